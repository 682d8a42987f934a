"""The extremes of position and velocity along a flight, its stationary points included.

A cell of a flight lies within the extremes that are known if the bounds of `symosc.engine.gap_bounds`, taken at both of
its ends, say so: v and x minus an extreme are gaps like those to a belt. A cell of which that cannot be said is cut, at
a stationary point where there is one between its ends, and each new end is evaluated exactly. So no extreme is missed,
and what a flight cannot widen costs one evaluation or none.

All functions are scalar and run on floats (CPython, numba).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from symosc.engine.first_exit import shifted
from symosc.engine.flow import derivatives, state_at
from symosc.engine.gap_bounds import NEAR, fourth_derivative_bound, positive_on
from symosc.engine.state import Flown
from symosc.kernels.entire import EPS, SIXTH

# How far beyond an extreme a bound may be, as a part of the extremes' size: some units in the last place.
WIDTH_SLACK = 16.0 * EPS
# The first cell of a flight, times 1/rate, and the shortest: there nothing can be hidden.
FIRST_CELL, SHORTEST_CELL = 3.0, 1e-6
MOST_CELLS = 100_000
MOST_STATIONARY_STEPS = 8
# How far from the ends of a cell a place to cut is at least, as a part of it.
CUT_AWAY = 1e-3


class Extremes(NamedTuple):
    """The smallest and the largest position and velocity so far."""

    x_min: float
    x_max: float
    v_min: float
    v_max: float


def widened(seen, x, v):
    """Return extremes that include a point."""
    return Extremes(
        x if x < seen.x_min else seen.x_min,
        x if x > seen.x_max else seen.x_max,
        v if v < seen.v_min else seen.v_min,
        v if v > seen.v_max else seen.v_max,
    )


def flight_extremes(begin, last, start, x0, seen, K):
    """Return extremes that include a flight, whose ends they include already.

    Parameters
    ----------
    begin : time after the launch from which on it counts.
    last : Flown
        Its end.
    start : Launch
    x0 : position at the launch.
    seen : Extremes
    K : Constants
    """
    now, end = point_at(begin, start, K), last.tau
    cell = FIRST_CELL * K.moment
    for _ in range(MOST_CELLS):
        if now.tau >= end:
            break
        M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
        left = end - now.tau
        cell = 1.0 / K.Om if not K.steady and cell * K.Om > 1.0 else cell
        then = last
        if cell < left:
            then = state_at(now.tau + cell, start, K)
            seen = widened(seen, x0 + then.dx, start.v + then.dv)
        cut = False
        while (then.tau - now.tau) * K.rate > SHORTEST_CELL and not covered(now, then, M4, start.v, x0, seen):
            then, cut = cut_at(now, then, start, K), True
            seen = widened(seen, x0 + then.dx, start.v + then.dv)
        cell = FIRST_CELL * K.moment if cut or cell < FIRST_CELL * K.moment else 2.0 * cell
        now = then
    return seen


def point_at(tau, start, K):
    """Return the flight at `tau`, or at its launch."""
    if tau > 0.0:
        return state_at(tau, start, K)
    G1, G2, G3 = derivatives(start.v, start.F, start.s, start.c, K)
    return Flown(0.0, 0.0, 0.0, start.F, G1, G2, G3, start.s, start.c, 1.0, 0.0, 0.0)


def covered(now, then, M4, v0, x0, seen):
    """Return whether a cell lies within the extremes: one half seen from its beginning, the other from its end."""
    half = 0.5 * (then.tau - now.tau)
    return within(half, 1.0, now, M4, v0, x0, seen) and within(half, -1.0, then, M4, v0, x0, seen)


def within(reach, way, now, M4, v0, x0, seen):
    """Return whether a flight stays within the extremes for the time `reach` after a point, or before it (way -1)."""
    v, x = v0 + now.dv, x0 + now.dx
    slack = WIDTH_SLACK * (abs(seen.v_min) + abs(seen.v_max))
    half, third, fourth = 0.5 * now.G1, way * SIXTH * now.G2, -0.25 * SIXTH * M4
    slope = way * now.F
    if not (
        stays_positive(reach, seen.v_max - v + slack, -slope, -half, -third, fourth)
        and stays_positive(reach, v - seen.v_min + slack, slope, half, third, fourth)
    ):
        return False
    slack = WIDTH_SLACK * (abs(seen.x_min) + abs(seen.x_max))
    M3 = abs(now.G2) + (abs(now.G3) + 0.5 * M4 * reach) * reach
    slope, half, third, fourth = way * v, 0.5 * now.F, way * SIXTH * now.G1, -0.25 * SIXTH * M3
    return stays_positive(reach, seen.x_max - x + slack, -slope, -half, -third, fourth) and stays_positive(
        reach, x - seen.x_min + slack, slope, half, third, fourth
    )


def stays_positive(reach, p0, p1, p2, p3, p4):
    """Return whether p0 + p1 s + ... + p4 s^4 > 0 on [0, reach]: `positive_on`, which does not see a shallow dip."""
    if p1 < 0.0 and p2 > 0.0 and p1 * p1 < 2.0 * p0 * p2:  # p1 s + p2 s^2/2 is not below -p1^2/(2 p2)
        return positive_on(reach, p0 - 0.5 * p1 * p1 / p2, 0.0, 0.5 * p2, p3, p4)
    return positive_on(reach, p0, p1, p2, p3, p4)


def cut_at(now, then, start, K):
    """Return a point between two: where the acceleration is 0, or the velocity, or the middle."""
    width = then.tau - now.tau
    for of_v in (True, False):
        if of_v:
            first, rise, last, rise_last = now.F, now.G1, then.F, then.G1
        else:
            first, rise, last, rise_last = start.v + now.dv, now.F, start.v + then.dv, then.F
        # A stationary point at an end is known, and no place to cut.
        at_end = abs(first) <= CUT_AWAY * abs(rise) * width or abs(last) <= CUT_AWAY * abs(rise_last) * width
        if first * last < 0.0 and not at_end:
            here = stationary(now, then, of_v, start, K)
            if now.tau < here.tau < then.tau:
                return here
    return state_at(0.5 * (now.tau + then.tau), start, K)


def stationary(now, then, of_v, start, K):
    """Return the point between two where v is stationary, or x: by Halley's method, and a short shift at the end."""
    low, high, width = now.tau, then.tau, then.tau - now.tau
    if of_v:
        first, rise, last = now.F, now.G1, then.F
    else:
        first, rise, last = start.v + now.dv, now.F, start.v + then.dv
    tau = low + parabola_root(first, rise, last, width)
    here = now
    for _ in range(MOST_STATIONARY_STEPS):
        here = state_at(tau, start, K)
        if of_v:
            value, slope, bend = here.F, here.G1, here.G2
        else:
            value, slope, bend = start.v + here.dv, here.F, here.G1
        if (value < 0.0) == (first < 0.0):
            low = tau
        else:
            high = tau
        square = slope * slope - 0.5 * value * bend
        shift = -value * slope / square if square > 0.0 else 2.0 * width
        if abs(shift) * K.rate < NEAR:  # the extreme is off by the square of what is missing
            return moved(here, shift, start.v, K)
        tau = tau + shift
        if not low < tau < high:
            tau = 0.5 * (low + high)
    return here


def moved(here, shift, v0, K):
    """Return a point of a flight moved by so short a time that Taylor's formula has full precision, v included."""
    dv = here.dv + (here.F + (0.5 * here.G1 + SIXTH * here.G2 * shift) * shift) * shift
    there = shifted(here, shift, v0, K)
    G1, G2 = here.G1 + here.G2 * shift, here.G2 + here.G3 * shift
    s, c, E0, E1, E2 = there.s, there.c, there.E0, there.E1, there.E2
    return Flown(there.tau, there.dx, dv, there.F, G1, G2, here.G3, s, c, E0, E1, E2)


def parabola_root(f0, slope, f1, width):
    """Return the root in (0, width) of the parabola with f0 and a slope at 0 and f1, of the other sign, at `width`."""
    bend = (f1 - f0 - slope * width) / (width * width)
    square = slope * slope - 4.0 * bend * f0
    root = sqrt(square) if square > 0.0 else 0.0
    sign = 1.0 if f1 > 0.0 else -1.0
    below = slope + sign * root
    tau = -2.0 * f0 / below if below != 0.0 else 0.5 * width
    return tau if 0.0 < tau < width else 0.5 * width
