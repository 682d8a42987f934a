"""How far an event may be from its exact time: as far as an allowed error of the samples moves it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symosc import load_scene, simulate
from symosc.crosschecks.reach import Reach
from symosc.crosschecks.steps import StepEvents, follow_steps

SIZE = 1e-6


def reach_of(name: str, t_end: float, errors: tuple[float, float] = (0.0, 0.0), allowed_v: float = 0.0) -> Reach:
    scene = load_scene(name)
    t = np.linspace(float(scene.t0), t_end, 401)
    x, v = simulate(scene, t_end=t_end)(t)
    steps = follow_steps(scene.parameters, t, x, v, 1e-9, np.ones(2))
    return Reach(steps, np.tile(errors, (len(t), 1)), allowed_v, 0.0, np.zeros(0))


@pytest.mark.parametrize(("name", "t_end"), [("fig5", 12.0), ("fig9", 8.0), ("fig10", 10.0)])
def test_an_event_of_the_motion_and_of_the_steps_reach_equally_far(name: str, t_end: float) -> None:
    reach, events = reach_of(name, t_end, (SIZE, 3 * SIZE), SIZE), simulate(name, t_end=t_end).events
    assert len(events) == len(reach.steps.events.t) > 3
    for row, event in enumerate(events):
        assert reach.of_row(row) == pytest.approx(reach.of(event), rel=1e-6), event


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
@pytest.mark.parametrize("changed", ["x0", "v0"])
def test_what_an_error_does_is_within_reach_and_not_far_below_it(name: str, changed: str) -> None:
    """Up to the first event, restarted one sample before it with an error: moved no farther than it reaches."""
    scene = load_scene(name)
    for event in simulate(scene, t_end=12).events[:6]:
        before = float(event.t) - 1e-4
        x, v = (float(value) for value in simulate(scene, t_end=12)(before))
        if event.kind == "slip":
            continue  # there the force decides, which an error of x alone moves
        push = {"x0": (SIZE, 0.0), "v0": (0.0, SIZE)}[changed]
        reach = reach_of(name, 12.0, push)
        moved = simulate(scene, t0=before, x0=x + push[0], v0=v + push[1], t_end=before + 1).events[0]
        assert moved.kind == event.kind
        shift = abs(float(moved.t) - float(event.t))
        assert shift <= reach.of(event)
        if changed == "v0":
            assert reach.of(event) <= 3 * shift


def test_the_end_of_a_stick_moves_with_x() -> None:
    """Its force changes by k dx: the end is moved by that over the slope of the force."""
    scene = load_scene("fig5")
    p, seen = scene.parameters, 0
    for event in simulate(scene, t_end=12).events:
        if event.kind == "slip":
            v = float(p.belt(event.boundary))
            slope = -float(p.k) * v - float(p.B0 * p.Omega) * np.sin(float(event.theta))
            expected = 2 * float(p.k) * SIZE / abs(slope)  # REACH_SAFETY is 2
            assert reach_of("fig5", 12.0, (SIZE, 0.0)).of(event) == pytest.approx(expected, rel=1e-3)
            seen += 1
    assert seen >= 3


def test_without_errors_only_rounding_is_left() -> None:
    reach = reach_of("fig9", 8.0)
    for event in simulate("fig9", t_end=8).events:
        assert reach.of(event) <= 4.1 * np.spacing(float(event.t)) + 1e-15


def test_a_near_touch() -> None:
    """v = peak - b (t - t_m)^2/2 stays within twice the error of a belt below it for this long."""
    scene = load_scene("fig7-exact")
    trajectory = simulate(scene, t_end=8)
    graze = next(event for event in trajectory.events if event.kind == "graze")
    p, t_m = scene.parameters, float(graze.t)
    half = 1e-3
    bend = abs(float(trajectory(t_m + half)[1] - 2 * trajectory(t_m)[1] + trajectory(t_m - half)[1])) / half**2
    reach = reach_of("fig7-exact", 8.0, (0.0, SIZE), SIZE)
    assert reach.of_touch(trajectory, t_m) == pytest.approx(2 * np.sqrt(2 * 2 * SIZE / bend), rel=1e-3)
    assert reach.of_touch(trajectory, t_m + 1.0) is None
    assert reach.of_touch(trajectory, float(scene.t0) - 1) is None
    assert reach.of_touch(trajectory, 8.1) is None
    assert p.belt(graze.boundary) == graze.v


def test_a_start_on_a_belt_reaches_as_far_as_its_slower_side() -> None:
    scene = load_scene("fig9")
    found: list[Any] = []
    for belt in (1, 2):
        speed = scene.parameters.belt(belt)
        t = np.linspace(0, 1, 50)
        x, v = simulate(scene.parameters, t0=0, x0=1, v0=speed, t_end=1)(t)
        steps = follow_steps(scene.parameters, t, x, v, 1e-9, np.ones(2))
        reach = Reach(steps, np.tile((0.0, SIZE), (50, 1)), 0.0, 0.0, np.zeros(0))
        p = scene.parameters
        forces = [abs(float(p.A(alpha) + p.B0 - p.c * speed - p.k * 1) / float(p.m)) for alpha in (belt, belt + 1)]
        found.append(reach.of_start(belt))
        assert found[-1] == pytest.approx(2 * SIZE / min(forces), rel=1e-3)
    assert found[0] != found[1]


@pytest.mark.parametrize("belt", [1, 2])
def test_an_event_without_slope_reaches_as_far_as_its_bend_allows(belt: int) -> None:
    """At an end of a stick where the force turns, and at a touch: the root of twice the error over the bend."""
    reach = reach_of("fig9", 8.0, (0.0, SIZE), SIZE)
    K = reach.steps.K
    v, error = (K.belt1, K.belt2)[belt - 1].v, max(K.Om, np.sqrt(K.w0sq)) * SIZE
    if abs(K.w0sq * v) < abs(K.fB):
        theta = np.arcsin(-K.w0sq * v / K.fB)
        bend = K.fB * K.Om * np.cos(theta)
        found = reach._width(1.0, 0.0, float(theta), belt, 3 + belt)
        assert found == pytest.approx(2 * np.sqrt(2 * error / abs(bend)), rel=1e-2)
    assert belt == 2 or abs(K.w0sq * v) < abs(K.fB)
    for domain in (belt, belt + 1):  # x so that the acceleration vanishes
        A = (K.A1, K.A2, K.A3)[domain - 1]
        for theta in (0.3, 2.0, 4.4):
            x = (A - K.cm * v + K.f0 * np.cos(theta)) / K.w0sq
            slope = -(K.w0sq * v + K.fB * np.sin(theta))
            found = reach._width(1.0, float(x), theta, belt, domain)
            assert found == pytest.approx(2 * np.sqrt(2 * 2 * SIZE / abs(slope)), rel=1e-2)


def test_the_mode_before_an_event_of_a_step_is_that_of_the_event_before() -> None:
    """In a step with several events; at the first one it is where the step begins. A slip comes from its belt."""
    reach, asked = reach_of("fig10", 10.0), []
    rng = np.random.default_rng(4)
    rows, width = 40, lambda *given: asked.append(given) or 0.0
    step = np.sort(rng.integers(0, 12, rows))
    numbers = [rng.uniform(0, 9, rows) for _ in range(3)]
    kind, boundary, target = rng.integers(1, 5, rows), rng.integers(1, 3, rows), rng.integers(1, 6, rows)
    first = rng.integers(1, 6, 12)
    events = StepEvents(step, *numbers, kind, boundary, target)
    object.__setattr__(reach, "steps", SimpleNamespace(events=events, first=first))
    object.__setattr__(reach, "_width", width)
    for row in range(rows):
        asked.clear()
        reach.of_row(row)
        before = [j for j in range(row) if step[j] == step[row]]
        source = int(target[before[-1]] if before else first[step[row]])
        source = 3 + int(boundary[row]) if kind[row] == 3 else min(source, 3)
        assert asked == [(numbers[0][row], numbers[1][row], numbers[2][row], boundary[row], source)]


def test_a_stick_touches_nothing_nor_does_what_is_outside_the_motion() -> None:
    trajectory = simulate("fig5", t_end=12)
    reach = reach_of("fig5", 12.0, (SIZE, SIZE), 1e3)  # so loose that each flight with a turn nearly touches a belt
    found = {"flight": 0, "stick": 0}
    for segment in trajectory.segments:
        for part in (0.01, 0.5, 0.99):
            time = float(segment.t_start) + part * float(segment.t_end - segment.t_start)
            touch = reach.of_touch(trajectory, time)
            kind = "stick" if segment.mode.startswith("belt") else "flight"
            found[kind] += touch is not None
    assert found["stick"] == 0
    assert found["flight"] > 3
    for outside in (float(trajectory.t_start) - 1e-9, 12.0 + 1e-9):
        assert reach.of_touch(trajectory, outside) is None
