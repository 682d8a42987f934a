"""Static friction above kinetic friction: what holds a mass, and which theorems remain."""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy as sp

from symosc.derive.chapters.motion import HELD, MU, balance, newton, stick_force
from symosc.derive.scope import BELTS, LOWER, UPPER, F, Scope, mu_lambda, v_lambda
from symosc.derive.steps import (
    CONTEXT,
    DIFFERENT,
    Check,
    Items,
    Step,
    StepError,
    StepEvidence,
    Table,
    cases,
    close,
    decimal,
    equation,
    evaluate,
    exact,
    points,
    sign,
    step,
)
from symosc.derive.taylor import bisected
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, FN, Omega, c, k, m, t, t_i, tau, theta, v, x, x_i

TITLE = "Static friction"
#: By how much static friction exceeds kinetic friction, and kinetic friction twice, per mass.
EXCESS = sp.Symbol("E", positive=True)
JUMP = sp.Symbol("J", nonnegative=True)
STATIC = sp.Symbol(r"\mu_{s\lambda}", nonnegative=True)
STATICS = {belt: sp.Symbol(rf"\mu_{{s{belt}}}", nonnegative=True) for belt in (1, 2)}
SIDE = sp.Symbol(r"\sigma", real=True)
#: By how much a force falls on a belt per unit of time: (k v_lambda + B_0 Omega sin theta)/m.
FALL = named("b")
#: A spring, and the kinetic and the static limit of a belt.
SPRING = sp.Symbol("k", positive=True)
KINETIC = sp.Symbol("f", positive=True)
HOLDING = sp.Symbol("s", positive=True)
DECIMALS = 12


def items(scope: Scope) -> Items:
    """Yield the chapter: the law, its events, uniqueness, derivatives, what remains."""
    yield _law(scope)
    yield _slips(scope)
    yield _grazes()
    yield _counts()
    yield _unique()
    yield _saltation()
    yield _what_remains()


def _at_static_limit(belt: int, side: int) -> dict[Any, Any]:
    """Return the position on a belt at which the needed force is what the belt can hold.

    `side` is +1 where the mass is about to leave upward.
    """
    limit = side * STATICS[belt] * FN
    (place,) = sp.solve(stick_force(belt) - limit, x)
    return {x: place}


