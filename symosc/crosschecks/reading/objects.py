"""Turn Python objects into tables of named columns: tables of any package, results of solvers,
functions.

None of the packages is imported: the attributes of an object show what it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, optional
from symosc.crosschecks.frames import Problem
from symosc.crosschecks.reading.functions import even_times, times_for, values_at
from symosc.crosschecks.reading.names import (
    EVENTS,
    ID_COLUMN,
    KIND_COLUMN,
    USUAL_NAMES,
    Asked,
    plain,
)
from symosc.crosschecks.reading.tables import (
    BESIDE,
    ColumnTable,
    shape_of,
    table_of,
    table_of_matrix,
)
from symosc.crosschecks.reading.text import is_number
from symosc.crosschecks.samples import SAMPLE_COLUMNS
from symosc.simulation.samples import MotionSamples
from symosc.simulation.trajectory import Trajectory

#: What times and states are called in the results of solvers.
RESULT_NAMES = (("t", "y"), ("ts", "ys"))
MISSING: Any = object()  # in place of what an object has not
#: Longer lists of lists hold rows.
MOST_COLUMNS = 1000


def table_in(source: Any, asked: Asked, problem: Problem, where: str) -> ColumnTable | None:
    """Return the table in an object that holds solutions, None if it is no such object.

    `asked` are the names of its columns, `where` names it in messages; from `problem` a function
    gets its times.
    """
    if isinstance(source, ColumnTable):
        return source
    if isinstance(source, Trajectory):
        return _of_trajectory(source, asked)
    if isinstance(source, (list, tuple)) and not hasattr(source, "_fields"):
        return _of_sequence(source, asked, where)
    if not _has_x(source):
        result = _of_result(source, asked)
        if result is not None:
            return result
    is_array = hasattr(source, "__array__")
    if callable(source) and not isinstance(source, Mapping) and not is_array:
        return of_function(source, problem)
    columns = as_columns(source)
    if columns is not None:
        return table_of(columns, asked)
    if is_array:
        matrix = np.asarray(source)
        if matrix.ndim == 2 and matrix.dtype.kind in "OU":
            return _of_sequence(matrix.tolist(), asked, where)
        return table_of_matrix(matrix, asked, where)
    return None


def _has_x(source: Any) -> bool:
    """Return whether an object is a table, a mapping or a result with a column named "x"."""
    if isinstance(source, np.ndarray):
        return "x" in (source.dtype.names or ())
    with suppress(TypeError, ValueError):
        if hasattr(source, "__getitem__") and hasattr(source, "__contains__") and "x" in source:
            return True
    return "x" in getattr(source, "__dict__", ())


def _of_trajectory(motion: Trajectory, asked: Asked) -> ColumnTable:
    """Return the columns of an exact motion: even times and those of its events."""
    events = [(float(event.t), event.kind) for event in motion.events]
    times = even_times(float(motion.t_start), float(motion.t_end), motion.parameters)
    times = np.unique([*times, *(t for t, _ in events)])
    x, v = motion(times)
    columns = {"t": times, "x": x, "v": v, EVENTS: events}
    return table_of(columns, asked, notes=("an exact trajectory",))


def of_function(function: Any, problem: Problem, times: Any = None) -> ColumnTable:
    """Return the columns of a function t -> (x, v), at the given times or at those that resolve the
    `problem`.
    """
    if times is None:
        times = times_for(function, problem)
    times, (x, v) = values_at(function, times)
    note = f"the function was asked at {len(times)} times"
    return table_of({"t": times, "x": x, "v": v}, {}, notes=(note,))


# -- lists -----------------------------------------------------------------------------------------


def _of_sequence(source: Sequence[Any], asked: Asked, where: str) -> ColumnTable | None:
    """Return the table in a list or a tuple: of rows, or of columns such as t and states.

    None if it is a list of solutions.
    """
    if not len(source):
        raise ParameterError("solution", source, "is empty")
    if all(isinstance(row, Mapping) and _has_numbers(row) for row in source):
        names = dict.fromkeys(name for row in source for name in row)
        return table_of({str(name): [row.get(name) for row in source] for name in names}, asked)
    columns = _as_columns_of_states(source)
    if columns is not None:
        return table_of(columns, asked)
    if not all(map(_is_row, source)):
        return None
    head: Sequence[Any] = source[0]
    lengths = {len(row) for row in source}
    if len(lengths) > 1:
        what = "has rows of several lengths; each must be t, x, v"
        raise ParameterError(where, sorted(lengths), what)
    has_header = all(isinstance(name, str) and not is_number(name) for name in head)
    if has_header and len(source) > 1:
        cells = map(list, zip(*source[1:], strict=True))
        return table_of(dict(zip(head, cells, strict=True)), asked)
    if len(head) == 2 and isinstance(head[1], str) and not is_number(head[1]):
        t, kind = map(list, zip(*source, strict=True))
        return table_of({"t": t, KIND_COLUMN: kind}, asked)
    if len(head) <= 3 < len(source) or len(source) > MOST_COLUMNS:  # without a copy as an array
        cells = map(list, zip(*source, strict=True))
        return table_of({str(i): column for i, column in enumerate(cells, 1)}, asked)
    return table_of_matrix(np.array([list(row) for row in source], dtype=object), asked, where)


def _is_row(row: Any) -> bool:
    """Return whether an object is a sequence of numbers, perhaps written as text."""
    if not isinstance(row, (list, tuple, np.ndarray)) or not len(row):
        return False
    return all(isinstance(value, (int, float, str, np.number)) for value in row)


def _has_numbers(row: Mapping[Any, Any]) -> bool:
    """Return whether a mapping has a number for each name, as a row has, and no column."""
    return all(np.ndim(row[name]) == 0 for name in row if name != EVENTS)


def _as_columns_of_states(source: Sequence[Any]) -> Record | None:
    """Return the columns in t, x, v, or in t and an array of states; None if it is none.

    Two or three rows of lists could be both; they are rows.
    """
    if len(source) not in (2, 3) or isinstance(source[0], (str, Mapping)):
        return None
    first, *rest = source
    if isinstance(first, (list, tuple, np.ndarray)) or hasattr(first, "__array__"):
        shape = shape_of(first)
    else:
        return None
    if len(shape) != 1 or shape[0] < 2 or hasattr(first, "columns"):
        return None
    are_short = shape[0] <= 3 and not isinstance(first, np.ndarray)
    if are_short and all(map(_is_row, source)):
        return None
    shapes = [_shape_of_states(part) for part in rest]
    if len(rest) == 2 and all(inner == shape for inner in shapes):
        return dict(zip(SAMPLE_COLUMNS, source, strict=True))
    if len(rest) == 1 and shapes[0] == shape:
        return {"t": first, "x": rest[0]}
    if len(rest) == 1 and len(shapes[0]) == 2 and shape[0] in shapes[0]:
        return {"t": first, "y": np.asarray(rest[0])}
    return None


def _shape_of_states(part: Any) -> tuple[int, ...]:
    """Return the shape of an array, or of a list or tuple of lists; () if it has none."""
    if isinstance(part, (Mapping, str)):
        return ()
    with suppress(ValueError, TypeError):
        return np.shape(part)
    return ()


# -- results of solvers ----------------------------------------------------------------------------


def _of_result(source: Any, asked: Asked) -> ColumnTable | None:
    """Return the table of a solver's result (t and y, or ts and ys), None for another object."""
    is_mapping = isinstance(source, Mapping)
    entry = source.get if is_mapping else partial(getattr, source)
    for times, states in RESULT_NAMES:
        t = entry(times, MISSING)
        y = entry(states, MISSING)
        if t is MISSING or y is MISSING or callable(t) or callable(y):
            continue
        if isinstance(y, Mapping):
            return table_of({"t": t, **y}, asked)
        columns = _columns_of_states(t, y, states)
        if is_mapping:
            columns = {
                name: source[name] for name in source if name not in (times, states)
            } | columns
        columns |= {name: entry(name, None) for name in BESIDE if is_mapping or name != EVENTS}
        notes: tuple[str, ...] = ()
        if not getattr(source, "success", True):
            notes = (f"the solver says: {getattr(source, 'message', 'failed')}",)
        dense = getattr(source, "sol", None)
        about = {"are_padded": True, "notes": notes, "dense": dense if callable(dense) else None}
        return table_of(columns, asked, **about)
    return None


