"""`symosc warm`: what it prints; the compiling itself is replaced, it takes a minute."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner

from symosc.cli.app import main
from symosc.errors import MissingExtraError
from symosc.simulation import batch
from symosc.simulation.batch import Warmed

DONE = [Warmed("events in doubles", False, 12.34), Warmed("events in double-double numbers", True, 0.5)]


def run(*arguments: str) -> str:
    result = CliRunner().invoke(main, ["warm", *arguments], prog_name="symosc", catch_exceptions=False)
    assert (result.exit_code, result.stderr) == (0, "")
    return result.stdout


def test_a_row_for_each_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch, "warm", lambda: DONE)
    heads, _, *rows = (line.split("  ") for line in run().splitlines())
    assert [part.strip() for part in heads if part] == ["what", "how", "seconds"]
    assert [[part.strip() for part in row if part] for row in rows] == [
        ["events in doubles", "compiled", "12.3"],
        ["events in double-double numbers", "loaded", "0.5"],
    ]
    assert json.loads(run("--json")) == [row._asdict() for row in DONE]


def test_without_numba_one_line_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing() -> None:
        raise MissingExtraError("compiling", "fast")

    monkeypatch.setattr(batch, "compiled", missing)
    with pytest.raises(SystemExit) as ended:
        main.main(["warm"], prog_name="symosc")
    assert ended.value.code == 2


@pytest.mark.slow
@pytest.mark.compiled("pairs")
def test_what_was_compiled_is_there() -> None:
    pytest.importorskip("numba")
    batch.warm()
    assert [row.was_there for row in batch.warm()] == [True] * 3
