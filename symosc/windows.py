"""Theorem 7 in double precision: the window of one map, for sweeps over many parameter sets.

A flow that touches a boundary at the phase theta grazes it iff side (k v + B0 Omega sin theta) > 0, with side = 1 for a
contact from below and -1 for one from above. The ends are theta_cr = asin(-k v/(B0 Omega)) and
pi - theta_cr. Near |k v| = |B0 Omega| the arcsine turns a rounding error into its square root, so products, comparison,
root and arctangent are done with pairs of doubles (hi + lo): every end is within one unit in the last place.

Scalar arithmetic only: this source runs as CPython floats and compiled by numba.
"""

from __future__ import annotations

from math import frexp, ldexp, nan, sqrt
from typing import Any, NamedTuple

from symosc.errors import ParameterError
from symosc.model import Parameters


class Place(NamedTuple):
    """Where the flow of a map touches a boundary.

    Attributes
    ----------
    domain, boundary : int
    side : int
        1 for a contact from below, -1 for one from above.
    equation : int
        Its number in the paper: 55 to 58.
    """

    domain: int
    boundary: int
    side: int  # 1: from below, 0 < gamma + amplitude sin(theta); -1: from above, the opposite
    equation: int


PLACES = {"P2": Place(1, 1, 1, 55), "P3": Place(2, 1, -1, 56), "P5": Place(2, 2, 1, 57), "P6": Place(3, 2, -1, 58)}

_NO_GRAZING = {
    "P1": "sticks on belt 1",
    "P4": "sticks on belt 2",
    "P7": "leads from v2 to v1",
    "P8": "leads from v1 to v2",
}

ORDERS = ("full", "paper")

# What a window is; a wrapped arc goes through 0.
IN_DOUBT, EMPTY, EVERYTHING, ALL_BUT_ONE, ARC, WRAPPED_ARC = -1, 0, 1, 2, 3, 4


def place(mapping: str) -> Place:
    """Return where the flow of a map touches a boundary.

    Raises
    ------
    ParameterError
        If the map has no grazing (only P2, P3, P5 and P6 return to the boundary that they left).
    """
    if not isinstance(mapping, str) or mapping not in PLACES:
        reason = f"it {_NO_GRAZING[mapping]}; " if isinstance(mapping, str) and mapping in _NO_GRAZING else ""
        raise ParameterError("mapping", mapping, f"{reason}grazing is defined for {', '.join(PLACES)}")
    return PLACES[mapping]


def check_parameters(p: Any) -> Parameters:
    """Return `p` if it is a set of parameters."""
    if not isinstance(p, Parameters):
        shown = p if isinstance(p, str | int | float | None) else type(p).__name__
        raise ParameterError("p", shown, "must be Parameters; those of a scene are load_scene(name).parameters")
    return p


def check_order(order: str) -> str:
    """Return `order` if it is "full" or "paper", the two readings of Theorem 7."""
    if not isinstance(order, str) or order not in ORDERS:
        raise ParameterError("order", order, f"must be one of {', '.join(ORDERS)}")
    return order


def window_kind(side: int, gamma_sign: int, amplitude_sign: int, excess_sign: int, full: bool) -> int:
    """Return what the window is from the signs of gamma, the amplitude and |gamma| - |amplitude|.

    At |gamma| = |amplitude| the order 1 excludes one phase. G^(1) = G^(2) = 0 there and G^(3) = -gamma Omega^2 has the
    sign of a graze from `side` iff the rest of the circle is in the window: `full` includes it.
    """
    level = side * gamma_sign
    if amplitude_sign == 0:
        return EVERYTHING if level > 0 else EMPTY  # with gamma = 0 too, the flow stays in the boundary for ever
    if excess_sign < 0:
        return WRAPPED_ARC if level > 0 else ARC
    if level < 0:
        return EMPTY
    return EVERYTHING if excess_sign > 0 or full else ALL_BUT_ONE


