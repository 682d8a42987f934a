"""Return maps: from slip to slip under a drive, and from turn to turn without one."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.chapters.motion import balance
from symosc.derive.chapters.static_friction import EXCESS, SIDE
from symosc.derive.scope import Scope, v_lambda
from symosc.derive.slip_map import (
    DrivenBelt,
    Slip,
    by_phase,
    derivative_by_series,
    in_digits,
    next_by_series,
)
from symosc.derive.steps import (
    CONTEXT,
    Items,
    at_root,
    close,
    decimal,
    equation,
    exact,
    facts,
    step,
)
from symosc.derive.taylor import LinearEquation, TimedState, first_pass
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, E0, E1, E2, Omega, k, m, t, theta, x

TITLE = "Return maps"
#: The line x - v_lambda t of a stick.
LINE = named(r"\xi")
#: By how much the needed force falls in a unit of time, per mass, at a slip and at the next one.
FALL = named("b")
NEXT_FALL = named("b'")
DECIMALS = 24
#: Decimals of the turning points of the example.
PLACES = 15
#: The driven belt of the examples: damping, speed, kinetic and static friction, drive, frequency.
DRIVEN = DrivenBelt(*map(sp.Rational, ("1/20", "1/10", "7/10", "63/50", "3/5", "7/5")))


def items(scope: Scope) -> Items:
    """Yield the chapter: the map from slip to slip, its steep places and jumps, the planar map."""
    yield _section()
    yield _derivative()
    yield _steep()
    yield _planar()
    yield _jump()


# --- from slip to slip ---


def _needed(line: Any, time: Any) -> Any:
    """Return the acceleration that the belt's friction has to balance during a stick."""
    return balance(line + v_lambda * time, v_lambda, Omega * time)


def _fall(phase: Any) -> Any:
    """Return by how much the needed force falls in a unit of time, per mass."""
    return (k * v_lambda + B0 * Omega * sp.sin(phase)) / m


def _section() -> Items:
    """Return the items on the section and its coordinate."""
    rate = named(r"d\theta/d\xi")
    needed = _needed(LINE, t)
    delay = (-needed.diff(LINE) / needed.diff(t)).subs(Omega * t, theta)
    still = named(r"d\xi/dt")
    path = sp.Function("x")(t)
    return (
        r"\subsection{A stick forgets the velocity}",
        r"A mass that sticks on belt $\lambda$ has no freedom but the place where it sticks. Let",
        equation(LINE, x - v_lambda * t, x - v_lambda * t, "line"),
        r"be the \emph{line} of a stick. On the belt",
        equation(
            still,
            0,
            exact({still: (path - v_lambda * t).diff(t).subs(path.diff(t), v_lambda)}),
        ),
        r"and the line decides all that follows: when the mass slips, on which side, and every "
        r"later event. So under a drive, too, the motions with sticks are described by a map of "
        r"one variable, from the line of a stick to that of the next one, or from the phase "
        r"$\theta$ of a slip, modulo $2\pi$, to that of the next.",
        r"\begin{lemma}[line and phase]\label{thm:return_maps-phase} With $b = (k v_\lambda + "
        r"B_0\Omega\sin\theta)/m \ne 0$ at a slip, its phase changes with the line by",
        equation(rate, -k * Omega / (m * FALL), exact({rate: Omega * delay, FALL: _fall(theta)})),
        r"\end{lemma}",
        r"\begin{proof} The needed force depends on the line and the time, and has its limit at "
        r"the slip: \eqref{eq:static_friction-shift} with $\delta x = \delta\xi$.\end{proof}",
        r"Slips upward have $b < 0$ and slips downward $b > 0$, by "
        r"Theorem~\ref{thm:static_friction-exits}. So the phases of slips are two arcs of the "
        r"circle, one for each side; for $|B_0|\Omega < k|v_\lambda|$ all slips are on one side.",
    )


