"""Whether friction is smoothed so widely that flights show it: the smoothed equation is integrated over the steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues, fitted
from symosc.crosschecks.friction_clues import SMOOTH_CURVES, WIDEST, smoothed
from symosc.kernels._generated import acceleration

# Widths that are tried, in units of the distance of the belts, and steps that they are tried on.
WIDTHS_TRIED = np.geomspace(1e-3, 1.0, 31)
MOST_WIDTH_STEPS, MOST_FITTED_STEPS, FEWEST_SMOOTHED = 12, 60, 2
# Runge-Kutta steps over a sample's step: at least, at most, and so many for the time that friction needs to change.
FEWEST_STAGES, MOST_STAGES, STAGES_PER_CHANGE = 16, 384, 6.0
# So much of the defects may be left at the best width of the grid, and where it has been fitted.
NEAR_WIDTH, WIDTH_LEAVES = 2.0, 0.01


def smoothed_flights(clues: Clues) -> Iterator[Diagnosis]:
    """Yield the smoothed friction that repeats the wrong steps, with its width and curve."""
    wrong = np.flatnonzero(clues.wrong & (np.diff(clues.steps.t) > 0.0) & np.isfinite(clues.sizes))
    if len(wrong) < FEWEST_SMOOTHED:
        return
    few, shown = clues.some(wrong, MOST_WIDTH_STEPS), clues.some(wrong, MOST_FITTED_STEPS)
    K = clues.steps.K
    widths = WIDTHS_TRIED * (K.belt2.v - K.belt1.v)
    tried = [(*_best_width(clues, few, widths, form), name) for name, form in SMOOTH_CURVES.items()]
    for left, width, name in sorted(tried):
        if left > NEAR_WIDTH:
            return

        def misses(value: np.ndarray, form: Callable[[Any], Any] = SMOOTH_CURVES[name]) -> np.ndarray:
            return _missed(clues, shown, np.exp(value), form)[0]

        fit = fitted(misses, np.log([width]), np.array([1e-4]))
        if fit is None or not np.nanmedian(fit.sizes / clues.sizes[shown]) <= WIDTH_LEAVES:
            continue
        width = float(np.exp(fit.value[0]))
        if not width <= WIDEST * (K.belt2.v - K.belt1.v):
            continue
        share = clues.share(fit.sizes, shown)
        left = np.nanmedian(fit.sizes / clues.sizes[shown])
        evidence = f"the equation with it, integrated over {len(shown)} steps, leaves {left:.1e} of their defects"
        yield smoothed(name, width, width * float(fit.error[0]), evidence, share)
        return


def _best_width(clues: Clues, steps: np.ndarray, widths: np.ndarray, form: Callable[[Any], Any]) -> tuple[float, float]:
    """Return which part of the defects the best of some widths leaves, and that width."""
    sizes = np.max(np.abs(_missed(clues, steps, widths, form)), axis=2) / clues.sizes[steps]
    left = np.median(np.where(np.isfinite(sizes), sizes, np.inf), axis=1)
    best = int(np.argmin(left))
    return float(left[best]), float(widths[best])


def _missed(clues: Clues, steps: np.ndarray, widths: np.ndarray, form: Callable[[Any], Any]) -> np.ndarray:
    """Return what steps miss with smoothed friction, in units of what is allowed, shape (widths, steps, 2)."""
    s, K = clues.steps, clues.steps.K
    length = s.t[steps + 1] - s.t[steps]
    pull = max(K.belt1.J, K.belt2.J, 2.0 * float(np.max(np.abs(s.v[steps + 1] - s.v[steps]) / length)))
    rate = pull / np.min(widths) + np.sqrt(K.w0sq) + K.cm + K.Om
    count = int(np.clip(STAGES_PER_CHANGE * rate * np.max(length), FEWEST_STAGES, MOST_STAGES))
    h = length / count
    middle, width = 0.5 * (K.A1 + K.A3), widths[:, None]

    def push(theta: Any, x: Any, v: Any) -> Any:
        friction = K.belt1.J * form((v - K.belt1.v) / width) + K.belt2.J * form((v - K.belt2.v) / width)
        return acceleration(x, v, np.cos(theta), middle, K.cm, K.w0sq, K.f0) - 0.5 * friction

    shape = (len(widths), len(steps))
    x, v = np.broadcast_to(s.x[steps], shape), np.broadcast_to(s.v[steps], shape)
    for i in range(count):
        theta = s.theta[steps] + K.Om * i * h
        half, whole = theta + 0.5 * K.Om * h, theta + K.Om * h
        a1 = push(theta, x, v)
        a2 = push(half, x + 0.5 * h * v, v + 0.5 * h * a1)
        a3 = push(half, x + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2)
        a4 = push(whole, x + h * v + 0.5 * h * h * a2, v + h * a3)
        x, v = x + h * v + h * h * (a1 + a2 + a3) / 6.0, v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    ends = np.stack([x - s.x[steps + 1], v - s.v[steps + 1]], axis=2)
    return np.asarray(ends / clues.allowed[steps])
