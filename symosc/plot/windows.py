"""Figures of grazing: windows on the circle of phases, their contacts, windows against a parameter,
regions and curves.

A full dot or line belongs to a window or region, an open dot or broken line does not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import cos, pi, sin
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from symosc.base.aliases import NumberLike, Order, Record
from symosc.base.arguments import (
    NUMBER,
    ORDER,
    TEXT,
    function_of,
    public,
    require,
    require_or_none,
    row_of,
    sequence_of,
)
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact, show
from symosc.grazing.curve import CurvePiece, GrazingCurve
from symosc.grazing.window import GrazingWindow, WindowColumns, grazing_window, grazing_windows
from symosc.kernels.double_double import HALF_PI, THREE_HALVES_PI
from symosc.kernels.theorem7_cases import ALL_BUT_ONE, ARC, EMPTY, EVERYTHING, WRAPPED_ARC, place
from symosc.model import Parameters
from symosc.plot import drawing as common
from symosc.plot.drawing import (
    PARAMETER_LABELS,
    FigureSize,
    add_legend,
    axes_for,
    legend_entries,
    panels_for,
    read_panels,
    read_size,
    typeset,
)
from symosc.scenes import ParametersLike, parameters_for

if TYPE_CHECKING:
    from symosc.symbolic.inverse import ParameterRegion

INSIDE_COLOR = "#1f3fd6"
SHADE_COLOR = "#cfd6f6"
OUTSIDE_COLOR = "0.72"
CRITICAL_COLOR = "#d7191c"
START_COLOR = "#d7191c"
SOLID: Any = "solid"
DASHES: Any = (0, (4, 2))
TURN = 2 * pi
#: About half a turn: a phase that changes by more from point to point has jumped by a turn.
HALF_A_TURN = 3
PHASE_TICKS = ["$0$", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"]
PHASE_LABEL = r"phase $\mathrm{mod}(\Omega t_m, 2\pi)$"
#: The numbers on the dial of phases: how far from its middle they stand, nearer than this part of a
#: turn to a critical phase they give way to it, and by how much.
NUMBERS_AT = 0.8
NUMBER_TOUCHES = 1 / 12
GIVES_WAY = 0.2
CIRCLE_POINTS = 1441

# -- windows: the circle of phases, and the contacts -----------------------------------------------


@public
def window_figure(
    windows: GrazingWindow | Sequence[GrazingWindow],
    plane: Callable[[Axes, GrazingWindow], None] | None = None,
    *,
    panels: str | None = None,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw windows, one row each.

    Left: the circle of phases with the window, its ends and Theta_cr. The horizontal line is sin
    theta = -k v_lambda/(B0 Omega); the window is above it (P2, P5 with B0 > 0) or below it. Right:
    the place x_m(theta) of the contact, over the window and (thin) over the other phases.

    Parameters
    ----------
    windows : GrazingWindow or sequence of them
    plane : callable, optional
        Draws the grazing curve of a window on the switching plane, into axes of a third column.
    panels, ax, figsize : optional
        As for `symosc.plot.figure`. The panels are a circle, b contacts. Default: both, with `ax`
        a.

    Examples
    --------
    >>> from symosc import grazing_window, load_scene, plot
    >>> p = load_scene("fig9").parameters
    >>> drawing = plot.window_figure([grazing_window(p, mapping) for mapping in ("P2", "P3")])
    >>> len(drawing.axes)
    4
    """
    require(GrazingWindow, sequence_of(GrazingWindow), windows=windows)
    require_or_none(function_of(2), plane=plane)
    if isinstance(windows, GrazingWindow):
        chosen = [windows]
    else:
        chosen = list(windows)
    if not chosen:
        raise ParameterError("windows", windows, "must be at least one")
    draw = {"a": _circle, "b": _contacts}
    panels = read_panels(panels, draw, ax)
    columns = [draw[letter] for letter in panels] + ([] if plane is None else [plane])
    size = read_size(figsize, ax, (1.2 + 2.9 * len(columns), 2.5 * len(chosen) + 0.2))
    if ax is not None:
        if len(chosen) > 1:
            raise ParameterError(
                "windows",
                f"{len(chosen)} windows",
                "an Axes holds a single window; pass one window together with ax=",
            )
        draw[panels](ax, chosen[0])
        return common.figure_of(ax)
    with common.own_style():
        drawing = common.Drawing(figsize=size, layout="constrained")
        widths = [1.0 if column is _circle else 1.5 for column in columns]
        grid = drawing.subplots(len(chosen), len(columns), squeeze=False, width_ratios=widths)
        for row, window in zip(grid, chosen, strict=True):
            for axes, column in zip(row, columns, strict=True):
                column(axes, window)
    return drawing


