"""Read a solver's events, from any kind of file that `symosc check` reads: one file per case, or
one for all.

`formats.txt` has the rules.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import suppress
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
from symosc.crosschecks.reading.files import SUFFIXES, read_content, suffix_of
from symosc.crosschecks.reading.names import ID_COLUMN, USUAL_NAMES, plain
from symosc.crosschecks.reading.objects import as_table
from symosc.crosschecks.reading.text import plain_number
from symosc.simulation.tangents import NAMES

EVENT_WORDS = ("cross", "stick", "slip", "graze")
#: The kind of a line that says how far a case was followed.
FOLLOWED_TO = "end"
#: Names of files in a folder that are no results; and endings of files whose names must be those of
#: cases.
NO_RESULTS = ("cases", "manifest")
CERTAIN = (".csv", ".json")
#: Columns of derivatives: dt_mu1, dx_mu1, ...
CHANGES = tuple(f"d{of}_{name}" for name in NAMES for of in "tx")
#: What the columns are called, in any case, units and signs left out.
EVENT_COLUMNS = {
    "case": USUAL_NAMES[ID_COLUMN],
    "t": USUAL_NAMES["t"],
    "x": USUAL_NAMES["x"],
    "kind": {"kind", "event", "type"},
    "boundary": {"boundary", "belt"},
    "seconds": {"seconds"},
    **{f"{name}_{end}": {name + end} for name in "tx" for end in ("low", "high")},
    **{name: {name.replace("_", "").lower()} for name in CHANGES},
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
    """A solver's result for a case: its events in order of time, and the end time that it states."""

    events: list[GivenEvent] = field(default_factory=list)
    seconds: float | None = None
    note: str = ""  # why it has no events
    end: Fraction | None = None


Results = dict[str, CaseResult]


def read_results(path: str | Path, names: Container[str]) -> Results:
    """Return results by case, from a folder with a file for each (NAME.csv, NAME/events.csv, ...),
    or from one file.
    """
    source = Path(read_path(path))
    if not source.exists():
        raise ResultError(str(source), "does not exist")
    found: Results = {}
    for file, name in _files_of_cases(source, names) if source.is_dir() else [(source, None)]:
        if name in found:
            raise ResultError(str(file), f"is the second file with results for {name}")
        found |= _read_file(file, name)
    for name in found:
        if name not in names:
            raise ResultError(
                str(source), f"has results for {brief(name)!r}, which is no case of this set"
            )
    if not found:
        raise ResultError(str(source), "has no results")
    for result in found.values():
        result.events.sort(key=lambda event: event.t)
    return found


def _files_of_cases(folder: Path, names: Container[str]) -> Iterator[tuple[Path, str]]:
    """Yield each file of a folder that has results of a case, with the name of the case."""
    for path in sorted(folder.iterdir()):
        for file in sorted(path.glob("events.*")) if path.is_dir() else [path]:
            if path.is_dir():
                name = path.name
            else:
                name = path.name.partition(".")[0]
            suffix = suffix_of(file)
            if suffix in SUFFIXES and name in names:
                yield file, name
            elif suffix in CERTAIN and name not in NO_RESULTS:
                raise ResultError(
                    str(file), f"is named {brief(name)!r}, which is no case of this set"
                )


def _read_file(path: Path, name: str | None) -> Results:
    """Return the results in a file by case.

    `name` is the case that it is for, None if the file itself names cases.
    """
    if name is None:
        found: Results = {}
    else:
        found = {name: CaseResult()}
    try:
        for case, where, entry in _entries(
            read_content(path, partial(_columns, needs_case=name is None)), name
        ):
            _add_entry(where, found.setdefault(case, CaseResult()), entry)
    except ParameterError as error:
        raise ResultError(
            str(path), error.allowed if error.name == "file" else str(error)
        ) from None
    return found


def _wrong(what: str) -> ParameterError:
    """Return the exception to raise for a file of results, which says what is wrong with it."""
    return ParameterError("file", "", what)


def _names_by_meaning(names: Iterable[str]) -> dict[str, str]:
    """Return which of a file's column names mean "t", "x", "kind" and so on, as a dictionary by
    meaning.
    """
    found: dict[str, str] = {}
    there = list(map(str, names))
    for what, usual in EVENT_COLUMNS.items():
        fitting = [name for name in there if name.strip().lower() == what.lower()]
        fitting = fitting or [name for name in there if plain(name) in usual]
        if len(fitting) > 1:
            raise _wrong(f"has two columns named {brief(fitting[0])!r}")
        if fitting:
            found[what] = fitting[0]
    return found


def _columns(names: list[str], needs_case: bool) -> dict[str, str]:
    """Return a table's column names by meaning; raise ParameterError if a needed one is missing."""
    found = _names_by_meaning(names)
    enclosed = {"t_low", "t_high"} <= set(found)
    for what, needed in {"case": needs_case, "t": not enclosed, "kind": True}.items():
        if needed and what not in found:
            raise _wrong(f"has no column {what}; its columns are {brief(', '.join(names))}")
    return found


