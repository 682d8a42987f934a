"""Steps in which nothing happens: never one with an event, and their ends are those of the event search."""

from __future__ import annotations

import numpy as np
from careful_solver import random_parameters

from symosc import load_scene
from symosc.crosschecks import quiet, steps
from symosc.crosschecks.quiet import quiet_ends
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import constants
from symosc.engine.start import start_rows


def test_quiet_steps_are_those_of_the_event_search() -> None:
    """Random systems, steps from far below a period to near the limit, samples near belts, on them and far away."""
    rng, seen, there = np.random.default_rng(11), {0: 0, 1: 0}, 0
    for _ in range(12):
        p = random_parameters(rng)
        K = Arithmetic(p).K._replace(sigmas=0.0)
        belts, count = np.array([K.belt1.v, K.belt2.v]), 150
        at = rng.integers(0, 3, count)
        beside = rng.choice(belts, count) + rng.choice([-1, 1], count) * 10.0 ** rng.uniform(-8, 1, count)
        v = np.where(at > 0, belts[at - 1], beside)
        theta, x, left = rng.uniform(0, 6.2, count), rng.uniform(-9, 9, count), 10.0 ** rng.uniform(-5, 0.5, count)
        rows, _ = start_rows(at, theta, x, v, (0.0, 0.0, left / K.rate, 0.0, 0.0), K)
        quiet, ends = quiet_ends(rows, left / K.rate, K)
        modes, exact, events = steps._follow(rows, left / K.rate, K)
        assert not np.isin(events.step, quiet).any()
        assert (modes[quiet] == rows[quiet, 0]).all()
        np.testing.assert_allclose(ends, exact[quiet], rtol=1e-13, atol=1e-13)
        there += len(np.unique(events.step))
        for held in (0, 1):
            seen[held] += int(np.sum((modes[quiet] > 3) == held))
    assert min(seen.values()) > 50
    assert there > 100


def test_most_steps_of_a_fine_run_are_quiet() -> None:
    rng = np.random.default_rng(5)
    p = random_parameters(rng)
    K = Arithmetic(p).K
    theta, x, v = rng.uniform(0, 6.2, 2000), rng.uniform(-5, 5, 2000), rng.uniform(-5, 5, 2000)
    left = np.full(2000, 1e-4 / K.rate)
    rows, _ = start_rows(np.zeros(2000, int), theta, x, v, (0.0, 0.0, left, 0.0, 0.0), K)
    quiet, _ = quiet_ends(rows, left, K)
    assert len(quiet) > 1900


def test_a_stick_that_ends_between_the_ends_of_a_step_is_not_quiet() -> None:
    """A force that passes 0 and is back, aimed at: at both ends of the step the mass would stick."""
    rng, there = np.random.default_rng(6), 0
    for _ in range(100):
        K = Arithmetic(random_parameters(rng)).K
        at = int(rng.integers(1, 3))
        belt = (K.belt1, K.belt2)[at - 1]
        if not belt.turns or K.w0sq == 0.0:
            continue
        left = rng.uniform(0.05, 0.45) / K.rate
        middle = rng.choice([belt.angle, np.pi - belt.angle])
        turned = np.cos(middle + np.array([-0.5, 0.5]) * K.Om * left)
        side = 1 if (turned - np.cos(middle)).max() * K.f0 < 0 else 0
        A, small = (K.A1, K.A2, K.A3)[at - 1 + side], rng.uniform(1e-6, 1e-3) * abs(K.f0) * (K.Om * left) ** 2
        force = small if side else -small
        x = (A + np.cos(middle) * K.f0 - belt.v * K.cm - force) / K.w0sq - 0.5 * belt.v * left
        ones = np.ones(1)
        theta = (middle - 0.5 * K.Om * left) % (2 * np.pi)
        rows, _ = start_rows(np.array([at]), theta * ones, x * ones, belt.v * ones, (0.0, 0.0, left, 0.0, 0.0), K)
        events = steps._follow(rows, left * ones, K)[2]
        there += rows[0, 0] > 3 and len(events.step) > 0
        if len(events.step):
            assert len(quiet_ends(rows, left * ones, K)[0]) == 0
    assert there > 10


def test_a_flight_is_clear_if_its_bounds_are() -> None:
    """Of the domain that it is in, on both sides: lowest and highest velocity, with what the curve may add."""
    K = constants(load_scene("fig9").parameters)
    low, high = K.belt1.v, K.belt2.v
    tau = np.full(1, 1e-9)  # so short that only rounding is added
    off = quiet.CLEARANCE * 2 * (abs(low) + abs(high))
    for mode, v, v_end, clear in (
        (1, low - 2, low - 3, True), (1, low - 3, low - 2 * off, True), (1, low - 2, low, False),
        (1, low, low - 2, False), (1, low - 2, low + 1, False), (2, low + 1, high - 1, True),
        (2, high - 1, low + 1, True), (2, low, low + 1, False), (2, low + 1, low, False),
        (2, high - 1, high, False), (2, high, high - 1, False), (2, low - 1, low + 1, False),
        (3, high + 1, high + 2, True), (3, high + 2, high + 1, True), (3, high, high + 1, False),
        (3, high + 1, high, False), (3, low + 1, high + 1, False),
    ):  # fmt: skip
        found = quiet._flight_is_clear(tau, np.full(1, float(mode)), np.full(1, v), np.full(1, v_end), np.zeros(1), K)
        assert found.tolist() == [clear], (mode, v, v_end)
    # A curve between its ends leaves the chord by no more than tau^2/8 times the bend.
    tau, a = np.full(1, 0.01), np.full(1, 3.0)
    most = np.hypot(3.0, K.w0 * (low + 1)) + abs(K.fB) * 0.01
    bend = 0.125 * 1e-4 * ((K.cm + K.w0) * most + abs(K.fB))
    for part, clear in ((0.99, False), (1.01, True)):
        end = np.full(1, low + part * bend)
        assert quiet._flight_is_clear(tau, np.full(1, 2.0), np.full(1, low + 1), end, a, K).tolist() == [clear]
