"""`attractors`: what many motions settle to, how many of them, and from where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import pi
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import DataFrame, NumberLike
from symosc.base.arguments import NUMBER, TABLE_LIKE, WHOLE, public, require, require_or_none
from symosc.base.display.drawable import Comparable, Drawable
from symosc.base.display.frames import imported
from symosc.base.errors import ParameterError
from symosc.base.quantities import forcing_periods, quantity_of, read_number
from symosc.basins.kinds import ObservedCycle, Rest
from symosc.basins.plane import Limit, PhasePlane, require_spring
from symosc.basins.recurrence import DrivenMotions, Recurrent
from symosc.basins.return_map import LEAST_POINTS, return_map
from symosc.basins.starts import ReadStarts, read_starts
from symosc.model import Model, Oscillator
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.orbits.shooting import orbit_near
from symosc.orbits.unsettled import Chaotic, QuasiPeriodic
from symosc.scenes import ParametersLike, check_periods, model_of
from symosc.simulation.simulate import simulate
from symosc.simulation.tables import counted
from symosc.words import Word

#: Forcing periods for which a motion is followed at most, unless the caller says so.
USUAL_PERIODS = 1000
MOST_PERIODS = 10**6
#: Slips over which the exponent of the map of slips is computed.
SLIPS = 12_000
#: Times at which an orbit is compared with the state beside which it was looked for, half as many,
#: and how near it must come, as a part of its extent.
ORBIT_SAMPLES = 512
BESIDE = 0.05
Attractor: TypeAlias = PeriodicOrbit | ObservedCycle | Rest | Chaotic | QuasiPeriodic


@dataclass(frozen=True, eq=False, repr=False)
class Attractors(Comparable, Drawable):
    """The attractors of a set of starts, the most frequent one first.

    Attributes
    ----------
    parameters : Parameters or Oscillator
    orbits : tuple
        For each attractor a `PeriodicOrbit`, an `ObservedCycle`, a `Rest`, a `QuasiPeriodic` or
        `Chaotic`. An orbit of several forcing periods is one attractor, and two orbits that are
        mirror images are two.
    share, share_error : (n,) float arrays
        The part p of the starts that leads to each, and its standard error sqrt(p (1 - p)/starts)
        as a part of all starts, if the starts were drawn at random.
    basin : int array
        For each start the index of its attractor, -1 where that is undecided; of the grid's shape
        if the starts are a grid.
    starts : (m, 3) float array
        t0, x0, v0.
    axes : dict
        The values of the axes of a grid by name, else empty.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, attractors
    >>> law = Oscillator(m=1, c="0.1", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
    >>> found = attractors(law, {"x0": "-2:2:9", "v0": "-1:1:5"})
    >>> found.names, found.basin.shape, found.share.round(3).tolist()
    (('cycle', 'rest'), (9, 5), [0.911, 0.089])
    """

    _drawn_by = "attractors_figure"
    _made_by = "attractors(...)"

    parameters: Model
    orbits: tuple[Attractor, ...]
    share: np.ndarray
    share_error: np.ndarray
    basin: np.ndarray
    starts: np.ndarray
    axes: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def undecided(self) -> float:
        """The part of the starts whose attractor is undecided."""
        return float((self.basin < 0).mean())

    @property
    def names(self) -> tuple[str, ...]:
        """A short name of each attractor, such as "rest on belt 1" or "period 2"."""
        names = [_name_of(orbit) for orbit in self.orbits]
        return tuple(
            f"{name} ({names[: i + 1].count(name)})" if names.count(name) > 1 else name
            for i, name in enumerate(names)
        )

    def __len__(self) -> int:
        return len(self.orbits)

    def __repr__(self) -> str:
        parts = [f"{name} {share:.3g}" for name, share in zip(self.names, self.share, strict=True)]
        if self.undecided:
            parts.append(f"undecided {self.undecided:.3g}")
        return f"<Attractors of {counted(len(self.starts), 'start')}: {', '.join(parts)}>"

    def to_xarray(self) -> Any:
        """Return a Dataset with the basin over the starts and the shares over the attractors.

        MissingExtraError if xarray is not installed.
        """
        coordinates: dict[str, Any] = {"attractor": list(self.names)}
        if self.axes:
            dimensions = tuple(self.axes)
            for name, values in self.axes.items():
                coordinates[name] = (name, values, {"long_name": quantity_of(name).meaning})
        else:
            dimensions = ("start",)
            for n, name in enumerate(("t0", "x0", "v0")):
                about = {"long_name": quantity_of(name).meaning}
                coordinates[name] = ("start", self.starts[:, n], about)
        columns = {
            "basin": (
                dimensions,
                self.basin,
                {"long_name": "index of the attractor, -1: undecided"},
            ),
            "share": ("attractor", self.share, {"long_name": "part of the starts"}),
            "share_error": ("attractor", self.share_error, {"long_name": "its standard error"}),
        }
        return imported("xarray").Dataset(columns, coordinates)


@public
def attractors(
    what: ParametersLike,
    starts: ArrayLike | Mapping[str, ArrayLike] | DataFrame,
    *,
    t_end: NumberLike | None = None,
    workers: int | None = None,
) -> Attractors:
    """Find all attractors to which starts lead, and the basin of each.

    Without a drive, states are points of a plane, whose paths do not cross. Each start is followed
    until v falls through 0 for the first time; these points are sorted, and long motions from a few
    of them decide all others: of two that lead to one attractor, all between them do. With a drive,
    all motions are followed together until their states at the ends of forcing periods recur.
    A limit counts as an attractor only if neighbours come nearer to it.

    Parameters
    ----------
    what : Parameters or Oscillator, or a Scene, its name or its file
        Any friction law, with a spring.
    starts : (n, 3) or (3,) array_like, rows of t0, x0, v0; or mapping of these names
        As for `simulate_many`. Or a mapping of two of the names to values, or text "LO:HI:N": a
        grid, where the third one is 0.
    t_end : number or str, optional
        For how long a motion with a drive is followed at most; "1000T" is 1000 forcing periods, the
        default. What has not recurred by then is chaotic, quasi-periodic, or undecided. Without a drive it has no
        effect: motions are followed for up to 20,000 turns.
    workers : int, optional
        Threads; None: one for each core. They do not change the answer.

    Returns
    -------
    Attractors

    Raises
    ------
    ParameterError
        If a number is out of range, or there is no spring.

    Examples
    --------
    >>> from symosc import attractors
    >>> attractors("fig9", [(0, 0, 0), (0, 5, 1)])
    <Attractors of 2 starts: period 1 1>
    """
    model = model_of(what, "what")
    require(*TABLE_LIKE, starts=starts)
    require_or_none(NUMBER, t_end=t_end)
    require_or_none(WHOLE, workers=workers)
    require_spring(model)
    given = read_starts(starts)
    most = _periods_in(model, t_end)
    if model.B0 == 0:
        plane = PhasePlane(model, workers)
        numbers, limits = plane.decide(given.rows)
        orbits = [_orbit_of_limit(plane, limit) for limit in limits]
    else:
        motions = DrivenMotions(model, most, workers)
        numbers = motions.decide(given.rows)
        orbits = [_orbit_of(motions, attractor) for attractor in motions.found]
    return _sorted(model, given, numbers, orbits)


def _periods_in(model: Model, t_end: Any) -> int:
    """Return for how many forcing periods motions are followed at most."""
    if t_end is None:
        return USUAL_PERIODS
    given = forcing_periods("t_end", t_end)
    if given is None:
        span = float(read_number("t_end", t_end)[0])
        if not span > 0:
            raise ParameterError("t_end", t_end, "must be > 0")
        periods = span * float(model.Omega) / (2 * pi)
    else:
        check_periods("t_end", t_end, model)
        periods = float(given)
    return int(min(max(periods, 1), MOST_PERIODS))


def _sorted(
    model: Model, given: ReadStarts, numbers: np.ndarray, orbits: list[Attractor]
) -> Attractors:
    """Return the answer, with the attractors that starts lead to, the most frequent one first."""
    counts = np.array([(numbers == n).sum() for n in range(len(orbits))], dtype=np.int64)
    order = [n for n in np.argsort(-counts, kind="stable").tolist() if counts[n]]
    basin = np.full(len(numbers), -1)
    for place, n in enumerate(order):
        basin[numbers == n] = place
    share = counts[order] / len(numbers)
    error = np.sqrt(share * (1.0 - share) / len(numbers))
    return Attractors(
        model, tuple(orbits[n] for n in order), share, error, basin.reshape(given.shape),
        given.rows, given.axes,
    )  # fmt: skip


def _orbit_of_limit(plane: PhasePlane, limit: Limit) -> Attractor:
    """Return the attractor of motions without a drive that have this limit."""
    if limit.kind == "rest":
        return plane.rest
    orbit = _closed(plane.model, limit.x, 0.0, None)
    if orbit is not None and not orbit.is_rest:
        return orbit
    period = plane.return_time(limit.x)
    path = simulate(plane.model, x0=limit.x, v0=0, t_end=2 * period)
    labels = [
        segment.label
        for segment in path.segments
        if segment.label and period <= float(segment.t_end) < 2 * period
    ]
    word = str(Word(tuple(labels)).cycle)
    return ObservedCycle(np.array([[limit.x, 0.0]]), period, 0, word)


def _orbit_of(
    motions: DrivenMotions, attractor: Recurrent | Rest | Chaotic | QuasiPeriodic
) -> Attractor:
    """Return the attractor of motions with a drive."""
    if isinstance(attractor, Chaotic):
        return _with_slips(motions.model, attractor)
    if not isinstance(attractor, Recurrent):
        return attractor
    q = attractor.periods
    x, v = attractor.points[0].tolist()
    orbit = _closed(motions.model, x, v, q)
    if orbit is not None and orbit.periods == q:
        return orbit
    period = 2 * pi * q / float(motions.model.Omega)
    return ObservedCycle(attractor.points, period, q, attractor.word)


def _with_slips(model: Oscillator, chaos: Chaotic) -> Chaotic:
    """Return chaos with its exponent per slip from the map of slips, where one belt has friction:
    this map is quicker than derivatives of motions, and followed for longer.
    """
    law = model.law
    belts = [n for n in law.boundaries if law.kinetic(n) or law.excess(n)]
    if len(belts) != 1 or not np.isfinite(chaos.per_slip):
        return chaos
    x, v = chaos.points[-1].tolist()
    events = simulate(model, x0=x, v0=v, t_end="20T").events
    phases = [event.theta for event in events if event.kind == "slip"]
    if not phases:
        return chaos
    exponent, _ = return_map(model, points=LEAST_POINTS).exponent(phases[0], n=SLIPS, skip=0)
    return replace(chaos, per_slip=exponent if np.isfinite(exponent) else chaos.per_slip)


def _closed(model: Model, x: float, v: float, periods: int | None) -> PeriodicOrbit | None:
    """Return the orbit that Newton's method finds beside a state; None if it finds none there."""
    try:
        orbit = orbit_near(model, 0, x, v, periods)
    except ConvergenceError:
        return None
    if orbit.is_rest:
        return None
    times = np.linspace(0.0, float(orbit.period), 2 * ORBIT_SAMPLES, endpoint=False)
    away = np.abs(orbit(times) - np.array([[x], [v]])) / np.ptp(orbit(times), axis=1)[:, None]
    if away.max(axis=0).min() > BESIDE:
        return None
    return orbit


def _name_of(orbit: Attractor) -> str:
    """Return a short name of an attractor."""
    if not isinstance(orbit, PeriodicOrbit):
        return orbit.name
    if orbit.periods:
        return f"period {orbit.periods}"
    return "cycle"
