"""The curve of roots of the closing equations as one parameter varies.

That nothing fails between two points of a branch: every margin is bounded there, not only compared at its ends.

A flight of duration tau stays in its domain exactly if tau > 0 and, for each boundary of the domain,

    q(u) = +-(v - v_lambda)/(time^j (1 - u)^e) > 0 on the whole of [0, 1].

Here time counts from its start, and u = time/tau. The known roots at its start are j (0 off the boundary, 1 on it, 2
after a stick), those at its end e. A stick has F/((1 - u) tau) for the force that ends it, and for the other force its
distance from 0. These functions are smooth in u and along the branch, ends included: q(0) and q(1) are accelerations.
All other conditions are smooth numbers.

Three points of the branch and two on its cubic between them cut a piece of it into four. Take a cell with the margins
f0, f1 > 0 at its ends, and C = h^2 max|f''|/2. At the part r of the cell the margin is at least (1 - r) f0 + r f1 - C r
(1 - r). That is positive for all r in [0, 1] if and only if

    sqrt(f0) + sqrt(f1) > sqrt(C).

h^2 f'' is taken from the second differences of the five values, times MARGIN_SAFETY. The bound holds as long as a
margin's second derivative is nowhere larger than MARGIN_SAFETY times its largest value at the inner points (for the
functions of u, also at the neighbouring u). Where it does not suffice the piece is halved. It is a bound in this sense,
not in the sense of interval arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from symosc.aliases import Point, Points
from symosc.engine.flow import derivatives
from symosc.errors import ParameterError
from symosc.kernels._generated import motion
from symosc.kernels.entire import EPS
from symosc.kernels.entire_array import basis
from symosc.orbits.admissibility import SAMPLE, Condition, conditions, failing, failures
from symosc.orbits.closing_equations import CONVERGING, ClosingEquations, OrbitPiece, solve
from symosc.orbits.find import (
    SETTLING_EVENTS,
    Passage,
    follow,
    largest_displacement,
    mappings_between,
    resting_text,
    rotated,
    settled_word,
    windows,
)
from symosc.orbits.floquet import monodromy
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.words import Word, WordError, read_word

LEAST_SIZE = 0.1  # of the largest displacement expected
SHARPEST_TURN = 0.9  # cosine of the angle between tangents of neighbouring points
DIFFERENCE = 1e-6  # of the range, for the derivative with respect to the parameter: Newton's method needs no more


MARGIN_SAFETY = 4.0
LEAST_PARTS, MOST_PARTS, REFINED = 12, 800, 8
Node = tuple[ClosingEquations, np.ndarray]


# How far beyond an end the words are looked for, as parts of the range: the nearest that is found counts.
DISTANCES = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5)
MOST_WORDS, MOST_GUESSES = 6, 4
LONGEST_WORD = 24  # mappings of a word that is tried


@dataclass(frozen=True)
class BranchPoint:
    """A point of a branch: parameter value, switching points (x, theta), multipliers, margins."""

    value: float
    points: np.ndarray
    tangent: np.ndarray
    multipliers: tuple[complex, complex]
    conditions: tuple[Condition, ...]
    failures: tuple[Condition, ...]


class Curve:
    """A curve of roots in z = (x/size, phase, parameter/range)."""

    # Arclength measures positions from their mean: a shift of the whole orbit, such as by A0/k, changes nothing else
    # and needs no steps. So lengths and angles are those of `level(z)`.

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
            while len(self._equations) >= 32:
                del self._equations[next(iter(self._equations))]
            parameters = self.orbit.parameters.replace(**{self.parameter: value})
            self._equations[value] = ClosingEquations(parameters, self.word, self.orbit.periods)
        return self._equations[value]

    def linearised(self, z: np.ndarray, slope: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals (2n,) and their Jacobian (2n, 2n + 1) by scaled unknowns; `slope`: its last column."""
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
        """Return the scaled unknowns from points (n, 2) and parameter."""
        return np.append(np.ravel(points), value) / self.scale

    def of(self, point: BranchPoint) -> np.ndarray:
        """Return the scaled unknowns of a branch point."""
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
        for _ in range(12):
            try:
                slope = self.slope(z) if slope is None else slope  # good enough for all steps from a near guess
                values, matrix = self.linearised(z, slope)
                right = np.append(-values, -row @ (z - guess))
                step = np.linalg.solve(np.vstack([matrix, row]), right)
            except (np.linalg.LinAlgError, ParameterError, ZeroDivisionError):
                return None
            size, whole = np.abs(self.level(step)).max(), max(1.0, np.abs(z).max())
            if not np.isfinite(size) or size > 1.0:  # in arclength; farther off another root is found
                return None
            z = z + step
            if size <= 4 * EPS * whole or (size < CONVERGING and size > before / 4):
                return z
            before = size
        return z if size < CONVERGING else None

    def point(self, z: np.ndarray, along: np.ndarray) -> BranchPoint:
        """Return the branch point at z; its tangent is oriented like `along`."""
        points, value = self.split(z)
        equations = self.equations(value)
        _, matrix = self.linearised(self.joined(points, value))
        tangent = np.linalg.solve(np.vstack([matrix, self.level(along)]), np.append(np.zeros(len(z) - 1), 1.0))
        first, second = monodromy(equations, points).multipliers
        margins = tuple(conditions(equations, points))
        tangent /= np.linalg.norm(self.level(tangent))
        both = (complex(first), complex(second))
        return BranchPoint(value, points, tangent, both, margins, tuple(failing(list(margins))))

    def first(self, direction: float) -> BranchPoint:
        """Return the given first point, with its tangent towards larger or smaller values."""
        return self.point(self.joined(self.start, self.value), np.append(np.zeros(len(self.scale) - 1), direction))

    def accepted(self, z: np.ndarray | None, before: BranchPoint) -> BranchPoint | None:
        """Return the point at z, or None if there is none or the curve turns too sharply towards it."""
        if z is None:
            return None
        try:
            point = self.point(z, before.tangent)
        except (np.linalg.LinAlgError, ParameterError, ZeroDivisionError):
            return None
        return point if point.tangent @ self.level(before.tangent) > SHARPEST_TURN else None

    def step(self, current: BranchPoint, length: float) -> BranchPoint | None:
        """Return the point of the curve a length further on, at most at the end of the range; None if not found."""
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
        """Return the midpoint of the cubic through a and b with their tangents, which is near the curve."""
        return 0.5 * (self.of(a) + self.of(b)) + 0.125 * self.distance(a, b) * (a.tangent - b.tangent)

    def middle(self, a: BranchPoint, b: BranchPoint) -> BranchPoint | None:
        """Return the point of the curve midway between two points."""
        return self.accepted(self.correct(self.halfway(a, b), self.of(b) - self.of(a)), a)


