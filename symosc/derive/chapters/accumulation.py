r"""Events do not accumulate: how many a motion can have in a given time, for all parameters."""

from __future__ import annotations

from itertools import pairwise
from math import floor
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.chapters.motion import MU, newton
from symosc.derive.scope import BELTS, Scope, v_lambda
from symosc.derive.steps import (
    CONTEXT,
    Check,
    Items,
    Step,
    Table,
    cases,
    equation,
    exact,
    facts,
    number,
    sign,
    step,
)
from symosc.model import Parameters
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, FN, Omega, c, cm, k, m, t, tau, theta, w0sq

TITLE = "Events do not accumulate"
RATE = named("r")
BELOW = named("U")
JUMP = named("J")
GAP = named("g")
GAP_RATE = named(r"\dot{g}")
GAMMA = named(r"\gamma")
LETTER_A = named("a")
#: Over how many periods of the drive the table counts events.
PERIODS = 40
SCENES = ("fig5", "fig6", "fig7", "fig8", "fig9", "fig10")


def items(scope: Scope) -> Items:
    """Yield the chapter: one flight, one belt, and how many events there can be in a given time."""
    yield _forces(scope)
    yield _one_flight()
    yield _one_belt()
    yield (
        r"\subsection{What follows}",
        r"\begin{theorem}[events do not accumulate]\label{thm:accumulation-finite} Let $m > 0$, $k "
        r"\ge 0$, $c \ge 0$, $\Omega > 0$ and $\mu_\lambda F_N \ge 0$, and let $A_0$, $B_0$ and "
        r"$v_1 < v_2$ be any numbers. Every motion has finitely many events in each bounded "
        r"interval of time: it consists of flights and sticks, one after the other.\end{theorem}",
        r"\begin{proof} Let $t^* \ge t_0$. Near $t^*$ the velocity stays away from the speed of "
        r"one belt at least, as $v_1 \ne v_2$. Let $\lambda$ be the other belt. On $[t^* - \delta, "
        r"t^*]$ and on $[t^*, t^* + \delta]$, for some $\delta > 0$, $r$ does not change its sign "
        r"by Lemma~\ref{thm:accumulation-forces}, and $\delta$ may be below $\pi/\omega_d$. So "
        r"there are at most three events in each by Theorem~\ref{thm:accumulation-three}. A "
        r"bounded interval is covered by finitely many such neighbourhoods.\end{proof}",
        *_bound(),
        r"For $c > 0$ and $k > 0$ the settled motion stays in a fixed ball "
        r"(Theorem~\ref{thm:orbits-unique}), so its events per period are bounded, uniformly on "
        r"each compact set of parameters with $v_1 < v_2$ and $\Omega > 0$: only finitely many "
        r"words occur there. Over all times events may be infinitely many, and sticks may become "
        r"shorter without end, as in the paper's Fig.~8. That is no accumulation, as they lie half "
        r"a period apart.",
        r"\begin{remark}[what rests on it]\label{thm:accumulation-used} That a word is a finite "
        r"sequence and each motion has one (Definition~\ref{thm:borders-border}); that the "
        r"monodromy matrix is a product of finitely many factors "
        r"(Theorem~\ref{thm:jacobians-monodromy}) and a perturbation can be followed from event to "
        r"event (Theorem~\ref{thm:exponents-events}); that a motion which is regular over one "
        r"period meets no border (Theorem~\ref{thm:borders-atlas}); and that a certificate, which "
        r"is a finite list of flights and sticks, can describe every regular motion "
        r"(Chapter~\ref{sec:certificates}). Backwards in time a motion is not unique "
        r"(Theorem~\ref{thm:motion-unique}), but the theorem counts the events of each "
        r"continuation.\end{remark}",
        _table(),
    )


