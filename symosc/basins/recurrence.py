"""Motions with a drive: attractors are what recurs on the stroboscopic section.

The section has the states at the ends of forcing periods. All motions are followed together, in
chunks of forcing periods, and those that are decided are dropped:

- A motion whose section points repeat after q periods, to a small part of its extent, leads to a
  candidate. Newton's method on the section map finds the orbit itself, and neighbours on all sides
  must come nearer to it over further periods: then it is an attractor, and the distance from which
  they did so is its neighbourhood.
- A motion that stays in the neighbourhood of an attractor for two of its periods, and comes
  nearer, leads to it.
- What recurs never, to the end, is compared by its clouds of section points. What a cloud is, chaos
  or a torus, decides a long motion in it (`symosc.orbits.unsettled`). Everything else is undecided.

`symosc.orbits.settling` answers another question with the same verdicts on rests, chaos and tori: to
which orbit one motion settles. It makes the orbit first, from a motion that nearly repeats itself,
and its multipliers say how long the motion has to be followed until it is nearer. Here thousands of
motions are compared with few orbits, of which only neighbourhoods are known, and multipliers never
needed: a neighbourhood decides all motions in it at once. So candidates must be closer here, and the
tolerances differ.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, sqrt
from typing import Any

import numpy as np

from symosc.basins.kinds import Rest, oscillator_of, rest_of
from symosc.model import Model, Oscillator
from symosc.orbits.unsettled import Chaotic, QuasiPeriodic, unsettled_at
from symosc.simulation.ensemble import simulate_many

#: No accuracy is asked for: in chaos errors grow without end, and what is asked here is where
#: motions lead. Each event is decided by more than its own rounding.
ACCURACY = inf
#: Forcing periods of the first chunks, by the number of periods before them, and of all others.
CHUNKS = {0: 32, 32: 32, 64: 64}
LAST_CHUNK = 128
#: Section points repeat if they differ by less than this part of the extent of the motion.
REPEATS = 1e-6
#: Two orbits are the same if their section points differ by less than this part of the extent.
SAME = 1e-5
#: Distances of neighbours that must come nearer, as parts of the extent, and the directions in
#: which they lie.
RADII = (1e-3, 1e-4, 1e-5, 1e-6)
DIRECTIONS = np.array([(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)])
#: Periods of an orbit after which neighbours must have come nearer, by the factor SHRINKS.
SHRINKING = (4, 16, 64, 256)
SHRINKS = 0.5
#: How far neighbours may move away in between, as a multiple of their distance.
FARTHEST = 100.0
#: Candidates that are no attractors, of motions that are followed together, before further ones
#: wait until the motions have gone on.
MOST_FAILED = 12
#: Steps of Newton's method, and the step of its difference quotients as a part of the extent.
NEWTON_STEPS = 4
DIFFERENCE = 1e-6
#: How near to the rests a motion must be that creeps towards them, as a part of the extent, and how
#: near to their edge its limit is estimated, as a part of its own distance, from so many points.
BESIDE_REST = 1e-2
AT_EDGE = 0.05
LEAST_CREEPING = 16
#: Section points of a motion in which long orbits are looked for, and those that are compared with
#: others. So many numbers of others are computed at once.
LONG = 4096
CLOUD = 512
AT_ONCE = 4_000_000
#: How near a neighbour is that moves away in chaos, and after how many forcing periods by more than
#: it does where distances grow in proportion to time.
CLOSE = 1e-8
PARTING_PERIODS = 512
#: Two clouds are one if their points are no farther from each other than from their own
#: neighbours, times this.
FARTHER = 4.0
#: Points of a motion that are compared with a cloud, and clouds that are tried at most.
COMPARED = 256
MOST_CLOUDS = 16


@dataclass
class Recurrent:
    """A periodic orbit on the section: its points in order of time, and the distance from which
    motions are attracted.
    """

    points: np.ndarray
    radius: float
    word: str

    @property
    def periods(self) -> int:
        """Forcing periods after which it closes."""
        return len(self.points)


class DrivenMotions:
    """Motions under a drive, followed in chunks of forcing periods until their attractors are
    known.

    `most` is the number of forcing periods that a motion is followed for; `found` has the
    attractors, in order.
    """

    def __init__(self, model: Model, most: int, workers: int | None) -> None:
        self.model = oscillator_of(model)
        self.most = most
        self.workers = workers
        self.rest = rest_of(model)
        self.unit = units_of(self.model)
        self.found = list[Recurrent | Rest | Chaotic | QuasiPeriodic]()

    # -- following ---------------------------------------------------------------------------------

    def follow(self, starts: np.ndarray, periods: int, sections: int) -> Any:
        """Return the summary of motions over so many forcing periods, with the last sections."""
        return simulate_many(
            self.model, starts, f"{periods}T", accuracy=ACCURACY, workers=self.workers,
            record=("status", "word", "section"), sections=sections,
        )  # fmt: skip

    def onward(self, points: np.ndarray, periods: int, sections: int = 1) -> np.ndarray:
        """Return the last section points of motions that start in `points` of the section."""
        starts = np.column_stack([np.zeros(len(points)), points])
        section: np.ndarray = self.follow(starts, periods, sections).section
        return section

    def distances(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Return the distances of section points in units of the oscillator."""
        distances: np.ndarray = np.abs((first - second) / self.unit).max(axis=-1)
        return distances

    def decide(self, starts: np.ndarray) -> np.ndarray:
        """Return for each row t0, x0, v0 the number of its attractor, -1 if undecided."""
        if self.model.contracts and len(starts) > 1:
            # No two motions move apart. So what attracts its neighbours attracts all.
            first = self._decided(starts[:1])
            if first[0] >= 0:
                return np.full(len(starts), first[0])
        return self._decided(starts)

    def _decided(self, starts: np.ndarray) -> np.ndarray:
        numbers = np.full(len(starts), -1)
        waiting = np.arange(len(starts))
        now = starts
        points = np.zeros((0, 1, 2))
        done = 0
        while len(waiting) and done < self.most:
            periods = min(CHUNKS.get(done, LAST_CHUNK), self.most - done)
            # A motion may start between two sections.
            begins = int(done == 0)
            followed = self.follow(now, periods + begins, periods)
            done += periods
            points = followed.section
            rests = (followed.status == "equilibrium") | self._held(points[:, -1])
            if rests.any():
                numbers[waiting[rests]] = self._number_of_rest()
            going = (followed.status == "t_end") & np.isfinite(points).all(axis=(1, 2)) & ~rests
            waiting = waiting[going]
            points = points[going]
            recurring = self._recurring(points, followed.word[going])
            numbers[waiting] = recurring
            waiting = waiting[recurring < 0]
            points = points[recurring < 0]
            now = np.column_stack([np.zeros(len(waiting)), points[:, -1]])
        if len(waiting):
            numbers[waiting] = self._unsettled(points)
        return numbers

    def _held(self, points: np.ndarray) -> np.ndarray:
        """Return which section points are rests on a belt: what is held once is held for ever."""
        if self.rest is None or not self.rest.belt:
            return np.zeros(len(points), dtype=bool)
        x, v = points.T
        held: np.ndarray = (v == 0.0) & (x >= self.rest.low) & (x <= self.rest.high)
        return held

    def _number_of_rest(self) -> int:
        """Return the number of the rest among the attractors."""
        for n, attractor in enumerate(self.found):
            if isinstance(attractor, Rest):
                return n
        assert self.rest is not None  # the mass rests
        self.found.append(self.rest)
        return len(self.found) - 1

    # -- recurrence --------------------------------------------------------------------------------

    def _recurring(self, points: np.ndarray, words: np.ndarray) -> np.ndarray:
        """Return for motions, from their section points and last words, the numbers of the
        attractors to which they lead; -1 where that is open.
        """
        numbers = self._known(points)
        creeping = self._creep(points)
        if creeping.any():
            numbers[creeping] = self._number_of_rest()
        repeats = repeats_of(points, self.unit)
        candidates = np.flatnonzero((numbers < 0) & (repeats > 0))
        failed = 0
        while len(candidates) and failed < MOST_FAILED:
            i = int(candidates[0])
            q = int(repeats[i])
            candidates = candidates[1:]
            candidate = self._attractor(points[i, -q:], str(words[i]))
            if candidate is None:
                failed += 1
                # others beside it fail as it does
                same = self.distances(points[candidates, -1], points[i, -1]) < SAME
                candidates = candidates[~same]
                continue
            n = self._number_of(candidate)
            numbers[i] = n
            near = self._near(points[candidates], candidate)
            numbers[candidates[near]] = n
            candidates = candidates[~near]
        return numbers

    def _known(self, points: np.ndarray) -> np.ndarray:
        """Return for motions the numbers of the orbits beside which they are, -1 for none."""
        numbers = np.full(len(points), -1)
        for n, attractor in enumerate(self.found):
            if isinstance(attractor, Recurrent):
                numbers[(numbers < 0) & self._near(points, attractor)] = n
        return numbers

    def _near(self, points: np.ndarray, attractor: Recurrent) -> np.ndarray:
        """Return which motions are in the neighbourhood of an attractor and come nearer to it."""
        q = attractor.periods
        if not len(points) or points.shape[1] < 2 * q:
            return np.zeros(len(points), dtype=bool)
        away = self.distances(points, attractor.points[0])
        phase = np.argmin(away[:, -q:], axis=1) + points.shape[1] - q
        rows = np.arange(len(points))
        now = away[rows, phase]
        before = away[rows, phase - q]
        inside = (now <= attractor.radius) & (before <= attractor.radius)
        near: np.ndarray = inside & ((now <= before) | (now <= REPEATS))
        return near

    def _number_of(self, attractor: Recurrent) -> int:
        """Return the number of an attractor, a new one if its orbit is not known yet."""
        for n, known in enumerate(self.found):
            if isinstance(known, Recurrent) and known.periods == attractor.periods:
                away = self.distances(known.points, attractor.points[0])
                if away.min() < SAME:
                    return n
        self.found.append(attractor)
        return len(self.found) - 1

    def _attractor(self, points: np.ndarray, word: str) -> Recurrent | None:
        """Return the orbit near section points that repeat, if it attracts its neighbours."""
        q = len(points)
        point = self._polished(points[-1], q)
        path = self.onward(point[None], q, q)[0]
        for divisor in range(1, q):
            if q % divisor == 0 and self.distances(path[divisor - 1], path[-1]) < SAME:
                path = path[:divisor]
                break
        orbit = np.concatenate([path[-1:], path[:-1]])
        radius = self._radius(orbit)
        if radius is None:
            return None
        return Recurrent(orbit, radius, word if len(orbit) == 1 else "")

    def _creep(self, points: np.ndarray) -> np.ndarray:
        """Return which motions slip a little in each period, ever less, towards the edge of the rests.

        They come nearer for ever and do not arrive. At the distance d beyond the edge the force
        exceeds friction by k d, for a time that grows as sqrt(d), so that a slip grows as d^2. So
        the roots of the slips are a straight line over d, which is 0 at the limit of the motion.
        This limit must be the edge, for the lines through both halves of the points.
        """
        if self.rest is None or not self.rest.belt or points.shape[1] < LEAST_CREEPING:
            return np.zeros(len(points), dtype=bool)
        x = points[..., 0]
        beyond = np.maximum(x - self.rest.high, self.rest.low - x) / self.unit[0]
        slips = -np.diff(beyond, axis=1)
        creeps = (beyond > 0).all(axis=1) & (slips > 0).all(axis=1) & (beyond[:, -1] < BESIDE_REST)
        middle = slips.shape[1] // 2
        for begin, end in ((0, middle), (middle, -1)):
            near = beyond[creeps, :-1][:, end]
            far = beyond[creeps, begin]
            last = np.sqrt(slips[creeps, end])
            rise = np.sqrt(slips[creeps, begin]) - last
            limit = near - last * (far - near) / np.where(rise > 0, rise, np.nan)
            creeps[creeps] = np.abs(limit) < AT_EDGE * beyond[creeps, -1]
        return creeps

    def _polished(self, point: np.ndarray, q: int) -> np.ndarray:
        """Return the fixed point of the map over `q` periods near a section point, or the point."""
        best = point
        least = inf
        step = DIFFERENCE * self.unit
        for _ in range(NEWTON_STEPS):
            beside = point + np.array([(0.0, 0.0), (step[0], 0.0), (0.0, step[1])])
            here, by_x, by_v = self.onward(beside, q)[:, -1]
            miss = here - point
            size = float(np.abs(miss / self.unit).max())
            if not size < least:
                break
            best, least = point, size
            (a, c) = ((by_x - here) / step[0]).tolist()
            (b, d) = ((by_v - here) / step[1]).tolist()
            if self._sticks(point):
                b = d = 0.0
            determinant = (1 - a) * (1 - d) - b * c
            if abs(determinant) < 1e-9:
                break
            along_x = ((1 - d) * miss[0] + b * miss[1]) / determinant
            along_v = (c * miss[0] + (1 - a) * miss[1]) / determinant
            point = point + np.array([along_x, along_v])
            if self.distances(point, best) > 100 * REPEATS / SHRINKS:
                break
        return best

    def _sticks(self, point: np.ndarray) -> bool:
        """Return whether a section point is on a belt."""
        return any(point[1] == float(belt.v) for belt in self.model.belts)

    def _radius(self, orbit: np.ndarray) -> float | None:
        """Return the largest distance from which neighbours on all sides come nearer to an orbit;
        None if they do not.
        """
        q = len(orbit)
        if self._sticks(orbit[0]):
            # Neighbours of the motion stick too: what starts off the belt is none, since static
            # friction may hold the mass where kinetic friction would let it go.
            directions = DIRECTIONS[DIRECTIONS[:, 1] == 0]
        else:
            directions = DIRECTIONS
        for radius in RADII:
            neighbours = orbit[0] + radius * directions * self.unit
            for times in SHRINKING:
                neighbours = self.onward(neighbours, q * times)[:, -1]
                away = self.distances(neighbours, orbit[0])
                if not (away <= FARTHEST * radius).all():
                    break
                if (away <= SHRINKS * radius).all():
                    return radius
        return None

    # -- chaos and tori ----------------------------------------------------------------------------

    def _unsettled(self, points: np.ndarray) -> np.ndarray:
        """Return the numbers of the attractors, chaotic or quasi-periodic, to which motions lead that
        do not recur, from their last section points; -1 where it is open.
        """
        numbers = np.full(len(points), -1)
        waiting = np.arange(len(points))
        for _ in range(MOST_CLOUDS):
            if not len(waiting):
                break
            i = int(waiting[0])
            cloud = self.onward(points[i, -1:], LONG, LONG)[0]
            waiting = waiting[1:]
            if not np.isfinite(cloud).all():
                continue
            again = self._recurring(cloud[None], np.array([""]))
            if again[0] >= 0:
                numbers[i] = again[0]
                waiting, numbers = self._settled(points, waiting, numbers)
                continue
            cloud = cloud[-CLOUD:]
            attractor = self._attractor_from(cloud)
            if attractor is None:
                number = -1
            else:
                number = self._number_of_cloud(attractor)
            numbers[i] = number
            same = np.array([self._same_cloud(points[j], cloud) for j in waiting], dtype=bool)
            numbers[waiting[same]] = number
            waiting = waiting[~same]
        return numbers

    def _settled(
        self, points: np.ndarray, waiting: np.ndarray, numbers: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the motions that go on waiting, and the numbers, now that another attractor is
        known.
        """
        periods = [known.periods for known in self.found if isinstance(known, Recurrent)]
        longest = max(periods, default=0)
        if 2 * longest <= points.shape[1]:
            numbers[waiting] = self._recurring(points[waiting], np.full(len(waiting), ""))
            return waiting[numbers[waiting] < 0], numbers
        # An orbit of so many periods is not seen in these points: the motions are followed on.
        count = max(1, AT_ONCE // (4 * longest))
        for begin in range(0, len(waiting), count):
            part = waiting[begin : begin + count]
            last = points[part, -1]
            numbers[part] = self._known(self.onward(last, 2 * longest, 2 * longest))
        return waiting[numbers[waiting] < 0], numbers

    def _attractor_from(self, cloud: np.ndarray) -> Chaotic | QuasiPeriodic | None:
        """Return the chaos or the torus of a cloud of section points, None if it is not known to be
        one that attracts.
        """
        x, v = cloud[-1].tolist()
        found = unsettled_at(self.model, 0.0, x, v)
        if isinstance(found, Chaotic) and self._parts(cloud[-1]):
            return replace(found, points=cloud)
        if isinstance(found, QuasiPeriodic) and found.attracts:
            return found
        return None

    def _parts(self, point: np.ndarray) -> bool:
        """Return whether a neighbour of a section point moves away faster than without chaos."""
        beside = point + np.array([(0.0, 0.0), (CLOSE * self.unit[0], 0.0)])
        here, there = self.onward(beside, PARTING_PERIODS)[:, -1]
        return bool(self.distances(here, there) > CLOSE * PARTING_PERIODS * 2)

    def _number_of_cloud(self, attractor: Chaotic | QuasiPeriodic) -> int:
        """Return the number of an attractor with a cloud, a new one if its cloud is no other's."""
        for n, known in enumerate(self.found):
            if not isinstance(known, type(attractor)):
                continue
            if self._same_cloud(attractor.points, known.points):
                return n
        self.found.append(attractor)
        return len(self.found) - 1

    def _same_cloud(self, points: np.ndarray, cloud: np.ndarray) -> bool:
        """Return whether section points lie in a cloud, as the cloud's own second half lies in its
        first one.
        """
        half = len(cloud) // 2
        own = self._gap(cloud[half:], cloud[:half])
        other = self._gap(points[-COMPARED:], cloud[:half])
        return other <= FARTHER * own

    def _gap(self, points: np.ndarray, cloud: np.ndarray) -> float:
        """Return the mean distance from points to the nearest one of a cloud."""
        return float(self.distances(points[:, None], cloud).min(axis=1).mean())


def repeats_of(points: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Return after how many periods the last section points of motions repeat, 0 if they do not."""
    repeats = np.zeros(len(points), np.int64)
    for q in range(1, points.shape[1] // 2 + 1):
        last = points[:, -q:]
        before = points[:, -2 * q : points.shape[1] - q]
        same = (np.abs(last - before) / unit).max(axis=(1, 2)) < REPEATS
        repeats[(repeats == 0) & same] = q
    return repeats


def units_of(law: Oscillator) -> np.ndarray:
    """Return units of position and velocity that fit an oscillator: what its forces and belts make
    of a spring.
    """
    forces = abs(law.A0) + abs(law.B0)
    for n in law.law.boundaries:
        forces += law.law.kinetic(n) + law.law.excess(n)
    rate = max(float(law.Omega), sqrt(law.k / law.m))
    fastest = max(abs(float(belt.v)) for belt in law.belts)
    size = float(forces / law.k) + fastest / rate
    return np.array([size, size * rate])
