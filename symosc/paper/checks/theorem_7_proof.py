"""What Theorem 7 and its proof say of the contact itself: eqs. (59) to (66), gamma, and the unknowns."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import numpy as np

from symosc.grazing.start import grazing_start
from symosc.grazing.window import grazing_window
from symosc.mappings.equations import jacobian
from symosc.mappings.theorem7_cases import PLACES
from symosc.model import Parameters
from symosc.paper.checks.contacts import looked_at
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.printed_cases import RATIOS, contains, printed_window, touching, turn
from symosc.paper.checks.rational_cases import RATIONAL_PHASES, as_text, contacts
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, UNDECIDED, Evidence
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate

#: Contacts of each mapping's boundary that are looked through for arrivals.
ARRIVALS = 60
#: The mappings that can end where a flow grazes: the named one, and the one from the other belt.
ENDS = {"P2": ("P2",), "P3": ("P3", "P7"), "P5": ("P5", "P8"), "P6": ("P6",)}
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


def without_force() -> Evidence:
    """The iff of Theorem 7 as it stands: "the flow reaches x_m" does not say F = 0, and gamma has x'' in it."""
    arrivals = inside = 0
    shown: dict[str, str] = {}
    for mapping, where in PLACES.items():
        for contact in contacts(where.boundary, ARRIVALS, seed=70 + where.equation):
            p, force = contact.p, contact.force(where.domain)
            # The flow of the domain reaches the boundary, and with F not 0 it goes straight through.
            if force * where.side <= 0 or p.B0 <= 0:
                continue
            gamma, amplitude = gamma_of(p, force, contact.speed), p.B0 * p.Omega / p.m
            says = printed_window(mapping, gamma, amplitude)
            arrivals += 1
            if any(contains(arcs, turn(contact.s, contact.c)) for _, arcs in says):
                if contact.grazes(where.domain):
                    raise ArithmeticError("a flow with F not 0 grazes")
                inside += 1
                shown = shown or {
                    "one of them": f"{mapping}, ({where.equation}.{says[0][0]}); {as_text(contact)}",
                    "γ, B₀Ω/m, F there": f"{gamma}, {amplitude}, {force}",
                    "what the exact flow does there": f"goes on {'on' if contact.sticks else 'in'} {contact.next_mode}",
                }
    numbers = {
        "exact contacts that a flow reaches with F not 0": str(arrivals),
        "of them with the phase in the printed set": str(inside),
        "of these grazes": "0",
    } | shown
    finding = "With F not 0 the flow of a domain goes straight through the boundary and cannot graze, but its phase "
    finding += "can be in the printed set, as at the exact contact given here"
    return Evidence(CORRECTED if inside else CONFIRMED, f"{finding}.", numbers)


def grazing_inequality() -> Evidence:
    """Eqs. (61), (62), (65), (66) and gamma: the inequality, and that it is the sign of gamma + (B0 Omega/m) sin."""
    total = wrong = differs = 0
    for mapping, where in PLACES.items():
        for ratio in RATIOS:
            for s, c in RATIONAL_PHASES:
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
    """gamma_j = (c/m) x'' + (k/m) x' tells the cases apart: what it is at a graze, where x'' = 0."""
    total = other = 0
    for mapping, where in PLACES.items():
        for ratio in RATIOS:
            for s, c in RATIONAL_PHASES:
                contact = touching(mapping, ratio * 3, Fraction(3), s, c)
                if contact.grazes(where.domain):
                    p = contact.p
                    gamma = gamma_of(p, contact.force(where.domain), contact.speed)
                    total, other = total + 1, other + (gamma != p.k * contact.speed / p.m)
    numbers = {"exact grazes": str(total), "γ not k v_λ/m": str(other)}
    if other:
        return Evidence(NOT_AS_PRINTED, f"γ has other values than k v_λ/m at {other} of {total} exact grazes.", numbers)
    finding = f"At all {total} exact grazes ẍ = 0 and γ = k v_λ/m: the parameters alone choose the case"
    return Evidence(CONFIRMED, f"{finding}.", numbers)


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


@flown_again
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
                motion = looked_at(simulate(p, **start.start, t_end=end, max_events=1))
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
    strange = sum(found[label] for mapping, found in counts.items() for label in found if label not in ENDS[mapping])
    finding = "Flowing back from a graze, the flow comes from the planes of the mapping that the paper names"
    if other:
        finding += "; in domain 2 also from the other belt, by P₇ or P₈, whose end is the graze then"
    return Evidence(NOT_AS_PRINTED if strange else CONFIRMED, f"{finding}.", numbers)
