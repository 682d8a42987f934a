"""Derivatives of events, saltation from them, Lyapunov exponents, and why there is no chaos."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import sympy as sp

from symosc.derivatives.sensitivities import sensitivities
from symosc.derive.chapters.jacobians import AFTER, BEFORE, force_at_belt, multiplier_products
from symosc.derive.chapters.maps import force
from symosc.derive.chapters.orbits import FUNCTIONS
from symosc.derive.flight_basis import flight_basis
from symosc.derive.scope import Scope, v_lambda
from symosc.derive.steps import (
    CONTEXT,
    Items,
    Step,
    Table,
    at_root,
    close,
    decimal,
    equation,
    exact,
    facts,
    number,
    sign,
    step,
)
from symosc.orbits.find import find_orbit
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import Omega, a_i, c, k, m, tau, theta_i, v_i, x_i
from symosc.symbolic.theorem7 import rational

TITLE = "Derivatives of motions, exponents, and no chaos"
#: Derivatives by q: of an event's time and position, of the belt's speed; at a fixed time, before
#: and after the event.
T_Q = named("t_q")
X_Q = named("x_q")
V_Q = named("v_q")
DX, DV, DX_PLUS, DV_PLUS = (
    named(name)
    for name in (r"\delta x", r"\delta\dot{x}^{-}", r"\delta x^{+}", r"\delta\dot{x}^{+}")
)
RATE = named(r"\dot{F}")
F_Q = named("F_q")
#: The scene whose derivatives are compared, how many of its events, and the digits of the
#: comparison.
SCENE = "fig5"
EVENTS = 6
DIGITS = 30


def items(scope: Scope) -> Items:
    """Yield the chapter: derivatives of events by parameters, Lyapunov exponents, and why there is
    no chaos.
    """
    yield _derivatives()
    yield _where_not_differentiable()
    yield _exponents()
    yield _no_chaos()


def _derivatives() -> Items:
    """Yield the items on derivatives of events."""
    s, e = sp.symbols("s varepsilon", real=True)
    place = named("x")
    speed = named(r"\dot{x}")
    near_x = place + speed * s + BEFORE * s**2 / 2 + e * (DX + DV * s)
    near_v = speed + BEFORE * s + e * DV

    def along(expr: Any) -> Any:
        """Return the derivative of `expr` by q at the event: q changes by e, and the event's time
        by s = e t_q.
        """
        return expr.subs(s, e * T_Q).diff(e).subs(e, 0)

    reached = sp.solve(along(near_v) - V_Q, T_Q)[0]
    moved = {T_Q: reached, X_Q: along(near_x).subs(speed, v_lambda)}
    ratio = AFTER / BEFORE
    stuck = {DV_PLUS: V_Q}
    released = sp.solve(F_Q - k / m * DX - c / m * V_Q + RATE * T_Q, T_Q)[0]
    yield (
        r"\subsection{Derivatives of events}",
        r"Let $q$ be a parameter, or $t_0$, $x_0$ or $\dot{x}_0$. The index $q$ marks the "
        r"derivative of what belongs to an event: of its time, $t_q$, and of its position, $x_q$; "
        r"and $v_q$ that of the belt's speed, which is 1 for $q = v_\lambda$ and 0 for all others. "
        r"$\delta$ marks derivatives at a fixed time, before and after the event. So at an event "
        r"$x_q = \delta x + \dot{x}\, t_q$.",
        r"During a flight $(\delta x, \delta\dot{x})$ is multiplied by $\Phi(\tau)$ "
        r"(Lemma~\ref{thm:jacobians-phi}), and what $q$ does in the equation of motion is added; a "
        r"stick keeps $\delta x$ and adds $v_q \tau$. What is left are the events.",
        r"\begin{theorem}[events]\label{thm:exponents-events} Let a flight meet belt $\lambda$ "
        r"with the acceleration $F^{-} \ne 0$. Then",
        equation(T_Q, (V_Q - DV) / BEFORE, moved, "contact"),
        equation(X_Q, DX + v_lambda * T_Q, moved, "place"),
        r"If the flight goes on with the acceleration $F^{+}$ on the other side, then behind the "
        r"contact",
        equation(
            DV_PLUS,
            ratio * DV + (1 - ratio) * V_Q,
            {DV_PLUS: V_Q - AFTER * T_Q, T_Q: reached},
            "crossing",
        ),
        r"and if the mass sticks,",
        equation(DV_PLUS, V_Q, stuck, "onset"),
        r"A stick that ends where $F^{(\alpha)} = 0$ with the rate $\dot{F} \ne 0$ of "
        r"\eqref{eq:sticks-rate} ends at a time with",
        equation(T_Q, (k * DX + c * V_Q - m * F_Q) / (m * RATE), {T_Q: released}, "slip"),
        r"where $F_q$ is the derivative of $F^{(\alpha)}$ by $q$ alone, and behind it",
        equation(DV_PLUS, V_Q, {DV_PLUS: V_Q - AFTER * T_Q, AFTER: 0}, "end"),
        r"In all cases $\delta x^{+} = \delta x$.\end{theorem}",
        facts(equation(DX_PLUS, DX, {DX_PLUS: X_Q - v_lambda * T_Q, **moved})),
        r"\begin{proof} The motion beside the given one is $x + \dot{x} s + \ldots + "
        r"\varepsilon(\delta x + \delta\dot{x}\, s)$ at the time $s$ after the event, and meets "
        r"the belt at $s = \varepsilon t_q$. The condition that the event fulfils ($\dot{x} = "
        r"v_\lambda$, or $F^{(\alpha)} = 0$) is differentiated by $\varepsilon$ and solved for "
        r"$t_q$: the implicit function theorem. The velocity at the event is $v_\lambda$, and "
        r"behind it changes with $F^{+}$; at the end of a stick $F^{+} = F^{(\alpha)} = "
        r"0$.\end{proof}",
        r"For $v_q = 0$ these are the saltation matrices of Theorem~\ref{thm:jacobians-saltation}: "
        r"a crossing multiplies by $\operatorname{diag}(1, F^{+}/F^{-})$; an onset by "
        r"$\operatorname{diag}(1, 0)$, of rank one: the direction of the velocity is forgotten; "
        r"the end of a stick changes nothing, it only takes place sooner or later.",
        _events_table(),
    )


def _where_not_differentiable() -> Items:
    """Yield the items on the points where a motion has no derivative, or one on each side."""
    steps = lengths()
    yield (
        r"\subsection{Where they end}",
        r"The theorem divides by $F^{-}$ or $\dot{F}$. Where one of them vanishes, and where "
        r"$F^{+} = 0$ at a contact, another event is born, and the derivatives differ on the two "
        r"sides. Let $\epsilon > 0$ be how far $q$ has gone beyond that point, and $b > 0$ the "
        r"first derivative that does not vanish. To leading order",
        r"\begin{enumerate}\item[(i)] a flight that without the belt would go beyond its speed by "
        r"the velocity $\epsilon$ meets it before that, by the time",
        steps["graze"],
        r"A belt with friction lets no flight pass there (Lemma~\ref{thm:motion-jump}): the mass "
        r"sticks. It meets the belt with $F = b s$, and along the belt $F$ falls with the rate $b$ "
        r"as well, so that the stick lasts for",
        steps["graze-stick"],
        r"\item[(ii)] a stick that begins with $F = -\epsilon$ and rises with the rate $b$ lasts "
        r"for",
        steps["stick"],
        r"\item[(iii)] a slip that begins with $F = \epsilon$ and falls with the rate $b$ lasts for",
        steps["slip-short"],
        r"\item[(iv)] a stick during which $F = \epsilon - b s^2/2$ is interrupted from $-s$ to "
        r"$2s$, with the $s$ of \eqref{eq:exponents-graze}:",
        steps["interrupted"],
        r"so that the slip lasts for",
        steps["interrupted-slip"],
        r"\end{enumerate}",
        r"So in (i) and (iv) times grow with the square root on one side, and no derivative exists "
        r"there. In (ii) and (iii) each side has its own derivatives.",
        _graze_example(),
    )


def _exponents() -> Items:
    """Yield the items on Lyapunov exponents."""
    chi = sp.Symbol(r"\chi_j", positive=True)
    change = named(r"\ln\det(S_j\Phi(\tau_j))")
    gone = named(r"\ln\chi_j")
    span = named(r"\tau_j", positive=True)
    true = {change: sp.log(sp.exp(-c * span / m) * chi), gone: sp.log(chi)}
    mu = sp.Symbol(r"\mu_\lambda", nonnegative=True)
    after = sp.Symbol("F^{+}", positive=True)
    yield (
        r"\subsection{Lyapunov exponents}",
        r"Let $M(t)$ be the product of the matrices of all pieces up to the time $t$ "
        r"(Theorem~\ref{thm:jacobians-monodromy}). The \emph{Lyapunov exponents} $\Lambda_1 \ge "
        r"\Lambda_2$ of the motion are the limits for $t \to \infty$ (upper limits, if there are "
        r"none) of $\frac{1}{t}\ln\|M(t)\| = \Lambda_1$ and $\frac{1}{t}\ln|\det M(t)| = \Lambda_1 "
        r"+ \Lambda_2$.",
        r"\begin{theorem}[exponents]\label{thm:exponents-lyapunov} Let a motion be regular "
        r"(Definition~\ref{thm:jacobians-regular}), and let $\chi_j = F^{+}/F^{-}$ at its "
        r"crossings.\begin{enumerate}\item[(i)] $\Lambda_1 \le 0$.\item[(ii)] $\Lambda_2 = "
        r"-\infty$ once the mass has stuck. Without sticks a flight and its crossing contribute",
        equation(
            change,
            -c * span / m + gone,
            exact(true, lambda expr: sp.expand_log(sp.expand(expr))),
            "area",
        ),
        step(chi, "<=", 1, sign({chi: after / (after + 2 * mu * solution.FN / m)}), "chi"),
        r"so that $\Lambda_1 + \Lambda_2 \le -c/m$.\item[(iii)] On a periodic motion with the "
        r"multipliers $\rho_j$, $\Lambda_j = \ln|\rho_j|/\mathcal{T}$.\item[(iv)] For $c > 0$ and "
        r"$k > 0$ the motion that attracts all others has $\Lambda_1 < 0$ if it has a "
        r"flight.\end{enumerate}\end{theorem}",
        r"\begin{proof} (i) For $k > 0$ no factor increases the energy norm (proof of "
        r"Theorem~\ref{thm:jacobians-monodromy}), so $M(t)$ is bounded. For $k = 0$ the change "
        r"$\delta\dot{x}$ does not grow, and $\delta x$ no faster than $t$. (ii) "
        r"$\operatorname{diag}(1, 0)$ makes $\det M(t) = 0$; without it \eqref{eq:exponents-area} "
        r"is \eqref{eq:jacobians-det} and Theorem~\ref{thm:jacobians-saltation}. (iii) "
        r"$M(n\mathcal{T}) = M(\mathcal{T})^n$. (iv) Theorem~\ref{thm:jacobians-monodromy} "
        r"(i).\end{proof}",
        _exponents_table(),
    )


def _no_chaos() -> Items:
    """Yield the items on why there is no chaos."""
    place = named("y")
    rate = named(r"\dot{y}")
    n = sp.Symbol("n", integer=True, positive=True)
    count = sp.Symbol("N", positive=True)
    stiff = sp.Symbol("k", positive=True)
    mass = sp.Symbol("m", positive=True)
    form = sp.hessian(mass * rate**2 / 2 + stiff * place**2 / 2, (place, rate))
    entropy = named("h_\\epsilon")
    horseshoe = named(r"\ln 2")
    yield (
        r"\subsection{There is no chaos}",
        r"\begin{theorem}[no chaos]\label{thm:exponents-chaos} Let $k > 0$ and $c \ge 0$. In the "
        r"norm $\|(y, \dot{y})\|^2 = \frac{m}{2}\dot{y}^2 + \frac{k}{2}y^2$, the map of the states "
        r"over one period of the drive moves no two states apart. "
        r"Therefore\begin{enumerate}\item[(i)] its topological entropy on every compact invariant "
        r"set is 0: it has no horseshoe;\item[(ii)] no motion depends sensitively on its start, "
        r"and no Lyapunov exponent is positive;\item[(iii)] no multiplier leaves the unit circle; "
        r"for $c > 0$ no period doubles, no torus is born and no periodic motions fold (for $c = "
        r"0$ see Corollary~\ref{thm:undamped-survives});\item[(iv)] for $c > 0$ all motions tend "
        r"to one, or each to a rest (Theorem~\ref{thm:orbits-unique}), and then the rests of two "
        r"motions are no farther apart than their starts.\end{enumerate}\end{theorem}",
        r"\begin{proof} $\|\cdot\|$ is a norm, since $k > 0$ and $m > 0$.",
        facts(*(step(form[i, i], ">", 0, sign()) for i in (0, 1))),
        r"Along the difference of two motions its square does not grow by \eqref{eq:motion-energy} "
        r"and Lemma~\ref{thm:motion-monotone}. (i) Cover a compact invariant set with $N$ balls of "
        r"the radius $\epsilon/2$. Two states in one ball stay closer than $\epsilon$ under all "
        r"iterates, so $N$ orbits of the length $n$ represent all others to within $\epsilon$, for "
        r"every $n$. The entropy at this scale is",
        equation(entropy, 0, {entropy: sp.limit(sp.log(count) / n, n, sp.oo)}, "entropy"),
        r"for all $\epsilon > 0$, while a horseshoe has at least",
        step(horseshoe, ">", 0, sign({horseshoe: sp.log(2)}), "horseshoe"),
        r"(ii) Two motions that start closer than $\epsilon$ stay closer than $\epsilon$; "
        r"Theorem~\ref{thm:exponents-lyapunov} (i). (iii) Theorem~\ref{thm:jacobians-monodromy} "
        r"(i); for $c > 0$ all periodic motions are one with the period of the drive, or rests "
        r"(Theorem~\ref{thm:orbits-unique}). (iv) The distance does not grow.\end{proof}",
        r"\begin{remark}[what chaos needs]\label{thm:exponents-needs} The proof uses two facts: "
        r"the spring and the damper are linear with $k > 0$, $c \ge 0$, and friction never grows "
        r"when the mass moves faster against a belt. Chaos in friction oscillators is reported "
        r"where one of them fails: static friction above kinetic friction, friction that falls "
        r"with speed, friction with a memory, a spring that is not linear, negative damping. A "
        r"simulation of this model that shows chaos has an error in its events or its steps, or "
        r"has not settled: for $c = 0$ motions may settle slowly, or to one of a continuum of "
        r"periodic or quasi-periodic motions (Chapter~\ref{sec:undamped}).\end{remark}",
    )


def lengths() -> dict[str, Step]:
    """Return the steps on how long an event that is born lasts, to leading order, by their labels."""
    s = named("s")
    length = named(r"\ell")
    total = named(r"\int_{-s}^{2s} F")
    end = sp.Symbol("u", positive=True)
    e = sp.Symbol(r"\epsilon", positive=True)
    b = sp.Symbol("b", positive=True)
    bump = e - b * s**2 / 2
    half = sp.sqrt(2 * e / b)
    before = next(-root for root in sp.solve(bump, s) if root.is_negative)
    fading = bump.diff(s).subs(s, -s) - b * length
    returns = [at for at in sp.solve(sp.integrate(bump, (s, -before, end)), end) if at.is_positive]
    rows = {
        "graze": (s, half, {s: before}),
        "graze-stick": (length, s, {length: sp.solve(fading, length)[0]}),
        "stick": (length, e / b, {length: sp.solve(b * length - e, length)[0]}),
        "slip-short": (length, 2 * e / b, {length: sp.solve(e - b * length / 2, length)[0]}),
        "interrupted": (total, 0, {total: sp.integrate(bump, (s, -before, 2 * before))}),
        "interrupted-slip": (length, 3 * s, {length: returns[0] + before, s: half}),
    }
    return {label: equation(*parts, label) for label, parts in rows.items()}


def _in_numbers(expr: Any, scope: Scope) -> Any:
    """Return an expression with the numbers of the scope's scene put in."""
    return expr.xreplace(scope.display).xreplace(scope.numbers)


