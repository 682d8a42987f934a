"""L g has a known sign, and why no event can be missed: the bounds behind symosc.engine.first_exit."""

from __future__ import annotations

from typing import Any

import sympy as sp

from symosc.derive.chapters.domains import DELTA, NORMS
from symosc.derive.scope import Scope, v_lambda
from symosc.derive.steps import Items, equation, exact, facts, modes, sign, step
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, A, Omega, c, cm, k, m, t, tau, theta, w0sq

TITLE = "No event is missed"
LETTER_A = sp.Symbol("a", real=True)
LG = named("L g")
GAMMA = named(r"\gamma")
C4 = sp.Symbol("C_4", nonnegative=True)


def items(scope: Scope) -> Items:
    """Yield the chapter: the equation of the gap to a belt, how often it vanishes, and the bounds
    of the search.
    """
    yield _gap()
    yield _zeros()
    yield _bounds()
    yield _search()


def _gap() -> Items:
    """Yield the items on the equation for the gap."""
    path = sp.Function("x")(t)
    newton = (A + B0 * sp.cos(Omega * t) - c * path.diff(t) - k * path) / m
    jerk = newton.diff(t).subs(path.diff(t, 2), newton)
    true = (jerk + c / m * newton + k / m * (path.diff(t) - v_lambda)).subs(Omega * t, theta)
    meaning = {LG: true, GAMMA: k * v_lambda / m, LETTER_A: B0 * Omega / m}
    yield (
        r"\subsection{An equation for the gap}",
        r"\begin{lemma}[the gap]\label{thm:events-gap} Let $g = \dot{x} - v_\lambda$ be the gap "
        r"between the velocity and a belt's speed. In \emph{every} domain, with $L$ as in "
        r"Definition~\ref{thm:domains-basis} and $\gamma = k v_\lambda/m$, $a = B_0\Omega/m$,",
        equation(LG, -(GAMMA + LETTER_A * sp.sin(theta)), meaning, "gap"),
        r"\end{lemma}",
        r"\begin{proof} Differentiate \eqref{eq:motion-domain}: $A_\alpha$ goes, and friction with "
        r"it. Subtract $k v_\lambda/m$.\end{proof}",
        r"The right side is the function of Theorem~\ref{thm:grazing-theorem7}, and "
        r"$\dot{F}^{(\alpha)}$ on a belt, \eqref{eq:sticks-rate}. It changes its sign only at the "
        r"phases $\Theta^{\mathrm{cr}}$ and $\pi - \Theta^{\mathrm{cr}}$, which are known in "
        r"closed form.",
    )


def _zeros() -> Items:
    """Yield the items on the zeros between critical phases."""
    phi = sp.Function("phi")(tau)
    q = sp.Function("q")(tau)
    g = phi * q
    true = (g.diff(tau, 2) + cm * g.diff(tau) + w0sq * g).subs(
        phi.diff(tau, 2), -cm * phi.diff(tau) - w0sq * phi
    )
    letter = named(r"\varphi")
    rate = named(r"\dot{\varphi}")
    slope = named(r"\dot{q}")
    curve = named(r"\ddot{q}")
    inner = (phi**2 * sp.exp(cm * tau) * q.diff(tau)).diff(tau) * sp.exp(-cm * tau) / phi
    names = {letter: phi, rate: phi.diff(tau), slope: q.diff(tau), curve: q.diff(tau, 2)}
    closed = ((r.basis()[solution.E1], r.parameters()) for r in solution.REGIMES.values())
    applied = (y.diff(tau, 2) + at[cm] * y.diff(tau) + at[w0sq] * y for y, at in closed)
    free = named(r"L E_1")
    factored = exact({LG: true} | names)
    yield (
        r"\subsection{At most two zeros between critical phases}",
        r"\begin{theorem}[disconjugacy, after P\'olya]\label{thm:events-two} On an interval of "
        r"time on which $\gamma + a\sin\theta$ does not change its sign, and which is shorter than "
        r"$\pi/\omega_d$ if $c^2 < 4km$ (any length if not), $g$ has at most two zeros, or "
        r"vanishes identically.\end{theorem}",
        r"\begin{proof} The interval lies in one on which a solution $\varphi > 0$ of $L\varphi = "
        r"0$ exists: $E_1$ of Table~\ref{tab:domains-regimes}, started shortly before the "
        r"interval, is positive for $0 < \tau < \pi/\omega_d$, or for all $\tau > 0$.",
        facts(*(equation(free, 0, exact({free: remains}, modes)) for remains in applied)),
        r"With $q = g/\varphi$",
        equation(LG, letter * curve + (2 * rate + cm * letter) * slope, factored, "factor"),
        r"which is P\'olya's factorisation \cite{polya1922} $L g = \frac{e^{-c\tau/m}}{\varphi} "
        r"\frac{d}{d\tau}\bigl(\varphi^2 e^{c\tau/m}\dot{q}\bigr)$.",
        facts(equation(true, inner, exact())),
        r"By \eqref{eq:events-gap} $L g$ keeps its sign. If $\gamma$ and $a$ are not both 0, its "
        r"zeros are isolated, so $\varphi^2 e^{c\tau/m}\dot{q}$ is strictly monotone and $\dot{q}$ "
        r"has at most one zero; $q$, and with it $g$, has at most two. If $\gamma = a = 0$, "
        r"$\varphi^2 e^{c\tau/m}\dot{q}$ is constant: $q$ is strictly monotone and has at most one "
        r"zero, or it is constant, and then $g$ has none or vanishes identically.\end{proof}",
        r"\begin{corollary}[how many contacts there can be]\label{thm:events-count} In each "
        r"interval of the length $2\pi/\Omega$ one flight, continued beyond its end, meets the "
        r"speed of a belt at most $2(5 + 2\omega_d/\Omega)$ times ($\omega_d = 0$ if $c^2 \ge "
        r"4km$), unless it stays there for ever. Opposite signs of $g$ at the ends of a piece as "
        r"in Theorem~\ref{thm:events-two} mean exactly one zero in it; equal signs mean none or "
        r"two, and the one extremum of $g/\varphi$ tells which.\end{corollary}",
        r"\begin{proof} Two critical phases cut the interval into at most three pieces, and cuts "
        r"at distances just below $\pi/\omega_d$ add at most $2\omega_d/\Omega + 2$ "
        r"more.\end{proof}",
        r"So every flight has a first contact or none, its contacts do not accumulate, and a "
        r"search that goes piece by piece ends. That flights and sticks do not accumulate either "
        r"is Theorem~\ref{thm:accumulation-finite}. The bounds below need no pieces, and are what "
        r"the program uses from step to step.",
    )


