"""Figures of motions and periodic orbits in the form of the paper's Figs. 5 to 10, of branches and
of borders.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from symosc.base.aliases import NumberLike, Record, SceneName
from symosc.base.arguments import (
    NUMBER,
    SCENE_NAME,
    WHOLE,
    public,
    require,
    require_or_none,
    sequence_of,
)
from symosc.base.errors import ParameterError
from symosc.base.exact import whole_number
from symosc.base.quantities import read_number
from symosc.plot import drawing as common
from symosc.plot.drawing import (
    PARAMETER_LABELS,
    FigureSize,
    axes_for,
    panels_for,
    read_panels,
    read_size,
    typeset,
    write_above,
)
from symosc.plot.panels import (
    INSET_ROOM,
    INSET_TOP,
    PANELS,
    SHAPES,
    Panel,
    View,
    draw_insets,
    mark_style,
    view_of,
)
from symosc.scenes import Scene, end_time, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

if TYPE_CHECKING:
    from symosc.orbits.border import Border
    from symosc.orbits.branch import Branch
    from symosc.orbits.periodic_orbit import PeriodicOrbit

#: Where figures of the shipped scenes end that run on for longer: what the paper's text speaks of
#: fills the panels.
SCENE_ENDS = {"fig5": 9.0, "fig6": 5.0, "fig8": 9.0}
#: A periodic scene is shown for this many periods of the excitation.
PERIODS_SHOWN = 2.5
#: More events than these are a black band, and take long to draw.
MOST_DRAWN_EVENTS = 1000

LEGEND_ORDER = (
    "mass",
    "belt",
    "onset of stick",
    "end of stick",
    "crossing",
    "grazing point",
    "start",
)


@public
def figure(
    subject: Trajectory | Scene | SceneName,
    *,
    t_end: NumberLike | None = None,
    panels: str | None = None,
    boundary: int | None = None,
    columns: int = 2,
    skip: NumberLike | None = None,
    ax: Axes | None = None,
    figsize: FigureSize = None,
    **style: Any,
) -> Figure:
    """Draw a motion: displacement, velocity, phase plane and forces.

    Parameters
    ----------
    subject : Trajectory, Scene or str
        A scene (or its name) is simulated first.
    t_end : number, optional
        End of the time axis, for scenes only. Default: the scene's own end; for a scene with a
        periodic structure a few periods, and for a scene of the paper the time that the paper
        describes.
    panels : str, optional
        Letters of the panels: a x(t), b x'(t), c phase plane, d forces against t, e forces against
        x, f forces against x', g the product of the forces against t (> 0 at a passage, < 0 in a
        stick). Default: "abcd", for scenes with a periodic structure "abcdef" (as the paper's Figs.
        9 and 10), with `ax` "a".
    boundary : int, optional
        1 to draw F^(1) and F^(2), 2 to draw F^(2) and F^(3) (accelerations, eq. (9)). Default: the
        boundary of the first event. Over sticks on a belt with static friction a band shows by how
        much it exceeds kinetic friction: where its edge comes to 0 the stick ends.
    columns : int, optional
        2: panels side by side, for the width of a page (7 in). 1: above each other, for one column
        of it (3.4 in). A phase plane alone is square.
    skip : number or str, optional
        The time from the start that is left out, such as a transient; "10T": ten periods of the
        drive.
    ax : matplotlib.axes.Axes, optional
        Axes to draw one panel into, without insets. Their figure is returned, a legend is left to
        the caller.
    figsize : (number, number), optional
        Width and height of the figure in inches. Default: enough for its panels.
    **style
        Properties of matplotlib's lines for the curves, such as ``color="black"`` or
        ``linewidth=2``. The two forces of a panel keep their colours. What you set in
        ``matplotlib.rcParams`` holds too.

    Examples
    --------
    >>> from symosc import plot
    >>> drawing = plot.figure("fig9", panels="ac")
    >>> [axes.get_xlabel() for axes in drawing.axes]
    ['time $t$', 'displacement $x$']
    """
    require(Trajectory, Scene, SCENE_NAME, subject=subject)
    require_or_none(NUMBER, t_end=t_end)
    if not isinstance(subject, Trajectory):
        if isinstance(subject, Scene):
            scene = subject
        else:
            scene = load_scene(subject)
        motion = simulated(scene, t_end)
        usual = default_panels(scene)
    elif t_end is not None:
        raise ParameterError(
            "t_end", t_end, "t_end applies to scenes only; a trajectory has its own"
        )
    elif len(subject.events) > MOST_DRAWN_EVENTS:
        allowed = f"a figure shows at most {MOST_DRAWN_EVENTS} events; simulate a shorter time"
        raise ParameterError("subject", subject, allowed)
    else:
        motion = subject
        usual = "abcd"
    panels = read_panels(usual if panels is None and ax is None else panels, PANELS, ax)
    if boundary is not None:
        boundary = whole_number("boundary", boundary, 1, len(motion.parameters.law.boundaries))
    columns = whole_number("columns", columns, 1, 2)
    if skip is None:
        since = -inf
    else:
        since = _time_after(motion, skip)
    view = view_of(motion, boundary, since=since, style=common.read_style(style, figure))
    read_size(figsize, ax, (0.0, 0.0))
    if ax is not None:
        PANELS[panels](ax, view)
        return common.figure_of(ax)
    if "b" in panels and view.magnified:
        tall = panels.index("b")
    else:
        tall = None
    if columns == 2 and panels != "c":
        width = 7.0
    else:
        width = 3.4
    drawn = [(PANELS[letter], view) for letter in panels]
    return assemble(drawn, min(columns, len(panels)), width, tall=tall, figsize=figsize)


def _time_after(motion: Trajectory, skip: NumberLike) -> float:
    """Return the time at which the part `skip` of a motion is over; ParameterError if it is not
    within the motion.
    """
    begin = float(motion.t_start)
    end = float(motion.t_end)
    # A text of periods such as "10T" becomes a time; anything else comes back as it is.
    time_after = end_time(skip, motion.parameters, begin)
    if time_after is skip:
        duration, _ = read_number("skip", skip)
        since = begin + float(duration)
    else:
        since = float(time_after)
    if not begin <= since < end:
        raise ParameterError("skip", skip, f"must be >= 0 and end before t = {end:g}")
    return since


def simulated(scene: Scene, t_end: NumberLike | None = None) -> Trajectory:
    """Return the motion of a scene up to `t_end` or, if that is None, to the default end of its
    figure.
    """
    if t_end is None:
        end = default_end(scene)
    else:
        end = t_end
    motion = simulate(scene, t_end=end, max_events=MOST_DRAWN_EVENTS)
    if motion.status == "max_events":
        last = f"t = {float(motion.t_end):.6g}, after {MOST_DRAWN_EVENTS} events"
        raise ParameterError(
            "t_end", end, f"a figure ends at {last}; give an earlier end, or start later"
        )
    return motion


@public
def orbit_figure(
    orbit: PeriodicOrbit,
    panels: str | None = None,
    *,
    columns: int = 2,
    ax: Axes | None = None,
    figsize: FigureSize = None,
    **style: Any,
) -> Figure:
    """Draw a periodic orbit for a few periods.

    Arguments as for `figure`, by default all panels or c.

    Examples
    --------
    >>> from symosc import find_orbit, load_scene, plot
    >>> orbit = find_orbit(load_scene("fig9").parameters, "P32")
    >>> [axes.get_ylabel() for axes in plot.orbit_figure(orbit, "c").axes]
    ['velocity $\\\\dot{x}$']
    """
    from symosc.orbits.periodic_orbit import PeriodicOrbit

    require(PeriodicOrbit, orbit=orbit)
    require(WHOLE, columns=columns)
    if not orbit.admissible:
        raise ParameterError("orbit", orbit.word, f"no motion follows it: it is {orbit.message}")
    motion = simulate_orbit(orbit, PERIODS_SHOWN)
    if panels is None:
        if ax is None:
            panels = "abcdef"
        else:
            panels = "c"
    return figure(
        motion,
        panels=panels,
        boundary=orbit.first_belt,
        columns=columns,
        ax=ax,
        figsize=figsize,
        **style,
    )


def simulate_orbit(orbit: PeriodicOrbit, periods: float) -> Trajectory:
    """Return the motion on an orbit, simulated from its first switching point for `periods` of its
    periods.
    """
    (t0, x0, v0) = orbit.start
    if orbit.stable is False:  # rounding grows, so that later periods would leave it
        periods = min(periods, 1)
    t_end = float(t0) + periods * orbit.span_of_loop
    return simulate(orbit.parameters, t0=t0, x0=x0, v0=v0, t_end=t_end)


def default_end(scene: Scene) -> Any:
    """Return the default end time of a scene's figure."""
    end: Any = SCENE_ENDS.get(scene.name, scene.t_end)
    if scene.structure:
        end = float(scene.t0) + PERIODS_SHOWN * 2 * pi / float(scene.parameters.Omega)
    # A scene of a shipped name may start later than the shipped one ends.
    if end > scene.t0:
        return min(end, scene.t_end)
    return scene.t_end


