"""From one event to the next, with everything proven: which belt, when, and what happens there (Theorems 4 and 5)."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import arb

from symosc.certificates.balls import Ball, Undecided, ball, decided_sign, sure_sign
from symosc.certificates.circles import Circle, ExactTouch, circle_of_start, exact_touches, goes_round
from symosc.certificates.contact import Wall, first_zero, gap_of, sharper, zero_in
from symosc.certificates.flow import Flight, FlightPoint, FlightStart, Oscillator
from symosc.certificates.sets import StateSet
from symosc.certificates.stick import Slip, StickStart, end_of_stick, force_on_belt
from symosc.certificates.turns import Turns
from symosc.model import MODE_NAMES, NEIGHBOURS, Parameters

ON_A_BELT = 3  # modes above it are sticks, on belt mode - ON_A_BELT


class Problem:
    """The oscillator at the working precision, with the turns of both belts."""

    def __init__(self, p: Parameters) -> None:
        self.p, self.oscillator = p, Oscillator(p)
        self.turns = {boundary: Turns(p, boundary) for boundary in (1, 2)}


class Moving(NamedTuple):
    """A set of states in one mode: (t, x), or (t, x, v) before the first event of a motion from between the belts.

    Attributes
    ----------
    mode : int
        A code of `symosc.model.MODE_NAMES`.
    boundary : int
        The belt that it is on or leaves just now, or 0. That it leaves it into its mode is proven.
    circle : Circle or None
        The exact velocity and acceleration, where velocities go round circles and it is known (`circles`).
    """

    mode: int
    boundary: int
    states: StateSet
    circle: Circle | None = None


class ProvenEvent(NamedTuple):
    """A proven event: what, and enclosures of its time and position."""

    kind: str
    boundary: int
    source: str
    target: str
    t: Ball
    x: Ball


def begin(problem: Problem, start: tuple[Fraction, ...], errors: tuple[Fraction, ...]) -> Moving:
    """Return the mode and the states that a motion starts with.

    Parameters
    ----------
    problem : Problem
    start, errors : t0, x0, v0, and the half-widths to which they are known.
    """
    p, v0 = problem.p, start[2]
    values = [ball(each) + arb(0, ball(error).upper()) for each, error in zip(start, errors, strict=True)]
    if v0 not in (p.v1, p.v2):
        mode = 1 + (v0 > p.v1) + (v0 > p.v2)
        return Moving(mode, 0, StateSet.of(values), _circle(p, mode, start, errors))
    if errors[2] > 0:
        raise Undecided("a start on a belt whose velocity is known to an error only", values[0])
    boundary = 1 if v0 == p.v1 else 2
    signs = []
    for domain in NEIGHBOURS[boundary]:
        force = problem.oscillator.force(domain, *values)
        sign = sure_sign(force)
        if sign == 0 and not any(errors) and (start[0] == 0 or p.B0 == 0):  # the forces are rational
            exact = (
                p.A(domain) + p.B0 - p.k * start[1] - p.c * v0
                if start[0] == 0
                else p.A(domain) - p.k * start[1] - p.c * v0
            )
            sign = (exact > 0) - (exact < 0)
            if exact == 0:
                _, sign = next(problem.turns[boundary].pieces(values[0]))
            if sign == 0:
                raise Undecided("a force on the belt that is 0 for ever", values[0])
        elif sign == 0:
            raise Undecided("a force on the belt at the start", values[0])
        signs.append(sign)
    below, above = signs
    mode = boundary + 1 if above > 0 else boundary if below < 0 else ON_A_BELT + boundary
    return Moving(mode, boundary, StateSet.of(values[:2]), _circle(p, mode, start, errors))


def _circle(p: Parameters, mode: int, start: tuple[Fraction, ...], errors: tuple[Fraction, ...]) -> Circle | None:
    """Return the circle of an exact start in a domain, if there are circles."""
    if any(errors) or mode > ON_A_BELT or not goes_round(p):
        return None
    return circle_of_start(p, mode, start[1], start[2])


def next_event(problem: Problem, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    """Return the next event and the states after it, or None if there is surely none until t_end.

    Raises
    ------
    Undecided
    """
    if state.mode > ON_A_BELT:
        return _slip(problem, state, t_end)
    return _contact(problem, state, t_end)


def walls_of(problem: Problem, mode: int) -> list[Wall]:
    """Return the belts around a domain."""
    return [Wall(b, 1 if mode > b else -1, problem.turns[b]) for b in (1, 2) if mode in NEIGHBOURS[b]]


def launch(problem: Problem, state: Moving, values: list[Ball]) -> Flight:
    """Return the flight from these values of t, x and v, the last left out on a belt."""
    v = values[2] if len(values) == 3 else problem.oscillator.speed[state.boundary]
    return Flight(problem.oscillator, state.mode, FlightStart(values[0], values[1], v))


def first_wall(flight: Flight, walls: list[Wall], boundary: int, t_end: Ball) -> tuple[Wall, Ball] | None:
    """Return the wall that a flight meets first, and when; None if none until t_end."""
    best, stop = None, t_end - flight.start.t
    for wall in walls:
        found = first_zero(flight, wall, stop, wall.boundary == boundary)
        if found is not None:
            low, high = found
            tau = zero_in(gap_of(flight, wall), low.tau, high.tau, "a contact", flight.start.t)
            if best is not None and not tau < best[1]:
                if tau > best[1]:
                    continue
                raise Undecided("which belt comes first", flight.start.t + tau)
            best, stop = (wall, tau), tau.upper()
    return best


def _contact(problem: Problem, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    flight, walls = launch(problem, state, state.states.hull()), walls_of(problem, state.mode)
    touches = [] if state.circle is None else exact_touches(problem.p, state.circle, walls)
    crossed = [wall for wall in walls if wall.boundary not in {touch.wall.boundary for touch in touches}]
    met = first_wall(flight, crossed, state.boundary, t_end)
    touch = min(touches, key=lambda each: float(each.tau), default=None)
    if touch is not None and (met is None or not met[1] < touch.tau):
        return _touch(problem, state, flight, touch, t_end if met is None else flight.start.t + met[1])
    if met is None:
        return None
    wall, tau = met
    boundary = wall.boundary
    there = flight.at(tau)
    if state.states.thin:
        states = StateSet.of([flight.start.t + tau, flight.x(there)])
    else:
        thin = launch(problem, state, list(state.states.centre))
        then = sharper(gap_of(thin, wall), tau, wall.side * there.a)
        value = [thin.start.t + then, thin.x(thin.at(then))]
        states = state.states.mapped(value, contact_jacobian(flight, there, boundary, len(state.states.centre)))
    t, x = states.hull()
    target = _after(problem, state.mode, boundary, there.a, t)
    kind = "stick" if target > ON_A_BELT else "cross"
    event = ProvenEvent(kind, boundary, MODE_NAMES[state.mode], MODE_NAMES[target], t, x)
    return event, Moving(target, boundary, states)


def _touch(
    problem: Problem, state: Moving, flight: Flight, touch: ExactTouch, until: Ball
) -> tuple[ProvenEvent, Moving] | None:
    """Return a touch that is exact, if it surely comes before a time; None if it surely does not."""
    p, boundary, t = problem.p, touch.wall.boundary, flight.start.t + touch.tau
    if decided_sign(until - t, "whether a touch is the next event", t) < 0:
        return None
    x, name = ball(p.A(state.mode) / p.k), MODE_NAMES[state.mode]
    after = Moving(state.mode, boundary, StateSet.of([t, x]), Circle(p.belt(boundary), Fraction(0)))
    return ProvenEvent("graze", boundary, name, name, t, x), after


def _after(problem: Problem, mode: int, boundary: int, force: Ball, t: Ball) -> int:
    """Return the mode after a contact from a domain with that acceleration at it, which has the right sign."""
    o, upward = problem.oscillator, mode == boundary
    if o.jump[boundary].is_zero():
        return boundary + 1 if upward else boundary
    other = force - o.jump[boundary] if upward else force + o.jump[boundary]
    passes = decided_sign(other, "a force at a contact", t) == (1 if upward else -1)
    return (boundary + 1 if upward else boundary) if passes else ON_A_BELT + boundary


def contact_jacobian(flight: Flight, there: FlightPoint, boundary: int, count: int) -> list[list[Ball]]:
    """Return the derivatives of (t, x) at a contact by the first `count` of (t, x, v) at the start."""
    columns = []
    for i in range(count):
        dx, dv = flight.moved(there, [arb(int(i == j)) for j in range(3)])
        dt = -dv / there.a
        columns.append((dt, dx + flight.oscillator.speed[boundary] * dt))
    return [list(row) for row in zip(*columns, strict=True)]


def _slip(problem: Problem, state: Moving, t_end: Ball) -> tuple[ProvenEvent, Moving] | None:
    o, boundary = problem.oscillator, state.boundary
    t, x = state.states.hull()
    hold = StickStart(boundary, t, x)
    slip = end_of_stick(o, hold, problem.turns[boundary], t_end - t)
    if not isinstance(slip, Slip):
        return None
    speed = o.speed[boundary]
    if state.states.thin:
        states = StateSet.of([t + slip.tau, x + speed * slip.tau])
    else:
        t_c, x_c = state.states.centre
        side = 1 if slip.domain == boundary else -1
        force = force_on_belt(o, StickStart(boundary, t_c, x_c), slip.domain, side)
        then = sharper(force, slip.tau, -abs(slip.slope))
        # The force depends on the line x - v t = u of the stick and on time: dt = (k/m) du / (dF/dt).
        by_x = o.km / slip.slope
        jacobian = [[-speed * by_x, by_x], [-speed * (1 + speed * by_x), 1 + speed * by_x]]
        states = state.states.mapped([t_c + then, x_c + speed * then], jacobian)
    t, x = states.hull()
    event = ProvenEvent("slip", boundary, MODE_NAMES[state.mode], MODE_NAMES[slip.domain], t, x)
    circle = Circle(problem.p.belt(boundary), Fraction(0)) if goes_round(problem.p) else None
    return event, Moving(slip.domain, boundary, states, circle)
