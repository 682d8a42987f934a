"""Chunks on several threads: any number of them gives the same, in order; an interrupt ends all of them soon."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest
from effort import PATIENCE

from symosc import ParameterError, load_scene, simulate_many
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

    begun = []

    def work(rows: slice, room: None, patrol: Patrol) -> None:
        begun.append(rows.start)
        if rows.start == 0:
            assert running.wait(PATIENCE)
            raise KeyboardInterrupt
        running.set()
        assert patrol.stopped.wait(PATIENCE), "nobody ends it"
        patrol.check()

    with pytest.raises(KeyboardInterrupt):
        in_chunks(40, work, lambda: None, 3)
    assert len(begun) <= 4 < 14  # chunks: the thread that failed may take another one before the others are stopped
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("symosc")]


def test_an_interrupt_of_the_caller_ends_the_threads() -> None:
    """As Ctrl-C does: it comes in the caller's thread, here while it reports."""
    checked = []

    def work(rows: slice, room: None, patrol: Patrol) -> int:
        assert rows.start <= 5 or patrol.stopped.wait(PATIENCE), "nobody ends it"
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


@pytest.mark.parametrize(
    ("given", "message"),
    [({"workers": 0}, "workers = 0"), ({"workers": 1.5}, "workers = 1.5"), ({"progress": 3}, "progress = 3")],
)
def test_bad_workers(given: Any, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        simulate_many(FIG9, (0, 0, 0), 1, **given)
