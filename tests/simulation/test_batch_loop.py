"""Room for the events of a batch, which calls lend each other."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from symosc.engine.batch import EventRows
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


class Raided(list[EventRows]):
    """Kept rooms of which another thread takes one while somebody looks at them all."""

    def __init__(self, kept: list[EventRows]) -> None:
        super().__init__(kept)
        self.taken: list[EventRows] = []

    def __iter__(self) -> Iterator[EventRows]:
        there = iter(self[:])
        self.taken.append(self.pop())
        return there


def test_room_that_another_thread_has_taken_does_not_come_back() -> None:
    rooms = Rooms(3)
    with rooms.lent() as room:
        first, second = room(), room()
    raided = Raided(rooms._kept)
    assert len(raided) == 2
    rooms._kept = raided
    with rooms.lent() as room:
        room()
    kept = rooms._kept[:]
    assert len(kept) + len(raided.taken) == 2
    assert all(each.floats is not gone.floats for each in kept for gone in raided.taken)
    assert {id(each.floats) for each in (*kept, *raided.taken)} == {id(first.floats), id(second.floats)}
