"""Theorem 7: eqs. (55) to (58) with every case, the contact's place, and the tangency of fourth order."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import sympy as sp

from symosc.derive.blocks import Illustration, Table, block, proof
from symosc.derive.latex import named
from symosc.derive.scope import BELTS, G, Scope, v_lambda
from symosc.derive.steps import Exact, Heading, Prose, Relation, Step, equation, fact
from symosc.derive.window_check import Window, a, g, p, q
from symosc.mappings.theorem7_cases import PLACES, Place
from symosc.scenes import load_scene
from symosc.symbolic import solution, theorem7
from symosc.symbolic.solution import B0, A, Omega, c, k, m, t, theta, v, x

TITLE = "Grazing: Theorem 7 with all cases"
THETA_M, CRITICAL = named(r"\theta_m"), named(r"\Theta^{\mathrm{cr}}")
GAMMA = named(r"\gamma")


#: The signs of gamma and |gamma| - a, values that have them, and the case in words (a > 0).
SHAPES = (
    (1, -1, p, p + q, r"$0 < \gamma < a$"),
    (1, 0, p, p, r"$0 < \gamma = a$"),
    (1, 1, p + q, p, r"$0 < a < \gamma$"),
    (0, -1, sp.Integer(0), p, r"$\gamma = 0$"),
    (-1, -1, -p, p + q, r"$-a < \gamma < 0$"),
    (-1, 0, -p, p, r"$\gamma = -a$"),
    (-1, 1, -p - q, p, r"$\gamma < -a$"),
)
CASES_WITHOUT_DRIVE = ((p, r"$a = 0 < \gamma$"), (-p, r"$\gamma < 0 = a$"), (sp.Integer(0), r"$a = \gamma = 0$"))


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _contact()
    yield from _what_it_fixes()
    yield from _theorem()
    if scope.scene is not None:
        for mapping, place in PLACES.items():
            if place.boundary in scope.boundaries:
                yield from _numbers(scope, mapping, place)
    yield from _equality()
    yield from _no_spring()


def _contact() -> Iterator[Any]:
    yield Heading("What a contact fixes")
    yield from block(
        "definition",
        r"Let the flow of $\Omega_\alpha$ come to the boundary $\dot{x} = v_\lambda$ at the time $t_m$, at "
        r"the position "
        r"$x_m$ and the phase $\theta_m = \Omega t_m$ modulo $2\pi$, with $F^{(\alpha)} = 0$. It \emph{grazes} if it "
        r"stays in $\Omega_\alpha$ right before and right after $t_m$. It \emph{grazes to first order} if "
        r"$\sigma G^{(1,\alpha)} < 0$, with $\sigma = 1$ for a boundary above the domain and $\sigma = -1$ for one "
        r"below. Table~\ref{tab:grazing-places} has the four places; the paper names each by a mapping.",
        title="graze",
        label="thm:grazing-graze",
    )
    rows = []
    for mapping, place in PLACES.items():
        relation = "<" if place.side > 0 else ">"
        sine = ">" if place.side > 0 else "<"
        rows.append(
            (
                f"$P_{mapping[1]}$",
                place.domain,
                place.boundary,
                f"${place.side}$",
                rf"$G^{{(1,{place.domain})}} {relation} 0$",
                rf"$a \sin\theta_m {sine} -\gamma$",
                f"({place.equation})",
            )
        )
    yield Table(
        "tab:grazing-places",
        r"Where a flow can graze: domain, boundary and side, and when it does to first order.",
        ("mapping", r"$\alpha$", r"$\lambda$", r"$\sigma$", "grazes iff", "that is", "paper"),
        tuple(rows),
    )


def _what_it_fixes() -> Iterator[Any]:
    acceleration, rate = named(r"\ddot{x}"), named(r"\dot{x}_m")
    general = (c * acceleration + k * rate) / m
    at_contact = general.subs({acceleration: 0, rate: v_lambda})
    force = solution.in_paper_letters(solution.acceleration()).subs({v: v_lambda, Omega * t: theta})
    solved = sp.solve(force, x)[0].subs(theta, THETA_M)
    first = solution.in_paper_letters(solution.g_function(1).subs(v, v_lambda)).subs(Omega * t, THETA_M)
    letter = sp.Symbol("a", real=True)
    yield from block(
        "lemma",
        equation(
            GAMMA,
            k * v_lambda / m,
            r"At such a contact the paper's $\gamma = (c/m)\ddot{x} + (k/m)\dot{x}$ is fixed by the parameters, and "
            r"with the amplitude $a$,",
            Exact({GAMMA: at_contact}),
            label="grazing-gamma",
        ),
        equation(letter, B0 * Omega / m, "", Exact({letter: B0 * Omega / m}), label="grazing-a"),
        equation(
            G(1),
            -(GAMMA + letter * sp.sin(THETA_M)),
            r"the first G-function depends on the phase alone:",
            Exact({G(1): first.subs(x, solved), GAMMA: k * v_lambda / m, letter: B0 * Omega / m}, sp.simplify),
            label="grazing-G1",
        ),
        equation(
            named("x_m"),
            (A + B0 * sp.cos(THETA_M) - c * v_lambda) / k,
            r"For $k > 0$ the phase gives the position,",
            Exact({named("x_m"): solved}),
            label="grazing-xm",
        ),
        equation(
            sp.sin(CRITICAL),
            -GAMMA / letter,
            r"and if $|\gamma| \le |a| \ne 0$, $G^{(1,\alpha)}$ vanishes at the phases "
            r"$\Theta^{\mathrm{cr}} = \arcsin(-\gamma/a)$ and $\pi - \Theta^{\mathrm{cr}}$, where",
            Exact({CRITICAL: sp.asin(-k * v_lambda / (B0 * Omega)), GAMMA: k * v_lambda / m, letter: B0 * Omega / m}),
            label="grazing-critical",
        ),
        title="what a contact fixes",
        label="thm:grazing-contact",
    )
    yield from proof(
        r"$\ddot{x} = F^{(\alpha)} = 0$ and $\dot{x} = v_\lambda$ at $t_m$. Put both into \eqref{eq:switching-g1} and "
        r"\eqref{eq:motion-acceleration}. So of the paper's ``four unknowns'' with three equations only the phase is "
        r"free, and $\gamma$ does not vary along the family of contacts: the case of the theorem is decided by the "
        r"parameters."
    )


def _theorem() -> Iterator[Any]:
    yield Heading("The theorem")
    yield from block(
        "theorem",
        r"Let $m, \Omega > 0$ and $c, k \ge 0$, let $P_j$ be one of $P_2$, $P_3$, $P_5$, $P_6$ with "
        r"$(\alpha, \lambda, \sigma)$ from Table~\ref{tab:grazing-places}, and let the flow of $\Omega_\alpha$ have "
        r"$\dot{x} = v_\lambda$ and $F^{(\alpha)} = 0$ at $t_m$. With $\gamma$, $a$ and $\Theta^{\mathrm{cr}}$ as in "
        r"Lemma~\ref{thm:grazing-contact} and $a \ge 0$, it grazes to first order iff $\theta_m \in [0, 2\pi)$ is in "
        r"the set of Table~\ref{tab:grazing-windows}. For $a < 0$ the sets are those of $-a$, moved by $\pi$ modulo "
        r"$2\pi$.",
        title="the paper's Theorem 7, (55) to (58), completed",
        label="thm:grazing-theorem7",
    )
    yield windows_table()
    turned = named(r"\sin(\theta_m + \pi)")
    yield from proof(
        r"By \eqref{eq:grazing-G1}, $\sigma G^{(1,\alpha)} < 0$ is $\sigma(\gamma + a\sin\theta_m) > 0$. For $a > 0$ "
        r"this is $\sin\theta_m > -\gamma/a$ for $\sigma = 1$ and $\sin\theta_m < -\gamma/a$ for $\sigma = -1$. The "
        r"sine takes the value $-\gamma/a$ twice on the circle if $|\gamma| < a$, at $\Theta^{\mathrm{cr}}$ and "
        r"$\pi - \Theta^{\mathrm{cr}}$; once if $|\gamma| = a$, at $3\pi/2$ or $\pi/2$; and not at all if "
        r"$|\gamma| > a$. On each arc between these points the sign is the same, and it is decided at one of $0$, "
        r"$\pi/2$, $\pi$, $3\pi/2$. For $\gamma > 0$ the angle $\Theta^{\mathrm{cr}}$ is negative: "
        r"$2\pi + \Theta^{\mathrm{cr}} = 2\pi - |\Theta^{\mathrm{cr}}|$ and $\pi - \Theta^{\mathrm{cr}} = "
        r"\pi + |\Theta^{\mathrm{cr}}|$, which is how the paper writes the ends. Where the paper writes a closed end "
        r"$2\pi]$, it is the phase 0. For $a = 0$ the condition is $\sigma\gamma > 0$, at every phase or at none. For "
        r"$a < 0$, $a\sin\theta_m = (-a)\sin(\theta_m + \pi)$, by",
        equation(
            turned,
            -sp.sin(THETA_M),
            "",
            Exact({turned: sp.sin(THETA_M + sp.pi)}, sp.simplify),
            label="grazing-turned",
        ),
    )
    yield Prose(
        r"That the flow comes from $\Omega_\alpha$ is no further condition: by "
        r"Lemma~\ref{thm:switching-side} the first "
        r"G-function that does not vanish fixes the side before the contact too, and for odd order it is the side "
        r"after it. With $F^{(\alpha)} = 0$ and $\sigma G^{(1,\alpha)} > 0$ the flow would come from the other side of "
        r"the boundary, where it is not the motion."
    )
    yield Illustration(
        "windows",
        "fig:grazing-windows",
        r"The case $0 < \gamma < a$ with $\gamma/a = 1/2$: where $\sin\theta$ is above its critical value $P_2$ and "
        r"$P_5$ graze (grey), where it is below $P_3$ and $P_6$ do (hatched).",
        0.95,
    )


def windows_table(label: str = "tab:grazing-windows") -> Table:
    """Return the table of Theorem 7's windows, each of them checked."""
    return Table(
        label,
        r"Theorem~7: the phases $\theta_m$ at which a contact grazes to first order. The paper has neither the case "
        r"$\gamma = -a$ of $P_2$ and $P_5$ nor those with $a = 0$; in the last one the flow stays in the boundary.",
        ("", r"$P_2$, $P_5$ ($\sigma = 1$)", r"$P_3$, $P_6$ ($\sigma = -1$)"),
        _windows(),
    )


