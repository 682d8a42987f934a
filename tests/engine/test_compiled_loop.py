"""The loop over many trajectories: rows are states, and the bookkeeping is that of one step after the other."""

from __future__ import annotations

import random
from fractions import Fraction
from math import inf

import numpy as np
import pytest
from random_constants import constants_of

from symosc.engine import compiled_loop
from symosc.engine.compiled_loop import (
    FLOAT_COLUMNS,
    INT_COLUMNS,
    STATE_WIDTH,
    batch_of,
    follow_all,
    handed_out,
    keep_state,
    room_for,
    row_of,
    state_of,
)
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
    RUNNING,
    SLIP,
    STICK,
    Covariance,
    NextEvent,
    State,
)
from symosc.engine.tally import no_tally
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


@pytest.mark.parametrize("accuracy", [inf, 1e-5, 3e-14])
@pytest.mark.parametrize("most", [1, 3, 99])
@pytest.mark.parametrize("room", [1, 2, 7, 400])
def test_the_loop_writes_every_event_once(
    accuracy: float, most: int, room: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of steps that are told: however small the room, the rows of all calls together are those of the trajectories."""
    told = Told(random.Random(4), 6)
    monkeypatch.setattr(compiled_loop, "advance", told.advance)
    K = AnySet()
    batch = batch_of(np.array([row_of(told.state(i, 0), 1000.0 + i, i * 1e-13) for i in range(30)]))
    begin, floats, ints = 0, [], []
    while begin < 30:
        out = room_for(room)
        assert out.floats.shape == (len(FLOAT_COLUMNS), room)
        assert out.ints.shape == (len(INT_COLUMNS), room)
        begin, rows = follow_all(begin, batch, most, accuracy, out, no_tally(), K)
        assert begin == 30 or (rows == room and batch.codes[begin] == RUNNING)
        floats += out.floats[:, :rows].T.tolist()
        ints += out.ints[:, :rows].T.tolist()
    right = [told.right(i, most, accuracy) for i in range(30)]
    assert batch.codes.tolist() == [code for code, _ in right]
    assert batch.counts.tolist() == [len(events) for _, events in right]
    due = [(i, *event) for i, (_, events) in enumerate(right) for event in events]
    assert [row[:3] for row in ints] == [[i, kind, 1 + i % 2] for i, kind, *_ in due]
    assert [row[3:] for row in ints] == [[before.mode, behind.mode] for *_, before, behind, _ in due]
    for row, (i, _, _, behind, error) in zip(floats, due, strict=True):
        expected = handed_out(behind.t, behind.t_low, 100.0 * i, behind.x, behind.v, error, behind.S.S11, K)
        assert row == [expected[0], behind.x, behind.v, behind.theta, *expected[1:]]
    asked = [told.asked.count(i) for i in range(30)]
    assert asked == [int(state_of(batch.states, i).n) for i in range(30)]
