"""Motions in double-double numbers as far as doubles are in doubt: the loop, for numba and for CPython.

It is written for pairs (`symosc.kernels.pair_type`), to which `symosc.engine.pairs` binds it together with the engine.
What comes out is rounded to doubles by the rules for numbers with many digits (`symosc.engine.rounding`).
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

import numpy as np

from symosc.engine.compiled_loop import end_by_phase as end_in_doubles
from symosc.engine.compiled_loop import handed_out, keep_state, state_of
from symosc.engine.compiled_loop import next_doubt as next_doubt_in_doubles
from symosc.engine.compiled_loop import searched as searched_in_doubles
from symosc.engine.compiled_loop import write_event as write_event_in_doubles
from symosc.engine.flow import constant_force
from symosc.engine.near_event import advance_near
from symosc.engine.rounding import is_faint, rounded_covariance, rounding_error
from symosc.engine.state import END, FAILED, GRAZE, IN_DOUBT, ON_BELT, REST, RUNNING, Covariance, NextEvent, State
from symosc.engine.tally import leave_tally, tally_step
from symosc.kernels._generated import acceleration
from symosc.kernels.entire import EPS
from symosc.kernels.pair_type import from_complex


def first_pairs(pairs, K):
    """Complete rows of starts, which have mode, at, theta, x, v and the times; no force on a belt may be 0."""
    K = from_complex(K)
    for i in range(pairs.shape[0]):
        mode, at, theta, x, v = (
            int(pairs[i, 0]),
            int(pairs[i, 1]),
            float(pairs[i, 3]),
            float(pairs[i, 4]),
            float(pairs[i, 5]),
        )
        if at > 0:  # to the last bit
            v = K.belt1.v if at == 1 else K.belt2.v
        s, c = sin(theta), cos(theta)
        below, above = (at, at + 1) if mode > ON_BELT else (mode, mode)
        pairs[i, 5], pairs[i, 16], pairs[i, 17] = v, s, c
        pairs[i, 6] = acceleration(x, v, c, constant_force(below, K), K.cm, K.w0sq, K.f0)
        pairs[i, 7] = acceleration(x, v, c, constant_force(above, K), K.cm, K.w0sq, K.f0)
        pairs[i, 8] = (EPS * x) * (EPS * x)
        if at == 0:
            pairs[i, 10] = (EPS * v) * (EPS * v)


class Going(NamedTuple):
    """How far motions are followed, and by which constants in doubles."""

    most: int  # events after which a trajectory is FULL
    accuracy: float
    more: int  # events that there is room for, for each motion, beside those that are wanted
    table: np.ndarray  # as `symosc.engine.compiled_loop.follow_all` takes it
    careful: np.ndarray  # the same, for decisions that exceed the errors of a state whatever accuracy is asked for


def follow_pairs(chosen, wanted, pairs, batch, out, K, tally, going):
    """Follow trajectories to a number of events, or to their end; events and states come out in doubles.

    The search for each event is made in doubles as far as these are sure (`symosc.engine.near_event`). A motion that
    doubles would soon leave open again is followed farther, as long as there is room.

    Parameters
    ----------
    chosen : (m,) numbers of the trajectories to follow, in order.
    wanted : (n,) events to come to, in all.
    pairs : (n, STATE_WIDTH) complex array, updated: states in pairs, as `symosc.engine.compiled_loop` has rows.
    batch : Batch, updated: the states in doubles, with their rounding as their error; the events so far; RUNNING, END,
        REST, or IN_DOUBT for a contact that pairs leave open, and for an event that they do not know far better than
        doubles.
    out : EventRows, room for all events to come.
    K : Constants of complex numbers
    tally : as `symosc.engine.compiled_loop.follow_all` takes it.
    going : Going

    Returns
    -------
    rows
        The number of rows that were filled.
    """
    K = from_complex(K)
    states, sets, counts, codes = batch
    rows, tallied = 0, tally.floats.shape[0] > 0
    for i in chosen:
        state, plain, careful = state_of(pairs, i), going.table[sets[i]], going.careful[sets[i]]
        t_end, t_end_low, t0 = from_complex(pairs[i, 13]), from_complex(pairs[i, 14]), from_complex(pairs[i, 15])
        code, goal, last = RUNNING, wanted[i], min(going.most, wanted[i] + going.more)
        rounded = in_doubles(state, t0, plain)
        while code == RUNNING:
            if counts[i] >= goal:
                goal = next_doubt_in_doubles(rounded, counts[i], states[i], last, going.accuracy, plain)
                if goal == 0:
                    break
            before, rough = rounded, searched_in_doubles(rounded, states[i], careful)
            found = advance_near(state, rounded, rough, t_end, t_end_low, K)
            state, step = found.state, found.code
            rounded = in_doubles(state, t0, plain)
            if step == FAILED or not found.decided:
                code = IN_DOUBT
            elif step <= GRAZE:
                clock = handed_out(state.t, state.t_low, t0, state.x, state.v, found.t_error, state.S.S11, K)
                if not (is_faint(clock[1].hi, clock[0].hi) and is_faint(clock[2].hi, state.x.hi)):
                    code = IN_DOUBT
                if rows < out.floats.shape[1]:  # there is no room where tallies are kept
                    errors = rounding_error(clock[1].hi, clock[0].hi), rounding_error(clock[2].hi, state.x.hi)
                    plainly = NextEvent(step, found.boundary, True, found.t_error.hi, rounded)
                    write_event_in_doubles(out, rows, i, before, plainly, (clock[0].hi, errors[0], errors[1]), plain)
                rows += 1
                counts[i] += 1
            elif step in (END, REST):
                code = step
            if tallied and code != IN_DOUBT and code != REST:
                plainly = NextEvent(step, found.boundary, True, found.t_error.hi, rounded)
                tally_step(i, before, plainly, t0.hi, tally, plain)
        if tallied:
            end, end_low, _ = end_in_doubles(states[i], plain)
            left = (end - rounded.t) + (end_low - rounded.t_low)
            leave_tally(i, rounded, code, left, t0.hi, tally, plain)
        codes[i] = code
        keep_state(pairs, i, state)
        keep_state(states, i, rounded)
    return rows


def in_doubles(state, t0, K):
    """Return a state of pairs in doubles, whose constants are K, as `symosc.engine.start.rounded`."""
    x, v, t, S = state.x.hi, state.v.hi, state.t.hi, state.S
    S11, S12, S22 = rounded_covariance(state.at, x, v, S.S11.hi, S.S12.hi, S.S22.hi)
    return State(
        state.mode,
        state.at,
        state.n,
        state.theta.hi,
        x,
        v,
        state.Fb.hi,
        state.Fa.hi,
        Covariance(S11, S12, S22),
        t,
        ((state.t - t) + state.t_low).hi - (t - t0.hi) * K.Om_gain,
        state.s.hi,
        state.c.hi,
        ((state.theta - state.theta.hi) + state.theta_low).hi,
    )
