"""The first root of a polynomial that is known within a noise, on [0, 1]: no root is passed over.

If the Bernstein coefficients on an interval all exceed the noise, there is no root in it. If the polynomial falls from
above the noise to below it with one change of sign, there is exactly one. If its slope changes sign exactly once, from
falling to rising, the value at the bottom decides. Above the noise there is no root, below it there are two, of which
the first one counts. Within the noise it is a touch. Otherwise the interval is divided; what is still open at the
smallest width is a touch too.

The functions are scalar and run on floats and on mpmath numbers.
"""

from __future__ import annotations

from itertools import pairwise
from math import comb

from symosc.aliases import Number

# Where an interval is divided: not a fraction at which roots like to be.
CUT = 0.4831
# The smallest interval: where the slope has several roots nearer to each other than this, it is a touch.
NARROWEST = 2.0**-60
# Newton's method halves its bracket at worst: enough for thousands of digits.
MOST_ROOT_STEPS = 20_000


def first_root(p: list[Number], noise: Number, eps: Number) -> tuple[bool, Number]:
    """Return (touch, sigma) for the first root in (0, 1] of a polynomial known within `noise`; sigma None: no root.

    `touch` says that the polynomial comes to 0 within the noise, and whether it passes is open.
    """
    if p[0] - sum(abs(term) for term in p[1:]) > noise:
        return False, None
    one = 1 + 0 * p[0]
    slope = [k * term for k, term in enumerate(p)][1:]
    narrowest = max(eps**0.5 / 16, NARROWEST)
    stack = [(0 * one, one, bernstein(p))]
    while stack:
        low, high, b = stack.pop()
        if min(b) > noise:
            continue
        if b[0] > noise and b[-1] < -noise and _changes(b, noise) == 1 and _changes(b, -noise) == 1:
            return False, _newton(p, slope, low, high, eps)
        if _has_one_bottom(b):
            bottom = _newton([-term for term in slope], [-k * q for k, q in enumerate(slope)][1:], low, high, eps)
            value = _value(p, bottom)
            if value > noise:
                continue
            if b[0] > noise and value < -noise:
                return False, _newton(p, slope, low, bottom, eps)
            return True, bottom
        if high - low < narrowest:
            return True, 0.5 * (low + high)
        left, right = _divided(b)
        middle = low + CUT * (high - low)
        stack += [(middle, high, right), (low, middle, left)]
    return False, None


def bernstein(p: list[Number]) -> list[Number]:
    """Return the Bernstein coefficients on [0, 1] of a polynomial in powers."""
    n = len(p) - 1
    row = [term / comb(n, j) for j, term in enumerate(p)]
    coefficients = []
    while row:  # a table of sums: b_i = sum_j comb(i, j) row_j
        coefficients.append(row[0])
        row = [first + second for first, second in pairwise(row)]
    return coefficients


def _divided(b: list[Number]) -> tuple[list[Number], list[Number]]:
    left, right, row = [b[0]], [b[-1]], b
    while len(row) > 1:
        row = [first + CUT * (second - first) for first, second in pairwise(row)]
        left.append(row[0])
        right.append(row[-1])
    return left, right[::-1]


def _changes(b: list[Number], level: Number) -> int:
    signs = [value > level for value in b]
    return sum(first != second for first, second in pairwise(signs))


def _has_one_bottom(b: list[Number]) -> bool:
    """Return whether the slope changes sign once, from falling to rising."""
    rising = [second > first for first, second in pairwise(b)]
    return len(rising) > 1 and not rising[0] and rising[-1] and sum(a != c for a, c in pairwise(rising)) == 1


def _value(p: list[Number], sigma: Number) -> Number:
    value = 0 * sigma
    for term in reversed(p):
        value = value * sigma + term
    return value


def _newton(p: list[Number], slope: list[Number], low: Number, high: Number, eps: Number) -> Number:
    """Return the root of p, positive at `low` and negative at `high`, by Newton's method kept inside the bracket.

    Only steps of Newton's method can show that it has converged. A step that leaves the bracket is replaced by a
    halving, whose length says nothing.
    """
    sigma = 0.5 * (low + high)
    before, settled = high - low, eps**0.75
    for _ in range(MOST_ROOT_STEPS):
        value, rise = _value(p, sigma), _value(slope, sigma)
        if value > 0:
            low = sigma
        else:
            high = sigma
        shift = -value / rise if rise != 0 else high - low
        if abs(shift) <= eps * sigma or (before <= abs(shift) <= settled * sigma):
            return sigma
        if low < sigma + shift < high:
            sigma, before = sigma + shift, abs(shift)
        else:
            following = 0.5 * (low + high)
            if following in (low, high):
                return sigma
            sigma = following
    return sigma