def _forces(scope: Scope) -> Items:
    """Return the items of the lemma on the two forces near a belt."""
    moving = sp.Function("x")(t)
    path = solution.in_paper_letters(solution.acceleration(moving, v_lambda, Omega * t))
    speed = {moving.diff(t): v_lambda + GAP, Omega * t: theta}
    letters = {GAMMA: k * v_lambda / m, LETTER_A: B0 * Omega / m, GAP: solution.v - v_lambda}
    drive = -(GAMMA + LETTER_A * sp.sin(theta))
    gap = named(r"\dot{g}|_{\Omega_\lambda}")
    above = named(r"\dot{g}|_{\Omega_{\lambda+1}}")
    rate = named(r"\dot{U}")
    wave = -(GAMMA + LETTER_A * sp.sin(Omega * t))
    bend = named(r"\ddot{r}")
    yield (
        r"\subsection{Two forces and one rate}",
        r"A bouncing ball comes to rest after infinitely many bounces in a finite time, and then "
        r"the words, matrices and certificates of the other chapters would not exist. This chapter "
        r"shows that nothing like it happens here, for any parameters: no damping, no spring, no "
        r"friction and no drive included.",
        r"\begin{definition}[event]\label{thm:accumulation-event} An \emph{event} of a motion at "
        r"belt $\lambda$ is a time at which $\dot{x} = v_\lambda$, but not during some time before "
        r"and after it: a passage, the beginning or the end of a stick, or a touch.\end{definition}",
        r"\begin{lemma}[forces near a belt]\label{thm:accumulation-forces} Let $g = \dot{x} - "
        r"v_\lambda$, let $U$ be the acceleration $F^{(\lambda)}$ taken at the position and the "
        r"time of the motion, but at the speed of the belt, and $J = 2\mu_\lambda F_N/m \ge 0$. As "
        r"long as the motion does not meet the other belt,",
        equation(gap, BELOW - c / m * GAP, _at_belts(scope, gap, above), "below"),
        equation(above, BELOW - JUMP - c / m * GAP, _at_belts(scope, gap, above), "above"),
        r"and $0 \le U \le J$ during a stick, while at all times, with $\gamma$ and $a$ as in "
        r"Lemma~\ref{thm:events-gap},",
        equation(
            rate,
            RATE - k / m * GAP,
            {rate: path.diff(t).subs(speed), RATE: drive, **letters},
            "rate",
        ),
        equation(
            RATE,
            drive,
            {RATE: path.diff(t).subs({moving.diff(t): v_lambda, Omega * t: theta}), **letters},
            "r",
        ),
        r"If $r$ vanishes at all times, $\gamma = a = 0$. If not, its zeros are isolated, and of "
        r"the second order at most, as",
        equation(
            bend,
            -(Omega**2) * (RATE + GAMMA),
            {bend: wave.diff(t, 2).subs(Omega * t, theta), RATE: drive},
            "bend",
        ),
        r"\end{lemma}",
        r"\begin{proof} \eqref{eq:motion-acceleration}, and \eqref{eq:motion-jump} for the other "
        r"side. During a stick $F^{(\lambda)} = U \ge 0 \ge F^{(\lambda+1)} = U - J$ by "
        r"Proposition~\ref{thm:motion-held}. $U$ depends on $x$ and $t$ alone. Where $r = \ddot{r} "
        r"= 0$, \eqref{eq:accumulation-bend} has $\gamma = 0$, and where $\dot{r} = 0$ too, $a = "
        r"0$.\end{proof}",
    )


def _at_belts(scope: Scope, below: Any, above: Any) -> Check:
    """Return the check that a step on the gap's rate below and above a belt holds at each belt."""
    meanings = []
    for belt in scope.boundaries:
        lower = newton(belt)
        meaning = {
            below: lower,
            above: newton(belt + 1),
            BELOW: lower.subs(solution.v, BELTS[belt]),
        }
        meaning |= {JUMP: 2 * MU[belt] * FN / m, GAP: solution.v - BELTS[belt]}
        meanings.append(exact(meaning))
    return cases(*meanings)


