"""Theorem 7: the printed cases (55) to (58) against the exact flow at rational contacts, and what
its proof says.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from functools import cache
from math import atan2, isqrt, pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from symosc.friction import MAPS
from symosc.grazing.check import check_grazing
from symosc.grazing.start import grazing_start
from symosc.grazing.window import grazing_window
from symosc.kernels.theorem7_cases import PLACES
from symosc.mappings.equations import jacobian
from symosc.model import Parameters
from symosc.paper.checks.exact import RATIONAL_PHASES, RationalContact, contacts
from symosc.paper.checks.motions import recorded
from symosc.paper.claims import CORRECTED, UNDECIDED, Evidence, evidence, verdict
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate

#: Angles are written as rational numbers, a whole turn as 4: pi/2 is 1, pi is 2. (See
#: `quarter_turns`.)
ZERO, QUARTER, HALF, FULL_CIRCLE = map(Fraction, (0, 1, 2, 4))


class Arc(NamedTuple):
    """An arc of angles from `low` to `high`; `high` is not in it, `low` only if `closed`."""

    low: Fraction
    high: Fraction
    closed: bool = False


# --- what the paper prints ---


def printed_window(mapping: str, gamma: Any, amplitude: Any) -> list[tuple[int, list[Arc]]]:
    """Return number and arcs of phases of each printed case that holds for gamma and `amplitude`,
    B0 Omega/m.
    """
    g = gamma
    a = amplitude
    # d is |Theta_cr|; where there is no Theta_cr, no case that holds has d in it.
    if a and abs(g) <= abs(a):
        sine = -g / a
        d = quarter_turns(abs(sine), root(1 - sine * sine))
    else:
        d = ZERO
    if MAPS[mapping].side > 0:
        cases = [
            (0 < g < a, [Arc(ZERO, HALF + d, closed=True), Arc(FULL_CIRCLE - d, FULL_CIRCLE)]),
            (0 < g == a, [Arc(ZERO, 3 * QUARTER, closed=True), Arc(3 * QUARTER, FULL_CIRCLE)]),
            (0 < a < g, [Arc(ZERO, FULL_CIRCLE, closed=True)]),
            (g == 0, [Arc(ZERO, HALF)]),
            (g < 0 and a > abs(g), [Arc(d, HALF - d)]),
            (g < 0 and a < abs(g), []),
        ]
    else:
        cases = [
            (0 < g < a, [Arc(HALF + d, FULL_CIRCLE - d)]),
            (0 < a <= g, []),
            (g == 0, [Arc(HALF, FULL_CIRCLE)]),
            (g < 0 and a > abs(g), [Arc(ZERO, d, closed=True), Arc(HALF - d, FULL_CIRCLE)]),
            (g < 0 and a == abs(g), [Arc(ZERO, QUARTER, closed=True), Arc(QUARTER, FULL_CIRCLE)]),
            (g < 0 and a < abs(g), [Arc(ZERO, FULL_CIRCLE, closed=True)]),
        ]
    return [(number, arcs) for number, (holds, arcs) in enumerate(cases, 1) if holds]


def gamma_of(p: Parameters, acceleration: Fraction, velocity: Fraction) -> Fraction:
    """Return gamma = (c/m) x'' + (k/m) x' of Theorem 7."""
    return p.c / p.m * acceleration + p.k / p.m * velocity


def quarter_turns(s: Any, c: Any) -> Any:
    """Convert an angle, given by sine and cosine, to a rational number in [0, 4) that grows with
    the angle.
    """
    # In each quarter the part of it is |sine| or |cosine| over the sum of both, 0 to 1.
    if s >= 0:
        if c > 0:
            return s / (s + c)
        return 1 - c / (s - c)
    if c < 0:
        return 2 + s / (s + c)
    return 3 + c / (c - s)


def angle(where: Any) -> float:
    """Convert a number that `quarter_turns` returned to the angle in radians."""
    quarter, part = divmod(float(where), 1.0)
    # `part` is sine/(sine + cosine) of the rest, so that its tangent is part/(1 - part).
    return (quarter + atan2(part, 1.0 - part) * 2 / pi) * pi / 2


