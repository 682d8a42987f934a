"""The search for the end of a flight or a stick.

No contact is passed over, its bounds are bounds, and its cost.
"""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from symosc import Parameters
from symosc.engine import first_exit as exits
from symosc.engine.arithmetic import Arithmetic, MpArithmetic
from symosc.engine.first_exit import (
    belt_exit,
    first_exit,
    force_gain,
    fourth_derivative_bound,
    march,
    positive_on,
    safe_step,
)
from symosc.engine.flow import BeltConstants, Constants, derivatives, state_at, velocity_scale
from symosc.engine.state import HIT, NOTHING, TANGENCY, Covariance, Flown, Launch, State, Walls
from symosc.kernels.entire import EPS

pytestmark = pytest.mark.usefixtures("interpreted")


def parameters_of(rng: random.Random, **fixed: object) -> Parameters:
    """Return random parameters: under- and overdamped, near resonance and far from it."""
    numbers = {
        name: round(10 ** rng.uniform(-1, 1), 6) for name in ("m", "c", "k", "B0", "Omega", "FN")
    }
    if rng.random() < 0.3:
        numbers |= {
            "k": numbers["m"] * numbers["Omega"] ** 2,
            "c": round(10 ** rng.uniform(-9, -2), 12),
        }
    return Parameters(**(numbers | {"A0": 1, "v1": -1, "v2": 1, "mu1": 0.3, "mu2": 0.2} | fixed))


def constants_of(rng: random.Random, **fixed: object) -> Constants:
    """Return constants of random parameters."""
    return Arithmetic(parameters_of(rng, **fixed)).K


@pytest.mark.slow
def test_no_contact_is_passed_over() -> None:
    """Against the signs of a fine scan.

    An independent check that can only miss what is shorter than its step.
    """
    rng = random.Random(8)
    hits = 0
    for _ in range(100):
        K = constants_of(rng)
        v0 = rng.uniform(-0.95, 0.95)
        a0 = rng.uniform(-9, 9)
        theta = rng.uniform(0, 6.28)
        start = Launch(v0, a0, math.sin(theta), math.cos(theta))
        walls = Walls(v0 + 1, 1 - v0, True, True, False, False)
        code, side, now = first_exit(K.chunk, start, walls, Covariance(0.0, 0.0, 0.0), K)
        assert code in (HIT, NOTHING)
        before = np.linspace(0, now.tau, 400)[:-1]
        assert all(abs(v0 + state_at(time, start, K).dv) < 1 for time in before)
        if code == HIT:
            hits += 1
            assert v0 + state_at(now.tau, start, K).dv == pytest.approx(
                side, abs=1e-13 * (1 + abs(a0))
            )
    assert hits > 30


def test_a_root_near_0_is_found_to_the_resolution() -> None:
    """Of a quartic whose root is known.

    Simple roots, and such whose slope, bend or third derivative is small there.
    """
    rng = random.Random(31)
    for _ in range(4000):
        root = 10 ** rng.uniform(-6, -1) * rng.choice([-1, 1])
        resolution = 10 ** rng.uniform(-12, -6)
        F, G1, G2, G3 = (10 ** rng.uniform(-3, 1) * rng.choice([-1, 1]) for _ in range(4))
        G1 = G1 - rng.choice([0, 1]) * (G1 + G2 * root)
        G2 = G2 - rng.choice([0, 0.99]) * (G2 + G3 * root)
        if abs(root) * (abs(G1) + abs(G2) + abs(G3)) > 0.2 * abs(F):
            continue  # then another root may be as near
        over = -(F + (G1 / 2 + (G2 / 6 + G3 / 24 * root) * root) * root) * root
        computed = exits.local_root(over, F, G1, G2, G3, resolution)
        assert abs(computed - root) <= resolution + 1e-15


COEFFICIENTS = st.floats(-5, 5)


@pytest.mark.slow
@given(st.tuples(*[COEFFICIENTS] * 5), st.floats(0.01, 3))
@settings(
    derandomize=True, deadline=None, suppress_health_check=list(HealthCheck), max_examples=100
)
def test_positive_bernstein_coefficients_mean_a_positive_polynomial(
    p: tuple[float, ...], s: float
) -> None:
    values = np.polyval(p[::-1], np.linspace(0, s, 200))
    if positive_on(s, p):
        assert values.min() > -1e-12
    elif p[0] > 0:  # not too shy: on a tenth of the way to the nearest possible root it says so
        reach = p[0] / (p[0] + max(map(abs, p[1:])))
        assert positive_on(min(0.1 * reach, s), p)


