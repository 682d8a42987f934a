"""Figs. 7 and 8: the grazes of belt 1 from below and from above, their printed starts, and what
follows them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import cos, hypot, inf, pi, sin
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from symosc.engine.arithmetic import mp_context
from symosc.engine.flow import constants
from symosc.engine.next_event import never_leaves
from symosc.engine.state import Covariance, Launch
from symosc.friction import NEIGHBOURS
from symosc.grazing.start import GrazingStart, grazing_start, is_grazing
from symosc.grazing.window import grazing_window
from symosc.kernels.theorem7_cases import Place, place
from symosc.model import PARAMETER_NAMES, Parameters, by_name
from symosc.paper.checks.exact import flow
from symosc.paper.checks.motions import (
    LAST_HALF_UNIT,
    certificate_of,
    flight_after,
    force_names,
    force_text,
    forces,
    forces_hold,
    is_zero,
    mode_text,
    motion,
    number,
    scene_contacts,
    subscripted,
    text,
    together,
)
from symosc.paper.checks.orbits import REACH, range_of
from symosc.paper.claims import NOT_AS_PRINTED, UNDECIDED, Evidence, Refuted, evidence, verdict
from symosc.scenes import Scene, load_scene
from symosc.simulation.trajectory import Trajectory

#: Until when motions are followed that shall have no further contact, and samples of their
#: velocity.
LATE = 60
GRAZE_SAMPLES = 8000


@dataclass(frozen=True)
class Graze:
    """What a figure of a grazing motion shows: a scene, as printed and as corrected, and the
    mapping that grazes.
    """

    printed: Scene
    scene: Scene
    mapping: str
    half_turns: int  # the phase of the grazing point in units of pi

    def flow_back(self, to_start: bool = True) -> GrazingStart:
        """Return the start from which the flow grazes: at t0 or, if not `to_start`, at the contact
        before the graze.
        """
        theta = +mp_context(60).pi * self.half_turns
        return grazing_start(
            self.scene.parameters, self.mapping, theta, t0=self.scene.t0 if to_start else None
        )

    @property
    def place(self) -> Place:
        """The domain and the belt of the graze."""
        return place(self.mapping)

    @property
    def print_is_right(self) -> bool:
        """Whether a start from which the flow grazes rounds to the printed start, all parameters
        being as printed.
        """
        return bool(nearest_graze(self.printed, self.mapping).round_to_it)


#: Fig. 7 needs A0 = 10.
FIG7 = Graze(load_scene("fig7"), load_scene("fig7-corrected"), "P2", 1)
_FIG8 = replace(load_scene("fig8"), t_end=Fraction(9))
FIG8 = Graze(_FIG8, _FIG8, "P3", 0)


@cache
def exact(figure: Graze, t_end: Any = None) -> Scene:
    """Return a figure's corrected scene with the start from which it grazes, to 40 decimals, and
    the end `t_end`.
    """
    start = figure.flow_back().start
    return replace(
        figure.scene, **(start | {"t0": figure.scene.t0, "t_end": t_end or figure.scene.t_end})
    )


def reaches_belt(scene: Scene, belt: int) -> Evidence:
    """Check whether a motion below a belt reaches it: by the event search, and for all later times
    by a bound.
    """
    p = scene.parameters
    path = motion(scene, LATE)
    first = next((event for event in path.events if event.boundary == belt), None)
    square = steady_square(p)
    speed = f"v{subscripted(belt)}"
    numbers = {
        "square of the steady velocity amplitude": text(square),
        f"square of {speed}": text(p.belt(belt) ** 2),
    }
    if first is not None:
        numbers["t of the first contact"] = text(first.t, 20)
        finding = f"The first contact is a {first.kind} at t = {text(first.t, 11)}."
        return Evidence(verdict(first.kind == "graze"), finding, numbers)
    t_max, v_max = highest_velocity(path)
    since = no_contact_since(path, belt)
    numbers |= {
        "highest velocity": f"{text(v_max, 12)} at t = {text(t_max, 9)} (to 1e-12)",
        "contacts until t": f"0 until {LATE}",
        "no contact after t, by steady amplitude and energy of the transient": text(since, 6),
    }
    if since > LATE:
        return Evidence(
            UNDECIDED, f"There is no contact until t = {LATE}; later is not known.", numbers
        )
    finding = (
        f"There is no contact, ever: until t = {LATE} the velocity rises to {text(v_max, 7)} "
        f"({speed} = {text(p.belt(belt))}), and what it tends to has the amplitude √{text(square)} "
        f"= {text(float(square) ** 0.5, 6)}, whatever A₀ is."
    )
    return Evidence(NOT_AS_PRINTED, finding, numbers)


def steady_square(p: Parameters) -> Fraction:
    """Return the square of the amplitude of the steady velocity in one domain.

    Friction and A0 do not enter.
    """
    return (p.B0 * p.Omega) ** 2 / ((p.k - p.m * p.Omega**2) ** 2 + (p.c * p.Omega) ** 2)


def highest_velocity(path: Trajectory, since: float | None = None) -> tuple[float, float]:
    """Return the time and the value of the highest velocity of a flight in domain 1, from the time
    `since` on.
    """
    if since is None:
        since = float(path.t_start)
    times = np.linspace(since, float(path.t_end), GRAZE_SAMPLES)
    _, velocities = path(times)
    i = int(np.argmax(velocities))
    t_max = float(times[i])
    if 0 < i < GRAZE_SAMPLES - 1:
        t_max = brentq(lambda t: float(path.force(1, t)), times[i - 1], times[i + 1], xtol=1e-13)
    _, v_max = path(t_max)
    return t_max, float(v_max)


def no_contact_since(path: Trajectory, belt: int) -> float:
    """Return a time after which a flight below a belt cannot reach it any more.

    Inf if no such time is found.
    """
    p = path.parameters
    domain, _ = NEIGHBOURS[belt]  # the one below the belt
    for t in np.linspace(float(path.t_start), float(path.t_end), 400):
        phase = float(p.Omega) * t
        _, v = path(t)
        start = Launch(float(v), float(path.force(domain, t)), sin(phase), cos(phase))
        if never_leaves(
            start, Covariance(0.0, 0.0, 0.0), -np.inf, float(p.belt(belt)), domain, constants(p)
        ):
            return float(t)
    return inf


def contacts_text(path: Trajectory) -> str:
    """Return the first two contacts of a motion as text, for the `numbers` of an Evidence."""
    shown = [f"{e.kind} at t = {text(e.t, 16)}" for e in path.events[:2]]
    return ", ".join(shown) or f"none until t = {text(path.t_end)}"


def tangential(figure: Graze) -> Evidence:
    """Check that the motion grazes the belt at the figure's red point, from the printed and from
    the exact start.
    """
    printed = motion(figure.printed)
    scene = exact(figure)
    p = figure.scene.parameters
    numbers = {"contacts as printed until the first slip": contacts_text(printed)}
    if p != figure.printed.parameters:
        numbers["contacts with the corrected parameter"] = contacts_text(motion(figure.scene))
    contact = scene_contacts(scene)[0]
    event = motion(scene).events[0]
    domain = figure.place.domain
    below, above, _ = forces(p, contact)
    domain_below, _ = NEIGHBOURS[contact.belt]
    if domain == domain_below:
        force = below
    else:
        force = above
    name = force_names(domain)
    touch = is_grazing(p, figure.mapping, contact.x, contact.theta)
    slope = touch.values[-1]
    grazes = event.kind == "graze" and is_zero(force) and touch.grazing
    red_point = f"{text(event.t, 25)}, {text(event.x, 12)}"
    numbers["t, x of the red point from the exact start"] = red_point
    numbers[f"{name}, G⁽¹⁾ at the red point"] = f"{force_text(force)}, {text(slope, 12)}"
    finding = (
        f"From the start to 40 decimals the motion {'grazes' if grazes else 'does not graze'} belt "
        f"{contact.belt} at t = {text(event.t, 12)}, with {name} = {force_text(force)} and G⁽¹⁾ = "
        f"{text(slope, 6)}."
    )
    rounded = motion(figure.scene).events
    if len(rounded) > 1 and rounded[0].kind == "stick":
        stick, slip, *_ = rounded
        duration = slip.t - stick.t
        numbers["stick in place of the graze, from the printed start, lasts"] = text(duration, 12)
        finding += (
            f" From the printed digits it overshoots and sticks for a time of {text(duration, 4)}."
        )
    if not printed.events:
        finding += " With the printed parameters there is no contact at all."
    as_printed = bool(printed.events) and printed.events[0].kind == "graze"
    # Where the print is right, its rounding alone keeps the printed start from grazing.
    judged = verdict(as_printed or (grazes and figure.print_is_right), grazes)
    return Evidence(judged, finding, numbers | certificate_of(scene))


def touches_once(figure: Graze) -> Evidence:
    """Check that a motion in the domain below grazes belt 1 once and never meets it again."""
    belt = figure.place.boundary
    path = motion(exact(figure), LATE)
    printed = motion(figure.printed, LATE)
    after = no_contact_since(path, belt)
    # From 1 after the graze on: at the graze itself the velocity is that of the belt.
    t, v = highest_velocity(path, float(path.events[0].t) + 1)
    numbers = {
        f"contacts until t = {LATE}, exact start": str(len(path.events)),
        "none by the energy bound after t": text(after, 6),
        f"contacts until t = {LATE} as printed": str(len(printed.events)),
        "highest velocity later": f"{text(v, 9)} at t = {text(t, 7)}",
    }
    finding = (
        f"From the exact start mass and belt {belt} have the same velocity at t = "
        f"{text(path.events[0].t, 12)} only, where the mass meets the red point's curve, and never "
        f"again: later ẋ is at most {text(v, 5)}."
    )
    as_printed, touches = (
        [event.kind for event in trajectory.events] == ["graze"] for trajectory in (printed, path)
    )
    # The simulation covers the time until LATE, and the energy bound that from `after` on.
    never_again = after < LATE
    return Evidence(verdict(as_printed, touches and never_again), finding, numbers)


def of_mapping(figure: Graze) -> Evidence:
    """Check that a motion of the figure's mapping ends, or begins, at the graze."""
    before = figure.flow_back(to_start=False)
    name = subscripted(figure.mapping)
    word = motion(exact(figure)).word
    follows = word[:1] == [figure.mapping]
    # Both flow back from the same graze, but may put it into different periods of the drive.
    t = before.t + figure.flow_back().t_m - before.t_m
    numbers = {
        f"comes from the plane of {name}": "yes" if before.found else "no",
        "mappings that follow": subscripted(" ".join(word)) or "none",
        "last contact before: t, x, belt": f"{text((t, before.x), 12)}, {before.boundary}",
    }
    finding = (
        f"Flowing back, the motion came from belt {before.boundary} at t = {text(t, 9)}, x = "
        f"{text(before.x, 9)}: so {'a' if before.found else 'no'} {name} ends in it; "
        f"{'a' if follows else 'no'} {name} begins at it."
    )
    either = before.found or follows
    as_printed = either and figure.scene.parameters == figure.printed.parameters
    return Evidence(verdict(as_printed, either), finding, numbers)


