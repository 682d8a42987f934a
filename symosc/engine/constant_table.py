"""The constants of many parameter sets at once, one table row each.

The formulas are those of `symosc.engine.flow.constants`, on columns of pairs (`symosc.kernels.pair_columns`).
A row of the table has the fields of `Constants`: compiled functions take either.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import atan2, pi
from typing import Any

import numpy as np

from symosc.engine.flow import BeltConstants, Constants, MarchConstants, constants
from symosc.kernels.pair_columns import PairColumn, as_double, each
from symosc.model import Parameters

# Numbers of these sizes neither overflow nor underflow in any product on the way.
SMALLEST_IN_COLUMNS, LARGEST_IN_COLUMNS = 1e-20, 1e20

NESTED = {"belt1": BeltConstants, "belt2": BeltConstants, "march": MarchConstants, "stride": MarchConstants}


def _row_type(kind: Any) -> np.dtype[Any]:
    """Return the numpy row type for a NamedTuple of numbers, flags (0.0 or 1.0) and nested tuples."""
    return np.dtype([(name, _row_type(NESTED[name]) if name in NESTED else np.float64) for name in kind._fields])


ROW = _row_type(Constants)


class ConstantRows(Sequence[Constants]):
    """A table of constants for interpreted code: indexing returns a row as `Constants` with Python's floats."""

    def __init__(self, table: np.ndarray) -> None:
        self.table = table
        self._last: tuple[int, Constants] | None = None

    def __len__(self) -> int:
        return len(self.table)

    def __getitem__(self, i: Any) -> Any:
        if self._last is None or self._last[0] != i:
            values = dict(zip(Constants._fields, self.table[i].item(), strict=True))
            for name, kind in NESTED.items():
                values[name] = kind(*values[name])
            self._last = int(i), Constants(**values)
        return self._last[1]


class ParameterColumns:
    """Many parameter sets, a column of pairs for each parameter; forces are computed from these as in `Parameters`."""

    A, belt = Parameters.A, Parameters.belt

    def __init__(self, columns: dict[str, PairColumn]) -> None:
        vars(self).update(columns)


def table_of(rows: Iterable[Constants]) -> np.ndarray:
    """Return a table with a row for each of the given constants."""
    return np.array([tuple(row) for row in rows], dtype=ROW)


def constant_table(
    columns: dict[str, PairColumn], count: int, alone: Callable[[int], Constants], march_rows: Callable[..., None]
) -> np.ndarray:
    """Return the constants of `count` parameter sets; `alone(i)` computes set i exactly where columns may be wrong."""
    doubts = np.zeros(count, dtype=bool)
    given = {name: PairColumn(column.hi, column.lo, doubts) for name, column in columns.items()}
    for column in given.values():
        size = abs(column.hi)
        doubts |= (size != 0.0) & ~((size >= SMALLEST_IN_COLUMNS) & (size <= LARGEST_IN_COLUMNS))
    table = np.zeros(count, dtype=ROW)
    with np.errstate(all="ignore"):
        K = constants(ParameterColumns(given), as_double, np.sqrt, each(atan2), pi)  # type: ignore[arg-type]
    _fill(table, K)
    for i in np.flatnonzero(doubts).tolist():
        table[i] = tuple(alone(i))
    marches = np.zeros((count, 2, len(MarchConstants._fields)))
    march_rows(table, marches)
    for which, name in enumerate(("march", "stride")):
        for n, field in enumerate(MarchConstants._fields):
            table[name][field] = marches[:, which, n]
    return table


def _fill(table: np.ndarray, values: Any) -> None:
    """Write the fields of a named tuple of columns, and of the tuples in it, into the fields of the same names."""
    for name, value in zip(values._fields, values, strict=True):
        if name in NESTED:
            _fill(table[name], value)
        else:
            table[name] = value
