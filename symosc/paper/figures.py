"""The paper's Figs. 1 to 10, and figures of Theorem 7: their data and their drawing.

Figs. 5 to 10 have the paper's panels, order and colours, with dots where its text puts them: belts are black and the
mass is red; blue circles and green squares are onset and end of a stick (in Fig. 7 of the first period), red triangles
switching points, red stars contacts.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, partial
from math import pi
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle
from scipy.optimize import minimize_scalar

from symosc.kernels.entire import EPS
from symosc.mappings.theorem7_cases import place
from symosc.model import NEIGHBOURS, Parameters
from symosc.plot.drawing import STYLE
from symosc.plot.figures import assemble, default_end
from symosc.plot.panels import (
    BELT_COLOR,
    END_COLOR,
    MASS_COLOR,
    ONSET_COLOR,
    PANELS,
    SWITCH_COLOR,
    Contact,
    Mark,
    Panel,
    View,
    mark_style,
    view_of,
)
from symosc.plot.windows import sweep_figure
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event, Trajectory
from symosc.words import MAPS

# Periods in panel (c) of Fig. 7.
SEVERAL_PERIODS = 4.0
# How far the black curves of Figs. 7 and 8 reach beyond the points that the text names, as fractions of both axes.
LONG_REACH = 0.25, 0.35
# The picture of an orbit shows this part of a period on either side of it.
ORBIT_MARGIN = 0.06
START_STYLE: dict[str, Any] = {"mfc": "white", "mec": "black", "mew": 0.8, "ms": 4.2, "zorder": 7, "clip_on": False}


# --- views: how long a motion is followed, and where the text puts dots and black curves ---


def period(name: str) -> float:
    """Return the period of the excitation of a scene."""
    return 2 * pi / float(load_scene(name).parameters.Omega)


def start_time(name: str) -> float:
    """Return t0 of a scene."""
    return float(load_scene(name).t0)


def printed_scene(name: str) -> str:
    """Return the name of the scene as the paper prints it, of which scene `name` is a correction."""
    return name.partition("-")[0]


@lru_cache
def stick_view(name: str) -> View:
    """Return the view of Figs. 5 and 6."""
    return view_of(simulate(name, t_end=default_end(load_scene(name))), None)


@lru_cache
def several_periods_view(name: str) -> View:
    """Return the view of Fig. 7(c), (d): several periods, start and end of the first one, any contact."""
    t0, T = start_time(name), period(name)
    view = view_of(simulate(name, t_end=t0 + SEVERAL_PERIODS * T), 1)
    contact = first_contact(view)
    marks = [Mark("start of period", ONSET_COLOR, t0), Mark("end of period", END_COLOR, t0 + T)]
    marks += [] if contact is None else [_contact_mark(contact)]
    contacts = tuple(Contact(mark.t, mark.t, view.boundary) for mark in marks)
    return replace(view, marks=tuple(marks), contacts=contacts, magnified=(), belt_reach=LONG_REACH)


@lru_cache
def grazing_view(name: str) -> View:
    """Return the view of Fig. 8: a red contact with belt 1, later a stick on it."""
    view = view_of(simulate(name, t_end=default_end(load_scene(printed_scene(name)))), 1)
    contact, stick = first_contact(view), later_stick(view)
    assert contact is not None
    onset, end = Mark("onset of stick", ONSET_COLOR, stick.since), Mark("end of stick", END_COLOR, stick.until)
    marks = view.marks[0], _contact_mark(contact), onset, end
    return replace(view, marks=marks, contacts=(contact, stick), magnified=(contact,), belt_reach=LONG_REACH)


@lru_cache
def motion_view(name: str) -> View:
    """Return the view of Figs. 9 and 10 from the printed start."""
    return view_of(simulate(name, t_end=start_time(name) + 2.2 * period(name)), None)


@lru_cache
def orbit_view(name: str) -> View:
    """Return one period of the periodic orbit (scene `name`) and a little more, around the printed start's time."""
    t0, T = start_time(name), period(name)
    since = start_time(printed_scene(name)) - ORBIT_MARGIN * T
    # The orbit's own scene starts at a switching; with the period it is known at any time.
    x, v = simulate(name, t_end=t0 + 2 * T)(since + T)
    end = since + (1 + 2 * ORBIT_MARGIN) * T
    view = view_of(simulate(load_scene(name).parameters, t0=since, x0=x, v0=v, t_end=end), None)
    return replace(view, marks=view.marks[1:])


