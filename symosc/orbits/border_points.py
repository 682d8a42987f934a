"""Points of codimension two and folds of a border: where they are, and what they are called.

At a point of codimension two two inequalities of one word vanish, or one vanishes that is not a
simple zero there. Doubles tell which; the point itself is located with many digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from math import pi
from typing import NamedTuple

import numpy as np

from symosc.kernels import linear
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import EPS
from symosc.model import Parameters
from symosc.orbits import border_system
from symosc.orbits.admissibility import Condition, conditions, failures, scales
from symosc.orbits.border_system import (
    BorderPlane,
    BorderSystem,
    Node,
    Zero,
    names_of,
    zeros_of,
)
from symosc.orbits.closing_equations import ClosingEquations, Orbit, solve
from symosc.orbits.find import settling

FOLD = "fold"
# To what length a change on the way is bisected, and how often at most.
LOCATED = 1e-12
MOST_HALVINGS = 50
# So far from where it is looked for a point is accepted, and a margin is taken to vanish there.
NEAR = 1e-3
# Points on the circle around a point of codimension two, and its radius as a part of the ranges.
AROUND = 24
RADIUS = 1e-3
# A piece that is shorter than this may be one that the other word has not.
SHORT_PIECE = 1e-3
# A zero of a margin may be a multiple one if its next derivative is below this part of the size of
# an acceleration per time. The point is known only as well as the curve shows it: the derivative
# need not be very small.
NEARLY_MULTIPLE = 0.1
# Ranks of candidates with one inequality, which are tried before all pairs: those at the end of a
# piece, then those at an extremum. Pairs have their larger relative margin, which is >= 0.
RANK_AT_END = -2.0
RANK_AT_EXTREMUM = -1.0
# The first change of a parameter in the secant method, as a part of its scale.
FIRST_CHANGE = 1e-9
# Bisections in doubles and steps of the secant method with many digits, to a fold.
FOLD_HALVINGS = 3
FOLD_STEPS = 8
REGULAR = {
    border_system.AT_FAR: ", and G^(1) of that domain is 0 there",
    border_system.AT_ARRIVAL: ", and G^(1) of that domain is 0 there: a cubic tangency",
    border_system.AT_TOUCH: " in an extremum at which v'' is 0 too",
    border_system.AT_HOLD: " in an extremum at which F'' is 0 too",
}


class PlacedOrbit(NamedTuple):
    """An orbit, and the values of the plane's two parameters at which it exists."""

    values: np.ndarray
    orbit: Orbit


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


def between(a: Node, b: Node, fraction: float) -> np.ndarray:
    """Return the point at this `fraction` of the way from a to b, on the cubic through both
    with their tangents (Hermite's).
    """
    length = linear.norm(b.z - a.z)  # the tangents are unit vectors
    r = fraction
    weight_of_a = (1 - r) ** 2 * (1 + 2 * r)
    weight_of_b = r * r * (3 - 2 * r)
    slope = length * (r * (1 - r) ** 2 * a.tangent - r * r * (1 - r) * b.tangent)
    return np.asarray(weight_of_a * a.z + weight_of_b * b.z + slope)


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
        positions, _ = orbit.points.T
        size = float(np.abs(positions).max())
        for piece, (x, theta) in zip(equations.pieces, orbit.points.tolist(), strict=True):
            settled, _ = settling(equations, x, theta % (2 * pi), piece.start, size)
            if settled is not None:
                return settled
    return None


def scaled_margin(condition: Condition) -> float:
    """Return a condition's relative margin: its value divided by the size of its terms."""
    return condition.value / condition.scale


def failing(system: BorderSystem, node: Node) -> Condition | None:
    """Return the inequality that fails most at a node of the border; None if all hold."""
    return min(
        (condition for condition in system.margins(node.z) if not condition.value > 0),
        key=scaled_margin,
        default=None,
    )


# -- folds -----------------------------------------------------------------------------------------


