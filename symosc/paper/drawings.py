"""The paper's Figs. 2 to 4: the friction of the oscillator, its domains, and its mappings.

All are computed: Fig. 2 from a set of parameters, the arrows of Fig. 3 from the accelerations (9), and every curve of
Fig. 4 is a motion of one oscillator.
"""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from symosc.model import NEIGHBOURS, Parameters
from symosc.paper.oscillator import COLUMN_WIDTH, GREY, LINE_WEIGHT, THICK_WEIGHT, THIN_WEIGHT
from symosc.plot.drawing import STYLE
from symosc.plot.panels import BELT_COLOR, END_COLOR, MASS_COLOR, ONSET_COLOR
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory
from symosc.words import MAPS

DRAWN_POINTS = 200
LEVELS = (r"$-(\mu_1+\mu_2)F_N$", r"$(\mu_1-\mu_2)F_N$", r"$(\mu_1+\mu_2)F_N$")
BOX = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
SHADES = ("#eef3fb", "#fdfdfd", "#fbf1ee")  # of domains 1, 2 and 3

Edges = tuple[float, float]

#: The oscillator of Fig. 4, where and when each of its mappings starts (x_i, t_i), and the longest time that one takes.
MAPPING_PARAMETERS = Parameters(
    m=1, c="0.1", k="0.4", A0=0, B0=20, Omega="2.5", v1=4, v2=8, mu1="0.7", mu2="0.5", FN="9.81"
)
MAPPING_STARTS = {
    "P1": ("-6.5", "1.59"),
    "P2": ("-11", "1.01"),
    "P3": ("-3", "0.25"),
    "P4": ("1.5", "1.97"),
    "P5": ("-9.5", "1.51"),
    "P6": ("-7.5", "2.51"),
    "P7": ("4.5", "0.59"),
    "P8": ("-14", "1.84"),
}
#: Where the names stand, from the middle of the curves: alignment, and distance in points.
MAPPING_NAMES = {
    "P1": ("center", "top", 0, -5),
    "P2": ("center", "top", 0, -3),
    "P3": ("center", "bottom", 0, 3),
    "P4": ("center", "bottom", 0, 4),
    "P5": ("center", "top", 0, -3),
    "P6": ("center", "bottom", 0, 3),
    "P7": ("left", "center", 5, 0),
    "P8": ("right", "center", -5, 0),
}
MAPPING_SPAN = 3
#: Start and end of a mapping: shape and colour.
ENDS = (("o", ONSET_COLOR), ("s", END_COLOR))


# --- Fig. 2 ---


def fig2(p: Parameters | None = None) -> Figure:
    """Return Fig. 2, the friction force F_f against the velocity, an interval at each belt's speed (eq. (1)).

    Parameters
    ----------
    p : Parameters, optional
        Default: those of Fig. 5.

    Returns
    -------
    matplotlib.figure.Figure
    """
    p = load_scene("fig5").parameters if p is None else p
    v1, v2 = float(p.v1), float(p.v2)
    levels = [float(p.A0 - p.A(alpha)) for alpha in (1, 2, 3)]
    reach, height = v2 - v1, max(map(abs, levels)) or 1.0
    edges = v1 - reach, v1, v2, v2 + reach
    with rc_context(STYLE):
        drawing = Figure(figsize=(COLUMN_WIDTH, 2.7), layout="constrained")
        ax = drawing.add_subplot()
        ax.axhline(0.0, color=GREY, lw=THIN_WEIGHT, zorder=1)
        for alpha, (level, name) in enumerate(zip(levels, LEVELS, strict=True), 1):
            low, high = edges[alpha - 1 : alpha + 1]
            ax.plot([low, high], [level, level], color=MASS_COLOR, lw=1.6, solid_capstyle="butt", zorder=3, label=name)
            text, side = f"{name}\n$= {level:.4g}$", -1 if alpha == 3 else 1
            place = (low + high) / 2, level + 0.07 * side * height
            ax.text(*place, text, ha="center", va="top" if side < 0 else "bottom")
            ax.text(place[0], -1.3 * height, rf"$\Omega_{alpha}$", ha="center", va="center", color=GREY)
        for belt, speed in ((1, v1), (2, v2)):
            ax.plot([speed, speed], levels[belt - 1 : belt + 1], color=ONSET_COLOR, lw=THICK_WEIGHT, zorder=4)
            ax.axvline(speed, color=GREY, lw=THIN_WEIGHT, ls=":", zorder=1)
        ax.set_xlim(edges[0], edges[-1])
        ax.set_ylim(-1.5 * height, 1.25 * height)
        ax.set_xticks([v1, v2], [f"$v_1 = {v1:g}$", f"$v_2 = {v2:g}$"])
        ax.set_yticks([0.0], ["0"])
        ax.set_xlabel(r"velocity $\dot{x}$")
        ax.set_ylabel("friction force $F_f$")
        key = [Line2D([], [], color=MASS_COLOR, lw=1.6), Line2D([], [], color=ONSET_COLOR, lw=THICK_WEIGHT)]
        words = ["slips: one value", "sticks: any value"]
        ax.legend(key, words, loc="upper left", frameon=False, handlelength=0.9, handletextpad=0.5, borderaxespad=0.2)
    return drawing


