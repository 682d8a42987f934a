"""The equations of a border: the closing equations of one word, and the inequalities that are 0 on
it.

A border is followed with the word of its two that has fewer pieces: on the other side some piece is
added, which has no length on the border. Its inequality vanishes in one of four ways (`Zero`). The
field's names are those of di Bernardo, Kowalczyk and Nordmark (Int. J. Bifurcation Chaos 13, 2003)
for what the orbit does to the belt's sticking region, the part of the switching plane with
F^(below) > 0 > F^(above):

    FAR, at a crossing   it crosses at the region's edge and a stick is born there         crossing-sliding
    FAR, at an onset     it arrives at the edge and a slip to the far side is born         switching-sliding
    HOLD, in a stick     it touches the edge from inside and a slip is born                adding-sliding
    TOUCH, in a flight   it grazes the belt where the mass would stick                     grazing-sliding

The force of the far domain is 0 in the first two; G^(1) of the far domain tells them apart and is 0
where they meet (FLAT). The phase of a turn (HOLD) or of a graze (TOUCH) is an unknown, so all
equations are algebraic. A graze next to the start of its flight would have the start itself as a
second root: it is divided out, as in the closing equations.

At a point of codimension two a second zero is added, of another inequality, or of what makes the
first one simple (`Zero.bend`). ARRIVAL is only for such points: a flight that meets its belt with
v' = v'' = 0.

Motions that are symmetric lose two inequalities at once. They belong to one border, and the
equations take one of them.

Where the motion loses its word, as it comes to rest or meets no belt, the border has a closed form
(`ClosedForm`).
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from math import inf, pi
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from symosc.base.aliases import Mpf, Number, Points
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import constants, derivatives
from symosc.friction import NEIGHBOURS
from symosc.kernels import linear
from symosc.kernels._generated import motion, next_derivative
from symosc.kernels.entire import EPS
from symosc.model import OtherNumbers, Parameters, by_name
from symosc.orbits import admissibility
from symosc.orbits.admissibility import (
    Condition,
    Extreme,
    clearances,
    conditions,
    holding_forces,
    scales,
)
from symosc.orbits.closing_equations import ClosingEquations, Orbit, OrbitPiece, pieces_of

#: What stands for a word where the mass may rest on a belt for ever.
REST = "rest"
AT_FAR = "far"
AT_ARRIVAL = "arrival"
AT_FLAT = "flat"
AT_HOLD = "hold"
AT_TOUCH = "touch"
AT_BEND = "bend"
TIMED = (AT_HOLD, AT_TOUCH)  # zeros at a phase that is an unknown
MOST_NEWTON = 12
MOST_POLISHING = 30
DIFFERENCE = 1e-7  # for derivatives in doubles: Newton's method needs no more
FINE_DIFFERENCE_EXPONENT = -20  # the same with FINE_DIGITS, as a power of 10
FINE_DIGITS = 50
# Newton's method in doubles, in scaled unknowns: it has converged at steps of this size; from the
# next one on steps that shrink by less than NO_PROGRESS are rounding. The Jacobian is computed anew
# where a step has shrunk by less than SLOW_PROGRESS.
CONVERGED = 1e-12
PERHAPS_ROUNDING = 1e-6
NO_PROGRESS = 4
SLOW_PROGRESS = 16
# With FINE_DIGITS it has converged at steps of this size.
FINE_CONVERGED = 1e-30
# Entries of the inverse Jacobian as large as this show a point that is not isolated.
LARGEST_INVERSE = 1e6
# Points of the plane that differ by less, as a part of the ranges, are one.
SAME_POINT = 1e-6
# Phases that differ by less are those of one extremum.
SAME_EXTREMUM = 1e-5
NOTHING = 1e-7  # a margin below this part of its terms is 0 on a border
POINTS_WEIGHT = 4.0  # by which switching points count less than the parameters in lengths
# Positions are measured by the extent of the orbit, or by this part of how far out it is.
LEAST_EXTENT = 0.1


#: The unknowns of a border: x and theta of each switching, phases of zeros, and two parameters.
Unknowns: TypeAlias = "Sequence[Number] | np.ndarray"


class Zero(NamedTuple):
    """A margin that is 0 on a border: its kind, its piece, and `place`, the belt of a gap or the
    domain of a force.
    """

    kind: str
    piece: int
    place: int

    @property
    def bend(self) -> Zero:
        """The `Zero` of this margin's next time derivative, which vanishes too where the zero is
        not a simple one.
        """
        return self._replace(kind=AT_BEND if self.kind in TIMED else AT_FLAT)


class BorderPlane(NamedTuple):
    """A plane of two parameters: the parameter set that fixes the others, the names of the two, and
    their ranges.
    """

    fixed: Any
    names: tuple[str, str]
    low: np.ndarray
    high: np.ndarray

    def parameters(self, values: Sequence[float] | np.ndarray) -> Any:
        """Return the parameters at a point of the plane: Parameters, or an Oscillator."""
        return self.fixed.replace(**dict(zip(self.names, map(float, values), strict=True)))

    def near(self, a: Sequence[float], b: Sequence[float]) -> bool:
        """Return whether two points of the plane differ by less than SAME_POINT of the range in
        each parameter.
        """
        return bool((np.abs(np.subtract(a, b)) < SAME_POINT * self.widths).all())

    @property
    def widths(self) -> np.ndarray:
        """The widths of the ranges."""
        return self.high - self.low


class Node(NamedTuple):
    """A point of a border.

    It has the scaled unknowns `z` of a `BorderSystem`, the unit tangent there (scaled likewise), and
    the estimated absolute errors of the two parameters (not scaled).
    """

    z: np.ndarray
    tangent: np.ndarray
    errors: np.ndarray

    def slope(self, j: int) -> float:
        """Return how fast parameter j (0 or 1) changes along the border here: the parameters are
        the last two unknowns.
        """
        return self.tangent[-2 + j]


class Evaluated(NamedTuple):
    """Unknowns of a border in words: the closing equations at its parameters, the switching points
    and the phases of extrema.
    """

    equations: ClosingEquations
    points: Points
    phases: Unknowns


class Corrected(NamedTuple):
    """A root by Newton's method, the inverse Jacobian, and the estimated error of the root, all in
    scaled unknowns.
    """

    z: np.ndarray
    inverse: np.ndarray
    error: float


class LocatedZero(NamedTuple):
    """A zero, and the phase of its extremum in a list, which is empty if it has none."""

    zero: Zero
    phases: list[float]


# Stretches below this part of the largest one are rounding.
NO_STRETCH = 1e-15


class QuickArithmetic(Arithmetic):
    """Arithmetic in doubles only to evaluate equations.

    It lacks the constants that a search for events needs.
    """

    def __init__(self, parameters: OtherNumbers) -> None:
        self.K = constants(parameters)  # from floats, which is faster than from fractions


class BorderSystem:
    """The closing equations of a word together with the margins that have to vanish on a border,
    `zeros`.

    The unknowns u are x and theta of each switching point, the phase of each extremum at which a
    margin has to vanish, and the two parameters. If one margin vanishes the roots form a curve, the
    border; if two, a point. Lengths are measured in the scaled unknowns z = u/scale.
    """

    #: Whether points of codimension two are located with many digits.
    is_refined = True

    def __init__(self, plane: BorderPlane, orbit: Orbit, zeros: Sequence[Zero]) -> None:
        self.word, self.periods, points = orbit
        self.plane = plane
        self.fixed = plane.fixed
        self.names = plane.names
        self.zeros = tuple(zeros)
        self.timed = [zero for zero in self.zeros if zero.kind in TIMED]
        self.given = by_name(plane.fixed, float)
        self.pieces = pieces_of(self.word)
        self.n = len(self.pieces)
        self.sizes = np.zeros(0)
        # conditions that are 0 all along, as the border's own or by symmetry
        self.hidden: tuple[int, ...] = ()
        self.pieces = self._unaccelerated_after(
            zero.piece for zero in self.zeros if zero.kind == AT_FAR
        )
        self.symmetric_pieces = self.pieces
        x, _ = points.T
        size = max(np.ptp(x), LEAST_EXTENT * np.abs(x).max())
        weight = POINTS_WEIGHT * np.sqrt(2 * self.n)
        self.scale = np.array(
            [*[size * weight, weight] * self.n, *[weight] * len(self.timed), *plane.widths]
        )

    def _unaccelerated_after(self, crossings: Iterable[int]) -> tuple[OrbitPiece, ...]:
        """Return the word's pieces, where a flight after a piece whose index is in `crossings`
        starts with acceleration 0, as it does after a stick.
        """
        pieces = list(self.pieces)
        for i in crossings:
            following = (i + 1) % self.n
            piece = pieces[following]
            pieces[following] = replace(piece, after_stick=not piece.sticks)
        return tuple(pieces)

    def called(self) -> tuple[str, str]:
        """Return what happens at the border, and its name in the literature."""
        return names_of(self)

    # -- the equations -----------------------------------------------------------------------------

    def at(self, u: Unknowns, digits: int | None = None) -> Evaluated:
        """Return the closing equations, the switching points and the phases of extrema for the
        unknowns u.
        """
        changed = dict(zip(self.names, u[-2:], strict=True))
        if digits is None:
            values: Any = OtherNumbers(self.given | changed)
        else:
            values = self.fixed.replace(**changed)
        if digits:
            arithmetic = None
        else:
            arithmetic = QuickArithmetic(values)
        equations = ClosingEquations(values, self.word, self.periods, digits, arithmetic)
        equations.pieces = self.pieces
        return Evaluated(equations, *self._split(u))

    def _split(self, u: Unknowns) -> tuple[Points, Unknowns]:
        """Return the switching points and the phases of extrema that the unknowns u contain."""
        n = 2 * self.n
        return list(zip(u[:n:2], u[1:n:2], strict=True)), u[n:-2]

    def values(self, z: np.ndarray) -> tuple[float, float]:
        """Return the values of the two parameters at scaled unknowns z."""
        first, second = (z[-2:] * self.scale[-2:]).tolist()
        return first, second

    def orbit(self, z: np.ndarray) -> Orbit:
        """Return the orbit at scaled unknowns z."""
        return Orbit(self.word, self.periods, (z * self.scale)[: 2 * self.n].reshape(-1, 2))

    def residuals(self, u: Unknowns, digits: int | None = None) -> list[Number]:
        """Return what must be 0 at u: closing equations, then margins that vanish; in floats, or
        with `digits`.
        """
        equations, points, phases = self.at(u, digits)
        return equations.residuals(points) + self._zeros(equations, points, phases)

    def _zeros(self, equations: ClosingEquations, points: Points, phases: Unknowns) -> list[Number]:
        """Return the values that must vanish on the border besides the closing equations."""
        values = []
        phases_left = list(phases)
        for zero in self.zeros:
            if zero.kind in TIMED:  # the phases are in the order of these zeros
                theta = phases_left.pop(0)
            else:  # a bend belongs to the extremum of another zero, in the same piece
                phase_of = {
                    timed.piece: phase
                    for timed, phase in reversed(list(zip(self.timed, phases, strict=True)))
                }
                theta = phase_of.get(zero.piece)
            values += zero_values(equations, points, zero, theta)
        return values

    def _linearised(self, u: list[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the residuals at u and their Jacobian in doubles.

        The rows of the closing equations have exact derivatives by the switching points; the rows
        of zeros and the columns of the parameters are finite differences.
        """
        equations, points, phases = self.at(u)
        n = 2 * self.n
        size = len(u)
        values = np.array(equations.residuals(points) + self._zeros(equations, points, phases))
        matrix = np.zeros((len(values), size))
        matrix[:n, :n] = equations.matrix(points)
        # A zero depends on start and end of its piece, each with x and theta: four unknowns.
        touched = {(2 * zero.piece + j) % n for zero in self.zeros for j in range(4)}

        def zeros(unknowns: Unknowns) -> list[Number]:
            return self._zeros(equations, *self._split(unknowns))

        for j in (*touched, *range(n, size - 2)):
            step = DIFFERENCE * self.scale[j] / POINTS_WEIGHT
            matrix[n:, j] = _slope(zeros, u, values[n:], j, step)
        for j in (-2, -1):
            matrix[:, j] = _slope(self.residuals, u, values, j, DIFFERENCE * self.scale[j])
        return values, matrix

    def fine_tangent(self, u: Sequence[Mpf]) -> np.ndarray:
        """Return the border's unit tangent at the mpmath numbers u, in scaled unknowns, to nearly
        double precision.
        """
        step = u[0].context.mpf(10) ** FINE_DIFFERENCE_EXPONENT
        (equations, _, _) = self.at(u, FINE_DIGITS)

        def at_fixed_parameters(unknowns: Unknowns) -> list[Number]:
            points, phases = self._split(unknowns)
            return equations.residuals(points) + self._zeros(equations, points, phases)

        def at_any(unknowns: Unknowns) -> list[Number]:
            return self.residuals(unknowns, FINE_DIGITS)

        values = np.array(at_any(u))
        functions = [at_fixed_parameters] * (len(u) - 2) + [at_any] * 2
        columns = [
            _slope(function, u, values, j, step).astype(float)
            for j, function in enumerate(functions)
        ]
        return linear.null_vector(np.array(columns).T * self.scale)

    # -- Newton's method ---------------------------------------------------------------------------

    def correct(self, z: np.ndarray, row: np.ndarray | None) -> Corrected | None:
        """Solve the equations by Newton's method from z; None if that fails.

        `row` is the normal of a hyperplane through z that contains the root; None if the equations
        alone fix it.
        """
        start = z
        inverse = None
        before = inf
        with suppress(ZeroDivisionError, OverflowError, ValueError):
            for _ in range(MOST_NEWTON):
                u = (z * self.scale).tolist()
                if inverse is None:  # at the start, and where the last one converged slowly
                    values, matrix = self._linearised(u)
                    matrix *= self.scale
                    if row is not None:
                        matrix = np.vstack([matrix, row])
                    if len(matrix) == len(z):
                        inverse = linear.inverse(matrix)
                    else:  # of too many equations, none contradicts the others
                        inverse = linear.pseudo_inverse(matrix, NO_STRETCH)
                else:
                    values = np.array(self.residuals(u))
                if row is not None:
                    values = np.append(values, linear.dot(row, z - start))
                step = linear.product(inverse, values)
                size = float(np.abs(step).max())
                if not size < 1:  # nan too
                    return None
                z = z - step
                is_rounding = size < PERHAPS_ROUNDING and size > before / NO_PROGRESS
                if size < CONVERGED or is_rounding:
                    # The next correction is smaller by the last ratio, or by the Jacobian's error.
                    return Corrected(z, inverse, size * (10.0 * size / before + DIFFERENCE))
                if size > before / SLOW_PROGRESS:
                    inverse = None
                before = size
        return None

    def polish(
        self, z: np.ndarray, fixed: tuple[int, Fraction] | None = None
    ) -> list[Number] | None:
        """Return the root u in many digits; None if it is not found.

        `fixed` is the index of an unknown and the exact value that it keeps, for a system whose
        roots form a curve.
        """
        if fixed is None:
            row = None
        else:
            index, exact_value = fixed
            row = np.eye(len(z))[index]
        corrected = self.correct(z, row)
        if corrected is None:
            return None
        inverse = corrected.inverse
        is_singular = fixed is None and np.abs(inverse).max() > LARGEST_INVERSE
        if not np.isfinite(inverse).all() or is_singular:
            return None
        equations = ClosingEquations(self.fixed, self.word, self.periods, FINE_DIGITS)
        number = equations.arithmetic.number
        u = [number(Fraction(value)) for value in (corrected.z * self.scale).tolist()]
        # With the inverse in doubles each step makes many more digits right.
        before = inf
        with suppress(ZeroDivisionError, ValueError):
            for _ in range(MOST_POLISHING):
                if fixed is not None:
                    u[index] = number(exact_value)
                values = [float(value) for value in self.residuals(u, FINE_DIGITS)]
                if not np.isfinite(values).all():
                    return None
                if fixed is not None:
                    values.append(0.0)  # the hyperplane's equation: u[index] is right already
                step = linear.product(inverse, np.array(values))
                size = float(np.abs(step).max())
                changes = (step * self.scale).tolist()
                u = [
                    value - number(Fraction(change))
                    for value, change in zip(u, changes, strict=True)
                ]
                if size < FINE_CONVERGED:
                    return u
                if size > before / 2:  # it does not converge
                    return None
                before = size
        return None

    def node(self, z: np.ndarray, along: np.ndarray, row: np.ndarray | None = None) -> Node | None:
        """Find the border's point in the hyperplane through z with the normal `row` or else
        `along`; None if not found.

        The node's tangent is oriented like `along`. Its errors come from rounding and from the last
        correction.
        """
        corrected = self.correct(z, along if row is None else row)
        if corrected is None:
            return None
        z, inverse, error = corrected
        if not self.sizes.size:  # one orbit tells the sizes of the terms for all
            self.sizes = self._sizes((z * self.scale).tolist())
        # What rounding of the residuals does to the parameters, the last two unknowns.
        grown = np.abs(inverse[-2:, : len(self.sizes)])
        rounding = linear.product(grown, 4 * EPS * self.sizes) + 2 * EPS * np.abs(z[-2:])
        # The last column of the inverse moves along the border: no residual but the row's changes.
        tangent = inverse[:, -1] * np.sign(linear.dot(inverse[:, -1], along))
        return Node(z, tangent / linear.norm(tangent), (rounding + error) * self.scale[-2:])

    def _sizes(self, u: Sequence[float]) -> np.ndarray:
        """Return the sizes of the terms of all residuals, by which their rounding errors are
        measured.
        """
        equations, points, _ = self.at(u)
        size = scales(equations, points)
        sizes = []
        largest = max(abs(x) for x, _ in points)
        for piece, _, _, tau in equations.spans(points):
            if piece.sticks:
                size_2 = size.a
            else:
                size_2 = size.v * min(1.0, abs(tau)) / abs(tau) ** piece.zeros
            sizes += [largest, size_2]
        for zero in self.zeros:
            if zero.kind == AT_TOUCH:
                sizes += [size.v, size.a / size.t]
            elif zero.kind in TIMED:
                sizes += [size.a, size.a]
            else:
                sizes.append(size.a)
        return np.array(sizes)

    # -- the inequalities along the border ---------------------------------------------------------

    def hide(self, curve: Sequence[np.ndarray]) -> None:
        """Make `margins` ignore the inequalities that are 0 all along the border, at all its points
        z in `curve`.
        """
        flags = list[list[bool]]()
        shift = 0
        for z in curve:
            equations, points, _ = self.at((z * self.scale).tolist())
            margins = conditions(equations, points)
            flags.append([abs(c.value) < NOTHING * c.scale for c in margins])
            if is_symmetric(np.array(points)):
                shift = self.n // 2
            else:
                shift = 0
        small = [i for i, states in enumerate(zip(*flags, strict=True)) if all(states)]
        # An extremum next to an end of its flight may be missed; by symmetry its margin is 0 too.
        own = [(zero.kind, zero.piece) for zero in self.zeros]
        own += [(zero.kind, (zero.piece + shift) % self.n) for zero in self.zeros]
        of_zeros = [i for i, c in enumerate(margins) if (kind_of(c), c.piece) in own]
        self.hidden = tuple({*small, *of_zeros})
        # Only for the inequalities: the equations would not fix an orbit that is at rest twice.
        crossings = [
            c.piece for i, c in enumerate(margins) if i in small and c.rank == admissibility.PASSING
        ]
        self.symmetric_pieces = self._unaccelerated_after(crossings)

    def margins(self, z: np.ndarray) -> list[Condition]:
        """Return the inequalities that must hold on the border, and those by which the zeros on it
        are simple ones.
        """
        equations, points, phases = self.at((z * self.scale).tolist())
        equations.pieces = self.symmetric_pieces
        all_conditions = conditions(equations, points)
        size = scales(equations, points)
        kinds_and_pieces = {(zero.kind, zero.piece) for zero in self.zeros}
        hidden = [all_conditions[i] for i in sorted(self.hidden)]
        own = [c for c in hidden if (kind_of(c), c.piece) in kinds_and_pieces]
        # A hidden inequality is 0 all along: it fails nowhere.
        margins = [
            c._replace(value=inf) if i in self.hidden else c for i, c in enumerate(all_conditions)
        ]
        # A zero without a phase does not use its theta.
        padded_phases = [*phases, *[0.0] * len(self.zeros)]
        for zero, theta in zip(self.zeros, padded_phases, strict=False):
            margins += self._simple_zero_margins(equations, points, zero, theta, size.a / size.t)
        equations.pieces = self.pieces
        return margins + [_elsewhere(equations, points, condition, phases) for condition in own]

    def _simple_zero_margins(
        self, equations: ClosingEquations, points: Points, zero: Zero, theta: float, size: float
    ) -> Iterator[Condition]:
        """Yield the inequalities that hold as long as `zero` is a simple one; where one of them
        fails, the border ends.

        `theta` is the phase of the extremum at which the margin vanishes; `size` becomes the
        `Condition.scale`.
        """
        _, begin = points[zero.piece]
        _, end = equations.ends(points)[zero.piece]
        piece = self.pieces[zero.piece]
        (value,) = zero_values(equations, points, zero.bend, theta)
        if zero.kind == AT_FAR:
            # At a crossing the force of the far domain has the sign of the side or is 0, at an
            # onset of a stick it has not: its derivative G^(1) must have the same sign.
            following = self.pieces[(zero.piece + 1) % self.n]
            if following.sticks:
                sign = -piece.side
            else:
                sign = piece.side
            theta = end
            text = f"G^(1) of the far domain at the end of {piece.label} keeps its sign"
        else:
            # The belt or domain with the smaller number lies below: a minimum is turned to it.
            if zero.kind == AT_HOLD:
                place_below = piece.start
            else:
                place_below = piece.mode - 1
            if zero.place == place_below:
                sign = 1
            else:
                sign = -1
            text = f"the extremum in {piece.label} is a regular one"
            for turned, order in ((theta - begin, "begins before"), (end - theta, "ends after")):
                time = turned / equations.K.Om
                inequality = f"{piece.label} {order} its extremum"
                yield Condition(zero.piece, inequality, time, theta, "", -1, size)
        yield Condition(zero.piece, text, float(sign * value), theta / equations.K.Om, "", -1, size)


