"""Proposed enclosures of a motion: what the engine computes, with a radius, for the checker to prove.

Nothing in this module proves anything, so nothing in it can make a certificate wrong. `simulate`
with many digits says which events there are, and when and where; each becomes an enclosure of a
few units of its last digit or, for a start known to an error, of the error that the engine
estimates. The checker (`verify`, `verify_orbits`) uses nothing of the engine: it proves the file
by ball arithmetic, or refuses it. A refused file is proposed again with more digits, or wider.

A graze of a start with an error is the statement that one start touches. Its start lies between
two values of one number of the start, which the secant method finds: it makes the least gap 0.

A motion that settles on an orbit comes into a box about one of its switching points. The box has
the shape that the map over some periods contracts, by the Jacobian of the closing equations.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from decimal import Decimal, localcontext
from fractions import Fraction
from math import ceil, floor
from typing import Any, NamedTuple

from flint import arb, ctx

import symosc.certificates.verify as verify
from symosc.base.aliases import Number, Record
from symosc.base.exact import power_of_ten, show
from symosc.certificates.certificate import (
    CORNER,
    STARTS,
    Certificate,
    confirmed,
    made_by,
    oscillator_entry,
    provable,
    stated,
)
from symosc.certificates.corners import Step, steps_of
from symosc.derivatives.sensitivities import sensitivities
from symosc.engine.arithmetic import many_digits
from symosc.engine.events import Event
from symosc.engine.start import Start
from symosc.engine.state import Launch
from symosc.friction import MODE_NAMES, NEIGHBOURS
from symosc.kernels._generated import acceleration
from symosc.model import Model, Parameters
from symosc.orbits.closing_equations import ClosingEquations, polish
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.simulation.simulate import MOST_EXACT_EVENTS, simulate
from symosc.simulation.trajectory import Trajectory
from symosc.words import Word

#: Enclosures of events have this many digits, and more where events are closer to each other.
DIGITS = 25
DIGITS_BEYOND = 8
#: Digits in which the engine computes beyond those of an enclosure.
SPARE_DIGITS = 20
#: Digits that are asked for where fewer leave a contact open: the engine takes up to twelve times as
#: many for it.
MORE_DIGITS = 200
#: The secant method for a touch begins at the middle of the starts, and at this part of their error.
SECOND_VALUE = Fraction(1, 4)
#: A box of a cycle is tried after a refused one only if it is smaller by this factor.
MUCH_SMALLER = 1000
#: Each time the checker refuses an exact start's events, they are proposed with so many times the
#: digits.
FINER = (1, 2)
#: What the checker says where no digits of a proposal help.
NEAR_MISS = "a touch or a near miss"
#: Steps that the checker is given at first, for each event and one more.
QUICK_STEPS = 2000
#: Radii to propose for a start with an error, in units of the engine's estimate.
WIDER = (1.25, 2.5, 8.0, 64.0)
EXACT = (Fraction(0),) * 3
#: The radius of an exact start's event, in units of the engine's estimate.
EXACT_ROW = 100.0
#: What can be proven instead of a graze.
TOUCHES = " (with start_error the statement that a start so near touches can be proven)"
#: Which start value is varied for a graze: the first one of these that has an error.
FREE = (("x0", 1), ("v0", 2), ("t0", 0))
MOST_SECANTS = 14
MOST_NEWTON = 60
#: Digits of the numbers with which a motion is followed that settles.
SETTLED_DIGITS = 90
#: Decimal places of the box.
BOX_PLACES = 60
#: Bits with which the checker is asked how wide its sets are.
CHECKED_BITS = (256, 512, 1024, 2048)
#: How many events a motion may take to come near the orbit, tried one after another; how near that
#: is (of t, and of x).
MOST_EVENTS_BEFORE = (50, 400, 2000)
NEAR_ARRIVAL = 1e-6
#: How many times larger the box is than what comes into it; its least size; the largest factor by
#: which it may be contracted; the most turns that this may take; how many boxes are proposed.
BOX_MARGIN = 8
LEAST_BOX = Fraction(1, 10**22)
MOST_Q = 0.9
MOST_TURNS = 8
#: Steps of a power iteration, and what is added to a side in each of them (as a share of the larger).
POWER_STEPS = 60
LEAST_SHARE = 1e-3
MOST_CYCLES = 3
MODE_NUMBERS = {name: mode for mode, name in MODE_NAMES.items()}

Interval = tuple[Fraction, Fraction]


class NothingProposed(Exception):
    """Raised if not all can be proposed: `what` is undecided, after the events of a `statement`."""

    def __init__(self, what: str, statement: Record | None = None) -> None:
        self.what = what
        self.statement = statement
        super().__init__(what)


class ToProve(NamedTuple):
    """The motion to prove: parameters, start (t0, x0, v0), errors, t_end, digits, and names for
    derivatives (`wrt`).
    """

    p: Model
    start: tuple[Fraction, Fraction, Fraction]
    errors: tuple[Fraction, Fraction, Fraction]
    t_end: Fraction
    digits: int = DIGITS
    wrt: tuple[str, ...] = ()

    @property
    def exact(self) -> bool:
        """Whether the start is known exactly."""
        return not any(self.errors)

    @property
    def may_touch(self) -> bool:
        """Whether a file may state that one of the starts within an error touches a belt."""
        return isinstance(self.p, Parameters)

    @property
    def error_digits(self) -> int:
        """The digits that tell the smallest error of the start from 0."""
        return max((power_of_ten(1 / error) for error in self.errors if error), default=0)

    def run(self, digits: int, most: int | None = None, **changes: Any) -> Trajectory:
        """Return the motion as the engine follows it with `digits`, up to `most` events.

        `changes` replaces numbers of the start, t_end and start_error.
        """
        about: dict[str, Any] = dict(zip(STARTS, self.start, strict=True))
        about["t_end"] = self.t_end
        if not self.exact:
            about["start_error"] = list(self.errors)
        return simulate(self.p, digits=digits, max_events=most, **(about | changes))

    def steps(self, run: Trajectory) -> Sequence[Step]:
        """Return the events of a motion from this start, and the corners that it passes."""
        return steps_of(run, Start(self.p, *self.start, self.t_end))


# -- decimals --------------------------------------------------------------------------------------


def fraction(number: Any) -> Fraction:
    """Return a number of mpmath, or a float, exactly as a fraction."""
    if isinstance(number, float | int | Fraction):
        return Fraction(number)
    sign = 1 if number >= 0 else -1  # the mantissa has none
    return Fraction(int(number.man)) * Fraction(2) ** int(number.exp) * sign


def around(number: Any, radius: Any) -> Interval:
    """Return both ends of the interval of a radius about a number."""
    middle = fraction(number)
    reach = abs(fraction(radius))
    return middle - reach, middle + reach


def outward(ends: Interval, digits: int) -> list[str]:
    """Return both ends of an interval as decimals of so many digits.

    The lower end is rounded down and the upper end up, by one unit of the last digit more than
    necessary.
    """
    # The checker can then prove what is as wide as rounding alone.
    low, high = ends
    scale = max(abs(low), abs(high), Fraction(1))
    unit = Fraction(10) ** (len(str(int(scale))) - digits)
    return [show_decimal(floor(low / unit - 1) * unit), show_decimal(ceil(high / unit + 1) * unit)]


def show_decimal(exact: Fraction) -> str:
    """Return a fraction that is a finite decimal as text, with all of its digits."""
    with localcontext(prec=len(str(abs(exact.numerator))) + len(str(exact.denominator)) + 5):
        return format(Decimal(exact.numerator) / Decimal(exact.denominator), "f")


def one_digit(most: Any) -> str:
    """Round a positive number down to a decimal with one digit, such as 3e-12."""
    number = fraction(most)
    power = power_of_ten(number)
    while number < Fraction(10) ** power:
        power -= 1
    while number >= Fraction(10) ** (power + 1):
        power += 1
    return f"{number // Fraction(10) ** power}e{power}"


def known(ends: Interval, digits: int) -> list[str]:
    """Return an interval as decimals, with two digits more than it knows, but at most `digits`."""
    low, high = ends
    if low != high:
        scale = max(abs(low), abs(high), Fraction(1))
        digits = min(digits, max(3, 3 + power_of_ten(scale / (high - low))))
    return outward(ends, digits)


# -- motions ---------------------------------------------------------------------------------------


def certify_motion(task: ToProve) -> Certificate:
    """Propose all events of a motion until t_end, and let the checker prove them.

    Return the certificate; if not all is proven, with the events that are.
    """
    statement = first_entries(task, task.digits)
    message = ""
    try:
        for statement in _statements(task):
            certificate = _checked(statement)
            if certificate.proven:
                return certificate
            message = certificate.message
            if NEAR_MISS in message:
                break
    except NothingProposed as undecided:
        message = undecided.what
        statement = undecided.statement or statement
    rows = []
    if "events" in statement:
        sets, _ = enclosed(statement, CHECKED_BITS[:2])
        rows = statement["events"][: len(sets)]
    kept = {
        key: value
        for key, value in statement.items()
        if key not in ("wrt", "derivatives", "free", "starts")
    }
    kept |= {"starts": "all", "events": rows}
    since = Fraction(rows[-1]["t"][0]) if rows else task.start[0]
    events = sum(row["kind"] != CORNER for row in rows)
    count = f"after {events} event{'' if events == 1 else 's'}"
    text = f"{message}, {count}, from t = {float(since):.15g} on"
    return stated("trajectory", False, text, kept)


def _checked(statement: Record) -> Certificate:
    """Return the certificate of a proposed motion with the checker's verdict."""
    # At a touch the checker takes steps without end, with ever more bits. So it is first given the
    # few steps that most motions take, and then asked whether it stops at a touch.
    steps = min(verify.LIMITS["steps"], QUICK_STEPS * (1 + len(statement["events"])))
    certificate = confirmed("trajectory", statement, steps=steps)
    if certificate.proven or "(--steps)" not in certificate.message:
        return certificate
    _, reason = enclosed(statement)
    if reason == NEAR_MISS and statement["starts"] == "all":
        message = f"not confirmed by the checker: not proven: {reason}"
        return stated("trajectory", False, message, statement)
    return confirmed("trajectory", statement)


