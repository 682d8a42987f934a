"""Switching points: numbers, or arrays that are broadcast to one shape."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from symosc.base.aliases import Number
from symosc.base.arrays import real_array
from symosc.base.errors import ParameterError
from symosc.base.exact import LARGEST, scalar_of

POINT_NAMES = ("x_i", "theta_i", "x_j", "theta_j")
REAL_NUMBER = "must be a finite real number: a float, an int or an mpmath number"


def is_array(value: Any) -> bool:
    """Return whether a value is an array or a sequence of numbers."""
    try:
        return np.ndim(value) > 0
    except (ValueError, RuntimeError):  # lists of different lengths, or nested deeply
        return True


def scalar(name: str, value: Any, convert: Callable[[Any], Number]) -> Number:
    """Convert a number by `convert`, and check that it is a finite real number."""
    value = scalar_of(name, value)
    if isinstance(value, bool | np.bool_ | str | bytes | complex | None) or is_array(value):
        raise ParameterError(name, value, REAL_NUMBER)
    try:
        number = convert(value)
        finite = not hasattr(number, "_mpc_") and abs(number) < math.inf
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(name, value, REAL_NUMBER) from None
    if not finite:
        raise ParameterError(
            name, value, REAL_NUMBER if hasattr(number, "_mpc_") else "must be finite"
        )
    if abs(number) > float(LARGEST):  # squares of it must not overflow
        raise ParameterError(name, value, f"must be at most {float(LARGEST):g} in size")
    return number


def point_columns(points: list[object]) -> list[np.ndarray]:
    """Return x_i, theta_i, x_j, theta_j as four arrays, broadcast to one shape."""
    allowed = "must be an array of real numbers (arrays and mpmath numbers do not mix)"
    columns = [
        real_array(name, value, allowed) for name, value in zip(POINT_NAMES, points, strict=True)
    ]
    try:
        return [np.array(column) for column in np.broadcast_arrays(*columns)]
    except (ValueError, RuntimeError):  # RuntimeError: more dimensions than numpy broadcasts
        shapes = tuple(column.shape for column in columns)
        raise ParameterError(
            "points", shapes, "must be arrays whose shapes fit together (broadcast)"
        ) from None