def in_window(figure: Graze) -> Evidence:
    """Check that the phase of the graze is in the window that Theorem 7 prints for its gamma and B0
    Omega/m.
    """
    p = figure.scene.parameters
    mapping = figure.mapping
    scene = exact(figure)
    window = grazing_window(p, mapping, "paper")
    event = next(event for event in motion(scene).events if event.kind == "graze")
    contact = scene_contacts(scene)[0]
    inside = window.contains(figure.half_turns * mp_context(60).pi)
    touch = is_grazing(p, mapping, contact.x, contact.theta)
    numbers = {
        "γ, B₀Ω/m": text((window.gamma, window.amplitude)),
        "case": window.case,
        "Ωt mod 2π at the graze": text(event.theta, 25),
        "G⁽⁰⁾, G⁽¹⁾": ", ".join(f"{value:.6g}" for value in touch.values),
    }
    finding = (
        f"γ = {text(window.gamma)} and B₀Ω/m = {text(window.amplitude)}, in rational numbers: case "
        f"{window.case}. Its window contains Ωt = {'π' if figure.half_turns else '0'}, and the "
        f"flow touches with order 1, G⁽¹⁾ = {touch.values[-1]:.6g}."
    )
    return evidence(inside and touch.grazing and touch.order == 1, finding, numbers)