def _statements(task: ToProve) -> Iterator[Record]:
    """Yield the contents of one file after another, each with finer or wider enclosures."""
    if task.exact:
        for finer in FINER:
            yield _exact_statement(task, finer)
        return
    working = task.digits + SPARE_DIGITS + task.error_digits
    run = task.run(working)
    touch = None
    if task.may_touch:
        touch = _possible_touch(task, run, working)
    elif run.status == "undecidable" or any(event.kind == "graze" for event in run.events):
        raise open_after(task, run, f"{NEAR_MISS} near t = {float(run.t_end):.15g}", working)
    if touch is not None:
        with suppress(NothingProposed):
            yield from _touching(task, touch, run)
        # What the engine takes for a touch may be none: its estimates are of first order.
        run = _followed(task._replace(errors=EXACT), working)
    if run.status == "max_events":
        raise NothingProposed(f"what comes after {MOST_EXACT_EVENTS} events is not decided")
    # The checker's sets are wider than the estimates, and it says how wide they are.
    rows = [row_of(step, WIDER[0], task.digits) for step in task.steps(run)]
    statement = about(task, run, rows)
    sets, reason = enclosed(statement)
    rows = statement["events"][: len(sets)]
    if reason:
        known_rows = statement | {"events": rows}
        raise NothingProposed(f"not confirmed by the checker: not proven: {reason}", known_rows)
    for wider in WIDER:
        wide_rows = []
        for row, ends in zip(rows, sets, strict=True):
            wide_row = dict(row)
            for name, (low, high) in zip("tx", ends, strict=True):
                wide = around((low + high) / 2, (high - low) / 2 * Fraction(wider))
                wide_row[name] = known(wide, task.digits)
            wide_rows.append(wide_row)
        yield statement | {"events": wide_rows}


