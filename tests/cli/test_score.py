"""`symosc cases` and `symosc score`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli_runs import good, run
from small_set import NAMES, small_set

from symosc.reference.folder import write_cases


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the small set."""
    return write_cases(tmp_path_factory.mktemp("score") / "cases", small_set())


def results(folder: Path, path: Path, change: dict[str, str] | None = None) -> Path:
    """Write right results into one file, with a text in place of others."""
    lines = ["case,t,x,kind,boundary"]
    for name in NAMES:
        for row in (folder / name / "events.csv").read_text().splitlines()[1:]:
            t, _, x, _, kind, boundary, *_ = row.split(",")
            lines.append(f"{name},{t},{x},{kind},{boundary}")
        lines.append(f"{name},,,end,")
    text = "\n".join(lines) + "\n"
    for old, new in (change or {}).items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path.write_text(text)
    return path


def test_right_results(folder: Path, tmp_path: Path) -> None:
    lines = good("score", str(folder), str(results(folder, tmp_path / "mine.csv"))).splitlines()
    assert lines[0].split()[:4] == ["case", "events", "condition", "mine"]
    assert lines[-1] == f"mine: right in all {len(NAMES)} cases"
    assert good("score", str(folder), str(folder)).splitlines()[-1].startswith("cases: right in all")


def test_wrong_results_are_named_and_the_exit_code_is_1(folder: Path, tmp_path: Path) -> None:
    path = results(folder, tmp_path / "mine.csv", {"paper-fig6,3.39156": "paper-fig6,3.39157"})
    result = run("score", str(folder), str(path))
    assert (result.exit_code, result.stderr) == (1, "")
    assert "paper-fig6: error: stick at belt 1, error 2.9e-06, allowed 1.0e-09 at t = 3.39156" in result.stdout
    assert result.stdout.splitlines()[-1] == f"mine: right in {len(NAMES) - 1} of {len(NAMES)} cases, wrong in 1"
    assert run("score", str(folder), str(path), "--tolerance", "1e-5").exit_code == 0
    data = json.loads(run("score", str(folder), str(path), "--json").stdout)
    (score,) = data["scores"]
    assert (data["set_version"], score["ok"], score["right"]) == (1, False, len(NAMES) - 1)
    (wrong,) = [case for case in score["results"] if not case["right"]]
    assert (wrong["name"], wrong["late"], wrong["missed"]) == ("paper-fig6", 1, 0)
    assert wrong["wrong"][0]["fault"] == "error"


def test_two_solvers_pages_and_a_picture(folder: Path, tmp_path: Path) -> None:
    one = results(folder, tmp_path / "one.csv")
    two = results(folder, tmp_path / "two.csv", {"rest-1,,,end,": "rest-1,3,0,slip,1\nrest-1,4,0,stick,1"})
    page, picture = tmp_path / "page.html", tmp_path / "picture.svg"
    result = run("score", str(folder), str(one), str(two), "-o", str(page), "--plot", str(picture))
    assert result.exit_code == 1
    assert "invented 2" in result.stdout
    assert result.stdout.splitlines()[0].split() == ["case", "events", "condition", "one", "two"]
    assert page.read_text().startswith("<!DOCTYPE html>")
    assert "<svg" in picture.read_text()
    markdown = tmp_path / "page.md"
    assert run("score", str(folder), str(two), "-o", str(markdown)).exit_code == 1
    assert "- rest-1: invented: slip at belt 1 at t = 3" in markdown.read_text()
    piped = run("score", str(folder), str(one), "--plot", "-")
    assert piped.exit_code == 0
    assert piped.stdout.startswith("<?xml")


def test_a_list_of_cases_says_how_many_are_proven() -> None:
    assert good("cases", "--group", "easy").splitlines()[-1] == "2 cases, 2 of them proven"


@pytest.mark.slow
def test_a_folder(tmp_path: Path) -> None:
    target = tmp_path / "cases"
    assert good("cases", "--group", "easy", "-o", str(target)) == f"wrote 2 cases into {target}\n"
    assert (target / "easy-fig9" / "events.csv").is_file()
    answer = json.loads(good("cases", "--group", "easy", "-o", str(target), "--json"))
    assert answer == {"folder": str(target), "cases": ["easy-fig9", "easy-fig10"]}
    assert good("score", str(target), str(target)).splitlines()[-1] == "cases: right in all 2 cases"
