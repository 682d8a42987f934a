"""The summary of a motion, updated at every step, in memory independent of the number of events.

This file is executed with other globals: see symosc/kernels/rebind.py.

A step of the event loop (`symosc.engine.next_event.advance`) is a flight or a stick without an
event inside. The events at their ends are always counted. Where it is asked for, also the share of
the time on belts, the extremes, and the sections that the motion passes. Sections are where a
forcing period ends, Omega t = 2 pi n; the mappings between two of them make a word. An event so
near a section that its error could move it across belongs to the period that begins there. Of a
section the state is kept from which it is reached; only those that are asked for, or that words do
not already distinguish, are computed, once, at the end (`settle`).

Extremes: the belts bound the velocity of a flight, so mostly one or two of the four are in
question. A flight lies within the extremes so far if one like it, whose own extremes are known,
lies far enough within (`lies_within`). Any other is searched. A cell of it lies within the extremes
found if the bounds of `symosc.engine.first_exit`, taken at both of its ends, say so: v and x minus
an extreme are gaps like those to a belt. Any other cell is cut, at a stationary point where there
is one between its ends, and each new end is evaluated exactly. So no extreme is missed.

Arguments that many functions share: `i` is the number of the motion, `tally` holds the tallies of
all, `t0` is its start and `K` its constants. `seen` and `own` are extremes, of the motion and of
one flight, and `open_ends` says which of them are in question. `start` is the Launch of a flight at
position `x0`; `now` and `then` are points of it, and `M4` bounds the fourth derivative of v.

All functions are scalar and run on floats (CPython, numba).
"""

from __future__ import annotations

from functools import cache
from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np

from symosc.engine.first_exit import NEAR, fourth_derivative_bound, positive_on, shifted
from symosc.engine.flow import (
    clock_time,
    constant_force,
    derivatives,
    sine_and_cosine,
    speeds_around,
    state_at,
)
from symosc.engine.next_event import TWO_PI, advance_phase
from symosc.engine.state import END, GRAZE, ON_BELT, REST, STATE_ROW, STICK, Flown, Launch, State
from symosc.friction import MAPS
from symosc.kernels._generated import acceleration, motion
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import EPS, SIXTH, basis_with_drive
from symosc.kernels.rebind import outlined

# Columns of `Tally.floats`: time that is left out, stuck time, extremes, the last state, and (LOW,
# HIGH) the extremes of the ends of steps alone.
SKIPPED, STUCK, X_MIN, X_MAX, V_MIN, V_MAX, T_LAST, X_LAST, V_LAST, X_LOW, X_HIGH, V_LOW, V_HIGH = (
    range(13)
)
# Columns of `Tally.ints`: events and sticks; the belt of the last event; sections so far; whether
# the word began at a section, whether the next section comes just behind the last event; lengths of
# the word now and of the last one; the code of the word now; flights that were searched for
# extremes, and the one of them that the last flight was like.
EVENTS_SO_FAR, STICKS, PLANE, SECTIONS, WHOLE, EARLY, LENGTH, LAST_LENGTH, CODE, SEARCHED, LIKE = (
    range(11)
)
# Columns of `Tally.flights`: domain, phase, position and velocity at the launch, duration, and the
# flight's own extremes.
MODE, THETA, X, V, DURATION, OWN_X_MIN, OWN_X_MAX, OWN_V_MIN, OWN_V_MAX = range(9)
KEPT_FLIGHTS = 8
# Columns of `Tally.sections`: whether a flight reaches it, since when, the state at its launch, and
# the variances.
FLIES, SINCE, FROM_THETA, FROM_X, FROM_V, FROM_F, S11_THERE, S22_THERE = range(8)
# An event, or the end of a motion, is at a section if its phase is not farther from it, beside its
# error.
AT_SECTION = 1e-9
MOST_AT_SECTION = 1e-3  # the largest error of a phase that counts so
# Words of a period are compared by a number; of up to 17 mappings by all of them. Small enough for
# 64 bits.
WORD_MODULUS = 2**56 - 5
TRANSIENT = 45.0  # a transient is over after so many of its decay times
MOST_REST_STEPS = 2**62
LEAST_RING = 2  # with a ring of one section a way over two of them would count as one without end
LONGEST_REPEAT = 32  # periods after which a motion may repeat, at most
# Two sections are the same if they differ by less than this part of the motion's extent, and this
# times their errors.
SAME_PART = 1e-6
SAME_ERRORS = 8.0
# How far beyond an extreme a bound may be, as a part of the extremes' size: some units in the last
# place.
WIDTH_SLACK = 16.0 * EPS
# The first cell of a flight, times 1/rate, and the shortest: there nothing can be hidden.
FIRST_CELL = 3.0
SHORTEST_CELL = 1e-6
MOST_CELLS = 100_000
MOST_STATIONARY_STEPS = 8
CUT_AWAY = 1e-3  # how far from the ends of a cell a place to cut is at least, as a part of it