@cache
def _windows() -> tuple[tuple[Any, ...], ...]:
    """Return the rows: the case in words, and its windows for the boundary above the domain and below it."""
    sides = {1: PLACES["P2"], -1: PLACES["P3"]}
    rows = []
    for _, _, gamma, amplitude, words in SHAPES:
        rows.append((words, *(window(sides[side], gamma, amplitude) for side in (1, -1))))
    for gamma, words in CASES_WITHOUT_DRIVE:
        rows.append((words, *(window(sides[side], gamma, sp.Integer(0)) for side in (1, -1))))
    return tuple(rows)


def window(place: Place, gamma: Any, amplitude: Any) -> Step:
    """Return the window of a case as a step."""
    case = next(row for row in theorem7.all_cases(place, False) if _holds(row.condition, gamma, amplitude))
    check = Window(place.side, gamma, amplitude, ((CRITICAL, sp.asin(-g / a)),))
    return Step(Relation(THETA_M, "in", _with_name(case.phases)), "", check)


def _holds(condition: Any, gamma: Any, amplitude: Any) -> bool:
    return bool(sp.simplify(condition.subs({g: gamma, a: amplitude}, simultaneous=True)) == sp.true)


def _with_name(phases: Any) -> Any:
    """Write Theta_cr for asin(-gamma/a) in the ends of a set."""
    if isinstance(phases, sp.Union):
        return sp.Union(*(_with_name(part) for part in phases.args), evaluate=False)
    if not isinstance(phases, sp.Interval):
        return phases
    low, high, *open_ends = phases.args
    names = {sp.asin(g / a): -CRITICAL}
    return sp.Basic.__new__(sp.Interval, low.subs(names), high.subs(names), *open_ends)


