"""Read solutions from Python objects.

Tables of any package, solver results, arrays, functions, lists of these.

None of the packages is imported: the attributes of an object show what it is. `run_solver` calls
somebody's function.
"""

from __future__ import annotations

import re
import sys
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import redirect_stdout, suppress
from dataclasses import replace
from functools import partial
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from inspect import iscoroutine
from itertools import chain, pairwise, zip_longest
from math import ceil, inf, isfinite, nan, pi
from pathlib import Path
from traceback import extract_tb
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, brief
from symosc.base.exact import unmasked
from symosc.crosschecks.samples import SAMPLE_COLUMNS, Samples, checked, fastest_rate
from symosc.model import Parameters
from symosc.scenes import Scene
from symosc.simulation.trajectory import Trajectory

# -- names of columns --------------------------------------------------------------------------------------------------

#: Columns asked for by name: of t, x, v and id; None: there is no such column.
Asked = Mapping[str, str | None]
#: The column that says to which of several trajectories a row belongs.
ID_COLUMN = "id"
#: The usual names of columns, in any case and without units.
USUAL_NAMES = {
    "t": {"t", "time", "times", "ts"},
    "x": {"x", "position", "positions", "pos", "displacement", "disp", "q", "xs"},
    "v": {
        "v",
        "velocity",
        "velocities",
        "vel",
        "speed",
        "xdot",
        "dx",
        "dxdt",
        "xprime",
        "qdot",
        "vx",
        "vs",
    },
    ID_COLUMN: {
        "id",
        "ids",
        "trajectory",
        "trajectories",
        "traj",
        "run",
        "case",
        "motion",
        "trajectoryid",
        "runid",
    },
}
#: The entry of a file or a mapping that is no column of samples; names of arrays that hold x and v
#: together.
EVENTS = "events"
#: Events of scipy's solve_ivp and of MATLAB's ode45; they are no columns of samples either.
SOLVER_EVENTS = ("t_events", "y_events", "te", "xe", "ye", "ie")
STATE_NAMES = ("y", "ys", "u", "z", "state", "states", "sol", "solution", "data")
NONE = "none"
MISSING: Any = object()  # in place of what an object has not
MOST_NAMES = 12  # in a message


def read_column_names(columns: Mapping[str, str | None] | None) -> dict[str, str | None]:
    """Check and return `columns`, column names by t, x, v and id.

    "none", for a missing column, becomes None.
    """
    if columns is not None and not isinstance(columns, Mapping):
        raise ParameterError("columns", columns, 'must be a mapping, such as {"x": "position"}')
    asked: dict[str, str | None] = {}
    for name, column in (columns or {}).items():
        if name not in USUAL_NAMES:
            raise ParameterError("columns", name, "only t, x and v are read, and id")
        if column is not None and not isinstance(column, str):
            raise ParameterError(
                "columns", column, f"must be text: the name of the column that holds {name}"
            )
        if column is None or column.lower() == NONE:
            asked[name] = None
        else:
            asked[name] = column
        if asked[name] is None and name in ("t", "x"):
            raise ParameterError("columns", f"{name}={NONE}", "a time and a position are needed")
    named = [column for column in asked.values() if column is not None]
    named += [name for name in SAMPLE_COLUMNS if name not in asked]
    if len(set(named)) < len(named):
        raise ParameterError("columns", asked, "t, x and v must be three columns")
    return asked


def plain(name: str) -> str:
    """Return a column name in lower case without units, brackets and signs.

    "Time (s)" is "time", "dx/dt" is "dxdt".
    """
    text = (
        unicodedata.normalize("NFKD", name[:200])
        .lower()
        .replace("\u0307", "dot")
        .replace("'", "prime")
    )
    text = re.sub(r"\([^)]*\)|\[[^\]]*\]|\{[^}]*\}", "", text) or text
    return "".join(letter for letter in text if letter.isalnum())


