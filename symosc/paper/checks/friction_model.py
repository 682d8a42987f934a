"""Sections 2 and 3: the friction law, the equations of motion, the stick conditions, domains and boundaries."""

from __future__ import annotations

import random
from fractions import Fraction
from math import pi, sqrt

import numpy as np

from symosc.model import MODE_NAMES, SIDES, Parameters
from symosc.paper.checks import dop853
from symosc.paper.checks.rational_cases import RationalContact, contacts, friction_on_mass
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, Evidence
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

CASES = 240
#: Scenes of the paper whose motions have every state between them.
SCENES = ("fig5", "fig6", "fig8", "fig9", "fig10")
#: Rounding errors of sticks, relative.
FRICTION_TOLERANCE = 1e-12


# --- what the paper prints ---


def friction_force(p: Parameters, alpha: int) -> Fraction:
    """Eq. (1) inside a domain: the force F_f that friction opposes to the motion."""
    return {1: -(p.mu1 + p.mu2), 2: p.mu1 - p.mu2, 3: p.mu1 + p.mu2}[alpha] * p.FN


def friction_interval(p: Parameters, boundary: int) -> tuple[Fraction, Fraction]:
    """Eq. (1) at the speed of a belt: the interval in which F_f lies."""
    middle = (p.mu1 - p.mu2) * p.FN
    outer = (p.mu1 + p.mu2) * p.FN
    return (-outer, middle) if boundary == 1 else (middle, outer)


def added_force(p: Parameters, alpha: int) -> Fraction:
    """Eq. (5): what stands beside A0 on the right."""
    return {1: p.mu1 + p.mu2, 2: -(p.mu1 - p.mu2), 3: -(p.mu1 + p.mu2)}[alpha] * p.FN


def vector_field(p: Parameters, alpha: int, x: Fraction, v: Fraction, cosine: Fraction) -> Fraction:
    """Eq. (9)."""
    rest = {1: p.A0 + (p.mu1 + p.mu2) * p.FN, 2: p.A0 - (p.mu1 - p.mu2) * p.FN, 3: p.A0 - (p.mu1 + p.mu2) * p.FN}
    return -p.c / p.m * v - p.k / p.m * x + p.B0 / p.m * cosine + rest[alpha] / p.m


def stick_force(p: Parameters, boundary: int, x: Fraction, cosine: Fraction) -> Fraction:
    """Eq. (2), and its counterpart on belt 2: all forces but the friction of that belt."""
    other = p.mu2 * p.FN if boundary == 1 else -p.mu1 * p.FN
    return p.A0 + p.B0 * cosine - p.k * x - p.c * p.belt(boundary) + other


def domain_of(p: Parameters, v: Fraction) -> list[int]:
    """Eqs. (6) and (7): the open domains (1, 2, 3) and the boundaries (12, 23) that a velocity is in."""
    inside = {1: v < p.v1, 2: p.v1 < v < p.v2, 3: v > p.v2, 12: v == p.v1, 23: v == p.v2}
    return [name for name, yes in inside.items() if yes]


# --- checks ---


def _parameter_sets() -> list[Parameters]:
    return [contact.p for contact in contacts(1, CASES, seed=3)]


def friction_levels() -> Evidence:
    """Eq. (1) inside the domains, against Coulomb's law of both belts and eq. (5)."""
    wrong_coulomb = wrong_motion = total = 0
    for p in _parameter_sets():
        for alpha in (1, 2, 3):
            total += 1
            wrong_coulomb += -friction_force(p, alpha) != friction_on_mass(p, alpha)
            wrong_motion += p.A(alpha) - p.A0 != -friction_force(p, alpha)
    p = load_scene("fig5").parameters
    numbers = {
        "rational parameter sets and domains": str(total),
        "F_f not the sum of both belts' Coulomb friction": str(wrong_coulomb),
        "A_α − A₀ not -F_f": str(wrong_motion),
        "levels of Fig. 5": ", ".join(f"{float(friction_force(p, alpha)):g}" for alpha in (1, 2, 3)),
    }
    right = wrong_coulomb == wrong_motion == 0
    finding = "F_f is the friction of both belts as a resistance: it stands with a minus on the right of (5)"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}; {total} exact cases.", numbers)