def _bounds() -> Items:
    """Yield the items on bounds for later times."""
    yield r"\subsection{Two bounds for later times}"
    third = named("u^{(3)}")
    fourth = named("u^{(4)}")
    energy = named(r"\frac{d}{d\tau}\Bigl((u^{(4)})^2 + \frac{k}{m}(u^{(3)})^2\Bigr)")
    z = sp.Function("z")(tau)
    total = z.diff(tau) ** 2 + w0sq * z**2
    rate = (
        total.diff(tau)
        .subs(z.diff(tau, 2), -cm * z.diff(tau) - w0sq * z)
        .subs(z.diff(tau), fourth)
        .subs(z, third)
    )
    steady = named("V_0^2")
    response = sp.I * Omega * B0 / m / (w0sq - Omega**2 + sp.I * Omega * cm)
    square = sp.simplify(response * sp.conjugate(response))
    yield (
        r"\begin{theorem}[a bound for ever]\label{thm:events-steady} Away from undamped resonance "
        r"($\Delta > 0$) let $V(t)$ be the steady velocity, which has the frequency $\Omega$ and "
        r"the amplitude $V_0$ with",
        equation(
            steady,
            LETTER_A**2 / DELTA,
            {steady: square, LETTER_A: B0 * Omega / m, DELTA: NORMS[DELTA]},
            "V0",
        ),
        r"and let $u = \dot{x} - V$ be the transient. Then at all later times of the flight "
        r"$|g^{(4)}| \le C_4 = V_0\Omega^4 + \sqrt{(u^{(4)})^2 + (k/m)(u^{(3)})^2}$, with the "
        r"derivatives of $u$ taken now.\end{theorem}",
        r"\begin{proof} $L u = 0$, so $L u^{(3)} = 0$, and",
        equation(energy, -2 * cm * fourth**2, rate, "energy"),
        r"which is never positive:",
        step(energy, "<=", 0, sign({energy: rate})),
        r"so $|u^{(4)}|$ never exceeds the root of the present value, and $|V^{(4)}| \le "
        r"V_0\Omega^4$.\end{proof}",
    )
    z = sp.Function("z")(tau)
    w = named("w")
    w_rate = named(r"\dot{w}")
    second = named(r"\frac{d}{d\tau}\Bigl(\dot{w}^2 + \frac{k}{m}w^2\Bigr)")
    drive = LETTER_A * Omega**3 * sp.cos(theta)
    forced = -(LETTER_A * sp.sin(Omega * t)).diff(t, 3).subs(Omega * t, theta)
    pushed = (z.diff(tau) ** 2 + w0sq * z**2).diff(tau)
    pushed = (
        pushed.subs(z.diff(tau, 2), forced - cm * z.diff(tau) - w0sq * z)
        .subs(z.diff(tau), w_rate)
        .subs(z, w)
    )
    yield (
        r"\begin{theorem}[a bound for a while]\label{thm:events-while} In every regime, resonance "
        r"included, $|g^{(4)}| \le C_4 = \sqrt{\dot{w}^2 + (k/m) w^2} + |a|\,\Omega^2$ for the "
        r"next $1/\Omega$ of time, with $w = g^{(3)} = G^{(2,\alpha)}$ and $\dot{w} = "
        r"G^{(3,\alpha)}$ taken now.\end{theorem}",
        r"\begin{proof} The third derivative of \eqref{eq:events-gap} is",
        equation(
            named("L w"),
            drive,
            forced,
            "Lw",
        ),
        r"so that",
        equation(second, 2 * w_rate * (drive - cm * w_rate), pushed, "pushed"),
        r"which is at most $2|a|\Omega^3\,|\dot{w}|$, and the root of $\dot{w}^2 + (k/m)w^2$ grows "
        r"at most at the rate $|a|\Omega^3$: in $1/\Omega$ by no more than $|a|\Omega^2 = "
        r"|B_0|\Omega^3/m$.\end{proof}",
    )