def case_label(place: Place, gamma_sign: int, amplitude_sign: int, excess_sign: int) -> str:
    """Return the paper's case: (55.1) is the first of (55). Letters are cases that the paper lacks.

    a: gamma has the wrong sign and |gamma| = |amplitude|; b, c: B0 = 0, everything and nothing. B0 < 0 is B0 > 0
    half a period later.
    """
    if amplitude_sign == 0:
        return f"({place.equation}.{'b' if place.side * gamma_sign > 0 else 'c'})"
    # By the sign of gamma, then of |gamma| - |amplitude| from -1 to 1.
    below, above = {1: "123", 0: "4", -1: "5a6"}, {1: "122", 0: "3", -1: "456"}
    number = (below if place.side > 0 else above)[gamma_sign][excess_sign + 1]
    label = f"({place.equation}.{number})"
    return label if amplitude_sign > 0 else f"{label} shifted by pi"


# --- pairs of doubles: a number is the unevaluated sum hi + lo with |lo| at most half a unit of hi ---

SPLITTER = 134217729.0  # 2^27 + 1 (Veltkamp)
HALF_PI = (1.5707963267948966, 6.123233995736766e-17)
PI = (3.141592653589793, 1.2246467991473532e-16)
TWO_PI = (6.283185307179586, 2.4492935982947064e-16)
THREE_HALVES_PI = 4.71238898038469
# atan(j/8), j = 0 to 8
ATAN_HI = (
    0.0,
    0.12435499454676144,
    0.24497866312686414,
    0.35877067027057225,
    0.4636476090008061,
    0.5585993153435624,
    0.6435011087932844,
    0.7188299996216245,
    0.7853981633974483,
)
ATAN_LO = (
    0.0,
    -3.1253241424539383e-18,
    1.0698755618734451e-17,
    -2.4623815582638635e-17,
    2.2698777452961687e-17,
    -5.4556305485916264e-18,
    1.5834785051444286e-17,
    -2.1478388444456983e-17,
    3.061616997868383e-17,
)
# Products of pairs are right to some units of 2^-104: closer to equality than this, rational numbers must decide.
DOUBT = 2.0**-98


def two_sum(a, b):
    """Return (s, e): s = a + b rounded and e its error (Knuth)."""
    s = a + b
    rest = s - a
    return s, (a - (s - rest)) + (b - rest)


def fast_sum(a, b):
    """Return two_sum for |a| >= |b| (Dekker)."""
    s = a + b
    return s, b - (s - a)


def two_product(a, b):
    """Return (p, e): p = a b rounded and e its error (Dekker)."""
    p = a * b
    big = SPLITTER * a
    ah = big - (big - a)
    big = SPLITTER * b
    bh = big - (big - b)
    al, bl = a - ah, b - bh
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


def pair_sum(ah, al, bh, bl):
    """Return a + b for pairs; the error is relative to the result, cancellation or not, when a and b are exact."""
    s, e = two_sum(ah, bh)
    t, f = two_sum(al, bl)
    s, e = fast_sum(s, e + t)
    return fast_sum(s, e + f)


def pair_product(ah, al, bh, bl):
    """Return a b for pairs; exact for two doubles."""
    p, e = two_product(ah, bh)
    return fast_sum(p, e + (ah * bl + al * bh))


def pair_quotient(ah, al, bh, bl):
    """Return a/b for pairs."""
    q = ah / bh
    ph, pl = pair_product(q, 0.0, bh, bl)
    rh, _ = pair_sum(ah, al, -ph, -pl)
    return fast_sum(q, rh / bh)


def pair_root(ah, al):
    """Return the square root of a pair > 0."""
    root = sqrt(ah)
    ph, pl = two_product(root, root)
    rh, _ = pair_sum(ah, al, -ph, -pl)
    return fast_sum(root, rh / (2.0 * root))


