"""Periodic orbits of any friction law, known by their motion over one period."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import floor, inf, nan, pi, sqrt
from typing import Never

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import Number, NumberLike, Record, SceneName
from symosc.base.arguments import ARRAY_LIKE, NAMES, public, require
from symosc.base.arrays import real_array
from symosc.base.errors import ParameterError, meant
from symosc.derivatives.sensitivities import sensitivities
from symosc.engine.arithmetic import mp_context
from symosc.engine.events import Event
from symosc.kernels import linear
from symosc.model import Model
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.floquet import NEAR_ONE, multipliers
from symosc.orbits.periodic_orbit import (
    DOUBLE_MULTIPLIER,
    LEAST_SIZE,
    Approach,
    OrbitSensitivities,
    PeriodicOrbit,
    SwitchingPoint,
    counted_periods,
    multiplier_text,
    periods_until,
    read_approach,
)
from symosc.orbits.return_maps import SPARE_DIGITS, Closed, Shooting, SpeedSection
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import BAND_ROW, ELAPSED_ROW, Trajectory, map_labels
from symosc.words import Word, first_of_cycle

#: How far the motion over one period may end from its start, as a part of its size and speed, for
#: multipliers of at most 1.
CLOSES = 1e-8
#: Samples of a motion in which turns of the velocity are looked for.
SAMPLES = 2048
#: Derivatives of multipliers are difference quotients with such a step, in parts of the parameter,
#: of orbits with so many digits.
NEIGHBOUR_STEP = Fraction(1, 10**8)
NEIGHBOUR_DIGITS = 30
#: Periods for which the approach of a motion is followed.
APPROACH_LOOPS = 400.5
#: A phase is looked for to this part of the period, among so many samples at once.
PHASE_STEP = 1e-13
ZOOM = 64
#: The velocity turns where two steps of the search differ by less than this part of its distance.
FINE_TURN = 1e-9


@dataclass(frozen=True, repr=False)
class FollowedOrbit(PeriodicOrbit):
    """A periodic orbit of any law, or a rest: the answer of `find_orbit` where the law is not that
    of at most two Coulomb belts, or where there is no drive.

    The attributes are those of `PeriodicOrbit`. Without a drive the period is found, one multiplier
    is 1, that of the phase, and `periods` is 0; times count from the first switching point. A rest
    has no word; its multipliers are the factors by which deviations change in a unit of time, or in
    a period of the drive.

    Attributes
    ----------
    start : tuple of t, x, v
        A state on the orbit, in a flight.
    motion : Trajectory or None
        The motion from there over one period; None for a rest.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, find_orbit
    >>> law = Oscillator(m=1, c="1/10", k=1, belts=[Belt("1/5", mu="1/2", mu_s=1)])
    >>> cycle = find_orbit(law)
    >>> type(cycle).__name__, cycle.stable, cycle.periods, cycle.is_rest
    ('FollowedOrbit', True, 0, False)
    >>> f"{cycle.period:.6f}", f"{cycle.motion.t_end - cycle.motion.t_start:.6f}"
    ('8.383797', '8.383797')
    """

    start: tuple[Number, Number, Number] = (0.0, 0.0, 0.0)
    motion: Trajectory | None = field(default=None, compare=False)
    _section: SpeedSection | None = field(default=None, compare=False)

    @property
    def is_rest(self) -> bool:
        """Whether the mass rests."""
        return self.motion is None

    @public
    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return [x, v] at times t."""
        require(*ARRAY_LIKE, t=t)
        times = real_array("t", t, "must be real numbers")
        begin, x, v = map(float, self.start)
        if self.motion is None:
            return np.stack([np.full(times.shape, x), np.full(times.shape, v)])
        elapsed = (times - begin) % float(self.period)
        since = float(self.motion.t_start)
        return self.motion(np.minimum(since + elapsed, float(self.motion.t_end)))

    def equations(self) -> Never:
        """Refuse: the closing equations are those of two Coulomb belts with a drive."""
        _ = self.parameters.parameters  # which names the belt and what it has
        raise ParameterError(
            "orbit", self.word, "an orbit without a drive, or a rest, has no closing equations"
        )

    @property
    def first_belt(self) -> int | None:
        """The belt at which the points begin; None if no belt is met."""
        if not self.points:
            return None
        return Word(self.labels).maps[0].start.boundary

    @property
    def lyapunov(self) -> np.ndarray:
        """The two Lyapunov exponents per unit of time.

        An orbit with a stick has the multiplier 0, exponent -inf; a cycle without a drive has the
        exponent 0 of its phase.
        """
        if self.is_rest and not self.period:
            span = 1.0
        else:
            span = float(self.period)
        sizes = sorted((abs(complex(value)) for value in self.multipliers), reverse=True)
        logarithm = mp_context(25).log
        return np.array([float(logarithm(size)) if size > 0 else -inf for size in sizes]) / span

    @public
    def sensitivities(self, wrt: str | Sequence[str]) -> OrbitSensitivities:
        """Return the derivatives of the switching points and multipliers with respect to
        parameters.

        Those of the points follow from the derivatives of the return map. Those of the multipliers
        are difference quotients of orbits found with many digits.

        Raises
        ------
        ParameterError
            If a name is no parameter, or given twice, or the mass rests.
        """
        require(*NAMES, wrt=wrt)
        names = (wrt,) if isinstance(wrt, str) else tuple(wrt)
        known = list(self.parameters.numbers())
        for name in names or ("",):
            if name not in known or names.count(name) > 1:
                allowed = f"must be different names of {', '.join(known)}"
                hint = "" if name in known else meant(str(name), known)
                raise ParameterError("wrt", name, allowed + hint)
        if self._section is None:
            raise ParameterError("wrt", wrt, "a rest has no switching points to differentiate")
        dt, dx, _ = changes_of(self, names)
        slopes = np.array([self._slopes(name) for name in names]).T
        return OrbitSensitivities(names, dt, dx, slopes)

    def _slopes(self, name: str) -> list[complex]:
        """Return the derivatives of the multipliers with respect to a parameter; nan where both are
        equal.
        """
        first, second = map(complex, self.multipliers)
        if abs(first - second) <= DOUBLE_MULTIPLIER:
            return [complex(nan), complex(nan)]
        value = self.parameters.numbers()[name]
        step = max(abs(value), LEAST_SIZE) * NEIGHBOUR_STEP
        pairs = [self._neighbour(name, value + sign * step) for sign in (1, -1)]
        return [(a - b) / (2 * float(step)) for a, b in zip(*pairs, strict=True)]

    def _neighbour(self, name: str, value: Fraction) -> list[complex]:
        """Return the multipliers of the orbit at another value of a parameter, in the order of the
        orbit's own.
        """
        assert self._section is not None
        section = replace(self._section, law=self.parameters.replace(**{name: value}))
        t, x, _ = self.start
        shooting = Shooting(section, self.periods, 1.0, 1.0)
        closed = shooting.polish(Closed(t, x, self.period, np.eye(2), 0.0, 0), NEIGHBOUR_DIGITS)
        if closed is None:
            reason = f"there is none beside it for another {name}"
            raise ConvergenceError(self.word, (), self.periods, inf, reason)
        sticks = any(label.startswith("S") or label in ("P1", "P4") for label in self.labels)
        pair = [complex(z) for z in multipliers_of_map(closed.changes, self.periods, sticks)]
        target = complex(self.multipliers[0])
        return sorted(pair, key=lambda value: abs(value - target))

    @public
    def approach(self, scene: Scene | SceneName, within: NumberLike = 1e-6) -> Approach:
        """Return how far a scene's start is from the orbit, and when its motion comes within
        `within` of the orbit.

        Without a drive the start is compared with the state of the orbit from which the motion is
        not late or early in the end.

        Raises
        ------
        ParameterError
            If the scene has other parameters than the orbit.
        """
        scene, near = read_approach(scene, within)
        if scene.parameters != self.parameters:
            raise ParameterError("scene", scene.name, "must have the orbit's parameters")
        t0 = float(scene.t0)
        span = self.span_of_loop
        path = simulate(scene.reduced(), t_end=t0 + APPROACH_LOOPS * span)
        elapsed = span * np.arange(1 + int((float(path.t_end) - t0) / span))
        states = path(t0 + elapsed)
        if self.periods:
            shifts = span / self.periods * np.arange(self.periods) + t0
            shift = self._nearest(shifts, states[:, -1])
        else:
            shift = self._phase_of(states[:, -1])
        on_orbit = self(shift)
        offset = states[:, 0] - on_orbit
        distance = np.abs(states - on_orbit[:, None]).max(axis=0)
        offset_x, offset_v = offset.tolist()
        return Approach(nan, nan, offset_x, offset_v, periods_until(distance, near), near)

    def _nearest(self, times: np.ndarray, state: np.ndarray) -> float:
        """Return at which of some times the orbit is nearest to a state."""
        distances = np.abs(self(times) - state[:, None]).max(axis=0)
        return float(times[int(distances.argmin())])

    def _phase_of(self, state: np.ndarray) -> float:
        """Return the time at which the orbit is nearest to a state, by ever finer samples."""
        step = self.span_of_loop / SAMPLES
        phase = self._nearest(step * np.arange(SAMPLES), state)
        while step > PHASE_STEP * self.span_of_loop:
            near = phase + step * np.linspace(-1.0, 1.0, ZOOM + 1)
            phase = self._nearest(near, state)
            step *= 4 / ZOOM
        return phase

    @property
    def span_of_loop(self) -> float:
        """The period, or for a rest without a drive that of the free motion without damping."""
        if self.period:
            return float(self.period)
        return 2 * pi * sqrt(self.parameters.m / self.parameters.k)

    def as_dict(self) -> Record:
        """Return everything as plain values.

        Numbers with more than double precision become text.
        """
        return super().as_dict() | {
            "is_rest": self.is_rest,
            "start": dict(zip(("t", "x", "v"), map(float, self.start), strict=True)),
        }


