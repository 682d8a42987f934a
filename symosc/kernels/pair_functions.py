"""Square root, exponential, sine and cosine of double-double numbers, for numba.

Each is the overload of the function of `math` with that name for `symosc.kernels.pair_type`. The errors that the
docstrings state are the largest that were measured against mpmath, over all arguments that they speak of
(`tests/kernels/test_pair_functions.py`); a unit is 2^-106 = 1.2e-32. Tables and coefficients are made when a function
is compiled: exact rational numbers, or mpmath's with 70 digits, rounded once.
"""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numba
import numpy as np
from numba.extending import overload

from symosc.kernels.multiprecision import mp_context
from symosc.kernels.pair_type import Pair, pair, pair_type

# Angles are reduced by multiples of pi over this, a power of two.
PER_PI = 1024
# exp is computed at a part of its argument, halved so often.
HALVINGS = 9
# Below the first exp is 0, as low parts would no longer be exact; above the second it is infinite.
LEAST_POWER, LARGEST_POWER = -670.0, 709.0
# expm1 needs no reduction below this.
SMALL = 0.34


def three_parts(value: Any) -> tuple[float, float, float]:
    """Return three floats whose sum is an mpf of many digits, to about 2^-160 of it."""
    first = float(value)
    second = float(value - first)
    return first, second, float(value - first - second)


def coefficient(n: int, sign: int = 1) -> Pair:
    """Return 1/n!, or minus that."""
    return Pair(Fraction(sign, math.factorial(n)))


@overload(math.sqrt)
def square_root(x):
    """Square root: error at most 3 units of the result."""

    def root(x):
        first = math.sqrt(x.hi)
        if x.hi <= 0.0:
            return pair(first, 0.0)
        near = pair(first, 0.0)
        rest = x - near * near
        return near + pair(rest.hi / (2.0 * first), 0.0)

    return root if x is pair_type else None


@lru_cache(maxsize=1)
def turned_sine() -> Any:
    """Return the compiled sine of an angle and so many quarters of a turn.

    The angle is a multiple j of pi/1024, which the table has, and a rest of at most pi/2048, for which Taylor's series
    takes five terms; only their first coefficients need two doubles.
    """
    context = mp_context(70)
    quarter = PER_PI // 2
    table = [Pair(context.sin(j * context.pi / PER_PI)) for j in range(quarter + 1)]
    high, low = np.array([each.hi for each in table]), np.array([each.lo for each in table])
    step1, step2, step3 = three_parts(context.pi / PER_PI)
    per_step = float(PER_PI / context.pi)
    s3, s5, s7, s9 = coefficient(3, -1), coefficient(5), coefficient(7, -1).hi, coefficient(9).hi
    c2, c4, c6, c8 = coefficient(2, -1), coefficient(4), coefficient(6, -1).hi, coefficient(8).hi

    def sine(x, quarters):
        steps = math.floor(x.hi * per_step + 0.5)
        many = pair(steps, 0.0)
        rest = ((x - many * pair(step1, 0.0)) - many * pair(step2, 0.0)) - many * pair(step3, 0.0)
        square = rest * rest
        q = square.hi
        s = rest + rest * square * (s3 + square * (s5 + pair(q * (s7 + q * s9), 0.0)))
        c = square * (c2 + square * (c4 + pair(q * (c6 + q * c8), 0.0)))  # cos - 1
        j = int(steps) + quarters * quarter
        i = j & (quarter - 1)
        at, beside = pair(high[i], low[i]), pair(high[quarter - i], low[quarter - i])
        if j & quarter:
            at, beside = beside, -at
        value = at + (at * c + beside * s)
        return -value if j & (2 * quarter) else value

    return numba.njit(sine)


@overload(math.sin)
def sine(x):
    """Sine: error at most 1.8e-32 for angles up to 1e6, in units of 1."""
    if x is not pair_type:
        return None
    turned = turned_sine()
    return lambda x: turned(x, 0)


@overload(math.cos)
def cosine(x):
    """Cosine: error as the sine's."""
    if x is not pair_type:
        return None
    turned = turned_sine()
    return lambda x: turned(x, 1)


@lru_cache(maxsize=1)
def small_expm1() -> Any:
    """Return the compiled exp(x) - 1 for |x| up to log(2)/2: Taylor's series at x/2^9, doubled nine times."""
    e2, e3, e4, e5 = (coefficient(n) for n in range(2, 6))
    e6, e7, e8, e9 = (coefficient(n).hi for n in range(6, 10))
    part = 0.5**HALVINGS

    def expm1(x):
        m = pair(x.hi * part, x.lo * part)
        q = m.hi
        tail = pair(q * (e6 + q * (e7 + q * (e8 + q * e9))), 0.0)
        s = m + m * m * (e2 + m * (e3 + m * (e4 + m * (e5 + tail))))
        for _ in range(HALVINGS):
            s = pair(2.0 * s.hi, 2.0 * s.lo) + s * s
        return s

    return numba.njit(expm1)


@overload(math.exp)
def exponential(x):
    """Exponential: error at most 3e-32 of the result from -670 to 709; 0 below, infinite above."""
    if x is not pair_type:
        return None
    log2 = mp_context(70).ln2
    step1, step2, step3 = three_parts(+log2)
    per_step = float(1 / log2)
    expm1 = small_expm1()

    def exp(x):
        if x.hi < LEAST_POWER:
            return pair(0.0, 0.0)
        if x.hi > LARGEST_POWER:
            return pair(math.inf, 0.0)
        steps = math.floor(x.hi * per_step + 0.5)
        many = pair(steps, 0.0)
        rest = ((x - many * pair(step1, 0.0)) - many * pair(step2, 0.0)) - many * pair(step3, 0.0)
        value = pair(1.0, 0.0) + expm1(rest)
        return pair(math.ldexp(value.hi, int(steps)), math.ldexp(value.lo, int(steps)))

    return exp


@overload(math.expm1)
def exponential_minus_1(x):
    """exp(x) - 1: error at most 8e-32 of the result."""
    if x is not pair_type:
        return None
    small = small_expm1()
    return lambda x: small(x) if abs(x.hi) < SMALL else math.exp(x) - pair(1.0, 0.0)


@overload(operator.pow)
def power(x, y):
    """Power, for estimates of errors: 16 digits."""
    return (lambda x, y: pair(x.hi**y.hi, 0.0)) if x is pair_type and y is pair_type else None
