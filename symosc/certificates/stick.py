"""The end of a stick: both exits, by the monotone pieces of the forces between their turns.

On a belt F^(below) and F^(above) change alike, and between two turns (`symosc.certificates.turns`) monotonically. A
falling piece can only end the stick downwards, where F^(below) reaches 0; a rising one only upwards, where F^(above)
does. So the sign at the end of each piece decides it. If the drift has no mean (v = 0 or k = 0), the forces repeat
with the drive: a stick that lasts for one period lasts for ever.
"""

from __future__ import annotations

from typing import NamedTuple

from symosc.certificates.balls import Ball, Undecided
from symosc.certificates.contact import MOST_PIECES, GapCurve, GapSample, zero_in
from symosc.certificates.flow import Oscillator
from symosc.certificates.turns import Turns


class StickStart(NamedTuple):
    """The start of a stick: the belt, and time and position as balls."""

    boundary: int
    t: Ball
    x: Ball


class Slip(NamedTuple):
    """The end of a stick: the domain into which, the time since its start, the derivative of the force there."""

    domain: int
    tau: Ball
    slope: Ball


#: A stick that never ends.
FOR_EVER = "for ever"


def force_on_belt(o: Oscillator, hold: StickStart, domain: int, side: int) -> GapCurve:
    """Return the acceleration in a domain beside the belt along a stick, times `side`, and its derivative."""
    speed, drift = o.speed[hold.boundary], o.km * o.speed[hold.boundary]

    def force(tau: Ball) -> GapSample:
        t = hold.t + tau
        value = o.force(domain, t, hold.x + speed * tau, speed)
        return GapSample(tau, side * value, -side * (drift + o.drive * (o.Omega * t).sin()))

    return force


def end_of_stick(o: Oscillator, hold: StickStart, turns: Turns, stop: Ball) -> Slip | str | None:
    """Return the end of a stick, FOR_EVER, or None if it lasts until `stop` at least.

    At its start F^(below) >= 0 >= F^(above) is known, and that it goes into the stick where one of them is 0.
    """
    begin = stop * 0
    for lasted, (turn, drift) in enumerate(turns.pieces(hold.t), 1):
        if drift == 0:
            return FOR_EVER
        end = stop if turn is None else turn - hold.t
        last = turn is None or end >= stop
        if last:
            end = stop
        domain = hold.boundary + (drift > 0)
        force = force_on_belt(o, hold, domain, -drift)
        there = force(end)
        if there.g < 0:
            tau = zero_in(force, begin, end, "the end of a stick", hold.t)
            return Slip(domain, tau, -drift * force(tau).dg)
        if not there.g > 0:
            raise Undecided("a stick that may end where a force turns", hold.t + end)
        if last:
            return None
        if turns.repeats and lasted > 2:
            return FOR_EVER
        if lasted > MOST_PIECES:
            raise Undecided(f"a stick of more than {MOST_PIECES} pieces", hold.t + end)
        begin = end
    return None