def is_wanted(name: str, asked: Asked | None) -> bool:
    """Return whether to read the column `name`.

    Any if `asked` is None, else one asked for or with a usual name.
    """
    if asked is None or plain(name) in set().union(*USUAL_NAMES.values()):
        return True
    return name.lower() in {column.lower() for column in asked.values() if column} | {
        EVENTS,
        *STATE_NAMES,
        *SOLVER_EVENTS,
    }


def refuse_twice(where: str, names: Iterable[str], asked: Asked | None) -> None:
    """Raise ParameterError if the name of a column to be read occurs twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen and is_wanted(name, asked):
            raise ParameterError("file", where, f"has {brief(name)!r} twice")
        seen.add(name)


def find_columns(names: Sequence[str], asked: Asked, where: str) -> dict[str, str]:
    """Find t, x and perhaps v, id among the column `names`, as `asked` or by usual names.

    ParameterError if unclear.
    """
    missing = f"is missing in {where}; there are: {names_text(names)}"
    found: dict[str, str] = {}
    free = [each for each in names if each not in asked.values()]
    for name, usual in USUAL_NAMES.items():
        column = asked.get(name)
        if column is not None:
            same = [each for each in names if each == column] or [
                e for e in names if e.lower() == column.lower()
            ]
            if len(set(same)) != 1:
                raise ParameterError("column", column, missing)
            found[name] = same[0]
        elif name not in asked:
            fitting = [each for each in free if each == name][:1] or [
                each for each in free if plain(each) in usual
            ]
            if len(fitting) > 1 and name in SAMPLE_COLUMNS:
                what = f"may be any of {names_text(fitting)} in {where}; say which, such as {name}={fitting[0]}"
                raise ParameterError("column", name, what)
            if fitting:
                found[name] = fitting[0]
    for name in ("t", "x"):
        if name not in found:
            left = [each for each in free if each not in found.values()]
            if left:
                say = f"; say which, such as {name}={brief(left[0])}"
            else:
                say = ""
            raise ParameterError("column", name, missing + say)
    if "v" not in found and "v" not in asked and set(names) - {*found.values(), EVENTS}:
        raise ParameterError(
            "column", "v", f"{missing}; without velocities, which are then computed: v=none"
        )
    return found


def names_text(names: Sequence[str]) -> str:
    """Return the first few names, joined for a message."""
    if len(names) > MOST_NAMES:
        more = [f"and {len(names) - MOST_NAMES} more"]
    else:
        more = []
    return ", ".join([*map(brief, names[:MOST_NAMES]), *more]) or "none"


# -- objects -----------------------------------------------------------------------------------------------------------

#: A table as columns by name; those of an array package, perhaps not yet in memory.
Table = dict[str, Any]
#: The problem that a function or a solver solves; None if it is not known.
Problem = Scene | Parameters | None


def solutions_in(
    source: Any, asked: Asked, problem: Problem = None, where: str = ""
) -> list[Samples]:
    """Return the solutions in an object.

    `where` names it in messages, `asked` are the names of its columns.
    """
    # A list of objects is several solutions, or pieces of one if each begins where the one before
    # ends.
    where = where or type(source).__name__
    if isinstance(source, Trajectory):
        events = tuple((float(event.t), event.kind) for event in source.events)
        times = _grid(float(source.t_start), float(source.t_end), source.parameters)
        times = np.unique([*times, *(t for t, _ in events)])
        return [
            replace(checked(times, *source(times)), events=events, notes=("an exact trajectory",))
        ]
    if isinstance(source, (list, tuple)):
        return _read_list(source, asked, problem, where)
    if not asked and not _has_x(source):
        found = _read_result(source, problem)
        if found is not None:
            return found
    if callable(source) and not isinstance(source, Mapping) and not hasattr(source, "__array__"):
        return [of_function(source, problem)]
    if isinstance(source, np.ndarray) and source.dtype.names is None:
        if source.ndim != 2 or source.shape[1] not in (2, 3):
            what = "must have columns t, x, v, so the shape (n, 3); this is its shape"
            raise ParameterError(where, source.shape, what)
        return [checked(*source.T)]
    table = as_table(source)
    if table is None:
        raise ParameterError(
            "solution", source, "is no solution: give a file, a table, an array or a function"
        )
    return _read_table(table, asked, where, problem)


def _has_x(source: Any) -> bool:
    """Return whether an object is a table or a mapping with a column named "x"."""
    if isinstance(source, np.ndarray):
        return "x" in (source.dtype.names or ())
    with suppress(TypeError, ValueError):
        return hasattr(source, "__getitem__") and hasattr(source, "__contains__") and "x" in source
    return False


def _read_result(source: Any, problem: Problem) -> list[Samples] | None:
    """Return the solutions in a solver result (t and y, or ts and ys), or None for another object."""
    if isinstance(source, Mapping):
        of = source.get
    else:
        of = partial(getattr, source)
    for times, states in (("t", "y"), ("ts", "ys")):
        t = of(times, MISSING)
        y = of(states, MISSING)
        if t is MISSING or y is MISSING or callable(t) or callable(y):
            continue
        if isinstance(y, Mapping):
            return solutions_in({"t": t, **y}, {}, None, type(source).__name__)
        found = _read_states(np.asarray(t), y, states)
        if getattr(source, "success", True):
            notes = []
        else:
            notes = [f"the solver says: {getattr(source, 'message', 'failed')}"]
        if len(found) == 1:
            listed = _solver_events(of, problem, found[0])
            dense = getattr(source, "sol", None)
            found = [
                replace(
                    found[0],
                    events=listed.events,
                    lists=listed.lists,
                    notes=(*notes, *listed.notes),
                    dense=dense if callable(dense) else None,
                )
            ]
        return found
    return None


def _read_states(t: np.ndarray, y: Any, name: str) -> list[Samples]:
    """Return solutions from times and states: x and v as two rows, two columns or a pair."""
    try:
        y = np.asarray(y, dtype=float)
    except (TypeError, ValueError):
        raise ParameterError(
            name, "ragged", "must have two rows, x and v, so the shape (2, n)"
        ) from None
    # a column of MATLAB
    if t.size == max(t.shape, default=0):
        t = t.ravel()
    if t.ndim == 2 and y.ndim == 3 and len(t) == len(y):
        return [
            replace(_read_states(*pair, name)[0], name=str(i))
            for i, pair in enumerate(zip(t, y, strict=True))
        ]
    if y.shape == (2, t.size):
        rows = y
    else:
        rows = y.T
    if y.ndim != 2 or rows.shape != (2, t.size):
        raise ParameterError(
            name, y.shape, "must have two rows, x and v, so the shape (2, n); this is its shape"
        )
    # Solvers with arrays of one size fill them up with inf.
    padded = t.ndim == 1 and t.dtype.kind == "f" and len(t) > 2 and np.isinf(t[-1])
    kept = slice(int(np.argmax(np.isinf(t))) if padded else None)
    return [checked(t[kept], rows[0][kept], rows[1][kept])]


def _read_list(source: Sequence[Any], asked: Asked, problem: Problem, where: str) -> list[Samples]:
    """Return the solutions in a list of rows, of whole solutions, or of consecutive pieces of one solution."""
    if not source:
        raise ParameterError("solution", source, "is empty")
    if all(
        isinstance(row, Mapping) and all(np.ndim(row[name]) == 0 for name in row if name != EVENTS)
        for row in source
    ):
        names = dict.fromkeys(name for row in source for name in row)
        return _read_table(
            {str(name): [row.get(name) for row in source] for name in names}, asked, where
        )
    rows = (list, tuple, np.ndarray)
    numbers = (int, float, str, np.number)
    if all(
        isinstance(row, rows) and len(row) and all(isinstance(value, numbers) for value in row)
        for row in source
    ):
        lengths = {len(row) for row in source}
        if len(lengths) > 1:
            raise ParameterError(
                where, sorted(lengths), "has rows of several lengths; each must be t, x, v"
            )
        columns = [list(column) for column in zip(*source, strict=True)]
        if len(columns) not in (2, 3):
            return solutions_in(np.empty((len(source), len(columns))), {}, None, where)
        return [checked(*columns)]
    found: list[Samples] = []
    for i, part in enumerate(source):
        if isinstance(part, (str, int, float)) or part is None:
            raise ParameterError(f"{where}[{i}]", part, "is no solution")
        try:
            found += solutions_in(part, asked, problem)
        except RecursionError:  # of a list that contains itself
            raise ParameterError(where, part, "is nested too deeply") from None
    # Two pieces meet if their times agree but for rounding.
    gaps = [
        abs(after.t[0] - before.t[-1]) / np.spacing(abs(before.t[-1]))
        for before, after in pairwise(found)
    ]
    if len(found) == 1 or max(gaps) > 4.0 or len({each.lacks_v for each in found}) > 1:
        return found
    joined: Record = {
        name: np.concatenate([getattr(each, name) for each in found]) for name in SAMPLE_COLUMNS
    }
    begin = np.cumsum([len(each.t) for each in found[:-1]])
    joined["t"][begin] = np.maximum(joined["t"][begin], joined["t"][begin - 1])
    listed = [each.events for each in found if each.events is not None]
    if listed:
        joined["events"] = tuple(chain.from_iterable(listed))
    by_function = [each.lists for each in found if each.lists is not None]
    if by_function:
        # A piece without such lists claims nothing, and so the whole does not.
        functions = zip_longest(*by_function, fillvalue=())
        are_complete = len(by_function) == len(found)
        lists = tuple(tuple(chain.from_iterable(times)) for times in functions)
        joined["lists"] = lists if are_complete else ()
    notes = dict.fromkeys(note for each in found for note in each.notes)
    return [Samples(**joined, notes=(*notes, f"joined from {len(found)} pieces"))]


# -- tables ------------------------------------------------------------------------------------------------------------


def as_table(source: Any) -> Table | None:
    """Return a mapping, structured array, or table of pandas, polars, xarray or pyarrow as a table, else None."""
    package = type(source).__module__.partition(".")[0]
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


def _pandas_table(frame: Any) -> Table:
    """Return a DataFrame as a table; the levels of a named index become columns too."""
    if any(
        name is not None and str(name) not in map(str, frame.columns) for name in frame.index.names
    ):
        frame = frame.reset_index()
    if len({str(name) for name in frame.columns}) < len(frame.columns):
        raise ParameterError("DataFrame", list(frame.columns), "has two columns of one name")
    return {str(name): frame.iloc[:, i].to_numpy() for i, name in enumerate(frame.columns)}


def _xarray_table(data: Any) -> Table:
    """Return an xarray Dataset as a table.

    Of two dimensions, the one that is not time becomes the id of solutions.
    """
    if max((len(variable.dims) for variable in data.variables.values()), default=0) <= 1:
        return {str(name): variable for name, variable in data.variables.items()}
    frame = data.to_dataframe().reset_index()
    along = next(
        (
            each.dims
            for name, each in data.variables.items()
            if plain(str(name)) in USUAL_NAMES["t"]
        ),
        (),
    )
    others = [
        str(name) for name in data.dims if name not in along[-1:] and frame[name].nunique() > 1
    ]
    if len(others) == 1 and ID_COLUMN not in frame:
        frame = frame.rename(columns={others[0]: ID_COLUMN})
    return _pandas_table(frame.dropna())


def _read_table(table: Table, asked: Asked, where: str, problem: Problem = None) -> list[Samples]:
    """Return the solutions in a table.

    A single one, or one for each id or for each row of matrices.
    """
    table = _with_columns_of_states(table, asked)
    names = find_columns([name for name in table if name not in SOLVER_EVENTS], asked, where)
    values: Record = {name: table[own] for name, own in names.items()}
    ids = values.pop(ID_COLUMN, None)
    events = table.get(EVENTS)
    if np.ndim(_array(values["x"])) > 1:
        found = _read_matrices(values, where)
        return [_with_solver_events(found[0], table, problem)] if len(found) == 1 else found
    if np.ndim(_array(values["t"])) == 2 and 1 in _array(values["t"]).shape:
        values["t"] = _array(values["t"]).ravel()  # a column of MATLAB
    if ids is not None:
        ids = np.ravel(np.asarray(ids)).astype(str)
    # A column that has no value twice numbers the rows.
    if ids is None or len(np.unique(ids)) == len(ids):
        samples = checked(**values, events=events)
        return [samples if events is not None else _with_solver_events(samples, table, problem)]
    if events is not None:
        raise ParameterError(
            "events", "given", f"can be listed for one solution; {where} has several"
        )
    return _split_by_id(values, ids)


def _with_solver_events(samples: Samples, table: Table, problem: Problem) -> Samples:
    """Return samples with the events that a solver has left in the same table."""
    listed = _solver_events(table.get, problem, samples)
    notes = (*samples.notes, *listed.notes)
    return replace(samples, events=listed.events, lists=listed.lists, notes=notes)


def _with_columns_of_states(table: Table, asked: Asked) -> Table:
    """Return a table with columns x and v in place of a matrix of states, as solvers return it."""
    names = [name for name in table if name not in SOLVER_EVENTS]
    usual = {"t": USUAL_NAMES["t"], "x": USUAL_NAMES["x"], "v": USUAL_NAMES["v"]}
    have = {
        key: [name for name in names if name == asked.get(key) or plain(name) in usual[key]]
        for key in usual
    }
    is_named_x = bool(have["x"]) or "x" in asked
    if is_named_x:
        # Rows of x without v may be several solutions: positions alone.
        candidates = have["x"] if have["t"] and not have["v"] else []
    else:
        candidates = [name for name in names if name.lower() in STATE_NAMES]
    for name in candidates:
        both = _array(table[name])
        if both.ndim != 2 or 2 not in both.shape:
            continue
        by_rows = len(both) == 2 and both.shape != (2, 2)
        x, v = both if by_rows else both.T
        columns: Table = {"x": x, "v": v}
        rest = {each: column for each, column in table.items() if each != name}
        if is_named_x:
            times = _array(rest.pop(have["t"][0])).ravel()
            if len(times) != len(x) or (by_rows and not _is_velocity(times, x, v)):
                continue
            columns["t"] = times
        if asked.get("v", "") is None:
            columns.pop("v")
        return rest | columns
    return table


def _is_velocity(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> bool:
    """Return whether v is the velocity of x, roughly: steps of x are those of the mean v."""
    try:
        t, x, v = (np.asarray(values, dtype=float).ravel() for values in (t, x, v))
    except (TypeError, ValueError):
        return False
    steps = np.diff(x)
    off = steps - 0.5 * (v[1:] + v[:-1]) * np.diff(t)
    return bool(np.sum(np.abs(off)) <= 0.5 * np.sum(np.abs(steps)))


def _array(values: Any) -> np.ndarray:
    """Return a column as a numpy array.

    An empty one if its entries have different lengths, which is refused later.
    """
    try:
        return np.asarray(values)
    except ValueError:  # ragged; the check of the samples says where
        return np.empty(0)


def _read_matrices(values: Record, where: str) -> list[Samples]:
    """Return the solutions in columns that are matrices: one solution per row, or per column."""
    arrays = {name: np.asarray(value) for name, value in values.items()}
    if arrays["t"].ndim:
        count = arrays["t"].shape[-1]
    else:
        count = 0
    shapes = {name: array.shape for name, array in arrays.items()}
    if all(
        array.size == max(array.shape, default=0) for array in arrays.values()
    ):  # one row or column each
        return [checked(**{name: array.ravel() for name, array in arrays.items()})]
    if arrays["t"].ndim == 1 and arrays["x"].shape[-1] != count and arrays["x"].shape[0] == count:
        arrays = {name: array.T for name, array in arrays.items()}
    sizes = {array.shape for name, array in arrays.items() if name != "t" or array.ndim > 1}
    if len(sizes) != 1 or len(shape := sizes.pop()) != 2 or shape[1] != arrays["t"].shape[-1]:
        raise ParameterError(
            "shapes", shapes, f"do not fit in {where}: x and v need a row for each solution"
        )
    rows = {name: np.broadcast_to(array, shape) for name, array in arrays.items()}
    found = [checked(**{name: row[i] for name, row in rows.items()}) for i in range(shape[0])]
    if len(found) > 1:
        return [replace(each, name=str(i)) for i, each in enumerate(found)]
    return found


def _split_by_id(values: Record, ids: np.ndarray) -> list[Samples]:
    """Return one solution per id, in order of their first rows."""
    lengths = {name: len(column) for name, column in values.items()} | {ID_COLUMN: len(ids)}
    if len(set(lengths.values())) > 1:
        raise ParameterError("lengths", lengths, "the columns must have the same length")
    columns = {name: np.asarray(column) for name, column in values.items()}
    found = []
    names, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
    rows = np.split(np.argsort(inverse, kind="stable"), np.cumsum(np.bincount(inverse))[:-1])
    for i in np.argsort(first).tolist():
        try:
            one = checked(**{name: column[rows[i]] for name, column in columns.items()})
        except ParameterError as error:
            raise ParameterError(
                error.name, error.value, f"{error.allowed} (id {names[i]})"
            ) from None
        found.append(replace(one, name=str(names[i]) if len(names) > 1 else ""))
    return found


# -- functions, trajectories, results with events ----------------------------------------------------------------------

# A function is called at no more times than these.
MOST_TIMES = 200_000


def _grid(t0: float, t_end: float, problem: Scene | Parameters) -> np.ndarray:
    """Return evenly spaced times, fine enough for the shorter period of the drive and the free motion."""
    if isinstance(problem, Parameters):
        p = problem
    else:
        p = problem.parameters
    period = 2.0 * pi / fastest_rate(p)
    count = ceil(min((t_end - t0) / period * 200, float(MOST_TIMES)))
    return np.linspace(t0, t_end, min(max(count, 1_000), MOST_TIMES) + 1)


def of_function(function: Callable[..., Any], problem: Problem, times: Any = None) -> Samples:
    """Return samples of a function t -> (x, v) at the given `times`, or if None at many times from start to end.

    Start and end are t_min and t_max if the function has these attributes, as scipy's OdeSolution
    has, else those of the scene `problem`.
    """
    if times is None:
        ends: list[Any] = [getattr(function, name, None) for name in ("t_min", "t_max")]
        if None in ends and isinstance(problem, Scene):
            ends = [problem.t0, problem.t_end]
        if None in ends or problem is None:
            what = "needs times: give crosscheck(parameters, t, function), or a scene, which says from when to when"
            raise ParameterError(
                "function", getattr(function, "__name__", type(function).__name__), what
            )
        times = _grid(float(ends[0]), float(ends[1]), problem)
        nodes = getattr(function, "ts", None)
        if nodes is not None:
            times = np.unique([*times, *np.asarray(nodes, dtype=float)])
    times = checked(times, np.zeros(np.shape(times)), np.zeros(np.shape(times))).t
    return replace(
        checked(times, *_evaluated(function, times)),
        notes=(f"the function was asked at {len(times)} times",),
    )


def _evaluated(function: Callable[..., Any], times: np.ndarray) -> np.ndarray:
    """Return x and v of a function that takes all times at once or one by one."""
    with suppress(Exception):  # masked, or whatever it raises if it takes single numbers alone
        states = np.asarray(unmasked("function", function(times)), dtype=float)
        if (2, len(times)) in (states.shape, states.shape[::-1]):
            if len(states) == 2:
                return states
            return states.T
    single = []
    for time in times.tolist():
        try:
            value = function(time)
        except ParameterError:
            raise
        except Exception as error:  # it is somebody's; the traceback goes on to its own line
            what = brief(f"{type(error).__name__}: {error}".partition("\n")[0])
            name = getattr(function, "__name__", "?")
            raise ParameterError("function", name, f"fails at t = {time:g}: {what}") from error
        single.append(np.ravel(unmasked("function", value)))
    if any(len(state) != 2 for state in single):
        raise ParameterError(
            "function", len(single[0]), "must return two numbers, x and v; it returned so many"
        )
    return np.array(single).T


def dense_note(trajectory: Trajectory, dense: Callable[[np.ndarray], Any], until: float) -> str:
    """Return a note that says how far a solver's dense output is from the exact motion up to the time `until`."""
    ends = (getattr(dense, "t_min", -inf), getattr(dense, "t_max", inf))
    low = max(float(trajectory.t_start), float(ends[0]))
    high = min(until, float(ends[1]))
    if not low < high:
        return "the dense output and the exact motion have no times in common"
    times = _grid(low, high, trajectory.parameters)
    errors = np.abs(_evaluated(dense, times) - trajectory(times))
    x, v = (float(np.max(row)) for row in errors)
    worst = float(times[int(np.argmax(errors[1]))])
    return f"the dense output is off by up to {x:.2e} in x, {v:.2e} in v (at t = {worst:.10g}, of {len(times):,} times)"