def _possible_touch(task: ToProve, run: Trajectory, digits: int) -> Touch | None:
    """Return the first contact of a motion that may be a touch, or None."""
    name, place = next((name, place) for name, place in FREE if task.errors[place])
    for before, event in enumerate(run.events):
        if event.kind == "graze":
            mode = MODE_NUMBERS[event.source]
            return Touch(name, place, before, fraction(event.t), event.boundary, mode)
    if run.status != "undecidable":
        return None
    # The engine stops at a near miss, and does not say of which belt.
    mode = MODE_NUMBERS[run.segments[-1].mode]
    t = fraction(run.t_end)
    belts_beside = [belt for belt in NEIGHBOURS if mode in NEIGHBOURS[belt]]
    touches = [Touch(name, place, len(run.events), t, belt, mode) for belt in belts_beside]
    if not touches:
        return None
    unvaried = task.start[place]

    def size_of_gap(touch: Touch) -> Fraction:
        gap, _ = _least_gap(task, touch, unvaried, t, digits)
        return abs(gap)

    return min(touches, key=size_of_gap)


def enclosed(
    statement: Record, precisions: Sequence[int] = CHECKED_BITS
) -> tuple[list[tuple[Interval, Interval]], str]:
    """Return how the checker encloses t and x of each event of a file, and why it stops: "" if it
    follows the motion up to t_end.

    `precisions` are the bits to try.
    """
    # Nothing rests on it: the file is proven as a whole.
    source = {key: value for key, value in statement.items() if key in verify.MOTION}
    try:
        shape = verify.shape_of("trajectory", source)
        data = verify.read(source, {key: shape[key] for key in verify.MOTION}, "trajectory")
    except verify.Stop as stop:  # numbers beyond the limits of the format
        return [], stop.args[1]
    start = [data["start"][name] for name in STARTS]
    sets: list[tuple[Interval, Interval]] = []
    reason = ""
    for bits in precisions:
        sets = []
        limits = verify.LIMITS | {"left": verify.LIMITS["steps"]}
        with verify.LOCK, ctx.workprec(bits):
            try:
                problem = verify.StatedOscillator(data["parameters"], limits)
                motion = verify.begin(problem, start, data["start_error"], [])
                for row in data["events"]:
                    motion = motion.after_event(row)
                    sets.append((ends_of(motion.t), ends_of(motion.x)))
                motion.positive(arb(data["t_end"]).upper())
            except verify.Stop as stop:
                code, reason = stop.args
                if code == verify.OPEN:  # more bits may decide it
                    continue
                return sets, reason
            return sets, ""
    return sets, reason


