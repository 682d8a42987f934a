"""Motions without a drive: one map of an interval decides where all of them lead.

Without a drive a state is a point (x, v) of the plane, and what follows from it is unique. So two
paths may merge, but not cross. Each path that does not end in a rest goes round, and passes again
and again through the section: the states with v = 0 where the velocity falls. A path from a section
point to v = 0 again encloses those that start nearer to the rest. So the map P from a section point x
to the next one never decreases: P(a) <= P(b) for a < b. It may jump (where a path touches a belt
with static friction) and be constant (where paths merge in a stick). Three things follow, and
nothing else is used of the law:

- the section points of one motion increase or decrease for ever, so they have a limit;
- a motion from a to beyond b proves that P has no fixed point between a and b;
- if motions from a and b lead to one attractor, then so do all between them ("squeeze").

Each start is followed to its first section point alone. These points are sorted. Long motions
from a few of them, found by bisection, decide all others. A limit is accepted as a cycle where P
brings both neighbours nearer, or that on the side from which the motion came.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import inf, nan, pi, sqrt
from typing import NamedTuple

import numpy as np

from symosc.base.errors import ParameterError
from symosc.basins.kinds import Rest, oscillator_of, rest_of
from symosc.engine.state import CROSS
from symosc.friction import domain_code
from symosc.model import Model, with_section
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.tables import EventTable

#: The accuracy of events that is asked for: doubles reach it without other arithmetic.
ACCURACY = 1e-9
#: Starts that are followed together: their events take 100 bytes each.
TOGETHER = 50_000
#: A motion is followed for a time longer by this factor where its first section point is missing,
#: so many times.
LONGER = 6.0
MOST_LONGER = 7
#: Section points of a motion that are computed at a time, and in all.
RETURNS_AT_ONCE = 24
MOST_RETURNS = 20_000
#: The least unit of distances on the section.
TINY = 1e-300
#: Two section points are the same if they differ by less than this part of the largest: the errors
#: of events are smaller.
SAME = 1e-9
#: Section points that go on by less than this part of the largest have arrived: their errors are
#: of this size.
STILL = 1e-11
#: A limit is known when its distance is estimated to be less than this part of the largest point.
NEAR = 1e-7
#: The limit is the rest if its estimated distance differs from the rest's by less than this part.
BESIDE_REST = 1e-2
#: Neighbours of a limit that show whether it attracts, as parts of the largest section point.
BESIDE = (1e-3, 1e-5)
#: Where long motions show neither an attractor nor a rest, so many more points between them are
#: tried.
MOST_OPEN = 64


class FirstPoints(NamedTuple):
    """The first section points of motions, and their errors; NaN where `rests` is True (a motion
    that ends in a rest before), or where none was found.

    `t` are the times, `events` the numbers of events until then.
    """

    x: np.ndarray
    error: np.ndarray
    rests: np.ndarray
    t: np.ndarray
    events: np.ndarray


@dataclass
class Limit:
    """What section points converge to: an `x`, the rest (x is NaN), or nothing that is known."""

    kind: str  # "cycle", "rest" or "open"
    x: float = nan


OPEN = Limit("open")
AT_REST = Limit("rest")


@dataclass
class PhasePlane:
    """The section map of an oscillator without a drive.

    `wall` is the oscillator with a belt at speed 0 beside its own, which needs no friction: its
    events are the section points. `number` is its number.
    """

    model: Model
    workers: int | None = None
    rest: Rest = field(init=False)
    turn: float = field(init=False)
    held: float = field(init=False)

    def __post_init__(self) -> None:
        law = oscillator_of(self.model)
        rest = rest_of(law)
        assert rest is not None  # there is no drive, and a spring
        self.rest = rest
        if law.law.boundary_of(0):
            self.wall = law
        else:
            self.wall = with_section(law, Fraction(0))
        self.number = self.wall.law.boundary_of(0)
        self.turn = 2 * pi * sqrt(law.m / law.k)
        speeds = {n: abs(float(belt.v)) for n, belt in enumerate(law.belts, 1) if belt.v}
        self.held = sum(
            2 * float(law.law.kinetic(n) + law.law.excess(n)) / (float(law.k) * speed)
            for n, speed in speeds.items()
        )
        #: Events of a motion between two section points, at most.
        self.events_of_turn = 6 * len(self.wall.belts) + 4
        self.trap = self._trap()
        self.rest_attracts = self._rest_attracts()

    def _trap(self) -> float:
        """Return the distance from the rest within which section points stay in the bands beside
        v = 0, and come nearer; 0 if there is none.
        """
        law = oscillator_of(self.model)
        if self.rest.belt:
            return 0.0
        beside = [band for band in law.bands if _holds_zero(band.below, band.above)]
        if min(band.c for band in beside) < 0 or max(band.c for band in beside) == 0:
            return 0.0
        speeds = [abs(float(edge.v)) for edge in law.edges if edge.v]
        return min(speeds, default=inf) * sqrt(law.m / law.k)

    def _rest_attracts(self) -> bool:
        """Return whether the rest can be an attractor."""
        if self.rest.belt or self.trap:
            return True
        law = oscillator_of(self.model)
        beside = [band for band in law.bands if _holds_zero(band.below, band.above)]
        return max(band.c for band in beside) > 0

    # -- the map -----------------------------------------------------------------------------------

    def first_points(self, x: np.ndarray, v: np.ndarray) -> FirstPoints:
        """Return where motions from x and v first pass through the section, the start not counted."""
        count = len(x)
        found = FirstPoints(
            np.full(count, nan),
            np.zeros(count),
            np.zeros(count, dtype=bool),
            np.full(count, nan),
            np.zeros(count, np.int64),
        )
        for begin in range(0, len(x), TOGETHER):
            rows = np.arange(begin, min(begin + TOGETHER, len(x)))
            span = 1.1 * self.turn + min(self.held, self.turn)
            for _ in range(MOST_LONGER):
                rows = self._first_points(x, v, rows, span, found)
                if not len(rows):
                    break
                span = LONGER * span + self.held
        return found

    def _first_points(
        self, x: np.ndarray, v: np.ndarray, rows: np.ndarray, span: float, found: FirstPoints
    ) -> np.ndarray:
        """Fill `found` for some rows; return the rows without a point, which may have one later."""
        starts = np.column_stack([np.zeros(len(rows)), x[rows], v[rows]])
        table = simulate_many(
            self.wall, starts, span, accuracy=ACCURACY, workers=self.workers,
            max_events=self.events_of_turn,
        )  # fmt: skip
        downward = self._downward(table)
        motions, firsts = np.unique(table.trajectory[downward], return_index=True)
        places = np.flatnonzero(downward)[firsts]
        found.x[rows[motions]] = table.x[places]
        found.error[rows[motions]] = table.x_error[places]
        found.t[rows[motions]] = table.t[places]
        found.events[rows[motions]] = places - np.searchsorted(table.trajectory, motions)
        status = np.array(table.status)
        ended = status == "equilibrium"
        ended[motions] = False
        found.rests[rows[ended]] = True
        later = status == "t_end"
        later[motions] = False
        return rows[later]

    def _downward(self, table: EventTable) -> np.ndarray:
        """Return which events of a table are section points."""
        downward: np.ndarray = (
            (table.boundary == self.number)
            & (table.kind_code == CROSS)
            & (table.target_code == domain_code(self.number))
        )
        return downward

    def next_points(self, x: np.ndarray) -> np.ndarray:
        """Return P(x) for section points, NaN where the mass comes to rest."""
        return self.first_points(np.asarray(x, dtype=float), np.zeros(len(x))).x

    def paths(self, x: np.ndarray, count: int) -> list[tuple[np.ndarray, bool]]:
        """Return for each section point in `x` up to `count` next ones, and whether its motion comes
        to rest then.
        """
        starts = np.column_stack([np.zeros(len(x)), x, np.zeros(len(x))])
        span = 1.5 * count * (self.turn + self.held)
        table = simulate_many(
            self.wall, starts, span, accuracy=ACCURACY, workers=self.workers,
            max_events=count * self.events_of_turn,
        )  # fmt: skip
        downward = self._downward(table)
        cuts = np.searchsorted(table.trajectory, np.arange(len(x) + 1))
        paths = []
        for i, status in enumerate(table.status):
            part = slice(cuts[i], cuts[i + 1])
            points = table.x[part][downward[part]]
            paths.append((points[:count], status == "equilibrium" and len(points) <= count))
        return paths

    def return_time(self, x: float) -> float:
        """Return the time from a section point of a cycle to the next one."""
        return float(self.first_points(np.array([x]), np.zeros(1)).t[0])

    # -- limits ------------------------------------------------------------------------------------

    def limits(self, x: np.ndarray) -> list[Limit]:
        """Return what the section points from each in `x` on converge to."""
        limits: list[Limit | None] = [None] * len(x)
        last = np.array(x, dtype=float)
        sizes = np.maximum(last - self.rest.high, TINY)
        for _ in range(-(-MOST_RETURNS // RETURNS_AT_ONCE)):
            waiting = np.array([i for i, limit in enumerate(limits) if limit is None], dtype=int)
            if not len(waiting):
                break
            for i, (points, rests) in zip(
                waiting.tolist(), self.paths(last[waiting], RETURNS_AT_ONCE), strict=True
            ):
                path = np.concatenate([[last[i]], points])
                limits[i] = self._limit_of(path, rests, sizes[i])
                if len(points):
                    last[i] = points[-1]
                elif limits[i] is None:
                    limits[i] = OPEN
        return [self._confirmed(limit or OPEN) for limit in limits]

    def _limit_of(self, points: np.ndarray, rests: bool, size: float) -> Limit | None:
        """Return the limit of successive section points; None if it is not known yet."""
        beyond = points[-1] - self.rest.high
        if rests or beyond < self.trap or beyond <= STILL * size:
            return AT_REST
        if len(points) < 3:
            return None
        first, second, third = points[-3:].tolist()
        step = third - second
        before = second - first
        if max(abs(step), abs(before)) <= STILL * size:
            return Limit("cycle", third)
        if abs(step) >= abs(before):
            return None
        ratio = step / before
        left = step * ratio / (1.0 - ratio)
        if abs(left) > NEAR * size:
            return None
        if abs(beyond + left) <= BESIDE_REST * beyond:
            return AT_REST
        return Limit("cycle", third + left)

    def _confirmed(self, limit: Limit) -> Limit:
        """Return a limit if it attracts neighbours on one side at least, else OPEN."""
        if limit.kind != "cycle":
            return limit
        size = limit.x - self.rest.high
        for part in BESIDE:
            step = part * size
            low, high = self.next_points(np.array([limit.x - step, limit.x + step]))
            noise = SAME * size
            if low > limit.x - step + noise or high < limit.x + step - noise:
                return limit
        return OPEN

    # -- starts ------------------------------------------------------------------------------------

    def decide(self, starts: np.ndarray) -> tuple[np.ndarray, list[Limit]]:
        """Return for each row t0, x0, v0 the number of its attractor (-1: undecided), and the
        attractors.
        """
        first = self.first_points(starts[:, 1], starts[:, 2])
        kinds = FoundLimits(self)
        numbers = np.full(len(starts), -1)
        if first.rests.any() and self.rest_attracts:
            numbers[first.rests] = kinds.number(AT_REST)
        known = np.flatnonzero(np.isfinite(first.x))
        order = known[np.argsort(first.x[known], kind="stable")]
        if len(order):
            numbers[order] = self._squeezed(first.x[order], first.error[order], kinds)
        return numbers, kinds.found

    def _squeezed(self, x: np.ndarray, error: np.ndarray, kinds: FoundLimits) -> np.ndarray:
        """Return the attractors of sorted section points, from long motions of as few as possible."""
        numbers = np.full(len(x), -1)
        tried = np.zeros(len(x), dtype=bool)

        def follow(places: Sequence[int]) -> None:
            for place, limit in zip(places, self.limits(x[list(places)]), strict=True):
                numbers[place] = kinds.number(limit)
                tried[place] = True

        follow(sorted({0, len(x) - 1}))
        parts = [(0, len(x) - 1)]
        least = max(1, len(x) // MOST_OPEN)
        while parts:
            middles = list[tuple[int, int, int]]()
            for low, high in parts:
                if high - low < 2:
                    continue
                if numbers[low] == numbers[high] >= 0:
                    numbers[low:high] = numbers[low]
                elif numbers[low] != numbers[high] or high - low > least:
                    middles.append((low, (low + high) // 2, high))
            if middles:
                follow([middle for _, middle, _ in middles])
            parts = [part for low, mid, high in middles for part in ((low, mid), (mid, high))]
        # Where the error of a point could move it into another basin, nothing is decided.
        close = (numbers[1:] != numbers[:-1]) & (np.diff(x) <= error[1:] + error[:-1])
        for place in np.flatnonzero(close).tolist():
            numbers[place : place + 2] = -1
        return numbers


class FoundLimits:
    """The different limits that have been found, in order."""

    def __init__(self, plane: PhasePlane) -> None:
        self.plane = plane
        self.found = list[Limit]()

    def number(self, limit: Limit) -> int:
        """Return the number of a limit, -1 if it is open; a new one gets the next number."""
        if limit.kind == "open" or (limit.kind == "rest" and not self.plane.rest_attracts):
            return -1
        for n, known in enumerate(self.found):
            if known.kind == limit.kind and (limit.kind == "rest" or self._same(known, limit)):
                return n
        self.found.append(limit)
        return len(self.found) - 1

    def _same(self, known: Limit, limit: Limit) -> bool:
        distance = max(known.x, limit.x) - self.plane.rest.high
        return abs(known.x - limit.x) <= 10 * NEAR * distance


def _holds_zero(below: Fraction | None, above: Fraction | None) -> bool:
    """Return whether a band between two speeds lies at the speed 0, or ends there."""
    return (below is None or below <= 0) and (above is None or above >= 0)


def require_spring(model: Model) -> None:
    """Raise ParameterError for an oscillator without a spring: its motions settle nowhere."""
    if model.k == 0:
        raise ParameterError("k", 0, "must be > 0: without a spring the mass settles nowhere")
