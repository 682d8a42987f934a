"""Phases and times as exact numbers: fractions, or real constants of sympy such as 3 pi/2."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np

from symosc.aliases import Angle, Context, Expr, Number
from symosc.errors import ParameterError
from symosc.exact import NUMBER_FORMS, read_exact
from symosc.mappings.phase import has_pi, read_text


def read_phase(name: str, value: object) -> Angle:
    """Return what `read_angle` returns, but a float as the binary number that it is: phases are computed, not typed."""
    if isinstance(value, float | np.floating) and math.isfinite(value):
        value = Fraction(float(value))
    return read_angle(name, value)


def read_angle(name: str, value: Any) -> Angle:
    """Return a Fraction, or a real sympy constant, for a number, a text such as "3*pi/2" or a sympy expression."""
    forms = f"{NUMBER_FORMS}, or a real constant such as sympy.pi or '3*pi/2'"
    if has_pi(value):
        return read_text(name, value).symbolic()
    if getattr(value, "is_Float", None) is False and not value.is_Rational:  # sympy's, and no plain number
        if not _is_real_constant(value):
            raise ParameterError(name, value, forms)
        return value
    try:
        return read_exact(name, value)
    except ParameterError as error:
        raise ParameterError(name, value, error.allowed if "finite" in error.allowed else forms) from None


def _is_real_constant(value: Expr) -> bool:
    plain = hasattr(value, "is_real") and not value.free_symbols and value.is_number
    return bool(plain and value.is_real is not False and value.evalf().is_Float)


def number_of(value: Angle, context: Context) -> Number:
    """Return a Fraction or a sympy constant as an mpf of the context."""
    if isinstance(value, Fraction):
        return context.mpf(value.numerator) / value.denominator
    return context.mpf(str(value.evalf(context.dps + 5)))


def phase_of(angle: Angle) -> Angle:
    """Return an exact angle reduced to [0, 2 pi), exactly."""
    if isinstance(angle, Fraction):
        if 0 <= angle < 6:
            return angle
        import sympy

        angle = sympy.Rational(angle.numerator, angle.denominator)
    import sympy

    return angle - 2 * sympy.pi * sympy.floor(angle / (2 * sympy.pi))


def symbolic(value: Angle) -> Expr:
    """Return a Fraction as a sympy number, and anything else as it is."""
    import sympy

    return sympy.Rational(value.numerator, value.denominator) if isinstance(value, Fraction) else value


def times(value: Angle, factor: Fraction) -> Angle:
    """Return an exact angle times a rational number."""
    return value * factor if isinstance(value, Fraction) else value * symbolic(factor)