def _name_phase(axes: Axes, theta: float, name: str) -> None:
    """Write a phase's name outside the circle, farther at its top and bottom, on the side away from
    it.
    """
    if abs(cos(theta)) < 0.5:
        beyond = 1.28
    else:
        beyond = 1.22
    if cos(theta) > 0.1:
        side = "left"
    elif cos(theta) < -0.1:
        side = "right"
    else:
        side = "center"
    style: Record = {"color": CRITICAL_COLOR, "ha": side, "va": "center", "fontsize": 8}
    axes.text(beyond * cos(theta), beyond * sin(theta), name, **style)


def _circle(axes: Axes, window: GrazingWindow) -> None:
    """Draw the circle of phases, on it the window as a thick arc, and the phases Theta_cr and pi -
    Theta_cr.
    """

    def arc(low: float, high: float, **style: Any) -> None:
        """Draw the arc of the circle from the phase `low` to `high`."""
        theta = np.linspace(low, high, max(2, int(CIRCLE_POINTS * (high - low) / TURN)))
        axes.plot(np.cos(theta), np.sin(theta), **style)

    arc(0, TURN, color=OUTSIDE_COLOR, linewidth=1.0, zorder=1)
    for low, high, *_ in window.intervals:
        arc(low, high, color=INSIDE_COLOR, linewidth=3.0, solid_capstyle="butt", zorder=2)
    critical = critical_phases(window)
    for theta, belongs in critical:
        axes.plot([0, cos(theta)], [0, sin(theta)], color=CRITICAL_COLOR, linewidth=0.7, zorder=1)
        draw_dot(axes, cos(theta), sin(theta), belongs)
    if critical:
        # Both critical phases have this sine.
        theta_cr, _ = critical[0]
        level = sin(theta_cr)
        axes.plot(
            [-1.15, 1.15],
            [level, level],
            color=CRITICAL_COLOR,
            linewidth=0.7,
            linestyle=(0, (4, 3)),
            zorder=1,
        )
    for (theta, _), name in zip(critical, (r"$\Theta^{cr}$", r"$\pi-\Theta^{cr}$"), strict=False):
        _name_phase(axes, theta, name)
    for quarter in range(4):
        angle = quarter * pi / 2
        axes.plot(
            [0.94 * cos(angle), cos(angle)],
            [0.94 * sin(angle), sin(angle)],
            color="black",
            linewidth=0.6,
        )
        # Inside, since the names of the critical phases stand outside; on the side of the tick
        # where no critical phase is near.
        at = angle
        for theta, _ in critical:
            if cos(angle - theta) > cos(NUMBER_TOUCHES * TURN):
                at += GIVES_WAY if sin(angle - theta) >= 0 else -GIVES_WAY
        axes.text(
            NUMBERS_AT * cos(at),
            NUMBERS_AT * sin(at),
            PHASE_TICKS[quarter],
            ha="center",
            va="center",
            fontsize=7,
        )
    axes.set(xlim=(-1.9, 1.9), ylim=(-1.5, 1.5), aspect="equal")
    axes.set_axis_off()
    if window.order == "paper":
        rule = ", by the rule as printed"
    else:
        rule = ""
    axes.set_title(f"phases at which {typeset(window.mapping)} grazes{rule}", fontsize=8)


def critical_phases(window: GrazingWindow) -> list[tuple[float, bool]]:
    """Return Theta_cr and pi - Theta_cr modulo 2 pi (one if equal), each with whether it is in the
    window.
    """
    gamma_sign, amplitude_sign, excess_sign = window.signs
    if amplitude_sign == 0 or excess_sign > 0:
        return []
    if excess_sign == 0:
        # |gamma| = |B0| Omega/m: the sine of the critical phase is 1 or -1, at a single phase.
        if gamma_sign * amplitude_sign < 0:
            theta, _ = HALF_PI  # its low part is less than a double shows
        else:
            theta = THREE_HALVES_PI
        return [(theta, window.kind == EVERYTHING)]
    theta_cr = float(window.critical_phase())
    return [(theta_cr % TURN, False), (pi - theta_cr, False)]


