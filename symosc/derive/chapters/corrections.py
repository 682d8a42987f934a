"""Discontinuity maps of the four borders, their orders and coefficients, and the multipliers."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache, partial
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.chapters import borders
from symosc.derive.chapters.borders import NAMES
from symosc.derive.chapters.jacobians import force_at_belt
from symosc.derive.flight_basis import flight_basis
from symosc.derive.scope import Scope, v_lambda, valued
from symosc.derive.steps import (
    CONTEXT,
    STEP_DIGITS,
    Items,
    Table,
    at_root,
    close,
    decimal,
    equation,
    number,
)
from symosc.orbits.find import find_orbit
from symosc.scenes import load_scene
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import B0, Omega, c, k, m
from symosc.symbolic.theorem7 import rational

TITLE = "Discontinuity maps of the four borders"
#: The places of the borders in NAMES, CORRECTIONS and PHASES: their numbers `n`.
GRAZING, CROSSING, SWITCHING, ADDING = range(len(NAMES))
#: The place of the change of the position in what `changes` returns; that of the velocity is 1.
POSITION = 0
ROMAN = ("i", "ii", "iii", "iv")
SMALL = sp.Symbol(r"\epsilon", positive=True)
BEND = sp.Symbol("b", positive=True)
TIME = sp.Symbol("t", real=True)
END = sp.Symbol("s", positive=True)
GAP = named("g(t)")
PLACE = named(r"\delta x")
SPEED = named(r"\delta\dot{x}")
BEFORE = named("F^{-}")
ROOT = sp.sqrt(2 * SMALL / BEND)


class Correction(NamedTuple):
    """A border: the gap on the way not taken, when the extra piece is, and what it changes."""

    name: str
    piece: str
    gap: Any
    first: Any  # the beginning of the extra piece
    last: Any  # its end
    place: Any  # the change of x at the end of the piece, to leading order
    speed: Any  # that of v
    place_order: Any  # the power of epsilon in `place`
    speed_order: Any  # that in `speed`, None if this is 0


def _corrections() -> tuple[Correction, ...]:
    """Return the four borders with the changes that are to be shown."""
    bump = SMALL - BEND * TIME**2 / 2
    slip = -SMALL * (TIME + ROOT) + BEND * (TIME**3 + ROOT**3) / 6
    three_halves = sp.Rational(3, 2)
    return (
        Correction(
            NAMES[GRAZING],
            "stick",
            gap=bump,
            first=-ROOT,
            last=sp.S.Zero,
            place=-sp.Rational(2, 3) * sp.sqrt(2 / BEND) * SMALL**three_halves,
            speed=-SMALL,
            place_order=three_halves,
            speed_order=sp.S.One,
        ),
        Correction(
            NAMES[CROSSING],
            "stick",
            gap=SMALL * TIME - BEND * TIME**2 / 2,
            first=sp.S.Zero,
            last=SMALL / BEND,
            place=-(SMALL**3) / (3 * BEND**2),
            speed=-(SMALL**2) / (2 * BEND),
            place_order=sp.Integer(3),
            speed_order=sp.Integer(2),
        ),
        Correction(
            NAMES[SWITCHING],
            "slip",
            gap=-SMALL * TIME + BEND * TIME**2 / 2,
            first=sp.S.Zero,
            last=2 * SMALL / BEND,
            place=-2 * SMALL**3 / (3 * BEND**2),
            speed=sp.S.Zero,
            place_order=sp.Integer(3),
            speed_order=None,
        ),
        Correction(
            NAMES[ADDING],
            "slip",
            gap=slip,
            first=-ROOT,
            last=2 * ROOT,
            place=-9 * SMALL**2 / (2 * BEND),
            speed=sp.S.Zero,
            place_order=sp.Integer(2),
            speed_order=None,
        ),
    )


CORRECTIONS = _corrections()


def items(scope: Scope) -> Items:
    """Yield the chapter: the four maps, the exact flow beside them, and the multipliers."""
    yield (
        r"\subsection{What is compared}",
        r"Let the settled motion be regular (Definition~\ref{thm:borders-border}) but for one "
        r"event at a belt $\lambda$ with $\mu_\lambda F_N > 0$, at which $F^{(\alpha)}$ vanishes "
        r"as in one of the four cases of Theorem~\ref{thm:borders-names}. Beyond the border an "
        r"\emph{extra piece} is born: a stick in (i) and (ii), a slip in (iii) and (iv). Compare "
        r"the motion with the one that does without: in (i) and (ii) the flight of $\Omega_\alpha$ "
        r"goes on as if the belt did not hold, in (iii) and (iv) the stick goes on as if it did. "
        r"$\delta x$ and $\delta\dot{x}$ are what the motion has more than the continued one, at "
        r"the time at which the extra piece ends. The map $(x, \dot{x}) \mapsto (x + \delta x, "
        r"\dot{x} + \delta\dot{x})$ is the \emph{discontinuity map}: put behind the maps of the "
        r"shorter word it gives those of the longer one. Its letters are $b > 0$ and",
        r"\begin{enumerate}\item[(i)] grazing-sliding: $\epsilon$, by how much the continued "
        r"flight goes beyond $v_\lambda$ at most, and $b = |\dot{F}^{(\alpha)}|$ there;\item[(ii)] "
        r"crossing-sliding: $\epsilon = |F^{(\alpha)}|$ at the contact, of the sign that holds the "
        r"mass, and $b = |\dot{F}^{(\alpha)}|$;\item[(iii)] switching-sliding: $\epsilon = "
        r"|F^{(\alpha)}|$ at the contact, of the sign that lets the mass go, and $b = "
        r"|\dot{F}^{(\alpha)}|$;\item[(iv)] adding-sliding: $\epsilon$, by how much $F^{(\alpha)}$ "
        r"goes beyond 0 at most if the stick is continued, and $b = |\ddot{F}^{(\alpha)}|$ there, "
        r"which is $|a\,\Omega\cos\theta|$ by \eqref{eq:accumulation-r}.\end{enumerate}On the "
        r"other side of the border, for $\epsilon \le 0$, both changes are 0. $\epsilon$ is a "
        r"smooth function of the state before the event and of the parameters.",
        _theorem(),
    )
    yield _numbers_table()
    yield _multipliers()


def _theorem() -> Items:
    """Return the theorem on the four maps, with its steps."""
    steps: list[Any] = []
    for n, border in enumerate(CORRECTIONS):
        if border.piece == "stick":
            extra = -1
        else:
            extra = 1
        area = sp.integrate(border.gap, (TIME, border.first, border.last))
        steps.append(rf"({ROMAN[n]}) {border.name}:")
        steps.append(equation(PLACE, border.place, {PLACE: extra * area}, f"x-{n + 1}"))
        if border.speed != 0:
            last = border.gap.subs(TIME, border.last)
            steps.append(equation(SPEED, border.speed, {SPEED: -last}, f"v-{n + 1}"))
    return (
        r"\begin{theorem}[four discontinuity maps]\label{thm:corrections-maps} Let $\alpha = "
        r"\lambda$; for $\alpha = \lambda + 1$ all signs of $\delta x$ and $\delta\dot{x}$ are the "
        r"opposite. To leading order in $\epsilon > 0$",
        *steps,
        r"and $\delta\dot{x} = 0$ in (iii) and (iv). In (i) and (iv) $\delta x$, $\delta\dot{x}$ "
        r"are analytic functions of $\sqrt{\epsilon}$ near 0, in (ii) and (iii) of $\epsilon$, so "
        r"what is left out is smaller by a factor of the order $\sqrt{\epsilon}$ or "
        r"$\epsilon$.\end{theorem}",
        r"\begin{proof} By \eqref{eq:accumulation-below} and \eqref{eq:accumulation-rate} $\dot{g} "
        r"= U - (c/m)g$ and $\dot{U} = r - (k/m)g$. Measure $t$ from the maximum in (i), from the "
        r"contact in (ii) and (iii), from the least $U$ in (iv), and in units of "
        r"$\sqrt{\epsilon/b}$ in (i) and (iv), of $\epsilon/b$ in (ii) and (iii). In these units "
        r"the terms with $c$, $k$ and with the derivatives of $r$ that are not named have a factor "
        r"$\sqrt{\epsilon}$ or $\epsilon$. Without them",
        *(
            equation(GAP, border.gap, {GAP: _gap(n)}, f"gap-{n + 1}")
            for n, border in enumerate(CORRECTIONS)
        ),
        r"in the order of (i) to (iv): in (i) and (ii) along the continued flight, in (iii) and "
        r"(iv) along the slip. The stick begins where $g = 0$ in (i) and ends where $U = 0$ in (i) "
        r"and (ii); the slip ends where $g = 0$. So the extra piece lasts for $s$ with",
        *(
            equation(END, border.last - border.first, {END: _length(n)}, f"s-{n + 1}")
            for n, border in enumerate(CORRECTIONS)
        ),
        r"These zeros are simple, so by the implicit function theorem the times, in their units, "
        r"and all that follows are analytic. $\delta x$ is the integral of the difference of both "
        r"velocities: of $-g$ in (i) and (ii), of $g$ in (iii) and (iv); and $\delta\dot{x}$ is "
        r"$-g$ at the end.\end{proof}",
        r"The orders are 1 for grazing-sliding, 2 for crossing-sliding and adding-sliding, and 3 "
        r"for switching-sliding; compare the normal forms in \cite{dibernardo2002,dibernardo2008}.",
    )


def _gap(n: int) -> Any:
    """Return the gap g(t) of a border, integrated from the force to leading order."""
    constant = sp.Symbol("C", real=True)
    later = sp.Symbol("u", real=True)
    if n == GRAZING:  # U = -b t, and the maximum of g is epsilon at t = 0
        return SMALL + sp.integrate(-BEND * later, (later, 0, TIME))
    if n == ADDING:  # U = -epsilon + b t^2/2 from the zero of U on
        force = -SMALL + BEND * later**2 / 2
        roots = sp.solve(force.subs(later, constant), constant)
        start = next(root for root in roots if not root.is_positive)
        return sp.integrate(force, (later, start, TIME))
    if n == CROSSING:
        force = SMALL - BEND * later
    else:
        force = -SMALL + BEND * later
    return sp.integrate(force, (later, 0, TIME))


def _length(n: int) -> Any:
    """Return how long the extra piece lasts, from the gap of `_gap`."""
    gap = _gap(n)

    def positive_zero(expr: Any) -> Any:
        return max(sp.solve(expr, TIME), key=lambda root: root.is_positive)

    if n == GRAZING:  # from the zero of g to that of U
        return positive_zero(gap) - sp.solve(gap.diff(TIME), TIME)[0]
    if n == CROSSING:  # from 0 to the zero of U
        return sp.solve(gap.diff(TIME), TIME)[0]
    if n == SWITCHING:  # from 0 to the zero of g
        return positive_zero(gap)
    half = sp.Symbol("q", positive=True)  # the slip begins at -q, and its end is a zero of g
    factors = sp.factor(sp.expand(gap.subs(SMALL, BEND * half**2 / 2)))
    return (positive_zero(factors) + half).subs(half, ROOT)


# --- numbers: the exact flow with 60 digits beside a border ---


class ExampleOscillator(NamedTuple):
    """One domain for m = 1, with numbers of 60 digits."""

    c: Any
    k: Any
    B0: Any
    Omega: Any
    A: Any = CONTEXT.mpf(0)


def flow(o: ExampleOscillator, place: Any, speed: Any, angle: Any, later: Any) -> tuple[Any, Any]:
    """Return position and velocity after a time, in closed form with complex roots."""
    mp = CONTEXT
    wave = o.B0 / mp.mpc(o.k - o.Omega**2, o.c * o.Omega)
    root = mp.sqrt(mp.mpc(o.c**2 / 4 - o.k))
    first_root = -o.c / 2 + root
    second_root = -o.c / 2 - root
    turn = mp.expj(angle)
    # What the forced motion leaves to the two exponentials, at the start and at the end.
    free_x = place - o.A / o.k - mp.re(wave * turn)
    free_v = speed - mp.re(1j * o.Omega * wave * turn)
    first_start = (free_v - second_root * free_x) / (first_root - second_root)
    second_start = free_x - first_start
    forced = wave * mp.expj(angle + o.Omega * later)
    first = first_start * mp.exp(first_root * later)
    second = second_start * mp.exp(second_root * later)
    position = o.A / o.k + mp.re(forced + first + second)
    velocity = mp.re(1j * o.Omega * forced + first_root * first + second_root * second)
    return position, velocity


def pull(o: ExampleOscillator, belt: Any, place: Any, angle: Any) -> Any:
    """Return U: the acceleration at the belt's speed."""
    return o.A + o.B0 * CONTEXT.cos(angle) - o.c * belt - o.k * place


