"""Governing equations of P1 to P8: eqs. (50) to (54)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.latex import named
from symosc.derive.scope import BELTS, SIDES, Scope
from symosc.derive.steps import Exact, Heading, Prose, Solves, equation
from symosc.symbolic import maps, solution
from symosc.symbolic.solution import A_m, Omega, a_i, c, f0, k, m, tau, theta_i, v_i, x_i
from symosc.words import MAPS, Map

TITLE = r"Governing equations of $P_1$ to $P_8$"


def force(alpha: int, x: Any, v: Any, theta: Any) -> Any:
    """Return F^(alpha) at a point, with the A_alpha of the domain."""
    return solution.acceleration(x, v, theta).xreplace({A_m: solution.force_constant(alpha) / m})


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"A mapping leads from the switching point $(x_i, \Omega t_i)$ to the next one, $(x_{i+1}, \Omega "
        r"t_{i+1})$; the "
        r"velocities are those of the belts (eq.~(51)). With $\theta = \Omega t$ and "
        r"$\tau = (\theta_{i+1} - \theta_i)/\Omega$ its two governing equations are $f_1 = 0$ and $f_2 = 0$ "
        r"(eq.~(54)). "
        r"All flights are the motion of the domain, with $A_\alpha$ and the speeds of the belts put in; $\tau$ must be "
        r"the first positive root of $f_2$."
    )
    for label in scope.maps:
        row = MAPS[label]
        yield Heading(_title(row))
        yield from _stick(row) if row.sticks else _flight(row)


def _title(row: Map) -> str:
    planes = [rf"\Sigma^{{{plane.superscript}}}_{{({plane.boundary})}}" for plane in (row.start, row.end)]
    what = f"stick on belt {row.start.boundary}" if row.sticks else rf"flight in $\Omega_{row.domain}$"
    return rf"$P_{row.label[1]}\colon {planes[0]} \to {planes[1]}$, {what}"


def _flight(row: Map) -> Iterator[Any]:
    start, end = BELTS[row.start.boundary], BELTS[row.end.boundary]
    letters = {v_i: start, maps.v_j: end}
    first, second = (expr.xreplace(letters) for expr in maps.flight_residual().values())
    number = row.label[1]
    acceleration = force(row.domain, x_i, start, theta_i)
    newton = solution.in_paper_letters(solution.acceleration(x_i, start, theta_i))
    newton = newton.subs(solution.A, solution.force_constant(row.domain)).subs(Omega * solution.t_i, theta_i)
    yield equation(
        a_i,
        _flat(acceleration),
        rf"It starts with $\dot{{x}}_i = {_speed(row.start.boundary)}$ and the acceleration of $\Omega_{row.domain}$ "
        rf"(eq.~(9) with $A_{row.domain}$),",
        Exact({a_i: newton} | _PAPER, sp.expand),
    )
    driven = solution._force_at_start().xreplace({v_i: start}) + f0 * sp.cos(theta_i + Omega * tau)
    yield equation(
        named(rf"f_1^{{({number})}}"),
        first,
        rf"and ends on $\dot{{x}} = {_speed(row.end.boundary)}$ at $x_{{i+1}}$:",
        Solves(driven, x_i, start, shift=maps.x_j, general=True),
    )
    name = named(rf"f_2^{{({number})}}")
    check = Exact({name: solution.time_derivative(first) - end}, solution.use_relations, independent=False)
    yield equation(name, second, "", check)


_PAPER = {solution.cm: c / m, solution.w0sq: k / m, f0: solution.B0 / m}


def _flat(expr: Any) -> Any:
    return sp.expand(expr)


def _speed(boundary: int) -> str:
    return f"v_{boundary}"


def _stick(row: Map) -> Iterator[Any]:
    belt = row.start.boundary
    speed = BELTS[belt]
    lo, hi = SIDES[belt]
    name = named(rf"f_1^{{({row.label[1]})}}")
    yield equation(
        name,
        maps.stick_residual()["f1"].xreplace({v_i: speed}),
        "The mass rides on the belt,",
        Exact({name: x_i + sp.integrate(speed, (tau, 0, tau)) - maps.x_j}, sp.expand),
    )
    reason = "until one of the forces vanishes, whichever is first:"
    for alpha, where in ((lo, "below"), (hi, "above")):
        name = named(rf"f_2^{{({row.label[1]})}}")
        right = maps.stick_residual()["f2"].xreplace({v_i: speed, A_m: solution.force_constant(alpha) / m})
        true = solution.in_paper_letters(solution.acceleration(maps.x_j, speed, maps.theta_j))
        true = true.subs(solution.A, solution.force_constant(alpha))
        check = Exact({name: true} | _PAPER, sp.expand)
        yield equation(name, _flat(right), reason, check, rf"(slips {where}, into $\Omega_{alpha}$)")
        reason = ""
