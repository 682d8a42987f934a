"""Stick-slip cycles in closed form: without and with a damper, and of a pulled spring."""

from __future__ import annotations

from functools import cache, partial
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.chapters.motion import balance
from symosc.derive.chapters.static_friction import EXCESS, HOLDING, JUMP, KINETIC, SPRING
from symosc.derive.scope import F, Scope
from symosc.derive.steps import (
    CONTEXT,
    Check,
    Items,
    Meaning,
    Step,
    StepError,
    StepEvidence,
    Table,
    close,
    decimal,
    equation,
    exact,
    number,
    sign,
    solves,
    step,
)
from symosc.derive.taylor import LinearEquation, TimedState, bisected, first_pass
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, E0, E1, E2, c, m, t, tau, v, x

TITLE = "Stick-slip cycles in closed form"
#: The cycle: half the way of the stick, the frequency of the flight, the speed of the belt.
HALF = sp.Symbol("a", positive=True)
FREQUENCY = solution.omega_0
SPEED = sp.Symbol("V", positive=True)
DECIMALS = 24
TABLE_DECIMALS = 12
#: The decay and the frequency of a damped flight.
RATE = solution.h
TURN = solution.omega_d


def items(scope: Scope) -> Items:
    """Yield the chapter: the cycle without a damper, all other motions, the damper, a pulled spring."""
    yield _cycle()
    yield _all_motions()
    yield _damped()
    yield _end()
    yield _numbers()
    yield _pulled()


# --- without a damper ---


def _flight_at() -> Any:
    """Return the position during the flight below the belt, from f/k + a with the velocity V."""
    swing = HALF * sp.cos(FREQUENCY * tau) + SPEED / FREQUENCY * sp.sin(FREQUENCY * tau)
    return KINETIC / SPRING + swing


def _cycle() -> Items:
    """Return the items on the stick-slip cycle without drive and damper."""
    turn = 2 * (sp.pi - sp.atan(HALF * FREQUENCY / SPEED))
    flight = named("x(\\tau)")
    place = _flight_at()
    speed = place.diff(tau)
    needed = named(r"F_{s\lambda}(\tau_f)")
    arriving = {needed: -SPRING * (KINETIC / SPRING - HALF), HOLDING: KINETIC + SPRING * HALF}
    end = named(r"\dot{x}(\tau_f)")
    there = named(r"x(\tau_f)")
    lasts = named(r"\tau_f")
    period = named(r"\mathcal{T}")
    swing = named(r"R^2")
    held = named(r"\tau_s")
    at_end = {tau: turn / FREQUENCY}
    return (
        r"\subsection{Without a damper}",
        r"\begin{theorem}[stick-slip]\label{thm:stick_slip-cycle} Let $c = A_0 = B_0 = 0$, $k > "
        r"0$, and let there be one belt with the speed $V > 0$, kinetic friction $f > 0$ and "
        r"static friction $s > f$. With $a = (s - f)/k$ and $\omega_0 = \sqrt{k/m}$ every motion "
        r"that sticks once repeats from its first slip on, with the flight",
        equation(
            flight,
            place,
            solves(
                FREQUENCY**2 * KINETIC / SPRING, KINETIC / SPRING + HALF, SPEED, 0, FREQUENCY**2
            ),
            "flight",
        ),
        r"that lasts for",
        equation(lasts, turn / FREQUENCY, _returns(speed), "flight-time"),
        r"since its velocity and position are then",
        equation(end, SPEED, exact({end: speed.subs(at_end)}, _trigonometry)),
        equation(there, KINETIC / SPRING - HALF, exact({there: place.subs(at_end)}, _trigonometry)),
        r"and with the stick and the period",
        equation(held, 2 * HALF / SPEED, exact({held: _ride(SPEED)}), "ride"),
        equation(
            period,
            2 * HALF / SPEED + turn / FREQUENCY,
            exact({period: held + lasts, held: _ride(SPEED), lasts: turn / FREQUENCY}),
            "period",
        ),
        r"The positions are between $f/k - R$ and $f/k + R$ with",
        equation(
            swing,
            HALF**2 + SPEED**2 / FREQUENCY**2,
            exact({swing: (place - KINETIC / SPRING) ** 2 + (speed / FREQUENCY) ** 2}, sp.simplify),
            "swing",
        ),
        r"\end{theorem}",
        r"\begin{proof} The spring pulls the mass back until it needs the force $-s$, at",
        equation(
            named("x"),
            KINETIC / SPRING + HALF,
            exact({named("x"): HOLDING / SPRING, HOLDING: KINETIC + SPRING * HALF}),
        ),
        r"so that the mass slips downward there: \eqref{eq:stick_slip-flight}. A harmonic function "
        r"takes a value twice in a turn, so $\tau_f$ is the first return. The needed force is then",
        equation(needed, HOLDING - 2 * KINETIC, arriving, "arrival"),
        step(needed, "<", HOLDING, sign(arriving)),
        step(needed, ">", -HOLDING, sign(arriving)),
        r"so the mass sticks, and rides to the place where it slipped.\end{proof}",
        r"For $m = k = 1$, $V = \frac{1}{5}$, $f = \frac{1}{2}$ and $s = 1$ the period and the "
        r"largest position are",
        decimal(
            r"\mathcal{T}",
            _plain_period(_PLAIN),
            DECIMALS,
            close(lambda: _followed(_PLAIN).period, DECIMALS),
        ),
        decimal(
            r"x_{\max}",
            _plain_top(_PLAIN),
            DECIMALS,
            close(lambda: _followed(_PLAIN).top, DECIMALS),
        ),
        r"which Taylor series of the equation of motion, followed through one turn, confirm.",
    )


