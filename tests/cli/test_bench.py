"""`symosc bench`: what it runs and prints; the measuring itself is replaced, it takes minutes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

import pytest
from cli_runs import good

from symosc.bench import cases, speed, work


def test_json_of_all_that_was_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")

    def measured(name: str) -> Callable[..., dict[str, Any]]:
        def run(progress: Callable[..., Iterable[int]], quick: bool = False, cases: Any = None) -> dict[str, Any]:
            found = {"name": name, "quick": quick, "steps": list(progress([1, 2])), "empty": float("nan")}
            return found | {"ok": True, "machine": None, "scores": [], "ours": []}

        return run

    for name, module in {"speed": speed, "work": work, "hard": cases}.items():
        monkeypatch.setattr(module, "run", measured(name))
    data = json.loads(good("bench", "--json"))
    assert list(data) == ["quick", "speed", "work_precision"]
    assert (data["speed"]["name"], data["speed"]["quick"]) == ("speed", False)
    assert (data["work_precision"]["steps"], data["work_precision"]["empty"]) == ([1, 2], None)
    assert list(json.loads(good("bench", "--json", "--hard", "--quick"))) == ["quick", "hard"]
