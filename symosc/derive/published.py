"""Published results that the model contains, each computed twice: by its formula, and by running this package.

The parameters are A0 = 0, B0 = P, v1 = 0, mu1 FN = F, mu2 = 0 and a v2 that no velocity reaches: an oscillator that
rubs on a wall. The formulas are those of `symosc.symbolic.coulomb`, evaluated with 50 digits; the package's values come
from `find_orbit` and `simulate`. The chapter `literature`, the page docs/literature.md and the tests use these tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import pi
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from symosc.derive.steps import CONTEXT
from symosc.errors import ParameterError, SymoscError
from symosc.exact import show
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.orbits.floquet import rest_positions
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.reference.cases import wall
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import G, H, Q, phi, x_0, x_f
from symosc.symbolic.solution import BASIS, tau
from symosc.symbolic.theorem7 import rational

#: mpmath with 60 digits, and its conversion of numbers of any kind.
MP = CONTEXT.clone()
number: Callable[[Any], Any] = MP.convert

# --- the formulas as numbers ---


class Formulas:
    """The closed forms with the numbers of one problem, in mpmath numbers of 60 digits.

    ParameterError without a spring, and at undamped resonance: there is no bounded motion to compute.
    """

    def __init__(self, p: Parameters) -> None:
        if p.k == 0:
            raise ParameterError("k", 0, "must be > 0: without a spring nothing holds the mass near the origin")
        if p.c == 0 and p.k == p.m * p.Omega**2:
            raise ParameterError("Omega", show(p.Omega), "must not be sqrt(k/m) for c = 0: the motion has no bound")
        s = solution
        exact = {s.m: p.m, s.c: p.c, s.k: p.k, s.Omega: p.Omega, s.cm: p.c / p.m, s.w0sq: p.k / p.m}
        exact |= {coulomb.P: abs(p.B0), x_f: p.mu1 * p.FN / p.k}
        rationals = {letter: rational(value) for letter, value in exact.items()}
        self.regime = next(r for r in solution.REGIMES.values() if r.condition.subs(rationals) == sp.true)
        self.numbers = {letter: number(value) for letter, value in exact.items()}
        self.numbers |= {letter: self.value(meaning) for letter, meaning in self.regime.letters.items()}
        self.half = self._basis(MP.pi / self.numbers[solution.Omega])
        self.numbers[Q] = self.value(sp.sqrt(coulomb.response_squared()))
        steady = [self.value(part, self.half) for part in coulomb.half_period()]
        self.numbers |= dict(zip((G, H), steady, strict=True))
        self.amplitude = self.numbers[x_0] = self.value(coulomb.amplitude())

    def value(self, expr: Any, more: dict[Any, Any] | None = None) -> Any:
        """Return an expression in the symbols as a number."""
        known = self.numbers | (more or {})
        letters = sorted(sp.sympify(expr).free_symbols, key=str)
        return _as_function(expr, tuple(letters))(*(known[letter] for letter in letters))

    def _basis(self, time: Any) -> dict[Any, Any]:
        return {name: self.value(self.regime.basis()[name], {tau: time}) for name in BASIS[:3]}

    def trace_and_determinant(self) -> tuple[Any, Any]:
        """Return trace and determinant of one period's matrix, the square of the half period's."""
        matrix = coulomb.half_period_matrix(coulomb.ratio())
        trace, determinant = (self.value(part, self.half) for part in (matrix.trace(), matrix.det()))
        return trace**2 - 2 * determinant, determinant**2

    def slide_bound(self, angle: Any) -> Any:
        """Return B at an angle after the highest point."""
        angle = MP.mpf(angle)
        return self.value(coulomb.slide_function(), self._basis(angle / self.numbers[solution.Omega]) | {phi: angle})

    def largest_slide_bound(self) -> tuple[Any, Any]:
        """Return the supremum of B over (0, pi) and the angle where it is, 0 for the limit at the turning point.

        A maximum inside counts if it is above that limit by 1e-10, relative to it: far above rounding errors.
        """

        def slope(angle: Any) -> Any:
            return MP.diff(self.slide_bound, angle)

        limit = self.value(coulomb.slide_limit())
        angles = np.linspace(0, pi, 4001)[1:-1]
        bound, letters = _slide_bounds(self.regime)
        values = bound(angles, *(float(self.numbers[letter]) for letter in letters))
        top = int(np.argmax(values))
        low = angles[top - 1] if top else angles[0] / 100
        if values[top] <= limit + 1e-10 * abs(limit) or slope(low) <= 0:
            return limit, MP.mpf(0)
        angle = MP.findroot(slope, (low, angles[top + 1]), solver="anderson")
        return self.slide_bound(angle), angle

    def largest_force_ratio(self) -> Any:
        """Return the largest F/P for which the symmetric motion has no stops."""
        largest = sp.Symbol("largest")
        return self.value(coulomb.largest_force_ratio(largest), {largest: self.largest_slide_bound()[0]})


@cache
def _as_function(expr: Any, letters: tuple[Any, ...]) -> Callable[..., Any]:
    """Return an expression as a function of its symbols, in mpmath numbers of 60 digits."""
    functions = {name: getattr(MP, name) for name in ("sin", "cos", "sinh", "cosh", "exp", "sqrt")}
    return sp.lambdify(letters, expr, modules=functions)


@cache
def _slide_bounds(regime: solution.Regime) -> tuple[Callable[..., Any], list[Any]]:
    """Return B for arrays of angles in double precision, and the symbols of its further arguments."""
    closed = coulomb.closed(coulomb.slide_function(), regime, phi / solution.Omega)
    letters = sorted(closed.free_symbols - {phi}, key=str)
    return sp.lambdify([phi, *letters], closed, "numpy"), letters


# --- this package's values ---


@cache
def slide_orbit(parameters: Parameters, digits: int | None = None) -> PeriodicOrbit:
    """Return the motion without stops."""
    return find_orbit(parameters, "P32", digits=digits)


def _turning_points(parameters: Parameters, x0: Any, t_end: int, digits: int | None = None) -> list[Any]:
    """Return the x at which a motion from rest turns or stops, in order of time."""
    path = simulate(parameters, t0=0, x0=x0, v0=5 if parameters.B0 else 0, t_end=t_end, digits=digits)
    return [event.x for event in path.events if event.kind in ("cross", "stick")]


def resonance_growth(F: Any, P: Any, digits: int = 30) -> list[Any]:
    """Return by how much each cycle raises the highest points at Omega = 1, c = 0.

    The start is the one whose turning points are at theta = pi/2 + n pi: x = (P/2 - F)/k at t = 0, with any velocity
    that is large enough.
    """
    highest = _turning_points(wall(F, 1, P=P), Fraction(P) / 2 - Fraction(F), 40, digits)[::2]
    return [after - before for before, after in pairwise(highest)]


def one_sided_orbit(F: Any, n: int, middle: Fraction) -> PeriodicOrbit:
    """Return the orbit without stops at Omega = 1/(2 n), c = 0 whose turning points lie around a middle.

    In double precision: its neighbours are orbits too, so that equations of more digits are singular there.
    """
    guess = [(0, float(middle + _free_amplitude(n))), (2 * pi * n, float(middle - _free_amplitude(n)))]
    return find_orbit(wall(F, Fraction(1, 2 * n)), "P32", guess=guess)


def _free_amplitude(n: int) -> Fraction:
    """Return |V| P/k at Omega = 1/(2 n): the friction does not enter."""
    return 1 / (1 - Fraction(1, 4 * n * n))


def one_sided_path(F: Any, n: int, middle: Fraction, cycles: Fraction) -> Trajectory:
    """Return the motion from the highest point that the orbit around a middle would have."""
    t_end = cycles * Fraction(4 * pi * n)
    return simulate(wall(F, Fraction(1, 2 * n)), t0=0, x0=middle + _free_amplitude(n), v0=0, t_end=t_end, accuracy=1e-6)


def one_sided_end(F: Any, n: int) -> float:
    """Bisect for the largest middle whose motion neither stops nor turns more than twice per cycle."""
    low, high = Fraction(0), Fraction(1)
    while high - low > 1e-9:
        middle = (low + high) / 2
        kinds = [event.kind for event in one_sided_path(F, n, middle, Fraction(9, 4)).events]
        low, high = (middle, high) if kinds == ["cross"] * 4 else (low, middle)
    return float(low + high) / 2


# --- the number of stops per cycle, by running ---


@cache
def stops(parameters: Parameters) -> int | None:
    """Return how many stops the motion from rest at 0 has per cycle when it has settled; None: it does not settle."""
    turn = 2 * pi / float(parameters.Omega)
    for cycles in (8, 30, 120, 480):
        path = from_rest(parameters, cycles + 2)
        before, after = path((cycles + 0.5) * turn), path((cycles + 1.5) * turn)
        if np.abs(after - before).max() < 1e-12 * (1 + np.abs(after).max()):
            onsets = [event.t / turn for event in path.events if event.kind == "stick"]
            return sum(cycles + 0.5 <= onset < cycles + 1.5 for onset in onsets)
    return None


def from_rest(p: Parameters, cycles: int) -> Trajectory:
    """Return so many cycles of the motion from rest at 0."""
    return simulate(p, t0=0, x0=0, v0=0, t_end=Fraction(cycles * (2 * pi / float(p.Omega))), accuracy=1e-6)


class Border(NamedTuple):
    """Where the number of stops changes: F/P on its two sides, and the numbers there."""

    low: float
    high: float
    below: int
    above: int

    @property
    def middle(self) -> float:
        """F/P halfway between the sides."""
        return (self.low + self.high) / 2


@cache
def find_border(low: Any, high: Any, Omega: Any, c: Any = 0) -> Border:
    """Bisect the forced amplitude between two values of F/P with different numbers of stops."""

    def count(ratio: Fraction) -> int | None:
        return stops(wall(1, Omega, c, P=1 / ratio))

    a, b = Fraction(low), Fraction(high)
    below, above = count(a), count(b)
    if below == above or below is None or above is None:
        raise ParameterError("low, high", (str(low), str(high)), "must have different numbers of stops")
    while b - a > 1e-8 * a:
        middle = (a + b) / 2
        found = count(middle)
        if found is None:
            raise SymoscError(f"the motion at F/P = {float(middle)!r} does not settle")
        if found == below:
            a = middle
        else:
            b, above = middle, found
    return Border(float(a), float(b), below, above)


# --- the same borders by equations ---


def solve_border(Omega: Any, border: Border) -> tuple[Any, str]:
    """Solve for the F/P near a border (c = 0) at which a stop, or a slide, is born; return it and which of the two.

    With P = k = 1 half a cycle is n slides down. Each starts where a stop ends, x = cos(theta) + F, and ends at rest,
    the last one at minus the first one's start: 2 n equations for n phases and n durations. The border is where

    - "graze": a slide comes to rest on the way without staying, v = x'' = 0: a stop of no length (with its time, two
      more equations for two more unknowns, the other one being F);
    - "birth": a stop lasts to theta = pi, where the drive just reaches what would move it, x = F - 1: a slide of no
      length.
    """
    few, count = min((border.low, border.below), (border.high, border.above), key=lambda side: side[1])
    p = wall(Fraction(few), Omega)
    slides, candidates = _slides_near_border(p, count // 2)
    _, kind, j, at = min(candidates)
    n = len(slides)
    # A slide that starts at rest and without acceleration.
    known = {solution.v_i: 0, solution.a_i: 0, solution.omega_0: 1, solution.f0: 1, solution.Omega: rational(p.Omega)}
    flow = [expr.xreplace(known) for expr in solution.flow(solution.REGIMES["undamped"])]
    x = _as_function(flow[0], (solution.x_i, solution.theta_i, tau))
    v, a = (_as_function(expr, (solution.theta_i, tau)) for expr in flow[1:])

    def equations(*z: Any) -> list[Any]:
        F, phases, times = z[0], z[1 : n + 1], z[n + 1 : 2 * n + 1]
        starts = [MP.cos(phase) + F for phase in phases]
        ends = [*starts[1:], -starts[0]]
        found = [v(phase, time) for phase, time in zip(phases, times, strict=True)]
        found += [x(*slide, time) - end for *slide, time, end in zip(starts, phases, times, ends, strict=True)]
        if kind == "birth":
            return [*found, ends[j] - F + 1]
        return [*found, v(phases[j], z[-1]), a(phases[j], z[-1])]

    guess = [few, *(phase for phase, _ in slides), *(time for _, time in slides)]
    return MP.findroot(equations, guess + [at] * (kind == "graze"))[0], kind


def _slides_near_border(p: Parameters, count: int) -> tuple[list[tuple[float, float]], list[Any]]:
    """Return (phase, duration) of each slide down in half a settled cycle, and nearby grazes and births."""
    path = from_rest(p, 22)
    late = [event for event in path.events if event.t > 40 * pi / float(p.Omega)]
    pairs = [(a, b) for a, b in pairwise(late) if a.kind == "slip"]
    first = next(
        i for i in range(1, len(pairs)) if pairs[i - 1][0].target == "Omega2" and pairs[i][0].target == "Omega1"
    )
    slides = pairs[first : first + count]
    candidates = []
    for j, (start, end) in enumerate(slides):
        candidates.append((abs(end.x - float(p.mu1) + 1), "birth", j, 0.0))
        times = np.linspace(start.t, end.t, 2001)[20:-20]
        speeds = path(times)[1]
        peaks = np.flatnonzero((speeds[1:-1] > speeds[:-2]) & (speeds[1:-1] >= speeds[2:])) + 1
        candidates += [(-float(speeds[i]), "graze", j, float(times[i] - start.t)) for i in peaks]
    return [(float(p.Omega) * start.t, end.t - start.t) for start, end in slides], candidates


# --- the tables ---

#: (c, F, Omega): under-, critically and overdamped too.
AMPLITUDES = (
    ("0", "0.4", "1.5"), ("0.2", "0.4", "1.5"), ("0.1", "0.25", "0.6"), ("2", "0.1", "0.8"), ("3", "0.1", "0.7"),
)  # fmt: skip
DAMPED = [(rf"$c = {c}$, $F = {F}$, $\Omega = {Omega}$", wall(F, Omega, c)) for c, F, Omega in AMPLITUDES]
#: (c, Omega), and two values of F/P between which the motions without stops end.
BORDERS = (
    ("0", "1.5", "0.646", "0.647"), ("0", "0.8", "0.817", "0.818"), ("0", "0.3", "0.086", "0.087"),
    ("0.2", "1.5", "0.598", "0.599"),
)  # fmt: skip
#: Omega, and two values of F/P between which the number of stops per cycle changes.
COUNTS = (
    ("0.1", "0.120", "0.121"), ("0.1", "0.373", "0.374"), ("0.1", "0.505", "0.506"), ("0.1", "0.804", "0.805"),
    ("0.04", "0.263", "0.264"), ("0.04", "0.379", "0.380"), ("0.04", "0.439", "0.440"), ("0.04", "0.457", "0.458"),
)  # fmt: skip
#: n of Omega = 1/(2 n), F, and the middles of the turning points.
CONTINUA = ((1, "0.1", ("-0.2", "0", "0.1")), (2, "0.02", ("0", "0.04")))
#: A mass that may rest on belt 1, with damping.
RESTING = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=10, mu1=1, mu2="1/10", FN=1)


class Value(NamedTuple):
    """A number computed twice.

    Its letter and the parameters in LaTeX (those that are not named are 1 (m, k, P, F_N) or 0 (c)), the two numbers,
    how many decimals are worth printing, what the two may differ by (relative), and what else was seen in running.
    """

    name: str
    case: str
    formula: Any
    package: Any
    decimals: int = 12
    tolerance: float = 1e-12
    note: str = ""

    @property
    def difference(self) -> Any:
        """Formula minus package, relative to the formula's value if that is not 0."""
        formula = number(self.formula)
        return (formula - number(self.package)) / (abs(formula) or 1)


