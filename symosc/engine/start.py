"""How a motion starts: an exact initial value problem, and its first state in any arithmetic.

What a motion does from a point of a belt is decided here for all who ask: single motions, batches,
maps, orbits and crosschecks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from symosc.base.aliases import Number
from symosc.base.exact import power_of_ten
from symosc.engine.arithmetic import Arithmetic, MpArithmetic, column_functions
from symosc.engine.batch import rounded_covariance, row_of
from symosc.engine.first_exit import ROUNDING
from symosc.engine.flow import (
    Constants,
    belt_at,
    belt_forces,
    constant_force,
    constants,
    corrected,
    held_forces,
)
from symosc.engine.next_event import band_beyond, entered
from symosc.engine.state import BELT, DOMAIN_ABOVE, ON_BELT, STATE_ROW, Covariance, State
from symosc.kernels._generated import acceleration
from symosc.kernels.entire import EPS
from symosc.model import Model

#: Sine and cosine of a phase.
Phase: TypeAlias = tuple[Number, Number]

# Digits beyond those of the numbers of a problem, for a force that is 0 or not.
SPARE_DIGITS = 40
# A force on a belt at the start that is smaller than this part of its terms is decided with more
# digits.
CLEAR_FORCE = 1e-9
# A motion is searched period by period: more than this many would take hours.
MOST_PERIODS = 10**8
# One that is to go on for longer is followed for so many periods: it may come to rest meanwhile.
FAR_PERIODS = 1000
MOST_CORRECTIONS = 8  # each of them doubles the digits


@dataclass(frozen=True)
class Start:
    """An exact initial value problem.

    `start_error` holds the half-widths of t0, x0 and v0 (None: exact).
    """

    parameters: Model
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    start_error: tuple[Fraction, Fraction, Fraction] | None = None

    def __post_init__(self) -> None:
        if self.start_error and max(self.start_error) == 0:
            object.__setattr__(self, "start_error", None)

    @property
    def spare_digits(self) -> int:
        """The number of digits beyond the usual that resolve the gaps from v0 to the belts, and the
        errors of the start.
        """
        gaps = [self.v0 - edge.v for edge in self.parameters.law.edges]
        small = [abs(value) for value in (*(self.start_error or ()), *gaps) if value != 0]
        return max([0, *(power_of_ten(1 / value) for value in small)])


class BeltStart(NamedTuple):
    """How a motion goes on from a point of a belt (Theorems 4 and 5): its mode, and the forces that
    decided it.
    """

    boundary: int
    mode: int  # in which it goes on
    below: Number  # F^(below) + E and F^(above) - E
    above: Number
    E: Number

    @property
    def forces(self) -> tuple[Number, Number]:
        """Both forces in the first state: those that hold the mass in a stick, else the
        acceleration twice.
        """
        if self.mode > ON_BELT:
            return self.below, self.above
        if self.mode > self.boundary:
            force = self.above + self.E
        else:
            force = self.below - self.E
        return force, force


def belt_start(
    boundary: int, x: Number, phase: Phase, arithmetic: Arithmetic, allowed: Number = 0
) -> BeltStart:
    """Decide how a motion goes on at `x` of a belt (Theorems 4 and 5).

    Forces up to `allowed` in size count as 0.
    """
    # A force that is not larger than `allowed` is 0: then its first G-function that does not vanish
    # decides.
    K = arithmetic.K
    belt = belt_at(boundary, K)
    (s, c) = phase
    below, above = belt_forces(boundary, x, c, K)
    forces = held_forces(below, above, belt)
    below, above = (0 * force if abs(force) <= allowed else force for force in forces)
    where = arithmetic.namespace["resolve"](belt.v, below, above, s, c, K)
    if where == BELT and belt.is_corner:
        mode = boundary
    elif where == BELT:
        mode = ON_BELT + boundary
    else:
        mode = boundary + (where == DOMAIN_ABOVE)
    return BeltStart(boundary, mode, below, above, belt.E)


def belt_state(
    start: BeltStart,
    clock: tuple[int, Number],
    phase: Phase,
    x: Number,
    S: Covariance,
    K: Constants,
) -> State:
    """Return the State at time 0 of a start on a belt, from `clock` (periods, theta) and `phase`
    (sine, cosine).
    """
    v = belt_at(start.boundary, K).v
    zero = 0 * x
    return State(
        start.mode, start.boundary, *clock, x, v, *start.forces, S, zero, zero, *phase, zero
    )


def start_rows(
    at: np.ndarray,
    phase: tuple[np.ndarray, Any],
    x: np.ndarray,
    v: np.ndarray,
    times: Sequence[Any],
    K: Any,
) -> tuple[np.ndarray, np.ndarray]:
    """Return rows of a batch for columns of starts, and flags of starts on a belt where a force may be 0
    in doubles.

    `at` is the belt or 0, `phase` holds theta and theta_low, and `times` t, t_low, t_end, t_end_low
    and t0; `K` has the constants, for all rows or one for each.
    """
    # the domain; of a start on a belt for now the one below it
    mode = np.where(at > 0, at, 1 + (v > K.belt1.v) + (v > K.belt2.v))
    theta, theta_low = phase
    s, c = column_functions()["sine_cosine"](theta)
    if np.any(theta_low):
        s, c = corrected(s, c, theta_low)
    A_below, A_above = (np.choose(n - 1, [K.A1, K.A2, K.A3]) for n in (mode, mode + (at > 0)))
    below, above = (acceleration(x, v, c, A, K.cm, K.w0sq, K.f0) for A in (A_below, A_above))
    E = np.where(at > 0, np.where(at == 1, K.belt1.E, K.belt2.E), 0.0)
    held_below = below + E
    held_above = above - E
    terms = np.maximum(abs(A_below), abs(A_above)) + abs(K.f0) + abs(K.w0sq * x) + abs(K.cm * v)
    small = np.minimum(abs(held_below), abs(held_above)) <= CLEAR_FORCE * (terms + E)
    unclear = (at > 0) & small
    up = (at > 0) & (held_above > 0.0)
    down = (at > 0) & (held_below < 0.0)
    held = (at > 0) & ~up & ~down
    # In a flight both are its acceleration, in a stick the forces that hold the mass.
    Fb = np.where(up, above, np.where(held, held_below, below))
    Fa = np.where(up, above, np.where(held, held_above, below))
    t, t_low, t_end, t_end_low, t0 = times
    # A start is known to its rounding; the velocity on a belt is exact.
    rows = np.empty(len(at), STATE_ROW)
    rows["mode"] = np.where(held, ON_BELT + at, mode + up)
    rows["at"] = at
    rows["n"] = 0.0
    rows["theta"] = theta
    rows["x"] = x
    rows["v"] = v
    rows["Fb"] = Fb
    rows["Fa"] = Fa
    rows["S11"] = (EPS * x) ** 2
    rows["S12"] = 0.0
    rows["S22"] = np.where(at > 0, 0.0, EPS * v) ** 2
    rows["t"] = t
    rows["t_low"] = t_low
    rows["s"] = s
    rows["c"] = c
    rows["theta_low"] = theta_low
    rows["t_end"] = t_end
    rows["t_end_low"] = t_end_low
    rows["t0"] = t0
    return rows, unclear


def force_terms(boundary: int, x: Number, K: Constants) -> Number:
    """Return the size of the terms of the forces on a belt, the scale of their rounding errors."""
    belt = belt_at(boundary, K)
    A = (constant_force(n, K) for n in (boundary, boundary + 1))
    return max(map(abs, A)) + belt.E + abs(K.f0) + abs(K.w0sq * x) + abs(K.cm * belt.v)


def first_state(start: Start, arithmetic: Arithmetic) -> State:
    """Return the first State of a motion in the given arithmetic, which has the row of constants of
    the start (`symosc.friction.FrictionLaw.place_of`).

    Its count of forcing periods is 0 at t0.
    """
    # On a belt the forces decide where it goes (`belt_start`). Where one of them may be 0 that is
    # decided with more digits than the numbers of the problem have together: at t0 = 0 the forces
    # are rational, and so this is exact. A force that the error of the start can make 0 is 0.
    p = start.parameters
    K = arithmetic.K
    number = arithmetic.number
    eps = arithmetic.namespace["EPS"]
    x = number(start.x0)
    v = number(start.v0)
    (theta, theta_low) = arithmetic.phase(start.t0)
    phase: Phase = arithmetic.namespace["sine_and_cosine"](theta, theta_low)
    _, mode, at = p.law.place_of(start.v0)
    if at:
        begun = belt_start(at, x, phase, arithmetic)
        clear = CLEAR_FORCE * force_terms(at, x, K) + reach_of_error(start, arithmetic)
        if min(abs(begun.below), abs(begun.above)) <= clear:
            exact = _decided_start(start, at, arithmetic.row)
            forces = (exact.below, exact.above, exact.E)
            begun = BeltStart(exact.boundary, exact.mode, *map(arithmetic.rounded, forces))
        mode = begun.mode
        (Fb, Fa) = begun.forces
    else:
        Fb = Fa = acceleration(x, v, phase[1], constant_force(mode, K), K.cm, K.w0sq, K.f0)
    S = Covariance((eps * x) * (eps * x), 0 * x, 0 * v if at else (eps * v) * (eps * v))
    if start.start_error:
        dt, dx, dv = (number(error) for error in start.start_error)
        # Half-widths, no standard errors: with the factor 3 no sum of the three is underestimated
        # (Cauchy-Schwarz).
        S12 = 3 * v * Fb * dt**2
        S = Covariance(
            S.S11 + 3 * (dx**2 + (v * dt) ** 2), S12, S.S22 + 3 * (dv**2 + (Fb * dt) ** 2)
        )
    return State(mode, at, 0, theta, x, v, Fb, Fa, S, *arithmetic.time(start.t0), *phase, theta_low)


def begun(start: Start, arithmetic: Callable[[int], Arithmetic]) -> tuple[int, State]:
    """Return the row of constants in which a motion begins, and its first State there.

    `arithmetic` returns the arithmetic with a row of constants, by its number.
    """
    row = start.parameters.law.place_of(start.v0).row
    own = arithmetic(row)
    state = first_state(start, own)
    way = band_beyond(state.mode, own.K)
    if way:
        return row + way, entered(state, way)
    return row, state


def reach_of_error(start: Start, arithmetic: Arithmetic) -> Number:
    """Return the largest change of the forces on a belt that the error of the start may cause."""
    K = arithmetic.K
    number = arithmetic.number
    dt, dx, dv = (number(error) for error in start.start_error or (Fraction(0),) * 3)
    return K.w0sq * (dx + abs(number(start.v0)) * dt) + K.cm * dv + abs(K.fB) * dt


def _decided_start(start: Start, boundary: int, row: int) -> BeltStart:
    """Decide whether a motion sticks or leaves at its start on a belt, with enough digits to tell a
    force from 0.
    """
    p = start.parameters
    numbers = [start.t0, start.x0, start.v0, *p.numbers().values()]
    parts = (part for q in numbers for part in (q.numerator, q.denominator))
    digits = SPARE_DIGITS + sum(Decimal(part).adjusted() + 1 for part in parts)
    arithmetic = MpArithmetic(p, digits, row=row)
    x = arithmetic.number(start.x0)
    rounding = ROUNDING * arithmetic.namespace["EPS"] * force_terms(boundary, x, arithmetic.K)
    phase: Phase = arithmetic.namespace["sine_and_cosine"](*arithmetic.phase(start.t0))
    return belt_start(boundary, x, phase, arithmetic, rounding + reach_of_error(start, arithmetic))


def is_far(start: Start) -> bool:
    """Return whether a motion ends later than any is followed."""
    return start.t_end - start.t0 > longest_span(start.parameters)


def last_time(start: Start, arithmetic: Arithmetic) -> tuple[Number, Number]:
    """Return the end time in two parts: t_end or, if that is far, an earlier one.

    A motion that is to go on for too long is followed for a short time: it may come to rest.
    """
    if is_far(start):
        short = longest_span(start.parameters) * FAR_PERIODS / MOST_PERIODS
        return arithmetic.time(start.t0 + short)
    return arithmetic.time(start.t_end)


def longest_span(parameters: Model) -> Fraction:
    """Return the longest time for which a motion is followed: MOST_PERIODS periods of the drive.

    Without a drive it is MOST_PERIODS times the time that one search for an event covers.
    """
    if parameters.B0 == 0:  # no drive
        return MOST_PERIODS * Fraction(constants(parameters).chunk)
    # A period is 2 pi/Omega; the rational 44/7 is a little more than 2 pi.
    return Fraction(MOST_PERIODS * 44, 7) / parameters.Omega


def first_row_in_doubles(start: Start) -> tuple[int, tuple[Number, ...]]:
    """Return the number of the constants with which a motion begins, and its batch row in doubles."""
    return first_row(start, partial(Arithmetic, start.parameters))


def first_row(
    start: Start, arithmetic: Callable[[int], Arithmetic]
) -> tuple[int, tuple[Number, ...]]:
    """Return the number of the constants with which a motion begins, and its batch row (state,
    t_end in two parts, t0) there.

    `arithmetic` returns the arithmetic with a row of constants, by its number.
    """
    row, state = begun(start, arithmetic)
    return row, row_of(state, *last_time(start, arithmetic(row)))


def is_steady(start: Start) -> bool:
    """Return whether a start at t0 = 0 lies exactly on the periodic motion of its domain.

    False for any other t0.
    """
    p = start.parameters
    row = p.law.place_of(start.v0).row
    c = p.law.damping(p.c, row)
    forces = [p.A0 + force for force in p.law.rows[row].forces]
    pull = p.k - p.m * p.Omega**2
    drag = c * p.Omega
    size = pull * pull + drag * drag
    if start.t0 != 0 or size == 0 or start.start_error:
        return False
    # The steady motion at t = 0, without its mean: A/k, or a mean velocity A/c where k = 0.
    x = p.B0 * pull / size
    v = p.B0 * drag * p.Omega / size
    if p.k == 0:
        return c != 0 and any(start.v0 == v + force / c for force in forces)
    return start.v0 == v and any(start.x0 == x + force / p.k for force in forces)


def settles(start: Start) -> bool:
    """Return whether a start off the belts comes to rest without a contact, decided in rational
    numbers.
    """
    # The conditions are those of `symosc.engine.next_event`. The sign of u = g' + (h + w) g, with
    # w = sqrt(square), follows from the squares of its two parts: all numbers stay rational.
    p = start.parameters
    row, domain, at = p.law.place_of(start.v0)
    if p.B0 != 0 or start.start_error or at:
        return False
    of_row = p.law.rows[row]
    c = p.law.damping(p.c, row)
    h = c / (2 * p.m)
    square = h * h - p.k / p.m
    a = (p.A0 + of_row.forces[domain - 1] - p.k * start.x0 - c * start.v0) / p.m
    if a == 0 and start.v0 == 0:
        return True
    if square < 0:
        return False
    edges = (None, of_row.below, of_row.above, None)
    for edge, side in ((edges[domain - 1], 1), (edges[domain], -1)):
        if edge:
            v = edge.v
            gap = side * (start.v0 - v)
            rational_part = side * a + h * gap  # of u; the other part is w * gap >= 0
            is_negative = rational_part < 0 and rational_part**2 > square * gap * gap
            if side * p.k * v > 0 or is_negative:
                return False
    return True


def rounded(state: State, t0: float, gain: float) -> State:
    """Round a state to doubles and add this rounding to its error.

    `gain` is the relative rounding error of Omega.
    """
    mode, at, n, theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low = state
    high = float(t)
    phase = float(theta)
    x = float(x)
    v = float(v)
    low = float(t - high + t_low) - (high - t0) * gain  # see `symosc.engine.flow.clock_time`
    S = Covariance(*rounded_covariance(at, x, v, float(S.S11), float(S.S12), float(S.S22)))
    rest = float(theta - phase + theta_low)
    return State(
        mode, at, n, phase, x, v, float(Fb), float(Fa), S, high, low, float(s), float(c), rest
    )


def continued(state: State, eps: Fraction, arithmetic: MpArithmetic) -> State:
    """Convert a state to the digits of `arithmetic`, and add its earlier relative rounding `eps` to
    its error.
    """
    # Phase and time have the rounding too: it is an error of x and v that such a part of a period
    # makes. Where the force is 0, at the end of a stick or a touch, the time is made right to all
    # digits: else a force would act for ever.
    K = arithmetic.K
    rounded = arithmetic.rounded
    S = state.S
    theta = rounded(state.theta) + state.theta_low
    t = rounded(state.t) + state.t_low
    x = rounded(state.x)
    v = state.v
    if state.at:
        v = belt_at(state.at, K).v
    else:
        v = rounded(v)

    def forces() -> tuple[Number, Number]:
        if state.mode > ON_BELT:
            belt = belt_at(state.at, K)
            below, above = belt_forces(state.at, x, phase[1], K)
            return held_forces(below, above, belt)
        return (
            acceleration(x, v, phase[1], constant_force(state.mode, K), K.cm, K.w0sq, K.f0),
        ) * 2

    turn = arithmetic.namespace["sine_and_cosine"]
    phase: Phase = turn(theta, 0 * theta)
    if K.driven:
        span = K.period
    else:
        span = 1 / K.beat
    part = span * arithmetic.number(eps)
    missing = 0 * x
    Fb, Fa = forces()
    if state.mode <= ON_BELT and state.Fb == 0:
        for _ in range(MOST_CORRECTIONS):
            s, _ = phase
            slope = K.fB * s + K.w0sq * v  # how fast the force falls, at a constant v
            if abs(Fb) <= abs(slope) * span:
                shift = Fb / slope
            else:
                shift = 0 * x
            theta = theta + K.Om * shift
            t = t + shift
            x = x + v * shift
            phase = turn(theta, 0 * theta)
            Fb, Fa = forces()
            if abs(shift) <= arithmetic.namespace["EPS"] * span:
                break
        missing = abs(Fb) * span
        Fa = 0 * x
        Fb = 0 * x
    if state.Fb == 0:
        Fb = 0 * x
    if state.Fa == 0:
        Fa = 0 * x
    dx = (abs(x) / span + abs(v)) * part
    dv = missing
    if state.mode <= ON_BELT:
        dv = dv + (abs(Fb) + (0 if state.at else abs(v) / span)) * part
    S = Covariance(S.S11 + dx * dx, rounded(S.S12), S.S22 + dv * dv)
    return State(*state[:3], theta, x, v, Fb, Fa, S, t, 0 * x, *phase, 0 * x)
