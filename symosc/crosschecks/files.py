"""Samples t, x, v of somebody's solution, from files and from objects of other packages, none of which is imported."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.samples import SAMPLE_COLUMNS, Samples, checked, short, shown
from symosc.errors import ParameterError

EXAMPLE = '{"t": [...], "x": [...], "v": [...]}'
# Column names that a message lists.
COLUMNS_LISTED = 12


def read_samples(source: Any, columns: Mapping[str, str] | None = None) -> Samples:
    """Read samples.

    Parameters
    ----------
    source : path or object
        A path that ends in .csv (with a header), .npz or .json (columns as lists, or a list of rows); an OdeResult of
        scipy (the rows of y are x and v); a pandas DataFrame, an xarray Dataset or a mapping of columns. The index of a
        DataFrame can be the time. "events" in JSON, an npz or a mapping are pairs (t, kind).
    columns : mapping, optional
        What the columns t, x and v are called, for example ``{"x": "position"}``.

    Raises
    ------
    ParameterError
        If the file cannot be read, a column is missing, or the samples are not what `checked` demands.
    """
    names = _column_names(columns)
    where = str(source) if isinstance(source, (str, Path)) else type(source).__name__
    if isinstance(source, (str, Path)):
        source = _read_file(Path(source), {*names.values(), "events"})
    if hasattr(source, "y") and hasattr(source, "t") and not columns and not _has(source, "x"):
        return _read_result(source)
    if type(source).__module__.partition(".")[0] == "pandas" and source.index.name == names["t"]:
        source = source.reset_index()
    found = {}
    for name, column in names.items():
        if not _has(source, column):
            raise ParameterError("column", column, f"is missing in {where}; there are: {_listed(source)}")
        found[name] = source[column]
    events = source["events"] if _has(source, "events") else None
    return checked(found["t"], found["x"], found["v"], events)


def _column_names(columns: Mapping[str, str] | None) -> dict[str, str]:
    if columns is not None and not isinstance(columns, Mapping):
        raise ParameterError("columns", shown(columns), 'must be a mapping, such as {"x": "position"}')
    names = {name: name for name in SAMPLE_COLUMNS} | dict(columns or {})
    for name, column in names.items():
        if name not in SAMPLE_COLUMNS:
            raise ParameterError("columns", name, "only t, x and v are read")
        if not isinstance(column, str):
            raise ParameterError("columns", shown(column), f"must be text: the name of the column that holds {name}")
    if len(set(names.values())) < len(names):
        raise ParameterError("columns", names, "t, x and v must be three columns")
    return names


def _read_result(result: Any) -> Samples:
    """Return the samples of an OdeResult."""
    try:
        shape = np.shape(result.y)
    except ValueError:
        shape = ()
    if len(shape) != 2 or shape[0] != 2:
        raise ParameterError("y", shape, "must have two rows, x and v, so the shape (2, n); this is its shape")
    return checked(result.t, result.y[0], result.y[1])


def _has(source: Any, column: str) -> bool:
    # Text and lists have parts, a table has columns.
    if isinstance(source, (str, bytes, list, tuple)) or not hasattr(source, "__getitem__"):
        return False
    if isinstance(source, np.ndarray):
        return column in (source.dtype.names or ())
    try:
        return column in source
    except TypeError:
        return False


def _listed(source: Any) -> str:
    keys = [short(str(key)) for key in getattr(source, "keys", list)()]
    more = [f"and {len(keys) - COLUMNS_LISTED} more"] if len(keys) > COLUMNS_LISTED else []
    return ", ".join(keys[:COLUMNS_LISTED] + more) or "none"


def _read_file(path: Path, wanted: set[str]) -> Any:
    readers = {".csv": _read_csv, ".npz": _read_npz, ".json": _read_json}
    if path.suffix.lower() not in readers:
        raise ParameterError("file", str(path), f"must end in {', '.join(readers)}")
    try:
        return readers[path.suffix.lower()](path, wanted)
    except ParameterError:
        raise
    except OSError as error:
        raise ParameterError("file", str(path), f"cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise ParameterError("file", str(path), "cannot be read: it is not text in UTF-8") from None
    except RecursionError:
        raise ParameterError("file", str(path), "cannot be read: its brackets are nested too deeply") from None
    except MemoryError:
        raise ParameterError("file", str(path), "cannot be read: it does not fit into memory") from None
    except (ValueError, csv.Error) as error:
        raise ParameterError("file", str(path), f"cannot be read: {error}") from None


def _read_csv(path: Path, wanted: set[str]) -> dict[str, list[str]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        reader = csv.reader(file, skipinitialspace=True)
        rows = [(reader.line_num, row) for row in reader if any(entry.strip() for entry in row)]
    if not rows:
        raise ParameterError("file", str(path), "is empty; its first line must name the columns, such as t,x,v")
    heads = [name.strip() for name in rows[0][1]]
    heads[0] = heads[0].lstrip("# ")  # numpy.savetxt writes its header as a comment
    for number, row in rows[1:]:
        if len(row) != len(heads):
            raise ParameterError("file", str(path), f"row {number} has {len(row)} entries, the header {len(heads)}")
    _refuse_twice(path, heads, wanted)
    return {name: [row[i] for _, row in rows[1:]] for i, name in enumerate(heads)}


def _refuse_twice(path: Path, names: Iterable[str], wanted: set[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen and name in wanted:
            raise ParameterError("file", str(path), f"has {short(name)!r} twice")
        seen.add(name)


def _read_npz(path: Path, wanted: set[str]) -> Record:
    with path.open("rb") as file:
        try:
            with np.load(file) as data:
                return {name: _plain(path, data, name) if name in wanted else None for name in data.files}
        except (ParameterError, MemoryError):
            raise
        except Exception:  # zipfile, zlib and numpy raise a dozen kinds, all for the same reason
            raise ParameterError("file", str(path), "is not an npz file, or it is damaged") from None


def _plain(path: Path, data: Any, name: str) -> Any:
    try:
        return data[name]
    except ValueError:
        what = f"{name} must be an array of numbers (events: of text), not of Python objects"
        raise ParameterError("file", str(path), what) from None


def _read_json(path: Path, wanted: set[str]) -> Any:
    text = path.read_text(encoding="utf-8-sig")
    if not text.strip():
        raise ParameterError("file", str(path), f"is empty; it must hold columns, such as {EXAMPLE}")

    def table(pairs: list[tuple[str, Any]]) -> Record:
        _refuse_twice(path, (name for name, _ in pairs), wanted)
        return dict(pairs)

    try:
        data = json.loads(text, object_pairs_hook=table)
    except (ParameterError, json.JSONDecodeError):
        raise
    except ValueError:  # Python's own limit
        raise ParameterError("file", str(path), "cannot be read: a number in it has thousands of digits") from None
    if isinstance(data, list) and data and all(isinstance(row, dict) for row in data):
        return {name: [row.get(name) for row in data] for name in data[0]}
    if not isinstance(data, dict):
        raise ParameterError("file", str(path), f"must hold columns, such as {EXAMPLE}")
    return data
