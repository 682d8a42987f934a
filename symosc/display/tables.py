"""Tables: drawn by rich on a terminal with room for them, else as plain text.

Plain tables look like those of tabulate, which a test compares; loading tabulate takes half as long as a simulation.
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Sequence

#: Colours of the cells that say what an event is, or how a judgement ended.
CELL_STYLES = {"stick": "blue", "slip": "green", "cross": "red", "graze": "magenta", "undecidable": "yellow"}
CELL_STYLES |= {"confirmed": "green", "refuted": "red", "not as printed": "red", "corrected": "yellow"}


def plain_table(heads: Sequence[str], rows: Sequence[Sequence[str]], decimals: Collection[str] = ()) -> str:
    """Return a table; the columns with heads in `decimals` are aligned at their points, the others at the left."""
    columns = []
    for i, head in enumerate(heads):
        cells = [row[i].strip() for row in rows]
        aligned = head in decimals
        cells = at_points(cells) if aligned else cells
        width = max([len(head) + 2, *map(len, cells)])
        columns.append([cell.rjust(width) if aligned else cell.ljust(width) for cell in (head, *cells)])
        columns[-1].insert(1, "-" * width)
    return "\n".join("  ".join(line).rstrip() for line in zip(*columns, strict=True))


def at_points(cells: Sequence[str]) -> list[str]:
    """Append spaces to numbers so that their decimal points are below each other."""
    behind = [_behind_point(cell) for cell in cells]
    return [cell + " " * (max(behind) - each) for cell, each in zip(cells, behind, strict=True)]


def _behind_point(cell: str) -> int:
    """Return the number of characters after a number's decimal point, -1 without one."""
    try:
        float(cell)
    except ValueError:
        return -1
    point = cell.rfind(".")
    point = cell.lower().rfind("e") if point < 0 else point
    return len(cell) - point - 1 if point >= 0 else -1


def print_table(heads: Sequence[str], rows: Sequence[Sequence[str]], decimals: Collection[str] = ()) -> bool:
    """Print a table on standard output if that is a terminal with room for it; return whether it did."""
    if sys.stdout is None or not sys.stdout.isatty():
        return False
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console, shown = Console(file=sys.stdout), Table(box=SIMPLE_HEAD, header_style="bold", pad_edge=False)
    columns = []
    for i, head in enumerate(heads):
        shown.add_column(Text(head), justify="right" if head in decimals else "left", no_wrap=True)
        cells = [row[i] for row in rows]
        columns.append(at_points(cells) if head in decimals and cells else cells)
    for row in zip(*columns, strict=True):
        shown.add_row(*(Text(cell, style=CELL_STYLES.get(cell, "")) for cell in row))
    anything = console.options.update(max_width=10 * sum(map(len, rows[0] if rows else heads)) + 1000)
    if console.measure(shown, options=anything).maximum > console.width:
        return False  # no number is cut, and no cell folded
    console.print(shown)
    return True
