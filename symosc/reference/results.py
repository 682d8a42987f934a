"""Read a solver's events: a table of all cases or one for each case, in any format, or JSON.

`formats.txt`, the README of a set of cases, has the rules.
"""

from __future__ import annotations

import json
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, ResultError, brief
from symosc.base.exact import read_exact
from symosc.base.files import read_path
from symosc.crosschecks.reading.files import PACKED, SUFFIXES, read_file, suffix_of
from symosc.crosschecks.reading.names import ID_COLUMN, KIND_COLUMN, USUAL_NAMES, plain
from symosc.crosschecks.reading.objects import table_in
from symosc.crosschecks.reading.text import TextRows, is_number, plain_number, read_rows
from symosc.simulation.tangents import NAMES

EVENT_KINDS = ("cross", "stick", "slip", "graze")
#: The kind of a line that says how far a case was followed.
FOLLOWED_TO = "end"
#: What a case's file is called in a folder of its own, as `symosc cases` writes it.
EVENTS_FILE = "events.csv"
#: The table of a set of cases; beside results it is not one of them.
CASES_TABLE = "cases.csv"
#: Columns of derivatives: dt_mu1, dx_mu1, ...
CHANGES = tuple(f"d{coordinate}_{name}" for name in NAMES for coordinate in "tx")
ENCLOSURES = ("t_low", "t_high", "x_low", "x_high")
#: The columns that are read; others are ignored.
COLUMNS = ("case", "t", "x", "kind", "boundary", "seconds", *ENCLOSURES, *CHANGES)
#: Other names of them.
USUAL_COLUMNS = {
    "t": USUAL_NAMES["t"],
    "x": USUAL_NAMES["x"],
    "kind": USUAL_NAMES[KIND_COLUMN],
    "case": USUAL_NAMES[ID_COLUMN],
    "boundary": {"belt", "beltnumber", "border"},
}


class GivenEvent(NamedTuple):
    """An event from a solver's file: `changes` has its derivatives.

    X is None and boundary 0 if the file lacks them.
    """

    t: Fraction
    x: Fraction | None
    kind: str
    boundary: int
    changes: Mapping[str, float] = {}


@dataclass
class CaseResult:
    """A solver's result for a case: its events in order of time, and its end time."""

    events: list[GivenEvent] = field(default_factory=list)
    seconds: float | None = None
    note: str = ""  # why it has no events
    end: Fraction | None = None


Results = dict[str, CaseResult]


class FilePlace(NamedTuple):
    """A place in a file of results, for messages: a line of it, or an event."""

    path: Path
    where: str

    def wrong(self, message: str) -> ResultError:
        """Return the exception that says what is wrong here."""
        return ResultError(str(self.path), f"{self.where}: {message}")


class Entry(NamedTuple):
    """An event, or the end of a run, as it stands in a file: the name of its case, and its cells
    by the names of their columns, without empty ones.
    """

    case: str
    place: FilePlace
    cells: Record


def read_results(path: str | Path, names: Container[str]) -> Results:
    """Return results by case, from one file, or from a folder with NAME.csv or NAME/events.csv for
    each case.

    JSON has the cases by name; any other file is a table in a format that `symosc check` reads.
    """
    source = Path(read_path(path))
    if not source.exists():
        raise ResultError(str(source), "does not exist")
    results: Results = {}
    if source.is_dir():
        for file, name in _files_of_cases(source, names):
            if name in results:
                raise ResultError(str(file), f"is the second file with results for {name}")
            results[name] = CaseResult()
            _add_entries(results, _table_entries(file, name))
    elif source.suffix.lower() == ".json":
        _add_entries(results, _json_entries(source))
    elif suffix_of(source) in SUFFIXES:
        _add_entries(results, _table_entries(source, None))
    else:
        endings = f"{', '.join(SUFFIXES)} and perhaps {', '.join(PACKED)}"
        raise ResultError(str(source), f"must end in {endings}, or be a folder of tables")
    for name in results:
        if name not in names:
            problem = f"has results for {brief(name)!r}, which is no case of this set"
            raise ResultError(str(source), problem)
    if not results:
        problem = "has no results; a folder has them in NAME.csv or NAME/events.csv for each case"
        raise ResultError(str(source), problem)
    for result in results.values():
        result.events.sort(key=lambda event: event.t)
    return results


