"""Borders: the curves in a plane of two parameters on which branches end, and the points where they
meet.

A border is followed by pseudo-arclength continuation of the equations in
`symosc.orbits.border_system`. It ends where another inequality of its orbit vanishes, where its own
zero is no simple one any more, or at the end of the range. Those points of codimension two, and the
folds of the curve, are located with many digits. The borders that leave a point are found on a
small circle around it: the words of the settled motion are bisected along the circle.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, pairwise
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import NumberLike, Record
from symosc.base.arguments import NUMBER, TEXT, WHOLE, mapping_of, public, require, row_of
from symosc.base.display.drawable import Drawable
from symosc.base.errors import ParameterError, SymoscError, meant
from symosc.base.exact import read_exact, whole_number
from symosc.base.quantities import least
from symosc.kernels import linear
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import EPS
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits import border_system
from symosc.orbits.admissibility import Condition, conditions, failures, scales
from symosc.orbits.border_system import (
    BorderSystem,
    ClosedForm,
    Node,
    Plane,
    Zero,
    names_of,
    zeros_of,
)
from symosc.orbits.branch import MOST, NO_CONVERGENCE, RANGE, Branch, read_range
from symosc.orbits.closing_equations import ClosingEquations, ConvergenceError, Orbit, solve
from symosc.orbits.find import find_orbit, settling
from symosc.orbits.floquet import rest_positions
from symosc.words import Word, cycle


class BorderError(SymoscError, ArithmeticError):
    """Raised if the border at the end of a branch cannot be found or followed.

    Examples
    --------
    >>> from symosc import BorderError, Parameters, continue_border, continue_orbit
    >>> p = Parameters(m=1, c=0.5, k=1, A0=0, B0=1.2, Omega=1, v1=-1.9, v2=1.9, mu1=1, mu2=1, FN=1)
    >>> branch = continue_orbit(p, "P4817", "B0", (0.9, 1.3))
    >>> try:
    ...     continue_border(branch, 0, "v1", (-3, -1))
    ... except BorderError as error:
    ...     print(error)
    P7481 ends where both belts are met at once: two borders meet there
    """


CLOSED = "closed"
FOLD = "fold"
CHECKED = 8  # points per check of the inequalities
# to what length a change on the way is bisected, and how often at most
LOCATED = 1e-12
MOST_HALVINGS = 50
FARTHEST = 0.1  # of a correction, as a part of the step
# so far from where it is looked for a point is accepted, and a margin is taken to vanish there
NEAR = 1e-3
# Distances as parts of the ranges: from a border to where its words are looked at, from a branch's
# end to where its border is looked for, from a border to where a narrow region behind it is looked
# for.
BESIDE = (1e-6, 1e-5, 1e-4, 1e-7)
AWAY = (1e-7, 1e-6, 1e-5)
SHIFTS = (1e-9, 1e-8, 1e-7, 1e-6)
STEP = 0.002
MOST_POINTS = 5000
REGULAR = {
    border_system.AT_FAR: ", and G^(1) of that domain is 0 there",
    border_system.AT_ARRIVAL: ", and G^(1) of that domain is 0 there: a cubic tangency",
    border_system.AT_TOUCH: " in an extremum at which v'' is 0 too",
    border_system.AT_HOLD: " in an extremum at which F'' is 0 too",
}
#: What stands for a word where the mass may rest on a belt for ever.
REST = "rest"


class BorderEnd(NamedTuple):
    """Where and why a border ends.

    Attributes
    ----------
    kind : str
        "codimension two", "end of the range", "closed", "no convergence" or "max_points".
    values : tuple of two floats
        The values of the two parameters at this end of the border.
    message : str

    Examples
    --------
    >>> from symosc import continue_border, continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> border = continue_border(branch, 0, "FN", (9, 11))
    >>> [end.kind for end in border.ends]
    ['end of the range', 'end of the range']
    """

    kind: str
    values: tuple[float, float]
    message: str


class SpecialPoint(NamedTuple):
    """A fold of a border, or a point of codimension two.

    Attributes
    ----------
    kind : str
        "fold"; or the names in the literature of the borders that meet at the point, as in
        "degenerate crossing-sliding" or "crossing-sliding and grazing-sliding".
    values : tuple of two floats
        The values of the two parameters at the point.
    message : str
        Which inequalities vanish at the point.
    error : float
        Estimate of the largest error of the two values; nan if they could only be bracketed by the
        curve's points.

    Examples
    --------
    >>> from symosc import continue_border, continue_orbit, load_scene
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> border = continue_border(branch, 0, "FN", (9, 11))
    >>> border.special
    ()
    """

    kind: str
    values: tuple[float, float]
    message: str
    error: float


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
        What happens to the orbit at the border, as for `BranchEnd`.
    sliding : str
        The name in the literature: "crossing-sliding", "grazing-sliding", "switching-sliding" or
        "adding-sliding"; "" where the mass does not stick to the belt in question.
    words : tuple of two (str or None)
        The words on both sides, the branch's first: those of the settled motions, found by the
        engine beside the border. "rest" where the mass may rest on a belt for ever; None if it
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

    def __init__(self, system: BorderSystem, nodes: list[Node], ends: Any, special: Any) -> None:
        self._plane = system.plane
        self._system = system
        self._nodes = nodes
        self.parameters = system.names
        self.fixed = system.plane.fixed
        self.ends = ends
        self.special = tuple(special)
        self.points = np.array([system.values(node.z) for node in nodes])
        self.errors = np.array([node.error for node in nodes])
        self.kind, self.sliding = names_of(system)
        own = cycle(str(system.word))
        self._side = 1.0
        self.words: tuple[str | None, str | None] = (
            own,
            None,
        )  # beside the middle point, that of the equations first
        for distance in BESIDE:
            words = self.words_beside(len(self) // 2, distance)
            if words[0] != own and own in words:
                self._side = -self._side
                words = words[::-1]
            if words[0] == own and words[1] != own:
                self.words = words
                break

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

        def word(p: Parameters) -> str | None:
            if any(rest_positions(p, belt) is not None for belt in (1, 2)):
                return REST
            found = motion_at(p, self.orbit(i))
            if found is None:
                return None
            return found.cycle

        first, second = self.beside(i, distance)
        return word(first), word(second)

    @public
    def orbit(self, i: int) -> Orbit:
        """Return the orbit at the border's i-th point, with the shorter one of the words on its two
        sides.
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
        along = self._nodes[i].tangent[-2:] / linear.norm(self._nodes[i].tangent[-2:])
        away = self._side * far * np.array([-along[1], along[0]]) * self._plane.widths
        first, second = (self._plane.parameters(self.points[i] + way * away) for way in (1, -1))
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
        how = _read_steps(step, max_points)
        plane = self._plane
        found = [self]
        done = list[tuple[float, float]]()
        waiting = [self]
        while waiting:
            here = waiting.pop()
            for end in here.ends:
                points = (each.values for each in here.special if each.kind != FOLD)
                at = next((values for values in points if plane.near(values, end.values)), None)
                if at is None or any(plane.near(at, other) for other in done):
                    continue
                done.append(at)
                # All borders that leave the point, this one among them, cross a small circle around
                # it.
                around = _circle(
                    plane, at, here.orbit(int(np.abs(here.points - at).sum(axis=1).argmin()))
                )
                chords = pairwise(
                    [*around, *around[:1]]
                )  # the plane's range is convex: the last chord is in it too
                for other in _distinct(
                    (each for chord in chords for each in all_crossings(plane, *chord)), *how
                ):
                    if not any(
                        passes(each, other.points[len(other) // 2], other.words) for each in found
                    ):
                        found.append(other)
                        waiting.append(other)
        return found

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
        ((name, given),) = value.items()
        system = self._system
        j = self.parameters.index(name)
        exact = read_exact(name, given)
        target = float(exact) / system.scale[-2 + j]
        places = np.array([node.z[-2 + j] for node in self._nodes]) - target
        found = []
        for i in np.flatnonzero(places[:-1] * places[1:] <= 0).tolist():
            a, b = self._nodes[i : i + 2]
            if places[i] <= places[i + 1]:
                low = 0.0
                high = 1.0
            else:
                low = 1.0
                high = 0.0
            for _ in range(MOST_HALVINGS):  # next to a fold the curve is far from its chord
                part = (low + high) / 2
                if between(a, b, part)[-2 + j] < target:
                    low = part
                else:
                    high = part
            guess = between(a, b, low)
            guess[-2 + j] = target
            polished = system.polish(guess, (len(guess) - 2 + j, exact))
            if polished is not None:
                found.append(float(polished[-1 - j]))
                continue
            folds = (point.values for point in self.special if point.kind == FOLD)
            at_fold = [
                values[1 - j]
                for values in folds
                if abs(values[j] - float(exact)) <= 4 * EPS * abs(values[j])
            ]
            if not at_fold:
                raise ConvergenceError(
                    str(system.word), (), system.periods, inf, "the border is singular there"
                )
            found += at_fold
        return tuple(sorted(set(found)))

    def __len__(self) -> int:
        return len(self.points)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Border) and self.as_dict() == other.as_dict()

    def __repr__(self) -> str:
        a, b = self.words
        ends = " to ".join(
            f"({', '.join(f'{x:.6g}' for x in end.values)}) ({end.kind})" for end in self.ends
        )
        name = self.sliding or self.kind
        axes = ", ".join(self.parameters)
        return (
            f"<Border {a} | {b or 'no word'} ({name}) over ({axes}), {len(self.points)} points, "
            f"{ends}>"
        )

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


def between(a: Node, b: Node, part: float) -> np.ndarray:
    """Return the point at the fraction `part` of the way from a to b, on the cubic through both
    with their tangents.
    """
    length = linear.norm(b.z - a.z)
    r = part
    first = (1 - r) ** 2 * (1 + 2 * r)
    second = r * r * (3 - 2 * r)
    slope = length * (r * (1 - r) ** 2 * a.tangent - r * r * (1 - r) * b.tangent)
    return np.asarray(first * a.z + second * b.z + slope)


def motion_at(parameters: Parameters, *near: Orbit) -> Orbit | None:
    """Find an admissible orbit at `parameters`, starting from each orbit of `near` in turn; None if
    none is found.

    The word of the orbit in `near` is tried first, then the words of the motion that is simulated
    from this orbit. With c > 0 all other motions settle to an admissible orbit
    (`symosc.orbits.floquet`).
    """
    for orbit in near:
        equations = ClosingEquations(parameters, orbit.word, orbit.periods)
        solution = solve(equations, orbit.points)
        if solution.converged and not failures(equations, solution.points):
            return orbit._replace(points=solution.points)
        size = float(np.abs(orbit.points[:, 0]).max())
        for piece, (x, theta) in zip(equations.pieces, orbit.points.tolist(), strict=True):
            found, _ = settling(equations, x, theta % (2 * pi), piece.start, size)
            if found is not None:
                return found
    return None


# -- along a border --------------------------------------------------------------------------------


class Tracer:
    """One run along a border, from a first node in both directions, to an end or to `most` points."""

    def __init__(self, system: BorderSystem, first: Node, step: float, most: int) -> None:
        self.plane = system.plane
        self.system = system
        self.first = first
        self.longest = step
        self.most = most
        self.low, self.high = (
            bound / self.plane.widths for bound in (self.plane.low, self.plane.high)
        )

    def border(self) -> Border:
        """Follow the border both ways from the first point and return it."""
        path, last, special = self._follow(self.first)
        begin = last
        if last.kind != CLOSED:
            backward, begin, others = self._follow(self.first._replace(tangent=-self.first.tangent))
            path = [node._replace(tangent=-node.tangent) for node in reversed(backward[1:])] + path
            special = [*reversed(others), *special]
        return Border(self.system, path, (begin, last), special)

    def _follow(self, first: Node) -> tuple[list[Node], BorderEnd, list[SpecialPoint]]:
        """Follow the border along the first node's tangent.

        Return its nodes, its end and its special points.
        """
        path = [first]
        special = list[SpecialPoint]()
        step = self.longest
        bend = 0.0 * first.z
        checked = 0
        self.margins: list[Condition] | None = None

        def end(kind: str, message: str) -> tuple[list[Node], BorderEnd, list[SpecialPoint]]:
            return path, BorderEnd(kind, self.system.values(path[-1].z), message), special

        while True:
            here = path[-1]
            guess = here.z + step * here.tangent + 0.5 * step * step * bend
            node = self.system.node(guess, here.tangent)
            near = node is not None and linear.norm(node.z - guess) < FARTHEST * step
            if node is None or not near or linear.dot(node.tangent, here.tangent) < 0.98:
                step /= 2
                if step < 1e-9:
                    return end(
                        NO_CONVERGENCE,
                        "the steps became too short: the equations are singular there",
                    )
                continue
            bend = (node.tangent - here.tangent) / linear.norm(node.z - here.z)
            outside = None
            for j, (value, low, high) in enumerate(
                zip(node.z[-2:], self.low, self.high, strict=True)
            ):
                # A border along a bound is not outside.
                if outside is None and not low - 1e-14 <= value <= high + 1e-14:
                    outside = j, float(low if value < low else high)
            if outside is not None:  # end at the bound
                j, bound = outside
                guess = between(
                    here, node, float((bound - here.z[-2 + j]) / (node.z[-2 + j] - here.z[-2 + j]))
                )
                guess[-2 + j] = bound
                node = self.system.node(guess, here.tangent, np.eye(len(guess))[-2 + j]) or here
            for j in (0, 1):
                slopes = np.array([here.tangent[-2 + j], node.tangent[-2 + j]])
                if (
                    slopes.prod() < 0 and np.ptp(slopes) > 1e-6
                ):  # rounding alone on a line along an axis
                    fold = self._fold(here, node, j)
                    if fold is not None:
                        path.append(fold[0])
                        special.append(fold[1])
            if outside is not None and linear.norm(node.z - here.z) < LOCATED:
                path.pop()  # it was there already
            path.append(node)
            closed = False
            if (
                len(path) > CHECKED and outside is None
            ):  # it is if the first point lies between the last two
                away = first.z - here.z
                along = node.z - here.z
                length = linear.norm(along)
                part = linear.dot(away, along) / length**2
                closed = bool(
                    0 <= part <= 1 and linear.norm(away - part * along) < FARTHEST * length
                )
            if (
                outside is not None
                or closed
                or len(path) > self.most
                or len(path) - checked > CHECKED
            ):
                at = self._first_failure(path, checked)
                if at is not None:
                    cut, point = self._codimension_two(path[at - 1], path[at])
                    del path[at:]
                    kept = {self.system.values(node.z) for node in path}
                    special[:] = [*(each for each in special if each.values in kept), point]
                    path.append(cut)
                    return end("codimension two", f"{point.kind}: {point.message}")
                checked = len(path) - 1
            if closed:
                path[-1] = first
                return end(CLOSED, "the curve is closed")
            if outside is not None:
                j, bound = outside
                return end(
                    RANGE,
                    f"{self.plane.names[j]} = {bound * self.plane.widths[j]:.10g}; the border "
                    "goes on",
                )
            if len(path) > self.most:
                return end(MOST, f"stopped after {self.most} points")
            step = min(1.5 * step, self.longest)

    def _failing(self, node: Node) -> Condition | None:
        """Return the inequality that fails most at a node of the border; None if all hold."""
        return min(
            (c for c in self.system.margins(node.z) if not c.value > 0),
            key=_scaled_margin,
            default=None,
        )

    def _first_failure(self, path: list[Node], checked: int) -> int | None:
        """Return the index of the first node in `path` after `checked` at which an inequality
        fails, or None.
        """
        low = checked
        high = len(path) - 1
        before = self.margins
        self.margins = self.system.margins(path[high].z)
        if all(c.value > 0 for c in self.margins):
            # A margin may dip between two checks. How it has changed tells how far.
            steady = (
                a.value == b.value
                or min(a.value, b.value) > min(abs(a.value - b.value), b.value / 2)
                for a, b in zip(before or (), self.margins, strict=False)
            )
            if before is None or all(steady):
                looked: Sequence[int] = ()
            else:
                looked = range(low + 1, high)
            return next((i for i in looked if self._failing(path[i]) is not None), None)
        while high - low > 1:
            middle = (low + high) // 2
            if self._failing(path[middle]) is None:
                low = middle
            else:
                high = middle
        return high

    def _fold(self, here: Node, node: Node, j: int) -> tuple[Node, SpecialPoint] | None:
        """Locate the fold between two nodes: the point of the border at which parameter j is
        largest or smallest.
        """
        system = self.system
        other = 1 - j
        index = len(here.z) - 1 - j
        for _ in range(3):  # in doubles first
            part = here.tangent[-2 + j] / (here.tangent[-2 + j] - node.tangent[-2 + j])
            middle = system.node(between(here, node, float(part)), here.tangent)
            if middle is None:
                return None
            z = middle.z
            if middle.tangent[-2 + j] * here.tangent[-2 + j] > 0:
                here = middle
            else:
                node = middle
        tried: list[tuple[float, float]] = []
        q = float(z[-2 + other] * system.scale[-2 + other])
        for _ in range(8):
            u = system.polish(z, (index, Fraction(q)))
            if u is None:
                return None
            tangent = system.fine_tangent(u)
            tried.append((q, float(tangent[-2 + j] / tangent[-2 + other])))
            z = np.array([float(value) for value in u]) / system.scale
            if len(tried) == 1:
                change = 1e-9 * float(system.scale[-2 + other])
            elif tried[-1][1] == tried[-2][1]:
                break
            else:
                (a, f), (b, g) = tried[-2:]
                change = -g * (b - a) / (g - f)
            if abs(change) <= 4 * EPS * abs(q):
                break
            q += change
        values = system.values(z)
        tangent = tangent * float(np.sign(linear.dot(tangent, here.tangent)))
        error = max(abs(change), *(2 * EPS * abs(value) for value in values))
        message = (
            f"{self.plane.names[j]} is {'largest' if here.tangent[-2 + j] > 0 else 'smallest'} "
            "along the border"
        )
        return Node(z, tangent, np.full(2, error)), SpecialPoint(FOLD, values, message, error)

    def _codimension_two(self, good: Node, bad: Node) -> tuple[Node, SpecialPoint]:
        """Locate the border's end between `good`, where all inequalities hold, and `bad`, as Node
        and SpecialPoint.
        """
        system = self.system
        condition = self._failing(bad)
        for _ in range(MOST_HALVINGS):
            if linear.norm(bad.z - good.z) < LOCATED:
                break
            middle = system.node(between(good, bad, 0.5), good.tangent)
            if middle is None:
                break
            failed = self._failing(middle)
            if failed is None:
                good = middle
            else:
                bad = middle
                condition = failed
        values = system.values(good.z)
        closed = isinstance(system, ClosedForm)
        if closed:
            found = None
        else:
            found = meeting(self.plane, system.orbit(good.z), values)
        if found is None:
            if condition is None:
                message = "a condition fails"
            else:
                message = f"the condition '{condition.text}' fails"
            if not closed:
                message += "; the point could not be refined"
            length = float(np.abs((bad.z - good.z)[-2:] * system.scale[-2:]).max())
            found = SpecialPoint(
                names_of(system)[1] or names_of(system)[0], values, message, length
            )
        z = good.z.copy()
        z[-2:] = np.array(found.values) / system.scale[-2:]
        return good._replace(z=z, error=np.full(2, found.error)), found


def _scaled_margin(condition: Condition) -> float:
    """Return a condition's relative margin: its value divided by the size of its terms."""
    return condition.value / condition.scale


# -- points of codimension two ---------------------------------------------------------------------


def meeting(plane: Plane, orbit: Orbit, values: tuple[float, float]) -> SpecialPoint | None:
    """Find the point near the parameters `values` at which two inequalities of one word vanish;
    None if not found.

    The word is that of `orbit` or, if no point is found with it, the shortest one among the motions
    around `values`.
    """
    durations = ClosingEquations(plane.parameters(values), orbit.word, orbit.periods).durations(
        orbit.points
    )
    if durations.min() < 1e-3:
        found = None
    else:
        found = _two_zeros(plane, orbit, values)
    if found is None:
        around = [each for _, each in _circle(plane, values, orbit)]
        if around:
            found = _two_zeros(plane, min(around, key=lambda each: len(each.points)), values)
        else:
            found = None
    return found


#: A point of the plane and an orbit there.
Motion = tuple[np.ndarray, Orbit]


def _circle(plane: Plane, values: Sequence[float], orbit: Orbit) -> list[Motion]:
    """Return points of the plane on a small circle around the point `values`, each with the orbit
    found there.
    """
    found = []
    for i in range(24):
        angle = 2 * pi * (i + 0.5) / 24
        place = np.array(values) + 1e-3 * plane.widths * np.array([cos(angle), sin(angle)])
        inside = (plane.low <= place).all() and (place <= plane.high).all()
        if inside:
            there = motion_at(plane.parameters(place), orbit)
        else:
            there = None
        if there is not None:
            found.append((place, there))
    return found


def _two_zeros(plane: Plane, orbit: Orbit, values: tuple[float, float]) -> SpecialPoint | None:
    """Find the point near the parameters `values` at which two inequalities of the orbit's word
    vanish, or None.
    """
    equations = ClosingEquations(plane.parameters(values), orbit.word, orbit.periods)
    solution = solve(equations, orbit.points)
    if solution.converged:
        points = solution.points
    else:
        points = orbit.points
    if border_system.is_symmetric(points, NEAR):
        half = len(points) // 2
    else:
        half = 0
    if half:
        points = border_system.symmetrised(points)
    size = scales(equations, points)
    single = list[tuple[Zero, list[float], Condition]]()
    pairs = list[Any]()
    for c in conditions(equations, points):
        if abs(_scaled_margin(c)) < NEAR:
            single += [(zero, phases, c) for zero, phases in zeros_of(equations, points, c)]
    for zero, phases, c in single:
        (flat,) = border_system.zero_values(
            equations, points, zero.bend, phases[0] if phases else 0.0
        )
        if (
            abs(flat) * size.t < 0.1 * size.a
        ):  # it may be 0 at a point that is known as well as a curve shows it
            pairs.append((-1.0 if phases else -2.0, (zero, zero.bend), phases, (c.text,)))
    for one, two in combinations(single, 2):
        if (
            one[0].kind != two[0].kind or two[0].piece - one[0].piece != half
        ):  # two that are one by symmetry
            found = (
                max(abs(_scaled_margin(one[2])), abs(_scaled_margin(two[2]))),
                (one[0], two[0]),
                one[1] + two[1],
            )
            pairs.append((*found, (one[2].text, two[2].text)))
    for _, zeros, phases, texts in sorted(pairs, key=lambda pair: pair[0]):
        images = [(zero.kind, zero.piece + way * half) for zero in zeros for way in (1, -1) if half]
        mirrored = [other for other in single if (other[0].kind, other[0].piece) in images]
        added = [
            each
            for other in mirrored
            for each in ((other[0], other[0].bend) if len(texts) == 1 else other[:1])
        ]
        more = [phase for other in mirrored for phase in other[1]]
        # The equations of one half of a symmetric orbit may leave the other half undetermined: both
        # are tried first.
        for all_zeros, all_phases in (([*zeros, *added], [*phases, *more]), (zeros, phases))[
            not added :
        ]:
            system = BorderSystem(plane, orbit._replace(points=points), all_zeros)
            polished = system.polish(
                np.array([*points.ravel(), *all_phases, *values]) / system.scale
            )
            at = [float(value) for value in (polished or [])[-2:]]
            if polished is None or (np.abs(np.subtract(at, values)) > NEAR * plane.widths).any():
                continue
            names = [names_of(system, zero) for zero in zeros[: len(texts)]]
            kind = " and ".join(sorted(sliding or what for what, sliding in names))
            message = " and ".join(f"{text} just fails" for text in texts)
            if len(texts) == 1:
                if zeros[0].kind != border_system.AT_ARRIVAL:
                    kind = f"degenerate {kind}"
                message += REGULAR[zeros[0].kind]
            return SpecialPoint(
                kind, (at[0], at[1]), f"{message} ({orbit.cycle})", 2 * EPS * max(map(abs, at))
            )
    return None


def closed_form(plane: Plane, place: np.ndarray, orbit: Orbit) -> tuple[ClosedForm, Node] | None:
    """Return the border through `place` beyond which the motion of `orbit` rests or meets no belt,
    and its node.
    """
    p = plane.parameters(place)
    system = ClosedForm(plane, p, orbit)
    holds, drives = system.terms(place)
    if not (holds > drives > 0 if system.line else abs(holds - drives) < 1e-6 * drives):
        return None
    if p.v1 == -p.v2 and {"v1", "v2"} & {*plane.names}:
        raise BorderError(
            f"{orbit.cycle} ends where both belts are met at once: two borders meet there"
        )
    node = system.node(place / system.scale, system.along(place))
    if node is not None and all(c.value > 0 for c in system.margins(node.z)):
        return (system, node)
    return None


# -- finding borders -------------------------------------------------------------------------------


def crossed_borders(
    plane: Plane, place: np.ndarray, orbit: Orbit, direction: np.ndarray
) -> Iterator[tuple[BorderSystem, Node]]:
    """Yield the borders of the word of `orbit`, found at `place`, that the line along `direction`
    crosses there.
    """
    equations = ClosingEquations(plane.parameters(place), orbit.word, orbit.periods)
    points = orbit.points
    nearest = sorted(conditions(equations, points), key=lambda c: abs(_scaled_margin(c)))[:6]
    for zero, phases in (found for c in nearest for found in zeros_of(equations, points, c)):
        if zero.kind == border_system.AT_ARRIVAL:  # it belongs to the word with more pieces
            continue
        system = BorderSystem(plane, orbit, [zero])
        z = np.array([*np.ravel(points), *phases, *place]) / system.scale
        row = np.zeros(len(system.scale))
        across = direction / plane.widths
        row[-2:] = np.array([-across[1], across[0]]) / linear.norm(across)
        first = system.node(z, row)
        # A second point tells which inequalities are 0 all along.
        if first is None:
            second = None
        else:
            second = system.node(first.z + 1e-4 * first.tangent, first.tangent)
        if first is None or second is None:
            continue
        system.hide([first.z, second.z])
        if all(_scaled_margin(c) > -border_system.NOTHING for c in system.margins(first.z)):
            yield system, first


def first_crossing(plane: Plane, start: Motion, stop: Motion) -> tuple[BorderSystem, Node] | None:
    """Return the first border that crosses the segment from `start` to `stop` in the plane; None if
    none is found.
    """
    whole = float(np.abs((stop[0] - start[0]) / plane.widths).max())
    word = start[1].cycle
    low = start
    high = stop
    while word != stop[1].cycle:
        way = high[0] - low[0]
        length = float(np.abs(way / plane.widths).max())
        if length <= max(1e-3 * whole, 1e-6):  # short enough for the equations
            for place, orbit in sorted((low, high), key=lambda end: len(end[1].points)):
                for system, node in crossed_borders(plane, place, orbit, way):
                    part = linear.dot(system.values(node.z) - low[0], way) / linear.dot(way, way)
                    if -0.5 <= part <= 1.5:
                        return system, node
        if length < 1e-9:
            break
        places = (low[0] + part * way for part in (0.5, 0.4))  # the first may be on the border
        found = ((place, motion_at(plane.parameters(place), low[1], high[1])) for place in places)
        place, middle = next((each for each in found if each[1] is not None), (low[0], None))
        if middle is None:
            break
        if middle.cycle == word:
            low = (place, middle)
        else:
            high = (place, middle)
    return None


def all_crossings(plane: Plane, start: Motion, stop: Motion) -> Iterator[tuple[BorderSystem, Node]]:
    """Yield, in order, the borders at which the word of the motion changes along the segment from
    `start` to `stop`.
    """
    found = first_crossing(plane, start, stop)
    if found is None:
        return
    system, node = found
    way = (stop[0] - start[0]) / np.abs((stop[0] - start[0]) / plane.widths).max()
    place = system.values(node.z)
    own = system.orbit(node.z)
    if not 0 <= linear.dot(place - start[0], way) <= linear.dot(stop[0] - start[0], way):
        return  # the border at the segment's end, once more
    for shift in SHIFTS:
        before = place - shift * way
        after = place + shift * way
        orbits = [
            motion_at(plane.parameters(beside), own, start[1], stop[1])
            for beside in (before, after)
        ]
        words = {orbit.cycle for orbit in orbits if orbit is not None}
        if len(words) == 2 and own.cycle in words:
            break
    if orbits[0] is not None and linear.dot(before - start[0], way) > 0:
        yield from all_crossings(plane, start, (before, orbits[0]))
    yield system, node
    if orbits[1] is not None and linear.dot(stop[0] - after, way) > 0:
        yield from all_crossings(plane, (after, orbits[1]), stop)


def borders_between(
    a: Parameters,
    b: Parameters,
    parameters: tuple[str, str],
    range: Mapping[str, tuple[NumberLike, NumberLike]],
    **how: Any,
) -> list[Border]:
    """Return the borders between the parameter sets `a` and `b`, found where the word changes on
    the way from a to b.

    `a` and `b` may differ in the two named parameters only; `how` holds `step` and `max_points` of
    `continue_border`.
    """
    plane = _read_plane(a, *parameters, range)
    first, second = (_settled(plane, p) for p in (a, b))
    begun = list[Any]()
    if (first[1] is None) != (second[1] is None):  # one of them has no word
        if first[1] is None:
            inside = second
            outside = first
        else:
            inside = first
            outside = second
        found = _loss_of_word(plane, inside, outside[0])
        if found is None:
            return []
        begun = [found[1]]
        first = inside
        second = found[0]
    if first[1] is not None and second[1] is not None:
        begun += all_crossings(plane, (first[0], first[1]), (second[0], second[1]))
    return _distinct(begun, *_read_steps(**how))


def _settled(plane: Plane, p: Parameters) -> tuple[np.ndarray, Orbit | None]:
    """Return the point of the plane that belongs to the parameters `p`, and the orbit of the
    settled motion, if any.
    """
    place = np.array([float(getattr(p, name)) for name in plane.names])
    try:
        orbit = find_orbit(p)
    except ConvergenceError:
        return place, None
    return place, Orbit(Word(orbit.labels), orbit.periods, orbit.phases())


def _loss_of_word(plane: Plane, inside: Any, place: np.ndarray) -> tuple[Motion, Any] | None:
    """Return (motion, border): the border between `inside`, with orbit, and `place`, without.

    A motion beside it.
    """
    system = ClosedForm(plane, plane.parameters(place), inside[1])

    def word(part: float) -> bool:
        holds, drives = system.terms(place + part * (inside[0] - place))
        return bool(holds < drives)

    low = 0.0
    high = 1.0
    if word(low) or not word(high):
        return None
    for _ in range(MOST_HALVINGS):
        middle = (low + high) / 2
        if word(middle):
            high = middle
        else:
            low = middle
    at, near = (
        place + part * (inside[0] - place) for part in (high, high + (1 - high) * BESIDE[1])
    )
    found = closed_form(plane, at, inside[1])
    if found is None:
        beside = None
    else:
        beside = motion_at(plane.parameters(near), found[0].orbit(found[1].z))
    if beside is None:
        return None
    return ((near, beside), closed_form(plane, at, beside))


def _distinct(begun: Iterable[tuple[BorderSystem, Node]], step: float, most: int) -> list[Border]:
    """Return the borders through the nodes of `begun`, each once, followed by steps up to `step` to
    `most` points.
    """
    found = list[Border]()
    for system, node in begun:
        border = Tracer(system, node, step, most).border()
        if len(border) > 1 and not any(
            passes(each, system.values(node.z), border.words) for each in found
        ):
            found.append(border)
    return found


def passes(border: Border, values: Sequence[float] | np.ndarray, words: Any) -> bool:
    """Return whether `border` has `words` on its sides and passes the point `values` within 1e-4 of
    the ranges.
    """
    if set(border.words) != set(words):
        return False
    # The chords of long steps are farther from the curve than that: the cubics between the points
    # are cut in eight.
    nodes = border._nodes
    system = border._system
    between_nodes = (between(a, b, part / 8) for a, b in pairwise(nodes) for part in range(8))
    curve = np.array([system.values(z) for z in (*between_nodes, nodes[-1].z)])
    places = (curve - values) / border._plane.widths
    way = np.diff(places, axis=0)
    squares = np.maximum((way * way).sum(axis=1), 1e-300)
    part = np.clip(-(places[:-1] * way).sum(axis=1) / squares, 0, 1)
    return bool((np.abs(places[:-1] + part[:, None] * way).max(axis=1) < 1e-4).any())


@public
def continue_border(
    branch: Branch,
    end: int,
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
    end : int
        The number of the branch's end, 0 or 1.
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
    require(TEXT, parameter=parameter)
    require(row_of(2, NUMBER), mapping_of(row_of(2, NUMBER)), range=range)
    require(NUMBER, step=step)
    require(WHOLE, max_points=max_points)
    which = whole_number("end", end, 0, 1)
    reason = branch.ends[which]
    if reason.kind in (RANGE, NO_CONVERGENCE, MOST):
        known = (
            f"must be an end at a border; the branch ends there with {reason.kind!r}: "
            f"{reason.message}"
        )
        raise ParameterError("end", end, known)
    if abs(reason.value) > 1e-12 * np.abs(branch.values).max():
        value = reason.value
    else:
        value = 0.0
    parameters = branch.parameters(-which).replace(**{branch.parameter: value})
    plane = _read_plane(parameters, branch.parameter, parameter, range)
    longest, most = _read_steps(step, max_points)
    values = np.array([value, float(getattr(parameters, parameter))])
    inward = np.sign(branch.values[len(branch.values) // 2] - reason.value) or (1.0, -1.0)[which]
    near = Orbit(Word(branch.labels), branch.periods, branch.orbit(-which).phases())
    if reason.beyond is None:
        closed = closed_form(plane, values, near)
    else:
        closed = None
    if closed is not None:
        border = Tracer(*closed, longest, most).border()
        border.kind = reason.kind
        return border
    for distance in AWAY:
        shift = np.array([inward * distance * plane.widths[0], 0.0])
        inside, outside = (
            motion_at(plane.parameters(values + way * shift), near) for way in (1, -1)
        )
        if inside is None or outside is None:
            continue
        found = first_crossing(plane, (values + shift, inside), (values - shift, outside))
        if found is not None:
            border = Tracer(*found, longest, most).border()
            if border.words[1] == cycle(branch.word):
                border.words = border.words[::-1]
                border._side = -border._side
                border.kind = reason.kind
            return border
    raise BorderError(
        f"the border of {branch.word} at {branch.parameter} = {reason.value:.8g} was not found: "
        f"{reason.message}"
    )


def _read_steps(step: NumberLike = STEP, max_points: int = MOST_POINTS) -> tuple[float, int]:
    """Check the two options of `continue_border`.

    Return the longest step and the largest number of points.
    """
    longest = float(read_exact("step", step))
    most = whole_number("max_points", max_points, 2)
    if not 0 < longest <= 0.1:
        raise ParameterError("step", step, "must be > 0 and at most 0.1")
    return longest, most


def _read_plane(parameters: Parameters, first: str, second: Any, limits: Any) -> Plane:
    """Check the two parameters and their ranges `limits`; return their plane."""
    if second not in PARAMETER_NAMES or second == first:
        known = f"must be one of {', '.join(name for name in PARAMETER_NAMES if name != first)}"
        raise ParameterError("parameter", second, known + meant(second, PARAMETER_NAMES))
    if isinstance(limits, Mapping):
        given = dict(limits)
    else:
        given = {second: limits}
    value = getattr(parameters, first)
    at_zero = (-1 if least(first) is None else 0, 1)
    given.setdefault(first, sorted((value / 10, value * 10)) if value else at_zero)
    low, high = np.array(
        [read_range(parameters, name, given.pop(name, None)) for name in (first, second)]
    ).T
    if given:
        raise ParameterError(
            "range", ", ".join(map(str, given)), f"must be ranges of {first} and {second}"
        )
    return Plane(parameters, (first, second), low, high)
