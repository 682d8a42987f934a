"""Proof of a motion up to its end, event by event, with as many bits as needed; a graze of one start in its error.

A graze is a double zero of the gap, and no balls can tell it from a near miss. So one number of the start is left free,
s, and with it the zero is a simple one of the bordered system

    gap(t, s) = 0,    d gap/dt (t, s) = 0,

whose Jacobian [[gap_t, gap_s], [gap_tt, gap_ts]] is regular where gap_s and gap_tt are not 0. Krawczyk's operator
(`symosc.certificates.orbit`) maps a box of times and of s between two fractions into its interior: for exactly one s
between them the flight grazes. For all s between them the derivative of the acceleration has one sign around the graze,
so it is the only contact there. The checker proves the same by continuity and by the sign of gap_s.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import islice
from math import ceil, log2, log10
from typing import NamedTuple

from flint import arb, arb_mat, ctx

from symosc.aliases import Record
from symosc.certificates.balls import Ball, StateSet, Undecided, around, ball, exact_ends, made_by, outward, size
from symosc.certificates.certificate import Certificate, changes_of, confirmed, events_of
from symosc.certificates.derivatives import NUMBERS, Change, event_changes
from symosc.certificates.flow import Flight, Jet, Oscillator
from symosc.certificates.motion import Moving, ProvenEvent, begin, belts_around, fenced, first_zero, next_event
from symosc.exact import show
from symosc.model import MODE_NAMES, Parameters

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
    spare += ceil((task.digits - DIGITS) / log10(2))
    return FIRST_BITS + 32 * ceil(spare / 32)


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


def _differentiated(task: ToProve, proof: Proof) -> Proof:
    """Return a proof with the derivatives asked for, or with the reason why one of them is undecided."""
    changes, mode = [], NUMBERS[proof.mode]
    try:
        for name in task.wrt:
            changes.append(event_changes(task.p, task.start, mode, proof.events, name))
        wanted = 10.0 ** (-task.digits - 1)
        for value in (value for column in changes for change in column for value in change):
            if not size(value.rad()) < wanted * max(1.0, size(value)):
                raise Undecided(WIDE)
    except Undecided as undecided:
        return proof._replace(undecided=undecided)
    return proof._replace(changes=changes)


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
        wanted = 10.0 ** (-task.digits - 1)
        if task.exact and not all(size(it.rad()) < wanted * max(1.0, size(it)) for it in (event.t, event.x)):
            raise Undecided("the digits of an event", event.t)
        yield following
    raise Undecided(f"what comes after {MOST_PROVEN_EVENTS} events", event.t)


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
        state = arrive(ball(low).union(ball(high)))
        before_it = events.copy()
        flight, there = _lowest(o, state, boundary, near)
        _only_contact(o, state, flight, there, boundary)
        _krawczyk(o, arrive, state, flight, there.tau, boundary, place, ball(low), ball(high))
        events[:] = before_it
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
    start, reach, points = ball(given), ball(error), []

    def sample(value: Ball, near: Ball) -> Ball:
        _, there = _lowest(o, arrive(value), boundary, near)
        points.append((value, there.g.mid()))
        return there.tau

    for share in (arb(0), arb(0.25)):
        near = sample((start + share * reach).mid(), near)
    for _ in range(MOST_SECANTS):
        (s, g), (s2, g2) = points[-2:]
        step = (g2 * (s2 - s) / (g2 - g)).mid()
        if not step.is_finite():
            break
        value = (s2 - step).mid()
        if not abs(value - start) <= reach:
            break
        near = sample(value, near)
    unit = Fraction(1, 10 ** int(ctx.prec * 0.301 / 2.5 + 1))
    low, high = (Fraction(round(exact_ends(points[-1][0])[0] / unit) + step) * unit for step in (-1, 1))
    if max(abs(low - given), abs(high - given)) > error:
        raise Undecided("a touch that is further off than the error of the start", near)
    return low, high


def _krawczyk(
    o: Oscillator,
    arrive: Callable[[Ball], Moving],
    state: Moving,
    flight: Flight,
    tau: Ball,
    boundary: int,
    place: int,
    low: Ball,
    high: Ball,
) -> None:
    """Prove that for exactly one free number between low and high a flight grazes in a box of times."""
    # `flight` and `state` are of all these starts, `tau` is when their gap is lowest, `place` that of the free number.
    side, speed = flight.side(boundary), o.speed[boundary]
    lowest, free = flight.t0 + tau, low.union(high)
    times = around(lowest.mid(), 4 * lowest.rad())
    t, s = times.mid(), free.mid()

    thin = arrive(s)
    one = thin.flight(o, thin.states.hull())
    there = one.at(t - one.t0)
    residual = arb_mat([[side * (there.v - speed)], [side * there.a]])

    there = flight.at(times - flight.t0)
    dx, dv = flight.moved(there, [row[place] for row in state.states.slopes])
    da = -o.cm * dv - o.km * dx
    J = side * arb_mat([[there.a, dv], [flight.jerk(there), da]])
    try:
        Y = J.mid().inv().mid()
    except ZeroDivisionError:
        raise Undecided("a touch that does not depend on the free number of the start", lowest) from None
    off = (arb_mat([[1, 0], [0, 1]]) - Y * J) * arb_mat([[times - t], [free - s]]) - Y * residual
    t, s = t + off[0, 0], s + off[1, 0]
    if not (times.contains_interior(t) and low < s < high):
        raise Undecided("whether a flight near this start touches", lowest)


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
        bend = flight.jerk(flight.at(around(there.tau, width)))
        if bend > 0 or bend < 0:
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
    rows, before = [], ball(task.start[0])
    for event in proof.events:
        digits, since = task.digits, event.t - before
        if since > 0:
            scale = max(1.0, size(event.t))
            digits = max(digits, DIGITS_BEYOND + ceil(log2(scale / size(since)) * log10(2)))
        rows.append(event_row(event, digits))
        before = event.t
    statement = question(task, bits) | {
        "starts": "all" if proof.free is None else "some",
        "mode": proof.mode,
        "events": rows,
    }
    if proof.changes:
        ends = [
            [[list(outward(each, _known(each, task.digits))) for each in change] for change in column]
            for column in proof.changes
        ]
        derivatives = [
            {name: [change[i] for change in row] for i, name in enumerate(("dt", "dx"))}
            for row in zip(*ends, strict=True)
        ]
        statement |= {"wrt": list(task.wrt), "derivatives": derivatives}
    if proof.free is not None:
        name, low, high = proof.free
        statement["free"] = {"name": name, "low": show(low), "high": show(high)}
    if proof.undecided is None:
        changes = changes_of(statement.get("derivatives", ()))
        return confirmed(Certificate("trajectory", True, "", events_of(rows), statement=statement, derivatives=changes))
    count = f"{len(rows)} event{'' if len(rows) == 1 else 's'}"
    message = f"{proof.undecided.what}{proof.undecided.place()} is not decided with {bits} bits, after {count}"
    if proof.undecided.graze is not None and task.exact:
        message += "; with start_error the statement that a start so near touches can be proven"
    return Certificate("trajectory", False, message, events_of(rows), statement=statement)


def question(task: ToProve, bits: int) -> Record:
    """Return the header of a motion's file: the program, and the exact input as rational numbers."""
    return made_by(bits) | {
        "parameters": {name: show(getattr(task.p, name)) for name in task.p.as_dict()},
        "start": {name: show(value) for name, value in zip(("t0", "x0", "v0"), task.start, strict=True)},
        "start_error": [show(error) for error in task.errors],
        "t_end": show(task.t_end),
    }


def event_row(event: ProvenEvent, digits: int) -> Record:
    """Return an event as a row of the file, with at most `digits` digits."""
    row: Record = {"kind": event.kind, "boundary": event.boundary, "source": event.source, "target": event.target}
    return row | {name: list(outward(value, _known(value, digits))) for name, value in (("t", event.t), ("x", event.x))}


def _known(value: Ball, digits: int) -> int:
    """Return the number of digits of a ball, at most the given one."""
    low, high = exact_ends(value)
    scale = max(abs(low), abs(high), Fraction(1))
    return digits if low == high else min(digits, 2 + int((_log2(scale) - _log2(high - low)) * log10(2)))