def _one_flight() -> Items:
    """Return the items of the lemma on a flight that returns to its belt."""
    phi = sp.Function("phi")(tau)
    gap = sp.Function("g")(tau)
    growth = named(r"\dot{W}")
    letter = named(r"\varphi")
    wronskian = sp.exp(cm * tau) * (phi * gap.diff(tau) - phi.diff(tau) * gap)
    slope = wronskian.diff(tau).subs(phi.diff(tau, 2), -cm * phi.diff(tau) - w0sq * phi)
    force = gap.diff(tau, 2) + cm * gap.diff(tau) + w0sq * gap
    quotient = phi**2 * sp.exp(cm * tau) * (gap / phi).diff(tau)
    total = named("W")
    yield (
        r"\subsection{One flight}",
        r"\begin{lemma}[a flight that returns]\label{thm:accumulation-returns} Let $r$ not change "
        r"its sign on an interval shorter than $\pi/\omega_d$ (any length if $c^2 \ge 4km$), and "
        r"let a flight in it begin and end at belt $\lambda$. If it is in $\Omega_\lambda$, $r \ge "
        r"0$, and $U < 0$ at its beginning and $U > 0$ at its end. If it is in "
        r"$\Omega_{\lambda+1}$, $r \le 0$, and $U > J$ at its beginning and $U < J$ at its end. If "
        r"$\gamma = a = 0$ there is no such flight.\end{lemma}",
        r"\begin{proof} Take $\varphi > 0$ with $L\varphi = 0$ as in the proof of "
        r"Theorem~\ref{thm:events-two}, $q = g/\varphi$ and",
        equation(
            total,
            letter**2 * sp.exp(c * tau / m) * named(r"\dot{q}"),
            exact(
                {
                    total: wronskian,
                    letter: phi,
                    named(r"\dot{q}"): (gap / phi).diff(tau),
                    **_paper(),
                },
                independent=False,
            ),
            "W",
        ),
        r"which is $e^{c\tau/m}(\varphi\dot{g} - \dot{\varphi}g)$. By \eqref{eq:events-gap} $L g = "
        r"r$, so that",
        facts(equation(wronskian, quotient, exact(independent=False))),
        equation(
            growth,
            sp.exp(c * tau / m) * letter * RATE,
            exact({growth: slope, letter: phi, RATE: force, **_paper()}, independent=False),
            "growth",
        ),
        r"and $W$ is monotone. At both ends of the flight $q = 0$, so $\dot{q}$ and $W$ change "
        r"their sign in it unless $q$ vanishes throughout, and that is no flight. For $g < 0$ in "
        r"between $q$ falls first and rises then: $W$ grows, from a negative to a positive value, "
        r"so that $r \ge 0$ and $r$ is not always 0. At the ends $W$ has the sign of $\dot{g}$, "
        r"which is that of $U$ by \eqref{eq:accumulation-below}. For $g > 0$ turn all signs, with "
        r"\eqref{eq:accumulation-above}.\end{proof}",
    )


def _paper() -> dict[Any, Any]:
    """Return the meanings of the paper's letters c and k in those of the basis functions."""
    return {c: cm * m, k: w0sq * m}


def _one_belt() -> Items:
    """Return the items of the theorem on one belt."""
    yield (
        r"\subsection{One belt}",
        r"\begin{theorem}[three events]\label{thm:accumulation-three} Let $r$ of belt $\lambda$ "
        r"not change its sign on a closed interval of time that is shorter than $\pi/\omega_d$ "
        r"(any length if $c^2 \ge 4km$), and let the motion not meet the other belt in it. Then it "
        r"has at most three events there.\end{theorem}",
        r"\begin{proof} Let $r \ge 0$; $r \le 0$ is the mirror image. Call a flight \emph{inner} "
        r"if it begins and ends at the belt within the interval. By "
        r"Lemma~\ref{thm:accumulation-returns} an inner flight is in $\Omega_\lambda$, with $U < "
        r"0$ at its beginning and $U > 0$ at its end. There is at most one: from the end of one to "
        r"the beginning of the next $g \le 0$, because no inner flight is in $\Omega_{\lambda+1}$, "
        r"so $\dot{U} \ge 0$ by \eqref{eq:accumulation-rate}, and $U$ cannot fall from above 0 to "
        r"below. Besides the inner flight the interval may begin and end with parts of a flight, "
        r"so that at most two stretches remain on which $\dot{x} = v_\lambda$, each a single time "
        r"or a stick. With an inner flight the first one is a single time, as $U \ge 0$ up to the "
        r"end of a stick. So at most three events are left: 1 for the first stretch and 2 for the "
        r"second, or 2 for one stretch without an inner flight. The most is: the mass comes from "
        r"above and passes, returns from below and sticks, and leaves upwards.\end{proof}",
        r"The mass may make use of all three: with $r > 0$ the belt's other forces grow, and a "
        r"stick can only end upwards.",
    )


