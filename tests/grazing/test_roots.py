"""The search for the first root."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise
from math import comb, sqrt
from typing import Any

import numpy as np
import pytest

from symosc.grazing import roots
from symosc.grazing.roots import first_root


def test_first_root_of_products() -> None:
    rng = random.Random(7)
    for _ in range(300):
        places = sorted(rng.uniform(0.02, 1.5) for _ in range(rng.randrange(1, 6)))
        if any(b - a < 1e-3 for a, b in pairwise(places)):
            continue
        p = [1.0]
        for root in places:
            p = [(p[i] if i < len(p) else 0.0) - (p[i - 1] / root if i else 0.0) for i in range(len(p) + 1)]
        touch, found = first_root(p, 1e-15, 2.0**-53)
        assert not touch
        assert (found is None) == (places[0] > 1)
        assert found is None or abs(found - places[0]) < 1e-9


def test_first_root_tells_touches_and_near_misses() -> None:
    for depth in (1e-10, 0.0, -1e-10):  # (x - 0.6)^2 + depth
        touch, found = first_root([0.36 + depth, -1.2, 1.0], 1e-15, 2.0**-53)
        assert touch == (depth == 0.0)
        assert (found is None) == (depth > 0.0)
        if depth <= 0.0:
            assert abs(found - (0.6 - sqrt(-depth))) < 1e-8


def least_on(p: list[float], low: float, high: float) -> float:
    """Return the least value of a polynomial on an interval, from all zeros of its slope."""
    slope = np.polynomial.Polynomial(p).deriv()
    inner = [float(z.real) for z in slope.roots() if abs(z.imag) < 1e-9 and low < z.real < high]
    return min(float(np.polynomial.Polynomial(p)(each)) for each in (low, high, *inner))


def drawn(rng: random.Random) -> list[float]:
    """Return a polynomial that is positive at 0; about half of them come near to 0 and part again."""
    if rng.random() < 0.5:
        bottom, depth, degree = (
            rng.uniform(0.05, 0.95),
            rng.choice([-1, 1]) * 10 ** rng.uniform(-9, -1),
            rng.randint(0, 3),
        )
        curve = np.polynomial.Polynomial([bottom**2 + depth, -2 * bottom, 1.0])
        for _ in range(degree):
            curve = curve * np.polynomial.Polynomial([1.0, rng.uniform(-0.4, 0.4)])
        found = curve.coef.tolist()
    else:
        found = [rng.uniform(0.1, 1), *(rng.uniform(-2, 2) for _ in range(rng.randint(1, 7)))]
    return found if found[0] > 0 else [abs(found[0]), *found[1:]]


def test_what_is_said_holds_for_every_polynomial_within_the_noise() -> None:
    """No root: all are positive. A root: all are positive before it and have one there. A touch: it is open."""
    rng, said = random.Random(8), {"none": 0, "root": 0, "touch": 0}
    for _ in range(700):
        p, noise = drawn(rng), 10 ** rng.uniform(-12, -2)
        if p[0] <= noise:
            continue
        touch, sigma = first_root(p, noise, 2.0**-53)
        if sigma is None:
            assert not touch
            assert least_on(p, 0.0, 1.0) > noise * (1 - 1e-9)
            said["none"] += 1
            continue
        assert 0 < sigma <= 1
        value = float(np.polynomial.Polynomial(p)(sigma))
        if touch:
            assert abs(value) <= noise * (1 + 1e-6) + 1e-15
            assert least_on(p, 0.0, sigma) >= -noise * (1 + 1e-6)
            said["touch"] += 1
            continue
        assert abs(value) < 1e-12
        assert least_on(p, 0.0, sigma * (1 - 1e-6)) > -1e-12  # it is the first one ...
        assert least_on(p, 0.0, 1.0) < -noise  # ... and no polynomial within the noise is without
        said["root"] += 1
    assert min(said.values()) > 40


@pytest.mark.parametrize("bottom", [0.25, 0.5, 0.75])
@pytest.mark.parametrize(("part", "touches"), [(0.5, True), (1.0, True), (2.0, False), (-1.0, True), (-2.0, None)])
def test_a_bottom_at_the_noise_is_a_touch(bottom: float, part: float, touches: bool | None) -> None:
    """(s - bottom)^2 + part noise, in numbers that doubles hold: at the noise itself it is open, above it is clear."""
    noise = 2.0**-20
    touch, sigma = first_root([bottom**2 + part * noise, -2 * bottom, 1.0], noise, 2.0**-53)
    if touches is None:
        assert not touch
        assert sigma == pytest.approx(bottom - (2 * noise) ** 0.5, rel=1e-9)
    else:
        assert touch is touches
        assert (sigma == pytest.approx(bottom, abs=1e-7)) if touches else sigma is None


def test_bernstein_coefficients_are_those_of_the_definition() -> None:
    """The polynomial is the sum of b_i C(n, i) s^i (1 - s)^(n - i); divided, its two halves have theirs."""
    rng = random.Random(9)
    for _ in range(60):
        p = [Fraction(rng.randint(-99, 99), rng.randint(1, 9)) for _ in range(rng.randint(1, 8))]
        n, s = len(p) - 1, Fraction(rng.randint(0, 8), 8)

        def value(b: list[Any], s: Any) -> Any:
            n = len(b) - 1
            return sum(each * comb(n, i) * s**i * (1 - s) ** (n - i) for i, each in enumerate(b))

        exact = sum(term * s**k for k, term in enumerate(p))
        coefficients = roots.bernstein(p)
        assert len(coefficients) == n + 1
        assert value(coefficients, s) == exact
        left, right = roots._divided([float(each) for each in coefficients])
        whole = float(exact)
        if s <= roots.CUT:
            assert value(left, float(s) / roots.CUT) == pytest.approx(whole, abs=1e-9)
        else:
            assert value(right, (float(s) - roots.CUT) / (1 - roots.CUT)) == pytest.approx(whole, abs=1e-9)
