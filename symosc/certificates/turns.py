"""Where the drift -(k v + B0 Omega sin(Omega t)) of a belt turns: the Theta_cr of Theorem 7, as enclosed times.

It is the right side of L g = drift/m for the gap g = v - v_belt in every domain, and m dF/dt of both forces on the
belt. Between the turns it keeps its sign, which is known from their order and needs no evaluation.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from flint import arb

from symosc.certificates.balls import Ball, Undecided, ball
from symosc.model import Parameters


class Turns:
    """The turns of the drift of one belt.

    Attributes
    ----------
    constant : int or None
        The sign of the drift if it never changes.
    """

    def __init__(self, p: Parameters, boundary: int) -> None:
        bias, amplitude = p.k * p.belt(boundary), p.B0 * p.Omega
        self.Omega, self.constant, self.rising = ball(p.Omega), None, (p.B0 > 0) - (p.B0 < 0)
        self.period = 2 * arb.pi() / self.Omega
        #: Whether the forces on the belt repeat with the drive.
        self.repeats = bias == 0
        if abs(bias) >= abs(amplitude):
            self.constant = (bias < 0) - (bias > 0)
        else:
            ratio: Fraction = -bias / amplitude
            self.angle = ball(ratio).asin()

    def time(self, index: int) -> Ball:
        """Return the time of a turn; from those of even index on sin(Omega t) is above its turning value."""
        turn, odd = divmod(index, 2)
        angle = arb.pi() - self.angle if odd else self.angle
        return (angle + 2 * turn * arb.pi()) / self.Omega

    def first_after(self, t: Ball) -> int:
        """Return the index of the first turn after t; one that is exactly at t is behind it."""
        phase = (self.Omega * t).mid()
        turns = int((phase / (2 * arb.pi())).mid().floor().unique_fmpz())
        index = 2 * turns - 2
        while True:
            time = self.time(index)
            if time > t:
                return index
            if not time <= t:
                raise Undecided("a start near a turn of the forces", t)
            index += 1

    def pieces(self, t: Ball) -> Iterator[tuple[Ball | None, int]]:
        """Yield the turns after t (None: never) and the sign of the drift before each."""
        if self.constant is not None:
            yield None, self.constant
            return
        index = self.first_after(t)
        while True:
            before_is_even = index % 2 == 1  # the turn before this one
            yield self.time(index), (-self.rising if before_is_even else self.rising)
            index += 1
