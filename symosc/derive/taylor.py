"""Motions by Taylor series of their differential equation: what closed forms are compared with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from symosc.derive.steps import CONTEXT

#: Terms of a series, and its steps in time: 0.25^60 is below all digits.
TERMS = 60
STRIDE = CONTEXT.mpf("0.25")
HALVINGS = 150


class LinearEquation(NamedTuple):
    """The equation y'' + damping y' + stiffness y = constant + drive cos(phase), with the rate
    `frequency` of the phase.
    """

    damping: Any
    stiffness: Any
    constant: Any = 0
    drive: Any = 0
    frequency: Any = 0


class TimedState(NamedTuple):
    """A time with the value of y, its rate, and the phase of the drive."""

    time: Any
    value: Any
    rate: Any
    phase: Any = 0


def bisected(
    is_before: Callable[[Any], bool], low: Any, high: Any, halvings: int = HALVINGS
) -> Any:
    """Return where `is_before` changes from true to false, between two numbers."""
    before = CONTEXT.mpf(low)
    behind = CONTEXT.mpf(high)
    for _ in range(halvings):
        middle = (before + behind) / 2
        if is_before(middle):
            before = middle
        else:
            behind = middle
    return before


def series(equation: LinearEquation, begin: TimedState) -> list[Any]:
    """Return the Taylor coefficients of y, by the differential equation."""
    cosine = CONTEXT.cos(begin.phase)
    sine = CONTEXT.sin(begin.phase)
    waves = (cosine, -sine, -cosine, sine)
    scale = CONTEXT.mpf(equation.drive)
    terms = [begin.value, begin.rate]
    for n in range(TERMS):
        force = scale * waves[n % 4]
        if n == 0:
            force += equation.constant
        held = equation.damping * (n + 1) * terms[-1] + equation.stiffness * terms[-2]
        terms.append((force - held) / ((n + 1) * (n + 2)))
        scale = scale * equation.frequency / (n + 1)
    return terms


def summed(terms: list[Any], time: Any) -> tuple[Any, Any]:
    """Return the value of a Taylor series and of its derivative."""
    value = CONTEXT.mpf(0)
    rate = CONTEXT.mpf(0)
    for term in reversed(terms):
        rate = rate * time + value
        value = value * time + term
    return value, rate


def first_pass(
    equation: LinearEquation, begin: TimedState, has_passed: Callable[[Any, Any], bool]
) -> TimedState:
    """Return the instant at which a condition on value and rate becomes true.

    It is looked at after each step, so it has to stay true for longer than that.
    """
    here = begin
    terms = series(equation, here)
    ahead = summed(terms, STRIDE)
    while not has_passed(*ahead):
        here = _later(equation, here, STRIDE, ahead)
        terms = series(equation, here)
        ahead = summed(terms, STRIDE)
    inside = bisected(lambda time: not has_passed(*summed(terms, time)), 0, STRIDE)
    return _later(equation, here, inside, summed(terms, inside))


def after(equation: LinearEquation, begin: TimedState, duration: Any) -> TimedState:
    """Return the instant after a duration, of either sign."""
    steps = int(abs(duration) / STRIDE) + 1
    stride = duration / steps
    here = begin
    for _ in range(steps):
        here = _later(equation, here, stride, summed(series(equation, here), stride))
    return here


def _later(
    equation: LinearEquation, here: TimedState, span: Any, state: tuple[Any, Any]
) -> TimedState:
    value, rate = state
    return TimedState(here.time + span, value, rate, here.phase + equation.frequency * span)
