"""Other models: the coefficient, the phase, the clock or the sign is found, with a number that its error covers."""

from __future__ import annotations

import numpy as np
import pytest

from symosc import crosscheck, load_scene, simulate
from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import fitted
from symosc.crosschecks.other_models import rounded, with_error
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