# --- after the graze of Fig. 7 ---


def returns(scene: Scene, periods: int) -> list[tuple[float, float]]:
    """Return the changes (dx, dv) of the state over each of the first `periods` periods of the
    drive.
    """
    times = float(scene.t0) + 2 * pi / float(scene.parameters.Omega) * np.arange(periods + 1)
    states = motion(scene, LATE)(times)
    return [(float(dx), float(dv)) for dx, dv in np.diff(states, axis=1).T]


def same_point(figure: Graze) -> Evidence:
    """Compare the states at the start (blue point) and one period later, from the exact and from
    the printed start.
    """
    path = motion(exact(figure), LATE)
    (change,) = returns(exact(figure), 1)
    (printed,) = returns(figure.printed, 1)
    blue = path(float(path.t_start))
    green = path(float(path.t_start) + 2 * pi / float(figure.scene.parameters.Omega))
    same = max(map(abs, change)) <= LAST_HALF_UNIT
    as_printed = max(map(abs, printed)) <= LAST_HALF_UNIT
    numbers = {
        "x, ẋ at the blue point": text(blue, 10),
        "x, ẋ at the green point": text(green, 10),
        "differences": text(change, 10),
        "differences with all numbers as printed": text(printed, 10),
    }
    finding = (
        f"One period after the start the mass is at (x, ẋ) = ({text(green, 7)}), and it was at "
        f"({text(blue, 7)}): {'one point' if same else 'two points'} of the phase plane."
    )
    return Evidence(verdict(as_printed, same), finding, numbers)


