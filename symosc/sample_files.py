"""Samples t, x, v of somebody's solution, from files and from objects of other packages, none of which is imported."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from symosc.errors import ParameterError

NAMES = ("t", "x", "v")
LEAST = 2
KINDS = ("cross", "stick", "slip", "graze")


@dataclass(frozen=True)
class Samples:
    """A solution at times: `t`, `x`, `v` are (n,) float arrays; `events` are pairs (t, kind), or None."""

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    events: tuple[tuple[float, str], ...] | None = None


def read_samples(source: Any, columns: Mapping[str, str] | None = None) -> Samples:
    """Read samples.

    Parameters
    ----------
    source : path or object
        A path that ends in .csv (with a header), .npz or .json (columns as lists, or a list of rows); an OdeResult of
        scipy (x and v are the first two rows of y); a pandas DataFrame, an xarray Dataset or a mapping of columns. The
        index of a DataFrame will do for the time. "events" in JSON, an npz or a mapping are pairs (t, kind).
    columns : mapping, optional
        What the columns t, x and v are called, for example ``{"x": "position"}``.

    Raises
    ------
    ParameterError
        If the file cannot be read, a column is missing, or the samples are not what `checked` demands.
    """
    names = {name: name for name in NAMES} | dict(columns or {})
    for name in names:
        if name not in NAMES:
            raise ParameterError("columns", name, "only t, x and v are read")
    where = source if isinstance(source, (str, Path)) else type(source).__name__
    if isinstance(source, (str, Path)):
        source = _read_file(Path(source))
    if hasattr(source, "y") and hasattr(source, "t") and not columns and not _has(source, "x"):
        y = np.asarray(source.y)
        if y.ndim != 2 or len(y) < 2:
            raise ParameterError("y", y.shape, "must have the rows x and v, shape (2, n)")
        return checked(source.t, y[0], y[1])
    if type(source).__module__.partition(".")[0] == "pandas" and source.index.name == names["t"]:
        source = source.reset_index()
    found = {}
    for name, column in names.items():
        if not _has(source, column):
            known = ", ".join(str(key) for key in getattr(source, "keys", list)())
            raise ParameterError("column", column, f"is missing in {where}; there are: {known or 'none'}")
        found[name] = np.asarray(source[column])
    events = source["events"] if _has(source, "events") else None
    return checked(found["t"], found["x"], found["v"], events)


def _has(source: Any, column: str) -> bool:
    try:
        return column in source
    except TypeError:
        return False


def _read_file(path: Path) -> Any:
    readers = {".csv": _read_csv, ".npz": _read_npz, ".json": _read_json}
    if path.suffix.lower() not in readers:
        raise ParameterError("file", str(path), f"must end in {', '.join(readers)}")
    try:
        return readers[path.suffix.lower()](path)
    except OSError as error:
        raise ParameterError("file", str(path), f"cannot be read: {error.strerror or error}") from None
    except (UnicodeDecodeError, json.JSONDecodeError, csv.Error) as error:
        raise ParameterError("file", str(path), f"cannot be read: {error}") from None


def _read_csv(path: Path) -> dict[str, list[str]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = [row for row in csv.reader(file, skipinitialspace=True) if row]
    if not rows:
        raise ParameterError("file", str(path), "is empty; its first line must name the columns, such as t,x,v")
    heads = [name.strip() for name in rows[0]]
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(heads):
            raise ParameterError("file", str(path), f"row {number} has {len(row)} entries, the header {len(heads)}")
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(heads)}


def _read_npz(path: Path) -> dict[str, Any]:
    try:
        with np.load(path) as data:
            return {name: data[name] for name in data.files}
    except (ValueError, EOFError, AttributeError) as error:
        raise ParameterError("file", str(path), f"is no npz file of plain arrays ({error})") from None
    except Exception as error:
        if type(error).__name__ != "BadZipFile":
            raise
        raise ParameterError("file", str(path), "is no npz file") from None


def _read_json(path: Path) -> Any:
    data = json.loads(path.read_text(encoding="utf-8"))
    if isinstance(data, list) and data and all(isinstance(row, dict) for row in data):
        return {name: [row.get(name) for row in data] for name in data[0]}
    if not isinstance(data, dict):
        raise ParameterError("file", str(path), 'must hold columns, such as {"t": [...], "x": [...], "v": [...]}')
    return data


def checked(t: Any, x: Any, v: Any, events: Any = None) -> Samples:
    """Return samples as float arrays.

    Raises
    ------
    ParameterError
        Unless t, x and v are finite numbers, one-dimensional, of one length >= 2, and t increases.
    """
    arrays = {}
    for name, values in zip(NAMES, (t, x, v), strict=True):
        try:
            array = np.asarray(values, dtype=float)
        except (TypeError, ValueError):
            raise ParameterError(name, _first_wrong(values), "is no number") from None
        if array.ndim != 1:
            raise ParameterError(name, array.shape, "must be one-dimensional")
        bad = np.flatnonzero(~np.isfinite(array))
        if len(bad):
            raise ParameterError(f"{name}[{bad[0]}]", float(array[bad[0]]), f"must be finite ({len(bad)} are not)")
        arrays[name] = array
    lengths = {name: len(array) for name, array in arrays.items()}
    if len(set(lengths.values())) > 1:
        raise ParameterError("lengths", lengths, "t, x and v must have one length")
    if lengths["t"] < LEAST:
        raise ParameterError("samples", lengths["t"], f"at least {LEAST} are needed")
    late = np.flatnonzero(np.diff(arrays["t"]) <= 0.0)
    if len(late):
        i, times = int(late[0]) + 1, arrays["t"]
        what = "is repeated" if times[i] == times[i - 1] else f"comes after {float(times[i - 1])!r}"
        raise ParameterError(f"t[{i}]", float(times[i]), f"{what}; the times must increase")
    return Samples(**arrays, events=None if events is None else _checked_events(events))


def _first_wrong(values: Any) -> Any:
    for value in values if isinstance(values, Iterable) else [values]:
        try:
            float(value)
        except (TypeError, ValueError):
            return str(value)
    return type(values).__name__


def _checked_events(events: Any) -> tuple[tuple[float, str], ...]:
    pairs = []
    for i, pair in enumerate(events):
        try:
            time, kind = pair
            time = float(time)
        except (TypeError, ValueError):
            raise ParameterError(f"events[{i}]", pair, "must be a pair (t, kind)") from None
        if str(kind) not in KINDS or not np.isfinite(time):
            raise ParameterError(f"events[{i}]", (time, kind), f"t must be finite, kind one of {', '.join(KINDS)}")
        pairs.append((time, str(kind)))
    return tuple(sorted(pairs))
