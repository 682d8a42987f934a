"""Figures of attractors and their basins, of section maps, and of bifurcations.

Classes differ in lightness, attractors in their marks, so that all can be read in grey.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from symosc.base.aliases import NumberLike, Record
from symosc.base.arguments import NUMBER, public, require, require_or_none
from symosc.base.exact import read_exact
from symosc.basins.attractors import Attractors
from symosc.basins.kinds import ObservedCycle, Rest
from symosc.basins.return_map import ReturnMap
from symosc.model import Model
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.orbits.unsettled import Chaotic, QuasiPeriodic
from symosc.plot.drawing import FigureSize, add_legend, axes_for, draw_belts
from symosc.plot.sweeps import (
    MOST_CLASSES,
    UNDECIDED_COLOR,
    WORD_COLORS,
    borders,
    cell_edges,
    label,
)
from symosc.simulation.simulate import simulate

#: Cells of a map, at most, around whose classes lines are drawn: between more they cover it.
MOST_OUTLINED = 12_000
#: Points of a drawn cycle.
CYCLE_POINTS = 2_000
#: How much wider than a black line is the white one below it, so that it is seen on any colour.
HALO = 1.4
MARKS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")
#: Attractors that have their own look; further ones share the last one.
MOST_SHOWN = MOST_CLASSES


@public
def attractors_figure(
    found: Attractors, *, ax: Axes | None = None, figsize: FigureSize = None
) -> Figure:
    """Draw the basins of attractors over a grid of starts or, without a grid, their shares.

    Over x0 and v0 the attractors are drawn in: rests and the states of orbits at the phase of the
    starts as marks, limit cycles as closed lines, chaos and tori as clouds of points.

    Parameters
    ----------
    found : Attractors
    ax, figsize : optional
        As for `symosc.plot.figure`.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, attractors, plot
    >>> law = Oscillator(m=1, c="0.1", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
    >>> found = attractors(law, {"x0": "-2:2:9", "v0": "-1:1:5"})
    >>> [axes.get_ylabel() for axes in plot.attractors_figure(found).axes]
    ['$v_0$']
    """
    require(Attractors, found=found)
    if not found.axes or min(map(len, found.axes.values())) < 2:
        return _shares(found, ax, figsize)
    return _basins(found, ax, figsize)


def _shares(found: Attractors, ax: Axes | None, figsize: FigureSize) -> Figure:
    """Draw the shares of attractors as bars with their errors."""
    names = list(found.names)
    shares = found.share.tolist()
    errors = found.share_error.tolist()
    if found.undecided:
        names.append("undecided")
        shares.append(found.undecided)
        errors.append(0.0)
    with axes_for(ax, (4.6, 1.2 + 0.32 * len(names)), figsize=figsize) as (drawing, (axes,)):
        style: Record = {"color": "0.8", "edgecolor": "black", "linewidth": 0.5}
        axes.barh(range(len(names)), shares, xerr=errors, capsize=2.5, **style)
        axes.set_yticks(range(len(names)), names)
        axes.set_ylim(len(names) - 0.4, -0.6)
        axes.set_xlim(0, min(1.0, 1.12 * max(shares) + max(errors)) + 0.001)
        axes.set(xlabel=f"share of {len(found.starts):,} starts")
    return drawing


def colours_of(count: int) -> np.ndarray:
    """Return so many colours, from light to dark."""
    spread = np.linspace(0, len(WORD_COLORS) - 3, max(count, 2)).round().astype(int)
    colours: np.ndarray = to_rgba_array([WORD_COLORS[i] for i in spread])[:count]
    return colours


def _basins(found: Attractors, ax: Axes | None, figsize: FigureSize) -> Figure:
    """Draw basins over a grid."""
    # x0 goes across, or what comes first of t0, x0, v0.
    across, up = sorted(found.axes, key=("t0", "x0", "v0").index)
    basin = found.basin
    if tuple(found.axes) != (across, up):
        basin = basin.T
    x_order = np.argsort(found.axes[across], kind="stable")
    y_order = np.argsort(found.axes[up], kind="stable")
    basin = np.minimum(basin[x_order][:, y_order], MOST_SHOWN - 1)
    x = cell_edges(found.axes[across][x_order])
    y = cell_edges(found.axes[up][y_order])
    shown = min(len(found), MOST_SHOWN)
    colours = colours_of(shown)
    codes = np.where(basin < 0, shown, basin)
    palette = ListedColormap([*colours, UNDECIDED_COLOR])
    handles = list[Any]()
    with axes_for(ax, (5.4, 3.6), figsize=figsize) as (drawing, (axes,)):
        axes.pcolormesh(x, y, codes.T, cmap=palette, vmin=-0.5, vmax=shown + 0.5, rasterized=True)
        lines = borders(x, y, codes)
        if len(lines) <= MOST_OUTLINED:
            axes.add_collection(LineCollection(lines, colors="black", linewidths=0.5))
        axes.set(xlabel=label(across), ylabel=label(up), xlim=x[[0, -1]], ylim=y[[0, -1]])
        if up == "v0":
            speeds = [belt.v for belt in found.parameters.law.belts]
            draw_belts(axes, speeds, *axes.get_ylim())
        frame: Record = {"edgecolor": "black", "linewidth": 0.5}
        in_plane = (across, up) == ("x0", "v0")
        for n, (name, orbit) in enumerate(zip(found.names, found.orbits, strict=True)):
            if n == MOST_SHOWN - 1 and len(found) > MOST_SHOWN:
                name = f"{len(found) - n} others"
            if n >= MOST_SHOWN:
                break
            text = f"{name}: {_share_text(found.share[n])}"
            handles.append(Patch(facecolor=colours[n], label=f"leads to {text}", **frame))
            if in_plane:
                handles += _draw_attractor(axes, found, orbit, name, MARKS[n % len(MARKS)])
        if found.undecided:
            text = f"undecided: {_share_text(found.undecided)}"
            handles.append(Patch(facecolor=UNDECIDED_COLOR, label=text, **frame))
        look: Record = {"frameon": False, "handlelength": 1.6, "handleheight": 1.0}
        if ax is None:
            drawing.legend(handles=handles, loc="outside right upper", **look)
        else:
            axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1, 1), **look)
    return drawing


def _share_text(share: float) -> str:
    """Return a share as text, in percent."""
    return f"{100 * share:.3g} %"


def _draw_attractor(
    axes: Axes, found: Attractors, orbit: Any, name: str, mark: str
) -> list[Line2D]:
    """Draw an attractor into the phase plane; return its entry of the legend, if it is seen there."""
    point: Record = {"linestyle": "none", "color": "black", "markeredgecolor": "white"}
    if isinstance(orbit, Rest):
        x, v = np.array([orbit.low, orbit.high]), np.zeros(2)
        if orbit.high > orbit.low:
            style: Record = {"linewidth": 2.6, "solid_capstyle": "butt"}
        else:
            style = point | {"marker": "o", "ms": 5.5}
    elif isinstance(orbit, Chaotic | QuasiPeriodic):
        if not _same_phase(found):
            return []
        x, v = orbit.points.T
        style = point | {"marker": ".", "ms": 2.6, "markeredgewidth": 0}
    elif orbit.periods:
        if not _same_phase(found):
            return []
        x, v = section_points(orbit)
        style = point | {"marker": mark, "ms": 5.5}
    else:
        x, v = _whole_cycle(orbit, found.parameters)
        style = {"linewidth": 1.1}
    (low, high), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    if not ((low <= x) & (x <= high) & (bottom <= v) & (v <= top)).any():
        return []
    if "linewidth" in style:
        axes.plot(
            x, v, color="white", linewidth=style["linewidth"] + HALO, scalex=False, scaley=False
        )
    common: Record = {"color": "black", "scalex": False, "scaley": False}
    (line,) = axes.plot(x, v, **(common | style))
    line.set_label(name)
    return [line]


def _same_phase(found: Attractors) -> bool:
    """Return whether the starts are at the ends of forcing periods, as the states that are drawn."""
    return bool((found.starts[:, 0] == 0.0).all())


def section_points(orbit: PeriodicOrbit | ObservedCycle) -> tuple[np.ndarray, np.ndarray]:
    """Return x and v of an orbit at the ends of forcing periods."""
    if isinstance(orbit, ObservedCycle):
        return orbit.points[:, 0], orbit.points[:, 1]
    period = float(orbit.period) / orbit.periods
    x, v = orbit(period * np.arange(orbit.periods))
    return x, v


def _whole_cycle(
    orbit: PeriodicOrbit | ObservedCycle, parameters: Model
) -> tuple[np.ndarray, np.ndarray]:
    """Return x and v along a limit cycle."""
    times = np.linspace(0.0, float(orbit.period), CYCLE_POINTS)
    if isinstance(orbit, PeriodicOrbit):
        x, v = orbit(times)
    else:
        ((x0, v0),) = orbit.points.tolist()
        x, v = simulate(parameters, x0=x0, v0=v0, t_end=times[-1])(times)
    return x, v


# -- section maps ----------------------------------------------------------------------------------

#: Images of a start that a cobweb leaves out, and those that it shows.
COBWEB_SKIP = 60
COBWEB_STEPS = 60
PHASE_TICKS = (
    [0, pi / 2, pi, 3 * pi / 2, 2 * pi],
    ["0", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"],
)


@public
def return_map_figure(
    found: ReturnMap,
    start: NumberLike | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw a section map with the diagonal, its fixed points, and a cobweb.

    Parameters
    ----------
    found : ReturnMap
    start : number, optional
        Where the cobweb begins, of 60 steps; with a drive 60 more are left out before. Default: the
        middle of the range.
    ax, figsize : optional
        As for `symosc.plot.figure`.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, plot, return_map
    >>> law = Oscillator(m=1, c="0.1", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
    >>> [axes.get_xlabel() for axes in plot.return_map_figure(return_map(law, points=33)).axes]
    ['$x$ where $\\\\dot{x}$ falls through 0']
    """
    require(ReturnMap, found=found)
    require_or_none(NUMBER, start=start)
    low, high = float(found.at.min()), float(found.at.max())
    if found.belt and high - low > 0.95 * 2 * pi:
        high = low + 2 * pi
    if start is None:
        begin = float(found.at[len(found.at) // 2])
    else:
        begin = float(read_exact("start", start))
    with axes_for(ax, (4.2, 3.9), figsize=figsize) as (drawing, (axes,)):
        axes.plot([low, high], [low, high], color="0.55", lw=0.8, ls=(0, (4, 2)), label="diagonal")
        skip = COBWEB_SKIP if found.belt else 0
        web = found.orbit(begin, skip + COBWEB_STEPS)[skip:]
        if len(web) > 1:
            across = np.repeat(web, 2)[:-1]
            up = np.repeat(web, 2)[1:]
            axes.plot(across, up, color="#1776b4", lw=0.6, label="cobweb", zorder=1.5)
        x, y = _broken(found)
        axes.plot(x, y, color="black", lw=1.3, label="map", zorder=2.5)
        for stable, face, name in ((True, "black", "stable"), (False, "white", "unstable")):
            places = [point.at for point in found.fixed_points() if point.stable == stable]
            if places:
                style: Record = {"linestyle": "none", "marker": "o", "ms": 5, "zorder": 3}
                style |= {"markeredgecolor": "black", "markerfacecolor": face}
                axes.plot(places, places, label=f"{name} fixed point", **style)
        if found.belt:
            axes.set(xlabel=r"phase $\theta$ of a slip", ylabel="phase of the next slip")
            if high - low > pi:
                for axis in (axes.xaxis, axes.yaxis):
                    axis.set_ticks(*PHASE_TICKS)
            axes.set(xlim=(low, high), ylim=(low, high) if high - low > pi else None)
        else:
            text = r"$x$ where $\dot{x}$ falls through 0"
            axes.set(xlabel=text, ylabel="the next one", xlim=(low, high))
        add_legend(drawing, ax, [axes], 2)
    return drawing


def _broken(found: ReturnMap) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a map, with gaps where it jumps or passes the end of the phases."""
    x, y = found.at, found.after
    gaps = np.searchsorted(x, [jump.at for jump in found.jumps])
    if found.belt:
        wraps = np.flatnonzero(np.abs(np.diff(y)) > pi) + 1
        gaps = np.union1d(gaps, wraps)
    return np.insert(x, gaps, np.nan), np.insert(y, gaps, np.nan)
