"""The numbers of a problem: their meaning, units, and expressions and quantities read as exact
numbers.

An expression such as "3*pi/2" is exact if it has numbers, + - * / ^ and parentheses alone. With pi,
sqrt, sin, cos or exp an enclosure is computed and rounded to 40 digits, which are right; a value
whose digits cancel is refused. A quantity such as "3 kg" or "60 rpm" (extra `units`: pint) becomes
the number in kg, m, s, N and rad.
"""

from __future__ import annotations

import numbers
import re
from contextlib import suppress
from decimal import ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from symosc.base.errors import ParameterError, optional
from symosc.base.exact import NOT_FINITE, NUMBER, SMALLEST, read_exact, show
from symosc.base.expressions import ExactPhase, enclosed, evaluated


class Quantity(NamedTuple):
    """A parameter or start value of the problem: its meaning, dimension, letter in LaTeX, and
    allowed range.
    """

    meaning: str
    dimension: str
    letter: str
    allowed: str = ""


#: All parameters, in order, and the numbers of a start. Any consistent system of units will do for
#: them.
QUANTITIES = {
    "m": Quantity("mass", "mass", "m", "> 0"),
    "c": Quantity("damping", "mass/time", "c", ">= 0"),
    "k": Quantity("stiffness", "mass/time^2", "k", ">= 0"),
    "A0": Quantity("constant force", "force", "A_0"),
    "B0": Quantity("amplitude of the excitation", "force", "B_0", "any sign"),
    "Omega": Quantity("frequency of the excitation", "angle/time", r"\Omega", "> 0"),
    "v1": Quantity("speed of belt 1", "length/time", "v_1", "less than v2"),
    "v2": Quantity("speed of belt 2", "length/time", "v_2"),
    "mu1": Quantity("friction coefficient of belt 1", "1", r"\mu_1", ">= 0"),
    "mu2": Quantity("friction coefficient of belt 2", "1", r"\mu_2", ">= 0"),
    "FN": Quantity("normal force", "force", "F_N", ">= 0"),
    # of any belt (`symosc.belts.Belt`)
    "v": Quantity("speed of a belt", "length/time", "v"),
    "mu": Quantity("kinetic coefficient of friction", "1", r"\mu", ">= 0"),
    "mu_s": Quantity("static coefficient of friction", "1", r"\mu_s", ">= 0"),
    "w": Quantity("relative speed of a belt", "length/time", "w", ">= 0"),
    "slope": Quantity(
        "slope of friction beyond the curve of a belt", "time/length", r"\mu'", ">= 0"
    ),
    "mu_s1": Quantity("static coefficient of belt 1", "1", r"\mu_{s,1}", ">= 0"),
    "mu_s2": Quantity("static coefficient of belt 2", "1", r"\mu_{s,2}", ">= 0"),
    "t0": Quantity("start time", "time", "t_0"),
    "x0": Quantity("start position", "length", "x_0"),
    "v0": Quantity("start velocity", "length/time", "v_0"),
    "t_end": Quantity("end time", "time", r"t_\mathrm{end}", "later than t0"),
    "skip": Quantity("time that is left out", "time", ""),
    "periods": Quantity("number of forcing periods", "1", "N"),
    # of other models (`symosc.reductions`)
    "phase": Quantity("phase of the excitation", "angle", r"\varphi"),
    "Y": Quantity("amplitude of the base", "length", "Y"),
    "Y_phase": Quantity("phase of the base", "angle", r"\varphi_Y"),
    "pull": Quantity("constant speed of the base", "length/time", "u"),
    "W": Quantity("amplitude of the belts' speeds", "length/time", "W"),
    "W_phase": Quantity("phase of the belts' speeds", "angle", r"\varphi_W"),
    "g": Quantity("gravity", "length/time^2", "g"),
    "angle": Quantity("slope down which x is counted", "angle", r"\alpha"),
}


def check_range(name: str, value: Fraction) -> None:
    """Raise ParameterError if the parameter `name` may not have this value."""
    lowest = least(name)
    if lowest is None or value >= lowest:
        return
    if 0 < value < lowest:
        allowed = f"at least {float(lowest):g}"
    else:
        allowed = quantity_of(name).allowed
    raise ParameterError(name, show(value), f"must be {allowed}")


#: The unit of each dimension in scene files where a number has one; plain numbers of such a file
#: are in these too.
UNITS = {
    "mass": "kg", "mass/time": "kg/s", "mass/time^2": "N/m", "force": "N", "angle/time": "rad/s", "length/time": "m/s",
    "1": "1", "time": "s", "length": "m", "angle": "rad", "length/time^2": "m/s^2",
    "time/length": "s/m",
}  # fmt: skip