def ends_of(ball: Any) -> Interval:
    """Return both ends of a ball as exact fractions."""
    middle, radius = (
        Fraction(int(exact.p), int(exact.q)) for exact in (ball.mid().fmpq(), ball.rad().fmpq())
    )
    return middle - radius, middle + radius


def _followed(task: ToProve, digits: int, most: int | None = None, **changes: Any) -> Trajectory:
    """Return the motion with enough digits for enclosures of `digits`, or raise NothingProposed."""
    working = digits + SPARE_DIGITS + task.error_digits
    run = task.run(working, most, **changes)
    if run.status == "undecidable" and task.exact and working < MORE_DIGITS:
        working = MORE_DIGITS
        run = task.run(working, most, **changes)
    if run.status == "undecidable":
        near = f"{float(run.t_end):.15g}"
        remark = TOUCHES if task.exact and task.may_touch else ""
        raise open_after(task, run, f"{NEAR_MISS} near t = {near}", working, remark)
    if run.status == "max_events" and most is None:
        raise NothingProposed(f"what comes after {MOST_EXACT_EVENTS} events is not decided")
    return run


def open_after(
    task: ToProve, run: Trajectory, what: str, digits: int, remark: str = ""
) -> NothingProposed:
    """Return the exception that says what so many digits do not decide, with the events of `run`."""
    rows = [row_of(step, EXACT_ROW, task.digits) for step in task.steps(run)]
    return NothingProposed(
        f"{what} is not decided with {digits} digits{remark}", about(task, run, rows)
    )


def _exact_statement(task: ToProve, finer: int) -> Record:
    """Return the events of an exact start; `finer` is how many times the digits are proposed."""
    least = finer * task.digits
    digits = least
    while True:  # until the run is finer than the rows that are read off it
        run = _followed(task, digits)
        steps = task.steps(run)
        row_digits = _row_digits(task, run, steps, least)
        if max(row_digits, default=0) <= digits + SPARE_DIGITS // 2:
            break
        digits = max(row_digits)
    # A double zero, which enclosures cannot tell from a near miss. Without damping and drive v and
    # v' go round a circle, which is decided in rational numbers.
    circles = task.p.B0 == 0 < task.p.k and 0 in dampings(task.p)
    graze = next((event for event in run.events if event.kind == "graze"), None)
    if graze is not None and not circles:
        what = f"{NEAR_MISS} near t = {float(graze.t):.15g}"
        remark = TOUCHES if task.may_touch else ""
        raise open_after(task, run, what, run.digits or digits, remark)
    events = [
        row_of(step, EXACT_ROW, digits_of_row)
        for step, digits_of_row in zip(steps, row_digits, strict=True)
    ]
    statement = about(task, run, events)
    if task.wrt:
        statement |= _derivatives(task, run)
    return statement


def dampings(p: Model) -> set[Fraction]:
    """Return the damping in each domain or, if friction depends on the speed, in each band."""
    return {p.law.damping(p.c, row) for row in range(len(p.law.rows))}


def _row_digits(task: ToProve, run: Trajectory, steps: Sequence[Step], least: int) -> list[int]:
    """Return how many digits each step needs so that its time is told from that before it."""
    digits_of_events = []
    before = task.start[0]
    for step in steps:
        t = fraction(step.t)
        digits = 2 * least + (run.digits or 0)  # more than the run has, as they do not do
        if t > before:
            scale = max(Fraction(1), abs(t))
            digits = DIGITS_BEYOND + power_of_ten(scale / (t - before))
        digits_of_events.append(max(least, digits))
        before = t
    return digits_of_events


def row_of(step: Step, wider: float, digits: int) -> Record:
    """Return an event as a row of the file: t and x within so many times their estimated errors."""
    row: Record = {name: getattr(step, name) for name in ("kind", "boundary", "source", "target")}
    for name in ("t", "x"):
        error = getattr(step, f"{name}_error")
        row[name] = known(around(getattr(step, name), wider * error), digits)
    return row


def about(task: ToProve, run: Trajectory, rows: list[Record]) -> Record:
    """Return the contents of a motion's file, with the events in `rows`."""
    mode = run.segments[0].mode
    return first_entries(task, run.digits or 0) | {"starts": "all", "mode": mode, "events": rows}


def first_entries(task: ToProve, digits: int) -> Record:
    """Return the first entries of a motion's file: the program, and parameters and start as
    rational numbers.
    """
    return made_by(digits) | {
        "parameters": oscillator_entry(task.p),
        "start": {name: show(value) for name, value in zip(STARTS, task.start, strict=True)},
        "start_error": [show(error) for error in task.errors],
        "t_end": show(task.t_end),
    }


# -- derivatives -----------------------------------------------------------------------------------


