"""Equation of motion and friction law: eqs. (1) to (12), and what follows from set-valued friction."""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy as sp

from symosc.derive.scope import BELTS, LOWER, UPPER, F, Scope, mu_lambda, v_lambda
from symosc.derive.steps import (
    Check,
    Illustration,
    Items,
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
from symosc.symbolic.latex import named
from symosc.symbolic.solution import A0, B0, FN, Omega, c, k, m, mu1, mu2, t, v, x

TITLE = "Equation of motion and friction law"
MU = {1: mu1, 2: mu2}
WAVE = sp.cos(Omega * t)
HELD = named(r"F_{s\lambda}")
#: The domains, in words.
VELOCITIES = {1: r"$\dot{x} < v_1$", 2: r"$v_1 < \dot{x} < v_2$", 3: r"$\dot{x} > v_2$"}


def coulomb(alpha: int) -> Any:
    """Return the constant force in a domain: A0 and, for each belt, its friction -mu FN sgn(v -
    v_lambda).
    """
    # p and q are how far v is from the belts' speeds; of v - v_lambda only the sign matters.
    first, second = sp.symbols("p q", positive=True)
    if alpha == 1:
        slip1 = -first
    else:
        slip1 = first
    if alpha == 3:
        slip2 = second
    else:
        slip2 = -second
    return A0 - mu1 * FN * sp.sign(slip1) - mu2 * FN * sp.sign(slip2)


def acceleration(alpha: int) -> Any:
    """Return F^(alpha)(x, v, t) in the paper's notation: eq. (9) with A_alpha of the domain."""
    return solution.in_paper_letters(solution.acceleration()).subs(
        solution.A, solution.force_constant(alpha)
    )


@cache
def newton(alpha: int) -> Any:
    """Return the acceleration in a domain, solved from Newton's law with Coulomb friction."""
    a = sp.Symbol("a")
    return sp.solve(m * a + c * v + k * x - coulomb(alpha) - B0 * sp.cos(Omega * t), a)[0]


def balance(place: Any, speed: Any, phase: Any) -> Any:
    """Return the acceleration by the balance of forces in a domain, at a position, velocity and
    phase.
    """
    # Typed anew: what the other chapters print comes from `symosc.symbolic.solution`.
    return (solution.A + B0 * sp.cos(phase) - k * place - c * speed) / m


def stick_force(belt: int) -> Any:
    """Return the sum of all other forces on a mass that moves with a belt, without that belt's
    friction: eq. (2).
    """
    # The upper belt pulls a mass on the lower one up, the lower belt one on the upper one down.
    other_belt = 3 - belt
    pull = MU[other_belt] * FN * (1 if other_belt == 2 else -1)
    return A0 + B0 * WAVE - k * x - c * BELTS[belt] + pull


def at_each_belt(scope: Scope) -> Check:
    """Return the check that a step, written for a belt lambda, holds for each belt that occurs in
    `scope`.
    """
    meanings = []
    for belt in scope.boundaries:
        lower, upper = (newton(alpha).subs(v, BELTS[belt]) for alpha in NEIGHBOURS[belt])
        meanings.append({F(LOWER): lower, F(UPPER): upper, HELD: stick_force(belt)})
        meanings[-1] |= {mu_lambda: MU[belt], v_lambda: BELTS[belt]}
    return cases(*map(exact, meanings))


def items(scope: Scope) -> Items:
    """Yield the chapter: forces, domains, monotone friction, uniqueness, and what a belt has to
    hold.
    """
    yield _balance()
    yield _domains(scope)
    yield _monotone(scope)


def _balance() -> Items:
    """Yield the items on the balance of forces."""
    total = named(r"m\ddot{x}")
    first = named("T_1")
    second = named("T_2")
    checks = (
        exact({total: m * newton(alpha), first: sign_1 * mu1 * FN, second: sign_2 * mu2 * FN})
        for alpha, (sign_1, sign_2) in enumerate(((1, 1), (-1, 1), (-1, -1)), 1)
    )
    yield (
        r"\subsection{The balance of forces}",
        r"A mass $m > 0$ at the position $x(t)$ is held by a spring of stiffness $k \ge 0$ and a "
        r"damper with the coefficient $c \ge 0$, and driven by the force $A_0 + B_0\cos\Omega t$ "
        r"with the frequency $\Omega > 0$. Two belts are pressed against it with the normal force "
        r"$F_N \ge 0$ each; belt $\lambda$ runs with the constant speed $v_\lambda$, $\lambda = 1, "
        r"2$, and $v_1 < v_2$. With the friction $T_\lambda$ that belt $\lambda$ exerts on the "
        r"mass, Newton's law is",
        equation(total, A0 + B0 * WAVE - k * x - c * v + first + second, cases(*checks), "newton"),
        r"\begin{definition}[Coulomb friction]\label{thm:motion-coulomb} Let "
        r"$\operatorname{Sgn}(s) = \{1\}$ for $s > 0$, $\{-1\}$ for $s < 0$, and $[-1, 1]$ for $s "
        r"= 0$. With the friction coefficients $\mu_\lambda \ge 0$ the friction of belt $\lambda$ "
        r"is a force $T_\lambda \in -\mu_\lambda F_N \operatorname{Sgn}(\dot{x} - v_\lambda)$: it "
        r"opposes the sliding of the mass on the belt, and is whatever is needed, within "
        r"$\mu_\lambda F_N$, while the mass does not slide.\end{definition}",
        r"\begin{definition}[motion, in the sense of Filippov]\label{thm:motion-motion} A "
        r"\emph{motion} is a function $x(t)$ with an absolutely continuous velocity that satisfies "
        r"\eqref{eq:motion-newton}, with friction as in Definition~\ref{thm:motion-coulomb}, for "
        r"almost all $t$.\end{definition}",
        r"This is Filippov's notion of a solution \cite{filippov1988} for an equation whose right "
        r"side jumps at $\dot{x} = v_1$ and $\dot{x} = v_2$. Figure~\ref{fig:motion-friction} "
        r"shows $T_1 + T_2$; the paper's (1) has $-(T_1 + T_2)$, the resistance.",
        Illustration(
            "friction",
            "fig:motion-friction",
            r"The friction of both belts against the velocity $\dot{x}$ of the mass. At the speed "
            r"of a belt its friction can take every value of an interval (thick).",
            0.75,
        ),
    )


def _domains(scope: Scope) -> Items:
    """Yield the items on domains and boundaries."""
    ode = named(r"m\ddot{x} + c\dot{x} + k x")
    A = solution.A
    free = {ode: m * solution.in_paper_letters(solution.acceleration()) + c * v + k * x}
    general = F(r"\alpha")
    rows = []
    for alpha in scope.domains:
        constant = equation(named(f"A_{alpha}"), solution.force_constant(alpha), coulomb(alpha))
        frictions = [rf"${'-' if alpha > belt else ''}\mu_{belt} F_N$" for belt in (1, 2)]
        rows.append((rf"$\Omega_{alpha}$", VELOCITIES[alpha], *frictions, constant))

    gap = 2 * mu_lambda * FN / m
    laws = (exact({general: newton(a), A: solution.force_constant(a)}) for a in scope.domains)
    yield (
        r"\subsection{Domains and boundaries}",
        r"The velocities of the belts cut the phase plane into the open domains $\Omega_1 = "
        r"\{\dot{x} < v_1\}$, $\Omega_2 = \{v_1 < \dot{x} < v_2\}$ and $\Omega_3 = \{\dot{x} > "
        r"v_2\}$, with the boundaries $\partial\Omega_{12} = \{\dot{x} = v_1\}$ and "
        r"$\partial\Omega_{23} = \{\dot{x} = v_2\}$ between them. Boundary $\lambda$ lies between "
        r"$\Omega_\lambda$ below and $\Omega_{\lambda+1}$ above. In a domain $\Omega_\alpha$ both "
        r"frictions are constant, and add to the constant part of the drive: $A_\alpha = A_0 + T_1 "
        r"+ T_2$ (Table~\ref{tab:motion-constants}). So the motion obeys",
        equation(ode, A + B0 * WAVE, free, note=r"in $\Omega_\alpha$,", label="domain"),
        r"or $\ddot{x} = F^{(\alpha)}(x, \dot{x}, t)$ with the acceleration",
        equation(general, (A + B0 * WAVE - k * x - c * v) / m, cases(*laws), "acceleration"),
        Table(
            "tab:motion-constants",
            r"The domains, the frictions in them, and $A_\alpha$.",
            ("domain", "velocities", "$T_1$", "$T_2$", r"$A_\alpha$"),
            tuple(rows),
        ),
        r"\begin{lemma}[no boundary repels]\label{thm:motion-jump} Where $\dot{x} = v_\lambda$, "
        r"the accelerations below and above the boundary differ by",
        equation(F(LOWER) - F(UPPER), gap, at_each_belt(scope), "jump"),
        r"which is not negative,",
        step(gap, ">=", 0, sign()),
        r"so that the flow never leaves a boundary to both sides at once.\end{lemma}",
        r"\begin{proof} Subtract \eqref{eq:motion-acceleration} for $\alpha = \lambda + 1$ from "
        r"that for $\alpha = \lambda$, with Table~\ref{tab:motion-constants}. To leave downward "
        r"needs $F^{(\lambda)} < 0$ or $= 0$, to leave upward $F^{(\lambda+1)} > 0$ or $= 0$, "
        r"which together contradict \eqref{eq:motion-jump} unless both vanish and $\mu_\lambda F_N "
        r"= 0$; then the belt has no friction and there is no boundary. The paper's assumption "
        r"$\mu_1 \ge \mu_2$ is not needed.\end{proof}",
    )


def _monotone(scope: Scope) -> Items:
    """Yield the items on monotone friction, and the force of a stick."""
    y = named("y")
    rate = named(r"\dot{y}")
    energy = named(r"\frac{d}{dt}\Bigl(\frac{m}{2}\dot{y}^2 + \frac{k}{2}y^2\Bigr)")
    accelerated = named(r"\ddot{y}")
    difference = named(r"(T - \tilde{T})")
    meaning = {
        energy: m * rate * accelerated + k * y * rate,
        accelerated: (difference - c * rate - k * y) / m,
    }
    held = []
    for belt in scope.boundaries:
        mean = sp.expand(m * (acceleration(belt) + acceleration(belt + 1)) / 2).subs(v, BELTS[belt])
        held.append(equation(named(rf"F_{{s{belt}}}"), mean, stick_force(belt), f"held-{belt}"))
    yield (
        r"\subsection{Friction is monotone}",
        r"\begin{lemma}[monotone friction]\label{thm:motion-monotone} Let $T$ and $\tilde{T}$ be "
        r"possible values of $T_1 + T_2$ at the velocities $w$ and $\tilde{w}$. Then $(T - "
        r"\tilde{T})(w - \tilde{w}) \le 0$.\end{lemma}",
        facts(*(step(coulomb(a) - coulomb(a + 1), ">=", 0, sign()) for a in scope.domains[:-1])),
        r"\begin{proof} $s \mapsto \operatorname{Sgn}(s)$ never falls, so each $T_\lambda$ never "
        r"grows with the velocity: by Table~\ref{tab:motion-constants}, $A_1 - A_2 = 2\mu_1 F_N "
        r"\ge 0$ and $A_2 - A_3 = 2\mu_2 F_N \ge 0$, and at $\dot{x} = v_\lambda$ all values "
        r"between those on both sides are allowed.\end{proof}",
        r"\begin{theorem}[existence and uniqueness forward in time]\label{thm:motion-unique} "
        r"Through each $(t_0, x_0, \dot{x}_0)$ passes a motion, which exists for all $t \ge t_0$, "
        r"and for these $t$ it is the only one.\end{theorem}",
        r"\begin{proof} The right side of \eqref{eq:motion-newton} is a set that is convex, "
        r"closed, bounded for bounded velocities and upper semicontinuous in the state, and it "
        r"grows at most linearly, so motions exist for all later times \cite[Chapter "
        r"2]{filippov1988}. Let $y$ be the difference of two of them, and $T$, $\tilde{T}$ their "
        r"frictions. Then",
        equation(energy, difference * rate - c * rate**2, meaning, "energy"),
        r"almost everywhere, and by Lemma~\ref{thm:motion-monotone} this is at most $-c\dot{y}^2 "
        r"\le 0$. If both start alike the energy on the left stays 0, so $\dot{y} = 0$ for all "
        r"later times, and $y = 0$.\end{proof}",
        r"Backward in time motions are not unique: all that come to stick at one point of a belt "
        r"are one motion afterwards. The energy inequality returns in Chapter~\ref{sec:orbits}.",
        r"\subsection{The force that a stick has to hold}",
        r"\begin{proposition}[what the belt has to hold]\label{thm:motion-held} Let $F_{s\lambda}$ "
        r"be the sum of all forces on the mass but the friction of belt $\lambda$ while $\dot{x} = "
        r"v_\lambda$; for belt 1 it is the paper's (2),",
        held,
        r"On the two sides of the boundary the belt adds its friction forward and backward,",
        equation(m * F(LOWER), HELD + mu_lambda * FN, at_each_belt(scope), "held-sides"),
        equation(m * F(UPPER), HELD - mu_lambda * FN, at_each_belt(scope)),
        r"so that the mass can stay on the belt, $|F_{s\lambda}| \le \mu_\lambda F_N$, iff "
        r"$F^{(\lambda)} \ge 0 \ge F^{(\lambda+1)}$; and the product of the paper's section 6 is",
        equation(
            m**2 * F(LOWER) * F(UPPER),
            HELD**2 - mu_lambda**2 * FN**2,
            at_each_belt(scope),
            "product",
        ),
        r"\end{proposition}",
        r"\begin{proof} On the belt $\ddot{x} = 0$, so \eqref{eq:motion-newton} demands $T_\lambda "
        r"= -F_{s\lambda}$, which Definition~\ref{thm:motion-coulomb} allows iff $|F_{s\lambda}| "
        r"\le \mu_\lambda F_N$. Below the boundary $T_\lambda = \mu_\lambda F_N$, above it "
        r"$T_\lambda = -\mu_\lambda F_N$. A negative product means that $|F_{s\lambda}| < "
        r"\mu_\lambda F_N$, a positive one that the flow passes.\end{proof}",
    )