def draw_dot(axes: Axes, x: float, y: float, belongs: bool, label: str | None = None) -> None:
    """Draw a dot at (x, y): a full one if this point belongs to a window, else an open one."""
    style: Record = {
        "color": INSIDE_COLOR,
        "markerfacecolor": INSIDE_COLOR if belongs else "white",
        "markersize": 4.5,
    }
    axes.plot([x], [y], "o", zorder=4, clip_on=False, linestyle="none", label=label, **style)


def _contacts(axes: Axes, window: GrazingWindow) -> None:
    """Draw the positions of possible grazes, (A_alpha + B0 cos theta - c v_lambda)/k, over the
    phase theta.
    """
    p = window.parameters
    grazing_place = window.place
    axes.set(xlim=(0, TURN), xlabel=PHASE_LABEL, ylabel="$x_m$")
    axes.set_xticks(np.arange(5) * pi / 2, PHASE_TICKS)
    axes.set_title(
        f"domain {grazing_place.domain} at $v_{grazing_place.boundary} = {show(window.speed)}$",
        fontsize=8,
    )
    if p.k == 0:
        axes.set_yticks([])
        if window.contact_phases:
            phase = "$F = 0$ fixes the phase"
        else:
            phase = "no phase of the window has $F = 0$"
        axes.text(
            0.5, 0.9, f"$k = 0$: $x_m$ is free, {phase}", transform=axes.transAxes, ha="center"
        )
        for low, high, *_ in window.intervals:
            axes.axvspan(low, high, color=SHADE_COLOR, linewidth=0)
        for theta in window.contact_phases:
            axes.axvline(float(theta), color=INSIDE_COLOR, linewidth=1.6)
        return
    middle = float((p.A(grazing_place.domain) - p.c * window.speed) / p.k)
    amplitude = float(p.B0 / p.k)
    # The whole curve thin, and over it the window thick.
    curves = [
        (0, TURN, OUTSIDE_COLOR, 0.8),
        *((low, high, INSIDE_COLOR, 2.0) for low, high, *_ in window.intervals),
    ]
    for low, high, color, width in curves:
        phases = np.linspace(low, high, max(2, int(CIRCLE_POINTS * (high - low) / TURN)))
        axes.plot(phases, middle + amplitude * np.cos(phases), color=color, linewidth=width)
    for theta, belongs in critical_phases(window):
        axes.axvline(theta, color=CRITICAL_COLOR, linewidth=0.7, linestyle=(0, (4, 3)), zorder=0)
        # The phase 0 is at both ends of the axis.
        abscissas = (theta, TURN) if theta == 0 else (theta,)
        for abscissa in abscissas:
            draw_dot(axes, abscissa, middle + amplitude * float(np.cos(theta)), belongs)


# -- windows against one parameter -----------------------------------------------------------------