def periodic(figure: Graze) -> Evidence:
    """Check whether the motion is, or approaches, a periodic motion, and whether the latter can
    touch the belt.
    """
    p = figure.scene.parameters
    scene = exact(figure)
    changes = [hypot(dx, dv) for dx, dv in returns(scene, 4)]
    first_change, second_change, third_change, last_change = changes
    fixed = first_change <= LAST_HALF_UNIT
    # A motion that approaches a periodic one changes from period to period by a factor below 1.
    if third_change > 0:
        factor = last_change / third_change
    else:
        factor = 0.0
    square = steady_square(p)
    level = p.belt(figure.place.boundary) ** 2
    approaches = factor < 1 and motion(scene, LATE).segments[-1].mode == "Omega1"
    detuning = (p.B0 * p.Omega) ** 2 / level - (p.c * p.Omega) ** 2
    numbers = {
        f"change of (x, ẋ) over period {i}": text(change, 8) for i, change in enumerate(changes, 1)
    } | {
        "ratio of the last two changes": text(factor, 8),
        "square of the steady velocity amplitude, of v₁": text((square, level)),
        "(k − mΩ²)²; for a periodic motion that just touches v₁": (
            f"{text((p.k - p.m * p.Omega**2) ** 2)}; {text(detuning)}"
        ),
    }
    if fixed:
        description = "periodic"
    elif approaches:
        description = "not periodic, but approaching a periodic motion"
    else:
        description = "not periodic"
    finding = (
        f"(x, ẋ) changes by {text(first_change, 6)} over the first period, by "
        f"{text(second_change, 6)} "
        f"over the next: {description}. The periodic motion has the velocity amplitude "
        f"√{text(square)} = {text(float(square) ** 0.5, 5)} and "
        f"{'can' if square >= level else 'never can'} touch v₁ = {text(p.v1)}, whatever A₀ is."
    )
    return Evidence(verdict(fixed, approaches), finding, numbers)


def not_at_belt(figure: Graze) -> Evidence:
    """Check that at the start, and one period later, x' is not the speed of the belt that the
    motion grazes.
    """
    numbers = {}
    gaps = []
    belt = figure.place.boundary
    for scene, name in ((figure.printed, "as printed"), (exact(figure), "A₀ = 10, exact start")):
        level = float(scene.parameters.belt(belt))
        period = 2 * pi / float(scene.parameters.Omega)
        path = motion(scene, LATE)
        states = [path(t) for t in (float(scene.t0), float(scene.t0) + period)]
        velocities = [float(v) for _, v in states]
        gaps += [abs(v - level) for v in velocities]
        numbers[f"ẋ at the blue and the green point, {name}"] = text(velocities, 10)
    finding = (
        f"The velocities differ from v{subscripted(belt)} by {text(min(gaps), 6)} or more: these "
        "are no grazing points."
    )
    return Evidence(verdict(min(gaps) > LAST_HALF_UNIT), finding, numbers)


# --- the stick after the graze of Fig. 8 ---


