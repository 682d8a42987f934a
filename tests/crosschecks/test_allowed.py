"""What rounding allows: of a sample, of a step, and over a step."""

from __future__ import annotations

import numpy as np
import pytest
from careful_solver import random_parameters

from symosc import load_scene, simulate
from symosc.crosschecks import allowed
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.steps import follow_steps


def test_the_acceleration_is_bounded_at_any_state() -> None:
    """In every domain and at every phase; and there is a state of that size where it is reached."""
    rng = np.random.default_rng(1)
    for _ in range(40):
        p = random_parameters(rng)
        x, v = rng.uniform(-9, 9, 2)
        m, c, k, B0 = (float(getattr(p, name)) for name in ("m", "c", "k", "B0"))
        largest = max(
            abs(float(p.A(domain)) + sign * B0 - k * at * x - c * by * v) / m
            for domain in (1, 2, 3) for sign in (1, -1) for at in (1, -1) for by in (1, -1)
        )  # fmt: skip
        assert allowed.push(p, x, v) == pytest.approx(largest, rel=1e-12)
        assert allowed.push(p, np.array([x, -x]), np.array([v, v])) == pytest.approx([largest, largest], rel=1e-12)


def test_what_rounding_leaves_open() -> None:
    """Of a sample its own digits and those of its time; of a step the ulps of its times and of the largest values."""
    rng = np.random.default_rng(2)
    p = load_scene("fig9").parameters
    t = 1e5 + np.sort(rng.uniform(0, 2, 6))
    x, v, units = rng.uniform(-4, 4, 6), rng.uniform(-20, 20, 6), rng.uniform(0, 1e-3, (3, 6))
    loose = allowed.looseness(p, Samples(t, x, v), units)
    for i in range(6):
        a = allowed.push(p, x[i], v[i])
        assert loose[i] == pytest.approx(
            [units[1, i] + abs(v[i]) * units[0, i], units[2, i] + a * units[0, i]], rel=1e-12
        )
    steps = follow_steps(p, t, x, v, 0.0, np.ones(2))
    found = allowed.rounding_of_steps(steps, np.array([4.0, 20.0]))
    for i in range(5):
        tick = 2 * max(np.spacing(t[i]), np.spacing(t[i + 1]))
        base = 8 * np.finfo(float).eps
        right = [tick * 20 + base * 4, tick * allowed.push(p, 4.0, 20.0) + base * 20]
        assert found[i] == pytest.approx(right, rel=1e-12)


def test_rounded_samples_are_carried_over_the_step() -> None:
    """At least as far as any rounding within its unit moves the motion over a step; nothing if nothing is rounded."""
    rng = np.random.default_rng(3)
    p = load_scene("fig9").parameters
    t = np.linspace(0.2, 1.2, 21)
    x, v = simulate("fig9", t_end=2)(t)
    scales, near = np.ones(2), np.full(21, 1e-9)
    steps, loose = follow_steps(p, t, x, v, near, scales), np.full((21, 2), [1e-4, 2e-4])
    most = allowed.carried(steps, loose, near, scales)
    assert not allowed.carried(steps, 0 * loose, near, scales).any()
    for _ in range(6):
        off = loose * rng.uniform(-1, 1, (21, 2))
        moved = follow_steps(p, t, x + off[:, 0], v + off[:, 1], near, scales)
        assert (np.abs(moved.defects) <= 1.05 * most + 1e-9).all()
    assert (most >= loose[1:]).all()
    assert most.max() < 20 * loose.max()
