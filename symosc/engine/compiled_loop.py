"""Many trajectories in one loop, events into columns: what `simulate_many` compiles."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from symosc.aliases import Number
from symosc.engine.events import CODE_COLUMNS, FLOAT_COLUMNS, event_codes, event_numbers
from symosc.engine.flow import clock_time
from symosc.engine.next_event import advance
from symosc.engine.pages import room_of
from symosc.engine.state import (
    DOUBTFUL,
    END,
    FAILED,
    FULL,
    GRAZE,
    IN_DOUBT,
    INEXACT,
    MOVED,
    REST,
    RUNNING,
    Covariance,
    State,
)
from symosc.engine.tally import leave_tally, tally_step
from symosc.kernels.entire import EPS

# A row of states: mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, t_end, t_end_low, t0, s, c, theta_low.
STATE_WIDTH = 19
# Steps after which doubles that are not in doubt are no longer looked ahead for.
LOOK_AHEAD = 16


class Batch(NamedTuple):
    """Trajectories: where they are, their parameter sets, their events so far, and what each ended with."""

    states: np.ndarray  # (n, STATE_WIDTH), rows as `row_of` makes them
    sets: np.ndarray  # (n,)
    counts: np.ndarray  # (n,)
    codes: np.ndarray  # (n,)


class EventRows(NamedTuple):
    """A buffer for events: FLOAT_COLUMNS, and the number of the trajectory with CODE_COLUMNS; each in one piece."""

    floats: np.ndarray  # (columns, rows)
    ints: np.ndarray


def batch_of(states: np.ndarray, sets: np.ndarray | None = None) -> Batch:
    """Return trajectories that are about to begin; all have the first parameter set unless `sets` says another."""
    count = len(states)
    sets = np.zeros(count, np.int64) if sets is None else sets
    return Batch(states, sets, np.zeros(count, np.int64), np.zeros(count, np.int64))


def room_for(events: int) -> EventRows:
    """Return room for so many events."""
    return EventRows(room_of((len(FLOAT_COLUMNS), events)), room_of((1 + len(CODE_COLUMNS), events), np.int32))


def rows_between(rows: EventRows, begin: int, end: int) -> EventRows:
    """Return some of the rows; they are not copied."""
    return EventRows(rows.floats[:, begin:end], rows.ints[:, begin:end])


def row_of(state: State, t_end: Number, t_end_low: Number) -> list[Number]:
    """Return a state, the two parts of the end, and the time as that of the start, as a row of a batch."""
    return [*state[:8], *state.S, state.t, state.t_low, t_end, t_end_low, state.t, *state[11:]]


def state_of(states, i):
    """Return the state in row i."""
    # float() and int(): under CPython numpy's own scalars would be slower.
    return State(
        int(states[i, 0]),
        int(states[i, 1]),
        int(states[i, 2]),
        float(states[i, 3]),
        float(states[i, 4]),
        float(states[i, 5]),
        float(states[i, 6]),
        float(states[i, 7]),
        Covariance(float(states[i, 8]), float(states[i, 9]), float(states[i, 10])),
        float(states[i, 11]),
        float(states[i, 12]),
        float(states[i, 16]),
        float(states[i, 17]),
        float(states[i, 18]),
    )


def keep_state(states, i, state):
    """Write a state into row i."""
    states[i, 0], states[i, 1], states[i, 2] = state.mode, state.at, state.n
    states[i, 3], states[i, 4], states[i, 5] = state.theta, state.x, state.v
    states[i, 6], states[i, 7] = state.Fb, state.Fa
    states[i, 8], states[i, 9], states[i, 10] = state.S.S11, state.S.S12, state.S.S22
    states[i, 11], states[i, 12] = state.t, state.t_low
    states[i, 16], states[i, 17], states[i, 18] = state.s, state.c, state.theta_low


def handed_out(t, t_low, t0, x, v, t_error, S11, K):
    """Return an event's time, and standard errors of t and x that cover the rounding of these two numbers.

    What a motion is locked to is the phase: the rounding of Omega is taken back in the time that it stands for.
    """
    out = clock_time(t, t_low, t0, K)
    t_error, x_error = t_error + EPS * (abs(out) + 0.25 * (t - t0)), abs(v) * t_error + sqrt(S11) + EPS * abs(x)
    return out, t_error, x_error


def follow_all(begin, batch, most, accuracy, out, tally, table):
    """Follow trajectories from number `begin` on, until all are done or there were as many events as the output holds.

    Parameters
    ----------
    begin : first trajectory to follow; it may have been begun before.
    batch : Batch, updated.
    most : events after which a trajectory is FULL.
    accuracy : a trajectory ends as INEXACT at the first event known to less, relative to max(1, |value|, |t0| for t).
    out : EventRows
    tally : Tally, updated; events are recorded where it is for no motion, else only counted.
    table : constants of the parameter sets, as `symosc.engine.constant_table` makes them.

    Returns
    -------
    (next, rows)
        The trajectory to go on with, and the number of events.
    """
    rows = 0
    states, sets, counts, codes = batch
    tallied = tally.floats.shape[0] > 0
    for i in range(begin, states.shape[0]):
        before, K = state_of(states, i), table[sets[i]]
        t_end, t_end_low, t0 = end_by_phase(states[i], K)
        code = RUNNING
        while code == RUNNING:
            if counts[i] >= most:
                code = FULL
                break
            if rows >= out.floats.shape[1]:
                break
            found = advance(before, t_end, t_end_low, K)
            step, _, decided, t_error, state = found
            if not decided or step == FAILED:
                code = IN_DOUBT
            elif step <= GRAZE:
                clock = handed_out(state.t, state.t_low, t0, state.x, state.v, t_error, state.S.S11, K)
                if is_inexact(clock[0], clock[1], state.x, clock[2], t0, accuracy):
                    code = INEXACT
                if not tallied:
                    write_event(out, rows, i, before, found, clock, K)
                rows += 1
                counts[i] += 1
            elif step != MOVED:
                code = step
            if tallied and code not in DOUBTFUL and code != REST:
                tally_step(i, before, found, t0, tally, K)
            before = state
        if tallied:
            leave_tally(i, before, code, (t_end - before.t) + (t_end_low - before.t_low), t0, tally, K)
        keep_state(states, i, before)
        codes[i] = code
        if code == RUNNING:
            return i, rows
    return states.shape[0], rows


def is_inexact(t, t_error, x, x_error, t0, accuracy):
    """Return whether an event is known to less than `accuracy`."""
    return t_error > accuracy * max(1.0, abs(t), abs(t0)) or x_error > accuracy * max(1.0, abs(x))


def end_by_phase(row, K):
    """Return t_end in two parts, as doubles count it (`symosc.engine.flow.clock_time`), and t0 of a row of a batch."""
    t_end, t0 = float(row[13]), float(row[15])
    return t_end, float(row[14]) - (t_end - t0) * K.Om_gain, t0


def searched(state, row, K):
    """Return the next event (NextEvent) of a state, by the times in a row of a batch."""
    t_end, t_end_low, _ = end_by_phase(row, K)
    return advance(state, t_end, t_end_low, K)


def search_row(states, table):
    """Advance the state in the first row to its next event; return code, belt, decided and t_error (NextEvent)."""
    code, boundary, decided, t_error, state = searched(state_of(states, 0), states[0], table[0])
    keep_state(states, 0, state)
    return code, boundary, decided, t_error


def next_doubt(state, count, row, most, accuracy, K):
    """Return the number of the next event that `follow_all` leaves in doubt; 0 if there is none soon.

    Parameters
    ----------
    state : State, before which there were `count` events.
    row : row of a batch, for its times.
    most : number of the last event that is of interest.
    accuracy, K : as `follow_all` takes them.
    """
    t0 = float(row[15])
    for _ in range(LOOK_AHEAD):
        step, _, decided, t_error, state = searched(state, row, K)
        if count >= most or step in (END, REST):
            break
        if step == FAILED or not decided:
            return count + 1
        if step <= GRAZE:
            count += 1
            x, v = state.x, state.v
            t, t_error, x_error = handed_out(state.t, state.t_low, t0, x, v, t_error, state.S.S11, K)
            if is_inexact(t, t_error, x, x_error, t0, accuracy):
                return count
    return 0


def write_event(out, row, i, before, found, clock, K):
    """Write an event of trajectory i into a row; arguments as `symosc.engine.events.event_numbers` takes them."""
    numbers, codes = event_numbers(before, found, clock, K), event_codes(before, found)
    for n in range(len(numbers)):
        out.floats[n, row] = numbers[n]
    out.ints[0, row] = i
    for n in range(len(codes)):
        out.ints[n + 1, row] = codes[n]