class NumberOfBelt(NamedTuple):
    """What the name of a belt's number says, such as mu1_2: the `quantity` mu, of belt 1 (`belt`),
    at the point 2 of its friction curve (`point`; 0: at the belt's speed).
    """

    quantity: str
    belt: int
    point: int = 0

    def __str__(self) -> str:
        if self.point:
            return f"{self.quantity}{self.belt}_{self.point}"
        return f"{self.quantity}{self.belt}"


_NUMBER_OF_BELT = re.compile(r"([a-z_]+)([1-9]\d*)(?:_([1-9]\d*))?", re.ASCII)


def number_of_belt(name: str) -> NumberOfBelt | None:
    """Return what the name of a belt's number says; None if it cannot be one."""
    read = _NUMBER_OF_BELT.fullmatch(name)
    if read is None:
        return None
    quantity, belt, point = read.groups(default="0")
    return NumberOfBelt(quantity, int(belt), int(point))


def quantity_of(name: str) -> Quantity:
    """Return the `Quantity` called `name`, which may be that of a belt's number, such as mu1_2.

    An index after the name, as in "Omega[3]", is ignored.
    """
    name, _, _ = name.partition("[")  # of a cell, such as "Omega[3]"
    number = number_of_belt(name)
    if name in QUANTITIES or number is None:
        return QUANTITIES[name]
    quantity = QUANTITIES[number.quantity]
    meaning = f"{quantity.meaning.removesuffix(' of a belt')} of belt {number.belt}"
    indices = f"{number.belt}"
    if number.point:
        meaning += f", point {number.point} of its curve"
        indices += f",{number.point}"
    letter, _, index = quantity.letter.partition("_")
    if index:
        indices = f"{index},{indices}"
    return quantity._replace(meaning=meaning, letter=f"{letter}_{{{indices}}}")


def least(name: str) -> Fraction | None:
    """Return the smallest value that a quantity may have; None if it may be negative."""
    return {"> 0": SMALLEST, ">= 0": Fraction(0)}.get(quantity_of(name).allowed)


def unit_of(name: str) -> str:
    """Return the unit of a parameter or start value."""
    return UNITS[quantity_of(name).dimension]


def read_number(name: str, value: Any) -> tuple[Fraction, bool]:
    """Return the number called `name`, whose `value` may be text such as "2*pi" or "3 kg", and
    whether it is exact.
    """
    # An expression of sympy, such as 2*pi.
    is_symbolic = hasattr(type(value), "free_symbols") and not isinstance(value, numbers.Real)
    if is_symbolic:
        text = str(value)
    else:
        text = value
    # `read_exact` refuses what is not finite.
    if (
        not isinstance(text, str)
        or NUMBER.fullmatch(text.strip())
        or NOT_FINITE.fullmatch(text.strip())
    ):
        return read_exact(name, text), True
    if is_quantity(text):
        return read_quantity(name, text)
    return read_expression(name, text)


def forcing_periods(name: str, text: Any) -> Fraction | None:
    """Return the number of drive periods that text such as "10T" gives, else None.

    Errors call the argument `name`.
    """
    if not (isinstance(text, str) and text.strip().endswith("T")):
        return None
    count = text.strip()[:-1].rstrip("* ")
    if not NUMBER.fullmatch(count):
        raise ParameterError(name, text, _forms(name))
    return read_exact(name, count)


#: Digits to which an expression with pi is known.
KNOWN_DIGITS = 40
A_NUMBER = "give a number such as 0.8 or '4/5'"
AN_EXPRESSION = (
    "or an expression such as '3*pi/2': numbers and pi with + - * / ^ ( ), sqrt(), sin(), cos() "
    "and exp()"
)
#: Times that may be given in periods of the drive.
IN_PERIODS = ("t_end", "skip")


def _forms(name: str) -> str:
    """Return in which forms the number called `name` may be given, for messages."""
    forms = [A_NUMBER]
    if name in IN_PERIODS:
        forms.append("periods of the drive such as '10T'")
    with suppress(KeyError):  # a number that is none of a problem has no unit
        unit = unit_of(name)
        if unit != "1":
            forms.append(f"a quantity such as '3 {unit}' (extra units)")
    return ", ".join([*forms, AN_EXPRESSION])


