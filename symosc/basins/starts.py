"""Starts of many motions: rows, columns by name, or a grid over two of t0, x0 and v0."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from symosc.base.errors import ParameterError
from symosc.scenes import START_NAMES
from symosc.simulation.problems import NumberColumn, common_length, named
from symosc.sweeps.plan import read_axis

NAMES = START_NAMES[:3]
GRID = "two of them, with their values, make a grid"
NAMES_OF_STARTS = "must name t0, x0 and v0, or two of them, which make a grid"


class ReadStarts(NamedTuple):
    """Starts as rows t0, x0, v0, and the axes of a grid by name; none if they are no grid."""

    rows: np.ndarray
    axes: dict[str, np.ndarray]

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of what has a number for each start."""
        if self.axes:
            return tuple(map(len, self.axes.values()))
        return (len(self.rows),)


def read_starts(starts: Any) -> ReadStarts:
    """Return starts that are given as rows t0, x0, v0, as columns of these names, or as a grid."""
    if isinstance(starts, Mapping) and len(starts) == 2:
        return _grid(starts)
    if isinstance(starts, Mapping) and {*starts} != {*NAMES}:
        raise ParameterError("starts", [*starts], NAMES_OF_STARTS)
    columns = named("starts", starts, NAMES)
    if isinstance(columns, Mapping):
        values = {name: NumberColumn(name, columns[name]).hi for name in NAMES}
        count = common_length({name: len(column) for name, column in values.items()})
        rows = np.column_stack([np.broadcast_to(column, count) for column in values.values()])
        return ReadStarts(_some(rows), {})
    try:
        rows = np.asarray(starts, dtype=object)
    except ValueError:  # rows of different lengths
        rows = np.zeros((0, 0), dtype=object)
    if rows.shape == (3,):
        rows = rows[None]
    if rows.ndim != 2 or rows.shape[1] != 3:
        allowed = f"must be rows t0, x0, v0, or columns of these names; {GRID}"
        raise ParameterError("starts", starts, allowed)
    columns = [NumberColumn(name, values).hi for name, values in zip(NAMES, rows.T, strict=True)]
    return ReadStarts(_some(np.column_stack(columns)), {})


def _some(rows: np.ndarray) -> np.ndarray:
    """Return rows of starts; ParameterError if there are none."""
    if not len(rows):
        raise ParameterError("starts", "none", "must be one or more")
    return rows


def _grid(starts: Mapping[Any, Any]) -> ReadStarts:
    """Return a grid of starts over two of t0, x0 and v0; the third one is 0."""
    for name in starts:
        if name not in NAMES:
            raise ParameterError("starts", name, NAMES_OF_STARTS)
    axes = {str(name): read_axis(str(name), values) for name, values in starts.items()}
    mesh = np.meshgrid(*axes.values(), indexing="ij")
    columns = dict(zip(axes, mesh, strict=True))
    nought = np.zeros(mesh[0].size)
    rows = [columns[name].ravel() if name in columns else nought for name in NAMES]
    return ReadStarts(np.column_stack(rows), axes)
