"""Sections 2, 3 and 5: the friction law, the equations of motion, domains, switching planes, and
the eight mappings.
"""

from __future__ import annotations

import random
from collections import Counter
from fractions import Fraction
from itertools import pairwise, product
from math import pi, sqrt, tanh
from typing import Any

import numpy as np
from scipy.optimize import brentq

from symosc.friction import MAPS, NEIGHBOURS
from symosc.mappings.equations import residual
from symosc.model import Parameters
from symosc.paper.checks.exact import (
    DOP853_AGREEMENT,
    RationalContact,
    contacts,
    dop853,
    friction_on_mass,
    tally,
)
from symosc.paper.checks.motions import EXIT_EQUATIONS, field, recorded
from symosc.paper.claims import CORRECTED, DEFINITION, Evidence, evidence, verdict
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate

CASES = 240
#: Scenes of the paper whose motions have every state between them, and all printed ones.
STATES = ("fig5", "fig6", "fig8", "fig9", "fig10")
FIGURES = ("fig5", "fig6", "fig7", "fig8", "fig9", "fig10")


# --- what the paper prints ---


def friction_force(p: Parameters, alpha: int) -> Fraction:
    """Return the friction force F_f of eq. (1) inside a domain, as a resistance to the motion."""
    return {1: -(p.mu1 + p.mu2), 2: p.mu1 - p.mu2, 3: p.mu1 + p.mu2}[alpha] * p.FN


def friction_interval(p: Parameters, boundary: int) -> tuple[Fraction, Fraction]:
    """Return the interval of eq. (1) in which the friction force F_f lies at the speed of a belt."""
    middle = (p.mu1 - p.mu2) * p.FN
    outer = (p.mu1 + p.mu2) * p.FN
    if boundary == 1:
        return (-outer, middle)
    return (middle, outer)


def added_force(p: Parameters, alpha: int) -> Fraction:
    """Return the friction term of eq. (5) that is added to A0 on the right side."""
    return {1: p.mu1 + p.mu2, 2: -(p.mu1 - p.mu2), 3: -(p.mu1 + p.mu2)}[alpha] * p.FN


def vector_field(p: Parameters, alpha: int, x: Fraction, v: Fraction, cosine: Fraction) -> Fraction:
    """Return the acceleration F^(alpha) of eq. (9) in domain `alpha`, at x, v and `cosine` =
    cos(Omega t).
    """
    constant_force = {
        1: p.A0 + (p.mu1 + p.mu2) * p.FN,
        2: p.A0 - (p.mu1 - p.mu2) * p.FN,
        3: p.A0 - (p.mu1 + p.mu2) * p.FN,
    }
    return -p.c / p.m * v - p.k / p.m * x + p.B0 / p.m * cosine + constant_force[alpha] / p.m


def stick_force(p: Parameters, boundary: int, x: Fraction, cosine: Fraction) -> Fraction:
    """Return the force of eq. (2), or its counterpart on belt 2: all forces but the friction of
    that belt.
    """
    # Belt 2 is faster than a mass on belt 1, and belt 1 slower than one on belt 2.
    if boundary == 1:
        drag = p.mu2 * p.FN
    else:
        drag = -p.mu1 * p.FN
    return p.A0 + p.B0 * cosine - p.k * x - p.c * p.belt(boundary) + drag


def domain_of(p: Parameters, v: Fraction) -> list[int]:
    """Return the open domains (1, 2, 3) and the boundaries (12, 23) of eqs. (6) and (7) that a
    velocity is in.
    """
    conditions = {1: v < p.v1, 2: p.v1 < v < p.v2, 3: v > p.v2, 12: v == p.v1, 23: v == p.v2}
    return [name for name, holds in conditions.items() if holds]


#: Eqs. (50) and (51): belt and side at the start and at the end (0 on the belt, -1 below, 1 above
#: its speed).
PLANES = {
    "P1": ((1, 0), (1, 0)),
    "P2": ((1, -1), (1, -1)),
    "P3": ((1, 1), (1, 1)),
    "P4": ((2, 0), (2, 0)),
    "P5": ((2, -1), (2, -1)),
    "P6": ((2, 1), (2, 1)),
    "P7": ((2, -1), (1, 1)),
    "P8": ((1, 1), (2, -1)),
}


