"""One motion: in doubles as a batch of one, with many digits event by event, and the digits that decide a contact.

In doubles `MotionInDoubles` calls the loop of `simulate_many`, compiled where this process has loaded it or the motion
is long, else run by CPython, with the same bits. With many digits (`Motion`) doubles search first, and only the last
step to an event takes the digits (`symosc.engine.next_event`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import compress
from math import ceil, log
from operator import itemgetter
from typing import Any

import numpy as np

from symosc.aliases import Number
from symosc.engine.arithmetic import (
    ROUNDED_FROM,
    Arithmetic,
    MpArithmetic,
    compiled_pairs,
    is_compiled,
    many_digits,
    mp_context,
    pair_constants,
    pairs_as_complex,
)
from symosc.engine.batch import (
    NEGLIGIBLE,
    PIECE_COLUMNS,
    EventRows,
    PairLimits,
    batch_of,
    event_buffer,
    next_undecided,
    rounding_error,
    row_of,
    rows_between,
    state_of,
    write_piece,
)
from symosc.engine.constant_table import table_of
from symosc.engine.events import (
    CODE_COLUMNS,
    CODE_NAMES,
    EVENT_COLUMNS,
    EXACT_COLUMNS,
    FLOAT_COLUMNS,
    Event,
    event_codes,
)
from symosc.engine.flow import Constants, clock_time, constants
from symosc.engine.next_event import advance
from symosc.engine.start import MOST_PERIODS, Start, first_state, is_steady, last_time, rounded, settles
from symosc.engine.state import END, FAILED, GRAZE, ON_BELT, REST, RUNNING, UNDECIDED, NextEvent, State
from symosc.engine.summary import no_tally
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.simulation.batch import FOLLOW, TURN, chosen_loops, joined, loaded_loop
from symosc.simulation.tables import rows_of

# Events of the first block of a motion and of the largest one.
FIRST_BLOCK, LARGEST_BLOCK = 64, 1 << 15
# Digits between a start and a belt, or of its error, that pairs have to spare.
PAIR_SPARE = 8
# Events that a motion is followed farther in pairs, at most, if doubles would not decide again.
MOST_MORE = 64
# Error estimates are standard errors; digits that are promised must hold.
SAFETY = 100
# The working precision where doubles do not decide, or are not accurate enough.
FINER_DIGITS = 36
# A contact that is undecided with this many times the digits may be a graze.
GRAZE_TIMES, GRAZE_SPARE = 3, 20
# Digits up to which also the fast root of an overdamped system counts, and up to which grazes are confirmed.
MOST_FAST, MOST_GRAZE = 600, 2500
# Takes the fields of an event from its numbers and names; the names by code, and which numbers have all digits.
IN_ORDER = itemgetter(*((*FLOAT_COLUMNS, *CODE_COLUMNS).index(name) for name in EVENT_COLUMNS))
NAMES = [CODE_NAMES.get(name) for name in CODE_COLUMNS]
ARE_EXACT = [name in EXACT_COLUMNS for name in FLOAT_COLUMNS]


def check_reached(start: Start, periods: int) -> None:
    """Raise ParameterError if a motion stopped at MOST_PERIODS before its t_end."""
    if periods >= MOST_PERIODS:
        reason = f"is more than {MOST_PERIODS:.0e} forcing periods after t0 = {show(start.t0)}, more than are followed"
        raise ParameterError("t_end", show(start.t_end), reason)


def single_loop(count: int) -> tuple[Callable[..., tuple[int, int, int]], int]:
    """Return the loop that follows one motion after its first `count` events, and how many it finds at most.

    It is compiled if that is loaded or pays.
    """
    functions = loaded_loop()
    if functions:
        return functions["follow_all"], LARGEST_BLOCK
    loop = FOLLOW if count < TURN else chosen_loops(None).follow
    return loop, TURN if loaded_loop() is None else LARGEST_BLOCK


def fits_pairs(start: Start) -> bool:
    """Return whether pairs of doubles follow a motion with the same results as many digits."""
    return start.start_error is None and start.spare_digits <= PAIR_SPARE and not settles(start)


def search_in_doubles(start: Start) -> Callable[[State], NextEvent]:
    """Return the function that finds the next event in doubles; it is not thread-safe."""
    arithmetic = Arithmetic(start.parameters)
    t_end, t_end_low = last_time(start, arithmetic)
    t0, K = float(start.t0), arithmetic.K
    functions = loaded_loop()
    if functions is None or not is_compiled(functions["search_row"]):
        return partial(advance, t_end=t_end, t_end_low=t_end_low - (t_end - t0) * K.Om_gain, K=K)
    table, search_row = table_of([K]), functions["search_row"]

    def search(state: State) -> NextEvent:
        row = np.array([row_of(state, t_end, t_end_low)])
        row[0, 15] = t0
        code, boundary, decided, t_error = search_row(row, table)
        return NextEvent(code, boundary, decided, t_error, state_of(row, 0))

    return search


class MotionInDoubles:
    """A motion in doubles: a batch of one, its events and pieces in columns.

    `code` is RUNNING, or what the motion ended with (`symosc.engine.batch.follow_all`). With `bare` decisions exceed
    their own rounding only, not the errors of the state.
    """

    def __init__(self, start: Start, bare: bool = False) -> None:
        arithmetic = Arithmetic(start.parameters)
        self.start, self.K = start, arithmetic.K._replace(sigmas=0.0) if bare else arithmetic.K
        first, self._end = first_state(start, arithmetic), last_time(start, arithmetic)
        self.first_at, self._table = first.at, table_of([self.K])
        self._batch = batch_of(np.array([row_of(first, *self._end)]))
        pieces = np.empty((len(PIECE_COLUMNS), 1))
        write_piece(pieces, 0, first, float(start.t0 - Fraction(first.t)))
        self._events, self._pieces = list[EventRows](), [pieces]

    @property
    def code(self) -> int:
        """What the motion ended with, or RUNNING."""
        return int(self._batch.codes[0])

    @code.setter
    def code(self, code: int) -> None:
        self._batch.codes[0] = code

    @property
    def count(self) -> int:
        """The number of events so far."""
        return int(self._batch.counts[0])

    @property
    def state(self) -> State:
        """The current state."""
        return state_of(self._batch.states, 0)

    @property
    def elapsed(self) -> float:
        """Time since t0."""
        state = self.state
        return clock_time(state.t - float(self.start.t0), state.t_low, 0.0, self.K)

    def events(self) -> EventRows:
        """Return the events so far."""
        return joined(self._events)

    def pieces(self) -> np.ndarray:
        """Return the pieces so far, in columns."""
        return np.concatenate(self._pieces, axis=1)

    def follow(self, most: int, accuracy: float) -> None:
        """Go on until the motion ends, needs more digits, or a block of events is full."""
        loop, largest = single_loop(self.count)
        size = min(largest, max(FIRST_BLOCK, 8 * self.count))
        out, pieces = event_buffer(size), np.empty((len(PIECE_COLUMNS), size))
        _, rows, parts = loop(0, self._batch, most, accuracy, out, pieces, no_tally(), self._table)
        self._events.append(rows_between(out, 0, rows))
        self._pieces.append(pieces[:, :parts])

    def take_over(self, finer: FinerMotion | MotionInPairs) -> None:
        """Go on from the last state of a motion with more digits, whose events and pieces replace those found here."""
        self._events, self._pieces = list(finer.rows), [self._pieces[0], *finer.pieces]
        self._batch.states[0] = self.row(finer.rounded_state())
        self._batch.counts[0], self.code = finer.count, finer.code if finer.ended else RUNNING

    def row(self, state: State) -> list[Number]:
        """Return the row of a batch for this motion in a state."""
        row = row_of(state, *self._end)
        row[15] = float(self.start.t0)
        return row

    def next_doubt(self, state: State, count: int, accuracy: float, most: int) -> int:
        """Return the number of the next event that doubles, from a state after `count` events, leave in doubt, or 0."""
        if self.start.start_error:  # more digits would not decide it
            return 0
        row = self.row(state)
        return _or_none(partial(next_undecided, state, count, row, most, accuracy, self.K)) or 0


class Motion:
    """The states and events of one initial value problem so far, with many digits.

    `code` is what the last step ended with, and `decided` whether the numbers at hand decide that; `first_at` is the
    belt on which the start is, or 0.
    """

    rounds = False  # whether events are recorded in doubles

    def __init__(self, start: Start, digits: MpArithmetic | int) -> None:
        own = many_digits(start.parameters, digits) if isinstance(digits, int) else digits
        self.start, self.arithmetic, self.digits = start, own, own.digits
        state = first_state(start, own)
        self.t0, self.first_at, self.K = state.t, state.at, own.inner_K
        self._t0_low = own.inward(own.number(start.t0 - Fraction(float(start.t0))))
        if start.start_error:  # rounding is far below it, and it is no standard error
            self.K = self.K._replace(sigmas=own.inward(own.number(Fraction(1))))
        self._state, self._end = own.inward(state), own.inward(last_time(start, own))
        self._search: Callable[[State], NextEvent] | None = None
        if own.advance_near and not start.start_error:
            self._search = _or_none(partial(search_in_doubles, start))
        self._first, self._worst = self._state, 0.0
        self.events, self._columns = list[Event](), list[tuple[Any, ...]]()
        self.code, self.decided = 0, True
        self.ahead: tuple[State, NextEvent] | None = None
        self._record(0.0)

    def missing_digits(self, digits: int) -> int:
        """Return how many of `digits` digits the least accurate event lacks, relative to max(1, |value|)."""
        if self._worst == 0:
            return 0
        context = mp_context(15)
        return int(context.ceil(context.log10(SAFETY * context.convert(self.arithmetic.outward(self._worst))))) + digits

    @property
    def ended(self) -> bool:
        """Whether the last step reached the end, a rest or a failure."""
        return self.code in (END, REST, FAILED)

    def _record(self, elapsed: Number) -> None:
        """Store the piece that begins after a step, `elapsed` after the exact t0."""
        s = self._state
        a = s.Fb if s.mode <= ON_BELT else 0.0
        elapsed = float(elapsed + self._t0_low)  # rounded once, as in pairs
        self._columns.append((s.n, *map(float, (s.theta, s.mode, s.x, s.v, a)), elapsed))

    def columns(self) -> np.ndarray:
        """Return the pieces so far, in columns."""
        return np.array(self._columns, dtype=float).T

    def step(self) -> None:
        """Advance by one event, or by one interval without events."""
        own = self.arithmetic
        entered = own.enter()
        try:
            before = self._state
            found = self._next(before)
            self.code, self.decided, self._state = found.code, found.decided, found.state
            if found.code in (END, REST):
                return
            self._record(self._elapsed())
            if found.code <= GRAZE:
                s = found.state
                clock = own.time_with_errors(s.t, s.t_low, self._first.t, s.x, s.v, found.t_error, s.S.S11, self.K)
                numbers = own.event_numbers(before, found, clock, self.K)
                if self.rounds:
                    event = event_from(map(float, numbers), event_codes(before, found))
                    self.events.append(with_rounding(event))
                    return
                self._worst = max(self._worst, clock[1] / max(1, abs(clock[0])), clock[2] / max(1, abs(s.x)))
                exact = iter(own.outward(tuple(compress(numbers, ARE_EXACT))))
                numbers = [next(exact) if each else float(n) for n, each in zip(numbers, ARE_EXACT, strict=True)]
                self.events.append(event_from(numbers, event_codes(before, found)))
        finally:
            own.leave(entered)

    def search(self) -> None:
        """Search the next event in doubles, if they reach; `ahead` is the rounded state and what is found."""
        if self._search is None or self.ahead is not None:
            return
        rough = self.rounded_state()
        found = _or_none(partial(self._search, rough))
        if found is None:
            self._search = None
        else:
            self.ahead = rough, found

    def _next(self, state: State) -> NextEvent:
        """Return the next event with many digits, searched in doubles where possible."""
        self.search()
        if self.ahead is None:
            found: NextEvent = self.arithmetic.advance(state, *self._end, self.K)
        else:
            found = self.arithmetic.advance_near(state, *self.ahead, *self._end, self.K)
            self.ahead = None
        return found

    def _elapsed(self) -> Number:
        """Return the time since t0, in the motion's arithmetic."""
        since = self._state.t - self._first.t
        return since + ((self._state.t_low - self._first.t_low) + since * self.K.Om_gain)

    def rounded_state(self) -> State:
        """Return the current state in doubles."""
        entered = self.arithmetic.enter()
        try:
            return rounded(self._state, self.start)
        finally:
            self.arithmetic.leave(entered)

    @property
    def state(self) -> State:
        """The current state."""
        return self.arithmetic.outward(self._state)

    @property
    def elapsed(self) -> Number:
        """Time since t0."""
        entered = self.arithmetic.enter()
        try:
            return self.arithmetic.outward(self._elapsed())
        finally:
            self.arithmetic.leave(entered)

    @property
    def time(self) -> Number:
        """The time of the current state."""
        return self.arithmetic.outward(self._state.t)


