"""`sweep`: the same bits however and by whomever it is computed, stopped and resumed.

Its page, and a published map.
"""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from math import cos, pi, sin, sqrt, tan
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_runs import good
from effort import PATIENCE
from samples import sample_of
from scipy.optimize import minimize_scalar
from small_sweeps import OPTIONS, OVER, SCENE, identical, in_small_chunks

from symosc import Parameters, Scene, SweepError, simulate, sweep, sweep_status
from symosc.base.errors import brief
from symosc.scenes import load_scene
from symosc.sweeps import sweep as chunks
from symosc.sweeps.sweep import dask_client

pytest.importorskip("xarray")


@pytest.fixture(scope="module")
def whole() -> Any:
    return sweep(SCENE, OVER, **OPTIONS)


@pytest.mark.quick(1)
@pytest.mark.parametrize("suffix", [".nc", ".zarr", ".csv"])
def test_a_finished_output_is_read_and_not_computed_again(
    whole: Any, suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"map{suffix}"
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)
    assert [path.name for path in tmp_path.iterdir()] == [path.name]
    assert sweep_status(SCENE, OVER, **OPTIONS, path=path) == (str(path), 24, 24, True)
    monkeypatch.setattr(chunks, "compute", None)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)


KILLED = """
import os, signal, sys
from symosc.sweeps import sweep as chunks
from symosc.sweeps.store import Store
from symosc import sweep
sys.path[:0] = [{support!r}]
from small_sweeps import OPTIONS, SCENE
chunks.FIRST_CHUNK = chunks.MOST_CHUNK = 1
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
@sample_of(2, 20)
def test_killed_at_random_moments_it_goes_on_to_the_same_bits(count: int, tmp_path: Path) -> None:
    path = tmp_path / "map.nc"
    rng = np.random.default_rng(count)
    over = OVER | {"FN": "1:20:50"}
    script = KILLED.format(
        support=str(Path(__file__).parents[1] / "support"), path=str(path), over=over
    )
    for _ in range(count):
        moment = str(rng.integers(1, 60)), str(rng.choice([0, 0, rng.integers(0, 1000)]))
        assert (
            subprocess.run([sys.executable, "-c", script, *moment], check=False).returncode
            == -signal.SIGKILL
        )
    assert not path.exists()
    assert 0 < sweep_status(SCENE, over, **OPTIONS, path=path).done < 300
    identical(sweep(SCENE, over, **OPTIONS, path=path), sweep(SCENE, over, **OPTIONS))
    assert [path.name for path in tmp_path.iterdir()] == ["map.nc"]


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


LIMITED = """
import resource, sys
sys.path[:0] = [{support!r}]
from small_sweeps import OPTIONS, OVER, SCENE
from symosc import OutputError, sweep
from symosc.sweeps import sweep as chunks
from symosc.sweeps.store import Store
chunks.FIRST_CHUNK = chunks.MOST_CHUNK = 5
sys.dont_write_bytecode = True  # CPython keeps what it could write of a module
resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
try:
    sweep(SCENE, OVER, **OPTIONS, path={path!r})
except OutputError as error:
    print(error)
