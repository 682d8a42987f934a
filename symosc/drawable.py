"""Answers that draw themselves with ``.plot()``.

What draws them is in `symosc.plot`, above the answers: it registers a function for each kind of them here, and no
answer needs to know of figures. `symosc` itself says what is to be loaded for that, when the first one is drawn.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

#: What draws each kind of answer; filled by `register` when `symosc.plot` is loaded.
_drawers: dict[str, Callable[..., Any]] = {}
#: Called before the first drawing; they load what registers.
loaders: list[Callable[[], object]] = []


def register(kind: type | str, draw: Callable[..., Any]) -> None:
    """Let ``answer.plot(**options)`` return ``draw(answer, **options)`` for answers of a kind.

    A kind whose module is slow to load is given by its name, such as "symosc.simulation.trajectory.Trajectory".
    """
    _drawers[kind if isinstance(kind, str) else _name(kind)] = draw


def _name(kind: type) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"


class Drawable:
    """An answer that draws itself."""

    __slots__ = ()

    def plot(self, **options: Any) -> Any:
        """Draw this: the same as the function of `symosc.plot` for it.

        Parameters
        ----------
        **options
            As for that function: `plot.figure` for a Trajectory, `plot.orbit_figure` for a PeriodicOrbit,
            `plot.branch_figure` for a Branch, `plot.window_figure` for a GrazingWindow, `plot.figure_grazing_curve` for
            a GrazingCurve, `plot.region_figure` for a ParameterRegion and `plot.crosscheck_figure` for a CrossCheck.
            Those with panels take ``panels=``, and all take ``ax=`` for axes of your own, which hold one panel.

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
        while loaders:
            loaders.pop()()
        kinds = [name for name in map(_name, type(self).__mro__) if name in _drawers]
        if not kinds:
            raise NotImplementedError(f"nothing draws a {type(self).__name__}")
        return _drawers[kinds[0]](self, **options)
