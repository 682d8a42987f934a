"""Checks of what Section 6 says about all figures: their parameters, and the force product at sticks."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from symosc.model import NEIGHBOURS
from symosc.paper.checks.contacts import forces, is_zero, sticks, text, verdict
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.friction_model import added_force, vector_field
from symosc.paper.checks.theorems import exact_contacts
from symosc.paper.evidence import UNDECIDED, Evidence
from symosc.scenes import Scene, load_scene

PRINTED = ("fig5", "fig6", "fig7", "fig8", "fig9", "fig10")
#: Acceleration of gravity that the captions list among the parameters.
G = Fraction("9.81")
#: The figures with sticks, and how far they are followed here.
FOLLOWED = {"fig5": 40, "fig6": 20, "fig8": 9, "fig10": 15}


def parameters() -> Evidence:
    """Check v1 < v2 and mu1 >= mu2, and positive m, FN, B0 and Omega, in all figures."""
    return hypotheses([load_scene(name) for name in PRINTED])


def hypotheses(scenes: Sequence[Scene]) -> Evidence:
    """Check what Section 2 and Theorem 7 assume of the parameters, in rational numbers."""
    numbers, held = {}, True
    for scene in scenes:
        p = scene.parameters
        held = held and p.v1 < p.v2 and p.mu1 >= p.mu2 and min(p.m, p.FN, p.B0, p.Omega) > 0
        numbers[f"{_figure(scene)}: v₂ − v₁, μ₁ − μ₂"] = f"{text(p.v2 - p.v1)}, {text(p.mu1 - p.mu2)}"
    how = "holds" if held else "does not hold"
    finding = f"v₁ < v₂, μ₁ ≥ μ₂ and B₀ > 0, decided in rational numbers, {how} in all {len(scenes)} figures."
    return Evidence(verdict(held), finding, numbers)


def gravity() -> Evidence:
    """Check what g = 9.81, which all captions list and no equation contains, has to do with FN."""
    return weight([load_scene(name) for name in PRINTED])


def weight(scenes: Sequence[Scene]) -> Evidence:
    """Compare FN with the weight m g in rational numbers."""
    weights = {_figure(scene): (scene.parameters.FN, scene.parameters.m * G) for scene in scenes}
    equal = [name for name, (force, own) in weights.items() if force == own]
    others = [name for name in weights if name not in equal]
    numbers = {f"{name}: F_N, m g": f"{text(force)}, {text(own)}" for name, (force, own) in weights.items()}
    finding = f"No equation contains g. F_N = m g in {', '.join(equal) or 'no figure'}"
    if others:
        ratios = ", ".join(text(float(weights[name][0] / weights[name][1]), 4) for name in others)
        finding += f"; in {', '.join(others)} F_N is {ratios} times the weight"
    return Evidence(verdict(bool(equal)), finding + ".", numbers)


def forces_or_accelerations() -> Evidence:
    """Check what the quantities F are that Section 6 shows as forces: m F is the right side of (5), exactly."""
    total = wrong = 0
    for boundary in (1, 2):
        for contact in exact_contacts(boundary):
            p = contact.p
            for alpha in NEIGHBOURS[boundary]:
                field = vector_field(p, alpha, contact.x, contact.speed, contact.c)
                force = p.A0 + added_force(p, alpha) + p.B0 * contact.c - p.k * contact.x - p.c * contact.speed
                total, wrong = total + 1, wrong + (p.m * field != force)
    masses = {_figure(scene): scene.parameters.m for scene in map(load_scene, PRINTED)}
    apart = [name for name, mass in masses.items() if mass != 1]
    numbers = {"exact contacts and domains": str(total), "m F of (9) not the right side of (5)": str(wrong)}
    numbers |= {f"{name}: m": text(mass) for name, mass in masses.items()}
    finding = f"m F⁽ᵅ⁾ is the force, F⁽ᵅ⁾ the acceleration; the two differ in {', '.join(apart) or 'no figure'}"
    return Evidence(verdict(not apart and not wrong, not wrong), finding + ".", numbers)


@flown_again
def products() -> Evidence:
    """Check the sign of the force product at all starting and vanishing points of sticks."""
    return force_products([load_scene(name) for name in FOLLOWED])


def force_products(scenes: Sequence[Scene]) -> Evidence:
    """Check F F < 0 where sticks start, and that F F = 0 where they vanish, for every stick of the scenes."""
    numbers, held, count = {}, True, 0
    for scene in scenes:
        p = scene.parameters
        found = [(s.onset, s.end) for s in sticks(scene, FOLLOWED.get(scene.name)) if s.end is not None]
        if not found:
            continue
        starts = [forces(p, onset).product for onset, _ in found]
        ends = [forces(p, end) for _, end in found]
        held = held and max(starts) < 0 and all(is_zero(end.below) != is_zero(end.above) for end in ends)
        count += len(found)
        least = max(min(abs(end.below), abs(end.above)) for end in ends)
        numbers[f"{_figure(scene)}: sticks"] = str(len(found))
        numbers[f"{_figure(scene)}: product where they start"] = f"{text(min(starts), 8)} to {text(max(starts), 8)}"
        numbers[f"{_figure(scene)}: the force that vanishes where they end"] = f"at most {text(least, 2)}"
    if not count:
        return Evidence(UNDECIDED, "There is no stick.", {"sticks": "0"})
    finding = (
        f"{'All' if held else 'Not all'} {count} sticks start with a negative product and end with exactly one force 0."
    )
    return Evidence(verdict(bool(held)), finding, numbers)


def _figure(scene: Scene) -> str:
    return f"Fig. {scene.name.removeprefix('fig')}"
