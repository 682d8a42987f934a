"""Events at the wrong time: not located, or not seen at all."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from faulty_solver import Flaw, Solver

from symosc import crosscheck, load_scene
from symosc.crosschecks import event_clues
from symosc.engine.state import CROSS, SLIP


@pytest.mark.parametrize(
    ("name", "every"),
    [pytest.param("fig5", 1, marks=pytest.mark.slow), pytest.param("fig9", 1, marks=pytest.mark.slow), ("fig10", 2)],
)
def test_events_that_are_not_located(name: str, every: int) -> None:
    scene = load_scene(name)
    grid = np.linspace(float(scene.t0), 10, 400 * every + 1)
    run = Solver(scene.parameters, Flaw(late=True)).run(grid, float(scene.x0), float(scene.v0))
    t, x, v = (column[::every] for column in run.arrays())
    assert crosscheck(scene, t, x, v).diagnosis[0].cause == "late events"


def test_contacts_within_a_step_are_missed_double_roots() -> None:
    scene = load_scene("fig8")
    run = Solver(scene.parameters, Flaw()).run(np.linspace(2.5, 12, 60), float(scene.x0), float(scene.v0))
    check = crosscheck(scene, *run.arrays())
    assert not check.ok
    assert check.diagnosis[0].cause == "double root"


def made_up(first: list[int], kinds: list[int], wrong: list[bool]) -> Any:
    """Return steps of length 2, each with an event in its middle, and samples that stay where they are."""
    n = len(first)
    events = SimpleNamespace(step=np.arange(n), t=2.0 * np.arange(n) + 1.0, kind=np.array(kinds))
    steps = SimpleNamespace(t=2.0 * np.arange(n + 1), first=np.array(first), events=events)
    return SimpleNamespace(
        steps=steps, wrong=np.array(wrong), label=np.append(first, first[-1]),
        some=lambda chosen, most: chosen, limits=lambda part=1.0: np.full(n, part),
    )  # fmt: skip


def test_late_events_are_told_from_those_that_are_not_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: how late each event fits best. A delay up to the end of its step, in one domain, was not seen."""
    rng, answers = np.random.default_rng(2), set()
    for _ in range(80):
        first, n = rng.integers(1, 4, 6).tolist(), 6
        kinds = [SLIP] * n if rng.random() < 0.15 else rng.choice([CROSS, SLIP], n).tolist()
        wrong = rng.random(n) < 0.7
        clues = made_up(first, kinds, wrong.tolist())
        delay = rng.choice([0.25, 0.5, 0.9985, 1.0], n, p=[0.2, 0.2, 0.1, 0.5])
        leaves = rng.choice([0.99, 1.01], n, p=[0.8, 0.2]) * event_clues.DELAY_LEAVES
        monkeypatch.setattr(
            event_clues, "_best_delays", lambda _, chosen, rows, d=delay, left=leaves: (d[chosen], left[chosen])
        )
        found = list(event_clues.delays(clues))
        fits = wrong & (leaves < event_clues.DELAY_LEAVES)
        if not fits.any() or all(kinds[i] == SLIP for i in np.flatnonzero(fits)):
            assert found == []
            answers.add("none")
            continue
        (one,) = found
        unseen = [i for i in np.flatnonzero(fits) if delay[i] >= 0.999 and clues.label[i + 1] == first[i]]
        answers.add(one.cause)
        assert one.share == pytest.approx(fits.sum() / wrong.sum())
        if 2 * len(unseen) > fits.sum():
            assert (one.cause, one.words.split("(")[1]) == ("double root", f"{len(unseen)} times)")
        else:
            assert one.cause == "late events"
            assert (one.value, one.error) == (pytest.approx(delay[fits].mean()), pytest.approx(delay[fits].std()))
            assert f"up to {delay[fits].max():.3g} late" in one.words
    assert answers == {"none", "double root", "late events"}


@pytest.mark.parametrize("late", [0.0, 0.3, 0.77, 1.0])
def test_the_delay_that_fits_best_is_found(late: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: what a delay leaves, when the velocity goes on or is set to the belt's; each step has its own."""
    clues, chosen = made_up([1, 2, 1], [CROSS] * 3, [True] * 3), np.array([0, 1, 2])
    best = np.array([late, 0.5, 1.0 - late])
    tried: list[np.ndarray] = []

    def left(_: Any, chosen: np.ndarray, rows: np.ndarray, delay: np.ndarray, onto: bool) -> np.ndarray:
        tried.append(delay)
        return np.abs(delay - best) * 1e3 + (5.0 if onto else 0.0) * np.array([1.0, -1.0, 1.0]) + 5.0

    monkeypatch.setattr(event_clues, "_with_delay", left)
    delay, leaves = event_clues._best_delays(clues, chosen, chosen)
    assert delay == pytest.approx(best, abs=1e-3)
    assert leaves == pytest.approx([5.0, 0.0, 5.0], abs=1.0)
    assert np.min(tried) >= 0.0
    assert np.max(tried) <= 1.0
