"""Theorem 7: every case of (55) to (58) as an exact set, the proof that the cases are complete, and their LaTeX."""

from __future__ import annotations

import math
from typing import Any

import pytest
import sympy as sp
from sympy import Interval, Rational, S, asin, pi

from symosc import (
    theorem7,
)
from symosc.base.errors import ParameterError
from symosc.symbolic.theorem7 import CIRCLE, real, sign_of

MAPS = ("P2", "P3", "P5", "P6")
gamma, a = sp.symbols("gamma a", real=True)
CUT = asin(Rational(3, 5))  # Theta_cr of |gamma| = 3, amplitude 5
UPPER = Interval.open(0, pi)
LOWER = Interval.open(pi, 2 * pi)
NO_TOP = Interval.Ropen(0, pi / 2) + Interval.open(pi / 2, 2 * pi)
NO_BOTTOM = Interval.Ropen(0, 3 * pi / 2) + Interval.open(3 * pi / 2, 2 * pi)
# Written down from the paper by hand, gamma and B0 Omega/m in front: (55) and (57), (56) and (58).
FROM_BELOW = {
    "1": (3, 5, Interval.Ropen(0, pi + CUT) + Interval.open(2 * pi - CUT, 2 * pi)),
    "2": (5, 5, NO_BOTTOM),
    "3": (7, 5, CIRCLE),
    "4": (0, 5, UPPER),
    "5": (-3, 5, Interval.open(CUT, pi - CUT)),
    "6": (-7, 5, S.EmptySet),
}
FROM_ABOVE = {
    "1": (3, 5, Interval.open(pi + CUT, 2 * pi - CUT)),
    "2": (7, 5, S.EmptySet),
    "3": (0, 5, LOWER),
    "4": (-3, 5, Interval.Ropen(0, CUT) + Interval.open(pi - CUT, 2 * pi)),
    "5": (-5, 5, NO_TOP),
    "6": (-7, 5, CIRCLE),
}
PRINTED = {"P2": FROM_BELOW, "P3": FROM_ABOVE, "P5": FROM_BELOW, "P6": FROM_ABOVE}
EQUATION = {"P2": 55, "P3": 56, "P5": 57, "P6": 58}
ALL_PRINTED = [(mapping, number) for mapping in MAPS for number in PRINTED[mapping]]
# The paper's theorem lacks these.
LACKING = [
    ("P2", "(55.a)", -5, 5, S.EmptySet),
    ("P5", "(57.a)", -5, 5, S.EmptySet),
    ("P3", "(56.2)", 5, 5, S.EmptySet),
    ("P2", "(55.b)", 1, 0, CIRCLE),
    ("P3", "(56.b)", -1, 0, CIRCLE),
    ("P2", "(55.c)", -1, 0, S.EmptySet),
    ("P6", "(58.c)", 1, 0, S.EmptySet),
    ("P2", "(55.c)", 0, 0, S.EmptySet),
    ("P6", "(58.c)", 0, 0, S.EmptySet),
    ("P2", "(55.1) shifted by pi", 3, -5, Interval.Ropen(0, CUT) + Interval.open(pi - CUT, 2 * pi)),
    ("P2", "(55.2) shifted by pi", 5, -5, NO_TOP),
    ("P2", "(55.3) shifted by pi", 7, -5, CIRCLE),
    ("P2", "(55.4) shifted by pi", 0, -5, LOWER),
    ("P2", "(55.5) shifted by pi", -3, -5, Interval.open(pi + CUT, 2 * pi - CUT)),
    ("P2", "(55.6) shifted by pi", -7, -5, S.EmptySet),
    ("P2", "(55.a) shifted by pi", -5, -5, S.EmptySet),
    ("P6", "(58.1) shifted by pi", 3, -5, Interval.open(CUT, pi - CUT)),
    ("P6", "(58.2) shifted by pi", 5, -5, S.EmptySet),
    ("P6", "(58.3) shifted by pi", 0, -5, UPPER),
    (
        "P6",
        "(58.4) shifted by pi",
        -3,
        -5,
        Interval.Ropen(0, pi + CUT) + Interval.open(2 * pi - CUT, 2 * pi),
    ),
    ("P6", "(58.5) shifted by pi", -5, -5, NO_BOTTOM),
    ("P6", "(58.6) shifted by pi", -7, -5, CIRCLE),
]


def printed(mapping: str, level: Any, amplitude: Any) -> Any:
    """Return what Theorem 7 says as printed, at the first order."""
    return theorem7(mapping, level, amplitude, "paper")


@pytest.mark.parametrize(("mapping", "number"), ALL_PRINTED)
def test_printed_case(mapping: str, number: str) -> None:
    level, amplitude, expected = PRINTED[mapping][number]
    assert printed(mapping, level, amplitude) == expected
    assert _label(mapping, level, amplitude) == f"({EQUATION[mapping]}.{number})"


@pytest.mark.parametrize(("mapping", "label", "level", "amplitude", "expected"), LACKING)
def test_case_that_the_paper_lacks(
    mapping: str, label: str, level: int, amplitude: int, expected: Any
) -> None:
    assert printed(mapping, level, amplitude) == expected
    assert _label(mapping, level, amplitude) == label


