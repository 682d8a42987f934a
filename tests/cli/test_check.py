"""symosc check: exit codes, summary, JSON, figure and bad input."""

from __future__ import annotations

import json
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
    np.savetxt(path, np.column_stack([t, x, v]), fmt="%.17g", delimiter=",", header=head, comments="")
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
    assert "early end: the solution ends at t = 6; the motion of fig9 goes on to t = 10" in result.output
    assert run("fig9", short, "--partial").exit_code == 0
    assert run("fig9", short, "--t-end", "6").exit_code == 0
    other = write(tmp_path / "other.csv", t, *simulate("fig9", x0="4.6447", t_end=6)(t))
    result = run("fig9", other, "--partial")
    assert result.exit_code == 1
    assert "wrong start: the solution starts at t0 = 0.1324, x0 = 4.6447" in result.output
    assert run("fig9", other, "--partial", "--own-start").exit_code == 0


def test_a_right_solution_passes(tmp_path: Path, samples: Any) -> None:
    result = run(write(tmp_path / "run.csv", *samples), "--scene", "fig9", "--t-end", "6")
    assert result.exit_code == 0, result.output
    assert result.output.startswith("ok: 120 samples")
    assert "7 matched, 0 missed, 0 invented" in result.output


@pytest.mark.parametrize("name", ["weak-spring-k-0", "late-start-t0-1e8-fig9"])
def test_a_reference_case_is_taken_by_its_name(name: str, tmp_path: Path) -> None:
    (case,) = (each for each in reference_cases() if each.name == name)
    motion = simulate(case.scene)
    t = np.linspace(float(case.t0), float(case.t_end), 300)
    x, v = motion(t)
    assert run(write(tmp_path / "run.csv", t, x, v), "--case", name).exit_code == 0


@pytest.mark.slow
def test_a_wrong_one_fails_and_is_drawn(tmp_path: Path, samples: Any) -> None:
    t, x, v = samples
    v[60] += 0.5
    figure = tmp_path / "errors.pdf"
    words = (write(tmp_path / "run.csv", t, x, v), "--scene", "fig9", "-o", figure)
    result = run_part(*words)
    assert result.exit_code == 1
    assert result.output.startswith("FAILED")
    assert "first wrong step: 59" in result.output
    assert "a sample off by itself" in result.output
    assert figure.read_bytes().startswith(b"%PDF-")
    data = json.loads(run_part(*words, "--json").output)
    assert data["ok"] is False
    assert data["wrong_steps"] == [59, 60]
    assert data["first_wrong"]["reason"] == "outlier"
    assert data["max_defect_v"] == pytest.approx(0.5, rel=0.1)


@pytest.mark.slow
def test_a_scene_may_be_the_first_word_and_be_changed(tmp_path: Path, samples: Any) -> None:
    path = write(tmp_path / "run.csv", *samples)
    assert run_part("fig9", path).exit_code == 0
    assert run_part("fig9", path, "--set", "k=3").exit_code == 0  # as it is
    assert run_part("fig9", path, "--set", "k=3.1").exit_code == 1


def test_standard_input(samples: Any, tmp_path: Path) -> None:
    text = write(tmp_path / "run.csv", *samples).read_text()
    for words in (("fig9", "-"), ("-", "--scene", "fig9")):
        result = CliRunner().invoke(main, ["check", *words, "--partial"], input=text)
        assert result.exit_code == 0, result.output
    result = CliRunner().invoke(main, ["check", "fig9", "-"], input="")
    assert (result.exit_code, "is empty" in result.stderr) == (2, True)


@pytest.mark.slow
def test_several_files_and_a_column_of_ids(tmp_path: Path, samples: Any) -> None:
    t, x, v = samples
    good, bad = write(tmp_path / "good.csv", t, x, v), write(tmp_path / "bad.csv", t, x, v + 0.1 * (t > 3))
    result = run_part("fig9", good, bad)
    assert result.exit_code == 1
    assert result.stdout.startswith("FAILED: 2 solutions, 1 failed")
    assert f"\n{bad}: " in result.stdout
    data = json.loads(run_part("fig9", good, bad, "--json").stdout)
    assert [each["ok"] for each in data["checks"]] == [True, False]
    lines = [f"{name},{line}" for name in "ab" for line in good.read_text().splitlines()[1:]]
    (tmp_path / "both.csv").write_text("which,t,x,v\n" + "\n".join(lines))
    assert run_part("fig9", tmp_path / "both.csv", "--columns", "id=which").stdout.startswith("ok: 2 solutions")
    result = run("fig9", tmp_path / "both.csv", "--columns", "id=which", "-o", tmp_path / "both.svg")
    assert (result.exit_code, "shows one solution" in result.stderr) == (2, True)


@pytest.mark.slow
def test_a_solver_is_run(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "from symosc import simulate\n"
        "def solve(p, t0, x0, v0, t_end):\n"
        "    print('working')\n"
        "    return simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end)\n"
        "def wrong(p, *start):\n"
        "    return solve(p.replace(mu1=p.mu1 * 2), *start)\n"
    )
    words = ("fig9", "--t-end", "4", "--json", "--solver")
    result = run(*words, f"{tmp_path}/mine.py:solve")
    assert result.exit_code == 0
    assert json.loads(result.stdout)["compared_until"] == 4
    assert run(*words, f"{tmp_path}/mine.py:wrong").exit_code == 1
