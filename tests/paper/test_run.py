"""symosc reproduce: reading claims, judging them, what the reports say, exit codes and bad input."""

from __future__ import annotations

import json
import os
import re
import signal
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure
from pebble.pool.process import PoolManager
from stand_in_claims import CLAIM, bad_picture, good_picture

from symosc.cli import reproduce
from symosc.cli.app import main
from symosc.derive.chapters import CHAPTERS
from symosc.errors import OutputError, ParameterError
from symosc.paper import report
from symosc.paper.claims import read_claims
from symosc.paper.evidence import VERDICTS
from symosc.paper.pictures import PICTURES, Picture
from symosc.paper.run import ERROR, POOLS, Plan, Results, run

CLAIMS = read_claims(PICTURES)


def pictures(build: Callable[[], Figure]) -> dict[str, Picture]:
    return {"fig1": Picture("fig1", "Fig. 1: a line", "A line.", 1, build, partial(str, "From 0 to v1."), build)}


# --- the claims files ---


def test_a_part_of_a_plan() -> None:
    plan = Plan(CLAIMS, PICTURES)
    part = plan.only("fig7")
    assert {claim.id.partition("-")[0] for claim in part.claims} == {"fig7"}
    assert "fig7" in part.pictures
    assert "fig6" not in part.pictures
    assert 0 < len(part) < len(plan)
    assert plan.subjects
    assert part.subjects == ()  # a chapter takes longer than the claims
    for prefix in ("fig11", ""):
        with pytest.raises(ParameterError, match="no claim's id begins so"):
            plan.only(prefix)


