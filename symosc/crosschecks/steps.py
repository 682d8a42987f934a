"""The exact motion over each step of somebody's samples, restarted from every sample: local errors, not global ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, pi
from typing import Any

import numpy as np

from symosc.crosschecks.quiet import quiet_ends
from symosc.engine.arithmetic import Arithmetic, mp_context
from symosc.engine.batch import Batch, batch_of, keep_state, state_of
from symosc.engine.constant_table import table_of
from symosc.engine.flow import Constants
from symosc.engine.next_event import TWO_PI, advance
from symosc.engine.start import start_rows
from symosc.engine.state import CROSS, END, FAILED, GRAZE, MOVED, ON_BELT, REST
from symosc.kernels import entire_array
from symosc.kernels._generated import acceleration, motion
from symosc.kernels.entire import EPS
from symosc.model import Parameters
from symosc.simulation.batch import InterpretBudget, chosen_loops, follow_batch, joined

# Fewer steps than this are interpreted before compiled code is loaded, which takes a second; so are fewer ones once
# they are many together, as in the diagnoses of many solutions. The bits are the same.
COMPILE_FROM = 4000
FEW_STEPS = InterpretBudget(50_000)
MOST_STEP_EVENTS = 10_000  # in one step
# Steps that are followed together: what they need besides the result stays in the processor's cache.
STEPS_TOGETHER = 1 << 16


@dataclass(frozen=True)
class StepEvents:
    """Events of the exact motion inside steps, in order of step and time.

    Attributes
    ----------
    step : (rows,) int array
    t, x, theta : (rows,) float arrays
        Times, positions, phases.
    kind, boundary, target : (rows,) int arrays
        Codes of `symosc.engine.events.KIND_NAMES`, 1 or 2, codes of `symosc.model.MODE_NAMES`.
    """

    step: np.ndarray
    t: np.ndarray
    x: np.ndarray
    theta: np.ndarray
    kind: np.ndarray
    boundary: np.ndarray
    target: np.ndarray

    def rows(self, first: int, last: int) -> slice:
        """Return where the events of steps `first` to `last` (included) are."""
        return slice(*np.searchsorted(self.step, [first, last + 1]))


@dataclass(frozen=True)
class ExactSteps:
    """What the exact motion does between one sample and the next.

    Attributes
    ----------
    parameters, K : Parameters, Constants
    t, x, v : (n,) arrays, the samples
    theta : (n,) array, phases
    defects : (n - 1, 2) array
        Exact motion from a sample over the step, minus the next sample: x and v.
    first, last : (n - 1,) int arrays
        Codes of the motion (MODE_NAMES) just after the sample and at the end of the step.
    events : StepEvents
    """

    parameters: Parameters
    K: Constants
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    theta: np.ndarray
    defects: np.ndarray
    first: np.ndarray
    last: np.ndarray
    events: StepEvents

    def at(self, time: float, slack: float = 0.0) -> tuple[int, int]:
        """Return the first and the last step within `slack` of a time."""
        low, high = np.searchsorted(self.t, [time - slack, time + slack], "right") - 1
        last = len(self.first) - 1
        return min(max(int(low), 0), last), min(max(int(high), 0), last)

    def flight(self, domain: Any, since: Any, until: Any) -> np.ndarray:
        """Return x, v at samples `until` if the force of `domain` acted alone since samples `since`.

        Both are index arrays; `domain` is one for all, or an array.
        """
        K, tau = self.K, self.t[until] - self.t[since]
        s0, c0 = np.sin(self.theta[since]), np.cos(self.theta[since])
        x0, v0 = self.x[since], self.v[since]
        A = np.take([K.A1, K.A2, K.A3], domain - 1)
        a0 = acceleration(x0, v0, c0, A, K.cm, K.w0sq, K.f0)
        E0, E1, E2, R2, I2, _, _ = entire_array.basis(tau, K)
        dx, dv, _ = motion(v0, a0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        return np.stack([x0 + dx, v0 + dv], axis=-1)


def follow_steps(parameters: Parameters, t: Any, x: Any, v: Any, near: Any, scales: Any) -> ExactSteps:
    """Restart the exact motion from every sample and follow it to the time of the next one.

    A sample with |v - v_lambda| <= near may be meant to be on the belt or beside it. Both are tried, and the one that
    agrees better with the next sample counts. Where a time is repeated nothing moves: the defect is the jump.

    Parameters
    ----------
    parameters : Parameters
    t, x, v : (n,) float arrays, t never decreasing
    near : float or (n,) array
        Unit of velocity.
    scales : (2,) or (n - 1, 2) array
        Units in which the defects of x and v are compared with each other.
    """
    K = Arithmetic(parameters).K._replace(sigmas=0.0)
    count = len(t) - 1
    scales = np.broadcast_to(scales, (count, 2))
    theta, defects, modes = np.empty(count + 1), np.empty((count, 2)), np.zeros((2, count), np.int8)
    near, found = np.broadcast_to(near, count + 1), []
    for begin in range(0, count, STEPS_TOGETHER):
        part = slice(begin, min(begin + STEPS_TOGETHER, count) + 1)
        theta[part] = phases(parameters, t[part])[1]
        inner = slice(begin, part.stop - 1)
        some = Pieces(K, t[part], x[part], v[part], theta[part], near[part], scales[inner])
        defects[inner], modes[:, inner], events = some.follow()
        found.append(replace(events, step=events.step + begin))
    _at_joints(t, modes)
    return ExactSteps(parameters, K, t, x, v, theta, defects, modes[0], modes[1], concatenated(found))


def _at_joints(t: np.ndarray, modes: np.ndarray) -> None:
    """Let a step in which no time passes have the mode in which the motion arrives, or leaves the first sample."""
    for i in np.flatnonzero(np.diff(t) == 0.0).tolist():
        modes[:, i] = modes[1, i - 1] if i else modes[0, int(np.argmax(np.diff(t) > 0.0))]


@dataclass(frozen=True)
class Pieces:
    """Some samples one after the other, and what `follow_steps` needs of them."""

    K: Constants
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    theta: np.ndarray
    near: np.ndarray
    scales: np.ndarray

    def follow(self) -> tuple[np.ndarray, np.ndarray, StepEvents]:
        """Return the defects of the steps between the samples, their first and last modes, and the events."""
        v, near = self.v[:-1], self.near[:-1]
        gaps = np.abs(v[:, None] - np.array([self.K.belt1.v, self.K.belt2.v]))
        closest, beside = np.argmin(gaps, axis=1) + 1, gaps.min(axis=1)
        moving = np.flatnonzero(np.diff(self.t) > 0.0)
        defects = np.column_stack([self.x[:-1], v]) - np.column_stack([self.x[1:], self.v[1:]])
        modes, size = np.zeros((2, len(v)), np.int8), np.zeros(len(v))
        on = np.where(beside == 0.0, closest, 0)  # the boundary of a sample that is exactly on a belt
        defects[moving], modes[:, moving], size[moving], events = self.of(moving, on[moving])
        doubtful = moving[(beside[moving] > 0.0) & (beside[moving] <= near[moving])]
        if len(doubtful):
            others = self.of(doubtful, closest[doubtful])
            # On a belt both agree up to rounding: then it is on the belt.
            better = ~(others[2] > size[doubtful] * (1.0 + 1e-6) + EPS)
            chosen = doubtful[better]
            defects[chosen], modes[:, chosen] = others[0][better], others[1][:, better]
            events = _joined(events, others[3], chosen)
        return defects, modes, events

    def of(self, steps: np.ndarray, on: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, StepEvents]:
        """Return what `follow` does for some steps from belt `on` (0: from where the sample is), with their sizes."""
        belts, left = np.array([self.K.belt1.v, self.K.belt2.v]), self.t[steps + 1] - self.t[steps]
        start_v = np.where(on > 0, belts[on - 1], self.v[steps])
        rows, _ = start_rows(on, self.theta[steps], self.x[steps], start_v, (0.0, 0.0, left, 0.0, 0.0), self.K)
        modes, ends, events = followed_rows(rows, left, self.K)
        defects = ends - np.column_stack([self.x[steps + 1], self.v[steps + 1]])
        origin = steps[events.step]
        events = replace(events, step=origin, t=self.t[origin] + events.t)
        return defects, modes, np.max(np.abs(defects) / self.scales[steps], axis=1), events


def phases(parameters: Parameters, t: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return (periods, theta) with Omega t = 2 pi periods + theta for an array of times, however large they are."""
    context = mp_context(60)
    Om = parameters.Omega
    exact = context.mpf(Om.numerator) / Om.denominator / (2 * context.pi)  # turns per time
    high = float(exact)
    low = float(exact - high)
    turns = t * high
    # Dekker's product: what the rounding of t * high lost.
    t_big, high_big = _upper_half(t), _upper_half(np.float64(high))
    t_rest, high_rest = t - t_big, high - high_big
    lost = ((t_big * high_big - turns) + t_big * high_rest + t_rest * high_big) + t_rest * high_rest
    whole = np.floor(turns)
    part = (turns - whole) + (lost + t * low)
    shift = np.floor(part)
    theta = (part - shift) * (2.0 * pi)
    over = theta >= TWO_PI
    return (whole + shift + over).astype(np.int64), np.where(over, 0.0, theta)