def root(square: Any) -> Any:
    """Return a square root, exactly where it is rational."""
    if isinstance(square, Fraction):
        top = isqrt(square.numerator)
        bottom = isqrt(square.denominator)
        if top * top == square.numerator and bottom * bottom == square.denominator:
            return Fraction(top, bottom)
    return sqrt(square)


def is_inside(cases: list[tuple[int, list[Arc]]], where: Any) -> bool:
    """Return whether an angle (as `quarter_turns` gives it) is in an arc of the cases."""
    arcs = [arc for _, arcs in cases for arc in arcs]
    return any(arc.low < where < arc.high or (arc.closed and where == arc.low) for arc in arcs)


@cache
def zero_force_contact(
    mapping: str, gamma: Fraction, amplitude: Fraction, s: Fraction, c: Fraction
) -> RationalContact:
    """Return a contact with F = 0 in a mapping's domain, for gamma, B0 Omega/m (`amplitude`), sin
    and cos of theta.
    """
    map_row = MAPS[mapping]
    boundary = map_row.end.boundary
    p = _oscillator(boundary, gamma, amplitude)
    # The force falls with x by k/m: this x makes it 0.
    origin = RationalContact(p, boundary, Fraction(0), s, c)
    return RationalContact(p, boundary, p.m * origin.force(map_row.domain) / p.k, s, c)


@cache
def _oscillator(boundary: int, gamma: Fraction, amplitude: Fraction) -> Parameters:
    """Return parameters with gamma at a belt, and with B0 Omega/m (`amplitude`)."""
    # Any values do for what these two do not fix.
    m = Fraction(2)
    k = Fraction(3)
    Omega = Fraction(3, 2)
    speed = gamma * m / k
    if boundary == 1:
        v1 = speed
        v2 = speed + 5
    else:
        v1 = speed - 5
        v2 = speed
    drive = {"B0": amplitude * m / Omega, "Omega": Omega}
    return Parameters(m=m, c=1, k=k, A0=1, **drive, v1=v1, v2=v2, mu1="1/2", mu2="1/3", FN=2)


DRIVES = (Fraction(3), Fraction(7, 4))
#: gamma over the amplitude: sines of rational points, so that the ends of the windows are among the
#: phases; 0, equality and beyond.
RATIOS = tuple(sorted({s for s, _ in RATIONAL_PHASES} | {Fraction(6, 5), Fraction(-6, 5)}))
#: Pairs of gamma and B0 Omega/m.
PAIRS = [(ratio * size, size) for size in DRIVES for ratio in RATIOS]


class ContactRow(NamedTuple):
    """A comparison at one contact: whether the exact flow grazes there, and whether a printed case
    agrees (`right`).
    """

    case: int  # of the paper's equation, 0 if none holds
    right: bool
    grazes: bool
    fourth_order: bool  # F = G(1) = 0 at |gamma| = |B0| Omega/m


@cache
def rows_of(mapping: str, drives: tuple[Fraction, ...] = DRIVES) -> tuple[ContactRow, ...]:
    """Compare a mapping's printed cases with the flow at all exact contacts whose B0 Omega/m is one
    of `drives`.
    """
    rows = []
    domain = MAPS[mapping].domain
    for amplitude in drives:
        for gamma in (ratio * (abs(amplitude) or 2) for ratio in RATIOS):
            cases = printed_window(mapping, gamma, amplitude) or [(0, [])]
            for s, c in RATIONAL_PHASES:
                contact = zero_force_contact(mapping, gamma, amplitude, s, c)
                grazes = contact.grazes(domain)
                fourth_order = contact.slope(domain) == 0 and abs(gamma) == abs(amplitude)
                for case, arcs in cases:
                    right = is_inside([(case, arcs)], quarter_turns(s, c)) == grazes
                    rows.append(ContactRow(case, right, grazes, fourth_order))
    return tuple(rows)


