"""The pictures of the report: the paper's figures, as printed and corrected, and its Theorem 7, with their texts.

Every number in a caption comes from the scenes and their trajectories.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from math import pi
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from symosc.exact import show
from symosc.grazing.window import grazing_window
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.paper import figures
from symosc.paper.figures import WINDOW_SCENES, period, printed_scene, start_time, stick_view
from symosc.plot.panels import Contact, View, view_of
from symosc.scenes import load_scene

STAR = "Star: the contact, magnified in the inset."
MARKS = "Blue circles: onset of a stick; green squares: its end."
LETTERS = {"Omega": "Ω", "mu1": "μ1", "mu2": "μ2"}
POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Picture(NamedTuple):
    """A figure of the report, with its heading and a sentence (`alt`) for readers who do not see it."""

    key: str
    title: str
    alt: str
    paper_figure: int | None  # the number of the paper's figure that it reproduces
    build: Callable[[], Figure]
    describe: Callable[[], str]  # returns the caption, with its numbers computed
    narrow: Callable[[], Figure] | None = None  # draws it for a phone, with panels above each other


# --- numbers and starts in captions ---


def number(value: float, digits: int = 5) -> str:
    """Return a number as captions show it."""
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    mantissa = mantissa.replace("-", "−")
    if not exponent:
        return mantissa
    power = "10" + str(int(exponent)).translate(POWERS)
    return power if mantissa == "1" else f"{mantissa}·{power}"


def listed_parameters(p: Parameters) -> str:
    """Return the parameters in one phrase."""
    values = [f"{LETTERS.get(key, key)} = {value}" for key, value in p.as_dict().items()]
    return f"Parameters {', '.join(values)}".replace("-", "−")


def parameters_and_start(name: str) -> str:
    """Return parameters and start of a scene in one sentence; a start of many digits is cut."""
    scene, start = load_scene(name), []
    for key, value in (("t0", scene.t0), ("x0", scene.x0), ("ẋ0", scene.v0)):
        text = show(value)
        start.append(f"{key} = {text if len(text) <= 14 else f'{text[:13]}…'}")
    return f"{listed_parameters(scene.parameters)}; start {', '.join(start)}.".replace("-", "−")


def _force(domain: int) -> str:
    return f"F⁽{str(domain).translate(POWERS)}⁾"


def _span(contact: Contact) -> str:
    return f"{number(contact.since)} to {number(contact.until)}"


# --- captions ---


MODEL = (
    "The mass m on a spring k and a damper c is driven by A0 + B0 cos Ωt and pressed with the force FN between "
    "belt 1, which moves with v1, and belt 2, which moves with v2 > v1. The friction coefficients are μ1 and μ2."
)
FRICTION = (
    "The friction force of both belts against the velocity of the mass: it jumps by 2 μ1 FN at v1 and by 2 μ2 FN "
    "at v2, where it takes any value in between while the mass sticks (blue)."
)
DOMAINS = (
    "The phase plane with the domains Ω1 (ẋ < v1), Ω2 (v1 < ẋ < v2) and Ω3 (ẋ > v2), and the boundaries ∂Ω12 "
    "(ẋ = v1) and ∂Ω23 (ẋ = v2). Arrows: the direction of the motion at t = 0; blue: where the mass then sticks to "
    "a belt (Theorem 4)."
)
MAPPINGS = (
    "The mappings from one switching (circle) to the next (square): P1 and P4 are sticks, P2 and P3 return to "
    "belt 1, P5 and P6 to belt 2, P7 leads from belt 2 to belt 1 and P8 from belt 1 to belt 2."
)
PRODUCTS = (
    "The product of the forces per mass on both sides of the belt that the motion switches at: (a) Fig. 5, belt 1, "
    "(b) Fig. 6, belt 2, (c) Fig. 9, belt 1, (d) Fig. 10, belt 2. It is positive where the mass passes (triangle), "
    "negative while it sticks (shaded), and 0 where a stick ends (squares)."
)


def with_parameters(caption: str, scene: str | None = None) -> str:
    """Return a caption of Figs. 2 to 4 with the parameters of a scene, or of Fig. 4."""
    p = figures.MAPPING_PARAMETERS if scene is None else load_scene(scene).parameters
    return f"{caption} {listed_parameters(p)}."


def stick_caption(name: str) -> str:
    """Return the caption of Fig. 5 or 6."""
    view = stick_view(name)
    low, high = view.domains
    sticks = [stick for stick in view.contacts if stick.belt == view.boundary and stick.until < view.t[-1]]
    # The force whose zero ends a stick is that of the domain into which the mass slips.
    into = {float(event.t): int(event.target[-1]) for event in view.trajectory.events if event.kind == "slip"}
    spans = [f"t = {_span(stick)} (ended by {_force(into[stick.until])} = 0)" for stick in sticks]
    return (
        f"As printed. (a) Displacement, (b) velocity, (c) phase plane, (d) forces per mass {_force(low)} (blue) and "
        f"{_force(high)} (green, dashed), shaded where the mass sticks to belt {view.boundary}. Red: the mass; black: "
        f"the belts. {MARKS} The mass sticks from {', '.join(spans)}. {stick_signs(view, sticks)} "
        f"{parameters_and_start(name)}"
    )


def stick_signs(view: View, sticks: list[Contact]) -> str:
    """Say whether Theorem 4's conditions hold inside sticks."""
    low, high = view.domains
    inside = np.concatenate([view.t[(stick.since < view.t) & (view.t < stick.until)] for stick in sticks])
    force = view.trajectory.force
    everywhere = bool((force(low, inside) > 0).all() and (force(high, inside) < 0).all())
    holds = "" if everywhere else " does not hold everywhere"
    return f"While it sticks, {_force(low)} > 0 > {_force(high)}{holds}."


