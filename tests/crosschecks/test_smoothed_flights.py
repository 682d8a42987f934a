"""Friction that is smoothed widely: flights, not sticks, tell its width and its curve."""

from __future__ import annotations

import numpy as np
import pytest
from excerpts import crosscheck
from faulty_solver import smoothed

from symosc import load_scene, simulate
from symosc.crosschecks import smoothed_flights
from symosc.crosschecks.clues import Clues
from symosc.crosschecks.friction_clues import CURVES, SMOOTH_CURVES

NAMES = {"tanh": "tanh", "arctan": "arctan", "root": "z/sqrt(1 + z^2)"}


@pytest.mark.quick(2)
@pytest.mark.parametrize(("name", "samples", "part"), [("fig10", 300, 0.1), ("fig9", 60, 0.3), ("fig5", 150, 0.02)])
@pytest.mark.parametrize("curve", NAMES)
def test_wide_smoothing_is_measured(curve: str, name: str, samples: int, part: float) -> None:
    scene = load_scene(name)
    width, begin = part * float(scene.parameters.v2 - scene.parameters.v1), float(scene.t0)
    times = np.linspace(begin, begin + 8, samples)
    t, x, v = smoothed(scene.parameters, times, float(scene.x0), float(scene.v0), width, curve)
    first = crosscheck(scene, t, x, v).diagnosis[0]
    assert (first.cause, first.subject) == ("smoothed friction", NAMES[curve])
    assert first.value == pytest.approx(width, rel=1e-3)


@pytest.mark.parametrize(("change", "value"), [("c", "1.1"), ("mu1", "0.7")])
def test_other_coefficients_are_no_smoothing(change: str, value: str) -> None:
    p = load_scene("fig5").parameters
    t = np.linspace(0, 15, 200)
    check = crosscheck("fig5", t, *simulate(p.replace(**{change: value}), t0=0, x0=0, v0=0, t_end=15)(t))
    assert not list(smoothed_flights.smoothed_flights(Clues.of(check)))
    assert (check.diagnosis[0].cause, check.diagnosis[0].subject) == ("coefficient", change)


@pytest.mark.parametrize("name", SMOOTH_CURVES)
def test_the_curves_are_those_of_the_sticks(name: str) -> None:
    u = np.linspace(-0.9, 0.9, 19)
    assert SMOOTH_CURVES[name](CURVES[name][0](u)) == pytest.approx(u, abs=1e-14)
