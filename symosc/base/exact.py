"""Reading numbers exactly: every parameter and every start is a rational number, never a rounded
float.
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

from symosc.base.errors import ParameterError

NUMBER_FORMS = (
    "give an int, a float, a string such as '0.8' or '4/5', a Fraction, a Decimal or a rational "
    "sympy number"
)

#: What a decimal or a fraction looks like: ASCII digits only, no underscores, no spaces inside.
NUMBER = re.compile(r"[+-]?(\d+/\d+|(\d+\.?\d*|\.\d+)([eE](?P<exponent>[+-]?\d+))?)", re.ASCII)
NOT_FINITE = re.compile(r"[+-]*(inf|infinity|nan)", re.IGNORECASE)
#: What an expression looks like, which is not a number.
EXPRESSION = re.compile(r"pi\b|π|sqrt|\w\(|\d\s*[*^]|[)\d]\s*[+-]\s*[(\d]", re.IGNORECASE)
NO_EXPRESSION = (
    "must be a number, as an expression is not exact: write its value with the digits that you "
    "need, such as "
    "'3.14159265358979323846264338328' for pi or '6.28318530717958647692528676656' for 2 pi"
)
#: Digits that a caller may ask for.
LEAST_ASKED_DIGITS = 5
MOST_ASKED_DIGITS = 10_000
MOST_CHARACTERS = 4000  # Python converts no more than 4300 digits to an int

# Decimal exponents beyond this are typing errors, and Fraction would build an integer of as many
# digits.
MAX_EXPONENT = 1000
TOO_FAR = f"the decimal exponent must be within ±{MAX_EXPONENT}"
#: Bits of a numerator or denominator: a number with the most digits that a caller may ask for has
#: a third of them.
MOST_BITS = 100_000

# Fourth powers of rates and their products must not overflow a double.
LARGEST = Fraction(10) ** 50
SMALLEST = 1 / LARGEST
LARGEST_DOUBLE = float(LARGEST)


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


def read_double(name: str, value: object) -> float:
    """Return `value` as the double next to the number that `read_exact` reads, quickly if it is a
    float or the text of a decimal.
    """
    is_plain = type(value) is float
    if type(value) is str and len(value) <= MOST_CHARACTERS and "/" not in value:
        is_plain = NUMBER.fullmatch(value.strip()) is not None
    if is_plain:
        number = float(value)  # type: ignore[arg-type]
        if 0.0 < abs(number) <= LARGEST_DOUBLE:
            return number
    return float(read_exact(name, value))


def _read(name: str, value: Any) -> Fraction:
    """Return a number of any type, or its text, as an exact Fraction.

    Error messages call the number `name`.
    """
    value = scalar_of(name, value)
    # numpy takes its timedelta64 for an integer
    if isinstance(value, bool) or type(value).__name__ == "timedelta64":
        raise ParameterError(name, value, NUMBER_FORMS)
    if isinstance(value, str):
        return _read_text(name, str.__str__(value))  # a class of texts may show another one
    # An expression of sympy, such as 2*pi, is known by how it prints.
    is_symbolic = hasattr(type(value), "free_symbols")
    if is_symbolic and not isinstance(value, numbers.Real):
        is_expression = EXPRESSION.search(str(value))
        raise ParameterError(name, value, NO_EXPRESSION if is_expression else NUMBER_FORMS)
    try:
        number = _number_of(name, value)
    except ParameterError:
        raise
    except Exception:  # whatever the methods of a class of numbers raise
        raise ParameterError(name, value, NUMBER_FORMS) from None
    if max(number.numerator.bit_length(), number.denominator.bit_length()) > MOST_BITS:
        allowed = f"its numerator and denominator may have at most {MOST_BITS:,} bits each"
        raise ParameterError(name, value, allowed)
    return number


def _number_of(name: str, value: Any) -> Fraction:
    """Return a number that is no text as an exact Fraction; ParameterError if it is not finite."""
    if isinstance(value, Fraction):
        return value
    if isinstance(value, numbers.Rational):  # also int, numpy's integers, sympy's rational numbers
        return Fraction(int(value.numerator), int(value.denominator))
    if hasattr(type(value), "_mpf_") and hasattr(type(value), "context"):
        return _number_of_mpmath(name, value)  # it prints fewer digits than it has
    if isinstance(value, Decimal):
        is_finite = value.is_finite()
    elif isinstance(value, numbers.Real):
        is_finite = math.isfinite(value)
    else:
        raise ParameterError(name, value, NUMBER_FORMS)
    if not is_finite:
        raise ParameterError(name, value, "must be finite")
    number: Any = value
    if isinstance(number, float):
        return Fraction(float.__repr__(number))  # numpy's repr names the type
    return _read_text(name, str(number))


def _number_of_mpmath(name: str, value: Any) -> Fraction:
    """Return the exact binary value of a number of mpmath; ParameterError if it is not finite."""
    sign, mantissa, exponent, bits = value._mpf_
    if not mantissa and (exponent or bits):  # mpmath's encoding of nan and the infinities
        raise ParameterError(name, value, "must be finite")
    # A power of 2 as large as the exponent says would fill the memory.
    if abs(exponent + bits) > MAX_EXPONENT / math.log10(2):
        raise ParameterError(name, value, TOO_FAR)
    magnitude = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    if sign:
        return -magnitude
    return magnitude


def scalar_of(name: str, value: Any) -> Any:
    """Return the entry of an array without dimensions, of any library; other values as they are.

    ParameterError, which calls it `name`, if the entry is masked.
    """
    if isinstance(value, int | float | str | Fraction) or not hasattr(type(value), "dtype"):
        return value
    if not is_scalar(value):
        return value
    unmasked(name, value)
    try:
        return value.__array__()[()]
    except Exception:  # of a library that does not give its numbers away, as inside a derivative
        return value


def is_scalar(value: Any) -> bool:
    """Return whether an object of a class with a dtype is an array without dimensions."""
    return getattr(value, "shape", None) == ()


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
        raise ParameterError(name, text, TOO_FAR)
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
        parts = value
    else:
        parts = (value,)
    if kind and any(isinstance(part, kind) and part.mask.any() for part in parts):
        raise ParameterError(name, "masked", "must be a number everywhere; some are masked")
    return value


def whole_number(name: str, value: Any, least: int | None = None, most: int | None = None) -> int:
    """Return `value` as an int, or raise ParameterError if it is not one or out of range."""
    try:
        entry = scalar_of(name, value)
        if type(entry).__name__ in ("bool", "bool_"):  # numpy need not be loaded
            number = None
        else:
            number = operator.index(entry)
    except Exception:  # whatever the methods of a class of numbers raise
        number = None
    if least is None:
        allowed = ""
    elif most is None:
        allowed = f" >= {least}"
    else:
        allowed = f" from {least} to {most}"
    too_small = least is not None and number is not None and number < least
    too_large = most is not None and number is not None and number > most
    if number is None or too_small or too_large:
        raise ParameterError(name, value, f"must be a whole number{allowed}")
    return number


def read_digits(digits: object, most: int = MOST_ASKED_DIGITS) -> int | None:
    """Check the argument `digits`: return a whole number, or None for doubles.

    ParameterError if out of range.
    """
    if digits is None:
        return None
    return whole_number("digits", digits, LEAST_ASKED_DIGITS, most)


def read_start_error(value: Any) -> tuple[Fraction, Fraction, Fraction] | None:
    """Return by how much t0, x0 and v0 may be off, exactly.

    `value` is one number >= 0 for all, or three numbers, or None.
    """
    if value is None:
        return None
    value = scalar_of("start_error", value)
    is_row = isinstance(value, list | tuple)
    if is_row or (hasattr(type(value), "dtype") and not is_scalar(value)):
        errors = list(value)
    else:
        errors = [value] * 3
    if len(errors) != 3:
        raise ParameterError("start_error", value, "must be a number, or three: of t0, x0 and v0")
    t0, x0, v0 = (read_exact("start_error", error) for error in errors)
    if min(t0, x0, v0) < 0:
        raise ParameterError("start_error", value, "must be >= 0")
    return t0, x0, v0


def power_of_ten(value: Fraction) -> int:
    """Return the exponent of the least power of ten that is not less than a number > 0."""
    # Not of the quotient, which may be beyond the range of doubles.
    return math.ceil(math.log10(value.numerator) - math.log10(value.denominator))


# A decimal is written with an exponent if it has more leading or trailing zeros than this, and as a
# fraction if it has more digits.
MOST_ZEROS = 20
LONGEST_DECIMAL = 60


def show(value: Fraction) -> str:
    """Return a short text that reads back as `value`: a decimal if 60 digits suffice, else a
    fraction.
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
    zeros_after = int(exponent)  # of a large number, before the point
    zeros_before = -1 - number.adjusted()  # of a small number, behind the point
    if max(zeros_after, zeros_before) <= MOST_ZEROS:
        return f"{number:f}"
    first, *rest = map(str, digits)
    return f"{'-' * sign}{first}{'.' * bool(rest)}{''.join(rest)}e{number.adjusted()}"


def as_source(text: str) -> str:
    """Return a number's text as Python source: in quotes if a float would not read
    as that number.
    """
    # A float is read as the decimal that it prints as; a fraction, or a decimal with more digits,
    # stays text.
    exact = "/" not in text and Fraction(str(float(text))) == Fraction(text)
    if exact:
        return text
    return repr(text)
