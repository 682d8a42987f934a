"""From doubles to more digits: the events of `simulate_many` are those of `simulate`, on every step of the ladder."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from samples import sample_of

from symosc import EventTable, Parameters, Trajectory, load_scene, simulate, simulate_many
from symosc.engine import batch
from symosc.engine.state import IN_DOUBT
from symosc.simulation import batch_loop, chunks, ensemble, ladder

numba = pytest.importorskip("numba")

COLUMNS = ("t", "x", "v", "theta", "t_error", "x_error", "boundary", "kind", "source", "target")


@pytest.fixture(autouse=True)
def compiled_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch_loop.PAIRS, "events", 0)
    monkeypatch.setattr(batch_loop.DOUBLES, "events", 0)


def rows_of(table: EventTable, i: int) -> list[tuple[Any, ...]]:
    mine = table.trajectory == i
    return list(zip(*(getattr(table, name)[mine].tolist() for name in COLUMNS), strict=True))


def events_of(trajectory: Trajectory) -> list[tuple[Any, ...]]:
    return [tuple(getattr(event, name) for name in COLUMNS) for event in trajectory.events]


def fig8_like(seed: int) -> tuple[Parameters, list[tuple[Fraction, ...]]]:
    """Return parameters near those of fig8, whose errors grow, and starts on and beside belts."""
    dice = random.Random(seed)
    p = load_scene("fig8").parameters
    p = p.replace(A0=p.A0 + Fraction(dice.randint(-99, 99), 100), Omega=2 + Fraction(dice.randint(-50, 50), 100))
    starts = [(Fraction(dice.randint(0, 50), 10), Fraction(dice.randint(-600, 600), 100)) for _ in range(6)]
    return p, [(t, x, dice.choice((p.v1, p.v2, Fraction(dice.randint(-300, 300), 100)))) for t, x in starts]


@pytest.mark.compiled("pairs")
@pytest.mark.slow
@sample_of(6, 200)
def test_events_of_pairs_are_those_of_many_digits(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    climbed, looked = [], []
    climb, in_doubles = ladder.climb, chunks.in_doubles

    def counted(problems: Any, *others: Any) -> Any:
        found = climb(problems, *others)
        climbed.extend(np.isin(found.batch.codes, (IN_DOUBT,)).tolist())
        return found

    monkeypatch.setattr(ladder, "climb", counted)
    monkeypatch.setattr(chunks, "in_doubles", lambda *given: looked.append(given) or in_doubles(*given))
    for seed in range(count):
        p, starts = fig8_like(seed)
        accuracy, most = random.Random(seed).choice(((1e-15, None), (5e-16, 40), (3e-16, 7)))
        table = simulate_many(p, starts, [t + 30 for t, _, _ in starts], accuracy=accuracy, max_events=most)
        for i, (t0, x0, v0) in enumerate(starts):
            alone = simulate(p, t0=t0, x0=x0, v0=v0, t_end=t0 + 30, accuracy=accuracy, max_events=most)
            assert rows_of(table, i) == events_of(alone), (seed, i)
            assert table.status[i] == alone.status
    assert len(climbed) > 2 * count  # double-double numbers had work to do, and most of it they could do
    assert sum(climbed) == len(looked) < len(climbed) / 2


@pytest.mark.compiled("pairs")
@pytest.mark.slow
def test_what_pairs_leave_open_is_left_to_more_digits() -> None:
    """A swing that just touches a belt, and starts that are known to so much only."""
    swing = Parameters(m=1, c=0, k=1, A0=0, B0=0, Omega=1, v1=-1, v2=5, mu1=0, mu2=0, FN=1)
    table = simulate_many(swing, [(0, 1, 0), (0, "0.999", 0)], 7)
    assert rows_of(table, 0) == events_of(simulate(swing, t0=0, x0=1, v0=0, t_end=7))
    assert table.kind.tolist() == ["graze"]
    scene = load_scene("fig8-exact")
    start, error = (scene.t0, scene.x0, scene.v0), scene.start_error
    table = simulate_many(scene.parameters, [start] * 2, scene.t_end, start_error=error)
    assert rows_of(table, 0) == rows_of(table, 1) == events_of(simulate(scene))
    assert "graze" in table.kind.tolist()


@pytest.mark.compiled("pairs")
@pytest.mark.slow
def test_many_sets_and_any_order() -> None:
    """The place of a motion in the batch does not matter, nor what is beside it."""
    work = [(p, start) for p, starts in map(fig8_like, range(4)) for start in starts[:3]]
    ends = [start[0] + 25 for _, start in work]
    table = simulate_many([p for p, _ in work], [start for _, start in work], ends)
    order = random.Random(1).sample(range(len(work)), len(work))
    mixed = simulate_many([work[i][0] for i in order], [work[i][1] for i in order], [ends[i] for i in order])
    for place, i in enumerate(order):
        assert rows_of(mixed, place) == rows_of(table, i)
        assert mixed.status[place] == table.status[i]


def test_little_work_is_interpreted_in_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    """So little work does not wait for a compiler; it comes to the same."""
    monkeypatch.setattr(batch_loop.PAIRS, "events", 10_000)
    monkeypatch.setattr(batch_loop.DOUBLES, "events", 10_000)
    monkeypatch.setattr("symosc.simulation.ladder.pairs_are_compiled", lambda: False)
    monkeypatch.setattr(batch_loop, "is_compiled", lambda loop: False)
    monkeypatch.setattr(chunks, "in_doubles", None)
    p, starts = fig8_like(0)
    given: Any = {"max_events": 9, "accuracy": 3e-16}
    table = simulate_many(p, starts[:2], 12, **given)
    for i, (t0, x0, v0) in enumerate(starts[:2]):
        assert rows_of(table, i) == events_of(simulate(p, t0=t0, x0=x0, v0=v0, t_end=12, **given))
    assert 0 < batch_loop.PAIRS.events < 10_000


class Counted:
    """An event loop that counts its calls."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, *given: Any) -> Any:
        self.calls += 1
        return batch_loop.interpreted(*given)


