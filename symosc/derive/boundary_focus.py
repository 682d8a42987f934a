"""The cycle that is born at a corner of a friction curve, from closed forms and from Taylor series."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from symosc.derive.chapters.static_friction import bisected
from symosc.derive.steps import CONTEXT

#: Dampings below and above the corner, with m = k = 1 and the corner at the velocity 1.
FOCUS = (CONTEXT.mpf(1) / 10, -CONTEXT.mpf(3) / 10)
#: Terms of a Taylor series, and its steps in time: 0.25^60 is below all digits.
TERMS = 60
STRIDE = CONTEXT.mpf("0.25")


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


def _series(damping: Any, speed: Any, rate: Any) -> list[Any]:
    """Return the Taylor coefficients of the velocity, from the differential equation."""
    terms = [speed, rate]
    for n in range(TERMS):
        terms.append(-(damping * (n + 1) * terms[-1] + terms[-2]) / ((n + 1) * (n + 2)))
    return terms


def _summed(terms: list[Any], time: Any) -> tuple[Any, Any]:
    """Return the value of a Taylor series and of its derivative."""
    value = CONTEXT.mpf(0)
    rate = CONTEXT.mpf(0)
    for term in reversed(terms):
        rate = rate * time + value
        value = value * time + term
    return value, rate


def _first(damping: Any, rate: Any, has_passed: Callable[[Any, Any], bool]) -> tuple[Any, Any, Any]:
    """Return time, velocity and rate when a condition on velocity and rate becomes true.

    The motion begins with the velocity 1; it is followed by Taylor series.
    """
    begin = CONTEXT.mpf(0)
    terms = _series(damping, CONTEXT.mpf(1), rate)
    ahead = _summed(terms, STRIDE)
    while not has_passed(*ahead):
        begin += STRIDE
        terms = _series(damping, *ahead)
        ahead = _summed(terms, STRIDE)

    def is_before(time: Any) -> bool:
        return not has_passed(*_summed(terms, time))

    inside = bisected(is_before, 0, STRIDE)
    return (begin + inside, *_summed(terms, inside))


def _turn(rate: Any) -> tuple[Any, Any, Any]:
    """Return the times above and below the corner, and the rate after one turn."""
    lower, upper = FOCUS
    above, _, turned = _first(upper, rate, lambda speed, rate: speed < 1)
    below, _, back = _first(lower, turned, lambda speed, rate: speed > 1)
    return above, below, back


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
    _, top, _ = _first(FOCUS[1], start, lambda speed, rate: rate < 0)
    small = CONTEXT.mpf(10) ** -15
    factor = (_turn(start + small)[2] - _turn(start - small)[2]) / (2 * small)
    return FocusCycle(start, (above, below), top, factor)
