"""Who computes the chunks: any executor gives the same bits, and a worker that fails loses nothing that is finished."""

from __future__ import annotations

import os
import signal
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from effort import PATIENCE
from small_sweeps import OPTIONS, OVER, SCENE, identical, in_small_chunks

from symosc import SweepError, sweep, sweep_status
from symosc.sweeps import run
from symosc.sweeps.motions import Chunk
from symosc.sweeps.run import Sizes, carried_out, dask_client, engine
from symosc.sweeps.sweep import planned

pytest.importorskip("xarray")


@pytest.fixture(scope="module")
def whole() -> Any:
    return sweep(SCENE, OVER, **OPTIONS)


def test_threads_of_ones_own(whole: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    in_small_chunks(monkeypatch, 5)
    with ThreadPoolExecutor(3) as threads:
        identical(sweep(SCENE, OVER, **OPTIONS, executor=threads), whole)


class Delayed(ThreadPoolExecutor):
    """Begins each chunk after a random delay, so that they are done in another order."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        delay = np.random.default_rng(self._work_queue.qsize()).uniform(0, 0.05)

        def later() -> Any:
            time.sleep(delay)
            return fn(*args, **kwargs)

        return super().submit(later)


def test_the_order_of_the_chunks_does_not_matter(whole: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    in_small_chunks(monkeypatch, 2)
    with Delayed(3) as threads:
        identical(sweep(SCENE, OVER, **OPTIONS, executor=threads, workers=3), whole)


@pytest.mark.parametrize("seed", range(10))
def test_every_cell_is_computed_once(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the chunks' times and whatever is there already."""
    rng = np.random.default_rng(seed)
    plan, _ = planned(SCENE, {"Omega": "1:6:50", "FN": "1:20:40"}, "word", 3, 0, None)
    cuts = np.sort(rng.choice(2000, 8, replace=False)).tolist()
    gaps = [(cuts[i], cuts[i + 1]) for i in range(0, 8, 2)]
    monkeypatch.setattr(run, "computed", lambda share, **_: Chunk({}, float(rng.exponential(3))))
    seen = np.zeros(2000, dtype=int)
    for begin, end, _ in carried_out(plan, gaps, run.Here(1), int(rng.integers(1, 4))):
        seen[begin:end] += 1
    expected = np.zeros(2000, dtype=int)
    for begin, end in gaps:
        expected[begin:end] = 1
    assert seen.tolist() == expected.tolist()


@pytest.mark.parametrize("rate", [0.3, 10.0, 5000.0])
def test_chunks_become_as_long_as_they_should(rate: float) -> None:
    sizes = Sizes()
    for _ in range(12):
        sizes.learn(sizes.next, sizes.next / rate)
    assert sizes.next == pytest.approx(max(run.CHUNK_SECONDS * rate, 1), rel=0.2)


@pytest.mark.slow
def test_a_worker_that_dies_loses_nothing_that_is_finished(
    whole: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process of a pool is killed in the middle; the pool is broken, the same call goes on with another one."""
    in_small_chunks(monkeypatch, 4)
    path = tmp_path / "map.nc"
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:

        def kill(done: int, _: int) -> None:
            if done == 8:
                pool.submit(os._exit, 1)

        with pytest.raises(SweepError, match=r"a worker failed.* motions are kept in .*map\.nc\.parts"):
            sweep(SCENE, OVER, **OPTIONS, path=path, executor=pool, workers=1, progress=kill)
        assert sweep_status(SCENE, OVER, **OPTIONS, path=path).done >= 8
        with pytest.raises(SweepError, match="a worker failed"):  # it stays broken
            sweep(SCENE, OVER, **OPTIONS, path=path, executor=pool)
    with ThreadPoolExecutor(2) as threads:
        identical(sweep(SCENE, OVER, **OPTIONS, path=path, executor=threads), whole)


def test_an_error_of_a_worker_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any, **__: Any) -> None:
        raise ZeroDivisionError("of\nsome kind")

    monkeypatch.setattr(run, "computed", broken)
    with pytest.raises(SweepError) as caught:
        sweep(SCENE, OVER)
    assert str(caught.value) == "a worker failed: ZeroDivisionError: of some kind"


def test_what_is_done_beside_an_error_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of chunks that end together, the whole ones come first."""
    plan, _ = planned(SCENE, {"Omega": "1:6:50"}, "word", 3, 0, None)
    in_small_chunks(monkeypatch, 10)

    class Together(ThreadPoolExecutor):
        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            ended: Future[Any] = Future()
            if not made:
                ended.set_exception(ZeroDivisionError("of some kind"))
            else:
                ended.set_result(Chunk({}, 1.0))
            made.append(ended)
            return ended

    made: list[Future[Any]] = []
    chunks = carried_out(plan, [(0, 50)], Together(1), 5)
    begins = [next(chunks)[0]]
    begins += [next(chunks)[0] for _ in range(len(made) - 2)]
    assert min(begins) > 0
    assert len(begins) == 4
    with pytest.raises(SweepError, match="ZeroDivisionError"):
        next(chunks)


def test_a_worker_with_another_version_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symosc.sweeps.plan.kernels_hash", lambda: "another")
    with pytest.raises(SweepError, match="another version of symosc"):
        sweep(SCENE, OVER)


@pytest.mark.slow
def test_a_cluster_of_which_a_worker_is_killed_loses_nothing(
    whole: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two processes of dask; one is killed after the first chunks, its work is done again."""
    distributed = pytest.importorskip("distributed")
    in_small_chunks(monkeypatch, 1)
    options: dict[str, Any] = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**options, processes=True) as cluster, distributed.Client(cluster) as client:
        before = client.run(os.getpid)
        killed: list[int] = []

        def kill(done: int, _: int) -> None:
            if done >= 6 and not killed:
                killed.append(next(iter(before.values())))
                os.kill(killed[0], signal.SIGKILL)

        path = tmp_path / "map.nc"
        identical(sweep(SCENE, OVER, **OPTIONS, path=path, executor=client, progress=kill), whole)
        assert killed
        monkeypatch.setattr(run, "CONNECT_SECONDS", PATIENCE)
        with dask_client(cluster.scheduler_address) as again, again.get_executor() as executor:
            few = {"Omega": [3], "FN": [5, 10]}
            identical(sweep(SCENE, few, **OPTIONS, executor=executor, workers=2), sweep(SCENE, few, **OPTIONS))


@pytest.mark.parametrize("executor", [5, "dask", object(), ThreadPoolExecutor])
def test_what_is_no_executor(executor: Any) -> None:
    refused(lambda: engine(executor, None), "executor")


def test_no_scheduler_answers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(run, "CONNECT_SECONDS", 0.2)
    refused(lambda: dask_client("tcp://127.0.0.1:9"), "executor")
    refused(lambda: dask_client(str(tmp_path / "none.json")), "executor")
