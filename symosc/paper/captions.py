"""Captions of the paper's figures; every number in them comes from the scenes and their trajectories."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from symosc.exact import show
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.paper.drawings import MAPPING_PARAMETERS
from symosc.paper.views import (
    SEVERAL_PERIODS,
    first_contact,
    grazing_view,
    largest_velocity,
    later_stick,
    motion_view,
    orbit_view,
    period,
    printed_scene,
    several_periods_view,
    start_time,
    stick_view,
)
from symosc.plot.panels import Contact, View, view_of
from symosc.scenes import load_scene

STAR = "Star: the contact, magnified in the inset."
MARKS = "Blue circles: onset of a stick; green squares: its end."
LETTERS = {"Omega": "Ω", "mu1": "μ1", "mu2": "μ2"}
# A start with more digits than that is cut in captions.
START_DIGITS = 12
POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float, digits: int = 5) -> str:
    """Return a number as captions show it."""
    text = f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    if exponent:
        power = "10" + str(int(exponent)).translate(POWERS)
        return power if mantissa == "1" else f"{mantissa}·{power}".replace("-", "−")
    return mantissa.replace("-", "−")


def listed_parameters(p: Parameters) -> str:
    """Return the parameters in one phrase."""
    values = [f"{LETTERS.get(key, key)} = {value}" for key, value in p.as_dict().items()]
    return f"Parameters {', '.join(values)}".replace("-", "−")


def given(name: str) -> str:
    """Return parameters and start of a scene in one sentence."""
    scene = load_scene(name)
    start = [f"{key} = {_cut(value)}" for key, value in (("t0", scene.t0), ("x0", scene.x0), ("ẋ0", scene.v0))]
    return f"{listed_parameters(scene.parameters)}; start {', '.join(start)}.".replace("-", "−")


def model_caption() -> str:
    """Return the caption of Fig. 1."""
    return (
        "The mass m on a spring k and a damper c is driven by A0 + B0 cos Ωt and pressed with the force FN between "
        "belt 1, which moves with v1, and belt 2, which moves with v2 > v1. The friction coefficients are μ1 and μ2."
    )


def friction_caption() -> str:
    """Return the caption of Fig. 2."""
    p = load_scene("fig5").parameters
    return (
        "The friction force of both belts against the velocity of the mass: it jumps by 2 μ1 FN at v1 and by 2 μ2 FN "
        f"at v2, where it takes any value in between while the mass sticks (blue). {listed_parameters(p)}."
    )


def domains_caption() -> str:
    """Return the caption of Fig. 3."""
    p = load_scene("fig5").parameters
    return (
        "The phase plane with the domains Ω1 (ẋ < v1), Ω2 (v1 < ẋ < v2) and Ω3 (ẋ > v2), and the boundaries ∂Ω12 "
        "(ẋ = v1) and ∂Ω23 (ẋ = v2). Arrows: the direction of the motion at t = 0; blue: where the mass then sticks to "
        f"a belt (Theorem 4). {listed_parameters(p)}."
    )


def mappings_caption() -> str:
    """Return the caption of Fig. 4."""
    return (
        "The mappings from one switching (circle) to the next (square): P1 and P4 are sticks, P2 and P3 return to "
        "belt 1, P5 and P6 to belt 2, P7 leads from belt 2 to belt 1 and P8 from belt 1 to belt 2. "
        f"{listed_parameters(MAPPING_PARAMETERS)}."
    )


def stick_caption(name: str) -> str:
    """Return the caption of Fig. 5 or 6."""
    view = stick_view(name)
    low, high = view.domains
    sticks = [stick for stick in view.contacts if stick.belt == view.boundary and stick.until < view.t[-1]]
    spans = [f"t = {_span(stick)} (ended by {_zero_force(view, stick)} = 0)" for stick in sticks]
    return (
        f"As printed. (a) Displacement, (b) velocity, (c) phase plane, (d) forces per mass {_F(low)} (blue) and "
        f"{_F(high)} (green, dashed), shaded where the mass sticks to belt {view.boundary}. Red: the mass; black: the "
        f"belts. {MARKS} The mass sticks from {', '.join(spans)}. {_signs(view, sticks)} {given(name)}"
    )


def _signs(view: View, sticks: list[Contact]) -> str:
    """Say whether Theorem 4's conditions hold inside sticks."""
    low, high = view.domains
    inside = np.concatenate([view.t[(stick.since < view.t) & (view.t < stick.until)] for stick in sticks])
    force = view.trajectory.force
    everywhere = bool((force(low, inside) > 0).all() and (force(high, inside) < 0).all())
    holds = "" if everywhere else " does not hold everywhere"
    return f"While it sticks, {_F(low)} > 0 > {_F(high)}{holds}."


def _zero_force(view: View, stick: Contact) -> str:
    """Name the force whose zero ends a stick: that of the domain into which the mass slips."""
    (slip,) = [event for event in view.trajectory.events if event.kind == "slip" and float(event.t) == stick.until]
    return _F(int(slip.target[-1]))


