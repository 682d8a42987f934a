"""Measured data of a fit: events or samples, from tables, rows, solver results and files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from symosc.base.errors import ParameterError, shown
from symosc.base.exact import read_exact, unmasked
from symosc.base.files import STDOUT
from symosc.crosschecks.frames import Problem
from symosc.crosschecks.reading.files import read_file
from symosc.crosschecks.reading.names import ID_COLUMN, KIND_COLUMN, Asked, read_column_names
from symosc.crosschecks.reading.objects import table_in
from symosc.crosschecks.reading.solutions import samples_of
from symosc.crosschecks.samples import check_kind

#: What columns hold.
ROLES = ("t", KIND_COLUMN, "x", "v", ID_COLUMN)
#: What data are, for messages.
ALLOWED = (
    "must have the columns t and kind, or t and x, or t, x and v, or be rows of these; "
    "columns says how they are called"
)


@dataclass(frozen=True)
class Measured:
    """Measured data: times, and either kinds of events or positions, perhaps with velocities."""

    t: np.ndarray
    kinds: np.ndarray | None
    states: np.ndarray | None  # (1 or 2, n)
    weighted: bool = False  # whether their standard deviations are known

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of what is measured: "t" of events, or "x", or "x" and "v"."""
        if self.states is None:
            return ("t",)
        return ("x", "v")[: len(self.states)]

    @property
    def times(self) -> np.ndarray:
        """The time of each residual."""
        return np.tile(self.t, len(self.columns))

    def thinned(self, most: int) -> Measured:
        """Return every n-th sample, so that about `most` are left; events are all kept."""
        if self.states is None:
            return self
        step = -(-len(self.t) // most)
        if step == 1:
            return self
        return Measured(self.t[::step], None, self.states[:, ::step], self.weighted)


def read_measured(data: Any, columns: Mapping[str, str | None] | None, scene: Problem) -> Measured:
    """Return measured data of any form; raise ParameterError if columns are missing or wrong.

    `columns` says how the columns t, kind, x and v are called, `scene` what is fitted.
    """
    asked = read_column_names(columns, ROLES)
    use = partial(_measured_in, asked=asked, scene=scene)
    if not isinstance(data, str | Path):
        return use(data, where="data")
    where = "standard input" if data == STDOUT else str(data)
    return read_file(data, where, partial(use, where=where))


def _measured_in(data: Any, asked: Asked, scene: Problem, where: str) -> Measured:
    """Return the events or samples in a file's content, or in an object."""
    if isinstance(data, Iterator):
        data = _rows_in(data)
    table = table_in(unmasked("data", data), asked, scene, where)
    if table is None:
        raise ParameterError("data", shown(data), ALLOWED)
    columns = table.chosen(asked, where, needs_v=False, with_kinds=True)
    if not table.are_padded and np.ndim(columns.get("x", ())) < 2:
        columns.pop(ID_COLUMN, None)
        return _of_columns(columns)
    solutions = samples_of(table, columns, scene, where)
    if len(solutions) > 1:
        allowed = "are several solutions; a fit takes one"
        raise ParameterError("data", f"{len(solutions)} solutions", allowed)
    samples = solutions[0]
    states = [samples.x] if samples.lacks_v else [samples.x, samples.v]
    return Measured(samples.t, None, np.array(states))


def _rows_in(data: Iterator[Any]) -> list[Any]:
    """Return the rows that an iterator yields; numbers and letters, which may come without end, are
    none.
    """
    rows = []
    for row in data:
        if isinstance(row, str) or not hasattr(row, "__len__"):
            raise ParameterError("data", shown(row), ALLOWED)
        rows.append(row)
    return rows


def _of_columns(columns: Mapping[str, Any]) -> Measured:
    """Return checked columns as `Measured`."""
    cells = {name: list(unmasked(name, column)) for name, column in columns.items()}
    if not cells["t"]:
        raise ParameterError("data", "no rows", ALLOWED)
    if len({len(column) for column in cells.values()}) > 1:
        lengths = ", ".join(f"{name} of length {len(column)}" for name, column in cells.items())
        raise ParameterError("data", lengths, "must have columns of one length")

    def numbers(name: str) -> list[float]:
        return [float(read_exact(f"{name}[{row}]", cell)) for row, cell in enumerate(cells[name])]

    t = np.array(numbers("t"))
    if KIND_COLUMN not in cells:
        return Measured(t, None, np.array([numbers(name) for name in ("x", "v") if name in cells]))
    for row, kind in enumerate(cells[KIND_COLUMN]):
        check_kind(row, kind)
    return Measured(t, np.array(cells[KIND_COLUMN], dtype=object), None)
