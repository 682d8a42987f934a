"""What a summary of a motion keeps: step by step, in memory that does not grow with the number of events.

A step of the event loop (`symosc.engine.next_event.advance`) is a flight or a stick without an event inside. The events
at their ends are always counted. Where it is asked for, also the share of the time on belts, the extremes, and the
sections that the motion passes. Sections are where a forcing period ends, Omega t = 2 pi n; the mappings between two of
them make a word. An event so near a section that its error could move it across belongs to the period that begins
there. Of a section is kept from where it is reached; `symosc.engine.settled` computes those that are looked at.

All functions are scalar and run on floats (CPython, numba).
"""

from __future__ import annotations

from functools import cache
from math import cos, inf, sin
from typing import Any, NamedTuple

import numpy as np

from symosc.engine.extremes import Extremes, flight_extremes, widened
from symosc.engine.flow import clock_time, constant_force, derivatives, state_at
from symosc.engine.next_event import TWO_PI, later
from symosc.engine.state import END, GRAZE, ON_BELT, REST, STICK, Flown, Launch, State
from symosc.kernels._generated import acceleration, motion
from symosc.kernels.entire import basis_at
from symosc.words import MAPS

# Columns of `Tally.floats`: time that is left out, stuck time, extremes, the last state, and the extremes of the ends
# of steps alone.
SKIPPED, STUCK, X_MIN, X_MAX, V_MIN, V_MAX, T_LAST, X_LAST, V_LAST, X_LOW, X_HIGH, V_LOW, V_HIGH = range(13)
# Columns of `Tally.ints`: events and sticks; the belt of the last event; sections so far; whether the word began at a
# section, whether the next section comes just behind the last event; lengths of the word now and of the last one.
EVENTS_SO_FAR, STICKS, PLANE, SECTIONS, WHOLE, EARLY, LENGTH, LAST_LENGTH, CODE = range(9)
# An event, or the end of a motion, is at a section if its phase is not farther from it, beside its error.
AT_SECTION, MOST_AT_SECTION = 1e-9, 1e-3
# Words of a period are compared by a number; of up to 17 mappings by all of them. Small enough for 64 bits.
WORD_MODULUS = 2**56 - 5
# A transient is over after so many of its decay times.
TRANSIENT = 45.0
MOST_REST_STEPS = 2**62

_MAP_CODES = {(row.start.boundary, row.mode, row.end.boundary): int(label[1:]) for label, row in MAPS.items()}
#: Number of the mapping by (belt at its start, mode, belt at its end); 0 for none.
MAP_OF = np.array([_MAP_CODES.get((at, mode, to), 0) for at in range(3) for mode in range(6) for to in range(3)])
# What is kept of a section: whether a flight reaches it, how long after it left and from where; the variances there.
FLIES, SINCE, FROM_THETA, FROM_X, FROM_V, FROM_F, S11_THERE, S22_THERE = range(8)
# With room for one section a way over two of them would count as one without end.
LEAST_RING = 2


class Kept(NamedTuple):
    """What a tally keeps beside counts and the last state."""

    stuck: bool  # the time on belts
    extent: bool  # the extremes of the ends of steps
    inside: bool  # and those inside flights
    ring: int  # sections; 0: neither these nor words
    longest: int  # mappings of a word


class Tally(NamedTuple):
    """What is kept of each motion; of sections and words the last ones, in a ring."""

    asked: Kept
    floats: np.ndarray  # (n, 13)
    ints: np.ndarray  # (n, 9)
    sections: np.ndarray  # (n, ring, 8)
    words: np.ndarray  # (n, ring), of the periods that end at these sections; -1 for none
    labels: np.ndarray  # (n, 2, longest word): mappings of the word now, and of the last whole one


@cache
def no_tally() -> Tally:
    """Return a tally of no motion: events are recorded."""
    return begun_tally(np.zeros((0, 16)), np.zeros(0), Kept(False, False, False, 0, 0))


def begun_tally(states: np.ndarray, skipped: np.ndarray, asked: Kept) -> Tally:
    """Return the tally of motions at their starts.

    Parameters
    ----------
    states : (n, STATE_WIDTH) rows of a batch.
    skipped : (n,) time that is left out.
    asked : Kept
    """
    count = len(states)
    floats, ints = np.zeros((count, 13)), np.zeros((count, 9), np.int64)
    floats[:, SKIPPED] = skipped
    floats[:, [X_MIN, V_MIN, X_LOW, V_LOW]], floats[:, [X_MAX, V_MAX, X_HIGH, V_HIGH]] = inf, -inf
    floats[:, [T_LAST, X_LAST, V_LAST]] = states[:, [11, 4, 5]]
    ints[:, PLANE], ints[:, WHOLE] = states[:, 1], states[:, 3] == 0.0
    # Places of sections that were not reached are never read.
    sections, words = np.empty((count, asked.ring, 8)), np.full((count, asked.ring), -1, np.int64)
    return Tally(asked, floats, ints, sections, words, np.zeros((count, 2, asked.longest), np.uint8))


