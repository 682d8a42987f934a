"""Sets of states that are carried from event to event without growing by being put into boxes.

A set is ``centre + matrix y`` with an exact centre, a matrix of exact numbers and y in a box of balls around 0. The
image of a map with the value f at the centre and the Jacobian J over the whole set lies in ``f + (J matrix) y`` (mean
value theorem). It is turned into an orthogonal frame along its longest side (Lohner's QR), in which the box stays
small where the map contracts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from flint import arb

from symosc.certificates.balls import Ball

Matrix = Sequence[Sequence[Ball]]


@dataclass(frozen=True)
class StateSet:
    """A set of states.

    Attributes
    ----------
    centre : list of exact balls
    matrix : rows of exact balls
    box : list of balls around 0
    slopes : rows of balls
        The derivatives by the numbers of the box that the set began as, over the whole set.
    """

    centre: Sequence[Ball]
    matrix: Matrix
    box: Sequence[Ball]
    slopes: Matrix = field(default=(), compare=False)

    @classmethod
    def of(cls, values: Sequence[Ball]) -> StateSet:
        """Return the box of the given balls."""
        count = len(values)
        unit = [[arb(int(i == j)) for j in range(count)] for i in range(count)]
        return cls([value.mid() for value in values], unit, [value - value.mid() for value in values], unit)

    @property
    def thin(self) -> bool:
        """Whether it is a point."""
        return all(y.is_zero() for y in self.box)

    def hull(self) -> list[Ball]:
        """Return the smallest box around the set, up to rounding."""
        return [c + _row(row, self.box) for c, row in zip(self.centre, self.matrix, strict=True)]

    def mapped(self, value: Sequence[Ball], jacobian: Matrix) -> StateSet:
        """Return a set that contains the image, in the plane, by a map with this value at the centre.

        Parameters
        ----------
        value : two balls
        jacobian : two rows
            Enclosures of the derivatives over the whole set.
        """
        carried, slopes = (
            [[_row(row, column) for column in zip(*each, strict=True)] for row in jacobian]
            for each in (self.matrix, self.slopes)
        )
        centre = [each.mid() for each in value]
        rest = [each - c for each, c in zip(value, centre, strict=True)]
        p, q = _direction(carried, self.box)
        inverse = [[p, q], [-q, p]]
        box = []
        for row in inverse:  # of the frame, times the square of its length
            turned = [_row(row, column) for column in zip(*carried, strict=True)]
            box.append((_row(turned, self.box) + _row(row, rest)) / (p * p + q * q))
        return StateSet(centre, [[p, -q], [q, p]], box, slopes)


def _row(row: Sequence[Ball], column: Sequence[Ball]) -> Ball:
    total = row[0] * column[0]
    for a, b in zip(row[1:], column[1:], strict=True):
        total += a * b
    return total


def _direction(carried: Matrix, box: Sequence[Ball]) -> tuple[Ball, Ball]:
    """Return the direction of the longest side, as two exact numbers."""
    sides = [(a.mid() * y.rad(), b.mid() * y.rad()) for a, b, y in zip(*carried, box, strict=True)]
    a, b = max(sides, key=lambda side: (abs(side[0]) + abs(side[1])).mid())
    length = (abs(a) + abs(b)).mid()
    if length.is_zero():
        return arb(1), arb(0)
    p, q = (arb(float((each / length).mid())) for each in (a, b))
    return p, q
