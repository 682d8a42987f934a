"""Proven steps from event to event: the next belt, the time, and the continuation (Theorems 4 and
5).

No sign is guessed: a ball that contains 0 raises `Undecided`. The lemmas are proven in `symosc
derive certificates`.

Contacts. Let g = v - v_belt, taken positive where the flight is, and L g = drift/m
(`symosc.certificates.flow`). On a piece between two turns, shorter than pi/omega_d if the motion is
underdamped, let C'' = kappa C, C(0) = 1, C'(0) = 0 and S'' = kappa S, S(0) = 0, S'(0) = 1. As a
function of s = S/C, H = exp(h u) g/C is convex if the drift is >= 0, concave if it is <= 0. So with
signs at the ends only: g < 0 at the end: one zero in the piece. Concave, g > 0 at the end: none.
Convex: none after a start with g = 0, nor with g > 0 at both ends if H rises at the left or falls
at the right, or if its tangents meet above 0. Else the piece is cut where g may be least.

Sticks. F^(below) and F^(above) change alike, and between two turns monotonically. A falling piece
can only end the stick downwards, where F^(below) reaches 0; a rising one only upwards, where
F^(above) does. If the drift has no mean (v = 0 or k = 0), the forces repeat with the drive: a stick
that lasts for one period lasts for ever.

Exact grazes. In a domain without damping and drive (v, v'/w), w^2 = k/m, goes round a circle. The
velocity grazes a belt if and only if v^2 + v'^2 m/k = v_belt^2, which is decided in rational
numbers: v and v' are rational for an exact start, at the end of a stick (v = v_belt, v' = F = 0)
and at a graze (the same). Balls only say when.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx

from symosc.base.aliases import Record
from symosc.certificates.balls import (
    Ball,
    StateSet,
    Undecided,
    around,
    ball,
    decided_sign,
    sure_sign,
)
from symosc.certificates.flow import Curve, Flight, Jet, Oscillator, holding_force
from symosc.friction import MODE_NAMES, NEIGHBOURS
from symosc.model import Parameters

ON_A_BELT = 3  # modes above it are sticks, on belt mode - ON_A_BELT
#: Tangents are used on pieces shorter than this, in units of 1/omega_d: less than pi/2.
LONGEST_DIP = 1.4
MOST_PIECES = 20_000


# -- the next contact of a flight, and the end of a stick ------------------------------------------


def first_zero(flight: Flight, boundary: int, stop: Ball, on_it: bool) -> tuple[Jet, Jet] | None:
    """Return jets of a flight's gap to a belt before and after its first zero; None if it has none
    until `stop`.

    `on_it` says that the flight starts on that belt, from where it is known to leave it.
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
        low = high
        on_it = False
        count = count + 1
        if count % 8 == 0:
            wall = -flight.side(boundary) * flight.oscillator.speed[boundary]
            if wall > flight.speed_bound(flight.at(end)):  # for ever
                return None
        if count > MOST_PIECES:
            raise Undecided(f"a flight of more than {MOST_PIECES} pieces", flight.t0 + end)
    return None


def _ends_of_pieces(flight: Flight, boundary: int, stop: Ball) -> Iterator[tuple[Ball, bool, bool]]:
    """Yield each piece's end, and whether m g'' + c g' + k g (g: the gap to the belt) is >= 0, and
    is <= 0, on it.
    """
    o = flight.oscillator
    begin = flight.t0
    at = arb(0)
    # Pieces are at most this long, in units of 1/omega_d: less than pi.
    if o.damping < 0:
        longest = (arb(2.8) / o.omega_d).mid()
    else:
        longest = None
    for turn, drift in o.turns(boundary).after(begin):
        if turn is None:
            end = None
        else:
            end = turn - begin
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