@pytest.mark.quick(5)
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("amplitude", [5, -5])
@pytest.mark.parametrize("level", [5, -5])
def test_full_order_adds_the_tangency_of_fourth_order_and_nothing_else(
    mapping: str, amplitude: int, level: int
) -> None:
    first = printed(mapping, level, amplitude)
    full = theorem7(mapping, level, amplitude)
    if mapping in ("P2", "P5"):
        graze = level > 0
    else:
        graze = level < 0
    assert full == (CIRCLE if graze else S.EmptySet)
    if amplitude * level < 0:
        touched = pi / 2
    else:
        touched = 3 * pi / 2
    assert full - first == (sp.FiniteSet(touched) if graze else S.EmptySet)
    for swing in (3, 0, -3, 7, -7):
        assert theorem7(mapping, swing, amplitude) == printed(mapping, swing, amplitude)


LINES = (gamma, a, gamma - a, gamma + a)


@pytest.mark.full(2)
@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("order", ["paper", "full"])
def test_exactly_one_case_holds_everywhere(mapping: str, order: str) -> None:
    """A proof: each condition asks for signs of four linear forms only, so it is constant on each of the cells into
    which their four lines through the origin cut the plane; one point of each of the 17 cells is
    tried."""
    cases = theorem7(mapping, gamma, a, order)
    for case in cases:
        for relation in case.condition.atoms(sp.core.relational.Relational):
            form = sp.expand(relation.lhs - relation.rhs)
            assert any(sp.expand(form - sign * line) == 0 for line in LINES for sign in (1, -1)), (
                relation
            )
    # Corners of a square around the origin, and what lies between: all rays, all sectors, and the
    # origin.
    points = [(2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (-1, 2), (-2, 2), (-2, 1)]
    points += [(-x, -y) for x, y in points] + [(0, 0)]
    cells = {tuple(sp.sign(line.subs({gamma: x, a: y})) for line in LINES) for x, y in points}
    assert len(cells) == 17
    for x, y in points:
        held = [case for case in cases if case.condition.subs({gamma: x, a: y}) == sp.true]
        assert len(held) == 1, (x, y, held)
        phases = held[0].phases.subs({gamma: x, a: y})
        assert sp.Union(phases, S.EmptySet) == sp.Union(theorem7(mapping, x, y, order), S.EmptySet)
        assert held[0].label == _label(mapping, x, y)
    used = {
        case.label
        for case in cases
        for x, y in points
        if case.condition.subs({gamma: x, a: y}) == sp.true
    }
    assert used == {case.label for case in cases}  # none is superfluous


@pytest.mark.parametrize(
    ("level", "amplitude", "expected"),
    [
        (sp.sqrt(2), 2, Interval.Ropen(0, 5 * pi / 4) + Interval.open(7 * pi / 4, 2 * pi)),
        (sp.sqrt(2) + sp.sqrt(3), sp.sqrt(5 + 2 * sp.sqrt(6)), NO_BOTTOM),
        (
            pi,
            Rational(22, 7),
            Interval.Ropen(0, pi + asin(7 * pi / 22))
            + Interval.open(2 * pi - asin(7 * pi / 22), 2 * pi),
        ),
        (-1, 2, Interval.open(pi / 6, 5 * pi / 6)),
        (sp.sqrt(2) * sp.sqrt(3) - sp.sqrt(6), 1, UPPER),
        (10**40 + 1, 10**40, CIRCLE),
        (10**40, 10**40 + 1, None),
    ],
)
def test_algebraic_and_other_real_numbers(level: Any, amplitude: Any, expected: Any) -> None:
    text = printed("P2", level, amplitude)
    if expected is None:
        cut = asin(Rational(level, amplitude))
        expected = sp.Union(
            Interval.Ropen(0, pi + cut), Interval.open(2 * pi - cut, 2 * pi), evaluate=False
        )
    assert text == expected


def test_signs_that_need_many_digits() -> None:
    near = sp.sqrt(2) - Rational(math.isqrt(2 * 10**300), 10**150)
    assert sign_of(near) == 1
    assert sign_of(-near) == -1
    assert sign_of(sp.sin(pi / 7) * 0 + sp.cos(pi / 5) - (1 + sp.sqrt(5)) / 4) == 0
    assert (
        sign_of(
            sp.sin(asin(Rational(1, 3)) + asin(Rational(2, 3))) - (sp.sqrt(5) + 4 * sp.sqrt(2)) / 9
        )
        == 0
    )


@pytest.mark.parametrize(
    "bad",
    ["abc", "", None, float("nan"), float("inf"), sp.oo, sp.nan, sp.zoo, sp.I, 1 + sp.I, True],
)
def test_what_is_no_real_number(bad: Any) -> None:
    with pytest.raises(ParameterError, match="gamma"):
        theorem7("P2", bad, 1)
    with pytest.raises(ParameterError, match="amplitude"):
        theorem7("P2", 1, bad)


def test_a_constant_that_only_algebra_shows_to_be_0() -> None:
    nothing = sp.sqrt(3 + 2 * sp.sqrt(2)) - 1 - sp.sqrt(2)
    assert real("gamma", nothing) == 0
    with pytest.raises(ParameterError, match="gamma"):
        real("gamma", sp.Function("f")(1))


def _label(mapping: str, level: int, amplitude: int) -> str:
    cases = theorem7(mapping, gamma, a)
    return next(
        case.label for case in cases if case.condition.subs({gamma: level, a: amplitude}) == sp.true
    )
