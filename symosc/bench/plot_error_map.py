"""A picture of `symosc.bench.error_map`."""

from __future__ import annotations

from math import nan
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patheffects import withStroke
from scipy.ndimage import distance_transform_edt, label

from symosc.aliases import Record
from symosc.bench.error_map import NEAREST, place_of
from symosc.plot.drawing import STYLE

#: Range of the colours, as powers of ten.
COLOUR_RANGE = (-17, 0)
UNSEEN = "0.88"
# Label and place of the marks of both axes: numbers next to 1 are given by their distance from it.
RATIO_TICKS = (
    ("0.01", place_of(0.01)),
    (r"$1{-}10^{-3}$", place_of(1, -1e-3)),
    (r"$1{-}10^{-6}$", place_of(1, -1e-6)),
    ("1", place_of(1)),
    (r"$1{+}10^{-6}$", place_of(1, 1e-6)),
    (r"$1{+}10^{-3}$", place_of(1, 1e-3)),
    ("100", place_of(100)),
)
ZETA_TICKS = (
    (r"$10^{-9}$", place_of(1e-9)),
    (r"$10^{-6}$", place_of(1e-6)),
    (r"$10^{-3}$", place_of(1e-3)),
    ("0.5", place_of(0.5)),
    (r"$1{-}10^{-5}$", place_of(1, -1e-5)),
    ("1", place_of(1)),
    (r"$1{+}10^{-5}$", place_of(1, 1e-5)),
    ("100", place_of(100)),
)
ROWS = (("cheap", "the cheap formula everywhere"), ("symosc", "symosc"))
FORMULA_LABELS = {"apart": "cheap", "careful": "careful", "series": "series"}
# Regions with less than this part of a panel's width around their middle get no name.
LEAST_NAMED = 0.05
OUTLINE = [withStroke(linewidth=2.0, foreground="black")]


def figure(result: Record) -> Figure:
    """Draw the errors of the cheap formula and of symosc, with the borders that symosc draws between its formulas.

    Parameters
    ----------
    result : dict
        From `symosc.bench.error_map.run`.
    """
    taus = result["taus"]
    with rc_context(STYLE):
        drawing = Figure(figsize=(7.0, 4.9), layout=ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.04))
        grid = drawing.subplots(2, len(taus), sharex=True, sharey=True, squeeze=False)
        for row, (key, name) in enumerate(ROWS):
            for column, tau in enumerate(taus):
                ax = grid[row, column]
                mesh = _errors(ax, result, key, column)
                _borders(ax, result, column, shipped=key == "symosc")
                largest = float(np.nanmax(np.array(result[key][column])))
                ax.set_title(rf"$\omega_0\tau = {_number(tau)}$: up to ${_number(largest)}$", fontsize=8.0)
                ax.tick_params(labelfontfamily="STIXGeneral", labelsize=7.0, direction="out")
            grid[row, 0].set_ylabel(rf"{name}" + "\n" + r"damping ratio $\zeta = c/(2m\omega_0)$")
        for ax, ticks in ((grid[0, 0].xaxis, RATIO_TICKS), (grid[0, 0].yaxis, ZETA_TICKS)):
            ax.set_ticks([place for _, place in ticks], [label for label, _ in ticks])
        for ax in grid[1]:
            ax.tick_params(axis="x", labelrotation=90)
            ax.set_xlabel(r"$\Omega/\omega_0$")
        bar = drawing.colorbar(mesh, ax=grid, pad=0.01, aspect=40, extend="max")
        bar.set_label(r"$\log_{10}$ of the error of the flow (its worst entire function, against 50 digits)")
        bar.ax.tick_params(labelfontfamily="STIXGeneral")
        return drawing


def _errors(ax: Axes, result: Record, key: str, column: int) -> Any:
    errors = np.array(result[key][column])
    ax.set_facecolor(UNSEEN)
    logs = np.log10(np.maximum(errors, 10.0 ** COLOUR_RANGE[0]))
    return ax.pcolormesh(
        result["ratio"],
        result["zeta"],
        logs,
        norm=Normalize(*COLOUR_RANGE),
        cmap="viridis",
        shading="nearest",
        rasterized=True,
    )


def _borders(ax: Axes, result: Record, column: int, shipped: bool) -> None:
    """Draw the border of the cheap formula; for what is shipped all borders, and the names of what is between them."""
    chosen = np.array(result["formulas"][column])
    ratios, zetas = np.array(result["border_ratio"]), np.array(result["border_zeta"])
    for formula in ("apart", "careful") if shipped else ("apart",):  # two borders between three formulas
        inside = np.where(chosen == "", nan, chosen == formula)
        if np.nanmin(inside) < np.nanmax(inside):
            border = ax.contour(ratios, zetas, inside, [0.5], colors="white", linewidths=1.0)
            border.set_path_effects([*OUTLINE])
    for formula, name in FORMULA_LABELS.items() if shipped else ():
        parts, count = label(chosen == formula)
        for part in range(1, count + 1):
            _name(ax, ratios, zetas, parts == part, name)
    _name(ax, ratios, zetas, chosen == "", "longer than one period", color="0.25", rotation=90, path_effects=None)
    if not shipped:
        over = np.broadcast_to(zetas[:, np.newaxis] > NEAREST, chosen.shape) & (chosen != "")
        _name(ax, ratios, zetas, over, "overdamped:\nno such formula", color="0.25", path_effects=None)


def _name(ax: Axes, ratios: np.ndarray, zetas: np.ndarray, inside: np.ndarray, name: str, **style: Any) -> None:
    """Write a name where a region is widest, if it is wide enough."""
    depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
    if depth.max() < LEAST_NAMED * len(ratios):
        return
    i, j = (round(float(np.mean(index))) for index in np.nonzero(depth > depth.max() - 1))
    look: Record = {"ha": "center", "va": "center", "fontsize": 7.5, "linespacing": 1.0}
    look |= {"color": "white", "path_effects": OUTLINE}
    ax.text(ratios[j], zetas[i], name, **(look | style))


def _number(value: float) -> str:
    """Return a number for math text: 1, 6 or a power of ten."""
    if 0.1 <= value < 100:
        return f"{value:.0f}"
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"10^{{{int(exponent)}}}" if mantissa == "1" else rf"{mantissa}{{\times}}10^{{{int(exponent)}}}"