def _derivatives(task: ToProve, run: Trajectory) -> Record:
    """Return the derivatives of all events by `task.wrt` as entries of the file, or raise NothingProposed."""
    count = len(run.events)
    p = task.p.parameters
    _, _, v0 = task.start
    for name in task.wrt:
        if name not in provable(p, v0):
            is_on_belt = v0 in (p.v1, p.v2) and name.startswith("v")
            where = "at resonance or where it is 0"
            if is_on_belt:
                where = "of a start on a belt"
            raise open_after(task, run, f"a derivative by {name} {where}", task.digits)
    if any(event.kind == "graze" for event in run.events):
        raise open_after(task, run, "a derivative behind a graze", task.digits)
    start: dict[str, Any] = dict(zip(STARTS, task.start, strict=True))
    changes = sensitivities(
        task.p, task.wrt, **start, t_end=task.t_end, digits=task.digits + SPARE_DIGITS
    )
    rows = []
    for event in range(count):
        columns = {"dt": changes.dt[event], "dx": changes.dx[event]}
        rows.append(
            {
                name: [outward(around(value, 0), task.digits) for value in values]
                for name, values in columns.items()
            }
        )
    return {"wrt": list(task.wrt), "derivatives": rows}


# -- a graze of some start -------------------------------------------------------------------------


class Touch(NamedTuple):
    """A start value `name` that is varied until a flight in a mode just touches a belt near t.

    `place` is its index in the start, `before` the number of events before the flight.
    """

    name: str
    place: int
    before: int
    t: Fraction
    boundary: int
    mode: int


def _touching(task: ToProve, touch: Touch, run: Trajectory) -> Iterator[Record]:
    """Yield files that state a graze of one start within the error, and all events of it."""
    name = touch.name
    place = touch.place
    value, digits = _touching_value(task, touch)
    middle = task.start[place]
    error = task.errors[place]
    # Where a start is off by e, contacts near the touch are off by about the root of e in time.
    places = 2 * (task.digits + 2) + task.error_digits // 2
    unit = Fraction(1, 10**places)
    low, high = (Fraction(floor(value / unit) + step) * unit for step in (-1, 2))
    if max(abs(low - middle), abs(high - middle)) > error:
        near = f"near t = {float(touch.t):.15g}"
        what = f"a touch that is further off than the error of the start, {near},"
        raise open_after(task, run, what, digits)
    errors = [Fraction(0)] * 3
    errors[place] = (high - low) / 2
    changes: dict[str, Any] = {name: (low + high) / 2, "start_error": errors}
    run_at_middle = task.run(digits, **changes)
    free = {"name": name, "low": show_decimal(low), "high": show_decimal(high)}
    for wider in WIDER[::2]:
        rows = [row_of(event, wider, task.digits) for event in run_at_middle.events]
        yield about(task, run_at_middle, rows) | {"starts": "some", "free": free}


def _touching_value(task: ToProve, touch: Touch) -> tuple[Fraction, int]:
    """Return the start value with which a flight touches, by the secant method, and the digits in
    which it is computed.
    """
    # The least gap is 0 to so many digits as the start value is needed to; twice as many are used.
    digits = 2 * (2 * task.digits + SPARE_DIGITS) + task.error_digits
    middle = task.start[touch.place]
    reach = task.errors[touch.place]
    near = touch.t
    points = list[tuple[Fraction, Fraction]]()
    for count in range(2 + MOST_SECANTS):
        if count < 2:
            value = middle + reach * count * SECOND_VALUE
        else:
            (value_before, gap_before), (last_value, last_gap) = points[-2:]
            if gap_before == last_gap:
                break
            step = last_gap * (last_value - value_before) / (last_gap - gap_before)
            value = fraction(many_digits(task.p, digits).number(last_value - step))
            if abs(value - middle) > reach:
                break
        gap, near = _least_gap(task, touch, value, near, digits)
        points.append((value, gap))
    last_value, _ = points[-1]
    return last_value, digits


def _least_gap(
    task: ToProve, touch: Touch, value: Fraction, near: Fraction, digits: int
) -> tuple[Fraction, Fraction]:
    """Return the least gap to a belt that a flight has, and when, near a time `near`.

    The flight begins after the events before the touch, if the start has another `value`. The gap
    may be negative: the belt does not end this flight.
    """
    arithmetic = many_digits(task.p, digits)
    number = arithmetic.number
    context = arithmetic.context
    K = arithmetic.K
    start = list(task.start)
    start[touch.place] = value
    t, x, v = map(number, start)
    if touch.before:
        changes: dict[str, Any] = {touch.name: value, "start_error": 0}
        event = task.run(digits, touch.before, **changes).events[touch.before - 1]
        t, x, v = map(context.convert, (event.t, event.x, event.v))
    theta = K.Om * t
    A = (K.A1, K.A2, K.A3)[touch.mode - 1]
    cosine = context.cos(theta)
    force = acceleration(x, v, cosine, A, K.cm, K.w0sq, K.f0)
    launch = Launch(v, force, context.sin(theta), cosine)
    tau = number(near) - t
    state_at = arithmetic.namespace["state_at"]
    # The gap is least where the acceleration F is 0: Newton's method with its derivative G1.
    for _ in range(MOST_NEWTON):
        state = state_at(tau, launch, K)
        step = state.F / state.G1
        if abs(step) <= 16 * context.eps * abs(tau):  # rounding
            break
        tau = tau - step
    state = state_at(tau, launch, K)
    gap = v + state.dv - number(task.p.belt(touch.boundary))
    return fraction(gap), fraction(t + tau)


