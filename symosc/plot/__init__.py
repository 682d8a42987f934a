"""Figures: of motions in the paper's panels (`figure`), of branches, windows, grazing curves and cross-checks.

May import: everything up to grazing. matplotlib is loaded with this package, and with nothing before it.

One more figure: a module of its own that returns a matplotlib Figure; its function is named here.

Examples
--------
>>> from symosc import plot, simulate
>>> drawing = plot.figure(simulate("fig5", t_end=7))
>>> len(drawing.axes)
4
"""

from symosc.plot.branch import branch_figure
from symosc.plot.curve import figure_grazing_curve
from symosc.plot.drawing import check_suffix, save
from symosc.plot.figures import MOST_DRAWN_EVENTS, check_panels, default_panels, figure, orbit_figure, simulated
from symosc.plot.windows import sweep_figure, window_figure

__all__ = [
    "MOST_DRAWN_EVENTS",
    "branch_figure",
    "check_panels",
    "check_suffix",
    "default_panels",
    "figure",
    "figure_grazing_curve",
    "orbit_figure",
    "save",
    "simulated",
    "sweep_figure",
    "window_figure",
]