def fold_between(
    system: BorderSystem, here: Node, node: Node, j: int
) -> tuple[Node, SpecialPoint] | None:
    """Locate the fold between two nodes: the point of the border at which parameter j is largest or
    smallest.
    """
    near = _near_fold(system, here, node, j)
    if near is None:
        return None
    z, here = near
    fold = _polished_fold(system, z, j)
    if fold is None:
        return None
    values = system.values(fold.z)
    # The sign of a null vector is arbitrary: it goes the way that the border is followed.
    tangent = fold.tangent * float(np.sign(linear.dot(fold.tangent, here.tangent)))
    error = max(abs(fold.change), *(2 * EPS * abs(value) for value in values))
    if here.slope(j) > 0:
        extreme = "largest"
    else:
        extreme = "smallest"
    message = f"{system.plane.names[j]} is {extreme} along the border"
    return Node(fold.z, tangent, np.full(2, error)), SpecialPoint(FOLD, values, message, error)


def _near_fold(
    system: BorderSystem, here: Node, node: Node, j: int
) -> tuple[np.ndarray, Node] | None:
    """Return a point close to the fold between two nodes, in doubles, and the node before it."""
    z = here.z
    for _ in range(FOLD_HALVINGS):
        # Where the slope of parameter j would be 0 if it were linear between the nodes.
        fraction = here.slope(j) / (here.slope(j) - node.slope(j))
        middle = system.node(between(here, node, float(fraction)), here.tangent)
        if middle is None:
            return None
        z = middle.z
        if middle.slope(j) * here.slope(j) > 0:
            here = middle
        else:
            node = middle
    return z, here


class PolishedFold(NamedTuple):
    """A fold in scaled unknowns, the tangent there, and the last change of the parameter that was
    varied to find it.
    """

    z: np.ndarray
    tangent: np.ndarray
    change: float


def _polished_fold(system: BorderSystem, z: np.ndarray, j: int) -> PolishedFold | None:
    """Return the fold near `z`, or None.

    The secant method varies the other parameter until the slope of parameter j is 0.
    """
    # The two parameters are the last unknowns.
    fold_index = len(z) - 2 + j
    varied_index = len(z) - 1 - j
    value = float(z[varied_index] * system.scale[varied_index])
    tried: list[tuple[float, float]] = []  # value of the varied parameter, slope there
    for _ in range(FOLD_STEPS):
        u = system.polish(z, (varied_index, Fraction(value)))
        if u is None:
            return None
        tangent = system.fine_tangent(u)
        slope = float(tangent[fold_index] / tangent[varied_index])
        tried.append((value, slope))
        z = np.array([float(number) for number in u]) / system.scale
        if len(tried) == 1:
            change = FIRST_CHANGE * float(system.scale[varied_index])
        else:
            value_before, slope_before = tried[-2]
            if slope == slope_before:
                break
            change = -slope * (value - value_before) / (slope - slope_before)
        if abs(change) <= 4 * EPS * abs(value):  # rounding
            break
        value += change
    return PolishedFold(z, tangent, change)


# -- points of codimension two ---------------------------------------------------------------------


def end_between(system: BorderSystem, good: Node, bad: Node) -> tuple[Node, SpecialPoint]:
    """Locate the border's end between `good`, where all inequalities hold, and `bad`, as Node and
    SpecialPoint.
    """
    good, bad, condition = _bisected(system, good, bad)
    values = system.values(good.z)
    point = None
    if system.is_refined:
        point = meeting(system.plane, system.orbit(good.z), values)
    if point is None:
        message = _failure_text(condition)
        if system.is_refined:
            message += "; the point could not be refined"
        # How far the two nodes are apart in the parameters, the last two unknowns.
        length = float(np.abs((bad.z - good.z)[-2:] * system.scale[-2:]).max())
        kind, sliding = system.called()
        point = SpecialPoint(sliding or kind, values, message, length)
    # The last node of the border: the parameters of the point, all else as at `good`.
    z = good.z.copy()
    z[-2:] = np.array(point.values) / system.scale[-2:]
    return good._replace(z=z, errors=np.full(2, point.error)), point


def _bisected(system: BorderSystem, good: Node, bad: Node) -> tuple[Node, Node, Condition | None]:
    """Return two nodes close to each other, of which the second fails, and the condition there."""
    condition = failing(system, bad)
    for _ in range(MOST_HALVINGS):
        if linear.norm(bad.z - good.z) < LOCATED:
            break
        middle = system.node(between(good, bad, 0.5), good.tangent)
        if middle is None:
            break
        failed = failing(system, middle)
        if failed is None:
            good = middle
        else:
            bad = middle
            condition = failed
    return good, bad, condition


