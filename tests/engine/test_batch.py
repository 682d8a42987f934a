"""Rows of a batch, its memory, and the extremes of its summaries."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise
from math import cos, sin
from typing import Any

import mpmath
import numpy as np
import pytest
from oracle import flow_oracle
from random_constants import constants_of
from regimes import random_sets

from symosc import Parameters
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.batch import (
    PAGE,
    STATE_WIDTH,
    copied,
    handed_out,
    joined,
    keep_state,
    large_array,
    row_of,
    state_of,
)
from symosc.engine.flow import Constants, state_at
from symosc.engine.state import (
    CROSS,
    END,
    FAILED,
    FULL,
    GRAZE,
    IN_DOUBT,
    INEXACT,
    MOVED,
    REST,
    SLIP,
    STICK,
    Covariance,
    Flown,
    Launch,
    NextEvent,
    State,
)
from symosc.engine.summary import Extremes, flight_extremes, widened
from symosc.kernels._generated import acceleration
from symosc.kernels.entire import EPS


def drawn(rng: random.Random) -> State:
    numbers = [rng.uniform(-9, 9) for _ in range(5)]
    S = Covariance(*(rng.uniform(0, 1e-9) for _ in range(3)))
    clock = rng.uniform(0, 99), 1e-15, rng.uniform(-1, 1), rng.uniform(-1, 1), 1e-17
    return State(rng.randint(1, 5), rng.randint(0, 2), rng.randint(0, 99), *numbers, S, *clock)


def test_a_row_is_its_state() -> None:
    rng = random.Random(1)
    rows = np.full((5, STATE_WIDTH), np.nan)
    states = [drawn(rng) for _ in range(5)]
    for i, state in enumerate(states):
        rows[i] = row_of(state, 123.0, 1e-14)
        assert rows[i, 13:].tolist() == [123.0, 1e-14, state.t, state.s, state.c, state.theta_low]
    assert [state_of(rows, i) for i in range(5)] == states
    others = [drawn(rng) for _ in range(5)]
    ends = rows[:, 13:16].copy()
    for i in (3, 0):
        keep_state(rows, i, others[i])
    assert [state_of(rows, i) for i in range(5)] == [others[0], *states[1:3], others[3], states[4]]
    assert np.array_equal(rows[:, 13:16], ends)


def test_errors_that_are_handed_out_cover_the_rounding_of_the_numbers() -> None:
    """Each part alone is what the error is made of. The rounding of t is none of x, which is that of the event."""
    rng, K = random.Random(2), constants_of(random.Random(3))
    for _ in range(300):
        t, t0 = (rng.choice([0.0, 1.0, 1e8]) * rng.uniform(0, 1) for _ in range(2))
        t, t0 = max(t, t0), min(t, t0)
        x, v = (10 ** rng.uniform(-3, 9) * rng.choice([-1, 1]) for _ in range(2))
        t_low, gain = rng.uniform(-1, 1) * EPS * t, rng.uniform(-1, 1) * EPS
        error, S11 = rng.choice([0.0, 1e-9]), rng.choice([0.0, 1e-18])
        out, t_error, x_error = handed_out(t, t_low, t0, x, v, error, S11, K._replace(Om_gain=gain))
        exact = Fraction(t) + Fraction(t_low) + (Fraction(t) - Fraction(t0)) * Fraction(gain)
        assert abs(exact - Fraction(out)) <= Fraction(t_error - error) + Fraction(EPS * t / 8)
        assert t_error == pytest.approx(error + EPS * (abs(out) + 0.25 * (t - t0)), rel=1e-12, abs=0)
        assert x_error == pytest.approx(abs(v) * error + S11**0.5 + EPS * abs(x), rel=1e-12, abs=0)


class AnySet:
    """The constants of whichever parameter set is asked for, as far as the loop itself needs them."""

    Om_gain = 0.0

    def __getitem__(self, number: int) -> AnySet:
        return self


class Told:
    """Steps that are told: of each trajectory a list of (code, decided, error of the time), then END."""

    def __init__(self, rng: random.Random, most: int) -> None:
        self.rng, self.steps = rng, {}
        for i in range(30):
            kinds = [rng.choice([CROSS, STICK, SLIP, GRAZE, MOVED, MOVED]) for _ in range(rng.randint(0, most))]
            last = rng.choice([END, REST, FAILED, CROSS])
            steps = [(kind, True, 1e-12) for kind in kinds]
            if last == CROSS:  # an event that is not decided, or not known well enough
                steps.append((CROSS, *rng.choice([(False, 1e-12), (True, 1e-3)])))
            self.steps[i] = [*steps, (END if last == CROSS else last, True, 0.0)]
        self.asked: list[int] = []

    def state(self, i: int, step: int) -> State:
        rng = random.Random(100 * i + step)
        return drawn(rng)._replace(n=step, at=i, t=100.0 * i + step, x=10.0 + step)

    def advance(self, state: State, t_end: float, t_end_low: float, K: object) -> NextEvent:
        i, step = state.at, state.n
        self.asked.append(i)
        assert (t_end, t_end_low) == (1000.0 + i, i * 1e-13)
        code, decided, error = self.steps[i][step]
        return NextEvent(code, 1 + i % 2, decided, error, self.state(i, step + 1))

    def right(self, i: int, most: int, accuracy: float) -> tuple[int, list[tuple[int, State, State, float]]]:
        """Return the code that trajectory i ends with, and (kind, before, behind, error) of its events."""
        events = []
        for step, (code, decided, error) in enumerate(self.steps[i]):
            if len(events) == most:
                return FULL, events
            before, behind = self.state(i, step), self.state(i, step + 1)
            if code == FAILED or not decided:
                return IN_DOUBT, events
            if code <= GRAZE:
                events.append((code, before, behind, error))
                t_error = error + EPS * (behind.t + 0.25 * (behind.t - 100.0 * i))
                x_error = abs(behind.v) * error + behind.S.S11**0.5 + EPS * behind.x
                if t_error > accuracy * max(1.0, behind.t) or x_error > accuracy * max(1.0, behind.x):
                    return INEXACT, events
            elif code != MOVED:
                return code, events
        raise AssertionError


def flight(p: Parameters, dice: random.Random) -> tuple[Constants, Launch, float, Flown]:
    K = Arithmetic(p).K
    theta, x, v = dice.uniform(0, 6.28), dice.uniform(-5, 5), dice.uniform(-5, 5)
    F = acceleration(x, v, cos(theta), K.A2, K.cm, K.w0sq, K.f0)
    start = Launch(v, F, sin(theta), cos(theta))
    duration = dice.choice((0.1, 0.5, 1.0)) * min(K.chunk, 60 / K.rate)
    return K, start, x, state_at(duration, start, K)


def extremes_of(K: Constants, start: Launch, x: float, last: Flown) -> Extremes:
    seen = widened(Extremes(x, x, start.v, start.v), x + last.dx, start.v + last.dv)
    return flight_extremes(0.0, last, start, x, seen, K)


@pytest.mark.parametrize("seed", range(4))
def test_no_sample_is_beyond_the_extremes_and_they_are_reached(seed: int) -> None:
    """In all regimes: critical damping, resonance, no spring, no drive."""
    dice = random.Random(seed)
    for p in random_sets(seed, 12):
        K, start, x, last = flight(p, dice)
        found = extremes_of(K, start, x, last)
        points = [state_at(tau, start, K) for tau in np.linspace(0, last.tau, 300)[1:-1].tolist()]
        sampled = np.array(
            [(x, start.v), (x + last.dx, start.v + last.dv), *((x + q.dx, start.v + q.dv) for q in points)]
        )
        size = abs(sampled).max()
        gaps = np.array(found)[[0, 2]] - sampled.min(axis=0), sampled.max(axis=0) - np.array(found)[[1, 3]]
        assert max(map(np.max, gaps)) <= 1e-14 * size, p
        assert min(map(np.min, gaps)) >= -1e-2 * size, p


def stationary_values(p: Parameters, begin: tuple[Any, Any, Any], duration: Any, which: int) -> list[Any]:
    """Return x (0) or v (1) at the ends of a flight in domain 2 and at its stationary points, by the oracle's flow."""

    times = [duration * n / 8 for n in range(9)]
    points = [flow_oracle(p, 2, *begin, tau, dps=20) for tau in times]
    values = [points[0][which], points[-1][which]]
    for (a, before), (b, after) in pairwise(zip(times, points, strict=True)):
        if before[which + 1] * after[which + 1] < 0:

            def rate(tau: Any) -> Any:
                return flow_oracle(p, 2, *begin, tau, dps=20)[which + 1]

            root = mpmath.findroot(rate, (a, b), solver="anderson", tol=1e-16)
            values.append(flow_oracle(p, 2, *begin, root, dps=20)[which])
    return values


