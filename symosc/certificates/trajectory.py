"""Proof of a motion up to its end, event by event, with as many bits as needed; a graze of one start in its error.

A graze is a double zero of the gap, and no balls can tell it from a near miss. So one number s of the start is left
free: (t, s) is a simple zero of gap = d gap/dt = 0, and Krawczyk's operator proves that exactly one s between two
fractions grazes. The checker proves the same by continuity and by the sign of d gap/ds (`symosc derive certificates`).

Derivatives of the events by a number are coefficients of power series of two terms in its change: at the time of the
next event, which is known, v (on a belt: the force that vanishes) has a derivative, and the implicit function theorem
gives that of the event. It holds because each event is proven to be transversal: the slope there is not 0, nor is the
force after it. So nearby motions have the same events.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import islice
from math import ceil, log2, log10
from typing import NamedTuple, TypeAlias

from flint import arb, arb_mat, arb_series, ctx

from symosc.aliases import Record
from symosc.certificates.balls import Ball, StateSet, Undecided, around, ball, exact_ends, made_by, outward, size
from symosc.certificates.certificate import STARTS, Certificate, confirmed, provable, stated
from symosc.certificates.flow import Flight, Jet, Oscillator, first_coefficient
from symosc.certificates.motion import (
    ON_A_BELT,
    Moving,
    ProvenEvent,
    begin,
    belts_around,
    fenced,
    first_zero,
    next_event,
)
from symosc.certificates.orbit import krawczyk
from symosc.exact import show
from symosc.model import MODE_NAMES, PARAMETER_NAMES, Parameters

FIRST_BITS, MOST_BITS = 128, 8192
#: More bits do not help a start that is known to an error; they are raised this often only.
RAISES_WITH_ERROR = 1
MOST_PROVEN_EVENTS = 20_000
#: Enclosures of events have this many digits, and more where events are closer to each other.
DIGITS, DIGITS_BEYOND = 25, 8
EXACT = (Fraction(0),) * 3
WIDE = "the digits of a derivative"
#: Numbers of the start that may be left free, in this order: the first one that is known to an error.
FREE = (("x0", 1), ("v0", 2), ("t0", 0))
MOST_SECANTS, MOST_NARROWINGS = 12, 60
MODE_NUMBERS = {name: mode for mode, name in MODE_NAMES.items()}
#: dt and dx of an event.
Change: TypeAlias = tuple[Ball, Ball]


class ToProve(NamedTuple):
    """The motion to prove: parameters, t0, x0, v0, their errors, t_end, the digits of the enclosures, and `wrt`."""

    p: Parameters
    start: tuple[Fraction, Fraction, Fraction]
    errors: tuple[Fraction, Fraction, Fraction]
    t_end: Fraction
    digits: int = DIGITS
    wrt: tuple[str, ...] = ()

    @property
    def exact(self) -> bool:
        """Whether the start is known exactly."""
        return not any(self.errors)

    def precise(self, *values: Ball) -> bool:
        """Return whether balls are known to the digits asked for."""
        return all(size(each.rad()) < 10.0 ** (-self.digits - 1) * max(1.0, size(each)) for each in values)


class Proof(NamedTuple):
    """The initial mode, proven events, the undecided question, and the free number of a start that grazes."""

    mode: str
    events: list[ProvenEvent]
    undecided: Undecided | None = None
    free: tuple[str, Fraction, Fraction] | None = None  # its name and the two fractions between which it is
    changes: list[list[Change]] | None = None  # dt and dx of all events by each name


def prove_trajectory(task: ToProve) -> Certificate:
    """Prove all events of a motion until t_end, with more bits where these do not decide; return the certificate."""
    bits, raises = _first_bits(task), 0
    while True:
        with ctx.workprec(bits):
            proof = _follow(task)
            if proof.undecided is None:
                proof = _differentiated(task, proof)
                if proof.undecided is None or proof.undecided.what != WIDE or bits >= MOST_BITS:
                    return _certificate(task, proof, bits)
            elif proof.undecided.graze is not None and not task.exact:
                with ctx.workprec(2 * bits):
                    grazing = _with_a_graze(task, proof, proof.undecided.graze)
                if grazing.undecided is None:
                    return _certificate(task, grazing, bits)
            raises += 1
            if bits >= MOST_BITS or (not task.exact and raises > RAISES_WITH_ERROR):
                return _certificate(task, proof, bits)
        bits = min(2 * bits, MOST_BITS)


def _first_bits(task: ToProve) -> int:
    """Return the bits to begin with: more for an accurate start and for late times."""
    p, (t0, _, v0) = task.p, task.start
    small = [each for each in (*task.errors, abs(v0 - p.v1), abs(v0 - p.v2)) if each]
    turns = abs(p.Omega * t0) + p.Omega * (task.t_end - t0)
    spare = max(0, *(-_log2(each) for each in small)) + max(0, _log2(turns))
    return FIRST_BITS + 32 * ceil((spare + ceil((task.digits - DIGITS) / log10(2))) / 32)


def _log2(number: Fraction) -> int:
    """Return the binary logarithm of a number, approximately."""
    return number.numerator.bit_length() - number.denominator.bit_length() if number else 0


def _follow(task: ToProve) -> Proof:
    """Prove events with the working precision until t_end, or up to the first undecided question."""
    mode, events, o = "", [], Oscillator(task.p)
    try:
        state = begin(o, task.start, task.errors)
        mode = MODE_NAMES[state.mode]
        for event, _ in _events(o, state, task):
            events.append(event)
    except Undecided as undecided:
        return Proof(mode, events, undecided)
    return Proof(mode, events)


def _events(o: Oscillator, state: Moving, task: ToProve) -> Iterator[tuple[ProvenEvent, Moving]]:
    """Yield the proven events until t_end, and the states after each."""
    t_end = ball(task.t_end)
    for _ in range(MOST_PROVEN_EVENTS):
        following = next_event(o, state, t_end)
        if following is None:
            return
        event, state = following
        if not event.t < t_end:
            raise Undecided("an event at the end", event.t)
        if task.exact and not task.precise(event.t, event.x):
            raise Undecided("the digits of an event", event.t)
        yield following
    raise Undecided(f"what comes after {MOST_PROVEN_EVENTS} events", event.t)


# -- derivatives -------------------------------------------------------------------------------------------------------


def _differentiated(task: ToProve, proof: Proof) -> Proof:
    """Return a proof with the derivatives asked for, or with the reason why one of them is undecided."""
    changes = []
    try:
        for name in task.wrt:
            changes.append(event_changes(task.p, task.start, MODE_NUMBERS[proof.mode], proof.events, name))
        if not task.precise(*(value for column in changes for change in column for value in change)):
            raise Undecided(WIDE)
    except Undecided as undecided:
        return proof._replace(undecided=undecided)
    return proof._replace(changes=changes)


def event_changes(
    p: Parameters, start: Sequence[Fraction], mode: int, events: Sequence[ProvenEvent], name: str
) -> list[Change]:
    """Enclose the derivatives of t and x at all events by one parameter or start value, or raise Undecided."""
    if name not in provable(p, start[2]):
        on_belt = start[2] in (p.v1, p.v2) and name[0] == "v"
        where = "of a start on a belt" if on_belt else "at resonance or where it is 0"
        raise Undecided(f"a derivative by {name} {where}")
    found: list[Change] = []
    with suppress(ZeroDivisionError, ValueError):  # series cannot be divided by what may be 0
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

    def series(value: Ball, slope: Ball) -> Ball:
        return arb_series([value, slope], prec=2)

    def slope(value: Ball) -> Ball:
        return value[1] if isinstance(value, arb_series) else arb(0)

    o = Oscillator(p, {name: series(ball(getattr(p, name)), arb(1))} if name in PARAMETER_NAMES else None)
    t, x, v = (series(ball(value), arb(int(name == own))) for value, own in zip(start, STARTS, strict=True))
    found = []
    for event in events:
        if event.kind == "graze":
            raise Undecided("a derivative behind a graze", event.t)
        speed, then, target = o.speed[event.boundary], series(event.t, arb(0)), MODE_NUMBERS[event.target]
        if mode > ON_A_BELT:
            at_end = x + speed * (then - t)
            force = o.force(target, then, at_end, speed)
            dt = slope(force) / first_coefficient(o.km * speed + o.drive * (o.Omega * then).sin())
        else:
            flight = Flight(o, mode, t, x, v)
            there = flight.at(then - t)
            at_end, dt = flight.x(there), (slope(speed) - slope(there.v)) / first_coefficient(there.a)
        dx = slope(at_end) + first_coefficient(speed) * dt
        found.append((dt, dx))
        mode, t, x, v = target, series(event.t, dt), series(event.x, dx), speed
    return found


# -- a graze of some start ---------------------------------------------------------------------------------------------


def _with_a_graze(task: ToProve, proof: Proof, graze: tuple[int, Ball]) -> Proof:
    """Prove that some start within the error grazes, where a graze of all starts is undecided; return the new proof."""
    o, before, (boundary, near) = Oscillator(task.p), len(proof.events), graze
    name, place = next((name, place) for name, place in FREE if task.errors[place])
    events: list[ProvenEvent] = []

    def arrive(value: Ball) -> Moving:
        """Return the states after the last event before the graze, if the free number of the start lies in a ball."""
        events.clear()
        low, high = exact_ends(value)
        start, errors = list(task.start), list(EXACT)
        start[place], errors[place] = (low + high) / 2, (high - low) / 2
        state = begin(o, tuple(start), tuple(errors))
        for event, after in islice(_events(o, state, task), before):
            events.append(event)
            state = after
        return state

    try:
        low, high = _grazing_interval(o, arrive, boundary, task.start[place], task.errors[place], near)
        free = ball(low).union(ball(high))
        thin, state = arrive(free.mid()), arrive(free)
        flight, there = _lowest(o, state, boundary, near)
        _only_contact(o, state, flight, there, boundary)
        if not _one_touches(o, thin, state, flight, there.tau, boundary, place, ball(low), ball(high)):
            raise Undecided("whether a flight near this start touches", flight.t0 + there.tau)
        states = StateSet.of([flight.t0 + there.tau, flight.x(flight.at(there.tau))])
        t, x = states.hull()
        mode = MODE_NAMES[state.mode]
        events.append(ProvenEvent("graze", boundary, mode, mode, t, x))
        events.extend(event for event, _ in _events(o, Moving(state.mode, boundary, states), task))
    except Undecided as undecided:
        return Proof(proof.mode, events, undecided)
    return Proof(proof.mode, events, None, (name, low, high))


def _grazing_interval(
    o: Oscillator, arrive: Callable[[Ball], Moving], boundary: int, given: Fraction, error: Fraction, near: Ball
) -> tuple[Fraction, Fraction]:
    """Estimate, by secants, two fractions with the free number's value for a graze between them; proves nothing."""
    start, reach, points = ball(given), ball(error), list[tuple[Ball, Ball]]()
    for count in range(2 + MOST_SECANTS):
        if count < 2:
            value = (start + arb(0.25 * count) * reach).mid()
        else:
            (s, g), (s2, g2) = points[-2:]
            step = (g2 * (s2 - s) / (g2 - g)).mid()
            value = (s2 - step).mid()
            if not (step.is_finite() and abs(value - start) <= reach):
                break
        _, there = _lowest(o, arrive(value), boundary, near)
        points.append((value, there.g.mid()))
        near = there.tau
    unit = Fraction(1, 10 ** int(ctx.prec * 0.301 / 2.5 + 1))
    low, high = (Fraction(round(exact_ends(points[-1][0])[0] / unit) + step) * unit for step in (-1, 1))
    if max(abs(low - given), abs(high - given)) > error:
        raise Undecided("a touch that is further off than the error of the start", near)
    return low, high


