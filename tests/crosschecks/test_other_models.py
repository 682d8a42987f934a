"""Other models: the coefficient, the phase, the clock or the sign is found, with a number that its error covers."""

from __future__ import annotations

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import load_scene, simulate
from symosc.crosschecks import clues as fits
from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import fitted
from symosc.crosschecks.other_models import TICK, _tick, rounded, with_error
from symosc.model import PARAMETER_NAMES

T = np.linspace(0.5, 12, 240)


def diagnosed(name: str, **changes: float) -> tuple[Diagnosis, ...]:
    """Return what is said of the motion of other parameters."""
    scene = load_scene(name)
    p = scene.parameters.replace(**changes)
    x, v = simulate(p, t0=0.5, x0=scene.x0, v0=scene.v0, t_end=12)(T)
    first = crosscheck(scene.parameters, T, x, v).diagnosis[0]
    return first, *first.alternatives


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", PARAMETER_NAMES)
def test_a_wrong_coefficient_is_estimated(name: str) -> None:
    rng = np.random.default_rng([ord(letter) for letter in name])
    scene = "fig5" if name == "v1" else "fig10"  # where that belt is met
    right = float(getattr(load_scene(scene).parameters, name))
    value = round(right * (1.0 + float(rng.choice([-1, 1])) * rng.uniform(0.01, 0.1)), 6)
    found = [one for one in diagnosed(scene, **{name: value}) if one.subject == name]
    assert [one.cause for one in found] == ["coefficient"]
    assert found[0].share > 0.9
    assert found[0].value is not None
    assert found[0].error is not None
    assert found[0].value == pytest.approx(value, abs=max(6.0 * found[0].error, 1e-7 * abs(value)))
    assert found[0].error < 1e-3 * abs(value)


@pytest.mark.parametrize("name", ["A0", "x", "v"])
def test_a_wrong_sign(name: str) -> None:
    scene = load_scene("fig5")
    x, v = simulate(scene, t_end=12)(T)
    if name == "A0":
        p = scene.parameters
        x, v = simulate(p.replace(A0=-p.A0), t0=0.5, x0=1, v0=2, t_end=12)(T)
    signs = {"x": (-1, 1), "v": (1, -1)}.get(name, (1, 1))
    first = crosscheck(scene.parameters, T, signs[0] * x, signs[1] * v).diagnosis[0]
    assert (first.cause, first.subject) == ("sign", name)


def test_a_fast_clock_and_a_drive_ahead_are_told_apart_by_the_start() -> None:
    scene, shift = load_scene("fig9"), 0.03
    t0 = float(scene.t0)
    t = np.linspace(t0, 6, 150)
    motion = simulate(scene, t_end=6)
    clock = crosscheck(scene, t + shift, *motion(t)).diagnosis[0]
    assert clock.cause == "time shift"
    assert clock.value == pytest.approx(shift, abs=1e-8)
    Om = float(scene.parameters.Omega)
    ahead = simulate(scene.parameters, t0=t0 + shift, x0=scene.x0, v0=scene.v0, t_end=7)
    phase = crosscheck(scene, t, *ahead(t + shift)).diagnosis[0]
    assert phase.cause == "phase"
    assert phase.value == pytest.approx(Om * shift, abs=1e-7)
    sine = simulate(scene.parameters, t0=t0 - np.pi / 2 / Om, x0=scene.x0, v0=scene.v0, t_end=7)
    assert "sine in place of cosine" in crosscheck(scene, t, *sine(t - np.pi / 2 / Om)).diagnosis[0].words
    # Without a scene there is no start to tell by: both are named.
    both = crosscheck(scene.parameters, t + shift, *motion(t)).diagnosis[0]
    assert {both.cause, *(one.cause for one in both.alternatives)} >= {"time shift", "phase"}


def test_a_fit_is_not_led_astray_by_a_third_of_the_steps() -> None:
    rng = np.random.default_rng(4)
    slopes = rng.uniform(0.5, 2.0, (60, 2))
    target = slopes * 3.25 + rng.normal(size=(60, 2))
    target[::3] += rng.uniform(100, 1000, (20, 2))
    fit = fitted(lambda q: slopes * q[0] - target, np.array([0.0]), np.array([1e-3]))
    assert fit is not None
    assert fit.value[0] == pytest.approx(3.25, abs=5.0 * fit.error[0])
    assert 0.01 < fit.error[0] < 0.3
    assert fitted(lambda q: 0.0 * slopes, np.array([0.0]), np.array([1e-3])) is None


def test_numbers_have_the_digits_that_their_error_leaves() -> None:
    assert with_error(1.23456789, 1e-4) == "1.23457 ± 0.0001"
    assert rounded(1.23456789, 0.0) == "1.23456789"
    assert rounded(0.0, 1e-3) == "0"


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_small_changes_are_small_in_the_units_of_what_they_change(name: str) -> None:
    """Those of velocities by the belts' difference, wherever they stand; others by forces and the largest rate."""
    p = load_scene(name).parameters
    rate = max(float(p.Omega), float(p.k / p.m) ** 0.5, float(p.c / p.m))
    push = max(abs(float(p.A(domain))) for domain in (1, 2, 3)) + abs(float(p.B0))
    units = {"m": p.m, "Omega": p.Omega, "FN": p.FN, "c": float(p.m) * rate, "k": float(p.m) * rate**2}
    units |= {"A0": push, "B0": push, "mu1": 1, "mu2": 1, "v1": p.v2 - p.v1, "v2": p.v2 - p.v1}
    assert units.keys() == set(PARAMETER_NAMES)
    for each, unit in units.items():
        assert _tick(p, each) == pytest.approx(TICK * float(unit))
    moved = p.replace(v1=0, v2=p.v2 - p.v1)
    assert [_tick(moved, each) for each in ("v1", "v2")] == [_tick(p, each) for each in ("v1", "v2")]


def test_one_number_is_what_most_steps_ask_for_and_several_are_least_squares() -> None:
    rng = np.random.default_rng(6)
    J, wanted = rng.uniform(0.5, 2, (21, 2, 1)), np.append(np.full(12, 0.25), rng.uniform(-9, 9, 9))
    change, error = fits._median_change(-J[..., 0] * wanted[:, None], J)
    assert change == pytest.approx([0.25])
    assert error == pytest.approx([1 / np.sqrt(np.sum(J**2))])
    J[0] = 0.0  # a step that shows nothing
    assert fits._median_change(-J[..., 0] * wanted[:, None], J)[0] == pytest.approx([0.25])
    assert fits._median_change(np.ones((3, 2)), np.zeros((3, 2, 1))) is None
    J, right = rng.uniform(-1, 1, (21, 2, 3)) * [1.0, 1e-6, 1e6], np.array([0.5, 2e5, -3e-7])
    change, error = fits._median_change(-J @ right, J)
    assert change == pytest.approx(right)
    matrix = J.reshape(-1, 3)
    assert error == pytest.approx(np.sqrt(np.diag(np.linalg.inv(matrix.T @ matrix))), rel=1e-6)
    assert fits._least_squares(np.ones((4, 2)), np.ones((4, 2, 2))) is None  # two numbers that do the same
    assert fits._least_squares(np.ones((0, 2)), np.ones((0, 2, 2))) is None