def _failure_text(condition: Condition | None) -> str:
    """Return in words which condition fails."""
    if condition is None:
        return "a condition fails"
    return f"the condition '{condition.text}' fails"


def meeting(plane: BorderPlane, orbit: Orbit, values: tuple[float, float]) -> SpecialPoint | None:
    """Find the point near the parameters `values` at which two inequalities of one word vanish;
    None if not found.

    The word is that of `orbit` or, if no point is found with it, the shortest one among the motions
    around `values`.
    """
    equations = ClosingEquations(plane.parameters(values), orbit.word, orbit.periods)
    has_short_piece = equations.durations(orbit.points).min() < SHORT_PIECE
    if not has_short_piece:
        point = _two_zeros(plane, orbit, values)
        if point is not None:
            return point
    around = [neighbour.orbit for neighbour in circle(plane, values, orbit)]
    if not around:
        return None
    shortest = min(around, key=lambda neighbour: len(neighbour.points))
    return _two_zeros(plane, shortest, values)


def circle(plane: BorderPlane, values: Sequence[float], orbit: Orbit) -> list[PlacedOrbit]:
    """Return points of the plane on a small circle around the point `values`, each with the orbit
    found there.
    """
    orbits = []
    for i in range(AROUND):
        angle = 2 * pi * (i + 0.5) / AROUND
        sample = np.array(values) + RADIUS * plane.widths * np.array([cos(angle), sin(angle)])
        if not ((plane.low <= sample).all() and (sample <= plane.high).all()):
            continue
        neighbour = motion_at(plane.parameters(sample), orbit)
        if neighbour is not None:
            orbits.append(PlacedOrbit(sample, neighbour))
    return orbits


class Vanishing(NamedTuple):
    """An inequality that nearly vanishes: a zero for the border's equations, the phases that are
    unknown in it, and the inequality.
    """

    zero: Zero
    phases: list[float]
    condition: Condition


class Candidate(NamedTuple):
    """Two zeros that may meet: of two inequalities, or of one and of its next derivative.

    Candidates with a lower `rank` are tried first. `texts` are those of the inequalities.
    """

    rank: float
    zeros: tuple[Zero, Zero]
    phases: list[float]
    texts: tuple[str, ...]


def _two_zeros(
    plane: BorderPlane, orbit: Orbit, values: tuple[float, float]
) -> SpecialPoint | None:
    """Find the point near the parameters `values` at which two inequalities of the orbit's word
    vanish, or None.
    """
    equations = ClosingEquations(plane.parameters(values), orbit.word, orbit.periods)
    # `half`: the number of pieces in a half of a symmetric orbit, else 0.
    points, half = _symmetric_points(equations, orbit)
    vanishing = _vanishing(equations, points)
    candidates = _degenerate(equations, points, vanishing) + _paired(vanishing, half)
    for candidate in sorted(candidates, key=lambda pair: pair.rank):
        for zeros, phases in _equations_of(candidate, vanishing, half):
            system = BorderSystem(plane, orbit._replace(points=points), zeros)
            unknowns = np.array([*points.ravel(), *phases, *values])
            polished = system.polish(unknowns / system.scale)
            if polished is None:
                continue
            # The plane's two parameters are the last unknowns. A root far away is another point:
            # both must be within NEAR of the ranges.
            values_found = (float(polished[-2]), float(polished[-1]))
            if (np.abs(np.subtract(values_found, values)) > NEAR * plane.widths).any():
                continue
            message = f"{_message(candidate)} ({orbit.cycle})"
            error = 2 * EPS * max(map(abs, values_found))
            return SpecialPoint(_kind(system, candidate), values_found, message, error)
    return None


def _symmetric_points(equations: ClosingEquations, orbit: Orbit) -> tuple[np.ndarray, int]:
    """Return the points of the orbit at the parameters of the equations.

    Return also the number of pieces in a half of the orbit if its second half nearly is the mirror
    image of the first; its points are then made exactly symmetric. Else that number is 0.
    """
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
    return points, half


