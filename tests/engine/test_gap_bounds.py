"""Bounds of the gap: each is a bound, and when a root is taken for the only one, and how far a touch reaches."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from agreement import BASE
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_constants import constants_of
from touches import tenths

from symosc.engine import first_exit, flow, gap_bounds, touches
from symosc.engine.flow import derivatives, state_at
from symosc.engine.gap_bounds import fourth_derivative_bound, positive_on, safe_step
from symosc.engine.start import Start
from symosc.engine.state import Covariance, FlightEnd, Launch, Walls
from symosc.simulation.motion import Motion

pytestmark = pytest.mark.usefixtures("interpreted")

COEFFICIENTS = st.floats(-5, 5)


def taylor(root: float, slope: float, bend: float) -> tuple[float, ...]:
    """Return the coefficients p0 to p4 of slope (root - s) + bend (root - s)^2/2."""
    return slope * root + bend * root**2 / 2, -slope - bend * root, bend / 2, 0.0, 0.0


def test_a_root_is_near_only_if_it_is_the_only_one_there() -> None:
    """Each guard alone says no: a slope that is not down, a loose bound, a turn before what is missing is made up."""
    K = flow.constants(BASE)
    assert gap_bounds.is_near(0.01, (*taylor(0.01, 1.0, 0.0), 4), 0.0, 1.0, K) == (True, True, True)
    assert not gap_bounds.is_near(0.01, (*taylor(0.01, -1.0, 0.0), 4), 0.0, 1.0, K)[0]
    assert not gap_bounds.is_near(0.01, (*taylor(0.01, 0.0, 0.0), 4), 0.0, 1.0, K)[0]
    # missing = M4 root^4/12 against ISOLATED slope/rate
    edge = 12 * gap_bounds.ISOLATED / (K.rate * 1.0)
    assert gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 0.0), 4), 0.9 * edge, 1.0, K)[0]
    assert not gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 0.0), 4), 1.1 * edge, 1.0, K)[0]
    # 8 SHRINK root bend < slope: the slope keeps its sign on what a safe step leaves open
    edge = 1 / (8 * gap_bounds.SHRINK)
    assert gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 0.9 * edge), 4), 0.0, 1.0, K)[0]
    assert not gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 1.1 * edge), 4), 0.0, 1.0, K)[0]
    # 8 missing (bend root + slope) < slope^2 root
    edge = 12 / (8 * (100.0 + 1.0))
    assert gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 100.0), 4), 0.9 * edge, 1.0, K)[0]
    assert not gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 100.0), 4), 1.1 * edge, 1.0, K)[0]


def test_a_root_is_close_if_taylor_reaches_it_and_clear_if_the_gap_is_deep_behind() -> None:
    K = flow.constants(BASE)
    edge = 12 * gap_bounds.NEAR / K.rate
    assert gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 0.0), 4), 0.9 * edge, 1.0, K)[1]
    assert not gap_bounds.is_near(1.0, (*taylor(1.0, 1.0, 0.0), 4), 1.1 * edge, 1.0, K)[1]
    size, bend = 3.0, 2.0  # depth behind the root: slope^2/(2 bend)
    slope = math.sqrt(2 * gap_bounds.CLEAR_DEPTH * size * bend)
    assert gap_bounds.is_near(1e-6, (*taylor(1e-6, 1.01 * slope, bend), 4), 0.0, size, K)[2]
    assert not gap_bounds.is_near(1e-6, (*taylor(1e-6, 0.99 * slope, bend), 4), 0.0, size, K)[2]
    # a divided polynomial: the gap is root times it for each degree that is missing
    far = 1e-3
    slope = math.sqrt(2 * gap_bounds.CLEAR_DEPTH * size * bend / far)
    assert gap_bounds.is_near(far, (*taylor(far, 1.01 * slope, bend), 3), 0.0, size, K)[2]
    assert not gap_bounds.is_near(far, (*taylor(far, 0.99 * slope, bend), 3), 0.0, size, K)[2]


def test_what_is_missing_counts_the_rest_of_the_polynomial() -> None:
    """A root that Halley's method has not reached yet leaves a value, which counts like the bound."""
    K = flow.constants(BASE)
    off = 0.9 * gap_bounds.ISOLATED / K.rate
    p0, *others = taylor(1.0, 1.0, 0.0)
    assert gap_bounds.is_near(1.0, (p0 + off, *others, 4), 0.0, 1.0, K)[0]
    assert gap_bounds.is_near(1.0, (p0 - off, *others, 4), 0.0, 1.0, K)[0]
    assert not gap_bounds.is_near(1.0, (p0 + 1.3 * off, *others, 4), 0.0, 1.0, K)[0]
    assert not gap_bounds.is_near(1.0, (p0 - 1.3 * off, *others, 4), 0.0, 1.0, K)[0]


