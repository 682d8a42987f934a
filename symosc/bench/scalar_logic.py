"""The event logic of `event_logic` in scalars only, so that numba can compile it together with a solver.

A solver gives `follow` a function ``leave(q, s, mode, t, x, v, t_end)``, which follows one flight or stick and returns
(side, t, x). The side is -1 or +1 where it was left, 0 where it lasts until t_end, and UNSOLVED where the solver gave
up. Its clock starts anew with each flight and stick, and the phase at t = 0 is in `Scalars`. Otherwise, after many
periods, the rounding of Omega t would be more than a fine tolerance allows, and steps would shrink to nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, inf, sin
from typing import Any, NamedTuple

import numpy as np

from symosc.aliases import Record
from symosc.bench.event_logic import CHATTER, Motion, PeerError
from symosc.bench.solvers import Late
from symosc.engine.events import KIND_NAMES
from symosc.engine.next_event import CROSS, GRAZE, SLIP, STICK, TWO_PI
from symosc.model import MODE_NAMES
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene

UNSOLVED = 2
CHATTERS, GAVE_UP = 1, 2
#: One-step methods start flights from a belt this part of the larger belt speed off it, a few units in the last place:
#: from the belt itself, some flights come back at once for ever, and errors after a near graze are in proportion.
ONE_STEP_OFFSET = 1e-15
FIRST_ROWS = 64
# A root is refined until its bracket is within this part of its time.
LAST_BIT = 2.0**-52

#: What a solver's module defines under these names, and `bind` puts in their place: ``leave`` as above, and
#: ``margin(q, mode, side, piece, tau)``, how far a flight or stick is from being left on one side after the time tau.
leave: Any = None
margin: Any = None


class Scalars(NamedTuple):
    """A parameter set: eq. (9) per mass, belt speeds, the shorter period (`Motion.period`) and the phase at t = 0."""

    A1: float
    A2: float
    A3: float
    swing: float
    Omega: float
    stiffness: float
    damping: float
    v1: float
    v2: float
    period: float
    theta: float


def scalars(motion: Motion) -> Scalars:
    """Return a parameter set as scalars; t = 0 is the motion's origin."""
    m, A = motion.m, motion.A
    per_mass = (A[1] / m, A[2] / m, A[3] / m, motion.B0 / m, motion.Omega, motion.k / m, motion.c / m)
    return Scalars(*per_mass, motion.belts[1], motion.belts[2], motion.period, motion.theta)


def from_now(q, t):
    """Return the parameter set with a clock that is 0 at t."""
    theta = (q.theta + q.Omega * t) % TWO_PI
    return Scalars(q.A1, q.A2, q.A3, q.swing, q.Omega, q.stiffness, q.damping, q.v1, q.v2, q.period, theta)


def force(q, alpha, t, x, v):
    """Return F^(alpha), the acceleration in a domain."""
    A = q.A1 if alpha == 1 else q.A2 if alpha == 2 else q.A3
    return A + q.swing * cos(q.Omega * t + q.theta) - q.stiffness * x - q.damping * v


def margins(q, mode, t, x, v):
    """Return how far a mode is from being left downward and upward: positive inside."""
    if mode == 1:
        return inf, q.v1 - v
    if mode == 2:
        return v - q.v1, q.v2 - v
    if mode == 3:
        return v - q.v2, inf
    above = force(q, mode - 2, t, x, v)
    return above + (q.A1 - q.A2 if mode == 4 else q.A2 - q.A3), -above


def turn(q, mode, t, x, v):
    """Return the time derivative of the margins, up to its sign."""
    if mode < 4:
        return force(q, mode, t, x, v)
    return q.swing * q.Omega * sin(q.Omega * t + q.theta) + q.stiffness * v


def resolve(q, boundary, t, x):
    """Return the mode that follows at a point of a boundary (Theorems 4 and 5)."""
    v = q.v1 if boundary == 1 else q.v2
    if force(q, boundary + 1, t, x, v) > 0.0:
        return boundary + 1
    if force(q, boundary, t, x, v) < 0.0:
        return boundary
    return 3 + boundary


