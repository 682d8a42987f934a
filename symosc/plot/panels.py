"""The contents of a figure's panels: the mass, the belts, the forces, and a mark for each event.

Every kind of event has a shape of its own and the upper force is dashed, so that nothing rests on
colour alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import floor, inf, log10, pi, sqrt
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from symosc.base.aliases import Record
from symosc.friction import geometry
from symosc.simulation.trajectory import MovedTrajectory, Trajectory, belt_path

BELT_COLOR = "black"
MASS_COLOR = "#d7191c"
ONSET_COLOR = "#1f3fd6"
END_COLOR = "#0f8a2a"
SWITCH_COLOR = "#d7191c"
FORCE_BELOW = ONSET_COLOR
FORCE_ABOVE = END_COLOR

#: Shape and size (points) of each mark. Over its onset the end of a stick leaves a rim, because it
#: is smaller.
SHAPES = {
    "start": ("o", 4.2),
    "onset of stick": ("o", 5.4),
    "start of period": ("o", 5.4),
    "end of stick": ("s", 3.7),
    "end of period": ("s", 3.7),
    "crossing": ("^", 5.6),
    "grazing point": ("*", 8.0),
    "contact": ("*", 8.0),
}
#: Name and colour of the mark of each kind of event.
EVENT_MARKS = {
    "stick": ("onset of stick", ONSET_COLOR),
    "slip": ("end of stick", END_COLOR),
    "cross": ("crossing", SWITCH_COLOR),
    "graze": ("grazing point", SWITCH_COLOR),
}

# A stick shorter than this fraction of the time axis would be a dot: it gets an inset.
SHORT_STICK = 0.01
MOST_INSETS = 2
#: The entry of the legend for what static friction adds.
HOLD_LABEL = "static friction"
#: By how much of the range of the velocities an axis may be longer to show a belt's speed.
LONGER_AXIS = 0.65
#: Belts nearer than this part of the axis have names that would lie over each other.
NAMES_TOUCH = 0.08


class Mark(NamedTuple):
    """A mark on the curves: its label and colour, its time, and the belt of its event (None if it
    has none).
    """

    label: str
    color: str
    t: float
    belt: int | None = None


class Contact(NamedTuple):
    """A contact with a belt: a stick from `since` to `until`, or a graze, for which these times are
    equal.
    """

    since: float
    until: float
    belt: int


@dataclass(frozen=True)
class View:
    """What the panels draw: samples t, x, v of a trajectory, marks for its events, and its contacts
    with the belts.

    The forces are those on both sides of `boundary`, the number of a belt. Panel (a) shows the path of a
    point of the belt at each of the `contacts`. The path goes beyond the contact by the fractions
    `belt_reach` of the width and the height of the axes. Panel (b) shows the `magnified` contacts
    in insets. `style` has properties of the curves as matplotlib names them.
    """

    trajectory: Trajectory
    boundary: int
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    marks: tuple[Mark, ...]
    contacts: tuple[Contact, ...]
    magnified: tuple[Contact, ...]
    belt_reach: tuple[float, float] = (0.06, 0.15)
    style: Record = field(default_factory=dict)

    @property
    def scale(self) -> float:
        """The relative size of marks and lines: 1 for up to 16 marks, smaller if there are more."""
        return max(min(1.0, sqrt(16 / max(len(self.marks), 1))), 0.2)

    @property
    def domains(self) -> tuple[int, int]:
        """The domains below and above the boundary whose forces are drawn."""
        law = self.trajectory.parameters.law
        return geometry(len(law.belts)).neighbours[self.boundary]

    @property
    def hold(self) -> float:
        """By how much the acceleration that the belt `boundary` can withstand exceeds that of its
        kinetic friction.
        """
        p = self.trajectory.parameters
        return float(p.law.excess(self.boundary) / p.m)

    @property
    def belts_move(self) -> bool:
        """Whether the speeds of the belts change, as they may in another model."""
        return (
            isinstance(self.trajectory, MovedTrajectory)
            and self.trajectory.model.shift.bound() != 0
        )

    def speed_of(self, belt: int) -> float:
        """Return the mean speed of a belt, in the coordinates of the trajectory."""
        return self._moved(self.trajectory.parameters.belt(belt))

    def corners(self) -> list[float]:
        """Return the speeds of the corners of friction curves among the velocities drawn."""
        edges = self.trajectory.parameters.law.edges
        speeds = [self._moved(edge.v) for edge in edges if not edge.belt]
        return [speed for speed in speeds if self.v.min() < speed < self.v.max()]

    def _moved(self, speed: Fraction) -> float:
        """Return a speed of the law in the coordinates of the trajectory."""
        if isinstance(self.trajectory, MovedTrajectory):
            speed += self.trajectory.model.pull
        return float(speed)

    def belts(self) -> list[int]:
        """Return the belts to draw: `boundary`, and any belt with a speed near the velocities
        drawn.
        """
        low = self.v.min()
        high = self.v.max()
        p = self.trajectory.parameters
        allowed = LONGER_AXIS * (high - low)
        near_belts = [
            belt
            for belt in p.law.boundaries
            if low - allowed <= self.speed_of(belt) <= high + allowed
        ]
        return sorted({*near_belts, self.boundary})


def boundary_of(mode: str) -> int:
    """Return the number of the belt in the name of a stick."""
    return int(mode.removeprefix("belt"))


class Sampling(NamedTuple):
    """The density of a curve's points: how many in a period, at least between two events, and at
    most in all.
    """

    per_period: int  # of the drive, or of the free oscillation if that is shorter
    least: int  # between two events
    most: int  # in the whole motion


FINE = Sampling(per_period=120, least=40, most=20_000)


def view_of(
    trajectory: Trajectory,
    boundary: int | None,
    sampling: Sampling = FINE,
    since: float = -inf,
    style: Record | None = None,
) -> View:
    """Sample a trajectory from the time `since` on, and return what the panels draw of it."""
    p = trajectory.parameters
    events = trajectory.events
    start = float(trajectory.t_start)
    t = _sample_times(trajectory, sampling, since)
    x, v = trajectory(t)
    first_mode = trajectory.segments[0].mode
    sticks_first = first_mode.startswith("belt")
    if boundary is None:
        # The belt of the first contact, else the one that the velocity comes nearest to.
        if sticks_first:
            boundary = boundary_of(first_mode)
        elif events:
            boundary = events[0].boundary
        else:
            boundary = min(p.law.boundaries, key=lambda belt: np.abs(v - float(p.belt(belt))).min())
    contacts = _sticks(trajectory)
    contacts += [
        Contact(float(event.t), float(event.t), event.boundary)
        for event in events
        if event.kind == "graze"
    ]
    contacts = [
        Contact(max(contact.since, t[0]), contact.until, contact.belt)
        for contact in contacts
        if contact.until >= t[0]
    ]
    if sticks_first:
        marks = [Mark("onset of stick", ONSET_COLOR, start, boundary_of(first_mode))]
    else:
        marks = [Mark("start", "white", start)]
    marks += [Mark(*EVENT_MARKS[event.kind], float(event.t), event.boundary) for event in events]
    return View(
        trajectory,
        boundary,
        t,
        x,
        v,
        marks=tuple(mark for mark in marks if mark.t >= since),
        contacts=tuple(contacts),
        magnified=_inset_sticks(contacts, t),
        style=style or {},
    )


def _sample_times(trajectory: Trajectory, sampling: Sampling, since: float) -> np.ndarray:
    """Return times that resolve every segment, denser after its start, including the events."""
    p = trajectory.parameters
    period = 2 * pi / max(float(p.Omega), sqrt(p.k / p.m))
    edges = [float(segment.t_start) for segment in trajectory.segments] + [float(trajectory.t_end)]
    if since > edges[0]:
        edges = [since, *(edge for edge in edges if edge > since)]
    step = max(period / sampling.per_period, (edges[-1] - edges[0]) / sampling.most)
    # Denser at the start of a segment, where a velocity leaves a belt.
    start = np.linspace(0, 1, sampling.least // 2) ** 4
    times = []
    for low, high in pairwise(edges):
        even = np.linspace(0, 1, int(min(max((high - low) / step, sampling.least), sampling.most)))
        # Without the upper edge, which would be rounded; all edges are added below.
        times.append(low + (high - low) * np.union1d(even, start)[:-1])
    return np.clip(np.unique(np.concatenate([*times, edges])), edges[0], edges[-1])


# --- the panels ---

AXIS_LABELS = {"t": "time $t$", "x": "displacement $x$", "v": r"velocity $\dot{x}$"}
#: Their units, that of the forces per mass F, and that of products of these.
AXIS_UNITS = {"t": "s", "x": "m", "v": "m/s", "F": "m/s$^2$", "FF": "m$^2$/s$^4$"}


def _with_unit(text: str, quantity: str, view: View) -> str:
    """Return the label of an axis, with the unit of the quantity if the view has units."""
    if view.trajectory.in_si:
        return f"{text} ({AXIS_UNITS[quantity]})"
    return text


def _motion_panel(ax: Axes, view: View, across: str, up: str) -> None:
    """Draw `up` ("x" or "v") against `across` ("t", "x" or "v"), with marks, and paths or speeds of
    the belts.
    """
    style: Record = {
        "color": MASS_COLOR,
        "linewidth": 1.3 * max(view.scale, 0.5),
        "label": "mass",
    } | view.style
    ax.plot(getattr(view, across), getattr(view, up), **style)
    ax.set_ylabel(_with_unit(AXIS_LABELS[up], up, view))
    if up == "x":
        _belt_points(ax, view)
    elif across == "t" or not view.belts_move:
        _belt_speeds(ax, view)

    def height(t: Any) -> Any:
        x, v = view.trajectory(t)
        return v if up == "v" else x

    _draw_marks(ax, view, view.marks, across, height)
    _horizontal_axis(ax, view, across)


def _force_panel(ax: Axes, view: View, across: str) -> None:
    """Draw the forces on both sides of the boundary over t (with sticks shaded), x, or v (with the
    belts).
    """
    force = view.trajectory.force
    marks = _marks_of_forces(view)
    (below, above) = view.domains
    if across == "t":
        _shade_sticks(ax, view)
    ax.axhline(0, color="0.6", lw=0.6, zorder=0)
    user_style = {
        name: value
        for name, value in view.style.items()
        if name not in ("color", "linestyle", "label")
    }
    for domain, color, style in ((below, FORCE_BELOW, "-"), (above, FORCE_ABOVE, (0, (4, 1.6)))):
        line: Record = {
            "color": color,
            "linestyle": style,
            "linewidth": max(view.scale, 0.5),
        } | user_style
        ax.plot(getattr(view, across), force(domain, view.t), label=f"$F^{{({domain})}}$", **line)
    if across == "t" and view.hold:
        _hold_bands(ax, view)
    for domain in (below, above):
        _draw_marks(ax, view, marks, across, partial(force, domain))
    forces = f"forces per mass $F^{{({below})}}$, $F^{{({above})}}$"
    ax.set_ylabel(_with_unit(forces, "F", view))
    if across == "t":
        crossings = [mark.t for mark in marks if mark.label == "crossing"]
        ax.vlines(
            crossings,
            force(below, crossings),
            force(above, crossings),
            color="0.6",
            lw=0.6,
            zorder=0,
        )
    for belt in view.belts() if across == "v" and not view.belts_move else ():
        speed = view.speed_of(belt)
        ax.axvline(speed, color=BELT_COLOR, lw=0.6, zorder=1, label="belt")
        ax.annotate(
            f"$v_{belt}$",
            (speed, 1),
            (0, 2),
            ("data", "axes fraction"),
            "offset points",
            ha="center",
        )
    _horizontal_axis(ax, view, across)


def _product_panel(ax: Axes, view: View) -> None:
    """Draw the product of both forces at the boundary: > 0 where the mass would cross it, < 0 where
    it would stick.

    With static friction E it is that of the forces that decide this.
    """
    force = view.trajectory.force
    (below, above) = view.domains
    hold = view.hold

    def product(t: Any) -> Any:
        return (np.asarray(force(below, t)) + hold) * (force(above, t) - hold)

    _shade_sticks(ax, view)
    ax.axhline(0, color="0.6", lw=0.6, zorder=0)
    style: Record = {"color": "black", "linewidth": max(view.scale, 0.5)} | view.style
    ax.plot(view.t, product(view.t), **style)
    _draw_marks(ax, view, _marks_of_forces(view), "t", product)
    if hold:
        factors = f"(F^{{({below})}} + E)\\, (F^{{({above})}} - E)"
    else:
        factors = f"F^{{({below})}}\\, F^{{({above})}}"
    ax.set_ylabel(_with_unit(f"product ${factors}$", "FF", view))
    _horizontal_axis(ax, view, "t")


Panel = Callable[[Axes, View], None]

PANELS: dict[str, Panel] = {
    "a": partial(_motion_panel, across="t", up="x"),
    "b": partial(_motion_panel, across="t", up="v"),
    "c": partial(_motion_panel, across="x", up="v"),
    "d": partial(_force_panel, across="t"),
    "e": partial(_force_panel, across="x"),
    "f": partial(_force_panel, across="v"),
    "g": _product_panel,
}


# --- parts of panels ---


def _horizontal_axis(ax: Axes, view: View, across: str) -> None:
    """Label the horizontal axis with the quantity `across`, and limit a time axis to the samples."""
    # A motion may be too short for doubles to tell its end from its start.
    if across == "t" and view.t[0] < view.t[-1]:
        ax.set_xlim(view.t[0], view.t[-1])
    ax.set_xlabel(_with_unit(AXIS_LABELS[across], across, view))


def _belt_points(ax: Axes, view: View) -> None:
    """Draw, for each contact, the position over time of the point of the belt that the mass
    touches.
    """
    low, high = ax.get_ylim()
    width_part, height_part = view.belt_reach
    most_time = width_part * (view.t[-1] - view.t[0])
    most_way = height_part * (high - low)
    for contact in view.contacts:
        path = partial(belt_path, view.trajectory, contact.belt)
        x, _ = view.trajectory(contact.since)
        (begin,), (speed,) = path(np.array([contact.since]))
        if speed:
            reach = min(most_time, most_way / abs(speed))
        else:
            reach = most_time
        t = np.linspace(contact.since - reach, contact.until + reach, 200 if view.belts_move else 2)
        belt_positions, _ = path(t)
        # Below the mass: in a stick both have one path, and the mass is seen.
        ax.plot(t, x + belt_positions - begin, color=BELT_COLOR, lw=0.6, zorder=1, label="belt")
    ax.set_ylim(low, high)


def _belt_speeds(ax: Axes, view: View) -> None:
    """Draw lines at the speeds of the belts, with their names on the right."""
    # Below the mass, which is seen in a stick; the line goes on at both sides of it.
    low, high = ax.get_ylim()
    if not view.belts_move:
        for corner in view.corners():
            ax.axhline(corner, color=BELT_COLOR, lw=0.4, ls=(0, (1, 4)), zorder=0)
    belts = view.belts()
    speeds = [view.speed_of(belt) for belt in belts]
    gap = min((upper - lower for lower, upper in pairwise(speeds)), default=inf)
    names_touch = gap < NAMES_TOUCH * (high - low)
    for belt, speed in zip(belts, speeds, strict=True):
        # In points, the lower name down and the upper one up.
        shift = 0
        if names_touch:
            shift = {belts[0]: -5, belts[-1]: 5}.get(belt, 0)
        if view.belts_move:
            _, path = belt_path(view.trajectory, belt, view.t)
            ax.plot(view.t, path, color=BELT_COLOR, lw=0.6, zorder=1, label="belt")
            speed = float(path[-1])
        else:
            ax.axhline(speed, color=BELT_COLOR, lw=0.6, zorder=1, label="belt")
        ax.annotate(
            f"$v_{belt}$",
            (1, speed),
            (4, shift),
            ("axes fraction", "data"),
            "offset points",
            va="center",
        )


def _marks_of_forces(view: View) -> list[Mark]:
    """Return the marks for the panels of forces: all but the start and events at the belt that is
    not `boundary`.
    """
    return [
        mark for mark in view.marks if mark.label != "start" and mark.belt in (view.boundary, None)
    ]


def _shade_sticks(ax: Axes, view: View) -> None:
    """Shade the times at which the mass sticks to the belt `boundary` of the view."""
    for stick in _sticks(view.trajectory):
        if stick.belt == view.boundary:
            ax.axvspan(stick.since, stick.until, color="0.92", lw=0, zorder=-1)


def _hold_bands(ax: Axes, view: View) -> None:
    """Draw, over each stick, what static friction adds to the forces: the stick ends where the edge
    of this band comes to 0.
    """
    (below, above) = view.domains
    for stick in _sticks(view.trajectory):
        held = view.t[(view.t >= stick.since) & (view.t <= stick.until)]
        if stick.belt != view.boundary or len(held) < 2:
            continue
        for domain, side, color in ((below, 1, FORCE_BELOW), (above, -1, FORCE_ABOVE)):
            kinetic = view.trajectory.force(domain, held)
            ax.fill_between(
                held,
                kinetic,
                kinetic + side * view.hold,
                color=color,
                alpha=0.18,
                lw=0,
                zorder=0.5,
                label=HOLD_LABEL,
            )


def _draw_marks(
    ax: Axes, view: View, marks: Sequence[Mark], across: str, up: Callable[[Any], Any]
) -> None:
    """Draw marks on a curve; `up` returns the height of the curve at given times."""
    for label, color in dict.fromkeys((mark.label, mark.color) for mark in marks):
        t = np.array([mark.t for mark in marks if mark.label == label])
        if across == "t":
            abscissas = t
        else:
            x, v = view.trajectory(t)
            abscissas = v if across == "v" else x
        style = mark_style(label, color, view.scale)
        ax.plot(abscissas, up(t), linestyle="none", clip_on=False, label=label, **style)


def mark_style(label: str, color: str, scale: float = 1.0) -> Record:
    """Return shape, colours and size of a mark as matplotlib's options of a line."""
    marker, size = SHAPES[label]
    if label == "start":
        edge = "black"
        width = 0.8
        level = 4
    else:
        edge = "white"
        width = 0.4
        level = 5
    level += color == END_COLOR  # the end of a stick over its onset
    return {
        "marker": marker,
        "ms": size * scale,
        "mfc": color,
        "mec": edge,
        "mew": width * scale,
        "zorder": level,
    }


