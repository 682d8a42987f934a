"""symosc reproduce: a run, what goes wrong in it, exit codes, files and bad input."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure
from stand_in_claims import CLAIM, bad_picture, good_picture

from symosc.base.errors import OutputError
from symosc.cli import reproduce
from symosc.cli.app import main
from symosc.paper import report
from symosc.paper.pictures import Picture
from symosc.paper.run import ERROR, Plan, run


def pictures(build: Callable[[], Figure]) -> dict[str, Picture]:
    return {
        "fig1": Picture(
            "fig1", "Fig. 1: a line", "A line.", 1, build, partial(str, "From 0 to v1."), build
        )
    }


@pytest.mark.slow
def test_what_goes_wrong_is_a_result(read: Any) -> None:
    checks = {
        name.replace("_", "-"): name for name in ("right", "wrong", "raises", "dies", "no_evidence")
    }
    checks |= {"one": "shared", "two": "shared"}  # these wait for each other
    claims = read("\n".join(CLAIM.format(id=name, check=check) for name, check in checks.items()))
    results = run(Plan(claims, pictures(bad_picture)), workers=2)
    verdicts = {each.claim.id: each.verdict for each in results.judged}
    assert verdicts == dict.fromkeys(verdicts, "confirmed") | {
        "wrong": "not as printed"
    } | dict.fromkeys(("raises", "dies", "no-evidence"), ERROR)
    assert len({os.getpid(), *(int(each.numbers["process"]) for each in results.judged[-2:])}) == 3
    findings = {each.claim.id: each.finding for each in results.judged}
    assert re.fullmatch(
        r"ZeroDivisionError: by nothing \(stand_ins.py, line \d+\)", findings["raises"]
    )
    assert findings["dies"] == "the process ended with exit code 7"
    assert "no_evidence returned bool, not Evidence" in findings["no-evidence"]
    assert not results.ok
    assert [each.claim.id for each in results.changed] == ["wrong", "raises", "dies", "no-evidence"]
    assert "no such curve" in results.failures["fig1"]


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("check", "build", "code", "said"),
    [
        ("right", good_picture, 0, "1 claim: 1 confirmed"),
        ("wrong", good_picture, 1, "CHANGED one: It is 3."),
        ("raises", good_picture, 1, "CHANGED one: ZeroDivisionError"),
        ("right", bad_picture, 1, "FAILED fig1: ValueError: no such curve"),
    ],
)
def test_exit_codes(
    read: Any,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    check: str,
    build: Any,
    code: int,
    said: str,
) -> None:
    plan = Plan(read(CLAIM.format(id="one", check=check)), pictures(build))
    folder = tmp_path / "deep" / "report"
    assert reproduce.carry_out(plan, folder, workers=0) == code
    assert said in capsys.readouterr().out
    files = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert files == {"report.html", "report.json"} | (
        {"figures/fig1.svg"} if build is good_picture else set()
    )


@pytest.mark.slow
def test_json_for_machines(read: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = CLAIM.format(id="one", check="right") + 'see = ["fig1", "switching"]\n'
    plan = Plan(read(text), pictures(good_picture), ("switching",))
    assert reproduce.carry_out(plan, tmp_path, as_json=True, workers=0) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    (figure,) = content["figures"]
    (derivation,) = content["derivations"]
    assert (tmp_path / figure["file"]).read_text(encoding="utf-8").count("<svg") == 1
    assert {"date", "processor", "python", "symosc", "seconds"} <= set(content["made"])
    assert (tmp_path / derivation["file"].partition("#")[0]).is_file()
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<math" in html
    assert not re.search(r"<script|src=\"(?!data:)|href=\"(?!#|data:)", html)


def test_a_run_says_at_once_what_it_does_and_how_long(
    read: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    claims = read(CLAIM.format(id="one", check="right"))
    assert Plan(claims, {}).about == "judges 1 claim; takes about 5 seconds on two cores"
    keys = [str(number) for number in range(20)]
    plan = Plan(claims * 101, dict.fromkeys(keys), tuple(keys[:18]))  # type: ignore[arg-type]
    assert plan.about == (
        "judges 101 claims, draws 20 figures, checks 18 chapters of derivations; "
        "takes about a minute on two cores"
    )
    several = Plan(claims, {}, tuple(keys) * 4)
    assert several.about.endswith("; takes about 2 minutes on two cores")
    assert reproduce.carry_out(Plan(claims, {}), tmp_path, workers=0) == 0
    assert capsys.readouterr().err == f"symosc: reproduce {Plan(claims, {}).about}\n"


@pytest.mark.parametrize("there", [False, True])
def test_an_interrupt_leaves_the_folder_as_it_was(read: Any, tmp_path: Path, there: bool) -> None:
    folder = tmp_path / "deep" / "out"
    if there:
        folder.mkdir(parents=True)
        (folder / "report.html").write_text("old")
    with pytest.raises(KeyboardInterrupt):
        reproduce.carry_out(
            Plan(read(CLAIM.format(id="one", check="interrupts")), {}), folder, workers=0
        )
    if there:
        assert [(path.name, path.read_text()) for path in folder.iterdir()] == [
            ("report.html", "old")
        ]
    else:
        assert not (tmp_path / "deep").exists()


def test_nothing_is_written_unless_all_of_it_can_be(tmp_path: Path) -> None:
    (tmp_path / "figures").touch()
    with pytest.raises(OutputError, match="cannot write"):
        report.write(tmp_path, {"figures/fig1.svg": "x", "report.html": "x"})
    with pytest.raises(ValueError, match="null byte"):
        report.write(tmp_path, {"report.html": "new", "x\0": "not a name"})
    assert [path.name for path in tmp_path.iterdir()] == ["figures"]


def test_bad_input_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    out = str(tmp_path / "out")
    for words in (
        ["-o", str(tmp_path / "file" / "sub")],
        ["-o", "-"],
        ["-o", ""],
        ["--only", "fig11", "-o", out],
    ):
        result = CliRunner().invoke(main, ["reproduce", *words])
        assert result.exit_code == 2
        assert result.stdout == ""
        assert result.stderr.startswith("symosc: error: ")
        assert result.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()
