"""The roots of the closing equations with one parameter free: a curve, and its points."""

from __future__ import annotations

import numpy as np

from symosc.errors import ParameterError
from symosc.kernels.entire import EPS
from symosc.orbits.admissibility import conditions, failing
from symosc.orbits.branch import BranchPoint
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.floquet import monodromy, multipliers
from symosc.orbits.guesses import largest_displacement
from symosc.orbits.newton import CONVERGING, solve
from symosc.orbits.periodic_orbit import PeriodicOrbit

LEAST_SIZE = 0.1  # of the largest displacement expected
CORRECTIONS = 12
LARGEST_CORRECTION = 1.0  # in arclength; farther off another root is found
SHARPEST_TURN = 0.9  # cosine of the angle between tangents of neighbouring points
DIFFERENCE = 1e-6  # of the range, for the derivative with respect to the parameter: Newton's method needs no more
REMEMBERED = 32


class Curve:
    """A curve of roots in z = (x/size, phase, parameter/range).

    Arclength measures positions from their mean: a shift of the whole orbit, such as by A0/k, changes nothing else
    and needs no steps. So lengths and angles are those of `level(z)`.
    """

    def __init__(self, orbit: PeriodicOrbit, parameter: str, low: float, high: float) -> None:
        self.orbit, self.parameter, self.low, self.high = orbit, parameter, low, high
        self.word = orbit.equations().word
        self.start, self.value = orbit.phases(), float(getattr(orbit.parameters, parameter))
        n = len(self.start)
        # Switching points may lie close together on an orbit that moves far.
        size = max(np.ptp(self.start[:, 0]), LEAST_SIZE * largest_displacement(orbit.equations())[1])
        # The points together weigh as much as the parameter.
        self.scale = np.append(np.tile([size, 1.0], n) * np.sqrt(n), high - low)
        self._equations: dict[float, ClosingEquations] = {}

    def equations(self, value: float) -> ClosingEquations:
        """Return the closing equations for a value of the parameter."""
        if value not in self._equations:
            while len(self._equations) >= REMEMBERED:
                del self._equations[next(iter(self._equations))]
            parameters = self.orbit.parameters.replace(**{self.parameter: value})
            self._equations[value] = ClosingEquations(parameters, self.word, self.orbit.periods)
        return self._equations[value]

    def linearised(self, z: np.ndarray, slope: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals (2n,) and their Jacobian (2n, 2n + 1) with respect to the scaled unknowns.

        Its last column, by the parameter, is taken from `slope` if that is given.
        """
        points, value = self.split(z)
        equations = self.equations(value)
        values, column = np.array(equations.residuals(points)), self.slope(z) if slope is None else slope
        return values, np.column_stack([equations.matrix(points), column]) * self.scale

    def slope(self, z: np.ndarray) -> np.ndarray:
        """Return the derivative of the residuals with respect to the parameter, by differences."""
        points, value = self.split(z)
        change = DIFFERENCE * (self.high - self.low)
        # One-sided at the ends of the range: there may be no such system beyond.
        above = change if value + change <= self.high else 0.0
        below = change if value - change >= self.low else 0.0
        beside = [np.array(self.equations(value + shift).residuals(points)) for shift in (above, -below)]
        return (beside[0] - beside[1]) / (above + below)

    def split(self, z: np.ndarray) -> tuple[np.ndarray, float]:
        """Return points (n, 2) and parameter from the scaled unknowns."""
        unscaled = z * self.scale
        # An end of the range stays what it is: the product may miss it by an ulp.
        value = float(unscaled[-1])
        for bound in (self.low, self.high):
            if abs(value - bound) <= 4 * EPS * abs(bound):
                value = bound
        return unscaled[:-1].reshape(-1, 2), value

    def joined(self, points: np.ndarray, value: float) -> np.ndarray:
        """Return the scaled unknowns."""
        return np.append(np.ravel(points), value) / self.scale

    def of(self, point: BranchPoint) -> np.ndarray:
        """Return the scaled unknowns of a point."""
        return self.joined(point.points, point.value)

    @staticmethod
    def level(z: np.ndarray) -> np.ndarray:
        """Return z with the positions measured from their mean."""
        found = z.copy()
        found[:-1:2] -= found[:-1:2].mean()
        return found

    def distance(self, a: BranchPoint, b: BranchPoint) -> float:
        """Return the length of the chord between two points."""
        return float(np.linalg.norm(self.level(self.of(b) - self.of(a))))

    def correct(self, guess: np.ndarray, normal: np.ndarray) -> np.ndarray | None:
        """Return the point of the curve in the plane through `guess` with that normal, or None."""
        z, before, row, slope = guess, np.inf, self.level(normal), None
        for _ in range(CORRECTIONS):
            try:
                slope = self.slope(z) if slope is None else slope  # good enough for all steps from a near guess
                values, matrix = self.linearised(z, slope)
                right = np.append(-values, -row @ (z - guess))
                step = np.linalg.solve(np.vstack([matrix, row]), right)
            except (np.linalg.LinAlgError, ParameterError, ZeroDivisionError):
                return None
            size, whole = np.abs(self.level(step)).max(), max(1.0, np.abs(z).max())
            if not np.isfinite(size) or size > LARGEST_CORRECTION:
                return None
            z = z + step
            if size <= 4 * EPS * whole or (size < CONVERGING and size > before / 4):
                return z
            before = size
        return z if size < CONVERGING else None

    def point(self, z: np.ndarray, along: np.ndarray) -> BranchPoint:
        """Return what is known about a point of the curve; its tangent points as `along` does."""
        points, value = self.split(z)
        equations = self.equations(value)
        _, matrix = self.linearised(self.joined(points, value))
        tangent = np.linalg.solve(np.vstack([matrix, self.level(along)]), np.append(np.zeros(len(z) - 1), 1.0))
        flow = monodromy(equations, points)
        both = multipliers(flow.trace, flow.determinant, equations.complex_root)
        margins = tuple(conditions(equations, points))
        return BranchPoint(
            value,
            points,
            tangent / np.linalg.norm(self.level(tangent)),
            float(flow.trace),
            float(flow.determinant),
            (complex(both[0]), complex(both[1])),
            margins,
            tuple(failing(list(margins))),
        )

    def first(self, direction: float) -> BranchPoint:
        """Return the point that the curve was given, its tangent towards larger or smaller values."""
        return self.point(self.joined(self.start, self.value), np.append(np.zeros(len(self.scale) - 1), direction))

    def accepted(self, z: np.ndarray | None, before: BranchPoint) -> BranchPoint | None:
        """Return the point at z, or None if there is no such point or the curve turns too sharply towards it."""
        if z is None:
            return None
        try:
            point = self.point(z, before.tangent)
        except (np.linalg.LinAlgError, ParameterError, ZeroDivisionError):
            return None
        return point if point.tangent @ self.level(before.tangent) > SHARPEST_TURN else None

    def step(self, current: BranchPoint, length: float) -> BranchPoint | None:
        """Return the point at that length along the tangent, or the end of the range if that comes first, or None."""
        ahead = self.of(current) + length * current.tangent
        value = self.split(ahead)[1]
        if self.low < value < self.high:
            point = self.accepted(self.correct(ahead, current.tangent), current)
            if point is None or self.low <= point.value <= self.high:
                return point
            ahead, value = self.of(point), point.value  # the curve bends over the end of the range
        value = self.high if value >= self.high else self.low
        part = (value - current.value) / (ahead[-1] * self.scale[-1] - current.value)
        guess, _ = self.split(self.of(current) + part * (ahead - self.of(current)))
        solution = solve(self.equations(value), guess)
        return self.accepted(self.joined(solution.points, value), current) if solution.converged else None

    def halfway(self, a: BranchPoint, b: BranchPoint) -> np.ndarray:
        """Return where the cubic with the points and tangents of a and b is halfway: off the curve by its bend."""
        return 0.5 * (self.of(a) + self.of(b)) + 0.125 * self.distance(a, b) * (a.tangent - b.tangent)

    def middle(self, a: BranchPoint, b: BranchPoint) -> BranchPoint | None:
        """Return the point of the curve between two points."""
        return self.accepted(self.correct(self.halfway(a, b), self.of(b) - self.of(a)), a)
