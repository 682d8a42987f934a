"""Which roots of the closing equations are orbits: every inequality that they do not contain, and its margin.

The equations say that each piece ends on its belt. That it gets there first, and that the motion goes on as the next
mapping says, are inequalities. Each one is a `Condition` with a value that is positive where it holds: the smallest
values tell how far an orbit is from ceasing to exist, and one that passes 0 along a branch is the reason why it ends.
The first exits are also verified by the engine's guaranteed search (`symosc.events`).
"""

from __future__ import annotations

from math import acos, cos, inf, pi, sin
from typing import Any, NamedTuple

from symosc.advance import CROSS, FAILED, REST, SLIP, STICK, advance
from symosc.closing import ClosingEquations, Piece
from symosc.events import state_at
from symosc.flow import Constants
from symosc.sticks import gain, wrapped

SAMPLE = 0.25  # step in which extrema of the velocity are looked for, in units of 1/rate
MOST_SAMPLES = 4000
# The engine's first exit may differ from the orbit's by this part of a period: near a graze both are ill-conditioned.
SAME_TIME = 1e-6
# Where an inequality holds by less than this the engine's answer would be about rounding errors. It is not asked.
MARGINAL = 1e-9


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
    """

    piece: int
    text: str
    value: float
    t: float
    event: str
    rank: int


GRAZING, BIRTH, VANISHING = "grazing", "birth of a stick", "vanishing of a stick"
SLIP_BIRTH, SLIP_VANISHING, FLIGHT_VANISHING = "birth of a slip", "vanishing of a slip", "vanishing of a flight"
# A flight that no longer reaches its belt takes the stick behind it with it; a slip that vanishes takes its own arrival
# with it; a crossing that turns into a stick makes the flight behind it leave on the wrong side.
ARRIVAL, STICK_LASTS, STICK_END, PASSING, HOLD, GAP, FLIGHT_LASTS, ENGINE = range(8)


class Extremum(NamedTuple):
    """A zero of the acceleration in a flight: time since its start, velocity, v''."""

    tau: float
    v: float
    b: float


def conditions(equations: ClosingEquations, points: Any) -> list[Condition]:
    """Return every inequality of a root with its margin, in the order of the pieces (double precision)."""
    found: list[Condition] = []
    points = [(float(x), float(theta)) for x, theta in points]
    for i, (start, end) in enumerate(zip(points, equations.ends(points), strict=True)):
        piece, following = equations.pieces[i], equations.pieces[(i + 1) % len(points)]
        found += _of_stick(i, piece, start, end, equations) if piece.sticks else []
        found += [] if piece.sticks else _of_flight(i, piece, following, start, end, equations)
    return found


def _of_flight(
    i: int, piece: Piece, following: Piece, start: Any, end: Any, equations: ClosingEquations
) -> list[Condition]:
    K, v_end = equations.K, equations.belt(piece.end).v
    tau, t_end = (end[1] - start[1]) / K.Om, end[1] / K.Om
    found = [Condition(i, f"{piece.label} lasts", tau, t_end, FLIGHT_VANISHING, FLIGHT_LASTS)]
    arrival = piece.side * equations.force(piece.mode, end[0], v_end, end[1])
    rank = GAP if piece.zeros == 2 else ARRIVAL
    if piece.zeros == 2:  # at the end of a short slip the force is lost in rounding, its change since the start is not
        arrival = piece.side * state_at(*[tau, *equations.start_of_flight(piece, start), K])[2]
    where, sign = f"F^({piece.mode})", ">" if piece.side > 0 else "<"
    text = f"{piece.label} meets v{piece.end} with {where} {sign} 0"
    found.append(Condition(i, text, arrival, t_end, GRAZING, rank))
    gap, t_gap = inf, t_end
    if tau > 0:
        for extremum in extrema(0.0, tau, equations.start_of_flight(piece, start), piece.after_stick, K):
            for clearance in _gaps(piece.mode, extremum, K):
                if clearance < gap:
                    gap, t_gap = clearance, start[1] / K.Om + extremum.tau
    found.append(Condition(i, f"{piece.label} stays in Omega{piece.mode}", gap, t_gap, GRAZING, GAP))
    far = piece.mode + piece.side
    beyond = piece.side * equations.force(far, end[0], v_end, end[1])
    if following.sticks:
        text = f"F^({far}) {'<' if piece.side > 0 else '>'} 0 at the onset of {following.label} (Theorem 4)"
        return [*found, Condition(i, text, -beyond, t_end, SLIP_BIRTH, HOLD)]
    text = f"F^({far}) {sign} 0 where {piece.label} crosses v{piece.end} (Theorem 5)"
    return [*found, Condition(i, text, beyond, t_end, BIRTH, PASSING)]


def _gaps(mode: int, extremum: Extremum, K: Constants) -> list[float]:
    """Return how far the velocity stays from the walls of its domain at an extremum that is turned to them."""
    gaps = []
    if mode > 1 and extremum.b > 0:
        gaps.append(extremum.v - (K.belt1, K.belt2)[mode - 2].v)
    if mode < 3 and extremum.b < 0:
        gaps.append((K.belt1, K.belt2)[mode - 1].v - extremum.v)
    return gaps


def _of_stick(i: int, piece: Piece, start: Any, end: Any, equations: ClosingEquations) -> list[Condition]:
    K, belt = equations.K, equations.belt(piece.start)
    low, high, tau = piece.start, piece.start + 1, (end[1] - start[1]) / K.Om
    s0, c0, t_end = sin(start[1]), cos(start[1]), end[1] / K.Om
    found = [Condition(i, f"{piece.label} lasts", tau, t_end, VANISHING, STICK_LASTS)]
    below = equations.force(low, start[0], belt.v, start[1])
    hold, t_hold = inf, t_end
    if belt.turns:
        for angle in (belt.angle, acos(-1.0) - belt.angle):
            turn = wrapped(angle - wrapped(start[1])) / K.Om
            while 0 < turn < tau:
                now = below + gain(turn, s0, c0, belt, K)[0]
                if min(now, belt.J - now) < hold:
                    hold, t_hold = min(now, belt.J - now), start[1] / K.Om + turn
                turn += K.period
    text = f"F^({low}) > 0 > F^({high}) during {piece.label} (Theorem 4)"
    found.append(Condition(i, text, hold, t_hold, SLIP_BIRTH, HOLD))
    slope = piece.side * (belt.drift - K.fB * sin(end[1]))
    text = f"F^({low if piece.side < 0 else high}) {'falls' if piece.side < 0 else 'rises'} where {piece.label} ends"
    return [*found, Condition(i, text, slope, t_end, SLIP_VANISHING, STICK_END)]


def extrema(begin: float, tau: float, flight: Any, at_rest: bool, K: Constants) -> list[Extremum]:
    """Return the extrema of the velocity of a flight (v0, a0, s0, c0) between two times; `at_rest`: a0 = 0 is none."""
    count = int(min(MOST_SAMPLES, max(8, (tau - begin) * K.rate / SAMPLE)))
    times = [begin + (tau - begin) * j / count for j in range(at_rest, count + 1)]
    slopes = [state_at(*[time, *flight, K])[2] for time in times]
    found = []
    for j in range(len(times) - 1):
        if (slopes[j] > 0) != (slopes[j + 1] > 0) and slopes[j] != 0:
            found.append(_extremum(times[j], times[j + 1], slopes[j] > 0, flight, K))
    return found


def _extremum(low: float, high: float, falls: bool, flight: Any, K: Constants) -> Extremum:
    """Return the zero of the acceleration in a bracket, by Newton steps kept inside it."""
    tau = 0.5 * (low + high)
    for _ in range(100):
        _, dv, a, b, *_ = state_at(*[tau, *flight, K])
        low, high = (tau, high) if (a > 0) == falls else (low, tau)
        following = tau - a / b if b != 0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - tau) <= 1e-15 * high or following in (low, high):
            break
        tau = following
    return Extremum(tau, flight[0] + dv, b)


def grazing_distance(equations: ClosingEquations, points: Any) -> float:
    """Return the least velocity by which a flight misses a belt that it turns before, or exceeds one that it meets.

    At an extremum inside a flight that is the gap to the belt. At a flight's end it is how far the flight would go past
    the belt if the motion of its domain went on: both are 0 where the orbit grazes, from either side.
    """
    K, nearest = equations.K, inf
    points = [(float(x), float(theta)) for x, theta in points]
    nearest = min([c.value for c in conditions(equations, points) if "stays in" in c.text], default=inf)
    for piece, start, end in zip(equations.pieces, points, equations.ends(points), strict=True):
        if piece.sticks:
            continue
        tau = (end[1] - start[1]) / K.Om
        past = extrema(tau, tau + K.period, equations.start_of_flight(piece, start), False, K)
        if past:
            nearest = min(nearest, abs(past[0].v - equations.belt(piece.end).v))
    return float(nearest)


def failures(equations: ClosingEquations, points: Any) -> list[Condition]:
    """Return the conditions that do not hold, the one that explains the others first; empty for an orbit.

    Where all hold, every piece is also followed by the engine, whose first exit is guaranteed to be the first.
    """
    all_of_them = conditions(equations, points)
    failed = [condition for condition in all_of_them if not condition.value > 0]
    if failed:
        return sorted(failed, key=lambda condition: condition.rank)
    if min(condition.value for condition in all_of_them) < MARGINAL:
        return []
    missed = (_first_exit(i, equations, points) for i in range(len(points)))
    return [condition for condition in missed if condition is not None]


def _first_exit(i: int, equations: ClosingEquations, points: Any) -> Condition | None:
    """Return None if the engine agrees that piece i ends where and how the orbit says, the failure otherwise."""
    K, piece, following = equations.K, equations.pieces[i], equations.pieces[(i + 1) % len(points)]
    x, theta = (float(value) for value in points[i])
    due = float(equations.ends(points)[i][1])
    v = equations.belt(piece.start).v
    if piece.sticks:
        forces = [equations.force(piece.start + side, x, v, theta) for side in (0, 1)]
    else:
        forces = [equations.start_of_flight(piece, (x, theta))[1]] * 2
    turns = int(theta // (2 * pi))
    state: Any = (piece.mode, piece.start, turns, theta - 2 * pi * turns, x, v, *forces, 0.0, 0.0, 0.0, 0.0, 0.0)
    while True:
        code, boundary, decided, _, *rest = advance(*[*state, (equations.periods + 2) * K.period, 0.0, K])
        if not decided:  # rounding hides what happens: no contradiction
            return None
        state = rest
        phase = 2 * pi * state[2] + state[3]
        if code in (CROSS, STICK, SLIP, REST, FAILED) or phase > due + 2 * pi * SAME_TIME:
            break
    expected = code in (CROSS, STICK, SLIP) and (boundary, state[0]) == (piece.end, following.mode)
    if expected and abs(phase - due) <= 2 * pi * SAME_TIME:
        return None
    event = SLIP_BIRTH if piece.sticks else GRAZING
    return Condition(i, f"{piece.label} ends where it first can", -abs(due - phase) / K.Om, phase / K.Om, event, ENGINE)
