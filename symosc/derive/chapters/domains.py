"""The solution in one domain, its closed forms in every damping regime, and how the regimes join."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import sympy as sp

from symosc.derive.latex import latex, named
from symosc.derive.scope import Scope
from symosc.derive.steps import Exact, Heading, Prose, Solves, equation
from symosc.symbolic import solution
from symosc.symbolic.solution import BASIS, E0, E1, E2, I2, R2, Omega, a_i, cm, f0, tau, theta_i, v_i, w0sq, x_i

TITLE = "The solution in one domain"

#: What D = d^2/dtau^2 + (c/m) d/dtau + k/m makes of each basis function, and how each one starts.
RESPONSES = {
    E0: (sp.Integer(0), 1, -cm),
    E1: (sp.Integer(0), 0, 1),
    E2: (sp.Integer(1), 0, 0),
    R2: (sp.cos(Omega * tau), 0, 0),
    I2: (sp.sin(Omega * tau), 0, 0),
}

REGIME_WORDS = {
    "underdamped": r"Underdamped, $c^2 < 4km$",
    "critical": r"Critically damped, $c^2 = 4km$",
    "overdamped": r"Overdamped, $c^2 > 4km$",
    "undamped": r"Undamped, $c = 0$, away from resonance",
    "resonance": r"Undamped resonance, $c = 0$, $\Omega^2 = k/m$",
    "no spring": r"No spring, $k = 0$, $c > 0$",
    "free": r"Free, $c = k = 0$",
}


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"In a domain, $m\ddot{x} + c\dot{x} + kx = A_\alpha + B_0\cos\Omega t$ with $x = x_i$, $\dot{x} = "
        r"\dot{x}_i$ at "
        r"$t_i$. Let $D = d^2/d\tau^2 + (c/m)\, d/d\tau + k/m$ with $\tau = t - t_i$, let $\theta_i = \Omega t_i$, and "
        r"let $S$ be the impulse response: $D S = 0$, $S(0) = 0$, $\dot{S}(0) = 1$. The motion is made of five "
        r"functions "
        r"of $\tau$: $E_1 = S$, $E_0 = \dot{S}$, $E_2 = \int_0^\tau S(u)\,du$, and "
        r"$R_2 + i I_2 = \int_0^\tau S(u)\, e^{i\Omega(\tau - u)}\,du$."
    )
    yield Heading("What holds in every regime")
    yield from _rates()
    yield from _relations()
    yield from _flow()
    for regime in scope.regimes:
        yield from _regime(regime, scope)
    if scope.scene is None:
        yield from _joins()


def _rates() -> Iterator[Any]:
    reason = r"The equation of $S$ and Leibniz' rule give the derivatives"
    generic = _generic()
    for symbol, rate in solution.rates().items():
        name = named(rf"\dot{{{symbol.name[0]}}}_{symbol.name[1]}")
        meaning = generic | {name: generic[symbol].diff(tau)}
        yield equation(name, rate, reason, Exact(meaning, _modes))
        reason = ""


def _generic() -> dict[Any, Any]:
    """Return the basis functions for two different characteristic roots, as divided differences of exp(z tau)."""
    mean, half = sp.symbols("r q", positive=True)
    roots = -mean + half, -mean - half
    wave, conjugate = (solution.divided_difference(z, *roots) for z in (sp.I * Omega, -sp.I * Omega))
    S = solution.divided_difference(*roots)
    closed = (
        S.diff(tau),
        S,
        solution.divided_difference(sp.Integer(0), *roots),
        (wave + conjugate) / 2,
        (wave - conjugate) / (2 * sp.I),
    )
    return dict(zip(BASIS, closed, strict=True)) | {cm: 2 * mean, w0sq: mean**2 - half**2}


def _modes(expr: Any) -> Any:
    return solution.collect_modes(sp.expand_trig(expr))


def _relations() -> Iterator[Any]:
    step, real, imaginary = solution.relations()
    generic = _generic()
    reason = r"and since $D E_2 = 1$ and $D(R_2 + i I_2) = e^{i\Omega\tau}$, whatever the damping,"
    for relation, value in ((step, sp.Integer(1)), (real, sp.cos(Omega * tau)), (imaginary, sp.sin(Omega * tau))):
        left = sp.collect(sp.expand(relation + value), [R2, I2])
        # Solved for the force, so that the long side can be broken.
        yield equation(value, left, reason, Exact(generic, _modes))
        reason = ""


def _flow() -> Iterator[Any]:
    flow = solution.flow()
    force = solution._force_at_start() + f0 * sp.cos(theta_i + Omega * tau)
    yield Heading("The motion")
    position, velocity, acceleration = named(r"x(\tau)"), named(r"\dot{x}(\tau)"), named(r"\ddot{x}(\tau)")
    yield equation(
        position,
        flow.x,
        r"Variation of constants, with $A_\alpha$ eliminated in favour of the acceleration "
        r"$\ddot{x}_i = F^{(\alpha)}(x_i, \dot{x}_i, t_i)$ at the start, so that friction enters only there:",
        Solves(force, x_i, v_i, general=True),
    )
    reason = r"Differentiated, and shortened by the relations above,"
    meaning = {velocity: solution.time_derivative(flow.x)}
    yield equation(velocity, flow.v, reason, Exact(meaning, solution.use_relations, independent=False))
    meaning = {acceleration: solution.time_derivative(flow.v)}
    yield equation(acceleration, flow.a, "", Exact(meaning, solution.use_relations, independent=False))
    start = named(r"\ddot{x}_i")
    newton = sp.solve(solution.acceleration(x_i, v_i, theta_i) - a_i, a_i)[0]
    yield equation(start, solution.acceleration(x_i, v_i, theta_i), "where", Exact({start: newton}, sp.expand))


def _regime(regime: solution.Regime, scope: Scope) -> Iterator[Any]:
    yield Heading(REGIME_WORDS[regime.name])
    parameters = regime.parameters()
    reason = "The letters of this regime are"
    if scope.scene is None:
        for letter, value in regime.letters.items():
            yield equation(letter, value, reason, Exact({letter: _letters()[letter]}, sp.simplify))
            reason = ""
    centre = latex(regime.centre) if regime.centre != 0 else ""
    reason = r"The divided differences of $z \mapsto e^{z\tau}$ over the characteristic roots "
    reason += rf"${centre}\pm {latex(regime.offset)}$ are"
    if regime.offset == 0:
        reason = rf"With the double root ${latex(regime.centre)}$,"
    for symbol, closed in regime.basis().items():
        force, start, rate = RESPONSES[symbol]
        solves = Solves(force, sp.Integer(start), sp.sympify(rate).xreplace(parameters), *parameters.values())
        yield equation(symbol, tidy(closed), reason, solves)
        reason = ""


def _letters() -> dict[Any, Any]:
    """Return the letters of the regimes from the coefficients and the discriminant of m z^2 + c z + k."""
    z = sp.Symbol("z")
    polynomial = sp.Poly(solution.m * z**2 + solution.c * z + solution.k, z)
    a, b, _ = polynomial.all_coeffs()
    disc = polynomial.discriminant()
    roots = {solution.h: b / (2 * a), solution.eta: sp.sqrt(disc) / (2 * a), solution.omega_d: sp.sqrt(-disc) / (2 * a)}
    return roots | {solution.omega_0: sp.sqrt(-disc.subs(solution.c, 0)) / (2 * a)}


_MODES = sp.sin, sp.cos, sp.sinh, sp.cosh


def _times(wave: Any, row: Any) -> Any:
    """Return the product, with the sign of a sum of negative terms in front."""
    if wave != 1 and row.is_Add and all(term.could_extract_minus_sign() for term in row.args):
        return -wave * sp.Add(*(-term for term in row.args))
    return wave * row


def tidy(expr: Any) -> Any:
    """Write a closed form over one common denominator with its modes collected, so that it prints short."""
    waves = sorted(expr.atoms(sp.exp), key=sp.default_sort_key)
    stand_ins = [sp.Dummy() for _ in waves]
    above, below = sp.fraction(sp.together(expr.xreplace(dict(zip(waves, stand_ins, strict=True)))))
    above, trig = sp.expand(above), sorted(above.atoms(*_MODES), key=sp.default_sort_key)
    plain = above.xreplace(dict.fromkeys(stand_ins, sp.Integer(0)))
    rows = {sp.Integer(1): plain} | {wave: above.coeff(letter) for letter, wave in zip(stand_ins, waves, strict=True)}
    above = sp.Add(*(_times(wave, sp.collect(row, trig, sp.factor)) for wave, row in rows.items()))
    return sp.Mul(above, 1 / sp.factor(below), evaluate=False) if below != 1 and above.is_Add else above / below


@sp.cacheit
def _limits(join: solution.Join) -> dict[Any, Any]:
    source = solution.REGIMES[join.source].basis()
    # sympy's limits of cosh and sinh can be wrong, those of exp are not.
    paths = {f: expr.rewrite([sp.cosh, sp.sinh], sp.exp).xreplace(join.path) for f, expr in source.items()}
    return {f: sp.limit(expr, join.letter, 0) for f, expr in paths.items()}


def _joins() -> Iterator[Any]:
    yield Heading("The regimes are limits of each other")
    yield Prose(
        r"Each border of two regimes is approached along a path; in the limit the five functions of one turn "
        r"into those "
        r"of the other. $E_0 = \dot{E}_1$ needs no line of its own."
    )
    for join in solution.JOINS:
        target = solution.REGIMES[join.target].basis()
        path = ", ".join(rf"${latex(name)} \to {latex(value)}$" for name, value in join.path.items())
        along = f" along {path}" if path else ""
        reason = rf"From \emph{{{join.source}}} to \emph{{{join.target}}}{along}:"
        for symbol in BASIS[1:]:
            name = named(rf"\lim_{{{latex(join.letter)}\to 0}} {latex(symbol)}")
            check = Exact({name: partial(_limit, join, symbol)}, sp.simplify)
            yield equation(name, tidy(target[symbol]), reason, check)
            reason = ""


def _limit(join: solution.Join, symbol: Any) -> Any:
    return _limits(join)[symbol]
