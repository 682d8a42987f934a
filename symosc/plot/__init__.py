"""Figures: of motions in the paper's panels (`figure`), branches, windows, grazing curves, cross-checks and so on.

May import: everything up to reference. matplotlib is loaded with this package, and with nothing before it.

One more figure: a module of its own that returns a matplotlib Figure; its function is named here, and registered for
the answer whose ``.plot()`` it is (`symosc.drawable`).

Examples
--------
>>> from symosc import plot, simulate
>>> drawing = plot.figure(simulate("fig5", t_end=7))
>>> len(drawing.axes)
4
"""

from symosc.crosschecks.report import CrossCheck
from symosc.drawable import register
from symosc.grazing.curve import GrazingCurve
from symosc.grazing.window import GrazingWindow
from symosc.orbits.branch import Branch
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.plot.bifurcation import bifurcation_figure, curve_figure
from symosc.plot.branch import branch_figure
from symosc.plot.crosscheck import figure as crosscheck_figure
from symosc.plot.curve import figure_grazing_curve
from symosc.plot.drawing import check_suffix, save
from symosc.plot.figures import MOST_DRAWN_EVENTS, check_panels, default_panels, figure, orbit_figure, simulated
from symosc.plot.maps import basin_figure, map_figure
from symosc.plot.region import region_figure
from symosc.plot.score import score_figure
from symosc.plot.sweep import sweep_figure
from symosc.plot.swept import swept_figure
from symosc.plot.windows import window_figure
from symosc.simulation.trajectory import Trajectory

__all__ = [
    "MOST_DRAWN_EVENTS",
    "basin_figure",
    "bifurcation_figure",
    "branch_figure",
    "check_panels",
    "check_suffix",
    "crosscheck_figure",
    "curve_figure",
    "default_panels",
    "figure",
    "figure_grazing_curve",
    "map_figure",
    "orbit_figure",
    "region_figure",
    "save",
    "score_figure",
    "simulated",
    "sweep_figure",
    "swept_figure",
    "window_figure",
]

# What ``.plot()`` of an answer calls.
register(Trajectory, figure)
register(PeriodicOrbit, orbit_figure)
register(Branch, branch_figure)
register(GrazingWindow, window_figure)
register(GrazingCurve, figure_grazing_curve)
register(CrossCheck, crosscheck_figure)
register("symosc.symbolic.grazing_answers.ParameterRegion", region_figure)  # by name: it would load sympy
