"""`atlas`: the plane of two parameters, as regions with words, their borders, and boxes in which a word is proven."""

from __future__ import annotations

import heapq
import json
import os
from collections import Counter, defaultdict, deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache, partial
from itertools import product
from math import log2
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

import numpy as np

from symosc.aliases import NumberLike, Progress, Record, SceneName
from symosc.arguments import public
from symosc.certificates.certificate import FORMAT
from symosc.display.drawable import Drawable
from symosc.display.progress import reporting
from symosc.errors import ParameterError
from symosc.exact import read_exact, show, whole_number
from symosc.files import STDOUT, check_folder_of, write_text
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.border import REST, Border, BorderError, borders_between, network, passes
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit
from symosc.scenes import Scene, load_scene
from symosc.sweeps.plan import cycles
from symosc.words import Word, read_word

#: Boxes that are tried between two looks at the clock, and in one call of a worker.
BATCH, CHUNK = 64, 8
#: Orbits of other words that are kept for the parts of a rectangle.
MOST_NEAR = 3
#: Boxes whose sides are a smaller part of the ranges are not divided further.
LEAST_SIDE = Fraction(1, 1 << 24)
#: So often it is tried to find a border between two words; the part of the plane beside a border at which it is found.
MOST_FAILED, BESIDE = 3, 1e-4
#: So far inside of the plane's edge a place is looked at.
EDGE = 1e-6

#: Points of the grid along each side; as parts: the longest step along a border.
GRID, BORDER_STEP = 12, 0.005
REST_NAMES = ("v1", "v2", "mu1", "mu2", "FN", "B0")

Rectangle = tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]
#: Labels of a word in order of time, and the unknowns of its orbit, nearly (`symosc.certificates.plane`).
Candidate = tuple[tuple[str, ...], tuple[float, ...]]
#: Both parameters and the word there, "" if it has none.
Place = tuple[float, float, str]


class Task(NamedTuple):
    """A rectangle to prove, and orbits that may be near, the more probable ones first; `divide`: it is too large."""

    box: Rectangle
    near: tuple[Candidate, ...]
    divide: int = 0
    #: The middle of a rectangle around it or beside it, and the word there.
    above: Place | None = None


class Tried(NamedTuple):
    """What came of a task: the word, or "" and the parts to try; the orbit at the middle, and its word."""

    word: str
    points: tuple[tuple[float, float], ...]
    parts: tuple[Task, ...]
    seen: str = ""


class ProvenBox(NamedTuple):
    """A box of both parameters in which a word is proven.

    Attributes
    ----------
    word : str
        "rest" where the mass may rest on a belt for ever.
    range : tuple of two pairs of Fractions
        The lower and the upper value of each parameter.
    points : tuple of (phase, x)
        The switchings of the orbit at the middle of the box, nearly; from its first flight on.
    """

    word: str
    range: Rectangle
    points: tuple[tuple[float, float], ...]


class Region(NamedTuple):
    """Where a word is, in an atlas.

    Attributes
    ----------
    word : str
        "rest" where the mass may rest on a belt for ever, "" where it was not found.
    share : float
        Its part of the area, estimated where it is not proven.
    proven : float
        The part of the area in which it is proven.
    """

    word: str
    share: float
    proven: float


def area(box: Rectangle) -> Fraction:
    """Return the area of a rectangle."""
    (a, b), (c, d) = box
    return (b - a) * (d - c)


def middle_of(box: Rectangle, word: str) -> Place:
    """Return the middle of a rectangle, with its word."""
    x, y = (float(low + high) / 2 for low, high in box)
    return x, y, word


def divided(box: Rectangle, along: int, at: Fraction | None = None) -> list[Rectangle]:
    """Return the halves of a rectangle, or its parts on both sides of a value."""
    (low, high), other = box[along], box[1 - along]
    middle = (low + high) / 2 if at is None else at
    if not low < middle < high:
        return [box]
    return [(part, other) if along == 0 else (other, part) for part in ((low, middle), (middle, high))]


