"""Fits to made-up measurements: what was put in is found, within the errors that are said."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from click.testing import CliRunner
from fit_sets import SIGMA, fit_set, pulls, sampled

from symosc import (
    Belt,
    Oscillator,
    ParameterError,
    Parameters,
    Scene,
    Trajectory,
    fit,
    load_scene,
    sensitivities,
    simulate,
)
from symosc.analysis.fitting import best
from symosc.cli.app import main
from symosc.scenes import as_toml


def measured(
    seed: int, sigma: float, kept: float = 0.8, t_end: float = 60
) -> list[tuple[float, str]]:
    dice = np.random.default_rng(seed)
    trajectory = simulate("fig5", t_end=t_end)
    return [
        (event.t + dice.normal() * sigma, event.kind)
        for event in trajectory.events
        if dice.random() < kept
    ]


@pytest.mark.parametrize("seed", range(4))
def test_noisy_events_some_of_them_missing(seed: int) -> None:
    fitted = fit(
        "fig5", measured(seed, 1e-3), ("mu1", "c"), sigma=1e-3, start={"mu1": "0.84", "c": "1.05"}
    )
    assert fitted.success, fitted.message
    for name, right in (("mu1", 0.8), ("c", 1.0)):
        assert abs(fitted.values[name] - right) < 4.5 * fitted.errors[name]
        assert fitted.errors[name] < 0.01
    assert np.sqrt(np.mean(fitted.residuals**2)) < 1.6
    assert isinstance(fitted.trajectory, Trajectory)
    assert fitted.covariance[0, 0] == pytest.approx(fitted.errors["mu1"] ** 2)


def test_errors_are_those_of_many_measurements() -> None:
    """The spread of the fitted values over many measurements is the error that each one says."""
    fits = [fit("fig5", measured(seed, 2e-3, t_end=20), "mu1", sigma=2e-3) for seed in range(25)]
    pulls = [(result.values["mu1"] - 0.8) / result.errors["mu1"] for result in fits]
    assert 0.6 < np.std(pulls) < 1.5


def test_samples() -> None:
    dice = np.random.default_rng(3)
    trajectory = simulate("fig5", t_end=20)
    t = np.linspace(0.1, 20, 150)
    x, v = trajectory(t)
    data: dict[str, Any] = {"t": t, "x": x + dice.normal(size=len(t)) * 1e-3}
    fitted = fit("fig5", data, ("mu1", "k", "x0"), sigma=1e-3, start={"mu1": 0.83, "k": 1.02})
    for name, right in (("mu1", 0.8), ("k", 1.0), ("x0", 0.0)):
        assert abs(fitted.values[name] - right) < 4.5 * fitted.errors[name]
    both = fit("fig5", data | {"v": v}, "mu1", sigma=[1e-3, 1e-2])
    assert len(both.residuals) == 2 * len(t)
    unknown = fit("fig5", data, "mu1")  # the error of the data is that of the residuals
    assert unknown.errors["mu1"] == pytest.approx(
        fit("fig5", data, "mu1", sigma=1e-3).errors["mu1"], rel=0.3
    )


def test_what_the_data_do_not_determine_is_said() -> None:
    """Times do not tell the unit of mass; one event does not tell two numbers."""
    fitted = fit("fig5", measured(1, 1e-3), ("m", "c", "k", "A0", "B0", "FN"), sigma=1e-3)
    assert not fitted.success
    assert "do not determine m, c, k, A0, B0, FN" in fitted.message
    assert all(math.isinf(error) for error in fitted.errors.values())
    assert not fit("fig5", measured(1, 1e-3)[:1], ("mu1", "c"), sigma=1e-3).success


def test_as_many_data_as_numbers_tell_no_errors() -> None:
    fitted = fit("fig5", [(1.221, "slip")], "mu1")
    assert fitted.errors == {"mu1": np.inf}
    assert "give sigma" in fitted.message
    arguments = fit("fig5", [(1.221, "slip")], "mu1", sigma=1e-3)
    assert arguments.errors["mu1"] < 1
    assert fit("fig5", [(1.221, "slip")], "mu1", sigma=[1e-3, 9]).errors == arguments.errors
    refused(lambda: fit("fig5", [(1, 2, 3, 4)], "mu1"), "data")


# -- the right minimum, or none ------------------------------------------------------------------

#: The scene of a fit that was a success 955 sigma off.
HARD = Scene(
    "hard",
    Parameters(
        m="39/50",
        c="163/100",
        k="181/25",
        A0="-527/100",
        B0="453/50",
        Omega="11/25",
        mu1="39/100",
        mu2="4/25",
        FN="221/100",
        v1="-571/100",
        v2="-33/100",
    ),
    Fraction("1.63"),
    Fraction("-2.01"),
    Fraction("5.74"),
    Fraction("44.4481"),
)


def test_a_start_in_the_reach_of_another_minimum() -> None:
    """The minimum at k = 8.4 is wrong, where events of the motion come in another order."""
    data = [(event.t, event.kind) for event in simulate(HARD).events]
    fitted = fit(HARD, data, "k", sigma=0.002, start={"k": 9.412})
    assert fitted.success, fitted.message
    assert abs(fitted.values["k"] - 7.24) < fitted.errors["k"]
    again = fit(HARD, data, "k", sigma=0.002, start={"k": 9.412})
    assert again.values == fitted.values
    assert again.message == fitted.message


@pytest.mark.parametrize("seed", [42, 50])
def test_many_starts_are_needed(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A fit from the first values alone, robust or not, ends in a minimum that is not the lowest."""
    made = fit_set(seed, 0.3)
    data = made.noisy(np.random.default_rng(seed))
    fitted = fit(made.scene, data, made.free, sigma=SIGMA, start=made.start)
    assert fitted.success, fitted.message
    assert made.is_right(fitted)
    monkeypatch.setattr(best, "candidates", lambda problem, first: iter(()))
    for robust in (False, True):
        alone = fit(made.scene, data, made.free, sigma=SIGMA, start=made.start, robust=robust)
        assert not alone.success
        assert not made.is_right(alone)


