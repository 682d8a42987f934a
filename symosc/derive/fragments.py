"""Fragments for users' papers: one map, theorem or formula each, with all that it needs, as LaTeX
that needs amsmath.

Each step is checked before it is printed, as in the chapters, whose sections they share; numbers
are put in after that.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import sympy as sp

import symosc
from symosc.base.errors import ParameterError
from symosc.base.exact import show
from symosc.derive.chapters import domains, grazing, jacobians, motion, sticks, switching
from symosc.derive.document import Checked, Part, align, cell, check
from symosc.derive.scope import BELTS, F, FragmentScope
from symosc.derive.steps import (
    Items,
    Prose,
    Step,
    StepError,
    Table,
    cases,
    equation,
    exact,
    flat,
    generic_basis,
    step,
)
from symosc.friction import MAPS, NEIGHBOURS
from symosc.kernels.theorem7_cases import PLACES
from symosc.symbolic import maps, solution, theorem7
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import (
    B0,
    BASIS,
    E0,
    E1,
    E2,
    A,
    Omega,
    c,
    k,
    m,
    t,
    tau,
    theta_i,
    v,
    v_i,
    x,
    x_i,
)

ALONE = "\\documentclass{article}\n\\usepackage{amsmath}\n\\begin{document}\n"
PREFIX = "symosc"
POSITION = named(r"x(\tau)")
VELOCITY = named(r"\dot{x}(\tau)")
BASIS_TEXT = (
    r"Here $E_1(\tau)$ is the response of $\ddot{y} + (c/m)\dot{y} + (k/m)y$ to an impulse: the "
    r"solution of the unforced equation with $E_1(0) = 0$ and $\dot{E}_1(0) = 1$; further $E_0 = "
    r"\dot{E}_1$, $E_2(\tau) = \int_0^\tau E_1(u)\,du$ and $R_2(\tau) + i I_2(\tau) = \int_0^\tau "
    r"E_1(u)\, e^{i\Omega(\tau - u)}\,du$"
)


class Fragment(NamedTuple):
    """A piece of theory for users' papers: title, function that returns its items, and the paper's
    equation numbers.
    """

    title: str
    items: Callable[[FragmentScope], Items]
    tags: dict[str, str] = {}  # noqa: RUF012 (nobody changes it)


def check_fragment(name: str, scope: FragmentScope) -> Checked:
    """Build the fragment `name` and check its steps.

    StepError if one fails or divides by 0 in the scope's numbers.
    """
    numbers = scope.given()
    sentence = []
    if len(numbers) == 1:
        sentence = [f"The number is {numbers[0]}."]
    elif numbers:
        sentence = [f"The numbers are {', '.join(numbers)}."]
    fragment = check(name, FRAGMENTS[name].title, flat([sentence, FRAGMENTS[name].items(scope)]))
    for statement, _ in fragment.steps():
        right = scope.shown(statement.right)
        if isinstance(right, sp.Expr) and right.has(sp.zoo, sp.nan, sp.oo):
            raise StepError(str(statement), "divides by 0 with these numbers")
    return fragment


def as_latex(
    fragment: Checked,
    scope: FragmentScope,
    prefix: str = PREFIX,
    paper_tags: bool = False,
    alone: bool = False,
) -> str:
    """Return a fragment as LaTeX, in which labels begin with `prefix` and a colon, as in
    symosc:P3-f1.

    `scope` has the numbers and the form of the fragment. If `paper_tags`, equations get their
    numbers in the paper; if `alone`, a complete document is made.
    """
    if not re.fullmatch(r"[A-Za-z0-9.:_-]*", prefix):
        raise ParameterError("prefix", prefix, "may have letters, digits and . : _ - only")
    if paper_tags:
        tags = FRAGMENTS[fragment.key].tags
    else:
        tags = {}
    if prefix:
        label_start = f"{prefix}:"
    else:
        label_start = ""
    command = [
        f"symosc derive {fragment.key}",
        *(f"--set {name}={show(value)}" for name, value in scope.values),
    ]
    if scope.form != "entire":
        command += [f"--form {scope.form}"]
    if scope.digits is not None:
        command += [f"--digits {scope.digits}"]
    out = [
        f"% {fragment.title.replace('$', '')}: {' '.join(command)} (symosc {symosc.__version__}).\n"
        "% Needs \\usepackage{amsmath}. Every formula was checked by machine before it was "
        "printed.\n"
    ]

    def end(part: Part) -> str:
        if part.item.label in tags:
            tag = rf"\tag{{{tags[part.item.label]}}} "
        else:
            tag = ""
        return rf"{tag}\label{{{label_start}{part.label.removeprefix('eq:')}}}"

    for part in fragment.displays():
        if isinstance(part, list):
            out.append(align(part, scope, end))
        else:
            out.append(
                part.item.text if isinstance(part.item, Prose) else _table(part.item, scope, tags)
            )
    body = "\n".join(out).replace(r"\varnothing", r"\emptyset") + "\n"
    if alone:
        return f"{ALONE}{body}\\end{{document}}\n"
    return body


def _table(table: Table, scope: FragmentScope, tags: dict[str, str]) -> str:
    """Return a table as LaTeX; `tags` has the paper's equation numbers, which column heads show."""
    lines = [" & ".join(cell(value, scope) for value in row) for row in table.rows]
    heads = [
        head + (f", {tags[f'column{i}']}" if f"column{i}" in tags else "")
        for i, head in enumerate(table.heads)
    ]
    begin = "\\begin{center}\n" + rf"\begin{{tabular}}{{{'l' * len(heads)}}}"
    body = [line + (r" \\[8pt]" if r"\frac" in line else r" \\") for line in lines]
    return "\n".join(
        [begin, " & ".join(heads) + r" \\ \hline", *body, "\\end{tabular}\n\\end{center}"]
    )


