"""Whether the tags of a MATLAB file make sense: scipy ends the whole program at one that does not."""

from __future__ import annotations

import struct
from collections.abc import Iterator

MAT_HEADER = 128
#: The kinds of data that the format has; a matrix is made of such, a packed one has a checksum of its own.
NUMBER_TAGS, MATRIX_TAG, PACKED_TAG, TEXT_TAGS = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13), 14, 15, (16, 17, 18)
#: Classes of a matrix that holds numbers; a sparse one has two lists of places as well.
SPARSE, NUMBER_CLASSES = 5, range(5, 16)
DEEPEST_MATRIX = 50


def has_wrong_tags(data: bytes) -> bool:
    """Return whether a file of version 5 has a tag of no known kind, or one that reaches beyond its matrix.

    Examples
    --------
    >>> from io import BytesIO
    >>> from scipy.io import savemat
    >>> file = BytesIO()
    >>> savemat(file, {"t": [0.0, 1.0]})
    >>> data = file.getvalue()
    >>> has_wrong_tags(data), has_wrong_tags(data[:176] + b"\\xff" + data[177:])
    (False, True)
    """
    order = {b"IM": "<", b"MI": ">"}.get(data[126:MAT_HEADER])
    if order is None:
        return False  # version 4, or no such file: scipy says so
    try:
        return not all(_is_sound(data, order, *tag, 1) for tag in _tags(data, order, MAT_HEADER, len(data), False))
    except (struct.error, ValueError):
        return True


def _is_sound(data: bytes, order: str, kind: int, begin: int, end: int, depth: int) -> bool:
    if kind != MATRIX_TAG:
        return kind in (*NUMBER_TAGS, PACKED_TAG, *TEXT_TAGS)
    parts = list(_tags(data, order, begin, end, True))
    if depth > DEEPEST_MATRIX or not _has_its_parts(data, order, parts):
        return False
    return all(_is_sound(data, order, *part, depth + 1) for part in parts)


def _has_its_parts(data: bytes, order: str, parts: list[tuple[int, int, int]]) -> bool:
    """Return whether a matrix of numbers has as many parts as its flags say: flags, size, name, numbers."""
    if not parts:
        return True  # an empty one
    (flags,) = struct.unpack_from(f"{order}I", data, parts[0][1])
    own, complex_too = flags & 0xFF, flags >> 11 & 1
    return own not in NUMBER_CLASSES or len(parts) == 4 + complex_too + 2 * (own == SPARSE)


def _tags(data: bytes, order: str, at: int, end: int, inside: bool) -> Iterator[tuple[int, int, int]]:
    """Yield kind, beginning and end of the elements between two places; those inside a matrix are multiples of 8."""
    while at < end:
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if kind >> 16:  # a short one, in the tag itself
            yield kind & 0xFFFF, at + 4, at + 8
            at += 8
            continue
        begin, at = at + 8, at + 8 + size
        if at > end:
            raise ValueError("an element reaches beyond its end")
        yield kind, begin, at
        at += -size % 8 if inside else 0