def grazing_P2_caption(name: str) -> str:
    """Return the caption of Fig. 7 with the printed or another A0."""
    view = several_periods_view(name)
    p, t0 = view.trajectory.parameters, start_time(name)
    touching = first_contact(view_of(view.trajectory, view.boundary))
    if touching is None:
        t, v = largest_velocity(view)
        what = (
            f"As printed, with A0 = {show(p.A0)}: in {SEVERAL_PERIODS:g} periods the mass does not reach belt 1 and "
            f"nothing grazes; its largest velocity is {number(v)} at t = {number(t)}, below v1 = {show(p.v1)}."
        )
    else:
        printed = show(load_scene(printed_scene(name)).parameters.A0)
        shift = (load_scene(printed_scene(name)).parameters.A0 - p.A0) / p.k
        same = f"(The same motion, moved by {number(float(shift))} in x, has A0 = {printed}.)"
        what = f"With A0 = {show(p.A0)} instead of {printed}. {_contact(view, touching)} {same} {STAR}"
    x, v = view.trajectory(t0 + period(name)) - view.trajectory(t0)
    return (
        f"{what} (a) Displacement of the mass (red) and of the points of belt 1 that it meets at the marks (black), "
        f"(b) velocity, (c) velocity for several periods (dotted lines: one period apart), (d) phase plane. Circle and "
        f"square: start and end of the first period, in which (x, ẋ) changes by ({number(x)}, {number(v)}). "
        f"{given(name)}"
    )


def grazing_P3_caption(name: str) -> str:
    """Return the caption of Fig. 8 from the printed or the exact start."""
    view = grazing_view(name)
    touching, stick = first_contact(view), later_stick(view)
    assert touching is not None
    return (
        f"{_contact(view, touching)} {STAR} (a) Displacement of the mass (red) and of the points of belt 1 "
        f"that it meets (black), (b) velocity, (c) velocity near the later stick, (d) phase plane. {MARKS} The later "
        f"stick lasts from t = {_span(stick)}. {_signs(view, [stick])} {given(name)}"
    )


def _contact(view: View, touching: Contact) -> str:
    x = number(float(view.trajectory(touching.since)[0]), 7)
    if touching.since == touching.until:
        return f"From the exact start the mass grazes belt 1 at t = {number(touching.since, 9)}, x = {x}."
    length = number(1e3 * (touching.until - touching.since), 3)
    return (
        f"From the printed start the mass does not graze belt 1 but sticks to it at t = {number(touching.since, 7)}, "
        f"x = {x} for {length}·10⁻³."
    )


def motion_caption(name: str) -> str:
    """Return the caption of Fig. 9 or 10 from the printed start."""
    view = motion_view(name)
    return (
        f"As printed. {_six_panels(view)} The printed start is not on the periodic orbit: "
        f"{_distance(f'{name}-orbit')} {given(name)}"
    )


def orbit_caption(orbit: str) -> str:
    """Return the caption of the true periodic orbit beside the printed start."""
    view = orbit_view(orbit)
    events, structure = view.trajectory.events, load_scene(orbit).structure
    once = [event for event in events if event.t < events[0].t + 0.999 * period(orbit)]
    points = ", ".join(f"({number(float(event.t), 7)}, {number(float(event.x), 7)})" for event in once)
    return (
        f"The periodic orbit {structure} with its period T = {number(period(orbit), 7)}. {_six_panels(view)} It "
        f"switches at (t, x) = {points}. Diamond: the start printed in the paper; {_distance(orbit)} {given(orbit)}"
    )


def product_caption() -> str:
    """Return the caption of the products of forces."""
    return (
        "The product of the forces per mass on both sides of the belt that the motion switches at: (a) Fig. 5, belt 1, "
        "(b) Fig. 6, belt 2, (c) Fig. 9, belt 1, (d) Fig. 10, belt 2. It is positive where the mass passes (triangle), "
        "negative while it sticks (shaded), and 0 where a stick ends (squares)."
    )


def _six_panels(view: View) -> str:
    low, high = view.domains
    sticks = any(event.kind == "stick" for event in view.trajectory.events)
    marks = MARKS if sticks else "Triangles: the mass passes a belt."
    return (
        f"(a) Displacement, (b) velocity, (c) phase plane, (d) to (f) forces per mass {_F(low)} (blue) and {_F(high)} "
        f"(green, dashed) against time, displacement and velocity. {marks}"
    )


def _distance(orbit: str) -> str:
    scene = load_scene(orbit)
    away = find_orbit(scene.parameters, str(scene.structure)).approach(printed_scene(orbit))
    return (
        f"it differs by {number(away.dt, 3)} in t and {number(away.dx, 3)} in x from the orbit's nearest switching "
        f"point, and the motion from it is within {number(away.within)} of the orbit after {away.periods} periods."
    )


def _F(domain: int) -> str:
    return f"F⁽{str(domain).translate(POWERS)}⁾"


def _span(contact: Contact) -> str:
    return f"{number(contact.since)} to {number(contact.until)}"


def _cut(value: Fraction) -> str:
    text = show(value)
    return text if len(text) <= START_DIGITS + 2 else f"{text[: START_DIGITS + 1]}…"
