"""Pairs of doubles: as exact as they say."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import mpmath

from symosc.kernels import double_double as dd


def test_the_table_of_arctangents() -> None:
    mp_wide = mpmath.mp.clone()
    mp_wide.prec = 120
    for j in range(9):
        exact = mp_wide.atan(mp_wide.mpf(j) / 8)
        assert dd.ATAN[j] == (float(exact), float(exact - float(exact)))
    for pair, factor in ((dd.HALF_PI, 0.5), (dd.PI_PAIR, 1), (dd.TWO_PI_PAIR, 2)):
        assert pair == (float(factor * mp_wide.pi), float(factor * mp_wide.pi - pair[0]))


def exact(*parts: float) -> Fraction:
    return sum(map(Fraction, parts), Fraction(0))


def pairs(rng: random.Random, positive: bool = False) -> tuple[float, float]:
    """Return a random pair: a double, and one below half a unit of it."""
    high = (
        rng.uniform(0.1, 1) * 2.0 ** rng.randint(-60, 60) * (1 if positive else rng.choice([-1, 1]))
    )
    return high, rng.uniform(-0.5, 0.5) * math.ulp(high)


def test_sums_and_products_of_doubles_are_exact() -> None:
    rng = random.Random(1)
    for _ in range(500):
        a = pairs(rng)[0]
        b = pairs(rng)[0]
        assert exact(*dd.two_sum(a, b)) == exact(a, b)
        assert exact(*dd.two_product(a, b)) == Fraction(a) * Fraction(b)
        large, small = sorted((a, b), key=abs, reverse=True)
        assert exact(*dd.fast_sum(large, small)) == exact(a, b)


def test_pairs_keep_a_hundred_bits() -> None:
    rng = random.Random(2)
    for _ in range(500):
        a = pairs(rng)
        b = pairs(rng)
        for function, right in (
            (dd.pair_sum, exact(*a) + exact(*b)),
            (dd.pair_product, exact(*a) * exact(*b)),
            (dd.pair_quotient, exact(*a) / exact(*b)),
        ):
            high, low = function(*a, *b)
            size = max(abs(right), abs(exact(*a)) * (function is dd.pair_sum))
            assert abs(exact(high, low) - right) <= size / 2**99, function
            assert high == high + low  # the low part is below half a unit
        assert dd.pair_sum(*a, -a[0], -a[1]) == (0, 0)


def test_roots_and_angles_of_pairs() -> None:
    rng = random.Random(3)
    with mpmath.workdps(50):
        for _ in range(200):
            y = pairs(rng, positive=True)
            r = pairs(rng, positive=True)
            if y[0] >= r[0]:
                y, r = r, y

            def number(pair: tuple[float, float]) -> mpmath.mpf:
                return mpmath.mpf(pair[0]) + mpmath.mpf(pair[1])

            for computed, right, bits in (
                (dd.pair_root(*y), mpmath.sqrt(number(y)), 99),
                (
                    dd.pair_atan(*y, *r),
                    mpmath.atan2(number(y), number(r)),
                    60,
                ),  # the series' tail is in doubles
                (dd.pair_asin(*y, *r), mpmath.asin(number(y) / number(r)), 60),
            ):
                assert abs(number(computed) - right) <= 2.0**-bits * abs(right)
