"""The page about sweeps: its commands run, with fewer values on their axes, and its pictures are there."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from cli_runs import good

pytest.importorskip("xarray")
DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "sweeps.md").read_text(encoding="utf-8")
COMMANDS = [
    command for block in re.findall(r"^```console\n\$ symosc (.*?)\n```$", PAGE, re.M | re.S) for command in [block]
]
EXAMPLES = re.findall(r"^```python\n(.*?)^```$\s*prints\s*^```text\n(.*?)^```$", PAGE, re.M | re.S)


def test_every_picture_is_made_by_a_command() -> None:
    pictures = re.findall(r"\]\((sweeps/[^)]+)\)", PAGE)
    assert {Path(name).name for name in pictures} <= {shlex.split(command)[-1] for command in COMMANDS}
    assert {path.name for path in (DOCS / "sweeps").iterdir()} == {Path(name).name for name in pictures}


@pytest.mark.quick(1)
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: shlex.split(command)[-1])
def test_the_commands_run(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    short = re.sub(r"(--over \w+=[^:]+:[^:]+):\d+", r"\1:3", command)
    assert short != command
    printed = good(*shlex.split(short))
    assert re.search(r" [39] motions", printed)
    assert {path.suffix for path in tmp_path.iterdir()} == ({".nc", ".png"} if "--plot" in command else set())


def test_every_example_says_what_it_prints() -> None:
    assert len(EXAMPLES) == PAGE.count("```python") > 0


@pytest.mark.slow
@pytest.mark.full(1)  # a cluster is in test_run.py too
@pytest.mark.parametrize("number", range(len(EXAMPLES)))
def test_example(number: int, tmp_path: Path) -> None:
    code, expected = EXAMPLES[number]
    if "distributed" in code:
        pytest.importorskip("distributed")
    calm = os.environ | {"DASK_LOGGING__DISTRIBUTED": "error"}  # on a slow machine it warns that a worker ends late
    result = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=calm, capture_output=True, text=True)
    assert (result.stderr, result.stdout) == ("", expected)