#: The oscillator and the speed of the belt in the comparison.
SETTING = {
    m: Fraction(1),
    k: Fraction(1),
    Omega: Fraction(1),
    c: Fraction(1, 5),
    B0: Fraction(2),
    v_lambda: Fraction(1, 2),
}
HERE = ExampleOscillator(
    c=number(SETTING[c] / SETTING[m]),
    k=number(SETTING[k] / SETTING[m]),
    B0=number(SETTING[B0] / SETTING[m]),
    Omega=number(SETTING[Omega]),
)
BELT = number(SETTING[v_lambda])
#: The sine of the phase at the event, and whether its cosine is negative.
PHASES = (("0", False), ("0", False), ("-1/2", False), ("-1/4", True))
#: The largest sqrt(epsilon), how many are halved from it, and the decimals of the limits.
FIRST = CONTEXT.mpf(10) ** -3
POINTS = 9
DECIMALS = 12


def phase(n: int) -> Any:
    """Return the phase of the event of a border in the comparison."""
    text, negative = PHASES[n]
    sine = CONTEXT.mpf(sp.Rational(text).p) / sp.Rational(text).q
    if negative:
        return CONTEXT.pi - CONTEXT.asin(sine)
    return CONTEXT.asin(sine)


def bend(n: int) -> Any:
    """Return b of a border in the comparison."""
    angle = phase(n)
    push = HERE.k * BELT + HERE.B0 * CONTEXT.sin(angle)
    if n == ADDING:
        return abs(HERE.B0 * CONTEXT.cos(angle))
    return abs(push)