def stick_exit(p: Parameters, boundary: int, x: Any, cosine: Any) -> Any:
    """Return left minus right side of the second equation of (52), or (53) for belt 2: 0 where a
    stick ends.
    """

    def number(value: Fraction) -> Any:
        # As exact as x.
        if isinstance(x, Fraction):
            return value
        return float(value)

    applied = (
        number(p.A0) + number(p.B0) * cosine - number(p.k) * x - number(p.c * p.belt(boundary))
    )
    if boundary == 1:
        drag_2 = number(p.mu2 * p.FN)
    else:
        drag_2 = -number(p.mu2 * p.FN)
    return applied + drag_2 - number(p.mu1 * p.FN)


def printed_planes(speed: Any, delta: Any) -> tuple[Any, Any]:
    """Return the expressions of eq. (49) whose limits for delta -> 0 define v^- and v^+."""
    return speed - delta, speed + delta


# --- checks ---


def _both_boundaries(seed: int) -> tuple[RationalContact, ...]:
    """Return `CASES` random rational contacts with each of the two boundaries."""
    return (*contacts(1, CASES, seed + 1), *contacts(2, CASES, seed + 2))


def _friction_coefficient(p: Parameters, boundary: int) -> Fraction:
    if boundary == 1:
        return p.mu1
    return p.mu2


def _applied_force(contact: RationalContact) -> Fraction:
    """Return the sum of all forces on the mass but friction."""
    p = contact.p
    return p.A0 + p.B0 * contact.c - p.k * contact.x - p.c * contact.speed


def friction_between_the_jumps() -> Evidence:
    """Check eq. (1) inside the domains against Coulomb's law of both belts and against eq. (5)."""

    def added(p: Parameters, alpha: int) -> Fraction:
        return p.A(alpha) - p.A0

    # Each case is (parameters, domain).
    questions = {
        "rational parameter sets and domains": lambda case: True,
        "F_f not the sum of both belts' Coulomb friction": lambda case: (
            -friction_force(*case) != friction_on_mass(*case)
        ),
        "A_α − A₀ not -F_f": lambda case: added(*case) != -friction_force(*case),
    }
    numbers = tally(
        product((contact.p for contact in contacts(1, CASES, seed=3)), (1, 2, 3)), questions
    )
    total, *wrong = numbers.values()
    p = load_scene("fig5").parameters
    numbers["levels of Fig. 5"] = ", ".join(
        f"{float(friction_force(p, alpha)):g}" for alpha in (1, 2, 3)
    )
    finding = (
        "F_f is the friction of both belts as a resistance: it stands with a minus on the right of "
        "(5)"
    )
    return evidence(not any(wrong), f"{finding}; {total} exact cases.", numbers)


def friction_at_the_jumps() -> Evidence:
    """Check eq. (1) at x' = v1 and v2: is the friction force in its interval, or one of the values
    on either side?
    """

    def interval(contact: RationalContact) -> tuple[Fraction, Fraction]:
        return friction_interval(contact.p, contact.boundary)

    def is_outside(contact: RationalContact) -> bool:
        low, high = interval(contact)
        return not low <= _applied_force(contact) <= high

    # While the mass sticks, friction balances the applied force.
    questions = {
        "exact contacts at which the mass sticks": lambda contact: True,
        "friction force outside the interval of (1)": is_outside,
        "friction force equal to a single value of (1)": lambda contact: (
            _applied_force(contact) in interval(contact)
        ),
    }
    sticking = (contact for contact in _both_boundaries(40) if contact.sticks)
    numbers = tally(sticking, questions)
    held, outside, at_an_end = numbers.values()
    finding = (
        f"The friction force that keeps ẍ = 0 is in the interval at all {held} contacts, and is "
        f"neither of the single values at {held - at_an_end}: the intervals of these have to be "
        "open."
    )
    return evidence(
        held and not outside, finding, numbers, verdict(at_an_end == held, corrected=True)
    )


