"""Theorem 7: the printed cases (55) to (58) against the exact flow at rational contacts."""

from __future__ import annotations

from fractions import Fraction
from math import atan2, pi
from typing import Any

from symosc.grazing.check import check_grazing
from symosc.grazing.window import grazing_window
from symosc.mappings.theorem7_cases import PLACES
from symosc.paper.checks.printed_cases import DRIVES, RATIOS, contains, printed_window, rows_of, touching, turn
from symosc.paper.checks.rational_cases import RATIONAL_PHASES
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, Evidence
from symosc.scenes import load_scene

CHECKED_PHASES = 100
# Ends of computed windows are the nearest doubles.
WINDOW_TOLERANCE = 1e-14


def _window(mapping: str, scenes: tuple[str, ...]) -> Evidence:
    """Compare the printed cases with the exact flow, and the computed windows with three numerical ways."""
    rows = [row for row in rows_of(mapping) if row.case]
    wrong = [row for row in rows if not row.right]
    generic = [row for row in wrong if not row.fourth_order]
    equation = PLACES[mapping].equation
    numbers = {
        "exact contacts (γ, B₀Ω/m, phase)": str(len(rows)),
        "of them grazing": str(sum(row.grazes for row in rows)),
    }
    for case in range(1, 7):
        inside = [row for row in rows if row.case == case]
        numbers[f"({equation}.{case})"] = f"right at {sum(row.right for row in inside)} of {len(inside)}"
    numbers["wrong, but for tangencies of fourth order"] = str(len(generic))
    numbers["wrong at tangencies of fourth order"] = str(len(wrong) - len(generic))
    ends = _same_ends(mapping)
    numbers["pairs (γ, B₀Ω/m) whose computed window has the printed ends"] = f"{sum(ends)} of {len(ends)}"
    mismatches = 0
    for name in scenes:
        report = check_grazing(load_scene(name).parameters, mapping, n=CHECKED_PHASES)
        mismatches += len(report.mismatches)
        agreed = " / ".join(str(count) for count in report.agreements.values())
        numbers[f"{name}, case {report.case}: phases agreed on by {' / '.join(report.agreements)}"] = agreed
    numbers["phases of these scenes that disagree"] = str(mismatches)
    empty = [case for case in range(1, 7) if not any(row.case == case for row in rows)]
    if generic or mismatches or empty or not all(ends):
        finding = f"Wrong at {len(generic)} contacts, {ends.count(False)} windows have other ends"
        return Evidence(NOT_AS_PRINTED, f"{finding}.", numbers)
    finding = f"The six cases are right at {len(rows) - len(wrong)} of {len(rows)} exact contacts with F = 0"
    if not wrong:
        return Evidence(CONFIRMED, f"{finding}.", numbers)
    finding += f"; at the other {len(wrong)} the flow grazes to fourth order, at the phase that they exclude"
    return Evidence(CORRECTED, f"{finding}.", numbers)


def _same_ends(mapping: str) -> list[bool]:
    """Tell for each pair with a printed case whether `grazing_window`, order "paper", has the printed arcs."""
    found = []
    for amplitude in DRIVES:
        for gamma in (ratio * amplitude for ratio in RATIOS):
            p = touching(mapping, gamma, amplitude, *RATIONAL_PHASES[0]).p
            ours = [(low, high, closed) for low, high, closed, _ in grazing_window(p, mapping, "paper").intervals]
            for _, arcs in printed_window(mapping, gamma, amplitude):
                printed = [(_angle(arc.low), _angle(arc.high), arc.closed) for arc in arcs]
                found.append(
                    len(ours) == len(printed)
                    and all(
                        abs(a[0] - b[0]) + abs(a[1] - b[1]) < WINDOW_TOLERANCE and a[2] == b[2]
                        for a, b in zip(ours, printed, strict=True)
                    )
                )
    return found


def _angle(where: Any) -> float:
    """Return the angle in radians that `turn` gives as `where`."""
    quarter, part = divmod(float(where), 1.0)
    return (quarter + atan2(part, 1.0 - part) * 2 / pi) * pi / 2


def window_p2() -> Evidence:
    """Theorem 7 (i), eq. (55)."""
    return _window("P2", ("fig7-corrected", "fig9"))


def window_p3() -> Evidence:
    """Theorem 7 (ii), eq. (56)."""
    return _window("P3", ("fig8", "fig10"))


def window_p5() -> Evidence:
    """Theorem 7 (iii), eq. (57)."""
    return _window("P5", ("fig8", "fig9"))


def window_p6() -> Evidence:
    """Theorem 7 (iv), eq. (58)."""
    return _window("P6", ("fig8", "fig10"))


