"""Solutions as Python objects of any kind: results of solvers, functions, arrays, tables of other packages, lists.

None of the packages is imported: what an object has tells what it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.columns import BOTH_IN_ONE, ID_COLUMN, NO_COLUMNS, USUAL_NAMES, Asked, find_columns, plain
from symosc.crosschecks.functions import SolverTask, of_function, of_trajectory, solver_events
from symosc.crosschecks.samples import Samples, checked, checked_positions, shown
from symosc.errors import ParameterError
from symosc.simulation.trajectory import Trajectory

# Two pieces of a solution meet if their times agree to this many units of the last place.
SAME_TIME = 4.0
#: A table: the names of its columns, and what returns one.
Table = tuple[list[str], Callable[[str], Any]]


def solutions_in(source: Any, asked: Asked, problem: SolverTask | None = None, where: str = "") -> list[Samples]:
    """Return the solutions that an object holds; `where` is what a message calls it.

    It may be an OdeResult of scipy or what has `t` and `y` like it, `ts` and `ys` of diffrax, a function t -> (x, v) or
    a dense output, a Trajectory; a DataFrame, an xarray Dataset, a table of pyarrow or polars, a mapping of columns, a
    structured array; an (n, 3) array of t, x, v or (n, 2) of t, x; rows as a list of dicts. A list of these is several
    solutions, or pieces of one if each begins where the one before ends.
    """
    where = where or type(source).__name__
    if isinstance(source, Trajectory):
        return [of_trajectory(source)]
    if isinstance(source, (list, tuple)):
        return _of_list(source, asked, problem, where)
    if not asked and not _has_column(source, "x"):
        found = _of_result(source, problem)
        if found is not None:
            return found
    if callable(source) and not isinstance(source, Mapping) and not hasattr(source, "__array__"):
        return [of_function(source, problem)]
    if isinstance(source, np.ndarray) and source.dtype.names is None:
        return [_of_array(source, where)]
    table = as_table(source)
    if table is None:
        raise ParameterError("solution", shown(source), "is no solution: give a file, a table, an array or a function")
    return _of_table(table, asked, where)


def _has_column(source: Any, column: str) -> bool:
    if isinstance(source, np.ndarray):
        return column in (source.dtype.names or ())
    try:
        return hasattr(source, "__getitem__") and hasattr(source, "__contains__") and column in source
    except (TypeError, ValueError):
        return False


# -- results of solvers, arrays ----------------------------------------------------------------------------------------


def _of_result(source: Any, problem: SolverTask | None) -> list[Samples] | None:
    """Return the solutions in what a solver gave back, or None if it is no such thing."""
    for times, states in (("t", "y"), ("ts", "ys")):
        inside = isinstance(source, Mapping)
        if not all(name in source if inside else hasattr(source, name) for name in (times, states)):
            continue
        t, y = (source[name] if inside else getattr(source, name) for name in (times, states))
        if callable(t) or callable(y):
            continue
        if isinstance(y, Mapping):
            return solutions_in({"t": t, **y}, {}, None, type(source).__name__)
        found = _of_states(np.asarray(t), y, states)
        notes = [] if getattr(source, "success", True) else [f"the solver says: {getattr(source, 'message', 'failed')}"]
        events, more = solver_events(source, problem)
        if len(found) == 1:
            dense = getattr(source, "sol", None)
            dense = dense if callable(dense) else None
            found = [replace(found[0], events=events, notes=(*notes, *more), dense=dense)]
        return found
    return None


def _of_states(t: np.ndarray, y: Any, name: str) -> list[Samples]:
    """Return solutions from times and states: x and v as two rows, two columns, or a pair; or a batch of these."""
    try:
        y = np.asarray(y, dtype=float)
    except (TypeError, ValueError):
        raise ParameterError(name, "ragged", "must have two rows, x and v, so the shape (2, n)") from None
    t = t.ravel() if t.size == max(t.shape, default=0) else t  # a column of MATLAB
    if t.ndim == 2 and y.ndim == 3 and len(t) == len(y):
        return [replace(_of_states(*pair, name)[0], name=str(i)) for i, pair in enumerate(zip(t, y, strict=True))]
    if y.ndim == 2 and 2 in y.shape:
        rows = y if y.shape == (2, t.size) else y.T
        if rows.shape == (2, t.size):
            # Solvers with arrays of one size fill them up with inf.
            padded = t.ndim == 1 and t.dtype.kind == "f" and len(t) > 2 and np.isinf(t[-1])
            kept = slice(int(np.argmax(np.isinf(t))) if padded else None)
            return [checked(t[kept], rows[0][kept], rows[1][kept])]
    raise ParameterError(name, y.shape, "must have two rows, x and v, so the shape (2, n); this is its shape")


def _of_array(array: np.ndarray, where: str) -> Samples:
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ParameterError(where, array.shape, "must have columns t, x, v, so the shape (n, 3); this is its shape")
    return checked(*array.T) if array.shape[1] == 3 else checked_positions(*array.T)


# -- lists -------------------------------------------------------------------------------------------------------------


def _of_list(source: Sequence[Any], asked: Asked, problem: SolverTask | None, where: str) -> list[Samples]:
    if not source:
        raise ParameterError("solution", shown(source), "is empty")
    if all(isinstance(row, Mapping) and _is_row(row) for row in source):
        names = list(dict.fromkeys(name for row in source for name in row))
        return _of_table((names, lambda name: [row.get(name) for row in source]), asked, where)
    if all(isinstance(row, (list, tuple, np.ndarray)) and _are_numbers(row) for row in source):
        lengths = {len(row) for row in source}
        if len(lengths) > 1:
            raise ParameterError(where, sorted(lengths), "has rows of several lengths; each must be t, x, v")
        columns = [list(column) for column in zip(*source, strict=True)]
        if len(columns) not in (2, 3):
            return [_of_array(np.empty((len(source), len(columns))), where)]
        return [checked(*columns) if len(columns) == 3 else checked_positions(*columns)]
    found: list[Samples] = []
    for i, part in enumerate(source):
        if isinstance(part, (str, int, float)) or part is None:
            raise ParameterError(f"{where}[{i}]", shown(part), "is no solution")
        found += solutions_in(part, asked, problem)
    if len(found) > 1 and all(map(_meet, found, found[1:])):
        return [_joined(found)]
    return found


def _is_row(row: Mapping[Any, Any]) -> bool:
    """Tell whether a mapping is a row, whose entries are numbers or texts, and not columns."""
    return all(value is None or np.ndim(value) == 0 for name, value in row.items() if name != "events")


def _are_numbers(row: Any) -> bool:
    return len(row) > 0 and all(isinstance(value, (int, float, str, np.number)) for value in row)


def _meet(one: Samples, other: Samples) -> bool:
    """Tell whether one piece begins where another ends."""
    end, begin = float(one.t[-1]), float(other.t[0])
    return abs(begin - end) <= SAME_TIME * float(np.spacing(abs(end))) and one.lacks_v == other.lacks_v


def _joined(pieces: Sequence[Samples]) -> Samples:
    """Return pieces of a solution as one."""
    columns: Record = {name: np.concatenate([getattr(each, name) for each in pieces]) for name in ("t", "x", "v")}
    begin = np.cumsum([len(each.t) for each in pieces[:-1]])
    columns["t"][begin] = np.maximum(columns["t"][begin], columns["t"][begin - 1])  # they agree but for rounding
    lists = [each.events for each in pieces if each.events is not None]
    events = tuple(pair for pairs in lists for pair in pairs) if lists else None
    notes = dict.fromkeys(note for each in pieces for note in each.notes)
    return Samples(**columns, events=events, notes=(*notes, f"joined from {len(pieces)} pieces"))


# -- tables ------------------------------------------------------------------------------------------------------------


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
        keys = {str(key): key for key in source}
        return list(keys), lambda name: source[keys[name]]
    columns = getattr(source, "columns", None)  # polars
    if isinstance(columns, list) and hasattr(source, "__getitem__"):
        return [str(name) for name in columns], source.__getitem__
    return None


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
        times = [name for name, variable in data.variables.items() if plain(str(name)) in USUAL_NAMES["t"]]
        along = data.variables[times[0]].dims if times else ()
        inner = str(along[-1]) if along else ""
        others = [str(name) for name in data.dims if str(name) != inner and frame[name].nunique() > 1]
        if len(others) == 1 and ID_COLUMN not in frame:
            frame = frame.rename(columns={others[0]: ID_COLUMN})
        return _of_pandas(frame.dropna())
    names = [str(name) for name in data.variables]
    return names, lambda name: data[name].values


def _of_table(table: Table, asked: Asked, where: str) -> list[Samples]:
    """Return the solutions in a table."""
    names, column = _with_states_apart(*table, asked)
    found = find_columns(names, asked, where)
    values: Record = {name: column(own) for name, own in found.items()}
    ids = values.pop(ID_COLUMN, None)
    events = next((column(name) for name in names if name in NO_COLUMNS), None)
    if np.ndim(_plainly(values["x"])) > 1:
        return _of_rows(values, where)
    ids = None if ids is None else np.ravel(np.asarray(ids)).astype(str)
    if ids is None or len(np.unique(ids)) == len(ids):  # a column that has no value twice numbers the rows
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


def _by_id(values: Record, ids: np.ndarray) -> list[Samples]:
    """Return a solution for each id, in order of their first rows."""
    lengths = {name: len(column) for name, column in values.items()} | {ID_COLUMN: len(ids)}
    if len(set(lengths.values())) > 1:
        raise ParameterError("lengths", lengths, "the columns must have one length")
    names, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
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
