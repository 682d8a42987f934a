"""Somebody's events, read from CSV or JSON: a folder with a file per case, or one file. `formats.txt` has the rules."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

from symosc.aliases import Record
from symosc.errors import ParameterError, ResultError, brief
from symosc.exact import read_exact
from symosc.files import read_path

EVENT_WORDS = ("cross", "stick", "slip", "graze")
#: The kind of a line that says that a case was followed to its end.
FOLLOWED_TO_END = "end"
#: Files of a set of cases that are no results.
NO_RESULTS = ("cases", "manifest")
LARGEST_FILE = 2 * 10**9


class GivenEvent(NamedTuple):
    """An event that a solver has found; x is None and boundary 0 where it does not say."""

    t: Fraction
    x: Fraction | None
    kind: str
    boundary: int


@dataclass
class CaseResult:
    """What a solver has for a case: its events in order of time, its seconds if given, or a note why it has none."""

    events: list[GivenEvent] = field(default_factory=list)
    seconds: float | None = None
    note: str = ""


Results = dict[str, CaseResult]


def read_results(path: str | Path, names: Container[str]) -> Results:
    """Return results by case.

    Parameters
    ----------
    path : str or Path
        A folder with a file per case (NAME.csv, NAME.json, NAME/events.csv, NAME/events.json), or one file.
    names : container of str
        The cases that there are.

    Raises
    ------
    ResultError
        If a file cannot be read, or names a case that does not exist. The message is one line.
    """
    source = Path(read_path(path))
    if source.is_dir():
        found = _of_folder(source, names)
    elif source.suffix.lower() in RESULT_READERS:
        found = RESULT_READERS[source.suffix.lower()](source, None)
    else:
        raise ResultError(
            str(source), "must be a folder, a .csv file or a .json file" if source.exists() else NOT_THERE
        )
    for name in found:
        if name not in names:
            raise ResultError(str(source), f"has results for {brief(name)!r}, which is no case of this set")
    if not found:
        raise ResultError(str(source), "has no results")
    for result in found.values():
        result.events.sort(key=lambda event: event.t)
    return found


NOT_THERE = "does not exist"


def _of_folder(folder: Path, names: Container[str]) -> Results:
    found: Results = {}
    for path in sorted(folder.iterdir()):
        inside = [each for each in (path / "events.csv", path / "events.json") if each.is_file()]
        for file in inside if path.is_dir() else [path]:
            name = path.name if path.is_dir() else path.stem
            if file.suffix.lower() not in RESULT_READERS or (name in NO_RESULTS and name not in names):
                continue
            if name not in names:
                raise ResultError(str(file), f"is named {brief(name)!r}, which is no case of this set")
            if name in found:
                raise ResultError(str(file), f"is the second file with results for {name}")
            found[name] = RESULT_READERS[file.suffix.lower()](file, name).get(name, CaseResult())
    return found


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise ResultError(str(path), f"is larger than {LARGEST_FILE:.0e} bytes")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ResultError(str(path), f"cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise ResultError(str(path), "is not UTF-8 text") from None
    if not text.strip():
        raise ResultError(str(path), "is empty; a case without events has a header and no lines")
    return text


# -- CSV ---------------------------------------------------------------------------------------------------------------


def _read_csv(path: Path, name: str | None) -> Results:
    """Return the results of a file; `name` is the case it is for, None if it names them."""
    reader = csv.DictReader(_text(path).splitlines(), strict=True, skipinitialspace=True)
    found: Results = {} if name is None else {name: CaseResult()}
    try:
        reader.fieldnames = [each.strip().lower() for each in reader.fieldnames or ()]
        _check_columns(path, reader.fieldnames, name is None)
        for row in reader:
            where = f"line {reader.line_num}"
            if None in row or None in row.values():
                raise ResultError(str(path), f"{where}: has not as many entries as the header")
            row = {key: value.strip() for key, value in row.items() if value.strip()}
            _add(path, where, found.setdefault(name or row.get("case", ""), CaseResult()), row)
    except csv.Error as error:
        raise ResultError(str(path), f"is not CSV: {error}") from None
    return found


def _check_columns(path: Path, columns: Sequence[str], needs_case: bool) -> None:
    double = next((each for i, each in enumerate(columns) if each in columns[:i]), None)
    if double is not None:
        raise ResultError(str(path), f"has two columns named {brief(double)!r}")
    enclosed = {"t_low", "t_high"} <= set(columns)
    wanted = [*(["case"] if needs_case else []), *([] if enclosed else ["t"]), "kind"]
    missing = [each for each in wanted if each not in columns]
    if missing:
        has = brief(", ".join(columns))
        raise ResultError(str(path), f"has no column {missing[0]}; its columns are {has}")


# -- JSON --------------------------------------------------------------------------------------------------------------


def _read_json(path: Path, name: str | None) -> Results:
    """Return the results of a file; see `_read_csv`."""
    try:
        content = json.loads(_text(path), parse_float=Decimal, parse_constant=_refuse, object_pairs_hook=_object)
    except ValueError as error:
        raise ResultError(str(path), f"is not JSON: {brief(str(error))}") from None
    except RecursionError:
        raise ResultError(str(path), "is not JSON: nested too deeply") from None
    if name is None and not isinstance(content, dict):
        raise ResultError(str(path), "must be an object: names of cases, and their events")
    parts = content.items() if name is None else [(name, content)]
    return {case: _json_result(path, case, each) for case, each in parts}


def _refuse(constant: str) -> Any:
    raise ValueError(f"{constant} is no number")


def _object(pairs: list[tuple[str, Any]]) -> Record:
    found: Record = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"{brief(key)!r} is there twice")
        found[key] = value
    return found


def _json_result(path: Path, case: str, content: Any) -> CaseResult:
    about = content if isinstance(content, dict) else {"events": content}
    events, result = about.get("events"), CaseResult()
    if not isinstance(events, list):
        raise ResultError(str(path), f"{brief(case)}: must be a list of events, or an object with a list 'events'")
    for number, event in enumerate(events, 1):
        where = f"{brief(case)}, event {number}"
        if not isinstance(event, dict):
            raise ResultError(str(path), f"{where}: must be an object with t and kind")
        _add(path, where, result, {key.lower(): value for key, value in event.items() if value is not None})
    if about.get("seconds") is not None:
        result.seconds = _seconds(path, case, about["seconds"])
    return result


# -- an event ----------------------------------------------------------------------------------------------------------


def _add(path: Path, where: str, result: CaseResult, entry: Record) -> None:
    """Read an event into a result."""
    if "seconds" in entry:
        result.seconds = max(result.seconds or 0.0, _seconds(path, where, entry["seconds"]))
    kind = str(entry.get("kind", "")).lower()
    if kind == FOLLOWED_TO_END:
        return
    if kind not in EVENT_WORDS:
        words = ", ".join(EVENT_WORDS)
        raise ResultError(str(path), f"{where}: kind is {brief(kind)!r}, and must be one of {words}, {FOLLOWED_TO_END}")
    t, x = (_number(path, where, entry, each) for each in "tx")
    if t is None:
        raise ResultError(str(path), f"{where}: has no t")
    boundary = str(entry.get("boundary", 0))
    if boundary not in ("0", "1", "2"):
        raise ResultError(str(path), f"{where}: boundary is {brief(boundary)!r}, and must be 1 or 2")
    result.events.append(GivenEvent(t, x, kind, int(boundary)))


def _number(path: Path, where: str, entry: Record, name: str) -> Fraction | None:
    """Return a number of an event, the middle of name_low and name_high if it is enclosed; None without one."""
    try:
        if f"{name}_low" in entry and f"{name}_high" in entry:
            return (read_exact(name, entry[f"{name}_low"]) + read_exact(name, entry[f"{name}_high"])) / 2
        return None if name not in entry else read_exact(name, entry[name])
    except ParameterError as error:
        raise ResultError(str(path), f"{where}: {error}") from None


def _seconds(path: Path, where: str, value: Any) -> float:
    try:
        seconds = read_exact("seconds", value)
    except ParameterError as error:
        raise ResultError(str(path), f"{where}: {error}") from None
    if seconds < 0:
        raise ResultError(str(path), f"{where}: seconds = {brief(str(value))}: must be >= 0")
    return float(seconds)


RESULT_READERS: dict[str, Callable[[Path, str | None], Results]] = {".csv": _read_csv, ".json": _read_json}