# -- between two points ------------------------------------------------------------------------------------------------


def no_margin_vanishes(nodes: list[Node], margins: list[tuple[Condition, ...]]) -> bool:
    """Return whether no margin reaches 0 between the first and the last of five points of a branch."""
    rows = [[c.value for c in row if not of_function(c)] for row in margins]
    if not _cells(np.array(rows)).all():
        return False
    equations, points = nodes[2]
    for i, duration in enumerate(equations.durations(points)):
        parts = duration / equations.K.Om * equations.K.rate / SAMPLE
        u = np.linspace(0.0, 1.0, 1 + int(min(MOST_PARTS, max(LEAST_PARTS, parts))))
        if not _stay_positive(nodes, i, u, 30):
            return False
    return True


def of_function(condition: Condition) -> bool:
    """Return whether a condition concerns a whole piece, not only its end or duration."""
    return " stays in " in condition.text or " during " in condition.text


def _cells(values: np.ndarray, deficit: float | np.ndarray = 0.0) -> np.ndarray:
    """Return for each column of (5, n) values whether it is proven positive between the rows."""
    bend = np.abs(np.diff(values, 2, axis=0)).max(axis=0)
    if bend.size > 2:
        bend[1:-1] = np.maximum(bend[1:-1], np.maximum(bend[:-2], bend[2:]))
    least = values - deficit
    roots = np.sqrt(np.maximum(least, 0.0))
    return (least > 0).all(axis=0) & (roots[:-1] + roots[1:] > np.sqrt(0.5 * MARGIN_SAFETY * bend)).all(axis=0)


def _stay_positive(nodes: list[Node], i: int, u: np.ndarray, depth: int) -> bool:
    """Return whether the margins of piece i stay positive at and between the parts u of its duration."""
    found = [functions(equations, points, i, u) for equations, points in nodes]
    for rows in zip(*found, strict=True):
        values = np.array(rows)
        bend = np.abs(np.diff(values, 2, axis=1)).max(axis=0)
        bend = np.concatenate([bend[:1], bend, bend[-1:]])
        bend[1:-1] = np.maximum(bend[1:-1], np.maximum(bend[:-2], bend[2:]))
        good = _cells(values, MARGIN_SAFETY / 8 * bend)
        if good.all():
            continue
        if depth == 0 or not _cells(values)[~good].all():
            return False
        for first, last in _runs(~good):
            low, high = u[max(first - 1, 0)], u[min(last + 1, len(u) - 1)]
            finer = np.linspace(low, high, 1 + REFINED * (last - first + 2))
            if finer[1] <= finer[0] or len(finer) > MOST_PARTS or not _stay_positive(nodes, i, finer, depth - 1):
                return False
    return True


def _runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last index of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def functions(equations: ClosingEquations, points: Points, i: int, u: np.ndarray) -> list[np.ndarray]:
    """Return the margins of piece i (distances to belts or forces that hold) at parts u of its duration."""
    piece, start, end = equations.pieces[i], points[i], equations.ends(points)[i]
    tau = (end[1] - start[1]) / equations.K.Om
    return (_of_stick if piece.sticks else _of_flight)(equations, piece, start, end, tau, u)


