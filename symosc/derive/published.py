"""Published results that the model contains, each computed twice: by its formula, and by running
this package.

The parameters are A0 = 0, B0 = P, v1 = 0, mu1 FN = F, mu2 = 0 and a v2 that no velocity reaches: an
oscillator that rubs on a wall. Formulas (`symosc.symbolic.coulomb`) have 50 digits; the package's
values come from `find_orbit` and `simulate`. The chapter `literature`, the page docs/literature.md
and the tests use these tables.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache, partial
from itertools import pairwise
from math import pi
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from scipy import optimize

from symosc.analysis.sensitivities import sensitivities
from symosc.base.errors import ParameterError, SymoscError
from symosc.base.exact import show
from symosc.derive.steps import CONTEXT
from symosc.model import Parameters
from symosc.orbits.branch import continue_orbit
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


class Flight:
    """The closed forms of a flight for one set of parameters, evaluated with 60 digits."""

    def __init__(self, p: Parameters) -> None:
        s = solution
        exact = {s.m: p.m, s.c: p.c, s.k: p.k, s.Omega: p.Omega, s.cm: p.c / p.m, s.w0sq: p.k / p.m}
        exact |= {coulomb.P: abs(p.B0), x_f: p.mu1 * p.FN / p.k}
        (self.regime,) = s.possible_regimes(
            {letter: rational(value) for letter, value in exact.items()}
        )
        self.numbers = {letter: number(value) for letter, value in exact.items()}
        self.numbers |= {
            letter: self.value(meaning) for letter, meaning in self.regime.letters.items()
        }

    def value(self, expr: Any, more: dict[Any, Any] | None = None) -> Any:
        """Evaluate an expression with the numbers of this flight's symbols, and with those that
        `more` gives.
        """
        known = self.numbers | (more or {})
        letters = tuple(sorted(sp.sympify(expr).free_symbols, key=str))
        return _as_function(expr, letters)(*(known[letter] for letter in letters))

    def basis(self, time: Any) -> dict[Any, Any]:
        """Return the response to a unit impulse (E1), its derivative (E0) and its integral (E2) at
        a time.
        """
        return {name: self.value(self.regime.basis()[name], {tau: time}) for name in BASIS[:3]}


class Formulas(Flight):
    """Den Hartog's symmetric motion without stops for given parameters.

    ParameterError if k = 0 or it is unbounded.
    """

    def __init__(self, p: Parameters) -> None:
        if p.k == 0:
            raise ParameterError(
                "k", 0, "must be > 0: without a spring nothing holds the mass near the origin"
            )
        if p.c == 0 and p.k == p.m * p.Omega**2:
            raise ParameterError(
                "Omega", show(p.Omega), "must not be sqrt(k/m) for c = 0: the motion has no bound"
            )
        super().__init__(p)
        self.half = self.basis(MP.pi / self.numbers[solution.Omega])
        self.numbers[Q] = self.value(coulomb.FRICTIONLESS)
        steady = [self.value(part, self.half) for part in coulomb.half_period()]
        self.numbers |= dict(zip((G, H), steady, strict=True))
        self.amplitude = self.numbers[x_0] = self.value(coulomb.amplitude())
        known = self.numbers
        self.steady = known[x_0] + known[G] * known[x_f], known[H] * known[x_f]  # p_0 and q_0

    def trace_and_determinant(self) -> tuple[Any, Any]:
        """Return trace and determinant of the monodromy matrix, the square of the matrix of half a
        period.
        """
        matrix = coulomb.half_period_matrix(coulomb.ratio())
        trace, determinant = (
            self.value(part, self.half) for part in (matrix.trace(), matrix.det())
        )
        return trace**2 - 2 * determinant, determinant**2

    def slide_bound(self, angle: Any) -> Any:
        """Return the bound B: at an angle after the highest point the mass moves down if and only
        if p_0 > B F/k.

        p_0 is the value of the steady response to the drive at the highest point.
        """
        angle = MP.mpf(angle)
        return self.value(
            coulomb.slide_function(),
            self.basis(angle / self.numbers[solution.Omega]) | {phi: angle},
        )

    def largest_slide_bound(self) -> tuple[Any, Any]:
        """Return the supremum of `slide_bound` over the angles (0, pi), and the angle where it is
        reached.
        """
        # A maximum inside counts if it is above that limit by 1e-10, relative to it: far above
        # rounding errors.
        slope = partial(MP.diff, self.slide_bound)
        limit = self.value(coulomb.slide_limit())
        angles = np.linspace(0, pi, 4001)[1:-1]
        bound, letters = _slide_bounds(self.regime)
        values = bound(angles, *(float(self.numbers[letter]) for letter in letters))
        top = int(np.argmax(values))
        if top:
            low = angles[top - 1]
        else:
            low = angles[0] / 100
        if values[top] <= limit + 1e-10 * abs(limit) or slope(low) <= 0:
            return limit, MP.mpf(0)
        angle = MP.findroot(slope, (low, angles[top + 1]), solver="anderson")
        return self.slide_bound(angle), angle

    def largest_force_ratio(self) -> Any:
        """Return the largest ratio F/P of friction to drive for which the symmetric motion has no
        stops.
        """
        largest = sp.Symbol("largest")
        return self.value(
            coulomb.largest_force_ratio(largest), {largest: self.largest_slide_bound()[0]}
        )


@cache
def _as_function(expr: Any, letters: tuple[Any, ...]) -> Callable[..., Any]:
    """Return an expression as a function of its symbols, in mpmath numbers of 60 digits."""
    return sp.lambdify(
        letters,
        expr,
        {name: getattr(MP, name) for name in ("sin", "cos", "sinh", "cosh", "exp", "sqrt")},
    )


@cache
def _slide_bounds(regime: solution.Regime) -> tuple[Callable[..., Any], list[Any]]:
    """Return `slide_bound` in a damping regime as a numpy function of the angle and some symbols,
    and these symbols.
    """
    closed = coulomb.closed(coulomb.slide_function(), regime, phi / solution.Omega)
    letters = sorted(closed.free_symbols - {phi}, key=str)
    return sp.lambdify([phi, *letters], closed, "numpy"), letters


# --- this package's values ---


@cache
def slide_orbit(parameters: Parameters, digits: int | None = None) -> PeriodicOrbit:
    """Return the motion without stops as the periodic orbit P32 that the package finds."""
    return find_orbit(parameters, "P32", digits=digits)


def _turning_points(
    parameters: Parameters, x0: Any, t_end: int, digits: int | None = None
) -> list[Any]:
    """Return the positions at which a motion turns or stops, in order of time."""
    path = simulate(
        parameters, t0=0, x0=x0, v0=5 if parameters.B0 else 0, t_end=t_end, digits=digits
    )
    return [event.x for event in path.events if event.kind in ("cross", "stick")]


def resonance_start(P: Any, F: Any) -> Any:
    """Return k x at the start of the motion at resonance."""
    return P / 2 - F


def resonance_growth(F: Any, P: Any, digits: int = 30) -> list[Any]:
    """Simulate a motion at resonance with friction F and drive P.

    Return how far its highest point rises per cycle.
    """
    # From this x at t = 0, with any velocity that is large enough, turning points are at
    # theta = pi/2 + n pi.
    start = resonance_start(Fraction(P), Fraction(F))
    highest = _turning_points(wall(F, 1, P=P), start, 40, digits)[::2]
    return [after - before for before, after in pairwise(highest)]


def one_sided_orbit(F: Any, n: int, middle: Fraction) -> PeriodicOrbit:
    """Return the orbit without stops, c = 0, Omega = 1/(2 n), friction F, whose turning points have
    mean `middle`.
    """
    # In doubles only: neighbouring motions are orbits too, so the equations are singular, which
    # more digits would show.
    guess = [
        (0, float(middle + _free_amplitude(n))),
        (2 * pi * n, float(middle - _free_amplitude(n))),
    ]
    return find_orbit(wall(F, Fraction(1, 2 * n)), "P32", guess=guess)


def _free_amplitude(n: int) -> Fraction:
    """Return the amplitude at Omega = 1/(2 n), P = k = 1, which does not depend on friction."""
    return 1 / (1 - Fraction(1, 4 * n * n))


def one_sided_path(F: Any, n: int, middle: Fraction, cycles: Fraction) -> Trajectory:
    """Simulate `cycles` periods of the motion of `one_sided_orbit`, which starts at its highest
    point.
    """
    t_end = cycles * Fraction(4 * pi * n)
    return simulate(
        wall(F, Fraction(1, 2 * n)),
        t0=0,
        x0=middle + _free_amplitude(n),
        v0=0,
        t_end=t_end,
        accuracy=1e-6,
    )


def one_sided_end(F: Any, n: int) -> float:
    """Return the largest `middle` with which the motion of `one_sided_orbit` has no stops, found by
    bisection.
    """
    return _largest_without_stops(lambda middle: (F, n, middle))


def last_friction(n: int) -> float:
    """Return the largest friction F with which the symmetric motion at Omega = 1/(2 n), c = 0 has
    no stops.
    """
    return _largest_without_stops(lambda F: (F, n, Fraction(0)))


def _largest_without_stops(motion: Callable[[Fraction], tuple[Any, int, Fraction]]) -> float:
    """Return the largest z in (0, 1) for which `one_sided_path` with (F, n, middle) = motion(z) has
    no stops.
    """
    low = Fraction(0)
    high = Fraction(1)
    while high - low > 1e-9:
        middle = (low + high) / 2
        events = one_sided_path(*motion(middle), Fraction(9, 4)).events
        if [event.kind for event in events] == ["cross"] * 4:
            low = middle
        else:
            high = middle
    return float(low + high) / 2


# --- where borders meet, and where P32 ends ---


def meeting_point(c: Any, guess: tuple[float, float]) -> tuple[Any, Any]:
    """Return (Omega, F) at which the mass turns without acceleration just when the drive has its
    peak.
    """

    def conditions(Omega: Any, F: Any) -> tuple[Any, Any]:
        formulas = Formulas(wall(MP.nstr(F, 55), MP.nstr(Omega, 55), c))
        p, q = formulas.steady
        turned = formulas.value(
            coulomb.turning_acceleration(True), {coulomb.p_0: p, coulomb.q_0: q}
        )
        return turned, (1 - Omega**2) * q - number(Fraction(c)) * Omega * p

    return tuple(MP.findroot(conditions, guess))


def meeting_point_by_running(c: Any, guess: tuple[float, float]) -> tuple[float, float]:
    """Return (Omega, F) of `meeting_point`, solved for with orbits P32 from `find_orbit` instead of
    formulas.
    """

    def conditions(where: Any) -> tuple[float, float]:
        t, x = max(find_orbit(wall(where[1], where[0], c), "P32").points, key=lambda point: point.x)
        phase = where[0] * t
        return np.cos(phase) - x + where[1], np.sin(phase)

    return tuple(optimize.root(conditions, guess, tol=1e-12, options={"eps": 1e-8}).x.tolist())


def end_without_stops(c: Any, P: Any, near: float) -> tuple[Any, Any]:
    """Return the Omega next to `near` at which the motion without stops ends for friction F = 1,
    and its amplitude.
    """

    def formulas(Omega: Any) -> Formulas:
        return Formulas(wall(1, MP.nstr(Omega, 55), c, P=P))

    def gap(Omega: Any) -> Any:
        return formulas(Omega).largest_force_ratio() * number(Fraction(P)) - 1

    Omega = MP.findroot(gap, (near, near + 1e-4), solver="secant")
    return Omega, formulas(Omega).amplitude


# --- base and wall move together ---


def base_and_wall(F: Any, Omega: Any) -> Parameters:
    """Return parameters for the mass's motion relative to base and wall, which both move as
    cos(Omega t); m = k = 1.
    """
    return wall(F, Omega, P=Fraction(Omega) ** 2)


def transmissibility(F: Any, Omega: Any) -> Any:
    """Return the mass's largest absolute displacement if base and wall move as cos(Omega t), by
    formula; c = 0.
    """
    formulas = Formulas(base_and_wall(F, Omega))
    known = formulas.numbers
    r = formulas.numbers[solution.Omega]
    (p, q) = formulas.steady

    def absolute(angle: Any) -> Any:
        steady = (p * MP.cos(angle) + q * MP.sin(angle)) / r**2
        free = known[x_0] - p - known[x_f]
        rate = -q * r
        return known[x_f] + steady + free * MP.cos(angle / r) + rate * MP.sin(angle / r)

    top = float(max(np.linspace(0, pi, 201), key=lambda angle: abs(absolute(angle))))
    return abs(absolute(MP.findroot(lambda angle: MP.diff(absolute, angle), top)))


def transmissibility_by_running(F: Any, Omega: Any) -> float:
    """Return the same as `transmissibility` by simulation: motion on P32 relative to the base, plus
    cos(Omega t).
    """
    p = base_and_wall(F, Omega)
    (t0, x0), _ = slide_orbit(p).points
    path = simulate(
        p,
        t0=Fraction(t0),
        x0=Fraction(x0),
        v0=0,
        t_end=Fraction(t0) + Fraction(slide_orbit(p).period),
    )

    def absolute(t: Any) -> Any:
        return -np.abs(path(t)[0] + np.cos(float(p.Omega) * t))

    times = np.linspace(path.t_start, path.t_end, 1001)[1:-1]
    top = times[int(np.argmin(absolute(times)))]
    step = times[1] - times[0]
    around = (top - step, top + step)
    return -float(
        optimize.minimize_scalar(
            absolute, bounds=around, method="bounded", options={"xatol": 1e-9}
        ).fun
    )


def inversion(F: Any, height: Callable[[Any, Any], Any]) -> float:
    """Return the frequency ratio Omega at which the amplitude ``height(F, Omega)`` is as large as
    without friction.
    """
    return float(
        optimize.brentq(
            lambda r: float(height(F, Fraction(r))) * (r * r - 1) - 1, 1.38, 1.6, xtol=1e-13
        )
    )


# --- the number of stops per cycle, by running ---


@cache
def stops(parameters: Parameters) -> int | None:
    """Count the stops per cycle of the settled motion from rest at 0; None if it does not settle."""
    turn = 2 * pi / float(parameters.Omega)
    for cycles in (8, 30, 120, 480, 1920):
        path = from_rest(parameters, cycles + 2)
        before = path((cycles + 0.5) * turn)
        after = path((cycles + 1.5) * turn)
        if np.abs(after - before).max() < 1e-12 * (1 + np.abs(after).max()):
            onsets = [event.t / turn for event in path.events if event.kind == "stick"]
            return sum(cycles + 0.5 <= onset < cycles + 1.5 for onset in onsets)
    return None


def from_rest(p: Parameters, cycles: int) -> Trajectory:
    """Simulate the first `cycles` cycles of the motion from rest at x = 0."""
    return simulate(
        p, t0=0, x0=0, v0=0, t_end=Fraction(cycles * (2 * pi / float(p.Omega))), accuracy=1e-6
    )


class Border(NamedTuple):
    """Two values of F/P between which the number of stops per cycle changes, their mean, and the
    numbers of stops.
    """

    low: float
    high: float
    middle: float
    below: int
    above: int


@cache
def find_border(low: Any, high: Any, Omega: Any, c: Any = 0) -> Border:
    """Return a border between two values of F/P with different numbers of stops per cycle, found by
    bisection.
    """

    def count(ratio: Fraction) -> int:
        found = stops(wall(1, Omega, c, P=1 / ratio))
        if found is None:
            raise SymoscError(f"the motion at F/P = {float(ratio)!r} does not settle")
        return found

    a = Fraction(low)
    b = Fraction(high)
    below = count(a)
    above = count(b)
    if below == above:
        raise ParameterError(
            "low, high", (str(low), str(high)), "must have different numbers of stops"
        )
    while b - a > 1e-8 * a:
        middle = (a + b) / 2
        found = count(middle)
        if found == below:
            a = middle
        else:
            b = middle
            above = found
    return Border(float(a), float(b), (float(a) + float(b)) / 2, below, above)


# --- the same borders by equations ---


def solve_border(Omega: Any, border: Border) -> tuple[Any, str]:
    """Return F/P at `border`, c = 0, by equations, and its kind: "graze" (a stop of length 0) or
    "birth" (a slide).
    """
    # With P = k = 1 half a cycle is n slides down. Each starts where a stop ends, x = cos(theta) + F, and ends at rest,
    # the last one at minus the first one's start: 2 n equations for n phases and n durations. The border is where
    # "graze": a slide comes to rest on the way without staying, v = x'' = 0: a stop of no length (with its time, two
    #     more equations for two more unknowns, the other one being F);
    # "birth": a stop lasts to theta = pi, where the drive just reaches what would move it, x = F - 1: a slide of no
    #     length.
    few, count = min(
        (border.low, border.below), (border.high, border.above), key=lambda side: side[1]
    )
    p = wall(Fraction(few), Omega)
    slides, candidates = _slides_near_border(p, count // 2)
    _, kind, j, at = min(candidates)
    n = len(slides)
    (_, v, a) = _slide(p)

    def equations(*z: Any) -> list[Any]:
        F = z[0]
        phases = z[1 : n + 1]
        times = z[n + 1 : 2 * n + 1]
        if kind == "birth":
            return [*_half_cycle(p, F, phases, times), _slide_ends(F, phases)[j] - F + 1]
        return [*_half_cycle(p, F, phases, times), v(phases[j], z[-1]), a(phases[j], z[-1])]

    guess = [few, *(phase for phase, _ in slides), *(time for _, time in slides)]
    return MP.findroot(equations, guess + [at] * (kind == "graze"))[0], kind


def solve_stop_positions(p: Parameters) -> list[Any]:
    """Solve for the positions of the stops in half a settled cycle, the highest first.

    M = k = P = 1, any c.
    """
    slides, _ = _slides_near_border(p, (stops(p) or 0) // 2)
    n = len(slides)
    F = number(p.mu1)
    guess = [*(phase for phase, _ in slides), *(time for _, time in slides)]
    return [
        MP.cos(phase) + F
        for phase in list(MP.findroot(lambda *z: _half_cycle(p, F, z[:n], z[n:]), guess))[:n]
    ]


def _half_cycle(p: Parameters, F: Any, phases: Any, times: Any) -> list[Any]:
    """Return the residuals of half a cycle: all are 0 if each slide ends at rest where the next one
    starts.
    """
    x, v, _ = _slide(p)
    rows = list(zip(phases, times, _slide_ends(F, phases), strict=True))
    at_rest = [v(phase, time) for phase, time, _ in rows]
    return at_rest + [x(phase, time, MP.cos(phase) + F) - end for phase, time, end in rows]


def _slide_ends(F: Any, phases: Any) -> list[Any]:
    """Return where each slide of half a cycle ends, which is where the next one starts: at x =
    cos(phase) + F.
    """
    starts = [MP.cos(phase) + F for phase in phases]
    return [*starts[1:], -starts[0]]


@cache
def _slide(p: Parameters) -> tuple[Callable[..., Any], ...]:
    """Return the functions x(theta_i, tau, x_i), v(theta_i, tau), a(theta_i, tau) of a slide from
    rest with a = 0.
    """
    flight = Flight(p)
    known = {solution.v_i: 0, solution.a_i: 0, solution.f0: 1}

    def function(expr: Any, phase: Any, time: Any, start: Any = 0) -> Any:
        return flight.value(expr, {solution.x_i: start, solution.theta_i: phase, tau: time})

    return tuple(partial(function, expr.xreplace(known)) for expr in solution.flow(flight.regime))


def _slides_near_border(p: Parameters, count: int) -> tuple[list[tuple[float, float]], list[Any]]:
    """Return phase, duration of `count` simulated slides, and candidates (distance, kind, slide,
    time) for a border.
    """
    path = from_rest(p, 22)
    late = [event for event in path.events if event.t > 40 * pi / float(p.Omega)]
    pairs = [(a, b) for a, b in pairwise(late) if a.kind == "slip"]
    targets = [start.target for start, _ in pairs]
    first = next(i for i, ways in enumerate(pairwise(targets), 1) if ways == ("Omega2", "Omega1"))
    slides = pairs[first : first + count]
    candidates = []
    for j, (start, end) in enumerate(slides):
        candidates.append((abs(end.x - float(p.mu1) + 1), "birth", j, 0.0))
        times = np.linspace(start.t, end.t, 2001)[20:-20]
        speeds = path(times)[1]
        peaks = np.flatnonzero((speeds[1:-1] > speeds[:-2]) & (speeds[1:-1] >= speeds[2:])) + 1
        candidates += [(-float(speeds[i]), "graze", j, float(times[i] - start.t)) for i in peaks]
    return [(float(p.Omega) * start.t, end.t - start.t) for start, end in slides], candidates


def largest_exponent(count: int, seed: int = 0) -> float:
    """Return the largest Lyapunov exponent found in `count` random oscillators (m = k = 1) over 60
    periods each.
    """
    dice = random.Random(seed)
    largest = -np.inf
    for _ in range(count):
        F = f"{dice.uniform(0.01, 1):.3f}"
        Omega = f"{dice.uniform(0.05, 3):.3f}"
        p = wall(F, Omega, f"{dice.choice((0, dice.uniform(0, 1))):.3f}")
        found = sensitivities(p, "x0", t0=0, x0=dice.uniform(-2, 2), v0=0, t_end="60T")
        largest = max(largest, float(found.lyapunov[0]))
    return largest


# --- the tables ---

#: (c, F, Omega): under-, critically and overdamped too.
AMPLITUDES = (
    ("0", "0.4", "1.5"), ("0.2", "0.4", "1.5"), ("0.1", "0.25", "0.6"), ("2", "0.1", "0.8"), ("3", "0.1", "0.7")
)  # fmt: skip
DAMPED = [
    (rf"$c = {c}$, $F = {F}$, $\Omega = {Omega}$", wall(F, Omega, c)) for c, F, Omega in AMPLITUDES
]
#: (c, Omega), and two values of F/P between which the motions without stops end.
BORDERS = (
    ("0", "1.5", "0.646", "0.647"), ("0", "0.8", "0.817", "0.818"), ("0", "0.3", "0.086", "0.087"),
    ("0.2", "1.5", "0.598", "0.599")
)  # fmt: skip
#: Omega, and two values of F/P between which the number of stops per cycle changes.
COUNTS = (
    ("0.1", "0.120", "0.121"), ("0.1", "0.373", "0.374"), ("0.1", "0.505", "0.506"), ("0.1", "0.804", "0.805"),
    ("0.04", "0.263", "0.264"), ("0.04", "0.379", "0.380"), ("0.04", "0.439", "0.440"), ("0.04", "0.457", "0.458")
)  # fmt: skip
#: n of Omega = 1/(2 n), F, and the middles of the turning points.
CONTINUA = ((1, "0.1", ("-0.2", "0", "0.1")), (2, "0.02", ("0", "0.04")))
#: c, and where to look for the point at which P32 turns at a peak of the drive and begins to stick.
MEETINGS = (("0.1", (0.4759, 0.2483)), ("0.001", (0.4998, 0.3324)))
#: A mass that may rest on belt 1, with damping.
RESTING = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=10, mu1=1, mu2="1/10", FN=1)


class Value(NamedTuple):
    """A number computed twice, by a formula and by running the package."""

    name: str  # its letter in LaTeX
    case: str  # the parameters in LaTeX; those that are not named are 1 (m, k, P, F_N) or 0 (c)
    formula: Any
    package: Any
    decimals: int = 12  # as many as are worth printing
    tolerance: float = 1e-12  # allowed relative difference
    note: str = ""  # what else was seen in running the package

    @property
    def difference(self) -> Any:
        """Formula minus package, relative to the formula's value if that is not 0."""
        formula = number(self.formula)
        return (formula - number(self.package)) / (abs(formula) or 1)