def _bound() -> Items:
    """Return the items of the corollary on the number of events in a period of the drive."""
    return (
        r"\begin{corollary}[how many]\label{thm:accumulation-bound} In an interval of the length "
        r"$2\pi/\Omega$ a motion that meets belt $\lambda$ alone has at most $3(3 + \lfloor "
        r"2\omega_d/\Omega\rfloor)$ events. If it meets both belts, and $N$ times one after the "
        r"other, it has at most $3(5 + \lfloor 2\omega_d/\Omega\rfloor + N)$, and $N \le 2\pi "
        r"F_*/(\Omega(v_2 - v_1))$ if $|F^{(2)}| \le F_*$ while $v_1 \le \dot{x} \le v_2$. "
        r"($\omega_d = 0$ for $c^2 \ge 4km$.)\end{corollary}",
        r"\begin{proof} $r$ of one belt changes its sign at two phases, so that a period has at "
        r"most three intervals on which it does not, and at most five for both belts; $\lfloor "
        r"2\omega_d/\Omega\rfloor$ cuts more make all of them shorter than $\pi/\omega_d$. In each "
        r"of them the events form rows at the same belt, one more than the belt changes there, and "
        r"each row has at most three. Between the belts the velocity changes by $v_2 - "
        r"v_1$.\end{proof}",
    )


def event_bound(p: Parameters, belts: set[int], changes: int) -> int:
    """Return the bound of the corollary on the number of events in a period of the drive: three in
    each of the pieces that the period is cut into.
    """
    square = number(p.k / p.m) - number(p.c / p.m) ** 2 / 4
    frequency = CONTEXT.sqrt(max(square, CONTEXT.mpf(0)))
    cuts = floor(2 * frequency / number(p.Omega))
    if len(belts) == 1:
        return 3 * (3 + cuts)
    return 3 * (5 + cuts + changes)


class BusiestPeriod(NamedTuple):
    """The period of a motion with most events: their number, their belts, and how often the belt
    changes from one to the next.
    """

    event_count: int
    belts: set[int]
    changes: int


def busiest_period(scene: str) -> BusiestPeriod:
    """Return the busiest period of a scene's motion."""
    start = load_scene(scene)
    period = 2 * CONTEXT.pi / number(start.parameters.Omega)
    trajectory = simulate(start, t_end=f"{PERIODS}T")
    events = [(CONTEXT.mpf(event.t), event.boundary) for event in trajectory.events]
    most_events = 0
    belts = {1}
    changes = 0
    # The busiest period may begin with an event.
    for begin, _ in events:
        belts_met = [belt for time, belt in events if begin <= time <= begin + period]
        if len(belts_met) > most_events:
            most_events = len(belts_met)
            belts = set(belts_met)
            changes = sum(before != after for before, after in pairwise(belts_met))
    return BusiestPeriod(most_events, belts, changes)


def _count(number_of: int) -> Step:
    """Return a cell of the table: a whole number, which has to be exactly this one."""
    letter = named("z")
    return equation(letter, sp.Integer(number_of), exact({letter: sp.Integer(number_of)}))


def _table() -> Table:
    """Return the table of the bound and of the events that the paper's motions have in a period."""
    rows: list[tuple[Any, ...]] = []
    checks: list[Step] = []
    for scene in SCENES:
        count, belts, changes = busiest_period(scene)
        bound = event_bound(load_scene(scene).parameters, belts, changes)
        checks.append(step(sp.Integer(count), "<=", sp.Integer(bound), sign()))
        belt_names = ", ".join(map(str, sorted(belts)))
        rows.append((rf"\texttt{{{scene}}}", belt_names, *map(_count, (changes, count, bound))))
    return Table(
        "tab:accumulation-counts",
        rf"The most events that the motions of the paper's figures have in an interval as long as "
        rf"a period of the drive, in {PERIODS} periods, and the bound of "
        rf"Corollary~\ref{{thm:accumulation-bound}} with the $N$ of that interval.",
        ("scene", "belts", "$N$", "events", "bound"),
        tuple(rows),
        tuple(checks),
        columns="llrrr",
    )
