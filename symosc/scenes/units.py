"""Quantities such as "3 kg" or "60 rpm" in scene files, as plain numbers in kg, m, s, N and rad (extra `units`).

pint knows the units. No unit is kept: what comes out is the same fraction that a user would have written.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache
from typing import Any

from symosc.errors import MissingExtraError, ParameterError
from symosc.exact import read_exact
from symosc.scenes.quantities import QUANTITIES, unit_of

#: A number, and the name of a unit with powers of one digit.
QUANTITY = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+/\d+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))\s*"
    r"(?P<unit>(?!pi\b)[^\W\d_]|[°%](?![\d.]))(?P<rest>(?:[^\W\d_]|[\s°%*/^()·\-]|(?<!\d)\d(?!\d))*)"
)
LONGEST_UNIT = 50
#: Names of units that count turns or radians, and do not say which.
AMBIGUOUS = ("hertz", "counts_per_second")
#: A unit whose factor has more digits than this has pi in it, which is known to 50 digits in pint.
LONGEST_FACTOR = 30


def is_quantity(text: str) -> bool:
    """Tell whether a text is a number with the name of something behind it."""
    return QUANTITY.fullmatch(text) is not None


def read_quantity(name: str, text: str) -> tuple[Fraction, bool]:
    """Return a quantity as a number in the unit of its dimension, and whether it is exact.

    Raises
    ------
    ParameterError
        If the unit is unknown, of another dimension, or hertz, which can mean two things.
    MissingExtraError
        If pint is not installed.
    """
    parts = QUANTITY.fullmatch(text)
    wanted, what = unit_of(name), QUANTITIES[name][0]
    allowed = f"{name} is a {what}: give it in {wanted}, or in a unit of the same kind"
    if wanted == "1":
        allowed = f"{name} is a {what}, a number without a unit"
    if parts is None or len(parts["unit"] + parts["rest"]) > LONGEST_UNIT:
        raise ParameterError(name, text, allowed)
    unit = (parts["unit"] + parts["rest"]).strip()
    factor = _factor(name, text, unit, wanted, allowed)
    exact = max(len(str(factor.numerator)), len(str(factor.denominator))) <= LONGEST_FACTOR
    return read_exact(name, parts["number"]) * factor, exact


def _factor(name: str, text: str, unit: str, wanted: str, allowed: str) -> Fraction:
    registry = _registry()
    try:
        given = registry.parse_units(unit.replace("^", "**").replace("·", "*"))
        if wanted == "rad/s" and any(part.endswith(AMBIGUOUS) for part in given._units):
            raise ParameterError(name, text, "hertz may mean turns or radians per second: write turn/s or rad/s")
        if dict(given.dimensionality) == {} and wanted == "1":
            return Fraction(registry.Quantity(Fraction(1), given).to("dimensionless").magnitude)
        if wanted == "1":
            raise ParameterError(name, text, allowed)
        return Fraction(registry.Quantity(Fraction(1), given).to(registry.parse_units(wanted)).magnitude)
    except ParameterError:
        raise
    except Exception:  # pint has a dozen kinds, some of them AssertionError and TypeError
        raise ParameterError(name, text, allowed) from None


@cache
def _registry() -> Any:
    try:
        import pint
    except ImportError:
        raise MissingExtraError("a number with a unit in a scene", "units") from None
    return pint.UnitRegistry(non_int_type=Fraction)