# --- the fragments ---


def _relabelled(items: Items, label: str) -> list[Step]:
    """Return the steps among some items of a chapter, relabelled as `label` followed by 1, 2, ..."""
    steps = [item for item in flat(items) if isinstance(item, Step)]
    return [replace(step, label=f"{label}{n}") for n, step in enumerate(steps, 1)]


def _constant(alpha: int) -> Step:
    """Return the fragment for the constant force A_alpha."""
    return equation(
        named(f"A_{alpha}"), solution.force_constant(alpha), motion.coulomb(alpha), f"A{alpha}"
    )


def _acceleration() -> list[Step]:
    """Return the fragment of the acceleration."""
    general = F(r"\alpha")
    checks = (exact({general: motion.newton(a), A: solution.force_constant(a)}) for a in (1, 2, 3))
    right = (A + B0 * sp.cos(Omega * t) - k * x - c * v) / m
    return [equation(general, right, cases(*checks), "F"), *map(_constant, (1, 2, 3))]


def _friction(scope: FragmentScope) -> Items:
    """Return the items on the model: its forces, and the acceleration in each domain."""
    return (
        r"A mass $m$ on a spring $k$ and a damper $c$ is driven by $A_0 + B_0\cos\Omega t$ and "
        r"pressed with the force $F_N$ between two belts with the speeds $v_1 < v_2$ and the "
        r"friction coefficients $\mu_1$ and $\mu_2$. With $\operatorname{Sgn}(s) = "
        r"\operatorname{sgn}(s)$ for $s \ne 0$ and $\operatorname{Sgn}(0) = [-1, 1]$, $m\ddot{x} + "
        r"c\dot{x} + k x - A_0 - B_0\cos\Omega t \in -\mu_1 F_N\operatorname{Sgn}(\dot{x} - v_1) - "
        r"\mu_2 F_N\operatorname{Sgn}(\dot{x} - v_2)$. In the domains $\Omega_1$ ($\dot{x} < "
        r"v_1$), $\Omega_2$ ($v_1 < \dot{x} < v_2$) and $\Omega_3$ ($\dot{x} > v_2$)",
        "the acceleration is",
        _acceleration(),
    )


def _flow(scope: FragmentScope) -> Items:
    """Return the items on the motion inside a domain."""
    return (
        r"Where $m\ddot{x} + c\dot{x} + k x = A_\alpha + B_0\cos\Omega t$, take the motion from "
        r"$(x_i, \dot{x}_i)$ at the time $t_i$ with the phase $\theta_i = \Omega t_i$, at $\tau = "
        r"t - t_i$ later.",
        _motion(scope),
    )


