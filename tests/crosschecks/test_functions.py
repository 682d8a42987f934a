"""Functions, dense outputs and trajectories as solutions."""

from __future__ import annotations

from math import cos, sin
from types import SimpleNamespace

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import ParameterError, load_scene, simulate
from symosc.crosschecks.functions import MOST_TIMES, SolverTask, of_function, solver_events, solver_task

FIG9 = load_scene("fig9")


def test_functions_of_one_time_and_of_many() -> None:
    problem = solver_task(FIG9)
    for function in (
        lambda t: (sin(t), cos(t)),
        lambda t: np.array([np.sin(t), np.cos(t)]),
        lambda t: np.column_stack([np.sin(t), np.cos(t)]) if np.ndim(t) else [sin(t), cos(t)],
    ):
        samples = of_function(function, problem)
        np.testing.assert_allclose(samples.x, np.sin(samples.t), rtol=0, atol=1e-15)
        np.testing.assert_allclose(samples.v, np.cos(samples.t), rtol=0, atol=1e-15)
        assert (samples.t[0], samples.t[-1]) == (float(FIG9.t0), float(FIG9.t_end))
    long = of_function(lambda t: (t, t), SolverTask(FIG9.parameters, 0.0, 1e9))
    assert len(long.t) == MOST_TIMES + 1


def test_a_function_may_be_given_with_times() -> None:
    motion, t = simulate("fig9", t_end=3), np.linspace(0.2, 3, 50)
    for first in ("fig9", FIG9.parameters):
        check = crosscheck(first, t, lambda time: motion(time))
        assert check.ok
        assert check.t.tolist() == t.tolist()
    assert crosscheck("fig9", simulate("fig9")).ok
    assert len(crosscheck("fig9", simulate("fig9")).matched) == len(simulate("fig9").events)


def test_what_is_no_solution_of_a_function() -> None:
    with pytest.raises(ParameterError, match=r"needs times: give crosscheck\(parameters, t, function\)"):
        crosscheck(FIG9.parameters, lambda t: (t, t))
    with pytest.raises(ParameterError, match="must return two numbers"):
        crosscheck("fig9", lambda t: t)
    for function, kind in ((lambda t: (t / 0, 1), ZeroDivisionError), (lambda: (0, 0), TypeError)):
        with pytest.raises(ParameterError, match=rf"fails at t = 0.1324: {kind.__name__}: ") as caught:
            crosscheck("fig9", function)
        assert isinstance(caught.value.__cause__, kind)  # an error of the function itself, with its place
    with pytest.raises(ParameterError, match=r"x\[0\] = nan"):
        crosscheck("fig9", lambda t: (np.nan, 1))


def test_only_events_at_a_belt_count_and_each_once() -> None:
    v1, v2 = float(FIG9.parameters.v1), float(FIG9.parameters.v2)
    result = SimpleNamespace(
        t_events=[np.array([1.0, 2.0]), np.array([1.0 + 1e-12, 3.0]), np.array([])],
        y_events=[np.array([[0, v1], [0, v2]]), np.array([[0, v1], [0, v2 + 1.0]]), np.array([])],
    )
    events, notes = solver_events(result, solver_task(FIG9))
    assert events == ((1.0, ""), (2.0, ""))
    assert notes[1] == "1 of the solver's t_events are not at a belt, and left out"
    assert solver_events(SimpleNamespace(t_events=None), solver_task(FIG9)) == (None, ())
    assert solver_events(result, None) == (None, ())


@pytest.mark.parametrize(
    ("t_events", "y_events", "words"),
    [
        ([["a"]], None, "must be lists of finite times"),
        ([[np.nan]], None, "must be lists of finite times"),
        (5, None, "must be lists of finite times"),
        ([[1.0, 2.0]], [[[0, 1]]], "must have x and v for each of t_events"),
        ([[1.0]], [[[None]]], "must have x and v for each of t_events"),
    ],
)
def test_events_of_a_solver_that_are_none(t_events: object, y_events: object, words: str) -> None:
    result = SimpleNamespace(t_events=t_events, y_events=y_events)
    with pytest.raises(ParameterError, match=words):
        solver_events(result, solver_task(FIG9))