@pytest.mark.slow
@pytest.mark.parametrize("robust", [False, True])
def test_a_minimum_without_outliers_is_looked_for(robust: bool) -> None:
    """A wrong minimum describes all but three events in a row; the right one describes these too."""
    made = fit_set(1140, 0.05)
    data = made.noisy(np.random.default_rng(140))
    fitted = fit(made.scene, data, made.free, start=made.start, robust=robust)
    assert fitted.success
    assert not fitted.outliers
    assert made.is_right(fitted)


@pytest.mark.parametrize(
    "count",
    [
        3,
        pytest.param(12, marks=pytest.mark.slow),
        pytest.param(60, marks=pytest.mark.campaign),
    ],
)
def test_a_family_of_fits(count: int) -> None:
    """Every success is at the truth; nearly all starts within 30 % lead there."""
    for off, with_sigma in ((0.3, True), (0.05, True), (0.3, False)):
        succeeded = 0
        for seed in range(count):
            made = fit_set(seed, off)
            data = made.noisy(np.random.default_rng(seed))
            sigma = SIGMA if with_sigma else None
            fitted = fit(made.scene, data, made.free, sigma=sigma, start=made.start)
            assert not fitted.success or made.is_right(fitted), (seed, fitted)
            assert fitted.success or "describes the data" in fitted.message
            succeeded += fitted.success
        assert succeeded >= 0.95 * count - 1


@pytest.mark.parametrize(
    "count",
    [
        2,
        pytest.param(10, marks=pytest.mark.slow),
        pytest.param(60, marks=pytest.mark.campaign),
    ],
)
def test_a_family_with_outliers(count: int) -> None:
    """An outlier is named; a robust fit is right in spite of it, any other is no success."""
    named = 0
    succeeded = 0
    for seed in range(count):
        made = fit_set(seed, 0.3)
        data, row = made.with_outlier(np.random.default_rng(seed))
        plain = fit(made.scene, data, made.free, sigma=SIGMA, start=made.start)
        assert not plain.success
        assert "outlier" in plain.message or "describes the data" in plain.message
        robust = fit(made.scene, data, made.free, sigma=SIGMA, start=made.start, robust=True)
        assert not robust.success or made.is_right(robust), (seed, robust)
        succeeded += robust.success
        for result in (plain, robust):
            named += [outlier.row for outlier in result.outliers] == [row]
            assert len(result.outliers) <= 1 + len(data) // 10
    assert succeeded >= 0.95 * count - 1
    assert named >= 2 * (0.9 * count - 1)


