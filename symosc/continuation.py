"""Branches of periodic orbits: pseudo-arclength continuation, and why a branch ends.

The closing equations plus one for the arclength are solved by Newton's method from a point on the tangent. No general
package is used: what makes these branches end are inequalities (a graze, the birth of a stick) that a continuation code
for smooth systems does not know, and the smooth part is a Newton method on a small block system that is there already.

The equations stay smooth where an orbit ceases to be one (the root goes on as an inadmissible one). So every reason to
end is a change of sign of a smooth function along the branch, and is located by bisection.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from symosc.admissible import conditions
from symosc.branches import Branch, BranchEnd, BranchError, BranchPoint, times_of
from symosc.closing import CONVERGING, ClosingEquations, newton
from symosc.errors import ParameterError
from symosc.exact import read_exact, show
from symosc.guesses import SETTLING_EVENTS, follow, settled_word
from symosc.kernels.entire import EPS
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits import find_orbit
from symosc.periodic import PeriodicOrbit, SwitchingPoint
from symosc.stability import monodromy, multipliers
from symosc.verification import failures

FOLD, PERIOD_DOUBLING, NEIMARK_SACKER = "fold", "period doubling", "Neimark-Sacker"
MULTIPLIER_MESSAGES = {
    FOLD: "a multiplier is +1",
    PERIOD_DOUBLING: "a multiplier is -1",
    NEIMARK_SACKER: "two complex multipliers have the modulus 1",
}
RANGE, STALLED, MOST = "end of the range", "no convergence", "max_points"

# Steps in the arclength of (x/size, phase, parameter/range).
FIRST_STEP, LONGEST_STEP, SHORTEST_STEP = 0.01, 0.02, 1e-10
CORRECTIONS = 8
VANISHED = 1e-7  # what a margin must have fallen to at an end, as a part of what it was a step before, to count as 0
BEYOND = 1e-3  # of the range: how far behind an end the next word is looked for
SHARPEST_TURN = 0.9  # cosine of the angle between tangents of neighbouring points
RESOLUTION = 1e-12  # of the arclength, to which ends are located; closer by, rounding would decide what has happened
DIFFERENCE = 1e-6  # of the range, for the derivative with respect to the parameter: Newton's method needs no more


def continue_orbit(
    parameters: Parameters,
    word: Any,
    parameter: str,
    range: tuple[Any, Any],
    guess: Any = None,
    *,
    periods: int | None = None,
    max_points: int = 2000,
) -> Branch:
    """Follow a periodic orbit as one parameter changes, both ways, until it ends or leaves the range.

    Parameters
    ----------
    parameters : Parameters
        Where the branch is begun; the parameter's value must lie in the range.
    word : str or sequence of str
        The mapping structure, read right to left.
    parameter : str
        "Omega", "A0", "FN", ...: any name of Parameters.
    range : (low, high)
    guess, periods : optional
        As for `find_orbit`.
    max_points : int
        Of each of the two directions.

    Returns
    -------
    Branch

    Raises
    ------
    WordError, ConvergenceError
        As `find_orbit`.
    ParameterError
        If there is no such parameter, or the range is empty, not allowed or does not contain the parameter's value.
    BranchError
        If the first root is no orbit.
    """
    low, high = _read_range(parameters, parameter, range)
    orbit = find_orbit(parameters, word, guess, periods=periods)
    if not orbit.admissible:
        raise BranchError(orbit)
    curve = Curve(orbit, parameter, low, high)
    (down, first), (up, last) = (_follow(curve, direction, max_points) for direction in (-1.0, 1.0))
    return Branch(orbit, parameter, [*reversed(down[1:]), *up], (first, last))


class Curve:
    """The closing equations with one parameter free: a curve of roots in (x/size, phase, parameter/range)."""

    def __init__(self, orbit: PeriodicOrbit, parameter: str, low: float, high: float) -> None:
        self.orbit, self.parameter, self.low, self.high = orbit, parameter, low, high
        self.word = orbit.equations().word
        self.start, self.value = orbit.phases(), float(getattr(orbit.parameters, parameter))
        n = len(self.start)
        size = max(np.ptp(self.start[:, 0]), 1e-3 * np.abs(self.start[:, 0]).max(), 1e-9)
        # The points together weigh as much as the parameter.
        self.scale = np.append(np.tile([size, 1.0], n) * np.sqrt(n), high - low)

    def equations(self, value: float) -> ClosingEquations:
        """Return the closing equations for a value of the parameter."""
        return ClosingEquations(self.orbit.parameters.replace(**{self.parameter: value}), self.word, self.orbit.periods)

    def linearised(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals (2n,) and their Jacobian (2n, 2n + 1) with respect to the scaled unknowns."""
        points, value = self.split(z)
        equations, change = self.equations(value), DIFFERENCE * (self.high - self.low)
        values = np.array(equations.residuals(points))
        # To one side at the ends of the range: there may be no such system beyond.
        above = change if value + change <= self.high else 0.0
        below = change if value - change >= self.low else 0.0
        sides = [np.array(self.equations(value + shift).residuals(points)) for shift in (above, -below)]
        column = (sides[0] - sides[1]) / (above + below)
        return values, np.column_stack([equations.matrix(points), column]) * self.scale

    def split(self, z: np.ndarray) -> tuple[np.ndarray, float]:
        """Return points (n, 2) and parameter from the scaled unknowns."""
        unscaled = z * self.scale
        return unscaled[:-1].reshape(-1, 2), float(unscaled[-1])

    def joined(self, points: np.ndarray, value: float) -> np.ndarray:
        """Return the scaled unknowns."""
        return np.append(np.ravel(points), value) / self.scale

    def ahead(self, point: BranchPoint, length: float) -> tuple[np.ndarray, float]:
        """Return points and parameter on the tangent."""
        return self.split(self.joined(point.points, point.value) + length * point.tangent)

    def correct(self, guess: np.ndarray, base: np.ndarray, tangent: np.ndarray, length: float) -> np.ndarray | None:
        """Return the point of the curve at arclength `length` from `base` along `tangent`, or None."""
        z, before = guess, np.inf
        for _ in range(CORRECTIONS):
            try:
                values, matrix = self.linearised(z)
                right = np.append(-values, length - tangent @ (z - base))
                step = np.linalg.solve(np.vstack([matrix, tangent]), right)
            except (np.linalg.LinAlgError, ParameterError):
                return None
            size = np.abs(step).max()
            if not np.isfinite(size) or size > 1:
                return None
            z = z + step
            if size <= 4 * EPS or (size < CONVERGING and size > before / 4):
                return z
            before = size
        return z if size < CONVERGING else None

    def point(self, z: np.ndarray, along: np.ndarray) -> BranchPoint:
        """Return what is known about a point of the curve; its tangent points as `along` does."""
        points, value = self.split(z)
        equations = self.equations(value)
        _, matrix = self.linearised(z)
        tangent = np.linalg.solve(np.vstack([matrix, along]), np.append(np.zeros(len(z) - 1), 1.0))
        flow = monodromy(equations, points)
        both = multipliers(flow.trace, flow.determinant, equations.complex_root)
        return BranchPoint(
            value,
            points,
            tangent / np.linalg.norm(tangent),
            float(flow.trace),
            float(flow.determinant),
            (complex(both[0]), complex(both[1])),
            tuple(conditions(equations, points)),
            tuple(failures(equations, points)),
        )