def _law(scope: Scope) -> Items:
    """Return the items on the law, and on what happens at the speed of a belt."""
    below = F(LOWER) + EXCESS
    above = F(UPPER) - EXCESS
    apart = named(r"(F^{(\lambda)} + E) - (F^{(\lambda+1)} - E)")
    checks = []
    jumps = []
    for belt in scope.boundaries:
        lower, upper = (newton(alpha).subs(v, BELTS[belt]) for alpha in (belt, belt + 1))
        excess = (STATICS[belt] - MU[belt]) * FN / m
        names = {F(LOWER): lower, F(UPPER): upper, EXCESS: excess, STATIC: STATICS[belt]}
        checks.append(exact({HELD: stick_force(belt), **names}))
        jumps.append(exact({apart: below - above, JUMP: 2 * MU[belt] * FN / m, **names}))
    needed = cases(*checks)
    excess = (STATIC - mu_lambda) * FN / m
    return (
        r"\subsection{The law}",
        r"In the chapters before, a belt holds a mass with the force at which it slides. Most "
        r"surfaces hold more. Let belt $\lambda$ have a \emph{static} coefficient $\mu_{s\lambda} "
        r"\ge \mu_\lambda$ besides its kinetic coefficient $\mu_\lambda$, and let",
        equation(EXCESS, excess, excess, "E"),
        r"be the excess of static over kinetic friction per mass, each belt its own. As before $J = "
        r"2\mu_\lambda F_N/m$. For $E = 0$ everything below is what the other chapters state.",
        r"\begin{definition}[static friction]\label{thm:static_friction-law} While $\dot{x} \ne "
        r"v_\lambda$, belt $\lambda$ exerts the kinetic friction $|T_\lambda| = \mu_\lambda F_N$ on "
        r"the mass, against its sliding. While the mass sticks to it, $T_\lambda$ is whatever is "
        r"needed, up to $|T_\lambda| \le \mu_{s\lambda} F_N$. A \emph{motion} consists of flights "
        r"and sticks and has a continuous velocity. Where its velocity is that of a belt, it sticks "
        r"if the belt can hold it for some time from then on, and it sticks \emph{for as long as "
        r"the belt can hold it}.\end{definition}",
        r"This is what is meant by stiction: an arriving mass sticks also when the needed force is "
        r"between the kinetic and the static limit. Filippov's rule, with the velocity in "
        r"between, would allow kinetic friction only, and let such a mass pass: that is "
        r"another model.",
        r"\begin{lemma}[what a belt can hold]\label{thm:static_friction-held} With the force "
        r"$F_{s\lambda}$ of Proposition~\ref{thm:motion-held} and the accelerations "
        r"$F^{(\lambda)}$, $F^{(\lambda+1)}$ with kinetic friction,",
        equation(m * below, HELD + STATIC * FN, needed, "below"),
        equation(m * above, HELD - STATIC * FN, needed, "above"),
        equation(apart, JUMP + 2 * EXCESS, cases(*jumps), "difference"),
        r"so that $|F_{s\lambda}| \le \mu_{s\lambda} F_N$ iff $F^{(\lambda)} + E \ge 0 \ge "
        r"F^{(\lambda+1)} - E$.\end{lemma}",
        r"\begin{proof} By \eqref{eq:motion-held-sides} $m F^{(\lambda)} = F_{s\lambda} + "
        r"\mu_\lambda F_N$; add $mE$. The other side is its mirror image.\end{proof}",
        r"\begin{theorem}[Theorems 4 and 5 with static "
        r"friction]\label{thm:static_friction-cases} Let a motion have $\dot{x} = v_\lambda$ at a "
        r"time $t_m$. \begin{enumerate}\item[(i)] It sticks if $F^{(\lambda)} > -E$ and "
        r"$F^{(\lambda+1)} < E$. \item[(ii)] It goes above if $F^{(\lambda+1)} > E$, and below if "
        r"$F^{(\lambda)} < -E$. \item[(iii)] If $F^{(\lambda+1)} = E > 0$ or $F^{(\lambda)} = -E < "
        r"0$, the first derivative of this force during a stick that does not vanish at $t_m$ takes "
        r"its part; if all vanish, it sticks.\end{enumerate}\end{theorem}",
        r"\begin{proof} (i) By Lemma~\ref{thm:static_friction-held} the belt can hold the mass for "
        r"some time, and so it does. (ii) It cannot hold it. For $F^{(\lambda+1)} > E \ge 0$ "
        r"\eqref{eq:motion-jump} gives $F^{(\lambda)} > 0$ too: no flight goes below, and one goes "
        r"above. (iii) On the belt $F^{(\lambda+1)}$ is analytic in time, so that its first "
        r"derivative that does not vanish decides whether the belt can hold the mass for some time. "
        r"If it cannot, $\ddot{x} = F^{(\lambda+1)} = E > 0$ leads above.\end{proof}",
        r"In one sentence: static friction replaces the forces by $F^{(\lambda)} + E$ and "
        r"$F^{(\lambda+1)} - E$ wherever the question is whether the mass sticks. While it "
        r"slides, nothing changes: the flights, and the equations of all mappings but those of "
        r"the ends of sticks, are those of Chapters~\ref{sec:domains} and~\ref{sec:maps}.",
    )


