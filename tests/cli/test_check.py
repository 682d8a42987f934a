"""symosc check: exit codes, summary, JSON, figure and bad input."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cli_runs
import numpy as np
import pytest
from click.testing import CliRunner, Result

from symosc import reference_cases, simulate
from symosc.cli.app import main


def run(*words: Any) -> Result:
    return cli_runs.run("check", *map(str, words))


def run_part(*words: Any) -> Result:
    """Check samples that end before the scene does."""
    return run(*words, "--partial")


def write(path: Path, t: Any, x: Any, v: Any, head: str = "t,x,v") -> Path:
    np.savetxt(
        path, np.column_stack([t, x, v]), fmt="%.17g", delimiter=",", header=head, comments=""
    )
    return path


@pytest.fixture
def samples() -> tuple[Any, Any, Any]:
    """To t = 6, where the scene goes on to 10."""
    t = np.linspace(0.1324, 6, 120)
    return (t, *simulate("fig9", t_end=6)(t))


def test_start_and_end_are_those_of_the_scene(tmp_path: Path, samples: Any) -> None:
    t, x, v = samples
    short = write(tmp_path / "short.csv", t, x, v)
    result = run("fig9", short)
    assert result.exit_code == 1
    assert (
        "early end: the solution ends at t = 6; the motion of fig9 goes on to t = 10"
        in result.output
    )
    assert run("fig9", short, "--partial").exit_code == 0
    assert run("fig9", short, "--t-end", "6").exit_code == 0
    other = write(tmp_path / "other.csv", t, *simulate("fig9", x0="4.6447", t_end=6)(t))
    result = run("fig9", other, "--partial")
    assert result.exit_code == 1
    assert "wrong start: the solution starts at t0 = 0.1324, x0 = 4.6447" in result.output
    assert run("fig9", other, "--partial", "--own-start").exit_code == 0


@pytest.mark.parametrize(
    "name", ["late-start-t0-1e8-fig9", pytest.param("weak-spring-k-0", marks=pytest.mark.slow)]
)
def test_a_reference_case_is_taken_by_its_name(name: str, tmp_path: Path) -> None:
    (case,) = (each for each in reference_cases() if each.name == name)
    motion = simulate(case.scene)
    t = np.linspace(float(case.t0), float(case.t_end), 300)
    x, v = motion(t)
    assert run(write(tmp_path / "run.csv", t, x, v), "--case", name).exit_code == 0


def test_standard_input(samples: Any, tmp_path: Path) -> None:
    text = write(tmp_path / "run.csv", *samples).read_text()
    for words in (("fig9", "-"), ("-", "--scene", "fig9")):
        result = CliRunner().invoke(main, ["check", *words, "--partial"], input=text)
        assert result.exit_code == 0, result.output
    result = CliRunner().invoke(main, ["check", "fig9", "-"], input="")
    assert (result.exit_code, "is empty" in result.stderr) == (2, True)
