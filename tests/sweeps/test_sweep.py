"""`sweep`: the same bits however it is computed, stopped and resumed; and what it refuses."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from samples import sample_of
from small_sweeps import OPTIONS, OVER, SCENE, identical, in_small_chunks

from symosc import OutputError, SceneError, SweepError, simulate, sweep, sweep_status
from symosc.errors import MissingExtraError, brief
from symosc.scenes import load_scene
from symosc.sweeps import run
from symosc.sweeps.store import Store

pytest.importorskip("xarray")


@pytest.fixture(scope="module")
def whole() -> Any:
    return sweep(SCENE, OVER, **OPTIONS)


class Stopped(BaseException):
    """What stands for the end of the program."""


@pytest.mark.slow
def test_chunks_do_not_change_the_result(whole: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for motions in (1, 5, 7):
        in_small_chunks(monkeypatch, motions)
        identical(sweep(SCENE, OVER, **OPTIONS, workers=1), whole)


@pytest.mark.quick(1)
@pytest.mark.parametrize("suffix", [".nc", ".zarr", ".csv"])
def test_a_finished_output_is_read_and_not_computed_again(
    whole: Any, suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"map{suffix}"
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    assert sweep_status(SCENE, OVER, **OPTIONS, path=path) == (str(path), 24, 24, True)
    monkeypatch.setattr(run, "computed", None)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)


def stopped_at(call: int, function: Callable[..., Any], after: bool) -> Callable[..., Any]:
    """Return a function that stops the program at its n-th call, before or after it has done its work."""
    calls = 0

    def stopping(*args: Any, **kwargs: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == call and not after:
            raise Stopped
        result = function(*args, **kwargs)
        if calls == call:
            raise Stopped
        return result

    return stopping


@pytest.mark.quick(2)
@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("target", ["os.replace", "os.mkdir", "numpy.savez", "symosc.sweeps.run.computed"])
def test_wherever_it_is_stopped_it_goes_on_to_the_same_bits(
    whole: Any, target: str, after: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped at each call of what makes files, in turn: each run gets a little farther."""
    in_small_chunks(monkeypatch, 5)
    path, stops, done = tmp_path / "map.nc", 0, [0]
    for call in [1, 2, 1, 3, 2, 1, 4, 1, 2, 99]:
        with monkeypatch.context() as patch:
            module, _, name = target.rpartition(".")
            patch.setattr(target, stopped_at(call, getattr(sys.modules[module], name), after))
            try:
                found = sweep(SCENE, OVER, **OPTIONS, path=path)
            except Stopped:
                stops += 1
                done.append(sweep_status(SCENE, OVER, **OPTIONS, path=path).done)
                continue
        identical(found, whole)
        break
    assert stops
    assert done == sorted(done)  # what is finished is kept
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)
    assert [each.name for each in tmp_path.iterdir()] == ["map.nc"]


KILLED = """
import os, signal, sys
from symosc.sweeps import run
from symosc.sweeps.store import Store
from symosc import sweep
sys.path[:0] = [{support!r}]
from small_sweeps import OPTIONS, SCENE
run.FIRST_CHUNK = run.MOST_CHUNK = 1
files, calls = map(int, sys.argv[1:])  # when it is killed: so many calls after its n-th step with its files
def step(event, arguments):
    global files
    if any("map.nc" in str(each) for each in arguments):
        files -= 1
        if files == 0:
            sys.setprofile(call)
def call(*_):
    global calls
    calls -= 1
    if calls < 0:
        os.kill(os.getpid(), signal.SIGKILL)
sys.addaudithook(step)
sweep(SCENE, {over!r}, **OPTIONS, path={path!r}, workers=1)
"""


@pytest.mark.slow
@sample_of(3, 20)
def test_killed_at_random_moments_it_goes_on_to_the_same_bits(count: int, tmp_path: Path) -> None:
    path, rng, over = tmp_path / "map.nc", np.random.default_rng(count), OVER | {"FN": "1:20:50"}
    script = KILLED.format(support=str(Path(__file__).parents[1] / "support"), path=str(path), over=over)
    for _ in range(count):
        moment = str(rng.integers(1, 60)), str(rng.choice([0, 0, rng.integers(0, 1000)]))
        assert subprocess.run([sys.executable, "-c", script, *moment], check=False).returncode == -signal.SIGKILL
    assert not path.exists()
    assert 0 < sweep_status(SCENE, over, **OPTIONS, path=path).done < 300
    identical(sweep(SCENE, over, **OPTIONS, path=path), sweep(SCENE, over, **OPTIONS))
    assert [each.name for each in tmp_path.iterdir()] == ["map.nc"]


