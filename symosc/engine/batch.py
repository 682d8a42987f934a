"""Many trajectories in one loop, in doubles and in double-double numbers; events go into columns.

This file is executed with other globals: see symosc/kernels/rebind.py.

These are the loops that `simulate_many` compiles. `follow_pairs` and `first_pairs` are bound to
pairs; what they hand out are doubles, whose only error is their rounding unless that of the pairs
is not negligible beside it.

Arguments that many functions share: `states` has a row for each motion (STATE_ROW), `table` has the
constants of all parameter sets and `K` those of one. A motion is followed to `most` events; it ends
as INEXACT at the first that is known to less than `accuracy`.
Events go into `out` (EventRows), parts between steps into `pieces`, and counts and extremes into
`tally` instead of `out` if summaries are asked for (`symosc.engine.summary`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Number
from symosc.engine.events import CODE_COLUMNS, FLOAT_COLUMNS, event_codes, event_numbers
from symosc.engine.flow import belt_at, belt_forces, clock_time, constant_force, held_forces
from symosc.engine.next_event import (
    advance,
    advance_near,
    band_beyond,
    entered,
    free_time,
    time_with_errors,
)
from symosc.engine.state import (
    END,
    FAILED,
    FULL,
    GRAZE,
    INEXACT,
    MOVED,
    NEEDS_DIGITS,
    ON_BELT,
    REST,
    RUNNING,
    UNDECIDED,
    Covariance,
    Followed,
    NextEvent,
    State,
)
from symosc.engine.summary import finish_tally, tally_step
from symosc.kernels._generated import acceleration
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import EPS
from symosc.kernels.rebind import outlined

# Steps that doubles look ahead for an undecided event, at most.
LOOK_AHEAD = 16
# An error below this part of the rounding to doubles is negligible.
NEGLIGIBLE = 2.0**-20
PAGE = 1 << 21  # bytes of a large page


class Batch(NamedTuple):
    """Many trajectories, a row each: current state, index of the parameter set, count of events,
    and end code.
    """

    states: np.ndarray  # (n,) of STATE_ROW
    sets: np.ndarray  # (n,) which follow a motion through the rows of a law, see `follow_one`
    counts: np.ndarray  # (n,)
    codes: np.ndarray  # (n,)


class EventRows(NamedTuple):
    """A buffer with a column per event: `floats` has the numbers (t, x ...), `ints` the trajectory
    and codes.
    """

    floats: np.ndarray  # (columns, rows)
    ints: np.ndarray


#: Columns of the pieces of a motion: the state where it begins, the time since the double next to
#: t0, and the number of the row of constants.
PIECE_COLUMNS = ("n", "theta", "mode", "x", "v", "a", "elapsed", "row")
NO_PIECES = np.empty((len(PIECE_COLUMNS), 0))


class PairLimits(NamedTuple):
    """The limits of a run in double-double numbers: events, accuracy, buffer space; and tables of
    constants.
    """

    most: int  # events after which a trajectory is FULL
    accuracy: float
    more: int  # for how many events per motion the buffer has room beyond those that are wanted
    noise: float  # errors of an event that pairs may have, as a part of the rounding to doubles
    table: np.ndarray  # as `follow_all` takes it
    # the same, for decisions that exceed the errors of a state whatever accuracy is asked for
    careful: np.ndarray


def large_array(shape: tuple[int, ...], dtype: Any = np.float64) -> np.ndarray:
    """Return an uninitialised array, as ``np.empty`` does.

    A large one begins at a large memory page.
    """
    # The first access to a memory page costs a microsecond or more; with 4 KiB pages that can be a
    # quarter of an event's time. numpy asks the system for pages of 2 MiB, but gets them only
    # between multiples of 2 MiB.
    size = math.prod(shape) * np.dtype(dtype).itemsize
    if size < PAGE:
        return np.empty(shape, dtype)
    whole = np.empty(size + 2 * PAGE, np.uint8)
    address, _ = whole.__array_interface__["data"]
    skipped = -address % PAGE
    return whole[skipped : skipped + size].view(dtype).reshape(shape)


def joined_arrays(pieces: list[np.ndarray]) -> np.ndarray:
    """Concatenate arrays of one type along their first axis, in contiguous memory."""
    if len(pieces) == 1:
        return np.ascontiguousarray(pieces[0])
    return np.concatenate(
        pieces, out=large_array((sum(map(len, pieces)), *pieces[0].shape[1:]), pieces[0].dtype)
    )


def contiguous_copy(columns: np.ndarray) -> np.ndarray:
    """Return a copy of the array `columns` in contiguous memory."""
    out = large_array(columns.shape, columns.dtype)
    out[...] = columns
    return out


def batch_of(states: np.ndarray, sets: np.ndarray | None = None) -> Batch:
    """Return a batch of trajectories from rows of start states.

    `sets` are indices of parameter sets (None: all 0).
    """
    count = len(states)
    if sets is None:
        sets = np.zeros(count, np.int64)
    return Batch(states, sets, np.zeros(count, np.int64), np.zeros(count, np.int64))


def event_buffer(events: int) -> EventRows:
    """Return an empty buffer with room for so many `events`."""
    return EventRows(
        large_array((len(FLOAT_COLUMNS), events)),
        large_array((1 + len(CODE_COLUMNS), events), np.int32),
    )


def rows_between(rows: EventRows, begin: int, end: int) -> EventRows:
    """Return the events from number `begin` to before `end` of an event buffer, without a copy."""
    return EventRows(rows.floats[:, begin:end], rows.ints[:, begin:end])


def joined(parts: Iterable[EventRows]) -> EventRows:
    """Concatenate the events of several buffers in contiguous memory."""
    rows = list(parts) or [event_buffer(0)]
    if len(rows) == 1:
        return rows[0]
    return EventRows(*(np.concatenate(columns, axis=1) for columns in zip(*rows, strict=True)))


def piece_buffer(pieces: int) -> np.ndarray:
    """Return an empty buffer with room for so many `pieces` of a motion, a column each (see
    PIECE_COLUMNS).
    """
    return np.empty((len(PIECE_COLUMNS), pieces))


def row_of(state: State, t_end: Number, t_end_low: Number) -> tuple[Number, ...]:
    """Return the batch row of a motion that starts in `state`: this state, t_end in two parts, and
    t0.
    """
    return tuple(numbers_in(Followed(state, t_end, t_end_low, state.t)))


def numbers_in(values: tuple[Any, ...]) -> Iterator[Number]:
    """Yield the numbers in a tuple and in the tuples in it, in order."""
    for value in values:
        if isinstance(value, tuple):
            yield from numbers_in(value)
        else:
            yield value


def borrowed(arrays):
    """Return a tuple of arrays unchanged.

    Compiled code replaces this by views, to save numba's reference counts.
    """
    return arrays


def state_of(row):
    """Return the State in a row of a table of motions."""
    # float() and int(): under CPython numpy's own scalars would be slower.
    return State(
        mode=int(row.mode),
        at=int(row.at),
        n=int(row.n),
        theta=float(row.theta),
        x=float(row.x),
        v=float(row.v),
        Fb=float(row.Fb),
        Fa=float(row.Fa),
        S=Covariance(float(row.S11), float(row.S12), float(row.S22)),
        t=float(row.t),
        t_low=float(row.t_low),
        s=float(row.s),
        c=float(row.c),
        theta_low=float(row.theta_low),
    )


def keep_state(row, state):
    """Write `state` into a row of a table of motions; its end time and t0 stay."""
    row.mode = state.mode
    row.at = state.at
    row.n = state.n
    row.theta = state.theta
    row.x = state.x
    row.v = state.v
    row.Fb = state.Fb
    row.Fa = state.Fa
    row.S11 = state.S.S11
    row.S12 = state.S.S12
    row.S22 = state.S.S22
    row.t = state.t
    row.t_low = state.t_low
    row.s = state.s
    row.c = state.c
    row.theta_low = state.theta_low


# --- doubles ---


@outlined
def follow_all(begin, batch, most, accuracy, out, pieces, tally, table):
    """Follow the trajectories of `batch` from number `begin` on, until all have ended or a buffer
    is full.

    Return the number of the first that has not ended, and how many events and pieces are in the
    buffers.
    """
    #   begin : first trajectory to follow; it may have been begun before.
    #   batch : Batch, updated.
    #   most : events after which a trajectory is FULL.
    #   accuracy : it ends as INEXACT at the first event known to less, relative to max(1, |value|,
    #     |t0| for t).
    #   out : EventRows
    #   pieces : (PIECE_COLUMNS, m) buffer of the pieces that steps lead to; none are recorded where
    #     m is 0.
    #   tally : Tally, updated; events are recorded where it is for no motion, else only counted.
    #   table : constants of the parameter sets, as `symosc.engine.flow` makes them.
    rows = 0
    parts = 0
    for i in range(begin, batch.states.shape[0]):
        rows, parts = follow_one(
            i, False, rows, parts, batch, most, accuracy, out, pieces, tally, table
        )
        if batch.codes[i] == RUNNING:
            return i, rows, parts
    return batch.states.shape[0], rows, parts


@outlined
def follow_one(i, once, rows, parts, batch, most, accuracy, out, pieces, tally, table):
    """Follow trajectory `i` to its end or a full buffer, or one step if `once`.

    Return counts of events and pieces.
    """
    batch, out, pieces, tally, table = borrowed((batch, out, pieces, tally, table))
    states, sets, counts, codes = batch
    recorded = pieces.shape[1] > 0
    tallied = tally.floats.shape[0] > 0
    before = state_of(states[i])
    row = sets[i]
    K = table[row]
    t_end, t_end_low, t0 = end_by_phase(states[i], K)
    code = RUNNING
    going = True
    while code == RUNNING and going:
        if counts[i] >= most:
            code = FULL
            break
        if rows >= out.floats.shape[1] or (recorded and parts >= pieces.shape[1]):
            break
        event = advance(before, t_end, t_end_low, K)
        step, _, decided, t_error, state = event
        if not decided or step == FAILED:
            code = UNDECIDED
        elif step <= GRAZE:
            clock = time_with_errors(
                state.t, state.t_low, t0, state.x, state.v, t_error, state.S.S11, K
            )
            if is_inexact(clock[0], clock[1], state.x, clock[2], t0, accuracy):
                code = INEXACT
            if not tallied:
                write_event(out, rows, i, before, event, clock, K)
            rows += 1
            counts[i] += 1
        elif step != MOVED:
            code = step
        if tallied and code not in NEEDS_DIGITS and code != REST:
            tally_step(i, before, event, t0, tally, K)
        way = band_beyond(state.mode, K)
        if way != 0 and code not in NEEDS_DIGITS:
            state = entered(state, way)
            row += way
            K = table[row]
        if recorded and code == RUNNING:
            write_piece(pieces, parts, state, clock_time(state.t - t0, state.t_low, 0.0, K), K)
            parts += 1
        before = state
        going = not once
    if tallied and (code != RUNNING or not once):
        finish_tally(i, before, code, (t_end - before.t) + (t_end_low - before.t_low), t0, tally, K)
    keep_state(states[i], before)
    sets[i] = row
    codes[i] = code
    return rows, parts


def is_inexact(t, t_error, x, x_error, t0, accuracy):
    """Return whether t_error > accuracy max(1, |t|, |t0|) or x_error > accuracy max(1, |x|) for an
    event.
    """
    late = (t_error > accuracy) & (t_error > accuracy * abs(t)) & (t_error > accuracy * abs(t0))
    return late | ((x_error > accuracy) & (x_error > accuracy * abs(x)))


def end_by_phase(row, K):
    """Return t_end, t_end_low and t0 of a batch row.

    The end, as times in states, becomes phase/Omega with the rounded Omega.
    """
    t_end = float(row.t_end)
    t0 = float(row.t0)
    return t_end, float(row.t_end_low) - (t_end - t0) * K.Om_gain, t0


@outlined
def searched(state, row, K):
    """Find the next event after `state`, up to the end time in the batch row `row`.

    Return a NextEvent.
    """
    t_end, t_end_low, _ = end_by_phase(row, K)
    return advance(state, t_end, t_end_low, K)


@outlined
def search_row(states, table, row):
    """Move the state in row 0 on to its next event, with the constants in `row` of the table.

    Return the rest of the NextEvent, and its `open_free_time`.
    """
    before = state_of(states[0])
    K = table[row]
    event = searched(before, states[0], K)
    keep_state(states[0], event.state)
    return (
        event.code,
        event.boundary,
        event.decided,
        event.t_error,
        open_free_time(event, before, K),
    )


def open_free_time(event, state, K):
    """Return how long the flight from `state` surely meets no wall if its contact `event` is
    undecided, else 0.
    """
    if event.boundary > 0 and not event.decided:
        return free_time(state, K)
    return 0.0


@outlined
def doubt_row(states, count, most, accuracy, table, row):
    """Return what `next_undecided` does for the state in row 0 of `states`."""
    state = state_of(states[0])
    return next_undecided(state, count, states[0], most, accuracy, table, row)


@outlined
def next_undecided(state, count, motion, most, accuracy, table, row):
    """Look up to LOOK_AHEAD steps ahead of `state`.

    Return the number of the first event that doubles cannot decide or know too little of, or 0.

    Events are numbered on from `count`; those after number `most` do not matter. `motion` is the
    batch row of the motion, and `row` the number of its constants in `table`.
    """
    t0 = float(motion.t0)
    for _ in range(LOOK_AHEAD):
        K = table[row]
        step, _, decided, t_error, state = searched(state, motion, K)
        if count >= most or step in (END, REST):
            break
        if step == FAILED or not decided:
            return count + 1
        if step <= GRAZE:
            count += 1
            x = state.x
            v = state.v
            t, t_error, x_error = time_with_errors(
                state.t, state.t_low, t0, x, v, t_error, state.S.S11, K
            )
            if is_inexact(t, t_error, x, x_error, t0, accuracy):
                return count
        way = band_beyond(state.mode, K)
        if way != 0:
            state = entered(state, way)
            row += way
    return 0


def write_event(out, row, i, before, event, clock, K):
    """Write an event of trajectory `i` into column `row` of `out`.

    `clock` is (t, t_error, x_error).
    """
    numbers = event_numbers(before, event, clock, K)
    codes = event_codes(before, event, K)
    for n in range(len(numbers)):
        out.floats[n, row] = numbers[n]
    out.ints[0, row] = i
    for n in range(len(codes)):
        out.ints[n + 1, row] = codes[n]


def write_piece(pieces, row, state, elapsed, K):
    """Write a motion's piece that begins at `state`, a time `elapsed` after t0, into column `row`
    of `pieces`.
    """
    if state.mode <= ON_BELT:
        a = state.Fb
    else:
        a = 0.0
    band = float(K.row)
    numbers = float(state.n), state.theta, float(state.mode), state.x, state.v, a, elapsed, band
    for n in range(len(numbers)):
        pieces[n, row] = numbers[n]


# --- double-double numbers, where doubles cannot decide ---

# In loops that are bound to pairs these names stay functions of doubles
# (`symosc.engine.arithmetic.PLAIN_IN_PAIRS`).
end_by_phase_in_doubles = end_by_phase
searched_in_doubles = searched
next_undecided_in_doubles = next_undecided
open_free_time_in_doubles = open_free_time
write_event_in_doubles = write_event
write_piece_in_doubles = write_piece
entered_in_doubles = entered


def from_complex(value):
    """Return `value` unchanged in doubles.

    The version for pairs converts complex hi + i lo to pairs, also in a row of a table.
    """
    return value


def first_pairs(pairs, numbers, table):
    """Fill in forces, sine, cosine and errors of start states in pairs; none may be on a belt with
    a force near 0.

    `numbers` are those of their constants in the `table` of complex numbers.
    """
    for i in range(pairs.shape[0]):
        row = pairs[i]
        K = from_complex(table[numbers[i]])
        mode = int(row.mode)
        at = int(row.at)
        theta = float(row.theta)
        x = float(row.x)
        v = float(row.v)
        if at > 0:  # to the last bit
            v = belt_at(at, K).v
        s = sin(theta)
        c = cos(theta)
        row.v = v
        row.s = s
        row.c = c
        F = acceleration(x, v, c, constant_force(mode, K), K.cm, K.w0sq, K.f0)
        if mode > ON_BELT:
            belt = belt_at(at, K)
            below, above = belt_forces(at, x, c, K)
            below, above = held_forces(below, above, belt)
            row.Fb = below
            row.Fa = above
        else:
            row.Fb = F
            row.Fa = F
        row.S11 = (EPS * x) * (EPS * x)
        if at == 0:
            row.S22 = (EPS * v) * (EPS * v)


def follow_pairs(chosen, wanted, pairs, batch, out, pieces, table, tally, limits):
    """Follow the `chosen` trajectories in double-double numbers until each has `wanted` events or
    has ended.
    """
    # Doubles search for each event as far as they are sure (`advance_near`). A motion that doubles
    # could soon not decide again is followed farther, as long as the buffer holds its events.
    #   chosen : (m,) numbers of the trajectories to follow, in order.
    #   wanted : (n,) number of events to reach, with those so far; updated for a motion that has
    #     filled `pieces`.
    #   pairs : (n,) array of PAIR_ROW, updated: states in pairs.
    #   batch : Batch, updated: the states in doubles, with their rounding as their error; the
    #     events so far; RUNNING, END, REST, or UNDECIDED before a contact that pairs cannot decide,
    #     or an event that they know worse than `limits.noise` says: the states are the last ones
    #     that they are sure of.
    #   out : EventRows that hold all events to come.
    #   pieces : as `follow_all` takes it; a motion that has filled it is RUNNING.
    #   table : the rows of constants of the law of all these motions, of complex numbers.
    #   tally : as `follow_all` takes it.
    states, sets, counts, codes = batch
    rows = 0
    parts = 0
    recorded = pieces.shape[1] > 0
    tallied = tally.floats.shape[0] > 0
    for i in chosen:
        state = state_of(pairs[i])
        plain = limits.table[sets[i]]
        careful = limits.careful[sets[i]]
        K = from_complex(table[int(plain.row)])
        t_end = from_complex(pairs[i].t_end)
        t_end_low = from_complex(pairs[i].t_end_low)
        t0 = from_complex(pairs[i].t0)
        code = RUNNING
        goal = wanted[i]
        farthest = min(limits.most, wanted[i] + limits.more)  # number of the last event looked for
        rounded = in_doubles(state, t0, plain)
        while code == RUNNING and not (recorded and parts >= pieces.shape[1]):
            # Past its goal a motion goes on only while doubles could soon not decide again.
            if counts[i] >= goal:
                goal = next_undecided_in_doubles(
                    rounded, counts[i], states[i], farthest, limits.accuracy, limits.table, sets[i]
                )
                if goal == 0:
                    break
            rough = searched_in_doubles(rounded, states[i], careful)
            free = open_free_time_in_doubles(rough, rounded, careful)
            event = advance_near(state, rounded, rough, free, t_end, t_end_low, K)
            step = event.code
            rounded_after = in_doubles(event.state, t0, plain)
            # decided: events that are not are dropped below
            rounded_event = NextEvent(step, event.boundary, True, event.t_error.hi, rounded_after)
            if step == FAILED or not event.decided:
                code = UNDECIDED
                break
            if step <= GRAZE:
                S11 = event.state.S.S11
                t = event.state.t
                t_low = event.state.t_low
                x = event.state.x
                t, t_error, x_error = time_with_errors(
                    t, t_low, t0, x, event.state.v, event.t_error, S11, K
                )
                if not (
                    is_below(limits.noise, t_error.hi, t.hi)
                    and is_below(limits.noise, x_error.hi, x.hi)
                ):
                    code = UNDECIDED
                    break
                if rows < out.floats.shape[1]:  # there is none where tallies are kept
                    clock = t.hi, rounding_error(t_error.hi, t.hi), rounding_error(x_error.hi, x.hi)
                    write_event_in_doubles(out, rows, i, rounded, rounded_event, clock, plain)
                rows += 1
                counts[i] += 1
            elif step in (END, REST):
                code = step
            if tallied and code != REST:
                tally_step(i, rounded, rounded_event, t0.hi, tally, plain)
            state = event.state
            rounded = rounded_after
            way = band_beyond(rounded.mode, K)
            if way != 0:
                sets[i] += way
                plain = limits.table[sets[i]]
                careful = limits.careful[sets[i]]
                K = from_complex(table[int(plain.row)])
                state = entered(state, way)
                rounded = entered_in_doubles(rounded, way)
            if recorded and code == RUNNING:
                elapsed = ((state.t - t0.hi) + state.t_low).hi
                write_piece_in_doubles(pieces, parts, rounded, elapsed, plain)
                parts += 1
        if tallied:
            end, end_low, _ = end_by_phase_in_doubles(states[i], plain)
            remaining = (end - rounded.t) + (end_low - rounded.t_low)
            finish_tally(i, rounded, code, remaining, t0.hi, tally, plain)
        if recorded and goal > 0:
            wanted[i] = goal
        codes[i] = code
        keep_state(pairs[i], state)
        keep_state(states[i], rounded)
    return rows, parts


def in_doubles(state, t0, K):
    """Round a state of pairs to doubles, and add the rounding to its covariance.

    `K` and `t0` belong to the motion.
    """
    x = state.x.hi
    v = state.v.hi
    t = state.t.hi
    S = state.S
    S11, S12, S22 = rounded_covariance(state.at, x, v, S.S11.hi, S.S12.hi, S.S22.hi)
    t_low = ((state.t - t) + state.t_low).hi - (t - t0.hi) * K.Om_gain
    theta_low = ((state.theta - state.theta.hi) + state.theta_low).hi
    theta = state.theta.hi
    Fb = state.Fb.hi
    Fa = state.Fa.hi
    S = Covariance(S11, S12, S22)
    return State(
        state.mode,
        state.at,
        state.n,
        theta,
        x,
        v,
        Fb,
        Fa,
        S,
        t,
        t_low,
        state.s.hi,
        state.c.hi,
        theta_low,
    )


# --- rounding to doubles ---


def is_below(part, error, value):
    """Return whether `error` is at most the fraction `part` of the error of rounding `value` to a
    double.
    """
    return error <= part * (EPS * abs(value))


def rounding_error(error, value):
    """Return the error of `value` rounded to a double: the rounding, plus `error` unless that is
    negligible.
    """
    rounding = EPS * abs(value)
    if is_below(NEGLIGIBLE, error, value):
        return rounding
    return error + rounding


def rounded_covariance(at, x, v, S11, S12, S22):
    """Return the covariance of a state rounded to doubles.

    On a belt (`at` > 0) the velocity is exact.
    """
    position = (EPS * x) * (EPS * x)
    velocity = (EPS * v) * (EPS * v)
    if NEGLIGIBLE * NEGLIGIBLE * velocity >= S22:
        S12 = 0.0
        S22 = 0.0
    if NEGLIGIBLE * NEGLIGIBLE * position >= S11:
        S11 = position
    else:
        S11 = S11 + position
    return S11, S12, (S22 if at > 0 else S22 + velocity)
