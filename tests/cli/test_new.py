"""symosc new: a file to begin with, never over one that is there."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_runs import good, run

import symosc


def test_the_file_is_a_scene(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    assert "symosc simulate" in good("new", str(file), "--like", "fig9")
    scene, like = symosc.load_scene(file), symosc.load_scene("fig9")
    assert (scene.name, scene.parameters, scene.x0, scene.t_end) == ("mine", like.parameters, like.x0, like.t_end)
    assert "simulate" in file.read_text().splitlines()[0]
    assert good("new", "-").startswith("# A scene of symosc")


@pytest.mark.parametrize("name", ["mine.toml", "no/such/folder.toml", "mine.txt", "link.toml"])
def test_nothing_is_lost_and_nothing_half_written(name: str, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("mine")
    (tmp_path / "link.toml").symlink_to(tmp_path / "nowhere")
    before = sorted(tmp_path.iterdir())
    found = run("new", str(tmp_path / name))
    assert found.exit_code == 2
    assert found.stderr.count("\n") == 1
    assert (tmp_path / "mine.toml").read_text() == "mine"
    assert sorted(tmp_path.iterdir()) == before
    assert run("new", str(tmp_path / "mine.toml"), "--force").exit_code == 0


def test_notes_go_to_stderr(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    good("new", str(file))
    file.write_text(file.read_text().replace("x0 = 0 ", 'x0 = "pi/6" '))
    found = run("simulate", str(file), "--t-end", "2", "--json")
    assert found.stderr == "symosc: mine: x0 = pi/6: read to 40 digits, 0.5235987755982988730771…\n"
    assert found.stdout.startswith("{")
