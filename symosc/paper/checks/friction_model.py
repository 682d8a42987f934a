"""Sections 2 and 3: the friction law, the equations of motion, the stick conditions, domains and boundaries."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np

from symosc.model import NEIGHBOURS, Parameters
from symosc.paper.checks import dop853
from symosc.paper.checks.contacts import looked_at
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.rational_cases import RationalContact, contacts, friction_on_mass
from symosc.paper.evidence import CONFIRMED, CORRECTED, DEFINITION, NOT_AS_PRINTED, Evidence
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

FRICTION_CASES = 240
#: Scenes of the paper whose motions have every state between them.
FRICTION_SCENES = ("fig5", "fig6", "fig8", "fig9", "fig10")
FIGURES = ("fig5", "fig6", "fig7", "fig8", "fig9", "fig10")


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
    return [contact.p for contact in contacts(1, FRICTION_CASES, seed=3)]


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
    held = outside = at_an_end = 0
    for boundary in (1, 2):
        for contact in contacts(boundary, FRICTION_CASES, seed=40 + boundary):
            if contact.sticks:
                p, (low, high) = contact.p, friction_interval(contact.p, boundary)
                # x'' = 0: friction holds all other forces.
                needed = p.A0 + p.B0 * contact.c - p.k * contact.x - p.c * contact.speed
                held += 1
                outside += not low <= needed <= high
                at_an_end += needed in (low, high)
    numbers = {
        "exact contacts at which the mass sticks": str(held),
        "friction force outside the interval of (1)": str(outside),
        "friction force equal to a single value of (1)": str(at_an_end),
    }
    if outside or not held:
        return Evidence(NOT_AS_PRINTED, f"Outside the interval at {outside} of {held} contacts.", numbers)
    finding = f"The friction force that keeps ẍ = 0 is in the interval at all {held} contacts, and is neither of the "
    finding += f"single values at {held - at_an_end}: the intervals of these have to be open."
    return Evidence(CONFIRMED if at_an_end == held else CORRECTED, finding, numbers)


def _motions() -> list[Trajectory]:
    return [simulate(load_scene(name), max_events=40) for name in FRICTION_SCENES]


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
    numbers |= {f"largest relative difference to DOP853 in Ω{alpha}": f"{worst[alpha]:.2g}" for alpha in sorted(worst)}
    right = set(worst) == {1, 2, 3} and max(worst.values()) < dop853.DOP853_AGREEMENT
    finding = f"Flights by (5) as printed differ from the exact motion by {max(worst.values()):.1g} at most"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}, in all three domains.", numbers)


def stick_condition() -> Evidence:
    """Eq. (2) with |F_s1| <= mu1 FN, its counterpart on belt 2, and Theorem 4."""
    total = differs = equal = stays = leaves = wrong_strict = 0
    for boundary in (1, 2):
        lo, hi = NEIGHBOURS[boundary]
        for contact in contacts(boundary, FRICTION_CASES, seed=10 + boundary):
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
    finding += f"At |Fₛ| = μ FN friction just holds; at {leaves} of {equal} such contacts the mass leaves right after."
    return Evidence(CONFIRMED, finding, numbers)


def stick_motion() -> Evidence:
    """Eqs. (3), (4), (11), (12): x' = v_lambda and x'' = 0 while the mass sticks."""
    import sympy as sp

    t, speed, place = sp.symbols("t v_lambda x_i")
    x = place + speed * t
    numbers = {"dx/dt, d²x/dt² of x = xᵢ + v_λ (t − tᵢ)": f"{x.diff(t)}, {x.diff(t, 2)}"}
    right = (x.diff(t), x.diff(t, 2)) == (speed, 0)
    finding = "Sticking to a belt means to have its speed; (3), (4) and (11), (12) say so in two forms; ẍ = 0 follows"
    return Evidence(DEFINITION if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def mirrored(p: Parameters) -> Parameters:
    """Return the oscillator seen in a mirror, x -> -x: the belts change places, and so do mu1 and mu2."""
    return p.replace(A0=-p.A0, B0=-p.B0, v1=-p.v2, v2=-p.v1, mu1=p.mu2, mu2=p.mu1)


@flown_again
def friction_order() -> Evidence:
    """The assumption mu1 >= mu2: is it needed? A mirror turns every motion into one with mu1 and mu2 exchanged."""
    worst, events, other = 0.0, 0, 0
    for name in FRICTION_SCENES:
        scene = load_scene(name)
        p = scene.parameters
        given = looked_at(simulate(scene, max_events=12))
        seen = simulate(mirrored(p), t0=scene.t0, x0=-scene.x0, v0=-scene.v0, t_end=scene.t_end, max_events=12)
        kinds = [(event.kind, 3 - event.boundary) for event in seen.events]
        other += kinds != [(event.kind, event.boundary) for event in given.events]
        gaps = [abs(a.t - b.t) + abs(a.x + b.x) for a, b in zip(given.events, seen.events, strict=False)]
        worst, events = max([worst, *gaps]), events + len(gaps)
    cases = [
        contact for boundary in (1, 2) for contact in contacts(boundary, FRICTION_CASES, seed=20) if _is_strict(contact)
    ]
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
    finding = f"It can be assumed, and nothing needs it: Theorem 4 holds at all {len(reversed_)} exact contacts with "
    finding += f"μ₁ < μ₂, and the motions with μ₁ and μ₂ exchanged differ from the mirror images by {worst:.1g}."
    return Evidence(DEFINITION, finding if needless else "It is an assumption, and it is needed.", numbers)


def _is_strict(contact: RationalContact) -> bool:
    return contact.force(contact.boundary) * contact.force(contact.boundary + 1) != 0


def friction_characteristics() -> Evidence:
    """Section 2: both belts possess the same friction characteristics; and the coefficients of the figures."""
    wrong = total = 0
    for p in _parameter_sets():
        for boundary, mu in ((1, p.mu1), (2, p.mu2)):
            low, high = friction_interval(p, boundary)
            total, wrong = total + 1, wrong + (high - low != 2 * mu * p.FN)
    numbers = {"jumps of (1) at a belt": str(total), "not 2 μ FN with the belt's own μ": str(wrong)}
    for name in FIGURES:
        p = load_scene(name).parameters
        numbers[f"{name}: μ₁, μ₂"] = f"{float(p.mu1):g}, {float(p.mu2):g}"
    finding = f"At both belts the force jumps by 2 μ FN, with the belt's own μ: one law, at all {total} jumps"
    return Evidence(NOT_AS_PRINTED if wrong else CONFIRMED, f"{finding}.", numbers)


def frequency() -> Evidence:
    """Section 2 calls Omega a frequency ratio: which meaning has it in (9) and (62)?"""
    import sympy as sp

    t, B0, m, k, Omega = sp.symbols("t B0 m k Omega", positive=True)
    printed = -B0 * Omega / m * sp.sin(Omega * t)  # the last term of (62) and (66)
    meanings = {"angular frequency": Omega, "ratio to √(k/m)": Omega * sp.sqrt(k / m)}
    rests = {}
    for words, factor in meanings.items():
        drive = B0 / m * sp.cos(factor * t)
        rests[words] = sp.simplify(drive.diff(t) - printed.subs(sp.sin(Omega * t), sp.sin(factor * t)))
    numbers = {f"d/dt of the drive minus the term in (62), Ω as {words}": str(rest) for words, rest in rests.items()}
    if rests["ratio to √(k/m)"] == 0:
        return Evidence(CONFIRMED, "As a ratio it gives (62).", numbers)
    finding = "(62) and (66) follow from (9) if Ω is the angular frequency; with a ratio they lack the factor √(k/m)"
    return Evidence(CORRECTED if rests["angular frequency"] == 0 else NOT_AS_PRINTED, f"{finding}.", numbers)


def motion_states() -> Evidence:
    """Section 3: five motion states."""
    p = load_scene("fig5").parameters
    middle = (p.v1 + p.v2) / 2
    places = [domain_of(p, v) for v in (p.v1 - 1, p.v1, middle, p.v2, p.v2 + 1)]
    domains = [place for place in places if place in ([1], [2], [3])]
    boundaries = [place for place in places if place in ([12], [23])]
    numbers = {"domains of (6)": str(len(domains)), "boundaries of (7)": str(len(boundaries))}
    right = len(domains) == 3 and len(boundaries) == 2
    finding = "A motion in each domain of (6), and one on each boundary of (7) that stays there"
    return Evidence(DEFINITION if right else NOT_AS_PRINTED, f"{finding}.", numbers)


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
    finding = f"Each of {total} velocities is in one domain or on one boundary" if not wrong else f"{wrong} are not"
    return Evidence(NOT_AS_PRINTED if wrong else DEFINITION, f"{finding}.", numbers)


def vector_fields() -> Evidence:
    """Eqs. (8) to (10): the field (9) is (5) divided by the mass, and jumps by 2 mu FN/m."""
    wrong = jumps = total = 0
    for boundary in (1, 2):
        for contact in contacts(boundary, FRICTION_CASES, seed=30 + boundary):
            p, lo, hi = contact.p, *NEIGHBOURS[boundary]
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