@pytest.mark.quick(2)
@pytest.mark.parametrize("sigma", [1e-3, None])
@pytest.mark.parametrize("form", ["events", "samples"])
def test_data_of_another_motion_are_not_described(sigma: float | None, form: str) -> None:
    """With a wrong normal force no k describes the events or the samples of fig5."""
    motion = simulate("fig5", t_end=20)
    t = np.linspace(0.1, 20, 80)
    data: Any = {"t": t, "x": motion(t)[0]}
    if form == "events":
        data = [(event.t, event.kind) for event in motion.events]
    wrong = load_scene("fig5").parameters.replace(FN=9)
    scene = replace(load_scene("fig5"), parameters=wrong, t_end=Fraction(20))
    fitted = fit(scene, data, "k", sigma=sigma, start={"k": 1.1})
    assert not fitted.success
    assert "no motion describes the data, from many starts: " in fitted.message
    assert "farthest off are " in fitted.message
    assert ("chi² is " in fitted.message) == (sigma is not None)


def test_sigma_below_the_rounding_is_said() -> None:
    scene, data = sampled(0, 4, 0.0)
    fitted = fit(scene, data, ("mu1", "c"), sigma=1e-7)
    assert not fitted.success
    assert "sigma is smaller than the errors of rounding (x to 4 decimals" in fitted.message
    assert fit(scene, data, ("mu1", "c"), sigma=1e-4 / math.sqrt(12)).success


def test_an_outlier_among_samples_without_sigma() -> None:
    scene, data = sampled(1, None, 1e-3)
    data["x"][70] += 0.05
    plain = fit(scene, data, "mu1")
    assert not plain.success
    assert [(outlier.row, outlier.what) for outlier in plain.outliers] == [(70, "x")]
    assert "robust=True" in plain.message
    robust = fit(scene, data, "mu1", robust=True)
    assert robust.success
    assert robust.outliers[0].row == 70
    assert abs(pulls(scene, robust)[0]) < 4


def test_random_errors_are_no_misfit() -> None:
    """Without sigma no normal errors of few or many data count as outliers or structure."""
    names = ("mu1", "c")
    for seed in range(0, 12, 2):
        scene, data = sampled(seed, None, 1e-3, "x", 8 + 10 * seed)
        fitted = fit(scene, data, names)
        assert fitted.success, fitted.message
        events = measured(seed, 1e-3, t_end=12 + 4 * seed)
        assert fit("fig5", events, names).success


# -- errors --------------------------------------------------------------------------------------

#: Decimals, noise, columns and sigma of samples; the rounding errors of a stick repeat.
SAMPLES = {
    "5 decimals": (5, 0.0, "xv", None),
    "5 decimals of x": (5, 0.0, "x", None),
    "6 decimals, sigma known": (6, 0.0, "xv", 1e-6 / math.sqrt(12)),
    "8 decimals": (8, 0.0, "xv", None),
    "noise and 3 decimals": (3, 3e-4, "xv", None),
    "noise, sigma known": (None, 1e-3, "xv", 1e-3),
    "noise": (None, 1e-3, "xv", None),
}


def covers(sizes: np.ndarray) -> None:
    """Assert that errors of one number cover 68 % and 95 %, within three counting errors."""
    count = len(sizes)
    for most, part in ((1.0, 0.6827), (2.0, 0.9545)):
        allowed = 3.0 * math.sqrt(part * (1.0 - part) / count)
        assert abs(np.mean(np.abs(sizes) <= most) - part) <= allowed, (most, sizes)


