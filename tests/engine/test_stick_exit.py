"""The end of a stick: it is the first time at which a force vanishes."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from random_constants import constants_of

from symosc.engine.flow import BeltConstants, Constants
from symosc.engine.state import HIT, NOTHING, TANGENCY, Hold
from symosc.engine.stick_exit import belt_exit, gain, slopes


def test_the_end_of_a_stick_is_the_first() -> None:
    rng = random.Random(9)
    ends = 0
    for _ in range(300):
        K = constants_of(rng, v1=round(rng.uniform(-2, 0.5), 3))
        belt, theta = K.belt1, rng.uniform(0, 2 * math.pi)
        below = rng.uniform(0.01, 0.99) * belt.J
        s0, c0 = math.sin(theta), math.cos(theta)
        code, side, tau, *_ = belt_exit(K.period, Hold(below, below - belt.J, theta, s0, c0), 0.0, belt, K)
        inside = [below + gain(time, s0, c0, belt, K)[0] for time in np.linspace(0, tau, 300)[:-1]]
        assert all(0 < force < belt.J for force in inside)
        if code == HIT:
            ends += 1
            force = below + gain(tau, s0, c0, belt, K)[0]
            assert force == pytest.approx(0 if side < 0 else belt.J, abs=1e-13 * (belt.J + abs(K.f0)))
    assert ends > 100


@pytest.mark.parametrize("below", [0.0, 0.3, 1.0])
def test_constant_forces_never_end_a_stick(below: float) -> None:
    """Without drive and spring's pull nothing changes, not even where a force is 0 already."""
    K = constants_of(random.Random(3), B0=0, v1=0)
    belt, theta = K.belt1, 1.2
    held = Hold(below * belt.J, (below - 1) * belt.J, theta, math.sin(theta), math.cos(theta))
    end = belt_exit(K.period, held, 0.0, belt, K)
    assert (end.code, end.tau, end.Delta) == (NOTHING, K.period, 0.0)


def test_a_stick_that_lasts_has_no_side() -> None:
    rng, lasts = random.Random(10), 0
    for _ in range(200):
        K = constants_of(rng, v1=round(rng.uniform(-2, 0.5), 3))
        belt, theta = K.belt1, rng.uniform(0, 2 * math.pi)
        below, tau_max = rng.uniform(0.01, 0.99) * belt.J, K.period * rng.choice([0.01, 0.3, 1.0])
        hold = Hold(below, below - belt.J, theta, math.sin(theta), math.cos(theta))
        end = belt_exit(tau_max, hold, 0.0, belt, K)
        if end.code == NOTHING:
            lasts += 1
            assert (end.side, end.tau) == (0, tau_max)
            assert end.Delta == pytest.approx(gain(tau_max, hold.s, hold.c, belt, K)[0], abs=1e-12 * (1 + abs(K.f0)))
        else:
            assert abs(end.side) == 1
            Delta, s, c = gain(end.tau, hold.s, hold.c, belt, K)
            slope, bend = slopes(s, c, belt, K)
            phase = hold.theta + K.Om * end.tau
            assert (end.s, end.c) == pytest.approx((math.sin(phase), math.cos(phase)), abs=4e-15)
            size = (1 + abs(K.f0)) * (1 + K.Om) ** 2
            assert (end.Delta, end.slope) == pytest.approx((Delta, slope), abs=1e-9 * size)
            assert end.bend == pytest.approx(bend, abs=1e-5 * size)
    assert lasts > 50


def test_a_force_that_only_touches_0_is_a_touch() -> None:
    """Where the force turns, within the error of the position; deeper it is an exit, clear of it the stick lasts."""
    rng, codes = random.Random(11), set()
    for _ in range(150):
        K = constants_of(rng, v1=round(rng.uniform(-2, 0.5), 3))
        belt, theta = K.belt1, rng.uniform(0, 2 * math.pi)
        s0, c0 = math.sin(theta), math.cos(theta)
        if not belt.turns:
            continue
        grid = np.linspace(0, K.period, 20001)
        Delta = gain_of(grid, s0, c0, belt, K)
        inner = 1 + np.flatnonzero((np.diff(Delta)[:-1] < 0) & (np.diff(Delta)[1:] > 0))
        if len(inner) != 1 or Delta[inner[0]] > -1e-3 * abs(K.f0) or Delta[: inner[0]].max() > 0.5 * belt.J:
            continue  # the force below is to fall first
        depth, turn, S11 = -float(Delta[inner[0]]), grid[inner[0]], 1e-12
        noise = K.sigmas * K.w0sq * 1e-6
        for part, code in ((0.5, TANGENCY), (-0.5, TANGENCY), (-3.0, HIT), (3.0, None)):
            below = depth + part * noise
            if 1.5 * below + Delta.max() > belt.J:
                continue
            end = belt_exit(K.period, Hold(below, below - belt.J, theta, s0, c0), S11, belt, K)
            if code is None:
                assert end.code == NOTHING or end.tau > turn + 1e-6
                continue
            codes.add(end.code)
            assert (end.code, end.side) == (code, -1)
            assert end.tau == pytest.approx(turn, abs=2e-3 * K.period + 10 * math.sqrt(noise / abs(K.fB * K.Om)))
    assert codes == {TANGENCY, HIT}


def gain_of(times: np.ndarray, s0: float, c0: float, belt: BeltConstants, K: Constants) -> np.ndarray:
    """Return what the forces gain, from their slope -(k v + B0 Omega sin)/m integrated."""
    return belt.drift * times + K.f0 * (c0 * np.cos(K.Om * times) - s0 * np.sin(K.Om * times) - c0)
