"""The page on checking is a test: its commands and examples are run, and every format that is read stands in it."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from symosc import simulate
from symosc.crosschecks.files import PACKED, SUFFIXES

PAGE = (Path(__file__).parents[2] / "docs" / "checking.md").read_text(encoding="utf-8")
SOLVER, EXAMPLE = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
COMMANDS = re.findall(r"^\$ (.*)$", PAGE, re.MULTILINE)
# Those that find the solution wrong: its method steps over belts.
WRONG = ("--solver",)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    import pandas

    folder = tmp_path_factory.mktemp("checking")
    t = np.linspace(0.1324, 10, 500)
    x, v = simulate("fig9")(t)
    frame = pandas.DataFrame({"t": t, "x": x, "v": v})
    frame.to_csv(folder / "run.csv", index=False)
    frame.to_parquet(folder / "other.parquet")
    frame[["t", "x"]].to_csv(folder / "positions.csv", index=False)
    np.savetxt(folder / "run.txt", np.column_stack([t, x, 0 * t, v]), fmt="%.17g")
    (folder / "mysolver.py").write_text(SOLVER)
    program = folder / "bin" / "symosc"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m symosc "$@"\n')
    program.chmod(0o755)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_the_commands_run(command: str, folder: Path) -> None:
    environment = {**os.environ, "PATH": os.pathsep.join([str(folder / "bin"), os.environ["PATH"]])}
    result = subprocess.run(command, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (int(any(word in command for word in WRONG)), ""), result.stdout
    assert result.stdout.startswith(("ok", "{", "FAILED"))


@pytest.mark.slow
def test_the_example_prints_what_it_says(tmp_path: Path) -> None:
    (expected,) = re.findall(r"^```text\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    result = subprocess.run([sys.executable, "-c", EXAMPLE], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (result.stderr, result.stdout) == ("", expected)


def test_every_format_is_named() -> None:
    alike = {".out", ".asc", ".pq", ".arrow", ".hdf"}
    for suffix in {*SUFFIXES, *PACKED} - alike:
        assert f"`{suffix}`" in PAGE, suffix
