"""The points of codimension two, where two conditions fail at once, and what surrounds each."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import sympy as sp

from symosc.derive.chapters.corrections import (
    BELT,
    HERE,
    ExampleOscillator,
    flow,
    neville,
    pull,
    zero,
)
from symosc.derive.scope import Scope, stated
from symosc.derive.steps import (
    CONTEXT,
    Items,
    Step,
    Table,
    close,
    decimal,
    equation,
    exact,
    number,
)
from symosc.reference.cases import wall
from symosc.symbolic.latex import named
from symosc.symbolic.solution import FN, k

TITLE = "Points of codimension two"
TIME = sp.Symbol("t", real=True)
CONTACT = named("t_m")
BEND = sp.Symbol("h", positive=True)
HALF = sp.Symbol("s", positive=True)
SMALL = sp.Symbol(r"\epsilon", positive=True)
SLOPE = sp.Symbol("b", positive=True)
LEVEL = named("u")
HEIGHT = named("q")
JUMP = sp.Symbol("J", positive=True)
DIP = sp.Symbol("d", positive=True)
CURVE = sp.Symbol("e", positive=True)
GAP = named("g(t)")
PUSH = named("U(t)")


def items(scope: Scope) -> Items:
    """Yield the chapter: the list, each point's surroundings, and examples."""
    yield _list()
    yield _arrival()
    yield _passage()
    yield _double()
    yield _frictionless()
    yield _rests()
    yield _pairs()
    yield _tables()


def _list() -> Items:
    """Return the items with the list and the proof that it is complete."""
    return (
        r"In this chapter $c > 0$, $k > 0$ and $B_0 \ne 0$, so that one periodic motion attracts "
        r"all others except on belts at rest (Theorem~\ref{thm:orbits-unique}). In a plane of two "
        r"parameters its word changes on curves, the four borders of "
        r"Theorem~\ref{thm:borders-names}. Where two conditions fail at once, curves meet. $U$, "
        r"$J$ and $r$ are those of Lemma~\ref{thm:accumulation-forces}.",
        r"\begin{theorem}[the list]\label{thm:codimension-list} Where exactly two conditions of "
        r"Definition~\ref{thm:borders-border} fail, or one fails together with the sign that "
        r"decides its name, the settled motion has, up to the mirror image $x \to "
        r"-x$:\begin{enumerate}\item[(P)] two of the four borders at two different events: ten "
        r"pairs (Theorem~\ref{thm:codimension-pairs});\item[(A)] a flight of $\Omega_\lambda$ that "
        r"arrives at belt $\lambda$ with $U = r = 0$ and $\dot{r} > 0$: a cubic tangency "
        r"(Theorem~\ref{thm:codimension-arrival});\item[(B)] a flight of $\Omega_{\lambda+1}$ that "
        r"arrives with $U = r = 0$ and $\dot{r} > 0$, or $\dot{r} < 0$ "
        r"(Theorem~\ref{thm:codimension-passage});\item[(C)] a stick in which $U = r = \dot{r} = "
        r"0$ and $\ddot{r} < 0$: then $k|v_\lambda| = |B_0|\Omega$ "
        r"(Theorem~\ref{thm:codimension-double});\item[(D)] a graze of a belt whose friction "
        r"vanishes, $U = J = 0$ (Theorem~\ref{thm:codimension-frictionless}).\end{enumerate}The "
        r"set on which there is no periodic motion with a word, $v_\lambda = 0$ and $|B_0| \le "
        r"\mu_\lambda F_N$, is a line in planes with $v_\lambda$; its end is (E) "
        r"(Theorem~\ref{thm:codimension-rests}). Both belts are never met at once, as $v_1 \ne "
        r"v_2$, and a stick never has both ends at once unless $J = 0$.\end{theorem}",
        r"\begin{proof} A condition belongs to one event, and each event to one belt. If the two "
        r"belong to different events, this is (P). At one event a flight from below arrives with "
        r"$\dot{g} = U \ge 0$, where the other force is $U - J$. $U > 0$ and $U = J > 0$ is a "
        r"border by the sign of $r$, with $r = 0$ the mirror image of (B). $U = 0 < J$ with $r < "
        r"0$ is the graze. With $r > 0$ the flight would have come from above. With $r = 0$ it "
        r"comes from below if $\dot{r} > 0$: (A), while $\dot{r} = 0$ is a third condition, as is "
        r"$r = 0$ if $U = J = 0$, (D). $J = 0 < U$ is a passage. A flight from above is the mirror "
        r"image. On a stick $U > 0 > U - J$, until one of both vanishes, let it be $U$. With $r < "
        r"0$ the stick ends as in a regular motion, and $r > 0$ is impossible after $U > 0$. With "
        r"$r = 0$ it is a border if $\dot{r} > 0$, impossible after $U > 0$ if $\dot{r} < 0$, and "
        r"(C) if $\dot{r} = 0$, where $\ddot{r} \ne 0$ by \eqref{eq:accumulation-bend} and $U > 0$ "
        r"before asks for $\ddot{r} < 0$. $r = \dot{r} = 0$ is $|\gamma| = |a|$.\end{proof}",
        r"What surrounds (A) to (D) is shown to leading order, as in the proof of "
        r"Theorem~\ref{thm:corrections-maps}: in units in which the point is approached, the terms "
        r"with $c$ and $k$ and the derivatives of $r$ that are not named are small, all zeros "
        r"below are simple away from the curves named, and the implicit function theorem carries "
        r"over what is found. $t$ counts from the zero of $r$, but in (D) from the maximum. The "
        r"two letters of each plane, $(u, q)$ and so on, are smooth functions of the parameters, "
        r"and coordinates of the plane if their gradients are independent.",
    )