@public
def sweep_figure(
    p: ParametersLike,
    mapping: str,
    name: str,
    low: NumberLike | None = None,
    high: NumberLike | None = None,
    order: Order = "full",
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw the grazing window of a mapping against one parameter: the phases between Theta_cr and
    pi - Theta_cr.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
        The other parameters; the value of `name` in it is marked.
    mapping, order :
        As for `symosc.grazing_window`.
    name : {"Omega", "B0", "k", "v1", "v2"}
        A parameter on which the window depends.
    low, high : number, optional
        Range. Default: from 0 (both signs for B0 and the belts) to twice the larger one of the
        value and the equality
        |k v_lambda| = |B0| Omega, as far as Parameters allows.

    Examples
    --------
    >>> from symosc import load_scene, plot
    >>> drawing = plot.sweep_figure(load_scene("fig9").parameters, "P2", "Omega", "0.1", 4)
    >>> drawing.axes[0].get_xlabel()
    '$\\\\Omega$'
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping, name=name)
    require_or_none(NUMBER, low=low, high=high)
    require(ORDER, order=order)
    low, high = _sweep_range(p, mapping, name, low, high)
    equalities = [q for q in _equalities(p, mapping, name) if low < q < high]
    values = _sweep_values(low, high, equalities)
    columns = grazing_windows(p, mapping, order, **{name: values})
    if name == "B0":
        amplitudes = values
    else:
        amplitudes = np.full_like(values, float(p.B0))
    # Where side B0 > 0, the window is where sin(theta) is above sin(Theta_cr), else below.
    above = place(mapping).side * amplitudes
    with axes_for(ax, (4.6, 3.4), figsize=figsize) as (drawing, (axes,)):
        _window_areas(axes, values, columns, above)
        _draw_critical_phases(axes, values, columns)
        # At equality a window may have or lack a single phase.
        for q in equalities:
            window = grazing_window(p.replace(**{name: q}), mapping, order)
            for theta, belongs in critical_phases(window):
                meaning = "belongs to it" if belongs else "does not belong to it"
                draw_dot(axes, float(q), theta, belongs, meaning)
        axes.set(
            xlabel=PARAMETER_LABELS[name], ylabel=PHASE_LABEL, xlim=(low, high), ylim=(0, TURN)
        )
        _mark_value(axes, float(getattr(p, name)), low, high)
        axes.set_yticks(np.arange(5) * pi / 2, PHASE_TICKS)
        axes.set_title(f"grazing window of {typeset(mapping)}, {order} order")
        add_legend(drawing, ax, [axes], 3)
    return drawing


def _sweep_values(low: float, high: float, equalities: Sequence[Fraction]) -> np.ndarray:
    """Return the values at which a sweep is computed: evenly from `low` to `high`, and at the
    equalities and 0, where the window changes its kind, with close neighbours on both sides.
    """
    offsets = (0.0, 1e-9 * (high - low), -1e-9 * (high - low))
    edges = [float(q) + step for q in [*equalities, Fraction(0)] for step in offsets]
    inside = [edge for edge in edges if low <= edge <= high]
    return np.union1d(np.linspace(low, high, 801), inside)


def _draw_critical_phases(axes: Axes, values: np.ndarray, columns: WindowColumns) -> None:
    """Draw Theta_cr and pi - Theta_cr against the parameter's values, as broken lines."""
    label: str | None = r"$\Theta^{cr}$ and $\pi-\Theta^{cr}$ (excluded)"
    for curve in (columns.theta_cr % TURN, pi - columns.theta_cr):
        if not np.isnan(curve).all():
            # nan interrupts the line where the phase jumps by a turn.
            is_jump = np.abs(np.diff(curve, prepend=curve[0])) > HALF_A_TURN
            broken = np.where(is_jump, np.nan, curve)
            axes.plot(
                values,
                broken,
                color=CRITICAL_COLOR,
                linewidth=1.0,
                linestyle=DASHES,
                label=label,
            )
            label = None  # both lines have one entry in the legend


def _mark_value(axes: Axes, value: float, low: float, high: float) -> None:
    """Mark the parameter's given value, if it is in the range that is drawn."""
    if not low <= value <= high:
        return
    axes.axvline(value, color="black", linewidth=0.9, linestyle=":", label="given value")
    # If the line would lie on the frame, the axis goes on a little beyond it.
    width = high - low
    near_low = value - low < 0.02 * width
    near_high = high - value < 0.02 * width
    axes.set_xlim(low - 0.04 * width * near_low, high + 0.04 * width * near_high)


