"""A motion up to its end, proven event by event, with as many bits as it takes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import islice
from math import ceil, log2, log10
from typing import Any, NamedTuple

from symosc.aliases import Record
from symosc.certificates.balls import FLINT_VERSION, Ball, Undecided, ball, exact_ends, outward, size, working_bits
from symosc.certificates.certificate import Certificate, confirmed
from symosc.certificates.graze import FREE, prove_touch
from symosc.certificates.motion import Moving, Problem, ProvenEvent, begin, next_event
from symosc.exact import show
from symosc.model import MODE_NAMES, Parameters

FIRST_BITS, MOST_BITS = 128, 8192
#: More bits do not help a start that is known to an error; they are raised this often only.
RAISES_WITH_ERROR = 1
MOST_PROVEN_EVENTS = 20_000
#: Enclosures of events have this many digits, and more where events are closer to each other.
DIGITS, DIGITS_BEYOND = 25, 8
EXACT = (Fraction(0),) * 3


class ToProve(NamedTuple):
    """What is to be proven: parameters, t0, x0, v0, their errors, t_end, and how many digits enclosures have."""

    p: Parameters
    start: tuple[Fraction, Fraction, Fraction]
    errors: tuple[Fraction, Fraction, Fraction]
    t_end: Fraction
    digits: int = DIGITS

    @property
    def exact(self) -> bool:
        """Whether the start is known exactly."""
        return not any(self.errors)


class Proof(NamedTuple):
    """Events that are proven, the mode that the motion starts in, what is open, and the start that touches."""

    mode: str
    events: list[ProvenEvent]
    open: Undecided | None = None
    free: tuple[str, Fraction, Fraction] | None = None


def first_bits(task: ToProve) -> int:
    """Return the precision to begin with: more for a start that is known very well, and for late ones."""
    p, (t0, _, v0) = task.p, task.start
    small = [each for each in (*task.errors, abs(v0 - p.v1), abs(v0 - p.v2)) if each]
    turns = abs(p.Omega * t0) + p.Omega * (task.t_end - t0)
    spare = max(0, *(-_log2(each) for each in small)) + max(0, _log2(turns))
    spare += ceil((task.digits - DIGITS) / log10(2))
    return FIRST_BITS + 32 * ceil(spare / 32)


def _log2(number: Fraction) -> int:
    return number.numerator.bit_length() - number.denominator.bit_length() if number else 0


def prove_trajectory(task: ToProve) -> Certificate:
    """Prove all events of a motion until t_end; see `symosc.certify`."""
    bits = first_bits(task)
    raises = 0
    while True:
        with working_bits(bits):
            proof = _follow(task)
            if proof.open is None:
                return _certificate(task, proof, bits)
            if proof.open.touch is not None and not task.exact:
                with working_bits(2 * bits):
                    touching = _with_a_touch(task, proof, proof.open.touch)
                if touching.open is None:
                    return _certificate(task, touching, bits)
            raises += 1
            if bits >= MOST_BITS or (not task.exact and raises > RAISES_WITH_ERROR):
                return _certificate(task, proof, bits)
        bits = min(2 * bits, MOST_BITS)


def _follow(task: ToProve) -> Proof:
    """Return what is proven with the working precision."""
    mode, events = "", []
    try:
        problem = Problem(task.p)
        state = begin(problem, task.start, task.errors)
        mode = MODE_NAMES[state.mode]
        for event, _ in _events(problem, state, task):
            events.append(event)
    except Undecided as undecided:
        return Proof(mode, events, undecided)
    return Proof(mode, events)


def _events(problem: Problem, state: Moving, task: ToProve) -> Iterator[tuple[ProvenEvent, Moving]]:
    """Yield the proven events until t_end, and the states after each."""
    t_end, count = ball(task.t_end), 0
    while (following := next_event(problem, state, t_end)) is not None:
        event, state = following
        if not event.t < t_end:
            raise Undecided("an event at the end", event.t)
        if task.exact and not (_accurate(event.t, task.digits) and _accurate(event.x, task.digits)):
            raise Undecided("the digits of an event", event.t)
        yield following
        count += 1
        if count >= MOST_PROVEN_EVENTS:
            raise Undecided(f"what comes after {count} events", event.t)


def _accurate(value: Ball, digits: int) -> bool:
    return size(value.rad()) < 10.0 ** (-digits - 1) * max(1.0, size(value))


def _with_a_touch(task: ToProve, proof: Proof, touch_near: tuple[int, Ball]) -> Proof:
    """Return a proof in which some start within the error touches where one with all starts is open."""
    problem, before = Problem(task.p), len(proof.events)
    name, place = next((name, place) for name, place in FREE if task.errors[place] or task.exact)
    events: list[ProvenEvent] = []

    def arrive(value: Ball) -> Moving:
        """Return the states after the events before the touch, from one ball of the free number."""
        events.clear()
        low, high = exact_ends(value)
        start, errors = list(task.start), list(EXACT)
        start[place], errors[place] = (low + high) / 2, (high - low) / 2
        state = begin(problem, (start[0], start[1], start[2]), (errors[0], errors[1], errors[2]))
        for event, after in islice(_events(problem, state, task), before):
            events.append(event)
            state = after
        return state

    try:
        touch = prove_touch(problem, arrive, name, (task.start[place], task.errors[place]), touch_near)
        arrive(ball(touch.low).union(ball(touch.high)))
        events.append(touch.event)
        events.extend(event for event, _ in _events(problem, touch.after, task))
    except Undecided as undecided:
        return Proof(proof.mode, events, undecided)
    return Proof(proof.mode, events, None, (name, touch.low, touch.high))


# -- what is said about it ---------------------------------------------------------------------------------------------


def _certificate(task: ToProve, proof: Proof, bits: int) -> Certificate:
    rows, before = [], ball(task.start[0])
    for event in proof.events:
        rows.append(_row(event, before, task))
        before = event.t
    statement = question(task, bits) | {
        "starts": "all" if proof.free is None else "some",
        "mode": proof.mode,
        "events": rows,
    }
    if proof.free is not None:
        name, low, high = proof.free
        statement["free"] = {"name": name, "low": show(low), "high": show(high)}
    if proof.open is None:
        return confirmed(Certificate("trajectory", True, "", events_of(rows), statement=statement))
    return Certificate("trajectory", False, _open(task, proof, proof.open, bits), events_of(rows), statement=statement)


def question(task: ToProve, bits: int) -> Record:
    """Return what the file of a motion says first: who made it, and the exact input as rational numbers."""
    return {
        "made_by": f"symosc, python-flint {FLINT_VERSION}, {bits} bits",
        "parameters": {name: show(getattr(task.p, name)) for name in task.p.as_dict()},
        "start": {name: show(value) for name, value in zip(("t0", "x0", "v0"), task.start, strict=True)},
        "start_error": [show(error) for error in task.errors],
        "t_end": show(task.t_end),
    }


def events_of(rows: Sequence[Record]) -> tuple[Any, ...]:
    """Return rows of a file as `Certificate.events`."""
    return tuple((row["kind"], row["source"], row["target"], tuple(row["t"]), tuple(row["x"])) for row in rows)


def _open(task: ToProve, proof: Proof, undecided: Undecided, bits: int) -> str:
    count = f"{len(proof.events)} event{'' if len(proof.events) == 1 else 's'}"
    near = "" if undecided.near is None else f" near t = {undecided.near.mid().str(15, radius=False)}"
    hint = ""
    if undecided.touch is not None and task.exact:
        hint = "; with start_error the statement that a start so near touches can be proven"
    return f"{undecided.what}{near} is not decided with {bits} bits, after {count}{hint}"


def _row(event: ProvenEvent, before: Ball, task: ToProve) -> Record:
    digits = task.digits
    since = event.t - before
    if since > 0:
        scale = max(1.0, size(event.t))
        digits = max(digits, DIGITS_BEYOND + ceil(log2(scale / size(since)) * log10(2)))
    return event_row(event, digits)


def event_row(event: ProvenEvent, digits: int) -> Record:
    """Return an event as a file has it, with so many digits at most."""
    numbers = {name: list(outward(value, _known(value, digits))) for name, value in (("t", event.t), ("x", event.x))}
    about = {"kind": event.kind, "boundary": event.boundary, "source": event.source, "target": event.target}
    return about | numbers


def _known(value: Ball, digits: int) -> int:
    """Return how many digits say what a ball says, but no more than that many."""
    low, high = exact_ends(value)
    width = high - low
    if width == 0:
        return digits
    scale = max(abs(low), abs(high), Fraction(1))
    return min(digits, 2 + int((_log2(scale) - _log2(width)) * log10(2)))
