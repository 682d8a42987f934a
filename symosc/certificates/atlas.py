"""`atlas`: the plane of two parameters, as regions with words, their borders, and boxes in which a
word is proven.
"""

from __future__ import annotations

import heapq
import json
import os
from collections import Counter, defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import product
from math import log2
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import NumberLike, Progress, Record, SceneName
from symosc.base.arguments import (
    FILE,
    NUMBER,
    PROGRESS,
    mapping_of,
    public,
    require,
    require_or_none,
    row_of,
)
from symosc.base.display.drawable import Drawable
from symosc.base.display.progress import reporting
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact, show, whole_number
from symosc.base.files import STDOUT, check_folder_of, write_text
from symosc.base.workers import process_pool
from symosc.certificates.certificate import FORMAT
from symosc.kernels import linear
from symosc.model import PARAMETER_NAMES, Parameters, by_name
from symosc.orbits.border import Border, BorderError, borders_between, labelled, passes
from symosc.orbits.border_system import REST
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import SETTLING_PERIODS, settled_orbit
from symosc.scenes import Scene, model_of, parameters_of, scene_of
from symosc.simulation.ensemble import simulate_many
from symosc.words import Word, read_word

#: How many boxes are tried before the time is checked again, and in one call of a worker.
BATCH = 64
CHUNK = 8
#: How many likely orbits are passed on to the parts of a rectangle.
MOST_NEAR = 3
#: The least side of a box that is tried, as a part of the range.
LEAST_SIDE = Fraction(1, 1 << 24)
#: How often to try to find a border between two words; how far beside a border to look, as a part
#: of the plane.
MOST_FAILED = 3
BESIDE = 1e-4
#: From this excess on (`NotInBox`) it says nothing, and boxes are halved so many times.
MOST_EXCESS = 1e6
DIVIDED_IF_UNKNOWN = 3
#: Points of the grid along each side; so far inside of the plane's edge a place is looked at; the
#: step along a border.
GRID = 12
EDGE = 1e-6
BORDER_STEP = 0.005

Rectangle = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]
#: Both parameters and the word there, "" if it has none.
Place = tuple[float, float, str]


class LikelyOrbit(NamedTuple):
    """The labels of a word in order of time, and unknowns (`symosc.certificates.plane`) near those
    of its orbit.
    """

    labels: tuple[str, ...]
    unknowns: tuple[float, ...]


class ProvenBox(NamedTuple):
    """A box of two parameters in which a word is proven.

    Attributes
    ----------
    word : str
        "rest" where the mass may rest on a belt for ever.
    range : tuple of two pairs of Fractions
        The lower and the upper value of each parameter.
    points : tuple of (phase, x)
        Approximate switching points of the orbit at the middle of the box, in order of time. A
        flight begins at the first of them. Empty for "rest".
    """

    word: str
    range: Rectangle
    points: tuple[tuple[float, float], ...]


class Region(NamedTuple):
    """The part of an atlas in which the settled motion has one word.

    Attributes
    ----------
    word : str
        "rest" where the mass may rest on a belt for ever, "" where no word was found.
    share : float
        The region's part of the whole area: `proven`, and its part of what is not proven, estimated
        from the grid.
    proven : float
        The part of the whole area in which the word is proven.
    """

    word: str
    share: float
    proven: float


class BoxTask(NamedTuple):
    """A rectangle of the plane of two parameters in which a word is still to be proven, and orbits
    that it may have.
    """

    box: Rectangle
    # Orbits that it may have, that of the nearest rectangle first.
    near: tuple[LikelyOrbit, ...] = ()
    divide: int = 0  # how many times it is halved before a proof is tried, as it is much too large
    # The middle of a rectangle around it or beside it, and the word there.
    above: Place | None = None


def area(box: Rectangle) -> Fraction:
    """Return the area of a rectangle in the plane of two parameters."""
    (a, b), (c, d) = box
    return (b - a) * (d - c)


def middle_of(box: Rectangle) -> tuple[float, float]:
    """Return the middle of a rectangle."""
    x, y = (float(low + high) / 2 for low, high in box)
    return x, y


def divided(box: Rectangle, along: int, at: Fraction | None = None) -> list[Rectangle]:
    """Cut side `along` (0 or 1) of a box at `at` or its middle.

    Return both parts, or [box] if `at` is not inside.
    """
    low, high = box[along]
    uncut_side = box[1 - along]
    if at is None:
        middle = (low + high) / 2
    else:
        middle = at
    if not low < middle < high:
        return [box]
    halves = ((low, middle), (middle, high))
    if along == 0:
        return [(half, uncut_side) for half in halves]
    return [(uncut_side, half) for half in halves]


