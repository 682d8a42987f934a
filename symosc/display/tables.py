"""Tables of plain text, as pipes, files and tests get them: columns two spaces apart, numbers aligned at their points.

tabulate prints the same, which a test compares; to load it takes half as long as a motion takes to follow.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

#: A column is at least so much wider than its head.
LEAST_PADDING = 2


def plain_table(heads: Sequence[str], rows: Sequence[Sequence[str]], decimals: Collection[str] = ()) -> str:
    """Return a table; the columns with heads in `decimals` are aligned at their points, the others at the left."""
    columns = []
    for i, head in enumerate(heads):
        cells = [row[i].strip() for row in rows]
        aligned = head in decimals
        cells = at_points(cells) if aligned else cells
        width = max([len(head) + LEAST_PADDING, *map(len, cells)])
        columns.append([cell.rjust(width) if aligned else cell.ljust(width) for cell in (head, *cells)])
        columns[-1].insert(1, "-" * width)
    return "\n".join("  ".join(line).rstrip() for line in zip(*columns, strict=True))


def at_points(cells: Sequence[str]) -> list[str]:
    """Return numbers with spaces behind them, so that their points are below each other."""
    behind = [_behind_point(cell) for cell in cells]
    return [cell + " " * (max(behind) - each) for cell, each in zip(cells, behind, strict=True)]


def _behind_point(cell: str) -> int:
    """Return how many characters are behind a number's point, -1 if it has none."""
    try:
        float(cell)
    except ValueError:
        return -1
    point = cell.rfind(".")
    point = cell.lower().rfind("e") if point < 0 else point
    return len(cell) - point - 1 if point >= 0 else -1
