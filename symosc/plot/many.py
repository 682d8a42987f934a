"""Figures of many motions at once: their events, and their summaries."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from symosc.arguments import public
from symosc.engine.events import KIND_NAMES
from symosc.errors import ParameterError
from symosc.plot.bifurcation import COMPONENT_LABELS
from symosc.plot.columns import label, typeset
from symosc.plot.drawing import one_axes, style_for
from symosc.plot.panels import EVENT_MARKS, SHAPES
from symosc.simulation.tables import EventTable, Summary

#: Marks shrink where there are more than this; values of a column that have a bar of their own, and room for how many.
ROOMY_MARKS, MOST_BARS, LEAST_BARS = 200, 12, 4
LEAST_MARK = 0.6


@public
def events_figure(events: EventTable, *, ax: Axes | None = None) -> Figure:
    """Draw when which motion has which event: time across, a line of marks for each motion.

    Parameters
    ----------
    events : EventTable
        What `symosc.simulate_many` returns.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If `events` is no EventTable, or `ax` are no axes.

    Examples
    --------
    >>> from symosc import load_scene, plot, simulate_many
    >>> events = simulate_many(load_scene("fig5").parameters, [(0, 0, 0), (0, 1, 0)], t_end=7, use_numba=False)
    >>> [axes.get_ylabel() for axes in plot.events_figure(events).axes]
    ['motion']
    """
    with style_for(ax):
        drawing, axes = one_axes(ax, (5.0, 3.4))
        scale = max(LEAST_MARK / 5, min(1.0, (ROOMY_MARKS / max(len(events), 1)) ** 0.5))
        for code, kind in KIND_NAMES.items():
            name, color = EVENT_MARKS[kind]
            shape, size = SHAPES[name]
            here = events.kind_code == code
            if here.any():
                look = {"ls": "", "ms": max(size * scale, LEAST_MARK), "color": color, "label": name}
                axes.plot(events.t[here], events.trajectory[here], shape, **look)
        axes.set(xlabel="time $t$", ylabel="motion")
        axes.yaxis.set_major_locator(MaxNLocator(integer=True))
        axes.set_ylim(-0.5, max(len(events.status), 1) - 0.5)
        if len(events) == 0:
            axes.text(0.5, 0.5, "no event", transform=axes.transAxes, ha="center")
        elif ax is None:
            drawing.legend(loc="outside upper center", ncols=4, frameon=False)
    return drawing


@public
def summary_figure(summary: Summary, name: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw what became of many motions.

    Parameters
    ----------
    summary : Summary
        What ``simulate_many(…, record="summary")`` returns.
    name : str, optional
        The column. "section" draws the points in the phase plane, a column of text or whole numbers how often each
        value is there, another one how its values are spread. Default: the first of word, section and the others that
        is there.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If `summary` is no Summary, has no such column, or `ax` are no axes.

    Examples
    --------
    >>> from symosc import load_scene, plot, simulate_many
    >>> starts = [(0, 0, 0), (0, 1, 0)]
    >>> found = simulate_many(load_scene("fig9").parameters, starts, t_end=20, record="summary", use_numba=False)
    >>> [axes.get_xlabel() for axes in plot.summary_figure(found).axes]
    ['motions']
    """
    columns = summary.columns()
    if name is None:
        name = next((each for each in ("word", "section", *columns) if each in columns), "word")
    if name not in columns:
        raise ParameterError("name", name, f"is not recorded here; there is {', '.join(columns) or 'nothing'}")
    values = columns[name]
    with style_for(ax):
        drawing, axes = one_axes(ax, (4.6, 3.4))
        if name == "section":
            _section(axes, values)
        elif values.dtype.kind == "f":
            axes.hist(values[np.isfinite(values)], bins="auto", color="0.6", edgecolor="black", linewidth=0.5)
            axes.set(xlabel=label(name), ylabel="motions")
        else:
            _bars(axes, values, name)
    return drawing


def _section(axes: Axes, section: np.ndarray) -> None:
    points = section.reshape(-1, 2)
    size = max(6.0 * min(1.0, 500 / max(len(points), 1)), 0.3)
    axes.scatter(points[:, 0], points[:, 1], s=size, color="black", linewidths=0, rasterized=True)
    axes.set(xlabel=COMPONENT_LABELS["x"], ylabel=COMPONENT_LABELS["v"])


def _bars(axes: Axes, values: np.ndarray, name: str) -> None:
    """Draw how often each value is there, the most frequent on top; rare ones as one bar."""
    kinds, counts = np.unique(values, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    names = [typeset(str(kinds[i])) if name == "word" else str(kinds[i]) for i in order]
    sizes = counts[order].tolist()
    if len(names) > MOST_BARS:
        rest = len(names) - MOST_BARS + 1
        names, sizes = [*names[:-rest], f"{rest} others"], [*sizes[:-rest], sum(sizes[-rest:])]
    bars = axes.barh(range(len(names)), sizes, color="0.8", edgecolor="black", linewidth=0.5)
    axes.bar_label(bars, padding=2)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(max(len(names), LEAST_BARS) - 0.5, -0.5)
    axes.margins(x=0.12)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel="motions", ylabel=label(name))