class SolverEvents(NamedTuple):
    """Times that a solver's event functions found at a belt, and notes on the others.

    `events` are pairs (t, ""), their kinds being unknown; `lists` the same times by function.
    """

    events: tuple[tuple[float, str], ...] | None = None
    lists: tuple[tuple[float, ...], ...] | None = None
    notes: tuple[str, ...] = ()


def _solver_events(of: Callable[..., Any], problem: Problem, samples: Samples) -> SolverEvents:
    """Return the `t_events` of a result, or its te and ie, by event function.

    `of` returns an attribute or an entry of the result by name. A function that finds a time where
    v is not a belt's looks for something else, and is left out; an empty list may be that of a
    belt.
    """
    lists = of("t_events", None)
    states = of("y_events", None)
    if lists is None:
        lists, states = _lists_of_matlab(of)
    if lists is None or problem is None:
        return SolverEvents()
    p = problem if isinstance(problem, Parameters) else problem.parameters
    kept: list[tuple[float, ...]] = []
    beside = 0
    for i, values in enumerate(lists if np.iterable(lists) else [nan]):
        unmasked("t_events", values)
        try:
            times = np.ravel(np.asarray(values, dtype=float)).tolist()
        except (TypeError, ValueError):
            times = [nan]
        if not all(map(isfinite, times)):
            raise ParameterError("t_events", brief(repr(values)), "must be lists of finite times")
        try:
            speeds = None
            if states is not None:
                speeds = [float(np.ravel(states[i][j])[-1]) for j in range(len(times))]
        except (IndexError, KeyError, TypeError, ValueError):
            what = "must have x and v for each of t_events"
            raise ParameterError("y_events", type(states).__name__, what) from None
        if _are_at_belts(p, samples, times, speeds):
            kept.append(tuple(times))
        else:
            beside += 1
    if not any(kept):
        return SolverEvents(lists=tuple(kept))
    # Two functions that vanish together, such as an event that ends a piece, are one event.
    distinct: list[float] = []
    for time in sorted(chain.from_iterable(kept)):
        if not distinct or time - distinct[-1] > 1e-9 * 2.0 * pi / fastest_rate(p):
            distinct.append(time)
    notes = [
        "the times of events are the solver's t_events; they must have every contact at a belt that they are about, "
        "and the rest is read off the samples"
    ]
    if beside:
        functions = "1 event function finds" if beside == 1 else f"{beside} event functions find"
        notes.append(f"{functions} times that are not at a belt: left out")
    return SolverEvents(tuple((time, "") for time in distinct), tuple(kept), tuple(notes))


