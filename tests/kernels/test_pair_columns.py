"""Exact columns: the doubles that fractions give, and a doubt wherever they would have to decide."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from symosc.kernels.pair_columns import PairColumn, as_double, either, exactly, larger


def column(values: list[Fraction], doubts: np.ndarray) -> PairColumn:
    hi = np.array([float(value) for value in values])
    lo = np.array([float(value - Fraction(h)) for value, h in zip(values, hi.tolist(), strict=True)])
    rest = [float(abs(v - Fraction(h) - Fraction(e))) for v, h, e in zip(values, hi.tolist(), lo.tolist(), strict=True)]
    return PairColumn(hi, lo, np.array(rest) * 1.001, doubts)


FORMULAS: list[Any] = [
    lambda a, b, c: a * b - c,
    lambda a, b, c: a / (2 * b) + c * c,
    lambda a, b, c: (a - b) / (c * c + 1),
    lambda a, b, c: 1 - (a / b) ** 2 * Fraction(1, 5),
    lambda a, b, c: -abs(a - c) / b,
]


@pytest.mark.parametrize("seed", range(5))
def test_formulas_round_as_fractions_do(seed: int) -> None:
    dice = random.Random(seed)

    def some() -> list[Fraction]:
        return [Fraction(dice.randint(1, 10**17), 10 ** dice.randint(1, 17)) for _ in range(200)]

    a, b, c = some(), some(), some()
    for formula in FORMULAS:
        doubts = np.zeros(200, bool)
        found = as_double(formula(*(column(values, doubts) for values in (a, b, c))))
        expected = [float(formula(*row)) for row in zip(a, b, c, strict=True)]
        assert found[~doubts].tolist() == np.array(expected)[~doubts].tolist()
        assert doubts.mean() < 0.02


def test_what_is_exactly_0_is_a_doubt() -> None:
    third, doubts = Fraction(1, 3), np.zeros(3, bool)
    a, b = column([third, third, Fraction(2)], doubts), column([Fraction(1), Fraction(2), Fraction(4)], doubts)
    below = a * b < column([third, third, Fraction(8)], doubts)
    assert doubts.tolist() == [True, False, False]  # 2 * 4 is exact: no doubt
    assert below[1:].tolist() == [False, False]


def test_single_numbers_and_columns_are_chosen_alike() -> None:
    assert (either(True, 1, 2), larger(Fraction(1, 2), Fraction(1, 3)), exactly(0.5)) == (
        1,
        Fraction(1, 2),
        Fraction(1, 2),
    )
    doubts = np.zeros(2, bool)
    a, b = column([Fraction(1), Fraction(1, 3)], doubts), column([Fraction(1, 7), Fraction(2)], doubts)
    assert as_double(larger(a, b)).tolist() == [1.0, 2.0]
    assert as_double(either(np.array([True, False]), a, Fraction(9))).tolist() == [1.0, 9.0]
    assert as_double(exactly(np.array([0.5]))).tolist() == [0.5]
