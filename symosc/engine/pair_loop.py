"""Motions in double-double numbers as far as doubles are in doubt: a loop for numba.

It is written for pairs (`symosc.kernels.pair_type`), to which `symosc.engine.pairs` binds it together with the engine.
What comes out is rounded to doubles by the rules for numbers with many digits (`symosc.engine.rounding`).
"""

from __future__ import annotations

from symosc.engine.compiled_loop import handed_out, keep_state, state_of
from symosc.engine.next_event import advance
from symosc.engine.rounding import is_faint, rounded_covariance, rounding_error
from symosc.engine.state import END, FAILED, GRAZE, IN_DOUBT, REST, RUNNING, Covariance, State
from symosc.kernels.pair_type import from_complex


def follow_pairs(chosen, wanted, pairs, batch, out, K):
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

    Returns
    -------
    rows
        The number of rows that were filled.
    """
    K = from_complex(K)
    states, _, counts, codes = batch
    floats, ints = out
    rows = 0
    for i in chosen:
        state = state_of(pairs, i)
        t_end, t_end_low, t0 = from_complex(pairs[i, 13]), from_complex(pairs[i, 14]), from_complex(pairs[i, 15])
        code = RUNNING
        while code == RUNNING and counts[i] < wanted[i]:
            source = state.mode
            step, boundary, decided, t_error, state = advance(state, t_end, t_end_low, K)
            if step == FAILED or not decided:
                code = IN_DOUBT
            elif step <= GRAZE:
                x, v = state.x, state.v
                t, t_error, x_error = handed_out(state.t, state.t_low, t0, x, v, t_error, state.S.S11, K)
                if not (is_faint(t_error.hi, t.hi) and is_faint(x_error.hi, x.hi)):
                    code = IN_DOUBT
                floats[rows, 0], floats[rows, 1], floats[rows, 2] = t.hi, x.hi, v.hi
                floats[rows, 3] = state.theta.hi
                floats[rows, 4] = rounding_error(t_error.hi, t.hi)
                floats[rows, 5] = rounding_error(x_error.hi, x.hi)
                ints[rows, 0], ints[rows, 1], ints[rows, 2] = i, step, boundary
                ints[rows, 3], ints[rows, 4] = source, state.mode
                rows += 1
                counts[i] += 1
            elif step in (END, REST):
                code = step
        codes[i] = code
        keep_state(pairs, i, state)
        keep_state(states, i, in_doubles(state))
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
    )
