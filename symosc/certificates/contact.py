"""The first contact of a flight with a belt, and the end of a stick: proven to be the first, and enclosed.

Contacts. Let g = v - v_belt, taken positive where the flight is, and L g = drift/m (`symosc.certificates.flow`). On a
piece between two turns, shorter than pi/omega_d if the motion is underdamped, take phi > 0 with L phi = 0 from its left
end u = 0: phi = exp(-h u) C(u), C'' = kappa C, C(0) = 1, C'(0) = 0, and s = S/C with S'' = kappa S, S(0) = 0,
S'(0) = 1. Then H = g/phi has d2H/ds2 = C^3 exp(h u) L g: a convex function of s if the drift is >= 0, a concave one if
it is <= 0. So with signs at the ends only:

- g < 0 at the end: exactly one zero in the piece;
- concave, g > 0 at the end: none (H is above its chord);
- convex, g(0) = 0 with g > 0 afterwards: none;
- convex, g > 0 at both ends: none if H rises at the left or falls at the right end, or if its two tangents meet
  above 0. Else the piece is cut where g may be least: g < 0 there means one zero before it, g > 0 two smaller pieces.

Sticks. F^(below) and F^(above) change alike, and between two turns monotonically. A falling piece can only end the
stick downwards, where F^(below) reaches 0; a rising one only upwards, where F^(above) does. So the sign at the end of
each piece decides it. If the drift has no mean (v = 0 or k = 0), the forces repeat with the drive: a stick that lasts
for one period lasts for ever.

No sign is guessed: a ball that contains 0 raises `Undecided`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from flint import arb, ctx

from symosc.certificates.balls import Ball, Undecided, around
from symosc.certificates.flow import Curve, Flight, Jet, Oscillator, holding_force

#: Pieces are at most this long, in units of 1/omega_d: less than pi.
LONGEST_PIECE = 2.8
#: Tangents are used on pieces shorter than this, in units of 1/omega_d: less than pi/2.
LONGEST_DIP = 1.4
MOST_CUTS = 200
MOST_PIECES = 20_000
#: After each that many pieces: may the motion never come to a belt again?
PIECES_TO_REST = 8
MOST_ZERO_STEPS = 400
MOST_WIDENINGS = 40


def first_zero(flight: Flight, boundary: int, stop: Ball, on_it: bool) -> tuple[Jet, Jet] | None:
    """Return the ends of a piece with exactly one zero of the gap, the first one before the time `stop`.

    None if there is none. `on_it`: the flight starts on that belt, from where it is known to leave it.
    """
    gap = flight.gap(boundary)
    low = gap(arb(0))
    if on_it:
        low = low._replace(g=arb(0))
    elif not low.g > 0:
        raise Undecided("a start on a belt or beside it", flight.t0)
    count = 0
    for end, convex, concave in _ends_of_pieces(flight, boundary, stop):
        high = gap(end)
        if high.g < 0:
            return low, high
        if not high.g > 0:
            raise Undecided("a contact at the end of a piece", flight.t0 + end, (boundary, end))
        if convex and not concave and not on_it:
            found = _dip(flight, boundary, gap, low, high)
            if found is not None:
                return found
        low, on_it, count = high, False, count + 1
        if count % PIECES_TO_REST == 0 and never_meets(flight, boundary, end):
            return None
        if count > MOST_PIECES:
            raise Undecided(f"a flight of more than {MOST_PIECES} pieces", flight.t0 + end)
    return None


def _ends_of_pieces(flight: Flight, boundary: int, stop: Ball) -> Iterator[tuple[Ball, bool, bool]]:
    """Yield ends of pieces up to `stop`, whether H is convex there, and concave."""
    o, begin, at = flight.oscillator, flight.t0, arb(0)
    longest = (arb(LONGEST_PIECE) / o.omega_d).mid() if o.damping < 0 else None
    for turn, drift in o.turns(boundary).after(begin):
        end = None if turn is None else turn - begin
        if end is None or end >= stop:
            end = stop
        elif not end < stop:
            raise Undecided("a turn of the forces at the end of the search", begin + stop)
        curved = drift * flight.side(boundary)
        if longest is not None:
            while not end - at < longest:
                at = (at + longest).mid()
                yield at, curved >= 0, curved <= 0
        at = end
        yield end, curved >= 0, curved <= 0
        if end is stop:
            return


def never_meets(flight: Flight, boundary: int, tau: Ball) -> bool:
    """Return whether a flight certainly stays on its side of a belt from tau on."""
    bound = flight.stays_within(flight.at(tau))
    return bool(-flight.side(boundary) * flight.oscillator.speed[boundary] > bound)


def _dip(flight: Flight, boundary: int, gap: Curve, low: Jet, high: Jet) -> tuple[Jet, Jet] | None:
    """Search the first zero on a piece where H is convex and the gap positive at both ends."""
    o, pending = flight.oscillator, [high]
    for cut in range(MOST_CUTS):
        high = pending[-1]
        u = high.tau - low.tau
        if o.damping < 0 and not u * o.omega_d < LONGEST_DIP:
            middle = (low.tau + u / 2).mid()
        else:
            middle = _where_to_cut(o, low, high, u, cut)
        if middle is None:
            low = pending.pop()
            if not pending:
                return None
            continue
        there = gap(middle)
        if there.g < 0:
            return low, there
        if not there.g > 0:
            break
        pending.append(there)
    raise Undecided("a touch or a near miss", flight.t0 + high.tau, (boundary, high.tau))


def _where_to_cut(o: Oscillator, low: Jet, high: Jet, u: Ball, cut: int) -> Ball | None:
    """Return the point at which to divide a convex piece, or None if the gap is positive on all of it."""
    slope_low = low.dg + o.h * low.g
    if slope_low >= 0:
        return None
    if o.damping == 0:
        S, C = u, arb(1)
    else:
        S, C = (o.omega_d * u).sin_cos() if o.damping < 0 else (o.omega_d * u).sinh_cosh()
        S = S / o.omega_d
    s = S / C
    slope_high = high.dg + o.h * high.g - o.kappa * s * high.g
    if slope_high <= 0:
        return None
    grown = (o.h * u).exp()
    H_high, rise = grown * high.g / C, grown * C * slope_high
    meet = (low.g - H_high + rise * s) / (rise - slope_low)
    if low.g + slope_low * meet > 0:
        return None
    # Where the derivative of the gap may vanish, by the secant; every third time the middle.
    share = -low.dg / (high.dg - low.dg)
    if cut % 3 == 2 or not 0.02 < share < 0.98:  # nor may it be no number
        share = arb(0.5)
    return (low.tau + u * share).mid()


def zero_in(gap: Curve, low: Ball, high: Ball, what: str, t: Ball) -> Ball:
    """Return an enclosure of the only zero of the gap between low and high, where its sign falls.

    Newton's method finds it, kept between points where the sign is known; two signs prove the enclosure. The slope has
    one sign on it.
    """
    ends, here = (low, high), high.mid()
    low, high = low.mid(), high.mid()
    sample, step = gap(here), high
    for count in range(MOST_ZERO_STEPS):
        if sample.g > 0:
            low = here
        elif sample.g < 0:
            high = here
        else:
            break
        before, step = step, (-sample.g / sample.dg).mid()
        following = (here + step).mid()
        slow = count % 4 == 3 and abs(step) > abs(before) / 2
        if slow or not step.is_finite() or not low < following < high:
            following = ((low + high) / 2).mid()
        if following == here:
            break
        here, sample = following, gap(following)
    return fenced(gap, sample, arb(0), ends, what, t)


def fenced(gap: Curve, sample: Jet, spare: Ball, ends: tuple[Ball, Ball], what: str, t: Ball) -> Ball:
    """Return a ball around a sample with different signs of the gap at its ends and one sign of its slope."""
    (low, high), here = ends, sample.tau
    width = 2 * abs(sample.g).upper() / max(abs(sample.dg).lower(), arb(2) ** -10000) + spare
    for _ in range(MOST_WIDENINGS):
        width = width.mid()
        found = around(here, width)
        if gap((here - width).mid()).g > 0 and gap((here + width).mid()).g < 0:
            if not gap(found).dg < 0:
                raise Undecided(f"the slope at {what}", t + found)
            if not (low < found < high):
                raise Undecided(f"{what} at the end of a piece", t + found)
            return found
        width = 2 * width + abs(here) * arb(2) ** (4 - ctx.prec)
    raise Undecided(what, t + here)


def sharper(gap: Curve, found: Ball, slope: Ball) -> Ball:
    """Return a sharper enclosure of a gap's zero in `found` (interval Newton, twice).

    `slope` encloses the derivative of the gap over `found`, and may do so for other starts as well.
    """
    for _ in range(2):
        middle = found.mid()
        step = middle - gap(middle).g / slope
        if not step.overlaps(found):
            raise ArithmeticError("two enclosures of one zero have nothing in common")
        found = step.intersection(found)
        slope = gap(found).dg
    return found


class Slip(NamedTuple):
    """The end of a stick: the domain entered, the time since the stick's start, the force's derivative there."""

    domain: int
    tau: Ball
    slope: Ball


#: A stick that never ends.
FOR_EVER = "for ever"


def end_of_stick(o: Oscillator, boundary: int, t: Ball, x: Ball, stop: Ball) -> Slip | str | None:
    """Return the end of a stick from (t, x), FOR_EVER, or None if it lasts at least for a time `stop`.

    At its start F^(below) >= 0 >= F^(above) is known, and that it goes into the stick where one of them is 0.
    """
    begin, turns = stop * 0, o.turns(boundary)
    for lasted, (turn, drift) in enumerate(turns.after(t), 1):
        if drift == 0:
            return FOR_EVER
        end = stop if turn is None else turn - t
        last = turn is None or end >= stop
        if last:
            end = stop
        domain = boundary + (drift > 0)
        force = holding_force(o, boundary, domain, t, x)
        there = force(end)
        if there.g < 0:
            tau = zero_in(force, begin, end, "the end of a stick", t)
            return Slip(domain, tau, -drift * force(tau).dg)
        if not there.g > 0:
            raise Undecided("a stick that may end where a force turns", t + end)
        if last:
            return None
        if turns.repeats and lasted > 2:
            return FOR_EVER
        if lasted > MOST_PIECES:
            raise Undecided(f"a stick of more than {MOST_PIECES} pieces", t + end)
        begin = end
    return None
