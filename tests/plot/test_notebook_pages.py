"""What pages of notebooks are made of."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from symosc.plot.notebooks import HEAD_ROWS, TAIL_ROWS, rows_to_show, table


@pytest.mark.parametrize("count", [1, 10, 11, 100_000])
def test_a_long_table_shows_its_ends(count: int) -> None:
    numbers = rows_to_show(count)
    root = ElementTree.fromstring(table(["i"], count, lambda i: [i]))
    cells = [cell.text or "" for cell in root.iter("td")]
    if count > HEAD_ROWS + TAIL_ROWS:
        assert cells.pop(HEAD_ROWS) == f"… {count - HEAD_ROWS - TAIL_ROWS:,} more"
        assert numbers == [*range(HEAD_ROWS), *range(count - TAIL_ROWS, count)]
    assert cells == [str(i) for i in numbers]
    assert len(numbers) == min(count, HEAD_ROWS + TAIL_ROWS)
