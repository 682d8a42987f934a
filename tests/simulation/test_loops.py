"""Which loop follows motions: one choice, with its budgets."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from symosc import load_scene
from symosc.base.errors import MissingExtraError
from symosc.engine import arithmetic, batch
from symosc.engine.arithmetic import Arithmetic
from symosc.simulation import loops
from symosc.simulation.loops import INTERPRETED, TURN, Budget, LoopChoice

K = Arithmetic(load_scene("fig5").parameters).K


def compiled_function(name: str, there: bool) -> Any:
    """Return what stands for a compiled function, whose code is on disk or not."""
    cache = SimpleNamespace(has_code=lambda: there)
    return SimpleNamespace(py_func=name, overloads={}, _cache=cache)


def with_compiled(monkeypatch: pytest.MonkeyPatch, there: bool) -> dict[str, Any]:
    """Let compiled functions be on disk or not; none has run."""
    functions = {
        name: compiled_function(name, there)
        for name in ("march_rows", "follow_all", "settle", "search_row", "doubt_row")
    }
    functions["run_program"] = compiled_function("run_program", there)
    monkeypatch.setattr(loops, "compiled", lambda: functions)
    monkeypatch.setattr(arithmetic, "compiled_program", lambda: functions["run_program"])
    monkeypatch.setattr(loops, "loaded_loop", lambda: None)
    return functions


def without_numba() -> Any:
    raise MissingExtraError("compiling", "fast")


def test_the_caller_decides_about_many(monkeypatch: pytest.MonkeyPatch) -> None:
    functions = with_compiled(monkeypatch, False)
    assert LoopChoice().of_many(False) is INTERPRETED
    assert LoopChoice().of_many(True).follow is functions["follow_all"]
    monkeypatch.setattr(loops, "compiled", without_numba)
    assert LoopChoice().of_many(None) is INTERPRETED
    with pytest.raises(MissingExtraError):
        LoopChoice().of_many(True)


def test_code_on_disk_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    functions = with_compiled(monkeypatch, True)
    chosen = LoopChoice().of_many(None)
    assert chosen.table == (functions["march_rows"], functions["run_program"])
    assert chosen[1:3] == (functions["follow_all"], functions["settle"])


def test_without_code_events_are_interpreted_until_the_budget_is_spent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    functions = with_compiled(monkeypatch, False)
    calls = []

    def interpreted(*arguments: Any) -> tuple[int, int, int]:
        calls.append("interpreted")
        return 1, 700, 0

    def compiled(*arguments: Any) -> tuple[int, int, int]:
        calls.append("compiled")
        return 1, 700, 0

    monkeypatch.setattr(loops, "INTERPRETED", INTERPRETED._replace(follow=interpreted))
    for name in ("py_func", "overloads", "_cache"):
        setattr(compiled, name, getattr(functions["follow_all"], name))
    functions["follow_all"] = compiled
    choice = LoopChoice(doubles=Budget(1000))
    follow = choice.of_many(None).follow
    motions = batch.Batch(*(range(5),) * 4)  # type: ignore[arg-type]
    for _ in range(3):
        follow(0, motions, 9, 1.0, batch.event_buffer(10))
    assert calls == ["interpreted", "interpreted", "compiled"]


def test_a_single_motion_imports_no_numba_before_it_has_had_many_events(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    functions = with_compiled(monkeypatch, True)
    choice = LoopChoice()
    assert choice.of_single(TURN - 1, [K]) == (batch.follow_all, [K], TURN)
    assert choice.of_single(TURN, [K]).follow is functions["follow_all"]
    monkeypatch.setattr(loops, "loaded_loop", lambda: functions)
    assert choice.of_single(0, [K]).follow is functions["follow_all"]


@pytest.mark.parametrize("there", [True, False])
def test_searches_are_compiled_where_the_event_loop_is_loaded(
    there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    functions = with_compiled(monkeypatch, there)
    choice = LoopChoice()
    assert choice.of_searches() == (batch.search_row, batch.doubt_row, False)
    monkeypatch.setattr(loops, "loaded_loop", lambda: functions)
    assert choice.of_searches().are_compiled is there
    choice.searches.events = 0
    assert choice.of_searches().search is functions["search_row"]


def test_pairs_are_compiled_for_many_events(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loops, "compiled_pairs", lambda: "compiled")
    monkeypatch.setattr(arithmetic, "interpreted_pairs", lambda: "interpreted")
    monkeypatch.setattr(arithmetic, "pairs_are_compiled", lambda: False)
    monkeypatch.setattr(arithmetic, "pairs_are_loaded", lambda: False)
    choice = LoopChoice(pairs=Budget(100))
    assert (choice.of_pairs(100), choice.of_pairs(101)) == ("interpreted", "compiled")
    assert choice.of_pairs_if_loaded() is None
    monkeypatch.setattr(arithmetic, "pairs_are_compiled", lambda: True)
    monkeypatch.setattr(arithmetic, "pairs_are_loaded", lambda: True)
    assert choice.of_pairs(1) == "compiled"
    assert choice.of_pairs_if_loaded() == "compiled"
