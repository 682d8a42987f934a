"""What commands read alike: settings, whole numbers, names of files and folders."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import click
import pytest

from symosc import ParameterError, load_scene
from symosc.cli.settings import WholeNumber, folder_name, goes_to_stdout, read_settings, scene_with


def test_settings() -> None:
    assert read_settings(()) == {}
    assert read_settings(("k=3", "mu1=4/5", "name==x")) == {"k": "3", "mu1": "4/5", "name": "=x"}


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (("k",), "is not NAME=VALUE"),
        (("",), "is not NAME=VALUE"),
        (("k=1", "k=2"), "k is set twice"),
        (("t_end=3",), "t_end is not a parameter; use --t-end"),
        (("x0=3",), "x0 is not a parameter; use --x0"),
    ],
)
def test_settings_that_are_none(settings: tuple[str, ...], words: str) -> None:
    with pytest.raises(click.BadParameter, match=words):
        read_settings(settings)


@pytest.mark.parametrize("text", ["7", " 7 ", "+7", "07"])
def test_whole_numbers(text: str) -> None:
    assert WholeNumber(min=1).convert(text, None, None) == 7


@pytest.mark.parametrize("text", ["1_000", "７", "7.0", "", "seven", "0x7", "9" * 1001, "0", "-7"])
def test_what_is_no_whole_number(text: str) -> None:
    with pytest.raises(click.BadParameter):
        WholeNumber(min=1).convert(text, None, None)


@pytest.mark.parametrize(("name", "expected"), [(None, False), ("a.csv", False), ("-", True), ("./-", False)])
def test_standard_output_has_a_name(name: str | None, expected: bool) -> None:
    assert goes_to_stdout(name, "--csv") is expected


def test_standard_output_takes_one_thing() -> None:
    assert goes_to_stdout("a.csv", "--csv", as_json=True) is False
    for name, as_json in (("-", True), ("", False), ("", True)):
        with pytest.raises(click.BadParameter):
            goes_to_stdout(name, "--csv", as_json)


def test_folders() -> None:
    assert folder_name("out") == "out"
    assert folder_name("./-") == "./-"
    for name in ("", "-"):
        with pytest.raises(click.BadParameter, match="is not a folder"):
            folder_name(name)


def test_a_scene_with_changes() -> None:
    plain = load_scene("fig9")
    start: dict[str, Any] = {"x0": "1/3", "t_end": None}
    scene = scene_with("fig9", ("k=2",), start)
    assert scene.parameters == plain.parameters.replace(k=2)
    assert (scene.x0, scene.v0, scene.t_end) == (Fraction(1, 3), plain.v0, plain.t_end)
    with pytest.raises(ParameterError, match="k = "):
        scene_with("fig9", ("k=-2",), {})
