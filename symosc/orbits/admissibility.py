"""Which roots of the closing equations are orbits: every inequality that they do not contain, and its margin.

The equations say that each piece ends on its belt. That it gets there first, and that the motion goes on as the next
mapping says, are inequalities. Each one is a `Condition` with a value that is positive where it holds. The smallest
values show how far an orbit is from ceasing to exist. One that passes 0 along a branch is the reason why the branch
ends.

The margins are computed in the arithmetic of the equations, so that more digits decide what doubles cannot. The
engine's verdict on the whole orbit is `symosc.orbits.verification`.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any, NamedTuple

import numpy as np

from symosc.aliases import Number, Point, Points
from symosc.engine.flow import Constants
from symosc.engine.state import Launch
from symosc.kernels._generated import motion
from symosc.kernels.entire_array import basis
from symosc.orbits.closing_equations import ClosingEquations, OrbitPiece

SAMPLE = 0.25  # step in which extrema of the velocity are looked for, in units of 1/rate
MOST_VELOCITY_SAMPLES = 4000
FINEST_SAMPLES = 64.0  # an extremum is known to this many rounding errors of its time


class Condition(NamedTuple):
    """An inequality that an orbit must satisfy.

    Attributes
    ----------
    piece : int
        Which mapping of the word, in order of time.
    text : str
        The inequality in words.
    value : float
        Positive where it holds; time for durations, else velocity or acceleration.
    t : float
        When it is closest to failing.
    event : str
        What happens to the orbit where the value passes 0.
    rank : int
        Where several fail at once, the one with the lowest rank explains the others.
    scale : float
        The size of the terms that the value is a difference of: rounding errors are measured by it.

    Examples
    --------
    >>> from symosc import find_orbit, load_scene
    >>> orbit = find_orbit(load_scene("fig5").parameters, "P32")
    >>> orbit.admissible, orbit.failures[0].text
    (False, 'F^(2) > 0 where P2 crosses v1 (Theorem 5)')
    """

    piece: int
    text: str
    value: float
    t: float
    event: str
    rank: int
    scale: float


GRAZING, BIRTH, VANISHING = "grazing", "birth of a stick", "vanishing of a stick"
SLIP_BIRTH, SLIP_VANISHING, FLIGHT_VANISHING = "birth of a slip", "vanishing of a slip", "vanishing of a flight"
# A flight that no longer reaches its belt takes the stick behind it with it; a slip that vanishes takes its own arrival
# with it; a crossing that turns into a stick makes the flight behind it leave into the wrong domain.
ARRIVAL, STICK_LASTS, STICK_END, PASSING, HOLD, STAYS_INSIDE, FLIGHT_LASTS, ENGINE = range(8)


class Extremum(NamedTuple):
    """A zero of the acceleration in a flight: time since its start, velocity, v''."""

    tau: Number
    v: Number
    b: Number


class Scales(NamedTuple):
    """Sizes of times, velocities and accelerations on an orbit."""

    t: float
    v: float
    a: float


def scales(equations: ClosingEquations, points: Points) -> Scales:
    """Return the sizes of the terms in the margins of an orbit."""
    K = equations.K
    belts = [abs(float(equations.belt(piece.start).v)) for piece in equations.pieces]
    a = max(abs(float(A)) for A in (K.A1, K.A2, K.A3)) + abs(float(K.f0)) + float(K.cm) * max(belts)
    a += float(K.w0sq) * max(abs(float(x)) for x, _ in points)
    return Scales(1 / float(K.rate), a / float(K.rate) + max(belts), a)


def conditions(equations: ClosingEquations, points: Points) -> list[Condition]:
    """Return every inequality of a root with its margin, in the order of the pieces.

    Parameters
    ----------
    equations : ClosingEquations
        In any arithmetic; the margins are rounded to floats at the end.
    points : sequence of (x, theta)
    """
    found: list[Condition] = []
    number = equations.exact or float
    points = [(number(x), number(theta)) for x, theta in points]
    sizes = scales(equations, points)
    for i, (start, end) in enumerate(zip(points, equations.ends(points), strict=True)):
        piece, following = equations.pieces[i], equations.pieces[(i + 1) % len(points)]
        of_piece = _Margins(equations, i, sizes, found)
        if piece.sticks:
            _of_stick(of_piece, piece, start, end, equations)
        else:
            _of_flight(of_piece, piece, following, start, end, equations)
    return found


class _Margins:
    """The conditions of one piece, gathered in order."""

    def __init__(self, equations: ClosingEquations, piece: int, sizes: Scales, found: list[Condition]) -> None:
        self.Om, self.piece, self.sizes, self.found = equations.K.Om, piece, sizes, found

    def add(self, text: str, value: Number, theta: Number, event: str, rank: int, size: float) -> None:
        """Add one whose value is closest to 0 at the phase theta."""
        self.found.append(Condition(self.piece, text, float(value), float(theta / self.Om), event, rank, size))


def _of_flight(
    margins: _Margins, piece: OrbitPiece, following: OrbitPiece, start: Point, end: Point, equations: ClosingEquations
) -> None:
    K, v_end, sizes = equations.K, equations.belt(piece.end).v, margins.sizes
    tau, flight = (end[1] - start[1]) / K.Om, equations.start_of_flight(piece, start)
    margins.add(f"{piece.label} lasts", tau, end[1], FLIGHT_VANISHING, FLIGHT_LASTS, sizes.t)
    arrival = piece.side * equations.force(piece.mode, end[0], v_end, end[1])
    rank, size = STAYS_INSIDE if piece.zeros == 2 else ARRIVAL, sizes.a
    if piece.zeros == 2:  # at the end of a short slip the force is lost in rounding, its change since the start is not
        arrival = piece.side * _states(equations)(tau, flight, K).F
        size *= float(min(1, abs(tau) * K.rate))
    where, sign = f"F^({piece.mode})", ">" if piece.side > 0 else "<"
    text = f"{piece.label} meets v{piece.end} with {where} {sign} 0"
    margins.add(text, arrival, end[1], GRAZING, rank, size)
    gap, nearest = inf, end[1]
    if tau > 0:
        for extremum in extrema(0 * tau, tau, flight, piece.after_stick, equations):
            for clearance in _gaps(piece.mode, extremum, K):
                if clearance < gap:
                    gap, nearest = clearance, start[1] + K.Om * extremum.tau
    text = f"{piece.label} stays in Omega{piece.mode}"
    margins.add(text, gap, nearest, GRAZING, STAYS_INSIDE, sizes.v * float(min(1, abs(tau) * K.rate)))
    far = piece.mode + piece.side
    beyond = piece.side * equations.force(far, end[0], v_end, end[1])
    if following.sticks:
        text = f"F^({far}) {'<' if piece.side > 0 else '>'} 0 at the onset of {following.label} (Theorem 4)"
        margins.add(text, -beyond, end[1], SLIP_BIRTH, HOLD, sizes.a)
    else:
        text = f"F^({far}) {sign} 0 where {piece.label} crosses v{piece.end} (Theorem 5)"
        margins.add(text, beyond, end[1], BIRTH, PASSING, sizes.a)


def _gaps(mode: int, extremum: Extremum, K: Constants) -> list[Number]:
    """Return how far the velocity stays from the boundaries of its domain at an extremum that is turned to them."""
    gaps = []
    if mode > 1 and extremum.b > 0:
        gaps.append(extremum.v - (K.belt1, K.belt2)[mode - 2].v)
    if mode < 3 and extremum.b < 0:
        gaps.append((K.belt1, K.belt2)[mode - 1].v - extremum.v)
    return gaps


def _of_stick(margins: _Margins, piece: OrbitPiece, start: Point, end: Point, equations: ClosingEquations) -> None:
    K, belt, names = equations.K, equations.belt(piece.start), equations.arithmetic.namespace
    low, high, tau = piece.start, piece.start + 1, (end[1] - start[1]) / K.Om
    s0, c0 = equations.sin(start[1]), equations.cos(start[1])
    margins.add(f"{piece.label} lasts", tau, end[1], VANISHING, STICK_LASTS, margins.sizes.t)
    below = equations.force(low, start[0], belt.v, start[1])
    hold, nearest = inf, end[1]
    if belt.turns:
        for angle in (belt.angle, names["PI"] - belt.angle):
            turn = names["wrapped"](angle - names["wrapped"](start[1])) / K.Om
            while 0 < turn < tau:
                now = below + names["gain"](turn, s0, c0, belt, K)[0]
                if min(now, belt.J - now) < hold:
                    hold, nearest = min(now, belt.J - now), start[1] + K.Om * turn
                turn += K.period
    text = f"F^({low}) > 0 > F^({high}) during {piece.label} (Theorem 4)"
    margins.add(text, hold, nearest, SLIP_BIRTH, HOLD, margins.sizes.a)
    slope = piece.side * (belt.drift - K.fB * equations.sin(end[1]))
    text = f"F^({low if piece.side < 0 else high}) {'falls' if piece.side < 0 else 'rises'} where {piece.label} ends"
    margins.add(text, slope, end[1], SLIP_VANISHING, STICK_END, float(abs(belt.drift) + abs(K.fB)))


def _states(equations: ClosingEquations) -> Callable[..., Any]:
    return equations.arithmetic.namespace["state_at"]


def extrema(begin: Number, tau: Number, flight: Launch, at_rest: bool, equations: ClosingEquations) -> list[Extremum]:
    """Return the extrema of the velocity of a flight between two times; `at_rest`: a0 = 0 is none.

    They are looked for in doubles, and then placed in the arithmetic of the equations.
    """
    coarse = equations.coarse.K
    v0, a0, s0, c0 = (float(value) for value in flight)
    span, count = float(tau - begin), int(min(MOST_VELOCITY_SAMPLES, max(8, float(tau - begin) * coarse.rate / SAMPLE)))
    times = float(begin) + span * np.arange(at_rest, count + 1) / count
    _, _, slopes = motion(v0, a0, s0, c0, coarse.cm, coarse.w0sq, coarse.f0, coarse.Om, *basis(times, coarse)[:5])
    rising = slopes > 0
    for j in np.flatnonzero(slopes[:-1] == 0)[::-1]:  # a sample just at a turn belongs to what follows
        rising[j] = rising[j + 1]
    turns = np.flatnonzero(rising[:-1] != rising[1:])
    return [_extremum(times[j], times[j + 1], rising[j], flight, equations) for j in turns]


def _extremum(low: float, high: float, falls: bool, flight: Launch, equations: ClosingEquations) -> Extremum:
    """Return the zero of the acceleration in a bracket, by Newton steps kept inside it."""
    states, K, number = _states(equations), equations.K, equations.exact or float
    allowed = FINEST_SAMPLES * equations.arithmetic.namespace["EPS"]
    low, high = number(low), number(high)
    tau = (low + high) / 2
    for _ in range(100):
        now = states(tau, flight, K)
        a, b = now.F, now.G1
        if a == 0:
            break
        low, high = (tau, high) if (a > 0) == falls else (low, tau)
        following = tau - a / b if b != 0 else low
        if not low < following < high:
            following = (low + high) / 2
        if abs(following - tau) <= allowed * high or following in (low, high):
            break
        tau = following
    return Extremum(tau, flight.v + now.dv, b)


def grazing_distance(equations: ClosingEquations, points: Points) -> float:
    """Return the least velocity by which a flight misses a belt that it turns before, or exceeds one that it meets.

    At an extremum inside a flight that is the gap to the belt. At a flight's end it is how far the flight would go past
    the belt if the motion of its domain went on. Both are 0 where the orbit grazes, seen from below and from above.
    """
    K, nearest = equations.K, inf
    points = [(float(x), float(theta)) for x, theta in points]
    nearest = min([c.value for c in conditions(equations, points) if "stays in" in c.text], default=inf)
    for piece, start, end in zip(equations.pieces, points, equations.ends(points), strict=True):
        if piece.sticks:
            continue
        tau = (end[1] - start[1]) / K.Om
        past = extrema(tau, tau + K.period, equations.start_of_flight(piece, start), False, equations)
        if past:
            nearest = min(nearest, abs(past[0].v - equations.belt(piece.end).v))
    return float(nearest)


def failing(all_of_them: list[Condition]) -> list[Condition]:
    """Return the conditions that do not hold, the one that explains the others first."""
    return sorted((c for c in all_of_them if not c.value > 0), key=lambda condition: condition.rank)
