"""Curves of periodic orbits of any friction law over one parameter, through folds, stable or not.

The unknowns are a passage through a section (`symosc.orbits.return_maps`) and the parameter. Newton's
method on the return map and on the arclength has the exact derivatives of both, also by the
parameter. The motions are those of the law, so that every point is an orbit with its word, followed
by the engine. A step whose orbit has another word, or that finds none, is made shorter, until what
is left is below the resolution: there the branch ends.

What becomes of an orbit at an end is seen from the orbit there: a turn of a flight at the speed of a
belt is a graze, a stick of no length vanishes, a crossing at the limit of friction turns into a
stick. With static friction a graze is a stick at once, and beyond it there need be no orbit near.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, pi
from typing import NamedTuple

import numpy as np

from symosc.base.display.progress import Advance
from symosc.base.errors import ParameterError
from symosc.kernels import linear
from symosc.model import Model
from symosc.orbits.followed_orbit import FollowedOrbit, followed_orbit
from symosc.orbits.law_margins import margins
from symosc.orbits.return_maps import Passage, SpeedSection, quality_of, section_through

#: Lengths of steps, in the arclength of (time/pace, x/size, parameter/range).
FIRST_STEP = 0.01
LONGEST_STEP = 0.04
#: Ends are located to this part of the range; a piece on the way must not be shorter.
RESOLUTION = 4e-12
#: Steps that are tried beyond an end, so that it is none of the step before.
TRIED_AGAIN = (8 * RESOLUTION, 1e-9)
GROWTH = 1.5
#: A step is too long if the tangent turns by more than what this cosine says.
LEAST_COSINE = 0.95
#: A correction is longer than the step by at most this factor.
LONGEST_CORRECTION = 0.5
#: Newton's steps of a correction at most, and the residuals that are small enough.
MOST_CORRECTIONS = 6
FOUND = 1e-13
GOOD = 1e-11
MOST_HALVINGS = 1
#: A section is given up if it is less steep and nearer to a belt than FINE_SECTION, and worse than
#: this part of the best.
FINE_SECTION = 0.6
POOR_SECTION = 0.7
ANY_BETTER = 0.98
#: On a shorter step no gap is looked for, and so little at least the parameter counts as changed.
NO_GAP = 1e-5
LEAST_AWAY = 1e-9
#: Steps to an event of the curve, and the change of the parameter, as a part of its range, to which
#: it is located.
MOST_LOCATING = 60
#: A cycle that is smaller than this part of the first one has shrunk to a rest.
SHRUNK = 1e-4
#: Samples of an orbit for its extent.
SAMPLES = 1024
#: Points before the curve may be closed.
LEAST_LOOP = 12


class CurvePoint(NamedTuple):
    """An orbit on the curve: the parameter, the passage, the period, the derivatives of the return
    map by t, x and the parameter, the tangent in scaled unknowns, and the orbit.
    """

    value: float
    section: SpeedSection
    t: float
    x: float
    span: float
    changes: np.ndarray
    tangent: np.ndarray
    orbit: FollowedOrbit


class CurveEvent(NamedTuple):
    """A place of the curve where a multiplier passes the unit circle."""

    kind: str
    value: float
    point: CurvePoint


class LawCurveEnd(NamedTuple):
    """Why the curve ends: "range", "lost", "shrunk", "closed" or "most", at a value of the
    parameter.
    """

    why: str
    value: float


@dataclass
class LawCurve:
    """The curve of orbits through a first one, over a parameter.

    `size` and `pace` are the units of positions and times.
    """

    first: FollowedOrbit
    parameter: str
    low: float
    high: float

    def __post_init__(self) -> None:
        assert self.first.motion is not None
        assert self.first._section is not None
        self.model = self.first.parameters
        self.periods = self.first.periods
        times = np.linspace(float(self.first.motion.t_start), float(self.first.motion.t_end), 513)
        xs, _ = self.first.motion(times)
        self.size = float(np.ptp(xs))
        self.pace = float(self.first.period) / (2 * pi * max(1, self.periods))
        self.scale = np.array([self.pace, self.size, self.high - self.low])
        self.value = float(self.model.numbers()[self.parameter])
        self.passages = 0

    # -- one point ---------------------------------------------------------------------------------

    def law(self, value: float) -> Model:
        """Return the oscillator at a value of the parameter."""
        return self.model.replace(**{self.parameter: value})

    def span_of(self, value: float, span: float) -> float:
        """Return the period at a value of the parameter; without a drive that is `span`."""
        if not self.periods:
            return span
        Omega = value if self.parameter == "Omega" else float(self.model.Omega)
        return 2 * pi * self.periods / Omega

    def passage(
        self, section: SpeedSection, z: np.ndarray, span: float
    ) -> tuple[SpeedSection, Passage, float] | None:
        """Return section, passage and period for the unknowns z = (t, x, value); None if the motion
        does not come back.
        """
        t, x, value = (z * self.scale).tolist()
        try:
            section = replace(section, law=self.law(value))
            span = self.span_of(value, span)
            end = section.passage(t, x, span, ("t0", "x0", self.parameter))
        except (ParameterError, OverflowError):
            return None
        self.passages += 1
        if end is None or not np.isfinite(end.changes).all():
            return None
        if not self.periods:
            span = end.t - t
        return section, end, span

    def equations(self, z: np.ndarray, end: Passage, span: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual of the return map and its derivatives by the unknowns, both scaled.

        Without a drive the time has no equation, but is kept where it is.
        """
        t, x, value = (z * self.scale).tolist()
        rows = end.changes.astype(float) * self.scale
        if self.periods:
            residual = np.array([end.t - t - span, end.x - x])
            rows[0, 0] -= self.scale[0]
            if self.parameter == "Omega":
                rows[0, 2] += span / value * self.scale[2]
        else:
            residual = np.array([0.0, end.x - x])
            rows[0] = (self.scale[0], 0.0, 0.0)
            rows[1, 0] = 0.0
        rows[1, 1] -= self.scale[1]
        units = self.scale[:2]
        return residual / units, rows / units[:, None]

    def tangent(self, rows: np.ndarray, like: np.ndarray) -> np.ndarray:
        """Return the unit vector along the curve, in the direction of another."""
        (a, b, c), (d, e, f) = rows.tolist()
        across = np.array([b * f - c * e, c * d - a * f, a * e - b * d])
        length = linear.norm(across)
        if length == 0.0:
            return like
        across = across / length
        if linear.dot(across, like) < 0:
            return -across
        return across

    def corrected(
        self, section: SpeedSection, guess: np.ndarray, span: float, along: np.ndarray
    ) -> tuple[np.ndarray, SpeedSection, Passage, float, np.ndarray] | None:
        """Return the point of the curve in the plane through `guess` across `along`, None if
        Newton's method finds none near.
        """
        z = guess
        found = self.passage(section, z, span)
        if found is None:
            return None
        for _ in range(MOST_CORRECTIONS):
            section, end, span = found
            residual, rows = self.equations(z, end, span)
            miss = float(np.abs(residual).max())
            if miss < FOUND:
                return z, section, end, span, rows
            try:
                step = -linear.solve(
                    np.vstack([rows, along]), np.append(residual, linear.dot(z - guess, along))
                )
            except ZeroDivisionError:
                return None
            part = 1.0
            for _ in range(MOST_HALVINGS):
                later = self.passage(section, z + part * step, span)
                if later is not None:
                    off, _ = self.equations(z + part * step, later[1], later[2])
                    if float(np.abs(off).max()) < miss:
                        break
                part /= 4
            else:
                if miss < GOOD:
                    return z, section, end, span, rows
                return None
            z = z + part * step
            found = later
        section, end, span = found
        residual, rows = self.equations(z, end, span)
        if float(np.abs(residual).max()) < GOOD:
            return z, section, end, span, rows
        return None

    def unknowns(self, point: CurvePoint) -> np.ndarray:
        """Return the scaled unknowns of a point."""
        return np.array([point.t, point.x, point.value]) / self.scale

    def point_near(
        self, point: CurvePoint, step: float, along: np.ndarray | None = None
    ) -> CurvePoint | None:
        """Return the orbit with the same word a step along the tangent from a point, None if none is
        found near.
        """
        z = self.unknowns(point)
        guess = z + step * point.tangent
        across = point.tangent if along is None else along
        found = self.corrected(point.section, guess, point.span, across)
        if found is None:
            return None
        z_new, section, end, span, rows = found
        if linear.norm(z_new - guess) > LONGEST_CORRECTION * abs(step) + GOOD:
            return None
        tangent = self.tangent(rows, point.tangent)
        if linear.dot(tangent, point.tangent) < LEAST_COSINE:
            return None
        return self.as_point(z_new, section, end, span, tangent)

    def as_point(
        self, z: np.ndarray, section: SpeedSection, end: Passage, span: float, tangent: np.ndarray
    ) -> CurvePoint | None:
        """Return a point of the curve with its orbit; None if the motion does not close, or has
        another word.
        """
        t, x, value = (z * self.scale).tolist()
        orbit = followed_orbit(section, t, x, span, self.periods, end.changes[:, :2], 0.0, 0, None)
        if orbit is None or orbit.labels != self.first.labels:
            return None
        return CurvePoint(value, section, t, x, span, end.changes, tangent, orbit)

    def begin(self, direction: float) -> CurvePoint | None:
        """Return the first point, with the tangent in a direction of the parameter."""
        section = self.first._section
        assert section is not None
        assert self.first.motion is not None
        t = float(self.first.motion.t_start)
        z = np.array([t, float(self.first.start[1]), self.value]) / self.scale
        along = np.array([0.0, 0.0, 1.0])
        found = self.corrected(section, z, float(self.first.period), along)
        if found is None:
            return None
        z, section, end, span, rows = found
        tangent = self.tangent(rows, direction * along)
        return self.as_point(z, section, end, span, tangent)

    def with_better_section(
        self, points: list[CurvePoint], enough: float = POOR_SECTION
    ) -> tuple[CurvePoint, bool]:
        """Return the last point, with another section where its own has become poor, worse than
        `enough` of the best; and whether it has another one.
        """
        point = points[-1]
        assert point.orbit.motion is not None
        quality = quality_of(point.orbit.motion, point.section)
        if quality > FINE_SECTION:
            return point, False
        section = section_through(point.orbit.motion)
        if section is None or quality > enough * quality_of(point.orbit.motion, section):
            return point, False
        z = self.passed(point, section)
        if z is None:
            return point, False
        along = np.array([0.0, 0.0, 1.0 if point.tangent[2] > 0 else -1.0])
        if len(points) > 1:
            # Where the parameter turns back the orbit before tells where the curve goes on.
            before = self.passed(points[-2], section)
            if before is None:
                return point, False
            along = z - before
        found = self.corrected(section, z, point.span, along / linear.norm(along))
        if found is None:
            return point, False
        z, section, end, span, rows = found
        better = self.as_point(z, section, end, span, self.tangent(rows, along))
        return better or point, better is not None

    def passed(self, point: CurvePoint, section: SpeedSection) -> np.ndarray | None:
        """Return the scaled unknowns of an orbit at another section; None if it does not pass it."""
        section = replace(section, law=self.law(point.value))
        motion = section.motion(point.t, point.x, point.section.speed, 1.02 * point.span)
        passages = section.passages(motion)
        if not passages:
            return None
        event = motion.events[passages[0]]
        t = event.t
        if self.periods:
            turn = self.span_of(point.value, point.span) / self.periods
            # Both orbits at a change of the section begin in the same turn.
            t -= turn * np.floor((t - point.t) / turn)
        else:
            t = 0.0
        return np.array([t, event.x, point.value]) / self.scale

    # -- along the curve ---------------------------------------------------------------------------

    def follow(
        self, direction: float, most: int, advance: Advance = None
    ) -> tuple[list[CurvePoint], list[CurveEvent], LawCurveEnd]:
        """Follow the curve in a direction of the parameter; return its points, events and end."""
        point = self.begin(direction)
        if point is None:
            return [], [], LawCurveEnd("lost", self.value)
        points = [point]
        events = list[CurveEvent]()
        step = FIRST_STEP
        bad = inf  # the arclength from the last point to one that was not found
        retried = 0
        first_extent = self.extent(point)
        examined = 0  # points whose section has been looked at, and twice if a step failed there
        tried_any = 0
        while len(points) < most:
            if examined < len(points):
                examined = len(points)
                points[-1], changed = self.with_better_section(points)
                if changed:
                    bad = inf
                    step = max(step, FIRST_STEP / 10)
            point = points[-1]
            trial = min(step, bad / 2)
            later = self.point_near(point, trial)
            if later is None and tried_any < len(points):
                # The section may be in the way: the next orbits need not pass it.
                tried_any = len(points)
                points[-1], changed = self.with_better_section(points, ANY_BETTER)
                if changed:
                    continue
            if later is None:
                bad = trial
                step = trial / 2
                if trial > RESOLUTION:
                    continue
                if retried < len(TRIED_AGAIN):
                    step = TRIED_AGAIN[retried]
                    retried += 1
                    bad = inf
                    continue
                return points, events, LawCurveEnd("lost", points[-1].value)
            if not self.low <= later.value <= self.high:
                last = self.at_limit(point, later)
                if last is not None:
                    events += self.events_between(point, last)
                    points.append(last)
                    return points, events, LawCurveEnd("range", last.value)
                bad = trial
                step = trial / 2
                if trial <= RESOLUTION:
                    return points, events, LawCurveEnd("lost", point.value)
                continue
            if trial > NO_GAP and self.may_have_gap([*points[-2:], later]):
                step = trial / 2
                continue
            events += self.events_between(point, later)
            points.append(later)
            bad -= trial
            retried = 0
            if bad < RESOLUTION / 4:
                bad = inf
            step = min(trial * GROWTH, LONGEST_STEP)
            if advance:
                advance(abs(later.value - self.value) / (self.high - self.low), len(points))
            if self.extent(later) < SHRUNK * first_extent:
                return points, events, LawCurveEnd("shrunk", self.shrunk_value(points))
            if self.is_closed(points):
                return points, events, LawCurveEnd("closed", later.value)
        return points, events, LawCurveEnd("most", points[-1].value)

    def may_have_gap(self, points: list[CurvePoint]) -> bool:
        """Return whether a margin of the orbits, a parabola through three points of the curve, is
        negative between the last two.
        """
        if len(points) < 3:
            return False
        tables = [
            {(margin.piece, margin.text): margin for margin in margins(point.orbit, sticks=False)}
            for point in points
        ]
        places = [0.0]
        for before, after in pairwise(points):
            away = (after.value - before.value) / self.scale[2]
            places.append(places[-1] + max(abs(away), LEAST_AWAY))
        for key in tables[0].keys() & tables[1].keys() & tables[2].keys():
            values = [table[key].value for table in tables]
            if _lowest_between(places, values) < 0.0:
                return True
        return False

    def extent(self, point: CurvePoint) -> float:
        """Return the extent of an orbit's velocities."""
        assert point.orbit.motion is not None
        motion = point.orbit.motion
        times = np.linspace(float(motion.t_start), float(motion.t_end), SAMPLES)
        _, v = motion(times)
        return _highest(v) + _highest(-v)

    def shrunk_value(self, points: list[CurvePoint]) -> float:
        """Return where a cycle that shrinks in proportion has no size."""
        before, last = points[-2:]
        sizes = self.extent(before), self.extent(last)
        slope = (last.value - before.value) / (sizes[1] - sizes[0])
        return last.value - sizes[1] * slope

    def is_closed(self, points: list[CurvePoint]) -> bool:
        """Return whether the curve is back at its first point."""
        if len(points) < LEAST_LOOP or points[0].section.speed != points[-1].section.speed:
            return False
        off = self.unknowns(points[-1]) - self.unknowns(points[0])
        same_way = linear.dot(points[-1].tangent, points[0].tangent) > LEAST_COSINE
        return (
            same_way
            and linear.norm(off) < LONGEST_STEP / 2
            and linear.dot(off, points[0].tangent) < 0
        )

    def at_limit(self, before: CurvePoint, beyond: CurvePoint) -> CurvePoint | None:
        """Return the orbit at the limit of the range between two points."""
        limit = self.high if beyond.value > self.high else self.low
        part = (limit - before.value) / (beyond.value - before.value)
        z = self.unknowns(before)
        guess = z + part * (self.unknowns(beyond) - z)
        guess[2] = limit / self.scale[2]
        along = np.array([0.0, 0.0, 1.0])
        found = self.corrected(before.section, guess, before.span, along)
        if found is None:
            return None
        z, section, end, span, rows = found
        point = self.as_point(z, section, end, span, self.tangent(rows, before.tangent))
        return point and point._replace(value=limit)

    # -- events ------------------------------------------------------------------------------------

    def tests(self, point: CurvePoint) -> dict[str, float]:
        """Return functions along the curve that pass 0 where a multiplier passes the unit circle."""
        first, second = (complex(value) for value in point.orbit.multipliers)
        functions = {"fold": float(point.tangent[2])}
        if not self.periods:
            own = first if second == 1 else second
            return functions | {"period doubling": 1 + own.real}
        trace = (first + second).real
        determinant = (first * second).real
        functions["period doubling"] = 1 + trace + determinant
        if abs(trace) < 2:  # else the two are real where their product is 1
            functions["Neimark-Sacker"] = 1 - determinant
        return functions

    def events_between(self, before: CurvePoint, after: CurvePoint) -> Iterator[CurveEvent]:
        """Yield the events between two points of the curve with one section."""
        start = self.tests(before)
        end = self.tests(after)
        for kind in start.keys() & end.keys():
            if start[kind] * end[kind] < 0:
                point = self.located(kind, before, after)
                if point is not None:
                    yield CurveEvent(kind, point.value, point)

    def located(self, kind: str, before: CurvePoint, after: CurvePoint) -> CurvePoint | None:
        """Return the point between two at which a test function is 0, by bracketed secants along the
        tangent of the first.
        """
        z = self.unknowns(before)
        whole = linear.dot(self.unknowns(after) - z, before.tangent)
        low, high = 0.0, whole
        f_low, f_high = self.tests(before)[kind], self.tests(after)[kind]
        point = after
        for n in range(MOST_LOCATING):
            middle = low - f_low * (high - low) / (f_high - f_low)
            if n % 3 == 2:
                middle = (low + high) / 2
            trial = self.point_near(before, middle)
            if trial is None or kind not in self.tests(trial):
                return None
            moved = abs(trial.value - point.value)
            point = trial
            value = self.tests(trial)[kind]
            if value == 0 or (moved < RESOLUTION * self.scale[2] and n > 3):
                break
            if high - low < RESOLUTION * whole:
                break
            if value * f_low < 0:
                high, f_high = middle, value
            else:
                low, f_low = middle, value
        return point


def _highest(v: np.ndarray) -> float:
    """Return the maximum of a velocity from its samples, by a parabola through the highest three."""
    n = min(max(int(v.argmax()), 1), len(v) - 2)
    before, here, after = v[n - 1 : n + 2].tolist()
    bend = before - 2 * here + after
    if bend >= 0.0:
        return float(v.max())
    return float(here - (after - before) ** 2 / (8 * bend))


def _lowest_between(places: list[float], values: list[float]) -> float:
    """Return the least value of the parabola through three points between the last two."""
    first, middle, last = places
    slope = (values[2] - values[1]) / (last - middle)
    before = (values[1] - values[0]) / (middle - first)
    bend = (slope - before) / (last - first)
    if bend <= 0.0:
        return min(values[1:])
    lowest = (middle + last) / 2 - slope / (2 * bend)
    if not middle < lowest < last:
        return min(values[1:])
    return values[1] + (lowest - middle) * (slope + bend * (lowest - last))
