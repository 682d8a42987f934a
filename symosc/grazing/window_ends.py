"""Theorem 7 in double precision: the window of one map, for sweeps over many parameter sets.

A flow that touches a boundary at the phase theta grazes it iff side (k v + B0 Omega sin theta) > 0. The side is 1 for
the boundary above the domain (a contact from below) and -1 for the one below. The ends are theta_cr, the arcsine of
-k v/(B0 Omega), and pi - theta_cr. Near |k v| = |B0 Omega| the arcsine turns a rounding error into its square root. So
products, comparison, root and arctangent are done with pairs of doubles (`symosc.kernels.double_double`): every end is
within one unit in the last place.

Scalar arithmetic only: this source runs as CPython floats and compiled by numba.
"""

from __future__ import annotations

from math import ldexp, nan

from symosc.kernels.double_double import (
    HALF_PI,
    PI_PAIR,
    THREE_HALVES_PI,
    TWO_PI_PAIR,
    pair_asin,
    pair_sum,
    scaled_product,
    sign,
)
from symosc.mappings.theorem7_cases import ALL_BUT_ONE, EQUALITY_IN_DOUBT, window_kind

# Products of pairs are right to some units of 2^-104: closer to equality than this, rational numbers must decide.
DOUBT = 2.0**-98


def window(k, v, B, Omega, side, full):
    """Return (kind, low, high, theta_cr) of the window; k, v, B and Omega are pairs.

    An ARC reaches from low up to high, both excluded, a WRAPPED_ARC from low through 0 to high. With ALL_BUT_ONE,
    low = high is the excluded phase. EQUALITY_IN_DOUBT: too near |k v| = |B0 Omega| for numbers that are no doubles.
    theta_cr is nan where Theta_cr does not exist.
    """
    ph, pl, pe = scaled_product(k[0], k[1], v[0], v[1])
    qh, ql, qe = scaled_product(B[0], B[1], Omega[0], Omega[1])
    p_sign, q_sign = sign(ph), sign(qh)
    if q_sign == 0:
        return window_kind(side, p_sign, 0, 0, full), nan, nan, nan
    # 2^3 is more than the mantissas can make up for; further up only |k v| > |B0 Omega| matters.
    shift = min(pe - qe, 3)
    ph, pl = ldexp(p_sign * ph, shift), ldexp(p_sign * pl, shift)
    qh, ql = q_sign * qh, q_sign * ql
    difference, rest = pair_sum(ph, pl, -qh, -ql)
    excess_sign = sign(difference) if difference != 0.0 else sign(rest)
    exact = k[1] == 0.0 and v[1] == 0.0 and B[1] == 0.0 and Omega[1] == 0.0
    if not exact and abs(difference) <= DOUBT:
        return EQUALITY_IN_DOUBT, nan, nan, nan
    kind = window_kind(side, p_sign, q_sign, excess_sign, full)
    slope = -p_sign * q_sign  # sign of sin(theta_cr)
    if excess_sign > 0:
        return kind, nan, nan, nan
    if excess_sign == 0:
        theta_cr = slope * HALF_PI[0]
        if kind != ALL_BUT_ONE:
            return kind, nan, nan, theta_cr
        point = HALF_PI[0] if slope > 0 else THREE_HALVES_PI
        return kind, point, point, theta_cr
    ah, al = pair_asin(ph, pl, qh, ql)
    ah, al = slope * ah + 0.0, slope * al  # no -0.0
    turned, _ = pair_sum(PI_PAIR[0], PI_PAIR[1], -ah, -al)  # pi - theta_cr
    wrapped, _ = pair_sum(TWO_PI_PAIR[0], TWO_PI_PAIR[1], ah, al)  # 2 pi + theta_cr
    if side * q_sign > 0:  # sin(theta) > sin(theta_cr)
        return kind, (wrapped if ah < 0.0 else ah), turned, ah
    return kind, turned, (ah if ah > 0.0 else wrapped), ah


def windows(pairs, side, full, columns):
    """Fill the arrays kind, low, high and theta_cr from four pairs of arrays (k, v, B0, Omega), all of one length."""
    kh, kl, vh, vl, Bh, Bl, Oh, Ol = pairs
    kind, low, high, theta_cr = columns
    for i in range(len(kind)):
        k, v, B, Omega = (kh[i], kl[i]), (vh[i], vl[i]), (Bh[i], Bl[i]), (Oh[i], Ol[i])
        kind[i], low[i], high[i], theta_cr[i] = window(k, v, B, Omega, side, full)
