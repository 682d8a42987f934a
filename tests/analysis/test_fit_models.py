"""Fits of other models in their own coordinates: base motion, pulled blocks, slopes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_runs import run
from other_models import Original, drawn

from symosc import Belt, OtherModel, ParameterError, Scene, fit, load_scene, simulate
from symosc.analysis.fitting.other_models import model_sensitivities
from symosc.reductions import numbers_of, with_numbers
from symosc.scenes import STARTS, as_toml

SIGMA = 1e-3
BASE = Scene(
    "base",
    OtherModel(
        m=1, c="1/5", k=2, Omega="3/2", FN="1/2", mu1="3/5", v1="1/4", Y=1, Y_phase="1/3"
    ),
    t0=1, x0="1/2", v0=0, t_end=30,
)  # fmt: skip
BLOCK = Scene(
    "block",
    OtherModel(
        m=1, k=2, c="1/10", Omega=1, FN=1, pull="1/10", belts=[Belt(0, "1/2", mu_s="4/5")]
    ),
    t0=0, x0=0, v0=0, t_end=60,
)  # fmt: skip
#: Its drive is -2 cos(Omega t) without a phase: the polar form jumps there.
NEGATIVE = OtherModel(
    m=1, k=1, c="1/10", Omega="6/5", FN="1/3", B0=-2, belts=[Belt("1/5", 1, mu_s="3/2")]
)


def truth(scene: Scene, names: tuple[str, ...]) -> np.ndarray:
    assert scene.original is not None
    numbers = numbers_of(scene.original.model)
    numbers |= {name: getattr(scene.original, name) for name in STARTS}
    return np.array([float(numbers[name]) for name in names])


def noisy(scene: Scene, form: str, seed: int) -> Any:
    """Return events or samples of a scene's motion, in its coordinates, with errors SIGMA."""
    dice = np.random.default_rng(seed)
    motion = simulate(scene)
    if form == "events":
        return [(event.t + SIGMA * dice.normal(), event.kind) for event in motion.events]
    times = np.linspace(float(motion.t_start) + 0.1, float(motion.t_end), 120)
    x, v = motion(times) + SIGMA * dice.normal(size=(2, 120))
    return {"t": times, "x": x, "v": v}


@pytest.mark.parametrize(
    "model",
    [drawn("all", 1), drawn("pulled and more", 0), drawn("incline", 0), NEGATIVE],
    ids=["all", "pulled and more", "incline", "negative"],
)
def test_derivatives_are_those_of_the_models_motion(model: OtherModel) -> None:
    start = {"t0": 0.3, "x0": 0.4, "v0": 0.35}
    names = (*numbers_of(model), *STARTS)
    times = np.linspace(0.5, 8.9, 61)
    moved = model_sensitivities(Scene("drawn", model, **start, t_end=9), names)
    count = len(moved.trajectory.events)
    assert count > 3
    step = 1e-6
    for n, name in enumerate(names):
        motions = []
        for change in (step, -step):
            if name in STARTS:
                other = simulate(model, **start | {name: start[name] + change}, t_end=9.5)
            else:
                value = float(numbers_of(model)[name]) + change
                other = simulate(with_numbers(model, {name: value}), **start, t_end=9.5)
            motions.append(other)
        above, below = motions
        states = (above(times) - below(times)) / (2 * step)
        assert moved(times)[..., n] == pytest.approx(states, rel=1e-7, abs=1e-7), name
        pairs = zip(above.events[:count], below.events[:count], strict=True)
        shifts = [float(one.t - other.t) / (2 * step) for one, other in pairs]
        assert moved.dt[:, n] == pytest.approx(shifts, rel=1e-7, abs=1e-7), name


@pytest.mark.parametrize("form", ["events", "samples"])
@pytest.mark.parametrize(
    ("scene", "start"),
    [
        (BASE, {"Y": 0.95, "c": 0.22, "mu1": 0.63}),
        (BASE, {"FN": 0.53, "Y_phase": 0.3, "x0": 0.51}),
        (BLOCK, {"pull": 0.104, "mu_s1": 0.78}),
    ],
    ids=["base", "phase and start", "block"],
)
def test_the_models_numbers_are_recovered(scene: Scene, start: dict[str, float], form: str) -> None:
    names = tuple(start)
    found = fit(scene, noisy(scene, form, 2), names, sigma=SIGMA, start=start)
    assert found.success, found.message
    off = np.array(list(found.values.values())) - truth(scene, names)
    assert np.all(abs(off) < 4 * np.array(list(found.errors.values()))), found
    right = simulate(scene)
    assert float(found.trajectory.t_start) == float(right.t_start)
    times = np.linspace(float(right.t_start), float(found.trajectory.t_end), 50)[:-1]
    assert np.abs(found.trajectory(times) - right(times))[0].max() < 0.02


