"""Figures of many motions: sweeps over one or two axes, frequency responses, events and summaries,
and atlases.

In maps every class has its own lightness, a line around it, and its name in its largest place where
there is room. So a map can be read in greyscale.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from itertools import pairwise
from json import loads
from math import pi
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import ListedColormap, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from symosc.base.aliases import Record
from symosc.base.arguments import DATASET, TEXT, one_of, public, require, require_or_none
from symosc.base.errors import ParameterError
from symosc.base.quantities import quantity_of
from symosc.engine.events import KIND_NAMES
from symosc.plot.drawing import (
    PARAMETER_LABELS,
    FigureSize,
    add_legend,
    axes_for,
    draw_belts,
    panels_for,
    shown_name,
    typeset,
    write_above,
)
from symosc.plot.figures import BORDER_STYLES
from symosc.plot.panels import EVENT_MARKS, SHAPES
from symosc.simulation.tables import EventTable, Summary
from symosc.words import cycle

if TYPE_CHECKING:
    import xarray

    from symosc.analysis.response import FrequencyResponse
    from symosc.basins.bifurcation import Bifurcation
    from symosc.certificates.atlas import Atlas, Rectangle
    from symosc.sweeps.output import SweptDataset

LABELS = PARAMETER_LABELS | {
    "stuck": "share of time stuck",
    "x": "last $x$",
    "v": r"last $\dot{x}$",
}
LABELS |= {
    "x_min": "least $x$",
    "x_max": "largest $x$",
    "v_min": r"least $\dot{x}$",
    "v_max": r"largest $\dot{x}$",
}
COMPONENT_LABELS = {
    "x": "displacement $x$ at whole periods",
    "v": "velocity $\\dot{x}$ at whole periods",
}
#: Of numbers: from light to dark with even steps of lightness.
SHADES = "cividis_r"
#: Of words: hues far apart, each darker than the one before, so that they differ in greyscale too.
WORD_COLORS = (
    "#fee9b9", "#98e0fd", "#fcaca9", "#57c16b", "#b282ea", "#c66d27", "#1776b4", "#b12061", "#00574c", "#033783",
)  # fmt: skip
MOST_CLASSES = 10
#: The room of a word above axes, as parts of their width: between words, and for each letter.
WORD_MARGIN = 0.02
LETTER_WIDTH = 0.015
#: Whole numbers of more different values are shades in a map, not classes.
MOST_WHOLE_CLASSES = 24
#: A class is named in a map only if so much of the map is free around the place.
LEAST_ROOM = 0.045
#: Bars of a summary; the rarest values share the last one.
MOST_BARS = 12
UNDECIDED_COLOR = "#d7191c"


def read_column(dataset: Any, name: Any) -> Any:
    """Return the column `name` of a sweep, without dimensions of length 1.

    ParameterError if it was not recorded.
    """
    if "status" not in dataset:
        raise ParameterError(
            "dataset", type(dataset).__name__, "must be what sweep(...) returns, with its status"
        )
    names = [str(column) for column in dataset.data_vars]
    if name is None:
        if "section" in names:
            name = "section"
        else:
            name = names[0]
    if name not in names:
        raise ParameterError("name", name, f"must be a recorded column: {', '.join(names)}")
    return dataset[name].squeeze(
        [axis for axis in axes_of(dataset[name]) if dataset.sizes[axis] == 1]
    )


def axes_of(column: Any) -> list[str]:
    """Return the names of the dimensions over which a column was swept."""
    return [str(axis) for axis in column.dims if axis not in ("period", "component")]


def read_axes(column: Any, count: int, what: str) -> list[str]:
    """Return the names of the swept axes of a column.

    ParameterError unless there are `count`, each with coordinates.

    `what` names the figure in the error.
    """
    if "component" in column.dims:
        raise ParameterError(
            "name", column.name, "must have one value a motion; bifurcation_figure draws sections"
        )
    axes = axes_of(column)
    if len(axes) != count or any(axis not in column.coords for axis in axes):
        sizes = ", ".join(f"{axis} ({column.sizes[axis]})" for axis in axes) or "none"
        allowed = f"{what} needs {count}; select values, such as dataset.isel(k=0)"
        raise ParameterError("dataset", f"axes {sizes}", allowed)
    return axes


def label(name: str) -> str:
    """Return the axis label of a parameter, a start value or a column."""
    return LABELS.get(name) or shown_name(name.replace("_", " "))


# -- sweeps over one axis --------------------------------------------------------------------------


@public
def swept_figure(
    dataset: xarray.Dataset | SweptDataset,
    name: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw the result of a sweep as a curve or a map, by its number of axes.

    A section over one axis is a bifurcation diagram, anything else over one axis a curve; two axes
    make a map, and a basin if they are starts x0 and v0.

    Parameters
    ----------
    dataset : xarray.Dataset
        What `symosc.sweep` returns, or a selection of it such as ``dataset.isel(k=0)``;
        ``dataset.symosc.plot()`` too draws it.
    name : str, optional
        The column, such as "word". Default: the section if there is one, else the first that was
        recorded.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3", "FN": "5:10:2"}, t_end="12T", skip="10T")
    >>> [axes.get_xlabel() for axes in plot.swept_figure(found).axes]
    ['$\\\\Omega$']
    """
    from symosc.sweeps.output import SweptDataset

    require(DATASET, SweptDataset, dataset=dataset)
    require_or_none(TEXT, name=name)
    data: Any = getattr(dataset, "dataset", dataset)  # an accessor `dataset.symosc` stands for it
    column = read_column(data, name)
    axes = axes_of(column)
    if column.name == "section":
        return bifurcation_figure(data, ax=ax, figsize=figsize)
    if len(axes) == 1:
        return curve_figure(data, column.name, ax=ax, figsize=figsize)
    if set(axes) == {"x0", "v0"}:
        return basin_figure(data, column.name, ax=ax, figsize=figsize)
    return map_figure(data, column.name, ax=ax, figsize=figsize)