def _slips(scope: Scope) -> Items:
    """Return the items on the ends of sticks."""
    rates = []
    for belt in scope.boundaries:
        on_belt = {x: x_i + v_lambda * (t - t_i)}
        needed = stick_force(belt).subs(BELTS[belt], v_lambda).subs(on_belt)
        rates.append(exact({named(r"\dot{F}_{s\lambda}"): needed.diff(t).subs(Omega * t, theta)}))
    starts = []
    rows = []
    for belt in scope.boundaries:
        for side in (1, -1):
            alpha = belt + (side > 0)
            left_at = newton(alpha).subs(v, BELTS[belt]).subs(_at_static_limit(belt, side))
            excess = (STATICS[belt] - MU[belt]) * FN / m
            starts.append(exact({named(r"\ddot{x}"): left_at, SIDE: side, EXCESS: excess}))
            rows.append(_exit_row(belt, side))
    return (
        r"\subsection{Slips}",
        r"\begin{theorem}[both exits of a stick]\label{thm:static_friction-exits} A stick on belt "
        r"$\lambda$ ends at the first time at which $F^{(\lambda)} + E$ falls below 0, and then the "
        r"mass goes into $\Omega_\lambda$; or at which $F^{(\lambda+1)} - E$ rises above 0, and "
        r"then it goes into $\Omega_{\lambda+1}$. With $\sigma = 1$ for an exit upward and $\sigma "
        r"= -1$ for one downward, the flight begins with the acceleration",
        equation(named(r"\ddot{x}"), SIDE * EXCESS, cases(*starts), "start"),
        r"while on the belt it was 0. The forces that decide change at the rate",
        equation(
            named(r"\dot{F}_{s\lambda}"),
            -(k * v_lambda + B0 * Omega * sp.sin(theta)),
            cases(*rates),
            "rate",
        ),
        r"of \eqref{eq:sticks-rate}, so an exit upward has $k v_\lambda + B_0\Omega\sin\theta \le "
        r"0$ and one downward $k v_\lambda + B_0\Omega\sin\theta \ge 0$: the phases at which a "
        r"mass can slip do not depend on $\mu_{s\lambda}$.\end{theorem}",
        r"\begin{proof} At the exit upward $F_{s\lambda} = \mu_{s\lambda} F_N$ by "
        r"\eqref{eq:static_friction-above}; put its position into \eqref{eq:motion-acceleration}. "
        r"$E$ is constant, so it leaves no trace in the rate.\end{proof}",
        r"The force of friction falls from $\mu_{s\lambda} F_N$ to $\mu_\lambda F_N$ at a slip. "
        r"Table~\ref{tab:static_friction-exits} replaces Table~\ref{tab:sticks-exits}: in the "
        r"paper's (52) and (53) the friction coefficient of the belt that the mass leaves becomes "
        r"its static one.",
        Table(
            "tab:static_friction-exits",
            r"What vanishes at the end of a stick with static friction, and into which domain the "
            r"mass goes.",
            ("belt", "into", "what vanishes", "its formula at $\\dot{x} = v_\\lambda$"),
            tuple(rows),
        ),
    )


def _exit_row(belt: int, side: int) -> tuple[Any, ...]:
    """Return a row of the table of exits: what vanishes at a belt, and its formula."""
    alpha = belt + (side > 0)
    held = stick_force(belt) - side * STATICS[belt] * FN
    formula = sp.expand(held.subs(Omega * t, theta))
    sliding = m * newton(alpha).subs(v, BELTS[belt]).subs(Omega * t, theta)
    value = sliding - side * (STATICS[belt] - MU[belt]) * FN
    name = named(rf"m(F^{{({alpha})}} {'-' if side > 0 else '+'} E)")
    shown = equation(name, formula, {name: value})
    return str(belt), rf"$\Omega_{alpha}$", f"${name.name}$", shown


