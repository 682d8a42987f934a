"""Parts of fragments: the motion in a domain, in both forms, and the mappings P1 to P8."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import sympy as sp

from symosc.derive.chapters import domains, motion
from symosc.derive.fragment_scope import FragmentScope
from symosc.derive.latex import latex, named
from symosc.derive.paper_form import paper_form
from symosc.derive.scope import BELTS
from symosc.derive.steps import Exact, Prose, Solves, Step, equation
from symosc.model import NEIGHBOURS
from symosc.symbolic import maps as symbolic_maps
from symosc.symbolic import solution
from symosc.symbolic.solution import BASIS, E0, E1, E2, A, Omega, a_i, m, t, tau, theta_i, v, v_i, x, x_i
from symosc.words import MAPS


def constant(alpha: int) -> Step:
    """Return what A_alpha is."""
    name = named(f"A_{alpha}")
    check = Exact({name: motion.coulomb(alpha)}, sp.expand)
    return equation(name, solution.force_constant(alpha), "", check, label=f"A{alpha}")


def _scene(alpha: Any) -> str:
    where = {1: r"$\dot{x} < v_1$", 2: r"$v_1 < \dot{x} < v_2$", 3: r"$\dot{x} > v_2$"}
    return rf"In the domain $\Omega_{alpha}$ ({where[alpha]})"


BASIS_TEXT = (
    r"Here $E_1(\tau)$ is the response of $\ddot{y} + (c/m)\dot{y} + (k/m)y$ to an impulse: the solution of the "
    r"unforced equation with $E_1(0) = 0$ and $\dot{E}_1(0) = 1$; further $E_0 = \dot{E}_1$, "
    r"$E_2(\tau) = \int_0^\tau E_1(u)\,du$ and $R_2(\tau) + i I_2(\tau) = \int_0^\tau E_1(u)\, "
    r"e^{i\Omega(\tau - u)}\,du$"
)


def _basis(scope: FragmentScope) -> Iterator[Any]:
    """Yield the five functions in the regime of the scope."""
    regime = scope.regime
    word, condition = domains.REGIME_WORDS[regime.name]
    parameters = regime.parameters()
    yield Prose(rf"{BASIS_TEXT}. In the regime {word} ({condition})")
    yield from _letters(regime)
    for symbol in (E0, E1, E2) if regime.name != "resonance" else BASIS:
        force, start, rate = domains.RESPONSES[symbol]
        solves = Solves(force, sp.Integer(start), sp.sympify(rate).xreplace(parameters), *parameters.values())
        yield equation(symbol, domains.tidy(regime.basis()[symbol]), "", solves, label=symbol.name)
    if regime.name == "resonance":
        return
    for item in domains.solved_functions(domains.generic_basis()):
        if isinstance(item, Step) and item.statement.left != E2:
            reason = "and with" if item.statement.left == domains.KAPPA else ""
            yield Step(item.statement, reason, item.check, label=item.label.removeprefix("domains-"))


def _letters(regime: solution.Regime) -> Iterator[Step]:
    true = domains.true_letters()
    for letter, value in regime.letters.items():
        name = str(letter).replace("_", "")
        yield equation(letter, value, "", Exact({letter: true[letter]}, sp.simplify), label=f"letter-{name}")


def motion_items(scope: FragmentScope) -> Iterator[Any]:
    """Yield the motion from x_i, in the form that is wanted."""
    if scope.form == "paper":
        yield from _paper_motion(scope)
        return
    flow = solution.flow()
    force = solution._force_at_start() + solution.f0 * sp.cos(theta_i + Omega * tau)
    position, velocity = named(r"x(\tau)"), named(r"\dot{x}(\tau)")
    solves = Solves(force, x_i, v_i, general=True)
    yield equation(position, flow.x, "The motion is", solves, label="x")
    by_v = {velocity: solution.time_derivative(flow.x)}
    yield equation(velocity, flow.v, "", Exact(by_v, solution.use_relations, independent=False), label="v")
    yield _start_acceleration(r"with the acceleration at the start")
    yield from _basis(scope)


def _start_acceleration(reason: str) -> Step:
    newton = sp.solve(solution.acceleration(x_i, v_i, theta_i) - a_i, a_i)[0]
    name = named(r"\ddot{x}_i")
    return equation(
        name, solution.acceleration(x_i, v_i, theta_i), reason, Exact({name: newton}, sp.expand), label="start"
    )


def _paper_motion(scope: FragmentScope) -> Iterator[Any]:
    regime = scope.regime
    form = paper_form(regime)
    word, condition = domains.REGIME_WORDS[regime.name]
    yield equation(
        named(r"x(\tau)"), form.x, rf"In the regime {word} ({condition}) the motion is", form.check, label="x"
    )
    velocity = named(r"\dot{x}(\tau)")
    yield equation(velocity, form.v, "", Exact({velocity: form.x.diff(tau)}, sp.simplify), label="v")
    reason = "with"
    for step in _letters(regime):
        if step.statement.left in form.x.free_symbols:
            yield Step(step.statement, reason, step.check, label=step.label)
            reason = ""
    for letter, value in form.constants.items():
        others = {name: other for name, other in form.constants.items() if name != letter}
        check = Exact(domains.constant_meaning(letter, form, regime, others), sp.simplify)
        yield equation(letter, value, reason, check, label=str(letter).replace("_", ""))
        reason = ""


def map_items(label: str) -> Callable[[FragmentScope], Iterator[Any]]:
    """Return what makes the fragment of a map."""
    row = MAPS[label]

    def items(scope: FragmentScope) -> Iterator[Any]:
        yield from _stick_map(label) if row.sticks else _flight_map(scope, label)

    return items


def _flight_map(scope: FragmentScope, label: str) -> Iterator[Any]:
    row = MAPS[label]
    start, end = BELTS[row.start.boundary], BELTS[row.end.boundary]
    scope.instances.update({v_i: start, symbolic_maps.v_j: end, A: named(f"A_{row.domain}")})
    name = f"P_{label[1]}"
    planes = [rf"\Sigma^{{{plane.superscript}}}_{{({plane.boundary})}}" for plane in (row.start, row.end)]
    yield Prose(
        rf"The mapping ${name}\colon {planes[0]} \to {planes[1]}$ leads from $(x_i, \theta_i)$ on "
        rf"$\dot{{x}} = {latex(start)}$ through $\Omega_{row.domain}$ to $(x_{{i+1}}, \theta_{{i+1}})$ on "
        rf"$\dot{{x}} = {latex(end)}$; $\theta = \Omega t$ modulo $2\pi$ is the phase, and "
        rf"$\Sigma^{{1}}_{{(\lambda)}}$ and $\Sigma^{{2}}_{{(\lambda)}}$ are the points of motions below and above "
        r"$\dot{x} = v_\lambda$. With the duration"
    )
    yield equation(
        tau,
        (symbolic_maps.theta_j - theta_i) / Omega,
        "",
        Exact({symbolic_maps.theta_j: theta_i + Omega * tau}),
        label="tau",
    )
    f1, f2 = named("f_1"), named("f_2")
    position, velocity = named(r"x(\tau)"), named(r"\dot{x}(\tau)")
    flow, residual = solution.flow(), symbolic_maps.flight_residual()
    check1 = Exact({f1: residual["f1"], position: flow.x}, sp.expand)
    check2 = Exact({f2: residual["f2"], velocity: flow.v}, sp.expand)
    yield equation(f1, position - symbolic_maps.x_j, r"it solves $f_1 = f_2 = 0$ with", check1, label="f1")
    yield equation(f2, velocity - symbolic_maps.v_j, "", check2, label="f2")
    yield Prose(r"where $\tau$ is the first positive time at which the motion meets the speed of a belt.")
    yield from motion_items(scope)
    yield Prose(
        rf"{_scene(row.domain)} the motion obeys $m\ddot{{x}} + c\dot{{x}} + k x = A_{row.domain} + B_0\cos\Omega t$, "
        "and the constant part of the forces is"
    )
    yield constant(row.domain)


def _stick_map(label: str) -> Iterator[Any]:
    row = MAPS[label]
    belt = row.start.boundary
    speed = BELTS[belt]
    plane = rf"\Sigma^{{0}}_{{({belt})}}"
    f1 = named("f_1")
    ride = symbolic_maps.stick_residual()["f1"].xreplace({v_i: speed})
    yield Prose(
        rf"The mapping $P_{label[1]}\colon {plane} \to {plane}$, the points with $\dot{{x}} = v_{belt}$ of motions on "
        rf"the belt, is a stick on belt {belt} from $(x_i, \theta_i)$ to "
        r"$(x_{i+1}, \theta_{i+1})$, with the phase $\theta = \Omega t$ modulo $2\pi$ and "
        r"$\tau = (\theta_{i+1} - \theta_i)/\Omega$. It solves $f_1 = f_2 = 0$ with"
    )
    yield equation(
        f1, ride, "", Exact({f1: x_i + sp.integrate(speed, (tau, 0, tau)) - symbolic_maps.x_j}, sp.expand), label="f1"
    )
    for alpha in NEIGHBOURS[belt]:
        f2 = named(f"f_2^{{({alpha})}}")
        at = {v: speed, x: symbolic_maps.x_j, Omega * t: symbolic_maps.theta_j}
        right = sp.expand(m * motion.acceleration(alpha).subs(at))
        way = "falls below" if alpha == belt else "rises above"
        reason = rf"and with $f_2 = f_2^{{({alpha})}}$ if the mass slips into $\Omega_{alpha}$, where this {way} 0:"
        check = Exact({f2: m * motion.newton(alpha).subs(at)}, sp.expand)
        yield equation(f2, right, reason, check, label=f"f2-{alpha}")
    yield Prose(r"The first of the two ends counts.")
