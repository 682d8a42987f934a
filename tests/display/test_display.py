"""Bars with rate and time left on a terminal, plain tables, and what pages of notebooks are made of."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from symosc.display.html import HEAD_ROWS, TAIL_ROWS, ends, table
from symosc.display.progress import late_bar, reporting

# --- progress ---


def test_a_function_of_the_caller_gets_the_progress() -> None:
    calls: list[tuple[float, float]] = []

    def note(done: float, total: float) -> None:
        calls.append((done, total))

    with reporting(note, 0, 9) as report, late_bar(note, "simulate", "events") as advance:
        report(4, 9)
        assert advance is not None
        advance(0.5, 7)
    assert calls == [(4, 9), (0.5, 1.0)]


# --- tables ---

# --- pages ---


@pytest.mark.parametrize("count", [0, 10, 11, 100_000])
def test_a_long_table_shows_its_ends(count: int) -> None:
    numbers = ends(count)
    root = ElementTree.fromstring(table(["i"], [[i] for i in numbers], count))
    cells = [cell.text or "" for cell in root.iter("td")]
    if count > HEAD_ROWS + TAIL_ROWS:
        assert cells.pop(HEAD_ROWS) == f"… {count - HEAD_ROWS - TAIL_ROWS:,} more"
        assert numbers == [*range(HEAD_ROWS), *range(count - TAIL_ROWS, count)]
    assert cells == [str(i) for i in numbers]
    assert len(numbers) == min(count, HEAD_ROWS + TAIL_ROWS)
