"""Admissibility: which roots of the closing equations are orbits; each inequality with its margin.

The equations say that each piece ends on its belt. That it gets there first, and that the motion
goes on as the next mapping says, are inequalities. Each one is a `Condition` with a value that is
positive where it holds. The smallest values show how far an orbit is from ceasing to exist. One
that passes 0 along a branch is the reason why the branch ends.

The margins are computed in the arithmetic of the equations, so that more digits decide what doubles
cannot. The verdict asks three questions, in this order.

1. Do all inequalities hold? Where a margin is too small for doubles the root is refined to
   FINE_DIGITS digits first. If a margin is 0 there, it is not an orbit: a piece has no length, or a
   belt is only grazed.
2. Does the motion from a switching point of the root do what the word says? It is simulated over
   the whole period by the engine, always: no margin is too small or too large for that.
3. Does it close? Every event has to be where and when the root says, the last one a period after
   the start.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from math import inf, pi
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Number, Points
from symosc.engine.arithmetic import column_functions
from symosc.engine.events import Event
from symosc.engine.state import Launch
from symosc.friction import MODE_NAMES, NEIGHBOURS
from symosc.kernels import linear
from symosc.kernels._generated import motion
from symosc.kernels.entire import EPS
from symosc.orbits.closing_equations import ClosingEquations, OrbitPiece, Solution, Span, polish
from symosc.simulation.simulate import simulate

# a margin below this part of the terms that it is a difference of is decided in more digits
MARGINAL = 1e-9
FINE_DIGITS = 50
# a margin below this part of its terms is 0 with FINE_DIGITS
NOTHING_IN_DIGITS = 1e-25
# At a root that cannot be refined a margin below this part of its terms may be 0.
PERHAPS_NOTHING = 1e-6
# There a piece vanishes if Newton's method has made its duration smaller than this part of what it
# was in doubles.
VANISHED = 1e-2
# Digits with which the engine follows an orbit whose margins are small.
ENGINE_DIGITS = (30, 60)
# How far the engine's events may be from the orbit's, as a part of a period and of the size of the
# positions: for a start in doubles, and for one with digits. A start that is rounded to doubles
# moves an arrival with a margin of MARGINAL by 1e-7.
ALLOWED_IN_DOUBLES = 1e-6
ALLOWED_IN_DIGITS = 1e-12
SAMPLE = 0.25  # step of the samples that bracket extrema of the velocity, in units of 1/rate
FEWEST_SAMPLES = 8
MOST_SAMPLES = 4000
# Bracketed Newton steps to an extremum, and how well it is to be known: in eps of its time.
MOST_EXTREMUM_NEWTON = 100
EXTREMUM_ROUNDING = 64.0


class Condition(NamedTuple):
    """An inequality that an orbit must satisfy.

    Attributes
    ----------
    piece : int
        Which mapping of the word, in order of time.
    text : str
        The inequality in words.
    value : float
        Positive where the inequality holds: a time if it is about a duration, else a velocity or an
        acceleration.
    t : float
        The time at which the inequality is closest to failing.
    event : str
        What happens to the orbit at the parameters at which the value passes 0.
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


GRAZING = "grazing"
BIRTH = "birth of a stick"
VANISHING = "vanishing of a stick"
SLIP_BIRTH = "birth of a slip"
SLIP_VANISHING = "vanishing of a slip"
FLIGHT_VANISHING = "vanishing of a flight"
# A flight that no longer reaches its belt takes the stick after it with it; a slip that vanishes
# takes its own arrival with it; a crossing that turns into a stick makes the flight after it leave
# into the wrong domain.
ARRIVAL, STICK_LASTS, STICK_END, PASSING, HOLD, STAYS_INSIDE, FLIGHT_LASTS, ENGINE = range(8)


class Extremum(NamedTuple):
    """An extremum of v in a flight: the time `tau` since the flight's start, the velocity `v`, and
    `b` = v''.
    """

    tau: Number
    v: Number
    b: Number