@cache
def _zero_force_contacts() -> tuple[tuple[int, RationalContact], ...]:
    """Return (domain, contact) for exact contacts with F = 0: of every mapping, with every gamma,
    at every phase.
    """
    return tuple(
        (MAPS[mapping].domain, zero_force_contact(mapping, ratio * 3, Fraction(3), s, c))
        for mapping in PLACES
        for ratio in RATIOS
        for s, c in RATIONAL_PHASES
    )


def window(mapping: str, *scenes: str) -> Evidence:
    """Check a mapping's printed cases, (55) to (58), by the exact flow, and by `check_grazing` in
    shipped `scenes`.
    """
    rows = [row for row in rows_of(mapping) if row.case]
    wrong = [row for row in rows if not row.right]
    generic = sum(not row.fourth_order for row in wrong)
    numbers: dict[str, Any] = {
        "exact contacts (γ, B₀Ω/m, phase)": len(rows),
        "of them grazing": sum(row.grazes for row in rows),
    }
    counts = {case: [row.right for row in rows if row.case == case] for case in range(1, 7)}
    for case, right in counts.items():
        numbers[f"({PLACES[mapping].equation}.{case})"] = f"right at {sum(right)} of {len(right)}"
    ends = _same_ends(mapping)
    numbers |= {
        "wrong, but for tangencies of fourth order": generic,
        "wrong at tangencies of fourth order": len(wrong) - generic,
        "pairs (γ, B₀Ω/m) whose computed window has the printed ends": f"{sum(ends)} of "
        f"{len(ends)}",
    }
    mismatches = 0
    for name in scenes:
        report = check_grazing(load_scene(name).parameters, mapping, n=100)
        mismatches += len(report.mismatches)
        agreed = " / ".join(map(str, report.agreements.values()))
        numbers[
            f"{name}, case {report.case}: phases agreed on by {' / '.join(report.agreements)}"
        ] = agreed
    numbers["phases of these scenes that disagree"] = mismatches
    finding = (
        f"The six cases are right at {len(rows) - len(wrong)} of {len(rows)} exact contacts with F "
        "= 0"
    )
    if wrong:
        finding += (
            f"; at the other {len(wrong)} the flow grazes to fourth order, at the phase that they "
            "exclude"
        )
    each_case_has_contacts = all(counts.values())
    flow_agrees = not generic and not mismatches
    right_elsewhere = flow_agrees and each_case_has_contacts and all(ends)
    return evidence(right_elsewhere, f"{finding}.", numbers, verdict(not wrong, corrected=True))


def _same_ends(mapping: str) -> list[bool]:
    """Say for each pair (gamma, B0 Omega/m) whether `grazing_window` computes the arcs that are
    printed.
    """
    agreed = []
    for gamma, amplitude in PAIRS:
        p = zero_force_contact(mapping, gamma, amplitude, *RATIONAL_PHASES[0]).p
        computed = [
            (low, high, closed)
            for low, high, closed, _ in grazing_window(p, mapping, "paper").intervals
        ]
        for _, arcs in printed_window(mapping, gamma, amplitude):
            printed = [(angle(arc.low), angle(arc.high), arc.closed) for arc in arcs]
            if np.shape(computed) != np.shape(printed):
                agreed.append(False)
            elif not arcs:  # numpy has no maximum of nothing
                agreed.append(True)
            else:
                agreed.append(bool(np.abs(np.subtract(computed, printed)).max() < 1e-14))
    return agreed


