"""Ends of sticks: too early, too late, and the friction at which a late one is left."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from faulty_solver import Flaw, Solver

from symosc import crosscheck, load_scene
from symosc.crosschecks import stick_clues
from symosc.crosschecks.report import CrossCheck
from symosc.crosschecks.stick_clues import Sticks


def checked(flaw: Flaw, every: int, joints: bool = False) -> CrossCheck:
    scene = load_scene("fig10")
    run = Solver(scene.parameters, flaw, joints).run(np.linspace(0.4588, 9, 601), 3.0837, 1.0)
    t, x, v = (column[::every] for column in run.arrays())
    return crosscheck(scene, t, x, v)


@pytest.mark.quick(1)
@pytest.mark.parametrize("static", [1.05, 1.3])
def test_static_friction_is_measured(static: float) -> None:
    first = checked(Flaw(static=static), 4).diagnosis[0]
    assert first.cause == "stick left late"
    assert first.value == pytest.approx(static, abs=1e-6)
    assert first.error is not None
    assert first.error < 1e-6


@pytest.mark.slow
def test_static_friction_shows_where_the_samples_end_with_the_sticks() -> None:
    first = checked(Flaw(static=1.1), 1, joints=True).diagnosis[0]
    assert first.cause == "stick left late"
    assert first.value == pytest.approx(1.1, abs=0.01)


@pytest.mark.quick(1)
@pytest.mark.parametrize("early", [0.05, 0.25])
def test_sticks_that_are_left_too_early(early: float) -> None:
    assert checked(Flaw(early=early), 4).diagnosis[0].cause == "stick left early"


def made_up(count: int, length: float) -> tuple[Any, Sticks]:
    """Return steps with a stick in each, from their beginning to their middle; no motion belongs to them."""
    t = length * np.arange(count + 1.0)
    steps = SimpleNamespace(t=t)
    clues = SimpleNamespace(steps=steps, wrong=np.ones(count, bool), scales=np.array([1.0, 3.0]),
                            limits=lambda part=1.0: np.full(count, part))  # fmt: skip
    rows = np.arange(count)
    return clues, Sticks(rows, np.ones(count, int), t[:-1], np.zeros(count), t[:-1] + 0.5 * length)


def test_a_drift_is_one_rate_of_all_sticks_and_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: each stick drifts at a rate of its own. What is no drift: too fast, too different, or not exact."""
    clues, sticks = made_up(5, 2.0)
    fastest = 0.02 * clues.scales[1]  # in a stick of length 1
    spread = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    same = 0.1 / 1.4826  # the median of what they are off, as a standard deviation
    for rate, off, rest, found in (
        (0.9 * fastest, 0.0, 0.0, 5), (-0.9 * fastest, 0.0, 0.0, 5), (1.1 * fastest, 0.0, 0.0, 0),
        (0.5 * fastest, 0.95 * same, 0.0, 5), (-0.5 * fastest, 0.95 * same, 0.0, 5),
        (0.5 * fastest, 1.05 * same, 0.0, 0),
        (0.5 * fastest, 0.0, 0.09, 5), (0.5 * fastest, 0.0, 0.11, 0),
    ):  # fmt: skip
        rates = rate * (1.0 + off * spread)

        def left(clues: Any, sticks: Sticks, time: Any, side: int, dx: Any = 0.0, dv: Any = 0.0, *,
                 rates: Any = rates, rest: float = rest) -> np.ndarray:  # fmt: skip
            misses = np.column_stack([0.0 * rates, 1e9 * (dv - rates) + 0.0 * dx])
            return misses + np.array([rest, 0.0]) if side == 1 else np.full((5, 2), 50.0)

        monkeypatch.setattr(stick_clues, "find_sticks", lambda _: sticks)
        monkeypatch.setattr(stick_clues, "_left_at", left)
        answer = list(stick_clues.drift_within_steps(clues))
        assert len(answer) == bool(found)
        for one in answer:
            assert one.cause == "drift"
            assert one.value == pytest.approx(rate)
            assert one.error == pytest.approx(1.4826 * off * abs(rate), abs=1e-9)
            assert one.share == pytest.approx(1.0 + 0.01 * (off == 0.0))


@pytest.mark.parametrize("count", [1, 2])
def test_one_drift_has_no_error_that_could_be_told(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    clues, sticks = made_up(count, 2.0)

    def left(clues: Any, sticks: Sticks, time: Any, side: int, dx: Any = 0.0, dv: Any = 0.0) -> np.ndarray:
        return np.column_stack([np.zeros(count), 1e9 * (dv - np.full(count, 0.01))])

    monkeypatch.setattr(stick_clues, "find_sticks", lambda _: sticks)
    monkeypatch.setattr(stick_clues, "_left_at", left)
    (one,) = stick_clues.drift_within_steps(clues)
    assert one.value == pytest.approx(0.01)
    assert one.error == (None if count == 1 else pytest.approx(0.0, abs=1e-12))
    assert one.evidence.endswith(f" {count} sticks")


def test_a_stick_that_ends_on_time_is_neither_early_nor_late(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: when each stick is left, and how well that fits. Most of those that fit say if it is early or late."""
    clues, sticks = made_up(4, 2.0)
    rng, answers = np.random.default_rng(5), set()
    monkeypatch.setattr(stick_clues, "find_sticks", lambda _: sticks)
    monkeypatch.setattr(stick_clues, "_kept_too_long", lambda _: iter(["kept"]))
    monkeypatch.setattr(stick_clues, "_friction", lambda clues, sticks, time: 1.0 + (time - sticks.end))
    monkeypatch.setattr(stick_clues, "_kept_on", lambda clues, rest: np.ones(len(rest), bool))
    monkeypatch.setattr(stick_clues, "_flights_without_cause", lambda clues, rest: len(rest))
    for _ in range(100):
        away = rng.choice([-0.4, -4e-6, -1e-6, 0.0, 1e-6, 4e-6, 0.4], 4)  # of a step of length 2
        leaves = rng.choice([0.5, 2.0], 4, p=[0.8, 0.2]) * stick_clues.DELAY_LEAVES

        def best(clues: Any, sticks: Sticks, low: Any, high: Any, *, away: Any = away, leaves: Any = leaves) -> Any:
            mine = (away > 0) if low is sticks.end else (away <= 0)
            return sticks.end + away, np.where(mine, leaves, 1e9)

        monkeypatch.setattr(stick_clues, "_best_exit", best)
        fits = (leaves < stick_clues.DELAY_LEAVES) & (abs(away) > 3e-6)
        (found,) = stick_clues.stick_ends(clues)
        if not fits.any():
            assert found == "kept"
            answers.add("kept")
            continue
        late = fits & (away > 0)
        is_late = 2 * late.sum() > fits.sum()
        answers.add(found.cause)
        assert found.cause == ("stick left late" if is_late else "stick left early")
        assert found.share == pytest.approx(1.0)  # what does not fit is explained too
        assert found.evidence.startswith(f"{fits.sum()} sticks ")
        if is_late:
            assert found.value == pytest.approx(np.median(1.0 + away[late]))
    assert answers == {"kept", "stick left late", "stick left early"}
    monkeypatch.setattr(stick_clues, "find_sticks", lambda _: None)
    assert list(stick_clues.stick_ends(clues)) == ["kept"]