def crop(view: View, since: float, until: float) -> View:
    """Return the part of a view between two times, sampled anew."""
    t = np.union1d(view.t[(since < view.t) & (view.t < until)], np.linspace(since, until, 200))
    x, v = view.trajectory(t)
    return replace(view, t=t, x=x, v=v, marks=tuple(mark for mark in view.marks if since <= mark.t <= until))


def first_contact(view: View) -> Contact | None:
    """Return the graze, or the short stick that replaces it for a rounded start; None without contact."""
    return min(view.contacts, key=lambda contact: contact.since, default=None)


def later_stick(view: View) -> Contact:
    """Return the stick that follows the graze in Fig. 8."""
    return max(view.contacts, key=lambda contact: contact.since)


def _contact_mark(contact: Contact) -> Mark:
    """Return the mark of a contact."""
    return Mark("grazing point" if contact.until == contact.since else "contact", SWITCH_COLOR, contact.since)


def largest_velocity(view: View) -> tuple[float, float]:
    """Return when the velocity between the ends of a view is largest, and how large."""
    guess, step = view.t[np.argmax(view.v)], 2 * pi / float(view.trajectory.parameters.Omega) / 60
    bounds = max(guess - step, view.t[0]), min(guess + step, view.t[-1])
    found = minimize_scalar(lambda t: -view.trajectory(t)[1], bounds=bounds, method="bounded")
    return float(found.x), -float(found.fun)


# --- Figs. 5 to 10 ---


