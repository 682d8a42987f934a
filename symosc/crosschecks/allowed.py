"""How far samples may be from the exact motion for their rounding, and what a step makes of that."""

from __future__ import annotations

from typing import Any

import numpy as np

from symosc.crosschecks.samples import Samples
from symosc.crosschecks.steps import ExactSteps, follow_steps
from symosc.model import Parameters


def rounding_of_steps(steps: ExactSteps, scales: np.ndarray) -> np.ndarray:
    """Return what the rounding of the times and of the samples makes of x and v."""
    pushed = float(push(steps.parameters, *scales))
    ticks = 2.0 * np.spacing(np.maximum(np.abs(steps.t[1:]), np.abs(steps.t[:-1])))
    return np.outer(ticks, [scales[1], pushed]) + 8.0 * np.finfo(float).eps * scales


def push(p: Parameters, x: float | np.ndarray, v: float | np.ndarray) -> Any:
    """Return a bound of the acceleration at given |x| and |v|."""
    forces = max(abs(p.A(alpha)) for alpha in (1, 2, 3)) + abs(p.B0)
    return float(forces / p.m) + float(p.k / p.m) * np.abs(x) + float(p.c / p.m) * np.abs(v)


def looseness(p: Parameters, samples: Samples, units: np.ndarray) -> np.ndarray:
    """Return how far x and v of each sample may be off for its rounding, that of its time included, shape (n, 2)."""
    computed = samples.v_off
    if computed is None and not np.any(units):
        return np.broadcast_to(0.0, (len(samples.t), 2))
    t, x, v = units
    v = v if computed is None else v + computed
    return np.column_stack([x + np.abs(samples.v) * t, v + push(p, samples.x, samples.v) * t])


def carried(steps: ExactSteps, loose: np.ndarray, near: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Return how far rounded samples may be from the exact motion over the step, shape (n - 1, 2).

    That is the rounding of the next sample, and what the step makes of the rounding of the one before. Events in the
    step amplify it. So the exact motion is followed from the corners of the box of states that round to the sample.
    """
    if not np.any(loose):
        return np.broadcast_to(0.0, steps.defects.shape)
    spread = np.zeros_like(steps.defects)
    for signs in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        shift = loose * signs
        x, v = (np.column_stack([steps.x, steps.v]) + shift).T
        corner = follow_steps(steps.parameters, steps.t, x, v, near, scales)
        spread = np.fmax(spread, np.abs(corner.defects + shift[1:] - steps.defects))
    return spread + loose[1:]