_MAP_CODES = {
    (row.start.boundary, row.mode, row.end.boundary): int(label[1:]) for label, row in MAPS.items()
}
#: Number of the mapping by (belt at its start, mode, belt at its end); 0 for none.
MAP_OF = np.array(
    [_MAP_CODES.get((at, mode, to), 0) for at in range(3) for mode in range(6) for to in range(3)]
)
# The paper's mappings; those that a further belt adds come behind (`symosc.friction.geometry`).
PAPER_MAPS = len(MAPS)
MAPS_OF_BELT = 5
# Words are digits to this base, 9 for the paper's mappings.
BASE_OF_BANDED = 64


class Kept(NamedTuple):
    """What a tally (the running summary of a motion) keeps beside events: time on belts, extremes,
    sections, words.
    """

    stuck: bool  # the time on belts
    extent: bool  # the extremes at the ends of steps
    inside: bool  # also the extremes inside flights
    ring: int  # sections; 0: neither these nor words
    longest: int  # mappings of a word


class Tally(NamedTuple):
    """The running summaries of many motions, a row each, with ring buffers of the last sections,
    words and flights.
    """

    asked: Kept
    floats: np.ndarray  # (n, 13)
    ints: np.ndarray  # (n, 11)
    sections: np.ndarray  # (n, ring, 8)
    words: np.ndarray  # (n, ring), of the periods that end at these sections; -1 for none
    labels: np.ndarray  # (n, 2, longest word): mappings of the word now, and of the last whole one
    flights: np.ndarray  # (n, KEPT_FLIGHTS, 9), those last searched for extremes


class Extremes(NamedTuple):
    """The smallest and the largest position and velocity so far."""

    x_min: float
    x_max: float
    v_min: float
    v_max: float


class Open(NamedTuple):
    """Flags of the extremes that a flight may still exceed: the least v, the largest v, and both of
    x.
    """

    v_min: bool
    v_max: bool
    x: bool  # its velocity may change its sign


@cache
def no_tally() -> Tally:
    """Return a tally without a motion.

    Given this, the event loop records single events instead of summaries.
    """
    none = np.zeros(0)
    return new_tally(np.zeros(0, STATE_ROW), none, none, Kept(False, False, False, 0, 0))


def new_tally(states: np.ndarray, planes: np.ndarray, skipped: np.ndarray, asked: Kept) -> Tally:
    """Return the tally of motions at their starts (rows of a batch).

    `planes` are the belts on which they start, or 0; the time `skipped` is not counted.
    """
    # The last numbers of the shapes count the columns that are named above.
    count = len(states)
    floats = np.zeros((count, 13))
    ints = np.zeros((count, 11), np.int64)
    floats[:, SKIPPED] = skipped
    floats[:, [X_MIN, V_MIN, X_LOW, V_LOW]] = inf
    floats[:, [X_MAX, V_MAX, X_HIGH, V_HIGH]] = -inf
    floats[:, T_LAST] = states["t"]
    floats[:, X_LAST] = states["x"]
    floats[:, V_LAST] = states["v"]
    ints[:, PLANE] = planes
    # The word that is being collected is whole if it begins at a section.
    ints[:, WHOLE] = states["theta"] == 0.0
    # Places of sections that were not reached are never read.
    sections = np.empty((count, asked.ring, 8))
    words = np.full((count, asked.ring), -1, np.int64)
    labels = np.zeros((count, 2, asked.longest), np.uint8)
    flights = np.empty((count, asked.inside * KEPT_FLIGHTS, 9))
    return Tally(asked, floats, ints, sections, words, labels, flights)


def select_tallies(tally: Tally, rows: Any) -> Tally:
    """Return a copy of the tally with the given `rows` (motions) only."""
    if len(tally.floats):
        return Tally(tally.asked, *(column[rows].copy() for column in tally[1:]))
    return tally


def store_tallies(tally: Tally, rows: Any, own: Tally) -> None:
    """Write `own`, the tally of some motions from `select_tallies`, back into `rows` of the tally
    of all.
    """
    if len(tally.floats):
        for column, part in zip(tally[1:], own[1:], strict=True):
            column[rows] = part


# --- step by step ---


