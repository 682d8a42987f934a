"""The same call returns the same bytes, whatever is compiled, however fast the machine, with any workers and chunks."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import one_result
import pytest

from symosc import simulate_many, sweep
from symosc.engine import arithmetic
from symosc.simulation import batch
from symosc.sweeps import sweep as run

pytest.importorskip("numba")
pytest.importorskip("xarray")


def program(cache: Path, *arguments: str) -> Any:
    """Return what the program prints that has this folder for compiled code, and nothing else."""
    cache.mkdir(exist_ok=True)
    command = [sys.executable, one_result.__file__, *arguments]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache)}
    return json.loads(
        subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    )


def lend(cache: Path, *functions: Any) -> None:
    """Copy what this program has compiled of functions of the engine into a cache that was used before."""
    (there,) = cache.glob("engine_*")
    for function in functions:
        for path in Path(function.stats.cache_path).glob(
            f"*.{function.py_func.__qualname__}-*.nb?"
        ):
            shutil.copy2(path, there)


@pytest.mark.compiled("pairs")
@pytest.mark.slow
def test_whatever_is_compiled_and_however_fast_the_machine_is(tmp_path: Path) -> None:
    warm = one_result.digests()
    cache = tmp_path / "cache"
    doubles = arithmetic.compiled()["follow_all"]
    loops = arithmetic.compiled_pairs()
    for clock in ("standing", "rushing"):
        assert program(cache, clock) == {"digests": warm, "loaded": [False, False]}, clock
    lend(cache, doubles)
    assert program(cache, "usual") == {"digests": warm, "loaded": [True, False]}
    for path in cache.rglob("*.nb?"):
        path.unlink()
    lend(cache, *loops)
    assert program(cache, "usual") == {"digests": warm, "loaded": [False, True]}


@pytest.mark.compiled("pairs")
@pytest.mark.slow
def test_any_number_of_workers_and_chunks_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = one_result.digests()
    for threads, motions, first in ((1, 1, 1), (2, 7, 3), (3, 2, 48), (3, 1024, 128)):
        monkeypatch.setattr(batch, "MOST_IN_CHUNK", motions)
        monkeypatch.setattr(run, "FIRST_CHUNK", first)
        monkeypatch.setattr(run, "CHUNK_SECONDS", 1e-3 * motions)
        assert one_result.digests(threads) == whole, (threads, motions, first)


@pytest.mark.compiled("pairs")
@pytest.mark.slow
def test_a_sweep_that_is_stopped_cold_and_resumed_warm(tmp_path: Path) -> None:
    arithmetic.compiled_pairs()
    broken = tmp_path / "broken.csv"
    whole = tmp_path / "whole.csv"
    assert program(tmp_path / "cache", "usual", str(broken)) == {"done": 5}
    assert not broken.exists()
    simulate_many(*one_result.motions()[0][1:4])  # so that compiled code is loaded
    resumed: list[int] = []
    sweep("fig9", **one_result.SWEEP, path=broken, progress=lambda done, _: resumed.append(done))
    assert resumed[0] >= 5
    sweep("fig9", **one_result.SWEEP, path=whole)
    assert broken.read_bytes() == whole.read_bytes()