def _sticks(trajectory: Trajectory) -> list[Contact]:
    """Return the sticks of a trajectory as contacts."""
    sticks = [segment for segment in trajectory.segments if segment.mode.startswith("belt")]
    return [
        Contact(float(stick.t_start), float(stick.t_end), int(stick.mode[-1])) for stick in sticks
    ]


def _inset_sticks(contacts: Sequence[Contact], t: np.ndarray) -> tuple[Contact, ...]:
    """Return the sticks to show in insets, which are too short to be seen over the times `t`."""
    longest = SHORT_STICK * (t[-1] - t[0])
    shortest = 1e-10 * np.abs(t).max()  # an inset of a shorter one would show rounding errors
    short = [
        contact
        for contact in contacts
        if shortest < contact.until - contact.since < longest and contact.until < t[-1]
    ]
    if len(short) > MOST_INSETS:  # only those that are far shorter than usual
        limit = 0.1 * median(
            contact.until - contact.since for contact in contacts if contact.until > contact.since
        )
        short = [contact for contact in short if contact.until - contact.since < limit]
    return tuple(short[:MOST_INSETS])


# --- insets ---

# Height of the room above the axes, over the height of these with their labels.
INSET_ROOM = 0.66
# The top of what stands above it (a fraction of the axes).
INSET_TOP = 1.97
# Left end and width, for one inset and for two.
INSET_BOXES = {1: ((0.2, 0.6),), 2: ((0.1, 0.36), (0.63, 0.36))}
INSET_FONT = 7.5


