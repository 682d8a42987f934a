"""Errata: each distinct error or gap of the paper, with its severity, the correction, and the
evidence.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from symosc.derive.chapters.motion import MU, newton
from symosc.derive.chapters.orbits import orbit_points
from symosc.derive.chapters.sticks import PAPER_EXITS
from symosc.derive.errata import SEVERITIES, read_errata
from symosc.derive.scope import F, Scope
from symosc.derive.steps import (
    Items,
    Step,
    StepError,
    Table,
    at_root,
    close,
    decimal,
    equation,
    facts,
    sign,
    step,
)
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, FN, Omega, c, k, m, t, v, x
from symosc.symbolic.theorem7 import rational

TITLE = "Errata"


def items(scope: Scope) -> Items:
    """Yield the chapter: the list of errors and gaps of the paper, and the computations behind some
    of them.
    """
    errata = read_errata()
    counts = ", ".join(
        rf"{sum(erratum.severity == severity for erratum in errata)} are \emph{{{severity}}} ({meaning})"
        for severity, meaning in SEVERITIES.items()
    )
    yield (
        r"\subsection{The list}",
        rf"These are the {len(errata)} distinct errors and gaps of the paper, in its order and "
        rf"each once: {counts}. "
        r"Numbers of equations, theorems and figures in this list are the paper's, except those "
        r"after \emph{See}. Its letters are the paper's too: $G^{(j)}$, $\Sigma^j$ and $x^{(i)}$ "
        r"without the names of domain and belt, $\partial\Omega_{ij}$ for a boundary and "
        r"$\varphi_{ij} = 0$ for its equation.",
        [
            rf"\textbf{{{erratum.number}.}}~{erratum.where} ({erratum.severity}). "
            rf"\emph{{Printed:}} {erratum.printed} \emph{{Right:}} {erratum.holds} \emph{{Proof.}} "
            rf"{erratum.proof}{f' See {erratum.shown}.' if erratum.shown else ''}"
            for erratum in errata
        ],
    )
    field = solution.in_paper_letters(solution.acceleration())
    domain, boundary = (
        field.diff(x) * v + field.diff(v) * rate + field.diff(t) for rate in (field, 0)
    )
    difference = named(r"D_{\mathbf{x}^{(\alpha)}}F^{(\alpha)} - D_{\mathbf{x}^{(0)}}F^{(\alpha)}")
    yield (
        r"\subsection{The derivative in (47)}",
        r"By its definition after (16), $D_{\mathbf{x}^{(0)}}$ differentiates along the boundary's "
        r"flow, which has $\dot{\mathbf{x}}^{(0)} = (v_\lambda, 0)^T$. The result that (47) gives "
        r"is along the flow of the domain, $\dot{\mathbf{x}}^{(\alpha)} = (v_\lambda, "
        r"F^{(\alpha)})^T$. They differ by",
        equation(
            difference,
            -c * F(r"\alpha") / m,
            {difference: domain - boundary, F(r"\alpha"): field},
            "flows",
        ),
        r"which vanishes at a graze, so that nothing that the paper derives from it changes.",
    )

    def ends(scene: str, belt: int, alpha: int, words: str) -> Items:
        """Return the text on the first stick of a scene, on `belt`, which ends into domain `alpha`."""
        numbers = Scope(load_scene(scene)).numbers
        above = belt + 1
        *_, slip_time = _up_to_slip(scene, 40, f"Omega{alpha}")
        # Where F^(alpha) is 0, F^(above) is its jump.
        held = (newton(above) - newton(alpha)).subs(numbers)
        true = -2 * (MU[belt] * FN / m).subs(numbers)
        return (
            rf"({PAPER_EXITS[belt]}) lets a stick on belt {belt} end by $F^{{({above})}} = 0$ only. "
            rf"{words} at the time below by $F^{{({alpha})}} = 0$, into $\Omega_{alpha}$,",
            decimal("t", slip_time, 20, label=f"{scene}-slip"),
            r"where the acceleration of the paper's condition is still",
            equation(F(above), held, true, f"{scene}-held", decimals=True),
        )

    yield (
        r"\subsection{The missing ends of sticks, (52) and (53)}",
        ends("fig5", 1, 1, "With the numbers of Fig.~5 the first one ends"),
        ends("fig6", 2, 2, "In Fig.~6 the mass leaves belt 2"),
    )
    # Of a scene such as fig7-corrected only the section on its figure.
    sections = {"fig7": _figure7, "fig8": _figure8}
    if scope.scene:
        figure_name, _, _ = scope.scene.name.partition("-")
        sections = {name: section for name, section in sections.items() if name == figure_name}
    yield [section() for section in sections.values()]
    rows = []
    for figure, word, printed in ((9, "P32", "0.1324, 4.5447"), (10, "P4645", "0.4588, 3.0837")):
        parameters = load_scene(f"fig{figure}").parameters
        place, phase = orbit_points(parameters, word)[0]
        time = phase * parameters.Omega.denominator / parameters.Omega.numerator
        cells = decimal("t_1", time, 10), decimal("x_1", place, 10)
        rows.append((f"Fig.~{figure}", f"$P_{{{word[1:]}}}$", f"${printed}$", *cells))
    yield (
        r"\subsection{Figs.~9 and 10: the starts}",
        Table(
            "tab:errata-starts",
            r"The printed starts of Figs.~9 and 10, and the switching points of the periodic "
            r"motions, to which the motions from the printed starts tend "
            r"(Theorem~\ref{thm:orbits-unique}).",
            ("figure", "orbit", "printed $t_0$, $x_0$", "$t_1$", "$x_1$"),
            tuple(rows),
        ),
    )


def _up_to_slip(scene: str, digits: int, target: str) -> list[Any]:
    """Simulate a scene with `digits` digits.

    Return the event times up to its first slip, which must enter `target`.
    """
    events = simulate(load_scene(scene), digits=digits, max_events=6).events
    slip = next(n for n, event in enumerate(events) if event.kind == "slip")
    if events[slip].target != target:
        raise StepError(scene, f"the mass slips into {events[slip].target}")
    return [event.t for event in events[: slip + 1]]


def _graze(scene: str, alpha: int, speed: Any, time: Any) -> tuple[Any, Any, Any]:
    """Return x of the graze at `time`, and x, v at t0 = 2.5 on the flight in domain `alpha` that
    ends in this graze.

    `speed` is the speed of the grazed belt.
    """
    scope = Scope(load_scene(scene))
    numbers = scope.numbers
    force = solution.in_paper_letters(solution.acceleration()).subs(
        solution.A, solution.force_constant(alpha)
    )
    place = sp.solve(force.subs({v: speed, t: time}).subs(numbers), x)[0]
    flow = solution.flow(scope.regimes[0])
    at_graze = {
        solution.x_i: place,
        solution.v_i: speed,
        solution.a_i: 0,
        solution.tau: sp.Rational(5, 2) - time,
    }
    at_graze |= {solution.theta_i: (Omega * time).subs(numbers)}
    start = (expr.subs(scope.display).subs(at_graze) for expr in (flow.x, flow.v))
    return place, *(sp.N(coordinate, 60)._to_mpmath(200) for coordinate in start)


def _start(x0: Any, v0: Any, label: str) -> list[Step]:
    """Return two steps that print x_0 and v_0 of a start.

    They get `label`, and `label` with v0 instead of x0.
    """
    return [
        decimal("x_0", x0, 10, label=label),
        decimal(r"\dot{x}_0", v0, 10, label=label.replace("x0", "v0")),
    ]


def _start_of(scene: str) -> list[Step]:
    """Return the steps on the printed x_0 and v_0 of a scene."""
    start = load_scene(scene)
    printed = (("x_0", start.x0), (r"\dot{x}_0", start.v0))
    return [equation(named(name), rational(z), rational(z), decimals=True) for name, z in printed]


def _printed_start(scene: str) -> str:
    """Return the printed (x_0, v_0) of a scene as LaTeX, with four decimals."""
    place, speed = (f"{float(step.right):.4f}" for step in _start_of(scene))
    return f"$({place}, {speed})$"


def _four_decimals(printed: str, value: Any) -> Step:
    """Return the step that checks a number, which the paper prints with four decimals, against its
    exact value.
    """
    return equation(named("z"), sp.Rational(printed), close(lambda: value, 4), decimals=True)


def _figure7() -> Items:
    """Return the section on the misprinted number of Fig. 7, which is x0 or A0."""
    numbers = Scope(load_scene("fig7")).numbers
    amplitude = ((B0 * Omega) ** 2 / ((k - m * Omega**2) ** 2 + c**2 * Omega**2)).subs(numbers)
    square = named(r"V_0^2")
    place, x0, v0 = _graze("fig7", 1, sp.Integer(5), sp.pi)
    # The same with A0 = 10.
    corrected, x0_of_10, v0_of_10 = _graze("fig7-corrected", 1, sp.Integer(5), sp.pi)
    return (
        r"\subsection{Fig.~7: one number is misprinted}",
        r"With the printed parameters the steady velocity in $\Omega_1$ does not reach $v_1 = 5$, "
        r"whatever $A_0$ is: by \eqref{eq:events-V0} its amplitude has",
        equation(square, 20, amplitude, "V0"),
        step(square, "<", 25, sign({square: amplitude})),
        r"so a graze can only be in the transient. The flow that touches $v_1$ at $t = \pi$, "
        r"traced back to the printed $t_0 = 2.5$, starts with the printed $A_0 = 5$ at",
        _start(x0, v0, "fig7-x0"),
        rf"The printed start is {_printed_start('fig7')}: with a misprint in $x_0$, which would "
        r"be $-5.6049$, all other numbers are right, and the contact is at $x_m = -3.0855$.",
        facts(
            *_start_of("fig7"),
            _four_decimals("-5.6049", x0),
            _four_decimals("1.3369", v0),
            equation(named("x_m"), sp.Rational("-3.0855"), place, decimals=True),
        ),
        r"With $A_0 = 10$ in place of 5 the start is",
        _start(x0_of_10, v0_of_10, "fig7-x0-10"),
        r"which is the printed one to all of its digits, with the contact at $x_m = -0.5855$. "
        r"Either number explains the figure; the numbers alone do not tell which one is misprinted.",
        facts(equation(named("x_m"), sp.Rational("-0.5855"), corrected, decimals=True)),
    )


def _figure8() -> Items:
    """Return the section on the start of Fig. 8, from whose printed digits the mass sticks shortly."""
    _, x0, v0 = _graze("fig8", 2, sp.Integer(-4), sp.Rational("3.14158"))

    def duration() -> dict[Any, Any]:
        onset, end = _up_to_slip("fig8", 30, "Omega2")
        return {named("t"): sp.Float(str(end - onset), 30)}

    short = step(named("t"), "<", sp.Rational(3, 1000), at_root(duration))
    return (
        r"\subsection{Fig.~8: no error, but four decimals do not graze}",
        r"The starts at $t_0 = 2.5$ from which the flow grazes form a curve, with one point for "
        r"each time $t_m$ of the contact. The point for $t_m = 3.14158$,",
        _start(x0, v0, "fig8-x0"),
        rf"rounds to the printed start {_printed_start('fig8')}, so the print is right. From the "
        r"rounded numbers the "
        rf"velocity "
        r"goes beyond $v_1$, and the mass sticks for some milliseconds instead of grazing.",
        facts(*_start_of("fig8"), _four_decimals("5.898", x0), _four_decimals("2.258", v0), short),
    )
