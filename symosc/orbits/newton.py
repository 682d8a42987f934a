"""Newton's methods for the closing equations: damped in doubles, plain in more digits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symosc.aliases import Number, Points
from symosc.kernels.entire import EPS
from symosc.orbits.closing_equations import ClosingEquations

MOST_NEWTON_STEPS = 60
MOST_POLISHING = 80
# So many corrections in a row that shrink by a constant factor only are a sign of a multiple root.
MOST_LINEAR = 16
# Corrections in more digits that stop shrinking have converged if they are below this power of the arithmetic's unit.
POLISHED = 0.8
LEAST_DAMPING = 2.0**-16
# A step may take at most this part of a piece's duration away: a flight must not shrink to its trivial root tau = 0.
SHORTEN = 0.8
# Below this size of a (relative) correction Newton's method is taken to converge; it then goes on to the last digit.
CONVERGING = 1e-8
# Without damping, directions that the equations fix by less than this are left alone.
SAME_ROW = 1e-9
# A residual below this may be rounding errors: Newton's method then goes on with more digits.
ROUNDED, MORE_DIGITS = 1e-9, 40
SINGULAR = "the Jacobian became singular"


@dataclass
class Solution:
    """What Newton's method ended with: points (n, 2) of (x, theta), largest |residual|, steps, and why it stopped."""

    points: Any
    residual: Number
    steps: int
    converged: bool
    reason: str


def newton(equations: ClosingEquations, guess: np.ndarray) -> Solution:
    """Solve the closing equations by Newton's method, damped by the natural monotonicity test.

    A step is accepted if the next simplified correction is shorter than the step (Deuflhard, Newton Methods for
    Nonlinear Problems, 2004, section 3.3). That does not depend on how the equations are scaled: f1 is a length, f2 a
    velocity or, at the end of a stick, an acceleration.

    Parameters
    ----------
    equations : ClosingEquations
        In double precision.
    guess : (n, 2) array of (x, theta)
        Phases must increase, and end less than N periods after the first.
    """
    points = np.array(guess, dtype=float)
    scale = np.array([max(np.ptp(points[:, 0]), np.abs(points[:, 0]).max(), 1e-3), 1.0])
    values = np.array(equations.residuals(points), dtype=float)
    best, size_before, damping = (np.abs(values).max(), points), np.inf, 1.0
    for steps in range(1, MOST_NEWTON_STEPS + 1):
        matrix = equations.matrix(points)
        try:
            step = _step(equations, matrix, -values)
        except np.linalg.LinAlgError:
            return Solution(best[1], best[0], steps, False, SINGULAR)
        size = np.abs(step / scale).max()
        if not np.isfinite(size):
            return Solution(best[1], best[0], steps, False, "the equations overflowed")
        if size <= 4 * EPS or (size < CONVERGING and size > size_before / 4):
            return Solution(points, equations.largest_residual(points), steps, True, "")
        size_before = size
        damping = min(1.0, 4.0 * damping, _longest(equations, points, step))
        while True:
            trial = points + damping * step
            values = np.array(equations.residuals(trial), dtype=float)
            after = np.abs(_step(equations, matrix, values) / scale).max()
            if after <= (1 - damping / 4) * size or (size < CONVERGING and damping == 1.0):
                break
            damping /= 2
            if damping < LEAST_DAMPING:
                return Solution(best[1], best[0], steps, False, "no step brings it nearer to a solution")
        points = trial
        best = min(best, (np.abs(values).max(), points), key=lambda pair: pair[0])
    return Solution(best[1], best[0], MOST_NEWTON_STEPS, False, f"not converged after {MOST_NEWTON_STEPS} steps")


def _step(equations: ClosingEquations, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the correction; without damping roots may be many, and the nearest one is wanted."""
    if equations.K.cm == 0:
        return np.linalg.lstsq(matrix, right, rcond=SAME_ROW)[0].reshape(-1, 2)
    return np.linalg.solve(matrix, right).reshape(-1, 2)


def solve(equations: ClosingEquations, guess: np.ndarray) -> Solution:
    """Solve the closing equations in double precision; where rounding errors stop Newton's method, with more digits.

    Near the birth of a short piece its duration has few digits in doubles, and steps that small are all noise.
    """
    with np.errstate(all="ignore"):
        solution = newton(equations, guess)
    if solution.converged or not np.isfinite(solution.residual) or solution.residual > ROUNDED:
        return solution
    try:
        finer = polish(equations.with_digits(MORE_DIGITS), solution.points)
    except (ZeroDivisionError, ValueError):
        return solution
    if not finer.converged:
        return solution
    points = np.array([[float(value) for value in point] for point in finer.points])
    return Solution(points, equations.largest_residual(points), solution.steps + finer.steps, True, "")


def _longest(equations: ClosingEquations, points: np.ndarray, step: np.ndarray) -> float:
    """Return the part of a step after which every flight has kept 1 - SHORTEN of its duration.

    A stick may shrink to nothing and beyond: its equations have roots of negative duration, which are inadmissible.
    """
    durations = equations.durations(points)
    changes = np.append(step[1:, 1], step[0, 1]) - step[:, 1]
    flights = np.array([not piece.sticks for piece in equations.pieces])
    shrinking = flights & (changes < 0)
    if not shrinking.any():
        return 1.0
    return float(min(1.0, (SHORTEN * durations[shrinking] / -changes[shrinking]).min()))


def polish(equations: ClosingEquations, points: Points) -> Solution:
    """Refine a solution in the arithmetic of `equations` (mpmath) by plain Newton steps.

    Converged means that the last correction is as small as the digits allow. Where the Jacobian is singular the
    corrections shrink by a constant factor only: they stop at about the root of that, or the matrix cannot be inverted.
    """
    context = equations.arithmetic.context  # type: ignore[attr-defined]
    points = [tuple(context.convert(value) for value in point) for point in points]
    n, last, linear = len(points), context.inf, 0
    for steps in range(1, MOST_POLISHING + 1):
        values = equations.residuals(points)
        matrix = context.zeros(2 * n)
        for i, block in enumerate(equations.blocks(points)):
            for row in range(2):
                for column in range(4):
                    matrix[2 * i + row, (2 * i + column) % (2 * n)] += block[row][column]
        try:
            step = context.lu_solve(matrix, context.matrix([-value for value in values]))
        except ZeroDivisionError:
            return Solution(points, max(map(abs, values)), steps, False, SINGULAR)
        size = max(abs(value) for value in step)
        settled = max(1, max(abs(value) for point in points for value in point))
        if not context.isfinite(size) or size > settled:
            return Solution(points, max(map(abs, values)), steps, False, "the corrections grow in more digits")
        points = [(x + step[2 * i], theta + step[2 * i + 1]) for i, (x, theta) in enumerate(points)]
        if size <= 16 * context.eps * settled or (size >= last / 4 and size < context.eps**POLISHED * settled):
            return Solution(points, equations.largest_residual(points), steps, True, "")
        linear = linear + 1 if size > last / 16 else 0
        if linear > MOST_LINEAR:
            return Solution(points, max(map(abs, values)), steps, False, "a multiple root")
        last = size
    return Solution(points, max(map(abs, values)), MOST_POLISHING, False, "not converged in more digits")