def _trigonometry(expr: Any) -> Any:
    """Return an expression with sines and cosines of 2(pi - atan q) in terms of q."""
    return sp.simplify(sp.expand_trig(sp.expand(expr)))


def _ride(speed: Any) -> Any:
    """Return how long a belt takes from f/k - a to f/k + a."""
    first, last = KINETIC / SPRING - HALF, KINETIC / SPRING + HALF
    (time,) = sp.solve(first + speed * tau - last, tau)
    return time


def _returns(speed: Any) -> Check:
    """Return the check that the velocity is V again after the time on the right, not before."""

    def check(statement: Step) -> StepEvidence:
        rest = _trigonometry(speed.subs(tau, statement.right) - SPEED)
        if rest != 0:
            raise StepError(str(statement), f"the velocity differs from V by {rest}")
        turn = sp.simplify(statement.right * FREQUENCY)
        for point in ({HALF: 2, FREQUENCY: 3, SPEED: 5}, {HALF: 7, FREQUENCY: 3, SPEED: 1}):
            if not 0 < sp.N(turn.subs(point)) < sp.N(2 * sp.pi):
                raise StepError(str(statement), "is not the first return")
        return StepEvidence("exact", "0")

    return check


def _all_motions() -> Items:
    """Return the items on all other motions without a damper."""
    ratio = HALF * FREQUENCY / SPEED
    above = -KINETIC / SPRING - (HALF - 2 * KINETIC / SPRING) * sp.cos(FREQUENCY * tau)
    above += SPEED / FREQUENCY * sp.sin(FREQUENCY * tau)
    # A flight above the belt has the friction -f; it starts where the one below ended.
    passed = named("x_p")
    returned = named("x_r")
    again = named("x_{p}'")
    ends = {returned: _flight_at().subs(tau, 2 * (sp.pi - sp.atan(ratio)) / FREQUENCY)}
    mirror = named(r"x(\tau)")
    other = (2 * KINETIC / SPRING - HALF) * FREQUENCY / SPEED
    upper = {again: above.subs(tau, -2 * sp.atan(other) / FREQUENCY)}
    more = sp.Symbol("epsilon_1", positive=True)
    beyond = {again: passed - 4 * KINETIC / SPRING, passed: (HOLDING + 2 * KINETIC + more) / SPRING}
    more_held = sp.Symbol("epsilon_2", positive=True)
    energy = named(r"\dot{W}")
    pulled = named("b")
    rates = {
        energy: 2 * (SPRING * x - KINETIC) * SPRING * v + 2 * m * SPRING * v * pulled,
        pulled: (KINETIC - SPRING * x) / m,
    }
    return (
        r"\begin{theorem}[where motions end]\label{thm:stick_slip-all} In the setting of "
        r"Theorem~\ref{thm:stick_slip-cycle} let $W = (k x - f)^2 + m k \dot{x}^2$. The motions "
        r"that start with $\dot{x} < V$ and $W < m k V^2$ are free oscillations and never meet the "
        r"belt. All others stick in finite time: from their first slip on they are the cycle. It "
        r"is the only periodic motion that meets the belt, and has the multipliers 1 and "
        r"0.\end{theorem}",
        r"\begin{proof} Below the belt $m\ddot{x} = f - k x$, and",
        equation(energy, 0, exact(rates), "invariant"),
        r"so motions with $W < m k V^2$ do not reach the velocity $V$. A motion with $W = m k V^2$ "
        r"touches the belt, and sticks by Theorem~\ref{thm:static_friction-graze}; those with a "
        r"larger $W$, and those that start above the belt, reach it. Let a mass pass the belt "
        r"downward at $x_p$. As in \eqref{eq:stick_slip-flight} with $a = x_p - f/k$ it is back at",
        equation(
            returned,
            2 * KINETIC / SPRING - passed,
            exact({**ends, passed: KINETIC / SPRING + HALF}, _trigonometry),
            "back",
        ),
        r"and if it passes the belt upward there, the flight above, with $a = x_p - f/k$,",
        equation(
            mirror,
            above,
            solves(
                -(FREQUENCY**2) * KINETIC / SPRING,
                2 * KINETIC / SPRING - (KINETIC / SPRING + HALF),
                SPEED,
                0,
                FREQUENCY**2,
            ),
            "above",
        ),
        r"brings it to the belt at",
        equation(
            again,
            passed - 4 * KINETIC / SPRING,
            exact({**upper, passed: KINETIC / SPRING + HALF}, _trigonometry),
            "again",
        ),
        r"which is lower than $x_p$ by the same length in each turn. So this ends. A mass passes "
        r"upward only where $-k x_r > s$, that is for $k x_p > s + 2f$, and then",
        step(again * SPRING, ">", -HOLDING, sign(_wider(beyond, more_held)), "not-below"),
        r"so that in the end it arrives with $|k x| \le s$ and sticks. The map from slip to slip "
        r"is constant: one multiplier is 0, and that along the motion is 1.\end{proof}",
        r"So the cycle attracts in the strongest sense, and yet its basin is bounded by motions "
        r"that just touch the belt: not by a cycle, but by the largest of the free oscillations.",
    )