@pytest.mark.slow
@given(st.floats(1e-6, 5), st.tuples(*[COEFFICIENTS] * 3), st.floats(0.01, 5))
@settings(
    derandomize=True, deadline=None, suppress_health_check=list(HealthCheck), max_examples=150
)
def test_a_safe_step_stays_before_the_first_root(
    p0: float, middle: tuple[float, ...], p4: float
) -> None:
    p = (p0, *middle, -p4)
    step, root = safe_step(10.0, p)
    roots = np.roots(p[::-1])
    first = min((r.real for r in roots if abs(r.imag) < 1e-9 and r.real > 0), default=math.inf)
    assert 0 < step <= first * (1 + 1e-9)
    if root < 10.0:
        assert root == pytest.approx(first, rel=1e-4)


def test_gaps_are_wrong_by_few_roundings() -> None:
    """A gap in doubles beside the same one with 40 digits: at most 6 of the 64 units of ROUNDING."""
    rng = random.Random(9)
    worst = 0.0
    for _ in range(40):
        p = parameters_of(rng)
        K = Arithmetic(p).K
        finer = MpArithmetic(p, 40, fast=False)
        number = finer.context.mpf
        theta = rng.uniform(0, 6.28)
        start = Launch(rng.uniform(-3, 3), rng.uniform(-20, 20), math.sin(theta), math.cos(theta))
        exact_start = Launch(*map(number, start))
        for _ in range(20):
            tau = K.chunk * rng.random() ** 3
            now = state_at(tau, start, K)
            exact = finer.namespace["state_at"](number(tau), exact_start, finer.K)
            size = velocity_scale(tau, start.v, start.F, K)
            size += (abs(K.f0) + K.cm * abs(start.v)) * abs(now.E1)
            worst = max(worst, float(abs(now.dv - exact.dv)) / (EPS * size))
    assert 1.0 < worst <= 6.0


def test_the_fourth_derivative_stays_within_its_bound() -> None:
    rng = random.Random(5)
    for _ in range(80):
        K = constants_of(rng)
        v0 = rng.uniform(-3, 3)
        a0 = rng.uniform(-20, 20)
        theta = rng.uniform(0, 6.28)
        s0 = math.sin(theta)
        c0 = math.cos(theta)
        _, w, j = derivatives(v0, a0, s0, c0, K)
        bound = fourth_derivative_bound(w, j, s0, c0, K)
        if K.steady:
            reach = 20 / K.rate
        else:
            reach = 1 / K.Om
        for tau in np.linspace(0, reach, 60):
            assert abs(state_at(tau, Launch(v0, a0, s0, c0), K).G3) <= bound * (1 + 1e-9)


def launched(v0: float, a0: float, theta: float, K: Constants) -> tuple[Launch, Flown]:
    """Return a launch and the flight there."""
    s = math.sin(theta)
    c = math.cos(theta)
    G1, G2, G3 = derivatives(v0, a0, s, c, K)
    now = Flown(0.0, 0.0, 0.0, a0, G1, G2, G3, s, c, 1.0, 0.0, 0.0)
    return Launch(v0, a0, s, c), now


def test_a_wall_that_is_met_in_a_step_is_met_once_and_first() -> None:
    """Against a fine scan: the other wall stays away, and the gap changes its sign once between the two ends."""
    rng = random.Random(14)
    sides = {-1: 0, 0: 0, 1: 0}
    for _ in range(150):
        K = constants_of(rng)
        if not K.apart:
            continue
        start, now = launched(rng.uniform(-0.9, 0.9), rng.uniform(-9, 9), rng.uniform(0, 6.28), K)
        walls = Walls(start.v + 1, 1 - start.v, True, True, False, False)
        computed = march(K.chunk, start.v, now, walls, 0.0, K)
        sides[computed.side] += 1
        if computed.side != 0:
            low = computed.now.tau
            high = computed.there.tau
            assert low < high < K.chunk
            assert computed.there.dv == pytest.approx(
                state_at(high, start, K).dv, abs=1e-12 * (2 + K.V0 + abs(start.F))
            )
            beyond = [
                computed.side * (start.v + state_at(t, start, K).dv) > 1
                for t in np.linspace(low, high, 60)
            ]
            assert beyond == sorted(beyond)
            assert not beyond[0]
            assert beyond[-1]
            assert all(
                -computed.side * (start.v + state_at(t, start, K).dv) < 1
                for t in np.linspace(low, high, 60)
            )
    assert min(sides.values()) > 5