@lru_cache(maxsize=256)
def _flights(labels: tuple[str, ...], p: Parameters, names: tuple[str, str]) -> Any:
    from symosc.certificates.plane import Flights, mirrors

    return Flights(labels, mirrors(p, names))


def orbit_near(p: Parameters, names: tuple[str, str], box: Rectangle) -> Candidate | None:
    """Return the orbit to which the motion at the middle of a box settles; None if it is not found."""
    middle = p.replace(**{name: (low + high) / 2 for name, (low, high) in zip(names, box, strict=True)})
    try:
        orbit = find_orbit(middle)
    except ConvergenceError:
        return None
    if not orbit.admissible or orbit.periods != 1:
        return None
    Omega, wanted = float(middle.Omega), flight_first(canonical(orbit.labels))
    turns = (orbit.labels[i:] + orbit.labels[:i] for i in range(len(wanted)))
    first = next(i for i, labels in enumerate(turns) if labels == wanted)
    points = [(t * Omega, x) for t, x in orbit.points[first:] + orbit.points[:first]]
    return wanted, tuple(_flights(wanted, p, names).unknowns(Omega, points))


def flight_first(word: str) -> tuple[str, ...]:
    """Return the labels of a word in order of time, begun with a flight."""
    labels = read_word(word).labels
    first = next(i for i, label in enumerate(labels) if label not in ("P1", "P4"))
    return labels[first:] + labels[:first]


def attempt(p: Parameters, names: tuple[str, str], task: Task) -> Tried:
    """Try to prove a rectangle with the orbits near its middle; divide it if that fails."""
    from symosc.certificates.plane import NotInBox, Surface, box_arithmetic

    box, along, found, surface = task.box, None, list(task.near), None
    candidates = iter(task.near)
    while surface is None:
        candidate = next(candidates, None)
        if candidate is None:
            if len(found) > len(task.near) or (candidate := orbit_near(p, names, box)) is None:
                break
            found.insert(0, candidate)
        labels, unknowns = candidate
        try:
            with box_arithmetic():
                surface = Surface(p, names, box, _flights(labels, p, names), unknowns)
        except NotInBox:
            continue
    if surface is None:
        return Tried("", (), tuple(Task(part, tuple(found[:MOST_NEAR])) for part in divided(box, _longer(box))))
    try:
        with box_arithmetic():
            if not task.divide:
                surface.prove()
                return Tried(canonical(labels), tuple(surface.points()), ())
            divide = task.divide - 1
    except NotInBox as reason:
        along, divide = reason.along, int(log2(max(reason.excess, 1)) / 2) if reason.excess < 1e6 else 3
    along = _longer(box) if along is None else along
    others = [each for each in found if each[0] != labels][: MOST_NEAR - 1]
    places = ((-0.5, 0), (0.5, 0)) if along == 0 else ((0, -0.5), (0, 0.5))
    near = [(labels, surface.near(*place)) for place in places]
    others.insert(0, (labels, surface.near(0, 0)))
    parts = [Task(part, (each, *others), divide) for part, each in zip(divided(box, along), near, strict=True)]
    return Tried("", (), tuple(parts), canonical(labels))


def canonical(labels: Sequence[str]) -> str:
    """Return the text of a word, the same for all its rotations."""
    return str(cycles(np.array([str(Word(tuple(labels)))]))[0])


def _longer(box: Rectangle) -> int:
    """Return the side of a box that is the longer part of its middle."""
    sizes = [(high - low) / max(abs(high), abs(low)) for low, high in box]
    return int(sizes[1] > sizes[0])


def may_rest(p: Parameters, names: tuple[str, str], box: Rectangle) -> bool | None:
    """Return whether the mass may rest on a belt for all parameters of a box; None: for some of them."""
    ends = {name: (value, value) for name in REST_NAMES for value in [getattr(p, name)]}
    ends |= {name: both for name, both in zip(names, box, strict=True) if name in ends}
    low, high = sorted((abs(ends["B0"][0]), abs(ends["B0"][1])))
    low = Fraction(0) if ends["B0"][0] < 0 < ends["B0"][1] else low
    some = False
    for belt in "12":
        if ends["v" + belt] == (0, 0):
            least, most = (ends["mu" + belt][i] * ends["FN"][i] for i in (0, 1))
            if least >= high:
                return True
            some = some or most > low
    return None if some else False