def test_a_quartic_start_has_no_root_where_it_says() -> None:
    """g = j t^4/24 + ...: with five derivatives bounded, none before 4 j/M5; against the flow itself."""
    rng = random.Random(3)
    checked = 0
    for _ in range(200):
        p = BASE.replace(c=tenths(rng, 0, 60), k=tenths(rng, 1, 60), Omega=tenths(rng, 3, 40))
        K = Motion(Start(p, Fraction(0), Fraction(0), Fraction(0), Fraction(1))).K
        # F = G1 = G2 = 0 at theta = 3 pi/2 with the belt's speed v = B0 Omega/k
        v, s0, c0 = K.fB / K.w0sq, -1.0, 0.0
        _, w, j = flow.derivatives(v, 0.0, s0, c0, K)
        assert abs(w) < 1e-9 * abs(j)
        reach = gap_bounds.quartic_start(j, w, s0, c0, K)
        assert reach > 0
        for part in (0.01, 0.3, 0.7, 1.0):
            tau = reach * part
            gain = flow.state_at(tau, Launch(v, 0.0, s0, c0), K).dv
            expected = j * tau**4 / 24
            assert gain * expected > 0
            checked += abs(gain - expected) <= 0.9 * abs(expected)
    assert checked > 600


def fifth_at_most(j: float, w: float, K: flow.Constants) -> float:
    """Return the largest |v^(5)| of a free oscillation with the derivatives w and j at the start, by looking."""
    omega = math.sqrt(K.w0sq)
    return max(abs(j * omega * math.cos(a) - w * K.w0sq * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 1001))


def test_the_reach_of_a_quartic_start_is_what_taylor_proves() -> None:
    """|g - j tau^4/24| <= M5 tau^5/120: no root before 5 |j|/M5, and some margin; free motion attains its bound."""
    rng = random.Random(4)
    for _ in range(50):
        k, m = tenths(rng, 1, 90), tenths(rng, 2, 30)
        K = flow.constants(BASE.replace(B0=0, c=0, k=k, m=m, Omega="0.01"))
        assert K.steady
        j, w = rng.uniform(-3, 3), rng.uniform(-1, 1)
        reach = gap_bounds.quartic_start(j, w, -1.0, 0.0, K)
        assert 3 * abs(j) <= reach * fifth_at_most(j, w, K) <= 5 * abs(j)


def test_the_reach_of_a_quartic_start_without_any_motion() -> None:
    K = flow.constants(BASE.replace(B0=0, c=0, Omega="0.01"))
    assert K.steady
    assert gap_bounds.quartic_start(0.0, 0.0, -1.0, 0.0, K) == K.chunk


def test_the_reach_of_a_quartic_start_at_resonance_is_no_longer_than_its_bound_holds() -> None:
    K = flow.constants(BASE.replace(m=1, c=0, k=4, Omega=2))
    assert not K.steady
    assert gap_bounds.quartic_start(1e9, 0.0, -1.0, 0.0, K) == 1 / K.Om
    j, w = 1e-3, 1e-3
    reach = gap_bounds.quartic_start(j, w, -1.0, 0.0, K)
    assert reach * K.Om < 1
    assert 3 * j <= reach * (fifth_at_most(j, w, K) + K.fB * K.Om**3) <= 5.5 * j


# -- a step that goes too far ------------------------------------------------------------------------------------------


