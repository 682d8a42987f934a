"""What the page shows for a link: the motion of `symosc.simulate`, as plain values for the plots, texts and table."""

from __future__ import annotations

from collections.abc import Iterable
from math import cos, floor, log10, pi, sin
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.errors import ParameterError, SymoscError
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.mappings.theorem7_cases import PLACES
from symosc.model import NEIGHBOURS
from symosc.plot.explorer.inputs import FIELDS, link_of, read_link, scene_of
from symosc.plot.panels import EVENT_MARKS, SHAPES, Sampling, View, view_of
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event, Trajectory

#: More events than this are not followed, and more than these not listed: an answer takes no longer than a look.
MOST_SHOWN_EVENTS, TABLE_ROWS = 300, 100
#: Errors of events, relative to max(1, |value|): no picture and no number of the page shows more.
SHOWN_ACCURACY = 1e-9
SAMPLING = Sampling(per_period=60, least=12, most=1000)
#: Digits of the curves' points, relative to what a plot shows: enough to look a thousand times closer.
DRAWN_DIGITS = 7
AXIS_MARGIN = 0.06

#: The dial: the radius of a belt's ring, and how far inside of it its events are marked.
RINGS, INSIDE = {1: 0.62, 2: 1.0}, 0.15
#: Belts nearer to each other than this part of the axis have one name.
NEAR_NAMES = 0.13
#: What a stick is shaded with, by its belt.
STICK_SHADES = {1: "#e3e6eb", 2: "#b4bac6"}
#: A window's arc and its name: dark for contacts from below, light for those from above.
BELOW_COLORS, ABOVE_COLORS = ("#1f3fd6", "white"), ("#c3cdf5", "black")
ARC_COLUMNS = ("radius", "low", "high", "color", "text", "map", "label_x", "label_y")
MARKERS = {"o": "circle", "s": "square", "^": "triangle", "*": "star"}


def answer(link: str, default: Scene) -> Record:
    """Return what the page shows for a link.

    Returns
    -------
    dict
        "link" and "errors" (what is allowed, by the name of the field; "" for what belongs to none) always; what is
        drawn and said only if there are no errors.
    """
    state, notes = read_link(link, default)
    scene, errors = scene_of(state)
    content: Record = {"link": link_of(state), "errors": errors, "notes": notes}
    if scene is None:
        return content
    try:
        trajectory = simulate(scene, max_events=MOST_SHOWN_EVENTS, accuracy=SHOWN_ACCURACY)
        return content | {"notes": notes + _notes(scene, trajectory)} | _shown(scene, trajectory)
    except ParameterError as error:
        errors[error.name if error.name in FIELDS else ""] = error.allowed
    except (SymoscError, ArithmeticError) as error:
        errors[""] = f"doubles cannot follow this motion: {error}"
    return content


def _notes(scene: Scene, trajectory: Trajectory) -> list[str]:
    notes = []
    if scene.start_error is not None and any(scene.start_error):
        known = ", ".join(f"±{float(each):.3g}" for each in scene.start_error)
        notes.append(f"t₀, x₀, v₀ of this scene are known to {known}; a contact within their reach is a graze")
    if trajectory.status == "max_events":
        notes.append(f"more than {MOST_SHOWN_EVENTS} events: the picture ends there; show fewer periods")
    if trajectory.segments[0].mode.startswith("belt"):
        notes.append(f"the motion starts with a stick on belt {trajectory.segments[0].mode[-1]}")
    return notes


def _shown(scene: Scene, trajectory: Trajectory) -> Record:
    view = view_of(trajectory, None, SAMPLING)
    F1 = np.asarray(trajectory.force(1, view.t))
    forces = {1: F1} | {domain: F1 - _step_down(trajectory, domain) for domain in (2, 3)}
    ranges = _ranges(view, forces)
    return {
        "name": scene.name,
        "word": trajectory.word,
        "status": trajectory.status,
        "message": _message(trajectory),
        "count": len(trajectory.events),
        "table": [_row(event) for event in trajectory.events[:TABLE_ROWS]],
        "windows": [_window(grazing_window(scene.parameters, mapping)) for mapping in PLACES],
        "sources": {
            "curves": _curves(view, forces),
            "marks": _marks(view),
            "sticks": _sticks(view),
            "arcs": _arcs(scene),
            "contacts": _contacts(view),
        },
        "ranges": ranges,
        "belts": _belts(view, ranges["v"]),
    }


def _step_down(trajectory: Trajectory, domain: int) -> float:
    """Return F^(1) - F^(domain), which is the same in every state."""
    first, other = trajectory.force(1, trajectory.t_start), trajectory.force(domain, trajectory.t_start)
    return float(first - other)


def _message(trajectory: Trajectory) -> str:
    if trajectory.status == "undecidable":
        return f"{trajectory.message} (symosc simulate --digits)"
    return trajectory.message


# --- the plots ---


def _rounded(values: Any, span: float) -> list[float]:
    """Return values with as many decimals as a plot of that span can show."""
    decimals = DRAWN_DIGITS - floor(log10(span)) if span > 0 else DRAWN_DIGITS
    rounded: list[float] = np.round(np.asarray(values, dtype=float), max(min(decimals, 300), -300)).tolist()
    return rounded


def _span(values: np.ndarray) -> float:
    return float(np.ptp(values)) or float(np.abs(values).max())


def _curves(view: View, forces: dict[int, np.ndarray]) -> Record:
    columns = {"t": view.t, "x": view.x, "v": view.v, **{f"F{domain}": values for domain, values in forces.items()}}
    return {name: _rounded(values, _span(values)) for name, values in columns.items()}


