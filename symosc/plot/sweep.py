"""Figure of a grazing window against one parameter. A full dot belongs to the window, an open dot does not."""

from __future__ import annotations

from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.aliases import NumberLike, Order
from symosc.arguments import public
from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.grazing.window import GrazingWindow, WindowColumns, grazing_window, grazing_windows
from symosc.kernels.double_double import HALF_PI, THREE_HALVES_PI
from symosc.mappings.theorem7_cases import (
    ALL_BUT_ONE,
    ARC,
    EMPTY,
    EVERYTHING,
    WRAPPED_ARC,
    place,
)
from symosc.model import Parameters
from symosc.plot.drawing import one_axes, style_for
from symosc.plot.windows import CRITICAL_COLOR, PHASE_TICKS, SHADE_COLOR, TURN, critical_phases, draw_dot, tex

SWEEP_POINTS = 801
# A value nearer to the frame than this part of the axis gets room of that size.
LEAST_ROOM, FRAME_ROOM = 0.02, 0.04
NAMES = {"Omega": r"\Omega", "B0": "B_0", "k": "k", "v1": "v_1", "v2": "v_2"}


@public
def sweep_figure(
    p: Parameters,
    mapping: str,
    name: str,
    low: NumberLike | None = None,
    high: NumberLike | None = None,
    order: Order = "full",
    *,
    ax: Axes | None = None,
) -> Figure:
    """Draw the window of a map against one parameter; its border is the curve of the arcsine.

    Parameters
    ----------
    p : Parameters
        The other parameters; the value of `name` in it is marked.
    mapping, order :
        As for `symosc.grazing_window`.
    name : {"Omega", "B0", "k", "v1", "v2"}
        A parameter on which the window depends.
    low, high : number, optional
        Range. Default: from 0 (both signs for B0 and the belts) to twice the larger one of the value and the equality
        |k v_lambda| = |B0| Omega, as far as Parameters allows.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; their figure is returned.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        For a map without grazing, another parameter, or a range that is empty or not allowed.

    Examples
    --------
    >>> from symosc import load_scene, plot
    >>> drawing = plot.sweep_figure(load_scene("fig9").parameters, "P2", "Omega", "0.1", 4)
    >>> drawing.axes[0].get_xlabel()
    '$\\\\Omega$'
    """
    low, high = _sweep_range(p, mapping, name, low, high)
    equalities = [q for q in _equalities(p, mapping, name) if low < q < high]
    values = _values(low, high, equalities)
    found = grazing_windows(p, mapping, order, **{name: values})
    with style_for(ax):
        drawing, axes = one_axes(ax, (4.6, 3.4))
        _areas(axes, values, found, place(mapping).side * (values if name == "B0" else float(p.B0)))
        _borders(axes, values, found)
        for q in equalities:
            _dots(axes, float(q), grazing_window(p.replace(**{name: q}), mapping, order))
        axes.set(
            xlabel=f"${NAMES[name]}$", ylabel=r"$\mathrm{mod}(\Omega t_m, 2\pi)$", xlim=(low, high), ylim=(0, TURN)
        )
        _mark_value(axes, float(getattr(p, name)))
        axes.set_yticks(np.arange(5) * pi / 2, PHASE_TICKS)
        axes.set_title(f"grazing window of ${tex(mapping)}$, {order} order")
        _legend(axes, drawing if ax is None else None)
    return drawing


def _dots(axes: Axes, value: float, window: GrazingWindow) -> None:
    """Draw the critical phases of a window above a value, with what they are to the window."""
    for theta, belongs in critical_phases(window):
        draw_dot(axes, value, theta, belongs, label="belongs to it" if belongs else "does not belong to it")


def _values(low: float, high: float, equalities: list[Fraction]) -> np.ndarray:
    """Return values to sample: even ones, and equality and 0, where the window changes its kind, and beside these."""
    steps = (0.0, 1e-9 * (high - low), -1e-9 * (high - low))
    edges = [float(q) + step for q in [*equalities, Fraction(0)] for step in steps]
    even = np.linspace(low, high, SWEEP_POINTS)
    return np.unique(np.concatenate([even, [edge for edge in edges if low <= edge <= high]]))


def _legend(axes: Axes, drawing: Figure | None) -> None:
    """Add a legend with one entry for each label: below the figure, or inside the axes if they are a user's own."""
    handles, labels = axes.get_legend_handles_labels()
    if not handles:
        return
    once = dict(zip(labels, handles, strict=True))
    if drawing is None:
        axes.legend(list(once.values()), list(once))
    else:
        drawing.legend(list(once.values()), list(once), loc="outside lower center", ncols=3, frameon=False)


