"""Section 4: G-functions, Lemmas 1 to 3 and Theorems 4 to 6, against the exact flow near rational
contacts.

The lemmas are on any discontinuous system. That their conditions are sufficient is Taylor's
theorem; that they are not necessary one oscillator shows, by a single contact.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from symosc.model import Parameters
from symosc.paper.checks.exact import RationalContact, contacts, tally
from symosc.paper.claims import CONFIRMED, CORRECTED, DEFINITION, Evidence, evidence, verdict
from symosc.simulation.simulate import simulate

#: Components of the states of a general system; more bring nothing new.
DIMENSION = 3
#: The paper's name for the time before a contact, in the words after (19).
BEFORE = "tₘ₊"


# --- what the paper prints ---


#: Conditions on F^(below) and F^(above). Eq. (20) has the normal vector to either side.
CONDITIONS: dict[str, Callable[[Fraction, Fraction], bool]] = {
    "slides, (20)": lambda below, above: above < 0 < below or -below < 0 < -above,
    "passes, (21), (22)": lambda below, above: (
        (below > 0 and above > 0) or (above < 0 and below < 0)
    ),
    "sticks, (26), (27)": lambda below, above: below > 0 and above < 0,
    "passes, (34), (35)": lambda below, above: below * above > 0,
}


def grazing_condition(from_below: bool, force: Fraction, slope: Fraction) -> bool:
    """Return whether (23), (24), (38) to (43) hold: F = 0, and its slope G^(1) < 0 (domain below)
    or > 0 (above).
    """
    return force == 0 and (slope < 0 if from_below else slope > 0)


def g_functions(n: Any, difference: Any, t: Any) -> tuple[Any, Any]:
    """Return the right sides of (15) and (16) for a normal vector n(t) and `difference` =
    x^(alpha)(t) - x^(0)(t).
    """
    # Each is a matrix of one entry.
    (first,) = n.diff(t).T * difference + n.T * difference.diff(t)
    (second,) = (
        n.diff(t, 2).T * difference
        + 2 * n.diff(t).T * difference.diff(t)
        + n.T * difference.diff(t, 2)
    )
    return first, second


def slope_of_field(contact: RationalContact, alpha: int) -> Fraction:
    """Return G^(1) by eqs. (39), (40), (47), (48): grad F . (x', F) + dF/dt, with F of eq. (9)."""
    p = contact.p
    return (
        -p.k / p.m * contact.speed
        - p.c / p.m * contact.force(alpha)
        - p.B0 * p.Omega * contact.s / p.m
    )


def slope_along_boundary(contact: RationalContact, alpha: int) -> Fraction:
    """Return the left side of (47), the derivative of F along the boundary, where (x', x'') is
    (v_lambda, 0).
    """
    p = contact.p
    return -p.k / p.m * contact.speed - p.B0 * p.Omega * contact.s / p.m


def all_contacts() -> tuple[RationalContact, ...]:
    """Return random rational contacts with both belts, which Theorems 4 to 6 are checked at."""
    return (*contacts(1), *contacts(2))


# --- definitions of Section 4, by symbols ---


def _vector(name: str, t: Any) -> Any:
    """Return a symbolic vector of the functions name0(t), name1(t), ..."""
    import sympy as sp

    return sp.Matrix([sp.Function(f"{name}{i}")(t) for i in range(DIMENSION)])


def general_system() -> Evidence:
    """Check that the oscillator (10) is a system of the kind that eq. (13) defines."""
    import sympy as sp

    x, v, m, c, k, A, B0, Omega, t = sp.symbols("x v m c k A B0 Omega t")
    field = sp.Matrix([v, (A + B0 * sp.cos(Omega * t) - k * x - c * v) / m])
    linear = all(field.jacobian([x, v]).diff(letter).is_zero_matrix for letter in (x, v))
    numbers = {
        "n for (10)": field.rows,
        "entries of ∂F/∂(x, ẋ) that depend on x or ẋ": "0" if linear else "some",
    }
    finding = (
        "(13) lays down the systems that are meant. (10) is one with n = 2, linear in each domain: "
        "its solutions exist for all times, and are smooth as Lemmas 1 to 3 ask."
    )
    return Evidence(DEFINITION, finding, numbers)


def general_g_functions() -> Evidence:
    """Check that (15) and (16) are the first two derivatives of the product of n and x^(alpha) -
    x^(0), by the product rule.
    """
    import sympy as sp

    t = sp.Symbol("t")
    n = _vector("n", t)
    difference = _vector("y", t)
    (product,) = n.T * difference
    rests = [
        sp.expand(g - product.diff(t, order))
        for order, g in enumerate(g_functions(n, difference, t), 1)
    ]
    # (15) is the first derivative, (16) the second.
    numbers = {
        f"({14 + order}) minus derivative {order} of nᵀ(x⁽ᵅ⁾ − x⁽⁰⁾)": rest
        for order, rest in enumerate(rests, 1)
    }
    finding = (
        "(15) and (16) are the first and second derivative of nᵀ(x⁽ᵅ⁾ − x⁽⁰⁾) along the flows, for "
        "any n(x⁽⁰⁾, t)."
    )
    return evidence(not any(rests), finding, numbers, DEFINITION)


def normal_vector() -> Evidence:
    """Check the normal vector of eqs. (17) and (25): the gradient of phi = x' - v_lambda."""
    import sympy as sp

    x, v, speed = sp.symbols("x v v_lambda")
    normal = tuple(sp.diff(v - speed, variable) for variable in (x, v))
    finding = (
        f"With φ = ẋ − v_λ from (7), (17) gives n = {normal} for both boundaries: it points to the "
        "domain above."
    )
    numbers = {"gradient of φ = ẋ − v_λ by (x, ẋ)": normal, "(25)": "(0, 1)"}
    return evidence(normal == (0, 1), finding, numbers)


def reduced_g_functions() -> Evidence:
    """Check that (15), (16) reduce to (18), (19) at a contact with a fixed plane n . x = const."""
    import sympy as sp

    t, height = sp.symbols("t h")
    n = sp.Matrix(sp.symbols(f"n0:{DIMENSION}"))
    flow = _vector("x", t)
    boundary = _vector("b", t)
    # The boundary flow stays in the plane, n . b = const: one component of it follows from the
    # others.
    last = DIMENSION - 1
    last_component = (height - sum(n[i] * boundary[i] for i in range(last))) / n[last]
    differences = []
    for order, value in enumerate(g_functions(n, flow - boundary, t), 1):
        (reduced,) = n.T * flow.diff(t, order)
        in_plane = value.subs({boundary[last]: last_component}).doit()
        differences.append(sp.simplify(in_plane - reduced))
    # (15) and (16) against (18) and (19).
    numbers = {
        f"({14 + i}) minus ({17 + i})": difference for i, difference in enumerate(differences, 1)
    }
    finding = (
        "With n constant (15) and (16) are nᵀ(ẋ⁽ᵅ⁾ − ẋ⁽⁰⁾) and nᵀ(ẍ⁽ᵅ⁾ − ẍ⁽⁰⁾); x⁽⁰⁾ stays in the "
        "plane nᵀx = const, so that nᵀẋ⁽⁰⁾ = nᵀẍ⁽⁰⁾ = 0, and (18) and (19) remain."
    )
    return evidence(not any(differences), finding, numbers)


def boundary_dimension() -> Evidence:
    """Check eq. (14): in which space the boundary is, and its dimension, from points of the
    boundary (7).
    """
    numbers = {}
    inside = True
    for boundary in (1, 2):
        contact = contacts(boundary)[0]  # any one: its belt's speed is what counts
        points = np.array([(float(x), float(contact.speed)) for x in range(-3, 4)])
        rank = int(np.linalg.matrix_rank(points - points[0]))
        inside = inside and points.shape[1] == rank
        numbers[f"belt {boundary}: coordinates of a point, dimension of the boundary"] = (
            f"{points.shape[1]}, {rank}"
        )
    finding = "A point of the boundary has n = 2 coordinates, the boundary has n − 1 = 1 dimension."
    return Evidence(verdict(inside, corrected=True), finding, numbers)


def time_before_and_after() -> Evidence:
    """Check the words after (19): which of t_m+ and t_m- is before the contact."""
    passing = 0
    before = 0
    for contact in all_contacts():
        # The lower domain is on the side -1 of the belt, the upper one on the side 1.
        lo, hi = contact.domains
        for source, target, side in ((lo, hi, -1), (hi, lo, 1)):
            if contact.passes and contact.next_mode == f"Omega{target}":
                passing += 1
                before += contact.side(source, after=False) == side
    # By t± = t ± 0, after (17), minus is the time before.
    if before == passing:
        time_before = "tₘ₋"
    else:
        time_before = "tₘ₊"
    numbers = {
        "exact contacts at which the flow passes": passing,
        "in the domain that it comes from at tₘ − 10⁻⁸": before,
        "the paper's name of the time before": BEFORE,
        "its name by t± = t ± 0, after (17)": time_before,
    }
    finding = (
        f"The time before a contact is {time_before} by the definition t± = t ± 0, {BEFORE} by the "
        "words after (19)."
    )
    return Evidence(verdict(time_before == BEFORE, corrected=True), finding, numbers)


def g_functions_are_derivatives() -> Evidence:
    """Check G^(0) = F, G^(1) = grad F . F + dF/dt of eqs. (25), (30), (31), (46) to (48) by the
    power series of (5).
    """
    values = []
    slopes = []
    for contact in (*contacts(1)[:100], *contacts(2)[:100]):
        for alpha in contact.domains:
            first, second, *_ = contact.derivatives(alpha)
            values.append(abs(first - contact.force(alpha)))
            slopes.append(abs(second - slope_of_field(contact, alpha)))
    numbers = {
        "rational contacts and domains": len(values),
        "largest |ẍ(tₘ) − G⁽⁰⁾|": max(values),
        "largest |d³x/dt³(tₘ) − G⁽¹⁾|": max(slopes),
    }
    finding = (
        "G⁽⁰⁾ and G⁽¹⁾ are the first two derivatives of ẋ along the flow, exactly, in "
        f"{len(values)} rational cases."
    )
    return evidence(max(values) == max(slopes) == 0, finding, numbers)


def derivative_along_the_flow() -> Evidence:
    """Check whether the left side of (47), by the definition after (16), is equal to its printed
    result.
    """

    def gap(contact: RationalContact) -> Fraction:
        return slope_of_field(contact, 1) - slope_along_boundary(contact, 1)

    questions = {
        "exact contacts": lambda contact: True,
        "the two sides of (47) differ": gap,
        "their difference is not −(c/m) F⁽¹⁾": lambda contact: (
            gap(contact) != -contact.p.c / contact.p.m * contact.force(1)
        ),
        "they differ where F⁽¹⁾ = 0": lambda contact: gap(contact) != 0 == contact.force(1),
    }
    numbers = tally(contacts(1), questions)
    _, apart, damping, at_zero = numbers.values()
    if not apart:
        return Evidence(CONFIRMED, "The two sides of (47) are the same.", numbers)
    finding = (
        "The result of (47) minus its left side is −(c/m) F⁽¹⁾, exactly: not 0 in general, and 0 "
        "at every graze."
    )
    return evidence(not damping and not at_zero, finding, numbers, CORRECTED)


# --- Lemmas 1 to 3 and Theorems 4 to 6: is a printed "iff" sufficient, and is it necessary? ---


def _grazes_as_printed(contact: RationalContact) -> list[bool]:
    """Return whether the printed condition of a graze holds at a contact, for the domain below and
    the one above.
    """
    lo, hi = contact.domains
    return [
        grazing_condition(a == lo, contact.force(a), slope_of_field(contact, a)) for a in (lo, hi)
    ]


def _grazes(contact: RationalContact) -> bool:
    return any(contact.grazes(alpha) for alpha in contact.domains)


def _both_come(contact: RationalContact) -> bool:
    """Return what Lemma 1 supposes: the flows of both domains come to the boundary."""
    lo, hi = contact.domains
    return contact.side(lo, after=False) < 0 < contact.side(hi, after=False)


def _as_printed(contact: RationalContact, name: str) -> bool:
    if name == "grazes":
        return any(_grazes_as_printed(contact))
    return CONDITIONS[name](*contact.forces)


#: At t = pi the flow of domain 1 comes to belt 1 with F = G^(1) = 0 < G^(2), that of domain 2 with
#: F < 0: the mass sticks, though F^(1) is not positive.
HELD_WITHOUT_FORCE = RationalContact(
    Parameters(m=1, c=1, k=1, A0=0, B0=1, Omega=1, v1=0, v2=5, mu1="1/10", mu2="1/10", FN=1),
    boundary=1,
    x=Fraction(-4, 5),
    s=Fraction(0),
    c=Fraction(-1),
)


class Statement(NamedTuple):
    """A lemma or theorem: what it says of a contact, and where that is not necessary."""

    condition: str  # the printed one: a key of CONDITIONS, or "grazes"
    holds: Callable[[RationalContact], bool]  # whether the exact flow does it
    action: str  # what it does
    exception: str  # where the condition is not necessary


LEMMAS: dict[int, Statement] = {
    1: Statement(
        "slides, (20)",
        lambda contact: contact.sticks and _both_come(contact),
        "slides",
        "where a G⁽⁰⁾ is 0",
    ),
    2: Statement(
        "passes, (21), (22)", lambda contact: contact.passes, "passes", "where a G⁽⁰⁾ is 0"
    ),
    3: Statement("grazes", _grazes, "touches and returns", "where G⁽⁰⁾ = G⁽¹⁾ = 0"),
}
THEOREMS: dict[int, Statement] = {
    4: Statement(
        "sticks, (26), (27)",
        lambda contact: contact.sticks,
        "sticking",
        "a force that is exactly 0",
    ),
    5: Statement(
        "passes, (34), (35)", lambda contact: contact.passes, "passing", "a force that is exactly 0"
    ),
    6: Statement("grazes", _grazes, "grazing", "F = 0 and G⁽¹⁾ = 0 together"),
}


@cache
def lemma(which: int) -> Evidence:
    """Check Lemma 1, 2 or 3, eqs. (20) to (24), with the normal vector in either direction."""
    condition, holds, action, exception = LEMMAS[which]
    cases = [
        (contact, _as_printed(contact, condition), holds(contact))
        for contact in (HELD_WITHOUT_FORCE, *all_contacts())
    ]
    wrong = sum(printed and not true for _, printed, true in cases)
    missed = [contact for contact, printed, true in cases if true and not printed]
    numbers: dict[str, Any] = {
        "exact contacts": len(cases),
        f"condition fulfilled, and it {action}": sum(
            printed and true for _, printed, true in cases
        ),
        "condition fulfilled, and it does not": wrong,
    }
    if wrong or not missed:
        return evidence(not wrong, "Necessary and sufficient at all contacts.", numbers)
    example = missed[0]
    numbers["a contact that is left out"] = example
    for alpha in example.domains:
        numbers[f"F({alpha}) there, and its derivatives"] = ", ".join(
            map(str, example.derivatives(alpha))
        )
    numbers["what the exact flow does there"] = example.goes_on
    finding = (
        f"Sufficient at all contacts. Not necessary: {exception} the next derivative decides, as "
        "at the one given here."
    )
    return Evidence(CORRECTED, finding, numbers)


def necessary_and_sufficient() -> Evidence:
    """Check the abstract: the conditions of stick, non-stick and grazing motions are necessary and
    sufficient.
    """
    numbers = {}
    verdicts = []
    for which, name in enumerate(("stick (20)", "passing (21), (22)", "grazing (23), (24)"), 1):
        result = lemma(which)
        verdicts.append(result.verdict)
        numbers[name] = result.finding
        numbers[f"{name}: contacts"] = result.numbers["exact contacts"]
    finding = "All three are sufficient; none is necessary where a G-function that it uses is 0."
    return evidence(set(verdicts) == {CORRECTED}, finding, numbers, CORRECTED)


def theorem(which: int, boundary: int) -> Evidence:
    """Check the "iff" of Theorem 4, 5 or 6, eqs. (26), (27), (34), (35), (38) to (43), against the
    exact flow.
    """
    condition, holds, action, exception = THEOREMS[which]
    cases = contacts(boundary)
    simulated = _simulated(boundary)

    def is_degenerate(contact: RationalContact) -> bool:
        # Every graze has F = 0: an exception to Theorem 6 has G^(1) = 0 as well.
        return any(
            contact.force(a) == 0 and (which < 6 or contact.slope(a) == 0) for a in contact.domains
        )

    regular = sum(not is_degenerate(contact) for contact in cases)
    wrong = [contact for contact in cases if _as_printed(contact, condition) != holds(contact)]
    generic = [contact for contact in wrong if not is_degenerate(contact)]
    numbers: dict[str, Any] = {
        "rational contacts": len(cases),
        f"of them {action} by the exact flow": sum(map(holds, cases)),
        f"without {exception}": regular,
        "of these, the flow does otherwise than printed": len(generic),
        "starts at t = 0 that were simulated": len(simulated),
        "of them not as the exact flow": simulated.count(False),
    }
    for contact in (generic or wrong)[:1]:
        numbers["a case"] = contact
        for alpha in contact.domains:
            numbers |= {
                f"F({alpha}) there": contact.force(alpha),
                f"G(1,{alpha}) there": contact.slope(alpha),
            }
        numbers["what happens there"] = contact.goes_on
    finding = (
        f"Right at all {regular} contacts without {exception}. With it the next derivative that "
        "is not 0 decides; one such contact is given here, where the printed condition fails."
    )
    return evidence(
        not generic and all(simulated), finding, numbers, verdict(not wrong, corrected=True)
    )


@cache
def _simulated(boundary: int) -> tuple[bool, ...]:
    """Return for each contact at phase 0 whether `simulate`, started there, agrees with the exact
    flow.
    """
    agreed = []
    for contact in contacts(boundary):
        if contact.s == 0 and contact.c == 1:
            # So short a time later the motion still is as it was at the beginning.
            end = Fraction(1, 10**6)
            motion = simulate(
                contact.p, t0=0, x0=contact.x, v0=contact.speed, t_end=end, max_events=1
            )
            agreed.append(motion.mode(0.0) == contact.next_mode)
    return tuple(agreed)


def theorem_6_both_sides() -> Evidence:
    """Check eqs. (44) and (45) as printed: can both forces be 0 and both inequalities hold at one
    contact?
    """
    questions = {
        "contacts that graze, with G⁽¹⁾ not 0": _grazes,
        "of them with (44) and (45) on both sides": lambda contact: all(
            _grazes_as_printed(contact)
        ),
        "of them with (44) and (45) on one side": lambda contact: (
            _grazes(contact) and any(_grazes_as_printed(contact))
        ),
    }
    # Those with G^(1) not 0 on both sides.
    cases = [
        contact
        for contact in all_contacts()
        if all(contact.slope(alpha) for alpha in contact.domains)
    ]
    numbers = tally(cases, questions)
    grazing, _, on_one_side = numbers.values()
    differences = [below - above for below, above in (contact.forces for contact in cases)]
    numbers["least F⁽ˡᵒ⁾ − F⁽ʰⁱ⁾ over all contacts"] = min(differences)
    finding = (
        f"Read for α = 1 or α = 2, as in Theorem 6, (44) and (45) hold at {on_one_side} of "
        f"{grazing} grazing contacts; with friction both forces cannot vanish together."
    )
    return evidence(on_one_side == grazing, finding, numbers)


def no_repelling_boundary() -> Evidence:
    """Check that each contact with no force 0 sticks (Theorem 4) or passes (Theorem 5): the
    boundary never repels.
    """
    stick_by_4 = CONDITIONS["sticks, (26), (27)"]
    pass_by_5 = CONDITIONS["passes, (34), (35)"]

    def repels(forces: tuple[Fraction, Fraction]) -> bool:
        below, above = forces
        return below < 0 < above

    questions: dict[str, Callable[[Any], Any]] = {
        "rational contacts with no force 0": lambda forces: True,
        "stick by Theorem 4": lambda forces: stick_by_4(*forces),
        "pass by Theorem 5": lambda forces: pass_by_5(*forces),
        "leave on both sides (F⁽ˡᵒ⁾ < 0 < F⁽ʰⁱ⁾)": repels,
        "covered by neither theorem": lambda forces: (
            not (stick_by_4(*forces) or pass_by_5(*forces))
        ),
    }
    numbers = tally(
        (contact.forces for contact in all_contacts() if all(contact.forces)), questions
    )
    strict, stick, passing, repelled, neither = numbers.values()
    finding = f"{stick} + {passing} of {strict} contacts stick or pass, {neither} do neither."
    return evidence(neither == repelled == 0 and stick + passing == strict, finding, numbers)


def grazing_definition() -> Evidence:
    """Check whether contacts with G^(1) = 0 graze by the definition before Theorem 7: a tangent
    flow that returns.
    """
    kinds = ("F = 0, G⁽¹⁾ ≠ 0", "F = G⁽¹⁾ = 0, G⁽²⁾ ≠ 0", "F = G⁽¹⁾ = G⁽²⁾ = 0")
    # For each of the `kinds`: whether the flow returns, at each such contact.
    by_kind: tuple[list[bool], list[bool], list[bool]] = ([], [], [])
    first_order, second_order, third_order = by_kind
    for contact in all_contacts():
        for alpha in contact.domains:
            force, slope, curvature, _ = contact.derivatives(alpha)
            if force != 0:
                continue
            if slope:
                returns = first_order
            elif curvature:
                returns = second_order
            else:
                returns = third_order
            returns.append(contact.grazes(alpha))
    numbers = {
        f"{kind}: contacts, of them the flow returns": f"{len(returns)}, {sum(returns)}"
        for kind, returns in zip(kinds, by_kind, strict=True)
    }
    finding = (
        f"The definition asks for tangency and return, not for an order: {sum(third_order)} exact "
        "contacts of fourth order return to their domain, and graze by it."
    )
    return Evidence(DEFINITION, finding, numbers)
