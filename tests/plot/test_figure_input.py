"""Bad input of figures: one clear line each, at once, and nothing half-written."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from bad_values import refused
from effort import at_most

import symosc
from symosc import load_scene, simulate

P = load_scene("fig5").parameters


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("panels", ["", "z", "aa", 5, ["a"], True, b"a", {}, "A"]),
        ("boundary", [0, 3, True, "1", [1], 1.0, np.array([1, 2])]),
        ("columns", [0, 3, True, "1", None, 1.0]),
        ("t_end", ["", "x", float("nan"), True, -1, 1j, []]),
    ],
)
def test_options_of_a_figure(name: str, values: list[Any]) -> None:
    for value in values:
        refused(lambda value=value: symosc.plot.figure("fig5", **{name: value}), name)  # type: ignore[misc]


def test_a_figure_of_too_many_events_is_refused_at_once() -> None:
    with at_most(10_000_000):
        message = refused(lambda: symosc.plot.figure("fig9", t_end="1e7"), "t_end")
    assert "earlier end" in message
    long = simulate("fig9", max_events=symosc.plot.MOST_DRAWN_EVENTS + 1, t_end=10**7)
    refused(lambda: symosc.plot.figure(long), "subject")


def test_what_cannot_be_saved(tmp_path: Any) -> None:
    refused(lambda: symosc.plot.save(None, tmp_path / "a.pdf"), "drawing")
    refused(lambda: symosc.plot.save(symosc.plot.figure("fig6", panels="a"), None), "path")  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []
