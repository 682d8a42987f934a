"""Columns of numbers: read exactly, with the rest that a double lacks; one error that names the row."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError
from symosc.simulation.columns import NumberColumn, decimal_rest, same


def awkward(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    parts = [rng.uniform(-6, 6, 300), np.round(rng.uniform(-9, 9, 200), 3), 10 ** rng.uniform(-12, 25, 300)]
    parts += [rng.integers(0, 10**15, 100) / 10.0 ** rng.integers(0, 15, 100), np.arange(-20, 20.0)]
    special = [0.0, 0.5, 1024.0, 1e15, 2.0**53 - 1, 2.0**60, 1e22, 0.1, 1e-5, 0.1 + 0.2, 5e-324, 9007199254740993.0]
    return np.concatenate([*parts, np.array(special)])


@pytest.mark.parametrize("seed", range(4))
def test_the_rest_of_a_double_is_that_of_its_decimal(seed: int) -> None:
    values = awkward(seed)
    rest, sure = decimal_rest(values)
    exact = [float(Fraction(repr(value)) - Fraction(value)) for value in values.tolist()]
    assert rest[sure].tolist() == np.array(exact)[sure].tolist()
    assert sure.mean() > 0.6
    column = NumberColumn("x", values)
    assert column.parts[1].tolist() == exact
    assert [column.exact(i) for i in range(50)] == [Fraction(repr(value)) for value in values[:50].tolist()]


def test_any_numbers_are_read_alike() -> None:
    given: list[Any] = ["0.1", 0.1, Fraction(1, 10), Decimal("0.1"), np.float32(0.1)]
    column = NumberColumn("x", given)
    assert {column.exact(i) for i in range(5)} == {Fraction(1, 10)}
    assert len(set(zip(*column.parts, strict=True))) == 1
    assert NumberColumn("x", [0.1, Fraction(0.1)]).exact(1) == Fraction(0.1)
    whole = NumberColumn("x", np.arange(3))
    assert (whole.hi.tolist(), whole.parts[1].tolist()) == ([0, 1, 2], [0, 0, 0])


def test_numbers_that_are_equal_as_doubles_need_not_be_equal() -> None:
    a, b = NumberColumn("x", ["0.1", "1/3"]), NumberColumn("y", [Fraction(0.1), "1/3"])
    assert (same(a, b, 0, 0), same(a, b, 1, 1), same(a, b, 0, 1)) == (False, True, False)
    assert same(NumberColumn("x", 1), NumberColumn("y", np.ones(3)), 2, 2)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([1, 2, float("nan")], r"x\[2\] = nan: must be finite"),
        (np.array([1.0, np.inf]), r"x\[1\] = inf: must be finite"),
        (np.array([1.0, 1e60, 1e70]), r"x\[1\] = 1e\+60: must be at most"),
        ([1, "one"], r"x\[1\] = 'one': give an int"),
        ([1, True], r"x\[1\] = True: give an int"),
        ([1, [2]], r"x\[1\] = \[2\]: give an int"),
        ("one", r"x = 'one': give an int"),
        (np.zeros((2, 2)), r"must be a number or have shape \(n,\)"),
    ],
)
def test_bad_numbers_are_named_by_their_row(given: Any, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        NumberColumn("x", given)