def grazing_P2_caption(name: str) -> str:
    """Return the caption of Fig. 7 with the printed or another A0."""
    view = figures.several_periods_view(name)
    p, printed, t0 = view.trajectory.parameters, load_scene(printed_scene(name)).parameters, start_time(name)
    contact = figures.first_contact(view_of(view.trajectory, view.boundary))
    if contact is None:
        t, v = figures.largest_velocity(view)
        what = (
            f"As printed, with A0 = {show(p.A0)}: in {figures.SEVERAL_PERIODS:g} periods the mass does not reach belt "
            f"1 and nothing grazes; its largest velocity is {number(v)} at t = {number(t)}, below v1 = {show(p.v1)}."
        )
    else:
        shift = number(float((printed.A0 - p.A0) / p.k))
        what = (
            f"With A0 = {show(p.A0)} instead of {show(printed.A0)}. {_contact(view, contact)} (The same motion, moved "
            f"by {shift} in x, has A0 = {show(printed.A0)}.) {STAR}"
        )
    x, v = view.trajectory(t0 + period(name)) - view.trajectory(t0)
    return (
        f"{what} (a) Displacement of the mass (red) and of the points of belt 1 that it meets at the marks (black), "
        f"(b) velocity, (c) velocity for several periods (dotted lines: one period apart), (d) phase plane. Circle and "
        f"square: start and end of the first period, in which (x, ẋ) changes by ({number(x)}, {number(v)}). "
        f"{parameters_and_start(name)}"
    )


def grazing_P3_caption(name: str) -> str:
    """Return the caption of Fig. 8 from the printed or the exact start."""
    view = figures.grazing_view(name)
    contact, stick = figures.first_contact(view), figures.later_stick(view)
    assert contact is not None
    return (
        f"{_contact(view, contact)} {STAR} (a) Displacement of the mass (red) and of the points of belt 1 "
        f"that it meets (black), (b) velocity, (c) velocity near the later stick, (d) phase plane. {MARKS} The later "
        f"stick lasts from t = {_span(stick)}. {stick_signs(view, [stick])} {parameters_and_start(name)}"
    )


def _contact(view: View, contact: Contact) -> str:
    """Return a sentence about a contact with belt 1."""
    x = number(float(view.trajectory(contact.since)[0]), 7)
    if contact.since == contact.until:
        return f"From the exact start the mass grazes belt 1 at t = {number(contact.since, 9)}, x = {x}."
    length = number(1e3 * (contact.until - contact.since), 3)
    return (
        f"From the printed start the mass does not graze belt 1 but sticks to it at t = {number(contact.since, 7)}, "
        f"x = {x} for {length}·10⁻³."
    )


def motion_caption(name: str) -> str:
    """Return the caption of Fig. 9 or 10 from the printed start."""
    return (
        f"As printed. {_panels_text(figures.motion_view(name))} The printed start is not on the periodic orbit: "
        f"{_distance_text(f'{name}-orbit')} {parameters_and_start(name)}"
    )


