"""Figs. 5 to 10 in the paper's form: its panels in its order, its colours, and dots where its text puts them.

Belts are black and the mass is red. Blue circles and green squares are onset and end of a stick (in Fig. 7 of the first
period), red triangles switching points, red stars contacts.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.paper.views import (
    first_period_view,
    grazing_view,
    largest_velocity,
    motion_view,
    orbit_view,
    period,
    printed_scene,
    several_periods_view,
    start_time,
    stick_close_up,
    stick_view,
)
from symosc.plot.figures import assemble
from symosc.plot.panels import BELT_COLOR, END_COLOR, MASS_COLOR, PANELS, Panel, View, mark_style
from symosc.scenes import load_scene

# In inches, by the number of columns: two for a page, one for a phone, where a point of it is 1.5 pixels.
WIDTHS = {2: 5.2, 1: 3.4}
# A printed start that is nearer to the orbit than this fraction of the axis is magnified in an inset.
NEAR_DOT = 0.02
# Where that inset is (fractions of the axes), and room for texts and marks beyond the curves (of the axis).
INSIDE_ORBIT = 0.33, 0.39, 0.42, 0.2
GAP_ROOM, START_ROOM = 0.15, 0.06
START_STYLE: dict[str, Any] = {"mfc": "white", "mec": "black", "mew": 0.8, "ms": 4.2, "zorder": 7, "clip_on": False}


def stick_figure(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 5 or 6: (a) displacement, (b) velocity, (c) phase plane, (d) forces."""
    view = stick_view(name)
    return _paper_form([(PANELS[letter], view) for letter in "abcd"], columns)


def grazing_figure_P2(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 7: (a) displacement and (b) velocity in the first period, (c) velocity later on, (d) phase plane."""
    first, several = first_period_view(name), several_periods_view(name)
    periods = partial(_velocity_of_periods, start=start_time(name), period=period(name))
    panels: list[tuple[Panel, View]] = [
        (PANELS["a"], first),
        (_velocity_and_gap, first),
        (periods, several),
        (PANELS["c"], several),
    ]
    return _paper_form(panels, columns, tall=1 if first.magnified else None)


def grazing_figure_P3(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 8: (a) displacement, (b) velocity, (c) velocity near the stick, (d) phase plane."""
    view = grazing_view(name)
    panels = [(PANELS["a"], view), (PANELS["b"], view), (PANELS["b"], stick_close_up(name)), (PANELS["c"], view)]
    return _paper_form(panels, columns, tall=1)


def motion_figure(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 9 or 10 from the printed start: as Fig. 5, then (e), (f) forces against displacement and velocity."""
    view = motion_view(name)
    return _paper_form([(PANELS[letter], view) for letter in "abcdef"], columns)


def orbit_figure(name: str, columns: int = 2) -> Figure:
    """Draw one period of the periodic orbit in the form of Figs. 9 and 10, with the printed start beside it."""
    view, scene = orbit_view(name), load_scene(printed_scene(name))
    t, x, v = (float(value) for value in (scene.t0, scene.x0, scene.v0))
    panels: dict[str, Panel] = {letter: PANELS[letter] for letter in "abcdef"}
    for letter, start in (("a", (t, x)), ("b", (t, v))):
        panels[letter] = partial(_with_start, panel=PANELS[letter], start=start)
    panels["c"] = partial(_phase_plane_with_start, start=(x, v))
    return _paper_form([(panel, view) for panel in panels.values()], columns)


def product_figure(columns: int = 2) -> Figure:
    """Draw the products of forces that section 6 speaks of: Figs. 5, 6, 9 and 10."""
    views = [stick_view("fig5"), stick_view("fig6"), motion_view("fig9"), motion_view("fig10")]
    return _paper_form([(PANELS["g"], view) for view in views], columns)


def _paper_form(panels: list[tuple[Panel, View]], columns: int, tall: int | None = None) -> Figure:
    return assemble(panels, columns, WIDTHS[columns], tall=tall)


# --- panels that only the paper has ---


def _velocity_and_gap(ax: Axes, view: View) -> None:
    """Panel (b); if the mass never reaches a belt, with a bar over the gap that remains."""
    PANELS["b"](ax, view)
    if view.trajectory.events:
        return
    (t, v), speed = largest_velocity(view), float(view.trajectory.parameters.belt(view.boundary))
    bar = {"arrowstyle": "|-|, widthA=0.2, widthB=0.2", "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (t, speed), (t, v), arrowprops=bar)
    ax.annotate(f"gap {speed - v:.2f}", (t, speed), (0, 3), textcoords="offset points", ha="center", fontsize=8)
    low, high = ax.get_ylim()
    ax.set_ylim(low, max(high, speed + GAP_ROOM * (speed - low)))


def _velocity_of_periods(ax: Axes, view: View, start: float, period: float) -> None:
    """Panel (c) of Fig. 7: the velocity for several periods, with a dotted line at the beginning of each."""
    _velocity_and_gap(ax, view)
    for time in np.arange(start, view.t[-1] + period / 2, period):
        ax.axvline(time, color="0.6", lw=0.6, ls=(0, (1, 2)), zorder=0)


def _with_start(ax: Axes, view: View, panel: Panel, start: tuple[float, float]) -> None:
    """Any panel, with the printed start as a diamond."""
    panel(ax, view)
    low, high = ax.get_ylim()
    room = START_ROOM * (high - low)
    ax.set_ylim(min(low, start[1] - room), max(high, start[1] + room))
    ax.plot(*start, "D", label="printed start", **START_STYLE)


def _phase_plane_with_start(ax: Axes, view: View, start: tuple[float, float]) -> None:
    """Panel (c) with the printed start, and an inset inside the orbit if they cannot be told apart."""
    _with_start(ax, view, PANELS["c"], start)
    crossing = min(view.trajectory.events, key=lambda event: abs(float(event.x) - start[0]))
    distance = abs(float(crossing.x) - start[0])
    if distance > NEAR_DOT * np.ptp(view.x):
        return
    inset = ax.inset_axes(INSIDE_ORBIT)
    inset.plot(view.x, view.v, color=MASS_COLOR, lw=1.3)
    inset.axhline(float(crossing.v), color=BELT_COLOR, lw=0.6)
    inset.plot(float(crossing.x), float(crossing.v), linestyle="none", **mark_style("end of stick", END_COLOR))
    inset.plot(*start, "D", **START_STYLE)
    inset.set_xlim(start[0] - 3 * distance, start[0] + 2 * distance)
    inset.set_ylim(start[1] - 40 * distance, start[1] + 20 * distance)
    inset.tick_params(labelsize=7, labelfontfamily="STIXGeneral", pad=2)
    inset.set_yticks([start[1]])
    ax.indicate_inset_zoom(inset, edgecolor="0.6", lw=0.5)
