"""Figures of branches of periodic orbits."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from symosc.orbits.branch import Branch, BranchEnd
from symosc.orbits.continuation import MOST, NO_CONVERGENCE
from symosc.plot.figures import STYLE

# Colours that are told apart with any colour vision (Okabe and Ito), one for each switching point.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
MARKERS = {
    "grazing": "o",
    "birth of a stick": "^",
    "vanishing of a stick": "v",
    "birth of a slip": ">",
    "vanishing of a slip": "<",
    "vanishing of a flight": "P",
    "fold": "s",
    "period doubling": "D",
    "Neimark-Sacker": "X",
}
PARAMETER_LABELS = {"A0": "$A_0$", "B0": "$B_0$", "Omega": r"$\Omega$", "FN": "$F_N$"} | {
    f"{letter}{number}": rf"${symbol}_{number}$" for letter, symbol in (("v", "v"), ("mu", r"\mu")) for number in (1, 2)
}
ORDINALS = ("", "2nd ", "3rd ")
UNSTABLE = (0, (4, 2))


def branch_figure(branch: Branch) -> Figure:
    """Draw a branch: position at each switching and moduli of the multipliers over the parameter.

    Solid lines are stable orbits, dashed ones unstable. Marks tell why the branch ends, the words above the second
    panel name the orbit on the branch and those behind its ends.

    Parameters
    ----------
    branch : Branch

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene, plot
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.9, 4.1))
    >>> [axes.get_ylabel() for axes in plot.branch_figure(branch).axes]
    ['position $x$ at the switching', 'moduli of the multipliers']
    """
    with rc_context(STYLE):
        drawing = Figure(figsize=(7.0, 3.1), layout=ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.04))
        left, right = drawing.subplots(1, 2)
        _positions(left, branch)
        _multipliers(right, branch)
        for ax, letter in ((left, "a"), (right, "b")):
            ax.set_xlabel(PARAMETER_LABELS.get(branch.parameter, f"${branch.parameter}$"))
            ax.set_title(f"({letter})", loc="left", x=-0.12, pad=4)
            ax.tick_params(labelfontfamily="STIXGeneral")
            for end in branch.ends:
                if end.kind in MARKERS:
                    ax.axvline(end.value, color="0.6", lw=0.6, zorder=0)
        _next_words(right, branch)
        _legend(drawing, left, branch)
    return drawing


def _positions(ax: Axes, branch: Branch) -> None:
    for i, label in enumerate(branch.labels):
        color, before = COLORS[i % len(COLORS)], branch.labels[:i].count(label)
        name = f"start of {ORDINALS[before]}{label}" if before < len(ORDINALS) else None
        for part, stable in _runs(branch.stable):
            style: Any = "-" if stable else UNSTABLE
            ax.plot(branch.values[part], branch.points[part, i, 1], color=color, ls=style, lw=1.2, label=name)
        for end in branch.ends:
            _mark(ax, end, end.points[i].x, color)
    ax.set_ylabel("position $x$ at the switching")


def _multipliers(ax: Axes, branch: Branch) -> None:
    sizes = np.abs(branch.multipliers)
    for column in (0, 1):
        for part, stable in _runs(branch.stable):
            ax.plot(branch.values[part], sizes[part, column], color="black", ls="-" if stable else UNSTABLE, lw=1.2)
    for end, row in zip(branch.ends, (0, -1), strict=True):
        for size in sizes[row]:
            _mark(ax, end, size, "black")
    top = max(float(sizes.max()), 1e-12)
    if top > 0.7:
        ax.axhline(1, color="0.6", lw=0.6, zorder=0)
    ax.set_ylim(-0.04 * top, 1.18 * top)
    ax.set_ylabel("moduli of the multipliers")


def _mark(ax: Axes, end: BranchEnd, height: float, color: str) -> None:
    if end.kind in MARKERS:
        style: dict[str, Any] = {"ms": 5.0, "mfc": color, "mec": "white", "mew": 0.5, "zorder": 5, "clip_on": False}
        ax.plot(end.value, height, linestyle="none", marker=MARKERS[end.kind], **style)


def _next_words(ax: Axes, branch: Branch) -> None:
    """Name the orbits on the branch and behind its ends, above the axes."""
    low, high = branch.values.min(), branch.values.max()
    style: dict[str, Any] = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points", "fontsize": 8}
    ax.annotate(branch.word, (0.5 * (low + high), 1), (0, 4), ha="center", **style)
    for end in branch.ends:
        words = end.kind if end.kind in (NO_CONVERGENCE, MOST) else end.beyond
        if words:
            ax.annotate(words, (end.value, 1), (0, 4), ha="center", **style)


def _runs(stable: np.ndarray) -> list[tuple[slice, bool]]:
    """Return the stretches of equal stability, each with the point that it shares with the next one."""
    cuts = [0, *(np.flatnonzero(np.diff(stable)) + 1), len(stable)]
    return [(slice(a, min(b + 1, len(stable))), bool(stable[a])) for a, b in pairwise(cuts)]


def _legend(drawing: Figure, ax: Axes, branch: Branch) -> None:
    handles, labels = ax.get_legend_handles_labels()
    entries = dict(zip(reversed(labels), reversed(handles), strict=True))
    entries = {label: entries[label] for label in dict.fromkeys(labels)}
    for kind in dict.fromkeys(end.kind for end in branch.ends if end.kind in MARKERS):
        entries[kind] = Line2D([], [], linestyle="none", marker=MARKERS[kind], ms=5.0, color="black")
    style: dict[str, Any] = {"frameon": False, "handlelength": 1.6, "columnspacing": 1.4, "borderpad": 0.1}
    columns = min(len(entries), 6)
    drawing.legend(list(entries.values()), list(entries), loc="outside lower center", ncols=columns, **style)
