"""`symosc cases`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli_runs import good, run


def test_a_table_of_a_group() -> None:
    lines = good("cases", "--group", "easy").splitlines()
    assert lines[0].split() == ["name", "group", "events", "status"]
    assert lines[2].split() == ["easy-fig9", "easy", "12", "proven"]
    assert lines[-1] == "2 cases, 2 of them proven"
    listed = json.loads(good("cases", "--group", "continuum", "--json"))["cases"]
    assert len(listed) == 9
    assert listed[0]["status"] == "computed, not proven"


@pytest.mark.slow
def test_a_folder(tmp_path: Path) -> None:
    target = tmp_path / "cases"
    assert good("cases", "--group", "easy", "-o", str(target)) == f"wrote 2 cases into {target}\n"
    assert (target / "easy-fig9" / "events.csv").is_file()
    answer = json.loads(good("cases", "--group", "easy", "-o", str(target), "--json"))
    assert answer == {"folder": str(target), "cases": ["easy-fig9", "easy-fig10"]}
    assert good("score", str(target), str(target)).splitlines()[-1] == "cases: right in all 2 cases"


@pytest.mark.parametrize(
    "arguments",
    [
        ("--group", "none"),
        ("-o", ""),
        ("-o", "-"),
        ("-o", "no/such/folder", "--group", "easy"),
        ("-o", __file__, "--group", "easy"),
        ("more",),
    ],
)
def test_bad_input(arguments: tuple[str, ...]) -> None:
    result = run("cases", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert len(result.stderr.splitlines()) == 1
