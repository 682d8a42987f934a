"""Figures of grazing windows: on the phase circle, with the contact curve x_m(theta), and against one parameter.

A full dot belongs to the window, an open dot does not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from math import cos, pi, sin
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.errors import ParameterError
from symosc.exact import read_exact, show
from symosc.grazing.sweep import WindowColumns, grazing_windows
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.kernels.double_double import HALF_PI, THREE_HALVES_PI
from symosc.mappings.theorem7_cases import (
    ALL_BUT_ONE,
    ARC,
    EMPTY,
    EVERYTHING,
    WRAPPED_ARC,
    check_parameters,
    place,
)
from symosc.model import Parameters
from symosc.plot.drawing import Drawing, figure_of, one_axes, read_panels, style_for

INSIDE, SHADE, OUTSIDE, CRITICAL = "#1f3fd6", "#cfd6f6", "0.72", "#d7191c"
TURN = 2 * pi
QUARTERS = ["$0$", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"]
POINTS = 1441
SWEEP_POINTS = 801
# A value nearer to the frame than this part of the axis gets room of that size.
LEAST_ROOM, ROOM = 0.02, 0.04
NAMES = {"Omega": r"\Omega", "B0": "B_0", "k": "k", "v1": "v_1", "v2": "v_2"}


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
        If an argument is none of these.

    Examples
    --------
    >>> from symosc import grazing_window, load_scene, plot
    >>> p = load_scene("fig9").parameters
    >>> drawing = plot.window_figure([grazing_window(p, mapping) for mapping in ("P2", "P3")])
    >>> len(drawing.axes)
    4
    """
    given = [windows] if isinstance(windows, GrazingWindow) else windows
    chosen = list(given) if isinstance(given, Iterable) else []
    if not chosen or not all(isinstance(window, GrazingWindow) for window in chosen):
        raise ParameterError("windows", "...", "must be a GrazingWindow or a sequence of them, at least one")
    draw = {"a": _circle, "b": _contacts}
    panels = read_panels(panels, tuple(draw), ax)
    if ax is not None:
        drawing = figure_of(ax)
        if len(chosen) > 1:
            raise ParameterError("windows", f"{len(chosen)} windows", "axes hold one window: give ax= with one")
        draw[panels](ax, chosen[0])
        return drawing
    columns: list[Callable[[Axes, GrazingWindow], None]] = [draw[letter] for letter in panels]
    columns += [] if plane is None else [plane]
    with style_for(ax):
        size = 1.2 + 2.9 * len(columns), 2.5 * len(chosen) + 0.2
        drawing = Drawing(figsize=size, layout="constrained")
        widths = [1.0 if column is _circle else 1.5 for column in columns]
        grid = drawing.subplots(len(chosen), len(columns), squeeze=False, width_ratios=widths)
        for row, window in zip(grid, chosen, strict=True):
            for axes, column in zip(row, columns, strict=True):
                column(axes, window)
    return drawing