"""


@pytest.mark.full(1)
@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".nc", ".zarr", ".csv"])
def test_a_disk_that_the_output_fills_keeps_all_chunks(
    whole: Any, suffix: str, tmp_path: Path
) -> None:
    """The system refuses to write files of more than 3,000 bytes.

    HDF5 ended the program with a segmentation fault.
    """
    pytest.importorskip("resource")
    path = tmp_path / f"map{suffix}"
    script = LIMITED.format(support=str(Path(__file__).parents[1] / "support"), path=str(path))
    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert (result.returncode, result.stdout) == (
        0,
        f"cannot write {brief(str(path))}: File too large\n",
    ), result.stderr
    assert not path.exists()
    assert sweep_status(SCENE, OVER, **OPTIONS, path=path) == (str(path), 24, 24, False)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)
    assert [path.name for path in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("resume", [True, False])
def test_what_is_not_ours_is_refused_and_stays(resume: bool, tmp_path: Path) -> None:
    for name in ("map.zarr", "other.nc.parts"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "thesis.tex").write_text("mine")
    (tmp_path / "file.nc").write_text("mine")
    for name in ("map.zarr", "other.nc", "file.nc"):
        with pytest.raises(
            SweepError, match=r"not the output of a sweep|not the folder of a sweep"
        ):
            sweep(SCENE, {"k": [3]}, path=tmp_path / name, resume=resume)
    theirs = sorted(
        path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()
    )
    assert theirs == ["file.nc", "map.zarr/thesis.tex", "other.nc.parts/thesis.tex"]


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".nc", ".zarr", ".csv"])
def test_a_damaged_output_is_refused_and_made_anew(whole: Any, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"map{suffix}"
    sweep(SCENE, OVER, **OPTIONS, path=path)
    if path.is_dir():
        file = path / "x" / "c" / "0" / "0"
    else:
        file = path
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)
    with pytest.raises(SweepError, match="is damaged"):
        sweep(SCENE, OVER, **OPTIONS, path=path)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path, resume=False), whole)
    identical(sweep(SCENE, OVER, **OPTIONS, path=path), whole)


@pytest.mark.parametrize("seed", range(3))
def test_each_cell_is_the_motion_that_its_coordinates_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = load_scene("fig9")
    over = {"Omega": rng.uniform(2, 6, 3), "x0": rng.normal(0, 3, 2), "mu1": rng.uniform(0, 1, 2)}
    dataset = sweep(scene, over, t_end="7/3T", record=("events", "sticks", "x"))
    for cell in np.ndindex(dataset.events.shape):
        one = dataset[dict(zip(over, cell, strict=True))]
        p = scene.parameters.replace(Omega=float(one.Omega), mu1=float(one.mu1))
        t_end = float(scene.t0) + float(7 / 3) * (2 * np.pi / float(one.Omega))
        motion = simulate(p, t0=scene.t0, x0=float(one.x0), v0=scene.v0, t_end=t_end)
        assert (len(motion.events), str(one.status.values)) == (int(one.events), motion.status)
        assert sum(event.kind == "stick" for event in motion.events) == int(one.sticks)
        assert float(one.x) == pytest.approx(float(motion(t_end)[0]), rel=1e-11, abs=1e-11)


# -- who computes ---


@pytest.mark.slow
def test_a_worker_that_dies_loses_nothing_that_is_finished(
    whole: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process of a pool is killed in the middle.

    The pool is broken, the same call goes on with another one.
    """
    in_small_chunks(monkeypatch, 4)
    path = tmp_path / "map.nc"
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:

        def kill(done: int, _: int) -> None:
            if done == 8:
                pool.submit(os._exit, 1)

        with pytest.raises(
            SweepError, match=r"a worker failed.* motions are kept in .*map\.nc\.parts"
        ):
            sweep(SCENE, OVER, **OPTIONS, path=path, executor=pool, workers=1, progress=kill)
        assert sweep_status(SCENE, OVER, **OPTIONS, path=path).done >= 8
        with pytest.raises(SweepError, match="a worker failed"):  # it stays broken
            sweep(SCENE, OVER, **OPTIONS, path=path, executor=pool)
    with ThreadPoolExecutor(2) as threads:
        identical(sweep(SCENE, OVER, **OPTIONS, path=path, executor=threads), whole)