#: What is compared, in the order of the page: title, the sources' keys, and what computes the rows.
TABLES: dict[str, tuple[str, tuple[str, ...], Callable[[], Iterator[Value]]]] = {}


def _compared(key: str, title: str, *sources: str) -> Callable[..., Any]:
    """Return a decorator that registers a function, which yields a table's rows, with key, title
    and `sources`.
    """
    return lambda rows: TABLES.setdefault(key, (title, sources, rows))


#: What holds for all rows of a table, by the letters of the chapter; the rows are computed with it,
#: and the captions say it.
GIVEN = {
    "ends": {"c": "0.1", "P": "1.5", "F": "1"},
    "decay": {"x": "0.95"},
    "decrements": {"x": "1.5", "c": "0.2", "F": "0.1", "P": "0"},
    "slow": {"F": "0.5"},
    "cycles": {"c": "0.1", "F": "0.5"},
    "rests": {"t": "60"},
}


@_compared("amplitude", "Amplitude of the motion without stops", "denhartog1930", "denhartog1931")
def _amplitudes() -> Iterator[Value]:
    for case, p in DAMPED:
        yield Value(
            "x_0", case, Formulas(p).amplitude, max(point.x for point in slide_orbit(p, 30).points)
        )


@_compared("stability", "Its multipliers", "shaw1986")
def _multipliers() -> Iterator[Value]:
    """Yield sum and product of the multipliers of the motion without stops (P32), except products
    too small to show.
    """
    for case, p in DAMPED:
        one, other = slide_orbit(p, 30).multipliers
        total, product = Formulas(p).trace_and_determinant()
        yield Value(r"\rho_1 + \rho_2", case, total, (one + other).real)
        if abs(product) > 1e-4:
            yield Value(r"\rho_1 \rho_2", case, product, (one * other).real)