def cut_at_rest(p: Parameters, names: tuple[str, str], box: Rectangle) -> list[Rectangle]:
    """Return the parts of a box between the borders of rest that are parallel to a side."""
    parts = [box]
    for belt in "12":
        free = [name for name in ("mu" + belt, "FN", "B0") if name in names]
        if f"v{belt}" in names or p.belt(int(belt)) != 0 or len(free) != 1:
            continue
        mu, along = getattr(p, "mu" + belt), names.index(free[0])
        held = {"B0": mu * p.FN, "FN": abs(p.B0) / mu if mu else 0, "mu" + belt: abs(p.B0) / p.FN if p.FN else 0}[
            free[0]
        ]
        for at in (held, -held):
            parts = [each for part in parts for each in divided(part, along, at)]
    return parts


class Cover:
    """Boxes of the plane: those that are proven, and those that are not, the larger ones first."""

    def __init__(self, p: Parameters, names: tuple[str, str], whole: Rectangle) -> None:
        self.p, self.names, self.whole, self.count = p, names, whole, 0
        self.proven, self.area, self.small = list[ProvenBox](), Fraction(0), list[Rectangle]()
        self.heap = list[tuple[float, int, Task]]()
        #: Places near to each other with different words.
        self.changes = list[tuple[Place, Place]]()

    def add(self, *tasks: Task) -> None:
        """Add rectangles to prove; what rests there is known at once."""
        for task in tasks:
            sides = zip(task.box, self.whole, strict=True)
            if may_rest(self.p, self.names, task.box):
                self.prove(ProvenBox(REST, task.box, ()))
            elif min((b - a) / (d - c) for (a, b), (c, d) in sides) < LEAST_SIDE:
                self.small.append(task.box)
            else:
                heapq.heappush(self.heap, (-float(area(task.box)), self.count, task))
                self.count += 1

    def prove(self, box: ProvenBox) -> None:
        """Add a proven box."""
        self.proven.append(box)
        self.area += area(box.range)

    @property
    def share(self) -> Fraction:
        """The part of the area that is proven."""
        return self.area / area(self.whole)

    def open(self) -> list[Rectangle]:
        """Return what is not proven."""
        return [*(task.box for _, _, task in sorted(self.heap)), *self.small]

    def run(self, share: Fraction, until: float, pool: Executor | None, report: Any) -> None:
        """Prove boxes until a part of the area is proven, or until a time."""
        work = partial(attempt, self.p, self.names)
        while self.heap and self.share < share and monotonic() < until:
            tasks = [heapq.heappop(self.heap)[2] for _ in range(min(BATCH, len(self.heap)))]
            results = map(work, tasks) if pool is None else pool.map(work, tasks, chunksize=CHUNK)
            for task, tried in zip(tasks, results, strict=True):
                place, above = middle_of(task.box, tried.word or tried.seen), task.above
                if above and place[2] not in ("", above[2]):
                    self.changes.append((above, place))
                if tried.word:
                    self.prove(ProvenBox(tried.word, task.box, tried.points))
                self.add(*(part._replace(above=place if place[2] else above) for part in tried.parts))
            report(min(float(self.share), float(share)), float(share))

    def taken_up(self, boxes: Sequence[ProvenBox], left: Sequence[Rectangle]) -> None:
        """Take up the boxes of an earlier run: the orbits near an open one are those of the nearest proven ones."""
        for each in boxes:
            self.prove(each)
        orbits = [each for each in boxes if each.points]
        sizes = np.array([float(high - low) for low, high in self.whole])
        middles = np.array([[float(a + b) / 2 for a, b in each.range] for each in orbits]).reshape(-1, 2) / sizes
        for box in left:
            place = np.array([float(a + b) / 2 for a, b in box]) / sizes
            near, nearest = dict[tuple[str, ...], Candidate](), np.argsort(((middles - place) ** 2).sum(axis=1))
            for i in nearest[:MOST_NEAR]:
                labels = flight_first(orbits[i].word)
                middle = {name: (a + b) / 2 for name, (a, b) in zip(self.names, orbits[i].range, strict=True)}
                Omega = float(middle.get("Omega", self.p.Omega))
                unknowns = _flights(labels, self.p, self.names).unknowns(Omega, orbits[i].points)
                near.setdefault(labels, (labels, tuple(unknowns)))
            above = middle_of(orbits[nearest[0]].range, orbits[nearest[0]].word) if orbits else None
            self.add(Task(box, tuple(near.values()), above=above))