def tally_step(i, before, event, t0, tally, K):
    """Add a step of motion `i`, from the state `before` to the NextEvent `event`, to its tally."""
    after = event.state
    asked = tally.asked
    ints = tally.ints
    if event.code <= GRAZE and (after.t - t0) + after.t_low >= tally.floats[i, SKIPPED]:
        ints[i, EVENTS_SO_FAR] += 1
        ints[i, STICKS] += event.code == STICK
    if asked.extent or (asked.stuck and before.mode > ON_BELT):
        tau = (after.t - before.t) + (after.t_low - before.t_low)
        tally_stretch(i, before, after, tau, t0, tally, K)
    if asked.ring == 0:
        return
    if after.n > before.n:
        tally_sections(i, before, after.n, after.S, tally, K)
    if event.code <= GRAZE:
        to_section = TWO_PI - after.theta
        reach = 8.0 * (K.Om * event.t_error)  # eight standard errors of the phase
        near = to_section < AT_SECTION + (reach if reach < MOST_AT_SECTION else MOST_AT_SECTION)
        if near and ints[i, EARLY] == 0:
            close_word(i, tally)
            ints[i, EARLY] = 1
        boundary = event.boundary
        base = 9
        if K.banded:
            boundary = boundary + int(K.shift)
            base = BASE_OF_BANDED
            code = map_number(ints[i, PLANE], before.mode, boundary, K)
        else:
            # `MAP_OF` is flat: belt before (0: none), 6 modes, belt after.
            code = int(MAP_OF[(ints[i, PLANE] * 6 + before.mode) * 3 + boundary])
        if code > 0:
            length = ints[i, LENGTH]
            if length < tally.labels.shape[2]:
                tally.labels[i, 0, length] = code
            ints[i, LENGTH] = length + 1
            # a number whose digits to the base 9 are the mappings 1 to 8
            ints[i, CODE] = (ints[i, CODE] * base + code) % WORD_MODULUS
        ints[i, PLANE] = boundary


def map_number(at, mode, to, K):
    """Return the number of the mapping from belt `at` (0: none) to belt `to` in a mode of the row K;
    0 if there is none.
    """
    domain = 2 + int(K.shift)
    if mode > ON_BELT:
        at = to
        kind = 1
    elif at == to:
        kind = 2 if domain == to else 3
    else:
        kind = 4 if at > to else 5
    if at == 0:
        return 0
    belt = max(at, to)
    if belt > 2:
        return PAPER_MAPS + (belt - 3) * MAPS_OF_BELT + kind
    if kind > 3:  # passages between belts 1 and 2
        return kind + 3
    return 3 * (belt - 1) + kind


def launch_of(state):
    """Return the Launch (v, F, and the phase's sine and cosine) of a flight that begins in `state`."""
    return Launch(state.v, state.Fb, state.s, state.c)


def tally_stretch(i, before, after, tau, t0, tally, K):
    """Add stick time and extremes between two states, `tau` apart, to motion i's tally, without
    skipped time.
    """
    floats = tally.floats
    asked = tally.asked
    begin = floats[i, SKIPPED] - ((before.t - t0) + before.t_low)
    if tau < begin:
        return
    if not (begin > 0.0):
        begin = 0.0
    x = before.x
    v = before.v
    if before.mode > ON_BELT:
        floats[i, STUCK] += tau - begin
        x = x + v * begin
    elif begin > 0.0 and asked.extent:
        now = state_at(begin, launch_of(before), K)
        x = x + now.dx
        v = v + now.dv
    if not asked.extent:
        return
    ends = Extremes(floats[i, X_LOW], floats[i, X_HIGH], floats[i, V_LOW], floats[i, V_HIGH])
    ends = widened(widened(ends, x, v), after.x, after.v)
    floats[i, X_LOW], floats[i, X_HIGH], floats[i, V_LOW], floats[i, V_HIGH] = ends
    if not asked.inside:
        return
    seen = Extremes(floats[i, X_MIN], floats[i, X_MAX], floats[i, V_MIN], floats[i, V_MAX])
    seen = widened(widened(seen, x, v), after.x, after.v)
    if before.mode <= ON_BELT:
        slowest, fastest = speeds_around(before.mode, K)
        open_ends = Open(seen.v_min > slowest, seen.v_max < fastest, slowest < 0.0 < fastest)
        search = open_ends.v_min or open_ends.v_max or open_ends.x
        if search and not (begin == 0.0 and lies_within(i, before, tau, seen, open_ends, tally, K)):
            start = launch_of(before)
            last = end_of_flight(before, after, tau, K)
            ends = widened(Extremes(x, x, v, v), after.x, after.v)
            own = flight_extremes(begin, last, start, before.x, ends, open_ends, K)
            if begin == 0.0:
                keep_flight(i, before, tau, own, tally, K)
            seen = widened(widened(seen, own.x_min, own.v_min), own.x_max, own.v_max)
    floats[i, X_MIN], floats[i, X_MAX], floats[i, V_MIN], floats[i, V_MAX] = seen


