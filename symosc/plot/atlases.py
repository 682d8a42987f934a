"""The figure of an atlas: its regions, borders, special points, and what is not proven."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch

from symosc.aliases import Record
from symosc.arguments import public
from symosc.plot.drawing import PARAMETER_LABELS, add_legend, axes_for, typeset
from symosc.plot.figures import BORDER_STYLES
from symosc.plot.sweeps import WORD_COLORS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symosc.certificates.atlas import Atlas, Rectangle

#: Colours that differ in grey too, light enough for black lines on them; the last one is for all further words.
SHADES = (*WORD_COLORS[:6], "#e0e0e0")


@public
def atlas_figure(atlas: Atlas, *, ax: Axes | None = None) -> Figure:
    """Draw an atlas: proven boxes in colours, what is not proven hatched, borders by kind, and special points.

    Parameters
    ----------
    atlas : Atlas
    ax : matplotlib Axes, optional
        Axes of your own.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from symosc import atlas, plot
    >>> plane = atlas("fig9", {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, workers=1)
    >>> [axes.get_xlabel() for axes in plot.atlas_figure(plane).axes]
    ['$\\\\Omega$']
    """
    words = [region.word for region in atlas.regions if region.word]
    colours = {word: SHADES[min(i, len(SHADES) - 1)] for i, word in enumerate(words)}
    entries: dict[str, Any] = {}
    with axes_for(ax, (5.2, 3.8)) as (drawing, (axes,)):
        for word, colour in colours.items():
            boxes = [corners(box.range) for box in atlas.boxes if box.word == word]
            axes.add_collection(PolyCollection(boxes, facecolors=colour, edgecolors=colour, linewidths=0.2))
            name = "other words" if colour == SHADES[-1] else typeset(word)
            entries[name] = Patch(facecolor=colour, edgecolor="0.4", linewidth=0.4)
        if atlas.open:
            hatched: Record = {"facecolor": "white", "edgecolor": "0.6", "hatch": "//////"}
            axes.add_collection(PolyCollection([corners(box) for box in atlas.open], linewidths=0, **hatched))
            entries["not proven"] = Patch(linewidth=0.4, **hatched)
        for word, colour in () if atlas.boxes else colours.items():
            places = np.array([(x, y) for x, y, seen in atlas.grid if seen == word])
            if len(places):
                axes.plot(*places.T, "s", color=colour, markeredgecolor="0.4", markeredgewidth=0.3, markersize=5)
        for border in atlas.borders:
            line = BORDER_STYLES.get(border.sliding, {"linestyle": (0, (1, 3))})["linestyle"]
            (drawn,) = axes.plot(*border.points.T, linestyle=line, color="black", linewidth=0.9)
            entries.setdefault(border.sliding or border.kind, drawn)
        for i, point in enumerate(atlas.special, 1):
            axes.plot(*point.values, "o", color="black", markersize=3)
            name = "fold" if point.kind == "fold" else f"C{i}"
            axes.annotate(name, point.values, xytext=(3, 3), textcoords="offset points", fontsize=7)
        xlim, ylim = ([float(end) for end in side] for side in atlas.range)
        axes.set(xlabel=PARAMETER_LABELS[atlas.over[0]], ylabel=PARAMETER_LABELS[atlas.over[1]], xlim=xlim, ylim=ylim)
        add_legend(drawing, ax, entries, 3)
    return drawing


def corners(box: Rectangle) -> list[tuple[float, float]]:
    """Return the corners of a rectangle in order."""
    (a, b), (c, d) = ((float(low), float(high)) for low, high in box)
    return [(a, c), (b, c), (b, d), (a, d)]