def followed_orbit(
    section: SpeedSection,
    t: Number,
    x: Number,
    span: Number,
    periods: int,
    changes: np.ndarray,
    residual: float,
    steps: int,
    digits: int | None,
    motion: Trajectory | None = None,
) -> FollowedOrbit | None:
    """Follow the law's motion from a passage for one period; return the orbit if it closes, else
    None.

    `span` is the period, `changes` are the derivatives of the return map; `motion` is the law's, if
    it is known.
    """
    law = section.law
    v = section.speed
    more = digits if digits is None else digits + 2
    if motion is None:
        motion = simulate(law, t0=t, x0=x, v0=v, t_end=t + span, digits=more)
    if float(motion.t_end) < float(t + span):
        return None
    first, second = _multipliers(section, motion, periods, changes)
    largest = max(abs(complex(first)), abs(complex(second)))
    inside = np.linspace(float(t), float(motion.t_end), SAMPLES)
    xs, vs = motion(inside)
    off_x = abs(xs[-1] - float(x)) / max(np.ptp(xs), 1e-300)
    off_v = abs(vs[-1] - float(v)) / max(np.ptp(vs), 1e-300)
    if max(off_x, off_v) > CLOSES * max(1.0, largest):
        return None
    labels, order = _cycle(motion)
    touched = belts_touched(motion)
    if touched:  # rounding decides whether the mass sticks there for a moment
        labels = ()
        order = []
        first = 1 + 0 * first
        second = first
    events = [(turns, motion.events[n]) for turns, n in order]
    lag = _lag(events, law, t, periods, digits)
    points = tuple(
        SwitchingPoint(_rounded(event.t + turns * span - lag, digits), _rounded(event.x, digits))
        for turns, event in events
    )
    values = (_rounded_complex(first, digits), _rounded_complex(second, digits))
    gap = _gap(values, periods)
    stable = None if abs(gap) <= NEAR_ONE else gap > 0
    near = min(turning_distance(motion, inside, vs), passing_distance(motion))
    if touched:
        near = 0.0
    period = _rounded(span, digits)
    return FollowedOrbit(
        parameters=law,
        word=str(Word(labels)),
        labels=labels,
        points=points,
        period=period,
        periods=periods,
        multipliers=values,
        stable=stable,
        residual=residual,
        admissible=True,
        failures=(),
        grazing_distance=near,
        message=_message(periods, period, stable, gap, near, touched),
        steps=steps,
        digits=digits,
        start=(_rounded(t - lag, digits), _rounded(x, digits), v),
        motion=motion,
        _section=section,
    )


