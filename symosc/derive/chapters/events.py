"""L g has a known sign, and why no event can be missed: the bounds behind symosc.engine.first_exit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from symosc.derive.latex import named
from symosc.derive.scope import Scope, v_lambda
from symosc.derive.steps import Exact, Heading, Prose, Relation, Sign, Step, equation
from symosc.symbolic.solution import B0, A, Omega, c, cm, h, k, m, omega_d, t, tau, w0sq

TITLE = "Why no event is missed"


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _gap()
    yield from _factorised()
    yield from _bound()


def _gap() -> Iterator[Any]:
    yield Heading("An equation for the gap")
    path = sp.Function("x")(t)
    gap = named(r"m \ddot{g} + c \dot{g} + k g")
    newton = (A + B0 * sp.cos(Omega * t) - c * path.diff(t) - k * path) / m
    g = path.diff(t) - v_lambda
    acceleration = newton
    jerk = acceleration.diff(t).subs(path.diff(t, 2), newton)
    meaning = {gap: m * jerk + c * newton + k * g}
    yield equation(
        gap,
        -(B0 * Omega * sp.sin(Omega * t) + k * v_lambda),
        r"Let $g = \dot{x} - v_\lambda$ be the gap between the velocity and a belt's speed. Eq.~(5), "
        r"differentiated, has "
        r"neither $A_\alpha$ nor friction left, and gives in \emph{every} domain",
        Exact(meaning, sp.expand),
    )
    yield Prose(
        r"The right side is the sign function of Theorem~7: it changes sign only at $\Theta^{\mathrm{cr}}$ and "
        r"$\pi - \Theta^{\mathrm{cr}}$, in closed form. On a belt $m\dot{F}^{(\alpha)}$ is the same expression."
    )


def _factorised() -> Iterator[Any]:
    yield Heading("At most two zeros on a piece")
    phi = sp.exp(-h * tau) * sp.sin(omega_d * tau)
    yield Prose(
        r"Let $L = d^2/d\tau^2 + 2h\, d/d\tau + h^2 + \omega_d^2$ and $\varphi = e^{-h\tau} \sin\omega_d\tau$, "
        r"which is "
        r"positive for $0 < \tau < \pi/\omega_d$."
    )
    left = named(r"L\varphi")
    zero = sp.Integer(0)
    solves = {left: _polya(phi)}
    yield equation(left, zero, r"It solves the unforced equation,", Exact(solves, sp.simplify))
    outer = phi**2 * sp.exp(2 * h * tau)
    name = named(r"L g")
    q = sp.Function("q")(tau)
    meaning = {name: _polya(phi * q)}
    factored = (outer * q.diff(tau)).diff(tau) / (phi * sp.exp(2 * h * tau))
    slope, curve = named(r"\dot{q}"), named(r"\ddot{q}")
    rates = {slope: q.diff(tau), curve: q.diff(tau, 2)}
    shown = sp.simplify(factored.doit().xreplace({q.diff(tau, 2): curve, q.diff(tau): slope}))
    yield equation(
        name,
        sp.expand(shown),
        r"With $q = g/\varphi$ the operator factorises (P\'olya): $L g = \dfrac{e^{-2h\tau}}{\varphi} "
        r"\dfrac{d}{d\tau}\bigl(\varphi^2 e^{2h\tau} \dot{q}\bigr)$, that is",
        Exact(meaning | rates, sp.simplify),
    )
    yield Prose(
        r"Where $L g$ keeps its sign, $\varphi^2 e^{2h\tau}\dot{q}$ is monotone, so $\dot{q}$ has at most one "
        r"zero and $q$, "
        r"with it $g$, at most two: opposite signs at the ends of such a piece mean exactly one zero; equal signs mean "
        r"none or two, as the one extremum of $q$ tells. Without oscillation, $c^2 \ge 4km$, a $\varphi > 0$ "
        r"exists for all "
        r"$\tau$, and pieces of any length will do."
    )


def _polya(g: Any) -> Any:
    return g.diff(tau, 2) + 2 * h * g.diff(tau) + (h**2 + omega_d**2) * g


def _bound() -> Iterator[Any]:
    yield Heading("A bound for all later times")
    yield Prose(
        r"The event search (\texttt{symosc.engine}) uses this in a form that needs no pieces. Split the "
        r"velocity into its steady part and its transient, which obeys the unforced equation, as all of its "
        r"derivatives do. Let $w$ and $j$ be the third and fourth derivative of the transient."
    )
    w, j = named("w"), named("j")
    energy = named(r"\frac{d}{d\tau}(j^2 + \tfrac{k}{m} w^2)")
    z = sp.Function("z")(tau)
    total = z.diff(tau) ** 2 + w0sq * z**2
    rate = total.diff(tau).subs(z.diff(tau, 2), -cm * z.diff(tau) - w0sq * z)
    rate = rate.subs(z.diff(tau), j).subs(z, w)
    yield equation(energy, -2 * cm * j**2, "Its energy never grows:", Exact({energy: rate}, sp.expand))
    yield Step(Relation(energy, "<=", sp.Integer(0)), "", Sign({energy: rate}))
    steady = named("V_0^2")
    response = sp.I * Omega * B0 / m / (w0sq - Omega**2 + sp.I * Omega * cm)
    square = sp.simplify(response * sp.conjugate(response))
    yield equation(
        steady,
        (B0 * Omega / m) ** 2 / ((w0sq - Omega**2) ** 2 + cm**2 * Omega**2),
        r"The steady velocity has the amplitude $V_0$, its fourth derivative $V_0\Omega^4$:",
        Exact({steady: square}, sp.simplify),
    )
    yield Prose(
        r"So $|g^{(4)}| \le M_4 = V_0\Omega^4 + \sqrt{j^2 + (k/m) w^2}$ at all later times, with $w$ and $j$ "
        r"taken now, and by "
        r"Taylor's theorem $g(\tau + s) \ge P(s)$ with the polynomial"
    )
    s, bound = sp.Symbol("s", positive=True), sp.Symbol("M_4", nonnegative=True)
    values = [named(name) for name in ("g", r"\dot{g}", r"\ddot{g}", r"g^{(3)}")]
    taylor = sp.Add(*(value * s**n / sp.factorial(n) for n, value in enumerate(values)))
    u, left = sp.Symbol("u", positive=True), named("P(s)")
    remainder = sp.integrate((s - u) ** 3 / 6 * bound, (u, 0, s))
    yield equation(
        left,
        taylor - bound * s**4 / 24,
        r"The remainder $\int_0^s (s-u)^3 g^{(4)}(\tau+u)\,du/6$ is at most $M_4 s^4/24$ in size:",
        Exact({left: taylor - remainder}, sp.expand),
    )
    yield Prose(
        r"and $g$ has no zero before the first zero of $P$. A step never goes further than that, so no crossing, "
        r"however "
        r"short, can be stepped over. At a start on the boundary, where $g = 0$, the known zero is divided out of $P$. "
        r"This is a proof in real arithmetic. With rounded numbers each value of $g$ is known to a few units of its "
        r"last digits only, and decisions leave margins for that, which are named in "
        r"\texttt{symosc.engine}; that they are wide enough in double precision was measured, not proven."
    )
