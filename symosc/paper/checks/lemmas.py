"""Section 4 up to Theorem 4, and eq. (47): G-functions by symbols, Lemmas 1 to 3 at exact contacts of the oscillator.

The lemmas are on any discontinuous system. That their conditions are sufficient is Taylor's theorem; that they are
not necessary one oscillator shows, by a single contact.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from symosc.model import NEIGHBOURS
from symosc.paper.checks.rational_cases import RationalContact, as_text
from symosc.paper.checks.theorems import exact_contacts, slope_of_field
from symosc.paper.evidence import CONFIRMED, CORRECTED, DEFINITION, NOT_AS_PRINTED, Evidence

#: Components of the states of a general system; more bring nothing new.
DIMENSION = 3


# --- what the paper prints ---


def sliding_condition(towards: Fraction, other: Fraction) -> bool:
    """Eq. (20): G^(0) of the domain that the normal vector points to, and of the other one."""
    return towards < 0 < other


def passing_condition(normal_to_target: bool, before: Fraction, after: Fraction) -> bool:
    """Eqs. (21) and (22): G^(0) of the domain that the flow leaves, and of the one that it enters."""
    return (before > 0 and after > 0) if normal_to_target else (before < 0 and after < 0)


def tangency_condition(normal_away: bool, value: Fraction, slope: Fraction) -> bool:
    """Eqs. (23) and (24): G^(0) and G^(1) of a domain, with the normal vector away from it or towards it."""
    return value == 0 and (slope < 0 if normal_away else slope > 0)


def g_functions(n: Any, difference: Any, t: Any) -> tuple[Any, Any]:
    """Eqs. (15) and (16), with D for the derivative by t along both flows."""
    first = (n.diff(t).T * difference + n.T * difference.diff(t))[0]
    second = (n.diff(t, 2).T * difference + 2 * n.diff(t).T * difference.diff(t) + n.T * difference.diff(t, 2))[0]
    return first, second


def along_boundary_flow(contact: RationalContact, alpha: int) -> Fraction:
    """Left side of eq. (47): D F along the boundary flow, for which (x', x'') is (v_lambda, 0)."""
    p = contact.p
    return -p.k / p.m * contact.speed - p.B0 * p.Omega * contact.s / p.m


# --- definitions and what follows from them ---


def _vector(name: str, t: Any) -> Any:
    import sympy as sp

    return sp.Matrix([sp.Function(f"{name}{i}")(t) for i in range(DIMENSION)])


def general_system() -> Evidence:
    """Eq. (13) is a definition; the oscillator (10) is such a system."""
    import sympy as sp

    x, v, m, c, k, A, B0, Omega, t = sp.symbols("x v m c k A B0 Omega t")
    field = sp.Matrix([v, (A + B0 * sp.cos(Omega * t) - k * x - c * v) / m])
    linear = field.jacobian([x, v]).diff(x).is_zero_matrix and field.jacobian([x, v]).diff(v).is_zero_matrix
    numbers = {
        "n for (10)": str(field.rows),
        "entries of ∂F/∂(x, ẋ) that depend on x or ẋ": "0" if linear else "some",
    }
    finding = "(13) lays down the systems that are meant. (10) is one with n = 2, linear in each domain: its solutions "
    return Evidence(DEFINITION, f"{finding}exist for all times, and are smooth as Lemmas 1 to 3 ask.", numbers)


def general_g_functions() -> Evidence:
    """Eqs. (15) and (16) are the first two derivatives of n . (x^(alpha) - x^(0)), by the product rule."""
    import sympy as sp

    t = sp.Symbol("t")
    n, difference = _vector("n", t), _vector("y", t)
    product = (n.T * difference)[0]
    rests = [sp.expand(g - product.diff(t, i)) for i, g in enumerate(g_functions(n, difference, t), 1)]
    numbers = {f"({14 + i}) minus derivative {i} of nᵀ(x⁽ᵅ⁾ − x⁽⁰⁾)": str(rest) for i, rest in enumerate(rests, 1)}
    if any(rests):
        return Evidence(NOT_AS_PRINTED, "They are not these derivatives.", numbers)
    finding = "(15) and (16) are the first and second derivative of nᵀ(x⁽ᵅ⁾ − x⁽⁰⁾) along the flows, for any n(x⁽⁰⁾, t)"
    return Evidence(DEFINITION, f"{finding}.", numbers)


def normal_vector() -> Evidence:
    """Eqs. (17) and (25): the gradient of phi = x' - v_lambda."""
    import sympy as sp

    x, v, speed = sp.symbols("x v v_lambda")
    normal = tuple(sp.diff(v - speed, variable) for variable in (x, v))
    numbers = {"gradient of φ = ẋ − v_λ by (x, ẋ)": str(normal), "(25)": "(0, 1)"}
    right = normal == (0, 1)
    finding = f"With φ = ẋ − v_λ from (7), (17) gives n = {normal} for both boundaries: it points to the domain above"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def reduction() -> Evidence:
    """Eqs. (15), (16) -> (18), (19): what remains at a contact with a fixed plane n . x = const."""
    import sympy as sp

    t, height = sp.symbols("t h")
    n, flow, boundary = sp.Matrix(sp.symbols(f"n0:{DIMENSION}")), _vector("x", t), _vector("b", t)
    values = g_functions(n, flow - boundary, t)
    # The boundary flow stays in the plane, n . b = const: one component of it follows from the others.
    last = (height - sum(n[i] * boundary[i] for i in range(DIMENSION - 1))) / n[DIMENSION - 1]
    staying = {boundary[DIMENSION - 1]: last}
    rests = []
    for order, value in enumerate(values, 1):
        printed = (n.T * flow.diff(t, order))[0]
        rests.append(sp.simplify(value.subs(staying).doit() - printed))
    numbers = {f"({14 + i}) minus ({17 + i})": str(rest) for i, rest in enumerate(rests, 1)}
    finding = "With n constant (15) and (16) are nᵀ(ẋ⁽ᵅ⁾ − ẋ⁽⁰⁾) and nᵀ(ẍ⁽ᵅ⁾ − ẍ⁽⁰⁾); x⁽⁰⁾ stays in the plane nᵀx = "
    finding += "const, so that nᵀẋ⁽⁰⁾ = nᵀẍ⁽⁰⁾ = 0, and (18) and (19) remain"
    if any(rests):
        return Evidence(NOT_AS_PRINTED, "Something else remains.", numbers)
    return Evidence(CONFIRMED, f"{finding}.", numbers)


def derivative_along_the_flow() -> Evidence:
    """Eq. (47): its left side by the definition after (16), and its result."""
    contacts = exact_contacts(1)
    gaps = [(slope_of_field(contact, 1) - along_boundary_flow(contact, 1), contact) for contact in contacts]
    damping = sum(gap != -contact.p.c / contact.p.m * contact.force(1) for gap, contact in gaps)
    apart = sum(gap != 0 for gap, _ in gaps)
    at_zero = sum(gap != 0 for gap, contact in gaps if contact.force(1) == 0)
    numbers = {
        "exact contacts": str(len(contacts)),
        "the two sides of (47) differ": str(apart),
        "their difference is not −(c/m) F⁽¹⁾": str(damping),
        "they differ where F⁽¹⁾ = 0": str(at_zero),
    }
    if not apart:
        return Evidence(CONFIRMED, "The two sides of (47) are the same.", numbers)
    if damping or at_zero:
        return Evidence(NOT_AS_PRINTED, "The two sides of (47) differ by more than −(c/m) F⁽¹⁾.", numbers)
    finding = "The result of (47) minus its left side is −(c/m) F⁽¹⁾, exactly: not 0 in general, and 0 at every graze"
    return Evidence(CORRECTED, f"{finding}.", numbers)


# --- the lemmas ---


def _compare(
    says: Callable[[RationalContact], bool], does: Callable[[RationalContact], bool], what: str, zero: str
) -> Evidence:
    """Compare a printed "iff" with the exact flow: is it sufficient, and is it necessary?"""
    contacts = (*exact_contacts(1), *exact_contacts(2))
    wrong = [contact for contact in contacts if says(contact) and not does(contact)]
    left_out = [contact for contact in contacts if does(contact) and not says(contact)]
    numbers = {
        "exact contacts": str(len(contacts)),
        f"condition fulfilled, and it {what}": str(sum(says(contact) and does(contact) for contact in contacts)),
        "condition fulfilled, and it does not": str(len(wrong)),
    }
    if wrong:
        return Evidence(NOT_AS_PRINTED, f"Not sufficient: {as_text(wrong[0])}.", numbers)
    if not left_out:
        return Evidence(CONFIRMED, "Necessary and sufficient at all contacts.", numbers)
    one = left_out[0]
    numbers["a contact that is left out"] = as_text(one)
    for alpha in NEIGHBOURS[one.boundary]:
        numbers[f"F({alpha}) there, and its derivatives"] = ", ".join(map(str, one.derivatives(alpha)))
    numbers["what the exact flow does there"] = f"goes on {'on' if one.sticks else 'in'} {one.next_mode}"
    finding = f"Sufficient at all contacts. Not necessary: {zero} the next derivative decides, as at the one given here"
    return Evidence(CORRECTED, f"{finding}.", numbers)


def lemma_1() -> Evidence:
    """Lemma 1, eq. (20), with the normal vector either way."""

    def says(contact: RationalContact) -> bool:
        lo, hi = NEIGHBOURS[contact.boundary]
        up = sliding_condition(contact.force(hi), contact.force(lo))  # n = (0, 1) points to the domain above
        down = sliding_condition(-contact.force(lo), -contact.force(hi))
        return up or down

    return _compare(says, lambda contact: contact.sticks, "slides", "where a G⁽⁰⁾ is 0")


def lemma_2() -> Evidence:
    """Lemma 2, eqs. (21) and (22), from the domain below to the one above and back."""

    def says(contact: RationalContact) -> bool:
        lo, hi = NEIGHBOURS[contact.boundary]
        up = passing_condition(True, contact.force(lo), contact.force(hi))
        return up or passing_condition(False, contact.force(hi), contact.force(lo))

    return _compare(says, lambda contact: contact.passes, "passes", "where a G⁽⁰⁾ is 0")


def lemma_3() -> Evidence:
    """Lemma 3, eqs. (23) and (24), for both domains of a boundary."""

    def says(contact: RationalContact) -> bool:
        return any(
            tangency_condition(alpha == contact.boundary, contact.force(alpha), slope_of_field(contact, alpha))
            for alpha in NEIGHBOURS[contact.boundary]
        )

    def does(contact: RationalContact) -> bool:
        return any(contact.grazes(alpha) for alpha in NEIGHBOURS[contact.boundary])

    return _compare(says, does, "touches and returns", "where G⁽⁰⁾ = G⁽¹⁾ = 0")


def necessary_and_sufficient() -> Evidence:
    """The abstract: the conditions of stick, non-stick and grazing motions are necessary and sufficient."""
    numbers, verdicts = {}, []
    for name, check in (("stick (20)", lemma_1), ("passing (21), (22)", lemma_2), ("grazing (23), (24)", lemma_3)):
        evidence = check()
        verdicts.append(evidence.verdict)
        numbers[name] = evidence.finding
        numbers[f"{name}: contacts"] = evidence.numbers["exact contacts"]
    if NOT_AS_PRINTED in verdicts:
        return Evidence(NOT_AS_PRINTED, "Not all of them are sufficient.", numbers)
    if CORRECTED in verdicts:
        finding = "All three are sufficient; none is necessary where a G-function that it uses is 0"
        return Evidence(CORRECTED, f"{finding}.", numbers)
    return Evidence(CONFIRMED, "All three are necessary and sufficient.", numbers)