@pytest.mark.slow
def test_an_output_of_another_sweep_is_not_touched(whole: Any, tmp_path: Path) -> None:
    path = tmp_path / "map.nc"
    sweep(SCENE, OVER, **OPTIONS, path=path)
    content = path.read_bytes()
    for over, options in (({"k": [3]}, OPTIONS), (OVER, OPTIONS | {"t_end": "7T"})):
        for call in (sweep, sweep_status):
            with pytest.raises(SweepError, match="output of another sweep"):
                call(SCENE, over, **options, path=path)
    assert path.read_bytes() == content
    sweep(SCENE, {"k": [3]}, path=path, resume=False)
    assert sweep(SCENE, {"k": [3]}, path=path).sizes == {"k": 1}


def test_a_file_that_is_no_output_is_not_touched(tmp_path: Path) -> None:
    for suffix in (".nc", ".zarr", ".csv"):
        path = tmp_path / f"mine{suffix}"
        path.write_text("my data\n")
        with pytest.raises(SweepError, match="is no output of a sweep"):
            sweep(SCENE, OVER, **OPTIONS, path=path)
        assert path.read_text() == "my data\n"


def test_chunks_of_another_sweep_are_not_touched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    in_small_chunks(monkeypatch, 5)
    path = tmp_path / "map.nc"
    with monkeypatch.context() as patch:
        patch.setattr(run, "computed", stopped_at(3, run.computed, False))
        with pytest.raises(Stopped):
            sweep(SCENE, OVER, **OPTIONS, path=path)
    there = sweep_status(SCENE, OVER, **OPTIONS, path=path)
    assert there == (str(path), 10, 24, False)
    for call in (sweep, sweep_status):
        with pytest.raises(SweepError, match="chunks of another sweep"):
            call(SCENE, {"k": [3]}, path=path)
    assert sweep_status(SCENE, OVER, **OPTIONS, path=path) == there


@pytest.mark.slow
def test_a_full_disk_keeps_what_is_finished(whole: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    in_small_chunks(monkeypatch, 5)
    path = tmp_path / "map.nc"

    def full(call: int, function: Callable[..., Any]) -> Callable[..., Any]:
        stopping = stopped_at(call, function, False)

        def filling(*args: Any, **kwargs: Any) -> Any:
            try:
                return stopping(*args, **kwargs)
            except Stopped:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)) from None

        return filling

    for target, call, done in (("savez", 3, 10), ("savez", 2, 15)):
        with monkeypatch.context() as patch:
            patch.setattr(np, target, full(call, np.savez))
            with pytest.raises(OutputError, match="No space left on device"):
                sweep(SCENE, OVER, **OPTIONS, path=path)
        assert sweep_status(SCENE, OVER, **OPTIONS, path=path).done == done
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)


LIMITED = """
import resource, sys
sys.path[:0] = [{support!r}]
from small_sweeps import OPTIONS, OVER, SCENE
from symosc import OutputError, sweep
from symosc.sweeps import run
from symosc.sweeps.store import Store
run.FIRST_CHUNK = run.MOST_CHUNK = 5
resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
try:
    sweep(SCENE, OVER, **OPTIONS, path={path!r})
except OutputError as error:
    print(error)
"""


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".nc", ".zarr", ".csv"])
def test_a_disk_that_the_output_fills_keeps_all_chunks(whole: Any, suffix: str, tmp_path: Path) -> None:
    """The system refuses to write files of more than 3,000 bytes; HDF5 ended the program with a segmentation fault."""
    pytest.importorskip("resource")
    path = tmp_path / f"map{suffix}"
    script = LIMITED.format(support=str(Path(__file__).parents[1] / "support"), path=str(path))
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout) == (0, f"cannot write {brief(str(path))}: File too large\n"), (
        result.stderr
    )
    assert not path.exists()
    assert sweep_status(SCENE, OVER, **OPTIONS, path=path) == (str(path), 24, 24, False)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_an_output_is_on_the_disk_before_its_chunks_are_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not only in the system's memory, which a power failure empties."""
    path, synced = tmp_path / "map.nc", list[tuple[int, bool]]()
    monkeypatch.setattr(
        os, "fsync", lambda handle: synced.append((os.fstat(handle).st_ino, bool(Store(path).ranges())))
    )
    sweep(SCENE, {"k": [3]}, t_end=1, path=path)
    assert synced == [(path.stat().st_ino, True), (tmp_path.stat().st_ino, True)]


