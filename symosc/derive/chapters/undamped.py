"""Motions without a damper: free ones between the belts, tori, and to what all others tend."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import sympy as sp

from symosc.derive.chapters.events import LETTER_A
from symosc.derive.scope import Scope, valued
from symosc.derive.steps import (
    CONTEXT,
    Items,
    Step,
    StepEvidence,
    Table,
    close,
    decimal,
    equation,
    exact,
    number,
    sign,
    step,
)
from symosc.model import Parameters
from symosc.simulation.simulate import simulate
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, A, Omega, k, m, omega_0, t

TITLE = "Without a damper"
FIXED = named("X_0")
RESPONSE = named("V_0")
RADIUS = sp.Symbol("R", positive=True)
ANGLE = named(r"\psi")
WHOLE = sp.Symbol("S", positive=True)
STEADY = B0 / (k - m * Omega**2)


def items(scope: Scope) -> Items:
    """Yield the chapter: bounded, recurrent and free motions, and what is left of the theorems."""
    yield (
        r"In this chapter $c = 0$ and $k > 0$. $\omega_0 = \sqrt{k/m}$, $T = 2\pi/\Omega$, and a "
        r"belt with $\mu_\lambda F_N = 0$ counts as absent. $S = (\mu_1 + \mu_2)F_N > 0$: at least "
        r"one belt rubs. $f = T_1 + T_2$ is the friction of both. A \emph{free oscillation} is a "
        r"solution $z = R\cos(\omega_0 t + \psi)$ of $m\ddot{z} + k z = 0$; all of them form a "
        r"plane, with the points $(R\cos\psi, R\sin\psi)$. A motion $x$ \emph{tends} to another "
        r"one if the energy $W = \frac{m}{2}\dot{y}^2 + \frac{k}{2}y^2$ of their difference $y$ "
        r"tends to 0. By \eqref{eq:motion-energy} and Lemma~\ref{thm:motion-monotone} $W$ never "
        r"grows here either.",
    )
    yield _bounded()
    yield _recurrent()
    yield _shape()
    yield _free()
    yield _one_belt()
    yield _examples()
    yield _survivors()


def _bounded() -> Items:
    """Return the items on when motions are bounded."""
    phase = sp.Symbol("s", positive=True)
    size = named(r"\int_0^{\pi/\omega_0}|\dot{z}|\,dt")
    swing = sp.integrate(RADIUS * omega_0 * sp.sin(omega_0 * phase), (phase, 0, sp.pi / omega_0))
    mean = named(r"\frac{\Omega}{\pi}\int_0^{2\pi/\Omega} S\,|\cos\Omega t|\,dt")
    quarter = sp.integrate(WHOLE * sp.cos(Omega * phase), (phase, 0, sp.pi / (2 * Omega)))
    work = named(r"\int_0^{2\pi/\omega_0}\cos(\omega_0 t)\,\dot{z}\,dt\Big|_{\psi = \pi/2}")
    speed = -RADIUS * omega_0 * sp.sin(omega_0 * phase + sp.pi / 2)
    drive = sp.integrate(
        sp.expand_trig(sp.cos(omega_0 * phase) * speed), (phase, 0, 2 * sp.pi / omega_0)
    )
    yield (
        r"\subsection{Bounded motions}",
        r"\begin{proposition}[bounded, or not]\label{thm:undamped-bounded} "
        r"\begin{enumerate}\item[(i)] For $\Omega \ne \omega_0$, and for $\Omega = \omega_0$ with "
        r"$\pi|B_0| < 4S$, all motions come into one ball in finite time and stay "
        r"there.\item[(ii)] For $\Omega = \omega_0$ and $\pi|B_0| > 4S$ no motion is bounded; nor "
        r"for $\pi|B_0| = 4S$ if both belts rub.\end{enumerate}\end{proposition}",
        r"\begin{proof} (i) Let $\Omega \ne \omega_0$, subtract the solution $A_0/k + "
        r"X_0\cos\Omega t$ with the $X_0$ of \eqref{eq:undamped-X0}, and let $z$ be what is left: "
        r"$m\ddot{z} + k z = f$. Its energy $E$ has the rate $f\dot{z}$. Outside the belts' speeds "
        r"$f = -S\operatorname{sgn}\dot{x}$, so that $f\dot{x} \le -S|\dot{x}| + "
        r"2S\max|v_\lambda|$ everywhere, and $f\dot{z} \le -S|\dot{z}| + K$ with a constant $K$. "
        r"During half a period $\pi/\omega_0$ the bounded force $f$ changes $\dot{z}$ by a bounded "
        r"amount against a free oscillation of the amplitude $R$, for which",
        equation(size, 2 * RADIUS, {size: swing}, "swing"),
        r"So $E$ changes by at most $-2SR$ plus a constant, and falls whenever $R$ is large. For "
        r"$\Omega = \omega_0$ subtract $A_0/k$ alone. Now the drive adds at most the following "
        r"times $|B_0|$ in a whole period, up to a bounded part,",
        equation(sp.Abs(work), sp.pi * RADIUS, {work: drive}, "work"),
        r"and friction takes at least $4SR$, by \eqref{eq:undamped-swing} twice, up to a bounded "
        r"part.",
        r"(ii) If one motion is bounded, there is one with the period $T$ "
        r"(Theorem~\ref{thm:undamped-recurrent} (i), whose proof needs no more than this). "
        r"$m\ddot{x} + k x$ has no part with the frequency $\omega_0$, so that $B_0$ and the part "
        r"of $f$ in $\cos\Omega t$ cancel, and $|B_0|$ is at most",
        equation(mean, 4 * WHOLE / sp.pi, {mean: Omega / sp.pi * 4 * quarter}, "mean"),
        r"with equality only if $f = \pm S\operatorname{sgn}\cos\Omega t$ at almost all times. But "
        r"if both belts rub, $|f| < S$ while $\dot{x}$ goes from one belt's speed to the "
        r"other's.\end{proof}",
    )


def _recurrent() -> Items:
    """Return the items on the motions to which all others tend."""
    y = named("y")
    rate = named(r"\dot{y}")
    bend = named(r"\ddot{y}")
    forces = named(r"(f - \tilde{f})")
    energy = named(r"\dot{W}")
    meaning = {energy: m * rate * bend + k * y * rate, bend: (forces - k * y) / m}
    yield (
        r"\subsection{To what all motions tend}",
        r"\begin{lemma}[constant distance]\label{thm:undamped-distance} Let the difference $y$ of "
        r"two bounded motions have a constant $W > 0$ for all $t \ge t_0$. Then their frictions "
        r"agree at almost all times and $y$ is a free oscillation; or from some time on both rest "
        r"on one belt with $v_\lambda = 0$ for ever.\end{lemma}",
        r"\begin{proof} With the frictions $f$ and $\tilde{f}$",
        equation(energy, forces * rate, meaning, "W"),
        r"so that $f = \tilde{f}$ at almost all times with $\dot{y} \ne 0$, where $y$ is then a "
        r"free oscillation of the energy $W$. Between two neighbouring zeros of $\dot{y}$ passes "
        r"the time $\pi/\omega_0$, so the times with $\dot{y} = 0$ are isolated or form intervals. "
        r"If there is no interval, $y$ is a free oscillation for all times. On an interval $y = Y$ "
        r"with $\frac{k}{2}Y^2 = W$, and $f - \tilde{f} = k Y \ne 0$ although the velocities are "
        r"equal: they are the speed $v_\lambda$ of one belt, to which both stick. The friction "
        r"during a stick is continuous, and so is it where a stick ends, since the acceleration "
        r"that the mass slips with begins at 0 (Theorem~\ref{thm:sticks-exits}); and sticks are "
        r"followed by flights (Theorem~\ref{thm:accumulation-finite}). So if the interval ended, "
        r"$f - \tilde{f}$ would be near $k Y \ne 0$ shortly after, where $\dot{y} \ne 0$ and $f = "
        r"\tilde{f}$. It does not end, and bounded motions stick for ever only if $v_\lambda = "
        r"0$.\end{proof}",
        r"\begin{theorem}[all motions without a damper]\label{thm:undamped-recurrent} Let $c = 0$, "
        r"$k > 0$, $S > 0$, and $\Omega \ne \omega_0$ or $\pi|B_0| < "
        r"4S$.\begin{enumerate}\item[(i)] There is a motion $x^*$ with the period $T$.\item[(ii)] "
        r"If $v_\lambda = 0$ and $|B_0| \le \mu_\lambda F_N$ for a belt that rubs, every motion "
        r"tends to a rest on it, at a position of the interval of "
        r"Theorem~\ref{thm:orbits-unique}.\item[(iii)] If not, let $\mathcal{K}$ be the set of all "
        r"free oscillations $z$ for which $x^* + z$ is a motion. It is convex and compact, "
        r"contains 0, and a shift of time by $T$, which turns it by the angle $\omega_0 T$, takes "
        r"it onto itself. All $x^* + z$ with $z \in \mathcal{K}$ have the same friction $f^*(t)$ "
        r"at almost all times. Every motion tends to one of them, and to one "
        r"only.\end{enumerate}\end{theorem}",
        r"\begin{proof} Let $P$ be the map of the states over the time $T$ and $\|\cdot\|^2 = W$: "
        r"$P$ moves no two states apart, and all motions are bounded by "
        r"Proposition~\ref{thm:undamped-bounded}. (i) Let $p_n = P^n p$. The state $q$ for which "
        r"$\limsup\|p_n - q\|$ is least is the only one, as balls are strictly convex, and $P q$ "
        r"does as well as $q$: so $P q = q$.",
        r"(iii) $f^*$: $W$ of a free oscillation is constant, so $f = f^*$ by "
        r"Lemma~\ref{thm:undamped-distance} (a rest is excluded: for $|B_0| > \mu_\lambda F_N$ no "
        r"rest lasts). Convex: if $x^* + z_1$ and $x^* + z_2$ are motions, a mean of them solves "
        r"the same equation, with the friction $f^*$. At each velocity the possible frictions are "
        r"monotone, so the velocities that allow $f^*(t)$ form an interval, and the mean has one "
        r"of them. Compact: the set is closed because the right side of \eqref{eq:motion-newton} "
        r"is, and bounded because all motions come into one ball while $R$ stays. Shifted by $T$, "
        r"$x^* + z$ is a motion of the same kind; this takes $\mathcal{K}$ into itself without a "
        r"change of distances, and a compact set then onto itself. Let $q$ be a limit of some of "
        r"the $p_n$. All $P^n q$ have the same distance to $x^*$, the limit of $\|p_n - x^*\|$, so "
        r"that $q$ belongs to $x^* + z$ with $z \in \mathcal{K}$. For each $n$ in question take "
        r"the member of $\mathcal{K}$ that the shift by $nT$ takes to $z$; its motion has at $nT$ "
        r"a distance to the given one that tends to 0. These members have a limit $z_\infty \in "
        r"\mathcal{K}$. The distance to $x^* + z_\infty$ tends to 0 for these $n$, and never "
        r"grows. There is no other such member since the distance of two is constant.",
        r"(ii) The rests are motions by Proposition~\ref{thm:motion-held}. On one in the middle of "
        r"the interval the friction of the belt is strictly inside its limits at almost all times, "
        r"so a motion that keeps its distance to it has $\dot{x} = 0$ at almost all times, by "
        r"\eqref{eq:undamped-W} and Lemma~\ref{thm:motion-monotone}. As in (iii) each limit keeps "
        r"its distance; so it is a rest, and the distance to it tends to 0.\end{proof}",
    )


def _shape() -> Items:
    """Return the items on the set of all recurrent motions if friction changes on them."""
    turn = named(r"\omega_0 T")
    count = named("j")
    yield (
        r"\begin{theorem}[motions that use the belts]\label{thm:undamped-belts} Let $f^*$ of "
        r"Theorem~\ref{thm:undamped-recurrent} (iii) not be constant. If $x^*$ sticks, or "
        r"$2\omega_0/\Omega$ is no whole number, $\mathcal{K} = \{0\}$: every motion tends to "
        r"$x^*$. In all cases $\mathcal{K}$ is a point or a segment; a segment only if $f^*$ jumps "
        r"at times that differ by multiples of $\pi/\omega_0$. If $2\omega_0/\Omega$ is odd, $x^*$ "
        r"is in the middle of the segment and the others have the period $2T$; if it is even, all "
        r"have the period $T$.\end{theorem}",
        r"\begin{proof} Let $z \in \mathcal{K}$. During a stick of $x^*$ its friction is inside "
        r"its limits for some time: it can stay at a limit only if $r = 0$ "
        r"(Lemma~\ref{thm:accumulation-forces}) all the time, that is for $B_0 = 0$ and $v_\lambda "
        r"= 0$, which is (ii) of Theorem~\ref{thm:undamped-recurrent}. The velocity of $x^* + z$ "
        r"has to be $v_\lambda$ too during that time, so $\dot{z} = 0$ and $z = 0$. Without sticks "
        r"$f^*$ jumps where $x^*$ passes a belt, and $x^* + z$ passes it at the same time: "
        r"$\dot{z} = 0$. One such time $t_c$ leaves a line of oscillations. $t_c + T$ is another "
        r"such time, so if $z \ne 0$,",
        equation(
            turn,
            count * sp.pi,
            exact({turn: omega_0 * 2 * sp.pi / Omega, count: 2 * omega_0 / Omega}),
            "turn",
        ),
        r"with a whole number $j$, and the turn by this angle changes the sign of all $z \in "
        r"\mathcal{K}$, or none.\end{proof}",
        r"So each stick in the motion $x^*$ makes it attract all others, as for $c > 0$. Segments "
        r"are exceptional, but exist: the continuum of Proposition~\ref{thm:undamped-continuum} is "
        r"one, with $2\omega_0/\Omega = 4n$.",
    )


def _solves_spring(statement: Step) -> StepEvidence:
    """Check that the right side, a function of t, solves m x'' + k x = A + B0 cos(Omega t).

    Its free part at t = 0 has the position R cos(psi) and the velocity -R omega_0 sin(psi).
    """
    place = statement.right.subs({FIXED: STEADY, omega_0: sp.sqrt(k / m)})
    steady = A / k + STEADY * sp.cos(Omega * t)
    free = (place - steady).subs(t, 0)
    rate = (place - steady).diff(t).subs(t, 0)
    check = exact(tidy=sp.simplify)
    equation(free, RADIUS * sp.cos(ANGLE), check).verify()
    equation(rate, -RADIUS * sp.sqrt(k / m) * sp.sin(ANGLE), check).verify()
    force = m * place.diff(t, 2) + k * place
    return equation(force, A + B0 * sp.cos(Omega * t), check).verify()


def _free() -> Items:
    """Return the items on motions that use no belt."""
    delta = named(r"\Delta")
    freely = k / m - Omega**2
    steady = named("V_0^2")
    angle = sp.Symbol("s", positive=True)
    whole = sp.Symbol("j", integer=True)
    start = named(r"\psi")
    left = 2 * sp.sin(angle / 2) * sp.cos(start + whole * angle)
    right = sp.sin(start + whole * angle + angle / 2) - sp.sin(start + whole * angle - angle / 2)
    sine = named(r"\sin\theta")
    wave = named(r"\tfrac{1}{2}\sqrt{3} - (\sin\theta + \tfrac{1}{6}\sin 3\theta)")
    square = sp.Rational(2, 3) * (sine - sp.sqrt(3) / 2) ** 2 * (sine + sp.sqrt(3))
    angle3 = sp.Symbol("theta", real=True)
    tripled = {
        named(r"\sin 3\theta"): sp.expand_trig(sp.sin(3 * angle3)).subs(sp.sin(angle3), sine)
    }
    yield (
        r"\subsection{Free motions, and tori}",
        r"Let $f^*$ be constant. Then $x^*$ stays in one domain $\Omega_\alpha$ and its boundary, "
        r"and because its mean velocity is 0 and it is no rest, $v_- < 0 < v_+$ for the speeds of "
        r"the belts (those that rub) that bound the domain, $\pm\infty$ where there is none. Let "
        r"$w = \min(-v_-, v_+)$.",
        r"\begin{theorem}[free motions]\label{thm:undamped-free} Let $\Omega \ne \omega_0$, or "
        r"$B_0 = 0$ and $X_0 = 0$. The motions without friction that changes are",
        equation(
            named("x"),
            A / k + FIXED * sp.cos(Omega * t) + RADIUS * sp.cos(omega_0 * t + ANGLE),
            _solves_spring,
            "x",
        ),
        r"with",
        equation(
            FIXED,
            STEADY,
            exact({FIXED: sp.solve(-m * Omega**2 * FIXED + k * FIXED - B0, FIXED)[0]}),
            "X0",
        ),
        r"for which $v_- \le \dot{x} \le v_+$ at all times. Let $V_0 = \Omega|X_0|$ be the "
        r"velocity of the response with the period $T$.",
        r"\begin{enumerate}\item[(i)] Let $\omega_0/\Omega$ be irrational. There are such motions "
        r"iff $V_0 \le w$: all with $R \le R_* = (w - V_0)/\omega_0$. For $V_0 < w$ the states at "
        r"the times $nT$ of those with $0 < R \le R_*$ fill ellipses around that of $R = 0$: the "
        r"motions lie on tori.\item[(ii)] Let $\omega_0/\Omega = p/q$ in lowest terms with $q \ge "
        r"2$. Again there are such motions iff $V_0 \le w$; those with $R \le R_*$ are among them, "
        r"they are $R = 0$ alone for $V_0 = w$, and all but $R = 0$ have the period $q "
        r"T$.\item[(iii)] Let $\omega_0 = p\,\Omega$, $p \ge 2$. All of them have the period $T$. "
        r"Those with $R \le R_*$ are among them if $V_0 \le w$, but there may be some for $V_0 > "
        r"w$ too.\item[(iv)] If there are such motions, every motion tends to one of them, and "
        r"where their set $\mathcal{K}$ has an interior, every motion that has an event at a belt "
        r"that rubs tends to one on the border of $\mathcal{K}$.\end{enumerate}\end{theorem}",
        r"\begin{proof} $|\dot{x}| \le V_0 + \omega_0 R$, so all with $\omega_0 R \le w - V_0$ are "
        r"such motions. (i) For an irrational ratio the phases of both waves come as near as "
        r"wanted to every pair (Kronecker), so that $V_0 + \omega_0 R$ and its negative are the "
        r"bounds of $\dot{x}$. (ii) $\mathcal{K}$ is convex and a turn by $\omega_0 T$ takes it "
        r"into itself. $q$ such turns are whole ones, and the mean of the $q$ images of a member "
        r"is 0 by",
        equation(
            left, right, exact(tidy=lambda expr: sp.expand(sp.expand_trig(expr), trig=True)), "sum"
        ),
        r"with $s = \omega_0 T$, summed over $j = 0, \ldots, q - 1$: the right side adds up to 0 "
        r"and $\sin(s/2) \ne 0$. So $R = 0$ belongs to $\mathcal{K}$. If $V_0 = w$, the motion "
        r"with $R = 0$ touches a belt once in $T$, say at $t_j = t_0 + j T$, and $\pm\dot{z}(t_j) "
        r"\le 0$ for all $j$; the sum of these is 0, so all vanish. But then $\dot{z}$ changes its "
        r"sign at $t_j$ to first order unless $R = 0$, while the gap of the response is of the "
        r"second order. (iv) The first half is Theorem~\ref{thm:undamped-recurrent} (iii). If a "
        r"motion tends to a member inside $\mathcal{K}$, whose velocity stays away from $v_\pm$ by "
        r"some distance at all times, it has no events after some time. From its last event on it "
        r"is itself a free motion, at a constant distance from its limit, so it is its limit: but "
        r"that has no events.\end{proof}",
        r"The response is that of \eqref{eq:events-V0} with $c = 0$:",
        equation(
            steady,
            LETTER_A**2 / delta**2,
            {steady: (Omega * STEADY) ** 2, LETTER_A: B0 * Omega / m, delta: freely},
            "V0",
        ),
        r"where $\Delta = k/m - \Omega^2$ here. So when a parameter takes $V_0$ below $w$, the "
        r"motion that attracts leaves the belts and attracts no more. Tori of all sizes from 0 to "
        r"$R_*$, or motions with the period $q T$, are born around it at once, and $R_*$ grows in "
        r"proportion to $w - V_0$. Their multipliers are $e^{\pm i\omega_0 T}$. For (iii) take "
        r"$\omega_0 = 3\Omega$ and",
        equation(
            wave,
            square,
            exact({wave: sp.sqrt(3) / 2 - sine - named(r"\sin 3\theta") / 6, **tripled}),
            "third",
        ),
        r"which is never negative: with a third harmonic of the size $V_0/6$ the largest velocity "
        r"is $\frac{1}{2}\sqrt{3}\,V_0$, and free motions exist between belts at $\pm w$ up to "
        r"$V_0 = 2w/\sqrt{3}$.",
    )


#: Where the package's motion starts at rest, its periods, and the decimals to which its amplitude
#: is the limit then.
START = 0
PERIODS = 1600
DECIMALS = 6
#: Amplitudes of the drive for the table, with k = 2 and Omega = 2, where V_0 = B_0.
AMPLITUDES = ("19/20", "4/5")


def between(stiffness: Any, frequency: Any, amplitude: Any) -> Parameters:
    """Return the examples' parameters: c = A0 = 0, belts at -1 and 1 with the friction 1/5."""
    return Parameters(
        m=1,
        c=0,
        k=stiffness,
        A0=0,
        B0=amplitude,
        Omega=frequency,
        v1=-1,
        v2=1,
        mu1="1/5",
        mu2="1/5",
        FN=1,
    )