def _or_none(compute: Callable[[], Any]) -> Any:
    """Return a result in doubles, or None outside their range."""
    try:
        return compute()
    except (ArithmeticError, ValueError):
        return None


class MotionInPairs:
    """The same problem in double-double numbers, by compiled code, followed only as far as doubles require."""

    def __init__(self, doubles: MotionInDoubles, accuracy: float, most: int) -> None:
        start, exact = doubles.start, many_digits(doubles.start.parameters, ROUNDED_FROM)
        state, plain = first_state(start, exact), Arithmetic(start.parameters).K
        self._follow, self._K, table = compiled_pairs().follow_pairs, pair_constants(start.parameters), [doubles.K]
        self._limits = PairLimits(most, accuracy, MOST_MORE, NEGLIGIBLE, table_of(table), table_of([plain]))
        self._pairs = np.array([pairs_as_complex(tuple(row_of(state, *last_time(start, exact))))])
        self._batch = batch_of(np.array([doubles.row(rounded(state, start))]))
        self.rows, self.pieces = list[EventRows](), list[np.ndarray]()

    @property
    def code(self) -> int:
        """What the motion ended with, or RUNNING."""
        return int(self._batch.codes[0])

    @property
    def count(self) -> int:
        """The number of events so far."""
        return int(self._batch.counts[0])

    @property
    def ended(self) -> bool:
        """Whether the end, or a rest, is reached."""
        return self.code in (END, REST)

    def rounded_state(self) -> State:
        """Return the current state in doubles."""
        return state_of(self._batch.states, 0)

    def reach(self, count: int) -> bool:
        """Follow the motion to `count` events or to its end, and on while doubles are in doubt; False if pairs are."""
        first, wanted = np.arange(1), np.array([count])
        while True:
            size = max(count - self.count, 0) + MOST_MORE
            out, pieces = event_buffer(size), np.empty((len(PIECE_COLUMNS), 2 * size))
            given = (self._pairs, self._batch, out, pieces, self._K, no_tally(), self._limits)
            rows, parts = self._follow(first, wanted, *given)
            self.rows.append(rows_between(out, 0, rows))
            self.pieces.append(pieces[:, :parts])
            if self.code != RUNNING or parts < pieces.shape[1]:
                return self.code != UNDECIDED


