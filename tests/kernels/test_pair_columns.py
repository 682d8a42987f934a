"""Columns of pairs: what fractions give, and a doubt where a difference loses its digits."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from symosc.kernels.pair_columns import PairColumn


def column(values: list[Fraction], doubts: np.ndarray) -> PairColumn:
    hi = np.array([float(value) for value in values])
    return PairColumn(
        hi,
        np.array([float(v - Fraction(h)) for v, h in zip(values, hi.tolist(), strict=True)]),
        doubts,
    )


FORMULAS: list[Any] = [
    lambda a, b, c: a * b - c,
    lambda a, b, c: a / (2 * b) + c * c,
    lambda a, b, c: (a - b) / (c * c + 1),
    lambda a, b, c: 1 - (a / b) ** 2 * Fraction(1, 5),
    lambda a, b, c: -abs(a - c) / b,
]


@pytest.mark.parametrize("formula", FORMULAS)
def test_formulas_are_right_to_thirty_digits(formula: Any) -> None:
    dice = random.Random(5)
    a, b, c = (
        [Fraction(dice.randint(1, 10**17), 10 ** dice.randint(1, 17)) for _ in range(500)]
        for _ in range(3)
    )
    doubts = np.zeros(500, bool)
    computed = formula(*(column(values, doubts) for values in (a, b, c)))
    terms = [
        (*row, row[0] * row[1], row[2] ** 2, (row[0] / row[1]) ** 2, 1)
        for row in zip(a, b, c, strict=True)
    ]
    sizes = [max(map(abs, row)) for row in terms]
    for i, row in enumerate(zip(a, b, c, strict=True)):
        error = Fraction(float(computed.hi[i])) + Fraction(float(computed.lo[i])) - formula(*row)
        assert abs(error) <= Fraction(1, 10**29) * max(sizes[i], sizes[i] / min(1, *row))
    assert not doubts.any()


def test_a_difference_that_loses_its_digits_is_a_doubt() -> None:
    third = Fraction(1, 3)
    doubts = np.zeros(3, bool)
    a = column([third, Fraction("0.1"), Fraction(2)], doubts)
    b = column([Fraction(1), Fraction("0.1"), Fraction(4)], doubts)
    below = a * b < column([third + Fraction(1, 10**31), Fraction("0.01"), Fraction(8)], doubts)
    assert doubts.tolist() == [True, doubts[1], False]  # 2 * 4 is exact: no doubt
    assert not below[2]
