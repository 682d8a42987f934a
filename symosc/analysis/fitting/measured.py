"""Measured data of a fit: events or samples, from tables, rows, solver results and files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from symosc.base.errors import ParameterError, meant, shown
from symosc.base.exact import read_exact, unmasked
from symosc.crosschecks.reading.files import read_content
from symosc.crosschecks.reading.functions import Problem
from symosc.crosschecks.reading.names import (
    ID_COLUMN,
    USUAL_NAMES,
    Asked,
    find_text_columns,
    names_text,
    plain,
    read_column_names,
)
from symosc.crosschecks.reading.objects import as_table
from symosc.crosschecks.reading.solutions import solutions_in
from symosc.crosschecks.reading.text import plain_number
from symosc.engine.events import KIND_NAMES

KINDS = tuple(KIND_NAMES.values())
#: The column of the kinds of events, and its usual names.
KIND = "kind"
KIND_COLUMNS = {"kind", "kinds", "event", "type"}
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
    kind = None
    if isinstance(columns, Mapping):
        kind = columns.get(KIND)
    if kind is not None and not isinstance(kind, str):
        raise ParameterError(
            "columns", kind, "must be text: the name of the column that holds kind"
        )
    sample_columns = columns
    if isinstance(columns, Mapping):
        sample_columns = {name: column for name, column in columns.items() if name != KIND}
    asked = read_column_names(sample_columns)
    source_name = "data"
    if isinstance(data, str | Path):
        source_name = "standard input" if data == "-" else str(data)
        data = _content(data, kind, asked, source_name)
        if isinstance(data, _Chosen):
            return _of_columns(data.columns, data.lines)
    table = _table(data)
    if table is None:
        rows = _rows(data)
        return _of_columns(rows) if rows else _of_solution(data, asked, scene, source_name)
    return _of_columns(
        {name: table[own] for name, own in _choose(table, kind, asked, source_name).items()}
    )


class _Chosen:
    """The columns of a text file by t, kind, x and v, and the lines that they come from."""

    def __init__(self, lines: list[tuple[str, dict[str, str]]], names: Iterable[str]) -> None:
        self.lines = [line for line, _ in lines]
        self.columns = {name: [cells.get(name, "") for _, cells in lines] for name in names}
        for name in set(self.columns) - {KIND}:
            self.columns[name] = [plain_number(cell) for cell in self.columns[name]]


def _content(path: str | Path, kind: str | None, asked: Asked, source_name: str) -> Any:
    """Return the content of a file: the `_Chosen` of a text file, else objects such as tables."""
    chosen: list[str] = []  # stays empty unless `read_content` asks, as it does for a text file

    def choose(names: list[str]) -> dict[str, str]:
        columns = _choose(names, kind, asked, source_name)
        chosen[:] = columns
        return columns

    content = read_content(path, choose)
    return _Chosen(list(content), chosen) if chosen else content


def _table(data: Any) -> dict[str, Any] | None:
    """Return data as a table of columns by name, None if they are none; rows may be mappings."""
    rows = isinstance(data, list | tuple) and data and all(isinstance(row, Mapping) for row in data)
    if rows:
        names = dict.fromkeys(str(name) for row in data for name in row)
        return {name: [row.get(name) for row in data] for name in names}
    return as_table(data)


def _choose(
    names: Iterable[str], kind: str | None, asked: Asked, source_name: str
) -> dict[str, str]:
    """Return which of the column `names` are t and kind, or else t, x and perhaps v."""
    known = list(map(str, names))
    if kind is None:
        kinds = [name for name in known if name == KIND]
        kinds = kinds or [name for name in known if plain(name) in KIND_COLUMNS]
    else:
        kinds = [name for name in known if name == kind]
    if kind is not None and not kinds:
        raise ParameterError(
            "column", kind, f"not found in {source_name}; its columns are {names_text(known)}"
        )
    if not kinds:
        return _sample_names(known, asked, source_name)
    times = [name for name in known if name == asked.get("t", "t")]
    if "t" not in asked:
        times = times or [name for name in known if plain(name) in USUAL_NAMES["t"]]
    if len(times) != 1:
        raise ParameterError("data", f"columns {names_text(known)}", ALLOWED)
    return {"t": times[0], KIND: kinds[0]}


def _sample_names(there: list[str], asked: Asked, source_name: str) -> dict[str, str]:
    """Return which of the columns that are `there` are t, x and, if it has a usual name, v."""
    with_v = "v" in asked or any(plain(name) in USUAL_NAMES["v"] for name in there)
    numbered = there == [str(i + 1) for i in range(len(there))]
    try:
        columns = find_text_columns(
            there, asked if with_v or numbered else {**asked, "v": None}, source_name
        )
    except ParameterError as error:
        if asked:
            raise
        about = f"columns {names_text(there)}"
        raise ParameterError("data", about, f"{ALLOWED} ({error})") from None
    columns.pop(ID_COLUMN, None)
    return columns


def _rows(data: Any) -> dict[str, list[Any]]:
    """Return the columns of rows (t, kind), (t, x) or (t, x, v); none if data are no such rows."""
    rows: list[tuple[Any, ...]] = []
    try:
        for row in unmasked("data", data):
            if isinstance(row, str):  # a row of letters, which may come without end
                return {}
            rows.append(tuple(row))
    except (TypeError, ValueError, KeyError):
        return {}
    if {len(row) for row in rows} not in ({2}, {3}) or isinstance(data, bytes | bytearray):
        return {}
    cells = [cell for row in rows for cell in row]
    if any(np.ndim(cell) for cell in cells if not isinstance(cell, str)):
        return {}
    _, second_cell, *_ = rows[0]
    names: tuple[str, ...] = ("t", "x", "v")
    if isinstance(second_cell, str) and not _is_number(second_cell):
        names = ("t", KIND)
    columns = map(list, zip(*rows, strict=True))
    return dict(zip(names, columns, strict=False))  # rows (t, x) have no v


def _is_number(text: str) -> bool:
    """Return whether a cell of text is a number, and no kind."""
    try:
        read_exact("x", text)
    except ParameterError:
        return False
    return True


def _of_solution(data: Any, asked: Asked, scene: Problem, source_name: str) -> Measured:
    """Return the samples in an object that `symosc check` reads, such as a solver's result."""
    try:
        solutions = solutions_in(data, asked, scene, source_name)
    except ParameterError as error:
        raise ParameterError("data", shown(data), f"{ALLOWED} ({error})") from None
    if len(solutions) > 1:
        allowed = "are several solutions; a fit takes one"
        raise ParameterError("data", f"{len(solutions)} solutions", allowed)
    samples = solutions[0]
    states = [samples.x] if samples.lacks_v else [samples.x, samples.v]
    return Measured(samples.t, None, np.array(states))