@cache
def radius(p: Parameters) -> Any:
    """Return R of the motion from rest at `START`, at its last event in `PERIODS` periods."""
    last = simulate(p, t0=0, x0=START, v0=0, t_end=f"{PERIODS}T").events[-1]
    steady = number(p.B0) / (number(p.k) - number(p.m) * number(p.Omega) ** 2)
    phase = number(p.Omega) * number(last.t)
    # The position and velocity of the free part: what is left of the state without the response.
    free_x = number(last.x) - steady * CONTEXT.cos(phase)
    free_v = number(last.v) + steady * number(p.Omega) * CONTEXT.sin(phase)
    return CONTEXT.sqrt(free_x**2 + free_v**2 * number(p.m) / number(p.k))


def response(p: Parameters) -> tuple[Any, Any]:
    """Return X_0 and V_0 of the response of the theorem, as exact numbers."""
    letters = {k: p.k, m: p.m, Omega: p.Omega, B0: p.B0}
    steady = STEADY.subs({letter: sp.Rational(str(value)) for letter, value in letters.items()})
    return steady, abs(steady) * sp.Rational(str(p.Omega))


def _numbers(p: Parameters) -> Items:
    """Return the steps on X_0 and V_0 of an example."""
    steady, speed = response(p)
    letters = {k: p.k, m: p.m, Omega: p.Omega, B0: p.B0}
    values = {letter: sp.Rational(str(value)) for letter, value in letters.items()}
    return (
        equation(FIXED, steady, {FIXED: STEADY.subs(values)}),
        equation(
            RESPONSE, speed, {RESPONSE: values[Omega] * sp.Abs(FIXED), FIXED: STEADY.subs(values)}
        ),
    )


