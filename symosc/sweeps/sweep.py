"""`sweep`: motions over parameters and starts, as an xarray.Dataset."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import DataFrame, NumberLike, Progress, SceneName
from symosc.arguments import public
from symosc.display.progress import Report, reporting
from symosc.errors import SweepError
from symosc.scenes import Scene, load_scene
from symosc.sweeps import output
from symosc.sweeps.collected import Collected
from symosc.sweeps.dataset import dataset_of, need_xarray
from symosc.sweeps.grid import SWEPT_STARTS, read_grid, start_rows
from symosc.sweeps.plan import SweepPlan, read_plan
from symosc.sweeps.run import carried_out, engine
from symosc.sweeps.store import Store, missing

if TYPE_CHECKING:
    import xarray


@public
def sweep(
    scene: Scene | SceneName,
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
    """Follow one motion for each cell of a grid, or row of a table, of parameters and starts (extra `sweep`).

    The result is the same to the last bit for any workers and executor, however often the program was killed meanwhile.

    Parameters
    ----------
    scene : Scene, or its name or path
    over : mapping, DataFrame or sequence of mappings
        One to three axes: parameters, t0, x0 or v0 with their values, numbers or text ``"LO:HI:N"``; or a table, a row
        for each set. Values are taken as doubles, each read as the decimal that it prints as.
    record : str or sequence of str
        Columns of a summary (see `simulate_many`); ``"section:64"`` for 64 points. The status is always there.
    t_end, skip : number or str, optional
        End, and how long at its start a motion is not looked at; ``"60T"`` is 60 forcing periods from the start on.
    starts : array_like, shape (3,) or (n, 3), optional
        t0, x0, v0; several rows are one more dimension, "start".
    workers, executor : optional
        Threads; or an executor of concurrent.futures or Client of dask, and how many chunks are under way there.
    path, resume : optional
        Output: .nc, .zarr or .csv, and whether what an earlier run has left of the same sweep is used.
    progress : bool or callable
        True: a bar, on a terminal. Or what gets the numbers of motions done and of all.

    Raises
    ------
    ParameterError, SweepError, OutputError, MissingExtraError
        If an argument is out of range; the output is another sweep's, or a worker failed; a file cannot be written;
        a package is missing. Finished chunks are kept: the same call goes on.

    Examples
    --------
    >>> from symosc import sweep
    >>> sweep("fig9", {"Omega": "3.5:4.5:3", "FN": [5, 10]}, t_end="12T", skip="10T").word.values.tolist()
    [['P32', 'P32'], ['P32', 'P32'], ['P82746', 'P32']]
    """
    need_xarray()
    plan, given = planned(scene, over, record, t_end, skip, starts)
    target = None if path is None else output.output_path(path)
    going_on, (who, under_way) = resume, engine(executor, workers)
    if target is not None and _is_finished(plan, target, going_on):
        Store(target).remove(plan.key)  # stopped before it could do that itself
        return dataset_of(plan, output.read_columns(target), given)
    with Store(target) if target is not None else nullcontext() as store:
        if store is not None:
            store.open(plan.key, plan.content, going_on)
        return _computed(plan, given, store, lambda gaps: carried_out(plan, gaps, who, under_way), progress)


def _computed(
    plan: SweepPlan, given: dict[str, Any], store: Store | None, compute: Callable[..., Any], progress: Any
) -> xarray.Dataset:
    """Compute what is missing, and write the output."""
    results, there = Collected(len(plan.grid)), []
    for begin, end, columns in store.chunks(plan.column_names) if store is not None else ():
        results.fill(begin, end, columns)
        there.append((begin, end))
    gaps = missing(there, results.count)
    done = results.count - sum(end - begin for begin, end in gaps)
    with reporting(progress, done, results.count) as report:
        _fill(results, compute(gaps), store, done, report)
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
    starts = start_rows(starts)
    if starts is not None and np.ndim(np.asarray(starts, dtype=object)) == 1 and len(starts) == 3:
        problem, starts = problem.started(dict(zip(SWEPT_STARTS, starts, strict=True))), None
    grid = read_grid(problem, over, starts)
    return read_plan(problem, grid, record, t_end, skip), {"over": over, "starts": starts}


def _is_finished(plan: SweepPlan, target: Path, going_on: bool) -> bool:
    """Tell whether the output is there already, to be used."""
    there = output.plan_of(target, to_replace=not going_on)
    if going_on and there not in (None, plan.key):
        raise SweepError(f"{target} is the output of another sweep: name another file, or start anew")
    return going_on and there is not None


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


@public
def sweep_status(
    scene: Scene | SceneName,
    over: Mapping[str, ArrayLike] | Sequence[Mapping[str, NumberLike]] | DataFrame,
    *,
    record: str | Sequence[str] = ("word",),
    t_end: NumberLike | None = None,
    skip: NumberLike = 0,
    starts: ArrayLike | Mapping[str, ArrayLike] | DataFrame | None = None,
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