def _arrival() -> Items:
    """Return the theorem on a cubic tangency."""
    gap = HEIGHT + LEVEL * TIME + BEND * TIME**3 / 6
    touch = {LEVEL: sp.solve(gap.diff(TIME).subs(TIME, -HALF), LEVEL)[0]}
    height = sp.solve(gap.subs(TIME, -HALF).subs(touch), HEIGHT)[0]
    again = named("t_2")
    later = max(
        sp.solve(gap.subs(HEIGHT, height).subs(touch), TIME), key=lambda root: root.is_positive
    )
    return (
        r"\subsection{(A) A cubic tangency: adding-sliding becomes grazing-sliding}",
        r"\begin{theorem}[cubic tangency]\label{thm:codimension-arrival} Let $r = h t$ with $h > "
        r"0$, and let the flight of $\Omega_\lambda$, if it went on, have",
        equation(
            GAP,
            gap,
            {GAP: HEIGHT + sp.integrate(LEVEL + sp.integrate(BEND * TIME, TIME), TIME)},
            "cubic",
        ),
        r"For $u < 0$ write $u = -h s^2/2$, $s > 0$. Two borders leave the point $u = q = 0$: the "
        r"line $u = 0$, $q > 0$ of adding-sliding, and the curve",
        equation(HEIGHT, -BEND * HALF**3 / 3, {HEIGHT: height}, "graze"),
        r"of grazing-sliding, a half of a semicubical parabola. Between them, for $u < 0$ and $q > "
        r"-hs^3/3$, the mass sticks, slips and sticks again. On the other side it arrives and "
        r"sticks. At the graze the flight goes on and arrives at",
        equation(again, 2 * HALF, {again: later}, "second"),
        r"if it touches at $t = -s$.\end{theorem}",
        r"\begin{proof} The flight has its maximum at $-s$, with $g = q + hs^3/3$ there. If it is "
        r"negative, or $u > 0$, there is one contact, behind the minimum or without one, and $U > "
        r"0$ from then on. If it is positive, the mass sticks from a time before $-s$ on, with $U "
        r"= u + h t^2/2$ on the belt, which is negative from $-s$ to $s$: a slip. For $u > 0$ $U$ "
        r"stays positive. The stick whose slip vanishes at $u = 0$ begins before $t = 0$ iff $q > "
        r"0$.\end{proof}",
    )