def _limit() -> Any:
    """Return the amplitude B0 with V_0 = 1 for m = k = 1 and Omega = 17/10."""
    size = sp.Symbol("size", positive=True)
    values = {k: 1, m: 1, Omega: sp.Rational(17, 10), B0: size}
    largest_velocity = sp.Abs((Omega * STEADY).subs(values))
    (limit,) = sp.solve(largest_velocity - 1, size)
    return limit


def _one_belt() -> Items:
    """Return the items on one belt at rest: where motions without stops end, and odd stops."""
    yield (
        r"\subsection{One belt at rest}",
        r"Let $A_0 = 0$, $B_0 > 0$ and $v_1 = 0$, let $\mu_2 = 0$ and $v_2$ be out of reach, and "
        r"let $F = \mu_1 F_N$ and $x_f = F/k$: the oscillator with Coulomb friction "
        r"\cite{denhartog1931,hongliu2000}. A motion is \emph{symmetric} if $x(t + \pi/\Omega) = "
        r"-x(t)$. One without stops moves down for half a period from its highest point $x_0$, "
        r"with the friction $+F$. With the angle $\varphi$ since then, $x = x_f + p_0\cos\varphi + "
        r"q_0\sin\varphi + u$, where $u$ is a free oscillation.",
        *_continuum(),
        *_meeting_points(),
        r"\begin{proposition}[odd numbers of stops]\label{thm:undamped-odd} A periodic motion with "
        r"the period of the drive that is not its own mirror image, and with it every motion of "
        r"this period with an odd number of stops per cycle, needs $\Omega = \omega_0/(2n)$ with a "
        r"whole number $n$. Its stops that its mirror image does not share have no "
        r"length.\end{proposition}",
        r"\begin{proof} The mirror image $-x(t + \pi/\Omega)$ is a motion too. The difference of "
        r"the two keeps its energy (proof of Theorem~\ref{thm:orbits-unique}): friction is the "
        r"same in both whenever their velocities differ. While both rest the difference is "
        r"constant, and as both leave with the same friction it is 0. So the difference $x(t) + "
        r"x(t + \pi/\Omega)$, if it is not 0, is a free oscillation. As $x$ has the period "
        r"$2\pi/\Omega$, it is the same after half a period of the drive, which therefore is $n$ "
        r"periods of the free oscillation: $\Omega = \omega_0/(2n)$. While one of the two stops "
        r"the other one stops too, or the friction of the first one would be constant: a stop that "
        r"is alone has no length.\end{proof}",
    )