def sticks_later(figure: Graze) -> Evidence:
    """Check, from the printed and the exact start, that the contact after the red point begins a
    stick on that belt.
    """
    belt = figure.place.boundary
    scenes = (figure.printed, exact(figure))
    contacts = [
        [event for event in motion(scene).events if event.kind != "slip"] for scene in scenes
    ]
    fewest = min(map(len, contacts))
    if fewest < 2:
        raise Refuted("No contact follows.", {"contacts": fewest})
    # The first contact is that of the red point.
    printed, true = (second for _, second, *_ in contacts)
    holds = {(event.kind, event.boundary) for event in (printed, true)} == {("stick", belt)}
    numbers = {
        f"t, x of the next contact, {name} start": f"{text(event.t, 16)}, {text(event.x, 12)}"
        for name, event in (("printed", printed), ("exact", true))
    }
    finding = (
        f"The next contact is at t = {text(true.t, 11)} from the exact start "
        f"({text(printed.t, 11)} from the printed one): there the mass sticks to belt {belt}."
    )
    return evidence(holds, finding, numbers)


def stick_after(figure: Graze, check: str, *domains: int) -> Evidence:
    """Run the check of `motions` named `check`, with `domains`, on the stick after the graze from
    the exact start.
    """
    checks = {"together": together, "forces_hold": forces_hold, "flight_after": flight_after}
    # The flight after the stick needs the next contact, which is later than the scene's end.
    if domains:
        scene = exact(figure, Fraction(10))
    else:
        scene = exact(figure)
    return checks[check](scene, figure.place.boundary, *domains)


def curves_meet(figure: Graze) -> Evidence:
    """Check Fig. 8's paths of two belt points: the mass meets them at the red and the blue point,
    and nowhere else.
    """
    # Nowhere else: if it is never slower than the belt, it never falls back to a point of it.

    def as_described(path: Trajectory) -> bool:
        kinds = [(event.kind, event.boundary) for event in path.events]
        slower = any(segment.mode == "Omega1" for segment in path.segments)
        return not slower and kinds == [("graze", 1), ("stick", 1), ("slip", 1)]

    path = motion(exact(figure))
    printed = motion(figure.printed)
    p = figure.scene.parameters
    numbers = {
        f"modes of motion, {name} start": ", ".join(
            mode_text(segment.mode) for segment in trajectory.segments
        )
        for name, trajectory in (("exact", path), ("printed", printed))
    }
    red, blue, *_ = path.events
    ahead = blue.x - (red.x + number(p, p.v1) * (blue.t - red.t))
    numbers["mass minus the red point's curve, at the blue point"] = text(ahead, 12)
    holds = as_described(path)
    finding = (
        f"From the exact start the mass gets ahead of the red point's curve, by {text(ahead, 6)} "
        "at the blue point, and "
        f"{'meets the curves as described only' if holds else 'meets the curves elsewhere too'}. "
        f"From the printed start there is a {printed.events[0].kind} at the red point."
    )
    # Where the print is right, its rounding alone changes what happens from the printed start.
    as_printed = as_described(printed) or (holds and figure.print_is_right)
    return Evidence(verdict(as_printed, holds), finding, numbers)


# --- do the printed starts graze, and if not, does one misprinted number explain it? ---

START = ("t0", "x0", "v0")
#: A phase of the contact is a quarter of a turn if it is within so much of one.
PHASE = 1e-4


def contact_or_misprint(figure: Graze) -> Evidence:
    """Check that the motion as printed grazes; if not, search for a change of a single number that
    makes it graze.
    """
    scene = figure.printed
    as_printed = reaches_belt(scene, figure.place.boundary)
    if as_printed.verdict != NOT_AS_PRINTED:
        return as_printed
    names = (*PARAMETER_NAMES, *START)
    numbers = dict(as_printed.numbers)
    grazing = [value for name in names for value in values_that_graze(scene, figure.mapping, name)]
    for name in names:
        texts = [
            f"{value.shortest} (graze at t = {value.t_m:.6g})"
            for value in grazing
            if value.name == name
        ]
        numbers[f"{name} free: values that graze"] = "; ".join(texts) or "none"
    finding = (
        f"{as_printed.finding} With one number changed it grazes: {misprints(scene, grazing)}."
    )
    return Evidence(as_printed.verdict, finding, numbers)


