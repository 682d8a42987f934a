"""The cycle that is born at a corner of a friction curve, from closed forms and from Taylor series."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

from symosc.derive.steps import CONTEXT
from symosc.derive.taylor import LinearEquation, TimedState, first_pass

#: Dampings below and above the corner, with m = k = 1 and the corner at the velocity 1.
FOCUS = (CONTEXT.mpf(1) / 10, -CONTEXT.mpf(3) / 10)


class FocusCycle(NamedTuple):
    """The cycle around a boundary focus, in units of the distance d of the corner.

    `start` is the acceleration at the corner, upward, and `times` those above and below it.
    """

    start: Any
    times: tuple[Any, Any]
    top: Any
    factor: Any


def _closed(damping: Any, start: Any, time: Any) -> tuple[Any, Any]:
    """Return the velocity and its rate after a time, from the velocity 1 and a rate `start`, by the
    closed form.
    """
    decay = damping / 2
    turn = CONTEXT.sqrt(1 - decay**2)
    wave = CONTEXT.cos(turn * time)
    slope = CONTEXT.sin(turn * time) / turn
    size = CONTEXT.exp(-decay * time)
    speed = size * (wave + (start + decay) * slope)
    rate = size * (start * wave - (1 + decay * start) * slope)
    return speed, rate


@cache
def focus_by_closed_forms() -> FocusCycle:
    """Return the cycle from the equations of both closed forms, by Newton's method."""
    lower, upper = FOCUS

    def closing(start: Any, above: Any, below: Any) -> tuple[Any, Any, Any]:
        speed, turned = _closed(upper, start, above)
        back, rate = _closed(lower, turned, below)
        return speed - 1, back - 1, rate - start

    solver = CONTEXT.clone()  # it changes its precision on the way
    start, above, below = solver.findroot(closing, (2, "2.3", 4))
    highest = solver.findroot(lambda time: _closed(upper, start, time)[1], "1.1")
    factor = CONTEXT.exp(-(lower * below + upper * above))
    return FocusCycle(start, (above, below), _closed(upper, start, highest)[0], factor)


def _turn(rate: Any) -> tuple[Any, Any, Any]:
    """Return the times above and below the corner, and the rate after one turn, by Taylor series."""
    lower, upper = (LinearEquation(damping, 1) for damping in FOCUS)
    above = first_pass(upper, TimedState(0, CONTEXT.mpf(1), rate), lambda speed, rate: speed < 1)
    begin = TimedState(0, CONTEXT.mpf(1), above.rate)
    below = first_pass(lower, begin, lambda speed, rate: speed > 1)
    return above.time, below.time, below.rate


@cache
def focus_by_series() -> FocusCycle:
    """Return the cycle as the fixed point of a turn, with the multiplier from differences."""
    rates = [CONTEXT.mpf("1.9"), CONTEXT.mpf(2)]
    misses = [_turn(rate)[2] - rate for rate in rates]
    while abs(rates[1] - rates[0]) > CONTEXT.mpf(10) ** -40:
        slope = (misses[1] - misses[0]) / (rates[1] - rates[0])
        rates = [rates[1], rates[1] - misses[1] / slope]
        misses = [misses[1], _turn(rates[1])[2] - rates[1]]
    start = rates[1]
    above, below, _ = _turn(start)
    begin = TimedState(0, CONTEXT.mpf(1), start)
    top = first_pass(LinearEquation(FOCUS[1], 1), begin, lambda speed, rate: rate < 0).value
    small = CONTEXT.mpf(10) ** -15
    factor = (_turn(start + small)[2] - _turn(start - small)[2]) / (2 * small)
    return FocusCycle(start, (above, below), top, factor)
