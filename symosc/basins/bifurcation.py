"""`bifurcation`: what motions settle to over one parameter, where several attractors coexist.

With a drive two motions go through the values one after the other, upward and downward; each begins
at a value where it ended at the one before, pushed a little, so that it leaves an orbit that has
lost its stability. Motions from given starts begin anew at each value. Without a drive the
attractors are computed at each value (`symosc.basins.plane`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import DataFrame, NumberLike
from symosc.base.arguments import (
    ARRAY_LIKE,
    NUMBER,
    TABLE_LIKE,
    TEXT,
    WHOLE,
    mapping_of,
    public,
    require,
    require_or_none,
)
from symosc.base.display.drawable import Comparable, Drawable
from symosc.base.display.frames import imported
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import read_exact, whole_number
from symosc.base.quantities import quantity_of
from symosc.basins.kinds import oscillator_of
from symosc.basins.plane import PhasePlane, require_spring
from symosc.basins.recurrence import CLOUD, repeats_of, units_of
from symosc.basins.starts import read_starts
from symosc.model import Model
from symosc.orbits.unsettled import sections_of, unsettled_at
from symosc.scenes import ParametersLike, model_of
from symosc.simulation.ensemble import simulate_many
from symosc.sweeps.plan import read_axis, swept_names

#: How far a motion is pushed between two values, as a part of the extent.
PUSH = 1e-4
#: Two motions are on one attractor if the section points of each are no farther from those of the
#: other than this part of the extent, or than this times the distance between halves of one motion.
SAME = 1e-4
FARTHER = 6.0
MOST_SECTIONS = 10_000
MOST_SKIPPED = 100_000
#: Section points without a drive that are followed to their limits, and cycles that are kept.
FOLLOWED = 24
MOST_CYCLES = 4


@dataclass(frozen=True, eq=False, repr=False)
class Bifurcation(Comparable, Drawable):
    """Section points of motions over one parameter.

    Attributes
    ----------
    parameters : Parameters or Oscillator
    name : str
        The parameter.
    values : (n,) float array
    branches : tuple of str
        "upward", "downward", and "start 1", "start 2" and so on; without a drive "rest" and
        "cycle 1", "cycle 2" and so on, by size.
    points : (n, branches, sections, 2) float array
        Position and velocity at the ends of forcing periods or, without a drive, where v falls
        through 0 (one point); NaN where there are none.
    attractor : (n, branches) int array
        For each motion the first branch that is on the same attractor; -1 without points.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, bifurcation
    >>> law = Oscillator(m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.98")])
    >>> found = bifurcation(law, {"mu_s1": "0.7:0.98:8"}, sections=8)
    >>> found.points.shape, found.branches, found.coexisting.any()
    ((8, 2, 8, 2), ('upward', 'downward'), np.False_)
    """

    _drawn_by = "bifurcation_figure"
    _made_by = "bifurcation(...)"

    parameters: Model
    name: str
    values: np.ndarray
    branches: tuple[str, ...]
    points: np.ndarray
    attractor: np.ndarray

    @property
    def coexisting(self) -> np.ndarray:
        """For each value whether more than one attractor was found."""
        several: np.ndarray = (
            (self.attractor >= 0) & (self.attractor != self.attractor.max(axis=1)[:, None])
        ).any(axis=1)
        return several

    @public
    def name_at(self, value: NumberLike, branch: str | None = None) -> str:
        """Return the name of what a motion settled to, such as "period 2", "rest" or "cycle".

        Motions that do not repeat themselves are followed on, to say whether they are chaotic or
        quasi-periodic: "chaos, exponent 0.02", "quasi-periodic, rotation 1.065". "undecided" is
        what is open, "" where the branch has no points.

        Parameters
        ----------
        value : number
            Of the parameter; the nearest one of `values` counts.
        branch : str, optional
            One of `branches`; the first one by default.

        Examples
        --------
        >>> from symosc import Belt, Oscillator, bifurcation
        >>> law = Oscillator(m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.98")])
        >>> found = bifurcation(law, {"mu_s1": [0.7, 1.26]}, sections=8)
        >>> found.name_at(0.7), found.name_at(1.26)
        ('period 1', 'chaos, exponent 0.02')
        """
        require(NUMBER, value=value)
        require_or_none(TEXT, branch=branch)
        names = list(self.branches)
        if branch is not None and branch not in names:
            raise ParameterError("branch", branch, f"must be one of {', '.join(names)}")
        row = 0 if branch is None else names.index(branch)
        place = int(np.abs(self.values - float(read_exact("value", value))).argmin())
        points = self.points[place, row]
        if not np.isfinite(points).all():
            return ""
        model = self.parameters.replace(**{self.name: float(self.values[place])})
        if self.branches[row].startswith(("rest", "cycle")):
            return self.branches[row].split()[0]
        return _name_of(model, points)

    def __repr__(self) -> str:
        return (
            f"<Bifurcation over {self.name}: {len(self.values)} values, "
            f"{', '.join(self.branches)}; several attractors at {int(self.coexisting.sum())}>"
        )

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per section point; MissingExtraError if pandas is not installed.

        Its columns are the parameter, "branch", "attractor", "period" (the number of the section
        point), "x" and "v". Branches without points at a value have no rows there.
        """
        shape = self.points.shape[:-1]
        value, branch, period = (places.ravel() for places in np.indices(shape))
        columns = {
            self.name: self.values[value],
            "branch": np.array(self.branches)[branch],
            "attractor": self.attractor[value, branch],
            "period": period,
            "x": self.points[..., 0].ravel(),
            "v": self.points[..., 1].ravel(),
        }
        there = np.isfinite(columns["x"])
        rows = {name: column[there] for name, column in columns.items()}
        return imported("pandas").DataFrame(rows)

    def to_xarray(self) -> Any:
        """Return a Dataset over the parameter, the branches and the sections.

        MissingExtraError if xarray is not installed.
        """
        about = {"long_name": quantity_of(self.name).meaning}
        columns = {
            "section": ((self.name, "branch", "period", "component"), self.points),
            "attractor": ((self.name, "branch"), self.attractor),
        }
        coordinates = {
            self.name: (self.name, self.values, about),
            "branch": list(self.branches),
            "component": ["x", "v"],
        }
        return imported("xarray").Dataset(columns, coordinates)


@public
def bifurcation(
    what: ParametersLike,
    over: Mapping[str, ArrayLike],
    *,
    starts: ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    sections: int = 100,
    skip: int = 200,
    workers: int | None = None,
) -> Bifurcation:
    """Compute a bifurcation diagram in which coexisting attractors are told apart.

    Parameters
    ----------
    what : Parameters or Oscillator, or a Scene, its name or its file
    over : mapping
        One parameter (also mu_s1, w1_1 and so on) with its values, or text "LO:HI:N".
    starts : optional
        Rows t0, x0, v0 or columns of them, as for `simulate_many`: further motions, with a drive,
        that begin there at each value.
    sections, skip : int, optional
        With a drive: forcing periods at whose ends states are kept, after those that are left out.
    workers : int, optional
        Threads; None: one for each core.

    Returns
    -------
    Bifurcation

    Raises
    ------
    ParameterError
        If a number is out of range, a name is unknown, or there is no spring.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, bifurcation
    >>> law = Oscillator(m=1, c="0.1", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
    >>> found = bifurcation(law, {"v1": [0.4, 0.5, 0.6]})
    >>> found.branches, found.coexisting.tolist()
    (('rest', 'cycle 1'), [True, True, False])
    """
    model = model_of(what, "what")
    require(mapping_of(*ARRAY_LIKE), over=over)
    require_or_none(*TABLE_LIKE, starts=starts)
    require(WHOLE, sections=sections, skip=skip)
    require_or_none(WHOLE, workers=workers)
    require_spring(model)
    known = [name for name in swept_names(model) if name not in ("t0", "x0", "v0")]
    if len(over) != 1 or next(iter(over)) not in known:
        allowed = f"must be one of {', '.join(known)} with its values"
        if len(over) == 1:
            allowed += meant(next(iter(over)), known)
        raise ParameterError("over", list(over), allowed)
    ((name, given),) = over.items()
    if name not in model.numbers():  # static friction of the paper's belts, which have none
        model = oscillator_of(model)
    values = np.sort(read_axis(name, given))
    models = [model.replace(**{name: value}) for value in values.tolist()]
    kept = whole_number("sections", sections, 1, MOST_SECTIONS)
    left_out = whole_number("skip", skip, 0, MOST_SKIPPED)
    if model.B0 == 0 and name != "B0":
        if starts is not None:
            raise ParameterError("starts", starts, "must be omitted without a drive")
        branches, points = _without_drive(models, workers)
    else:
        rows = np.zeros((0, 3)) if starts is None else read_starts(starts).rows
        motions = _Motions(models, kept, left_out, workers)
        points = np.concatenate([motions.followed(), motions.started(rows)], axis=1)
        branches = ("upward", "downward", *(f"start {n + 1}" for n in range(len(rows))))
    attractor = np.array(
        [_same(own, units_of(oscillator_of(p))) for own, p in zip(points, models, strict=True)]
    )
    return Bifurcation(model, name, values, branches, points, attractor)


class _Motions:
    """Motions under a drive at all values of a parameter."""

    def __init__(self, models: list[Model], sections: int, skip: int, workers: int | None) -> None:
        self.models = models
        self.sections = sections
        self.periods = sections + skip
        self.workers = workers

    def _sections(self, models: list[Model], starts: np.ndarray) -> np.ndarray:
        """Return the last section points of motions, each with parameters of its own."""
        found = simulate_many(
            models, starts, f"{self.periods}T", accuracy=inf, record=("section",),
            sections=self.sections, workers=self.workers,
        )  # fmt: skip
        section: np.ndarray = found.section
        return section

    def followed(self) -> np.ndarray:
        """Return the section points of two motions through all values, upward and downward."""
        count = len(self.models)
        points = np.full((count, 2, self.sections, 2), np.nan)
        states = np.zeros((2, 2))
        push = PUSH * units_of(oscillator_of(self.models[0]))
        for i in range(count):
            places = i, count - 1 - i
            starts = np.column_stack([np.zeros(2), states + push])
            found = self._sections([self.models[place] for place in places], starts)
            for direction, place in enumerate(places):
                points[place, direction] = found[direction]
            last = found[:, -1]
            states = np.where(np.isfinite(last), last, states)
        return points

    def started(self, starts: np.ndarray) -> np.ndarray:
        """Return the section points of motions from starts at each value."""
        count = len(self.models)
        shape = (count, len(starts), self.sections, 2)
        if not len(starts):
            return np.zeros(shape)
        models = [model for model in self.models for _ in range(len(starts))]
        return self._sections(models, np.tile(starts, (count, 1))).reshape(shape)


def _name_of(model: Model, points: np.ndarray) -> str:
    """Return what a motion under a drive is that ends with some section points."""
    x, v = points[-1].tolist()
    followed = sections_of(model, 0.0, x, v, CLOUD)
    if followed is None:
        return "undecided"
    (periods,) = repeats_of(followed[None], units_of(oscillator_of(model))).tolist()
    if periods:
        return f"period {periods}"
    found = unsettled_at(model, 0.0, *followed[-1].tolist())
    return "undecided" if found is None else found.name


def _without_drive(models: list[Model], workers: int | None) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the names of the attractors, and where each passes through the section."""
    points = np.full((len(models), 1 + MOST_CYCLES, 1, 2), np.nan)
    for i, model in enumerate(models):
        plane = PhasePlane(model, workers)
        size = float(units_of(oscillator_of(model))[0])
        parts = np.linspace(0.0, 1.0, FOLLOWED + 1)[1:] ** 2
        _, limits = plane.decide(
            np.column_stack([0 * parts, plane.rest.high + 2 * size * parts, 0 * parts])
        )
        cycles = sorted(limit.x for limit in limits if limit.kind == "cycle")
        if any(limit.kind == "rest" for limit in limits):
            points[i, 0, 0] = plane.rest.high, 0.0
        for n, x in enumerate(cycles[:MOST_CYCLES]):
            points[i, 1 + n, 0] = x, 0.0
    there = np.isfinite(points[:, :, 0, 0]).any(axis=0)
    names = ("rest", *(f"cycle {n + 1}" for n in range(MOST_CYCLES)))
    return tuple(np.array(names)[there].tolist()), points[:, there]


def _same(points: np.ndarray, unit: np.ndarray) -> list[int]:
    """Return for each branch the first one whose section points are the same, -1 without points."""
    first = list[int]()
    for n, own in enumerate(points):
        if not np.isfinite(own).all():
            first.append(-1)
            continue
        same = (m for m in range(n) if first[m] == m and _together(points[m], own, unit))
        first.append(next(same, n))
    return first


def _together(one: np.ndarray, two: np.ndarray, unit: np.ndarray) -> bool:
    """Return whether two motions are on one attractor, as far as their section points tell."""
    gap = max(_gap(one, two, unit), _gap(two, one, unit))
    return gap <= SAME or gap <= FARTHER * max(_drift(one, unit), _drift(two, unit))


def _drift(points: np.ndarray, unit: np.ndarray) -> float:
    """Return how far the second half of a motion's section points is from the first one: much in
    chaos, and where the motion has not settled.
    """
    half = len(points) // 2
    if not half:
        return 0.0
    return _gap(points[half:], points[:half], unit)


def _gap(points: np.ndarray, others: np.ndarray, unit: np.ndarray) -> float:
    """Return the mean distance from points to the nearest of others."""
    distances = np.abs((points[:, None] - others[None]) / unit).max(axis=-1)
    return float(distances.min(axis=1).mean())