def _wider(values: Meaning, more: Any) -> Meaning:
    """Return values in which static friction exceeds kinetic friction."""
    return {**values, HOLDING: KINETIC + more}


# --- with a damper ---


def _damped() -> Items:
    """Return the items on the cycle with a damper."""
    slip = named("x_s")
    needed = balance(x, SPEED, 0).subs({B0: 0, solution.A: 0, solution.k: SPRING}) * m
    (start,) = sp.solve(needed + HOLDING, x)
    gap = named(r"\dot{x}(\tau) - V")
    flown = -(SPRING * SPEED * E2 + (HOLDING - KINETIC) * E1) / m
    velocity = SPEED + flown
    launched = {x: start}
    below = balance(x, SPEED, 0).subs({B0: 0, solution.A: KINETIC, solution.k: SPRING})
    begin = named(r"\ddot{x}(0)")
    speed = named("V")
    change = named(r"\dot{Q}")
    rate = named(r"\ddot{x}")
    moving = named(r"\dot{x}")
    third = named(r"\dddot{x}")
    law = {third: -(c * rate + SPRING * moving) / m}
    arrival = sp.Symbol("epsilon_1", nonnegative=True)
    less = sp.Symbol("epsilon_2", positive=True)
    # at the return 0 <= acceleration < E
    arriving = {F(1): arrival, F(2): F(1) - JUMP, EXCESS: arrival + less}
    held = named(r"\tau_s")
    landing = named(r"\ddot{x}_f")
    (landed,) = sp.solve(below - landing, x)
    response = {name: value.xreplace(_FREQUENCIES) for name, value in _underdamped().items()}
    positive = sp.exp(-RATE * tau) * (sp.cos(TURN * tau) + RATE / TURN * sp.sin(TURN * tau))
    return (
        r"\subsection{With a damper}",
        r"Let everything be as in Theorem~\ref{thm:stick_slip-cycle}, but $c > 0$. A stick ends at",
        equation(slip, (HOLDING - c * SPEED) / SPRING, exact({slip: start}), "slip"),
        r"with the acceleration",
        equation(begin, -(HOLDING - KINETIC) / m, exact({begin: below, **launched}), "begin"),
        r"\begin{lemma}[the flight]\label{thm:stick_slip-gap} At the time $\tau$ after the slip, "
        r"as long as the mass is below the belt, in every regime of damping,",
        equation(gap, flown, _gap_check(velocity), "gap"),
        r"\end{lemma}",
        r"\begin{proof} The velocity obeys the unforced equation, begins with $V$ and has the rate "
        r"\eqref{eq:stick_slip-begin} there; its gap begins with 0. $E_1$ and $E_2$ are the "
        r"answers to a unit impulse and to a unit force.\end{proof}",
        r"\begin{theorem}[the cycle with a damper]\label{thm:stick_slip-damped} For $c \ge "
        r"2\sqrt{k m}$ no cycle meets the belt. For $0 < c < 2\sqrt{k m}$ there is a speed",
        equation(
            named("V^{*}"),
            (HOLDING - KINETIC) / SPRING * named(r"\max_\tau(-E_1/E_2)"),
            exact(
                {
                    named("V^{*}"): sp.solve(flown.subs(SPEED, speed), speed)[0],
                    named(r"\max_\tau(-E_1/E_2)"): -E1 / E2,
                }
            ),
            "largest",
        ),
        r"with the maximum over $\pi/\omega_d < \tau < 2\pi/\omega_d$. For $0 < V \le V^{*}$ there "
        r"is exactly one cycle that meets the belt. Its flight lasts until the first $\tau_f$ with "
        r"$k V E_2 + (s - f)E_1 = 0$; with the acceleration $\ddot{x}_f$ on arrival its stick "
        r"lasts for",
        equation(
            held,
            (HOLDING - KINETIC + m * landing) / (SPRING * SPEED),
            exact({held: (start - landed) / SPEED}),
            "damped-ride",
        ),
        r"Every motion that sticks once is this cycle from its first slip on: one multiplier is 0. "
        r"For $V > V^{*}$ there is no such cycle.\end{theorem}",
        r"\begin{proof} $E_2 > 0$ for $\tau > 0$, since it is $m/k$ times what is missing to 1 in "
        r"the free motion that starts at 1 at rest,",
        equation(
            1 - SPRING / m * E2,
            positive,
            exact(response, sp.simplify),
            note=r"$< 1$.",
            label="missing",
        ),
        r"For $c \ge 2\sqrt{k m}$ also $E_1 > 0$, and the gap stays negative. Otherwise $E_1 < 0$ "
        r"for $\pi/\omega_d < \tau < 2\pi/\omega_d$, and the gap vanishes there iff $k V/(s - f)$ "
        r"is a value of $-E_1/E_2$, which begins and ends with 0: iff $V \le V^{*}$. Later the "
        r"mass does not come back for the first time, since $Q = \ddot{x}^2 + "
        r"\frac{k}{m}\dot{x}^2$ has",
        equation(
            change,
            -2 * c * rate**2 / m,
            exact({change: 2 * rate * third + 2 * SPRING / m * moving * rate, **law}),
            "falls",
        ),
        r"so that each maximum of the velocity is lower than the one before. On arrival the "
        r"velocity is $V$ as at the slip, so that $0 \le \ddot{x}_f < (s - f)/m = E$. Then",
        step(F(1) + EXCESS, ">", 0, sign(arriving), "held-up"),
        step(F(2) - EXCESS, "<", 0, sign(arriving), "held-down"),
        r"and the mass sticks. All slips are at the same place, so that after one of them all "
        r"motions are one. A periodic motion that meets the belt but never sticks would pass it. "
        r"After a flight that begins at the belt with $\ddot{x}$, $Q$ says that it comes back with "
        r"a smaller $|\ddot{x}|$, and a passage makes it smaller by $2f/m$: this cannot repeat. "
        r"\end{proof}",
    )


