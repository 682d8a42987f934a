"""The end of a stick: it is the first time at which a force vanishes."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from random_constants import constants_of

from symosc.engine.state import HIT, NOTHING, Hold
from symosc.engine.stick_exit import belt_exit, gain


def test_the_end_of_a_stick_is_the_first() -> None:
    rng = random.Random(9)
    ends = 0
    for _ in range(300):
        K = constants_of(rng, v1=round(rng.uniform(-2, 0.5), 3))
        belt, theta = K.belt1, rng.uniform(0, 2 * math.pi)
        below = rng.uniform(0.01, 0.99) * belt.J
        s0, c0 = math.sin(theta), math.cos(theta)
        code, side, tau, _, _, _ = belt_exit(K.period, Hold(below, below - belt.J, theta, s0, c0), 0.0, belt, K)
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
