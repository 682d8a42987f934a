"""The oscillator with Coulomb friction against a wall at rest: the closed forms of the literature,
derived.

    m x'' + c x' + k x = P cos(theta) - F sgn(x'),    theta = Omega t

This is the double-belt model with A0 = 0, B0 = P, v1 = 0, mu1 FN = F, mu2 = 0 and a v2 that no
velocity reaches.

Its symmetric motion without stops obeys x(t + pi/Omega) = -x(t). From a highest point x_0 the mass
moves down for half a period, and friction is +F. With x_f = F/k and the angle phi since the highest
point, the motion is

    x = x_f + p_0 cos(phi) + q_0 sin(phi) + a free motion,    p_0^2 + q_0^2 = Q^2,

where Q is the amplitude without friction. Half a period later position and velocity are those of
the start, negated. These two equations give p_0 = x_0 + G x_f and q_0 = H x_f; Q then gives x_0.
All formulas hold in every damping regime: they are in E0, E1, E2 at tau = pi/Omega, and `closed`
puts in a regime's closed forms.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from symosc.base.aliases import Expr
from symosc.symbolic import solution
from symosc.symbolic.solution import (
    E0,
    E1,
    E2,
    Omega,
    a_i,
    c,
    cm,
    f0,
    h,
    k,
    m,
    omega_d,
    tau,
    v_i,
    w0sq,
    x_i,
)

#: The amplitude of the drive, the friction force, and F/k.
P, F, x_f = sp.symbols("P F x_f", positive=True)
#: The highest point, and the steady part of the motion there: p_0 cos(phi) + q_0 sin(phi).
x_0, p_0, q_0 = sp.symbols("x_0 p_0 q_0", real=True)
G, H = sp.symbols("G H", real=True)
Q = sp.Symbol("Q", positive=True)
#: The amplitude without friction, Q, in the parameters.
FRICTIONLESS = sp.sqrt(P**2 / ((k - m * Omega**2) ** 2 + (c * Omega) ** 2))
#: The angle since the highest point, Omega/omega_0, and the middle of the turning points.
phi = sp.Symbol("varphi", positive=True)
r = sp.Symbol("r", positive=True)
d = sp.Symbol("d", real=True)
#: Den Hartog's letters for c = 0.
V, U, S = sp.symbols("V U S", real=True)
HALF = sp.pi / Omega
#: The free motion (x, v) at the highest point: (x_0, 0) without x_f and without the steady part.
FREE_START = sp.ImmutableMatrix([x_0 - p_0 - x_f, -Omega * q_0])


# --- the symmetric motion without stops ---


@cache
def transition() -> Expr:
    """Return the matrix, in the basis E0, E1, E2, that takes (x, v) of an unforced motion to (x, v)
    at tau later.
    """
    flow = solution.flow()
    start = {a_i: solution.acceleration(x_i, v_i, solution.theta_i)}
    states = [solution.use_relations(expr.xreplace(start)) for expr in (flow.x, flow.v)]
    matrix = sp.Matrix(2, 2, lambda i, j: states[i].diff((x_i, v_i)[j]))
    return matrix.subs(1 - w0sq * E2 - cm * E1, E0)  # the relation of E0, E1 and E2


def symmetry() -> Expr:
    """Return the column (x + x_0, v) half a period T/2 after the highest point x_0.

    It is 0 as x(t + T/2) = -x(t).
    """
    return transition() * FREE_START + sp.Matrix([x_f - p_0 + x_0, -Omega * q_0])


@cache
def half_period() -> tuple[Expr, Expr]:
    """Solve `symmetry` for G and H: the drive's response p_0 cos + q_0 sin has p_0 = x_0 + G F/k
    and q_0 = H F/k.
    """
    found = sp.solve(list(symmetry()), [p_0, q_0], dict=True)[0]
    return sp.simplify((found[p_0] - x_0) / x_f), sp.simplify(found[q_0] / x_f)


@cache
def amplitude() -> Expr:
    """Return the highest point x_0 by the amplitude Q without friction: the larger root of p_0^2 +
    q_0^2 = Q^2.
    """
    roots = sp.solve((x_0 + G * x_f) ** 2 + (H * x_f) ** 2 - Q**2, x_0)
    return max(roots, key=lambda root: root.subs({G: 0, H: 0, Q: 1}))


# --- its stability, and where it ends ---


def turning_acceleration(after: bool) -> Expr:
    """Return the acceleration just after (or before) the highest point x_0, at which friction
    changes its sign.
    """
    return -(Omega**2) * p_0 + cm * Omega * q_0 - w0sq * (x_0 - p_0 - (x_f if after else -x_f))


@cache
def ratio() -> Expr:
    """Return the ratio rho of the accelerations just after and before the highest point, for the
    steady motion.
    """
    after, before = (_steady(turning_acceleration(side)) for side in (True, False))
    return after / before


def half_period_matrix(rho: Expr) -> Expr:
    """Return the matrix that carries a perturbation (x, v) over half a period.

    The turn at the end scales v by rho.
    """
    return sp.diag(1, rho) * transition()


def velocity() -> Expr:
    """Return x'/Omega at the angle phi after the highest point, by the basis functions E0 and E1 at
    tau = phi/Omega.
    """
    return _steady((transition() * FREE_START)[1] / Omega - p_0 * sp.sin(phi) + q_0 * sp.cos(phi))


@cache
def slide_function() -> Expr:
    """Return B(phi): at the angle phi after its highest point the mass moves down iff p_0 > B(phi)
    F/k.

    p_0 is the cosine part of the response to the drive.
    """
    return sp.simplify(sp.solve(velocity().subs(x_0, p_0 - G * x_f), p_0)[0] / x_f)


@cache
def slide_limit() -> Expr:
    """Return the limit of `slide_function` for phi -> 0.

    The mass starts to move down if p_0 exceeds F/k times it.
    """

    def after(
        expr: Expr,
    ) -> Expr:  # differentiated by phi at phi = 0: E0 and E1 are functions of tau = phi/Omega
        rate = (
            expr.diff(phi)
            + sum(expr.diff(name) * rate for name, rate in solution.rates().items()) / Omega
        )
        return sp.simplify(rate.subs(solution.start_values()).subs(phi, 0))

    above, below = sp.fraction(sp.together(slide_function()))
    return after(above) / after(below)


def largest_force_ratio(largest: Expr) -> Expr:
    """Return the largest ratio of friction to drive without stops.

    `largest` is the maximum of `slide_function`.
    """
    return k * Q / P / sp.sqrt(largest**2 + H**2)


def _steady(expr: Expr) -> Expr:
    """Put p_0 = x_0 + G x_f and q_0 = H x_f (steady part of the motion, x_f = F/k) into an
    expression; expand it.
    """
    return sp.expand(expr.subs({p_0: x_0 + G * x_f, q_0: H * x_f}))


# --- other motions for c = 0 ---


@cache
def resonance_growth() -> Expr:
    """Return by how much the highest point x_0 rises in a period at resonance: c = 0 and Omega^2 =
    k/m.
    """
    # The highest point x_0 is at theta = pi/2, so that the drive pushes along with the velocity.
    regime = solution.REGIMES["resonance"]
    at = {
        x_i: x_0,
        v_i: 0,
        solution.theta_i: sp.pi / 2,
        a_i: solution.acceleration(x_0, sp.Integer(0), sp.pi / 2),
    }
    lowest = solution.flow(regime).x.xreplace(at).xreplace(regime.parameters()).subs(tau, HALF)
    lowest = lowest.subs({solution.A_m: Omega**2 * F / k, f0: Omega**2 * P / k})  # k = m Omega^2
    return sp.simplify(2 * (-lowest - x_0))


@cache
def free_decay() -> Expr:
    """Return by how much nearer to 0 each turning point of a free motion without damping is than
    the one before.
    """
    lowest = solution.flow(solution.REGIMES["undamped"]).x.subs(
        {v_i: 0, f0: 0, a_i: w0sq * (x_f - x_0), x_i: x_0}
    )
    lowest = lowest.subs({w0sq: solution.omega_0**2, tau: sp.pi / solution.omega_0})
    return sp.simplify(x_0 + lowest)


# --- closed forms ---


def closed(expr: Expr, regime: solution.Regime, time: Expr = HALF) -> Expr:
    """Replace the basis functions E0, E1, E2 in an expression by their closed forms in a damping
    regime at `time`.
    """
    basis = {
        name: form.subs(tau, time)
        for name, form in regime.basis().items()
        if name in solution.BASIS[:3]
    }
    return expr.subs(basis).subs(regime.parameters())


def den_hartog_damped() -> tuple[Expr, Expr]:
    """Return Den Hartog's formulas for G and H of `half_period` if 0 < c^2 < 4 k m.

    Omega_d^2 = k/m - h^2, h = c/2m.
    """
    decay = h * HALF
    turn = omega_d * HALF
    slow = sp.sinh(decay) - h / omega_d * sp.sin(turn)
    below = sp.cosh(decay) + sp.cos(turn)
    return slow / below, (h**2 + omega_d**2) / (Omega * omega_d) * sp.sin(turn) / below


def den_hartog_undamped() -> dict[Expr, Expr]:
    """Return Den Hartog's formulas for c = 0 as a dict with his letters V, U and S as keys."""
    return {
        V: 1 / (1 - r**2),
        U: sp.sin(sp.pi / r) / (r * (1 + sp.cos(sp.pi / r))),  # tan(pi/(2 r))/r
        S: r * sp.sin(phi / r) / sp.sin(phi)
        + r**2 * U * (sp.cos(phi) - sp.cos(phi / r)) / sp.sin(phi),
    }
