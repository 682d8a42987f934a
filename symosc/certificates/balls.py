"""Ball arithmetic: python-flint's arb, exact input, certain signs, decimals rounded outward.

Sets of states.

The working precision of arb is global to the process. `ctx.workprec` sets and restores it; nothing
here may run in threads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from decimal import Decimal, localcontext
from fractions import Fraction
from math import ceil, floor
from typing import Any, TypeAlias

from symosc.base.errors import MissingExtraError

try:
    from flint import __version__ as FLINT_VERSION
    from flint import arb, fmpq
except ImportError:
    raise MissingExtraError("certify", "certify") from None

if tuple(int(part) for part in FLINT_VERSION.split(".")[:2]) < (
    0,
    9,
):  # before it, the negative of a ball was wrong.
    raise MissingExtraError(
        f"certify with python-flint {FLINT_VERSION}, which has unsound balls,", "certify"
    )

#: A ball: an enclosure of a real number.
Ball: TypeAlias = Any
Matrix: TypeAlias = Sequence[Sequence[Ball]]


class Undecided(Exception):
    """Raised if balls cannot decide a sign.

    A higher precision, or a smaller error of the start, may decide it.
    """

    # `near` is a time nearby. If a graze is possible, `graze` has the belt and the time after the
    # start of the flight.

    def __init__(
        self, what: str, near: Ball | None = None, graze: tuple[int, Ball] | None = None
    ) -> None:
        self.what = what
        self.near = near
        self.graze = graze
        super().__init__(what)

    def place(self) -> str:
        """Return the text " near t = ..." for a message; "" if no time is known."""
        if self.near is None:
            return ""
        return f" near t = {self.near.mid().str(15, radius=False)}"


def made_by(bits: int) -> dict[str, Any]:
    """Return {"made_by": text}, the entry of a file that names symosc, the version of python-flint,
    and the `bits`.
    """
    return {"made_by": f"symosc, python-flint {FLINT_VERSION}, {bits} bits"}


def ball(number: Fraction | int) -> Ball:
    """Return an enclosure of a rational number."""
    return arb(fmpq(number.numerator, number.denominator))


def around(middle: Ball, radius: Ball) -> Ball:
    """Return the ball of all numbers within `radius` of those in `middle`."""
    return middle + arb(0, abs(radius).upper())


def sure_sign(value: Ball) -> int:
    """Return the sign of all numbers in a ball, 0 if they differ in sign."""
    if value > 0:
        return 1
    if value < 0:
        return -1
    return 0


def decided_sign(value: Ball, what: str, near: Ball | None = None) -> int:
    """Return the sign that all numbers in a ball have; else raise Undecided with the text `what`
    and time `near`.
    """
    sign = sure_sign(value)
    if sign == 0:
        raise Undecided(what, near)
    return sign


def size(value: Ball) -> float:
    """Return a float near the largest absolute value in a ball, not a bound."""
    return float(abs(value).upper())


def exact_ends(value: Ball) -> tuple[Fraction, Fraction]:
    """Return the ends of a ball as exact fractions, from its middle and radius."""
    middle, radius = (
        Fraction(int(part.p), int(part.q)) for part in (value.mid().fmpq(), value.rad().fmpq())
    )
    return middle - radius, middle + radius


def outward(value: Ball, digits: int) -> tuple[str, str]:
    """Return both ends of a ball as decimal texts, the lower one rounded down and the upper one up."""
    # The ends are one unit of the last digit further apart than necessary, so that a checker can
    # prove them whose ball is about as wide as this one.
    low, high = exact_ends(value)
    scale = max(abs(low), abs(high), Fraction(1))
    unit = Fraction(10) ** (len(str(int(scale))) - digits)
    return _decimal(floor(low / unit - 1) * unit), _decimal(ceil(high / unit + 1) * unit)


def _decimal(exact: Fraction) -> str:
    """Return a fraction that is a finite decimal as text, with all digits."""
    with localcontext(prec=len(str(abs(exact.numerator))) + len(str(exact.denominator)) + 5):
        return format(Decimal(exact.numerator) / Decimal(exact.denominator), "f")


@dataclass(frozen=True)
class StateSet:
    """A set of states: all sums ``centre + matrix y``, where the vector y is anywhere in `box`.

    Centre and matrix are exact. The box has a ball around 0 for each component of y.
    """

    # The image of a map with the value f at the centre and the Jacobian J over the whole set lies
    # in f + (J matrix) y (mean value theorem). It is turned into an orthogonal frame along its
    # longest side (Lohner's QR), in which the box stays small where the map contracts: sets do not
    # grow by being put into boxes. `slopes` are the derivatives by the coordinates of the box with
    # which the set began, over the whole set.

    centre: Sequence[Ball]
    matrix: Matrix
    box: Sequence[Ball]
    slopes: Matrix = field(default=(), compare=False)

    @classmethod
    def of(cls, values: Sequence[Ball]) -> StateSet:
        """Return the set of all states within the given balls: a box along the axes."""
        count = len(values)
        unit = [[arb(int(i == j)) for j in range(count)] for i in range(count)]
        return cls(
            [value.mid() for value in values], unit, [value - value.mid() for value in values], unit
        )

    @property
    def thin(self) -> bool:
        """Whether the set is a single point."""
        return all(y.is_zero() for y in self.box)

    def hull(self) -> list[Ball]:
        """Return the smallest box around the set, up to rounding."""
        return [c + _dot(row, self.box) for c, row in zip(self.centre, self.matrix, strict=True)]

    def image(self, value: Sequence[Ball], jacobian: Matrix) -> StateSet:
        """Return a set that contains the image under a map, by its `value` at the centre and
        `jacobian` over all.
        """
        carried, slopes = (
            [[_dot(row, column) for column in zip(*each, strict=True)] for row in jacobian]
            for each in (self.matrix, self.slopes)
        )
        centre = [each.mid() for each in value]
        rest = [each - c for each, c in zip(value, centre, strict=True)]
        p, q = _direction(carried, self.box)
        box = []
        for row in ([p, q], [-q, p]):  # the inverse of the frame, times the square of its length
            turned = [_dot(row, column) for column in zip(*carried, strict=True)]
            box.append((_dot(turned, self.box) + _dot(row, rest)) / (p * p + q * q))
        return StateSet(centre, [[p, -q], [q, p]], box, slopes)


def _dot(row: Sequence[Ball], column: Sequence[Ball]) -> Ball:
    """Return the scalar product of a row and a column."""
    return sum((a * b for a, b in zip(row, column, strict=True)), arb(0))


def _direction(carried: Matrix, box: Sequence[Ball]) -> tuple[Ball, Ball]:
    """Return a vector of two exact balls along the longest side of the parallelogram `carried` y, y
    in `box`.
    """
    sides = [(a.mid() * y.rad(), b.mid() * y.rad()) for a, b, y in zip(*carried, box, strict=True)]
    a, b = max(sides, key=lambda side: (abs(side[0]) + abs(side[1])).mid())
    length = (abs(a) + abs(b)).mid()
    if length.is_zero():
        return arb(1), arb(0)
    p, q = (arb(float((each / length).mid())) for each in (a, b))
    return p, q
