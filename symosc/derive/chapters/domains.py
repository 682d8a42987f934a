"""The solution in one domain, its closed forms in every damping regime, and how the regimes join."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.chapters.motion import balance
from symosc.derive.scope import Scope
from symosc.derive.steps import (
    CONTEXT,
    Check,
    Items,
    Step,
    Table,
    at_root,
    equation,
    exact,
    generic_basis,
    modes,
    solves,
)
from symosc.symbolic import solution
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import (
    BASIS,
    E0,
    E1,
    E2,
    I2,
    R2,
    Omega,
    a_i,
    cm,
    f0,
    tau,
    theta_i,
    v_i,
    w0sq,
    x_i,
)

TITLE = "The motion in one domain"
A = solution.A
B0 = solution.B0
c = solution.c
k = solution.k
m = solution.m
eta = solution.eta
omega_0 = solution.omega_0
omega_d = solution.omega_d
KAPPA = named(r"\kappa")
DELTA = named(r"\Delta", positive=True)
NORMS = {KAPPA: w0sq - Omega**2, DELTA: (w0sq - Omega**2) ** 2 + (cm * Omega) ** 2}

#: What L makes of each basis function, and how each one starts.
RESPONSES = {
    E0: (0, 1, -cm),
    E1: (0, 0, 1),
    E2: (1, 0, 0),
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


def items(scope: Scope) -> Items:
    """Yield the chapter: the closed form of a flight in every damping regime, and how the regimes
    join.
    """
    yield _functions()
    yield _motion()
    yield _as_printed(scope)
    yield _regimes(scope)


def _functions() -> Items:
    """Yield the items on the five basis functions."""
    generic = generic_basis()
    rates = []
    for symbol, rate in solution.rates().items():
        name = named(rf"\dot{{{symbol.name[0]}}}_{symbol.name[1]}")
        check = exact(generic | {name: generic[symbol].diff(tau)}, modes)
        rates.append(equation(name, rate, check, f"rate-{symbol.name}"))
    laws = []
    values = {"step": sp.Integer(1), "cosine": sp.cos(Omega * tau), "sine": sp.sin(Omega * tau)}
    for (name, value), relation in zip(values.items(), solution.relations(), strict=True):
        left = sp.collect(sp.expand(relation + value), [R2, I2])
        laws.append(equation(value, left, exact(generic, modes), f"{name}"))
    yield (
        r"\subsection{Five functions that hold every motion}",
        r"\begin{definition}[basis functions]\label{thm:domains-basis} With $\tau = t - t_i$ the "
        r"time since the start at $t_i$, let $L = d^2/d\tau^2 + (c/m)\, d/d\tau + k/m$. Let "
        r"$E_1(\tau)$ be the response to an impulse: $L E_1 = 0$, $E_1(0) = 0$, $\dot{E}_1(0) = "
        r"1$. Further let $E_0 = \dot{E}_1$, $E_2(\tau) = \int_0^\tau E_1(u)\,du$ and $R_2(\tau) + "
        r"i I_2(\tau) = \int_0^\tau E_1(u)\, e^{i\Omega(\tau - u)}\,du$.\end{definition}",
        r"\begin{lemma}[rates and relations]\label{thm:domains-relations} The basis functions have "
        r"the derivatives",
        rates,
        r"and obey, whatever the damping,",
        laws,
        r"\end{lemma}",
        r"\begin{proof} The rates follow from $L E_1 = 0$ and Leibniz' rule. The relations are $L "
        r"E_2 = 1$ and $L(R_2 + i I_2) = e^{i\Omega\tau}$, with all derivatives replaced by the "
        r"rates: both sides have the same rates, and are equal at $\tau = 0$.\end{proof}",
        solved_functions(generic),
    )


def _motion() -> Items:
    """Yield the items on the motion."""
    start, *motion = flow()
    yield (
        r"\subsection{The motion}",
        r"\begin{theorem}[the motion in a domain]\label{thm:domains-flow} A motion that starts in "
        r"$\Omega_\alpha$, or goes into it, at $t_i$ with the phase $\theta_i = \Omega t_i$, the "
        r"position $x_i$ and the velocity $\dot{x}_i$ is, as long as it stays in $\Omega_\alpha$,",
        motion,
        r"where the acceleration at the start is",
        start,
        r"This holds in every regime of damping and at resonance.\end{theorem}",
        r"\begin{proof} $L x = (A_\alpha + B_0\cos\theta)/m$ by \eqref{eq:motion-domain}. "
        r"Variation of constants gives $x$ as a combination of $E_0$, $E_1$, $E_2$, $R_2$ and "
        r"$I_2$. Then $A_\alpha$ is eliminated in favour of $\ddot{x}_i$, so that friction enters "
        r"only there, and the derivatives are shortened by Lemma~\ref{thm:domains-relations}. That "
        r"\eqref{eq:domains-x} solves the equation with the right start was checked with the "
        r"relations alone.\end{proof}",
    )


def _as_printed(scope: Scope) -> Items:
    """Yield the items on the form that papers print."""
    if scope.scene is None:
        name = "underdamped"
    else:
        name = scope.regimes[0].name
    form = paper_form(solution.REGIMES[name])
    (first, second) = REGIME_WORDS[name]
    if name == "underdamped":
        form_is = (
            r"The form with constants of integration, for $c^2 < 4km$ away from undamped "
            r"resonance, with $h = c/(2m)$ and $\omega_d = \sqrt{k/m - h^2}$, is"
        )
    else:
        form_is = (
            rf"The form with constants of integration, in the regime \emph{{{first}}} ({second}), "
            r"is"
        )
    yield (
        r"\subsection{The same motion as papers print it}",
        form_is,
        equation(named(r"x(\tau)"), form.x, form.check, "paper"),
        "with",
        constants(form),
        r"It is the same function as \eqref{eq:domains-x}, since both solve the same problem. It "
        r"needs a case for every regime, and loses digits near the borders of the regimes and for "
        r"short times, where \eqref{eq:domains-x} loses none if the basis functions are computed "
        r"as divided differences \cite{mccurdy1984}.",
    )


def _regimes(scope: Scope) -> Items:
    """Yield the items on the regimes of damping, and their limits."""
    if scope.scene:
        regime = scope.regimes[0]
        name, condition = REGIME_WORDS[regime.name]
        yield (
            r"\subsection{The basis functions of this scene}",
            rf"The regime is \emph{{{name}}} ({condition}). There",
            [basis_function(symbol, regime, label=f"scene-{symbol.name}") for symbol in BASIS],
        )
        return

    def roots(regime: solution.Regime) -> str:
        if regime.centre != 0:
            centre = latex(regime.centre)
        else:
            centre = ""
        if regime.offset != 0:
            return rf"${centre} \pm {latex(regime.offset)}$"
        return f"${centre or 0}$, double"

    values = {name: value for regime in scope.regimes for name, value in regime.letters.items()}
    regimes = solution.REGIMES
    letters = (solution.h, omega_d, eta, omega_0)
    regime_rows = []
    for regime in scope.regimes:
        functions = [basis_function(symbol, regime) for symbol in (E1, E0)]
        regime_rows.append((*REGIME_WORDS[regime.name], roots(regime), *functions))
    yield (
        r"\subsection{The regimes of damping}",
        r"In terms of the roots of $m z^2 + c z + k$ the basis functions are elementary. With the "
        r"letters",
        [
            equation(letter, values[letter], true_letters()[letter], f"{letter.name}")
            for letter in letters
        ],
        r"Table~\ref{tab:domains-regimes} gives $E_1$ and $E_0$; the other functions follow by "
        r"Corollary~\ref{thm:domains-solved}.",
        Table(
            "tab:domains-regimes",
            r"The regimes of damping: their roots, and the two functions that the others follow "
            r"from.",
            ("regime", "condition", "roots", "$E_1$", "$E_0$"),
            tuple(regime_rows),
        ),
        r"Three functions are left over, where the corollary divides by 0. Without a spring,",
        basis_function(E2, regimes["no spring"], note="for $c > 0$,", label="no-spring-E2"),
        basis_function(E2, regimes["free"], note="for $c = 0$.", label="free-E2"),
        r"At undamped resonance",
        basis_function(R2, regimes["resonance"], label="resonance-R2"),
        basis_function(I2, regimes["resonance"], label="resonance-I2"),
    )
    borders = []
    arrows = ("=", r"\mapsto")
    for join in solution.JOINS:
        source, target = (
            solution.REGIMES[name].parameters() for name in (join.source, join.target)
        )
        limits = [
            equation(
                name, target[letter], sp.limit(source[letter].xreplace(join.path), join.letter, 0)
            )
            for name, letter in ((named("c/m"), cm), (named("k/m"), w0sq))
        ]
        # An arrow where the old value of a letter is in the new one.
        path = ", ".join(
            rf"${latex(name)} {arrows[name in value.free_symbols]} {latex(value)}$"
            for name, value in join.path.items()
        )
        (source_name, _), (target_name, _) = (
            REGIME_WORDS[name] for name in (join.source, join.target)
        )
        limit = rf"${latex(join.letter)} \to 0$"
        borders.append((source_name, target_name, limit, path, *limits))
    yield (
        r"\subsection{The regimes are limits of each other}",
        r"\begin{theorem}[one motion, no cases]\label{thm:domains-entire} For each $\tau$ the "
        r"basis functions are entire functions of $c/m$, $k/m$ and $\Omega$. So at each border of "
        r"two regimes the functions of one turn into those of the other.\end{theorem}",
        r"\begin{proof} $E_1$ solves a linear equation whose coefficients are polynomials of $c/m$ "
        r"and $k/m$, with a fixed start; such a solution is an entire function of the "
        r"coefficients, and so are $E_0$ and the integrals $E_2$ and $R_2 + i I_2$, the last one "
        r"also of $\Omega$. Table~\ref{tab:domains-joins} goes over the borders: along each path "
        r"$c/m$ and $k/m$ of one regime tend to those of the other.\end{proof}",
        Table(
            "tab:domains-joins",
            r"The borders of the regimes: how each is approached, and to what $c/m$ and $k/m$ tend "
            r"there.",
            ("from", "to", "with", "where", r"$c/m \to$", r"$k/m \to$"),
            tuple(borders),
            tuple(_sampled(join) for join in solution.JOINS),
        ),
    )


def flow() -> tuple[Step, ...]:
    """Return the steps on a flight in a domain: its initial acceleration, and x, v and acceleration
    after tau.
    """
    flow = solution.flow()
    newton = {a_i: balance(x_i, v_i, theta_i), **solution.PAPER_LETTERS}
    force = solution.A_m + f0 * sp.cos(theta_i + Omega * tau)
    velocity = named(r"\dot{x}(\tau)")
    acceleration = named(r"\ddot{x}(\tau)")
    start = named(r"\ddot{x}_i")
    back = {c: m * cm, k: m * w0sq, B0: m * f0, A: m * solution.A_m}
    by_newton = {a_i: sp.expand(newton[a_i].xreplace(back))}
    by_v, by_a = (
        {name: solution.time_derivative(expr)}
        for name, expr in ((velocity, flow.x), (acceleration, flow.v))
    )
    return (
        equation(start, solution.acceleration(x_i, v_i, theta_i), {start: a_i, **newton}, "start"),
        equation(named(r"x(\tau)"), flow.x, solves(force, x_i, v_i, meaning=by_newton), "x"),
        equation(velocity, flow.v, exact(by_v, solution.use_relations), "v"),
        equation(acceleration, flow.a, exact(by_a, solution.use_relations), "a"),
    )


def solved_functions(generic: dict[Any, Any]) -> Items:
    """Return the corollary with E2, R2, I2 in terms of E0, E1.

    `generic` has their closed forms, for the checks.
    """
    cosine_part = sp.cos(Omega * tau) - E0 - cm * E1
    sine_part = sp.sin(Omega * tau) - Omega * E1
    meaning = generic | {name: value.xreplace(generic) for name, value in NORMS.items()}
    return (
        r"\begin{corollary}\label{thm:domains-solved} $E_0$ and $E_1$ give the other three: for $k "
        r"> 0$",
        equation(E2, (1 - E0 - cm * E1) / w0sq, exact(generic, modes), "E2"),
        "and with",
        equation(KAPPA, NORMS[KAPPA], NORMS, "kappa"),
        equation(DELTA, KAPPA**2 + (cm * Omega) ** 2, NORMS, "Delta"),
        r"wherever $\Delta > 0$, that is everywhere but at undamped resonance,",
        equation(
            R2, (KAPPA * cosine_part + cm * Omega * sine_part) / DELTA, exact(meaning, modes), "R2"
        ),
        equation(
            I2, (KAPPA * sine_part - cm * Omega * cosine_part) / DELTA, exact(meaning, modes), "I2"
        ),
        r"\end{corollary}",
        r"\begin{proof} \eqref{eq:domains-step} is solved for $E_2$; \eqref{eq:domains-cosine} and "
        r"\eqref{eq:domains-sine} are two linear equations for $R_2$ and $I_2$ with the "
        r"determinant $\Delta$.\end{proof}",
    )


# --- the motion as papers print it: e^{-ct/2m} (C_1 cos omega_d t + C_2 sin omega_d t) and a steady
# part ---

C1, C2, D1, D2 = (named(name) for name in ("C_1", "C_2", "D_1", "D_2"))
DECAY = sp.exp(-c * tau / (2 * m))
PHASE = theta_i + Omega * tau

WAVE = D1 * sp.cos(PHASE) + D2 * sp.sin(PHASE)
TUNED = k - m * Omega**2
NORM = TUNED**2 + c**2 * Omega**2
FREE_NORM = m**2 * Omega**2 + c**2
STEADY = A / k + WAVE, {D1: B0 * TUNED / NORM, D2: B0 * c * Omega / NORM}
GROWING = B0 / (2 * m * Omega) * tau * sp.sin(PHASE)
SLIDING = A * tau / c + WAVE, {D1: -B0 * m / FREE_NORM, D2: B0 * c / (Omega * FREE_NORM)}
#: Of each regime two solutions of the unforced equation, what divides C_2, a particular solution,
#: and its constants.
MODES = {
    "underdamped": (DECAY * sp.cos(omega_d * tau), DECAY * sp.sin(omega_d * tau), omega_d, *STEADY),
    "critical": (DECAY, tau * DECAY, 1, *STEADY),
    "overdamped": (DECAY * sp.cosh(eta * tau), DECAY * sp.sinh(eta * tau), eta, *STEADY),
    "undamped": (
        sp.cos(omega_0 * tau),
        sp.sin(omega_0 * tau),
        omega_0,
        A / k + D1 * sp.cos(PHASE),
        {D1: B0 / TUNED},
    ),
    "resonance": (sp.cos(Omega * tau), sp.sin(Omega * tau), Omega, A / k + GROWING, {}),
    "no spring": (sp.Integer(1), sp.exp(-c * tau / m), 1, *SLIDING),
    "free": (sp.Integer(1), tau, 1, A * tau**2 / (2 * m) - B0 / (m * Omega**2) * sp.cos(PHASE), {}),
}


class PaperForm(NamedTuple):
    """The paper's closed form of a flight: x and v, with letters C1, C2, D1, D2 for its constants.

    `constants` has their values, `meaning` defines all letters, `check` verifies that x solves eq.
    (5) from its start.
    """

    x: Any
    v: Any
    constants: dict[Any, Any]
    check: Check
    meaning: dict[Any, Any]


@cache
def paper_form(regime: solution.Regime) -> PaperForm:
    """Return the motion in a regime with the constants of integration C1, C2 and a steady part with
    D1, D2.
    """
    first, second, below, steady, letters = MODES[regime.name]
    x = C1 * first + C2 * second + steady
    start = {tau: sp.Integer(0)}
    v = x.diff(tau)
    equations = [x.subs(start) - x_i, v.subs(start) - v_i]
    solved = sp.solve(equations, [C1, C2], dict=True)[0]
    if regime.name != "no spring":  # C_1 is plain there; C_2 is shorter with it
        solved[C2] = sp.solve(equations[1], C2)[0]
    # One denominator for the whole sum.
    if below != 1:
        quotient = sp.Mul(sp.expand(solved[C2] * below), 1 / below, evaluate=False)
    else:
        quotient = sp.expand(solved[C2])
    constants = letters | {C1: sp.expand(solved[C1]), C2: quotient}
    values = regime.parameters()
    back = {c: m * values[cm], k: m * values[w0sq]}
    force = ((A + B0 * sp.cos(PHASE)) / m).xreplace(back)
    meaning = {
        name: value.xreplace(constants).xreplace(constants).xreplace(back)
        for name, value in constants.items()
    }
    meaning |= back
    check = solves(force, x_i, v_i, values[cm], values[w0sq], meaning)
    joined = sp.collect(C1 * first + C2 * second, [DECAY]) + steady
    return PaperForm(joined, _one_exponential(v, first), constants, check, meaning)


def _one_exponential(v: Any, mode: Any) -> Any:
    """Return the velocity v expanded and, if `mode`, the factor of C1 in x, decays, with e^{-ct/2m}
    factored out.
    """
    # A symbol stands for the exponential, so that .coeff() finds its factor.
    if not mode.has(sp.exp):
        return sp.expand(v)
    v = sp.expand(v)
    stand_in = sp.Dummy()
    inside = v.xreplace({DECAY: stand_in}).coeff(stand_in)
    waves = sorted(inside.atoms(*_WAVES), key=sp.default_sort_key)
    rows = {wave: inside.coeff(wave) for wave in waves} or {sp.Integer(1): inside}
    return DECAY * sp.Add(*(_times(wave, row) for wave, row in rows.items())) + v.xreplace(
        {DECAY: sp.S.Zero}
    )


def constants(form: PaperForm) -> list[Step]:
    """Return a step for each constant of `form` that states its value.

    C1 and C2 are checked to fit the start.
    """
    start = {tau: sp.Integer(0)}
    at_start = (form.x.subs(start) - x_i, form.x.diff(tau).subs(start) - v_i)
    (fitted,) = sp.solve(at_start, [C1, C2], dict=True)
    steps = []
    for letter, value in form.constants.items():
        # C2 is stated in terms of C1.
        start_fits = {name: fitted[name] for name in (letter, C1) if letter in fitted}
        meaning = start_fits or {name: form.meaning[name] for name in (letter, c, k)}
        steps.append(equation(letter, value, meaning, letter.name.replace("_", "")))
    return steps


def basis_function(symbol: Any, regime: solution.Regime, **options: Any) -> Step:
    """Return the checked step "symbol = closed form" of a basis function in a regime.

    `options` go to `equation`.
    """
    force, start, rate = map(sp.sympify, RESPONSES[symbol])
    parameters = regime.parameters()
    check = solves(force, start, rate.xreplace(parameters), *parameters.values())
    return equation(symbol, tidy(regime.basis()[symbol]), check, **options)


def true_letters() -> dict[Any, Any]:
    """Return the rates h, eta and the frequencies omega_d, omega_0 in m, c, k: from the roots of m
    z^2 + c z + k.
    """
    z = sp.Symbol("z")
    polynomial = sp.Poly(m * z**2 + c * z + k, z)
    a, b, _ = polynomial.all_coeffs()
    disc = polynomial.discriminant()
    roots = {
        solution.h: b / (2 * a),
        eta: sp.sqrt(disc) / (2 * a),
        omega_d: sp.sqrt(-disc) / (2 * a),
    }
    return roots | {omega_0: sp.sqrt(-disc.subs(c, 0)) / (2 * a)}


_WAVES = sp.sin, sp.cos, sp.sinh, sp.cosh


def _times(wave: Any, row: Any) -> Any:
    """Return the function `wave` times the sum `row`; if all terms of `row` are negative, the minus
    comes first.
    """
    if wave != 1 and row.is_Add and all(term.could_extract_minus_sign() for term in row.args):
        return -wave * sp.Add(*(-term for term in row.args))
    return wave * row


def tidy(expr: Any) -> Any:
    """Write a closed form over a common denominator, with the terms of each exp, sin, cos, ...
    collected, so that it is short.
    """
    waves = sorted(expr.atoms(sp.exp), key=sp.default_sort_key)
    stand_ins = [sp.Dummy() for _ in waves]
    # A symbol stands for each exponential, so that .coeff() finds its factor.
    without_waves = expr.xreplace(dict(zip(waves, stand_ins, strict=True)))
    numerator, denominator = sp.fraction(sp.together(without_waves))
    trig = sorted(numerator.atoms(*_WAVES), key=sp.default_sort_key)
    numerator = sp.expand(numerator)
    without_exp = numerator.xreplace(dict.fromkeys(stand_ins, sp.Integer(0)))
    # By the exponential that they are the factor of; 1 stands for none.
    rows = {sp.Integer(1): without_exp} | {
        wave: numerator.coeff(letter) for letter, wave in zip(stand_ins, waves, strict=True)
    }
    numerator = sp.Add(
        *(_times(wave, sp.collect(row, trig, sp.factor)) for wave, row in rows.items())
    )
    if denominator != 1 and numerator.is_Add:
        return sp.Mul(numerator, 1 / sp.factor(denominator), evaluate=False)
    return numerator / denominator


def _sampled(join: solution.Join) -> Step:
    """Return the step that R2 in the regime `join.source`, next to `join.target`, agrees
    numerically with R2 there.
    """
    source = solution.REGIMES[join.source].basis()
    target = solution.REGIMES[join.target].basis()
    values = {
        solution.h: "3/7",
        omega_d: "5/4",
        eta: "2/9",
        omega_0: "7/5",
        Omega: "8/5",
        tau: "9/4",
    }
    point = {letter: sp.Rational(value) for letter, value in values.items()}
    nearby = (
        source[R2].xreplace(join.path).xreplace({join.letter: sp.Rational(1, 10**25)}).subs(point)
    )
    at_limit = target[R2].subs({key: value for key, value in point.items() if key != join.letter})
    return equation(
        sp.N(nearby, 40, maxn=200), sp.N(at_limit, 40), at_root(dict, CONTEXT.mpf(10) ** -20)
    )