class FinerMotion(Motion):
    """The same problem with FINER_DIGITS, followed only as far as doubles require.

    A contact that is undecided here is followed with `digits_to_confirm_graze`. Undecided still, it is a graze. Decided
    only there, the trajectory ends as "undecidable": from here on double precision, backed up as it is, would guess.
    """

    rounds = True

    def __init__(self, start: Start) -> None:
        super().__init__(start, FINER_DIGITS + start.spare_digits)
        self._finest: Motion | None = None
        self.rows, self.pieces = list[EventRows](), list[np.ndarray]()
        self._given = 0

    @property
    def count(self) -> int:
        """The number of events so far."""
        return len(self.events)

    def reach(self, count: int, next_doubt: Callable[[State, int], int]) -> bool:
        """Follow the motion to `count` events or to its end; return False at an undecided contact.

        It goes on to what `next_doubt` says of the state in doubles, and the number of events: the next event that
        doubles do not decide or know well enough.
        """
        while not self.ended:
            if self.count >= count:
                count = next_doubt(self.rounded_state(), self.count)
                if count == 0:
                    break
            before = self.count
            self.step()
            if self.code == FAILED or not (self.decided or self.start.start_error or self._is_graze(before)):
                del self.events[before:]
                return False
        self.rows.append(rows_of(0, self.events[self._given :]))
        self._given = self.count
        self.pieces = [self.columns()[:, 1:]]
        return True

    def _is_graze(self, before: int) -> bool:
        """Return whether the contact after `before` events stays undecided with many more digits; then use those."""
        base = 2 * (self.digits or 0) // GRAZE_TIMES  # at least twice the digits
        needed = digits_to_confirm_graze(self, self.elapsed, base)
        if needed is None:
            return False
        if self._finest is None or (self._finest.digits or 0) < needed:
            whole = digits_to_confirm_graze(self, self.start.t_end - self.start.t0, base)
            self._finest = Motion(self.start, min(whole or MOST_GRAZE, 3 * needed))
        finest = self._finest
        while len(finest.events) <= before and not finest.ended:
            finest.step()
            if not finest.decided and len(finest.events) >= before:
                if len(self.events) > before and len(finest.events) > before:
                    self.events[-1] = rounded_event(finest.events[-1])
                return finest.code != FAILED
        return False


