"""Parts of notebook pages: a line, tables with the middle omitted, and small pictures (SVG).

All content is escaped. Colours are those of the notebook, light or dark; no style affects the rest of the notebook.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

#: Rows of a table that has more: as many at its beginning and at its end.
HEAD_ROWS, TAIL_ROWS = 7, 3
#: Size of a small picture, and the margin around what it shows.
PICTURE_WIDTH, PICTURE_HEIGHT, PICTURE_MARGIN = 260, 130, 6
#: Points of a curve, at most.
MOST_POINTS = 600
CELL = "text-align:left;padding:1px 12px 1px 0;white-space:nowrap"


def page(kind: str, line: str, *parts: str) -> Markup:
    """Return a page: a title, a line, and its tables and pictures side by side."""
    shown = Markup("").join(Markup("<div>{}</div>").format(part) for part in parts if part)
    head = Markup('<div style="margin-bottom:4px"><strong>{}</strong> {}</div>').format(kind, line)
    row = Markup('<div style="display:flex;flex-wrap:wrap;gap:8px 24px;align-items:flex-start">{}</div>').format(shown)
    return Markup('<div class="symosc" style="max-width:100%;overflow-x:auto">{}{}</div>').format(head, row)


def table(heads: Sequence[str], rows: Sequence[Sequence[Any]], count: int | None = None) -> Markup:
    """Return a table, the middle of a long one left out; of `count` rows only those that `ends` names need be given."""
    left_out = (len(rows) if count is None else count) - HEAD_ROWS - TAIL_ROWS
    shown_rows = [_row_html(each) for each in (rows if left_out <= 0 else [*rows[:HEAD_ROWS], *rows[-TAIL_ROWS:]])]
    if left_out > 0:
        gap = Markup('<tr><td colspan="{}" style="{};opacity:0.6">… {:,} more</td></tr>')
        shown_rows.insert(HEAD_ROWS, gap.format(len(heads), CELL, left_out))
    head = Markup("").join(Markup('<th style="{}">{}</th>').format(CELL, each) for each in heads)
    body = Markup("").join(shown_rows)
    return Markup("<table><thead><tr>{}</tr></thead><tbody>{}</tbody></table>").format(head, body)


def ends(count: int) -> list[int]:
    """Return the numbers of the rows that a table of `count` rows shows."""
    every = range(count)
    return list(every) if count <= HEAD_ROWS + TAIL_ROWS else [*every[:HEAD_ROWS], *every[-TAIL_ROWS:]]


def _row_html(cells: Sequence[Any]) -> Markup:
    each = (Markup('<td style="{}">{}</td>').format(CELL, shown(cell)) for cell in cells)
    return Markup("<tr>{}</tr>").format(Markup("").join(each))


def shown(value: Any) -> Any:
    """Return a value as text for a cell: numbers with ten digits."""
    if isinstance(value, (float, np.floating)):
        return f"{float(value):.10g}"
    return "" if value is None else value


def facts(values: dict[str, Any]) -> Markup:
    """Return a table of names and values, without those that are None."""
    line = Markup('<tr><th style="{}">{}</th><td style="{}">{}</td></tr>')
    lines = (line.format(CELL, name, CELL, shown(value)) for name, value in values.items() if value is not None)
    return Markup("<table><tbody>{}</tbody></table>").format(Markup("").join(lines))


def curve(says: str, x: Any, y: Any, marks: Iterable[tuple[float, float]] = ()) -> Markup:
    """Return a small picture of a curve with a dot at each of `marks`, "" if it has no two points; NaN breaks it."""
    # `says` is what the picture shows, in words: for who cannot see it, and when the mouse is over it.
    x, y = (np.asarray(each, dtype=float) for each in (x, y))
    if len(x) > MOST_POINTS:
        chosen = np.linspace(0, len(x) - 1, MOST_POINTS).astype(int)
        x, y = x[chosen], y[chosen]
    known = np.isfinite(x) & np.isfinite(y)
    if known.sum() < 2:
        return Markup("")
    across, up = _scale(x[known], PICTURE_WIDTH), _scale(y[known], PICTURE_HEIGHT)
    text, pen = [], "M"
    for one, other, there in zip(x.tolist(), y.tolist(), known.tolist(), strict=True):
        if there:
            text.append(f"{pen}{across(one):.1f} {PICTURE_HEIGHT - up(other):.1f}")
        pen = "L" if there else "M"
    line = Markup('<path d="{}" fill="none" stroke="currentColor" stroke-width="1.2"/>').format("".join(text))
    dot = Markup('<circle cx="{:.1f}" cy="{:.1f}" r="2.6" fill="#d7191c"/>')
    dots = [dot.format(across(one), PICTURE_HEIGHT - up(other)) for one, other in marks]
    start = Markup('<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{0}" height="{1}" viewBox="0 0 {0} {1}">')
    frame = Markup(
        '<title>{}</title><rect x="0.5" y="0.5" width="{}" height="{}" fill="none" stroke="currentColor" '
        'stroke-opacity="0.25"/>{}</svg>'
    )
    inside = frame.format(says, PICTURE_WIDTH - 1, PICTURE_HEIGHT - 1, Markup("").join([line, *dots]))
    return start.format(PICTURE_WIDTH, PICTURE_HEIGHT) + inside


def _scale(values: np.ndarray, size: int) -> Any:
    """Return the function that puts values into a picture."""
    low, high = float(values.min()), float(values.max())
    middle, extent = low / 2 + high / 2, high - low
    gain = (size - 2 * PICTURE_MARGIN) / extent if extent > 0 else 0.0
    return lambda value: size / 2 + (value - middle) * gain