def _one_touches(
    o: Oscillator,
    thin: Moving,
    state: Moving,
    flight: Flight,
    tau: Ball,
    boundary: int,
    place: int,
    low: Ball,
    high: Ball,
) -> bool:
    """Return whether for exactly one free number between low and high a flight grazes in a box of times (Krawczyk)."""
    # `flight` and `state` are of all these starts, `thin` of the middle one, `tau` is when their gap is lowest, `place`
    # that of the free number.
    side, lowest, free = flight.side(boundary), flight.t0 + tau, low.union(high)
    times, one = around(lowest.mid(), 4 * lowest.rad()), thin.flight(o, thin.states.hull())
    there = one.at(times.mid() - one.t0)
    residual = [side * (there.v - o.speed[boundary]), side * there.a]
    there = flight.at(times - flight.t0)
    dx, dv = flight.moved(there, [row[place] for row in state.states.slopes])
    J = side * arb_mat([[there.a, dv], [flight.jerk(there), -o.cm * dv - o.km * dx]])
    image = krawczyk([times, free], [times.mid(), free.mid()], residual, J)
    return image is not None and bool(low < image[1] < high)


def _lowest(o: Oscillator, state: Moving, boundary: int, near: Ball) -> tuple[Flight, Jet]:
    """Return the flight and its smallest gap near a time, proven to be the only zero of the derivative there."""
    flight = state.flight(o, state.states.hull())
    gap = flight.gap(boundary)

    def falling(tau: Ball) -> Jet:  # the derivative of the gap with the other sign
        there = gap(tau)
        return Jet(tau, -there.dg, -there.ddg, arb.nan())

    tau = near.mid()
    for _ in range(MOST_NARROWINGS):
        sample = falling(tau)
        following = (tau - sample.g / sample.dg).mid()
        if not following.is_finite():
            break
        done, tau = abs(following - tau) < arb(2) ** (10 - ctx.prec) * abs(tau), following
        if done:
            break
    ends, spare = (arb(0), arb.pos_inf()), arb(2) ** (8 - ctx.prec)
    return flight, gap(fenced(falling, falling(tau), spare, ends, "the lowest point of a gap", flight.t0))


