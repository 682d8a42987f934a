"""Friction that depends on speed: bands and corners, growth, and which theorems remain."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.chapters.motion import balance
from symosc.derive.chapters.static_friction import JUMP
from symosc.derive.chapters.switching import along_flow
from symosc.derive.scope import F, G, Scope, v_lambda
from symosc.derive.steps import (
    CONTEXT,
    Check,
    Items,
    Step,
    Table,
    cases,
    close,
    decimal,
    equation,
    exact,
    sign,
    solves,
    step,
)
from symosc.friction import Map, geometry
from symosc.model import Band, Belt, Oscillator
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import A0, B0, Omega, c, k, m, t, tau, theta, theta_i, v, x, x_i

TITLE = "Friction that depends on speed"
#: A piece of the friction of a belt, p + q w at the relative speed w, and the side of the belt on
#: which the mass is: 1 above, -1 below.
START = sp.Symbol(r"p_\lambda", real=True)
SLOPE = sp.Symbol(r"q_\lambda", real=True)
SIDE = sp.Symbol(r"\sigma_\lambda", real=True)
FRICTION = named(r"T_\lambda")
#: Damping and constant force of two neighbouring bands, and the speed of the edge between them.
DAMPING = named("c_j")
FORCE = named("A_j")
NEXT_DAMPING = named("c_{j+1}")
NEXT_FORCE = named("A_{j+1}")
EDGE = named("u")
HERE = "j"
NEXT = "j+1"
PHASE = named(r"\theta")
#: The decay rate of a band, of any sign, and how much of it is growth: max(-h, 0).
RATE = sp.Symbol("h", real=True)
GROWTH = sp.Symbol("h_{-}", nonnegative=True)
FREQUENCY = sp.Symbol("omega_d", positive=True)
HYPERBOLIC = sp.Symbol("eta", positive=True)
#: The least damping of a law.
LEAST = named("c_*")
#: How far the search goes in a band in which motions grow, as a part of 1/|h|: at most, and by how
#: much a step may pass that.
REACH = sp.Rational(7, 20)
BEYOND = sp.Rational(5, 8)


def items(scope: Scope) -> Items:
    """Yield the chapter: the law, its edges, growth, contraction, labels, what remains."""
    yield _bands()
    yield _belts()
    yield _corners()
    yield _touch()
    yield _accumulation()
    yield _closed_forms()
    yield _growth()
    yield _search()
    yield _contraction()
    yield _bounded()
    yield _labels()
    yield _what_remains()


# --- the law ---


class BandEquation(NamedTuple):
    """The linear equation of a band: its damping and its constant force."""

    damping: Any
    force: Any


def _friction(side: int, gap: Any, start: Any, slope: Any) -> Any:
    """Return the friction of a belt by its definition, at the relative velocity side * gap."""
    relative = side * gap
    return -sp.sign(relative) * (start + slope * sp.Abs(relative))


#: Three belts, to check sums over belts: their speeds, and the pieces that count.
SPEEDS = sp.symbols("v_1:4", real=True)
STARTS = sp.symbols("p_1:4", real=True)
SLOPES = sp.symbols("q_1:4", real=True)


def _sides(slower: int) -> tuple[int, ...]:
    """Return the sides of the three belts, of which `slower` are slower than the mass."""
    return tuple(1 if n < slower else -1 for n in range(3))


def _force(slower: int) -> Any:
    """Return the sum of all forces on a mass that is faster than some of the three belts."""
    gap = sp.Symbol("w", positive=True)
    total = A0 + B0 * sp.cos(Omega * t) - k * x - c * v
    for side, speed, start, slope in zip(_sides(slower), SPEEDS, STARTS, SLOPES, strict=True):
        total += _friction(side, gap, start, slope).subs(gap, side * (v - speed))
    return total


def _line(slower: int) -> BandEquation:
    """Return the linear equation that these forces make."""
    total = sp.expand(_force(slower))
    rest = total + k * x - B0 * sp.cos(Omega * t)
    return BandEquation(-total.diff(v), rest.subs(v, 0))


def in_band(damping: Any, force: Any, place: Any = x, speed: Any = v) -> Any:
    """Return the acceleration by the balance of forces in a band."""
    return balance(place, speed, Omega * t).subs({c: damping, solution.A: force})


def _bands() -> Items:
    """Return the items on friction curves and bands."""
    gap = sp.Symbol("w", positive=True)
    pieces = []
    for side in (1, -1):
        meaning = {FRICTION: _friction(side, gap, START, SLOPE), SIDE: side}
        pieces.append(exact({**meaning, v: v_lambda + side * gap}))
    slopes = named(r"\sum_\lambda q_\lambda")
    starts = named(r"\sum_\lambda (q_\lambda v_\lambda - \sigma_\lambda p_\lambda)")
    total = named(r"m\ddot{x} + c_j\dot{x} + k x")
    sums = []
    for slower in range(4):
        line = _line(slower)
        known = zip(_sides(slower), SPEEDS, STARTS, SLOPES, strict=True)
        constant = sp.Add(*(slope * speed - side * start for side, speed, start, slope in known))
        meaning = {DAMPING: line.damping, FORCE: line.force}
        whole = _force(slower) + line.damping * v + k * x
        sums.append(exact({**meaning, slopes: sp.Add(*SLOPES), starts: constant, total: whole}))
    return (
        r"\subsection{Bands}",
        r"The friction of most surfaces falls while they begin to slide, and may grow at higher "
        r"speeds: Stribeck's curve. A curve that is linear in pieces leaves every equation of "
        r"motion linear, so that the closed forms of Chapter~\ref{sec:domains} remain.",
        r"\begin{definition}[friction curve]\label{thm:friction_curves-law} Let there be $n \ge 1$ "
        r"belts, $v_1 < \ldots < v_n$. Belt $\lambda$ has a \emph{curve} $f_\lambda(w) \ge 0$ over "
        r"the relative speed $w = |\dot{x} - v_\lambda|$, continuous and linear in finitely many "
        r"pieces, the last of which does not fall. While $\dot{x} \ne v_\lambda$ the belt exerts "
        r"the friction $T_\lambda = -\operatorname{sgn}(\dot{x} - v_\lambda)\, f_\lambda(w)$; at "
        r"$\dot{x} = v_\lambda$ it holds the mass with at most $s_\lambda \ge f_\lambda(0)$, as in "
        r"Definition~\ref{thm:static_friction-law}, where $E = (s_\lambda - f_\lambda(0))/m$. The "
        r"\emph{edges} of the law are the speeds of all belts, and the speeds $v_\lambda \pm w$ of "
        r"the points at which the slope of a curve changes; those that are no belt's are "
        r"\emph{corners}. A \emph{band} lies between two neighbouring edges or beyond the outermost "
        r"ones. A \emph{domain} lies between two neighbouring belts or beyond the outermost ones, and "
        r"consists of one band or more.\end{definition}",
        r"Coulomb's friction is $f_\lambda = \mu_\lambda F_N$ for all $w$: then bands are domains. "
        r"$f_\lambda \ge 0$ at all speeds asks for the last piece not to fall.",
        r"\begin{proposition}[a linear equation in each band]\label{thm:friction_curves-bands} Let "
        r"$f_\lambda = p_\lambda + q_\lambda w$ be the piece that counts in band $j$, and "
        r"$\sigma_\lambda = \operatorname{sgn}(\dot{x} - v_\lambda)$ there. Then",
        equation(FRICTION, SLOPE * (v_lambda - v) - SIDE * START, cases(*pieces), "piece"),
        r"and the motion obeys",
        equation(total, FORCE + B0 * sp.cos(Omega * t), cases(*sums), "newton"),
        r"with the damping and the constant force",
        equation(DAMPING, c + slopes, cases(*sums), "damping"),
        equation(FORCE, A0 + starts, cases(*sums), "force"),
        r"\end{proposition}",
        r"\begin{proof} $\sigma_\lambda w = \dot{x} - v_\lambda$; add all belts to "
        r"\eqref{eq:motion-newton}. The machine's check has three belts, and all four ways to "
        r"lie between them.\end{proof}",
        r"So $c_j$ may be negative where friction falls. In the two outermost bands all belts are "
        r"on their last pieces, so that both have the same damping $c_\infty \ge c$.",
        _example_table(),
    )


#: A law with a belt of each kind of piece, of which the table lists the bands.
CURVE = ((0, 2), (2, 1), (5, sp.Rational(2, 5)))


def _example_law() -> Oscillator:
    """Return the oscillator of the table of bands."""
    curve = [(w, str(f)) for w, f in CURVE]
    return Oscillator(m=1, c=1, k="8/5", B0=1, Omega=1, belts=[Belt(3, curve=curve)])


def _example_table() -> Table:
    """Return the table of the bands of a law, each constant checked by values of the curve."""
    law = _example_law()
    rows = []
    for j, band in enumerate(law.bands, 1):
        low, high = (_shown_speed(speed) for speed in (band.below, band.above))
        numbers = (
            equation(DAMPING, sp.Rational(str(band.c)), _by_secant(band, "slope")),
            equation(FORCE, sp.Rational(str(band.A)), _by_secant(band, "value")),
        )
        rows.append((str(j), low, high, *numbers))
    return Table(
        "tab:friction_curves-bands",
        r"The bands of a law, as the package lists them: $c = 1$, $A_0 = 0$, one belt with $v_1 = "
        r"3$, and the curve with the points $(0, 2)$, $(2, 1)$, $(5, \frac{2}{5})$.",
        ("$j$", "from", "to", "$c_j$", "$A_j$"),
        tuple(rows),
        (
            *(equation(named("w"), w, sp.Integer(w)) for w, _ in CURVE),
            *(equation(named("f"), f, sp.sympify(f)) for _, f in CURVE),
            equation(named("v_1"), 3, sp.Rational(str(law.belts[0].v))),
            equation(c, 1, sp.Rational(str(law.c))),
            equation(A0, 0, sp.Rational(str(law.A0))),
        ),
        columns="rrrrr",
    )


def _shown_speed(speed: Any) -> str:
    """Return the speed of an edge as LaTeX, a dash where there is none."""
    if speed is None:
        return "--"
    return f"${speed}$"


def _curve_value(w: Any) -> Any:
    """Return the friction of the example at a relative speed, by the points of the curve."""
    for (begin, high), (end, low) in pairwise(CURVE):
        if w <= end:
            return high + (low - high) * (w - begin) / sp.Integer(end - begin)
    return CURVE[-1][1]


def _by_secant(band: Band, what: str) -> Check:
    """Return the check of a band's damping (`what` is "slope") or constant force, from the friction
    at two of its velocities.
    """
    # Outside the outermost edges the band is taken to be 2 wide.
    ends = [sp.Rational(str(speed)) for speed in (band.below, band.above) if speed is not None]
    low = ends[0] - 2 * (band.below is None)
    high = ends[-1] + 2 * (band.above is None)
    first = low + (high - low) / 4
    second = low + (high - low) / 2
    forces = [
        -speed - sp.sign(speed - 3) * _curve_value(abs(speed - 3)) for speed in (first, second)
    ]
    damping = -(forces[1] - forces[0]) / (second - first)
    if what == "slope":
        return exact({DAMPING: damping})
    return exact({FORCE: forces[0] + damping * first})


# --- belts ---


def _belts() -> Items:
    """Return the items on what does not depend on the band at the speed of a belt."""
    below, above = (_line(slower) for slower in (1, 2))
    at_belt = {v: SPEEDS[1]}
    known = {named(r"f_\lambda(0)"): STARTS[1], v_lambda: SPEEDS[1], EDGE: SPEEDS[1]}
    forces = {F(HERE): _force(1).subs(at_belt) / m, F(NEXT): _force(2).subs(at_belt) / m}
    twice = {JUMP: 2 * STARTS[1] / m}
    lines = {
        DAMPING: below.damping,
        FORCE: below.force,
        NEXT_DAMPING: above.damping,
        NEXT_FORCE: above.force,
    }
    rate = named(r"m\dot{F}^{(j)}")
    position = x_i + v_lambda * (t - solution.t_i)
    sliding = m * in_band(DAMPING, FORCE, position, v_lambda)
    return (
        r"\subsection{What stays at a belt}",
        r"Let $F^{(j)}$ be the acceleration in band $j$, and let edge $u$ lie between the bands $j$ "
        r"and $j + 1$. At a belt $u = v_\lambda$.",
        r"\begin{theorem}[what every law shares]\label{thm:friction_curves-belts} At the speed of "
        r"belt $\lambda$ the accelerations below and above differ by",
        equation(F(HERE) - F(NEXT), JUMP, exact({**forces, **twice}), "jump"),
        equation(
            JUMP,
            2 * named(r"f_\lambda(0)") / m,
            exact({JUMP: forces[F(HERE)] - forces[F(NEXT)], **known}),
            "J",
        ),
        r"whatever the curves of this and of the other belts are. During a stick both change at "
        r"the rate",
        equation(
            rate,
            -(k * v_lambda + B0 * Omega * sp.sin(theta)),
            exact({rate: sliding.diff(t).subs(Omega * t, theta)}),
            "rate",
        ),
        r"which depends on neither $c_j$ nor $A_j$. At each edge, belt or corner, the constants of "
        r"both bands obey",
        equation(
            FORCE - NEXT_FORCE,
            (DAMPING - NEXT_DAMPING) * EDGE + m * JUMP,
            cases(exact({**lines, **twice, **known}), *_corner_checks()),
            "joined",
        ),
        r"with $J = 0$ at a corner.\end{theorem}",
        r"\begin{proof} Only the friction of belt $\lambda$ jumps at $v_\lambda$, from "
        r"$f_\lambda(0)$ to $-f_\lambda(0)$; all else is continuous in the velocity. On the belt "
        r"the velocity is constant, so the damper does not change. \eqref{eq:friction_curves-joined} "
        r"is \eqref{eq:friction_curves-jump} in the letters of both bands.\end{proof}",
        r"So $0 \ge F^{(j+1)} - E$ and $F^{(j)} + E \ge 0$ decide about sticks as before: "
        r"Chapters~\ref{sec:sticks}, \ref{sec:switching} and~\ref{sec:static_friction} hold with "
        r"$f_\lambda(0)$ in place of $\mu_\lambda F_N$ and $s_\lambda$ in place of $\mu_{s\lambda} "
        r"F_N$.",
        _theorem7(),
    )


def _corner_checks() -> Iterator[Check]:
    """Yield the checks that the constants of two bands are joined at a corner above and below a
    belt.
    """
    place = sp.Symbol("w_c", positive=True)
    near = (START, SLOPE)
    # the piece beyond the corner has another slope, and the same friction at the corner
    steeper = sp.Symbol("q_e", real=True)
    far = (START + (SLOPE - steeper) * place, steeper)
    for side in (1, -1):
        if side == 1:
            lower, upper = near, far
        else:
            lower, upper = far, near
        constants = dict[Any, Any]()
        for names, (start, slope) in (
            ((DAMPING, FORCE), lower),
            ((NEXT_DAMPING, NEXT_FORCE), upper),
        ):
            constants |= {names[0]: c + slope, names[1]: A0 + slope * v_lambda - side * start}
        yield exact({**constants, JUMP: 0, EDGE: v_lambda + side * place})


def _recursion(order: int) -> Check:
    """Return the check of the recursion of G-functions at one order."""
    in_band = {c: DAMPING, solution.A: FORCE}
    # v, and the G-functions of the orders 0, 1, ...
    functions = [v_lambda, *(expr.subs(in_band) for expr in along_flow(order))]
    return exact(
        {
            G("n", HERE): functions[order + 1],
            G("n-1", HERE): functions[order],
            G("n-2", HERE): functions[order - 1],
            named("n"): order,
            theta: theta_i,
        }
    )


def _first_at_edge(order: int) -> Check:
    """Return the check of a G-function in both bands, where those of lower order vanish."""
    checks = []
    for damping, force in ((DAMPING, FORCE), (NEXT_DAMPING, NEXT_FORCE)):
        flows = [expr.subs({c: damping, solution.A: force}) for expr in along_flow(order)]
        value = flows[order] + damping / m * flows[order - 1]
        if order > 1:
            value += k / m * flows[order - 2]
        checks.append(exact({G(order, HERE): value, EDGE: v_lambda, theta: theta_i}))
    return cases(*checks)


def _theorem7() -> Items:
    """Return the items on G-functions and Theorem 7 at any edge."""
    counter = named("n")
    wave = B0 * Omega**counter * sp.cos(theta + counter * sp.pi / 2) / m
    contact = named("x_m")
    (place,) = sp.solve(in_band(DAMPING, FORCE, x, v_lambda), x)
    return (
        r"\begin{lemma}[G-functions at an edge]\label{thm:friction_curves-G} Along the flow of band "
        r"$j$, with $G^{(0,j)} = F^{(j)}$ and $G^{(-1,j)} = \dot{x}$, for all $n \ge 1$",
        equation(
            G("n", HERE),
            wave - DAMPING / m * G("n-1", HERE) - k / m * G("n-2", HERE),
            cases(*map(_recursion, range(1, 7))),
            "recursion",
        ),
        r"So where $\dot{x} = u$ and all G-functions of lower order vanish,",
        equation(
            G(1, HERE),
            -(k * EDGE + B0 * Omega * sp.sin(theta)) / m,
            _first_at_edge(1),
            "G1",
        ),
        equation(G(2, HERE), -B0 * Omega**2 * sp.cos(theta) / m, _first_at_edge(2), "G2"),
        equation(G(3, HERE), B0 * Omega**3 * sp.sin(theta) / m, _first_at_edge(3), "G3"),
        r"and one of them is not 0, unless $B_0 = k u = 0$.\end{lemma}",
        r"\begin{proof} Differentiate \eqref{eq:friction_curves-newton} $n$ times; the machine's "
        r"check is for $n = 1$ to 6. If $G^{(2,j)} = G^{(3,j)} = 0$, then $B_0 = 0$, and $k u = 0$ "
        r"by $G^{(1,j)} = 0$.\end{proof}",
        r"\begin{corollary}[Theorem 7 for every law]\label{thm:friction_curves-theorem7} The "
        r"critical phases $\Theta^{\mathrm{cr}}$ and the windows of "
        r"Theorems~\ref{thm:grazing-theorem7} and~\ref{thm:grazing-equality}, with $u$ for "
        r"$v_\lambda$, are those of each edge of each law. The position of the contact is",
        equation(
            contact,
            (FORCE - DAMPING * v_lambda + B0 * sp.cos(theta)) / k,
            exact({contact: place.subs(Omega * t, theta)}),
            "contact",
        ),
        r"and the phases at which a stick can end are those of "
        r"Theorem~\ref{thm:static_friction-exits}.\end{corollary}",
        r"\begin{proof} The proofs use \eqref{eq:grazing-G1}, \eqref{eq:grazing-G2} and "
        r"\eqref{eq:grazing-G3} at $F^{(\alpha)} = 0$ alone. These are \eqref{eq:friction_curves-G1} "
        r"to \eqref{eq:friction_curves-G3}, without $c_j$ and $A_j$.\end{proof}",
    )


# --- corners ---


def _at_corner() -> dict[Any, Any]:
    """Return the constants of the band above a corner, by \\eqref{eq:friction_curves-joined}."""
    return {NEXT_FORCE: FORCE - (DAMPING - NEXT_DAMPING) * EDGE}


def _corners() -> Items:
    """Return the items on corners."""
    here = in_band(DAMPING, FORCE, x, EDGE)
    there = in_band(NEXT_DAMPING, NEXT_FORCE, x, EDGE).subs(_at_corner())
    meaning = {F(HERE): here, F(NEXT): there}
    return (
        r"\subsection{Corners are no events}",
        r"\begin{theorem}[both bands agree]\label{thm:friction_curves-corner} Let a motion have "
        r"$\dot{x} = u$ at a corner. Then",
        equation(F(HERE) - F(NEXT), 0, exact(meaning), "same-force"),
        r"and the first G-function that does not vanish there has the same order $n$ and the same "
        r"value in both bands. For even $n$ the motion passes the corner, for odd $n$ it touches "
        r"it and returns. It never sticks, and it is unique. If all G-functions vanish, $\dot{x} = "
        r"u$ for ever.\end{theorem}",
        r"\begin{proof} \eqref{eq:friction_curves-same-force} is "
        r"\eqref{eq:friction_curves-joined} with $J = 0$. Let the G-functions of the orders $0$ to "
        r"$n - 1$ vanish in both bands. In \eqref{eq:friction_curves-recursion} $c_j$ multiplies "
        r"one of these, so $G^{(n,j)}$ does not depend on the band: induction. The sides before and "
        r"after follow from Lemma~\ref{thm:switching-side}, with the same answer in both bands: one "
        r"of them has the motion, and it leaves into the band that its own flow goes to. If all "
        r"vanish, $B_0 = k u = 0$ by Lemma~\ref{thm:friction_curves-G}, and $F^{(j)} = 0$ remains "
        r"true at the constant velocity $u$.\end{proof}",
        r"So no window, no stick and no label belongs to a corner. Neither does a jump of the "
        r"derivative: in the matrix $\operatorname{diag}(1, F^{+}/F^{-})$ of "
        r"Theorem~\ref{thm:jacobians-saltation}",
        equation(F(NEXT) / F(HERE), 1, exact(meaning, sp.simplify), "saltation"),
        r"so that it is the identity, and $\Phi$ of a flight is the product of those of its bands. "
        r"Areas change with",
        equation(
            named(r"\det\Phi"),
            sp.exp(-named(r"\sum_j c_j \tau_j") / m),
            exact(_area_meaning()),
            "area",
        ),
        r"where $\tau_j$ is the time spent in band $j$.",
    )


def _area_meaning() -> dict[Any, Any]:
    """Return the determinant of a passage through two bands, from the basis functions of each."""
    first, second = sp.symbols("tau_1 tau_2", positive=True)
    meaning: dict[Any, Any] = {named(r"\sum_j c_j \tau_j"): DAMPING * first + NEXT_DAMPING * second}
    determinant: Any = 1
    for damping, time in ((DAMPING, first), (NEXT_DAMPING, second)):
        # In a band with two roots: Phi of the velocity and the position, and its determinant.
        rate = damping / (2 * m)
        wave = sp.exp(-rate * time) * sp.sin(FREQUENCY * time) / FREQUENCY
        slope = wave.diff(time)
        stiffness = rate**2 + FREQUENCY**2
        first_entry = slope + 2 * rate * wave
        determinant *= sp.simplify(first_entry * slope + stiffness * wave**2)
    return meaning | {named(r"\det\Phi"): determinant}


def _touch() -> Items:
    """Return the items on a touch of a corner."""
    depth = sp.Symbol("delta", positive=True)
    bend = sp.Symbol("b", positive=True)
    half = sp.Symbol("s", positive=True)
    gap = named("g")
    change = named(r"\delta\dot{x}")
    impulse = named(r"\int g\,dt")
    area = sp.integrate(depth - bend * t**2 / 2, (t, -half, half))
    contact = {bend: 2 * depth / half**2}
    here = in_band(DAMPING, FORCE, x, EDGE + gap)
    beyond = in_band(NEXT_DAMPING, NEXT_FORCE, x, EDGE + gap).subs(_at_corner())
    push = sp.simplify((beyond - here) / gap)
    return (
        r"\begin{proposition}[a touch]\label{thm:friction_curves-touch} Let the motion of band $j$, "
        r"continued, go beyond a corner by a gap $g$ of at most $\delta$, with $b = |k u + "
        r"B_0\Omega\sin\theta|/m > 0$ at the largest gap, and let $s = \sqrt{2\delta/b}$. Beyond "
        r"the corner the accelerations differ by",
        equation(
            F(NEXT) - F(HERE),
            -(NEXT_DAMPING - DAMPING) * gap / m,
            exact({F(NEXT): beyond, F(HERE): here}),
            "beyond",
        ),
        r"so that, to leading order, the corner changes the velocity by",
        equation(
            impulse, sp.Rational(4, 3) * depth * half, exact({impulse: area, **contact}), "impulse"
        ),
        equation(
            change,
            -sp.Rational(4, 3) * depth * half * (NEXT_DAMPING - DAMPING) / m,
            exact({change: push * impulse, impulse: area, **contact}),
            "touch",
        ),
        r"which is of the order $\delta^{3/2}$.\end{proposition}",
        r"\begin{proof} The difference of both motions obeys the equation of band $j$ with the right "
        r"side $-(c_{j+1} - c_j)\,g/m$ while the gap is positive, and 0 else. At a time $r$ after "
        r"its maximum the gap is $\delta - b r^2/2$, to leading order, and it is positive for $|r| < "
        r"s$.\end{proof}",
        r"So a program that cannot decide whether a corner is touched need not decide it: with a "
        r"gap below $\delta$ both answers are the same motion up to the order $\delta^{3/2}$. At a "
        r"belt with $E = 0$ it is the order $\delta$, and with $E > 0$ another motion "
        r"(Example~\ref{thm:static_friction-fork}).",
    )


def _accumulation() -> Items:
    """Return the items on why events and corners do not accumulate."""
    gap = named("g")
    rate = named(r"\dot{g}|_j")
    above = named(r"\dot{g}|_{j+1}")
    force = named("U")
    force_rate = named(r"\dot{U}")
    turning = named("r")
    path = sp.Function("x")(t)
    here = in_band(DAMPING, FORCE, x, EDGE)
    jumped = {NEXT_FORCE: FORCE - (DAMPING - NEXT_DAMPING) * EDGE - m * JUMP}
    meaning = {
        force: here,
        rate: in_band(DAMPING, FORCE, x, v),
        above: in_band(NEXT_DAMPING, NEXT_FORCE, x, v).subs(jumped),
        gap: v - EDGE,
    }
    moving = in_band(DAMPING, FORCE, path, EDGE).diff(t)
    moving = moving.subs(path.diff(t), EDGE + gap)
    turn = -(k * EDGE + B0 * Omega * sp.sin(Omega * t)) / m
    return (
        r"\begin{theorem}[nothing accumulates]\label{thm:friction_curves-finite} For every law and "
        r"all parameters a motion has finitely many events, and passes finitely many corners, in "
        r"each bounded interval of time.\end{theorem}",
        r"\begin{proof} Let $E = 0$ at edge $u$, let $g = \dot{x} - u$, and let $U$ be $F^{(j)}$ "
        r"taken at the position and the time of the motion, but at the speed $u$. While the motion "
        r"is in the two bands beside the edge,",
        equation(rate, force - DAMPING / m * gap, exact(meaning), "gap-below"),
        equation(above, force - JUMP - NEXT_DAMPING / m * gap, exact(meaning), "gap-above"),
        equation(
            force_rate,
            turning - k / m * gap,
            exact({force_rate: moving, turning: turn}),
            "gap-rate",
        ),
        r"with $r = -(k u + B_0\Omega\sin\theta)/m$. These are the equations of "
        r"Lemma~\ref{thm:accumulation-forces}, each band with its own damping, and $J = 0$ at a "
        r"corner. The proofs of Lemma~\ref{thm:accumulation-returns} and "
        r"Theorem~\ref{thm:accumulation-three} take one flight beside the edge at a time, and need "
        r"a positive solution $\varphi$ of its unforced equation. $E_1$ is one, for dampings of "
        r"either sign (Proposition~\ref{thm:friction_curves-forms}). So there are at most three "
        r"contacts with the edge in a short interval of time. Edges are finite in number. Where $E "
        r"> 0$, Corollary~\ref{thm:static_friction-count} holds with the largest $|c_j|$ for "
        r"$c$.\end{proof}",
    )


# --- growth ---


def _closed_forms() -> Items:
    """Return the items on the closed forms in a band with a damping of any sign."""
    letter = named("E_1")
    waves = (
        (sp.sin(FREQUENCY * tau) / FREQUENCY, RATE**2 + FREQUENCY**2, r"if $h^2 < k/m$,", "wave"),
        (tau, RATE**2, r"if $h^2 = k/m$,", "critical"),
        (
            sp.sinh(HYPERBOLIC * tau) / HYPERBOLIC,
            RATE**2 - HYPERBOLIC**2,
            r"if $h^2 > k/m$.",
            "overdamped",
        ),
    )
    forms = [
        equation(
            letter,
            sp.exp(-RATE * tau) * wave,
            solves(0, 0, 1, 2 * RATE, stiffness),
            label,
            note=note,
        )
        for wave, stiffness, note, label in waves
    ]
    first = named(r"\ell_1")
    second = named(r"\ell_2")
    root = sp.Symbol("epsilon", positive=True)
    roots = {first: -RATE + HYPERBOLIC, second: -RATE - HYPERBOLIC}
    stiffness = {k: m * (RATE**2 - HYPERBOLIC**2)}
    size = {RATE: -root - HYPERBOLIC}
    return (
        r"\subsection{Closed forms where motions grow}",
        r"\begin{proposition}[the same functions]\label{thm:friction_curves-forms} With $h = "
        r"c_j/(2m)$ of either sign, the impulse response of band $j$ is",
        forms,
        r"It is positive for $0 < \tau < \pi/\omega_d$ in the first case, and for all $\tau > 0$ in "
        r"the others. $E_0$, $E_2$, $R_2$ and $I_2$ follow from it as in "
        r"Definition~\ref{thm:domains-basis}.\end{proposition}",
        r"The basis functions are entire in $c_j$, so no formula of Chapter~\ref{sec:domains} "
        r"changes. One choice does: the roots $\ell_1$ and $\ell_2$ of an overdamped band with $h < "
        r"0$. There",
        equation(first * second, k / m, exact({**roots, **stiffness}), "roots"),
        step(first, ">", 0, sign({**roots, **size}), "large-root"),
        r"where $\ell_1 = -h + \eta$ is a sum of two positive numbers, and $\ell_2 = (k/m)/\ell_1$ "
        r"loses no digits, while $-h - \eta$ would.",
    )


def _signs(meaning: dict[Any, Any]) -> Check:
    """Return the check of an inequality for both signs of the decay rate."""
    size = sp.Symbol("epsilon", positive=True)
    both = ({RATE: size, GROWTH: 0}, {RATE: -size, GROWTH: size})
    return cases(*(sign({**meaning, **values}) for values in both))


def _growth() -> Items:
    """Return the items on how fast anything grows."""
    time = sp.Symbol("s", nonnegative=True)
    total = named("Q")
    change = named(r"\dot{Q}")
    speed = named(r"\dot{z}")
    place = named("z")
    square = speed**2 + k / m * place**2
    z = sp.Function("z")(t)
    free = (z.diff(t) ** 2 + k / m * z**2).diff(t)
    free = free.subs(z.diff(t, 2), -2 * RATE * z.diff(t) - k / m * z)
    free = free.subs(z.diff(t), speed).subs(z, place)
    falling = named(r"\frac{d}{ds}\bigl(e^{-4 h_{-} s} Q\bigr)")
    Q = sp.Function("Q")(time)
    weighted = (sp.exp(-4 * GROWTH * time) * Q).diff(time)
    weighted = weighted.subs(Q.diff(time), change).subs(Q, total)
    start = sp.Symbol("epsilon_1", nonnegative=True)
    less = sp.Symbol("epsilon_2", nonnegative=True)
    now = named(r"\sqrt{Q(\tau)}")
    later = named(r"\sqrt{Q(\tau + s)}")
    # e^{-4 h_- s} Q has fallen from start^2 to start^2 - less
    fallen = {now: sp.sqrt(start + less), later: sp.sqrt(sp.exp(4 * GROWTH * time) * start)}
    return (
        r"\begin{theorem}[growth]\label{thm:friction_curves-growth} Let $z$ be the transient of a "
        r"flight in a band, or a derivative of it, let $Q = \dot{z}^2 + (k/m) z^2$ and $h_{-} = "
        r"\max(-h, 0)$. Then",
        equation(change, -4 * RATE * speed**2, exact({change: free}), "energy"),
        step(
            change,
            "<=",
            4 * GROWTH * total,
            _signs({change: -4 * RATE * speed**2, total: square}),
            "growth",
        ),
        r"so that, for $s \ge 0$,",
        step(later, "<=", sp.exp(2 * GROWTH * time) * now, _root_check(fallen), "root"),
        r"\end{theorem}",
        r"\begin{proof} $\ddot{z} + 2h\dot{z} + (k/m)z = 0$. By \eqref{eq:friction_curves-growth}",
        equation(
            falling,
            sp.exp(-4 * GROWTH * time) * (change - 4 * GROWTH * total),
            exact({falling: weighted}),
            "falling",
        ),
        r"is never positive; take the root.\end{proof}",
        r"For $h \ge 0$ this is \eqref{eq:events-energy}: $h_{-} = 0$, and nothing grows.",
    )


def _root_check(fallen: dict[Any, Any]) -> Check:
    """Return the check of sqrt(Q) from that of Q: both sides are positive, and are squared."""

    def check(statement: Step) -> Any:
        squares = Step(statement.left**2, statement.op, statement.right**2, statement.check)
        return sign(fallen)(squares)

    return check


def _search() -> Items:
    """Return the items on the bounds of the search, and on how far they are used."""
    speed = named(r"\dot{w}")
    place = named("w")
    total = named("Q")
    change = named(r"\dot{Q}")
    push = sp.Symbol("epsilon", positive=True)
    less = sp.Symbol("epsilon_2", nonnegative=True)
    moving = sp.Symbol("epsilon_1", nonnegative=True)
    amplitude = named("a")
    drive = amplitude * Omega**3 * sp.cos(theta)
    w = sp.Function("w")(t)
    pushed = (w.diff(t) ** 2 + k / m * w**2).diff(t)
    third = -(amplitude * sp.sin(Omega * t)).diff(t, 3)
    pushed = pushed.subs(w.diff(t, 2), third - 2 * RATE * w.diff(t) - k / m * w)
    pushed = pushed.subs(w.diff(t), speed).subs(w, place).subs(Omega * t, theta)
    most = named(r"|a|\Omega^3")
    bounded = {
        change: 2 * moving * (push - less) - 4 * RATE * moving**2,
        total: moving**2 + k / m * place**2,
        most: push,
        named(r"|\dot{w}|"): moving,
    }
    span = sp.Symbol("s", nonnegative=True)
    bound = named(r"\dot{\rho} - 2h_{-}\rho")
    first = named(r"\rho_0")
    rho = sp.exp(2 * GROWTH * span) * (first + most * span)
    reach = named("2|h|S")
    rate = sp.Symbol("epsilon", positive=True)
    longest = REACH / rate * (1 + BEYOND)
    factor = sp.exp(2 * REACH * (1 + BEYOND))
    return (
        r"\subsection{The search where motions grow}",
        r"\begin{theorem}[the two bounds with growth]\label{thm:friction_curves-bounds} In a band, "
        r"for all $s$ from 0 to $S$, while the flight stays in it, and with the letters of "
        r"Theorems~\ref{thm:events-steady} and~\ref{thm:events-while},\begin{enumerate}\item[(i)] "
        r"away from undamped resonance ($\Delta > 0$), with $U = \sqrt{(u^{(4)})^2 + (k/m) "
        r"(u^{(3)})^2}$, $|g^{(4)}| \le V_0\Omega^4 + e^{2 h_{-} S} U$;\item[(ii)] always, with $W "
        r"= \sqrt{\dot{w}^2 + (k/m) w^2}$, $|g^{(4)}| \le e^{2 h_{-} S} (W + |a|\,\Omega^3 S)$, where "
        r"$|a|\,\Omega^3 S \le |B_0|\Omega^3/m$ for $S \le 1/\Omega$.\end{enumerate}The "
        r"derivatives are taken at $s = "
        r"0$. For $h \ge 0$ and $S = 1/\Omega$ these are the bounds of "
        r"Chapter~\ref{sec:events}.\end{theorem}",
        r"\begin{proof} (i) $u^{(3)}$ is a transient: Theorem~\ref{thm:friction_curves-growth}. The "
        r"steady velocity has the amplitude $V_0$ for $h$ of either sign. (ii) Let $Q = \dot{w}^2 + "
        r"(k/m)w^2$. By \eqref{eq:events-Lw}",
        equation(change, 2 * speed * (drive - 2 * RATE * speed), exact({change: pushed}), "pushed"),
        step(
            change,
            "<=",
            4 * GROWTH * total + 2 * most * named(r"|\dot{w}|"),
            _signs(bounded),
            "pushed-growth",
        ),
        r"and $|\dot{w}| \le \sqrt{Q}$, so that $\sqrt{Q}$ grows at most at the rate $2h_{-}\sqrt{Q} "
        r"+ |a|\Omega^3$. It stays below $\rho(s) = e^{2h_{-}s}(\rho_0 + |a|\Omega^3 s)$ with "
        r"$\rho_0 = \sqrt{Q(0)}$, since",
        equation(
            bound,
            sp.exp(2 * GROWTH * span) * most,
            exact({bound: rho.diff(span) - 2 * GROWTH * rho}),
            "above",
        ),
        r"is at least $|a|\Omega^3$.\end{proof}",
        r"\begin{corollary}[fourfold]\label{thm:friction_curves-fourfold} The program searches a "
        r"band with $h < 0$ in stretches of at most $\frac{7}{20|h|}$, and looks beyond the end of "
        r"a stretch by at most $\frac{5}{8}$ of it. So in a stretch",
        step(reach, "<=", sp.Rational(91, 80), _at_most({reach: 2 * rate * longest}), "reach"),
        step(sp.exp(sp.Rational(91, 80)), "<", 4, sign({}), "fourfold"),
        r"and no derivative of a transient, measured by $\sqrt{Q}$, grows more than fourfold. The "
        r"factor is at most",
        decimal(
            "e^{91/80}",
            CONTEXT.exp(CONTEXT.mpf(91) / 80),
            2,
            close(lambda: CONTEXT.mpf(sp.N(factor, 50)._to_mpmath(CONTEXT.prec)), 2),
        ),
        r"\end{corollary}",
        r"Four times the bounds of Chapter~\ref{sec:events} are therefore bounds in each stretch "
        r"(the second one if $S \le 1/\Omega$), and Theorem~\ref{thm:events-search} holds stretch by "
        r"stretch. Where $h < 0$ a transient that is small now need not stay small. So a program may "
        r"conclude from it that a flight meets no belt any more only where $c_j \ge 0$, as in the "
        r"outermost bands, which have $c_\infty \ge c \ge 0$.",
    )


def _at_most(meaning: dict[Any, Any]) -> Check:
    """Return the check of an upper bound between exact numbers that is the best one."""

    def check(statement: Step) -> Any:
        equation(statement.left, statement.right, exact(meaning)).verify()
        return sign(meaning)(statement)

    return check


# --- contraction ---


def _contraction() -> Items:
    """Return the items on the criterion of contraction."""
    rate = named(r"\dot{y}")
    bend = named(r"\ddot{y}")
    place = named("y")
    forces = named(r"(T - \tilde{T})")
    energy = named(r"\dot{W}")
    whole = named("W")
    plain = named(r"T - \tilde{T}")
    meaning = {
        energy: m * rate * bend + k * place * rate,
        bend: (forces - c * rate - k * place) / m,
    }
    more = sp.symbols("epsilon_1:3", nonnegative=True)
    spans = sp.symbols("delta_1:3", nonnegative=True)
    jump = sp.Symbol("epsilon", nonnegative=True)
    relative = named(r"(w - \tilde{w})")
    # from the smaller velocity to the larger one: two bands with dampings above c_*, and a belt
    fallen = -jump - sp.Add(
        *((LEAST + extra - c) * span for extra, span in zip(more, spans, strict=True))
    )
    falls = {plain: fallen, relative: sp.Add(*spans)}
    moving = sp.Symbol("epsilon_1", positive=True)
    work = {
        energy: (-(LEAST - c) * moving - jump) * moving - c * moving**2,
        rate: moving,
    }
    size = sp.Symbol("epsilon_2", positive=True)
    grows = {
        energy: size * rate**2,
        whole: m * rate**2 / 2 + k * place**2 / 2,
        named(r"|c_{*}|"): size,
    }
    return (
        r"\subsection{When two motions approach each other}",
        r"Let $T = \sum_\lambda T_\lambda$ be the friction of all belts, and $c_*$ the least $c_j$ "
        r"of all bands.",
        r"\begin{lemma}[friction falls at least so fast]\label{thm:friction_curves-monotone} Let $E "
        r"= 0$ at all belts, and let $T$ and $\tilde{T}$ be possible values of the friction at the "
        r"velocities $w > \tilde{w}$. Then",
        step(plain, "<=", -(LEAST - c) * relative, sign(falls), "monotone"),
        r"\end{lemma}",
        r"\begin{proof} By \eqref{eq:friction_curves-damping} $T$ has the slope $c - c_j$ in band "
        r"$j$, at most $c - c_*$. At a belt it jumps down, by \eqref{eq:friction_curves-jump}, and "
        r"may have any value between. Between $\tilde{w}$ and $w$ lie parts of bands and belts; the "
        r"machine's check has two bands and a belt.\end{proof}",
        r"\begin{theorem}[criterion of contraction]\label{thm:friction_curves-contraction} Let $E = "
        r"0$ at all belts, let $y$ be the difference of two motions and $W = \frac{m}{2}\dot{y}^2 + "
        r"\frac{k}{2}y^2$. Then",
        equation(energy, forces * rate - c * rate**2, exact(meaning), "work"),
        step(energy, "<=", -LEAST * rate**2, sign(work), "contraction"),
        r"\begin{enumerate}\item[(i)] If $c_j \ge 0$ in all bands, $W$ never grows, and all "
        r"statements of this supplement that rest on \eqref{eq:motion-energy} alone hold with $c_*$ "
        r"in place of $c$.\item[(ii)] If $c_* < 0$, then",
        step(energy, "<=", 2 * named(r"|c_{*}|") / m * whole, sign(grows), "separation"),
        r"so that $\sqrt{W}$ grows at most like $e^{|c_*|t/m}$. Motions are unique forward in time "
        r"and depend continuously on their start and on the parameters, on each bounded interval of "
        r"time.\end{enumerate}\end{theorem}",
        r"\begin{proof} Lemma~\ref{thm:friction_curves-monotone} with $w - \tilde{w} = \dot{y}$; for "
        r"$\dot{y} < 0$ exchange the motions. Existence is that of Theorem~\ref{thm:motion-unique}: "
        r"friction is still a convex set, closed, and grows at most linearly. If $W$ is 0 at the "
        r"start, it stays 0 by \eqref{eq:friction_curves-separation} (one-sided Lipschitz "
        r"condition). A parameter that changes by $\epsilon$ adds work of the order $\epsilon$ to "
        r"$\dot{W}$; where it moves the speed of a belt, the lemma is for the velocities relative to "
        r"this belt, which differ from the others by $\epsilon$.\end{proof}",
        r"In short: $c_j = c + \sum_\lambda q_\lambda \ge 0$ says that no piece of a curve falls "
        r"faster than the damper can make up for. The package calls such a law \emph{contracting} "
        r"(\texttt{contracts}). A single band with $c_j < 0$, or a single belt with $E > 0$, takes "
        r"the contraction away, and chaos may come "
        r"(Remark~\ref{thm:exponents-needs}).",
    )


def _bounded() -> Items:
    """Return the items on how far motions go, with dampings of any sign."""
    outer = named(r"c_{\infty}")
    extra = named(r"\hat{T}")
    total = named(r"m\ddot{x} + c_{\infty}\dot{x} + k x")
    friction = named("T")
    force = A0 + B0 * sp.cos(Omega * t) + friction - c * v - k * x
    return (
        r"\begin{proposition}[how far a motion goes]\label{thm:friction_curves-bound} Let the "
        r"damping $c_\infty$ of the outermost bands and $k$ be positive. With $\hat{T} = T + "
        r"(c_\infty - c)\dot{x}$",
        equation(
            total,
            A0 + B0 * sp.cos(Omega * t) + extra,
            exact({total: force + outer * v + k * x, extra: friction + (outer - c) * v}),
            "bounded",
        ),
        r"where $\hat{T}$ is bounded. So every motion comes into a fixed ball, and "
        r"Proposition~\ref{thm:orbits-bound} holds with $c_\infty$ for $c$ and the largest "
        r"$|\hat{T}|$ for $(\mu_1 + \mu_2)F_N$. If $E = 0$ at all belts, there is a periodic motion "
        r"with the period $2\pi/\Omega$, whatever the signs of the other $c_j$ "
        r"are.\end{proposition}",
        r"\begin{proof} In both outermost bands $T$ has the slope $c - c_\infty$, so there $\hat{T}$ "
        r"is constant; between them $\dot{x}$ is bounded. The map over one period takes a large ball "
        r"into itself, and is continuous by Theorem~\ref{thm:friction_curves-contraction}: "
        r"Brouwer's theorem.\end{proof}",
        r"\begin{corollary}[one attractor]\label{thm:friction_curves-attractor} Let $E = 0$ at all "
        r"of $n \ge 1$ belts, $c_* > 0$ and $k > 0$. Then Theorems~\ref{thm:orbits-unique}, "
        r"\ref{thm:jacobians-monodromy}, \ref{thm:exponents-lyapunov}, \ref{thm:exponents-chaos} "
        r"and~\ref{thm:borders-atlas} hold, with $c_*$ for $c$, with $f_\lambda(0)$ for "
        r"$\mu_\lambda F_N$, with $A_0$ and the friction of all other belts for $H_\lambda$, and with "
        r"\eqref{eq:friction_curves-area} for the factor of areas.\end{corollary}",
        r"\begin{proof} They use $\dot{W} \le -c\,\dot{y}^2$, bounded motions, and at belts "
        r"\eqref{eq:motion-jump} and \eqref{eq:sticks-rate}. These are "
        r"Theorem~\ref{thm:friction_curves-contraction}, "
        r"Proposition~\ref{thm:friction_curves-bound} and "
        r"Theorem~\ref{thm:friction_curves-belts}. At corners nothing happens "
        r"(Theorem~\ref{thm:friction_curves-corner}).\end{proof}",
    )


# --- labels ---


#: Kinds of mappings: the letter, what it is, and how many there are with n belts.
_COUNT = sp.Symbol("n", positive=True)
KINDS = (
    ("S", "stick on a belt", _COUNT),
    ("B", "return to a belt from below", _COUNT),
    ("A", "return to a belt from above", _COUNT),
    ("U", "passage up, to the next belt", _COUNT - 1),
    ("D", "passage down, to the next belt", _COUNT - 1),
)
#: For how many numbers of belts the labels of the package are counted.
MOST_BELTS = 6


def _kind(mapping: Map) -> str:
    """Return the letter of a mapping, from the planes where it starts and ends."""
    start, end = mapping.start, mapping.end
    if start.superscript == 0:
        return "S"
    if start == end:
        return {1: "B", 2: "A"}[start.superscript]
    if start.boundary < end.boundary:
        return "U"
    return "D"


def _counted(letter: Any, kind: str) -> Check:
    """Return the check of the number of mappings of a kind ("": all), among those of the
    package.
    """
    checks = []
    for belts in range(1, MOST_BELTS + 1):
        kinds = [_kind(mapping) for mapping in geometry(belts).maps.values()]
        count = kinds.count(kind) if kind else len(kinds)
        checks.append(exact({letter: sp.Integer(count), _COUNT: sp.Integer(belts)}))
    return cases(*checks)


def _labels() -> Items:
    """Return the items on the mappings of any number of belts."""
    count = named("N")
    sums = named(r"N")
    rows = []
    for letter, meaning, number in KINDS:
        example = next(
            (
                (label, mapping)
                for label, mapping in geometry(2).maps.items()
                if _kind(mapping) == letter
            ),
            None,
        )
        paper = [
            f"$P_{label[1:]}$"
            for label, mapping in geometry(2).maps.items()
            if _kind(mapping) == letter
        ]
        assert example is not None
        number_step = equation(count, number, _counted(count, letter))
        names = ", ".join(rf"\texttt{{{name}}}" for name in _names(letter))
        rows.append((rf"\texttt{{{letter}}}", meaning, number_step, names, ", ".join(paper)))
    outer = 2
    inner = 4 * (_COUNT - 1)
    return (
        r"\subsection{Labels of the mappings}",
        r"\begin{proposition}[$5n - 2$ mappings]\label{thm:friction_curves-labels} With $n$ belts, "
        r"whatever their curves are, there are",
        equation(
            sums,
            5 * _COUNT - 2,
            cases(exact({sums: _COUNT + inner + outer}), _counted(sums, "")),
            "labels",
        ),
        r"mappings from one event at a belt to the next: those of "
        r"Table~\ref{tab:friction_curves-labels}.\end{proposition}",
        r"\begin{proof} There is a stick on each belt. A flight lies in one domain, and corners in "
        r"it are no events (Theorem~\ref{thm:friction_curves-corner}). A domain between two belts "
        r"has four flights, two that return and two that pass; each of the two outermost domains "
        r"has one, which returns.\end{proof}",
        Table(
            "tab:friction_curves-labels",
            r"The mappings of $n$ belts; the names for belts 1 and 2, and the paper's, which the "
            r"package prints for two belts. A passage has the numbers of the belt that it leaves and "
            r"of the one that it reaches.",
            ("", "mapping", "number", "names", "paper"),
            tuple(rows),
        ),
        r"So a curve with more pieces has the same words, and the words of a Stribeck curve can be "
        r"compared with those of Coulomb's friction.",
    )


def _names(letter: str) -> list[str]:
    """Return the names of a kind of mappings of two belts: its letter, and the numbers of belts."""
    names = []
    for mapping in geometry(2).maps.values():
        if _kind(mapping) == letter:
            belts = [str(mapping.start.boundary)]
            if letter in "UD":
                belts.append(str(mapping.end.boundary))
            names.append(letter + "".join(belts))
    return names


# --- what remains ---


def _what_remains() -> Items:
    """Return the items on the theorems that hold, and on those that fall."""
    return (
        r"\subsection{Which theorems remain}",
        r"Table~\ref{tab:friction_curves-theorems} is for $E = 0$ at all belts. With a belt that "
        r"has $E > 0$ Tables~\ref{tab:static_friction-theorems} "
        r"and~\ref{tab:static_friction-falls} hold in addition.",
        Table(
            "tab:friction_curves-theorems",
            r"The theorems of this supplement with friction curves, $E = 0$ at all belts.",
            ("statement", r"$c_j \ge 0$ in all bands", r"$c_j < 0$ in a band"),
            _REMAINS,
            columns="p{54mm}p{46mm}p{46mm}",
        ),
    )


_REMAINS = (
    (
        r"Closed forms, Chapter~\ref{sec:domains}, band by band",
        "hold",
        r"hold (Proposition~\ref{thm:friction_curves-forms})",
    ),
    (
        r"Theorem~\ref{thm:grazing-theorem7} (Theorem 7); phases at which a mass can slip",
        "hold",
        r"hold (Corollary~\ref{thm:friction_curves-theorem7})",
    ),
    (
        r"One motion forward in time, Theorem~\ref{thm:motion-unique}; it depends continuously on "
        r"start and parameters",
        "holds",
        r"holds (Theorem~\ref{thm:friction_curves-contraction})",
    ),
    (
        r"Events do not accumulate, Theorem~\ref{thm:accumulation-finite}",
        "holds",
        r"holds (Theorem~\ref{thm:friction_curves-finite})",
    ),
    (
        r"Motions are bounded, and one has the period of the drive",
        r"holds for $c_\infty > 0$, $k > 0$",
        r"holds for $c_\infty > 0$, $k > 0$ (Proposition~\ref{thm:friction_curves-bound})",
    ),
    (
        r"A multiplier 0 after a stick, Theorem~\ref{thm:jacobians-monodromy} (ii)",
        "holds",
        "holds",
    ),
    (
        r"Distances never grow; no multiplier above 1, no positive exponent, no chaos, "
        r"Theorem~\ref{thm:exponents-chaos}",
        r"hold for $k > 0$",
        r"fall (Example~\ref{thm:equilibria-example})",
    ),
    (
        r"One motion attracts all others, with the period of the drive, "
        r"Theorem~\ref{thm:orbits-unique}",
        r"holds for $c_* > 0$, $k > 0$",
        r"falls: a rest and cycles exist side by side",
    ),
    (
        r"One motion decides the word between borders, Theorem~\ref{thm:borders-atlas}",
        r"holds for $c_* > 0$, $k > 0$",
        "falls",
    ),
    (
        r"Motions without a damper, Chapter~\ref{sec:undamped}",
        r"are for constant friction, and not carried over",
        r"are for constant friction, and not carried over",
    ),
)
