"""Published results on the oscillator with Coulomb friction: derived, and compared with what this package computes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive import literature_motions
from symosc.derive.latex import named
from symosc.derive.literature_pieces import LAMBDA, RELATION, free_motion, numbers, steady_part
from symosc.derive.scope import Scope
from symosc.derive.steps import Exact, Heading, Prose, Relation, Step, equation
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import F, G, H, P, Q, S, U, V, p_0, phi, q_0, r, x_0, x_f
from symosc.symbolic.solution import E0, E1, E2, Omega, c, cm, k, m, w0sq

TITLE = "Published results that the model contains"

# Names of what is derived: trace and determinant of the free motion over half a period, and of what it does to a
# perturbation; accelerations before and after a turning point.
T, D, T_h, D_h = (named(name) for name in ("T", "D", "T_h", "D_h"))
RHO = named(r"\chi")
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
    yield from literature_motions.growth_and_decay()
    yield from literature_motions.stops()
    yield from literature_motions.continuum()
    yield from literature_motions.rests()


# --- the motion without stops ---


def _symmetric_motion() -> Iterator[Any]:
    yield Heading("The symmetric motion without stops")
    u_0, w_0 = named("u_0"), named(r"\dot{u}_0")
    yield Prose(
        r"Den Hartog \cite{denhartog1930,denhartog1931} found this motion. Let $x(t + \pi/\Omega) = -x(t)$, let $x_0$ "
        r"be its highest point and $\varphi$ the angle $\Omega t$ since then. For $0 < \varphi < \pi$ the mass moves "
        r"down and friction is $+F$, so that $x = x_f + p_0 \cos\varphi + q_0 \sin\varphi + u$ with a free motion $u$. "
        r"It starts at $u_0 = x_0 - p_0 - x_f$ with the velocity $\dot{u}_0 = -\Omega q_0$. The basis functions are "
        r"those of Definition~\ref{thm:domains-basis}, taken at $\tau = \pi/\Omega$ unless another time is named."
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

    reason = r"For $0 < c^2 < 4 k m$ this is Den Hartog's form, with $h = c/(2m)$ and $\omega_d^2 = k/m - h^2$:"
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
        r"$\ddot{x}_+$; see Shaw \cite{shaw1986}, and Theorem~\ref{thm:jacobians-saltation}. A motion beside the "
        r"symmetric one, ahead by the velocity $\delta$, turns $\mathrm{d}t$ later."
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
    yield equation(later, RHO * delta, reason, Exact(turned), r"with $\chi = \ddot{x}_+/\ddot{x}_-$.")
    root, half = named("R"), coulomb.half_period_matrix(RHO)
    meaning = {T_h: half.trace(), D_h: half.det(), T: coulomb.transition().trace(), D: coulomb.transition().det()}
    yield equation(
        T_h,
        1 - w0sq * E2 + RHO * E0,
        r"So half a period takes a perturbation $(x, \dot{x})$ through the free motion and then multiplies its "
        r"velocity by $\chi$. The other half does the same, so the multipliers $\rho_1$, $\rho_2$ are the squares of "
        r"the eigenvalues of that matrix, whose trace and determinant are",
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
        r"On an orbit $0 \le \chi < 1$, so that $D_h < 1$ too. If both sides above are positive, the eigenvalues lie "
        r"inside the unit circle by the conditions of Jury, and so do the multipliers. They vanish at $r = 1/n$ only: "
        r"for odd $n$ there $U$ is infinite and the motion does not exist; for even $n$ one multiplier is 1."
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
        r"For this border see \cite{denhartog1930,hongliu2000}. The mass has to move down at all angles "
        r"$0 < \varphi < \pi$, and its velocity there is linear in $p_0$ and "
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