def stick_figure(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 5 or 6: (a) displacement, (b) velocity, (c) phase plane, (d) forces."""
    return _paper_form([(PANELS[letter], stick_view(name)) for letter in "abcd"], columns)


def grazing_figure_P2(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 7: (a) displacement and (b) velocity in the first period, (c) velocity later on, (d) phase plane."""
    several, t0, T = several_periods_view(name), start_time(name), period(name)
    contact = first_contact(view_of(several.trajectory, 1))
    magnified = () if contact is None else (contact,)
    first = replace(crop(several, t0, t0 + 1.25 * T), magnified=magnified)
    periods = partial(_velocity_of_periods, start=t0, period=T)
    panels: list[tuple[Panel, View]] = [(PANELS["a"], first), (_velocity_and_gap, first)]
    return _paper_form([*panels, (periods, several), (PANELS["c"], several)], columns, tall=1 if magnified else None)


def grazing_figure_P3(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 8: (a) displacement, (b) velocity, (c) velocity near the stick, (d) phase plane."""
    view = grazing_view(name)
    stick = later_stick(view)
    reach = 1.2 * (stick.until - stick.since)
    close_up = crop(replace(view, magnified=()), stick.since - reach, stick.until + reach)
    panels = [(PANELS["a"], view), (PANELS["b"], view), (PANELS["b"], close_up), (PANELS["c"], view)]
    return _paper_form(panels, columns, tall=1)


def motion_figure(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 9 or 10 from the printed start: as Fig. 5, then (e), (f) forces against displacement and velocity."""
    return _paper_form([(PANELS[letter], motion_view(name)) for letter in "abcdef"], columns)


def orbit_figure(name: str, columns: int = 2) -> Figure:
    """Draw one period of the periodic orbit in the form of Figs. 9 and 10, with the printed start."""
    view, scene = orbit_view(name), load_scene(printed_scene(name))
    t, x, v = (float(value) for value in (scene.t0, scene.x0, scene.v0))
    panels: dict[str, Panel] = {letter: PANELS[letter] for letter in "abcdef"}
    for letter, start in (("a", (t, x)), ("b", (t, v))):
        panels[letter] = partial(_with_start, panel=PANELS[letter], start=start)
    panels["c"] = partial(_phase_plane_with_start, start=(x, v))
    return _paper_form([(panel, view) for panel in panels.values()], columns)


def product_figure(columns: int = 2) -> Figure:
    """Draw the products of forces that section 6 speaks of: Figs. 5, 6, 9 and 10."""
    views = [stick_view("fig5"), stick_view("fig6"), motion_view("fig9"), motion_view("fig10")]
    return _paper_form([(PANELS["g"], view) for view in views], columns)


def _paper_form(panels: list[tuple[Panel, View]], columns: int, tall: int | None = None) -> Figure:
    # Two columns for a page, one for a phone, where a point of it is 1.5 pixels.
    return assemble(panels, columns, {2: 5.2, 1: 3.4}[columns], tall=tall)


def _velocity_and_gap(ax: Axes, view: View) -> None:
    """Draw panel (b), with a bar over the remaining gap if the mass never reaches a belt."""
    PANELS["b"](ax, view)
    if view.trajectory.events:
        return
    (t, v), speed = largest_velocity(view), float(view.trajectory.parameters.belt(view.boundary))
    bar = {"arrowstyle": "|-|, widthA=0.2, widthB=0.2", "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (t, speed), (t, v), arrowprops=bar)
    ax.annotate(f"gap {speed - v:.2f}", (t, speed), (0, 3), textcoords="offset points", ha="center", fontsize=8)
    low, high = ax.get_ylim()
    ax.set_ylim(low, max(high, speed + 0.15 * (speed - low)))


def _velocity_of_periods(ax: Axes, view: View, start: float, period: float) -> None:
    """Draw panel (c) of Fig. 7: the velocity over several periods, each beginning with a dotted line."""
    _velocity_and_gap(ax, view)
    for time in np.arange(start, view.t[-1] + period / 2, period):
        ax.axvline(time, color="0.6", lw=0.6, ls=(0, (1, 2)), zorder=0)


def _with_start(ax: Axes, view: View, panel: Panel, start: tuple[float, float]) -> None:
    """Wrap a panel so that it shows the printed start as a diamond."""
    panel(ax, view)
    low, high = ax.get_ylim()
    margin = 0.06 * (high - low)
    ax.set_ylim(min(low, start[1] - margin), max(high, start[1] + margin))
    ax.plot(*start, "D", label="printed start", **START_STYLE)


def _phase_plane_with_start(ax: Axes, view: View, start: tuple[float, float]) -> None:
    """Draw panel (c) with the printed start, and an inset inside the orbit if they coincide visually."""
    _with_start(ax, view, PANELS["c"], start)
    crossing = min(view.trajectory.events, key=lambda event: abs(float(event.x) - start[0]))
    distance = abs(float(crossing.x) - start[0])
    if distance > 0.02 * np.ptp(view.x):
        return
    inset = ax.inset_axes((0.33, 0.39, 0.42, 0.2))
    inset.plot(view.x, view.v, color=MASS_COLOR, lw=1.3)
    inset.axhline(float(crossing.v), color=BELT_COLOR, lw=0.6)
    inset.plot(float(crossing.x), float(crossing.v), linestyle="none", **mark_style("end of stick", END_COLOR))
    inset.plot(*start, "D", **START_STYLE)
    inset.set_xlim(start[0] - 3 * distance, start[0] + 2 * distance)
    inset.set_ylim(start[1] - 40 * distance, start[1] + 20 * distance)
    inset.tick_params(labelsize=7, labelfontfamily="STIXGeneral", pad=2)
    inset.set_yticks([start[1]])
    ax.indicate_inset_zoom(inset, edgecolor="0.6", lw=0.5)


# --- Theorem 7, eqs. (55) to (58) ---

#: The scenes whose parameters are used: those that graze; for the mappings of belt 2, of which the paper shows no
#: graze, the scene about that belt.
WINDOW_SCENES = {"P2": "fig7-exact", "P3": "fig8-exact", "P5": "fig10", "P6": "fig10"}


def window_parameters(mapping: str) -> Parameters:
    """Return the parameters of the scene for a mapping's window."""
    return load_scene(WINDOW_SCENES[mapping]).parameters


def speed_of_equality(mapping: str) -> Fraction:
    """Return the speed > 0 at which |gamma| = B0 Omega/m."""
    p = window_parameters(mapping)
    return abs(p.B0) * p.Omega / p.k


def without_other_belt(mapping: str) -> Parameters:
    """Return the scene's parameters with the other belt far away: the window is independent of its speed."""
    p, far = window_parameters(mapping), 2 * speed_of_equality(mapping) + 1
    return p.replace(v2=far) if place(mapping).boundary == 1 else p.replace(v1=-far)


def window_graze(mapping: str) -> Event | None:
    """Return the scene's graze, if it is one of the mapping."""
    where, events = place(mapping), simulate(WINDOW_SCENES[mapping]).events
    sought = ("graze", where.boundary, f"Omega{where.domain}")
    return next((event for event in events if (event.kind, event.boundary, event.source) == sought), None)


def window_sweep(mapping: str) -> Figure:
    """Draw when a mapping grazes against its belt's speed, the graze of its scene, and what Theorem 7 leaves out."""
    where, speed, edge = place(mapping), f"v{place(mapping).boundary}", 2 * speed_of_equality(mapping)
    drawing = sweep_figure(without_other_belt(mapping), mapping, speed, -edge, edge, order="full")
    drawing.set_size_inches(3.6, 3.1)
    (axes,) = drawing.axes
    axes.title.set_text(f"phases at which $P_{mapping[1]}$ grazes, eq. ({where.equation})")
    for area in axes.collections:
        area.set_linewidth(1.0)  # no seam where two areas meet
    names = {
        "given value": f"$v_{where.boundary}$ in Fig. {printed_scene(WINDOW_SCENES[mapping]).removeprefix('fig')}",
        "belongs to it": f"grazes, not in ({where.equation})",
        "does not belong to it": "does not graze",
    }
    for line in axes.lines:
        line.set_label(names.get(str(line.get_label()), line.get_label()))
    graze = window_graze(mapping)
    if graze is not None:
        Omega = float(window_parameters(mapping).Omega)
        # A phase that is 0 but for the error of its time is 0.
        theta, error = float(graze.theta), 10 * Omega * max(graze.t_error, EPS * abs(float(graze.t)))
        style: dict[str, Any] = mark_style("grazing point", SWITCH_COLOR) | {"clip_on": False, "ls": ""}
        axes.plot(float(graze.v), 0.0 if 2 * pi - theta <= error else theta, label="grazing point", **style)
    drawing.legends[0].remove()
    with rc_context(STYLE):
        handles, labels = axes.get_legend_handles_labels()
        drawing.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False, borderpad=0.1)
    return drawing


# --- Figs. 1 to 4 ---

COLUMN_WIDTH = 3.6  # inches: one column of a page, and legible on a phone
THIN, LINE, THICK = 0.6, 1.1, 2.4  # weights of lines
GREY = "#666666"
SHADES = ("#eef3fb", "#fdfdfd", "#fbf1ee")  # of domains 1, 2 and 3
BOX = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
OUTSIDE: dict[str, Any] = {"loc": "outside lower center", "ncols": 2, "frameon": False, "borderpad": 0.1}
CENTER: dict[str, Any] = {"ha": "center", "va": "center"}

Edges = tuple[float, float]


# --- Fig. 1 ---


@rc_context(STYLE)
def fig1() -> Figure:
    """Return Fig. 1, the physical model: mass, spring, damper, the two belts, and the forces."""
    drawing = Figure(figsize=(COLUMN_WIDTH, 2.0))
    ax = drawing.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set(xlim=(-0.5, 11.7), ylim=(-3.4, 3.4), aspect="equal")
    ax.set_axis_off()
    _draw_wall_spring_and_damper(ax)
    mass = Rectangle((4.7, -0.9), 2.0, 1.8, facecolor="#f3d9d6", edgecolor=MASS_COLOR, lw=LINE, zorder=3)
    ax.add_patch(mass)
    ax.text(5.7, 0.0, "$m$", **CENTER, fontsize=11, zorder=4)
    _belt(ax, 1, 2)
    _belt(ax, -1, 1)
    _draw_arrow(ax, (6.7, 0.35), (8.1, 0.35), MASS_COLOR)
    ax.text(8.25, 0.33, r"$A_0 + B_0\cos\Omega t$", ha="left", va="center")
    _draw_arrow(ax, (6.7, -0.5), (7.6, -0.5), "black", lw=THIN)
    ax.text(7.75, -0.5, "$x$", ha="left", va="center")
    return drawing


def _draw_arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float], color: str, **style: Any) -> None:
    arrow: dict[str, Any] = {"arrowstyle": "-|>", "mutation_scale": 8.0, "lw": LINE, "shrinkA": 0.0, "shrinkB": 0.0}
    ax.add_patch(FancyArrowPatch(start, end, color=color, **(arrow | style)))