class Scales(NamedTuple):
    """The magnitudes of the times `t`, the velocities `v` and the accelerations `a` on an orbit."""

    t: float
    v: float
    a: float


def scales(equations: ClosingEquations, points: Points) -> Scales:
    """Return the magnitudes of times, velocities and accelerations on an orbit, as a scale for
    rounding errors.
    """
    K = equations.K
    belts = [abs(float(equations.belt(piece.start).v)) for piece in equations.pieces]
    # The terms of an acceleration: constant forces, the drive, the damper and the spring.
    a = max(abs(float(A)) for A in (K.A1, K.A2, K.A3)) + abs(float(K.f0)) + float(K.cm) * max(belts)
    a += float(K.w0sq) * max(abs(float(x)) for x, _ in points)
    return Scales(1 / float(K.rate), a / float(K.rate) + max(belts), a)


def conditions(equations: ClosingEquations, points: Points) -> list[Condition]:
    """Return each inequality that a root of the closing equations must satisfy, with its margin,
    piece by piece.
    """
    points = [(equations.number(x), equations.number(theta)) for x, theta in points]
    sizes = scales(equations, points)
    all_conditions = list[Condition]()
    for i, span in enumerate(equations.spans(points)):
        following = equations.pieces[(i + 1) % len(points)]
        if span.piece.sticks:
            margins = _stick(equations, span, sizes)
        else:
            margins = _flight(equations, span, following, sizes)
        for margin in margins:
            condition = Condition(
                i,
                margin.text,
                float(margin.value),
                float(margin.theta / equations.K.Om),
                margin.event,
                margin.rank,
                margin.scale,
            )
            all_conditions.append(condition)
    return all_conditions


class Margin(NamedTuple):
    """What a `Condition` says, in the arithmetic of the equations: `theta` is the phase at which
    the margin is closest to 0.
    """

    text: str
    value: Number
    theta: Number
    event: str
    rank: int
    scale: float


class Extreme(NamedTuple):
    """A margin where it is extremal in a piece, the phase there, and `place`, the belt of a gap or
    the domain of a force.
    """

    margin: Number
    theta: Number
    place: int


def _flight(
    equations: ClosingEquations, span: Span, following: OrbitPiece, sizes: Scales
) -> Iterator[Margin]:
    """Yield the inequalities of the flight `span` before the piece `following`.

    `sizes` go into `Condition.scale`.
    """
    side = span.piece.side
    K = equations.K
    (piece, start, end, tau) = span
    end_x, end_theta = end
    v_end = equations.belt(piece.end).v
    # In a flight that is shorter than 1/rate v and F change by about this part of their sizes.
    short = float(min(1, abs(tau) * K.rate))
    if side > 0:
        sign, opposite = "><"
    else:
        sign, opposite = "<>"
    text = f"{piece.label} has positive duration"
    yield Margin(text, tau, end_theta, FLIGHT_VANISHING, FLIGHT_LASTS, sizes.t)
    arrival = side * equations.force(piece.mode, end_x, v_end, end_theta)
    rank = ARRIVAL
    size = sizes.a
    # At the end of a short slip the force is lost in rounding, its change since the start is not.
    if piece.zeros == 2:
        state_at = equations.arithmetic.namespace["state_at"]
        arrival = side * state_at(tau, equations.start_of_flight(piece, start), K).F
        rank = STAYS_INSIDE
        size = sizes.a * short
    text = f"{piece.label} meets v{piece.end} with F^({piece.mode}) {sign} 0"
    yield Margin(text, arrival, end_theta, GRAZING, rank, size)
    nearest = min(clearances(equations, span), default=Extreme(inf, end_theta, 0))
    text = f"{piece.label} stays in Omega{piece.mode}"
    size = sizes.v * short
    yield Margin(text, nearest.margin, nearest.theta, GRAZING, STAYS_INSIDE, size)
    far = piece.mode + side
    beyond = side * equations.force(far, end_x, v_end, end_theta)
    if following.sticks:
        text = f"F^({far}) {opposite} 0 at the onset of {following.label} (Theorem 4)"
        yield Margin(text, -beyond, end_theta, SLIP_BIRTH, HOLD, sizes.a)
    else:
        text = f"F^({far}) {sign} 0 where {piece.label} crosses v{piece.end} (Theorem 5)"
        yield Margin(text, beyond, end_theta, BIRTH, PASSING, sizes.a)