def _lists_of_matlab(of: Callable[..., Any]) -> tuple[Any, Any]:
    """Return times and states by event function from the te, ye (or xe) and ie of MATLAB's ode45.

    None without te.
    """
    te = of("te", None)
    if te is None:
        return None, None
    times = np.ravel(te)
    states = next((of(name, None) for name in ("ye", "xe") if of(name, None) is not None), None)
    states = None if states is None else np.reshape(_array(states), (len(times), -1))
    ie = of("ie", None)
    functions = np.zeros(len(times)) if ie is None else np.ravel(ie)
    if len(functions) != len(times):
        raise ParameterError(
            "ie", len(functions), f"must have one number for each of {len(times)} te"
        )
    rows = [functions == number for number in np.unique(functions)]
    return [times[row] for row in rows], None if states is None else [states[row] for row in rows]


def _are_at_belts(
    p: Parameters, samples: Samples, times: Sequence[float], speeds: Sequence[float] | None
) -> bool:
    """Return whether v is the speed of a belt at all times.

    Without `speeds`, of the samples around them.
    """
    belts = np.array([[float(p.v1)], [float(p.v2)]])
    largest = 0.0 if samples.lacks_v else float(np.max(np.abs(samples.v)))
    if speeds is None:
        if samples.lacks_v:
            return True
        after = np.clip(np.searchsorted(samples.t, times), 1, len(samples.t) - 1)
        around = np.stack([samples.v[after - 1], samples.v[after]])
        low = np.min(around, axis=0) - 1e-6 * largest
        high = np.max(around, axis=0) + 1e-6 * largest
        return bool(np.all(np.any((belts >= low) & (belts <= high), axis=0)))
    v = np.array(speeds)
    near = 1e-6 * np.maximum(np.abs(v), max(largest, 1e-300))
    return bool(np.all(np.any(np.abs(v - belts) <= near, axis=0)))