def equations_of_motion() -> Evidence:
    """Check eq. (5), integrated by scipy's DOP853 over flights in each domain, against the exact
    motion.
    """
    errors: dict[int, list[float]] = {}
    for motion in (simulate(load_scene(name), max_events=40) for name in STATES):
        p = motion.parameters.parameters
        for segment in motion.segments[:8]:
            if segment.mode.startswith("Omega"):
                alpha = int(segment.mode[-1])
                begin = float(segment.t_start)
                end = float(segment.t_end)
                run = dop853(p, p.A0 + added_force(p, alpha), (begin, end), motion(begin))
                difference = np.abs(run.y - motion(np.minimum(run.t, end))).max()
                error = difference / max(1.0, np.abs(run.y).max())
                errors.setdefault(alpha, []).append(float(error))
    rows = sorted(errors.items())
    numbers: dict[str, Any] = {f"flights in Ω{alpha}": len(of_domain) for alpha, of_domain in rows}
    numbers |= {
        f"largest relative difference to DOP853 in Ω{alpha}": f"{max(of_domain):.2g}"
        for alpha, of_domain in rows
    }
    worst = max(map(max, errors.values()))
    finding = (
        f"Flights by (5) as printed differ from the exact motion by {worst:.1g} at most, in all "
        "three domains."
    )
    return evidence(set(errors) == {1, 2, 3} and worst < DOP853_AGREEMENT, finding, numbers)


def stick_if_friction_holds() -> Evidence:
    """Check eq. (2) with |F_s1| <= mu1 FN, and its counterpart on belt 2, against Theorem 4 and the
    exact flow.
    """

    def excess(contact: RationalContact) -> Fraction:
        p = contact.p
        b = contact.boundary
        grip = _friction_coefficient(p, b) * p.FN
        return abs(stick_force(p, b, contact.x, contact.c)) - grip

    def is_held(contact: RationalContact) -> bool:
        below, above = contact.forces
        return below >= 0 >= above

    questions = {
        "rational contacts with both belts": lambda contact: True,
        "|Fₛ| ≤ μ FN not the same as F⁽ˡᵒ⁾ ≥ 0 ≥ F⁽ʰⁱ⁾": lambda contact: (
            (excess(contact) <= 0) != is_held(contact)
        ),
        "|Fₛ| not μ FN, and the exact flow does otherwise": lambda contact: (
            excess(contact) and (excess(contact) < 0) != contact.sticks
        ),
        "|Fₛ| = μ FN": lambda contact: excess(contact) == 0,
        "of them the mass stays on the belt": lambda contact: (
            excess(contact) == 0 and contact.sticks
        ),
        "of them it leaves at once": lambda contact: excess(contact) == 0 and not contact.sticks,
    }
    numbers = tally(_both_boundaries(10), questions)
    total, differs, wrong, equal, _, leaves = numbers.values()
    finding = (
        f"|Fₛ| ≤ μ FN is F⁽ˡᵒ⁾ ≥ 0 ≥ F⁽ʰⁱ⁾, exactly; right at all {total - equal} contacts without "
        f"equality. At |Fₛ| = μ FN friction just holds; at {leaves} of {equal} such contacts the "
        "mass leaves right after."
    )
    return evidence(not differs and not wrong, finding, numbers)


def stick_motion() -> Evidence:
    """Check eqs. (3), (4), (11), (12): x' = v_lambda, the belt's speed, and x'' = 0 while the mass
    sticks.
    """
    import sympy as sp

    t, speed, place = sp.symbols("t v_lambda x_i")
    x = place + speed * t
    numbers = {"dx/dt, d²x/dt² of x = xᵢ + v_λ (t − tᵢ)": f"{x.diff(t)}, {x.diff(t, 2)}"}
    finding = (
        "Sticking to a belt means to have its speed; (3), (4) and (11), (12) say so in two forms; "
        "ẍ = 0 follows."
    )
    return evidence((x.diff(t), x.diff(t, 2)) == (speed, 0), finding, numbers, DEFINITION)


