"""One motion in one arithmetic, event by event, and the digits that decide an undecided contact.

In doubles the next event is found by compiled code where this process has loaded it, else by CPython, with the same
bits. With many digits doubles search first, and only the last step to an event takes the digits
(`symosc.engine.next_event`).
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
from symosc.engine.arithmetic import Arithmetic, MpArithmetic, compiled, is_compiled, many_digits, mp_context
from symosc.engine.batch import rounding_error, row_of
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
from symosc.engine.flow import Constants, constants
from symosc.engine.next_event import advance
from symosc.engine.start import Start, first_state, is_steady, rounded
from symosc.engine.state import END, FAILED, GRAZE, ON_BELT, REST, Covariance, NextEvent, State
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.simulation.trajectory import Piece

# A motion is searched period by period: more than this many would take hours.
MOST_PERIODS = 10**8
# What doubles found is kept for so many steps.
MOST_SEARCHED = 256
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


def last_time(start: Start, arithmetic: Arithmetic) -> tuple[Number, Number]:
    """Return t_end in two parts, or a time MOST_PERIODS after t0 if that is earlier."""
    periods = Fraction(MOST_PERIODS * 44, 7) / start.parameters.Omega  # 44/7 is a little more than 2 pi
    return arithmetic.time(min(start.t_end, start.t0 + periods))


def check_reached(start: Start, periods: int) -> None:
    """Raise ParameterError if a motion stopped at MOST_PERIODS before its t_end."""
    if periods >= MOST_PERIODS:
        reason = f"is more than {MOST_PERIODS:.0e} forcing periods after t0 = {show(start.t0)}, more than are followed"
        raise ParameterError("t_end", show(start.t_end), reason)


def search_in_doubles(start: Start, K: Constants) -> Callable[[State], NextEvent]:
    """Return the function that finds the next event in doubles; it is not thread-safe."""
    t_end, t_end_low = last_time(start, Arithmetic(start.parameters))
    t0 = float(start.t0)
    search_row = loaded_search()
    if search_row is None:
        low = t_end_low - (t_end - t0) * K.Om_gain
        return partial(advance, t_end=t_end, t_end_low=low, K=K)
    table = table_of([K])

    def search(state: State) -> NextEvent:
        row = np.array([row_of(state, t_end, t_end_low)])
        row[0, 15] = t0
        code, boundary, decided, t_error = search_row(row, table)
        mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, _, _, _, s, c, theta_low = row[0].tolist()
        S = Covariance(S11, S12, S22)
        there = State(int(mode), int(at), int(n), theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)
        return NextEvent(code, boundary, decided, t_error, there)

    return search


def loaded_search() -> Any:
    """Return the compiled `symosc.engine.batch.search_row`, or None where loading it costs more than many events."""
    if not compiled.cache_info().currsize:
        return None
    functions = compiled()
    in_use, function = functions["follow_all"].overloads, functions["search_row"]
    return function if in_use and is_compiled(function) else None


class Motion:
    """The states and events of one initial value problem so far, in doubles or with many digits.

    `code` is what the last step ended with, and `decided` whether the numbers at hand decide that; `first_at` is the
    belt on which the start is, or 0. `searched` are states in doubles with what was found from there: since digits took
    over, or, with digits, what doubles found ahead.
    """

    rounds = False  # whether events are recorded in doubles, whatever the digits

    def __init__(self, start: Start, digits: Arithmetic | int | None = None, sigmas: float | None = None) -> None:
        p = start.parameters
        own: Arithmetic = many_digits(p, digits) if isinstance(digits, int) else digits or Arithmetic(p)
        self.start, self.arithmetic = start, own
        self.digits = own.digits if isinstance(own, MpArithmetic) else None
        self._paths = paths = self.arithmetic
        state = first_state(start, self.arithmetic)
        self.t0, self.first_at = state.t, state.at
        self.K = paths.inner_K
        if (
            self.digits and start.start_error
        ):  # rounding is far below the error of the start, which is no standard error
            self.K = self.K._replace(sigmas=paths.inward(self.arithmetic.number(Fraction(1))))
        self._state, self._end = paths.inward(state), paths.inward(last_time(start, self.arithmetic))
        self._search: Callable[[State], NextEvent] | None = None
        if not self.digits:
            self.K = self.K if sigmas is None else self.K._replace(sigmas=sigmas)
            self._search = search_in_doubles(start, self.K)
        elif paths.advance_near and not start.start_error:
            self._search = _or_none(lambda: search_in_doubles(start, Arithmetic(start.parameters).K))
        self._first, self._worst, self._taken_over = self._state, 0.0, 0
        self.events: list[Event] = []
        self.pieces: list[Piece] = []
        self.code, self.decided = 0, True
        self.searched: list[tuple[State, NextEvent]] = []
        self._record(0.0)

    def missing_digits(self, digits: int) -> int:
        """Return how many of `digits` digits the least accurate event lacks, relative to max(1, |value|)."""
        if self._worst == 0:
            return 0
        context = mp_context(15)
        return int(context.ceil(context.log10(SAFETY * context.convert(self._paths.outward(self._worst))))) + digits

    @property
    def ended(self) -> bool:
        """Whether the last step reached the end, a rest or a failure."""
        return self.code in (END, REST, FAILED)

    def _record(self, elapsed: Number) -> None:
        """Store the state after a step, and its time."""
        s = self._state
        a = s.Fb if s.mode <= ON_BELT else 0.0
        self.pieces.append(Piece(s.n, float(s.theta), s.mode, float(s.x), float(s.v), float(a), float(elapsed)))

    def step(self) -> None:
        """Advance by one event, or by one interval without events."""
        paths = self._paths
        entered = paths.enter()
        try:
            before = self._state
            if self._search and not self.digits:
                found = self._search(before)
                if len(self.searched) < MOST_SEARCHED:
                    self.searched.append((before, found))
            else:
                found = self._in_digits(before)
            self.code, self.decided, self._state = found.code, found.decided, found.state
            if found.code in (END, REST):
                return
            self._record(self._elapsed())
            if found.code <= GRAZE:
                s = found.state
                clock = paths.time_with_errors(s.t, s.t_low, self._first.t, s.x, s.v, found.t_error, s.S.S11, self.K)
                numbers = paths.event_numbers(before, found, clock, self.K)
                if self.rounds:
                    event = event_from(map(float, numbers), event_codes(before, found))
                    self.events.append(with_rounding(event))
                    return
                if self.digits:
                    self._worst = max(self._worst, clock[1] / max(1, abs(clock[0])), clock[2] / max(1, abs(s.x)))
                    exact = iter(paths.outward(tuple(compress(numbers, ARE_EXACT))))
                    numbers = [next(exact) if each else float(n) for n, each in zip(numbers, ARE_EXACT, strict=True)]
                self.events.append(event_from(numbers, event_codes(before, found)))
        finally:
            paths.leave(entered)

    def _in_digits(self, state: State) -> NextEvent:
        """Return the next event with many digits, searched in doubles where possible."""
        rough, found = self.searched.pop(0) if self.searched else (state, None)
        if found is None or rough[:3] != state[:3]:  # mode, belt and period
            rough, found = rounded(state, self.start), None
            if self._search is not None:
                found = _or_none(partial(self._search, rough))
        if found is None:
            self._search = None
            return self._paths.advance(state, *self._end, self.K)
        there: NextEvent = self._paths.advance_near(state, rough, found, *self._end, self.K)
        if there.code != found.code:  # doubles went elsewhere
            self.searched.clear()
        return there

    def _elapsed(self) -> Number:
        """Return the time since t0, in the motion's arithmetic."""
        since = self._state.t - self._first.t
        return since + ((self._state.t_low - self._first.t_low) + since * self.K.Om_gain)

    def take_over(self, finer: Motion) -> None:
        """Continue in doubles from the state and more accurate events of a motion with more digits."""
        self.events[self._taken_over :] = [rounded_event(event) for event in finer.events[self._taken_over :]]
        self._taken_over = len(self.events)
        self.pieces[:] = finer.pieces
        self.code, self.decided = finer.code, True
        self.searched.clear()
        entered = finer._paths.enter()
        try:
            self._state = rounded(finer._state, self.start)
        finally:
            finer._paths.leave(entered)

    @property
    def state(self) -> State:
        """The current state."""
        return self._paths.outward(self._state)

    @property
    def elapsed(self) -> Number:
        """Time since t0."""
        entered = self._paths.enter()
        try:
            return self._paths.outward(self._elapsed())
        finally:
            self._paths.leave(entered)

    @property
    def time(self) -> Number:
        """The time of the current state."""
        return self._paths.outward(self._state.t)


def _or_none(compute: Callable[[], Any]) -> Any:
    """Return a result in doubles, or None outside their range."""
    try:
        return compute()
    except (ArithmeticError, ValueError):
        return None


class FinerMotion(Motion):
    """The same problem with FINER_DIGITS, followed only as far as doubles require.

    A contact that is undecided here is followed with `digits_to_confirm_graze`. Undecided still, it is a graze. Decided
    only there, the trajectory ends as "undecidable": from here on double precision, backed up as it is, would guess.
    """

    rounds = True

    def __init__(self, start: Start) -> None:
        super().__init__(start, FINER_DIGITS + start.spare_digits)
        self._finest: Motion | None = None

    def reach(self, count: int, searched: list[tuple[State, NextEvent]]) -> bool:
        """Follow the motion to `count` events or to its end; return False at an undecided contact."""
        self.searched = searched[:]
        while len(self.events) < count and not self.ended:
            before = len(self.events)
            self.step()
            if self.code == FAILED or not (self.decided or self.start.start_error or self._is_graze(before)):
                return False
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
                    self.events[-1] = finest.events[-1]
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