def _border(case: str, formula: Any, border: Border) -> Value:
    """Return a table row for F/P at a border: its value by formula, and by bisection of
    simulations.
    """
    return Value(
        "F/P",
        case,
        formula,
        border.middle,
        7,
        1e-7,
        f"{border.below} stops below, {border.above} above",
    )


@_compared("border", "Where motions without stops end", "denhartog1930", "hongliu2000")
def _borders() -> Iterator[Value]:
    for c, Omega, low, high in BORDERS:
        border = find_border(Fraction(low), Fraction(high), Omega, c)
        yield _border(
            rf"$c = {c}$, $\Omega = {Omega}$",
            Formulas(wall(1, Omega, c)).largest_force_ratio(),
            border,
        )


@_compared("points", "Where borders meet", "guardia2010", "kowalczyk2008")
def _points() -> Iterator[Value]:
    """Yield the points at which borders meet, without and with damping."""
    for n in (1, 2, 3):
        case = rf"$A_{n}$: $\Omega = 1/{2 * n}$"
        formula = Fraction(1, 4 * n * n - 1)
        yield Value("F/P", case, formula, last_friction(n), 7, 1e-7)
    near = find_border(Fraction("0.031"), Fraction("0.033"), "0.32").middle
    yield Value(
        "F/P",
        r"near $B_1$: $\Omega = 0.32$",
        Formulas(wall(1, "0.32")).largest_force_ratio(),
        near,
        7,
        1e-7,
    )
    for c, guess in MEETINGS:
        pairs = zip(meeting_point(c, guess), meeting_point_by_running(c, guess), strict=True)
        for name, (formula, run) in zip((r"\Omega", "F"), pairs, strict=True):
            yield Value(name, rf"$c = {c}$", formula, run, 10, 1e-10)


