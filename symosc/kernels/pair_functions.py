"""Square root, exponential, sine and cosine of double-double numbers: one source for CPython and numba.

For numba each is the overload of the function of `math` with that name for `symosc.kernels.pair_type`; CPython runs the
same source with its own `pair`. The errors that the docstrings state are the largest that were measured against mpmath,
over all arguments that they speak of (`tests/kernels/test_pair_functions.py`); a unit is 2^-106 = 1.2e-32. Table and
coefficients are exact rational numbers, or mpmath's with 70 digits, rounded once.
"""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from typing import Any

import numpy as np
from numba.extending import overload, register_jitable

from symosc.kernels.multiprecision import mp_context
from symosc.kernels.pair_type import Pair, pair, pair_type

EXACT = mp_context(70)
# Angles are reduced by multiples of pi over this, a power of two.
PER_PI = 1024
QUARTER = PER_PI // 2
# exp is computed at a part of its argument, halved so often.
HALVINGS = 9
PART = 0.5**HALVINGS
# Below the first exp is 0, as low parts would no longer be exact; above the second it is infinite.
LEAST_POWER, LARGEST_POWER = -670.0, 709.0
# expm1 needs no reduction below this.
SMALL = 0.34


def three_parts(value: Any) -> tuple[float, float, float]:
    """Return three floats whose sum is an mpf of many digits, to about 2^-160 of it."""
    first = float(value)
    second = float(value - first)
    return first, second, float(value - first - second)


# sin(j pi/1024) for a quarter of a turn, and the coefficients of Taylor's series.
SINES = [Pair(EXACT.sin(j * EXACT.pi / PER_PI)) for j in range(QUARTER + 1)]
SINES_HIGH, SINES_LOW = np.array([each.hi for each in SINES]), np.array([each.lo for each in SINES])
TURN1, TURN2, TURN3 = (Pair(part) for part in three_parts(EXACT.pi / PER_PI))
LOG1, LOG2, LOG3 = (Pair(part) for part in three_parts(+EXACT.ln2))
PER_TURN, PER_LOG = float(PER_PI / EXACT.pi), float(1 / EXACT.ln2)
F2, F3, F4, F5 = (Pair(Fraction(1, math.factorial(n))) for n in range(2, 6))
F6, F7, F8, F9 = (1.0 / math.factorial(n) for n in range(6, 10))


@register_jitable
def root(x):
    """Square root: error at most 3 units of the result."""
    if not x.hi > 0.0:
        return pair(0.0 if x.hi == 0.0 else math.nan, 0.0)
    first = math.sqrt(x.hi)
    near = pair(first, 0.0)
    rest = x - near * near
    return near + pair(rest.hi / (2.0 * first), 0.0)


@register_jitable
def turned_sine(x, quarters):
    """Sine of an angle and so many quarters of a turn: error at most 1.8e-32 up to 1e6, in units of 1.

    The angle is a multiple j of pi/1024, which the table has, and a rest of at most pi/2048, for which Taylor's series
    takes five terms; only their first coefficients need two doubles.
    """
    steps = math.floor(x.hi * PER_TURN + 0.5)
    many = pair(float(steps), 0.0)
    rest = ((x - many * TURN1) - many * TURN2) - many * TURN3
    square = rest * rest
    q = square.hi
    s = rest + rest * square * (-F3 + square * (F5 + pair(q * (-F7 + q * F9), 0.0)))
    c = square * (-F2 + square * (F4 + pair(q * (-F6 + q * F8), 0.0)))  # cos - 1
    j = int(steps) + quarters * QUARTER
    i = j & (QUARTER - 1)
    at = pair(float(SINES_HIGH[i]), float(SINES_LOW[i]))
    beside = pair(float(SINES_HIGH[QUARTER - i]), float(SINES_LOW[QUARTER - i]))
    if j & QUARTER:
        at, beside = beside, -at
    value = at + (at * c + beside * s)
    return -value if j & (2 * QUARTER) else value


@register_jitable
def sine(x):
    """Sine, see `turned_sine`."""
    return turned_sine(x, 0)


@register_jitable
def cosine(x):
    """Cosine, see `turned_sine`."""
    return turned_sine(x, 1)


@register_jitable
def small_expm1(x):
    """exp(x) - 1 for |x| up to log(2)/2: Taylor's series at x/2^9, doubled nine times."""
    m = pair(x.hi * PART, x.lo * PART)
    q = m.hi
    tail = pair(q * (F6 + q * (F7 + q * (F8 + q * F9))), 0.0)
    s = m + m * m * (F2 + m * (F3 + m * (F4 + m * (F5 + tail))))
    for _ in range(HALVINGS):
        s = pair(2.0 * s.hi, 2.0 * s.lo) + s * s
    return s


@register_jitable
def exponential(x):
    """Exponential: error at most 3e-32 of the result from -670 to 709; 0 below, infinite above."""
    if x.hi < LEAST_POWER:
        return pair(0.0, 0.0)
    if x.hi > LARGEST_POWER:
        return pair(math.inf, 0.0)
    steps = math.floor(x.hi * PER_LOG + 0.5)
    many = pair(float(steps), 0.0)
    rest = ((x - many * LOG1) - many * LOG2) - many * LOG3
    value = pair(1.0, 0.0) + small_expm1(rest)
    return pair(math.ldexp(value.hi, int(steps)), math.ldexp(value.lo, int(steps)))


@register_jitable
def exponential_minus_1(x):
    """exp(x) - 1: error at most 8e-32 of the result."""
    return small_expm1(x) if abs(x.hi) < SMALL else exponential(x) - pair(1.0, 0.0)


#: What these are to the engine.
FUNCTIONS = {"sqrt": root, "sin": sine, "cos": cosine, "exp": exponential, "expm1": exponential_minus_1}


def _overload(name: str, function: Any) -> None:
    """Let numba call a function for pairs where the source calls that of `math`."""
    overload(getattr(math, name))(lambda x: function if x is pair_type else None)


for _name, _function in FUNCTIONS.items():
    _overload(_name, _function)


@overload(operator.pow)
def power(x, y):
    """Power, for estimates of errors: 16 digits."""
    return (lambda x, y: pair(x.hi**y.hi, 0.0)) if x is pair_type and y is pair_type else None
