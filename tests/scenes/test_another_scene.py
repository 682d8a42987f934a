"""What CONTRIBUTING says of a new scene, done to the letter in a copy, with a scene that is not from the paper."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from scratch import Scratch


@pytest.mark.slow
def test_a_scene_is_added_as_contributing_says(tmp_path: Path) -> None:
    scratch = Scratch(tmp_path)
    scene = re.sub(
        'source = ".*"',
        'source = "My own work, 2026, Fig. 3"',
        scratch.run("symosc", "scenes", "fig9"),
    )
    scratch.write("symosc/scenes/squeal.toml", scene.replace('name = "fig9"', 'name = "squeal"'))
    scratch.replace(
        "docs/reference/answers.md",
        "| `fig9-orbit`,",
        "| `squeal` | mine | it squeals |\n| `fig9-orbit`,",
    )
    assert scratch.run("symosc", "simulate", "squeal", "--json") != ""
    listed = scratch.run("symosc", "scenes").splitlines()
    assert [
        line
        for line in listed
        if line.startswith("squeal ") and line.endswith("My own work, 2026, Fig. 3")
    ]
    assert "WSEAS" in listed[-1]
    # The tests that CONTRIBUTING names, and those that look at all scenes.
    scratch.pytest(
        "tests/test_readme.py", "tests/scenes/test_scene_files.py", only="scene and not random"
    )
    scratch.pytest("tests/reference/test_cases.py", only="set or version or page")
