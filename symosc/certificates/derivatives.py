"""Derivatives of the events of a proven motion, enclosed: power series of two terms in the change of one number.

From event to event the flow is that of `symosc.certificates.flow`, with series for t, x and v at its start and for the
parameter that changes. At the time of the next event, which is known, v (on a belt: the force that vanishes) has then
a derivative, and the implicit function theorem gives that of the event. It holds because each event is proven to be
transversal: the slope there is not 0, nor is the force after it. So nearby motions have the same events.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from fractions import Fraction
from typing import TypeAlias

from flint import arb, arb_series

from symosc.certificates.balls import Ball, Undecided, ball
from symosc.certificates.certificate import STARTS, provable
from symosc.certificates.flow import Flight, Oscillator, first_coefficient
from symosc.certificates.motion import ON_A_BELT, ProvenEvent
from symosc.model import MODE_NAMES, PARAMETER_NAMES, Parameters

#: dt and dx of an event.
Change: TypeAlias = tuple[Ball, Ball]
NUMBERS = {name: mode for mode, name in MODE_NAMES.items()}


def event_changes(
    p: Parameters, start: Sequence[Fraction], mode: int, events: Sequence[ProvenEvent], name: str
) -> list[Change]:
    """Enclose the derivatives of t and x at all events by one parameter or start value, or raise Undecided."""
    if name not in provable(p, start[2]):
        on_belt = start[2] in (p.v1, p.v2) and name[0] == "v"
        raise Undecided(
            f"a derivative by {name} {'of a start on a belt' if on_belt else 'at resonance or where it is 0'}"
        )
    found: list[Change] = []
    # Series cannot be divided by what may be 0.
    with suppress(ZeroDivisionError, ValueError):
        for event, change in zip(events, _changes(p, start, mode, events, name), strict=True):
            if not all(each.is_finite() for each in change):
                raise Undecided(f"a derivative by {name} of an event", event.t)
            found.append(change)
        return found
    raise Undecided(f"a derivative by {name} at critical damping")


def _changes(
    p: Parameters, start: Sequence[Fraction], mode: int, events: Sequence[ProvenEvent], name: str
) -> list[Change]:
    """Return the derivatives of t and x of all events by a number, as coefficients of power series in it."""
    o = Oscillator(p, {name: _series(ball(getattr(p, name)), arb(1))} if name in PARAMETER_NAMES else None)
    t, x, v = (_series(ball(value), arb(int(name == own))) for value, own in zip(start, STARTS, strict=True))
    found = []
    for event in events:
        if event.kind == "graze":
            raise Undecided("a derivative behind a graze", event.t)
        speed, then = o.speed[event.boundary], _series(event.t, arb(0))
        if mode > ON_A_BELT:
            at_end = x + speed * (then - t)
            force = o.force(NUMBERS[event.target], then, at_end, speed)
            dt = _slope(force) / first_coefficient(o.km * speed + o.drive * (o.Omega * then).sin())
        else:
            flight = Flight(o, mode, t, x, v)
            there = flight.at(then - t)
            at_end, dt = flight.x(there), (_slope(speed) - _slope(there.v)) / first_coefficient(there.a)
        dx = _slope(at_end) + first_coefficient(speed) * dt
        found.append((dt, dx))
        mode, t, x, v = NUMBERS[event.target], _series(event.t, dt), _series(event.x, dx), speed
    return found


def _series(value: Ball, slope: Ball) -> Ball:
    """Return a power series of two terms."""
    return arb_series([value, slope], prec=2)


def _slope(series: Ball) -> Ball:
    """Return the derivative of a series, 0 of a ball."""
    return series[1] if isinstance(series, arb_series) else arb(0)
