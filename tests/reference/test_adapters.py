"""The examples in docs/adapters: each follows a few cases, and is scored."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from effort import PATIENCE

from symosc.reference.folder import read_set
from symosc.reference.results import read_results
from symosc.reference.score import Score, score

ADAPTERS = Path(__file__).parents[2] / "docs" / "adapters"
GOOD = {
    "paper-fig5",
    "paper-fig6",
    "graze-overdamped-P3",
    "rest-1",
    "free-decay-2",
    "continuum-1-2",
}


def judged(written: Path, command: list[str], tmp_path: Path) -> Score:
    """Run an adapter on the small set and judge its results, with a tolerance that a good solver
    keeps.
    """
    results = tmp_path / "theirs.csv"
    run = [*command, str(written / "cases.csv"), str(results)]
    done = subprocess.run(run, capture_output=True, text=True, timeout=PATIENCE, cwd=tmp_path)
    assert done.returncode == 0, done.stderr[-500:]
    _, cases = read_set(written)
    return score("theirs", cases, read_results(results, {case.name for case in cases}))


def assert_good(found: Score) -> None:
    assert {case.name for case in found.cases if case.right} == GOOD
    assert all(case.seconds is not None for case in found.cases)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("g++") is None, reason="no C++ compiler")
def test_the_program_in_cpp(written: Path, tmp_path: Path) -> None:
    program = tmp_path / "dopri"
    source = ADAPTERS / "dopri.cpp"
    flags = ["-O2", "-std=c++17", "-Wall", "-Wextra", "-Werror"]
    subprocess.run(["g++", *flags, "-o", str(program), str(source)], check=True, timeout=PATIENCE)
    assert_good(judged(written, [str(program)], tmp_path))
    wrong = subprocess.run(
        [str(program), "nothing", str(tmp_path / "out")], capture_output=True, text=True
    )
    assert wrong.returncode == 2
    assert len(wrong.stderr.splitlines()) == 1


@pytest.mark.slow
def test_the_one_with_scipy(written: Path, tmp_path: Path) -> None:
    assert_good(judged(written, [sys.executable, str(ADAPTERS / "with_scipy.py")], tmp_path))


def test_all_are_named_in_the_readme() -> None:
    text = (ADAPTERS / "README.md").read_text(encoding="utf-8")
    for path in ADAPTERS.iterdir():
        if path.suffix != ".md" and not path.name.startswith("__"):
            assert f"`{path.name}`" in text