def friction_coefficients_in_order() -> Evidence:
    """Check whether mu1 >= mu2 is needed: mirror images of motions, x -> -x, have mu1 and mu2
    exchanged.
    """
    gaps = [0.0]
    different = 0
    for scene in map(load_scene, STATES):
        original = recorded(simulate(scene, max_events=12))
        p = scene.parameters
        # In the mirror, x -> -x, the belts change places.
        mirrored = p.replace(A0=-p.A0, B0=-p.B0, v1=-p.v2, v2=-p.v1, mu1=p.mu2, mu2=p.mu1)
        image = simulate(
            mirrored, t0=scene.t0, x0=-scene.x0, v0=-scene.v0, t_end=scene.t_end, max_events=12
        )
        kinds = [(event.kind, 3 - event.boundary) for event in image.events]
        different += kinds != [(event.kind, event.boundary) for event in original.events]
        gaps += [
            abs(a.t - b.t) + abs(a.x + b.x)
            for a, b in zip(original.events, image.events, strict=False)
        ]
    cases = [contact for belt in NEIGHBOURS for contact in contacts(belt, CASES, seed=20)]
    # Forces and what the flow does where the order is the reverse one and no force is 0.
    reverse = [
        (*contact.forces, contact.sticks)
        for contact in cases
        if contact.p.mu1 < contact.p.mu2 and all(contact.forces)
    ]
    wrong = sum((below > 0 > above) != sticks for below, above, sticks in reverse)
    numbers = {
        "events of Figs. 5, 6, 8, 9, 10 compared with their mirror image": len(gaps) - 1,
        "figures whose mirror image has other events": different,
        "largest difference of t and x": f"{max(gaps):.2g}",
        "rational contacts with μ₁ < μ₂": len(reverse),
        "of them Theorem 4 wrong": wrong,
    }
    mirrors_agree = not different and max(gaps) < 1e-9
    theorem_holds = reverse and not wrong
    if mirrors_agree and theorem_holds:
        finding = (
            f"It can be assumed, and nothing needs it: Theorem 4 holds at all {len(reverse)} exact "
            "contacts with μ₁ < μ₂, and the motions with μ₁ and μ₂ exchanged differ from the "
            f"mirror images by {max(gaps):.1g}."
        )
    else:
        finding = "It is an assumption, and it is needed."
    return Evidence(DEFINITION, finding, numbers)


def friction_characteristics() -> Evidence:
    """Check section 2: both belts have the same friction law, with coefficients that are listed for
    each figure.
    """
    jumps = [
        (contact.p, belt, friction_interval(contact.p, belt))
        for contact in contacts(1, CASES, seed=3)
        for belt in (1, 2)
    ]
    wrong = sum(
        high - low != 2 * _friction_coefficient(p, belt) * p.FN for p, belt, (low, high) in jumps
    )
    numbers: dict[str, Any] = {
        "jumps of (1) at a belt": len(jumps),
        "not 2 μ FN with the belt's own μ": wrong,
    }
    for name in FIGURES:
        p = load_scene(name).parameters
        numbers[f"{name}: μ₁, μ₂"] = f"{float(p.mu1):g}, {float(p.mu2):g}"
    finding = (
        "At both belts the force jumps by 2 μ FN, with the belt's own μ: one law, at all "
        f"{len(jumps)} jumps."
    )
    return evidence(not wrong, finding, numbers)


def drive_frequency_ratio() -> Evidence:
    """Check what Omega, which section 2 calls a frequency ratio, means in (9) and (62)."""
    import sympy as sp

    t, B0, m, k, Omega = sp.symbols("t B0 m k Omega", positive=True)

    def difference(frequency: Any) -> Any:
        """Return the derivative of the drive with this angular frequency, minus what is printed."""
        printed = -B0 * Omega / m * sp.sin(frequency * t)  # the last term of (62) and (66)
        return sp.simplify((B0 / m * sp.cos(frequency * t)).diff(t) - printed)

    as_frequency = difference(Omega)
    as_ratio = difference(Omega * sp.sqrt(k / m))
    text_before = "d/dt of the drive minus the term in (62), Ω as"
    numbers = {
        f"{text_before} angular frequency": as_frequency,
        f"{text_before} ratio to √(k/m)": as_ratio,
    }
    finding = (
        "(62) and (66) follow from (9) if Ω is the angular frequency; with a ratio they lack the "
        "factor √(k/m)."
    )
    return evidence(as_frequency == 0 and as_ratio != 0, finding, numbers, CORRECTED)


def five_motion_states() -> Evidence:
    """Check that section 3 has five states of motion: in three domains and on two boundaries."""
    p = load_scene("fig5").parameters
    # Below, on, between and above the belts' speeds. `domain_of` gives lists: [1], or [12] for the
    # boundary of domains 1 and 2.
    speeds = (p.v1 - 1, p.v1, (p.v1 + p.v2) / 2, p.v2, p.v2 + 1)
    states = [domain_of(p, v) for v in speeds]
    domains = sum(state in ([1], [2], [3]) for state in states)
    boundaries = sum(state in ([12], [23]) for state in states)
    numbers = {"domains of (6)": domains, "boundaries of (7)": boundaries}
    finding = "A motion in each domain of (6), and one on each boundary of (7) that stays there."
    return evidence((domains, boundaries) == (3, 2), finding, numbers, DEFINITION)