@pytest.mark.slow
@pytest.mark.parametrize("c", ["0.1", "4.7"])
def test_extremes_are_those_of_mpmath(c: Any) -> None:
    p = Parameters(m=1, c=c, k=5, A0=1, B0=7, Omega="1.5", v1=-90, v2=90, mu1=0, mu2=0, FN=0)
    K, dice = Arithmetic(p).K, random.Random(4)
    t, x, v = (dice.randint(-300, 300) / 128 for _ in range(3))
    theta = 1.5 * t
    start = Launch(v, acceleration(x, v, cos(theta), K.A2, K.cm, K.w0sq, K.f0), sin(theta), cos(theta))
    found = extremes_of(K, start, x, state_at(4.0, start, K))
    with mpmath.workdps(20):
        for which, (low, high) in enumerate(((found.x_min, found.x_max), (found.v_min, found.v_max))):
            values = stationary_values(p, (mpmath.mpf(t), mpmath.mpf(x), mpmath.mpf(v)), mpmath.mpf(4), which)
            assert abs(float(min(values) - low)) < 2e-14
            assert abs(float(max(values) - high)) < 2e-14


@pytest.mark.parametrize("dtype", [np.float64, np.int32])
@pytest.mark.parametrize("shape", [(0,), (6, 0), (6, 1), (7, 1000), (5, PAGE // 8 + 3), (PAGE,)], ids=str)
def test_room_is_an_array_of_its_own(shape: tuple[int, ...], dtype: type) -> None:
    room = large_array(shape, dtype)
    assert room.shape == shape
    assert room.dtype == dtype
    assert room.flags.c_contiguous
    assert room.flags.aligned
    assert room.flags.writeable
    room[...] = 7
    assert np.all(room == 7)


def test_large_room_begins_at_a_page() -> None:
    for size in (PAGE // 8, PAGE // 8 + 1, PAGE):
        assert large_array((size,)).__array_interface__["data"][0] % PAGE == 0


def test_copies_are_right_and_share_nothing() -> None:
    columns = np.arange(12.0).reshape(3, 4)
    copy = copied(columns[:, :2])
    assert copy.tolist() == [[0, 1], [4, 5], [8, 9]]
    assert not np.shares_memory(copy, columns)
    for pieces in ([columns[0]], [columns[0], columns[2, :3]], [columns[0, ::2]]):
        whole = joined(pieces)
        assert whole.tolist() == np.concatenate(pieces).tolist()
        assert whole.flags.c_contiguous
