"""Numbers at fault: noise, samples off by themselves, lists of events."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symosc import crosscheck, simulate
from symosc.crosschecks import data_clues

T = np.linspace(0, 12, 400)


@pytest.mark.parametrize("size", [1e-5, 1e-2])
def test_noise_is_measured(size: float) -> None:
    rng = np.random.default_rng(2)
    x, v = simulate("fig5", t_end=12)(T)
    noisy = [column + size * rng.standard_normal(len(T)) for column in (x, v)]
    first = crosscheck("fig5", T, *noisy).diagnosis[0]
    assert first.cause == "noise"
    assert first.value == pytest.approx(size, rel=0.15)


def test_samples_off_by_themselves_are_counted() -> None:
    x, v = simulate("fig9", t_end=12)(T[10:])
    for i in (50, 120, 300):
        v[i] += 0.01
    first = crosscheck("fig9", T[10:], x, v).diagnosis[0]
    assert (first.cause, first.words) == ("outlier", "3 samples are off, the first is number 50")


def test_lists_of_events() -> None:
    motion = simulate("fig5", t_end=12)
    x, v = motion(T)
    events = [(float(event.t), event.kind) for event in motion.events]

    def causes(listed: list[tuple[float, str]]) -> list[str]:
        return [one.cause for one in crosscheck("fig5", T, x, v, events=listed).diagnosis]

    assert causes(events) == []
    assert causes(events[:2] + events[3:]) == ["missing events"]
    assert causes(sorted([*events, (8.0, "cross")])) == ["invented events"]
    assert causes([(t + 0.02 * (i == 1), kind) for i, (t, kind) in enumerate(events)]) == ["event times"]


def test_noise_is_seen_in_opposite_neighbours() -> None:
    """Made up: defects as noise makes them; too few pairs, or neighbours not opposite in both, are no noise."""
    rng = np.random.default_rng(3)
    for count, kind, found in ((40, "noise", True), (13, "noise", True), (12, "noise", False), (40, "same", False),
                               (40, "one", False), (2000, "weak", False)):  # fmt: skip
        sizes = np.array([2e-4, 5e-3])
        off = sizes * rng.standard_normal((count + 1, 2))
        defects = off[1:] - (0.1 if kind == "weak" else 1.0) * off[:-1]
        if kind == "same":
            defects = np.abs(defects)
        if kind == "one":
            defects[:, 1] = np.abs(defects[:, 1])
        inside = np.arange(count)
        clues: Any = SimpleNamespace(
            inside=inside, wrong=np.ones(count, bool), steps=SimpleNamespace(defects=defects), flights_wrong=0.5
        )
        answer = list(data_clues.noise(clues))
        assert len(answer) == found
        if found:
            assert (answer[0].cause, answer[0].share) == ("noise", 0.5)
            assert answer[0].value is not None
            assert answer[0].error is not None
            assert 0.4 < answer[0].value / sizes[1] < 2.0
            assert answer[0].error == pytest.approx(answer[0].value / np.sqrt(2 * count))


def test_how_many_samples_are_off_and_what_they_explain() -> None:
    faults = [
        SimpleNamespace(step=step, reason=reason, defect_x=dx, defect_v=dv, words=f"step {step}")
        for step, reason, dx, dv in (
            (4, "outlier", 0.5, -0.25), (7, "local error", 9.0, 9.0), (8, "outlier", -0.125, 2.0),
            (20, "outlier", 1.0, 0.0)
        )
    ]  # fmt: skip
    check = SimpleNamespace(faults=faults, wrong_steps=np.array([4, 5, 7, 8, 11, 20, 21, 30]))
    (one,) = data_clues.outliers(check)
    assert one.words == "3 samples are off, the first is number 5"
    assert (one.evidence, one.value, one.share) == ("step 4", 1.0, 5 / 8)
    check.faults = faults[2:3]
    assert next(data_clues.outliers(check)).words == "1 sample is off, the first is number 9"
    check.faults = faults[1:2]
    assert list(data_clues.outliers(check)) == []


def test_what_a_list_lacks_and_has_too_much_explains_it_wholly() -> None:
    def events(*pairs: tuple[float, str]) -> list[SimpleNamespace]:
        return [SimpleNamespace(t=t, kind=kind) for t, kind in pairs]

    for missed, invented, right in (
        (events(), events(), []),
        (events((1.0, "cross"), (2.0, "slip")), events((1.25, "cross"), (1.5, "slip")), [("event times", -0.5)]),
        (events((1.0, "cross")), events((1.5, "slip")), [("missing events", 1.0), ("invented events", 1.0)]),
        (events((1.0, "cross"), (2.0, "slip")), events(), [("missing events", 2.0)]),
        (events(), events((3.0, "stick")), [("invented events", 1.0)]),
    ):
        found = list(data_clues.listed(SimpleNamespace(missed=missed, invented=invented)))
        assert [(one.cause, one.value) for one in found] == right
        assert all(one.share == 1.0 for one in found)
        for one, first in zip(found, [each[0] for each in (missed, invented) if each], strict=False):
            assert one.cause == "event times" or f"{first.kind} at t = {first.t:g}" in one.words


@pytest.mark.parametrize("factor", [1000.0, 0.01])
@pytest.mark.parametrize("columns", ["x", "v", "x and v"])
def test_columns_in_other_units(columns: str, factor: float) -> None:
    motion = simulate("fig9", t_end=8)
    t = np.linspace(float(motion.t_start), 8, 300)
    x, v = motion(t)
    x, v = (column * factor if name in columns.split(" and ") else column for name, column in (("x", x), ("v", v)))
    first = crosscheck("fig9", t, x, v).diagnosis[0]
    assert (first.cause, first.subject, first.value) == ("columns", columns, factor)
    assert ("too large" if factor > 1 else "too small") in first.words
