"""The paper's Figs. 1 to 4: the model, the friction force, the phase plane and the eight mappings."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from symosc.friction import MAPS, NEIGHBOURS
from symosc.model import Parameters
from symosc.plot.drawing import STYLE
from symosc.plot.panels import BELT_COLOR, END_COLOR, MASS_COLOR, ONSET_COLOR
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

COLUMN_WIDTH = 3.6  # inches: one column of a page, and legible on a phone
# weights of lines
THIN = 0.6
LINE = 1.1
THICK = 2.4
GREY = "#666666"
SHADES = ("#eef3fb", "#fdfdfd", "#fbf1ee")  # of domains 1, 2 and 3
BOX = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
OUTSIDE: dict[str, Any] = {
    "loc": "outside lower center",
    "ncols": 2,
    "frameon": False,
    "borderpad": 0.1,
}
CENTER: dict[str, Any] = {"ha": "center", "va": "center"}

Edges = tuple[float, float]


@rc_context(STYLE)
def fig1() -> Figure:
    """Return Fig. 1, the physical model: mass, spring, damper, the two belts, and the forces."""
    drawing = Figure(figsize=(COLUMN_WIDTH, 2.0))
    ax = drawing.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set(xlim=(-0.5, 11.7), ylim=(-3.4, 3.4), aspect="equal")
    ax.set_axis_off()
    ax.plot([0.0, 0.0], [-1.1, 1.1], color="black", lw=LINE)
    for low in np.linspace(-1.1, 0.8, 7):
        ax.plot([-0.35, 0.0], [low, low + 0.3], color="black", lw=THIN)
    # The spring at height 0.45, in six turns, from the wall to the mass.
    mass_left = 4.7
    height = 0.45
    x = np.linspace(0.6, 4.1, 25)
    y = height + 0.24 * np.sin(np.arange(25) * np.pi / 2)
    x = np.concatenate([[0.0], x, [mass_left]])
    y = np.concatenate([[height], y, [height]])
    ax.plot(x, y, color="black", lw=LINE, solid_joinstyle="round")
    ax.text(1.3, 0.85, "$k$", ha="center", va="bottom")
    # The damper at height -0.45: rod, pot, piston, rod.
    y0 = -height
    left = 1.35
    right = 2.35
    piston = 1.95
    half = 0.24
    ax.plot([0.0, left], [y0, y0], color="black", lw=LINE)
    ax.plot(
        [right, left, left, right],
        [y0 + half, y0 + half, y0 - half, y0 - half],
        color="black",
        lw=LINE,
    )
    ax.plot([piston, piston], [y0 - 0.17, y0 + 0.17], color="black", lw=1.6 * LINE)
    ax.plot([piston, mass_left], [y0, y0], color="black", lw=LINE)
    ax.text(1.3, -0.8, "$c$", ha="center", va="top")
    mass = Rectangle(
        (mass_left, -0.9), 2.0, 1.8, facecolor="#f3d9d6", edgecolor=MASS_COLOR, lw=LINE, zorder=3
    )
    ax.add_patch(mass)
    ax.text(5.7, 0.0, "$m$", **CENTER, fontsize=11, zorder=4)
    _draw_belt(ax, 1, 2)
    _draw_belt(ax, -1, 1)
    _draw_arrow(ax, (6.7, 0.35), (8.1, 0.35), MASS_COLOR)
    ax.text(8.25, 0.33, r"$A_0 + B_0\cos\Omega t$", ha="left", va="center")
    _draw_arrow(ax, (6.7, -0.5), (7.6, -0.5), "black", lw=THIN)
    ax.text(7.75, -0.5, "$x$", ha="left", va="center")
    return drawing


def _draw_arrow(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], color: str, **style: Any
) -> None:
    """Draw an arrow with a filled head from one point to another; `style` as for
    FancyArrowPatch.
    """
    arrow: dict[str, Any] = {
        "arrowstyle": "-|>",
        "mutation_scale": 8.0,
        "lw": LINE,
        "shrinkA": 0.0,
        "shrinkB": 0.0,
    }
    ax.add_patch(FancyArrowPatch(start, end, color=color, **(arrow | style)))


def _draw_belt(ax: Axes, side: int, number: int) -> None:
    """Draw a belt above (side 1) or below (-1) the mass: its strand at the mass moves to the right."""
    contact = 0.9  # height of the strand at the mass
    radius = 0.7
    centres = (3.6, 8.9)
    left_centre, right_centre = centres
    mass_left, mass_right = (4.7, 6.7)
    middle = side * (contact + radius)
    outer = side * (contact + 2 * radius)
    for centre in centres:
        ax.add_patch(Circle((centre, middle), radius, facecolor="white", edgecolor=GREY, lw=THIN))
        ax.plot([centre], [middle], "o", color=GREY, ms=1.8)
        bend = 0.5 * radius * np.exp(1j * np.radians([205, 335]))
        start, end = ((centre + z.real, middle + side * z.imag) for z in bend)
        _draw_arrow(
            ax,
            start,
            end,
            GREY,
            lw=THIN,
            mutation_scale=5.0,
            connectionstyle=f"arc3,rad={0.6 * side}",
        )
    turn = np.linspace(-np.pi / 2, np.pi / 2, 60)
    # The belt's rim: the right bow upwards, then the left one downwards.
    bows = [(right_centre, np.cos(turn), np.sin(turn)), (left_centre, -np.cos(turn), -np.sin(turn))]
    rim = np.vstack([np.column_stack([x + radius * c, middle + radius * s]) for x, c, s in bows])
    ax.add_patch(Polygon(rim, closed=True, fill=False, edgecolor=BELT_COLOR, lw=1.5, zorder=2))
    # A shoe behind the strand presses the belt against the mass.
    low, high = sorted((side * (contact + 0.07), side * (contact + 0.25)))
    ax.add_patch(
        Rectangle((mass_left, low), mass_right - mass_left, high - low, facecolor=GREY, lw=0)
    )
    _draw_arrow(ax, (5.7, outer + side * 0.95), (5.7, side * (contact + 0.25)), "black", zorder=5)
    ax.text(5.9, outer + side * 0.6, "$F_N$", ha="left", va="center")
    _draw_arrow(ax, (6.95, side * (contact + 0.3)), (7.95, side * (contact + 0.3)), BELT_COLOR)
    ax.text(7.4, side * (contact + 0.75), f"$v_{number}$", **CENTER)
    ax.text(9.75, middle, f"belt {number}", ha="left", va="center")


@rc_context(STYLE)
def fig2() -> Figure:
    """Return Fig. 2, the friction force F_f against the velocity, an interval at each belt's speed
    (eq. (1)).
    """
    p = load_scene("fig5").parameters
    v1 = float(p.v1)
    v2 = float(p.v2)
    levels = [float(p.A0 - p.A(alpha)) for alpha in (1, 2, 3)]
    names = (r"$-(\mu_1+\mu_2)F_N$", r"$(\mu_1-\mu_2)F_N$", r"$(\mu_1+\mu_2)F_N$")
    reach = v2 - v1
    height = max(map(abs, levels)) or 1.0
    edges = v1 - reach, v1, v2, v2 + reach
    drawing = Figure(figsize=(COLUMN_WIDTH, 2.7), layout="constrained")
    ax = drawing.add_subplot()
    ax.axhline(0.0, color=GREY, lw=THIN, zorder=1)
    for alpha, (level, name) in enumerate(zip(levels, names, strict=True), 1):
        low, high = edges[alpha - 1 : alpha + 1]
        ax.plot(
            [low, high],
            [level, level],
            color=MASS_COLOR,
            lw=1.6,
            solid_capstyle="butt",
            zorder=3,
            label=name,
        )
        if alpha == 3:
            side = -1
        else:
            side = 1
        middle = (low + high) / 2
        ax.text(
            middle,
            level + 0.07 * side * height,
            f"{name}\n$= {level:.4g}$",
            ha="center",
            va="top" if side < 0 else "bottom",
        )
        ax.text(middle, -1.3 * height, rf"$\Omega_{alpha}$", **CENTER, color=GREY)
    for belt, speed in ((1, v1), (2, v2)):
        ax.plot([speed, speed], levels[belt - 1 : belt + 1], color=ONSET_COLOR, lw=THICK, zorder=4)
        ax.axvline(speed, color=GREY, lw=THIN, ls=":", zorder=1)
    ax.set(xlim=(edges[0], edges[-1]), ylim=(-1.5 * height, 1.25 * height))
    ax.set(xlabel=r"velocity $\dot{x}$", ylabel="friction force $F_f$")
    ax.set_xticks([v1, v2], [f"$v_1 = {v1:g}$", f"$v_2 = {v2:g}$"])
    ax.set_yticks([0.0], ["0"])
    key = [Line2D([], [], color=MASS_COLOR, lw=1.6), Line2D([], [], color=ONSET_COLOR, lw=THICK)]
    words = ["slips: one value", "sticks: any value"]
    ax.legend(
        key,
        words,
        loc="upper left",
        frameon=False,
        handlelength=0.9,
        handletextpad=0.5,
        borderaxespad=0.2,
    )
    return drawing


def _draw_directions(
    ax: Axes,
    p: Parameters,
    alpha: int,
    points: tuple[np.ndarray, np.ndarray],
    size: tuple[float, float],
) -> None:
    """Draw arrows of one length at points (x, v) of domain `alpha`, in the direction of the motion
    at t = 0, in axes of width and height `size`.
    """
    X, V = points
    width, height = size
    F = (float(p.A(alpha) + p.B0) - float(p.k) * X - float(p.c) * V) / float(p.m)
    # The direction of (x', F^(alpha)), as the axes show it.
    U = V / width
    W = F / height
    length = np.hypot(U, W)
    style: dict[str, Any] = {
        "pivot": "mid",
        "color": GREY,
        "width": 0.004,
        "scale": 16,
        "headwidth": 4.5,
    }
    ax.quiver(X, V, U / length, W / length, zorder=1, **style)


@rc_context(STYLE)
def fig3() -> Figure:
    """Return Fig. 3, the phase plane with its domains and boundaries, and the direction of motion
    at t = 0.
    """
    p = load_scene("fig5").parameters
    v1 = float(p.v1)
    v2 = float(p.v2)
    zones = {belt: sticking_interval(p, belt) for belt in (1, 2)}
    left = min(low for low, _ in zones.values())
    right = max(high for _, high in zones.values())
    x_low = left - 0.25 * (right - left)
    x_high = right + 0.25 * (right - left)
    v_low = v1 - 0.9 * (v2 - v1)
    v_high = v2 + 0.9 * (v2 - v1)
    width = x_high - x_low
    height = v_high - v_low
    drawing = Figure(figsize=(COLUMN_WIDTH, 3.0), layout="constrained")
    ax = drawing.add_subplot()
    for alpha, (low, high) in enumerate(((v_low, v1), (v1, v2), (v2, v_high)), 1):
        ax.axhspan(low, high, color=SHADES[alpha - 1], lw=0, zorder=0)
        # Ten columns of arrows, and about seven rows in all domains together.
        rows = max(1, round(7 * (high - low) / height))
        X, V = np.meshgrid(
            np.linspace(x_low, x_high, 12)[1:-1],
            low + (np.arange(rows) + 0.5) * (high - low) / rows,
        )
        _draw_directions(ax, p, alpha, (X, V), (width, height))
        place = (x_high - 0.02 * width, (low + high) / 2)
        box = dict(BOX, facecolor=SHADES[alpha - 1])
        ax.text(
            *place, rf"$\Omega_{alpha}$", ha="right", va="center", fontsize=11, bbox=box, zorder=5
        )
    stick: dict[str, Any] = {"color": ONSET_COLOR, "lw": THICK + 0.6}
    for belt, speed in ((1, v1), (2, v2)):
        lo, hi = NEIGHBOURS[belt]
        ax.axhline(speed, color=BELT_COLOR, lw=LINE, zorder=2)
        ax.plot(zones[belt], [speed, speed], solid_capstyle="butt", zorder=3, **stick)
        place = x_low + 0.035 * width, speed
        ax.text(
            *place, rf"$\partial\Omega_{{{lo}{hi}}}$", ha="left", va="center", bbox=BOX, zorder=5
        )
    _prepare_phase_axes(ax, p, (x_low, x_high), (v_low, v_high))
    key = [
        Line2D([], [], **stick),
        Line2D([], [], color=GREY, marker=r"$\rightarrow$", ls="", ms=8),
    ]
    words = [r"sticks at $\Omega t = 0$", r"direction at $\Omega t = 0$"]
    drawing.legend(key, words, columnspacing=1.2, **OUTSIDE)
    return drawing


def sticking_interval(p: Parameters, belt: int) -> tuple[float, float]:
    """Return the ends of the interval of x in which the mass sticks to a belt at phase 0 (Theorem
    4).
    """
    # It sticks between the positions at which a neighbour's force is 0, the upper one's first.
    left, right = (
        (p.A(alpha) + p.B0 - p.c * p.belt(belt)) / p.k for alpha in reversed(NEIGHBOURS[belt])
    )
    return float(left), float(right)


def _prepare_phase_axes(ax: Axes, p: Parameters, x: Edges, v: Edges) -> None:
    ax.set(xlim=x, ylim=v, xticks=[], xlabel="displacement $x$", ylabel=r"velocity $\dot{x}$")
    ax.set_yticks([float(p.v1), float(p.v2)], ["$v_1$", "$v_2$"])
    ax.tick_params(axis="y", length=0)


#: The oscillator of Fig. 4; where and when each mapping starts, x_i and t_i; and where its name
#: stands, from the middle of its curve: alignment, and distance in points.
MAPPING_PARAMETERS = Parameters(
    m=1, c="0.1", k="0.4", A0=0, B0=20, Omega="2.5", v1=4, v2=8, mu1="0.7", mu2="0.5", FN="9.81"
)
MAPPINGS = {
    "P1": ("-6.5", "1.59", ("center", "top", 0, -5)),
    "P2": ("-11", "1.01", ("center", "top", 0, -3)),
    "P3": ("-3", "0.25", ("center", "bottom", 0, 3)),
    "P4": ("1.5", "1.97", ("center", "bottom", 0, 4)),
    "P5": ("-9.5", "1.51", ("center", "top", 0, -3)),
    "P6": ("-7.5", "2.51", ("center", "bottom", 0, 3)),
    "P7": ("4.5", "0.59", ("left", "center", 5, 0)),
    "P8": ("-14", "1.84", ("right", "center", -5, 0)),
}
#: Start and end of a mapping: shape and colour.
ENDS = (("o", ONSET_COLOR), ("s", END_COLOR))


def mapping_motion(label: str) -> Trajectory:
    """Return the motion of Fig. 4 that is one mapping: it starts on the mapping's plane and ends at
    its first event.
    """
    x, t, _ = MAPPINGS[label]
    speed = MAPPING_PARAMETERS.belt(MAPS[label].start.boundary)
    return simulate(MAPPING_PARAMETERS, t0=t, x0=x, v0=speed, t_end=float(t) + 3, max_events=1)


@rc_context(STYLE)
def fig4() -> Figure:
    """Return Fig. 4, the basic mappings P1 to P8 in the phase plane, each a motion of the same
    oscillator.
    """
    p = MAPPING_PARAMETERS
    v1 = float(p.v1)
    v2 = float(p.v2)
    drawing = Figure(figsize=(COLUMN_WIDTH, 3.0), layout="constrained")
    ax = drawing.add_subplot()
    for label in MAPPINGS:
        _draw_mapping(ax, label)
    low = v1 - 0.8 * (v2 - v1)
    high = v2 + 0.85 * (v2 - v1)
    x_low, x_high = ax.get_xlim()
    left = x_low - 1.0
    right = x_high + 1.8
    for alpha, edges in enumerate(((low, v1), (v1, v2), (v2, high)), 1):
        ax.axhspan(*edges, color=SHADES[alpha - 1], lw=0, zorder=0)
        place = right - 0.025 * (right - left), sum(edges) / 2
        ax.text(*place, rf"$\Omega_{alpha}$", ha="right", va="center", fontsize=11)
    for speed in (v1, v2):
        ax.axhline(speed, color=BELT_COLOR, lw=LINE, zorder=2)
    _prepare_phase_axes(ax, p, (left, right), (low, high))
    marks = [Line2D([], [], ls="", marker=marker, ms=3.5, color=color) for marker, color in ENDS]
    drawing.legend(marks, ["start", "end"], **OUTSIDE)
    return drawing


def _draw_mapping(ax: Axes, label: str) -> None:
    """Draw a mapping's motion in the phase plane, with its two ends, an arrow and its name."""
    motion = mapping_motion(label)
    count = 200
    middle = count // 2
    x, v = motion(np.linspace(float(motion.t_start), float(motion.events[0].t), count))
    sticks = motion.segments[0].mode.startswith("belt")
    if sticks:
        weight = THICK
    else:
        weight = LINE
    ax.plot(x, v, color=MASS_COLOR, lw=weight, zorder=3, label=label, solid_capstyle="butt")
    for index, (marker, color) in zip((0, -1), ENDS, strict=True):
        ax.plot(x[index], v[index], marker, color=color, ms=3.5, zorder=5)
    # The samples at which the arrow begins, and beside which the name stands. A flight that returns
    # to its belt has its name at the farthest point from the belt, near the middle.
    if v[0] == v[-1] and not sticks:
        head = count // 4
        name_at = int(np.argmax(np.abs(v - v[0])))
    else:
        head = middle
        name_at = middle
    arrow = {
        "arrowstyle": "-|>",
        "color": MASS_COLOR,
        "lw": LINE,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 9,
    }
    ax.annotate("", (x[head + 4], v[head + 4]), (x[head], v[head]), arrowprops=arrow, zorder=4)
    _, _, (across, up, dx, dy) = MAPPINGS[label]
    ax.annotate(
        f"$P_{label[1:]}$",
        (x[name_at], v[name_at]),
        (dx, dy),
        textcoords="offset points",
        ha=across,
        va=up,
        zorder=6,
    )