def misprints(scene: Scene, values: Sequence[FreeValue]) -> str:
    """Return as text which of the `values` are as short as printed ones, first those that graze at
    a quarter period.
    """
    # Those are likely with which the graze is at a quarter of the period, as it is in the figures.
    quarter = pi / (2 * float(scene.parameters.Omega))
    at_quarter: list[str] = []
    at_other_times: list[str] = []
    for value in values:
        if value.as_short_as_printed:
            off = abs((value.t_m + quarter / 2) % quarter - quarter / 2)
            if value.name in START:
                digits = f"{value.value:.4f}"
            else:
                digits = value.shortest
            line = f"{value.name} = {digits} (at t = {value.t_m:.6g})"
            if off > PHASE:
                at_other_times.append(line)
            else:
                at_quarter.append(line)
    first = " or ".join(at_quarter) or "none at a quarter of a period"
    if not at_other_times:
        return first
    return f"{first}; also, at times that nothing tells from others, {' or '.join(at_other_times)}"


def start_grazes(figure: Graze) -> Evidence:
    """Check that the start that grazes nearest to the printed start, with the same t0, rounds to
    the printed start.
    """
    scene = figure.scene
    printed = figure.printed.parameters
    near = nearest_graze(scene, figure.mapping)
    values = by_name(scene.parameters)
    changed = ", ".join(
        f"{name} = {text(value)}"
        for name, value in values.items()
        if value != getattr(printed, name)
    )
    numbers = {
        "printed x₀, ẋ₀": text((scene.x0, scene.v0)),
        "nearest start that grazes, minus printed: x₀, ẋ₀": f"{near.dx:+.3g}, {near.dv:+.3g}",
        "time of its contact": f"{near.t_m:.9g}",
        "half a unit of the last printed digit": f"{HALF_UNIT:g}",
        "contacts from the printed start": contacts_text(motion(scene)),
    }
    holds = False
    conclusion = "which does not round to it"
    if near.round_to_it:
        times = " to ".join(f"{t:.8g}" for t in near.round_to_it)
        numbers["contacts at these times have starts that round to the printed one"] = times
        holds, details = _grazes_exactly(figure, Fraction(near.t_m).limit_denominator(10**9))
        numbers |= details
        if holds:
            conclusion = "which rounds to it"
        else:
            conclusion = "which rounds to it, but does not graze in many digits"
    if changed:
        subject = f"With {changed} the starts"
    else:
        subject = "The starts"
    finding = (
        f"{subject} at t₀ = {text(scene.t0)} that graze are a curve, one for each time of the "
        "contact. The one next to the printed start is "
        f"{max(abs(near.dx), abs(near.dv)):.2g} away, {conclusion}."
    )
    return Evidence(verdict(holds and not changed, holds), finding, numbers)


def _grazes_exactly(figure: Graze, t_m: Fraction) -> tuple[bool, dict[str, str]]:
    """Return whether the start for a graze at t_m grazes and rounds to the printed start, and its
    numbers.
    """
    p = figure.scene.parameters
    grazing_place = figure.place
    scene = figure.scene
    texts = grazing_start(p, figure.mapping, t_m=t_m, t0=scene.t0).start
    start: dict[str, Any] = {name: Fraction(texts[name]) for name in ("x0", "v0")}
    path = motion(replace(scene, **start, start_error=texts["start_error"]))
    x, v = flow(p, p.A(grazing_place.domain), (scene.t0, *start.values()), float(t_m))
    # Where the force vanishes at t_m.
    x_m = (
        float(p.A(grazing_place.domain))
        + float(p.B0) * cos(float(p.Omega * t_m))
        - float(p.c) * float(v)
    ) / float(p.k)
    gap = abs(float(v) - float(p.belt(grazing_place.boundary))) + abs(float(x) - x_m)
    numbers = {
        "x₀, ẋ₀ of a start that grazes": f"{texts['x0'][:22]}, {texts['v0'][:22]}",
        "contacts from it": contacts_text(path),
        "|ẋ − v_λ| + |x − xₘ| at the contact, in another closed form": f"{gap:.1g}",
    }
    rounds_to_it = all(
        abs(value - getattr(scene, name)) <= LAST_HALF_UNIT for name, value in start.items()
    )
    grazes = path.events[0].kind == "graze"
    is_confirmed = gap < 1e-9  # by the other closed form, in doubles
    return rounds_to_it and grazes and is_confirmed, numbers