def domains_and_boundaries() -> Evidence:
    """Check that by eqs. (6) and (7) every state is in exactly one domain or on one boundary."""
    draw = random.Random(6)
    # For each velocity all domains (1, 2, 3) and boundaries (12, 23) whose condition it fulfils.
    memberships = []
    for contact in contacts(1, CASES, seed=3):
        p = contact.p
        middle = (p.v1 + p.v2) / 2
        anywhere = middle + Fraction(draw.randint(-40, 40), 4)
        velocities = (p.v1, p.v2, middle, anywhere, p.v1 - 1, p.v2 + 1)
        memberships += [domain_of(p, v) for v in velocities]
    wrong = sum(len(places) != 1 for places in memberships)
    on_boundary = sum(places in ([12], [23]) for places in memberships)
    numbers = {
        "velocities": len(memberships),
        "on a boundary": on_boundary,
        "in none or several places": wrong,
    }
    finding = f"Each of {len(memberships)} velocities is in one domain or on one boundary."
    return evidence(not wrong, finding, numbers, DEFINITION)


def vector_fields() -> Evidence:
    """Check eqs. (8) to (10): the field (9) is (5) divided by the mass, and jumps by 2 mu FN/m."""
    wrong = 0
    jumps = 0
    cases = _both_boundaries(30)
    for contact in cases:
        p = contact.p
        fields = [
            vector_field(p, alpha, contact.x, contact.speed, contact.c) for alpha in contact.domains
        ]
        wrong += sum(field != force for field, force in zip(fields, contact.forces, strict=True))
        below, above = fields
        jump = 2 * _friction_coefficient(p, contact.boundary) * p.FN / p.m
        jumps += below - above != jump
    total = 2 * len(cases)
    numbers = {
        "rational states and domains": total,
        "(9) not Newton's law with Coulomb's friction": wrong,
    }
    numbers["jumps that are not 2 μ FN/m"] = jumps
    finding = (
        f"(9) agrees with Newton's law and Coulomb's friction in {total - wrong} of {total} exact "
        "cases."
    )
    return evidence(not wrong and not jumps, finding, numbers)


def forces_or_accelerations() -> Evidence:
    """Check whether F, which section 6 shows as a force, is one: exactly, m F is the right side of
    (5).
    """
    cases = [
        (contact, alpha) for contact in (*contacts(1), *contacts(2)) for alpha in contact.domains
    ]

    def is_newton(contact: RationalContact, alpha: int) -> bool:
        p = contact.p
        acceleration = vector_field(p, alpha, contact.x, contact.speed, contact.c)
        return p.m * acceleration == _applied_force(contact) + added_force(p, alpha)

    wrong = sum(not is_newton(contact, alpha) for contact, alpha in cases)
    masses = {f"Fig. {name.removeprefix('fig')}": load_scene(name).parameters.m for name in FIGURES}
    apart = [name for name, mass in masses.items() if mass != 1]
    numbers: dict[str, Any] = {
        "exact contacts and domains": len(cases),
        "m F of (9) not the right side of (5)": wrong,
    }
    numbers |= {f"{name}: m": f"{float(mass):g}" for name, mass in masses.items()}
    finding = (
        "m F⁽ᵅ⁾ is the force, F⁽ᵅ⁾ the acceleration; the two differ in "
        f"{', '.join(apart) or 'no figure'}."
    )
    return evidence(not wrong, finding, numbers, verdict(not apart, corrected=True))


MAPPED_SCENES = ("fig5", "fig6", "fig8", "fig9", "fig10", "fig7-exact", "fig8-exact")
FLIGHTS = ("P2", "P3", "P5", "P6", "P7", "P8")
#: Exact contacts that are searched for ends of sticks, and for grazes.
EXIT_CASES = 300


def switching_planes() -> Evidence:
    """Check eq. (49): three planes at each belt, for motions below, on and above its speed."""
    names = {-1: "below", 0: "on it", 1: "above"}
    ends = Counter(end for pair in PLANES.values() for end in pair)
    numbers = {
        f"belt {belt}, {names[side]}: ends of mappings": count
        for (belt, side), count in ends.items()
    }
    finding = (
        f"{len(ends)} planes, three at each belt: what is there goes on below, on or above the "
        "belt's speed."
    )
    return evidence(len(ends) == 6, finding, numbers, DEFINITION)