def _grazes() -> Items:
    """Return the items on touches of a belt with static friction."""
    turn = {F(LOWER): 0, F(UPPER): F(LOWER) - JUMP}
    mirrored = {F(UPPER): 0, F(LOWER): F(UPPER) + JUMP}
    angle = sp.Symbol(r"\theta_m", real=True)
    length = named(r"\tau_e")
    first = EXCESS / FALL
    second = -B0 * Omega**2 * sp.cos(angle) * EXCESS**2 / (2 * m * FALL**3)
    slope = (k * v_lambda + B0 * Omega * sp.sin(angle)) / m
    force = EXCESS + _along_belt(angle, tau)
    missed = sp.Symbol("epsilon", positive=True)
    path = sp.Rational(1, 2) + 2 * (1 - missed) * sp.cos(t / 2)
    place = named("x(t)")
    flown = named(r"\ddot{x}(t) + x(t)")
    drive = sp.Rational(1, 2) + sp.Rational(3, 2) * (1 - missed) * sp.cos(t / 2)
    moving = named(r"\dot{x}(t)")
    held = named(r"F_{s\lambda}(\tau)")
    # On the belt from t = 3 pi on: the drive and the spring; the belt runs with the speed 1.
    on_belt = (
        sp.expand_trig(sp.Rational(3, 2) * sp.cos((3 * sp.pi + tau) / 2)) - sp.Rational(1, 2) - tau
    )
    left = _first_slip_of_the_example()
    return (
        r"\subsection{Grazes}",
        r"\begin{theorem}[a graze is the onset of a stick]\label{thm:static_friction-graze} Let a "
        r"flight of $\Omega_\lambda$ touch the speed of belt $\lambda$ from below, $F^{(\lambda)} = "
        r"0 > G^{(1,\lambda)}$, as in Theorem~6. Then",
        step(F(LOWER) + EXCESS, ">", 0, sign(turn), "touch-below"),
        step(F(UPPER) - EXCESS, "<", 0, sign(turn), "touch-above"),
        r"so that for $E > 0$ the mass sticks, and likewise after a touch from above, where",
        step(F(LOWER) + EXCESS, ">", 0, sign(mirrored)),
        step(F(UPPER) - EXCESS, "<", 0, sign(mirrored)),
        r"The phases and the window of such touches are those of "
        r"Theorem~\ref{thm:grazing-theorem7}.\end{theorem}",
        r"\begin{proof} Put the touch into \eqref{eq:motion-jump}. Theorem~7 asks which flights "
        r"reach $\dot{x} = v_\lambda$ with $F^{(\alpha)} = 0$ and turn back; flights, "
        r"\eqref{eq:switching-decides} and the critical phases contain neither $E$ nor "
        r"$\mu_{s\lambda}$.\end{proof}",
        r"So Theorem 7 answers another question: at these phases a flight that arrives with the "
        r"acceleration 0 begins to stick. An event that is only a touch exists at belts with $E = "
        r"0$ alone.",
        r"\begin{corollary}[how long such a stick lasts]\label{thm:static_friction-length} Let the "
        r"touch be from below, at the phase $\theta_m$, and let $b = (k v_\lambda + "
        r"B_0\Omega\sin\theta_m)/m > 0$. The stick lasts for the time",
        equation(length, first + second, _expands(force, {FALL: slope}, 2), "length"),
        r"up to terms of the order $E^3$. After a touch from above $b < 0$, and $E$ is to be "
        r"replaced by $-E$.\end{corollary}",
        r"\begin{proof} By Lemma~\ref{thm:sticks-rate} and $F^{(\lambda)} = 0$ at the touch, put "
        r"the series into $F^{(\lambda)} + E = 0$: the terms with $E$ and $E^2$ vanish.\end{proof}",
        r"\begin{example}[a fork]\label{thm:static_friction-fork} Let $m = k = 1$, $c = A_0 = 0$, "
        r"$\Omega = \frac{1}{2}$, one belt with the speed 1, kinetic friction $\frac{1}{2}$ and "
        r"static friction 1, and $B_0 = \frac{3}{2}(1 - \epsilon)$. Below the belt",
        equation(place, path, _solves_in_time(drive)),
        r"is a motion, since",
        equation(flown, drive, exact({flown: path.diff(t, 2) + path})),
        equation(moving, -(1 - missed) * sp.sin(t / 2), exact({moving: path.diff(t)})),
        r"For $0 < \epsilon < 1$ it never reaches the belt. For $\epsilon = 0$ it touches the belt "
        r"at $t = 3\pi$ and sticks, until the needed force, at $\tau$ after the touch",
        equation(
            held,
            sp.Rational(3, 2) * sp.sin(tau / 2) - sp.Rational(1, 2) - tau,
            exact({held: on_belt}),
        ),
        r"falls to $-1$, at",
        decimal(r"\tau", left, DECIMALS, close(_first_slip_by_bisection, DECIMALS)),
        r"However small $\epsilon$ is, the two motions separate at once. No such thing happens for "
        r"$E = 0$, where a graze and a near miss stay together to the order of "
        r"$\epsilon$.\end{example}",
    )


def _along_belt(angle: Any, time: Any) -> Any:
    """Return by how much an acceleration beside a belt has changed after some time of a stick."""
    later = balance(x_i + v_lambda * time, v_lambda, angle + Omega * time)
    return later - balance(x_i, v_lambda, angle)


