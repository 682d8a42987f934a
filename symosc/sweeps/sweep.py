"""`sweep`: motions over parameters and starts, as an xarray.Dataset."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from symosc.errors import SweepError
from symosc.exact import true_or_false
from symosc.scenes import Scene, load_scene
from symosc.sweeps import output
from symosc.sweeps.collected import Collected
from symosc.sweeps.dataset import dataset_of, need_xarray
from symosc.sweeps.grid import SWEPT_STARTS, read_grid
from symosc.sweeps.plan import SweepPlan, read_plan
from symosc.sweeps.progress import Report, reporting
from symosc.sweeps.run import carried_out, engine
from symosc.sweeps.store import Store, missing

if TYPE_CHECKING:
    import xarray


def sweep(
    scene: Scene | str | Path,
    over: Any,
    *,
    record: str | Sequence[str] = ("word",),
    t_end: Any = None,
    skip: Any = 0,
    starts: Any = None,
    workers: int | None = None,
    executor: Any = None,
    path: str | Path | None = None,
    resume: bool = True,
    progress: Any = False,
) -> xarray.Dataset:
    """Follow one motion for each cell of a grid, or each row of a table, of parameters and starts.

    Needs the extra `sweep`. A motion, and so every number of the result, depends on its cell alone: the result is the
    same to the last bit for any number of workers, any executor, and however often the program was killed meanwhile.

    Parameters
    ----------
    scene : Scene, or its name or path
        What is not swept.
    over : mapping, DataFrame or sequence of mappings
        One to three axes: names of parameters or of t0, x0, v0 with their values, numbers or text ``"LO:HI:N"`` for N
        evenly spaced ones. Or a table, each row a set. Values are taken as doubles, each read as the decimal that it
        prints as.
    record : str or sequence of str
        Columns of a summary (see `simulate_many`): word, multiplicity, events, sticks, stuck, t, x, v, mode, x_min,
        x_max, v_min, v_max, section (``"section:64"`` for 64 points). The status is always there.
    t_end : number or str, optional
        End of all motions, or text such as ``"60T"``: 60 periods of the forcing after the start. Default: the scene's.
    skip : number or str
        How long at its start a motion is not looked at; time, or periods such as ``"40T"``.
    starts : array_like, shape (3,) or (n, 3), optional
        t0, x0, v0; several rows are one more dimension, "start".
    workers : int, optional
        Threads, by default as many as there are cores; with an executor, how many chunks are under way.
    executor : concurrent.futures.Executor or dask.distributed.Client, optional
        Where chunks are computed. Default: threads of this process.
    path : str or Path, optional
        Output: .nc (netCDF), .zarr or .csv. Finished chunks are kept beside it until it is written.
    resume : bool
        Whether finished chunks, or a finished output, of the same sweep are used. False: start anew, and replace it.
    progress : bool or callable
        True: a bar with rate and time left, on a terminal. Or what gets the numbers of motions done and of all.

    Returns
    -------
    xarray.Dataset
        Its attribute ``call`` is the call that gives it again.

    Raises
    ------
    ParameterError
        If an argument is out of range.
    SweepError
        If the output is another sweep's, or a worker failed. Finished chunks are kept: the same call goes on.
    OutputError
        If a file cannot be written, for example on a full disk. Finished chunks are kept.
    MissingExtraError
        If xarray, or what writes the output, is not installed.

    Examples
    --------
    >>> from symosc import sweep
    >>> found = sweep("fig9", {"Omega": "3.5:4.5:3", "FN": [5, 10]}, t_end="12T", skip="10T")
    >>> found.word.values.tolist()
    [['P32', 'P32'], ['P32', 'P32'], ['P32', 'P32']]
    """
    need_xarray()
    plan, given = planned(scene, over, record, t_end, skip, starts)
    target = None if path is None else output.output_path(path)
    going_on = true_or_false("resume", resume)
    who, under_way = engine(executor, workers)
    if target is not None and _is_finished(plan, target, going_on):
        Store(target).remove(plan.key)  # stopped before it could do that itself
        return dataset_of(plan, output.read_columns(target), given)
    results, there = Collected(len(plan.grid)), []
    with Store(target) if target is not None else nullcontext() as store:
        if store is not None:
            store.open(plan.key, plan.content, going_on)
            for begin, end, columns in store.chunks():
                results.fill(begin, end, columns)
                there.append((begin, end))
        gaps = missing(there, results.count)
        done = results.count - sum(end - begin for begin, end in gaps)
        with reporting(progress, done, results.count) as report:
            _fill(results, carried_out(plan, gaps, who, under_way), store, done, report)
        dataset = dataset_of(plan, results.columns(), given)
        if store is not None:
            output.write_output(dataset, store.output, store.folder)
            store.remove(plan.key)
    return dataset


def _fill(results: Collected, chunks: Any, store: Store | None, done: int, report: Report) -> None:
    """Take chunks in as they come; each is on disk before it counts."""
    try:
        for begin, end, chunk in chunks:
            if store is not None:
                store.write(begin, end, chunk.columns)
            results.fill(begin, end, chunk.columns)
            done += end - begin
            report(done, results.count)
    except SweepError as error:
        if store is None:
            raise
        kept = f"{done} of {results.count} motions are kept in {store.folder}, and the same call goes on"
        raise SweepError(f"{error}; {kept}") from error.__cause__


def planned(scene: Any, over: Any, record: Any, t_end: Any, skip: Any, starts: Any) -> tuple[SweepPlan, dict[str, Any]]:
    """Return the plan of a call, and what of the call is not in it."""
    problem = scene if isinstance(scene, Scene) else load_scene(scene)
    if starts is not None and np.ndim(np.asarray(starts, dtype=object)) == 1 and len(starts) == 3:
        problem, starts = problem.started(dict(zip(SWEPT_STARTS, starts, strict=True))), None
    grid = read_grid(problem, over, starts)
    return read_plan(problem, grid, record, t_end, skip), {"over": over, "starts": starts}


def _is_finished(plan: SweepPlan, target: Path, going_on: bool) -> bool:
    """Tell whether the output is there already."""
    there = output.plan_of(target) if going_on else None
    if there not in (None, plan.key):
        raise SweepError(f"{target} is the output of another sweep: name another file, or start anew")
    return there is not None


class SweepStatus(NamedTuple):
    """How far a sweep is.

    Attributes
    ----------
    path : str
    done, total : int
        Motions.
    written : bool
        Whether the output is there.

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


def sweep_status(
    scene: Scene | str | Path,
    over: Any,
    *,
    record: str | Sequence[str] = ("word",),
    t_end: Any = None,
    skip: Any = 0,
    starts: Any = None,
    path: str | Path,
) -> SweepStatus:
    """Tell how far the sweep with the same arguments is, without computing anything; it may be running meanwhile.

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
    plan, _ = planned(scene, over, record, t_end, skip, starts)
    target = output.output_path(path)
    total, written = len(plan.grid), _is_finished(plan, target, True)
    store = Store(target)
    if not written and store.key() not in (None, plan.key):
        raise store.strange()
    left = 0 if written else sum(end - begin for begin, end in missing(store.ranges(), total))
    return SweepStatus(str(path), total - left, total, written)
