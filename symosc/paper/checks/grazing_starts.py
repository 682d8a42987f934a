"""Figs. 7 and 8: do the printed starts graze, and if not, does one misprinted number explain it?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import cos, pi
from typing import Any

from symosc.grazing.start import grazing_start
from symosc.mappings.theorem7_cases import place
from symosc.paper.checks.contacts import motion, text, verdict
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.grazing_figures import LAST_HALF_UNIT, Graze, contacts_text, fig7, fig8, reaches_belt
from symosc.paper.checks.linear_flow import flow
from symosc.paper.evidence import NOT_AS_PRINTED, Evidence
from symosc.paper.graze_search import START, FreeValue, nearest_graze, search
from symosc.scenes import Scene

#: A parameter is printed with no more significant digits than this.
MISPRINTED_DIGITS = 3
#: A phase of the contact is a quarter of a turn if it is within so much of one.
PHASE = 1e-4


@flown_again
def fig7_contact() -> Evidence:
    """Check that the motion of Fig. 7 with all numbers as printed grazes belt 1, or which numbers would do."""
    return contact_or_misprint(fig7().printed, "P2")


def contact_or_misprint(scene: Scene, mapping: str) -> Evidence:
    """Check that a motion grazes; if not, search for single numbers with which it does."""
    as_printed = reaches_belt(scene, place(mapping).boundary)
    if as_printed.verdict != NOT_AS_PRINTED:
        return as_printed
    found = search(scene, mapping, float(LAST_HALF_UNIT))
    numbers = dict(as_printed.numbers)
    for name in (*scene.parameters.as_dict(), *START):
        of_name = [each for each in found if each.name == name]
        numbers[f"{name} free: values that graze"] = "; ".join(map(_value, of_name)) or "none"
    finding = f"{as_printed.finding} With one number changed it grazes: {misprints(scene, found)}."
    return Evidence(as_printed.verdict, finding, numbers)


def _value(found: FreeValue) -> str:
    return f"{found.shortest} (graze at t = {found.t_m:.6g})"


def explains(scene: Scene, found: FreeValue) -> bool:
    """Tell whether a value is as short as what is printed: parameters have few digits, x0 and v0 four decimals."""
    if found.name in ("x0", "v0"):
        return True
    decimals = len(found.shortest.partition(".")[2])
    return found.digits <= MISPRINTED_DIGITS if found.name != "t0" else decimals <= 1


def misprints(scene: Scene, found: Sequence[FreeValue]) -> str:
    """List the values that are as short as the printed ones; first those that graze at a quarter of a period."""
    quarter = pi / (2 * float(scene.parameters.Omega))
    lists: tuple[list[str], list[str]] = ([], [])
    for each in found:
        if explains(scene, each):
            off = abs((each.t_m + quarter / 2) % quarter - quarter / 2)
            value = f"{each.value:.4f}" if each.name in START else each.shortest
            lists[off > PHASE].append(f"{each.name} = {value} (at t = {each.t_m:.6g})")
    first = " or ".join(lists[0]) or "none at a quarter of a period"
    others = f"; also, at times that nothing tells from others, {' or '.join(lists[1])}" if lists[1] else ""
    return f"{first}{others}"


@flown_again
def fig7_start() -> Evidence:
    """Check that the printed start of Fig. 7 is that of a graze."""
    return start_grazes(fig7())


@flown_again
def fig8_start() -> Evidence:
    """Check that the printed start of Fig. 8 is that of a graze."""
    return start_grazes(fig8())


def start_grazes(figure: Graze) -> Evidence:
    """Find the start of a graze next to the printed one, of all phases of the contact: does it round to it?"""
    scene, mapping = figure.scene, figure.mapping
    near = nearest_graze(scene, mapping, float(LAST_HALF_UNIT))
    changed = [
        f"{name} = {text(getattr(scene.parameters, name))}"
        for name in scene.parameters.as_dict()
        if getattr(scene.parameters, name) != getattr(figure.printed.parameters, name)
    ]
    numbers = {
        "printed x₀, ẋ₀": f"{text(scene.x0)}, {text(scene.v0)}",
        "nearest start that grazes, minus printed: x₀, ẋ₀": f"{near.dx:+.3g}, {near.dv:+.3g}",
        "time of its contact": f"{near.t_m:.9g}",
        "half a unit of the last printed digit": f"{float(LAST_HALF_UNIT):g}",
        "contacts from the printed start": contacts_text(motion(scene)),
    }
    held, how = False, "which does not round to it"
    if near.rounds:
        numbers["contacts at these times have starts that round to the printed one"] = (
            f"{near.t_low:.8g} to {near.t_high:.8g}"
        )
        held = _exactly(figure, Fraction(near.t_m).limit_denominator(10**9), numbers)
        how = "which rounds to it" if held else "which rounds to it, but does not graze in many digits"
    condition = f"With {', '.join(changed)} the" if changed else "The"
    finding = (
        f"{condition} starts at t₀ = {text(scene.t0)} that graze are a curve, one for each time of the contact. The "
        f"one next to the printed start is {max(abs(near.dx), abs(near.dv)):.2g} away, {how}."
    )
    return Evidence(verdict(held and not changed, held), finding, numbers)


def _exactly(figure: Graze, t_m: Fraction, numbers: dict[str, str]) -> bool:
    """Tell whether the flow from the start that belongs to t_m grazes, with 40 digits and in another closed form."""
    scene, at = figure.scene, place(figure.mapping)
    p = scene.parameters
    found = grazing_start(p, figure.mapping, t_m=t_m, t0=scene.t0)
    start: dict[str, Any] = {name: Fraction(found.start[name]) for name in ("x0", "v0")}
    path = motion(replace(scene, **start, start_error=found.start["start_error"]))
    x, v = flow(p, p.A(at.domain), (scene.t0, *start.values()), float(t_m))
    x_m = (float(p.A(at.domain)) + float(p.B0) * cos(float(p.Omega * t_m)) - float(p.c) * float(v)) / float(p.k)
    gap = abs(float(v) - float(p.belt(at.boundary))) + abs(float(x) - x_m)
    numbers["x₀, ẋ₀ of a start that grazes"] = f"{found.start['x0'][:22]}, {found.start['v0'][:22]}"
    numbers["contacts from it"] = contacts_text(path)
    numbers["|ẋ − v_λ| + |x − xₘ| at the contact, in another closed form"] = f"{gap:.1g}"
    inside = all(abs(value - getattr(scene, name)) <= LAST_HALF_UNIT for name, value in start.items())
    return inside and path.events[0].kind == "graze" and gap < 1e-9