def _graze_example() -> Items:
    """Return the stick that the printed digits of Fig. 7 leave: to leading order, and as it is."""
    scene = load_scene("fig7-corrected")
    scope = Scope(scene)
    flow = solution.flow(scope.regimes[0])
    phase = scope.numbers[Omega] * rational(scene.t0)
    start = {x_i: rational(scene.x0), v_i: rational(scene.v0), theta_i: phase}
    start[a_i] = _in_numbers(force(1, x_i, v_i, theta_i), scope).xreplace(start)
    speed, push, rate = (
        sp.lambdify(tau, _in_numbers(part.xreplace(start), scope), FUNCTIONS)
        for part in (flow.v, flow.a, flow.a.diff(tau))
    )
    onset, end = (number(event.t) for event in simulate(scene, digits=DIGITS).events[:2])
    top = CONTEXT.clone().findroot(push, onset - number(scene.t0))
    beyond = speed(top) - number(scene.parameters.v1)
    leading = CONTEXT.sqrt(-2 * beyond / rate(top))
    stick = end - onset
    ratio = named(r"|\ell/s - 1|")
    off = {ratio: sp.Float(CONTEXT.nstr(abs(stick / leading - 1), 20), 20)}
    return (
        r"The paper's Fig.~7 is an example, with the other value of $A_0$ in "
        r"Chapter~\ref{sec:errata}: from the printed digits of its start the mass does not graze, "
        r"but sticks for some time $\ell$, beside the $s$ of (i):",
        decimal("s", leading, 7),
        decimal(r"\ell", stick, 7, note="so that"),
        step(ratio, "<", sp.Rational(1, 1000), at_root(lambda: off)),
    )


