"""What commands read alike: settings, whole numbers, names of files and folders."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest
from cli_runs import run

from symosc import ParameterError, load_scene
from symosc.cli.options import scene_with
from symosc.scenes import as_toml


def test_a_scene_with_changes() -> None:
    plain = load_scene("fig9")
    scene = scene_with("fig9", ("k=2",), x0="1/3", t_end=None)
    assert scene.parameters == plain.parameters.replace(k=2)
    assert (scene.x0, scene.v0, scene.t_end) == (Fraction(1, 3), plain.v0, plain.t_end)
    with pytest.raises(ParameterError, match="k = "):
        scene_with("fig9", ("k=-2",))


def test_numbers_that_are_typed_may_be_expressions_as_in_files(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = as_toml(load_scene("fig9"))
    for name, new in (("Omega", '"2*pi"'), ("mu1", '"sqrt(2)/9"'), ("x0", '"pi/6"')):
        text = re.sub(rf"^{name} = .*$", f"{name} = {new}", text, flags=re.M)
    path.write_text(text)
    typed = scene_with("fig9", ("Omega=2*pi", "mu1=sqrt(2)/9"), x0="pi/6")
    assert typed == load_scene(path)
    assert typed.start_error is not None
    assert scene_with("fig9", ("k=(1+2)/9",), v0="2^3").started({}).start_error is None


@pytest.mark.parametrize(
    ("command", "meant"),
    [
        ("simulat fig5", "simulate"),
        ("orbit fig9 --structur P32", "--structure"),
        ("simulate fig9_orbit", "fig9-orbit"),
        ("simulate fig5 --set fn=3", "FN"),
        ("grazing fig9 --set omega=3", "Omega"),
        ("sweep fig5 --over omega=1:2:3", "Omega"),
        ("sweep fig5 --over Omega=1:2:3 --record wrod", "word"),
        ("orbit fig9 --continue omega=3:4", "Omega"),
        ("derive jacobian", "jacobians"),
    ],
)
def test_what_is_like_a_known_word_is_named(command: str, meant: str) -> None:
    result = run(*command.split())
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert re.search(rf"did you mean '?{meant}'?\?", result.stderr, re.I), result.stderr