def _follow(curve: Curve, direction: float, most: int) -> tuple[list[BranchPoint], BranchEnd]:
    """Follow the curve one way; return its points and why they end."""
    along = np.append(np.zeros(len(curve.scale) - 1), direction)
    current = curve.point(curve.joined(curve.start, curve.value), along)
    path, length = [current], FIRST_STEP
    if current.value == (curve.high if direction > 0 else curve.low):
        return path, _end_of_range(curve, current)
    while len(path) < most:
        ahead = curve.ahead(current, length)
        if not curve.low < ahead[1] < curve.high:
            last = _at_bound(curve, current, *ahead)
            if last is not None and not _changes(current, last):
                return [*path, last], _end_of_range(curve, last)
        following = _step(curve, current, length)
        if following is None:
            length /= 2
            if length < SHORTEST_STEP:
                return path, _stalled(curve, current)
            continue
        if _changes(current, following):
            following = _locate(curve, current, following, length)
            return [*path, following], _end(curve, current, following)
        path.append(following)
        current, length = following, min(1.5 * length, LONGEST_STEP)
    return path, BranchEnd(MOST, current.value, f"stopped after {most} points", _named(curve, current), ())


def _end_of_range(curve: Curve, point: BranchPoint) -> BranchEnd:
    return BranchEnd(RANGE, point.value, "the orbit goes on", _named(curve, point), ())


def _step(curve: Curve, current: BranchPoint, length: float) -> BranchPoint | None:
    base = curve.joined(current.points, current.value)
    z = curve.correct(base + length * current.tangent, base, current.tangent, length)
    return None if z is None else _accepted(curve, z, current)


def _at_bound(curve: Curve, current: BranchPoint, points: np.ndarray, value: float) -> BranchPoint | None:
    """Return the point at the end of the range that a step to `points` and `value` goes past, or None."""
    value = curve.high if value >= curve.high else curve.low
    solution = newton(curve.equations(value), points)
    return _accepted(curve, curve.joined(solution.points, value), current) if solution.converged else None


