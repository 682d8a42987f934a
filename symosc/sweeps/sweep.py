"""`sweep`: motions over parameters and starts as an xarray.Dataset, computed in chunks by threads
or an executor.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import closing, contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import DataFrame, NumberLike, Progress, SceneName
from symosc.base.arguments import (
    ARRAY_LIKE,
    DATA_FRAME,
    EXECUTOR,
    FILE,
    FLAG,
    NAMES,
    NUMBER,
    PROGRESS,
    TABLE_LIKE,
    WHOLE,
    mapping_of,
    public,
    require,
    require_or_none,
    sequence_of,
)
from symosc.base.display.progress import reporting
from symosc.base.errors import ParameterError, SweepError, SymoscError, optional
from symosc.base.exact import whole_number
from symosc.model import Model
from symosc.scenes import Scene
from symosc.sweeps import output
from symosc.sweeps.output import need_xarray
from symosc.sweeps.plan import SweepPlan, compute, kernels_hash, read_plan
from symosc.sweeps.store import Columns, Store, missing

if TYPE_CHECKING:
    import xarray

#: Processor seconds that a chunk should take; less would be overhead, more would be lost when a
#: program is killed.
CHUNK_SECONDS = 4.0
#: Motions in the first and in the largest chunk, and the largest ratio of the sizes of two
#: successive chunks.
FIRST_CHUNK = 128
MOST_CHUNK = 1 << 18
MOST_GROWTH = 16.0
CONNECT_SECONDS = 10
# Chunks under way for each processor of an executor, if the user names no number.
AHEAD = 2

Range = tuple[int, int]
#: Axes by name, or a table of sets of values.
GRID_LIKE = (mapping_of(*ARRAY_LIKE), sequence_of(mapping_of(NUMBER)), DATA_FRAME)


@public
def sweep(
    scene: Scene | Model | SceneName,
    over: Mapping[str, ArrayLike] | Sequence[Mapping[str, NumberLike]] | DataFrame,
    *,
    record: str | Sequence[str] = ("word",),
    t_end: NumberLike | None = None,
    skip: NumberLike = 0,
    starts: ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    path: str | Path | None = None,
    resume: bool = True,
    progress: Progress = False,
) -> xarray.Dataset:
    """Follow one motion for each cell of a grid, or row of a table, of parameters and starts (extra
    `sweep`).

    The result is the same to the last bit for any workers and executor, however often the program
    was killed meanwhile.

    Parameters
    ----------
    scene : Scene, or its name or path; or Parameters or Oscillator
        Parameters start from rest unless `over` or `starts` say otherwise.
    over : mapping, DataFrame or sequence of mappings
        One to three axes: parameters (also mu_s1, mu_s2: static coefficients), t0, x0 or v0 with
        their values, numbers or text ``"LO:HI:N"``; or a table, a row for each set. Values are
        taken as doubles, each read as the decimal that it prints as.
    record : str or sequence of str
        Columns of a summary (see `simulate_many`); ``"section:64"`` for 64 points. The status is
        always there.
    t_end, skip : number or str, optional
        End, and how long at its start a motion is not looked at; ``"60T"`` is 60 forcing periods
        from the start on.
    starts : array_like, shape (3,) or (n, 3), optional
        t0, x0, v0; several rows are one more dimension, "start".
    workers, executor : optional
        The number of threads. With an executor of concurrent.futures, or a Client of dask, it is
        the number of chunks that are under way there.
    path, resume : optional
        The output file (.nc, .zarr or .csv), and whether to use what an earlier run of the same
        sweep has left.
    progress : bool or callable
        True: a bar, on a terminal. Or what gets the numbers of motions done and of all.

    Raises
    ------
    ParameterError, SweepError, OutputError, MissingExtraError
        If an argument is out of range; the output is another sweep's, or a worker failed; a file
        cannot be written; a package is missing. Finished chunks are kept: the same call goes on.

    Examples
    --------
    >>> from symosc import sweep
    >>> sweep("fig9", {"Omega": "3.5:4.5:3", "FN": [5, 10]}, t_end="12T", skip="10T").word.values.tolist()
    [['P32', 'P32'], ['P32', 'P32'], ['P74682', 'P32']]
    """
    require(*GRID_LIKE, over=over)
    require(*NAMES, record=record)
    require_or_none(NUMBER, t_end=t_end)
    require(NUMBER, skip=skip)
    require_or_none(*TABLE_LIKE, starts=starts)
    require_or_none(WHOLE, workers=workers)
    require_or_none(EXECUTOR, executor=executor)
    require_or_none(*FILE, path=path)
    require(FLAG, resume=resume)
    require(*PROGRESS, progress=progress)
    need_xarray()
    plan = read_plan(scene, over, record, t_end, skip, starts)
    if path is None:
        target = None
    else:
        target = output.output_path(path)
    pool, under_way = read_executor(executor, workers)
    if target is not None and _is_finished(plan, target, resume):
        Store(target).remove(plan.key)  # stopped before it could do that itself
        return output.dataset_of(plan, output.read_columns(target))
    with closing(Store(target)) if target is not None else nullcontext() as store:
        columns = dict[str, np.ndarray]()
        kept_ranges = list[Range]()
        total = len(plan)
        if store is not None:
            store.open(plan.key, plan.content, resume)
            for begin, end, chunk in store.chunks(plan.column_names):
                _fill(columns, total, begin, end, chunk)
                kept_ranges.append((begin, end))
        gaps = missing(kept_ranges, total)
        done = total - sum(end - begin for begin, end in gaps)
        with reporting(progress, done, total) as report:
            try:
                for begin, end, chunk in _carried_out(plan, gaps, pool, under_way):
                    if store is not None:
                        store.write(begin, end, chunk)  # it is on disk before it counts
                    _fill(columns, total, begin, end, chunk)
                    done += end - begin
                    report(done, total)
            except SweepError as error:
                if store is None:
                    raise
                kept = (
                    f"{done} of {total} motions are kept in {store.folder}, and the same call goes "
                    "on"
                )
                raise SweepError(f"{error}; {kept}") from error.__cause__
        dataset = output.dataset_of(plan, columns)
        if store is not None:
            output.write_output(dataset, store.output, store.folder)
            store.remove(plan.key)
        return dataset


def _fill(columns: Columns, count: int, begin: int, end: int, chunk: Columns) -> None:
    """Copy the columns of a chunk, with the cells from `begin` up to `end`, into columns of all
    `count` cells.
    """
    for name, values in chunk.items():
        if name not in columns:
            columns[name] = np.zeros((count, *values.shape[1:]), values.dtype)
        if columns[name].dtype.itemsize < values.dtype.itemsize:  # longer texts
            columns[name] = columns[name].astype(values.dtype)
        columns[name][begin:end] = values


def _is_finished(plan: SweepPlan, target: Path, resume: bool) -> bool:
    """Return whether the output file exists and holds the result of this plan."""
    written_plan = output.plan_of(target, to_replace=not resume)
    if resume and written_plan not in (None, plan.key):
        raise SweepError(
            f"{target} is the output of another sweep: name another file, or start anew"
        )
    return resume and written_plan is not None


class Here(Executor):
    """An executor that computes each submitted chunk at once, in this process, on all threads."""

    def __init__(self, workers: int | None) -> None:
        self.workers = workers

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Compute a chunk and return a finished future."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs, workers=self.workers))
        except Exception as error:
            future.set_exception(error)
        return future


def read_executor(executor: Any, workers: Any) -> tuple[Executor, int]:
    """Return the executor that computes chunks, and how many chunks may be under way in it at a
    time.

    Without an `executor` this process computes them, on so many threads as `workers` says (default:
    all cores). With an executor, `workers` is the number of chunks under way.
    """
    if workers is None:
        count = None
    else:
        count = whole_number("workers", workers, 1)
    if executor is None:
        return Here(count), 1
    if hasattr(executor, "get_executor") and hasattr(executor, "ncores"):  # a Client of dask
        if count is None:
            count = AHEAD * max(sum(executor.ncores().values()), 1)
        return executor.get_executor(pure=False), count
    if not isinstance(executor, Executor):
        allowed = "give an executor of concurrent.futures, or a Client of dask.distributed"
        raise ParameterError("executor", type(executor).__name__, allowed)
    if count is None:
        count = AHEAD * (getattr(executor, "_max_workers", None) or os.cpu_count() or 1)
    return executor, count


def dask_client(address: str) -> Any:
    """Return a client of a dask cluster, by the address of its scheduler or the name of its
    scheduler file.
    """
    Client = optional("distributed", "a dask cluster", "sweep").Client
    if address.endswith(".json"):
        if not Path(address).is_file():  # dask would wait for it
            raise ParameterError(
                "executor", address, "must be the name of an existing scheduler file"
            )
        return Client(scheduler_file=address, timeout=CONNECT_SECONDS)
    try:
        return Client(address, timeout=CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        allowed = f"no scheduler of dask answers there ({_error_text(error)})"
        raise ParameterError("executor", address, allowed) from None


def _carried_out(
    plan: SweepPlan, gaps: list[Range], executor: Executor, under_way: int
) -> Iterator[tuple[int, int, Columns]]:
    """Compute the cells in the ranges `gaps` in chunks, and yield each chunk as soon as it is
    complete.
    """
    # At most `under_way` chunks are submitted and not finished. SweepError if a worker fails; what
    # was yielded stands.
    todo = gaps[::-1]  # `_next_chunk` takes from the end
    size = FIRST_CHUNK
    pending = dict[Future[tuple[Columns, float]], Range]()
    try:
        while todo or pending:
            while todo and len(pending) < under_way:
                begin, end = _next_chunk(todo, size, under_way)
                with _worker_errors():
                    future = executor.submit(
                        partial(compute, plan.arguments(begin, end), kernels_hash())
                    )
                pending[future] = begin, end
            done, _ = wait(pending, return_when=FIRST_COMPLETED)
            # Failed chunks come last: the others are kept before the error is raised.
            failures_last = sorted(
                done, key=lambda task: task.cancelled() or task.exception() is not None
            )
            for future in failures_last:
                begin, end = pending.pop(future)
                with _worker_errors():
                    columns, seconds = future.result()
                # The next chunk gets as many cells as take CHUNK_SECONDS at the speed of this one.
                growth = min(max(CHUNK_SECONDS / max(seconds, 1e-6), 1 / MOST_GROWTH), MOST_GROWTH)
                size = int(min(max((end - begin) * growth, 1), MOST_CHUNK))
                yield begin, end, columns
    finally:
        for future in pending:
            future.cancel()


def _next_chunk(todo: list[Range], size: int, under_way: int) -> Range:
    """Take a chunk of about `size` cells off the ranges `todo`, less if too few are left for
    `under_way` chunks.
    """
    left = sum(end - begin for begin, end in todo)
    begin, end = todo.pop()
    middle = min(end, begin + max(min(size, -(-left // under_way)), 1))
    if end - middle < (middle - begin) // 4:  # a rest that small is not worth its own chunk
        return begin, end
    if middle < end:
        todo.append((middle, end))
    return begin, middle


@contextmanager
def _worker_errors() -> Iterator[None]:
    """Turn an error of a worker or its pool into SweepError, except symosc's own errors and a lack
    of memory.
    """
    try:
        yield
    except (SymoscError, MemoryError):
        raise
    except Exception as error:
        raise SweepError(f"a worker failed: {_error_text(error)}") from error


def _error_text(error: BaseException) -> str:
    """Return an error on one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())