def sweep_figure(
    p: Parameters,
    mapping: str,
    name: str,
    low: Any = None,
    high: Any = None,
    order: str = "full",
    *,
    ax: Axes | None = None,
) -> Figure:
    """Draw the window of a map against one parameter; its border is the curve of the arcsine.

    Parameters
    ----------
    p : Parameters
        The other parameters; the value of `name` in it is marked.
    mapping, order :
        As for `symosc.grazing_window`.
    name : {"Omega", "B0", "k", "v1", "v2"}
        A parameter on which the window depends.
    low, high : number, optional
        Range. Default: from 0 (both signs for B0 and the belts) to twice the larger one of the value and the equality
        |k v_lambda| = |B0| Omega, as far as Parameters allows.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        For a map without grazing, another parameter, or a range that is empty or not allowed.

    Examples
    --------
    >>> from symosc import load_scene, plot
    >>> drawing = plot.sweep_figure(load_scene("fig9").parameters, "P2", "Omega", "0.1", 4)
    >>> drawing.axes[0].get_xlabel()
    '$\\\\Omega$'
    """
    low, high = _sweep_range(check_parameters(p), mapping, name, low, high)
    equalities = [q for q in _equalities(p, mapping, name) if low < q < high]
    values = np.linspace(low, high, SWEEP_POINTS)
    # The window changes its kind at equality and at 0: sample them, and next to them.
    steps = (0.0, 1e-9 * (high - low), -1e-9 * (high - low))
    edges = [float(q) + step for q in [*equalities, Fraction(0)] for step in steps]
    values = np.unique(np.concatenate([values, [edge for edge in edges if low <= edge <= high]]))
    found = grazing_windows(p, mapping, order, **{name: values})
    with style_for(ax):
        drawing, axes = one_axes(ax, (4.6, 3.4))
        _areas(axes, values, found, place(mapping).side * (values if name == "B0" else float(p.B0)))
        _borders(axes, values, found)
        for q in equalities:
            for theta, belongs in _critical(grazing_window(p.replace(**{name: q}), mapping, order)):
                _dot(axes, float(q), theta, belongs, label="belongs to it" if belongs else "does not belong to it")
        axes.set(
            xlabel=f"${NAMES[name]}$", ylabel=r"$\mathrm{mod}(\Omega t_m, 2\pi)$", xlim=(low, high), ylim=(0, TURN)
        )
        _mark_value(axes, float(getattr(p, name)))
        axes.set_yticks(np.arange(5) * pi / 2, QUARTERS)
        axes.set_title(f"grazing window of ${_tex(mapping)}$, {order} order")
        handles, labels = axes.get_legend_handles_labels()
        if handles:
            style: dict[str, Any] = {"loc": "outside lower center", "ncols": 3, "frameon": False}
            once = dict(zip(labels, handles, strict=True))
            target, options = (drawing, style) if ax is None else (axes, {})
            target.legend(list(once.values()), list(once), **options)
    return drawing


def _mark_value(axes: Axes, value: float) -> None:
    """Draw a line at the given value, if the axis reaches it; where it would lie on the frame, make room."""
    low, high = axes.get_xlim()
    if not low <= value <= high:
        return
    axes.axvline(value, color="black", linewidth=0.9, linestyle=":", label="given value")
    room, width = ROOM * (high - low), high - low
    near_low, near_high = value - low < LEAST_ROOM * width, high - value < LEAST_ROOM * width
    axes.set_xlim(low - room * near_low, high + room * near_high)


def _tex(mapping: str) -> str:
    return f"P_{mapping.removeprefix('P')}"


# --- the circle ---


def _circle(axes: Axes, window: GrazingWindow) -> None:
    around = np.linspace(0, TURN, POINTS)
    axes.plot(np.cos(around), np.sin(around), color=OUTSIDE, linewidth=1.0, zorder=1)
    for low, high, *_ in window.intervals:
        arc = np.linspace(low, high, max(2, int(POINTS * (high - low) / TURN)))
        axes.plot(np.cos(arc), np.sin(arc), color=INSIDE, linewidth=3.0, solid_capstyle="butt", zorder=2)
    critical = _critical(window)
    for theta, belongs in critical:
        axes.plot([0, cos(theta)], [0, sin(theta)], color=CRITICAL, linewidth=0.7, zorder=1)
        _dot(axes, cos(theta), sin(theta), belongs)
    if critical:
        level = sin(critical[0][0])
        axes.plot([-1.15, 1.15], [level, level], color=CRITICAL, linewidth=0.7, linestyle=(0, (4, 3)), zorder=1)
    names = (r"$\Theta^{cr}$", r"$\pi-\Theta^{cr}$")
    for (theta, _), name in zip(critical, names, strict=False):
        beyond = 1.28 if abs(cos(theta)) < 0.5 else 1.22
        side = "left" if cos(theta) > 0.1 else "right" if cos(theta) < -0.1 else "center"
        axes.text(beyond * cos(theta), beyond * sin(theta), name, color=CRITICAL, ha=side, va="center", fontsize=8)
    _quarter_marks(axes, [theta for theta, _ in critical])
    axes.set(xlim=(-1.9, 1.9), ylim=(-1.5, 1.5), aspect="equal")
    axes.set_axis_off()
    axes.set_title(f"${_tex(window.mapping)}$: case {window.case}, {window.order} order", fontsize=8)