_FREQUENCIES = {
    solution.cm: 2 * RATE,
    solution.w0sq: RATE**2 + TURN**2,
}


def _underdamped() -> Meaning:
    """Return the basis functions of an underdamped flight, and the spring that belongs to them."""
    wave = sp.exp(-RATE * tau) * sp.sin(TURN * tau) / TURN
    moment = sp.Symbol("u", real=True)
    step_response = sp.integrate(wave.subs(tau, moment), (moment, 0, tau))
    return {
        E1: wave,
        E0: wave.diff(tau),
        E2: step_response,
        SPRING: m * (RATE**2 + TURN**2),
        c: 2 * m * RATE,
    }


def _gap_check(velocity: Any) -> Check:
    """Return the check that V and the gap obey the unforced equation from the slip on."""

    def check(statement: Step) -> StepEvidence:
        whole = Step(statement.left, "=", SPEED + statement.right, statement.check)
        meaning = {SPRING: m * solution.w0sq}
        begin = -(HOLDING - KINETIC) / m
        return solves(0, SPEED, begin, meaning=meaning)(whole)

    return check


def _end() -> Items:
    """Return the items on the end of the cycle."""
    ratio = named(r"\psi")
    slope = named(r"\dot{\psi}")
    bend = named(r"\ddot{\psi}")
    relation = {E0: 1 - SPRING / m * E2 - c / m * E1}
    rule = {solution.cm: c / m, solution.w0sq: SPRING / m}
    first = solution.time_derivative(-E1 / E2).xreplace(rule)
    riccati = -1 / E2 + SPRING / m - c / m * ratio + ratio**2
    again = riccati.diff(ratio) * slope + riccati.diff(E2) * solution.rates()[E2]
    falling = named(r"\frac{d^2 V}{d\tau^2}")
    determinant = named(r"\det\Phi")
    volume = E0 * (1 - SPRING / m * E2) + SPRING / m * E1**2
    at_end = {E0: E1**2 / E2}
    way = named(r"\delta x")
    below = balance(x, SPEED, 0).subs({B0: 0, solution.A: KINETIC, solution.k: SPRING})
    needed = balance(x, SPEED, 0).subs({B0: 0, solution.A: 0, solution.k: SPRING}) * m
    return (
        r"\begin{theorem}[a discontinuous fold]\label{thm:stick_slip-end} Let $0 < c < 2\sqrt{k "
        r"m}$. At $V = V^{*}$ the flight of the cycle touches the belt: it arrives with "
        r"$\ddot{x}_f = 0$, at the only $\tau^{*}$ in $(\pi/\omega_d, 2\pi/\omega_d)$ with",
        equation(E0, sp.exp(-c * named(r"\tau^{*}") / m), _end_check(volume, at_end), "touch"),
        r"Below $V^{*}$ its duration is $\tau_f = \tau^{*} - \sqrt{2E_2(\tau^{*})(V^{*} - "
        r"V)/V^{*}}$ to leading order. The slip covers the way",
        equation(
            way,
            (HOLDING - KINETIC) / SPRING,
            exact({way: sp.solve(needed + HOLDING, x)[0] - sp.solve(below, x)[0]}),
            "way",
        ),
        r"at the end: the cycle does not shrink, its multiplier stays 0, and beyond $V^{*}$ it is "
        r"gone, while the rest has been stable all the time.\end{theorem}",
        r"\begin{proof} Let $\psi = -E_1/E_2$, so that $V = \psi(\tau_f)(s - f)/k$. With $E_0 = 1 "
        r"- \frac{k}{m}E_2 - \frac{c}{m}E_1$",
        equation(slope, riccati, exact({slope: first, ratio: -E1 / E2, **relation}, sp.simplify)),
        equation(
            bend,
            E1 / E2**2 + (2 * ratio - c / m) * slope,
            exact({bend: again}, sp.simplify),
            "bend",
        ),
        r"Where $\dot{\psi} = 0$ and $E_1 < 0$ thus $\ddot{\psi} = -\psi/E_2 < 0$: there is one "
        r"maximum, at $E_0 E_2 = E_1^2$. The determinant of the flight is",
        equation(determinant, volume, _determinant_check(), "volume"),
        r"and is $e^{-c\tau/m}$ by \eqref{eq:jacobians-det}; with $E_0 E_2 = E_1^2$ it is $E_0$. "
        r"There $V(\tau) = \psi(\tau)(s - f)/k$ has",
        equation(
            falling,
            -named("V^{*}") / E2,
            exact(
                {
                    falling: (HOLDING - KINETIC) / SPRING * (-ratio / E2),
                    named("V^{*}"): (HOLDING - KINETIC) / SPRING * ratio,
                }
            ),
            "root",
        ),
        r"which gives the root. The touch has $m\ddot{x} = f - c V - k x = 0$.\end{proof}",
        r"Motions that just touch the belt at $V^{*}$ stick and are the cycle; at a larger $V$ the "
        r"same start leads to the rest. Between the rest and the cycle there is no unstable cycle "
        r"with which the cycle could merge: what bounds the basin of the rest is the flight that "
        r"touches the belt. A fold of smooth cycles has a multiplier 1 and a partner; this end has "
        r"neither \cite{leine2004}.",
    )


