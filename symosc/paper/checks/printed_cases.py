"""Eqs. (55) to (58) as printed, and what the exact flow does at contacts of every case."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import isqrt, sqrt
from typing import Any, NamedTuple

from symosc.mappings.theorem7_cases import PLACES
from symosc.model import Parameters
from symosc.paper.checks.rational_cases import RATIONAL_PHASES, RationalContact

#: Angles are written as rational numbers, a turn as 4: pi/2 is 1, pi is 2. (See `turn`.)
HALF, FULL_CIRCLE = Fraction(2), Fraction(4)


class Arc(NamedTuple):
    """The angles between `low` and `high`, without `high`, and with `low` if closed."""

    low: Fraction
    high: Fraction
    closed: bool = False


def turn(s: Any, c: Any) -> Any:
    """Return an angle from its sine and cosine as a number in [0, 4) that grows with it; rational for rational ones."""
    if s >= 0:
        return s / (s + c) if c > 0 else 1 - c / (s - c)
    return 2 + s / (s + c) if c < 0 else 3 + c / (c - s)


# --- what the paper prints ---


def printed_window(mapping: str, gamma: Any, amplitude: Any) -> list[tuple[int, list[Arc]]]:
    """Eqs. (55) to (58): every case whose condition holds, with its phases.

    Parameters
    ----------
    mapping : {"P2", "P3", "P5", "P6"}
    gamma, amplitude : Fraction or float
        gamma_j and B0 Omega/m.

    Returns
    -------
    list of (int, list of Arc)
        Number of the case, counted in the paper's order, and its arcs. The ends [0 and 2 pi] are the same point.
    """
    g, a = gamma, amplitude
    ratio = -g / a if a and abs(g) <= abs(a) else None  # the sine of Theta_cr
    d = turn(abs(ratio), root(1 - ratio * ratio)) if ratio is not None else Fraction(0)  # |Theta_cr|
    zero, quarter = Fraction(0), Fraction(1)
    if PLACES[mapping].side > 0:
        cases = [
            (0 < g < a, [Arc(zero, HALF + d, True), Arc(FULL_CIRCLE - d, FULL_CIRCLE)]),
            (0 < g == a, [Arc(zero, 3 * quarter, True), Arc(3 * quarter, FULL_CIRCLE)]),
            (0 < a < g, [Arc(zero, FULL_CIRCLE, True)]),
            (g == 0, [Arc(zero, HALF)]),
            (g < 0 and a > abs(g), [Arc(d, HALF - d)]),
            (g < 0 and a < abs(g), []),
        ]
    else:
        cases = [
            (0 < g < a, [Arc(HALF + d, FULL_CIRCLE - d)]),
            (0 < a <= g, []),
            (g == 0, [Arc(HALF, FULL_CIRCLE)]),
            (g < 0 and a > abs(g), [Arc(zero, d, True), Arc(HALF - d, FULL_CIRCLE)]),
            (g < 0 and a == abs(g), [Arc(zero, quarter, True), Arc(quarter, FULL_CIRCLE)]),
            (g < 0 and a < abs(g), [Arc(zero, FULL_CIRCLE, True)]),
        ]
    return [(number, arcs) for number, (holds, arcs) in enumerate(cases, 1) if holds]


# --- exact contacts ---


def root(square: Any) -> Any:
    """Return a square root, exactly where it is rational."""
    if isinstance(square, Fraction):
        top, bottom = isqrt(square.numerator), isqrt(square.denominator)
        if top * top == square.numerator and bottom * bottom == square.denominator:
            return Fraction(top, bottom)
    return sqrt(square)


def contains(arcs: list[Arc], where: Any) -> bool:
    """Tell whether an angle (as `turn` gives it) is in arcs."""
    return any(arc.low < where < arc.high or (arc.closed and where == arc.low) for arc in arcs)


def touching(mapping: str, gamma: Fraction, amplitude: Fraction, s: Fraction, c: Fraction) -> RationalContact:
    """Return a contact with F = 0 of the domain of a mapping, for given gamma and B0 Omega/m."""
    where = PLACES[mapping]
    m, k, damping, Omega = Fraction(2), Fraction(3), Fraction(1), Fraction(3, 2)
    speed = gamma * m / k
    others = (speed, speed + 5) if where.boundary == 1 else (speed - 5, speed)
    p = Parameters(
        m=m, k=k, c=damping, A0=1, B0=amplitude * m / Omega, Omega=Omega, v1=others[0], v2=others[1],
        mu1="1/2", mu2="1/3", FN=2,
    )  # fmt: skip
    contact = RationalContact(p, where.boundary, Fraction(0), s, c)
    return RationalContact(p, where.boundary, m * contact.force(where.domain) / k, s, c)


DRIVES = (Fraction(3), Fraction(7, 4))
#: gamma over the amplitude: sines of rational points, so that the ends of the windows are among the phases; 0, equality
#: and beyond.
RATIOS = tuple(sorted({s for s, _ in RATIONAL_PHASES} | {Fraction(6, 5), Fraction(-6, 5)}))


class Row(NamedTuple):
    """What the paper and the exact flow say of one contact."""

    case: int  # of the paper's equation, 0 if none holds
    gamma: Fraction
    amplitude: Fraction
    printed: bool
    grazes: bool
    fourth_order: bool  # F = G(1) = 0 at |gamma| = |B0| Omega/m

    @property
    def right(self) -> bool:
        """Whether both say the same."""
        return self.printed == self.grazes


@cache
def rows_of(mapping: str, drives: tuple[Fraction, ...] = DRIVES) -> tuple[Row, ...]:
    """Return the rows of all exact contacts with the given B0 Omega/m."""
    found, domain = [], PLACES[mapping].domain
    for amplitude in drives:
        for gamma in (ratio * (abs(amplitude) or 2) for ratio in RATIOS):
            cases = printed_window(mapping, gamma, amplitude) or [(0, [])]
            for s, c in RATIONAL_PHASES:
                contact = touching(mapping, gamma, amplitude, s, c)
                grazes, slope = contact.grazes(domain), contact.slope(domain)
                special = slope == 0 and abs(gamma) == abs(amplitude)
                found += [
                    Row(case, gamma, amplitude, contains(arcs, turn(s, c)), grazes, special) for case, arcs in cases
                ]
    return tuple(found)