@pytest.mark.parametrize("kind", SAMPLES)
@pytest.mark.parametrize(
    "count",
    [
        pytest.param(15, marks=pytest.mark.slow),
        pytest.param(300, marks=pytest.mark.campaign),
    ],
)
def test_errors_of_samples(kind: str, count: int) -> None:
    decimals, noise, columns, sigma = SAMPLES[kind]
    results = []
    for seed in range(count):
        scene, data = sampled(seed, decimals, noise, columns)
        results.append(pulls(scene, fit(scene, data, ("mu1", "c"), sigma=sigma)))
    for column in np.transpose(results):  # numbers of one fit are correlated: each counts alone
        covers(column)
        assert abs(np.sqrt(np.mean(column**2)) - 1.0) <= 3.0 / math.sqrt(2.0 * count)


@pytest.mark.parametrize("sigma", [SIGMA, None])
@pytest.mark.parametrize("robust", [False, True])
@pytest.mark.parametrize(
    "count",
    [
        pytest.param(15, marks=pytest.mark.slow),
        pytest.param(300, marks=pytest.mark.campaign),
    ],
)
def test_errors_of_events(sigma: float | None, robust: bool, count: int) -> None:
    results = []
    for seed in range(count):
        made = fit_set(1000 + seed, 0.05)
        data = made.noisy(np.random.default_rng(seed))
        result = fit(made.scene, data, made.free, sigma=sigma, start=made.start, robust=robust)
        results.append(pulls(made.scene, result)[0])
    covers(np.array(results))


def linear_theory(slopes: np.ndarray, noise: np.ndarray, sigma: float) -> tuple[Any, Any]:
    """Return how far small errors of data move a fit, in its standard errors, and these."""
    inverse = np.linalg.inv(slopes.T @ slopes)
    errors = sigma * np.sqrt(np.diag(inverse))
    return inverse @ slopes.T @ noise / errors, errors


@pytest.mark.parametrize("seed", range(3))
def test_samples_and_linear_theory(seed: int) -> None:
    names = ("mu1", "c")
    scene, data = sampled(seed, None, 1e-3)
    noise = np.concatenate([data["x"], data["v"]]) - np.ravel(simulate(scene)(data["t"]))
    slopes = sensitivities(scene, names)(data["t"]).reshape(-1, 2)
    moves, errors = linear_theory(slopes, noise, 1e-3)
    fitted = fit(scene, data, names, sigma=1e-3)
    assert list(fitted.errors.values()) == pytest.approx(errors, rel=1e-3)
    assert pulls(scene, fitted) == pytest.approx(moves, abs=1e-3)


@pytest.mark.parametrize("count", [5, pytest.param(300, marks=pytest.mark.campaign)])
def test_events_and_linear_theory(count: int) -> None:
    """The moves of linear theory have a variance of 1, and those of the fits are the same.

    So coverage needs no counting: the motions are bent little over a few errors.
    """
    bent = []
    for seed in range(count):
        made = fit_set(1000 + seed, 0.05)
        data = made.noisy(np.random.default_rng(seed))
        noise = np.array([t for t, _ in data]) - np.array([t for t, _ in made.events])
        moves, errors = linear_theory(made.slopes, noise, SIGMA)
        fitted = fit(made.scene, data, made.free, sigma=SIGMA, start=made.start)
        assert list(fitted.errors.values()) == pytest.approx(errors, rel=0.1)
        bent += (np.array(pulls(made.scene, fitted)) - moves).tolist()
    assert np.sqrt(np.mean(np.square(bent))) < 0.02


def test_rounding_errors_repeat_in_a_stick() -> None:
    """Errors of samples rounded to 5 decimals are larger than the square root of n says."""
    scene, data = sampled(2, 5, 0.0, "x", 600)
    fitted = fit(scene, data, "mu1")
    slopes = sensitivities(scene, "mu1")(data["t"])[0, :, 0]
    independent = 1e-5 / math.sqrt(12) / math.sqrt(float(slopes @ slopes))
    assert fitted.errors["mu1"] > 2 * independent
    assert abs(pulls(scene, fitted)[0]) < 4


