"""Execution of many motions at once: buffers, threads, and compilation in advance.

What comes out does not depend on the number of threads: each chunk is computed by itself, and put
where it belongs. Which loop runs is chosen by `symosc.simulation.loops`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from threading import Event
from time import perf_counter
from typing import Any, NamedTuple, TypeVar

import numpy as np

from symosc.base.exact import whole_number
from symosc.engine import arithmetic
from symosc.engine import batch as engine_batch
from symosc.engine.arithmetic import compiled, compiled_pairs
from symosc.engine.batch import (
    NO_PIECES,
    Batch,
    EventRows,
    batch_of,
    event_buffer,
)
from symosc.engine.flow import table_of
from symosc.engine.start import Start, first_row_in_doubles
from symosc.engine.state import PAIR_ROW, STATE_ROW
from symosc.engine.summary import Tally, no_tally
from symosc.kernels.compiling import is_compiled
from symosc.scenes import load_scene
from symosc.simulation.loops import CHOICE

Result = TypeVar("Result")

# Events after which a loop gives its rows back, and can be interrupted: a tenth of a second. A
# little more than a power of 2: else all columns would have the same places in the processor's
# cache.
CAPACITY = (1 << 18) + 72
# A chunk has enough motions to hide what it costs to begin one, and so few that all threads are
# busy to the end.
LEAST_IN_CHUNK = 16
MOST_IN_CHUNK = 2048
LEAST_ALONE = 512  # where one thread does all
CHUNKS_PER_WORKER = 6
MOST_WORKERS = 256


def follow_batch(
    follow: Callable[..., tuple[int, int, int]],
    batch: Batch,
    most: int,
    accuracy: float,
    table: np.ndarray,
    buffer: EventRows | None = None,
    tally: Tally | None = None,
) -> Iterator[EventRows]:
    """Follow all trajectories of a batch by the loop `follow`.

    Yield copies of event rows each time `buffer` is full.

    A motion ends after `most` events, or at an event less accurate than `accuracy`. `table` has the
    constants of the parameter sets. With a `tally`, running summaries are updated there and no
    events are recorded.
    """
    buffer = buffer or event_buffer(4 * len(batch.states) + 64)
    tally = tally or no_tally()
    begin = 0
    while begin < len(batch.states):
        begin, filled, _ = follow(begin, batch, most, accuracy, buffer, NO_PIECES, tally, table)
        if len(tally.floats):
            filled = 0
        yield EventRows(*(engine_batch.contiguous_copy(columns[:, :filled]) for columns in buffer))


#: Buffers of earlier calls, 18 MB each: memory that is new to a process is slow.
SPARE_BUFFERS: list[EventRows] = []
MOST_SPARE = 2


class Stopped(Exception):
    """Raised in a thread whose result is no longer needed, since the caller was interrupted."""


class CancelToken(Event):
    """A flag that threads check regularly: it is set when the caller has been interrupted."""

    def check(self) -> None:
        """Raise Stopped if the caller was interrupted."""
        if self.is_set():
            raise Stopped


def read_workers(workers: Any) -> int:
    """Return the number of threads asked for; if None, the number of cores available to this
    process.
    """
    if workers is None:
        if hasattr(os, "sched_getaffinity"):
            return len(os.sched_getaffinity(0))
        return os.cpu_count() or 1
    return whole_number("workers", workers, 1)


def in_chunks(
    count: int,
    work: Callable[[slice, EventRows, CancelToken], Result],
    workers: int,
    progress: Callable[[int, int], object],
) -> list[Result]:
    """Call `work(rows, buffer, cancel)` for chunks of `count` rows, in threads.

    Return the results in order.
    """
    # An interrupt, or an error of any chunk, ends all of them at their next `CancelToken.check`,
    # and is raised.
    if workers > 1:
        least = LEAST_IN_CHUNK
    else:
        least = LEAST_ALONE
    size = max(least, min(MOST_IN_CHUNK, -(-count // (CHUNKS_PER_WORKER * workers))))
    # No motions are a chunk too: it has the columns, each without an entry.
    chunks = [slice(begin, min(begin + size, count)) for begin in range(0, max(count, 1), size)]
    cancel = CancelToken()
    results = list[Result]()
    done = 0

    def work_on(rows: slice) -> Result:
        cancel.check()
        try:  # another thread may have taken the last one
            buffer = SPARE_BUFFERS.pop()
        except IndexError:
            buffer = event_buffer(CAPACITY)
        result = work(rows, buffer, cancel)
        SPARE_BUFFERS.append(buffer)
        return result

    if min(workers, len(chunks)) <= 1:
        for rows in chunks:
            results.append(work_on(rows))
            progress(rows.stop, count)
    else:
        with ThreadPoolExecutor(min(workers, len(chunks)), thread_name_prefix="symosc") as pool:
            try:
                futures = {pool.submit(work_on, rows): rows.stop - rows.start for rows in chunks}
                for future in as_completed(futures):
                    future.result()
                    done += futures[future]
                    progress(done, count)
            except BaseException:
                cancel.set()
                pool.shutdown(wait=True, cancel_futures=True)
                raise
        results = [future.result() for future in futures]
    del SPARE_BUFFERS[MOST_SPARE:]
    return results


class Warmed(NamedTuple):
    """The result of `warm`: what was compiled or loaded from disk, and the seconds it took."""

    what: str
    was_there: bool
    seconds: float


def warm() -> list[Warmed]:
    """Compile what `simulate_many` calls, unless it is on disk.

    Raise MissingExtraError if numba is not installed.
    """
    loops = CHOICE.of_many(True)
    doubles = compiled()
    pairs = compiled_pairs()
    tangents = arithmetic.compiled_tangents()["tangents"]
    scene = load_scene("fig8")
    nothing = np.arange(0)
    none = np.zeros(0, STATE_ROW)
    start = Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end)
    in_doubles = arithmetic.Arithmetic(scene.parameters)
    K = arithmetic.pair_constants(scene.parameters)
    table = table_of([in_doubles.K])
    batch = batch_of(none)
    out = event_buffer(0)
    row = np.array([first_row_in_doubles(start)[1]], STATE_ROW)
    # what `tangents` takes: t, theta, x, v and the codes of events; dt, dx, marks, reasons, growth
    columns = *(np.zeros(0),) * 4, *(nothing,) * 3
    changes = (
        *(np.zeros((0, 1)),) * 2,
        np.zeros((0, 1), np.int8),
        np.zeros(0, np.int8),
        np.zeros((0, 2)),
    )
    of_motions = np.zeros((0, 5))
    letters = np.zeros((0, 4))
    work = np.zeros((8, 11))
    pair_rows = np.zeros(0, PAIR_ROW)
    limits = engine_batch.PairLimits(1, 1.0, 0, 1.0, table, table)
    # what `run_program` takes: operations, constants, results; arguments, out, doubts
    program = (
        *(np.zeros((0, 4), np.int64), np.zeros((0, 2)), nothing),
        *(np.zeros((0, 2, 0)), np.zeros((0, 0)), np.zeros(0, bool)),
    )
    # numba compiles a function for the types of its arguments, whatever the sizes of arrays; so these
    # are empty, or just large enough.
    calls: dict[str, list[tuple[Any, tuple[Any, ...]]]] = {
        "events in doubles": [
            (loops.table.march_rows, (table, np.zeros((1, 2, 7)))),
            (loops.table.run_program, program),
            (loops.follow, (0, batch, 1, 1.0, out, NO_PIECES, no_tally(), table)),
            (loops.settle, (no_tally(), nothing, table, np.zeros((0, 0, 2)), nothing)),
        ],
        "events of single motions": [
            (doubles["search_row"], (row, table, 0)),
            (doubles["doubt_row"], (row, 0, 1, 1.0, table, 0)),
        ],
        "events in double-double numbers": [
            (pairs.first_pairs, (pair_rows, nothing, K)),
            (
                pairs.follow_pairs,
                (nothing, nothing, pair_rows, batch, out, NO_PIECES, K, no_tally(), limits),
            ),
        ],
        "derivatives of events": [
            (
                tangents,
                (
                    nothing,
                    nothing,
                    of_motions,
                    nothing,
                    columns,
                    nothing,
                    True,
                    letters,
                    table,
                    changes,
                    work,
                ),
            )
        ],
    }
    done = []
    for subject, functions in calls.items():
        was_there = all(is_compiled(function) for function, _ in functions)
        begin = perf_counter()
        for function, arguments in functions:
            function(*arguments)
        done.append(Warmed(subject, was_there, perf_counter() - begin))
    return done
