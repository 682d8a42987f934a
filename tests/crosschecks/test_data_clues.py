"""Numbers at fault: noise, samples off by themselves, lists of events."""

from __future__ import annotations

import numpy as np
import pytest

from symosc import crosscheck, simulate

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
