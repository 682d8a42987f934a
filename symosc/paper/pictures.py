"""The pictures of the report, with their texts: the paper's figures, as printed and corrected, and
its Theorem 7.

Figs. 5 to 10 have the paper's panels, order and colours, with dots where its text puts them: belts
are black and the mass is red; blue circles and green squares are onset and end of a stick (in Fig.
7 of the first period), red triangles switching points, red stars contacts. Every number in a
caption comes from the scenes and their trajectories.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache, lru_cache, partial
from math import pi
from typing import Any, NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import minimize_scalar

from symosc.base.exact import show
from symosc.grazing.window import grazing_window
from symosc.kernels.entire import EPS
from symosc.kernels.theorem7_cases import place
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.paper.checks.motions import force_names
from symosc.paper.figures import MAPPING_PARAMETERS, fig1, fig2, fig3, fig4
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

# Periods in panel (c) of Fig. 7.
SEVERAL_PERIODS = 4.0
# How far the black curves of Figs. 7 and 8 reach beyond the points that the text names, as
# fractions of both axes.
LONG_REACH = 0.25, 0.35
# The picture of an orbit shows this part of a period on either side of it.
ORBIT_MARGIN = 0.06
START_STYLE: dict[str, Any] = {
    "mfc": "white",
    "mec": "black",
    "mew": 0.8,
    "ms": 4.2,
    "zorder": 7,
    "clip_on": False,
}

STAR = "Star: the contact, magnified in the inset."
MARKS = "Blue circles: onset of a stick; green squares: its end."
LETTERS = {"Omega": "Ω", "mu1": "μ1", "mu2": "μ2"}
POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Picture(NamedTuple):
    """A figure of the report, with its heading and a sentence (`alt`) for readers who do not see
    it.
    """

    key: str
    title: str
    alt: str
    paper_figure: int | None  # the number of the paper's figure that it reproduces
    build: Callable[[], Figure]
    describe: Callable[[], str]  # returns the caption, with its numbers computed
    narrow: Callable[[], Figure] | None = None  # draws it for a phone, with panels above each other


# --- numbers and starts in captions ---


def number(value: float, digits: int = 5) -> str:
    """Return a number as captions show it: rounded to `digits` digits, with a minus sign and a
    power of ten.
    """
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    mantissa = mantissa.replace("-", "−")
    if not exponent:
        return mantissa
    power = "10" + str(int(exponent)).translate(POWERS)
    if mantissa == "1":
        return power
    return f"{mantissa}·{power}"


def listed_parameters(p: Parameters) -> str:
    """Return the parameters in one phrase."""
    values = [f"{LETTERS.get(key, key)} = {value}" for key, value in p.as_dict().items()]
    return f"Parameters {', '.join(values)}".replace("-", "−")


def parameters_and_start(name: str) -> str:
    """Return parameters and start of a scene in one sentence; a start of many digits is cut."""
    scene = load_scene(name)
    start = {"t0": show(scene.t0), "x0": show(scene.x0), "ẋ0": show(scene.v0)}
    shown = [
        f"{key} = {text if len(text) <= 14 else f'{text[:13]}…'}" for key, text in start.items()
    ]
    return f"{listed_parameters(scene.parameters)}; start {', '.join(shown)}.".replace("-", "−")


def with_parameters(caption: str, scene: str | None = None) -> str:
    """Return a caption with the parameters of a scene appended (None: of the oscillator of Fig. 4)."""
    if scene is None:
        p = MAPPING_PARAMETERS
    else:
        p = load_scene(scene).parameters
    return f"{caption} {listed_parameters(p)}."


def _forces(view: View) -> str:
    return "forces per mass {} (blue) and {} (green, dashed)".format(
        *map(force_names, view.domains)
    )


def _span(contact: Contact) -> str:
    return f"{number(contact.since)} to {number(contact.until)}"


MODEL = (
    "The mass m on a spring k and a damper c is driven by A0 + B0 cos Ωt and pressed with the "
    "force FN between "
    "belt 1, which moves with v1, and belt 2, which moves with v2 > v1. The friction "
    "coefficients are μ1 and μ2."
)
FRICTION = (
    "The friction force of both belts against the velocity of the mass: it jumps by 2 μ1 FN at "
    "v1 and by 2 μ2 FN "
    "at v2, where it takes any value in between while the mass sticks (blue)."
)
DOMAINS = (
    "The phase plane with the domains Ω1 (ẋ < v1), Ω2 (v1 < ẋ < v2) and Ω3 (ẋ > v2), and the "
    "boundaries ∂Ω12 "
    "(ẋ = v1) and ∂Ω23 (ẋ = v2). Arrows: the direction of the motion at t = 0; blue: where the "
    "mass then sticks to "
    "a belt (Theorem 4)."
)
MAPPINGS = (
    "The mappings from one switching (circle) to the next (square): P1 and P4 are sticks, P2 and "
    "P3 return to "
    "belt 1, P5 and P6 to belt 2, P7 leads from belt 2 to belt 1 and P8 from belt 1 to belt 2."
)
PRODUCTS = (
    "The product of the forces per mass on both sides of the belt that the motion switches at: "
    "(a) Fig. 5, belt 1, "
    "(b) Fig. 6, belt 2, (c) Fig. 9, belt 1, (d) Fig. 10, belt 2. It is positive where the mass "
    "passes (triangle), "
    "negative while it sticks (shaded), and 0 where a stick ends (squares)."
)


# --- views of motions: how long one is followed, and where the text puts dots and black curves ---


def start_and_period(name: str) -> tuple[float, float]:
    """Return t0 of a scene, and the period of its drive."""
    scene = load_scene(name)
    return float(scene.t0), 2 * pi / float(scene.parameters.Omega)


def printed_scene(name: str) -> str:
    """Return the name of the printed scene for the name of a corrected one: "fig7-exact" -> "fig7"."""
    return name.partition("-")[0]


@lru_cache
def printed_view(name: str) -> View:
    """Return what Figs. 5, 6, 9 and 10 show: the motion of a scene from its printed start."""
    scene = load_scene(name)
    (t0, T) = start_and_period(name)
    return view_of(
        simulate(name, t_end=t0 + 2.2 * T if scene.structure else default_end(scene)), None
    )


@lru_cache
def several_periods_view(name: str) -> View:
    """Return what Fig. 7(c), (d) show: several periods, with marks at both ends of period 1 and the
    first contact.
    """
    t0, T = start_and_period(name)
    view = view_of(simulate(name, t_end=t0 + SEVERAL_PERIODS * T), 1)
    marks = [Mark("start of period", ONSET_COLOR, t0), Mark("end of period", END_COLOR, t0 + T)]
    marks += map(_contact_mark, _in_order(view)[:1])
    contacts = tuple(Contact(mark.t, mark.t, view.boundary) for mark in marks)
    return replace(view, marks=tuple(marks), contacts=contacts, magnified=(), belt_reach=LONG_REACH)


@lru_cache
def grazing_view(name: str) -> View:
    """Return what Fig. 8 shows: a motion with a contact with belt 1, marked red, and a later stick
    on belt 1.
    """
    view = view_of(simulate(name, t_end=default_end(load_scene(printed_scene(name)))), 1)
    contact, *_, stick = _in_order(view)
    onset = Mark("onset of stick", ONSET_COLOR, stick.since)
    end = Mark("end of stick", END_COLOR, stick.until)
    marks = view.marks[0], _contact_mark(contact), onset, end
    return replace(
        view, marks=marks, contacts=(contact, stick), magnified=(contact,), belt_reach=LONG_REACH
    )


@lru_cache
def orbit_view(name: str) -> View:
    """Return a view of one period of the periodic orbit of scene `name`, from a little before the
    printed start on.
    """
    t0, T = start_and_period(name)
    printed_start, _ = start_and_period(printed_scene(name))
    since = printed_start - ORBIT_MARGIN * T
    # The orbit's own scene starts at a switching; with the period it is known at any time.
    x, v = simulate(name, t_end=t0 + 2 * T)(since + T)
    end = since + (1 + 2 * ORBIT_MARGIN) * T
    view = view_of(simulate(load_scene(name).parameters, t0=since, x0=x, v0=v, t_end=end), None)
    return replace(view, marks=view.marks[1:])


def crop(view: View, since: float, until: float) -> View:
    """Return the part of a view between two times, sampled anew."""
    t = np.union1d(view.t[(since < view.t) & (view.t < until)], np.linspace(since, until, 200))
    x, v = view.trajectory(t)
    return replace(
        view, t=t, x=x, v=v, marks=tuple(mark for mark in view.marks if since <= mark.t <= until)
    )


def _in_order(view: View) -> tuple[Contact, ...]:
    return tuple(sorted(view.contacts, key=lambda contact: contact.since))


def _contact_mark(contact: Contact) -> Mark:
    """Return the mark of a graze, or of the onset of a stick."""
    return Mark(
        "grazing point" if contact.until == contact.since else "contact",
        SWITCH_COLOR,
        contact.since,
    )


def _paper_form(panels: list[tuple[Panel, View]], columns: int, tall: int | None = None) -> Figure:
    # Two columns for a page, one for a phone, where a point of it is 1.5 pixels.
    return assemble(panels, columns, {2: 5.2, 1: 3.4}[columns], tall=tall)


# --- Figs. 5, 6, 9 and 10, from the printed starts ---


def printed_figure(name: str, columns: int = 2) -> Figure:
    """Draw displacement, velocity, phase plane and forces; for Figs. 9 and 10 also forces against x
    and v.
    """
    if load_scene(name).structure:
        letters = "abcdef"
    else:
        letters = "abcd"
    return _paper_form([(PANELS[letter], printed_view(name)) for letter in letters], columns)


def product_figure(columns: int = 2) -> Figure:
    """Draw the products of both forces against time, of which section 6 speaks, for Figs. 5, 6, 9
    and 10.
    """
    return _paper_form(
        [(PANELS["g"], printed_view(name)) for name in ("fig5", "fig6", "fig9", "fig10")], columns
    )


def stick_caption(name: str) -> str:
    """Return the caption of Fig. 5 or 6."""
    view = printed_view(name)
    sticks = [
        stick for stick in view.contacts if stick.belt == view.boundary and stick.until < view.t[-1]
    ]
    # The force whose zero ends a stick is that of the domain into which the mass slips.
    into = {
        float(event.t): int(event.target[-1])
        for event in view.trajectory.events
        if event.kind == "slip"
    }
    spans = [
        f"t = {_span(stick)} (ended by {force_names(into[stick.until])} = 0)" for stick in sticks
    ]
    return (
        f"As printed. (a) Displacement, (b) velocity, (c) phase plane, (d) {_forces(view)}, "
        "shaded where the mass "
        f"sticks to belt {view.boundary}. Red: the mass; black: the belts. {MARKS} The mass "
        "sticks from "
        f"{', '.join(spans)}. {stick_signs(view, sticks)} {parameters_and_start(name)}"
    )


def stick_signs(view: View, sticks: list[Contact]) -> str:
    """Say whether Theorem 4's conditions hold inside sticks."""
    low, high = view.domains
    inside = np.concatenate(
        [view.t[(stick.since < view.t) & (view.t < stick.until)] for stick in sticks]
    )
    force = view.trajectory.force
    everywhere = bool((force(low, inside) > 0).all() and (force(high, inside) < 0).all())
    signs = f"{force_names(low)} > 0 > {force_names(high)}"
    return f"While it sticks, {signs}{'' if everywhere else ' does not hold everywhere'}."