@public
def bifurcation_figure(
    dataset: xarray.Dataset | Bifurcation,
    component: Literal["x", "v"] = "x",
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw the section over one parameter: a point for each recorded period.

    Of what `symosc.bifurcation` returns coexisting attractors are told apart: those that motions
    reach upward, and others, each with a colour and a mark of its own. Several starts of a sweep lie
    over each other. If a sweep recorded words too, dashed lines mark where the word changes; the
    words stand above.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3"}, record="section:2", t_end="12T")
    >>> [axes.get_ylabel() for axes in plot.bifurcation_figure(found).axes]
    ['displacement $x$ at whole periods']
    """
    from symosc.basins.bifurcation import Bifurcation

    require(DATASET, Bifurcation, dataset=dataset)
    require(one_of("x", "v"), component=component)
    if isinstance(dataset, Bifurcation):
        return _branches(dataset, component, ax, figsize)
    section = read_column(dataset, "section").sel(component=component)
    if "start" in section.dims:
        one_start = section.isel(start=0)
    else:
        one_start = section
    (name,) = read_axes(one_start, 1, "a bifurcation diagram")
    points = section.transpose(name, ...).values.reshape(section.sizes[name], -1)
    values = section[name].values
    with axes_for(ax, (5.0, 3.4), figsize=figsize) as (drawing, (axes,)):
        _scatter(axes, np.repeat(values, points.shape[1]), points.ravel())
        axes.set(
            xlabel=label(name),
            ylabel=COMPONENT_LABELS[component],
            xlim=(values.min(), values.max()),
        )
        if "word" in dataset:
            words = read_column(dataset, "word")
            words = (words.isel(start=0) if "start" in words.dims else words).sortby(name)
            _mark_changes(axes, words[name].values, words.values.astype(str))
    return drawing


#: Colours and marks of the branches of a bifurcation, from dark to light, and their texts.
BRANCH_STYLES = (
    ("black", "o"),
    ("#c66d27", "D"),
    ("#57c16b", "^"),
    ("#1776b4", "v"),
    ("#b282ea", "s"),
)
BRANCH_TEXTS = {"upward": "followed upward", "downward": "only followed downward"}
NO_DRIVE_LABEL = r"$x$ where $\dot{x}$ falls through 0"


def _branches(
    found: Bifurcation, component: Literal["x", "v"], ax: Axes | None, figsize: FigureSize
) -> Figure:
    """Draw a bifurcation diagram with a look for each branch that has an attractor of its own."""
    drive = "upward" in found.branches
    coordinate = "xv".index(component)
    entries: dict[str, Any] = {}
    with axes_for(ax, (5.4, 3.6), figsize=figsize) as (drawing, (axes,)):
        for n, branch in enumerate(found.branches):
            alone = found.attractor[:, n] == n
            if not alone.any():
                continue
            points = found.points[alone, n, :, coordinate]
            colour, mark = BRANCH_STYLES[n % len(BRANCH_STYLES)]
            size = 2.4 if points.shape[1] == 1 else max(0.5, 12.0 / points.size**0.25)
            style: Record = {"marker": mark, "color": colour, "linestyle": "none"}
            axes.plot(
                np.repeat(found.values[alone], points.shape[1]), points.ravel(),
                **style, ms=size, markeredgewidth=0, rasterized=True, zorder=2 + n,
            )  # fmt: skip
            if drive:
                text = BRANCH_TEXTS.get(branch, f"only from {branch}")
            else:
                text = branch
            (entries[text],) = axes.plot([], [], **style, ms=4, markeredgewidth=0)
        axes.set(
            xlabel=label(found.name),
            ylabel=COMPONENT_LABELS[component] if drive else NO_DRIVE_LABEL,
            xlim=(found.values.min(), found.values.max()),
        )
        if len(entries) > 1 or not drive:
            add_legend(drawing, ax, entries, 2 if len(entries) == 4 else 3)
    return drawing


def _mark_changes(axes: Axes, values: np.ndarray, words: np.ndarray, named: bool = True) -> None:
    """Mark where the word changes between increasing values; if `named` write each above its
    stretch where it fits.
    """
    changes = np.flatnonzero(words[1:] != words[:-1]) + 1  # indices of the first new word
    low, high = axes.get_xlim()
    # A line halfway between the last value with a word and the first one with the next.
    lines = [(values[i - 1] + values[i]) / 2 for i in changes]
    for line in lines:
        axes.axvline(line, color="0.6", lw=0.6, ls=(0, (4, 2)), zorder=0)
    for i, (left, right) in zip([0, *changes], pairwise([low, *lines, high]), strict=True):
        word_width = (high - low) * (WORD_MARGIN + LETTER_WIDTH * len(words[i]))
        if named and right - left > word_width:
            write_above(axes, (left + right) / 2, typeset(words[i]), 3)


@public
def curve_figure(
    dataset: xarray.Dataset,
    name: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw a column against one parameter: numbers as a curve, words as levels.

    Arguments as for `swept_figure`.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3"}, record="events", t_end="12T")
    >>> [axes.get_ylabel() for axes in plot.curve_figure(found).axes]
    ['events']
    """
    require(DATASET, dataset=dataset)
    require_or_none(TEXT, name=name)
    column = read_column(dataset, name)
    (axis,) = read_axes(column, 1, "a curve")
    column = column.sortby(axis)
    column_values = column.values
    values = column[axis].values
    with axes_for(ax, (5.0, 3.4), figsize=figsize) as (drawing, (axes,)):
        if column_values.dtype.kind in "UO":
            words, levels = np.unique(column_values.astype(str), return_inverse=True)
            axes.plot(values, levels, linestyle="none", marker="o", ms=2.5, color="black")
            axes.set_yticks(range(len(words)), [typeset(word) for word in words])
        else:
            axes.plot(
                values,
                column_values,
                color="black",
                lw=0.8,
                drawstyle="steps-mid" if column_values.dtype.kind in "iu" else None,
            )
        axes.set(xlabel=label(axis), ylabel=label(str(column.name)), xlim=values[[0, -1]])
    return drawing


def _scatter(axes: Axes, x: np.ndarray, y: np.ndarray) -> None:
    """Draw points, the smaller the more there are."""
    size = max(6.0 * min(1.0, 500 / max(len(x), 1)), 0.3)
    axes.scatter(x, y, s=size, color="black", linewidths=0, rasterized=True)


# -- frequency responses ---------------------------------------------------------------------------

BALANCE_COLOR = "#d55e00"
#: Styles of the columns of a frequency response, and their labels; others are black lines without a
#: label.
RESPONSE_STYLES: dict[str, Record] = {
    "amplitude": {"label": "exact amplitude"},
    "dissipated": {"label": "lost in all", "lw": 1.8},
    "balance": {"color": BALANCE_COLOR, "ls": (0, (4, 2)), "label": "harmonic balance"},
    "damper": {"color": "#0072b2", "ls": "-.", "label": "in the damper"},
    "friction": {"color": "#cc79a7", "ls": (0, (1, 1)), "label": "in friction"},
    "balance_error": {"color": BALANCE_COLOR},
}
#: What the lines of a response look like that was followed up and down.
RESPONSE_WAYS: dict[str, Record] = {
    "up": {"color": "black", "ls": "-", "marker": "^", "mfc": "black"},
    "down": {"color": "0.55", "ls": (0, (4, 2)), "marker": "v", "mfc": "white"},
}
#: The columns of each panel of a frequency response, the label of its axis, and the height of a
#: thin line across.
RESPONSE_PANELS: dict[str, tuple[tuple[str, ...], str, float | None]] = {
    "a": (("amplitude", "balance"), "amplitude", None),
    "b": (("transmissibility",), "transmissibility", 1),
    "c": (("phase",), "phase behind the excitation", None),
    "d": (("dissipated", "damper", "friction"), "energy per cycle", None),
    "e": (("stuck",), "share of time stuck", None),
    "f": (("balance_error",), "error of harmonic balance in %", 0),
}
#: How much higher than all but the highest fifth of a true resonance a panel is, and how many
#: resonances it names.
HIGHEST = 4.0
MOST_NAMED = 3
#: Values of a parameter up to which each has a marker.
FEW_POINTS = 40


@public
def response_figure(
    found: FrequencyResponse,
    panels: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw a frequency response.

    The words stand above the first panel, and lines mark where they change.

    Parameters
    ----------
    found : FrequencyResponse
    panels, ax, figsize : optional
        As for `symosc.plot.figure`. The panels are a amplitude, with that of harmonic balance, b
        transmissibility, c phase, d energies per cycle, e share of the time stuck, f error of
        harmonic balance. Default: all, with `ax` a. Where the motion was followed up and down,
        there is a line for each way, of the first of these alone, and no panel f.

    Examples
    --------
    >>> from symosc import frequency_response, plot
    >>> found = frequency_response("fig9", {"Omega": "3:5:9"})
    >>> [axes.get_ylabel() for axes in plot.response_figure(found, "ac").axes]
    ['amplitude', 'phase behind the excitation']
    """
    from symosc.analysis.response import FrequencyResponse

    require(FrequencyResponse, found=found)
    # The words are those of the way that was followed first.
    first = np.flatnonzero(found.direction == found.direction[0])
    order = first[np.argsort(found.values[first])]
    # A motion without a word has a blank: a name that takes room and shows nothing.
    words = np.where(
        found.status == "rest", "rest", [cycle(str(word)) or " " for word in found.word]
    )[order]
    layout: Record = {"more": 0.5, "columns": 2, "letter_at": -0.12}
    draw = {letter: partial(_response_panel, letter=letter) for letter in RESPONSE_PANELS}
    if found.direction[0] and np.isnan(found.balance_error).all():
        del draw["f"]
    with panels_for(found, draw, panels, ax, (3.5, 2.1), figsize=figsize, **layout) as (
        drawing,
        row,
    ):
        for axes in row:
            axes.set_xlim(found.values.min(), found.values.max())
            _mark_changes(axes, found.values[order], words, named=axes is row[0])
        for axes in row[-2:]:  # the lowest of each of the two columns
            axes.set_xlabel(f"${quantity_of(found.name).letter}$")
        add_legend(drawing, ax, row, 5)
    return drawing


def _response_panel(axes: Axes, response: FrequencyResponse, letter: str) -> None:
    """Draw a panel of a frequency response, with gaps where a column is infinite."""
    names, text, level = RESPONSE_PANELS[letter]
    drawn = list[np.ndarray]()
    shift = {"phase": 2 * pi * (response.phase < -pi / 2)}  # phases from -pi/2 to 3 pi/2
    for way in dict.fromkeys(response.direction.tolist()):
        rows = np.flatnonzero(response.direction == way)
        order = rows[np.argsort(response.values[rows])]
        for name in names:
            if way and name != names[0]:  # two lines, which differ in print too, are enough
                continue
            column = getattr(response, name)[order]
            column = column + shift.get(name, np.zeros(len(response)))[order]
            column = np.where(np.isfinite(column), column, np.nan)
            if name == "balance_error":  # in percent
                column = column * 100
            axes.plot(response.values[order], column, **_line_style(name, way, column))
            drawn.append(column[np.isfinite(column)])
    if level is not None:
        axes.axhline(level, color="0.6", lw=0.6, zorder=0)
    axes.set_ylabel(text)
    if letter == "c":
        axes.set_yticks([0, pi / 2, pi], ["0", r"$\pi/2$", r"$\pi$"])
    elif letter == "e":
        axes.set_ylim(-0.02, 1.02)
    elif letter in "abd":
        _fit_height(axes, response, np.concatenate([np.zeros(0), *drawn]))


def _line_style(name: str, way: str, column: np.ndarray) -> Record:
    """Return the style of a column of a response.

    Followed upwards it is dark, with triangles that point up, downwards grey and open: the ways
    differ in print too.
    """
    style: Record = {"color": "black", "lw": 1.2} | RESPONSE_STYLES.get(name, {})
    if len(column) <= FEW_POINTS:
        style |= {"marker": "o", "ms": 3}
    if not way:
        return style
    return style | {"ms": 3.5, "label": f"{way}wards"} | RESPONSE_WAYS[way]


def _fit_height(axes: Axes, response: FrequencyResponse, drawn: np.ndarray) -> None:
    """Let the axis of a panel begin at 0 and show all finite values that are `drawn`.

    Only next to a true resonance, where the motion grows for ever, they are cut off where all else
    would look flat; the panel says so.
    """
    if not len(drawn):
        return
    top = float(drawn.max()) or 1.0
    resonances = response.values[np.isinf(response.balance)]
    if len(resonances):
        highest = HIGHEST * float(np.quantile(drawn, 0.8))
        is_cut = 0.0 < highest < top
        if is_cut:
            top = highest
        values = ", ".join(f"{value:.6g}" for value in resonances[:MOST_NAMED])
        if len(resonances) > MOST_NAMED:
            values += ", …"
        note = f"infinite at {PARAMETER_LABELS[response.name]} = {values}"
        if is_cut:
            note += "\nhigher values cut off"
        for value in resonances:
            axes.axvline(value, color="0.6", lw=0.8, ls=":", zorder=0)
        axes.text(0.98, 0.94, note, transform=axes.transAxes, ha="right", va="top", fontsize=7)
    axes.set_ylim(0, 1.08 * top)


# -- sweeps over two axes --------------------------------------------------------------------------


#: The name of a class of cells of a map, its colour and its hatch.
Look = tuple[str, Any, str]


@public
def map_figure(
    dataset: xarray.Dataset,
    name: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw a map over two axes, the first one across; arguments as for `swept_figure`.

    Words and whole numbers are classes with borders and a legend; of many words the rarest are one
    class. Other numbers are shades with lines of equal value. Cells that could not be decided are a
    class of their own.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3", "FN": "5:10:2"}, t_end="12T", skip="10T")
    >>> [axes.get_ylabel() for axes in plot.map_figure(found).axes]
    ['$F_N$']
    """
    require(DATASET, dataset=dataset)
    require_or_none(TEXT, name=name)
    return _map(dataset, read_column(dataset, name), ax, figsize)


def _map(dataset: xarray.Dataset, column: Any, ax: Axes | None, figsize: FigureSize) -> Figure:
    """Draw a column as a map over its two swept axes, with the belts if the vertical axis is v0.

    Return the figure.
    """
    over = read_axes(column, 2, "a map")
    first, second = over
    column = column.sortby(over).transpose(*over)
    unknown = read_column(dataset, "status").sortby(over).transpose(*over).values == "undecidable"
    values = column.values
    x_edges = cell_edges(column[first].values)
    y_edges = cell_edges(column[second].values)
    edges = x_edges, y_edges
    are_words = values.dtype.kind in "UO"
    are_whole = values.dtype.kind in "iu"
    with axes_for(ax, (5.2, 3.8), figsize=figsize) as (drawing, (axes,)):
        if are_words or (are_whole and len(np.unique(values)) <= MOST_WHOLE_CLASSES):
            codes, looks = classes_of(values, unknown)
            _draw_classes(axes, edges, codes, looks, label(str(column.name)), new=ax is None)
        else:
            known = np.where(unknown, np.nan, values.astype(float))
            _draw_shades(axes, edges, known, label(str(column.name)))
        axes.set(
            xlabel=label(first),
            ylabel=label(second),
            xlim=x_edges[[0, -1]],
            ylim=y_edges[[0, -1]],
        )
        scene = loads(dataset.attrs.get("scene", "{}"))
        if second == "v0":
            draw_belts(
                axes,
                [Fraction(scene[name]) for name in ("v1", "v2") if name in scene],
                *axes.get_ylim(),
            )
    return drawing


@public
def basin_figure(
    dataset: xarray.Dataset,
    name: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw where starts in the phase plane lead: a map over x0 and v0 with the belts.

    Arguments as for `swept_figure`.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"v0": "0:2:2", "x0": "-1:1:3"}, t_end="12T", skip="10T")
    >>> [axes.get_xlabel() for axes in plot.basin_figure(found).axes]
    ['$x_0$']
    """
    require(DATASET, dataset=dataset)
    require_or_none(TEXT, name=name)
    column = read_column(dataset, name)
    if set(read_axes(column, 2, "a basin")) != {"x0", "v0"}:
        raise ParameterError(
            "dataset", "axes " + ", ".join(map(str, column.dims)), "a basin has the axes x0 and v0"
        )
    return _map(dataset, column.transpose("x0", "v0"), ax, figsize)


def classes_of(values: np.ndarray, undecidable: np.ndarray) -> tuple[np.ndarray, list[Look]]:
    """Return for each cell the number of its class, and for each class its name, colour and
    hatching.
    """
    are_words = values.dtype.kind in "UO"
    if are_words:
        named_values = np.where(values == "", "no event", values).astype(str)
    else:
        named_values = values
    kinds, codes, counts = np.unique(named_values, return_inverse=True, return_counts=True)
    codes = codes.reshape(values.shape)
    if are_words:  # the most frequent first; whole numbers stay in their order
        order = np.argsort(-counts, kind="stable")
        codes = np.argsort(order, kind="stable")[codes]  # the inverse of the permutation
        kinds = kinds[order]
    if len(kinds) > MOST_CLASSES:
        shown = MOST_CLASSES - 1
    else:
        shown = len(kinds)
    shades: Any = colormaps[SHADES](np.linspace(0.02, 0.92, max(shown, 2)))
    if are_words:
        spread = np.linspace(0, len(WORD_COLORS) - 1, max(shown, 2)).round().astype(int)
        shades = to_rgba_array([WORD_COLORS[i] for i in spread])
    looks = [(str(kind), shade, "") for kind, shade in zip(kinds[:shown], shades, strict=False)]
    if shown < len(kinds):
        codes = np.minimum(codes, shown)
        looks.append((f"{len(kinds) - shown} others", "white", "......"))
    if undecidable.any():
        codes = np.where(undecidable, len(looks), codes)
        looks.append(("undecidable", UNDECIDED_COLOR, "xxxxxx"))
    return codes, looks


def _draw_classes(
    axes: Axes,
    edges: tuple[np.ndarray, np.ndarray],
    codes: Any,
    looks: list[Look],
    title: str,
    new: bool,
) -> None:
    """Draw cells between `edges` by the `looks` of their classes `codes`, with a legend that has
    this `title`: beside all axes if `new`.
    """
    x, y = edges
    colors = ListedColormap([color for _, color, _ in looks])
    axes.pcolormesh(x, y, codes.T, cmap=colors, vmin=-0.5, vmax=len(looks) - 0.5, rasterized=True)
    axes.add_collection(LineCollection(borders(x, y, codes), colors="black", linewidths=0.5))
    for number, (name, color, hatch) in enumerate(looks):
        inside = codes == number
        if hatch:
            sides = ((0, 0), (1, 0), (1, 1), (0, 1))
            cells = [
                [(x[i + right], y[j + up]) for right, up in sides] for i, j in np.argwhere(inside)
            ]
            style: Record = {
                "facecolors": "none",
                "edgecolors": "black",
                "hatch": hatch,
                "linewidths": 0,
            }
            axes.add_collection(PolyCollection(cells, **style))
        else:
            _label_class(axes, edges, inside, name, color)
    frame: Record = {"edgecolor": "black", "linewidth": 0.5}
    handles = [
        Patch(facecolor=color, hatch=hatch, label=typeset(name), **frame)
        for name, color, hatch in looks
    ]
    if new:
        position: Record = {"loc": "outside right upper"}
        draw = axes.figure.legend
    else:
        position = {"loc": "upper left", "bbox_to_anchor": (1, 1)}
        draw = axes.legend
    look: Record = {"frameon": False, "handlelength": 1.4, "handleheight": 1.0}
    draw(handles=handles, title=title, title_fontsize=8, alignment="left", **look, **position)


def _label_class(axes: Axes, edges: Any, inside: np.ndarray, name: str, color: Any) -> None:
    """Write the name of a class at the point deepest within its cells, where `inside` is true, if
    there is room.
    """
    # scipy.ndimage takes longer to load than most figures to draw.
    from scipy.ndimage import distance_transform_edt

    # The padding makes the map's frame an edge of the class; depths are parts of the map's sides.
    depth = distance_transform_edt(
        np.pad(inside, 1), sampling=[1 / length for length in inside.shape]
    )[1:-1, 1:-1]
    cell = np.unravel_index(np.argmax(depth), depth.shape)
    if depth[cell] > LEAST_ROOM:
        x, y = ((edge[k] + edge[k + 1]) / 2 for edge, k in zip(edges, cell, strict=True))
        red, green, blue = color[:3]
        # The weights of red, green and blue in the lightness of a grey picture.
        if 0.299 * red + 0.587 * green + 0.114 * blue < 0.45:
            ink = "white"
        else:
            ink = "black"
        axes.text(x, y, typeset(name), ha="center", va="center", color=ink, fontsize=8)


def borders(x: np.ndarray, y: np.ndarray, codes: np.ndarray) -> list[list[tuple[float, float]]]:
    """Return the lines between cells of different classes: `codes` numbers the classes, `x` and `y`
    are cell edges.
    """
    upright = [
        [(x[i + 1], y[j]), (x[i + 1], y[j + 1])] for i, j in np.argwhere(codes[1:] != codes[:-1])
    ]
    level = [
        [(x[i], y[j + 1]), (x[i + 1], y[j + 1])]
        for i, j in np.argwhere(codes[:, 1:] != codes[:, :-1])
    ]
    return upright + level


def _draw_shades(
    axes: Axes, edges: tuple[np.ndarray, np.ndarray], values: np.ndarray, name: str
) -> None:
    """Draw a map of numbers as shades, with lines of equal value and a colour bar."""
    shown = np.ma.masked_invalid(values).T
    axes.set_facecolor(UNDECIDED_COLOR)  # seen where a value is missing
    mesh = axes.pcolormesh(*edges, shown, cmap=SHADES, rasterized=True)
    axes.figure.colorbar(mesh, ax=axes, label=name)
    if min(values.shape) > 1 and np.nanmin(values) < np.nanmax(values):
        centres = [(edge[1:] + edge[:-1]) / 2 for edge in edges]
        lines = axes.contour(*centres, shown, levels=5, colors="black", linewidths=0.5)
        axes.clabel(lines, fontsize=7, inline_spacing=2)


def cell_edges(values: np.ndarray) -> np.ndarray:
    """Return the edges of cells around increasing values: the middles between them, and one edge at
    each end.
    """
    middles = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middles[0]], middles, [2 * values[-1] - middles[-1]]])


# -- ensembles -------------------------------------------------------------------------------------


@public
def events_figure(
    events: EventTable, *, ax: Axes | None = None, figsize: FigureSize = None
) -> Figure:
    """Draw the events that `symosc.simulate_many` returns: time across, one line of marks for each
    motion.

    Examples
    --------
    >>> from symosc import load_scene, plot, simulate_many
    >>> events = simulate_many(load_scene("fig5").parameters, [(0, 0, 0), (0, 1, 0)], t_end=7, use_numba=False)
    >>> [axes.get_ylabel() for axes in plot.events_figure(events).axes]
    ['motion']
    """
    require(EventTable, events=events)
    with axes_for(ax, (5.0, 3.4), figsize=figsize) as (drawing, (axes,)):
        # Marks of more events are smaller: all together they cover about the same area, that of 200
        # marks in full size.
        scale = max(0.6 / 5, min(1.0, (200 / max(len(events), 1)) ** 0.5))
        for code, kind in KIND_NAMES.items():
            name, color = EVENT_MARKS[kind]
            shape, size = SHAPES[name]
            of_kind = events.kind_code == code
            if of_kind.any():
                style: Record = {
                    "ls": "",
                    "ms": max(size * scale, 0.6),
                    "color": color,
                    "label": name,
                }
                axes.plot(events.t[of_kind], events.trajectory[of_kind], shape, **style)
        axes.set(xlabel="time $t$", ylabel="motion", ylim=(-0.5, max(len(events.status), 1) - 0.5))
        axes.yaxis.set_major_locator(MaxNLocator(integer=True))
        if len(events) == 0:
            axes.text(0.5, 0.5, "no event", transform=axes.transAxes, ha="center")
        elif ax is None:
            drawing.legend(loc="outside upper center", ncols=4, frameon=False)
    return drawing


@public
def summary_figure(
    summary: Summary, name: str | None = None, *, ax: Axes | None = None, figsize: FigureSize = None
) -> Figure:
    """Draw the summary of many motions.

    Parameters
    ----------
    summary : Summary
        What ``simulate_many(…, record="summary")`` returns.
    name : str, optional
        The column to draw. "section": the points in the phase plane. A column of text or whole
        numbers: how often each value occurs. Any other column: a histogram of its values. Default:
        "word" if it was recorded, else "section", else the first column.

    Examples
    --------
    >>> from symosc import load_scene, plot, simulate_many
    >>> starts = [(0, 0, 0), (0, 1, 0)]
    >>> found = simulate_many(load_scene("fig9").parameters, starts, t_end=20, record="summary", use_numba=False)
    >>> [axes.get_xlabel() for axes in plot.summary_figure(found).axes]
    ['motions']
    """
    require(Summary, summary=summary)
    require_or_none(TEXT, name=name)
    columns = summary.columns()
    if name is None:
        name = next(
            (column for column in ("word", "section", *columns) if column in columns), "word"
        )
    if name not in columns:
        raise ParameterError(
            "name", name, f"must be a recorded column: {', '.join(columns) or 'none'}"
        )
    values = columns[name]
    with axes_for(ax, (4.6, 3.4), figsize=figsize) as (drawing, (axes,)):
        if name == "section":
            _scatter(axes, *values.reshape(-1, 2).T)
            axes.set(xlabel=COMPONENT_LABELS["x"], ylabel=COMPONENT_LABELS["v"])
        elif values.dtype.kind == "f":
            axes.hist(
                values[np.isfinite(values)],
                bins="auto",
                color="0.6",
                edgecolor="black",
                linewidth=0.5,
            )
            axes.set(xlabel=label(name), ylabel="motions")
        else:
            _bars(axes, values, name)
    return drawing


def _bars(axes: Axes, values: np.ndarray, name: str) -> None:
    """Draw how often each value occurs as bars, the most frequent on top, the rare ones together in
    one bar.
    """
    kinds, counts = np.unique(values, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    names = [typeset(str(kinds[i])) if name == "word" else str(kinds[i]) for i in order]
    sizes = counts[order].tolist()
    if len(names) > MOST_BARS:
        joined = len(names) - MOST_BARS + 1
        names = [*names[:-joined], f"{joined} others"]
        sizes = [*sizes[:-joined], sum(sizes[-joined:])]
    bars = axes.barh(range(len(names)), sizes, color="0.8", edgecolor="black", linewidth=0.5)
    axes.bar_label(bars, padding=2)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(max(len(names), 4) - 0.5, -0.5)  # downwards, and few bars are not made thick
    axes.margins(x=0.12)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel="motions", ylabel=label(name))


# -- atlases ---------------------------------------------------------------------------------------

#: Colours that differ in grey too, light enough for black lines on them; the last one is for all
#: further words.
ATLAS_COLORS = (*WORD_COLORS[:6], "#e0e0e0")


@public
def atlas_figure(atlas: Atlas, *, ax: Axes | None = None, figsize: FigureSize = None) -> Figure:
    """Draw an atlas: proven boxes in colours, what is not proven hatched, borders by kind, and
    special points.

    Examples
    --------
    >>> from symosc import atlas, plot
    >>> plane = atlas("fig9", {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, workers=1)
    >>> [axes.get_xlabel() for axes in plot.atlas_figure(plane).axes]
    ['$\\\\Omega$']
    """
    from symosc.certificates.atlas import Atlas

    require(Atlas, atlas=atlas)
    words = [region.word for region in atlas.regions if region.word]
    colours = {word: ATLAS_COLORS[min(i, len(ATLAS_COLORS) - 1)] for i, word in enumerate(words)}
    entries: dict[str, Any] = {}
    with axes_for(ax, (5.2, 3.8), figsize=figsize) as (drawing, (axes,)):
        for word, colour in colours.items():
            boxes = [corners(box.range) for box in atlas.boxes if box.word == word]
            axes.add_collection(
                PolyCollection(boxes, facecolors=colour, edgecolors=colour, linewidths=0.2)
            )
            if colour == ATLAS_COLORS[-1]:
                name = "other words"
            else:
                name = typeset(word)
            entries[name] = Patch(facecolor=colour, edgecolor="0.4", linewidth=0.4)
        if atlas.open:
            hatched: Record = {"facecolor": "white", "edgecolor": "0.6", "hatch": "//////"}
            axes.add_collection(
                PolyCollection([corners(box) for box in atlas.open], linewidths=0, **hatched)
            )
            entries["not proven"] = Patch(linewidth=0.4, **hatched)
        # An atlas without proven boxes shows the words that were simulated on its grid.
        for word, colour in () if atlas.boxes else colours.items():
            points = np.array([(x, y) for x, y, grid_word in atlas.grid if grid_word == word])
            if len(points):
                axes.plot(
                    *points.T,
                    "s",
                    color=colour,
                    markeredgecolor="0.4",
                    markeredgewidth=0.3,
                    markersize=5,
                )
        for border in atlas.borders:
            line = BORDER_STYLES.get(border.sliding, {"linestyle": (0, (1, 3))})["linestyle"]
            (drawn,) = axes.plot(*border.points.T, linestyle=line, color="black", linewidth=0.9)
            entries.setdefault(border.sliding or border.kind, drawn)
        for i, point in enumerate(atlas.special, 1):
            axes.plot(*point.values, "o", color="black", markersize=3)
            if point.kind == "fold":
                name = "fold"
            else:
                name = f"C{i}"
            axes.annotate(name, point.values, xytext=(3, 3), textcoords="offset points", fontsize=7)
        xlim, ylim = ([float(end) for end in side] for side in atlas.range)
        x_name, y_name = atlas.over
        axes.set(
            xlabel=PARAMETER_LABELS[x_name],
            ylabel=PARAMETER_LABELS[y_name],
            xlim=xlim,
            ylim=ylim,
        )
        add_legend(drawing, ax, entries, 3)
    return drawing


def corners(box: Rectangle) -> list[tuple[float, float]]:
    """Return the four corners of a rectangle, counterclockwise from the lower left."""
    (a, b), (c, d) = ((float(low), float(high)) for low, high in box)
    return [(a, c), (b, c), (b, d), (a, d)]
