"""The figure of a friction law: the force over the velocity, as in Fig. 2 of the paper."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import nan
from typing import Any

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from symosc.base.aliases import NumberLike, Record
from symosc.base.arguments import NUMBER, public, require_or_none, row_of
from symosc.base.errors import ParameterError
from symosc.base.quantities import read_number
from symosc.model import Band, Oscillator, Parameters
from symosc.plot import drawing as common
from symosc.plot.drawing import FigureSize, axes_for
from symosc.plot.panels import AXIS_LABELS, MASS_COLOR, ONSET_COLOR
from symosc.scenes import ParametersLike, model_of

#: How far the figure reaches beyond the edges, as a part of their distance.
BEYOND = 0.35
CORNER_COLOR = "0.8"
#: More corners, as those of a law from a function, would hide it.
MOST_CORNERS = 24
#: Half the width of the bars at the static limits, as a part of the figure's width.
HALF_BAR = 0.012


@public
def friction_figure(
    p: ParametersLike,
    *,
    v: tuple[NumberLike, NumberLike] | None = None,
    ax: Axes | None = None,
    figsize: FigureSize = None,
    **style: Any,
) -> Figure:
    """Draw the friction force over the velocity of the mass.

    At the speed of a belt the force is an interval, in which the mass sticks. Static friction that
    exceeds the kinetic one makes it longer; bars mark its ends. Corners, where the slope of the
    friction changes, are thin lines, unless there are dozens.

    Parameters
    ----------
    p : Parameters, Oscillator, Scene, or the name or file of one
    v : pair of numbers, optional
        The velocities to show. None: all edges of the law, and a third of their distance beyond.
    ax, **style : optional
        As for `symosc.plot.figure`; a style is that of kinetic friction.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from symosc import Belt, Oscillator, plot
    >>> law = Oscillator(m=1, c=0, k=1, belts=[Belt(1, curve=[(0, 0.4), (0.5, 0.25)], mu_s=0.6)])
    >>> drawing = plot.friction_figure(law)
    >>> drawing.axes[0].get_ylabel()
    'friction force $F_f$'
    """
    oscillator = _with_bands(model_of(p))
    low, high = _range(oscillator, v)
    line_style = common.read_style(style, friction_figure)
    with axes_for(ax, (3.8, 2.8), figsize=figsize) as (drawing, (axes,)):
        axes.axhline(0.0, color="0.4", lw=0.6, zorder=1)
        speeds, forces = _kinetic(oscillator, low, high)
        look: Record = {"color": MASS_COLOR, "linewidth": 1.6, "label": "slips: one value"}
        axes.plot(speeds, forces, **{"zorder": 3} | look | line_style)
        _draw_edges(axes, oscillator, low, high)
        axes.set(xlim=(low, high), xlabel=AXIS_LABELS["v"], ylabel="friction force $F_f$")
        axes.margins(y=0.12)
        common.add_legend(drawing, ax, [axes], 2)
    return drawing


def _with_bands(model: Any) -> Any:
    """Return the oscillator of a model."""
    if isinstance(model, Parameters):
        return model.oscillator
    return model


def _range(oscillator: Oscillator, v: Any) -> tuple[float, float]:
    """Return the velocities to show."""
    require_or_none(row_of(2, NUMBER), v=v)
    if v is not None:
        low, high = (float(read_number("v", end)[0]) for end in v)
        if low >= high:
            raise ParameterError("v", v, "must be a pair of increasing velocities")
        return low, high
    speeds = [float(edge.v) for edge in oscillator.law.edges]
    reach = BEYOND * (speeds[-1] - speeds[0]) or abs(speeds[0]) or 1.0
    return speeds[0] - reach, speeds[-1] + reach


def _resistance(oscillator: Oscillator, band: Band, v: float) -> float:
    """Return the friction force F_f against the motion at a velocity of a band."""
    return float(oscillator.A0 - band.A) + float(band.c - oscillator.c) * v


def _kinetic(oscillator: Oscillator, low: float, high: float) -> tuple[list[float], list[float]]:
    """Return velocities and friction forces for a line, which is interrupted at belts."""
    speeds = list[float]()
    forces = list[float]()
    for band in oscillator.bands:
        begin = low if band.below is None else max(low, float(band.below))
        end = high if band.above is None else min(high, float(band.above))
        if begin <= end:
            speeds += [begin, end]
            forces += [_resistance(oscillator, band, begin), _resistance(oscillator, band, end)]
        if band.above is not None and oscillator.law.boundary_of(band.above):
            speeds.append(nan)
            forces.append(nan)
    return speeds, forces


def _draw_edges(axes: Axes, oscillator: Oscillator, low: float, high: float) -> None:
    """Draw what is at the edges of the law between two velocities: sticks, static limits, corners."""
    half = HALF_BAR * (high - low)
    sticks = list[Sequence[tuple[float, float]]]()
    excess = list[Sequence[tuple[float, float]]]()
    corners = list[float]()
    for edge, (below, above) in zip(oscillator.edges, pairwise(oscillator.bands), strict=True):
        v = float(edge.v)
        if not low <= v <= high:
            continue
        if not edge.belts:
            corners.append(v)
            continue
        ends = _resistance(oscillator, below, v), _resistance(oscillator, above, v)
        sticks.append([(v, ends[0]), (v, ends[1])])
        common.write_above(axes, v, f"$v_{edge.belts[0]}$")
        axes.axvline(v, color="0.4", lw=0.6, ls=":", zorder=1)
        if edge.E:
            for end, side in zip(ends, (-1, 1), strict=True):
                limit = end + side * float(edge.E)
                excess.append([(v, end), (v, limit)])
                excess.append([(v - half, limit), (v + half, limit)])
    if len(corners) > MOST_CORNERS:
        corners = []
    for corner in corners:
        axes.axvline(corner, color=CORNER_COLOR, lw=0.5, zorder=0)
    _draw_lines(axes, sticks, color=ONSET_COLOR, linewidth=2.4, label="sticks: any value")
    _draw_lines(axes, excess, color=ONSET_COLOR, linewidth=1.0, label="static friction")


def _draw_lines(axes: Axes, lines: list[Sequence[tuple[float, float]]], **look: Any) -> None:
    """Draw lines with one entry in the legend, if there are any."""
    if lines:
        axes.add_collection(LineCollection(lines, zorder=4, **look))
