"""The motion in one domain, derived by sympy for all domains and all damping regimes at once.

    m x'' + c x' + k x = A + B0 cos(Omega t),    x(t_i) = x_i,  x'(t_i) = v_i,    A = A_alpha in domain alpha (eq. (5))

Divided by m, with tau = t - t_i, cm = c/m, w0sq = k/m, f0 = B0/m and the phase theta_i = Omega t_i,
the motion is a combination of five functions of tau with S the impulse response: S'' + cm S' + w0sq
S = 0, S(0) = 0, S'(0) = 1:

    E0 = S',   E1 = S,   E2 = int_0^tau S(u) du,   R2 + i I2 = int_0^tau S(u) exp(i Omega (tau - u)) du

A damping regime is one row of `REGIMES`: the roots of the characteristic equation. Its closed forms
follow from them as divided differences of z -> exp(z tau), equal roots included: no regime is a
special case of the derivation. The chapter `domains` of `symosc.derive` proves that all of this
solves eq. (5).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple

import sympy as sp

from symosc.base.aliases import Expr

# The paper's letters. A stands for A_alpha, theta for Omega t mod 2 pi, and (x, v, t) for a point
# of the flow.
m, Omega = sp.symbols("m Omega", positive=True)
c, k, mu1, mu2, FN = sp.symbols("c k mu_1 mu_2 F_N", nonnegative=True)
A, A0, B0, t, x, v, theta = sp.symbols("A A_0 B_0 t x v theta", real=True)
t_i, x_i, v_i, tau = sp.symbols("t_i x_i v_i tau", real=True)

# Divided by m; a_i is the acceleration at the start.
cm, w0sq = sp.symbols("cm w0sq", nonnegative=True)
A_m, f0, a_i, theta_i = sp.symbols("A_m f0 a_i theta_i", real=True)

# The basis functions, and the letters of the regimes: decay rate h = c/2m and frequencies (eta: of
# sinh and cosh).
BASIS = E0, E1, E2, R2, I2 = sp.symbols("E0 E1 E2 R2 I2", real=True)
h, omega_d, eta, omega_0 = sp.symbols("h omega_d eta omega_0", positive=True)

#: The paper's letters for what is divided by m.
PAPER_LETTERS = {cm: c / m, w0sq: k / m, f0: B0 / m, A_m: A / m}


class Flow(NamedTuple):
    """The motion in a domain: displacement x, velocity v and acceleration a at the time tau after
    the start.
    """

    x: Expr
    v: Expr
    a: Expr


def in_paper_letters(expr: Expr) -> Expr:
    """Rewrite an expression in the paper's m, c, k, A, B0, Omega, t, x_i, v_i, t_i."""
    expr = expr.xreplace({a_i: acceleration(x_i, v_i, theta_i)})
    return expr.xreplace(PAPER_LETTERS | {theta_i: Omega * t_i, theta: Omega * t})


# --- forces and G-functions ---


def force_constant(alpha: int) -> Expr:
    """Return A_alpha in domain alpha (1, 2 or 3): A0 plus the friction of both belts, positive from
    a faster belt.
    """
    return A0 + {1: mu1 + mu2, 2: mu2 - mu1, 3: -mu1 - mu2}[alpha] * FN


def acceleration(x: Expr = x, v: Expr = v, theta: Expr = theta) -> Expr:
    """Return F^(alpha) of eq. (9), the acceleration A_alpha/m + (B0/m) cos theta - (k/m) x - (c/m)
    v in a domain.
    """
    return A_m + f0 * sp.cos(theta) - w0sq * x - cm * v


@cache
def g_function(order: int) -> Expr:
    """Return the G-function G^(order) of eqs. (18), (19): the derivative of F^(alpha) along the
    flow, `order` times.
    """
    if order == 0:
        return acceleration()
    G = g_function(order - 1)
    return sp.expand(v * G.diff(x) + acceleration() * G.diff(v) + Omega * G.diff(theta))


def next_derivative(y1: Expr, y0: Expr, forcing_n: Expr) -> Expr:
    """Return the rate of change of y1 = dy0/dt, for v or a G-function y0: -(c/m) y1 - (k/m) y0 -
    forcing_n.
    """
    return -cm * y1 - w0sq * y0 - forcing_n