def _expands(force: Any, meaning: dict[Any, Any], order: int) -> Check:
    """Return the check that the right side is the zero of `force` in tau, up to E^order."""

    def check(statement: Step) -> StepEvidence:
        series = statement.right.xreplace(meaning)
        rates = [force.diff(tau, n).subs(tau, 0) for n in range(order + 1)]
        taylor = sp.Add(*(rate * tau**n / sp.factorial(n) for n, rate in enumerate(rates)))
        rest = sp.expand(taylor.subs(tau, series))
        for power in range(-1, order + 1):
            coefficient = rest.coeff(EXCESS, power)
            # A number refutes a wrong series at once, where the proof takes seconds.
            number = evaluate(coefficient, next(points(coefficient, 1)))
            if abs(number) > DIFFERENT or sp.simplify(coefficient) != 0:
                raise StepError(str(statement), f"E^{power} has the coefficient {coefficient}")
        if sp.limit(statement.right, EXCESS, 0) != 0:
            raise StepError(str(statement), "does not vanish with E")
        return StepEvidence("exact", "0")

    return check


def _solves_in_time(drive: Any) -> Check:
    """Return the check that the right side solves x'' + x = drive."""

    def check(statement: Step) -> StepEvidence:
        rest = sp.simplify(statement.right.diff(t, 2) + statement.right - drive)
        if rest != 0:
            raise StepError(str(statement), f"does not solve its equation: {rest} remains")
        return StepEvidence("exact", "0")

    return check


@cache
def _first_slip_of_the_example() -> Any:
    """Return how long the stick of the fork lasts, by Newton's method."""
    time = CONTEXT.mpf("1.5")
    for _ in range(8):
        force = CONTEXT.mpf("1.5") * CONTEXT.sin(time / 2) + CONTEXT.mpf("0.5") - time
        time -= force / (CONTEXT.mpf("0.75") * CONTEXT.cos(time / 2) - 1)
    return time


@cache
def _first_slip_by_bisection() -> Any:
    """Return the same from the balance of forces, at the first change of its sign."""

    def is_held(time: Any) -> bool:
        drive = CONTEXT.mpf("1.5") * CONTEXT.cos((3 * CONTEXT.pi + time) / 2)
        spring = CONTEXT.mpf("0.5") + time
        return bool(drive - spring > -1)

    return bisected(is_held, 0, 2)


def _counts() -> Items:
    """Return the items on the least duration of a flight."""
    bend = named(r"\ddot{g}")
    pull = named(r"\ddot{x}")
    path = sp.Function("x")(t)
    law = solution.in_paper_letters(solution.acceleration(path, path.diff(t), Omega * t)).diff(t)
    third = law.subs(path.diff(t, 2), pull).subs(path.diff(t), v).subs(Omega * t, theta)
    bound = sp.Symbol("M", positive=True)
    least = EXCESS * tau - bound * tau**2 / 2
    gap = named(r"g_{*}(\tau)")
    zero = named(r"g_{*}(2E/M)")
    integral = sp.integrate(EXCESS - bound * t, (t, 0, tau))
    return (
        r"\subsection{Events do not accumulate}",
        r"\begin{theorem}[a flight has a least duration]\label{thm:static_friction-finite} Let "
        r"$|\dot{x}| \le V$ and $|\ddot{x}| \le a$ during a flight that starts at the speed of a "
        r"belt with $E > 0$, and $M = (c a + k V + |B_0|\Omega)/m$. The flight comes back to this "
        r"belt after the time $2E/M$ at the earliest, and to another belt after $|v_{\lambda'} - "
        r"v_\lambda|/a$.\end{theorem}",
        r"\begin{proof} Behind a slip $|\ddot{x}| = E$ by \eqref{eq:static_friction-start}, and "
        r"where the mass passes the belt $|\ddot{x}| \ge E$ by "
        r"Theorem~\ref{thm:static_friction-cases}. During the flight the gap $g = \dot{x} - "
        r"v_\lambda$ has",
        equation(
            bend,
            -(c * pull + k * v + B0 * Omega * sp.sin(theta)) / m,
            {bend: third},
            "bend",
        ),
        r"which is at most $M$ in size. So at $\tau$ after the start $|g|$ is at least",
        equation(gap, least, exact({gap: integral}), "least"),
        r"which is positive up to its second zero,",
        equation(zero, 0, exact({zero: least.subs(tau, 2 * EXCESS / bound)})),
        r"\end{proof}",
        r"\begin{corollary}[finitely many events]\label{thm:static_friction-count} Every motion has "
        r"finitely many events in each bounded interval of time.\end{corollary}",
        r"\begin{proof} During a bounded interval the velocity and the acceleration are bounded, "
        r"since friction is. Near a time $t^*$ the velocity stays away from the speeds of all belts "
        r"but one. If this belt has $E = 0$, Theorem~\ref{thm:accumulation-three} bounds the number "
        r"of events near $t^*$. If it has $E > 0$, each stick and each passage is followed by a "
        r"flight with the least duration of Theorem~\ref{thm:static_friction-finite}.\end{proof}",
        r"A stick may be as short as one likes, as the arrival decides how much of the static limit "
        r"is left; but two of them lie apart by a flight.",
    )