def root(q, mode, side, piece, a, b, fa, fb, tolerance):
    """Return a change of sign of `margin` between a and b (Chandrupatla 1997)."""
    c, fc, part = a, fa, 0.5
    for _ in range(200):
        tau = a + part * (b - a)
        f = margin(q, mode, side, piece, tau)
        if (f < 0.0) == (fa < 0.0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = tau, f
        best, least = (a, fa) if abs(fa) < abs(fb) else (b, fb)
        smallest = (0.5 * tolerance + LAST_BIT * abs(best)) / abs(b - a)
        if smallest > 0.5 or least == 0.0:
            return best
        part = 0.5
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
            part = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        part = min(1.0 - smallest, max(smallest, part))
    return b


def follow(q, s, t, x, v, mode, boundary, offset, t_end):
    """Follow a motion and return (rows, count, outcome, mode): rows of t, x, kind, boundary; outcome 0 at t_end."""
    rows = np.empty((FIRST_ROWS, 4))
    count = 0
    while t < t_end:
        if boundary > 0 and mode < 4:
            v += offset if mode > boundary else -offset
        here = from_now(q, t)
        side, tau, x = leave(here, s, mode, 0.0, x, v, t_end - t)
        t += tau
        if side == 0:
            break
        if side == UNSOLVED:
            return rows, count, GAVE_UP, mode
        source, kind = mode, SLIP
        if source > 3:
            boundary = source - 3
            mode = boundary + 1 if side > 0 else boundary
        else:
            boundary = source if side > 0 else source - 1
            mode = resolve(here, boundary, tau, x)
            kind = STICK if mode > 3 else GRAZE if mode == source else CROSS
        v = q.v1 if boundary == 1 else q.v2
        if count == len(rows):
            longer = np.empty((2 * count, 4))
            for i in range(count):  # a slice would make compiling three seconds longer
                for j in range(4):
                    longer[i, j] = rows[i, j]
            rows = longer
        rows[count, 0], rows[count, 1], rows[count, 2], rows[count, 3] = t, x, kind, boundary
        count += 1
        if count > CHATTER and t - rows[count - 1 - CHATTER, 0] < q.period:
            return rows, count, CHATTERS, mode
    return rows, count, 0, mode


def runner(
    scene: Scene, functions: Record, q: Scalars, settings: Any, offset: float = 0.0
) -> Callable[[], Sequence[FoundEvents]]:
    """Return a function that follows a scene and returns its events.

    Parameters
    ----------
    scene : Scene
    functions : dict
        From `symosc.engine.arithmetic`.
    q : Scalars
    settings : tuple
        The argument `s` of `leave`.
    offset : float
        Flights from a belt start at this distance from its speed.
    """
    t0, x, v = float(scene.t0), float(scene.x0), float(scene.v0)
    mode, boundary = Motion(scene.parameters, scene.t0).start(0.0, x, v)
    arguments = q, settings, 0.0, x, v, mode, boundary, offset
    duration = float(scene.t_end - scene.t0)
    follow = functions["follow"]
    follow(*arguments, 0.0)  # compiles

    def run() -> Late:
        rows, count, outcome, last = follow(*arguments, duration)

        def events() -> list[FoundEvents]:
            times, positions, kinds, boundaries = rows[:count].T.tolist()
            times = [t0 + t for t in times]
            return list(map(FoundEvents, times, positions, map(KIND_NAMES.__getitem__, kinds), map(int, boundaries)))

        found = Late(events)
        if outcome == 0:
            return found
        where = f"in {MODE_NAMES[last]} after t = {found[-1].t if found else t0:.6g}"
        reason = f"chatters {where}: more than {CHATTER} events within one period"
        raise PeerError(reason if outcome == CHATTERS else f"took too many steps {where}", found)

    return run
