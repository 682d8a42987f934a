"""What Theorem 7 and its proof say of the contact itself: eqs. (59) to (66), gamma, and the unknowns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

from symosc.grazing.start import grazing_start
from symosc.grazing.window import grazing_window
from symosc.mappings.equations import jacobian
from symosc.mappings.theorem7_cases import PLACES
from symosc.model import Parameters
from symosc.paper.checks.printed_cases import RATIOS, contains, printed_window, touching, turn
from symosc.paper.checks.rational_cases import PHASES
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, UNDECIDED, Evidence
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

#: Every contact in these scenes is looked at.
SCENES = ("fig5", "fig6", "fig8", "fig9", "fig10")
#: Grazes at these phases, of the oscillators of these figures, are traced back.
TRACED = {"fig5": ("P2", "P3", "P5", "P6"), "fig8": ("P3", "P5"), "fig10": ("P5", "P6")}
TRACED_PHASES = (0.3, 1.3, 2.3, 3.3, 4.4, 5.5)


# --- what the paper prints ---


def gamma_of(p: Parameters, acceleration: Fraction, velocity: Fraction) -> Fraction:
    """Theorem 7: gamma = (c/m) x'' + (k/m) x'."""
    return p.c / p.m * acceleration + p.k / p.m * velocity


def slope_at_contact(p: Parameters, acceleration: Fraction, velocity: Fraction, sine: Fraction) -> Fraction:
    """Eqs. (62), (66): the left side, which has to be < 0 from below and > 0 from above."""
    return -p.c / p.m * acceleration - p.k / p.m * velocity - p.B0 * p.Omega / p.m * sine


# --- checks ---


def _arrivals() -> Iterator[tuple[Parameters, str, Event, Any]]:
    """Yield (p, mapping, event, acceleration) for every contact at which a flight arrives."""
    for name in SCENES:
        motion = simulate(load_scene(name), max_events=100)
        for event in motion.events:
            if event.source.startswith("Omega"):
                domain = int(event.source[-1])
                mapping = next(
                    key for key, at in PLACES.items() if (at.domain, at.boundary) == (domain, event.boundary)
                )
                yield motion.parameters, mapping, event, motion.force(domain, event.t)


def without_force() -> Evidence:
    """The iff of Theorem 7 as it stands: "the flow reaches x_m" does not say F = 0, and gamma has x'' in it."""
    arrivals = inside = grazes = 0
    shown: dict[str, str] = {}
    for p, mapping, event, acceleration in _arrivals():
        gamma = float(p.c) / float(p.m) * float(acceleration) + float(p.k) / float(p.m) * float(event.v)
        amplitude = float(p.B0 * p.Omega / p.m)
        where = turn(np.sin(float(event.theta)), np.cos(float(event.theta)))
        says = any(contains(arcs, where) for _, arcs in printed_window(mapping, gamma, amplitude))
        arrivals += 1
        grazes += event.kind == "graze"
        if says and event.kind != "graze":
            inside += 1
            shown = shown or {
                "a case": f"{mapping}, Ωt mod 2π = {float(event.theta):.6g}, γ = {gamma:.6g}, "
                f"B₀Ω/m = {amplitude:.6g}, F = {float(acceleration):.6g}",
                "what happens there": f"{event.kind}, {event.source} -> {event.target}",
            }
    numbers = {
        "arrivals at a belt in Figs. 5, 6, 8, 9, 10": str(arrivals),
        "of them grazes": str(grazes),
        "phase in the printed window, no graze": str(inside),
    } | shown
    finding = f"Of {arrivals} arrivals at a belt {inside} are in the printed window and do not graze, since F is not 0"
    return Evidence(NOT_AS_PRINTED if inside else CONFIRMED, f"{finding}.", numbers)


def grazing_inequality() -> Evidence:
    """Eqs. (61), (62), (65), (66) and gamma: the inequality, and that it is the sign of gamma + (B0 Omega/m) sin."""
    total = wrong = differs = 0
    for mapping, where in PLACES.items():
        for ratio in RATIOS:
            for s, c in PHASES:
                contact = touching(mapping, ratio * 3, Fraction(3), s, c)
                p, force = contact.p, contact.force(where.domain)
                slope = slope_at_contact(p, force, contact.speed, s)
                total += 1
                wrong += slope != contact.derivatives(where.domain)[1] or force != 0
                differs += slope != -(gamma_of(p, force, contact.speed) + p.B0 * p.Omega / p.m * s)
    numbers = {
        "exact contacts": str(total),
        "F not 0, or (62)/(66) not the derivative of F along the flow": str(wrong),
        "not -(γ + (B₀Ω/m) sin(Ωtₘ))": str(differs),
    }
    finding = f"At all {total} exact contacts (62) and (66) are dF/dt and -(γ + (B₀Ω/m) sin(Ωtₘ))"
    right = not wrong and not differs
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}." if right else "They are not.", numbers)