def _unique() -> Items:
    """Return the items on uniqueness, and on a start from which two motions obey the law."""
    leaving = -sp.Rational(1, 2) + t * sp.sin(t) / 4
    needed = sp.Rational(1, 2) + sp.cos(t) / 2
    path = named("x(t)")
    moving = named(r"\dot{x}(t)")
    start = named(r"\ddot{x}(0)")
    held = named(r"F_{s\lambda}(t)")
    # kinetic friction -1/2 above the belt, and the drive cos(t)/2
    drive = -sp.Rational(1, 2) + sp.cos(t) / 2
    return (
        r"\subsection{One motion from each start}",
        r"\begin{theorem}[unique forward in time]\label{thm:static_friction-unique} Through each "
        r"$(t_0, x_0, \dot{x}_0)$ passes one motion in the sense of "
        r"Definition~\ref{thm:static_friction-law}, and it exists for all $t \ge t_0$. Backward in "
        r"time motions are not unique: all that come to stick at one point of a belt at one time "
        r"are one motion afterwards.\end{theorem}",
        r"\begin{proof} Between events a flight or a stick is determined. At an event "
        r"Theorem~\ref{thm:static_friction-cases} leaves one way to go on, if $E > 0$; for $E = 0$ "
        r"it is Theorem~\ref{thm:motion-unique}. By Corollary~\ref{thm:static_friction-count} this "
        r"reaches every time.\end{proof}",
        r"That the mass sticks \emph{for as long as the belt can hold it} is part of the "
        r"definition for a reason: the force law alone does not decide it.",
        r"\begin{example}[hold or leave]\label{thm:static_friction-fork-in-law} Let $m = k = "
        r"\Omega = 1$, $c = A_0 = 0$, $B_0 = \frac{1}{2}$, one belt at rest with kinetic friction "
        r"$\frac{1}{2}$ and static friction 1, and let the mass be at rest at $x = -\frac{1}{2}$. "
        r"Then the needed force",
        equation(
            held,
            needed,
            exact({held: balance_of_example()}),
            note=r"is at most 1, so that rest obeys the law for ever.",
        ),
        r"But it is 1 at $t = 0$, and so does the motion that leaves the belt then,",
        equation(path, leaving, _solves_in_time(drive)),
        equation(moving, (sp.sin(t) + t * sp.cos(t)) / 4, exact({moving: leaving.diff(t)})),
        equation(
            start,
            sp.Rational(1, 2),
            exact({start: leaving.diff(t, 2).subs(t, 0)}),
            note="(here $E$),",
        ),
        r"until $\tan t = -t$, at",
        decimal("t", _return_by_newton(), DECIMALS, close(_return_by_bisection, DECIMALS)),
        r"where it sticks. By Definition~\ref{thm:static_friction-law} the mass rests.\end{example}",
        r"Bossolini, Br\o ns and Kristiansen \cite{bossolini2017} call such motions singular; they "
        r"arise where the needed force touches the static limit with slope 0 from within. "
        r"Theorem~\ref{thm:motion-unique} does not apply, because for $E > 0$ friction is not "
        r"monotone in the velocity.",
    )


def balance_of_example() -> Any:
    """Return the sum of drive and spring on a mass at rest in the example of two motions."""
    at_rest = {solution.A: 0, B0: sp.Rational(1, 2), k: 1, c: 0, m: 1}
    return balance(-sp.Rational(1, 2), 0, t).subs(at_rest)


@cache
def _return_by_newton() -> Any:
    """Return when the motion that leaves has the velocity 0 again."""
    time = CONTEXT.mpf(2)
    for _ in range(8):  # v vanishes where tan t = -t
        time -= (CONTEXT.tan(time) + time) / (2 + CONTEXT.tan(time) ** 2)
    return time


