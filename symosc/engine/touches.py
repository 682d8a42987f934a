"""Touches: the minimum of a gap near a tangency, and how far a gap may be wrong there.

A part of `symosc.engine.first_exit`: where its steps shrink, the minimum of the gap ahead is found and compared with
the rounding error of the gap plus what is known of the error of the start. A gap that shrinks without end is no touch.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on mpmath numbers.
"""

from __future__ import annotations

from math import sqrt

from symosc.engine.flow import state_at, velocity_scale
from symosc.engine.gap_bounds import FAR, gap_to, positive_on
from symosc.engine.state import HIT, LOST, NOTHING, STALLED, TANGENCY
from symosc.kernels.entire import EPS, SIXTH

# What a decision must exceed, in units of EPS times the sum of the sizes of the terms (errors measured: at most 6).
ROUNDING = 64.0
# Steps to the minimum of a gap.
MOST_DESCENTS = 400
# A gap within its error that leaves it within this time (times 1/rate) is on its way through 0.
SOON = 1e-2


def tolerance(now, start_gap, start, S, K):
    """Return how far a gap may be wrong on a flight: rounding, and what the errors `S` of its launch have become."""
    pull = -K.w0sq * now.E1
    variance = pull * pull * S.S11 + 2.0 * pull * now.E0 * S.S12 + now.E0 * now.E0 * S.S22
    rounding = ROUNDING * EPS * (velocity_scale(now.tau, start.v, start.F, K) + start_gap)
    return rounding + K.sigmas * sqrt(abs(variance))


def closest_approach(tau, earliest, side, M4, start, walls, S, K):
    """Look for a minimum of the gap near `tau` and after `earliest`, by Newton steps on its slope.

    Returns
    -------
    (verdict, tau_min)
        NOTHING: the gap is positive up to tau_min. HIT: it is negative at tau_min. TANGENCY: it touches 0 there as far
        as this precision tells, and not for good; LOST: for good. STALLED: no minimum was found nearby, or the way
        to it is not proven free.
    """
    begin, sign = tau, -side
    start_gap = walls.below if side < 0 else walls.above
    last, depth_known = FAR, False
    for _ in range(MOST_DESCENTS):
        now = state_at(tau, start, K)
        gap, slope, bend = gap_to(side, now, walls), sign * now.F, sign * now.G1
        allowed = tolerance(now, start_gap, start, S, K)
        if bend <= 0.0 and not depth_known:
            return STALLED, tau
        shift = -slope / bend if bend > 0.0 else 0.0 * slope
        if abs(slope * shift) <= 0.25 * allowed or gap < -2.0 * allowed:
            depth_known = True
        if depth_known:
            if gap < -allowed:
                return HIT, tau
            if gap > allowed:
                back, third = tau - begin, -sign * SIXTH * now.G2
                free = positive_on(back, gap - allowed, -slope, 0.5 * bend, third, -0.25 * SIXTH * M4)
                return (NOTHING if free and back > 0.0 else STALLED), tau
            if abs(shift) >= 0.9 * last or shift == 0.0:  # as near as rounding allows
                return (TANGENCY if parts_again(tau, side, start, walls, S, K) else LOST), tau
        last = abs(shift)
        tau = tau + shift
        if tau < earliest:
            return STALLED, begin
    return LOST, tau


def hidden(tau, side, start, walls, S, K):
    """Return whether a gap is 0 as far as this precision tells, and was or will be so for a while around `tau`."""
    now = state_at(tau, start, K)
    allowed = tolerance(now, walls.below if side < 0 else walls.above, start, S, K)
    return gap_to(side, now, walls) <= allowed and abs(now.F) <= allowed * K.rate / SOON


def parts_again(tau, side, start, walls, S, K):
    """Return whether a gap that is 0 as far as this precision tells is clearly not 0 soon after `tau`.

    A gap that shrinks without end is no touch, however small it gets.
    """
    for rate in (K.rate, K.Om):
        now = state_at(tau + 0.5 / rate, start, K)
        if abs(gap_to(side, now, walls)) > 4.0 * tolerance(now, walls.below if side < 0 else walls.above, start, S, K):
            return True
    return False
