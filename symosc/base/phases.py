"""Phases and times that are known exactly: read, compared, and computed with.

An exact angle is a Fraction, a real constant of sympy, or an `ExactPhase` a + b pi with rational a
and b.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any, TypeGuard

import numpy as np

from symosc.base.aliases import Angle, Context, Expr, Number
from symosc.base.errors import ParameterError
from symosc.base.exact import LARGEST, NO_EXPRESSION, NUMBER_FORMS, read_exact
from symosc.base.expressions import ExactPhase, evaluated

PHASE_FORMS = (
    "give a number, or a rational multiple of pi such as 'pi', '3*pi/2' or '-pi/4' "
    "(a rational number may be added)"
)
ANGLE_FORMS = f"{NUMBER_FORMS}, or a real constant such as sympy.pi or '3*pi/2'"


def has_pi(text: object) -> TypeGuard[str]:
    """Return whether a value is text that contains pi."""
    return isinstance(text, str) and ("pi" in text or "π" in text)


def read_phase_text(name: str, text: str) -> ExactPhase:
    """Read a phase from a text such as "3*pi/2", "pi - 1/3" or "0.7"."""
    if not has_pi(text):
        return ExactPhase(_read_rational(name, text))
    phase = evaluated(name, text, PHASE_FORMS)
    if not isinstance(phase, ExactPhase):
        raise ParameterError(name, text, PHASE_FORMS)
    if max(map(abs, phase)) > LARGEST:
        raise ParameterError(name, text, f"must be at most {float(LARGEST):g} in size")
    return phase


def of_sympy(value: Expr) -> ExactPhase | None:
    """Return a sympy number as a phase, or None if it is not a + b pi with rational a and b."""
    import sympy

    multiple = value.coeff(sympy.pi)
    rest = value - multiple * sympy.pi
    if not (multiple.is_Rational and rest.is_Rational):
        return None
    return ExactPhase(
        Fraction(int(rest.p), int(rest.q)), Fraction(int(multiple.p), int(multiple.q))
    )


def read_phase(name: str, value: object) -> Angle:
    """Read a phase like `read_angle`, but take a float as its exact binary value, not as the
    decimal it prints as.
    """
    if isinstance(value, float | np.floating) and math.isfinite(value):
        value = Fraction(float(value))
    return read_angle(name, value)


def read_angle(name: str, value: Any) -> Angle:
    """Read a number, a text such as "3*pi/2" or a sympy expression as a Fraction or a sympy
    constant.

    A float is read as the decimal that it prints as.
    """
    if has_pi(value):
        return read_phase_text(name, value).symbolic()
    # An expression of sympy that is no plain number; only sympy's classes have is_Float.
    if getattr(value, "is_Float", None) is False and not value.is_Rational:
        is_constant = hasattr(value, "is_real") and not value.free_symbols and value.is_number
        if not (is_constant and value.is_real is not False and value.evalf().is_Float):
            raise ParameterError(name, value, ANGLE_FORMS)
        return value
    return _read_rational(name, value)


def _read_rational(name: str, value: Any) -> Fraction:
    """Return a rational number; a ParameterError says that multiples of pi are allowed too."""
    try:
        return read_exact(name, value)
    except ParameterError as error:
        if error.allowed in (NUMBER_FORMS, NO_EXPRESSION):
            raise ParameterError(name, value, ANGLE_FORMS) from None
        raise


def number_of(value: Angle, context: Context) -> Number:
    """Return a Fraction or a sympy constant as an mpf of a context."""
    if isinstance(value, Fraction):
        return context.mpf(value.numerator) / value.denominator
    return context.mpf(str(value.evalf(context.dps + 5)))


def reduced(angle: Angle) -> Angle:
    """Return an exact angle modulo 2 pi, in [0, 2 pi), again exact."""
    if isinstance(angle, Fraction) and 0 <= angle < 6:  # less than 2 pi: without sympy
        return angle
    import sympy

    angle = symbolic(angle)
    return angle - 2 * sympy.pi * sympy.floor(angle / (2 * sympy.pi))


def symbolic(value: Angle) -> Expr:
    """Return a Fraction as a sympy number, and other values unchanged."""
    import sympy

    if isinstance(value, Fraction):
        return sympy.Rational(value.numerator, value.denominator)
    return value


def times(value: Angle, factor: Fraction) -> Angle:
    """Return an exact angle, a Fraction or a sympy constant, times a rational number."""
    if isinstance(value, Fraction):
        return value * factor
    return value * symbolic(factor)
