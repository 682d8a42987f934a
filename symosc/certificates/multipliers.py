"""Multipliers of an orbit, enclosed, and whether they lie inside the unit circle.

The monodromy matrix is the product of the pieces (`symosc.orbits.floquet`), here with balls. The multipliers are the
roots of z^2 - T z + D, with its trace T and determinant D. Both lie inside the unit circle if and only if |D| < 1 and
|T| < 1 + D (Schur and Cohn).
"""

from __future__ import annotations

from typing import NamedTuple

from flint import arb

from symosc.certificates.balls import Ball, hull
from symosc.certificates.closing import ClosingBalls, Values

#: Multipliers whose difference squared is less than this are enclosed together.
NEARLY_DOUBLE = arb(2) ** -90


class Multiplier(NamedTuple):
    """Enclosures of the real and the imaginary part of a multiplier."""

    re: Ball
    im: Ball


class Stability(NamedTuple):
    """Trace and determinant of the monodromy matrix, as balls."""

    trace: Ball
    determinant: Ball

    @property
    def stable(self) -> bool | None:
        """Whether both multipliers are surely inside the unit circle; False: one is surely outside; None: open."""
        T, D = self.trace, self.determinant
        if abs(D) < 1 and abs(T) < 1 + D:
            return True
        return False if abs(D) > 1 or abs(T) > 1 + D else None

    def multipliers(self) -> tuple[Multiplier, Multiplier]:
        """Return both, the larger one first if they are real."""
        half, nought = self.trace / 2, arb(0)
        square = half * half - self.determinant
        if self.determinant.is_zero():
            return Multiplier(self.trace, nought), Multiplier(nought, nought)
        if abs(square) < NEARLY_DOUBLE:  # real or complex: who proves it again may not be able to tell
            square = hull(-NEARLY_DOUBLE, NEARLY_DOUBLE)
        if square < 0:
            turn = (-square).sqrt()
            return Multiplier(half, turn), Multiplier(half, -turn)
        if square > 0 and not half.contains(0):
            root = square.sqrt()
            large = half + root if half > 0 else half - root
            return Multiplier(large, nought), Multiplier(self.determinant / large, nought)
        reach = abs(square).upper().sqrt()
        around = hull(-reach, reach)
        if square > 0:
            root = square.sqrt()
            return Multiplier(half + root, nought), Multiplier(half - root, nought)
        return Multiplier(half + around, around), Multiplier(half + around, around)


def stability(closing: ClosingBalls, values: Values) -> Stability:
    """Return trace and determinant of the monodromy matrix of the root in `values`."""
    o, pieces, ends = closing.oscillator, closing.pieces, closing.ends(values)
    (xx, xv), (vx, vv) = (arb(1), arb(0)), (arb(0), arb(1))
    determinant = (-o.cm * closing.turn).exp()
    for i, piece in enumerate(pieces):
        if piece.sticks:
            continue
        flight = closing.flight(i, values)
        there = flight.at(ends[2 * i] - values[2 * i])
        ratio, following = arb(0), pieces[(i + 1) % len(pieces)]
        if not following.sticks:
            force = o.force(following.mode, ends[2 * i], ends[2 * i + 1], o.speed[piece.end])
            ratio = force / there.a
        down, E, E1, phi = -o.km * there.E, there.E, there.E1, there.phi
        xx, xv, vx, vv = (
            phi * xx + E * vx,
            phi * xv + E * vv,
            ratio * (down * xx + E1 * vx),
            ratio * (down * xv + E1 * vv),
        )
        determinant = determinant * ratio
    return Stability(xx + vv, determinant)
