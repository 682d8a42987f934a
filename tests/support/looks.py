"""All of a figure as text: what `stored_outputs` says of it, and the look of its artists."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.colors import is_color_like, to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.spines import Spine
from matplotlib.text import Text
from stored_outputs import lines_of_figure, sampled

NAMES = {
    Legend: ("frame_on", "visible"),
    Line2D: (
        "markerfacecolor",
        "markeredgecolor",
        "markeredgewidth",
        "clip_on",
        "drawstyle",
        "alpha",
    ),
    Text: ("color", "fontsize", "ha", "va"),
    Collection: ("edgecolor", "linewidth", "hatch", "linestyle", "rasterized"),
    Patch: ("facecolor", "edgecolor", "linewidth", "hatch", "linestyle"),
}


def full(figure: Figure) -> str:
    """Return what a figure shows, and how.

    One line for each look, with the number of artists that have it.
    """
    return "\n".join([*lines_of_figure(figure), *looks(figure)])


def looks(figure: Figure) -> Iterator[str]:
    """Yield the looks of the artists in each axes and of the legends, and how the axes stand."""
    for axes in [*figure.axes, *(inset for each in figure.axes for inset in each.child_axes)]:
        spec = axes.get_subplotspec()
        grid = spec and (
            spec.rowspan.start,
            spec.colspan.start,
            spec.get_gridspec().get_height_ratios(),
        )
        grid = grid and (*grid, spec.get_gridspec().get_width_ratios())  # type: ignore[union-attr]
        shown_below, font = (
            axes.xaxis.get_tick_params().get(name) for name in ("labelbottom", "labelfontfamily")
        )
        box = (axes.get_aspect(), axes.get_box_aspect(), axes.margins(), axes.get_in_layout())
        yield f"stands {grid} {box} {shown_below} {font}"
        yield from dict.fromkeys(
            look for artist in axes.get_children() if (look := look_of(artist, axes))
        )
    for legend in [*figure.legends, *(axes.get_legend() for axes in figure.axes)]:
        if legend:
            yield f"legend {legend._ncols} {legend.get_frame_on()} {legend.columnspacing} {legend.handlelength}"  # type: ignore[attr-defined]
            yield from (look for handle in legend.legend_handles if (look := look_of(handle, None)))


def look_of(artist: Any, axes: Axes | None) -> str:
    """Return one line about the look of an artist, "" for what is in every axes."""
    if (
        isinstance(artist, Spine)
        or (axes and artist is axes.patch)
        or (isinstance(artist, Text) and not str(artist))
    ):
        return ""
    kind = next((kind for kind in NAMES if isinstance(artist, kind)), None)
    if kind is None or (kind is Text and not artist.get_text()):
        return ""
    names = NAMES[kind]
    if kind is Line2D and artist.get_marker() == "None":
        names = tuple(name for name in names if not name.startswith("marker"))
    values = [shown(getattr(artist, f"get_{name}")()) for name in names]
    if kind is Collection and artist.get_array() is not None:
        values += [str(artist.get_clim()), sampled(artist.get_cmap()(np.linspace(0, 1, 16)))]
    if axes is None and kind is Line2D:
        values += [
            shown(getattr(artist, f"get_{name}")())
            for name in ("marker", "markersize", "linestyle", "color")
        ]
    if (offset := getattr(artist, "xyann", None)) is not None:
        values += [f"beside {artist.xy} by {' '.join(f'{each:.2f}' for each in offset)}"]
    return f"  {kind.__name__} {' '.join(values)}"


def shown(value: Any) -> str:
    """Return a property as text; of many colours or lengths their sums."""
    if isinstance(value, (str, tuple)) and is_color_like(value) and str(value).lower() != "none":
        return to_hex(value)  # versions differ in which form they keep
    if isinstance(value, np.ndarray):
        return sampled(value)
    if value is None:
        return "-"
    return str(value)
