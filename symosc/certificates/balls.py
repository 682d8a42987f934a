"""Ball arithmetic: python-flint's arb, exact input, signs that are certain, decimals rounded outward.

The working precision of arb is global to the process. It is set with `working_bits`, which gives it back; nothing
here may run in threads.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal, localcontext
from fractions import Fraction
from typing import Any, TypeAlias

from symosc.errors import MissingExtraError

try:
    from flint import __version__ as FLINT_VERSION
    from flint import arb, ctx, fmpq
except ImportError:
    raise MissingExtraError("certify", "certify") from None

#: Before it, the negative of a ball was wrong.
OLDEST_FLINT = (0, 9)
if tuple(int(part) for part in FLINT_VERSION.split(".")[:2]) < OLDEST_FLINT:
    raise MissingExtraError(f"certify with python-flint {FLINT_VERSION}, which has unsound balls,", "certify")

#: A ball: an enclosure of a real number.
Ball: TypeAlias = Any


class Undecided(Exception):
    """A sign or a bracket that these balls leave open; more bits, or a better known start, may decide it.

    Attributes
    ----------
    what : str
        What is open, in words.
    near : ball or None
        The time near which it is.
    touch : tuple or None
        The wall that may be touched, the time after the start of the flight where it may be, if that is what is open.
    """

    def __init__(self, what: str, near: Ball | None = None, touch: tuple[int, Ball] | None = None) -> None:
        self.what, self.near, self.touch = what, near, touch
        super().__init__(what)


@contextmanager
def working_bits(bits: int) -> Iterator[None]:
    """Work with that many bits, and give back the precision that was set before."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def ball(number: Fraction | int) -> Ball:
    """Return an enclosure of a rational number."""
    return arb(fmpq(number.numerator, number.denominator))


def around(middle: Ball, radius: Ball) -> Ball:
    """Return the ball of all numbers within `radius` of those in `middle`."""
    return middle + arb(0, abs(radius).upper())


def hull(low: Ball, high: Ball) -> Ball:
    """Return a ball that contains both balls and all between them."""
    return low.union(high)


def sure_sign(value: Ball) -> int:
    """Return the sign of all numbers in a ball, 0 if they have not all the same one."""
    return 1 if value > 0 else -1 if value < 0 else 0


def decided_sign(value: Ball, what: str, near: Ball | None = None) -> int:
    """Return the sign of all numbers in a ball; Undecided if they have not all the same one."""
    sign = sure_sign(value)
    if sign == 0:
        raise Undecided(what, near)
    return sign


def size(value: Ball) -> float:
    """Return a float near the largest size in a ball; it proves nothing."""
    return float(abs(value).upper())


def exact_ends(value: Ball) -> tuple[Fraction, Fraction]:
    """Return the ends of a ball as exact fractions, from its middle and radius."""
    middle, radius = (_exact(part) for part in (value.mid(), value.rad()))
    return middle - radius, middle + radius


def _exact(point: Ball) -> Fraction:
    mantissa, exponent = point.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def outward(value: Ball, digits: int) -> tuple[str, str]:
    """Return the ends of a ball as decimals, the lower one rounded down and the higher one up.

    They are one unit of the last digit further apart than they must be, so that somebody who knows the number only a
    little better can prove them.
    """
    low, high = exact_ends(value)
    scale = max(abs(low), abs(high), Fraction(1))
    unit = Fraction(10) ** (len(str(int(scale))) - digits)
    return _decimal(low - unit, unit, ROUND_FLOOR), _decimal(high + unit, unit, ROUND_CEILING)


def _decimal(value: Fraction, unit: Fraction, rounding: str) -> str:
    steps = value / unit
    count = (
        -(-steps.numerator // steps.denominator) if rounding == ROUND_CEILING else steps.numerator // steps.denominator
    )
    exact = count * unit
    with localcontext() as context:
        context.prec = len(str(abs(exact.numerator))) + len(str(exact.denominator)) + 5
        return format(Decimal(exact.numerator) / Decimal(exact.denominator), "f")