def _of_flight(
    equations: ClosingEquations, piece: OrbitPiece, start: Point, end: Point, tau: float, u: np.ndarray
) -> list[np.ndarray]:
    """Return the margins of a flight, its distances to belts, at parts u of its duration."""
    K, times = equations.K, tau * u
    v, a, s, c = equations.start_of_flight(piece, start)
    _, dv, acceleration = motion(v, a, s, c, K.cm, K.w0sq, K.f0, K.Om, *basis(times, K)[:5])
    b = derivatives(v, a, s, c, K)[0]
    found = []
    for boundary, sign in ((piece.mode - 1, 1.0), (piece.mode, -1.0)):
        if boundary not in (1, 2):
            continue
        roots = 0 if boundary != piece.start else 2 if piece.after_stick else 1
        gap = sign * ((v - equations.belt(boundary).v) + dv)
        inner = u > 0 if roots else np.ones(len(u), dtype=bool)
        q = np.empty(len(u))
        q[inner] = gap[inner] / times[inner] ** roots
        q[~inner] = sign * (0.5 * b if roots == 2 else a)
        if boundary == piece.end:
            ends = u == 1
            q[~ends] /= 1 - u[~ends]
            q[ends] = -sign * acceleration[ends] * tau ** (1 - roots)
        found.append(q)
    return found


def _of_stick(
    equations: ClosingEquations, piece: OrbitPiece, start: Point, end: Point, tau: float, u: np.ndarray
) -> list[np.ndarray]:
    """Return the margins of a stick, the forces that hold it, at parts u of its duration."""
    K, belt = equations.K, equations.belt(piece.start)
    before = -(1 - u) * tau  # time, counted from the end of the stick, where the force that ends it is 0
    half = 0.5 * K.Om * before
    force = -piece.side * (belt.drift * before - 2 * K.f0 * np.sin(end[1] + half) * np.sin(half))
    slope = piece.side * (belt.drift - K.fB * equations.sin(end[1]))
    ratio = np.where(u == 1, slope, force / np.where(u == 1, 1.0, -before))
    return [ratio, belt.J - force]


# -- beyond an end -----------------------------------------------------------------------------------------------------


def word_beyond(curve: Curve, point: BranchPoint, direction: float) -> tuple[str | None, str]:
    """Return the orbit's word just beyond an end; or None and the motion there as text ("" if unknown)."""
    # The motion is simulated there from the orbit at the end, and the words that it goes through are solved for. One
    # with an admissible orbit is the answer: with c > 0 there is no second one (`symosc.orbits.floquet`).
    instead = ""
    for distance in DISTANCES:
        value = point.value + direction * distance * (curve.high - curve.low)
        if value == point.value:
            continue
        try:
            equations = curve.equations(value)
        except ParameterError:
            break
        x, theta = (float(value) for value in point.points[0])
        passages, rests = follow(equations, x, theta % (2 * pi), equations.pieces[0].start, SETTLING_EVENTS)
        found = orbit_of(equations, passages, float(np.abs(point.points[:, 0]).max()))
        if found is not None:
            return str(found[0].word), ""
        instead = instead or (resting_text(equations, passages[-1].mode) if rests else "")
    return None, instead


def orbit_of(
    equations: ClosingEquations, passages: list[Passage], size: float
) -> tuple[ClosingEquations, np.ndarray] | None:
    """Return the equations and points of an admissible orbit that a simulation approaches."""
    settled = settled_word(equations, passages)
    words = ([settled] if settled else []) + _words_of_a_period(equations, passages)
    for word in dict.fromkeys(words):
        trial = ClosingEquations(equations.parameters, word, equations.periods)
        found = windows(passages, word.labels, equations.periods, max(size, 1e-300))
        for guess in sorted(found, key=lambda each: each.defect)[:MOST_GUESSES]:
            solution = solve(trial, guess.points)
            if solution.converged and not failures(trial, solution.points):
                return trial, solution.points
    return None


def _words_of_a_period(equations: ClosingEquations, passages: list[Passage]) -> list[Word]:
    """Return the words of one period that occur in the simulation, the last ones first."""
    labels, found = mappings_between(passages), []
    phases = np.array([passage.theta for passage in passages])
    turn = 2 * pi * equations.periods
    for last in range(len(labels), 0, -1):
        first = int(np.argmin(np.abs(phases - (phases[last] - turn))))
        part = labels[first:last]
        if not 0 < len(part) <= LONGEST_WORD or None in part or phases[last] - turn < phases[0] - 1:
            continue
        try:
            word = read_word(rotated(tuple(label for label in part if label), equations))
        except WordError:
            continue
        if word not in found:
            found.append(word)
        if len(found) >= MOST_WORDS:
            break
    return found
