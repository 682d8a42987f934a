"""Named columns: what every file and object becomes before its names are matched."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.crosschecks.reading.names import (
    EVENTS,
    SOLVER_EVENTS,
    USUAL_NAMES,
    Asked,
    find_columns,
    is_usual,
    plain,
    unsure_names,
)
from symosc.crosschecks.samples import SAMPLE_COLUMNS

#: Rows of a matrix that count as columns of a table.
MOST_ROWS = 1000
#: Of so many first samples advice is made.
ADVICE_SAMPLES = 50
#: What is no column of samples.
BESIDE = (EVENTS, *SOLVER_EVENTS)
DEEPEST_NESTING = 50


@dataclass(frozen=True)
class ColumnTable:
    """Columns by name.

    `headers` has the lists of their names that may be meant, the best first. `load` returns the
    columns at these places, by role. `beside` are values that are no columns, such as events.
    `are_padded`: times end with inf. `dense` is a solver's own function t -> (x, v), `notes` say how
    the columns were read, `header_notes` how a header was, by its number; `peek` returns the first
    values of a column, for advice.
    """

    headers: Sequence[Sequence[str]]
    load: Callable[[Mapping[str, int]], Record]
    beside: Record = field(default_factory=dict)
    are_padded: bool = False
    notes: tuple[str, ...] = ()
    dense: Callable[..., Any] | None = None
    peek: Callable[[int], Any] | None = None
    header_notes: Mapping[int, str] = field(default_factory=dict)

    def chosen(
        self, asked: Asked, where: str, *, needs_v: bool = True, with_kinds: bool = False
    ) -> Record:
        """Return the columns t, x and perhaps v and id, or t and kind, by these names.

        ParameterError, about the first header, if no header says which they are.
        """
        columns, _ = self.choice(asked, where, needs_v=needs_v, with_kinds=with_kinds)
        return columns

    def choice(
        self, asked: Asked, where: str, *, needs_v: bool = True, with_kinds: bool = False
    ) -> tuple[Record, tuple[str, ...]]:
        """Return the columns as `chosen` does, and notes on what was not sure about their names."""
        refusal: ParameterError | None = None
        for number, names in enumerate(self.headers):
            try:
                places = find_columns(
                    names,
                    asked,
                    where,
                    advice=self.advice,
                    needs_v=needs_v,
                    with_kinds=with_kinds,
                )
            except ParameterError as error:
                refusal = refusal or error
            else:
                notes = unsure_names(names, places, asked)
                if number in self.header_notes:
                    notes.append(self.header_notes[number])
                return self.load(places), tuple(notes)
        assert refusal is not None
        raise refusal

    def advice(self) -> dict[str, int]:
        """Return the places of columns that behave like t, x and v.

        The first that increases is t; of the next x and v, v is the velocity of x.
        """
        if self.peek is None:
            return {}
        columns: dict[int, np.ndarray] = {}
        for place in range(min(len(self.headers[0]), MOST_ROWS)):
            with suppress(Exception):  # text, ragged, or what cannot be loaded
                values = np.asarray(self.peek(place), dtype=float)
                if values.ndim == 1 and len(values) > 1:
                    columns[place] = values
        lengths = Counter(map(len, columns.values()))
        if not lengths:
            return {}
        ((length, _),) = lengths.most_common(1)
        columns = {place: values for place, values in columns.items() if len(values) == length}
        increasing = [place for place, values in columns.items() if np.all(np.diff(values) > 0)]
        if not increasing:
            return {}
        t = increasing[0]
        others = [place for place in columns if place != t]
        for x in others:
            for v in others:
                if x != v and is_velocity(columns[t], columns[x], columns[v]):
                    return {"t": t, "x": x, "v": v}
        return dict(zip(SAMPLE_COLUMNS, (t, *others), strict=False))


def is_velocity(t: Any, x: Any, v: Any) -> bool:
    """Return whether v is the velocity of x, roughly: steps of x are those of the mean v."""
    try:
        t, x, v = (np.asarray(values, dtype=float).ravel() for values in (t, x, v))
    except (TypeError, ValueError):
        return False
    steps = np.diff(x)
    size = np.sum(np.abs(steps))
    off = steps - 0.5 * (v[1:] + v[:-1]) * np.diff(t)
    return bool(np.sum(np.abs(off)) <= 0.5 * size)


# -- tables of arrays ------------------------------------------------------------------------------


def table_of(columns: Mapping[str, Any], asked: Asked, **about: Any) -> ColumnTable:
    """Return a table of columns by name, which may be matrices.

    A matrix NAME with one row or column for each time is NAME[1], NAME[2], ...; a nested mapping
    `out` with `t` is out.t. `asked` are the names asked for, `about` further fields of the table.
    """
    flat = flattened(columns)
    beside: Record = {}
    for name in list(flat):
        short = name.rpartition(".")[2]
        if short in BESIDE:
            beside[short] = _loaded(flat.pop(name))
    split = _split_matrices(flat, asked)
    names = list(split)
    values = list(split.values())

    def load(places: Mapping[str, int]) -> Record:
        return {role: _loaded(values[place]) for role, place in places.items()}

    return ColumnTable(
        headers=[names],
        load=load,
        beside=beside,
        peek=lambda place: _loaded(values[place])[:ADVICE_SAMPLES],
        **about,
    )


def table_of_matrix(matrix: np.ndarray, asked: Asked, where: str) -> ColumnTable:
    """Return the table in a matrix of samples, (n, columns) or (columns, n), without names."""
    if matrix.ndim != 2 or min(matrix.shape) < 2:
        what = "must have columns t, x, v, so the shape (n, 3) or (3, n); this is its shape"
        raise ParameterError(where, matrix.shape, what)
    columns = matrix.T if _has_samples_in_rows(matrix) else matrix
    return table_of({str(i): column for i, column in enumerate(columns, 1)}, asked)


def _has_samples_in_rows(matrix: np.ndarray) -> bool:
    """Return whether the rows of a matrix are samples: they are more, or as many, and the first
    column increases.
    """
    rows, columns = matrix.shape
    fits = {rows: columns in (2, 3), columns: rows in (2, 3)}
    if fits[rows] != fits[columns]:
        return fits[rows]
    if fits[rows] or rows == columns:
        return not (_increases(matrix[0]) and not _increases(matrix[:, 0]))
    return rows > columns


def _increases(values: Any) -> bool:
    with suppress(TypeError, ValueError):
        return bool(np.all(np.diff(np.asarray(values, dtype=float)) >= 0))
    return False


class Stored:
    """A column in a file that is read when it is needed."""

    def __init__(self, shape: tuple[int, ...], read: Callable[[], Any]) -> None:
        self.shape = shape
        self.read = read

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        return np.asarray(self.read(), dtype=dtype)


def _loaded(value: Any) -> Any:
    return value.read() if isinstance(value, Stored) else value


def array_of(values: Any) -> np.ndarray:
    """Return a column as a numpy array.

    An empty one if its entries have different lengths, which is refused later.
    """
    try:
        return np.asarray(_loaded(values))
    except ValueError:  # ragged; the check of the samples says where
        return np.empty(0)


def shape_of(values: Any) -> tuple[int, ...]:
    """Return the shape of a column, without reading it where that is possible."""
    shape = getattr(values, "shape", None)
    if isinstance(shape, tuple):
        return shape
    if isinstance(values, (list, tuple)) and values and np.ndim(values[0]) == 0:
        return (len(values),)
    return array_of(values).shape if isinstance(values, (list, tuple)) else ()


def is_line(shape: Sequence[int]) -> bool:
    """Return whether an array is one row or one column."""
    return len(shape) == 1 or (len(shape) == 2 and 1 in shape)


def flattened(columns: Mapping[str, Any]) -> Record:
    """Return columns by name, with those in a mapping, a struct or a cell after its name.

    `t` in `run` in `out` is called "out.run.t", the second cell of `run` run[2]. A mapping that holds
    all is left out of the names.
    """
    flat: Record = {}
    for name, value in columns.items():
        _flatten(str(name), value, flat, 0)
    while flat:
        parts = [name.partition(".") for name in flat]
        structs = {struct for struct, _, _ in parts}
        if len(structs) > 1 or not all(dot for _, dot, _ in parts):
            break
        flat = {rest: value for (_, _, rest), value in zip(parts, flat.values(), strict=True)}
    return flat


def _flatten(name: str, value: Any, flat: Record, depth: int) -> None:
    """Enter a value of this name, or what is in it, into `flat`."""
    if depth > DEEPEST_NESTING:
        raise ParameterError("solution", name, "is nested too deeply")
    is_array = isinstance(value, np.ndarray)
    if isinstance(value, (np.ndarray, np.void)) and value.dtype.names:
        value = {part: value[part] for part in value.dtype.names}
    elif is_array and value.dtype == object and name.rpartition(".")[2] not in BESIDE:
        if value.size == 1 and (np.ndim(value.item()) or _is_struct(value.item())):
            return _flatten(name, value.item(), flat, depth + 1)
        if value.ndim == 1 and any(np.ndim(cell) or _is_struct(cell) for cell in value):
            for i, cell in enumerate(value, 1):
                _flatten(f"{name}[{i}]", cell, flat, depth + 1)
            return None
    if isinstance(value, Mapping):
        for part in value:
            _flatten(f"{name}.{part}", value[part], flat, depth + 1)
    else:
        flat[name] = value
    return None


def _is_struct(value: Any) -> bool:
    return isinstance(value, Mapping) or bool(getattr(getattr(value, "dtype", None), "names", None))


def _may_be_column(name: str, value: Any, count: int, asked: Asked) -> bool:
    """Return whether a value may be a column: an array of as many entries as there are times.

    One with a usual name is kept, so that a message says what is wrong with it.
    """
    if name in asked.values() or (is_usual(name) and "." not in name):
        return True
    if isinstance(value, (str, bytes)):
        return False
    shape = shape_of(value)
    return bool(shape) and len(shape) <= 2 and count in shape


def _split_matrices(columns: Record, asked: Asked) -> Record:
    """Return columns with the rows of each matrix, of states for example, as NAME[1], NAME[2], ...

    A matrix keeps its own name as well where it may hold several solutions.
    """
    shapes = {name: shape_of(value) for name, value in columns.items()}

    def may_be(role: str, name: str) -> bool:
        return name == asked.get(role) or _short(name) in USUAL_NAMES[role]

    times = [name for name in columns if may_be("t", name) and is_line(shapes[name])]
    if times:
        count = max(shapes[times[0]])
    else:
        sizes = Counter(max(shape) for shape in shapes.values() if shape and max(shape) > 1)
        count = sizes.most_common(1)[0][0] if sizes else 0
    has_v = any(may_be("v", name) for name in columns)
    split: Record = {}
    whole: Record = {}
    for name, value in columns.items():
        if count and not _may_be_column(name, value, count, asked):
            continue
        shape = shapes[name]
        if len(shape) != 2 or is_line(shape) or count not in shape or min(shape) > MOST_ROWS:
            split[name] = value
            continue
        matrix = array_of(value)
        # States in columns, as MATLAB has them, or in rows, as scipy has them.
        has_samples_in_rows = shape[0] == count
        if len(columns) == 1:
            has_samples_in_rows = _has_samples_in_rows(matrix)
        rows = matrix.T if has_samples_in_rows else matrix
        is_x = may_be("x", name)
        if len(columns) > 1 and (may_be("v", name) or may_be("t", name) or (is_x and has_v)):
            whole[name] = value  # a row for each solution
        elif is_x and len(columns) > 1:
            # Rows of x without v may be several solutions: positions alone.
            are_states = len(rows) == 2 and (
                shape[0] == count or not times or is_velocity(array_of(columns[times[0]]), *rows)
            )
            if not are_states:
                whole[name] = value
        split |= {f"{name}[{i}]": row for i, row in enumerate(rows, 1)}
    return split | whole


def _short(name: str) -> str:
    return plain(name.rpartition(".")[2])