def _amplitudes() -> Iterator[Value]:
    for case, p in DAMPED:
        yield Value("x_0", case, Formulas(p).amplitude, max(point.x for point in slide_orbit(p, 30).points))


def _multipliers() -> Iterator[Value]:
    """Yield sum and product of the multipliers of P32; products that are too small for a table are left out."""
    for case, p in DAMPED:
        one, other = slide_orbit(p, 30).multipliers
        total, product = Formulas(p).trace_and_determinant()
        yield Value(r"\rho_1 + \rho_2", case, total, (one + other).real)
        if abs(product) > 1e-4:
            yield Value(r"\rho_1 \rho_2", case, product, (one * other).real)


def _borders() -> Iterator[Value]:
    """Yield where the motions without stops end."""
    for c, Omega, low, high in BORDERS:
        border = find_border(Fraction(low), Fraction(high), Omega, c)
        yield _border(rf"$c = {c}$, $\Omega = {Omega}$", Formulas(wall(1, Omega, c)).largest_force_ratio(), border)


def _counts() -> Iterator[Value]:
    """Yield where other numbers of stops change."""
    for Omega, low, high in COUNTS:
        border = find_border(Fraction(low), Fraction(high), Omega)
        yield _border(rf"$\Omega = {Omega}$", solve_border(Omega, border)[0], border)


