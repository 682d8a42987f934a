"""What is swept: axes that make a grid, or the rows of a table; and the cells of both, one motion each."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from symosc.errors import ParameterError, meant
from symosc.exact import read_exact, unmasked, whole_number
from symosc.model import PARAMETER_NAMES
from symosc.scenes import START_NAMES, Scene
from symosc.simulation.problems import named

SWEPT_STARTS = START_NAMES[:3]
SWEPT_NAMES = (*PARAMETER_NAMES, *SWEPT_STARTS)
MOST_AXES = 3
#: The dimension of a table's rows, and of several starts.
SET_AXIS, START_AXIS = "set", "start"
MOST_SWEPT = 10**9
AXIS_FORM = "give numbers, or LO:HI:N such as '1:6:500'"
OVER_FORM = "give names with their values, such as {'Omega': '1:6:500'}, or a table: a DataFrame or a list of dicts"


class Coordinate(NamedTuple):
    """Values of one parameter or start value along one dimension."""

    dimension: str
    values: np.ndarray


class Grid:
    """The cells of a sweep, in C order of its dimensions.

    Values are doubles, each read as the decimal that it prints as: a coordinate of the result says exactly what was
    computed. What is not swept stays exact.

    Parameters
    ----------
    coordinates : dict of str to Coordinate
        By the name of what is swept.

    Attributes
    ----------
    sizes : dict of str to int
        Length of each dimension, in order.
    """

    def __init__(self, coordinates: dict[str, Coordinate]) -> None:
        self.coordinates = coordinates
        self.sizes = {each.dimension: len(each.values) for each in coordinates.values()}

    def __len__(self) -> int:
        return math.prod(self.sizes.values())

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the dimensions."""
        return tuple(self.sizes.values())

    def columns(self, begin: int, end: int) -> dict[str, np.ndarray]:
        """Return the swept values of the cells from `begin` up to `end`."""
        places = np.unravel_index(np.arange(begin, end), self.shape)
        where = dict(zip(self.sizes, places, strict=True))
        return {name: values[where[dimension]] for name, (dimension, values) in self.coordinates.items()}

    def is_table(self) -> bool:
        """Return whether the rows of a table are swept."""
        return SET_AXIS in self.sizes


def read_grid(scene: Scene, over: Any, starts: Any = None) -> Grid:
    """Return the cells that are asked for.

    Parameters
    ----------
    scene : Scene
    over : mapping, DataFrame or sequence of mappings
        Axes by name, or a table.
    starts : array_like, shape (n, 3) or (3,), optional
        Rows of t0, x0, v0: each set is followed from each of them.

    Raises
    ------
    ParameterError
        For names that cannot be swept, values that are no numbers or that the model does not allow, and for none or
        too many axes.
    """
    table = _table_columns(over)
    axes = table if table is not None else _axes(over)
    found = {name: Coordinate(name if table is None else SET_AXIS, values) for name, values in axes.items()}
    if starts is not None:
        twice = [name for name in SWEPT_STARTS if name in found]
        if twice:
            raise ParameterError("starts", twice[0], "is swept too; give it in one place")
        found |= {name: Coordinate(START_AXIS, values) for name, values in _starts(starts).items()}
    grid = Grid(found)
    if len(grid) > MOST_SWEPT:
        raise ParameterError("over", f"{len(grid)} motions", f"must be at most {MOST_SWEPT}")
    _check_values(scene, grid)
    return grid


def _axes(over: Any) -> dict[str, np.ndarray]:
    if not isinstance(over, Mapping):
        raise ParameterError("over", over, OVER_FORM)
    if not 1 <= len(over) <= MOST_AXES:
        raise ParameterError("over", list(over), f"must have one to {MOST_AXES} axes")
    return {_known(name): read_axis(name, values) for name, values in over.items()}


def _known(name: Any) -> str:
    if name not in SWEPT_NAMES:
        known = f"cannot be swept; what can be is {', '.join(SWEPT_NAMES)}"
        raise ParameterError("over", name, known + meant(name, SWEPT_NAMES))
    return str(name)


def read_axis(name: str, values: Any) -> np.ndarray:
    """Return the values of an axis: those that are given, or N evenly spaced ones of the text LO:HI:N.

    Raises
    ------
    ParameterError
        Unless they are different numbers.
    """
    found = _evenly(name, values) if isinstance(values, str) else _numbers(name, values)
    if not len(found):
        raise ParameterError(name, values, f"has no values; {AXIS_FORM}")
    ordered = np.sort(found)
    same = ordered[1:][ordered[1:] == ordered[:-1]]
    if len(same):
        raise ParameterError(name, float(same[0]), "is twice on its axis")
    return found


