"""Processes that work side by side."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context

from symosc.base.errors import SymoscError

LOST = (
    "a worker process ended before its work was done: it was killed, or there was not enough "
    "memory; fewer workers need less"
)


@contextmanager
def process_pool(count: int, start: str | None = None) -> Iterator[Executor]:
    """Yield a pool of `count` processes, started as `start` says ("spawn" or "fork"; None: as
    usual).

    It has no more processes than the machine has cores.

    Raises
    ------
    SymoscError
        If a process ends before its work is done.
    """
    most = os.cpu_count() or 1
    pool = ProcessPoolExecutor(min(count, most), get_context(start))
    try:
        yield pool
    except BrokenProcessPool:
        raise SymoscError(LOST) from None
    finally:
        pool.shutdown(cancel_futures=True)
