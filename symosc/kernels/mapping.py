"""Residuals and derivatives of one map between two points: scalar source for every kind of number.

`symosc.mappings.equations` binds these functions to numpy's and mpmath's sin, cos and entire functions; numba compiles
them; `symosc.symbolic.export` prints them in other languages. A flight goes from a belt of speed v_i to one of speed
v_j through the domain with A = A_alpha/m.
"""

from __future__ import annotations

from math import cos, sin

from symosc.kernels._generated import (
    acceleration,
    flight_jacobian,
    flight_parameters,
    flight_residual,
    motion,
    stick_jacobian,
    stick_parameters,
    stick_residual,
)
from symosc.kernels.entire import basis
from symosc.kernels.repeated import repeated


def flight(x_i, theta_i, x_j, theta_j, v_i, v_j, A, K):
    """Return f1, f2."""
    s0, c0 = sin(theta_i), cos(theta_i)
    E0, E1, E2, R2, I2, _, _ = basis((theta_j - theta_i) / K.Om, K)
    a0 = acceleration(x_i, v_i, c0, A, K.cm, K.w0sq, K.f0)
    return flight_residual(x_i, v_i, a0, s0, c0, x_j, v_j, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)


def flight_slopes(x_i, theta_i, theta_j, v_i, A, K):
    """Return the derivatives of f1 by x_i, theta_i, theta_j, then those of f2; by x_j they are -1 and 0."""
    s0, c0 = sin(theta_i), cos(theta_i)
    E0, E1, E2, R2, I2, _, _ = basis((theta_j - theta_i) / K.Om, K)
    a0 = acceleration(x_i, v_i, c0, A, K.cm, K.w0sq, K.f0)
    _, dv, a = motion(v_i, a0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    return flight_jacobian(v_i, a0, v_i + dv, a, K.w0sq, K.Om, E0, E1, E2)


def flight_by_parameters(x_i, theta_i, theta_j, v_i, A, m, K):
    """Return the derivatives of x and v - v_i at the end by m, c, k, A_alpha, B0, Omega and v_i, in pairs."""
    s0, c0, tau = sin(theta_i), cos(theta_i), (theta_j - theta_i) / K.Om
    E0, E1, E2, R2, I2, _, _ = basis(tau, K)
    U0, U1, U2, V, W, P, Q = repeated(tau, K)
    a0 = acceleration(x_i, v_i, c0, A, K.cm, K.w0sq, K.f0)
    _, dv, a = motion(v_i, a0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    v = v_i + dv
    return flight_parameters(
        x_i, v_i, a0, s0, c0, v, a, tau, m, K.cm, K.w0sq, K.f0, K.Om, E1, E2, R2, I2, U0, U1, U2, V, W, P, Q
    )


def stick(x_i, theta_i, x_j, theta_j, v, A, K):
    """Return f1, f2 of a stick at speed v that slips into the domain with A = A_alpha/m."""
    return stick_residual(x_i, v, (theta_j - theta_i) / K.Om, x_j, cos(theta_j), A, K.cm, K.w0sq, K.f0)


def stick_slopes(theta_j, v, K):
    """Return the derivatives of f1 by theta_i and theta_j, and of f2 by x_j and theta_j; the others are 1, -1 or 0."""
    return stick_jacobian(v, sin(theta_j), K.w0sq, K.f0, K.Om)


def stick_by_parameters(x_j, theta_i, theta_j, v, F, m, K):
    """Return the derivatives of f2 = F by c, k, A_alpha, B0, v and m, and of f1 by Omega and v."""
    return stick_parameters(v, (theta_j - theta_i) / K.Om, x_j, cos(theta_j), F, m, K.cm, K.Om)
