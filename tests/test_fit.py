"""Fits to made-up measurements: what was put in is found, within the errors that are said."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from click.testing import CliRunner

from symosc import Trajectory, fit, simulate
from symosc.cli.app import main


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
    found = fit(
        "fig5", measured(seed, 1e-3), ("mu1", "c"), sigma=1e-3, start={"mu1": "0.84", "c": "1.05"}
    )
    assert found.success, found.message
    for name, right in (("mu1", 0.8), ("c", 1.0)):
        assert abs(found.values[name] - right) < 4.5 * found.errors[name]
        assert found.errors[name] < 0.01
    assert np.sqrt(np.mean(found.residuals**2)) < 1.6
    assert isinstance(found.trajectory, Trajectory)
    assert found.covariance[0, 0] == pytest.approx(found.errors["mu1"] ** 2)


def test_errors_are_those_of_many_measurements() -> None:
    """The spread of the fitted values over many measurements is the error that each one says."""
    fits = [fit("fig5", measured(seed, 2e-3, t_end=20), "mu1", sigma=2e-3) for seed in range(25)]
    pulls = [(found.values["mu1"] - 0.8) / found.errors["mu1"] for found in fits]
    assert 0.6 < np.std(pulls) < 1.5


def test_samples() -> None:
    dice = np.random.default_rng(3)
    trajectory = simulate("fig5", t_end=20)
    t = np.linspace(0.1, 20, 150)
    x, v = trajectory(t)
    data: dict[str, Any] = {"t": t, "x": x + dice.normal(size=len(t)) * 1e-3}
    found = fit("fig5", data, ("mu1", "k", "x0"), sigma=1e-3, start={"mu1": 0.83, "k": 1.02})
    for name, right in (("mu1", 0.8), ("k", 1.0), ("x0", 0.0)):
        assert abs(found.values[name] - right) < 4.5 * found.errors[name]
    both = fit("fig5", data | {"v": v}, "mu1", sigma=[1e-3, 1e-2])
    assert len(both.residuals) == 2 * len(t)
    unknown = fit("fig5", data, "mu1")  # the error of the data is that of the residuals
    assert unknown.errors["mu1"] == pytest.approx(
        fit("fig5", data, "mu1", sigma=1e-3).errors["mu1"], rel=0.3
    )


def test_what_the_data_do_not_determine_is_said() -> None:
    """Times do not tell the unit of mass; one event does not tell two numbers."""
    found = fit("fig5", measured(1, 1e-3), ("m", "c", "k", "A0", "B0", "FN"), sigma=1e-3)
    assert not found.success
    assert "do not determine m, c, k, A0, B0, FN" in found.message
    assert all(math.isinf(error) for error in found.errors.values())
    assert not fit("fig5", measured(1, 1e-3)[:1], ("mu1", "c"), sigma=1e-3).success


def test_as_many_data_as_numbers_tell_no_errors() -> None:
    found = fit("fig5", [(1.221, "slip")], "mu1")
    assert found.errors == {"mu1": np.inf}
    assert "give sigma" in found.message
    given = fit("fig5", [(1.221, "slip")], "mu1", sigma=1e-3)
    assert given.errors["mu1"] < 1
    assert fit("fig5", [(1.221, "slip")], "mu1", sigma=[1e-3, 9]).errors == given.errors
    refused(lambda: fit("fig5", [(1, 2, 3, 4)], "mu1"), "data")


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
    bad = tmp_path / "bad.csv"
    bad.write_text("t,kind\n1\n")
    for arguments in (
        ["fit", "fig5", str(bad), "--free", "mu1"],
        ["fit", "fig5", "no.csv", "--free", "mu1"],
    ):
        assert run(main, arguments).exit_code == 2