def _columns_of_states(t: Any, y: Any, name: str) -> Record:
    """Return times and states as columns: t and the states, or t, x and v of many runs."""
    times = np.asarray(t)
    try:
        states = np.asarray(y, dtype=float)
    except (TypeError, ValueError):
        what = "must have two rows, x and v, so the shape (2, n)"
        raise ParameterError(name, "ragged", what) from None
    if times.size == max(times.shape, default=0):  # a column of MATLAB
        times = times.ravel()
    if times.ndim == 1 and 1 <= states.ndim <= 2:
        rows = states.T if states.shape[0] == len(times) != states.shape[-1] else states
        if rows.ndim < 2 or rows.shape[1] != len(times):
            what = "must have two rows, x and v, so the shape (2, n); this is its shape"
            raise ParameterError(name, states.shape, what)
        return {"t": times} | {f"{name}[{i}]": row for i, row in enumerate(rows, 1)}
    axes = [
        axis
        for axis in range(max(times.ndim - 1, 0), states.ndim)
        if states.shape[axis] == 2 and np.delete(states.shape, axis).tolist() == [*times.shape]
    ]
    if not axes or not times.ndim:
        what = "must have two rows, x and v, so the shape (2, n); this is its shape"
        raise ParameterError(name, states.shape, what)
    x, v = np.moveaxis(states, axes[0], 0)
    return {"t": times, "x": x, "v": v}