def forcing(n: int) -> Expr:
    """Return minus the n-th time derivative of the drive (B0/m) cos(Omega t), for
    `next_derivative`.
    """
    return -f0 * Omega**n * sp.cos(theta).diff(theta, n)


def stick_acceleration(start: Expr, cosines: Expr) -> Expr:
    """Return F^(alpha) at tau after a stick began with F^(alpha) = `start`.

    `cosines` is the change of cos(Omega t).
    """
    # `cosines` stands for cos(theta_i + Omega tau) - cos(theta_i), which a caller can compute
    # without cancellation.
    at_start = acceleration(x_i, v, theta_i)
    at_end = acceleration(x_i + v * tau, v, theta_i + Omega * tau)
    wave = sp.cos(theta_i + Omega * tau) - sp.cos(theta_i)
    return start + sp.collect(sp.expand(at_end - at_start), f0).subs(wave, cosines)


# --- what holds for the basis functions in every regime ---


@cache
def rates() -> dict[Expr, Expr]:
    """Return the derivatives of the basis functions E0, E1, E2, R2, I2 by tau, written in these
    functions.
    """
    S = sp.Function("S")
    u = sp.Symbol("u", real=True)
    integrals = [S(u) * wave for wave in (1, sp.cos(Omega * (tau - u)), sp.sin(Omega * (tau - u)))]
    meanings = [
        S(tau).diff(tau),
        S(tau),
        *(sp.Integral(integral, (u, 0, tau)) for integral in integrals),
    ]
    names_of = dict(zip(meanings, BASIS, strict=True))
    ode = {S(tau).diff(tau, 2): -cm * S(tau).diff(tau) - w0sq * S(tau)}
    # factor_terms takes Omega out of the integrals
    return {
        name: sp.factor_terms(meaning.diff(tau)).xreplace(ode).xreplace(names_of)
        for meaning, name in names_of.items()
    }


def start_values() -> dict[Expr, Expr]:
    """Return the values of the basis functions at tau = 0: 1 for E0, and 0 for E1, E2, R2 and I2."""
    return {symbol: sp.Integer(symbol == E0) for symbol in BASIS}


def time_derivative(expr: Expr) -> Expr:
    """Differentiate an expression in tau and the basis functions with respect to tau."""
    return expr.diff(tau) + sp.Add(*(expr.diff(symbol) * rate for symbol, rate in rates().items()))


@cache
def relations() -> tuple[Expr, Expr, Expr]:
    """Return three expressions that are 0: E2, R2 and I2 are the responses to 1, cos(Omega tau),
    sin(Omega tau).
    """

    def relation(response: Expr, force: Expr) -> Expr:
        first = time_derivative(response)
        return sp.expand(time_derivative(first) + cm * first + w0sq * response - force)

    return relation(E2, 1), relation(R2, sp.cos(Omega * tau)), relation(I2, sp.sin(Omega * tau))


def use_relations(expr: Expr) -> Expr:
    """Remove E0, cos(Omega tau) and sin(Omega tau) from an expression by `relations`, and expand
    it.
    """
    expr = sp.expand(expr, trig=True)
    for unwanted, value in _solved_relations():
        expr = sp.expand(expr.xreplace({unwanted: value}))
    return expr


@cache
def _solved_relations() -> tuple[tuple[Expr, Expr], ...]:
    """Return the terms that `use_relations` removes, in order, each with what it is equal to."""
    step_response, cosine_response, sine_response = relations()
    return tuple(
        (unwanted, sp.solve(relation, unwanted)[0])
        for relation, unwanted in (
            (cosine_response, sp.cos(Omega * tau)),
            (sine_response, sp.sin(Omega * tau)),
            (step_response, E0),
        )
    )


# --- the flow ---


