"""Stick motion and both exits: eqs. (3), (4), (11), (12), (52), (53)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from symosc.derive.chapters.motion import MU, acceleration, newton
from symosc.derive.scope import BELTS, UPPER, F, Scope, mu_lambda, v_lambda
from symosc.derive.steps import (
    Illustration,
    Items,
    Step,
    Table,
    cases,
    equation,
    exact,
    facts,
    sign,
    step,
)
from symosc.friction import NEIGHBOURS
from symosc.symbolic import solution
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import B0, FN, Omega, a_i, k, m, t, tau, theta, theta_i, v, x_i

TITLE = "Sticks and their two ends"
#: The paper's equation for the end of a stick on each belt: F^(alpha) above the belt rises to 0.
PAPER_EXITS = {1: 52, 2: 53}


def force_on_belt(phase: Any) -> Any:
    """Return F^(alpha) after a time tau of a stick, if a_i is its value at the start.

    `phase` is theta at that time.
    """
    # In the difference A_alpha cancels, so that one formula serves both sides of the belt.
    later = solution.acceleration(x_i + v_lambda * tau, v_lambda, phase)
    return a_i + later - solution.acceleration(x_i, v_lambda, theta_i)


def rate() -> Step:
    """Return the step on dF^(alpha)/dt during a stick, which both sides of the belt share."""
    position = x_i + v_lambda * (t - solution.t_i)
    # `in_paper_letters` writes theta as Omega t, so that .diff(t) differentiates the phase too.
    force_in_time = solution.in_paper_letters(solution.acceleration(position, v_lambda, theta))
    rate_of_force = (m * force_in_time.diff(t)).subs(Omega * t, theta)
    return equation(
        named(r"m\dot{F}^{(\alpha)}"),
        -(k * v_lambda + B0 * Omega * sp.sin(theta)),
        rate_of_force,
        "rate",
    )


def force(belt: int, alpha: int, label: str = "") -> Step:
    """Return the step with the formula of m F^(alpha) at the speed of `belt`, checked by Newton's
    law.
    """
    on_belt = {v: BELTS[belt], Omega * t: theta}
    right = sp.expand(m * acceleration(alpha).subs(on_belt))
    return equation(m * F(alpha), right, {F(alpha): newton(alpha).subs(on_belt)}, label)


def items(scope: Scope) -> Items:
    """Yield the chapter: what changes during a stick, and its two ends."""
    held = solution.stick_acceleration(a_i, sp.cos(theta_i + Omega * tau) - sp.cos(theta_i)).subs(
        v, v_lambda
    )
    yield (
        r"\subsection{The mass on a belt}",
        r"\begin{definition}[stick]\label{thm:sticks-stick} A \emph{stick} on belt $\lambda$ is an "
        r"interval of time during which $\dot{x} = v_\lambda$, so that $\ddot{x} = 0$ (the paper's "
        r"(3), (4), (11), (12)). By Proposition~\ref{thm:motion-held} it needs $F^{(\lambda)} \ge "
        r"0 \ge F^{(\lambda+1)}$ all the time.\end{definition}",
        r"\begin{lemma}[what changes on a belt]\label{thm:sticks-rate} On belt $\lambda$, at "
        r"$\tau$ after the phase $\theta_i$ and the position $x_i$,",
        equation(
            named(r"x(\tau)"),
            x_i + v_lambda * tau,
            x_i + sp.integrate(v_lambda, (tau, 0, tau)),
            "x",
        ),
        r"and the accelerations on both sides, $\alpha = \lambda$ and $\lambda + 1$, are",
        equation(named(r"F^{(\alpha)}(\tau)"), held, force_on_belt(theta_i + Omega * tau), "force"),
        r"with $\ddot{x}_i = F^{(\alpha)}(x_i, v_\lambda, t_i)$, each its own. They change at one "
        r"rate, which depends on the phase $\theta = \Omega t$ alone:",
        rate(),
        r"\end{lemma}",
        r"\begin{proof} Put $x = x_i + v_\lambda\tau$ and $\dot{x} = v_\lambda$ into "
        r"\eqref{eq:motion-acceleration}, and differentiate.\end{proof}",
        r"The right side of \eqref{eq:sticks-rate} vanishes where $\sin\theta = -k "
        r"v_\lambda/(B_0\Omega)$. If there are such phases, one is $\Theta^{\mathrm{cr}} = "
        r"\arcsin(-k v_\lambda/(B_0\Omega))$ and the other $\pi - \Theta^{\mathrm{cr}}$: the "
        r"critical phases of Theorem~\ref{thm:grazing-theorem7}. Between two of them both "
        r"accelerations are strictly monotone (or constant, for $B_0 = 0$ and $k v_\lambda = 0$), "
        r"so the end of a stick is found without a search: on each such piece each of them has at "
        r"most one zero, or never changes.",
    )
    zero = named(r"F^{(\lambda+1)}|_{F^{(\lambda)} = 0}")
    lower = cases(*(sign({zero: -(newton(lo) - newton(lo + 1))}) for lo in scope.boundaries))
    jumps = (
        exact({F(UPPER): newton(lo + 1) - newton(lo), mu_lambda: MU[lo]}) for lo in scope.boundaries
    )
    yield (
        r"\subsection{Both ends}",
        r"\begin{theorem}[both exits of a stick]\label{thm:sticks-exits} A stick on belt $\lambda$ "
        r"ends at the first time at which $F^{(\lambda)}$ falls below 0, and then the mass goes "
        r"into $\Omega_\lambda$; or at which $F^{(\lambda+1)}$ rises above 0, and then it goes "
        r"into $\Omega_{\lambda+1}$. Both cannot happen at once if the belt has friction: where "
        r"$F^{(\lambda)} = 0$,",
        equation(F(UPPER), -2 * mu_lambda * FN / m, cases(*jumps), "other"),
        "which holds the mass on its upper side:",
        step(zero, "<=", 0, lower),
        r"\end{theorem}",
        r"\begin{proof} While $F^{(\lambda)} \ge 0 \ge F^{(\lambda+1)}$ the rest on the belt is a "
        r"motion by Proposition~\ref{thm:motion-held}, and by Theorem~\ref{thm:motion-unique} the "
        r"only one; a zero that is only touched does not end it. Where $F^{(\lambda)}$ becomes "
        r"negative, no friction of the belt balances the other forces. Let $F^{(\lambda)} = 0$ "
        r"there, and take the first derivative of $F^{(\lambda)}$ along the belt that does not "
        r"vanish: it is negative. The flow of $\Omega_\lambda$ has the same first derivative, "
        r"because by \eqref{eq:switching-g1} and \eqref{eq:sticks-rate} the rates of "
        r"$F^{(\lambda)}$ along both differ only by multiples of $F^{(\lambda)}$ and of $\dot{x} - "
        r"v_\lambda$, which vanish to higher order. So by Lemma~\ref{thm:switching-side} it goes "
        r"below $v_\lambda$. The other end is the mirror image. \eqref{eq:sticks-other} is "
        r"Lemma~\ref{thm:motion-jump}.\end{proof}",
    )
    rows = []
    for belt in scope.boundaries:
        for alpha in NEIGHBOURS[belt]:
            if alpha == belt:
                change = "falls"
                paper = "not in the paper"
            else:
                change = "rises"
                paper = f"the paper's ({PAPER_EXITS[belt]})"
            rows.append(
                (
                    str(belt),
                    rf"$F^{{({alpha})}}$ {change}",
                    rf"$\Omega_{alpha}$",
                    paper,
                    force(belt, alpha),
                )
            )
    yield (
        Table(
            "tab:sticks-exits",
            r"What vanishes at the end of a stick, and into which domain the mass goes. The "
            r"paper's (52) and (53) have one end each.",
            ("belt", "what", "into", "", r"$m F^{(\alpha)}$ there"),
            tuple(rows),
        ),
        r"The paper's own figures use the missing ends: in Fig.~6 the mass leaves belt 2 by "
        r"$F^{(2)} = 0$ (Figure~\ref{fig:sticks-exits}), and the first stick of Fig.~5 ends in "
        r"$\Omega_1$ by $F^{(1)} = 0$ (Chapter~\ref{sec:errata}).",
        Illustration(
            "stick-exits",
            "fig:sticks-exits",
            r"The stick of the paper's Fig.~6 on belt 2 (grey): it ends where $F^{(2)}$ falls to "
            r"0, not where $F^{(3)}$ rises to 0.",
            0.85,
        ),
    )
    turn = named(r"\Delta_T F^{(\alpha)}")
    per_turn = (
        force_on_belt(theta_i + Omega * tau).subs(tau, 2 * sp.pi / Omega).rewrite(sp.cos) - a_i
    )
    gain = sp.simplify(per_turn.xreplace(solution.PAPER_LETTERS))
    turned = equation(turn, -2 * sp.pi * k * v_lambda / (m * Omega), {turn: gain})
    still = equation(turn, 0, {turn: gain.subs(k, 0)})
    period = equation(
        named(r"\mathcal{T}"), 2 * sp.pi / Omega, sp.solve(Omega * t - 2 * sp.pi, t)[0]
    )
    yield (
        r"\begin{corollary}\label{thm:sticks-ends} "
        rf"For $k v_\lambda \ne 0$ every stick ends: over each period ${latex(period.right)}$ "
        r"both accelerations "
        rf"change by ${latex(turned.right)}$. For $k v_\lambda = 0$ a stick ends within one "
        r"period, or never.\end{corollary}",
        facts(turned, still, period),
        r"\begin{proof} Integrate \eqref{eq:sticks-rate} over one period.\end{proof}",
    )
