"""Figure of a grazing curve: the starts on the switching plane from which a mapping grazes, and its ends."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.arguments import public
from symosc.grazing.curve import CurvePiece, GrazingCurve
from symosc.mappings.theorem7_cases import place
from symosc.plot.drawing import Drawing, figure_of, read_panels, style_for

#: Shapes of the ends inside a window, by how the reason begins; others are diamonds.
END_SHAPES = {"end of the window": "o", "beyond": "o", "the flow touches": "s"}
START_COLOR, CONTACT_COLOR, GAP_COLOR = "#d7191c", "#1f3fd6", "0.85"
ANGLE_TICKS = {-2: r"$-\pi$", -1: r"$-\pi/2$", 0: "0", 1: r"$\pi/2$", 2: r"$\pi$", 3: r"$3\pi/2$", 4: r"$2\pi$"}
TURN = 2 * pi


@public
def figure_grazing_curve(curve: GrazingCurve, panels: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a grazing curve.

    Left: the switching plane, phases mod 2 pi, with the starts (x_i, Omega t_i) and the tangencies (x_m, theta_m).
    Right: the flight from start to tangency, in phase, over theta_m. An open dot is an end at the window's end, a full
    one an end inside the window; phases in the window without a start are shaded.

    Parameters
    ----------
    curve : GrazingCurve
    panels, ax : optional
        As for `symosc.plot.figure`. The panels are a switching plane, b flight. Default: both, with `ax` a.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If that is no GrazingCurve, or there is no such panel.

    Examples
    --------
    >>> from symosc import grazing_curve, load_scene, plot
    >>> drawing = plot.figure_grazing_curve(grazing_curve(load_scene("fig9").parameters, "P2"))
    >>> drawing.axes[1].get_title()
    'flight to the grazing point'
    """
    panels = read_panels(panels, tuple(PANELS), ax)
    if ax is not None:
        PANELS[panels](ax, curve)
        return figure_of(ax)
    with style_for(ax):
        drawing = Drawing(figsize=(3.5 * len(panels), 3.2), layout="constrained")
        for axes, letter in zip(drawing.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
            PANELS[letter](axes, curve)
    return drawing


def _draw_flight(axes: Axes, curve: GrazingCurve) -> None:
    for piece in curve.pieces:
        axes.plot(piece.theta_m, piece.theta_m - piece.theta, color=START_COLOR, linewidth=1.2)
        _ends(axes, piece, [end.theta_m - end.theta for end in (piece.low, piece.high)], "theta_m")
    for low, high, origin in curve.gaps:
        axes.axvspan(low, high, color=GAP_COLOR, linewidth=0, label=f"from: {origin}")
    axes.set(xlabel=r"$\theta_m$", ylabel=r"$\theta_m - \Omega t_i$")
    axes.set_title("flight to the grazing point")
    if not curve.pieces:
        say_instead(axes, _why_empty(curve))
    axes.set_xlim(*(_reach(curve) if curve.windows else (0, TURN)))
    _quarters(axes)
    _legend(axes)


def draw_plane(axes: Axes, curve: GrazingCurve) -> None:
    """Draw the left half of `figure_grazing_curve` into axes of another figure."""
    for piece in curve.pieces:
        _line(axes, piece.theta, piece.x, START_COLOR, label="start")
        _line(axes, piece.theta_m, piece.x_m, CONTACT_COLOR, label="grazing point", style=(0, (4, 1.6)))
        _ends(axes, piece, [end.x for end in (piece.low, piece.high)], "theta")
    belt = place(curve.mapping).boundary
    axes.set(xlabel=r"$\mathrm{mod}(\Omega t, 2\pi)$", ylabel="$x$", xlim=(0, TURN))
    axes.set_title(rf"${_tex(curve.mapping)}$ on the plane $\dot x = v_{belt}$")
    if not curve.pieces:
        say_instead(axes, _why_empty(curve))
    _quarters(axes)
    _legend(axes)


PANELS = {"a": draw_plane, "b": _draw_flight}


def say_instead(axes: Axes, why: str) -> None:
    """Say in axes why there is nothing to draw; a scale of nothing is not shown."""
    axes.text(0.5, 0.5, why, transform=axes.transAxes, ha="center", va="center")
    axes.set_yticks([])


def _why_empty(curve: GrazingCurve) -> str:
    return "no start on this plane grazes" if curve.windows else "the window is empty"


def _tex(mapping: str) -> str:
    return f"P_{mapping[1:]}"


def _reach(curve: GrazingCurve) -> tuple[float, float]:
    """Return the first and the last phase; over a full circle they are counted from where the curve was cut."""
    spans = [(piece.low.theta_m, piece.high.theta_m) for piece in curve.pieces]
    spans += [(low, high) for low, high, _ in curve.gaps]
    return min(low for low, _ in spans), max(high for _, high in spans)


def _line(axes: Axes, theta: np.ndarray, x: np.ndarray, color: str, label: str, style: Any = "-") -> None:
    """Draw a curve with its phase mod 2 pi, broken where that jumps."""
    turns = np.floor(theta / TURN)
    for part in np.split(np.arange(len(theta)), np.nonzero(np.diff(turns))[0] + 1):
        axes.plot(theta[part] - TURN * turns[part], x[part], color=color, linestyle=style, linewidth=1.2, label=label)


def _ends(axes: Axes, piece: CurvePiece, heights: list[float], across: str) -> None:
    for end, height in zip((piece.low, piece.high), heights, strict=True):
        if end.reason == "closed":
            continue
        style: dict[str, Any] = {
            "marker": next((shape for start, shape in END_SHAPES.items() if end.reason.startswith(start)), "D"),
            "markersize": 3.5,
            "linestyle": "none",
            "color": START_COLOR,
            "zorder": 3,
            "clip_on": False,
        }
        if end.reason == "end of the window":
            style["markerfacecolor"] = "white"
        along = end.theta % TURN if across == "theta" else end.theta_m
        axes.plot([along], [height], **style, label=end.reason)


def _quarters(axes: Axes) -> None:
    low, high = axes.get_xlim()
    shown = {k: ANGLE_TICKS.get(k, rf"${k // 2 if k % 2 == 0 else f'{k}/2 '}\pi$") for k in range(-4, 13)}
    inside = [k for k in shown if low - 1e-9 <= k * pi / 2 <= high + 1e-9]
    axes.set_xticks([k * pi / 2 for k in inside], [shown[k] for k in inside])


def _legend(axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    first = dict(zip(reversed(labels), reversed(handles), strict=True))
    if first:
        names = list(dict.fromkeys(labels))
        axes.legend([first[name] for name in names], names, frameon=False, fontsize=7)