def _derivative() -> Items:
    """Return the items on the derivative of the map."""
    kick = named(r"\delta\dot{x}^{+}")
    moved = named(r"\delta\xi")
    growth = named(r"d\xi'/d\xi")
    turned = named(r"d\theta'/d\theta")
    flight = sp.Matrix([[1 - k / m * E2, E1], [-k / m * E1, E0]])
    shove = SIDE * EXCESS * k * moved / (m * FALL)
    landed = (flight * sp.Matrix([moved, kick]))[0] / moved
    to_line = named(r"d\theta/d\xi")
    to_next = named(r"d\theta'/d\xi'")
    rates = {to_line: -k * Omega / (m * FALL), to_next: -k * Omega / (m * NEXT_FALL)}
    example = Slip(CONTEXT.mpf(5) / 2, -1)
    following, steepness = by_phase(in_digits(DRIVEN), example)
    turn = 2 * CONTEXT.pi
    return (
        r"\begin{theorem}[derivative of the map]\label{thm:return_maps-derivative} Let a slip with "
        r"$b \ne 0$ on the side $\sigma$ be followed by one flight of the duration $\tau$, which "
        r"touches no belt on its way and arrives with $\ddot{x} \ne 0$ where the belt holds it, "
        r"strictly. Then the line of the next stick has the derivative",
        equation(
            growth,
            1 - k / m * E2 + SIDE * EXCESS * k / (m * FALL) * E1,
            exact({growth: landed, kick: shove}),
            "growth",
        ),
        r"and if that stick ends with $b' \ne 0$, the phase has",
        equation(
            NEXT_FALL * turned,
            FALL * growth,
            exact({turned: to_next * growth / to_line, **rates}),
            "by-phase",
        ),
        r"If the flight passes belts on its way, $d\xi'/d\xi$ is the first entry of the product "
        r"$\Phi(\tau_n)S_{n-1}\cdots S_1\Phi(\tau_1)$, with the matrices $S_j$ of the passages, "
        r"times the column of 1 and $\sigma E k/(m b)$; through the bands of friction curves each "
        r"piece of the flight has the $\Phi$ of its band.\end{theorem}",
        r"\begin{proof} At a fixed time the position behind the slip changes by $\delta\xi$, and "
        r"by \eqref{eq:static_friction-saltation} the velocity by",
        equation(
            kick,
            shove,
            exact({kick: _late_kick(moved), FALL: _fall(theta)}),
            "kick",
        ),
        r"The flight multiplies both by $\Phi$ (Lemma~\ref{thm:jacobians-phi}). On arrival the "
        r"velocity is that of the belt, so that to first order the line changes as the position "
        r"does. The phases follow by Lemma~\ref{thm:return_maps-phase}.\end{proof}",
        r"For $E = 0$ the factor is $\Phi_{11}$, which is below 1 in size for $c > 0$. For $E > 0$ "
        r"the second term may have any size and sign.",
        r"\begin{example}[one slip]\label{thm:return_maps-example} Let $m = k = 1$, $c = "
        r"\frac{1}{20}$, $\Omega = \frac{7}{5}$, $B_0 = \frac{3}{5}$, and one belt with the speed "
        r"$\frac{1}{10}$, kinetic friction $\frac{7}{10}$ and static friction $\frac{63}{50}$. "
        r"After the slip downward at $\theta = \frac{5}{2}$",
        decimal(
            r"\theta'",
            following.phase % turn,
            DECIMALS,
            close(lambda: _next_phase(example) % turn, DECIMALS),
        ),
        decimal(
            r"d\theta'/d\theta",
            steepness,
            DECIMALS,
            close(lambda: derivative_by_series(in_digits(DRIVEN), example), DECIMALS),
        ),
        r"modulo $2\pi$, as the Taylor series of the motion and differences of two such motions "
        r"confirm. The map expands there, and turns the order of phases round.\end{example}",
    )


def _late_kick(moved: Any) -> Any:
    """Return the velocity that a delayed slip lacks, from the time by which it is late."""
    needed = _needed(LINE, t)
    late = (-needed.diff(LINE) / needed.diff(t)).subs(Omega * t, theta) * moved
    return -SIDE * EXCESS * late