def _upper_half(value: Any) -> Any:
    shifted = value * 134217729.0  # 2^27 + 1
    return shifted - (shifted - value)


def followed_rows(rows: np.ndarray, left: np.ndarray, K: Constants) -> tuple[np.ndarray, np.ndarray, StepEvents]:
    """Follow every row to its end, `left` later.

    Returns
    -------
    modes : (2, n) int array
        Just after the start and at the end.
    ends : (n, 2) array
        States [x, v] at the ends.
    events : StepEvents
        With times from the starts on.
    """
    modes, ends = np.array([rows[:, 0], rows[:, 0]]).astype(np.int8), np.empty((len(rows), 2))
    quiet, states = quiet_ends(rows, left, K)
    ends[quiet] = states
    busy = np.delete(np.arange(len(rows)), quiet)
    modes[1, busy], ends[busy], events = _follow(rows[busy], left[busy], K)
    return modes, ends, replace(events, step=busy[events.step])


def _follow(rows: np.ndarray, left: np.ndarray, K: Constants) -> tuple[np.ndarray, np.ndarray, StepEvents]:
    """Follow every row event by event; return the last modes, states [x, v] there and events, from time 0."""
    batch = batch_of(rows.copy())
    few = len(rows) < COMPILE_FROM and FEW_STEPS.events > 0
    follow = chosen_loops(False if few else None).follow
    numbers, table = joined(follow_batch(follow, batch, MOST_STEP_EVENTS, inf, table_of([K])))
    FEW_STEPS.events -= len(rows) * few
    t, x, theta = numbers[[0, 1, 3]]
    found = StepEvents(table[0].astype(int), t, x, theta, table[1], table[2], table[4])
    doubtful = np.flatnonzero((batch.codes != END) & (batch.codes != REST))
    if len(doubtful):
        singles = [_follow_one(batch, rows, i, K) for i in doubtful.tolist()]
        columns = np.array([event for single in singles for event in single], dtype=float).reshape(-1, 7).T
        step, kind, boundary, target = (columns[k].astype(int) for k in (0, 4, 5, 6))
        found = _joined(found, StepEvents(step, columns[1], columns[2], columns[3], kind, boundary, target), doubtful)
    modes = batch.states[:, 0].astype(int)
    ends = _ends(rows, modes, left, found, K)
    ends[batch.codes == FAILED] = np.nan
    return modes, ends, found


