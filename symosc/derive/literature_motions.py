"""The other motions of the chapter on published results: growth, decay, stops, continua and rests."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.blocks import block, proof
from symosc.derive.latex import named
from symosc.derive.literature_pieces import LAMBDA, numbers
from symosc.derive.steps import Exact, Heading, Prose, equation
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import F, P, d, phi, r, x_0, x_f
from symosc.symbolic.solution import BASIS, E0, E1, E2, FN, Omega, k, m, tau, w0sq

# --- growth, decay ---


def growth_and_decay() -> Iterator[Any]:
    """Yield the growth at resonance and the decay without a drive."""
    yield Heading("Resonance and free decay")
    growth, loss = named(r"\Delta x"), named("L")
    yield equation(
        growth,
        (sp.pi * P - 4 * F) / k,
        r"At $r = 1$, $c = 0$ let the highest point $x_0 > x_f$ be at $\Omega t = \pi/2$, so that the drive has the "
        r"sign of the velocity. The flow of the regime \emph{resonance} then has its next turning point half a period "
        r"later, at $-x_0 - \frac{1}{2} \Delta x$. So a cycle raises the highest point by",
        Exact({growth: coulomb.resonance_growth()}),
        "and there is no bound if $F < \\pi P/4$.",
    )
    yield numbers(
        "resonance",
        r"Growth per cycle at resonance; run: the cycle that differs most, of a motion from $x = (\frac{1}{2} P - "
        r"F)/k$ at $t = 0$.",
    )
    yield equation(
        loss,
        2 * F / k,
        r"Without a drive and for $c = 0$ half a cycle takes $x_0 > x_f$ to $-(x_0 - L)$, and the mass stays at the "
        r"first turning point with $|x| \le x_f$:",
        Exact({loss: coulomb.free_decay(), x_f: F / k}),
    )
    yield numbers("decay", r"Turning points from $x = 0.95$; at the last one the package says \emph{equilibrium}.")


# --- stops ---


def stops() -> Iterator[Any]:
    """Yield how many stops a cycle has."""
    yield Heading("Stops per cycle")
    yield Prose(
        r"Hong and Liu \cite{hongliu2000} sort the settled motions for $c = 0$ by their number of stops per cycle: 0, "
        r"1, 2, 4, 6, $\ldots$, 14. Half a cycle with $n$ stops is $n$ slides down. Each starts where a stop ends, "
        r"$P\cos\theta_j - k x_j + F = 0$, and ends at rest, the last one at $-x_1$: $2 n$ equations for $n$ phases "
        r"and $n$ durations. The number changes where a slide comes to rest on its way for a moment, $\dot{x} = "
        r"\ddot{x} = 0$ (a stop of no length is born), or where a stop lasts until the drive just reaches what would "
        r"move it, $x_j = (F - P)/k$ at $\theta = \pi$ (a slide of no length is born)."
    )
    yield numbers(
        "stops",
        r"Where the number of stops changes: these equations with 50 digits; and bisection of the forced amplitude.",
    )
    yield from block(
        "proposition",
        r"Let $c = 0$. A periodic motion that is not its own mirror image, and with it every motion with an odd number "
        r"of stops per cycle, needs $r = 1/(2n)$ with a whole number $n$. Its stops that its mirror image does not "
        r"share have no length.",
        title="odd numbers of stops",
        label="thm:literature-odd",
    )
    yield from proof(
        r"The mirror image $-x(t + \pi/\Omega)$ is a motion too. The difference of the two keeps its energy (proof of "
        r"Theorem~\ref{thm:orbits-unique}): friction is the same in both whenever their velocities differ. While both "
        r"rest the difference is constant, and as both leave with the same friction it is 0. So the difference "
        r"$x(t) + x(t + \pi/\Omega)$, if it is not 0, is a free motion. It is the same after half a period of the "
        r"drive, which therefore is $n$ periods of the free motion: $r = 1/(2n)$. While one of the two "
        r"stops the other one stops too, or the "
        r"friction of the first one would be constant: a stop that is alone has no length."
    )
    yield Prose(
        r"At $r = 1/(2n)$ one stop per cycle is what is seen: it gets shorter from cycle to cycle, and its length "
        r"tends to 0."
    )


# --- continua ---


def continuum() -> Iterator[Any]:
    """Yield the motions that are not isolated."""
    yield Heading("Continua of motions without stops")
    n = sp.Symbol("n", integer=True, positive=True)
    closed = {name: coulomb.closed(name, solution.REGIMES["undamped"]) for name in BASIS[:3]}
    at = {r: 1 / (2 * n), solution.omega_0: 2 * n * Omega, w0sq: (2 * n * Omega) ** 2}
    meaning = {E0: closed[E0].subs(at), E1: closed[E1].subs(at), E2: closed[E2].subs(at)}
    reason = (
        r"See \cite{csernak2007}. At $r = 1/(2n)$, $c = 0$ half a period is $n$ periods of the free motion, which "
        r"comes back:"
    )
    yield equation(E0, sp.Integer(1), reason, Exact(meaning))
    yield equation(E1, sp.Integer(0), "", Exact(meaning))
    yield equation(E2, sp.Integer(0), "", Exact(meaning))
    yield equation(
        x_0,
        P / (k * (1 - r**2)),
        r"So $G = H = 0$: the amplitude does not depend on the friction,",
        Exact({x_0: P / (k - m * Omega**2), Omega: r * sp.sqrt(k / m)}),
    )
    rate = named(r"\dot{x}")
    wave = solution.omega_0 * sp.sin(solution.omega_0 * tau) / Omega**2
    exact = {rate: Omega * coulomb.one_sided_velocity(), E1: wave * Omega**2 / solution.omega_0**2, tau: phi / Omega}
    exact |= {w0sq: solution.omega_0**2, solution.omega_0: 2 * n * Omega}
    yield equation(
        rate,
        2 * n * Omega * (x_f - d) * sp.sin(2 * n * phi) - Omega * x_0 * sp.sin(phi),
        r"and a free motion $d \cos(\varphi/r)$ may be added to the symmetric one. Its turning points are then $d + "
        r"x_0$ and $d - x_0$, at the same times. On the way down",
        Exact(exact),
    )
    yield Prose(
        r"and on the way up $-\dot{x}$ is the same with $x_f + d$ in place of $x_f - d$. As $|\sin 2 n\varphi| \le 2 n "
        r"\sin\varphi$, with equality in the limit at the turning points only, there is no stop if and only if $|d| < "
        r"r^2 x_0 - x_f$: a continuum of orbits. At its end one of the two turning points is a stop of no length."
    )
    ratios = [(r**2 * x_0 + side * d - x_f) / (r**2 * x_0 + side * d + x_f) for side in (1, -1)]
    yield equation(
        LAMBDA[1],
        ((r**2 * x_0 - x_f) ** 2 - d**2) / ((r**2 * x_0 + x_f) ** 2 - d**2),
        r"One multiplier is 1, along the continuum. The other one is the product of the two ratios of accelerations:",
        Exact({LAMBDA[1]: ratios[0] * ratios[1]}),
    )
    yield numbers(
        "continuum",
        r"Members of the continua, which the package calls marginal: turning points and the second multiplier. Their "
        r"middle $\bar{x}$ is $d$. The end $d_*$ is bisected in $d$, by whether the motion stops.",
    )


# --- rests ---


def rests() -> Iterator[Any]:
    """Yield the rests on a belt."""
    yield Heading("Rest positions on a belt at rest")
    low, high, B0, A = named("x_-"), named("x_+"), solution.B0, solution.A0
    mu, other = solution.mu1, solution.mu2
    ends = {low: (A - (mu - other) * FN + sp.Abs(B0)) / k, high: (A + (mu + other) * FN - sp.Abs(B0)) / k}
    yield equation(
        high - low,
        2 * (mu * FN - sp.Abs(B0)) / k,
        r"For $c > 0$ a periodic motion is the only one, except on a belt at rest "
        r"(Theorem~\ref{thm:orbits-unique}). Let $v_1 = 0$. The mass stays at $x$ for ever "
        r"if $F^{(1)} \ge 0 \ge F^{(2)}$ at all phases, $k x \le A_1 - "
        r"|B_0|$ and $k x \ge A_2 + |B_0|$. These $x$ form an interval of the length",
        Exact(ends, sp.expand),
        r"for $|B_0| \le \mu_1 F_N$.",
    )
    yield Prose(r"The map over a period leaves every rest where it is, so that its multiplier along the interval is 1.")
    yield numbers(
        "rests",
        r"For $m = c = k = \Omega = F_N = \mu_1 = 1$, $A_0 = v_1 = 0$, $B_0 = \mu_2 = \frac{1}{10}$: the ends of the "
        r"interval, and where motions from inside it are at $t = 60$.",
    )
