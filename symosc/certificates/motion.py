"""Proven steps from event to event: the next belt, the time, and the continuation (Theorems 4 and 5).

Exact grazes. In a domain without damping and drive v'' = -w^2 v, w^2 = k/m, so v = v0 cos(w tau) + (a0/w) sin(w tau)
goes round a circle with R^2 = v0^2 + a0^2/w^2. If v0 and a0 are rational, so is R^2. The velocity grazes a belt if and
only if R^2 = v_belt^2, which is decided in rational numbers: then it turns there, F = 0 and x = A/k. Balls only say
when. Rational are v0 and a0 of an exact start, of the end of a stick (v0 = v_belt, a0 = F = 0) and of a graze (the
same).
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import arb

from symosc.certificates.balls import Ball, StateSet, Undecided, around, ball, decided_sign, sure_sign
from symosc.certificates.contact import Slip, end_of_stick, first_zero, sharper, zero_in
from symosc.certificates.flow import Flight, FlightPoint, Oscillator, holding_force
from symosc.model import MODE_NAMES, NEIGHBOURS, Parameters

ON_A_BELT = 3  # modes above it are sticks, on belt mode - ON_A_BELT


class Circle(NamedTuple):
    """The exact initial velocity and acceleration of a flight whose (v, a) move on a circle."""

    v: Fraction
    a: Fraction


class Moving(NamedTuple):
    """A set of states in one mode: (t, x), or (t, x, v) before the first event of a start off the belts.

    `mode` is a code of `symosc.model.MODE_NAMES`; `boundary` the belt that it is on or leaves just now (into its mode,
    which is proven), or 0; `circle` is known where velocities go round one from an exact state.
    """

    mode: int
    boundary: int
    states: StateSet
    circle: Circle | None = None

    def flight(self, o: Oscillator, values: list[Ball]) -> Flight:
        """Return the flight from these values of t, x and v; v is omitted on a belt."""
        return Flight(o, self.mode, values[0], values[1], values[2] if len(values) == 3 else o.speed[self.boundary])


class ProvenEvent(NamedTuple):
    """A proven event: its kind, and enclosures of its time and position."""

    kind: str
    boundary: int
    source: str
    target: str
    t: Ball
    x: Ball


def goes_round(p: Parameters) -> bool:
    """Return whether (v, a) move on circles (no damping, no drive)."""
    return p.c == 0 and p.B0 == 0 and p.k > 0


def belts_around(domain: int) -> list[int]:
    """Return the belts that border a domain."""
    return [boundary for boundary in (1, 2) if domain in NEIGHBOURS[boundary]]


def begin(o: Oscillator, start: tuple[Fraction, ...], errors: tuple[Fraction, ...]) -> Moving:
    """Return the mode and the states from t0, x0, v0 with given half-widths."""
    p, (t0, x0, v0) = o.p, start
    values = [around(ball(each), ball(error)) for each, error in zip(start, errors, strict=True)]
    if v0 not in (p.v1, p.v2):
        boundary, mode = 0, 1 + (v0 > p.v1) + (v0 > p.v2)
    else:
        if errors[2] > 0:
            raise Undecided("a start on a belt whose velocity is known to an error only", values[0])
        boundary = 1 if v0 == p.v1 else 2
        exact = not any(errors) and (t0 == 0 or p.B0 == 0)  # the forces are rational
        below, above = (_force_sign(o, domain, boundary, values, start, exact) for domain in NEIGHBOURS[boundary])
        mode = boundary + 1 if above > 0 else boundary if below < 0 else ON_A_BELT + boundary
        values.pop()
    circle = None
    if goes_round(p) and not any(errors) and mode <= ON_A_BELT:
        circle = Circle(v0, (p.A(mode) - p.k * x0) / p.m)
    return Moving(mode, boundary, StateSet.of(values), circle)


def _force_sign(
    o: Oscillator, domain: int, boundary: int, values: list[Ball], start: tuple[Fraction, ...], exact: bool
) -> int:
    """Return the sign of a force on a belt at the start, or of its derivative if the force is exactly 0."""
    p, (_, x0, v0) = o.p, start
    sign = sure_sign(o.force(domain, *values))
    if sign == 0 and not exact:
        raise Undecided("a force on the belt at the start", values[0])
    if sign == 0:
        force = p.A(domain) + (p.B0 if start[0] == 0 else 0) - p.k * x0 - p.c * v0
        sign = (force > 0) - (force < 0)
        if force == 0:
            _, sign = next(o.turns(boundary).after(values[0]))
        if sign == 0:
            raise Undecided("a force on the belt that is 0 for ever", values[0])
    return sign


def next_event(o: Oscillator, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    """Return the next event and the states after it, None if there is none until t_end, or raise Undecided."""
    return (_slip if state.mode > ON_A_BELT else _contact)(o, state, t_end)


def _first_contact(flight: Flight, belts: list[int], on: int, t_end: Ball) -> tuple[int, Ball] | None:
    """Return the belt that a flight from belt `on` meets first, and when; None if none until t_end."""
    best, stop = None, t_end - flight.t0
    for boundary in belts:
        found = first_zero(flight, boundary, stop, boundary == on)
        if found is not None:
            low, high = found
            tau = zero_in(flight.gap(boundary), low.tau, high.tau, "a contact", flight.t0)
            if best is not None and not tau < best[1]:
                if tau > best[1]:
                    continue
                raise Undecided("which belt comes first", flight.t0 + tau)
            best, stop = (boundary, tau), tau.upper()
    return best


def _contact(o: Oscillator, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    """Return the event at the first contact of a flight and the states after it."""
    flight, belts = state.flight(o, state.states.hull()), belts_around(state.mode)
    grazes = {} if state.circle is None else _exact_grazes(o.p, state.circle, belts)
    met = _first_contact(flight, [belt for belt in belts if belt not in grazes], state.boundary, t_end)
    if grazes:
        boundary = min(grazes, key=lambda belt: float(grazes[belt]))
        tau = grazes[boundary]
        if met is None or not met[1] < tau:
            until, t = t_end if met is None else flight.t0 + met[1], flight.t0 + tau
            if decided_sign(until - t, "whether a touch is the next event", t) < 0:
                return None
            x, name = ball(o.p.A(state.mode) / o.p.k), MODE_NAMES[state.mode]
            after = Moving(state.mode, boundary, StateSet.of([t, x]), Circle(o.p.belt(boundary), Fraction(0)))
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
        states = state.states.image(value, _contact_jacobian(flight, there, boundary, len(state.states.centre)))
    t, x = states.hull()
    target = _mode_after(o, state.mode, boundary, there.a, t)
    kind = "stick" if target > ON_A_BELT else "cross"
    event = ProvenEvent(kind, boundary, MODE_NAMES[state.mode], MODE_NAMES[target], t, x)
    return event, Moving(target, boundary, states)


def _exact_grazes(p: Parameters, circle: Circle, belts: list[int]) -> dict[int, Ball]:
    """Return the belts that a flight grazes, with the first times; it neither crosses nor sticks there."""
    square, found = circle.v**2 + circle.a**2 * p.m / p.k, {}
    for boundary in belts:
        speed = p.belt(boundary)
        if speed == 0 or speed**2 != square:
            continue
        w = (ball(p.k) / ball(p.m)).sqrt()
        if circle.a == 0:
            turn = 2 * arb.pi() if circle.v == speed else arb.pi()
        else:  # the angle from the start's direction (v0, a0/w) to that of the belt, the way the motion goes
            side = 1 if speed > 0 else -1
            turn = arb.atan2(side * ball(circle.a) / w, side * ball(circle.v))
            turn = turn if circle.a * side > 0 else turn + 2 * arb.pi()
        found[boundary] = turn / w
    return found


def _mode_after(o: Oscillator, mode: int, boundary: int, force: Ball, t: Ball) -> int:
    """Return the mode after a contact from a domain with an acceleration of the right sign."""
    upward = mode == boundary
    beyond = boundary + 1 if upward else boundary
    if o.jump[boundary].is_zero():
        return beyond
    other = force - o.jump[boundary] if upward else force + o.jump[boundary]
    passes = decided_sign(other, "a force at a contact", t) == (1 if upward else -1)
    return beyond if passes else ON_A_BELT + boundary


def _contact_jacobian(flight: Flight, there: FlightPoint, boundary: int, count: int) -> list[list[Ball]]:
    """Return the derivatives of (t, x) at a contact by the first `count` of (t, x, v) at the start."""
    columns = []
    for i in range(count):
        dx, dv = flight.moved(there, [arb(int(i == j)) for j in range(3)])
        dt = -dv / there.a
        columns.append((dt, dx + flight.oscillator.speed[boundary] * dt))
    return [list(row) for row in zip(*columns, strict=True)]


def _slip(o: Oscillator, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    """Return the event at the end of a stick and the states after it."""
    boundary, speed = state.boundary, o.speed[state.boundary]
    t, x = state.states.hull()
    slip = end_of_stick(o, boundary, t, x, t_end - t)
    if not isinstance(slip, Slip):
        return None
    if state.states.thin:
        states = StateSet.of([t + slip.tau, x + speed * slip.tau])
    else:
        t_c, x_c = state.states.centre
        then = sharper(holding_force(o, boundary, slip.domain, t_c, x_c), slip.tau, -abs(slip.slope))
        # The force depends on the line x - v t = u of the stick and on time: dt = (k/m) du / (dF/dt).
        by_x = o.km / slip.slope
        jacobian = [[-speed * by_x, by_x], [-speed * (1 + speed * by_x), 1 + speed * by_x]]
        states = state.states.image([t_c + then, x_c + speed * then], jacobian)
    t, x = states.hull()
    event = ProvenEvent("slip", boundary, MODE_NAMES[state.mode], MODE_NAMES[slip.domain], t, x)
    circle = Circle(o.p.belt(boundary), Fraction(0)) if goes_round(o.p) else None
    return event, Moving(slip.domain, boundary, states, circle)