def complete(*mappings: str) -> Evidence:
    """Check whether the printed lists of cases cover every pair (gamma, B0 Omega/m > 0), each once."""
    numbers: dict[str, Any] = {}
    missing: set[Fraction] = set()
    several = 0
    grazing = 0
    for mapping in mappings:
        counts = [len(printed_window(mapping, *pair)) for pair in PAIRS]
        without_case = [pair for pair, count in zip(PAIRS, counts, strict=True) if count == 0]
        missing |= {gamma / size for gamma, size in without_case}
        several += sum(count > 1 for count in counts)
        grazing += sum(row.grazes for row in rows_of(mapping) if not row.case)
        equation = f"({PLACES[mapping].equation})"
        numbers[f"{equation}: pairs with exactly one case"] = f"{counts.count(1)} of {len(PAIRS)}"
        shown = ", ".join(f"γ = {gamma}, B₀Ω/m = {size}" for gamma, size in without_case)
        numbers[f"{equation}: pairs with no case"] = shown or "0"
    numbers |= {"pairs with several cases": several, "contacts without a case that graze": grazing}
    if not missing:
        return evidence(not several, "Every pair has exactly one case.", numbers)
    words = ", ".join(
        f"γ = {'−' if ratio == -1 else f'{ratio} '}B₀Ω/m" for ratio in sorted(missing)
    )
    finding = f"No case for {words}; {grazing} of the contacts there graze."
    return evidence(not several, finding, numbers, CORRECTED)


def negative_drive() -> Evidence:
    """Check the printed cases for B0 < 0 and B0 = 0, which nothing in section 2 excludes."""
    numbers: dict[str, Any] = {}
    wrong = 0
    without = 0
    total = 0
    drives = (-DRIVES[0], Fraction(0))  # one below 0, and none
    for mapping, where in PLACES.items():
        rows = [row for row in rows_of(mapping, drives) if not row.fourth_order]
        wrong_cases = [row.case for row in rows if row.case and not row.right]
        cases = ", ".join(f"({where.equation}.{case})" for case in sorted(set(wrong_cases)))
        numbers[f"cases of ({where.equation}) that hold for B₀ ≤ 0 and are wrong"] = cases or "none"
        wrong += len(wrong_cases)
        without += sum(row.case == 0 for row in rows)
        total += len(rows)
    numbers |= {
        "exact contacts with B₀ ≤ 0": total,
        "a printed case holds and is wrong": wrong,
        "no printed case holds": without,
    }
    finding = (
        "With B₀ < 0 and B₀ = 0 there are cases that hold as printed and are wrong, and γ for "
        "which none holds."
    )
    return Evidence(verdict(not wrong and not without, corrected=True), finding, numbers)


def equality() -> Evidence:
    """Check gamma = +-B0 Omega/m: does the flow graze at the phase that (55.2), (56.5), (57.2) and
    (58.5) exclude?
    """
    numbers: dict[str, Any] = {}
    excluded = 0
    returning = 0
    for mapping in PLACES:
        map_row = MAPS[mapping]
        for size in DRIVES:
            # There F, G^(1) and G^(2) vanish where the sine is -gamma/size, its top or bottom.
            gamma = map_row.side * size
            sine = Fraction(-map_row.side)
            contact = zero_force_contact(mapping, gamma, size, sine, Fraction(0))
            excluded += not is_inside(
                printed_window(mapping, gamma, size), quarter_turns(sine, Fraction(0))
            )
            returning += contact.grazes(map_row.domain)
            equal = f"γ = {gamma} = {'-' if map_row.side < 0 else ''}B₀Ω/m"
            values = ", ".join(map(str, contact.derivatives(map_row.domain)))
            numbers[f"{mapping}, {equal}: F, G⁽¹⁾, G⁽²⁾, G⁽³⁾"] = values
    total = len(numbers)
    numbers |= {
        "contacts at the excluded phase": total,
        "printed as no graze": excluded,
        "the flow returns": returning,
    }
    finding = (
        f"At {returning} of {total} contacts at the excluded phase the flow returns to its domain"
    )
    if excluded and returning:
        finding += ": F = G⁽¹⁾ = G⁽²⁾ = 0, a tangency of fourth order, which Theorem 6 does not see"
    return Evidence(verdict(not (excluded and returning), corrected=True), f"{finding}.", numbers)


# --- the contact itself: eqs. (59) to (66), gamma, and the unknowns ---