def default_panels(scene: Scene) -> str:
    """Return the default panels of a scene's figure."""
    if scene.structure:
        return "abcdef"
    return "abcd"


@common.own_style()
def assemble(
    panels: Sequence[tuple[Panel, View]],
    columns: int,
    width: float,
    *,
    tall: int | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw panels into one figure of this width in inches, or of `figsize`, with a letter for each
    and one legend below them.

    The panels stand in as many columns as `columns` says. If `tall` is given, the panel with this
    index is made taller, and the insets of its view stand above it.
    """
    ((first_panel, _), *others) = panels
    square = first_panel is PANELS["c"] and not others
    rows = -(-len(panels) // columns)  # rounded up
    heights = [3.0 if square else 2.0] * rows
    if tall is not None:
        heights[tall // columns] *= 1 + INSET_ROOM  # the panel itself is as high as the others
    layout = ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.04)
    size = read_size(figsize, None, (width, sum(heights) + 0.35))
    width, _ = size
    drawing = common.Drawing(figsize=size, layout=layout)
    grid = drawing.add_gridspec(len(heights), columns, height_ratios=heights)
    for number, (panel, view) in enumerate(panels):
        cell = grid[number // columns, number % columns]
        if number == tall:
            # The panel has the lower part, and the insets stand in the upper one.
            cell = cell.subgridspec(2, 1, height_ratios=(INSET_ROOM, 1.0))[1]
        ax = drawing.add_subplot(cell)
        panel(ax, view)
        if number == tall:
            draw_insets(ax, view)
        if len(panels) > 1:
            position: Record = {"x": -0.12} | ({"y": INSET_TOP} if number == tall else {})
            title = ax.set_title(f"({'abcdefg'[number]})", loc="left", pad=4, **position)
            title.set_in_layout(number != tall)  # the grid keeps that room free
        elif square:
            ax.set_box_aspect(1)
        ax.tick_params(labelfontfamily=rcParams["font.family"][0])
    entries = common.legend_entries(ax for ax in drawing.axes)
    for label in entries.keys() & SHAPES.keys():  # in full size, however small the marks are
        style = mark_style(label, entries[label].get_markerfacecolor())
        entries[label] = Line2D([], [], linestyle="none", **style)
    order = [label for label in LEGEND_ORDER if label in entries]
    order += [label for label in entries if label not in order]  # the forces
    # In a row at most one entry for each inch of width.
    legend_rows = -(-len(order) // max(1, round(width)))
    if legend_rows == 2:
        # It is filled by columns: lines, sticks and forces first, so that pairs stand in one.
        pairs = ("mass", "belt", "onset of stick", "end of stick")
        order.sort(key=lambda label: label not in pairs and not label.startswith("$F"))
    legend = {label: entries[label] for label in order}
    common.add_legend(drawing, None, legend, -(-len(order) // legend_rows))
    return drawing


# -- branches --------------------------------------------------------------------------------------

# Colours that differ with any colour vision (Okabe and Ito), one for each switching point.
CURVE_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
END_MARKERS = {
    "grazing": "o",
    "birth of a stick": "^",
    "vanishing of a stick": "v",
    "birth of a slip": ">",
    "vanishing of a slip": "<",
    "vanishing of a flight": "P",
    "onset at a corner": "*",
}
SPECIAL_MARKERS = {"fold": "D", "period doubling": "s", "Neimark-Sacker": "h"}
ORDINALS = ("", "2nd ", "3rd ")
#: The least distance of labels at the right end of the curves, as a part of their whole range.
LABEL_GAP = 0.05
# Stability -> line style; the styles differ without colours.
STABILITY_STYLES: Record = {"stable": "-", "marginal": "-.", "not stable": (0, (4, 2))}


@public
def branch_figure(
    branch: Branch, panels: str | None = None, *, ax: Axes | None = None, figsize: FigureSize = None
) -> Figure:
    """Draw a branch: position at each switching and moduli of the multipliers over the parameter.

    Solid lines are stable orbits. Dash-dotted ones are marginal: a multiplier is on the unit
    circle, which is dotted. Dashed ones are not stable. Marks tell why the branch ends. The words
    above the last panel name the orbit on the branch and those behind its ends.

    Parameters
    ----------
    branch : Branch
    panels, ax, figsize : optional
        As for `symosc.plot.figure`. The panels are a positions, b multipliers. Default: both, with
        `ax` b.

    Examples
    --------
    >>> from symosc import continue_orbit, load_scene, plot
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.9, 4.1))
    >>> [axes.get_ylabel() for axes in plot.branch_figure(branch).axes]
    ['position $x$ at the switching', 'moduli of the multipliers']
    """
    from symosc.orbits.branch import Branch

    require(Branch, branch=branch)
    layout: Record = {"alone": "b", "letter_at": -0.12}
    # `panels_for` has drawn the panels when it yields their axes.
    with panels_for(branch, BRANCH_PANELS, panels, ax, (3.5, 3.1), figsize=figsize, **layout) as (
        drawing,
        row,
    ):
        for axes in row:
            axes.set_xlabel(PARAMETER_LABELS.get(branch.parameter, f"${branch.parameter}$"))
            for end in branch.ends:
                if end.kind in END_MARKERS:
                    axes.axvline(end.value, color="0.6", lw=0.6, zorder=0)
        _write_words(row[-1], branch)
        entries = common.legend_entries(row)
        # The unit circle comes last in the legend. Only the panel of multipliers shows it.
        unit_circle = {}
        if "unit circle" in entries:
            unit_circle["unit circle"] = entries.pop("unit circle")
        for kind in dict.fromkeys(end.kind for end in branch.ends if end.kind in END_MARKERS):
            entries[kind] = Line2D(
                [], [], linestyle="none", marker=END_MARKERS[kind], ms=5.0, color="black"
            )
        for kind in dict.fromkeys(place.kind for place in branch.special):
            entries[kind] = Line2D(
                [], [], linestyle="none", marker=SPECIAL_MARKERS[kind], ms=5.0, color="black"
            )
        for name in [name for name in STABILITY_STYLES if name in stability(branch)]:
            entries[name] = Line2D([], [], color="black", ls=STABILITY_STYLES[name], lw=1.2)
        common.add_legend(drawing, ax, entries | unit_circle, 3 * len(row))
    return drawing


def _positions(ax: Axes, branch: Branch) -> None:
    """Draw the positions of the switching points over the parameter, or of a cycle without them its
    least and its largest position.
    """
    if not branch.labels:
        for rows, look in _stretches(branch):
            for x in branch.extents.T:
                ax.plot(branch.values[rows], x[rows], color=CURVE_COLORS[0], ls=look, lw=1.2)
        _mark_ends(ax, branch, [branch.extents[0], branch.extents[-1]], CURVE_COLORS[0])
        ax.margins(x=0.09)
        ax.set_ylabel("least and largest position $x$")
        return
    # Rows: the orbits of the branch; columns: their switching points.
    _, x = np.moveaxis(branch.points, -1, 0)
    for i, label in enumerate(branch.labels):
        color = CURVE_COLORS[i % len(CURVE_COLORS)]
        earlier = branch.labels[:i].count(label)
        if earlier < len(ORDINALS):
            name = f"start of {ORDINALS[earlier]}{label}"
        else:
            name = None
        for rows, look in _stretches(branch):
            ax.plot(
                branch.values[rows],
                x[rows, i],
                color=color,
                ls=look,
                lw=1.2,
                label=name,
            )
        _mark_ends(ax, branch, [[end.points[i].x] for end in branch.ends], color)
    last = int(np.argmax(branch.values))
    height = -inf
    least_gap = LABEL_GAP * float(np.ptp(x))
    for i in np.argsort(x[last]):  # from below, so that no label covers another
        height = max(float(x[last, i]), height + least_gap)
        position = branch.values[last], height
        ax.annotate(
            typeset(branch.labels[i]),
            position,
            (4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    ax.margins(x=0.09)
    ax.set_ylabel("position $x$ at the switching")


def _multipliers(ax: Axes, branch: Branch) -> None:
    """Draw the moduli of the multipliers over the parameter."""
    for rows, look in _stretches(branch):
        values, sizes = multiplier_curves(branch.values[rows], branch.multipliers[rows])
        larger, smaller = sizes.T
        for curve in (larger, smaller):
            ax.plot(values, curve, color="black", ls=look, lw=1.2)
    sizes = np.abs(branch.multipliers)
    _mark_ends(ax, branch, [sizes[0], sizes[-1]], "black")
    for place in branch.special:
        marker = SPECIAL_MARKERS[place.kind]
        ax.plot(place.value, 1.0, linestyle="none", marker=marker, ms=5.0, color="black")
    ax.axhline(1, color="0.4", lw=0.8, ls=(0, (1, 2)), zorder=0, label="unit circle")
    top = max(float(sizes.max()), 1.0)
    ax.set_ylim(-0.04 * top, 1.12 * top)
    ax.set_ylabel("moduli of the multipliers")


BRANCH_PANELS = {"a": _positions, "b": _multipliers}


def multiplier_curves(values: np.ndarray, multipliers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Interpolate part of a branch: return many parameter values, and at each the moduli of both
    multipliers, the larger one first.
    """
    # Trace and determinant of the monodromy matrix are smooth along a branch and are interpolated;
    # the multipliers are not where a real pair turns complex, and follow from them.
    trace = multipliers.sum(axis=1).real
    determinant = multipliers.prod(axis=1).real
    columns = np.column_stack([values, trace, determinant])
    # The abscissa is the length of the curve of all three, each in units of its range.
    sizes = np.ptp(columns, axis=0)
    steps = np.linalg.norm(np.diff(columns, axis=0) / np.where(sizes == 0, 1, sizes), axis=1)
    # scipy.interpolate takes longer to load than most figures to draw.
    from scipy.interpolate import Akima1DInterpolator

    # The interpolation needs abscissas that increase, so points at no distance are left out.
    keep = np.concatenate([[True], steps > 1e-12])
    along = np.cumsum(np.concatenate([[0.0], steps]))[keep]
    if len(along) > 2:
        fine = np.unique(np.concatenate([np.linspace(a, b, 24) for a, b in pairwise(along)]))
        columns = Akima1DInterpolator(along, columns[keep], method="makima")(fine)
    values, trace, determinant = columns.T
    # Multipliers are the roots of z^2 - trace z + determinant.
    root = np.sqrt((trace * trace - 4 * determinant).astype(complex))
    moduli = np.abs(np.column_stack([trace + root, trace - root])) / 2
    return values, np.sort(moduli)[:, ::-1]


