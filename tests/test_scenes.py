"""Bad scenes, scene files and errors of starts: one clear line each."""

from __future__ import annotations

import pickle
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from bad_values import refused

from symosc import Scene, load_scene
from symosc.errors import SceneError
from symosc.exact import read_start_error, show
from symosc.scenes import SCENES_FOLDER
from symosc.words import WordError

P = load_scene("fig5").parameters
START = {"t0": 0, "x0": 0, "v0": 0, "t_end": 5}


@pytest.mark.parametrize("value", ["P99", "", "P33", "xx", "P5 P2"])
def test_a_structure_that_is_none(value: str) -> None:
    with pytest.raises(WordError):
        Scene("s", P, **START, structure=value)
    assert Scene("s", P, **START, structure="P3∘P2").structure == "P3∘P2"


@pytest.mark.parametrize(
    ("name", "value"),
    [("name", value) for value in (None, 5, "", " ")]
    + [("source", None), ("source", b""), ("parameters", None), ("parameters", {})],
)
def test_a_scene_of_wrong_types(name: str, value: Any) -> None:
    refused(lambda: Scene(**({"name": "s", "parameters": P, **START} | {name: value})), name)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "is empty"),
        (b"# nothing\n", "is empty"),
        (b"t_end = 5\n", r"start is missing: give it in a table \[start\]"),
        (b"a = " + b"[" * 50_000, "nested too deeply"),
        (b"t_end = " + b"1" * 5000, "is not valid TOML"),
        (b"\xff\xfea", "is not UTF-8"),
    ],
)
def test_scene_files_that_are_none(text: bytes, message: str, tmp_path: Any) -> None:
    path = tmp_path / "bad.toml"
    path.write_bytes(text)
    with pytest.raises(SceneError, match=message) as caught:
        load_scene(path)
    assert "\n" not in str(caught.value)


def test_a_scene_file_may_begin_with_a_byte_order_mark(tmp_path: Any) -> None:
    path = tmp_path / "bom.toml"
    path.write_bytes(b"\xef\xbb\xbf" + (SCENES_FOLDER / "fig5.toml").read_bytes())
    assert load_scene(path) == load_scene("fig5")


@pytest.mark.parametrize("value", ["", "a\0b", "a\0.toml", ".", "n" * 5000])
def test_names_of_scenes(value: Any) -> None:
    with pytest.raises(SceneError) as caught:
        load_scene(value)
    assert "\n" not in str(caught.value)
    assert "\0" not in str(caught.value)


# --- the error of a start ---


def test_start_errors_are_read_exactly() -> None:
    assert read_start_error(None) is None
    assert read_start_error("1e-30") == (Fraction(1, 10**30),) * 3
    assert read_start_error([0, 0.1, "1/3"]) == (0, Fraction(1, 10), Fraction(1, 3))
    assert Scene("s", P, **START).start_error is None
    scene = Scene("s", P, **START, start_error=(0, "5e-45", Decimal("5e-45")))
    assert scene.start_error == (0, Fraction(1, 2 * 10**44), Fraction(1, 2 * 10**44))
    assert hash(scene) == hash(pickle.loads(pickle.dumps(scene)))


@pytest.mark.parametrize(
    "value",
    [
        "",
        "abc",
        -1,
        [0, 0, -1],
        [0, 0],
        [],
        [0] * 4,
        [0, 0, None],
        float("nan"),
        True,
        {},
        {1: 2, 3: 4, 5: 6},
        1j,
        b"123",
        [[0]] * 3,
    ],
)
def test_start_errors_that_are_none(value: Any) -> None:
    refused(lambda: Scene("s", P, **START, start_error=value), "start_error")


@pytest.mark.parametrize("name", ["fig7-exact", "fig8-exact"])
def test_exact_scenes_are_known_to_half_a_unit_of_their_last_digit(name: str) -> None:
    scene = load_scene(name)
    assert scene.start_error is not None
    assert scene.start_error[0] == 0
    for value, error in zip((scene.x0, scene.v0), scene.start_error[1:], strict=True):
        digits = len(show(value).partition(".")[2])
        assert error == Fraction(1, 2 * 10**digits)
