"""What pages are made of: tables that are cut, curves that stay inside their frame."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest

from symosc.display.html import HEAD_ROWS, PICTURE_HEIGHT, PICTURE_WIDTH, TAIL_ROWS, curve, ends, table

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("count", [0, 1, 9, 10, 11, 12, 100_000])
def test_a_long_table_shows_its_ends(count: int) -> None:
    numbers = ends(count)
    root = ElementTree.fromstring(table(["i"], [[i] for i in numbers], count))
    cells = [cell.text or "" for cell in root.iter("td")]
    if count <= HEAD_ROWS + TAIL_ROWS:
        assert cells == [str(i) for i in range(count)]
        return
    left_out = cells.pop(HEAD_ROWS)
    assert left_out == f"… {count - HEAD_ROWS - TAIL_ROWS:,} more"
    assert cells == [str(i) for i in (*range(HEAD_ROWS), *range(count - TAIL_ROWS, count))]


@pytest.mark.parametrize("seed", range(6))
def test_a_curve_stays_inside_its_frame(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size, shift = 10.0 ** rng.integers(-200, 200), 10.0 ** rng.integers(-3, 9)
    x, y = rng.normal(size=(2, 900)) * size + shift
    y[rng.random(900) < 0.1] = np.nan
    root = ElementTree.fromstring(curve("a & b", x, y, [(float(np.nanmax(x)), float(np.nanmin(y)))]))
    path = root.find(f"{SVG}path").attrib["d"]  # type: ignore[union-attr]
    points = np.array([pair.split() for pair in path.replace("M", "L").split("L") if pair], dtype=float)
    assert len(points) > 400
    assert path.count("M") > 10  # it is broken where y is not known
    assert (points >= 0).all()
    assert (points <= [PICTURE_WIDTH, PICTURE_HEIGHT]).all()
    assert root.find(f"{SVG}title").text == "a & b"  # type: ignore[union-attr]


def test_what_is_no_curve_has_no_picture() -> None:
    nan = float("nan")
    assert [curve("", *each) for each in (([], []), ([1.0], [2.0]), ([1.0, 2.0], [nan, 1.0]))] == ["", "", ""]
    assert "M6.0 65.0L254.0 65.0" in curve("", [0, 1], [5, 5])  # a constant one is in the middle