def _end_check(volume: Any, at_end: Meaning) -> Check:
    """Return the check that the touch E0 E2 = E1^2 makes E0 the determinant of the flight."""
    decay = sp.exp(-c * named(r"\tau^{*}") / m)

    def check(statement: Step) -> StepEvidence:
        rest = sp.simplify(volume.xreplace(at_end) - at_end[E0])
        if statement.left != E0 or statement.right != decay or rest != 0:
            raise StepError(str(statement), f"{rest} remains")
        values = touch_by_newton(DAMPED)
        off = values.wave - CONTEXT.exp(-DAMPED.damping * values.time)
        if abs(off) > CONTEXT.mpf(10) ** -45:
            raise StepError(str(statement), f"is off by {off} in the example")
        return StepEvidence("exact", "0")

    return check


def _determinant_check() -> Check:
    """Return the check by the determinant of the matrix of a flight, whose entries are E's."""
    matrix = sp.Matrix([[1 - SPRING / m * E2, E1], [-SPRING / m * E1, E0]])
    return exact({named(r"\det\Phi"): matrix.det()})


# --- numbers ---


class Machine(NamedTuple):
    """An oscillator with m = 1 on one belt: its numbers."""

    damping: Any
    stiffness: Any
    speed: Any
    kinetic: Any
    holding: Any


