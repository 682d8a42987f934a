"""Base classes of results that display themselves: by ``.plot()``, and as a page in notebooks.

Modules that are loaded when a result is first shown register here what shows each kind: no answer
imports a figure.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, TypeVar

Item = TypeVar("Item")
# Number of entries shown of a listing that has more than the second number of them.
SHOWN = 3
MOST_SHOWN = 10
#: The ways to show a result, each with the module that registers functions for it when it is
#: loaded.
MODULES = {"draw": "symosc.plot", "write": "symosc.plot", "page": "symosc.plot.notebooks"}
#: The registered functions by the way to show a result, and the qualified name of its class.
_registered: dict[tuple[str, str], Callable[..., Any]] = {}


def register(
    kind: type | str, show: Callable[..., Any], what: Literal["draw", "page", "write"] = "draw"
) -> None:
    """Register what shows the results of a class, which may be given by its qualified name.

    "draw": ``result.plot(**options)`` returns ``show(result, **options)``. "page": notebooks show
    the HTML that ``show(result)`` returns. "write": ``result.to_html(path)`` returns ``show(result,
    path)``.
    """
    _registered[
        what, kind if isinstance(kind, str) else f"{kind.__module__}.{kind.__qualname__}"
    ] = show


def _found(result: object, what: str) -> Callable[..., Any] | None:
    """Return the function that `register` got for the class of a result and for `what`; None if
    there is none.
    """
    import_module(MODULES[what])
    names = (f"{kind.__module__}.{kind.__qualname__}" for kind in type(result).__mro__)
    return next((_registered[what, name] for name in names if (what, name) in _registered), None)


def _notebook_page(result: object) -> Any:
    """Return the notebook page of a result as HTML, or None, in which case its repr is shown."""
    page = _found(result, "page")
    if page is None:
        return None
    return page(result)


class Drawable:
    """A result with a plot and a notebook page."""

    __slots__ = ()

    def plot(self, *given: Any, **options: Any) -> Any:
        """Draw the result, by the function of `symosc.plot` for it.

        Parameters
        ----------
        *given, **options
            As for that function: `plot.figure` for a Trajectory, `plot.orbit_figure` for a
            PeriodicOrbit, `plot.branch_figure` for a Branch, `plot.window_figure` for a
            GrazingWindow and so on. Those with panels take ``panels=``, and all take ``ax=`` for
            axes of your own, which hold one panel.

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
        draw = _found(self, "draw")
        if draw is None:
            raise NotImplementedError(f"nothing draws a {type(self).__name__}")
        return draw(self, *given, **options)

    _repr_html_ = _notebook_page

    def __dir__(self) -> list[str]:
        """Return the names that a user is meant to use, for completion."""
        return sorted(name for name in super().__dir__() if not name.startswith("_"))


class Comparable:
    """A base class for dataclasses: instances are equal if all their public fields are, and NaN
    equals NaN.
    """

    __slots__ = ()
    __hash__ = None  # type: ignore[assignment]  # arrays have none

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        names = [each.name for each in fields(self) if not each.name.startswith("_")]  # type: ignore[arg-type]
        return all(_same(getattr(self, name), getattr(other, name)) for name in names)


def _same(one: Any, other: Any) -> bool:
    """Return whether two values are equal: arrays as a whole (NaN equals NaN), others by ==, or
    else by their repr.
    """
    if hasattr(one, "dtype"):
        from numpy import array_equal

        return bool(array_equal(one, other, equal_nan=one.dtype.kind == "f"))
    return bool(one == other) or repr(one) == repr(other)


class Listing(tuple[Item, ...]):
    """A tuple of many entries whose text shows the first ones and their number.

    Examples
    --------
    >>> from symosc import simulate
    >>> events = simulate("fig9", t_end=900).events
    >>> len(events) > 1000, len(repr(events)) < 1000
    (True, True)
    """

    def __repr__(self) -> str:
        if len(self) <= MOST_SHOWN:
            return super().__repr__()
        return f"({', '.join(map(repr, self[:SHOWN]))}, ... {len(self):,} in all)"

    _repr_html_ = _notebook_page


class Reportable:
    """A result that can be written as an HTML page."""

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
        write = _found(self, "write")
        if write is None:
            raise NotImplementedError(f"nothing writes a page about a {type(self).__name__}")
        return Path(write(self, path))