def _numbers(scope: Scope, mapping: str, place: Place) -> Iterator[Any]:
    """Yield the window of a scene, with its numbers."""
    number = mapping[1]
    gamma = (k * BELTS[place.boundary] / m).subs(scope.numbers)
    amplitude = (B0 * Omega / m).subs(scope.numbers)
    yield Heading(rf"The window of $P_{number}$ with the numbers of the scene")
    for letter, value, formula in (
        (GAMMA, gamma, k * BELTS[place.boundary] / m),
        (named("a"), amplitude, B0 * Omega / m),
    ):
        reason = "The numbers to compare are" if letter is GAMMA else ""
        yield equation(letter, value, reason, Exact({letter: formula.subs(scope.numbers)}))
    phases = theorem7.window_phases(place, gamma, amplitude, False)
    reason = r"and the flow grazes to first order at the phases"
    yield Step(Relation(THETA_M, "in", phases), reason, Window(place.side, gamma, amplitude))


def _equality() -> Iterator[Any]:
    yield Heading(r"The ends of a window, and the case of equality")
    second, third = G(2), G(3)
    contact = {v: v_lambda, x: (solution.A_m + solution.f0 * sp.cos(theta) - solution.cm * v_lambda) / solution.w0sq}
    g1, g2, g3 = (sp.expand(solution.g_function(n).subs(contact)) for n in (1, 2, 3))
    on_end = {v_lambda: -solution.f0 * Omega * sp.sin(theta) / solution.w0sq}
    assert sp.simplify(g1.subs(on_end)) == 0
    wave = {solution.f0: B0 / m, solution.w0sq: k / m, solution.cm: c / m, theta: THETA_M}
    letter = sp.Symbol("a", real=True)
    amplitude = {letter: B0 * Omega / m}
    true2, true3 = (expr.subs(on_end).xreplace(wave) for expr in (g2, g3))
    yield from block(
        "theorem",
        r"Let $F^{(\alpha)} = G^{(1,\alpha)} = 0$ at a contact, with $a \ne 0$; this needs $|\gamma| \le |a|$.",
        equation(
            second,
            -letter * Omega * sp.cos(THETA_M),
            r"The next G-functions are",
            Exact({second: true2} | amplitude, sp.simplify),
            label="grazing-G2",
        ),
        equation(
            third,
            letter * Omega**2 * sp.sin(THETA_M) - c * second / m,
            "",
            Exact({third: true3, second: true2} | amplitude, sp.simplify),
            label="grazing-G3",
        ),
        r"\begin{enumerate}"
        r"\item[(i)] If $|\gamma| < |a|$, then $G^{(2,\alpha)} \ne 0$: the flow of $\Omega_\alpha$ crosses "
        r"the boundary and does not graze. The windows are open at these ends in full order too."
        r"\item[(ii)] If $|\gamma| = |a|$, then $G^{(2,\alpha)} = 0$ and $G^{(3,\alpha)} = -\gamma\Omega^2 \ne 0$: the "
        r"flow touches to fourth order, and grazes iff $\sigma\gamma > 0$."
        r"\end{enumerate}"
        r"So in the rows $0 < \gamma = a$ for $P_2$ and $P_5$ and $\gamma = -a$ for $P_3$ and $P_6$ of "
        r"Table~\ref{tab:grazing-windows} the phase that is taken out, $3\pi/2$ or $\pi/2$, grazes as "
        r"well, and to full order these windows are the whole circle; all other rows stay as they are.",
        title="the case of equality",
        label="thm:grazing-equality",
    )
    yield from _equality_proof(true3)
    yield _equality_in_figures()