@_compared("ends", "The ends of a branch", "iklodi2024")
def _ends() -> Iterator[Value]:
    """Yield the frequencies at which the branch of motions without stops ends, and its highest
    points there.
    """
    c, P, F = GIVEN["ends"].values()
    for end in continue_orbit(wall(F, 1, c, P=P), "P32", "Omega", ("0.6", "1.5")).ends:
        Omega, amplitude = end_without_stops(c, P, end.value)
        yield Value(r"\Omega", "", Omega, end.value, 12, 1e-12, end.kind)
        yield Value("x_0", "there", amplitude, max(point.x for point in end.points), 10, 1e-10)


@_compared("resonance", "Growth per cycle at resonance", "denhartog1930", "butikov2015")
def _growth() -> Iterator[Value]:
    """Yield the rise of the highest point per cycle by formula, and the simulated rise that is
    farthest from it.
    """
    for F, P in (("0.5", "1"), ("0.3", "0.5")):
        formula = MP.pi * MP.mpf(P) - 4 * MP.mpf(F)
        rises = resonance_growth(F, P)
        _, worst = max((abs(MP.mpf(rise) - formula), rise) for rise in rises)
        yield Value(
            r"\Delta x", rf"$P = {P}$, $F = {F}$", formula, worst, note=f"{len(rises)} cycles"
        )


