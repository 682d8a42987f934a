"""Proof of a motion that settles on a proven orbit: events of any number of periods, by a contraction over one.

Let P be the map from an arrival at a belt to the same one some periods later, less the periods, and B = c + [-e, e] a
box about the orbit's arrival. If every motion from B has the events of the word, and P(B) lies in B, then every motion
that comes into B has these events in every later period. Let D contain the derivatives of P over B and q be the largest
of (|D| e)_i / e_i. If q < 1, there is one fixed point in B, and after n cycles a motion is within 2 q^n e of it
(`symosc derive certificates`). So a certificate says as much of 100,000 periods as of one.

A start on a belt to all its digits, where a stick ends, may stick a little at first: every start leaves the belt before
a time that is stated, with F = 0 or F of the sign of a flight. All these flights are followed as one set.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import floor
from typing import NamedTuple

from flint import arb, arb_mat, ctx

from symosc.aliases import Record
from symosc.certificates.balls import Ball, StateSet, Undecided, around, ball, exact_ends
from symosc.certificates.certificate import Certificate, confirmed
from symosc.certificates.flow import Oscillator
from symosc.certificates.motion import Moving, ProvenEvent, begin, next_event
from symosc.certificates.orbit import ClosingBalls, Values, one_digit, switchings, unit_matrix
from symosc.certificates.trajectory import DIGITS, ToProve, event_row, question
from symosc.exact import show
from symosc.model import MODE_NAMES
from symosc.orbits.closing_equations import pieces_of
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.words import Word

SETTLED_BITS = 320
#: How many events a motion may take to come near the orbit, and how near that is (of t, and of x).
MOST_EVENTS_BEFORE, NEAR_ARRIVAL = 2000, 1e-6
#: A box is this many times larger than the set that comes into it; the least one; the largest factor q.
BOX_MARGIN, LEAST_BOX, MOST_Q, MOST_TURNS = 8, Fraction(1, 10**22), 0.9, 8


class Cycle(NamedTuple):
    """A box of (t, x) that `turns` rounds of the orbit map into itself, with its events and the sets after them."""

    middle: list[Fraction]
    widths: list[Fraction]  # half-widths
    turns: int
    events: list[ProvenEvent]
    states: list[StateSet]


def prove_settled(task: ToProve, orbit: PeriodicOrbit) -> Certificate:
    """Prove all events of a motion until t_end that repeat from some event on as it approaches an orbit."""
    with ctx.workprec(SETTLED_BITS):
        closing = ClosingBalls(Oscillator(task.p), pieces_of(Word(orbit.labels)), orbit.periods)
        before: list[ProvenEvent] = []
        try:
            near = closing.polished([arb(float(each)) for point in orbit.points for each in point])
            root = next((root for _, root in closing.roots(near)), None)
            if root is None:
                raise Undecided("the orbit on which the motion is to settle")
            start, until = _start(closing.oscillator, task)
            about = question(task, SETTLED_BITS) | {"mode": MODE_NAMES[start.mode]}
            about["may_stick_until"] = None if until is None else show(until)
            for event, state in _followed(closing.oscillator, start, ball(task.t_end), MOST_EVENTS_BEFORE):
                before.append(event)
                i = _arrival(closing, root, event)
                cycle = None if i is None else _invariant_box(closing, root, i, state)
                if i is not None and cycle is not None:
                    return _certificate(task, closing, root, i, before, cycle, about)
            raise Undecided(f"whether the motion settles on the orbit within {len(before)} events")
        except Undecided as undecided:
            return Certificate("settled", False, f"not decided: {undecided.what}")


def _start(o: Oscillator, task: ToProve) -> tuple[Moving, Fraction | None]:
    """Return the initial states and, for a start at the end of a stick, the time until which some of them may stick."""
    p, (t0, x0, v0) = task.p, task.start
    try:
        return begin(o, task.start, task.errors), None
    except Undecided:
        if v0 not in (p.v1, p.v2) or task.errors[2]:
            raise
    boundary = 1 if v0 == p.v1 else 2
    t, x = (around(ball(c), ball(e)) for c, e in zip((t0, x0), task.errors, strict=False))
    low, high = (o.force(domain, t, x, o.speed[boundary]) for domain in (boundary, boundary + 1))
    slope = -(o.km * o.speed[boundary] + o.drive * (o.Omega * t).sin())
    if not ((slope < 0 and high < 0) or (slope > 0 and low > 0)):
        raise Undecided("a force on the belt at the start", t)
    domain, force = (boundary, low) if slope < 0 else (boundary + 1, high)
    longest = exact_ends(2 * abs(force).upper() / abs(slope).lower())[1]
    lasts = task.errors[0] + Fraction(floor(longest * 10**60) + 2, 10**60)  # a decimal of few digits above it
    reached = x + arb(0, (abs(o.speed[boundary]) * ball(2 * lasts)).upper())
    return Moving(domain, boundary, StateSet.of([around(ball(t0), ball(lasts)), reached])), t0 + lasts


def _followed(o: Oscillator, state: Moving, t_end: Ball, most: int) -> Iterator[tuple[ProvenEvent, Moving]]:
    """Yield up to `most` proven events before t_end, with the states after each."""
    for _ in range(most):
        following = next_event(o, state, t_end)
        if following is None:
            return
        yield following
        state = following[1]


def _arrival(closing: ClosingBalls, points: Values, event: ProvenEvent) -> int | None:
    """Return the number of the orbit's switching point, the end of a flight, that is near an event; None if none is."""
    for i, row in enumerate(switchings(closing, points, 0)[:-1]):
        turns = float((event.t - row[4]) / closing.turn)
        near = abs(turns - round(turns)) < NEAR_ARRIVAL and abs(float(event.x - row[5])) < NEAR_ARRIVAL
        if near and row[:4] == event[:4] and event.kind != "slip":
            return i
    return None


