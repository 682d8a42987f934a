"""Derivatives of the mappings, perturbations in a domain, saltation, and the monodromy matrix."""

from __future__ import annotations

from functools import cache
from math import prod
from typing import Any

import sympy as sp

from symosc.derive.scope import Scope
from symosc.derive.steps import (
    CONTEXT,
    STEP_DIGITS,
    Items,
    at_root,
    equation,
    exact,
    facts,
    generic_basis,
    modes,
    number,
    sign,
    step,
)
from symosc.orbits.find import find_orbit
from symosc.scenes import load_scene
from symosc.symbolic import maps, solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import E0, E1, E2, FN, Omega, a_i, cm, m, tau, theta_i, v_i, w0sq, x_i

TITLE = "Derivatives, saltation and monodromy"
BEFORE = named("F^{-}")
AFTER = named("F^{+}")


def total(expr: Any, letter: Any) -> Any:
    """Differentiate `expr` by a start value `letter` at fixed tau.

    The initial acceleration a_i varies with it.
    """
    return expr.diff(letter) + expr.diff(a_i) * solution.acceleration(x_i, v_i, theta_i).diff(
        letter
    )


def partial(what: str, by: str) -> Any:
    """Return the symbol that prints as the partial derivative of `what` with respect to `by`
    (LaTeX).
    """
    return named(rf"\frac{{\partial {what}}}{{\partial {by}}}")


