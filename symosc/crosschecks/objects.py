"""Solutions as Python objects of any kind: results of solvers, functions, arrays, tables of other packages, lists.

None of the packages is imported: what an object has tells what it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.formats import Asked
from symosc.crosschecks.functions import SolverTask, of_function, of_trajectory, solver_events
from symosc.crosschecks.samples import Samples, checked, checked_positions, shown
from symosc.crosschecks.tables import as_table, of_table
from symosc.errors import ParameterError
from symosc.simulation.trajectory import Trajectory

# Two pieces of a solution meet if their times agree to this many units of the last place.
SAME_TIME = 4.0


def solutions_in(source: Any, asked: Asked, problem: SolverTask | None = None, where: str = "") -> list[Samples]:
    """Return the solutions that an object holds.

    Parameters
    ----------
    source : object
        An OdeResult of scipy or what has `t` and `y` like it, `ts` and `ys` of diffrax, a function t -> (x, v) or a
        dense output, a Trajectory; a DataFrame, an xarray Dataset, a table of pyarrow or polars, a mapping of columns,
        a structured array; an (n, 3) array of t, x, v or (n, 2) of t, x; rows as a list of dicts. A list of these is
        several solutions, or pieces of one if each begins where the one before ends.
    asked : mapping
        Names of columns, see `symosc.crosschecks.columns.asked_columns`.
    problem : SolverTask, optional
    where : str
        What a message calls it.

    Raises
    ------
    ParameterError
        If it is none of these, or the numbers are no solution.
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
    return of_table(table, asked, where)


def _has_column(source: Any, column: str) -> bool:
    if isinstance(source, np.ndarray):
        return column in (source.dtype.names or ())
    try:
        return hasattr(source, "__getitem__") and hasattr(source, "__contains__") and column in source
    except (TypeError, ValueError):
        return False


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
            return of_table({"t": t, **y}, {}, type(source).__name__)
        found = of_states(np.asarray(t), y, states)
        notes = [] if getattr(source, "success", True) else [f"the solver says: {getattr(source, 'message', 'failed')}"]
        events, more = solver_events(source, problem)
        if len(found) == 1:
            dense = getattr(source, "sol", None)
            dense = dense if callable(dense) else None
            found = [replace(found[0], events=events, notes=(*notes, *more), dense=dense)]
        return found
    return None


def of_states(t: np.ndarray, y: Any, name: str) -> list[Samples]:
    """Return solutions from times and states: x and v as two rows, two columns, or a pair; or a batch of these."""
    try:
        y = np.asarray(y, dtype=float)
    except (TypeError, ValueError):
        raise ParameterError(name, "ragged", "must have two rows, x and v, so the shape (2, n)") from None
    t = t.ravel() if t.size == max(t.shape, default=0) else t  # a column of MATLAB
    if t.ndim == 2 and y.ndim == 3 and len(t) == len(y):
        return [replace(of_states(*pair, name)[0], name=str(i)) for i, pair in enumerate(zip(t, y, strict=True))]
    if y.ndim == 2 and 2 in y.shape:
        rows = y if y.shape == (2, t.size) else y.T
        if rows.shape == (2, t.size):
            kept = slice(None) if t.ndim != 1 else _until_padding(t)
            return [checked(t[kept], rows[0][kept], rows[1][kept])]
    raise ParameterError(name, y.shape, "must have two rows, x and v, so the shape (2, n); this is its shape")


def _until_padding(t: np.ndarray) -> slice:
    """Return what is before the end of the times: solvers with arrays of one size fill them up with inf."""
    padded = t.dtype.kind == "f" and len(t) > 2 and np.isinf(t[-1])
    return slice(int(np.argmax(np.isinf(t)))) if padded else slice(None)


def _of_array(array: np.ndarray, where: str) -> Samples:
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ParameterError(where, array.shape, "must have columns t, x, v, so the shape (n, 3); this is its shape")
    return checked(*array.T) if array.shape[1] == 3 else checked_positions(*array.T)


def _of_list(source: Sequence[Any], asked: Asked, problem: SolverTask | None, where: str) -> list[Samples]:
    if not source:
        raise ParameterError("solution", shown(source), "is empty")
    if all(isinstance(row, Mapping) and _is_row(row) for row in source):
        names = list(dict.fromkeys(name for row in source for name in row))
        return of_table({name: [row.get(name) for row in source] for name in names}, asked, where)
    if all(isinstance(row, (list, tuple, np.ndarray)) and _are_numbers(row) for row in source):
        return [_of_array(_rows(source, where), where)]
    parts: list[list[Samples]] = []
    for i, part in enumerate(source):
        if isinstance(part, (str, int, float)) or part is None:
            raise ParameterError(f"{where}[{i}]", shown(part), "is no solution")
        parts.append(solutions_in(part, asked, problem))
    found = [samples for part in parts for samples in part]
    if len(found) > 1 and all(map(_meet, found, found[1:])):
        return [joined(found)]
    return found


def _is_row(row: Mapping[Any, Any]) -> bool:
    """Tell whether a mapping is a row, whose entries are numbers or texts, and not columns."""
    return all(value is None or np.ndim(value) == 0 for name, value in row.items() if name != "events")


def _are_numbers(row: Any) -> bool:
    return len(row) > 0 and all(isinstance(value, (int, float, str, np.number)) for value in row)


def _rows(source: Sequence[Any], where: str) -> np.ndarray:
    lengths = {len(row) for row in source}
    if len(lengths) > 1:
        raise ParameterError(where, sorted(lengths), "has rows of several lengths; each must be t, x, v")
    columns = [list(column) for column in zip(*source, strict=True)]
    if len(columns) not in (2, 3):
        return np.empty((len(source), len(columns)))
    samples = checked(*columns) if len(columns) == 3 else checked_positions(*columns)
    return np.column_stack([samples.t, samples.x, samples.v][: len(columns)])


def _meet(one: Samples, other: Samples) -> bool:
    """Tell whether one piece begins where another ends."""
    end, begin = float(one.t[-1]), float(other.t[0])
    return abs(begin - end) <= SAME_TIME * float(np.spacing(abs(end))) and one.lacks_v == other.lacks_v


def joined(pieces: Sequence[Samples]) -> Samples:
    """Return pieces of a solution as one."""
    columns: Record = {name: np.concatenate([getattr(each, name) for each in pieces]) for name in ("t", "x", "v")}
    begin = np.cumsum([len(each.t) for each in pieces[:-1]])
    columns["t"][begin] = np.maximum(columns["t"][begin], columns["t"][begin - 1])  # they agree but for rounding
    lists = [each.events for each in pieces if each.events is not None]
    events = tuple(pair for pairs in lists for pair in pairs) if lists else None
    notes = dict.fromkeys(note for each in pieces for note in each.notes)
    return Samples(**columns, events=events, notes=(*notes, f"joined from {len(pieces)} pieces"))
