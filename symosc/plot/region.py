"""Figure of a region of two parameters: where the window of a map has a property, and whether its border belongs to it.

A full line belongs to the region, a broken one does not; the same holds for full and open dots. What Parameters does
not allow is hatched.
"""

from __future__ import annotations

from functools import partial, reduce
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from symosc.aliases import NumberLike
from symosc.arguments import public
from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.plot.drawing import one_axes, style_for
from symosc.plot.sweep import NAMES
from symosc.plot.windows import INSIDE_COLOR, SHADE_COLOR

if TYPE_CHECKING:
    from symosc.symbolic.inverse import ParameterRegion

REGION_POINTS = 401
#: A shorter piece of the border, relative to the axes, is only where one kind of border meets another.
LEAST_PIECE = 0.01
FORBIDDEN: dict[str, Any] = {"facecolor": "0.93", "hatch": "xxx", "edgecolor": "0.6", "linewidth": 0}
INSIDE: dict[str, Any] = {"facecolor": SHADE_COLOR, "edgecolor": "0.35", "linewidth": 0}
BELONGS: Any = "solid"
EXCLUDED: Any = (0, (4, 2))


@public
def region_figure(
    region: ParameterRegion,
    first: tuple[NumberLike, NumberLike] | None = None,
    second: tuple[NumberLike, NumberLike] | None = None,
    *,
    ax: Axes | None = None,
) -> Figure:
    """Draw a region of two parameters, the first one to the right and the second one up.

    Parameters
    ----------
    region : ParameterRegion
        As `symosc.values_containing` and its like return for two names.
    first, second : pair of numbers, optional
        Ranges of the two parameters. Default: from 0 (both signs for B0 and the belts) to twice the given value.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        For something else than a region, and for a range that is not from a lower to a higher value.

    Examples
    --------
    >>> from symosc import load_scene, plot, values_containing
    >>> region = values_containing(load_scene("fig9").parameters, "P2", ("Omega", "k"), "7*pi/6")
    >>> drawing = plot.region_figure(region)
    >>> [text.get_text() for text in drawing.legends[0].get_texts()]
    ['inside', 'border, not inside', 'given values, outside']
    """
    names = region.question.names
    spans = [_span(region, name, given) for name, given in zip(names, (first, second), strict=True)]
    x, y = np.meshgrid(*(np.linspace(*span, REGION_POINTS) for span in spans))
    allowed = _margin(region.allowed, region.letters, x, y)
    inside = _margin(region.condition, region.letters, x, y)
    with style_for(ax):
        drawing, axes = one_axes(ax, (4.6, 3.9))
        shown = [*_fill(axes, x, y, inside, allowed), *_borders(axes, x, y, inside, allowed)]
        shown += _given(axes, region, spans)
        axes.set(xlabel=f"${NAMES[names[0]]}$", ylabel=f"${NAMES[names[1]]}$", xlim=spans[0], ylim=spans[1])
        axes.set_title(f"${region.question.latex()}$")
        style: dict[str, Any] = {"loc": "outside lower center", "ncols": 3, "frameon": False}
        target, options = (drawing, style) if ax is None else (axes, {})
        if shown:
            target.legend(handles=shown, **options)
    return drawing


class _Margin(NamedTuple):
    """How far points are inside a condition: > 0 inside, 0 on its border; and whether a border there is inside."""

    values: np.ndarray
    closed: np.ndarray


def _margin(condition: Any, letters: tuple[Any, Any], x: np.ndarray, y: np.ndarray) -> _Margin:
    import sympy as sp

    if condition in (sp.true, sp.false):
        return _Margin(np.full_like(x, np.inf if condition == sp.true else -np.inf), np.zeros(x.shape, dtype=bool))
    if isinstance(condition, sp.And | sp.Or):
        both = isinstance(condition, sp.And)
        return reduce(partial(_joined, both=both), (_margin(each, letters, x, y) for each in condition.args))
    found = sp.lambdify(letters, condition.gts - condition.lts, "numpy")(x, y)
    closed = np.full(x.shape, isinstance(condition, sp.Ge | sp.Le))
    return _Margin(np.asarray(np.broadcast_to(found, x.shape), dtype=float), closed)


