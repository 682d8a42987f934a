"""Reading numbers exactly.

Every parameter and every start is a rational number, never a rounded float.
"""

from __future__ import annotations

import math
import numbers
import operator
import re
import sys
from decimal import Context, Decimal, Inexact
from fractions import Fraction
from typing import Any

from symosc.errors import ParameterError

NUMBER_FORMS = "give an int, a float, a string such as '0.8' or '4/5', a Fraction, a Decimal or a rational sympy number"

#: What a decimal or a fraction looks like: ASCII digits only, no underscores, no spaces inside.
NUMBER = re.compile(r"[+-]?(\d+/\d+|(\d+\.?\d*|\.\d+)([eE](?P<exponent>[+-]?\d+))?)", re.ASCII)
NOT_FINITE = re.compile(r"[+-]*(inf|infinity|nan)", re.IGNORECASE)
#: What an expression looks like, which is not a number.
EXPRESSION = re.compile(r"pi\b|π|sqrt|\w\(|\d\s*[*^]|[)\d]\s*[+-]\s*[(\d]", re.IGNORECASE)
NO_EXPRESSION = (
    "is an expression, and only fractions are exact: write its value with the digits that you need, such as "
    "'3.14159265358979323846264338328' for pi or '6.28318530717958647692528676656' for 2 pi"
)
#: Digits that a caller may ask for.
LEAST_ASKED_DIGITS = 5
MOST_ASKED_DIGITS = 10_000
MOST_CHARACTERS = 4000  # Python converts no more than 4300 digits to an int

# Decimal exponents beyond this are typing errors, and Fraction would build an integer of as many
# digits.
MAX_EXPONENT = 1000

# Fourth powers of rates and their products must not overflow a double.
LARGEST = Fraction(10) ** 50
SMALLEST = 1 / LARGEST


def read_exact(name: str, value: object) -> Fraction:
    """Return `value` as an exact Fraction of at most 10^50 in size.

    Messages call the number `name`.
    """
    # A float is read as the decimal that it prints as (0.8 is 4/5); an mpmath number as its exact
    # binary value. ParameterError for all that is no finite exact number of moderate size.
    number = _read(name, value)
    if abs(number) > LARGEST:
        raise ParameterError(name, value, f"must be at most {float(LARGEST):g} in size")
    return number


def _read(name: str, value: Any) -> Fraction:
    """Return a number of any type, or its text, as an exact Fraction.

    Error messages call the number `name`.
    """
    if isinstance(value, Fraction):
        return value
    # numpy takes its timedelta64 for an integer
    if isinstance(value, bool) or type(value).__name__ == "timedelta64":
        raise ParameterError(name, value, NUMBER_FORMS)
    if isinstance(value, str):
        return _read_text(name, value)
    if isinstance(
        value, numbers.Rational
    ):  # int, numpy integers and the rational numbers of sympy register here
        return Fraction(int(value.numerator), int(value.denominator))
    if hasattr(type(value), "_mpf_") and hasattr(
        type(value), "context"
    ):  # mpmath: prints fewer digits than it has
        sign, mantissa, exponent, bits = value._mpf_
        if not mantissa and (exponent or bits):  # mpmath's encoding of nan and the infinities
            raise ParameterError(name, value, "must be finite")
        magnitude = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
        if sign:
            return -magnitude
        return magnitude
    if isinstance(value, Decimal | numbers.Real):
        if not (value.is_finite() if isinstance(value, Decimal) else math.isfinite(float(value))):
            raise ParameterError(name, value, "must be finite")
        # str, not repr: numpy's repr names the type
        if isinstance(value, Decimal):
            return _read_text(name, str(value))
        return Fraction(str(value))
    # An expression of sympy, such as 2*pi, is known by how it prints.
    symbolic = hasattr(type(value), "free_symbols") and EXPRESSION.search(str(value))
    raise ParameterError(name, value, NO_EXPRESSION if symbolic else NUMBER_FORMS)