def zero(function: Callable[[Any], Any], near: Any) -> Any:
    """Return the zero of a function near a value, with all digits, by the secant method."""
    # Two starts one percent off on either side; 58 of the digits that CONTEXT has must agree.
    old = near * CONTEXT.mpf("0.99")
    new = near * CONTEXT.mpf("1.01")
    old_value = function(old)
    new_value = function(new)
    for _ in range(60):
        if new_value == old_value or abs(new - old) < CONTEXT.mpf(10) ** -58 * abs(near):
            break
        step_length = new_value * (new - old) / (new_value - old_value)
        old = new
        old_value = new_value
        new = new - step_length
        new_value = function(new)
    return new


@cache
def changes(n: int, small: Any) -> tuple[Any, Any]:
    """Return delta x and delta v of a border by the exact flow, for epsilon = `small`."""
    if n == GRAZING:
        return _changes_by_graze(small)
    if n == CROSSING:
        return _changes_by_crossing(small)
    return _changes_by_slip(n, small)


def _changes_by_graze(small: Any) -> tuple[Any, Any]:
    """Return delta x and delta v of a stick in place of a flight that goes beyond the belt's speed
    by `small`.
    """
    angle = phase(GRAZING)
    curve = bend(GRAZING)
    root = CONTEXT.sqrt(2 * small / curve)
    speed = BELT + small
    top = (HERE.B0 * CONTEXT.cos(angle) - HERE.c * speed) / HERE.k

    def beyond_belt(time: Any) -> Any:
        _, velocity = flow(HERE, top, speed, angle, time)
        return velocity - BELT

    contact = zero(beyond_belt, -root)
    met, _ = flow(HERE, top, speed, angle, contact)
    guess = small * HERE.c / curve
    leaves = zero(lambda time: pull(HERE, BELT, met + BELT * (time - contact), angle + time), guess)
    place, velocity = flow(HERE, top, speed, angle, leaves)
    return met + BELT * (leaves - contact) - place, BELT - velocity