def _mark_ends(ax: Axes, branch: Branch, heights: Sequence[Any], color: str) -> None:
    """Mark both ends of the branch, at the `heights` given for each end, with symbols for why it
    ends.
    """
    style: Record = {
        "ms": 5.0,
        "mfc": color,
        "mec": "white",
        "mew": 0.5,
        "zorder": 5,
        "clip_on": False,
    }
    for end, places in zip(branch.ends, heights, strict=True):
        for height in places if end.kind in END_MARKERS else ():
            ax.plot(end.value, height, linestyle="none", marker=END_MARKERS[end.kind], **style)


def _write_words(ax: Axes, branch: Branch) -> None:
    """Write above the axes the word of the branch, over its middle, and at its ends the words of
    the orbits beyond.
    """
    from symosc.orbits.branch import MOST, NO_CONVERGENCE

    words: list[Any] = [(0.5 * (branch.values.min() + branch.values.max()), branch.word)]
    words += [
        (end.value, end.kind if end.kind in (NO_CONVERGENCE, MOST) else end.beyond)
        for end in branch.ends
    ]
    for abscissa, word in words:
        if word:
            write_above(ax, abscissa, typeset(word))


def stability(branch: Branch) -> np.ndarray:
    """Return for each orbit of a branch "stable", "marginal" or "not stable", the keys of
    `STABILITY_STYLES`.
    """
    # What is not stable is marginal if no multiplier is outside the unit circle by more than
    # rounding.
    from symosc.orbits.floquet import NEAR_ONE

    sizes = np.abs(branch.multipliers).max(axis=1)
    return np.where(
        branch.stable, "stable", np.where(sizes <= 1 + NEAR_ONE, "marginal", "not stable")
    )


