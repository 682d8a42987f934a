"""symosc scenes: the list, and scene files that it prints."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import pytest
from cli_runs import good

import symosc


def test_scenes_lists_all_with_their_source() -> None:
    text = good("scenes")
    for name in symosc.scene_names():
        assert re.search(rf"^{name} ", text, re.MULTILINE)
    assert "WSEAS" in text.splitlines()[-1]
    data = json.loads(good("scenes", "--json"))
    assert [entry["name"] for entry in data] == symosc.scene_names()


@pytest.mark.parametrize("name", symosc.scene_names())
def test_a_printed_scene_is_the_scene(name: str, tmp_path: Path) -> None:
    path = tmp_path / "copy.toml"
    path.write_text(good("scenes", name))
    assert symosc.load_scene(path) == symosc.load_scene(name)


def test_the_error_of_a_start_survives_the_scene_file(tmp_path: Path) -> None:
    text = good("scenes", "fig8-exact")
    assert "start_error = [0, 5e-45, 5e-45]" in text
    assert json.loads(good("scenes", "fig8-exact", "--json"))["start_error"] == ["0", "5e-45", "5e-45"]
    assert "start_error" not in good("scenes", "fig8")
    path = tmp_path / "one.toml"
    for given, read in (('"1/3"', Fraction(1, 3)), ("1e-9", Fraction(1, 10**9)), ("0", Fraction(0))):
        path.write_text(re.sub(r"start_error = .*", f"start_error = {given}", text))
        assert symosc.load_scene(path).start_error == (read,) * 3
        copy = tmp_path / "copy.toml"
        copy.write_text(good("scenes", str(path)))
        assert symosc.load_scene(copy).start_error == (read,) * 3


def test_a_fraction_survives_the_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "third.toml"
    path.write_text(good("scenes", "fig5").replace("k = 1", 'k = "1/3"'))
    copy = tmp_path / "copy.toml"
    copy.write_text(good("scenes", str(path)))
    assert symosc.load_scene(copy).parameters == symosc.load_scene("fig5").parameters.replace(k="1/3")
