"""Numbers are read exactly, in whatever form they come."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy

from symosc.errors import ParameterError
from symosc.model import Parameters
from symosc.scenes import load_scene

VALUES = {"m": 1, "c": 1, "k": 1, "A0": -15, "B0": 10, "Omega": 1, "v1": 1, "v2": 5, "mu1": "0.8", "mu2": "0.6"}

VALUES["FN"] = "9.81"

NOT_EXACT = ["", "one", "1,5", "0x10", "1/0", None, [1], 1j, True, sympy.sqrt(2), sympy.Symbol("x"), "1e99999999"]


def parameters(**changes: object) -> Parameters:
    return Parameters(**(VALUES | changes))


@pytest.mark.parametrize(
    "value",
    [
        0.8,
        "0.8",
        " 4/5 ",
        "8e-1",
        Fraction(4, 5),
        Decimal("0.80"),
        sympy.Rational(4, 5),
        np.float64(0.8),
        np.float32(0.8),
        np.array(0.8)[()],
    ],
    ids=repr,
)
def test_four_fifths_in_every_form(value: object) -> None:
    assert parameters(mu1=value).mu1 == Fraction(4, 5)


@pytest.mark.parametrize("value", [3, "3.000", Fraction(3), sympy.Integer(3), np.int64(3), np.uint8(3), mpmath.mpf(3)])
def test_three_in_every_form(value: object) -> None:
    read = parameters(k=value).k
    assert type(read) is Fraction
    assert (type(read.numerator), read.numerator, read.denominator) == (int, 3, 1)


def test_an_mpf_keeps_every_bit() -> None:
    with mpmath.workdps(60):
        tenth = mpmath.mpf(1) / 10
    read = parameters(c=tenth).c
    assert read != Fraction(1, 10)
    assert abs(read - Fraction(1, 10)) < Fraction(1, 10**59)
    assert read.denominator & (read.denominator - 1) == 0


def test_a_long_decimal_keeps_every_digit() -> None:
    text = "-3.10490096305158165661870252120914982217742324"
    assert load_scene("fig7-exact").x0 == Fraction(text)
    assert load_scene("fig7-exact").x0 != Fraction(text[:-1])
    assert Fraction(text) == parameters(A0=Decimal(text)).A0


def test_floats_are_the_decimals_that_they_print_as() -> None:
    p = parameters(FN=19.62, c=1e-10, k=5e-324)
    assert (p.FN, p.c, p.k) == (Fraction(981, 50), Fraction(1, 10**10), Fraction(5, 10**324))


@pytest.mark.parametrize("value", NOT_EXACT)
def test_values_that_are_no_exact_numbers(value: object) -> None:
    with pytest.raises(ParameterError, match="A0"):
        parameters(A0=value)