def _border(case: str, formula: Any, border: Border) -> Value:
    note = f"{border.below} stops below, {border.above} above"
    return Value("F/P", case, formula, border.middle, 7, 1e-7, note)


def _growth() -> Iterator[Value]:
    for F, P in (("0.5", "1"), ("0.3", "0.5")):
        formula, rises = MP.pi * MP.mpf(P) - 4 * MP.mpf(F), resonance_growth(F, P)
        _, worst = max((abs(MP.mpf(rise) - formula), rise) for rise in rises)
        yield Value(r"\Delta x", rf"$P = {P}$, $F = {F}$", formula, worst, note=f"{len(rises)} cycles")


def _decay() -> Iterator[Value]:
    """Yield the turning points of a free motion that starts at rest, the last one where it stays."""
    F, formula = Fraction(1, 10), Fraction(19, 20)
    for i, x in enumerate(_turning_points(wall(F, 1, P=0), formula, 40), 1):
        formula = -formula + (2 * F if formula > 0 else -2 * F)
        yield Value(f"x_{i}", "$F = 0.1$", formula, x)


def _continuum() -> Iterator[Value]:
    """Yield turning points and second multipliers of members of the continua."""
    for n, F, middles in CONTINUA:
        half, x_f, case = _free_amplitude(n), Fraction(F), rf"$\Omega = 1/{2 * n}$, $F = {F}$"
        end = half / (4 * n * n) - x_f
        for middle in map(Fraction, middles):
            orbit = one_sided_orbit(F, n, middle)
            assert orbit.stable is None
            member = rf"{case}, $\bar{{x}} = {show(middle)}$"
            highest, lowest = (point.x for point in orbit.points)
            product = (end**2 - middle**2) / ((end + 2 * x_f) ** 2 - middle**2)
            yield Value(r"x_{\max}", member, middle + half, highest)
            yield Value(r"x_{\min}", member, middle - half, lowest)
            yield Value(r"\rho_2", member, product, orbit.multipliers[1].real)
        yield Value("d_*", case, end, one_sided_end(F, n), 7, 1e-7)


