"""DOP853 compiled by numba: an adaptive Runge-Kutta method with the event logic inside, nothing of
it in Python.

Coefficients, error estimate and dense output are those of `scipy.integrate.DOP853` (Hairer, Norsett
& Wanner). An exit is searched where a margin changes its sign over a limited step, and up to its
turning point inside. Steps of the method itself refine the event, not its interpolant, and flights
start off the belt.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import lru_cache
from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853

from symosc.base.aliases import Record
from symosc.bench import event_logic
from symosc.bench.event_logic import (
    ATOL,
    LAST_BIT,
    ONE_STEP_OFFSET,
    STEPS_PER_PERIOD,
    UNSOLVED,
    Problem,
    force,
    margins,
    problem,
    root,
    runner,
    turn,
)
from symosc.bench.solvers import FoundEvent, Solver
from symosc.kernels.compiling import compile_modules
from symosc.scenes import Scene

STAGES = DOP853.n_stages
ALL_STAGES = (
    STAGES + 1 + len(DOP853.C_EXTRA)
)  # with the derivative at the end, and those of the dense output
STAGE_TIMES = np.concatenate([DOP853.C, [1.0], DOP853.C_EXTRA])
STAGE_WEIGHTS = np.zeros((ALL_STAGES, ALL_STAGES))
STAGE_WEIGHTS[:STAGES, :STAGES] = DOP853.A
STAGE_WEIGHTS[STAGES, :STAGES] = DOP853.B
STAGE_WEIGHTS[STAGES + 1 :] = DOP853.A_EXTRA
E3 = DOP853.E3
E5 = DOP853.E5
DENSE_WEIGHTS = DOP853.D
DENSE_TERMS = len(DENSE_WEIGHTS) + 3
STEP_SAFETY = 0.9
STEP_SHRINK = 0.2
STEP_GROWTH = 10.0
STEP_EXPONENT = -1.0 / (DOP853.error_estimator_order + 1)


class Settings(NamedTuple):
    """Tolerances, the longest and the first step, and arrays for stages and dense output."""

    rtol: float
    atol: float
    longest: float
    first: float
    K: np.ndarray
    F: np.ndarray


class SolverStep(NamedTuple):
    """One step of DOP853: its start t, x, v, its length h, and the coefficients F of its dense
    output.
    """

    F: np.ndarray
    t: float
    x: float
    v: float
    h: float


def settings(q: Problem, tolerance: float) -> Settings:
    """Return DOP853's settings for a relative tolerance, with steps in proportion to the period of
    `q`.
    """
    stages = np.zeros((2, ALL_STAGES))
    terms = np.zeros((2, DENSE_TERMS))
    # The first step of each flight and stick, as a part of the period.
    return Settings(
        tolerance, ATOL * tolerance, q.period / STEPS_PER_PERIOD, q.period / 20, stages, terms
    )


def stages(q, s, mode, t, x, v, h, begin, end):
    """Evaluate Runge-Kutta stages begin to end - 1 and store their rates in s.K.

    Return the state of the last one.
    """
    X = V = 0.0
    for stage in range(begin, end):
        dx = dv = 0.0
        for j in range(stage):
            dx += STAGE_WEIGHTS[stage, j] * s.K[0, j]
            dv += STAGE_WEIGHTS[stage, j] * s.K[1, j]
        X = x + h * dx
        V = v + h * dv
        s.K[0, stage] = V
        if mode < 4:
            s.K[1, stage] = force(q, mode, t + h * STAGE_TIMES[stage], X, V)
        else:
            s.K[1, stage] = 0.0
    return X, V


def error_of(s, x, v, X, V, h):
    """Return DOP853's error estimate of a step h from (x, v) to (X, V) in units of the tolerance.

    S has its stages.
    """
    third = fifth = 0.0
    for row in range(2):
        e3 = e5 = 0.0
        for j in range(STAGES + 1):
            e3 += E3[j] * s.K[row, j]
            e5 += E5[j] * s.K[row, j]
        if row == 0:
            size = max(abs(x), abs(X))
        else:
            size = max(abs(v), abs(V))
        scale = s.atol + s.rtol * size
        third += (e3 / scale) ** 2
        fifth += (e5 / scale) ** 2
    if fifth == 0.0:
        return 0.0
    return h * fifth / sqrt((fifth + 0.01 * third) * 2.0)


def dense(q, s, mode, t, x, v, X, V, h):
    """Compute the dense output, into s.F, of a step from (x, v) to (X, V); return the step."""
    stages(q, s, mode, t, x, v, h, STAGES + 1, ALL_STAGES)
    for row in range(2):
        if row == 0:
            delta = X - x
        else:
            delta = V - v
        s.F[row, 0] = delta
        s.F[row, 1] = h * s.K[row, 0] - delta
        s.F[row, 2] = 2.0 * delta - h * (s.K[row, STAGES] + s.K[row, 0])
        for i in range(DENSE_TERMS - 3):
            total = 0.0
            for j in range(ALL_STAGES):
                total += DENSE_WEIGHTS[i, j] * s.K[row, j]
            s.F[row, 3 + i] = h * total
    return SolverStep(s.F, t, x, v, h)


def state_in(step, tau):
    """Return position and velocity at the time tau after a step began, by its dense output."""
    part = tau / step.h
    x = v = 0.0
    for i in range(DENSE_TERMS):
        if i % 2 == 0:
            factor = part
        else:
            factor = 1.0 - part
        x = (x + step.F[0, DENSE_TERMS - 1 - i]) * factor
        v = (v + step.F[1, DENSE_TERMS - 1 - i]) * factor
    return step.x + x, step.v + v


def margin(q, mode, side, step, tau):
    """Return the lower margin (side < 0), upper margin (> 0) or `turn` (0) at the time tau after a
    step began.
    """
    x, v = state_in(step, tau)
    t = step.t + tau
    if side == 0:
        return turn(q, mode, t, x, v)
    below, above = margins(q, mode, t, x, v)
    if side < 0:
        return below
    return above


def exit_within(q, s, mode, step, end, tolerance):
    """Return (side, tau) at which a margin becomes negative within [0, end].

    Side 0 if none does.
    """
    x, v = state_in(step, end)
    below, above = margins(q, mode, step.t + end, x, v)
    if below >= 0.0 and above >= 0.0:
        return 0, end
    if below < 0.0:
        side = -1
        after = below
    else:
        side = 1
        after = above
    before = margin(q, mode, side, step, 0.0)
    if before < 0.0:
        return side, 0.0
    return side, root(q, mode, side, step, 0.0, end, before, after, tolerance)


def refined(q, s, mode, side, step, tau):
    """Return time and position of an exit by Newton's method on the Runge-Kutta step itself, not
    its dense output.
    """
    x = step.x
    for _ in range(3):
        x, v = stages(q, s, mode, step.t, step.x, step.v, tau, 1, STAGES + 1)
        below, above = margins(q, mode, step.t + tau, x, v)
        slope = abs(turn(q, mode, step.t + tau, x, v))
        if slope > 0.0:
            change = (below if side < 0 else above) / slope
        else:
            change = 0.0
        if not abs(change) < 1e-3 * step.h or abs(change) < LAST_BIT * (step.t + tau):
            break
        tau += change
        x += v * change
    return tau, x


def leave(q, s, mode, t, x, v, t_end):
    """Follow one flight or stick by steps.

    Return side, time and position of its exit (side 0: t_end reached).
    """
    h = s.first
    # the first Runge-Kutta stage
    s.K[0, 0] = v
    if mode < 4:
        s.K[1, 0] = force(q, mode, t, x, v)
    else:
        s.K[1, 0] = 0.0
    last_slope = turn(q, mode, t, x, v)
    for _ in range(1_000_000):
        h = min(h, s.longest, t_end - t)
        X, V = stages(q, s, mode, t, x, v, h, 1, STAGES + 1)
        error = error_of(s, x, v, X, V, h)
        if error >= 1.0:
            h *= max(STEP_SHRINK, STEP_SAFETY * error**STEP_EXPONENT)
            if t + h == t:
                return UNSOLVED, t, x
            continue
        slope = turn(q, mode, t + h, X, V)
        below, above = margins(q, mode, t + h, X, V)
        outside = below < 0.0 or above < 0.0
        if outside or slope * last_slope < 0.0:
            # What is found in the interpolant's last bits is refined anyway.
            tolerance = s.rtol * h
            step = dense(q, s, mode, t, x, v, X, V, h)
            side = 0
            tau = h
            if slope * last_slope < 0.0:
                extremum = root(q, mode, 0, step, 0.0, h, last_slope, slope, tolerance)
                side, tau = exit_within(q, s, mode, step, extremum, tolerance)
            if side == 0 and outside:
                side, tau = exit_within(q, s, mode, step, h, tolerance)
            if side != 0:
                tau, x = refined(q, s, mode, side, step, tau)
                return side, t + tau, x
        if t + h >= t_end:
            return 0, t_end, X
        t = t + h
        x = X
        v = V
        last_slope = slope
        s.K[0, 0], s.K[1, 0] = s.K[0, STAGES], s.K[1, STAGES]
        if error == 0.0:
            h *= STEP_GROWTH
        else:
            h *= min(STEP_GROWTH, STEP_SAFETY * error**STEP_EXPONENT)
    return UNSOLVED, t, x


@lru_cache(maxsize=1)
def compiled() -> Record:
    """Return the functions of this module and of `event_logic` by name, compiled together by numba."""
    return compile_modules((event_logic, sys.modules[__name__]))


def prepare(scene: Scene, tolerance: float) -> Callable[[], Iterator[FoundEvent]]:
    """Return a function that follows a scene by the compiled DOP853 and returns its events."""
    return runner(
        scene, compiled(), settings(problem(scene.parameters), tolerance), ONE_STEP_OFFSET
    )


SOLVERS = (
    Solver(
        "numba DOP853",
        prepare,
        (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14),
        needs="numba",
        note=f"at least {STEPS_PER_PERIOD} steps per period; extrema of the margins; "
        f"flights start {ONE_STEP_OFFSET:g} off the belt",
    ),
)