def _changes_by_crossing(small: Any) -> tuple[Any, Any]:
    """Return delta x and delta v of a stick at whose start U is `small`."""
    angle = phase(CROSSING)
    curve = bend(CROSSING)
    # The position at which U is `small`; a stick from there ends when U is 0.
    start = (HERE.B0 * CONTEXT.cos(angle) - HERE.c * BELT - small) / HERE.k
    leaves = zero(lambda time: pull(HERE, BELT, start + BELT * time, angle + time), small / curve)
    place, velocity = flow(HERE, start, BELT, angle, leaves)
    place_of_stick = start + BELT * leaves
    return place_of_stick - place, BELT - velocity


def _changes_by_slip(n: int, small: Any) -> tuple[Any, Any]:
    """Return delta x and delta v of a slip in place of a stick: SWITCHING or ADDING."""
    angle = phase(n)
    curve = bend(n)
    root = CONTEXT.sqrt(2 * small / curve)
    start = (HERE.B0 * CONTEXT.cos(angle) - HERE.c * BELT + small) / HERE.k
    # The slip begins at `first`, where g has a zero of order `power`, and ends near `last`.
    if n == SWITCHING:
        first = CONTEXT.mpf(0)
        last = 2 * small / curve
        power = 1
    else:
        first = zero(lambda time: pull(HERE, BELT, start + BELT * time, angle + time), -root)
        last = 2 * root
        power = 2
    left = start + BELT * first

    def rest(time: Any) -> Any:
        """Return g divided by the power of the time since the slip began."""
        _, velocity = flow(HERE, left, BELT, angle + first, time - first)
        return (velocity - BELT) / (time - first) ** power

    ends = zero(rest, last)
    place, velocity = flow(HERE, left, BELT, angle + first, ends - first)
    return place - (start + BELT * ends), velocity - BELT