# -- tables ----------------------------------------------------------------------------------------


def as_columns(source: Any) -> Record | None:
    """Return the columns by name in a mapping, a structured array, a data frame of any library, or
    an object whose attributes are columns; None if it has none.
    """
    if isinstance(source, MotionSamples):
        return source.columns()
    if isinstance(source, np.ndarray):
        if source.dtype.names is None:
            return None
        return {name: source[name] for name in source.dtype.names}
    if hasattr(source, "data_vars"):  # which is a mapping too
        return _xarray_table(source)
    if isinstance(source, Mapping):
        return {str(name): column for name, column in source.items()}
    if hasattr(source, "iloc") and hasattr(source, "index"):
        return _pandas_table(source)
    if hasattr(source, "dims") and hasattr(source, "coords"):
        return _of_data_array(source)
    for compute in ("collect", "compute", "read_all"):  # a lazy frame, or a reader
        has_columns = any(hasattr(source, name) for name in ("columns", "collect_schema", "schema"))
        if hasattr(source, compute) and has_columns and not hasattr(source, "__array__"):
            return as_columns(getattr(source, compute)())
    for as_mapping in ("fetchnumpy", "_asdict"):
        if hasattr(source, as_mapping):
            return as_columns(getattr(source, as_mapping)())
    names = getattr(getattr(source, "schema", None), "names", None)  # pyarrow
    if names is not None and callable(getattr(source, "column", None)):
        return {name: source.column(i) for i, name in enumerate(names)}
    for attribute in ("columns", "colnames"):
        names = getattr(source, attribute, None)
        if isinstance(names, (list, tuple)) and hasattr(source, "__getitem__"):
            return {str(name): source[name] for name in names}
    if hasattr(source, "to_pandas"):
        return as_columns(source.to_pandas())
    if hasattr(source, "__arrow_c_stream__"):
        return as_columns(optional("pyarrow", "a table of Arrow", "tables").table(source))
    return _attributes(source)