def canonical(labels: Sequence[str]) -> str:
    """Return the text of a word, rotated so that all rotations of its `labels` give the same text."""
    return str(Word(tuple(labels)).cycle)


def flight_first(word: str) -> tuple[str, ...]:
    """Return the labels of `word` in order of time, rotated so that the first is a flight.

    There must be one.
    """
    labels = read_word(word).labels
    first = next(i for i, label in enumerate(labels) if label not in ("P1", "P4"))
    return labels[first:] + labels[:first]


class Attempt(NamedTuple):
    """What came of a task: the word at its middle ("" if none is found), the box if it is proven,
    and the parts left to try.
    """

    word: str
    box: ProvenBox | None
    parts: list[BoxTask]


class ParameterPlane(NamedTuple):
    """A plane of two parameters, with their names and ranges.

    `p` has the values of the other nine parameters.
    """

    p: Parameters
    names: tuple[str, str]
    range: Rectangle

    def at(self, point: Sequence[Any]) -> Parameters:
        """Return the oscillator's parameters at a point of the plane."""
        return self.p.replace(**dict(zip(self.names, point, strict=True)))

    def rests(self, box: Rectangle) -> bool | None:
        """Return whether the mass may rest on a belt for all parameters of a box; None if only for
        some of them.
        """
        ends = by_name(self.p, lambda value: (value, value))
        ends.update(zip(self.names, box, strict=True))
        # The mass rests on a belt at rest whose friction, between mu FN at both ends, holds |B0|.
        least_push, most_push = sorted(map(abs, ends["B0"]))
        low_B0, high_B0 = ends["B0"]
        if low_B0 < 0 < high_B0:
            least_push = Fraction(0)
        still = [belt for belt in "12" if ends["v" + belt] == (0, 0)]
        holds = [
            [mu * FN for mu, FN in zip(ends["mu" + belt], ends["FN"], strict=True)]
            for belt in still
        ]
        if any(least_hold >= most_push for least_hold, _ in holds):
            return True
        if any(most_hold > least_push for _, most_hold in holds):
            return None
        return False

    def cut_at_rest(self) -> list[Rectangle]:
        """Cut the plane along those borders of the region of rest that are parallel to an axis.

        Return the parts.
        """
        parts = [self.range]
        p = self.p
        for belt in "12":
            mu = getattr(p, "mu" + belt)
            # Where mu FN = |B0| if only this one of them varies in the plane.
            borders = {
                "B0": mu * p.FN,
                "FN": abs(p.B0) / mu if mu else 0,
                "mu" + belt: abs(p.B0) / p.FN if p.FN else 0,
            }
            free = [name for name in borders if name in self.names]
            if f"v{belt}" in self.names or p.belt(int(belt)) != 0 or len(free) != 1:
                continue
            along = self.names.index(free[0])
            border = Fraction(borders[free[0]])
            for value in (border, -border):  # B0 may be negative
                parts = [piece for part in parts for piece in divided(part, along, value)]
        return parts

    def word(self, point: Sequence[Any]) -> str:
        """Return the word of the settled motion at a point, "rest" if the mass may rest.

        "" if it is not found.
        """
        x, y = map(Fraction, point)
        if self.rests(((x, x), (y, y))):
            return REST
        try:
            return canonical(settled_orbit(self.at((x, y))).labels)
        except ConvergenceError:
            return ""

    def grid(self, pool: Executor | None) -> tuple[Place, ...]:
        """Return places (value, value, settled word or "") on a grid and the edges.

        `pool` does the computations.
        """
        # Both edges, and the middles of GRID equal parts between them.
        shares = [Fraction(0), *(Fraction(2 * i + 1, 2 * GRID) for i in range(GRID)), Fraction(1)]
        values_x, values_y = (
            [low + (high - low) * share for share in shares] for low, high in self.range
        )
        points = list(product(values_x, values_y))
        words = {(x, y): REST for x, y in points if self.rests(((x, x), (y, y)))}
        moving = [point for point in points if point not in words]
        if moving:
            # One run of all of them finds most words; the others are looked for one by one.
            words |= self._simulated_words(moving)
        without_word = [point for point in points if point not in words]
        if pool is None:
            their_words: Iterator[str] = map(self.word, without_word)
        else:
            their_words = pool.map(self.word, without_word, chunksize=CHUNK)
        words.update(zip(without_word, their_words, strict=True))
        return tuple((float(x), float(y), words[x, y]) for x, y in points)

    def _simulated_words(
        self, points: Sequence[tuple[Fraction, Fraction]]
    ) -> dict[tuple[Fraction, Fraction], str]:
        """Return the words of the points at which the motion from rest settles soon, with a word
        that repeats itself each period.
        """
        numbers: Record = by_name(self.p, float)
        numbers |= dict(zip(self.names, np.array(points, dtype=float).T, strict=True))
        columns = ("word", "multiplicity", "status")
        t_end = f"{SETTLING_PERIODS[0]}T"
        runs = simulate_many(numbers, (0, 0, 0), t_end, record=columns, workers=1)
        words = {}
        for point, word, count, status in zip(
            points, runs.word, runs.multiplicity, runs.status, strict=True
        ):
            if word and count == 1 and status == "t_end":
                words[point] = canonical(read_word(str(word)).labels)
        return words

    # -- borders -----------------------------------------------------------------------------------

    def borders(
        self, pairs: Sequence[tuple[Place, Place]], known: Sequence[Border] = ()
    ) -> list[Border]:
        """Search for borders between the places of `pairs` whose words differ.

        Return them and the `known` borders.
        """
        borders = list(known)
        failed = Counter[frozenset[str]]()
        followed_up = len(known)  # how many borders have had their sides looked at
        waiting = deque(pairs)
        while waiting:
            a, b = waiting.popleft()
            x_a, y_a, word_a = a
            x_b, y_b, word_b = b
            words = frozenset((word_a, word_b))
            if len(words) < 2 or failed[words] >= MOST_FAILED or border_known(borders, a, b):
                continue
            at_a = self.at((x_a, y_a))
            at_b = self.at((x_b, y_b))
            limits = dict(zip(self.names, self.range, strict=True))
            try:
                for border in borders_between(at_a, at_b, self.names, limits, step=BORDER_STEP):
                    if not _is_among(border, borders):
                        # The border itself and those that begin at its special points.
                        borders += [
                            member
                            for member in border.network(step=BORDER_STEP)
                            if not _is_among(member, borders)
                        ]
            except (BorderError, ConvergenceError):
                pass
            # No more searches for borders between words that several searches have not found.
            failed[words] += not border_known(borders, a, b)
            for border in borders[followed_up:]:
                waiting += self.beyond(border)
            followed_up = len(borders)
        return borders

    def beyond(self, border: Border) -> Iterator[tuple[Place, Place]]:
        """Yield for each side of a border a place beside it and one at the edge: `borders` searches
        between them.
        """
        middle, across = self.across(border.points)
        for step in (across, -across):
            # How many steps lead to the edge of the plane, the nearest one.
            sides = zip(np.array(self.range, dtype=float), middle, step, strict=True)
            reach = min(
                ((high if change > 0 else low) - value) / change
                for (low, high), value, change in sides
                if change
            )
            if reach > 2 * BESIDE:
                ends = [(middle + part * step).tolist() for part in (BESIDE, reach * (1 - EDGE))]
                beside, at_edge = ((x, y, self.word((x, y))) for x, y in ends)
                yield beside, at_edge

    def across(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the middle one of a border's `points` and a vector across the border, in units of
        the plane's size.
        """
        middle = len(points) // 2
        size = np.array([float(high - low) for low, high in self.range])
        along = (points[middle] - points[middle - 1]) / size
        along_x, along_y = along
        normal = np.array([along_y, -along_x]) / linear.norm(along)
        return points[middle], normal * size

    # -- boxes -------------------------------------------------------------------------------------

    def orbit_near(self, box: Rectangle) -> LikelyOrbit | None:
        """Return labels and unknowns (`BoxEquations`) of the attracting orbit at a box's middle.

        None if none is usable.
        """
        middle = self.at([(low + high) / 2 for low, high in box])
        try:
            orbit = settled_orbit(middle)
        except ConvergenceError:
            return None
        if not orbit.admissible or orbit.periods != 1:
            return None
        # One rotation for all orbits of a word: that of its canonical text.
        Omega = float(middle.Omega)
        labels = orbit.labels
        wanted = flight_first(canonical(labels))
        first = next(i for i in range(len(labels)) if labels[i:] + labels[:i] == wanted)
        points = [(t * Omega, x) for t, x in orbit.points[first:] + orbit.points[:first]]
        unknowns = _flights(wanted, self.p, self.names).unknowns(Omega, points)
        return LikelyOrbit(wanted, tuple(unknowns))

    def surface_in(self, box: Rectangle, orbit: LikelyOrbit) -> Any:
        """Return the `Surface` of a likely orbit over a box; None if its word has no orbit at the
        middle of the box.
        """
        from symosc.certificates.plane import NotInBox, Surface, box_arithmetic

        flights = _flights(orbit.labels, self.p, self.names)
        try:
            with box_arithmetic():
                return Surface(self.p, self.names, box, flights, orbit.unknowns)
        except NotInBox:
            return None

    def attempt(self, task: BoxTask) -> Attempt:
        """Try to prove one word in a task's rectangle.

        The orbits in `task.near` are tried first, then one found at the middle.
        """
        from symosc.certificates.plane import NotInBox, box_arithmetic

        box = task.box
        orbits = list(task.near)
        surface = None
        for orbit in task.near:
            surface = self.surface_in(box, orbit)
            if surface is not None:
                break
        if surface is None:  # the search for an orbit at the middle is dear, so it comes last
            orbit_at_middle = self.orbit_near(box)
            if orbit_at_middle is not None:
                orbits.insert(0, orbit_at_middle)
                orbit = orbit_at_middle
                surface = self.surface_in(box, orbit)
        if surface is None:
            halves = divided(box, _longer_side(box))
            return Attempt("", None, [BoxTask(half, tuple(orbits[:MOST_NEAR])) for half in halves])
        labels = orbit.labels
        word = canonical(labels)
        along = None
        divide = task.divide - 1
        try:
            with box_arithmetic():
                if not task.divide:
                    surface.prove()
                    return Attempt(word, ProvenBox(word, box, tuple(surface.points())), [])
        except NotInBox as reason:
            along = reason.along
            # A box that is 4 times too large is halved once before the next proof, and so on.
            if reason.excess < MOST_EXCESS:
                divide = int(log2(max(reason.excess, 1)) / 2)
            else:
                divide = DIVIDED_IF_UNKNOWN
        if along is None:
            along = _longer_side(box)
        # The likely orbits of both halves: at their own middles, at that of the box, of other words.
        of_other_words = [other for other in orbits if other.labels != labels]
        others = [LikelyOrbit(labels, surface.near(0, 0)), *of_other_words][:MOST_NEAR]
        if along == 0:
            middles = ((-0.5, 0.0), (0.5, 0.0))
        else:
            middles = ((0.0, -0.5), (0.0, 0.5))
        parts = []
        for half, (a, b) in zip(divided(box, along), middles, strict=True):
            own = LikelyOrbit(labels, surface.near(a, b))
            parts.append(BoxTask(half, (own, *others), divide))
        return Attempt(word, None, parts)


@lru_cache(maxsize=256)
def _flights(labels: tuple[str, ...], p: Parameters, names: tuple[str, str]) -> Any:
    """Return the `BoxEquations` of a word, for a plane of the parameters `names`."""
    from symosc.certificates.plane import BoxEquations, mirrors

    return BoxEquations(labels, mirrors(p, names))


def _longer_side(box: Rectangle) -> int:
    """Return which side of a box (0 or 1) is longer, relative to the largest absolute value of its
    parameter there.
    """
    sizes = [(high - low) / max(abs(high), abs(low)) for low, high in box]
    return int(sizes[1] > sizes[0])


def border_known(borders: Sequence[Border], a: Place, b: Place) -> bool:
    """Return whether the border between places `a` and `b` is known: `borders` between them have
    both words.
    """
    *point_a, word_a = a
    *point_b, word_b = b
    between = (border for border in borders if crosses(border.points, point_a, point_b))
    words = {word or "" for border in between for word in border._words}
    return {word_a, word_b} <= words


def _is_among(border: Border, borders: Sequence[Border]) -> bool:
    """Return whether one of `borders` has the words of `border` and passes through its middle
    point.
    """
    middle = border.points[len(border) // 2]
    return any(passes(known, middle, border._words) for known in borders)


def crosses(points: np.ndarray, a: Any, b: Any) -> bool:
    """Return whether the polygonal line through `points` crosses the segment from `a` to `b`."""

    def sides(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return on which side of the line from `start` to `end` each point lies, 1, -1 or 0."""
        along = end - start
        to = point - start
        return np.sign(along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0])

    a = np.asarray(a)
    b = np.asarray(b)
    low = points[:-1]
    high = points[1:]
    # Two segments cross if each has its ends on both sides of the other one.
    parted_by_segment = sides(low, a, b) != sides(high, a, b)
    parted_by_line = sides(a, low, high) != sides(b, low, high)
    return bool((parted_by_segment & parted_by_line).any())


