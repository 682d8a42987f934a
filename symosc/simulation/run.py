"""A trajectory in the making: the state is advanced event by event, in one kind of arithmetic, and recorded."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from fractions import Fraction
from typing import Any, TypeAlias

from symosc.aliases import Number
from symosc.engine.arithmetic import Arithmetic, MpArithmetic, many_digits, mp_context
from symosc.engine.batch import rounding_error
from symosc.engine.start import Start, first_state, rounded
from symosc.engine.state import CROSS, END, FAILED, GRAZE, ON_BELT, REST, SLIP, STICK, NextEvent, State
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.model import MODE_NAMES
from symosc.simulation.search import MOST_PERIODS, Search, last_time, search_in_doubles
from symosc.simulation.trajectory import Event, Piece

EVENT_KINDS = {CROSS: "cross", STICK: "stick", SLIP: "slip", GRAZE: "graze"}
# What doubles found is kept for so many steps.
MOST_SEARCHES = 256
# Error estimates are standard errors; digits that are promised must hold.
SAFETY = 100


def check_reached(start: Start, periods: int) -> None:
    """Raise ParameterError if a motion that ended after so many periods did not get to its t_end for their number."""
    if periods >= MOST_PERIODS:
        reason = f"is more than {MOST_PERIODS:.0e} forcing periods after t0 = {show(start.t0)}, more than are followed"
        raise ParameterError("t_end", show(start.t_end), reason)


#: A state in doubles, and the next event that they found from there.
Searched: TypeAlias = tuple[State, NextEvent]


def _search_beside_digits(start: Start) -> Search | None:
    """Return what searches for the next event in doubles; None where many digits have to do it alone."""
    if start.start_error:  # that is no rounding
        return None
    try:
        return search_in_doubles(start, Arithmetic(start.parameters).K)
    except (ArithmeticError, ValueError):  # out of the range of doubles
        return None


class Path:
    """The states and events of one initial value problem so far, in one arithmetic.

    Parameters
    ----------
    start : Start
    arithmetic : Arithmetic or int, optional
        Or the number of digits; None: doubles.
    rounds : bool
        Whether events are handed out as doubles; then `missing_digits` knows nothing.

    Attributes
    ----------
    events : list of Event
    pieces : list of Piece
    state : State
    code, decided : int, bool
        What the last step ended with, and whether that was beyond doubt (`symosc.engine.next_event`).
    first_at : int
        The belt on which the start is, or 0.
    searches : deque of (State, NextEvent)
        In doubles: what was found since a path with more digits was adopted, and from where. With digits: what doubles
        found on the way to come, if they are ahead.
    """

    def __init__(self, start: Start, arithmetic: Arithmetic | int | None = None, rounds: bool = False) -> None:
        self.start, self._rounds = start, rounds
        if isinstance(arithmetic, int):
            arithmetic = many_digits(start.parameters, arithmetic)
        self.arithmetic: Arithmetic = arithmetic or Arithmetic(start.parameters)
        digits = isinstance(self.arithmetic, MpArithmetic)
        self._paths = paths = self.arithmetic.paths
        number, state = self.arithmetic.number, first_state(start, self.arithmetic)
        self.K = paths.constants(self.arithmetic.K)
        if digits and start.start_error:  # rounding is far below the error of the start, which is no standard error
            self.K = self.K._replace(sigmas=paths.inward(number(Fraction(1))))
        self.t0, self.first_at = state.t, state.at
        self._state = paths.inward(state)
        self._end = paths.inward(last_time(start, self.arithmetic))
        self._in_digits, self._search = digits, None
        if not digits:
            self._search = search_in_doubles(start, self.K)
        elif paths.advance_near:
            self._search = _search_beside_digits(start)
        self.searches: deque[Searched] = deque()
        self._t0, self._t0_low = self._state.t, self._state.t_low
        self.events: list[Event] = []
        self.pieces: list[Piece] = []
        self.code, self.decided = 0, True
        self._worst, self._adopted = 0.0, 0
        self._record(0.0)

    def missing_digits(self, digits: int) -> int:
        """Return how many of `digits` digits the least accurate event lacks (relative to max(1, |value|))."""
        if self._worst == 0:
            return 0
        context = mp_context(15)
        return int(context.ceil(context.log10(SAFETY * context.convert(self._paths.outward(self._worst))))) + digits

    @property
    def ended(self) -> bool:
        """Whether the last step reached the end, a rest or a failure."""
        return self.code in (END, REST, FAILED)

    def _record(self, elapsed: Number) -> None:
        s = self._state
        a = s.Fb if s.mode <= ON_BELT else 0.0
        self.pieces.append(Piece(s.n, float(s.theta), s.mode, float(s.x), float(s.v), float(a), float(elapsed)))

    def step(self) -> None:
        """Advance by one event or one stretch without events."""
        before = self._paths.enter()
        try:
            self._step(self._paths)
        finally:
            self._paths.leave(before)

    def _step(self, paths: Arithmetic) -> None:
        source = self._state.mode
        self.code, boundary, self.decided, t_error, s = self._advanced(paths)
        self._state = s
        if self.code in (END, REST):
            return
        self._record(self._elapsed())
        if self.code in EVENT_KINDS:
            t, t_error, x_error = paths.handed_out(s.t, s.t_low, self._t0, s.x, s.v, t_error, s.S.S11, self.K)
            kind, names = EVENT_KINDS[self.code], (MODE_NAMES[source], MODE_NAMES[s.mode])
            if self._rounds:
                numbers = (float(t), float(s.x), float(s.v), float(s.theta))
                event = Event(*numbers, kind, boundary, *names, float(t_error), float(x_error))
                self.events.append(with_rounding(event))
                return
            self._worst = max(self._worst, t_error / max(1, abs(t)), x_error / max(1, abs(s.x)))
            t, x, v, theta = paths.outward((t, s.x, s.v, s.theta))
            self.events.append(Event(t, x, v, theta, kind, boundary, *names, float(t_error), float(x_error)))

    def _advanced(self, paths: Arithmetic) -> NextEvent:
        """Return the next event; doubles search for it, also where many digits follow the motion."""
        state = self._state
        if self._search and not self._in_digits:
            found = self._search(state)
            if len(self.searches) < MOST_SEARCHES:
                self.searches.append((state, found))
            return found
        rough = self._rough_event()
        if rough is None:
            return paths.advance(state, *self._end, self.K)
        found = paths.advance_near(state, *rough, *self._end, self.K)
        if found.code != rough[1].code:
            self.searches.clear()  # the doubles went elsewhere
        return found

    def _rough_event(self) -> Searched | None:
        """Return about the same state in doubles and what they find from there, if they are of use."""
        state = self._state
        if self.searches:
            known = self.searches.popleft()
            if known[0][:3] == state[:3]:  # mode, belt and period
                return known
        if self._search is not None:
            try:
                rough = rounded(state, self.start)
                return rough, self._search(rough)
            except (ArithmeticError, ValueError):  # out of the range of doubles
                self._search = None
        return None

    def _elapsed(self) -> Number:
        since = self._state.t - self._t0
        return since + ((self._state.t_low - self._t0_low) + since * self.K.Om_gain)

    def adopt(self, other: Path) -> None:
        """Continue from where a path with more digits is, and take over what it knows better."""
        self.events[self._adopted :] = [rounded_event(event) for event in other.events[self._adopted :]]
        self._adopted = len(self.events)
        self.pieces[:] = other.pieces
        self._state, self.code, self.decided = other.rounded_state(), other.code, True
        self.searches.clear()

    @property
    def state(self) -> State:
        """The current state."""
        return self._paths.outward(self._state)

    def believe(self) -> None:
        """Take the path in doubles as it is: decisions exceed their own rounding only, not the errors of the state."""
        self.K = self.K._replace(sigmas=0.0)
        self._search = search_in_doubles(self.start, self.K)

    def rounded_state(self) -> State:
        """Return the current state in doubles."""
        before = self._paths.enter()
        try:
            return rounded(self._state, self.start)
        finally:
            self._paths.leave(before)

    @property
    def elapsed(self) -> Number:
        """Time since t0."""
        before = self._paths.enter()
        try:
            return self._paths.outward(self._elapsed())
        finally:
            self._paths.leave(before)

    @property
    def time(self) -> Number:
        """The time of the current state."""
        return self._paths.outward(self._state.t)


def cut_event(event: Event, context: Any) -> Event:
    """Return an event with numbers of an mpmath context; the errors cover the cut."""
    t, x, v, theta = (+context.convert(value) for value in (event.t, event.x, event.v, event.theta))
    half = float(context.eps) / 2
    t_error, x_error = event.t_error + half * float(abs(event.t)), event.x_error + half * float(abs(event.x))
    return replace(event, t_error=t_error, x_error=x_error, t=t, x=x, v=v, theta=theta)


def rounded_event(event: Event) -> Event:
    """Return an event with floats; the errors cover the rounding."""
    if isinstance(event.t, float):
        return event
    t, x, v, theta = (float(value) for value in (event.t, event.x, event.v, event.theta))
    return with_rounding(replace(event, t=t, x=x, v=v, theta=theta))


def with_rounding(event: Event) -> Event:
    """Return an event whose numbers are rounded to floats, with errors that cover the rounding."""
    t_error, x_error = rounding_error(event.t_error, event.t), rounding_error(event.x_error, event.x)
    return replace(event, t_error=t_error, x_error=x_error)
