"""Solutions that are functions of time: the times at which they are asked, and their values."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from math import ceil, inf, pi
from typing import Any

import numpy as np

from symosc.base.errors import ParameterError, brief
from symosc.base.exact import unmasked
from symosc.crosschecks.frames import Problem
from symosc.crosschecks.samples import checked, fastest_rate
from symosc.model import Model
from symosc.scenes import Scene, model_of
from symosc.simulation.trajectory import Trajectory

#: Times at which a function is asked: at least, at most, and in the shorter one of the periods of
#: the drive and the free motion.
LEAST_TIMES = 1_000
MOST_TIMES = 200_000
TIMES_PER_PERIOD = 200


def even_times(t0: float, t_end: float, p: Model) -> np.ndarray:
    """Return evenly spaced times that resolve the shorter period of the drive and the free
    motion.
    """
    period = 2.0 * pi / fastest_rate(p)
    count = ceil(min((t_end - t0) / period * TIMES_PER_PERIOD, float(MOST_TIMES)))
    return np.linspace(t0, t_end, min(max(count, LEAST_TIMES), MOST_TIMES) + 1)


def times_for(function: Callable[..., Any], problem: Problem) -> np.ndarray:
    """Return the times at which a function is asked, from its start to its end.

    These are t_min and t_max if the function has these attributes, as scipy's OdeSolution has, else
    those of the scene `problem`.
    """
    ends: list[Any] = [getattr(function, name, None) for name in ("t_min", "t_max")]
    if None in ends and isinstance(problem, Scene):
        own = problem.original or problem
        ends = [own.t0, own.t_end]
    if None in ends or problem is None:
        what = (
            "needs times: give crosscheck(parameters, t, function), or a scene, "
            "which says from when to when"
        )
        raise ParameterError("function", _name_of(function), what)
    times = even_times(float(ends[0]), float(ends[1]), model_of(problem))
    nodes = getattr(function, "ts", None)
    if nodes is None:
        return times
    return np.unique([*times, *np.asarray(nodes, dtype=float)])


def _name_of(function: Callable[..., Any]) -> str:
    """Return what messages call a function: its name, or that of its class."""
    name: str = getattr(function, "__name__", type(function).__name__)
    return name


def values_at(function: Callable[..., Any], times: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the times as floats, and x and v of a function of all times at once or of one by
    one.
    """
    times = checked(times, np.zeros(np.shape(times)), np.zeros(np.shape(times))).t
    with suppress(Exception):  # masked, or whatever it raises if it takes single numbers alone
        states = np.asarray(unmasked("function", function(times)), dtype=float)
        if (2, len(times)) in (states.shape, states.shape[::-1]):
            return times, states if len(states) == 2 else states.T
    rows = []
    for time in times.tolist():
        try:
            value = function(time)
        except ParameterError:
            raise
        except Exception as error:  # it is somebody's; the traceback goes on to its own line
            what = brief(f"{type(error).__name__}: {error}".partition("\n")[0])
            name = _name_of(function)
            raise ParameterError("function", name, f"fails at t = {time:g}: {what}") from error
        rows.append(np.ravel(unmasked("function", value)))
    for time, row in zip(times.tolist(), rows, strict=True):
        if len(row) != 2:
            what = f"must return two numbers, x and v; at t = {time:g} it returns {len(row)}"
            raise ParameterError("function", _name_of(function), what)
    return times, np.array(rows).T


def dense_note(trajectory: Trajectory, dense: Callable[[np.ndarray], Any], until: float) -> str:
    """Return a note that says how far a solver's dense output is from the exact motion up to the
    time `until`.
    """
    low = max(float(trajectory.t_start), float(getattr(dense, "t_min", -inf)))
    high = min(until, float(getattr(dense, "t_max", inf)))
    if not low < high:
        return "the dense output and the exact motion have no times in common"
    times, states = values_at(dense, even_times(low, high, trajectory.parameters))
    errors = np.abs(states - trajectory(times))
    x, v = (float(np.max(row)) for row in errors)
    worst = float(times[int(np.argmax(errors[1]))])
    where = f"at t = {worst:.10g}, of {len(times):,} times"
    return f"the dense output is off by up to {x:.2e} in x, {v:.2e} in v ({where})"
