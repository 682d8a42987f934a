"""Switching events that samples show: those of the motion, whatever the grid, and in their order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from symosc import load_scene, simulate
from symosc.crosschecks.events import find_events, labels
from symosc.crosschecks.steps import ExactSteps, follow_steps
from symosc.model import MODE_NAMES


def found_in(name: str, t: np.ndarray, t_end: float) -> tuple[list[Any], np.ndarray, np.ndarray, ExactSteps]:
    scene = load_scene(name)
    x, v = simulate(scene, t_end=t_end)(t)
    steps = follow_steps(scene.parameters, t, x, v, 1e-9, np.ones(2))
    near = np.full(len(t), 1e-9)
    label = labels(steps, near, near)
    events, modes = find_events(steps, label, np.zeros(len(t) - 1, bool))
    return events, modes, label, steps


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", ["fig5", "fig6", "fig9", "fig10"])
@pytest.mark.parametrize("count", [300, 1009])
def test_samples_of_a_motion_show_its_events(name: str, count: int) -> None:
    t_end = 12.0
    t = np.linspace(float(load_scene(name).t0), t_end, count)
    events, *_ = found_in(name, t, t_end)
    exact = simulate(name, t_end=t_end).events
    assert [(e.kind, e.boundary, e.source, e.target) for e in events] == [
        (e.kind, e.boundary, e.source, e.target) for e in exact
    ]
    for event, right in zip(events, exact, strict=True):
        assert t[event.step] <= float(right.t) <= t[event.last_step + 1]
        assert event.t == pytest.approx(float(right.t), abs=1e-9)  # by the exact motion over the step
        assert event.spread == 0


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_labels_and_modes_are_those_of_the_motion(name: str) -> None:
    t = np.linspace(float(load_scene(name).t0), 12.0, 700)
    _, modes, label, _ = found_in(name, t, 12.0)
    trajectory = simulate(name, t_end=12)
    # The first sample may be on a belt that the motion leaves at once.
    assert [MODE_NAMES[code] for code in label[1:].tolist()] == [trajectory.mode(float(time)) for time in t[1:]]
    assert np.array_equal(modes[1:], label[1:])
    assert modes[0] == (0 if label[0] > 3 and trajectory.mode(float(t[0])) != MODE_NAMES[label[0]] else label[0])


def test_steps_that_are_wrong_show_crossings_between_their_samples() -> None:
    """From one domain to the last but one: both belts are crossed, in order, at times read off the samples."""
    scene = load_scene("fig9")
    p, t = scene.parameters, np.array([0.0, 0.01, 0.02, 0.03])
    below, above = float(p.v1) - 1, float(p.v2) + 1
    steps = follow_steps(p, t, np.zeros(4), np.array([below, below, above, below]), 1e-9, np.ones(2))
    near = np.full(4, 1e-9)
    events, modes = find_events(steps, labels(steps, near, near), np.ones(3, bool))
    assert [(e.kind, e.boundary, e.source, e.target) for e in events] == [
        ("cross", 1, "Omega1", "Omega2"),
        ("cross", 2, "Omega2", "Omega3"),
        ("cross", 2, "Omega3", "Omega2"),
        ("cross", 1, "Omega2", "Omega1"),
    ]
    assert [e.step for e in events] == [1, 1, 2, 2]
    speeds = {1: float(p.v1), 2: float(p.v2)}
    for event in events:  # what the exact motion over the step does not do is read off: v is a straight line
        v0, v1 = (below, above) if event.step == 1 else (above, below)
        line = t[event.step] + 0.01 * (speeds[event.boundary] - v0) / (v1 - v0)
        assert t[event.step] <= event.t <= t[event.step + 1]
        assert event.spread == 0 or (event.spread == pytest.approx(0.01) and event.t == pytest.approx(line, abs=1e-12))
    assert sum(event.spread > 0 for event in events) >= 2
    assert modes.tolist() == [1, 1, 3, 1]
