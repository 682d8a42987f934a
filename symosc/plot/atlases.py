"""The figure of an atlas: its regions, borders, special points, and what is not proven."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch

from symosc.arguments import public
from symosc.plot.drawing import PARAMETER_LABELS, add_legend, one_axes, style_for, typeset
from symosc.plot.sweeps import WORD_COLORS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symosc.certificates.atlas import Atlas, Rectangle

#: Colours that differ in grey too, light enough for black lines on them; the last one is for all further words.
SHADES = (*WORD_COLORS[:6], "#e0e0e0")
#: How borders are drawn, by what the field calls them.
LINES = {"crossing-sliding": "-", "grazing-sliding": "--", "switching-sliding": "-.", "adding-sliding": ":"}


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
    limits = [[float(end) for end in side] for side in atlas.range]
    entries: dict[str, Any] = {}
    with style_for(ax):
        drawing, axes = one_axes(ax, (5.2, 3.8))
        for word in words:
            boxes = [corners(box.range) for box in atlas.boxes if box.word == word]
            colour = colours[word]
            axes.add_collection(PolyCollection(boxes, facecolors=colour, edgecolors=colour, linewidths=0.2))
            name = "other words" if colour == SHADES[-1] else typeset(word)
            entries[name] = Patch(facecolor=colour, edgecolor="0.4", linewidth=0.4)
        left = [corners(box) for box in atlas.open]
        if left:
            axes.add_collection(
                PolyCollection(left, facecolors="white", edgecolors="0.6", linewidths=0, hatch="//////")
            )
            entries["not proven"] = Patch(facecolor="white", edgecolor="0.6", hatch="//////", linewidth=0.4)
        seen = [(x, y, word) for x, y, word in atlas.grid if word in colours] if not atlas.boxes else []
        for word in words:
            places = np.array([each[:2] for each in seen if each[2] == word])
            if len(places):
                axes.plot(*places.T, "s", color=colours[word], markeredgecolor="0.4", markeredgewidth=0.3, markersize=5)
        for border in atlas.borders:
            line = LINES.get(border.sliding, (0, (1, 3)))
            (drawn,) = axes.plot(*border.points.T, linestyle=line, color="black", linewidth=0.9)
            entries.setdefault(border.sliding or border.kind, drawn)
        for i, point in enumerate(atlas.special):
            axes.plot(*point.values, "o", color="black", markersize=3)
            name = "fold" if point.kind == "fold" else f"C{i + 1}"
            axes.annotate(name, point.values, xytext=(3, 3), textcoords="offset points", fontsize=7)
        axes.set(xlabel=PARAMETER_LABELS[atlas.over[0]], ylabel=PARAMETER_LABELS[atlas.over[1]])
        axes.set(xlim=limits[0], ylim=limits[1])
        add_legend(drawing, ax, entries, 3)
    return drawing


def corners(box: Rectangle) -> list[tuple[float, float]]:
    """Return the corners of a rectangle in order."""
    (a, b), (c, d) = ((float(low), float(high)) for low, high in box)
    return [(a, c), (b, c), (b, d), (a, d)]
