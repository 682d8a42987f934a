"""Solutions that can be asked at any time: functions t -> (x, v), dense outputs, trajectories; events of solvers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, inf, isfinite, nan, pi
from typing import Any

import numpy as np

from symosc.crosschecks.samples import Samples, checked
from symosc.errors import ParameterError, brief
from symosc.exact import unmasked
from symosc.model import Parameters
from symosc.scenes import Scene
from symosc.simulation.trajectory import Trajectory

# A function is asked so often in the shortest of the periods of the drive and of the free motion, within these limits.
TIMES_PER_PERIOD = 200
FEWEST_TIMES, MOST_TIMES = 1_000, 200_000
# An event of a solver is at a belt if its velocity is that of the belt to this part of the largest.
AT_BELT = 1e-6
# Events of a solver closer than this part of the forcing period are one.
SAME_EVENT = 1e-9


@dataclass(frozen=True)
class SolverTask:
    """What is to be solved, as far as a function needs it to be asked: `t_end` is None where no scene says it."""

    parameters: Parameters
    t0: float | None = None
    t_end: float | None = None

    @property
    def period(self) -> float:
        """Shortest of the periods of the drive and of the free motion."""
        return 2.0 * pi / max(float(self.parameters.Omega), float(self.parameters.k / self.parameters.m) ** 0.5)


def solver_task(scene: Scene | Parameters) -> SolverTask:
    """Return what is to be solved."""
    if isinstance(scene, Parameters):
        return SolverTask(scene)
    return SolverTask(scene.parameters, float(scene.t0), float(scene.t_end))


def grid(t0: float, t_end: float, problem: SolverTask) -> np.ndarray:
    """Return times at which a function is asked."""
    count = ceil(min((t_end - t0) / problem.period * TIMES_PER_PERIOD, float(MOST_TIMES)))
    return np.linspace(t0, t_end, min(max(count, FEWEST_TIMES), MOST_TIMES) + 1)


def of_trajectory(trajectory: Trajectory) -> Samples:
    """Return samples of an exact motion, at its events too, and the list of these."""
    t0, t_end = float(trajectory.t_start), float(trajectory.t_end)
    events = tuple((float(event.t), event.kind) for event in trajectory.events)
    times = np.unique([*grid(t0, t_end, SolverTask(trajectory.parameters)), *(t for t, _ in events)])
    return replace(checked(times, *trajectory(times)), events=events, notes=("an exact trajectory",))


def of_function(function: Callable[..., Any], problem: SolverTask | None, times: Any = None) -> Samples:
    """Return samples of a function t -> (x, v), at given times, between its own ends, or over the scene."""
    if times is None:
        ends: list[Any] = [getattr(function, name, None) for name in ("t_min", "t_max")]
        if None in ends and problem is not None:
            ends = [problem.t0, problem.t_end]
        if None in ends or problem is None:
            what = "needs times: give crosscheck(parameters, t, function), or a scene, which says from when to when"
            raise ParameterError("function", getattr(function, "__name__", type(function).__name__), what)
        times = grid(float(ends[0]), float(ends[1]), problem)
        nodes = getattr(function, "ts", None)
        times = times if nodes is None else np.unique([*times, *np.asarray(nodes, dtype=float)])
    times = checked(times, np.zeros(np.shape(times)), np.zeros(np.shape(times))).t
    samples = checked(times, *_asked(function, times))
    return replace(samples, notes=(f"the function was asked at {len(times)} times",))


def _asked(function: Callable[..., Any], times: np.ndarray) -> np.ndarray:
    """Return x and v of a function that takes all times at once, or one after the other."""
    try:
        states = np.asarray(unmasked("function", function(times)), dtype=float)
    except Exception:  # masked, or whatever it raises if it takes single numbers alone
        states = np.empty(0)
    if states.shape == (2, len(times)):
        return states
    if states.shape == (len(times), 2):
        return states.T
    single = [np.ravel(unmasked("function", _at(function, time))) for time in times.tolist()]
    if any(len(state) != 2 for state in single):
        raise ParameterError("function", len(single[0]), "must return two numbers, x and v; it returned so many")
    return np.array(single).T


def _at(function: Callable[..., Any], time: float) -> Any:
    try:
        return function(time)
    except ParameterError:
        raise
    except Exception as error:  # it is somebody's; the traceback goes on to its own line
        what = brief(f"{type(error).__name__}: {error}".partition("\n")[0])
        raise ParameterError(
            "function", getattr(function, "__name__", "?"), f"fails at t = {time:g}: {what}"
        ) from error


def dense_note(trajectory: Trajectory, dense: Callable[[np.ndarray], Any], until: float) -> str:
    """Return how far a solver's dense output is from the exact motion, as a note: it is no step, and not judged."""
    ends = (getattr(dense, "t_min", -inf), getattr(dense, "t_max", inf))
    low, high = max(float(trajectory.t_start), float(ends[0])), min(until, float(ends[1]))
    if not low < high:
        return "the dense output and the exact motion have no times in common"
    times = grid(low, high, SolverTask(trajectory.parameters))
    errors = np.abs(_asked(dense, times) - trajectory(times))
    x, v = (float(np.max(row)) for row in errors)
    worst = float(times[int(np.argmax(errors[1]))])
    return f"the dense output is off by up to {x:.2e} in x, {v:.2e} in v (at t = {worst:.10g}, of {len(times):,} times)"


def _times(values: Any) -> list[float]:
    unmasked("t_events", values)
    try:
        found: list[float] = np.ravel(np.asarray(values, dtype=float)).tolist()
    except (TypeError, ValueError):
        found = [nan]
    if not all(map(isfinite, found)):
        raise ParameterError("t_events", brief(repr(values)), "must be lists of finite times")
    return found


def _speed(states: Any, i: int, j: int) -> float:
    try:
        return float(np.ravel(states[i][j])[-1])
    except (IndexError, KeyError, TypeError, ValueError):
        raise ParameterError("y_events", type(states).__name__, "must have x and v for each of t_events") from None


def solver_events(
    result: Any, problem: SolverTask | None
) -> tuple[tuple[tuple[float, str], ...] | None, tuple[str, ...]]:
    """Return the events that a result of scipy lists (`t_events`), with the kind "", and notes.

    Only those at a belt count: a solver may have looked for other things too. Two functions that vanish together, such
    as an event that is the end of one piece, are one event.
    """
    lists, states = getattr(result, "t_events", None), getattr(result, "y_events", None)
    if lists is None or problem is None:
        return None, ()
    p, found, beside = problem.parameters, [], 0
    belts = np.array([float(p.v1), float(p.v2)])
    for i, times in enumerate(lists if np.iterable(lists) else [nan]):
        for j, time in enumerate(_times(times)):
            v = belts[0] if states is None else _speed(states, i, j)
            near = np.min(np.abs(v - belts)) <= AT_BELT * max(float(np.max(np.abs(belts))), abs(v), 1e-300)
            found += [time] if near else []
            beside += not near
    kept: list[float] = []
    for time in sorted(found):
        if not kept or time - kept[-1] > SAME_EVENT * problem.period:
            kept.append(time)
    if not kept:
        return None, ()
    notes = ["the times of events are the solver's t_events; what they do not list is read off the samples"]
    if beside:
        notes.append(f"{beside} of the solver's t_events are not at a belt, and left out")
    return tuple((time, "") for time in kept), tuple(notes)