# --- numbers: the matrices above, multiplied with 50 digits, against the package ---


@cache
def event_time_derivatives(scene: str, by_friction: bool) -> list[Any]:
    """Return derivatives of a scene's event times by x_0, or mu_1 if `by_friction`, from formulas
    of this chapter.
    """
    start = load_scene(scene)
    p = start.parameters
    w0sq = number(p.k / p.m)
    path = simulate(start, digits=DIGITS + 15)
    # dx and dv: the derivatives of the state, from event to event.
    if by_friction:
        dx = CONTEXT.mpf(0)
    else:
        dx = CONTEXT.mpf(1)
    dv = CONTEXT.mpf(0)
    # The derivative of the force by mu_1 in each domain, by which the friction of belt 1 pulls: up
    # below it, down above it.
    push = {
        alpha: number(sign * p.FN / p.m) * by_friction for alpha, sign in ((1, 1), (2, -1), (3, -1))
    }
    time_before = number(start.t0)
    slopes = []
    for event in path.events[:EVENTS]:
        t = number(event.t)
        phase = number(p.Omega) * t
        belt = event.boundary
        contact = (belt, number(event.x), phase)
        source = int(event.source[-1])
        target = int(event.target[-1])
        if event.source.startswith("Omega"):  # a flight ends, else a stick
            e0, e1, e2 = flight_basis(p)(t - time_before)
            dx_at_end = (1 - w0sq * e2) * dx + e1 * dv + e2 * push[source]
            dv_at_end = e0 * dv - w0sq * e1 * dx + e1 * push[source]
            dx = dx_at_end
            dv = dv_at_end
            # The event comes so much earlier or later that the velocity is the belt's again.
            force_before = force_at_belt(p, source, *contact)
            slopes.append(-dv * number(p.m) / force_before)
            if event.target.startswith("Omega"):
                dv = dv * force_at_belt(p, target, *contact) / force_before
            else:  # on a belt all have its velocity
                dv = dv * 0
        else:
            spring_rate = number(p.k * p.belt(belt))
            drive_rate = number(p.B0 * p.Omega) * CONTEXT.sin(phase)
            rate = -(spring_rate + drive_rate) / number(p.m)  # of the force at the slip
            slopes.append((w0sq * dx - push[target]) / rate)
        time_before = t
    return slopes