def draw_insets(ax: Axes, view: View) -> None:
    """Draw the contacts to be magnified as insets above axes."""
    for contact, (left, width) in zip(
        view.magnified, INSET_BOXES.get(len(view.magnified), ()), strict=True
    ):
        _inset(ax, view, contact, (left, 1.16, width, 0.5))


def _inset(ax: Axes, view: View, contact: Contact, box: tuple[float, float, float, float]) -> None:
    """Draw an inset in the rectangle `box`: the velocity relative to the belt, shortly before and
    after a contact.
    """
    since, until, belt = contact
    path = partial(belt_path, view.trajectory, belt)
    is_stick = until > since
    t_first = view.t[0]
    t_last = view.t[-1]
    if is_stick:
        length = until - since
    else:
        length = SHORT_STICK * (t_last - t_first)
    # The contact, and as long a time before it and after it.
    times = np.linspace(max(since - length, t_first), min(until + length, t_last), 400)
    times = np.union1d(times, [since, until])
    _, velocities = view.trajectory(times)
    _, speeds = path(times)
    relative = velocities - speeds
    # Both axes are in units of a power of ten, which their labels name.
    time_power = floor(log10(length))
    speed_power = floor(log10(np.abs(relative).max() or 1))
    inset = ax.inset_axes(box)
    inset.plot(
        (times - since) / 10.0**time_power, relative / 10.0**speed_power, color=MASS_COLOR, lw=1.3
    )
    inset.axhline(0, color=BELT_COLOR, lw=0.6, zorder=1)
    if is_stick:
        marks = [(since, "onset of stick", ONSET_COLOR), (until, "end of stick", END_COLOR)]
    else:
        marks = [(since, "grazing point", SWITCH_COLOR)]
    for time, label, color in marks:
        inset.plot(
            (time - since) / 10.0**time_power, 0, linestyle="none", **mark_style(label, color)
        )
    if is_stick:
        _write_length(inset, length, above=relative.mean() > 0)
    inset.margins(x=0, y=0.2)
    # Ticks and label on top leave the way free for the leaders to the spot that is magnified.
    inset.xaxis.tick_top()
    inset.xaxis.set_label_position("top")
    time_unit, speed_unit = (
        f"$10^{{{-exponent}}}\\," if exponent else "$" for exponent in (time_power, speed_power)
    )
    inset.set_xlabel(f"{time_unit}(t - {since:.6f})$", fontsize=INSET_FONT, labelpad=2)
    inset.set_ylabel(f"{speed_unit}(\\dot{{x}} - v_{belt})$", fontsize=INSET_FONT, labelpad=2)
    inset.tick_params(labelsize=7, labelfontfamily="STIXGeneral", pad=2)
    inset.set_in_layout(False)  # the grid keeps its room free
    # Lines from the contact to the lower corners of the inset.
    leader: Record = {"arrowstyle": "-", "color": "0.6", "lw": 0.5, "shrinkA": 0, "shrinkB": 3}
    _, (speed,) = path(np.array([since]))
    spot = since, float(speed)
    left, bottom, width, _ = box
    for corner in (left, left + width):
        ax.annotate("", spot, (corner, bottom), "data", "axes fraction", leader, zorder=0)


def _write_length(inset: Axes, length: float, above: bool) -> None:
    """Write the length of a stick into its inset, between the branches of the curve, which are
    `above` the belt or below it.
    """
    if above:
        height = 0.7
    else:
        height = 0.3
    mantissa, _, exponent = f"{length:.1e}".partition("e")
    text = f"length ${mantissa}\\cdot 10^{{{int(exponent)}}}$"
    inset.text(
        0.53,
        height,
        text,
        transform=inset.transAxes,
        fontsize=INSET_FONT,
        ha="center",
        va="center",
    )
