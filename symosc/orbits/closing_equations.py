"""The closing equations of a periodic orbit, with all switching points as unknowns.

An orbit with the word "P32" is n = 2 mappings in order of time, P2 then P3. The unknowns are its
switching points (x_0, theta_0), ..., (x_(n-1), theta_(n-1)), phases not wrapped; the equations are
f1 = f2 = 0 (eq. (54)) of each mapping from point i to point i + 1, the last one back to (x_0,
theta_0 + 2 pi N) after N periods of the excitation. The Jacobian is block-cyclic: mapping i has one
2x2 block for its start and one for its end. As all points are unknown, errors do not grow along the
orbit as they would with shooting from one point, and every equation belongs to one piece.

The residuals are those of `symosc.mappings.equations`, continued to where there are no mappings any
more. So a branch of orbits is smooth up to its end and beyond. Sticks may have a negative duration.
A flight after a stick starts with no acceleration, as the stick's equation says already. Where tau
= 0 is a root of f2 it is divided out: Newton's method does not fall for it, and a slip may vanish
without the system becoming singular.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Number, Point, Points
from symosc.base.errors import SymoscError
from symosc.engine.arithmetic import Arithmetic, MpArithmetic
from symosc.engine.flow import BeltConstants, belt_at
from symosc.engine.state import ON_BELT, Launch
from symosc.kernels import _generated as kernels
from symosc.kernels import elementary
from symosc.kernels.entire import EPS
from symosc.kernels.linear import Factors, Shortest, factors
from symosc.model import Parameters
from symosc.words import Word

MOST_NEWTON_STEPS = 60
LEAST_DAMPING = 2.0**-16
MOST_POLISHING = 80
# A step takes at most this part of a flight's duration away: it must not shrink to its trivial root
# tau = 0.
MOST_SHORTENING = 0.8
# Below this size of a (relative) correction Newton's method is taken to converge; it then goes on
# to the last digit.
CONVERGING = 1e-8
# Newton's steps are rounding, and over, where they are as small as this (in EPS), or where they are
# CONVERGING but do not shrink any more by this factor.
LAST_STEP = 4
NO_PROGRESS = 4
# Positions are measured by the extent of an orbit and by how far out it is, but by no less than this.
LEAST_SCALE = 1e-3
# Without damping, directions that the equations fix by less than this are left alone.
LEAST_STRETCH = 1e-9
# Where doubles stop at a residual below this, it is solved with so many digits.
STOPPED_BY_ROUNDING = 1e-9
FINER_DIGITS = 40
# With many digits: corrections that shrink by less than the first factor converge linearly, as at a
# multiple root, if they do so more than so many times in a row.
LINEAR = 16
MOST_LINEAR = 16
SINGULAR = "the Jacobian became singular"


class ConvergenceError(SymoscError, ArithmeticError):
    """Raised if Newton's method for a periodic orbit does not converge.

    Attributes
    ----------
    word : str
    best : tuple of (t, x)
        The best switching points that were found.
    periods : int
        The number of forcing periods after which the points should close.
    residual : float
        Largest |f1|, |f2| of eq. (54) at the points `best`.

    Examples
    --------
    >>> from symosc import ConvergenceError, find_orbit, load_scene
    >>> try:
    ...     find_orbit(load_scene("fig6").parameters, "P654")
    ... except ConvergenceError as error:
    ...     print(error.word, error.residual > 1)
    P654 True
    """

    def __init__(
        self, word: str, best: tuple[object, ...], periods: int, residual: float, reason: str
    ) -> None:
        self.word = word
        self.best = best
        self.periods = periods
        self.residual = residual
        self.reason = reason
        if residual < inf:
            about = f" (smallest residual {residual:.1e})"
        else:
            about = ""
        super().__init__(f"no periodic orbit{' ' * bool(word)}{word} was found: {reason}{about}")


@dataclass(frozen=True)
class OrbitPiece:
    """A piece of an orbit, one mapping of its word: belts of start and end, mode, and the side to
    which it goes on at its end: 1 up, -1 down.
    """

    label: str
    start: int
    end: int
    mode: int
    side: int
    after_stick: bool

    @property
    def sticks(self) -> bool:
        """Whether the mass sticks to a belt during the piece."""
        return self.mode > ON_BELT

    def roots(self, boundary: int) -> int:
        """Return the order of v - v_boundary = 0 at a flight's start: 1 on this belt, 2 there after
        a stick, else 0.
        """
        if self.sticks or boundary != self.start:
            return 0
        if self.after_stick:
            return 2
        return 1

    @property
    def zeros(self) -> int:
        """The multiplicity of the root tau = 0 of f2 of eq. (54), by which `residuals` divides f2."""
        return self.roots(self.end)


def pieces_of(word: Word) -> tuple[OrbitPiece, ...]:
    """Return the pieces of a periodic orbit that has this word."""
    pieces = []
    for i, (row, exit) in enumerate(zip(word.maps, word.exits(), strict=True)):
        if row.sticks:
            goes_up = exit == "above"
        else:
            goes_up = row.end.superscript == 1  # it meets its belt from below
        if goes_up:
            side = 1
        else:
            side = -1
        ends = row.start.boundary, row.end.boundary
        pieces.append(OrbitPiece(row.label, *ends, row.mode, side, word.maps[i - 1].sticks))
    return tuple(pieces)


class Span(NamedTuple):
    """A piece between two points: start and end (x, theta), phases not wrapped, and duration `tau`."""

    piece: OrbitPiece
    start: Point
    end: Point
    tau: Number


class Orbit(NamedTuple):
    """An orbit, given by its word, its number of forcing periods, and its points (x, theta), an (n,
    2) array.
    """

    word: Word
    periods: int
    points: np.ndarray

    @property
    def cycle(self) -> str:
        """The word as text, the same text for all its rotations."""
        return str(self.word.cycle)


class ClosingEquations:
    """The closing equations of an orbit: of one word, number of periods and parameter set, in one
    arithmetic.
    """

    def __init__(
        self,
        parameters: Parameters,
        word: Word,
        periods: int,
        digits: int | None = None,
        arithmetic: Any = None,
    ) -> None:
        self.parameters = parameters
        self.word = word
        self.periods = periods
        self.pieces = pieces_of(word)
        self.arithmetic = arithmetic or (
            Arithmetic(parameters) if digits is None else MpArithmetic(parameters, digits)
        )
        self.K = self.arithmetic.K
        self.basis = self.arithmetic.namespace["basis"]
        self.context: Any = getattr(self.arithmetic, "context", None)  # of mpmath; None: doubles
        if self.context:
            self.number: Any = self.context.convert
        else:
            self.number = float
        # The C library's functions would have other last bits on other machines.
        functions: Any = self.context or elementary
        self.sin = functions.sin
        self.cos = functions.cos
        self.exp = functions.exp
        self.turn = 2 * (self.context.pi if self.context else pi) * periods

    @cached_property
    def coarse(self) -> ClosingEquations:
        """The same equations in double precision."""
        if self.context is None:
            return self
        return ClosingEquations(self.parameters, self.word, self.periods)

    def with_digits(self, digits: int) -> ClosingEquations:
        """Return the same equations with that many digits."""
        return ClosingEquations(self.parameters, self.word, self.periods, digits)

    def ends(self, points: Points) -> list[Point]:
        """Return the end (x, theta) of each piece: the next of `points`; for the last, the first
        one a period later.
        """
        x, theta = points[0]
        return [*points[1:], (x, theta + self.turn)]

    def spans(self, points: Points) -> list[Span]:
        """Return every piece with its start, its end and its duration."""
        spans = []
        for piece, start, end in zip(self.pieces, points, self.ends(points), strict=True):
            _, theta = start
            _, end_theta = end
            spans.append(Span(piece, start, end, (end_theta - theta) / self.K.Om))
        return spans

    def residuals(self, points: Points) -> list[Number]:
        """Return f1 and f2 of eq. (54) for each piece; f2 is divided by tau^n where tau = 0 is an
        n-fold root of it.
        """
        values = []
        for span in self.spans(points):
            f1, f2 = self._residual(span)
            values += [f1, f2 / span.tau**span.piece.zeros]
        return values

    def largest_residual(self, points: Points) -> Number:
        """Return the largest |f1|, |f2| of eq. (54)."""
        return max(abs(value) for span in self.spans(points) for value in self._residual(span))

    def force(self, domain: int, x: Number, v: Number, theta: Number) -> Number:
        """Return F^(domain) of eq. (9), which is the acceleration in this domain."""
        K = self.K
        A = (K.A1, K.A2, K.A3)[domain - 1]
        return kernels.acceleration(x, v, self.cos(theta), A, K.cm, K.w0sq, K.f0)

    def belt(self, boundary: int) -> BeltConstants:
        """Return the constants of a belt, such as its speed, in this arithmetic."""
        return belt_at(boundary, self.K)

    def start_of_flight(self, piece: OrbitPiece, start: Point) -> Launch:
        """Return what a flight begins with at `start`: velocity, acceleration, sine and cosine of
        the phase.
        """
        x, theta = start
        v = self.belt(piece.start).v
        if piece.after_stick:
            a = 0 * x  # a 0 in the arithmetic of x
        else:
            a = self.force(piece.mode, x, v, theta)
        return Launch(v, a, self.sin(theta), self.cos(theta))

    def _residual(self, span: Span) -> tuple[Number, Number]:
        """Return f1 and f2 of eq. (54) for one piece, without the division of f2 by tau^n as in
        `residuals`.
        """
        v_end = self.belt(span.piece.end).v
        K = self.K
        (piece, start, end, tau) = span
        x, _ = start
        x_end, theta_end = end
        if piece.sticks:
            # of the domain that it leaves to: belt n has domain n below, n + 1 above
            A = (K.A1, K.A2, K.A3)[piece.start - (piece.side < 0)]
            cosine = self.cos(theta_end)
            return kernels.stick_residual(x, v_end, tau, x_end, cosine, A, K.cm, K.w0sq, K.f0)
        v, a, s, c = self.start_of_flight(piece, start)
        basis = self.basis(tau, K)[:5]
        return kernels.flight_residual(
            x, v, a, s, c, x_end, v_end, K.cm, K.w0sq, K.f0, K.Om, *basis
        )

    def _jacobian(self, span: Span) -> Any:
        """Return the 2x4 Jacobian of f1 and f2, as in `residuals`, by x and theta of the piece's
        start and end.
        """
        # Below x_th1 is the derivative of f1 by theta at the end (1), v_x0 that of f2 by x at the
        # start (0).
        (piece, start, end, tau) = span
        K = self.K
        if piece.sticks:
            v = self.belt(piece.start).v
            _, theta_end = end
            s = self.sin(theta_end)
            x_th0, x_th1, v_x1, v_th1 = kernels.stick_jacobian(v, s, K.w0sq, K.f0, K.Om)
            return (1, x_th0, -1, x_th1), (0, 0, v_x1, v_th1)
        v, a, s, c = self.start_of_flight(piece, start)
        E0, E1, E2, R2, I2 = self.basis(tau, K)[:5]
        _, dv, a_end = kernels.motion(v, a, s, c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = kernels.flight_jacobian(
            v, a, v + dv, a_end, K.w0sq, K.Om, E0, E1, E2
        )
        if piece.after_stick:
            # The acceleration at the start is 0 whatever x and theta are: what its derivatives
            # (-w0sq by x, -f0 sin theta by theta) contribute is taken away.
            x_x0 = x_x0 + K.w0sq * E2
            x_th0 = x_th0 + K.f0 * s * E2
            v_x0 = v_x0 + K.w0sq * E1
            v_th0 = v_th0 + K.f0 * s * E1
        if piece.zeros:  # f2/tau^zeros: the quotient rule, with dv for f2
            power = tau**piece.zeros
            shift = piece.zeros * dv / (tau * K.Om)
            v_x0 = v_x0 / power
            v_th0 = (v_th0 + shift) / power
            v_th1 = (v_th1 - shift) / power
        return (x_x0, x_th0, -1, x_th1), (v_x0, v_th0, 0, v_th1)

    def matrix(self, points: Points) -> Any:
        """Return the block-cyclic Jacobian of `residuals` by all x and theta: a (2n, 2n) array or
        an mpmath matrix.
        """
        size = 2 * len(self.pieces)
        if self.context:
            matrix = self.context.zeros(size)
        else:
            matrix = np.zeros((size, size))
        for i, span in enumerate(self.spans(points)):
            for row, values in enumerate(self._jacobian(span)):
                for column, value in enumerate(values):
                    matrix[2 * i + row, (2 * i + column) % size] += value
        return matrix

    def durations(self, points: np.ndarray) -> np.ndarray:
        """Return the duration of every piece as a phase: Omega times the time."""
        theta = points[:, 1]
        return np.append(theta[1:], theta[0] + float(self.turn)) - theta


# -- Newton's methods ------------------------------------------------------------------------------


@dataclass
class Solution:
    """The result of Newton's method: points (n, 2) of (x, theta), largest |residual|, steps, and
    stop reason.
    """

    points: Any
    residual: Number
    steps: int
    converged: bool
    reason: str


def newton(equations: ClosingEquations, guess: np.ndarray) -> Solution:
    """Solve the closing equations by Newton's method, damped by the natural monotonicity test."""
    # A step is accepted if the next simplified correction is shorter than the step (Deuflhard,
    # Newton Methods for Nonlinear Problems, 2004, section 3.3). That does not depend on how the
    # equations are scaled: f1 is a length, f2 a velocity or, at the end of a stick, an
    # acceleration.
    points = np.array(guess, dtype=float)
    x, _ = points.T
    scale = np.array([max(np.ptp(x), np.abs(x).max(), LEAST_SCALE), 1.0])  # of x and of theta
    values = np.array(equations.residuals(points), dtype=float)
    best_points = points
    best_residual = np.abs(values).max()

    def failed(steps: int, reason: str) -> Solution:
        return Solution(best_points, best_residual, steps, False, reason)

    size_before = np.inf
    damping = 1.0
    for steps in range(1, MOST_NEWTON_STEPS + 1):
        # `system.solve` is used again for the simplified corrections, with the same matrix.
        try:
            system = _linear_system(equations, points)
            step = system.solve(-values).reshape(-1, 2)
        except (ZeroDivisionError, OverflowError, ValueError):
            return failed(steps, SINGULAR)
        size = np.abs(step / scale).max()
        if not np.isfinite(size):
            return failed(steps, "the equations overflowed")
        is_rounding = size < CONVERGING and size > size_before / NO_PROGRESS
        if size <= LAST_STEP * EPS or is_rounding:
            return Solution(points, equations.largest_residual(points), steps, True, "")
        size_before = size
        # At most four times as long a part of the step as the last one.
        damping = min(1.0, 4.0 * damping, _largest_part(equations, points, step))
        while True:
            trial = points + damping * step
            values = np.array(equations.residuals(trial), dtype=float)
            after = np.abs(system.solve(values).reshape(-1, 2) / scale).max()
            # Shorter in any case, by the more the larger the part of the step is.
            is_shorter = after <= (1 - damping / 4) * size
            is_converging = size < CONVERGING and damping == 1.0
            if is_shorter or is_converging:
                break
            damping /= 2
            if damping < LEAST_DAMPING:
                return failed(steps, "no step brings it nearer to a solution")
        points = trial
        residual = np.abs(values).max()
        if residual < best_residual:
            best_points = points
            best_residual = residual
    return failed(MOST_NEWTON_STEPS, f"not converged after {MOST_NEWTON_STEPS} steps")