def items(scope: Scope) -> Items:
    """Yield the chapter: derivatives of f1 and f2, perturbations, saltation, and the monodromy
    matrix.
    """
    flow = solution.flow()
    flight_slopes = maps.flight_jacobian()
    ends = {maps.v_end: flow.v, maps.a_end: flow.a}
    rows = []
    for n, (expr, short) in enumerate(((flow.x, "x"), (flow.v, "v")), 1):
        slope = solution.time_derivative(expr) / Omega
        derivatives = {
            "x0": ("x_i", total(expr, x_i)),
            # At fixed theta_j a later start makes the flight shorter.
            "th0": (r"\theta_i", total(expr, theta_i) - slope),
            "th1": (r"\theta_{i+1}", slope),
        }
        for key, (by, derivative) in derivatives.items():
            letter = partial(f"f_{n}", by)
            check = exact({letter: derivative} | ends, solution.use_relations)
            rows.append(equation(letter, flight_slopes[f"{short}_{key}"], check, f"f{n}-{key}"))
    yield (
        r"\subsection{Derivatives of the governing equations}",
        r"\begin{proposition}[flights]\label{thm:jacobians-flight} For a flight "
        r"(Theorem~\ref{thm:maps-flight}) with $\dot{x}_i = v_\lambda$, and with the velocity "
        r"$\dot{x}(\tau)$ and the acceleration $\ddot{x}(\tau)$ at its end,",
        *rows,
        r"while $\partial f_1/\partial x_{i+1} = -1$ and $\partial f_2/\partial x_{i+1} = "
        r"0$.\end{proposition}",
        r"\begin{proof} $\ddot{x}_i$ depends on $x_i$ and $\theta_i$ by \eqref{eq:maps-start}, and "
        r"$\tau$ on both phases by \eqref{eq:maps-tau}. The derivatives by $\theta_i$ are short "
        r"because moving a start along its own flow changes nothing at the end: "
        r"$\dot{x}_i\,\partial/\partial x_i + \ddot{x}_i\,\partial/\partial\dot{x}_i + "
        r"\Omega\,\partial/\partial\theta_i$ gives 0.\end{proof}",
    )
    residual = maps.stick_residual()
    stick_slopes = maps.stick_jacobian()
    theta_j = maps.theta_j
    duration = {tau: (theta_j - theta_i) / Omega}
    # The equation, the variable in print and as a symbol, and the name of the kernel's result.
    entries = (
        ("1", r"\theta_i", theta_i, "x_th0"), ("1", r"\theta_{i+1}", theta_j, "x_th1"),
        ("2", "x_{i+1}", maps.x_j, "v_x1"), ("2", r"\theta_{i+1}", theta_j, "v_th1")
    )  # fmt: skip
    slopes = [
        equation(
            partial(f"f_{n}", by),
            stick_slopes[key],
            residual[f"f{n}"].subs(duration).diff(letter),
            f"stick-{key}",
        )
        for n, by, letter, key in entries
    ]
    yield (
        r"\begin{proposition}[sticks]\label{thm:jacobians-stick} For a stick "
        r"(Theorem~\ref{thm:maps-stick}) with $\dot{x}_i = v_\lambda$",
        *slopes,
        r"while $\partial f_1/\partial x_i = 1$, $\partial f_1/\partial x_{i+1} = -1$, and $f_2$ "
        r"does not depend on $(x_i, \theta_i)$.\end{proposition}",
    )
    yield perturbations(), saltation()
    product = named(r"\rho_1\rho_2")
    bound = named(r"e^{-c\mathcal{T}/m}\prod_j F^{+}_j/F^{-}_j")

    def values() -> dict[Any, Any]:
        texts = (
            CONTEXT.nstr(value, STEP_DIGITS + 5)
            for value in multiplier_products("fig9-orbit", "P32")
        )
        return {
            name: sp.Float(text, STEP_DIGITS + 10)
            for name, text in zip((product, bound), texts, strict=True)
        }

    energy = named(r"\frac{d}{d\tau}\bigl(\tfrac{m}{2}\dot{y}^2 + \tfrac{k}{2}y^2\bigr)")
    rate = named(r"\dot{y}")
    bend = named(r"\ddot{y}")
    place = named("y")
    meaning = {
        energy: m * rate * bend + solution.k * place * rate,
        bend: -(solution.c * rate + solution.k * place) / m,
    }
    yield (
        r"\subsection{The monodromy matrix}",
        r"\begin{definition}[regular motion]\label{thm:jacobians-regular} A motion is "
        r"\emph{regular} if each of its flights arrives at a belt with $F \ne 0$ and touches none "
        r"on its way; each contact is a passage with $F^{(\lambda)} F^{(\lambda+1)} > 0$, or the "
        r"onset of a stick with $F^{(\lambda)} > 0 > F^{(\lambda+1)}$; and each stick is held with "
        r"these strict signs up to its end, where one of the two accelerations vanishes with "
        r"$\dot{F} \ne 0$.\end{definition}",
        r"So a regular motion grazes nowhere, but this is not enough: a passage with $F^{+} = 0$, "
        r"or a stick that is about to be interrupted, is no graze, and next to it events are born "
        r"that the matrices below do not have (\eqref{eq:exponents-stick} to "
        r"\eqref{eq:exponents-interrupted}).",
        r"\begin{theorem}[monodromy and multipliers]\label{thm:jacobians-monodromy} Let a periodic "
        r"motion that is regular and has the period $\mathcal{T}$ consist of flights and sticks "
        r"with the durations $\tau_1, \ldots, \tau_n$. A small change of its state at the start is "
        r"after $\mathcal{T}$ multiplied by the \emph{monodromy matrix} $M = S_n\Psi_n \cdots "
        r"S_2\Psi_2 S_1\Psi_1$, where $\Psi_j = \Phi(\tau_j)$ for a flight, $\Psi_j = I$ for a "
        r"stick, and $S_j$ is the saltation matrix at the end of the piece $j$. Its eigenvalues "
        r"$\rho_1$ and $\rho_2$ are the \emph{multipliers}.",
        r"\begin{enumerate}\item[(i)] $|\rho_1|, |\rho_2| \le 1$. For $c > 0$ and $k > 0$ both are "
        r"below 1 in size if there is at least one flight.\item[(ii)] A motion with a stick has a "
        r"multiplier 0, and the other one is the trace of $M$.\item[(iii)] A motion without sticks "
        r"has $\rho_1\rho_2 = e^{-c\mathcal{T}/m}\prod_j F^{+}_j/F^{-}_j > "
        r"0$.\end{enumerate}\end{theorem}",
        r"\begin{proof} The product is finite (Theorem~\ref{thm:accumulation-finite}), by the "
        r"chain rule. In a flight a small change $(y, \dot{y})$ obeys the unforced equation, and",
        equation(energy, -solution.c * rate**2, meaning, "energy"),
        r"so $\Phi$ does not increase the energy norm $\tfrac{m}{2}\dot{y}^2 + \tfrac{k}{2}y^2$, "
        r"and neither does $S$ by \eqref{eq:jacobians-bound}: no eigenvalue exceeds 1 (for $k = 0$ "
        r"take the limit $k \to 0$ of the matrix). If $c > 0$ and $k > 0$, the energy can stay the "
        r"same during a flight only if $\dot{y} = 0$ all the time, and then $k y = 0$; so no "
        r"eigenvalue has the size 1. (ii) One factor $\operatorname{diag}(1, 0)$ makes $\det M = "
        r"0$. (iii) The determinant of a product is the product of the determinants, "
        r"\eqref{eq:jacobians-det} and Theorem~\ref{thm:jacobians-saltation}.\end{proof}",
        r"For the orbit $P_{32}$ of the paper's Fig.~9, whose multipliers are computed from "
        r"Proposition~\ref{thm:jacobians-flight}, both sides of (iii) agree to 40 digits:",
        equation(product, bound, at_root(values, CONTEXT.mpf(10) ** -40), "product"),
    )