# --- Fig. 3 ---


def fig3(scene: str = "fig5") -> Figure:
    """Return Fig. 3, the phase plane with its domains and boundaries, and the direction of motion at t = 0.

    Parameters
    ----------
    scene : str
        Whose accelerations the arrows show.

    Returns
    -------
    matplotlib.figure.Figure
    """
    p = load_scene(scene).parameters
    v1, v2 = float(p.v1), float(p.v2)
    zones = {belt: stick_zone(p, belt) for belt in (1, 2)}
    left, right = min(zone[0] for zone in zones.values()), max(zone[1] for zone in zones.values())
    x = left - 0.25 * (right - left), right + 0.25 * (right - left)
    v = v1 - 0.9 * (v2 - v1), v2 + 0.9 * (v2 - v1)
    with rc_context(STYLE):
        drawing = Figure(figsize=(COLUMN_WIDTH, 3.0), layout="constrained")
        ax = drawing.add_subplot()
        for alpha, (low, high) in enumerate(((v[0], v1), (v1, v2), (v2, v[1])), 1):
            ax.axhspan(low, high, color=SHADES[alpha - 1], lw=0, zorder=0)
            _field(ax, p, alpha, x, (low, high), (x, v))
            ax.text(
                x[1] - 0.02 * (x[1] - x[0]),
                (low + high) / 2,
                rf"$\Omega_{alpha}$",
                ha="right",
                va="center",
                fontsize=11,
                bbox=dict(BOX, facecolor=SHADES[alpha - 1]),
                zorder=5,
            )
        for belt, speed in ((1, v1), (2, v2)):
            lo, hi = NEIGHBOURS[belt]
            ax.axhline(speed, color=BELT_COLOR, lw=LINE_WEIGHT, zorder=2)
            ax.plot(
                zones[belt], [speed, speed], color=ONSET_COLOR, lw=THICK_WEIGHT + 0.6, solid_capstyle="butt", zorder=3
            )
            ax.text(
                x[0] + 0.035 * (x[1] - x[0]),
                speed,
                rf"$\partial\Omega_{{{lo}{hi}}}$",
                ha="left",
                va="center",
                bbox=BOX,
                zorder=5,
            )
        ax.set_xlim(x)
        ax.set_ylim(v)
        _phase_axes(ax, v1, v2)
        key = [
            Line2D([], [], color=ONSET_COLOR, lw=THICK_WEIGHT + 0.6),
            Line2D([], [], color=GREY, marker=r"$\rightarrow$", ls="", ms=8),
        ]
        words = [r"sticks at $\Omega t = 0$", r"direction at $\Omega t = 0$"]
        drawing.legend(key, words, loc="outside lower center", ncols=2, frameon=False, borderpad=0.1, columnspacing=1.2)
    return drawing


def stick_zone(p: Parameters, belt: int) -> tuple[float, float]:
    """Return the displacements at which the mass sticks to a belt at phase 0: F(above) < 0 < F(below) (Theorem 4)."""
    ends = [(p.A(alpha) + p.B0 - p.c * p.belt(belt)) / p.k for alpha in reversed(NEIGHBOURS[belt])]
    return float(ends[0]), float(ends[1])