def _of_columns(columns: Mapping[str, Any], lines: list[str] | None = None) -> Measured:
    """Return checked columns as `Measured`; `lines` are those of a file that they come from."""
    cells = {name: list(unmasked(name, column)) for name, column in columns.items()}
    if not cells["t"]:
        raise ParameterError("data", "no rows", ALLOWED)
    if len({len(column) for column in cells.values()}) > 1:
        lengths = ", ".join(f"{name} of length {len(column)}" for name, column in cells.items())
        raise ParameterError("data", lengths, "must have columns of one length")
    place = partial(_place, lines)

    def numbers(name: str) -> list[float]:
        return [float(read_exact(place(name, row), cell)) for row, cell in enumerate(cells[name])]

    t = np.array(numbers("t"))
    if KIND not in cells:
        return Measured(t, None, np.array([numbers(name) for name in ("x", "v") if name in cells]))
    for row, kind in enumerate(cells[KIND]):
        if not isinstance(kind, str) or kind not in KINDS:
            allowed = f"must be one of {', '.join(KINDS)}{meant(str(kind), KINDS)}"
            raise ParameterError(place(KIND, row), kind, allowed)
    return Measured(t, np.array(cells[KIND], dtype=object), None)


def _place(lines: list[str] | None, name: str, row: int) -> str:
    """Return how a message names a cell: by its row, and its line if it comes from a file."""
    return f"{name}[{row}]" if lines is None else f"{name}[{row}] ({lines[row]})"
