"""Chunks on disk: whole or not there, of one plan, for one program at a time."""

from __future__ import annotations

import errno
import os
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from symosc.base.errors import OutputError, SweepError
from symosc.sweeps.store import Store

KEY = 64 * "a"
OTHER_KEY = 64 * "b"
NAMES = ("word", "x")


@pytest.fixture
def opened() -> Iterator[Callable[..., Store]]:
    stores: list[Store] = []

    def made(folder: Path, key: str = KEY, resume: bool = True) -> Store:
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


def test_chunks_of_another_plan_stay_where_they_are(opened: Any, tmp_path: Path) -> None:
    store = opened(tmp_path)
    store.write(0, 2, columns(0, 2))
    store.close()
    with pytest.raises(SweepError, match="another sweep"):
        opened(tmp_path, OTHER_KEY)
    assert store.ranges() == [(0, 2)]
    anew = opened(tmp_path, OTHER_KEY, resume=False)
    assert anew.ranges() == []
    assert anew.key() == OTHER_KEY


def test_a_folder_is_for_one_at_a_time(opened: Any, tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    first = opened(tmp_path)
    second = Store(tmp_path / "map.nc")
    first.write(0, 2, columns(0, 2))
    with warnings.catch_warnings():
        warnings.simplefilter("error", ResourceWarning)
        with pytest.raises(SweepError, match="is in use"):
            second.open(KEY, {"about": 1}, False)
        assert second._lock is None  # the file is closed
    assert first.ranges() == [(0, 2)]
    first.close()
    assert opened(tmp_path).ranges() == [(0, 2)]


def test_a_chunk_of_another_form_is_taken_away(opened: Any, tmp_path: Path) -> None:
    """Of another length, without a column, of another range or plan, or one that somebody made with numpy."""
    store = opened(tmp_path)
    store.write(0, 3, columns(0, 2))
    store.write(3, 5, {"x": np.zeros(2)})
    store.write(5, 7, columns(5, 7))
    chunk = store.folder / "000000000005-000000000007.npz"
    (store.folder / "000000000007-000000000009.npz").write_bytes(chunk.read_bytes())
    np.savez(store.folder / "000000000009-000000000010.npz", **columns(9, 10))
    assert [begin for begin, _, _ in store.chunks(NAMES)] == [5]
    assert store.ranges() == [(5, 7)]
    content = chunk.read_bytes()
    store.close()
    other = opened(tmp_path, OTHER_KEY, resume=False)
    chunk.write_bytes(content)
    assert list(other.chunks(NAMES)) == []


def test_no_damaged_chunk_is_read(opened: Any, tmp_path: Path) -> None:
    """Whichever bit is flipped, and wherever the file ends; the others are read."""
    store = opened(tmp_path)
    store.write(0, 2, columns(0, 2))
    (path,) = store.folder.glob("*.npz")
    whole = path.read_bytes()
    for place in range(len(whole)):
        flipped = whole[:place] + bytes([whole[place] ^ 1 << place % 8]) + whole[place + 1 :]
        for content in (flipped, whole[:place]) if place % 50 == 0 else (flipped,):
            path.write_bytes(content)
            assert list(store.chunks(NAMES)) == [], place
    store.write(5, 9, columns(5, 9))
    path.write_bytes(whole[:-1])
    assert [begin for begin, _, _ in store.chunks(NAMES)] == [5]
    assert store.ranges() == [(5, 9)]
    path.write_bytes(whole)
    assert [begin for begin, _, _ in store.chunks(NAMES)] == [0, 5]


def test_a_full_disk_leaves_nothing_half_written(
    opened: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = opened(tmp_path)
    store.write(0, 2, columns(0, 2))

    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OutputError, match="No space left on device"):
        store.write(2, 4, columns(2, 4))
    assert sorted(path.name for path in store.folder.iterdir()) == [
        "000000000000-000000000002.npz",
        "lock",
        "plan.json",
    ]
