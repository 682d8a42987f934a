"""Published results that the model contains, each computed twice: by its formula, and by running this package.

The parameters are A0 = 0, B0 = P, v1 = 0, mu1 FN = F, mu2 = 0 and a v2 that no velocity reaches: an oscillator that
rubs on a wall. The formulas are those of `symosc.symbolic.coulomb`, evaluated with 50 digits; the package's values come
from `find_orbit` and `simulate`. Nothing here is quoted but the formulas' sources.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
import sympy as sp

from symosc.derive.steps import CONTEXT
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.reference.cases import wall
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import G, H, Q, phi, x_0, x_f
from symosc.symbolic.solution import BASIS, Omega, c, k, m, tau
from symosc.symbolic.theorem7 import rational

MP = CONTEXT.clone()
GRID = 4001
#: What a maximum of B inside must be above its limit at the turning point, relative to it: far above rounding errors.
ABOVE = 1e-10


# --- the formulas as numbers ---


class Formulas:
    """The closed forms with the numbers of one problem, in mpmath numbers of 60 digits.

    Raises
    ------
    ParameterError
        Without a spring, and at undamped resonance: there is no bounded motion to compute.
    """

    def __init__(self, parameters: Parameters) -> None:
        p = parameters
        if p.k == 0:
            raise ParameterError("k", 0, "must be > 0: without a spring nothing holds the mass near the origin")
        if p.c == 0 and p.k == p.m * p.Omega**2:
            raise ParameterError("Omega", show(p.Omega), "must not be sqrt(k/m) for c = 0: the motion has no bound")
        exact = {m: p.m, c: p.c, k: p.k, Omega: p.Omega, coulomb.P: abs(p.B0), x_f: p.mu1 * p.FN / p.k}
        exact |= {solution.cm: p.c / p.m, solution.w0sq: p.k / p.m}
        rationals = {letter: rational(value) for letter, value in exact.items()}
        regimes = solution.REGIMES.values()
        self.regime = next(each for each in regimes if each.condition.subs(rationals) == sp.true)
        self.numbers = {letter: MP.mpf(value.numerator) / value.denominator for letter, value in exact.items()}
        self.numbers |= {letter: self.value(meaning) for letter, meaning in self.regime.letters.items()}
        self.half = self.basis(MP.pi / self.numbers[Omega])
        self.numbers[Q] = self.value(sp.sqrt(coulomb.response_squared()))
        steady = [self.value(part, self.half) for part in coulomb.half_period()]
        self.numbers |= dict(zip((G, H), steady, strict=True))
        self.numbers[x_0] = self.value(coulomb.amplitude())

    def value(self, expr: Any, more: dict[Any, Any] | None = None) -> Any:
        """Return an expression in the letters as a number."""
        known = self.numbers | (more or {})
        letters = sorted(sp.sympify(expr).free_symbols, key=str)
        return as_function(expr, tuple(letters))(*(known[letter] for letter in letters))

    def basis(self, time: Any) -> dict[Any, Any]:
        """Return E0, E1, E2 at a time."""
        closed = self.regime.basis()
        return {name: self.value(closed[name], {tau: time}) for name in BASIS[:3]}

    def amplitude(self) -> Any:
        """Return x_0."""
        return self.numbers[x_0]

    def trace_and_determinant(self) -> tuple[Any, Any]:
        """Return trace and determinant of one period's matrix, the square of the half period's."""
        matrix = coulomb.half_period_matrix(coulomb.ratio())
        trace, determinant = (self.value(part, self.half) for part in (matrix.trace(), matrix.det()))
        return trace**2 - 2 * determinant, determinant**2

    def slide_bound(self, angle: Any) -> Any:
        """Return B at an angle after the highest point."""
        angle = MP.mpf(angle)
        return self.value(coulomb.slide_function(), self.basis(angle / self.numbers[Omega]) | {phi: angle})

    def largest_slide_bound(self) -> tuple[Any, Any]:
        """Return the supremum of B over (0, pi) and the angle where it is, 0 for the limit at the turning point.

        A maximum inside counts if it is above that limit by `ABOVE`, relative to it.
        """
        limit = self.value(coulomb.slide_limit())
        angles = np.linspace(0, pi, GRID)[1:-1]
        bound, letters = _slide_bounds(self.regime)
        values = bound(angles, *(float(self.numbers[letter]) for letter in letters))
        top = int(np.argmax(values))
        low = angles[top - 1] if top else angles[0] / 100
        if values[top] <= limit + ABOVE * abs(limit) or self._slide_slope(low) <= 0:
            return limit, MP.mpf(0)
        angle = MP.findroot(self._slide_slope, (low, angles[top + 1]), solver="anderson")
        return self.slide_bound(angle), angle

    def _slide_slope(self, angle: Any) -> Any:
        return MP.diff(self.slide_bound, angle)

    def border(self) -> Any:
        """Return F/P at the end of the motions without stops."""
        largest, _ = self.largest_slide_bound()
        return self.value(coulomb.border(LARGEST), {LARGEST: largest})


LARGEST = sp.Symbol("largest")


@cache
def as_function(expr: Any, letters: tuple[Any, ...]) -> Callable[..., Any]:
    """Return an expression as a function of its letters, in mpmath numbers of 60 digits."""
    functions = {name: getattr(MP, name) for name in ("sin", "cos", "sinh", "cosh", "exp", "sqrt")}
    return sp.lambdify(letters, expr, modules=functions)


@cache
def _slide_bounds(regime: solution.Regime) -> tuple[Callable[..., Any], list[Any]]:
    """Return B for arrays of angles in double precision, and the letters that it needs after the angles."""
    closed = coulomb.closed(coulomb.slide_function(), regime, phi / Omega)
    letters = sorted(closed.free_symbols - {phi}, key=str)
    return sp.lambdify([phi, *letters], closed, "numpy"), letters


# --- this package's values ---


@cache
def slide_orbit(parameters: Parameters, digits: int | None = None) -> PeriodicOrbit:
    """Return the motion without stops."""
    return find_orbit(parameters, "P32", digits=digits)


def turning_points(parameters: Parameters, x0: Any, v0: Any, t_end: Any, digits: int | None = None) -> list[Any]:
    """Return the x at which the velocity changes its sign, and where the mass stops, in order of time."""
    path = simulate(parameters, t0=0, x0=x0, v0=v0, t_end=t_end, digits=digits)
    return [event.x for event in path.events if event.kind in ("cross", "stick")]


def resonance_growth(F: Any, P: Any, digits: int = 30) -> list[Any]:
    """Return by how much each cycle raises the highest points at Omega = 1, c = 0.

    The start is the one whose turning points are at theta = pi/2 + n pi: x = (P/2 - F)/k at t = 0, with any velocity
    that is large enough.
    """
    start = Fraction(P) / 2 - Fraction(F)
    highest = turning_points(wall(F, 1, P=P), start, 5, 40, digits)[::2]
    return [after - before for before, after in pairwise(highest)]


@cache
def one_sided_orbit(F: Any, n: int, middle: Fraction) -> PeriodicOrbit:
    """Return the orbit without stops at Omega = 1/(2 n), c = 0 whose turning points lie around a middle.

    In double precision: its neighbours are orbits too, so that equations of more digits are singular there.
    """
    x_0 = 1 / (1 - Fraction(1, 4 * n * n))  # |V| P/k: the friction does not enter
    guess = [(0, float(middle + x_0)), (2 * pi * n, float(middle - x_0))]
    return find_orbit(wall(F, Fraction(1, 2 * n)), "P32", guess=guess)


def one_sided_end(F: Any, n: int, width: float = 1e-9) -> float:
    """Bisect for the largest middle whose motion neither stops nor turns more than twice per cycle."""
    low, high = Fraction(0), Fraction(1)
    while high - low > width:
        middle = (low + high) / 2
        kinds = [event.kind for event in _one_sided_path(F, n, middle, Fraction(9, 4)).events]
        low, high = (middle, high) if kinds == ["cross"] * 4 else (low, middle)
    return float(low + high) / 2


def one_sided_stops(F: Any, n: int, middle: Fraction, cycles: int) -> list[float]:
    """Return how long the stops last in a motion from the highest point that an orbit around a middle would have."""
    events = _one_sided_path(F, n, middle, Fraction(cycles)).events
    return [end.t - onset.t for onset, end in pairwise(events) if onset.kind == "stick"]


def _one_sided_path(F: Any, n: int, middle: Fraction, cycles: Fraction) -> Trajectory:
    highest = middle + 1 / (1 - Fraction(1, 4 * n * n))
    t_end = cycles * Fraction(4 * pi * n)
    return simulate(wall(F, Fraction(1, 2 * n)), t0=0, x0=highest, v0=0, t_end=t_end, accuracy=1e-6)
