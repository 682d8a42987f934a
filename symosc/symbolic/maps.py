"""The mappings P1 to P8: residuals f1, f2 (eq. (54)) and their derivatives, derived by sympy.

A flight from (x_i, v_i, theta_i) to (x_j, v_j, theta_j) takes tau = (theta_j - theta_i)/Omega and
has

    f1 = x(tau) - x_j,    f2 = v(tau) - v_j

All flights are one formula: the maps differ in A_alpha and in the belts v_i and v_j. A stick has
the two equations f1 = x_i + v tau - x_j and f2 = F^(alpha)(x_j, v, theta_j), alpha being the domain
that it slips into (eqs. (52), (53), and the exits that they lack).

Derivatives with respect to the unknowns follow from two facts. Perturbations obey the unforced
equation; and moving the start along its own flow changes nothing at the end. Derivatives with
respect to a parameter q follow from the equation of motion differentiated: D (dx/dq) = forcing, at
rest at the start, so that dx/dq is the forcing convolved with S. With D = d^2/dtau^2 + cm d/dtau +
w0sq and * for the convolution from 0 to tau, seven more entire functions do it:

    U1 = S*S,   U0 = U1',   U2 = int U1,   V + i W = S * (R2 + i I2),   P + i Q = S * (tau exp(i Omega tau))
"""

from __future__ import annotations

from functools import cache
from itertools import product

import sympy as sp

from symosc.symbolic import solution
from symosc.symbolic.solution import (
    E0,
    E1,
    E2,
    I2,
    R2,
    Expr,
    Omega,
    a_i,
    cm,
    f0,
    h,
    m,
    tau,
    theta_i,
    v_i,
    w0sq,
    x_i,
)

p, q = sp.symbols("p q", real=True)
#: The functions that parameter derivatives need in addition to the basis functions.
REPEATED = U0, U1, U2, V, W, P, Q = sp.symbols("U0 U1 U2 V W P Q", real=True)

x_j, v_j, theta_j, v_end, a_end, F = sp.symbols("x_j v_j theta_j v_end a_end F", real=True)

#: Their derivatives with respect to tau.
REPEATED_RATES = {U0: E1 - cm * U0 - w0sq * U1, U1: U0, U2: U1}
REPEATED_RATES |= {V: U1 - Omega * W, W: Omega * V, P: R2 - Omega * Q, Q: I2 + Omega * P}
#: S * f for each f that the motion consists of; 1 stands for the constant.
CONVOLVED = {sp.Integer(1): E2, E0: U0, E1: U1, E2: U2, R2: V, I2: W}


def rate(expr: Expr) -> Expr:
    """Differentiate by tau an expression in tau, the basis E0, E1, E2, R2, I2 and the convolutions
    U0 to Q.
    """
    chain = (expr.diff(symbol) * value for symbol, value in REPEATED_RATES.items())
    return solution.time_derivative(expr) + sp.Add(*chain)


def convolve(expr: Expr) -> Expr:
    """Return the convolution of the impulse response with `expr`, a linear combination of 1 and the
    basis functions.
    """
    expr = sp.expand(expr)
    parts = {symbol: expr.coeff(symbol) for symbol in solution.BASIS}
    constant = expr - sp.Add(*(sp.expand(factor * symbol) for symbol, factor in parts.items()))
    return sp.expand(constant * CONVOLVED[sp.Integer(1)]) + sp.Add(
        *(q * CONVOLVED[f] for f, q in parts.items())
    )


def repeated_apart() -> dict[str, Expr]:
    """Return formulas, by name, of U0 to Q in parameter derivatives, far from critical damping and
    resonance.
    """
    # U1 = S*S is explicit; the others solve D f = g, which by their known rates has no derivatives
    # left. With p + i q = w0sq - Omega^2 + i cm Omega, the last two pairs are (u + i z)/(p + i q).
    first = (E1 - tau * (E0 + h * E1)) / (2 * solution.omega_d**2)
    formulas = {"U1": first, "U0": sp.factor(solution.time_derivative(first).subs(cm, 2 * h))}
    formulas |= {"U2": sp.solve(_operator(U2) - E2, U2)[0], "D": p**2 + q**2}
    swing = tuple(tau * wave(Omega * tau) for wave in (sp.cos, sp.sin))
    # Real and imaginary part, what the operator makes of them, and the names of u and z.
    pairs = (((V, W), (R2, I2), ("u", "z")), ((P, Q), swing, ("y", "n")))
    for (f, g), forcing, names in pairs:
        # The known terms, without f and g, to the side of the forcing.
        sources = [
            force - _operator(unknown).subs({f: 0, g: 0})
            for unknown, force in zip((f, g), forcing, strict=True)
        ]
        formulas |= dict(zip(names, map(sp.expand, sources), strict=True))
        real, imaginary = sp.symbols(names)
        quotient = sp.solve([p * f - q * g - real, q * f + p * g - imaginary], [f, g])
        formulas |= {
            str(name): expr.subs(p**2 + q**2, sp.Symbol("D")) for name, expr in quotient.items()
        }
    return formulas


