"""Fragments for a paper of one's own: one map, one theorem or one formula each, with all that it needs.

Each step is checked before it is printed, as in the chapters; numbers are put in after that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.blocks import Table
from symosc.derive.chapters import grazing, jacobians, motion, sticks, switching
from symosc.derive.fragment_parts import BASIS_TEXT, constant, map_items, motion_items
from symosc.derive.fragment_scope import FragmentScope
from symosc.derive.latex import named
from symosc.derive.scope import BELTS, F, G, v_lambda
from symosc.derive.steps import Each, Exact, Prose, Relation, Sign, Step, equation
from symosc.mappings.theorem7_cases import PLACES
from symosc.model import NEIGHBOURS
from symosc.symbolic import solution, theorem7
from symosc.symbolic.solution import (
    B0,
    A,
    Omega,
    c,
    k,
    m,
    t,
    tau,
    theta,
    theta_i,
    v,
    x,
)
from symosc.words import MAPS


class Fragment(NamedTuple):
    """A fragment: its title, what makes it, and the paper's numbers of its equations by their labels."""

    title: str
    items: Callable[[FragmentScope], Iterator[Any]]
    tags: dict[str, str]


# --- the fragments ---


def _friction(scope: FragmentScope) -> Iterator[Any]:
    del scope
    yield Prose(
        r"A mass $m$ on a spring $k$ and a damper $c$ is driven by $A_0 + B_0\cos\Omega t$ and pressed with the force "
        r"$F_N$ between two belts with the speeds $v_1 < v_2$ and the friction coefficients $\mu_1$ and $\mu_2$. With "
        r"$\operatorname{Sgn}(s) = \operatorname{sgn}(s)$ for $s \ne 0$ and $\operatorname{Sgn}(0) = [-1, 1]$,"
        r" $m\ddot{x} + c\dot{x} + k x - A_0 - B_0\cos\Omega t \in -\mu_1 F_N\operatorname{Sgn}(\dot{x} - v_1) - "
        r"\mu_2 F_N\operatorname{Sgn}(\dot{x} - v_2)$. In the domains $\Omega_1$ ($\dot{x} < v_1$), $\Omega_2$ "
        r"($v_1 < \dot{x} < v_2$) and $\Omega_3$ ($\dot{x} > v_2$)"
    )
    general, check = F(r"\alpha"), []
    for alpha in (1, 2, 3):
        check.append(Exact({general: motion.newton(alpha), A: solution.force_constant(alpha)}, sp.expand))
    right = (A + B0 * sp.cos(Omega * t) - k * x - c * v) / m
    yield equation(general, right, r"the acceleration is", Each(tuple(check)), label="F")
    for alpha in (1, 2, 3):
        yield constant(alpha)


def _flow(scope: FragmentScope) -> Iterator[Any]:
    yield Prose(
        r"Where $m\ddot{x} + c\dot{x} + k x = A_\alpha + B_0\cos\Omega t$, take the motion from $(x_i, \dot{x}_i)$ at "
        r"the time $t_i$ with the phase $\theta_i = \Omega t_i$, at $\tau = t - t_i$ later."
    )
    yield from motion_items(scope)


def _stick(scope: FragmentScope) -> Iterator[Any]:
    del scope
    rate = named(r"m\dot{F}^{(\alpha)}")
    moving = sticks.force_on_belt(theta_i + Omega * tau)
    true = solution.in_paper_letters(moving.diff(tau)).subs(theta_i + Omega * tau, theta)
    true = (m * true).subs(Omega * (solution.t_i + tau), theta).subs(Omega * solution.t_i + Omega * tau, theta)
    yield Prose(
        r"While the mass moves with belt $\lambda$, $\dot{x} = v_\lambda$ and $\ddot{x} = 0$. The stick "
        r"lasts as long as "
        r"$F^{(\lambda)} \ge 0 \ge F^{(\lambda+1)}$, where $m F^{(\alpha)}$ is what all forces would sum up to if "
        r"friction were that of the domain below ($\alpha = \lambda$) or above ($\alpha = \lambda + 1$) "
        r"the belt's speed. "
        r"It ends where the first of the two changes its sign, and the mass slips into that domain. On belt 1"
    )
    for belt in (1, 2):
        for alpha in NEIGHBOURS[belt]:
            at = {v: BELTS[belt], Omega * t: theta}
            right = sp.expand(m * motion.acceleration(alpha).subs(at))
            reason = "and on belt 2" if (belt, alpha) == (2, 2) else ""
            check = Exact({F(alpha): motion.newton(alpha).subs(at)}, sp.expand)
            label = f"belt{belt}-F{alpha}"
            yield equation(m * F(alpha), right, reason, check, label=label)
    yield equation(
        rate,
        -(k * v_lambda + B0 * Omega * sp.sin(theta)),
        r"with the phase $\theta = \Omega t$. All of them change at the rate",
        Exact({rate: true}, sp.expand),
        label="rate",
    )


