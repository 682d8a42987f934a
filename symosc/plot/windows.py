"""Figures of grazing windows: on the phase circle, and with the contact curve x_m(theta).

A full dot belongs to the window, an open dot does not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, pi, sin
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.arguments import public
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.grazing.window import GrazingWindow
from symosc.kernels.double_double import HALF_PI, THREE_HALVES_PI
from symosc.mappings.theorem7_cases import (
    EVERYTHING,
)
from symosc.plot.drawing import Drawing, figure_of, read_panels, style_for

INSIDE_COLOR, SHADE_COLOR, OUTSIDE_COLOR, CRITICAL_COLOR = "#1f3fd6", "#cfd6f6", "0.72", "#d7191c"
TURN = 2 * pi
PHASE_TICKS = ["$0$", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"]
CIRCLE_POINTS = 1441


@public
def window_figure(
    windows: GrazingWindow | Sequence[GrazingWindow],
    plane: Callable[[Axes, GrazingWindow], None] | None = None,
    *,
    panels: str | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Draw windows, one row each.

    Left: the circle of phases with the window, its ends and Theta_cr; the horizontal line is sin theta =
    -k v_lambda/(B0 Omega), which the phases of the window are above (P2, P5 with B0 > 0) or below. Right: the place
    x_m(theta) of the contact, over the window and (thin) over the other phases.

    Parameters
    ----------
    windows : GrazingWindow or sequence of them
    plane : callable, optional
        Draws the grazing curve of a window on the switching plane, into axes of a third column.
    panels : str, optional
        Letters of the panels: a circle, b contacts. Default: both, with `ax` a.
    ax : matplotlib.axes.Axes, optional
        Axes to draw one panel of one window into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If there is no window, or no such panel, or more than one window with `ax`.

    Examples
    --------
    >>> from symosc import grazing_window, load_scene, plot
    >>> p = load_scene("fig9").parameters
    >>> drawing = plot.window_figure([grazing_window(p, mapping) for mapping in ("P2", "P3")])
    >>> len(drawing.axes)
    4
    """
    chosen = _read_windows(windows)
    draw = {"a": _circle, "b": _contacts}
    panels = read_panels(panels, tuple(draw), ax)
    if ax is None:
        return _rows(chosen, [draw[letter] for letter in panels] + ([] if plane is None else [plane]))
    drawing = figure_of(ax)
    if len(chosen) > 1:
        raise ParameterError("windows", f"{len(chosen)} windows", "axes hold one window: give ax= with one")
    draw[panels](ax, chosen[0])
    return drawing


def _read_windows(windows: GrazingWindow | Sequence[GrazingWindow]) -> list[GrazingWindow]:
    """Return one window, or all of a sequence, as a list."""
    chosen = [windows] if isinstance(windows, GrazingWindow) else list(windows)
    if not chosen:
        raise ParameterError("windows", windows, "must be at least one")
    return chosen


def _rows(windows: list[GrazingWindow], columns: list[Callable[[Axes, GrazingWindow], None]]) -> Figure:
    """Return a figure with a row for each window, and in each row what the columns draw of it."""
    with style_for(None):
        size = 1.2 + 2.9 * len(columns), 2.5 * len(windows) + 0.2
        drawing = Drawing(figsize=size, layout="constrained")
        widths = [1.0 if column is _circle else 1.5 for column in columns]
        grid = drawing.subplots(len(windows), len(columns), squeeze=False, width_ratios=widths)
        for row, window in zip(grid, windows, strict=True):
            for axes, column in zip(row, columns, strict=True):
                column(axes, window)
    return drawing


def tex(mapping: str) -> str:
    """Return the name of a map as LaTeX."""
    return f"P_{mapping.removeprefix('P')}"


# --- the circle ---


def _circle(axes: Axes, window: GrazingWindow) -> None:
    around = np.linspace(0, TURN, CIRCLE_POINTS)
    axes.plot(np.cos(around), np.sin(around), color=OUTSIDE_COLOR, linewidth=1.0, zorder=1)
    for low, high, *_ in window.intervals:
        arc = np.linspace(low, high, max(2, int(CIRCLE_POINTS * (high - low) / TURN)))
        axes.plot(np.cos(arc), np.sin(arc), color=INSIDE_COLOR, linewidth=3.0, solid_capstyle="butt", zorder=2)
    critical = critical_phases(window)
    for theta, belongs in critical:
        axes.plot([0, cos(theta)], [0, sin(theta)], color=CRITICAL_COLOR, linewidth=0.7, zorder=1)
        draw_dot(axes, cos(theta), sin(theta), belongs)
    if critical:
        level = sin(critical[0][0])
        axes.plot([-1.15, 1.15], [level, level], color=CRITICAL_COLOR, linewidth=0.7, linestyle=(0, (4, 3)), zorder=1)
    names = (r"$\Theta^{cr}$", r"$\pi-\Theta^{cr}$")
    for (theta, _), name in zip(critical, names, strict=False):
        beyond = 1.28 if abs(cos(theta)) < 0.5 else 1.22
        side = "left" if cos(theta) > 0.1 else "right" if cos(theta) < -0.1 else "center"
        axes.text(
            beyond * cos(theta), beyond * sin(theta), name, color=CRITICAL_COLOR, ha=side, va="center", fontsize=8
        )
    _quarter_marks(axes, [theta for theta, _ in critical])
    axes.set(xlim=(-1.9, 1.9), ylim=(-1.5, 1.5), aspect="equal")
    axes.set_axis_off()
    axes.set_title(f"${tex(window.mapping)}$: case {window.case}, {window.order} order", fontsize=8)


