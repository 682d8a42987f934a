"""Steps in which surely nothing happens, all at once as arrays: of many samples nearly all steps are such.

Over a short step of length tau the velocity stays near the chord between its two ends: it is off by at most
tau^2/8 max |b|, where b is the second derivative. In a flight

    v'' + (c/m) v' + (k/m) v = -(B0 Omega/m) sin(theta),   r^2 = v'^2 + (k/m) v^2,   dr/dtau <= |B0 Omega/m|,

so that r, and b with it, are bounded over the step. If the chord, so widened, stays between the belts, then the flight
meets none of them. On a belt the same is done with the two forces: their second derivative is at most |B0| Omega^2/m.
"""

from __future__ import annotations

import numpy as np

from symosc.engine.flow import Constants
from symosc.engine.state import ON_BELT
from symosc.kernels import entire_array
from symosc.kernels._generated import motion, stick_acceleration

# Longest step, in units of 1/rate: beyond it the bounds say nothing.
LONGEST_QUIET = 0.5
# What is nearer to a belt, or to the end of a stick, than this part of the sizes there is left to the event search.
CLEARANCE = 1e-9


def quiet_ends(rows: np.ndarray, left: np.ndarray, K: Constants) -> tuple[np.ndarray, np.ndarray]:
    """Return for which rows nothing happens in the time `left`, and the states [x, v] at the ends of these.

    Parameters
    ----------
    rows : array
        Starts, as `symosc.engine.start.start_rows` makes them.
    left : array
        Lengths of the steps.
    K : Constants

    Returns
    -------
    numbers : int array
        Numbers of the rows.
    ends : (len(numbers), 2) array
    """
    numbers = np.flatnonzero(K.rate * left < LONGEST_QUIET)
    tau = left[numbers]
    mode, _, _, theta, x, v, below, above = rows[numbers, :8].T
    held = mode > ON_BELT
    s, c = np.sin(theta), np.cos(theta)
    E0, E1, E2, R2, I2, s_tau, c_tau = entire_array.basis(tau, K)
    dx, dv, _ = motion(v, below, s, c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    ends = np.column_stack([x + np.where(held, v * tau, dx), v + np.where(held, 0.0, dv)])
    turned = (c * c_tau - s * s_tau) - c
    lasts = held & _stick_lasts(tau, x, v, below, above, turned, K)
    quiet = lasts | (~held & _flight_is_clear(tau, mode, v, ends[:, 1], below, K))
    return numbers[quiet], ends[quiet]


def _flight_is_clear(
    tau: np.ndarray, mode: np.ndarray, v: np.ndarray, v_end: np.ndarray, a: np.ndarray, K: Constants
) -> np.ndarray:
    """Tell which flights stay in their domain, clear of the belts."""
    most = np.hypot(a, K.w0 * v) + abs(K.fB) * tau
    off = 0.125 * tau * tau * ((K.cm + K.w0) * most + abs(K.fB))
    off += CLEARANCE * (np.abs(v) + np.abs(v_end) + abs(K.belt1.v) + abs(K.belt2.v))
    low, high = np.minimum(v, v_end) - off, np.maximum(v, v_end) + off
    walls = np.array([-np.inf, K.belt1.v, K.belt2.v, np.inf])
    domain = np.minimum(mode.astype(int), 3)  # a row on a belt is no flight, and asked about elsewhere
    return (low > walls[domain - 1]) & (high < walls[domain])


def _stick_lasts(
    tau: np.ndarray,
    x: np.ndarray,
    v: np.ndarray,
    below: np.ndarray,
    above: np.ndarray,
    turned: np.ndarray,
    K: Constants,
) -> np.ndarray:
    """Tell which sticks last, clear of their ends; `turned` is by how much the cosine of the phase changes."""
    off = 0.125 * tau * tau * abs(K.fB) * K.Om
    off += CLEARANCE * (np.abs(below) + np.abs(above) + K.w0sq * np.abs(x) + K.cm * np.abs(v) + 2.0 * abs(K.f0))
    lower, upper = (stick_acceleration(force, v, tau, turned, K.w0sq, K.f0) for force in (below, above))
    return (np.minimum(below, lower) > off) & (np.maximum(above, upper) < -off)
