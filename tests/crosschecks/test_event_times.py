"""Where an event of the samples is said to be, and what a contact with a belt is: on steps that are made up."""

from __future__ import annotations

import random
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symosc.crosschecks import events
from symosc.crosschecks.events import CODES
from symosc.model import MODE_NAMES


def made_up(n: int, rows: list[tuple[int, float, str, int, int]], v: Any = None, first: Any = 2, last: Any = 2) -> Any:
    """Return steps between n samples at the times 0, 1, ...; rows of events: step, time, kind, belt, target."""
    rows = sorted(rows)
    step = np.array([row[0] for row in rows], int)
    inner = SimpleNamespace(
        step=step,
        t=np.array([row[1] for row in rows], float),
        kind=np.array([CODES[row[2]] for row in rows], int),
        boundary=np.array([row[3] for row in rows], int),
        target=np.array([row[4] for row in rows], int),
        rows=lambda low, high: slice(*np.searchsorted(step, [low, high + 1])),
    )
    K = SimpleNamespace(belt1=SimpleNamespace(v=-1.0), belt2=SimpleNamespace(v=2.0), period=10.0)
    modes = [np.broadcast_to(each, n - 1).astype(int) for each in (first, last)]
    speeds = np.zeros(n) if v is None else np.asarray(v, float)
    return SimpleNamespace(t=np.arange(float(n)), v=speeds, K=K, first=modes[0], last=modes[1], events=inner)


def test_the_time_is_that_of_the_exact_motion_if_its_steps_have_the_event() -> None:
    """The first of the kind, at the belt, in the steps that are meant; and then nothing is read off the samples."""
    rng = random.Random(1)
    for _ in range(80):
        rows = [
            (step := rng.randrange(6), step + rng.random(), rng.choice(["cross", "stick"]), rng.choice([1, 2]), 2)
            for _ in range(8)
        ]
        low = rng.randrange(6)
        high, kind, belt = rng.randint(low, 7), rng.choice(["cross", "stick"]), rng.choice([1, 2])
        steps = made_up(7, rows)
        sample = rng.choice([None, low])
        found = events._event(steps, kind, belt, 1, 2, low, high, sample)
        end = min(high, 5)
        own = [row for row in sorted(rows) if low <= row[0] <= end and row[2:4] == (kind, belt)]
        assert (found.kind, found.boundary, found.source, found.target) == (kind, belt, "Omega1", "Omega2")
        assert (found.step, found.last_step) == (low, end)
        if own:
            assert (found.t, found.spread) == (own[0][1], 0.0)
        else:
            assert found.spread == end + 1 - low
            assert sample is None or found.t == low


@pytest.mark.parametrize("belt", [1, 2])
def test_else_it_is_read_off_the_samples(belt: int) -> None:
    """A straight line through the belt's speed between two samples; of several the one nearest to the belt."""
    speed = (-1.0, 2.0)[belt - 1]
    for before, after in ((-0.3, 0.1), (0.2, -0.6), (0.5, 0.25)):
        steps = made_up(4, [], v=[9, speed + before, speed + after, 9])
        found = events._event(steps, "cross", belt, 1, 2, 1, 1, None)
        part = before / (before - after) if before * after < 0 else 0.5
        assert found.t == pytest.approx(1 + part)
    for nearest in (2, 3):
        v = speed + np.array([9, 0.5, 0.3, 0.3, -0.4, 9])
        v[nearest] = speed + 0.01
        assert events._event(made_up(6, [], v=v), "cross", belt, 1, 2, 1, 3, None).t == nearest
    ends = speed + np.array([9, 0.1, 0.3, 0.4, -0.1, 9])  # an end is nearest: the line from end to end
    assert events._event(made_up(6, [], v=ends), "cross", belt, 1, 2, 1, 3, None).t == pytest.approx(2.5)


def test_crossings_on_the_way_between_domains() -> None:
    for source in (1, 2, 3):
        for target in (1, 2, 3):
            found = events._crossings(made_up(4, []), source, target, 1, 2)
            up = list(range(min(source, target), max(source, target) + 1))
            way = up if target > source else up[::-1]
            right = [(min(a, b), MODE_NAMES[a], MODE_NAMES[b]) for a, b in pairwise(way)]
            assert [(e.boundary, e.source, e.target) for e in found] == right
            assert all((e.step, e.last_step, e.kind) == (1, 1, "cross") for e in found)


def test_a_contact_is_a_stick_if_it_lasts() -> None:
    """As long as a billionth of the period: by the exact motion where steps are right, else by the samples alone."""
    for mode in (4, 5):
        for first, last, target, sticks in (
            (mode, 2, None, True), (2, mode, None, True), (2, 2, mode, True), (2, 2, 9 - mode, False),
            (2, 2, None, False),
        ):  # fmt: skip
            rows = [] if target is None else [(2, 2.5, "stick", 1, target)]
            steps = made_up(6, rows, first=first, last=last)
            right = np.zeros(5, bool)
            assert events._is_stick(steps, mode, 2, 2, right) is sticks
            steps.t = np.array([0, 1, 2, 2 + 1.01e-8, 3, 4.0])
            assert events._is_stick(steps, mode, 2, 2, right) is sticks
            steps.t = np.array([0, 1, 2, 2 + 0.99e-8, 3, 4.0])
            assert not events._is_stick(steps, mode, 2, 2, right)
        wrong = np.ones(5, bool)
        steps = made_up(6, [], first=mode, last=mode)
        assert not events._is_stick(steps, mode, 2, 2, wrong)  # one sample at the belt has left it at once
        assert events._is_stick(steps, mode, 2, 3, wrong)  # two are on it
        assert events._is_stick(made_up(6, [], first=2, last=2), mode, 2, 3, wrong)
        assert events._is_stick(steps, mode, 4, 5, np.zeros(5, bool))  # the last sample has no step


def test_samples_at_one_belt_with_a_flight_between() -> None:
    """Reached by a flight, in a right step in which the motion never is on the belt."""
    for label, first, last, target, wrong, flown in (
        ((4, 4), 2, 2, None, False, True), ((4, 4), 4, 2, None, False, False), ((4, 4), 2, 4, None, False, False),
        ((4, 4), 2, 2, 4, False, False), ((4, 4), 2, 2, 5, False, True), ((4, 4), 2, 2, None, True, False),
        ((4, 5), 2, 2, None, False, False), ((2, 2), 1, 1, None, False, False),
    ):  # fmt: skip
        rows = [] if target is None else [(1, 1.5, "stick", 1, target)]
        steps = made_up(4, rows, first=first, last=last)
        labels = np.array([1, *label, 1])
        found = events._flown(steps, labels, np.array([False, wrong, False]))
        assert found.tolist() == [False, False, flown, False]
        steps.t = np.array([0.0, 1.0, 1.0, 2.0])  # at one time nothing flies
        assert not events._flown(steps, labels, np.array([False, wrong, False]))[2]


def test_events_of_a_list_are_in_the_step_of_their_time() -> None:
    steps = made_up(5, [])
    pairs = [
        (-3.0, "cross"),
        (0.0, "slip"),
        (0.5, "cross"),
        (2.0, "stick"),
        (3.9, "cross"),
        (4.0, "cross"),
        (9.0, "cross"),
    ]
    found = events.given_events(steps, pairs)
    assert [(e.t, e.kind) for e in found] == pairs
    assert [e.step for e in found] == [e.last_step for e in found] == [0, 0, 0, 2, 3, 3, 3]
    assert all((e.boundary, e.source, e.target, e.spread) == (0, "", "", 0.0) for e in found)
