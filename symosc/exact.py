"""Reading numbers exactly: every parameter and every start is a rational number, never a rounded float."""

from __future__ import annotations

import math
import numbers
import re
from decimal import Decimal
from fractions import Fraction
from typing import Any

from symosc.errors import ParameterError

NUMBER_FORMS = "give an int, a float, a string such as '0.8' or '4/5', a Fraction, a Decimal or a rational sympy number"

# Decimal exponents beyond this are typing errors, and Fraction would build an integer of as many digits.
MAX_EXPONENT = 1000

# Fourth powers of rates and their products must not overflow a double.
LARGEST = Fraction(10) ** 50
SMALLEST = 1 / LARGEST

# A double has at most 17 significant digits. A decimal with more was cut off by somebody who had still more of them.
DIGITS_OF_A_DOUBLE = 17
BITS_OF_A_DOUBLE = 53


def read_exact(name: str, value: Any) -> Fraction:
    """Return `value` as an exact Fraction, at most LARGEST in size.

    A float is read as the decimal that it prints as (0.8 is 4/5); an mpmath number as its exact binary value.

    Raises
    ------
    ParameterError
        For text that is no number, for NaN, infinities and numbers that are too large, and for types that are not exact
        numbers.
    """
    number = _read(name, value)
    if abs(number) > LARGEST:
        raise ParameterError(name, value, f"must be at most {float(LARGEST):g} in size")
    return number


def _read(name: str, value: Any) -> Fraction:
    if isinstance(value, bool):
        raise ParameterError(name, value, NUMBER_FORMS)
    if isinstance(value, Fraction):
        return value
    if isinstance(value, str):
        return _read_text(name, value)
    if isinstance(value, Decimal):
        if not value.is_finite():
            raise ParameterError(name, value, "must be finite")
        return _read_text(name, str(value))
    if isinstance(value, numbers.Rational):  # int, numpy integers and the rational numbers of sympy register here
        return Fraction(int(value.numerator), int(value.denominator))
    if hasattr(value, "_mpf_") and hasattr(value, "context"):  # mpmath: prints fewer digits than it has
        return _read_mpf(name, value)
    if isinstance(value, numbers.Real):
        if not math.isfinite(float(value)):
            raise ParameterError(name, value, "must be finite")
        return Fraction(str(value))  # str, not repr: numpy's repr names the type
    raise ParameterError(name, value, NUMBER_FORMS)


def _read_text(name: str, text: str) -> Fraction:
    exponent = re.search(r"[eE]([+-]?\d+)\s*$", text)
    if exponent and abs(int(exponent.group(1))) > MAX_EXPONENT:
        raise ParameterError(name, text, f"the decimal exponent must be within ±{MAX_EXPONENT}")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ParameterError(name, text, "the denominator must not be 0") from None
    except ValueError:
        lowered = text.strip().lower().lstrip("+-")
        allowed = "must be finite" if lowered in {"inf", "infinity", "nan"} else NUMBER_FORMS
        raise ParameterError(name, text, allowed) from None


def _read_mpf(name: str, value: Any) -> Fraction:
    sign, mantissa, exponent, bits = value._mpf_
    if not mantissa and (exponent or bits):  # mpmath's encoding of nan and the infinities
        raise ParameterError(name, value, "must be finite")
    magnitude = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    return -magnitude if sign else magnitude


def half_unit(value: Fraction) -> Fraction:
    """Return how far a number that was cut to finitely many digits may be from the one that was meant.

    Numbers as people type them (up to 17 significant digits) are exact, so are fractions such as 1/3: the answer is 0.
    A longer decimal or binary number is somebody's rounding: the answer is half a unit of its last digit.
    """
    denominator = value.denominator
    twos = (denominator & -denominator).bit_length() - 1
    rest, fives = denominator >> twos, 0
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest != 1:
        return Fraction(0)
    if fives == 0 and twos > BITS_OF_A_DOUBLE and value.numerator.bit_length() > BITS_OF_A_DOUBLE:
        return Fraction(1, 2 ** (twos + 1))
    decimals = max(twos, fives)
    if len(str(abs(value.numerator) * 10**decimals // denominator)) > DIGITS_OF_A_DOUBLE:
        return Fraction(1, 2 * 10**decimals)
    return Fraction(0)


def show(value: Fraction) -> str:
    """Return the shortest text that reads back as `value`: a decimal where it ends, else a fraction."""
    denominator = value.denominator
    twos = (denominator & -denominator).bit_length() - 1
    rest, fives = denominator >> twos, 0
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    decimals = max(twos, fives)
    if rest != 1 or decimals > 60:
        return str(value)
    if decimals == 0:
        return str(value.numerator)
    digits = f"{abs(value.numerator) * 10**decimals // denominator:0{decimals + 1}d}"
    return f"{'-' if value < 0 else ''}{digits[:-decimals]}.{digits[-decimals:]}"
