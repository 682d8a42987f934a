"""Grazing windows of many parameter sets at once, in double precision, compiled where numba is installed."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import Order
from symosc.arguments import public
from symosc.engine.arithmetic import compile_modules
from symosc.errors import MissingExtraError, ParameterError
from symosc.grazing import window_ends
from symosc.grazing.window import grazing_window
from symosc.kernels import double_double
from symosc.mappings import theorem7_cases
from symosc.mappings.arguments import real_array
from symosc.mappings.theorem7_cases import EMPTY, EQUALITY_IN_DOUBT, EVERYTHING, place
from symosc.model import Parameters


class WindowColumns(NamedTuple):
    """Windows of many parameter sets, arrays of one shape.

    Attributes
    ----------
    kind : int8
        EMPTY, EVERYTHING, ALL_BUT_ONE, ARC or WRAPPED_ARC, constants of `symosc.mappings.theorem7_cases`; always exact.
    low, high : float
        An ARC reaches from low up to high, a WRAPPED_ARC from low through 0 to high, ends excluded. ALL_BUT_ONE:
        low = high is the excluded phase. nan otherwise.
    theta_cr : float
        Theta_cr in [-pi/2, pi/2], nan where it does not exist.

    Examples
    --------
    >>> from symosc import grazing_windows, load_scene
    >>> columns = grazing_windows(load_scene("fig9").parameters, "P2", Omega=[0.05, 1, 4])
    >>> columns.high.round(4).tolist()
    [nan, 3.4814, 3.225]
    """

    kind: np.ndarray
    low: np.ndarray
    high: np.ndarray
    theta_cr: np.ndarray

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, WindowColumns):
            return False
        return all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in zip(self, other, strict=True))

    def __ne__(self, other: object) -> bool:
        return not self == other


@public
def grazing_windows(p: Parameters, mapping: str, order: Order = "full", **swept: ArrayLike) -> WindowColumns:
    """Return the windows for arrays of parameters, in double precision; see `grazing_window`.

    Every end is within one unit in the last place, and every case is exact: array entries are used as exact binary
    numbers, the other parameters stay rational. Compiled where numba is installed.

    Parameters
    ----------
    p : Parameters
    mapping, order :
        As for `grazing_window`.
    **swept : array_like of float
        Values of k, B0, Omega and v1 or v2 (the belt of the map); they are broadcast. The window depends on no others.

    Raises
    ------
    ParameterError
        For another parameter, and for values that Parameters would refuse.

    Examples
    --------
    >>> from symosc import grazing_windows, load_scene
    >>> columns = grazing_windows(load_scene("fig9").parameters, "P2", Omega=[0.05, 1, 4])
    >>> columns.kind.tolist()
    [1, 4, 4]
    """
    where, full = place(mapping), order == "full"
    names = ("k", f"v{where.boundary}", "B0", "Omega")
    for name in swept:
        if name not in names:
            raise ParameterError(name, "swept", f"the window of {mapping} depends on {', '.join(names)} only")
    arrays = _broadcast({name: real_array(name, values, "must be numbers") for name, values in swept.items()})
    _check_values(p, arrays)
    shape = next(iter(arrays.values())).shape if arrays else ()
    pairs = []
    for name in names:
        constant = Fraction(0) if name in arrays else getattr(p, name)
        high, low = _pair(constant)
        pairs += [arrays[name].ravel() if name in arrays else np.full(math.prod(shape), high)]
        pairs += [np.full(math.prod(shape), low)]
    columns = WindowColumns(np.empty(math.prod(shape), np.int8), *(np.empty(math.prod(shape)) for _ in range(3)))
    _rows()(tuple(pairs), where.side, full, tuple(columns))
    for i in np.nonzero(columns.kind == EQUALITY_IN_DOUBT)[0]:
        _fill(
            columns, int(i), p, mapping, order, {name: Fraction(float(each.flat[i])) for name, each in arrays.items()}
        )
    return WindowColumns(*(column.reshape(shape) for column in columns))


def _broadcast(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return arrays of one shape."""
    try:
        return dict(zip(arrays, np.broadcast_arrays(*arrays.values()), strict=True))
    except (ValueError, RuntimeError):  # RuntimeError: more dimensions than numpy broadcasts
        shapes = ", ".join(f"{name}: {array.shape}" for name, array in arrays.items())
        raise ParameterError(
            "swept", shapes, "the shapes must be equal, or broadcast to one as numpy does it"
        ) from None


def _check_values(p: Parameters, arrays: dict[str, np.ndarray]) -> None:
    """Let Parameters judge the extreme values of each array."""
    for name, array in arrays.items():
        for value in (array.min(), array.max()) if array.size else ():
            p.replace(**{name: float(value)})


def _fill(
    columns: WindowColumns, i: int, p: Parameters, mapping: str, order: Order, values: dict[str, Fraction]
) -> None:
    """Write row i from rational numbers."""
    exact = grazing_window(p.replace(**values), mapping, order)
    columns.kind[i] = exact.kind
    columns.theta_cr[i] = float(exact.critical_phase())
    columns.low[i], columns.high[i] = (math.nan, math.nan) if exact.kind in (EMPTY, EVERYTHING) else exact.ends


def _pair(value: Fraction) -> tuple[float, float]:
    """Return a Fraction as a pair of doubles, right to 2^-106."""
    high = float(value)
    return high, float(value - Fraction(high))


@lru_cache(maxsize=1)
def _rows() -> Callable[..., None]:
    """Return `windows.windows`, compiled if numba is installed."""
    try:
        return compile_modules((double_double, theorem7_cases, window_ends), {"windows"})["windows"]
    except MissingExtraError:
        return window_ends.windows