def _search() -> Items:
    """Yield the items on the search, and that it ends."""
    s = sp.Symbol("s", positive=True)
    left = named("p(s)")
    values = [named(name) for name in ("g", r"\dot{g}", r"\ddot{g}", "g^{(3)}")]
    taylor = sp.Add(*(value * s**n / sp.factorial(n) for n, value in enumerate(values)))
    remainder = integrated(C4)
    lowest = integrated(-C4, *reversed(values))
    upper = named(r"g(\tau + s) - p(s)")
    yield (
        r"\subsection{The search, and that it ends}",
        r"\begin{lemma}[a polynomial below the gap]\label{thm:events-below} Let $g > 0$ now (for "
        r"$g < 0$ take $-g$), and",
        equation(left, taylor - C4 * s**4 / 24, lowest, "p"),
        r"Then $g(\tau + s) \ge p(s)$ for all later times for which $C_4$ is a bound, and",
        step(upper, "<=", C4 * s**4 / 12, sign({upper: 2 * remainder}), "excess"),
        r"\end{lemma}",
        r"\begin{proof} Taylor's theorem with the remainder $\int_0^s (s - u)^3 g^{(4)}(\tau + "
        r"u)\,du/6$, which is at most $C_4 s^4/24$ in size.\end{proof}",
        r"\begin{theorem}[no event is missed, and the search ends]\label{thm:events-search} Let "
        r"the search go from $\tau$ to $\tau + s$ with the first positive zero $s$ of $p$, or as "
        r"far as the bound holds if that is less, and so on. No zero of $g$ is passed. The search "
        r"either passes every given time in finitely many steps, or its points converge to the "
        r"first zero of $g$; and after each step that ends at a zero of $p$, $0 \le g \le C_4 "
        r"s^4/12$.\end{theorem}",
        r"\begin{proof} $g \ge p > 0$ before the zero of $p$: nothing is passed. The points "
        r"increase. If they stay bounded, they converge to some $\tau^*$. If $g(\tau^*) \ne 0$, "
        r"then $g \ge \delta > 0$ on the way for some $\delta$, while the steps shrink to 0. But "
        r"$g$, its derivatives and $C_4$ are bounded by some $K$ on the way, so $p(s) \ge \delta - "
        r"K(s + s^2/2 + s^3/6 + s^4/24) > 0$ for all $s$ below a positive number that does not "
        r"depend on the step: a contradiction. The last statement is \eqref{eq:events-excess} with "
        r"$p(s) = 0$.\end{proof}",
        r"At a start on the boundary $g = 0$ is no event: the known zero is divided out of $p$, "
        r"one factor $s$ for each derivative that vanishes, and the argument holds for the "
        r"quotient. Near a simple zero the steps converge to fourth order, and "
        r"\texttt{symosc.engine} changes to Newton's method once $p$ shows that there is one zero "
        r"nearby. Near a tangency it looks for the minimum of $g$ ahead: positive, negative, or "
        r"undecided with the digits at hand, which it then reports.",
        r"This is a proof in real arithmetic. With rounded numbers each value of $g$ is known to a "
        r"few units of its last digit only, and decisions leave margins for that, which are named "
        r"in \texttt{symosc.engine}; that they are wide enough in double precision was measured, "
        r"not proven.",
    )


def integrated(rate: Any, *starts: Any) -> Any:
    """Return the function of s whose fourth derivative is `rate`.

    `starts` has its third to its own value at 0.
    """
    s = sp.Symbol("s", positive=True)
    for start in starts or (0, 0, 0, 0):
        rate = start + sp.integrate(rate, (s, 0, s))
    return rate
