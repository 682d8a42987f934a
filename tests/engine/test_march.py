"""Marching in fixed steps: it is the flow, and no wall is met on the way."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from random_constants import constants_of

from symosc.engine.flow import Constants, derivatives, state_at
from symosc.engine.gap_bounds import fourth_derivative_bound
from symosc.engine.march import MARCH_SLACK, crosses_once, march, meets_once, opens, stays_open, whole, within_reach
from symosc.engine.state import Flown, Launch, Walls


def test_marching_is_the_flow_and_stops_before_the_first_contact() -> None:
    rng = random.Random(6)
    marched = 0
    for _ in range(500):
        K = constants_of(rng)
        if not K.apart:
            continue
        v0, a0, theta = rng.uniform(-0.9, 0.9), rng.uniform(-9, 9), rng.uniform(0, 6.28)
        s0, c0 = math.sin(theta), math.cos(theta)
        b, w, j = derivatives(v0, a0, s0, c0, K)
        walls, start = Walls(v0 + 1, 1 - v0, True, True, False, False), Launch(v0, a0, s0, c0)
        now = Flown(0.0, 0.0, 0.0, a0, b, w, j, s0, c0, 1.0, 0.0, 0.0)
        now = march(K.chunk, v0, now, walls, 0.0, K).now
        exact = state_at(now.tau, start, K)
        scale = abs(v0) + K.V0 + abs(a0) / K.w0 + 1
        assert now.dv == pytest.approx(exact.dv, abs=1e-12 * scale)
        assert pytest.approx(exact.F, abs=1e-11 * scale * K.rate) == now.F
        assert pytest.approx(exact.G3, abs=1e-11 * scale * K.rate**4) == now.G3
        assert (now.s, now.c) == pytest.approx((exact.s, exact.c), abs=1e-14)
        marched += now.tau > 0
        for time in np.linspace(0, now.tau, 50):
            assert abs(v0 + state_at(time, start, K).dv) < 1
    assert marched > 50


def launched(v0: float, a0: float, theta: float, K: Constants) -> tuple[Launch, Flown]:
    """Return a launch and the flight there."""
    s, c = math.sin(theta), math.cos(theta)
    G1, G2, G3 = derivatives(v0, a0, s, c, K)
    now = Flown(0.0, 0.0, 0.0, a0, G1, G2, G3, s, c, 1.0, 0.0, 0.0)
    return Launch(v0, a0, s, c), now


def test_a_wall_out_of_reach_is_never_reached() -> None:
    """The flow itself, over many periods of the free motion, keeps the distance that was asked for."""
    rng, answers = random.Random(11), set()
    for _ in range(150):
        K = constants_of(rng)
        if not K.apart:
            continue
        v0, a0, theta = rng.uniform(-2, 2), rng.uniform(-9, 9), rng.uniform(0, 6.28)
        start = launched(v0, a0, theta, K)[0]
        below, above = (10 ** rng.uniform(-1, 2) for _ in range(2))
        slack = rng.choice([0.0, 0.3])
        has = rng.random() < 0.8, rng.random() < 0.8
        v_steady, u_steady = K.Ss * start.s + K.Sc * start.c, K.Ss * start.c - K.Sc * start.s
        walls = Walls(v0 + below, above - v0, *has, False, False)
        near = within_reach(v0, v0 - v_steady, a0 - K.Om * u_steady, slack, walls, K)[2:4]
        speeds = [v0 + state_at(tau, start, K).dv for tau in np.linspace(0, 12 / K.w0, 150)]
        answers |= {near}
        for is_near, there, room in zip(near, has, (below + min(speeds), above - max(speeds)), strict=True):
            assert there or not is_near
            assert is_near or not there or room >= slack - 1e-9
        # ... and no shyer than its two bounds: what the steady motion and the free motion can reach at most
        most = K.V0 + math.hypot(v0 - v_steady, (a0 - K.Om * u_steady) / K.w0)
        for is_near, there, room in zip(near, has, (below - most, above - most), strict=True):
            assert is_near == (there and room < slack) or abs(room - slack) < 1e-9
    assert answers == {(False, False), (False, True), (True, False), (True, True)}


def test_marching_ends_with_the_bound_there_and_only_where_it_must() -> None:
    """It returns M4 of the point that it got to, and stops for the end, a wall in the next step, or patience."""
    rng, ends = random.Random(12), {"end": 0, "wall": 0}
    for _ in range(120):
        K = constants_of(rng)
        if not K.apart:
            continue
        start, now = launched(rng.uniform(-0.9, 0.9), rng.uniform(-9, 9), rng.uniform(0, 6.28), K)
        distance, tau_max = 10 ** rng.uniform(0, 0.7), min(K.chunk, 30 / K.rate)
        walls = Walls(start.v + distance, distance - start.v, True, True, False, False)
        found, M4_there, side, beyond = march(tau_max, start.v, now, walls, 0.0, K)
        there = state_at(found.tau, start, K)
        assert M4_there == pytest.approx(fourth_derivative_bound(there.G2, there.G3, there.s, there.c, K), rel=1e-9)
        if found.tau + K.march.step >= tau_max:
            ends["end"] += 1
        elif side != 0:
            ends["wall"] += 1
            assert beyond.tau == found.tau + K.march.step
            assert side * (start.v + beyond.dv) > distance > side * (start.v + found.dv)
        elif not K.patient:  # seldom: two walls in one step, or a touch
            gap, h = distance - abs(start.v + there.dv), K.march.step
            assert gap < abs(there.F) * h + abs(there.G1) * h**2 / 2 + abs(there.G2) * h**3 / 6 + M4_there * h**4 / 24
    assert min(ends.values()) > 10


def test_marching_keeps_the_margin() -> None:
    """What the start is uncertain by is kept free, beside the slack of the gap's size."""
    rng, marched = random.Random(13), 0
    for _ in range(150):
        K = constants_of(rng)
        if not K.apart:
            continue
        start, now = launched(rng.uniform(-0.5, 0.5), rng.uniform(-3, 3), rng.uniform(0, 6.28), K)
        walls, margin = Walls(start.v + 1, 1 - start.v, True, True, False, False), rng.uniform(0.05, 0.4)
        found = march(K.chunk, start.v, now, walls, margin, K).now
        marched += found.tau > 0
        for tau in np.linspace(0, found.tau, 40)[1:]:
            assert abs(start.v + state_at(tau, start, K).dv) < 1 - margin + MARCH_SLACK
    assert marched > 20


