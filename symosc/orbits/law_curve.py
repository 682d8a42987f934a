"""Curves of periodic orbits of any friction law over one parameter, through folds, stable or not.

The unknowns are a passage through a section (`symosc.orbits.return_maps`) and the parameter. Newton's
method follows the motion along the itinerary of the orbit before (`symosc.orbits.itinerary`). Then
the engine follows it: every point is an orbit of the law with its word. Where a step finds none, or
an orbit with another word, the end is looked for as the zero of an inequality
(`symosc.orbits.law_border`). Where that is not found the step is made shorter, until what is left is
below the resolution: there the branch ends.

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
from symosc.orbits.itinerary import Itinerary, LawInDoubles, MotionOnWay, itinerary_of
from symosc.orbits.law_border import BorderAhead, border_ahead
from symosc.orbits.law_margins import margins
from symosc.orbits.return_maps import SpeedSection, quality_of, section_through
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import BAND_ROW, Trajectory

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
#: Where the curve goes along the parameter by more than this, corrections keep its value.
ALONG_PARAMETER = 0.5
#: A correction is longer than the step by at most this factor.
LONGEST_CORRECTION = 0.5
#: Newton's steps of a correction at most, and the residuals that are small enough.
MOST_CORRECTIONS = 6
FOUND = 1e-13
GOOD = 1e-11
#: How often a correction begins again, where the motion passes other corners than the one before.
MOST_ITINERARIES = 6
#: The change of the parameter, as a part of its range, in difference quotients; and how many laws in
#: doubles are kept.
DIFFERENCE = 1e-7
MOST_KEPT = 16
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
#: At most so many inequalities may be those that fail at an end, the nearest to 0 first; and so often
#: the end is computed anew from an orbit nearer to it.
MOST_REASONS = 4
MOST_NEARER = 8
#: So far before an end, in parts of RESOLUTION, is the last orbit; beyond it there is none after this
#: part of the range.
BEFORE_END = 2
BEYOND_END = 1e-9
#: The least part of the way to an end that is tried.
LEAST_PART = 1e-9
#: An end is looked for as far ahead as this times the step that found no orbit.
REACH = 2.0
#: A value of the parameter is an end of the range within this part of it.
ROUNDING = 1e-15
#: Points before the curve may be closed.
LEAST_LOOP = 12


class CurvePoint(NamedTuple):
    """An orbit on the curve: the parameter, the passage, the period, the derivatives of the return
    map by t and x, the tangent in scaled unknowns, the orbit, its itinerary, and its margins without
    those of the forces during sticks.
    """

    value: float
    section: SpeedSection
    t: float
    x: float
    span: float
    changes: np.ndarray
    tangent: np.ndarray
    orbit: FollowedOrbit
    itinerary: Itinerary
    margins: dict[tuple[int, str], float]


class PointFound(NamedTuple):
    """A point that Newton's method found: scaled unknowns, the motion along the itinerary, the
    period, and the derivatives of the equations by the unknowns.
    """

    z: np.ndarray
    followed: MotionOnWay
    span: float
    rows: np.ndarray


class CurveEvent(NamedTuple):
    """A place of the curve where a multiplier passes the unit circle."""

    kind: str
    value: float
    point: CurvePoint


class LawCurveEnd(NamedTuple):
    """Why the curve ends: "range", "lost", "shrunk", "family", "closed" or "most", at a value of the
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
        self._models = dict[float, Model]()
        self._laws = dict[float, LawInDoubles]()

    # -- one point ---------------------------------------------------------------------------------

    def law(self, value: float) -> Model:
        """Return the oscillator at a value of the parameter."""
        if value not in self._models:
            while len(self._models) >= MOST_KEPT:  # the oldest goes
                del self._models[next(iter(self._models))]
            self._models[value] = self.model.replace(**{self.parameter: value})
        return self._models[value]

    def span_of(self, value: float, span: float) -> float:
        """Return the period at a value of the parameter; without a drive that is `span`."""
        if not self.periods:
            return span
        Omega = value if self.parameter == "Omega" else float(self.model.Omega)
        return 2 * pi * self.periods / Omega

    def in_doubles(self, value: float) -> LawInDoubles:
        """Return the law in doubles at a value of the parameter."""
        if value not in self._laws:
            while len(self._laws) >= MOST_KEPT:  # the oldest goes
                del self._laws[next(iter(self._laws))]
            self._laws[value] = LawInDoubles(self.law(value))
        return self._laws[value]

    def split(self, z: np.ndarray) -> tuple[float, float, float]:
        """Return time, position and the value of the parameter for scaled unknowns."""
        t, x, value = (z * self.scale).tolist()
        for bound in (self.low, self.high):  # beyond it there may be no law, by a rounding
            if abs(value - bound) <= ROUNDING * abs(bound):
                value = bound
        return t, x, value

    def passage(self, itinerary: Itinerary, z: np.ndarray) -> MotionOnWay | None:
        """Return the motion along an itinerary for the unknowns z = (t, x, value), None if there is
        none.
        """
        t, x, value = self.split(z)
        try:
            followed = itinerary.follow(self.in_doubles(value), t, x)
        except (ParameterError, OverflowError):
            return None
        if followed is None or not np.isfinite(followed.changes).all():
            return None
        return followed

    def residual(self, z: np.ndarray, followed: MotionOnWay, span: float) -> np.ndarray:
        """Return by how much the motion misses its start, in time and position, scaled.

        Without a drive the time has no equation.
        """
        t, x, value = (z * self.scale).tolist()
        late = 0.0
        if self.periods:
            late = followed.end.t - t - self.span_of(value, span)
        return np.array([late, followed.end.x - x]) / self.scale[:2]

    def slope(
        self, itinerary: Itinerary, z: np.ndarray, followed: MotionOnWay, span: float
    ) -> np.ndarray | None:
        """Return the derivatives of the residual by the scaled parameter, as a difference quotient;
        None if there are no motions beside z.
        """
        here = self.residual(z, followed, span)
        for shift in (DIFFERENCE, -DIFFERENCE):
            beside = z + np.array([0.0, 0.0, shift])
            later = self.passage(itinerary, beside)
            if later is not None:
                return np.asarray((self.residual(beside, later, span) - here) / shift)
        return None

    def rows(self, followed: MotionOnWay, slope: np.ndarray) -> np.ndarray:
        """Return the derivatives of the residual by the scaled unknowns.

        Without a drive the time is kept where it is.
        """
        rows = followed.changes - np.eye(2)
        if not self.periods:
            rows = np.array([[1.0, 0.0], [0.0, rows[1, 1]]])
        units = self.scale[:2]
        return np.column_stack([rows * units / units[:, None], slope])

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
        self,
        itinerary: Itinerary,
        begin: np.ndarray,
        guess: np.ndarray,
        span: float,
        along: np.ndarray,
    ) -> PointFound | None:
        """Return the point of the curve in the plane through `guess` across `along`, None if
        Newton's method finds none near `begin`.
        """
        z = begin
        followed = self.passage(itinerary, z)
        keeps_value = not along[:2].any() and z[2] == guess[2]
        slope = np.zeros(2) if keeps_value else None
        for _ in range(MOST_CORRECTIONS):
            if followed is None:
                return None
            residual = self.residual(z, followed, span)
            miss = float(np.abs(residual).max())
            if miss < FOUND and slope is not None:
                break
            if slope is None:  # good enough for all steps
                slope = self.slope(itinerary, z, followed, span)
            if slope is None:
                return None
            right = np.append(residual, linear.dot(z - guess, along))
            try:
                step = -linear.solve(np.vstack([self.rows(followed, slope), along]), right)
            except ZeroDivisionError:
                return None
            if keeps_value:  # to the bit
                step[2] = 0.0
            later = self.passage(itinerary, z + step)
            if later is None:
                return None
            off = float(np.abs(self.residual(z + step, later, span)).max())
            if off >= miss:
                break
            z = z + step
            followed = later
        if followed is None or float(np.abs(self.residual(z, followed, span)).max()) >= GOOD:
            return None
        slope = self.slope(itinerary, z, followed, span)
        if slope is None:
            return None
        if not self.periods:
            t, _, _ = (z * self.scale).tolist()
            span = followed.end.t - t
        else:
            span = self.span_of(float(z[2] * self.scale[2]), span)
        return PointFound(z, followed, span, self.rows(followed, slope))

    def point_across(
        self,
        section: SpeedSection,
        itinerary: Itinerary,
        guess: np.ndarray,
        span: float,
        across: np.ndarray,
        like: np.ndarray,
        any_word: bool = False,
        before: np.ndarray | None = None,
    ) -> CurvePoint | None:
        """Return the orbit in the plane through `guess` across a direction, with a tangent like
        another; None if none is found near, or only one with another word unless that is allowed.
        `before` are the unknowns of an orbit from which the next one is looked for.

        The engine follows it. Where its motion passes other corners than the itinerary, it gives the
        next itinerary.
        """
        begins = [guess]
        if before is not None and not across[:2].any():
            # From the guess the motion may not reach the belt, from where it was it does.
            begins.append(np.append(before[:2], guess[2]))
        for _ in range(MOST_ITINERARIES):
            found = None
            for begin in begins:
                found = found or self.corrected(itinerary, begin, guess, span, across)
            if found is None:
                return None
            begins = [found.z]
            t, x, value = self.split(found.z)
            try:
                section = replace(section, law=self.law(value))
            except ParameterError:
                return None
            motion = self.motion(section, t, x, found.span)
            seen = itinerary_of(motion, section.upwards)
            is_seen = seen.legs == itinerary.legs
            itinerary = seen
            if is_seen or not (any_word or is_along(motion, self.first.labels)):
                break
        assert found is not None
        tangent = self.tangent(found.rows, like)
        return self.as_point(found, section, motion, itinerary, tangent, any_word)

    def motion(self, section: SpeedSection, t: float, x: float, span: float) -> Trajectory:
        """Return the law's motion for some time from a passage."""
        return simulate(section.law, t0=t, x0=x, v0=section.speed, t_end=t + span, accuracy=inf)

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
        if along is None and abs(point.tangent[2]) > ALONG_PARAMETER:
            # at one value of the parameter there is one law only
            across = np.array([0.0, 0.0, 1.0])
        later = self.point_across(
            point.section, point.itinerary, guess, point.span, across, point.tangent, before=z
        )
        if later is None:
            return None
        off = linear.norm(self.unknowns(later) - guess)
        if off > LONGEST_CORRECTION * abs(step) + GOOD:
            return None
        if linear.dot(later.tangent, point.tangent) < LEAST_COSINE:
            return None
        return later

    def as_point(
        self,
        found: PointFound,
        section: SpeedSection,
        motion: Trajectory,
        itinerary: Itinerary,
        tangent: np.ndarray,
        any_word: bool,
    ) -> CurvePoint | None:
        """Return a point of the curve with its orbit; None if the motion does not close, or has
        another word unless that is allowed.
        """
        t, x, value = self.split(found.z)
        changes = found.followed.changes
        orbit = followed_orbit(
            section, t, x, found.span, self.periods, changes, 0.0, 0, None, motion
        )
        if orbit is None or not (any_word or orbit.labels == self.first.labels):
            return None
        table = {(margin.piece, margin.text): margin.value for margin in margins(orbit, False)}
        return CurvePoint(
            value, section, t, x, found.span, changes, tangent, orbit, itinerary, table
        )

    def begin(self, direction: float) -> CurvePoint | None:
        """Return the first point, with the tangent in a direction of the parameter."""
        section = self.first._section
        assert section is not None
        assert self.first.motion is not None
        t = float(self.first.motion.t_start)
        z = np.array([t, float(self.first.start[1]), self.value]) / self.scale
        along = np.array([0.0, 0.0, 1.0])
        itinerary = itinerary_of(self.first.motion, section.upwards)
        span = float(self.first.period)
        return self.point_across(section, itinerary, z, span, along, direction * along)

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
        along = along / linear.norm(along)
        t, x, _ = (z * self.scale).tolist()
        section = replace(section, law=self.law(point.value))
        itinerary = itinerary_of(self.motion(section, t, x, point.span), section.upwards)
        better = self.point_across(section, itinerary, z, point.span, along, along)
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
        has_failed = False  # whether a longer step from the last point found no orbit
        retried = 0
        first_extent = self.extent(point)
        examined = 0  # points whose section has been looked at, and twice if a step failed there
        tried_any = 0
        while len(points) < most:
            if examined < len(points):
                examined = len(points)
                points[-1], changed = self.with_better_section(points)
                if changed:
                    has_failed = False
                    step = max(step, FIRST_STEP / 10)
            point = points[-1]
            trial = step
            final = self.at_end_of_range(point, trial)
            if final is not None:
                events += self.events_between(point, final)
                return [*points, final], events, LawCurveEnd("range", final.value)
            later = self.point_near(point, trial)
            if later is None and tried_any < len(points):
                # The section may be in the way: the next orbits need not pass it.
                tried_any = len(points)
                points[-1], changed = self.with_better_section(points, ANY_BETTER)
                if changed:
                    continue
            if later is None or (trial > NO_GAP and self.may_have_gap([*points[-2:], later])):
                located = self.end_ahead(point, trial)
                if located is not None:
                    final, end = located
                    events += self.events_between(point, final)
                    return [*points, final], events, end
            if later is None:
                has_failed = True
                step = trial / 2
                if trial > RESOLUTION:
                    continue
                if retried < len(TRIED_AGAIN):
                    step = TRIED_AGAIN[retried]
                    retried += 1
                    continue
                return points, events, LawCurveEnd("lost", points[-1].value)
            if not self.low <= later.value <= self.high:
                last = self.at_limit(point, later)
                if last is not None:
                    events += self.events_between(point, last)
                    points.append(last)
                    return points, events, LawCurveEnd("range", last.value)
                has_failed = True
                step = trial / 2
                if trial <= RESOLUTION:
                    return points, events, LawCurveEnd("lost", point.value)
                continue
            if trial > NO_GAP and self.may_have_gap([*points[-2:], later]):
                step = trial / 2
                continue
            if self.is_in_family(later):
                return [*points, later], events, LawCurveEnd("family", later.value)
            events += self.events_between(point, later)
            points.append(later)
            retried = 0
            if has_failed:
                # Longer steps from here need not fail where one did from the point before.
                has_failed = False
                step = trial
            else:
                step = min(trial * GROWTH, LONGEST_STEP)
            if advance:
                advance(abs(later.value - self.value) / (self.high - self.low), len(points))
            if self.extent(later) < SHRUNK * first_extent:
                return points, events, LawCurveEnd("shrunk", self.shrunk_value(points))
            if self.is_closed(points):
                return points, events, LawCurveEnd("closed", later.value)
        return points, events, LawCurveEnd("most", points[-1].value)

    def end_ahead(self, point: CurvePoint, step: float) -> tuple[CurvePoint, LawCurveEnd] | None:
        """Return the last orbit before the end of the word next to a point, and the end, which is
        less than about a step away; None if none is found.
        """
        direction = 1.0 if point.tangent[2] > 0 else -1.0
        width = self.scale[2]
        reach = REACH * step * abs(point.tangent[2]) * width
        last = point
        for _ in range(MOST_NEARER):
            ahead = self.border_ahead(last, direction, reach)
            if ahead is None:
                return None
            shift = direction * BEFORE_END * RESOLUTION * width
            # The first value may be beyond the end: there the motion passes other corners.
            part = 1.0
            later = self.orbit_beside(last, ahead, ahead.value - shift)
            while later is None and part > LEAST_PART:
                part /= 8
                away = part * (ahead.value - last.value)
                later = self.orbit_beside(last, ahead, ahead.value - away)
            if later is None:
                return None
            is_there = abs(later.value - ahead.value) <= 2 * abs(shift)
            has_moved = abs(later.value - last.value) > 4 * abs(shift)
            last = later
            if is_there and not has_moved:
                break
        else:
            return None
        if self.orbit_beside(last, ahead, ahead.value + direction * BEYOND_END * width):
            return None
        return last, LawCurveEnd("lost", ahead.value)

    def border_ahead(self, point: CurvePoint, direction: float, reach: float) -> BorderAhead | None:
        """Return the nearest border ahead, at which an inequality of the orbit is 0."""
        places = list[BorderAhead]()
        slack = 4 * BEFORE_END * RESOLUTION * self.scale[2]
        for condition in margins(point.orbit)[:MOST_REASONS]:
            place = border_ahead(point.orbit, condition, self.parameter, self.scale[2])
            if place is not None and -slack < direction * (place.value - point.value) < reach:
                places.append(place)
        return min(places, key=lambda place: direction * place.value, default=None)

    def orbit_beside(
        self, point: CurvePoint, place: BorderAhead, value: float
    ) -> CurvePoint | None:
        """Return the orbit with the word of a point at a value of the parameter beside a border,
        None if none is found.
        """
        along = np.array([0.0, 0.0, 1.0])
        guess = np.array([place.t, place.x, value]) / self.scale
        return self.point_across(
            point.section, point.itinerary, guess, point.span, along, point.tangent
        )

    def orbit_near(self, point: CurvePoint, value: float) -> FollowedOrbit | None:
        """Return an orbit with any word near a point at another value of the parameter, None if none
        is found.
        """
        try:
            section = replace(point.section, law=self.law(value))
        except ParameterError:
            return None
        motion = self.motion(section, point.t, point.x, point.span)
        if float(motion.t_end) < point.t + point.span:
            return None
        itinerary = itinerary_of(motion, section.upwards)
        if itinerary.legs[-1].sticks or itinerary.legs[-1].band != itinerary.legs[0].band:
            return None
        along = np.array([0.0, 0.0, 1.0])
        guess = np.array([point.t, point.x, value]) / self.scale
        found = self.point_across(
            section, itinerary, guess, point.span, along, point.tangent, any_word=True
        )
        return found and found.orbit

    def may_have_gap(self, points: list[CurvePoint]) -> bool:
        """Return whether a margin of the orbits, a parabola through three points of the curve, is
        negative between the last two.
        """
        if len(points) < 3:
            return False
        tables = [point.margins for point in points]
        places = [0.0]
        for before, after in pairwise(points):
            away = (after.value - before.value) / self.scale[2]
            places.append(places[-1] + max(abs(away), LEAST_AWAY))
        for key in tables[0].keys() & tables[1].keys() & tables[2].keys():
            values = [table[key] for table in tables]
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

    def is_in_family(self, point: CurvePoint) -> bool:
        """Return whether a cycle stays in one band: then the band has no damping, and every smaller
        circle is a cycle for the same value of the parameter.
        """
        motion = point.orbit.motion
        assert motion is not None
        bands = set(motion._pieces[BAND_ROW].tolist())
        return not self.periods and not point.orbit.labels and len(bands) == 1

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

    def at_end_of_range(self, point: CurvePoint, step: float) -> CurvePoint | None:
        """Return the orbit at the end of the range if a step along the tangent leads beyond it, where
        the law may not be allowed; None if it does not, or none is found.
        """
        if abs(point.tangent[2]) < ALONG_PARAMETER:
            return None
        ahead = point.value + step * float(point.tangent[2]) * self.scale[2]
        if self.low <= ahead <= self.high:
            return None
        limit = self.high if ahead > self.high else self.low
        part = (limit - point.value) / (ahead - point.value)
        if part * step > LONGEST_STEP:
            return None
        guess = self.unknowns(point) + part * step * point.tangent
        inward = self.value - limit
        shift = float(np.sign(inward)) * BEFORE_END * RESOLUTION * self.scale[2]
        for value in (limit, limit + shift):  # with the limit itself the orbit may be gone
            found = self.point_on_limit(point, guess, value)
            if found is not None and linear.dot(found.tangent, point.tangent) > LEAST_COSINE:
                return found._replace(value=limit)
        return None

    def point_on_limit(
        self, point: CurvePoint, guess: np.ndarray, limit: float
    ) -> CurvePoint | None:
        """Return the orbit at an end of the range, near a point and a guess."""
        guess[2] = limit / self.scale[2]
        along = np.array([0.0, 0.0, 1.0])
        z = self.unknowns(point)
        found = self.point_across(
            point.section, point.itinerary, guess, point.span, along, point.tangent, before=z
        )
        return found and found._replace(value=limit)

    def at_limit(self, before: CurvePoint, beyond: CurvePoint) -> CurvePoint | None:
        """Return the orbit at the limit of the range between two points."""
        limit = self.high if beyond.value > self.high else self.low
        part = (limit - before.value) / (beyond.value - before.value)
        z = self.unknowns(before)
        guess = z + part * (self.unknowns(beyond) - z)
        return self.point_on_limit(before, guess, limit)

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


def is_along(motion: Trajectory, labels: tuple[str, ...]) -> bool:
    """Return whether the mappings of a motion over one period are as many as those of a word."""
    return len(motion.events) == len(labels)


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
