"""Events at the wrong time: not located, or not seen at all."""

from __future__ import annotations

import numpy as np
import pytest
from excerpts import crosscheck
from faulty_solver import Flaw, Solver

from symosc import load_scene


@pytest.mark.parametrize(
    ("name", "every"),
    [pytest.param("fig5", 1, marks=pytest.mark.slow), pytest.param("fig9", 1, marks=pytest.mark.slow), ("fig10", 2)],
)
def test_events_that_are_not_located(name: str, every: int) -> None:
    scene = load_scene(name)
    grid = np.linspace(float(scene.t0), 10, 400 * every + 1)
    run = Solver(scene.parameters, Flaw(late=True)).run(grid, float(scene.x0), float(scene.v0))
    t, x, v = (column[::every] for column in run.arrays())
    assert crosscheck(scene, t, x, v).diagnosis[0].cause == "late events"


def test_contacts_within_a_step_are_missed_double_roots() -> None:
    scene = load_scene("fig8")
    run = Solver(scene.parameters, Flaw()).run(np.linspace(2.5, 12, 60), float(scene.x0), float(scene.v0))
    check = crosscheck(scene, *run.arrays())
    assert not check.ok
    assert check.diagnosis[0].cause == "double root"