def _g_functions(scope: FragmentScope) -> Iterator[Any]:
    del scope
    yield Prose(
        r"The G-functions of the domain $\Omega_\alpha$ at a boundary $\dot{x} = v_\lambda$ are the derivatives of the "
        r"acceleration $F^{(\alpha)}$ along its flow; $\theta = \Omega t$ is the phase:"
    )
    steps = [item for item in switching.g_functions() if isinstance(item, Step)]
    yield from (Step(step.statement, "", step.check, label=f"G{n}") for n, step in enumerate(steps, 1))


def _saltation(scope: FragmentScope) -> Iterator[Any]:
    del scope
    yield Prose(
        r"Where a motion crosses $\dot{x} = v_\lambda$ with the accelerations $F^{-} \ne 0$ before and $F^{+} \ne 0$ "
        r"after, a small change $(\delta x, \delta\dot{x})$ of its state is multiplied by the saltation matrix "
        r"$S = \operatorname{diag}(1, F^{+}/F^{-})$, where"
    )
    steps = [item for item in jacobians.saltation() if isinstance(item, Step) and isinstance(item.check, Sign)]
    yield from (Step(step.statement, "", step.check, label=f"ratio{n}") for n, step in enumerate(steps, 1))
    yield Prose(
        r"At the onset of a stick the matrix is $\operatorname{diag}(1, 0)$, at its end the identity. "
        r"Between events it is multiplied by $\Phi(\tau)$ with the entries"
    )
    steps = [item for item in jacobians.perturbations() if isinstance(item, Step)]
    yield from (Step(step.statement, "", step.check, label=f"phi{n}") for n, step in enumerate(steps[:4], 1))
    yield Prose(BASIS_TEXT + ".")


def _theorem4(scope: FragmentScope) -> Iterator[Any]:
    yield from _cases(r"the motion sticks to belt $\lambda$ if $F^{(\lambda)} > 0$ and $F^{(\lambda+1)} < 0$", scope)


def _theorem5(scope: FragmentScope) -> Iterator[Any]:
    yield from _cases(
        r"the motion passes if $F^{(\lambda)} F^{(\lambda+1)} > 0$: upward, into $\Omega_{\lambda+1}$, if both are "
        r"positive, downward, into $\Omega_\lambda$, if both are negative",
        scope,
    )


def _theorem6(scope: FragmentScope) -> Iterator[Any]:
    yield from _cases(
        r"a flow that comes in $\Omega_\lambda$ grazes if $F^{(\lambda)} = 0$ and $G^{(1,\lambda)} < 0$, "
        r"one that comes in "
        r"$\Omega_{\lambda+1}$ if $F^{(\lambda+1)} = 0$ and $G^{(1,\lambda+1)} > 0$; where $G^{(1,\alpha)} "
        r"= 0$ too, the "
        r"first derivative of $F^{(\alpha)}$ along the flow that does not vanish decides, and grazes iff "
        r"its order is odd",
        scope,
    )
    first = solution.in_paper_letters(solution.g_function(1)).subs({Omega * t: theta, v: v_lambda})
    general = solution.in_paper_letters(solution.acceleration()).subs({Omega * t: theta, v: v_lambda})
    right = -c * F(r"\alpha") / m - k * v_lambda / m - B0 * Omega * sp.sin(theta) / m
    reason = r"With the phase $\theta = \Omega t$"
    yield equation(G(1), right, reason, Exact({G(1): first, F(r"\alpha"): general}, sp.expand), label="G1")


def _cases(words: str, scope: FragmentScope) -> Iterator[Any]:
    yield Prose(
        r"At the boundary $\dot{x} = v_\lambda$ between $\Omega_\lambda$ below and $\Omega_{\lambda+1}$ above it, "
        + words
        + "."
    )
    for item in _friction(scope):
        if isinstance(item, Step):
            at = "Here the acceleration in $\\Omega_\\alpha$ is" if item.label == "F" else item.reason
            yield Step(item.statement, at, item.check, label=item.label)


