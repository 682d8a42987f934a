"""Figures of sweeps over one axis: bifurcation diagrams, and curves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.arguments import public
from symosc.plot.columns import label, read_axes, read_column, typeset
from symosc.plot.drawing import one_axes, style_for

if TYPE_CHECKING:
    import xarray

COMPONENT_LABELS = {"x": "displacement $x$ at whole periods", "v": "velocity $\\dot{x}$ at whole periods"}
# Points shrink down to this size (points squared) when there are many.
LARGEST_POINT, LEAST_POINT, ROOMY_POINTS = 6.0, 0.3, 500


@public
def bifurcation_figure(
    dataset: xarray.Dataset, component: Literal["x", "v"] = "x", *, ax: Axes | None = None
) -> Figure:
    """Draw the stroboscopic section against a parameter: a point for each recorded period.

    Parameters
    ----------
    dataset : xarray.Dataset
        What `symosc.sweep` returns for ``record="section"`` over one axis; several starts lie over each other.
    component : {"x", "v"}
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
    >>> found = sweep("fig9", {"Omega": "3:5:3"}, record="section:2", t_end="12T")
    >>> [axes.get_ylabel() for axes in plot.bifurcation_figure(found).axes]
    ['displacement $x$ at whole periods']
    """
    section = read_column(dataset, "section").sel(component=component)
    one = section.isel(start=0) if "start" in section.dims else section
    (name,) = read_axes(one, 1, "a bifurcation diagram")
    points = section.transpose(name, ...).values.reshape(section.sizes[name], -1)
    values = np.repeat(section[name].values, points.shape[1])
    size = max(LARGEST_POINT * min(1.0, ROOMY_POINTS / points.size), LEAST_POINT)
    with style_for(ax):
        drawing, axes = one_axes(ax, (5.0, 3.4))
        axes.scatter(values, points.ravel(), s=size, color="black", linewidths=0, rasterized=True)
        axes.set(xlabel=label(name), ylabel=COMPONENT_LABELS[component])
        _span(axes, section[name].values)
    return drawing


@public
def curve_figure(dataset: xarray.Dataset, name: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a column against one parameter: numbers as a curve, words as levels.

    Parameters
    ----------
    dataset : xarray.Dataset
        What `symosc.sweep` returns over one axis.
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
    >>> found = sweep("fig9", {"Omega": "3:5:3"}, record="events", t_end="12T")
    >>> [axes.get_ylabel() for axes in plot.curve_figure(found).axes]
    ['events']
    """
    column = read_column(dataset, name)
    (axis,) = read_axes(column, 1, "a curve")
    column = column.sortby(axis)
    values, shown = column[axis].values, column.values
    with style_for(ax):
        drawing, axes = one_axes(ax, (5.0, 3.4))
        if shown.dtype.kind in "UO":
            words, levels = np.unique(shown.astype(str), return_inverse=True)
            axes.plot(values, levels, linestyle="none", marker="o", ms=2.5, color="black")
            axes.set_yticks(range(len(words)), [typeset(word) for word in words])
        else:
            axes.plot(values, shown, color="black", lw=0.8, drawstyle="steps-mid" if shown.dtype.kind in "iu" else None)
        axes.set(xlabel=label(axis), ylabel=label(str(column.name)))
        _span(axes, values)
    return drawing


def _span(axes: Axes, values: Any) -> None:
    if values.min() < values.max():
        axes.set_xlim(values.min(), values.max())