def keep_flight(i, state, tau, own, tally, K):
    """Store a flight (start `state`, duration `tau`, extremes `own`) in the tally, to compare later
    flights with.
    """
    flights = tally.flights
    n = tally.ints[i, SEARCHED] % KEPT_FLIGHTS
    tally.ints[i, SEARCHED] += 1
    flights[i, n, MODE] = state.mode + 8 * K.row
    flights[i, n, THETA] = state.theta
    flights[i, n, X] = state.x
    flights[i, n, V] = state.v
    flights[i, n, DURATION] = tau
    flights[i, n, OWN_X_MIN] = own.x_min
    flights[i, n, OWN_X_MAX] = own.x_max
    flights[i, n, OWN_V_MIN] = own.v_min
    flights[i, n, OWN_V_MAX] = own.v_max


def lies_within(i, state, tau, seen, open_ends, tally, K):
    """Return whether a flight from `state` surely stays within the extremes `seen`, as a similar
    earlier flight did.

    `open_ends` says which extremes are in question. Two flights in one band differ, at equal times
    since their launch, by a steady motion, driven by the difference of their drives, plus a free
    motion, the root of whose energy dv^2 + (k/m) dx^2 never grows by more than `K.growth`. Where
    these two are not separated (near resonance), the root of the energy grows no faster, but for
    this factor, than the difference of the drives, which is B0/m times that of the phases.
    """
    if K.w0 == 0.0:  # without a spring the energy says nothing of x
        return False
    flights = tally.flights
    count = min(tally.ints[i, SEARCHED], KEPT_FLIGHTS)
    n = tally.ints[i, LIKE]
    mode = state.mode + 8 * K.row
    v_slack = 0.5 * WIDTH_SLACK * (abs(seen.v_min) + abs(seen.v_max))
    x_slack = 0.5 * WIDTH_SLACK * (abs(seen.x_min) + abs(seen.x_max))
    # by how much the root of the energy may differ, per difference of the phases
    if K.steady:
        turned_by = K.V0 * (1.0 + K.w0 / K.Om) * (1.0 + K.growth)
    else:
        turned_by = abs(K.f0) * tau * K.growth
    for _ in range(count):  # from the one behind the last on: motions repeat
        if n + 1 < count:
            n = n + 1
        else:
            n = 0
        if flights[i, n, MODE] == mode and tau <= flights[i, n, DURATION] * (1.0 + WIDTH_SLACK):
            distance = abs(state.v - flights[i, n, V]) + K.w0 * abs(state.x - flights[i, n, X])
            distance = distance * K.growth + turned_by * abs(state.theta - flights[i, n, THETA])
            v_distance = distance - v_slack
            x_distance = distance * K.swing - x_slack
            if (
                (not open_ends.v_min or flights[i, n, OWN_V_MIN] - v_distance >= seen.v_min)
                and (not open_ends.v_max or flights[i, n, OWN_V_MAX] + v_distance <= seen.v_max)
                and (not open_ends.x or flights[i, n, OWN_X_MIN] - x_distance >= seen.x_min)
                and (not open_ends.x or flights[i, n, OWN_X_MAX] + x_distance <= seen.x_max)
            ):
                tally.ints[i, LIKE] = n
                return True
    return False


def tally_sections(i, before, last, S, tally, K):
    """Store the Poincaré sections from the state `before` to the end of period number `last` in the
    tally.
    """
    ring = tally.words.shape[1]
    first = before.n + 1
    if last - first >= ring:  # a long way without an event: all but the last words are empty
        close_word(i, tally)
        tally.ints[i, SECTIONS] += (last - ring) - first
        first = last - ring
        tally.ints[i, EARLY] = 1
    S_x = max(before.S.S11, S.S11)
    S_v = max(before.S.S22, S.S22)
    for period in range(first, last + 1):
        tau = ((period - before.n) * TWO_PI - before.theta) / K.Om
        keep_section(i, before, tau, S_x, S_v, tally, K)


