"""The closed form as a careful user writes it, scanned at a fixed distance for a change of sign.

It evaluates the particular plus the homogeneous solution in sines, cosines and exponentials, with one formula for each
regime of damping. It takes a number of samples per period (of drive or spring, the shorter one), and a root finder
between two samples of different sign. In Python the samples are taken with NumPy, a period at a time, and the root
finder is scipy's brentq; the other form is compiled by numba.

What happens between two samples is not seen, and the formulas divide by k and by the distance from resonance.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from math import cos, exp, sin, sqrt
from typing import NamedTuple

from symosc.aliases import Record
from symosc.bench import scalar_logic
from symosc.bench.event_logic import Motion, PeerError
from symosc.bench.scalar_logic import UNSOLVED, Scalars, margins, root, runner, scalars
from symosc.bench.solvers import Solver
from symosc.engine.arithmetic import bind, compile_modules
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene

SCAN_SAMPLES, MANY_SCAN_SAMPLES = 20, 200
UNDERDAMPED, CRITICAL, OVERDAMPED = range(3)
# The first sample of a flight or stick, as a part of the distance of two samples: at its start, the sign of what is
# looked for is that of the rounding.
COOL_DOWN = 1e-5
MOST_SCAN_SAMPLES = 10_000_000


class Scan(NamedTuple):
    """How to scan (distance and number of samples per period, tolerance of a root), and constants of the closed form.

    `decay` and `second` are h and omega_d (underdamped), h and 0 (critical) or the characteristic roots (overdamped).
    P and Q are the amplitudes of the particular solution's cosine and sine.
    """

    distance: float
    points: int
    tolerance: float
    regime: int
    decay: float
    second: float
    P: float
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


def scan_of(motion: Motion, points: int, tolerance: float) -> Scan:
    """Return the constants of the closed form; PeerError where it divides by zero."""
    m, c, k, Omega = motion.m, motion.c, motion.k, motion.Omega
    distance = motion.period / points
    try:
        square = (k - m * Omega**2) ** 2 + (c * Omega) ** 2
        P, Q = motion.B0 * (k - m * Omega**2) / square, motion.B0 * c * Omega / square
        _ = 1 / k
    except ZeroDivisionError:
        raise PeerError("the closed form divides by zero: k = 0, or resonance without damping") from None
    h, discriminant = c / (2 * m), (c / (2 * m)) ** 2 - k / m
    if discriminant < 0:
        regime, decay, second = UNDERDAMPED, h, sqrt(-discriminant)
    elif discriminant == 0:
        regime, decay, second = CRITICAL, h, 0.0
    else:
        regime, decay, second = OVERDAMPED, -h + sqrt(discriminant), -h - sqrt(discriminant)
    return Scan(distance, points, tolerance, regime, decay, second, P, Q)


def piece_from(q, s, mode, t, x, v):
    """Fit the constants of the homogeneous solution to a start."""
    if mode > 3:
        return ScanPiece(s, t, x, v, 0.0, 0.0, 0.0)
    equilibrium = (q.A1 if mode == 1 else q.A2 if mode == 2 else q.A3) / q.stiffness
    phase = q.Omega * t + q.theta
    y = x - equilibrium - s.P * cos(phase) - s.Q * sin(phase)
    w = v + q.Omega * (s.P * sin(phase) - s.Q * cos(phase))
    if s.regime == UNDERDAMPED:
        return ScanPiece(s, t, x, v, equilibrium, y, (w + s.decay * y) / s.second)
    if s.regime == CRITICAL:
        return ScanPiece(s, t, x, v, equilibrium, y, w + s.decay * y)
    R = (w - s.second * y) / (s.decay - s.second)
    return ScanPiece(s, t, x, v, equilibrium, R, y - R)


def state_at(q, mode, piece, tau):
    """Return position and velocity after the time tau."""
    if mode > 3:
        return piece.x + piece.v * tau, piece.v
    s, R, S = piece.s, piece.R, piece.S
    phase = q.Omega * (piece.t + tau) + q.theta
    cosine, sine = cos(phase), sin(phase)
    x = piece.equilibrium + s.P * cosine + s.Q * sine
    v = q.Omega * (s.Q * cosine - s.P * sine)
    if s.regime == UNDERDAMPED:
        decay, cosine, sine = exp(-s.decay * tau), cos(s.second * tau), sin(s.second * tau)
        x += decay * (R * cosine + S * sine)
        v += decay * ((S * s.second - R * s.decay) * cosine - (R * s.second + S * s.decay) * sine)
    elif s.regime == CRITICAL:
        decay = exp(-s.decay * tau)
        x += decay * (R + S * tau)
        v += decay * (S - s.decay * (R + S * tau))
    else:
        slow, fast = R * exp(s.decay * tau), S * exp(s.second * tau)
        x += slow + fast
        v += s.decay * slow + s.second * fast
    return x, v


def margin(q, mode, side, piece, tau):
    """Return the margin on one side (see `margins`) after the time tau."""
    x, v = state_at(q, mode, piece, tau)
    below, above = margins(q, mode, piece.t + tau, x, v)
    return below if side < 0 else above


def leave(q, s, mode, t, x, v, t_end):
    """Follow one flight or stick, sample by sample."""
    piece = piece_from(q, s, mode, t, x, v)
    tau = COOL_DOWN * s.distance
    x, v = state_at(q, mode, piece, tau)
    below, above = margins(q, mode, t + tau, x, v)
    for _ in range(MOST_SCAN_SAMPLES):
        later = tau + s.distance
        x, v = state_at(q, mode, piece, later)
        next_below, next_above = margins(q, mode, t + later, x, v)
        if next_below < 0.0 or next_above < 0.0:
            side, before, after = (-1, below, next_below) if next_below < 0.0 else (1, above, next_above)
            at = root(q, mode, side, piece, tau, later, before, after, s.tolerance) if before > 0.0 else tau
            x, v = state_at(q, mode, piece, at)
            return (side, t + at, x) if t + at <= t_end else (0, t_end, x)
        if t + later >= t_end:
            return 0, t_end, x
        tau, below, above = later, next_below, next_above
    return UNSOLVED, t, x


@lru_cache(maxsize=1)
def interpreted() -> Record:
    """Return the functions with samples taken by NumPy, and scipy's brentq as the root finder."""
    import numpy as np
    from scipy.optimize import brentq

    arrays = bind(SCAN_MODULES, {"cos": np.cos, "sin": np.sin, "exp": np.exp})
    state_at_all, margins_of_all = arrays["state_at"], arrays["margins"]

    def leave(q: Scalars, s: Scan, mode: int, t: float, x: float, v: float, t_end: float) -> tuple[int, float, float]:
        piece = piece_from(q, s, mode, t, x, v)
        taus = s.distance * (np.arange(s.points + 1) + COOL_DOWN)
        while t + taus[0] < t_end:
            outside = np.minimum(*margins_of_all(q, mode, t + taus, *state_at_all(q, mode, piece, taus)))[1:] < 0
            n = int(outside.argmax())
            if outside[n]:
                tau, later = float(taus[n]), float(taus[n + 1])
                side = -1 if margin(q, mode, -1, piece, later) < 0 else 1
                if margin(q, mode, side, piece, tau) > 0:
                    tau = brentq(partial(margin, q, mode, side, piece), tau, later, xtol=s.tolerance)
                x = state_at(q, mode, piece, tau)[0]
                return (side, t + tau, x) if t + tau <= t_end else (0, t_end, x)
            taus += s.points * s.distance
        return 0, t_end, x

    return bind(SCAN_MODULES, {"leave": leave})