# The highest point of a symmetric motion, F/k, and the angle since the highest point.
HIGHEST = named("x_0")
HELD = named("x_f", positive=True)
TURNED = sp.Symbol("varphi", positive=True)
COUNT = sp.Symbol("n", integer=True, positive=True)


def _continuum() -> Items:
    """Return the items on a continuum of motions without stops."""
    friction = named("F")
    end = named("d_*")
    added = named("d")
    fast = 2 * COUNT * TURNED
    slow = {Omega: sp.sqrt(k / m) / (2 * COUNT), HIGHEST: B0 / (k - m * Omega**2)}
    motion = HELD + HIGHEST * sp.cos(TURNED) + (added - HELD) * sp.cos(fast)
    force = m * Omega**2 * motion.diff(TURNED, 2) + k * motion
    balance = named(r"m\ddot{x} + k x")
    rate = named(r"\dot{x}")
    whole = sp.Symbol("j", integer=True, positive=True)
    next_sine = sp.sin(whole * TURNED + TURNED)
    parts = sp.sin(whole * TURNED) * sp.cos(TURNED) + sp.cos(whole * TURNED) * sp.sin(TURNED)
    least = HIGHEST / (4 * COUNT**2)
    yield (
        r"\begin{proposition}[a continuum, and its death]\label{thm:undamped-continuum} Let "
        r"$\Omega = \omega_0/(2n)$ with a whole number $n$. If $F/B_0 < 1/(4n^2 - 1)$, the motions "
        r"$x + d\cos 2n\varphi$ have no stops for all $|d| < d_*$, where $x$ is the symmetric one "
        r"and",
        equation(
            end,
            B0 / (k * (4 * COUNT**2 - 1)) - friction / k,
            {end: least - HELD, HELD: friction / k, **slow},
            "end",
        ),
        r"If not, there is none. So the continuum dies at $F = B_0/(4n^2 - 1)$.\end{proposition}",
        r"\begin{proof} See \cite{csernak2007} for the orbits. Half a period is $n$ periods of "
        r"$u$, which comes back. So symmetry asks for $u = -x_f\cos 2n\varphi$ and $q_0 = 0$, and "
        r"the equation of motion on the way down for",
        equation(
            HIGHEST,
            4 * COUNT**2 * B0 / (k * (4 * COUNT**2 - 1)),
            slow,
            note=r"whatever the friction is.",
        ),
        r"A free oscillation $d\cos 2n\varphi$ may be added: the turning points are then $d + x_0$ "
        r"and $d - x_0$, at the same times, and on the way down",
        equation(
            balance, B0 * sp.cos(TURNED) + friction, {balance: force, HELD: friction / k, **slow}
        ),
        equation(
            rate,
            2 * COUNT * Omega * (HELD - added) * sp.sin(fast) - Omega * HIGHEST * sp.sin(TURNED),
            {rate: Omega * motion.diff(TURNED)},
        ),
        r"On the way up $-\dot{x}$ is the same with $x_f + d$ in place of $x_f - d$. By induction "
        r"with",
        equation(next_sine, parts, sp.expand_trig(next_sine), "sine"),
        r"$|\sin j\varphi| \le j\sin\varphi$ for $0 < \varphi < \pi$, with equality in the limit "
        r"at the turning points only. So there is no stop if and only if $x_f + |d| < "
        r"x_0/(4n^2)$.\end{proof}",
        r"At the end of the continuum one of the two turning points is a stop of no length. One "
        r"multiplier is 1, along the continuum. The other one is the product of the two ratios of "
        r"accelerations after and before a turn (Theorem~\ref{thm:jacobians-saltation}):",
        _second_multiplier(added, least),
    )