def _draw_wall_spring_and_damper(ax: Axes) -> None:
    ax.plot([0.0, 0.0], [-1.1, 1.1], color="black", lw=LINE)
    for low in np.linspace(-1.1, 0.8, 7):
        ax.plot([-0.35, 0.0], [low, low + 0.3], color="black", lw=THIN)
    # The spring at height 0.45, in six turns, from the wall to the mass.
    x, y = np.linspace(0.6, 4.1, 25), 0.45 + 0.24 * np.sin(np.arange(25) * np.pi / 2)
    x, y = np.concatenate([[0.0], x, [4.7]]), np.concatenate([[0.45], y, [0.45]])
    ax.plot(x, y, color="black", lw=LINE, solid_joinstyle="round")
    ax.text(1.3, 0.85, "$k$", ha="center", va="bottom")
    # The damper at height -0.45: rod, pot, piston, rod.
    y0, left, right, half = -0.45, 1.35, 2.35, 0.24
    ax.plot([0.0, left], [y0, y0], color="black", lw=LINE)
    ax.plot([right, left, left, right], [y0 + half, y0 + half, y0 - half, y0 - half], color="black", lw=LINE)
    ax.plot([1.95, 1.95], [y0 - 0.17, y0 + 0.17], color="black", lw=1.6 * LINE)
    ax.plot([1.95, 4.7], [y0, y0], color="black", lw=LINE)
    ax.text(1.3, -0.8, "$c$", ha="center", va="top")


