"""What the panels of a figure show: the mass, the belts, the forces, and a dot for each event."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import floor, log10, pi, sqrt
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from symosc.model import SIDES
from symosc.simulation.trajectory import Trajectory

BELT, MASS = "black", "#d7191c"
ONSET, END, SWITCH = "#1f3fd6", "#0f8a2a", "#d7191c"
FORCE_BELOW, FORCE_ABOVE = ONSET, END

POINTS_PER_PERIOD, LEAST_POINTS, MOST_POINTS = 120, 40, 20_000
# A stick shorter than this fraction of the time axis would be a dot: it gets an inset.
SHORT_STICK = 0.01
# ... unless it is shorter than this fraction of t, where its curve would show rounding errors.
RESOLVED = 1e-10
MOST_INSETS = 2
# A belt is drawn if that stretches the velocity axis by no more than this fraction.
BELT_STRETCH = 0.65
# How far beyond a contact the belt's displacement is drawn, as fractions of both axes.
BELT_REACH = 0.06, 0.15
STICK_SHADE = "0.92"
IN_INSET: dict[str, Any] = {"fontsize": 7.5, "ha": "center", "va": "center"}


@dataclass(frozen=True)
class Mark:
    """A dot: what it is, and the event that it stands for."""

    label: str
    color: str
    t: float


@dataclass(frozen=True)
class Contact:
    """A stick on a belt from `since` to `until`, or a point of contact (both are equal)."""

    since: float
    until: float
    belt: int


@dataclass(frozen=True)
class View:
    """Everything that the panels draw.

    Attributes
    ----------
    trajectory : Trajectory
    boundary : int
        Whose forces are drawn.
    t, x, v : numpy.ndarray
        The samples of the curves.
    marks : tuple of Mark
        The dots.
    contacts : tuple of Contact
        Where panel (a) shows the displacement of a point of a belt.
    magnified : tuple of Contact
        At most two, which panel (b) shows in insets.
    belt_reach : tuple of two floats
        How far beyond a contact the belt's displacement is drawn, as fractions of both axes.
    """

    trajectory: Trajectory
    boundary: int
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    marks: tuple[Mark, ...]
    contacts: tuple[Contact, ...]
    magnified: tuple[Contact, ...]
    belt_reach: tuple[float, float] = BELT_REACH

    @property
    def domains(self) -> tuple[int, int]:
        """The domains below and above the boundary."""
        return SIDES[self.boundary]

    def belts(self) -> list[int]:
        """Return the belts whose speed is near enough to the velocities to be drawn."""
        low, high = self.v.min(), self.v.max()
        p, allowed = self.trajectory.parameters, BELT_STRETCH * (high - low)
        near = [belt for belt in (1, 2) if low - allowed <= p.belt(belt) <= high + allowed]
        return sorted({*near, self.boundary})


def view_of(trajectory: Trajectory, boundary: int | None) -> View:
    """Sample a trajectory and choose the boundary whose forces are drawn, by default that of the first event."""
    t = _sample_times(trajectory)
    x, v = trajectory(t)
    if boundary is None:
        p, events = trajectory.parameters, trajectory.events
        on_belt = trajectory.segments[0].mode.removeprefix("belt")
        nearest = min((1, 2), key=lambda belt: np.abs(v - float(p.belt(belt))).min())
        boundary = int(on_belt) if on_belt in "12" else events[0].boundary if events else nearest
    contacts = _sticks(trajectory) + [
        Contact(float(event.t), float(event.t), event.boundary) for event in trajectory.events if event.kind == "graze"
    ]
    short = tuple(contact for contact in contacts if _is_short(contact, t))
    return View(trajectory, boundary, t, x, v, _marks(trajectory), tuple(contacts), short[:MOST_INSETS])


def _sample_times(trajectory: Trajectory) -> np.ndarray:
    """Return times that resolve every segment, denser after its start, with the events among them."""
    p = trajectory.parameters
    period = 2 * pi / max(float(p.Omega), sqrt(p.k / p.m))
    edges = [float(segment.t_start) for segment in trajectory.segments] + [float(trajectory.t_end)]
    step = max(period / POINTS_PER_PERIOD, (edges[-1] - edges[0]) / MOST_POINTS)
    start = np.linspace(0, 1, LEAST_POINTS // 2) ** 4
    times = []
    for low, high in pairwise(edges):
        even = np.linspace(0, 1, int(min(max((high - low) / step, LEAST_POINTS), MOST_POINTS)))
        times.append(low + (high - low) * np.union1d(even, start))
    return np.clip(np.unique(np.concatenate([*times, edges])), edges[0], edges[-1])


def _marks(trajectory: Trajectory) -> tuple[Mark, ...]:
    start = float(trajectory.t_start)
    on_belt = trajectory.segments[0].mode.startswith("belt")
    marks = [Mark("onset of stick", ONSET, start) if on_belt else Mark("start", "white", start)]
    kinds = {
        "stick": ("onset of stick", ONSET),
        "slip": ("end of stick", END),
        "cross": ("crossing", SWITCH),
        "graze": ("grazing point", SWITCH),
    }
    marks += [Mark(*kinds[event.kind], float(event.t)) for event in trajectory.events]
    return tuple(marks)


# --- the panels ---


def _displacement(ax: Axes, view: View) -> None:
    """Panel (a): the mass, and the points of the belts that it sticks to or grazes (black)."""
    _curve(ax, view, view.t, view.x, "displacement $x$")
    low, high = ax.get_ylim()
    reaches = view.belt_reach[0] * (view.t[-1] - view.t[0]), view.belt_reach[1] * (high - low)
    for contact in view.contacts:
        speed, x = float(view.trajectory.parameters.belt(contact.belt)), view.trajectory(contact.since)[0]
        reach = min(reaches[0], reaches[1] / abs(speed)) if speed else reaches[0]
        ends = np.array([contact.since - reach, contact.until + reach])
        ax.plot(ends, x + speed * (ends - contact.since), color=BELT, lw=0.6, zorder=3, label="belt")
    ax.set_ylim(low, high)
    _dots(ax, view, lambda t: t, lambda t: view.trajectory(t)[0])
    _time_axis(ax, view)


def _velocity(ax: Axes, view: View) -> None:
    _curve(ax, view, view.t, view.v, r"velocity $\dot{x}$")
    _belt_lines(ax, view)
    _dots(ax, view, lambda t: t, lambda t: view.trajectory(t)[1])
    _time_axis(ax, view)
    _insets(ax, view)


def _phase_plane(ax: Axes, view: View) -> None:
    _curve(ax, view, view.x, view.v, r"velocity $\dot{x}$")
    _belt_lines(ax, view)
    _dots(ax, view, lambda t: view.trajectory(t)[0], lambda t: view.trajectory(t)[1])
    ax.set_xlabel("displacement $x$")


def _forces_in_time(ax: Axes, view: View) -> None:
    for stick in _sticks(view.trajectory):
        if stick.belt == view.boundary:
            ax.axvspan(stick.since, stick.until, color=STICK_SHADE, lw=0, zorder=-1)
    _forces(ax, view, view.t, lambda t: t)
    crossings = [mark.t for mark in view.marks if mark.label == "crossing"]
    ends = [view.trajectory.force(domain, crossings) for domain in view.domains]
    ax.vlines(crossings, *ends, color="0.6", lw=0.6, zorder=0)
    _time_axis(ax, view)


def _forces_in_displacement(ax: Axes, view: View) -> None:
    _forces(ax, view, view.x, lambda t: view.trajectory(t)[0])
    ax.set_xlabel("displacement $x$")


def _forces_in_velocity(ax: Axes, view: View) -> None:
    _forces(ax, view, view.v, lambda t: view.trajectory(t)[1])
    for belt in view.belts():
        speed = float(view.trajectory.parameters.belt(belt))
        ax.axvline(speed, color=BELT, lw=0.6, zorder=1, label="belt")
        ax.annotate(f"$v_{belt}$", (speed, 1), (0, 2), ("data", "axes fraction"), "offset points", ha="center")
    ax.set_xlabel(r"velocity $\dot{x}$")


Panel = Callable[[Axes, View], None]

PANELS: dict[str, Panel] = {
    "a": _displacement,
    "b": _velocity,
    "c": _phase_plane,
    "d": _forces_in_time,
    "e": _forces_in_displacement,
    "f": _forces_in_velocity,
}


# --- what they are made of ---


def _curve(ax: Axes, view: View, across: np.ndarray, up: np.ndarray, label: str) -> None:
    ax.plot(across, up, color=MASS, lw=1.3, label="mass")
    ax.set_ylabel(label)


def _time_axis(ax: Axes, view: View) -> None:
    ax.set_xlim(view.t[0], view.t[-1])
    ax.set_xlabel("time $t$")


def _belt_lines(ax: Axes, view: View) -> None:
    # Above the mass, but thinner: in a stick both are seen.
    for belt in view.belts():
        speed = float(view.trajectory.parameters.belt(belt))
        ax.axhline(speed, color=BELT, lw=0.6, zorder=3, label="belt")
        ax.annotate(f"$v_{belt}$", (1, speed), (4, 0), ("axes fraction", "data"), "offset points", va="center")


def _forces(ax: Axes, view: View, across: np.ndarray, place: Callable[[Any], Any]) -> None:
    below, above = view.domains
    force = view.trajectory.force
    ax.axhline(0, color="0.6", lw=0.6, zorder=0)
    for domain, color in ((below, FORCE_BELOW), (above, FORCE_ABOVE)):
        ax.plot(across, force(domain, view.t), color=color, lw=1.0, label=f"$F^{{({domain})}}$")
    for domain in (below, above):
        _dots(ax, view, place, lambda t, domain=domain: force(domain, t), start=False)  # type: ignore[misc]
    ax.set_ylabel(f"forces per mass $F^{{({below})}}$, $F^{{({above})}}$")


def _dots(ax: Axes, view: View, across: Callable[[Any], Any], up: Callable[[Any], Any], start: bool = True) -> None:
    for label, color in dict.fromkeys((mark.label, mark.color) for mark in view.marks):
        if label == "start" and not start:
            continue
        times = np.array([mark.t for mark in view.marks if mark.label == label])
        # The end of a stick is smaller: over its onset it leaves a blue ring.
        size, edge, width, level = (4.2, "black", 0.8, 4) if label == "start" else (5.4, "white", 0.4, 5)
        size, level = (4.0, 6) if color == END else (size, level)
        style: dict[str, Any] = {"ms": size, "mfc": color, "mec": edge, "mew": width, "zorder": level}
        ax.plot(across(times), up(times), linestyle="none", marker="o", clip_on=False, label=label, **style)


def _sticks(trajectory: Trajectory) -> list[Contact]:
    sticks = [segment for segment in trajectory.segments if segment.mode.startswith("belt")]
    return [Contact(float(stick.t_start), float(stick.t_end), int(stick.mode[-1])) for stick in sticks]


def _is_short(contact: Contact, t: np.ndarray) -> bool:
    """Tell whether a stick is too short to be seen, but long enough to be resolved, and ends in the picture."""
    longest, finest = SHORT_STICK * (t[-1] - t[0]), RESOLVED * np.abs(t).max()
    return bool(finest < contact.until - contact.since < longest and contact.until < t[-1])


def _insets(ax: Axes, view: View) -> None:
    """Magnify contacts that are too short to be seen, in room made above the curve."""
    if not view.magnified:
        return
    low, high = ax.get_ylim()
    ticks = [tick for tick in ax.get_yticks() if low <= tick <= high]
    ax.set_ylim(low, high + 0.9 * (high - low))
    ax.set_yticks(ticks)
    boxes = ((0.14, 0.34), (0.62, 0.34)) if len(view.magnified) == 2 else ((0.27, 0.6),)
    for contact, (left, width) in zip(view.magnified, boxes, strict=True):
        _inset(ax, view, contact, (left, 0.6, width, 0.26))


def _inset(ax: Axes, view: View, contact: Contact, box: tuple[float, float, float, float]) -> None:
    since, until, belt = contact.since, contact.until, contact.belt
    speed = float(view.trajectory.parameters.belt(belt))
    length = until - since or SHORT_STICK * (view.t[-1] - view.t[0])
    times = np.linspace(max(since - length, view.t[0]), min(until + length, view.t[-1]), 400)
    times = np.union1d(times, [since, until])
    away = view.trajectory(times)[1] - speed
    shift, scale = floor(log10(length)), floor(log10(np.abs(away).max() or 1))
    inset = ax.inset_axes(box)
    inset.plot((times - since) / 10.0**shift, away / 10.0**scale, color=MASS, lw=1.3)
    inset.axhline(0, color=BELT, lw=0.6, zorder=3)
    dots = ((since, ONSET, 5.4), (until, END, 4.0)) if until > since else ((since, SWITCH, 5.4),)
    for time, color, size in dots:
        inset.plot((time - since) / 10.0**shift, 0, "o", color=color, ms=size, mec="white", mew=0.4, zorder=5)
    if until > since:
        # Clear of the belt, between the branches of the curve.
        height = 0.62 if away.mean() > 0 else 0.42
        inset.text(0.5, height, f"length\n{_scientific(length)}", transform=inset.transAxes, **IN_INSET)
    inset.margins(x=0, y=0.2)
    # Ticks and label on top leave the way free for the leaders to the spot that is magnified.
    inset.xaxis.tick_top()
    inset.xaxis.set_label_position("top")
    inset.set_xlabel(f"{_power(-shift)}(t - {since:.6f})$", fontsize=IN_INSET["fontsize"], labelpad=2)
    inset.set_ylabel(f"{_power(-scale)}(\\dot{{x}} - v_{belt})$", fontsize=IN_INSET["fontsize"], labelpad=2)
    inset.tick_params(labelsize=7, labelfontfamily="STIXGeneral", pad=2)
    for corner in (box[0], box[0] + box[2]):
        style = {"arrowstyle": "-", "color": "0.6", "lw": 0.5, "shrinkA": 0, "shrinkB": 3}
        ax.annotate("", (since, speed), (corner, box[1]), "data", "axes fraction", style, zorder=0)


def _power(exponent: int) -> str:
    return "$" if exponent == 0 else f"$10^{{{exponent}}}\\,"


def _scientific(value: float) -> str:
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"${mantissa}\\cdot 10^{{{int(exponent)}}}$"
