"""Sweeps of a moment for tests, made-up results to draw, and what it means that two results are the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from symosc.sweeps.output import dataset_of
from symosc.sweeps.plan import read_plan

#: 24 motions of two periods each.
SCENE = "fig9"
OVER = {"Omega": "3:5:6", "FN": [5, 10, "12.5", 15]}
OPTIONS: dict[str, Any] = {
    "t_end": "6T",
    "skip": "4T",
    "record": ("word", "events", "x", "section:2"),
}


def identical(one: Any, other: Any) -> None:
    """Fail unless two datasets are the same to the last bit.

    Values, types, coordinates and attributes.
    """
    assert one.identical(other)
    for name in {*one.variables} | {*other.variables}:
        assert one[name].dtype == other[name].dtype, name
        assert one[name].values.tobytes() == other[name].values.tobytes(), name


def in_small_chunks(monkeypatch: pytest.MonkeyPatch, motions: int = 4) -> None:
    """Let every chunk have so many motions."""
    monkeypatch.setattr("symosc.sweeps.sweep.FIRST_CHUNK", motions)
    monkeypatch.setattr("symosc.sweeps.sweep.MOST_CHUNK", motions)


def made_up(
    over: Any, *, starts: Any = None, **columns: Callable[[dict[str, np.ndarray]], Any]
) -> Any:
    """Return a result whose columns are functions of what is swept; nothing is simulated."""
    plan = read_plan(SCENE, over, [*columns], "60T", "40T", starts)
    cells = plan.cells(0, len(plan))
    found = {name: np.asarray(column(cells)) for name, column in columns.items()}
    found.setdefault("status", np.full(len(plan), "t_end"))
    if "section" in found:
        plan = replace(plan, sections=found["section"].shape[1])
    return dataset_of(plan, found)
