"""Base classes of results that display themselves: by ``.plot()``, and as a page in notebooks.

No result imports a figure: `symosc.plot` is loaded when a result is first shown.
"""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar, TypeVar

Item = TypeVar("Item")
# Number of entries shown of a listing that has more than the second number of them.
SHOWN = 3
MOST_SHOWN = 10


def _notebook_page(result: object) -> Any:
    """Return the notebook page of a result as HTML, or None, in which case its repr is shown."""
    return import_module("symosc.plot.notebooks").page_of(result)


class Drawable:
    """A result with a plot and a notebook page."""

    __slots__ = ()
    #: The function of `symosc.plot` that draws results of the class. A name, as matplotlib is not
    #: loaded with them.
    _drawn_by: ClassVar[str] = ""
    #: The call that makes such a result, for messages about other arguments.
    _made_by: ClassVar[str] = ""

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
        if not self._drawn_by:
            raise NotImplementedError(f"nothing draws a {type(self).__name__}")
        draw = getattr(import_module("symosc.plot"), self._drawn_by)
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
        names = [field.name for field in fields(self) if not field.name.startswith("_")]  # type: ignore[arg-type]
        return all(_same(getattr(self, name), getattr(other, name)) for name in names)


def _same(first: Any, second: Any) -> bool:
    """Return whether two values of a field are equal.

    Arrays are compared as a whole. NaN equals NaN, also within lists, tuples, dictionaries and
    dataclasses that have no comparison of their own.
    """
    if hasattr(first, "dtype") or hasattr(second, "dtype"):
        return _same_arrays(first, second)
    if type(first) is not type(second):
        return bool(first == second)
    if isinstance(first, list | tuple):
        return len(first) == len(second) and all(map(_same, first, second))
    if isinstance(first, dict):
        return first.keys() == second.keys() and all(
            _same(first[key], second[key]) for key in first
        )
    if is_dataclass(first) and not isinstance(first, Comparable):
        compared = [field.name for field in fields(first) if field.compare]
        return all(_same(getattr(first, name), getattr(second, name)) for name in compared)
    return bool(first == second or (first != first and second != second))


def _same_arrays(first: Any, second: Any) -> bool:
    import numpy as np

    is_real = all(np.asarray(value).dtype.kind in "fc" for value in (first, second))
    return bool(np.array_equal(first, second, equal_nan=is_real))


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
        return Path(import_module("symosc.plot.judged").write_page(self, path))
