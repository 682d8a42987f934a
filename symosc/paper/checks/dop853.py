"""Flights by scipy's DOP853: the equation of motion as printed, integrated without anything of this package's flow."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from symosc.model import Parameters

DOP853_TOLERANCE = 1e-12
#: What it may differ by from the exact motion, relative to the size of the motion.
DOP853_AGREEMENT = 1e-9


def flight(
    p: Parameters, constant: Fraction, span: tuple[float, float], state: tuple[float, float] | np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return times and states [x, v] of m x'' + c x' + k x = constant + B0 cos(Omega t) from `state` over `span`."""
    run = _run(p, constant, span, state)
    return run.t, run.y


def reaches(
    p: Parameters, constant: Fraction, t: float, state: tuple[float, float], speed: float
) -> tuple[float, float]:
    """Return t and x at which such a flight first has a velocity; it has to come to that within 100 periods."""

    def gap(time: float, y: np.ndarray) -> float:
        return float(y[1] - speed)

    gap.terminal = True  # type: ignore[attr-defined]
    run = _run(p, constant, (t, t + 200 * np.pi / float(p.Omega)), state, gap)
    return float(run.t_events[0][0]), float(run.y_events[0][0][0])


def _run(p: Parameters, constant: Fraction, span: tuple[float, float], state: Any, events: Any = None) -> Any:
    from scipy.integrate import solve_ivp

    A, m, c, k, B0, Omega = (float(value) for value in (constant, p.m, p.c, p.k, p.B0, p.Omega))

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], (A + B0 * np.cos(Omega * t) - k * y[0] - c * y[1]) / m

    tolerance = {"rtol": DOP853_TOLERANCE, "atol": DOP853_TOLERANCE}
    return solve_ivp(rates, span, state, method="DOP853", events=events, **tolerance)
