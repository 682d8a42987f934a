"""`symosc grazing --solve`: inverse questions on the command line."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import cli_runs
import pytest

from symosc import load_scene, values_containing, values_empty, values_everything

FIG9 = load_scene("fig9").parameters


run, good = partial(cli_runs.run, "grazing"), partial(cli_runs.good, "grazing")


def test_one_parameter_and_a_phase() -> None:
    shown = good("fig9", "--map", "P2", "--solve", "Omega", "--phase", "7*pi/6")
    assert shown == "P2 grazes at theta = 7*pi/6 for Omega in (0, 2/3)\n"
    every = good("fig9", "--map", "P2", "--solve", "k", "--phase", "pi:3*pi/2")
    assert every == "P2 grazes at every theta in [pi, 3*pi/2] for k in [36, oo)\n"
    assert good("fig9", "--map", "P2", "--solve", "k", "--phase", "pi:3*pi/2", "--order", "paper") == every.replace(
        "[36", "(36"
    )
    changed = good("fig9", "--set", "B0=18", "--map", "P2", "--solve", "Omega", "--phase", "7*pi/6")
    assert "(0, 1/3)" in changed


def test_without_a_phase_empty_and_everything() -> None:
    lines = good("fig9", "--map", "P2", "--solve", "Omega").splitlines()
    assert lines == [values_empty(FIG9, "P2", "Omega").text(), values_everything(FIG9, "P2", "Omega").text()]
    assert lines == ["P2 grazes at no phase for no Omega", "P2 grazes at every phase for Omega in (0, 1/3]"]


def test_maps_that_depend_on_what_is_asked() -> None:
    maps = [line[:2] for line in good("fig9", "--solve", "v1", "--phase", "0").splitlines()]
    assert maps == ["P2", "P3"]
    assert len(good("fig9", "--solve", "Omega", "--phase", "1").splitlines()) == 4


def test_two_parameters_and_letters() -> None:
    region = good("fig9", "--map", "P2", "--solve", "Omega,k", "--phase", "7*pi/6")
    assert region == "P2 grazes at theta = 7*pi/6 where k > 9*Omega/2\n"
    letters = good("--map", "P3", "--solve", "Omega", "--phase", "pi").splitlines()
    assert letters[0] == "P3 grazes at theta = pi:"
    assert set(letters[1:]) == {
        "  if k*v_lambda < 0: Omega in (0, oo)",
        "  if k*v_lambda >= 0: Omega in the empty set",
    }


def test_latex_and_json() -> None:
    for names in ("Omega", "Omega,k"):
        arguments = ["fig9", "--map", "P2", "--solve", names, "--phase", "7*pi/6"]
        asked: Any = tuple(names.split(",")) if "," in names else names
        answer = values_containing(FIG9, "P2", asked, "7*pi/6")
        assert good(*arguments, "--latex") == answer.latex() + "\n"
        (data,) = json.loads(good(*arguments, "--json"))["answers"]
        assert data["latex"] == answer.latex()
        assert data["names"] == names.split(",")
        assert data.get("values", "(0, 2/3)") == "(0, 2/3)"
        assert data.get("condition", "k > 9*Omega/2") == "k > 9*Omega/2"
    (data,) = json.loads(good("--map", "P3", "--solve", "Omega", "--phase", "pi", "--json"))["answers"]
    assert {each["values"] for each in data["answers"]} == {"(0, oo)", "the empty set"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["fig9", "--phase", "pi"], "--phase needs --solve"),
        (["fig9", "--solve", "c"], "depends on Omega, B0, k and v1"),
        (["fig9", "--solve", ""], "is not NAME or NAME,NAME"),
        (["fig9", "--solve", "Omega,"], "is not NAME or NAME,NAME"),
        (["fig9", "--solve", "Omega,k,B0"], "is not NAME or NAME,NAME"),
        (["fig9", "--solve", "Omega,Omega"], "two different ones"),
        (["fig9", "--solve", "Omega", "--phase", ""], "theta = ''"),
        (["fig9", "--solve", "Omega", "--phase", "pi*pi"], "a rational multiple of pi such as"),
        (["fig9", "--solve", "Omega", "--phase", "pi:"], "is not PHASE or LOW:HIGH"),
        (["fig9", "--solve", "Omega", "--phase", "pi:0"], "from a lower to a higher phase"),
        (["fig9", "--solve", "Omega", "--phase", "0:9"], "longer than a turn"),
        (["fig9", "--solve", "Omega", "--plot", "a.png"], "draws one region"),
        (["fig9", "--solve", "Omega", "--check", "5"], "goes without --check and --against"),
        (["--solve", "Omega,k", "--phase", "1"], "needs numbers: give a SCENE"),
        (["--solve", "Omega", "--phase", "1:2"], "where the parameters are letters"),
        (["fig9", "--map", "P1", "--solve", "Omega"], "sticks on belt 1"),
        (["fig9", "--map", "P5", "--solve", "v1"], "depends on Omega, B0, k and v2"),
    ],
)
def test_bad_questions_cost_one_line(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_help_has_examples() -> None:
    assert "--solve Omega --phase 7*pi/6" in good("--help")