def friction_at_the_jumps() -> Evidence:
    """Eq. (1) at x' = v1 and v2: its intervals, and the single values whose closed intervals end there too."""
    instants = outside = at_an_end = 0
    share = 1.0
    for motion in _motions():
        p = motion.parameters
        for segment in motion.segments:
            if not segment.mode.startswith("belt"):
                continue
            boundary = int(segment.mode[-1])
            low, high = (float(end) for end in friction_interval(p, boundary))
            for t in np.linspace(float(segment.t_start), float(segment.t_end), 23)[1:-1]:
                x, v = motion(t)
                held = float(p.A0) + float(p.B0) * np.cos(float(p.Omega) * t) - float(p.k) * x - float(p.c) * v
                instants += 1
                outside += not low <= held <= high
                at_an_end += held in (low, high)
                share = min(share, min(held - low, high - held) / (high - low))
    numbers = {
        "instants inside sticks that were looked at": str(instants),
        "friction force outside the interval of (1)": str(outside),
        "friction force equal to a single value of (1)": str(at_an_end),
        "smallest distance from an end of the interval": f"{share:.3g} of its length",
    }
    if outside or not instants:
        return Evidence(NOT_AS_PRINTED, f"Outside the interval at {outside} of {instants} instants.", numbers)
    finding = f"The interval holds at all {instants} instants of sticks, the single values that (1) gives for ẋ in "
    finding += f"[v₂, ∞), [v₁, v₂] and (-∞, v₁] hold at {at_an_end} of them: these intervals have to be open."
    return Evidence(CONFIRMED if at_an_end == instants else CORRECTED, finding, numbers)


def _motions() -> list[Trajectory]:
    return [simulate(load_scene(name), max_events=40) for name in SCENES]


def equations_of_motion() -> Evidence:
    """Eq. (5), integrated by scipy's DOP853 over flights in each domain, against the exact motion."""
    worst: dict[int, float] = {}
    flights: dict[int, int] = {}
    for motion in _motions():
        p = motion.parameters
        for segment in motion.segments[:8]:
            if not segment.mode.startswith("Omega"):
                continue
            alpha = int(segment.mode[-1])
            span = float(segment.t_start), float(segment.t_end)
            t, states = dop853.flight(p, p.A0 + added_force(p, alpha), span, motion(span[0]))
            error = np.abs(states - motion(np.minimum(t, span[1]))).max() / max(1.0, np.abs(states).max())
            worst[alpha] = max(worst.get(alpha, 0.0), float(error))
            flights[alpha] = flights.get(alpha, 0) + 1
    numbers = {f"flights in Ω{alpha}": str(flights[alpha]) for alpha in sorted(flights)}
    numbers |= {f"largest relative difference in Ω{alpha}": f"{worst[alpha]:.2g}" for alpha in sorted(worst)}
    right = set(worst) == {1, 2, 3} and max(worst.values()) < dop853.DOP853_AGREEMENT
    finding = f"Flights by (5) as printed differ from the exact motion by {max(worst.values()):.1g} at most"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}, in all three domains.", numbers)


def stick_condition() -> Evidence:
    """Eq. (2) with |F_s1| <= mu1 FN, its counterpart on belt 2, and Theorem 4."""
    total = differs = equal = stays = leaves = wrong_strict = 0
    for boundary in (1, 2):
        lo, hi = SIDES[boundary]
        for contact in contacts(boundary, CASES, seed=10 + boundary):
            p = contact.p
            held = (p.mu1 if boundary == 1 else p.mu2) * p.FN
            force = stick_force(p, boundary, contact.x, contact.c)
            total += 1
            differs += (abs(force) <= held) != (contact.force(lo) >= 0 >= contact.force(hi))
            if abs(force) == held:
                equal += 1
                stays += contact.sticks
                leaves += not contact.sticks
            else:
                wrong_strict += (abs(force) < held) != contact.sticks
    numbers = {
        "rational contacts with both belts": str(total),
        "|Fₛ| ≤ μ FN not the same as F⁽ˡᵒ⁾ ≥ 0 ≥ F⁽ʰⁱ⁾": str(differs),
        "|Fₛ| not μ FN, and the exact flow does otherwise": str(wrong_strict),
        "|Fₛ| = μ FN": str(equal),
        "of them the mass stays on the belt": str(stays),
        "of them it leaves at once": str(leaves),
    }
    if differs or wrong_strict:
        return Evidence(NOT_AS_PRINTED, f"Wrong at {differs + wrong_strict} of {total} contacts.", numbers)
    finding = f"|Fₛ| ≤ μ FN is F⁽ˡᵒ⁾ ≥ 0 ≥ F⁽ʰⁱ⁾, exactly; right at all {total - equal} contacts without equality. "
    finding += f"At |Fₛ| = μ FN the mass leaves at once in {leaves} of {equal} cases; Theorem 4 has < there."
    return Evidence(CORRECTED if leaves else CONFIRMED, finding, numbers)


