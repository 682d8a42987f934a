"""Governing equations of P1 to P8: eqs. (49) to (54)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.blocks import Table, block, proof
from symosc.derive.latex import latex, named
from symosc.derive.scope import BELTS, Scope, v_lambda
from symosc.derive.steps import Exact, Heading, Prose, Solves, equation
from symosc.model import NEIGHBOURS
from symosc.symbolic import maps, solution
from symosc.symbolic.solution import A_m, Omega, a_i, f0, m, tau, theta_i, v_i, x_i
from symosc.words import MAPS, Map

TITLE = "Switching planes and mappings"
#: The speed of the belt where a flight ends.
V_END = named(r"v_{\lambda'}")
F1, F2 = named("f_1"), named("f_2")


def force(alpha: int, x: Any, v: Any, theta: Any) -> Any:
    """Return F^(alpha) at a point, with the A_alpha of the domain."""
    return solution.acceleration(x, v, theta).xreplace({A_m: solution.force_constant(alpha) / m})


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _planes(scope)
    yield from _flights()
    yield from _sticks()
    if scope.scene is not None:
        yield from _with_numbers(scope)


def _planes(scope: Scope) -> Iterator[Any]:
    yield from block(
        "definition",
        r"On the boundary $\dot{x} = v_\lambda$ there are three \emph{switching planes}, sets of points "
        r"$(x, \theta)$ with the phase $\theta = \Omega t$ modulo $2\pi$: $\Sigma^0_{(\lambda)}$ for a mass that rides "
        r"on the belt, $\Sigma^1_{(\lambda)}$ for one that comes from $\Omega_\lambda$ or goes into it, and "
        r"$\Sigma^2_{(\lambda)}$ for $\Omega_{\lambda+1}$. The eight \emph{basic mappings} take a switching point "
        r"$(x_i, \theta_i)$ to the next one, $(x_{i+1}, \theta_{i+1})$; Table~\ref{tab:maps-maps} lists them.",
        title="switching planes and mappings, the paper's (49) to (51)",
        label="thm:maps-planes",
    )
    rows: list[Any] = []
    for label in scope.maps:
        row = MAPS[label]
        belt, other = row.start.boundary, row.end.boundary
        if row.sticks:
            lo, hi = NEIGHBOURS[belt]
            rows.append((f"$P_{label[1]}$", *_between(row), f"stick on belt {belt}", f"{lo} or {hi}", belt, belt))
            continue
        rows.append((f"$P_{label[1]}$", *_between(row), rf"flight in $\Omega_{row.domain}$", row.domain, belt, other))
    yield Table(
        "tab:maps-maps",
        r"The basic mappings. A flight goes through $\Omega_\alpha$ from $\dot{x} = v_\lambda$ to "
        r"$\dot{x} = v_{\lambda'}$; a stick slips into $\Omega_\alpha$.",
        ("mapping", "from", "to", "motion", r"$\alpha$", r"$\lambda$", r"$\lambda'$"),
        tuple(rows),
    )
    yield Prose(
        r"A word such as $P_{32} = P_3 \circ P_2$ is read from right to left: $P_2$ is applied first. In the paper's "
        r"(49) the planes are told apart by limits $v_\lambda^{\pm} = \lim_{\delta\to 0}(v_\lambda \pm \delta)$, which "
        r"all equal $v_\lambda$; what tells them apart is the side, and that is meant here."
    )


def _between(row: Map) -> tuple[str, str]:
    first, last = (rf"$\Sigma^{{{plane.superscript}}}_{{({plane.boundary})}}$" for plane in (row.start, row.end))
    return first, last


def _flights() -> Iterator[Any]:
    yield Heading("The governing equations")
    letters = {v_i: v_lambda, maps.v_j: V_END}
    first, second = (expr.xreplace(letters) for expr in maps.flight_residual().values())
    driven = solution._force_at_start().xreplace({v_i: v_lambda}) + f0 * sp.cos(theta_i + Omega * tau)
    newton = sp.solve(solution.acceleration(x_i, v_lambda, theta_i) - a_i, a_i)[0]
    by_rate = {F2: solution.time_derivative(first) - V_END}
    yield from block(
        "theorem",
        r"A flight through $\Omega_\alpha$ from $(x_i, \theta_i)$ on $\dot{x} = v_\lambda$ to "
        r"$(x_{i+1}, \theta_{i+1})$ on $\dot{x} = v_{\lambda'}$ takes the time $\tau$ and satisfies $f_1 = f_2 = 0$ "
        r"with",
        equation(
            tau,
            (maps.theta_j - theta_i) / Omega,
            "",
            Exact({maps.theta_j: theta_i + Omega * tau}),
            label="maps-tau",
        ),
        equation(
            F1,
            first,
            "",
            Solves(driven, x_i, v_lambda, shift=maps.x_j, general=True),
            label="maps-f1",
        ),
        equation(F2, second, "", Exact(by_rate, solution.use_relations, independent=False), label="maps-f2"),
        equation(
            a_i,
            solution.acceleration(x_i, v_lambda, theta_i),
            r"where the basis functions are taken at $\tau$, and",
            Exact({a_i: newton}, sp.expand),
            label="maps-start",
        ),
        r"with $(\alpha, \lambda, \lambda')$ from Table~\ref{tab:maps-maps}. Conversely, a solution is a flight if the "
        r"motion goes into $\Omega_\alpha$ at $\tau = 0$ and $\tau$ is the first positive time at which it meets a "
        r"boundary.",
        title="flights, the paper's (54)",
        label="thm:maps-flight",
    )
    yield from proof(
        r"$f_1$ and $f_2$ are the position and velocity of Theorem~\ref{thm:domains-flow} minus where the flight ends."
    )
    yield Prose(
        r"The mappings differ in $A_\alpha$ and in the two speeds alone, so this is all six flights. It goes into "
        r"$\Omega_\alpha$ at the start by the first G-function that does not vanish, Lemma~\ref{thm:switching-side}. "
        r"That $\tau$ is the first time has to be checked for the other belt too: the equations of $P_3$ know nothing "
        r"of $v_2$. Chapter~\ref{sec:events} tells how."
    )


def _sticks() -> Iterator[Any]:
    residual = maps.stick_residual()
    ride, end = (residual[key].xreplace({v_i: v_lambda}) for key in ("f1", "f2"))
    newton = sp.solve(solution.acceleration(maps.x_j, v_lambda, maps.theta_j) - a_i, a_i)[0]
    yield from block(
        "theorem",
        r"A stick on belt $\lambda$ that slips into $\Omega_\alpha$, $\alpha = \lambda$ or $\lambda + 1$, satisfies "
        r"$f_1 = f_2 = 0$ with",
        equation(
            F1,
            ride,
            "",
            Exact({F1: x_i + sp.integrate(v_lambda, (tau, 0, tau)) - maps.x_j}, sp.expand),
            label="maps-stick-f1",
        ),
        equation(F2, end, "", Exact({F2: newton}, sp.expand), label="maps-stick-f2"),
        r"where $\tau = (\theta_{i+1} - \theta_i)/\Omega$. Conversely, a solution is a stick if "
        r"$F^{(\lambda)} \ge 0 \ge F^{(\lambda+1)}$ from $\theta_i$ to $\theta_{i+1}$, and the force that vanishes "
        r"changes its sign there.",
        title="sticks, the paper's (52) and (53) with both exits",
        label="thm:maps-stick",
    )
    yield from proof(r"This is \eqref{eq:sticks-x} and Theorem~\ref{thm:sticks-exits}.")


def _with_numbers(scope: Scope) -> Iterator[Any]:
    yield Heading("With the numbers of the scene")
    for label in scope.maps:
        row = MAPS[label]
        if row.sticks:
            yield Prose(rf"$P_{label[1]}$ rides on belt {row.start.boundary} with the speed below, and slips into")
            for alpha in NEIGHBOURS[row.start.boundary]:
                name = named(rf"f_2^{{({label[1]})}}")
                right = sp.expand(force(alpha, maps.x_j, BELTS[row.start.boundary], maps.theta_j))
                true = force(alpha, maps.x_j, BELTS[row.start.boundary], maps.theta_j)
                yield equation(name, right, rf"$\Omega_{alpha}$ where", Exact({name: true}, sp.expand))
            continue
        start = BELTS[row.start.boundary]
        words = rf"$P_{label[1]}$ starts with"
        true = force(row.domain, x_i, start, theta_i)
        yield equation(a_i, sp.expand(true), words, Exact({a_i: true}, sp.expand))
        speeds = rf"v_{row.start.boundary}", rf"v_{row.end.boundary}"
        yield Prose(
            rf"and with ${latex(scope.shown(start))}$ for $v_\lambda = {speeds[0]}$ and "
            rf"${latex(scope.shown(BELTS[row.end.boundary]))}$ for $v_{{\lambda'}} = {speeds[1]}$ in "
            r"Theorem~\ref{thm:maps-flight}."
        )
