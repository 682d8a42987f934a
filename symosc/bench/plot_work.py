"""The picture of work and precision: error against time per event, a panel per scene, a curve per solver."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from symosc.aliases import Record
from symosc.bench import ours
from symosc.plot.drawing import STYLE

COLUMNS = 3
#: A colour per library, a mark per method of it.
COLOURS = ("#b2182b", "#2166ac", "#e08214", "#1b7837", "#762a83", "#8c510a")
POINT_MARKS = "os^Dv"
#: What is more exact than this (a double has no more digits) is drawn here, what is worse than the other there.
BEST, WORST = 1e-17, 1.0
RAW = ", raw"


def figure(result: Record) -> Figure:
    """Draw the result of `symosc.bench.work_precision.run`.

    A filled mark is a solver with the precautions that its traps ask for, a hollow one the same as it comes. A cross
    over a mark: events were missed or invented; no line leads there. Runs that failed have no time; each panel says how
    many there were.

    Parameters
    ----------
    result : dict

    Returns
    -------
    matplotlib.figure.Figure
    """
    scenes = list(dict.fromkeys(row["scene"] for row in result["rows"]))
    looks = _looks(list(dict.fromkeys(row["solver"] for row in result["rows"])))
    columns = min(COLUMNS, len(scenes) + 1)
    lines = -(-(len(scenes) + 1) // columns)  # one cell is for the legend
    with rc_context(STYLE):
        layout = ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.05)
        drawing = Figure(figsize=(7.2 / COLUMNS * columns, 2.6 * lines), layout=layout)
        grid = drawing.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
        for ax, scene in zip(grid.flat, scenes, strict=False):
            _panel(ax, scene, [row for row in result["rows"] if row["scene"] == scene], looks)
        for ax in grid.flat[len(scenes) :]:
            ax.set_axis_off()
        for ax in grid[:, 0]:
            ax.set_ylabel("largest error")
        for ax in grid.flat:
            ax.tick_params(labelbottom=True)
        drawing.supxlabel("time per event [µs]", fontsize=STYLE["axes.labelsize"])
        _legend(grid[-1, -1], looks)
    return drawing


def _looks(solvers: Sequence[str]) -> dict[str, Record]:
    """Return colour and mark of each solver; the raw one looks like the other of that name."""
    libraries: dict[str, list[str]] = {}
    looks: dict[str, Record] = {}
    own = [solver.name for solver in ours.SOLVERS]
    for name in dict.fromkeys(solver.removesuffix(RAW) for solver in solvers):
        if name in own:
            looks[name] = {"color": "black", "marker": "*P"[own.index(name) % 2], "markersize": 9 - 3 * own.index(name)}
            continue
        methods = libraries.setdefault(name.split()[0].rstrip(","), [])
        colour = COLOURS[list(libraries).index(name.split()[0].rstrip(",")) % len(COLOURS)]
        looks[name] = {"color": colour, "marker": POINT_MARKS[len(methods) % len(POINT_MARKS)], "markersize": 4}
        methods.append(name)
    return looks


def _panel(ax: Axes, scene: str, rows: Sequence[Record], looks: dict[str, Record]) -> None:
    for solver in dict.fromkeys(row["solver"] for row in rows):
        look = dict(looks[solver.removesuffix(RAW)])
        drawn = [row for row in rows if row["solver"] == solver and row["us_per_event"] is not None]
        if any(row["raw"] for row in drawn):
            look |= {"linestyle": ":", "markerfacecolor": "white"}
        above: Record = {"zorder": 4} if look["color"] == "black" else {}
        right = [row for row in drawn if not row["missed"] and not row["invented"]]
        wrong = [row for row in drawn if row not in right]
        ax.plot(*_points(right), linewidth=0.7, markeredgewidth=0.6, **look, **above)
        ax.plot(*_points(wrong), markeredgewidth=0.6, **look | {"linestyle": "none"}, **above)
        ax.plot(*_points(wrong), "x", color="black", markersize=6, markeredgewidth=0.7, zorder=5)
    failed = sum(bool(row["failure"]) for row in rows)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(BEST / 3, WORST * 3)
    ax.set_yticks([10.0**n for n in range(-16, 1, 4)])
    ax.minorticks_off()
    ax.grid(linewidth=0.3, color="0.85")
    ax.set_title(scene, loc="left", pad=4)
    if failed:
        ax.text(
            0.02,
            0.03,
            f"{failed} run{'s' * (failed > 1)} failed",
            transform=ax.transAxes,
            ha="left",
            va="bottom",
            fontsize=7,
        )


def _points(rows: Sequence[Record]) -> tuple[list[float], list[float]]:
    errors = [WORST if row["error"] is None else min(max(row["error"], BEST), WORST) for row in rows]
    return [row["us_per_event"] for row in rows], errors


def _legend(ax: Axes, looks: dict[str, Record]) -> None:
    entries = [(Line2D([], [], linewidth=0.7, **look), name) for name, look in looks.items()]
    plain: Record = {"color": "0.3", "linestyle": "none", "markersize": 4}
    entries.append((Line2D([], [], marker="o", markerfacecolor="white", **plain), "hollow: as it comes"))
    entries.append((Line2D([], [], marker="x", **plain | {"color": "black"}), "events missed or invented"))
    handles, labels = zip(*entries, strict=True)
    ax.legend(handles, labels, loc="upper left", fontsize=7.0, frameon=False, borderaxespad=0.0, labelspacing=0.3)