def _events_table() -> Table:
    """Return the table of derivatives of event times from `sensitivities`, checked by
    `event_time_derivatives`.
    """
    by_formula = {q: event_time_derivatives(SCENE, q == "mu1") for q in ("x0", "mu1")}
    by_package = {q: sensitivities(SCENE, q, digits=DIGITS) for q in by_formula}

    def cell(q: str, n: int) -> Any:
        check = close(partial(CONTEXT.mpf, by_formula[q][n]), 24)
        (slope,) = by_package[q].dt[n]
        return decimal("z", slope, 24, check)

    events = enumerate(by_package["x0"].trajectory.events[:EVENTS])
    return Table(
        "tab:exponents-events",
        r"The first events of the paper's Fig.~5: $t_q$ as found by \texttt{sensitivities}, to 24 "
        r"decimals (half a unit of the last one). The matrices of this section, multiplied with 50 "
        r"digits, give the same.",
        ("", "", "$t_q$ for $q = x_0$", r"$t_q$ for $q = \mu_1$"),
        tuple((str(n + 1), event.kind, *(cell(q, n) for q in by_formula)) for n, event in events),
        columns="rlrr",
    )


def _exponents_table() -> Table:
    """Return the table of two orbits' Lyapunov exponents by the theorem, and by following motions
    with the package.
    """
    _, product = multiplier_products("fig9-orbit", "P32")
    decay = (
        CONTEXT.log(product) * number(load_scene("fig9-orbit").parameters.Omega) / (2 * CONTEXT.pi)
    )

    def growth(scene: str, choose: Any) -> Any:
        """Return the sum or maximum (`choose`) of a scene's Lyapunov exponents, averaged over
        periods 50 to 100.
        """
        early, late = (
            choose(sensitivities(scene, "x0", t_end=f"{n}T").lyapunov) for n in (50, 100)
        )
        # Both are means from the start on: 100 times `late` minus 50 times `early`, over 50.
        return 2 * late - early

    stuck = find_orbit("fig10-orbit", "P4645", digits=DIGITS)
    largest = CONTEXT.log(abs(CONTEXT.mpmathify(stuck.multipliers[0]))) / CONTEXT.mpf(stuck.period)
    assert sensitivities("fig10-orbit", "x0", t_end="5T").lyapunov[1] == -CONTEXT.inf
    total = growth("fig9-orbit", sum)
    rate = growth("fig10-orbit", max)
    values = (
        (r"$\Lambda_1 + \Lambda_2$ of $P_{32}$", decay, total),
        (r"$\Lambda_1$ of $P_{4645}$", largest, rate),
    )
    rows: list[Any] = [
        (
            name,
            decimal("z", by_formula, 11),
            decimal("z", number(run), 11, close(partial(CONTEXT.mpf, by_formula), 11)),
        )
        for name, by_formula, run in values
    ]
    rows.append((r"$\Lambda_2$ of $P_{4645}$", r"$-\infty$", r"$-\infty$"))
    return Table(
        "tab:exponents-lyapunov",
        r"Exponents of the orbits of the paper's Figs.~9 and 10: by (ii) and (iii) with many "
        r"digits, and by \texttt{sensitivities} over up to 100 periods (\emph{run}).",
        ("", "formula", "run"),
        tuple(rows),
        columns="lrr",
    )