def motion_caption(name: str) -> str:
    """Return the caption of Fig. 9 or 10 from the printed start."""
    return (
        f"As printed. {_panels_text(printed_view(name))} The printed start is not on the "
        "periodic orbit: "
        f"{_distance_text(f'{name}-orbit')} {parameters_and_start(name)}"
    )


def _panels_text(view: View) -> str:
    """Return the part of a caption that says what the panels (a) to (f) and their marks are."""
    sticks = any(event.kind == "stick" for event in view.trajectory.events)
    return (
        f"(a) Displacement, (b) velocity, (c) phase plane, (d) to (f) {_forces(view)} against "
        "time, displacement and "
        f"velocity. {MARKS if sticks else 'Triangles: the mass passes a belt.'}"
    )


@cache
def _distance_text(orbit: str) -> str:
    """Return the part of a caption that says how far the printed start is from an orbit."""
    scene = load_scene(orbit)
    away = find_orbit(scene.parameters, str(scene.structure)).approach(printed_scene(orbit))
    return (
        f"it differs by {number(away.dt, 3)} in t and {number(away.dx, 3)} in x from the orbit's "
        "nearest switching "
        f"point, and the motion from it is within {number(away.within)} of the orbit after "
        f"{away.periods} periods."
    )


# --- Figs. 7 and 8 ---