@cache
def flow(regime: Regime | None = None) -> Flow:
    """Return the motion at tau after (t_i, x_i, v_i), in the basis functions or, for a regime, in
    closed form.
    """
    # Variation of constants gives x up to two constants, the start fixes them. A is then eliminated
    # in favour of the acceleration a_i at the start: friction enters only there, and nothing
    # cancels when tau -> 0. Each result is sorted by cause (x_i, v_i, a_i, f0); x and v are the
    # start value and what has been added to it since.
    if regime is not None:
        return Flow(
            *(expr.xreplace(regime.basis()).xreplace(regime.parameters()) for expr in flow())
        )
    alpha, beta = sp.symbols("alpha beta")
    shape = alpha * E0 + beta * E1 + A_m * E2 + f0 * (sp.cos(theta_i) * R2 - sp.sin(theta_i) * I2)
    at_start = [
        expr.xreplace(start_values()) for expr in (shape - x_i, time_derivative(shape) - v_i)
    ]
    constants = sp.solve(at_start, [alpha, beta], dict=True)[0]
    position = use_relations(shape.xreplace(constants).xreplace({A_m: _force_at_start()}))
    velocity = use_relations(time_derivative(position))
    rate_of_velocity = time_derivative(velocity)
    return Flow(
        x_i + collected(position - x_i),
        v_i + collected(velocity - v_i),
        collected(rate_of_velocity),
    )


def _force_at_start() -> Expr:
    """Return A_m = A_alpha/m in terms of the acceleration a_i at the start."""
    return sp.solve(acceleration(x_i, v_i, theta_i) - a_i, A_m)[0]


def collected(expr: Expr) -> Expr:
    """Return an expression that is linear in x_i, v_i, a_i and f0 = B0/m as a sum with one term for
    each of them.
    """
    expr = sp.expand(expr)
    waves = [sp.cos(theta_i), sp.sin(theta_i)]
    causes = (x_i, v_i, a_i, f0)
    parts = (q * sp.factor_terms(sp.collect(expr.coeff(q), waves)) for q in causes)
    return sp.Add(*parts) + sp.collect(expr.xreplace(dict.fromkeys(causes, sp.S.Zero)), waves)


# --- the regimes ---


@dataclass(frozen=True)
class Regime:
    """One damping regime: its condition, and the characteristic roots from which the closed forms
    follow.
    """

    name: str
    condition: Expr  # a Boolean in m, c, k, Omega
    centre: (
        Expr  # centre +- offset solve lambda^2 + cm lambda + w0sq = 0, in the regime's own letters
    )
    offset: Expr
    letters: dict[Expr, Expr] = field(hash=False)  # what these letters are in m, c, k

    def parameters(self) -> dict[Expr, Expr]:
        """Return c/m = -(l1 + l2) and k/m = l1 l2 for the regime's roots l1 and l2, in its own
        letters.
        """
        return {cm: -2 * self.centre, w0sq: self.centre**2 - self.offset**2}

    @cache  # noqa: B019 (the table of regimes lives as long as the program)
    def basis(self) -> dict[Expr, Expr]:
        """Return the closed forms in tau of the basis functions E0, E1, E2, R2, I2, with these
        symbols as keys.
        """
        roots = self.centre + self.offset, self.centre - self.offset
        S = collect_modes(divided_difference(*roots))
        # Omega -> -Omega conjugates the response to exp(i Omega tau), since the operator is real.
        Z, conjugate = (divided_difference(z, *roots) for z in (sp.I * Omega, -sp.I * Omega))
        integral = divided_difference(sp.Integer(0), *roots)
        closed = S.diff(tau), S, integral, (Z + conjugate) / 2, (Z - conjugate) / (2 * sp.I)
        return {symbol: collect_modes(expr) for symbol, expr in zip(BASIS, closed, strict=True)}


def divided_difference(*nodes: Expr) -> Expr:
    """Return the divided difference of the function exp(z tau) of z over nodes, some of which may
    be equal.
    """
    # Over the roots it is S; a further node z gives int_0^tau S(u) exp(z (tau - u)) du.

    def difference(z: list[Expr]) -> Expr:
        if z[0] == z[-1]:
            return tau ** (len(z) - 1) * _exponential(z[0]) / sp.factorial(len(z) - 1)
        return (difference(z[1:]) - difference(z[:-1])) / (z[-1] - z[0])

    return difference(sorted(nodes, key=sp.default_sort_key))  # puts equal nodes side by side