def _attributes(source: Any) -> Record | None:
    """Return the attributes of an object that are columns, one of them the time; else None."""
    names = [*getattr(source, "__dict__", ()), *getattr(type(source), "__slots__", ())]
    columns = {name: getattr(source, name, None) for name in names if name[:1] != "_"}
    columns = {name: values for name, values in columns.items() if shape_of(values)}
    if len(columns) > 1 and any(plain(name) in USUAL_NAMES["t"] for name in columns):
        return columns
    return None


def _of_data_array(array: Any) -> Record | None:
    """Return the columns in a DataArray of xarray that has the times as a coordinate."""
    times = [str(name) for name in array.coords if plain(str(name)) in USUAL_NAMES["t"]]
    if not times or array.ndim not in (1, 2):
        return None
    values = np.asarray(array)
    columns: Record = {times[0]: np.asarray(array.coords[times[0]])}
    if array.ndim == 1:
        return columns | {str(array.name or "x"): values}
    (along,) = array.coords[times[0]].dims
    (other,) = (name for name in array.dims if name != along)
    rows = values if array.dims[1] == along else values.T
    if other in array.coords:
        names = [str(name) for name in np.asarray(array.coords[other]).tolist()]
    else:
        names = [f"{array.name or 'y'}[{i}]" for i in range(1, len(rows) + 1)]
    return columns | dict(zip(names, rows, strict=True))


def _pandas_table(frame: Any) -> Record:
    """Return a DataFrame as a table; the levels of a named index become columns too."""
    if not hasattr(frame, "columns"):  # a Series
        frame = frame.to_frame(frame.name or "x")
    names = [_frame_name(name) for name in frame.columns]
    if len(set(names)) < len(names):
        raise ParameterError("DataFrame", list(frame.columns), "has two columns of one name")
    columns: Record = {name: frame.iloc[:, i].to_numpy() for i, name in enumerate(names)}
    has_named_index = any(
        level is not None and str(level) not in names for level in frame.index.names
    )
    if has_named_index:
        levels = frame.index.to_frame(index=False)
        columns = {
            str(name): levels.iloc[:, i].to_numpy() for i, name in enumerate(levels.columns)
        } | columns
    elif not any(plain(name) in USUAL_NAMES["t"] for name in names):
        index = np.asarray(frame.index)
        if index.dtype.kind in "fm":
            columns = {"t": index} | columns
    for name, values in columns.items():
        if values.dtype.kind == "m":  # durations
            columns[name] = values / np.timedelta64(1, "s")
    return columns


def _frame_name(name: Any) -> str:
    """Return the name of a column; that of a column with levels has dots between them."""
    if isinstance(name, tuple):
        return ".".join(str(part) for part in name if str(part))
    return str(name)


def _xarray_table(data: Any) -> Record:
    """Return an xarray Dataset as a table.

    Of two dimensions, the one that is not time becomes the id of solutions.
    """
    if max((len(variable.dims) for variable in data.variables.values()), default=0) <= 1:
        return {str(name): variable for name, variable in data.variables.items()}
    if not any(plain(str(name)) in USUAL_NAMES["x"] for name in data.data_vars):
        return {str(name): np.asarray(variable) for name, variable in data.variables.items()}
    frame = data.to_dataframe().reset_index()
    of_times = (
        variable.dims
        for name, variable in data.variables.items()
        if plain(str(name)) in USUAL_NAMES["t"]
    )
    along = next(of_times, ())[-1:]
    others = [str(name) for name in data.dims if name not in along and frame[name].nunique() > 1]
    if len(others) == 1 and ID_COLUMN not in frame:
        frame = frame.rename(columns={others[0]: ID_COLUMN})
    return _pandas_table(frame.dropna())