@pytest.mark.slow
def test_a_cluster_of_which_a_worker_is_killed_loses_nothing(
    whole: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two processes of dask; one is killed after the first chunks, its work is done again."""
    distributed = pytest.importorskip("distributed")
    in_small_chunks(monkeypatch, 1)
    options: dict[str, Any] = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with (
        distributed.LocalCluster(**options, processes=True) as cluster,
        distributed.Client(cluster) as client,
    ):
        before = client.run(os.getpid)
        killed: list[int] = []

        def kill(done: int, _: int) -> None:
            if done >= 6 and not killed:
                killed.append(next(iter(before.values())))
                os.kill(killed[0], signal.SIGKILL)

        path = tmp_path / "map.nc"
        identical(sweep(SCENE, OVER, **OPTIONS, path=path, executor=client, progress=kill), whole)
        assert killed
        monkeypatch.setattr(chunks, "CONNECT_SECONDS", PATIENCE)
        with dask_client(cluster.scheduler_address) as again, again.get_executor() as executor:
            few = {"Omega": [3], "FN": [5, 10]}
            identical(
                sweep(SCENE, few, **OPTIONS, executor=executor, workers=2),
                sweep(SCENE, few, **OPTIONS),
            )


# -- the page, and a published map ---

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "sweeps.md").read_text(encoding="utf-8")
COMMANDS = [
    command
    for block in re.findall(r"^```console\n\$ symosc (.*?)\n```$", PAGE, re.M | re.S)
    for command in [block]
]
EXAMPLES = re.findall(r"^```python\n(.*?)^```$\s*prints\s*^```text\n(.*?)^```$", PAGE, re.M | re.S)
COULOMB = Parameters(m=1, c=0, k=1, A0=0, B0=1, Omega=1, v1=0, v2=1000, mu1=0, mu2=0, FN=1)
WALL = Scene("wall", COULOMB, t0=0, x0=0, v0=0, t_end=1)


def test_every_picture_is_made_by_a_command() -> None:
    pictures = re.findall(r"\]\((sweeps/[^)]+)\)", PAGE)
    assert {Path(name).name for name in pictures} <= {
        shlex.split(command)[-1] for command in COMMANDS
    }
    assert {path.name for path in (DOCS / "sweeps").iterdir()} == {
        Path(name).name for name in pictures
    }


@pytest.mark.quick(1)
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: shlex.split(command)[-1])
def test_the_commands_run(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    short = re.sub(r"(--over \w+=[^:]+:[^:]+):\d+", r"\1:3", command)
    assert short != command
    printed = good(*shlex.split(short))
    assert re.search(r" [39] motions", printed)
    assert {path.suffix for path in tmp_path.iterdir()} == (
        {".nc", ".png"} if "--plot" in command else set()
    )


@pytest.mark.slow
@pytest.mark.full(1)  # a cluster is in test_run.py too
@pytest.mark.parametrize("number", range(len(EXAMPLES)))
def test_example(number: int, tmp_path: Path) -> None:
    code, expected = EXAMPLES[number]
    if "distributed" in code:
        pytest.importorskip("distributed")
    # On a slow machine it says that a worker ends late, or misses its scheduler at the end.
    calm = os.environ | {"DASK_LOGGING__DISTRIBUTED": "critical"}
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=calm, capture_output=True, text=True
    )
    assert (result.stderr, result.stdout) == ("", expected)


def largest_friction(r: float) -> float:
    """Return F/P on the border of motions without stops for the frequency ratio r, with Coulomb friction.

    Den Hartog (Trans. ASME 53, 1931), in the form of Hong and Liu (J. Sound Vib. 229, 2000); all
    but c are 1.
    """
    V = 1 / (1 - r * r)
    U = tan(pi / (2 * r)) / r

    def S(u: float) -> float:
        return r * r * (sin(u / r) / r + U * (cos(u) - cos(u / r))) / sin(u)

    grid = np.linspace(0, pi, 402)[1:-1]
    best = grid[np.argmax([S(u) for u in grid])]
    near = minimize_scalar(
        lambda u: -S(u),
        bounds=(max(best - 0.01, 1e-6), min(best + 0.01, pi - 1e-6)),
        method="bounded",
    )
    largest = max(1.0, -near.fun)  # at both ends of (0, pi) it tends to 1 at least
    return abs(V) / sqrt(U * U + (largest / r**2) ** 2)


@pytest.mark.slow
def test_the_border_of_the_map_is_the_formulas() -> None:
    assert largest_friction(1.5) == pytest.approx(0.64657909, abs=1e-8)  # published
    assert largest_friction(0.8) == pytest.approx(0.81740639, abs=1e-8)
    over = {"Omega": "0.65:2:6", "mu1": "0.42:0.9:13"}
    dataset = sweep(WALL, over, record="sticks", t_end="61T", skip="60T")
    step = 0.04
    for ratio in dataset.Omega.values:
        stops = dataset.sticks.sel(Omega=ratio)
        free = stops.mu1.values[stops.values == 0]
        stopping = stops.mu1.values[stops.values > 0]
        border = largest_friction(ratio)
        assert free.max() < stopping.min()
        assert free.max() < border + 1e-9, ratio
        assert stopping.min() > border - 1e-9, ratio
        assert stopping.min() - free.max() < 1.5 * step