def _stick(equations: ClosingEquations, span: Span, sizes: Scales) -> Iterator[Margin]:
    """Yield the inequalities of the stick `span`, with their margins.

    `sizes` go into `Condition.scale`.
    """
    belt = equations.belt(span.piece.start)
    K = equations.K
    (piece, _, (_, end_theta), tau) = span
    low = piece.start
    high = piece.start + 1
    text = f"{piece.label} has positive duration"
    yield Margin(text, tau, end_theta, VANISHING, STICK_LASTS, sizes.t)
    weakest = min(holding_forces(equations, span), default=Extreme(inf, end_theta, 0))
    text = f"F^({low}) > 0 > F^({high}) during {piece.label} (Theorem 4)"
    yield Margin(text, weakest.margin, weakest.theta, SLIP_BIRTH, HOLD, sizes.a)
    slope = piece.side * (belt.drift - K.fB * equations.sin(end_theta))
    if piece.side < 0:
        change = f"F^({low}) falls"
    else:
        change = f"F^({high}) rises"
    size = float(abs(belt.drift) + abs(K.fB))
    text = f"{change} where {piece.label} ends"
    yield Margin(text, slope, end_theta, SLIP_VANISHING, STICK_END, size)


def clearances(equations: ClosingEquations, span: Span) -> Iterator[Extreme]:
    """Yield the gap to a belt at each minimum of v in a flight above the belt, and at each maximum
    below it.
    """
    piece, start, _, tau = span
    if not tau > 0:
        return
    _, start_theta = start
    flight = equations.start_of_flight(piece, start)
    for extremum in extrema(0 * tau, tau, flight, piece.after_stick, equations):
        # a minimum is turned to the belt below
        if extremum.b > 0:
            belt = piece.mode - 1
        else:
            belt = piece.mode
        if belt in NEIGHBOURS and extremum.b != 0:
            v = equations.belt(belt).v
            if extremum.b > 0:
                clearance = extremum.v - v
            else:
                clearance = v - extremum.v
            yield Extreme(clearance, start_theta + equations.K.Om * extremum.tau, belt)


def holding_forces(equations: ClosingEquations, span: Span) -> Iterator[Extreme]:
    """Yield the smaller one of F^(below) and -F^(above) where both forces are extremal in a
    stick.
    """
    (piece, (start_x, start_theta), _, tau) = span
    K = equations.K
    names = equations.arithmetic.namespace
    belt = equations.belt(piece.start)
    if not belt.turns:  # the forces only rise or only fall
        return
    s0 = equations.sin(start_theta)
    c0 = equations.cos(start_theta)
    below_at_start = equations.force(piece.start, start_x, belt.v, start_theta)
    # The forces turn where sin(theta) is that of `belt.angle`: at two phases of each period.
    for angle in (belt.angle, names["PI"] - belt.angle):
        elapsed = (angle - start_theta) % names["TWO_PI"] / K.Om
        while 0 < elapsed < tau:
            gain, *_ = names["force_gain"](elapsed, s0, c0, belt, K)
            below = below_at_start + gain
            # -F^(above) is the jump less F^(below).
            hold, domain = min((below, piece.start), (belt.J - below, piece.start + 1))
            yield Extreme(hold, start_theta + K.Om * elapsed, domain)
            elapsed += K.period