@dataclass(frozen=True, repr=False)
class Atlas(Drawable):
    """The plane of two parameters: which word the settled motion has where, and where that is proven.

    With c > 0 and k > 0 a point of the plane has one word, as an orbit with a flight attracts all motions.

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
        Continued from where the word changes on the grid, and from their points of codimension two.

    Examples
    --------
    >>> from symosc import atlas, load_scene
    >>> plane = atlas("fig9", {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, prove=0.9, workers=1)
    >>> plane
    <Atlas over Omega and FN: 1 word, 0 borders, 1.000000 of the area proven>
    >>> plane.word_at(Omega=4, FN=10)
    'P32'
    """

    parameters: Parameters
    over: tuple[str, str]
    range: Rectangle
    boxes: tuple[ProvenBox, ...]
    open: tuple[Rectangle, ...]
    grid: tuple[Place, ...]
    borders: tuple[Any, ...] = ()

    @property
    def proven(self) -> float:
        """The part of the area in which the word is proven."""
        return float(sum((area(box.range) for box in self.boxes), Fraction(0)) / area(self.range))

    @cached_property
    def regions(self) -> tuple[Region, ...]:
        """One region per word: its share of the area, and how much of it is proven; the largest first."""
        whole, proven = area(self.range), defaultdict[str, float](float)
        for box in self.boxes:
            proven[box.word] += float(area(box.range) / whole)
        (left_end, right), (bottom, top) = self.range
        looked = [each for each in self.grid if left_end < each[0] < right and bottom < each[1] < top]
        outside = [word for x, y, word in looked if not self._around(x, y).size]
        seen = Counter(outside or [word for *_, word in looked])
        words = {
            *proven,
            *(word for *_, word in looked),
            *(word for border in self.borders for word in border.words if word),
        }
        left = max(0.0, 1 - sum(proven.values()))
        found = [Region(word, proven[word] + left * seen[word] / max(seen.total(), 1), proven[word]) for word in words]
        return tuple(sorted(found, key=lambda each: (-each.share, each.word)))

    @property
    def special(self) -> tuple[Any, ...]:
        """The folds of borders and points of codimension two, each once."""
        found, size = dict[tuple[Any, ...], Any](), [float(high - low) for low, high in self.range]
        for border in self.borders:
            for each in border.special:
                found.setdefault((each.kind, *(round(v / s, 6) for v, s in zip(each.values, size, strict=True))), each)
        return tuple(found.values())

    @public
    def word_at(self, **values: NumberLike) -> str:
        """Return the word at a point: that of a proven box, else that of the motion which the engine finds there.

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
        if set(values) != set(self.over):
            raise ParameterError("values", ", ".join(values), f"give {self.over[0]} and {self.over[1]}")
        point = [read_exact(name, values[name]) for name in self.over]
        for name, value, (low, high) in zip(self.over, point, self.range, strict=True):
            if not low <= value <= high:
                raise ParameterError(name, values[name], f"must be between {show(low)} and {show(high)}")
        exact = tuple((value, value) for value in point)
        if may_rest(self.parameters, self.over, (exact[0], exact[1])):
            return REST
        for i in self._around(*map(float, point)):
            box = self.boxes[i]
            if all(low <= value <= high for value, (low, high) in zip(point, box.range, strict=True)):
                return box.word
        return canonical(find_orbit(self.parameters.replace(**dict(zip(self.over, point, strict=True)))).labels)

    @cached_property
    def _ends(self) -> np.ndarray:
        """The ends of the boxes, a row for each side."""
        rows = [[float(end) for side in box.range for end in side] for box in self.boxes]
        return np.array(rows).reshape(-1, 4).T

    def _around(self, x: float, y: float) -> np.ndarray:
        """Return the indices of the boxes with a point."""
        low_x, high_x, low_y, high_y = self._ends
        return np.flatnonzero((low_x <= x) & (x <= high_x) & (low_y <= y) & (y <= high_y))

    def statement(self) -> Record:
        """Return what the file states: the boxes, and beside them what was found and is not proven."""

        def pairs(box: Rectangle) -> list[list[str]]:
            return [[show(low), show(high)] for low, high in box]

        found = {
            "grid": [list(each) for each in self.grid],
            "borders": [border.as_dict() for border in self.borders],
        }
        return {
            "parameters": self.parameters.as_dict(),
            "over": list(self.over),
            "range": pairs(self.range),
            "share": show(sum((area(box.range) for box in self.boxes), Fraction(0)) / area(self.range)),
            "boxes": [
                {"word": box.word, "range": pairs(box.range)}
                | {"phases": [f"{phase:.8g}" for phase, _ in box.points], "x": [f"{x:.8g}" for _, x in box.points]}
                for box in self.boxes
            ],
            "open": [pairs(box) for box in self.open],
            "found": found,
        }

    def to_json(self, path: str | Path) -> None:
        """Write the atlas as JSON, which `symosc verify` proves ("-": to standard output)."""
        about = {"format": FORMAT, "kind": "atlas", "proven": bool(self.boxes), "made_by": "symosc"}
        write_text(
            path, json.dumps(about | self.statement(), separators=(",", ":")).replace('{"word"', '\n{"word"') + "\n"
        )

    def __repr__(self) -> str:
        words, borders = len([each for each in self.regions if each.word]), len(self.borders)
        about = f"{words} word{'s' * (words != 1)}, {borders} border{'s' * (borders != 1)}"
        return f"<Atlas over {self.over[0]} and {self.over[1]}: {about}, {self.proven:.6f} of the area proven>"


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
    """Draw up the plane of two parameters: the words of the settled motions, their borders, and boxes with proofs.

    The words are first looked for on a grid. Where they change, borders are continued, and from their points of
    codimension two others in turn (`symosc.continue_border`). A box is proven if an orbit of its word exists, and is
    admissible, for all of its parameters: then it is the motion that settles (extra ``certify``).

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
        Processes; default: one for each core. The result does not depend on it, unless the time is up.
    path : str or Path, optional
        A JSON file: what an earlier call with the same plane has left there is taken up; the result is written there.
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
    began = monotonic()
    p = what if isinstance(what, Parameters) else (what if isinstance(what, Scene) else load_scene(what)).parameters
    names, whole = _read_plane(p, over)
    share = read_exact("prove", prove)
    if not 0 <= share <= 1:
        raise ParameterError("prove", prove, "must be a part of the area, from 0 to 1")
    limit = float("inf") if seconds is None else float(read_exact("seconds", seconds))
    if limit <= 0:
        raise ParameterError("seconds", seconds, "must be > 0")
    count = whole_number("workers", workers, 1) if workers is not None else os.cpu_count() or 1
    if share > 0:
        import symosc.certificates.balls  # noqa: F401  says so if python-flint is not installed
    if path is not None and path != STDOUT:
        check_folder_of(path)
    left = None if path is None or not Path(path).exists() else read_atlas(path)
    if left is not None and (left.parameters, left.over, left.range) != (p, names, whole):
        raise ParameterError("path", path, "is the atlas of another plane: name another file")
    cover = Cover(p, names, whole)
    with (
        ProcessPoolExecutor(count) if count > 1 else nullcontext() as pool,
        reporting(progress, 0, float(share), "proven", "") as report,
    ):
        if left is None:
            grid = looked_at(p, names, whole, pool)
            borders = borders_of(p, names, whole, neighbours(grid))
            cover.add(*(Task(part, ()) for part in cut_at_rest(p, names, whole)))
        else:
            grid, borders = left.grid, list(left.borders)
            cover.taken_up(left.boxes, left.open)
        cover.run(share, began + limit, pool, report)
    borders = borders_of(p, names, whole, cover.changes, borders)  # those that the grid has missed
    made = Atlas(p, names, whole, tuple(cover.proven), tuple(cover.open()), grid, tuple(borders))
    if path is not None:
        made.to_json(path)
    return made