def _vanishing(equations: ClosingEquations, points: np.ndarray) -> list[Vanishing]:
    """Return the inequalities that nearly vanish."""
    vanishing = []
    for condition in conditions(equations, points):
        if abs(scaled_margin(condition)) < NEAR:
            for zero, phases in zeros_of(equations, points, condition):
                vanishing.append(Vanishing(zero, phases, condition))
    return vanishing


def _degenerate(
    equations: ClosingEquations, points: np.ndarray, vanishing: Sequence[Vanishing]
) -> list[Candidate]:
    """Return a candidate for each inequality whose zero is nearly a multiple one: this zero, and
    that of the next derivative (`Zero.bend`).
    """
    size = scales(equations, points)
    candidates = []
    for zero, phases, condition in vanishing:
        if phases:
            theta = phases[0]
            rank = RANK_AT_EXTREMUM
        else:
            theta = 0.0  # not used: only extrema have a phase
            rank = RANK_AT_END
        (derivative,) = border_system.zero_values(equations, points, zero.bend, theta)
        # The derivative is G^(1) of a force at an end, v'' at an extremum of v: an acceleration per
        # time. At an extremum of a force in a stick it is F'', with one time more, so that there
        # the bound depends on the unit of time.
        if abs(derivative) * size.t < NEARLY_MULTIPLE * size.a:
            candidates.append(Candidate(rank, (zero, zero.bend), phases, (condition.text,)))
    return candidates


def _paired(vanishing: Sequence[Vanishing], half: int) -> list[Candidate]:
    """Return the pairs of inequalities that nearly vanish, but not those that are one by symmetry."""
    candidates = []
    for first, second in combinations(vanishing, 2):
        same_kind = first.zero.kind == second.zero.kind
        if same_kind and second.zero.piece - first.zero.piece == half:  # mirror images
            continue
        # Pairs that are nearer to 0 are tried first.
        rank = max(abs(scaled_margin(first.condition)), abs(scaled_margin(second.condition)))
        zeros = (first.zero, second.zero)
        texts = (first.condition.text, second.condition.text)
        candidates.append(Candidate(rank, zeros, first.phases + second.phases, texts))
    return candidates


def _equations_of(
    candidate: Candidate, vanishing: Sequence[Vanishing], half: int
) -> list[tuple[Sequence[Zero], list[float]]]:
    """Return the zeros to solve for, with their phases, in the order in which to try them.

    The equations of one half of a symmetric orbit may leave the other half undetermined: both are
    tried first.
    """
    alone = (candidate.zeros, candidate.phases)
    if not half:
        return [alone]
    images = [(zero.kind, zero.piece + sign * half) for zero in candidate.zeros for sign in (1, -1)]
    mirrored = [
        inequality
        for inequality in vanishing
        if (inequality.zero.kind, inequality.zero.piece) in images
    ]
    if not mirrored:
        return [alone]
    zeros = list(candidate.zeros)
    phases = list(candidate.phases)
    for image in mirrored:
        zeros.append(image.zero)
        if len(candidate.texts) == 1:  # a degenerate zero
            zeros.append(image.zero.bend)
        phases += image.phases
    return [(zeros, phases), alone]


def _kind(system: BorderSystem, candidate: Candidate) -> str:
    """Return the names of the borders that meet at a point, as in the literature."""
    # A candidate with one inequality has its next derivative as second zero, without a name.
    names = [names_of(system, zero) for zero in candidate.zeros[: len(candidate.texts)]]
    kind = " and ".join(sorted(sliding or end_kind for end_kind, sliding in names))
    # Two simple zeros meet, or a cubic tangency has a name of its own.
    is_simple = len(candidate.texts) == 2 or candidate.zeros[0].kind == border_system.AT_ARRIVAL
    if is_simple:
        return kind
    return f"degenerate {kind}"


def _message(candidate: Candidate) -> str:
    """Return text that says which inequalities vanish at a point."""
    message = " and ".join(f"{text} just fails" for text in candidate.texts)
    if len(candidate.texts) == 1:
        message += REGULAR[candidate.zeros[0].kind]
    return message