@pytest.mark.parametrize(("events", "interpreted"), [(-1, 0), (0, 0), (150, 150), (160, 214), (10**6, 750)])
def test_the_loop_is_interpreted_until_so_many_events(
    events: int, interpreted: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, compiled = load_scene("fig9"), Counted()
    monkeypatch.setattr(batch_loop.DOUBLES, "events", events)
    monkeypatch.setattr(batch_loop, "TURN", 64)
    monkeypatch.setattr(batch_loop, "is_compiled", lambda loop: False)
    plain = batch_loop.chosen_loops(False)
    patient = plain._replace(follow=batch_loop.PatientLoop(compiled))
    monkeypatch.setattr(ensemble, "chosen_loops", lambda use_numba: plain if use_numba is False else patient)
    starts = [(0, Fraction(n, 7), 0) for n in range(5)]
    table = simulate_many(scene.parameters, starts, 2000, max_events=150, accuracy=1e-9, workers=1)
    assert table == simulate_many(scene.parameters, starts, 2000, max_events=150, accuracy=1e-9, use_numba=False)
    assert (compiled.calls > 0, events - batch_loop.DOUBLES.events) == (interpreted < 750, interpreted)
    assert len(table) == 750


def test_faint_errors_leave_no_trace() -> None:
    """What is rounded to a double is the same for any number of digits that are enough."""
    for x in (1.0, -3e-8, 7e20):
        assert batch.rounding_error(1e-30 * abs(x), x) == batch.rounding_error(0.0, x) == 2.0**-53 * abs(x)
        assert batch.rounding_error(1e-20 * abs(x), x) > 2.0**-53 * abs(x)
        for v in (2.0, -1e-3):
            faint = (1e-60 * x * x, 1e-60 * x * v, 1e-60 * v * v)
            for at in (0, 1):
                assert batch.rounded_covariance(at, x, v, *faint) == batch.rounded_covariance(at, x, v, 0, 0, 0)
                assert batch.rounded_covariance(at, x, v, 1e-40 * x * x, 0.0, 0.0)[0] > (2.0**-53 * x) ** 2
    assert batch.rounding_error(1e-30, 0.0) == 1e-30


@pytest.mark.slow
def test_fig8_over_fifty_periods_is_told_apart_from_grazing_or_given_up() -> None:
    """Its sticks shrink by 3/8 each half period: 36 digits go on beyond t = 61 and say so, 150 digits to the end."""
    scene = load_scene("fig8")
    p, start, t_end = scene.parameters, (scene.t0, scene.x0, scene.v0), scene.t0 + Fraction(355, 113) * 50
    found, table = simulate(scene, t_end=t_end), simulate_many(p, start, t_end)
    assert found.status == "undecidable"
    assert "cannot be decided with 36 digits" in found.message
    assert 61 < found.events[-1].t < t_end / 2
    assert table.status == ["undecidable"]
    assert rows_of(table, 0) == events_of(found)
    exact = simulate(scene, t_end=t_end, digits=150)
    assert (exact.status, len(exact.events)) == ("t_end", 196)
    sticks = [segment.t_end - segment.t_start for segment in exact.segments if segment.mode.startswith("belt")]
    assert 9.2e-43 < min(sticks) < 9.4e-43
    for event, right in zip(found.events, exact.events, strict=False):
        assert (event.kind, event.boundary) == (right.kind, right.boundary)
        assert abs(float(right.t) - event.t) <= 10 * event.t_error