def _belt(ax: Axes, side: int, number: int) -> None:
    """Draw a belt above (side 1) or below (-1) the mass: its strand at the mass moves to the right."""
    contact, radius, centres, mass = 0.9, 0.7, (3.6, 8.9), (4.7, 6.7)
    middle, outer = side * (contact + radius), side * (contact + 2 * radius)
    for centre in centres:
        ax.add_patch(Circle((centre, middle), radius, facecolor="white", edgecolor=GREY, lw=THIN))
        ax.plot([centre], [middle], "o", color=GREY, ms=1.8)
        bend = 0.5 * radius * np.exp(1j * np.radians([205, 335]))
        start, end = ((centre + z.real, middle + side * z.imag) for z in bend)
        _draw_arrow(ax, start, end, GREY, lw=THIN, mutation_scale=5.0, connectionstyle=f"arc3,rad={0.6 * side}")
    turn = np.linspace(-np.pi / 2, np.pi / 2, 60)
    bows = [(centres[1], np.cos(turn), np.sin(turn)), (centres[0], -np.cos(turn), -np.sin(turn))]
    rim = np.vstack([np.column_stack([x + radius * c, middle + radius * s]) for x, c, s in bows])
    ax.add_patch(Polygon(rim, closed=True, fill=False, edgecolor=BELT_COLOR, lw=1.5, zorder=2))
    # A shoe behind the strand presses the belt against the mass.
    shoe = sorted((side * (contact + 0.07), side * (contact + 0.25)))
    ax.add_patch(Rectangle((mass[0], shoe[0]), mass[1] - mass[0], shoe[1] - shoe[0], facecolor=GREY, lw=0))
    _draw_arrow(ax, (5.7, outer + side * 0.95), (5.7, side * (contact + 0.25)), "black", zorder=5)
    ax.text(5.9, outer + side * 0.6, "$F_N$", ha="left", va="center")
    _draw_arrow(ax, (6.95, side * (contact + 0.3)), (7.95, side * (contact + 0.3)), BELT_COLOR)
    ax.text(7.4, side * (contact + 0.75), f"$v_{number}$", **CENTER)
    ax.text(9.75, middle, f"belt {number}", ha="left", va="center")


