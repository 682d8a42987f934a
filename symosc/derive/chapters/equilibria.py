"""Rests of an oscillator without a drive, and where oscillations begin."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import sympy as sp

from symosc.derive.boundary_focus import (
    FOCUS,
    FocusCycle,
    focus_by_closed_forms,
    focus_by_series,
)
from symosc.derive.chapters.friction_curves import (
    DAMPING,
    FORCE,
    FREQUENCY,
    RATE,
    in_band,
)
from symosc.derive.chapters.motion import balance
from symosc.derive.scope import LOWER, UPPER, F, Scope
from symosc.derive.steps import (
    CONTEXT,
    Check,
    Items,
    cases,
    close,
    decimal,
    equation,
    exact,
    sign,
    solves,
    step,
)
from symosc.derive.taylor import LinearEquation, TimedState, after, bisected, first_pass
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, c, k, m, tau, v, x

TITLE = "Equilibria and onset"
#: Decimals of a cycle, and of the numbers of other authors that are printed.
DECIMALS = 24
PUBLISHED = 15
#: The friction of a belt at rest: kinetic and static; all other forces but the spring's.
KINETIC = sp.Symbol("f_lambda", positive=True)
HOLDING = sp.Symbol("s_lambda", positive=True)
OTHERS = named(r"H_\lambda")
#: A friction curve that falls exponentially, f_inf + f_1 exp(-w/w_0) + b w, and a belt's speed.
FAR, NEAR, WIDTH, VISCOUS, SPEED = sp.symbols("f_infty f_1 w_0 b V", positive=True)
#: A friction curve that falls and rises again, s - q_1 w + q_3 w^3.
FALL, RISE = sp.symbols("q_1 q_3", positive=True)
#: A corner's distance from the velocity 0, and the dampings on both of its sides.
DISTANCE = sp.Symbol("d", positive=True)
FIRST, SECOND = sp.symbols("c_1 c_2", real=True)


def items(scope: Scope) -> Items:
    """Yield the chapter: rests and their stability, the onset of oscillations in both kinds of law."""
    yield _in_a_band()
    yield _on_a_belt()
    yield _smooth()
    yield _published()
    yield _focus()
    yield _example()
    yield _only_one()


# --- rests ---


def _in_a_band() -> Items:
    """Return the items on the rest in a band, and its stability."""
    rest = named("x^{*}")
    first = named(r"\ell_1")
    second = named(r"\ell_2")
    exponent = sp.Symbol("ell")
    roots = sp.solve(m * exponent**2 + DAMPING * exponent + k, exponent)
    values = dict(zip((first, second), roots, strict=True))
    (place,) = sp.solve(in_band(DAMPING, FORCE, x, 0).subs(B0, 0), x)
    return (
        r"\subsection{Rests}",
        r"In this chapter $B_0 = 0$ and $k > 0$, and the law has any number of belts with friction "
        r"curves as in Chapter~\ref{sec:friction_curves}, and with static friction as in "
        r"Chapter~\ref{sec:static_friction}.",
        r"\begin{proposition}[a rest in a band]\label{thm:equilibria-rest} Let $\dot{x} = 0$ lie "
        r"inside band $j$. The mass can rest at",
        equation(rest, FORCE / k, exact({rest: place}), "rest"),
        r"only. The rest is asymptotically stable for $c_j > 0$, unstable for $c_j < 0$, and a "
        r"centre for $c_j = 0$.\end{proposition}",
        r"\begin{proof} $y = x - x^{*}$ obeys $m\ddot{y} + c_j\dot{y} + k y = 0$ near the rest. "
        r"Its characteristic roots have",
        equation(first + second, -DAMPING / m, exact(values, sp.simplify), "sum"),
        equation(first * second, k / m, exact(values, sp.simplify), "product"),
        r"so both real parts have the sign of $-c_j$.\end{proof}",
    )


def _beside_belt(friction: Any) -> Any:
    """Return the acceleration of a mass at the speed 0 of a belt that exerts the given friction."""
    return balance(x, 0, 0).subs({B0: 0, solution.A: OTHERS + friction})


def _on_a_belt() -> Items:
    """Return the items on the rests on a belt with the speed 0."""
    sides = {F(LOWER): _beside_belt(KINETIC), F(UPPER): _beside_belt(-KINETIC)}
    ends = [sp.solve(_beside_belt(-limit), x)[0] for limit in (-HOLDING, HOLDING)]
    low = named("x_-")
    high = named("x_+")
    length = named(r"\ell")
    size = sp.Symbol("epsilon_1", positive=True)
    less = sp.Symbol("epsilon_2", positive=True)
    # the needed force is epsilon_1 in size, on either side: less than f, and more than f
    held = [{**sides, x: (OTHERS + side * size) / k, KINETIC: size + less} for side in (1, -1)]
    beyond = {**sides, x: (OTHERS - KINETIC - less) / k}
    braking = sp.Symbol("a", positive=True)
    start = sp.Symbol("v_0", positive=True)
    way = named(r"\delta x")
    braked = start * tau - braking * tau**2 / 2
    stopped = {tau: sp.solve(braked.diff(tau), tau)[0]}
    return (
        r"\begin{proposition}[rests on a belt]\label{thm:equilibria-belt} Let belt $\lambda$ have "
        r"the speed 0, the kinetic friction $f_\lambda$ at the relative speed 0 and the static "
        r"limit $s_\lambda \ge f_\lambda$, and let $H_\lambda$ be the sum of $A_0$ and the "
        r"friction of all other belts at the velocity 0.\begin{enumerate}\item[(i)] The mass can "
        r"rest on the belt where $|H_\lambda - k x| \le s_\lambda$: at the positions between",
        equation(low, (OTHERS - HOLDING) / k, exact({low: ends[1]})),
        equation(high, (OTHERS + HOLDING) / k, exact({high: ends[0]})),
        r"an interval of the length",
        equation(length, 2 * HOLDING / k, exact({length: ends[0] - ends[1]}), "length"),
        r"\item[(ii)] A rest with $|H_\lambda - k x| < f_\lambda$ is stable: a motion that starts "
        r"nearby soon rests nearby, whatever the dampings of the bands are. It does not attract "
        r"the rests beside it.\item[(iii)] A rest with $f_\lambda < |H_\lambda - k x| \le "
        r"s_\lambda$ is unstable.\end{enumerate}\end{proposition}",
        r"\begin{proof} (i) By Lemma~\ref{thm:static_friction-held}; the needed force is "
        r"$H_\lambda - k x$ and does not change. (ii) Then",
        step(F(LOWER), ">", 0, cases(*map(sign, held)), "pulled-up"),
        step(F(UPPER), "<", 0, cases(*map(sign, held)), "pulled-down"),
        r"and by continuity $|\ddot{x}| \ge a$ with some $a > 0$, towards the velocity 0, near the "
        r"rest. A mass with the velocity $v_0$ there stops within $v_0/a$, after a way of at most",
        equation(way, start**2 / (2 * braking), exact({way: braked.subs(stopped)}), "way"),
        r"(iii) Let $H_\lambda - k x > f_\lambda$; the other case is its mirror image. Then",
        step(F(UPPER), ">", 0, sign(beyond), "pushed"),
        r"so that after a push upward, however small, the velocity grows until it has passed a "
        r"bound that does not depend on the push.\end{proof}",
    )


# --- a smooth law ---


def _smooth() -> Items:
    """Return the items on the onset in a law whose friction curve is smooth."""
    curve = sp.Function("f")
    relative = sp.Symbol("w", positive=True)
    speed = SPEED
    slope = named("f'(V)")
    bend = named("f''(V)")
    third = named("f'''(V)")
    values = {
        name: curve(relative).diff(relative, order).subs(relative, speed)
        for order, name in enumerate((slope, bend, third), 1)
    }
    damping = named("c_V")
    loss = named(r"r(\dot{x})")
    # what the damper and the belt take, relative to the rest, at a velocity v below the belt's
    taken = c * v - curve(speed - v) + curve(speed)
    near = (c + slope) * v - bend * v**2 / 2 + third * v**3 / 6
    power = named(r"\bar{P}")
    size = sp.Symbol("a", positive=True)
    angle = named(r"\varphi")
    swing = size * sp.cos(angle)
    mean = sp.integrate(sp.expand(near.subs(v, swing) * swing), (angle, 0, 2 * sp.pi)) / (2 * sp.pi)
    average = (c + slope) * size**2 / 2 + third * size**4 / 16
    square = named("a^2")
    (found,) = [root for root in sp.solve(mean / size**2, size**2) if root != 0]
    return (
        r"\subsection{The onset in a smooth law}",
        r"Let one belt have the speed $V > 0$ and a smooth friction curve $f(w)$, $f > 0$. At "
        r"velocities $\dot{x}$ below $V$ the friction on the mass is $f(V - \dot{x})$, and the "
        r"mass rests at $(A_0 + f(V))/k$. Relative to the rest, damper and belt take the force "
        r"$r(\dot{x}) = c\dot{x} - f(V - \dot{x}) + f(V)$,",
        equation(
            loss, near, _taylor(taken, values), "loss", note=r"and terms of the order $\dot{x}^4$."
        ),
        r"\begin{theorem}[onset in a smooth law]\label{thm:equilibria-smooth} The rest is stable "
        r"for $c_V > 0$ and unstable for $c_V < 0$, where",
        equation(damping, c + slope, exact({damping: taken.diff(v).subs(v, 0).doit()} | values)),
        r"At $c_V = 0$ and $f'''(V) \ne 0$ it has a Hopf bifurcation with the frequency $\omega_0 "
        r"= \sqrt{k/m}$. The cycle has the amplitude $a$ of the velocity with",
        equation(square, -8 * (c + slope) / third, exact({square: found}), "amplitude"),
        r"to leading order, on the side of the onset on which this is positive. It attracts for "
        r"$f'''(V) > 0$, and then the rest is unstable; it repels for $f'''(V) < 0$, and bounds "
        r"the basin of the rest.\end{theorem}",
        r"\begin{proof} The slope of $r$ at 0, $c_V$, is the damping of the linear equation, to "
        r"which Proposition~\ref{thm:equilibria-rest} applies. At $c_V = 0$ the roots are $\pm "
        r"i\omega_0$, and they pass the imaginary axis with $c_V$. The mean power that a harmonic "
        r"velocity $a\cos\varphi$ loses is",
        equation(power, average, exact({power: mean}), "power"),
        r"and the amplitude falls where it is positive. The term with $f''(V)$ does no work in the "
        r"mean; if it stands alone, the equation does not change when the time and the velocity "
        r"change their signs, so all motions near the rest close, and it adds nothing to the first "
        r"Lyapunov coefficient, which has the sign of $-f'''(V)$. The rest is Hopf's "
        r"theorem.\end{proof}",
        r"A refined curve of straight pieces brackets this speed between the two corners at which "
        r"$c_j$ changes its sign.",
    )


def _taylor(taken: Any, values: dict[Any, Any]) -> Check:
    """Return the check that the right side is the Taylor polynomial of degree 3 in v."""
    terms = [
        taken.diff(v, order).subs(v, 0).doit() * v**order / sp.factorial(order)
        for order in range(4)
    ]
    return exact({named(r"r(\dot{x})"): sp.Add(*terms)} | values)


def _falling(w: Any) -> Any:
    return FAR + NEAR * sp.exp(-w / WIDTH) + VISCOUS * w


def _rising(w: Any) -> Any:
    return sp.Symbol("s", positive=True) - FALL * w + RISE * w**3


def _published() -> Items:
    """Return the items on the onsets that two sources print."""
    onset = named(r"V_H")
    w = sp.Symbol("w", positive=True)
    balance_of_slopes = c + _falling(w).diff(w)
    (zero,) = sp.solve(balance_of_slopes, w)
    formula = WIDTH * sp.log(NEAR / (WIDTH * (VISCOUS + c)))
    square = named("a^2")
    slope = _falling(w).diff(w) + c
    third = _falling(w).diff(w, 3)
    beyond = sp.Symbol("epsilon", positive=True)
    # at V_H the exponential is known: f_1 exp(-V_H/w_0) = w_0 (b + c)
    at_onset = {w: formula + beyond}
    ahead = (-8 * slope / third).subs(at_onset)
    first_order = sp.simplify(sp.diff(ahead, beyond).subs(beyond, 0)) * (SPEED - onset)
    edge = named("V_1^2")
    cubic = sp.solve(c + _rising(w).diff(w), w**2)[0]
    whole = (-8 * (c + _rising(w).diff(w)) / _rising(w).diff(w, 3)).subs(w, SPEED)
    half = sp.Rational(1, 2)
    bstab = {NEAR: half, WIDTH: half, VISCOUS: 0, c: sp.Rational(1, 10)}
    lathe = {
        NEAR: 4,
        WIDTH: sp.Rational(1, 10),
        VISCOUS: sp.Rational(1, 5),
        c: sp.Rational("5.746"),
    }
    turning = sp.sqrt(6957 / sp.Rational("0.538"))
    return (
        r"\begin{example}[published onsets]\label{thm:equilibria-published} For $f(w) = f_\infty + "
        r"f_1 e^{-w/w_0} + b w$ the onset is at",
        equation(onset, formula, exact({onset: zero}, sp.simplify), "exponential"),
        r"and $f''' < 0$: the cycle exists beside the stable rest, at speeds above $V_H$, and to "
        r"leading order",
        equation(square, 8 * WIDTH * (SPEED - onset), exact({square: first_order}), "beside"),
        r"For $f(w) = \frac{1}{2} + \frac{1}{2}e^{-2w}$ and $c = \frac{1}{10}$ \cite{stender2022}, "
        r"and for $f_1 = 4$, $w_0 = \frac{1}{10}$, $b = \frac{1}{5}$, $c = 5.746$, $m = 0.538$ and "
        r"$k = 6957$ \cite{veraszto2017} this is",
        decimal(
            r"\tfrac{1}{2}\ln 10",
            sp.N(formula.subs(bstab), 60)._to_mpmath(CONTEXT.prec),
            PUBLISHED,
            close(partial(_onset_by_bisection, bstab), PUBLISHED),
        ),
        decimal(
            r"V_H",
            sp.N(formula.subs(lathe), 60)._to_mpmath(CONTEXT.prec),
            PUBLISHED,
            close(partial(_onset_by_bisection, lathe), PUBLISHED),
        ),
        decimal(
            r"\omega_0",
            sp.N(turning, 60)._to_mpmath(CONTEXT.prec),
            10,
            close(_turn_frequency, 10),
        ),
        r"For $f(w) = s - q_1 w + q_3 w^3$ \cite{thomsen2003} the rest is unstable below $V_1$, "
        r"with",
        equation(edge, (FALL - c) / (3 * RISE), exact({edge: cubic}), "cubic"),
        equation(square, 4 * (edge - SPEED**2), exact({square: whole, edge: cubic}), "cubic-size"),
        r"and a stable cycle is born there.\end{example}",
    )


def _onset_by_bisection(values: dict[Any, Any]) -> Any:
    """Return where the numeric derivative of the force on the mass by its velocity changes sign."""
    low, high, slow, drag = (
        CONTEXT.mpf(sp.Rational(values[letter]).p) / sp.Rational(values[letter]).q
        for letter in (NEAR, WIDTH, VISCOUS, c)
    )
    small = CONTEXT.mpf(10) ** -20

    def force(speed: Any, velocity: Any) -> Any:
        w = speed - velocity
        return low * CONTEXT.exp(-w / high) + slow * w - drag * velocity

    def grows(speed: Any) -> bool:
        return bool(force(speed, small) > force(speed, -small))

    return bisected(grows, "0.01", 3)


def _turn_frequency() -> Any:
    """Return the frequency at which the Taylor series of x'' = -(k/m) x comes back after a turn."""
    square = CONTEXT.mpf(6957) / CONTEXT.mpf("0.538")
    begin = TimedState(0, CONTEXT.mpf(0), CONTEXT.mpf(1))
    # A quarter of a turn after the start the rate vanishes; time in units of 1/100.
    unit = LinearEquation(0, square / 10000)
    quarter = bisected(lambda time: after(unit, begin, time).rate > 0, 1, 2)
    return 50 * CONTEXT.pi / quarter


# --- a law of straight pieces ---


def _focus() -> Items:
    """Return the items on the cycle that is born at a corner."""
    scale = sp.Symbol("epsilon", positive=True)
    place = named("y")
    speed = named(r"\dot{y}")
    bend = named(r"\ddot{y}")
    above = named(r"m\ddot{y} + c_2\dot{y} + k y")
    (rest,) = sp.solve(in_band(FIRST, FORCE, x, 0).subs(B0, 0), x)
    upper = FORCE - (FIRST - SECOND) * DISTANCE
    forces = m * in_band(SECOND, upper, rest + place, speed).subs(B0, 0)
    start = named("a")
    launched = sp.exp(-RATE * tau) * (
        sp.cos(FREQUENCY * tau) + (start + RATE) / FREQUENCY * sp.sin(FREQUENCY * tau)
    )
    stiffness = RATE**2 + FREQUENCY**2
    rate = sp.exp(-RATE * tau) * (
        start * sp.cos(FREQUENCY * tau)
        - (k / m + RATE * start) / FREQUENCY * sp.sin(FREQUENCY * tau)
    )
    corner = m * bend + FIRST * speed + k * place
    (at_corner,) = sp.solve(corner.subs({bend: start * DISTANCE, speed: DISTANCE}), place)
    known = named(r"\ddot{y}/d")
    position = named("y/d")
    largest = named(r"\dot{y}/d")
    scaled = named(r"\epsilon\,(m\ddot{y} + c_2\dot{y} + k y)")
    return (
        r"\subsection{The onset at a corner}",
        r"In a law of straight pieces the rest loses its stability when the speed of a belt moves "
        r"a corner over the velocity 0.",
        r"\begin{theorem}[a cycle is born at a corner]\label{thm:equilibria-focus} Let $B_0 = 0$, "
        r"$k > 0$, let band 1 contain the velocity 0, and let a corner at the velocity $d > 0$ "
        r"separate it from band 2. Let $y = x - x^{*}$, and let both bands be underdamped. While a "
        r"motion stays in them, $m\ddot{y} + c_1\dot{y} + k y = 0$ for $\dot{y} \le d$, and for "
        r"$\dot{y} \ge d$",
        equation(
            above,
            (SECOND - FIRST) * DISTANCE,
            exact({above: forces + SECOND * speed + k * place}),
            "focus",
        ),
        r"\begin{enumerate}\item[(i)] If $y$ is a motion for $d$, then $\epsilon y$ is one for "
        r"$\epsilon d$: a cycle that is born when the corner passes the velocity 0 has an "
        r"amplitude proportional to $d$, and a period and a multiplier that do not depend on "
        r"$d$.\item[(ii)] A flight that leaves the corner with $\ddot{y} = a d$ has, with $h$ and "
        r"$\omega_d$ of its band,",
        equation(
            largest,
            launched,
            solves(0, 1, start, 2 * RATE, stiffness),
            "launched",
        ),
        equation(
            known,
            rate,
            exact({known: launched.diff(tau), k: m * stiffness}, sp.simplify),
            "launched-rate",
        ),
        r"and leaves it at the position",
        equation(position, -(m * start + FIRST) / k, exact({position: at_corner / DISTANCE}), "at"),
        r"\item[(iii)] A cycle goes from the corner upward with $a_2 > 0$, comes back after "
        r"$\tau_2$ with $a_1 < 0$, and is closed by a flight below the corner that lasts for "
        r"$\tau_1$ and ends with $a_2$. Its multiplier is $e^{-(c_1\tau_1 + "
        r"c_2\tau_2)/m}$.\end{enumerate}\end{theorem}",
        r"\begin{proof} \eqref{eq:friction_curves-joined} gives \eqref{eq:equilibria-focus}. (i) "
        r"Both equations and the corner are homogeneous in $y$ and $d$:",
        equation(
            scaled,
            (SECOND - FIRST) * scale * DISTANCE,
            exact({scaled: scale * (m * bend + SECOND * speed + k * place), bend: _bend()}),
            "scaled",
        ),
        r"(ii) $\dot{y}$ obeys the unforced equation of each band, and begins with $d$ and $a d$; "
        r"at the corner both bands have the same acceleration. (iii) One multiplier is 1, along "
        r"the motion, and the product of both is \eqref{eq:friction_curves-area}.\end{proof}",
    )


def _bend() -> Any:
    """Return the acceleration above the corner, from the equation of the theorem."""
    return ((SECOND - FIRST) * DISTANCE - SECOND * named(r"\dot{y}") - k * named("y")) / m


def _example() -> Items:
    """Return the items on the cycle at a corner in numbers."""
    exact_cycle = focus_by_closed_forms()
    return (
        r"\begin{example}[an unstable cycle]\label{thm:equilibria-example} Let $m = k = 1$, $c_1 = "
        r"\frac{1}{10}$ and $c_2 = -\frac{3}{10}$. The three equations of (iii) have the solution",
        decimal("a_2", exact_cycle.start, DECIMALS, _seen(lambda cycle: cycle.start)),
        decimal(r"\tau_2", exact_cycle.times[0], DECIMALS, _seen(lambda cycle: cycle.times[0])),
        decimal(r"\tau_1", exact_cycle.times[1], DECIMALS, _seen(lambda cycle: cycle.times[1])),
        r"so that the cycle has the period, the largest velocity, the position where it passes the "
        r"corner upward, and the multiplier",
        decimal(
            r"\tau_1 + \tau_2",
            sum(exact_cycle.times),
            DECIMALS,
            _seen(lambda cycle: sum(cycle.times)),
        ),
        decimal(r"\dot{y}_{\max}/d", exact_cycle.top, DECIMALS, _seen(lambda cycle: cycle.top)),
        decimal(
            "y/d",
            -exact_cycle.start - FOCUS[0],
            DECIMALS,
            _seen(lambda cycle: -(cycle.start + FOCUS[0])),
        ),
        decimal(r"\rho", exact_cycle.factor, 11, _seen(lambda cycle: cycle.factor, 11)),
        r"Taylor series of both equations, followed from corner to corner, have the same fixed "
        r"point, and differences of their map the same multiplier. It exceeds 1: the cycle repels, "
        r"and bounds the basin of the rest, which shrinks to nothing with $d$. The cycle ends "
        r"where its largest velocity reaches a belt.\end{example}",
        r"With $-c_1$ and $-c_2$ time runs backward, $\tilde{y}(t) = -y(-t)$ has the same "
        r"velocities, and the cycle attracts: then the rest repels, and a stable cycle is born "
        r"with an amplitude proportional to $d$, not to its root as in a smooth law.",
    )


def _seen(part: Callable[[FocusCycle], Any], decimals: int = DECIMALS) -> Check:
    """Return the check that a decimal is what Taylor series have for a part of the cycle."""
    return close(lambda: part(focus_by_series()), decimals)


def _only_one() -> Items:
    """Return the items on when the cycle exists, and why it is the only one."""
    scale = sp.Symbol("epsilon", positive=True)
    wider = sp.Symbol("epsilon_1", positive=True)
    fall = sp.Symbol("epsilon_2", positive=True)
    above = sp.Symbol("epsilon_3", positive=True)
    dampings = {FIRST: SECOND + fall}
    force = named(r"\hat{r}(\dot{y})")
    scaled = named(r"\hat{r}(\epsilon\dot{y})")
    both_above = {
        force: FIRST * DISTANCE + SECOND * above,
        scaled: FIRST * DISTANCE + SECOND * (scale * (DISTANCE + above) - DISTANCE),
        scale: 1 + wider,
        **dampings,
    }
    # the velocity is below the corner, and epsilon times it is above
    one_above = {
        force: FIRST * (DISTANCE + above) / scale,
        scaled: FIRST * DISTANCE + SECOND * above,
        **dampings,
    }
    half = sp.exp(-RATE * tau) * (
        sp.cos(FREQUENCY * tau) + RATE / FREQUENCY * sp.sin(FREQUENCY * tau)
    )
    opposite = named(r"y(\pi/\omega_d)/y(0)")
    place = named(r"y/y(0)")
    limit = _limit()
    return (
        r"\begin{theorem}[the cycle at a corner is the only one]\label{thm:equilibria-only} Let "
        r"$c_1 > 0 > c_2$ be the dampings below and above a corner at $d > 0$, both bands "
        r"underdamped with $h_1$, $\omega_1$ and $h_2$, $\omega_2$, and let there be no other "
        r"edge. A motion that starts at $y = -a$ with $\dot{y} = 0$ comes back to $\dot{y} = 0$, "
        r"upward, at $y = -P(a)$. Then $P(a)/a$ never falls; it is $e^{-2\pi h_1/\omega_1} < 1$ "
        r"for small $a$, it rises strictly from where the motion passes the corner, and tends to "
        r"$q = e^{-\pi(h_1/\omega_1 + h_2/\omega_2)}$. So there is a cycle iff $q > 1$; it is the "
        r"only one, and it repels on both sides.\end{theorem}",
        r"\begin{proof} Let $\hat{r}$ be the force of damper and friction relative to the rest: "
        r"$c_1\dot{y}$ up to the corner and $c_1 d + c_2(\dot{y} - d)$ above. For $\epsilon > 1$",
        step(scaled, "<", scale * force, cases(sign(both_above), sign(one_above)), "outward"),
        r"if $\epsilon\dot{y} > d$, and both are equal otherwise. Stretch a turn of a motion in "
        r"the plane of $y$ and $\dot{y}$ by $\epsilon$. A motion that meets the stretched curve "
        r"has there a larger acceleration than the curve has, so that it goes outward or along it: "
        r"the motion from $-\epsilon a$ stays outside, and $P(\epsilon a) \ge \epsilon P(a)$, with "
        r"$>$ if its turn passes the corner. Small motions stay in one band. In the limit of large "
        r"ones the corner is at the velocity 0, and each half of a turn belongs to one band, in "
        r"which",
        equation(place, half, solves(0, 1, 0, 2 * RATE, RATE**2 + FREQUENCY**2), "half"),
        equation(
            opposite,
            -sp.exp(-sp.pi * RATE / FREQUENCY),
            exact({opposite: half.subs(tau, sp.pi / FREQUENCY)}, sp.simplify),
            "opposite",
        ),
        r"A cycle has $P(a) = a$. Below this $a$ motions go inward, above it outward.\end{proof}",
        r"For $d = 0$ the corner lies at the rest, and $P(a) = q a$ for all $a$: the rest is "
        r"asymptotically stable for $q < 1$ and unstable for $q > 1$, whatever the signs of $c_1$ "
        r"and $c_2$ are. In the example",
        decimal("q", limit, DECIMALS, close(_limit_by_series, DECIMALS)),
        r"so that the cycle exists.",
    )


def _limit() -> Any:
    """Return by how much a large motion grows in a turn, by the formula."""
    total = CONTEXT.mpf(0)
    for damping in FOCUS:
        decay = damping / 2
        total += decay / CONTEXT.sqrt(1 - decay**2)
    return CONTEXT.exp(-CONTEXT.pi * total)


def _limit_by_series() -> Any:
    """Return the same by Taylor series of both halves of a turn."""
    lower, upper = (LinearEquation(damping, 1) for damping in FOCUS)
    highest = first_pass(
        upper, TimedState(0, -CONTEXT.mpf(1), CONTEXT.mpf(0)), lambda y, rate: rate < 0
    )
    begin = TimedState(0, highest.value, CONTEXT.mpf(0))
    return -first_pass(lower, begin, lambda y, rate: rate > 0).value
