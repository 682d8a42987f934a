"""G-functions and Theorems 4 to 6: eqs. (18), (19), (26) to (48)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.latex import named
from symosc.derive.scope import SIDES, F, G, Scope
from symosc.derive.steps import Exact, Heading, Prose, equation
from symosc.symbolic import solution
from symosc.symbolic.solution import B0, Omega, a_i, c, k, m, t, tau, theta, theta_i, v, v_i, x_i

TITLE = "G-functions and Theorems 4 to 6"


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"The boundaries are $\dot{x} = v_\lambda$ with the normal $n = (0, 1)^{T}$ (eq.~(25)), so that eqs.~(18) and "
        r"(19) reduce to derivatives of $\dot{x}$ along the flow of one domain: $G^{(0,\alpha)} = F^{(\alpha)}$ and "
        r"$G^{(n,\alpha)} = d^n F^{(\alpha)}/dt^n$."
    )
    yield from _functions()
    yield from _local()
    yield from _theorems(scope)


def _functions() -> Iterator[Any]:
    yield Heading("The G-functions")
    acceleration = named(r"F^{(\alpha)}")
    path = sp.Function("x")(t)
    # d^n/dt^n of eq. (9) along a motion x(t) of the domain, with x'' = F put back in
    newton = (solution.A + B0 * sp.cos(Omega * t) - c * path.diff(t) - k * path) / m
    waves = [sp.cos(Omega * t).diff(t, n) * B0 / m for n in range(4)]
    lower = [v, acceleration]
    for n in (1, 2, 3):
        name = G(n)
        derivative = newton.diff(t, n)
        names = {path.diff(t, order + 1): lower[order] for order in range(n + 1)}
        true = derivative.doit().subs([(path.diff(t, j + 1), names[path.diff(t, j + 1)]) for j in range(n, -1, -1)])
        reason = r"Differentiating eq.~(9) along the motion gives eq.~(47), and by repeating it every higher order:"
        wave = solution.forcing(n).subs(theta, Omega * t).xreplace({solution.f0: B0 / m})
        shown = solution.next_derivative(lower[n], lower[n - 1], wave)
        shown = shown.xreplace({solution.cm: c / m, solution.w0sq: k / m})
        assert waves[n] is not None
        yield equation(name, shown, reason if n == 1 else "", Exact({name: true}, sp.expand))
        lower.append(name)


def _local() -> Iterator[Any]:
    yield Heading("What they decide")
    flow = solution.flow()
    at_start = solution.start_values() | {tau: sp.Integer(0)}
    values, derivative = [], flow.v
    for _ in range(4):
        derivative = solution.time_derivative(derivative)
        values.append(sp.expand(derivative.subs(at_start)))
    gap = named(r"\dot{x}(\tau) - v_\lambda")
    orders = [F(r"\alpha"), *(G(n) for n in (1, 2, 3))]
    taylor = sp.Add(*(g * tau ** (n + 1) / sp.factorial(n + 1) for n, g in enumerate(orders)))
    meaning: dict[Any, Any] = {gap: sp.Add(*(g * tau ** (n + 1) / sp.factorial(n + 1) for n, g in enumerate(values)))}
    here = {solution.x: x_i, v: v_i, theta: theta_i, solution.A_m: solution._force_at_start()}
    for n, g in enumerate(orders):
        meaning[g] = solution.g_function(n).xreplace(here)
    assert a_i in flow.a.free_symbols
    yield equation(
        gap,
        taylor,
        r"The velocity at $\tau$ after a contact, from the closed form of the flow, is up to terms of order $\tau^5$",
        Exact(meaning, sp.expand),
    )
    yield Prose(
        r"Hence the first G-function that does not vanish tells on which side of the boundary the flow of a domain is "
        r"after the contact, and by the sign of $\tau^n$ for $\tau < 0$ also before it: a first term of odd power "
        r"crosses, one of even power touches."
    )


def _theorems(scope: Scope) -> Iterator[Any]:
    for belt in scope.boundaries:
        lo, hi = SIDES[belt]
        yield Heading(rf"The boundary $\partial\Omega_{{{lo}{hi}}}$")
        yield Prose(
            rf"\emph{{Theorem 4.}} The flow of $\Omega_{lo}$ reaches the boundary from below if $F^{{({lo})}} > "
            rf"0$, that of "
            rf"$\Omega_{hi}$ reaches it from above if $F^{{({hi})}} < 0$. With both, neither flow can leave: the mass "
            rf"sticks. \emph{{Theorem 5.}} With $F^{{({lo})}} F^{{({hi})}} > 0$ one flow arrives and the other "
            rf"leaves to the "
            rf"other side: upward if both are positive, downward if both are negative. \emph{{Theorem 6.}} With "
            rf"$F^{{({lo})}} = 0$ the flow of $\Omega_{lo}$ touches from below iff $G^{{(1,{lo})}} < 0$; with "
            rf"$F^{{({hi})}} = 0$ "
            rf"the flow of $\Omega_{hi}$ touches from above iff $G^{{(1,{hi})}} > 0$."
        )
        for alpha in (lo, hi):
            name = named(rf"G^{{(1,{alpha})}}")
            true = solution.in_paper_letters(solution.along_flow(solution.acceleration()))
            shown = -c * F(alpha) / m - k * v / m - B0 * Omega * sp.sin(Omega * t) / m
            general = solution.in_paper_letters(solution.acceleration())
            yield equation(
                name,
                shown,
                "The derivative that decides it is" if alpha == lo else "",
                Exact({name: true, F(alpha): general}, sp.expand),
            )