def extrema(
    begin: Number, tau: Number, flight: Launch, skip: bool, equations: ClosingEquations
) -> list[Extremum]:
    """Return the extrema of v between the times `begin` and `tau` of a flight; with `skip`, without
    one at `begin`.
    """
    # They are bracketed in doubles, and then located in the arithmetic of the equations.
    coarse = equations.coarse.K
    v0, a0, s0, c0 = (float(value) for value in flight)
    span = float(tau - begin)
    count = int(min(MOST_SAMPLES, max(FEWEST_SAMPLES, span * coarse.rate / SAMPLE)))
    times = float(begin) + span * np.arange(skip, count + 1) / count
    basis = column_functions()["basis"]
    _, _, slopes = motion(
        v0, a0, s0, c0, coarse.cm, coarse.w0sq, coarse.f0, coarse.Om, *basis(times, coarse)[:5]
    )
    rising = slopes > 0
    # A sample just at a turn belongs to what follows; backward, as several may follow each other.
    for j in np.flatnonzero(slopes[:-1] == 0)[::-1]:
        rising[j] = rising[j + 1]
    turns = np.flatnonzero(rising[:-1] != rising[1:])
    return [_extremum(times[j], times[j + 1], rising[j], flight, equations) for j in turns]


def _extremum(
    low: float, high: float, maximum: bool, flight: Launch, equations: ClosingEquations
) -> Extremum:
    """Find the minimum or `maximum` of v between the times `low` and `high` of a flight by
    bracketed Newton steps.
    """
    state_at = equations.arithmetic.namespace["state_at"]
    K = equations.K
    number = equations.number
    allowed = EXTREMUM_ROUNDING * equations.arithmetic.namespace["EPS"]
    low = number(low)
    high = number(high)
    tau = (low + high) / 2
    for _ in range(MOST_EXTREMUM_NEWTON):
        state = state_at(tau, flight, K)
        a = state.F
        b = state.G1
        if a == 0:
            break
        if (a > 0) == maximum:  # v still rises to its maximum, or falls to its minimum
            low = tau
        else:
            high = tau
        before = tau
        if b != 0:
            tau = tau - a / b
        else:
            tau = low
        if not low < tau < high:
            tau = (low + high) / 2
        if abs(tau - before) <= allowed * high or tau in (low, high):
            tau = before
            break
    return Extremum(tau, flight.v + state.dv, b)


def grazing_distance(equations: ClosingEquations, points: Points) -> float:
    """Return the least gap in velocity between a belt and an extremum of a flight or its
    continuation; inf if none.
    """
    # At an extremum inside a flight that is the gap to the belt. At a flight's end it is how far
    # the flight would go past the belt if the motion of its domain went on. Both are 0 where the
    # orbit grazes, seen from below and from above.
    K = equations.K
    points = [(float(x), float(theta)) for x, theta in points]
    distances = [c.value for c in conditions(equations, points) if "stays in" in c.text]
    for piece, start, _, tau in equations.spans(points):
        if not piece.sticks:
            flight = equations.start_of_flight(piece, start)
            past_end = extrema(tau, tau + K.period, flight, False, equations)
            if past_end:
                distances.append(abs(past_end[0].v - equations.belt(piece.end).v))
    return float(min(distances, default=inf))


def concerns_whole_piece(condition: Condition) -> bool:
    """Return whether a condition is about all times of a piece (gaps, forces in a stick), not its
    end or duration.
    """
    return " stays in " in condition.text or " during " in condition.text


def failing(tested: list[Condition]) -> list[Condition]:
    """Return those of the given conditions that fail, sorted by `Condition.rank`."""
    return sorted((c for c in tested if not c.value > 0), key=lambda c: c.rank)


# -- the verdict -----------------------------------------------------------------------------------