def planes_as_limits() -> Evidence:
    """Check eq. (49) as printed.

    The limits v_lambda^- and v_lambda^+ name the sides of one plane.
    """
    import sympy as sp

    speed, delta = sp.symbols("v_lambda delta", positive=True)
    limits = [sp.limit(expression, delta, 0, "+") for expression in printed_planes(speed, delta)]
    numbers = {
        f"limit that defines v_λ{sign}": limit for sign, limit in zip("⁻⁺", limits, strict=True)
    }
    numbers["limits that are v_λ"] = f"{limits.count(speed)} of {len(limits)}"
    finding = (
        "Both limits are v_λ: the signs say on which side of it the motion is, not which number it "
        "has."
    )
    return evidence({speed} == {*limits}, finding, numbers, DEFINITION)


def basic_mappings() -> Evidence:
    """Check eqs. (50), (51): every way from plane to plane through one domain, or on one belt, is
    one of the eight.
    """
    ways = {((belt, 0), (belt, 0)) for belt in NEIGHBOURS}
    for domain in (1, 2, 3):
        # The belts at a domain, and the side of them on which it is.
        planes = [
            (belt, -1 if domain == belt else 1)
            for belt, sides in NEIGHBOURS.items()
            if domain in sides
        ]
        ways |= set(product(planes, planes))
    listed = set(PLANES.values())
    numbers = {
        "ways from plane to plane in one domain or on one belt": len(ways),
        "mappings of (50)": len(PLANES),
        "ways that (50) lacks": len(ways - listed),
        "mappings of (50) that are no way": len(listed - ways),
    }
    finding = f"(50) lists all {len(ways)} ways from plane to plane, each once."
    return evidence(ways == listed and len(PLANES) == len(ways), finding, numbers, DEFINITION)


def trajectories_in_domains() -> Evidence:
    """Check Fig. 4: between its ends each mapping's trajectory is in one domain or on one belt."""
    numbers = {}
    for label, planes in PLANES.items():
        start, end = ({NEIGHBOURS[belt][side > 0]} if side else set() for belt, side in planes)
        between = ", ".join(f"Ω{domain}" for domain in start & end)
        (start_belt, _), _ = planes
        numbers[f"{label}: in between"] = between or f"belt {start_belt}"
    flights = sum(between.startswith("Ω") for between in numbers.values())
    finding = (
        f"The planes at its ends leave one domain to each of {flights} flights, and the belt to P₁ "
        "and P₄."
    )
    return evidence(flights == 6, finding, numbers, DEFINITION)


def stick_exits(boundary: int) -> Evidence:
    """Check eqs. (52), (53) at exact contacts where one force vanishes and a stick ends, and in
    Fig. 5 or 6.
    """
    equation = EXIT_EQUATIONS[boundary]
    (lo, hi) = NEIGHBOURS[boundary]
    # By the domain that the mass slips into: whether the printed equation holds there.
    exits: dict[int, list[bool]] = {lo: [], hi: []}
    for contact in contacts(boundary, EXIT_CASES, seed=50 + boundary):
        below, above = contact.forces
        # The stick ends here: held so far by both forces, and the exact flow leaves the belt.
        falls = below == 0 > above and contact.slope(lo) < 0
        rises = above == 0 < below and contact.slope(hi) > 0
        if falls or rises:
            if falls:
                target = lo
            else:
                target = hi
            if contact.next_mode != f"Omega{target}":
                raise ArithmeticError(f"the exact flow {contact.goes_on}")
            exits[target].append(stick_exit(contact.p, boundary, contact.x, contact.c) == 0)
    numbers = {
        f"exact ends of sticks into Ω{alpha}; ({equation}) holds": f"{len(holds)}; {sum(holds)}"
        for alpha, holds in exits.items()
    } | _first_exit(boundary, equation)
    finding = (
        f"({equation}) holds at {sum(exits[hi])} of {len(exits[hi])} exact ends of sticks with "
        f"F({hi}) = 0, and at {sum(exits[lo])} of {len(exits[lo])} with F({lo}) = 0, where the "
        f"mass leaves as well, into Ω{lo}."
    )
    all_exits = exits[lo] + exits[hi]
    return Evidence(verdict(all_exits and all(all_exits)), finding, numbers)