def grazing_figure_P2(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 7: (a) displacement and (b) velocity in the first period, (c) velocity later on,
    (d) phase plane.
    """
    several = several_periods_view(name)
    (t0, T) = start_and_period(name)
    magnified = _in_order(view_of(several.trajectory, 1))[:1]
    first = replace(crop(several, t0, t0 + 1.25 * T), magnified=magnified)
    panels: list[tuple[Panel, View]] = [(PANELS["a"], first), (_velocity_and_gap, first)]
    panels += [(partial(_velocity_of_periods, start=t0, period=T), several), (PANELS["c"], several)]
    return _paper_form(panels, columns, tall=1 if magnified else None)


def _velocity_and_gap(ax: Axes, view: View) -> None:
    """Draw panel (b), velocity over time; if the mass never reaches a belt, a bar marks the gap
    that is left.
    """
    PANELS["b"](ax, view)
    if view.trajectory.events:
        return
    (t, v) = largest_velocity(view)
    speed = float(view.trajectory.parameters.belt(view.boundary))
    bar = {"arrowstyle": "|-|, widthA=0.2, widthB=0.2", "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (t, speed), (t, v), arrowprops=bar)
    ax.annotate(
        f"gap {speed - v:.2f}",
        (t, speed),
        (0, 3),
        textcoords="offset points",
        ha="center",
        fontsize=8,
    )
    low, high = ax.get_ylim()
    ax.set_ylim(low, max(high, speed + 0.15 * (speed - low)))


def _velocity_of_periods(ax: Axes, view: View, start: float, period: float) -> None:
    """Draw panel (c) of Fig. 7: the velocity over several periods, each beginning with a dotted
    line.
    """
    _velocity_and_gap(ax, view)
    for time in np.arange(start, view.t[-1] + period / 2, period):
        ax.axvline(time, color="0.6", lw=0.6, ls=(0, (1, 2)), zorder=0)


def largest_velocity(view: View) -> tuple[float, float]:
    """Return the time and the value of the largest velocity in a view."""
    guess = view.t[np.argmax(view.v)]
    step = 2 * pi / float(view.trajectory.parameters.Omega) / 60
    bounds = max(guess - step, view.t[0]), min(guess + step, view.t[-1])

    def minus_velocity(t: float) -> float:
        _, v = view.trajectory(t)
        return -float(v)

    peak = minimize_scalar(minus_velocity, bounds=bounds, method="bounded")
    return float(peak.x), -float(peak.fun)


def grazing_P2_caption(name: str) -> str:
    """Return the caption of Fig. 7 with the printed or another A0."""
    view = several_periods_view(name)
    (t0, T) = start_and_period(name)
    p = view.trajectory.parameters.parameters
    printed = load_scene(printed_scene(name)).parameters
    contacts = _in_order(view_of(view.trajectory, view.boundary))
    if contacts:
        shift = number(float((printed.A0 - p.A0) / p.k))
        opening = (
            f"With A0 = {show(p.A0)} instead of {show(printed.A0)}. "
            f"{_contact_text(view, contacts[0])} (The same "
            f"motion, moved by {shift} in x, has A0 = {show(printed.A0)}.) {STAR}"
        )
    else:
        t, v = largest_velocity(view)
        opening = (
            f"As printed, with A0 = {show(p.A0)}: in {SEVERAL_PERIODS:g} periods the mass does "
            "not reach belt 1 and "
            f"nothing grazes; its largest velocity is {number(v)} at t = {number(t)}, below v1 = "
            f"{show(p.v1)}."
        )
    x, v = view.trajectory(t0 + T) - view.trajectory(t0)
    return (
        f"{opening} (a) Displacement of the mass (red) and of the points of belt 1 that it meets at "
        "the marks (black), "
        "(b) velocity, (c) velocity for several periods (dotted lines: one period apart), (d) "
        "phase plane. Circle and "
        f"square: start and end of the first period, in which (x, ẋ) changes by ({number(x)}, "
        f"{number(v)}). "
        f"{parameters_and_start(name)}"
    )


def grazing_figure_P3(name: str, columns: int = 2) -> Figure:
    """Draw Fig. 8: (a) displacement, (b) velocity, (c) velocity near the stick, (d) phase plane."""
    view = grazing_view(name)
    _, stick = view.contacts
    reach = 1.2 * (stick.until - stick.since)
    close_up = crop(replace(view, magnified=()), stick.since - reach, stick.until + reach)
    panels = [
        (PANELS["a"], view),
        (PANELS["b"], view),
        (PANELS["b"], close_up),
        (PANELS["c"], view),
    ]
    return _paper_form(panels, columns, tall=1)


def grazing_P3_caption(name: str) -> str:
    """Return the caption of Fig. 8 from the printed or the exact start."""
    view = grazing_view(name)
    contact, stick = view.contacts
    return (
        f"{_contact_text(view, contact)} {STAR} (a) Displacement of the mass (red) and of the "
        "points of belt 1 "
        "that it meets (black), (b) velocity, (c) velocity near the later stick, (d) phase "
        f"plane. {MARKS} The later "
        f"stick lasts from t = {_span(stick)}. {stick_signs(view, [stick])} "
        f"{parameters_and_start(name)}"
    )


def _contact_text(view: View, contact: Contact) -> str:
    """Return a sentence about a contact with belt 1."""
    position, _ = view.trajectory(contact.since)
    x = number(float(position), 7)
    if contact.since == contact.until:
        return (
            f"From the exact start the mass grazes belt 1 at t = {number(contact.since, 9)}, x = "
            f"{x}."
        )
    length = number(1e3 * (contact.until - contact.since), 3)
    return (
        "From the printed start the mass does not graze belt 1 but sticks to it at t = "
        f"{number(contact.since, 7)}, "
        f"x = {x} for {length}·10⁻³."
    )


def orbit_figure(name: str, columns: int = 2) -> Figure:
    """Draw one period of the periodic orbit in the form of Figs. 9 and 10, with the printed start."""
    scene = load_scene(printed_scene(name))
    panels = dict(PANELS)
    t, x, v = (float(value) for value in (scene.t0, scene.x0, scene.v0))
    for letter, start in (("a", (t, x)), ("b", (t, v)), ("c", (x, v))):
        panels[letter] = partial(_draw_with_start, panel=PANELS[letter], start=start)
    return _paper_form([(panels[letter], orbit_view(name)) for letter in "abcdef"], columns)


def _draw_with_start(ax: Axes, view: View, panel: Panel, start: tuple[float, float]) -> None:
    """Draw a panel with a diamond at the printed start; if an event is close, panel (c) gets a
    magnified inset.
    """
    panel(ax, view)
    abscissa, height = start
    low, high = ax.get_ylim()
    margin = 0.06 * (high - low)
    ax.set_ylim(min(low, height - margin), max(high, height + margin))
    ax.plot(*start, "D", label="printed start", **START_STYLE)
    crossing = min(view.trajectory.events, key=lambda event: abs(float(event.x) - abscissa))
    distance = abs(float(crossing.x) - abscissa)
    if panel is not PANELS["c"] or distance > 0.02 * np.ptp(view.x):
        return
    inset = ax.inset_axes((0.33, 0.39, 0.42, 0.2))
    inset.plot(view.x, view.v, color=MASS_COLOR, lw=1.3)
    inset.axhline(float(crossing.v), color=BELT_COLOR, lw=0.6)
    inset.plot(
        float(crossing.x),
        float(crossing.v),
        linestyle="none",
        **mark_style("end of stick", END_COLOR),
    )
    inset.plot(*start, "D", **START_STYLE)
    inset.set(
        xlim=abscissa + np.array([-3, 2]) * distance, ylim=height + np.array([-40, 20]) * distance
    )
    inset.tick_params(labelsize=7, labelfontfamily="STIXGeneral", pad=2)
    inset.set_yticks([height])
    ax.indicate_inset_zoom(inset, edgecolor="0.6", lw=0.5)


def orbit_caption(orbit: str) -> str:
    """Return the caption of the true periodic orbit with the printed start."""
    view = orbit_view(orbit)
    (_, T) = start_and_period(orbit)
    events = view.trajectory.events
    # Those of one period, without the one that ends it.
    events_of_period = [event for event in events if event.t < events[0].t + 0.999 * T]
    points = ", ".join(
        f"({number(float(event.t), 7)}, {number(float(event.x), 7)})" for event in events_of_period
    )
    return (
        f"The periodic orbit {load_scene(orbit).structure} with its period T = {number(T, 7)}. "
        f"{_panels_text(view)} It "
        f"switches at (t, x) = {points}. Diamond: the start printed in the paper; "
        f"{_distance_text(orbit)} "
        f"{parameters_and_start(orbit)}"
    )


# --- Theorem 7, eqs. (55) to (58) ---

#: The scenes whose parameters are used: those that graze; for the mappings of belt 2, of which the
#: paper shows no graze, the scene about that belt.
WINDOW_SCENES = {"P2": "fig7-exact", "P3": "fig8-exact", "P5": "fig10", "P6": "fig10"}


def window_parameters(mapping: str) -> tuple[Parameters, Fraction, Parameters]:
    """Return a mapping's parameters, the belt speed with |gamma| = B0 Omega/m, and parameters to
    sweep this speed.
    """
    p = load_scene(WINDOW_SCENES[mapping]).parameters
    equality = abs(p.B0) * p.Omega / p.k
    far = 2 * equality + 1  # the window is independent of the other belt's speed
    return p, equality, p.replace(v2=far) if place(mapping).boundary == 1 else p.replace(v1=-far)


def window_graze(mapping: str) -> Event | None:
    """Return the first graze in a mapping's scene at the mapping's belt and from its domain; None
    if there is none.
    """
    grazing_place = place(mapping)
    events = simulate(WINDOW_SCENES[mapping]).events
    sought = ("graze", grazing_place.boundary, f"Omega{grazing_place.domain}")
    return next(
        (event for event in events if (event.kind, event.boundary, event.source) == sought), None
    )


def window_sweep(mapping: str) -> Figure:
    """Draw the grazing phases of a mapping against the belt's speed, and mark those that Theorem 7
    leaves out.
    """
    grazing_place = place(mapping)
    (p, equality, free) = window_parameters(mapping)
    drawing = sweep_figure(
        free, mapping, f"v{grazing_place.boundary}", -2 * equality, 2 * equality, order="full"
    )
    drawing.set_size_inches(3.6, 3.1)
    (axes,) = drawing.axes
    axes.title.set_text(f"phases at which $P_{mapping[1]}$ grazes, eq. ({grazing_place.equation})")
    for area in axes.collections:
        area.set_linewidth(1.0)  # no seam where two areas meet
    names = {
        "given value": f"$v_{grazing_place.boundary}$ in Fig. "
        f"{printed_scene(WINDOW_SCENES[mapping]).removeprefix('fig')}",
        "belongs to it": f"grazes, not in ({grazing_place.equation})",
        "does not belong to it": "does not graze",
    }
    for line in axes.lines:
        line.set_label(names.get(str(line.get_label()), line.get_label()))
    graze = window_graze(mapping)
    if graze is not None:
        # A phase that is 0 but for the error of its time is 0.
        theta = float(graze.theta)
        error = 10 * float(p.Omega) * max(graze.t_error, EPS * abs(float(graze.t)))
        style: dict[str, Any] = mark_style("grazing point", SWITCH_COLOR) | {
            "clip_on": False,
            "ls": "",
        }
        axes.plot(
            float(graze.v),
            0.0 if 2 * pi - theta <= error else theta,
            label="grazing point",
            **style,
        )
    drawing.legends[0].remove()
    with rc_context(STYLE):
        handles, labels = axes.get_legend_handles_labels()
        drawing.legend(
            handles, labels, loc="outside lower center", ncols=2, frameon=False, borderpad=0.1
        )
    return drawing


def window_caption(mapping: str) -> str:
    """Return the caption of the figure of a mapping's grazing phases against the belt's speed
    (Theorem 7).
    """
    grazing_place = place(mapping)
    graze = window_graze(mapping)
    p, equality, free = window_parameters(mapping)
    _, _, case = grazing_window(p, mapping).case.strip("()").partition(".")  # of "(55.1)"
    if graze is None:
        red = ""
    else:
        red = f"; star: its graze at t = {number(float(graze.t), 7)}"
    speed = f"v{grazing_place.boundary}"
    critical = "Θ^{cr}"
    figure = printed_scene(WINDOW_SCENES[mapping]).removeprefix("fig")
    caption = (
        f"Theorem 7, eq. ({grazing_place.equation}): the phases mod(Ωtₘ, 2π) at which {mapping}, a "
        "motion in domain "
        f"{grazing_place.domain}, grazes belt {grazing_place.boundary} (shaded), against the belt's speed "
        f"{speed}, which makes "
        f"γ = k {speed}/m and so the case of the theorem. Dashed: {critical} = arcsin(−γ m/(B0 "
        f"Ω)) and π − {critical}, "
        "which do not belong to it; dots: |γ| = B0 Ω/m, where a full one grazes and an open one "
        "does not. "
        f"Dotted: {speed} in Fig. {figure}, case {case} of ({grazing_place.equation}){red}. "
    )
    at_equality = free.replace(**{speed: grazing_place.side * equality})
    printed = grazing_window(at_equality, mapping, "paper")
    full = grazing_window(at_equality, mapping, "full")
    if printed.intervals != full.intervals:
        quarters = Fraction(printed.ends[0] / pi).limit_denominator(4)
        phase = f"{quarters.numerator if quarters.numerator > 1 else ''}π/{quarters.denominator}"
        caption += (
            f"At the full dot, {speed} = {number(float(grazing_place.side * equality))}, {phase}, the "
            "force and its first two "
            f"derivatives vanish and the third decides: it grazes, though ({grazing_place.equation}) as "
            "printed leaves it out. "
        )
    return f"{caption}{listed_parameters(p)}."


# What a title says of a scene as printed, with a number corrected, with a start of many digits, or
# on the orbit.
FORMS = {"": "", "corrected": ", corrected", "exact": ", exact start", "orbit": ", corrected"}

#: The paper's figures: key, title, what draws and what describes it, and a sentence for readers who
#: do not see it. From Fig. 5 on the key is the scene that is drawn.
FIGURES: list[tuple[str, str, Callable[..., Figure], Callable[..., str], str]] = [
    ("fig1", "physical model", fig1, partial(str, MODEL),
     "A block on a spring and a damper is pressed between two belts that move at different "
     "speeds."),
    ("fig2", "friction force", fig2, partial(with_parameters, FRICTION, "fig5"),
     "The friction force is a staircase of three levels with a vertical jump at each belt speed."),
    ("fig3", "domains and boundaries", fig3, partial(with_parameters, DOMAINS, "fig5"),
     "Two horizontal lines at the belt speeds cut the phase plane into three strips."),
    ("fig4", "basic mappings", fig4, partial(with_parameters, MAPPINGS),
     "Arcs in the strips of the phase plane and pieces of the boundaries, labelled P1 to P8."),
    ("fig5", "stick on belt 1", printed_figure, stick_caption,
     "The mass starts at rest, sticks to belt 1 three times and slips off it in between."),
    ("fig6", "stick on belt 2", printed_figure, stick_caption,
     "The mass sticks to belt 2 from the start, slips, slows down between the belts and sticks "
     "to belt 1."),
    ("fig7", "grazing of P2", grazing_figure_P2, grazing_P2_caption,
     "With the printed parameters the velocity of the mass stays below both belts."),
    ("fig7-corrected", "with A0 = 10", grazing_figure_P2, grazing_P2_caption,
     "The velocity rises to belt 1, where an inset shows a very short stick, and stays below it "
     "from then on."),
    ("fig7-exact", "the graze, with A0 = 10", grazing_figure_P2, grazing_P2_caption,
     "The velocity touches belt 1 from below in one point and stays below it from then on."),
    ("fig8", "grazing of P3, then a stick", grazing_figure_P3, grazing_P3_caption,
     "The velocity falls to belt 1, where an inset shows a very short stick, swings up and falls "
     "to it again."),
    ("fig8-exact", "the graze, then a stick", grazing_figure_P3, grazing_P3_caption,
     "The velocity touches belt 1 from above in one point, swings up and falls to it again, "
     "where it sticks."),
    ("fig9", "non-stick periodic motion P32", printed_figure, motion_caption,
     "The mass passes belt 1 upward and downward; its phase curve starts outside of the loop "
     "that it joins."),
    ("fig9-orbit", "the periodic orbit P32", orbit_figure, orbit_caption,
     "The orbit is a closed loop through belt 1; the printed start lies outside of it."),
    ("fig10", "stick periodic motion P4645", printed_figure, motion_caption,
     "The mass sticks to belt 2 twice in each period, between a swing below and a swing above it."),
    ("fig10-orbit", "the periodic orbit P4645", orbit_figure, orbit_caption,
     "The orbit is a closed loop with two straight pieces on belt 2; the printed start lies "
     "close to it."),
]  # fmt: skip


def _pictures() -> Iterator[Picture]:
    """Yield the paper's figures in its order, the products of forces, and Theorem 7."""
    for key, title, build, describe, alt in FIGURES:
        figure, _, variant = key.removeprefix("fig").partition("-")
        heading = f"Fig. {figure}{FORMS[variant]}: {title}"
        paper_figure = None if variant else int(figure)
        if int(figure) < 5:
            yield Picture(key, heading, alt, paper_figure, build, describe)
        else:
            of_scene = partial(build, key)
            narrow = partial(build, key, columns=1)
            captioned = partial(describe, key)
            yield Picture(key, heading, alt, paper_figure, of_scene, captioned, narrow)
    yield Picture(
        key="force-product",
        title="Section 6: product of the forces",
        alt="Four curves of products, positive where the mass passes a belt and negative while it "
        "sticks to one.",
        paper_figure=None,
        build=product_figure,
        describe=partial(str, PRODUCTS),
        narrow=partial(product_figure, columns=1),
    )
    for mapping in WINDOW_SCENES:
        yield Picture(
            key=f"theorem7-{mapping.lower()}",
            title=f"Theorem 7, eq. ({place(mapping).equation}): when {mapping} grazes",
            alt=f"The phases at which {mapping} grazes, against the belt's speed, lie between the "
            "two branches of an arcsine.",
            paper_figure=None,
            build=partial(window_sweep, mapping),
            describe=partial(window_caption, mapping),
        )


#: Every picture by its key.
PICTURES = {picture.key: picture for picture in _pictures()}