def neighbours(grid: Sequence[Place]) -> list[tuple[Place, Place]]:
    """Return all pairs of neighbouring places, side by side or one above the other, of a square
    grid.
    """
    side = GRID + 2
    pairs = []
    for i, place in enumerate(grid):
        if i + 1 < len(grid) and (i + 1) % side:  # else it is the last of its row
            pairs.append((place, grid[i + 1]))
        if i + side < len(grid):
            pairs.append((place, grid[i + side]))
    return pairs


class Cover:
    """A division of the plane into boxes: proven ones, and a queue of those still to prove, the
    larger ones first.
    """

    def __init__(self, plane: ParameterPlane) -> None:
        self.plane = plane
        self.count = 0
        self.area = Fraction(0)
        self.proven = list[ProvenBox]()
        self.small = list[Rectangle]()
        #: Minus the area, so that the largest comes first; a number, so that no tasks are compared.
        self.heap = list[tuple[float, int, BoxTask]]()
        #: Places near to each other with different words.
        self.changes = list[tuple[Place, Place]]()

    def add(self, *tasks: BoxTask) -> None:
        """Add rectangles to prove.

        One where the mass may rest everywhere counts as proven at once.
        """
        for task in tasks:
            sides = zip(task.box, self.plane.range, strict=True)
            shares = [(b - a) / (high - low) for (a, b), (low, high) in sides]
            if self.plane.rests(task.box):
                self.prove(ProvenBox(REST, task.box, ()))
            elif min(shares) < LEAST_SIDE:
                self.small.append(task.box)
            else:
                heapq.heappush(self.heap, (-float(area(task.box)), self.count, task))
                self.count += 1

    def prove(self, *boxes: ProvenBox) -> None:
        """Record boxes as proven, and add their area to the share that is proven."""
        self.proven += boxes
        self.area += sum((area(box.range) for box in boxes), Fraction(0)) / area(self.plane.range)

    def open(self) -> list[Rectangle]:
        """Return the rectangles that are not proven."""
        return [*(task.box for _, _, task in sorted(self.heap)), *self.small]

    def run(self, share: Fraction, until: float, pool: Executor | None, report: Any) -> None:
        """Try to prove the rectangles of the queue until the proven share of the plane is `share`,
        or the time is up.

        `until` is a time of the monotonic clock. The workers of `pool` do the proofs; `report` gets
        (proven, `share`).
        """
        work = self.plane.attempt
        while self.heap and self.area < share and monotonic() < until:
            tasks = list[BoxTask]()
            while self.heap and len(tasks) < BATCH:
                _, _, task = heapq.heappop(self.heap)
                tasks.append(task)
            if pool is None:
                attempts: Iterable[Attempt] = map(work, tasks)
            else:
                attempts = pool.map(work, tasks, chunksize=CHUNK)
            for task, attempt in zip(tasks, attempts, strict=True):
                word = attempt.word
                place = (*middle_of(task.box), word)
                above = task.above
                if above:
                    _, _, word_above = above
                    if word not in ("", word_above):
                        self.changes.append((above, place))
                if attempt.box:
                    self.prove(attempt.box)
                if word:
                    above = place
                self.add(*(part._replace(above=above) for part in attempt.parts))
            report(min(float(self.area), float(share)), float(share))

    def take_up(self, boxes: Sequence[ProvenBox], left: Sequence[Rectangle]) -> None:
        """Add an earlier run's proven `boxes` and, with their orbits as hints, the rectangles
        `left` to prove.
        """
        self.prove(*boxes)
        orbits = [proven for proven in boxes if proven.points]
        plane = self.plane
        sizes = np.array([float(high - low) for low, high in plane.range])
        # One row for each orbit, even if there is none.
        middles = np.array([middle_of(proven.range) for proven in orbits]).reshape(-1, 2) / sizes
        for box in left:
            place = np.array(middle_of(box)) / sizes
            near = dict[tuple[str, ...], LikelyOrbit]()  # one for each word, the nearest
            nearest = np.argsort(((middles - place) ** 2).sum(axis=1), kind="stable")
            for proven in (orbits[i] for i in nearest[:MOST_NEAR]):
                labels = flight_first(proven.word)
                Omega = float(plane.at([(low + high) / 2 for low, high in proven.range]).Omega)
                unknowns = _flights(labels, plane.p, plane.names).unknowns(Omega, proven.points)
                near.setdefault(labels, LikelyOrbit(labels, tuple(unknowns)))
            above = None
            if len(nearest):
                proven = orbits[nearest[0]]
                above = (*middle_of(proven.range), proven.word)
            self.add(BoxTask(box, tuple(near.values()), above=above))