def _field(ax: Axes, p: Parameters, alpha: int, x: Edges, v: Edges, limits: tuple[Edges, Edges]) -> None:
    """Draw arrows of one length in the direction of (x', F^(alpha)) at phase 0, as the axes show it."""
    rows = max(1, round(7 * (v[1] - v[0]) / (limits[1][1] - limits[1][0])))
    speeds = v[0] + (np.arange(rows) + 0.5) * (v[1] - v[0]) / rows
    places = np.linspace(*x, 12)[1:-1]
    X, V = np.meshgrid(places, speeds)
    F = (float(p.A(alpha) + p.B0) - float(p.k) * X - float(p.c) * V) / float(p.m)
    U, W = V / (limits[0][1] - limits[0][0]), F / (limits[1][1] - limits[1][0])
    size = np.hypot(U, W)
    ax.quiver(X, V, U / size, W / size, pivot="mid", color=GREY, width=0.004, scale=16, headwidth=4.5, zorder=1)


# --- Fig. 4 ---


def mapping_motion(label: str) -> Trajectory:
    """Return the motion of Fig. 4 that is one mapping: it starts on the mapping's plane and ends at its first event."""
    x, t = MAPPING_STARTS[label]
    speed = MAPPING_PARAMETERS.belt(MAPS[label].start.boundary)
    return simulate(MAPPING_PARAMETERS, t0=t, x0=x, v0=speed, t_end=float(t) + MAPPING_SPAN, max_events=1)


def fig4() -> Figure:
    """Return Fig. 4, the basic mappings P1 to P8 in the phase plane, each a motion of the same oscillator.

    Returns
    -------
    matplotlib.figure.Figure
    """
    p = MAPPING_PARAMETERS
    v1, v2 = float(p.v1), float(p.v2)
    with rc_context(STYLE):
        drawing = Figure(figsize=(COLUMN_WIDTH, 3.0), layout="constrained")
        ax = drawing.add_subplot()
        for label in MAPPING_STARTS:
            _mapping(ax, label)
        low, high = v1 - 0.8 * (v2 - v1), v2 + 0.85 * (v2 - v1)
        left, right = ax.get_xlim()[0] - 1.0, ax.get_xlim()[1] + 1.8
        for alpha, edges in enumerate(((low, v1), (v1, v2), (v2, high)), 1):
            ax.axhspan(*edges, color=SHADES[alpha - 1], lw=0, zorder=0)
            place = right - 0.025 * (right - left), sum(edges) / 2
            ax.text(*place, rf"$\Omega_{alpha}$", ha="right", va="center", fontsize=11)
        for speed in (v1, v2):
            ax.axhline(speed, color=BELT_COLOR, lw=LINE_WEIGHT, zorder=2)
        ax.set_xlim(left, right)
        ax.set_ylim(low, high)
        _phase_axes(ax, v1, v2)
        marks = [Line2D([], [], ls="", marker=marker, ms=3.5, color=color) for marker, color in ENDS]
        drawing.legend(marks, ["start", "end"], loc="outside lower center", ncols=2, frameon=False, borderpad=0.1)
    return drawing


def _phase_axes(ax: Axes, v1: float, v2: float) -> None:
    ax.set_xticks([])
    ax.set_yticks([v1, v2], ["$v_1$", "$v_2$"])
    ax.tick_params(axis="y", length=0)
    ax.set_xlabel("displacement $x$")
    ax.set_ylabel(r"velocity $\dot{x}$")


def _mapping(ax: Axes, label: str) -> None:
    motion = mapping_motion(label)
    t = np.linspace(float(motion.t_start), float(motion.events[0].t), DRAWN_POINTS)
    x, v = motion(t)
    sticks = motion.segments[0].mode.startswith("belt")
    ax.plot(
        x, v, color=MASS_COLOR, lw=THICK_WEIGHT if sticks else LINE_WEIGHT, zorder=3, label=label, solid_capstyle="butt"
    )
    for index, (marker, color) in zip((0, -1), ENDS, strict=True):
        ax.plot(x[index], v[index], marker, color=color, ms=3.5, zorder=5)
    returns = v[0] == v[-1] and not sticks
    middle = DRAWN_POINTS // 2
    head = DRAWN_POINTS // 4 if returns else middle
    arrow = {
        "arrowstyle": "-|>",
        "color": MASS_COLOR,
        "lw": LINE_WEIGHT,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 9,
    }
    ax.annotate("", (x[head + 4], v[head + 4]), (x[head], v[head]), arrowprops=arrow, zorder=4)
    across, up, dx, dy = MAPPING_NAMES[label]
    at = int(np.argmax(np.abs(v - v[0]))) if returns else middle
    ax.annotate(f"$P_{label[1:]}$", (x[at], v[at]), (dx, dy), textcoords="offset points", ha=across, va=up, zorder=6)
