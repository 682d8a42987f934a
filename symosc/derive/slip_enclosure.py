"""A proof by intervals that the map from slip to slip is continuous between two phases."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from mpmath import MPIntervalContext

from symosc.derive.slip_map import DrivenBelt, Functions, Slip, flight_after

_INTERVALS = MPIntervalContext()
_FUNCTIONS = Functions(_INTERVALS.exp, _INTERVALS.sin, _INTERVALS.cos, _INTERVALS.sqrt)
#: Steps of a flight in a unit of time, and the longest flight that is looked at.
STEPS = 48
LONGEST = 8
#: How often a cell of phases may be halved.
DEPTH = 14


class Landing(NamedTuple):
    """Where all flights of a cell come back: enclosures of their phases and lines."""

    phase: Any
    line: Any


def is_continuous(belt: DrivenBelt, low: str, high: str, windows: int) -> bool:
    """Tell whether the next slip is proven to depend continuously on the phase from `low` to `high`.

    Both slips are downward, and the next one comes while the needed force falls for the first time
    after `windows` of its minima. All numbers are exact: fractions, or texts such as "2.5".
    """
    begin = interval(low)
    end = interval(high)
    exact_belt = DrivenBelt(*map(interval, belt))
    cells = [(_INTERVALS.mpf([begin.a, end.b]), 0)]
    while cells:
        cell, depth = cells.pop()
        landing = _landing(exact_belt, cell)
        if landing is None or not _slips(exact_belt, landing, windows):
            if depth == DEPTH:
                return False
            middle = cell.mid
            cells += [
                (_INTERVALS.mpf([cell.a, middle]), depth + 1),
                (_INTERVALS.mpf([middle, cell.b]), depth + 1),
            ]
    return True


def interval(number: Any) -> Any:
    """Return an interval that contains a number, given as a fraction or a text such as "2.5"."""
    above, _, below = str(number).partition("/")
    return _INTERVALS.mpf(above) / _INTERVALS.mpf(below or "1")


def _landing(belt: DrivenBelt, cell: Any) -> Landing | None:
    """Return where the flights after slips in a cell return; None if this is not decided.

    They fall at first, then are below the belt, then rise until they are above its speed: so each
    returns once, with a positive acceleration, and touches the belt nowhere else.
    """
    flight = flight_after(belt, Slip(cell, -1), _FUNCTIONS)
    falls = True
    begin = None
    for n in range(LONGEST * STEPS):
        step = _INTERVALS.mpf([n, n + 1]) / STEPS
        place, velocity = flight(step)
        pull = belt.drive * _INTERVALS.cos(cell + belt.frequency * step)
        rate = pull + belt.kinetic - belt.damping * velocity - place
        falls = falls and rate.b < 0
        if falls or velocity.b < belt.speed.a:
            begin = None
            continue
        if not rate.a > 0:
            return None
        if begin is None:
            begin = step.a
        if flight(_INTERVALS.mpf(step.b))[1].a > belt.speed.b:
            return _landed(belt, cell, flight, _INTERVALS.mpf([begin, step.b]))
    return None


def _landed(belt: DrivenBelt, cell: Any, flight: Any, span: Any) -> Landing:
    """Return the phases and lines of a cell's flights that return within a span of time."""
    place, velocity = flight(_INTERVALS.mpf(span.a))
    time = cell / belt.frequency + span.a
    # The line changes at the rate of the gap, which is between its value at the span's begin and 0.
    gap = velocity - belt.speed
    change = _INTERVALS.mpf([0, span.delta.b]) * _INTERVALS.mpf([min(gap.a, 0), 0])
    line = place - belt.speed * time + change
    return Landing(cell + belt.frequency * span, line)


def _slips(belt: DrivenBelt, landing: Landing, windows: int) -> bool:
    """Tell whether all sticks of a cell are held until they slip downward in the same window."""
    level = landing.line + belt.damping * belt.speed
    lowest = level - belt.holding
    highest = level + belt.holding

    def force(phase: Any) -> Any:
        return belt.drive * _INTERVALS.cos(phase) - belt.speed * phase / belt.frequency

    here = force(landing.phase)
    if not (here.a > lowest.b and here.b < highest.a):
        return False
    turn = 2 * _INTERVALS.pi
    # sin(lag) = V/(B0 Omega): the force is lowest at pi + lag, highest at 2 pi - lag
    lag = _arcsine(belt.speed / (belt.drive * belt.frequency))
    first = (landing.phase - _INTERVALS.pi - lag) / turn
    count = math.ceil(float(first.a))
    minima = [_INTERVALS.pi + lag + turn * (count + n) for n in range(windows + 1)]
    if not (landing.phase.b < minima[0].a and landing.phase.a > minima[0].b - turn.b):
        return False
    maxima = [2 * _INTERVALS.pi - lag + turn * (count - 1 + n) for n in range(windows + 1)]
    held = all(force(at).a > lowest.b for at in minima[:-1])
    kept = all(force(at).b < highest.a for at in maxima)
    return held and kept and force(minima[-1]).b < lowest.a


def _arcsine(value: Any) -> Any:
    """Return an enclosure of the arc sine of a small positive number, checked by its sine."""
    middle = math.asin(float(value.mid))
    wide = _INTERVALS.mpf([middle - 1e-9, middle + 1e-9])
    below = _INTERVALS.sin(_INTERVALS.mpf(wide.a))
    above = _INTERVALS.sin(_INTERVALS.mpf(wide.b))
    if not (below.b < value.a and value.b < above.a):
        raise ValueError("the arc sine is not enclosed")
    return wide