def some_of(tally: Tally, rows: Any) -> Tally:
    """Return the tallies of some motions, as a copy."""
    return Tally(tally.asked, *(column[rows].copy() for column in tally[1:])) if len(tally.floats) else tally


def put_back(tally: Tally, rows: Any, own: Tally) -> None:
    """Write the tallies of some motions."""
    if len(tally.floats):
        for column, part in zip(tally[1:], own[1:], strict=True):
            column[rows] = part


def tally_step(i, before, found, t0, tally, K):
    """Count a step from the state `before` to what was `found` (NextEvent)."""
    after, asked = found.state, tally.asked
    if found.code <= GRAZE and (after.t - t0) + after.t_low >= tally.floats[i, SKIPPED]:
        tally.ints[i, EVENTS_SO_FAR] += 1
        tally.ints[i, STICKS] += found.code == STICK
    if asked.extent or (asked.stuck and before.mode > ON_BELT):
        tau = (after.t - before.t) + (after.t_low - before.t_low)
        tally_stretch(i, before, after, tau, t0, tally, K)
    if asked.ring > 0:
        tally_periods(i, before, found, tally, K)


def tally_periods(i, before, found, tally, K):
    """Count the sections on the way to what was found, and the mapping that ends there."""
    after, ints = found.state, tally.ints
    if after.n > before.n:
        tally_sections(i, before, after.n, after.S, tally, K)
    if found.code <= GRAZE:
        to_section = TWO_PI - after.theta
        reach = K.Om * found.t_error
        near = to_section < AT_SECTION + (8.0 * reach if 8.0 * reach < MOST_AT_SECTION else MOST_AT_SECTION)
        if near and ints[i, EARLY] == 0:
            close_word(i, tally)
            ints[i, EARLY] = 1
        plane = ints[i, PLANE]
        code = int(MAP_OF[(plane * 6 + before.mode) * 3 + found.boundary])
        if code > 0:
            length = ints[i, LENGTH]
            if length < tally.labels.shape[2]:
                tally.labels[i, 0, length] = code
            ints[i, LENGTH] = length + 1
            ints[i, CODE] = (ints[i, CODE] * 9 + code) % WORD_MODULUS
        ints[i, PLANE] = found.boundary


def keep_last(i, t, x, v, tally):
    """Keep the last state."""
    tally.floats[i, T_LAST], tally.floats[i, X_LAST], tally.floats[i, V_LAST] = t, x, v


def launch_of(state):
    """Return where a flight from a state is computed from."""
    return Launch(state.v, state.Fb, state.s, state.c)


def end_of(before, after, tau, start, K):
    """Return the end of a flight (Flown), from the state behind it."""
    if K.stiff:
        return state_at(tau, start, K)
    s, c = after.s, after.c
    F = acceleration(after.x, after.v, c, constant_force(before.mode, K), K.cm, K.w0sq, K.f0)
    G1, G2, G3 = derivatives(after.v, F, s, c, K)
    return Flown(tau, after.x - before.x, after.v - before.v, F, G1, G2, G3, s, c, 1.0, 0.0, 0.0)


def tally_stretch(i, before, after, tau, t0, tally, K):
    """Count the time and the extremes of the way from one state to another, as far as it is not left out."""
    floats, asked = tally.floats, tally.asked
    begin = floats[i, SKIPPED] - ((before.t - t0) + before.t_low)
    if tau < begin:
        return
    begin = begin if begin > 0.0 else 0.0
    x, v = before.x, before.v
    if before.mode > ON_BELT:
        floats[i, STUCK] += tau - begin
        x = x + v * begin
    elif begin > 0.0 and asked.extent:
        now = state_at(begin, launch_of(before), K)
        x, v = x + now.dx, v + now.dv
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
        start = launch_of(before)
        seen = flight_extremes(begin, end_of(before, after, tau, start, K), start, before.x, seen, K)
    floats[i, X_MIN], floats[i, X_MAX], floats[i, V_MIN], floats[i, V_MAX] = seen


def tally_sections(i, before, last, S, tally, K):
    """Keep the sections between a state and the period number `last`, of which the last ones have room."""
    ring = tally.words.shape[1]
    first = before.n + 1
    if last - first >= ring:  # a long way without an event: all but the last words are empty
        close_word(i, tally)
        tally.ints[i, SECTIONS] += (last - ring) - first
        first, tally.ints[i, EARLY] = last - ring, 1
    S_x, S_v = max(before.S.S11, S.S11), max(before.S.S22, S.S22)
    for period in range(first, last + 1):
        turns = period - before.n
        tau = (turns * TWO_PI - before.theta) / K.Om
        keep_section(i, before, tau, S_x, S_v, tally)