def limit(function: Callable[[Any], Any]) -> Any:
    """Return the limit of a function of sqrt(epsilon) at 0."""
    places = [FIRST / 2**j for j in range(POINTS)]
    return neville(places, [function(place) for place in places])


def neville(places: list[Any], values: list[Any]) -> Any:
    """Return the value at 0 of the polynomial through some points, by Neville's scheme."""
    # Neville's scheme: column[j] becomes the value at 0 of the polynomial through the values at
    # places[j] to places[j + width].
    column = [*values]
    for width in range(1, len(places)):
        for j in range(len(places) - width):
            far = places[j]
            near = places[j + width]
            column[j] = (far * column[j + 1] - near * column[j]) / (far - near)
    return column[0]


def order(n: int, coordinate: int) -> Any:
    """Return the order in epsilon of delta x or delta v (`coordinate`) by the exact flow."""

    def exponent(root: Any) -> Any:
        # Half the root is a quarter of epsilon.
        ratio = changes(n, root**2)[coordinate] / changes(n, (root / 2) ** 2)[coordinate]
        return CONTEXT.log(ratio) / CONTEXT.log(4)

    return limit(exponent)


def coefficient(n: int, coordinate: int, power: Any) -> Any:
    """Return the coefficient of the leading power of epsilon by the exact flow."""
    exponent = CONTEXT.mpf(sp.Rational(power).p) / sp.Rational(power).q
    return limit(lambda root: changes(n, root**2)[coordinate] / root ** (2 * exponent))


def _exact_factor(n: int, coordinate: int, power: Any) -> Any:
    """Return the coefficient of the leading power of epsilon from the gap of `_gap`."""
    gap = _gap(n)
    start = CORRECTIONS[n].first
    stop = start + _length(n)
    # A stick takes the gap away, a slip adds it.
    if CORRECTIONS[n].piece == "stick":
        extra = -1
    else:
        extra = 1
    if coordinate == POSITION:
        change = extra * sp.integrate(gap, (TIME, start, stop))
    else:
        change = extra * gap.subs(TIME, stop)
    return sp.simplify(change / SMALL**power)


def _sine_at(sine: Any, n: int) -> dict[Any, Any]:
    """Return the sine of the phase of a border's event, by its letter."""
    return {sine: CONTEXT.sin(phase(n))}