class ClosedForm(BorderSystem):
    """A border beyond which the motion has no word (it rests, or meets no belt): one equation in
    both parameters.

    The equation is about the slower belt. If this belt is at rest, the mass may rest on it where mu
    FN >= |B0|. If the speed of this belt is one of the two parameters, the border is the line of
    speed 0, with a word on either side. A moving belt is not met if it is at least as fast as the
    steady motion: |v| sqrt((k - m Omega^2)^2 + (c Omega)^2) >=
    |B0| Omega. The parameters `fixed` lie on the border; `orbit` is an orbit beside the border.
    """

    is_refined = False

    def __init__(self, plane: BorderPlane, fixed: Parameters, orbit: Orbit) -> None:
        if abs(fixed.v1) <= abs(fixed.v2):
            belt = 1
        else:
            belt = 2
        super().__init__(plane._replace(fixed=fixed), orbit, [Zero(AT_TOUCH, 0, belt)])
        self.plane = plane
        self.belt = belt
        self.n = 0
        self.near = orbit.points
        self.scale = plane.widths
        self.rests = fixed.belt(belt) == 0
        self.line = self.rests and f"v{belt}" in plane.names
        # Signs by which the belt's speed and B0 become their absolute values.
        if fixed.belt(belt) > 0:
            self.up = 1
        else:
            self.up = -1
        if fixed.B0 > 0:
            self.push = 1
        else:
            self.push = -1

    def _numbers(self, u: Unknowns, digits: int | None = None) -> Any:
        """Return all parameters, with the values `u` of the plane's two, as floats or, with
        `digits`, in mpmath.
        """
        changed = dict(zip(self.names, u, strict=True))
        if digits is None:
            return OtherNumbers(self.given | changed)
        first: Mpf = u[0]
        fixed = by_name(self.fixed, lambda q: first.context.mpf(q.numerator) / q.denominator)
        return OtherNumbers(fixed | changed)

    def terms(self, u: Unknowns, digits: int | None = None) -> tuple[Number, Number]:
        """Return the two terms that are equal on the border; where the first is larger the motion
        has no word.
        """
        p = self._numbers(u, digits)
        if self.rests:
            return p.friction(self.belt), self.push * p.B0
        resisted = (p.k - p.m * p.Omega**2) ** 2 + (p.c * p.Omega) ** 2
        return self.up * p.belt(self.belt) * resisted**0.5, self.push * p.B0 * p.Omega

    def residuals(self, u: Unknowns, digits: int | None = None) -> list[Number]:
        """Return what is 0 on the border, in a list: the difference of `terms`, or the speed of a
        belt at rest.
        """
        holds, drives = self.terms(u, digits)
        return [self._numbers(u, digits).belt(self.belt) if self.line else holds - drives]

    def _linearised(self, u: list[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual at u and its derivatives, in doubles."""
        values = np.array(self.residuals(u))
        columns = [_slope(self.residuals, u, values, j, DIFFERENCE * self.scale[j]) for j in (0, 1)]
        return values, np.transpose(columns)

    def _sizes(self, u: Sequence[float]) -> np.ndarray:
        """Return the size of the terms of the residual."""
        _, drives = self.terms(u)
        return np.array([0.0 if self.line else abs(drives)])

    def along(self, values: np.ndarray) -> np.ndarray:
        """Return the direction of the border at a point of it, in scaled unknowns."""
        _, matrix = self._linearised(values.tolist())
        ((a, b),) = matrix * self.scale  # the gradient of the one residual
        return np.array([b, -a]) / linear.norm(np.array([a, b]))

    def margins(self, z: np.ndarray) -> list[Condition]:
        """Return the conditions of the border: a moving belt is met before the other, a belt at
        rest holds the mass.
        """
        p = self._numbers(z * self.scale)
        margins = []
        own = self.up * p.belt(self.belt)
        far = -self.up * p.belt(3 - self.belt)
        if self.line:
            # On the line of speed 0 the mass can rest as long as friction holds it.
            holds, drives = self.terms(z * self.scale)
            margins.append((f"mu{self.belt} FN > |B0|", holds - drives))
        elif not self.rests:
            margins.append((f"v{self.belt} is not 0", own))
            if far > 0 and self.fixed.v1 != -self.fixed.v2:
                margins.append((f"belt {self.belt} is met before the other one", far - own))
        return [Condition(0, text, float(value), 0.0, "", -1, 1.0) for text, value in margins]

    def orbit(self, z: np.ndarray) -> Orbit:
        """Return the limit of orbits at the border: flights of no duration, or a steady motion that
        grazes belts.
        """
        p = self.fixed.replace(**dict(zip(self.names, (z * self.scale).tolist(), strict=True)))
        points = self.near.copy()
        if self.rests:
            points[:, 0] = float(sum(p.A(domain) for domain in NEIGHBOURS[self.belt]) / (2 * p.k))
            points[:, 1] = pi * np.round(points[:, 1] / pi)
            return Orbit(self.word, self.periods, points)
        if p.v1 > 0:
            domain = 1
        elif p.v2 < 0:
            domain = 3
        else:
            domain = 2
        fastest = phase(self.push * complex(p.c * p.Omega, p.m * p.Omega**2 - p.k))
        phases = np.array([fastest + pi * (p.belt(piece.start) < 0) for piece in self.pieces])
        points[:, 0] = float(p.A(domain) / p.k)
        points[:, 1] = phases + 2 * pi * np.round((points[:, 1] - phases) / (2 * pi))
        return Orbit(self.word, self.periods, points)


def _slope(
    function: Callable[[Unknowns], list[Number]],
    u: Unknowns,
    values: np.ndarray,
    j: int,
    step: Number,
) -> np.ndarray:
    """Return the difference quotient of `function` at u by u[j], with this step.

    `values` is function(u).
    """
    beside = list(u)
    beside[j] += step
    return np.asarray((np.array(function(beside)) - values) / step)


def extrema_of(equations: ClosingEquations, points: Points, i: int, kind: str) -> list[Extreme]:
    """Return the extrema in piece i: from `clearances` if `kind` is that of a graze, else from
    `holding_forces`.
    """
    span = equations.spans(points)[i]
    if kind == AT_TOUCH:
        return list(clearances(equations, span))
    return list(holding_forces(equations, span))


def _elsewhere(
    equations: ClosingEquations, points: Points, condition: Condition, phases: Unknowns
) -> Condition:
    """Return the inequality that a condition, which is 0 at the extrema of the given `phases`, also
    holds at all other extrema of its piece; its value is inf if there are none.
    """
    margins = list[Number]()
    kind = kind_of(condition)
    if kind in TIMED:
        for extreme in extrema_of(equations, points, condition.piece, kind):
            if all(abs(extreme.theta - phase) > SAME_EXTREMUM for phase in phases):
                margins.append(extreme.margin)
    value = float(min(margins, default=inf))
    return condition._replace(value=value, text=f"elsewhere, {condition.text}")


def zero_values(
    equations: ClosingEquations, points: Points, zero: Zero, theta: Number
) -> list[Number]:
    """Return what is 0 where `zero` is: its margin and, if this has an extremum, of phase `theta`,
    its derivative.
    """
    start = points[zero.piece]
    start_x, start_theta = start
    piece = equations.pieces[zero.piece]
    K = equations.K
    if zero.kind in (AT_FAR, AT_ARRIVAL, AT_FLAT):
        x, end = equations.ends(points)[zero.piece]
        v = equations.belt(piece.end).v
        F = equations.force(zero.place, x, v, end)
        if zero.kind != AT_FLAT:
            return [F]
        return [next_derivative(F, v, K.fB * equations.sin(end), K.cm, K.w0sq)]
    tau = (theta - start_theta) / K.Om
    if piece.sticks:
        belt = equations.belt(piece.start)
        if zero.kind == AT_BEND:
            return [-K.fB * K.Om * equations.cos(theta)]
        force = equations.force(zero.place, start_x + belt.v * tau, belt.v, theta)
        return [force, belt.drift - K.fB * equations.sin(theta)]
    launch = equations.start_of_flight(piece, start)
    _, dv, a = motion(*launch, K.cm, K.w0sq, K.f0, K.Om, *equations.basis(tau, K)[:5])
    if zero.kind == AT_BEND:
        return [next_derivative(a, launch.v + dv, K.fB * equations.sin(theta), K.cm, K.w0sq)]
    gap = (launch.v - equations.belt(zero.place).v) + dv
    roots = piece.roots(zero.place)
    if roots == 0:
        return [gap, a]
    # gap = g tau^roots (1 + ...): what is left of a once the multiple of gap with the same first
    # term is taken away.
    return [gap / tau**roots, (a - roots * gap / tau) / tau**roots]


def is_symmetric(points: np.ndarray, part: float = NOTHING) -> bool:
    """Return whether x(t + T/2) + x(t) is constant on the orbit through `points`, to the relative
    accuracy `part`.
    """
    if len(points) % 2:
        return False
    off_x, off_theta = np.abs(symmetrised(points) - points).T
    x, _ = np.abs(points).T
    return bool(off_x.max() < part * x.max() and off_theta.max() < part)


def symmetrised(points: np.ndarray) -> np.ndarray:
    """Return the switching points of the symmetric orbit nearest to an orbit with an even number of
    points.
    """
    half = len(points) // 2
    x, theta = points.T
    mean = x.mean()
    # The mean of each point and of the image of its partner, half a turn of the drive apart.
    difference = x[:half] - x[half:]
    total = theta[:half] + theta[half:]
    first = np.column_stack([mean + difference / 2, (total - pi) / 2])
    second = np.column_stack([mean - difference / 2, (total + pi) / 2])
    return np.vstack([first, second])


def kind_of(condition: Condition) -> str:
    """Return the kind of `Zero` that belongs to a condition whose value is 0.

    "" if none does, as for a duration.
    """
    if condition.rank == admissibility.PASSING or " at the onset of " in condition.text:
        return AT_FAR
    if condition.rank == admissibility.HOLD:
        return AT_HOLD
    if " meets v" in condition.text:
        return AT_ARRIVAL
    if condition.rank == admissibility.STAYS_INSIDE and "stays in" in condition.text:
        return AT_TOUCH
    return ""


def zeros_of(
    equations: ClosingEquations, points: Points, condition: Condition
) -> list[LocatedZero]:
    """Return each `Zero` that a condition near 0 can mean, with the phase of its extremum, if any.

    There are two at a crossing after which the flight turns back at once: that of the force, and
    that of a graze.
    """
    kind = kind_of(condition)
    i = condition.piece
    piece = equations.pieces[i]
    if kind == "":
        return []
    if kind == AT_ARRIVAL:
        return [LocatedZero(Zero(kind, i, piece.mode), [])]
    if kind != AT_FAR:
        closest = sorted(extrema_of(equations, points, i, kind))[:1]
        return [
            LocatedZero(Zero(kind, i, extreme.place), [float(extreme.theta)]) for extreme in closest
        ]
    zeros = [LocatedZero(Zero(AT_FAR, i, piece.mode + piece.side), [])]
    following = (i + 1) % len(points)
    v = equations.belt(piece.end).v
    _, end = equations.ends(points)[i]
    F = condition.value * piece.side
    K = equations.K
    G1, G2, _ = derivatives(v, F, equations.sin(end), equations.cos(end), K)
    if piece.side * G1 < 0 < piece.side * G2 and not equations.pieces[following].sticks:
        # The flight behind the crossing turns back at once: a graze so near that no sample would
        # show it. There the velocity a0 + b0 tau/2 + c0 tau^2/6, times tau, has a double root.
        _, start = points[following]
        phase_of_graze = float(start - 1.5 * G1 / G2 * K.Om)
        zeros.append(LocatedZero(Zero(AT_TOUCH, following, piece.end), [phase_of_graze]))
    return zeros


def names_of(system: BorderSystem, zero: Zero | None = None) -> tuple[str, str]:
    """Return (kind of a branch's end, name in the literature) for what happens at a border, or at
    its given `zero`, which belongs to an inequality (so it is neither FLAT nor BEND).
    """
    zero = zero or system.zeros[0]
    # The motion comes to rest on a belt. (Where it meets no belt a ClosedForm is a TOUCH.)
    if isinstance(system, ClosedForm) and system.rests:
        return admissibility.FLIGHT_VANISHING, ""
    # A cubic tangency: a graze, and a stick that is left at once, begin there.
    if zero.kind == AT_ARRIVAL:
        return admissibility.GRAZING, "adding-sliding and grazing-sliding"
    if zero.kind == AT_HOLD:
        return admissibility.SLIP_BIRTH, "adding-sliding"
    if zero.kind == AT_TOUCH:
        if system.fixed.friction(zero.place):
            return admissibility.GRAZING, "grazing-sliding"
        # A belt without friction is only passed through.
        return admissibility.GRAZING, ""
    # FAR: the force of the far domain is 0 at an onset of a stick, or at a crossing.
    following = system.pieces[(zero.piece + 1) % system.n]
    if following.sticks:
        return admissibility.SLIP_BIRTH, "switching-sliding"
    return admissibility.BIRTH, "crossing-sliding"