@cache
def _return_by_bisection() -> Any:
    """Return the same, at the first change of sign of the velocity."""
    return bisected(lambda time: CONTEXT.sin(time) + time * CONTEXT.cos(time) > 0, 1, 3)


def _saltation() -> Items:
    """Return the items on the derivative of a motion at a slip."""
    shift = named(r"\delta t")
    moved = named(r"\delta x")
    result = named(r"\delta\dot{x}^{+}")
    start = sp.Symbol("x_e", real=True)
    limit = sp.Symbol("q", real=True)
    # What a belt has to hold, at a time and for a position x_e at t = 0, is a constant `limit`.
    needed = m * balance(start + v_lambda * t, v_lambda, theta + Omega * t) - limit
    delay = -needed.diff(start) / needed.diff(t).subs(t, 0)
    slope = k * v_lambda + B0 * Omega * sp.sin(theta)
    late = k * moved / slope
    return (
        r"\subsection{Derivatives}",
        r"\begin{theorem}[saltation of a slip]\label{thm:static_friction-saltation} Let a stick "
        r"end at the phase $\theta$ with $k v_\lambda + B_0\Omega\sin\theta \ne 0$. A small change "
        r"$\delta x$ of the position on the belt delays the slip by",
        equation(shift, -late, exact({shift: delay * moved}), "shift"),
        r"and behind it the velocity has changed by",
        equation(
            result,
            SIDE * EXCESS * late,
            exact({result: _velocity_change(shift), shift: delay * moved}),
            "saltation",
        ),
        r"while $\delta x$ stays. Passages and onsets have the matrices of "
        r"Theorem~\ref{thm:jacobians-saltation}.\end{theorem}",
        r"\begin{proof} On the belt the needed force depends on the position and the time; it has "
        r"its limit at a time that moves by \eqref{eq:static_friction-shift}. During $\delta t$ the "
        r"unchanged motion already has the acceleration $\sigma E$ of "
        r"\eqref{eq:static_friction-start}, and the changed one still 0. At a passage and an onset "
        r"nothing but the acceleration before and after counts.\end{proof}",
        r"For $E = 0$ the velocity does not change, as in Chapter~\ref{sec:jacobians}. For $E > 0$ "
        r"the change has no bound: it is large where the needed force turns near its limit. An "
        r"onset still forgets the velocity, so one multiplier of a motion with a stick is 0, and "
        r"the second Lyapunov exponent is $-\infty$; but the first may be positive.",
    )


def _velocity_change(shift: Any) -> Any:
    """Return the velocity of a delayed flight less that of the flight that starts at once."""
    at_once, delayed = (v_lambda + SIDE * EXCESS * (t - begin) for begin in (0, shift))
    return delayed - at_once


def _what_remains() -> Items:
    """Return the items on the theorems that hold, and on those that fall."""
    y = named("y")
    rate = named(r"\dot{y}")
    bend = named(r"\ddot{y}")
    forces = named(r"(T - \tilde{T})")
    energy = named(r"\dot{W}")
    meaning = {energy: m * rate * bend + k * y * rate, bend: (forces - c * rate - k * y) / m}
    excess = named(r"T - \tilde{T}")
    less = sp.Symbol("q", nonnegative=True)
    rest = KINETIC / SPRING
    still = named(r"F^{(1)}")
    return (
        r"\subsection{Which theorems remain}",
        r"\begin{lemma}[friction may push two motions apart]\label{thm:static_friction-energy} Let "
        r"$y$ be the difference of two motions, $W = \frac{m}{2}\dot{y}^2 + \frac{k}{2}y^2$, and $s - "
        r"f$ the sum of $(\mu_{s\lambda} - \mu_\lambda)F_N$ over the belts. Then",
        equation(energy, forces * rate - c * rate**2, meaning, "energy"),
        r"which is at most $-c\dot{y}^2 + (s - f)|\dot{y}|$.\end{lemma}",
        r"\begin{proof} Take one belt. If both masses slide on it, or both stick, "
        r"Lemma~\ref{thm:motion-monotone} holds. If the first sticks and the second is slower, then "
        r"$T \le s$ and $\tilde{T} = f$, so that",
        step(excess, "<=", HOLDING - KINETIC, sign({excess: HOLDING - less - KINETIC}), "excess"),
        r"while $\dot{y} > 0$: the work is at most $(s - f)|\dot{y}|$. The other cases are mirror "
        r"images, and belts add.\end{proof}",
        r"\begin{example}[two attracting motions]\label{thm:static_friction-two} In the "
        r"setting of Theorem~\ref{thm:stick_slip-cycle} the position $x = f/k$ at rest is a motion "
        r"too, since there",
        equation(
            still,
            0,
            exact({still: balance(rest, 0, 0).subs({solution.A: KINETIC, B0: 0, k: SPRING})}),
        ),
        r"It never meets the belt, nor do the free oscillations about it with velocities below "
        r"$V$. So a rest and a stick-slip cycle exist side by side, whose distance neither grows "
        r"nor shrinks in the long run. With a small damper the rest attracts its neighbours, and so "
        r"does the cycle: its flight still comes back to the belt, where the mass sticks, and from "
        r"the place of the slip on all motions are one. So a motion tends to one or the other, "
        r"depending on its start.\end{example}",
        r"Table~\ref{tab:static_friction-theorems} lists what follows. Everything that rests on "
        r"single flights, sticks and events remains; everything that rests on \eqref{eq:motion-energy} "
        r"and Lemma~\ref{thm:motion-monotone} falls as soon as one belt has $E > 0$.",
        Table(
            "tab:static_friction-theorems",
            r"The theorems of this supplement with static friction, $E > 0$.",
            ("holds", "why"),
            _HOLDS,
            columns="p{62mm}p{88mm}",
        ),
        Table(
            "tab:static_friction-falls",
            r"What falls with static friction.",
            ("falls", "what there is instead"),
            _FALLS,
            columns="p{62mm}p{88mm}",
        ),
    )


