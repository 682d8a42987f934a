"""Sending the missing chunks of a sweep to whoever computes, and taking in what comes back."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from functools import partial
from pathlib import Path
from typing import Any

from symosc.errors import MissingExtraError, ParameterError, SweepError, SymoscError
from symosc.exact import whole_number
from symosc.sweeps.motions import Chunk, Share, computed
from symosc.sweeps.plan import SweepPlan

#: Processor seconds that a chunk should take; less would be overhead, more would be lost when a program is killed.
CHUNK_SECONDS = 4.0
#: Motions of the first chunk, and how much larger or smaller than the one before a chunk may be.
FIRST_CHUNK, MOST_GROWTH = 128, 16.0
MOST_CHUNK = 1 << 18
CONNECT_SECONDS = 10
# Chunks in flight for each processor of an executor whose size is not known.
AHEAD = 2

Range = tuple[int, int]
Done = tuple[int, int, Chunk]


class Here(Executor):
    """Computes in this process, each chunk when it is submitted; its motions run on all threads."""

    def __init__(self, workers: int | None) -> None:
        self.workers = workers

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Return a future that is done."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs, workers=self.workers))
        except Exception as error:
            future.set_exception(error)
        return future


def engine(executor: Any, workers: Any) -> tuple[Executor, int]:
    """Return who computes, and how many chunks are under way at a time.

    Parameters
    ----------
    executor : concurrent.futures.Executor or dask.distributed.Client, optional
        None: this process.
    workers : int, optional
        Threads of this process (default: all cores), or chunks under way in an executor.

    Raises
    ------
    ParameterError
        If an argument is none of these.
    """
    count = None if workers is None else whole_number("workers", workers, 1)
    if executor is None:
        return Here(count), 1
    if hasattr(executor, "get_executor") and hasattr(executor, "ncores"):
        cores = sum(executor.ncores().values())
        return executor.get_executor(pure=False), count or AHEAD * max(cores, 1)
    if not isinstance(executor, Executor):
        allowed = "give an executor of concurrent.futures, or a Client of dask.distributed"
        raise ParameterError("executor", type(executor).__name__, allowed)
    known = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    return executor, count or AHEAD * known


def dask_client(address: str) -> Any:
    """Return a client of a dask cluster, by the address of its scheduler or the name of its scheduler file.

    Raises
    ------
    MissingExtraError
        If dask.distributed is not installed.
    ParameterError
        If no scheduler answers there.
    """
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtraError("a dask cluster", "sweep") from None
    if address.endswith(".json"):
        if not Path(address).is_file():  # dask would wait for it
            raise ParameterError("executor", address, "there is no such scheduler file")
        return Client(scheduler_file=address, timeout=CONNECT_SECONDS)
    try:
        return Client(address, timeout=CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        allowed = f"no scheduler of dask answers there ({_brief(error)})"
        raise ParameterError("executor", address, allowed) from None


class Sizes:
    """How many motions the next chunk has, from how long the last ones took."""

    def __init__(self) -> None:
        self.next = FIRST_CHUNK

    def learn(self, motions: int, seconds: float) -> None:
        """Aim the next chunk at CHUNK_SECONDS."""
        growth = min(max(CHUNK_SECONDS / max(seconds, 1e-6), 1 / MOST_GROWTH), MOST_GROWTH)
        self.next = int(min(max(motions * growth, 1), MOST_CHUNK))


def carried_out(plan: SweepPlan, gaps: list[Range], executor: Executor, under_way: int) -> Iterator[Done]:
    """Compute the cells in `gaps` and yield them chunk by chunk, in the order in which they are done.

    Raises
    ------
    SweepError
        If a worker fails; the chunks that were yielded stand.
    """
    todo, sizes, pending = list(reversed(gaps)), Sizes(), dict[Future[Chunk], Range]()
    try:
        while todo or pending:
            while todo and len(pending) < under_way:
                begin, end = _cut(todo, sizes.next, under_way)
                pending[_submit(executor, plan.share(begin, end))] = begin, end
            done, _ = wait(pending, return_when=FIRST_COMPLETED)
            for future in sorted(done, key=_failed):  # those that are whole are kept before an error is raised
                begin, end = pending.pop(future)
                chunk = _result(future)
                sizes.learn(end - begin, chunk.seconds)
                yield begin, end, chunk
    finally:
        for future in pending:
            future.cancel()


def _cut(todo: list[Range], size: int, under_way: int) -> Range:
    """Take the next chunk from what is to do; at the end all that is left is shared by those under way."""
    left = sum(end - begin for begin, end in todo)
    begin, end = todo.pop()
    middle = min(end, begin + max(min(size, -(-left // under_way)), 1))
    if end - middle < (middle - begin) // 4:  # no crumbs
        middle = end
    if middle < end:
        todo.append((middle, end))
    return begin, middle


def _submit(executor: Executor, share: Share) -> Future[Chunk]:
    try:
        return executor.submit(partial(computed, share))
    except RuntimeError as error:  # a broken or closed pool
        raise SweepError(f"a worker failed: {_brief(error)}") from error


def _failed(future: Future[Chunk]) -> bool:
    return future.cancelled() or future.exception() is not None


def _result(future: Future[Chunk]) -> Chunk:
    try:
        return future.result()
    except SymoscError:
        raise
    except MemoryError:
        raise
    except Exception as error:
        raise SweepError(f"a worker failed: {_brief(error)}") from error


def _brief(error: BaseException) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())