# -- names of columns, files ---------------------------------------------------------------------


def test_columns_are_known_as_in_checks(tmp_path: Path) -> None:
    motion = simulate("fig5", t_end=12)
    t = np.linspace(0.1, 12, 40)
    x, v = motion(t)
    right = fit("fig5", {"t": t, "x": x, "v": v}, "mu1", sigma=1e-3)
    file = tmp_path / "samples.csv"
    np.savetxt(file, np.array([t, x, v]).T, header="Time (s);pos;vel", delimiter=";", comments="")
    np.savez(tmp_path / "samples.npz", clock=t, u=x)
    rows = list(zip(t, x, v, strict=True))
    for data in ({"time": t, "pos": x, "vel": v}, file, str(file), motion, rows):
        fitted = fit("fig5", data, "mu1", sigma=1e-3)
        assert fitted.success
        assert fitted.values["mu1"] == pytest.approx(right.values["mu1"])
        assert len(fitted.residuals) == 80 or data is motion
    named = {"t": "clock", "x": "u"}
    for data in ({"clock": t, "u": x}, tmp_path / "samples.npz"):
        assert len(fit("fig5", data, "mu1", sigma=1e-3, columns=named).residuals) == 40
    events = {"time": [1.22098, 8.28934], "event": ["slip", "slip"], "x": [1.16, -6.48]}
    assert len(fit("fig5", events, "mu1", sigma=1e-3).residuals) == 2
    events = {"when": [1.22098, 8.28934], "what": ["slip", "slip"]}
    columns = {"t": "when", "kind": "what"}
    assert fit("fig5", events, "mu1", sigma=1e-3, columns=columns).success
    refused(lambda: fit("fig5", {"o'clock": t, "u": x}, "mu1"), "column")
    refused(lambda: fit("fig5", {"t": t, "u": x}, "mu1", columns={"x": "w"}), "column")
    refused(lambda: fit("fig5", events, "mu1", columns={"t": "when", "kind": "why"}), "column")
    refused(lambda: fit("fig5", tmp_path / "no.csv", "mu1"), "file")


def test_columns_of_different_lengths_are_named_with_their_lengths() -> None:
    message = refused(lambda: fit("fig5", {"t": [1.0, 2.0], "x": [1.0]}, "mu1"), "data")
    assert "t of length 2, x of length 1" in message


def test_the_command(tmp_path: Path) -> None:
    file = tmp_path / "stops.csv"
    run = CliRunner().invoke
    file.write_text("t,kind\n" + "\n".join(f"{t},{kind}" for t, kind in measured(2, 1e-3)))
    said = run(
        main, ["fit", "fig5", str(file), "--free", "mu1", "--sigma", "1e-3", "--start", "mu1=0.75"]
    )
    assert said.exit_code == 0
    assert said.output.splitlines()[-1].startswith("converged")
    as_json = run(main, ["fit", "fig5", str(file), "--free", "mu1", "--json"])
    assert '"success": true' in as_json.output
    lines = file.read_text().replace("t,kind", "clock,kind").splitlines()
    t, _, kind = lines[3].partition(",")
    lines[3] = f"{float(t) + 0.2},{kind}"
    file.write_text("\n".join(lines))
    how = ["--sigma", "1e-3", "--columns", "t=clock"]
    plain = run(main, ["fit", "fig5", str(file), "--free", "mu1", *how])
    assert plain.exit_code == 1
    assert "the data have 1 outlier, which a fit with robust=True leaves out" in plain.output
    robust = run(main, ["fit", "fig5", str(file), "--free", "mu1", *how, "--robust", "--json"])
    assert robust.exit_code == 0
    assert '"row": 2' in robust.output
    bad = tmp_path / "bad.csv"
    bad.write_text("t,kind\n1\n")
    for arguments in (
        ["fit", "fig5", str(bad), "--free", "mu1"],
        ["fit", "fig5", "no.csv", "--free", "mu1"],
    ):
        assert run(main, arguments).exit_code == 2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,kind\n0.1,stick\n1.2,jump\n4.7,stick", r"kind\[1\] = 'jump': must be .* \(line 3\)"),
        ("t,kind\nabc,stick", r"t\[0\] = 'abc': is not a number \(line 2\)"),
        ("t,x\nabc,def", r"t\[0\] = 'abc': is not a number \(line 2\)"),
        ("t,kind\n0.1,stick\n1.2\n4.7,stick", "row 3 has 1 entry, and the others have 2"),
        ("t,kind\n0.1,stick\n1.2,\n4.7,stick", r"kind\[1\] = '': must be .* \(line 3\)"),
        ("t,x\n0,0\n0.1,abc", r"x\[1\] = 'abc': is not a number \(line 3\)"),
        ("t,kind\n", "no rows"),
    ],
)
def test_what_is_damaged_in_a_file_is_said_with_its_line(
    text: str, message: str, tmp_path: Path
) -> None:
    file = tmp_path / "run.csv"
    file.write_text(text)
    with pytest.raises(ParameterError, match=message):
        fit("fig5", file, "mu1")