def failures(equations: ClosingEquations, points: Points) -> list[Condition]:
    """Return the conditions that keep a root in doubles from being an orbit, sorted by rank.

    [] for an orbit.
    """
    tested = conditions(equations, points)
    # Doubles decide if no margin is small and the engine agrees; else more digits do.
    if not _margin_is_below(MARGINAL, tested) and not ill_conditioned(equations, points):
        failed = failing(tested)
        if failed or engine_contradiction(equations, points) is None:
            return failed
    fine = equations.with_digits(FINE_DIGITS)
    root = Solution(points, inf, 0, False, "a piece has no length")
    with suppress(ZeroDivisionError, ValueError):  # a flight loses all its length on the way
        root = polish(fine, points)
    if not root.converged:
        vanished = _vanished(equations, fine, points, root.points)
        return _failures_of_multiple_root(equations, points, tested, vanished)
    decided = list[Condition]()
    for condition in conditions(fine, root.points):
        if _is_below(NOTHING_IN_DIGITS, condition):
            condition = condition._replace(value=0.0)
        decided.append(condition)
    failed = failing(decided)
    if failed:
        return failed
    # It is an orbit if the engine follows it with any of these numbers of digits.
    contradictions = list[Condition]()
    for digits in ENGINE_DIGITS:
        contradiction = engine_contradiction(fine, root.points, digits)
        if contradiction is None:
            return []
        contradictions.append(contradiction)
    return [engine_contradiction(equations, points) or contradictions[-1]]


def _vanished(
    equations: ClosingEquations, fine: ClosingEquations, points: Points, last: Points
) -> set[int]:
    """Return the numbers of the pieces whose duration tends to 0 in Newton's method with many
    digits, which ended at `last` without a root.
    """
    spans = zip(equations.spans(points), fine.spans(last), strict=True)
    return {
        i
        for i, (before, after) in enumerate(spans)
        if abs(fine.K.Om * after.tau) < VANISHED * abs(equations.K.Om * before.tau)
    }


def _failures_of_multiple_root(
    equations: ClosingEquations, points: Points, tested: list[Condition], vanished: set[int]
) -> list[Condition]:
    """Return the conditions that keep a root from being an orbit where Newton's method with many
    digits does not converge.

    Doubles say `tested`; the durations of the pieces `vanished` tend to 0 in Newton's method.
    """
    # A piece has no length.
    lasts = [c for c in tested if c.piece in vanished and c.rank in (STICK_LASTS, FLIGHT_LASTS)]
    if lasts:
        return [c._replace(value=0.0) for c in lasts]
    # An inequality fails in doubles already.
    failed = failing(tested)
    if failed:
        return failed
    # All hold in doubles, one of them by too little to be sure: nothing decides it.
    undecided = _undecided(tested)
    if _margin_is_below(MARGINAL, tested):
        return undecided
    # All hold surely in doubles, and the engine decides. What it contradicts are the margins near
    # 0 or, if there are none, the piece at which it differs.
    contradiction = engine_contradiction(equations, points)
    if contradiction is None:
        return []
    return undecided or [contradiction]


def _undecided(tested: list[Condition]) -> list[Condition]:
    """Return the conditions that may fail at a root that cannot be refined, sorted by rank, as
    failed ones whose text says so.
    """
    near_0 = sorted((c for c in tested if _is_below(PERHAPS_NOTHING, c)), key=lambda c: c.rank)
    text = " (it cannot be decided: the equations are singular there)"
    return [c._replace(text=c.text + text, value=0.0) for c in near_0]


def _is_below(part: float, condition: Condition) -> bool:
    """Return whether a margin is nearer to 0 than this `part` of its terms."""
    return abs(condition.value) < part * condition.scale


def _margin_is_below(part: float, tested: list[Condition]) -> bool:
    """Return whether any margin is nearer to 0 than this `part` of its terms."""
    return any(_is_below(part, condition) for condition in tested)


def ill_conditioned(equations: ClosingEquations, points: Points) -> bool:
    """Return whether rounding in the closing equations may move a root's switching phases by more
    than `MARGINAL`.
    """
    sizes = scales(equations, points)
    # The sizes of the terms of f1 and f2 of each piece, by which rounding errors are measured.
    term_sizes = []
    x_size = max(abs(float(x)) for x, _ in points)
    durations = equations.durations(np.asarray(points))
    for piece, duration in zip(equations.pieces, durations, strict=True):
        size_2 = sizes.a if piece.sticks else sizes.v
        if piece.zeros:  # f2 is divided by the duration to this power (`residuals`)
            size_2 *= (abs(duration) / equations.K.Om) ** -piece.zeros * min(1.0, abs(duration))
        term_sizes += [x_size, size_2]
    try:
        phase_rows = linear.inverse(equations.matrix(points))[1::2]
    except ZeroDivisionError:
        return True
    moved = linear.product(np.abs(phase_rows), np.array(term_sizes))
    return bool(moved.max() * EPS > MARGINAL)