def _read_plane(p: Parameters, over: Mapping[str, Any]) -> tuple[tuple[str, str], Rectangle]:
    """Return the names of both parameters, and their ranges."""
    if len(over) != 2 or not set(over) <= set(PARAMETER_NAMES):
        raise ParameterError(
            "over", ", ".join(map(str, over)), f"give two parameters out of {', '.join(PARAMETER_NAMES)}"
        )
    ranges = []
    for name, limits in over.items():
        if np.ndim(np.asarray(limits, dtype=object)) != 1 or len(limits) != 2:
            raise ParameterError(name, limits, "give its lowest and its highest value")
        low, high = (read_exact(name, value) for value in limits)
        if not low < high:
            raise ParameterError(name, f"{show(low)}:{show(high)}", "give its lowest value before its highest")
        ranges.append((low, high))
    first, second = over
    for corner in product(*ranges):
        at = p.replace(**dict(zip(over, corner, strict=True)))
        for name in "ck":
            if getattr(at, name) <= 0:
                raise ParameterError(name, getattr(at, name), "must be > 0: else a point need not have one word")
    return (first, second), (ranges[0], ranges[1])


def looked_at(p: Parameters, names: tuple[str, str], whole: Rectangle, pool: Any) -> tuple[Place, ...]:
    """Return the words of the settled motions on a grid and on the edges, row by row; "" where none is found."""
    parts = [Fraction(0), *(Fraction(2 * i + 1, 2 * GRID) for i in range(GRID)), Fraction(1)]
    axes = [[low + (high - low) * part for part in parts] for low, high in whole]
    points = [((x, x), (y, y)) for x in axes[0] for y in axes[1]]
    work = partial(_word_of, p, names)
    words = map(work, points) if pool is None else pool.map(work, points, chunksize=CHUNK)
    return tuple((float(x[0]), float(y[0]), word) for (x, y), word in zip(points, words, strict=True))


