"""Equation of motion and friction law: eqs. (1) to (9)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.latex import named
from symosc.derive.scope import BELTS, SIDES, F, Scope
from symosc.derive.steps import Exact, Heading, Prose, Relation, Sign, Step, equation
from symosc.symbolic import solution
from symosc.symbolic.solution import A0, B0, FN, A_m, Omega, c, cm, f0, k, m, mu1, mu2, t, v, w0sq, x

TITLE = "Equation of motion and friction law"
MU = {1: mu1, 2: mu2}
WAVE = sp.cos(Omega * t)


def coulomb(alpha: int) -> Any:
    """Return A0 plus the friction of both belts, -mu F_N sgn(x' - v_lambda) each, at a velocity inside a domain."""
    gap = sp.symbols("p q", positive=True)
    slip1 = {1: -gap[0], 2: gap[0], 3: gap[0]}[alpha]
    slip2 = {1: -gap[1], 2: -gap[1], 3: gap[1]}[alpha]
    return A0 - mu1 * FN * sp.sign(slip1) - mu2 * FN * sp.sign(slip2)


def acceleration(alpha: int) -> Any:
    """Return F^(alpha)(x, v, t) in the paper's letters: eq. (9) with A_alpha of the domain."""
    return solution.in_paper_letters(solution.acceleration()).subs(solution.A, solution.force_constant(alpha))


def newton(alpha: int) -> Any:
    """Return the acceleration that Newton's law gives with Coulomb's friction."""
    a = sp.Symbol("a")
    return sp.solve(m * a + c * v + k * x - coulomb(alpha) - B0 * WAVE, a)[0]


def stick_force(belt: int) -> Any:
    """Return F_s of a belt: every force on the mass but this belt's friction (eq. (2) and its like for belt 2)."""
    lo, hi = SIDES[belt]
    total = m * (acceleration(lo) + acceleration(hi)) / 2
    return sp.expand(total.subs(v, BELTS[belt]))


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"A mass $m$ on a spring $k$ and a damper $c$ is driven by $A_0 + B_0\cos\Omega t$ and pressed with the force "
        r"$F_N$ between two belts that move with the speeds $v_1 < v_2$. Belt $\lambda$ acts on it with the Coulomb "
        r"friction $-\mu_\lambda F_N \operatorname{sgn}(\dot{x} - v_\lambda)$ while $\dot{x} \ne v_\lambda$."
    )
    yield Heading("The friction law")
    reason = (
        r"In the domains $\Omega_1$ ($\dot{x} < v_1$), $\Omega_2$ ($v_1 < \dot{x} < v_2$) and $\Omega_3$ "
        r"($\dot{x} > v_2$) of eq.~(6) both signs are constant, so friction only adds to the constant force. Eq.~(1) "
        r"gives"
    )
    for alpha in scope.domains:
        name = named(f"A_{alpha}")
        check = Exact({name: coulomb(alpha)}, sp.expand)
        yield equation(name, solution.force_constant(alpha), reason, check, rf"in $\Omega_{alpha}$.")
        reason = ""
    yield Heading("Accelerations")
    reason = r"Newton's law (5), solved for the acceleration, gives the vector field of eq.~(9):"
    for alpha in scope.domains:
        yield equation(F(alpha), acceleration(alpha), reason, Exact({F(alpha): newton(alpha)}, sp.expand))
        reason = ""
    letters = {A_m: solution.A / m, cm: c / m, w0sq: k / m, f0: B0 / m}
    general = named(r"F^{(\alpha)}")
    yield equation(
        general,
        solution.acceleration(),
        r"In all of them, with $\theta = \Omega t$ and $A_\alpha$ from above,",
        Exact({general: solution.in_paper_letters(solution.acceleration()).subs(Omega * t, solution.theta), **letters}),
    )
    yield Heading("No boundary repels")
    yield Prose(
        r"At a belt's speed the accelerations on both sides differ by the belt's friction, twice. The lower side never "
        r"accelerates less than the upper one, so the flow cannot leave a boundary to both sides at once; "
        r"$\mu_1 \ge \mu_2$, which the paper assumes, is not needed."
    )
    for belt in scope.boundaries:
        lo, hi = SIDES[belt]
        meaning = {F(lo): newton(lo), F(hi): newton(hi)}
        gap = 2 * MU[belt] * FN / m
        yield equation(F(lo) - F(hi), gap, rf"At $\partial\Omega_{{{lo}{hi}}}$:", Exact(meaning, sp.expand))
        yield Step(Relation(F(lo) - F(hi), ">=", sp.Integer(0)), "", Sign(meaning))
    yield Heading("The force that a stick has to hold")
    for belt in scope.boundaries:
        lo, hi = SIDES[belt]
        force = named(f"F_{{s{belt}}}")
        other = 3 - belt
        drag = MU[other] * FN * (1 if other == 2 else -1)
        direct = A0 + B0 * WAVE - k * x - c * BELTS[belt] + drag
        where = {F(lo): newton(lo).subs(v, BELTS[belt]), F(hi): newton(hi).subs(v, BELTS[belt]), force: direct}
        number = "eq.~(2)" if belt == 1 else "which eq.~(2) is for belt 1"
        yield equation(
            force,
            stick_force(belt),
            rf"While the mass moves with belt {belt}, everything but this belt's own friction sums up to ({number})",
            Exact(where, sp.expand),
        )
        reason = rf"and on the two sides of $\dot{{x}} = v_{belt}$ the belt adds its friction forward or backward:"
        yield equation(m * F(lo), force + MU[belt] * FN, reason, Exact(where, sp.expand))
        yield equation(m * F(hi), force - MU[belt] * FN, "", Exact(where, sp.expand))
        yield equation(
            m**2 * F(lo) * F(hi),
            force**2 - MU[belt] ** 2 * FN**2,
            rf"Hence the mass sticks iff $|F_{{s{belt}}}| < \mu_{belt} F_N$, which makes the product negative, and the "
            r"flow passes iff $|F_{s" + str(belt) + r"}| > \mu_" + str(belt) + r" F_N$, which makes it positive:",
            Exact(where, sp.expand),
        )
