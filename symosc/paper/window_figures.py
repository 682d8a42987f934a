"""Theorem 7 in pictures: the phases at which a mapping grazes, for every speed of its belt (eqs. (55) to (58))."""

from __future__ import annotations

from fractions import Fraction
from math import pi
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from symosc.grazing.window import grazing_window
from symosc.kernels.entire import EPS
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters
from symosc.paper.captions import listed_parameters, number
from symosc.paper.views import printed_scene
from symosc.plot.drawing import STYLE
from symosc.plot.panels import SWITCH_COLOR, mark_style
from symosc.plot.windows import sweep_figure
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

#: Whose parameters are taken: the scenes that graze, and for the maps of belt 2, whose grazes the paper does not show,
#: the one that is about that belt.
WINDOW_SCENES = {"P2": "fig7-exact", "P3": "fig8-exact", "P5": "fig10", "P6": "fig10"}
# In inches: as wide as Figs. 1 to 4, and legible on a phone.
WINDOW_INCHES = 3.6, 3.1


def window_sweep(mapping: str) -> Figure:
    """Draw when a mapping grazes against its belt's speed, the graze of its scene, and what Theorem 7 leaves out."""
    where, name = place(mapping), f"v{place(mapping).boundary}"
    drawing = sweep_figure(_room(mapping), mapping, name, *_range(mapping), order="full")
    drawing.set_size_inches(WINDOW_INCHES)
    (axes,) = drawing.axes
    axes.title.set_text(f"phases at which $P_{mapping[1]}$ grazes, eq. ({where.equation})")
    for area in axes.collections:
        area.set_linewidth(1.0)  # no seam where two areas meet
    names = {
        "given value": f"$v_{where.boundary}$ in Fig. {_number(mapping)}",
        "belongs to it": f"grazes, not in ({where.equation})",
        "does not belong to it": "does not graze",
    }
    for line in axes.lines:
        line.set_label(names.get(str(line.get_label()), line.get_label()))
    graze = _graze(mapping)
    if graze is not None:
        style: dict[str, Any] = mark_style("grazing point", SWITCH_COLOR) | {"clip_on": False, "ls": ""}
        axes.plot(
            float(graze.v), _phase(graze, load_scene(WINDOW_SCENES[mapping]).parameters), label="grazing point", **style
        )
    drawing.legends[0].remove()
    with rc_context(STYLE):
        handles, labels = axes.get_legend_handles_labels()
        drawing.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False, borderpad=0.1)
    return drawing


def _number(mapping: str) -> str:
    """Return the number of the paper's figure whose parameters are taken."""
    return printed_scene(WINDOW_SCENES[mapping]).removeprefix("fig")


def _equality(mapping: str) -> Fraction:
    """Return the speed > 0 at which |gamma| = B0 Omega/m."""
    p = load_scene(WINDOW_SCENES[mapping]).parameters
    return abs(p.B0) * p.Omega / p.k


def _range(mapping: str) -> tuple[Fraction, Fraction]:
    edge = 2 * _equality(mapping)
    return -edge, edge


def _room(mapping: str) -> Parameters:
    """Return the scene's parameters with the other belt out of the way: the window does not depend on its speed."""
    low, high = _range(mapping)
    p = load_scene(WINDOW_SCENES[mapping]).parameters
    return p.replace(v2=high + 1) if place(mapping).boundary == 1 else p.replace(v1=low - 1)


def _graze(mapping: str) -> Event | None:
    """Return the scene's graze, if it is one of the mapping."""
    where, domain = place(mapping), f"Omega{place(mapping).domain}"
    events = simulate(WINDOW_SCENES[mapping]).events
    grazes = [event for event in events if event.kind == "graze"]
    return next((each for each in grazes if each.boundary == where.boundary and each.source == domain), None)


def _phase(graze: Event, p: Parameters) -> float:
    """Return the phase of a graze in [0, 2 pi); one that is 0 but for the error of its time is 0."""
    theta, error = float(graze.theta), 10 * float(p.Omega) * max(graze.t_error, EPS * abs(float(graze.t)))
    return 0.0 if 2 * pi - theta <= error else theta


def window_caption(mapping: str) -> str:
    """Return the caption of `window_sweep`."""
    where, p = place(mapping), load_scene(WINDOW_SCENES[mapping]).parameters
    case = grazing_window(p, mapping).case.strip("()").partition(".")[2]
    graze = _graze(mapping)
    red = "" if graze is None else f"; star: its graze at t = {number(float(graze.t), 7)}"
    speed = f"v{where.boundary}"
    critical = "Θ^{cr}"
    return (
        f"Theorem 7, eq. ({where.equation}): the phases mod(Ωtₘ, 2π) at which {mapping}, a motion in domain "
        f"{where.domain}, grazes belt {where.boundary} (shaded), against the belt's speed {speed}, which makes "
        f"γ = k {speed}/m and so the case of the theorem. Dashed: {critical} = arcsin(−γ m/(B0 Ω)) and π − {critical}, "
        f"which do not belong to it; dots: |γ| = B0 Ω/m, where a full one grazes and an open one does not. "
        f"Dotted: {speed} in Fig. {_number(mapping)}, case {case} "
        f"of ({where.equation}){red}. {_left_out(mapping)}{listed_parameters(p)}."
    )


def _left_out(mapping: str) -> str:
    """Say which phase the theorem as printed lacks where |gamma| = B0 Omega/m."""
    where = place(mapping)
    name, speed = f"v{where.boundary}", where.side * _equality(mapping)
    p = _room(mapping).replace(**{name: speed})
    printed, full = grazing_window(p, mapping, "paper"), grazing_window(p, mapping, "full")
    if printed.intervals == full.intervals:
        return ""
    quarters = Fraction(printed.ends[0] / pi).limit_denominator(4)
    phase = f"{quarters.numerator if quarters.numerator > 1 else ''}π/{quarters.denominator}"
    return (
        f"At the full dot, {name} = {number(float(speed))}, {phase}, the force and its first two derivatives vanish "
        f"and the third decides: it grazes, though ({where.equation}) as printed leaves it out. "
    )