_HOLDS = (
    (
        r"Solutions in a domain, Chapter~\ref{sec:domains}; the rate on a belt, "
        r"Lemma~\ref{thm:sticks-rate}",
        r"Neither contains the static limit.",
    ),
    (
        r"Theorem~\ref{thm:grazing-theorem7} (Theorem 7) and its windows",
        r"A property of flights; a graze is now the onset of a stick "
        r"(Theorem~\ref{thm:static_friction-graze}).",
    ),
    (
        r"Phases at which a mass can slip",
        r"Theorem~\ref{thm:static_friction-exits}.",
    ),
    (
        r"One motion forward in time, Theorem~\ref{thm:motion-unique}",
        r"By the rule that a belt holds for as long as it can "
        r"(Theorem~\ref{thm:static_friction-unique}); backward motions may merge, as before.",
    ),
    (
        r"Events do not accumulate, Theorem~\ref{thm:accumulation-finite}",
        r"Corollary~\ref{thm:static_friction-count}.",
    ),
    (
        r"How far a motion goes, Proposition~\ref{thm:orbits-bound}",
        r"With $\mu_{s\lambda}$ in place of $\mu_\lambda$ in $F_*$.",
    ),
    (
        r"A multiplier 0 after a stick, Theorem~\ref{thm:jacobians-monodromy} (ii)",
        r"An onset still forgets the velocity.",
    ),
)
_FALLS = (
    (
        r"The distance of two motions never grows, \eqref{eq:motion-energy}",
        r"Lemma~\ref{thm:static_friction-energy}.",
    ),
    (
        r"One motion attracts all others, with the period of the drive, "
        r"Theorem~\ref{thm:orbits-unique}",
        r"Several may attract, with other periods or none "
        r"(Example~\ref{thm:static_friction-two}).",
    ),
    (
        r"No multiplier above 1 in size, Theorem~\ref{thm:jacobians-monodromy} (i)",
        r"\eqref{eq:static_friction-saltation} has no bound.",
    ),
    (
        r"No chaos, Theorems~\ref{thm:exponents-lyapunov} and~\ref{thm:exponents-chaos}",
        r"Exponents may be positive; \texttt{sensitivities} estimates them.",
    ),
    (
        r"The settled motion depends continuously on parameters; a motion that grazes and one "
        r"that misses stay together",
        r"It jumps at a touch (Example~\ref{thm:static_friction-fork}).",
    ),
    (
        r"One motion decides the word between borders, Theorem~\ref{thm:borders-atlas}",
        r"An atlas would need all attracting motions.",
    ),
    (
        r"Certificates of branches and planes as far as they use the contraction, "
        r"Chapter~\ref{sec:certificates}",
        r"Events one by one and orbits are proven.",
    ),
)