def _second_multiplier(added: Any, least: Any) -> Step:
    """Return the step on the second multiplier of a motion of the continuum."""
    multiplier = named(r"\rho_2")
    ratios = sp.Integer(1)
    for side in (1, -1):  # the highest point, the lowest one
        push = side * B0 - k * (added + side * HIGHEST)
        friction = side * k * HELD
        ratios *= (push + friction) / (push - friction)
    drive = k * HIGHEST * (1 - 1 / (4 * COUNT**2))
    return equation(
        multiplier,
        ((least - HELD) ** 2 - added**2) / ((least + HELD) ** 2 - added**2),
        exact({multiplier: ratios, B0: drive}, sp.simplify),
    )


def _meeting_points() -> Items:
    """Return the items on the points at which the border of motions without stops has corners."""
    p_0 = named("p_0")
    q_0 = named("q_0")
    cosine = named("a")
    sine = named("b")
    odd = 2 * COUNT + 1
    both = named(r"x(t) + x(t + \pi/\Omega)")

    def motion(angle: Any) -> Any:
        free = cosine * sp.cos(sp.expand(odd * angle)) + sine * sp.sin(sp.expand(odd * angle))
        return HELD + p_0 * sp.cos(angle) + q_0 * sp.sin(angle) + free

    yield (
        r"\begin{proposition}[points of codimension two]\label{thm:undamped-points} In the plane "
        r"of $\Omega$ and $F$ the border of the symmetric motions without stops passes through the "
        r"points \cite{guardia2010}\begin{enumerate}\item[$A_n$:] $\Omega = \omega_0/(2n)$, $F = "
        r"B_0/(4n^2 - 1)$;\item[$B_n$:] $\Omega = \omega_0/(2n + 1)$, $F = "
        r"0$.\end{enumerate}\end{proposition}",
        r"\begin{proof} $A_n$ is Proposition~\ref{thm:undamped-continuum} for $d = 0$. At $\Omega "
        r"= \omega_0/(2n + 1)$ half a period is $n + \frac{1}{2}$ periods of the free oscillation "
        r"$u = a\cos(2n + 1)\varphi + b\sin(2n + 1)\varphi$, which therefore changes its sign:",
        equation(both, 2 * HELD, {both: motion(TURNED) + motion(TURNED + sp.pi)}),
        r"This is 0 for $F = 0$ only.\end{proof}",
        r"With damping $A_1$ becomes a point where crossing-sliding meets a graze next to the "
        r"turning point: there the acceleration after the turn is 0 while the drive is largest "
        r"\eqref{eq:borders-rest}.",
    )


