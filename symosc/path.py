"""A trajectory in the making: the state is advanced event by event, in one kind of arithmetic, and recorded."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from symosc.advance import CROSS, END, FAILED, GRAZE, REST, SLIP, STICK
from symosc.errors import ParameterError
from symosc.events import ROUNDING
from symosc.exact import half_unit, show
from symosc.kernels._generated import acceleration
from symosc.model import MODE_NAMES, Parameters
from symosc.numerics import Arithmetic, MpArithmetic, mp_context
from symosc.switching import BELT, DOMAIN_ABOVE
from symosc.trajectory import Event, Piece

EVENT_KINDS = {CROSS: "cross", STICK: "stick", SLIP: "slip", GRAZE: "graze"}
START_DIGITS = 50
# A motion is searched period by period: more than this many would take hours.
MOST_STRETCHES = 10**8
# Error estimates are standard errors; digits that are promised must hold.
SAFETY = 100


@dataclass(frozen=True)
class Start:
    """An exact initial value problem: parameters, start and end as Fractions."""

    parameters: Parameters
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction


@dataclass
class State:
    """The arguments of `symosc.advance.advance` between events, in its order."""

    mode: int
    at: int
    n: int
    theta: Any
    x: Any
    v: Any
    Fb: Any
    Fa: Any
    S11: Any
    S12: Any
    S22: Any

    def as_tuple(self) -> tuple[Any, ...]:
        """Return the entries in order."""
        return tuple(self.__dict__.values())


def first_state(start: Start, arithmetic: MpArithmetic) -> State:
    """Return the state at t0; on a belt the forces decide where it goes (Theorems 4 and 5).

    A start with more digits than a double was cut off somewhere (`half_unit`): it is known to half a unit of its last
    digit, and a force that is 0 to that accuracy is 0.
    """
    p, K, number = start.parameters, arithmetic.K, arithmetic.number
    resolve, context = arithmetic.namespace["resolve"], arithmetic.context
    eps = arithmetic.namespace["EPS"]
    n, theta = arithmetic.phase(start.t0)
    x, v, c, s = number(start.x0), number(start.v0), context.cos(theta), context.sin(theta)
    dt, dx, dv = (number(half_unit(value)) for value in (start.t0, start.x0, start.v0))
    A = {1: K.A1, 2: K.A2, 3: K.A3}
    at = 1 if start.v0 == p.v1 else 2 if start.v0 == p.v2 else 0
    mode = 1 if start.v0 < p.v1 else 2 if start.v0 < p.v2 else 3
    forces = [acceleration(x, v, c, A[domain], K.cm, K.w0sq, K.f0) for domain in ((at, at + 1) if at else (mode, mode))]
    size = abs(A[mode]) + abs(K.f0) + abs(K.w0sq * x) + abs(K.cm * v)
    allowed = ROUNDING * eps * size + K.w0sq * (dx + abs(v) * dt) + K.cm * dv + abs(K.fB) * dt
    if at:
        forces = [0 * force if abs(force) <= allowed else force for force in forces]
        where = resolve(v, forces[0], forces[1], s, c, K)
        mode = 3 + at if where == BELT else at + 1 if where == DOMAIN_ABOVE else at
        if where != BELT:
            forces = [forces[1] if where == DOMAIN_ABOVE else forces[0]] * 2
    rounding_x, rounding_v = eps * abs(x), eps * abs(v) * (0 if at else 1)
    S11 = (rounding_x + dx) ** 2 + (v * dt) ** 2
    S22 = (rounding_v + dv) ** 2 + (forces[0] * dt) ** 2
    return State(mode, at, n, theta, x, v, forces[0], forces[1], S11, 0 * x, S22)


class Path:
    """The states and events of one initial value problem so far, in one arithmetic.

    Attributes
    ----------
    events : list of Event
    pieces : list of Piece
    state : State
    code, decided : int, bool
        What the last step ended with, and whether that was beyond doubt (`symosc.advance`).
    first_at : int
        The belt on which the start is, or 0.
    """

    def __init__(self, start: Start, digits: int | None = None) -> None:
        self.start = start
        exact = MpArithmetic(start.parameters, digits or START_DIGITS)
        self.arithmetic: Arithmetic = exact if digits else Arithmetic(start.parameters)
        self.state = first_state(start, exact)
        self.n_end, self.theta_end = self.arithmetic.phase(start.t_end)
        self.t0 = self.arithmetic.number(start.t0)
        if not digits:
            self.state = rounded(self.state)
        self._n0, self._theta0 = self.state.n, self.state.theta
        self.K = self.arithmetic.K
        stretches = float(start.t_end - start.t0) / float(self.K.chunk)
        if stretches > MOST_STRETCHES:
            reason = f"is {stretches:.1g} forcing or free periods after t0; at most {MOST_STRETCHES:.0e} are followed"
            raise ParameterError("t_end", show(start.t_end), reason)
        self.two_pi = self.arithmetic.namespace["TWO_PI"]
        self.events: list[Event] = []
        self.pieces: list[Piece] = []
        self.code, self.decided = 0, True
        self.first_at = self.state.at
        self._worst = 0 * self.t0
        self._record()

    def missing_digits(self, digits: int) -> int:
        """Return how many of `digits` digits the least accurate event lacks (relative to max(1, |value|))."""
        if self._worst == 0:
            return 0
        context = mp_context(15)
        return int(context.ceil(context.log10(SAFETY * context.convert(self._worst)))) + digits

    @property
    def elapsed(self) -> Any:
        """Time since t0."""
        return ((self.state.n - self._n0) * self.two_pi + (self.state.theta - self._theta0)) / self.K.Om

    @property
    def ended(self) -> bool:
        """Whether the last step reached the end, a rest or a failure."""
        return self.code in (END, REST, FAILED)

    def _record(self) -> None:
        s = self.state
        a = s.Fb if s.mode <= 3 else 0.0
        self.pieces.append(Piece(s.n, float(s.theta), s.mode, float(s.x), float(s.v), float(a), float(self.elapsed)))

    def step(self) -> None:
        """Advance by one event or one stretch without events."""
        source = self.state.mode
        result = self.arithmetic.advance(*self.state.as_tuple(), self.n_end, self.theta_end, self.K)
        self.code, boundary, self.decided, t_error = result[:4]
        self.state = State(*result[4:])
        if self.code in (END, REST):
            return
        s = self.state
        self._record()
        if self.code in EVENT_KINDS:
            x_error = abs(s.v) * t_error + s.S11**0.5
            kind, names = EVENT_KINDS[self.code], (MODE_NAMES[source], MODE_NAMES[s.mode])
            self._worst = max(self._worst, t_error / max(1, abs(self.time)), x_error / max(1, abs(s.x)))
            errors = float(t_error), float(x_error)
            self.events.append(Event(self.time, s.x, s.v, s.theta, kind, boundary, *names, *errors))

    def adopt(self, other: Path) -> None:
        """Continue from where a path with more digits is, and take over what it knows better."""
        self.events[:] = [rounded_event(event) for event in other.events]
        self.pieces[:] = other.pieces
        self.state, self.code, self.decided = rounded(other.state), other.code, True

    @property
    def time(self) -> Any:
        """The time of the current state."""
        return self.t0 + self.elapsed


def cut_event(event: Event, context: Any) -> Event:
    """Return an event with numbers of an mpmath context."""
    t, x, v, theta = (+context.convert(value) for value in (event.t, event.x, event.v, event.theta))
    return replace(event, t=t, x=x, v=v, theta=theta)


def rounded(state: State) -> State:
    """Return a state in double precision, with the rounding as its error."""
    numbers = [float(value) for value in state.as_tuple()[3:8]]
    eps = 2.0**-53
    theta, x, v, Fb, Fa = numbers
    v_error = 0.0 if state.at else eps * v
    return State(state.mode, state.at, state.n, theta, x, v, Fb, Fa, (eps * x) ** 2, 0.0, v_error**2)


def rounded_event(event: Event) -> Event:
    """Return an event with floats."""
    t, x, v, theta = (float(value) for value in (event.t, event.x, event.v, event.theta))
    return replace(event, t=t, x=x, v=v, theta=theta)