def _linear_system(equations: ClosingEquations, points: Points) -> Factors | Shortest:
    """Return the linear system of Newton's method at `points`; for c = 0, where it may be singular,
    its `solve` returns the shortest step.
    """
    matrix = equations.matrix(points)
    if equations.K.cm == 0:
        return Shortest(matrix, LEAST_STRETCH)
    return factors(matrix)


def solve(equations: ClosingEquations, guess: np.ndarray) -> Solution:
    """Solve the closing equations by Newton's method in doubles.

    Repeat it with FINER_DIGITS digits if rounding stops it.
    """
    # Near the birth of a short piece its duration has few digits in doubles, and steps that small
    # are all noise.
    with np.errstate(all="ignore"):
        solution = newton(equations, guess)
    # Only a small residual (nan is none) says that it is rounding which stops it.
    if solution.converged or not solution.residual <= STOPPED_BY_ROUNDING:
        return solution
    try:
        finer = polish(equations.with_digits(FINER_DIGITS), solution.points)
    except (ZeroDivisionError, ValueError):
        return solution
    if not finer.converged:
        return solution
    points = np.array([[float(value) for value in point] for point in finer.points])
    return Solution(
        points, equations.largest_residual(points), solution.steps + finer.steps, True, ""
    )


def _largest_part(equations: ClosingEquations, points: np.ndarray, step: np.ndarray) -> float:
    """Return the largest fraction of a Newton step that takes no more than the part MOST_SHORTENING
    off any flight.
    """
    # A stick may shrink to nothing and beyond: its equations have roots of negative duration, which
    # are inadmissible.
    durations = equations.durations(points)
    _, phase_step = step.T
    changes = np.append(phase_step[1:], phase_step[0]) - phase_step
    shrinking = np.array([not piece.sticks for piece in equations.pieces]) & (changes < 0)
    return float((MOST_SHORTENING * durations[shrinking] / -changes[shrinking]).min(initial=1.0))