def _joined(one: _Margin, other: _Margin, both: bool) -> _Margin:
    """Return the margin of both conditions, or of either: the comparison that decides has the border."""
    decides = one.values < other.values if both else one.values > other.values
    either = one.closed & other.closed if both else one.closed | other.closed
    closed = np.where(one.values == other.values, either, np.where(decides, one.closed, other.closed))
    return _Margin(np.where(decides, one.values, other.values), closed)


def _span(region: ParameterRegion, name: str, given: Any) -> tuple[float, float]:
    """Return the range of an axis; the default reaches past the given value and, for a belt, past the other one."""
    p = region.parameters
    if given is not None:
        low, high = (float(read_exact(name, end)) for end in given)
        if not low < high:
            raise ParameterError(name, given, "must go from a lower to a higher value")
        return low, high
    value = abs(float(getattr(p, name)))
    other = abs(float(p.v2 if name == "v1" else p.v1)) if name in ("v1", "v2") else 0.0
    reach = 2 * max(value, min(other, 2 * value) if value else other) or 1.0
    return (0.0, reach) if name in ("k", "Omega") else (-reach, reach)


def _fill(axes: Axes, x: np.ndarray, y: np.ndarray, inside: _Margin, allowed: _Margin) -> list[Any]:
    """Shade the region, hatch what is not allowed, and return what the legend needs."""
    shown = []
    both = np.minimum(inside.values, allowed.values)
    if (both > 0).any():
        _area(axes, x, y, both, INSIDE)
        shown.append(Patch(label="inside", **INSIDE))
    else:
        axes.text(
            0.5, 0.5, "nowhere here", transform=axes.transAxes, ha="center", bbox={"facecolor": "white", "linewidth": 0}
        )
    if (allowed.values < 0).any():
        _area(axes, x, y, -allowed.values, FORBIDDEN)
        shown.append(Patch(label="not allowed", **FORBIDDEN))
    return shown


def _area(axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray, look: dict[str, Any]) -> None:
    """Fill where values are positive."""
    finite = np.nan_to_num(values, posinf=1.0, neginf=-1.0)
    hatches = [look.get("hatch")]
    area = axes.contourf(x, y, finite, [0, np.inf], colors=[look["facecolor"]], hatches=hatches, zorder=0)
    area.set(edgecolor=look["edgecolor"] if "hatch" in look else look["facecolor"], linewidth=0)


def _borders(axes: Axes, x: np.ndarray, y: np.ndarray, inside: _Margin, allowed: _Margin) -> list[Any]:
    """Draw the border, full where it belongs to the region, and return what the legend needs."""
    shown: list[Any] = []
    if not inside.values.min() <= 0 <= inside.values.max() < np.inf:
        return shown
    for style, hidden, label in (
        (BELONGS, ~inside.closed, "border, inside"),
        (EXCLUDED, inside.closed, "border, not inside"),
    ):
        part = np.ma.masked_where(hidden | (allowed.values < 0), inside.values)
        if part.count() == 0 or not part.min() <= 0 <= part.max():
            continue
        look: dict[str, Any] = {"colors": [INSIDE_COLOR], "linewidths": 1.2, "linestyles": [style], "zorder": 2}
        pieces = axes.contour(x, y, part, [0], **look).allsegs[0]
        if any(
            (np.ptp(piece, axis=0) > LEAST_PIECE * np.array([np.ptp(x), np.ptp(y)])).any()
            for piece in pieces
            if len(piece)
        ):
            shown.append(Line2D([], [], color=INSIDE_COLOR, linewidth=1.2, linestyle=style, label=label))
    return shown


def _given(axes: Axes, region: ParameterRegion, spans: list[tuple[float, float]]) -> list[Any]:
    """Mark the values of the parameters that the region was asked for with, if they are on the axes."""
    names = region.question.names
    at = [float(getattr(region.parameters, name)) for name in names]
    if not all(low <= value <= high for value, (low, high) in zip(at, spans, strict=True)):
        return []
    inside = region.contains(**{name: getattr(region.parameters, name) for name in names})
    label = f"given values, {'inside' if inside else 'outside'}"
    face = "black" if inside else "white"
    return axes.plot(
        *([value] for value in at), "o", color="black", markerfacecolor=face, markersize=5, linestyle="none",
        label=label, zorder=4, clip_on=False,
    )  # fmt: skip