SCAN_MODULES = (scalar_logic, sys.modules[__name__])


@lru_cache(maxsize=1)
def compiled() -> Record:
    """Return the functions compiled by numba."""
    return compile_modules(SCAN_MODULES)


def prepare(with_numba: bool, points: int, scene: Scene, tolerance: float) -> Callable[[], Sequence[FoundEvents]]:
    """Prepare the scan with so many samples per period."""
    functions = compiled() if with_numba else interpreted()
    motion = Motion(scene.parameters, scene.t0)
    return runner(scene, functions, scalars(motion), scan_of(motion, points, tolerance))


SCAN_TOLERANCES = (1e-4, 1e-7, 1e-10, 1e-13)
SOLVERS = (
    Solver(
        f"closed form, scan {SCAN_SAMPLES}, numba",
        partial(prepare, True, SCAN_SAMPLES),
        SCAN_TOLERANCES,
        needs="numba",
        note=f"{SCAN_SAMPLES} samples per period, Chandrupatla's root finder; flights between two samples are not seen",
    ),
    Solver(
        f"closed form, scan {MANY_SCAN_SAMPLES}, numba",
        partial(prepare, True, MANY_SCAN_SAMPLES),
        SCAN_TOLERANCES,
        needs="numba",
        note=f"{MANY_SCAN_SAMPLES} samples per period",
    ),
    Solver(
        f"closed form, scan {SCAN_SAMPLES}, brentq",
        partial(prepare, False, SCAN_SAMPLES),
        SCAN_TOLERANCES,
        note="samples by NumPy, a period at a time",
    ),
    Solver(
        f"closed form, scan {MANY_SCAN_SAMPLES}, brentq",
        partial(prepare, False, MANY_SCAN_SAMPLES),
        SCAN_TOLERANCES,
        note="samples by NumPy, a period at a time",
    ),
)
