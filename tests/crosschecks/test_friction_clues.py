"""Friction at the belts: the width of a smooth curve and the rate of a drift are estimated."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from faulty_solver import Flaw, Solver, smoothed

from symosc import crosscheck, load_scene
from symosc.crosschecks import friction_clues
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


@pytest.mark.parametrize("boundary", [1, 2])
def test_what_samples_do_beside_a_belt_is_told_apart(boundary: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: one smooth curve, one rate, to and fro, or none of these; the first that fits is named."""
    belts = [SimpleNamespace(v=-1.0), SimpleNamespace(v=2.0)]
    v = np.zeros(12)
    steps = SimpleNamespace(v=v, last=np.full(11, 3 + boundary), K=SimpleNamespace(belt1=belts[0], belt2=belts[1]))
    clues: Any = SimpleNamespace(steps=steps, wrong=np.ones(11, bool))
    there, aside = np.array([1, 2, 3, 4, 5, 8, 9]), np.array([1.0, 2.0, 3.0, 2.0, 4.0, 1.0, 2.0]) * 1e-3
    for spread, same, signs, cause in (
        (0.19, 0.0, 1.0, "smoothed friction"), (0.21, 0.09, 1.0, "drift"), (0.21, 0.11, 1.0, "drift"),
        (0.21, 0.11, (-1.0) ** np.arange(7), "chatter"), (0.21, 0.11, [1, 1, 1, 1, 1, -1, -1], "drift"),
        (0.21, 0.11, [1, 1, 1, -1, -1, -1, -1], "drift"), (0.21, 0.11, [1, -1, -1, -1, 1, 1, 1], "chatter"),
    ):  # fmt: skip
        v[there + 1] = belts[boundary - 1].v + aside * signs
        curves = [("tanh", 0.5, 0.01, spread), ("arctan", 0.7, 0.02, 0.5)]
        monkeypatch.setattr(friction_clues, "held_samples", lambda _: there)
        monkeypatch.setattr(friction_clues, "_smoothed_sticks", lambda *_, curves=curves: curves)
        monkeypatch.setattr(friction_clues, "_rates", lambda *_, same=same: (-0.25, same, 5))
        (one,) = friction_clues.at_belts(clues)
        assert one.cause == cause
        if cause == "smoothed friction":
            assert (one.subject, one.value, one.error, one.share) == ("tanh", 0.5, 0.01, 1.0)
        elif same < 0.1:
            assert (one.value, one.error, one.share) == (-0.25, pytest.approx(0.25 * same), 1.0)
        else:
            assert (one.value, one.error, one.share) == (pytest.approx(4e-3), None, 7 / 11)
            assert one.evidence.startswith("7 samples")
    monkeypatch.setattr(friction_clues, "held_samples", lambda _: there[:2])
    assert list(friction_clues.at_belts(clues)) == []
