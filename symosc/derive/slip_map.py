"""The map from slip to slip of a driven mass on one belt, by closed forms and by Taylor series."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from symosc.derive.steps import CONTEXT, number
from symosc.derive.taylor import LinearEquation, TimedState, bisected, first_pass

#: How far the search for a slip or a return looks at once, in doubles, and its halvings.
STRIDE = 1 / 64
HALVINGS = 30
#: Newton's steps from a double's accuracy to 60 digits.
REFINEMENTS = 4


class DrivenBelt(NamedTuple):
    """A mass with m = k = 1 on one belt: damping, speed, kinetic and static friction, drive."""

    damping: Any
    speed: Any
    kinetic: Any
    holding: Any
    drive: Any
    frequency: Any


def in_digits(belt: DrivenBelt) -> DrivenBelt:
    """Return a belt whose numbers are fractions with numbers of 60 digits."""
    return DrivenBelt(*map(number, belt))


class Slip(NamedTuple):
    """A slip: the phase of the drive, and its side, 1 upward and -1 downward."""

    phase: Any
    side: int


class Arrival(NamedTuple):
    """The end of a flight: duration, place and phase, and the factor of a small change of place."""

    duration: Any
    place: Any
    phase: Any
    growth: Any


class Functions(NamedTuple):
    """The functions of one arithmetic: of doubles, or of 60 digits."""

    exp: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    sqrt: Callable[[Any], Any]


_DOUBLES = Functions(math.exp, math.sin, math.cos, math.sqrt)
_DIGITS = Functions(CONTEXT.exp, CONTEXT.sin, CONTEXT.cos, CONTEXT.sqrt)


def slope(belt: DrivenBelt, phase: Any) -> Any:
    """Return k V + B0 Omega sin(phase), by which the needed force falls in a unit of time."""
    return belt.speed + belt.drive * belt.frequency * CONTEXT.sin(phase)


def place_of(belt: DrivenBelt, slip: Slip) -> Any:
    """Return the position of a slip, where the needed force is the static limit."""
    pull = belt.drive * CONTEXT.cos(slip.phase) - belt.damping * belt.speed
    return pull - slip.side * belt.holding


def _decayed(belt: DrivenBelt, time: Any, functions: Functions) -> tuple[Any, Any, Any]:
    """Return E0, E1 and E2 of a flight."""
    decay = belt.damping / 2
    turn = functions.sqrt(1 - decay**2)
    size = functions.exp(-decay * time)
    impulse = size * functions.sin(turn * time) / turn
    rate = size * functions.cos(turn * time) - decay * impulse
    return rate, impulse, 1 - rate - belt.damping * impulse


def flight_after(belt: DrivenBelt, slip: Slip, functions: Functions) -> Callable[[Any], Any]:
    """Return the position and the velocity of the flight after a slip as a function of time."""
    force = -slip.side * belt.kinetic
    stiff = 1 - belt.frequency**2
    loss = belt.damping * belt.frequency
    size = stiff**2 + loss**2
    even = belt.drive * stiff / size
    odd = belt.drive * loss / size

    def steady(phase: Any) -> tuple[Any, Any]:
        cosine = functions.cos(phase)
        sine = functions.sin(phase)
        rate = belt.frequency * (odd * cosine - even * sine)
        return force + even * cosine + odd * sine, rate

    phase = slip.phase
    pull = belt.drive * functions.cos(phase) - belt.damping * belt.speed
    base, base_rate = steady(phase)
    gap = pull - slip.side * belt.holding - base
    gap_rate = belt.speed - base_rate

    def motion(time: Any) -> tuple[Any, Any]:
        rate, impulse, area = _decayed(belt, time, functions)
        center, center_rate = steady(phase + belt.frequency * time)
        place = center + gap * (1 - area) + gap_rate * impulse
        return place, center_rate - gap * impulse + gap_rate * rate

    return motion


def _crossing(value: Callable[[float], float]) -> float:
    """Return where a function of time that begins negative first becomes positive, in doubles."""
    time = STRIDE
    while value(time) < 0:
        time += STRIDE
    low = time - STRIDE
    high = time
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if value(middle) < 0:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _in_doubles(belt: DrivenBelt) -> DrivenBelt:
    return DrivenBelt(*map(float, belt))


def arrival(belt: DrivenBelt, slip: Slip) -> Arrival:
    """Return where the flight after a slip comes back to the belt, which has to hold it there."""
    rough = flight_after(_in_doubles(belt), Slip(float(slip.phase), slip.side), _DOUBLES)
    speed = float(belt.speed)
    time = CONTEXT.mpf(_crossing(lambda tau: -slip.side * (rough(tau)[1] - speed) - 1e-300))
    flight = flight_after(belt, slip, _DIGITS)
    for _ in range(REFINEMENTS):
        place, velocity = flight(time)
        pull = belt.drive * CONTEXT.cos(slip.phase + belt.frequency * time)
        rate = pull - slip.side * belt.kinetic - belt.damping * velocity - place
        time -= (velocity - belt.speed) / rate
    place, _ = flight(time)
    _, impulse, area = _decayed(belt, time, _DIGITS)
    kick = slip.side * (belt.holding - belt.kinetic) / slope(belt, slip.phase)
    return Arrival(time, place, slip.phase + belt.frequency * time, 1 - area + impulse * kick)


class MapStep(NamedTuple):
    """From a slip to the next one: that slip, and the factor of a small change of the line."""

    slip: Slip
    growth: Any


def needed_level(belt: DrivenBelt, phase: Any) -> Any:
    """Return B0 cos(phase) - V phase/Omega: on one line of the belt the needed force follows it."""
    return belt.drive * CONTEXT.cos(phase) - belt.speed * phase / belt.frequency


def line_of(belt: DrivenBelt, place: Any, phase: Any) -> Any:
    """Return x - V t of a position on the belt."""
    return place - belt.speed * phase / belt.frequency


def turns_after(belt: DrivenBelt, phase: Any) -> Iterator[Any]:
    """Yield the phases after a given one at which the needed force of a stick turns."""
    lag = CONTEXT.asin(belt.speed / (belt.drive * belt.frequency))
    half = CONTEXT.ceil((phase - CONTEXT.pi - lag) / CONTEXT.pi)
    while True:
        # the force is lowest at pi + lag and highest at 2 pi - lag, modulo 2 pi
        even = int(half) % 2 == 0
        turn = CONTEXT.pi * (half + 1) + (lag if even else -lag)
        if turn > phase:
            yield turn
        half += 1


def slip_after(belt: DrivenBelt, line: Any, phase: Any) -> Slip:
    """Return the slip at which a stick ends that is on a line of the belt at a phase."""
    begin = phase
    for end in turns_after(belt, phase):
        falls = needed_level(belt, end) < needed_level(belt, begin)
        side = -1 if falls else 1
        limit = line + belt.damping * belt.speed + side * belt.holding
        if side * (needed_level(belt, end) - limit) > 0:
            return Slip(_reached(belt, limit, side, (begin, end)), side)
        begin = end
    raise AssertionError("the force turns for ever")


def _reached(belt: DrivenBelt, limit: Any, side: int, span: tuple[Any, Any]) -> Any:
    """Return the phase at which the needed force reaches its limit, in a span in which it does."""

    def is_before(at: Any) -> bool:
        return bool(side * (needed_level(belt, at) - limit) < 0)

    # 40 halvings leave a place from which Newton's steps converge, unless the force turns there.
    phase = bisected(is_before, *span, halvings=40)
    for _ in range(REFINEMENTS):
        rate = -belt.drive * CONTEXT.sin(phase) - belt.speed / belt.frequency
        phase -= (needed_level(belt, phase) - limit) / rate
    if abs(needed_level(belt, phase) - limit) > CONTEXT.mpf(10) ** -50:
        return bisected(is_before, *span)
    return phase


def next_slip(belt: DrivenBelt, slip: Slip) -> MapStep:
    """Return the next slip by closed forms, with the derivative of the line by the line."""
    landed = arrival(belt, slip)
    line = line_of(belt, landed.place, landed.phase)
    held = needed_level(belt, landed.phase) - line - belt.damping * belt.speed
    if abs(held) > belt.holding:
        raise ValueError("the mass passes the belt")
    return MapStep(slip_after(belt, line, landed.phase), landed.growth)


def by_phase(belt: DrivenBelt, slip: Slip) -> tuple[Slip, Any]:
    """Return the next slip and the derivative of its phase by the phase."""
    step = next_slip(belt, slip)
    return step.slip, step.growth * slope(belt, slip.phase) / slope(belt, step.slip.phase)


def next_by_series(belt: DrivenBelt, slip: Slip) -> Slip:
    """Return the next slip by Taylor series of the equation of motion, and by the balance of forces."""
    equation = LinearEquation(
        belt.damping, 1, -slip.side * belt.kinetic, belt.drive, belt.frequency
    )
    begin = TimedState(0, place_of(belt, slip), belt.speed, slip.phase)
    landed = first_pass(
        equation, begin, lambda _, velocity: -slip.side * (velocity - belt.speed) > 0
    )

    def force(time: Any) -> Any:
        pull = belt.drive * CONTEXT.cos(landed.phase + belt.frequency * time)
        return pull - landed.value - belt.speed * (time + belt.damping)

    time = CONTEXT.mpf(0)
    while abs(force(time)) < belt.holding:
        time += STRIDE
    end = bisected(lambda at: abs(force(at)) < belt.holding, time - STRIDE, time)
    return Slip(landed.phase + belt.frequency * end, 1 if force(end) > 0 else -1)


def derivative_by_series(belt: DrivenBelt, slip: Slip) -> Any:
    """Return the derivative of the next phase by the phase as a difference of two motions."""
    small = CONTEXT.mpf(10) ** -18
    ends = [
        next_by_series(belt, Slip(slip.phase + part * small, slip.side)).phase for part in (1, -1)
    ]
    return (ends[0] - ends[1]) / (2 * small)