def keep_section(i, before, tau, S_x, S_v, tally, K):
    """Store the section at `tau` after `before`, with variances S_x, S_v.

    End the period's word if still open.
    """
    ints = tally.ints
    if ints[i, EARLY] == 0:
        close_word(i, tally)
    kept = tally.sections[i, ints[i, SECTIONS] % tally.words.shape[1]]
    if before.mode <= ON_BELT and tau > 0.0:
        kept[FLIES] = 1.0
    else:
        kept[FLIES] = 0.0
    kept[SINCE] = tau
    kept[FROM_THETA] = before.theta
    kept[FROM_X] = before.x
    kept[FROM_V] = before.v
    kept[FROM_F] = before.Fb
    kept[S11_THERE] = S_x
    kept[S22_THERE] = S_v
    number = ints[i, SECTIONS]
    ints[i, SECTIONS] += 1
    ints[i, EARLY] = 0
    if K.banded:  # later the motion is in another band
        section(i, number, tally, K)


def close_word(i, tally):
    """Store the word of the period that ends now, if its beginning was seen, and begin the word of
    the next.
    """
    ints = tally.ints
    labels = tally.labels
    ring = tally.words.shape[1]
    length = ints[i, LENGTH]
    if ints[i, WHOLE] == 1:
        # Words are told apart by their code and, in the last 6 bits, their length modulo 64.
        tally.words[i, ints[i, SECTIONS] % ring] = ints[i, CODE] * 64 % WORD_MODULUS + length % 64
        for n in range(min(length, labels.shape[2])):
            labels[i, 1, n] = labels[i, 0, n]
        ints[i, LAST_LENGTH] = length
    else:
        tally.words[i, ints[i, SECTIONS] % ring] = -1
    ints[i, WHOLE] = 1
    ints[i, LENGTH] = 0
    ints[i, CODE] = 0


@outlined
def finish_tally(i, last, code, remaining, t0, tally, K):
    """Store the `last` state of motion `i` in its tally, moved on by `remaining` if no more events
    come (REST).
    """
    n = last.n
    theta = last.theta
    t = clock_time(last.t, last.t_low, t0, K)
    x = last.x
    v = last.v
    if code == REST:  # without any more events
        rest = rest_of(remaining, K)
        n, theta, _ = advance_phase(last.n, last.theta, last.theta_low, rest, K)
        n = n + int((remaining - rest) / K.period + 0.5)  # whole periods, rounded
        if tally.asked.extent or tally.asked.stuck:
            rest_stretches(i, last, remaining, t0, tally, K)
        if tally.asked.ring > 0:
            tally_sections(i, last, n, last.S, tally, K)
        t = last.t + remaining
        x = last.x + last.v * remaining
        if last.mode <= ON_BELT:
            turn = theta - last.theta
            x, v = flown(last.x, launch_of(last), remaining, sin(turn), cos(turn), K)
    tally.floats[i, T_LAST] = t
    tally.floats[i, X_LAST] = x
    tally.floats[i, V_LAST] = v
    section_is_ahead = TWO_PI - theta < AT_SECTION
    if code in (END, REST) and tally.asked.ring > 0 and section_is_ahead:
        clock = t, last.t_low, sin(theta), cos(theta), 0.0
        state = State(last.mode, last.at, n, theta, x, v, last.Fb, last.Fa, last.S, *clock)
        keep_section(i, state, 0.0, state.S.S11, state.S.S22, tally, K)


def rest_of(tau, K):
    """Return `tau` modulo the forcing period, corrected for the rounding error of that period."""
    if tau < K.period:
        return tau
    rest = tau % K.period
    turns = (tau - rest) / K.period
    rest = rest - turns * K.period_low
    if rest >= 0.0:
        return rest
    return 0.0


@outlined
def rest_stretches(i, state, remaining, t0, tally, K):
    """Add stick time and extremes of the motion after its last event, for the `remaining` time, to
    its tally.
    """
    # Its extremes are searched piece by piece, until the transient is over; then one period shows
    # all that is to come.
    if K.under:
        decay = K.h
    else:
        decay = -K.l1
    fades = decay > 0.0 and K.w0 > 0.0 and state.mode <= ON_BELT
    now = state
    passed = 0.0
    for _ in range(MOST_REST_STEPS):
        if state.mode > ON_BELT or remaining - passed < K.chunk:
            step = remaining - passed
        else:
            step = K.chunk
        x = now.x + now.v * step
        v = now.v
        F = now.Fb
        if state.mode <= ON_BELT:
            there = state_at(step, launch_of(now), K)
            x = now.x + there.dx
            v = now.v + there.dv
            F = there.F
        _, phase, theta_low = advance_phase(0, now.theta, now.theta_low, step, K)
        clock = now.t + step, now.t_low, *sine_and_cosine(phase, theta_low), theta_low
        then = State(now.mode, 0, now.n, phase, x, v, F, F, now.S, *clock)
        tally_stretch(i, now, then, step, t0, tally, K)
        passed = passed + step
        shown = not K.driven or passed > 2.0 * K.period
        if passed >= remaining or (fades and decay * (passed - K.chunk) > TRANSIENT and shown):
            break
        now = then


