"""Published results that the model contains, each computed twice: by its formula, and by running this package.

The parameters are A0 = 0, B0 = P, v1 = 0, mu1 FN = F, mu2 = 0 and a v2 that no velocity reaches: an oscillator that
rubs on a wall. The formulas are those of `symosc.symbolic.coulomb`, evaluated with 50 digits; the package's values come
from `find_orbit` and `simulate`. Nothing here is quoted but the formulas' sources.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import pi
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from symosc.derive.steps import CONTEXT, DIGITS
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.simulation.simulate import simulate
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import G, H, Q, phi, x_0, x_f
from symosc.symbolic.solution import BASIS, Omega, c, k, m, tau
from symosc.symbolic.theorem7 import rational

MP = CONTEXT.clone()
FAR = 10**6
GRID = 4001
#: What a maximum of B inside must be above its limit at the turning point, relative to it: far above rounding errors.
ABOVE = 1e-10
#: A border is bisected to this width, relative to F/P.
WIDTH = 1e-10
SETTLING, LOOKED_AT = 40, 3


def wall(F: Any, Omega: Any, c: Any = 0, P: Any = 1) -> Parameters:
    """Return the parameters of a mass on a spring that rubs on a wall; m = k = F_N = 1."""
    return Parameters(m=1, c=c, k=1, A0=0, B0=P, Omega=Omega, v1=0, v2=FAR, mu1=F, mu2=0, FN=1)


# --- the formulas as numbers ---


class Formulas:
    """The closed forms with the numbers of one problem, in mpmath numbers of 60 digits."""

    def __init__(self, parameters: Parameters) -> None:
        p = parameters
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
        return _function(expr, tuple(letters))(*(known[letter] for letter in letters))

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
        closed = coulomb.closed(coulomb.slide_function(), self.regime, phi / Omega)
        letters = sorted(closed.free_symbols - {phi}, key=str)
        bound = sp.lambdify([phi, *letters], closed, "numpy")
        values = bound(angles, *(float(self.numbers[letter]) for letter in letters))
        top = int(np.argmax(values))
        if values[top] <= limit + ABOVE * abs(limit):
            return limit, MP.mpf(0)
        around = tuple(angles[[top - 1, top + 1]])
        angle = MP.findroot(lambda at: MP.diff(self.slide_bound, at), around, solver="anderson")
        return self.slide_bound(angle), angle

    def border(self) -> Any:
        """Return F/P at the end of the motions without stops."""
        largest, _ = self.largest_slide_bound()
        return self.value(coulomb.border(LARGEST), {LARGEST: largest})


LARGEST = sp.Symbol("largest")


@cache
def _function(expr: Any, letters: tuple[Any, ...]) -> Callable[..., Any]:
    functions = {name: getattr(MP, name) for name in ("sin", "cos", "sinh", "cosh", "exp", "sqrt")}
    return sp.lambdify(letters, expr, modules=functions)  # type: ignore[no-any-return]


# --- this package's values ---


@cache
def slide_orbit(parameters: Parameters, digits: int | None = None) -> PeriodicOrbit:
    """Return the motion without stops."""
    return find_orbit(parameters, "P32", digits=digits)


@cache
def stops(parameters: Parameters) -> int | None:
    """Return how many stops a settled motion from rest at 0 has per period of the excitation; None: it differs."""
    turn = 2 * pi / float(parameters.Omega)
    end = Fraction((SETTLING + LOOKED_AT) * turn)
    path = simulate(parameters, t0=0, x0=0, v0=0, t_end=end, accuracy=1e-6)
    onsets = np.array([event.t for event in path.events if event.kind == "stick"]) / turn - SETTLING
    counts = {int(np.count_nonzero((onsets >= i) & (onsets < i + 1))) for i in range(LOOKED_AT)}
    return counts.pop() if len(counts) == 1 else None


class Border(NamedTuple):
    """Where the number of stops changes: F/P on its two sides, and the numbers there."""

    low: float
    high: float
    below: int
    above: int

    @property
    def middle(self) -> float:
        return (self.low + self.high) / 2


def stops_at(ratio: Fraction, Omega: Any, c: Any = 0) -> int | None:
    """Return the number of stops per cycle at F/P = ratio: F = 1, and P is the forced amplitude."""
    return stops(wall(1, Omega, c, P=1 / ratio))


@cache
def find_border(low: Any, high: Any, Omega: Any, c: Any = 0) -> Border:
    """Bisect the forced amplitude between two values of F/P with different numbers of stops."""
    a, b = Fraction(low), Fraction(high)
    below, above = stops_at(a, Omega, c), stops_at(b, Omega, c)
    while b - a > WIDTH * a:
        middle = (a + b) / 2
        count = stops_at(middle, Omega, c)
        if count == below:
            a = middle
        else:
            b, above = middle, count
    assert below is not None
    assert above is not None
    return Border(float(a), float(b), below, above)