def test_the_command_checks_every_chapter(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    plans: list[Plan] = []
    monkeypatch.setattr(reproduce, "carry_out", lambda plan, *rest: plans.append(plan) or 0)
    for words in ([], ["--only", "fig5"]):
        assert CliRunner().invoke(main, ["reproduce", "-o", str(tmp_path), *words]).exit_code == 0
    assert [plan.subjects for plan in plans] == [tuple(CHAPTERS), ()]


# --- a run ---


@pytest.fixture
def results(read: Any) -> Results:
    names = ("right", "wrong", "raises", "dies", "no_evidence")
    claims = read("\n".join(CLAIM.format(id=name.replace("_", "-"), check=name) for name in names))
    return run(Plan(claims, pictures(bad_picture)), workers=1)


@pytest.mark.slow
def test_what_goes_wrong_is_a_result(results: Results) -> None:
    verdicts = {each.claim.id: each.verdict for each in results.judged}
    assert verdicts == dict.fromkeys(verdicts, ERROR) | {"right": "confirmed", "wrong": "not as printed"}
    findings = {each.claim.id: each.finding for each in results.judged}
    assert re.fullmatch(r"ZeroDivisionError: by nothing \(stand_ins.py, line \d+\)", findings["raises"])
    assert findings["dies"] == "the process ended with exit code 7"
    assert "no_evidence returned bool, not Evidence" in findings["no-evidence"]
    assert [each.claim.id for each in results.changed] == ["wrong", "raises", "dies", "no-evidence"]
    assert "no such curve" in results.failures["fig1"]
    assert not results.ok

    texts = report.files(results)
    content = json.loads(texts["report.json"])
    assert content["ok"] is False
    assert content["changed"] == ["wrong", "raises", "dies", "no-evidence"]
    assert content["counts"] == dict.fromkeys(VERDICTS, 0) | {"confirmed": 1, "not as printed": 1, ERROR: 3}
    assert content["claims"][0]["numbers"] == {"a|b": "1e-20", "F(1)": "-3"}
    assert content["figures"][0]["file"] is None
    for name in ("report.html", "report.md"):
        assert "not as printed" in texts[name]
        assert "committed: confirmed" in texts[name]
        assert "by nothing" in texts[name]
        assert "no such curve" in texts[name]
    assert r"a\|b | 10<sup>−20</sup>" in texts["report.md"]
    assert "It is 1 &lt;2&gt;." in texts["report.html"]


@pytest.mark.slow
@pytest.mark.parametrize("pools", [1, POOLS])
def test_a_pool_that_breaks_down_is_replaced(read: Any, monkeypatch: pytest.MonkeyPatch, pools: int) -> None:
    # A process that dies before the pool has noted what it does takes the whole pool with it.
    find = PoolManager.find_expired_task
    seen: list[int] = []

    def break_down(manager: PoolManager, worker: int) -> Any:
        seen.append(worker)
        if len(seen) == 1:
            raise BrokenProcessPool("All workers expired")
        return find(manager, worker)

    monkeypatch.setattr(PoolManager, "find_expired_task", break_down)
    monkeypatch.setattr("symosc.paper.run.POOLS", pools)
    claims = read("".join(CLAIM.format(id=name, check=name) for name in ("dies", "right")))
    findings = {each.claim.id: each.finding for each in run(Plan(claims, {}), workers=1).judged}
    if pools > 1:
        assert findings["dies"] == "the process ended with exit code 7"
        assert findings["right"] == "It is 1 <2>."
    else:
        assert findings["dies"] == "the pool of processes broke down, 1 times"


@pytest.mark.slow
def test_a_check_that_hangs_is_stopped(read: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symosc.paper.run.TASK_LIMIT", 0.5)
    (judged,) = run(Plan(read(CLAIM.format(id="one", check="hangs")), {})).judged
    assert (judged.verdict, judged.finding) == (ERROR, "no result within 0.5 s")


@pytest.mark.slow
def test_tasks_share_the_processors(read: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symosc.paper.run._processors", lambda: 2)
    claims = read("".join(CLAIM.format(id=f"shared-{i}", check="shared") for i in range(4)))
    done = run(Plan(claims, {}))
    processes = {each.numbers["process"] for each in done.judged}
    assert len(processes) == 2
    assert str(os.getpid()) not in processes


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
    read: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], check: str, build: Any, code: int, said: str
) -> None:
    plan = Plan(read(CLAIM.format(id="one", check=check)), pictures(build))
    folder = tmp_path / "deep" / "report"
    assert reproduce.carry_out(plan, folder, workers=0) == code
    assert said in capsys.readouterr().out
    files = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert files == {*report.REPORTS} | ({"figures/fig1.svg"} if build is good_picture else set())


@pytest.mark.slow
def test_json_for_machines(read: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = CLAIM.format(id="one", check="right") + 'figures = ["fig1"]\nderivation = "events"\n'
    plan = Plan(read(text), pictures(good_picture))
    assert reproduce.carry_out(plan, tmp_path, as_json=True, workers=0) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    (claim,), (figure,), (derivation,) = (content[key] for key in ("claims", "figures", "derivations"))
    assert claim["verdict"] == claim["committed"] == "confirmed"
    assert (tmp_path / figure["file"]).read_text(encoding="utf-8").count("<svg") == 1
    assert figure["claims"] == derivation["claims"] == ["one"]
    assert derivation["steps"] > 0
    assert (tmp_path / derivation["file"].partition("#")[0]).is_file()
    assert {"date", "processor", "python", "symosc", "seconds"} <= set(content["made"])
    markdown = (tmp_path / "report.md").read_text(encoding="utf-8")
    for link in re.findall(r"\]\(([^#)]+)\)", markdown):
        assert (tmp_path / link).is_file(), link
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "From 0 to v<sub>1</sub>." in html
    assert "<math" in html
    assert html.count("<source ") == 1  # the picture in the form for phones
    assert not re.search(r"<script|src=\"(?!data:)|href=\"(?!#|data:)", html)


def test_nothing_is_written_before_the_end(read: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = tmp_path / "out"
    old.mkdir()
    (old / "report.html").write_text("old")
    plan = Plan(read(CLAIM.format(id="one", check="right")), pictures(good_picture))
    monkeypatch.setattr(report, "files", lambda results: {"report.html": "new", "figures/\0": "not a name"})
    with pytest.raises(ValueError, match="null byte"):
        reproduce.carry_out(plan, old, workers=0)
    assert [(path.name, path.read_text()) for path in old.iterdir()] == [("report.html", "old")]


@pytest.mark.parametrize("there", [False, True])
def test_an_interrupt_leaves_the_folder_as_it_was(
    read: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, there: bool
) -> None:
    folder = tmp_path / "deep" / "out"
    if there:
        folder.mkdir(parents=True)
        (folder / "report.html").write_text("old")
    plan = Plan(read(CLAIM.format(id="one", check="right")), pictures(good_picture))

    def interrupted(*_: object) -> None:
        assert list(folder.glob(".symosc-*"))  # the work has begun
        raise KeyboardInterrupt

    monkeypatch.setattr("symosc.paper.run.judge", interrupted)
    with pytest.raises(KeyboardInterrupt):
        reproduce.carry_out(plan, folder, workers=0)
    if there:
        assert [(path.name, path.read_text()) for path in folder.iterdir()] == [("report.html", "old")]
    else:
        assert not (tmp_path / "deep").exists()


def test_an_interrupt_while_the_report_is_written_comes_after_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace = os.replace

    def interrupting(*paths: Any) -> None:
        signal.raise_signal(signal.SIGINT)
        replace(*paths)

    monkeypatch.setattr(os, "replace", interrupting)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt), report.Folder(tmp_path / "out") as folder:
            folder.write({"report.html": "new", "report.md": "new"})
    finally:
        signal.signal(signal.SIGINT, before)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["report.html", "report.md"]


def test_bad_input_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for words in (
        ["-o", str(tmp_path / "file" / "sub")],
        ["-o", "-"],
        ["-o", ""],
        ["--only", "fig11", "-o", str(tmp_path / "out")],
        ["--only", "", "-o", str(tmp_path / "out")],
    ):
        result = CliRunner().invoke(main, ["reproduce", *words])
        assert result.exit_code == 2
        assert result.stdout == ""
        assert result.stderr.startswith("symosc: error: ")
        assert result.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_folder_that_is_a_file(tmp_path: Path) -> None:
    (tmp_path / "figures").touch()
    with report.Folder(tmp_path) as folder, pytest.raises(OutputError, match="cannot write"):
        folder.write({"figures/fig1.svg": "x", "report.html": "x"})
    assert [path.name for path in tmp_path.iterdir()] == ["figures"]