def holding(Fb: float, Fa: float, theta: float, s: float, c: float, S11: float = 0.0) -> State:
    """Return the state at the beginning of a stick."""
    S = Covariance(S11, 0.0, 0.0)
    return State(4, 1, 0, theta, 0.0, 0.0, Fb, Fa, S, 0.0, 0.0, s, c, 0.0)


def test_the_end_of_a_stick_is_the_first() -> None:
    rng = random.Random(9)
    ends = 0
    for _ in range(120):
        K = constants_of(rng, v1=round(rng.uniform(-2, 0.5), 3))
        belt = K.belt1
        theta = rng.uniform(0, 2 * math.pi)
        below = rng.uniform(0.01, 0.99) * belt.J
        s0 = math.sin(theta)
        c0 = math.cos(theta)
        code, side, tau, *_ = belt_exit(
            K.period, holding(below, below - belt.J, theta, s0, c0), belt, K
        )
        inside = [
            below + force_gain(time, s0, c0, belt, K)[0] for time in np.linspace(0, tau, 300)[:-1]
        ]
        assert all(0 < force < belt.J for force in inside)
        if code == HIT:
            ends += 1
            force = below + force_gain(tau, s0, c0, belt, K)[0]
            assert force == pytest.approx(
                0 if side < 0 else belt.J, abs=1e-13 * (belt.J + abs(K.f0))
            )
    assert ends > 40


@pytest.mark.parametrize("below", [0.0, 0.3, 1.0])
def test_constant_forces_never_end_a_stick(below: float) -> None:
    """Without drive and spring's pull nothing changes, not even where a force is 0 already."""
    K = constants_of(random.Random(3), B0=0, v1=0)
    belt = K.belt1
    theta = 1.2
    held = holding(below * belt.J, (below - 1) * belt.J, theta, math.sin(theta), math.cos(theta))
    end = belt_exit(K.period, held, belt, K)
    assert (end.code, end.tau, end.Delta) == (NOTHING, K.period, 0.0)


def test_a_force_that_only_touches_0_is_a_touch() -> None:
    """Where the force turns, within the error of the position.

    Deeper it is an exit, clear of it the stick lasts.
    """
    rng = random.Random(11)
    codes = set()
    for _ in range(150):
        K = constants_of(rng, v1=round(rng.uniform(-2, 0.5), 3))
        belt = K.belt1
        theta = rng.uniform(0, 2 * math.pi)
        s0 = math.sin(theta)
        c0 = math.cos(theta)
        if not belt.turns:
            continue
        grid = np.linspace(0, K.period, 20001)
        Delta = gain_of(grid, s0, c0, belt, K)
        inner = 1 + np.flatnonzero((np.diff(Delta)[:-1] < 0) & (np.diff(Delta)[1:] > 0))
        if (
            len(inner) != 1
            or Delta[inner[0]] > -1e-3 * abs(K.f0)
            or Delta[: inner[0]].max() > 0.5 * belt.J
        ):
            continue  # the force below is to fall first
        depth = -float(Delta[inner[0]])
        turn = grid[inner[0]]
        S11 = 1e-12
        noise = K.sigmas * K.w0sq * 1e-6
        for part, code in ((0.5, TANGENCY), (-0.5, TANGENCY), (-3.0, HIT), (3.0, None)):
            below = depth + part * noise
            if 1.5 * below + Delta.max() > belt.J:
                continue
            end = belt_exit(K.period, holding(below, below - belt.J, theta, s0, c0, S11), belt, K)
            if code is None:
                assert end.code == NOTHING or end.tau > turn + 1e-6
                continue
            codes.add(end.code)
            assert (end.code, end.side) == (code, -1)
            assert end.tau == pytest.approx(
                turn, abs=2e-3 * K.period + 10 * math.sqrt(noise / abs(K.fB * K.Om))
            )
    assert codes == {TANGENCY, HIT}


def gain_of(
    times: np.ndarray, s0: float, c0: float, belt: BeltConstants, K: Constants
) -> np.ndarray:
    """Return what the forces gain, from their slope -(k v + B0 Omega sin)/m integrated."""
    return belt.drift * times + K.f0 * (c0 * np.cos(K.Om * times) - s0 * np.sin(K.Om * times) - c0)