def _sweep_range(
    p: Parameters, mapping: str, name: str, low: Any, high: Any
) -> tuple[float, float]:
    """Return the range of a parameter to draw, by default one that shows where the window changes
    its kind.
    """
    names = ("Omega", "B0", "k", f"v{place(mapping).boundary}")
    if name not in names:
        raise ParameterError(
            "name", name, f"the window of {mapping} depends on {', '.join(names)} only"
        )
    equalities = [abs(float(value)) for value in _equalities(p, mapping, name)]
    reach = 2 * max([abs(float(getattr(p, name))), *equalities]) or 1.0
    usual_low, usual_high = {
        "Omega": (reach / 400, reach),
        "k": (0.0, reach),
        "B0": (-reach, reach),
        "v1": (min(-reach, float(p.v2) - reach), min(reach, float(p.v2))),
        "v2": (max(-reach, float(p.v1)), max(reach, float(p.v1) + reach)),
    }[name]
    if low is None:
        first = usual_low
    else:
        first = float(read_exact(name, low))
    if high is None:
        last = usual_high
    else:
        last = float(read_exact(name, high))
    shift = 1e-9 * (last - first)  # the belts may not have one speed
    if name == "v1" and last == float(p.v2):
        last -= shift
    if name == "v2" and first == float(p.v1):
        first += shift
    if not first < last:
        raise ParameterError(
            name, [first, last], "the range must go from a lower to a higher value"
        )
    for end in (first, last):
        p.replace(**{name: end})
    return first, last


def _equalities(p: Parameters, mapping: str, name: str) -> list[Fraction]:
    """Return the values of a parameter at which |k v_lambda| = |B0| Omega."""
    speed = p.belt(place(mapping).boundary)
    level = abs(p.k * speed)
    size = abs(p.B0 * p.Omega)
    # The parameter's size: the side of the equation without it, over the other factor of its side.
    quotients = {"Omega": (level, abs(p.B0)), "B0": (level, p.Omega), "k": (size, abs(speed))}
    other_side, factor = quotients.get(name, (size, p.k))  # else a belt's speed
    if not (other_side and factor):
        return []
    value = other_side / factor
    if name in ("Omega", "k"):  # they are not negative
        return [value]
    return [value, -value]


def _window_areas(axes: Axes, values: np.ndarray, columns: WindowColumns, above: Any) -> None:
    """Shade the grazing window in `columns`, between its lower and upper phases, over the values of a
    parameter.

    `above` is positive where the window is above the line of its critical phases. A window that is
    the full circle begins and ends at 3 pi/2 where `above` > 0, and at pi/2 elsewhere.
    """
    if np.all(columns.kind == EMPTY):
        axes.text(0.5, 0.5, "the window is empty", transform=axes.transAxes, ha="center")
    everything = np.isin(columns.kind, (EVERYTHING, ALL_BUT_ONE))
    # Everything is a wrapped arc whose ends meet: shaded as one with the wrapped arcs beside it,
    # without a seam.
    seam = np.where(np.asarray(above) > 0, THREE_HALVES_PI, HALF_PI[0])
    low = np.where(everything, seam, columns.low)
    high = np.where(everything, seam, columns.high)
    wrapped = everything | (columns.kind == WRAPPED_ARC)
    floor = np.zeros_like(values)
    ceiling = np.full_like(values, TURN)
    label = "window"
    for where, lower, upper in (
        (wrapped, floor, high),
        (wrapped, low, ceiling),
        (columns.kind == ARC, low, high),
    ):
        if where.any():
            axes.fill_between(
                values, lower, upper, where=where, color=SHADE_COLOR, linewidth=0.4, label=label
            )
            label = "_"  # no second entry in the legend


# -- regions of two parameters ---------------------------------------------------------------------

FORBIDDEN: Record = {"facecolor": "0.93", "hatch": "xxx", "edgecolor": "0.6", "linewidth": 0}
INSIDE: Record = {"facecolor": SHADE_COLOR, "edgecolor": "0.35", "linewidth": 0}


