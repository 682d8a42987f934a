"""Turn Python objects into named columns: tables of any package, results of solvers, functions.

None of the packages is imported: the attributes of an object show what it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.crosschecks.reading.functions import Problem, even_times, times_for, values_at
from symosc.crosschecks.reading.names import (
    EVENTS,
    ID_COLUMN,
    SOLVER_EVENTS,
    USUAL_NAMES,
    Asked,
    NamedColumns,
    plain,
)
from symosc.crosschecks.samples import SAMPLE_COLUMNS
from symosc.simulation.samples import MotionSamples
from symosc.simulation.trajectory import Trajectory

#: What times and states are called in the results of solvers.
RESULT_NAMES = (("t", "y"), ("ts", "ys"))
MISSING: Any = object()  # in place of what an object has not


def named_columns(source: Any, asked: Asked, problem: Problem, where: str) -> NamedColumns | None:
    """Return the columns of an object that holds solutions, None if it is no such object.

    `asked` are the names of its columns, `where` names it in messages; from `problem` a function
    gets its times.
    """
    if isinstance(source, NamedColumns):
        return source
    if isinstance(source, Trajectory):
        return _of_trajectory(source)
    if not asked and not _has_x(source):
        result = _of_result(source)
        if result is not None:
            return result
    is_array = hasattr(source, "__array__")
    if callable(source) and not isinstance(source, Mapping) and not is_array:
        return of_function(source, problem)
    if isinstance(source, np.ndarray) and source.dtype.names is None:
        if source.ndim != 2 or source.shape[1] not in (2, 3):
            what = "must have columns t, x, v, so the shape (n, 3); this is its shape"
            raise ParameterError(where, source.shape, what)
        return NamedColumns(dict(zip(SAMPLE_COLUMNS, source.T, strict=False)), are_matched=True)
    table = as_table(source)
    return None if table is None else NamedColumns(table)


def _has_x(source: Any) -> bool:
    """Return whether an object is a table or a mapping with a column named "x"."""
    if isinstance(source, np.ndarray):
        return "x" in (source.dtype.names or ())
    with suppress(TypeError, ValueError):
        return hasattr(source, "__getitem__") and hasattr(source, "__contains__") and "x" in source
    return False


def _of_trajectory(motion: Trajectory) -> NamedColumns:
    """Return the columns of an exact motion: even times and those of its events."""
    events = [(float(event.t), event.kind) for event in motion.events]
    times = even_times(float(motion.t_start), float(motion.t_end), motion.parameters)
    times = np.unique([*times, *(t for t, _ in events)])
    x, v = motion(times)
    columns = {"t": times, "x": x, "v": v, EVENTS: events}
    return NamedColumns(columns, are_matched=True, notes=("an exact trajectory",))


def of_function(function: Any, problem: Problem, times: Any = None) -> NamedColumns:
    """Return the columns of a function t -> (x, v), at the given times or at those that resolve the
    `problem`.
    """
    if times is None:
        times = times_for(function, problem)
    times, (x, v) = values_at(function, times)
    note = f"the function was asked at {len(times)} times"
    return NamedColumns({"t": times, "x": x, "v": v}, are_matched=True, notes=(note,))


# -- results of solvers ----------------------------------------------------------------------------


def _of_result(source: Any) -> NamedColumns | None:
    """Return the columns of a solver's result (t and y, or ts and ys), None for another object."""
    is_mapping = isinstance(source, Mapping)
    entry = source.get if is_mapping else partial(getattr, source)
    for times, states in RESULT_NAMES:
        t = entry(times, MISSING)
        y = entry(states, MISSING)
        if t is MISSING or y is MISSING or callable(t) or callable(y):
            continue
        if isinstance(y, Mapping):
            return NamedColumns({"t": t, **y})
        columns = _columns_of_states(t, y, states)
        beside = (*SOLVER_EVENTS, EVENTS) if is_mapping else SOLVER_EVENTS
        columns |= {name: entry(name, None) for name in beside}
        notes: tuple[str, ...] = ()
        if not getattr(source, "success", True):
            notes = (f"the solver says: {getattr(source, 'message', 'failed')}",)
        dense = getattr(source, "sol", None)
        return NamedColumns(
            columns,
            are_matched=True,
            are_padded=True,
            notes=notes,
            dense=dense if callable(dense) else None,
        )
    return None