def _accepted(curve: Curve, z: np.ndarray, before: BranchPoint) -> BranchPoint | None:
    try:
        point = curve.point(z, before.tangent)
    except (np.linalg.LinAlgError, ParameterError):
        return None
    return point if point.tangent @ before.tangent > SHARPEST_TURN else None


def _changes(a: BranchPoint, b: BranchPoint) -> list[str]:
    """Return what happens between a point and one behind it, what explains the rest first; empty if nothing does."""
    found = [condition.event for condition in b.failures]
    plus, minus, one = zip(_multiplier_tests(a), _multiplier_tests(b), strict=True)
    if (a.tangent[-1] > 0) != (b.tangent[-1] > 0) or (plus[0] > 0) != (plus[1] > 0):
        found.append(FOLD)
    if (minus[0] > 0) != (minus[1] > 0):
        found.append(PERIOD_DOUBLING)
    if (one[0] > 0) != (one[1] > 0) and abs(b.trace) < 2:
        found.append(NEIMARK_SACKER)
    return found


def _multiplier_tests(point: BranchPoint) -> tuple[float, float, float]:
    """Return what vanishes where a multiplier is +1, where one is -1, and where their product is 1."""
    trace, determinant = point.trace, point.determinant
    return 1 - trace + determinant, 1 + trace + determinant, 1 - determinant


def _locate(curve: Curve, a: BranchPoint, b: BranchPoint, length: float) -> BranchPoint:
    """Return the first point behind `a` where something has happened; bisects the arclength."""
    base, far = curve.joined(a.points, a.value), curve.joined(b.points, b.value)
    low, high, near, found = 0.0, 1.0, base, b
    while (high - low) * length > RESOLUTION:
        middle = 0.5 * (low + high)
        guess = near + (far - near) * (middle - low) / (high - low)
        z = curve.correct(guess, base, a.tangent, middle * length)
        point = None if z is None else _accepted(curve, z, a)
        if z is None or point is None:
            break
        if _changes(a, point):
            high, far, found = middle, z, point
        else:
            low, near = middle, z
    return found


def _end(curve: Curve, before: BranchPoint, point: BranchPoint) -> BranchEnd:
    """Return why the branch ends at `point`: what fails there, and what is as good as 0 next to the point before."""
    pairs = zip(before.conditions, point.conditions, strict=True)
    zero = [now for was, now in pairs if now.value < VANISHED * min(was.value, 1e300)]
    zero = sorted(zero, key=lambda condition: condition.rank) or list(point.failures)
    kind = zero[0].event if point.failures else _changes(before, point)[0]
    reasons = tuple(condition for condition in zero if condition.event == kind)
    message = MULTIPLIER_MESSAGES.get(kind, "")
    if kind not in MULTIPLIER_MESSAGES:
        message = "; ".join(f"{c.text} no longer holds at t = {c.t:.10g}" for c in reasons)
    return BranchEnd(kind, point.value, message, _named(curve, point), reasons, _beyond(curve, point))


def _beyond(curve: Curve, point: BranchPoint) -> str | None:
    """Return the word that the motion settles to a little further on."""
    direction = 1 if point.value > curve.value else -1
    try:
        equations = curve.equations(point.value + direction * BEYOND * (curve.high - curve.low))
    except ParameterError:
        return None
    x, theta = (float(value) for value in point.points[0])
    found = settled_word(equations, follow(equations, x, theta % (2 * pi), equations.pieces[0].start, SETTLING_EVENTS))
    return None if found is None else str(found)


def _stalled(curve: Curve, point: BranchPoint) -> BranchEnd:
    nearest = min(point.conditions, key=lambda condition: condition.value)
    message = f"the steps became too short; nearest to failing: {nearest.text} (by {nearest.value:.3g})"
    return BranchEnd(STALLED, point.value, message, _named(curve, point), (nearest,))


def _named(curve: Curve, point: BranchPoint) -> tuple[SwitchingPoint, ...]:
    times = times_of(curve.orbit.parameters, curve.parameter, point)
    return tuple(SwitchingPoint(float(t), float(x)) for t, x in times)


def _read_range(parameters: Parameters, parameter: str, limits: Any) -> tuple[float, float]:
    if parameter not in PARAMETER_NAMES:
        raise ParameterError("parameter", parameter, f"must be one of {', '.join(PARAMETER_NAMES)}")
    try:
        low, high = limits
    except (TypeError, ValueError):
        raise ParameterError("range", limits, "must be a pair (low, high)") from None
    low, high = read_exact("range", low), read_exact("range", high)
    value = getattr(parameters, parameter)
    if not low < high or not low <= value <= high:
        allowed = f"must be low < high, with the value {parameter} = {show(value)} in between"
        raise ParameterError("range", f"{show(low)}:{show(high)}", allowed)
    for limit in (low, high):
        parameters.replace(**{parameter: limit})
    return float(low), float(high)
