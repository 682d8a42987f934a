"""Published results on the oscillator with Coulomb friction: derived, and compared with what this
package computes.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import Any

import sympy as sp

from symosc.derive.latex import latex, named
from symosc.derive.published import GIVEN, MP, Value, number, resonance_start, table
from symosc.derive.scope import Scope
from symosc.derive.steps import Items, Step, StepError, Table, close, decimal, equation, exact
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import F, G, H, P, Q, S, U, V, d, p_0, phi, q_0, r, x_0, x_f
from symosc.symbolic.solution import BASIS, E0, E1, E2, FN, Omega, c, cm, k, m, omega_0, tau, w0sq

TITLE = "Published results that the model contains"
#: The basis functions are not independent.
RELATION = {E0: 1 - w0sq * E2 - cm * E1}
#: The multipliers.
LAMBDA = named(r"\rho_1"), named(r"\rho_2")

# Names of what is derived: trace and determinant of the free motion over half a period, and of what
# it does to a perturbation; accelerations before and after a turning point.
T, D, T_h, D_h = (named(name) for name in ("T", "D", "T_h", "D_h"))
RHO = named(r"\chi")
A_MINUS = named(r"\ddot{x}_-")
A_PLUS = named(r"\ddot{x}_+")
B = named(r"B(\varphi)")
B_0 = named("B(0)")
LARGEST = named(r"B_*", positive=True)
UNDAMPED = {cm: 0, c: 0, G: 0, Omega: r * sp.sqrt(w0sq)}


def items(scope: Scope) -> Items:
    """Yield the items of the chapter on published results: symmetric motion, borders, stops,
    continua, moving bases.
    """
    u_0 = named("u_0")
    w_0 = named(r"\dot{u}_0")
    x, v = _free_motion(u_0, w_0)
    x_u, v_u = coulomb.transition() * sp.Matrix([u_0, w_0])
    stiffness = k - m * Omega**2
    damping = c * Omega
    push = sp.sqrt((stiffness * p_0 + damping * q_0) ** 2 + (stiffness * q_0 - damping * p_0) ** 2)
    yield (
        r"With $A_0 = 0$, $B_0 = P$, $v_1 = 0$, $\mu_1 F_N = F$, $\mu_2 = 0$ and a belt 2 that "
        r"is faster than the mass "
        r"ever gets, the model is the oscillator $m \ddot{x} + c \dot{x} + k x = P \cos\Omega t "
        r"- F \operatorname{sgn} "
        r"\dot{x}$ on which much has been published. In this chapter $x_f = F/k$ and $r = "
        r"\Omega\sqrt{m/k}$; its other "
        r"letters hold in this chapter only. Each number in its tables stands there twice: "
        r"computed from a formula or "
        r"from equations with 50 digits, and found by this package, which does not know the "
        r"formula (\emph{run}). "
        r"Where nothing else is said, $m = k = P = F_N = 1$ and $c = 0$.",
        r"\subsection{The symmetric motion without stops}",
        r"Den Hartog \cite{denhartog1930,denhartog1931} found this motion. Let $x(t + "
        r"\pi/\Omega) = -x(t)$, let $x_0$ "
        r"be its highest point and $\varphi$ the angle $\Omega t$ since then. For $0 < \varphi < "
        r"\pi$ the mass moves "
        r"down and friction is $+F$, so that $x = x_f + p_0 \cos\varphi + q_0 \sin\varphi + u$ "
        r"with a free motion $u$. "
        r"It starts at $u_0 = x_0 - p_0 - x_f$ with the velocity $\dot{u}_0 = -\Omega q_0$. The "
        r"basis functions are "
        r"those of Definition~\ref{thm:domains-basis}, taken at $\tau = \pi/\Omega$ unless "
        r"another time is named.",
        r"By Theorem~\ref{thm:domains-flow} without forces,",
        equation(named(r"u(\tau)"), x_u, {named(r"u(\tau)"): x, **RELATION}),
        equation(named(r"\dot{u}(\tau)"), v_u, {named(r"\dot{u}(\tau)"): v, **RELATION}),
        r"The steady part obeys the equation of motion without friction: $P\cos\Omega t$ is $(k "
        r"- m\Omega^2) p_0 + "
        r"c\Omega q_0$ at $\varphi = 0$ and $(k - m\Omega^2) q_0 - c\Omega p_0$ a quarter of a "
        r"period later. So",
        equation(P**2, (stiffness**2 + damping**2) * (p_0**2 + q_0**2), {P: push}),
        r"Call $Q = \sqrt{p_0^2 + q_0^2}$: the amplitude that the mass would have without "
        r"friction.",
    )
    matrix = coulomb.transition()
    solved = dict(zip((G, H), coulomb.half_period(), strict=True))
    rows = coulomb.symmetry()
    both = rows.jacobian([p_0, q_0])
    found = both.adjugate() * (-rows.subs({p_0: 0, q_0: 0})) / both.det()
    steady = dict(zip((p_0, q_0), found, strict=True)) | solved
    meaning = {p_0: x_0 + G * x_f, q_0: H * x_f, **solved}
    traces = {T: matrix.trace(), D: matrix.det()}
    below = 1 + T + D
    root = named("y", positive=True)
    yield (
        r"Half a period later position and velocity are those of the start, negated:",
        [equation(0, row, meaning) for row in rows],
        "These equations are linear in $p_0$ and $q_0$. They are solved by",
        equation(p_0, x_0 + G * x_f, steady),
        equation(q_0, H * x_f, steady),
        "with",
        equation(G, (1 - D - cm * E1) / below, {**solved, **traces, **RELATION}),
        equation(H, 2 * w0sq * E1 / (Omega * below), {**solved, **traces, **RELATION}),
        "where trace and determinant of the free motion are",
        equation(T, E0 + 1 - w0sq * E2, traces),
        equation(D, E0 - w0sq * (E0 * E2 - E1**2), traces),
        "so that $Q$ decides on the amplitude, which exists for $Q > |H| x_f$:",
        equation(
            x_0,
            coulomb.amplitude(),
            {Q: sp.sqrt(root**2 + H**2 * x_f**2), x_0: -G * x_f + root},
            "amplitude",
        ),
    )
    regimes = solution.REGIMES
    forms = coulomb.den_hartog_undamped()
    damped = [coulomb.closed(part, regimes["underdamped"]) for part in solved.values()]
    undamped = [
        coulomb.closed(part, regimes["undamped"]).subs(omega_0, Omega / r)
        for part in solved.values()
    ]

    def tidy(expr: Any) -> Any:
        return sp.simplify(sp.expand(sp.numer(sp.together(expr.rewrite(sp.exp)))))

    highest = {x_0: coulomb.amplitude().subs(G, 0), Q: P * sp.Abs(V) / k, H: U}

    yield (
        r"For $0 < c^2 < 4 k m$ this is Den Hartog's form, with $h = c/(2m)$ and $\omega_d^2 = "
        r"k/m - h^2$:",
        [
            equation(letter, shown, exact({letter: derived}, tidy))
            for letter, shown, derived in zip(
                (G, H), coulomb.den_hartog_damped(), damped, strict=True
            )
        ],
        r"For $c = 0$, with $Q = P |V|/k$,",
        equation(G, 0, undamped[0]),
        equation(H, forms[U], undamped[1], note=r"$= U = \frac{1}{r}\tan\frac{\pi}{2 r}$"),
        equation(V, forms[V], {V: k / (k - m * Omega**2), Omega: r * sp.sqrt(k / m)}),
        equation(x_0**2, V**2 * P**2 / k**2 - U**2 * x_f**2, highest),
        _numbers(
            "amplitude",
            r"The highest point by \eqref{eq:literature-amplitude}, and on the orbit $P_{32}$.",
        ),
    )
    push = (k - m * Omega**2) * p_0 + c * Omega * q_0
    before, after = (
        (push - k * x_0 + side * k * x_f).subs({c: m * cm, k: m * w0sq}) / m for side in (-1, 1)
    )
    delta = named(r"\delta")
    dt = named(r"\mathrm{d}t")
    later = named(r"\delta_+")
    turned = {later: -A_PLUS * dt, dt: -delta / A_MINUS, RHO: A_PLUS / A_MINUS}
    root = named("R")
    half = coulomb.half_period_matrix(RHO)
    meaning = {
        T_h: half.trace(),
        D_h: half.det(),
        T: coulomb.transition().trace(),
        D: coulomb.transition().det(),
    }
    squares = dict(zip(LAMBDA, (((T_h + sign * root) / 2) ** 2 for sign in (1, -1)), strict=True))
    squares |= {root: sp.sqrt(T_h**2 - 4 * D_h)}
    turn = {T_h: (1 + RHO) * sp.cos(sp.pi / r), D_h: RHO}
    yield (
        r"\subsection{Its multipliers}",
        r"At the highest point friction changes its sign, and with it the acceleration jumps "
        r"from $\ddot{x}_-$ to "
        r"$\ddot{x}_+$; see Shaw \cite{shaw1986}, and Theorem~\ref{thm:jacobians-saltation}. A "
        r"motion beside the "
        r"symmetric one, ahead by the velocity $\delta$, turns $\mathrm{d}t$ later.",
        r"From the equation of motion, and with the steady part written as $p_0$ and $q_0$:",
        equation(A_MINUS, coulomb.turning_acceleration(False), before),
        equation(A_PLUS, coulomb.turning_acceleration(True), after),
        r"With $\delta + \ddot{x}_- \mathrm{d}t = 0$ the velocity behind the turn is, to first "
        r"order,",
        equation(later, RHO * delta, turned, note=r"with $\chi = \ddot{x}_+/\ddot{x}_-$."),
        r"So half a period takes a perturbation $(x, \dot{x})$ through the free motion and then "
        r"multiplies its "
        r"velocity by $\chi$. The other half does the same, so the multipliers $\rho_1$, "
        r"$\rho_2$ are the squares of "
        r"the eigenvalues of that matrix, whose trace and determinant are",
        equation(T_h, 1 - w0sq * E2 + RHO * E0, meaning),
        equation(D_h, RHO * D, meaning),
        "and",
        equation(LAMBDA[0] + LAMBDA[1], T_h**2 - 2 * D_h, squares),
        equation(LAMBDA[0] * LAMBDA[1], D_h**2, squares),
        r"For $c = 0$",
        equation(
            RHO,
            (r**2 * x_0 - x_f) / (r**2 * x_0 + x_f),
            {RHO: coulomb.ratio(), **UNDAMPED},
            note="and",
        ),
        equation(1 - T_h + D_h, (1 + RHO) * (1 - sp.cos(sp.pi / r)), turn),
        equation(1 + T_h + D_h, (1 + RHO) * (1 + sp.cos(sp.pi / r)), turn),
        r"On an orbit $0 \le \chi < 1$, so that $D_h < 1$ too. If both sides above are positive, "
        r"the eigenvalues lie "
        r"inside the unit circle by the conditions of Jury, and so do the multipliers. They "
        r"vanish at $r = 1/n$ only: "
        r"for odd $n$ there $U$ is infinite and the motion does not exist; for even $n$ one "
        r"multiplier is 1.",
        _numbers(
            "stability",
            "The multipliers by these formulas, and from the monodromy matrix of $P_{32}$.",
        ),
    )
    steady = {p_0: x_0 + G * x_f, q_0: H * x_f}
    _, rate = _free_motion(x_0 - p_0 - x_f, -Omega * q_0)
    speed = sp.expand((rate / Omega - p_0 * sp.sin(phi) + q_0 * sp.cos(phi)).subs(steady))
    least = sp.solve(speed.subs(x_0, p_0 - G * x_f), p_0)[0] / x_f
    start = (
        sp.solve(coulomb.turning_acceleration(True).subs({q_0: H * x_f, x_0: p_0 - G * x_f}), p_0)[
            0
        ]
        / x_f
    )
    stiffness = (k - m * Omega**2) ** 2 + (c * Omega) ** 2
    at_border = {P: sp.sqrt(stiffness * (LARGEST**2 + H**2)) * x_f, F: k * x_f}
    free = solution.REGIMES["undamped"]
    closed = coulomb.closed(coulomb.slide_function(), free, phi / Omega).subs(omega_0, Omega / r)
    yield (
        r"\subsection{Where the motions without stops end}",
        r"For this border see \cite{denhartog1930,hongliu2000}. The mass has to move down at all "
        r"angles "
        r"$0 < \varphi < \pi$, and its velocity there is linear in $p_0$ and $x_f$: $\dot{x} < "
        r"0$ if and only if "
        r"$p_0 > B(\varphi)\, x_f$. With $E_0$, $E_1$ at $\tau = \varphi/\Omega$,",
        equation(B, coulomb.slide_function(), {B: least, **RELATION}),
        r"At the turning point the same is said by $\ddot{x}_+ < 0$, and $B$ has the limit",
        equation(B_0, (1 + G) * w0sq / Omega**2 + H * cm / Omega, start),
        r"Let $B_*$ be the largest value of $B$ on $0 \le \varphi < \pi$. The motion exists for "
        r"$p_0 > B_* x_f$, and "
        r"ends where $p_0 = B_* x_f$, $q_0 = H x_f$:",
        equation(P**2 / F**2, stiffness * (LARGEST**2 + H**2) / k**2, at_border, "border"),
        r"For $c = 0$ and with $S = r^2 B$ this is $F/P < |V|/\sqrt{U^2 + S_*^2/r^4}$:",
        equation(S, coulomb.den_hartog_undamped()[S], {S: r**2 * closed.subs(G, 0), H: U}),
        _numbers(
            "border",
            r"Where the motions without stops end: $B_*$ with 50 digits; and where the number of "
            r"stops of the settled "
            r"motion changes, bisected in the forced amplitude.",
        ),
    )
    n, j = (sp.Symbol(name, integer=True, positive=True) for name in "nj")
    ratio = named("F/P")
    inverse = named("1/U")
    next_sine = sp.sin(j * phi + phi)
    at = {r: 1 / (2 * n), LARGEST: 1, U: 0}
    odd = sp.cos(sp.expand(sp.pi * (2 * n + 1) / 2)) / (
        (2 * n + 1) * sp.sin(sp.expand(sp.pi * (2 * n + 1) / 2))
    )
    yield (
        r"\subsection{Where borders meet}",
        r"\begin{proposition}[points of codimension two]\label{thm:literature-points} "
        r"For $c = 0$ and $n = 1, 2, \ldots$ the border of the motions without stops passes "
        r"through the points "
        r"\cite{guardia2010}\begin{enumerate}"
        r"\item[$A_n$:] $r = 1/(2n)$, $F/P = 1/(4 n^2 - 1)$, where $S_*$ is the limit at both "
        r"turning points;"
        r"\item[$B_n$:] $r = 1/(2n + 1)$, $F/P = 0$.\end{enumerate}\end{proposition}",
        r"\begin{proof} First, $|\sin j\varphi| \le j\sin\varphi$ for $0 < \varphi < \pi$, by "
        r"induction with",
        equation(
            next_sine,
            sp.sin(j * phi) * sp.cos(phi) + sp.cos(j * phi) * sp.sin(phi),
            sp.expand_trig(sp.sin(j * phi + phi)),
            "sine",
        ),
        r"and the quotient tends to $j$ in size at $\varphi = 0$ and $\pi$. At $r = 1/(2n)$ one "
        r"has $U = 0$, so that "
        r"$S = r\sin(2n\varphi)/\sin\varphi$ has the supremum $S_* = 1$, and the border is at",
        equation(
            ratio, 1 / (4 * n**2 - 1), {ratio: sp.sqrt(r**4) / ((1 - r**2) * LARGEST), **at}, "A"
        ),
        r"At $r = 1/(2n + 1)$",
        equation(inverse, 0, {inverse: odd}, "B"),
        r"and the border, which is not above $|V/U|$, is at 0.\end{proof}",
        r"With damping $A_1$ becomes a point where crossing-sliding meets a graze next to the "
        r"turning point: "
        r"$\ddot{x}_+ = 0$ while the drive is largest, \eqref{eq:borders-rest}. In "
        r"Table~\ref{tab:literature-points} "
        r"it is near $A_1$ for $c = 0.001$.",
        _numbers(
            "points",
            r"Where borders meet. $A_n$: bisected in the friction, by whether the symmetric "
            r"motion stops. With "
            r"damping: two equations in $\Omega$ and $F$, in the formulas of this chapter and in "
            r"the switching points "
            r"of $P_{32}$.",
        ),
        _numbers(
            "ends",
            rf"The ends in $\Omega$ of the branch $P_{{32}}$ for {_given('ends')}, the "
            r"parameters of the "
            r"demo of \cite{iklodi2024} but for its static friction: "
            r"\eqref{eq:literature-border} with 50 digits, and "
            r"\texttt{continue\_orbit}.",
        ),
    )
    growth = named(r"\Delta x")
    slow = decimal("(P - F)/k", 1 - number(Fraction(GIVEN["slow"]["F"])), 1)
    loss = named("L")
    left = named("q")
    above = named("x_{i+1}")
    half = coulomb.closed(1 - w0sq * E2, solution.REGIMES["underdamped"], sp.pi / solution.omega_d)
    decay = {
        above: x_f + (named("x_i") - x_f) * half,
        left: sp.exp(-sp.pi * solution.h / solution.omega_d),
    }
    yield (
        r"\subsection{Resonance and free decay}",
        r"See \cite{butikov2015}. At $r = 1$, $c = 0$ let the highest point $x_0 > x_f$ be at "
        r"$\Omega t = \pi/2$, so "
        r"that the drive has the sign of the velocity. The flow of the regime \emph{resonance} "
        r"then has its next "
        r"turning point half a period later, at $-x_0 - \frac{1}{2} \Delta x$. So a cycle raises "
        r"the highest point by",
        equation(
            growth,
            (sp.pi * P - 4 * F) / k,
            coulomb.resonance_growth(),
            note=r"and there is no bound if $F < \pi P/4$.",
        ),
        _numbers(
            "resonance",
            r"Growth per cycle at resonance; run: the cycle that differs most, of a motion from "
            rf"$x = ({latex(resonance_start(P, F))})/k$.",
            equation(named("kx"), P / 2 - F, resonance_start(P, F)),
        ),
        r"Without a drive and for $c = 0$ half a cycle takes $x_0 > x_f$ to $-(x_0 - L)$, and "
        r"the mass stays at the "
        r"first turning point with $|x| \le x_f$:",
        equation(loss, 2 * F / k, {loss: coulomb.free_decay(), x_f: F / k}),
        _numbers(
            "decay",
            rf"Turning points from {_given('decay')}; at the last one the package says "
            rf"\emph{{equilibrium}}.",
        ),
        r"With a damper, $0 < c^2 < 4 k m$, half a cycle takes $\pi/\omega_d$ (compare "
        r"\cite{feeny1996}), and from a "
        r"highest point $x_i > x_f$, with $q = e^{-\pi h/\omega_d}$,",
        equation(
            above, -left * named("x_i") + (1 + left) * x_f, exact(decay, sp.simplify), "decrement"
        ),
        _numbers(
            "decrements",
            "Turning points from " + _given("decrements").replace(",", " for", 1) + ".",
        ),
        r"\subsection{Stops per cycle}",
        r"Hong and Liu \cite{hongliu2000} sort the settled motions for $c = 0$ by their number "
        r"of stops per cycle: 0, "
        r"1, 2, 4, 6, $\ldots$, 14. Half a cycle with $n$ stops is $n$ slides down. Each starts "
        r"where a stop ends, "
        r"$P\cos\theta_j - k x_j + F = 0$, and ends at rest, the last one at $-x_1$: $2 n$ "
        r"equations for $n$ phases "
        r"and $n$ durations. The number changes where a slide comes to rest on its way for a "
        r"moment, "
        r"$\dot{x} = \ddot{x} = 0$ (a stop of no length is born), or where a stop lasts until "
        r"the drive just reaches "
        r"what would move it, $x_j = (F - P)/k$ at $\theta = \pi$ (a slide of no length is born).",
        _numbers(
            "stops",
            r"Where the number of stops changes: these equations with 50 digits; and bisection "
            r"of the forced "
            r"amplitude.",
        ),
        r"The slower the drive, the more often the mass stops, while its highest point tends to "
        r"that of a quasi-static "
        r"motion, $(P - F)/k$ \cite{papangelo2015}; with critical damping it stops twice and is "
        r"near to it. The same "
        r"equations, in the basis functions of any regime, hold for $c > 0$.",
        _numbers(
            "slow",
            rf"The highest point of slowly driven motions, {_given('slow')}: $(P - F)/k = "
            rf"{latex(slow.right, True)}$.",
            slow,
        ),
        _numbers(
            "cycles",
            r"Where the mass stops in the two cases of the model of \cite{murari2026}, "
            rf"{_given('cycles')}.",
        ),
        r"\begin{proposition}[odd numbers of stops]\label{thm:literature-odd} "
        r"Let $c = 0$. A periodic motion with the period of the drive that is not its own mirror "
        r"image, and with it "
        r"every motion of this period with an odd number of stops per cycle, needs $r = 1/(2n)$ "
        r"with a whole number "
        r"$n$. Its stops that its mirror image does not "
        r"share have no length.\end{proposition}",
        r"\begin{proof} The mirror image $-x(t + \pi/\Omega)$ is a motion too. The difference of "
        r"the two keeps its "
        r"energy (proof of Theorem~\ref{thm:orbits-unique}): friction is the same in both "
        r"whenever their velocities "
        r"differ. While both rest the difference is constant, and as both leave with the same "
        r"friction it is 0. So the "
        r"difference $x(t) + x(t + \pi/\Omega)$, if it is not 0, is a free motion. As $x$ has "
        r"the period "
        r"$2\pi/\Omega$, it is the same after half a period of the drive, which therefore is $n$ "
        r"periods of the free "
        r"motion: $r = 1/(2n)$. While one of the two stops "
        r"the other one stops too, or the friction of the first one would be constant: a stop "
        r"that is alone has no "
        r"length.\end{proof}",
        r"At $r = 1/(2n)$ one stop per cycle is what is seen: it gets shorter from cycle to "
        r"cycle, and its length "
        r"tends to 0.",
    )
    n = sp.Symbol("n", integer=True, positive=True)
    d_end = named("d_*")
    death = {x_0: P / (k * (1 - r**2)), x_f: F / k, r: 1 / (2 * n)}
    closed = {name: coulomb.closed(name, solution.REGIMES["undamped"]) for name in BASIS[:3]}
    at = {r: 1 / (2 * n), omega_0: 2 * n * Omega, w0sq: (2 * n * Omega) ** 2}
    meaning = {E0: closed[E0].subs(at), E1: closed[E1].subs(at), E2: closed[E2].subs(at)}
    rate = named(r"\dot{x}")
    wave = omega_0 * sp.sin(omega_0 * tau) / Omega**2
    # The free part of the motion between the turning points is shifted by d.
    shifted = coulomb.velocity().subs({G: 0, H: 0}).subs(x_f, x_f - d)
    down = {rate: Omega * shifted, E1: wave * Omega**2 / omega_0**2, tau: phi / Omega}
    down |= {w0sq: omega_0**2, omega_0: 2 * n * Omega}
    ratios = [(r**2 * x_0 + side * d - x_f) / (r**2 * x_0 + side * d + x_f) for side in (1, -1)]
    yield (
        r"\subsection{Continua of motions without stops}",
        r"\begin{proposition}[a continuum, and its death]\label{thm:literature-continuum} "
        r"Let $c = 0$ and $r = 1/(2n)$. If $F/P < 1/(4n^2 - 1)$, the motions $x + "
        r"d\cos(\varphi/r)$ have no stops for "
        r"all $|d| < d_*$, where $x$ is the symmetric one and",
        equation(
            d_end, P / (k * (4 * n**2 - 1)) - F / k, {d_end: r**2 * x_0 - x_f, **death}, "end"
        ),
        r"If not, there is none. So the continuum dies at $F = P/(4n^2 - 1)$, which is the point "
        r"$A_n$ of "
        r"Proposition~\ref{thm:literature-points}.\end{proposition}",
        r"\begin{proof} See \cite{csernak2007} for the orbits. Half a period is $n$ periods of "
        r"the free motion, which "
        r"comes back:",
        equation(E0, 1, meaning),
        equation(E1, 0, meaning),
        equation(E2, 0, meaning),
        r"So $G = H = 0$: the amplitude does not depend on the friction,",
        equation(
            x_0, P / (k * (1 - r**2)), {x_0: P / (k - m * Omega**2), Omega: r * sp.sqrt(k / m)}
        ),
        r"and a free motion $d \cos(\varphi/r)$ may be added to the symmetric one. Its turning "
        r"points are then "
        r"$d + x_0$ and $d - x_0$, at the same times. On the way down",
        equation(
            rate, 2 * n * Omega * (x_f - d) * sp.sin(2 * n * phi) - Omega * x_0 * sp.sin(phi), down
        ),
        r"and on the way up $-\dot{x}$ is the same with $x_f + d$ in place of $x_f - d$. As "
        r"$|\sin 2 n\varphi| \le 2 n "
        r"\sin\varphi$ by \eqref{eq:literature-sine}, with equality in the limit at the turning "
        r"points only, there is "
        r"no stop if and only if $x_f + |d| < r^2 x_0$.\end{proof}",
        r"At the end of the continuum one of the two turning points is a stop of no length.",
        r"One multiplier is 1, along the continuum. The other one is the product of the two "
        r"ratios of accelerations:",
        equation(
            LAMBDA[1],
            ((r**2 * x_0 - x_f) ** 2 - d**2) / ((r**2 * x_0 + x_f) ** 2 - d**2),
            ratios[0] * ratios[1],
        ),
        _numbers(
            "continuum",
            r"Members of the continua, which the package calls marginal: turning points and the "
            r"second multiplier. "
            r"Their middle $\bar{x}$ is $d$. The end $d_*$ is bisected in $d$, by whether the "
            r"motion stops.",
        ),
    )
    z = named(r"\ddot{z}")
    y = named("z")
    force = named("T")
    shake = named("Y")
    rub = named("x_f", positive=True)
    slope = named("s'")
    lag = named(r"\delta")
    top = named(r"\max x")
    angle = sp.Symbol("theta", real=True)
    still = V * shake
    near = still * (1 - angle**2 / 2) + rub * slope * (angle - lag)
    best = near.subs(angle, sp.solve(near.diff(angle), angle)[0])
    turns = sp.solve(-(r**2) * still * angle + rub * slope, angle)[0]
    gain = rub**2 * slope**2 / still * (sp.Rational(1, 2) - 1 / r**2)
    wave = shake * sp.cos(angle)
    yield (
        r"\subsection{Base and wall in joint motion}",
        r"Let base and wall move with $Y\cos\theta$, and let $z = x - Y\cos\theta$ be the "
        r"relative motion: spring and "
        r"friction know only $z$. As $\ddot{x} = \ddot{z} - \Omega^2 Y\cos\theta$,",
        equation(
            m * z + k * y,
            m * Omega**2 * wave + force,
            {z: (-k * y + force) / m + Omega**2 * wave},
            "base",
        ),
        r"which is the model with $P = m\Omega^2 Y$. Marino, Cicirello and Hills "
        r"\cite{marino2019,marino2020} found a "
        r"frequency beyond which friction amplifies the absolute motion $x$. For $c = 0$ and "
        r"weak friction let $s$ be "
        r"the response to the square wave $\operatorname{sgn}\sin\theta$ per unit of $x_f$, in "
        r"angles $\theta$ from a "
        r"peak of the base; it is odd, and $s'$ its slope at 0. The relative motion turns at",
        equation(lag, rub * slope / (r**2 * V * shake), {lag: turns}, "lag"),
        r"and the friction changes there, so that near its peak $x = V Y (1 - \theta^2/2) + x_f "
        r"s' (\theta - \delta)$ "
        r"up to terms of third order in $x_f$. The peak is",
        equation(top, still + gain, {top: best, lag: turns}, "peak"),
        r"So weak friction damps the absolute motion for $r < \sqrt{2}$ and amplifies it for $r "
        r"> \sqrt{2}$; strong "
        r"friction moves this point up.",
        _numbers(
            "inversion",
            r"The $r$ at which friction leaves the absolute amplitude unchanged; $k Y$ is the "
            r"unit of the forces.",
        ),
    )
    low = named("x_-")
    high = named("x_+")
    B0 = solution.B0
    A = solution.A0
    mu = solution.mu1
    other = solution.mu2
    ends = {
        low: (A - (mu - other) * FN + sp.Abs(B0)) / k,
        high: (A + (mu + other) * FN - sp.Abs(B0)) / k,
    }
    yield (
        r"\subsection{Rest positions on a belt at rest}",
        r"For $c > 0$ a periodic motion is the only one, except on a belt at rest "
        r"(Theorem~\ref{thm:orbits-unique}). "
        r"Let $v_1 = 0$. The mass stays at $x$ for ever if $F^{(1)} \ge 0 \ge F^{(2)}$ at all "
        r"phases, "
        r"$k x \le A_1 - |B_0|$ and $k x \ge A_2 + |B_0|$. These $x$ form an interval of the "
        r"length",
        equation(
            high - low, 2 * (mu * FN - sp.Abs(B0)) / k, ends, note=r"for $|B_0| \le \mu_1 F_N$."
        ),
        r"The map over a period leaves every rest where it is, so that its multiplier along the "
        r"interval is 1.",
        _numbers(
            "rests",
            r"With the numbers of Example~\ref{thm:orbits-example}: the ends of the interval, "
            r"and where motions from "
            rf"inside it are at {_given('rests')}.",
        ),
    )


# --- pieces ---


def _agreed(value: Value) -> Any:
    """Return the number that the package computed for `value`.

    StepError unless it agrees with the formula's.
    """
    if not abs(value.difference) <= value.tolerance:
        raise StepError(value.name, f"formula and package differ by {MP.nstr(value.difference, 3)}")
    return number(value.package)


def _given(key: str) -> str:
    """Return what holds for all rows of a table as LaTeX, such as "$c = 0.1$, $F = 0.5$"."""
    return ", ".join(f"${letter} = {value}$" for letter, value in GIVEN[key].items())


def _numbers(key: str, caption: str, *more: Step) -> Table:
    """Return the table of values that are computed twice.

    By the formula, and by running the package.

    `more` has steps that check what the caption says besides what is given.
    """
    given = (
        equation(named(letter), sp.Rational(value), sp.Rational(value), decimals=True)
        for letter, value in GIVEN.get(key, {}).items()
    )
    values = table(key)
    noted = any(value.note for value in values)
    rows = []
    for value in values:
        formula = decimal("z", number(value.formula), value.decimals)
        ran = decimal(
            "z",
            number(value.package),
            value.decimals,
            close(partial(_agreed, value), value.decimals),
        )
        rows.append((f"${value.name}$", value.case, formula, ran, *([value.note] if noted else [])))
    heads = ("", "", "formula", "run", *([""] if noted else []))
    columns = "llrr" + "l" * noted
    return Table(f"tab:literature-{key}", caption, heads, tuple(rows), (*given, *more), columns)


def _free_motion(start: Any, rate: Any) -> tuple[Any, Any]:
    """Return x and v of the motion without drive and friction, a time tau after x = `start`, v =
    `rate`.
    """
    flow = solution.flow()
    at = {
        solution.x_i: start,
        solution.v_i: rate,
        solution.a_i: -w0sq * start - cm * rate,
        solution.f0: 0,
    }
    return tuple(sp.expand(part.xreplace(at).xreplace(RELATION)) for part in (flow.x, flow.v))
