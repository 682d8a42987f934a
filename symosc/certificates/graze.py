"""A graze, proven as a statement of existence: some start within the start's error touches the belt.

A touch is a double zero of the gap, and no balls can tell it from a near miss. So one number of the start is left free,
s, and with it the zero is a simple one of the bordered system

    gap(t, s) = 0,    d gap/dt (t, s) = 0,

whose Jacobian [[gap_t, gap_s], [gap_tt, gap_ts]] is regular where gap_s and gap_tt are not 0. Krawczyk's operator
(`symosc.certificates.closing`) maps a box of times and of s between two fractions into its interior: for exactly one s
between them the flight touches. For all s between them the derivative of the acceleration has one sign around the
touch, so it is the only contact there. The checker proves the same by continuity and by the sign of gap_s.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from flint import arb, arb_mat, ctx

from symosc.certificates.balls import Ball, Undecided, around, ball, exact_ends
from symosc.certificates.contact import GapSample, Wall, fenced, first_zero, gap_of
from symosc.certificates.flow import Flight
from symosc.certificates.motion import Moving, Problem, ProvenEvent, launch, walls_of
from symosc.certificates.sets import StateSet
from symosc.model import MODE_NAMES

#: Numbers of the start that are left free, the first one that is known to an error.
FREE = (("x0", 1), ("v0", 2), ("t0", 0))
MOST_SECANTS = 12
MOST_NARROWINGS = 60
Arrive = Callable[[Ball], Moving]


class Touch(NamedTuple):
    """A proven touch: between which values of a number of the start, the event, and the states after it."""

    low: Fraction
    high: Fraction
    event: ProvenEvent
    after: Moving


def prove_touch(
    problem: Problem, arrive: Arrive, free: str, about: tuple[Fraction, Fraction], touch: tuple[int, Ball]
) -> Touch:
    """Prove that some start touches, and that it is the only one between two fractions.

    Parameters
    ----------
    problem : Problem
    arrive : callable
        Returns the states at the start of the flight that touches, from a ball of the free number.
    free : the name of that number.
    about : the given value of the free number, and how far it may be off.
    touch : the wall, and about when after the start of the flight.

    Raises
    ------
    Undecided
    """
    given, error = about
    boundary, near = touch
    unit = Fraction(1, 10 ** int(ctx.prec * 0.301 / 2.5 + 1))
    start, reach = ball(given), ball(error)
    share, near = _free_value(problem, arrive, boundary, start, reach, near)
    low, high = (Fraction(round(exact_ends(share)[0] / unit) + step) * unit for step in (-1, 1))
    if max(abs(low - given), abs(high - given)) > error:
        raise Undecided("a touch that is further off than the error of the start", near)
    state = arrive(ball(low).union(ball(high)))
    flight, there = _lowest(problem, state, boundary, near)
    _alone(problem, state, flight, there, boundary)
    place = next(place for name, place in FREE if name == free)
    _krawczyk(problem, arrive, (boundary, place), (flight, state, there.tau), (low, high))
    point = flight.at(there.tau)
    states = StateSet.of([flight.start.t + there.tau, flight.x(point)])
    t, x = states.hull()
    name = MODE_NAMES[state.mode]
    return Touch(low, high, ProvenEvent("graze", boundary, name, name, t, x), Moving(state.mode, boundary, states))


def _free_value(
    problem: Problem, arrive: Arrive, boundary: int, start: Ball, reach: Ball, near: Ball
) -> tuple[Ball, Ball]:
    """Return the value of the free number that touches, nearly, and when; secant steps, which prove nothing."""
    points = []
    for share in (arb(0), arb(0.25)):
        value = (start + share * reach).mid()
        _, there = _lowest(problem, arrive(value), boundary, near)
        near = there.tau
        points.append((value, there.g.mid()))
    for _ in range(MOST_SECANTS):
        (s, g), (s2, g2) = points[-2:]
        step = (g2 * (s2 - s) / (g2 - g)).mid()
        if not step.is_finite():
            break
        value = (s2 - step).mid()
        if not abs(value - start) <= reach:
            break
        _, there = _lowest(problem, arrive(value), boundary, near)
        near = there.tau
        points.append((value, there.g.mid()))
    return points[-1][0], near


def _wall(problem: Problem, state: Moving, boundary: int) -> Wall:
    return next(wall for wall in walls_of(problem, state.mode) if wall.boundary == boundary)


def _krawczyk(
    problem: Problem,
    arrive: Arrive,
    where: tuple[int, int],
    family: tuple[Flight, Moving, Ball],
    ends: tuple[Fraction, Fraction],
) -> None:
    """Prove that for exactly one free number between two fractions a flight touches in a box of times.

    Parameters
    ----------
    where : the belt, and the place of the free number in the start.
    family : the flight from all these starts, their states, and when the gap is lowest.
    ends : the two fractions.
    """
    (boundary, place), (flight, state, tau), (low, high) = where, family, (ball(each) for each in ends)
    wall = _wall(problem, state, boundary)
    lowest, free = flight.start.t + tau, low.union(high)
    times = around(lowest.mid(), 4 * lowest.rad())
    t, s = times.mid(), free.mid()

    thin = arrive(s)
    one = launch(problem, thin, thin.states.hull())
    there = one.at(t - one.start.t)
    left = arb_mat([[wall.side * (there.v - one.oscillator.speed[boundary])], [wall.side * there.a]])

    there = flight.at(times - flight.start.t)
    dx, dv = flight.moved(there, [row[place] for row in state.states.slopes])
    da = -flight.oscillator.cm * dv - flight.oscillator.km * dx
    J = wall.side * arb_mat([[there.a, dv], [flight.jerk(there), da]])
    try:
        Y = J.mid().inv().mid()
    except ZeroDivisionError:
        raise Undecided("a touch that does not depend on the free number of the start", lowest) from None
    off = (arb_mat([[1, 0], [0, 1]]) - Y * J) * arb_mat([[times - t], [free - s]]) - Y * left
    t, s = t + off[0, 0], s + off[1, 0]
    if not (times.contains_interior(t) and low < s < high):
        raise Undecided("whether a flight near this start touches", lowest)


def _lowest(problem: Problem, state: Moving, boundary: int, near: Ball) -> tuple[Flight, GapSample]:
    """Return the flight and its lowest gap near a time, proven to be the only zero of the derivative around there."""
    flight = launch(problem, state, state.states.hull())
    wall = _wall(problem, state, boundary)
    gap = gap_of(flight, wall)

    def falling(tau: Ball) -> GapSample:  # the derivative of the gap with the other sign
        return GapSample(tau, -gap(tau).dg, -wall.side * flight.jerk(flight.at(tau)))

    tau = near.mid()
    for _ in range(MOST_NARROWINGS):
        sample = falling(tau)
        following = (tau - sample.g / sample.dg).mid()
        if not following.is_finite():
            break
        done, tau = abs(following - tau) < arb(2) ** (10 - ctx.prec) * abs(tau), following
        if done:
            break
    sample = falling(tau)
    width = 2 * abs(sample.g).upper() / max(abs(sample.dg).lower(), arb(2) ** -10000) + arb(2) ** (8 - ctx.prec)
    tau = fenced(falling, tau, width, (arb(0), arb.pos_inf()), "the lowest point of a gap", flight.start.t)
    return flight, gap(tau)


def _alone(problem: Problem, state: Moving, flight: Flight, there: GapSample, boundary: int) -> None:
    """Prove that there is no other contact up to a touch, nor beside it; Undecided if that stays open."""
    width = there.tau.mid() / 4
    for _ in range(MOST_NARROWINGS):
        around_it = around(there.tau, width)
        bend = flight.jerk(flight.at(around_it))
        if bend > 0 or bend < 0:
            break
        width = width / 2
    else:
        raise Undecided("the bend of a gap at a touch", flight.start.t + there.tau)
    for wall in walls_of(problem, state.mode):
        before = (there.tau - width).lower() if wall.boundary == boundary else there.tau.upper()
        if first_zero(flight, wall, before, wall.boundary == state.boundary) is not None:
            raise Undecided("a contact before a touch", flight.start.t + there.tau)
