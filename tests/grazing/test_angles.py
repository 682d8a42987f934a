"""Angles and phases as exact numbers, in every form, and nothing else."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
import pytest
import sympy

from symosc import ParameterError
from symosc.grazing.angles import number_of, phase_of, read_angle, read_phase, symbolic, times
from symosc.kernels.multiprecision import mp_context
from symosc.mappings.phase import LONGEST_TEXT


@pytest.mark.parametrize(
    ("given", "value"),
    [
        ("3*pi/2", 3 * sympy.pi / 2),
        ("(1 + 2)*pi/4 - 1", 3 * sympy.pi / 4 - 1),
        (" pi ", sympy.pi),
        ("pi*0.5", sympy.pi / 2),
        (sympy.pi / 3, sympy.pi / 3),
        (sympy.sqrt(2), sympy.sqrt(2)),
        ("5/3", Fraction(5, 3)),
        (2, Fraction(2)),
        (0.1, Fraction(1, 10)),
        (sympy.Rational(1, 3), Fraction(1, 3)),
    ],
)
def test_forms(given: Any, value: Any) -> None:
    assert read_angle("theta", given) == value
    assert type(read_angle("theta", given)) is type(value) or hasattr(value, "free_symbols")


def test_a_phase_that_was_computed_is_the_binary_number_that_it_is() -> None:
    assert read_phase("theta", 0.1) == Fraction(0.1) != Fraction(1, 10)
    assert read_phase("theta", "0.1") == Fraction(1, 10)


NONE = ["pi**2", "pi pi", "2*", "pi/0", "x", "pi + x", "", None, True, 1j, float("nan"), "__import__('os')*pi"]
NONE += [sympy.Symbol("x"), sympy.I, sympy.oo, "pi" + "+pi" * 100]
NONE += [sympy.true, sympy.Interval(0, 1), sympy.EmptySet, sympy.Tuple(1), sympy.Symbol("x", real=True) + sympy.pi]


@pytest.mark.parametrize("value", NONE, ids=str)
def test_what_is_no_angle(value: Any) -> None:
    with pytest.raises(ParameterError, match=r"^theta = "):
        read_angle("theta", value)


def test_the_longest_text() -> None:
    text = "pi" + " " * (LONGEST_TEXT - 2)
    assert read_angle("theta", text) == sympy.pi
    with pytest.raises(ParameterError, match=f"at most {LONGEST_TEXT} characters"):
        read_angle("theta", text + " ")


def test_phases_are_the_angles_less_whole_turns() -> None:
    rng, context = random.Random(5), mp_context(60)
    for _ in range(30):
        part = Fraction(rng.randint(-9999, 9999), rng.randint(1, 99))
        for angle in (part, symbolic(part) * sympy.pi):
            phase = phase_of(angle)
            turns = (number_of(angle, context) - number_of(phase, context)) / (2 * context.pi)
            assert abs(turns - round(turns)) < 1e-50
            assert 0 <= number_of(phase, context) < 2 * context.pi
    assert phase_of(Fraction(599, 100)) == Fraction(599, 100)
    assert phase_of(Fraction(6)) == 6  # 6 < 2 pi
    assert float(phase_of(Fraction(7))) == pytest.approx(7 - 2 * mpmath.pi)
    assert phase_of(2 * sympy.pi) == 0


def test_numbers_of_angles() -> None:
    context = mp_context(50)
    assert number_of(Fraction(1, 3), context) == context.mpf(1) / 3
    assert abs(number_of(sympy.pi / 3, context) - context.pi / 3) < 1e-49
    assert times(Fraction(1, 3), Fraction(3, 2)) == Fraction(1, 2)
    assert times(sympy.pi, Fraction(3, 2)) == 3 * sympy.pi / 2
    assert symbolic(Fraction(2, 3)) == sympy.Rational(2, 3)
    assert symbolic(sympy.pi) is sympy.pi
