"""Recorded formulas: the bits, and the doubts, that columns of pairs give."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
import pytest

from symosc.kernels.pair_columns import (
    PairColumn,
    angle_of_columns,
    as_double,
    atan2_of_columns,
    either,
    exactly,
    larger,
    root_of_columns,
    sign,
)
from symosc.kernels.pair_programs import TOGETHER, Recorder

ROWS = 3 * TOGETHER + 5  # the last block is not full


def of_pairs(a: Any, b: Any, c: Any) -> list[Any]:
    """Return doubles that need every operation on pairs."""
    numbers = (
        *(
            a + b,
            a - b,
            b - a,
            1 - a,
            2 * a - Fraction(1, 3),
            a * b,
            a / b,
            1 / b,
            c / 3,
            -a,
            abs(a),
        ),
        *((a - b) ** 2, larger(a, c), a * b - c, sign(a - b), sign(c - c), exactly(as_double(a))),
        *(exactly(as_double(a)) - b, either(a < b, a, Fraction(1, 7)), either(a >= c, 2, c)),
    )
    # A second operation shows the low part of the first.
    return [as_double(number) for number in numbers] + [
        as_double(number * number - number) for number in numbers
    ]


def of_doubles(a: Any, b: Any, c: Any) -> list[Any]:
    """Return doubles and flags that need every operation on them."""
    x = as_double(a)
    y = as_double(b)
    z = as_double(c)
    flags = (x < y, x <= z, x > y, x >= z, x == x, x != z, a < b, a <= c, a > b, a == b, a != b)
    signs = (flags[0] & flags[1], flags[0] | flags[3], flags[2] ^ True, flags[2] ^ flags[3])
    numbers = (x + y, x - y, 1 - x, x * y, x / y, 2 * pi / y, -x, abs(x), root_of_columns(abs(x)))
    chosen = (either(flags[0], x, y), either(flags[1], 1, z), larger(x, z), 3.0, False)
    return [*flags, *signs, *numbers, *chosen, x, y, angle_of_columns(x, y)]


@pytest.mark.parametrize("formulas", [of_pairs, of_doubles])
def test_a_program_gives_the_bits_of_columns(formulas: Callable[..., list[Any]]) -> None:
    pytest.importorskip("numba")
    from symosc.engine.arithmetic import compiled_program

    rng = np.random.default_rng(3)
    arguments = np.empty((3, 2, ROWS))
    arguments[:, 0] = rng.uniform(-3.0, 3.0, (3, ROWS))
    arguments[:, 1] = rng.uniform(-1e-17, 1e-17, (3, ROWS))
    arguments[:, :, 7] = 0.0
    arguments[1, :, 8:16] = arguments[0, :, 8:16]
    arguments[1, 1, 8:12] += 1e-30  # a difference that loses its digits
    arguments[2, 1, 12:16] = -arguments[2, 1, 12:16]
    doubts = np.zeros(ROWS, bool)
    with np.errstate(all="ignore"):
        expected = formulas(*(PairColumn(hi, lo, doubts) for hi, lo in arguments))
    recorder = Recorder()
    program = recorder.program(formulas(*(recorder.argument() for _ in arguments)))
    results = np.empty((ROWS, len(program.results)))
    lost = np.zeros(ROWS, bool)
    compiled_program()(*program[:3], arguments, results, lost)
    for number, y, x in program.angles:
        results[:, number] = atan2_of_columns(results[:, y], results[:, x])
    assert lost.tolist() == doubts.tolist()
    assert formulas is of_doubles or (doubts.any() and not doubts.all())
    for number, column in enumerate(expected):
        right = np.full(ROWS, column, float)
        computed = results[:, number].copy()
        same = right.view(np.uint64) == computed.view(np.uint64)
        assert (same | (np.isnan(right) & np.isnan(computed))).all(), number


def test_a_recorded_number_decides_nothing() -> None:
    """A formula that asks `if` would be right for the first row only."""
    a = Recorder().argument()
    with pytest.raises(TypeError, match="choose by `either`"):
        _ = 1 if a > 0 else 2
