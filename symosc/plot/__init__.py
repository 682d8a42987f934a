"""Figures: of motions in the paper's panels (`figure`), of branches, windows, grazing curves, cross-checks and sweeps.

May import: everything up to certificates. matplotlib is loaded with this package, and with nothing before it.

One more figure: a module of its own that returns a matplotlib Figure; its function is named here, and registered for
the answer whose ``.plot()`` it is (`symosc.display.drawable`).

Examples
--------
>>> from symosc import plot, simulate
>>> drawing = plot.figure(simulate("fig5", t_end=7))
>>> len(drawing.axes)
4
"""

from symosc.certificates.certificate import Certificate
from symosc.crosschecks.report import CrossCheck
from symosc.display.drawable import register
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
from symosc.plot.many import events_figure, summary_figure
from symosc.plot.maps import basin_figure, map_figure
from symosc.plot.proof import certificate_figure
from symosc.plot.region import region_figure
from symosc.plot.sweep import sweep_figure
from symosc.plot.swept import swept_figure
from symosc.plot.windows import window_figure
from symosc.simulation.event_table import EventTable
from symosc.simulation.summary import Summary
from symosc.simulation.trajectory import Trajectory

__all__ = [
    "MOST_DRAWN_EVENTS",
    "basin_figure",
    "bifurcation_figure",
    "branch_figure",
    "certificate_figure",
    "check_panels",
    "check_suffix",
    "crosscheck_figure",
    "curve_figure",
    "default_panels",
    "events_figure",
    "figure",
    "figure_grazing_curve",
    "map_figure",
    "orbit_figure",
    "region_figure",
    "save",
    "simulated",
    "summary_figure",
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
register(EventTable, events_figure)
register(Summary, summary_figure)
register(Certificate, certificate_figure)
register("symosc.symbolic.grazing_answers.ParameterRegion", region_figure)  # by name: it would load sympy
register("symosc.sweeps.dataset.SweptDataset", swept_figure)  # by name: it would load what sweeps need


def __dir__() -> list[str]:
    """Return the public names, for completion."""
    return __all__