def _dip(flight: Flight, boundary: int, gap: Curve, low: Jet, high: Jet) -> tuple[Jet, Jet] | None:
    """Search a flight from `low` to `high` for the first zero of its gap.

    Return jets before and after it, or None.

    The gap g is > 0 at both ends, and m g'' + c g' + k g is >= 0 between them.
    """
    o = flight.oscillator
    pending = [high]
    for cut in range(200):
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
    """Return when to cut a flight from its gap `low` to the gap `high`, `u` later; None if the gap
    stays > 0.

    `cut` is how many times the flight was cut before.
    """
    slope_low = low.dg + o.h * low.g
    if slope_low >= 0:
        return None
    if o.damping == 0:
        S = u
        C = arb(1)
    else:
        if o.damping < 0:
            S, C = (o.omega_d * u).sin_cos()
        else:
            S, C = (o.omega_d * u).sinh_cosh()
        S = S / o.omega_d
    s = S / C
    slope_high = high.dg + o.h * high.g - o.kappa * s * high.g
    if slope_high <= 0:
        return None
    grown = (o.h * u).exp()
    H_high = grown * high.g / C
    rise = grown * C * slope_high
    meet = (low.g - H_high + rise * s) / (rise - slope_low)
    if low.g + slope_low * meet > 0:
        return None
    # Where the derivative of the gap may vanish, by the secant; every third time the middle.
    share = -low.dg / (high.dg - low.dg)
    if cut % 3 == 2 or not 0.02 < share < 0.98:  # nor may it be no number
        share = arb(0.5)
    return (low.tau + u * share).mid()


def zero_in(gap: Curve, low: Ball, high: Ball, what: str, t: Ball) -> Ball:
    """Enclose the only zero of a gap that is > 0 at time `low`, < 0 at `high`.

    Errors name `what` and the start `t`.
    """
    # Newton's method finds it, kept between points where the sign is known; two signs prove the
    # enclosure. The slope has one sign on it.
    ends = (low, high)
    here = high.mid()
    low = low.mid()
    high = high.mid()
    sample = gap(here)
    step = high
    for count in range(400):
        if sample.g > 0:
            low = here
        elif sample.g < 0:
            high = here
        else:
            break
        before = step
        step = (-sample.g / sample.dg).mid()
        following = (here + step).mid()
        slow = count % 4 == 3 and abs(step) > abs(before) / 2
        if slow or not step.is_finite() or not low < following < high:
            following = ((low + high) / 2).mid()
        if following == here:
            break
        here = following
        sample = gap(following)
    return enclosed_zero(gap, sample, arb(0), ends, what, t)


def enclosed_zero(
    gap: Curve, sample: Jet, spare: Ball, ends: tuple[Ball, Ball], what: str, t: Ball
) -> Ball:
    """Enclose the zero of a falling gap near its jet `sample` by two signs.

    Errors name `what` and the start `t`.
    """
    # It lies between the two `ends`; its radius is twice the step of Newton's method, plus `spare`,
    # or a little more.
    (low, high) = ends
    here = sample.tau
    width = 2 * abs(sample.g).upper() / max(abs(sample.dg).lower(), arb(2) ** -10000) + spare
    for _ in range(40):
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
    """Narrow the enclosure `found` of a gap's zero by two interval Newton steps.

    `slope` encloses the derivative.
    """
    # `slope` encloses the derivative of the gap over `found`, and may do so for other starts as
    # well.
    for _ in range(2):
        middle = found.mid()
        step = middle - gap(middle).g / slope
        if not step.overlaps(found):
            raise ArithmeticError("two enclosures of one zero have nothing in common")
        found = step.intersection(found)
        slope = gap(found).dg
    return found


def end_of_stick(
    o: Oscillator, boundary: int, t: Ball, x: Ball, stop: Ball
) -> tuple[int, Ball, Ball] | None:
    """Return the domain into which a stick from (t, x) slips, its duration, and the derivative of
    the force at its end.

    Return None if it lasts at least for a time `stop`. The caller has proven that the forces hold
    the mass at the start of the stick, or right after it.
    """
    begin = stop * 0
    turns = o.turns(boundary)
    for lasted, (turn, drift) in enumerate(turns.after(t), 1):
        if drift == 0:
            return None
        last = turn is None or turn - t >= stop
        if last:
            end = stop
        else:
            end = turn - t
        domain = boundary + (drift > 0)
        force = holding_force(o, boundary, domain, t, x)
        g = force(end).g
        if g < 0:
            tau = zero_in(force, begin, end, "the end of a stick", t)
            return domain, tau, -drift * force(tau).dg
        if not g > 0:
            raise Undecided("a stick that may end where a force turns", t + end)
        if last or (turns.repeats and lasted > 2):
            return None
        if lasted > MOST_PIECES:
            raise Undecided(f"a stick of more than {MOST_PIECES} pieces", t + end)
        begin = end
    return None


# -- from event to event ---------------------------------------------------------------------------


