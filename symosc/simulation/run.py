"""A trajectory in the making: the state is advanced event by event, in one kind of arithmetic, and recorded."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from symosc.aliases import Number
from symosc.engine.arithmetic import Arithmetic, MpArithmetic, many_digits, mp_context
from symosc.engine.paths import Paths
from symosc.engine.rounding import rounding_error
from symosc.engine.start import Start, first_state, rounded
from symosc.engine.state import CROSS, END, FAILED, GRAZE, ON_BELT, REST, SLIP, STICK, State
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.model import MODE_NAMES
from symosc.simulation.trajectory import Event, Piece

EVENT_KINDS = {CROSS: "cross", STICK: "stick", SLIP: "slip", GRAZE: "graze"}
# A motion is searched period by period: more than this many would take hours.
MOST_PERIODS = 10**8
# Error estimates are standard errors; digits that are promised must hold.
SAFETY = 100


def last_time(start: Start, arithmetic: Arithmetic) -> tuple[Number, Number]:
    """Return t_end in two parts, or a time MOST_PERIODS after t0 if that is earlier."""
    periods = Fraction(MOST_PERIODS * 44, 7) / start.parameters.Omega  # 44/7 is a little more than 2 pi
    return arithmetic.time(min(start.t_end, start.t0 + periods))


def check_reached(start: Start, periods: int) -> None:
    """Raise ParameterError if a motion that ended after so many periods did not get to its t_end for their number."""
    if periods >= MOST_PERIODS:
        reason = f"is more than {MOST_PERIODS:.0e} forcing periods after t0 = {show(start.t0)}, more than are followed"
        raise ParameterError("t_end", show(start.t_end), reason)


class Path:
    """The states and events of one initial value problem so far, in one arithmetic.

    Parameters
    ----------
    start : Start
    arithmetic : Arithmetic or int, optional
        Or the number of digits; None: doubles.

    Attributes
    ----------
    events : list of Event
    pieces : list of Piece
    state : State
    code, decided : int, bool
        What the last step ended with, and whether that was beyond doubt (`symosc.engine.next_event`).
    first_at : int
        The belt on which the start is, or 0.
    """

    def __init__(self, start: Start, arithmetic: Arithmetic | int | None = None) -> None:
        self.start = start
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

    def _step(self, paths: Paths) -> None:
        source = self._state.mode
        self.code, boundary, self.decided, t_error, s = paths.advance(self._state, *self._end, self.K)
        self._state = s
        if self.code in (END, REST):
            return
        self._record(self._elapsed())
        if self.code in EVENT_KINDS:
            t, t_error, x_error = paths.handed_out(s.t, s.t_low, self._t0, s.x, s.v, t_error, s.S.S11, self.K)
            kind, names = EVENT_KINDS[self.code], (MODE_NAMES[source], MODE_NAMES[s.mode])
            self._worst = max(self._worst, t_error / max(1, abs(t)), x_error / max(1, abs(s.x)))
            t, x, v, theta = paths.outward((t, s.x, s.v, s.theta))
            self.events.append(Event(t, x, v, theta, kind, boundary, *names, float(t_error), float(x_error)))

    def _elapsed(self) -> Number:
        return (self._state.t - self._t0) + (self._state.t_low - self._t0_low)

    def adopt(self, other: Path) -> None:
        """Continue from where a path with more digits is, and take over what it knows better."""
        self.events[self._adopted :] = [rounded_event(event) for event in other.events[self._adopted :]]
        self._adopted = len(self.events)
        self.pieces[:] = other.pieces
        self._state, self.code, self.decided = rounded(other.state), other.code, True

    @property
    def state(self) -> State:
        """The current state."""
        return self._paths.outward(self._state)

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
    t_error, x_error = rounding_error(event.t_error, t), rounding_error(event.x_error, x)
    return replace(event, t_error=t_error, x_error=x_error, t=t, x=x, v=v, theta=theta)