def test_the_models_own_equation_is_fitted() -> None:
    """The data come from an integrator that knows the equation of the model, and no reduction."""
    assert BASE.original is not None
    _, state = Original(BASE.original.model).follow(1.0, 0.5, 0.0, 30.0)
    times = np.linspace(1.1, 29.9, 150)
    x, v = np.array([state(time) for time in times]).T
    names = ("Y", "c", "FN", "Y_phase", "x0")
    found = fit(BASE, {"t": times, "x": x, "v": v}, names, start={"Y": 0.97, "c": 0.21})
    assert found.success, found.message
    assert list(found.values.values()) == pytest.approx(truth(BASE, names), abs=1e-9)


def test_first_values_that_are_far_off_and_an_outlier() -> None:
    data = noisy(BASE, "events", 7)
    first = {"Omega": 1.6, "Y": 1.2}
    found = fit(BASE, data, ("Omega", "Y"), sigma=SIGMA, start=first)
    assert found.success, found.message
    assert abs(found.values["Omega"] - 1.5) < 4 * found.errors["Omega"]
    t, kind = data[4]
    data[4] = (t + 0.2, kind)
    found = fit(BASE, data, "Y", sigma=SIGMA, robust=True)
    assert [(outlier.row, outlier.what) for outlier in found.outliers] == [(4, kind)]


def test_errors_are_those_of_many_measurements_of_a_block() -> None:
    names = ("pull", "mu1")
    right = truth(BLOCK, names)
    fits = [fit(BLOCK, noisy(BLOCK, "events", seed), names, sigma=SIGMA) for seed in range(20)]
    pulls = np.array(
        [
            (np.array(list(found.values.values())) - right) / list(found.errors.values())
            for found in fits
        ]
    )
    assert np.all(np.abs(np.std(pulls, axis=0) - 1) < 0.4)


def test_a_model_that_is_symoscs_own_is_fitted_alike() -> None:
    numbers = load_scene("fig5").parameters.as_dict()
    data = [(event.t, event.kind) for event in simulate("fig5", t_end=20).events]
    names = ("mu1", "c")
    arguments: dict[str, Any] = {"sigma": SIGMA, "start": {"mu1": 0.75}}
    plain = fit(load_scene("fig5").parameters, data, names, **arguments)
    moved = fit(OtherModel(**numbers), data, names, **arguments)
    assert list(moved.values.values()) == pytest.approx(list(plain.values.values()), rel=1e-12)
    assert moved.covariance == pytest.approx(plain.covariance, rel=1e-9)


def test_what_cannot_be_fitted_is_refused() -> None:
    data = [(4.0, "slip"), (7.0, "stick")]
    for free in ("joined", "belts", "mu2", "v2", "Yphase"):
        with pytest.raises(ParameterError, match=r"free = .*must be one of m, k, Omega, FN, c"):
            fit(BASE, data, free)
    with pytest.raises(ParameterError, match=r"must be one of .*pull.*mu_s1, slope1, t0, x0, v0"):
        fit(BLOCK, data, "joined")
    weight = OtherModel(m=1, k=1, Omega=1, g=10, v1="1/5")
    with pytest.raises(ParameterError, match=r"free = 'FN': must be one of m, k, Omega, c"):
        fit(weight, data, "FN")
    with pytest.raises(ParameterError, match=r"slope1.*begin with start="):
        fit(BLOCK, data, "slope1")
    with pytest.raises(ParameterError, match="different names"):
        fit(BASE, data, ("Y", "Y"))
    with pytest.raises(ParameterError, match=r"Y = .*there is a drive.*vanishes"):
        fit(BLOCK, data, "Y")


def test_the_command_fits_a_file_of_a_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = as_toml(BASE).replace("Y = 1", 'Y = "100 cm"', 1)
    (tmp_path / "base.toml").write_text(lines, encoding="utf-8")
    rows = [f"{t!r},{kind}" for t, kind in noisy(BASE, "events", 2)]
    (tmp_path / "stops.csv").write_text("\n".join(["t,kind", *rows]), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    line = "fit base.toml stops.csv --free Y,c --sigma 1e-3 --start Y=0.96 --plot fit.svg"
    result = run(*line.split())
    assert result.exit_code == 0, result.output
    assert "converged" in result.output
    values = [float(row.split()[1]) for row in result.output.splitlines()[2:4]]
    assert values == pytest.approx([1, 0.2], abs=0.01)