def perturbations() -> Items:
    """Return the items of the lemma on perturbations in a domain."""
    flow = solution.flow()
    entries = {
        "11": (flow.x, x_i, 1 - w0sq * E2),
        "12": (flow.x, v_i, E1),
        "21": (flow.v, x_i, -w0sq * E1),
        "22": (flow.v, v_i, E0),
    }
    rows = []
    for n, (place, (expr, letter, entry)) in enumerate(entries.items(), 1):
        name = named(rf"\Phi_{{{place}}}")
        check = exact({name: total(expr, letter)}, solution.use_relations)
        rows.append(equation(name, entry, check, f"phi-{n}"))
    determinant = named(r"\det\Phi(\tau)")
    matrix = {determinant: (1 - w0sq * E2) * E0 + w0sq * E1**2}
    area = exact(matrix | generic_basis(), lambda expr: sp.simplify(modes(expr)))
    return (
        r"\subsection{Perturbations of a motion}",
        r"\begin{lemma}[perturbations in a domain]\label{thm:jacobians-phi} In a domain a small "
        r"change of $(x_i, \dot{x}_i)$ at a fixed time is multiplied by the matrix $\Phi(\tau)$ "
        r"with the entries",
        *rows,
        r"whatever the motion is, and areas shrink with the factor",
        equation(determinant, sp.exp(-cm * tau), area, "det"),
        r"\end{lemma}",
        r"\begin{proof} The difference of two motions of a domain obeys the unforced equation. The "
        r"determinant solves $\dot{w} = -(c/m)\,w$, $w(0) = 1$ (Liouville).\end{proof}",
    )


