"""Double-double numbers: their operators and functions, in CPython and compiled."""

from __future__ import annotations

import math
import operator
import random
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any

import pytest
from samples import sample_of

from symosc.kernels.multiprecision import mp_context
from symosc.kernels.rebind import bind

numba = pytest.importorskip("numba")
pairs = pytest.importorskip("symosc.kernels.pairs")

UNIT = 2.0**-106
EXACT = mp_context(100)
OPERATORS = {
    "sum": operator.add,
    "difference": operator.sub,
    "product": operator.mul,
    "quotient": operator.truediv,
}


def as_complex(number: Any) -> complex:
    return complex(float(number), float(number - float(number)))


def exact(value: complex) -> Any:
    return EXACT.mpf(value.real) + EXACT.mpf(value.imag)


def rounded(number: Any) -> tuple[complex, Any]:
    """Return a number as a pair, and what that is exactly."""
    value = as_complex(number)
    return value, exact(value)


@lru_cache(maxsize=1)
def compiled() -> Callable[..., Any]:
    """Return all operators and functions of two numbers, compiled once for all tests."""
    from_complex = pairs.from_complex
    out = pairs.to_complex

    def values(a: Any, b: Any) -> Any:
        x = from_complex(a)
        y = from_complex(b)
        if a.real > 0:
            branch = x
        else:
            branch = 1.0
        sizes = out(abs(x)), out(-x), out(2 * x), out(x / 3), out(0.5 + x)
        functions = (
            out(math.sin(x)),
            out(math.cos(x)),
            out(math.exp(x)),
            out(math.expm1(x)),
            out(math.sqrt(abs(x))),
        )
        order = x < y, x <= y, x > y, x >= y, x == y, x != y
        return (
            (out(x + y), out(x - y), out(x * y), out(x / y)),
            sizes,
            functions,
            order,
            int(x),
            out(branch),
        )

    return numba.njit(values)


def numbers(count: int, seed: int) -> Iterator[Any]:
    """Yield numbers of all sizes up to 1e6, many beside multiples of pi/2048, log(2) and 1."""
    dice = random.Random(seed)
    for n in range(count):
        far = EXACT.mpf(dice.uniform(-1, 1)) * 10 ** dice.uniform(-12, dice.choice((0, 1, 2, 6)))
        near = 1 + EXACT.mpf(dice.uniform(-1, 1)) * EXACT.mpf(10) ** -dice.randint(1, 33)
        steps = EXACT.pi / 2048 * dice.randint(-4096, 4096), EXACT.ln2 / 2 * dice.randint(-900, 900)
        yield (far * near, steps[0] * near, steps[1] * near, dice.randint(-5, 5) * near)[n % 4]


@pytest.mark.slow
@sample_of(400, 300_000)
def test_operators_are_right_to_a_few_units(count: int) -> None:
    arguments = zip(numbers(count, 1), numbers(count, 2), strict=True)
    worst = dict.fromkeys(OPERATORS, 0.0)
    for n, (a, b) in enumerate(arguments):
        (a, x), (b, y) = (
            rounded(a),
            rounded(-a * (1 + EXACT.mpf(2) ** -(n % 104)) if n % 5 == 0 else b),
        )
        if not (x and y):
            continue
        computed, sizes, _, order, whole, branch = compiled()(a, b)
        for (name, operation), value in zip(OPERATORS.items(), computed, strict=True):
            truth = operation(x, y)
            assert value.real == float(value.real + value.imag)  # no overlap
            worst[name] = max(
                worst[name], float(abs(exact(value) / truth - 1)) / UNIT if truth else abs(value)
            )
        assert [exact(size) for size in sizes[:3]] == [abs(x), -x, 2 * x]
        assert abs(exact(sizes[3]) * 3 / x - 1) < 10 * UNIT
        assert abs(exact(sizes[4]) - (x + 0.5)) <= 3 * UNIT * abs(x + 0.5)
        assert order == (x < y, x <= y, x > y, x >= y, x == y, x != y)
        assert whole == int(x)
        assert branch == (a if a.real > 0 else 1.0)
    limits = {"sum": 3, "difference": 3, "product": 5, "quotient": 10}
    assert all(0 < worst[name] < limits[name] for name in OPERATORS), worst


@pytest.mark.slow
@sample_of(400, 300_000)
def test_cpython_gives_the_bits_of_compiled_code(count: int) -> None:
    bound = bind((pairs,), {"pair": pairs.pair_of})
    functions = [
        bound[pairs.FUNCTIONS[name].__name__] for name in ("sin", "cos", "exp", "expm1", "sqrt")
    ]
    for n, (a, b) in enumerate(zip(numbers(count, 4), numbers(count, 5), strict=True)):
        first = as_complex(a)
        if n % 5 == 0:
            second = complex(first.real, first.imag * (n % 3))
        else:
            second = as_complex(b)
        if not (first and second) or abs(first) > 600:
            continue
        x = pairs.pair_of(first.real, first.imag)
        y = pairs.pair_of(second.real, second.imag)
        told = (
            tuple(map(complex, (x + y, x - y, x * y, x / y))),
            tuple(map(complex, (abs(x), -x, 2 * x, x / 3, 0.5 + x))),
            tuple(
                complex(function(abs(x) if function is functions[-1] else x))
                for function in functions
            ),
            (x < y, x <= y, x > y, x >= y, x == y, x != y),
            int(x),
        )
        assert repr(told) == repr(compiled()(first, second)[:5])


@pytest.mark.slow
@sample_of(1_000, 300_000)
def test_functions_are_as_exact_as_their_docstrings_say(count: int) -> None:
    worst = dict.fromkeys(("sin", "cos", "exp", "expm1", "sqrt"), 0.0)
    for number in numbers(count, 3):
        value, x = rounded(number)
        computed = dict(zip(worst, map(exact, compiled()(value, 1 + 0j)[2]), strict=True))
        for name in ("sin", "cos"):
            worst[name] = max(worst[name], float(abs(computed[name] - getattr(EXACT, name)(x))))
        if -670 < x < 709:
            worst["exp"] = max(worst["exp"], float(abs(computed["exp"] / EXACT.exp(x) - 1)))
        if -670 < x < 709 and x:
            worst["expm1"] = max(
                worst["expm1"], float(abs(computed["expm1"] / (EXACT.exp(x) - 1) - 1))
            )
        if x:
            worst["sqrt"] = max(
                worst["sqrt"], float(abs(computed["sqrt"] / EXACT.sqrt(abs(x)) - 1))
            )
    assert worst["sin"] < 1.8e-32, worst
    assert worst["cos"] < 1.8e-32, worst
    assert worst["exp"] < 3e-32, worst
    assert worst["expm1"] < 8e-32, worst
    assert worst["sqrt"] < 3 * UNIT, worst
    assert min(worst.values()) > 0.2 * UNIT  # the sample is not of exact cases


@pytest.mark.slow
def test_ends_of_the_ranges() -> None:
    _, _, (sine, cosine, exp, expm1, root), *_ = compiled()(0j, 1 + 0j)
    assert (sine, cosine, exp, expm1, root) == (0, 1, 1, 0, 0)
    assert compiled()(-671 + 0j, 1 + 0j)[2][2] == 0
    assert compiled()(710 + 0j, 1 + 0j)[2][2].real == math.inf
    assert compiled()(-1e4 + 0j, 1 + 0j)[2][3] == -1