def _passage() -> Items:
    """Return the theorem on a passage with U = r = 0."""
    push = LEVEL + BEND * TIME**2 / 2
    gap = sp.integrate(push, (TIME, CONTACT, TIME))
    back = {LEVEL: BEND * HALF**2 / 2}
    turned = sp.integrate(LEVEL - BEND * TIME**2 / 2, (TIME, CONTACT, HALF)).subs(back)
    quotient = named(r"\frac{g(t)}{t - t_m}")
    top = named("g(s)")
    minus_contact = sp.Symbol("p", positive=True)  # -t_m
    roots = sp.solve(turned.subs(CONTACT, -minus_contact), minus_contact)
    # The positive multiple of s.
    place = next(root for root in roots if (root / HALF).is_number and root / HALF > 0)
    return (
        r"\subsection{(B) A passage at the edge: three borders}",
        r"\begin{theorem}[a passage with $U = r = 0$]\label{thm:codimension-passage} Let the mass "
        r"come from $\Omega_{\lambda+1}$ at the time $t_m$, and let $U = u + \dot{r}\,t^2/2$ on "
        r"the belt, with $\dot{r} = \pm h$, $h > 0$. In the plane of $(t_m, u)$ three borders meet "
        r"at 0.\begin{enumerate}\item[(i)] $\dot{r} = h$: crossing-sliding on $u = -h t_m^2/2$, "
        r"$t_m < 0$; switching-sliding on $u = -h t_m^2/2$, $t_m > 0$; adding-sliding on $u = 0$, "
        r"$t_m < 0$. Below the parabola the mass slips and sticks; between it and $u = 0$, for "
        r"$t_m < 0$, it sticks, slips and sticks; in the rest it sticks.\item[(ii)] $\dot{r} = "
        r"-h$: crossing-sliding on $u = h t_m^2/2$, $t_m > 0$; switching-sliding on $u = h "
        r"t_m^2/2$, $t_m < 0$; grazing-sliding on $u = h t_m^2/8$, $t_m < 0$. Above the parabola "
        r"$u = h t_m^2/2$ the mass sticks and slips; between both parabolas, for $t_m < 0$, it "
        r"slips, sticks and slips; in the rest it slips.\end{enumerate}\end{theorem}",
        r"\begin{proof} (i) At the contact $U = u + h t_m^2/2$. If it is negative, the mass "
        r"passes, and its flight has",
        equation(
            quotient,
            LEVEL + BEND * (TIME**2 + TIME * CONTACT + CONTACT**2) / 6,
            exact({quotient: sp.cancel(gap / (TIME - CONTACT))}),
            "quotient",
        ),
        r"which is negative at $t_m$ and has a zero later: it returns, at a time with $U > 0$. If "
        r"it is positive, the mass sticks, and slips during the stick iff $u < 0$ and $t_m < 0$. "
        r"By the sign of $r = h t_m$ the two halves of the parabola have their names. (ii) Write "
        r"$u = h s^2/2$ for $u > 0$. $U > 0$ for $-s < t < s$: a contact then sticks until $s$. "
        r"For $t_m > s$ and for $u < 0$ the mass passes and $g$ falls for ever. For $t_m < -s$ it "
        r"passes, and its flight would have the maximum",
        equation(
            top, BEND * (HALF - CONTACT) ** 2 * (2 * HALF + CONTACT) / 6, {top: turned}, "top"
        ),
        r"so it returns iff $t_m > -2s$, and sticks till $s$ then. The flight that touches began at",
        equation(CONTACT, -2 * HALF, {CONTACT: -place}, "touch"),
        r"where $u = h t_m^2/8$.\end{proof}",
    )