# -- motions that settle ---------------------------------------------------------------------------


class Switching(NamedTuple):
    """An event of an orbit: the first entries of its row in a file, and t and x in many digits."""

    row: Record
    t: Number
    x: Number


class OrbitInDigits:
    """An orbit as the engine knows it in many digits: its points, its period, and the derivatives
    of each piece's end by its start.
    """

    def __init__(
        self,
        p: Parameters,
        labels: Sequence[str],
        periods: int,
        points: Sequence[tuple[Number, Number]],
        digits: int,
    ) -> None:
        self.equations = ClosingEquations(p, Word(tuple(labels)), periods, digits)
        context = self.equations.context
        Omega = self.equations.K.Om
        guess = [(context.convert(x), context.convert(t) * Omega) for t, x in points]
        solution = polish(self.equations, guess)
        if not solution.converged:
            raise NothingProposed(
                f"a root of the closing equations is not found: {solution.reason}"
            )
        self.solution = solution.points
        self.context = context
        self.pieces = self.equations.pieces
        self.turn = self.equations.turn / Omega
        #: t and x at each switching point.
        self.points = [(theta / Omega, x) for x, theta in solution.points]

    def switchings(self, begin: int) -> list[Switching]:
        """Return the events of one period from event `begin` on; the last one is event `begin`
        again, a period later.
        """
        switchings = []
        n = len(self.pieces)
        for j in range(begin, begin + n + 1):
            before = self.pieces[j % n - 1]
            piece = self.pieces[j % n]
            kind = "cross"
            if before.sticks:
                kind = "slip"
            elif piece.sticks:
                kind = "stick"
            row = {
                "kind": kind,
                "boundary": piece.start,
                "source": MODE_NAMES[before.mode],
                "target": MODE_NAMES[piece.mode],
            }
            t, x = self.points[j % n]
            switchings.append(Switching(row, t + self.turn * (j // n), x))
        return switchings

    def slopes(self) -> list[Any]:
        """Return for each piece the 2 x 2 matrix of the derivatives of t and x at its end by t and
        x at its start.
        """
        J = self.equations.matrix(self.solution)
        Omega = self.equations.K.Om
        context = self.context
        size = 2 * len(self.pieces)
        slopes = []

        def block(i: int, k: int) -> list[list[Number]]:
            """Return the derivatives of equations i and i + 1 by theta and x of the point whose x
            is unknown k (theta is the next).
            """
            return [[J[row, (k + 1) % size], J[row, k % size]] for row in (i, i + 1)]

        for i in range(0, size, 2):
            begin = block(i, i)  # of a piece, by the point where it starts
            end = block(i, i + 2)  # by the point where it ends
            # By the implicit function theorem the slope is -end^-1 begin.
            (a, b), (c, d) = end
            minus_inverse = context.matrix([[d, -b], [-c, a]]) / (b * c - a * d)
            slope = minus_inverse * context.matrix(begin)  # of theta and x
            slope[0, 1] = slope[0, 1] / Omega
            slope[1, 0] = slope[1, 0] * Omega
            slopes.append(slope)
        return slopes


class Cycle(NamedTuple):
    """A box of t and x at an arrival on a belt (the orbit's point `place`), into which all motions
    from it come back after `turns` periods.

    `reaches` says how far motions of the box are apart at each event, in t and in x; `q` is the
    factor by which the box is contracted.
    """

    place: int
    middle: Sequence[Fraction]
    widths: Sequence[Fraction]
    turns: int
    reaches: Sequence[Sequence[Fraction]]
    q: float


def certify_settled(task: ToProve, orbit: PeriodicOrbit) -> Certificate:
    """Propose that a motion settles on an orbit, by a cycle of events, and let the checker prove
    it.

    Return the certificate.
    """
    message = "no event comes near the orbit on which the motion is to settle"
    try:
        for statement in _settled_statements(task, orbit):
            certificate = confirmed("settled", statement)
            if certificate.proven:
                return certificate
            message = certificate.message
    except NothingProposed as undecided:
        message = undecided.what
    return Certificate("settled", False, message)


def _settled_statements(task: ToProve, orbit: PeriodicOrbit) -> Iterator[Record]:
    """Yield files that state the events of a motion up to its arrival in a box, and a cycle."""
    known_orbit = OrbitInDigits(
        task.p.parameters, orbit.labels, orbit.periods, orbit.points, SETTLED_DIGITS
    )
    turn = fraction(known_orbit.turn)
    left = leaving(task)
    begun = task
    head = first_entries(task, SETTLED_DIGITS) | {"may_stick_until": None}
    if left is not None:
        begun = task._replace(errors=left.errors)
        head["may_stick_until"] = show_decimal(left.until)
    seen = 0
    sizes = list[Fraction]()
    for most in MOST_EVENTS_BEFORE:
        run = begun.run(SETTLED_DIGITS, most)
        head["mode"] = run.segments[0].mode
        rows = [row_of(event, WIDER[1], DIGITS) for event in run.events]
        for count, event in enumerate(run.events[seen:], seen + 1):
            place = _arrival(known_orbit, event)
            cycle = None if place is None else _cycle(known_orbit, place, event)
            if cycle is None:
                continue
            # After a refused box only a much smaller one is tried: its events may keep their order.
            width_t, _ = cycle.widths
            if sizes and width_t * MUCH_SMALLER > sizes[-1]:
                continue
            sizes.append(width_t)
            entries = _cycle_entries(task, known_orbit, cycle, rows[count - 1], turn)
            entries["count"] += count
            yield head | {"events": rows[:count]} | entries
            if len(sizes) == MOST_CYCLES:
                return
        seen = len(run.events)


class LeavingStarts(NamedTuple):
    """By when all starts on a belt have left it, and the errors of the start of their flights."""

    until: Fraction
    errors: tuple[Fraction, Fraction, Fraction]


def leaving(task: ToProve) -> LeavingStarts | None:
    """Return when the starts on a belt have left it; None if the start is not on a belt, or the
    forces there are not 0 within its error.
    """
    p = task.p.parameters
    t0, x0, v0 = task.start
    error_t, error_x, error_v = task.errors
    if v0 not in (p.v1, p.v2) or error_v or task.exact:
        return None
    boundary = 1 if v0 == p.v1 else 2
    arithmetic = many_digits(p, SETTLED_DIGITS)
    number = arithmetic.number
    theta = number(p.Omega * t0)
    cosine = fraction(arithmetic.context.cos(theta))
    sine = fraction(arithmetic.context.sin(theta))
    below, above = (
        (p.A(domain) + p.B0 * cosine - p.k * x0 - p.c * v0) / p.m
        for domain in (boundary, boundary + 1)
    )
    # Both forces change alike with time, by `slope`, which changes by swing Omega at most.
    slope = -(p.k * v0 + p.B0 * p.Omega * sine) / p.m
    swing = abs(p.B0) * p.Omega / p.m
    ending = below if slope < 0 else above  # the force whose change of sign ends the stick
    reach = p.k / p.m * error_x + swing * error_t
    steepness = abs(slope) - swing * p.Omega * error_t
    if abs(ending) > reach or steepness <= 0:
        return None
    # Twice the time that the force takes to 0 at that slope, as the slope changes meanwhile.
    lasts = error_t + 2 * (abs(ending) + reach) / steepness
    lasts = Fraction(floor(lasts * 10**BOX_PLACES) + 2, 10**BOX_PLACES)  # rounded up
    error_x_then = error_x + abs(v0) * (lasts + error_t)  # the belt carries the mass on
    return LeavingStarts(t0 + lasts, (lasts, error_x_then, Fraction(0)))


def _arrival(orbit: OrbitInDigits, event: Event) -> int | None:
    """Return the index of the orbit's switching point, after a flight, that is near an event."""
    for i, switching in enumerate(orbit.switchings(0)[:-1]):
        turns = float((event.t - switching.t) / orbit.turn)
        is_near_in_t = abs(turns - round(turns)) < NEAR_ARRIVAL
        is_near = is_near_in_t and abs(float(event.x - switching.x)) < NEAR_ARRIVAL
        is_same = all(getattr(event, name) == value for name, value in switching.row.items())
        if is_near and is_same and event.kind != "slip":
            return i
    return None


def _cycle(orbit: OrbitInDigits, place: int, event: Event) -> Cycle | None:
    """Return a box about the orbit's point `place` that has an event in it and contracts, or None
    if it is too large.
    """
    slopes = orbit.slopes()
    turns, shape = _contraction(orbit, slopes, place)
    t, x = orbit.points[place]
    before = round(float((event.t - t) / orbit.turn))  # periods before the event
    places = 10**BOX_PLACES
    middle = tuple(
        Fraction(round(fraction(value) * places), places) for value in (t + before * orbit.turn, x)
    )
    # The box has the shape, and has the event well inside.
    errors = event.t_error, event.x_error
    distances = [
        abs(fraction(value) - c) + 2 * Fraction(error)
        for value, c, error in zip((event.t, event.x), middle, errors, strict=True)
    ]
    # Of one shape, as large as either side needs it.
    scales = (BOX_MARGIN * off / side for off, side in zip(distances, shape, strict=True))
    scale = max(LEAST_BOX, *scales)
    widths = tuple(Fraction(one_digit(scale * side)) for side in shape)
    if max(widths) > NEAR_ARRIVAL:
        return None
    # How far motions of the box are apart at each event, by the derivatives D from the first one.
    n = len(orbit.pieces)
    reaches = []
    D = orbit.context.eye(2)
    width_t, width_x = (orbit.context.mpf(w.numerator) / w.denominator for w in widths)
    for j in range(place, place + turns * n + 1):
        reach_t = abs(D[0, 0]) * width_t + abs(D[0, 1]) * width_x
        reach_x = abs(D[1, 0]) * width_t + abs(D[1, 1]) * width_x
        reaches.append((fraction(reach_t), fraction(reach_x)))
        D = slopes[j % n] * D
    q = max(float(reach / width) for reach, width in zip(reaches[-1], widths, strict=True))
    return Cycle(place, middle, widths, turns, reaches, q)


def _contraction(
    orbit: OrbitInDigits, slopes: Sequence[Any], place: int
) -> tuple[int, tuple[Fraction, Fraction]]:
    """Return after how many periods a box of t and x about the orbit's point `place` is contracted,
    and the sides of this box (the larger is 1).
    """
    n = len(orbit.pieces)
    one_period = orbit.context.eye(2)
    for j in range(place, place + n):
        one_period = slopes[j % n] * one_period
    all_periods = one_period
    for turns in range(1, MOST_TURNS + 1):
        shape = _contracted_box(all_periods)
        if shape is not None:
            return turns, shape
        all_periods = one_period * all_periods
    raise NothingProposed("a norm in which the orbit attracts is not found")


def _contracted_box(D: Any) -> tuple[Fraction, Fraction] | None:
    """Return sides (the larger is 1) of a box about 0 that the matrix D maps into a smaller copy of
    it, or None.
    """
    sizes = [[abs(float(D[i, j])) for j in (0, 1)] for i in (0, 1)]

    def image_of(sides: list[float]) -> list[float]:
        """Return the sides of the smallest box that contains the image of a box."""
        return [sum(a * b for a, b in zip(row, sides, strict=True)) for row in sizes]

    # By power iteration towards the eigenvector of |D|, the shape that is contracted most; a little
    # is added so that no side becomes 0.
    sides = [1.0, 1.0]
    for _ in range(POWER_STEPS):
        sides = [image + LEAST_SHARE * max(sides) for image in image_of(sides)]
        sides = [side / max(sides) for side in sides]
    if max(image / side for image, side in zip(image_of(sides), sides, strict=True)) < MOST_Q:
        side_t, side_x = sides
        return Fraction(f"{side_t:.2g}"), Fraction(f"{side_x:.2g}")
    return None


def _cycle_entries(
    task: ToProve, orbit: OrbitInDigits, cycle: Cycle, arrival: Record, turn: Fraction
) -> Record:
    """Return the entries of the file about a cycle that begins with the `arrival`, and about the
    last events.
    """
    n = len(orbit.pieces)
    length = n * cycle.turns
    # What happens at each event of a period, and t and x of it.
    heads = [switching.row for switching in orbit.switchings(cycle.place)[:-1]]
    points = [
        (fraction(t), fraction(x))
        for t, x in (orbit.points[(cycle.place + j) % n] for j in range(n))
    ]
    positions = [x for _, x in points]
    middle_t, _ = cycle.middle
    first_t, _ = points[0]
    before = round((middle_t - first_t) / turn)  # periods before the cycle
    times = []  # t of each event of the cycle, for the orbit
    for j in range(length + 1):
        t, _ = points[j % n]
        times.append(t + (before + (cycle.place + j) // n) * turn)
    box_t, box_x = (
        [show_decimal(c - width), show_decimal(c + width)]
        for c, width in zip(cycle.middle, cycle.widths, strict=True)
    )
    rows = [arrival | {"t": box_t, "x": box_x}]
    for j in range(1, length + 1):
        row = dict(heads[j % n])
        values = times[j], positions[j % n]
        for name, value, reach in zip("tx", values, cycle.reaches[j], strict=True):
            row[name] = outward((value - 2 * reach, value + 2 * reach), BOX_PLACES)
        rows.append(row)
    # The events until t_end: those of whole cycles, and of the last cycle those that are left (the
    # arrival is not counted).
    span = cycle.turns * turn
    cycles = max(0, floor((task.t_end - times[0]) / span))
    left = sum(t + cycles * span < task.t_end for t in times[:-1]) - 1
    total = cycles * length + left
    last = []
    for number in range(max(1, total - n + 1), total + 1):
        k, j = divmod(number, length)
        values = times[j] + k * span, positions[j % n]
        row = dict(heads[j % n])
        for name, value, reach in zip("tx", values, cycle.reaches[j], strict=True):
            spare = 2 * reach * Fraction(cycle.q**k)  # k cycles contract it by q each
            row[name] = known((value - spare, value + spare), task.digits)
        last.append(row)
    return {
        "periods": cycle.turns * orbit.equations.periods,
        "cycle": rows,
        "last": last,
        "count": total,
    }