def _mark_value(axes: Axes, value: float) -> None:
    """Draw a line at the given value, if the axis reaches it; where it would lie on the frame, make room."""
    low, high = axes.get_xlim()
    if not low <= value <= high:
        return
    axes.axvline(value, color="black", linewidth=0.9, linestyle=":", label="given value")
    room, width = FRAME_ROOM * (high - low), high - low
    near_low, near_high = value - low < LEAST_ROOM * width, high - value < LEAST_ROOM * width
    axes.set_xlim(low - room * near_low, high + room * near_high)


def _sweep_range(p: Parameters, mapping: str, name: str, low: Any, high: Any) -> tuple[float, float]:
    where = place(mapping)
    names = ("Omega", "B0", "k", f"v{where.boundary}")
    if name not in names:
        raise ParameterError("name", name, f"the window of {mapping} depends on {', '.join(names)} only")
    reach = 2 * max([abs(float(getattr(p, name))), *(abs(float(q)) for q in _equalities(p, mapping, name))]) or 1.0
    least, most = {
        "Omega": (reach / 400, reach),
        "k": (0.0, reach),
        "B0": (-reach, reach),
        "v1": (min(-reach, float(p.v2) - reach), min(reach, float(p.v2))),
        "v2": (max(-reach, float(p.v1)), max(reach, float(p.v1) + reach)),
    }[name]
    found = [
        float(read_exact(name, given)) if given is not None else end for given, end in ((low, least), (high, most))
    ]
    # The belts may not have one speed.
    shift = 1e-9 * (found[1] - found[0])
    if name == "v1" and found[1] == float(p.v2):
        found[1] -= shift
    if name == "v2" and found[0] == float(p.v1):
        found[0] += shift
    if not found[0] < found[1]:
        raise ParameterError(name, found, "the range must go from a lower to a higher value")
    for end in found:
        p.replace(**{name: end})
    return found[0], found[1]


def _equalities(p: Parameters, mapping: str, name: str) -> list[Fraction]:
    """Return the values of a parameter at which |k v_lambda| = |B0| Omega."""
    speed = p.belt(place(mapping).boundary)
    level, size = abs(p.k * speed), abs(p.B0 * p.Omega)
    if name == "Omega":
        return [level / abs(p.B0)] if p.B0 and level else []
    if name == "B0":
        return [sign * level / p.Omega for sign in (1, -1)] if level else []
    if name == "k":
        return [size / abs(speed)] if speed and size else []
    return [sign * size / p.k for sign in (1, -1)] if p.k and size else []


def _areas(axes: Axes, values: np.ndarray, found: WindowColumns, above: Any) -> None:
    """Shade the window; the arc that it lacks ends at 3 pi/2 where `above` > 0, at pi/2 elsewhere."""
    if np.all(found.kind == EMPTY):
        axes.text(0.5, 0.5, "the window is empty", transform=axes.transAxes, ha="center")
    everything = np.isin(found.kind, (EVERYTHING, ALL_BUT_ONE))
    # Everything is a wrapped arc whose ends meet: shaded as one with the wrapped arcs beside it, without a seam.
    last = np.where(np.asarray(above) > 0, THREE_HALVES_PI, HALF_PI[0])
    low, high = np.where(everything, last, found.low), np.where(everything, last, found.high)
    wrapped = everything | (found.kind == WRAPPED_ARC)
    floor, ceiling, label = np.zeros_like(values), np.full_like(values, TURN), "window"
    for where, lower, upper in ((wrapped, floor, high), (wrapped, low, ceiling), (found.kind == ARC, low, high)):
        if where.any():
            axes.fill_between(values, lower, upper, where=where, color=SHADE_COLOR, linewidth=0.4, label=label)
            label = "_"  # no second entry in the legend


def _borders(axes: Axes, values: np.ndarray, found: Any) -> None:
    """Draw Theta_cr and pi - Theta_cr, which are not in the window, broken where they jump by a turn."""
    if np.all(np.isnan(found.theta_cr)):
        return
    label: str | None = r"$\Theta^{cr}$ and $\pi-\Theta^{cr}$ (excluded)"
    for curve in (found.theta_cr % TURN, pi - found.theta_cr):
        broken = np.where(np.abs(np.diff(curve, prepend=curve[0])) > 3, np.nan, curve)
        axes.plot(values, broken, color=CRITICAL_COLOR, linewidth=1.0, linestyle=(0, (4, 2)), label=label)
        label = None