def read_expression(name: str, text: str) -> tuple[Fraction, bool]:
    """Return the value of an expression such as "3*pi/2" for the number `name`, and whether it is
    exact.
    """
    from mpmath import mp

    value = evaluated(name, text, _forms(name))
    if isinstance(value, ExactPhase) and value.multiple == 0:
        return value.rest, True
    interval = enclosed(value)
    # mpmath gives each end as an interval of itself; _mpi_ has the two equal ends of that.
    ends = (mp.make_mpf(end._mpi_[0]) for end in (interval.a, interval.b))
    low, high = (read_exact(name, end) for end in ends)
    # Five digits more than are kept have to be certain.
    if (high - low) * 10 ** (KNOWN_DIGITS + 5) > min(abs(low), abs(high)):
        raise ParameterError(
            name,
            text,
            f"its {KNOWN_DIGITS} digits cancel, so that they are not known; write it as a number, 0 if "
            "it is that",
        )
    return rounded((low + high) / 2), False


def rounded(value: Fraction) -> Fraction:
    """Return a number rounded to 40 significant digits."""
    context = Context(prec=KNOWN_DIGITS, rounding=ROUND_HALF_EVEN)
    return Fraction(context.divide(Decimal(value.numerator), Decimal(value.denominator)))


def half_unit(value: Fraction) -> Fraction:
    """Return half a unit of the 40th significant digit of a number."""
    exponent = Decimal(value.numerator).adjusted() - Decimal(value.denominator).adjusted() + 1
    return Fraction(10) ** (exponent - KNOWN_DIGITS) / 2


#: A number, and the name of a unit with powers of one digit.
_QUANTITY = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+/\d+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))\s*"
    r"(?P<unit>(?!pi\b|π|[eE][+-]?\d)(?:[^\W\d_]|[°%](?![\d.]))(?:[^\W\d_]|[\s°%*/^()·\-]|(?<!\d)\d(?!\d))*)"
)
#: A unit whose factor has more digits than this has pi in it, which is known to 50 digits in pint.
LONGEST_UNIT = 50
LONGEST_FACTOR = 30


def is_quantity(text: str) -> bool:
    """Return whether a text is a number followed by the name of a unit."""
    return _QUANTITY.fullmatch(text) is not None


def read_quantity(name: str, text: str) -> tuple[Fraction, bool]:
    """Return a number with a unit, such as "3 cm", in the unit of the number `name`, and whether it
    is exact.
    """
    parts = _QUANTITY.fullmatch(text)
    own_unit = unit_of(name)
    meaning = quantity_of(name).meaning
    is_pure = own_unit == "1"
    if is_pure:
        allowed = f"{name} is the {meaning}, a number without a unit"
    else:
        in_unit = f"give it in {own_unit}, or in a unit of the same kind"
        if name in IN_PERIODS:
            in_unit += ", or in periods of the drive such as '10T'"
        allowed = f"{name} is the {meaning}: {in_unit}"
    refused = ParameterError(name, text, allowed)
    if parts is None or len(parts["unit"]) > LONGEST_UNIT:
        raise refused
    if parts["unit"].strip() == "%":  # of a number without a unit; needs no table of units
        if not is_pure:
            raise refused
        return read_exact(name, parts["number"]) / 100, True
    registry = _registry()
    try:
        unit_given = registry.parse_units(
            parts["unit"].strip().replace("^", "**").replace("·", "*")
        )
        if is_pure:
            unit = "dimensionless"
        else:
            unit = registry.parse_units(own_unit)
        # Both count turns or radians, and do not say which.
        is_ambiguous = own_unit == "rad/s" and any(
            part.endswith(("hertz", "counts_per_second")) for part in unit_given._units
        )
        factor = Fraction(registry.Quantity(Fraction(1), unit_given).to(unit).magnitude)
    except Exception:  # pint has a dozen kinds, some of them AssertionError and TypeError
        raise refused from None
    if is_ambiguous:
        raise ParameterError(
            name, text, "hertz may mean turns or radians per second: write turn/s or rad/s"
        )
    number = read_exact(name, parts["number"]) * factor
    # A factor with more digits is a rounded constant, such as pi.
    is_exact = max(len(str(factor.numerator)), len(str(factor.denominator))) <= LONGEST_FACTOR
    return (number if is_exact else rounded(number)), is_exact


@cache
def _registry() -> Any:
    """Return pint's registry of units; MissingExtraError without pint."""
    pint = optional("pint", "a number with a unit", "units")
    return pint.UnitRegistry(non_int_type=Fraction)