def _theorem7(scope: FragmentScope) -> Iterator[Any]:
    letter = sp.Symbol("a", real=True)
    yield Prose(
        r"Let the flow of $\Omega_\alpha$ have $\dot{x} = v_\lambda$ and $\ddot{x} = 0$ at the time $t_m$, with the "
        r"phase $\theta_m = \Omega t_m$ modulo $2\pi$: $P_2$ has $(\alpha, \lambda) = (1, 1)$, $P_3$ $(2, 1)$, $P_5$ "
        r"$(2, 2)$ and $P_6$ $(3, 2)$, with $\sigma = 1$ where the boundary is above the domain, and $\sigma = -1$ "
        r"where it is below. With"
    )
    acceleration, rate = named(r"\ddot{x}"), named(r"\dot{x}")
    fixed = ((c * acceleration + k * rate) / m).subs({acceleration: 0, rate: v_lambda})
    yield equation(grazing.GAMMA, k * v_lambda / m, "", Exact({grazing.GAMMA: fixed}), label="gamma")
    yield equation(letter, B0 * Omega / m, "", Exact({letter: B0 * Omega / m}), label="a")
    yield Prose(
        r"and $\Theta^{\mathrm{cr}} = \arcsin(-\gamma/a)$, the flow grazes the boundary to first order iff "
        r"$\theta_m$ is in the set below, for $a \ge 0$; for $a < 0$ the sets are those of $-a$, moved by $\pi$."
    )
    table = grazing.windows_table("theorem7")
    yield Table(table.label, "The phases at which a contact grazes.", table.heads, table.rows)
    yield Prose(
        r"A single point that is taken out, for $|\gamma| = a$, is a tangency of fourth order, at which the flow "
        r"returns as well: to full order these two sets are the whole circle, and the others stay as they are."
    )
    if not scope.zero("k"):
        solved = sp.solve(solution.in_paper_letters(solution.acceleration()).subs({v: v_lambda, Omega * t: theta}), x)[
            0
        ]
        right = (A + B0 * sp.cos(grazing.THETA_M) - c * v_lambda) / k
        check = Exact({named("x_m"): solved.subs(theta, grazing.THETA_M)})
        reason = (
            r"Where $m\ddot{x} + c\dot{x} + k x = A_\alpha + B_0\cos\Omega t$ in $\Omega_\alpha$, the contact is at"
        )
        yield equation(named("x_m"), right, reason, check, label="xm")
    yield from _windows_in_numbers(scope)


def _windows_in_numbers(scope: FragmentScope) -> Iterator[Any]:
    reason = r"With the numbers of this paper"
    for mapping, place in PLACES.items():
        if not scope.has("m", "k", "B0", "Omega", f"v{place.boundary}"):
            continue
        gamma = (k * BELTS[place.boundary] / m).xreplace(scope.letters)
        amplitude = (B0 * Omega / m).xreplace(scope.letters)
        phases = theorem7.window_phases(place, gamma, amplitude, False)
        check = grazing.Window(place.side, gamma, amplitude)
        note = rf"for $P_{mapping[1]}$"
        yield Step(Relation(grazing.THETA_M, "in", phases), reason, check, note, label=f"window-{mapping}")
        reason = ""


FRAGMENTS: dict[str, Fragment] = {
    "friction": Fragment("The equation of motion", _friction, {"F": "9"}),
    "flow": Fragment("The motion in a domain", _flow, {}),
    "stick": Fragment("Sticks and their two ends", _stick, {"belt1-F2": "52", "belt2-F3": "53"}),
    "gfunctions": Fragment("The G-functions", _g_functions, {"G1": "47"}),
    "theorem4": Fragment("Theorem 4", _theorem4, {"F": "9"}),
    "theorem5": Fragment("Theorem 5", _theorem5, {"F": "9"}),
    "theorem6": Fragment("Theorem 6", _theorem6, {"F": "9", "G1": "47"}),
    "theorem7": Fragment("Theorem 7", _theorem7, {"column1": "(55), (57)", "column2": "(56), (58)"}),
    "saltation": Fragment("Saltation and perturbations", _saltation, {}),
    **{
        label: Fragment(
            f"The mapping $P_{label[1]}$",
            map_items(label),
            {"f1": "52" if label == "P1" else "53"} if MAPS[label].sticks else {"f1": r"54\,a", "f2": r"54\,b"},
        )
        for label in MAPS
    },
}
