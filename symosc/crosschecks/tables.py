"""Tables of any package as columns by name, and the solutions in them: one, one for each id, or one for each row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.columns import ID_COLUMN, NO_COLUMNS, find_columns, plain
from symosc.crosschecks.formats import BOTH_IN_ONE, Asked
from symosc.crosschecks.samples import Samples, checked, checked_positions
from symosc.errors import ParameterError

#: A table: the names of its columns, and what returns one.
Table = tuple[list[str], Callable[[str], Any]]


def as_table(source: Any) -> Table | None:
    """Return an object as a table, or None if it is none.

    A mapping, a structured array, a DataFrame of pandas or polars, a Dataset of xarray, a Table of pyarrow.
    """
    package = type(source).__module__.partition(".")[0]
    if isinstance(source, np.ndarray):
        return None if source.dtype.names is None else (list(source.dtype.names), source.__getitem__)
    if package == "pandas" and hasattr(source, "reset_index"):
        return _of_pandas(source)
    if package == "xarray" and hasattr(source, "to_dataframe"):
        return _of_xarray(source)
    names = getattr(source, "column_names", None)  # pyarrow
    if isinstance(names, list):
        return names, lambda name: source.column(names.index(name)).to_numpy()
    schema = getattr(getattr(source, "schema", None), "names", None)
    if package == "pyarrow" and isinstance(schema, list):
        return schema, lambda name: source.column(schema.index(name)).to_numpy(zero_copy_only=False)
    if isinstance(source, Mapping):
        return [str(name) for name in source], _by_text(source)
    columns = getattr(source, "columns", None)  # polars
    if isinstance(columns, list) and hasattr(source, "__getitem__"):
        return [str(name) for name in columns], source.__getitem__
    return None


def _by_text(source: Mapping[Any, Any]) -> Callable[[str], Any]:
    keys = {str(key): key for key in source}
    return lambda name: source[keys[name]]


def _of_pandas(frame: Any) -> Table | None:
    """Return a DataFrame; an index with names is columns too."""
    if not hasattr(frame, "columns"):
        return None
    inside = {str(name) for name in frame.columns}
    if any(name is not None and str(name) not in inside for name in frame.index.names):
        frame = frame.reset_index()
    keys = {str(name): i for i, name in enumerate(frame.columns)}
    if len(keys) < len(frame.columns):
        raise ParameterError("DataFrame", list(frame.columns), "has two columns of one name")
    return list(keys), lambda name: frame.iloc[:, keys[name]].to_numpy()


def _of_xarray(data: Any) -> Table | None:
    """Return a Dataset; over two dimensions it is several trajectories, the shorter rows of a table."""
    if not hasattr(data, "data_vars"):
        return None
    if max((len(variable.dims) for variable in data.variables.values()), default=0) > 1:
        frame = data.to_dataframe().reset_index()
        inner = _time_of(data)
        others = [str(name) for name in data.dims if str(name) != inner and frame[name].nunique() > 1]
        if len(others) == 1 and ID_COLUMN not in frame:
            frame = frame.rename(columns={others[0]: ID_COLUMN})
        return _of_pandas(frame.dropna())
    names = [str(name) for name in data.variables]
    return names, lambda name: data[name].values


def _time_of(data: Any) -> str:
    """Return the dimension along which the time goes."""
    times = [name for name, variable in data.variables.items() if plain(str(name)) in ("t", "time", "times")]
    along = data.variables[times[0]].dims if times else ()
    return str(along[-1]) if along else ""


def of_table(source: Any, asked: Asked, where: str) -> list[Samples]:
    """Return the solutions in a table, or in a mapping of columns."""
    table = as_table(source) if not isinstance(source, tuple) else source
    assert table is not None
    names, column = table
    names, column = _with_states_apart(names, column, asked)
    found = find_columns(names, asked, where)
    values: Record = {name: column(own) for name, own in found.items()}
    ids = values.pop(ID_COLUMN, None)
    events = next((column(name) for name in names if name in NO_COLUMNS), None)
    if np.ndim(_plainly(values["x"])) > 1:
        return _of_rows(values, where)
    if ids is None or not _are_ids(ids := np.ravel(np.asarray(ids))):
        return [_one(values, events)]
    if events is not None:
        raise ParameterError("events", "given", f"can be listed for one solution; {where} has several")
    return _by_id(values, ids)


def _one(values: Record, events: Any = None) -> Samples:
    if "v" in values:
        return checked(values["t"], values["x"], values["v"], events)
    return checked_positions(values["t"], values["x"], events)


def _plainly(values: Any) -> np.ndarray:
    try:
        return np.asarray(values)
    except ValueError:  # ragged; the check of the samples says where
        return np.empty(0)


def _with_states_apart(names: list[str], column: Callable[[str], Any], asked: Asked) -> Table:
    """Return a table in which an array that holds x and v together is two columns."""
    usual = {plain(name) for name in names}
    if usual & {"x", "position"} or "x" in asked:
        return names, column
    for name in names:
        both: np.ndarray = _plainly(column(name)) if name.lower() in BOTH_IN_ONE else np.empty(0)
        if both.ndim == 2 and 2 in both.shape:
            x, v = both if len(both) == 2 and both.shape != (2, 2) else both.T
            columns = {each: column(each) for each in names if each != name} | {"x": x, "v": v}
            return list(columns), columns.__getitem__
    return names, column


def _of_rows(values: Record, where: str) -> list[Samples]:
    """Return the solutions in columns that are matrices: a row, or a column, for each of them."""
    arrays = {name: np.asarray(value) for name, value in values.items()}
    count = arrays["t"].shape[-1] if arrays["t"].ndim else 0
    shapes = {name: array.shape for name, array in arrays.items()}
    if all(array.size == max(array.shape, default=0) for array in arrays.values()):  # one row or column each
        return [_one({name: array.ravel() for name, array in arrays.items()})]
    if arrays["t"].ndim == 1 and arrays["x"].shape[-1] != count and arrays["x"].shape[0] == count:
        arrays = {name: array.T for name, array in arrays.items()}
    sizes = {array.shape for name, array in arrays.items() if name != "t" or array.ndim > 1}
    if len(sizes) != 1 or len(shape := sizes.pop()) != 2 or shape[1] != arrays["t"].shape[-1]:
        raise ParameterError("shapes", shapes, f"do not fit in {where}: x and v need a row for each solution")
    rows = {name: np.broadcast_to(array, shape) for name, array in arrays.items()}
    return [
        replace(_one({name: row[i] for name, row in rows.items()}), name=str(i) if shape[0] > 1 else "")
        for i in range(shape[0])
    ]


def _are_ids(ids: np.ndarray) -> bool:
    """Tell whether a column says whose samples they are: one that has no value twice numbers the rows."""
    return len(np.unique(ids.astype(str))) < len(ids)


def _by_id(values: Record, ids: np.ndarray) -> list[Samples]:
    """Return a solution for each id, in order of their first rows."""
    lengths = {name: len(column) for name, column in values.items()} | {ID_COLUMN: len(ids)}
    if len(set(lengths.values())) > 1:
        raise ParameterError("lengths", lengths, "the columns must have one length")
    names, first, inverse = np.unique(ids.astype(str), return_index=True, return_inverse=True)
    order = np.argsort(inverse, kind="stable")
    rows = np.split(order, np.cumsum(np.bincount(inverse))[:-1])
    columns = {name: np.asarray(column) for name, column in values.items()}
    found = []
    for i in np.argsort(first).tolist():
        try:
            one = _one({name: column[rows[i]] for name, column in columns.items()})
        except ParameterError as error:
            raise ParameterError(error.name, error.value, f"{error.allowed} (id {names[i]})") from None
        found.append(replace(one, name=str(names[i]) if len(names) > 1 else ""))
    return found
