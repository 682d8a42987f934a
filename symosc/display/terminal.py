"""Tables on a terminal: drawn by rich, in colours unless NO_COLOR is set, where there is room for them."""

from __future__ import annotations

import sys
from collections.abc import Collection, Sequence

from symosc.display.tables import at_points

#: Colours of the cells that say what an event is, or how a judgement ended.
CELL_STYLES = {"stick": "blue", "slip": "green", "cross": "red", "graze": "magenta", "undecidable": "yellow"}
CELL_STYLES |= {"confirmed": "green", "refuted": "red", "not as printed": "red", "corrected": "yellow"}


def print_table(heads: Sequence[str], rows: Sequence[Sequence[str]], decimals: Collection[str] = ()) -> bool:
    """Print a table on standard output if that is a terminal with room for it; tell whether it did."""
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
