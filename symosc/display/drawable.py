"""Answers that show themselves: drawn by ``.plot()``, and as a page in notebooks.

What draws them is in `symosc.plot`, and their pages are in `symosc.plot.notebooks`, above the answers: they register a
function for each kind of them here, and no answer needs to know of figures. `symosc` itself says what is to be loaded
for that, when the first one is shown.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

Show = Callable[..., Any]
#: What draws each kind of answer, and what makes its page; filled by `symosc.plot` and `symosc.plot.notebooks`.
_drawers: dict[str, Show] = {}
_pages: dict[str, Show] = {}
#: What writes a page about each kind of answer into a file; filled by `symosc.plot`.
_writers: dict[str, Show] = {}
#: Called before the first drawing or page; they load what registers.
loaders: list[Callable[[], object]] = []
page_loaders: list[Callable[[], object]] = []


def register(kind: type | str, draw: Show) -> None:
    """Let ``answer.plot(**options)`` return ``draw(answer, **options)`` for answers of a kind.

    A kind whose module is slow to load is given by its name, such as "symosc.simulation.trajectory.Trajectory".
    """
    _drawers[kind if isinstance(kind, str) else _name(kind)] = draw


def register_page(kind: type | str, page: Show) -> None:
    """Let notebooks show ``page(answer)``, which is HTML, for answers of a kind; `kind` as for `register`."""
    _pages[kind if isinstance(kind, str) else _name(kind)] = page


def register_writer(kind: type | str, write: Show) -> None:
    """Let ``answer.to_html(path)`` return ``write(answer, path)`` for answers of a kind; `kind` as for `register`."""
    _writers[kind if isinstance(kind, str) else _name(kind)] = write


def _name(kind: type) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"


def _found(answer: object, shows: dict[str, Show], load: list[Callable[[], object]]) -> Show | None:
    while load:
        load.pop()()
    return next((shows[name] for name in map(_name, type(answer).__mro__) if name in shows), None)


class Drawable:
    """An answer that draws itself, and shows itself in notebooks."""

    __slots__ = ()

    def plot(self, **options: Any) -> Any:
        """Draw this: the same as the function of `symosc.plot` for it.

        Parameters
        ----------
        **options
            As for that function: `plot.figure` for a Trajectory, `plot.orbit_figure` for a PeriodicOrbit,
            `plot.branch_figure` for a Branch, `plot.window_figure` for a GrazingWindow, `plot.figure_grazing_curve` for
            a GrazingCurve, `plot.region_figure` for a ParameterRegion, `plot.crosscheck_figure` for a CrossCheck,
            `plot.events_figure` for an EventTable, `plot.summary_figure` for a Summary and `plot.certificate_figure`
            for a Certificate. Those with panels take ``panels=``, and all take ``ax=`` for axes of your own, which hold
            one panel.

        Returns
        -------
        matplotlib.figure.Figure

        Examples
        --------
        >>> from symosc import simulate
        >>> drawing = simulate("fig5", t_end=7).plot(panels="ac")
        >>> [axes.get_xlabel() for axes in drawing.axes]
        ['time $t$', 'displacement $x$']
        """
        draw = _found(self, _drawers, loaders)
        if draw is None:
            raise NotImplementedError(f"nothing draws a {type(self).__name__}")
        return draw(self, **options)

    def _repr_html_(self) -> str | None:
        """Return the page that notebooks show; None where there is none, and they show the repr."""
        page = _found(self, _pages, page_loaders)
        return None if page is None else str(page(self))

    def __dir__(self) -> list[str]:
        """Return the names that a user is meant to use, for completion."""
        return sorted(name for name in super().__dir__() if not name.startswith("_"))


class Reportable:
    """An answer that writes a page about itself."""

    __slots__ = ()

    def to_html(self, path: str | Path) -> Path:
        """Write a page about this: one HTML file that needs nothing else, readable on a phone.

        Parameters
        ----------
        path : path

        Returns
        -------
        Path

        Raises
        ------
        OutputError
            If the file cannot be written.

        Examples
        --------
        >>> from tempfile import TemporaryDirectory
        >>> import numpy as np
        >>> from symosc import crosscheck, simulate
        >>> t = np.linspace(0, 3, 40)
        >>> x, v = simulate("fig5", t_end=3)(t)
        >>> with TemporaryDirectory() as folder:
        ...     crosscheck("fig5", t, x, v).to_html(f"{folder}/check.html").name
        'check.html'
        """
        write = _found(self, _writers, loaders)
        if write is None:
            raise NotImplementedError(f"nothing writes a page about a {type(self).__name__}")
        return Path(write(self, path))