def neighbours(grid: Sequence[Place]) -> list[tuple[Place, Place]]:
    """Return the pairs of neighbours on a grid."""
    side = GRID + 2
    ends = ((i, j) for i in range(len(grid)) for j in (i + 1, i + side) if j < len(grid) and (j != i + 1 or j % side))
    return [(grid[i], grid[j]) for i, j in ends]


def _word_of(p: Parameters, names: tuple[str, str], point: Rectangle) -> str:
    """Return the word at a point; "" if it is not found."""
    if may_rest(p, names, point):
        return REST
    try:
        return canonical(
            find_orbit(p.replace(**{name: low for name, (low, _) in zip(names, point, strict=True)})).labels
        )
    except ConvergenceError:
        return ""


def borders_of(
    p: Parameters,
    names: tuple[str, str],
    whole: Rectangle,
    pairs: Sequence[tuple[Place, Place]],
    known: Sequence[Border] = (),
) -> list[Border]:
    """Return the known borders, those between places with different words, and all that are connected with these."""
    found, failed, looked = list(known), Counter[frozenset[str]](), len(known)
    waiting = deque(pairs)
    while waiting:
        a, b = waiting.popleft()
        words = frozenset((a[2], b[2]))
        if len(words) < 2 or failed[words] >= MOST_FAILED or explained(found, a, b):
            continue
        try:
            for border in between(p, names, whole, a[:2], b[:2]):
                if not _among(border, found):
                    found += [each for each in network(border, step=BORDER_STEP) if not _among(each, found)]
        except (BorderError, ConvergenceError):
            pass
        failed[words] += not explained(found, a, b)
        for border in found[looked:]:
            waiting += beyond(p, names, whole, border)
        looked = len(found)
    return found


