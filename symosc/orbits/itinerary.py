"""Motions of any friction law along a known itinerary: bands and belts in a known order, in doubles.

The engine finds out what a motion does. Where that is known, from a motion nearby, only the times are
to be found at which each leg ends: by Newton's method from the times of the motion nearby, with the
closed form of the band. That takes a small part of the time of a search for events. And it goes on
where there is no such motion any more: a stick may have a negative duration, and a flight that ends
where its velocity turns may end beyond the belt. So borders between words are the zeros of smooth
functions (`symosc.orbits.law_border`). Whether a motion is one of the law is for the engine to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from math import exp, inf, sqrt
from typing import NamedTuple

import numpy as np

from symosc.engine.flow import Constants, constants
from symosc.engine.state import ON_BELT
from symosc.friction import EdgeOfLaw, FrictionLaw, RowOfLaw
from symosc.kernels._generated import acceleration, motion, next_derivative
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import basis
from symosc.model import OSCILLATOR_NAMES, Model, OtherNumbers
from symosc.simulation.trajectory import BAND_ROW, ELAPSED_ROW, MODE_ROW, Trajectory

#: Newton's steps to the end of a leg at most, and the last one, as a part of the time that the motion
#: takes to change.
MOST_STEPS = 30
LAST_STEP = 1e-14
#: From a step of this size on steps that shrink by less than NO_PROGRESS are rounding.
PERHAPS_ROUNDING = 1e-6
NO_PROGRESS = 4
#: A velocity counts as that of an edge, as a part of both.
ON_SPEED = 1e-12
#: A step changes the duration of a leg at most by so much of it, and of the time in which the motion
#: changes.
LONGEST_STEP = 0.5
#: How far back the closed form of a flight is followed beyond its start, in the same time.
FARTHEST_BACK = 0.5


class LegEnd(Enum):
    """What a leg of an itinerary ends with."""

    #: A flight reaches the speed of an edge of the law.
    EDGE = "edge"
    #: A flight reaches the speed at which the itinerary began.
    CLOSED = "closed"
    #: The velocity of a flight turns.
    TURN = "turn"
    #: A stick ends where the belt can no longer hold the mass.
    SLIP = "slip"


class ItineraryLeg(NamedTuple):
    """A leg of an itinerary.

    Attributes
    ----------
    band : int
        The band of a flight, from 0; for a stick the number of its edge among those of the law.
    sticks : bool
    end : LegEnd
    edge : int
        The edge at which a flight ends, -1 if it ends at none; for a stick the side to which the
        mass leaves: 1 up, -1 down.
    rises : bool
        Whether a flight ends at its edge from below.
    """

    band: int
    sticks: bool
    end: LegEnd
    edge: int
    rises: bool

    @property
    def side(self) -> int:
        """1 if a flight ends at its edge from below, -1 from above."""
        return 1 if self.rises else -1


class PointOnWay(NamedTuple):
    """Time, position, velocity and acceleration at the beginning of a leg or its end, and the changes
    of the first three with the time and the position of the start.
    """

    t: float
    x: float
    v: float
    a: float
    dt: tuple[float, float]
    dx: tuple[float, float]
    dv: tuple[float, float]


class MotionOnWay(NamedTuple):
    """A motion along an itinerary: its end, the legs that it took, their durations, where each begins,
    and the factor by which flights and passages change areas.
    """

    end: PointOnWay
    legs: tuple[ItineraryLeg, ...]
    spans: tuple[float, ...]
    starts: tuple[PointOnWay, ...]
    growth: float

    @property
    def changes(self) -> np.ndarray:
        """The derivatives of the time and the position of the end by those of the start."""
        return np.array([self.end.dt, self.end.dx])


class RoundedLaw:
    """A friction law whose rows are rounded: what `constants` asks of a law."""

    def __init__(self, law: FrictionLaw) -> None:
        self.is_plain = law.is_plain
        self.rows = [_rounded_row(row) for row in law.rows]

    def damping(self, c: float, row: int) -> float:
        """Return the damping in a row of constants."""
        return c + (self.rows[row].slope or 0.0)


def _rounded_row(row: RowOfLaw) -> RowOfLaw:
    """Return a row of a law in doubles."""
    below, above = (edge and _rounded_edge(edge) for edge in (row.below, row.above))
    slope = row.slope and float(row.slope)
    low, middle, high = row.forces
    return RowOfLaw(slope, (float(low), float(middle), float(high)), below, above, row.domain)


def _rounded_edge(edge: EdgeOfLaw) -> EdgeOfLaw:
    """Return an edge in doubles."""
    return edge._replace(v=float(edge.v), J=float(edge.J), E=float(edge.E))


class LawInDoubles:
    """The numbers of a law in doubles: its edges, and the constants of its bands, from 0."""

    def __init__(self, model: Model) -> None:
        self.numbers = OtherNumbers(
            {name: float(getattr(model, name)) for name in OSCILLATOR_NAMES}
        )
        rounded = RoundedLaw(model.law)
        self.numbers._law = rounded  # type: ignore[assignment]
        self.law = rounded
        self.edges = [_rounded_edge(edge) for edge in model.law.edges]
        self.speeds = [edge.v for edge in self.edges]
        self.limits = [edge.E / self.numbers.m for edge in self.edges]
        self._bands = dict[int, tuple[Constants, float]]()

    def band(self, number: int) -> tuple[Constants, float]:
        """Return the constants and the constant force of a band."""
        if number not in self._bands:
            row = 0 if self.law.is_plain else number
            K = constants(self.numbers, row=row)
            force = K.A2
            if self.law.is_plain:
                force = (K.A1, K.A2, K.A3)[number]
            self._bands[number] = K, force
        return self._bands[number]

    def force(self, number: int, t: float, x: float, v: float) -> float:
        """Return the acceleration that a band gives."""
        K, A = self.band(number)
        return float(acceleration(x, v, cos(K.Om * t), A, K.cm, K.w0sq, K.f0))

    def holding(self, edge: int, side: int, t: float, x: float) -> float:
        """Return what is left of static friction against the force that pushes the mass off an edge,
        up (`side` 1) or down (-1).
        """
        v = self.speeds[edge]
        if side > 0:
            return self.limits[edge] - self.force(edge + 1, t, x, v)
        return self.limits[edge] + self.force(edge, t, x, v)

    def holding_slope(self, edge: int, side: int, t: float) -> float:
        """Return how fast that changes during a stick."""
        K, _ = self.band(edge)
        return side * (K.w0sq * self.speeds[edge] + K.fB * sin(K.Om * t))


@dataclass(frozen=True)
class Itinerary:
    """The legs of a motion from one passage of a speed to a later one, in the same direction.

    `spans` are their durations in a motion nearby. `start` is the edge at which the motion starts and
    ends, -1 where this is the speed `section`, in a flight.
    """

    legs: tuple[ItineraryLeg, ...]
    spans: tuple[float, ...]
    start: int
    section: float

    def speed(self, law: LawInDoubles) -> float:
        """Return the velocity at the start."""
        if self.start < 0:
            return self.section
        return law.speeds[self.start]

    def follow(self, law: LawInDoubles, t: float, x: float) -> MotionOnWay | None:
        """Return the motion along the itinerary from its start at a time and a position; None if a
        leg has no end.

        Where the velocity only just goes beyond a corner of friction and turns back, the legs beyond
        it come and go: they are left out where it does not reach the corner, and put in where it
        does.
        """
        here = PointOnWay(t, x, self.speed(law), 0.0, (1.0, 0.0), (0.0, 1.0), (0.0, 0.0))
        waiting = list(zip(self.legs, self.spans, strict=True))
        done = list[tuple[ItineraryLeg, float, PointOnWay]]()
        growth = 1.0
        while waiting:
            leg, guess = waiting.pop(0)
            beyond = _legs_beyond(law, leg, here, guess, done[-1][0] if done else None)
            if beyond:
                waiting = [*beyond, *waiting]
                continue
            after = leg_end(law, leg, here, guess, self.section)
            if after is None:
                back = _return_to(leg, waiting)
                if back < 0:
                    return None
                late = guess + sum(span for _, span in waiting[: back + 1])
                (later, span), *waiting = waiting[back + 1 :]
                waiting.insert(0, (later, late + span))
                continue
            following = waiting[0][0] if waiting else self.legs[0]
            span = after.t - here.t
            growth *= growth_of_areas(law, leg, following, span, after)
            done.append((leg, span, here))
            if following.sticks and waiting:
                after = after._replace(v=law.speeds[following.band], dv=(0.0, 0.0))
            here = after
        legs, spans, starts = zip(*done, strict=True)
        return MotionOnWay(here, legs, spans, starts, growth)


def _return_to(leg: ItineraryLeg, later: list[tuple[ItineraryLeg, float]]) -> int:
    """Return the number of the first of the legs after one that crosses an edge which comes back to
    this edge; -1 if none does before the next stick, or nothing comes after it.
    """
    if leg.sticks or leg.end is not LegEnd.EDGE:
        return -1
    for j, (other, _) in enumerate(later[:-1]):
        if other.sticks:
            return -1
        if other.end is LegEnd.EDGE and other.edge == leg.edge:
            return j
    return -1


def _legs_beyond(
    law: LawInDoubles,
    leg: ItineraryLeg,
    here: PointOnWay,
    guess: float,
    before: ItineraryLeg | None,
) -> list[tuple[ItineraryLeg, float]]:
    """Return the legs in place of one that comes back to the corner from where it begins, if its
    velocity turns beyond the next corner; else nothing.
    """
    if before is None or leg.sticks or before.sticks:
        return []
    if (before.end, leg.end, before.edge) != (LegEnd.EDGE, LegEnd.EDGE, leg.edge):
        return []
    far = leg.band - 1 if leg.rises else leg.band
    if before.rises == leg.rises or not 0 <= far < len(law.edges) or law.edges[far].belt:
        return []
    turn = leg_end(law, leg._replace(end=LegEnd.TURN), here, guess / 2, 0.0)
    if turn is None:
        return []
    above = turn.v - law.speeds[far]
    if above == 0.0 or (above > 0.0) == leg.rises:
        return []
    K, _ = law.band(leg.band)
    bend = next_derivative(0.0, turn.v, K.fB * sin(K.Om * turn.t), K.cm, K.w0sq)
    half = sqrt(2.0 * abs(_ratio(above, bend)))
    to_corner = max(turn.t - here.t - half, 0.0)
    there = -1 if leg.rises else 1
    return [
        (leg._replace(edge=far, rises=not leg.rises), to_corner),
        (leg._replace(band=leg.band + there, edge=far), 2.0 * half),
        (leg, to_corner),
    ]


def growth_of_areas(
    law: LawInDoubles, leg: ItineraryLeg, following: ItineraryLeg, span: float, after: PointOnWay
) -> float:
    """Return the factor by which a leg, and the passage at its end, change areas of states."""
    if leg.sticks:
        return 0.0
    K, _ = law.band(leg.band)
    factor = exp(-K.cm * span)
    if leg.end is LegEnd.EDGE and law.edges[leg.edge].belt and not following.sticks:
        factor *= law.force(following.band, after.t, after.x, after.v) / after.a
    return float(factor)


def leg_end(
    law: LawInDoubles, leg: ItineraryLeg, here: PointOnWay, guess: float, section: float
) -> PointOnWay | None:
    """Return the end of a leg that begins at a point and takes about as long as `guess`; None if it
    has none near.
    """
    if leg.sticks:
        return _stick_end(law, leg, here, guess)
    K, A = law.band(leg.band)
    while guess > K.chunk:
        here = _flown(K, A, here, K.chunk)
        guess -= K.chunk
    if leg.end is LegEnd.EDGE:
        target = law.speeds[leg.edge]
    else:
        target = section
    launch = _launch(K, A, here)
    _, _, s0, c0 = launch
    turns = leg.end is LegEnd.TURN
    tau = guess
    before = inf
    for _ in range(MOST_STEPS):
        if tau < -FARTHEST_BACK * K.moment:
            return None
        functions = basis(tau, K)
        *responses, s, c = functions
        dx, dv, a = motion(*launch, K.cm, K.w0sq, K.f0, K.Om, *responses)
        v = here.v + dv
        bend = next_derivative(a, v, K.fB * (s0 * c + c0 * s), K.cm, K.w0sq)
        if turns:
            step = _ratio(-a, bend)
        else:
            step = _step_to_speed((here.v - target) + dv, a, bend, leg.rises)
        size = abs(step)
        is_rounding = size < PERHAPS_ROUNDING * K.moment and size > before / NO_PROGRESS
        if size < LAST_STEP * K.moment or is_rounding:
            break
        before = size
        longest = LONGEST_STEP * max(abs(tau), K.moment)
        tau += min(max(step, -longest), longest)
    else:
        return None
    if not turns and (a > 0.0) != leg.rises:
        return None
    if not turns and abs((here.v - target) + dv) > ON_SPEED * (abs(target) + abs(here.v)):
        return None
    end = _changed(K, here, launch, responses, tau, (dx, dv, a))
    if turns:
        late = [_ratio(-change, bend) for change in _turned(K, here, launch, responses)]
    else:
        late = [_ratio(-change, a) for change in end.dv]
    return PointOnWay(
        end.t + step,
        end.x + v * step,
        v + a * step if turns else target,
        a,
        _sum(end.dt, late, 1.0),
        _sum(end.dx, late, v),
        _sum(end.dv, late, a),
    )


def _ratio(a: float, b: float) -> float:
    """Return a/b, inf where b is 0."""
    if b == 0.0:
        return inf
    return a / b


def _step_to_speed(off: float, a: float, bend: float, rises: bool) -> float:
    """Return the time after which a velocity that is `off` a speed has it, up to the second order,
    and rises there or falls; that to its turn if it does not reach the speed.

    So the passage is found next to a turn too.
    """
    square = a * a - 2.0 * bend * off
    if square < 0.0:
        return -a / bend
    slope = sqrt(square) if rises else -sqrt(square)
    if (a > 0.0) == rises:
        return _ratio(-2.0 * off, a + slope)
    return _ratio(slope - a, bend)


def _launch(K: Constants, A: float, here: PointOnWay) -> tuple[float, float, float, float]:
    """Return velocity, acceleration, sine and cosine of the phase at the start of a flight."""
    angle = K.Om * here.t
    c = cos(angle)
    return here.v, acceleration(here.x, here.v, c, A, K.cm, K.w0sq, K.f0), sin(angle), c


def _changes_of_launch(
    K: Constants, here: PointOnWay, launch: tuple[float, ...]
) -> list[tuple[float, float, float, float]]:
    """Return by how much the start of a flight changes with the start of the motion."""
    _, _, s, c = launch
    changes = []
    for dt, dx, dv in zip(here.dt, here.dx, here.dv, strict=True):
        turn = K.Om * dt
        changes.append((dv, -K.cm * dv - K.w0sq * dx - K.f0 * s * turn, c * turn, -s * turn))
    return changes


def _changed(
    K: Constants, here: PointOnWay, launch: tuple[float, ...], responses: Sequence[float],
    tau: float, gained: tuple[float, float, float],
) -> PointOnWay:  # fmt: skip
    """Return where a flight is after a fixed time tau, in which it has gained dx, dv and a."""
    dx, dv, a = gained
    # the motion is linear in what it starts with
    changes = [
        motion(*change, K.cm, K.w0sq, K.f0, K.Om, *responses)
        for change in _changes_of_launch(K, here, launch)
    ]
    positions, velocities, _ = zip(*changes, strict=True)
    return PointOnWay(
        here.t + tau, here.x + dx, here.v + dv, a,
        here.dt, _sum(here.dx, positions, 1.0), _sum(here.dv, velocities, 1.0),
    )  # fmt: skip


def _turned(
    K: Constants, here: PointOnWay, launch: tuple[float, ...], responses: Sequence[float]
) -> list[float]:
    """Return how the acceleration after a fixed time changes with the start of the motion."""
    changes = _changes_of_launch(K, here, launch)
    return [motion(*change, K.cm, K.w0sq, K.f0, K.Om, *responses)[2] for change in changes]


def _flown(K: Constants, A: float, here: PointOnWay, tau: float) -> PointOnWay:
    """Return where a flight is after a fixed time."""
    launch = _launch(K, A, here)
    *responses, _, _ = basis(tau, K)
    gained = motion(*launch, K.cm, K.w0sq, K.f0, K.Om, *responses)
    return _changed(K, here, launch, responses, tau, gained)


def flown_in(law: LawInDoubles, leg: ItineraryLeg, start: PointOnWay, tau: float) -> PointOnWay:
    """Return where the flight of a leg is after a time."""
    K, A = law.band(leg.band)
    while tau > K.chunk:
        start = _flown(K, A, start, K.chunk)
        tau -= K.chunk
    return _flown(K, A, start, tau)


def _sum(first: Sequence[float], second: Sequence[float], factor: float) -> tuple[float, float]:
    """Return the sum of a pair and `factor` times another one."""
    a, b = first
    c, d = second
    return a + factor * c, b + factor * d


def _stick_end(
    law: LawInDoubles, leg: ItineraryLeg, here: PointOnWay, guess: float
) -> PointOnWay | None:
    """Return where a stick ends; None if the force does not reach the limit near."""
    edge = leg.band
    side = leg.edge
    V = law.speeds[edge]
    K, _ = law.band(edge)
    tau = guess
    before = inf
    for _ in range(MOST_STEPS):
        left = law.holding(edge, side, here.t + tau, here.x + V * tau)
        slope = law.holding_slope(edge, side, here.t + tau)
        if slope >= 0.0:
            return None
        step = -left / slope
        tau += step
        size = abs(step)
        if size < LAST_STEP * max(abs(tau), K.moment) or not K.driven:
            break
        if size < PERHAPS_ROUNDING * K.moment and size > before / NO_PROGRESS:
            break
        before = size
    else:
        return None
    wave = side * K.fB * sin(K.Om * (here.t + tau))
    late = [
        -(side * K.w0sq * dx + wave * dt) / slope for dt, dx in zip(here.dt, here.dx, strict=True)
    ]
    return PointOnWay(
        here.t + tau, here.x + V * tau, V, 0.0,
        _sum(here.dt, late, 1.0), _sum(here.dx, late, V), (0.0, 0.0),
    )  # fmt: skip


def itinerary_of(motion: Trajectory, rises: bool) -> Itinerary:
    """Return the itinerary of a motion from a start in a flight to its return to the same speed, both
    while the velocity `rises` or falls.
    """
    rows = motion._rows_of_constants
    is_banded = rows[0].banded
    pieces = motion._pieces
    modes = pieces[MODE_ROW].astype(int).tolist()
    numbers = pieces[BAND_ROW].astype(int).tolist()
    begins = pieces[ELAPSED_ROW].tolist()
    end = float(motion.t_end) - float(motion.t_start)
    places = list[tuple[int, bool, float]]()  # band or edge, whether it sticks, when it begins
    for mode, row, begin in zip(modes, numbers, begins, strict=True):
        sticks = mode > ON_BELT
        if sticks:
            boundary = mode - ON_BELT
            place = row + boundary - 2 if is_banded else boundary - 1
        else:
            place = row if is_banded else mode - 1
        if not places or places[-1][:2] != (place, sticks):
            places.append((place, sticks, begin))
    legs = list[ItineraryLeg]()
    spans = list[float]()
    ends = [*(begin for _, _, begin in places[1:]), end]
    for i, (place, sticks, begin) in enumerate(places):
        spans.append(ends[i] - begin)
        if i + 1 == len(places):
            legs.append(ItineraryLeg(place, sticks, LegEnd.CLOSED, -1, rises))
            continue
        later, later_sticks, _ = places[i + 1]
        if sticks:
            side = 1 if later > place else -1
            legs.append(ItineraryLeg(place, True, LegEnd.SLIP, side, False))
        elif later_sticks:
            legs.append(ItineraryLeg(place, False, LegEnd.EDGE, later, later == place))
        else:
            edge = min(place, later)
            legs.append(ItineraryLeg(place, False, LegEnd.EDGE, edge, later > place))
    _, _, _, _, v, *_ = pieces[:, 0].tolist()
    return Itinerary(tuple(legs), tuple(spans), -1, v)
