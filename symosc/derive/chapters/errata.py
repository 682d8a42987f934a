"""Errata: each error or gap of the paper, what is right, and the check that shows it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from symosc.derive.chapters.motion import MU, coulomb, newton
from symosc.derive.latex import named
from symosc.derive.scope import SIDES, F, Scope
from symosc.derive.steps import (
    DIGITS,
    Check,
    Close,
    Exact,
    Heading,
    Prose,
    Relation,
    Sign,
    Step,
    StepError,
    StepEvidence,
    equation,
    rounded,
)
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution
from symosc.symbolic.solution import A0, B0, FN, Omega, m, mu1, mu2, t, theta

TITLE = "Errata"


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"Errors and gaps of the paper. Each item gives the paper's equation, what is right, and a checked line "
        r"that shows it."
    )
    yield from _friction()
    yield from _repelling()
    yield from _exits()
    yield from _windows()
    yield from _contact()
    figures = {"fig7": _figure7, "fig8": _figure8, "fig9": _figure9, "fig10": _figure10}
    for name, chapter in figures.items():
        if scope.scene is None or scope.scene.name.partition("-")[0] == name:
            yield from chapter()


def _friction() -> Iterator[Any]:
    yield Heading("Eqs.~(1) and (5): the sign of the friction force")
    for alpha, drag in ((1, -(mu1 + mu2)), (2, mu1 - mu2), (3, mu1 + mu2)):
        name = named(f"A_{alpha}")
        yield equation(
            name - A0,
            -drag * FN,
            r"(1) gives the friction force as the resistance to be overcome: it stands with a minus on the right "
            r"of (5), which "
            r"the paper does not say. With $F_f$ of (1) in each domain, $A_\alpha = A_0 - F_f$:"
            if alpha == 1
            else "",
            Exact({name: coulomb(alpha)}, sp.expand),
        )
    yield Prose(
        r"Also, (1) lets the single values hold at $\dot{x} = v_1$ and $\dot{x} = v_2$, where the force is an "
        r"interval: the "
        r"domains have to be open, as in (6)."
    )


def _repelling() -> Iterator[Any]:
    yield Heading(r"Eqs.~(38), (44), (45): both sides at once")
    for belt in (1, 2):
        lo, hi = SIDES[belt]
        mu = sp.Symbol(f"mu_{belt}", positive=True)
        force = sp.Symbol("F_N", positive=True)
        meaning = {F(lo): newton(lo).subs({MU[belt]: mu, FN: force}), F(hi): newton(hi).subs({MU[belt]: mu, FN: force})}
        reason = (
            r"(44) and (45), read as they stand, want $G^{(0,\alpha)} = 0$ and the inequality on \emph{both} "
            r"sides of the "
            r"boundary. A graze is a matter of one domain; on a belt with friction both forces cannot vanish together:"
        )
        yield Step(Relation(F(lo) - F(hi), ">", sp.Integer(0)), reason if belt == 1 else "", Sign(meaning))
    yield Prose(
        r"After (19), $t_{m+}$ and $t_{m-}$ are explained the wrong way round, and in (14) the boundary is a subset of "
        r"$\mathbb{R}^{n}$, not of $\mathbb{R}^{n-1}$. The assumption $\mu_1 \ge \mu_2$ after (1) is never used."
    )


@dataclass(frozen=True)
class SlipTime(Check):
    """The first slip off a belt in a scene leads into a domain, at the printed time (20 decimals)."""

    scene: str
    target: str

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        event = first_slip(self.scene)
        if event.target != self.target:
            raise StepError(str(statement), f"the mass slips into {event.target}")
        return Close(lambda: event.t, 20).run(statement)


@cache
def first_slip(scene: str) -> Any:
    """Return the first end of a stick, with 40 digits."""
    return next(e for e in simulate(load_scene(scene), digits=40, max_events=6).events if e.kind == "slip")


def _exits() -> Iterator[Any]:
    yield Heading("Eqs.~(52) and (53): one exit of two")
    rows = (
        (
            "fig5",
            1,
            1,
            2,
            r"(52) lets a stick on belt 1 end only by $F^{(2)} = 0$. With the numbers of Fig.~5 the first one ends",
        ),
        ("fig6", 2, 2, 3, r"(53) lets a stick on belt 2 end only by $F^{(3)} = 0$. Fig.~6 itself leaves belt 2"),
    )
    for scene, belt, alpha, other, words in rows:
        name = named("t")
        reason = rf"{words} at the time below by $F^{{({alpha})}} = 0$, into $\Omega_{alpha}$,"
        value = rounded(first_slip(scene).t, 20)
        yield Step(Relation(name, "=", value), reason, SlipTime(scene, f"Omega{alpha}"), decimals=True)
        numbers = Scope(load_scene(scene)).numbers
        left = F(other)
        sign = -1 if other > alpha else 1
        held = sign * (newton(1 if belt == 1 else 2) - newton(2 if belt == 1 else 3)).subs(numbers)
        yield Step(
            Relation(left, "=", held),
            r"where the force of the paper's condition is still",
            Exact({left: sign * 2 * (MU[belt] * FN / m).subs(numbers)}),
            decimals=True,
        )
    yield Prose("Chapter 3 has both exits of each belt.")


def _windows() -> Iterator[Any]:
    yield Heading(r"Eqs.~(55) to (58): cases")
    a = sp.Symbol("a", positive=True)
    half = sp.sin(theta / 2) - sp.cos(theta / 2)
    name = named(r"G^{(1,\alpha)}|_{\gamma = -a}")
    yield equation(
        name,
        a * half**2,
        r"(55) and (57) have no case for $\gamma < 0$, $|\gamma| = B_0\Omega/m =: a$. It is the empty set, since then "
        r"$G^{(1,\alpha)}$, which would have to be negative, is a square:",
        Exact({name: -(-a + a * sp.sin(theta))}, sp.simplify),
    )
    at = named(r"G^{(3,\alpha)}|_{\gamma = a,\ \theta = 3\pi/2}")
    yield equation(
        at,
        -B0 * Omega**3 / m,
        r"For $\gamma = a > 0$ they take $3\pi/2$ out, and (56), (58) take out $\pi/2$ for $\gamma = -a$, "
        r"because $G^{(1,\alpha)} = 0$ "
        r"there. But $G^{(2,\alpha)} = 0$ too, and the next one has the sign of a graze: the flow touches to "
        r"fourth order and "
        r"returns,",
        Exact({at: -solution.forcing(3).subs({theta: 3 * sp.pi / 2, solution.f0: B0 / m})}),
    )
    shifted = named(r"\sin(\theta + \pi)")
    yield equation(
        shifted,
        -sp.sin(theta),
        r"All cases suppose $B_0 > 0$. $B_0 < 0$ moves every window by half a period, since",
        Exact({shifted: sp.sin(theta + sp.pi)}),
    )
    yield Prose(
        r"and $B_0 = 0$ leaves everything or nothing by the sign of $\gamma$. Finally $\mathrm{mod}(\Omega t_m, "
        r"2\pi)$ never is "
        r"$2\pi$: the closed ends $2\pi]$ are the point 0."
    )


def _contact() -> Iterator[Any]:
    yield Heading(r"Theorem 7: ``four unknowns''")
    c, k, v = solution.c, solution.k, sp.Symbol("v_lambda", real=True)
    gamma, second = named(r"\gamma"), named(r"\ddot{x}(t_m)")
    yield equation(
        gamma,
        k * v / m,
        r"After (62) and (66) one unknown ``must be given'', and $\gamma_j$ is treated as free. But $\ddot{x} = 0$ and "
        r"$\dot{x} = v_\lambda$ at the contact, so that the parameters fix $\gamma_j$ and the case; only the "
        r"phase is free:",
        Exact({gamma: (c * second + k * v) / m, second: sp.Integer(0)}),
    )


# --- figures ---


def _graze(scene: str, alpha: int, speed: Any, time: Any, start: Any) -> tuple[Any, Any, Any]:
    """Return x at a contact at `time`, and (x, v) where the flow that touches there was at `start`, as expressions."""
    scope = Scope(load_scene(scene))
    numbers = scope.numbers
    force = solution.in_paper_letters(solution.acceleration()).subs(solution.A, solution.force_constant(alpha))
    place = sp.solve(force.subs({solution.v: speed, t: time}).subs(numbers), solution.x)[0]
    regime = scope.regimes[0]
    flow = solution.flow(regime)
    letters = {name: value.subs(numbers) for name, value in regime.letters.items()}
    at = {solution.x_i: place, solution.v_i: speed, solution.a_i: 0, solution.tau: start - time}
    at |= {solution.theta_i: (Omega * time).subs(numbers)}
    x, v = (expr.subs(letters | numbers).subs(at) for expr in (flow.x, flow.v))
    return place, x, v


def _decimal(name: str, value: Any, decimals: int, reason: str, note: str = "") -> Step:
    number = sp.N(value, DIGITS + 10)
    shown = rounded(number._to_mpmath(200), decimals)
    check = Close(lambda: number._to_mpmath(200), decimals)
    return Step(Relation(named(name), "=", shown), reason, check, note, decimals=True)


def _figure7() -> Iterator[Any]:
    yield Heading(r"Fig.~7: $A_0$")
    numbers = Scope(load_scene("fig7")).numbers
    k, c = solution.k, solution.c
    amplitude = (B0 * Omega) ** 2 / ((k - m * Omega**2) ** 2 + c**2 * Omega**2)
    square = named(r"V_0^2")
    yield equation(
        square,
        sp.Integer(20),
        r"With the printed parameters the steady velocity in $\Omega_1$ does not reach $v_1 = 5$, whatever $A_0$ "
        r"is: its "
        r"amplitude $V_0$ has",
        Exact({square: amplitude.subs(numbers)}),
    )
    yield Step(Relation(square, "<", sp.Integer(25)), "", Sign({square: amplitude.subs(numbers)}))
    reason = (
        r"so a graze can only be in the transient. The flow that touches $v_1$ at $t = \pi$, traced back to the "
        r"printed $t_0 = 2.5$, starts with $A_0 = 5$ at a point that is not the printed $(-3.1049, 1.3369)$:"
    )
    _, x, v = _graze("fig7", 1, sp.Integer(5), sp.pi, sp.Rational(5, 2))
    yield _decimal("x_0", x, 10, reason)
    yield _decimal(r"\dot{x}_0", v, 10, "")
    place, x, v = _graze("fig7-corrected", 1, sp.Integer(5), sp.pi, sp.Rational(5, 2))
    name = named("x_m")
    yield Step(
        Relation(name, "=", sp.nsimplify(place)),
        r"With $A_0 = 10$ the contact is at",
        Exact({name: place}),
        decimals=True,
    )
    yield _decimal(
        "x_0", x, 10, "and the start agrees with the printed one to all of its digits: the figure used $A_0 = 10$."
    )
    yield _decimal(r"\dot{x}_0", v, 10, "")


def _figure8() -> Iterator[Any]:
    yield Heading(r"Fig.~8: the start")
    place, x, v = _graze("fig8", 2, sp.Integer(-4), sp.pi, sp.Rational(5, 2))
    name = named("x_m")
    yield Step(
        Relation(name, "=", sp.nsimplify(place)), r"The graze at $t = \pi$ is at", Exact({name: place}), decimals=True
    )
    reason = (
        r"Its flow was at $t_0 = 2.5$ at the point below. The printed start $(5.8980, 2.2580)$ is off by one "
        r"unit of the last "
        r"digit and by two; from it the flow overshoots the belt's speed and sticks for a moment instead of grazing:"
    )
    yield _decimal("x_0", x, 10, reason)
    yield _decimal(r"\dot{x}_0", v, 10, "")


def _figure9() -> Iterator[Any]:
    yield from _start("fig9", "P32", 9, r"0.1324,\ 4.5447", "is a transient that approaches the periodic motion")


def _figure10() -> Iterator[Any]:
    yield from _start("fig10", "P4645", 10, r"0.4588,\ 3.0837", "is close to the periodic motion, but not on it")


def _start(scene: str, word: str, figure: int, printed: str, words: str) -> Iterator[Any]:
    from symosc.derive.chapters.orbits import root

    yield Heading(rf"Fig.~{figure}: the start")
    parameters = load_scene(scene).parameters
    x, phase = root(parameters, word)[0]
    time = phase * parameters.Omega.denominator / parameters.Omega.numerator
    reason = rf"The printed start $(t_0, x_0) = ({printed})$ {words}, whose switching point is at"
    yield Step(Relation(named("t_1"), "=", rounded(time, 10)), reason, Close(lambda: time, 10), decimals=True)
    yield Step(Relation(named("x_1"), "=", rounded(x, 10)), "", Close(lambda: x, 10), decimals=True)
