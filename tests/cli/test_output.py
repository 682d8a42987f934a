"""What commands print: tables, JSON, counts, and a word where a motion could not be decided."""

from __future__ import annotations

import json
from typing import Any

import click
import pytest

from symosc import simulate
from symosc.cli import common as output


def test_tables_align_numbers_at_their_points(capsys: pytest.CaptureFixture[str]) -> None:
    output.write_table([["1.5", "stick", "2.25"], ["10.125", "slip", "12.5"]], ["t", "kind", "t error"])
    head, line, first, second = capsys.readouterr().out.splitlines()
    assert first.index(".") == second.index(".")
    assert first.index("2.25") == second.index("12.5")  # the error's column is text
    assert head.split("  ") != head
    assert set(line) == {"-", " "}


def test_json_is_read_back(capsys: pytest.CaptureFixture[str]) -> None:
    data = {"a": [1, 2.5, "x"], "b": None}
    output.write_json(data)
    text = capsys.readouterr().out
    assert json.loads(text) == data
    assert text.endswith("}\n")


def test_counts_in_words() -> None:
    assert [output.count_events([0] * n) for n in (0, 1, 2)] == ["0 events", "1 event", "2 events"]


def test_an_undecided_motion_is_said_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    class Undecided:
        status, message = "undecidable", "the contact near t = 3"

    assert output.undecidable(Undecided()) is True  # type: ignore[arg-type]
    assert capsys.readouterr() == ("", "symosc: undecidable: the contact near t = 3\n")
    assert output.undecidable(simulate("fig5", t_end=2)) is False
    assert capsys.readouterr() == ("", "")


def test_a_reader_that_has_had_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    dropped: list[bool] = []

    def closed(*_: Any, **__: Any) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(click, "echo", closed)
    monkeypatch.setattr(output, "drop_stdout", lambda: dropped.append(True))
    output.write("text")
    assert dropped == [True]
