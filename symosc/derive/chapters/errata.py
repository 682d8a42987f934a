"""Errata: each distinct error or gap of the paper once, with its severity, what is right, and what shows it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import sympy as sp

from symosc.derive.blocks import Table
from symosc.derive.chapters.motion import MU, newton
from symosc.derive.errata import SEVERITIES, read_errata
from symosc.derive.latex import named
from symosc.derive.scope import F, Scope
from symosc.derive.steps import (
    CONTEXT,
    STEP_DIGITS,
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
    fact,
    rounded,
)
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution
from symosc.symbolic.solution import B0, FN, Omega, c, k, m, t, v, x

TITLE = "Errata"


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _list()
    yield from _flows()
    yield from _exits()
    figures = {"fig7": _figure7, "fig8": _figure8}
    for name, chapter in figures.items():
        if scope.scene is None or scope.scene.name.partition("-")[0] == name:
            yield from chapter()
    yield from _starts()


def _list() -> Iterator[Any]:
    errata = read_errata()
    yield Heading("The list")
    counts = ", ".join(
        rf"{sum(each.severity == severity for each in errata)} are \emph{{{severity}}} ({meaning})"
        for severity, meaning in SEVERITIES.items()
    )
    yield Prose(
        rf"These are the {len(errata)} distinct errors and gaps of the paper, in its order and each once: {counts}. "
        r"Numbers of equations, theorems and figures in this list are the paper's, but for those behind \emph{See}. "
        r"Its letters are the paper's too: $G^{(j)}$, $\Sigma^j$ and $x^{(i)}$ without the names of domain and belt, "
        r"$\partial\Omega_{ij}$ for a boundary and $\varphi_{ij} = 0$ for its equation."
    )
    for erratum in errata:
        see = f" See {erratum.shown}." if erratum.shown else ""
        yield Prose(
            rf"\textbf{{{erratum.number}.}}~{erratum.where} ({erratum.severity}). \emph{{Printed:}} {erratum.printed} "
            rf"\emph{{Right:}} {erratum.holds} \emph{{Proof.}} {erratum.proof}{see}"
        )


def _flows() -> Iterator[Any]:
    yield Heading(r"The derivative in (47)")
    field = solution.in_paper_letters(solution.acceleration())
    along = {"domain": (v, field), "boundary": (v, sp.Integer(0))}
    rates = {
        name: field.diff(x) * first + field.diff(v) * second + field.diff(t) for name, (first, second) in along.items()
    }
    difference = named(r"D_{\mathbf{x}^{(\alpha)}}F^{(\alpha)} - D_{\mathbf{x}^{(0)}}F^{(\alpha)}")
    yield equation(
        difference,
        -c * F(r"\alpha") / m,
        r"By its definition after (16), $D_{\mathbf{x}^{(0)}}$ differentiates along the boundary's flow, which has "
        r"$\dot{\mathbf{x}}^{(0)} = (v_\lambda, 0)^T$. The result that (47) gives is along the flow of the domain, "
        r"$\dot{\mathbf{x}}^{(\alpha)} = (v_\lambda, F^{(\alpha)})^T$. They differ by",
        Exact({difference: rates["domain"] - rates["boundary"], F(r"\alpha"): field}, sp.expand),
        label="errata-flows",
    )
    yield Prose(r"which vanishes at a graze, so that nothing that the paper derives from it changes.")


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
    yield Heading("The missing ends of sticks, (52) and (53)")
    rows = (
        (
            "fig5",
            1,
            1,
            2,
            r"(52) lets a stick on belt 1 end by $F^{(2)} = 0$ only. With the numbers of Fig.~5 the first one ends",
        ),
        ("fig6", 2, 2, 3, r"(53) lets a stick on belt 2 end by $F^{(3)} = 0$ only. In Fig.~6 the mass leaves belt 2"),
    )
    for scene, belt, alpha, other, words in rows:
        name = named("t")
        reason = rf"{words} at the time below by $F^{{({alpha})}} = 0$, into $\Omega_{alpha}$,"
        value = rounded(first_slip(scene).t, 20)
        yield Step(
            Relation(name, "=", value),
            reason,
            SlipTime(scene, f"Omega{alpha}"),
            decimals=True,
            label=f"errata-{scene}-slip",
        )
        numbers = Scope(load_scene(scene)).numbers
        held = (newton(other) - newton(alpha)).subs(numbers)
        yield Step(
            Relation(F(other), "=", held),
            r"where the acceleration of the paper's condition is still",
            Exact({F(other): -2 * (MU[belt] * FN / m).subs(numbers)}),
            decimals=True,
            label=f"errata-{scene}-held",
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


def _decimal(name: str, value: Any, decimals: int, reason: str, note: str = "", label: str = "") -> Step:
    number = sp.N(value, STEP_DIGITS + 10)
    shown = rounded(number._to_mpmath(200), decimals)
    check = Close(lambda: number._to_mpmath(200), decimals)
    return Step(Relation(named(name), "=", shown), reason, check, note, decimals=True, label=label)


def _figure7() -> Iterator[Any]:
    yield Heading(r"Fig.~7: one number is misprinted")
    numbers = Scope(load_scene("fig7")).numbers
    amplitude = (B0 * Omega) ** 2 / ((k - m * Omega**2) ** 2 + c**2 * Omega**2)
    square = named(r"V_0^2")
    yield Step(
        Relation(square, "=", sp.Integer(20)),
        r"With the printed parameters the steady velocity in $\Omega_1$ does not reach $v_1 = 5$, whatever "
        r"$A_0$ is: by \eqref{eq:events-V0} its amplitude has",
        Exact({square: amplitude.subs(numbers)}),
        label="errata-V0",
    )
    yield Step(Relation(square, "<", sp.Integer(25)), "", Sign({square: amplitude.subs(numbers)}))
    reason = (
        r"so a graze can only be in the transient. The flow that touches $v_1$ at $t = \pi$, traced back to the "
        r"printed $t_0 = 2.5$, starts with the printed $A_0 = 5$ at"
    )
    half = sp.Rational(5, 2)
    place, x0, v0 = _graze("fig7", 1, sp.Integer(5), sp.pi, half)
    yield _decimal("x_0", x0, 10, reason, label="errata-fig7-x0")
    yield _decimal(r"\dot{x}_0", v0, 10, "", label="errata-fig7-v0")
    yield Prose(
        r"The printed start is $(-3.1049, 1.3369)$: with a misprint in $x_0$, which would be $-5.6049$, "
        r"all other numbers are right, and the contact is at $x_m = -3.0855$.",
        (
            Step(Relation(named("x_0"), "=", sp.Rational("-5.6049")), "", Close(lambda: _number(x0), 4)),
            Step(Relation(named("v_0"), "=", sp.Rational("1.3369")), "", Close(lambda: _number(v0), 4)),
            fact(place, "=", sp.Rational("-3.0855"), Exact()),
        ),
    )
    other, x10, v10 = _graze("fig7-corrected", 1, sp.Integer(5), sp.pi, half)
    yield _decimal("x_0", x10, 10, r"With $A_0 = 10$ in place of 5 the start is", label="errata-fig7-x0-10")
    yield _decimal(r"\dot{x}_0", v10, 10, "", label="errata-fig7-v0-10")
    yield Prose(
        r"which is the printed one to all of its digits, with the contact at $x_m = -0.5855$. Either "
        r"number explains the figure; the numbers alone do not tell which one is misprinted.",
        (fact(other, "=", sp.Rational("-0.5855"), Exact()),),
    )


def _number(expr: Any) -> Any:
    return sp.N(expr, STEP_DIGITS + 10)._to_mpmath(200)


def _figure8() -> Iterator[Any]:
    yield Heading(r"Fig.~8: no error, but four decimals do not graze")
    half, time = sp.Rational(5, 2), sp.Rational("3.14158")
    _, x0, v0 = _graze("fig8", 2, sp.Integer(-4), time, half)
    reason = (
        r"The starts at $t_0 = 2.5$ from which the flow grazes form a curve, with one point for each time $t_m$ of the "
        r"contact. The point for $t_m = 3.14158$,"
    )
    yield _decimal("x_0", x0, 10, reason, label="errata-fig8-x0")
    yield _decimal(r"\dot{x}_0", v0, 10, "", label="errata-fig8-v0")
    yield Prose(
        r"rounds to the printed start $(5.8980, 2.2580)$, so the print is right. From the rounded numbers the velocity "
        r"goes beyond $v_1$, and the mass sticks for some milliseconds instead of grazing.",
        (
            Step(Relation(named("x_0"), "=", sp.Rational("5.898")), "", Close(lambda: _number(x0), 4)),
            Step(Relation(named("v_0"), "=", sp.Rational("2.258")), "", Close(lambda: _number(v0), 4)),
            Step(Relation(named("t"), "<", sp.Rational(3, 1000)), "", FirstStick("fig8")),
        ),
    )


@dataclass(frozen=True)
class FirstStick(Check):
    """From the printed start the first contact is a stick that is shorter than the right side."""

    scene: str

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        first, second = simulate(load_scene(self.scene), digits=30, max_events=2).events
        length = second.t - first.t
        if (first.kind, second.kind) != ("stick", "slip") or statement.op != "<" or not 0 < length < statement.right:
            raise StepError(str(statement), f"{first.kind}, {second.kind} after {length}")
        return StepEvidence("numeric", str(length)[:10], 1)


def _starts() -> Iterator[Any]:
    from symosc.derive.orbit_pieces import root

    yield Heading(r"Figs.~9 and 10: the starts")
    rows = []
    for scene, word, figure, printed in (
        ("fig9", "P32", 9, "0.1324, 4.5447"),
        ("fig10", "P4645", 10, "0.4588, 3.0837"),
    ):
        parameters = load_scene(scene).parameters
        place, phase = root(parameters, word)[0]
        time = phase * parameters.Omega.denominator / parameters.Omega.numerator
        cells = [
            Step(
                Relation(named(name), "=", rounded(value, 10)),
                "",
                Close(partial(CONTEXT.mpf, value), 10),
                decimals=True,
            )
            for name, value in (("t_1", time), ("x_1", place))
        ]
        rows.append((f"Fig.~{figure}", f"$P_{{{word[1:]}}}$", f"${printed}$", *cells))
    yield Table(
        "tab:errata-starts",
        r"The printed starts of Figs.~9 and 10, and the switching points of the periodic motions, to which the motions "
        r"from the printed starts tend (Theorem~\ref{thm:orbits-unique}).",
        ("figure", "orbit", "printed $t_0$, $x_0$", "$t_1$", "$x_1$"),
        tuple(rows),
    )