def _entries(content: Any, name: str | None) -> Iterator[tuple[str, str, Record]]:
    """Yield each event, or end of a run, as (its case, its place in the file, its entries by
    meaning).
    """
    # `name` is the case that the file is for, None if the file itself names cases.
    if name is None:
        where = ""
    else:
        where = brief(name)
    if name is not None:  # a case may be without events
        yield name, where, {"kind": FOLLOWED_TO}
    if isinstance(content, dict) and "kind" not in _names_by_meaning(content):
        table = None
    else:
        table = as_table(content)
    if isinstance(content, list) and content and isinstance(content[0], tuple):  # lines of a text
        for line, entry in content:
            yield name or entry.get("case", ""), line, entry
    elif table is not None:
        columns = {
            what: np.ravel(table[own]) for what, own in _columns([*table], name is None).items()
        }
        if len({len(each) for each in columns.values()}) > 1:
            raise _wrong("has columns of several lengths")
        for number, row in enumerate(zip(*columns.values(), strict=True), 1):
            entry = {
                what: cell
                for what, cell in zip(columns, map(_cell, row), strict=True)
                if cell is not None
            }
            yield name or str(entry.get("case", "")), f"row {number}", entry
    elif isinstance(content, list) and (name is not None or content):
        for number, event in enumerate(content, 1):
            place = f"{where}, event {number}".lstrip(", ")
            if not isinstance(event, dict):
                raise _wrong(f"{place}: must be an object with t and kind")
            entry = {
                what: event[own]
                for what, own in _names_by_meaning(event).items()
                if event[own] is not None
            }
            if name is None and "case" not in entry:
                raise _wrong(f"{place}: has no case")
            yield name or str(entry["case"]), place, entry
    elif name is None:
        if not isinstance(content, dict):
            raise _wrong("must be an object: names of cases, and their events")
        for case, part in content.items():
            yield from _entries(part, case)
    else:
        if not isinstance(content, dict) or not isinstance(content.get("events"), list | dict):
            raise _wrong(f"{where}: must be a list of events, or an object with a list 'events'")
        yield (
            name,
            where,
            {"kind": FOLLOWED_TO} | {key: content[key] for key in ("seconds",) if content.get(key)},
        )
        yield from _entries(content["events"], name)


def _cell(value: Any) -> Any:
    """Return a table cell, perhaps of numpy or bytes, as a plain Python value; None for an empty
    one.
    """
    if isinstance(value, np.generic | np.ndarray) and np.size(value) == 1:
        value = value.item()
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    if isinstance(value, str):
        value = value.strip()
    if value is None or value == "" or value != value:
        return None
    return value


def _add_entry(where: str, result: CaseResult, entry: Record) -> None:
    """Add an entry of a file to a result: an event, the time where the run ended, or the seconds
    that it took.
    """
    if "seconds" in entry:
        seconds = _number(where, entry, "seconds")
        if seconds is None or seconds < 0:
            raise _wrong(f"{where}: seconds = {brief(str(entry['seconds']))}: must be >= 0")
        result.seconds = max(result.seconds or 0.0, float(seconds))
    kind = str(entry.get("kind", "")).lower()
    if kind not in (*EVENT_WORDS, FOLLOWED_TO):
        words = ", ".join((*EVENT_WORDS, FOLLOWED_TO))
        raise _wrong(f"{where}: kind is {brief(kind)!r}, and must be one of {words}")
    t, x = (_number(where, entry, each) for each in "tx")
    if kind == FOLLOWED_TO:
        if result.end is None or t is None:
            result.end = t
        else:
            result.end = max(t, result.end)
        return
    if t is None:
        raise _wrong(f"{where}: has no t")
    belt = str(entry.get("boundary", "0"))
    with suppress(ParameterError):
        if belt in ("0", "1", "2"):
            boundary: int | Fraction = int(belt)
        else:
            boundary = read_exact("boundary", plain_number(belt))
        if boundary in (0, 1, 2):
            changes = {name: _number(where, entry, name) for name in CHANGES if name in entry}
            numbers = {name: float(value) for name, value in changes.items() if value is not None}
            result.events.append(GivenEvent(t, x, kind, int(boundary), numbers))
            return
    raise _wrong(f"{where}: boundary is {brief(belt)!r}, and must be 1 or 2")


def _number(where: str, entry: Record, name: str) -> Fraction | None:
    """Return the number `name` of an event, or the middle of its name_low and name_high; None if
    both are missing.
    """

    def exact(value: Any) -> Fraction:
        try:
            return read_exact(name, plain_number(value) if isinstance(value, str) else value)
        except ParameterError as error:
            raise _wrong(f"{where}: {error}") from None

    if f"{name}_low" in entry and f"{name}_high" in entry:
        return (exact(entry[f"{name}_low"]) + exact(entry[f"{name}_high"])) / 2
    if name in entry:
        return exact(entry[name])
    return None
