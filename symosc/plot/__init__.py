"""Figures: of motions in the paper's panels (`figure`), branches, windows, grazing curves,
cross-checks and so on.

May import: everything up to reference. matplotlib is loaded with a figure's module, not earlier.

Each function that draws returns a matplotlib Figure and raises ParameterError for bad arguments.
``ax=`` are axes of your own to draw one panel into; their figure is returned. ``panels=`` are
letters of the panels to draw.

To add a figure, write a module with such a function, and name the function in ``__init__.pyi``, and
as `_drawn_by` in the class of the results whose ``.plot()`` calls it
(`symosc.base.display.drawable`). A figure loads only what it needs: parts of scipy take longer to
load than a figure takes to draw.

Examples
--------
>>> from symosc import plot, simulate
>>> drawing = plot.figure(simulate("fig5", t_end=7))
>>> len(drawing.axes)
4
"""

from typing import Any

import lazy_loader

from symosc.plot.backend import backend_error

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Load a function of this package when it is first asked for; ParameterError if it is matplotlib
    that fails, for the name of an unknown backend.
    """
    try:
        return _load(name)
    except ValueError as error:
        unknown = backend_error(error)
        if unknown is None:
            raise
        raise unknown from None
