"""Borders: the curves in a plane of two parameters on which branches end, and the points where they
meet.

A border is followed by pseudo-arclength continuation (`symosc.orbits.border_trace`) of the
equations in `symosc.orbits.border_system`. It ends where another inequality of its orbit vanishes,
where its own zero is no simple one any more, or at the end of the range. Those points of
codimension two, and the folds of the curve, are located with many digits
(`symosc.orbits.border_points`). The borders that leave a point are found on a small circle around
it: the words of the settled motion are bisected along the circle
(`symosc.orbits.border_crossings`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import chain, pairwise
from math import inf
from typing import Any

import numpy as np

from symosc.base.aliases import NumberLike, Record
from symosc.base.arguments import NUMBER, TEXT, WHOLE, mapping_of, public, require, row_of
from symosc.base.display.drawable import Drawable
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import read_exact, whole_number
from symosc.base.quantities import least
from symosc.kernels import linear
from symosc.kernels.entire import EPS
from symosc.model import PARAMETER_NAMES, Model, Parameters, some
from symosc.orbits.admissibility import BIRTH, GRAZING, SLIP_BIRTH, VANISHING
from symosc.orbits.border_crossings import (
    BESIDE,
    Begun,
    BorderError,
    all_crossings,
    closed_form,
    first_crossing,
    loss_of_word,
)
from symosc.orbits.border_points import (
    FOLD,
    MOST_HALVINGS,
    PlacedOrbit,
    SpecialPoint,
    between,
    circle,
    motion_at,
)
from symosc.orbits.border_system import REST, BorderPlane, BorderSystem, Node
from symosc.orbits.border_trace import BorderEnd, followed
from symosc.orbits.branch import (
    MOST,
    NO_CONVERGENCE,
    RANGE,
    Branch,
    BranchSpecial,
    read_range,
)
from symosc.orbits.closing_equations import ConvergenceError, Orbit
from symosc.orbits.find import settled_orbit
from symosc.orbits.floquet import rest_positions
from symosc.orbits.law_border import (
    ONSET,
    BorderBegun,
    LawBorderSystem,
    OnsetSystem,
    begun_at,
    begun_at_multiplier,
    orbit_through,
)
from symosc.orbits.law_margins import margins
from symosc.words import Word, cycle, of_belts, written

# The distances, as parts of the ranges, from a branch's end to where its border is looked for.
AWAY = (1e-7, 1e-6, 1e-5)
# A branch that ends at a value below this part of its largest one ends at 0.
ROUNDED_TO_0 = 1e-12
# How near to a border a point is on it, as a part of the ranges.
ON_BORDER = 1e-4
# Parts into which the cubic between two points of a border is cut to measure distances from it.
PARTS_OF_STEP = 8
#: Ends of branches under any law whose border is followed.
FOLLOWED_UNDER_ANY_LAW = (GRAZING, BIRTH, VANISHING, SLIP_BIRTH, ONSET)
STEP = 0.002
# Values found in doubles that differ by less, as a part of the range, are one.
SAME_VALUE = 1e-11
MOST_POINTS = 5000


class Border(Drawable):
    """A border: the curve in a plane of two parameters on which the word of the settled motion
    changes.

    Attributes
    ----------
    parameters : tuple of two str
        The names of the two parameters, first that of the branch.
    points : (n, 2) array
        The values of the two parameters along the curve.
    errors : (n, 2) array
        Estimates of the errors of `points`.
    kind : str
        What happens to the orbit at the border, as for `BranchEnd`; or "fold", "period doubling",
        "Neimark-Sacker".
    sliding : str
        The name in the literature: "crossing-sliding", "grazing-sliding", "switching-sliding" or
        "adding-sliding"; "" where the mass does not stick to the belt in question.
    words : tuple of two (str or None)
        The words on both sides, the branch's first: those of the settled motions, found by the
        engine beside the border. "rest" where the mass may rest on a belt for ever, or comes to rest
        under another law than the paper's; None if it
        meets no belt any more, or no motion with a word was found. Rotations are made equal: P32,
        not P23.
    special : tuple of SpecialPoint
        Folds of the curve, and points of codimension two at its ends.
    ends : tuple of two BorderEnd
        Why the border ends at its first and its last point.
    fixed : Parameters
        The other nine parameters.

    Examples
    --------
    >>> from symosc import continue_border, continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> border = continue_border(branch, 0, "FN", (9, 11))
    >>> border.words, border.sliding
    (('P32', 'P321'), 'crossing-sliding')
    >>> abs(border.at(FN=10)[0] - branch.ends[0].value) < 1e-11
    True
    """

    _drawn_by = "border_figure"

    def __init__(
        self,
        system: BorderSystem,
        nodes: list[Node],
        ends: tuple[BorderEnd, BorderEnd],
        special: Iterable[SpecialPoint],
    ) -> None:
        self._plane = system.plane
        self._system = system
        self._nodes = nodes
        self.parameters = system.names
        self.fixed = system.plane.fixed
        self.ends = ends
        self.special = tuple(special)
        self.points = np.array([system.values(node.z) for node in nodes])
        self.errors = np.array([node.errors for node in nodes])
        self.kind, self.sliding = system.called()
        self._side = 1.0
        #: The number of belts by which words are labelled, and the words with the labels of two.
        self._belts = 2
        self._words = self._words_of_sides()

    @property
    def words(self) -> tuple[str | None, str | None]:
        """The words on both sides, the branch's first."""
        first, second = self._words
        return labelled(first, self._belts), labelled(second, self._belts)

    def _words_of_sides(self) -> tuple[str | None, str | None]:
        """Return the words on both sides of the middle point, that of the equations first, and
        choose the side that is the first.
        """
        if isinstance(self._system, LawBorderSystem):
            kept = self._system.same_words()
            if kept is not None:
                return kept
        own = cycle(str(self._system.word))
        for distance in BESIDE:
            words = self._pair_beside(len(self) // 2, distance)
            if words[0] != own and own in words:
                self._side = -self._side  # of the curve that `beside` looks at first
                words = words[::-1]
            if words[0] == own and words[1] != own:
                return words
        return own, None

    @public
    def words_beside(self, i: int, distance: NumberLike = 1e-6) -> tuple[str | None, str | None]:
        """Return the words of the motions at the two parameter sets that ``beside(i, distance)``
        returns, in its order.

        Each is the word of an orbit that was found at these parameters and confirmed by a
        simulation; with c > 0 all motions settle to this orbit. The word is "rest" where the mass
        may rest on a belt for ever, None if no orbit was found.
        """
        require(WHOLE, i=i)
        require(NUMBER, distance=distance)
        first, second = self._pair_beside(i, distance)
        return labelled(first, self._belts), labelled(second, self._belts)

    def _pair_beside(self, i: int, distance: NumberLike) -> tuple[str | None, str | None]:
        """Return the words of `words_beside` with the labels of two belts."""
        first, second = self.beside(i, distance)
        system = self._system
        if isinstance(system, LawBorderSystem):
            z = self._nodes[i].z
            return system.word_at(first, z), system.word_at(second, z)
        near = self.orbit(i)
        return _word_at(first, near), _word_at(second, near)

    @public
    def orbit(self, i: int) -> Any:
        """Return the orbit at the border's i-th point, with the shorter one of the words on its two
        sides. Under another law than the paper's it is the orbit with the branch's word beside the
        point, a `PeriodicOrbit`.
        """
        return self._system.orbit(self._nodes[whole_number("i", i, -len(self), len(self) - 1)].z)

    @public
    def beside(self, i: int, distance: NumberLike = 1e-6) -> tuple[Parameters, Parameters]:
        """Return two parameter sets, one on either side of the i-th point, in the order of `words`.

        In a plot over the ranges of the two parameters they lie on the border's normal through this
        point. Their distance from the point is `distance`, as a fraction of the plot's width.
        """
        i = whole_number("i", i, -len(self), len(self) - 1)
        far = float(read_exact("distance", distance))
        if not 0 < far <= 0.01:
            raise ParameterError("distance", distance, "must be > 0 and at most 0.01")
        # The two parameters are the last unknowns of a node.
        tangent = self._nodes[i].tangent[-2:]
        along_first, along_second = tangent / linear.norm(tangent)
        normal = np.array([-along_second, along_first])
        shift = self._side * far * normal * self._plane.widths
        first, second = (self._plane.parameters(self.points[i] + sign * shift) for sign in (1, -1))
        return first, second

    @public
    def network(self, *, step: NumberLike = STEP, max_points: int = MOST_POINTS) -> list[Border]:
        """Return this border and all borders that points of codimension two connect with it.

        Each is followed as by `continue_border`, with its `step` and `max_points`. The borders that
        leave a point of codimension two are found on a small circle around it, where the words of
        the motions change. A word on too small a part of the circle for doubles is missed. The list
        is complete if each border in it ends at a point of codimension two from which all borders
        were followed, at an end of the range, or with "no convergence".
        """
        require(NUMBER, step=step)
        require(WHOLE, max_points=max_points)
        steps = _read_steps(step, max_points)
        if isinstance(self._system, LawBorderSystem):
            raise BorderError(
                "borders of other friction laws than the paper's are followed one by one, from the "
                "ends of branches"
            )
        borders = [self]
        waiting = [self]
        done = list[tuple[float, float]]()
        while waiting:
            border = waiting.pop()
            for point in border._codimension_two():
                if any(self._plane.near(point, known) for known in done):
                    continue
                done.append(point)
                for leaving in border._leaving(point, *steps):
                    middle = leaving.points[len(leaving) // 2]
                    leaving._belts = self._belts
                    if not any(passes(known, middle, leaving._words) for known in borders):
                        borders.append(leaving)
                        waiting.append(leaving)
        return borders

    def _codimension_two(self) -> Iterator[tuple[float, float]]:
        """Yield the points of codimension two at the ends of the border."""
        points = [special.values for special in self.special if special.kind != FOLD]
        for end in self.ends:
            at_end = [values for values in points if self._plane.near(values, end.values)]
            if at_end:
                yield at_end[0]

    def _leaving(self, point: tuple[float, float], step: float, most: int) -> list[Border]:
        """Return the borders that leave a point of codimension two of this border.

        All of them, this one too, cross a small circle around the point.
        """
        nearest = int(np.abs(self.points - point).sum(axis=1).argmin())
        around = circle(self._plane, point, self.orbit(nearest))
        # The plane's range is convex: the last chord is in it too.
        chords = pairwise([*around, *around[:1]])
        crossings = (begun for chord in chords for begun in all_crossings(self._plane, *chord))
        return _distinct(crossings, step, most)

    @public
    def at(self, **value: NumberLike) -> tuple[float, ...]:
        """Return all values of one parameter where the other has a given value on the curve:
        ``border.at(FN="0.4")``.

        They are in ascending order. Each is found with 50 digits between two points of the curve
        and rounded.

        Raises
        ------
        ParameterError
            If the name is not one of the border's two parameters.
        ConvergenceError
            If a value cannot be found with many digits.
        """
        require(NUMBER, **value)
        if len(value) != 1 or next(iter(value)) not in self.parameters:
            allowed = f"must be one of {' and '.join(self.parameters)}, as NAME=value"
            raise ParameterError("at", ", ".join(value), allowed)
        ((name, wanted),) = value.items()
        system = self._system
        j = self.parameters.index(name)
        exact = read_exact(name, wanted)
        # The two parameters are the last unknowns: the given one, and the other one.
        index = len(system.scale) - 2 + j
        other_index = len(system.scale) - 1 - j
        target = float(exact) / system.scale[index]
        distances = np.array([node.z[index] for node in self._nodes]) - target
        values = list[float]()
        # Between which nodes the parameter passes the value.
        for i in np.flatnonzero(distances[:-1] * distances[1:] <= 0).tolist():
            guess = _where(self._nodes[i], self._nodes[i + 1], index, target)
            polished = system.polish(guess, (index, exact))
            if polished is not None:
                values.append(float(polished[other_index]))
            else:
                values += self._at_folds(j, float(exact))
        values = sorted(set(values))
        if system.is_refined or not values:
            return tuple(values)
        # A point of the curve at the value belongs to the steps on both sides of it.
        near = SAME_VALUE * self._plane.widths[1 - j]
        return (values[0], *(high for low, high in pairwise(values) if high - low > near))

    def _at_folds(self, j: int, value: float) -> list[float]:
        """Return the values of the other parameter at the folds where parameter j has a value:
        there Newton's method finds none.
        """
        folds = [point.values for point in self.special if point.kind == FOLD]
        at_fold = [
            values[1 - j] for values in folds if abs(values[j] - value) <= 4 * EPS * abs(values[j])
        ]
        if not at_fold:
            system = self._system
            raise ConvergenceError(
                str(system.word), (), system.periods, inf, "the border is singular there"
            )
        return at_fold

    def __len__(self) -> int:
        return len(self.points)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Border) and self.as_dict() == other.as_dict()

    def __repr__(self) -> str:
        a, b = (word or "no word" for word in self.words)
        ends = " to ".join(
            f"({end.values[0]:.6g}, {end.values[1]:.6g}) ({end.kind})" for end in self.ends
        )
        name = self.sliding or self.kind
        axes = ", ".join(self.parameters)
        return f"<Border {a} | {b} ({name}) over ({axes}), {len(self.points)} points, {ends}>"

    def as_dict(self) -> Record:
        """Return the border as a dict of plain values: numbers, text and lists."""
        return {
            "parameters": list(self.parameters),
            "fixed": self.fixed.as_dict(),
            "kind": self.kind,
            "sliding": self.sliding,
            "words": list(self.words),
            "points": self.points.tolist(),
            "errors": self.errors.tolist(),
            "ends": [end._asdict() for end in self.ends],
            "special": [point._asdict() for point in self.special],
        }


def labelled(word: str | None, belts: int) -> str | None:
    """Return the text of a word with the labels of a law of so many belts; what stands for a word
    stays.
    """
    if not word or word == REST:
        return word
    own = written(word)
    other = of_belts(own, belts)
    if other.labels == own.labels:
        return word
    return str(other.cycle)


def _word_at(p: Parameters, near: Orbit) -> str | None:
    """Return the word of the motion at parameters `p`, found from an orbit close by.

    REST where the mass may rest on a belt; None if no orbit is found.
    """
    if any(rest_positions(p, belt) is not None for belt in p.law.boundaries):
        return REST
    orbit = motion_at(p, near)
    if orbit is None:
        return None
    return orbit.cycle


def _where(a: Node, b: Node, column: int, target: float) -> np.ndarray:
    """Return the point between two nodes at which the unknown `column` is `target`.

    It is bisected, as the curve is far from its chord next to a fold.
    """
    # `low` and `high` are fractions of the way from a to b; at `low` the unknown is below the target.
    if a.z[column] <= b.z[column]:
        low = 0.0
        high = 1.0
    else:
        low = 1.0
        high = 0.0
    for _ in range(MOST_HALVINGS):
        middle = (low + high) / 2
        if between(a, b, middle)[column] < target:
            low = middle
        else:
            high = middle
    point = between(a, b, low)
    point[column] = target
    return point


def borders_between(
    a: Parameters,
    b: Parameters,
    parameters: tuple[str, str],
    range: Mapping[str, tuple[NumberLike, NumberLike]],
    *,
    step: NumberLike = STEP,
    max_points: int = MOST_POINTS,
) -> list[Border]:
    """Return the borders between the parameter sets `a` and `b`, found where the word changes on
    the way from a to b.

    `a` and `b` may differ in the two named parameters only; `step` and `max_points` are those of
    `continue_border`.
    """
    first, second = parameters
    if first == second or not {first, second} <= set(PARAMETER_NAMES):
        allowed = f"must be two different names out of {', '.join(PARAMETER_NAMES)}"
        raise ParameterError("parameters", f"{first}, {second}", allowed)
    plane = _read_plane(a, first, second, range)
    steps = _read_steps(step, max_points)
    (place_a, orbit_a), (place_b, orbit_b) = (_settled(plane, p) for p in (a, b))
    if orbit_a is None and orbit_b is None:
        return []
    if orbit_a is not None and orbit_b is not None:
        ends = PlacedOrbit(place_a, orbit_a), PlacedOrbit(place_b, orbit_b)
        return _distinct(all_crossings(plane, *ends), *steps)
    if orbit_a is not None:
        inside = PlacedOrbit(place_a, orbit_a)
        outside = place_b
    elif orbit_b is not None:
        inside = PlacedOrbit(place_b, orbit_b)
        outside = place_a
    lost = loss_of_word(plane, inside, outside)
    if lost is None:
        return []
    beside, border = lost
    return _distinct(chain([border], all_crossings(plane, inside, beside)), *steps)


def _settled(plane: BorderPlane, p: Parameters) -> tuple[np.ndarray, Orbit | None]:
    """Return the point of the plane that belongs to the parameters `p`, and the orbit of the
    settled motion, if any.
    """
    place = np.array([float(getattr(p, name)) for name in plane.names])
    try:
        orbit = settled_orbit(p)
    except ConvergenceError:
        return place, None
    return place, Orbit(Word(orbit.labels), orbit.periods, orbit.phases())


def traced(system: BorderSystem, first: Node, step: float, most: int) -> Border:
    """Return the border through a node, followed by steps up to `step` to `most` points each way."""
    course = followed(system, first, step, most)
    return Border(system, course.path, course.ends, course.special)


def _distinct(begun: Iterable[Begun], step: float, most: int) -> list[Border]:
    """Return the borders through the nodes of `begun`, each once, followed by steps up to `step` to
    `most` points.
    """
    borders = list[Border]()
    for system, node in begun:
        border = traced(system, node, step, most)
        values = system.values(node.z)
        is_known = any(passes(known, values, border._words) for known in borders)
        if len(border) > 1 and not is_known:
            borders.append(border)
    return borders


def passes(
    border: Border, values: Sequence[float] | np.ndarray, words: Sequence[str | None]
) -> bool:
    """Return whether `border` has `words` on its sides and passes the point `values` within
    ON_BORDER of the ranges.
    """
    if set(border._words) != set(words):
        return False
    # The chords of long steps are farther from the curve than that: the cubics between the points
    # are cut.
    nodes = border._nodes
    system = border._system
    between_nodes = (
        between(a, b, part / PARTS_OF_STEP)
        for a, b in pairwise(nodes)
        for part in range(PARTS_OF_STEP)
    )
    curve = np.array([system.values(z) for z in (*between_nodes, nodes[-1].z)])
    # The distance of the point from each chord: from the foot of the perpendicular, or an end.
    from_point = (curve - values) / border._plane.widths
    chords = np.diff(from_point, axis=0)
    squares = np.maximum((chords * chords).sum(axis=1), 1e-300)
    fractions = np.clip(-(from_point[:-1] * chords).sum(axis=1) / squares, 0, 1)
    nearest = from_point[:-1] + fractions[:, None] * chords
    return bool((np.abs(nearest).max(axis=1) < ON_BORDER).any())


@public
def continue_border(
    branch: Branch,
    end: int | BranchSpecial,
    parameter: str,
    range: tuple[NumberLike, NumberLike] | Mapping[str, tuple[NumberLike, NumberLike]],
    *,
    step: NumberLike = STEP,
    max_points: int = MOST_POINTS,
) -> Border:
    """Follow the border at the end of a branch through the plane of the branch's and a second
    parameter, both ways.

    The border ends where another inequality of its orbit vanishes, or at the end of a range.

    Parameters
    ----------
    branch : Branch
    end : int or BranchSpecial
        The number of the branch's end, 0 or 1; or one of `Branch.special`, whose fold, period
        doubling or Neimark-Sacker point is followed.
    parameter : str
        The second parameter.
    range : (low, high)
        The range of the second parameter; or a mapping of both names to their ranges. Without a
        range the first parameter may go down to a tenth of its value at the end, and up to ten
        times that (from a value of 0: up to 1).
    step : number
        The longest step, as a part of the ranges.
    max_points : int
        The most points in each of the two directions.

    Raises
    ------
    ParameterError
        If the branch does not end at a border there, or a name or range is not allowed.
    BorderError
        If the border cannot be followed from there.

    Examples
    --------
    >>> from symosc import continue_border, continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> continue_border(branch, 0, "FN", (9, 11)).sliding
    'crossing-sliding'
    """
    require(Branch, branch=branch)
    require(WHOLE, BranchSpecial, end=end)
    require(TEXT, parameter=parameter)
    require(row_of(2, NUMBER), mapping_of(row_of(2, NUMBER)), range=range)
    require(NUMBER, step=step)
    require(WHOLE, max_points=max_points)
    if isinstance(end, BranchSpecial):
        return _border_of_law(branch, end, parameter, range, step, max_points)
    number = whole_number("end", end, 0, 1)
    if branch._starts is not None:
        return _border_of_law(branch, number, parameter, range, step, max_points)
    at_end = -number  # the index of the branch's point at this end: 0 or -1
    reason = branch.ends[number]
    if reason.kind in (RANGE, NO_CONVERGENCE, MOST):
        allowed = (
            f"must be an end at a border; the branch ends there with {reason.kind!r}: "
            f"{reason.message}"
        )
        raise ParameterError("end", end, allowed)
    if abs(reason.value) > ROUNDED_TO_0 * np.abs(branch.values).max():
        value = reason.value
    else:
        value = 0.0
    parameters = branch.parameters(at_end).parameters.replace(**{branch.parameter: value})
    plane = _read_plane(parameters, branch.parameter, parameter, range)
    longest, most = _read_steps(step, max_points)
    values = np.array([value, float(getattr(parameters, parameter))])
    word = of_belts(Word(branch.labels), 2)  # of the parameters, whose second belt may be far
    near = Orbit(word, branch.periods, branch.orbit(at_end).phases())
    # Without a word beyond the end the border has a closed form.
    if reason.beyond is None:
        closed = closed_form(plane, values, near)
    else:
        closed = None
    if closed is not None:
        border = traced(*closed, longest, most)
        border._belts = len(branch._orbit.parameters.law.belts)
        border.kind = reason.kind
        return border
    # From the end towards the middle of the branch; where both have one value, up from the first
    # end and down from the last.
    middle_value = branch.values[len(branch.values) // 2]
    inward = np.sign(middle_value - reason.value) or (1.0, -1.0)[number]
    begun = _begun_at_end(plane, values, near, inward)
    if begun is None:
        raise BorderError(
            f"the border of {branch.word} at {branch.parameter} = {reason.value:.8g} was not "
            f"found: {reason.message}"
        )
    border = traced(*begun, longest, most)
    # The branch's word comes first, and what happens is what happens to it.
    border._belts = len(branch._orbit.parameters.law.belts)
    if border._words[1] == str(word.cycle):
        border._words = border._words[::-1]
        border._side = -border._side
        border.kind = reason.kind
    return border


def _border_of_law(
    branch: Branch,
    end: int | BranchSpecial,
    parameter: str,
    limits: tuple[NumberLike, NumberLike] | Mapping[str, tuple[NumberLike, NumberLike]],
    step: NumberLike,
    max_points: int,
) -> Border:
    """Return the border at an end of a branch under any law, or at a place where a multiplier passes
    the unit circle.
    """
    longest, most = _read_steps(step, max_points)
    assert branch._starts is not None
    if isinstance(end, BranchSpecial):
        if end not in branch.special:
            raise ParameterError("end", end.kind, "must be one of `branch.special`")
        at_end = int(np.abs(branch.values - end.value).argmin())
        value = end.value
        kind = end.kind
        inward = 1.0
        t, x, v = end.start
        span = end.span
    else:
        reason = branch.ends[end]
        if reason.kind not in FOLLOWED_UNDER_ANY_LAW:
            allowed = (
                f"must be an end at a border that has one equation ({', '.join(FOLLOWED_UNDER_ANY_LAW)}"
                f"); the branch ends there with {reason.kind!r}: {reason.message}"
            )
            raise ParameterError("end", end, allowed)
        at_end = -end
        value = float(branch.values[at_end])
        kind = reason.kind
        middle = branch.values[len(branch.values) // 2]
        inward = float(np.sign(middle - reason.value)) or (1.0, -1.0)[end]
        t, x, v = branch._starts[at_end].tolist()
        span = float(branch.spans[at_end])
    model = branch.parameters(at_end).replace(**{branch.parameter: value})
    plane = _read_plane(model, branch.parameter, parameter, limits, tuple(model.numbers()))
    lost = BorderError(
        f"the border of {branch.word or 'an orbit without a belt'} at {branch.parameter} = "
        f"{value:.8g} was not found: its {kind} has no equation there that can be solved"
    )
    other = float(model.numbers()[parameter])
    if kind == ONSET:
        return _onset(OnsetSystem(model, plane, branch.labels), value, other, lost, longest, most)
    orbit = orbit_through(model, t, x, v, span, branch.periods)
    if orbit is None:
        raise lost
    begun: BorderBegun | None = None
    if isinstance(end, BranchSpecial):
        begun = begun_at_multiplier(orbit, kind)
    else:
        reasons = [margin for margin in margins(orbit) if margin.event == kind]
        if reasons:
            begun = begun_at(orbit, reasons[0])
    if begun is None:
        raise lost
    system = LawBorderSystem(model, plane.names, plane.widths.tolist(), orbit, begun, plane, kind)
    z = system.unknowns(begun.t, begun.x, [value, other])
    row = np.zeros(len(z))
    row[-1] = 1.0
    node = system.node(z, row)
    if node is None:
        raise lost
    try:
        system.begin_side(node.z, inward)
    except (ConvergenceError, ValueError):
        raise lost from None
    border = traced(system, node, longest, most)
    border._belts = len(model.law.belts)
    return border


def _onset(
    system: OnsetSystem, value: float, other: float, lost: BorderError, longest: float, most: int
) -> Border:
    """Return the border of an onset at a corner, through a point of the plane."""
    z = np.array([value, other]) / system.scale
    along = system.along(z)
    node = None if along is None else system.node(z, along)
    if node is None:
        raise lost
    border = traced(system, node, longest, most)
    border._belts = len(system.model.law.belts)
    return border


def _begun_at_end(
    plane: BorderPlane, values: np.ndarray, near: Orbit, inward: float
) -> Begun | None:
    """Return the border that crosses a line along the plane's first parameter at the point `values`,
    the end of a branch; None if it is not found.

    `near` is the orbit at the end, `inward` the sign of the direction from the end into the branch.
    """
    first_width, _ = plane.widths
    for distance in AWAY:
        shift = np.array([inward * distance * first_width, 0.0])
        inside, outside = (
            motion_at(plane.parameters(values + sign * shift), near) for sign in (1, -1)
        )
        if inside is None or outside is None:
            continue
        begun = first_crossing(
            plane, PlacedOrbit(values + shift, inside), PlacedOrbit(values - shift, outside)
        )
        if begun is not None:
            return begun
    return None


def _read_steps(step: NumberLike = STEP, max_points: int = MOST_POINTS) -> tuple[float, int]:
    """Check the two options of `continue_border`.

    Return the longest step and the largest number of points.
    """
    longest = float(read_exact("step", step))
    most = whole_number("max_points", max_points, 2)
    if not 0 < longest <= 0.1:
        raise ParameterError("step", step, "must be > 0 and at most 0.1")
    return longest, most


def _read_plane(
    parameters: Model,
    first: str,
    second: str,
    limits: tuple[NumberLike, NumberLike] | Mapping[str, tuple[NumberLike, NumberLike]],
    known: Sequence[str] = PARAMETER_NAMES,
) -> BorderPlane:
    """Check the two parameters and their ranges `limits`; return their plane."""
    if second == first:
        raise ParameterError(
            "parameter", second, f"must differ from the branch's own parameter {first}"
        )
    if second not in known:
        names = [name for name in known if name != first]
        allowed = f"must be one of {some(names)}"
        raise ParameterError("parameter", second, allowed + meant(second, names))
    if isinstance(limits, Mapping):
        ranges = dict(limits)
    else:
        ranges = {second: limits}
    if first not in ranges:
        ranges[first] = _usual_range(first, parameters.numbers()[first])
    low, high = np.array(
        [read_range(parameters, name, ranges.pop(name, None), known) for name in (first, second)]
    ).T
    if ranges:
        raise ParameterError(
            "range", ", ".join(map(str, ranges)), f"must be ranges of {first} and {second}"
        )
    return BorderPlane(parameters, (first, second), low, high)


def _usual_range(name: str, value: Fraction) -> tuple[NumberLike, NumberLike]:
    """Return the range of a branch's parameter around its value at the branch's end."""
    if value > 0:
        return value / 10, value * 10
    if value < 0:
        return value * 10, value / 10
    if least(name) is None:
        return -1, 1
    return 0, 1
