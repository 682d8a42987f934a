"""What the ways to search for a contact cost."""

from __future__ import annotations

import pytest

from symosc.bench import gains


@pytest.mark.parametrize("scene", ["fig5", "fig9"])
def test_marching_saves_evaluations_and_strides_save_looks(scene: str) -> None:
    bound, short, strides = (gains._search(scene, way, 40) for way in gains.SEARCHES)
    flights = 0.5 if scene == "fig5" else 1.0  # half of fig5's events are ends of sticks
    assert bound["flow"] > 2.5 * flights
    assert short["flow"] < 1.3 * flights + 0.1
    assert strides["flow"] == pytest.approx(short["flow"], abs=0.1)
    assert strides["looks"] < 0.75 * short["looks"]


def test_the_table_has_a_row_for_each_way_and_function() -> None:
    search = [gains._search("fig9", way, 5) for way in gains.SEARCHES]
    functions = [{"name": "exp", "in_turn": [14.6, 41.8], "in_arrays": [8.5, 2.6]}]
    lines = gains.table({"search": search, "functions": functions}).splitlines()
    assert sum(line.startswith("fig9") for line in lines) == len(gains.SEARCHES)
    assert any(line.split() == ["exp", "14.6", "41.8", "8.5", "2.6"] for line in lines)
    assert "own" not in gains.table({"search": search, "functions": []})