class Turn(NamedTuple):
    """What a turn of a cycle has: durations of its flight and stick, and its largest position."""

    flight: Any
    stick: Any
    top: Any

    @property
    def period(self) -> Any:
        """The period of the cycle."""
        return self.flight + self.stick


_PLAIN = Machine(0, 1, CONTEXT.mpf(1) / 5, CONTEXT.mpf(1) / 2, 1)
DAMPED = Machine(CONTEXT.mpf(1) / 10, 1, None, CONTEXT.mpf(1) / 2, 1)
_PULLED = Machine(0, 2, CONTEXT.mpf(1) / 10, CONTEXT.mpf(1) / 2, CONTEXT.mpf(4) / 5)
_SPEEDS = ("1/10", "3/10", "1/2")


def _plain_period(machine: Machine) -> Any:
    """Return the period of the cycle without a damper, by the theorem."""
    turn = CONTEXT.sqrt(machine.stiffness)
    half = (machine.holding - machine.kinetic) / machine.stiffness
    flight = 2 * (CONTEXT.pi - CONTEXT.atan(half * turn / machine.speed)) / turn
    return 2 * half / machine.speed + flight


def _plain_top(machine: Machine) -> Any:
    """Return the largest position on the cycle without a damper, by the theorem."""
    half = (machine.holding - machine.kinetic) / machine.stiffness
    swing = CONTEXT.sqrt(half**2 + machine.speed**2 / machine.stiffness)
    return machine.kinetic / machine.stiffness + swing


@cache
def _followed(machine: Machine) -> Turn:
    """Return a turn of the cycle by Taylor series of the equation of motion."""
    below = LinearEquation(machine.damping, machine.stiffness, machine.kinetic)
    start = (machine.holding - machine.damping * machine.speed) / CONTEXT.mpf(machine.stiffness)
    begin = TimedState(0, start, machine.speed)
    top = first_pass(below, begin, lambda place, rate: rate < 0)
    landing = first_pass(below, begin, lambda place, rate: rate > machine.speed)
    return Turn(landing.time, (start - landing.value) / machine.speed, top.value)


class TouchingFlight(NamedTuple):
    """The flight that touches the belt: its duration, E_0 at its end, the speed of the belt."""

    time: Any
    wave: Any
    speed: Any


def _basis(machine: Machine, time: Any) -> tuple[Any, Any, Any]:
    """Return E0, E1 and E2 by their closed forms."""
    decay = machine.damping / 2
    turn = CONTEXT.sqrt(machine.stiffness - decay**2)
    size = CONTEXT.exp(-decay * time)
    wave = size * CONTEXT.sin(turn * time) / turn
    slope = size * CONTEXT.cos(turn * time) - decay * wave
    return slope, wave, (1 - slope - machine.damping * wave) / machine.stiffness


@cache
def touch_by_newton(machine: Machine) -> TouchingFlight:
    """Return the touch from E0 = exp(-c tau/m), by Newton's method."""
    time = CONTEXT.mpf("5.5")
    for _ in range(9):
        slope, wave, _ = _basis(machine, time)
        fallen = CONTEXT.exp(-machine.damping * time)
        bend = -machine.damping * slope - machine.stiffness * wave
        time -= (slope - fallen) / (bend + machine.damping * fallen)
    slope, wave, area = _basis(machine, time)
    excess = machine.holding - machine.kinetic
    return TouchingFlight(time, slope, -excess * wave / (machine.stiffness * area))


@cache
def _touch_by_series() -> TouchingFlight:
    """Return the touch by Taylor series, backward in time from the touch to the slip."""
    # The velocity in units of V: 1 with the rate 0 at the touch. Backward the damping is negative.
    backward = LinearEquation(-DAMPED.damping, DAMPED.stiffness)
    slip = first_pass(backward, TimedState(0, CONTEXT.mpf(1), CONTEXT.mpf(0)), lambda u, _: u > 1)
    return TouchingFlight(slip.time, None, (DAMPED.holding - DAMPED.kinetic) / slip.rate)


def flight_by_formula(machine: Machine) -> Turn:
    """Return the cycle of a damped machine from k V E2 + (s - f) E1 = 0."""
    excess = machine.holding - machine.kinetic
    pull = machine.stiffness * machine.speed
    touch = touch_by_newton(machine._replace(speed=None))

    def is_before(time: Any) -> bool:
        _, wave, area = _basis(machine, time)
        return bool(-excess * wave < pull * area)

    time = bisected(is_before, 3, touch.time)
    slope, wave, _ = _basis(machine, time)
    landing = -pull * wave - excess * slope
    stick = (excess + landing) / pull
    return Turn(time, stick, None)


def _numbers() -> Items:
    """Return the items on the damped cycle in numbers."""
    touch = touch_by_newton(DAMPED)
    rows = []
    for text in _SPEEDS:
        machine = DAMPED._replace(speed=number(sp.Rational(text).p) / sp.Rational(text).q)
        turn = flight_by_formula(machine)
        values = (turn.flight, turn.stick, turn.period)
        parts = ("flight", "stick", "period")
        cells = tuple(
            decimal(
                name, value, TABLE_DECIMALS, close(partial(_part, machine, part), TABLE_DECIMALS)
            )
            for name, value, part in zip((r"\tau_f", r"\tau_s", "T"), values, parts, strict=True)
        )
        rows.append((rf"${text}$", *cells))
    return (
        r"\begin{example}\label{thm:stick_slip-example} For $m = k = 1$, $c = \frac{1}{10}$, $f = "
        r"\frac{1}{2}$ and $s = 1$ the cycle ends with",
        decimal(
            r"\tau^{*}",
            touch.time,
            DECIMALS,
            close(lambda: _touch_by_series().time, DECIMALS),
        ),
        decimal(
            "V^{*}",
            touch.speed,
            DECIMALS,
            close(lambda: _touch_by_series().speed, DECIMALS),
        ),
        r"as Taylor series say too, which go backward from the touch to the slip. "
        r"Table~\ref{tab:stick_slip-cycles} has cycles at lower speeds.\end{example}",
        Table(
            "tab:stick_slip-cycles",
            r"Damped stick-slip cycles by Theorem~\ref{thm:stick_slip-damped}: flight, stick and "
            r"period, compared with Taylor series.",
            ("$V$", r"$\tau_f$", r"$\tau_s$", r"$\mathcal{T}$"),
            tuple(rows),
        ),
    )


