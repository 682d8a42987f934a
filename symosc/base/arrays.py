"""Arrays of real numbers, read and checked."""

from __future__ import annotations

import numpy as np

from symosc.base.errors import ParameterError
from symosc.base.exact import unmasked


def real_array(name: str, value: object, allowed: str) -> np.ndarray:
    """Return finite real numbers as an array of floats; for others raise ParameterError with the
    text `allowed`.
    """
    unmasked(name, value)
    try:
        array = np.asarray(value)
        # An array of numbers has no entries of other types; a list or an array of objects may.
        is_array_of_numbers = array is value and array.dtype.kind != "O"
        if is_array_of_numbers:
            entries = []
        else:
            entries = np.asarray(value, dtype=object).ravel().tolist()
        refused = (bool, np.bool_, str, bytes)
        if array.dtype.kind not in "iufO" or any(isinstance(entry, refused) for entry in entries):
            raise TypeError  # numpy and float() would read text and booleans as numbers
        array = array.astype(float)
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(name, value, allowed) from None
    if not np.isfinite(array).all():
        raise ParameterError(name, array[~np.isfinite(array)].flat[0], "must be finite everywhere")
    return array
