"""Friction at the belts: the width of a smooth curve and the rate of a drift are estimated."""

from __future__ import annotations

import numpy as np
import pytest
from excerpts import crosscheck
from faulty_solver import Flaw, Solver, smoothed

from symosc import load_scene
from symosc.crosschecks.friction_clues import CURVES

NAMES = {"tanh": "tanh", "arctan": "arctan", "root": "z/sqrt(1 + z^2)"}


@pytest.mark.slow
@pytest.mark.full(3)
@pytest.mark.parametrize("curve", NAMES)
@pytest.mark.parametrize("width", [0.01, 0.1])
def test_smoothed_friction_is_measured(curve: str, width: float) -> None:
    p = load_scene("fig5").parameters
    t, x, v = smoothed(p, np.linspace(0, 20, 400), 0.0, 0.0, width, curve)
    first = crosscheck(p, t, x, v).diagnosis[0]
    assert (first.cause, first.subject) == ("smoothed friction", NAMES[curve])
    assert first.value == pytest.approx(width, rel=0.05)


@pytest.mark.slow
@pytest.mark.full(1)
@pytest.mark.parametrize("curve", NAMES)
def test_smoothed_friction_shows_where_nothing_sticks(curve: str) -> None:
    scene = load_scene("fig9")
    t, x, v = smoothed(scene.parameters, np.linspace(0.1324, 8, 300), float(scene.x0), 1.0, 0.02, curve)
    first = crosscheck(scene, t, x, v).diagnosis[0]
    assert first.cause == "smoothed friction"
    assert first.value == pytest.approx(0.02, rel=0.3)


@pytest.mark.parametrize("rate", [pytest.param(1e-4, marks=pytest.mark.slow), -2e-3])
def test_a_drift_is_measured(rate: float) -> None:
    scene = load_scene("fig10")
    run = Solver(scene.parameters, Flaw(drift=rate)).run(np.linspace(0.4588, 20, 1601), 3.0837, 1.0)
    t, x, v = (column[::4] for column in run.arrays())
    first = crosscheck(scene, t, x, v).diagnosis[0]
    assert first.cause == "drift"
    assert first.value == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize("name", CURVES)
def test_the_integral_of_a_curve_belongs_to_its_inverse(name: str) -> None:
    """Its slope is the curve less the sign, here by differences."""
    inverse, integral = CURVES[name]
    u = np.linspace(-0.9, 0.9, 18)
    z, step = inverse(u), 1e-6
    slope = (integral(z + step) - integral(z - step)) / (2 * step)
    assert slope == pytest.approx(u - np.sign(u), abs=1e-8)