# --- Fig. 2 ---


@rc_context(STYLE)
def fig2(p: Parameters | None = None) -> Figure:
    """Return Fig. 2, the friction force F_f against the velocity, an interval at each belt's speed (eq. (1))."""
    p = load_scene("fig5").parameters if p is None else p
    v1, v2 = float(p.v1), float(p.v2)
    levels = [float(p.A0 - p.A(alpha)) for alpha in (1, 2, 3)]
    names = (r"$-(\mu_1+\mu_2)F_N$", r"$(\mu_1-\mu_2)F_N$", r"$(\mu_1+\mu_2)F_N$")
    reach, height = v2 - v1, max(map(abs, levels)) or 1.0
    edges = v1 - reach, v1, v2, v2 + reach
    drawing = Figure(figsize=(COLUMN_WIDTH, 2.7), layout="constrained")
    ax = drawing.add_subplot()
    ax.axhline(0.0, color=GREY, lw=THIN, zorder=1)
    for alpha, (level, name) in enumerate(zip(levels, names, strict=True), 1):
        low, high = edges[alpha - 1 : alpha + 1]
        ax.plot([low, high], [level, level], color=MASS_COLOR, lw=1.6, solid_capstyle="butt", zorder=3, label=name)
        side = -1 if alpha == 3 else 1
        place = (low + high) / 2, level + 0.07 * side * height
        ax.text(*place, f"{name}\n$= {level:.4g}$", ha="center", va="top" if side < 0 else "bottom")
        ax.text(place[0], -1.3 * height, rf"$\Omega_{alpha}$", **CENTER, color=GREY)
    for belt, speed in ((1, v1), (2, v2)):
        ax.plot([speed, speed], levels[belt - 1 : belt + 1], color=ONSET_COLOR, lw=THICK, zorder=4)
        ax.axvline(speed, color=GREY, lw=THIN, ls=":", zorder=1)
    ax.set_xlim(edges[0], edges[-1])
    ax.set_ylim(-1.5 * height, 1.25 * height)
    ax.set_xticks([v1, v2], [f"$v_1 = {v1:g}$", f"$v_2 = {v2:g}$"])
    ax.set_yticks([0.0], ["0"])
    ax.set_xlabel(r"velocity $\dot{x}$")
    ax.set_ylabel("friction force $F_f$")
    key = [Line2D([], [], color=MASS_COLOR, lw=1.6), Line2D([], [], color=ONSET_COLOR, lw=THICK)]
    words = ["slips: one value", "sticks: any value"]
    ax.legend(key, words, loc="upper left", frameon=False, handlelength=0.9, handletextpad=0.5, borderaxespad=0.2)
    return drawing


# --- Fig. 3 ---