def digits_to_confirm_graze(motion: Motion, elapsed: Number, digits: int) -> int | None:
    """Return the precision at which an undecided contact at a time counts as a graze; None if too high.

    A motion that tends to one that grazes has gaps that shrink like exp(-rate t), and each of them is a near miss or a
    crossing. The rate is the larger one of the free motion, or, where that takes too many digits, the smaller one: only
    starts without any share of the slow decay are fooled by that. A start that is on the steady motion has none of it,
    until something else than a graze happens.
    """
    start = motion.start
    K: Constants = constants(start.parameters)
    fast, slow = (K.h, K.h) if K.under else (-K.l2, -K.l1)
    fast_digits, slow_digits = (ceil(float(elapsed) * rate / log(10)) for rate in (fast, slow))
    if is_steady(start) and all(event.kind == "graze" for event in motion.events):
        fast_digits = 0
    decay = fast_digits if fast_digits <= MOST_FAST else max(MOST_FAST, slow_digits)
    needed = max(GRAZE_TIMES * digits, digits + GRAZE_SPARE + decay)
    return needed if needed <= max(MOST_GRAZE, GRAZE_TIMES * digits) else None


def event_from(numbers: Any, codes: Any) -> Event:
    """Return an event from its numbers and codes (`symosc.engine.events`)."""
    texts = [code if names is None else names[code] for names, code in zip(NAMES, codes, strict=True)]
    return Event(*IN_ORDER((*numbers, *texts)))


def cut_event(event: Event, context: Any) -> Event:
    """Return an event with numbers of an mpmath context; the errors include the truncation."""
    half = float(context.eps) / 2
    errors = {name: getattr(event, f"{name}_error") + half * float(abs(getattr(event, name))) for name in ("t", "x")}
    exact: dict[str, Any] = {name: +context.convert(getattr(event, name)) for name in EXACT_COLUMNS}
    return replace(event, **exact, t_error=errors["t"], x_error=errors["x"])


def rounded_event(event: Event) -> Event:
    """Return an event with floats; the errors include the rounding."""
    if isinstance(event.t, float):
        return event
    exact: dict[str, Any] = {name: float(getattr(event, name)) for name in EXACT_COLUMNS}
    return with_rounding(replace(event, **exact))


def with_rounding(event: Event) -> Event:
    """Return an event rounded to floats, with errors that include the rounding."""
    t_error, x_error = rounding_error(event.t_error, event.t), rounding_error(event.x_error, event.x)
    return replace(event, t_error=t_error, x_error=x_error)