@cache
def flight_residual() -> dict[str, Expr]:
    """Return f1 and f2 of eq. (54) for a flight, summed so that neither loses digits if start and
    end are close.
    """
    flow = solution.flow()
    return {"f1": flow.x - x_j, "f2": flow.v - v_j}


def by_start() -> dict[str, Expr]:
    """Return the derivatives of x(tau) and v(tau) by x_i, v_i and theta_i with keys such as x_x0,
    x_v0, v_ph.
    """
    flow = solution.flow()
    force = solution.acceleration(x_i, v_i, theta_i)
    functions = {"x": flow.x, "v": flow.v}
    variables = {"x0": x_i, "v0": v_i, "ph": theta_i}
    derivatives = {}
    for (name, expr), (key, variable) in product(functions.items(), variables.items()):
        # a_i depends on all of them.
        total = expr.diff(variable) + expr.diff(a_i) * force.diff(variable)
        derivatives[f"{name}_{key}"] = sp.expand(total)
    return derivatives


def flight_jacobian() -> dict[str, Expr]:
    """Return the derivatives of f1 and f2 of a flight by x_i, theta_i, theta_j: x_x0, x_th0, x_th1,
    v_x0 and so on.
    """
    # The others are constants: with respect to x_j, f1 has the derivative -1 and f2 the derivative
    # 0.
    start = by_start()
    slopes = {}
    for name, end in (("x", v_end), ("v", a_end)):
        # v_i d/dx_i + a_i d/dv_i + Omega d/dtheta_i = 0 at fixed theta_j: the start moves along its
        # own flow.
        if name == "v":
            by_v0 = solution.E0
        else:
            by_v0 = start["x_v0"]
        slopes[f"{name}_x0"] = start[f"{name}_x0"]
        slopes[f"{name}_th0"] = -(v_i * start[f"{name}_x0"] + a_i * by_v0) / Omega
        slopes[f"{name}_th1"] = end / Omega
    return slopes


def flight_parameters() -> dict[str, Expr]:
    """Return the derivatives of a flight's x(tau) and v(tau) - v_i by m, c, k, A_alpha, B0, Omega
    and v_i.
    """
    # At fixed x_i, theta_i and tau: where theta_j is fixed, a change of Omega moves the end as
    # well.
    flow = solution.flow()
    c0 = sp.cos(theta_i)
    s0 = sp.sin(theta_i)
    forcing = {
        name: -convolve(flown) / m for name, flown in (("m", flow.a), ("c", flow.v), ("k", flow.x))
    }
    # d/dOmega f0 cos(theta_i + Omega t) = -f0 t sin(theta_i + Omega t)
    forcing |= {"A": E2 / m, "B": (c0 * R2 - s0 * I2) / m, "Om": -f0 * (s0 * P + c0 * Q)}
    slopes = {}
    start = by_start()
    for name, response in forcing.items():
        slopes[f"x_{name}"] = solution.collected(response)
        slopes[f"v_{name}"] = solution.collected(rate(response))
    return slopes | {"x_v0": start["x_v0"], "v_v0": start["v_v0"] - 1}


def _operator(expr: Expr) -> Expr:
    """Return y'' + (c/m) y' + (k/m) y for an expression y in tau: the left side of the equation of
    motion.
    """
    first = rate(expr)
    return sp.expand(rate(first) + cm * first + w0sq * expr)


def stick_residual() -> dict[str, Expr]:
    """Return f1 and f2 of a stick on a belt of speed v_i.

    A_m is A_alpha/m in the domain that it slips into.
    """
    return {"f1": x_i + v_i * tau - x_j, "f2": solution.acceleration(x_j, v_i, theta_j)}


def stick_jacobian() -> dict[str, Expr]:
    """Return the derivatives of a stick's f1 (keys x_*) and f2 (v_*) by theta_i, theta_j, x_j, if
    not constant.
    """
    residual = stick_residual()
    # tau = (theta_j - theta_i)/Omega
    by_tau = residual["f1"].diff(tau) / Omega
    return {
        "x_th0": -by_tau,
        "x_th1": by_tau,
        "v_x1": residual["f2"].diff(x_j),
        "v_th1": residual["f2"].diff(theta_j),
    }


def stick_parameters() -> dict[str, Expr]:
    """Return the derivatives of f1 and f2 of a stick by the parameters that they contain, and by
    v_i.
    """
    residual = stick_residual()
    A = solution.A
    B0 = solution.B0
    c = solution.c
    k = solution.k
    back = {c: cm * m, k: w0sq * m, B0: f0 * m, A: solution.A_m * m}
    force = residual["f2"].xreplace(solution.PAPER_LETTERS)
    slopes = {
        f"v_{name}": force.diff(q)
        for name, q in (("c", c), ("k", k), ("A", A), ("B", B0), ("v0", v_i))
    }
    slopes["v_m"] = -F / m
    assert sp.expand(force.diff(m) + force / m) == 0
    slopes["x_Om"] = -residual["f1"].diff(tau) * tau / Omega
    slopes["x_v0"] = residual["f1"].diff(v_i)
    return {name: expr.xreplace(back) for name, expr in slopes.items()}