def _quarter_marks(axes: Axes, taken: list[float]) -> None:
    for quarter in range(4):
        theta = quarter * pi / 2
        axes.plot([0.94 * cos(theta), cos(theta)], [0.94 * sin(theta), sin(theta)], color="black", linewidth=0.6)
        if all(cos(theta - other) < 0.95 for other in taken):
            side = ("left", "center", "right", "center")[quarter]
            axes.text(1.12 * cos(theta), 1.2 * sin(theta), PHASE_TICKS[quarter], ha=side, va="center", fontsize=7)


def critical_phases(window: GrazingWindow) -> list[tuple[float, bool]]:
    """Return Theta_cr and pi - Theta_cr mod 2 pi (one phase at equality) with whether they are in the window."""
    gamma_sign, amplitude_sign, excess_sign = window.signs
    if amplitude_sign == 0 or excess_sign > 0:
        return []
    if excess_sign == 0:
        return [(HALF_PI[0] if gamma_sign * amplitude_sign < 0 else THREE_HALVES_PI, window.kind == EVERYTHING)]
    theta_cr = float(window.critical_phase())
    return [(theta_cr % TURN, False), (pi - theta_cr, False)]


def draw_dot(axes: Axes, x: float, y: float, belongs: bool, label: str | None = None) -> None:
    """Draw a full dot for what belongs to a window, an open one for what does not."""
    style: dict[str, Any] = {
        "color": INSIDE_COLOR,
        "markerfacecolor": INSIDE_COLOR if belongs else "white",
        "markersize": 4.5,
    }
    axes.plot([x], [y], "o", zorder=4, clip_on=False, linestyle="none", label=label, **style)


# --- contacts ---


def _contacts(axes: Axes, window: GrazingWindow) -> None:
    axes.set(xlim=(0, TURN), xlabel=r"$\mathrm{mod}(\Omega t_m, 2\pi)$", ylabel="$x_m$")
    axes.set_xticks(np.arange(5) * pi / 2, PHASE_TICKS)
    p = window.parameters
    axes.set_title(f"domain {window.place.domain} at $v_{window.place.boundary} = {show(window.speed)}$", fontsize=8)
    if p.k == 0:
        axes.set_yticks([])
        phase = "$F = 0$ fixes the phase" if window.contact_phases else "no phase of the window has $F = 0$"
        axes.text(0.5, 0.9, f"$k = 0$: $x_m$ is free, {phase}", transform=axes.transAxes, ha="center")
        for low, high, *_ in window.intervals:
            axes.axvspan(low, high, color=SHADE_COLOR, linewidth=0)
        for theta in window.contact_phases:
            axes.axvline(float(theta), color=INSIDE_COLOR, linewidth=1.6)
        return
    around = np.linspace(0, TURN, CIRCLE_POINTS)
    axes.plot(around, _places(window, around), color=OUTSIDE_COLOR, linewidth=0.8)
    for low, high, *_ in window.intervals:
        part = np.linspace(low, high, max(2, int(CIRCLE_POINTS * (high - low) / TURN)))
        axes.plot(part, _places(window, part), color=INSIDE_COLOR, linewidth=2.0)
    for theta, belongs in critical_phases(window):
        axes.axvline(theta, color=CRITICAL_COLOR, linewidth=0.7, linestyle=(0, (4, 3)), zorder=0)
        for shown in (theta, TURN) if theta == 0 else (theta,):
            draw_dot(axes, shown, float(_places(window, np.array([theta]))[0]), belongs)


def _places(window: GrazingWindow, theta: np.ndarray) -> np.ndarray:
    """Return (A_alpha + B0 cos theta - c v_lambda)/k at any phase, in the window or not."""
    p = window.parameters
    return float((p.A(window.place.domain) - p.c * window.speed) / p.k) + float(p.B0 / p.k) * np.cos(theta)