def _only_contact(o: Oscillator, state: Moving, flight: Flight, there: Jet, boundary: int) -> None:
    """Prove that there is no other contact up to and near a graze, or raise Undecided."""
    width = there.tau.mid() / 4
    for _ in range(MOST_NARROWINGS):
        if abs(flight.jerk(flight.at(around(there.tau, width)))) > 0:
            break
        width = width / 2
    else:
        raise Undecided("the bend of a gap at a touch", flight.t0 + there.tau)
    for belt in belts_around(state.mode):
        before = (there.tau - width).lower() if belt == boundary else there.tau.upper()
        if first_zero(flight, belt, before, belt == state.boundary) is not None:
            raise Undecided("a contact before a touch", flight.t0 + there.tau)


# -- the certificate ---------------------------------------------------------------------------------------------------


def _certificate(task: ToProve, proof: Proof, bits: int) -> Certificate:
    """Return the certificate of the motion."""
    rows, before, undecided = [], ball(task.start[0]), proof.undecided
    for event in proof.events:
        digits, since = task.digits, event.t - before
        if since > 0:
            scale = max(1.0, size(event.t))
            digits = max(digits, DIGITS_BEYOND + ceil(log2(scale / size(since)) * log10(2)))
        rows.append(event_row(event, digits))
        before = event.t
    starts = "all" if proof.free is None else "some"
    statement = question(task, bits) | {"starts": starts, "mode": proof.mode, "events": rows}
    if proof.changes:

        def decimals(value: Ball) -> list[str]:
            return list(outward(value, _known(value, task.digits)))

        statement |= {"wrt": list(task.wrt), "derivatives": []}
        for of_event in zip(*proof.changes, strict=True):
            dt, dx = ([decimals(change[i]) for change in of_event] for i in (0, 1))
            statement["derivatives"].append({"dt": dt, "dx": dx})
    if proof.free is not None:
        name, low, high = proof.free
        statement["free"] = {"name": name, "low": show(low), "high": show(high)}
    if undecided is None:
        return confirmed("trajectory", statement)
    count = f"{len(rows)} event{'' if len(rows) == 1 else 's'}"
    message = f"{undecided.what}{undecided.place()} is not decided with {bits} bits, after {count}"
    if undecided.graze is not None and task.exact:
        message += "; with start_error the statement that a start so near touches can be proven"
    return stated("trajectory", False, message, statement)


def question(task: ToProve, bits: int) -> Record:
    """Return the header of a motion's file: the program, and the exact input as rational numbers."""
    return made_by(bits) | {
        "parameters": task.p.as_dict(),
        "start": {name: show(value) for name, value in zip(STARTS, task.start, strict=True)},
        "start_error": [show(error) for error in task.errors],
        "t_end": show(task.t_end),
    }


def event_row(event: ProvenEvent, digits: int) -> Record:
    """Return an event as a row of the file, with at most `digits` digits."""
    row: Record = event._asdict()
    return row | {name: list(outward(row[name], _known(row[name], digits))) for name in "tx"}


def _known(value: Ball, digits: int) -> int:
    """Return the number of digits of a ball, at most the given one."""
    low, high = exact_ends(value)
    scale = max(abs(low), abs(high), Fraction(1))
    return digits if low == high else min(digits, 2 + int((_log2(scale) - _log2(high - low)) * log10(2)))