@cache
def _next_phase(slip: Slip) -> Any:
    """Return the phase of the next slip by Taylor series."""
    return next_by_series(in_digits(DRIVEN), slip).phase


# --- where it is steep, and where it jumps ---


def _steep() -> Items:
    """Return the items on the square root and the jumps of the map."""
    turned = sp.Symbol("theta_0", real=True)
    early = named(r"\delta t")
    first = named(r"\xi_0")
    square = 2 * k * (first - LINE) / (B0 * Omega**2 * sp.cos(turned))
    # the force less its limit, and its rate, at the time delta t before t_0 on the line xi
    wave = sp.cos(turned - Omega * early) - sp.cos(turned)
    force = B0 * wave + k * v_lambda * early + k * (first - LINE)
    turning = {sp.sin(turned): -k * v_lambda / (B0 * Omega)}
    to_second_order = _series(force, early, 2).subs(turning)
    (zero,) = sp.solve(to_second_order, early**2)
    rate = _series(_fall(turned - Omega * early), early, 1).subs(turning)
    return (
        r"\subsection{Where the map is steep, and where it jumps}",
        r"\begin{theorem}[a needed force that turns at its limit]\label{thm:return_maps-root} Let "
        r"the needed force of the line $\xi_0$ touch the limit $\sigma\mu_{s\lambda}F_N$ at a time "
        r"$t_0$, without passing it, and $B_0\cos\theta_0 \ne 0$ at its phase $\theta_0$. Lines "
        r"$\xi$ near $\xi_0$ with $(\xi_0 - \xi)B_0\cos\theta_0 > 0$ slip before $t_0$, by $\delta "
        r"t$ with",
        equation(early**2, square, exact({early: sp.sqrt(zero)}, sp.simplify), "root"),
        equation(
            FALL,
            -B0 * Omega**2 * sp.cos(turned) / m * early,
            exact({FALL: rate}, sp.simplify),
            "small",
        ),
        r"to leading order, so that $d\xi'/d\xi$ grows like $1/\delta t$, without a bound if $E > "
        r"0$. Lines on the other side of $\xi_0$ are held there and slip later by a finite "
        r"time.\end{theorem}",
        r"\begin{proof} At $\xi_0$ and $t_0$ the needed force has the slope $-m b = 0$ and the "
        r"second derivative $-B_0\Omega^2\cos\theta_0$; on another line it differs by $k(\xi_0 - "
        r"\xi)$. At the touch from within, this second derivative has the sign of "
        r"$-\sigma$.\end{proof}",
        r"So next to each jump of this kind the map behaves like a square root. It jumps for one "
        r"more reason: a flight that touches a belt with $E > 0$ begins to stick, while one that "
        r"misses it flies on (Theorem~\ref{thm:static_friction-graze}). Elsewhere the map is "
        r"analytic, since all its pieces are. For $E = 0$ the motion depends continuously on its "
        r"start, and at a jump of the map only the name of the next slip changes.",
    )


def _series(expr: Any, letter: Any, order: int) -> Any:
    """Return the Taylor polynomial of an expression in a letter."""
    terms = (
        expr.diff(letter, n).subs(letter, 0) * letter**n / sp.factorial(n) for n in range(order + 1)
    )
    return sp.expand(sp.Add(*terms))


# --- without a drive ---