class Moving(NamedTuple):
    """A set of states in one mode: of (t, x, v), or only of (t, x) where v is the speed of a belt."""

    mode: int  # a code of `symosc.friction.MODE_NAMES`
    boundary: (
        int  # the belt that it is on or leaves just now (into its mode, which is proven), or 0
    )
    states: StateSet
    #: Exact initial v and a of a flight without damping and drive: the point (v, a/omega_0) moves
    #: on a circle.
    circle: tuple[Fraction, Fraction] | None = None

    def flight(self, o: Oscillator, values: list[Ball]) -> Flight:
        """Return the flight that starts with `values`: t, x and v, or only t and x, if v is the
        speed of a belt.
        """
        return Flight(
            o,
            self.mode,
            values[0],
            values[1],
            values[2] if len(values) == 3 else o.speed[self.boundary],
        )


class ProvenEvent(NamedTuple):
    """A proven event: its kind, and enclosures of its time and position."""

    kind: str
    boundary: int
    source: str
    target: str
    t: Ball
    x: Ball

    def named(self) -> Record:
        """Return a dict with the kind, the belt (`boundary`), and the modes before (`source`) and
        after (`target`).
        """
        return dict(zip(self._fields[:4], self[:4], strict=True))


def goes_round(p: Parameters) -> bool:
    """Return whether flights have a spring, no damping and no drive: then (v, a/omega_0) moves on a
    circle.
    """
    return p.c == 0 and p.B0 == 0 and p.k > 0


def belts_around(domain: int) -> list[int]:
    """Return the belts that border a domain."""
    return [boundary for boundary in (1, 2) if domain in NEIGHBOURS[boundary]]


def begin(o: Oscillator, start: tuple[Fraction, ...], errors: tuple[Fraction, ...]) -> Moving:
    """Return the initial mode and the set of initial states, given t0, x0, v0 and their
    half-widths.
    """
    p = o.p
    (t0, x0, v0) = start
    values = [around(ball(each), ball(error)) for each, error in zip(start, errors, strict=True)]
    if v0 not in (p.v1, p.v2):
        boundary = 0
        mode = 1 + (v0 > p.v1) + (v0 > p.v2)
    else:
        if errors[2] > 0:
            raise Undecided("a start on a belt whose velocity is known to an error only", values[0])
        if v0 == p.v1:
            boundary = 1
        else:
            boundary = 2
        exact = not any(errors) and (t0 == 0 or p.B0 == 0)  # the forces are rational
        signs = []  # of the forces, or of the derivative of one that is exactly 0
        for domain in NEIGHBOURS[boundary]:
            sign = sure_sign(o.force(domain, *values))
            if sign == 0 and not exact:
                raise Undecided("a force on the belt at the start", values[0])
            if sign == 0:
                force = p.A(domain) + (p.B0 if t0 == 0 else 0) - p.k * x0 - p.c * v0
                sign = (force > 0) - (force < 0) or next(o.turns(boundary).after(values[0]))[1]
            if sign == 0:
                raise Undecided("a force on the belt that is 0 for ever", values[0])
            signs.append(sign)
        below, above = signs
        if above > 0:
            mode = boundary + 1
        elif below < 0:
            mode = boundary
        else:
            mode = ON_A_BELT + boundary
        values.pop()
    circle = None
    if goes_round(p) and not any(errors) and mode <= ON_A_BELT:
        circle = v0, (p.A(mode) - p.k * x0) / p.m
    return Moving(mode, boundary, StateSet.of(values), circle)


