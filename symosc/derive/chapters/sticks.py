"""Stick motion and both exits: eqs. (3), (4), (11), (12), (52), (53)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.chapters.motion import MU, acceleration, newton
from symosc.derive.latex import named
from symosc.derive.scope import BELTS, SIDES, F, Scope, v_lambda
from symosc.derive.steps import Exact, Heading, Prose, Relation, Sign, Step, equation
from symosc.symbolic import solution
from symosc.symbolic.solution import FN, Omega, a_i, k, m, t, tau, theta, theta_i, v, x_i

TITLE = "Stick motion and both exits"


def force_on_belt(angle: Any) -> Any:
    """Return F^(alpha) on a belt at tau, from eq. (9) at x_i + v_lambda tau, with the force fixed by its start."""
    here = solution.acceleration(x_i + v_lambda * tau, v_lambda, angle)
    start = solution.acceleration(x_i, v_lambda, theta_i)
    return a_i + here - start


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"On belt $\lambda$ the mass has $\dot{x} = v_\lambda$ and $\ddot{x} = 0$ (eqs.~(3), (4), (11), (12)). "
        r"It stays "
        r"there as long as $F^{(\mathrm{lo})} > 0$ below the belt's speed and $F^{(\mathrm{hi})} < 0$ above it."
    )
    position = named(r"x(\tau)")
    yield equation(
        position,
        x_i + v_lambda * tau,
        r"With $\tau = t - t_i$,",
        Exact({position: x_i + sp.integrate(v_lambda, (tau, 0, tau))}),
    )
    yield Heading("What changes on a belt")
    on_belt = named(r"F^{(\alpha)}(\tau)")
    wave = sp.cos(theta_i + Omega * tau) - sp.cos(theta_i)
    yield equation(
        on_belt,
        solution.stick_acceleration(a_i, wave).subs(v, v_lambda),
        r"Put into eq.~(9), with the value $\ddot{x}_i$ that $F^{(\alpha)}$ has at $t_i$, this is",
        Exact({on_belt: force_on_belt(theta_i + Omega * tau)}, sp.expand),
    )
    rate = named(r"m \dot{F}^{(\alpha)}")
    moving = solution.in_paper_letters(solution.acceleration(x_i + v_lambda * (t - solution.t_i), v_lambda, theta))
    yield equation(
        rate,
        -(k * v_lambda + solution.B0 * Omega * sp.sin(Omega * t)),
        r"Both $F^{(\mathrm{lo})}$ and $F^{(\mathrm{hi})}$ change at the same rate, which no longer has the "
        r"state in it. "
        r"They are monotone between the phases where it vanishes; these are the phases $\Theta^{\mathrm{cr}}$ and "
        r"$\pi - \Theta^{\mathrm{cr}}$ of Theorem~7:",
        Exact({rate: m * moving.diff(t)}, sp.expand),
    )
    yield Heading("Both exits")
    yield Prose(
        r"A stick ends when one of the two forces reaches 0, whichever is first: $F^{(\mathrm{lo})}$ falls to 0 "
        r"and the "
        r"mass slips into the domain below, or $F^{(\mathrm{hi})}$ rises to 0 and it slips into the domain above. "
        r"Eqs.~(52) and (53) have only one exit each."
    )
    for belt in scope.boundaries:
        lo, hi = SIDES[belt]
        for alpha in (lo, hi):
            only = {1: 2, 2: 3}[belt]
            paper = {1: "52", 2: "53"}[belt]
            says = f"eq.~({paper})" if alpha == only else f"missing in eq.~({paper})"
            meaning = {F(alpha): newton(alpha).subs(v, BELTS[belt])}
            yield equation(
                m * F(alpha),
                sp.expand(m * acceleration(alpha).subs(v, BELTS[belt])),
                rf"Belt {belt} is left into $\Omega_{alpha}$ where this vanishes ({says}):",
                Exact(meaning, sp.expand),
            )
        meaning = {F(alpha): newton(alpha).subs(v, BELTS[belt]) for alpha in (lo, hi)}
        yield equation(
            F(hi),
            F(lo) - 2 * MU[belt] * FN / m,
            r"The exits exclude each other if the belt has friction: where one force vanishes the other still holds, "
            r"since",
            Exact(meaning, sp.expand),
        )
        zero = named(rf"F^{{({hi})}}|_{{F^{{({lo})}} = 0}}")
        lower = {zero: -(newton(lo) - newton(hi))}
        yield Step(Relation(zero, "<=", sp.Integer(0)), "", Sign(lower))
