"""Our own sine, cosine, exp and expm1 against mpmath over their whole ranges; where their coefficients come from."""

from __future__ import annotations

import random
from typing import Any

import mpmath
import pytest
from mpmath import mp

from symosc.kernels import elementary

ULP = 2.0**-52
EDGE = 1 + 2.0**-20  # rounding may put the rest of a reduction a little outside its half interval


def errors(name: str, arguments: list[float]) -> list[tuple[float, float]]:
    """Return the absolute and the relative error at each argument."""
    found = []
    with mp.workdps(60):
        for x in arguments:
            true = getattr(mpmath, name)(mpmath.mpf(x))
            error = abs(mpmath.mpf(float(getattr(elementary, name)(x))) - true)
            found.append((float(error), float(error / abs(true)) if true else 0.0))
    return found


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", ["sin", "cos"])
@pytest.mark.parametrize("widest", [0.8, 10.0, 1e3, elementary.WIDEST])
def test_sine_and_cosine(name: str, widest: float) -> None:
    rng = random.Random(f"{name} {widest}")
    arguments = [rng.uniform(-widest, widest) for _ in range(1500)]
    # next to the ends of the reduction, where the rest is largest and smallest
    quarter = 3.141592653589793 / 4
    near = [
        n * quarter * (1 + rng.choice((-4, -1, 0, 1, 4)) * ULP) for n in range(-int(min(widest, 300) / quarter), 300)
    ]
    assert max(error for error, _ in errors(name, [*arguments, *(x for x in near if abs(x) <= widest)])) < 1.2e-16


def test_a_small_sine_keeps_its_digits() -> None:
    rng = random.Random(3)
    assert max(error for _, error in errors("sin", [10 ** rng.uniform(-300, -1) for _ in range(500)])) < 0.6 * ULP


@pytest.mark.parametrize(("name", "bound"), [("exp", 0.7 * ULP), ("expm1", 1.1 * ULP)])
def test_exponentials(name: str, bound: float) -> None:
    rng = random.Random(name)
    arguments = [rng.uniform(-1, 1) for _ in range(1500)] + [rng.uniform(-708, 709) for _ in range(1500)]
    arguments += [sign * 10 ** rng.uniform(-300, 0) for sign in (-1, 1) for _ in range(500)]
    assert max(error for _, error in errors(name, arguments)) < bound


def test_an_exponential_far_below_one_vanishes() -> None:
    assert 0 < float(elementary.exp(-1e9)) < 1e-307
    assert float(elementary.expm1(-1e9)) == -1.0


def sine_rest(z: Any) -> Any:
    r = mpmath.sqrt(z)
    return (mpmath.sin(r) / r - 1) / z if z > mpmath.mpf("1e-12") else z / 120 - mpmath.mpf(1) / 6


def cosine_rest(z: Any) -> Any:
    return (mpmath.cos(mpmath.sqrt(z)) - 1 + z / 2) / z**2 if z > mpmath.mpf("1e-9") else mpmath.mpf(1) / 24 - z / 720


def exponential_rest(r: Any) -> Any:
    return (mpmath.expm1(r) - r) / r**2 if abs(r) > mpmath.mpf("1e-12") else mpmath.mpf(1) / 2 + r / 6


@pytest.mark.parametrize(
    ("letter", "count", "function"), [("S", 6, sine_rest), ("C", 6, cosine_rest), ("X", 11, exponential_rest)]
)
def test_the_coefficients_are_those_of_a_chebyshev_fit(letter: str, count: int, function: Any) -> None:
    with mp.workdps(40):
        widest = mpmath.log(2) / 2 * EDGE if letter == "X" else (mpmath.pi / 4 * EDGE) ** 2
        fitted = mpmath.chebyfit(function, [-widest if letter == "X" else 0, widest], count)[::-1]
    # fits over intervals that differ in a last digit differ in theirs
    for n, coefficient in enumerate(fitted):
        assert getattr(elementary, f"{letter}{n}") == pytest.approx(float(coefficient), rel=1e-12)


def test_the_parts_of_the_constants_add_up() -> None:
    with mp.workdps(60):
        half_pi = sum(mpmath.mpf(part) for part in (elementary.HALF_PI_HIGH, elementary.HALF_PI_MIDDLE))
        assert abs(half_pi + elementary.HALF_PI_LOW - mpmath.pi / 2) < 1e-36
        assert abs(mpmath.mpf(elementary.LOG_2_HIGH) + elementary.LOG_2_LOW - mpmath.log(2)) < 1e-29
    for part in (elementary.HALF_PI_HIGH, elementary.HALF_PI_MIDDLE):  # 33 bits: a product with 20 bits is exact
        assert (part.as_integer_ratio()[0]).bit_length() <= 33
    assert elementary.LOG_2_HIGH.as_integer_ratio()[0].bit_length() <= 42
    assert elementary.WIDEST * elementary.TWO_OVER_PI < 2**20
