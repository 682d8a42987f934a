"""The flow of one domain in closed form, by complex numbers: independent of the package's kernels.

It is for c > 0 or off resonance, and for k > 0.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from typing import Any

import numpy as np

from symosc.model import Parameters

#: Roots that are closer than this part of their size are moved apart: the flow then is off by less than 1e-8.
FAR_APART = 1e-8


def flow(p: Parameters, A: Any, start: Sequence[Any], t: Any) -> tuple[Any, Any]:
    """Return x and x' at times t of m x'' + c x' + k x = A + B0 cos(Omega t) from start = (t0, x0, v0)."""
    m, c, k, B0, Omega = (float(getattr(p, name)) for name in ("m", "c", "k", "B0", "Omega"))
    t0, x0, v0 = map(float, start)
    half = cmath.sqrt(c * c - 4 * m * k) / (2 * m)
    if abs(half) < FAR_APART * c / m:
        half = FAR_APART * c / m
    one, two = -c / (2 * m) + half, -c / (2 * m) - half
    swing = B0 / (k - m * Omega**2 + 1j * c * Omega)

    def steady(time: Any) -> tuple[Any, Any]:
        turning = swing * np.exp(1j * Omega * np.asarray(time))
        return float(A) / k + turning.real, (1j * Omega * turning).real

    x_s, v_s = steady(t0)
    a = (v0 - v_s - two * (x0 - x_s)) / (one - two)
    b = x0 - x_s - a
    first, second = a * np.exp(one * (np.asarray(t) - t0)), b * np.exp(two * (np.asarray(t) - t0))
    x, v = steady(t)
    return x + (first + second).real, v + (one * first + two * second).real