def _double() -> Items:
    """Return the theorem on |gamma| = |a|."""
    push = LEVEL + DIP * TIME - CURVE * TIME**3 / 6
    low = -sp.sqrt(2 * DIP / CURVE)
    least = named(r"U(-\sqrt{2d/e})")
    zeros = sp.Symbol("s", positive=True)
    free = push.subs({LEVEL: 0, DIP: CURVE * zeros**2 / 6})
    gap = sp.integrate(free, (TIME, -zeros, TIME))
    return (
        r"\subsection{(C) $k|v_\lambda| = |B_0|\Omega$: a tongue}",
        r"\begin{theorem}[a double zero of $r$]\label{thm:codimension-double} Let $v_\lambda > 0$ "
        r"and, near the phase at which it is largest, $r = d - e t^2/2$ with $d = |a| - \gamma$ "
        r"and $e = |a|\Omega^2$, and let $U = u + d\,t - e t^3/6$ during a stick. For $d > 0$ "
        r"there are two borders: $u = \frac{2}{3}d\sqrt{2d/e}$ of adding-sliding, and $u = 0$ of "
        r"grazing-sliding. Between them the mass slips, sticks and slips for good; outside it "
        r"slips for good, before the tongue at $u < 0$ and behind it at $u > 0$. For $d \le 0$ "
        r"there are none.\end{theorem}",
        r"\begin{proof} $U$ falls except for $|t| < \sqrt{2d/e}$, $d > 0$. Its minimum is",
        equation(
            least,
            LEVEL - sp.Rational(2, 3) * DIP * sp.sqrt(2 * DIP / CURVE),
            {least: sp.expand(push.subs(TIME, low))},
            "least",
        ),
        r"and if it is negative the mass slips from the first zero of $U$ on. Its flight reaches "
        r"the belt again iff its maximum, at the third zero of $U$, is positive. At the border it "
        r"is 0, so that $g$, a quartic in $t$, has double zeros at the first and the third zero of "
        r"$U$, which then lie symmetrically to the second. The sum of all three is 0, so $u = 0$, "
        r"and with the first zero at $-s$",
        equation(GAP, -CURVE * (TIME**2 - zeros**2) ** 2 / 24, {GAP: gap}, "quartic"),
        r"For larger $u$ the maximum is positive, as it is near the other border, and the two "
        r"borders are the only ones between which $U$ has three zeros.\end{proof}",
        r"A flight that arrives with $U = r = \dot{r} = 0$, the quartic tangency of "
        r"Theorem~\ref{thm:grazing-equality}, needs three conditions. The paper's Figs.~7 and 8 "
        r"show it because their parameters have $k v_\lambda = \pm B_0\Omega$.",
    )


def _frictionless() -> Items:
    """Return the theorem on a graze with vanishing friction."""
    first = sp.sqrt(2 * SMALL / SLOPE)
    arrival = named(r"U(-s)")
    back = named(r"U(t_{2})")
    speed = SLOPE * HALF - JUMP
    length = 2 * speed / SLOPE
    edge = named(r"\epsilon_1")
    second = named(r"\epsilon_2")
    solved = {
        name: sp.solve(sp.Eq(SLOPE * first, JUMP * factor), SMALL)[0]
        for name, factor in ((edge, 1), (second, 2))
    }
    return (
        r"\subsection{(D) A belt without friction: three parabolas}",
        r"\begin{theorem}[a graze for $J = 0$]\label{thm:codimension-frictionless} Let a flight of "
        r"$\Omega_\lambda$, if it went on, have $g = \epsilon - b t^2/2$ with $b > 0$, and let $J "
        r"= 2\mu_\lambda F_N/m \ge 0$ be small. The borders that leave $\epsilon = J = 0$ are "
        r"$\epsilon = 0$ (grazing-sliding) and",
        equation(edge, JUMP**2 / (2 * SLOPE), solved, "edge-1"),
        equation(second, 2 * JUMP**2 / SLOPE, solved, "edge-2"),
        r"of switching-sliding and crossing-sliding. In their order: the mass does not meet the "
        r"belt; it sticks and returns; it passes, comes back and sticks; it passes and passes "
        r"back.\end{theorem}",
        r"\begin{proof} With $\epsilon = b s^2/2$ the flight meets the belt at $-s$, with",
        equation(
            arrival,
            SLOPE * HALF,
            {arrival: (SMALL - SLOPE * TIME**2 / 2).diff(TIME).subs(TIME, -HALF)},
            "arrival",
        ),
        r"The other force is $U - J$: it holds for $b s < J$. If not, the mass passes with the "
        r"acceleration $bs - J$, which falls with the rate $b$, and is back with the opposite one, "
        r"when",
        equation(back, 2 * JUMP - SLOPE * HALF, {back: SLOPE * HALF - SLOPE * length}, "back"),
        r"and $r = -b$: it sticks for a while iff $bs < 2J$.\end{proof}",
        r"For $J = 0$ there is no belt, and all three borders end.",
    )