def _stick(scope: FragmentScope) -> Items:
    """Return the items on a stick: how long it lasts, and the forces that decide it."""
    return (
        r"While the mass moves with belt $\lambda$, $\dot{x} = v_\lambda$ and $\ddot{x} = 0$. The "
        r"stick lasts as long as $F^{(\lambda)} \ge 0 \ge F^{(\lambda+1)}$, where $m F^{(\alpha)}$ "
        r"is what all forces would sum up to if friction were that of the domain below ($\alpha = "
        r"\lambda$) or above ($\alpha = \lambda + 1$) the belt's speed. It ends where the first of "
        r"the two changes its sign, and the mass slips into that domain. On belt 1",
        [sticks.force(1, alpha, f"belt1-F{alpha}") for alpha in (1, 2)],
        "and on belt 2",
        [sticks.force(2, alpha, f"belt2-F{alpha}") for alpha in (2, 3)],
        r"with the phase $\theta = \Omega t$. All of them change at the rate",
        sticks.rate(),
    )


def _g_functions(scope: FragmentScope) -> Items:
    """Return the items on the G-functions at a boundary."""
    return (
        r"The G-functions of the domain $\Omega_\alpha$ at a boundary $\dot{x} = v_\lambda$ are "
        r"the derivatives of the acceleration $F^{(\alpha)}$ along its flow; $\theta = \Omega t$ "
        r"is the phase:",
        _relabelled(switching.g_functions(), "G"),
    )


#: What Theorems 4 to 6 say about a motion at a boundary.
AT_BOUNDARY = {
    "theorem4": r"the motion sticks to belt $\lambda$ if $F^{(\lambda)} > 0$ and "
    r"$F^{(\lambda+1)} < 0$",
    "theorem5": r"the motion passes if $F^{(\lambda)} F^{(\lambda+1)} > 0$: upward, into "
    r"$\Omega_{\lambda+1}$, if both "
    r"are positive, downward, into $\Omega_\lambda$, if both are negative",
    "theorem6": r"a flow that comes in $\Omega_\lambda$ grazes if $F^{(\lambda)} = 0$ and "
    r"$G^{(1,\lambda)} < 0$, one "
    r"that comes in $\Omega_{\lambda+1}$ if $F^{(\lambda+1)} = 0$ and $G^{(1,\lambda+1)} > 0$; "
    r"where "
    r"$G^{(1,\alpha)} = 0$ too, the first derivative of $F^{(\alpha)}$ along the flow that does "
    r"not vanish decides, "
    r"and grazes iff its order is odd",
}


def _theorem(name: str, scope: FragmentScope) -> Items:
    """Return the fragment of Theorem 4, 5 or 6."""
    rate: Items = ()
    if name == "theorem6":
        rate = (r"With the phase $\theta = \Omega t$", switching.at_belt("G1"))
    return (
        r"At the boundary $\dot{x} = v_\lambda$ between $\Omega_\lambda$ below and "
        r"$\Omega_{\lambda+1}$ above it, "
        rf"{AT_BOUNDARY[name]}.",
        r"Here the acceleration in $\Omega_\alpha$ is",
        _acceleration(),
        rate,
    )


def _theorem7(scope: FragmentScope) -> Items:
    """Return the items that state Theorem 7: the table of windows, and those of the scope's numbers."""
    *letters, place = grazing.contact_steps()
    table = grazing.windows_table("theorem7")
    windows = list(_windows_in_numbers(scope))
    contact = (
        r"Where $m\ddot{x} + c\dot{x} + k x = A_\alpha + B_0\cos\Omega t$ in $\Omega_\alpha$, the "
        r"contact is at",
        place,
    )
    return (
        r"Let the flow of $\Omega_\alpha$ have $\dot{x} = v_\lambda$ and $\ddot{x} = 0$ at the "
        r"time $t_m$, with the phase $\theta_m = \Omega t_m$ modulo $2\pi$: $P_2$ has $(\alpha, "
        r"\lambda) = (1, 1)$, $P_3$ $(2, 1)$, $P_5$ $(2, 2)$ and $P_6$ $(3, 2)$, with $\sigma = 1$ "
        r"where the boundary is above the domain, and $\sigma = -1$ where it is below. With",
        letters,
        r"and $\Theta^{\mathrm{cr}} = \arcsin(-\gamma/a)$, the flow grazes the boundary to first "
        r"order iff $\theta_m$ is in the set below, for $a \ge 0$; for $a < 0$ the sets are those "
        r"of $-a$, moved by $\pi$.",
        Table(table.label, "The phases at which a contact grazes.", table.heads, table.rows),
        r"A single point that is taken out, for $|\gamma| = a$, is a tangency of fourth order, at "
        r"which the flow returns as well: to full order these two sets are the whole circle, and "
        r"the others stay as they are.",
        contact if dict(scope.values).get("k") != 0 else (),
        ("With the numbers of this paper", windows) if windows else (),
    )


