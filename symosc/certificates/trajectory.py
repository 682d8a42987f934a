"""Proof of a motion up to its end, event by event, with as many bits as needed.

A graze of one start in its error.

A graze is a double zero of the gap, and no balls can tell it from a near miss. So one number s of
the start is left free: (t, s) is a simple zero of gap = d gap/dt = 0, and Krawczyk's operator
proves that exactly one s between two fractions grazes. The checker proves the same by continuity
and by the sign of d gap/ds (`symosc derive certificates`).

Derivatives of the events by a number are coefficients of power series of two terms in its change:
at the time of the next event, which is known, v (on a belt: the force that vanishes) has a
derivative, and the implicit function theorem gives that of the event. It holds because each event
is proven to be transversal: the slope there is not 0, nor is the force after it. So nearby motions
have the same events.

A motion settles on a proven orbit: let P be the map from an arrival at a belt to the same one some
periods later, less the periods, and B = c + [-e, e] a box about the orbit's arrival. If every
motion from B has the events of the word, and P(B) lies in B, every motion that comes into B has
these events in every later period. Let D contain the derivatives of P over B and q be the largest
of (|D| e)_i / e_i. If q < 1, there is one fixed point in B, and after n cycles a motion is within 2
q^n e of it. So a certificate says as much of 100,000 periods as of one.

A start on a belt to all its digits, where a stick ends, may stick a little at first: every start
leaves the belt before a time that is stated, with F = 0 or F of the sign of a flight. All these
flights are followed as one set.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import islice
from math import ceil, floor, log2, log10
from typing import NamedTuple, TypeAlias

from flint import arb, arb_mat, arb_series, ctx

from symosc.base.aliases import Record
from symosc.base.exact import show
from symosc.certificates.balls import (
    Ball,
    StateSet,
    Undecided,
    around,
    ball,
    exact_ends,
    made_by,
    outward,
    size,
)
from symosc.certificates.certificate import STARTS, Certificate, confirmed, provable, stated
from symosc.certificates.flow import Flight, Jet, Oscillator, coefficient
from symosc.certificates.motion import (
    ON_A_BELT,
    Moving,
    ProvenEvent,
    begin,
    belts_around,
    enclosed_zero,
    first_zero,
    next_event,
)
from symosc.certificates.orbit import (
    ClosingBalls,
    Values,
    krawczyk,
    one_digit,
    switchings,
    unit_matrix,
)
from symosc.friction import MODE_NAMES
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.closing_equations import pieces_of
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.words import Word

FIRST_BITS = 128
MOST_BITS = 8192
#: How often the bits are doubled for a start with an error, which they hardly help.
RAISES_WITH_ERROR = 1
MOST_PROVEN_EVENTS = 20_000
#: Enclosures of events have this many digits, and more where events are closer to each other.
DIGITS = 25
DIGITS_BEYOND = 8
EXACT = (Fraction(0),) * 3
WIDE = "the digits of a derivative"
#: Which start value is varied for a graze: the first one of these that has an error.
FREE = (("x0", 1), ("v0", 2), ("t0", 0))
MOST_SECANTS = 12
MOST_NARROWINGS = 60
MODE_NUMBERS = {name: mode for mode, name in MODE_NAMES.items()}
SETTLED_BITS = 320
#: How many events a motion may take to come near the orbit, and how near that is (of t, and of x).
MOST_EVENTS_BEFORE = 2000
NEAR_ARRIVAL = 1e-6
#: How many times larger the box is than the set that comes into it; its least size; the largest
#: factor q.
BOX_MARGIN = 8
LEAST_BOX = Fraction(1, 10**22)
MOST_Q = 0.9
MOST_TURNS = 8
#: dt and dx of an event.
Change: TypeAlias = tuple[Ball, Ball]


class ToProve(NamedTuple):
    """The motion to prove: parameters, start (t0, x0, v0), errors, t_end, digits, and names for
    derivatives (`wrt`).
    """

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
        """Return whether balls are known to the task's digits, relative to the value or, if |value|
        < 1, to 1.
        """
        return all(
            size(each.rad()) < 10.0 ** (-self.digits - 1) * max(1.0, size(each)) for each in values
        )


class Proof(NamedTuple):
    """What is proven of a motion: its first mode and its events.

    `undecided` is the exception that ended the proof.
    """

    mode: str
    events: list[ProvenEvent]
    undecided: Undecided | None = None
    free: tuple[str, Fraction, Fraction] | None = (
        None  # a number of the start, and between what one value grazes
    )
    changes: list[list[Change]] | None = None  # dt and dx of all events by each name


def prove_trajectory(task: ToProve) -> Certificate:
    """Prove all events of a motion until t_end, with more bits where some sign is undecided.

    Return the certificate.
    """
    bits = _first_bits(task)
    raises = 0
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
    """Return the binary precision to begin with: more for an accurate start and for late times."""
    p = task.p
    (t0, _, v0) = task.start
    small = [each for each in (*task.errors, abs(v0 - p.v1), abs(v0 - p.v2)) if each]
    turns = abs(p.Omega * t0) + p.Omega * (task.t_end - t0)
    spare = max(0, *(-_log2(each) for each in small)) + max(0, _log2(turns))
    return FIRST_BITS + 32 * ceil((spare + ceil((task.digits - DIGITS) / log10(2))) / 32)


def _log2(number: Fraction) -> int:
    """Return the binary logarithm of a number, approximately."""
    if number:
        return number.numerator.bit_length() - number.denominator.bit_length()
    return 0


def _follow(task: ToProve) -> Proof:
    """Prove events with the working precision until t_end, or up to the first sign that is
    undecided.
    """
    mode = ""
    events = []
    o = Oscillator(task.p)
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
    count = 0
    for event, after in _followed(o, state, t_end, MOST_PROVEN_EVENTS):
        count += 1
        if not event.t < t_end:
            raise Undecided("an event at the end", event.t)
        if task.exact and not task.precise(event.t, event.x):
            raise Undecided("the digits of an event", event.t)
        yield event, after
    if count == MOST_PROVEN_EVENTS:
        raise Undecided(f"what comes after {MOST_PROVEN_EVENTS} events", event.t)


def _followed(
    o: Oscillator, state: Moving, t_end: Ball, most: int
) -> Iterator[tuple[ProvenEvent, Moving]]:
    """Yield up to `most` proven events before t_end, with the states after each."""
    for _ in range(most):
        following = next_event(o, state, t_end)
        if following is None:
            return
        yield following
        state = following[1]


# -- derivatives -----------------------------------------------------------------------------------


def _differentiated(task: ToProve, proof: Proof) -> Proof:
    """Return `proof` with the derivatives by `task.wrt` added or, if one is undecided, the
    exception that says so.
    """
    try:
        changes = [
            _changes(task, MODE_NUMBERS[proof.mode], proof.events, name) for name in task.wrt
        ]
        if not task.precise(
            *(value for column in changes for change in column for value in change)
        ):
            raise Undecided(WIDE)
    except Undecided as undecided:
        return proof._replace(undecided=undecided)
    return proof._replace(changes=changes)


def _changes(task: ToProve, mode: int, events: Sequence[ProvenEvent], name: str) -> list[Change]:
    """Enclose derivatives of t and x of all events by `name`, a parameter or start value.

    `mode` is the first mode.
    """
    p = task.p
    start = task.start
    if name not in provable(p, start[2]):
        on_belt = start[2] in (p.v1, p.v2) and name[0] == "v"
        if on_belt:
            where = "of a start on a belt"
        else:
            where = "at resonance or where it is 0"
        raise Undecided(f"a derivative by {name} {where}")

    def series(value: Ball, slope: Ball) -> Ball:
        return arb_series([value, slope], prec=2)

    found: list[Change] = []
    with suppress(ZeroDivisionError, ValueError):  # series cannot be divided by what may be 0
        o = Oscillator(
            p, {name: series(ball(getattr(p, name)), arb(1))} if name in PARAMETER_NAMES else None
        )
        t, x, v = (
            series(ball(value), arb(int(name == own)))
            for value, own in zip(start, STARTS, strict=True)
        )
        for event in events:
            if event.kind == "graze":
                raise Undecided("a derivative behind a graze", event.t)
            speed = o.speed[event.boundary]
            then = series(event.t, arb(0))
            target = MODE_NUMBERS[event.target]
            if mode > ON_A_BELT:
                at_end = x + speed * (then - t)
                force = o.force(target, then, at_end, speed)
                dt = coefficient(force, 1) / coefficient(
                    o.km * speed + o.drive * (o.Omega * then).sin()
                )
            else:
                flight = Flight(o, mode, t, x, v)
                there = flight.at(then - t)
                at_end = flight.x(there)
                dt = coefficient(speed - there.v, 1) / coefficient(there.a)
            dx = coefficient(at_end, 1) + coefficient(speed) * dt
            if not (dt.is_finite() and dx.is_finite()):
                raise Undecided(f"a derivative by {name} of an event", event.t)
            found.append((dt, dx))
            mode = target
            t = series(event.t, dt)
            x = series(event.x, dx)
            v = speed
        return found
    raise Undecided(f"a derivative by {name} at critical damping")


# -- a graze of some start -------------------------------------------------------------------------


def _with_a_graze(task: ToProve, proof: Proof, graze: tuple[int, Ball]) -> Proof:
    """Return a proof that one start within the error grazes, after the events of `proof`, near
    `graze` (belt, time).
    """
    o = Oscillator(task.p)
    before = len(proof.events)
    (boundary, near) = graze
    name, place = next((name, place) for name, place in FREE if task.errors[place])
    events: list[ProvenEvent] = []

    def arrive(value: Ball) -> Moving:
        """Return the states before the grazing flight, from all starts whose t0, x0 or v0 (`name`)
        is in `value`.
        """
        events.clear()
        low, high = exact_ends(value)
        start = list(task.start)
        errors = list(EXACT)
        start[place] = (low + high) / 2
        errors[place] = (high - low) / 2
        state = begin(o, tuple(start), tuple(errors))
        for event, after in islice(_events(o, state, task), before):
            events.append(event)
            state = after
        return state

    try:
        low, high = _grazing_interval(
            o, arrive, boundary, task.start[place], task.errors[place], near
        )
        free = ball(low).union(ball(high))
        middle = arrive(free.mid())
        state = arrive(free)
        flight, there = _lowest(o, state, boundary, near)
        _only_contact(o, state, flight, there, boundary)
        # Exactly one start value between low and high has a flight that grazes near `times`
        # (Krawczyk).
        side = flight.side(boundary)
        lowest = flight.t0 + there.tau
        times = around(lowest.mid(), 4 * lowest.rad())
        one = middle.flight(o, middle.states.hull())
        thin = one.at(times.mid() - one.t0)
        wide = flight.at(times - flight.t0)
        dx, dv = flight.moved(wide, [row[place] for row in state.states.slopes])
        J = side * arb_mat([[wide.a, dv], [flight.jerk(wide), -o.cm * dv - o.km * dx]])
        residual = [side * (thin.v - o.speed[boundary]), side * thin.a]
        image = krawczyk([times, free], [times.mid(), free.mid()], residual, J)
        if image is None or not ball(low) < image[1] < ball(high):
            raise Undecided("whether a flight near this start touches", lowest)
        states = StateSet.of([flight.t0 + there.tau, flight.x(flight.at(there.tau))])
        t, x = states.hull()
        mode = MODE_NAMES[state.mode]
        events.append(ProvenEvent("graze", boundary, mode, mode, t, x))
        events.extend(event for event, _ in _events(o, Moving(state.mode, boundary, states), task))
    except Undecided as undecided:
        return Proof(proof.mode, events, undecided)
    return Proof(proof.mode, events, None, (name, low, high))


def _grazing_interval(
    o: Oscillator,
    arrive: Callable[[Ball], Moving],
    boundary: int,
    given: Fraction,
    error: Fraction,
    near: Ball,
) -> tuple[Fraction, Fraction]:
    """Estimate, by the secant method, two values of t0, x0 or v0 between which one leads to a
    graze; no proof.

    `arrive` returns the states before the flight that grazes, about a time `near` after its start.
    The values differ from the `given` one by `error` at most.
    """
    start = ball(given)
    reach = ball(error)
    points = list[tuple[Ball, Ball]]()
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
    low, high = (
        Fraction(round(exact_ends(points[-1][0])[0] / unit) + step) * unit for step in (-1, 1)
    )
    if max(abs(low - given), abs(high - given)) > error:
        raise Undecided("a touch that is further off than the error of the start", near)
    return low, high


def _lowest(o: Oscillator, state: Moving, boundary: int, near: Ball) -> tuple[Flight, Jet]:
    """Return the flight, and the jet of its gap to a belt at the time when the gap is least, near
    `near`.
    """
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
        done = abs(following - tau) < arb(2) ** (10 - ctx.prec) * abs(tau)
        tau = following
        if done:
            break
    ends = (arb(0), arb.pos_inf())
    spare = arb(2) ** (8 - ctx.prec)
    return flight, gap(
        enclosed_zero(falling, falling(tau), spare, ends, "the lowest point of a gap", flight.t0)
    )


def _only_contact(o: Oscillator, state: Moving, flight: Flight, there: Jet, boundary: int) -> None:
    """Prove that a flight has no contact before its graze, which is at the jet `there`, or raise
    Undecided.
    """
    width = there.tau.mid() / 4
    for _ in range(MOST_NARROWINGS):
        if abs(flight.jerk(flight.at(around(there.tau, width)))) > 0:
            break
        width = width / 2
    else:
        raise Undecided("the bend of a gap at a touch", flight.t0 + there.tau)
    for belt in belts_around(state.mode):
        if belt == boundary:
            before = (there.tau - width).lower()
        else:
            before = there.tau.upper()
        if first_zero(flight, belt, before, belt == state.boundary) is not None:
            raise Undecided("a contact before a touch", flight.t0 + there.tau)


# -- the certificate -------------------------------------------------------------------------------


def _certificate(task: ToProve, proof: Proof, bits: int) -> Certificate:
    """Return the certificate of a motion: with the checker's verdict, or with what `bits` bits
    leave undecided.
    """
    rows = []
    before = ball(task.start[0])
    undecided = proof.undecided
    for event in proof.events:
        digits = task.digits
        since = event.t - before
        if since > 0:
            scale = max(1.0, size(event.t))
            digits = max(digits, DIGITS_BEYOND + ceil(log2(scale / size(since)) * log10(2)))
        rows.append(event_row(event, digits))
        before = event.t
    if proof.free is None:
        starts = "all"
    else:
        starts = "some"
    statement = first_entries(task, bits) | {"starts": starts, "mode": proof.mode, "events": rows}
    if proof.changes:
        derivatives = [
            {
                d: [decimals(change[i], task.digits) for change in of_event]
                for i, d in enumerate(("dt", "dx"))
            }
            for of_event in zip(*proof.changes, strict=True)
        ]
        statement |= {"wrt": list(task.wrt), "derivatives": derivatives}
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


def first_entries(task: ToProve, bits: int) -> Record:
    """Return the first entries of a motion's file: the program, and parameters and start as
    rational numbers.
    """
    return made_by(bits) | {
        "parameters": task.p.as_dict(),
        "start": {name: show(value) for name, value in zip(STARTS, task.start, strict=True)},
        "start_error": [show(error) for error in task.errors],
        "t_end": show(task.t_end),
    }


def event_row(event: ProvenEvent, digits: int) -> Record:
    """Return an event as a row of the file, with at most `digits` digits."""
    return event.named() | {"t": decimals(event.t, digits), "x": decimals(event.x, digits)}


def decimals(value: Ball, digits: int) -> list[str]:
    """Return both ends of a ball as decimals with the digits that are known, at most `digits`."""
    low, high = exact_ends(value)
    if low != high:
        scale = max(abs(low), abs(high), Fraction(1))
        digits = min(digits, 2 + int((_log2(scale) - _log2(high - low)) * log10(2)))
    return list(outward(value, digits))


# -- motions that settle ---------------------------------------------------------------------------


class Cycle(NamedTuple):
    """A box of t and x at an arrival on a belt, into which all motions from it come back after
    `turns` periods.
    """

    place: int  # the orbit's switching point in it
    middle: list[Fraction]
    widths: list[Fraction]  # half-widths
    turns: int
    events: list[ProvenEvent]
    states: list[StateSet]


def prove_settled(task: ToProve, orbit: PeriodicOrbit) -> Certificate:
    """Prove all events until t_end of a motion that settles on an orbit, by a cycle of events.

    Return a certificate.
    """
    with ctx.workprec(SETTLED_BITS):
        closing = ClosingBalls(Oscillator(task.p), pieces_of(Word(orbit.labels)), orbit.periods)
        before: list[ProvenEvent] = []
        try:
            near = closing.polished([arb(float(each)) for point in orbit.points for each in point])
            root = next((root for _, root in closing.roots(near)), None)
            if root is None:
                raise Undecided("the orbit on which the motion is to settle")
            start, until = _start(closing.oscillator, task)
            about = first_entries(task, SETTLED_BITS) | {"mode": MODE_NAMES[start.mode]}
            if until is None:
                about["may_stick_until"] = None
            else:
                about["may_stick_until"] = show(until)
            for event, state in _followed(
                closing.oscillator, start, ball(task.t_end), MOST_EVENTS_BEFORE
            ):
                before.append(event)
                i = _arrival(closing, root, event)
                if i is not None and (cycle := _invariant_box(closing, root, i, state)) is not None:
                    return _settled_certificate(task, closing, root, before, cycle, about)
            raise Undecided(f"whether the motion settles on the orbit within {len(before)} events")
        except Undecided as undecided:
            return Certificate("settled", False, f"not decided: {undecided.what}")


def _start(o: Oscillator, task: ToProve) -> tuple[Moving, Fraction | None]:
    """Return the initial states and None or, if the mass may stick first, the states as it slips
    and a later time.
    """
    p = task.p
    (t0, x0, v0) = task.start
    try:
        return begin(o, task.start, task.errors), None
    except Undecided:
        if v0 not in (p.v1, p.v2) or task.errors[2]:
            raise
    if v0 == p.v1:
        boundary = 1
    else:
        boundary = 2
    t, x = (around(ball(c), ball(e)) for c, e in zip((t0, x0), task.errors, strict=False))
    low, high = (o.force(domain, t, x, o.speed[boundary]) for domain in (boundary, boundary + 1))
    slope = -(o.km * o.speed[boundary] + o.drive * (o.Omega * t).sin())
    if not ((slope < 0 and high < 0) or (slope > 0 and low > 0)):
        raise Undecided("a force on the belt at the start", t)
    if slope < 0:
        domain = boundary
        force = low
    else:
        domain = boundary + 1
        force = high
    longest = exact_ends(2 * abs(force).upper() / abs(slope).lower())[1]
    lasts = task.errors[0] + Fraction(
        floor(longest * 10**60) + 2, 10**60
    )  # a decimal of few digits above it
    reached = x + arb(0, (abs(o.speed[boundary]) * ball(2 * lasts)).upper())
    return Moving(
        domain, boundary, StateSet.of([around(ball(t0), ball(lasts)), reached])
    ), t0 + lasts


def _arrival(closing: ClosingBalls, points: Values, event: ProvenEvent) -> int | None:
    """Return the index of the orbit's switching point (after a flight) that is near an event; None
    if none is.
    """
    for i, row in enumerate(switchings(closing, points, 0)[:-1]):
        turns = float((event.t - row.t) / closing.turn)
        near = (
            abs(turns - round(turns)) < NEAR_ARRIVAL and abs(float(event.x - row.x)) < NEAR_ARRIVAL
        )
        if near and row[:4] == event[:4] and event.kind != "slip":
            return i
    return None


def _invariant_box(closing: ClosingBalls, points: Values, i: int, state: Moving) -> Cycle | None:
    """Return a box around the orbit's point i that has `state` in it and into which its motions
    return, or None.
    """
    n = len(closing.pieces)
    turns = 1
    once = unit_matrix(2)
    for j in range(i, i + n):  # the derivative of the map from point i to itself, approximately
        once = (closing.end_by_start(j % n, points) * once).mid()
    D = once
    while (shape := _contracted_box(D)) is None:
        turns = turns + 1
        D = D * once
        if turns > MOST_TURNS:
            raise Undecided("a norm in which the orbit attracts")
    t, x = state.states.hull()
    gone = round(float((t - points[2 * i]) / closing.turn))
    about = points[2 * i] + gone * closing.turn, points[2 * i + 1]
    middle = [Fraction(round(exact_ends(each)[0] * 10**60), 10**60) for each in about]
    off = [abs(value - ball(c)).upper() for value, c in zip((t, x), middle, strict=True)]
    largest = max(
        LEAST_BOX,
        *(BOX_MARGIN * exact_ends(each / ball(w))[1] for each, w in zip(off, shape, strict=True)),
    )
    widths = [Fraction(one_digit(ball(largest * w))) for w in shape]
    if max(widths) > NEAR_ARRIVAL:
        return None
    box = StateSet.of([around(ball(c), ball(w)) for c, w in zip(middle, widths, strict=True)])
    late = box.hull()[0] + (turns + 1) * closing.turn
    steps = list(
        _followed(closing.oscillator, Moving(state.mode, state.boundary, box), late, n * turns)
    )
    events = [event for event, _ in steps]
    states = [box, *(after.states for _, after in steps)]
    t, x = states[-1].hull()
    t = t - turns * closing.turn
    inside = all(
        ball(w) > abs(value - ball(c)) for value, c, w in zip((t, x), middle, widths, strict=True)
    )
    wanted = switchings(closing, points, i)[1:] * turns
    same = [event[:4] for event in events] == [row[:4] for row in wanted]
    if inside and same:
        return Cycle(i, middle, widths, turns, events, states)
    return None


def _contracted_box(D: arb_mat) -> tuple[Fraction, Fraction] | None:
    """Return sides (the larger is 1) of a box about 0 that the matrix D maps into a smaller copy of
    it, or None.
    """
    sizes = [[abs(float(D[i, j])) for j in (0, 1)] for i in (0, 1)]
    e = [1.0, 1.0]
    for _ in range(60):  # towards the eigenvector of |D|
        e = [sum(a * b for a, b in zip(row, e, strict=True)) + 1e-3 * max(e) for row in sizes]
        e = [each / max(e) for each in e]
    q = max(
        sum(a * b for a, b in zip(row, e, strict=True)) / each
        for row, each in zip(sizes, e, strict=True)
    )
    if q < MOST_Q:
        return (Fraction(f"{e[0]:.2g}"), Fraction(f"{e[1]:.2g}"))
    return None


def _settled_certificate(
    task: ToProve,
    closing: ClosingBalls,
    points: Values,
    before: Sequence[ProvenEvent],
    cycle: Cycle,
    about: Record,
) -> Certificate:
    """Let the checker prove that the events `before` lead into a `cycle`.

    Return the certificate, headed by `about`.
    """
    n = len(cycle.events)
    turn = cycle.turns * closing.turn
    t_end = ball(task.t_end)
    widths = list(map(ball, cycle.widths))
    box = [[show(c - w), show(c + w)] for c, w in zip(cycle.middle, cycle.widths, strict=True)]
    rows = [event_row(before[-1], DIGITS) | {"t": box[0], "x": box[1]}]
    for event in cycle.events:
        wide = event._replace(
            t=around(event.t, 2 * event.t.rad()), x=around(event.x, 2 * event.x.rad())
        )
        rows.append(event_row(wide, 60))
    times = [around(ball(cycle.middle[0]), widths[0]), *(event.t for event in cycle.events)]
    cycles = max(0, floor(float((t_end - times[0]) / turn)))
    left = sum(bool(each + cycles * turn < t_end) for each in times[:-1]) - 1
    if left < 0 or not times[left] + cycles * turn < t_end < times[left + 1] + cycles * turn:
        raise Undecided("how many events there are until t_end")
    reaches = [
        [
            sum((abs(d) * w for d, w in zip(row, widths, strict=True)), arb(0))
            for row in states.slopes
        ]
        for states in cycle.states
    ]
    sums = [reach / width for reach, width in zip(reaches[-1], widths, strict=True)]
    q = sums[0].union(sums[1]).upper()
    if not q < 1:
        raise Undecided("a norm in which the orbit attracts")
    total = cycles * n + left
    last = []
    for number in range(max(1, total - n // cycle.turns + 1), total + 1):
        k, j = divmod(number, n)
        place = (cycle.place + j) % len(closing.pieces)
        if j == 0:
            event = before[-1]
        else:
            event = cycle.events[j - 1]
        spare = [2 * reach * q**k for reach in reaches[j]]
        gone = ((times[j] - points[2 * place]) / closing.turn).unique_fmpz()
        if gone is None:
            raise Undecided("how many periods an event of the cycle is behind that of the orbit")
        t = around(points[2 * place] + int(gone) * closing.turn + k * turn, spare[0])
        last.append(
            event_row(event._replace(t=t, x=around(points[2 * place + 1], spare[1])), task.digits)
        )
    statement = about | {
        "events": [event_row(event, DIGITS) for event in before],
        "periods": cycle.turns * closing.periods,
        "cycle": rows,
        "count": len(before) + total,
        "last": last,
    }
    return confirmed("settled", statement)