def _rests() -> Items:
    """Return the theorem on belts at rest and belts that hardly move."""
    size = sp.Abs(sp.Symbol("B_0", real=True))
    mu = sp.Symbol(r"\mu_\lambda", nonnegative=True)
    held = named(r"H_\lambda")
    high = named("x_+")
    low = named("x_-")
    ends = {
        name: sp.solve(held + sign * (mu * FN - size) - k * name, name)[0]  # the only solution
        for name, sign in ((high, 1), (low, -1))
    }
    return (
        r"\subsection{(E) A belt at rest: where the attractor jumps}",
        r"\begin{theorem}[belts that hardly move]\label{thm:codimension-rests} Let $|B_0| < "
        r"\mu_\lambda F_N$, and let $v_\lambda$ tend to 0 while all else stays. For $v_\lambda > "
        r"0$ the periodic motion tends to a rest at $x_+$, for $v_\lambda < 0$ to one at $x_-$,",
        equation(high, (held + mu * FN - size) / k, ends, "high"),
        equation(low, (held - mu * FN + size) / k, ends, "low"),
        r"the ends of the interval of Theorem~\ref{thm:orbits-unique}. So it jumps at $v_\lambda = "
        r"0$ by",
        equation(high - low, 2 * (mu * FN - size) / k, ends, "jump"),
        r"which vanishes in proportion to $\mu_\lambda F_N - |B_0|$ where the line of rests ends. "
        r"Elsewhere the attractor is continuous (Theorem~\ref{thm:borders-atlas}).\end{theorem}",
        r"\begin{proof} As in the proof of Theorem~\ref{thm:borders-atlas} (i) each sequence of "
        r"these motions has a part that tends, with the velocities, to a periodic motion for "
        r"$v_\lambda = 0$, which is a rest at some $\bar{x}$ of the interval. Let $v_\lambda > 0$. "
        r"The mean velocity is 0, so the motion is in $\Omega_\lambda$ at some times and on or "
        r"above the belt at others, and it enters $\Omega_\lambda$ at a time with $U \le 0$. In "
        r"the limit $U \le 0$ at some phase of the rest, where $U \ge 0$ at all phases by "
        r"Proposition~\ref{thm:motion-held}. So its least value is 0, and that is $m U = H_\lambda "
        r"+ \mu_\lambda F_N - |B_0| - k\bar{x}$. For $v_\lambda < 0$ turn all signs.\end{proof}",
    )


def _pairs() -> Items:
    """Return the theorem on two borders at two events."""
    return (
        r"\subsection{(P) Two borders at two events}",
        r"\begin{theorem}[two events]\label{thm:codimension-pairs} Let the settled motion be at "
        r"two borders at once, at different events, with the $\epsilon_1$ and $\epsilon_2$ of "
        r"Theorem~\ref{thm:corrections-maps}, taken along the settled motion, as functions of two "
        r"parameters.\begin{enumerate}\item[(i)] If neither is a graze, $\epsilon_1$ and "
        r"$\epsilon_2$ are continuously differentiable there. If their gradients are independent, "
        r"two borders cross, and the four words lie between them: without, with one of, and with "
        r"both of the extra pieces. Each border has a tangent at the point.\item[(ii)] If the "
        r"first one is a graze, all this holds on both sides of $\epsilon_1 = 0$, with two "
        r"different gradients of $\epsilon_2$: if the pairs of gradients are independent and of "
        r"one orientation, the same four words occur, and the other border has a kink at the "
        r"point.\item[(iii)] If both are grazes there are four pairs of gradients, one for each "
        r"sign of $\epsilon_1$ and $\epsilon_2$, and both borders have "
        r"kinks.\end{enumerate}\end{theorem}",
        r"\begin{proof} The settled motion is the fixed point of a map over $T$, which is composed "
        r"of smooth maps and the two discontinuity maps. Those of crossing-, switching- and "
        r"adding-sliding are continuously differentiable (their orders are 2 and more), that of a "
        r"graze on each side. The derivative of the map has no multiplier 1 "
        r"(Theorem~\ref{thm:jacobians-monodromy} (i)), so the fixed point depends in the same way "
        r"on the parameters, by the implicit function theorem on each side, and so do $\epsilon_1$ "
        r"and $\epsilon_2$. The $\epsilon$ of a graze is positive for the same parameters with and "
        r"without the stick: to first order, with $M$ and $D$ of "
        r"Theorem~\ref{thm:corrections-multipliers} for $\epsilon \to 0$, its two values "
        r"$\epsilon_{+}$ and $\epsilon_{-}$ have the ratio",
        _ratio(),
        r"which is $\det(I - M)/\det(I - M D)$, and positive because all multipliers are below 1 "
        r"in size.\end{proof}",
        r"A motion that is its own mirror image has its events in pairs, with $\epsilon_1 = "
        r"\epsilon_2$ for all parameters that keep the symmetry: that is one condition "
        r"(Chapter~\ref{sec:borders}).",
    )