def _stretches(branch: Branch) -> list[tuple[slice, Any]]:
    """Return for each stretch of equal stability its slice of the branch's points, and its line
    style.
    """
    states = stability(branch)
    count = len(states)
    cuts = [0, *(np.flatnonzero(states[1:] != states[:-1]) + 1), count]
    # A stretch has the first point of the next one too: the lines join.
    return [
        (slice(begin, min(end + 1, count)), STABILITY_STYLES[str(states[begin])])
        for begin, end in pairwise(cuts)
    ]


# -- borders ---------------------------------------------------------------------------------------

#: Line styles of borders by their names: they differ without colours.
BORDER_STYLES: Record = {
    "crossing-sliding": {"color": "#000000", "linestyle": "-"},
    "grazing-sliding": {"color": "#0072b2", "linestyle": "--"},
    "switching-sliding": {"color": "#d55e00", "linestyle": "-."},
    "adding-sliding": {"color": "#009e73", "linestyle": ":"},
}
WORD_OFFSET = 11.0  # of the words beside a border, in points


@public
def border_figure(
    border: Border | Sequence[Border],
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
    **style: Any,
) -> Figure:
    """Draw borders in their plane of two parameters, with the special points, and the words on both
    sides.

    The words stand beside a single border, and in the legend where there are several.

    Parameters
    ----------
    border : Border, or several of them
        Several must have the same two parameters, in either order.
    ax, **style : optional
        As for `symosc.plot.figure`.

    Examples
    --------
    >>> from symosc import continue_border, continue_orbit, load_scene, plot
    >>> branch = continue_orbit(load_scene("fig9").parameters, "P32", "Omega", (3.2, 4))
    >>> drawing = plot.border_figure(continue_border(branch, 0, "FN", (9, 11), step="0.05"))
    >>> drawing.axes[0].get_ylabel()
    '$F_N$'
    """
    from symosc.orbits.border import Border

    require(Border, sequence_of(Border), border=border)
    if isinstance(border, Sequence):
        borders = list(border)
    else:
        borders = [border]
    planes = {frozenset(getattr(curve, "parameters", ())) for curve in borders}
    if len(planes) != 1 or frozenset() in planes:
        raise ParameterError(
            "border", border, "must be one border or several of the same two parameters"
        )
    names = borders[0].parameters
    line_style = common.read_style(style, border_figure)
    with axes_for(ax, (4.6, 3.4), figsize=figsize) as (drawing, (axes,)):
        for curve in borders:
            columns = [curve.parameters.index(name) for name in names]
            name = curve.sliding or curve.kind
            words = " | ".join(sorted(typeset(word or "no word") for word in curve.words))
            if len(borders) == 1:
                label = name
            else:
                label = f"{words}, {name}"
            # Later ones win: the caller's style, the kind of border, the rest.
            look = (
                {"linewidth": 1.3, "color": "0.4", "label": label}
                | BORDER_STYLES.get(name, {})
                | line_style
            )
            axes.plot(*curve.points[:, columns].T, **look)
        x_name, y_name = names
        axes.set(xlabel=PARAMETER_LABELS[x_name], ylabel=PARAMETER_LABELS[y_name])
        axes.margins(0.06)
        if len(borders) == 1:
            drawing.draw_without_rendering()  # the limits of the axes decide which way is across
            _write_words_beside(axes, borders[0])
        _draw_special_points(axes, borders, names)
        common.add_legend(drawing, ax, [axes], 3 if len(borders) == 1 else 2)
    return drawing


