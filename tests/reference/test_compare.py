"""How events are compared: none of a solver's mistakes is dropped."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import pytest

from symosc import load_scene, simulate
from symosc.reference.compare import FAR_MATCH, Comparison, FoundEvents, align, compare, window_of

EXACT = simulate("fig5", digits=40).events

RIGHT = [FoundEvents(float(event.t), float(event.x), event.kind, event.boundary) for event in EXACT]

WINDOW = window_of(load_scene("fig5"))


def moved(event: FoundEvents, by: float) -> FoundEvents:
    return event._replace(t=event.t + by)


def test_the_right_events_are_right() -> None:
    result = compare(RIGHT, EXACT, WINDOW)
    assert result.complete
    assert (result.matched, result.first_wrong) == (len(EXACT), None)
    assert result.error is not None
    assert result.error < 1e-15


@pytest.mark.parametrize("t0", [10**8, 10**10])
def test_of_a_late_start_times_as_doubles_are_right_and_late_ones_are_not(t0: int) -> None:
    """Relative to |t| an event that is 1e-3 late was 1e-11 or less off."""
    reference = [replace(event, t=event.t + t0) for event in EXACT]
    rounded = [event._replace(t=float(known.t)) for event, known in zip(RIGHT, reference, strict=True)]
    assert compare(rounded, reference, WINDOW, t0).error_t == 0.0
    result = compare([moved(event, 1e-3) for event in rounded], reference, WINDOW, t0)
    assert result.error_t is not None
    assert 0.9e-3 < result.error_t < 1.1e-3


def test_errors_are_relative_to_at_least_one() -> None:
    changed = list(RIGHT)
    changed[0] = moved(RIGHT[0], 1e-6)  # at t = 0.12
    changed[-1] = RIGHT[-1]._replace(x=RIGHT[-1].x * (1 + 1e-5))  # |x| > 1
    result = compare(changed, EXACT, WINDOW)
    assert abs(RIGHT[-1].x) > 1
    assert (result.error_t, result.error_x) == (pytest.approx(1e-6, rel=1e-6), pytest.approx(1e-5, rel=1e-6))
    assert result.error == result.error_x


def test_a_missed_event_does_not_shift_the_later_ones() -> None:
    result = compare(RIGHT[:3] + RIGHT[4:], EXACT, WINDOW)
    assert (result.missed, result.invented, result.matched) == (1, 0, len(EXACT) - 1)
    assert result.first_wrong == RIGHT[3].t
    assert result.error is not None
    assert result.error < 1e-15


def test_an_invented_and_a_repeated_event() -> None:
    extra = FoundEvents(2.0, 0.0, "cross", 2)
    result = compare([*RIGHT, extra, moved(RIGHT[5], 1e-3)], EXACT, WINDOW)
    assert (result.missed, result.invented) == (0, 2)
    assert result.first_wrong == 2.0
    assert result.error is not None
    assert result.error < 1e-15  # the nearer one of the two reports counts


@pytest.mark.parametrize("change", [{"kind": "cross"}, {"boundary": 2}, {"t": RIGHT[3].t + 1.01 * WINDOW}])
def test_another_kind_boundary_or_time_is_another_event(change: dict[str, Any]) -> None:
    changed = [*RIGHT[:3], RIGHT[3]._replace(**change), *RIGHT[4:]]
    result = compare(changed, EXACT, WINDOW)
    assert (result.missed, result.invented) == (1, 1)
    assert not result.complete


def test_no_events_and_events_that_are_no_numbers() -> None:
    assert compare([], [], WINDOW) == Comparison(None, None, 0, 0, 0, 0, None)
    nothing = compare([], EXACT, WINDOW)
    assert (nothing.missed, nothing.error, nothing.first_wrong) == (len(EXACT), None, RIGHT[0].t)
    broken = compare([RIGHT[0]._replace(x=float("nan")), *RIGHT[1:]], EXACT, WINDOW)
    assert (broken.missed, broken.invented) == (1, 1)


def test_a_graze_is_not_missed_but_a_stick_in_its_place_is_invented() -> None:
    scene = load_scene("fig8-exact")
    exact = simulate(scene, digits=20, t_end=4).events
    assert [event.kind for event in exact] == ["graze"]
    silent = compare([], exact, window_of(scene))
    assert (silent.complete, silent.missed_grazes) == (True, 1)
    t, x = float(exact[0].t), float(exact[0].x)
    sticking = compare([FoundEvents(t, x, "stick", 1), FoundEvents(t + 1e-6, x, "slip", 1)], exact, window_of(scene))
    assert (sticking.invented, sticking.missed, sticking.missed_grazes) == (2, 0, 1)
    assert compare([FoundEvents(t, x, "graze", 1)], exact, window_of(scene)).missed_grazes == 0


def value_of_best(found: list[FoundEvents], reference: list[FoundEvents], window: float) -> float:
    """Return the value of the best alignment by trying all."""

    @lru_cache(None)
    def best(i: int, j: int) -> float:
        if i == len(reference) or j == len(found):
            return 0.0
        value = max(best(i + 1, j), best(i, j + 1))
        return max(value, best(i + 1, j + 1) + worth(reference[i], found[j], window))

    return best(0, 0)


def worth(one: FoundEvents, other: FoundEvents, window: float) -> float:
    if (one.kind, one.boundary) != (other.kind, other.boundary) or abs(one.t - other.t) > window:
        return -1.0
    return 1 - (1 - FAR_MATCH) * abs(one.t - other.t) / window


def test_thealignment_is_the_best_one() -> None:
    rng = random.Random(6)

    def some() -> list[FoundEvents]:
        events = [
            FoundEvents(rng.uniform(0, 3), 0.0, rng.choice(["stick", "slip"]), 1) for _ in range(rng.randrange(9))
        ]
        return sorted(events)

    for _ in range(500):
        found, reference, window = some(), some(), rng.choice([0.1, 0.5, 2.0])
        pairs = align(found, reference, [event.t for event in reference], window)  # type: ignore[arg-type]
        assert all(i < k and j < m for (i, j), (k, m) in pairwise(pairs))
        values = [worth(reference[i], found[j], window) for i, j in pairs]
        assert all(value > 0 for value in values)
        assert sum(values) == pytest.approx(value_of_best(found, reference, window))