# -- any friction law ----------------------------------------------------------------------------

DRIVEN: dict[str, Any] = {"m": 1, "c": "1/20", "k": 1, "B0": "3/10", "Omega": "7/10"}
STATIC = Oscillator(**DRIVEN, belts=[Belt("1/5", "1/2", mu_s="4/5"), Belt("3/2", "1/10")])
STRIBECK = Oscillator(
    **DRIVEN,
    belts=[Belt("1/2", curve=[(0, "1/2"), ("1/2", "3/10"), ("3/2", "1/5")], mu_s="3/5")],
)
RECOVERED = {
    "static": (STATIC, {"mu_s1": 0.75, "mu1": 0.53, "v1": 0.21}),
    "a curve": (STRIBECK, {"mu1_1": 0.33, "w1_1": 0.47}),
    "points in order": (STRIBECK, {"w1_1": 0.6, "w1_2": 1.3, "mu_s1": 0.63}),
}


@pytest.mark.parametrize("form", ["events", "samples"])
@pytest.mark.parametrize("law", RECOVERED)
def test_numbers_of_other_laws_are_recovered(law: str, form: str) -> None:
    """Within the errors, and with as large a sum of squares as its distribution says."""
    model, first = RECOVERED[law]
    scene = Scene("made", model, 0, 1, 0, 60)
    motion = simulate(scene)
    truth = {name: float(model.numbers()[name]) for name in first}
    times = np.linspace(0.1, 60, 120)
    pulls = []
    squares = 0.0
    free = 0
    for seed in range(4):
        dice = np.random.default_rng(seed)
        data: Any = [(event.t + 1e-3 * dice.normal(), event.kind) for event in motion.events]
        if form == "samples":
            x, v = motion(times)
            data = {
                "t": times,
                "x": x + 1e-3 * dice.normal(size=len(times)),
                "v": v + 1e-2 * dice.normal(size=len(times)),
            }
        found = fit(scene, data, tuple(first), sigma=(1e-3, 1e-2), start=first)
        assert found.success, found.message
        pulls += [(found.values[name] - truth[name]) / found.errors[name] for name in first]
        squares += float(found.residuals @ found.residuals)
        free += len(found.residuals) - len(first)
    assert max(map(abs, pulls)) < 4
    assert abs(squares - free) < 4 * math.sqrt(2 * free)