def _invariant_box(closing: ClosingBalls, points: Values, i: int, state: Moving) -> Cycle | None:
    """Find a box around the orbit's point i that contains the states and is mapped into itself; None if too large."""
    n, turns, once = len(closing.pieces), 1, unit_matrix(2)
    for j in range(i, i + n):  # the derivative of the map from point i to itself, approximately
        once = (closing.end_by_start(j % n, points) * once).mid()
    D = once
    while (shape := _shape(D)) is None:
        turns, D = turns + 1, D * once
        if turns > MOST_TURNS:
            raise Undecided("a norm in which the orbit attracts")
    t, x = state.states.hull()
    gone = round(float((t - points[2 * i]) / closing.turn))
    about = points[2 * i] + gone * closing.turn, points[2 * i + 1]
    middle = [Fraction(round(exact_ends(each)[0] * 10**60), 10**60) for each in about]
    off = [abs(value - ball(c)).upper() for value, c in zip((t, x), middle, strict=True)]
    size = max(LEAST_BOX, *(BOX_MARGIN * exact_ends(each / ball(w))[1] for each, w in zip(off, shape, strict=True)))
    widths = [Fraction(one_digit(ball(size * w))) for w in shape]
    if max(widths) > NEAR_ARRIVAL:
        return None
    box = StateSet.of([around(ball(c), ball(w)) for c, w in zip(middle, widths, strict=True)])
    late = box.hull()[0] + (turns + 1) * closing.turn
    steps = list(_followed(closing.oscillator, Moving(state.mode, state.boundary, box), late, n * turns))
    events, states = [event for event, _ in steps], [box, *(after.states for _, after in steps)]
    t, x = states[-1].hull()
    t = t - turns * closing.turn
    inside = all(ball(w) > abs(value - ball(c)) for value, c, w in zip((t, x), middle, widths, strict=True))
    wanted = switchings(closing, points, i)[1:] * turns
    same = [event[:4] for event in events] == [row[:4] for row in wanted]
    return Cycle(middle, widths, turns, events, states) if inside and same else None


def _shape(D: arb_mat) -> tuple[Fraction, Fraction] | None:
    """Return the sides of a box, the larger one 1, that the matrix D contracts by a factor below MOST_Q; or None."""
    sizes = [[abs(float(D[i, j])) for j in (0, 1)] for i in (0, 1)]
    e = [1.0, 1.0]
    for _ in range(60):  # towards the eigenvector of |D|
        e = [sum(a * b for a, b in zip(row, e, strict=True)) + 1e-3 * max(e) for row in sizes]
        e = [each / max(e) for each in e]
    q = max(sum(a * b for a, b in zip(row, e, strict=True)) / each for row, each in zip(sizes, e, strict=True))
    return (Fraction(f"{e[0]:.2g}"), Fraction(f"{e[1]:.2g}")) if q < MOST_Q else None


def _certificate(
    task: ToProve,
    closing: ClosingBalls,
    points: Values,
    i: int,
    before: Sequence[ProvenEvent],
    cycle: Cycle,
    about: Record,
) -> Certificate:
    """Return the certificate of the settled motion."""
    n, turn, t_end, widths = (
        len(cycle.events),
        cycle.turns * closing.turn,
        ball(task.t_end),
        list(map(ball, cycle.widths)),
    )
    box = [[show(c - w), show(c + w)] for c, w in zip(cycle.middle, cycle.widths, strict=True)]
    rows = [event_row(before[-1], DIGITS) | {"t": box[0], "x": box[1]}]
    for event in cycle.events:
        wide = event._replace(t=around(event.t, 2 * event.t.rad()), x=around(event.x, 2 * event.x.rad()))
        rows.append(event_row(wide, 60))
    times = [around(ball(cycle.middle[0]), widths[0]), *(event.t for event in cycle.events)]
    cycles = max(0, floor(float((t_end - times[0]) / turn)))
    left = sum(bool(each + cycles * turn < t_end) for each in times[:-1]) - 1
    if left < 0 or not times[left] + cycles * turn < t_end < times[left + 1] + cycles * turn:
        raise Undecided("how many events there are until t_end")
    reaches = [
        [sum((abs(d) * w for d, w in zip(row, widths, strict=True)), arb(0)) for row in states.slopes]
        for states in cycle.states
    ]
    sums = [reach / width for reach, width in zip(reaches[-1], widths, strict=True)]
    q = sums[0].union(sums[1]).upper()
    if not q < 1:
        raise Undecided("a norm in which the orbit attracts")
    total, last = cycles * n + left, []
    for number in range(max(1, total - n // cycle.turns + 1), total + 1):
        k, j = divmod(number, n)
        place, event = (i + j) % len(closing.pieces), before[-1] if j == 0 else cycle.events[j - 1]
        spare = [2 * reach * q**k for reach in reaches[j]]
        gone = ((times[j] - points[2 * place]) / closing.turn).unique_fmpz()
        if gone is None:
            raise Undecided("how many periods an event of the cycle is behind that of the orbit")
        t = around(points[2 * place] + int(gone) * closing.turn + k * turn, spare[0])
        last.append(event_row(event._replace(t=t, x=around(points[2 * place + 1], spare[1])), task.digits))
    statement = about | {
        "events": [event_row(event, DIGITS) for event in before],
        "periods": cycle.turns * closing.periods,
        "cycle": rows,
        "count": len(before) + total,
        "last": last,
    }
    return confirmed("settled", statement)
