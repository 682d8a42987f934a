"""One motion in more precise numbers than doubles: with many digits, or until doubles decide its
events again.

With many digits (`Motion`) doubles search for an event, and only the last step to it takes the
digits. `FinerMotion` takes over from `symosc.simulation.simulate.in_doubles` where doubles are in
doubt, and hands out doubles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from math import ceil, inf, log, nan
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Number
from symosc.engine import arithmetic, batch
from symosc.engine.arithmetic import (
    Arithmetic,
    MpArithmetic,
    PairLoops,
    many_digits,
    rows_in_doubles,
)
from symosc.engine.batch import (
    EventRows,
    event_buffer,
    joined,
    keep_state,
    piece_buffer,
    rows_between,
    state_of,
)
from symosc.engine.events import (
    CODE_COLUMNS,
    CODE_NAMES,
    EXACT_COLUMNS,
    FLOAT_COLUMNS,
    Event,
    belt_of_law,
    event_codes,
)
from symosc.engine.flow import Constants, belt_at, table_of
from symosc.engine.next_event import band_beyond, entered
from symosc.engine.start import (
    Start,
    begun,
    continued,
    is_steady,
    last_time,
    rounded,
    settles,
)
from symosc.engine.state import (
    END,
    FAILED,
    GRAZE,
    NUMBERS_OF_STATE,
    ON_BELT,
    PAIR_ROW,
    REST,
    RUNNING,
    STATE_ROW,
    UNDECIDED,
    Covariance,
    NextEvent,
    State,
)
from symosc.engine.summary import no_tally
from symosc.kernels.entire import EPS
from symosc.simulation.loops import CHOICE
from symosc.simulation.trajectory import ELAPSED_ROW

# The errors of an event that pairs may have in `simulate_many`, beside its rounding to doubles, as
# a part of that.
PAIR_NOISE = 0.1
# Digits between a start and a belt, or of its error, that pairs have to spare.
PAIR_SPARE = 8
# Events that a motion is followed farther in pairs, at most, if doubles would not decide again.
MOST_MORE = 64
MOST_EVER = 1 << 62  # more than there are
# Error estimates are standard errors; digits that are promised must hold.
SAFETY = 100
# The working precision where doubles do not decide, or are not accurate enough: what these leave
# open comes before an event whose errors are not negligible beside its rounding to doubles.
FINER_DIGITS = 44
# A contact that is undecided with this many times the digits may be a graze.
GRAZE_TIMES = 3
GRAZE_SPARE = 20
# Digits up to which also the fast root of an overdamped system counts, and up to which grazes are
# confirmed.
MOST_FAST = 600
MOST_GRAZE = 2500
# Digits for gaps that get smaller and smaller.
MOST_SHRINKING = 600


class Limits(NamedTuple):
    """How far a motion is followed in more precise numbers: how many events, and how exact they
    must be.
    """

    most: int  # events
    accuracy: float  # what doubles are asked for
    # the largest error of an event, as a part of the error of rounding it to a double
    noise: float = batch.NEGLIGIBLE


def fits_pairs(start: Start) -> bool:
    """Return whether double-double numbers (32 digits) are precise enough for a motion from this
    start.
    """
    return start.start_error is None and start.spare_digits <= PAIR_SPARE and not settles(start)


class SearchInDoubles:
    """The search in doubles for the next events of one motion, by compiled code if in use.

    Not thread-safe.
    """

    # `rows` are the constants with which doubles are tested for doubt (`next_doubt`). The decisions
    # of `next_event`, for more precise numbers, always exceed the errors of a state.

    def __init__(self, start: Start, rows: Sequence[Constants]) -> None:
        self._loops = CHOICE.of_searches()
        end = last_time(start, Arithmetic(start.parameters))
        self._motion = self._loops.motion(*end, float(start.t0))
        self._careful = self._loops.constants(rows_in_doubles(start.parameters))
        self._rows = self._loops.constants(rows)

    def next_event(self, state: State, row: int) -> tuple[NextEvent, float] | None:
        """Return the event after `state`, which has the constants number `row`, and, if undecided, a
        time before which no wall is met; None on overflow.
        """
        self._motion.put(state)
        CHOICE.searches.events -= 1
        try:
            code, boundary, decided, t_error, free = self._loops.search(
                self._motion.table, self._careful, row
            )
            return NextEvent(code, boundary, decided, t_error, self._motion.state()), free
        except (ArithmeticError, ValueError):
            return None

    def next_doubt(self, state: State, row: int, count: int, limits: Limits) -> int:
        """Return the number of the first event after number `count` that doubles cannot decide, 0
        if none is near.
        """
        self._motion.put(state)
        CHOICE.searches.events -= batch.LOOK_AHEAD
        try:
            most, accuracy = limits.most, limits.accuracy
            return int(
                self._loops.doubt(self._motion.table, count, most, accuracy, self._rows, row)
            )
        except (ArithmeticError, ValueError):
            return 0


class Motion:
    """One initial value problem followed with many digits: its state, and its events so far."""

    # `code` is what the last step ended with, and `decided` whether the numbers at hand decide
    # that; `first_at` is the belt on which the start is, or 0. `begin` is a state from which the
    # motion goes on, known in all digits, with the number of its constants, and `rows` are the
    # constants by which doubles are in doubt. The arithmetic and its constants K change with the
    # band in which the motion is.

    def __init__(
        self,
        start: Start,
        digits: MpArithmetic | int,
        begin: tuple[int, State] | None = None,
        rows: Sequence[Constants] | None = None,
    ) -> None:
        if isinstance(digits, int):
            self._arithmetic: Callable[[int], MpArithmetic] = partial(
                many_digits, start.parameters, digits
            )
        else:
            given = digits
            self._arithmetic = lambda row: given
        self.start = start
        in_doubles = rows_in_doubles(start.parameters)
        self.row, state = begin or begun(start, self._arithmetic)
        own = self._arithmetic(self.row)
        self.digits = own.digits
        self._use(self.row)
        (self.t0, t0_low) = own.time(start.t0)
        self._begin = own.inward((self.t0, t0_low))
        self.first_at = belt_of_law(state.at, in_doubles[self.row])
        self._t0_low = own.inward(own.number(start.t0 - Fraction(float(start.t0))))
        self._state = own.inward(state)
        self._end = own.inward(last_time(start, own))
        if own.fast and not start.start_error:
            self._search: SearchInDoubles | None = SearchInDoubles(start, rows or in_doubles)
        else:
            self._search = None
        self._before = self.row, self._state
        self._worst = 0.0
        self._events = list[tuple[Any, tuple[int, ...]]]()
        self._columns = list[tuple[Any, ...]]()
        self.code = 0
        self.decided = True
        self.grazes_only = True
        self._rough: State | None = None  # the state in doubles
        self._rounded_t0 = float(start.t0)
        self._rounded_gain = in_doubles[0].Om_gain
        self._record_piece(0.0)

    def _use(self, row: int) -> None:
        """Take the constants number `row`, and the arithmetic that has them."""
        self.row = row
        self.arithmetic = own = self._arithmetic(row)
        self.K = own.inner_K
        if self.start.start_error:  # rounding is far below it, and it is no standard error
            self.K = self.K._replace(sigmas=own.inward(own.number(Fraction(1))))

    def missing_digits(self, digits: int) -> int:
        """Return how many more digits the least accurate event needs to have `digits`.

        Negative if it has more.
        """
        if self._worst == 0:
            return 0
        context = arithmetic.mp_context(15)  # enough for a logarithm that is rounded up
        worst = context.convert(self.arithmetic.outward(self._worst))
        return int(context.ceil(context.log10(SAFETY * worst))) + digits

    @property
    def is_open(self) -> bool:
        """Whether the last step leaves open how the motion goes on."""
        # With an uncertain start a contact that may be a touch is one: a motion that misses the
        # belt is nearly the same. Not so at a belt with static friction, which would hold it.
        return not self.decided and (self.start.start_error is None or self._at_fork)

    @property
    def _at_fork(self) -> bool:
        """Whether the last step ended at, or on, a belt whose static friction exceeds kinetic
        friction.
        """
        state = self._state
        boundary = state.at or max(state.mode - ON_BELT, 0)
        return boundary > 0 and belt_at(boundary, self.K).E > 0

    @property
    def ended(self) -> bool:
        """Whether the last step reached the end, a rest or a failure."""
        return self.code in (END, REST, FAILED)

    @property
    def count(self) -> int:
        """The number of events so far."""
        return len(self._events)

    def events(self, context: Any = None) -> list[Event]:
        """Return the events in all digits, or rounded to an mpmath context.

        Then their errors include the rounding.
        """
        if context:
            half = float(context.eps) / 2
        else:
            half = 0.0
        events = list[Event]()
        for numbers, codes in self._events:
            values: dict[str, Any] = dict(zip(FLOAT_COLUMNS, numbers, strict=True))
            values |= {
                name: float(value) for name, value in values.items() if name not in EXACT_COLUMNS
            }
            exact = self.arithmetic.outward(tuple(values[name] for name in EXACT_COLUMNS), context)
            values |= zip(EXACT_COLUMNS, exact, strict=True)
            for name in ("t", "x"):
                values[f"{name}_error"] += half * abs(float(values[name]))
            for name, code in zip(CODE_COLUMNS, codes, strict=True):
                if name in CODE_NAMES:
                    values[name] = CODE_NAMES[name][code]
                else:
                    values[name] = code
            events.append(Event(**values))
        return events

    def undo(self) -> None:
        """Take back the last step: its state, its piece, and its event if it had one."""
        row, self._state = self._before
        self._use(row)
        self._rough = None
        del self._columns[-1]
        if self.code <= GRAZE:
            del self._events[-1]

    def _record_piece(self, elapsed: Number) -> None:
        """Store the piece of the motion that begins now, a time `elapsed` after t0 (as a number of
        this precision).
        """
        s = self._state
        if s.mode <= ON_BELT:
            a = s.Fb
        else:
            a = 0.0
        elapsed = float(elapsed + self._t0_low)  # rounded once, as in pairs
        numbers = map(float, (s.theta, s.mode, s.x, s.v, a))
        self._columns.append((s.n, *numbers, elapsed, float(self.row)))

    def columns(self) -> np.ndarray:
        """Return the numbers at the start of each piece, (columns, pieces): see
        `symosc.engine.batch.PIECE_COLUMNS`.
        """
        return np.array(self._columns, dtype=float).T

    def step(self) -> None:
        """Advance by one event, or by one interval without events."""
        own = self.arithmetic
        with own.precision():
            before = self._state
            self._before = self.row, before
            event = self._next_event(before)
            self.code = event.code
            self.decided = event.decided
            self._state = event.state
            if event.code in (END, REST):
                return
            if event.code <= GRAZE:
                s = event.state
                time_with_errors = own.following["time_with_errors"]
                clock = time_with_errors(
                    s.t, s.t_low, self._begin[0], s.x, s.v, event.t_error, s.S.S11, self.K
                )
                self._record_event(before, event, clock)
                self.grazes_only = self.grazes_only and event.code == GRAZE
            way = band_beyond(event.state.mode, self.K)
            if way:
                self._state = entered(event.state, way)
                self._use(self.row + way)
            self._record_piece(self._elapsed())

    def _record_event(self, before: State, event: NextEvent, clock: tuple[Number, ...]) -> None:
        """Store the event `event` after `before`.

        `clock` has its time, and the errors of its time and position.
        """
        t, t_error, x_error = clock
        self._worst = max(
            self._worst, t_error / max(1, abs(t)), x_error / max(1, abs(event.state.x))
        )
        numbers = self.arithmetic.following["event_numbers"](before, event, clock, self.K)
        self._events.append((numbers, event_codes(before, event, self.K)))

    def _next_event(self, state: State) -> NextEvent:
        """Return the event after `state` with many digits; doubles search for it where they can."""
        if self._search:
            rough = self.rounded_state()
        else:
            rough = None
        if self._search and rough:
            ahead = self._search.next_event(rough, self.row)
        else:
            ahead = None
        functions = self.arithmetic.following
        self._rough = None
        if ahead is None:
            self._search = None
            event: NextEvent = functions["advance"](state, *self._end, self.K)
        else:
            event = functions["advance_near"](state, rough, *ahead, *self._end, self.K)
        return event

    def _elapsed(self) -> Number:
        """Return the time since t0, as a number of the kind that the motion is computed with."""
        since = self._state.t - self._begin[0]
        before = self._begin[1]
        return since + ((self._state.t_low - before) + since * self.K.Om_gain)

    def rounded_state(self) -> State:
        """Return the current state rounded to doubles."""
        if self._rough is None:
            with self.arithmetic.precision():
                self._rough = rounded(self._state, self._rounded_t0, self._rounded_gain)
        return self._rough

    @property
    def state(self) -> State:
        """The current State (mode, phase, x, v, forces, errors, time) in mpmath numbers."""
        return self.arithmetic.outward(self._state)

    @property
    def elapsed(self) -> Number:
        """The time since t0, as an mpmath number."""
        with self.arithmetic.precision():
            return self.arithmetic.outward(self._elapsed())


class MotionInPairs:
    """A motion in double-double numbers, followed only until doubles can decide its events again."""

    # It stops before an event that pairs do not decide, or do not know accurately enough. `rows`
    # are the constants by which doubles are in doubt.

    def __init__(
        self, start: Start, rows: Sequence[Constants], limits: Limits, loops: PairLoops
    ) -> None:
        self._start = start
        exact = partial(many_digits, start.parameters, arithmetic.ROUNDED_FROM)
        number, state = begun(start, exact)
        tables = map(table_of, (rows, rows_in_doubles(start.parameters)))
        self._follow = loops.follow_pairs
        self._table = arithmetic.pair_constants(start.parameters)
        self._limits = batch.PairLimits(
            limits.most, limits.accuracy, MOST_EVER, limits.noise, *tables
        )
        row = batch.row_of(state, *last_time(start, exact(number)))
        self._pairs = np.array([arithmetic.pairs_as_complex(row)], PAIR_ROW)
        in_doubles = np.zeros(1, STATE_ROW)
        in_doubles["t_end"], in_doubles["t_end_low"] = last_time(
            start, Arithmetic(start.parameters)
        )
        in_doubles["t0"] = float(start.t0)
        self._batch = batch.batch_of(in_doubles, np.array([number]))
        keep_state(self._batch.states[0], rounded(state, float(start.t0), rows[0].Om_gain))
        self._events = list[EventRows]()
        self._pieces = list[np.ndarray]()
        self.goal = 0  # the number of events to come to

    row = property(
        lambda self: int(self._batch.sets[0]), doc="The number of the constants of its band."
    )
    code = property(
        lambda self: int(self._batch.codes[0]), doc="How the motion ended, as a code, or RUNNING."
    )
    count = property(lambda self: int(self._batch.counts[0]), doc="The number of events so far.")
    grazes_only = property(
        lambda self: self.count == 0, doc="Whether all events are grazes, which pairs leave open."
    )

    def rounded_state(self) -> State:
        """Return the current state in doubles."""
        return state_of(self._batch.states[0])

    def last_sure(self, digits: int) -> tuple[int, State]:
        """Return the state before the first event that pairs cannot decide, with `digits` digits,
        and the number of its constants.
        """
        finer = many_digits(self._start.parameters, digits, self.row)
        number = finer.context.mpf
        row = self._pairs[0]
        values = dict[str, Any]()
        for name in NUMBERS_OF_STATE:
            values[name] = number(float(row[name].real)) + number(float(row[name].imag))
        S = Covariance(*(values.pop(name) for name in Covariance._fields))
        whole = {name: int(values[name]) for name in ("mode", "at", "n")}
        return self.row, continued(State(**(values | whole), S=S), arithmetic.PAIR_EPS, finer)

    def reach(self, count: int) -> bool:
        """Follow to `count` events, then until doubles can decide again.

        Return False if pairs leave one undecided.
        """
        first = np.arange(1)
        wanted = np.array([count])
        while True:
            size = 2 * (max(count - self.count, 0) + MOST_MORE)
            out = event_buffer(size)
            pieces = piece_buffer(size)
            arguments = (
                self._pairs,
                self._batch,
                out,
                pieces,
                self._table,
                no_tally(),
                self._limits,
            )
            rows, parts = self._follow(first, wanted, *arguments)
            self._events.append(rows_between(out, 0, rows))
            self._pieces.append(pieces[:, :parts])
            self.goal = int(wanted[0])
            if self.code != RUNNING or parts < size:
                return self.code != UNDECIDED

    def take(self) -> tuple[EventRows, np.ndarray]:
        """Return the events and the pieces (parts between steps) found since the last call, as
        columns.
        """
        columns = joined(self._events), np.concatenate(self._pieces, axis=1)
        self._events = []
        self._pieces = []
        return columns


class MotionInDigits(Motion):
    """A motion with many digits that stores events as doubles.

    It starts at t0, or where the motion `other` is.
    """

    # If it does, an event that it knows less accurately than the limits allow counts as undecided.

    def __init__(
        self,
        start: Start,
        rows: Sequence[Constants],
        limits: Limits,
        digits: int,
        before: MotionInPairs | MotionInDigits | None,
    ) -> None:
        if before:
            begin = before.last_sure(digits)
        else:
            begin = None
        super().__init__(start, digits, begin, rows)
        self.from_start = before is None
        self.is_known = True
        if before:
            self._skipped = before.count
        else:
            self._skipped = 0
        self.grazes_only = before is None or before.grazes_only
        self._limits = limits
        self.goal = 0

    @property
    def count(self) -> int:
        """The number of events since t0, including those of the motion from which this one goes on."""
        return self._skipped + len(self._events)

    def reach(self, count: int) -> bool:
        """Follow the motion to `count` events or to its end.

        Return False after a step that could not be decided.
        """
        # It goes on to the next event that doubles do not decide or know well enough.
        self.goal = count
        while not self.ended:
            if self.count >= self.goal:
                state = self.rounded_state()
                search = self._search
                if search:
                    self.goal = search.next_doubt(state, self.row, self.count, self._limits)
                else:
                    self.goal = 0
                if self.goal == 0:
                    break
            self.step()
            if self.code == FAILED or not self.is_known or self.is_open:
                return False
        return True

    def _record_event(self, before: State, event: NextEvent, clock: tuple[Number, ...]) -> None:
        """Store an event rounded to doubles, with its errors.

        Note whether it is known well enough.
        """
        t, t_error, x_error = map(float, clock)
        x = float(event.state.x)
        noise = self._limits.noise
        if self.start.start_error:  # no digits make it smaller
            self.is_known = True
        elif self.from_start:
            # Where neighbouring motions move apart, digits are eaten however exact the start is: no
            # more is asked for than doubles would have to give.
            least = max(self._limits.accuracy, EPS)
            self.is_known = not batch.is_inexact(t, t_error, x, x_error, self._rounded_t0, least)
        else:
            self.is_known = batch.is_below(noise, t_error, t) and batch.is_below(noise, x_error, x)
        told = t, batch.rounding_error(t_error, t), batch.rounding_error(x_error, x)
        numbers = self.arithmetic.following["event_numbers"](before, event, told, self.K)
        self._events.append((tuple(map(float, numbers)), event_codes(before, event, self.K)))

    def last_sure(self, digits: int) -> tuple[int, State]:
        """Return the current state, the last that is known, with `digits` digits, and the number of
        its constants.
        """
        finer = many_digits(self.start.parameters, digits, self.row)
        eps = Fraction(1, 1 << self.arithmetic.context.prec)
        return self.row, continued(self.state, eps, finer)

    def take(self) -> tuple[EventRows, np.ndarray]:
        """Return the events and the pieces (parts between steps) found since the last call, as
        columns.
        """
        rows = event_buffer(len(self._events))
        pieces = self.columns()[:, 1:]
        for n, (numbers, codes) in enumerate(self._events):
            rows.floats[:, n] = numbers
            rows.ints[:, n] = (0, *codes)
        self._skipped = self.count
        del self._events[:], self._columns[1:]
        return rows, pieces


class FinerMotion:
    """A motion in pairs of doubles or in many digits, from its start on, followed until doubles
    suffice again.
    """

    # Pairs follow it, if `loops` are given or this process has them compiled, else FINER_DIGITS
    # digits. Past a contact that these leave undecided it goes on with as many digits as confirm a
    # graze (`digits_to_confirm_graze`): from the state before it with its error, or from t0 if that
    # error is why. If they do not decide the contact, it is a graze. If they do, the next such
    # contact takes twice as many digits: where sticks get shorter, so do gaps. Where a gap has died
    # away below these digits, it begins again with as many as die away until t_end, if that are at
    # most MOST_FAST. `rows` are the constants by which doubles are in doubt, `now` is the motion in
    # the precision at hand.

    def __init__(
        self,
        start: Start,
        rows: Sequence[Constants],
        limits: Limits,
        loops: PairLoops | None = None,
    ) -> None:
        self._problem = start, rows, limits
        self._least = FINER_DIGITS + start.spare_digits
        self._asked_at = inf  # the number of events before the contact that took more digits
        self.events = list[EventRows]()
        self.pieces = list[np.ndarray]()
        # the time of a contact that cannot be decided, and with how many digits
        self.open_at = nan
        self.open_in = 0
        self.now: MotionInPairs | MotionInDigits
        if fits_pairs(start):
            loops = loops or CHOICE.of_pairs_if_loaded()
        else:
            loops = None
        if loops:
            self.now = MotionInPairs(*self._problem, loops)
        else:
            self.now = MotionInDigits(*self._problem, self._least, None)

    def reach(self, count: int) -> bool:
        """Follow to `count` events, then on until doubles can decide again.

        Return False at an undecidable contact.
        """
        reached = self.now.reach(count)
        while not reached:
            goal = self.now.goal
            if not self._settle_contact():
                break
            reached = self.now.reach(goal)
        self._take()
        return reached

    def _take(self) -> None:
        """Append the events and pieces found since the last call to `events` and `pieces`."""
        events, pieces = self.now.take()
        self.events.append(events)
        self.pieces.append(pieces)

    def _settle_contact(self) -> bool:
        """Get past an undecided contact with more digits, or by taking it for a graze.

        Return False if both fail.
        """
        now = self.now
        (start, *_) = self._problem
        if isinstance(now, MotionInPairs):
            return self._go_on(self._least, now)
        # From t0 on the error has grown too large: again, with twice the digits.
        if now.from_start and not now.is_known:
            digits = 2 * now.digits
            self.open_at = float(now.state.t)
            self.open_in = now.digits
            now.undo()
            return digits <= MOST_GRAZE and self._go_on(digits)
        if start.start_error and now.code != FAILED and now.is_known:  # no digits decide this
            self.open_at = float(now.state.t)
            self.open_in = now.digits
            now.undo()
            return False
        events_before = now.count - (now.code <= GRAZE)  # the contact itself may be counted
        base = 2 * self._least // GRAZE_TIMES
        if events_before > self._asked_at:  # not the first contact that took more digits
            least = 2 * now.digits
        else:
            least = 0
        # The digits that confirm a graze at this contact, and at any until t_end.
        times = now.elapsed, start.t_end - start.t0
        needed, whole = (digits_to_confirm_graze(now, span, base, least) or inf for span in times)
        if least > MOST_SHRINKING:  # gaps that get smaller without end
            needed = inf
        if now.from_start and now.code != FAILED and now.digits >= needed:  # it is a graze
            self._asked_at = inf
            return True
        self.open_at = float(now.state.t)
        self.open_in = now.digits
        now.undo()
        # A gap that has died away: from t0 with as many digits as die away until t_end.
        if (
            now.code == FAILED
            and now.is_known
            and now.digits < whole < base + GRAZE_SPARE + MOST_FAST
        ):
            return self._go_on(int(whole))
        # More digits from the state before do not help: once more from t0, unless it began there.
        if now.code == FAILED or now.digits >= needed or needed == inf or not now.is_known:
            return not now.from_start and self._go_on(now.digits)
        # From the state before the contact: with what `whole` asks for, if that is not much more.
        self._asked_at = events_before
        if least:
            most = needed
        else:
            most = min(whole, MOST_GRAZE, GRAZE_TIMES * needed)
        return self._go_on(int(max(needed, most)), now)

    def _go_on(self, digits: int, source: MotionInPairs | MotionInDigits | None = None) -> bool:
        """Go on with `digits` digits from where `source` is, or from t0.

        Return whether it reaches all events so far.
        """
        self._take()
        before = self.now
        count = self.now.count
        self.now = now = MotionInDigits(*self._problem, digits, source)
        if isinstance(before, MotionInPairs) or source:
            return True
        # Steps of two arithmetics differ: one may end between events where the other one does not.
        while not now.ended and now.count <= count and now.elapsed < before.elapsed:
            now.step()
        if now.count > count:
            now.undo()
        there = now.count == count and now.code != FAILED
        _, pieces = now.take()
        # The last step may have gone on into another band.
        self.pieces.append(pieces[:, pieces[ELAPSED_ROW] > float(before.elapsed)])
        return there


def digits_to_confirm_graze(
    motion: Motion, elapsed: Number, digits: int, least: int = 0
) -> int | None:
    """Return how many digits must leave a contact undecided for it to count as a graze.

    None: too many to try.

    The contact is a time `elapsed` after t0. The result is at least `least`, and more than
    `digits`.
    """
    # A motion that tends to one that grazes has gaps that shrink like exp(-rate t), and each of
    # them is a near miss or a crossing. The rate is the larger one of the free motion, or, where
    # that takes too many digits, the smaller one: only starts without any share of the slow decay
    # are fooled by that. A start that is on the steady motion has none of it, until something else
    # than a graze happens.
    start = motion.start
    K = Arithmetic(start.parameters, motion.row).K
    if K.under:
        fast = max(K.h, 0.0)
        slow = fast
    else:
        fast = max(-K.l2, 0.0)
        slow = max(-K.l1, 0.0)
    fast_digits, slow_digits = (ceil(float(elapsed) * rate / log(10)) for rate in (fast, slow))
    if is_steady(start) and motion.grazes_only:
        fast_digits = 0
    if fast_digits <= MOST_FAST:
        decay = fast_digits
    else:
        decay = max(MOST_FAST, slow_digits)
    needed = max(GRAZE_TIMES * digits, digits + GRAZE_SPARE + decay, least)
    if needed <= max(MOST_GRAZE, GRAZE_TIMES * digits):
        return needed
    return None
