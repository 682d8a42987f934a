"""Where in a TOML file something stands: tomllib does not say."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence

#: A file with more lines is no scene that somebody wrote, and is not searched.
MOST_READ_LINES = 1000


def line_of(text: str, path: Sequence[str]) -> int | None:
    """Return the number of the line on which a key or a table of a TOML text is complete, None if it is not found.

    The lines up to it are the first ones that are TOML and have it: so strings of several lines, inline tables and
    dotted keys are all read by the same rules as the file itself.
    """
    lines = text.splitlines(keepends=True)
    for n in range(1, min(len(lines), MOST_READ_LINES) + 1):
        if not lines[n - 1].strip():
            continue
        try:
            data = tomllib.loads("".join(lines[:n]))
        except (ValueError, RecursionError):
            continue
        if _has(data, path):
            return n
    return None


def _has(data: object, path: Sequence[str]) -> bool:
    for key in path:
        if not isinstance(data, dict) or key not in data:
            return False
        data = data[key]
    return True
