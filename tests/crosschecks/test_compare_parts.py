"""The parts of a cross-check one by one: what rounding allows, which errors count, what is in disorder."""

from __future__ import annotations

import random
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import ParameterError, load_scene, simulate
from symosc.crosschecks import compare
from symosc.crosschecks.samples import Samples, check_joints


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
        pairs = [] if last is None else [(1.0, "cross"), (2.0, "cross"), (last, "cross")]
        assert compare.Task._later_events(task, trajectory, {}, pairs) == right  # type: ignore[arg-type]
        assert asked == ([pytest.approx(4.0 + span)] if right else [])


def test_arguments_are_read() -> None:
    t = np.linspace(0, 3, 9)
    x, v = simulate("fig5", t_end=3)(t)
    for name in ("tolerance", "global_tolerance"):
        for bad in (0, -1e-8, "0"):
            with pytest.raises(ParameterError, match=f"^{name} = "):
                crosscheck("fig5", t, x, v, **{name: bad})
    with pytest.raises(ParameterError, match="must be a Scene"):
        crosscheck(None, t, x, v)  # type: ignore[arg-type]
    result = crosscheck("fig5", t, x, v, tolerance="1e-6")  # type: ignore[arg-type]
    assert (result.tolerance, result.global_tolerance) == (1e-6, 1e-3)
    assert crosscheck("fig5", t, x, v, global_tolerance=0.5).global_tolerance == 0.5
    assert crosscheck("fig5", {"t": t, "x": x, "v": v}).ok
    listed = [(event.t, event.kind) for event in simulate("fig5", t_end=3).events]
    assert len(crosscheck("fig5", {"t": t, "x": x, "v": v}, events=listed).matched) == len(listed)
