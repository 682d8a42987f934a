"""Figure of a cross-check: errors against time, with the switching events marked."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from symosc.arguments import public
from symosc.crosschecks.compare import CrossCheck
from symosc.plot.drawing import Drawing, figure_of, read_panels, save, style_for

POSITION, VELOCITY, RIGHT, WRONG, INVENTED = "#1f3fd6", "#0f8a2a", "0.72", "#d7191c", "#e08214"
# Zeros are drawn here, and no axis goes further down.
FLOOR = 1e-17


@public
def crosscheck_figure(check: CrossCheck, panels: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a cross-check against time: global errors, defects of the steps, and the velocity.

    Events are vertical lines: matched ones grey, missed ones red and dashed, invented ones orange and dotted. The
    tolerances are dotted horizontal lines. `write` saves it.

    Parameters
    ----------
    check : CrossCheck
    panels, ax : optional
        As for `symosc.plot.figure`. The panels are a global errors, b defects, c velocity. Default: all, with `ax` a.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If that is no CrossCheck, or there is no such panel.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, plot, simulate
    >>> t = np.linspace(0, 3, 40)
    >>> x, v = simulate("fig5", t_end=3)(t)
    >>> [axes.get_ylabel() for axes in plot.crosscheck_figure(crosscheck("fig5", t, x, v), "ab").axes]
    ['global error', 'defect of the step']
    """
    panels = read_panels(panels, tuple(PANELS), ax)
    if ax is not None:
        drawing = figure_of(ax)
        _panel(ax, check, panels)
        ax.set_xlabel("$t$")
        ax.legend(**_entries([ax]))
        return drawing
    with style_for(ax):
        layout = ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.04)
        drawing = Drawing(figsize=(7.0, 0.8 + 1.6 * len(panels)), layout=layout)
        axes = drawing.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for each, letter, shown in zip(axes, panels, "abc", strict=False):
            _panel(each, check, letter)
            each.set_title(f"({shown})", loc="left", x=-0.07, pad=4)
            each.tick_params(labelfontfamily="STIXGeneral")
        axes[-1].set_xlabel("$t$")
        style: dict[str, Any] = {"frameon": False, "handlelength": 1.8, "columnspacing": 1.4}
        drawing.legend(**_entries(axes), loc="outside lower center", ncols=5, **style)
    return drawing


def _panel(ax: Axes, check: CrossCheck, letter: str) -> None:
    PANELS[letter](ax, check)
    _lines(ax, (match.event.t for match in check.matched), RIGHT, "-", "event, matched")
    _lines(ax, (event.t for event in check.missed), WRONG, "--", "event, missed")
    _lines(ax, (event.t for event in check.invented), INVENTED, ":", "event, invented")
    ax.set_xlim(check.t[0], check.t[-1])


def _entries(axes: Iterable[Axes]) -> dict[str, list[Any]]:
    entries: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(str(label), handle)
    return {"handles": list(entries.values()), "labels": list(entries)}


def write(check: CrossCheck, path: str | Path) -> Path:
    """Draw a cross-check into a PDF, SVG or PNG file; raises OutputError if it cannot be written."""
    return save(crosscheck_figure(check), path)


def _global_errors(ax: Axes, check: CrossCheck) -> None:
    _errors(ax, check.t, check.errors, check.scales, check.limits)
    ax.set_ylabel("global error")


def _defects(ax: Axes, check: CrossCheck) -> None:
    _errors(ax, check.t[1:], check.defects, check.scales, check.allowed)
    wrong = check.wrong_steps
    if len(wrong):
        worst = np.max(np.abs(check.defects[wrong]) / check.scales, axis=1)
        ax.plot(check.t[wrong + 1], worst, "x", color=WRONG, ms=5, label="wrong step")
    ax.set_ylabel("defect of the step")


def _errors(ax: Axes, t: np.ndarray, errors: np.ndarray, scales: tuple[float, float], limits: np.ndarray) -> None:
    shown: list[np.ndarray] = []
    names, colors = ("$x$, relative", r"$\dot{x}$, relative"), (POSITION, VELOCITY)
    for column, (name, color, style) in enumerate(zip(names, colors, ("-", (0, (4, 1.6))), strict=True)):
        values = np.maximum(np.abs(errors[:, column]) / scales[column], FLOOR)
        # Where exact and computed values agree to the last digit there is nothing to draw.
        values = np.where(values > FLOOR, values, np.nan)
        marker = "." if len(t) < 1000 else None
        shown.append(values)
        ax.plot(t, values, marker=marker, ms=2.5, lw=0.8, color=color, ls=style, label=name)
    limit = np.max(limits / scales, axis=1)
    ax.plot(t, limit, color="black", lw=0.7, ls=(0, (1, 2)), label="tolerance")
    if np.isnan(shown).all():  # nothing to scale by but the tolerance
        ax.set_ylim(FLOOR, 10 * max(float(np.max(limit)), FLOOR))
    ax.set_yscale("log")


def _velocity(ax: Axes, check: CrossCheck) -> None:
    p = check.trajectory.parameters
    ax.plot(check.t, check.v, color=VELOCITY, lw=0.8)
    low, high = float(np.min(check.v)), float(np.max(check.v))
    for speed in (float(p.v1), float(p.v2)):
        if low - (high - low) <= speed <= high + (high - low):
            ax.axhline(speed, color="black", lw=0.8, label="belt")
    ax.set_ylabel(r"$\dot{x}$")


PANELS = {"a": _global_errors, "b": _defects, "c": _velocity}


def _lines(ax: Axes, times: Iterable[Any], color: str, style: str, label: str) -> None:
    for time in times:
        ax.axvline(float(time), color=color, ls=style, lw=0.7 if style == "-" else 1.1, zorder=0, label=label)
