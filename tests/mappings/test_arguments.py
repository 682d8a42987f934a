"""Switching points as arguments: what is a number or an array, in which shape, and what is refused."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

from symosc import ParameterError
from symosc.mappings.arguments import columns_of, is_array, is_mp, real_array, scalar, text_or_booleans

RAGGED = [[1, 2], [3]]


@pytest.mark.parametrize(
    ("value", "array", "mp"),
    [
        (1, False, False),
        (1.5, False, False),
        (np.float64(1), False, False),
        (np.array(1.0), False, False),
        (mpmath.mpf(1), False, True),
        ([1, 2], True, False),
        (np.zeros(3), True, False),
        (RAGGED, True, False),
        ("12", False, False),
    ],
)
def test_kinds(value: Any, array: bool, mp: bool) -> None:
    assert is_array(value) is array
    assert is_mp(value) is mp


def test_scalars() -> None:
    assert scalar("x_i", np.array(2.5), float) == 2.5
    assert scalar("x_i", 2, float) == 2.0
    assert scalar("x_i", -(2.0**1000), float) == -(2.0**1000)
    for wrong in (True, np.True_, "1", b"1", None, [1], np.zeros(2), 1j, mpmath.mpc(1, 2), object()):
        with pytest.raises(ParameterError, match=r"^x_i = .*must be a finite real number"):
            scalar("x_i", wrong, mpmath.mpmathify if is_mp(wrong) or hasattr(wrong, "_mpc_") else float)
    for wrong in (float("inf"), -float("inf"), float("nan")):
        with pytest.raises(ParameterError, match=r"^x_i = .*finite"):
            scalar("x_i", wrong, float)


def test_columns_are_broadcast_and_are_copies() -> None:
    x = np.arange(3.0)
    columns = columns_of([x, 1.0, np.ones((2, 1)), 2])
    assert [column.shape for column in columns] == [(2, 3)] * 4
    assert np.array_equal(columns[0], [[0, 1, 2], [0, 1, 2]])
    columns[0][0, 0] = 9.0
    assert columns[0][1, 0] == x[0] == 0.0
    with pytest.raises(ParameterError, match="shapes fit together"):
        columns_of([np.ones(2), np.ones(3), 1.0, 1.0])


@pytest.mark.parametrize(
    "value", [[True, False], np.array([True]), ["1", "2"], np.array(["1"]), [1, "2"], [1j], RAGGED, [[1, True]]]
)
def test_what_is_no_array_of_numbers(value: Any) -> None:
    with pytest.raises(ParameterError, match=r"^theta_j = .*must be numbers"):
        real_array("theta_j", value, "must be numbers")


def test_arrays_of_numbers() -> None:
    for value in ([1, 2], (1.0, 2.0), np.array([1, 2], dtype=np.int8), np.array([1, 2], dtype=object)):
        found = real_array("x_j", value, "must be numbers")
        assert found.dtype == float
        assert found.tolist() == [1, 2]
    with pytest.raises(ParameterError, match=r"^x_j = inf: must be finite everywhere"):
        real_array("x_j", [1.0, np.inf], "must be numbers")


def test_text_among_numbers() -> None:
    assert not text_or_booleans([1, 2.0, None])
    for each in (True, np.False_, "1", b"1"):
        assert text_or_booleans([[1, 2], [3, each]])