def _planar() -> Items:
    """Return the items on the map of an oscillator without a drive."""
    slope = named("dv/dx")
    acceleration = named(r"\ddot{x}")
    rate = named(r"\dot{x}")
    place = sp.Function("x")(t)
    speed = sp.Function("v")(place)
    meaning = {
        slope: speed.diff(place),
        acceleration: speed.diff(t),
        rate: place.diff(t),
    }
    return (
        r"\subsection{Without a drive motions cannot cross}",
        r"Let $B_0 = 0$ and $k > 0$, with any number of belts, friction curves and static "
        r"friction. A motion is then a path in the plane of $x$ and $v = \dot{x}$, and its future "
        r"depends on the point alone.",
        r"\begin{lemma}[paths are graphs]\label{thm:return_maps-graph} As long as $v > 0$, a path "
        r"is the graph of a continuous function $v(x)$, with",
        equation(
            slope,
            acceleration / rate,
            exact(meaning),
            "graph",
        ),
        r"during flights and 0 during sticks. If two paths meet at $v > 0$, they are one from "
        r"there on: one of two paths cannot get from above the other to below it. Likewise for $v "
        r"< 0$.\end{lemma}",
        r"\begin{proof} $x$ grows while $v > 0$. Continuous functions have a common value where "
        r"one overtakes the other, and from a common point there is one motion "
        r"(Theorems~\ref{thm:static_friction-unique} "
        r"and~\ref{thm:friction_curves-contraction}).\end{proof}",
        r"\begin{theorem}[the map from turn to turn]\label{thm:return_maps-monotone} Let a motion "
        r"turn at $x = a$, $v = 0$, from below to above, and let $P(a)$ be its next turn of this "
        r"kind, if it has one.\begin{enumerate}\item[(i)] $P$ never falls: $P(a) \le P(a')$ for $a "
        r"< a'$.\item[(ii)] The turns $a$, $P(a)$, $P(P(a))$, $\ldots$ of a motion never change "
        r"their direction. If the motion is bounded, it comes to rest, or tends to a rest or to a "
        r"closed curve. Every periodic motion but the rests turns twice in a period.\item[(iii)] A "
        r"motion that starts between two periodic motions stays between them.\item[(iv)] The turns "
        r"from which motions tend to one and the same curve fill an interval. At an end of it "
        r"where $P$ is continuous there is a rest or a periodic motion, which does not attract "
        r"from inside; for $E = 0$ at all belts $P$ is continuous between rests. Elsewhere $P$ "
        r"jumps there: a motion touches a belt with $E > 0$.\end{enumerate}\end{theorem}",
        r"\begin{proof} (i) At $v = 0$ the force is $-k x$ and a constant on either side, so that "
        r"the turns upward are the places below some $x$, and those downward are above. The path "
        r"from $a$ is above 0 at $a'$, where the other one begins, stays above it or joins it by "
        r"the lemma, and ends at $v = 0$ at no smaller $x$. Below $v = 0$ the same holds with both "
        r"signs turned, so the next turns are in the order of $a$ and $a'$ again. (ii) From $P(a) "
        r"\ge a$ follows $P(P(a)) \ge P(a)$, and so on; likewise for $\le$. A bounded sequence of "
        r"this kind converges, and the path between two turns with it. If $P^n(a) = a$, then $P(a) "
        r"> a$ or $P(a) < a$ is impossible, so $P(a) = a$. (iii) (i). (iv) If $a < a'' < a'$ and "
        r"the outer two sequences have one limit, so has the middle one. Let $e$ be an end where "
        r"$P$ is continuous. Points inside have their images inside and points outside have them "
        r"outside, so $P(e) = e$. Without static excess a motion depends continuously on its start "
        r"(Theorem~\ref{thm:friction_curves-contraction}).\end{proof}",
        r"This is what the theorem of Poincar\'e and Bendixson says of smooth flows in the plane. "
        r"Here the flow has no inverse and may jump, but uniqueness forward in time is enough.",
    )


# --- a jump ---


class Turns(NamedTuple):
    """Lowest turns: of the path that touches the belt, of the cycle, of the path that misses it."""

    touching: Any
    cycle: Any
    missing: Any


#: m = k = 1: damping, speed of the belt, kinetic and static friction.
_DAMPING = CONTEXT.mpf(1) / 10
_SPEED = CONTEXT.mpf(1) / 5
_KINETIC = CONTEXT.mpf(1) / 2
_HOLDING = CONTEXT.mpf(1)


