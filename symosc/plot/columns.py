"""What figures of sweeps share: the columns of a result, and the names of its axes."""

from __future__ import annotations

from typing import Any

import numpy as np

from symosc.errors import ParameterError
from symosc.plot.branch import PARAMETER_LABELS

START_LABELS = {name: f"${name[0]}_0$" for name in ("t0", "x0", "v0")}
COLUMN_LABELS = {"stuck": "share of time stuck", "x": "last $x$", "v": r"last $\dot{x}$"}
UNDECIDABLE = "undecidable"


def read_column(dataset: Any, name: Any) -> Any:
    """Return a column of a result, without dimensions of length 1.

    Raises
    ------
    ParameterError
        If `dataset` is no result of a sweep, or has no such column.
    """
    if not hasattr(dataset, "data_vars") or "status" not in dataset:
        raise ParameterError("dataset", type(dataset).__name__, "must be a Dataset; sweep(...) makes one")
    names = [str(each) for each in dataset.data_vars]
    if name is None:
        name = "section" if "section" in names else names[0]
    if name not in names:
        raise ParameterError("name", name, f"is not recorded here; there is {', '.join(names)}")
    return dataset[name].squeeze([each for each in axes_of(dataset[name]) if dataset.sizes[each] == 1])


def axes_of(column: Any) -> list[str]:
    """Return the dimensions of a column that were swept."""
    return [str(each) for each in column.dims if each not in ("period", "component")]


def read_axes(column: Any, count: int, what: str) -> list[str]:
    """Return the axes of a column, which must be `count`, each with a coordinate.

    Raises
    ------
    ParameterError
        If they are others; the message says how to select.
    """
    if "component" in column.dims:
        raise ParameterError("name", column.name, "has x and v at many times; bifurcation_figure draws it")
    axes = axes_of(column)
    if len(axes) != count or any(each not in column.coords for each in axes):
        sizes = ", ".join(f"{each} ({column.sizes[each]})" for each in axes) or "none"
        allowed = f"{what} has {count} ax{'is' if count == 1 else 'es'}; select values, such as dataset.isel(k=0)"
        raise ParameterError("dataset", f"axes {sizes}", allowed)
    return axes


def label(name: str) -> str:
    """Return how a parameter, a start value or a column is named at an axis."""
    known = PARAMETER_LABELS | START_LABELS | COLUMN_LABELS | {letter: f"${letter}$" for letter in "mck"}
    return known.get(name, name.replace("_", " "))


def undecided(dataset: Any, column: Any) -> np.ndarray:
    """Return where the motion could not be decided, in the shape of a column."""
    status = dataset["status"].squeeze([each for each in dataset["status"].dims if dataset.sizes[each] == 1])
    return np.asarray(status.transpose(*axes_of(column)).values == UNDECIDABLE)


def typeset(word: str) -> str:
    """Return a word as the paper writes it; other text as it is."""
    if not word:
        return "no event"
    return f"$P_{{{word[1:]}}}$" if word[0] == "P" and word[1:].isdigit() else word