@rc_context(STYLE)
def fig3(scene: str = "fig5") -> Figure:
    """Return Fig. 3, the phase plane with its domains and boundaries, and the direction of motion at t = 0."""
    p = load_scene(scene).parameters
    v1, v2 = float(p.v1), float(p.v2)
    zones = {belt: stick_zone(p, belt) for belt in (1, 2)}
    left, right = min(zone[0] for zone in zones.values()), max(zone[1] for zone in zones.values())
    x = left - 0.25 * (right - left), right + 0.25 * (right - left)
    v = v1 - 0.9 * (v2 - v1), v2 + 0.9 * (v2 - v1)
    width = x[1] - x[0]
    drawing = Figure(figsize=(COLUMN_WIDTH, 3.0), layout="constrained")
    ax = drawing.add_subplot()
    for alpha, (low, high) in enumerate(((v[0], v1), (v1, v2), (v2, v[1])), 1):
        ax.axhspan(low, high, color=SHADES[alpha - 1], lw=0, zorder=0)
        _arrow_field(ax, p, alpha, x, (low, high), (x, v))
        place, box = (x[1] - 0.02 * width, (low + high) / 2), dict(BOX, facecolor=SHADES[alpha - 1])
        ax.text(*place, rf"$\Omega_{alpha}$", ha="right", va="center", fontsize=11, bbox=box, zorder=5)
    stick: dict[str, Any] = {"color": ONSET_COLOR, "lw": THICK + 0.6}
    for belt, speed in ((1, v1), (2, v2)):
        lo, hi = NEIGHBOURS[belt]
        ax.axhline(speed, color=BELT_COLOR, lw=LINE, zorder=2)
        ax.plot(zones[belt], [speed, speed], solid_capstyle="butt", zorder=3, **stick)
        place = x[0] + 0.035 * width, speed
        ax.text(*place, rf"$\partial\Omega_{{{lo}{hi}}}$", ha="left", va="center", bbox=BOX, zorder=5)
    _prepare_phase_axes(ax, p, x, v)
    key = [Line2D([], [], **stick), Line2D([], [], color=GREY, marker=r"$\rightarrow$", ls="", ms=8)]
    words = [r"sticks at $\Omega t = 0$", r"direction at $\Omega t = 0$"]
    drawing.legend(key, words, columnspacing=1.2, **OUTSIDE)
    return drawing


def stick_zone(p: Parameters, belt: int) -> tuple[float, float]:
    """Return the displacements at which the mass sticks to a belt at phase 0: F(above) < 0 < F(below) (Theorem 4)."""
    ends = [(p.A(alpha) + p.B0 - p.c * p.belt(belt)) / p.k for alpha in reversed(NEIGHBOURS[belt])]
    return float(ends[0]), float(ends[1])


def _arrow_field(ax: Axes, p: Parameters, alpha: int, x: Edges, v: Edges, limits: tuple[Edges, Edges]) -> None:
    """Draw arrows of one length in the direction of (x', F^(alpha)) at phase 0, as the axes show it."""
    rows = max(1, round(7 * (v[1] - v[0]) / (limits[1][1] - limits[1][0])))
    speeds = v[0] + (np.arange(rows) + 0.5) * (v[1] - v[0]) / rows
    X, V = np.meshgrid(np.linspace(*x, 12)[1:-1], speeds)
    F = (float(p.A(alpha) + p.B0) - float(p.k) * X - float(p.c) * V) / float(p.m)
    U, W = V / (limits[0][1] - limits[0][0]), F / (limits[1][1] - limits[1][0])
    size = np.hypot(U, W)
    ax.quiver(X, V, U / size, W / size, pivot="mid", color=GREY, width=0.004, scale=16, headwidth=4.5, zorder=1)


def _prepare_phase_axes(ax: Axes, p: Parameters, x: Edges, v: Edges) -> None:
    ax.set_xlim(x)
    ax.set_ylim(v)
    ax.set_xticks([])
    ax.set_yticks([float(p.v1), float(p.v2)], ["$v_1$", "$v_2$"])
    ax.tick_params(axis="y", length=0)
    ax.set_xlabel("displacement $x$")
    ax.set_ylabel(r"velocity $\dot{x}$")


# --- Fig. 4 ---

