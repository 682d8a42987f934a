"""Events that a solver's event functions found: `t_events` of scipy, or te and ie of MATLAB."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from math import isfinite, nan, pi
from typing import Any, NamedTuple

import numpy as np

from symosc.base.errors import ParameterError, brief
from symosc.base.exact import unmasked
from symosc.crosschecks.frames import Problem, has_moving_frame
from symosc.crosschecks.samples import Samples, fastest_rate
from symosc.model import Model
from symosc.scenes import model_of

# Two functions that vanish together, such as an event that ends a piece, find one event: their
# times differ by less than this part of the shortest period.
SAME_TIME = 1e-9
# A speed is a belt's if it differs from it by less than this part of the largest speed.
AT_BELT = 1e-6


class SolverEvents(NamedTuple):
    """Times that a solver's event functions found at a belt, and notes on the others.

    `events` are pairs (t, ""), their kinds being unknown; `lists` the same times by function.
    """

    events: tuple[tuple[float, str], ...] | None = None
    lists: tuple[tuple[float, ...], ...] | None = None
    notes: tuple[str, ...] = ()


def solver_events(columns: Mapping[str, Any], problem: Problem, samples: Samples) -> SolverEvents:
    """Return the `t_events` of a result, or its te and ie, by event function.

    A function that finds a time where v is not a belt's looks for something else, and is left out;
    an empty list may be that of a belt.
    """
    lists = columns.get("t_events")
    states = columns.get("y_events")
    if lists is None and columns.get("te") is not None:
        lists, states = _lists_of_matlab(columns)
    if lists is None or problem is None:
        return SolverEvents()
    if has_moving_frame(problem):
        note = (
            "the solver's t_events are left out: the speeds of the belts change in its coordinates"
        )
        return SolverEvents(notes=(note,))
    p = model_of(problem)
    kept: list[tuple[float, ...]] = []
    beside = 0
    for i, values in enumerate(lists if np.iterable(lists) else [nan]):
        times = _finite_times(values)
        speeds = None if states is None else _speeds(states, i, len(times))
        if _are_at_belts(p, samples, times, speeds):
            kept.append(tuple(times))
        else:
            beside += 1
    if not any(kept):
        return SolverEvents(lists=tuple(kept))
    distinct: list[float] = []
    for time in sorted(chain.from_iterable(kept)):
        if not distinct or time - distinct[-1] > SAME_TIME * 2.0 * pi / fastest_rate(p):
            distinct.append(time)
    notes = [
        "the times of events are the solver's t_events; they must have every contact at a belt "
        "that they are about, and the rest is read off the samples"
    ]
    if beside:
        functions = "1 event function finds" if beside == 1 else f"{beside} event functions find"
        notes.append(f"{functions} times that are not at a belt: left out")
    return SolverEvents(tuple((time, "") for time in distinct), tuple(kept), tuple(notes))


def _finite_times(values: Any) -> list[float]:
    """Return the times of one event function."""
    unmasked("t_events", values)
    try:
        times: list[float] = np.ravel(np.asarray(values, dtype=float)).tolist()
    except (TypeError, ValueError):
        times = [nan]
    if not all(map(isfinite, times)):
        raise ParameterError("t_events", brief(repr(values)), "must be lists of finite times")
    return times


def _speeds(states: Any, i: int, count: int) -> list[float]:
    """Return the velocities at the times that event function number `i` found."""
    try:
        return [float(np.ravel(states[i][j])[-1]) for j in range(count)]
    except (IndexError, KeyError, TypeError, ValueError):
        what = "must have x and v for each of t_events"
        raise ParameterError("y_events", type(states).__name__, what) from None


def _lists_of_matlab(columns: Mapping[str, Any]) -> tuple[list[Any], list[Any] | None]:
    """Return times and states by event function from the te, ye (or xe) and ie of MATLAB's
    ode45.
    """
    times = np.ravel(columns["te"])
    ie = columns.get("ie")
    functions = np.zeros(len(times)) if ie is None else np.ravel(ie)
    if len(functions) != len(times):
        what = f"must have one number for each of {len(times)} te"
        raise ParameterError("ie", len(functions), what)
    rows = [functions == number for number in np.unique(functions)]
    lists = [times[row] for row in rows]
    states = [columns[name] for name in ("ye", "xe") if columns.get(name) is not None]
    if not states:
        return lists, None
    try:
        by_time = np.reshape(np.asarray(states[0]), (len(times), -1))
    except ValueError:
        what = f"must have x and v for each of {len(times)} te"
        raise ParameterError("ye", type(states[0]).__name__, what) from None
    return lists, [by_time[row] for row in rows]


def _are_at_belts(
    p: Model, samples: Samples, times: Sequence[float], speeds: Sequence[float] | None
) -> bool:
    """Return whether v is the speed of a belt at all times.

    Without `speeds`, of the samples around them.
    """
    belts = np.array([[float(belt.v)] for belt in p.law.belts])
    largest = 0.0 if samples.lacks_v else float(np.max(np.abs(samples.v)))
    if speeds is None:
        if samples.lacks_v:
            return True
        after = np.clip(np.searchsorted(samples.t, times), 1, len(samples.t) - 1)
        around = np.stack([samples.v[after - 1], samples.v[after]])
        low = np.min(around, axis=0) - AT_BELT * largest
        high = np.max(around, axis=0) + AT_BELT * largest
        return bool(np.all(np.any((belts >= low) & (belts <= high), axis=0)))
    v = np.array(speeds)
    near = AT_BELT * np.maximum(np.abs(v), max(largest, 1e-300))
    return bool(np.all(np.any(np.abs(v - belts) <= near, axis=0)))
