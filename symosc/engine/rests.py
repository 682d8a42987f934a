"""Flights without an end: what shows that a motion meets no belt any more.

Three arguments, each for all times to come:

- the steady velocity and the energy of the transient bound the velocity (`never_leaves`);
- without a spring the transient is one exponential, which does the same;
- without a drive and without oscillation (B0 = 0, critical or overdamped) the gap g = +-(v - v_lambda) obeys
  L g = r with a constant r = -+(k/m) v_lambda. With the fast root l2 of L the function u = g' - l2 g obeys
  u' = l1 u + r. So u >= 0 and r >= 0 keep u >= 0, and g' >= l2 g keeps g > 0: the gap may shrink without end, but it
  never closes (`creeps_for_ever`). For k = 0 u is constant, a rational number whose sign is exact.

Who decides whether a motion creeps: about an exact start `symosc.engine.start.settles`, in rational numbers, once and
for all, before anything is simulated; about every later state, and the starts of maps and orbits, `creeps_for_ever`
here, which says yes only where that is clear of rounding. The conditions are the same.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on mpmath numbers.
"""

from __future__ import annotations

from math import sqrt

from symosc.engine.flow import constant_force
from symosc.engine.march import MARCH_SLACK
from symosc.engine.touches import ROUNDING
from symosc.kernels.entire import EPS

# A gap below this part of the velocities in question is too small to begin a new search with.
BESIDE = 1e-6


def never_leaves(start, S, lower, upper, domain, K):
    """Return whether v stays between two speeds for ever, from the steady amplitude and the transient's size.

    Parameters
    ----------
    start : Launch
    S : Covariance of its errors.
    lower, upper : speeds of the belts around the domain; -inf and inf where there is none.
    domain : 1, 2 or 3.
    K : Constants
    """
    if not K.steady or (K.w0 == 0.0 and K.cm == 0.0):
        return False
    v, F, s, c = start
    free = v - (K.Ss * s + K.Sc * c)
    if K.w0 == 0.0:
        mean = constant_force(domain, K) / K.cm
        free = free - mean
        highest, lowest = mean + K.V0 + (free if free > 0.0 else 0.0), mean - K.V0 + (free if free < 0.0 else 0.0)
    else:
        F_free = F - K.Om * (K.Ss * c - K.Sc * s)
        highest = K.V0 + sqrt(F_free * F_free + K.w0sq * free * free) / K.w0
        lowest = -highest
    # A swing that just touches a belt is an event.
    slack = MARCH_SLACK * (highest - lowest + abs(highest) + abs(v)) + K.sigmas * sqrt(S.S22 + K.w0sq * S.S11)
    return lowest - slack > lower and highest + slack < upper


def creeps_for_ever(state, K):
    """Return whether a flight without drive and oscillation (K.creeps) never reaches a wall; see the module."""
    mode, v, F, S = state.mode, state.v, state.Fb, state.S
    terms = abs(constant_force(mode, K)) + abs(K.w0sq * state.x) + (K.cm - K.l2) * abs(v)
    noise = ROUNDING * EPS * terms + K.sigmas * (K.w0sq * sqrt(S.S11) + (K.cm - K.l2) * sqrt(S.S22))
    if mode > 1:
        lower = K.belt1 if mode == 2 else K.belt2
        kept = lower.limit_above >= 0.0 if K.w0 == 0.0 else F - K.l2 * (v - lower.v) > noise
        kept = kept or (v == lower.v and F == 0.0 and lower.drift > 0.0)  # u begins with 0 and grows
        if not kept or lower.drift < 0.0:
            return False
    if mode < 3:
        upper = K.belt1 if mode == 1 else K.belt2
        kept = upper.limit_below <= 0.0 if K.w0 == 0.0 else -F - K.l2 * (upper.v - v) > noise
        kept = kept or (v == upper.v and F == 0.0 and upper.drift < 0.0)
        if not kept or upper.drift > 0.0:
            return False
    return True


def beside_a_wall(v, size, lower, upper):
    """Return whether v is so near a wall, compared with the velocities of `size`, that a touch may be here."""
    return v - lower <= BESIDE * size or upper - v <= BESIDE * size
