"""Touches: the minimum of a gap near a tangency, and how far a gap may be wrong there.

A part of `symosc.engine.first_exit`: where its steps shrink, the minimum of the gap ahead is found and compared with
the rounding error of the gap plus what is known of the error of the start. A gap that shrinks without end is no touch.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on mpmath numbers.
"""

from __future__ import annotations

from math import sqrt

from symosc.engine.flow import state_at, velocity_scale
from symosc.engine.gap_bounds import positive_on
from symosc.kernels.entire import EPS, SIXTH

# What a search ends with.
NOTHING, HIT, TANGENCY, STALLED = 0, 1, 2, 3
# A gap that is 0 as far as this precision tells, and stays so.
LOST = 4

# What a decision must exceed, in units of EPS times the sum of the sizes of the terms (errors measured: at most 6).
ROUNDING = 64.0
# Steps to the minimum of a gap.
MOST_DESCENTS = 400
# A gap within its error that leaves it within this time (times 1/rate) is on its way through 0.
SOON = 1e-2
FAR = 1e300


def tolerance(tau, E0, E1, start_gap, v0, F0, S11, S12, S22, K):
    """Return how far a gap may be wrong `tau` after a start: rounding, and what the errors of the start have become."""
    pull = -K.w0sq * E1
    variance = pull * pull * S11 + 2.0 * pull * E0 * S12 + E0 * E0 * S22
    return ROUNDING * EPS * (velocity_scale(tau, v0, F0, K) + start_gap) + K.sigmas * sqrt(abs(variance))


def closest_approach(tau, earliest, side, M4, v0, F0, s0, c0, below, above, S11, S12, S22, K):
    """Look for a minimum of the gap near `tau` and after `earliest`, by Newton steps on its slope.

    Returns
    -------
    (verdict, tau_min)
        NOTHING: the gap is positive up to tau_min. HIT: it is negative at tau_min. TANGENCY: it touches 0 there as far
        as this precision tells, and not for good; LOST: for good. STALLED: no minimum was found nearby, or the way
        to it is not proven free.
    """
    start, sign = tau, -side
    last, depth_known = FAR, False
    for _ in range(MOST_DESCENTS):
        _, dv, F, G1, G2, _, _, _, E0, E1, _ = state_at(tau, v0, F0, s0, c0, K)
        gap, slope, bend = (below + dv if side < 0 else above - dv), sign * F, sign * G1
        allowed = tolerance(tau, E0, E1, below if side < 0 else above, v0, F0, S11, S12, S22, K)
        if bend <= 0.0 and not depth_known:
            return STALLED, tau
        shift = -slope / bend if bend > 0.0 else 0.0 * slope
        if abs(slope * shift) <= 0.25 * allowed or gap < -2.0 * allowed:
            depth_known = True
        if depth_known:
            if gap < -allowed:
                return HIT, tau
            if gap > allowed:
                back = tau - start
                free = positive_on(back, gap - allowed, -slope, 0.5 * bend, -sign * SIXTH * G2, -0.25 * SIXTH * M4)
                return (NOTHING if free and back > 0.0 else STALLED), tau
            if abs(shift) >= 0.9 * last or shift == 0.0:  # as near as rounding allows
                parts = parts_again(tau, side, v0, F0, s0, c0, below, above, S11, S12, S22, K)
                return (TANGENCY if parts else LOST), tau
        last = abs(shift)
        tau = tau + shift
        if tau < earliest:
            return STALLED, start
    return LOST, tau


def hidden(tau, side, v0, F0, s0, c0, below, above, S11, S12, S22, K):
    """Return whether a gap is 0 as far as this precision tells, and was or will be so for a while around `tau`."""
    _, dv, F, _, _, _, _, _, E0, E1, _ = state_at(tau, v0, F0, s0, c0, K)
    allowed = tolerance(tau, E0, E1, below if side < 0 else above, v0, F0, S11, S12, S22, K)
    return (below + dv if side < 0 else above - dv) <= allowed and abs(F) <= allowed * K.rate / SOON


def parts_again(tau, side, v0, F0, s0, c0, below, above, S11, S12, S22, K):
    """Return whether a gap that is 0 as far as this precision tells is clearly not 0 soon after `tau`.

    A gap that shrinks without end is no touch, however small it gets.
    """
    for rate in (K.rate, K.Om):
        later = tau + 0.5 / rate
        _, dv, _, _, _, _, _, _, E0, E1, _ = state_at(later, v0, F0, s0, c0, K)
        start_gap = below if side < 0 else above
        gap = below + dv if side < 0 else above - dv
        if abs(gap) > 4.0 * tolerance(later, E0, E1, start_gap, v0, F0, S11, S12, S22, K):
            return True
    return False