def test_a_wall_that_is_met_in_a_step_is_met_once_and_first() -> None:
    """Against a fine scan: the other wall stays away, and the gap changes its sign once between the two ends."""
    rng, sides = random.Random(14), {-1: 0, 0: 0, 1: 0}
    for _ in range(300):
        K = constants_of(rng)
        if not K.apart:
            continue
        start, now = launched(rng.uniform(-0.9, 0.9), rng.uniform(-9, 9), rng.uniform(0, 6.28), K)
        walls = Walls(start.v + 1, 1 - start.v, True, True, False, False)
        found = march(K.chunk, start.v, now, walls, 0.0, K)
        sides[found.side] += 1
        if found.side != 0:
            low, high = found.now.tau, found.there.tau
            assert low < high < K.chunk
            assert found.there.dv == pytest.approx(state_at(high, start, K).dv, abs=1e-12 * (2 + K.V0 + abs(start.F)))
            beyond = [found.side * (start.v + state_at(t, start, K).dv) > 1 for t in np.linspace(low, high, 60)]
            assert beyond == sorted(beyond)
            assert not beyond[0]
            assert beyond[-1]
            assert all(-found.side * (start.v + state_at(t, start, K).dv) < 1 for t in np.linspace(low, high, 60))
    assert min(sides.values()) > 10


def test_the_bounds_of_a_step_hold_for_all_functions_with_such_a_derivative() -> None:
    """Quintics whose fourth derivative is known: a gap that stays open is positive, a fall or a bend has one root."""
    rng, open_ones, met = random.Random(15), dict.fromkeys(range(4), 0), 0
    for _ in range(2000):
        h, zeros = 10 ** rng.uniform(-1, 1), rng.choice([0, 0, 1, 2, 3])  # derivatives that vanish at the start
        start = [0.0] * zeros if zeros else [abs(rng.gauss(0, 0.3))]
        p = np.polynomial.Polynomial([*start, *(rng.gauss(0, 1) for _ in range(6 - len(start)))])
        t = np.linspace(0, 1, 200)
        M4 = float(np.abs(p.deriv(4)(t)).max()) / h**4
        g0, g1, d0, d1 = (float(q) for q in (p(0.0), p(1.0), p.deriv()(0.0), p.deriv()(1.0)))
        lift, bend = M4 * h**4 / 144, float(p.deriv(2)(0.0))
        if opens(d0, bend, g1, d1, lift, 0.0) if zeros else stays_open(g0, d0, g1, d1, lift, 0.0):
            open_ones[zeros] += 1
            assert (p(t[1:]) > 0).all()
        if g0 > 0 > g1:
            b0, b1 = (float(p.deriv(2)(end)) / h**2 for end in (0.0, 1.0))
            if crosses_once(d0 / h, b0, d1 / h, b1, M4, h):
                met += 1
                assert np.count_nonzero(np.diff(p(t) > 0)) == 1
    assert min(*open_ones.values(), met) > 20