def _draw_special_points(axes: Axes, borders: Sequence[Border], names: Sequence[str]) -> None:
    """Draw the folds (open) and points of codimension two (full) of borders, in the plane of the
    parameters `names`.
    """
    # By their values: a point that two borders share is drawn once.
    special = {point.values: (point, curve) for curve in borders for point in curve.special}
    for point, curve in special.values():
        coordinates = [point.values[curve.parameters.index(name)] for name in names]
        if point.kind == "fold":
            face = "white"
            label = "fold"
        else:
            face = "k"
            label = "codimension two"
        look: Record = {
            "ms": 4.5,
            "mfc": face,
            "mec": "black",
            "mew": 0.8,
            "zorder": 5,
            "linestyle": "none",
        }
        axes.plot(*coordinates, marker="o", label=label, **look)


def _write_words_beside(ax: Axes, border: Border) -> None:
    """Write the words that hold on both sides of a border beside it, where it is farthest from the
    axes' frame.
    """

    def room(i: int) -> float:
        """Return how far the point i is from the axes' frame, as a part of the axes' size."""
        within = ax.transAxes.inverted().transform(ax.transData.transform(border.points[i]))
        return float(min(*within, *(1 - within)))

    # Seven points evenly along the border, without its ends.
    i = max((len(border) * eighth // 8 for eighth in range(1, 8)), key=room)
    for word, neighbour in zip(border.words, border.beside(i, "1e-3"), strict=True):
        coordinates = [float(neighbour.numbers()[name]) for name in border.parameters]
        direction = ax.transData.transform(coordinates) - ax.transData.transform(border.points[i])
        x, y = WORD_OFFSET * direction / np.linalg.norm(direction)
        if abs(x) < WORD_OFFSET / 2:
            side: Any = "center"
        elif x > 0:
            side = "left"
        else:
            side = "right"
        style: Record = {"textcoords": "offset points", "fontsize": 8, "ha": side, "va": "center"}
        ax.annotate(typeset(word or "no word"), border.points[i], (x, y), **style)