def _numbers_table() -> Table:
    """Return the table of orders and coefficients: by the theorem, and by the exact flow."""
    rows: list[tuple[Any, ...]] = []
    for n, border in enumerate(CORRECTIONS):
        changes_of_border = (
            (r"$\delta x$", border.place, border.place_order),
            (r"$\delta\dot{x}$", border.speed, border.speed_order),
        )
        for coordinate, (change, formula, power) in enumerate(changes_of_border):
            if power is None:
                continue
            factor = sp.simplify(formula / SMALL**power)
            by_formula = sp.lambdify(BEND, factor, {"sqrt": CONTEXT.sqrt})(bend(n))
            by_formula = CONTEXT.mpf(by_formula)
            order_fits = close(partial(CONTEXT.mpf, sp.N(power, 50)), 8)
            fits = close(partial(coefficient, n, coordinate, power), DECIMALS)
            rows.append(
                (
                    border.name,
                    change,
                    rf"${sp.latex(power)}$",
                    decimal("z", order(n, coordinate), 8, order_fits),
                    equation(PLACE, factor, {PLACE: _exact_factor(n, coordinate, power)}),
                    decimal("z", by_formula, DECIMALS, fits),
                )
            )
    setting, numbers = valued({letter: rational(value) for letter, value in SETTING.items()})
    sine = named(r"\sin\theta")
    sines = [sp.Rational(text) for text, _ in PHASES]
    angles = tuple(
        equation(sine, value, at_root(partial(_sine_at, sine, n))) for n, value in enumerate(sines)
    )
    return Table(
        "tab:corrections-numbers",
        r"The discontinuity maps by Theorem~\ref{thm:corrections-maps} and by the exact flow with "
        rf"60 digits, extrapolated to vanishing $\epsilon$: the order to 8 decimals, the "
        rf"coefficient to {DECIMALS}. {setting}; $\sin\theta$ at the event is "
        rf"{', '.join(f'${latex(value)}$' for value in sines)}.",
        ("border", "", "order", "flow", "coefficient", "here, and by the flow"),
        tuple(rows),
        (*numbers, *angles),
        columns="llrrlr",
    )


# --- multipliers ---


def _multipliers() -> Items:
    """Return the items on what becomes of multipliers at the four borders."""
    first, _, third, fourth = (border.place for border in CORRECTIONS)
    graze = named("D_{12}")
    onset = named("D_{11}")
    arrival = named(r"\delta\epsilon")
    later = named(r"\delta t")
    slope = named(r"\frac{\partial\,\delta x}{\partial\epsilon}")
    moved = {arrival: k / m * PLACE - BEND * later, later: -SPEED / BEFORE}
    yield (
        r"\subsection{Multipliers}",
        r"\begin{theorem}[multipliers at the borders]\label{thm:corrections-multipliers} Let $M$ "
        r"be the monodromy matrix of the motion without the extra piece, begun behind the event in "
        r"question, and $D$ the matrix of the discontinuity map, so that $M D$ takes the place of "
        r"$M$. To leading order in $\epsilon > 0$:\begin{enumerate}\item[(i)] grazing-sliding: $D$ "
        r"has the rows $(1, D_{12})$ and $(0, 0)$ with",
        equation(graze, -ROOT, {graze: first.diff(SMALL)}, "graze"),
        r"The multipliers jump from those of $M$ to 0 and $M_{11}$, and from there the second one "
        r"goes away with $\sqrt{\epsilon}$: it is $M_{11} + D_{12} M_{21}$ up to terms of the "
        r"order $\epsilon$.\item[(ii)] crossing-sliding: $D = \operatorname{diag}(1, 0)$, and on "
        r"the other side, where the mass passes, the factor of the passage is "
        r"$\operatorname{diag}(1, |\epsilon|/|F^{-}|)$ (Theorem~\ref{thm:jacobians-saltation}). "
        r"The multipliers are continuous, with a kink: one tends to 0 with $|\epsilon|$ from one "
        r"side, and is 0 on the other.\item[(iii)] switching-sliding: both motions stick, one "
        r"multiplier is 0 on both sides. A small change in front of the contact, where the "
        r"acceleration is $F^{-}$, changes $\epsilon$ and $\delta x$ by",
        equation(arrival, k / m * PLACE + BEND / BEFORE * SPEED, moved, "arrival"),
        equation(slope, -2 * SMALL**2 / BEND**2, {slope: third.diff(SMALL)}, "switch"),
        r"times that. The other multiplier has a continuous derivative by a parameter; its second "
        r"derivative jumps.\item[(iv)] adding-sliding: a stick keeps $\delta x$ alone, and with a "
        r"slip in it",
        equation(
            onset, 1 - 9 * k * SMALL / (m * BEND), {onset: 1 + fourth.diff(SMALL) * k / m}, "add"
        ),
        r"times as much is kept. The multiplier that is not 0 is continuous, with a "
        r"kink.\end{enumerate}",
        r"No multiplier leaves the unit circle, so the motion goes on across every "
        r"border.\end{theorem}",
        r"\begin{proof} These are the derivatives of Theorem~\ref{thm:corrections-maps}. In (i) "
        r"$\epsilon$ is the gap at the maximum, and a change of $x$ moves the maximum of $g$ to "
        r"second order; so $\delta\epsilon = \delta\dot{x}$ and the last row is 0. $M D$ has the "
        r"trace $M_{11} + D_{12}M_{21}$ and the determinant 0. In (iii) $\epsilon = -U$ at the "
        r"contact, which comes later by $-\delta\dot{x}/F^{-}$ "
        r"(Theorem~\ref{thm:exponents-events}), and $U$ has the rate $b$; in (iv) $\epsilon = -U$ "
        r"at a fixed phase, so that $\delta\epsilon = (k/m)\,\delta x$. The last sentence is "
        r"Theorem~\ref{thm:jacobians-monodromy} (i) and Theorem~\ref{thm:borders-atlas} "
        r"(i).\end{proof}",
        _multipliers_table(),
    )