# --- the search --- The starts at t0 from which a flow grazes are a curve in the plane (x0, v0),
# one point for each time t_m of the contact: x_m and v_lambda at t_m, flowed back. Printed digits
# are right if the curve meets the box of all starts that round to them. If it does not, each
# parameter and each number of the start is left free in turn: a value at which the flow from the
# printed start touches the belt, and never is beyond it, explains the figure if it is no longer
# than what is printed.

#: Instants in which a graze is sought, values of a number left free, and digits of one that grazes.
INSTANTS = 300
VALUES = 201
LONGEST = 12
HALF_UNIT = float(LAST_HALF_UNIT)


@dataclass(frozen=True)
class NearestGraze:
    """The start that grazes nearest to a printed start: dx, dv from the printed one, and the
    graze's time t_m.
    """

    t_m: float
    dx: float
    dv: float
    # from and until when the contact is of the starts that round to the printed one; []: none
    round_to_it: list[float]


@dataclass(frozen=True)
class FreeValue:
    """A `value` of the scene's number `name` with which the flow grazes, at t_m.

    All other numbers are as printed.
    """

    name: str
    value: float
    uncertainty: float  # what half a unit of the printed x0 and v0 changes the value by
    t_m: float

    @property
    def shortest(self) -> str:
        """The shortest decimal number that differs from `value` by at most `uncertainty`."""
        rounded = [float(f"{self.value:.{digits}g}") for digits in range(1, LONGEST + 1)]
        fitting = (number for number in rounded if abs(number - self.value) <= self.uncertainty)
        return f"{next(fitting, self.value):.{LONGEST}g}"

    @property
    def as_short_as_printed(self) -> bool:
        """Whether the value has no more digits than the paper prints for this parameter or start
        value.
        """
        # That is one decimal of t0, three digits of a parameter, and for x0 and v0 as many as it
        # takes.
        if self.name == "t0":
            return len(self.shortest.partition(".")[2]) <= 1
        return self.name in START or len(self.shortest.replace(".", "").lstrip("-0")) <= 3


def starts_that_graze(scene: Scene, mapping: str, t_m: np.ndarray) -> np.ndarray:
    """Return x0 and v0 at t0 of the flows that graze the mapping's belt at the times t_m."""
    p = scene.parameters
    grazing_place = place(mapping)
    v = float(p.belt(grazing_place.boundary))
    A, B0, Omega, c, k = (
        float(value) for value in (p.A(grazing_place.domain), p.B0, p.Omega, p.c, p.k)
    )
    x_m = (A + B0 * np.cos(Omega * t_m) - c * v) / k  # where the force vanishes
    return np.array(
        [flow(p, A, (t, x, v), float(scene.t0)) for t, x in zip(t_m, x_m, strict=True)]
    ).T


def nearest_graze(scene: Scene, mapping: str) -> NearestGraze:
    """Return the start that grazes nearest to the printed start, and the times of grazes whose
    start rounds to it.
    """
    printed = np.array([[float(scene.x0)], [float(scene.v0)]])

    def distance(t: float) -> float:
        return float(np.abs(starts_that_graze(scene, mapping, np.array([t])) - printed).max())

    times = (
        float(scene.t0)
        + 2 * np.pi / float(scene.parameters.Omega) * np.arange(INSTANTS + 1) / INSTANTS
    )
    coarse = np.abs(starts_that_graze(scene, mapping, times) - printed).max(axis=0)
    # Between the neighbours of a value that is no larger than theirs there is a local minimum.
    inner = coarse[1:-1]
    valleys = np.flatnonzero((inner <= coarse[:-2]) & (inner <= coarse[2:])) + 1
    if len(valleys):
        candidates = valleys[np.argsort(coarse[valleys])].tolist()
    else:
        candidates = [1 + int(np.argmin(inner))]
    best = np.nan
    around = (np.nan, np.nan)
    for i in candidates:
        ends = float(times[i - 1]), float(times[i + 1])
        minimum = minimize_scalar(distance, bounds=ends, method="bounded", options={"xatol": 1e-13})
        t = float(minimum.x)
        if not distance(t) >= distance(best):  # true for the first one, where `best` is NaN
            best = t
            around = ends
    if distance(best) <= HALF_UNIT:
        sides: Sequence[float] = around
    else:
        sides = ()
    # On both sides of the best time, where the start ceases to round to the printed one.
    round_to_it = [
        float(brentq(lambda t: distance(t) - HALF_UNIT, *sorted((best, end)), xtol=1e-12))
        for end in sides
    ]
    (dx,), (dv,) = starts_that_graze(scene, mapping, np.array([best])) - printed
    return NearestGraze(best, float(dx), float(dv), round_to_it)