def saltation() -> Items:
    """Return the items of the theorem on saltation."""
    speed = named(r"v_\lambda")
    delta = named(r"\delta\dot{x}^{-}")
    shift = named(r"\delta t")
    result = named(r"\delta\dot{x}^{+}")
    delay = {shift: sp.solve(delta + BEFORE * named("s"), named("s"))[0]}
    field_gap = sp.Matrix([0, AFTER - BEFORE])
    normal = sp.Matrix([[0, 1]])
    (rate_of_gap,) = normal * sp.Matrix([speed, BEFORE])
    matrix = sp.eye(2) + field_gap * normal / rate_of_gap
    entries = tuple(
        equation(matrix[i, j], entry)
        for i, j, entry in ((0, 0, 1), (0, 1, 0), (1, 0, 0), (1, 1, AFTER / BEFORE))
    )
    lower = sp.Symbol("F^{+}", positive=True)
    mu = sp.Symbol(r"\mu_\lambda", nonnegative=True)
    ratio = AFTER / BEFORE
    upward = {BEFORE: AFTER + 2 * mu * FN / m, AFTER: lower}
    return (
        r"\begin{theorem}[saltation]\label{thm:jacobians-saltation} Where a motion crosses "
        r"$\dot{x} = v_\lambda$ with the accelerations $F^{-}$ before and $F^{+}$ after, both not "
        r"0, a small change $(\delta x, \delta\dot{x}^{-})$ is multiplied by the matrix $S = "
        r"\operatorname{diag}(1, F^{+}/F^{-})$, and",
        facts(*entries),
        step(ratio, ">", 0, sign(upward), "ratio"),
        step(ratio, "<=", 1, sign(upward), "bound"),
        r"At the onset of a stick the matrix is $\operatorname{diag}(1, 0)$, at its end it is the "
        r"identity.\end{theorem}",
        r"\begin{proof} To first order the changed motion crosses later by",
        equation(shift, -delta / BEFORE, delay, "delay"),
        r"and during this time one motion has $F^{+}$ and the other still $F^{-}$, so that "
        r"afterwards",
        equation(
            result,
            AFTER * delta / BEFORE,
            {result: delta + BEFORE * shift - AFTER * shift} | delay,
            "after",
        ),
        r"while $\delta x$ changes by terms of second order only. This is the general formula $S = "
        r"I + (\mathbf{f}^{+} - \mathbf{f}^{-})\,\mathbf{n}^T/(\mathbf{n}^T\mathbf{f}^{-})$ with "
        r"$\mathbf{f}^{\pm} = (v_\lambda, F^{\pm})^T$ \cite{leine2004,dibernardo2008}. A crossing "
        r"upward has $F^{-} = F^{+} + 2\mu_\lambda F_N/m$ with $F^{+} > 0$ by "
        r"Lemma~\ref{thm:motion-jump}, and downward both signs are turned, which gives the bounds. "
        r"At the onset of a stick the belt takes the change of the velocity, $F^{+} = 0$; at its "
        r"end the acceleration that the mass slips with starts at 0, on the belt it is 0, and the "
        r"general formula has $\mathbf{f}^{+} = \mathbf{f}^{-}$.\end{proof}",
    )


@cache
def multiplier_products(scene: str, word: str) -> tuple[Any, Any]:
    """Return the product of an orbit's multipliers: the package's, and the one by the theorem.

    50 digits.
    """
    p = load_scene(scene).parameters
    orbit = find_orbit(p, word, digits=STEP_DIGITS + 5)
    product = prod(map(CONTEXT.mpmathify, orbit.multipliers))
    ratios = CONTEXT.mpf(1)
    # P32 passes belt 1 downwards and then upwards: the domains before and after each passage.
    passages = ((2, 1), (1, 2))
    for (t, x), (before, after) in zip(orbit.points, passages, strict=True):
        force_after, force_before = (
            force_at_belt(p, alpha, 1, x, number(p.Omega) * t) for alpha in (after, before)
        )
        ratios *= force_after / force_before
    return CONTEXT.re(product), CONTEXT.exp(-number(p.c / p.m) * CONTEXT.mpf(orbit.period)) * ratios


def force_at_belt(p: Any, alpha: int, belt: int, x: Any, phase: Any) -> Any:
    """Return the force m F^(alpha) at the speed of `belt`, a position and a phase, from the
    parameters `p` alone.
    """
    friction = {1: p.mu1 + p.mu2, 2: p.mu2 - p.mu1, 3: -p.mu1 - p.mu2}[alpha] * p.FN
    return (
        number(p.A0 + friction - p.c * p.belt(belt))
        + number(p.B0) * CONTEXT.cos(phase)
        - number(p.k) * x
    )