class Grazing(NamedTuple):
    """The multipliers at the graze of Fig. 9's orbit: by the theorem, and extrapolated."""

    entry: Any  # M_11
    limit: Any
    before: tuple[Any, Any]


#: The branch of the paper's Fig. 9 that ends at a graze, and the word behind it.
BRANCH = ("P32", "Omega", ("3", "6"))
BEHIND = "P8274"
DISTANCE = 10.0**-6
SIDES = 4


@cache
def grazing() -> Grazing:
    """Return the multipliers of the paper's Fig. 9 at the end of its branch, on both sides."""
    p = load_scene("fig9").parameters
    _, end = borders.branch(p, *BRANCH).ends
    at_end = p.replace(Omega=end.value)
    word, *_ = BRANCH
    orbit = find_orbit(at_end, word, digits=STEP_DIGITS)
    before = tuple(CONTEXT.re(CONTEXT.mpmathify(value)) for value in orbit.multipliers)
    (down, place), (up, above) = orbit.points
    touch = CONTEXT.mpf(end.conditions[0].t)
    period = CONTEXT.mpf(orbit.period)
    touch += period * CONTEXT.ceil((up - touch) / period)  # the first touch after `up`
    # One period from the touch on, in three flights: duration, domain, the domain that the mass
    # passes into, and x and t there.
    rows = (
        (down + period - touch, 2, 1, place, down),
        (up - down, 1, 2, above, up),
        (touch - up, 2, None, None, None),
    )
    matrix = CONTEXT.eye(2)
    basis = flight_basis(at_end)
    ratio = number(at_end.k / at_end.m)
    for length, source, target, x, time in rows:
        e0, e1, e2 = basis(length)
        step_matrix = CONTEXT.matrix([[1 - ratio * e2, e1], [-ratio * e1, e0]])
        if target is not None:
            angle = number(at_end.Omega) * time
            force_before, force_after = (
                force_at_belt(at_end, alpha, 1, x, angle) for alpha in (source, target)
            )
            saltation = CONTEXT.matrix([[1, 0], [0, force_after / force_before]])
            step_matrix = saltation * step_matrix
        matrix = step_matrix * matrix
    # Beyond the border the multiplier depends on the root of the distance: its limit at 0.
    roots = []
    values = []
    for j in range(SIDES):
        distance = DISTANCE / 4**j
        beyond = find_orbit(p.replace(Omega=end.value + distance), BEHIND, digits=STEP_DIGITS)
        roots.append(CONTEXT.sqrt(distance))
        values.append(CONTEXT.re(CONTEXT.mpmathify(beyond.multipliers[0])))
    return Grazing(matrix[0, 0], neville(roots, values), before)


def _multipliers_table() -> Table:
    """Return the table of the multipliers at the graze of the paper's Fig. 9."""
    multipliers = grazing()
    first, second = multipliers.before
    return Table(
        "tab:corrections-multipliers",
        r"Multipliers at the end of the branch $P_{32}$ of the paper's Fig.~9 at a graze "
        r"(Table~\ref{tab:borders-examples}): those of $P_{32}$; $M_{11}$, from the matrices of "
        r"Chapter~\ref{sec:jacobians}; and that of $P_{8274}$, extrapolated to the border in "
        r"$\sqrt{\epsilon}$ from \texttt{find\_orbit}.",
        (r"$P_{32}$", "", "$M_{11}$", r"$P_{8274}$"),
        (
            (
                decimal("z", first, 6),
                decimal("z", second, 6),
                decimal("z", multipliers.entry, 6),
                decimal("z", multipliers.limit, 6, close(lambda: multipliers.entry, 6)),
            ),
        ),
        columns="rrrr",
    )
