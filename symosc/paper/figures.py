"""Figs. 5 to 10 in the paper's form, and Theorem 7: what is followed and shown, and how it is drawn.

Panels are in the paper's order and colours, with dots where its text puts them. Belts are black and the mass is red.
Blue circles and green squares are onset and end of a stick (in Fig. 7 of the first period), red triangles switching
points, red stars contacts. In Theorem 7's figures the phases at which a mapping grazes stand against its belt's speed.
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
from scipy.optimize import minimize_scalar

from symosc.kernels.entire import EPS
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters
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
from symosc.simulation.trajectory import Event

# In inches, by the number of columns: two for a page, one for a phone, where a point of it is 1.5 pixels.
WIDTHS = {2: 5.2, 1: 3.4}
# Fig. 7 shows a little more than the first period, its panel (c) several; Figs. 9 and 10 a little more than two.
FIRST_PERIOD, SEVERAL_PERIODS, TWO_PERIODS = 1.25, 4.0, 2.2
# How far the black curves of Figs. 7 and 8 reach beyond the points that the text names, as fractions of both axes.
LONG_REACH = 0.25, 0.35
# The close-up of a stick shows this part of its length on either side of it; an orbit, this part of a period.
STICK_MARGIN, ORBIT_MARGIN = 1.2, 0.06
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
    """Return what Figs. 5 and 6 show."""
    return view_of(simulate(name, t_end=default_end(load_scene(name))), None)


@lru_cache
def several_periods_view(name: str) -> View:
    """Return what Fig. 7(c), (d) show: several periods, start and end of the first one, a contact if there is one."""
    t0, T = start_time(name), period(name)
    view = view_of(simulate(name, t_end=t0 + SEVERAL_PERIODS * T), 1)
    contact = first_contact(view)
    marks = [Mark("start of period", ONSET_COLOR, t0), Mark("end of period", END_COLOR, t0 + T)]
    marks += [] if contact is None else [_contact_mark(contact)]
    contacts = tuple(Contact(mark.t, mark.t, view.boundary) for mark in marks)
    return replace(view, marks=tuple(marks), contacts=contacts, magnified=(), belt_reach=LONG_REACH)


@lru_cache
def grazing_view(name: str) -> View:
    """Return what Fig. 8 shows: a red contact with belt 1, later a stick on it."""
    view = view_of(simulate(name, t_end=default_end(load_scene(printed_scene(name)))), 1)
    contact, stick = first_contact(view), later_stick(view)
    assert contact is not None
    onset, end = Mark("onset of stick", ONSET_COLOR, stick.since), Mark("end of stick", END_COLOR, stick.until)
    marks = view.marks[0], _contact_mark(contact), onset, end
    return replace(view, marks=marks, contacts=(contact, stick), magnified=(contact,), belt_reach=LONG_REACH)


@lru_cache
def motion_view(name: str) -> View:
    """Return what Figs. 9 and 10 show with the printed start."""
    return view_of(simulate(name, t_end=start_time(name) + TWO_PERIODS * period(name)), None)


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
    """Return the graze, or the short stick that a start of a few digits makes of it; None if nothing is touched."""
    return min(view.contacts, key=lambda contact: contact.since, default=None)


def later_stick(view: View) -> Contact:
    """Return the stick that follows the graze in Fig. 8."""
    return max(view.contacts, key=lambda contact: contact.since)


def _contact_mark(contact: Contact) -> Mark:
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
    first = replace(crop(several, t0, t0 + FIRST_PERIOD * T), magnified=magnified)
    periods = partial(_velocity_of_periods, start=t0, period=T)
    panels: list[tuple[Panel, View]] = [(PANELS["a"], first), (_velocity_and_gap, first)]
    return _paper_form([*panels, (periods, several), (PANELS["c"], several)], columns, tall=1 if magnified else None)


def grazing_figure_P3(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 8: (a) displacement, (b) velocity, (c) velocity near the stick, (d) phase plane."""
    view = grazing_view(name)
    stick = later_stick(view)
    reach = STICK_MARGIN * (stick.until - stick.since)
    close_up = crop(replace(view, magnified=()), stick.since - reach, stick.until + reach)
    panels = [(PANELS["a"], view), (PANELS["b"], view), (PANELS["b"], close_up), (PANELS["c"], view)]
    return _paper_form(panels, columns, tall=1)


def motion_figure(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 9 or 10 from the printed start: as Fig. 5, then (e), (f) forces against displacement and velocity."""
    return _paper_form([(PANELS[letter], motion_view(name)) for letter in "abcdef"], columns)


def orbit_figure(name: str, columns: int = 2) -> Figure:
    """Draw one period of the periodic orbit in the form of Figs. 9 and 10, with the printed start beside it."""
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
    return assemble(panels, columns, WIDTHS[columns], tall=tall)


def _velocity_and_gap(ax: Axes, view: View) -> None:
    """Panel (b); if the mass never reaches a belt, with a bar over the gap that remains."""
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
    """Panel (c) of Fig. 7: the velocity for several periods, with a dotted line at the beginning of each."""
    _velocity_and_gap(ax, view)
    for time in np.arange(start, view.t[-1] + period / 2, period):
        ax.axvline(time, color="0.6", lw=0.6, ls=(0, (1, 2)), zorder=0)


def _with_start(ax: Axes, view: View, panel: Panel, start: tuple[float, float]) -> None:
    """Any panel, with the printed start as a diamond."""
    panel(ax, view)
    low, high = ax.get_ylim()
    margin = 0.06 * (high - low)
    ax.set_ylim(min(low, start[1] - margin), max(high, start[1] + margin))
    ax.plot(*start, "D", label="printed start", **START_STYLE)


def _phase_plane_with_start(ax: Axes, view: View, start: tuple[float, float]) -> None:
    """Panel (c) with the printed start, and an inset inside the orbit if they cannot be told apart."""
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
    """Return the parameters of a mapping's scene."""
    return load_scene(WINDOW_SCENES[mapping]).parameters


def speed_of_equality(mapping: str) -> Fraction:
    """Return the speed > 0 at which |gamma| = B0 Omega/m."""
    p = window_parameters(mapping)
    return abs(p.B0) * p.Omega / p.k


def without_other_belt(mapping: str) -> Parameters:
    """Return the scene's parameters with the other belt out of the way: the window does not depend on its speed."""
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
