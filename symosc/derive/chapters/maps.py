"""Governing equations of P1 to P8: eqs. (49) to (54)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from symosc.derive.chapters.motion import balance
from symosc.derive.scope import BELTS, Scope, v_lambda
from symosc.derive.steps import Items, Table, equation, exact, solves
from symosc.friction import MAPS, NEIGHBOURS
from symosc.symbolic import maps, solution
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import A_m, Omega, a_i, f0, m, tau, theta_i, v_i, w0sq, x_i

TITLE = "Switching planes and mappings"
#: The speed of the belt where a flight ends.
V_END = named(r"v_{\lambda'}")
F1 = named("f_1")
F2 = named("f_2")


def force(alpha: int, x: Any, v: Any, theta: Any) -> Any:
    """Return the force per mass F^(alpha), the acceleration, at (x, v, theta), with the domain's
    A_alpha put in.
    """
    return solution.acceleration(x, v, theta).xreplace({A_m: solution.force_constant(alpha) / m})


def items(scope: Scope) -> Items:
    """Yield the chapter: switching planes, the eight mappings, and the equations of flights and
    sticks.
    """
    rows: list[Any] = []
    for label in scope.maps:
        row = MAPS[label]
        belt = row.start.boundary
        target = row.end.boundary
        planes = [
            rf"$\Sigma^{{{plane.superscript}}}_{{({plane.boundary})}}$"
            for plane in (row.start, row.end)
        ]
        motion = rf"flight in $\Omega_{row.domain}$"
        domain = str(row.domain)
        if row.sticks:
            motion = f"stick on belt {belt}"
            domain = " or ".join(map(str, NEIGHBOURS[belt]))
        rows.append((f"$P_{label[1]}$", *planes, motion, domain, belt, target))
    yield (
        r"\begin{definition}[switching planes and mappings, the paper's (49) to "
        r"(51)]\label{thm:maps-planes} On the boundary $\dot{x} = v_\lambda$ there are three "
        r"\emph{switching planes}, sets of points $(x, \theta)$ with the phase $\theta = \Omega t$ "
        r"modulo $2\pi$: $\Sigma^0_{(\lambda)}$ for a mass that rides on the belt, "
        r"$\Sigma^1_{(\lambda)}$ for one that comes from $\Omega_\lambda$ or goes into it, and "
        r"$\Sigma^2_{(\lambda)}$ for $\Omega_{\lambda+1}$. The eight \emph{basic mappings} take a "
        r"switching point $(x_i, \theta_i)$ to the next one, $(x_{i+1}, \theta_{i+1})$; "
        r"Table~\ref{tab:maps-maps} lists them.\end{definition}",
        Table(
            "tab:maps-maps",
            r"The basic mappings. A flight goes through $\Omega_\alpha$ from $\dot{x} = v_\lambda$ "
            r"to $\dot{x} = v_{\lambda'}$; a stick slips into $\Omega_\alpha$.",
            ("mapping", "from", "to", "motion", r"$\alpha$", r"$\lambda$", r"$\lambda'$"),
            tuple(rows),
        ),
        r"A word such as $P_{32} = P_3 \circ P_2$ is read from right to left: $P_2$ is applied "
        r"first. The paper's (49) distinguishes the planes by limits $v_\lambda^{\pm} = "
        r"\lim_{\delta\to 0}(v_\lambda \pm \delta)$, which all equal $v_\lambda$; what "
        r"distinguishes them is the side, which is meant here.",
    )
    letters = {v_i: v_lambda, maps.v_j: V_END}
    first, second = (expr.xreplace(letters) for expr in maps.flight_residual().values())
    driven = A_m + f0 * sp.cos(theta_i + Omega * tau)
    newton = {a_i: balance(x_i, v_lambda, theta_i), **solution.PAPER_LETTERS}
    back = {
        solution.c: m * solution.cm,
        solution.k: m * w0sq,
        solution.B0: m * f0,
        solution.A: m * A_m,
    }
    by_newton = {a_i: sp.expand(newton[a_i].xreplace(back))}
    by_rate = {F2: solution.time_derivative(first) - V_END}
    yield (
        r"\subsection{The governing equations}",
        r"\begin{theorem}[flights, the paper's (54)]\label{thm:maps-flight} A flight through "
        r"$\Omega_\alpha$ from $(x_i, \theta_i)$ on $\dot{x} = v_\lambda$ to $(x_{i+1}, "
        r"\theta_{i+1})$ on $\dot{x} = v_{\lambda'}$ takes the time $\tau$ and satisfies $f_1 = "
        r"f_2 = 0$ with",
        equation(
            tau, (maps.theta_j - theta_i) / Omega, {maps.theta_j: theta_i + Omega * tau}, "tau"
        ),
        equation(
            F1,
            first,
            solves(driven - w0sq * maps.x_j, x_i - maps.x_j, v_lambda, meaning=by_newton),
            "f1",
        ),
        equation(F2, second, exact(by_rate, solution.use_relations), "f2"),
        r"where the basis functions are taken at $\tau$, and",
        equation(a_i, solution.acceleration(x_i, v_lambda, theta_i), newton, "start"),
        r"with $(\alpha, \lambda, \lambda')$ from Table~\ref{tab:maps-maps}. Conversely, a "
        r"solution is a flight if the motion goes into $\Omega_\alpha$ at $\tau = 0$ and $\tau$ is "
        r"the first positive time at which it meets a boundary.\end{theorem}",
        r"\begin{proof} $f_1$ and $f_2$ are the position and velocity of "
        r"Theorem~\ref{thm:domains-flow} minus where the flight ends.\end{proof}",
        r"The mappings differ in $A_\alpha$ and in the two speeds alone, so this is all six "
        r"flights. It goes into $\Omega_\alpha$ at the start by the first G-function that does not "
        r"vanish, Lemma~\ref{thm:switching-side}. That $\tau$ is the first time has to be checked "
        r"for the other belt too: the equations of $P_3$ do not contain $v_2$. "
        r"Chapter~\ref{sec:events} explains how.",
    )
    residual = maps.stick_residual()
    ride, end = (residual[key].xreplace({v_i: v_lambda}) for key in ("f1", "f2"))
    newton = {F2: balance(maps.x_j, v_lambda, maps.theta_j), **solution.PAPER_LETTERS}
    yield (
        r"\begin{theorem}[sticks, the paper's (52) and (53) with both exits]\label{thm:maps-stick} "
        r"A stick on belt $\lambda$ that slips into $\Omega_\alpha$, $\alpha = \lambda$ or "
        r"$\lambda + 1$, satisfies $f_1 = f_2 = 0$ with",
        equation(F1, ride, x_i + sp.integrate(v_lambda, (tau, 0, tau)) - maps.x_j, "stick-f1"),
        equation(F2, end, newton, "stick-f2"),
        r"where $\tau = (\theta_{i+1} - \theta_i)/\Omega$. Conversely, a solution is a stick if "
        r"$F^{(\lambda)} \ge 0 \ge F^{(\lambda+1)}$ from $\theta_i$ to $\theta_{i+1}$, and the "
        r"force that vanishes changes its sign there.\end{theorem}",
        r"\begin{proof} This is \eqref{eq:sticks-x} and Theorem~\ref{thm:sticks-exits}.\end{proof}",
    )
    if scope.scene:
        yield _with_numbers(scope)


def _with_numbers(scope: Scope) -> Items:
    """Return the section with the mappings in the scene's numbers."""
    parts: list[Any] = [r"\subsection{With the numbers of the scene}"]
    for label in scope.maps:
        row = MAPS[label]
        letter = f"P_{label[1]}"
        start = BELTS[row.start.boundary]
        end = BELTS[row.end.boundary]
        if row.sticks:
            parts.append(
                rf"${letter}$ rides on belt {row.start.boundary} with the speed below, and slips "
                r"into"
            )
            for alpha in NEIGHBOURS[row.start.boundary]:
                true = force(alpha, maps.x_j, start, maps.theta_j)
                name = named(rf"f_2^{{({label[1]})}}")
                parts += [rf"$\Omega_{alpha}$ where", equation(name, sp.expand(true), true)]
            continue
        true = force(row.domain, x_i, start, theta_i)
        parts += [
            rf"${letter}$ starts with",
            equation(a_i, sp.expand(true), true),
            rf"and with ${latex(scope.shown(start))}$ for $v_\lambda = v_{row.start.boundary}$ and "
            rf"${latex(scope.shown(end))}$ for $v_{{\lambda'}} = v_{row.end.boundary}$ in "
            r"Theorem~\ref{thm:maps-flight}.",
        ]
    return parts
