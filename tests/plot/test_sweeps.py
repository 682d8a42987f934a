"""Figures of sweeps and ensembles.

What is drawn is what was recorded, told apart without colours.
"""

from __future__ import annotations

import numpy as np
import pytest
from bad_values import refused
from small_sweeps import made_up

from symosc import plot
from symosc.plot.sweeps import MOST_CLASSES, borders, classes_of

pytest.importorskip("xarray")


@pytest.mark.parametrize("seed", [0, 3])
def test_cells_have_the_class_of_their_value(seed: int) -> None:
    rng = np.random.default_rng(seed)
    words = rng.choice(
        ["P32", "P2", "", "P56", *(f"P{i}" for i in range(100, 100 + 5 * seed))], (12, 9)
    )
    doubt = rng.random(words.shape) < 0.1
    codes, looks = classes_of(words, doubt)
    names = [name for name, _, _ in looks]
    assert len(names) <= MOST_CLASSES + 1
    for word, code, undecided in zip(words.ravel(), codes.ravel(), doubt.ravel(), strict=True):
        name = names[code]
        assert name == ("undecidable" if undecided else word or "no event") or name.endswith(
            " others"
        )
    kept = [name for name in names if name != "undecidable" and not name.endswith(" others")]
    counts = [np.sum(words == ("" if name == "no event" else name)) for name in kept]
    assert counts == sorted(counts, reverse=True)  # the rarest are the others


@pytest.mark.parametrize("seed", range(2))
def test_borders_are_where_the_class_changes(seed: int) -> None:
    codes = np.random.default_rng(seed).integers(0, 3, (6, 5))
    lines = borders(np.arange(7.0), np.arange(6.0), codes)
    assert len(lines) == np.sum(codes[1:] != codes[:-1]) + np.sum(codes[:, 1:] != codes[:, :-1])
    for (x1, y1), (x2, y2) in lines:
        middle = np.array([x1 + x2, y1 + y2]) / 2
        step = np.array([y2 - y1, x2 - x1]) / 2
        (a, b) = np.floor(middle - step).astype(int)
        (c, d) = np.floor(middle + step).astype(int)
        assert codes[a, b] != codes[c, d]


def test_only_starts_are_a_basin() -> None:
    refused(
        lambda: plot.basin_figure(made_up({"k": "1:6:3", "FN": "1:2:2"}, sticks=lambda c: c["k"])),
        "dataset",
    )
