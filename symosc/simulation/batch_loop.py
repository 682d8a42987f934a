"""How a batch is followed in doubles: by the compiled loop, or interpreted while that is less work than compiling."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from time import process_time
from typing import Any

import numpy as np

from symosc.engine import compiled_loop
from symosc.engine.arithmetic import compiled
from symosc.engine.binding import is_compiled
from symosc.engine.compiled_loop import Batch, EventRows, room_for
from symosc.engine.flow import Constants
from symosc.errors import MissingExtraError, ParameterError

CAPACITY = 1 << 18
# Events after which the interpreted loop looks at the clock.
TURN = 2048


class Patience:
    """How long a program goes on without a compiler: as long as compiling would take, all its calls together.

    Attributes
    ----------
    left : float
        Seconds of processor time.
    """

    def __init__(self, left: float) -> None:
        self.left = left

    @contextmanager
    def used(self) -> Iterator[None]:
        """Count the time that is spent inside."""
        since = process_time()
        yield
        self.left -= process_time() - since


DOUBLES, PAIRS = Patience(15.0), Patience(30.0)

Follow = Callable[[int, Batch, int, float, EventRows, Constants], tuple[int, int]]


class PatientLoop:
    """The event loop, interpreted until it has taken as long as compiling would take, and compiled from then on.

    Both give the same numbers. A batch that needs less than that is done before a compiler would be.

    Parameters
    ----------
    compiled_one : callable
        numba's function, which is compiled when it is first called.
    """

    def __init__(self, compiled_one: Follow) -> None:
        self._compiled = compiled_one

    def __call__(
        self, begin: int, batch: Batch, most: int, accuracy: float, out: EventRows, K: Constants
    ) -> tuple[int, int]:
        """Do what `symosc.engine.compiled_loop.follow_all` does, perhaps in turns of fewer rows."""
        if DOUBLES.left <= 0 or is_compiled(self._compiled):
            return self._compiled(begin, batch, most, accuracy, out, K)
        one, some = Batch(*(column[: begin + 1] for column in batch)), EventRows(*(rows[:TURN] for rows in out))
        with DOUBLES.used():
            return compiled_loop.follow_all(begin, one, most, accuracy, some, K)


def chosen_loop(use_numba: Any) -> Follow:
    """Return the event loop that is asked for: compiled (True), interpreted (False), or what is there (None)."""
    if use_numba is not None and not isinstance(use_numba, (bool, np.bool_)):
        raise ParameterError("use_numba", use_numba, "must be True, False or None")
    if use_numba is not None and not use_numba:
        return compiled_loop.follow_all
    try:
        compiled_one: Follow = compiled()["follow_all"]
    except MissingExtraError:
        if use_numba:
            raise
        return compiled_loop.follow_all
    return compiled_one if use_numba else PatientLoop(compiled_one)


def followed(follow: Follow, batch: Batch, most: int, accuracy: float, K: Constants) -> Iterator[EventRows]:
    """Follow a batch to its end; yield the rows of its events."""
    begin = 0
    while begin < len(batch.states):
        room = room_for(CAPACITY)
        begin, filled = follow(begin, batch, most, accuracy, room, K)
        rows = EventRows(room.floats[:filled], room.ints[:filled])
        yield rows if 2 * filled > CAPACITY else EventRows(*(column.copy() for column in rows))


def joined(parts: Iterable[EventRows]) -> EventRows:
    """Return rows in one piece."""
    rows = list(parts)
    return rows[0] if len(rows) == 1 else EventRows(*(np.concatenate(each) for each in zip(*rows, strict=True)))