def _examples() -> Items:
    """Return the examples: a motion with the period 2T, tori, and free motions for V_0 > w."""
    doubled = between(1, 2, "1/2")
    torus = between(2, 2, "19/20")
    harmonic = between(1, "1/3", "44/15")
    doubled_position, doubled_speed = response(doubled)
    harmonic_position, harmonic_speed = response(harmonic)
    radius = sp.Rational(1, 5)  # of the free part of the first motion
    largest = named(r"V_0 + \omega_0 R")
    start = named("x_0")
    limit = named(r"\tfrac{1}{2}\sqrt{3}\,V_0")
    start_text, numbers = valued({named("x"): sp.Integer(START)})
    yield (
        r"\begin{example}[the period $2T$]\label{thm:undamped-doubled} Let $m = k = F_N = 1$, $A_0 "
        r"= 0$, $v_1 = -1$, $v_2 = 1$, $\mu_1 = \mu_2 = \frac{1}{5}$, here and below, and $\Omega "
        r"= 2$, $B_0 = \frac{1}{2}$. Then",
        *_numbers(doubled),
        r"and the motion that starts at rest at",
        equation(
            start,
            sp.Rational(1, 30),
            {start: FIXED + RADIUS, FIXED: doubled_position, RADIUS: radius},
        ),
        r"has $R = \frac{1}{5}$. It never meets a belt, since",
        equation(largest, sp.Rational(8, 15), {largest: doubled_speed + radius}),
        step(largest, "<", 1, sign({largest: doubled_speed + radius})),
        r"and has the period $2T$.\end{example}",
        r"\begin{example}[tori]\label{thm:undamped-tori} Let $k = 2$, $\Omega = 2$. The ratio "
        r"$\omega_0/\Omega = 1/\sqrt{2}$ is irrational, and $V_0 = |B_0|$, as for $B_0 = "
        r"\frac{19}{20}$",
        *_numbers(torus),
        r"For $B_0 > 1$ one motion attracts all others. For $B_0 < 1$ motions that meet a belt "
        r"tend to the torus with $R_* = (1 - B_0)/\sqrt{2}$ (Table~\ref{tab:undamped-radius}), and "
        r"those inside stay where they are. With $k = 1$ and $\Omega = \frac{17}{10}$ the ratio is "
        r"$10/17$, and what looks like a closed curve for $B_0$ below",
        equation(B0, sp.Rational(189, 170), {B0: _limit()}),
        r"is 17 points: the period is $17T$.\end{example}",
        Table(
            "tab:undamped-radius",
            rf"The amplitude $R$ of the free part in Example~\ref{{thm:undamped-tori}}: the limit "
            rf"by Theorem~\ref{{thm:undamped-free}} (iv), and at the last event in {PERIODS} "
            rf"periods by \texttt{{simulate}}, from rest at {start_text}, to {DECIMALS} decimals.",
            ("$B_0$", "$R_*$", "run"),
            tuple(map(_radius_row, AMPLITUDES)),
            numbers,
            columns="rrr",
        ),
        r"\begin{example}[a third harmonic]\label{thm:undamped-third} Let $k = 1$, $\Omega = "
        r"\frac{1}{3}$, $B_0 = \frac{44}{15}$. Then",
        *_numbers(harmonic),
        r"is above $w = 1$, and the response with $R = 0$ meets the belts. But with $z = "
        r"\frac{1}{18}X_0\cos 3\Omega t$ the largest velocity is",
        step(limit, "<", 1, sign({limit: sp.sqrt(3) * RESPONSE / 2, RESPONSE: harmonic_speed})),
        r"at most, and the motion that starts at rest at",
        equation(
            start,
            sp.Rational(209, 60),
            {start: FIXED * sp.Rational(19, 18), FIXED: harmonic_position},
        ),
        r"has no events.\end{example}",
    )


