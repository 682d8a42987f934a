"""The cases of Theorem 7: the boundary that a map's flow can graze, and the kind and ends of its
window.

A flow that touches a boundary at the phase theta grazes it iff side (k v + B0 Omega sin theta) > 0.
The side is 1 for the boundary above the domain (a contact from below) and -1 for the one below. The
ends are theta_cr, the arcsine of -k v/(B0 Omega), and pi - theta_cr. Near |k v| = |B0 Omega| the
arcsine turns a rounding error into its square root. So products, comparison, root and arctangent
are done with pairs of doubles (`symosc.kernels.double_double`): every end is within one unit in the
last place.

Scalar arithmetic only: this source runs as CPython floats and compiled by numba.
"""

from __future__ import annotations

from math import ldexp, nan
from typing import NamedTuple

from symosc.base.aliases import Order
from symosc.base.errors import ParameterError
from symosc.friction import MAPS
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


class Place(NamedTuple):
    """The boundary at which the flow of a map can graze.

    Attributes
    ----------
    domain, boundary : int
    side : int
        1 if the boundary is the upper end of the domain, so that the flow touches it from below; -1
        if it is the lower end.
    equation : int
        The number of the map's equation in the paper: 55 to 58.

    Examples
    --------
    >>> from symosc import grazing_window, load_scene
    >>> grazing_window(load_scene("fig9").parameters, "P2").place
    Place(domain=1, boundary=1, side=1, equation=55)
    """

    domain: int
    boundary: int
    side: int  # it grazes where side (gamma + amplitude sin(theta)) > 0
    equation: int


_FIRST_EQUATION = 55
PLACES = {
    row.label: Place(row.domain, row.end.boundary, row.side, _FIRST_EQUATION + i)
    for i, row in enumerate(row for row in MAPS.values() if row.returns)
}
_NO_GRAZING = {
    "P1": "sticks on belt 1",
    "P4": "sticks on belt 2",
    "P7": "leads from v2 to v1",
    "P8": "leads from v1 to v2",
}
ORDERS: tuple[Order, ...] = ("full", "paper")

# What a window is; a wrapped arc goes through 0. EQUALITY_UNDECIDED: rational numbers must decide.
EQUALITY_UNDECIDED = -1
EMPTY = 0
EVERYTHING = 1
ALL_BUT_ONE = 2
ARC = 3
WRAPPED_ARC = 4


def place(mapping: str) -> Place:
    """Return the boundary at which a map can graze.

    Only P2, P3, P5 and P6 return to their boundary.
    """
    if mapping not in PLACES:
        if mapping in _NO_GRAZING:
            reason = f"it {_NO_GRAZING[mapping]}; "
        else:
            reason = ""
        raise ParameterError(
            "mapping", mapping, f"{reason}grazing is defined for {', '.join(PLACES)}"
        )
    return PLACES[mapping]


def window_kind(
    side: int, gamma_sign: int, amplitude_sign: int, excess_sign: int, full: bool
) -> int:
    """Return the kind of window from the signs of gamma, of the amplitude and of |gamma| -
    |amplitude| (the excess).

    Here gamma is k v_lambda/m, the amplitude B0 Omega/m, and the kind a code such as ARC. With
    `full`, the order "full" of `symosc.grazing_window`, a tangency of fourth order counts as a
    graze.
    """
    # At |gamma| = |amplitude| the order 1 excludes one phase. G^(1) = G^(2) = 0 there. G^(3) =
    # -gamma Omega^2 has the sign of a graze at `side` iff the rest of the circle is in the window;
    # then `full` includes the phase.
    level = side * gamma_sign
    if amplitude_sign == 0:
        # with gamma = 0 too, the flow stays in the boundary for ever
        if level > 0:
            return EVERYTHING
        return EMPTY
    if excess_sign < 0:
        if level > 0:
            return WRAPPED_ARC
        return ARC
    if level < 0:
        return EMPTY
    if excess_sign > 0 or full:
        return EVERYTHING
    return ALL_BUT_ONE


def case_label(place: Place, gamma_sign: int, amplitude_sign: int, excess_sign: int) -> str:
    """Return the label of the case with these signs: (55.1) is the first of eq. (55), (55.a) is not
    in the paper.
    """
    # a: gamma has the wrong sign and |gamma| = |amplitude|; b, c: B0 = 0, everything and nothing.
    # B0 < 0 is B0 > 0 half a period later.
    if amplitude_sign == 0:
        return f"({place.equation}.{'b' if place.side * gamma_sign > 0 else 'c'})"
    # By the sign of gamma, then of |gamma| - |amplitude| from -1 to 1.
    below = {1: "123", 0: "4", -1: "5a6"}
    above = {1: "122", 0: "3", -1: "456"}
    number = (below if place.side > 0 else above)[gamma_sign][excess_sign + 1]
    label = f"({place.equation}.{number})"
    if amplitude_sign > 0:
        return label
    return f"{label} shifted by pi"