def stick_motion() -> Evidence:
    """Eqs. (3), (4), (11), (12): x' = v_lambda and x'' = 0 while the mass sticks."""
    sticks, speed, place = {1: 0, 2: 0}, 0.0, 0.0
    for motion in _motions():
        for segment in motion.segments:
            if segment.mode.startswith("belt"):
                boundary = int(segment.mode[-1])
                sticks[boundary] += 1
                t = np.linspace(float(segment.t_start), float(segment.t_end), 21)[:-1]
                x, v = motion(t)
                belt = float(motion.parameters.belt(boundary))
                size = max(1.0, float(np.abs(x).max()))
                speed = max(speed, float(np.abs(v - belt).max()) / max(1.0, abs(belt)))
                place = max(place, float(np.abs(x - x[0] - belt * (t - t[0])).max()) / size)
    numbers = {
        "sticks on belt 1": str(sticks[1]),
        "sticks on belt 2": str(sticks[2]),
        "largest |ẋ − v_λ|, relative": f"{speed:.2g}",
        "largest |x − xᵢ − v_λ (t − tᵢ)|, relative": f"{place:.2g}",
    }
    right = min(sticks.values()) > 0 and max(speed, place) < FRICTION_TOLERANCE
    finding = f"On {sticks[1]} + {sticks[2]} sticks ẋ differs from the belt's speed by {speed:.1g} at most"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def mirrored(p: Parameters) -> Parameters:
    """Return the oscillator seen in a mirror, x -> -x: the belts change places, and so do mu1 and mu2."""
    return p.replace(A0=-p.A0, B0=-p.B0, v1=-p.v2, v2=-p.v1, mu1=p.mu2, mu2=p.mu1)


def friction_order() -> Evidence:
    """The assumption mu1 >= mu2: is it needed? A mirror turns every motion into one with mu1 and mu2 exchanged."""
    worst, events, other = 0.0, 0, 0
    for name in SCENES:
        scene = load_scene(name)
        p = scene.parameters
        given = simulate(scene, max_events=12)
        seen = simulate(mirrored(p), t0=scene.t0, x0=-scene.x0, v0=-scene.v0, t_end=scene.t_end, max_events=12)
        kinds = [(event.kind, 3 - event.boundary) for event in seen.events]
        other += kinds != [(event.kind, event.boundary) for event in given.events]
        gaps = [abs(a.t - b.t) + abs(a.x + b.x) for a, b in zip(given.events, seen.events, strict=False)]
        worst, events = max([worst, *gaps]), events + len(gaps)
    cases = [contact for boundary in (1, 2) for contact in contacts(boundary, CASES, seed=20) if _is_strict(contact)]
    reversed_ = [contact for contact in cases if contact.p.mu1 < contact.p.mu2]
    wrong = sum((contact.force(contact.boundary) > 0 > contact.force(contact.boundary + 1)) != contact.sticks
                for contact in reversed_)  # fmt: skip
    numbers = {
        "events of Figs. 5, 6, 8, 9, 10 compared with their mirror image": str(events),
        "figures whose mirror image has other events": str(other),
        "largest difference of t and x": f"{worst:.2g}",
        "rational contacts with μ₁ < μ₂": str(len(reversed_)),
        "of them Theorem 4 wrong": str(wrong),
    }
    needless = not other and not wrong and worst < 1e-9 and bool(reversed_)
    finding = f"Nothing needs μ₁ ≥ μ₂: Theorem 4 holds at all {len(reversed_)} contacts with μ₁ < μ₂, and the "
    finding += f"motions with μ₁ and μ₂ exchanged differ from the mirror images by {worst:.1g}."
    return Evidence(CORRECTED if needless else CONFIRMED, finding if needless else "It is needed.", numbers)


def _is_strict(contact: RationalContact) -> bool:
    return contact.force(contact.boundary) * contact.force(contact.boundary + 1) != 0


def friction_characteristics() -> Evidence:
    """Section 2: both belts possess the same friction characteristics; and the coefficients of the figures."""
    equal, numbers = 0, {}
    figures = ("fig5", "fig6", "fig7", "fig8", "fig9", "fig10")
    for name in figures:
        p = load_scene(name).parameters
        equal += p.mu1 == p.mu2
        jumps = ", ".join(f"{float(high - low):g}" for low, high in (friction_interval(p, belt) for belt in (1, 2)))
        numbers[f"{name}: μ₁, μ₂; jumps of the friction force"] = f"{float(p.mu1):g}, {float(p.mu2):g}; {jumps}"
    numbers["figures with μ₁ = μ₂"] = f"{equal} of {len(figures)}"
    finding = f"μ₁ = μ₂ in {equal} of {len(figures)} figures: the belts share the law, not the coefficient"
    if equal == len(figures):
        return Evidence(CONFIRMED, "μ₁ = μ₂ in all figures.", numbers)
    return Evidence(CORRECTED, f"{finding}.", numbers)


