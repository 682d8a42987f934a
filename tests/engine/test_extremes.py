"""Rows of a batch, its memory, and the extremes of its summaries."""

from __future__ import annotations

import random
from math import cos, sin

import numpy as np
import pytest
from regimes import random_sets

from symosc import Parameters
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import Constants, state_at
from symosc.engine.state import Flown, Launch
from symosc.engine.summary import Extremes, Open, flight_extremes, widened
from symosc.kernels._generated import acceleration


def flight(p: Parameters, dice: random.Random) -> tuple[Constants, Launch, float, Flown]:
    K = Arithmetic(p.replace(v1=-(10**6), v2=10**6)).K
    theta = dice.uniform(0, 6.28)
    x = dice.uniform(-5, 5)
    v = dice.uniform(-5, 5)
    F = acceleration(x, v, cos(theta), K.A2, K.cm, K.w0sq, K.f0)
    start = Launch(v, F, sin(theta), cos(theta))
    duration = dice.choice((0.1, 0.5, 1.0)) * min(K.chunk, 60 / K.rate)
    return K, start, x, state_at(duration, start, K)


def extremes_of(K: Constants, start: Launch, x: float, last: Flown) -> Extremes:
    ends = widened(Extremes(x, x, start.v, start.v), x + last.dx, start.v + last.dv)
    return flight_extremes(0.0, last, start, x, ends, Open(True, True, True), K)


@pytest.mark.parametrize("seed", range(4))
def test_no_sample_is_beyond_the_extremes_and_they_are_reached(seed: int) -> None:
    """In all regimes: critical damping, resonance, no spring, no drive."""
    dice = random.Random(seed)
    for p in random_sets(seed, 12):
        K, start, x, last = flight(p, dice)
        computed = extremes_of(K, start, x, last)
        points = [state_at(tau, start, K) for tau in np.linspace(0, last.tau, 300)[1:-1].tolist()]
        sampled = np.array(
            [
                (x, start.v),
                (x + last.dx, start.v + last.dv),
                *((x + q.dx, start.v + q.dv) for q in points),
            ]
        )
        size = abs(sampled).max()
        gaps = (
            np.array(computed)[[0, 2]] - sampled.min(axis=0),
            sampled.max(axis=0) - np.array(computed)[[1, 3]],
        )
        assert max(map(np.max, gaps)) <= 1e-14 * size, p
        assert min(map(np.min, gaps)) >= -1e-2 * size, p
