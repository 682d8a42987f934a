"""Theorem 7: eqs. (55) to (58) with every case, the contact's place, and the tangency of fourth order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import sympy as sp

from symosc.derive.latex import named
from symosc.derive.scope import BELTS, Scope, v_lambda
from symosc.derive.steps import Check, Exact, Heading, Prose, Relation, Step, StepError, StepEvidence, equation
from symosc.mappings.theorem7_cases import PLACES, Place
from symosc.symbolic import solution, theorem7
from symosc.symbolic.solution import B0, A, Omega, c, k, m, t, theta, v, x

TITLE = "Theorem 7 with all cases"
PHASE = named(r"\mathrm{mod}(\Omega t_m, 2\pi)")

g, a = sp.symbols("gamma a", real=True)
p, q = sp.symbols("p q", positive=True)


@dataclass(frozen=True)
class Window(Check):
    """The set on the right is where side (gamma + a sin theta) > 0, for given signs of gamma, a and |gamma| - |a|.

    Exact: the ends are zeros of gamma + a sin theta, which has at most two, and on each piece the sign is decided at a
    phase where the sine is 1, 0 or -1.
    """

    side: int
    gamma: Any
    amplitude: Any
    names: tuple[tuple[Any, Any], ...] = ()

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        parts = statement.right.args if isinstance(statement.right, sp.Union) else (statement.right,)
        for part in parts:
            for end in part.args[:2] if isinstance(part, sp.Interval) else ():
                self._check_end(statement, end, parts)
        for sine, phase in ((1, sp.pi / 2), (-1, 3 * sp.pi / 2), (0, sp.Integer(0)), (0, sp.pi)):
            value = self.side * (self.gamma + self.amplitude * sine)
            inside = sp.simplify(value).is_positive
            if inside is None:
                raise StepError(str(statement), f"the sign of {value} is undecided")
            if inside != self._contains(parts, phase):
                raise StepError(str(statement), f"is wrong at {phase}")
        return StepEvidence("exact", "0")

    def _check_end(self, statement: Relation, end: Any, parts: Any) -> None:
        if end in (0, 2 * sp.pi) and any(part.args[0] == 0 and part.args[2] == sp.false for part in parts):
            return  # an arc through 0
        angle = self._angle(end)
        zero = sp.simplify(sp.expand_trig(sp.sin(angle)) * self.amplitude + self.gamma)
        if zero != 0:
            raise StepError(str(statement), f"{end} is no zero of gamma + a sin theta, which is {zero} there")

    def _angle(self, end: Any) -> Any:
        for name, value in self.names:
            end = end.subs(name, value)
        return end.subs({g: self.gamma, a: self.amplitude})

    def _contains(self, parts: Any, phase: Any) -> bool:
        # Ends cannot cross a multiple of pi/2 while the signs stay: one set of numbers stands for all.
        numbers = {p: sp.Rational(3, 7), q: sp.Rational(2, 5)}
        for part in parts:
            if part == sp.S.EmptySet:
                continue
            low, high = (self._angle(end).subs(numbers) for end in part.args[:2])
            above = phase - low
            below = high - phase
            after = above > 0 or (part.args[2] == sp.false and above == 0)
            if after and (below > 0 or (part.args[3] == sp.false and below == 0)):
                return True
        return False


SHAPES = {
    (1, -1): (p, p + q, r"for $0 < \gamma_{j} < \frac{B_0}{m}\Omega$"),
    (1, 0): (p, p, r"for $0 < \gamma_{j} = \frac{B_0}{m}\Omega$"),
    (1, 1): (p + q, p, r"for $0 < \frac{B_0}{m}\Omega < \gamma_{j}$"),
    (0, -1): (sp.Integer(0), p, r"for $\gamma_{j} = 0$"),
    (-1, -1): (-p, p + q, r"for $\gamma_{j} < 0$, $\frac{B_0}{m}\Omega > |\gamma_{j}|$"),
    (-1, 0): (-p, p, r"for $\gamma_{j} < 0$, $\frac{B_0}{m}\Omega = |\gamma_{j}|$"),
    (-1, 1): (-p - q, p, r"for $\gamma_{j} < 0$, $\frac{B_0}{m}\Omega < |\gamma_{j}|$"),
}


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _contact()
    for mapping, place in PLACES.items():
        if scope.scene is None:
            yield from _cases(mapping, place)
        elif place.boundary in scope.boundaries:
            yield from _numbers(scope, mapping, place)
    yield from _equality()
    if scope.scene is None:
        yield from _signs()


def _contact() -> Iterator[Any]:
    yield Heading("What a contact fixes")
    gamma, acceleration = named(r"\gamma"), named(r"\ddot{x}")
    yield Prose(
        r"At a graze the flow of a domain $\Omega_\alpha$ touches $\dot{x} = v_\lambda$ with $F^{(\alpha)} = 0$, "
        r"so that "
        r"$\ddot{x} = 0$ and $\dot{x} = v_\lambda$ at $t_m$. The paper's $\gamma = (c/m)\ddot{x} + (k/m)\dot{x}$ is "
        r"therefore no unknown:"
    )
    general = (c * acceleration + k * named(r"\dot{x}_m")) / m
    at_contact = general.subs({acceleration: 0, named(r"\dot{x}_m"): v_lambda})
    yield equation(gamma, k * v_lambda / m, "", Exact({gamma: at_contact}))
    place = named("x_m")
    force = solution.in_paper_letters(solution.acceleration()).subs({v: v_lambda, Omega * t: theta})
    solved = sp.solve(force, x)[0]
    yield equation(
        place,
        (A + B0 * sp.cos(theta) - c * v_lambda) / k,
        r"and $F^{(\alpha)} = 0$ fixes the place of the contact from its phase $\theta = \Omega t_m$, if $k > 0$:",
        Exact({place: solved}),
    )
    name = named(r"G^{(1,\alpha)}")
    first = solution.in_paper_letters(solution.g_function(1).subs(v, v_lambda)).subs(Omega * t, theta)
    yield equation(
        name,
        -(k * v_lambda + B0 * Omega * sp.sin(theta)) / m,
        r"Then (62) and (66) depend on the phase only:",
        Exact({name: first.subs(x, solved)}, sp.simplify),
    )
    critical = named(r"\Theta^{\mathrm{cr}}")
    angle = sp.asin(-k * v_lambda / (B0 * Omega))
    yield equation(
        sp.sin(critical),
        -k * v_lambda / (B0 * Omega),
        r"which vanishes at the critical phase $\Theta^{\mathrm{cr}} = \arcsin(-\gamma m/(B_0\Omega))$,",
        Exact({critical: angle}),
    )


def _cases(mapping: str, place: Place) -> Iterator[Any]:
    number = mapping[1]
    critical = named(rf"\Theta^{{\mathrm{{cr}}}}_{number}")
    relation = "<" if place.side > 0 else ">"
    yield Heading(rf"$P_{number}$: from $\Omega_{place.domain}$ at $v_{place.boundary}$, eq.~({place.equation})")
    sine = ">" if place.side > 0 else "<"
    reason = (
        rf"It grazes iff $G^{{(1,{place.domain})}} {relation} 0$, that is $\sin\theta {sine} \sin{critical.name}$ "
        rf"for $B_0 > 0$, with $\gamma_{number} = k v_{place.boundary}/m$:"
    )
    table = theorem7.all_cases(place, False)
    for (gamma_sign, excess), (gamma, amplitude, words) in SHAPES.items():
        case = next(row for row in table if _holds(row.condition, gamma, amplitude))
        shown = _with_name(case.phases, critical)
        check = Window(place.side, gamma, amplitude, ((critical, sp.asin(-g / a)),))
        note = words.replace("{j}", number)
        missing = place.side > 0 and (gamma_sign, excess) == (-1, 0)
        note += " (missing in the paper)" if missing else ""
        yield Step(Relation(PHASE, "in", shown), reason, check, note)
        reason = ""
    for gamma in (p, -p, sp.Integer(0)):
        case = next(row for row in table if _holds(row.condition, gamma, sp.Integer(0)))
        sign = {p: "> 0", -p: "< 0"}.get(gamma, "= 0")
        note = rf"for $B_0 = 0$, $\gamma_{number} {sign}$"
        yield Step(Relation(PHASE, "in", case.phases), "", Window(place.side, gamma, sp.Integer(0)), note)


def _holds(condition: Any, gamma: Any, amplitude: Any) -> bool:
    return bool(sp.simplify(condition.subs({g: gamma, a: amplitude}, simultaneous=True)) == sp.true)


def _with_name(phases: Any, critical: Any) -> Any:
    """Write Theta_cr for asin(-gamma/a) in the ends of a set."""
    if isinstance(phases, sp.Union):
        return sp.Union(*(_with_name(part, critical) for part in phases.args), evaluate=False)
    if not isinstance(phases, sp.Interval):
        return phases
    low, high, *open_ends = phases.args
    names = {sp.asin(g / a): -critical}
    return sp.Basic.__new__(sp.Interval, low.subs(names), high.subs(names), *open_ends)


def _numbers(scope: Scope, mapping: str, place: Place) -> Iterator[Any]:
    """Yield the window of a scene, with its numbers."""
    number = mapping[1]
    gamma = (k * BELTS[place.boundary] / m).subs(scope.numbers)
    amplitude = (B0 * Omega / m).subs(scope.numbers)
    yield Heading(rf"$P_{number}$: from $\Omega_{place.domain}$ at $v_{place.boundary}$, eq.~({place.equation})")
    for letter, value, formula in (
        (named(rf"\gamma_{number}"), gamma, k * BELTS[place.boundary] / m),
        (named(r"\tfrac{B_0}{m}\Omega"), amplitude, B0 * Omega / m),
    ):
        reason = "The numbers to compare are" if letter.name.startswith(r"\gamma") else ""
        yield equation(letter, value, reason, Exact({letter: formula.subs(scope.numbers)}))
    phases = theorem7.window_phases(place, gamma, amplitude, False)
    reason = r"and the flow grazes at the phases"
    yield Step(Relation(PHASE, "in", phases), reason, Window(place.side, gamma, amplitude))


def _equality() -> Iterator[Any]:
    yield Heading(r"At the ends of a window")
    second, third = named(r"G^{(2,\alpha)}"), named(r"G^{(3,\alpha)}")
    contact = {v: v_lambda, x: (solution.A_m + solution.f0 * sp.cos(theta) - solution.cm * v_lambda) / solution.w0sq}
    g1, g2, g3 = (sp.expand(solution.g_function(n).subs(contact)) for n in (1, 2, 3))
    on_end = {v_lambda: -solution.f0 * Omega * sp.sin(theta) / solution.w0sq}
    assert sp.simplify(g1.subs(on_end)) == 0
    wave = {solution.f0: B0 / m, solution.w0sq: k / m, solution.cm: c / m}
    yield equation(
        second,
        -B0 * Omega**2 * sp.cos(theta) / m,
        r"Where $F^{(\alpha)} = G^{(1,\alpha)} = 0$ the next order decides:",
        Exact({second: g2.subs(on_end).xreplace(wave)}, sp.simplify),
    )
    yield Prose(
        r"For $|\gamma| < |B_0|\Omega/m$ it is not 0 at the ends: the contact is an inflection of odd order "
        r"$\tau^3$, and the "
        r"flow passes. For $|\gamma| = |B_0|\Omega/m$ both ends are the one phase with $\cos\theta = 0$, and one "
        r"order more is "
        r"needed:"
    )
    yield equation(
        third,
        B0 * Omega**3 * sp.sin(theta) / m - c * second / m,
        "",
        Exact({third: g3.subs(on_end).xreplace(wave), second: g2.subs(on_end).xreplace(wave)}, sp.simplify),
    )
    ends = (
        (
            3 * sp.pi / 2,
            -B0 * Omega**3 / m,
            r"With $B_0 > 0$, at $\theta = 3\pi/2$, which (55) and (57) exclude, it is",
        ),
        (sp.pi / 2, B0 * Omega**3 / m, r"and at $\theta = \pi/2$, which (56) and (58) exclude,"),
    )
    for phase, value, reason in ends:
        name = named(rf"G^{{(3,\alpha)}}|_{{\theta = {sp.latex(phase)}}}")
        true = (B0 * Omega**3 * sp.sin(theta) / m).subs(theta, phase)
        yield equation(name, value, reason, Exact({name: true}))
    yield Prose(
        r"The gap then starts with $G^{(3,\alpha)}\tau^4/24$ and has the sign of a graze: a tangency of fourth "
        r"order, after which "
        r"the flow does return. The paper's theorem stops at the first order and excludes it; with all orders "
        r"the window is "
        r"the whole circle."
    )


def _signs() -> Iterator[Any]:
    yield Heading(r"Other signs of $B_0$, and no spring")
    turned = named(r"B_0 \sin\theta\,|_{B_0 \to -B_0,\ \theta \to \theta + \pi}")
    yield equation(
        turned,
        B0 * sp.sin(theta),
        r"Changing the sign of $B_0$ and moving the phase by $\pi$ changes nothing, so $B_0 < 0$ has the windows "
        r"of $-B_0$ "
        r"half a period later:",
        Exact({turned: -B0 * sp.sin(theta + sp.pi)}, sp.simplify),
    )
    force = named(r"m F^{(\alpha)}|_{k = 0}")
    plain = m * solution.in_paper_letters(solution.acceleration()).subs({v: v_lambda, Omega * t: theta, k: 0})
    yield equation(
        force,
        A + B0 * sp.cos(theta) - c * v_lambda,
        r"Without a spring $\gamma = 0$, and $F^{(\alpha)} = 0$ fixes the phase instead of the place:",
        Exact({force: plain}, sp.expand),
    )
