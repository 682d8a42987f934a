"""The guards of the event search: when a root is taken for the only one, and how far a touch reaches."""

from __future__ import annotations

import math
import random
from fractions import Fraction

from agreement import BASE
from touches import tenths

from symosc import bounds, flow
from symosc.path import Path
from symosc.start import Start


def taylor(root: float, slope: float, bend: float) -> tuple[float, ...]:
    """Return the coefficients p0 to p4 of slope (root - s) + bend (root - s)^2/2."""
    return slope * root + bend * root**2 / 2, -slope - bend * root, bend / 2, 0.0, 0.0


def test_a_root_is_near_only_if_it_is_the_only_one_there() -> None:
    """Each guard alone says no: a slope that is not down, a loose bound, a turn before what is missing is made up."""
    K = flow.constants(BASE)
    assert bounds.is_near(0.01, *taylor(0.01, 1.0, 0.0), 4, 0.0, 1.0, K) == (True, True, True)
    assert not bounds.is_near(0.01, *taylor(0.01, -1.0, 0.0), 4, 0.0, 1.0, K)[0]
    assert not bounds.is_near(0.01, *taylor(0.01, 0.0, 0.0), 4, 0.0, 1.0, K)[0]
    # missing = M4 root^4/12 against ISOLATED slope/rate
    edge = 12 * bounds.ISOLATED / (K.rate * 1.0)
    assert bounds.is_near(1.0, *taylor(1.0, 1.0, 0.0), 4, 0.9 * edge, 1.0, K)[0]
    assert not bounds.is_near(1.0, *taylor(1.0, 1.0, 0.0), 4, 1.1 * edge, 1.0, K)[0]
    # 8 SHRINK root bend < slope: the slope keeps its sign on what a safe step leaves open
    edge = 1 / (8 * bounds.SHRINK)
    assert bounds.is_near(1.0, *taylor(1.0, 1.0, 0.9 * edge), 4, 0.0, 1.0, K)[0]
    assert not bounds.is_near(1.0, *taylor(1.0, 1.0, 1.1 * edge), 4, 0.0, 1.0, K)[0]
    # 8 missing (bend root + slope) < slope^2 root
    edge = 12 / (8 * (100.0 + 1.0))
    assert bounds.is_near(1.0, *taylor(1.0, 1.0, 100.0), 4, 0.9 * edge, 1.0, K)[0]
    assert not bounds.is_near(1.0, *taylor(1.0, 1.0, 100.0), 4, 1.1 * edge, 1.0, K)[0]


def test_a_root_is_close_if_taylor_reaches_it_and_clear_if_the_gap_is_deep_behind() -> None:
    K = flow.constants(BASE)
    edge = 12 * bounds.NEAR / K.rate
    assert bounds.is_near(1.0, *taylor(1.0, 1.0, 0.0), 4, 0.9 * edge, 1.0, K)[1]
    assert not bounds.is_near(1.0, *taylor(1.0, 1.0, 0.0), 4, 1.1 * edge, 1.0, K)[1]
    size, bend = 3.0, 2.0  # depth behind the root: slope^2/(2 bend)
    slope = math.sqrt(2 * bounds.CLEAR_DEPTH * size * bend)
    assert bounds.is_near(1e-6, *taylor(1e-6, 1.01 * slope, bend), 4, 0.0, size, K)[2]
    assert not bounds.is_near(1e-6, *taylor(1e-6, 0.99 * slope, bend), 4, 0.0, size, K)[2]
    # a divided polynomial: the gap is root times it for each degree that is missing
    far = 1e-3
    slope = math.sqrt(2 * bounds.CLEAR_DEPTH * size * bend / far)
    assert bounds.is_near(far, *taylor(far, 1.01 * slope, bend), 3, 0.0, size, K)[2]
    assert not bounds.is_near(far, *taylor(far, 0.99 * slope, bend), 3, 0.0, size, K)[2]


def test_what_is_missing_counts_the_rest_of_the_polynomial() -> None:
    """A root that Halley's method has not reached yet leaves a value, which counts like the bound."""
    K = flow.constants(BASE)
    off = 0.9 * bounds.ISOLATED / K.rate
    p0, *others = taylor(1.0, 1.0, 0.0)
    assert bounds.is_near(1.0, p0 + off, *others, 4, 0.0, 1.0, K)[0]
    assert bounds.is_near(1.0, p0 - off, *others, 4, 0.0, 1.0, K)[0]
    assert not bounds.is_near(1.0, p0 + 1.3 * off, *others, 4, 0.0, 1.0, K)[0]
    assert not bounds.is_near(1.0, p0 - 1.3 * off, *others, 4, 0.0, 1.0, K)[0]


def test_a_quartic_start_has_no_root_where_it_says() -> None:
    """g = j t^4/24 + ...: with five derivatives bounded, none before 4 j/M5; against the flow itself."""
    rng = random.Random(3)
    checked = 0
    for _ in range(200):
        p = BASE.replace(c=tenths(rng, 0, 60), k=tenths(rng, 1, 60), Omega=tenths(rng, 3, 40))
        K = Path(Start(p, Fraction(0), Fraction(0), Fraction(0), Fraction(1))).K
        # F = G1 = G2 = 0 at theta = 3 pi/2 with the belt's speed v = B0 Omega/k
        v, s0, c0 = K.fB / K.w0sq, -1.0, 0.0
        _, w, j = flow.derivatives(v, 0.0, s0, c0, K)
        assert abs(w) < 1e-9 * abs(j)
        reach = bounds.quartic_start(j, w, s0, c0, K)
        assert reach > 0
        for part in (0.01, 0.3, 0.7, 1.0):
            tau = reach * part
            gain = flow.state_at(tau, v, 0.0, s0, c0, K)[1]
            expected = j * tau**4 / 24
            assert gain * expected > 0
            checked += abs(gain - expected) <= 0.9 * abs(expected)
    assert checked > 600