@outlined
def flown(x, start, tau, s_Om, c_Om, K):
    """Return x and v of a flight `tau` after its Launch `start` at `x`.

    `s_Om` and `c_Om` are sine and cosine of Omega tau.
    """
    E0, E1, E2, R2, I2, _, _ = basis_with_drive(tau, s_Om, c_Om, K)
    dx, dv, _ = motion(
        start.v, start.F, start.s, start.c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2
    )
    return x + dx, start.v + dv


# --- at the end: the last sections, and after how many periods they repeat ---


@outlined
def settle(tally, sets, table, sections, repeats):
    """Fill `sections`, (n, m, 2), with x and v at the last m sections of motions, `repeats` with
    their multiplicity.
    """
    # `sets` (n,) are the parameter sets of the motions, `table` their constants. `sections` (n, m,
    # 2) is filled with x and v at the last m sections in order of time, as far as they were
    # reached, and `repeats`, (n,) or (0,), with the periods, 0 for a motion that does not repeat.
    wanted = sections.shape[1]
    for i in range(sets.shape[0]):
        K = table[sets[i]]
        there = tally.ints[i, SECTIONS]
        for n in range(wanted if wanted < there else there):
            kept = section(i, there - 1 - n, tally, K)
            sections[i, wanted - 1 - n, 0] = kept[FROM_X]
            sections[i, wanted - 1 - n, 1] = kept[FROM_V]
        if repeats.shape[0] > 0:
            repeats[i] = periods(i, tally, K)


@outlined
def periods(i, tally, K):
    """Return the number of periods after which words and sections repeat, twice in a row; 0 if they
    do not.
    """
    there = tally.ints[i, SECTIONS]
    for m in range(1, LONGEST_REPEAT + 1):
        if 2 * m > there:
            return 0
        if same_words(i, m, tally) and same_sections(i, m, tally, K):
            return m
    return 0


def same_words(i, m, tally):
    """Return whether the last m words of motion `i` are complete and equal the m words before."""
    there = tally.ints[i, SECTIONS]
    ring = tally.words.shape[1]
    words = tally.words
    for n in range(there - m, there):
        before = words[i, (n - m) % ring]
        if before < 0 or words[i, n % ring] != before:
            return False
    return True


def same_sections(i, m, tally, K):
    """Return whether the last m sections equal the m before, up to SAME_PART of the ranges of x and
    v, plus SAME_ERRORS errors.
    """
    floats = tally.floats
    there = tally.ints[i, SECTIONS]
    x_extent = floats[i, X_HIGH] - floats[i, X_LOW]
    v_extent = floats[i, V_HIGH] - floats[i, V_LOW]
    for n in range(there - m, there):
        now = section(i, n, tally, K)
        before = section(i, n - m, tally, K)
        x_error = sqrt(now[S11_THERE]) + sqrt(before[S11_THERE])
        v_error = sqrt(now[S22_THERE]) + sqrt(before[S22_THERE])
        same = abs(now[FROM_X] - before[FROM_X]) <= SAME_PART * x_extent + SAME_ERRORS * x_error
        if not (
            same
            and abs(now[FROM_V] - before[FROM_V]) <= SAME_PART * v_extent + SAME_ERRORS * v_error
        ):
            return False
    return True


@outlined
def section(i, n, tally, K):
    """Return Poincaré section number `n` of motion `i` from its tally.

    Compute x and v there at the first call.
    """
    kept = tally.sections[i, n % tally.words.shape[1]]
    x = kept[FROM_X]
    v = kept[FROM_V]
    tau = kept[SINCE]
    theta = kept[FROM_THETA]
    if kept[FLIES] > 0.0:
        s = sin(theta)
        c = cos(theta)
        # At a section Omega t = 2 pi n, so that Omega tau = -theta but for whole turns.
        x, v = flown(x, Launch(v, kept[FROM_F], s, c), tau, -s, c, K)
    else:
        x = x + v * tau
    kept[FLIES] = 0.0
    kept[SINCE] = 0.0
    kept[FROM_X] = x
    kept[FROM_V] = v
    return kept


