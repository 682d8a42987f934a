"""Figure of a cross-check: errors against time, with the switching events marked."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from symosc.crosschecks.compare import CrossCheck
from symosc.plot.drawing import STYLE, Drawing, save

POSITION, VELOCITY, RIGHT, WRONG, INVENTED = "#1f3fd6", "#0f8a2a", "0.72", "#d7191c", "#e08214"
# Zeros are drawn here, and no axis goes further down.
FLOOR = 1e-17


def figure(check: CrossCheck) -> Figure:
    """Draw global errors (a), defects of the steps (b) and the velocity (c) against time.

    Events are vertical lines: matched ones grey, missed ones red and dashed, invented ones orange and dotted. The
    tolerances are dotted horizontal lines. `write` saves it.
    """
    with rc_context(STYLE):
        drawing = Drawing(figsize=(7.0, 5.6), layout=ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.04))
        axes = drawing.subplots(3, 1, sharex=True)
        x_scale, v_scale = check.scales
        _errors(axes[0], check.t, check.errors, (x_scale, v_scale), check.global_tolerance)
        axes[0].set_ylabel("global error")
        _errors(axes[1], check.t[1:], check.defects, (x_scale, v_scale), check.tolerance)
        wrong = check.wrong_steps
        if len(wrong):
            worst = np.max(np.abs(check.defects[wrong]) / check.scales, axis=1)
            axes[1].plot(check.t[wrong + 1], worst, "x", color=WRONG, ms=5, label="wrong step")
        axes[1].set_ylabel("defect of the step")
        _velocity(axes[2], check)
        for ax, letter in zip(axes, "abc", strict=True):
            ax.set_title(f"({letter})", loc="left", x=-0.07, pad=4)
            _lines(ax, (match.event.t for match in check.matched), RIGHT, "-", "event, matched")
            _lines(ax, (event.t for event in check.missed), WRONG, "--", "event, missed")
            _lines(ax, (event.t for event in check.invented), INVENTED, ":", "event, invented")
            ax.tick_params(labelfontfamily="STIXGeneral")
        axes[2].set_xlabel("$t$")
        axes[2].set_xlim(check.t[0], check.t[-1])
        entries: dict[str, Any] = {}
        for ax in axes:
            for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
                entries.setdefault(label, handle)
        drawing.legend(
            list(entries.values()),
            list(entries),
            loc="outside lower center",
            ncols=5,
            frameon=False,
            handlelength=1.8,
            columnspacing=1.4,
        )
    return drawing


def write(check: CrossCheck, path: str | Path) -> Path:
    """Draw a cross-check into a PDF, SVG or PNG file; raises OutputError if it cannot be written."""
    return save(figure(check), path)


def _errors(ax: Axes, t: np.ndarray, errors: np.ndarray, scales: tuple[float, float], tolerance: float) -> None:
    names, colors = ("$x$, relative", r"$\dot{x}$, relative"), (POSITION, VELOCITY)
    for column, (name, color) in enumerate(zip(names, colors, strict=True)):
        values = np.maximum(np.abs(errors[:, column]) / scales[column], FLOOR)
        # Where exact and computed values agree to the last digit there is nothing to draw.
        values = np.where(values > FLOOR, values, np.nan)
        marker = "." if len(t) < 1000 else None
        ax.plot(t, values, marker=marker, ms=2.5, lw=0.8, color=color, label=name)
    ax.axhline(tolerance, color="black", lw=0.7, ls=(0, (1, 2)), label="tolerance")
    ax.set_yscale("log")


def _velocity(ax: Axes, check: CrossCheck) -> None:
    p = check.trajectory.parameters
    ax.plot(check.t, check.v, color=VELOCITY, lw=0.8)
    low, high = float(np.min(check.v)), float(np.max(check.v))
    for speed in (float(p.v1), float(p.v2)):
        if low - (high - low) <= speed <= high + (high - low):
            ax.axhline(speed, color="black", lw=0.8, label="belt")
    ax.set_ylabel(r"$\dot{x}$")


def _lines(ax: Axes, times: Iterable[Any], color: str, style: str, label: str) -> None:
    for time in times:
        ax.axvline(float(time), color=color, ls=style, lw=0.7 if style == "-" else 1.1, zorder=0, label=label)