@dataclass(frozen=True, repr=False)
class Atlas(Drawable):
    """The plane of two parameters: the words of the settled motions, and boxes in which a word is
    proven.

    With c > 0 and k > 0 a point of the plane has one word, as an orbit with a flight attracts all
    motions.

    Attributes
    ----------
    parameters : Parameters
        Its other nine parameters are those of the plane.
    over : tuple of two str
        The names of the parameters of the plane.
    range : tuple of two pairs of Fractions
    boxes : tuple of ProvenBox
    open : tuple of pairs of pairs of Fractions
        The rectangles in which nothing is proven.
    grid : tuple of (value, value, word)
        The settled motions that were looked at; no proof.
    borders : tuple of Border
        They were continued from where the word changes on the grid, and from points of codimension
        two.
    belts : int
        The number of belts, by which words are labelled. Files state two: in place of a second one
        there is one out of reach.

    Examples
    --------
    >>> from symosc import atlas, load_scene
    >>> plane = atlas("fig9", {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, prove=0.9, workers=1)
    >>> plane
    <Atlas over Omega and FN: 1 word, 0 borders, 1.000000 of the area proven>
    >>> plane.word_at(Omega=4, FN=10)
    'P32'
    """

    _drawn_by = "atlas_figure"

    parameters: Parameters
    over: tuple[str, str]
    range: Rectangle
    boxes: tuple[ProvenBox, ...]
    open: tuple[Rectangle, ...]
    grid: tuple[Place, ...]
    borders: tuple[Any, ...] = ()
    belts: int = 2

    @property
    def _share(self) -> Fraction:
        """The part of the area in which the word is proven, as an exact fraction."""
        return sum((area(box.range) for box in self.boxes), Fraction(0)) / area(self.range)

    @property
    def proven(self) -> float:
        """The part of the area in which the word is proven, as a float."""
        return float(self._share)

    @cached_property
    def regions(self) -> tuple[Region, ...]:
        """One region per word: its share of the area, and how much of it is proven.

        The largest first.
        """
        whole = area(self.range)
        proven = defaultdict[str, float](float)
        for box in self.boxes:
            proven[box.word] += float(area(box.range) / whole)
        (left_end, right), (bottom, top) = self.range
        # Places on the edge stand for no area.
        inside = [
            (x, y, word) for x, y, word in self.grid if left_end < x < right and bottom < y < top
        ]
        all_words = [word for _, _, word in inside]
        # What is not proven is divided like the places of the grid in which nothing is proven.
        unproven_words = [word for x, y, word in inside if not self._around(x, y).size]
        places_of = Counter(unproven_words or all_words)
        words = set(proven) | set(all_words)
        for border in self.borders:
            words |= {word for word in border.words if word}
        unproven = max(0.0, 1 - sum(proven.values()))
        regions = []
        for word in words:
            estimate = unproven * places_of[word] / max(places_of.total(), 1)
            regions.append(Region(word, proven[word] + estimate, proven[word]))
        return tuple(sorted(regions, key=lambda region: (-region.share, region.word)))

    @property
    def special(self) -> tuple[Any, ...]:
        """The special points of all borders (`SpecialPoint`), folds and points of codimension two,
        each once.
        """
        # Borders that meet have the same point, up to rounding.
        points = dict[tuple[Any, ...], Any]()
        sizes = [float(high - low) for low, high in self.range]
        for point in (point for border in self.borders for point in border.special):
            place = (
                round(value / size, 6) for value, size in zip(point.values, sizes, strict=True)
            )
            points.setdefault((point.kind, *place), point)
        return tuple(points.values())

    @public
    def word_at(self, **values: NumberLike) -> str:
        """Return the word at a point: that of a proven box, else that of the motion which the
        engine finds there.

        Parameters
        ----------
        **values
            Both parameters of the plane by their names: ``word_at(Omega=0.5, FN=0.6)``.

        Returns
        -------
        str
            "rest" where the mass may rest on a belt for ever.

        Raises
        ------
        ParameterError
            If a parameter is missing or out of the range.
        ConvergenceError
            If no box has the point, and the motion does not settle on an orbit that meets a belt.
        """
        require(NUMBER, **values)
        if set(values) != set(self.over):
            raise ParameterError(
                "values", ", ".join(values), f"give {self.over[0]} and {self.over[1]}"
            )
        x, y = (read_exact(name, values[name]) for name in self.over)
        for name, value, (low, high) in zip(self.over, (x, y), self.range, strict=True):
            if not low <= value <= high:
                raise ParameterError(
                    name, values[name], f"must be between {show(low)} and {show(high)}"
                )
        plane = ParameterPlane(self.parameters, self.over, self.range)
        if plane.rests(((x, x), (y, y))):
            return REST
        for i in self._around(float(x), float(y)):
            box = self.boxes[i]
            (low_x, high_x), (low_y, high_y) = box.range
            if low_x <= x <= high_x and low_y <= y <= high_y:
                return box.word
        return str(labelled(canonical(settled_orbit(plane.at((x, y))).labels), self.belts))

    @cached_property
    def _ends(self) -> np.ndarray:
        """An array with a column for each box: low and high end of the first parameter, low and
        high of the second.
        """
        rows = [[float(end) for side in box.range for end in side] for box in self.boxes]
        return np.array(rows).reshape(-1, 4).T

    def _around(self, x: float, y: float) -> np.ndarray:
        """Return the indices of the boxes that contain the point at which the plane's parameters
        are `x` and `y`.
        """
        low_x, high_x, low_y, high_y = self._ends
        return np.flatnonzero((low_x <= x) & (x <= high_x) & (low_y <= y) & (y <= high_y))

    def statement(self) -> Record:
        """Return what `to_json` writes: the plane, the boxes, and what was found without proof
        (grid, borders).
        """

        def pairs(box: Rectangle) -> list[list[str]]:
            return [[show(low), show(high)] for low, high in box]

        return {
            "parameters": self.parameters.as_dict(),
            "over": list(self.over),
            "range": pairs(self.range),
            "share": show(self._share),
            "boxes": [
                {"word": labelled(box.word, 2), "range": pairs(box.range)}
                | {
                    "phases": [f"{phase:.8g}" for phase, _ in box.points],
                    "x": [f"{x:.8g}" for _, x in box.points],
                }
                for box in self.boxes
            ],
            "open": [pairs(box) for box in self.open],
            "found": {
                "grid": [[x, y, labelled(word, 2)] for x, y, word in self.grid],
                "borders": [
                    border.as_dict() | {"words": list(border._words)} for border in self.borders
                ],
            },
        }

    @public
    def to_json(self, path: str | Path) -> None:
        """Write the atlas to a JSON file that `symosc verify` can prove again ("-": to standard
        output).
        """
        about = {"format": FORMAT, "kind": "atlas", "proven": bool(self.boxes), "made_by": "symosc"}
        text = json.dumps(about | self.statement(), separators=(",", ":"))
        write_text(path, text.replace('{"word"', '\n{"word"') + "\n")

    def __repr__(self) -> str:
        words = len([region for region in self.regions if region.word])
        borders = len(self.borders)
        about = f"{words} word{'s' * (words != 1)}, {borders} border{'s' * (borders != 1)}"
        return (
            f"<Atlas over {self.over[0]} and {self.over[1]}: {about}, {self.proven:.6f} of the "
            "area proven>"
        )