@pytest.mark.parametrize("resume", [True, False])
def test_what_is_not_ours_is_refused_and_stays(resume: bool, tmp_path: Path) -> None:
    for name in ("map.zarr", "other.nc.parts"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "thesis.tex").write_text("mine")
    (tmp_path / "file.nc").write_text("mine")
    for name in ("map.zarr", "other.nc", "file.nc"):
        with pytest.raises(SweepError, match=r"no output of a sweep|no folder of a sweep"):
            sweep(SCENE, {"k": [3]}, path=tmp_path / name, resume=resume)
    theirs = sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file())
    assert theirs == ["file.nc", "map.zarr/thesis.tex", "other.nc.parts/thesis.tex"]


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".nc", ".zarr", ".csv"])
def test_a_damaged_output_is_refused_and_made_anew(whole: Any, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"map{suffix}"
    sweep(SCENE, OVER, **OPTIONS, path=path)
    file = path / "x" / "c" / "0" / "0" if path.is_dir() else path
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)
    with pytest.raises(SweepError, match="is damaged"):
        sweep(SCENE, OVER, **OPTIONS, path=path)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path, resume=False), whole)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)


@pytest.mark.parametrize("seed", range(3))
def test_each_cell_is_the_motion_that_its_coordinates_say(seed: int) -> None:
    rng, scene = np.random.default_rng(seed), load_scene("fig9")
    over = {"Omega": rng.uniform(2, 6, 3), "x0": rng.normal(0, 3, 2), "mu1": rng.uniform(0, 1, 2)}
    found = sweep(scene, over, t_end="7/3T", record=("events", "sticks", "x"))
    for cell in np.ndindex(found.events.shape):
        one = found[dict(zip(over, cell, strict=True))]
        p = scene.parameters.replace(Omega=float(one.Omega), mu1=float(one.mu1))
        t_end = float(scene.t0) + float(7 / 3) * (2 * np.pi / float(one.Omega))
        motion = simulate(p, t0=scene.t0, x0=float(one.x0), v0=scene.v0, t_end=t_end)
        assert (len(motion.events), str(one.status.values)) == (int(one.events), motion.status)
        assert sum(event.kind == "stick" for event in motion.events) == int(one.sticks)
        assert float(one.x) == pytest.approx(float(motion(t_end)[0]), rel=1e-11, abs=1e-11)


def test_one_start_replaces_the_scenes_and_several_are_a_dimension() -> None:
    several = sweep("fig9", {"FN": [5, 10]}, starts=[(0, 1, 2), (0, 3, 4)], t_end=3, record="x")
    assert several.x.dims == ("FN", "start")
    for i, start in enumerate([(0, 1, 2), (0, 3, 4)]):
        one = sweep("fig9", {"FN": [5, 10]}, starts=start, t_end=3, record="x")
        assert one.x.values.tolist() == several.x.values[:, i].tolist()


def test_a_table_of_sets() -> None:
    rows = [{"Omega": 3, "FN": 5}, {"Omega": 4, "FN": 10}]
    found = sweep("fig9", rows, t_end=3, record="x")
    grid = sweep("fig9", {"Omega": [3, 4], "FN": [5, 10]}, t_end=3, record="x")
    assert found.x.dims == ("set",)
    assert found.x.values.tolist() == [grid.x.values[0, 0], grid.x.values[1, 1]]


def test_progress_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    in_small_chunks(monkeypatch, 10)
    calls: list[tuple[int, int]] = []
    sweep(SCENE, OVER, **OPTIONS, progress=lambda *numbers: calls.append(numbers))
    assert calls == [(10, 24), (24, 24)] or calls == [(10, 24), (20, 24), (24, 24)]


def test_without_xarray_one_line_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(MissingExtraError, match=r"symosc\[sweep\]"):
        sweep(SCENE, OVER)


@pytest.mark.parametrize(
    ("options", "name"),
    [({"resume": 1}, "resume"), ({"workers": 0}, "workers"), ({"executor": 5}, "executor"), ({"path": 5}, "path")],
)
def test_what_is_refused(options: dict[str, Any], name: str) -> None:
    refused(lambda: sweep(SCENE, OVER, **options), name)


@pytest.mark.parametrize("path", ["map.txt", "map", "-", "no/such/folder/map.nc", "map.png"])
def test_what_is_no_output(path: str) -> None:
    with pytest.raises(OutputError):
        sweep(SCENE, OVER, path=path)


def test_an_unknown_scene() -> None:
    with pytest.raises(SceneError):
        sweep("fig99", OVER)