#: The mappings that can end where a flow grazes: the named one, and the one from the other belt.
ENDS = {"P2": ("P2",), "P3": ("P3", "P7"), "P5": ("P5", "P8"), "P6": ("P6",)}
#: Grazes at these phases, of the oscillators of these figures, are traced back.
TRACED_PHASES = (0.3, 1.3, 2.3, 3.3, 4.4, 5.5)
TRACED = {"fig5": ("P2", "P3", "P5", "P6"), "fig8": ("P3", "P5"), "fig10": ("P5", "P6")}


def without_force() -> Evidence:
    """Check Theorem 7 as printed, without the hypothesis F = 0: does a phase in its set imply a
    graze?
    """
    arrivals = 0
    inside = 0
    example: dict[str, Any] = {}
    for mapping, row in PLACES.items():
        where = MAPS[mapping]
        for contact in contacts(where.end.boundary, 60, seed=70 + row.equation):
            p = contact.p
            force = contact.force(where.domain)
            # The flow of the domain reaches the boundary, and with F not 0 it goes straight
            # through.
            if force * where.side <= 0 or p.B0 <= 0:
                continue
            arrivals += 1
            gamma = gamma_of(p, force, contact.speed)
            amplitude = p.B0 * p.Omega / p.m
            cases = printed_window(mapping, gamma, amplitude)
            if is_inside(cases, quarter_turns(contact.s, contact.c)):
                if contact.grazes(where.domain):
                    raise ArithmeticError("a flow with F not 0 grazes")
                inside += 1
                (case, _) = cases[0]
                example = example or {
                    "one of them": f"{mapping}, ({row.equation}.{case}); {contact}",
                    "γ, B₀Ω/m, F there": f"{gamma}, {amplitude}, {force}",
                    "what the exact flow does there": contact.goes_on,
                }
    numbers = {
        "exact contacts that a flow reaches with F not 0": arrivals,
        "of them with the phase in the printed set": inside,
        "of these grazes": "0",
    } | example
    finding = (
        "With F not 0 the flow of a domain goes straight through the boundary and cannot graze, "
        "but its phase can be in the printed set, as at the exact contact given here."
    )
    return Evidence(verdict(not inside, corrected=True), finding, numbers)


def grazing_inequality() -> Evidence:
    """Check eqs. (61), (62), (65), (66): dF/dt along the flow is -(gamma + (B0 Omega/m) sin(Omega
    t_m)).
    """
    wrong = 0
    differs = 0
    cases = _zero_force_contacts()
    for domain, contact in cases:
        p = contact.p
        force = contact.force(domain)
        s = contact.s
        # The left side of (62) and (66).
        slope = -p.c / p.m * force - p.k / p.m * contact.speed - p.B0 * p.Omega / p.m * s
        _, first_derivative, *_ = contact.derivatives(domain)
        wrong += slope != first_derivative or force != 0
        differs += slope != -(gamma_of(p, force, contact.speed) + p.B0 * p.Omega / p.m * s)
    numbers = {
        "exact contacts": len(cases),
        "F not 0, or (62)/(66) not the derivative of F along the flow": wrong,
        "not -(γ + (B₀Ω/m) sin(Ωtₘ))": differs,
    }
    finding = (
        f"At all {len(cases)} exact contacts (62) and (66) are dF/dt and -(γ + (B₀Ω/m) sin(Ωtₘ))."
    )
    return evidence(not wrong and not differs, finding, numbers)


def gamma_is_fixed() -> Evidence:
    """Check that gamma, which distinguishes the cases, is k v_lambda/m at a graze, where x'' = 0."""
    grazes = [
        (contact, contact.force(domain))
        for domain, contact in _zero_force_contacts()
        if contact.grazes(domain)
    ]
    different = sum(gamma_of(c.p, force, c.speed) != c.p.k * c.speed / c.p.m for c, force in grazes)
    numbers = {"exact grazes": len(grazes), "γ not k v_λ/m": different}
    finding = (
        f"At all {len(grazes)} exact grazes ẍ = 0 and γ = k v_λ/m: the parameters alone choose the "
        "case."
    )
    return evidence(not different, finding, numbers)


