"""Ends of sticks: too early, too late, and the friction at which a late one is left."""

from __future__ import annotations

import numpy as np
import pytest
from excerpts import crosscheck
from faulty_solver import Flaw, Solver

from symosc import load_scene
from symosc.crosschecks.report import CrossCheck


def checked(flaw: Flaw, every: int, joints: bool = False) -> CrossCheck:
    scene = load_scene("fig10")
    run = Solver(scene.parameters, flaw, joints).run(np.linspace(0.4588, 9, 601), 3.0837, 1.0)
    t, x, v = (column[::every] for column in run.arrays())
    return crosscheck(scene, t, x, v)


@pytest.mark.quick(1)
@pytest.mark.parametrize("static", [1.05, 1.3])
def test_static_friction_is_measured(static: float) -> None:
    first = checked(Flaw(static=static), 4).diagnosis[0]
    assert first.cause == "stick left late"
    assert first.value == pytest.approx(static, abs=1e-6)
    assert first.error is not None
    assert first.error < 1e-6


@pytest.mark.slow
def test_static_friction_shows_where_the_samples_end_with_the_sticks() -> None:
    first = checked(Flaw(static=1.1), 1, joints=True).diagnosis[0]
    assert first.cause == "stick left late"
    assert first.value == pytest.approx(1.1, abs=0.01)


@pytest.mark.quick(1)
@pytest.mark.parametrize("early", [0.05, 0.25])
def test_sticks_that_are_left_too_early(early: float) -> None:
    assert checked(Flaw(early=early), 4).diagnosis[0].cause == "stick left early"