def _part(machine: Machine, part: str) -> Any:
    """Return a part of a turn that was followed by Taylor series."""
    return getattr(_followed(machine), part)


# --- a pulled spring ---


def _pulled() -> Items:
    """Return the items on a block that is pulled by a spring."""
    path = sp.Function("X")(t)
    drag = named("T")
    force = SPRING * (SPEED * t - path) + drag
    seen = SPEED * t - path
    law = named(r"m\ddot{x}")
    speed = named(r"\dot{x} - V")
    way = named(r"\delta X")
    flight = 2 * (sp.pi - sp.atan(HALF * FREQUENCY / SPEED)) / FREQUENCY
    moved = SPEED * flight + 2 * HALF
    first = named(r"\tau_1")
    limit = named(r"\lim_{V \to 0}\delta X")
    return (
        r"\subsection{A pulled spring}",
        r"\begin{theorem}[the same cycle]\label{thm:stick_slip-pulled} Let a block at $X(t)$ on a "
        r"floor at rest, with kinetic friction $f$ and static friction $s$, be pulled by a spring "
        r"whose other end moves with the speed $V > 0$: $m\ddot{X} = k(V t - X) + T$ with the "
        r"friction $T$ of the floor. Then the extension $x = V t - X$ of the spring obeys",
        equation(
            law,
            -SPRING * x - drag,
            exact({law: (m * seen.diff(t, 2)).subs(path.diff(t, 2), force / m), x: seen}),
            "pulled",
        ),
        equation(speed, -named(r"\dot{X}"), exact(_relative(path, seen)), "relative"),
        r"and this is a mass on a belt with the speed $V$. So the block sticks and slips for ever, "
        r"in the cycle of Theorem~\ref{thm:stick_slip-cycle}. It moves in each slip by",
        equation(
            way,
            SPEED * named(r"\tau_f") + 2 * HALF,
            exact(
                {way: SPEED * (named(r"\tau_s") + named(r"\tau_f")), named(r"\tau_s"): _ride(SPEED)}
            ),
            "jump",
        ),
        r"which is $V\mathcal{T}$. From a relaxed spring the first stick lasts for",
        equation(
            first,
            HOLDING / (SPRING * SPEED),
            exact({first: sp.solve(SPRING * SPEED * tau - HOLDING, tau)[0]}),
            "first",
        ),
        r"and each later one for $\tau_s = 2(s - f)/(k V)$.\end{theorem}",
        r"\begin{proof} Put $X = V t - x$ into the equation of the block. Friction opposes "
        r"$\dot{X}$, and $-T$ opposes $\dot{x} - V$. While the block sticks, its spring grows by "
        r"$V\tau_s = 2a$; in a period it does not change.\end{proof}",
        r"As $V \to 0$",
        equation(limit, 2 * HALF, _limit_check(moved), "slow"),
        r"that is $2(s - f)/k$, the jump that textbooks have; it is longer at each $V > 0$. For $m "
        r"= 1$, $k = 2$, $V = \frac{1}{10}$, $f = \frac{1}{2}$ and $s = \frac{4}{5}$ the slip and "
        r"the period last for",
        decimal(
            r"\tau_f",
            _plain_period(_PULLED) - 3,
            DECIMALS,
            close(lambda: _followed(_PULLED).flight, DECIMALS),
        ),
        decimal(
            r"\mathcal{T}",
            _plain_period(_PULLED),
            DECIMALS,
            close(lambda: _followed(_PULLED).period, DECIMALS),
        ),
    )


def _relative(path: Any, seen: Any) -> Meaning:
    """Return the meanings of the velocity of the block, and of the extension relative to the belt."""
    return {named(r"\dot{x} - V"): seen.diff(t) - SPEED, named(r"\dot{X}"): path.diff(t)}


def _limit_check(moved: Any) -> Check:
    """Return the check that the right side is the limit of the jump for a slow pull."""

    def check(statement: Step) -> StepEvidence:
        rest = sp.limit(moved, SPEED, 0, "+") - statement.right
        if sp.simplify(rest) != 0:
            raise StepError(str(statement), f"the limit differs by {rest}")
        return StepEvidence("exact", "0")

    return check