@public
def atlas(
    what: Scene | Parameters | SceneName,
    over: Mapping[str, tuple[NumberLike, NumberLike]],
    *,
    prove: NumberLike = 0,
    seconds: NumberLike | None = None,
    workers: int | None = None,
    path: str | Path | None = None,
    progress: Progress = False,
) -> Atlas:
    """Draw up the plane of two parameters: the words of the settled motions, their borders, and
    boxes with proofs.

    The words are first looked for on a grid. Where two neighbours differ, the border between their
    words is continued. Other borders begin at that border's points of codimension two, and are
    continued in turn (`symosc.continue_border`). A box is proven if an orbit of its word exists,
    and is admissible, for all parameters in the box: then all motions settle on that orbit (extra
    ``certify``).

    Parameters
    ----------
    what : Scene, Parameters, str or Path
        With c > 0 and k > 0; the start of a scene does not matter.
    over : mapping
        Two parameters and their ranges: ``{"Omega": (0.3, 2), "FN": (0.05, 1)}``.
    prove : number
        The part of the area to prove, from 0 to 1.
    seconds : number, optional
        When to stop proving.
    workers : int, optional
        Processes; default: one for each core. The result does not depend on it, unless the time is
        up.
    path : str or Path, optional
        A JSON file: what an earlier call with the same plane has left there is taken up; the result
        is written there.
    progress : bool or callable
        True: a bar, on a terminal. Or what gets the part proven, and the part to prove.

    Raises
    ------
    ParameterError
        If a range or a number is wrong, or the file is that of another plane.
    MissingExtraError
        Without python-flint, if something is to be proven.

    Examples
    --------
    >>> from symosc import atlas
    >>> atlas("fig9", {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, workers=1).word_at(Omega=4, FN=10)
    'P32'
    """
    p = parameters_of(scene_of(what, "what"))
    belts = len(model_of(what, "what").law.belts)
    require(mapping_of(row_of(2, NUMBER)), over=over)
    require_or_none(*FILE, path=path)
    require(*PROGRESS, progress=progress)
    began = monotonic()
    plane = _read_plane(p, over)
    share = read_exact("prove", prove)
    if not 0 <= share <= 1:
        raise ParameterError("prove", prove, "must be a part of the area, from 0 to 1")
    if seconds is None:
        limit = float("inf")
    else:
        limit = float(read_exact("seconds", seconds))
    if limit <= 0:
        raise ParameterError("seconds", seconds, "must be > 0")
    if workers is not None:
        count = whole_number("workers", workers, 1)
    else:
        count = os.cpu_count() or 1
    if share > 0:
        import symosc.certificates.balls  # noqa: F401  says so if python-flint is not installed
    if path is not None and path != STDOUT:
        check_folder_of(path)
    cover = Cover(plane)
    earlier = path is not None and Path(path).exists()
    if earlier:
        stored = _read_file(path)
        if stored.plane != plane:
            raise ParameterError(
                "path", path, "must not be the atlas of another plane; name another file"
            )
    with (
        process_pool(count) if count > 1 else nullcontext() as pool,
        reporting(progress, 0, float(share), "proven", "") as report,
    ):
        if earlier:
            grid = stored.grid
            pairs = stored.pairs
            cover.take_up(stored.boxes, stored.open)
        else:
            grid = plane.grid(pool)
            pairs = neighbours(grid)
            cover.add(*map(BoxTask, plane.cut_at_rest()))
        borders = plane.borders(pairs)
        cover.run(share, began + limit, pool, report)
    borders = plane.borders(cover.changes, borders)  # those that the grid has missed
    for border in borders:
        border._belts = belts
    boxes = [box._replace(word=str(labelled(box.word, belts))) for box in cover.proven]
    named = tuple((x, y, str(labelled(word, belts))) for x, y, word in grid)
    made = Atlas(*plane, tuple(boxes), tuple(cover.open()), named, tuple(borders), belts)
    if path is not None:
        made.to_json(path)
    return made