def values_that_graze(scene: Scene, mapping: str, name: str) -> list[FreeValue]:
    """Return the values of one number of the scene (a parameter, t0, x0 or v0) with which the
    motion grazes.
    """
    printed = float(getattr(scene if name in START else scene.parameters, name))
    # Times come back after a period.
    if name == "t0":
        reach = pi / float(scene.parameters.Omega)
    else:
        reach = REACH * max(1.0, abs(printed))
    if name in START:
        span = (printed - reach, printed + reach)
    else:
        span = range_of(scene.parameters, name)

    def gap(value: float, **change: float) -> float:
        return _peak(scene, mapping, {name: value} | change).beyond

    values = np.unique([*np.linspace(*span, VALUES), printed])
    gaps = [gap(float(value)) for value in values]
    grazing = []
    for i, (before, after) in enumerate(pairwise(gaps)):
        # A root needs a change of sign, and a gap that jumps has none. NaN has none either.
        has_root = before * after <= 0
        jumps = abs(before - after) > 10 * max(1.0, abs(printed))
        if not has_root or jumps:
            continue
        root = float(brentq(gap, values[i], values[i + 1]))
        peak = _peak(scene, mapping, {name: root})
        if not peak.may_graze or abs(peak.beyond) > HALF_UNIT:
            continue
        # Central differences: by how much the root moves with the other numbers of the printed
        # start.
        step = 1e-6 * max(1.0, abs(root))
        by_start = 0.0
        for key in {"x0", "v0"} - {name}:
            number = float(getattr(scene, key))
            change = gap(root, **{key: number + 1e-6}) - gap(root, **{key: number - 1e-6})
            by_start += abs(change) / 2e-6
        slope = abs(gap(root + step) - gap(root - step)) / (2 * step)
        # A number of the start has the rounding of its own last digit too.
        uncertainty = HALF_UNIT * (by_start / slope + (name in START))
        grazing.append(FreeValue(name, root, uncertainty, peak.t))
    return grazing


class FlowPeak(NamedTuple):
    """The peak of a flow: how far it is beyond the belt (< 0: short of it), its time, and whether
    it can be a graze.

    For a graze the flow must be in the mapping's domain before.
    """

    beyond: float
    t: float
    may_graze: bool


def _peak(scene: Scene, mapping: str, change: dict[str, float]) -> FlowPeak:
    """Return the peak of the flow from the scene's start; `change` gives some numbers of the scene
    new values.
    """
    grazing_place = place(mapping)
    start = tuple(change.get(name, float(getattr(scene, name))) for name in START)
    exact = {name: Fraction(value) for name, value in change.items() if name not in START}
    if exact:
        p = scene.parameters.replace(**exact)
    else:
        p = scene.parameters
    A = float(p.A(grazing_place.domain))
    belt = float(p.belt(grazing_place.boundary))
    t0 = start[0]
    # Three periods from the start on.
    times = t0 + 3 * 2 * np.pi / float(p.Omega) * np.arange(INSTANTS + 1) / INSTANTS

    def beyond(t: Any) -> Any:
        _, v = flow(p, A, start, t)
        return grazing_place.side * (v - belt)

    try:
        over = beyond(times)
    except ZeroDivisionError:  # resonance without a damper
        return FlowPeak(np.nan, np.nan, may_graze=False)
    i = int(np.argmax(over))
    step = times[1] - times[0]
    around = times[i] - step, times[i] + step
    peak = minimize_scalar(
        lambda t: -float(beyond(t)), bounds=around, method="bounded", options={"xatol": 1e-10}
    )
    # Up to the contact the flow stays below the belt, and in domain 2 within the speeds of the two.
    if grazing_place.domain == 2:
        width = float(p.v2 - p.v1)
    else:
        width = inf
    starts_below = over[0] < 0 and i > 0
    in_domain = bool(starts_below and np.all(over[: i + 1] > -width))
    return FlowPeak(-float(peak.fun), float(peak.x), in_domain)