def polish(equations: ClosingEquations, points: Points) -> Solution:
    """Refine a solution in the arithmetic of `equations` (mpmath) by plain Newton steps."""
    # Converged means that the last correction is as small as the digits allow. Where the Jacobian
    # is singular the corrections shrink by a constant factor only: they stop at about the root of
    # that, or the matrix cannot be inverted.
    context = equations.context
    points = [tuple(context.convert(value) for value in point) for point in points]
    last_size = context.inf
    linear_steps = 0
    for steps in range(1, MOST_POLISHING + 1):
        values = equations.residuals(points)
        largest = max(map(abs, values))
        try:
            step = context.lu_solve(
                equations.matrix(points), context.matrix([-value for value in values])
            )
        except ZeroDivisionError:
            return Solution(points, largest, steps, False, SINGULAR)
        size = max(abs(value) for value in step)
        largest_value = max(1, max(abs(value) for point in points for value in point))
        if not context.isfinite(size) or size > largest_value:
            return Solution(points, largest, steps, False, "the corrections grow in more digits")
        points = [(x + step[2 * i], theta + step[2 * i + 1]) for i, (x, theta) in enumerate(points)]
        is_rounding = size >= last_size / NO_PROGRESS and size < context.eps**0.8 * largest_value
        if size <= 16 * context.eps * largest_value or is_rounding:
            return Solution(points, equations.largest_residual(points), steps, True, "")
        if size > last_size / LINEAR:
            linear_steps = linear_steps + 1
        else:
            linear_steps = 0
        if linear_steps > MOST_LINEAR:
            return Solution(points, largest, steps, False, "a multiple root")
        last_size = size
    return Solution(points, largest, MOST_POLISHING, False, "not converged in more digits")
