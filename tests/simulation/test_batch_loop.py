"""Room for the events of a batch, which calls lend each other."""

from __future__ import annotations

import pytest

from symosc.simulation.batch_loop import Rooms


def test_room_is_lent_to_one_at_a_time_and_kept() -> None:
    rooms = Rooms(2)
    with rooms.lent() as room:
        first = room()
        with rooms.lent() as others:
            second = others()
            assert second.floats is not first.floats
        assert room().floats is second.floats
    with rooms.lent() as room:
        given = [room().floats for _ in range(3)]
    assert any(given[0] is each.floats for each in (first, second))
    assert given[2] is not first.floats
    assert given[2] is not second.floats


def test_room_of_a_call_that_failed_is_not_lent_again() -> None:
    rooms, lost = Rooms(2), list[object]()

    def fail() -> None:
        with rooms.lent() as room:
            lost.append(room().floats)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    with rooms.lent() as room:
        assert room().floats is not lost[0]