def pair_atan(yh, yl, xh, xl):
    """Return atan(y/x) for pairs 0 <= y <= x: atan(j/8) from the table plus the series of the rest, up to 1/16."""
    j = int(8.0 * (yh / xh) + 0.5)
    node = 0.125 * j
    # atan(y/x) - atan(node) = atan((y - node x)/(x + node y))
    ph, pl = pair_product(xh, xl, node, 0.0)
    qh, ql = pair_product(yh, yl, node, 0.0)
    ph, pl = pair_sum(yh, yl, -ph, -pl)
    qh, ql = pair_sum(xh, xl, qh, ql)
    zh, zl = pair_quotient(ph, pl, qh, ql)
    q = zh * zh
    tail = q * (1 / 5 - q * (1 / 7 - q * (1 / 9 - q * (1 / 11 - q * (1 / 13 - q * (1 / 15))))))
    zh, zl = fast_sum(zh, zl - zh * q * (1 / 3 - tail))
    return pair_sum(ATAN_HI[j], ATAN_LO[j], zh, zl)


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
    """Return a b for pairs as (hi, lo, exponent): the product is (hi + lo) 2^exponent, 1/4 <= |hi| <= 1 or hi = 0."""
    ah, ae = frexp(ah)
    bh, be = frexp(bh)
    if al != 0.0:
        al = ldexp(al, -ae)
    if bl != 0.0:
        bl = ldexp(bl, -be)
    h, e = pair_product(ah, al, bh, bl)
    return h, e, ae + be


def sign(value):
    """Return -1, 0 or 1."""
    return (1 if value > 0.0 else 0) - (1 if value < 0.0 else 0)


def window(kh, kl, vh, vl, Bh, Bl, Oh, Ol, side, full):
    """Return (kind, low, high, theta_cr) of the window; k, v, B0 and Omega are pairs.

    An ARC reaches from low up to high, both excluded, a WRAPPED_ARC from low through 0 to high. With ALL_BUT_ONE,
    low = high is the excluded phase. IN_DOUBT: too near |k v| = |B0 Omega| for numbers that are no doubles.
    theta_cr is nan where Theta_cr does not exist.
    """
    ph, pl, pe = scaled_product(kh, kl, vh, vl)
    qh, ql, qe = scaled_product(Bh, Bl, Oh, Ol)
    p_sign, q_sign = sign(ph), sign(qh)
    if q_sign == 0:
        return window_kind(side, p_sign, 0, 0, full), nan, nan, nan
    # 2^3 is more than the mantissas can make up for; further up only |k v| > |B0 Omega| matters.
    shift = min(pe - qe, 3)
    ph, pl = ldexp(p_sign * ph, shift), ldexp(p_sign * pl, shift)
    qh, ql = q_sign * qh, q_sign * ql
    difference, rest = pair_sum(ph, pl, -qh, -ql)
    excess_sign = sign(difference) if difference != 0.0 else sign(rest)
    exact = kl == 0.0 and vl == 0.0 and Bl == 0.0 and Ol == 0.0
    if not exact and abs(difference) <= DOUBT:
        return IN_DOUBT, nan, nan, nan
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
    turned, _ = pair_sum(PI[0], PI[1], -ah, -al)  # pi - theta_cr
    wrapped, _ = pair_sum(TWO_PI[0], TWO_PI[1], ah, al)  # 2 pi + theta_cr
    if side * q_sign > 0:  # sin(theta) > sin(theta_cr)
        return kind, (wrapped if ah < 0.0 else ah), turned, ah
    return kind, turned, (ah if ah > 0.0 else wrapped), ah


def windows(kh, kl, vh, vl, Bh, Bl, Oh, Ol, side, full, kind, low, high, theta_cr):
    """Fill the arrays kind, low, high and theta_cr from arrays of pairs, all of one length."""
    for i in range(len(kind)):
        kind[i], low[i], high[i], theta_cr[i] = window(
            kh[i], kl[i], vh[i], vl[i], Bh[i], Bl[i], Oh[i], Ol[i], side, full
        )
