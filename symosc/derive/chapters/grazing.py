"""Theorem 7: eqs. (55) to (58) with every case, the contact's place, and the tangency of fourth
order.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy as sp

from symosc.derive.scope import BELTS, G, Scope, v_lambda
from symosc.derive.steps import (
    Check,
    Illustration,
    Items,
    Step,
    StepError,
    StepEvidence,
    Table,
    equation,
    facts,
    step,
)
from symosc.kernels.theorem7_cases import PLACES
from symosc.scenes import load_scene
from symosc.symbolic import solution, theorem7
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import B0, A, Omega, c, k, m, t, theta, v, x

TITLE = "Grazing: Theorem 7 with all cases"
THETA_M = named(r"\theta_m")
CRITICAL = named(r"\Theta^{\mathrm{cr}}")
GAMMA = named(r"\gamma")
AMPLITUDE = sp.Symbol("a", real=True)
#: The letters of the cases in `theorem7`, and positive ones for their signs.
g, a = sp.symbols("gamma a", real=True)
p, q = sp.symbols("p q", positive=True)

#: Every case of the signs of gamma, a and |gamma| - a: values that have them, and the case in
#: words.
CASES = (
    (p, p + q, r"$0 < \gamma < a$"), (p, p, r"$0 < \gamma = a$"), (p + q, p, r"$0 < a < \gamma$"),
    (sp.S.Zero, p, r"$\gamma = 0$"),
    (-p, p + q, r"$-a < \gamma < 0$"), (-p, p, r"$\gamma = -a$"), (-p - q, p, r"$\gamma < -a$"),
    (p, sp.S.Zero, r"$a = 0 < \gamma$"), (-p, sp.S.Zero, r"$\gamma < 0 = a$"),
    (sp.S.Zero, sp.S.Zero, r"$a = \gamma = 0$")
)  # fmt: skip


def items(scope: Scope) -> Items:
    """Yield the chapter: what a contact fixes, Theorem 7 with all cases, the case of equality, and
    k = 0.
    """
    yield _contact()
    yield _signs()
    yield _theorem()
    yield _ends(scope)
    yield _no_spring()


def _contact() -> Items:
    """Yield the items on what a contact fixes."""
    rows = []
    for mapping, place in PLACES.items():
        # G^(1) = -(gamma + a sin theta_m): what bounds the one bounds the other the opposite way.
        if place.side > 0:
            rate_sign = "<"
            sine_sign = ">"
        else:
            rate_sign = ">"
            sine_sign = "<"
        rows.append(
            (
                f"$P_{mapping[1]}$",
                place.domain,
                place.boundary,
                f"${place.side}$",
                rf"$G^{{(1,{place.domain})}} {rate_sign} 0$",
                rf"$a \sin\theta_m {sine_sign} -\gamma$",
                f"({place.equation})",
            )
        )
    yield (
        r"\subsection{What a contact fixes}",
        r"\begin{definition}[graze]\label{thm:grazing-graze} Let the flow of $\Omega_\alpha$ come "
        r"to the boundary $\dot{x} = v_\lambda$ at the time $t_m$, at the position $x_m$ and the "
        r"phase $\theta_m = \Omega t_m$ modulo $2\pi$, with $F^{(\alpha)} = 0$. It \emph{grazes} "
        r"if it stays in $\Omega_\alpha$ right before and right after $t_m$. It \emph{grazes to "
        r"first order} if $\sigma G^{(1,\alpha)} < 0$, with $\sigma = 1$ for a boundary above the "
        r"domain and $\sigma = -1$ for one below. Table~\ref{tab:grazing-places} has the four "
        r"places; the paper names each by a mapping.\end{definition}",
        Table(
            "tab:grazing-places",
            r"Where a flow can graze: domain, boundary and side, and when it does to first order.",
            ("mapping", r"$\alpha$", r"$\lambda$", r"$\sigma$", "grazes iff", "that is", "paper"),
            tuple(rows),
        ),
    )


def _signs() -> Items:
    """Yield the items on the sign that decides at a contact."""
    gamma, amplitude, position = contact_steps()
    values = {GAMMA: gamma.right, AMPLITUDE: amplitude.right}
    first = solution.in_paper_letters(solution.g_function(1).subs(v, v_lambda)).subs(
        Omega * t, THETA_M
    )
    critical = {CRITICAL: sp.asin(-k * v_lambda / (B0 * Omega))}
    yield (
        r"\begin{lemma}[what a contact fixes]\label{thm:grazing-contact} At such a contact the "
        r"paper's $\gamma = (c/m)\ddot{x} + (k/m)\dot{x}$ is fixed by the parameters, and with the "
        r"amplitude $a$,",
        gamma,
        amplitude,
        r"the first G-function depends on the phase alone:",
        equation(
            G(1),
            -(GAMMA + AMPLITUDE * sp.sin(THETA_M)),
            values | {G(1): first.subs(x, position.right)},
            "G1",
        ),
        r"For $k > 0$ the phase gives the position,",
        position,
        r"and if $|\gamma| \le |a| \ne 0$, $G^{(1,\alpha)}$ vanishes at the phases "
        r"$\Theta^{\mathrm{cr}} = \arcsin(-\gamma/a)$ and $\pi - \Theta^{\mathrm{cr}}$, where",
        equation(sp.sin(CRITICAL), -GAMMA / AMPLITUDE, values | critical, "critical"),
        r"\end{lemma}",
        r"\begin{proof} $\ddot{x} = F^{(\alpha)} = 0$ and $\dot{x} = v_\lambda$ at $t_m$. Put both "
        r"into \eqref{eq:switching-g1} and \eqref{eq:motion-acceleration}. So of the paper's "
        r"``four unknowns'' with three equations only the phase is free, and $\gamma$ does not "
        r"vary along the family of contacts: the case of the theorem is decided by the "
        r"parameters.\end{proof}",
    )


def _theorem() -> Items:
    """Yield the items on the theorem."""
    yield (
        r"\subsection{The theorem}",
        r"\begin{theorem}[the paper's Theorem 7, (55) to (58), "
        r"completed]\label{thm:grazing-theorem7} Let $m, \Omega > 0$ and $c, k \ge 0$, let $P_j$ "
        r"be one of $P_2$, $P_3$, $P_5$, $P_6$ with $(\alpha, \lambda, \sigma)$ from "
        r"Table~\ref{tab:grazing-places}, and let the flow of $\Omega_\alpha$ have $\dot{x} = "
        r"v_\lambda$ and $F^{(\alpha)} = 0$ at $t_m$. With $\gamma$, $a$ and "
        r"$\Theta^{\mathrm{cr}}$ as in Lemma~\ref{thm:grazing-contact} and $a \ge 0$, it grazes to "
        r"first order iff $\theta_m \in [0, 2\pi)$ is in the set of "
        r"Table~\ref{tab:grazing-windows}. For $a < 0$ the sets are those of $-a$, moved by $\pi$ "
        r"modulo $2\pi$.\end{theorem}",
        windows_table(),
        r"\begin{proof} By \eqref{eq:grazing-G1}, $\sigma G^{(1,\alpha)} < 0$ is $\sigma(\gamma + "
        r"a\sin\theta_m) > 0$. For $a > 0$ this is $\sin\theta_m > -\gamma/a$ for $\sigma = 1$ and "
        r"$\sin\theta_m < -\gamma/a$ for $\sigma = -1$. The sine takes the value $-\gamma/a$ twice "
        r"on the circle if $|\gamma| < a$, at $\Theta^{\mathrm{cr}}$ and $\pi - "
        r"\Theta^{\mathrm{cr}}$; once if $|\gamma| = a$, at $3\pi/2$ or $\pi/2$; and not at all if "
        r"$|\gamma| > a$. On each arc between these points the sign is the same, and it is decided "
        r"at one of $0$, $\pi/2$, $\pi$, $3\pi/2$. For $\gamma > 0$ the angle "
        r"$\Theta^{\mathrm{cr}}$ is negative: $2\pi + \Theta^{\mathrm{cr}} = 2\pi - "
        r"|\Theta^{\mathrm{cr}}|$ and $\pi - \Theta^{\mathrm{cr}} = \pi + |\Theta^{\mathrm{cr}}|$, "
        r"which is how the paper writes the ends. Where the paper writes a closed end $2\pi]$, it "
        r"is the phase 0. For $a = 0$ the condition is $\sigma\gamma > 0$, at every phase or at "
        r"none. For $a < 0$, $a\sin\theta_m = (-a)\sin(\theta_m + \pi)$, by",
        equation(
            named(r"\sin(\theta_m + \pi)"), -sp.sin(THETA_M), sp.sin(THETA_M + sp.pi), "turned"
        ),
        r"\end{proof}",
        r"That the flow comes from $\Omega_\alpha$ is no further condition: by "
        r"Lemma~\ref{thm:switching-side} the first G-function that does not vanish fixes the side "
        r"before the contact too, and for odd order it is the side after it. With $F^{(\alpha)} = "
        r"0$ and $\sigma G^{(1,\alpha)} > 0$ the flow would come from the other side of the "
        r"boundary, where it is not the motion.",
        Illustration(
            "windows",
            "fig:grazing-windows",
            r"The case $0 < \gamma < a$ with $\gamma/a = 1/2$: where $\sin\theta$ is above its "
            r"critical value $P_2$ and $P_5$ graze (grey), where it is below $P_3$ and $P_6$ do "
            r"(hatched).",
            0.95,
        ),
    )


def _ends(scope: Scope) -> Items:
    """Yield the items on the ends of a window and equality."""
    if scope.scene:
        yield [
            _numbers(scope, mapping)
            for mapping in PLACES
            if PLACES[mapping].boundary in scope.boundaries
        ]
    second = G(2)
    third = G(3)
    contact = {
        v: v_lambda,
        x: (solution.A_m + solution.f0 * sp.cos(theta) - solution.cm * v_lambda) / solution.w0sq,
    }
    g1, g2, g3 = (sp.expand(solution.g_function(n).subs(contact)) for n in (1, 2, 3))
    on_end = {v_lambda: -solution.f0 * Omega * sp.sin(theta) / solution.w0sq}
    assert sp.simplify(g1.subs(on_end)) == 0
    true2, true3 = (
        expr.subs(on_end).xreplace(solution.PAPER_LETTERS | {theta: THETA_M}) for expr in (g2, g3)
    )
    true = {third: true3, second: true2, AMPLITUDE: B0 * Omega / m}
    yield (
        r"\subsection{The ends of a window, and the case of equality}",
        r"\begin{theorem}[the case of equality]\label{thm:grazing-equality} Let $F^{(\alpha)} = "
        r"G^{(1,\alpha)} = 0$ at a contact, with $a \ne 0$; this needs $|\gamma| \le |a|$.",
        r"The next G-functions are",
        equation(second, -AMPLITUDE * Omega * sp.cos(THETA_M), true, "G2"),
        equation(third, AMPLITUDE * Omega**2 * sp.sin(THETA_M) - c * second / m, true, "G3"),
        r"\begin{enumerate}\item[(i)] If $|\gamma| < |a|$, then $G^{(2,\alpha)} \ne 0$: the flow "
        r"of $\Omega_\alpha$ crosses the boundary and does not graze. The windows are open at "
        r"these ends in full order too.\item[(ii)] If $|\gamma| = |a|$, then $G^{(2,\alpha)} = 0$ "
        r"and $G^{(3,\alpha)} = -\gamma\Omega^2 \ne 0$: the flow touches to fourth order, and "
        r"grazes iff $\sigma\gamma > 0$.\end{enumerate}So in the rows $0 < \gamma = a$ for $P_2$ "
        r"and $P_5$ and $\gamma = -a$ for $P_3$ and $P_6$ of Table~\ref{tab:grazing-windows} the "
        r"phase that is taken out, $3\pi/2$ or $\pi/2$, grazes as well, and to full order these "
        r"windows are the whole circle; all other rows stay as they are.\end{theorem}",
    )
    third = G(3)
    square = named(r"\gamma + a\sin\theta_m|_{\gamma = -a}")
    half = sp.sin(THETA_M / 2) - sp.cos(THETA_M / 2)
    value = {third: true3.subs(THETA_M, 3 * sp.pi / 2), GAMMA: B0 * Omega / m}
    opposite = {third: true3.subs(THETA_M, sp.pi / 2), GAMMA: -B0 * Omega / m}
    fourth = [equation(third, -GAMMA * Omega**2, meaning) for meaning in (value, opposite)]
    sine = named(r"\sin\theta_m")
    cosine = named(r"\cos\theta_m")
    at_ends = [
        step
        for phase, sign in ((sp.pi / 2, 1), (3 * sp.pi / 2, -1))
        for step in (
            equation(sine, sign, {sine: sp.sin(phase)}),
            equation(cosine, 0, {cosine: sp.cos(phase)}),
        )
    ]
    yield (
        r"\begin{proof} \eqref{eq:grazing-G2} and \eqref{eq:grazing-G3} are "
        r"\eqref{eq:switching-g2} and \eqref{eq:switching-g3} with $F^{(\alpha)} = G^{(1,\alpha)} "
        r"= 0$. (i) There $|\sin\theta_m| = |\gamma/a| < 1$, so $\cos\theta_m \ne 0$, and "
        r"Lemma~\ref{thm:switching-side} applies with $n = 2$.",
        r"(ii) There $\sin\theta_m = -\gamma/a = \pm 1$ and $\cos\theta_m = 0$, so "
        rf"$G^{{(3,\alpha)}} = {latex(AMPLITUDE * Omega**2 * sp.sin(THETA_M))} = "
        rf"{latex(fourth[0].right)}$.",
        facts(*at_ends, *fourth),
        r"The lemma applies with $n = 3$: the flow stays in $\Omega_\alpha$ iff $\sigma "
        r"G^{(3,\alpha)} < 0$. In the other rows with $|\gamma| = a$ no phase grazes at all, for "
        r"example in the row $\gamma = -a$ of $P_2$ and $P_5$, which the paper lacks, where",
        equation(square, -AMPLITUDE * half**2, -AMPLITUDE + AMPLITUDE * sp.sin(THETA_M), "square"),
        r"is never positive.\end{proof}",
    )
    (gamma7, a7), (gamma8, a8) = (
        [expr.subs(Scope(load_scene(name)).numbers) for expr in (k * BELTS[1] / m, B0 * Omega / m)]
        for name in ("fig7", "fig8")
    )
    yield (
        rf"The paper's Figs.~7 and 8 are both cases of equality: $\gamma = a = {latex(gamma7)}$ "
        r"for $P_2$ in Fig.~7, "
        rf"and $\gamma = {latex(gamma8)}$, $a = {latex(a8)}$ for $P_3$ in Fig.~8. The graze at "
        rf"$t_m "
        r"= \pi$ is not at the "
        rf"excluded phase in "
        r"either of them.",
        facts(equation(gamma7, a7), equation(gamma8, -a8)),
    )


def _no_spring() -> Items:
    """Yield the items on motions without a spring."""
    sine = named(r"\sin\theta_m")
    phase = named(r"\cos\theta_m")
    plain = solution.in_paper_letters(solution.acceleration()).subs(
        {v: v_lambda, Omega * t: THETA_M, k: 0}
    )
    solved = sp.solve(plain.subs(sp.cos(THETA_M), phase), phase)[0]
    second = solution.in_paper_letters(solution.g_function(2)).subs(
        {v: v_lambda, Omega * t: THETA_M, k: 0}
    )
    first = solution.in_paper_letters(solution.g_function(1)).subs(
        {v: v_lambda, Omega * t: THETA_M, k: 0}
    )
    # At F = 0 and sin theta = 0, where the cosine is 1 or -1.
    turning = {A: sp.solve(plain, A)[0]}
    flat, curve = (
        sp.expand(expr.subs(turning)).subs(sp.sin(THETA_M), 0) for expr in (first, second)
    )
    inflection = (
        *(equation(phase, value, {phase: sp.cos(at)}) for value, at in ((1, 0), (-1, sp.pi))),
        *(equation(sine, 0, {sine: sp.sin(at)}) for at in (0, sp.pi)),
        equation(G(1), 0, {G(1): flat}),
        equation(
            G(2),
            -AMPLITUDE * Omega * sp.cos(THETA_M),
            {G(2): curve, AMPLITUDE: B0 * Omega / m},
        ),
    )
    yield (
        r"\subsection{No spring}",
        r"\begin{corollary}[no spring]\label{thm:grazing-no-spring} Let $k = 0$ and $B_0 \ne 0$. "
        r"Then $\gamma = 0$, and $F^{(\alpha)} = 0$ fixes the phase instead of the position, which "
        r"is free:",
        equation(phase, (c * v_lambda - A) / B0, solved, "no-spring"),
        r"If the right side is below 1 in size, there is one such phase with $\sin\theta_m > 0$ "
        r"and one with $\sin\theta_m < 0$; for $B_0 > 0$ the first is the graze of $P_2$ and "
        r"$P_5$, the second that of $P_3$ and $P_6$, for $B_0 < 0$ the other way round. Beyond 1 "
        r"no contact has $F^{(\alpha)} = 0$.",
        rf"If it is $\pm 1$, then $\sin\theta_m = 0$ and $G^{{(1,\alpha)}} = 0 \ne "
        rf"G^{{(2,\alpha)}} = {latex(inflection[-1].right)}$, and nothing grazes.",
        facts(*inflection),
        r"\end{corollary}",
        r"\begin{proof} This is Theorem~\ref{thm:grazing-theorem7} in the row $\gamma = 0$, and "
        r"Theorem~\ref{thm:grazing-equality} (i).\end{proof}",
    )


def contact_steps() -> tuple[Step, Step, Step]:
    """Return the steps that define gamma and a, and give the position x_m of a contact at which the
    force is 0.
    """
    acceleration = named(r"\ddot{x}")
    rate = named(r"\dot{x}_m")
    at_contact = ((c * acceleration + k * rate) / m).subs({acceleration: 0, rate: v_lambda})
    force = solution.in_paper_letters(solution.acceleration()).subs({v: v_lambda, Omega * t: theta})
    (without_force,) = sp.solve(force, x)
    place = without_force.subs(theta, THETA_M)
    return (
        equation(GAMMA, k * v_lambda / m, at_contact, "gamma"),
        equation(AMPLITUDE, B0 * Omega / m, B0 * Omega / m, "a"),
        equation(named("x_m"), (A + B0 * sp.cos(THETA_M) - c * v_lambda) / k, place, "xm"),
    )


@cache
def windows_table(label: str = "tab:grazing-windows") -> Table:
    """Return the table of Theorem 7's windows, each checked: contacts from below (P2, P5) and from
    above (P3, P6).
    """
    return Table(
        label,
        r"Theorem~7: the phases $\theta_m$ at which a contact grazes to first order. The paper has "
        r"neither the case $\gamma = -a$ of $P_2$ and $P_5$ nor those without a drive; in the last "
        r"one the flow stays in the boundary.",
        ("", r"$P_2$, $P_5$ ($\sigma = 1$)", r"$P_3$, $P_6$ ($\sigma = -1$)"),
        tuple(
            (words, _window("P2", gamma, a), _window("P3", gamma, a)) for gamma, a, words in CASES
        ),
    )


def _window(mapping: str, gamma: Any, amplitude: Any) -> Step:
    """Return the checked step with a mapping's grazing window for `gamma` and `amplitude`, 0 or of
    known signs.
    """
    place = PLACES[mapping]
    values = {g: gamma, a: amplitude}
    conditions = (
        (row, row.condition.subs(values, simultaneous=True))
        for row in theorem7.all_cases(place, full=False)
    )
    case = next(row for row, condition in conditions if sp.simplify(condition) == sp.true)
    check = window(place.side, gamma, amplitude, {CRITICAL: sp.asin(-g / a)})
    return step(THETA_M, "in", _with_critical_phase(case.phases), check)


def _with_critical_phase(phases: Any) -> Any:
    """Return a set of phases with the symbol Theta^cr for the critical phase asin(-gamma/a) in its
    ends.
    """
    if isinstance(phases, sp.Union):
        return sp.Union(*(_with_critical_phase(part) for part in phases.args), evaluate=False)
    if not isinstance(phases, sp.Interval):
        return phases
    low, high, *open_ends = phases.args
    names = {sp.asin(g / a): -CRITICAL}
    # sp.Interval itself would ask which end is larger, which a symbol does not say.
    return sp.Basic.__new__(sp.Interval, low.subs(names), high.subs(names), *open_ends)


def window(side: int, gamma: Any, amplitude: Any, names: Any = ()) -> Check:
    """Return the check that the set in a step is that of all theta with `side` (`gamma` +
    `amplitude` sin theta) > 0.

    `names` has the values of symbols in the ends of the set.
    """
    # This is exact: the function has at most two zeros, and where the sine is 1, 0 or -1 its sign
    # is decided.

    def angle(end: Any) -> Any:
        return end.subs(names).subs({g: gamma, a: amplitude})

    def contains(part: Any, phase: Any) -> bool:
        # Ends cannot cross a multiple of pi/2 while the signs stay: one set of numbers stands for
        # all.
        start, end, left_open, right_open = part.args
        numbers = {p: sp.Rational(3, 7), q: sp.Rational(2, 5)}  # any, as said above
        low = angle(start).subs(numbers)
        high = angle(end).subs(numbers)
        after_start = phase > low or (phase == low and not left_open)
        before_end = phase < high or (phase == high and not right_open)
        return bool(after_start and before_end)

    def check(statement: Step) -> StepEvidence:
        if isinstance(statement.right, sp.Union):
            sets = statement.right.args
        else:
            sets = (statement.right,)
        parts = [part for part in sets if isinstance(part, sp.Interval)]
        # A set that goes through the phase 0 is written in two parts, and 0 is no end of it.
        through_0 = any(part.start == 0 and not part.left_open for part in parts)
        ends = [end for part in parts for end in (part.start, part.end)]
        for end in ends:
            zero = sp.simplify(sp.expand_trig(sp.sin(angle(end))) * amplitude + gamma)
            if zero != 0 and not (through_0 and end in (0, 2 * sp.pi)):
                raise StepError(
                    str(statement),
                    f"{end} is no zero of gamma + a sin theta, which is {zero} there",
                )
        for sine, phase in ((1, sp.pi / 2), (-1, 3 * sp.pi / 2), (0, sp.Integer(0)), (0, sp.pi)):
            value = side * (gamma + amplitude * sine)
            inside = sp.simplify(value).is_positive
            if inside is None:
                raise StepError(str(statement), f"the sign of {value} is undecided")
            if inside != any(contains(part, phase) for part in parts):
                raise StepError(str(statement), f"is wrong at {phase}")
        return StepEvidence("exact", "0")

    return check


def _numbers(scope: Scope, mapping: str) -> Items:
    """Return the section with a mapping's window for the numbers of the scope's scene."""
    place = PLACES[mapping]
    gamma, amplitude = (
        e.subs(scope.numbers) for e in (k * BELTS[place.boundary] / m, B0 * Omega / m)
    )
    phases = theorem7.window_phases(place, gamma, amplitude, full=False)
    return (
        rf"\subsection{{The window of $P_{mapping[1]}$ with the numbers of the scene}}",
        "The numbers to compare are",
        equation(GAMMA, gamma, gamma),
        equation(AMPLITUDE, amplitude, amplitude),
        r"and the flow grazes to first order at the phases",
        step(THETA_M, "in", phases, window(place.side, gamma, amplitude)),
    )
