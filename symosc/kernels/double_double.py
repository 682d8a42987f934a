"""Pairs of doubles: a number is the unevaluated sum hi + lo with |lo| at most half a unit of hi.

This file is executed with other globals: see symosc/kernels/rebind.py.

Scalar arithmetic only: this source runs as CPython floats and compiled by numba.
"""

from __future__ import annotations

from math import frexp, ldexp, sqrt

SPLITTER = 134217729.0  # 2^27 + 1 (Veltkamp)
HALF_PI = (1.5707963267948966, 6.123233995736766e-17)
PI_PAIR = (3.141592653589793, 1.2246467991473532e-16)
TWO_PI_PAIR = (6.283185307179586, 2.4492935982947064e-16)
THREE_HALVES_PI = 4.71238898038469
# atan(j/8), j = 0 to 8
ATAN = (
    (0.0, 0.0),
    (0.12435499454676144, -3.1253241424539383e-18),
    (0.24497866312686414, 1.0698755618734451e-17),
    (0.35877067027057225, -2.4623815582638635e-17),
    (0.4636476090008061, 2.2698777452961687e-17),
    (0.5585993153435624, -5.4556305485916264e-18),
    (0.6435011087932844, 1.5834785051444286e-17),
    (0.7188299996216245, -2.1478388444456983e-17),
    (0.7853981633974483, 3.061616997868383e-17),
)


def two_sum(a, b):
    """Return (s, e): the rounded sum s of the doubles a and b, and its rounding error e (Knuth)."""
    s = a + b
    rest = s - a
    return s, (a - (s - rest)) + (b - rest)


def fast_sum(a, b):
    """Return (s, e) as `two_sum` does, in fewer operations, if |a| >= |b| (Dekker)."""
    s = a + b
    return s, b - (s - a)


def two_product(a, b):
    """Return (p, e): the rounded product p of the doubles a and b, and its rounding error e
    (Dekker).
    """
    # Each factor is split into halves whose products are exact.
    p = a * b
    big = SPLITTER * a
    ah = big - (big - a)
    big = SPLITTER * b
    bh = big - (big - b)
    al = a - ah
    bl = b - bh
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


def pair_sum(ah, al, bh, bl):
    """Return the sum of the pairs ah + al and bh + bl as a pair.

    It has all its digits even after cancellation.
    """
    s, e = two_sum(ah, bh)
    t, f = two_sum(al, bl)
    s, e = fast_sum(s, e + t)
    return fast_sum(s, e + f)


def pair_product(ah, al, bh, bl):
    """Return the product of the pairs ah + al and bh + bl as a pair.

    It is exact for two doubles.
    """
    p, e = two_product(ah, bh)
    return fast_sum(p, e + (ah * bl + al * bh))


def pair_quotient(ah, al, bh, bl):
    """Return the quotient of the pairs ah + al and bh + bl as a pair."""
    q = ah / bh
    p, e = two_product(q, bh)
    rest = ((ah - p) - e) + (al - q * bl)  # the first difference is exact
    return fast_sum(q, rest / bh)


def pair_root(ah, al):
    """Return the square root of the pair ah + al > 0 as a pair."""
    root = sqrt(ah)
    ph, pl = two_product(root, root)
    rh, _ = pair_sum(ah, al, -ph, -pl)
    return fast_sum(root, rh / (2.0 * root))


def pair_atan(yh, yl, xh, xl):
    """Return atan(y/x) for pairs 0 <= y <= x, by atan(j/8) with j/8 near y/x and a series for the
    difference.
    """
    j = int(8.0 * (yh / xh) + 0.5)
    node = 0.125 * j
    # atan(y/x) - atan(node) = atan((y - node x)/(x + node y))
    ph, pl = pair_product(xh, xl, node, 0.0)
    qh, ql = pair_product(yh, yl, node, 0.0)
    ph, pl = pair_sum(yh, yl, -ph, -pl)
    qh, ql = pair_sum(xh, xl, qh, ql)
    zh, zl = pair_quotient(ph, pl, qh, ql)
    q = zh * zh
    # The series z - z^3/3 + z^5/5 - ...: only its first term needs a pair.
    tail = q * (1 / 5 - q * (1 / 7 - q * (1 / 9 - q * (1 / 11 - q * (1 / 13 - q * (1 / 15))))))
    zh, zl = fast_sum(zh, zl - zh * q * (1 / 3 - tail))
    ah, al = ATAN[j]
    return pair_sum(ah, al, zh, zl)


def pair_asin(yh, yl, rh, rl):
    """Return asin(y/r) for pairs 0 <= y < r, by the arctangent of y and sqrt((r - y)(r + y))."""
    dh, dl = pair_sum(rh, rl, -yh, -yl)
    sh, sl = pair_sum(rh, rl, yh, yl)
    xh, xl = pair_product(dh, dl, sh, sl)
    xh, xl = pair_root(xh, xl)
    if yh <= xh:
        return pair_atan(yh, yl, xh, xl)
    ah, al = pair_atan(xh, xl, yh, yl)
    return pair_sum(HALF_PI[0], HALF_PI[1], -ah, -al)


def scaled_product(ah, al, bh, bl):
    """Return a b for pairs as (hi, lo, exponent): the product is (hi + lo) 2^exponent, 1/4 <= |hi|
    <= 1 or hi = 0.
    """
    ah, ae = frexp(ah)
    bh, be = frexp(bh)
    if al != 0.0:
        al = ldexp(al, -ae)
    if bl != 0.0:
        bl = ldexp(bl, -be)
    h, e = pair_product(ah, al, bh, bl)
    return h, e, ae + be


def sign(value):
    """Return the sign of a number as -1, 0 or 1."""
    return (1 if value > 0.0 else 0) - (1 if value < 0.0 else 0)
