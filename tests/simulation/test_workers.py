"""Chunks on several threads: any number of them gives the same, in order; an interrupt ends all of them soon."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError, load_scene, simulate_many
from symosc.simulation import batch_loop, workers
from symosc.simulation.workers import Patrol, Stopped, in_chunks

FIG9 = load_scene("fig9").parameters


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_results_are_in_order_and_rooms_are_not_shared(threads: int) -> None:
    used: set[int] = set()

    def work(rows: slice, room: list[int], patrol: Patrol) -> list[int]:
        assert id(room) not in used
        used.add(id(room))
        time.sleep(0.001)
        used.remove(id(room))
        return list(range(rows.start, rows.stop))

    seen: list[tuple[int, int]] = []
    found = in_chunks(53, work, list, threads, lambda done, of: seen.append((done, of)))
    assert [row for part in found for row in part] == list(range(53))
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)
    assert seen[-1] == (53, 53)


def test_an_error_ends_all_threads() -> None:
    running = threading.Event()

    def work(rows: slice, room: None, patrol: Patrol) -> None:
        if rows.start == 0:
            running.wait(5)
            raise KeyboardInterrupt
        running.set()
        for _ in range(5000):
            patrol.check()
            time.sleep(0.001)

    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        in_chunks(20, work, lambda: None, 3)
    assert time.perf_counter() - begin < 2
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("symosc")]


def test_an_interrupt_of_the_caller_ends_the_threads() -> None:
    """As Ctrl-C does: it comes in the caller's thread, here while it reports."""
    checked = []

    def work(rows: slice, room: None, patrol: Patrol) -> int:
        while rows.start > 5 and not patrol.stopped.is_set():
            time.sleep(0.001)
        try:
            patrol.check()
        except Stopped:
            checked.append(rows.start)
            raise
        return rows.start

    def interrupted(done: int, of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        in_chunks(40, work, lambda: None, 2, interrupted)
    assert len(checked) <= 2


@pytest.mark.slow
@pytest.mark.compiled("pairs")
def test_any_number_of_workers_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    monkeypatch.setattr(batch_loop.PAIRS, "left", 0.0)
    rng = np.random.default_rng(3)
    starts = np.column_stack([rng.uniform(0, 1, 150), rng.uniform(-5, 5, 150), rng.uniform(-5, 5, 150)])
    whole = simulate_many(FIG9, starts, 30, use_numba=True, workers=1)
    monkeypatch.setattr(workers, "MOST_IN_CHUNK", 7)
    done: list[int] = []
    for threads in (1, 2, 4):
        again = simulate_many(FIG9, starts, 30, use_numba=True, workers=threads, progress=lambda n, of: done.append(n))
        assert again == whole
    assert done.count(150) == 3


@pytest.mark.parametrize(
    ("given", "message"),
    [({"workers": 0}, "workers = 0"), ({"workers": 1.5}, "workers = 1.5"), ({"progress": 3}, "progress = 3")],
)
def test_bad_workers(given: Any, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        simulate_many(FIG9, (0, 0, 0), 1, **given)