def _read_text(name: str, text: str) -> Fraction:
    """Return a number written as text, such as "4/5", as an exact Fraction.

    Error messages call it `name`.
    """
    if len(text) > MOST_CHARACTERS:
        raise ParameterError(name, text, f"a number may have at most {MOST_CHARACTERS} characters")
    read = NUMBER.fullmatch(text.strip())
    if read is None:
        if NOT_FINITE.fullmatch(text.strip()):
            raise ParameterError(name, text, "must be finite")
        raise ParameterError(name, text, NO_EXPRESSION if EXPRESSION.search(text) else NUMBER_FORMS)
    if abs(int(read["exponent"] or 0)) > MAX_EXPONENT:
        raise ParameterError(name, text, f"the decimal exponent must be within ±{MAX_EXPONENT}")
    try:
        return Fraction(read.group())
    except ZeroDivisionError:
        raise ParameterError(name, text, "the denominator must not be 0") from None


def unmasked(name: str, value: Any) -> Any:
    """Return `value`; raise ParameterError if it contains masked entries of a numpy masked array."""
    # Most functions of numpy read what is behind the mask. While another thread loads numpy.ma it
    # has no such arrays.
    kind = getattr(sys.modules.get("numpy.ma"), "MaskedArray", None)
    if isinstance(value, (list, tuple)):
        each = value
    else:
        each = (value,)
    if kind and any(isinstance(part, kind) and part.mask.any() for part in each):
        raise ParameterError(name, "masked", "must be a number everywhere; some are masked")
    return value


def whole_number(name: str, value: Any, least: int, most: int | None = None) -> int:
    """Return `value` as an int, or raise ParameterError if it is not one or out of range."""
    try:
        # numpy need not be loaded
        if type(unmasked(name, value)).__name__ in ("bool", "bool_"):
            number = None
        else:
            number = operator.index(value)
    except TypeError:
        number = None
    if number is None or number < least or (most is not None and number > most):
        if most is None:
            allowed = f">= {least}"
        else:
            allowed = f"from {least} to {most}"
        raise ParameterError(name, value, f"must be a whole number {allowed}")
    return number


def read_digits(digits: object, most: int = MOST_ASKED_DIGITS) -> int | None:
    """Check the argument `digits`: return a whole number, or None for doubles.

    ParameterError if out of range.
    """
    if digits is None:
        return None
    return whole_number("digits", digits, LEAST_ASKED_DIGITS, most)


def read_start_error(value: Any) -> tuple[Fraction, Fraction, Fraction] | None:
    """Return by how much t0, x0 and v0 may be off, given one number >= 0 for all, three numbers, or None (exact)."""
    if value is None:
        return None
    is_array = hasattr(type(value), "dtype")
    if isinstance(value, list | tuple) or (is_array and value.shape):
        given = list(value)
    else:  # an array without dimensions is a number
        given = [value[()] if is_array else value] * 3
    if len(given) != 3:
        raise ParameterError("start_error", value, "must be a number, or three: of t0, x0 and v0")
    t0, x0, v0 = (read_exact("start_error", each) for each in given)
    if min(t0, x0, v0) < 0:
        raise ParameterError("start_error", value, "must be >= 0")
    return t0, x0, v0


# A decimal is written with an exponent if it has more leading or trailing zeros than this, and as a
# fraction if it has more digits.
MOST_ZEROS = 20
LONGEST_DECIMAL = 60


def show(value: Fraction) -> str:
    """Return a short text that reads back as `value`.

    A decimal if 60 digits suffice, else a fraction.
    """
    # an int of more than 4300 digits cannot be printed
    n = Decimal(value.numerator)
    d = Decimal(value.denominator)
    context = Context(prec=LONGEST_DECIMAL, traps=[Inexact])
    try:
        number = context.divide(n, d).normalize(context)
    except Inexact:
        if d == 1:
            return f"{n:f}"
        return f"{n:f}/{d:f}"
    sign, digits, exponent = number.as_tuple()
    if max(int(exponent), -1 - number.adjusted()) <= MOST_ZEROS:
        return f"{number:f}"
    first, *rest = map(str, digits)
    return f"{'-' * sign}{first}{'.' * bool(rest)}{''.join(rest)}e{number.adjusted()}"