def _saltation(scope: FragmentScope) -> Items:
    """Return the items that state the saltation matrices, and the matrix between events."""
    ratios = [
        item for item in flat(jacobians.saltation()) if isinstance(item, Step) and item.op != "="
    ]
    return (
        r"Where a motion crosses $\dot{x} = v_\lambda$ with the accelerations $F^{-} \ne 0$ before "
        r"and $F^{+} \ne 0$ after, a small change $(\delta x, \delta\dot{x})$ of its state is "
        r"multiplied by the saltation matrix $S = \operatorname{diag}(1, F^{+}/F^{-})$, where",
        _relabelled(ratios, "ratio"),
        r"At the onset of a stick the matrix is $\operatorname{diag}(1, 0)$, at its end the "
        r"identity. Between events it is multiplied by $\Phi(\tau)$ with the entries",
        _relabelled(jacobians.perturbations(), "phi")[:4],
        BASIS_TEXT + ".",
    )


def _windows_in_numbers(scope: FragmentScope) -> Iterator[Step]:
    """Yield the window of each mapping whose parameters are all given as numbers in the scope."""
    given = {name for name, _ in scope.values}
    for mapping, place in PLACES.items():
        if {"m", "k", "B0", "Omega", f"v{place.boundary}"} <= given:
            gamma = (k * BELTS[place.boundary] / m).xreplace(scope.numbers)
            amplitude = (B0 * Omega / m).xreplace(scope.numbers)
            phases = theorem7.window_phases(place, gamma, amplitude, full=False)
            check = grazing.window(place.side, gamma, amplitude)
            yield step(
                grazing.THETA_M,
                "in",
                phases,
                check,
                note=rf"for $P_{mapping[1]}$",
                label=f"window-{mapping}",
            )


# --- the motion in a domain, and the mappings ---


def _motion(scope: FragmentScope) -> Items:
    """Return the items that state the motion from (x_i, v_i) at t_i, in the form that the scope
    asks for.
    """
    regime = scope.regimes[0]
    name, condition = domains.REGIME_WORDS[regime.name]
    letters = {letter: domains.true_letters()[letter] for letter in regime.letters}
    labels = {letter: f"letter-{letter.name.replace('_', '')}" for letter in letters}
    steps = [
        equation(letter, regime.letters[letter], true, labels[letter])
        for letter, true in letters.items()
    ]
    if scope.form == "paper":
        form = domains.paper_form(regime)
        return (
            rf"In the regime {name} ({condition}) the motion is",
            equation(POSITION, form.x, form.check, "x"),
            equation(VELOCITY, form.v, form.x.diff(tau), "v"),
            "with",
            [step for step in steps if step.left in form.x.free_symbols],
            domains.constants(form),
        )
    at_start, x_step, v_step, _ = domains.flow()
    solved = flat(domains.solved_functions(generic_basis()))
    rest_of_functions = [item for item in solved if isinstance(item, Step) and item.left != E2]
    # At resonance all functions have closed forms of their own; else the others follow from three.
    if regime.name == "resonance":
        in_closed_form = BASIS
        others: Items = ()
    else:
        in_closed_form = (E0, E1, E2)
        others = ("and with", rest_of_functions)
    return (
        "The motion is",
        [x_step, v_step],
        "with the acceleration at the start",
        at_start,
        rf"{BASIS_TEXT}. In the regime {name} ({condition})",
        steps,
        [domains.basis_function(f, regime, label=f.name) for f in in_closed_form],
        others,
    )


