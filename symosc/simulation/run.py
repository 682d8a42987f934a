"""A trajectory in the making: the state is advanced event by event, in one kind of arithmetic, and recorded."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from symosc.aliases import Number
from symosc.engine.arithmetic import Arithmetic, MpArithmetic, mp_context
from symosc.engine.start import Start, first_state, rounded
from symosc.engine.state import CROSS, END, FAILED, GRAZE, ON_BELT, REST, SLIP, STICK
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

    def __init__(self, start: Start, digits: int | None = None) -> None:
        self.start = start
        self.arithmetic: Arithmetic = MpArithmetic(start.parameters, digits) if digits else Arithmetic(start.parameters)
        self.K = self.arithmetic.K
        number = self.arithmetic.number
        if digits and start.start_error:  # rounding is far below the error of the start, which is no standard error
            self.K = self.K._replace(sigmas=number(Fraction(1)))
        self.state = first_state(start, self.arithmetic)
        self.end = last_time(start, self.arithmetic)
        self.t0, self.t0_low = self.state.t, self.state.t_low
        self.events: list[Event] = []
        self.pieces: list[Piece] = []
        self.code, self.decided = 0, True
        self.first_at = self.state.at
        self._worst, self._adopted = 0 * self.t0, 0
        self._record()

    def missing_digits(self, digits: int) -> int:
        """Return how many of `digits` digits the least accurate event lacks (relative to max(1, |value|))."""
        if self._worst == 0:
            return 0
        context = mp_context(15)
        return int(context.ceil(context.log10(SAFETY * context.convert(self._worst)))) + digits

    @property
    def ended(self) -> bool:
        """Whether the last step reached the end, a rest or a failure."""
        return self.code in (END, REST, FAILED)

    def _record(self) -> None:
        s = self.state
        a = s.Fb if s.mode <= ON_BELT else 0.0
        self.pieces.append(Piece(s.n, float(s.theta), s.mode, float(s.x), float(s.v), float(a), float(self.elapsed)))

    def step(self) -> None:
        """Advance by one event or one stretch without events."""
        source = self.state.mode
        self.code, boundary, self.decided, t_error, self.state = self.arithmetic.advance(self.state, *self.end, self.K)
        if self.code in (END, REST):
            return
        s = self.state
        self._record()
        if self.code in EVENT_KINDS:
            handed_out = self.arithmetic.namespace["handed_out"]
            t, t_error, x_error = handed_out(s.t, s.t_low, self.t0, s.x, s.v, t_error, s.S.S11, self.K)
            kind, names = EVENT_KINDS[self.code], (MODE_NAMES[source], MODE_NAMES[s.mode])
            self._worst = max(self._worst, t_error / max(1, abs(t)), x_error / max(1, abs(s.x)))
            self.events.append(Event(t, s.x, s.v, s.theta, kind, boundary, *names, float(t_error), float(x_error)))

    def adopt(self, other: Path) -> None:
        """Continue from where a path with more digits is, and take over what it knows better."""
        self.events[self._adopted :] = [rounded_event(event) for event in other.events[self._adopted :]]
        self._adopted = len(self.events)
        self.pieces[:] = other.pieces
        self.state, self.code, self.decided = rounded(other.state), other.code, True

    @property
    def elapsed(self) -> Number:
        """Time since t0."""
        return (self.state.t - self.t0) + (self.state.t_low - self.t0_low)

    @property
    def time(self) -> Number:
        """The time of the current state."""
        return self.state.t


def cut_event(event: Event, context: Any) -> Event:
    """Return an event with numbers of an mpmath context; the errors cover the cut."""
    t, x, v, theta = (+context.convert(value) for value in (event.t, event.x, event.v, event.theta))
    return _with_rounding(event, float(context.eps) / 2, t=t, x=x, v=v, theta=theta)


def rounded_event(event: Event) -> Event:
    """Return an event with floats; the errors cover the rounding."""
    if isinstance(event.t, float):
        return event
    t, x, v, theta = (float(value) for value in (event.t, event.x, event.v, event.theta))
    return _with_rounding(event, 2.0**-53, t=t, x=x, v=v, theta=theta)


def _with_rounding(event: Event, eps: float, **numbers: Any) -> Event:
    t_error, x_error = event.t_error + eps * float(abs(event.t)), event.x_error + eps * float(abs(event.x))
    return replace(event, t_error=t_error, x_error=x_error, **numbers)