# --- the extremes of a flight, its stationary points included ---


def widened(seen, x, v):
    """Return the extremes extended to include a point (x, v)."""
    return Extremes(
        x if x < seen.x_min else seen.x_min,
        x if x > seen.x_max else seen.x_max,
        v if v < seen.v_min else seen.v_min,
        v if v > seen.v_max else seen.v_max,
    )


@outlined
def flight_extremes(begin, last, start, x0, own, open_ends, K):
    """Extend `own`, the extremes of the ends of a flight, to those of the flight from time `begin`
    to point `last`.

    `start` is its Launch, `x0` the position there, and `open_ends` says which extremes are in
    question.
    """
    if begin > 0.0:
        now = state_at(begin, start, K)
    else:
        now = point(0.0, 0.0, 0.0, start, K)
    cell = FIRST_CELL * K.moment
    for _ in range(MOST_CELLS):
        if now.tau >= last.tau:
            break
        M4 = fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K)
        if not K.steady and cell * K.Om > 1.0:  # M4 holds for 1/Omega only
            cell = 1.0 / K.Om
        then = last
        if cell < last.tau - now.tau:
            then = state_at(now.tau + cell, start, K)
            own = widened(own, x0 + then.dx, start.v + then.dv)
        wider = cell_extremes(now, then, M4, start, x0, own, open_ends, K)
        if wider == own:  # nothing new was found: longer cells may do
            cell = 2.0 * cell
        else:
            cell = FIRST_CELL * K.moment
        now = then
        own = wider
    return own


def end_of_flight(before, after, tau, K):
    """Return the end of a flight as a point (`Flown`, without its E0, E1, E2) from the states
    before and after it.
    """
    if K.stiff:  # derivatives need `stiff_derivatives`
        return state_at(tau, launch_of(before), K)
    F = acceleration(after.x, after.v, after.c, constant_force(before.mode, K), K.cm, K.w0sq, K.f0)
    return point(
        tau, after.x - before.x, after.v - before.v, Launch(after.v, F, after.s, after.c), K
    )


def point(tau, dx, dv, there, K):
    """Return a point (`Flown`) with gains dx, dv at `tau`; `there` has v, F, sine, cosine.

    E0, E1, E2, which carry errors only, are those at tau = 0.
    """
    v, F, s, c = there
    G1, G2, G3 = derivatives(v, F, s, c, K)
    return Flown(tau, dx, dv, F, G1, G2, G3, s, c, 1.0, 0.0, 0.0)


@outlined
def cell_extremes(now, then, M4, start, x0, own, open_ends, K):
    """Extend the extremes `own` by those of a flight between the points `now` and `then`, which
    `own` includes.
    """
    while (then.tau - now.tau) * K.rate > SHORTEST_CELL and not cell_within(
        now, then, M4, start.v, x0, own, open_ends
    ):
        middle = cut_at(now, then, start, open_ends, K)
        own = widened(own, x0 + middle.dx, start.v + middle.dv)
        own = cell_extremes(now, middle, M4, start, x0, own, open_ends, K)
        now = middle
    return own


@outlined
def cell_within(now, then, M4, v0, x0, seen, open_ends):
    """Return whether bounds from both ends prove that a flight between points `now` and `then`
    stays within `seen`.
    """
    half = 0.5 * (then.tau - now.tau)
    return within(half, 1.0, now, M4, v0, x0, seen, open_ends) and within(
        half, -1.0, then, M4, v0, x0, seen, open_ends
    )


@outlined
def within(reach, direction, now, M4, v0, x0, seen, open_ends):
    """Return whether a flight stays in the extremes `seen` for a time `reach` after point `now`
    (`direction` 1), or before it (-1).
    """
    v = v0 + now.dv
    x = x0 + now.dx
    if open_ends.v_max or open_ends.v_min:
        slack = WIDTH_SLACK * (abs(seen.v_min) + abs(seen.v_max))
        slope = direction * now.F
        half = 0.5 * now.G1
        third = direction * SIXTH * now.G2
        fourth = -0.25 * SIXTH * M4
        if open_ends.v_max and not stays_positive(
            reach, seen.v_max - v + slack, -slope, -half, -third, fourth
        ):
            return False
        if open_ends.v_min and not stays_positive(
            reach, v - seen.v_min + slack, slope, half, third, fourth
        ):
            return False
    if not open_ends.x:
        return True
    slack = WIDTH_SLACK * (abs(seen.x_min) + abs(seen.x_max))
    # M3 bounds the fourth derivative of x, the third of v.
    M3 = abs(now.G2) + (abs(now.G3) + 0.5 * M4 * reach) * reach
    slope = direction * v
    half = 0.5 * now.F
    third = direction * SIXTH * now.G1
    fourth = -0.25 * SIXTH * M3
    return stays_positive(
        reach, seen.x_max - x + slack, -slope, -half, -third, fourth
    ) and stays_positive(reach, x - seen.x_min + slack, slope, half, third, fourth)


