"""Work in chunks on all cores: threads that hold no lock while compiled loops run.

What comes out does not depend on the number of threads: each chunk is done by itself, and put where it belongs.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from queue import SimpleQueue
from threading import Event
from typing import Any, TypeVar

from symosc.exact import whole_number

Result = TypeVar("Result")
Room = TypeVar("Room")

# A chunk has enough motions to hide what it costs to begin one, and so few that all threads are busy to the end.
MOST_IN_CHUNK = 1024
CHUNKS_PER_WORKER = 6
MOST_WORKERS = 256


class Stopped(Exception):
    """The caller has been interrupted: what a thread was doing is of no use any more."""


class Patrol:
    """What a thread asks now and then: whether it is to go on.

    Attributes
    ----------
    stopped : threading.Event
    """

    def __init__(self) -> None:
        self.stopped = Event()

    def check(self) -> None:
        """Raise Stopped if the caller has been interrupted."""
        if self.stopped.is_set():
            raise Stopped


def read_workers(workers: Any) -> int:
    """Return the number of threads that is asked for; None: as many as there are cores for this process."""
    if workers is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return whole_number("workers", workers, 1)


def in_chunks(
    count: int,
    work: Callable[[slice, Room, Patrol], Result],
    room: Callable[[], Room],
    workers: int,
    progress: Callable[[int, int], object] | None = None,
) -> list[Result]:
    """Return the results of all chunks, in order.

    Parameters
    ----------
    count : int
        Rows in all.
    work : callable
        Does some rows, in room that no other thread uses meanwhile.
    room : callable
        Makes such room, once for each thread.
    workers, progress : as `simulate_many` takes them.

    Notes
    -----
    An interrupt, or an error of any chunk, ends all of them at their next `Patrol.check`, and is raised.
    """
    size = max(1, min(MOST_IN_CHUNK, -(-count // (CHUNKS_PER_WORKER * workers))))
    # No motions are a chunk too: it has the columns, each without an entry.
    chunks = [slice(begin, min(begin + size, count)) for begin in range(0, max(count, 1), size)]
    workers = min(workers, len(chunks))
    patrol, done, results = Patrol(), 0, dict[int, Result]()
    if workers <= 1:
        own = room()
        for number, rows in enumerate(chunks):
            results[number] = work(rows, own, patrol)
            if progress:
                progress(rows.stop, count)
        return list(results.values())
    rooms: SimpleQueue[Room] = SimpleQueue()
    for _ in range(workers):
        rooms.put(room())

    def one(rows: slice) -> Result:
        patrol.check()
        own = rooms.get()
        try:
            return work(rows, own, patrol)
        finally:
            rooms.put(own)

    with ThreadPoolExecutor(workers, thread_name_prefix="symosc") as pool:
        try:
            numbers: dict[Future[Result], int] = {pool.submit(one, rows): n for n, rows in enumerate(chunks)}
            for future in as_completed(numbers):
                number = numbers[future]
                results[number] = future.result()
                done += chunks[number].stop - chunks[number].start
                if progress:
                    progress(done, count)
        except BaseException:
            patrol.stopped.set()
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return [results[number] for number in range(len(chunks))]
