"""How far right samples may be from the exact motion: their own rounding, and what the motion makes of earlier errors.

Two motions of one scene never move apart. Friction falls with the velocity, so for the differences X and V of two
motions X' = V and V' = -(c/m) V - (k/m) X - (a force with the sign of V), through sticks and crossings as well. Hence

    V^2 + (k/m) X^2 never grows,   |V(t)| <= max(|V(0)|, (k/c) max |X|),   |V(t)| <= |V(0)| + (k/m) t max |X|.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from symosc.crosschecks.samples import Samples
from symosc.model import Parameters


def propagated(p: Parameters, off: np.ndarray, tau: Any) -> np.ndarray:
    """Return a bound of |x| and |v| between two exact motions that begin `off` apart, a time `tau` later.

    `off` has the shape (n, 2) or (2,).
    """
    if not np.any(off):
        return np.zeros(2)
    x, v = off[..., 0], off[..., 1]
    square, damping = float(p.k / p.m), float(p.c / p.m)
    fastest = np.sqrt(v * v + square * x * x)
    farthest = x + tau * fastest
    if square > 0.0:
        farthest = np.minimum(farthest, np.sqrt(x * x + v * v / square))
    v = np.minimum(fastest, v + square * tau * farthest)
    if damping > 0.0:
        v = np.minimum(v, np.maximum(off[..., 1], square / damping * farthest))
    return np.stack([farthest, v], axis=-1)


def double_rounding(p: Parameters, t: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Return what the rounding of times and samples to doubles makes of x and v over the steps, shape (n - 1, 2)."""
    pushed = float(push(p, *scales))
    ticks = 2.0 * np.spacing(np.maximum(np.abs(t[1:]), np.abs(t[:-1])))
    return np.outer(ticks, [scales[1], pushed]) + 8.0 * np.finfo(float).eps * scales


def push(p: Parameters, x: float | np.ndarray, v: float | np.ndarray) -> Any:
    """Return a bound of the acceleration at given |x| and |v|."""
    forces = max(abs(p.A(alpha)) for alpha in (1, 2, 3)) + abs(p.B0)
    return float(forces / p.m) + float(p.k / p.m) * np.abs(x) + float(p.c / p.m) * np.abs(v)


def looseness(p: Parameters, samples: Samples, rounding: np.ndarray) -> np.ndarray:
    """Return how far x and v of each sample may be off for its rounding, that of its time included, shape (n, 2).

    Parameters
    ----------
    p : Parameters
    samples : Samples
    rounding : (3, n) array
        How far t, x and v may be off as numbers: half a unit of the last place.
    """
    if samples.v_off is None and not np.any(rounding):
        return np.broadcast_to(0.0, (len(samples.t), 2))
    t, x, v = rounding
    v = v if samples.v_off is None else np.maximum(v, samples.v_off)
    # While the clock is off by t the velocity changes too.
    acceleration = push(p, np.abs(samples.x) + x, np.abs(samples.v) + v)
    fastest = np.abs(samples.v) + v + acceleration * t
    return np.column_stack([x + fastest * t, v + push(p, np.abs(samples.x) + x + fastest * t, fastest) * t])
