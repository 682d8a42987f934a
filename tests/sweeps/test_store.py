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


@pytest.mark.parametrize("seed", range(5))
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


KEY, OTHER_KEY = 64 * "a", 64 * "b"
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


def test_chunks_come_back(opened: Any, tmp_path: Path) -> None:
    store = opened(tmp_path)
    assert store.folder == tmp_path / "map.nc.parts"
    for begin, end in ((5, 9), (0, 2)):
        store.write(begin, end, columns(begin, end))
    store.close()
    again = opened(tmp_path)
    assert again.ranges() == [(0, 2), (5, 9)]
    for begin, end, found in again.chunks(NAMES):
        expected = columns(begin, end)
        assert {name: column.tolist() for name, column in found.items()} == {n: c.tolist() for n, c in expected.items()}
    again.remove(OTHER_KEY)
    assert again.ranges() == [(0, 2), (5, 9)]
    again.remove(KEY)
    assert list(tmp_path.iterdir()) == []


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


@pytest.mark.parametrize("content", ["", "[]", "{", '{"other": 1}', "\x00"])
def test_a_folder_with_a_plan_that_cannot_be_read_is_not_touched(opened: Any, tmp_path: Path, content: str) -> None:
    store = opened(tmp_path)
    store.close()
    (store.folder / "plan.json").write_text(content)
    for resume in (True, False):
        with pytest.raises(SweepError, match="no folder of a sweep"):
            opened(tmp_path, resume=resume)
    assert (store.folder / "plan.json").read_text() == content


@pytest.mark.parametrize("name", ["notes.txt", "plan.json", "lock.txt", "000000000000-1.npz", "sub/whole.nc"])
def test_a_folder_of_somebody_else_is_not_touched(opened: Any, tmp_path: Path, name: str) -> None:
    theirs = tmp_path / "map.nc.parts" / name
    theirs.parent.mkdir(parents=True)
    theirs.write_text("[1]")
    for resume in (True, False):
        with pytest.raises(SweepError, match="no folder of a sweep"):
            opened(tmp_path, resume=resume)
    assert [path for path in (tmp_path / "map.nc.parts").rglob("*") if path.is_file()] == [theirs]


def test_a_file_of_somebody_else_among_the_chunks_stays(opened: Any, tmp_path: Path) -> None:
    store = opened(tmp_path)
    store.write(0, 2, columns(0, 2))
    store.close()
    theirs = store.folder / "notes.txt"
    theirs.write_text("mine")
    opened(tmp_path, OTHER_KEY, resume=False).remove(OTHER_KEY)
    assert [*store.folder.iterdir()] == [theirs]


def test_one_program_at_a_time(opened: Any, tmp_path: Path) -> None:
    first = opened(tmp_path)
    with pytest.raises(SweepError, match="in use"):
        opened(tmp_path)
    first.close()
    opened(tmp_path)


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