def _read_plane(p: Parameters, over: Mapping[str, Any]) -> ParameterPlane:
    """Check the arguments of `atlas`, and return the oscillator, both names and both ranges as a
    `ParameterPlane`.
    """
    if len(over) != 2 or not set(over) <= set(PARAMETER_NAMES):
        names = ", ".join(PARAMETER_NAMES)
        raise ParameterError(
            "over", ", ".join(map(str, over)), f"give two parameters out of {names}"
        )
    ranges = []
    for name, limits in over.items():
        if np.array(limits, dtype=object).shape != (2,):
            raise ParameterError(name, limits, "give its lowest and its highest value")
        low, high = (read_exact(name, value) for value in limits)
        if not low < high:
            raise ParameterError(
                name, f"{show(low)}:{show(high)}", "give its lowest value before its highest"
            )
        ranges.append((low, high))
    first, second = over
    plane = ParameterPlane(p, (first, second), (ranges[0], ranges[1]))
    for name, at in product("ck", map(plane.at, product(*ranges))):
        if getattr(at, name) <= 0:
            raise ParameterError(
                name, getattr(at, name), "must be > 0: else a point need not have one word"
            )
    return plane


class StoredAtlas(NamedTuple):
    """What the file of an atlas has: its plane, proven and open boxes, grid, and a pair of places on
    both sides of each border.
    """

    plane: ParameterPlane
    boxes: list[ProvenBox]
    open: list[Rectangle]
    grid: tuple[Place, ...]
    pairs: list[tuple[Place, Place]]


