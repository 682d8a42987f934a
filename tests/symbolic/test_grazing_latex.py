"""Grazing answers in print: windows, Theorem 7's table and Piecewise, points of the grazing curve."""

from __future__ import annotations

import random
import re
from fractions import Fraction
from typing import Any

import pytest
import sympy as sp
from latex_reader import Reader

from symosc import (
    grazing_curve,
    grazing_start,
    grazing_window,
    is_grazing,
    load_scene,
    solve_grazing,
    theorem7,
)
from symosc.mappings.latex import number, words
from symosc.symbolic.grazing_latex import latex
from symosc.symbolic.theorem7 import CIRCLE

FIG9 = load_scene("fig9").parameters
MAPS = ("P2", "P3", "P5", "P6")
GAMMA, A = sp.symbols("gamma a", real=True)
INTERVAL = re.compile(r"\\left(?P<low>[\[(])(?P<a>.*?), (?P<b>.*?)\\right(?P<high>[\])])(?= \\cup|$)")


def read_set(text: str, values: dict[str, complex]) -> list[tuple[bool, float, float, bool]]:
    """Return the intervals that printed phases say, read as a human reads them."""
    if text == r"\varnothing":
        return []
    found = list(INTERVAL.finditer(text))
    assert " \\cup ".join(each.group() for each in found) == text, text
    return [
        (each["low"] == "[", *(Reader(_plain(each[end]), values).value().real for end in "ab"), each["high"] == "]")
        for each in found
    ]


def _plain(text: str) -> str:
    """Return a formula without the braces around arguments, which the reader takes for groups of its own."""
    return text.replace(r"{\left(", r"\left(").replace(r"\right)}", r"\right)")


def intervals(phases: Any) -> list[tuple[bool, float, float, bool]]:
    parts = phases.args if phases.is_Union else [] if phases.is_empty else [phases]
    return [(not part.left_open, float(part.start), float(part.end), not part.right_open) for part in parts]


@pytest.mark.parametrize("mapping", MAPS)
def test_printed_windows_say_what_the_windows_are(mapping: str) -> None:
    rng = random.Random(mapping)
    for _ in range(20):
        v1 = Fraction(rng.randint(-9, 9), 2)
        p = FIG9.replace(v1=v1, v2=v1 + rng.randint(1, 5), B0=rng.randint(-4, 4), Omega=rng.randint(1, 3))
        window = grazing_window(p, mapping)
        shown = window.latex().partition(r"\in ")[2]
        printed = read_set(shown, {r"\pi": complex(sp.pi)})
        for one, other in zip(printed, intervals(window.phases), strict=True):
            assert one == pytest.approx(other, abs=1e-12)


@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("order", ["full", "paper"])
def test_the_table_has_every_case(mapping: str, order: str) -> None:
    cases = theorem7(mapping, order=order)
    lines = cases.latex().splitlines()
    assert lines[0] == r"\begin{array}{lll}"
    assert lines[-1] == r"\end{array}"
    rows = [line.removesuffix(r" \\").split(" & ") for line in lines[2:-1]]
    assert [row[0].partition(r"\text")[0] for row in rows] == [case.label.partition(" ")[0] for case in cases]
    for row, case in zip(rows, cases, strict=True):
        numbers = next(each for each in POINTS if case.condition.subs(each) == sp.true)
        values = {r"\gamma": float(numbers[GAMMA]), "a": float(numbers[A]), r"\pi": complex(sp.pi)}
        for one, other in zip(read_set(row[2], values), intervals(case.phases.subs(numbers)), strict=True):
            assert one == pytest.approx(other, abs=1e-12)


#: Values of gamma and a in each cell of their plane.
POINTS = [{GAMMA: g, A: a} for g in range(-3, 4) for a in range(-3, 4)]
POINTS += [{GAMMA: sp.Rational(g, 2), A: a} for g in (-1, 1) for a in (-2, 2)]


@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("order", ["full", "paper"])
def test_the_piecewise_is_the_theorem(mapping: str, order: str) -> None:
    piecewise = theorem7(mapping, GAMMA, A, order).piecewise()
    assert isinstance(piecewise, sp.Piecewise)
    for point in POINTS:
        expected = theorem7(mapping, point[GAMMA], point[A], order)
        assert intervals(piecewise.subs(point)) == intervals(expected)


def test_conditions_are_chains() -> None:
    assert latex((GAMMA > 0) & (GAMMA < A) & (A > 0)) == r"0 < \gamma < a,\ a > 0"
    assert latex(sp.Eq(GAMMA, A) & (A > 0)) == r"\gamma = a,\ a > 0"
    assert latex((GAMMA >= -A) & (GAMMA < 0)) == r"- a \leq \gamma < 0"
    assert latex(CIRCLE) == r"\left[0, 2 \pi\right)"
    assert latex(2 * sp.pi - sp.asin(sp.Rational(1, 12))) == r"2 \pi - \arcsin{\left(\frac{1}{12} \right)}"
    assert theorem7("P2").latex() == theorem7("P2", GAMMA, A).latex()


def test_letters_of_a_users_own_stand_in_the_table() -> None:
    k, v, B0, Omega, m = sp.symbols("k v_1 B_0 Omega m", positive=True)
    shown = theorem7("P3", k * v / m, B0 * Omega / m).latex()
    assert r"\arcsin{\left(\frac{k v_{1}}{B_{0} \Omega} \right)}" in shown
    assert shown.count("(56.") == 2


def test_points_of_the_curve() -> None:
    curve = grazing_curve(FIG9, "P2", 60)
    end = curve.pieces[0].high
    assert f"{end.x:.10g}" in end.latex()
    assert r"\text{(end of the window)}" in end.latex()
    assert curve.latex().count(r" \\") == 1 + 2 * len(curve.pieces)
    start = grazing_start(FIG9, "P2", 1)
    assert start.latex() == (
        rf"P_{{2}}:\quad (\Omega t_i, x_i) = ({number(start.theta)}, {number(start.x)}) "
        rf"\mapsto (\Omega t_m, x_m) = (1, {number(start.x_m)})"
    )
    lost = grazing_start(FIG9, "P5", 1)
    assert not lost.found
    assert words(lost.reason) in lost.latex()
    solutions = solve_grazing(FIG9, "P2", x_i=4)
    assert number(solutions[0].theta) in solutions.latex()
    none = solve_grazing(FIG9, "P2", x_i=100)
    assert none.latex() == r"\text{x\_i goes over 3.65106 to 11.2811 on the grazing curve}"
    verdict = is_grazing(FIG9, "P2", grazing_window(FIG9, "P2").contact("1"), "1")
    assert verdict.latex().startswith("F = 0, G^{(1)} = -")
    assert verdict.latex().endswith(r"\text{it grazes}")
    for answer in (end, curve, start, solutions, verdict, theorem7("P2"), theorem7("P2")[0]):
        assert answer._repr_latex_() == f"${answer.latex()}$"


def test_numbers_in_print() -> None:
    assert number(0.5) == "0.5"
    assert number(1.25e-20) == r"1.25 \cdot 10^{-20}"
    assert words("100% of x_1") == r"\text{100\% of x\_1}"
