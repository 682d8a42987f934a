"""The closed form as a careful user writes it, scanned at a fixed distance for a change of sign,
compiled by numba.

One formula for each regime of damping, sampled some times per period (of drive or spring, the
shorter one), and a root finder between two samples of different sign. What happens between two
samples is not seen, and the formulas divide by k and by the distance from resonance.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from math import cos, exp, sin, sqrt
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.bench import event_logic
from symosc.bench.event_logic import (
    LASTS,
    ON_BELT,
    UNSOLVED,
    PeerError,
    PeerProblem,
    margins,
    problem,
    root,
    runner,
)
from symosc.bench.solvers import Solver, SolverEvent
from symosc.kernels.compiling import compile_modules
from symosc.model import Parameters
from symosc.scenes import Scene

UNDERDAMPED, CRITICAL, OVERDAMPED = range(3)
# The first sample of a flight or stick, as a part of the distance of two samples: at its start, the
# sign of what is looked for is that of the rounding.
FIRST_SAMPLE = 1e-5
# A scan that has not met an exit after so many samples gives up.
MOST_SAMPLES = 10_000_000


class Scan(NamedTuple):
    """What a scan for changes of sign needs: distance of samples, tolerance of a root, constants of
    the closed form.
    """

    distance: float
    tolerance: float
    regime: int
    # h, omega_d (underdamped); h, 0 (critical); or both characteristic roots (overdamped)
    decay: float
    second: float
    P: float  # amplitudes of the particular solution's cosine, and (Q) sine
    Q: float


class ScanPiece(NamedTuple):
    """One flight or stick: where it started, and in a flight the constants of its solution."""

    s: Scan
    t: float
    x: float
    v: float
    equilibrium: float
    R: float
    S: float


def scan_of(q: PeerProblem, points: int, tolerance: float) -> Scan:
    """Return a scan with `points` samples per period.

    Raise PeerError where its closed form divides by zero.
    """
    Omega = q.Omega
    k = q.stiffness
    try:
        square = (k - Omega**2) ** 2 + (q.damping * Omega) ** 2
        P = q.swing * (k - Omega**2) / square
        Q = q.swing * q.damping * Omega / square
        _ = 1 / k  # `piece_from` divides by it
    except ZeroDivisionError:
        raise PeerError(
            "the closed form divides by zero: k = 0, or resonance without damping"
        ) from None
    h = q.damping / 2
    discriminant = (q.damping / 2) ** 2 - k
    if discriminant < 0:
        regime = UNDERDAMPED
        decay = h
        second = sqrt(-discriminant)
    elif discriminant == 0:
        regime = CRITICAL
        decay = h
        second = 0.0
    else:
        regime = OVERDAMPED
        decay = -h + sqrt(discriminant)
        second = -h - sqrt(discriminant)
    return Scan(q.period / points, tolerance, regime, decay, second, P, Q)


def piece_from(q, s, mode, t, x, v):
    """Return a flight or stick from a start, with the constants of the homogeneous solution that
    fit this start.
    """
    if mode > ON_BELT:
        return ScanPiece(s, t, x, v, 0.0, 0.0, 0.0)
    force = q.A2
    if mode == 1:
        force = q.A1
    elif mode == 3:
        force = q.A3
    equilibrium = force / q.stiffness
    phase = q.Omega * t + q.theta
    # Position and velocity of the homogeneous solution: without the particular one.
    y = x - equilibrium - s.P * cos(phase) - s.Q * sin(phase)
    w = v + q.Omega * (s.P * sin(phase) - s.Q * cos(phase))
    if s.regime == UNDERDAMPED:
        return ScanPiece(s, t, x, v, equilibrium, y, (w + s.decay * y) / s.second)
    if s.regime == CRITICAL:
        return ScanPiece(s, t, x, v, equilibrium, y, w + s.decay * y)
    R = (w - s.second * y) / (s.decay - s.second)
    return ScanPiece(s, t, x, v, equilibrium, R, y - R)


def state_at(q, mode, piece, tau):
    """Return position and velocity at the time tau after a piece began."""
    if mode > ON_BELT:
        return piece.x + piece.v * tau, piece.v
    # The particular solution, which follows the drive, and then the homogeneous one with the
    # constants R and S.
    s = piece.s
    R = piece.R
    S = piece.S
    phase = q.Omega * (piece.t + tau) + q.theta
    cosine = cos(phase)
    sine = sin(phase)
    x = piece.equilibrium + s.P * cosine + s.Q * sine
    v = q.Omega * (s.Q * cosine - s.P * sine)
    if s.regime == UNDERDAMPED:
        decay = exp(-s.decay * tau)
        cosine = cos(s.second * tau)
        sine = sin(s.second * tau)
        x += decay * (R * cosine + S * sine)
        v += decay * ((S * s.second - R * s.decay) * cosine - (R * s.second + S * s.decay) * sine)
    elif s.regime == CRITICAL:
        decay = exp(-s.decay * tau)
        x += decay * (R + S * tau)
        v += decay * (S - s.decay * (R + S * tau))
    else:
        slow = R * exp(s.decay * tau)
        fast = S * exp(s.second * tau)
        x += slow + fast
        v += s.decay * slow + s.second * fast
    return x, v


def margin(q, mode, side, piece, tau):
    """Return how far the mass is from its lower (side < 0) or upper exit, tau after a piece began.

    Positive inside.
    """
    x, v = state_at(q, mode, piece, tau)
    below, above = margins(q, mode, piece.t + tau, x, v)
    if side < 0:
        return below
    return above


def leave(q, s, mode, t, x, v, t_end):
    """Follow one flight or stick by samples.

    Return side, time and position of its exit (side 0: t_end reached).
    """
    piece = piece_from(q, s, mode, t, x, v)
    tau = FIRST_SAMPLE * s.distance
    x, v = state_at(q, mode, piece, tau)
    below, above = margins(q, mode, t + tau, x, v)
    for _ in range(MOST_SAMPLES):
        later = tau + s.distance
        x, v = state_at(q, mode, piece, later)
        next_below, next_above = margins(q, mode, t + later, x, v)
        if next_below < 0.0 or next_above < 0.0:
            if next_below < 0.0:
                side = -1
                before = below
                after = next_below
            else:
                side = 1
                before = above
                after = next_above
            # Only the first sample may be outside already: then the exit is there.
            if before > 0.0:
                at = root(q, mode, side, piece, tau, later, before, after, s.tolerance)
            else:
                at = tau
            x, v = state_at(q, mode, piece, at)
            if t + at <= t_end:
                return side, t + at, x
            return LASTS, t_end, x
        if t + later >= t_end:
            return LASTS, t_end, x
        tau = later
        below = next_below
        above = next_above
    return UNSOLVED, t, x


@lru_cache(maxsize=1)
def compiled() -> Record:
    """Return the functions of this module and of `event_logic`, compiled together by numba."""
    return compile_modules((event_logic, sys.modules[__name__]))


def prepare(points: int, scene: Scene, tolerance: float) -> Callable[[], Iterator[SolverEvent]]:
    """Return a function that follows a scene by the scan, with `points` samples per period, and
    returns its events.
    """
    return runner(scene, compiled(), scan_of(problem(scene.parameters), points, tolerance), 0.0)


def count_many(
    p: Parameters, starts: np.ndarray, durations: np.ndarray, points: int, tolerance: float
) -> Callable[[], np.ndarray]:
    """Return a function that counts the events of motions from (t, x, v) by the scan, in one loop
    compiled by numba.
    """
    import numba

    q = problem(p)
    follow = compiled()["follow"]
    s = scan_of(q, points, tolerance)

    @numba.njit
    def count_all(q, s, starts, durations, counts):
        for i in range(len(starts)):
            t, x, v = starts[i]
            if v < q.v1:
                mode = 1
            elif v < q.v2:
                mode = 2
            else:
                mode = 3
            # No start is on a belt, so that nothing is offset.
            end = t + durations[i]
            _rows, count, _outcome, _mode = follow(q, s, t, x, v, mode, 0, (0.0, 0.0), end)
            counts[i] = count

    def run() -> np.ndarray:
        counts = np.zeros(len(starts), np.int64)
        count_all(q, s, starts, durations, counts)
        return counts

    return run


SOLVERS = tuple(
    Solver(
        f"closed form, scan {points}, numba",
        partial(prepare, points),
        (1e-4, 1e-7, 1e-10, 1e-13),
        needs="numba",
        note=f"{points} samples per period, Chandrupatla's root finder; flights between two "
        "samples are not seen",
    )
    for points in (20, 200)
)