def _quarter_marks(axes: Axes, taken: list[float]) -> None:
    for quarter in range(4):
        theta = quarter * pi / 2
        axes.plot([0.94 * cos(theta), cos(theta)], [0.94 * sin(theta), sin(theta)], color="black", linewidth=0.6)
        if all(cos(theta - other) < 0.95 for other in taken):
            side = ("left", "center", "right", "center")[quarter]
            axes.text(1.12 * cos(theta), 1.2 * sin(theta), QUARTERS[quarter], ha=side, va="center", fontsize=7)


def _critical(window: GrazingWindow) -> list[tuple[float, bool]]:
    """Return Theta_cr and pi - Theta_cr mod 2 pi (one phase at equality) with whether they are in the window."""
    gamma_sign, amplitude_sign, excess_sign = window.signs
    if amplitude_sign == 0 or excess_sign > 0:
        return []
    if excess_sign == 0:
        return [(HALF_PI[0] if gamma_sign * amplitude_sign < 0 else THREE_HALVES_PI, window.kind == EVERYTHING)]
    theta_cr = float(window.critical_phase())
    return [(theta_cr % TURN, False), (pi - theta_cr, False)]


def _dot(axes: Axes, x: float, y: float, belongs: bool, label: str | None = None) -> None:
    style: dict[str, Any] = {"color": INSIDE, "markerfacecolor": INSIDE if belongs else "white", "markersize": 4.5}
    axes.plot([x], [y], "o", zorder=4, clip_on=False, linestyle="none", label=label, **style)


# --- contacts ---


def _contacts(axes: Axes, window: GrazingWindow) -> None:
    axes.set(xlim=(0, TURN), xlabel=r"$\mathrm{mod}(\Omega t_m, 2\pi)$", ylabel="$x_m$")
    axes.set_xticks(np.arange(5) * pi / 2, QUARTERS)
    p = window.parameters
    axes.set_title(f"domain {window.place.domain} at $v_{window.place.boundary} = {show(window.speed)}$", fontsize=8)
    if p.k == 0:
        axes.set_yticks([])
        phase = "$F = 0$ fixes the phase" if window.contact_phases else "no phase of the window has $F = 0$"
        axes.text(0.5, 0.9, f"$k = 0$: $x_m$ is free, {phase}", transform=axes.transAxes, ha="center")
        for low, high, *_ in window.intervals:
            axes.axvspan(low, high, color=SHADE, linewidth=0)
        for theta in window.contact_phases:
            axes.axvline(float(theta), color=INSIDE, linewidth=1.6)
        return
    around = np.linspace(0, TURN, POINTS)
    axes.plot(around, _places(window, around), color=OUTSIDE, linewidth=0.8)
    for low, high, *_ in window.intervals:
        part = np.linspace(low, high, max(2, int(POINTS * (high - low) / TURN)))
        axes.plot(part, _places(window, part), color=INSIDE, linewidth=2.0)
    for theta, belongs in _critical(window):
        axes.axvline(theta, color=CRITICAL, linewidth=0.7, linestyle=(0, (4, 3)), zorder=0)
        for shown in (theta, TURN) if theta == 0 else (theta,):
            _dot(axes, shown, float(_places(window, np.array([theta]))[0]), belongs)


def _places(window: GrazingWindow, theta: np.ndarray) -> np.ndarray:
    """Return (A_alpha + B0 cos theta - c v_lambda)/k at any phase, in the window or not."""
    p = window.parameters
    return float((p.A(window.place.domain) - p.c * window.speed) / p.k) + float(p.B0 / p.k) * np.cos(theta)


