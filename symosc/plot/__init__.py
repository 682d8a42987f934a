"""Figures: of motions in the paper's panels (`figure`), branches, windows, grazing curves,
cross-checks and so on.

May import: everything up to reference. matplotlib is loaded with a figure's module, not earlier.

Each function that draws returns a matplotlib Figure and raises ParameterError for bad arguments.
``ax=`` are axes of your own to draw one panel into; their figure is returned. ``panels=`` are
letters of the panels to draw.

To add a figure, write a module with such a function, and name the function in ``__init__.pyi``, and
here if a result's ``.plot()`` calls it (`symosc.base.display.drawable`). A figure loads only what it
needs: parts of scipy take longer to load than a figure takes to draw.

Examples
--------
>>> from symosc import plot, simulate
>>> drawing = plot.figure(simulate("fig5", t_end=7))
>>> len(drawing.axes)
4
"""

from functools import partial
from typing import Any

import lazy_loader

from symosc.base.display.drawable import register
from symosc.plot.backend import backend_error

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    try:
        return _load(name)
    except ValueError as error:
        unknown = backend_error(error)
        if unknown is None:
            raise
        raise unknown from None


#: What ``.plot()`` of an answer calls, by names: neither the answers nor the figures are loaded for
#: it.
DRAWN_BY = {
    "symosc.scenes.Scene": "figure",
    "symosc.simulation.trajectory.Trajectory": "figure",
    "symosc.simulation.tables.EventTable": "events_figure",
    "symosc.simulation.tables.Summary": "summary_figure",
    "symosc.orbits.periodic_orbit.PeriodicOrbit": "orbit_figure",
    "symosc.orbits.branch.Branch": "branch_figure",
    "symosc.orbits.border.Border": "border_figure",
    "symosc.grazing.window.GrazingWindow": "window_figure",
    "symosc.grazing.curve.GrazingCurve": "figure_grazing_curve",
    "symosc.symbolic.inverse.ParameterRegion": "region_figure",
    "symosc.crosschecks.report.CrossCheck": "crosscheck_figure",
    "symosc.analysis.fitting.fit.Fit": "fit_figure",
    "symosc.analysis.response.FrequencyResponse": "response_figure",
    "symosc.certificates.certificate.Certificate": "certificate_figure",
    "symosc.certificates.atlas.Atlas": "atlas_figure",
    "symosc.sweeps.output.SweptDataset": "swept_figure",
}


def _draw(figure_name: str, answer: object, /, *given: Any, **options: Any) -> Any:
    """Draw the result `answer` by the function `figure_name` of `symosc.plot`, with arguments
    `given`, `options`.
    """
    return __getattr__(figure_name)(answer, *given, **options)


def _write(answer: Any, path: Any) -> Any:
    """Write the page of a cross-check to the file `path`, and return that path."""
    from symosc.plot.judged import write_page

    return write_page(answer, path)


for _kind, _name in DRAWN_BY.items():
    register(_kind, partial(_draw, _name))
register("symosc.crosschecks.report.CrossCheck", _write, "write")