def window(k, v, B, Omega, side, full):
    """Return a window's kind, its ends low and high, and theta_cr.

    `k`, the belt's speed `v`, `B` (B0) and `Omega` are pairs of doubles, each number being the sum
    of its pair. `side` is that of `Place`, `full` as in `window_kind`. Ends that a kind does not
    have are nan.
    """
    # An ARC reaches from low up to high, both excluded, a WRAPPED_ARC from low through 0 to high.
    # With ALL_BUT_ONE, low = high is the excluded phase. EQUALITY_UNDECIDED: too near |k v| = |B0
    # Omega| for numbers that are no doubles. theta_cr is nan where Theta_cr does not exist.
    # The products p = k v and q = B0 Omega: high and low part, to be multiplied by 2^exponent.
    k_high, k_low = k
    v_high, v_low = v
    B_high, B_low = B
    Omega_high, Omega_low = Omega
    p_high, p_low, p_exponent = scaled_product(k_high, k_low, v_high, v_low)
    q_high, q_low, q_exponent = scaled_product(B_high, B_low, Omega_high, Omega_low)
    p_sign = sign(p_high)
    q_sign = sign(q_high)
    if q_sign == 0:
        return window_kind(side, p_sign, 0, 0, full), nan, nan, nan
    # From here on |p| and |q|, in the units of q. 2^3 is more than the mantissas can make up for;
    # further up only |k v| > |B0 Omega| matters.
    shift = min(p_exponent - q_exponent, 3)
    p_high = ldexp(p_sign * p_high, shift)
    p_low = ldexp(p_sign * p_low, shift)
    q_high = q_sign * q_high
    q_low = q_sign * q_low
    difference, rest = pair_sum(p_high, p_low, -q_high, -q_low)
    if difference != 0.0:
        excess_sign = sign(difference)
    else:
        excess_sign = sign(rest)
    are_doubles = k_low == 0.0 and v_low == 0.0 and B_low == 0.0 and Omega_low == 0.0
    # The product of two doubles is an exact pair. Products of pairs are right to some units of
    # 2^-104: closer to equality than this, rational numbers must decide.
    if not are_doubles and abs(difference) <= 2.0**-98:
        return EQUALITY_UNDECIDED, nan, nan, nan
    kind = window_kind(side, p_sign, q_sign, excess_sign, full)
    slope = -p_sign * q_sign  # sign of sin(theta_cr)
    if excess_sign > 0:
        return kind, nan, nan, nan
    if excess_sign == 0:
        half_pi, _ = HALF_PI
        theta_cr = slope * half_pi
        if kind != ALL_BUT_ONE:
            return kind, nan, nan, theta_cr
        if slope > 0:
            point = half_pi
        else:
            point = THREE_HALVES_PI
        return kind, point, point, theta_cr
    size_high, size_low = pair_asin(p_high, p_low, q_high, q_low)  # |theta_cr|
    # + 0.0: no -0.0
    theta_cr = slope * size_high + 0.0
    theta_low = slope * size_low
    turned, _ = pair_sum(PI_PAIR[0], PI_PAIR[1], -theta_cr, -theta_low)  # pi - theta_cr
    wrapped, _ = pair_sum(TWO_PI_PAIR[0], TWO_PI_PAIR[1], theta_cr, theta_low)  # 2 pi + theta_cr
    # The window is where sin(theta) is above sin(theta_cr), or below it.
    if side * q_sign > 0:
        return kind, (wrapped if theta_cr < 0.0 else theta_cr), turned, theta_cr
    return kind, turned, (theta_cr if theta_cr > 0.0 else wrapped), theta_cr


def windows(pairs, side, full, columns):
    """Fill `columns` (kind, low, high, theta_cr) by `window`, row by row.

    `pairs` are arrays: high and low parts of k, of v, of B and of Omega.
    """
    kh, kl, vh, vl, Bh, Bl, Oh, Ol = pairs
    kind, low, high, theta_cr = columns
    for i in range(len(kind)):
        k = (kh[i], kl[i])
        v = (vh[i], vl[i])
        B = (Bh[i], Bl[i])
        Omega = (Oh[i], Ol[i])
        kind[i], low[i], high[i], theta_cr[i] = window(k, v, B, Omega, side, full)
