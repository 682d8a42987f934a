"""Many trajectories in one loop, events into columns: what `simulate_many` compiles."""

from __future__ import annotations

from math import sqrt

from symosc.engine.next_event import FAILED, GRAZE, MOVED, advance
from symosc.kernels.entire import EPS

# Columns of a row of STATE, OUT_FLOAT and OUT_INT.
# mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, then t_end, t_end_low, t0
STATE_WIDTH = 16
FLOAT_COLUMNS = ("t", "x", "v", "theta", "t_error", "x_error")
# What a trajectory ended with, beside the codes of `advance`.
RUNNING, FULL, IN_DOUBT, INEXACT = 0, -1, -2, -3


def handed_out(t, t_low, t0, x, v, t_error, S11, K):
    """Return an event's time, and standard errors of t and x that cover the rounding of these two numbers.

    What a motion is locked to is the phase: the rounding of Omega is taken back in the time that it stands for.
    """
    since = t - t0
    out = t + (t_low + since * K.Om_gain)
    t_error, x_error = t_error + EPS * (abs(out) + 0.25 * since), abs(v) * t_error + sqrt(S11) + EPS * abs(x)
    return out, t_error, x_error


def follow_all(begin, states, counts, codes, most, accuracy, out_float, out_int, K):
    """Follow trajectories from number `begin` on, until all are done or the output is full.

    Parameters
    ----------
    begin : first trajectory to follow; it may have been begun before.
    states : (n, STATE_WIDTH) array, updated.
    counts, codes : (n,) events so far, and what each trajectory ended with; updated.
    most : events after which a trajectory is FULL.
    accuracy : a trajectory ends as INEXACT at the first event known to less, relative to max(1, |value|, |t0| for t).
    out_float, out_int : output rows, (capacity, 6) and (capacity, 5).
    K : Constants

    Returns
    -------
    (next, rows)
        The trajectory to go on with, and the number of rows that were filled.
    """
    rows = 0
    for i in range(begin, states.shape[0]):
        mode, at, n = int(states[i, 0]), int(states[i, 1]), int(states[i, 2])
        # float() and int(): under CPython numpy's own scalars would be slower.
        theta, x, v = float(states[i, 3]), float(states[i, 4]), float(states[i, 5])
        Fb, Fa = float(states[i, 6]), float(states[i, 7])
        S11, S12, S22 = float(states[i, 8]), float(states[i, 9]), float(states[i, 10])
        t, t_low, t_end, t_end_low = (
            float(states[i, 11]),
            float(states[i, 12]),
            float(states[i, 13]),
            float(states[i, 14]),
        )
        t0 = float(states[i, 15])
        code = RUNNING
        while code == RUNNING:
            if counts[i] >= most:
                code = FULL
                break
            if rows >= out_float.shape[0]:
                break
            source = mode
            step, boundary, decided, t_error, mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low = advance(
                mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, t_end, t_end_low, K
            )
            if not decided or step == FAILED:
                code = IN_DOUBT
            elif step <= GRAZE:
                out, t_error, x_error = handed_out(t, t_low, t0, x, v, t_error, S11, K)
                if t_error > accuracy * max(1.0, abs(out), abs(t0)) or x_error > accuracy * max(1.0, abs(x)):
                    code = INEXACT
                out_float[rows, 0], out_float[rows, 1], out_float[rows, 2], out_float[rows, 3] = out, x, v, theta
                out_float[rows, 4], out_float[rows, 5] = t_error, x_error
                out_int[rows, 0], out_int[rows, 1], out_int[rows, 2] = i, step, boundary
                out_int[rows, 3], out_int[rows, 4] = source, mode
                rows += 1
                counts[i] += 1
            elif step != MOVED:
                code = step
        states[i, 0], states[i, 1], states[i, 2] = mode, at, n
        states[i, 3], states[i, 4], states[i, 5], states[i, 6], states[i, 7] = theta, x, v, Fb, Fa
        states[i, 8], states[i, 9], states[i, 10], states[i, 11], states[i, 12] = S11, S12, S22, t, t_low
        codes[i] = code
        if code == RUNNING:
            return i, rows
    return states.shape[0], rows