@_compared("decay", "Turning points of a free motion", "denhartog1930", "butikov2015")
def _decay() -> Iterator[Value]:
    """Yield the turning points of a free motion that starts at rest.

    At the last one the mass stays.
    """
    F = Fraction(1, 10)
    formula = Fraction(GIVEN["decay"]["x"])
    for i, x in enumerate(_turning_points(wall(F, 1, P=0), formula, 40), 1):
        formula = -formula + (2 * F if formula > 0 else -2 * F)
        yield Value(f"x_{i}", "$F = 0.1$", formula, x)


@_compared("decrements", "Turning points of a free motion with a damper", "feeny1996")
def _decrements() -> Iterator[Value]:
    start, c, F, P = GIVEN["decrements"].values()
    p = wall(F, 1, c, P=P)
    x = number(Fraction(start))
    h = number(p.c) / 2
    x_f = number(p.mu1)
    left = MP.exp(-MP.pi * h / MP.sqrt(1 - h * h))
    for i, event in enumerate(simulate(p, t0=0, x0=start, v0=0, t_end=40).events, 1):
        x = -left * x + (1 + left) * MP.sign(x) * x_f
        yield Value(f"x_{i}", "", x, event.x)


@_compared("stops", "Where the number of stops per cycle changes", "hongliu2000")
def _counts() -> Iterator[Value]:
    for Omega, low, high in COUNTS:
        border = find_border(Fraction(low), Fraction(high), Omega)
        yield _border(rf"$\Omega = {Omega}$", solve_border(Omega, border)[0], border)


