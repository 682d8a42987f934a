"""Room for large arrays in few pages.

A page that is touched for the first time costs a microsecond or more, most of all in virtual machines: with pages of
4 KiB that is up to a quarter of what an event costs. numpy asks the system for pages of 2 MiB where an array takes
4 MiB and more, but gets them only between multiples of 2 MiB. So large arrays begin at one here, and have room behind
them. Room that is never touched takes no memory.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

# Bytes of a large page.
PAGE = 1 << 21


def room_of(shape: tuple[int, ...], dtype: Any = np.float64) -> np.ndarray:
    """Return an array with any content, as ``np.empty`` does, in large pages if it is large."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    if size < PAGE:
        return np.empty(shape, dtype)
    whole = np.empty(size + 2 * PAGE, np.uint8)
    skipped = -whole.__array_interface__["data"][0] % PAGE
    return whole[skipped : skipped + size].view(dtype).reshape(shape)


def joined_in_room(pieces: list[np.ndarray]) -> np.ndarray:
    """Return columns of one type as one, in one piece of memory."""
    if len(pieces) == 1:
        return np.ascontiguousarray(pieces[0])
    out = room_of((sum(map(len, pieces)),), pieces[0].dtype)
    return np.concatenate(pieces, out=out)


def copied(columns: np.ndarray) -> np.ndarray:
    """Return a copy of columns, each in one piece."""
    out = room_of(columns.shape, columns.dtype)
    out[...] = columns
    return out
