"""What commands read alike: settings, whole numbers, names of files and folders."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from cli_runs import COMMANDS, good, run

from symosc import ParameterError, load_scene
from symosc.cli.common import scene_with
from symosc.scenes import as_toml


def test_a_scene_with_changes() -> None:
    plain = load_scene("fig9")
    start: dict[str, Any] = {"x0": "1/3", "t_end": None}
    scene = scene_with("fig9", ("k=2",), start)
    assert scene.parameters == plain.parameters.replace(k=2)
    assert (scene.x0, scene.v0, scene.t_end) == (Fraction(1, 3), plain.v0, plain.t_end)
    with pytest.raises(ParameterError, match="k = "):
        scene_with("fig9", ("k=-2",), {})


#: What shows the end of the motion that a command with --t-end looks at.
ENDS = {
    "simulate": ["simulate", "fig9", "--json"],
    "certify": ["certify", "fig9", "--json"],
    "figure": ["figure", "fig9", "-o", "fig9.svg"],
    "check": ["check", "fig9", "--solver", "solver_of_periods:solve", "--json"],
    "sweep": ["sweep", "fig9", "--over", "mu1=0.2:0.3:2", "--record", "t", "--json"],
}


SOLVER = """
from pathlib import Path
import numpy as np
from symosc import simulate
def solve(p, t0, x0, v0, t_end):
    Path("end").write_text(repr(float(t_end)))
    t = np.linspace(float(t0), float(t_end), 2000)
    return t, *simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end)(t)
"""


@pytest.mark.slow
def test_every_end_may_be_periods(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("xarray")
    pytest.importorskip("flint")
    with_end = {name for name in COMMANDS if "--t-end" in good(name, "--help")}
    assert with_end == ENDS.keys()
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "solver_of_periods.py").write_text(SOLVER)
    scene = load_scene("fig9")
    for (name, command), end in product(ENDS.items(), ("1.5T", f"{float(scene.t0)} + sqrt(36)")):
        shown = run(*command, "--set", "Omega=pi/2", "--t-end", end).stdout
        if name == "figure":
            said = float(shown.partition(" to ")[2].partition(",")[0])
        elif name == "check":
            said = float(Path("end").read_text())
        else:
            found = json.loads(shown)
            said = found["columns"]["t"]["largest"] if name == "sweep" else float(found["t_end"])
        assert said == pytest.approx(float(scene.t0) + 6, rel=1e-5), (name, shown)


def test_numbers_that_are_typed_may_be_expressions_as_in_files(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = as_toml(load_scene("fig9"))
    for name, new in (("Omega", '"2*pi"'), ("mu1", '"sqrt(2)/9"'), ("x0", '"pi/6"')):
        text = re.sub(rf"^{name} = .*$", f"{name} = {new}", text, flags=re.M)
    path.write_text(text)
    typed = scene_with("fig9", ("Omega=2*pi", "mu1=sqrt(2)/9"), {"x0": "pi/6"})
    assert typed == load_scene(path)
    assert typed.start_error is not None
    assert scene_with("fig9", ("k=(1+2)/9",), {"v0": "2^3"}).started({}).start_error is None


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
