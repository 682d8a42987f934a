"""Marching along a flight in fixed steps, which cost no exp, sin or cos.

A part of `symosc.engine.first_exit`, with the same bound M4 of the fourth derivative. Both ends of a step are known,
and so is Hermite's cubic of a gap g between them. At the part t of a step of length h its error is

    |g - cubic| <= 6 t^2 (1 - t)^2 M4 h^4/144,

at the most a sixteenth of what is left to Taylor's formula from one end. The cubic less that is a polynomial of degree
four whose Bernstein coefficients are g0, g0 + d0/4, (g0 + g1)/2 + (d0 - d1)/6 - M4 h^4/144, g1 - d1/4 and g1, with the
values g0, g1 and the slopes times h, d0, d1, at both ends. If they are positive, so is the gap. At a start on the wall,
where g0 = 0, the other four show that it has no other root.

All functions are scalar and run on floats (CPython, numba) and, with other globals, on mpmath numbers.
"""

from __future__ import annotations

from typing import NamedTuple

from symosc.aliases import Number
from symosc.engine.gap_bounds import gap_to
from symosc.engine.state import Flown
from symosc.kernels.entire import SIXTH

# What a gap must exceed while marching, as a part of its size.
MARCH_SLACK = 1e-10
# A gap of so many times what a stride needs (its fourth power counts) allows a step of 50 strides.
PATIENCE = 6e6
# sqrt(a^2 + b^2) <= a + OCTAGON b for a >= b >= 0, as OCTAGON > sqrt(2) - 1; it is less by a tenth at the most.
OCTAGON = 0.42


class Marched(NamedTuple):
    """Where a march ended."""

    now: Flown  # up to there no wall is met; without dx and the entire functions
    M4: Number  # the bound of the fourth derivative from there on
    side: int  # of the wall that is met in the next step, there once and for sure; 0: the next step is not decided
    there: Flown  # the end of that step


def march(tau_max, v0, now, walls, margin, K):
    """Pass over times without a contact in whole fixed steps: the bound of `first_exit`, at a fraction of its cost.

    Over a fixed step the transient is multiplied by a constant matrix and the steady state turns by a constant angle,
    so the derivatives cost no exp, sin or cos. Their rounding errors are far below the slack that the gaps are given.
    Strides are tried where the gaps look wide enough.

    Returns
    -------
    Marched
    """
    cm, w0sq, w0, Om, Ss, Sc = K.cm, K.w0sq, K.w0, K.Om, K.Ss, K.Sc
    Om2 = Om * Om
    Om3, Om4, steady4 = Om2 * Om, Om2 * Om2, K.V0 * Om2 * Om2
    tau, dv, F, G1, G2, G3, s, c = now.tau, now.dv, now.F, now.G1, now.G2, now.G3, now.s, now.c
    below, above, _, _, on_below, on_above = walls
    v_steady, u_steady = Ss * s + Sc * c, Ss * c - Sc * s
    v_free, F_free = v0 - v_steady, F - Om * u_steady
    G2_free, G3_free = G2 + Om3 * u_steady, G3 - Om4 * v_steady
    M4 = steady4 + at_least_norm(G3_free, w0 * G2_free)
    slack = MARCH_SLACK * (abs(v0) + K.V0 + abs(v_free) + abs(F_free) * K.swing) + margin
    has_below, has_above = within_reach(v0, v_free, F_free, slack, walls, K)
    step, stride = K.march.step, K.stride.step
    lift_step = 0.25 * SIXTH * SIXTH * (step * step) * (step * step)
    lift_stride = 0.25 * SIXTH * SIXTH * (stride * stride) * (stride * stride)
    long = looks_free(below + dv, above - dv, F, G1, stride, has_below, has_above)
    while True:
        M = K.stride if long else K.march
        h, lift = M.step, (lift_stride if long else lift_step) * M4 + slack
        if tau + h >= tau_max:
            if not long:
                return Marched(point(tau, dv, F, G1, G2, G3, s, c, now), M4, 0, now)
            long = False
            continue
        next_free, next_F_free = M.C * v_free + M.E1 * F_free, M.D * v_free + M.E0 * F_free
        next_s, next_c = M.c * s + M.s * c, M.c * c - M.s * s
        v_steady, u_steady = Ss * next_s + Sc * next_c, Ss * next_c - Sc * next_s
        next_dv, next_F = next_free + v_steady - v0, next_F_free + Om * u_steady
        d0, d1, free_below, free_above = h * F, h * next_F, True, True
        if has_below:
            g1 = below + next_dv
            if on_below and tau == 0.0:
                free_below = opens(d0, G1 * h * h, g1, d1, lift, slack)
            else:
                free_below = stays_open(below + dv, d0, g1, d1, lift, slack)
        if has_above:
            g1 = above - next_dv
            if on_above and tau == 0.0:
                free_above = opens(-d0, -G1 * h * h, g1, -d1, lift, slack)
            else:
                free_above = stays_open(above - dv, -d0, g1, -d1, lift, slack)
        free = free_below and free_above
        if long and not free:
            long = False
            continue
        G1_free = -cm * next_F_free - w0sq * next_free
        G2_free = -cm * G1_free - w0sq * next_F_free
        G3_free = -cm * G2_free - w0sq * G1_free
        next_G1, next_G2, next_G3 = G1_free - Om2 * v_steady, G2_free - Om3 * u_steady, G3_free + Om4 * v_steady
        if not free:
            here = point(tau, dv, F, G1, G2, G3, s, c, now)
            there = point(tau + h, next_dv, next_F, next_G1, next_G2, next_G3, next_s, next_c, now)
            side = -1 if free_above and meets_once(-1, here, there, M4, slack, walls) else 0
            side = 1 if free_below and meets_once(1, here, there, M4, slack, walls) else side
            return Marched(here, M4, side, there)
        tau, dv, F, G1, G2, G3, s, c = tau + h, next_dv, next_F, next_G1, next_G2, next_G3, next_s, next_c
        v_free, F_free, M4 = next_free, next_F_free, steady4 + at_least_norm(G3_free, w0 * G2_free)
        if K.patient:  # with the free motion gone, steps of their own length go farther
            room = PATIENCE * 6.0 * lift_stride * M4
            if (not has_below or below + dv > room) and (not has_above or above - dv > room):
                return Marched(point(tau, dv, F, G1, G2, G3, s, c, now), M4, 0, now)
        long = looks_free(below + dv, above - dv, F, G1, stride, has_below, has_above)