def _files_of_cases(folder: Path, names: Container[str]) -> Iterator[tuple[Path, str]]:
    """Yield each file of a folder that has results of a case, with the name of the case."""
    for path in sorted(folder.iterdir()):
        if path.is_dir():
            file = path / EVENTS_FILE
            name = path.name
        else:
            file = path
            name = path.stem
        is_table = suffix_of(file) in SUFFIXES and suffix_of(file) != ".json"
        if not is_table or not file.is_file() or path.name == CASES_TABLE:
            continue
        if name not in names:
            if file.suffix.lower() != ".csv":  # notes, or another set's
                continue
            problem = f"is named {brief(name)!r}, which is no case of this set"
            raise ResultError(str(file), problem)
        yield file, name


def _text_of(path: Path) -> str:
    """Return the text of a file in UTF-8, with or without a byte order mark."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ResultError(str(path), f"cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise ResultError(str(path), "cannot be read: it is not text in UTF-8") from None


def _table_entries(path: Path, case: str | None) -> Iterator[Entry]:
    """Yield the entries of a table in a file of any format that `symosc check` reads.

    `case` is the name of the case that it is for, None if it has a column of names.
    """
    reader = partial(read_rows, is_header=lambda names: "kind" in _columns_of(names))
    try:
        names, rows = read_file(path, str(path), _named_rows, reader)
    except ParameterError as error:
        raise ResultError(str(path), error.allowed) from None
    columns = _columns_of(names)
    _check_columns(path, names, columns, case is None)
    for number, cells in rows:
        read = {
            column: _plain_cell(cells[places[0]])
            for column, places in columns.items()
            if cells[places[0]] not in (None, "")
        }
        yield Entry(case or str(read.get("case", "")), FilePlace(path, number), read)


def _named_rows(content: Any) -> tuple[list[str], list[tuple[str, Sequence[Any]]]]:
    """Return the names of the columns of a table, and its rows, each with its place in the file."""
    if isinstance(content, TextRows):
        return content.names, [(f"line {number}", cells) for number, cells in content.rows]
    table = table_in(content, {}, None, "the file")
    if table is None:
        return [], []
    names = list(table.headers[0])
    columns = table.load({str(place): place for place in range(len(names))})
    rows = zip(*(_cells_of(column) for column in columns.values()), strict=True)
    return names, [(f"row {number}", row) for number, row in enumerate(rows, 1)]


def _cells_of(column: Any) -> list[Any]:
    """Return a column as numbers and text; None for NaN, which tables have for an empty cell."""
    cells = np.ravel(np.asarray(column)).tolist()
    return [None if cell != cell else cell for cell in cells]


def _plain_cell(cell: Any) -> Any:
    """Return a cell with a decimal point if it is a number that a file writes otherwise."""
    if isinstance(cell, str) and is_number(cell):
        return plain_number(cell)
    return cell


def _columns_of(header: Sequence[str]) -> dict[str, list[int]]:
    """Return the places of the columns that are read, by their names in COLUMNS.

    One that does not stand there under its own name has a usual one, such as time for t.
    """
    columns: dict[str, list[int]] = {}
    for place, name in enumerate(header):
        if name.strip() in COLUMNS:
            columns.setdefault(name.strip(), []).append(place)
    taken = {place for places in columns.values() for place in places}
    enclosed = {column for column in "tx" if f"{column}_low" in columns}
    for column, usual in USUAL_COLUMNS.items():
        if column in columns or column in enclosed:
            continue
        places = [
            place
            for place, name in enumerate(header)
            if place not in taken and plain(name) in usual
        ]
        if places:
            columns[column] = places
    return columns


def _check_columns(
    path: Path, header: Sequence[str], columns: Mapping[str, Sequence[int]], needs_case: bool
) -> None:
    """Raise ResultError if a needed column is missing, or one that is read is there twice."""
    needed = ["kind"]
    if needs_case:
        needed.append("case")
    if not {"t_low", "t_high"} <= columns.keys():
        needed.append("t")
    for column in needed:
        if column not in columns:
            listed = brief(", ".join(header))
            raise ResultError(str(path), f"has no column {column}; its columns are {listed}")
    for column, places in columns.items():
        if len(places) > 1:
            found = " and ".join(repr(header[place]) for place in places)
            raise ResultError(str(path), f"has two columns for {column}: {found}")


def _json_entries(path: Path) -> Iterator[Entry]:
    """Yield the entries of a JSON file: names of cases, each with its events and seconds."""
    try:
        # Numbers stay text, so that they keep all their digits.
        content = json.loads(_text_of(path), parse_float=str, parse_int=str, parse_constant=str)
    except RecursionError:
        problem = "cannot be read: its brackets are nested too deeply"
        raise ResultError(str(path), problem) from None
    except ValueError as error:
        raise ResultError(str(path), f"cannot be read: {error}") from None
    if not isinstance(content, dict):
        raise ResultError(str(path), "must be an object: names of cases, and their results")
    for case, result in content.items():
        place = FilePlace(path, brief(case))
        events = None
        if isinstance(result, dict):
            events = result.get("events")
        if not isinstance(events, list):
            raise place.wrong("it must be an object with a list 'events'")
        about = {"kind": FOLLOWED_TO, "seconds": result.get("seconds")}
        yield Entry(case, place, _without_empty(about))
        for number, event in enumerate(events, 1):
            place = FilePlace(path, f"{brief(case)}, event {number}")
            if not isinstance(event, dict):
                raise place.wrong("it must be an object with t and kind")
            yield Entry(case, place, _without_empty(event))


def _without_empty(cells: Record) -> Record:
    return {name: cell for name, cell in cells.items() if cell not in (None, "")}


def _add_entries(results: Results, entries: Iterator[Entry]) -> None:
    """Add entries to the results of their cases: events, times where runs ended, and seconds."""
    for case, place, cells in entries:
        result = results.setdefault(case, CaseResult())
        seconds = _number(place, cells, "seconds")
        if seconds is not None:
            if seconds < 0:
                raise place.wrong(f"seconds = {cells['seconds']}: must be >= 0")
            result.seconds = max(result.seconds or 0.0, float(seconds))
        if str(cells.get("kind", "")).lower() != FOLLOWED_TO:
            result.events.append(_event(place, cells))
            continue
        end = _coordinate(place, cells, "t")
        if end is not None:
            result.end = max(result.end or end, end)


def _event(place: FilePlace, cells: Record) -> GivenEvent:
    """Return the event that stands at a place."""
    kind = str(cells.get("kind", "")).lower()
    if kind not in EVENT_KINDS:
        words = ", ".join((*EVENT_KINDS, FOLLOWED_TO))
        raise place.wrong(f"kind is {brief(kind)!r}, and must be one of {words}")
    t = _coordinate(place, cells, "t")
    if t is None:
        raise place.wrong("it has no t")
    boundary = _number(place, cells, "boundary") or 0
    if boundary not in (0, 1, 2):
        raise place.wrong(f"boundary is {brief(str(cells['boundary']))!r}, and must be 1 or 2")
    changes = {}
    for name in CHANGES:
        change = _number(place, cells, name)
        if change is not None:
            changes[name] = float(change)
    return GivenEvent(t, _coordinate(place, cells, "x"), kind, int(boundary), changes)


def _coordinate(place: FilePlace, cells: Record, name: str) -> Fraction | None:
    """Return t or x: the cell of this name, or the middle between name_low and name_high; None if
    both are missing.
    """
    low = _number(place, cells, f"{name}_low")
    high = _number(place, cells, f"{name}_high")
    if low is not None and high is not None:
        return (low + high) / 2
    return _number(place, cells, name)


def _number(place: FilePlace, cells: Record, name: str) -> Fraction | None:
    """Return the number in a cell; None if the cell is missing."""
    value: Any = cells.get(name)
    if value is None:
        return None
    try:
        return read_exact(name, value)
    except ParameterError as error:
        raise place.wrong(str(error)) from None
