"""What CONTRIBUTING says of a new scene, done to the letter in a copy, with a scene that is not from the paper."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from project_files import ROOT

pytestmark = pytest.mark.slow
#: Tests that CONTRIBUTING names, and those that look at all scenes.
ASKED = ["tests/test_readme.py", "tests/test_model.py", "tests/cli/test_scenes.py", "tests/scenes/test_reading.py"]
ASKED += ["tests/reference/test_sets.py", "tests/plot/test_explorer.py"]


def test_a_scene_is_added_as_contributing_says(tmp_path: Path) -> None:
    folders = ("symosc", "tests", "docs")
    for name in folders:
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    for path in ROOT.iterdir():
        if path.is_file() or path.name == ".ci":
            (shutil.copy if path.is_file() else shutil.copytree)(path, tmp_path / path.name)

    def run(*command: str) -> str:
        done = subprocess.run([sys.executable, "-m", *command], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
        return done.stdout

    scene = re.sub('source = ".*"', 'source = "My own work, 2026, Fig. 3"', run("symosc", "scenes", "fig9"))
    scene = scene.replace('name = "fig9"', 'name = "squeal"')
    (tmp_path / "symosc" / "scenes" / "squeal.toml").write_text(scene)
    guide = tmp_path / "docs" / "guide.md"
    rows = guide.read_text(encoding="utf-8").replace(
        "| `fig9-orbit`,", "| `squeal` | mine | it squeals |\n| `fig9-orbit`,"
    )
    guide.write_text(rows, encoding="utf-8")
    assert run("symosc", "simulate", "squeal", "--json") != ""
    listed = run("symosc", "scenes").splitlines()
    assert [line for line in listed if line.startswith("squeal ") and line.endswith("My own work, 2026, Fig. 3")]
    assert "WSEAS" in listed[-1]
    run("pytest", "-q", "-m", "not slow and not campaign", "-p", "no:cacheprovider", *ASKED)