# --- against a parameter ---


def _sweep_range(p: Parameters, mapping: str, name: str, low: Any, high: Any) -> tuple[float, float]:
    where = place(mapping)
    names = ("Omega", "B0", "k", f"v{where.boundary}")
    if name not in names:
        raise ParameterError("name", name, f"the window of {mapping} depends on {', '.join(names)} only")
    reach = 2 * max([abs(float(getattr(p, name))), *(abs(float(q)) for q in _equalities(p, mapping, name))]) or 1.0
    least, most = {
        "Omega": (reach / 400, reach),
        "k": (0.0, reach),
        "B0": (-reach, reach),
        "v1": (min(-reach, float(p.v2) - reach), min(reach, float(p.v2))),
        "v2": (max(-reach, float(p.v1)), max(reach, float(p.v1) + reach)),
    }[name]
    found = [
        float(read_exact(name, given)) if given is not None else end for given, end in ((low, least), (high, most))
    ]
    # The belts may not have one speed.
    shift = 1e-9 * (found[1] - found[0])
    if name == "v1" and found[1] == float(p.v2):
        found[1] -= shift
    if name == "v2" and found[0] == float(p.v1):
        found[0] += shift
    if not found[0] < found[1]:
        raise ParameterError(name, found, "the range must go from a lower to a higher value")
    for end in found:
        p.replace(**{name: end})
    return found[0], found[1]


def _equalities(p: Parameters, mapping: str, name: str) -> list[Fraction]:
    """Return the values of a parameter at which |k v_lambda| = |B0| Omega."""
    speed = p.belt(place(mapping).boundary)
    level, size = abs(p.k * speed), abs(p.B0 * p.Omega)
    if name == "Omega":
        return [level / abs(p.B0)] if p.B0 and level else []
    if name == "B0":
        return [sign * level / p.Omega for sign in (1, -1)] if level else []
    if name == "k":
        return [size / abs(speed)] if speed and size else []
    return [sign * size / p.k for sign in (1, -1)] if p.k and size else []


def _areas(axes: Axes, values: np.ndarray, found: WindowColumns, above: Any) -> None:
    """Shade the window; the arc that it lacks ends at 3 pi/2 where `above` > 0, at pi/2 elsewhere."""
    if np.all(found.kind == EMPTY):
        axes.text(0.5, 0.5, "the window is empty", transform=axes.transAxes, ha="center")
    everything = np.isin(found.kind, (EVERYTHING, ALL_BUT_ONE))
    # Everything is a wrapped arc whose ends meet: shaded as one with the wrapped arcs beside it, without a seam.
    last = np.where(np.asarray(above) > 0, THREE_HALVES_PI, HALF_PI[0])
    low, high = np.where(everything, last, found.low), np.where(everything, last, found.high)
    wrapped = everything | (found.kind == WRAPPED_ARC)
    floor, ceiling, label = np.zeros_like(values), np.full_like(values, TURN), "window"
    for where, lower, upper in ((wrapped, floor, high), (wrapped, low, ceiling), (found.kind == ARC, low, high)):
        if where.any():
            axes.fill_between(values, lower, upper, where=where, color=SHADE, linewidth=0.4, label=label)
            label = "_"  # no second entry in the legend


def _borders(axes: Axes, values: np.ndarray, found: Any) -> None:
    """Draw Theta_cr and pi - Theta_cr, which are not in the window, broken where they jump by a turn."""
    if np.all(np.isnan(found.theta_cr)):
        return
    label: str | None = r"$\Theta^{cr}$ and $\pi-\Theta^{cr}$ (excluded)"
    for curve in (found.theta_cr % TURN, pi - found.theta_cr):
        broken = np.where(np.abs(np.diff(curve, prepend=curve[0])) > 3, np.nan, curve)
        axes.plot(values, broken, color=CRITICAL, linewidth=1.0, linestyle=(0, (4, 2)), label=label)
        label = None
