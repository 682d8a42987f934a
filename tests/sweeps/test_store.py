"""Chunks on disk: whole or not there, of one plan, for one program at a time."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from symosc.errors import OutputError, SweepError
from symosc.sweeps.store import Store, missing


@pytest.mark.parametrize("seed", range(20))
def test_what_is_missing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 40))
    ranges = [tuple(sorted(rng.integers(0, count + 1, 2).tolist())) for _ in range(rng.integers(0, 6))]
    covered = np.zeros(count, dtype=bool)
    for begin, end in ranges:
        covered[begin:end] = True
    gaps = missing(ranges, count)
    for begin, end in gaps:
        assert begin < end
        assert not covered[begin:end].any()
        covered[begin:end] = True
    assert covered.all()


@pytest.fixture
def opened() -> Iterator[Callable[..., Store]]:
    stores: list[Store] = []

    def made(folder: Path, key: str = "k", resume: bool = True) -> Store:
        stores.append(Store(folder / "map.nc"))
        try:
            stores[-1].open(key, {"about": 1}, resume)
        except Exception:
            stores[-1].close()
            raise
        return stores[-1]

    yield made
    for store in stores:
        store.close()


def columns(begin: int, end: int) -> dict[str, Any]:
    return {"word": np.array([f"P{i}" for i in range(begin, end)]), "x": np.arange(begin, end) / 7}


def test_chunks_come_back(opened: Any, tmp_path: Path) -> None:
    store = opened(tmp_path)
    assert store.folder == tmp_path / "map.nc.parts"
    for begin, end in ((5, 9), (0, 2)):
        store.write(begin, end, columns(begin, end))
    store.close()
    again = opened(tmp_path)
    assert again.ranges() == [(0, 2), (5, 9)]
    for begin, end, found in again.chunks():
        expected = columns(begin, end)
        assert {name: column.tolist() for name, column in found.items()} == {n: c.tolist() for n, c in expected.items()}
    again.remove("another")
    assert again.ranges() == [(0, 2), (5, 9)]
    again.remove("k")
    assert list(tmp_path.iterdir()) == []


def test_chunks_of_another_plan_stay_where_they_are(opened: Any, tmp_path: Path) -> None:
    store = opened(tmp_path)
    store.write(0, 2, columns(0, 2))
    store.close()
    with pytest.raises(SweepError, match="another sweep"):
        opened(tmp_path, "another")
    assert store.ranges() == [(0, 2)]
    anew = opened(tmp_path, "another", resume=False)
    assert anew.ranges() == []
    assert anew.key() == "another"


@pytest.mark.parametrize("content", ["", "[]", "{", '{"other": 1}', "\x00"])
def test_a_folder_with_a_plan_that_cannot_be_read_is_not_touched(opened: Any, tmp_path: Path, content: str) -> None:
    store = opened(tmp_path)
    store.close()
    (store.folder / "plan.json").write_text(content)
    with pytest.raises(SweepError, match="another sweep"):
        opened(tmp_path)


def test_one_program_at_a_time(opened: Any, tmp_path: Path) -> None:
    first = opened(tmp_path)
    with pytest.raises(SweepError, match="in use"):
        opened(tmp_path)
    first.close()
    opened(tmp_path)


@pytest.mark.parametrize("seed", range(6))
def test_a_damaged_chunk_is_as_if_it_were_not_there(opened: Any, tmp_path: Path, seed: int) -> None:
    store, rng = opened(tmp_path), np.random.default_rng(seed)
    store.write(0, 50, columns(0, 50))
    store.write(50, 60, columns(50, 60))
    path = next(path for path in store.folder.iterdir() if path.name.startswith("000000000000-"))
    whole = path.read_bytes()
    place = int(rng.integers(1, len(whole)))
    path.write_bytes(whole[:place] if seed % 2 else b"")
    assert [(begin, end) for begin, end, _ in store.chunks()] == [(50, 60)]
    assert store.ranges() == [(50, 60)]


def test_a_chunk_of_another_length_is_taken_away(opened: Any, tmp_path: Path) -> None:
    store = opened(tmp_path)
    store.write(0, 3, columns(0, 2))
    assert list(store.chunks()) == []


def test_what_a_killed_program_left_of_a_file_is_taken_away(opened: Any, tmp_path: Path) -> None:
    store = opened(tmp_path)
    store.close()
    (store.folder / ".symosc-abc.npz").write_bytes(b"half")
    opened(tmp_path)
    assert sorted(path.name for path in store.folder.iterdir()) == ["lock", "plan.json"]


def test_a_full_disk_leaves_nothing_half_written(opened: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = opened(tmp_path)
    store.write(0, 2, columns(0, 2))

    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OutputError, match="No space left on device"):
        store.write(2, 4, columns(2, 4))
    assert sorted(path.name for path in store.folder.iterdir()) == [
        "000000000000-000000000002.npz",
        "lock",
        "plan.json",
    ]


def test_a_folder_that_cannot_be_made(opened: Any, tmp_path: Path) -> None:
    (tmp_path / "map.nc.parts").write_text("a file")
    with pytest.raises(OutputError, match=r"File exists|Not a directory"):
        opened(tmp_path)