@_compared("slow", "Slow drives", "papangelo2015")
def _slow() -> Iterator[Value]:
    """Yield the highest points of slowly driven motions."""
    for c, Omega in (("0", "0.2"), ("0", "0.1"), ("0", "0.05"), ("2", "0.02")):
        p = wall(GIVEN["slow"]["F"], Omega, c)
        highest = max(
            event.x for event in from_rest(p, 60).events if event.t > 58 * (2 * pi / float(p.Omega))
        )
        formula = max(map(abs, solve_stop_positions(p)))
        note = f"{stops(p)} stops per cycle"
        yield Value(r"x_{\max}", rf"$c = {c}$, $\Omega = {Omega}$", formula, highest, note=note)


@_compared("cycles", "Two limit cycles", "murari2026")
def _cycles() -> Iterator[Value]:
    """Yield the positions at which the mass stops in two limit cycles, by their equations and by
    simulation.
    """
    for Omega in ("0.3", "0.15"):
        p = wall(GIVEN["cycles"]["F"], Omega, GIVEN["cycles"]["c"])
        run = sorted(
            {round(x, 12): x for _, x in find_orbit(p).points if x > 0}.values(), reverse=True
        )
        found = sorted((abs(x) for x in solve_stop_positions(p)), reverse=True)
        for n, (formula, x) in enumerate(zip(found, run, strict=True), 1):
            yield Value(
                rf"\pm x_{n}",
                rf"$\Omega = {Omega}$",
                formula,
                x,
                note=f"{stops(p)} stops per cycle",
            )