def searched(side: int, monkeypatch: pytest.MonkeyPatch, overshoot: bool = True) -> FlightEnd:
    """Return what a search ends with towards one of two walls, if its first step goes past the belt.

    In real arithmetic no step does; by rounding one may, and it has to be noticed.
    """
    K = flow.constants(BASE.replace(B0=0, c=0, k=1, m=1))
    if overshoot:
        steps = iter([1.0])
        usual = first_exit.safe_step
        monkeypatch.setattr(
            first_exit,
            "safe_step",
            lambda cap, *p: (next(steps, None) or usual(cap, *p)[0], cap),  # and no root is known
        )
        monkeypatch.setattr(first_exit, "positive_on", lambda *_: True)
    K = K._replace(apart=False)  # no marching
    # v = side * sin(tau): it meets the wall side * 1/2 at pi/6, the other one never
    walls = Walls(0.5 if side < 0 else 9.0, 0.5 if side > 0 else 9.0, True, True, False, False)
    return first_exit.first_exit(3.0, Launch(0.0, float(side), 0.0, 1.0), walls, Covariance(0.0, 0.0, 0.0), K)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_step_past_a_belt_goes_back_to_the_contact(side: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for overshoot in (False, True):
        code, found, now = searched(side, monkeypatch, overshoot)
        assert (code, found) == (first_exit.HIT, side)
        assert abs(now.tau - math.pi / 6) < 1e-14


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(("verdict", "code"), [(touches.TANGENCY, touches.TANGENCY), (touches.LOST, touches.STALLED)])
def test_a_step_past_a_belt_may_have_met_a_touch(
    side: int, verdict: int, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If what is near is no crossing as far as this precision tells, it is not made one."""
    asked = []

    def nearest(tau: float, earliest: float, towards: int, *_: Any) -> tuple[int, float]:
        asked.append((tau, earliest, towards))
        return verdict, 0.25

    monkeypatch.setattr(first_exit, "closest_approach", nearest)
    found = searched(side, monkeypatch)
    assert asked[-1] == (1.0, 0.0, side)
    assert found[:2] == (code, side)
    if verdict == first_exit.TANGENCY:
        assert found.now.tau == 0.25


@pytest.mark.slow
@given(st.tuples(*[COEFFICIENTS] * 5), st.floats(0.01, 3))
@settings(derandomize=True, deadline=None, suppress_health_check=list(HealthCheck), max_examples=300)
def test_positive_bernstein_coefficients_mean_a_positive_polynomial(p: tuple[float, ...], s: float) -> None:
    values = np.polyval(p[::-1], np.linspace(0, s, 200))
    if positive_on(s, *p):
        assert values.min() > -1e-12
    elif p[0] > 0:  # not too shy: on a tenth of the way to the nearest possible root it says so
        reach = p[0] / (p[0] + max(map(abs, p[1:])))
        assert positive_on(min(0.1 * reach, s), *p)


@pytest.mark.slow
@given(st.floats(1e-6, 5), st.tuples(*[COEFFICIENTS] * 3), st.floats(0.01, 5))
@settings(derandomize=True, deadline=None, suppress_health_check=list(HealthCheck), max_examples=500)
def test_a_safe_step_stays_before_the_first_root(p0: float, middle: tuple[float, ...], p4: float) -> None:
    p = (p0, *middle, -p4)
    step, root = safe_step(10.0, *p)
    roots = np.roots(p[::-1])
    first = min((r.real for r in roots if abs(r.imag) < 1e-9 and r.real > 0), default=math.inf)
    assert 0 < step <= first * (1 + 1e-9)
    if root < 10.0:
        assert root == pytest.approx(first, rel=1e-4)


def test_the_fourth_derivative_stays_within_its_bound() -> None:
    rng = random.Random(5)
    for _ in range(200):
        K = constants_of(rng)
        v0, a0, theta = rng.uniform(-3, 3), rng.uniform(-20, 20), rng.uniform(0, 6.28)
        s0, c0 = math.sin(theta), math.cos(theta)
        _, w, j = derivatives(v0, a0, s0, c0, K)
        bound = fourth_derivative_bound(w, j, s0, c0, K)
        reach = 20 / K.rate if K.steady else 1 / K.Om
        for tau in np.linspace(0, reach, 60):
            assert abs(state_at(tau, Launch(v0, a0, s0, c0), K).G3) <= bound * (1 + 1e-9)
