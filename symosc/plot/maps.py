"""Maps of sweeps over two axes: words and counts in classes, numbers in shades; and basins over starts.

Every class has its own lightness, a line around it, and its name in its largest place where there is room. So a map
can be read in greyscale.
"""

from __future__ import annotations

from fractions import Fraction
from json import loads
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from symosc.arguments import public
from symosc.errors import ParameterError
from symosc.plot.columns import label, read_axes, read_column, typeset, undecided
from symosc.plot.drawing import one_axes, style_for

if TYPE_CHECKING:
    import xarray

#: From light to dark with even steps of lightness.
SHADES, LIGHTEST, DARKEST = "cividis_r", 0.02, 0.92
MOST_CLASSES = 10
OTHERS_COLOR, UNDECIDED_COLOR = "white", "#d7191c"
OTHERS_HATCH, UNDECIDED_HATCH = "......", "xxxxxx"
# A class is named in the map where this part of the map's width is free around the place.
NAME_ROOM = 0.045
# Whole numbers of more different values than this are shown as shades.
MOST_LEVELS = 24
DARK = 0.45


class Classes(NamedTuple):
    """Cells by class: a number for each cell, and for each number what it is called and how it looks.

    Attributes
    ----------
    codes : (n0, n1) int array
    names : list of str
    colors : list
    hatches : list of str
    """

    codes: np.ndarray
    names: list[str]
    colors: list[Any]
    hatches: list[str]


@public
def map_figure(dataset: xarray.Dataset, name: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a map over two axes, the first one across.

    Words and whole numbers are classes with borders and a legend; of many words the rarest are one class. Other numbers
    are shades with lines of equal value. Cells that could not be decided are a class of their own.

    Parameters
    ----------
    dataset : xarray.Dataset
        What `symosc.sweep` returns over two axes.
    name : str, optional
        The column; default: the first that was recorded.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If an argument is none of these.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3", "FN": "5:10:2"}, t_end="12T", skip="10T")
    >>> [axes.get_ylabel() for axes in plot.map_figure(found).axes]
    ['$F_N$']
    """
    column = read_column(dataset, name)
    first, second = read_axes(column, 2, "a map")
    dataset = dataset.sortby([first, second])
    column = read_column(dataset, str(column.name))
    values, doubt = column.transpose(first, second).values, undecided(dataset, column.transpose(first, second))
    edges = _edges(column[first].values), _edges(column[second].values)
    with style_for(ax):
        drawing, axes = one_axes(ax, (5.2, 3.8))
        if values.dtype.kind in "UO" or (values.dtype.kind in "iu" and len(np.unique(values)) <= MOST_LEVELS):
            _draw_classes(axes, edges, classes_of(values, doubt), new=ax is None)
        else:
            _draw_shades(drawing, axes, edges, np.where(doubt, np.nan, values.astype(float)), label(str(column.name)))
        axes.set(xlabel=label(first), ylabel=label(second))
        axes.set(xlim=edges[0][[0, -1]], ylim=edges[1][[0, -1]])
    return drawing


@public
def basin_figure(dataset: xarray.Dataset, name: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw where starts in the phase plane lead: a map over x0 and v0, with the belts.

    Parameters
    ----------
    dataset : xarray.Dataset
        What `symosc.sweep` returns over x0 and v0.
    name : str, optional
        What tells the motions apart, such as "word" or the last position "x"; default: the first that was recorded.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If an argument is none of these.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"v0": "0:2:2", "x0": "-1:1:3"}, t_end="12T", skip="10T")
    >>> [axes.get_xlabel() for axes in plot.basin_figure(found).axes]
    ['$x_0$']
    """
    column = read_column(dataset, name)
    if set(read_axes(column, 2, "a basin")) != {"x0", "v0"}:
        raise ParameterError("dataset", "axes " + ", ".join(map(str, column.dims)), "a basin has the axes x0 and v0")
    drawing = map_figure(dataset.transpose("x0", "v0", ...), str(column.name), ax=ax)
    axes = drawing.axes[0] if ax is None else ax
    low, high = axes.get_ylim()
    with style_for(ax):
        for belt, speed in _belts(dataset).items():
            if low < speed < high:
                axes.axhline(speed, color="black", lw=0.8, ls=(0, (4, 2)))
                place: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
                axes.annotate(f"$v_{belt}$", (1, speed), (3, 0), va="center", **place)
    return drawing


def _belts(dataset: Any) -> dict[int, float]:
    scene = loads(dataset.attrs.get("scene", "{}"))
    return {belt: float(Fraction(scene[f"v{belt}"])) for belt in (1, 2) if f"v{belt}" in scene}


def classes_of(values: np.ndarray, doubt: np.ndarray) -> Classes:
    """Return the classes of cells: numbers in their order, words from the most frequent to the rarest."""
    texts = np.where(values == "", "no event", values).astype(str) if values.dtype.kind in "UO" else values
    kinds, codes, counts = np.unique(texts, return_inverse=True, return_counts=True)
    codes = codes.reshape(values.shape)
    if values.dtype.kind in "UO":
        order = np.argsort(-counts, kind="stable")
        codes, kinds = np.argsort(order, kind="stable")[codes], kinds[order]
    several = len(kinds) > MOST_CLASSES
    shown = MOST_CLASSES - 1 if several else len(kinds)
    names = [str(kind) for kind in kinds[:shown]]
    shades = colormaps[SHADES](np.linspace(LIGHTEST, DARKEST, max(shown, 2)))[:shown]
    colors, hatches = [*shades], [""] * shown
    if several:
        codes = np.minimum(codes, shown)
        names, colors, hatches = (
            [*names, f"{len(kinds) - shown} others"],
            [*colors, OTHERS_COLOR],
            [*hatches, OTHERS_HATCH],
        )
    if doubt.any():
        codes = np.where(doubt, len(names), codes)
        names, colors, hatches = [*names, "undecidable"], [*colors, UNDECIDED_COLOR], [*hatches, UNDECIDED_HATCH]
    return Classes(codes, names, colors, hatches)


def _draw_classes(axes: Axes, edges: tuple[np.ndarray, np.ndarray], classes: Classes, new: bool) -> None:
    palette = ListedColormap(classes.colors)
    options: dict[str, Any] = {"vmin": -0.5, "vmax": len(classes.names) - 0.5, "rasterized": True}
    axes.pcolormesh(*edges, classes.codes.T, cmap=palette, **options)
    for i, hatch in enumerate(classes.hatches):
        if hatch:
            _hatch(axes, edges, classes.codes == i, hatch)
    axes.add_collection(LineCollection(borders(*edges, classes.codes), colors="black", linewidths=0.5))
    for i, name in enumerate(classes.names):
        if not classes.hatches[i]:
            _name_place(axes, edges, classes.codes == i, name, classes.colors[i])
    handles = [
        Patch(facecolor=color, edgecolor="black", linewidth=0.5, hatch=hatch, label=typeset(name))
        for name, color, hatch in zip(classes.names, classes.colors, classes.hatches, strict=True)
    ]
    legend: dict[str, Any] = {"frameon": False, "handlelength": 1.4, "handleheight": 1.0}
    if new:
        axes.figure.legend(handles=handles, loc="outside right upper", **legend)
    else:
        axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1, 1), **legend)


