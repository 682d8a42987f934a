"""Plain tables are those of tabulate, over random cells."""

from __future__ import annotations

import random

import pytest
from tabulate import tabulate

from symosc.display.tables import plain_table

CELLS = ["", "x", "P4645", "Omega1 -> belt1", "1e-15", "3", "-4.0", "1.5e-07", "0.25", "12345.678", "nan", "-17", "…"]


@pytest.mark.parametrize("seed", range(40))
def test_plain_tables_are_those_of_tabulate(seed: int) -> None:
    rng = random.Random(seed)
    heads = rng.sample(["t", "x", "kind", "from -> to", "t error", "belt"], rng.randint(1, 6))
    rows = [[rng.choice(CELLS) for _ in heads] for _ in range(rng.randint(1, 9))]
    decimals = rng.sample(heads, rng.randint(0, len(heads)))
    align = ["decimal" if head in decimals else "left" for head in heads]
    expected = tabulate(rows, heads, tablefmt="simple", disable_numparse=True, colalign=align)
    assert plain_table(heads, rows, decimals) == expected


def test_a_table_without_rows_has_its_head() -> None:
    assert plain_table(["claim", "verdict"], []).splitlines()[0].split() == ["claim", "verdict"]
