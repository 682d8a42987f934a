"""Where in a TOML file something stands: tomllib does not say."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence

#: Characters that may be read in all: a file that takes more is no scene that somebody wrote, and is not searched.
MOST_READ = 1_000_000


def line_of(text: str, path: Sequence[str]) -> int | None:
    """Return the number of the line on which a key or a table of a TOML text is complete, None if it is not found.

    The lines up to it are the first ones that are TOML and have it: so strings of several lines, inline tables and
    dotted keys are all read by the same rules as the file itself.
    """
    lines, begin, read = text.splitlines(keepends=True), "", 0
    for n, line in enumerate(lines, 1):
        begin += line
        if not line.strip():
            continue
        read += len(begin)
        if read > MOST_READ:
            return None
        try:
            data = tomllib.loads(begin)
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