def engine_contradiction(
    equations: ClosingEquations, points: Points, digits: int | None = None
) -> Condition | None:
    """Simulate a root's motion over its period, and return a failed condition on the first piece
    that differs, or None.
    """
    pieces = equations.pieces
    K = equations.K
    first = _surest_start(equations, points)
    if digits is None:
        allowed = ALLOWED_IN_DOUBLES
    else:
        allowed = ALLOWED_IN_DIGITS
    exact_points = [(equations.number(x), equations.number(theta)) for x, theta in points]
    x0, theta0 = exact_points[first]
    t0 = theta0 / K.Om
    t_end = t0 + equations.turn / K.Om * (1 + allowed)
    v0 = equations.parameters.belt(pieces[first].start)
    events = simulate(
        equations.parameters,
        t0=t0,
        x0=x0,
        v0=v0,
        t_end=t_end,
        max_events=len(pieces) + 1,
        digits=digits,
    ).events
    difference = _first_difference(equations, exact_points, first, events, allowed)
    if difference is None:
        return None
    ending = pieces[difference.piece]
    if ending.sticks:
        kind = SLIP_BIRTH
    else:
        kind = GRAZING
    text = f"{ending.label} ends where it first can"
    value = -min(difference.late, float(equations.turn / K.Om))
    return Condition(difference.piece, text, value, difference.t, kind, ENGINE, 2 * pi)


class EngineDifference(NamedTuple):
    """Where a simulated motion is not that of a root: the piece at whose end it differs, how late
    the event is there (inf: there is none), and its time.
    """

    piece: int
    late: Number
    t: float


def _first_difference(
    equations: ClosingEquations, points: Points, first: int, events: Sequence[Event], allowed: float
) -> EngineDifference | None:
    """Return the first difference of the `events` of a motion from the `points` of a root, from the
    start of piece `first` on; None if all events of a period are the same, but for `allowed`.
    """
    pieces = equations.pieces
    K = equations.K
    fastest = max(abs(float(K.belt1.v)), abs(float(K.belt2.v)))
    size = max(abs(float(x)) for x, _ in points) + float(K.period) * fastest
    # Each event must be the one that begins the next piece, at its time and place.
    for j in range(1, len(pieces) + 1):
        i = (first + j) % len(pieces)
        ending = (i - 1) % len(pieces)
        piece = pieces[i]
        x, theta = points[i]
        due = (theta + (equations.turn if first + j >= len(pieces) else 0)) / K.Om
        if j > len(events):
            return EngineDifference(ending, inf, float(due))
        event = events[j - 1]
        late = abs(event.t - due)
        is_same = (event.boundary, event.target) == (piece.start, MODE_NAMES[piece.mode])
        is_off_time = late > allowed * K.period
        is_off_place = abs(event.x - x) > allowed * max(size, 1e-300)
        if not is_same or event.kind == "graze" or is_off_time or is_off_place:
            return EngineDifference(ending, late, float(event.t))
    return None


def _surest_start(equations: ClosingEquations, points: Points) -> int:
    """Return the number of the piece at whose start, the end of a flight, the forces on both sides
    of the belt are farthest from 0.
    """
    pieces = equations.pieces

    def least_force(i: int) -> float:
        """Return the smaller |F| of both sides where piece i starts."""
        (x, theta) = points[i]
        belt = pieces[i].start
        v = equations.belt(belt).v
        forces = (equations.force(domain, x, v, theta) for domain in NEIGHBOURS[belt])
        return min(abs(float(force)) for force in forces)

    after_flights = (i for i in range(len(pieces)) if not pieces[i - 1].sticks)
    return max(after_flights, key=least_force, default=0)