def _free(place: Any, speed: Any, time: Any) -> tuple[Any, Any]:
    """Return position and velocity of a flight below the belt by its closed form."""
    decay = _DAMPING / 2
    turn = CONTEXT.sqrt(1 - decay**2)
    size = CONTEXT.exp(-decay * time)
    cosine = CONTEXT.cos(turn * time)
    sine = CONTEXT.sin(turn * time) / turn
    gap = place - _KINETIC
    moved = size * (gap * cosine + (speed + decay * gap) * sine)
    return _KINETIC + moved, size * (speed * cosine - (gap + decay * speed) * sine)


def _turn(place: Any, speed: Any, number: int) -> Any:
    """Return a turn of a flight: the first, the second or, backward in time, that of number -1."""
    decay = _DAMPING / 2
    turn = CONTEXT.sqrt(1 - decay**2)
    gap = place - _KINETIC
    # tan(turn t) = turn v / (gap + decay v)
    angle = CONTEXT.atan2(turn * speed, gap + decay * speed)
    while angle > 0:
        angle -= CONTEXT.pi
    return _free(place, speed, (angle + CONTEXT.pi * max(number, 0)) / turn)[0]


@cache
def _turns_by_formula() -> Turns:
    """Return the turns by closed forms."""
    touch = _KINETIC - _DAMPING * _SPEED
    slip = _HOLDING - _DAMPING * _SPEED
    return Turns(_turn(touch, _SPEED, -1), _turn(slip, _SPEED, 2), _turn(touch, _SPEED, 2))


@cache
def _turns_by_series() -> Turns:
    """Return the turns by Taylor series."""
    forward = LinearEquation(_DAMPING, 1, _KINETIC)
    backward = LinearEquation(-_DAMPING, 1, _KINETIC)

    def lowest(place: Any) -> Any:
        top = first_pass(forward, TimedState(0, place, _SPEED), lambda _, rate: rate < 0)
        return first_pass(forward, top, lambda _, rate: rate > 0).value

    touch = _KINETIC - _DAMPING * _SPEED
    # backward in time the velocity has the other sign
    start = first_pass(backward, TimedState(0, touch, -_SPEED), lambda _, rate: rate > 0)
    return Turns(start.value, lowest(_HOLDING - _DAMPING * _SPEED), lowest(touch))


def _jump() -> Items:
    """Return the items on the basin of a rest that a touch bounds."""
    touching, cycle, missing = (named(name) for name in ("a_0", "P(a_{0})", "P(a_{0}^{+})"))
    turns = _turns_by_formula()
    values = {touching: turns.touching, cycle: turns.cycle, missing: turns.missing}
    return (
        r"\begin{example}[a basin that ends at a touch]\label{thm:return_maps-touch} Take "
        r"Theorem~\ref{thm:stick_slip-damped} with $m = k = 1$, $c = \frac{1}{10}$, $V = "
        r"\frac{1}{5}$, $f = \frac{1}{2}$ and $s = 1$. The path that touches the belt starts at",
        decimal("a_0", turns.touching, PLACES, close(lambda: _turns_by_series().touching, PLACES)),
        r"There $P$ jumps: the path that touches the belt sticks and turns next on the cycle, and "
        r"one that misses it, however closely, turns at",
        decimal("P(a_{0})", turns.cycle, PLACES, close(lambda: _turns_by_series().cycle, PLACES)),
        decimal(
            "P(a_{0}^{+})",
            turns.missing,
            PLACES,
            close(lambda: _turns_by_series().missing, PLACES),
        ),
        r"So $P(a_0) < a_0 < P(a_0^{+})$, and $a_0$ bounds the basins of the cycle and of the "
        r"rest, but belongs to no periodic motion.",
        facts(
            step(cycle, "<", touching, at_root(lambda: values)),
            step(touching, "<", missing, at_root(lambda: values)),
        ),
        r"\end{example}",
        r"Where friction falls with the speed and $E = 0$, unstable cycles bound the basins, as in "
        r"Example~\ref{thm:equilibria-example}.",
    )