def _rounded(value: Number, digits: int | None) -> Number:
    """Return a number of the answer: a double, or one with `digits`."""
    if digits is None:
        return float(value)
    return +mp_context(digits).convert(value)


def _rounded_complex(value: Number, digits: int | None) -> Number:
    """Return a multiplier of the answer: in doubles complex, or with `digits`."""
    if digits is None:
        return complex(value)
    return +mp_context(digits).convert(value)


def changes_of(
    orbit: FollowedOrbit, wrt: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the derivatives of an orbit's times, positions and period with respect to `wrt`."""
    section = orbit._section
    motion = orbit.motion
    assert section is not None
    assert motion is not None
    span = float(orbit.period)
    _, x, _ = map(float, orbit.start)
    t = float(motion.t_start)
    end = section.passage(t, x, span, ("t0", "x0", *wrt))
    if end is None:
        raise ConvergenceError(orbit.word, (), orbit.periods, inf, "its motion does not close")
    by_start = end.changes[:, :2].astype(float)
    by_wrt = end.changes[:, 2:].astype(float)
    if orbit.periods:
        # The period changes with the frequency of the drive only.
        d_span = np.array([-span / float(section.law.Omega) * (name == "Omega") for name in wrt])
        right = -by_wrt
        right[0] += d_span
        d_start = np.stack(
            [linear.solve(by_start - np.eye(2), column) for column in right.T], axis=1
        )
    else:
        dx = by_wrt[1] / (1 - by_start[1, 1])
        d_start = np.array([0 * dx, dx])
        d_span = by_start[0, 1] * dx + by_wrt[0]
    events = end.motion.trajectory.events
    own = np.flatnonzero([event.boundary != section.boundary for event in events])
    _, order = _cycle(motion)
    dt = np.empty((len(order), len(wrt)))
    dx = np.empty((len(order), len(wrt)))
    for i, (turns, n) in enumerate(order):
        row_t = end.motion.dt[own[n]].astype(float)
        row_x = end.motion.dx[own[n]].astype(float)
        dt[i] = linear.product(d_start.T, row_t[:2]) + row_t[2:] + turns * d_span
        dx[i] = linear.product(d_start.T, row_x[:2]) + row_x[2:]
    if not orbit.periods:
        return dt - dt[:1], dx, d_span
    # The points are earlier than in the motion by whole turns of the drive.
    lag = t - float(orbit.start[0])
    return dt + lag / span * -d_span, dx, d_span


def _multipliers(
    section: SpeedSection, motion: Trajectory, periods: int, changes: np.ndarray
) -> tuple[Number, Number]:
    """Return the multipliers of an orbit, the larger one first, from the derivatives of its return
    map.
    """
    (a, _), (_, d) = changes.tolist()
    sticks = any(event.kind == "stick" for event in motion.events)
    if periods and not sticks and isinstance(a, float):
        return multipliers(a + d, _growth_of_areas(section, motion), cmath.sqrt)
    return multipliers_of_map(changes, periods, sticks)


def multipliers_of_map(changes: np.ndarray, periods: int, sticks: bool) -> tuple[Number, Number]:
    """Return the multipliers of an orbit, the larger one first, from the derivatives of its return
    map alone.
    """
    (a, b), (c, d) = changes.tolist()
    if not periods:
        pair = (1 + 0 * d, d - d if sticks else d)
        return max(pair, key=abs), min(pair, key=abs)
    if sticks:
        return a + d, a - a
    context = getattr(a, "context", None)
    if context is None:
        return multipliers(a + d, a * d - b * c, cmath.sqrt)
    return multipliers(a + d, a * d - b * c, lambda value: context.mpc(context.sqrt(value)))


def _growth_of_areas(section: SpeedSection, motion: Trajectory) -> float:
    """Return by what factor areas grow along a motion without a stick, more precisely than by the
    difference of two products.
    """
    _, _, _, x, v, *_ = motion._pieces[:, 0].tolist()
    span = float(motion.t_end) - float(motion.t_start)
    exponents = sensitivities(
        section.law, ("x0", "v0"), t0=motion.t_start, x0=x, v0=v, t_end=motion.t_end
    ).lyapunov
    total = float(exponents.sum())
    if total == -inf:
        return 0.0
    return float(mp_context(25).exp(total * span))


def _gap(values: Sequence[Number], periods: int) -> float:
    """Return 1 minus the size of the multiplier that decides: without a drive not that of the
    phase.
    """
    sizes = [float(abs(value)) for value in values]
    if not periods:
        sizes.remove(1.0)
    return 1 - max(sizes)


def _cycle(motion: Trajectory) -> tuple[tuple[str, ...], list[tuple[int, int]]]:
    """Return the labels of an orbit from where its word begins, and the numbers of its events in
    this order, each with the number of periods by which it is later than in the motion.
    """
    names = map_labels(len(motion.parameters.law.belts))
    events = list(motion.events)
    following = [*events[1:], *events[:1]]
    labels = [
        names[event.boundary, event.target, after.boundary]
        for event, after in zip(events, following, strict=True)
    ]
    first = first_of_cycle(labels)
    numbers = range(len(events))
    turned = [(0, n) for n in numbers[first:]] + [(1, n) for n in numbers[:first]]
    return tuple(labels[first:] + labels[:first]), turned


def points_of(motion: Trajectory) -> list[tuple[Event, Event]]:
    """Return the events of the motion over one period in the order of the orbit's word, each with
    the one after it.
    """
    events = motion.events
    return [(events[n], events[(n + 1) % len(events)]) for n in numbers_of_points(motion)]


def numbers_of_points(motion: Trajectory) -> list[int]:
    """Return the numbers of the events of the motion over one period in the order of the orbit's
    word.
    """
    _, order = _cycle(motion)
    return [n for _, n in order]


def _lag(
    events: list[tuple[int, Event]], law: Model, t: Number, periods: int, digits: int | None
) -> Number:
    """Return by how much the orbit's times are earlier than those of its motion.

    With a drive these are whole periods of it, so that the points begin in the first one.
    """
    begin = events[0][1].t if events else t
    if not periods:
        return begin
    if digits is None:
        turn = 2 * pi / float(law.Omega)
    else:
        Omega = law.Omega
        turn = 2 * mp_context(digits + SPARE_DIGITS).pi * Omega.denominator / Omega.numerator
    return turn * floor(begin / turn)


def vertex_of(before: float, here: float, after: float) -> float:
    """Return the extreme value of the parabola through three evenly spaced values."""
    return here - (after - before) ** 2 / (8 * (before - 2 * here + after))


def turning_distance(motion: Trajectory, times: np.ndarray, v: np.ndarray) -> float:
    """Return the smallest difference between the speed of a belt and a turn of the velocity in a
    flight beside it; inf without a turn.
    """
    modes = np.asarray(motion.mode(times)).astype(str)
    speeds = np.array([float(belt.v) for belt in motion.parameters.law.belts])
    before, here, after = v[:-2], v[1:-1], v[2:]
    flies = (modes[:-2] == modes[2:]) & (np.char.find(modes[1:-1], "belt") < 0)
    turns = np.flatnonzero(flies & ((here - before) * (after - here) < 0))
    nearest = inf
    for n in turns.tolist():
        vertex = vertex_of(before[n], here[n], after[n])
        nearest = min(nearest, float(np.abs(vertex - speeds).min()))
    return nearest


def passing_distance(motion: Trajectory) -> float:
    """Return how far beyond a belt the velocity would turn, at least, if the flights that end there
    went on; inf if none would turn.
    """
    nearest = inf
    for event in motion.events:
        if event.source.startswith("belt"):
            continue
        end = float(event.t) - float(motion.t_start)
        piece = int(np.searchsorted(motion._pieces[ELAPSED_ROW], end)) - 1
        row = int(motion._pieces[BAND_ROW, piece])
        upwards = event.source == f"Omega{event.boundary}"
        begin = end
        span = 2 * pi / motion._rows_of_constants[row].beat
        vertex = float(motion.parameters.law.belts[event.boundary - 1].v)  # of a mere touch
        speed = vertex
        turns = True
        while turns and span > PHASE_STEP:
            times = begin + np.linspace(0.0, span, ZOOM + 1)
            _, v, _ = motion._states_together(times, np.full(len(times), piece), row)
            back = np.flatnonzero((np.diff(v) > 0) != upwards)
            turns = len(back) > 0
            n = int(back[0]) if turns else 0
            if n > 0:
                vertex = vertex_of(*v[n - 1 : n + 2].tolist())
                if abs(vertex - float(v[n])) <= FINE_TURN * abs(vertex - speed):
                    break
                begin = float(times[n - 1])
            span = 2 * span / ZOOM
        if turns:
            nearest = min(nearest, abs(vertex - speed))
    return nearest


def belts_touched(motion: Trajectory) -> list[int]:
    """Return the belts that a circle of the undamped motion touches: none if the motion is no
    such circle.

    Without drive and damping, the mass slips from a belt whose static friction is its kinetic one
    where no force acts. It then flies round the largest circle below the belt's speed, and comes
    back with no force to hold it.
    """
    if not is_undamped(motion):
        return []
    law = motion.parameters.law
    touched = sorted({event.boundary for event in motion.events})
    holds = any(law.excess(boundary) for boundary in touched)
    sticks = all(event.kind in ("stick", "slip", "graze") for event in motion.events)
    if holds or not sticks:
        return []
    return touched


def is_undamped(motion: Trajectory) -> bool:
    """Return whether a motion without a drive flies through bands without damping only."""
    model = motion.parameters
    rows = set(motion._pieces[BAND_ROW].astype(int).tolist())
    return model.B0 == 0 and not any(model.law.damping(model.c, row) for row in rows)


def _message(
    periods: int,
    period: Number,
    stable: bool | None,
    gap: float,
    near: float,
    touched: Sequence[int],
) -> str:
    """Return the message of an orbit: its kind, what decides its stability, and how far from
    grazing it is.
    """
    kind = {True: "a stable", False: "an unstable", None: "a marginal"}[stable]
    shown = multiplier_text(None if stable is None else gap)
    if periods:
        message = f"{kind} orbit of {counted_periods(periods)}, largest |multiplier| {shown}"
    else:
        message = (
            f"{kind} limit cycle of period {float(period):.6g}, |multipliers| 1 (of its phase) and "
            f"{shown}"
        )
    if stable is None:
        message += " (no neighbour need come nearer)"
    if touched:
        message += f", touches belt {' and '.join(map(str, touched))}"
    elif near < inf:
        message += f", {near:.3g} in velocity away from grazing"
    return message
