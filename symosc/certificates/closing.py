"""The closing equations of a periodic orbit in balls, and Krawczyk's proof that they have exactly one root in a box.

The unknowns are all switching points t_0, x_0, t_1, x_1, ..., and the equations those of `symosc.orbits`: each flight
ends on its belt, at the next point; each stick ends where the force on its side vanishes; the last piece ends where the
first begins, `periods` periods of the drive later.

Let f be these 2n functions, c the middle of a box X, J an enclosure of the Jacobian over X, Y any matrix. If

    K(X) = c - Y f(c) + (1 - Y J) (X - c)

lies inside X, then f has exactly one root in X, and it lies in K(X) (Krawczyk 1969). With constants that are balls this
holds for every value in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from flint import arb, arb_mat, ctx

from symosc.certificates.balls import Ball, Undecided
from symosc.certificates.flow import Flight, FlightStart, Oscillator
from symosc.orbits.closing_equations import OrbitPiece

MOST_POLISHINGS = 12
#: Boxes that are tried, as parts of the period and of the largest position: the first one that works is stated.
BOXES = (1e-7, 1e-9, 1e-12, 1e-16, 1e-20, 1e-26, 1e-34)
MOST_CONTRACTIONS = 4

Values = list[Ball]


class Root(NamedTuple):
    """A proven root: the box in which it is the only one, and a narrow enclosure; t_0, x_0, t_1, x_1, ..."""

    box: Values
    points: Values


class ClosingBalls:
    """The closing equations of one word, for one set of constants or a family of them.

    Parameters
    ----------
    oscillator : Oscillator
    pieces : tuple of OrbitPiece
    periods : int
    """

    def __init__(self, oscillator: Oscillator, pieces: tuple[OrbitPiece, ...], periods: int) -> None:
        self.oscillator, self.pieces = oscillator, pieces
        self.periods, self.turn = periods, 2 * periods * arb.pi() / oscillator.Omega

    def ends(self, values: Values) -> Values:
        """Return the points at the ends of the pieces: the next ones, and the first one a period later."""
        return [*values[2:], values[0] + self.turn, values[1]]

    def flight(self, i: int, values: Values) -> Flight:
        """Return the flight of piece i from its point."""
        piece, o = self.pieces[i], self.oscillator
        return Flight(o, piece.mode, FlightStart(values[2 * i], values[2 * i + 1], o.speed[piece.start]))

    def slipping(self, i: int) -> int:
        """Return the domain that stick i ends into."""
        return self.pieces[i].start + (self.pieces[i].side > 0)

    def left(self, i: int, values: Values, end: Values) -> tuple[Ball, Ball]:
        """Return the two residuals of piece i; balls or power series."""
        o, piece = self.oscillator, self.pieces[i]
        (t0, x0), (t1, x1) = values[2 * i : 2 * i + 2], end[2 * i : 2 * i + 2]
        if piece.sticks:
            speed = o.speed[piece.start]
            return x0 + speed * (t1 - t0) - x1, o.force(self.slipping(i), t1, x1, speed)
        flight = self.flight(i, values)
        there = flight.at(t1 - t0)
        return flight.x(there) - x1, there.v - o.speed[piece.end]

    def _slopes(self, i: int, values: Values, end: Values) -> tuple[Sequence[Ball], Sequence[Ball]]:
        """Return the derivatives of the two residuals of piece i by t and x at its start and t and x at its end."""
        o, piece = self.oscillator, self.pieces[i]
        t0, t1, v0, one, nought = values[2 * i], end[2 * i], o.speed[piece.start], arb(1), arb(0)
        if piece.sticks:
            return (-v0, one, v0, -one), (nought, nought, -o.drive * (o.Omega * t1).sin(), -o.km)
        flight = self.flight(i, values)
        there = flight.at(t1 - t0)
        phi, E, E1, a0 = there.phi, there.E, there.E1, flight.a0
        return (-v0 * phi - a0 * E, phi, there.v, -one), (o.km * E * v0 - a0 * E1, -o.km * E, there.a, nought)

    def residuals(self, values: Values) -> arb_mat:
        """Return f as a column."""
        end = self.ends(values)
        return arb_mat([[left] for i in range(len(self.pieces)) for left in self.left(i, values, end)])

    def jacobian(self, values: Values) -> arb_mat:
        """Return the derivatives of f."""
        n, end = len(self.pieces), self.ends(values)
        rows = [[arb(0)] * (2 * n) for _ in range(2 * n)]
        for i in range(n):
            for row, entries in zip(rows[2 * i : 2 * i + 2], self._slopes(i, values, end), strict=True):
                for j, entry in enumerate(entries, 2 * i):
                    row[j % (2 * n)] += entry
        return arb_mat(rows)

    def blocks(self, i: int, values: Values) -> tuple[arb_mat, arb_mat]:
        """Return the derivatives of the equations of piece i by t and x at its start, and by those at its end."""
        rows = self._slopes(i, values, self.ends(values))
        return arb_mat([list(row[:2]) for row in rows]), arb_mat([list(row[2:]) for row in rows])

    def polished(self, values: Values) -> Values:
        """Return exact numbers near a root, by Newton's method; they prove nothing.

        Raises
        ------
        Undecided
            If it does not settle.
        """
        values = [value.mid() for value in values]
        for _ in range(MOST_POLISHINGS):
            try:
                step = self.jacobian(values).mid().solve(self.residuals(values).mid())
            except ZeroDivisionError:
                break
            sizes = [abs(each.mid()) for each in step.entries()]
            values = [(value - each).mid() for value, each in zip(values, step.entries(), strict=True)]
            if not all(each.is_finite() for each in values):
                break
            scale = max((abs(value) for value in values), key=float)
            if all(each <= scale * arb(2) ** (16 - ctx.prec * 3 // 4) for each in sizes):
                return values
        raise Undecided("a root of the closing equations, which are singular or nearly so")

    def krawczyk(self, box: Values, about: Values | None = None) -> Values | None:
        """Return K(box) if it lies inside the box, else None; `about`: exact numbers to develop around."""
        middle = about or [each.mid() for each in box]
        J = self.jacobian(box)
        try:
            Y = J.mid().inv().mid()
        except ZeroDivisionError:
            return None
        left = Y * self.residuals(middle)
        rest = arb_mat([[(value - c)] for value, c in zip(box, middle, strict=True)])
        unit = arb_mat([[int(i == j) for j in range(len(box))] for i in range(len(box))])
        moved = (unit - Y * J) * rest - left
        image = [c + each for c, each in zip(middle, moved.entries(), strict=True)]
        inside = all(value.contains_interior(each) for value, each in zip(box, image, strict=True))
        return image if inside else None

    def boxes(self, middle: Values, largest: float = 1.0) -> Iterator[Root]:
        """Yield proven roots about exact numbers, the one that is alone in the widest box first.

        `largest`: widest box that is tried, as a part of the period and of the largest position.
        """
        sizes = self.turn.mid(), max((abs(value) for value in middle[1::2]), key=float) + 1
        for part in BOXES:
            if part > largest:
                continue
            box = [value + arb(0, (part * sizes[j % 2]).mid()) for j, value in enumerate(middle)]
            image = self.krawczyk(box, middle)
            if image is not None:
                yield Root(box, self.narrowed(image))

    def narrowed(self, box: Values) -> Values:
        """Return a narrower enclosure of the root in a box that is known to have exactly one."""
        for _ in range(MOST_CONTRACTIONS):
            image = self.krawczyk(box)
            if image is None:
                break
            done = all(float(a.rad()) > 0.25 * float(b.rad()) for a, b in zip(image, box, strict=True))
            box = image
            if done:
                break
        return box