@public
def region_figure(
    region: ParameterRegion,
    first: tuple[NumberLike, NumberLike] | None = None,
    second: tuple[NumberLike, NumberLike] | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw a region of two parameters, the first one to the right and the second one up.

    Parameters
    ----------
    region : ParameterRegion
        The answer of `symosc.values_containing`, `values_empty` or `values_everything` for two
        parameters.
    first, second : pair of numbers, optional
        Ranges of the two parameters. Default: from 0 to twice the value in the region's parameters,
        with both signs for B0, v1 and v2.

    Examples
    --------
    >>> from symosc import load_scene, plot, values_containing
    >>> region = values_containing(load_scene("fig9").parameters, "P2", ("Omega", "k"), "7*pi/6")
    >>> drawing = plot.region_figure(region)
    >>> [text.get_text() for text in drawing.legends[0].get_texts()]
    ['inside', 'border, not inside', 'given values, outside']
    """
    from symosc.symbolic.inverse import ParameterRegion

    require(ParameterRegion, region=region)
    require_or_none(row_of(2, NUMBER), first=first, second=second)
    names = region.question.names
    spans = [
        _axis_range(region, name, limits)
        for name, limits in zip(names, (first, second), strict=True)
    ]
    x, y = np.meshgrid(*(np.linspace(*span, 401) for span in spans))
    # Margins are positive where a condition holds. With 1 more for >= and <=, that of the condition
    # is larger where its border belongs to it.
    allowed = _margin(region.allowed, region.letters, x, y, 0.0)
    inside = _margin(region.condition, region.letters, x, y, 0.0)
    closed = _margin(region.condition, region.letters, x, y, 1.0)
    with axes_for(ax, (4.6, 3.9), figsize=figsize) as (drawing, (axes,)):
        shown = _region_areas(axes, x, y, inside, allowed)
        shown += _region_borders(axes, x, y, np.where(allowed < 0, np.nan, inside), closed > inside)
        shown += _mark_given(axes, region, spans)
        x_name, y_name = names
        x_span, y_span = spans
        axes.set(
            xlabel=PARAMETER_LABELS[x_name],
            ylabel=PARAMETER_LABELS[y_name],
            xlim=x_span,
            ylim=y_span,
        )
        axes.set_title(f"${region.question.latex()}$")
        add_legend(drawing, ax, {artist.get_label(): artist for artist in shown}, 3)
    return drawing


def _margin(
    condition: Any, letters: tuple[Any, Any], x: np.ndarray, y: np.ndarray, more: float = 0.0
) -> np.ndarray:
    """Return by how much a sympy condition on two symbols holds at points: > 0 where it holds, 0 at
    its border.

    `more` is added to the margin of every inequality >= or <=, which also holds at its border.
    """
    import sympy as sp

    if condition == sp.true:
        return np.full_like(x, np.inf)
    if condition == sp.false:
        return np.full_like(x, -np.inf)
    if isinstance(condition, sp.And | sp.Or):
        margins = [_margin(part, letters, x, y, more) for part in condition.args]
        if isinstance(condition, sp.And):
            return np.min(margins, axis=0)
        return np.max(margins, axis=0)
    # sympy's names of the greater side and of the less one, of < and of > alike.
    difference = sp.lambdify(letters, condition.gts - condition.lts, "numpy")(x, y)
    return np.broadcast_to(difference, x.shape) + more * isinstance(condition, sp.Ge | sp.Le)


def _axis_range(region: ParameterRegion, name: str, limits: Any) -> tuple[float, float]:
    """Return the range of an axis: `limits`, or one with the parameter's value in it, and both belts
    for v1 or v2.
    """
    p = region.parameters
    if limits is not None:
        low, high = (float(read_exact(name, end)) for end in limits)
        if not low < high:
            raise ParameterError(name, limits, "must go from a lower to a higher value")
        return low, high
    value = abs(float(getattr(p, name)))
    if name in ("v1", "v2"):
        second_speed = abs(float(p.v2 if name == "v1" else p.v1))
    else:
        second_speed = 0.0
    # A second belt that is much faster does not stretch the axis.
    if value:
        second_speed = min(second_speed, 2 * value)
    reach = 2 * max(value, second_speed) or 1.0
    if name in ("k", "Omega"):
        return (0.0, reach)
    return (-reach, reach)


def _region_areas(
    axes: Axes, x: np.ndarray, y: np.ndarray, inside: np.ndarray, allowed: np.ndarray
) -> list[Any]:
    """Shade where `inside` > 0, hatch where `allowed` < 0, at the points (x, y), and return the
    legend entries.
    """
    entries = []
    shaded = np.minimum(inside, allowed)  # > 0 where both are
    if not (shaded > 0).any():
        box = {"facecolor": "white", "linewidth": 0}
        axes.text(0.5, 0.5, "nowhere here", transform=axes.transAxes, ha="center", bbox=box)
    for label, values, style in (("inside", shaded, INSIDE), ("not allowed", -allowed, FORBIDDEN)):
        if (values > 0).any():
            finite = np.nan_to_num(values, posinf=1.0, neginf=-1.0)
            hatch = style.get("hatch")
            filled: Record = {"colors": [style["facecolor"]], "hatches": [hatch], "zorder": 0}
            area = axes.contourf(x, y, finite, [0, np.inf], **filled)
            area.set(edgecolor=style["edgecolor"] if hatch else style["facecolor"], linewidth=0)
            entries.append(Patch(label=label, **style))
    return entries


def _region_borders(
    axes: Axes, x: np.ndarray, y: np.ndarray, inside: np.ndarray, closed: np.ndarray
) -> list[Any]:
    """Draw the border where `inside` is 0, full where `closed`, else broken, and return the legend
    entries.
    """
    shown: list[Any] = []
    for style, hidden, label in (
        (SOLID, ~closed, "border, inside"),
        (DASHES, closed, "border, not inside"),
    ):
        margin = np.ma.masked_invalid(np.where(hidden, np.nan, inside))
        if margin.count() == 0 or not margin.min() <= 0 <= margin.max():
            continue
        lines = axes.contour(
            x, y, margin, [0], colors=[INSIDE_COLOR], linewidths=1.2, linestyles=[style], zorder=2
        )
        # A shorter piece is only where two kinds of border meet.
        least_size = 0.01 * np.array([np.ptp(x), np.ptp(y)])
        (pieces,) = lines.allsegs  # of the only level, 0
        if any((np.ptp(piece, axis=0) > least_size).any() for piece in pieces if len(piece)):
            shown.append(
                Line2D([], [], color=INSIDE_COLOR, linewidth=1.2, linestyle=style, label=label)
            )
    return shown


def _mark_given(axes: Axes, region: ParameterRegion, spans: list[tuple[float, float]]) -> list[Any]:
    """Mark the point of the given parameter values if it is within the ranges `spans`.

    Return it for the legend.
    """
    names = region.question.names
    at = [float(getattr(region.parameters, name)) for name in names]
    if not all(low <= value <= high for value, (low, high) in zip(at, spans, strict=True)):
        return []
    inside = region.contains(**{name: getattr(region.parameters, name) for name in names})
    label = f"given values, {'inside' if inside else 'outside'}"
    style: Record = {
        "color": "black",
        "markerfacecolor": "black" if inside else "white",
        "markersize": 5,
        "zorder": 4,
    }
    return axes.plot(
        *([value] for value in at), "o", linestyle="none", clip_on=False, label=label, **style
    )


# -- grazing curves --------------------------------------------------------------------------------

#: Shapes of the ends inside a window, by how the reason begins; others are diamonds.
END_SHAPES = {"end of the window": "o", "beyond": "o", "the flow touches": "s"}
ANGLE_TICKS = {
    -2: r"$-\pi$",
    -1: r"$-\pi/2$",
    0: "0",
    1: r"$\pi/2$",
    2: r"$\pi$",
    3: r"$3\pi/2$",
    4: r"$2\pi$",
}


@public
def figure_grazing_curve(
    curve: GrazingCurve,
    panels: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw a grazing curve.

    Left: the switching plane, phases mod 2 pi, with the starts (x_i, Omega t_i) and the tangencies
    (x_m, theta_m). Right: how far the phase advances in the flight from start to tangency, over
    theta_m. Where a curve ends at an end of the window its dot is open, else full; phases in the
    window that no start reaches are shaded.

    Parameters
    ----------
    curve : GrazingCurve
    panels, ax, figsize : optional
        As for `symosc.plot.figure`. The panels are a switching plane, b flight. Default: both, with
        `ax` a.

    Examples
    --------
    >>> from symosc import grazing_curve, load_scene, plot
    >>> drawing = plot.figure_grazing_curve(grazing_curve(load_scene("fig9").parameters, "P2"))
    >>> drawing.axes[1].get_title()
    'flight to the grazing point'
    """
    require(GrazingCurve, curve=curve)
    # `panels_for` has drawn the panels when it yields their axes.
    with panels_for(curve, CURVE_PANELS, panels, ax, (3.5, 3.2), figsize=figsize) as (drawing, _):
        return drawing


def _draw_flight(axes: Axes, curve: GrazingCurve) -> None:
    """Draw the durations of the flights of a grazing curve, in phase, over the phase of the graze."""
    for piece in curve.pieces:
        axes.plot(piece.theta_m, piece.theta_m - piece.theta, color=START_COLOR, linewidth=1.2)
        _draw_ends(axes, piece, lambda end: (end.theta_m, end.theta_m - end.theta))
    for low, high, origin in curve.gaps:
        axes.axvspan(low, high, color="0.85", linewidth=0, label=f"from: {origin}")
    axes.set(
        xlabel=r"$\theta_m$", ylabel=r"$\theta_m - \Omega t_i$", title="flight to the grazing point"
    )
    spans = [(piece.low.theta_m, piece.high.theta_m) for piece in curve.pieces]
    spans += [(low, high) for low, high, _ in curve.gaps]
    # The axis begins where the curve is cut, so that a piece across the phase 0 stays whole.
    if spans:
        span = min(low for low, _ in spans), max(high for _, high in spans)
    else:
        span = 0, TURN
    _finish(axes, curve, span)


def draw_plane(axes: Axes, curve: GrazingCurve) -> None:
    """Draw the starts and the tangencies of a grazing curve on the switching plane."""
    for piece in curve.pieces:
        _line(axes, piece.theta, piece.x, color=START_COLOR, label="start")
        _line(
            axes,
            piece.theta_m,
            piece.x_m,
            color="#1f3fd6",
            label="grazing point",
            linestyle=(0, (4, 1.6)),
        )
        _draw_ends(axes, piece, lambda end: (end.theta % TURN, end.x))
    belt = place(curve.mapping).boundary
    title = rf"{typeset(curve.mapping)} on the plane $\dot x = v_{belt}$"
    axes.set(xlabel=r"$\mathrm{mod}(\Omega t, 2\pi)$", ylabel="$x$", title=title)
    _finish(axes, curve, (0, TURN))


CURVE_PANELS = {"a": draw_plane, "b": _draw_flight}


def _finish(axes: Axes, curve: GrazingCurve, span: tuple[float, float]) -> None:
    """Set the range `span` of phases, ticks and legend; write why the curve is empty if it is."""
    if not curve.pieces:
        if curve.windows:
            reason = "no start on this plane grazes"
        else:
            reason = "the window is empty"
        axes.text(0.5, 0.5, reason, transform=axes.transAxes, ha="center", va="center")
        axes.set_yticks([])
    axes.set_xlim(*span)
    low, high = axes.get_xlim()
    # Ticks at the quarter turns k pi/2 of the axis.
    quarters = [k for k in range(-4, 13) if low - 1e-9 <= k * pi / 2 <= high + 1e-9]
    names = [ANGLE_TICKS.get(k, rf"${k // 2 if k % 2 == 0 else f'{k}/2 '}\pi$") for k in quarters]
    axes.set_xticks([k * pi / 2 for k in quarters], names)
    entries = legend_entries([axes])
    if entries:
        axes.legend(list(entries.values()), list(entries), frameon=False, fontsize=7)


def _line(axes: Axes, theta: np.ndarray, x: np.ndarray, **style: Any) -> None:
    """Draw a curve over its phase modulo 2 pi, interrupted where that jumps back to 0."""
    turns = np.floor(theta / TURN)
    for rows in np.split(np.arange(len(theta)), np.nonzero(np.diff(turns))[0] + 1):
        axes.plot(theta[rows] - TURN * turns[rows], x[rows], linewidth=1.2, **style)


def _draw_ends(axes: Axes, piece: CurvePiece, at: Callable[[Any], tuple[float, float]]) -> None:
    """Mark both ends of a piece of a grazing curve, where `at(end)` says.

    At ends of the window the dots are open.
    """
    for end in (piece.low, piece.high):
        if end.reason != "closed":
            shape = next(
                (shape for start, shape in END_SHAPES.items() if end.reason.startswith(start)), "D"
            )
            if end.reason == "end of the window":
                face = "white"
            else:
                face = START_COLOR
            style: Record = {
                "marker": shape,
                "markersize": 3.5,
                "color": START_COLOR,
                "markerfacecolor": face,
            }
            x, y = at(end)
            axes.plot(
                [x], [y], linestyle="none", zorder=3, clip_on=False, label=end.reason, **style
            )
