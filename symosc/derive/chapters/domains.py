"""The solution in one domain, its closed forms in every damping regime, and how the regimes join."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.blocks import Table, block, proof
from symosc.derive.latex import latex, named
from symosc.derive.paper_form import C1, C2, paper_form
from symosc.derive.scope import Scope
from symosc.derive.steps import Exact, Heading, Near, Prose, Solves, equation, fact, modes
from symosc.symbolic import solution
from symosc.symbolic.solution import BASIS, E0, E1, E2, I2, R2, Omega, a_i, cm, f0, tau, theta_i, v_i, w0sq, x_i

TITLE = "The motion in one domain"
KAPPA, DELTA = named(r"\kappa"), named(r"\Delta", positive=True)
NORMS = {KAPPA: w0sq - Omega**2, DELTA: (w0sq - Omega**2) ** 2 + (cm * Omega) ** 2}

#: What L makes of each basis function, and how each one starts.
RESPONSES = {
    E0: (sp.Integer(0), 1, -cm),
    E1: (sp.Integer(0), 0, 1),
    E2: (sp.Integer(1), 0, 0),
    R2: (sp.cos(Omega * tau), 0, 0),
    I2: (sp.sin(Omega * tau), 0, 0),
}

#: Name and condition of each regime.
REGIME_WORDS = {
    "underdamped": ("underdamped", "$0 < c^2 < 4km$"),
    "critical": ("critically damped", "$c^2 = 4km > 0$"),
    "overdamped": ("overdamped", "$c^2 > 4km > 0$"),
    "undamped": ("undamped", r"$c = 0$, $k \ne m\Omega^2$"),
    "resonance": ("undamped resonance", r"$c = 0$, $k = m\Omega^2$"),
    "no spring": ("no spring", "$k = 0 < c$"),
    "free": ("free", "$c = k = 0$"),
}


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _functions()
    yield from _flow()
    yield from _paper_form(scope)
    if scope.scene is None:
        yield from _table(scope)
        yield from _joins()
    else:
        yield from _scene_regime(scope.regimes[0])


def _functions() -> Iterator[Any]:
    yield Heading("Five functions that hold every motion")
    yield from block(
        "definition",
        r"With $\tau = t - t_i$ the time since the start at $t_i$, let "
        r"$L = d^2/d\tau^2 + (c/m)\, d/d\tau + k/m$. Let $E_1(\tau)$ be the response to "
        r"an impulse: $L E_1 = 0$, $E_1(0) = 0$, $\dot{E}_1(0) = 1$. Further let $E_0 = \dot{E}_1$, "
        r"$E_2(\tau) = \int_0^\tau E_1(u)\,du$ and "
        r"$R_2(\tau) + i I_2(\tau) = \int_0^\tau E_1(u)\, e^{i\Omega(\tau - u)}\,du$.",
        title="basis functions",
        label="thm:domains-basis",
    )
    generic = generic_basis()
    rates, reason = [], r"The basis functions have the derivatives"
    for symbol, rate in solution.rates().items():
        name = named(rf"\dot{{{symbol.name[0]}}}_{symbol.name[1]}")
        check = Exact(generic | {name: generic[symbol].diff(tau)}, modes)
        rates.append(equation(name, rate, reason, check, label=f"domains-rate-{symbol.name}"))
        reason = ""
    reason = r"and obey, whatever the damping,"
    laws = []
    names = ("step", "cosine", "sine")
    values = (sp.Integer(1), sp.cos(Omega * tau), sp.sin(Omega * tau))
    for name, relation, value in zip(names, solution.relations(), values, strict=True):
        left = sp.collect(sp.expand(relation + value), [R2, I2])
        laws.append(equation(value, left, reason, Exact(generic, modes), label=f"domains-{name}"))
        reason = ""
    yield from block("lemma", *rates, *laws, title="rates and relations", label="thm:domains-relations")
    yield from proof(
        r"The rates follow from $L E_1 = 0$ and Leibniz' rule. The relations are $L E_2 = 1$ and "
        r"$L(R_2 + i I_2) = e^{i\Omega\tau}$, with all derivatives replaced by the rates: both sides have the same "
        r"rates, and are equal at $\tau = 0$."
    )
    yield from solved_functions(generic)


def solved_functions(generic: dict[Any, Any]) -> Iterator[Any]:
    """Yield the corollary that E_0 and E_1 give the other functions."""
    still = sp.cos(Omega * tau) - E0 - cm * E1
    swing = sp.sin(Omega * tau) - Omega * E1
    meaning = generic | {name: value.xreplace(generic) for name, value in NORMS.items()}
    yield from block(
        "corollary",
        r"$E_0$ and $E_1$ give the other three: for $k > 0$",
        equation(E2, (1 - E0 - cm * E1) / w0sq, "", Exact(generic, modes), label="domains-E2"),
        equation(KAPPA, NORMS[KAPPA], "and with", Exact(NORMS), label="domains-kappa"),
        equation(DELTA, KAPPA**2 + (cm * Omega) ** 2, "", Exact(NORMS), label="domains-Delta"),
        equation(
            R2,
            (KAPPA * still + cm * Omega * swing) / DELTA,
            r"wherever $\Delta > 0$, that is everywhere but at undamped resonance,",
            Exact(meaning, modes),
            label="domains-R2",
        ),
        equation(I2, (KAPPA * swing - cm * Omega * still) / DELTA, "", Exact(meaning, modes), label="domains-I2"),
        label="thm:domains-solved",
    )
    yield from proof(
        r"\eqref{eq:domains-step} is solved for $E_2$; \eqref{eq:domains-cosine} and \eqref{eq:domains-sine} are two "
        r"linear equations for $R_2$ and $I_2$ with the determinant $\Delta$."
    )


def generic_basis() -> dict[Any, Any]:
    """Return the basis functions for two different characteristic roots, as divided differences of exp(z tau)."""
    mean, half = sp.symbols("r q", positive=True)
    roots = -mean + half, -mean - half
    wave, conjugate = (solution.divided_difference(z, *roots) for z in (sp.I * Omega, -sp.I * Omega))
    impulse = solution.divided_difference(*roots)
    closed = (
        impulse.diff(tau),
        impulse,
        solution.divided_difference(sp.Integer(0), *roots),
        (wave + conjugate) / 2,
        (wave - conjugate) / (2 * sp.I),
    )
    return dict(zip(BASIS, closed, strict=True)) | {cm: 2 * mean, w0sq: mean**2 - half**2}


def _flow() -> Iterator[Any]:
    flow = solution.flow()
    force = solution._force_at_start() + f0 * sp.cos(theta_i + Omega * tau)
    position, velocity, acceleration = named(r"x(\tau)"), named(r"\dot{x}(\tau)"), named(r"\ddot{x}(\tau)")
    start = named(r"\ddot{x}_i")
    newton = sp.solve(solution.acceleration(x_i, v_i, theta_i) - a_i, a_i)[0]
    by_v, by_a = ({name: solution.time_derivative(expr)} for name, expr in ((velocity, flow.x), (acceleration, flow.v)))
    yield Heading("The motion")
    yield from block(
        "theorem",
        r"A motion that starts in $\Omega_\alpha$, or goes into it, at $t_i$ with the phase $\theta_i = \Omega t_i$, "
        r"the position $x_i$ and the velocity $\dot{x}_i$ is, as long as it stays in $\Omega_\alpha$,",
        equation(position, flow.x, "", Solves(force, x_i, v_i, general=True), label="domains-x"),
        equation(velocity, flow.v, "", Exact(by_v, solution.use_relations, independent=False), label="domains-v"),
        equation(acceleration, flow.a, "", Exact(by_a, solution.use_relations, independent=False), label="domains-a"),
        equation(
            start,
            solution.acceleration(x_i, v_i, theta_i),
            r"where the acceleration at the start is",
            Exact({start: newton}, sp.expand),
            label="domains-start",
        ),
        r"This holds in every regime of damping and at resonance.",
        title="the motion in a domain",
        label="thm:domains-flow",
    )
    yield from proof(
        r"$L x = (A_\alpha + B_0\cos\theta)/m$ by \eqref{eq:motion-domain}. Variation of constants gives $x$ as a "
        r"combination of $E_0$, $E_1$, $E_2$, $R_2$ and $I_2$. Then $A_\alpha$ is eliminated in favour of "
        r"$\ddot{x}_i$, so that friction enters only there, and the derivatives are shortened by "
        r"Lemma~\ref{thm:domains-relations}. That \eqref{eq:domains-x} solves the equation with the right start was "
        r"checked with the relations alone."
    )


def _paper_form(scope: Scope) -> Iterator[Any]:
    name = "underdamped" if scope.scene is None else scope.regimes[0].name
    regime = solution.REGIMES[name]
    form = paper_form(regime)
    yield Heading("The same motion as papers print it")
    first, second = REGIME_WORDS[name]
    reason = (
        r"The form with constants of integration, for $c^2 < 4km$ away from undamped resonance, with $h = c/(2m)$ and "
        r"$\omega_d = \sqrt{k/m - h^2}$, is"
        if name == "underdamped"
        else rf"The form with constants of integration, in the regime \emph{{{first}}} ({second}), is"
    )
    yield equation(named(r"x(\tau)"), form.x, reason, form.check, label="domains-paper")
    reason = r"with"
    for letter, value in form.constants.items():
        others = {name: other for name, other in form.constants.items() if name != letter}
        check = Exact(constant_meaning(letter, form, regime, others), sp.simplify)
        yield equation(letter, value, reason, check, label=f"domains-{letter.name.replace('_', '')}")
        reason = ""
    yield Prose(
        r"It is the same function as \eqref{eq:domains-x}, since both solve the same problem. It needs a case for "
        r"every regime, and loses digits near the borders of the regimes and for short times, where "
        r"\eqref{eq:domains-x} loses none if the basis functions are computed as divided differences "
        r"\cite{mccurdy1984}."
    )


def constant_meaning(letter: Any, form: Any, regime: Any, others: dict[Any, Any]) -> dict[Any, Any]:
    """Return what a constant is by what it has to do: fit the start, or the drive."""
    x, v = form.x, form.x.diff(tau)
    start = {tau: sp.Integer(0)}
    if letter in (C1, C2):
        wanted = (x.subs(start) - x_i, v.subs(start) - v_i)
        found = sp.solve(wanted, [C1, C2], dict=True)[0]
        return {letter: found[letter], **({C1: found[C1]} if letter == C2 else {})}
    values = {letter: form.check.meaning[letter], **{name: form.check.meaning[name] for name in others if name != C1}}
    back = dict(form.check.back)
    return {letter: values[letter]} | back


def _table(scope: Scope) -> Iterator[Any]:
    yield Heading("The regimes of damping")
    rows = []
    for regime in scope.regimes:
        parameters, closed = regime.parameters(), regime.basis()
        cells = []
        for symbol in (E1, E0):
            force, start, rate = RESPONSES[symbol]
            solves = Solves(force, sp.Integer(start), sp.sympify(rate).xreplace(parameters), *parameters.values())
            cells.append(equation(symbol, tidy(closed[symbol]), "", solves))
        centre = latex(regime.centre) if regime.centre != 0 else ""
        roots = rf"${centre} \pm {latex(regime.offset)}$" if regime.offset != 0 else f"${centre or 0}$, double"
        rows.append((*REGIME_WORDS[regime.name], roots, *cells))
    letters = {solution.h: "h", solution.omega_d: "omega_d", solution.eta: "eta", solution.omega_0: "omega_0"}
    values = {name: value for regime in scope.regimes for name, value in regime.letters.items()}
    reason = r"In terms of the roots of $m z^2 + c z + k$ the basis functions are elementary. With the letters"
    for letter, name in letters.items():
        yield equation(
            letter,
            values[letter],
            reason,
            Exact({letter: true_letters()[letter]}, sp.simplify),
            label=f"domains-{name}",
        )
        reason = ""
    yield Prose(
        r"Table~\ref{tab:domains-regimes} gives $E_1$ and $E_0$; the other functions follow by "
        r"Corollary~\ref{thm:domains-solved}."
    )
    yield Table(
        "tab:domains-regimes",
        r"The regimes of damping: the roots of $m z^2 + c z + k$, and the two functions that the others follow from.",
        ("regime", "condition", "roots", "$E_1$", "$E_0$"),
        tuple(rows),
    )
    reason = r"Three functions are left over, where the corollary divides by 0. Without a spring,"
    for name, symbol, words in (
        ("no spring", E2, r"for $c > 0$,"),
        ("free", E2, r"for $c = 0$."),
        ("resonance", R2, ""),
        ("resonance", I2, ""),
    ):
        regime = solution.REGIMES[name]
        parameters = regime.parameters()
        force, start, rate = RESPONSES[symbol]
        solves = Solves(force, sp.Integer(start), sp.sympify(rate), *parameters.values())
        if symbol == R2:
            reason = r"At undamped resonance"
        label = f"domains-{name.replace(' ', '-')}-{symbol.name}"
        yield equation(symbol, tidy(regime.basis()[symbol]), reason, solves, words, label)
        reason = ""


def true_letters() -> dict[Any, Any]:
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


def _scene_regime(regime: solution.Regime) -> Iterator[Any]:
    yield Heading("The basis functions of this scene")
    parameters = regime.parameters()
    reason = rf"The regime is \emph{{{REGIME_WORDS[regime.name][0]}}} ({REGIME_WORDS[regime.name][1]}). There"
    for symbol, closed in regime.basis().items():
        force, start, rate = RESPONSES[symbol]
        solves = Solves(force, sp.Integer(start), sp.sympify(rate).xreplace(parameters), *parameters.values())
        yield equation(symbol, tidy(closed), reason, solves, label=f"domains-scene-{symbol.name}")
        reason = ""


def _joins() -> Iterator[Any]:
    yield Heading("The regimes are limits of each other")
    yield from block(
        "theorem",
        r"For each $\tau$ the basis functions are entire functions of $c/m$, $k/m$ and $\Omega$. So at each border of "
        r"two regimes the functions of one turn into those of the other.",
        title="one motion, no cases",
        label="thm:domains-entire",
    )
    yield from proof(
        r"$E_1$ solves a linear equation whose coefficients are polynomials of $c/m$ and $k/m$, with a fixed start; "
        r"such a solution is an entire function of the coefficients, and so are $E_0$ and the integrals $E_2$ and "
        r"$R_2 + i I_2$, the last one also of $\Omega$. Table~\ref{tab:domains-joins} goes over the borders: along "
        r"each path $c/m$ and $k/m$ of one regime tend to those of the other."
    )
    rows = []
    for join in solution.JOINS:
        source, target = (solution.REGIMES[name].parameters() for name in (join.source, join.target))
        path = ", ".join(_path(name, value) for name, value in join.path.items())
        names = named(r"c/m"), named(r"k/m")
        cells = []
        for name, letter in zip(names, (cm, w0sq), strict=True):
            value = sp.limit(source[letter].xreplace(join.path), join.letter, 0)
            cells.append(equation(name, target[letter], "", Exact({name: value}, sp.simplify)))
        words = [REGIME_WORDS[name][0] for name in (join.source, join.target)]
        rows.append((*words, rf"${latex(join.letter)} \to 0$", path, *cells))
    yield Table(
        "tab:domains-joins",
        r"The borders of the regimes: how each is approached, and to what $c/m$ and $k/m$ tend there.",
        ("from", "to", "with", "where", r"$c/m \to$", r"$k/m \to$"),
        tuple(rows),
        tuple(_sampled(join) for join in solution.JOINS),
    )


def _path(letter: Any, value: Any) -> str:
    """Return what a letter becomes on the way to a border, as LaTeX: an arrow where its old value is in the new one."""
    return rf"${latex(letter)} {chr(92) + 'mapsto' if letter in value.free_symbols else '='} {latex(value)}$"


def _sampled(join: solution.Join) -> Any:
    """Return a check of one function near a border: its value there and on the border agree to first order."""
    source, target = solution.REGIMES[join.source].basis(), solution.REGIMES[join.target].basis()
    small = sp.Rational(1, 10**25)
    point = {solution.h: sp.Rational(3, 7), solution.omega_d: sp.Rational(5, 4), solution.eta: sp.Rational(2, 9)}
    point |= {solution.omega_0: sp.Rational(7, 5), Omega: sp.Rational(8, 5), tau: sp.Rational(9, 4)}
    near = source[R2].xreplace(join.path).xreplace({join.letter: small}).subs(point)
    there = target[R2].subs({key: value for key, value in point.items() if key != join.letter})
    return fact(sp.N(near, 40, maxn=200), "=", sp.N(there, 40), Near(20))