def _ratio() -> Step:
    """Return the step on the ratio of the overshoots of both continuations of a graze."""
    entries = sp.symbols("M_{11} M_{12} M_{21} M_{22}", real=True)
    matrix = sp.Matrix(2, 2, entries)
    push = sp.Matrix(sp.symbols("p q", real=True))  # what the parameters change in a period

    def velocity(kept: int) -> Any:
        """Return the velocity of the fixed point z = M D z + push of a period, with D = diag(1,
        kept).
        """
        _, fixed_velocity = (sp.eye(2) - matrix * sp.diag(1, kept)).inv() * push
        return fixed_velocity

    # A stick makes all velocities the same.
    without = velocity(kept=1)
    stuck = velocity(kept=0)
    m_11, m_12, m_21, m_22 = entries
    right = ((1 - m_11) * (1 - m_22) - m_12 * m_21) / (1 - m_11)
    check = exact({named(r"\frac{\epsilon_{+}}{\epsilon_{-}}"): stuck / without}, sp.simplify)
    return equation(named(r"\frac{\epsilon_{+}}{\epsilon_{-}}"), right, check, "ratio")


# --- numbers ---

FIRST = CONTEXT.mpf(10) ** -2
POINTS = 9
DECIMALS = 10
#: The oscillator of the two points, whose friction and frequency are to be found.
WALL = wall(F=1, Omega=1, c="1/10")


def _phase(falls: bool) -> Any:
    """Return the phase at which r = 0, where r falls or rises."""
    sine = -HERE.k * BELT / (HERE.B0 * HERE.Omega)
    if falls:
        return CONTEXT.asin(sine)
    return CONTEXT.pi - CONTEXT.asin(sine)


def _extrapolated(function: Callable[[Any], Any]) -> Any:
    """Return the limit of a function of s at 0."""
    places = [FIRST / 2**j for j in range(POINTS)]
    return neville(places, [function(place) for place in places])


def tangency(half: Any) -> Any:
    """Return t_2/s of (A): where the flight that touches at t = -s arrives, by the exact flow."""
    angle = _phase(falls=False) - half
    place = (HERE.B0 * CONTEXT.cos(angle) - HERE.c * BELT) / HERE.k
    later = zero(_without_double_zero(place, angle), 3 * half)
    return (later - half) / half


def touching_passage(half: Any) -> Any:
    """Return t_m/s of (B) (ii): where the flight that touches at s began, by the exact flow."""
    angle = _phase(falls=True) + half
    place = (HERE.B0 * CONTEXT.cos(angle) - HERE.c * BELT) / HERE.k
    before = zero(_without_double_zero(place, angle), -3 * half)
    return (before + half) / half


def _without_double_zero(place: Any, angle: Any) -> Callable[[Any], Any]:
    """Return the gap of the flight that touches the belt at time 0, divided by the time squared."""

    def quotient(time: Any) -> Any:
        _, velocity = flow(HERE, place, BELT, angle, time)
        return (velocity - BELT) / time**2

    return quotient


def frictionless(half: Any) -> Any:
    """Return epsilon b/J^2 of (D) at the last border, by the exact flow."""
    angle = CONTEXT.mpf(0)
    slope = HERE.k * BELT
    small = slope * half**2 / 2
    # The flow of the domain below is `small` beyond the belt's speed at its top, at the phase 0; it
    # meets the belt's speed at the time `met` < 0.
    speed = BELT + small
    top = (HERE.B0 - HERE.c * speed) / HERE.k

    def beyond_belt(time: Any) -> Any:
        _, velocity = flow(HERE, top, speed, angle, time)
        return velocity - BELT

    met = zero(beyond_belt, -half)
    place, _ = flow(HERE, top, speed, angle, met)

    def force_back(jump: Any) -> Any:
        """Return U where the flight above the belt comes back, for a jump J of the force."""
        above = HERE._replace(A=HERE.A - jump)
        length = 2 * (pull(HERE, BELT, place, angle + met) - jump) / slope

        def gap_over_time(time: Any) -> Any:
            """Return the gap without its zero at the start, where the flight begins."""
            _, velocity = flow(above, place, BELT, angle + met, time)
            return (velocity - BELT) / time

        back = zero(gap_over_time, length)
        place_back, _ = flow(above, place, BELT, angle + met, back)
        return pull(HERE, BELT, place_back, angle + met + back)

    jump = zero(force_back, slope * half / 2)
    return small * slope / jump**2