def _hatch(axes: Axes, edges: tuple[np.ndarray, np.ndarray], inside: np.ndarray, hatch: str) -> None:
    """Hatch cells."""
    x, y = edges
    cells = [[(x[i], y[j]), (x[i + 1], y[j]), (x[i + 1], y[j + 1]), (x[i], y[j + 1])] for i, j in np.argwhere(inside)]
    axes.add_collection(PolyCollection(cells, facecolors="none", edgecolors="black", hatch=hatch, linewidths=0))


def _name_place(axes: Axes, edges: Any, inside: np.ndarray, name: str, color: Any) -> None:
    """Write the name of a class where its cells reach farthest from its border."""
    from scipy.ndimage import distance_transform_edt  # takes longer to load than most figures to draw

    depth = distance_transform_edt(np.pad(inside, 1), sampling=[1 / length for length in inside.shape])[1:-1, 1:-1]
    i, j = np.unravel_index(np.argmax(depth), depth.shape)
    if depth[i, j] > NAME_ROOM:
        place = [(edge[k] + edge[k + 1]) / 2 for edge, k in zip(edges, (i, j), strict=True)]
        ink = "white" if luminance(color) < DARK else "black"
        axes.text(place[0], place[1], typeset(name), ha="center", va="center", color=ink, fontsize=8)


def luminance(color: Any) -> float:
    """Return how light a colour is, from 0 to 1, as a greyscale print shows it."""
    red, green, blue = color[:3]
    return float(0.299 * red + 0.587 * green + 0.114 * blue)


def borders(x: np.ndarray, y: np.ndarray, codes: np.ndarray) -> list[list[tuple[float, float]]]:
    """Return the lines between cells of different classes; `x` and `y` are the edges of the cells."""
    lines = []
    for i, j in np.argwhere(codes[1:] != codes[:-1]):
        lines.append([(x[i + 1], y[j]), (x[i + 1], y[j + 1])])
    for i, j in np.argwhere(codes[:, 1:] != codes[:, :-1]):
        lines.append([(x[i], y[j + 1]), (x[i + 1], y[j + 1])])
    return lines


def _draw_shades(
    drawing: Figure, axes: Axes, edges: tuple[np.ndarray, np.ndarray], values: np.ndarray, name: str
) -> None:
    mesh = axes.pcolormesh(*edges, np.ma.masked_invalid(values).T, cmap=SHADES, rasterized=True)
    axes.set_facecolor(UNDECIDED_COLOR)
    drawing.colorbar(mesh, ax=axes, label=name)
    if min(values.shape) > 1 and np.nanmin(values) < np.nanmax(values):
        centres = [(edge[1:] + edge[:-1]) / 2 for edge in edges]
        lines = axes.contour(*centres, np.ma.masked_invalid(values).T, levels=5, colors="black", linewidths=0.5)
        axes.clabel(lines, fontsize=7, inline_spacing=2)


def _edges(values: np.ndarray) -> np.ndarray:
    """Return the edges of cells around values in increasing order."""
    if len(values) == 1:
        return values[0] + np.array([-0.5, 0.5])
    middles = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middles[0]], middles, [2 * values[-1] - middles[-1]]])
