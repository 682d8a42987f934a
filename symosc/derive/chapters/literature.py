"""Published results on the oscillator with Coulomb friction: derived, and compared with what this package computes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.blocks import block, proof
from symosc.derive.latex import named
from symosc.derive.literature_pieces import RELATION, free_motion, numbers, steady_part
from symosc.derive.scope import Scope
from symosc.derive.steps import Exact, Heading, Prose, Relation, Step, equation
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import F, G, H, P, Q, S, U, V, d, p_0, phi, q_0, r, x_0, x_f
from symosc.symbolic.solution import BASIS, E0, E1, E2, FN, Omega, c, cm, k, m, tau, w0sq

TITLE = "Published results that the model contains"

# Names of what is derived: trace and determinant of the free motion over half a period, and of what it does to a
# perturbation; accelerations before and after a turning point.
T, D, T_h, D_h = (named(name) for name in ("T", "D", "T_h", "D_h"))
RHO, LAMBDA = named(r"\rho"), (named(r"\lambda_1"), named(r"\lambda_2"))
A_MINUS, A_PLUS = named(r"\ddot{x}_-"), named(r"\ddot{x}_+")
B, B_0, LARGEST = named(r"B(\varphi)"), named("B(0)"), named(r"B_*", positive=True)
UNDAMPED = {cm: 0, c: 0, G: 0, Omega: r * sp.sqrt(w0sq)}


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"With $A_0 = 0$, $B_0 = P$, $v_1 = 0$, $\mu_1 F_N = F$, $\mu_2 = 0$ and a belt 2 that is faster than the mass "
        r"ever gets, the model is the oscillator $m \ddot{x} + c \dot{x} + k x = P \cos\Omega t - F \operatorname{sgn} "
        r"\dot{x}$ on which much has been published. In this chapter $x_f = F/k$ and $r = \Omega\sqrt{m/k}$; its other "
        r"letters hold in this chapter only. Each number in its tables stands there twice: computed from a formula or "
        r"from equations with 50 digits, and found by this package, which does not know the formula (\emph{run}). "
        r"Where nothing else is said, $m = k = P = F_N = 1$ and $c = 0$."
    )
    yield from _symmetric_motion()
    yield from _stability()
    yield from _border()
    yield from _growth_and_decay()
    yield from _stops()
    yield from _continuum()
    yield from _rests()


# --- the motion without stops ---


def _symmetric_motion() -> Iterator[Any]:
    yield Heading("The symmetric motion without stops")
    u_0, w_0 = named("u_0"), named(r"\dot{u}_0")
    yield Prose(
        r"Den Hartog \cite{denhartog1930,denhartog1931} found this motion. Let $x(t + \pi/\Omega) = -x(t)$, let $x_0$ be its highest point and $\varphi$ the angle $\Omega t$ since "
        r"then. For $0 < \varphi < \pi$ the mass moves down and friction is $+F$, so that $x = x_f + p_0 \cos\varphi + "
        r"q_0 \sin\varphi + u$ with a free motion $u$. It starts at $u_0 = x_0 - p_0 - x_f$ with the velocity "
        r"$\dot{u}_0 = -\Omega q_0$. The basis functions are those of Definition~\ref{thm:domains-basis}, "
        r"taken at $\tau = \pi/\Omega$ unless another time is named."
    )
    x, v = free_motion(u_0, w_0)
    ends = named(r"u(\tau)"), named(r"\dot{u}(\tau)")
    matrix = coulomb.transition() * sp.Matrix([u_0, w_0])
    reason = r"By Theorem~\ref{thm:domains-flow} without forces,"
    for name, shown, meaning in zip(ends, matrix, (x, v), strict=True):
        check = Exact({name: meaning, **RELATION}, sp.expand)
        yield equation(name, shown, reason, check)
        reason = ""
    stiffness, damping = k - m * Omega**2, c * Omega
    push = sp.sqrt((stiffness * p_0 + damping * q_0) ** 2 + (stiffness * q_0 - damping * p_0) ** 2)
    yield equation(
        P**2,
        (stiffness**2 + damping**2) * (p_0**2 + q_0**2),
        r"The steady part obeys the equation of motion without friction: $P\cos\Omega t$ is $(k - m\Omega^2) p_0 + "
        r"c\Omega q_0$ at $\varphi = 0$ and $(k - m\Omega^2) q_0 - c\Omega p_0$ a quarter of a period later. So",
        Exact({P: push}, sp.expand),
    )
    yield Prose(r"Call $Q = \sqrt{p_0^2 + q_0^2}$: the amplitude that the mass would have without friction.")
    yield from _conditions()
    yield from _closed_forms()
    yield numbers("amplitude", r"The highest point by \eqref{eq:literature-amplitude}, and on the orbit $P_{32}$.")


def _conditions() -> Iterator[Any]:
    solved = coulomb.half_period()
    meaning = {p_0: x_0 + G * x_f, q_0: H * x_f, G: solved.G, H: solved.H}
    reason = r"Half a period later position and velocity are those of the start, negated:"
    for row in coulomb.symmetry():
        yield Step(Relation(sp.Integer(0), "=", row), reason, Exact(meaning))
        reason = ""
    matrix = coulomb.transition()
    traces = {T: matrix.trace(), D: matrix.det()}
    yield equation(
        p_0, x_0 + G * x_f, "These equations are linear in $p_0$ and $q_0$. They are solved by", Exact(steady_part())
    )
    yield equation(q_0, H * x_f, "", Exact(steady_part()))
    below = 1 + T + D
    yield equation(G, (1 - D - cm * E1) / below, "with", Exact({G: solved.G, **traces, **RELATION}))
    yield equation(H, 2 * w0sq * E1 / (Omega * below), "", Exact({H: solved.H, **traces, **RELATION}))
    yield equation(T, E0 + 1 - w0sq * E2, "where trace and determinant of the free motion are", Exact(traces))
    yield equation(D, E0 - w0sq * (E0 * E2 - E1**2), "", Exact(traces))
    yield equation(
        x_0,
        coulomb.amplitude(),
        "so that $Q$ decides on the amplitude, which exists for $Q > |H| x_f$:",
        Exact({Q: sp.sqrt(named("y", positive=True) ** 2 + H**2 * x_f**2), x_0: -G * x_f + named("y", positive=True)}),
        label="literature-amplitude",
    )


def _closed_forms() -> Iterator[Any]:
    regimes, solved = solution.REGIMES, coulomb.half_period()
    printed = coulomb.den_hartog_damped()

    def tidy(expr: Any) -> Any:
        return sp.simplify(sp.expand(sp.numer(sp.together(expr.rewrite(sp.exp)))))

    reason = r"For $0 < c^2 < 4 k m$ this is Den Hartog's form, with $h = c/2m$ and $\omega_d^2 = k/m - h^2$:"
    for letter, shown, derived in zip((G, H), printed, solved, strict=True):
        yield equation(letter, shown, reason, Exact({letter: coulomb.closed(derived, regimes["underdamped"])}, tidy))
        reason = ""
    free = regimes["undamped"]
    undamped = {solution.omega_0: Omega / r}
    G_0, H_0 = (coulomb.closed(part, free).subs(undamped) for part in solved)
    reason = r"For $c = 0$, with $Q = P |V|/k$,"
    yield equation(G, sp.Integer(0), reason, Exact({G: G_0}))
    forms = coulomb.den_hartog_undamped()
    yield equation(H, forms[U], "", Exact({H: H_0}), r"$= U = \frac{1}{r}\tan\frac{\pi}{2 r}$")
    yield equation(V, forms[V], "", Exact({V: k / (k - m * Omega**2), Omega: r * sp.sqrt(k / m)}))
    yield equation(
        x_0**2,
        V**2 * P**2 / k**2 - U**2 * x_f**2,
        "",
        Exact({x_0: coulomb.amplitude().subs(G, 0), Q: P * sp.Abs(V) / k, H: U}),
    )


# --- stability ---


def _stability() -> Iterator[Any]:
    yield Heading("Its multipliers")
    push = (k - m * Omega**2) * p_0 + c * Omega * q_0
    yield Prose(
        r"At the highest point friction changes its sign, and with it the acceleration jumps from $\ddot{x}_-$ to "
        r"$\ddot{x}_+$; see Shaw \cite{shaw1986}, and Theorem~\ref{thm:jacobians-saltation}. A motion beside the symmetric one, ahead by the velocity $\delta$, turns $\mathrm{d}t$ later."
    )
    reason = r"From the equation of motion, and with the steady part written as $p_0$ and $q_0$:"
    letters = {c: m * cm, k: m * w0sq}
    for name, after in ((A_MINUS, False), (A_PLUS, True)):
        force = (push - k * x_0 + (k * x_f if after else -k * x_f)) / m
        yield equation(name, coulomb.turning_acceleration(after), reason, Exact({name: force.subs(letters)}))
        reason = ""
    delta, dt, later = named(r"\delta"), named(r"\mathrm{d}t"), named(r"\delta_+")
    turned = {later: -A_PLUS * dt, dt: -delta / A_MINUS, RHO: A_PLUS / A_MINUS}
    reason = r"With $\delta + \ddot{x}_- \mathrm{d}t = 0$ the velocity behind the turn is, to first order,"
    yield equation(later, RHO * delta, reason, Exact(turned), r"with $\rho = \ddot{x}_+/\ddot{x}_-$.")
    root, half = named("R"), coulomb.half_period_matrix(RHO)
    meaning = {T_h: half.trace(), D_h: half.det(), T: coulomb.transition().trace(), D: coulomb.transition().det()}
    yield equation(
        T_h,
        1 - w0sq * E2 + RHO * E0,
        r"So half a period takes a perturbation $(x, v)$ through the free motion and then multiplies $v$ by $\rho$. "
        r"The other half does the same, so the multipliers are the squares of the eigenvalues of that matrix, whose "
        r"trace and determinant are",
        Exact(meaning),
    )
    yield equation(D_h, RHO * D, "", Exact(meaning))
    squares = dict(zip(LAMBDA, (((T_h + sign * root) / 2) ** 2 for sign in (1, -1)), strict=True))
    squares |= {root: sp.sqrt(T_h**2 - 4 * D_h)}
    yield equation(LAMBDA[0] + LAMBDA[1], T_h**2 - 2 * D_h, "and", Exact(squares, sp.expand))
    yield equation(LAMBDA[0] * LAMBDA[1], D_h**2, "", Exact(squares, sp.expand))
    undamped = {RHO: coulomb.ratio(), **UNDAMPED}
    shown = (r**2 * x_0 - x_f) / (r**2 * x_0 + x_f)
    yield equation(RHO, shown, r"For $c = 0$", Exact(undamped), "and")
    turn = {T_h: (1 + RHO) * sp.cos(sp.pi / r), D_h: RHO}
    yield equation(1 - T_h + D_h, (1 + RHO) * (1 - sp.cos(sp.pi / r)), "", Exact(turn, sp.expand))
    yield equation(1 + T_h + D_h, (1 + RHO) * (1 + sp.cos(sp.pi / r)), "", Exact(turn, sp.expand))
    yield Prose(
        r"On an orbit $0 \le \rho < 1$. So both multipliers lie inside the unit circle, except at $r = 1/n$: for odd "
        r"$n$ there $U$ is infinite and the motion does not exist; for even $n$ one multiplier is 1."
    )
    yield numbers("stability", "The multipliers by these formulas, and from the monodromy matrix of $P_{32}$.")


# --- where it ends ---


def _border() -> Iterator[Any]:
    yield Heading("Where the motions without stops end")
    steady = {p_0: x_0 + G * x_f, q_0: H * x_f}
    _, rate = free_motion(x_0 - p_0 - x_f, -Omega * q_0)
    speed = sp.expand((rate / Omega - p_0 * sp.sin(phi) + q_0 * sp.cos(phi)).subs(steady))
    least = sp.solve(speed.subs(x_0, p_0 - G * x_f), p_0)[0] / x_f
    yield equation(
        B,
        coulomb.slide_function(),
        r"For this border see \cite{denhartog1930,hongliu2000}. The mass has to move down at all angles $0 < \varphi < \pi$, and its velocity there is linear in $p_0$ and "
        r"$x_f$: $\dot{x} < 0$ if and only if $p_0 > B(\varphi)\, x_f$. With $E_0$, $E_1$ at $\tau = \varphi/\Omega$,",
        Exact({B: least, **RELATION}),
    )
    start = sp.solve(coulomb.turning_acceleration(True).subs({q_0: H * x_f, x_0: p_0 - G * x_f}), p_0)[0] / x_f
    yield equation(
        B_0,
        (1 + G) * w0sq / Omega**2 + H * cm / Omega,
        r"At the turning point the same is said by $\ddot{x}_+ < 0$, and $B$ has the limit",
        Exact({B_0: start}),
    )
    stiffness = (k - m * Omega**2) ** 2 + (c * Omega) ** 2
    at_border = {P: sp.sqrt(stiffness * (LARGEST**2 + H**2)) * x_f, F: k * x_f}
    yield equation(
        P**2 / F**2,
        stiffness * (LARGEST**2 + H**2) / k**2,
        r"Let $B_*$ be the largest value of $B$ on $0 \le \varphi < \pi$. The motion exists for $p_0 > B_* x_f$, and "
        r"ends where $p_0 = B_* x_f$, $q_0 = H x_f$:",
        Exact(at_border),
    )
    free = solution.REGIMES["undamped"]
    closed = coulomb.closed(coulomb.slide_function(), free, phi / Omega).subs(solution.omega_0, Omega / r)
    yield equation(
        S,
        coulomb.den_hartog_undamped()[S],
        r"For $c = 0$ and with $S = r^2 B$ this is $F/P < |V|/\sqrt{U^2 + S_*^2/r^4}$:",
        Exact({S: r**2 * closed.subs(G, 0), H: U}),
    )
    yield numbers(
        "border",
        r"Where the motions without stops end: $B_*$ with 50 digits; and where the number of stops of the settled "
        r"motion changes, bisected in the forced amplitude.",
    )


# --- growth, decay ---


def _growth_and_decay() -> Iterator[Any]:
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


def _stops() -> Iterator[Any]:
    yield Heading("Stops per cycle")
    yield Prose(
        r"Hong and Liu \cite{hongliu2000} sort the settled motions for $c = 0$ by their number of stops per cycle: 0, "
        r"1, 2, 4, 6, \ldots, 14. Half a cycle with $n$ stops is $n$ slides down. Each starts where a stop ends, "
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
        r"rest the difference is constant, and as both leave with the same friction it is 0. So a difference that is "
        r"not 0 is a free motion that changes its sign after half a period of the drive, and as a difference of "
        r"periodic motions closes with it: $r = 1/(2n)$. While one of the two stops the other one stops too, or the "
        r"friction of the first one would be constant: a stop that is alone has no length."
    )
    yield Prose(
        r"At $r = 1/(2n)$ one stop per cycle is what is seen: it gets shorter from cycle to cycle, and its length "
        r"tends to 0."
    )


# --- continua ---


def _continuum() -> Iterator[Any]:
    yield Heading("Continua of motions without stops")
    n = sp.Symbol("n", integer=True, positive=True)
    closed = {name: coulomb.closed(name, solution.REGIMES["undamped"]) for name in BASIS[:3]}
    at = {r: 1 / (2 * n), solution.omega_0: 2 * n * Omega, w0sq: (2 * n * Omega) ** 2}
    meaning = {E0: closed[E0].subs(at), E1: closed[E1].subs(at), E2: closed[E2].subs(at)}
    reason = r"See \cite{csernak2007}. At $r = 1/(2n)$, $c = 0$ half a period is $n$ periods of the free motion, which comes back:"
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


def _rests() -> Iterator[Any]:
    yield Heading("Rest positions on a belt at rest")
    low, high, B0, A = named("x_-"), named("x_+"), solution.B0, solution.A0
    mu, other = solution.mu1, solution.mu2
    ends = {low: (A - (mu - other) * FN + B0) / k, high: (A + (mu + other) * FN - B0) / k}
    yield equation(
        high - low,
        2 * (mu * FN - B0) / k,
        r"For $c > 0$ a periodic motion is the only one, except on a belt at rest (Theorem~\ref{thm:orbits-unique}). Let "
        r"$v_1 = 0$. The mass stays at $x$ for ever if $F^{(1)} \ge 0 \ge F^{(2)}$ at all phases, $k x \le A_1 - "
        r"|B_0|$ and $k x \ge A_2 + |B_0|$. These $x$ form an interval of the length",
        Exact(ends, sp.expand),
        r"for $0 \le B_0 \le \mu_1 F_N$; of a negative $B_0$ take the size.",
    )
    yield Prose(r"The map over a period leaves every rest where it is, so that its multiplier along the interval is 1.")
    yield numbers(
        "rests",
        r"For $m = c = k = \Omega = F_N = \mu_1 = 1$, $A_0 = v_1 = 0$, $B_0 = \mu_2 = \frac{1}{10}$: the ends of the "
        r"interval, and where motions from inside it are at $t = 60$.",
    )