def keep_section(i, before, tau, S_x, S_v, tally):
    """Keep a section `tau` after a state; the word of its period ends here unless an event just before did that."""
    ints = tally.ints
    if ints[i, EARLY] == 0:
        close_word(i, tally)
    kept = tally.sections[i, ints[i, SECTIONS] % tally.words.shape[1]]
    kept[FLIES], kept[SINCE] = 1.0 if before.mode <= ON_BELT and tau > 0.0 else 0.0, tau
    kept[FROM_THETA], kept[FROM_X], kept[FROM_V], kept[FROM_F] = before.theta, before.x, before.v, before.Fb
    kept[S11_THERE], kept[S22_THERE] = S_x, S_v
    ints[i, SECTIONS] += 1
    ints[i, EARLY] = 0


def close_word(i, tally):
    """Keep the word of the period that ends, if that is a whole one, and begin the next."""
    ints, labels, ring = tally.ints, tally.labels, tally.words.shape[1]
    length = ints[i, LENGTH]
    if ints[i, WHOLE] == 1:
        tally.words[i, ints[i, SECTIONS] % ring] = ints[i, CODE] * 64 % WORD_MODULUS + length % 64
        for n in range(min(length, labels.shape[2])):
            labels[i, 1, n] = labels[i, 0, n]
        ints[i, LAST_LENGTH] = length
    else:
        tally.words[i, ints[i, SECTIONS] % ring] = -1
    ints[i, WHOLE], ints[i, LENGTH], ints[i, CODE] = 1, 0, 0


def leave_tally(i, last, code, left, t0, tally, K):
    """Keep the last state of a motion that ended, or goes on later; `left` is the time to its end."""
    if code == REST:
        rest_tally(i, last, left, t0, tally, K)
    else:
        keep_last(i, clock_time(last.t, last.t_low, t0, K), last.x, last.v, tally)
        if code == END:
            end_tally(i, last, tally)


def end_tally(i, state, tally):
    """Finish a motion that came to its end: a section that is just ahead counts."""
    if tally.asked.ring > 0 and TWO_PI - state.theta < AT_SECTION:
        keep_section(i, state, 0.0, state.S.S11, state.S.S22, tally)


def rest_tally(i, state, left, t0, tally, K):
    """Finish a motion without any more events, for the time `left`."""
    n, theta, _ = later(state.n, state.theta, state.theta_low, rest_of(left, K), K)
    whole = (left - rest_of(left, K)) / K.period
    n = n + int(whole + 0.5)
    if tally.asked.extent or tally.asked.stuck:
        rest_stretches(i, state, left, t0, tally, K)
    if tally.asked.ring > 0:
        tally_sections(i, state, n, state.S, tally, K)
    x, v = state.x + state.v * left, state.v
    if state.mode <= ON_BELT:
        turn = theta - state.theta
        x, v = flown(state.x, launch_of(state), left, sin(turn), cos(turn), K)
    clock = state.t + left, state.t_low, sin(theta), cos(theta), 0.0
    end = State(state.mode, 0, n, theta, x, v, state.Fb, state.Fa, state.S, *clock)
    end_tally(i, end, tally)
    keep_last(i, state.t + left, x, v, tally)


def rest_stretches(i, state, left, t0, tally, K):
    """Count the time and the extremes of a motion without any more events.

    Its extremes are looked for piece by piece, until the transient is over; then one period shows all that is to come.
    """
    decay = K.h if K.under else -K.l1
    fades = decay > 0.0 and K.w0 > 0.0 and state.mode <= ON_BELT
    now, passed = state, 0.0
    for _ in range(MOST_REST_STEPS):
        step = left - passed if state.mode > ON_BELT or left - passed < K.chunk else K.chunk
        x, v, F = flown_on(now, step, K)
        _, phase, theta_low = later(0, now.theta, now.theta_low, step, K)
        clock = now.t + step, now.t_low, sin(phase), cos(phase), theta_low
        then = State(now.mode, 0, now.n, phase, x, v, F, F, now.S, *clock)
        tally_stretch(i, now, then, step, t0, tally, K)
        passed = passed + step
        if passed >= left or (fades and decay * (passed - K.chunk) > TRANSIENT and passed > 2.0 * K.period):
            break
        now = then


def flown(x, start, tau, s_Om, c_Om, K):
    """Return position and velocity of a flight from x, given sine and cosine of what the phase gains."""
    E0, E1, E2, R2, I2, _, _ = basis_at(tau, s_Om, c_Om, K)
    dx, dv, _ = motion(start.v, start.F, start.s, start.c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    return x + dx, start.v + dv


def flown_on(state, step, K):
    """Return position, velocity and acceleration a step later."""
    if state.mode > ON_BELT:
        return state.x + state.v * step, state.v, state.Fb
    now = state_at(step, launch_of(state), K)
    return state.x + now.dx, state.v + now.dv, now.F


def rest_of(tau, K):
    """Return what is left of a time after whole forcing periods, of which there may be many."""
    if tau < K.period:
        return tau
    rest = tau % K.period
    turns = (tau - rest) / K.period
    rest = rest - turns * K.period_low
    return rest if rest >= 0.0 else 0.0
