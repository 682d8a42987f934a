"""The figure that fits the result of a sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.arguments import public
from symosc.plot.bifurcation import bifurcation_figure, curve_figure
from symosc.plot.columns import axes_of, read_column
from symosc.plot.maps import basin_figure, map_figure

if TYPE_CHECKING:
    import xarray

    from symosc.sweeps.output import SweptDataset


@public
def swept_figure(dataset: xarray.Dataset | SweptDataset, name: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw the result of a sweep, in the form that fits it.

    A section over one axis is a bifurcation diagram, anything else over one axis a curve; two axes make a map, and a
    basin if they are starts x0 and v0.

    Parameters
    ----------
    dataset : xarray.Dataset
        What `symosc.sweep` returns, or a selection of it such as ``dataset.isel(k=0)``; it is drawn by
        ``dataset.symosc.plot()`` too.
    name : str, optional
        The column. Default: the section if there is one, else the first that was recorded.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If `dataset` is no result of a sweep, has no such column, or has more axes than a figure.

    Examples
    --------
    >>> from symosc import plot, sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3", "FN": "5:10:2"}, t_end="12T", skip="10T")
    >>> [axes.get_xlabel() for axes in plot.swept_figure(found).axes]
    ['$\\\\Omega$']
    """
    from symosc.sweeps.output import SweptDataset

    if isinstance(dataset, SweptDataset):
        return swept_figure(dataset.dataset, name, ax=ax)
    column = read_column(dataset, name)
    axes = axes_of(column)
    if column.name == "section":
        return bifurcation_figure(dataset, ax=ax)
    if len(axes) == 1:
        return curve_figure(dataset, column.name, ax=ax)
    return (basin_figure if set(axes) == {"x0", "v0"} else map_figure)(dataset, column.name, ax=ax)