def frequency() -> Evidence:
    """Section 2 calls Omega a frequency ratio: with which meaning does Fig. 8's printed start reach belt 1?"""
    scene = load_scene("fig8")
    p, found = scene.parameters, {}
    ratio = p.replace(Omega=p.Omega * Fraction(sqrt(p.k / p.m)).limit_denominator(10**6))
    for words, meaning in (("angular frequency", p), ("ratio", ratio)):
        motion = simulate(meaning, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, max_events=1)
        event = motion.events[0]
        force = float(motion.force(2, event.t))
        found[words] = (float(event.t), abs(force))
    numbers = {"√(k/m) of Fig. 8": f"{sqrt(p.k / p.m):g}"}
    for words, (t, force) in found.items():
        numbers[f"Ω = 2 as {words}: first contact at t"] = f"{t:.10g}"
        numbers[f"Ω = 2 as {words}: |F⁽²⁾| there (0 is a graze)"] = f"{force:.2g}"
    as_frequency = (
        found["angular frequency"][1] < 0.05 < found["ratio"][1] and abs(found["angular frequency"][0] - pi) < 0.01
    )
    finding = "Fig. 8 grazes (to its printed digits) only if Ω is the angular frequency of the drive in time t"
    if as_frequency:
        return Evidence(CORRECTED, f"{finding}; it is no ratio, nothing is made dimensionless.", numbers)
    return Evidence(CONFIRMED, "As a ratio it gives Fig. 8.", numbers)


def motion_states() -> Evidence:
    """Section 3: five motion states."""
    counts: dict[str, int] = {}
    for motion in _motions():
        for segment in motion.segments:
            counts[segment.mode] = counts.get(segment.mode, 0) + 1
    p = load_scene("fig10").parameters.replace(mu2=0)
    scene = load_scene("fig10")
    without = simulate(p, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, max_events=60)
    numbers = {}
    for mode in MODE_NAMES.values():
        numbers[f"stretches {'on' if mode.startswith('belt') else 'in'} {mode}"] = str(counts.get(mode, 0))
    numbers["sticks on belt 2 of Fig. 10 without friction there"] = str(without.word.count("P4"))
    right = set(counts) == set(MODE_NAMES.values()) and len(counts) == 5
    finding = f"{len(counts)} states occur in the motions of the paper's figures: three domains and two belts"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def domains_and_boundaries() -> Evidence:
    """Eqs. (6) and (7): every state is in exactly one domain or on one boundary."""
    draw = random.Random(6)
    total = wrong = on_boundary = 0
    for p in _parameter_sets():
        middle = (p.v1 + p.v2) / 2
        for v in (p.v1, p.v2, middle, middle + Fraction(draw.randint(-40, 40), 4), p.v1 - 1, p.v2 + 1):
            places = domain_of(p, v)
            total += 1
            wrong += len(places) != 1
            on_boundary += places in ([12], [23])
    numbers = {"velocities": str(total), "on a boundary": str(on_boundary), "in none or several places": str(wrong)}
    finding = f"{wrong} of {total} velocities are in no domain or boundary, or in several"
    return Evidence(NOT_AS_PRINTED if wrong else CONFIRMED, f"{finding}.", numbers)


def vector_fields() -> Evidence:
    """Eqs. (8) to (10): the field (9) is (5) divided by the mass, and jumps by 2 mu FN/m."""
    wrong = jumps = total = 0
    for boundary in (1, 2):
        for contact in contacts(boundary, CASES, seed=30 + boundary):
            p, lo, hi = contact.p, *SIDES[boundary]
            for alpha in (lo, hi):
                total += 1
                wrong += vector_field(p, alpha, contact.x, contact.speed, contact.c) != contact.force(alpha)
            below, above = (vector_field(p, a, contact.x, contact.speed, contact.c) for a in (lo, hi))
            jumps += below - above != 2 * (p.mu1 if boundary == 1 else p.mu2) * p.FN / p.m
    numbers = {
        "rational states and domains": str(total),
        "(9) not Newton's law with Coulomb's friction": str(wrong),
        "jumps that are not 2 μ FN/m": str(jumps),
    }
    finding = f"(9) agrees with Newton's law and Coulomb's friction in {total - wrong} of {total} exact cases"
    return Evidence(NOT_AS_PRINTED if wrong or jumps else CONFIRMED, f"{finding}.", numbers)
