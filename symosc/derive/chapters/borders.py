"""Borders between words: what vanishes, the names of the literature, and why an atlas of words is
complete.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import sympy as sp

from symosc.derive.chapters.exponents import lengths
from symosc.derive.chapters.motion import MU, newton
from symosc.derive.scope import BELTS, LOWER, UPPER, F, G, Scope, mu_lambda, stated, v_lambda
from symosc.derive.steps import (
    CONTEXT,
    Check,
    Items,
    Table,
    at_root,
    cases,
    decimal,
    equation,
    exact,
    number,
    sign,
    step,
)
from symosc.model import Parameters
from symosc.orbits.branch import Branch, continue_orbit
from symosc.reference.cases import wall
from symosc.scenes import load_scene
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, FN, A, Omega, c, k, m, t, theta

TITLE = "Borders between words"
RATE = named(r"\dot{F}^{(\alpha)}")
NAMES = ("grazing-sliding", "crossing-sliding", "switching-sliding", "adding-sliding")


def items(scope: Scope) -> Items:
    """Yield the chapter: the four kinds of border between words, examples, and why an atlas is
    complete.
    """
    jump = -2 * mu_lambda * FN / m
    on_belt = solution.in_paper_letters(solution.acceleration(solution.x_i, v_lambda)).subs(
        Omega * t, theta
    )
    first = solution.in_paper_letters(solution.g_function(1)).subs(
        {Omega * t: theta, solution.v: v_lambda}
    )
    moving = solution.in_paper_letters(
        solution.acceleration(solution.x_i + v_lambda * t, v_lambda, Omega * t)
    )
    rate = moving.diff(t).subs(Omega * t, theta)
    same = {G(1): first.subs(solution.x, solution.x_i), F(r"\alpha"): on_belt, RATE: rate}
    touched = named(r"\sin\theta_m")
    place = named("x_m")
    still = {touched: sp.solve(rate.subs(sp.sin(theta), touched), touched)[0]}
    position = sp.solve(on_belt, solution.x_i)[0].subs(theta, named(r"\theta_m"))
    # The letters of a belt with friction.
    yield (
        r"\subsection{What a border is}",
        r"\begin{definition}[border]\label{thm:borders-border} Consider a periodic motion with the "
        r"period of the drive, one that is no rest. Its \emph{word} is the sequence of its "
        r"mappings, which is finite by Theorem~\ref{thm:accumulation-finite}. A \emph{border} is a "
        r"set of parameters for which it is not regular "
        r"(Definition~\ref{thm:jacobians-regular}).\end{definition}",
        r"On a border the equations of a word still hold, and one of these inequalities has become "
        r"an equality: in a plane of two parameters this is a curve. Four cases are possible "
        r"(Table~\ref{tab:borders-names}). Their names are those of "
        r"\cite{dibernardo2002,dibernardo2008,kowalczyk2008}; sliding is what is called sticking "
        r"here. Let $F^{(\alpha)}$ be what vanishes.",
        r"\begin{theorem}[four borders]\label{thm:borders-names} Let $\mu_\lambda F_N > 0$. If "
        r"$F^{(\lambda)} = 0$ at a contact with belt $\lambda$, then",
        equation(F(UPPER), jump, _across_each_belt(UPPER, 1), "other"),
        r"and if $F^{(\lambda+1)} = 0$ then",
        equation(F(LOWER), -jump, _across_each_belt(LOWER, -1)),
        step(
            2 * sp.Symbol(r"\mu_\lambda", positive=True) * sp.Symbol("F_N", positive=True) / m,
            ">",
            0,
            sign(),
        ),
        r"so the acceleration of the other side always pushes towards the belt. Along the flow of "
        r"$\Omega_\alpha$ and along the belt $F^{(\alpha)}$ has the same rate there,",
        equation(G(1), RATE - c * F(r"\alpha") / m, same, "rate"),
        r"and the sign of this rate, $-(\gamma + a\sin\theta)$ with the letters of "
        r"Lemma~\ref{thm:grazing-contact}, decides:\begin{enumerate}\item[(i)] A flight touches a "
        r"belt on its way: it grazes the boundary of the part of the belt that holds the mass. "
        r"Beyond the border it sticks there (\emph{grazing-sliding}).\item[(ii)] A passage into "
        r"$\Omega_\alpha$ has $F^{(\alpha)} = 0$, and the rate takes $F^{(\alpha)}$ to the side "
        r"that lets the mass go: beyond the border there is a short stick "
        r"(\emph{crossing-sliding}).\item[(iii)] A passage into $\Omega_\alpha$ has $F^{(\alpha)} "
        r"= 0$, and the rate takes it to the side that holds: on one side of the border the mass "
        r"sticks at once, on the other after a short flight (\emph{switching-sliding}).\item[(iv)] "
        r"During a stick $F^{(\alpha)}$ reaches 0 and returns: beyond the border a slip divides "
        r"the stick in two (\emph{adding-sliding} or \emph{multisliding}). Phase and place are "
        r"then known beforehand, for $B_0 \ne 0$:",
        equation(touched, -k * v_lambda / (B0 * Omega), still, "phase"),
        equation(
            place, (A + B0 * sp.cos(named(r"\theta_m")) - c * v_lambda) / k, position, "place"
        ),
        r"\end{enumerate}\end{theorem}",
        r"\begin{proof} \eqref{eq:borders-other} is Lemma~\ref{thm:motion-jump}; so no flight that "
        r"touches a belt may pass it, and close to a touch both sides hold the mass. "
        r"\eqref{eq:borders-rate} are \eqref{eq:switching-g1} and \eqref{eq:sticks-rate}, and its "
        r"last term vanishes. What follows a contact with a small $F^{(\alpha)}$ of either sign is "
        r"Theorem~\ref{thm:switching-cases}, and how long it lasts \eqref{eq:exponents-graze} to "
        r"\eqref{eq:exponents-interrupted-slip}. In (iv) both $F^{(\alpha)}$ and its rate vanish, "
        r"which fixes the phase by \eqref{eq:sticks-rate} and the place by "
        r"\eqref{eq:motion-acceleration}.\end{proof}",
        _names_table(),
        r"If $\mu_\lambda F_N = 0$ there is no belt, and (i) is no border of motions. Where the "
        r"mass may rest on a belt at rest (Theorem~\ref{thm:orbits-unique}) there is no word; the "
        r"border of that region is $|B_0| = \mu_\lambda F_N$, and is known beforehand.",
        _examples_table(),
        r"Motions that are their own mirror image have their contacts in pairs. Then two "
        r"inequalities become equalities at once on a border; it is no point of codimension two.",
        r"\subsection{Points of codimension two}",
        r"Where two of the four conditions hold at different contacts, two borders cross. Where "
        r"they hold at one contact, borders end or change their name: crossing-sliding becomes "
        r"switching-sliding where $F^{(\alpha)} = 0$ and its rate vanish together. For a belt at "
        r"rest, $v_\lambda = 0$, that is at",
        equation(touched, 0, {touched: still[touched].subs(v_lambda, 0)}, "rest"),
        r"so the mass turns when the drive is largest in size. For $c = 0$ these points are known "
        r"in closed form (Proposition~\ref{thm:undamped-points}). Chapter~\ref{sec:codimension} "
        r"lists all such points and what surrounds them, and Chapter~\ref{sec:corrections} has the "
        r"maps and the multipliers at a border.",
    )
    yield (
        r"\subsection{Why an atlas is complete}",
        r"An \emph{atlas} is a connected region of a plane of two parameters with its borders "
        r"drawn and a word named in each part between them.",
        r"\begin{theorem}[atlas]\label{thm:borders-atlas} Let $c > 0$ and $k > 0$ in the region, "
        r"and let no belt at rest have $|B_0| \le \mu_\lambda F_N$ "
        r"there.\begin{enumerate}\item[(i)] For each point there is one periodic motion, it "
        r"attracts all others, and it depends continuously on the parameters, across borders "
        r"too.\item[(ii)] Between the borders the word is constant: one motion per part decides "
        r"it, wherever it starts. The atlas is complete if all borders are drawn.\item[(iii)] "
        r"Where a periodic motion of a word is proven to be regular for all parameters of a box, "
        r"the box meets no border, and the word is that of the motion that settles at each of its "
        r"points.\end{enumerate}\end{theorem}",
        r"\begin{proof} (i) Existence, uniqueness and attraction are "
        r"Theorem~\ref{thm:orbits-unique}. Let parameters $p_n$ tend to $p$, with the periodic "
        r"motions $x_n$. These are bounded together with their first two derivatives, uniformly in "
        r"$n$, because the ball in the proof of that theorem depends continuously on the "
        r"parameters. So a part of them converges with the velocities, to a motion of $p$ since "
        r"the right side of \eqref{eq:motion-newton} is closed and convex. The limit is periodic, "
        r"hence the only periodic motion of $p$, and as every part has a part with this limit all "
        r"$x_n$ tend to it. (ii) If the motion of $p$ is regular, each event is a simple zero of a "
        r"smooth function of the state before it, and all other inequalities are strict. By the "
        r"implicit function theorem motions that start nearby, with nearby parameters, have the "
        r"same events over a period, and by (i) the periodic one does start nearby. So the word is "
        r"constant near $p$, and on each connected part without borders. (iii) By "
        r"Theorem~\ref{thm:orbits-unique} the proven motion is the one that attracts.\end{proof}",
        r"What is left to chance is a border that nobody has met, such as a small closed curve "
        r"inside a part. Boxes that are proven by (iii) exclude it; what they do not cover has to "
        r"be given as an area. For $c = 0$ the theorem does not hold: several motions may exist "
        r"(Corollary~\ref{thm:undamped-survives}).",
    )


def _across_each_belt(side: str, sign: int) -> Check:
    """Return the check of the acceleration on one side of each belt if the other side's is 0.

    `side` is LOWER or UPPER, and `sign` is 1 if that one is above the belt, -1 if it is below.
    """
    # By Newton's law in both domains: the difference does not depend on the state.
    differences = {belt: newton(belt + 1) - newton(belt) for belt in BELTS}
    return cases(
        *(exact({F(side): sign * gap, mu_lambda: MU[belt]}) for belt, gap in differences.items())
    )


def _names_table() -> Table:
    """Return the table of the four kinds of border: what is 0 there, and what a branch's end is
    called.
    """
    grazing, crossing, switching, adding = NAMES
    # What ends of branches with the shorter and with the longer word are called.
    graze = "grazing", "grazing, or vanishing of a stick"
    stick = "birth of a stick", "vanishing of a stick"
    slip_born, slip_vanishes = "birth of a slip", "vanishing of a slip"
    steps = lengths()
    divided = steps["interrupted-slip"]
    sliding = replace(divided, right=divided.right.subs(steps["graze"].left, steps["graze"].right))
    rows = (
        (grazing, r"$\dot{x} = v_\lambda$ in a flight", steps["graze"], *graze),
        (crossing, r"$F^{(\alpha)} = 0$ at a passage", steps["stick"], *stick),
        (switching, r"$F^{(\alpha)} = 0$ at an onset", steps["slip-short"], slip_born, "grazing"),
        (adding, r"$F^{(\alpha)} = 0$ in a stick", sliding, slip_born, slip_vanishes),
    )
    return Table(
        "tab:borders-names",
        r"The four borders: what becomes 0; how long what is born lasts, to leading order, at a "
        r"distance $\epsilon$ from the border, by \eqref{eq:exponents-graze} to "
        r"\eqref{eq:exponents-interrupted-slip}; and how this package names the end of a branch "
        r"there, on the side of the shorter and of the longer word.",
        ("name", "what", "length", "shorter word", "longer word"),
        rows,
    )


#: Below this a rate counts as 0: it is known from the end of a branch in doubles.
LEAST = sp.Rational(1, 10**4)
_WALL = wall("0.4", "0.4", "0.1")


class BranchExample(NamedTuple):
    """A branch one end of which is on a border.

    It is followed no farther than to that end, and once if both of its ends are examples.
    """

    place: str  # as the table says it
    parameters: Parameters
    word: str
    name: str  # the parameter along the branch
    limits: tuple[str, str]
    end: int  # the end of the branch: 0 or 1
    belt: int
    border: str
    negative: bool  # whether the rate is negative there, else it is 0


FIG9 = load_scene("fig9").parameters
FIG10 = load_scene("fig10").parameters
_grazing, _crossing, _switching, _adding = NAMES
EXAMPLES = (
    BranchExample(
        "Fig.~9", FIG9, "P32", "Omega", ("3", "6"), end=1, belt=2, border=_grazing, negative=True
    ),
    BranchExample(
        "Fig.~9", FIG9, "P32", "Omega", ("3", "6"), end=0, belt=1, border=_crossing, negative=True
    ),
    BranchExample(
        "at a wall",
        _WALL,
        "P1312",
        "mu1",
        ("0.1", "0.4"),
        end=0,
        belt=1,
        border=_switching,
        negative=True,
    ),
    BranchExample(
        "Fig.~10",
        FIG10.replace(Omega="0.7"),
        "P4645",
        "Omega",
        ("0.6", "0.7"),
        end=0,
        belt=2,
        border=_adding,
        negative=False,
    ),
)


@cache
def branch(p: Parameters, word: str, name: str, limits: tuple[str, str]) -> Branch:
    """Return the branch of an orbit; two examples and another chapter speak of the same one."""
    return continue_orbit(p, word, name, limits)


def _examples_table() -> Table:
    """Return the table of examples: ends of branches, and the rate of change of the vanishing
    acceleration there.
    """
    rows = []
    signs = []
    for example in EXAMPLES:
        p = example.parameters
        end = branch(p, example.word, example.name, example.limits).ends[example.end]
        at_end = p.replace(**{example.name: end.value})
        letter = {"Omega": r"\Omega", "mu1": r"\mu_1"}[example.name]
        phase = number(at_end.Omega) * number(end.conditions[0].t)
        # m dF/dt on the belt is -(k v_lambda + B0 Omega sin theta).
        steady_rate = number(at_end.k * at_end.belt(example.belt))
        drive_rate = number(at_end.B0 * at_end.Omega) * CONTEXT.sin(phase)
        rate = sp.Float(CONTEXT.nstr(-(steady_rate + drive_rate) / number(at_end.m), 20), 20)
        if example.negative:
            signs.append(step(rate, "<", 0, at_root(dict)))
        else:
            signs.append(step(sp.Abs(rate), "<", LEAST, at_root(dict)))
        rows.append(
            (
                example.border,
                f"$P_{{{example.word[1:]}}}$, {example.place}",
                f"${letter}$",
                decimal("z", end.value, 7),
                end.kind,
                decimal("z", rate, 3),
            )
        )
    text, numbers = stated(_WALL, "m", "k", "B0", "FN", "c", "Omega", "v1", "mu2")
    return Table(
        "tab:borders-examples",
        r"An example of each: ends of branches in one parameter, and the rate there, with belt 2 "
        r"in Fig.~9 (the graze) "
        rf"and in Fig.~10, else belt 1. The wall: {text}. In the second line the mass passes "
        r"downwards, so that a "
        rf"negative rate lets it go.",
        ("border", "branch", "", "at", "the package says", "rate"),
        tuple(rows),
        (*signs, *numbers),
        columns="lllrlr",
    )