def point(tau, dv, F, G1, G2, G3, s, c, start):
    """Return a point of a flight whose dx and entire functions nobody asks for."""
    return Flown(tau, start.dx, dv, F, G1, G2, G3, s, c, start.E0, start.E1, start.E2)


def at_least_norm(a, b):
    """Return sqrt(a^2 + b^2) or a little more, without a root."""
    a, b = abs(a), abs(b)
    return a + OCTAGON * b if a > b else b + OCTAGON * a


def looks_free(below, above, F, G1, h, has_below, has_above):
    """Return whether the parabolas of both gaps are positive after a step of length h: a guess, no proof."""
    rise = (F + 0.5 * G1 * h) * h
    return (not has_below or below + rise > 0.0) and (not has_above or above - rise > 0.0)


def stays_open(g0, d0, g1, d1, lift, slack):
    """Return whether a gap is shown to be positive over a step; see the module."""
    begins, ends = g0 > slack and g0 + 0.25 * d0 > slack, g1 > slack and g1 - 0.25 * d1 > slack
    return begins and ends and 0.5 * (g0 + g1) + SIXTH * (d0 - d1) > lift


def opens(d0, b0, g1, d1, lift, slack):
    """Return whether a gap is shown to be positive over a step that begins on the wall, but for its start.

    Without a slope there (d0 = 0) the bend b0 counts, times h^2: the coefficients of the cubic through g0, d0, b0 and
    g1, less t^3 (1 - t) M4 h^4/24, are 0, 0, b0/12, b0/8 + g1/4 - M4 h^4/96 and g1.
    """
    if g1 <= slack:
        return False
    if d0 >= 0.0 and g1 - 0.25 * d1 > slack and 0.5 * g1 + SIXTH * (d0 - d1) > lift:
        return True
    return d0 == 0.0 and b0 >= 0.0 and 0.125 * b0 + 0.25 * g1 > 1.5 * lift


def meets_once(side, now, there, M4, slack, walls):
    """Return whether a gap is surely positive at one point of a flight, negative at the next, and 0 once between."""
    if gap_to(side, there, walls) >= -slack or gap_to(side, now, walls) <= slack:
        return False
    h = there.tau - now.tau
    return crosses_once(-side * now.F, -side * now.G1, -side * there.F, -side * there.G1, M4, h)


def crosses_once(d0, b0, d1, b1, M4, h):
    """Return whether a gap that is positive and then negative at the ends of a step surely has one root between.

    It has if its slope, d0 and d1 at the ends, is negative all the way, or if its bend, b0 and b1, keeps its sign.
    """
    loose = SIXTH * h * h * M4
    falls = d0 < 0.0 and d1 < 0.0 and d0 + 2.0 * SIXTH * h * b0 < 0.0 and 2.0 * d0 + h * b0 + d1 + loose * h < 0.0
    half, bend = 0.5 * (b0 + b1), 1.5 * loose
    return falls or (b0 < 0.0 and b1 < 0.0 and half + bend < 0.0) or (b0 > 0.0 and b1 > 0.0 and half - bend > 0.0)


def within_reach(v0, v_free, F_free, slack, walls, K):
    """Return which walls are near enough to be looked at: the steady amplitude and the transient's energy bound v."""
    energy = F_free * F_free + K.w0sq * v_free * v_free
    room_below, room_above = walls.below - v0 - K.V0 - slack, v0 + walls.above - K.V0 - slack
    return (
        walls.has_below and not (room_below > 0.0 and energy < K.w0sq * room_below * room_below),
        walls.has_above and not (room_above > 0.0 and energy < K.w0sq * room_above * room_above),
    )