def stays_positive(reach, p0, p1, p2, p3, p4):
    """Return whether the polynomial with the coefficients p0 to p4 is proven positive on [0, reach],
    even if it falls at first.
    """
    # p1 s + p2 s^2/2 is not below -p1^2/(2 p2): that is taken off p0, and half of p2 is left
    if p1 < 0.0 and p2 > 0.0 and p1 * p1 < 2.0 * p0 * p2:
        return positive_on(reach, (p0 - 0.5 * p1 * p1 / p2, 0.0, 0.5 * p2, p3, p4))
    return positive_on(reach, (p0, p1, p2, p3, p4))


@outlined
def cut_at(now, then, start, open_ends, K):
    """Return the point at which to divide a part of a flight: one where v or x is stationary, else
    the middle.
    """
    width = then.tau - now.tau
    for of_v in (True, False):
        if of_v:
            in_question = open_ends.v_min or open_ends.v_max
        else:
            in_question = open_ends.x
        if not in_question:
            continue
        first, rise, _ = rates(now, of_v, start)
        last, rise_last, _ = rates(then, of_v, start)
        # A stationary point at an end is known, and no place to cut.
        at_end = (
            abs(first) <= CUT_AWAY * abs(rise) * width
            or abs(last) <= CUT_AWAY * abs(rise_last) * width
        )
        if first * last < 0.0 and not at_end:
            here = stationary(now, then, of_v, start, K)
            if now.tau < here.tau < then.tau:
                return here
    return state_at(0.5 * (now.tau + then.tau), start, K)


def rates(now, of_v, start):
    """Return the first three time derivatives of v (if `of_v`) or of x at a point of a flight."""
    if of_v:
        return (now.F, now.G1, now.G2)
    return (start.v + now.dv, now.F, now.G1)


@outlined
def stationary(now, then, of_v, start, K):
    """Return the point between `now` and `then` where v (if `of_v`) or x is stationary, by Halley's
    method.
    """
    low = now.tau
    high = then.tau
    width = then.tau - now.tau
    first, rise, _ = rates(now, of_v, start)
    last, _, _ = rates(then, of_v, start)
    tau = low + parabola_root(first, rise, last, width)
    here = now
    for _ in range(MOST_STATIONARY_STEPS):
        here = state_at(tau, start, K)
        value, slope, bend = rates(here, of_v, start)
        if (value < 0.0) == (first < 0.0):
            low = tau
        else:
            high = tau
        square = slope * slope - 0.5 * value * bend
        if square > 0.0:
            shift = -value * slope / square
        else:
            shift = 2.0 * width  # out of the bracket, which is halved then
        if abs(shift) * K.rate < NEAR:  # the extreme is off by the square of what is missing
            dv = (
                here.dv
                + (
                    here.F
                    + (0.5 * here.G1 + SIXTH * (here.G2 + 0.25 * here.G3 * shift) * shift) * shift
                )
                * shift
            )
            there = shifted(here, shift, start.v, K)
            G1 = here.G1 + here.G2 * shift
            G2 = here.G2 + here.G3 * shift
            s = there.s
            c = there.c
            E0 = there.E0
            E1 = there.E1
            E2 = there.E2
            return Flown(there.tau, there.dx, dv, there.F, G1, G2, here.G3, s, c, E0, E1, E2)
        tau = tau + shift
        if not low < tau < high:
            tau = 0.5 * (low + high)
    return here


def parabola_root(f0, slope, f1, width):
    """Return the root in (0, width) of a parabola with value f0 and `slope` at 0 and value f1 at
    `width`; f0 f1 < 0.
    """
    bend = (f1 - f0 - slope * width) / (width * width)
    square = slope * slope - 4.0 * bend * f0
    if square > 0.0:
        root = sqrt(square)
    else:
        root = 0.0
    # The slope where the parabola is 0 is `root` or -`root`, with the sign of f1.
    below = slope + (root if f1 > 0.0 else -root)
    if below != 0.0:
        tau = -2.0 * f0 / below
    else:
        tau = 0.5 * width
    if 0.0 < tau < width:
        return tau
    return 0.5 * width
