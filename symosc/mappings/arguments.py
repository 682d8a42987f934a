"""Reading the switching points that the mappings are given."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from symosc.aliases import Number
from symosc.errors import ParameterError
from symosc.exact import unmasked

POINT_NAMES = ("x_i", "theta_i", "x_j", "theta_j")
NUMBERS = "must be a finite real number: a float, an int or an mpmath number"
ARRAYS = "must be an array of real numbers (arrays and mpmath numbers do not mix)"


def is_mp(value: object) -> bool:
    """Return whether a value is an mpmath number."""
    return hasattr(value, "_mpf_") and hasattr(value, "context")


def is_array(value: Any) -> bool:
    """Return whether a value is an array or a sequence of numbers."""
    try:
        return np.ndim(value) > 0
    except (ValueError, RuntimeError):  # lists of different lengths, or nested deeply
        return True


def scalar(name: str, value: Any, convert: Callable[[Any], Number]) -> Number:
    """Return a number in the arithmetic of `convert`."""
    if isinstance(unmasked(name, value), np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool | np.bool_ | str | bytes | complex | None) or is_array(value):
        raise ParameterError(name, value, NUMBERS)
    try:
        number = convert(value)
        finite = not hasattr(number, "_mpc_") and abs(number) < math.inf
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(name, value, NUMBERS) from None
    if not finite:
        raise ParameterError(name, value, NUMBERS if hasattr(number, "_mpc_") else "must be finite")
    return number


def columns_of(given: list[object]) -> list[np.ndarray]:
    """Return the four arrays in one shape."""
    columns = [real_array(name, value, ARRAYS) for name, value in zip(POINT_NAMES, given, strict=True)]
    try:
        return [np.array(column) for column in np.broadcast_arrays(*columns)]
    except (ValueError, RuntimeError):  # RuntimeError: more dimensions than numpy broadcasts
        shapes = tuple(column.shape for column in columns)
        raise ParameterError("points", shapes, "must be arrays whose shapes fit together (broadcast)") from None


def real_array(name: str, value: object, allowed: str) -> np.ndarray:
    """Return finite real numbers as an array of floats; text, booleans and complex numbers are refused."""
    unmasked(name, value)
    try:
        array = np.asarray(value)
        plain = array is value and array.dtype.kind != "O"
        if array.dtype.kind not in "iufO" or (not plain and text_or_booleans(value)):
            raise TypeError
        array = array.astype(float)
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(name, value, allowed) from None
    if not np.isfinite(array).all():
        raise ParameterError(name, array[~np.isfinite(array)].flat[0], "must be finite everywhere")
    return array


def text_or_booleans(value: object) -> bool:
    """Return whether there is text or a boolean among the entries, which numpy and float() would read as numbers."""
    entries = np.asarray(value, dtype=object).ravel().tolist()
    return any(isinstance(entry, bool | np.bool_ | str | bytes) for entry in entries)