def _marks(view: View) -> Record:
    times = np.array([mark.t for mark in view.marks])
    x, v = view.trajectory(times)
    shapes = [SHAPES[mark.label] for mark in view.marks]
    return {
        "t": times.tolist(),
        "x": x.tolist(),
        "v": v.tolist(),
        "marker": [MARKERS[shape] for shape, _ in shapes],
        "size": [2 * size for _, size in shapes],
        "color": [mark.color for mark in view.marks],
        "label": [mark.label for mark in view.marks],
        "belt": [f"belt {mark.belt}" if mark.belt else "" for mark in view.marks],
    }


def _sticks(view: View) -> Record:
    """Return the sticks; those on belt 2 are darker."""
    sticks = [each for each in view.contacts if each.until > each.since]
    return {
        "since": [each.since for each in sticks],
        "until": [each.until for each in sticks],
        "shade": [STICK_SHADES[each.belt] for each in sticks],
    }


def _ranges(view: View, forces: dict[int, np.ndarray]) -> dict[str, tuple[float, float]]:
    """Return what each axis shows: the curve, the belts that are near, and for forces the zero."""
    p, near = view.trajectory.parameters, view.belts()
    shown = {
        "x": [view.x.min(), view.x.max()],
        "v": [view.v.min(), view.v.max(), *(float(p.belt(belt)) for belt in near)],
        "F": [0.0, forces[3].min(), forces[1].max()],
    }
    ranges = {name: _with_margin(min(values), max(values)) for name, values in shown.items()}
    return ranges | {"t": (float(view.t[0]), float(view.t[-1]))}


def _with_margin(low: float, high: float) -> tuple[float, float]:
    room = AXIS_MARGIN * (high - low) or AXIS_MARGIN * max(abs(low), 1.0)
    return float(low - room), float(high + room)


def _belts(view: View, v_range: tuple[float, float]) -> Record:
    """Return the speeds of both belts, whether they are drawn, and their names beside the plots.

    The name of a belt that is too far away to be drawn is at the edge, with an arrow.
    """
    speeds = [float(view.trajectory.parameters.belt(belt)) for belt in (1, 2)]
    low, high = v_range
    drawn = [low <= speed <= high for speed in speeds]
    arrows = ["↓ " * (speed < low) + "↑ " * (speed > high) for speed in speeds]
    places = [min(max(speed, low), high) for speed in speeds]
    texts = [f"{arrows[i]}belt {i + 1}" for i in (0, 1)]
    names = list(zip(places, texts, strict=True))
    if places[1] - places[0] < NEAR_NAMES * (high - low):  # they would lie over each other
        names = [(places[drawn.index(True) if any(drawn) else 0], f"{texts[1]}\n{texts[0]}")]
    return {"speeds": speeds, "drawn": drawn, "names": names}


# --- the dial ---


def _window(window: GrazingWindow) -> Record:
    arcs = [
        f"{'[' if first else '('}{low:.4f}, {high:.4f}{']' if last else ')'}"
        for low, high, first, last in window.intervals
    ]
    return {
        "map": window.mapping,
        "place": f"Ω{'₁₂₃'[window.place.domain - 1]} at belt {window.place.boundary}",
        "from": "below" if _from_below(window) else "above",
        "phases": " ∪ ".join(arcs) or "none",
        "case": window.case,
    }


def _arcs(scene: Scene) -> Record:
    """Return the windows as arcs of the rings: dark from below, light from above."""
    arcs: dict[str, list[Any]] = {name: [] for name in ARC_COLUMNS}
    for mapping in PLACES:
        window = grazing_window(scene.parameters, mapping)
        radius = RINGS[window.place.boundary]
        for low, high in _joined(window):
            middle = (low + high) / 2 if high - low < 2 * pi else pi / 2
            row = (
                radius,
                low,
                high,
                *(BELOW_COLORS if _from_below(window) else ABOVE_COLORS),
                mapping,
                radius * cos(middle),
                radius * sin(middle),
            )
            for column, value in zip(arcs.values(), row, strict=True):
                column.append(value)
    return arcs


def _from_below(window: GrazingWindow) -> bool:
    return window.place.domain == NEIGHBOURS[window.place.boundary][0]


def _joined(window: GrazingWindow) -> Iterable[tuple[float, float]]:
    """Return the arcs of a window; two that meet at the phase 0 are one."""
    arcs = [(low, high) for low, high, *_ in window.intervals]
    return [(arcs[1][0] - 2 * pi, arcs[0][1])] if len(arcs) == 2 else arcs


def _contacts(view: View) -> Record:
    """Return the events as marks on the dial, at their phases, inside the ring of their belt."""
    events = view.trajectory.events
    marks = [(event, *EVENT_MARKS[event.kind]) for event in events]
    radius = [RINGS[event.boundary] - INSIDE for event in events]
    return {
        "x": [r * cos(event.theta) for r, event in zip(radius, events, strict=True)],
        "y": [r * sin(event.theta) for r, event in zip(radius, events, strict=True)],
        "phase": [event.theta for event in events],
        "marker": [MARKERS[SHAPES[label][0]] for _, label, _ in marks],
        "size": [1.7 * SHAPES[label][1] for _, label, _ in marks],
        "color": [color for *_, color in marks],
        "label": [label for _, label, _ in marks],
    }


# --- the table ---


def _row(event: Event) -> list[str]:
    numbers = [f"{value:.8g}" for value in (event.t, event.x, event.v, event.theta)]
    return [event.kind, *numbers, str(event.boundary), _mode(event.source), _mode(event.target)]


def _mode(name: str) -> str:
    return f"Ω{'₁₂₃'[int(name[-1]) - 1]}" if name.startswith("Omega") else f"belt {name[-1]}"
