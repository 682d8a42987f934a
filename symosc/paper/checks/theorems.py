"""Section 4: G-functions, Lemmas 1 to 3 and Theorems 4 to 6, against the exact flow near rational contacts.

The lemmas are on any discontinuous system. That their conditions are sufficient is Taylor's theorem; that they are
not necessary one oscillator shows, by a single contact.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from symosc.model import NEIGHBOURS
from symosc.paper.checks.exact import RationalContact, exact_contacts, tally
from symosc.paper.claims import CONFIRMED, CORRECTED, DEFINITION, NOT_AS_PRINTED, Evidence, verdict
from symosc.simulation.simulate import simulate

#: Components of the states of a general system; more bring nothing new.
DIMENSION = 3
Contact = RationalContact


# --- what the paper prints ---


def sliding_condition(towards: Fraction, other: Fraction) -> bool:
    """Eq. (20): G^(0) of the domain that the normal vector points to, and of the other one."""
    return towards < 0 < other


def passing_either_way(normal_to_target: bool, before: Fraction, after: Fraction) -> bool:
    """Eqs. (21) and (22): G^(0) of the domain that the flow leaves, and of the one that it enters."""
    return (before > 0 and after > 0) if normal_to_target else (before < 0 and after < 0)


def tangency_condition(normal_away: bool, value: Fraction, slope: Fraction) -> bool:
    """Eqs. (23) and (24): G^(0) and G^(1) of a domain, with the normal vector away from it or towards it."""
    return value == 0 and (slope < 0 if normal_away else slope > 0)


def stick_condition(below: Fraction, above: Fraction) -> bool:
    """Eqs. (26) and (27), of a stick: F^(below) > 0 > F^(above)."""
    return below > 0 and above < 0


def passing_condition(below: Fraction, above: Fraction) -> bool:
    """Eqs. (34) and (35), of a passage: both forces have the same sign."""
    return below * above > 0


def grazing_condition(from_below: bool, force: Fraction, slope: Fraction) -> bool:
    """Eqs. (38) to (43): F = 0, and dF/dt < 0 for the domain below, > 0 for the one above."""
    return force == 0 and (slope < 0 if from_below else slope > 0)


def g_functions(n: Any, difference: Any, t: Any) -> tuple[Any, Any]:
    """Eqs. (15) and (16), with D for the derivative by t along both flows."""
    first = (n.diff(t).T * difference + n.T * difference.diff(t))[0]
    second = (n.diff(t, 2).T * difference + 2 * n.diff(t).T * difference.diff(t) + n.T * difference.diff(t, 2))[0]
    return first, second


def slope_of_field(contact: Contact, alpha: int) -> Fraction:
    """Eqs. (39), (40), (47), (48): grad F . (x', F) + dF/dt, with F of eq. (9)."""
    p = contact.p
    gradient = -p.k / p.m, -p.c / p.m
    return gradient[0] * contact.speed + gradient[1] * contact.force(alpha) - p.B0 * p.Omega * contact.s / p.m


def slope_along_boundary(contact: Contact, alpha: int) -> Fraction:
    """Left side of eq. (47): D F along the boundary flow, for which (x', x'') is (v_lambda, 0)."""
    p = contact.p
    return -p.k / p.m * contact.speed - p.B0 * p.Omega * contact.s / p.m


#: The paper's name for the time before a contact, in the words after (19).
BEFORE = "tₘ₊"


def all_contacts() -> tuple[Contact, ...]:
    """Return the contacts of both belts."""
    return (*exact_contacts(1), *exact_contacts(2))


# --- definitions of Section 4, by symbols ---


def _vector(name: str, t: Any) -> Any:
    """Return a vector of functions of t."""
    import sympy as sp

    return sp.Matrix([sp.Function(f"{name}{i}")(t) for i in range(DIMENSION)])


def general_system() -> Evidence:
    """Eq. (13) is a definition; the oscillator (10) is such a system."""
    import sympy as sp

    x, v, m, c, k, A, B0, Omega, t = sp.symbols("x v m c k A B0 Omega t")
    field = sp.Matrix([v, (A + B0 * sp.cos(Omega * t) - k * x - c * v) / m])
    linear = field.jacobian([x, v]).diff(x).is_zero_matrix and field.jacobian([x, v]).diff(v).is_zero_matrix
    numbers = {"n for (10)": field.rows, "entries of ∂F/∂(x, ẋ) that depend on x or ẋ": "0" if linear else "some"}
    finding = "(13) lays down the systems that are meant. (10) is one with n = 2, linear in each domain: its solutions "
    return Evidence(DEFINITION, f"{finding}exist for all times, and are smooth as Lemmas 1 to 3 ask.", numbers)


def general_g_functions() -> Evidence:
    """Eqs. (15) and (16) are the first two derivatives of n . (x^(alpha) - x^(0)), by the product rule."""
    import sympy as sp

    t = sp.Symbol("t")
    n, difference = _vector("n", t), _vector("y", t)
    product = (n.T * difference)[0]
    rests = [sp.expand(g - product.diff(t, i)) for i, g in enumerate(g_functions(n, difference, t), 1)]
    numbers = {f"({14 + i}) minus derivative {i} of nᵀ(x⁽ᵅ⁾ − x⁽⁰⁾)": rest for i, rest in enumerate(rests, 1)}
    if any(rests):
        return Evidence(NOT_AS_PRINTED, "They are not these derivatives.", numbers)
    finding = (
        "(15) and (16) are the first and second derivative of nᵀ(x⁽ᵅ⁾ − x⁽⁰⁾) along the flows, for any n(x⁽⁰⁾, t)."
    )
    return Evidence(DEFINITION, finding, numbers)


def normal_vector() -> Evidence:
    """Eqs. (17) and (25): the gradient of phi = x' - v_lambda."""
    import sympy as sp

    x, v, speed = sp.symbols("x v v_lambda")
    normal = tuple(sp.diff(v - speed, variable) for variable in (x, v))
    finding = f"With φ = ẋ − v_λ from (7), (17) gives n = {normal} for both boundaries: it points to the domain above."
    numbers = {"gradient of φ = ẋ − v_λ by (x, ẋ)": normal, "(25)": "(0, 1)"}
    return Evidence(verdict(normal == (0, 1)), finding, numbers)


def reduction() -> Evidence:
    """Eqs. (15), (16) -> (18), (19): what remains at a contact with a fixed plane n . x = const."""
    import sympy as sp

    t, height = sp.symbols("t h")
    n, flow, boundary = sp.Matrix(sp.symbols(f"n0:{DIMENSION}")), _vector("x", t), _vector("b", t)
    # The boundary flow stays in the plane, n . b = const: one component of it follows from the others.
    last = (height - sum(n[i] * boundary[i] for i in range(DIMENSION - 1))) / n[DIMENSION - 1]
    rests = [
        sp.simplify(value.subs({boundary[DIMENSION - 1]: last}).doit() - (n.T * flow.diff(t, order))[0])
        for order, value in enumerate(g_functions(n, flow - boundary, t), 1)
    ]
    numbers = {f"({14 + i}) minus ({17 + i})": rest for i, rest in enumerate(rests, 1)}
    if any(rests):
        return Evidence(NOT_AS_PRINTED, "Something else remains.", numbers)
    finding = "With n constant (15) and (16) are nᵀ(ẋ⁽ᵅ⁾ − ẋ⁽⁰⁾) and nᵀ(ẍ⁽ᵅ⁾ − ẍ⁽⁰⁾); x⁽⁰⁾ stays in the plane nᵀx = "
    return Evidence(CONFIRMED, finding + "const, so that nᵀẋ⁽⁰⁾ = nᵀẍ⁽⁰⁾ = 0, and (18) and (19) remain.", numbers)


# --- at exact contacts ---


def boundary_dimension() -> Evidence:
    """Eq. (14): in which space the boundary is, and its dimension, from contacts of (7)."""
    numbers, inside = {}, True
    for boundary in (1, 2):
        points = np.array([(float(x), float(exact_contacts(boundary)[0].p.belt(boundary))) for x in range(-3, 4)])
        rank = int(np.linalg.matrix_rank(points - points[0]))
        inside = inside and points.shape[1] == rank
        numbers[f"belt {boundary}: coordinates of a point, dimension of the boundary"] = f"{points.shape[1]}, {rank}"
    finding = "A point of the boundary has n = 2 coordinates, the boundary has n − 1 = 1 dimension."
    return Evidence(verdict(inside, corrected=True), finding, numbers)


def time_labels() -> Evidence:
    """The words after (19): which of t_m+ and t_m- is before the contact."""
    passing = before = 0
    for contact in all_contacts():
        lo, hi = NEIGHBOURS[contact.boundary]
        for source, target, side in ((lo, hi, -1), (hi, lo, 1)):
            if contact.passes and contact.next_mode == f"Omega{target}":
                passing += 1
                before += contact.side(source, after=False) == side
    ours = "tₘ₋" if before == passing else "tₘ₊"  # t± = t ± 0, after (17)
    numbers = {
        "exact contacts at which the flow passes": passing,
        "in the domain that it comes from at tₘ − 10⁻⁸": before,
        "the paper's name of the time before": BEFORE,
        "its name by t± = t ± 0, after (17)": ours,
    }
    finding = f"The time before a contact is {ours} by the definition t± = t ± 0, {BEFORE} by the words after (19)."
    return Evidence(verdict(ours == BEFORE, corrected=True), finding, numbers)


def g_functions_are_derivatives() -> Evidence:
    """Eqs. (25), (30), (31), (46) to (48): G^(0) = F and G^(1) = grad F . F + dF/dt, against the series of (5)."""
    values, slopes = [], []
    for contact in (*exact_contacts(1)[:100], *exact_contacts(2)[:100]):
        for alpha in NEIGHBOURS[contact.boundary]:
            first, second, *_ = contact.derivatives(alpha)
            values.append(abs(first - contact.force(alpha)))
            slopes.append(abs(second - slope_of_field(contact, alpha)))
    exact = max(values) == max(slopes) == 0
    numbers = {
        "rational contacts and domains": len(values),
        "largest |ẍ(tₘ) − G⁽⁰⁾|": max(values),
        "largest |d³x/dt³(tₘ) − G⁽¹⁾|": max(slopes),
    }
    finding = "G⁽⁰⁾ and G⁽¹⁾ are the first two derivatives of ẋ along the flow, exactly" if exact else "they differ"
    return Evidence(verdict(exact), f"{finding}, in {len(values)} rational cases.", numbers)


def derivative_along_the_flow() -> Evidence:
    """Eq. (47): its left side by the definition after (16), and its result."""

    def gap(contact: Contact) -> Fraction:
        return slope_of_field(contact, 1) - slope_along_boundary(contact, 1)

    questions = {
        "exact contacts": lambda contact: True,
        "the two sides of (47) differ": gap,
        "their difference is not −(c/m) F⁽¹⁾": lambda c: gap(c) != -c.p.c / c.p.m * c.force(1),
        "they differ where F⁽¹⁾ = 0": lambda c: gap(c) != 0 == c.force(1),
    }
    numbers = tally(exact_contacts(1), questions)
    _, apart, damping, at_zero = numbers.values()
    if not apart:
        return Evidence(CONFIRMED, "The two sides of (47) are the same.", numbers)
    if damping or at_zero:
        return Evidence(NOT_AS_PRINTED, "The two sides of (47) differ by more than −(c/m) F⁽¹⁾.", numbers)
    finding = "The result of (47) minus its left side is −(c/m) F⁽¹⁾, exactly: not 0 in general, and 0 at every graze."
    return Evidence(CORRECTED, finding, numbers)


# --- the lemmas: is a printed "iff" sufficient, and is it necessary? ---


def _slides(contact: Contact) -> bool:
    up = sliding_condition(contact.above, contact.below)  # n = (0, 1) points to the domain above
    return up or sliding_condition(-contact.below, -contact.above)


def _passes(contact: Contact) -> bool:
    up = passing_either_way(True, contact.below, contact.above)
    return up or passing_either_way(False, contact.above, contact.below)


def _is_tangential(contact: Contact) -> bool:
    return any(
        tangency_condition(alpha == contact.boundary, contact.force(alpha), slope_of_field(contact, alpha))
        for alpha in NEIGHBOURS[contact.boundary]
    )


def _grazes(contact: Contact) -> bool:
    return any(contact.grazes(alpha) for alpha in NEIGHBOURS[contact.boundary])


# Printed condition, what the exact flow does, its name, and where the condition is not necessary.
LEMMAS: dict[int, tuple[Callable[[Contact], bool], Callable[[Contact], bool], str, str]] = {
    1: (_slides, lambda contact: contact.sticks, "slides", "where a G⁽⁰⁾ is 0"),
    2: (_passes, lambda contact: contact.passes, "passes", "where a G⁽⁰⁾ is 0"),
    3: (_is_tangential, _grazes, "touches and returns", "where G⁽⁰⁾ = G⁽¹⁾ = 0"),
}


def lemma(which: int) -> Evidence:
    """Lemmas 1 to 3, eqs. (20) to (24), with the normal vector either way."""
    says, does, what, zero = LEMMAS[which]
    cases = [(contact, says(contact), does(contact)) for contact in all_contacts()]
    wrong = [contact for contact, said, done in cases if said and not done]
    missed = [contact for contact, said, done in cases if done and not said]
    numbers: dict[str, Any] = {
        "exact contacts": len(cases),
        f"condition fulfilled, and it {what}": sum(said and done for _, said, done in cases),
        "condition fulfilled, and it does not": len(wrong),
    }
    if wrong:
        return Evidence(NOT_AS_PRINTED, f"Not sufficient: {wrong[0]}.", numbers)
    if not missed:
        return Evidence(CONFIRMED, "Necessary and sufficient at all contacts.", numbers)
    numbers["a contact that is left out"] = missed[0]
    for alpha in NEIGHBOURS[missed[0].boundary]:
        numbers[f"F({alpha}) there, and its derivatives"] = ", ".join(map(str, missed[0].derivatives(alpha)))
    numbers["what the exact flow does there"] = missed[0].goes_on
    finding = (
        f"Sufficient at all contacts. Not necessary: {zero} the next derivative decides, as at the one given here."
    )
    return Evidence(CORRECTED, finding, numbers)


def necessary_and_sufficient() -> Evidence:
    """The abstract: the conditions of stick, non-stick and grazing motions are necessary and sufficient."""
    numbers, verdicts = {}, []
    for which, name in enumerate(("stick (20)", "passing (21), (22)", "grazing (23), (24)"), 1):
        evidence = lemma(which)
        verdicts.append(evidence.verdict)
        numbers[name] = evidence.finding
        numbers[f"{name}: contacts"] = evidence.numbers["exact contacts"]
    if NOT_AS_PRINTED in verdicts:
        return Evidence(NOT_AS_PRINTED, "Not all of them are sufficient.", numbers)
    if CORRECTED in verdicts:
        finding = "All three are sufficient; none is necessary where a G-function that it uses is 0."
        return Evidence(CORRECTED, finding, numbers)
    return Evidence(CONFIRMED, "All three are necessary and sufficient.", numbers)


# --- Theorems 4 to 6 ---


def _a_force_is_zero(contact: Contact) -> bool:
    return contact.below * contact.above == 0


def _force_and_slope_are_zero(contact: Contact) -> bool:
    return any(contact.force(a) == contact.slope(a) == 0 for a in NEIGHBOURS[contact.boundary])


def _sticks_as_printed(contact: Contact) -> bool:
    return stick_condition(contact.below, contact.above)


def _passes_as_printed(contact: Contact) -> bool:
    return passing_condition(contact.below, contact.above)


def _grazes_as_printed(contact: Contact) -> list[bool]:
    """Return whether a contact grazes as printed, for the domain below and for the one above."""
    lo, hi = NEIGHBOURS[contact.boundary]
    return [grazing_condition(a == lo, contact.force(a), slope_of_field(contact, a)) for a in (lo, hi)]


# Printed condition, what the exact flow does, its name, and the equalities that the condition passes over, with theirs.
THEOREMS: dict[int, tuple[Callable[[Contact], bool], Callable[[Contact], bool], str, Callable[[Contact], bool], str]]
THEOREMS = {
    4: (
        _sticks_as_printed, lambda contact: contact.sticks, "sticking",
        _a_force_is_zero, "a force that is exactly 0",
    ),
    5: (
        _passes_as_printed, lambda contact: contact.passes, "passing",
        _a_force_is_zero, "a force that is exactly 0",
    ),
    6: (
        lambda contact: any(_grazes_as_printed(contact)), _grazes, "grazing",
        _force_and_slope_are_zero, "F = 0 and G⁽¹⁾ = 0 together",
    ),
}  # fmt: skip


def theorem(which: int, boundary: int) -> Evidence:
    """Theorems 4 to 6, eqs. (26), (27), (34), (35), (38) to (43): does the exact flow obey the printed "iff"?"""
    printed, true, what, is_degenerate, degenerate = THEOREMS[which]
    cases, simulated = exact_contacts(boundary), _simulated(boundary)
    regular = sum(not is_degenerate(contact) for contact in cases)
    wrong = [contact for contact in cases if printed(contact) != true(contact)]
    generic = [contact for contact in wrong if not is_degenerate(contact)]
    numbers: dict[str, Any] = {
        "rational contacts": len(cases),
        f"of them {what} by the exact flow": sum(map(true, cases)),
        f"without {degenerate}": regular,
        "of these, the flow does otherwise than printed": len(generic),
        "starts at t = 0 that were simulated": len(simulated),
        "of them not as the exact flow": simulated.count(False),
    }
    for contact in (generic or wrong)[:1]:
        numbers["a case"] = contact
        for alpha in NEIGHBOURS[boundary]:
            numbers |= {f"F({alpha}) there": contact.force(alpha), f"G(1,{alpha}) there": contact.slope(alpha)}
        numbers["what happens there"] = contact.goes_on
    if generic or not all(simulated):
        finding = f"Wrong at {len(generic)} of {len(cases)} contacts without {degenerate}."
        return Evidence(NOT_AS_PRINTED, finding, numbers)
    if not wrong:
        return Evidence(CONFIRMED, f"Right at all {len(cases)} contacts.", numbers)
    finding = f"Right at all {regular} contacts without {degenerate}. With it the next derivative that is not 0 "
    finding += "decides; one such contact is given here, where the printed condition fails."
    return Evidence(CORRECTED, finding, numbers)


@cache
def _simulated(boundary: int) -> tuple[bool, ...]:
    """Return for each contact at phase 0 whether `simulate`, started there, agrees with the exact flow."""
    found = []
    for contact in exact_contacts(boundary):
        if contact.s == 0 and contact.c == 1:
            # So short a time later the motion still is as it was at the beginning.
            end = Fraction(1, 10**6)
            motion = simulate(contact.p, t0=0, x0=contact.x, v0=contact.speed, t_end=end, max_events=1)
            found.append(motion.mode(0.0) == contact.next_mode)
    return tuple(found)


def both_sides_at_once() -> Evidence:
    """Eqs. (44) and (45) as they stand: both forces 0 and both inequalities, at one contact."""
    contacts = [c for c in all_contacts() if all(c.slope(alpha) for alpha in NEIGHBOURS[c.boundary])]
    questions = {
        "contacts that graze, with G⁽¹⁾ not 0": _grazes,
        "of them with (44) and (45) on both sides": lambda contact: all(_grazes_as_printed(contact)),
        "of them with (44) and (45) on one side": lambda c: _grazes(c) and any(_grazes_as_printed(c)),
    }
    numbers = tally(contacts, questions)
    grazing, _, each = numbers.values()
    numbers["least F⁽ˡᵒ⁾ − F⁽ʰⁱ⁾ over all contacts"] = min(contact.below - contact.above for contact in contacts)
    finding = f"Read for α = 1 or α = 2, as in Theorem 6, (44) and (45) hold at {each} of {grazing} grazing contacts; "
    return Evidence(verdict(each == grazing), f"{finding}with friction both forces cannot vanish together.", numbers)


def no_third_way() -> Evidence:
    """Between Theorems 4 and 5 nothing is left where no force vanishes: the boundary never repels."""
    questions = {
        "rational contacts with no force 0": lambda contact: True,
        "stick by Theorem 4": _sticks_as_printed,
        "pass by Theorem 5": _passes_as_printed,
        "leave on both sides (F⁽ˡᵒ⁾ < 0 < F⁽ʰⁱ⁾)": lambda contact: contact.below < 0 < contact.above,
        "covered by neither theorem": lambda c: not (_sticks_as_printed(c) or _passes_as_printed(c)),
    }
    numbers = tally((contact for contact in all_contacts() if not _a_force_is_zero(contact)), questions)
    strict, stick, passing, repelled, neither = numbers.values()
    finding = f"{stick} + {passing} of {strict} contacts stick or pass, {neither} do neither."
    return Evidence(verdict(neither == repelled == 0 and stick + passing == strict), finding, numbers)


def grazing_definition() -> Evidence:
    """Before Theorem 7: grazing is a tangency after which the flow returns; what that says where G^(1) = 0 too."""
    kinds = ("F = 0, G⁽¹⁾ ≠ 0", "F = G⁽¹⁾ = 0, G⁽²⁾ ≠ 0", "F = G⁽¹⁾ = G⁽²⁾ = 0")
    returning: list[list[bool]] = [[], [], []]
    for contact in all_contacts():
        for alpha in NEIGHBOURS[contact.boundary]:
            force, first, second, _ = contact.derivatives(alpha)
            if force == 0:
                returning[0 if first else 1 if second else 2].append(contact.grazes(alpha))
    numbers = {
        f"{kind}: contacts, of them the flow returns": f"{len(found)}, {sum(found)}"
        for kind, found in zip(kinds, returning, strict=True)
    }
    finding = f"The definition asks for tangency and return, not for an order: {sum(returning[2])} exact contacts of "
    return Evidence(DEFINITION, f"{finding}fourth order return to their domain, and graze by it.", numbers)