def _columns_of_states(t: Any, y: Any, name: str) -> Record:
    """Return times and states as columns t, x and v, which are matrices if there are many runs."""
    times = np.asarray(t)
    try:
        states = np.asarray(y, dtype=float)
    except (TypeError, ValueError):
        what = "must have two rows, x and v, so the shape (2, n)"
        raise ParameterError(name, "ragged", what) from None
    if times.size == max(times.shape, default=0):  # a column of MATLAB
        times = times.ravel()
    rows = states_as_rows(times, states)
    if rows is None:
        what = "must have two rows, x and v, so the shape (2, n); this is its shape"
        raise ParameterError(name, states.shape, what)
    return {"t": times, "x": rows[0], "v": rows[1]}


def states_as_rows(
    times: np.ndarray, states: np.ndarray, prefer_columns: bool = False
) -> np.ndarray | None:
    """Return the array of all x and that of all v in an array of states; None if it is none.

    They are as many as the times. x and v may be rows, as scipy has them, or columns, as MATLAB
    has them; two states at two times are rows, unless columns are preferred.
    """
    candidates = [
        np.moveaxis(states, axis, 0)
        for axis in range(times.ndim - 1, states.ndim)
        if states.shape[axis] == 2 and np.delete(states.shape, axis).tolist() == [*times.shape]
    ]
    if not candidates or not times.ndim:
        return None
    return candidates[-1] if prefer_columns else candidates[0]


def is_velocity(t: Any, x: Any, v: Any) -> bool:
    """Return whether v is the velocity of x, roughly: steps of x are those of the mean v."""
    try:
        t, x, v = (np.asarray(values, dtype=float).ravel() for values in (t, x, v))
    except (TypeError, ValueError):
        return False
    steps = np.diff(x)
    off = steps - 0.5 * (v[1:] + v[:-1]) * np.diff(t)
    return bool(np.sum(np.abs(off)) <= 0.5 * np.sum(np.abs(steps)))


# -- tables ----------------------------------------------------------------------------------------


def as_table(source: Any) -> Record | None:
    """Return a mapping, a structured array, samples of a motion, or a table of pandas, polars, xarray
    or pyarrow as a table, else None.
    """
    package = type(source).__module__.partition(".")[0]
    if isinstance(source, MotionSamples):
        return source.columns()
    if isinstance(source, np.ndarray):
        if source.dtype.names is None:
            return None
        return {name: source[name] for name in source.dtype.names}
    if package == "pandas" and hasattr(source, "columns"):
        return _pandas_table(source)
    if package == "xarray" and hasattr(source, "data_vars"):
        return _xarray_table(source)
    if isinstance(source, Mapping):
        return {str(name): column for name, column in source.items()}
    if package == "pyarrow":
        names = getattr(getattr(source, "schema", None), "names", None)
        if names is None:
            return None
        return {name: source.column(i) for i, name in enumerate(names)}
    columns = getattr(source, "columns", None)  # polars
    if isinstance(columns, list) and hasattr(source, "__getitem__"):
        return {str(name): source[name] for name in columns}
    return None


def _pandas_table(frame: Any) -> Record:
    """Return a DataFrame as a table; the levels of a named index become columns too."""
    names = {str(name) for name in frame.columns}
    if any(level is not None and str(level) not in names for level in frame.index.names):
        frame = frame.reset_index()
    if len({str(name) for name in frame.columns}) < len(frame.columns):
        raise ParameterError("DataFrame", list(frame.columns), "has two columns of one name")
    return {str(name): frame.iloc[:, i].to_numpy() for i, name in enumerate(frame.columns)}


def _xarray_table(data: Any) -> Record:
    """Return an xarray Dataset as a table.

    Of two dimensions, the one that is not time becomes the id of solutions.
    """
    if max((len(variable.dims) for variable in data.variables.values()), default=0) <= 1:
        return {str(name): variable for name, variable in data.variables.items()}
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