@cache
def meeting(kind: str) -> tuple[Any, Any]:
    """Return F_N and Omega at a point (A) or (B) of the wall with c = 1/10, to 50 digits.

    The motion is symmetric, and one contact of each half has U = r = 0 where sin theta = 0.
    """
    damping, stiffness, amplitude = (number(getattr(WALL, name)) for name in ("c", "k", "B0"))

    def conditions(friction: Any, frequency: Any) -> tuple[Any, Any]:
        """Return position and velocity half a period later, minus what they have to be."""
        above = ExampleOscillator(damping, stiffness, amplitude, frequency, -friction)
        if kind == "(A)":
            # Sticks at x = F_N - 1 from the phase pi on until the force from above is 0.
            start = friction - 1
            leaves = 2 * CONTEXT.pi - CONTEXT.acos(friction + start)
            remaining = (2 * CONTEXT.pi - leaves) / frequency
            place, speed = flow(above, start, CONTEXT.mpf(0), leaves, remaining)
        else:  # leaves at the phase pi with the force 0
            start = -1 - friction
            place, speed = flow(above, start, CONTEXT.mpf(0), CONTEXT.pi, CONTEXT.pi / frequency)
        # A symmetric motion is at -x and -v half a period later.
        return place + start, speed

    guess = {"(A)": ("0.0436", "0.3218"), "(B)": ("0.248", "0.476")}[kind]
    solver = CONTEXT.clone()  # it changes its precision on the way
    friction, frequency = solver.findroot(
        lambda *point: list(conditions(*point)), [solver.mpf(text) for text in guess]
    )
    return CONTEXT.mpf(friction), CONTEXT.mpf(frequency)


def _tables() -> Items:
    """Return the tables of local ratios and of two points."""
    ratios = (
        (r"(A) $t_2/s$", sp.Integer(2), tangency),
        (r"(B) $t_m/s$", sp.Integer(-2), touching_passage),
        (r"(D) $\epsilon_2 b/J^2$", sp.Integer(2), frictionless),
    )
    rows = []
    for name, value, function in ratios:
        by_theorem = CONTEXT.mpf(int(value))
        by_flow = _extrapolated(function)
        check = close(partial(CONTEXT.mpf, by_theorem), DECIMALS)
        rows.append((name, f"${value}$", decimal("z", by_flow, DECIMALS, check)))
    points = []
    borders = {
        "(A)": r"adding-sliding, grazing-sliding",
        "(B)": "crossing-, switching-, grazing-sliding",
    }
    for kind, names in borders.items():
        points.append((kind, names, *(decimal("z", value, 10) for value in meeting(kind))))
    setting, numbers = stated(WALL, "m", "k", "B0", "mu1", "c", "A0", "v1", "mu2")
    return (
        r"\subsection{Examples}",
        Table(
            "tab:codimension-ratios",
            r"Ratios on the grazing-sliding border of (A) and (B) and on the crossing-sliding "
            r"border of (D): by the "
            rf"theorems, and by the exact flow with 60 digits, extrapolated to vanishing $s$, to "
            rf"{DECIMALS} decimals. The numbers are "
            r"those of Table~\ref{tab:corrections-numbers}.",
            ("", "theorem", "flow"),
            tuple(rows),
            columns="lrr",
        ),
        Table(
            "tab:codimension-points",
            rf"Two points of the oscillator at a wall ({setting}) in the plane of $F_N$ and "
            r"$\Omega$: the symmetric motion that fulfils both conditions, in closed form, solved "
            r"with 50 digits. \texttt{continue\_border} ends at the same points.",
            ("", "borders", "$F_N$", r"$\Omega$"),
            tuple(points),
            numbers,
            columns="llrr",
        ),
        r"In (A) the mass arrives at the phase $\pi$ at $x = F_N - 1$, in (B) it passes at the "
        r"phase 0 at $x = 1 + F_N$: there $U = 0$, and $r = -a\sin\theta = 0$ because the wall is "
        r"at rest. For $c = 0$ the point (B) is $A_1$ of Proposition~\ref{thm:undamped-points}.",
    )
