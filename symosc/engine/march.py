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
from symosc.engine.flow import derivatives
from symosc.engine.gap_bounds import fourth_derivative_bound, gap_to
from symosc.engine.state import Flown, Walls
from symosc.kernels._generated import next_derivative
from symosc.kernels.entire import SIXTH

# What a gap must exceed while marching, as a part of its size.
MARCH_SLACK = 1e-10
# A gap of so many times what a stride needs (its fourth power counts) allows a step of 50 strides.
PATIENCE = 6e6


class Marched(NamedTuple):
    """Where a march ended."""

    now: Flown  # up to there no wall is met; without dx and the entire functions
    M4: Number  # the bound of the fourth derivative from there on
    side: int  # of the wall that is met in the next step, there once and for sure; 0: the next step is not decided
    there: Flown  # the end of that step, without its last two derivatives (`whole`)


def march(tau_max, v0, now, walls, margin, K):
    """Pass over times without a contact in whole fixed steps: the bound of `first_exit`, at a fraction of its cost.

    Over a fixed step the transient is multiplied by a constant matrix and the steady state turns by a constant angle,
    so the derivatives cost no exp, sin or cos. Their rounding errors are far below the slack that the gaps are given.
    Strides are tried where the gaps look wide enough.

    Returns
    -------
    Marched
    """
    v_free, F_free = v0 - (K.Ss * now.s + K.Sc * now.c), now.F - K.Om * (K.Ss * now.c - K.Sc * now.s)
    slack = MARCH_SLACK * (abs(v0) + K.V0 + abs(v_free) + abs(F_free) * K.swing) + margin
    walls = within_reach(v0, v_free, F_free, slack, walls, K)
    M4, since, stride = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K), now.tau, K.stride.step
    long, patience = looks_free(now, stride, walls), PATIENCE * 0.25 * SIXTH * (stride * stride) * (stride * stride)
    while True:
        M = K.stride if long else K.march
        h, there, free_below, free_above = M.step, now, False, False
        if now.tau + h < tau_max:
            v_next, F_next = M.C * v_free + M.E1 * F_free, M.D * v_free + M.E0 * F_free
            s, c = M.c * now.s + M.s * now.c, M.c * now.c - M.s * now.s
            dv, F = v_next + (K.Ss * s + K.Sc * c) - v0, F_next + K.Om * (K.Ss * c - K.Sc * s)
            G1 = next_derivative(F, v0 + dv, K.fB * s, K.cm, K.w0sq)
            there = Flown(now.tau + h, now.dx, dv, F, G1, now.G2, now.G3, s, c, now.E0, now.E1, now.E2)
            lift = 0.25 * SIXTH * SIXTH * (h * h) * (h * h) * M4 + slack
            free_below = not walls.has_below or is_free(-1, now, there, lift, slack, walls)
            free_above = not walls.has_above or is_free(1, now, there, lift, slack, walls)
        if free_below and free_above:
            now, v_free, F_free = there, v_next, F_next
            long = looks_free(now, stride, walls)
            if not K.patient:
                continue
        elif not long and (since == now.tau or not are_wider(0.0, there, walls)):
            now = whole(now, v0, K)
            M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
            side = -1 if free_above and meets_once(-1, now, there, M4, slack, walls) else 0
            side = 1 if free_below and meets_once(1, now, there, M4, slack, walls) else side
            return Marched(now, M4, side, there)
        else:
            long = False
        if since < now.tau:  # the bound never grows: until here one of an earlier time was good enough
            now, since = whole(now, v0, K), now.tau
            M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
        # with the free motion gone, steps of their own length go farther
        if K.patient and are_wider(patience * M4, now, walls):
            return Marched(now, M4, 0, now)


def whole(now, v0, K):
    """Return a point of a flight with all its derivatives; its launch has them, and knows which are exactly 0."""
    if now.tau == 0.0:
        return now
    tau, dx, dv, F, _, _, _, s, c, E0, E1, E2 = now
    G1, G2, G3 = derivatives(v0 + dv, F, s, c, K)
    return Flown(tau, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2)


def looks_free(now, h, walls):
    """Return whether the parabolas of both gaps are positive after a step of length h: a guess, no proof."""
    dv = now.dv + (now.F + 0.5 * now.G1 * h) * h
    return (not walls.has_below or walls.below + dv > 0.0) and (not walls.has_above or walls.above - dv > 0.0)


def are_wider(least, now, walls):
    """Return whether the gaps to the walls around are wider than that."""
    dv = now.dv
    return (not walls.has_below or walls.below + dv > least) and (not walls.has_above or walls.above - dv > least)


def is_free(side, now, there, lift, slack, walls):
    """Return whether a wall is surely not met over a step, at its start apart if that is on the wall."""
    h, room = there.tau - now.tau, walls.below if side < 0 else walls.above
    g0, d0, g1, d1 = room - side * now.dv, -side * h * now.F, room - side * there.dv, -side * h * there.F
    if now.tau == 0.0 and (walls.on_below if side < 0 else walls.on_above):
        return opens(d0, -side * h * h * now.G1, g1, d1, lift, slack)
    return stays_open(g0, d0, g1, d1, lift, slack)


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
    """Return the walls without those too far away: the steady amplitude and the energy of the transient bound v."""
    energy = F_free * F_free + K.w0sq * v_free * v_free
    room_below, room_above = walls.below - v0 - K.V0 - slack, v0 + walls.above - K.V0 - slack
    return Walls(
        walls.below,
        walls.above,
        walls.has_below and not (room_below > 0.0 and energy < K.w0sq * room_below * room_below),
        walls.has_above and not (room_above > 0.0 and energy < K.w0sq * room_above * room_above),
        walls.on_below,
        walls.on_above,
    )