def beyond(p: Parameters, names: tuple[str, str], whole: Rectangle, border: Border) -> Iterator[tuple[Place, Place]]:
    """Yield a place beside the middle of a border and one straight ahead at the plane's edge, on both sides of it."""
    middle, way = across(border.points, whole)
    for step in (way, -way):
        reach = min(
            ((high if by > 0 else low) - value) / by
            for (low, high), value, by in zip(np.array(whole, dtype=float), middle, step, strict=True)
            if by
        )
        if reach > 2 * BESIDE:
            ends = [(middle + part * step).tolist() for part in (BESIDE, reach * (1 - EDGE))]
            a, b = ((x, y, _word_of(p, names, ((Fraction(x),) * 2, (Fraction(y),) * 2))) for x, y in ends)
            yield a, b


def between(p: Parameters, names: tuple[str, str], whole: Rectangle, a: Any, b: Any) -> list[Border]:
    """Return the borders that cross the segment between two points of the plane."""
    ends = [p.replace(**dict(zip(names, at, strict=True))) for at in (a, b)]
    return borders_between(ends[0], ends[1], names, dict(zip(names, whole, strict=True)), step=BORDER_STEP)


def explained(found: Sequence[Border], a: Place, b: Place) -> bool:
    """Return whether the borders that cross the segment between two places have both words."""
    words = {word or "" for each in found if crosses(each.points, a[:2], b[:2]) for word in each.words}
    return {a[2], b[2]} <= words


def across(border_points: np.ndarray, whole: Rectangle) -> tuple[np.ndarray, np.ndarray]:
    """Return the middle of a border, and the direction at a right angle to it, in units of the ranges."""
    middle, size = len(border_points) // 2, np.array([float(high - low) for low, high in whole])
    along = (border_points[middle] - border_points[middle - 1]) / size
    return border_points[middle], np.array([along[1], -along[0]]) / np.hypot(*along) * size


def _among(border: Border, found: Sequence[Border]) -> bool:
    """Return whether a border is one of those found."""
    return any(passes(each, border.points[len(border) // 2], border.words) for each in found)


def crosses(points: np.ndarray, a: Any, b: Any) -> bool:
    """Return whether a line through points crosses the segment from a to b."""

    def sides(of: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        along, to = end - start, of - start
        return np.sign(along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0])

    a, b, low, high = np.asarray(a), np.asarray(b), points[:-1], points[1:]
    return bool(((sides(low, a, b) != sides(high, a, b)) & (sides(a, low, high) != sides(b, low, high))).any())


def _followed_again(p: Parameters, names: tuple[str, str], whole: Rectangle, points: np.ndarray) -> list[Border]:
    """Return the borders between both sides of the middle of a known one."""
    middle, way = across(points, whole)
    try:
        low, high = np.array(whole, dtype=float).T
        return between(p, names, whole, *(np.clip(middle + by * way, low, high) for by in (-BESIDE, BESIDE)))
    except (BorderError, ConvergenceError):
        return []  # it is looked for once more where it is needed


def read_atlas(path: str | Path) -> Atlas:
    """Read the file of an atlas; its borders are followed again from where they were."""
    try:
        data = json.loads(Path(path).read_text(encoding="utf-8"))
        p = Parameters(**data["parameters"])

        def box(sides: Any) -> Rectangle:
            (a, b), (c, d) = ([Fraction(end) for end in side] for side in sides)
            return (a, b), (c, d)

        boxes = tuple(
            ProvenBox(
                row["word"],
                box(row["range"]),
                tuple((float(t), float(x)) for t, x in zip(row["phases"], row["x"], strict=True)),
            )
            for row in data["boxes"]
        )
        first, second = data["over"]
        grid = tuple((float(x), float(y), str(word)) for x, y, word in data["found"]["grid"])
        names, whole, borders = (first, second), box(data["range"]), list[Border]()
        for row in data["found"]["borders"]:
            for border in _followed_again(p, names, whole, np.array(row["points"], dtype=float)):
                borders += [border] * (not _among(border, borders))
        return Atlas(p, names, whole, boxes, tuple(map(box, data["open"])), grid, tuple(borders))
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise ParameterError(
            "path", path, f"is no file of an atlas ({type(error).__name__}: {str(error)[:80]})"
        ) from None
