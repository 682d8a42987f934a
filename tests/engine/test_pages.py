"""Room for large arrays: like numpy's own, but from the beginning of a large page on."""

from __future__ import annotations

import numpy as np
import pytest

from symosc.engine.pages import PAGE, copied, joined_in_room, room_of


@pytest.mark.parametrize("dtype", [np.float64, np.int32])
@pytest.mark.parametrize("shape", [(0,), (6, 0), (6, 1), (7, 1000), (5, PAGE // 8 + 3), (PAGE,)], ids=str)
def test_room_is_an_array_of_its_own(shape: tuple[int, ...], dtype: type) -> None:
    room = room_of(shape, dtype)
    assert room.shape == shape
    assert room.dtype == dtype
    assert room.flags.c_contiguous
    assert room.flags.aligned
    assert room.flags.writeable
    room[...] = 7
    assert np.all(room == 7)


def test_large_room_begins_at_a_page() -> None:
    for size in (PAGE // 8, PAGE // 8 + 1, PAGE):
        assert room_of((size,)).__array_interface__["data"][0] % PAGE == 0


def test_copies_are_right_and_share_nothing() -> None:
    columns = np.arange(12.0).reshape(3, 4)
    copy = copied(columns[:, :2])
    assert copy.tolist() == [[0, 1], [4, 5], [8, 9]]
    assert not np.shares_memory(copy, columns)
    for pieces in ([columns[0]], [columns[0], columns[2, :3]], [columns[0, ::2]]):
        joined = joined_in_room(pieces)
        assert joined.tolist() == np.concatenate(pieces).tolist()
        assert joined.flags.c_contiguous
