"""The data that the page shows for a link: a motion of `symosc.simulate`, as values for plots,
texts and table.

The state of the page is a text for each number. A text is read exactly, as in scene files: 0.8 and
4/5 are the same number. One more number: a field in GROUPS. One more curve: a column in
`_page_data`, and a glyph in `server`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import count
from math import ceil, cos, floor, log10, pi, sin, tau
from typing import Any, NamedTuple
from urllib.parse import parse_qsl, urlencode

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, SymoscError
from symosc.base.exact import read_start_error, show
from symosc.base.quantities import A_NUMBER, QUANTITIES, read_number, unit_of
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.kernels.theorem7_cases import PLACES
from symosc.model import (
    OSCILLATOR_NAMES,
    PARAMETER_NAMES,
    Belt,
    Model,
    Oscillator,
    Parameters,
    by_name,
)
from symosc.orbits.find import find_orbit
from symosc.plot.figures import simulate_orbit
from symosc.plot.panels import EVENT_MARKS, SHAPES, Sampling, View, view_of
from symosc.scenes import Scene, load_scene, scene_names
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event, Trajectory

#: More periods than this crowd the pictures.
MOST_SHOWN_PERIODS = 100
#: To so many digits the number of periods is shown.
PERIODS_DIGITS = 12
STARTS = ("t0", "x0", "v0")
#: How the page says what is wrong with a text that is no number.
NO_NUMBER = "is not a number; 0.8, 4/5, 8e-1 and 2*pi are"
CHANGED = ", changed"
#: What may be left out: static friction, which is then the kinetic friction of this name.
KINETIC = {"mu_s1": "mu1", "mu_s2": "mu2"}
EMPTY = {"mu_s1": "= μ₁", "mu_s2": "= μ₂"}
ONE_BELT = "the scene has one belt; the second one of the page has no friction and is far away"
SOURCE = "symosc explore"


class Field(NamedTuple):
    """An input field of a number on the page, and the range of its slider, which a typed number may
    exceed. `empty` says what an empty field means, where it may be empty.
    """

    name: str
    symbol: str
    low: str
    high: str
    step: str
    meaning: str
    unit: str
    empty: str


def _fields(*rows: str) -> list[Field]:
    """Return the input fields of these rows: name, symbol, and lowest and highest value and step of
    the slider.
    """
    fields = []
    for name, symbol, low, high, step in map(str.split, rows):
        meaning = QUANTITIES[name].meaning
        unit = unit_of(name)
        if name == "periods":
            meaning = "forcing periods shown"
            unit = "2π/Ω"
        if unit == "1":
            unit = ""
        fields.append(Field(name, symbol, low, high, step, meaning, unit, EMPTY.get(name, "")))
    return fields


#: The numbers of the page in the groups that it shows them in.
GROUPS = {
    "Mass": _fields("m m 0.1 5 0.01", "c c 0 5 0.01", "k k 0 20 0.05"),
    "Excitation A₀ + B₀ cos Ωt": _fields(
        "A0 A₀ -30 30 0.1", "B0 B₀ -30 30 0.1", "Omega Ω 0.05 8 0.01"
    ),
    "Belts": _fields(
        "v1 v₁ -15 15 0.05",
        "v2 v₂ -15 30 0.05",
        "mu1 μ₁ 0 1.5 0.01",
        "mu2 μ₂ 0 1.5 0.01",
        "mu_s1 μₛ₁ 0 1.5 0.01",
        "mu_s2 μₛ₂ 0 1.5 0.01",
        "FN F_N 0 30 0.1",
    ),
    "Start, and how much is shown": _fields(
        "t0 t₀ 0 10 0.01", "x0 x₀ -10 10 0.01", "v0 v₀ -15 15 0.01", "periods N 0.1 20 0.1"
    ),
}
FIELDS = {field.name: field for fields in GROUPS.values() for field in fields}
#: What else is in a link: the name of the scene, and to how much its start is known.
OTHER_KEYS = ("scene", "start_error")


@cache
def shipped_scenes() -> dict[str, Scene]:
    """Return the shipped scenes by name, cached."""
    return {name: load_scene(name) for name in scene_names()}


def state_of(scene: Scene) -> dict[str, str]:
    """Return the texts of the page's fields for a scene; ParameterError for a law that they cannot
    hold.
    """
    state = {"scene": scene.name, **texts_of(scene.parameters)}
    state |= {name: show(getattr(scene, name)) for name in STARTS}
    state["periods"] = (
        f"{float((scene.t_end - scene.t0) * scene.parameters.Omega) / tau:.{PERIODS_DIGITS}g}"
    )
    if scene.start_error is None:
        return state
    return state | {"start_error": ",".join(map(show, scene.start_error))}


def texts_of(model: Model) -> dict[str, str]:
    """Return the texts of the fields of a model; empty for static friction that is kinetic."""
    texts = by_name(kinetic_of(model), show) | dict.fromkeys(KINETIC, "")
    if isinstance(model, Oscillator):
        static = {f"mu_s{n}": belt for n, belt in enumerate(model.belts, 1)}
        texts |= {name: show(belt.mu_s) for name, belt in static.items() if belt.mu_s > belt.mu}
    return texts


def kinetic_of(model: Model) -> Parameters:
    """Return a model without its static friction; in place of a missing belt is one far away.

    ParameterError for what the page has no fields for: friction curves, and more than two belts.
    """
    if not isinstance(model, Oscillator):
        return model.parameters
    elsewhere = "symosc simulate and symosc figure follow"
    for n, belt in enumerate(model.belts, 1):
        if belt.curve or belt.slope:
            allowed = f"belt {n} has friction that depends on speed, which {elsewhere}"
            raise ParameterError("belts", belt, allowed)
    if len(model.belts) > 2:
        allowed = f"must be one or two on this page; {elsewhere} more"
        raise ParameterError("belts", len(model.belts), allowed)
    shared = {name: getattr(model, name) for name in OSCILLATOR_NAMES}
    return Oscillator(**shared, belts=[Belt(belt.v, belt.mu) for belt in model.belts]).parameters


def notes_of(scene: Scene) -> list[str]:
    """Return what the page says of a scene file."""
    notes = list(scene.notes)
    if len(scene.parameters.law.belts) == 1:
        notes.append(ONE_BELT)
    return notes


def read_link(query: str, default: Scene) -> tuple[dict[str, str], list[str]]:
    """Return the text of each field for the query of a link, and error messages.

    A field that is missing in the link gets its text from the shipped scene that the link names, or
    else from `default`.
    """
    texts = parse_qsl(query, keep_blank_values=True)
    given = {name: text for name, text in texts if name in FIELDS or name in OTHER_KEYS}
    notes = [
        f"the link has an unknown name {name!r}, which is left out"
        for name, _ in texts
        if name not in given
    ]
    defaults = state_of(shipped_scenes().get(given.get("scene", ""), default))
    if not set(STARTS).isdisjoint(given):
        defaults.pop("start_error", None)  # it is not that of another start
    return defaults | given, notes


def link_of(state: dict[str, str]) -> str:
    """Return the texts of the fields as the query of a link."""
    return urlencode(state)


def scene_of(state: dict[str, str]) -> tuple[Scene | None, dict[str, str]]:
    """Read a scene from the fields' texts.

    Return it and {}, or None and, for each wrong field, what is allowed.
    """
    sound = shipped_scenes()["fig5"]
    numbers = {}
    errors = {}
    for name in FIELDS:
        if name in KINETIC and not state.get(name, "").strip():
            continue
        try:
            numbers[name], _ = read_number(name, state[name])
        except ParameterError as error:
            if error.allowed.startswith(A_NUMBER):
                errors[name] = NO_NUMBER
            else:
                errors[name] = error.allowed
            numbers[name] = getattr(sound.parameters, name, Fraction(1))
    if not 0 < numbers["periods"] <= MOST_SHOWN_PERIODS:
        errors["periods"] = f"must be more than 0 and at most {MOST_SHOWN_PERIODS}"
    # A sound value takes the place of each wrong one, so that all wrong ones are named.
    parameters = None
    while parameters is None:
        try:
            parameters = Parameters(**{name: numbers[name] for name in PARAMETER_NAMES})
        except ParameterError as error:
            errors.setdefault(error.name, error.allowed)
            # An error of v1 may be that it is not less than v2.
            for name in ("v1", "v2") if error.name == "v1" else (error.name,):
                numbers[name] = getattr(sound.parameters, name)
    for name, kinetic in KINETIC.items():
        if name in numbers and numbers[name] < numbers[kinetic]:
            errors.setdefault(name, f"must be at least {kinetic} = {show(numbers[kinetic])}")
    if errors:
        return None, errors
    t_end = _end_time(numbers["t0"], numbers["periods"], parameters.Omega)
    start: dict[str, Any] = {name: numbers[name] for name in STARTS} | {"t_end": t_end}
    name = state.get("scene", "").strip() or "explored"
    known = state.get("start_error")
    try:
        scene = Scene(
            name,
            _with_static_friction(parameters, numbers),  # type: ignore[arg-type]
            **start,
            start_error=read_start_error(known.split(",")) if known else None,
        )
    except ParameterError as error:
        return None, {error.name: error.allowed}
    # A shipped scene has its source; a changed one says so in its name.
    base = name.removesuffix(CHANGED)
    shipped = shipped_scenes().get(base)
    if shipped and state_of(shipped) == state_of(replace(scene, name=base)):
        return shipped, {}
    return replace(scene, name=base + CHANGED if shipped else name, source=SOURCE), {}


def _with_static_friction(p: Parameters, numbers: Mapping[str, Fraction]) -> Model:
    """Return the parameters, as an `Oscillator` if a belt's static friction exceeds its kinetic
    friction.
    """
    static = [numbers.get("mu_s1", p.mu1), numbers.get("mu_s2", p.mu2)]
    if static == [p.mu1, p.mu2]:
        return p
    belts = [Belt(p.v1, p.mu1, mu_s=static[0]), Belt(p.v2, p.mu2, mu_s=static[1])]
    return Oscillator(**{name: getattr(p, name) for name in OSCILLATOR_NAMES}, belts=belts)


def _end_time(t0: Fraction, periods: Fraction, Omega: Fraction) -> Fraction:
    """Return t0 plus a number of periods of the drive, as the shortest decimal that gives so many
    periods back.
    """
    periods_text = f"{float(periods):.{PERIODS_DIGITS}g}"
    period = Fraction(tau) / Omega
    exact = t0 + Fraction(periods_text) * period
    exponent = floor(log10(max(float(periods_text), 1e-300)))  # of the first digit
    # Half a unit of the last digit of the periods, as a time.
    half_unit = period * Fraction(10) ** (exponent + 1 - PERIODS_DIGITS) / 2
    candidates = (round(exact, decimals) for decimals in count())
    return next(end for end in candidates if abs(end - exact) < half_unit)


# --- the answer ---

#: Digits of domains.
SUBSCRIPTS = {"1": "₁", "2": "₂", "3": "₃"}
#: More events than this are not followed, and more than these not listed: an answer takes no longer
#: than a look.
MOST_SHOWN_EVENTS = 300
TABLE_ROWS = 100
SAMPLING = Sampling(per_period=60, least=12, most=1000)
#: Digits of the curves' points, relative to what a plot shows: enough to look a thousand times
#: closer.
DRAWN_DIGITS = 7
AXIS_MARGIN = 0.06
#: Sizes of marks, in those of a figure on paper: in plots, and on the dial.
MARK_SCALE = 2
DIAL_MARK_SCALE = 1.7
#: Belts nearer than this part of the axis share one label: two would lie over each other.
LEAST_BELT_DISTANCE = 0.13

#: The dial: the radius of a belt's ring, and how far inside of it its events are marked.
RINGS = {1: 0.62, 2: 1.0}
INSIDE = 0.15
SHADES = {1: "#e3e6eb", 2: "#b4bac6"}  # of sticks on each belt
MARKERS = {"o": "circle", "s": "square", "^": "triangle", "*": "star"}


def answer(link: str, default: Scene) -> Record:
    """Return the data of the page for a link: always "link", "errors" and "notes", the rest if
    there are no errors.
    """
    # Errors say what is allowed, by the name of the field; "" for what belongs to none.
    state, notes = read_link(link, default)
    scene, errors = scene_of(state)
    content: Record = {"link": link_of(state), "errors": errors, "notes": notes}
    if scene is None:
        return content
    try:
        # No picture and no number of the page shows more.
        trajectory = simulate(scene, max_events=MOST_SHOWN_EVENTS, accuracy=1e-9)
        return (
            content | {"notes": notes + _notes(scene, trajectory)} | _page_data(scene, trajectory)
        )
    except ParameterError as error:
        errors[error.name if error.name in FIELDS else ""] = error.allowed
    except (SymoscError, ArithmeticError) as error:
        errors[""] = f"doubles cannot follow this motion: {error}"
    return content


def _notes(scene: Scene, trajectory: Trajectory) -> list[str]:
    """Return sentences for the user: how well the start is known, a motion cut short, a start in a
    stick.
    """
    notes = []
    first_mode = trajectory.segments[0].mode
    if scene.start_error is not None and any(scene.start_error):
        known = ", ".join(f"±{float(error):.3g}" for error in scene.start_error)
        notes.append(
            f"t₀, x₀, v₀ of this scene are known to {known}; a contact within their reach is a "
            "graze"
        )
    if trajectory.status == "max_events":
        notes.append(
            f"more than {MOST_SHOWN_EVENTS} events: the picture ends there; show fewer periods"
        )
    if first_mode.startswith("belt"):
        notes.append(f"the motion starts with a stick on belt {first_mode[-1]}")
    return notes


def _page_data(scene: Scene, trajectory: Trajectory) -> Record:
    """Return what the page shows of a motion: data of the plots, texts, and rows of the table."""
    view = view_of(trajectory, None, SAMPLING)
    F1 = np.asarray(trajectory.force(1, view.t))
    begin = trajectory.t_start
    # F^(1) - F^(domain) is the same in every state, so that a single force is computed.
    differences = {
        f"F{domain}": float(trajectory.force(1, begin) - trajectory.force(domain, begin))
        for domain in (2, 3)
    }
    curves = {"t": view.t, "x": view.x, "v": view.v, "F1": F1} | {
        name: F1 - difference for name, difference in differences.items()
    }
    ranges = _ranges(view, curves)
    # The phases of a touch do not depend on static friction.
    kinetic = kinetic_of(scene.parameters)
    windows = [grazing_window(kinetic, mapping) for mapping in PLACES]
    if trajectory.status == "undecidable":
        hint = " (symosc simulate --digits)"
    else:
        hint = ""
    sticks = [
        (contact.since, contact.until, SHADES[contact.belt])
        for contact in view.contacts
        if contact.until > contact.since  # a graze has no duration
    ]
    marks = []
    for mark in view.marks:
        if mark.belt:
            belt = f"belt {mark.belt}"
        else:
            belt = ""
        x, v = trajectory(mark.t).tolist()
        marks.append((mark.t, x, v, mark.color, belt, *_shape(mark.label, MARK_SCALE)))
    contacts = []  # on the dial of phases
    for event in trajectory.events:
        radius = RINGS[event.boundary] - INSIDE
        theta = event.theta
        label, color = EVENT_MARKS[event.kind]
        position = radius * cos(theta), radius * sin(theta)
        contacts.append((*position, theta, color, *_shape(label, DIAL_MARK_SCALE)))
    period = tau / float(scene.parameters.Omega)
    # The Poincaré section, at whole periods. The last one may lie outside the motion by rounding.
    section_times = np.arange(ceil(view.t[0] / period), floor(view.t[-1] / period) + 1) * period
    x, v = trajectory(np.clip(section_times, view.t[0], view.t[-1]))
    sources = {
        "curves": {name: _rounded(values) for name, values in curves.items()},
        "marks": _columns("t x v color belt marker size label", marks),
        "sticks": _columns("since until shade", sticks),
        "arcs": _columns("radius low high color text map label_x label_y", _arcs(windows)),
        "contacts": _columns("x y phase color marker size label", contacts),
        "section": {"x": x.tolist(), "v": v.tolist()},
        "start": {"x": [float(scene.x0)], "v": [float(scene.v0)]},
    }
    return {
        "name": scene.name,
        "word": trajectory.word,
        "status": trajectory.status,
        "message": trajectory.message + hint,
        "count": len(trajectory.events),
        "table": [_table_row(event) for event in trajectory.events[:TABLE_ROWS]],
        "windows": [_window_row(window) for window in windows],
        "sources": sources,
        "ranges": ranges,
        "belts": _belts(view, ranges["v"]),
    }


def settled(link: str, default: Scene) -> Record:
    """Return the page's text on the orbit to which the motion settles, and the orbit's curve in the
    phase plane.
    """
    state, _ = read_link(link, default)
    scene, _ = scene_of(state)
    text = ""
    curve = {"x": list[float](), "v": list[float]()}
    try:
        if scene is not None:
            orbit = find_orbit(scene)
            view = view_of(simulate_orbit(orbit, 1), None, SAMPLING)
            curve = {"x": _rounded(view.x), "v": _rounded(view.v)}
            text = orbit.message
            if not orbit.is_rest:
                sizes = ", ".join(f"{abs(multiplier):.4g}" for multiplier in orbit.multipliers)
                period = f"period {float(orbit.period):.6g} s"
                text = f"{orbit.word}, {period}, |multipliers| {sizes}: {text}"
    except (SymoscError, ArithmeticError) as error:
        text = str(error)
    return {"text": text, "curve": curve}


# --- the plots ---


def _rounded(values: np.ndarray) -> list[float]:
    """Return the values of a curve, rounded to the decimals that can be seen in a plot of their
    range.
    """
    span = float(np.ptp(values)) or float(np.abs(values).max())
    if span > 0:
        decimals = DRAWN_DIGITS - floor(log10(span))
    else:
        decimals = DRAWN_DIGITS
    rounded: list[float] = np.round(values, max(min(decimals, 300), -300)).tolist()
    return rounded


def _columns(names: str, rows: Iterable[Sequence[Any]]) -> Record:
    """Return a dict of columns of `rows` for a plot in the browser.

    `names` has their names, separated by spaces.
    """
    rows = list(rows)
    return {name: [row[i] for row in rows] for i, name in enumerate(names.split())}


def _shape(label: str, scale: float) -> tuple[str, float, str]:
    """Return shape, size (multiplied by `scale`) and label of the mark for an event with this
    label.
    """
    shape, size = SHAPES[label]
    return MARKERS[shape], scale * size, label


def _ranges(view: View, curves: dict[str, np.ndarray]) -> dict[str, tuple[float, float]]:
    """Return the ranges of the axes t, x, v and F for a motion and its forces F1 and F3 in
    `curves`, with a margin.
    """
    speeds = [float(view.trajectory.parameters.belt(belt)) for belt in view.belts()]
    forces = np.concatenate([[0.0], curves["F1"], curves["F3"]])
    ranges = {"t": (float(view.t[0]), float(view.t[-1]))}
    for name, values in {"x": view.x, "v": np.append(view.v, speeds), "F": forces}.items():
        low = float(values.min())
        high = float(values.max())
        room = AXIS_MARGIN * (high - low) or AXIS_MARGIN * max(abs(low), 1.0)
        ranges[name] = low - room, high + room
    return ranges


def _belts(view: View, v_range: tuple[float, float]) -> Record:
    """Return the speeds of both belts, whether each lies in the shown range `v_range`, and (height,
    text) of labels.
    """
    # The name of a belt that is too far away to be drawn is at the edge, with an arrow.
    speeds = [float(view.trajectory.parameters.belt(belt)) for belt in (1, 2)]
    low, high = v_range
    drawn = [low <= speed <= high for speed in speeds]
    heights = [min(max(speed, low), high) for speed in speeds]
    arrows = ["↓ " * (speed < low) + "↑ " * (speed > high) for speed in speeds]
    texts = [f"{arrow}belt {belt}" for belt, arrow in enumerate(arrows, 1)]
    names = list(zip(heights, texts, strict=True))
    lower, upper = heights
    if upper - lower < LEAST_BELT_DISTANCE * (high - low):
        # One label of two lines, at a belt that is drawn.
        height = heights[drawn.index(True)] if any(drawn) else lower
        lower_text, upper_text = texts
        names = [(height, f"{upper_text}\n{lower_text}")]
    return {"speeds": speeds, "drawn": drawn, "names": names}


# --- the dial ---


def _window_row(window: GrazingWindow) -> list[str]:
    """Return the texts of the cells of a grazing window's row in the page's table."""
    arcs = [f"{'(['[a]}{low:.4f}, {high:.4f}{')]'[b]}" for low, high, a, b in window.intervals]
    place = f"Ω{'₁₂₃'[window.place.domain - 1]} at belt {window.place.boundary}"
    if window.place.side > 0:
        side = "below"
    else:
        side = "above"
    return [window.mapping, place, side, " ∪ ".join(arcs) or "none", window.case]


def _arcs(windows: Sequence[GrazingWindow]) -> Iterator[tuple[Any, ...]]:
    """Yield arcs (radius, ends, colours, mapping, label's place) that show grazing windows on a
    circle of phases.
    """
    for window in windows:
        radius = RINGS[window.place.boundary]
        if window.place.side > 0:
            colors = ("#1f3fd6", "white")
        else:
            colors = ("#c3cdf5", "black")
        pieces = [(low, high) for low, high, *_ in window.intervals]
        if len(pieces) == 2:  # they meet at the phase 0
            (_, high), (low, _) = pieces
            pieces = [(low - 2 * pi, high)]
        for low, high in pieces:
            if high - low < 2 * pi:
                middle = (low + high) / 2
            else:  # the label of a full circle stands at its top
                middle = pi / 2
            yield (
                radius,
                low,
                high,
                *colors,
                window.mapping,
                radius * cos(middle),
                radius * sin(middle),
            )


def _table_row(event: Event) -> list[str]:
    """Return the texts of the cells of an event's row in the page's table."""
    numbers = [f"{value:.8g}" for value in (event.t, event.x, event.v, event.theta)]
    modes = [
        f"Ω{SUBSCRIPTS[mode[-1]]}" if mode.startswith("Omega") else f"belt {mode[-1]}"
        for mode in (event.source, event.target)
    ]
    return [event.kind, *numbers, str(event.boundary), *modes]