def _read_file(path: Any) -> StoredAtlas:
    """Read the file of an atlas, or raise ParameterError."""

    def box(sides: Any) -> Rectangle:
        """Return a rectangle from the texts of its ends."""
        (left, right), (low, high) = ([Fraction(end) for end in side] for side in sides)
        return (left, right), (low, high)

    try:
        data = json.loads(Path(path).read_text(encoding="utf-8"))
        first, second = data["over"]
        plane = ParameterPlane(
            Parameters(**data["parameters"]), (first, second), box(data["range"])
        )
        boxes = []
        pairs = []
        for row in data["boxes"]:
            points = zip(map(float, row["phases"]), map(float, row["x"]), strict=True)
            boxes.append(ProvenBox(row["word"], box(row["range"]), tuple(points)))
        low, high = np.array(plane.range, dtype=float).T
        for row in data["found"]["borders"]:
            middle, across = plane.across(np.array(row["points"], dtype=float))
            word_before, word_behind = row["words"]
            before, behind = (
                np.clip(middle + share * across, low, high).tolist() for share in (-BESIDE, BESIDE)
            )
            pairs.append(((*before, word_before or ""), (*behind, word_behind or "")))
        grid = tuple((float(x), float(y), str(word)) for x, y, word in data["found"]["grid"])
        return StoredAtlas(plane, boxes, [box(sides) for sides in data["open"]], grid, pairs)
    except (OSError, ValueError, LookupError, TypeError) as error:
        reason = f"is no file of an atlas ({type(error).__name__}: {str(error)[:80]})"
        raise ParameterError("path", path, reason) from None