@_compared("continuum", r"Motions around a middle $\bar{x}$", "csernak2007", "butikov2015")
def _continuum() -> Iterator[Value]:
    """Yield turning points and the second multiplier of some orbits that fill a continuum: Omega =
    1/(2 n), c = 0.
    """
    for n, F, middles in CONTINUA:
        half = _free_amplitude(n)
        x_f = Fraction(F)
        case = rf"$\Omega = 1/{2 * n}$, $F = {F}$"
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


@_compared("inversion", "Where friction begins to amplify", "marino2019", "marino2020")
def _inversions() -> Iterator[Value]:
    """Yield the frequency ratio beyond which friction amplifies the absolute motion, base and wall
    moving together.
    """
    for F in ("0.1", "0.5", "1"):
        formula, run = (
            inversion(F, height) for height in (transmissibility, transmissibility_by_running)
        )
        yield Value("r", f"$F = {F}$", formula, run, 10, 1e-10)


@_compared("rests", "Rest positions on a belt at rest")
def _rests() -> Iterator[Value]:
    """Yield the ends of the interval of rests, and the positions at t = 60 of motions that start
    inside it.
    """
    p = RESTING
    ends = rest_positions(RESTING, 1)
    assert ends is not None
    yield Value("x_-", "", (p.A(2) + abs(p.B0)) / p.k, ends[0])
    yield Value("x_+", "", (p.A(1) - abs(p.B0)) / p.k, ends[1])
    t = int(GIVEN["rests"]["t"])
    for x in map(Fraction, ("-3/5", "0", "1/2")):
        motion = simulate(p, t0=0, x0=x, v0=0, t_end=t)
        yield Value(f"x({t})", f"from ${show(x)}$", x, float(motion(t)[0]))


@cache
def table(key: str) -> tuple[Value, ...]:
    """Return the rows of the table with a key: numbers, each computed by a formula and by this
    package.
    """
    return tuple(TABLES[key][2]())