def _equality_proof(true3: Any) -> Iterator[Any]:
    """Yield the proof; `true3` is the third G-function at an end of a window."""
    third, letter = G(3), sp.Symbol("a", real=True)
    square = named(r"\gamma + a\sin\theta_m|_{\gamma = -a}")
    half = sp.sin(THETA_M / 2) - sp.cos(THETA_M / 2)
    value = {third: true3.subs(THETA_M, 3 * sp.pi / 2), GAMMA: B0 * Omega / m}
    other = {third: true3.subs(THETA_M, sp.pi / 2), GAMMA: -B0 * Omega / m}
    yield from proof(
        r"\eqref{eq:grazing-G2} and \eqref{eq:grazing-G3} are \eqref{eq:switching-g2} and \eqref{eq:switching-g3} with "
        r"$F^{(\alpha)} = G^{(1,\alpha)} = 0$. (i) There $|\sin\theta_m| = |\gamma/a| < 1$, so $\cos\theta_m \ne 0$, "
        r"and Lemma~\ref{thm:switching-side} applies with $n = 2$.",
        Prose(
            r"(ii) There $\sin\theta_m = -\gamma/a = \pm 1$ and $\cos\theta_m = 0$, so "
            r"$G^{(3,\alpha)} = a\Omega^2\sin\theta_m = -\gamma\Omega^2$, and the lemma applies with $n = 3$: the flow "
            r"stays in $\Omega_\alpha$ iff $\sigma G^{(3,\alpha)} < 0$.",
            (
                fact(third, "=", -GAMMA * Omega**2, Exact(value, sp.simplify)),
                fact(third, "=", -GAMMA * Omega**2, Exact(other, sp.simplify)),
            ),
        ),
        equation(
            square,
            -letter * half**2,
            r"In the other rows with $|\gamma| = a$ no phase grazes at all, for example in the row $\gamma = -a$ of "
            r"$P_2$ and $P_5$, which the paper lacks, where",
            Exact({square: -letter + letter * sp.sin(THETA_M)}, sp.simplify),
            label="grazing-square",
        ),
        r"is never positive.",
    )


