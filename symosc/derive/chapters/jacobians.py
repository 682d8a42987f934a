"""Derivatives of the mappings, perturbations in a domain, and the saltation at a crossing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.chapters.domains import _generic, _modes
from symosc.derive.latex import named
from symosc.derive.scope import Scope
from symosc.derive.steps import Exact, Heading, Prose, Relation, Sign, Step, equation
from symosc.symbolic import maps, solution
from symosc.symbolic.solution import E0, E1, E2, FN, Omega, a_i, cm, m, tau, theta_i, v_i, w0sq, x_i

TITLE = "Derivatives of the mappings and saltation"


def total(expr: Any, letter: Any) -> Any:
    """Differentiate a motion by a start value at fixed tau; the acceleration at the start depends on the start too."""
    return expr.diff(letter) + expr.diff(a_i) * solution.acceleration(x_i, v_i, theta_i).diff(letter)


def partial(what: str, by: str) -> Any:
    """Return the letter of a partial derivative."""
    return named(rf"\frac{{\partial {what}}}{{\partial {by}}}")


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _flights()
    yield from _sticks()
    yield from _perturbations()
    yield from _saltation()


def _flights() -> Iterator[Any]:
    flow, found = solution.flow(), maps.flight_jacobian()
    yield Heading("Flights")
    yield Prose(
        r"A flight of duration $\tau = (\theta_{i+1} - \theta_i)/\Omega$ starts with the acceleration "
        r"$\ddot{x}_i = F^{(\alpha)}(x_i, v, \theta_i)$, which depends on the start too. The derivatives by "
        r"$x_{i+1}$ are $-1$ "
        r"and 0."
    )
    ends = {maps.v_end: flow.v, maps.a_end: flow.a}
    for which, (expr, short) in enumerate(((flow.x, "x"), (flow.v, "v")), 1):
        name = f"f_{which}"
        slope = solution.time_derivative(expr) / Omega
        true = {
            partial(name, "x_i"): (total(expr, x_i), f"{short}_x0"),
            partial(name, r"\theta_i"): (total(expr, theta_i) - slope, f"{short}_th0"),
            partial(name, r"\theta_{i+1}"): (slope, f"{short}_th1"),
        }
        reason = {
            1: r"Differentiating the closed form of the flow gives for $f_1$",
            2: r"and for $f_2$",
        }[which]
        for letter, (derivative, key) in true.items():
            check = Exact({letter: derivative} | ends, solution.use_relations, independent=False)
            yield equation(letter, found[key], reason, check)
            reason = ""


def _sticks() -> Iterator[Any]:
    residual, found = maps.stick_residual(), maps.stick_jacobian()
    yield Heading("Sticks")
    theta_j = maps.theta_j
    where = {tau: (theta_j - theta_i) / Omega}
    rows = (
        ("f_1", r"\theta_i", "f1", theta_i, "x_th0"),
        ("f_1", r"\theta_{i+1}", "f1", theta_j, "x_th1"),
        ("f_2", "x_{i+1}", "f2", maps.x_j, "v_x1"),
        ("f_2", r"\theta_{i+1}", "f2", theta_j, "v_th1"),
    )
    reason = r"A stick moves with the belt, $\dot{x}_i = v_\lambda$, and ends where the force vanishes:"
    for name, by, key, letter, entry in rows:
        symbol = partial(name, by)
        true = residual[key].subs(where).diff(letter)
        yield equation(symbol, found[entry], reason, Exact({symbol: true}, sp.expand))
        reason = ""


def _perturbations() -> Iterator[Any]:
    flow = solution.flow()
    yield Heading("Perturbations in a domain")
    reason = r"A small change of the state at $t_i$ obeys the unforced equation, so its matrix does not depend on "
    reason += "the motion:"
    entries = (
        ("x", "x_i", flow.x, x_i, 1 - w0sq * E2),
        ("x", r"\dot{x}_i", flow.x, v_i, E1),
        (r"\dot{x}", "x_i", flow.v, x_i, -w0sq * E1),
        (r"\dot{x}", r"\dot{x}_i", flow.v, v_i, E0),
    )
    for what, by, expr, letter, entry in entries:
        name = partial(what, by)
        check = Exact({name: total(expr, letter)}, solution.use_relations, independent=False)
        yield equation(name, entry, reason, check)
        reason = ""
    generic = _generic()
    determinant = named(r"\det")
    matrix = {determinant: (1 - w0sq * E2) * E0 + w0sq * E1**2}
    yield equation(
        determinant,
        sp.exp(-cm * tau),
        r"Areas shrink at the rate $c/m$, whatever the motion:",
        Exact(matrix | generic, lambda expr: sp.simplify(_modes(expr))),
    )


def _saltation() -> Iterator[Any]:
    yield Heading("Saltation at a crossing")
    before, after = named("F^{-}"), named("F^{+}")
    speed, delta = named(r"v_\lambda"), named(r"\delta \dot{x}^{-}")
    shift, result = named(r"\delta t"), named(r"\delta \dot{x}^{+}")
    yield Prose(
        r"At a crossing the acceleration changes from $F^{-}$ to $F^{+}$. A motion that is off by $(\delta x, \delta "
        r"\dot{x}^{-})$ crosses at another time."
    )
    delay = {shift: sp.solve(delta + before * named("s"), named("s"))[0]}
    yield equation(shift, -delta / before, "To first order that is later by", Exact(delay))
    # One motion switches at 0, the other at the delay: compare both at the delay.
    true = {result: delta + before * shift - after * shift} | delay
    yield equation(
        result,
        after * delta / before,
        r"during which one motion has $F^{+}$ and the other still $F^{-}$. The position does not notice, the "
        r"velocity does:",
        Exact(true),
    )
    field_gap = sp.Matrix([0, after - before])
    normal = sp.Matrix([[0, 1]])
    flow_before = sp.Matrix([speed, before])
    matrix = sp.eye(2) + field_gap * normal / (normal * flow_before)[0]
    reason = (
        r"The general formula $S = I + (f^{+} - f^{-})\, n^{T}/(n^{T} f^{-})$ with $f^{\pm} = (v_\lambda, "
        r"F^{\pm})^{T}$ and "
        r"$n = (0, 1)^{T}$ says the same:"
    )
    for i, j, entry in ((0, 0, 1), (0, 1, 0), (1, 0, 0), (1, 1, after / before)):
        name = named(f"S_{{{i + 1}{j + 1}}}")
        yield equation(name, sp.sympify(entry), reason, Exact({name: matrix[i, j]}))
        reason = ""
    lower, mu = sp.Symbol("F^{+}", positive=True), sp.Symbol(r"\mu_\lambda", nonnegative=True)
    ratio = named("F^{+}/F^{-}")
    crossing = lower / (lower + 2 * mu * FN / m)
    bound = (
        r"A crossing upward has $F^{-} = F^{+} + 2 \mu_\lambda F_N/m$ with $F^{+} > 0$, and downward both signs "
        r"are turned. "
        r"So friction only ever takes away from a perturbation:"
    )
    yield Step(Relation(ratio, ">", sp.Integer(0)), bound, Sign({ratio: crossing}))
    yield Step(Relation(ratio, "<=", sp.Integer(1)), "", Sign({ratio: crossing}))
    yield Prose(
        r"At the onset of a stick the belt takes all of it, $\delta\dot{x}^{+} = 0$; at its end the force on the side "
        r"that the mass slips to starts from 0, and nothing is added."
    )