def _first_exit(boundary: int, equation: int) -> dict[str, str]:
    """Return when the first stick of Fig. 5 or 6 begins and ends, and there the two sides'
    difference in `equation`.
    """
    figure = {1: 5, 2: 6}[boundary]
    scene = load_scene(f"fig{figure}")
    name = f"Fig. {figure}"
    (lo, hi) = NEIGHBOURS[boundary]
    p = scene.parameters
    speed = float(scene.parameters.belt(boundary))
    t = float(scene.t0)
    x = float(scene.x0)
    if scene.v0 != p.belt(boundary):  # the stick begins where the flight from the start ends
        run = dop853(
            p, p.A(1), (t, t + 200 * pi / float(p.Omega)), (x, float(scene.v0)), until_speed=speed
        )
        # The only event function, `gap`, is 0 once: there the integration ends.
        ((t_contact,),) = run.t_events
        (((x_contact, _),),) = run.y_events
        t = float(t_contact)
        x = float(x_contact)

    def forces(elapsed: Any) -> dict[int, Any]:
        return {
            alpha: field(p, alpha, t + elapsed, x + speed * elapsed, speed) for alpha in (lo, hi)
        }

    # The first instant of a grid at which no hold is left, then its end by root finding before it.
    grid = np.linspace(0.0, 20.0, 4001)
    along = forces(grid)
    after = int(np.argmax((along[lo] < 0) | (along[hi] > 0)))
    if along[lo][after] < 0:
        slips_into = lo
    else:
        slips_into = hi

    def holding_force(elapsed: float) -> float:
        return float(forces(elapsed)[slips_into])

    end = float(brentq(holding_force, grid[after - 1], grid[after], xtol=1e-13))
    printed = stick_exit(p, boundary, x + speed * end, np.cos(float(p.Omega) * (t + end)))
    at_end = ", ".join(
        "0" if abs(value) < 1e-10 else f"{value:.6g}" for value in forces(end).values()
    )
    return {
        f"{name}: first stick begins, ends at t": f"{t:.9g}, {t + end:.9g}",
        f"{name}: F({lo}), F({hi}) at its end": at_end,
        f"{name}: left side of ({equation}) minus right side there": f"{float(printed):.6g}",
    }


def governing_equations() -> Evidence:
    """Check eq. (54): f1 = f2 = 0 for both ends of simulated flights, and DOP853 takes each flight
    to the same end.
    """
    residuals: dict[str, list[float]] = {label: [] for label in FLIGHTS}
    dop853_errors: dict[str, list[float]] = {label: [] for label in FLIGHTS}
    motions = [simulate(load_scene(name), max_events=40) for name in MAPPED_SCENES]
    # Segment i + 1 goes from event i to event i + 1.
    stretches = [
        (motion.parameters.parameters, segment, start, end)
        for motion in motions
        for segment, (start, end) in zip(motion.segments[1:], pairwise(motion.events), strict=False)
    ]
    for p, segment, start, end in stretches:
        label = str(segment.label)
        if label not in FLIGHTS:
            continue
        Omega = float(p.Omega)
        t = float(end.t)
        x = float(end.x)
        v = float(end.v)
        f1, f2 = residual(p, label, (float(start.x), Omega * float(start.t)), (x, Omega * t))
        size_x = max(1.0, abs(x))
        size_v = max(1.0, abs(v))
        residuals[label].append(max(abs(f1) / size_x, abs(f2) / size_v))
        if len(residuals[label]) <= 3:  # DOP853 is slow: three flights of a kind
            run = dop853(
                p, p.A(int(segment.mode[-1])), (float(start.t), t), (float(start.x), float(start.v))
            )
            x_end, v_end = run.y[:, -1]
            error = max(abs(x_end - x) / size_x, abs(v_end - v) / size_v)
            dop853_errors[label].append(float(error))
    # A kind of flight that does not occur counts as wrong.
    worst, by_dop853 = (
        {label: max(by_label[label], default=1.0) for label in FLIGHTS}
        for by_label in (residuals, dop853_errors)
    )
    numbers = {
        label: (
            f"{len(residuals[label])} flights, largest |f₁|, |f₂| {worst[label]:.2g}, by DOP853 "
            f"{by_dop853[label]:.2g}"
        )
        for label in FLIGHTS
    }
    largest = max(worst.values())
    difference = max(by_dop853.values())
    finding = (
        f"f₁ = f₂ = 0 at the ends of {sum(map(len, residuals.values()))} flights of six kinds, to "
        f"{largest:.1g}"
    )
    finding += f"; by DOP853 to {difference:.1g}."
    return evidence(largest < 1e-11 and difference < DOP853_AGREEMENT, finding, numbers)


