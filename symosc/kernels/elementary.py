"""Sine, cosine, exp and expm1 as arithmetic: the same bits in CPython, in compiled loops and in
lanes, everywhere.

This file is executed with other globals: see symosc/kernels/rebind.py.

The C library's functions differ from system to system, and are calls, which no compiler turns into
vector instructions. These have no branch (`sin` and `cos` one, for angles beyond WIDEST). The
argument is reduced by a constant in two or three parts (Cody and Waite, Software Manual for the
Elementary Functions, 1980); the rest is a polynomial that comes from a Chebyshev fit (the tests fit
it again).

| function | range | largest error |
|---|---|---|
| sin, cos | up to WIDEST | 1.2e-16, absolute |
| exp | -708 to 709 | 1.4 ulp; below -708: exp(-708), about 3e-308 |
| expm1 | -708 to 709 | 2.2 ulp, near 0 too |

Numbers may be lanes (`symosc.kernels.lane_types`): then `select` and `power_of_two` are those of
lanes.
"""

from __future__ import annotations

from math import cos as library_cos
from math import ldexp
from math import sin as library_sin

# Where n pi/2 is still a sum of exact products: n has 20 bits, the parts below 33.
WIDEST = 1.6e6

TWO_OVER_PI = 0.6366197723675814
HALF_PI_HIGH = 1.5707963267341256
HALF_PI_MIDDLE = 6.077100506303966e-11
HALF_PI_LOW = 2.0222662487959506e-21
LOG2_E = 1.4426950408889634
LOG_2_HIGH = 0.6931471805598903
LOG_2_LOW = 5.497923018708371e-14
# Adding and taking away this number rounds to an integer; the integer stands in the last bits of
# the sum.
TO_INTEGER = 1.5 * 2.0**52

# With z = r^2: sin r = r + r z (S0 + S1 z + ...), cos r = 1 - z/2 + z^2 (C0 + C1 z + ...),
# expm1 r = r + r^2 (X0 + X1 r + ...).
S0 = -0.16666666666666666
S1 = 0.008333333333330948
S2 = -0.0001984126983675854
S3 = 2.7557316102534617e-06
S4 = -2.505113184128889e-08
S5 = 1.5918129027234826e-10
C0 = 0.041666666666666664
C1 = -0.0013888888888887398
C2 = 2.4801587298765665e-05
C3 = -2.7557317271718644e-07
C4 = 2.087614626607931e-09
C5 = -1.1382632258093615e-11
X0 = 0.5
X1 = 0.1666666666666667
X2 = 0.04166666666666667
X3 = 0.008333333333326141
X4 = 0.0013888888888883752
X5 = 0.00019841269874800683
X6 = 2.4801587325533502e-05
X7 = 2.75572554255029e-06
X8 = 2.7557273661174726e-07
X9 = 2.5105206475334834e-08
X10 = 2.091467944897855e-09


def select(condition, value, fallback):
    """Return `value` where a condition holds, else `fallback`."""
    if condition:
        return value
    return fallback


def power_of_two(n):
    """Return 2^n for a whole number n as a double, by `ldexp`.

    Compiled code replaces this by bit operations.
    """
    return ldexp(1.0, int(n))


def sine_cosine(x):
    """Return the sine and the cosine of an angle in radians, accurate for angles up to 1.6e6
    (WIDEST).
    """
    n = (x * TWO_OVER_PI + TO_INTEGER) - TO_INTEGER
    rest = x - n * HALF_PI_HIGH
    part = n * HALF_PI_MIDDLE
    r = rest - part
    low = ((rest - r) - part) - n * HALF_PI_LOW  # what rounding took from r
    z = r * r
    half = 0.5 * z
    top = 1.0 - half
    zz = z * z  # terms in pairs: each waits for fewer others than in Horner's order
    of_s = (S0 + S1 * z) + zz * ((S2 + S3 * z) + zz * (S4 + S5 * z))
    of_c = (C0 + C1 * z) + zz * ((C2 + C3 * z) + zz * (C4 + C5 * z))
    s = r + (z * r * of_s + top * low)
    c = top + (((1.0 - top) - half) + (zz * of_c - r * (1.0 + S0 * z) * low))
    quarter = n - 4.0 * ((0.25 * n + TO_INTEGER) - TO_INTEGER)  # -2 to 2
    odd = abs(quarter) == 1.0
    half_turn = abs(quarter) == 2.0
    sine = select(odd, c, s)
    cosine = select(odd, s, c)
    return select(half_turn | (quarter == -1.0), -sine, sine), select(
        half_turn | (quarter == 1.0), -cosine, cosine
    )


def short_sin(x):
    """Return the sine of an angle in radians, accurate up to 1.6e6 (WIDEST) only.

    `sin` serves larger angles too.
    """
    return sine_cosine(x)[0]


def short_cos(x):
    """Return the cosine of an angle in radians, accurate up to 1.6e6 (WIDEST) only.

    `cos` serves larger ones too.
    """
    return sine_cosine(x)[1]


def sin(x):
    """Return the sine of an angle in radians."""
    near = sine_cosine(x)[0]
    if abs(x) <= WIDEST:
        return near
    return library_sin(x)


def cos(x):
    """Return the cosine of an angle in radians."""
    near = sine_cosine(x)[1]
    if abs(x) <= WIDEST:
        return near
    return library_cos(x)


def exp(x):
    """Return e^x."""
    scale, rest = power_and_rest(x)
    return scale + scale * rest


def expm1(x):
    """Return e^x - 1."""
    scale, rest = power_and_rest(x)
    return (scale - 1.0) + scale * rest


def power_and_rest(x):
    """Return 2^n and expm1(x - n log 2), with n the integer nearest to x / log 2."""
    x = select(x > -708.0, x, -708.0)
    n = (x * LOG2_E + TO_INTEGER) - TO_INTEGER
    r = (x - n * LOG_2_HIGH) - n * LOG_2_LOW
    z = r * r
    zz = z * z
    high = ((X4 + X5 * r) + z * (X6 + X7 * r)) + zz * ((X8 + X9 * r) + z * X10)
    return power_of_two(n), r + z * (((X0 + X1 * r) + z * (X2 + X3 * r)) + zz * high)