def one_unknown_is_free() -> Evidence:
    """Check what is said after (62): three equations have four unknowns, so that one must be given."""
    p = load_scene("fig9").parameters
    ranks = []
    starts = set()
    numbers = {}
    for theta in (0.5, 1.5, 2.5):
        start = grazing_start(p, "P2", theta)
        if not start.found:
            continue
        Omega = float(p.Omega)
        begin = (float(start.x), Omega * float(start.t))
        end = (float(start.x_m), Omega * float(start.t_m))
        gradient = [0, 0, -float(p.k / p.m), -float(p.B0 / p.m) * np.sin(start.theta_m)]
        matrix = np.vstack([jacobian(p, "P2", begin, end), gradient]).astype(float)
        values = np.linalg.svd(matrix, compute_uv=False)
        ranks.append(int((values > 1e-9 * values[0]).sum()))
        starts.add((float(start.x), float(start.theta)))
        numbers[f"graze of P₂ at Ωtₘ = {theta}"] = (
            f"starts at x = {start.x:.8g}, Ωt = {start.theta:.8g}"
        )
        numbers[f"singular values at {theta}"] = ", ".join(f"{value:.3g}" for value in values)
    numbers |= {"equations, unknowns": "3 (f₁, f₂, F), 4", "rank": ", ".join(map(str, ranks))}
    finding = (
        f"The three equations have rank {min(ranks)} at {len(ranks)} grazes of Fig. 9's "
        "oscillator; each given phase has its start."
    )
    return evidence(set(ranks) == {3} and len(starts) == len(ranks), finding, numbers)


def mappings_that_graze() -> Evidence:
    """Flow back from grazes and simulate up to them: are the mappings that end there P2, P3, P5, P6
    (Theorem 7)?
    """
    counts: dict[str, Counter[str]] = {mapping: Counter() for mapping in PLACES}
    case = "none"
    for name, mappings in TRACED.items():
        p = load_scene(name).parameters
        for mapping in mappings:
            window_of_map = grazing_window(p, mapping)
            for theta in filter(window_of_map.contains, TRACED_PHASES):
                start = grazing_start(p, mapping, theta)
                end = Fraction(float(start.t_m)) + Fraction(1, 1000)
                motion = recorded(simulate(p, **start.start, t_end=end, max_events=1))
                if motion.events[0].kind == "graze":
                    label = motion.word[0]
                else:
                    label = "no graze"
                counts[mapping][label] += 1
                if case == "none" and label not in (mapping, "no graze"):
                    begin = (
                        f"x = {float(start.x):.10g}, Ωt = {float(start.theta):.10g} on belt "
                        f"{start.boundary}"
                    )
                    case = (
                        f"{name}: {label} from {begin} grazes belt {MAPS[mapping].end.boundary} at "
                        f"Ωt = {theta}"
                    )
    numbers = {
        f"grazes that the paper calls {mapping}, by the mapping that ends there": ", ".join(
            f"{label} {count}" for label, count in sorted(labels.items())
        )
        for mapping, labels in counts.items()
    } | {"a graze by another mapping": case}
    total = sum(map(Counter.total, counts.values()))
    lost = sum(labels["no graze"] for labels in counts.values())
    if lost or not all(counts.values()):
        return Evidence(UNDECIDED, f"{lost} of {total} grazes could not be followed.", numbers)
    finding = (
        "Flowing back from a graze, the flow comes from the planes of the mapping that the paper "
        "names"
    )
    if any(labels[mapping] < labels.total() for mapping, labels in counts.items()):
        finding += (
            "; in domain 2 also from the other belt, by P₇ or P₈, whose end is the graze then"
        )
    strange = any(set(labels) - set(ENDS[mapping]) for mapping, labels in counts.items())
    return Evidence(verdict(not strange), f"{finding}.", numbers)