def _complete(mappings: tuple[str, ...]) -> Evidence:
    """Count the cases of the printed lists that hold for each pair (gamma, B0 Omega/m > 0)."""
    numbers: dict[str, str] = {}
    missing: set[Fraction] = set()
    several = grazing = 0
    for mapping in mappings:
        pairs = [(ratio * size, size) for size in DRIVES for ratio in RATIOS]
        held = {pair: len(printed_window(mapping, *pair)) for pair in pairs}
        none = [pair for pair, count in held.items() if count == 0]
        missing |= {gamma / size for gamma, size in none}
        several += sum(count > 1 for count in held.values())
        grazing += sum(row.grazes for row in rows_of(mapping) if not row.case)
        equation = PLACES[mapping].equation
        numbers[f"({equation}): pairs with exactly one case"] = f"{list(held.values()).count(1)} of {len(pairs)}"
        pairs_shown = ", ".join(f"γ = {gamma}, B₀Ω/m = {size}" for gamma, size in none)
        numbers[f"({equation}): pairs with no case"] = pairs_shown or "0"
    numbers |= {"pairs with several cases": str(several), "contacts without a case that graze": str(grazing)}
    if several:
        return Evidence(NOT_AS_PRINTED, f"{several} pairs have several cases.", numbers)
    if not missing:
        return Evidence(CONFIRMED, "Every pair has exactly one case.", numbers)
    words = ", ".join(f"γ = {'−' if ratio == -1 else f'{ratio} '}B₀Ω/m" for ratio in sorted(missing))
    finding = f"No case for {words}; {grazing} of the contacts there graze"
    return Evidence(CORRECTED, f"{finding}.", numbers)


def cases_from_below() -> Evidence:
    """Whether (55) and (57) cover every gamma for B0 > 0."""
    return _complete(("P2", "P5"))


def cases_from_above() -> Evidence:
    """Whether (56) and (58) cover every gamma for B0 > 0."""
    return _complete(("P3", "P6"))


def negative_drive() -> Evidence:
    """The printed cases for B0 < 0 and B0 = 0, which nothing in Section 2 excludes."""
    numbers = {}
    wrong = without = total = 0
    for mapping, where in PLACES.items():
        rows = [row for row in rows_of(mapping, (-DRIVES[0], Fraction(0))) if not row.fourth_order]
        bad = sorted({row.case for row in rows if row.case and not row.right})
        cases = ", ".join(f"({where.equation}.{case})" for case in bad)
        numbers[f"cases of ({where.equation}) that hold for B₀ ≤ 0 and are wrong"] = cases or "none"
        wrong += sum(row.case > 0 and not row.right for row in rows)
        without += sum(row.case == 0 for row in rows)
        total += len(rows)
    numbers |= {
        "exact contacts with B₀ ≤ 0": str(total),
        "a printed case holds and is wrong": str(wrong),
        "no printed case holds": str(without),
    }
    finding = "With B₀ < 0 and B₀ = 0 there are cases that hold as printed and are wrong, and γ for which none holds"
    return Evidence(CORRECTED if wrong or without else CONFIRMED, f"{finding}.", numbers)


def equality() -> Evidence:
    """gamma = +-B0 Omega/m: is the phase that (55.2), (56.5), (57.2) and (58.5) exclude a graze?"""
    numbers, total, excluded, returning = {}, 0, 0, 0
    for mapping, where in PLACES.items():
        for size in DRIVES:
            gamma, sine = where.side * size, Fraction(-where.side)
            contact = touching(mapping, gamma, size, sine, Fraction(0))
            cases = printed_window(mapping, gamma, size)
            total += 1
            excluded += not any(contains(arcs, turn(sine, Fraction(0))) for _, arcs in cases)
            returning += contact.grazes(where.domain)
            equal = f"γ = {gamma} = {'-' if where.side < 0 else ''}B₀Ω/m"
            values = ", ".join(str(value) for value in contact.derivatives(where.domain))
            numbers[f"{mapping}, {equal}: F, G⁽¹⁾, G⁽²⁾, G⁽³⁾"] = values
    numbers |= {
        "contacts at the excluded phase": str(total),
        "printed as no graze": str(excluded),
        "the flow returns": str(returning),
    }
    finding = f"At {returning} of {total} contacts at the excluded phase the flow returns to its domain"
    if excluded and returning:
        finding += ": F = G⁽¹⁾ = G⁽²⁾ = 0, a tangency of fourth order, which Theorem 6 does not see"
        return Evidence(CORRECTED, f"{finding}.", numbers)
    return Evidence(CONFIRMED, f"{finding}.", numbers)