def orbit_caption(orbit: str) -> str:
    """Return the caption of the true periodic orbit with the printed start."""
    view, T = figures.orbit_view(orbit), period(orbit)
    events = view.trajectory.events
    once = [event for event in events if event.t < events[0].t + 0.999 * T]
    points = ", ".join(f"({number(float(event.t), 7)}, {number(float(event.x), 7)})" for event in once)
    return (
        f"The periodic orbit {load_scene(orbit).structure} with its period T = {number(T, 7)}. {_panels_text(view)} It "
        f"switches at (t, x) = {points}. Diamond: the start printed in the paper; {_distance_text(orbit)} "
        f"{parameters_and_start(orbit)}"
    )


def _panels_text(view: View) -> str:
    low, high = view.domains
    sticks = any(event.kind == "stick" for event in view.trajectory.events)
    marks = MARKS if sticks else "Triangles: the mass passes a belt."
    return (
        f"(a) Displacement, (b) velocity, (c) phase plane, (d) to (f) forces per mass {_force(low)} (blue) and "
        f"{_force(high)} (green, dashed) against time, displacement and velocity. {marks}"
    )


def _distance_text(orbit: str) -> str:
    scene = load_scene(orbit)
    away = find_orbit(scene.parameters, str(scene.structure)).approach(printed_scene(orbit))
    return (
        f"it differs by {number(away.dt, 3)} in t and {number(away.dx, 3)} in x from the orbit's nearest switching "
        f"point, and the motion from it is within {number(away.within)} of the orbit after {away.periods} periods."
    )


def window_caption(mapping: str) -> str:
    """Return the caption of a figure of Theorem 7."""
    where, p, graze = place(mapping), figures.window_parameters(mapping), figures.window_graze(mapping)
    case = grazing_window(p, mapping).case.strip("()").partition(".")[2]
    red = "" if graze is None else f"; star: its graze at t = {number(float(graze.t), 7)}"
    speed, critical = f"v{where.boundary}", "Θ^{cr}"
    figure = printed_scene(WINDOW_SCENES[mapping]).removeprefix("fig")
    return (
        f"Theorem 7, eq. ({where.equation}): the phases mod(Ωtₘ, 2π) at which {mapping}, a motion in domain "
        f"{where.domain}, grazes belt {where.boundary} (shaded), against the belt's speed {speed}, which makes "
        f"γ = k {speed}/m and so the case of the theorem. Dashed: {critical} = arcsin(−γ m/(B0 Ω)) and π − {critical}, "
        f"which do not belong to it; dots: |γ| = B0 Ω/m, where a full one grazes and an open one does not. "
        f"Dotted: {speed} in Fig. {figure}, case {case} of ({where.equation}){red}. {_missing_phase(mapping)}"
        f"{listed_parameters(p)}."
    )


def _missing_phase(mapping: str) -> str:
    """Say which phase the theorem as printed lacks where |gamma| = B0 Omega/m."""
    where = place(mapping)
    name, speed = f"v{where.boundary}", where.side * figures.speed_of_equality(mapping)
    p = figures.without_other_belt(mapping).replace(**{name: speed})
    printed, full = grazing_window(p, mapping, "paper"), grazing_window(p, mapping, "full")
    if printed.intervals == full.intervals:
        return ""
    quarters = Fraction(printed.ends[0] / pi).limit_denominator(4)
    phase = f"{quarters.numerator if quarters.numerator > 1 else ''}π/{quarters.denominator}"
    return (
        f"At the full dot, {name} = {number(float(speed))}, {phase}, the force and its first two derivatives vanish "
        f"and the third decides: it grazes, though ({where.equation}) as printed leaves it out. "
    )


# --- all pictures ---

# What draws and what describes each form of figure: as a whole, or for a scene.
FIG1, FIG2 = (figures.fig1, partial(str, MODEL)), (figures.fig2, partial(with_parameters, FRICTION, "fig5"))
FIG3 = figures.fig3, partial(with_parameters, DOMAINS, "fig5")
FIG4 = figures.fig4, partial(with_parameters, MAPPINGS)
STICK = figures.stick_figure, stick_caption
GRAZING_P2 = figures.grazing_figure_P2, grazing_P2_caption
GRAZING_P3 = figures.grazing_figure_P3, grazing_P3_caption
MOTION, ORBIT = (figures.motion_figure, motion_caption), (figures.orbit_figure, orbit_caption)
# What scenes of a figure are called: as printed, with a number corrected, with a start of many digits, on the orbit.
FORMS = {"": "", "corrected": ", corrected", "exact": ", exact start", "orbit": ", corrected"}