def _ends(rows: np.ndarray, modes: np.ndarray, left: np.ndarray, events: StepEvents, K: Constants) -> np.ndarray:
    """Return the states [x, v] at the ends, in one piece from the last event of each row or from its start."""
    theta, x, v, a, left = rows[:, 3].copy(), rows[:, 4].copy(), rows[:, 5].copy(), rows[:, 6].copy(), left.copy()
    lasts = np.flatnonzero(np.diff(events.step, append=-1))
    i, belt = events.step[lasts], np.array([K.belt1.v, K.belt2.v])[events.boundary[lasts] - 1]
    theta[i], x[i], v[i], left[i] = events.theta[lasts], events.x[lasts], belt, left[i] - events.t[lasts]
    # After a slip and a graze the acceleration begins with 0.
    A = np.array([K.A1, K.A2, K.A3, 0.0, 0.0])[modes[i] - 1]
    a[i] = (events.kind[lasts] == CROSS) * acceleration(x[i], belt, np.cos(theta[i]), A, K.cm, K.w0sq, K.f0)
    E0, E1, E2, R2, I2, _, _ = entire_array.basis(left, K)
    dx, dv, _ = motion(v, a, np.sin(theta), np.cos(theta), K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    held = modes > ON_BELT
    return np.column_stack([x + np.where(held, v * left, dx), v + np.where(held, 0.0, dv)])


def _follow_one(batch: Batch, rows: np.ndarray, i: int, K: Constants) -> list[tuple[Any, ...]]:
    """Follow a row with a contact within rounding: what it is makes no difference beyond rounding, so it is taken."""
    state, (t_end, t_end_low) = state_of(rows, i), rows[i, 13:15].tolist()
    events: list[tuple[Any, ...]] = []
    code = MOVED
    while code not in (END, REST, FAILED) and len(events) < MOST_STEP_EVENTS:
        code, boundary, _, _, state = advance(state, t_end, t_end_low, K)
        if code <= GRAZE:
            events.append((i, state.t, state.x, state.theta, code, boundary, state.mode))
    batch.codes[i] = code if code in (END, REST) else FAILED
    keep_state(batch.states, i, state)
    return events


def _joined(events: StepEvents, others: StepEvents, steps: np.ndarray) -> StepEvents:
    """Return `events` with those of `steps` taken from `others`."""
    kept, taken = ~np.isin(events.step, steps), np.isin(others.step, steps)
    columns = {
        name: np.concatenate([getattr(events, name)[kept], getattr(others, name)[taken]]) for name in vars(events)
    }
    order = np.lexsort((columns["t"], columns["step"]))
    return StepEvents(**{name: column[order] for name, column in columns.items()})


def concatenated(parts: Sequence[StepEvents]) -> StepEvents:
    """Return events of several parts, one after the other."""
    return StepEvents(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in vars(parts[0])})
