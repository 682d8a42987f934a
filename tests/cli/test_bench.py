"""`symosc bench`: what it runs, prints and writes; the measuring itself is replaced, it takes minutes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from matplotlib.figure import Figure

from symosc.bench import cases, error_map, speed, work
from symosc.cli.app import main

MARKS = "<!-- results: begin -->\nold\n<!-- results: end -->\n"


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["bench", *arguments], prog_name="symosc")


def good(*arguments: str) -> str:
    result = run(*arguments)
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    return result.stdout


#: Where what takes long is, and what its result is called.
MEASURED = {
    "speed": (speed, "run"),
    "work_precision": (work, "run"),
    "hard": (cases, "run"),
    "error_map": (error_map, "run"),
}


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Replace what takes long; return the names of what is run."""
    names: list[str] = []

    def measured(name: str) -> Callable[..., dict[str, Any]]:
        def run(
            progress: Callable[..., Iterable[int]] = iter, quick: bool = False, cases: object = None
        ) -> dict[str, Any]:
            names.append("scores" if name == "hard" and cases is None else name)
            about: dict[str, Any] = {"machine": None, "ok": True, "scores": [], "ours": []}
            return about | {"name": names[-1], "quick": quick, "steps": list(progress([1, 2])), "empty": float("nan")}

        return run

    def drawn(result: dict[str, Any]) -> Figure:
        drawing = Figure()
        drawing.text(0, 0, "x", gid=f"picture of {result['name']}")
        return drawing

    for name, (module, function) in MEASURED.items():
        monkeypatch.setattr(module, function, measured(name))
        if hasattr(module, "table"):
            monkeypatch.setattr(module, "table", lambda result, **options: f"table of {result['name']} {options}")
    monkeypatch.setattr(cases, "hard_ones", lambda quick: f"hard ones, {quick}")
    for module in (work, error_map):
        monkeypatch.setattr(module, "figure", drawn)
    return names


def test_json_of_all_that_was_measured(calls: list[str]) -> None:
    data = json.loads(good("--json"))
    assert calls == ["speed", "work_precision"]
    assert list(data) == ["quick", *calls]
    assert (data["speed"]["name"], data["speed"]["quick"]) == ("speed", False)
    assert (data["work_precision"]["steps"], data["work_precision"]["empty"]) == ([1, 2], None)
    assert list(json.loads(good("--json", "--hard", "--quick"))) == ["quick", "hard"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "work.eps"], ".pdf, .svg or .png"),
        (["--results", "none.md"], "cannot write none.md: No such file"),
        (["--results", "plain.md"], "cannot write plain.md: needs the lines '<!-- results: begin -->'"),
        (["--results", "marked.md", "--hard"], "leave out --hard and -o"),
        (["--results", "marked.md", "-o", "work.svg"], "leave out --hard and -o"),
        (["--gradients", "plain.md", "--hard"], "--gradients is a run of its own"),
        (["--gradients", "plain.txt"], "must end in .md"),
    ],
    ids=["suffix", "no README", "no marks", "hard", "picture", "gradients", "no page"],
)
def test_bad_input_costs_no_measuring(
    arguments: list[str], message: str, calls: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plain.md").write_text("nothing")
    Path("marked.md").write_text(MARKS)
    result = run(*arguments)
    assert (result.exit_code, result.stdout, calls) == (2, "", [])
    assert result.stderr.count("\n") == 1
    assert message in result.stderr
    assert Path("marked.md").read_text() == MARKS