def test_errors_of_other_laws_are_those_of_linear_theory() -> None:
    names = ("mu_s1", "w1_1", "mu1_1")
    scene = Scene("made", STRIBECK, 0, 1, 0, 60)
    times = np.linspace(0.1, 60, 80)
    dice = np.random.default_rng(5)
    noise = 1e-4 * dice.normal(size=len(times))
    step = Fraction(1, 10**6)
    numbers = STRIBECK.numbers()
    columns = []
    for name in names:  # differences of motions
        ends = [
            simulate(replace(scene, parameters=STRIBECK.replace(**{name: numbers[name] + by})))
            for by in (step, -step)
        ]
        columns.append((ends[0](times)[0] - ends[1](times)[0]) / (2 * float(step)))
    moves, errors = linear_theory(np.transpose(columns), noise, 1e-4)
    data = {"t": times, "x": simulate(scene)(times)[0] + noise}
    found = fit(scene, data, names, sigma=1e-4)
    assert list(found.errors.values()) == pytest.approx(errors, rel=1e-3)
    truth = np.array([float(numbers[name]) for name in names])
    pulls = (np.array(list(found.values.values())) - truth) / errors
    assert pulls == pytest.approx(moves, abs=0.02)


def test_numbers_stay_in_order() -> None:
    """Where the data want static friction below kinetic friction, they meet, from any start."""
    coulomb = Oscillator(**DRIVEN, belts=[Belt("1/5", "1/2"), Belt("3/2", "1/10")])
    scene = Scene("made", coulomb, 0, 1, 0, 60)
    below = [
        (event.t - 0.03 * (event.kind == "slip"), event.kind) for event in simulate(scene).events
    ]
    free = ("mu_s1", "mu1", "c")
    best = fit(scene, below, ("mu1", "c"), sigma=0.05)
    for first in (0.55, 0.6):
        found = fit(scene, below, free, sigma=0.05, start={"mu_s1": first})
        assert 0 <= found.values["mu_s1"] - found.values["mu1"] < 1e-5
        assert found.values["mu1"] == pytest.approx(best.values["mu1"], abs=1e-5)
        assert np.sum(found.residuals**2) == pytest.approx(np.sum(best.residuals**2), rel=1e-4)
    fixed = fit(scene, below, "mu_s1", sigma=0.05, start={"mu_s1": 0.6})
    assert 0.5 <= fixed.values["mu_s1"] < 0.501


def test_a_start_out_of_order_is_one_sentence() -> None:
    data = [(1.0, "slip"), (3.0, "stick")]
    for name, value, message in (
        ("mu_s1", 0.4, r"mu_s1.*must be at least mu = 0.5"),
        ("w1_1", 1.6, r"w1_2.*must be greater than 1.6"),
        ("mu1_1", -0.1, r"mu1_1.*must be >= 0"),
        ("slope1", -1, r"slope1.*must be >= 0"),
        ("w2_1", 1, r"free.*must be one of .*w1_1"),
    ):
        with pytest.raises(ParameterError, match=message) as refusal:
            fit(STRIBECK, data, name, start={name: value})
        assert "\n" not in str(refusal.value)
    coulomb = Oscillator(**DRIVEN, belts=[Belt("1/5", "1/2")])
    with pytest.raises(ParameterError, match=r"mu_s1.*is equal to mu1; begin above it with start="):
        fit(coulomb, data, "mu_s1")
    with pytest.raises(ParameterError, match=r"slope1.*does not depend on speed; begin with"):
        fit(coulomb, data, "slope1")


def test_the_command_fits_a_curve(tmp_path: Path) -> None:
    scene = Scene("made", STRIBECK, 0, 1, 0, 60)
    (tmp_path / "mine.toml").write_text(as_toml(scene) + "\n", encoding="utf-8")
    rows = [f"{event.t},{event.kind}" for event in simulate(scene).events]
    (tmp_path / "stops.csv").write_text("\n".join(["t,kind", *rows]))
    files = [str(tmp_path / name) for name in ("mine.toml", "stops.csv")]
    options = ["--free", "mu1_1,mu_s1", "--start", "mu1_1=0.33", "--sigma", "1e-3"]
    picture = ["--plot", str(tmp_path / "fit.png")]
    said = CliRunner().invoke(main, ["fit", *files, *options, *picture])
    assert said.exit_code == 0, said.output
    assert [line.split()[:2] for line in said.output.splitlines() if line.startswith("mu")] == [
        ["mu1_1", "0.3"],
        ["mu_s1", "0.6"],
    ]
    assert (tmp_path / "fit.png").stat().st_size > 1000