def _flight_map(label: str, scope: FragmentScope) -> Items:
    """Return the items that state the equations of a flight, the mapping `label`."""
    row = MAPS[label]
    start = BELTS[row.start.boundary]
    end = BELTS[row.end.boundary]
    scope.instances.update({v_i: start, maps.v_j: end, A: named(f"A_{row.domain}")})
    planes = [
        rf"\Sigma^{{{plane.superscript}}}_{{({plane.boundary})}}" for plane in (row.start, row.end)
    ]
    f1 = named("f_1")
    f2 = named("f_2")
    flow = solution.flow()
    residual = maps.flight_residual()
    return (
        rf"The mapping $P_{label[1]}\colon {planes[0]} \to {planes[1]}$ leads from $(x_i, "
        r"\theta_i)$ on "
        rf"$\dot{{x}} = {latex(start)}$ through $\Omega_{row.domain}$ to $(x_{{i+1}}, "
        rf"\theta_{{i+1}})$ on $\dot{{x}} = {latex(end)}$; $\theta = \Omega t$ modulo $2\pi$ is "
        rf"the phase, and "
        r"$\Sigma^{1}_{(\lambda)}$ and $\Sigma^{2}_{(\lambda)}$ are the points of motions below "
        r"and above $\dot{x} = v_\lambda$. With the duration",
        equation(
            tau, (maps.theta_j - theta_i) / Omega, {maps.theta_j: theta_i + Omega * tau}, "tau"
        ),
        r"it solves $f_1 = f_2 = 0$ with",
        equation(f1, POSITION - maps.x_j, {f1: residual["f1"], POSITION: flow.x}, "f1"),
        equation(f2, VELOCITY - maps.v_j, {f2: residual["f2"], VELOCITY: flow.v}, "f2"),
        r"where $\tau$ is the first positive time at which the motion meets the speed of a belt.",
        _motion(scope),
        rf"In the domain $\Omega_{row.domain}$ ({motion.VELOCITIES[row.domain]}) the motion obeys "
        rf"$m\ddot{{x}} + c\dot{{x}} + k x = A_{row.domain} + B_0\cos\Omega t$, and the constant "
        r"part of the forces is",
        _constant(row.domain),
    )


def _stick_map(label: str, scope: FragmentScope) -> Items:
    """Return the items that state the equations of a stick, the mapping `label`."""
    belt = MAPS[label].start.boundary
    speed = BELTS[belt]
    plane = rf"\Sigma^{{0}}_{{({belt})}}"
    f1 = named("f_1")
    at_end = {v: speed, x: maps.x_j, Omega * t: maps.theta_j}
    f1_on_belt = maps.stick_residual()["f1"].xreplace({v_i: speed})
    exits = []
    for alpha in NEIGHBOURS[belt]:
        f2 = named(f"f_2^{{({alpha})}}")
        if alpha == belt:
            change = "falls below"
        else:
            change = "rises above"
        force = m * motion.acceleration(alpha)
        by_newton = m * motion.newton(alpha)
        exits += [
            rf"and with $f_2 = f_2^{{({alpha})}}$ if the mass slips into $\Omega_{alpha}$, where "
            rf"this {change} 0:",
            equation(f2, sp.expand(force.subs(at_end)), by_newton.subs(at_end), f"f2-{alpha}"),
        ]
    return (
        rf"The mapping $P_{label[1]}\colon {plane} \to {plane}$, the points with $\dot{{x}} = "
        rf"v_{belt}$ of motions on the belt, is a stick on belt {belt} from $(x_i, \theta_i)$ to "
        r"$(x_{i+1}, \theta_{i+1})$, with the phase $\theta = \Omega t$ modulo $2\pi$ and $\tau = "
        r"(\theta_{i+1} - \theta_i)/\Omega$. It solves $f_1 = f_2 = 0$ with",
        equation(f1, f1_on_belt, x_i + sp.integrate(speed, (tau, 0, tau)) - maps.x_j, "f1"),
        exits,
        r"The first of the two ends counts.",
    )


FRAGMENTS = {
    "friction": Fragment("The equation of motion", _friction, {"F": "9"}),
    "flow": Fragment("The motion in a domain", _flow),
    "stick": Fragment("Sticks and their two ends", _stick, {"belt1-F2": "52", "belt2-F3": "53"}),
    "gfunctions": Fragment("The G-functions", _g_functions, {"G1": "47"}),
    **{
        name: Fragment(f"Theorem {name[-1]}", partial(_theorem, name), {"F": "9", "G1": "47"})
        for name in AT_BOUNDARY
    },
    "theorem7": Fragment(
        "Theorem 7", _theorem7, {"column1": "(55), (57)", "column2": "(56), (58)"}
    ),
    "saltation": Fragment("Saltation and perturbations", _saltation),
}
for _name, _row in MAPS.items():
    _items = _flight_map
    _tags = {"f1": r"54\,a", "f2": r"54\,b"}
    if _row.sticks:
        _items = _stick_map
        _tags = {"f1": "52" if _name == "P1" else "53"}
    FRAGMENTS[_name] = Fragment(f"The mapping $P_{_name[1]}$", partial(_items, _name), _tags)
