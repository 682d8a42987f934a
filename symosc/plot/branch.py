"""Figures of branches of periodic orbits."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from symosc.arguments import public
from symosc.orbits.branch import MOST, NO_CONVERGENCE, Branch, BranchEnd
from symosc.orbits.floquet import NEAR_ONE
from symosc.plot.drawing import Drawing, figure_of, read_panels, style_for

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
# Stability -> line style; the styles are told apart without colours.
STYLES: dict[str, Any] = {"stable": "-", "marginal": "-.", "not stable": (0, (4, 2))}
UNIT = (0, (1, 2))
# Points at which the multipliers are drawn between two orbits of the branch.
BETWEEN = 24


@public
def branch_figure(branch: Branch, panels: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a branch: position at each switching and moduli of the multipliers over the parameter.

    Solid lines are stable orbits. Dash-dotted ones are marginal: a multiplier is on the unit circle, which is dotted.
    Dashed ones are not stable. Marks tell why the branch ends. The words above the last panel name the orbit on the
    branch and those behind its ends.

    Parameters
    ----------
    branch : Branch
    panels, ax : optional
        As for `symosc.plot.figure`. The panels are a positions, b multipliers. Default: both, with `ax` b.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If that is no Branch, or there is no such panel.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene, plot
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.9, 4.1))
    >>> [axes.get_ylabel() for axes in plot.branch_figure(branch).axes]
    ['position $x$ at the switching', 'moduli of the multipliers']
    """
    panels = read_panels(panels, tuple(PANELS), ax, alone="b")
    if ax is not None:
        drawing = figure_of(ax)
        _panel(ax, branch, panels)
        _next_words(ax, branch)
        ax.legend(**_legend([ax], branch))
        return drawing
    with style_for(ax):
        layout = ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.04)
        drawing = Drawing(figsize=(3.5 * len(panels), 3.1), layout=layout)
        row = drawing.subplots(1, len(panels), squeeze=False)[0]
        for axes, letter, shown in zip(row, panels, "ab", strict=False):
            _panel(axes, branch, letter)
            axes.set_title(f"({shown})", loc="left", x=-0.12, pad=4)
            axes.tick_params(labelfontfamily="STIXGeneral")
        _next_words(row[-1], branch)
        entries = _legend(row, branch)
        style: dict[str, Any] = {"frameon": False, "handlelength": 1.6, "columnspacing": 1.4, "borderpad": 0.1}
        drawing.legend(
            **entries, loc="outside lower center", ncols=min(len(entries["labels"]), 3 * len(panels)), **style
        )
    return drawing


def _panel(ax: Axes, branch: Branch, letter: str) -> None:
    PANELS[letter](ax, branch)
    ax.set_xlabel(PARAMETER_LABELS.get(branch.parameter, f"${branch.parameter}$"))
    for end in branch.ends:
        if end.kind in MARKERS:
            ax.axvline(end.value, color="0.6", lw=0.6, zorder=0)


def _positions(ax: Axes, branch: Branch) -> None:
    for i, label in enumerate(branch.labels):
        color, before = COLORS[i % len(COLORS)], branch.labels[:i].count(label)
        name = f"start of {ORDINALS[before]}{label}" if before < len(ORDINALS) else None
        for part, state in _runs(stability(branch)):
            ax.plot(branch.values[part], branch.points[part, i, 1], color=color, ls=STYLES[state], lw=1.2, label=name)
        for end in branch.ends:
            _mark(ax, end, end.points[i].x, color)
        last = int(np.argmax(branch.values))
        place = branch.values[last], branch.points[last, i, 1]
        ax.annotate(f"$P_{label[1:]}$", place, (4, 0), textcoords="offset points", va="center", fontsize=8)
    ax.margins(x=0.09)
    ax.set_ylabel("position $x$ at the switching")


def _multipliers(ax: Axes, branch: Branch) -> None:
    for part, state in _runs(stability(branch)):
        values, sizes = multiplier_curves(branch.values[part], branch.multipliers[part])
        for column in (0, 1):
            ax.plot(values, sizes[:, column], color="black", ls=STYLES[state], lw=1.2)
    sizes = np.abs(branch.multipliers)
    for end, row in zip(branch.ends, (0, -1), strict=True):
        for size in sizes[row]:
            _mark(ax, end, size, "black")
    ax.axhline(1, color="0.4", lw=0.8, ls=UNIT, zorder=0, label="unit circle")
    top = max(float(sizes.max()), 1.0)
    ax.set_ylim(-0.04 * top, 1.12 * top)
    ax.set_ylabel("moduli of the multipliers")


PANELS = {"a": _positions, "b": _multipliers}


def multiplier_curves(values: np.ndarray, multipliers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return many parameter values along a stretch of a branch, and both moduli there, the larger one first.

    Trace and determinant of the monodromy matrix are smooth along a branch and are interpolated; the multipliers are
    not where a real pair turns complex, and follow from them.
    """
    trace, determinant = multipliers.sum(axis=1).real, multipliers.prod(axis=1).real
    columns = np.column_stack([values, trace, determinant])
    steps = np.linalg.norm(
        np.diff(columns, axis=0) / (np.ptp(columns, axis=0) + (np.ptp(columns, axis=0) == 0)), axis=1
    )
    from scipy.interpolate import Akima1DInterpolator  # takes longer to load than most figures to draw

    keep = np.concatenate([[True], steps > 1e-12])
    along = np.cumsum(np.concatenate([[0.0], steps]))[keep]
    if len(along) > 2:
        fine = np.unique(np.concatenate([np.linspace(a, b, BETWEEN) for a, b in pairwise(along)]))
        columns = Akima1DInterpolator(along, columns[keep], method="makima")(fine)
    values, trace, determinant = columns.T
    root = np.sqrt((trace * trace - 4 * determinant).astype(complex))
    return values, np.sort(np.abs(np.column_stack([trace + root, trace - root])) / 2)[:, ::-1]


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


def stability(branch: Branch) -> np.ndarray:
    """Return a key of `STYLES` for each orbit of a branch.

    What is not stable is marginal if no multiplier is outside the unit circle by more than rounding.
    """
    sizes = np.abs(branch.multipliers).max(axis=1)
    return np.where(branch.stable, "stable", np.where(sizes <= 1 + NEAR_ONE, "marginal", "not stable"))


def _runs(states: np.ndarray) -> list[tuple[slice, str]]:
    """Return the stretches of equal stability, each with the point that it shares with the next one."""
    cuts = [0, *(np.flatnonzero(states[1:] != states[:-1]) + 1), len(states)]
    return [(slice(a, min(b + 1, len(states))), str(states[a])) for a, b in pairwise(cuts)]


def _legend(row: Sequence[Axes], branch: Branch) -> dict[str, list[Any]]:
    """Return handles and labels: switching points, stability, the unit circle, and what the marks of the ends mean."""
    entries: dict[str, Any] = {}
    for ax in row:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(str(label), handle)
    unit = entries.pop("unit circle", None)
    for kind in dict.fromkeys(end.kind for end in branch.ends if end.kind in MARKERS):
        entries[kind] = Line2D([], [], linestyle="none", marker=MARKERS[kind], ms=5.0, color="black")
    states = stability(branch)
    for name, style in STYLES.items():
        if name in states:
            entries[name] = Line2D([], [], color="black", ls=style, lw=1.2)
    if unit is not None:
        entries["unit circle"] = unit
    return {"handles": list(entries.values()), "labels": list(entries)}