def _radius_row(amplitude: str) -> tuple[Step, Step, Step]:
    """Return a row of the table of tori: B_0, R_* by the theorem, and R at the end of a motion."""
    parameters = between(2, 2, amplitude)
    _, speed = response(parameters)
    # R_* = (w - V_0)/omega_0, with w = 1 for the belts at -1 and 1, and omega_0 = sqrt(2).
    limit = (1 - CONTEXT.mpf(speed.p) / speed.q) / CONTEXT.sqrt(2)
    agrees = close(partial(CONTEXT.mpf, limit), DECIMALS)
    return (
        decimal("z", number(parameters.B0), 2),
        decimal("z", limit, DECIMALS),
        decimal("z", radius(parameters), DECIMALS, agrees),
    )


def _survivors() -> Items:
    """Return the items on what holds of the theorems for c > 0."""
    return (
        r"\subsection{What is left of the theorems for $c > 0$}",
        r"\begin{corollary}[what holds without a damper]\label{thm:undamped-survives} For $c = 0$, "
        r"$k > 0$, $S > 0$:\begin{enumerate}\item[(i)] Of Theorem~\ref{thm:exponents-chaos}, (i) "
        r"and (ii) hold: no two motions move apart, the entropy is 0, there is no horseshoe, and "
        r"nothing depends sensitively on the start. No multiplier leaves the unit "
        r"circle.\item[(ii)] Motions with the periods $2T$ or $qT$ and tori exist, and are born "
        r"where $V_0$ falls below $w$. None of them attracts its neighbours: they form the convex "
        r"set $\mathcal{K}$ around one with the period $T$.\item[(iii)] "
        r"Theorem~\ref{thm:orbits-unique} (i) holds if $\Omega \ne \omega_0$ or $\pi|B_0| < 4S$. "
        r"Its (ii) holds iff $\mathcal{K} = \{0\}$: if the motion with the period $T$ sticks, or "
        r"meets a belt and $2\omega_0/\Omega$ is no whole number, or touches the belts at most and "
        r"has $V_0 = w$ with $\omega_0/\Omega$ no whole number. Its (iii) holds, for $|B_0| = "
        r"\mu_\lambda F_N$ too.\item[(iv)] Theorem~\ref{thm:borders-atlas} holds on sets of "
        r"parameters where $\mathcal{K} = \{0\}$.\end{enumerate}\end{corollary}",
        r"\begin{proof} (i) The proof of Theorem~\ref{thm:exponents-chaos} uses $k > 0$ alone. "
        r"(ii) Theorems~\ref{thm:undamped-belts} and~\ref{thm:undamped-free}; if $x^* + z$ has a "
        r"longer period, a mean of its shifts has the period $T$. Two members keep their distance. "
        r"(iii) Theorems~\ref{thm:undamped-recurrent} to~\ref{thm:undamped-free}. (iv) Its proof "
        r"uses that one motion attracts all others, and a ball that all come into, which "
        r"Proposition~\ref{thm:undamped-bounded} gives.\end{proof}",
        r"\begin{remark}[no spring, or no friction]\label{thm:undamped-rest} For $S = 0$ the "
        r"equation is linear, and all motions that are bounded are those of "
        r"Theorem~\ref{thm:undamped-free} with $w = \infty$. For $k = 0$ nothing ties the "
        r"position: with $x$ every $x + d$ is a motion, and the distance of two velocities does "
        r"not grow.\end{remark}",
    )
