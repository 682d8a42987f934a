"""Methods with a fixed step: which one it was, and with which step."""

from __future__ import annotations

import numpy as np
import pytest
from faulty_solver import Flaw, Solver, without_events

from symosc import crosscheck, load_scene

NAMES = {"euler": "Euler", "heun": "Heun", "rk4": "RK4"}


@pytest.mark.quick(1)
@pytest.mark.parametrize(("method", "count"), [("rk4", 1), ("euler", 1), ("heun", 4)])
def test_a_method_and_its_step_are_named(method: str, count: int) -> None:
    scene = load_scene("fig5")
    run = Solver(scene.parameters, Flaw(method=method)).run(np.linspace(0, 20, 150 * count + 1), 0.0, 0.0)
    t, x, v = (column[::count] for column in run.arrays())
    first = crosscheck(scene, t, x, v).diagnosis[0]
    assert (first.cause, first.subject) == ("truncation", NAMES[method])
    assert first.value == pytest.approx(20 / 150 / count)


@pytest.mark.slow
def test_a_method_that_goes_over_events_chatters() -> None:
    scene = load_scene("fig5")
    t, x, v = without_events(scene.parameters, np.linspace(0, 20, 1601), 0.0, 0.0)
    first = crosscheck(scene, t[::4], x[::4], v[::4]).diagnosis[0]
    assert (first.cause, first.subject) == ("chatter", "RK4")
    assert first.value == pytest.approx(0.0125)


@pytest.mark.parametrize("method", ["euler", "rk4"])
def test_a_method_whose_events_are_samples_does_not_go_over_them(method: str) -> None:
    """Steps end and begin at the events, with v at the belt's speed: these are located, however wrong the flights."""
    scene = load_scene("fig6")
    run = Solver(scene.parameters, Flaw(method=method), joints=True).run(np.linspace(0, 20, 61), 0.0, 5.0)
    assert len(run.events) == 3
    first = crosscheck(scene, *run.arrays()).diagnosis[0]
    assert (first.cause, first.subject) == ("truncation", NAMES[method])
