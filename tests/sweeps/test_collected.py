"""Columns that are filled chunk by chunk: the same in whatever order the chunks come."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from symosc.sweeps.collected import Collected


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_the_chunks_does_not_matter(seed: int) -> None:
    rng, count = np.random.default_rng(seed), 40
    whole = {
        "word": rng.choice(["", "P32", "P3212", "P2"], count),
        "events": rng.integers(0, 99, count),
        "section": rng.normal(size=(count, 3, 2)),
    }
    cuts = [0, *sorted(rng.choice(np.arange(1, count), 4, replace=False)), count]
    chunks = list(pairwise(cuts))
    found = Collected(count)
    for i in rng.permutation(len(chunks)):
        begin, end = chunks[i]
        found.fill(begin, end, {name: column[begin:end] for name, column in whole.items()})
    columns = found.columns()
    assert columns.keys() == whole.keys()
    for name, column in whole.items():
        assert columns[name].dtype == column.dtype
        assert np.array_equal(columns[name], column)
