"""Marching along a flight in fixed steps, which cost no exp, sin or cos.

A part of `symosc.engine.first_exit`, with the same bound. All functions are scalar and run on floats (CPython, numba)
and, with other globals, on mpmath numbers.
"""

from __future__ import annotations

from math import sqrt

from symosc.engine.gap_bounds import gap_polynomial, positive_on
from symosc.engine.state import Flown
from symosc.kernels.entire import SIXTH

# What a gap must exceed while marching, as a part of its size.
MARCH_SLACK = 1e-10
# A gap of so many times what a stride needs (its fourth power counts) allows a step of 50 strides.
PATIENCE = 6e6


def march(tau_max, v0, now, M4, walls, margin, K):
    """Pass over times without a contact in whole fixed steps: the bound of `first_exit`, at a fraction of its cost.

    Over a fixed step the transient is multiplied by a constant matrix and the steady state turns by a constant angle,
    so the derivatives cost no exp, sin or cos. Their rounding errors are far below the slack that the gaps are given.
    Where the bound allows it, steps are strides.

    Returns
    -------
    (now, M4)
        The flight at a time up to which no wall is met, without dx and the entire functions, and the bound there.
    """
    M, long, stride = K.march, False, K.stride.step
    cm, w0sq, Om, Ss, Sc = K.cm, K.w0sq, K.Om, K.Ss, K.Sc
    Om2 = Om * Om
    Om3, Om4, steady4 = Om2 * Om, Om2 * Om2, K.V0 * Om2 * Om2
    tau, dv, F, G1, G2, G3, s, c = now.tau, now.dv, now.F, now.G1, now.G2, now.G3, now.s, now.c
    below, above, _, _, on_below, on_above = walls
    v_steady, u_steady = Ss * s + Sc * c, Ss * c - Sc * s
    v_free, F_free = v0 - v_steady, F - Om * u_steady
    slack = MARCH_SLACK * (abs(v0) + K.V0 + abs(v_free) + abs(F_free) * K.swing) + margin
    has_below, has_above = within_reach(v0, v_free, F_free, slack, walls, K)
    reach = 0.25 * SIXTH * (stride * stride) * (stride * stride)
    while tau + M.step < tau_max:
        free = True
        if has_below:
            p0, p1, p2, p3, p4, degree = gap_polynomial(below + dv, F, G1, G2, M4, on_below and tau == 0.0)
            free = positive_on(M.step, p0 - slack if degree == 4 else p0, p1, p2, p3, p4)
        if has_above and free:
            p0, p1, p2, p3, p4, degree = gap_polynomial(above - dv, -F, -G1, -G2, M4, on_above and tau == 0.0)
            free = positive_on(M.step, p0 - slack if degree == 4 else p0, p1, p2, p3, p4)
        if not free:
            if not long:
                break
            M, long = K.march, False
            continue
        tau = tau + M.step
        v_free, F_free = M.C * v_free + M.E1 * F_free, M.D * v_free + M.E0 * F_free
        s, c = M.c * s + M.s * c, M.c * c - M.s * s
        v_steady, u_steady = Ss * s + Sc * c, Ss * c - Sc * s
        G1_free = -cm * F_free - w0sq * v_free
        G2_free = -cm * G1_free - w0sq * F_free
        G3_free = -cm * G2_free - w0sq * G1_free
        M4 = steady4 + sqrt(G3_free * G3_free + w0sq * G2_free * G2_free)
        dv = v_free + v_steady - v0
        F, G1, G2 = F_free + Om * u_steady, G1_free - Om2 * v_steady, G2_free - Om3 * u_steady
        G3 = G3_free + Om4 * v_steady
        least = reach * M4
        if K.patient:  # with the free motion gone, steps of their own length go farther
            room = PATIENCE * least
            if (not has_below or below + dv > room) and (not has_above or above - dv > room):
                break
        long = (
            tau + stride < tau_max
            and (not has_below or below + dv + min(F, 0.0) * stride > least)
            and (not has_above or above - dv - max(F, 0.0) * stride > least)
        )
        M = K.stride if long else K.march
    return Flown(tau, now.dx, dv, F, G1, G2, G3, s, c, now.E0, now.E1, now.E2), M4


def within_reach(v0, v_free, F_free, slack, walls, K):
    """Return which walls are near enough to be looked at: the steady amplitude and the transient's energy bound v."""
    energy = F_free * F_free + K.w0sq * v_free * v_free
    room_below, room_above = walls.below - v0 - K.V0 - slack, v0 + walls.above - K.V0 - slack
    return (
        walls.has_below and not (room_below > 0.0 and energy < K.w0sq * room_below * room_below),
        walls.has_above and not (room_above > 0.0 and energy < K.w0sq * room_above * room_above),
    )