def _rests() -> Iterator[Value]:
    """Yield the ends of the interval of rests, and where motions from inside of it are after 60 units of time."""
    p, ends = RESTING, rest_positions(RESTING, 1)
    assert ends is not None
    yield Value("x_-", "", (p.A(2) + abs(p.B0)) / p.k, ends[0])
    yield Value("x_+", "", (p.A(1) - abs(p.B0)) / p.k, ends[1])
    for x in map(Fraction, ("-3/5", "0", "1/2")):
        yield Value("x(60)", f"from ${show(x)}$", x, float(simulate(p, t0=0, x0=x, v0=0, t_end=60)(60)[0]))


#: What is compared: title, the sources' keys, and what computes it.
TABLES: dict[str, tuple[str, tuple[str, ...], Callable[[], Iterator[Value]]]] = {
    "amplitude": ("Amplitude of the motion without stops", ("denhartog1930", "denhartog1931"), _amplitudes),
    "stability": ("Its multipliers", ("shaw1986",), _multipliers),
    "border": ("Where motions without stops end", ("denhartog1930", "hongliu2000"), _borders),
    "resonance": ("Growth per cycle at resonance", ("denhartog1930",), _growth),
    "decay": ("Turning points of a free motion", ("denhartog1930",), _decay),
    "stops": ("Where the number of stops per cycle changes", ("hongliu2000",), _counts),
    "continuum": (r"Motions around a middle $\bar{x}$", ("csernak2007",), _continuum),
    "rests": ("Rest positions on a belt at rest", (), _rests),
}


@cache
def table(key: str) -> tuple[Value, ...]:
    """Return the values of one table."""
    return tuple(TABLES[key][2]())
