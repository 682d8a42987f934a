"""That an orbit takes the course its word says: each piece ends where it first can, and goes on as the next one says.

A root of the closing equations says that a piece ends on its belt, not that it comes there first. So for each belt
around a flight the gap g has to be positive between its start and its end, and for each stick both forces that hold it.
This is proven from the left to the right, in steps whose lengths fit themselves. On a step from time a to time b, with
balls for all times between them, one of these is enough, g > 0 being known at a, or g = 0 at a start on the belt:

- g > 0 on the whole step;
- g' > 0 on the whole step;
- the step begins with the flight, g = g' = 0 there (it leaves a stick), and g'' > 0 on the whole step;
- the step ends with the flight, g = 0 there, and g' < 0 on the whole step.

No turning points of the forces enter: the steps may begin and end anywhere.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from flint import arb

from symosc.certificates.balls import Ball, Undecided, hull, sure_sign
from symosc.certificates.closing import ClosingBalls, Values
from symosc.certificates.flow import Flight, Oscillator

MOST_COURSE_STEPS = 4000
#: First step, as a part of the piece; shortest step.
FIRST_COURSE_STEP, SHORTEST_COURSE_STEP = 1 / 8, 2.0**-60


class Jet(NamedTuple):
    """Enclosures of a function and of its first two derivatives."""

    g: Ball
    dg: Ball
    ddg: Ball


Curve = Callable[[Ball], Jet]


class Margin(NamedTuple):
    """One thing that must stay positive: what it says, the function, and whether it is 0 at its start and its end.

    Attributes
    ----------
    what : str
    curve : callable
    at_start : int
        How many of g, g' are 0 at the start.
    at_end : bool
        Whether g is 0 at the end.
    """

    what: str
    curve: Curve
    at_start: int
    at_end: bool


def gap_curve(flight: Flight, boundary: int) -> Curve:
    """Return the gap between a flight and a belt, positive on the side of the flight."""
    speed, side = flight.oscillator.speed[boundary], 1 if flight.domain > boundary else -1

    def gap(tau: Ball) -> Jet:
        there = flight.at(tau)
        return Jet(side * (there.v - speed), side * there.a, side * flight.jerk(there))

    return gap


def force_curve(o: Oscillator, boundary: int, domain: int, t: Ball, x: Ball) -> Curve:
    """Return the force in a domain beside a belt along a stick from (t, x), positive while it holds."""
    speed, side = o.speed[boundary], 1 if domain == boundary else -1

    def force(tau: Ball) -> Jet:
        time = t + tau
        s, c = (o.Omega * time).sin_cos()
        value = (o.A[domain] + o.B0 * c - o.k * (x + speed * tau) - o.c * speed) / o.m
        return Jet(side * value, -side * (o.km * speed + o.drive * s), -side * o.drive * o.Omega * c)

    return force


def borders(closing: ClosingBalls, i: int, values: Values) -> list[Margin]:
    """Return what must stay positive on piece i."""
    o, piece = closing.oscillator, closing.pieces[i]
    if piece.sticks:
        found = []
        for domain in (piece.start, piece.start + 1):
            curve = force_curve(o, piece.start, domain, values[2 * i], values[2 * i + 1])
            ends = domain == closing.slipping(i)
            relation = ">" if domain == piece.start else "<"
            found.append(Margin(f"F^({domain}) {relation} 0 during {piece.label}", curve, 0, ends))
        return found
    flight, found = closing.flight(i, values), []
    for boundary in (piece.mode - 1, piece.mode):
        if boundary in (1, 2):
            roots = 0 if boundary != piece.start else 2 if piece.after_stick else 1
            what = f"v {'>' if piece.mode > boundary else '<'} v{boundary} during {piece.label}"
            found.append(Margin(what, gap_curve(flight, boundary), roots, boundary == piece.end))
    return found


def prove_positive(border: Margin, span: Ball) -> None:
    """Prove that a border stays positive between 0 and a time that lies in `span`.

    Raises
    ------
    Undecided
    """
    last, begin, first = span.upper().mid(), arb(0), True
    if border.at_start == 0 and not border.curve(begin).g > 0:
        raise Undecided(f"{border.what} at its start")
    step = (last * FIRST_COURSE_STEP).mid()
    for _ in range(MOST_COURSE_STEPS):
        end = (begin + step).mid()
        final = bool(end >= last)
        if final:
            end = last
        if _step(border, begin, end, first, final):
            if final:
                return
            begin, first, step = end, False, (step * 1.5).mid()
        else:
            step = ((end - begin) / 2).mid()
            if step <= last * SHORTEST_COURSE_STEP:
                break
    raise Undecided(border.what, begin)


def _step(border: Margin, begin: Ball, end: Ball, first: bool, final: bool) -> bool:
    """Return whether the border is surely positive on a step, its end included unless the border is 0 there."""
    over = hull(begin, end)
    whole = border.curve(over)
    middle = over.mid()
    there, off = border.curve(middle), over - middle
    square = (off * off).nonnegative_part()
    ahead = not (final and border.at_end)
    if ahead and (there.g + there.dg * off + whole.ddg * square / 2 > 0 or whole.g > 0):
        return True
    slope = there.dg + whole.ddg * off
    if ahead and slope > 0:
        return True
    if ahead and first and border.at_start == 2 and whole.ddg > 0:
        return True
    return final and border.at_end and not (first and border.at_start) and bool(slope < 0)


def prove_course(closing: ClosingBalls, values: Values) -> None:
    """Prove that the root in `values` takes the course of its word.

    Raises
    ------
    Undecided
    """
    ends = closing.ends(values)
    for i, piece in enumerate(closing.pieces):
        span = ends[2 * i] - values[2 * i]
        if not span > 0:
            raise Undecided(f"the duration of {piece.label}", values[2 * i])
        prove_passage(closing, i, values)
        for border in borders(closing, i, values):
            prove_positive(border, span)


def forces_at(closing: ClosingBalls, i: int, values: Values) -> list[tuple[int, Ball, int]]:
    """Return domains, forces and the signs that they must have where piece i begins, by Theorems 4 and 5.

    None where a stick ends: one force is 0 there, and that the other one holds is part of the stick.
    """
    o, piece, before = closing.oscillator, closing.pieces[i], closing.pieces[i - 1]
    if before.sticks:
        return []
    boundary, (t, x) = piece.start, values[2 * i : 2 * i + 2]
    low, high = (o.force(domain, t, x, o.speed[boundary]) for domain in (boundary, boundary + 1))
    if o.jump[boundary].is_zero():
        high = low
    wanted = (1, -1) if piece.sticks else (1, 1) if before.mode == boundary else (-1, -1)
    return list(zip((boundary, boundary + 1), (low, high), wanted, strict=True))


def prove_passage(closing: ClosingBalls, i: int, values: Values) -> None:
    """Prove that piece i begins as Theorems 4 and 5 allow, coming from the piece before it."""
    for domain, force, sign in forces_at(closing, i, values):
        if sure_sign(force) != sign:
            label = closing.pieces[i - 1].label
            raise Undecided(f"F^({domain}) {'>' if sign > 0 else '<'} 0 where {label} ends", values[2 * i])


def starts_with(first: Jet, at_start: int) -> int:
    """Return the sign with which a border begins: of g, g' or g'', by how many are 0 at its start; 0 if open."""
    return sure_sign(first[at_start])