Form = tuple[Callable[..., Figure], Callable[..., str]]
#: The paper's figures: key, title, form, and a sentence for readers who do not see it. From Fig. 5 on the key is
#: the scene that is drawn.
FIGURES: list[tuple[str, str, Form, str]] = [
    ("fig1", "physical model", FIG1,
     "A block on a spring and a damper is pressed between two belts that move at different speeds."),
    ("fig2", "friction force", FIG2,
     "The friction force is a staircase of three levels with a vertical jump at each belt speed."),
    ("fig3", "domains and boundaries", FIG3,
     "Two horizontal lines at the belt speeds cut the phase plane into three strips."),
    ("fig4", "basic mappings", FIG4,
     "Arcs in the strips of the phase plane and pieces of the boundaries, labelled P1 to P8."),
    ("fig5", "stick on belt 1", STICK,
     "The mass starts at rest, sticks to belt 1 three times and slips off it in between."),
    ("fig6", "stick on belt 2", STICK,
     "The mass sticks to belt 2 from the start, slips, slows down between the belts and sticks to belt 1."),
    ("fig7", "grazing of P2", GRAZING_P2,
     "With the printed parameters the velocity of the mass stays below both belts."),
    ("fig7-corrected", "with A0 = 10", GRAZING_P2,
     "The velocity rises to belt 1, where an inset shows a very short stick, and stays below it from then on."),
    ("fig7-exact", "the graze, with A0 = 10", GRAZING_P2,
     "The velocity touches belt 1 from below in one point and stays below it from then on."),
    ("fig8", "grazing of P3, then a stick", GRAZING_P3,
     "The velocity falls to belt 1, where an inset shows a very short stick, swings up and falls to it again."),
    ("fig8-exact", "the graze, then a stick", GRAZING_P3,
     "The velocity touches belt 1 from above in one point, swings up and falls to it again, where it sticks."),
    ("fig9", "non-stick periodic motion P32", MOTION,
     "The mass passes belt 1 upward and downward; its phase curve starts outside of the loop that it joins."),
    ("fig9-orbit", "the periodic orbit P32", ORBIT,
     "The orbit is a closed loop through belt 1; the printed start lies outside of it."),
    ("fig10", "stick periodic motion P4645", MOTION,
     "The mass sticks to belt 2 twice in each period, between a swing below and a swing above it."),
    ("fig10-orbit", "the periodic orbit P4645", ORBIT,
     "The orbit is a closed loop with two straight pieces on belt 2; the printed start lies close to it."),
]  # fmt: skip


def _paper_picture(key: str, title: str, form: Form, alt: str) -> Picture:
    build, describe = form
    figure, _, variant = key.removeprefix("fig").partition("-")
    heading, paper_figure = f"Fig. {figure}{FORMS[variant]}: {title}", None if variant else int(figure)
    if form in (FIG1, FIG2, FIG3, FIG4):
        return Picture(key, heading, alt, paper_figure, build, describe)
    narrow = partial(build, key, columns=1)
    return Picture(key, heading, alt, paper_figure, partial(build, key), partial(describe, key), narrow)


def _window_picture(mapping: str) -> Picture:
    title = f"Theorem 7, eq. ({place(mapping).equation}): when {mapping} grazes"
    alt = f"The phases at which {mapping} grazes, against the belt's speed, lie between the two branches of an arcsine."
    build, describe = partial(figures.window_sweep, mapping), partial(window_caption, mapping)
    return Picture(f"theorem7-{mapping.lower()}", title, alt, None, build, describe)


_PRODUCTS = Picture(
    "force-product",
    "Section 6: product of the forces",
    "Four curves of products, positive where the mass passes a belt and negative while it sticks to one.",
    None,
    figures.product_figure,
    partial(str, PRODUCTS),
    partial(figures.product_figure, columns=1),
)
#: Every picture by its key: the paper's figures in its order, then Theorem 7.
PICTURES: dict[str, Picture] = {
    picture.key: picture
    for picture in (*(_paper_picture(*row) for row in FIGURES), _PRODUCTS, *map(_window_picture, WINDOW_SCENES))
}