def gamma_is_fixed() -> Evidence:
    """gamma_j = (c/m) x'' + (k/m) x': its value at grazes of simulated motions, which the paper leaves open."""
    numbers, worst, events = {}, 0.0, 0
    for name, mapping, theta in (
        ("fig7-exact", "P2", None),
        ("fig8-exact", "P3", None),
        ("fig9", "P2", 0.5),
        ("fig9", "P2", 1.5),
        ("fig9", "P2", 2.5),
    ):
        scene = load_scene(name)
        p, where = scene.parameters, PLACES[mapping]
        if theta is None:
            motion = simulate(scene, max_events=1)
        else:
            start = grazing_start(p, mapping, theta)
            end = Fraction(float(start.t_m)) + Fraction(1, 100)
            motion = simulate(p, **start.start, t_end=end, max_events=1)
        graze = next(event for event in motion.events if event.kind == "graze")
        acceleration = float(motion.force(where.domain, graze.t))
        gamma = float(gamma_of(p, Fraction(acceleration), Fraction(float(graze.v))))
        worst = max(worst, abs(gamma - float(p.k * p.belt(where.boundary) / p.m)))
        events += 1
        fixed = f"{gamma:.10g}, k v/m = {float(p.k * p.belt(where.boundary) / p.m):g}"
        numbers[f"γ at the graze of {mapping} of {name} at Ωt mod 2π = {float(graze.theta):.6g}"] = fixed
    numbers["largest |γ − k v/m|"] = f"{worst:.2g}"
    finding = f"At all {events} grazes γ = k v_λ/m, to {worst:.1g}: the parameters alone choose the case"
    if worst < 1e-9:
        return Evidence(CORRECTED, f"{finding}.", numbers)
    return Evidence(CONFIRMED, "γ has other values than k v_λ/m.", numbers)


def one_unknown_is_free() -> Evidence:
    """After (62): three equations for four unknowns, so that one must be given."""
    p, mapping = load_scene("fig9").parameters, "P2"
    where = PLACES[mapping]
    ranks, starts, numbers = [], [], {}
    for theta in (0.5, 1.5, 2.5):
        start = grazing_start(p, mapping, theta)
        if not start.found:
            continue
        begin, end = (start.x, float(p.Omega) * start.t), (start.x_m, float(p.Omega) * start.t_m)
        gradient = [0, 0, -float(p.k / p.m), -float(p.B0 / p.m) * np.sin(start.theta_m)]
        matrix = np.vstack([jacobian(p, mapping, tuple(map(float, begin)), tuple(map(float, end))), gradient])
        values = np.linalg.svd(matrix.astype(float), compute_uv=False)
        ranks.append(int((values > 1e-9 * values[0]).sum()))
        starts.append((float(start.x), float(start.theta)))
        numbers[f"graze of P₂ at Ωtₘ = {theta}"] = f"starts at x = {start.x:.8g}, Ωt = {start.theta:.8g}"
        numbers[f"singular values at {theta}"] = ", ".join(f"{value:.3g}" for value in values)
    if not ranks:
        return Evidence(UNDECIDED, "No graze of P₂ was found.", {"grazes of P₂": "0"})
    numbers["equations, unknowns"] = "3 (f₁, f₂, F), 4"
    numbers["rank"] = ", ".join(map(str, ranks))
    free = set(ranks) == {3} and len(set(starts)) == len(starts) and where.boundary == 1
    finding = f"The three equations have rank {min(ranks)} at {len(ranks)} grazes of Fig. 9's oscillator"
    return Evidence(CONFIRMED if free else NOT_AS_PRINTED, f"{finding}; each given phase has its start.", numbers)


def mappings_that_graze() -> Evidence:
    """Theorem 7: is the mapping that ends with a graze P2, P3, P5 or P6? Grazes are traced back, and followed again."""
    counts: dict[str, Counter[str]] = {mapping: Counter() for mapping in PLACES}
    case = "none"
    for name, mappings in TRACED.items():
        p = load_scene(name).parameters
        for mapping in mappings:
            window = grazing_window(p, mapping)
            for theta in filter(window.contains, TRACED_PHASES):
                start = grazing_start(p, mapping, theta)
                end = Fraction(float(start.t_m)) + Fraction(1, 1000)
                motion = simulate(p, **start.start, t_end=end, max_events=1)
                label = motion.word[0] if motion.events[0].kind == "graze" else "no graze"
                counts[mapping][label] += 1
                if case == "none" and label not in (mapping, "no graze"):
                    begin = f"x = {float(start.x):.10g}, Ωt = {float(start.theta):.10g} on belt {start.boundary}"
                    case = f"{name}: {label} from {begin} grazes belt {PLACES[mapping].boundary} at Ωt = {theta}"
    numbers = {}
    for mapping, found in counts.items():
        labels = ", ".join(f"{label} {count}" for label, count in sorted(found.items()))
        numbers[f"grazes that the paper calls {mapping}, by the mapping that ends there"] = labels
    numbers["a graze by another mapping"] = case
    total = sum(found.total() for found in counts.values())
    other = total - sum(found[mapping] for mapping, found in counts.items())
    lost = sum(found["no graze"] for found in counts.values())
    if lost or not all(counts.values()):
        return Evidence(UNDECIDED, f"{lost} of {total} grazes could not be followed.", numbers)
    finding = f"{total - other} of {total} grazes end the mapping that the paper names"
    if other:
        finding += f"; the other {other}, in domain 2, come from the other belt: P₇ and P₈ can end with a graze"
    return Evidence(NOT_AS_PRINTED if other else CONFIRMED, f"{finding}.", numbers)
