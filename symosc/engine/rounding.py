"""What numbers with more digits become in doubles: their rounding is the only error, unless their own is not faint.

Errors of numbers with many digits depend on how many these are. Beside the rounding to doubles they are nothing, and
are left out: so the same doubles come out of any number of digits.
"""

from __future__ import annotations

from symosc.kernels.entire import EPS

# An error below this part of the rounding to doubles is faint.
FAINT_PART = 2.0**-20


def is_faint(error, value):
    """Return whether the error of a value is nothing beside its rounding to a double."""
    return error <= FAINT_PART * (EPS * abs(value))


def rounding_error(error, value):
    """Return the error of a value that is rounded to a double."""
    rounding = EPS * abs(value)
    return rounding if is_faint(error, value) else error + rounding


def rounded_covariance(at, x, v, S11, S12, S22):
    """Return the covariance of a state that is rounded to doubles; on a belt, `at` > 0, the velocity is exact."""
    position, velocity = (EPS * x) * (EPS * x), (EPS * v) * (EPS * v)
    if FAINT_PART * FAINT_PART * velocity >= S22:
        S12, S22 = 0.0, 0.0
    S11 = position if FAINT_PART * FAINT_PART * position >= S11 else S11 + position
    return S11, S12, (S22 if at > 0 else S22 + velocity)