def _equality_in_figures() -> Prose:
    at = {name: Scope(load_scene(name)).numbers for name in ("fig7", "fig8")}
    return Prose(
        r"The paper's Figs.~7 and 8 are both cases of equality: $\gamma = a = 10$ for $P_2$ in Fig.~7, and "
        r"$\gamma = -16$, $a = 16$ for $P_3$ in Fig.~8. The graze at $t_m = \pi$ is not at the excluded "
        r"phase in either of them.",
        (
            fact((k * BELTS[1] / m).subs(at["fig7"]), "=", (B0 * Omega / m).subs(at["fig7"]), Exact()),
            fact((k * BELTS[1] / m).subs(at["fig8"]), "=", -(B0 * Omega / m).subs(at["fig8"]), Exact()),
        ),
    )


def _no_spring() -> Iterator[Any]:
    yield Heading("No spring")
    phase = named(r"\cos\theta_m")
    plain = solution.in_paper_letters(solution.acceleration()).subs({v: v_lambda, Omega * t: THETA_M, k: 0})
    solved = sp.solve(plain.subs(sp.cos(THETA_M), phase), phase)[0]
    second = solution.in_paper_letters(solution.g_function(2)).subs({v: v_lambda, Omega * t: THETA_M, k: 0})
    curve = sp.expand(second.subs(A, sp.solve(plain, A)[0])).subs(sp.sin(THETA_M), 0)
    yield from block(
        "corollary",
        equation(
            phase,
            (c * v_lambda - A) / B0,
            r"Let $k = 0$ and $B_0 \ne 0$. Then $\gamma = 0$, and $F^{(\alpha)} = 0$ fixes the phase instead of the "
            r"position, which is free:",
            Exact({phase: solved}),
            label="grazing-no-spring",
        ),
        Prose(
            r"If the right side is below 1 in size, there is one such phase with $\sin\theta_m > 0$ and one with "
            r"$\sin\theta_m < 0$; for $B_0 > 0$ the first is the graze of $P_2$ and $P_5$, the second that of $P_3$ "
            r"and $P_6$, for $B_0 < 0$ the other way round. If it is $\pm 1$, then "
            r"$G^{(1,\alpha)} = 0 \ne G^{(2,\alpha)} = -a\Omega\cos\theta_m$, and nothing grazes; beyond that no "
            r"contact has $F^{(\alpha)} = 0$.",
            (fact(curve, "=", -B0 * Omega**2 * sp.cos(THETA_M) / m, Exact(tidy=sp.simplify)),),
        ),
        title="no spring",
        label="thm:grazing-no-spring",
    )
    yield from proof(
        r"This is Theorem~\ref{thm:grazing-theorem7} in the row $\gamma = 0$, and "
        r"Theorem~\ref{thm:grazing-equality} (i)."
    )