#: The oscillator of Fig. 4; where and when each mapping starts, x_i and t_i; and where its name stands, from the
#: middle of its curve: alignment, and distance in points.
MAPPING_PARAMETERS = Parameters(
    m=1, c="0.1", k="0.4", A0=0, B0=20, Omega="2.5", v1=4, v2=8, mu1="0.7", mu2="0.5", FN="9.81"
)
MAPPINGS = {
    "P1": ("-6.5", "1.59", ("center", "top", 0, -5)),
    "P2": ("-11", "1.01", ("center", "top", 0, -3)),
    "P3": ("-3", "0.25", ("center", "bottom", 0, 3)),
    "P4": ("1.5", "1.97", ("center", "bottom", 0, 4)),
    "P5": ("-9.5", "1.51", ("center", "top", 0, -3)),
    "P6": ("-7.5", "2.51", ("center", "bottom", 0, 3)),
    "P7": ("4.5", "0.59", ("left", "center", 5, 0)),
    "P8": ("-14", "1.84", ("right", "center", -5, 0)),
}
#: Start and end of a mapping: shape and colour.
ENDS = (("o", ONSET_COLOR), ("s", END_COLOR))


def mapping_motion(label: str) -> Trajectory:
    """Return the motion of Fig. 4 that is one mapping: it starts on the mapping's plane and ends at its first event."""
    x, t, _ = MAPPINGS[label]
    speed = MAPPING_PARAMETERS.belt(MAPS[label].start.boundary)
    return simulate(MAPPING_PARAMETERS, t0=t, x0=x, v0=speed, t_end=float(t) + 3, max_events=1)


@rc_context(STYLE)
def fig4() -> Figure:
    """Return Fig. 4, the basic mappings P1 to P8 in the phase plane, each a motion of the same oscillator."""
    p = MAPPING_PARAMETERS
    v1, v2 = float(p.v1), float(p.v2)
    drawing = Figure(figsize=(COLUMN_WIDTH, 3.0), layout="constrained")
    ax = drawing.add_subplot()
    for label in MAPPINGS:
        _draw_mapping(ax, label)
    low, high = v1 - 0.8 * (v2 - v1), v2 + 0.85 * (v2 - v1)
    left, right = ax.get_xlim()[0] - 1.0, ax.get_xlim()[1] + 1.8
    for alpha, edges in enumerate(((low, v1), (v1, v2), (v2, high)), 1):
        ax.axhspan(*edges, color=SHADES[alpha - 1], lw=0, zorder=0)
        place = right - 0.025 * (right - left), sum(edges) / 2
        ax.text(*place, rf"$\Omega_{alpha}$", ha="right", va="center", fontsize=11)
    for speed in (v1, v2):
        ax.axhline(speed, color=BELT_COLOR, lw=LINE, zorder=2)
    _prepare_phase_axes(ax, p, (left, right), (low, high))
    marks = [Line2D([], [], ls="", marker=marker, ms=3.5, color=color) for marker, color in ENDS]
    drawing.legend(marks, ["start", "end"], **OUTSIDE)
    return drawing


def _draw_mapping(ax: Axes, label: str) -> None:
    motion, count = mapping_motion(label), 200
    x, v = motion(np.linspace(float(motion.t_start), float(motion.events[0].t), count))
    sticks = motion.segments[0].mode.startswith("belt")
    weight = THICK if sticks else LINE
    ax.plot(x, v, color=MASS_COLOR, lw=weight, zorder=3, label=label, solid_capstyle="butt")
    for index, (marker, color) in zip((0, -1), ENDS, strict=True):
        ax.plot(x[index], v[index], marker, color=color, ms=3.5, zorder=5)
    returns = v[0] == v[-1] and not sticks
    head = count // 4 if returns else count // 2
    arrow = {"arrowstyle": "-|>", "color": MASS_COLOR, "lw": LINE, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 9}
    ax.annotate("", (x[head + 4], v[head + 4]), (x[head], v[head]), arrowprops=arrow, zorder=4)
    across, up, dx, dy = MAPPINGS[label][2]
    at = int(np.argmax(np.abs(v - v[0]))) if returns else count // 2
    ax.annotate(f"$P_{label[1:]}$", (x[at], v[at]), (dx, dy), textcoords="offset points", ha=across, va=up, zorder=6)
