"""Motions in double-double numbers as far as doubles are in doubt: a loop for numba.

It is written for pairs (`symosc.kernels.pair_type`), to which `symosc.engine.pairs` binds it together with the engine.
What comes out is rounded to doubles by the rules for numbers with many digits (`symosc.engine.rounding`).
"""

from __future__ import annotations

from symosc.engine.compiled_loop import handed_out, keep_state, state_of, write_event, write_kind
from symosc.engine.next_event import advance
from symosc.engine.rounding import is_faint, rounded_covariance, rounding_error
from symosc.engine.state import END, FAILED, GRAZE, IN_DOUBT, REST, RUNNING, Covariance, NextEvent, State
from symosc.engine.tally import leave_tally, tally_step
from symosc.kernels.pair_type import from_complex


def follow_pairs(chosen, wanted, pairs, batch, out, K, tally, table):
    """Follow trajectories to a number of events, or to their end; events and states come out in doubles.

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
    tally, table : as `symosc.engine.compiled_loop.follow_all` takes them.

    Returns
    -------
    rows
        The number of rows that were filled.
    """
    K = from_complex(K)
    states, sets, counts, codes = batch
    rows, tallied = 0, tally.floats.shape[0] > 0
    for i in chosen:
        state, plain = state_of(pairs, i), table[sets[i]]
        t_end, t_end_low, t0 = from_complex(pairs[i, 13]), from_complex(pairs[i, 14]), from_complex(pairs[i, 15])
        code, rounded = RUNNING, in_doubles(state)
        while code == RUNNING and counts[i] < wanted[i]:
            source, before = state.mode, rounded
            step, boundary, decided, t_error, state = advance(state, t_end, t_end_low, K)
            rounded = in_doubles(state)
            if step == FAILED or not decided:
                code = IN_DOUBT
            elif step <= GRAZE:
                x, v = state.x, state.v
                t, t_error, x_error = handed_out(state.t, state.t_low, t0, x, v, t_error, state.S.S11, K)
                if not (is_faint(t_error.hi, t.hi) and is_faint(x_error.hi, x.hi)):
                    code = IN_DOUBT
                if not tallied:
                    errors = rounding_error(t_error.hi, t.hi), rounding_error(x_error.hi, x.hi)
                    write_event(out, rows, t.hi, rounded, errors[0], errors[1])
                    write_kind(out, rows, i, step, boundary, source)
                rows += 1
                counts[i] += 1
            elif step in (END, REST):
                code = step
            if tallied and code != IN_DOUBT and code != REST:
                found = NextEvent(step, boundary, True, t_error.hi, rounded)
                tally_step(i, before, found, t0.hi, tally, plain)
        if tallied:
            left = (t_end - state.t) + (t_end_low - state.t_low)
            leave_tally(i, rounded, code, left.hi, t0.hi, tally, plain)
        codes[i] = code
        keep_state(pairs, i, state)
        keep_state(states, i, rounded)
    return rows


def in_doubles(state):
    """Return a state of pairs in doubles, as `symosc.engine.start.rounded`."""
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
        ((state.t - t) + state.t_low).hi,
        state.s.hi,
        state.c.hi,
    )
