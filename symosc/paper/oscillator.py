"""The paper's Fig. 1: a drawing of the oscillator, and the weights of lines that Figs. 1 to 4 share."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from symosc.plot.drawing import STYLE
from symosc.plot.panels import BELT_COLOR, MASS_COLOR

COLUMN_WIDTH = 3.6  # inches: one column of a page, and legible on a phone
THIN_WEIGHT, LINE_WEIGHT, THICK_WEIGHT = 0.6, 1.1, 2.4
GREY = "#666666"


def fig1() -> Figure:
    """Return Fig. 1, the physical model: mass, spring, damper, the two belts, and the forces.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with rc_context(STYLE):
        drawing = Figure(figsize=(COLUMN_WIDTH, 2.0))
        ax = _canvas(drawing, (-0.5, 11.7), (-3.4, 3.4))
        _wall(ax, 0.0, (-1.1, 1.1))
        _spring(ax, (0.0, 0.45), 4.7)
        ax.text(1.3, 0.85, "$k$", ha="center", va="bottom")
        _damper(ax, (0.0, -0.45), 4.7)
        ax.text(1.3, -0.8, "$c$", ha="center", va="top")
        ax.add_patch(
            Rectangle((4.7, -0.9), 2.0, 1.8, facecolor="#f3d9d6", edgecolor=MASS_COLOR, lw=LINE_WEIGHT, zorder=3)
        )
        ax.text(5.7, 0.0, "$m$", ha="center", va="center", fontsize=11, zorder=4)
        for side, number in ((1, 2), (-1, 1)):
            _belt(ax, side, number)
        _arrow(ax, (6.7, 0.35), (8.1, 0.35), MASS_COLOR)
        ax.text(8.25, 0.33, r"$A_0 + B_0\cos\Omega t$", ha="left", va="center")
        _arrow(ax, (6.7, -0.5), (7.6, -0.5), "black", lw=THIN_WEIGHT)
        ax.text(7.75, -0.5, "$x$", ha="left", va="center")
    return drawing


def _canvas(drawing: Figure, x: tuple[float, float], y: tuple[float, float]) -> Axes:
    ax = drawing.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set_xlim(x)
    ax.set_ylim(y)
    ax.set_aspect("equal")
    ax.set_axis_off()
    return ax


def _arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float], color: str, **style: Any) -> None:
    look: dict[str, Any] = {
        "arrowstyle": "-|>",
        "mutation_scale": 8.0,
        "lw": LINE_WEIGHT,
        "shrinkA": 0.0,
        "shrinkB": 0.0,
    } | style
    ax.add_patch(FancyArrowPatch(start, end, color=color, **look))


def _wall(ax: Axes, x: float, y: tuple[float, float]) -> None:
    ax.plot([x, x], y, color="black", lw=LINE_WEIGHT)
    for low in np.linspace(y[0], y[1] - 0.3, 7):
        ax.plot([x - 0.35, x], [low, low + 0.3], color="black", lw=THIN_WEIGHT)


def _spring(ax: Axes, start: tuple[float, float], end: float) -> None:
    lead, turns, height = 0.6, 6, 0.24
    x = np.linspace(start[0] + lead, end - lead, 4 * turns + 1)
    y = start[1] + height * np.sin(np.arange(4 * turns + 1) * np.pi / 2)
    x, y = (np.concatenate(parts) for parts in (([start[0]], x, [end]), ([start[1]], y, [start[1]])))
    ax.plot(x, y, color="black", lw=LINE_WEIGHT, solid_joinstyle="round")


def _damper(ax: Axes, start: tuple[float, float], end: float) -> None:
    x, y = start
    left, right, half = 1.35, 2.35, 0.24
    ax.plot([x, left], [y, y], color="black", lw=LINE_WEIGHT)
    ax.plot([right, left, left, right], [y + half, y + half, y - half, y - half], color="black", lw=LINE_WEIGHT)
    ax.plot([1.95, 1.95], [y - 0.17, y + 0.17], color="black", lw=1.6 * LINE_WEIGHT)
    ax.plot([1.95, end], [y, y], color="black", lw=LINE_WEIGHT)


def _belt(ax: Axes, side: int, number: int) -> None:
    """Draw a belt above (side 1) or below (-1) the mass: its strand at the mass moves to the right."""
    contact, radius, centres, mass = 0.9, 0.7, (3.6, 8.9), (4.7, 6.7)
    middle, outer = side * (contact + radius), side * (contact + 2 * radius)
    for centre in centres:
        ax.add_patch(Circle((centre, middle), radius, facecolor="white", edgecolor=GREY, lw=THIN_WEIGHT))
        ax.plot([centre], [middle], "o", color=GREY, ms=1.8)
        bend = 0.5 * radius * np.exp(1j * np.radians([205, 335]))
        start, end = ((centre + z.real, middle + side * z.imag) for z in bend)
        _arrow(ax, start, end, GREY, lw=THIN_WEIGHT, mutation_scale=5.0, connectionstyle=f"arc3,rad={0.6 * side}")
    turn = np.linspace(-np.pi / 2, np.pi / 2, 60)
    bows = [(centres[1], np.cos(turn), np.sin(turn)), (centres[0], -np.cos(turn), -np.sin(turn))]
    rim = np.vstack([np.column_stack([x + radius * c, middle + radius * s]) for x, c, s in bows])
    ax.add_patch(Polygon(rim, closed=True, fill=False, edgecolor=BELT_COLOR, lw=1.5, zorder=2))
    # A shoe behind the strand presses the belt against the mass.
    shoe = sorted((side * (contact + 0.07), side * (contact + 0.25)))
    ax.add_patch(Rectangle((mass[0], shoe[0]), mass[1] - mass[0], shoe[1] - shoe[0], facecolor=GREY, lw=0))
    _arrow(ax, (5.7, outer + side * 0.95), (5.7, side * (contact + 0.25)), "black", zorder=5)
    ax.text(5.9, outer + side * 0.6, "$F_N$", ha="left", va="center")
    _arrow(ax, (6.95, side * (contact + 0.3)), (7.95, side * (contact + 0.3)), BELT_COLOR)
    ax.text(7.4, side * (contact + 0.75), f"$v_{number}$", ha="center", va="center")
    ax.text(9.75, middle, f"belt {number}", ha="left", va="center")
