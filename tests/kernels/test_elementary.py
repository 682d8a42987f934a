"""Our own sine, cosine, exp and expm1 against mpmath over their whole ranges.

Where their coefficients come from.
"""

from __future__ import annotations

import random

import mpmath
import pytest
from mpmath import mp

from symosc.kernels import elementary

ULP = 2.0**-52


def errors(name: str, arguments: list[float]) -> list[tuple[float, float]]:
    """Return the absolute and the relative error at each argument."""
    computed = []
    with mp.workdps(60):
        for x in arguments:
            true = getattr(mpmath, name)(mpmath.mpf(x))
            error = abs(mpmath.mpf(float(getattr(elementary, name)(x))) - true)
            computed.append((float(error), float(error / abs(true)) if true else 0.0))
    return computed


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", ["sin", "cos"])
@pytest.mark.parametrize("widest", [0.8, 10.0, 1e3, elementary.WIDEST])
def test_sine_and_cosine(name: str, widest: float) -> None:
    rng = random.Random(f"{name} {widest}")
    arguments = [rng.uniform(-widest, widest) for _ in range(1500)]
    # next to the ends of the reduction, where the rest is largest and smallest
    quarter = 3.141592653589793 / 4
    near = [
        n * quarter * (1 + rng.choice((-4, -1, 0, 1, 4)) * ULP)
        for n in range(-int(min(widest, 300) / quarter), 300)
    ]
    assert (
        max(
            error for error, _ in errors(name, [*arguments, *(x for x in near if abs(x) <= widest)])
        )
        < 1.2e-16
    )


def test_a_small_sine_keeps_its_digits() -> None:
    rng = random.Random(3)
    assert (
        max(error for _, error in errors("sin", [10 ** rng.uniform(-300, -1) for _ in range(500)]))
        < 0.6 * ULP
    )


@pytest.mark.parametrize(("name", "bound"), [("exp", 0.7 * ULP), ("expm1", 1.1 * ULP)])
def test_exponentials(name: str, bound: float) -> None:
    rng = random.Random(name)
    arguments = [rng.uniform(-1, 1) for _ in range(1500)] + [
        rng.uniform(-708, 709) for _ in range(1500)
    ]
    arguments += [sign * 10 ** rng.uniform(-300, 0) for sign in (-1, 1) for _ in range(500)]
    assert max(error for _, error in errors(name, arguments)) < bound