def test_the_bounds_of_a_step_hold_for_quartics_that_come_near_them() -> None:
    """Their fourth derivative is constant, so that Hermite's cubic is as wrong as it can be."""
    rng, near, bent = random.Random(16), 0, 0
    t = np.linspace(0, 1, 100)
    basis = np.array([factor * (1 - t) ** (4 - i) * t**i for i, factor in enumerate((1, 4, 6, 4, 1))])
    for _ in range(2000):
        ends = [abs(rng.gauss(0, 1)) for _ in range(4)]
        c = np.array([0.2 * ends[0], ends[1], -abs(rng.gauss(0, 1.5)), ends[2], 0.2 * ends[3]])
        g0, d0, g1, d1 = c[0], 4 * (c[1] - c[0]), c[4], 4 * (c[4] - c[3])
        M4 = 24 * abs(c @ [1, -4, 6, -4, 1])
        gap = c @ basis
        if gap.min() < 0:
            near += 0.5 * (g0 + g1) + (d0 - d1) / 6 > 0.3 * M4 / 144  # where a bound of a third would let it through
            assert not stays_open(g0, d0, g1, d1, M4 / 144, 0.0)
        b0, b1, bound = ends[0], ends[1], 8 * ends[2]  # a bend whose second derivative is that bound
        if (b0 * (1 - t) + b1 * t - 0.5 * bound * t * (1 - t)).min() < 0:
            bent += b0 + b1 > 0.3 * bound / 2
            assert not crosses_once(1.0, b0, -1.0, b1, bound, 1.0)
    assert min(near, bent) > 10


def test_a_gap_that_is_no_larger_than_its_slack_is_not_met() -> None:
    """Nor is it met where the step begins on the wall; a launch keeps its derivatives, which may be exactly 0."""
    K = constants_of(random.Random(17))
    walls = Walls(0.5, 9.0, True, True, False, False)
    point = Flown(0.3, 0.0, -0.4, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    for gap, met in ((-2e-3, True), (-1e-4, False), (1e-4, False), (0.1, False)):
        there = point._replace(tau=0.4, dv=gap - walls.below)
        assert meets_once(-1, point, there, 0.0, 1e-3, walls) == met
        assert not meets_once(-1, point._replace(dv=-walls.below), there, 0.0, 1e-3, walls)
    launch = point._replace(tau=0.0)
    assert whole(launch, 0.0, K) is launch
    assert whole(point, 0.0, K)[4:7] == derivatives(point.dv, point.F, point.s, point.c, K)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_wall_that_is_met_once_is_judged_by_the_gap_to_it(side: int) -> None:
    """The upper wall's gap falls as v rises: slope and bend are those of the gap, at both ends of the step."""
    rng, seen = random.Random(side), set()
    for _ in range(300):
        h, size = rng.uniform(0.1, 1.0), rng.uniform(0.1, 1.0)
        gaps = rng.choice([0.3, 0.01, -0.2]), rng.choice([-0.3, -0.01, 0.2])
        slopes, bends = ([rng.uniform(-3, 1) for _ in range(2)] for _ in range(2))
        M4, slack = rng.choice([0.0, 1.0, 20.0]), 0.02
        ends = [
            state_like(tau, -side * (gap - size), -side * slope, -side * bend)
            for tau, gap, slope, bend in zip((2.0, 2.0 + h), gaps, slopes, bends, strict=True)
        ]
        walls = Walls(size, size, True, True, False, False)
        apart = gaps[0] > slack and gaps[1] < -slack
        right = apart and crosses_once(slopes[0], bends[0], slopes[1], bends[1], M4, h)
        assert meets_once(side, *ends, M4, slack, walls) == right
        seen.add((apart, right))
    assert seen == {(False, False), (True, False), (True, True)}


def state_like(tau: float, dv: float, F: float, G1: float) -> Flown:
    return Flown(tau, 0.0, dv, F, G1, *[0.0] * (len(Flown._fields) - 5))


def test_a_wall_that_is_only_come_near_to_is_not_met() -> None:
    """The lowest velocity of a flight is just above the wall, or below: only then it is met, at the end of the step."""
    rng, sides = random.Random(21), {-1: 0, 0: 0}
    for _ in range(150):
        K = constants_of(rng)
        if not K.apart:
            continue
        start, now = launched(rng.uniform(-0.9, 0.9), rng.uniform(-9, 9), rng.uniform(0, 6.28), K)
        tau_max = min(K.chunk, 30 / K.rate)
        scan = [start.v + state_at(tau, start, K).dv for tau in np.linspace(0, tau_max, 60)]
        if scan.index(min(scan)) in (0, 59):
            continue
        wall = min(scan) + rng.choice([-1, 1]) * 10 ** rng.uniform(-4, -1)
        if start.v - wall < 0.01:
            continue
        walls = Walls(start.v - wall, 1e6, True, True, False, False)
        found, _, side, beyond = march(tau_max, start.v, now, walls, 0.0, K)
        if found.tau + K.march.step >= tau_max:
            continue
        sides[side] += 1
        assert (side == 0) or start.v + beyond.dv < wall
    assert min(sides.values()) > 3
