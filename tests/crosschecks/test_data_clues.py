"""Numbers at fault: noise, samples off by themselves, lists of events."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import simulate
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