def _exponential(z: Expr) -> Expr:
    """Return exp(z tau), with cos and sin for the imaginary part of z, cosh and sinh for the
    overdamped rate eta.
    """

    def factor(part: Expr) -> Expr:
        if part.has(sp.I):
            return sp.cos(part / sp.I * tau) + sp.I * sp.sin(part / sp.I * tau)
        if part.has(eta):
            return sp.cosh(part * tau) + sp.sinh(part * tau)
        return sp.exp(part * tau)

    return sp.Mul(*map(factor, sp.Add.make_args(z)))


def collect_modes(expr: Expr) -> Expr:
    """Write an expression as a sum of modes (products of tau, exp, sin, cos, sinh, cosh) with
    factored coefficients.
    """
    # Different modes are linearly independent functions, so what is 0 for all tau comes out as 0.
    modes = sorted(expr.atoms(sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh), key=sp.default_sort_key)
    stand_ins = [sp.Dummy() for _ in modes]
    poly = sp.Poly(expr.xreplace(dict(zip(modes, stand_ins, strict=True))), *stand_ins, tau)
    powers = [
        sp.Mul(*(f**n for f, n in zip([*modes, tau], exponents, strict=True)))
        for exponents in poly.monoms()
    ]
    return sp.Add(*(sp.factor(q) * mode for q, mode in zip(poly.coeffs(), powers, strict=True)))


_h = c / (2 * m)
_w = sp.sqrt(k / m)
_i = sp.I
_table = (
    Regime(
        "underdamped",
        (c > 0) & (c**2 < 4 * k * m),
        -h,
        _i * omega_d,
        {h: _h, omega_d: sp.sqrt(_w**2 - _h**2)},
    ),
    Regime("critical", (c > 0) & (k > 0) & sp.Eq(c**2, 4 * k * m), -h, sp.Integer(0), {h: _h}),
    Regime(
        "overdamped", (k > 0) & (c**2 > 4 * k * m), -h, eta, {h: _h, eta: sp.sqrt(_h**2 - _w**2)}
    ),
    Regime(
        "undamped",
        sp.Eq(c, 0) & (k > 0) & sp.Ne(k, m * Omega**2),
        sp.Integer(0),
        _i * omega_0,
        {omega_0: _w},
    ),
    Regime("resonance", sp.Eq(c, 0) & sp.Eq(k, m * Omega**2), sp.Integer(0), _i * Omega, {}),
    Regime("no spring", (c > 0) & sp.Eq(k, 0), -h, h, {h: _h}),
    Regime("free", sp.Eq(c, 0) & sp.Eq(k, 0), sp.Integer(0), sp.Integer(0), {}),
)
REGIMES = {regime.name: regime for regime in _table}


def possible_regimes(numbers: dict[Expr, Expr]) -> tuple[Regime, ...]:
    """Return the damping regimes that are possible if some of m, c, k and Omega have the values in
    `numbers`.
    """
    holds = {regime: regime.condition.xreplace(numbers) for regime in REGIMES.values()}
    certain = tuple(regime for regime, condition in holds.items() if condition == sp.true)
    return certain or tuple(regime for regime, condition in holds.items() if condition != sp.false)


class Join(NamedTuple):
    """A limit of damping regimes: with `path` inserted, `source`'s basis tends to `target`'s basis
    as `letter` -> 0.
    """

    source: str
    target: str
    letter: Expr
    path: dict[Expr, Expr]


_small = sp.Symbol("epsilon", positive=True)
JOINS = (
    Join("underdamped", "critical", omega_d, {}),
    Join("overdamped", "critical", eta, {}),
    Join("underdamped", "undamped", h, {omega_d: sp.sqrt(omega_0**2 - h**2)}),
    Join("underdamped", "resonance", h, {omega_d: sp.sqrt(Omega**2 - h**2)}),
    Join("undamped", "resonance", _small, {omega_0: Omega + _small}),
    Join("undamped", "resonance", _small, {omega_0: Omega - _small}),
    Join("overdamped", "no spring", _small, {eta: h - _small}),
    Join("underdamped", "free", _small, {h: _small * h, omega_d: _small * omega_d}),
    Join("overdamped", "free", _small, {h: _small * h, eta: _small * eta}),
    Join("critical", "free", h, {}),
    Join("undamped", "free", omega_0, {}),
    Join("no spring", "free", h, {}),
)