def next_event(o: Oscillator, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    """Return the next event and the states after it, None if there is none until t_end, or raise
    Undecided.
    """
    return (_slip if state.mode > ON_A_BELT else _contact)(o, state, t_end)


def _first_contact(
    flight: Flight, belts: list[int], on: int, t_end: Ball
) -> tuple[int, Ball] | None:
    """Return the belt that a flight from belt `on` (0: from none) meets first, and when; None if
    none until t_end.
    """
    best = None
    stop = t_end - flight.t0
    for boundary in belts:
        found = first_zero(flight, boundary, stop, boundary == on)
        if found is not None:
            low, high = found
            tau = zero_in(flight.gap(boundary), low.tau, high.tau, "a contact", flight.t0)
            if best is not None and not tau < best[1]:
                if tau > best[1]:
                    continue
                raise Undecided("which belt comes first", flight.t0 + tau)
            best = (boundary, tau)
            stop = tau.upper()
    return best


def _contact(o: Oscillator, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    """Return the event at the first contact of a flight and the states after it; None if none until
    t_end.
    """
    flight = state.flight(o, state.states.hull())
    belts = belts_around(state.mode)
    if state.circle is None:
        grazes = {}
    else:
        grazes = _exact_grazes(o.p, *state.circle, belts)
    met = _first_contact(
        flight, [belt for belt in belts if belt not in grazes], state.boundary, t_end
    )
    if grazes:
        boundary = min(grazes, key=lambda belt: float(grazes[belt]))
        tau = grazes[boundary]
        if met is None or not met[1] < tau:
            if met is None:
                until = t_end
            else:
                until = flight.t0 + met[1]
            t = flight.t0 + tau
            if decided_sign(until - t, "whether a touch is the next event", t) < 0:
                return None
            x = ball(o.p.A(state.mode) / o.p.k)
            name = MODE_NAMES[state.mode]
            after = Moving(
                state.mode, boundary, StateSet.of([t, x]), (o.p.belt(boundary), Fraction(0))
            )
            return ProvenEvent("graze", boundary, name, name, t, x), after
    if met is None:
        return None
    boundary, tau = met
    there = flight.at(tau)
    if state.states.thin:
        states = StateSet.of([flight.t0 + tau, flight.x(there)])
    else:
        thin = state.flight(o, list(state.states.centre))
        then = sharper(thin.gap(boundary), tau, flight.side(boundary) * there.a)
        value = [thin.t0 + then, thin.x(thin.at(then))]
        # the derivatives of (t, x) by those of (t, x, v) at the start
        columns = []
        count = len(state.states.centre)
        for i in range(count):
            dx, dv = flight.moved(there, [arb(int(i == j)) for j in range(3)])
            dt = -dv / there.a
            columns.append((dt, dx + o.speed[boundary] * dt))
        states = state.states.image(value, [list(row) for row in zip(*columns, strict=True)])
    t, x = states.hull()
    # What follows (Theorems 4 and 5): it crosses if both forces have the sign of the passage, else
    # it sticks.
    upward = state.mode == boundary
    jump = o.jump[boundary]
    kind = "cross"
    target = 2 * boundary + 1 - state.mode
    if not jump.is_zero():
        if upward:
            other = there.a - jump
        else:
            other = there.a + jump
        if decided_sign(other, "a force at a contact", t) != (1 if upward else -1):
            kind = "stick"
            target = ON_A_BELT + boundary
    event = ProvenEvent(kind, boundary, MODE_NAMES[state.mode], MODE_NAMES[target], t, x)
    return event, Moving(target, boundary, states)


def _exact_grazes(p: Parameters, v0: Fraction, a0: Fraction, belts: list[int]) -> dict[int, Ball]:
    """Return the belts that a flight from v0, a0 without damping and drive just touches, and after
    how much time.
    """
    square = v0**2 + a0**2 * p.m / p.k
    found = {}
    for boundary in belts:
        speed = p.belt(boundary)
        if speed == 0 or speed**2 != square:
            continue
        w = (ball(p.k) / ball(p.m)).sqrt()
        if a0 == 0:
            if v0 == speed:
                turn = 2 * arb.pi()
            else:
                turn = arb.pi()
        # the angle from the start's direction (v0, a0/w) to that of the belt, the way the motion
        # goes
        else:
            if speed > 0:
                side = 1
            else:
                side = -1
            turn = arb.atan2(side * ball(a0) / w, side * ball(v0))
            if not (a0 * side > 0):
                turn = turn + 2 * arb.pi()
        found[boundary] = turn / w
    return found


def _slip(o: Oscillator, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    """Return the event at the end of a stick and the states after it; None if it lasts until t_end."""
    (t, x) = state.states.hull()
    speed = o.speed[state.boundary]
    boundary = state.boundary
    slip = end_of_stick(o, boundary, t, x, t_end - t)
    if slip is None:
        return None
    domain, tau, slope = slip
    if state.states.thin:
        states = StateSet.of([t + tau, x + speed * tau])
    else:
        t_c, x_c = state.states.centre
        then = sharper(holding_force(o, boundary, domain, t_c, x_c), tau, -abs(slope))
        # The force depends on the line x - v t = u of the stick and on time: dt = (k/m) du /
        # (dF/dt).
        by_x = o.km / slope
        jacobian = [[-speed * by_x, by_x], [-speed * (1 + speed * by_x), 1 + speed * by_x]]
        states = state.states.image([t_c + then, x_c + speed * then], jacobian)
    t, x = states.hull()
    event = ProvenEvent("slip", boundary, MODE_NAMES[state.mode], MODE_NAMES[domain], t, x)
    if goes_round(o.p):
        circle = (o.p.belt(boundary), Fraction(0))
    else:
        circle = None
    return event, Moving(domain, boundary, states, circle)