# -- solvers named on the command line ---------------------------------------------------------------------------------


def run_solver(name: str, scene: Scene) -> Any:
    """Return what the solver "MODULE:FUNCTION" or "file.py:FUNCTION" returns for (parameters, t0, x0, v0, t_end)."""
    # It prints to standard error. ParameterError if it does not exist, fails, or returns nothing.
    module, colon, function = name.rpartition(":")
    if not (module and colon and function):
        raise ParameterError("solver", name, "must be MODULE:FUNCTION, such as mysolver:solve")
    with redirect_stdout(sys.stderr):
        try:
            solve = _imported(module)
        except (Exception, SystemExit) as error:
            raise ParameterError(
                "solver", name, f"cannot be imported: {_error_text(error)}"
            ) from None
        for part in function.split("."):
            solve = getattr(solve, part, None)
        if not callable(solve):
            raise ParameterError(
                "solver", name, f"{brief(function)} is no function of {brief(module)}"
            )
        try:
            solution = solve(
                scene.parameters,
                *(float(getattr(scene, each)) for each in ("t0", "x0", "v0", "t_end")),
            )
        except (Exception, SystemExit) as error:
            raise ParameterError("solver", name, f"failed: {_error_text(error)}") from None
    if iscoroutine(solution):
        solution.close()  # or Python warns on standard error that nobody waited for it
        raise ParameterError("solver", name, "is async; it must return a solution")
    if solution is None:
        raise ParameterError("solver", name, "returned None; it must return a solution")
    return solution


def _imported(name: str) -> Any:
    """Import a module, given its name or the name of its file."""
    if not name.endswith(".py"):
        if "" not in sys.path:
            sys.path.insert(0, "")  # the folder in which the command runs
        return import_module(name)
    spec = spec_from_file_location(Path(name).stem, name)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def _error_text(error: BaseException) -> str:
    """Return an error as one line, with the place where it was raised."""
    own = ("importlib", __file__)
    frames = [
        frame
        for frame in extract_tb(error.__traceback__)
        if not any(name in frame.filename for name in own)
    ]
    if frames:
        place = f" (line {frames[-1].lineno} of {Path(frames[-1].filename).name})"
    else:
        place = ""
    return brief(f"{type(error).__name__}: {error}") + place