def _evenly(name: str, text: str) -> np.ndarray:
    parts = text.split(":")
    if len(parts) != 3:
        raise ParameterError(name, text, AXIS_FORM)
    low, high = (read_exact(name, part) for part in parts[:2])
    count = whole_number(name, int(parts[2]) if parts[2].strip().isascii() and parts[2].strip().isdigit() else None, 2)
    if count > MOST_SWEPT:
        raise ParameterError(name, text, f"must have at most {MOST_SWEPT} values")
    if low >= high:
        raise ParameterError(name, text, "must go from a lower to a higher value")
    # In fractions, so that 1:6:51 gives 1.1 and not 1.1000000000000001.
    return np.array([float(low + Fraction(i, count - 1) * (high - low)) for i in range(count)])


def _numbers(name: str, values: Any) -> np.ndarray:
    """Return a row of numbers as doubles."""
    unmasked(name, values)
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        raise ParameterError(name, values, AXIS_FORM)
    array = values if isinstance(values, np.ndarray) else np.asarray(list(values), dtype=object)
    if array.ndim != 1:
        raise ParameterError(name, values, f"must be one row of numbers; it has shape {array.shape}")
    if array.dtype.kind not in "iuf":
        return np.array([float(read_exact(name, value)) for value in array], dtype=float) + 0.0
    for value in (array.min(), array.max()) if len(array) else ():  # nan is both
        read_exact(name, value)
    return array.astype(float) + 0.0  # no -0.0


def _table_columns(over: Any) -> dict[str, np.ndarray] | None:
    """Return the columns of a table, or None if `over` is no table."""
    if hasattr(over, "columns") and hasattr(over, "to_numpy"):
        rows: dict[Any, Any] = {name: over[name].to_numpy() for name in over.columns}
    elif isinstance(over, (list, tuple)) and over and all(isinstance(row, Mapping) for row in over):
        if any(row.keys() != over[0].keys() for row in over):
            raise ParameterError("over", "a table", "must have the same names in all rows")
        rows = {name: [row[name] for row in over] for name in over[0]}
    else:
        return None
    columns = {_known(name): _numbers(name, values) for name, values in rows.items()}
    if not columns or not len(next(iter(columns.values()))):
        raise ParameterError("over", "a table", "must have a column and a row")
    return columns


def start_rows(starts: Any) -> Any:
    """Return starts as rows of t0, x0 and v0, one alone as a row; columns with names are put in this order."""
    columns = named("starts", starts, SWEPT_STARTS)
    if not isinstance(columns, Mapping):
        return starts
    each = [np.asarray(unmasked(name, column), dtype=object) for name, column in columns.items()]
    try:
        rows = np.stack(np.broadcast_arrays(*each), axis=-1)
    except ValueError:
        lengths = [np.shape(column) for column in columns.values()]
        raise ParameterError("starts", lengths, "the columns must be of one length") from None
    return rows.ravel() if rows.size == 3 else rows


def _starts(starts: Any) -> dict[str, np.ndarray]:
    unmasked("starts", starts)
    try:
        rows = np.atleast_2d(np.asarray(starts, dtype=object))
    except ValueError:
        rows = np.zeros(0)
    if rows.ndim != 2 or rows.shape[1] != 3 or not len(rows):
        raise ParameterError("starts", starts, "must have shape (n, 3), rows of t0, x0, v0")
    return {name: _numbers(name, rows[:, i]) for i, name in enumerate(SWEPT_STARTS)}


def _check_values(scene: Scene, grid: Grid) -> None:
    """Let Parameters judge the extreme values: what it allows are intervals, and that belt 1 is the slower one."""
    swept = {name: each.values for name, each in grid.coordinates.items() if name in PARAMETER_NAMES}
    belts = {name: swept.pop(name) for name in ("v1", "v2") if name in swept}
    for name, values in swept.items():
        for value in (values.min(), values.max()):
            scene.parameters.replace(**{name: float(value)})
    if grid.is_table() and len(belts) == 2:
        worst = int(np.argmin(belts["v2"] - belts["v1"]))
        scene.parameters.replace(v1=float(belts["v1"][worst]), v2=float(belts["v2"][worst]))
    elif belts:
        nearest = {name: float(values.max() if name == "v1" else values.min()) for name, values in belts.items()}
        scene.parameters.replace(**nearest)