class SweepStatus(NamedTuple):
    """The progress of a sweep.

    Attributes
    ----------
    path : str
    done, total : int
        Motions.
    written : bool
        Whether the output is written.

    Examples
    --------
    >>> from symosc import sweep_status
    >>> sweep_status("fig9", {"Omega": "1:6:500"}, path="map.nc")
    SweepStatus(path='map.nc', done=0, total=500, written=False)
    """

    path: str
    done: int
    total: int
    written: bool


@public
def sweep_status(
    scene: Scene | Model | SceneName,
    over: Mapping[str, ArrayLike] | Sequence[Mapping[str, NumberLike]] | DataFrame,
    *,
    record: str | Sequence[str] = ("word",),
    t_end: NumberLike | None = None,
    skip: NumberLike = 0,
    starts: ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
    path: str | Path,
) -> SweepStatus:
    """Return the progress of the sweep with the same arguments, without computing anything.

    Raises
    ------
    ParameterError, SweepError
        As `sweep` would.

    Examples
    --------
    >>> from symosc import sweep_status
    >>> sweep_status("fig9", {"Omega": "1:6:500"}, path="map.nc").done
    0
    """
    require(*GRID_LIKE, over=over)
    require(*NAMES, record=record)
    require_or_none(NUMBER, t_end=t_end)
    require(NUMBER, skip=skip)
    require_or_none(*TABLE_LIKE, starts=starts)
    require(*FILE, path=path)
    plan = read_plan(scene, over, record, t_end, skip, starts)
    target = output.output_path(path)
    store = Store(target)
    total = len(plan)
    written = _is_finished(plan, target, resume=True)
    if not written and store.key() not in (None, plan.key):
        raise store.foreign_error()
    if written:
        left = 0
    else:
        left = sum(end - begin for begin, end in missing(store.ranges(), total))
    return SweepStatus(str(path), total - left, total, written)
