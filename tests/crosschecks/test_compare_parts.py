"""The parts of a cross-check one by one: what rounding allows, which errors count, what is in disorder."""

from __future__ import annotations

import random
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from careful_solver import random_parameters

from symosc import ParameterError, load_scene, simulate
from symosc.crosschecks import compare
from symosc.crosschecks.compare import crosscheck
from symosc.crosschecks.samples import Samples, check_joints
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
        assert compare._push(p, x, v) == pytest.approx(largest, rel=1e-12)
        assert compare._push(p, np.array([x, -x]), np.array([v, v])) == pytest.approx([largest, largest], rel=1e-12)


def test_what_rounding_leaves_open() -> None:
    """Of a sample its own digits and those of its time; of a step the ulps of its times and of the largest values."""
    rng = np.random.default_rng(2)
    p = load_scene("fig9").parameters
    t = 1e5 + np.sort(rng.uniform(0, 2, 6))
    x, v, units = rng.uniform(-4, 4, 6), rng.uniform(-20, 20, 6), rng.uniform(0, 1e-3, (3, 6))
    loose = compare._loose(p, Samples(t, x, v), units)
    for i in range(6):
        a = compare._push(p, x[i], v[i])
        assert loose[i] == pytest.approx(
            [units[1, i] + abs(v[i]) * units[0, i], units[2, i] + a * units[0, i]], rel=1e-12
        )
    steps = follow_steps(p, t, x, v, 0.0, np.ones(2))
    found = compare._rounding(steps, np.array([4.0, 20.0]))
    for i in range(5):
        tick = 2 * max(np.spacing(t[i]), np.spacing(t[i + 1]))
        base = 8 * np.finfo(float).eps
        right = [tick * 20 + base * 4, tick * compare._push(p, 4.0, 20.0) + base * 20]
        assert found[i] == pytest.approx(right, rel=1e-12)


def test_rounded_samples_are_carried_over_the_step() -> None:
    """At least as far as any rounding within its unit moves the motion over a step; nothing if nothing is rounded."""
    rng = np.random.default_rng(3)
    p = load_scene("fig9").parameters
    t = np.linspace(0.2, 1.2, 21)
    x, v = simulate("fig9", t_end=2)(t)
    scales, near = np.ones(2), np.full(21, 1e-9)
    steps, loose = follow_steps(p, t, x, v, near, scales), np.full((21, 2), [1e-4, 2e-4])
    allowed = compare._carried(steps, loose, near, scales)
    assert not compare._carried(steps, 0 * loose, near, scales).any()
    for _ in range(6):
        off = loose * rng.uniform(-1, 1, (21, 2))
        moved = follow_steps(p, t, x + off[:, 0], v + off[:, 1], near, scales)
        assert (np.abs(moved.defects) <= 1.05 * allowed + 1e-9).all()
    assert (allowed >= loose[1:]).all()
    assert allowed.max() < 20 * loose.max()


def test_errors_count_as_far_as_they_are_allowed() -> None:
    errors = np.array([[1.0, -3.0], [np.nan, np.nan], [-9.0, 0.5]])
    assert compare._within(errors, np.array([2.0, 1.0])).tolist() == [[1.0, 1.0], [0.0, 0.0], [2.0, 0.5]]


def test_a_list_is_in_order_if_no_time_is_smaller_than_the_one_before() -> None:
    rng = random.Random(4)
    for _ in range(60):
        pairs = [(rng.choice([0.0, 0.5, 0.5, 1.0, 2.0]), "cross") for _ in range(rng.randint(0, 5))]
        notes: list[str] = []
        late = [i for i in range(1, len(pairs)) if pairs[i][0] < pairs[i - 1][0]]
        assert compare._disorder(pairs, notes) is bool(late)
        assert len(notes) == bool(late)
        if late:
            before, after = pairs[late[0] - 1][0], pairs[late[0]][0]
            assert notes[0].endswith(f"cross at t = {after:.10g} comes after t = {before:.10g}")


@pytest.mark.parametrize(("column", "name"), [(0, "x"), (1, "v")])
def test_a_joint_may_jump_by_a_part_of_the_largest_value(column: int, name: str) -> None:
    """... and by what rounding leaves open on both sides; the time and the jump are named."""
    t = np.array([0.0, 1.0, 1.0, 2.0, 2.0, 3.0])
    for largest, slack in ((5.0, 0.0), (5.0, 0.3), (1e-3, 0.0)):
        limit = 1e-2 * largest + 2 * slack
        for part, fine in ((0.99, True), (1.01, False), (-0.99, True), (-1.01, False)):
            values = np.zeros((2, 6))
            values[column, 0], values[column, 4] = -largest, part * limit
            values[column, 5] = values[column, 4]
            slacks = np.zeros((2, 6))
            slacks[column] = slack
            samples = Samples(t, *values)
            if fine:
                check_joints(samples, 1e-2, *slacks)
                continue
            with pytest.raises(ParameterError, match=rf"t\[4\] = 2.* \({name} jumps by {abs(part) * limit:.3g}\)"):
                check_joints(samples, 1e-2, *slacks)


@pytest.mark.parametrize("extra", [0.2, 3.0])
def test_events_of_a_list_just_behind_the_last_sample(extra: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Looked for if the list goes on to about the end, a twentieth of a period further; not behind an early end."""
    task = SimpleNamespace(parameters=load_scene("fig9").parameters)  # period pi/2
    asked: list[float] = []
    longer = SimpleNamespace(events=["a", "b", "c", "d"])
    task._simulate = lambda t_end, start: asked.append(t_end) or longer
    span = 0.05 * np.pi / 2
    for status, last, right in (
        ("t_end", 4.0, ["c", "d"]), ("t_end", 4.0 - 0.9 * span, ["c", "d"]), ("t_end", 4.0 - 1.1 * span, []),
        ("t_end", None, []), ("equilibrium", 4.0, []), ("undecidable", 4.0, []),
    ):  # fmt: skip
        asked.clear()
        trajectory: Any = SimpleNamespace(t_end=4.0, status=status, events=["a", "b"])
        pairs = [] if last is None else [(1.0, "cross"), (last, "cross")]
        assert compare.Task._later_events(task, trajectory, {}, pairs) == right  # type: ignore[arg-type]
        assert asked == ([pytest.approx(4.0 + span)] if right else [])


def test_arguments_are_read() -> None:
    t = np.linspace(0, 3, 9)
    x, v = simulate("fig5", t_end=3)(t)
    for name in ("tolerance", "global_tolerance"):
        for bad in (0, -1e-8, "0"):
            with pytest.raises(ParameterError, match=f"^{name} = "):
                crosscheck("fig5", t, x, v, **{name: bad})
    with pytest.raises(ParameterError, match="give a Scene"):
        crosscheck(None, t, x, v)  # type: ignore[arg-type]
    result = crosscheck("fig5", t, x, v, tolerance="1e-6")  # type: ignore[arg-type]
    assert (result.tolerance, result.global_tolerance) == (1e-6, 1e-3)
    assert crosscheck("fig5", t, x, v, global_tolerance=0.5).global_tolerance == 0.5
    assert crosscheck("fig5", {"t": t, "x": x, "v": v}).ok
    listed = [(event.t, event.kind) for event in simulate("fig5", t_end=3).events]
    assert len(crosscheck("fig5", {"t": t, "x": x, "v": v}, events=listed).matched) == len(listed)
