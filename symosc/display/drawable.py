"""Base classes of results that display themselves: by ``.plot()``, and as a page in notebooks.

`symosc.plot` and `symosc.plot.notebooks` register here what shows each kind of them: no answer imports a figure.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any, Literal, TypeVar

Show = Callable[..., Any]
Item = TypeVar("Item")
# Number of entries shown of a listing that has more than the second number of them.
SHOWN, MOST_SHOWN = 3, 10
#: The registered functions by what they do, then by the qualified name of the answers' class.
_registered: dict[str, dict[str, Show]] = {"draw": {}, "page": {}, "write": {}}
#: Called before the first drawing, report or page; they load what registers.
loaders: list[Callable[[], object]] = []
page_loaders: list[Callable[[], object]] = []


def register(kind: type | str, show: Show, what: Literal["draw", "page", "write"] = "draw") -> None:
    """Register a function that draws results of a class (or its qualified name), or writes a page of them."""
    # "draw": ``answer.plot(**options)`` returns ``show(answer, **options)``. "page": notebooks show the HTML of
    # ``show(answer)``. "write": ``answer.to_html(path)`` returns ``show(answer, path)``.
    _registered[what][kind if isinstance(kind, str) else f"{kind.__module__}.{kind.__qualname__}"] = show


def _found(answer: object, what: str, load: list[Callable[[], object]]) -> Show | None:
    """Run the loaders, and return the function registered for a result's class; None if there is none."""
    while load:
        load.pop()()
    shows, names = _registered[what], (f"{kind.__module__}.{kind.__qualname__}" for kind in type(answer).__mro__)
    return next((shows[name] for name in names if name in shows), None)


class Drawable:
    """A result with a plot and a notebook page."""

    __slots__ = ()

    def plot(self, *given: Any, **options: Any) -> Any:
        """Draw the result, by the function of `symosc.plot` for it.

        Parameters
        ----------
        *given, **options
            As for that function: `plot.figure` for a Trajectory, `plot.orbit_figure` for a PeriodicOrbit,
            `plot.branch_figure` for a Branch, `plot.window_figure` for a GrazingWindow and so on. Those with panels
            take ``panels=``, and all take ``ax=`` for axes of your own, which hold one panel.

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
        draw = _found(self, "draw", loaders)
        if draw is None:
            raise NotImplementedError(f"nothing draws a {type(self).__name__}")
        return draw(self, *given, **options)

    def _repr_html_(self) -> str | None:
        """Return the notebook page, or None, in which case the repr is shown."""
        page = _found(self, "page", page_loaders)
        return None if page is None else page(self)

    def __dir__(self) -> list[str]:
        """Return the names that a user is meant to use, for completion."""
        return sorted(name for name in super().__dir__() if not name.startswith("_"))


class Comparable:
    """A result, of a dataclass, that is equal to another one if all public fields are; NaN is equal to NaN."""

    __slots__ = ()
    __hash__ = None  # type: ignore[assignment]  # arrays have none

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        names = [each.name for each in fields(self) if not each.name.startswith("_")]  # type: ignore[arg-type]
        return all(_same(getattr(self, name), getattr(other, name)) for name in names)


def _same(one: Any, other: Any) -> bool:
    """Return whether two values are equal: arrays as a whole (NaN equals NaN), others by ==, or else by their repr."""
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

    def _repr_html_(self) -> str | None:
        """Return a table for notebooks, or None, in which case the repr is shown."""
        page = _found(self, "page", page_loaders)
        return None if page is None else page(self)


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
        write = _found(self, "write", loaders)
        if write is None:
            raise NotImplementedError(f"nothing writes a page about a {type(self).__name__}")
        return Path(write(self, path))
