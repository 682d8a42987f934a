"""Flights by scipy's DOP853: the equation of motion as printed, integrated without anything of this package's flow."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from symosc.model import Parameters

DOP853_TOLERANCE = 1e-12
#: What it may differ by from the exact motion, relative to the size of the motion.
DOP853_AGREEMENT = 1e-9


def flight(
    p: Parameters, constant: Fraction, span: tuple[float, float], state: tuple[float, float] | np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return times and states [x, v] of m x'' + c x' + k x = constant + B0 cos(Omega t) from `state` over `span`."""
    from scipy.integrate import solve_ivp

    A, m, c, k, B0, Omega = (float(value) for value in (constant, p.m, p.c, p.k, p.B0, p.Omega))

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], (A + B0 * np.cos(Omega * t) - k * y[0] - c * y[1]) / m

    run = solve_ivp(rates, span, state, method="DOP853", rtol=DOP853_TOLERANCE, atol=DOP853_TOLERANCE)
    return run.t, run.y
