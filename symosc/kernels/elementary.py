"""Sine, cosine, exp and expm1, and the entire functions, without a branch: loops over them become SIMD instructions.

The C library's functions are calls, which no compiler turns into vector instructions. These are arithmetic only. The
argument is reduced by a constant in two or three parts (Cody and Waite, Software Manual for the Elementary
Functions, 1980); the rest is a polynomial that comes from a Chebyshev fit (the tests fit it again).

| function | range | largest error |
|---|---|---|
| sin, cos | up to WIDEST | 1.2e-16, absolute |
| exp | -708 to 709 | 1.4 ulp; below -708: exp(-708), about 3e-308 |
| expm1 | -708 to 709 | 2.2 ulp, near 0 too |

Beyond WIDEST a sine is wrong: the caller checks.

Of the entire functions of `symosc.kernels.entire` there is a function for each formula, good where
`symosc.kernels.entire.basis` uses that. `symosc.mappings.compiled` sorts the points and compiles the loops of
`symosc.kernels.mapping` once for each of the four, as their `basis`.
"""

from __future__ import annotations

from math import floor

import numpy as np

from symosc.kernels import entire_array
from symosc.kernels.entire import closed_form, impulse, impulse_integral, wave_integrals

# Where n pi/2 is still a sum of exact products: n has 20 bits, the parts below 33.
WIDEST = 1.6e6

TWO_OVER_PI = 0.6366197723675814
HALF_PI_HIGH, HALF_PI_MIDDLE, HALF_PI_LOW = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
LOG2_E = 1.4426950408889634
LOG_2_HIGH, LOG_2_LOW = 0.6931471805598903, 5.497923018708371e-14
# Adding and taking away this number rounds to an integer; the integer stands in the last bits of the sum.
TO_INTEGER = 1.5 * 2.0**52

# With z = r^2: sin r = r + r z (S0 + S1 z + ...), cos r = 1 - z/2 + z^2 (C0 + C1 z + ...),
# expm1 r = r + r^2 (X0 + X1 r + ...).
S0, S1, S2 = -0.16666666666666666, 0.008333333333330948, -0.0001984126983675854
S3, S4, S5 = 2.7557316102534617e-06, -2.505113184128889e-08, 1.5918129027234826e-10
C0, C1, C2 = 0.041666666666666664, -0.0013888888888887398, 2.4801587298765665e-05
C3, C4, C5 = -2.7557317271718644e-07, 2.087614626607931e-09, -1.1382632258093615e-11
X0, X1, X2, X3 = 0.5, 0.1666666666666667, 0.04166666666666667, 0.008333333333326141
X4, X5, X6, X7 = 0.0013888888888883752, 0.00019841269874800683, 2.4801587325533502e-05, 2.75572554255029e-06
X8, X9, X10 = 2.7557273661174726e-07, 2.5105206475334834e-08, 2.091467944897855e-09


def sine_cosine(x):
    """Return the sine and the cosine of an angle in radians, up to WIDEST."""
    n = (x * TWO_OVER_PI + TO_INTEGER) - TO_INTEGER
    rest = x - n * HALF_PI_HIGH
    part = n * HALF_PI_MIDDLE
    r = rest - part
    low = ((rest - r) - part) - n * HALF_PI_LOW  # what rounding took from r
    z = r * r
    half = 0.5 * z
    top = 1.0 - half
    s = r + (z * r * (S0 + z * (S1 + z * (S2 + z * (S3 + z * (S4 + z * S5))))) + top * low)
    c = top + (((1.0 - top) - half) + (z * z * (C0 + z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * C5))))) - s * low))
    quarter = n - 4.0 * floor(0.25 * n)
    odd = (quarter == 1.0) | (quarter == 3.0)
    sine, cosine = (c, s) if odd else (s, c)
    return (-sine if quarter >= 2.0 else sine), (-cosine if (quarter == 1.0) | (quarter == 2.0) else cosine)


def sin(x):
    """Return the sine of an angle in radians."""
    return sine_cosine(x)[0]


def cos(x):
    """Return the cosine of an angle in radians."""
    return sine_cosine(x)[1]


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
    x = x if x > -708.0 else -708.0
    shifted = x * LOG2_E + TO_INTEGER
    n = shifted - TO_INTEGER
    r = (x - n * LOG_2_HIGH) - n * LOG_2_LOW
    high = X5 + r * (X6 + r * (X7 + r * (X8 + r * (X9 + r * X10))))
    rest = r + r * r * (X0 + r * (X1 + r * (X2 + r * (X3 + r * (X4 + r * high)))))
    n_bits = np.float64(shifted).view(np.int64) + 1023
    return np.int64(n_bits << 52).view(np.float64), rest  # 2^n: n moved to where a double keeps its exponent


# --- the entire functions ---

all_terms = entire_array.series  # with a fixed number of terms


def by_closed_form(tau, K):
    """Return what `basis` returns, where the system is underdamped and far from resonance and tau is not short."""
    s, c = sin(K.Om * tau), cos(K.Om * tau)
    E0, E1, E2, R2, I2 = closed_form(tau, s, c, K)
    return E0, E1, E2, R2, I2, s, c


def by_division(tau, K):
    """Return what `basis` returns, where neither the oscillator nor the drive is slow for tau."""
    s, c = sin(K.Om * tau), cos(K.Om * tau)
    E0, E1 = impulse(tau, K)
    R2, I2 = wave_integrals(tau, s, c, E1, K)
    return E0, E1, impulse_integral(tau, E1, K), R2, I2, s, c


def by_division_and_series(tau, K):
    """Return what `basis` returns, where the oscillator is slow for tau and the drive is not."""
    s, c = sin(K.Om * tau), cos(K.Om * tau)
    E0, E1, E2, _, _ = all_terms(tau, K.cm, K.w0sq, 0.0)
    R2, I2 = wave_integrals(tau, s, c, E1, K)
    return E0, E1, E2, R2, I2, s, c


def by_series(tau, K):
    """Return what `basis` returns, where tau is short for the oscillator and for the drive."""
    E0, E1, E2, R2, I2 = all_terms(tau, K.cm, K.w0sq, K.Om)
    return E0, E1, E2, R2, I2, sin(K.Om * tau), cos(K.Om * tau)