def four_grazes() -> Evidence:
    """Check what is said before Theorem 7: grazing has four cases, those of P2, P3, P5 and P6."""
    pairs = sorted((domain, boundary) for boundary, sides in NEIGHBOURS.items() for domain in sides)
    of_maps = sorted((row.domain, row.end.boundary) for row in MAPS.values() if row.returns)
    grazes: Counter[tuple[int, int]] = Counter()
    for boundary, domains in NEIGHBOURS.items():
        for contact in contacts(boundary, EXIT_CASES, seed=60 + boundary):
            grazes.update((alpha, boundary) for alpha in domains if contact.grazes(alpha))
    numbers = {
        "pairs of a domain and a boundary that it has": len(pairs),
        "of them the place of P₂, P₃, P₅ or P₆": sum(pair in of_maps for pair in pairs),
    } | {
        f"exact grazes of belt {belt} from Ω{domain}": grazes[domain, belt]
        for domain, belt in pairs
    }
    finding = (
        f"{len(pairs)} pairs of domain and boundary, one for each of P₂, P₃, P₅ and P₆; each of "
        "them can graze."
    )
    return evidence(pairs == of_maps == sorted(grazes) and len(pairs) == 4, finding, numbers)


def position_bound(p: Parameters) -> float:
    """Return the long-term bound of |x| from the L1 norm of the impulse response; c, k > 0."""
    # The proposition "how far a motion goes" of `symosc derive orbits`: friction and drive together
    # stay below a force M; then lim sup |x| <= (M/k) coth(pi zeta/(2
    # sqrt(1 - zeta^2))), or M/k without oscillation.
    force = float(abs(p.A0) + abs(p.B0) + (p.mu1 + p.mu2) * p.FN)
    damping = float(p.c) / (2 * sqrt(p.k * p.m))
    if damping >= 1:
        ringing = 1.0
    else:
        ringing = tanh(pi * damping / (2 * sqrt(1 - damping**2)))
    return force / float(p.k) / ringing


def _undamped_growth() -> list[float]:
    """Return the largest |x| in the periods 10, 20 and 40 of an undamped motion at resonance."""
    p = load_scene("fig8").parameters.replace(c=0, mu1="0.1", mu2="0.1", FN=10, B0=16)
    period = 2 * pi / float(p.Omega)
    motion = simulate(p, t0=0, x0=0, v0=0, t_end=41 * period, max_events=400)
    growth = []
    for n in (10, 20, 40):
        x, _ = motion(np.linspace(n * period, (n + 1) * period, 200))
        growth.append(float(np.abs(x).max()))
    return growth


def bounded_motions() -> Evidence:
    """Check that motions in the three unbounded domains are bounded, as section 5 says.

    Also without a damper.
    """
    within = 0
    numbers = {}
    for name in STATES:
        scene = load_scene(name)
        period = 2 * pi / float(scene.parameters.Omega)
        motion = recorded(simulate(scene, t_end=float(scene.t0) + 30 * period, max_events=2000))
        begin = float(motion.t_start)
        end = float(motion.t_end)
        late = np.linspace(begin + 0.5 * (end - begin), end, 400)
        x, _ = motion(late)
        reach = float(np.abs(x).max())
        bound = position_bound(scene.parameters)
        within += reach <= bound
        numbers[f"{name}: largest |x| in the second half of 30 periods, bound"] = (
            f"{reach:.4g}, {bound:.4g}"
        )
    numbers["bound"] = "lim sup |x| ≤ (M/k) coth(πζ/(2√(1 − ζ²))), M the sum of all forces"
    growth = _undamped_growth()
    swings = ", ".join(f"{value:.4g}" for value in growth)
    numbers["undamped at resonance, c = 0, Ω² = k/m: largest |x| in periods 10, 20, 40"] = swings
    finding = (
        f"{within} of {len(STATES)} motions of the figures stay within the bound that the damper "
        "gives, which holds for every motion with c, k > 0 (one kind in each of three domains). "
        f"Without a damper, at resonance, the swings grow: {swings}."
    )
    # Twice as many periods make the swings about twice as large.
    after_10, after_20, after_40 = growth
    grows = after_20 > 1.5 * after_10 and after_40 > 1.5 * after_20
    return evidence(within == len(STATES) and grows, finding, numbers)
