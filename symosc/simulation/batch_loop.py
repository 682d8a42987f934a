"""How a batch is followed in doubles: by the compiled loop, or interpreted while that is less work than compiling."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from symosc.engine import batch as engine_batch
from symosc.engine import first_rows, summary
from symosc.engine.arithmetic import compiled, is_compiled
from symosc.engine.batch import Batch, EventRows, copied, room_for, rows_between
from symosc.engine.constant_table import ConstantRows
from symosc.engine.summary import Tally
from symosc.errors import MissingExtraError, ParameterError

# Events after which a loop gives its rows back, and can be interrupted: a tenth of a second.
# A little more than a power of 2: else all columns would have the same places in the processor's cache.
CAPACITY = (1 << 18) + 72
# Events after which the interpreted loop asks whether to go on.
TURN = 2048


@dataclass
class InterpretBudget:
    """How many events a program still interprets before it compiles a loop: as many as take about as long as that.

    Interpreted and compiled loops give the same bits: only the time depends on it.
    """

    events: int


DOUBLES, PAIRS = InterpretBudget(250_000), InterpretBudget(25_000)

Follow = Callable[[int, Batch, int, float, EventRows, Tally, np.ndarray], tuple[int, int]]


class Loops(NamedTuple):
    """What motions are begun, followed and finished with, compiled or not; each takes constants as a table."""

    follow: Follow
    first_rows: Callable[..., None]
    march_rows: Callable[..., None]
    settle: Callable[..., None]

    @property
    def in_threads(self) -> bool:
        """Whether several threads are faster than one."""
        return self.follow is not interpreted


def interpreted(
    begin: int, batch: Batch, most: int, accuracy: float, out: EventRows, tally: Tally, table: np.ndarray
) -> tuple[int, int]:
    """Do what `symosc.engine.batch.follow_all` does, in CPython."""
    return engine_batch.follow_all(begin, batch, most, accuracy, out, tally, ConstantRows(table))


def _first_rows(table: np.ndarray, sets: np.ndarray, states: np.ndarray) -> None:
    first_rows.first_rows(ConstantRows(table), sets, states)


def _march_rows(table: np.ndarray, out: np.ndarray) -> None:
    first_rows.march_rows(ConstantRows(table), out)


def _settle(tally: Tally, sets: np.ndarray, table: np.ndarray, sections: np.ndarray, repeats: np.ndarray) -> None:
    summary.settle(tally, sets, ConstantRows(table), sections, repeats)


class PatientLoop:
    """The event loop, interpreted until DOUBLES is spent, unless it was compiled before; compiled from then on.

    Parameters
    ----------
    compiled_one : callable
        numba's function, which is compiled when it is first called.
    """

    def __init__(self, compiled_one: Follow) -> None:
        self._compiled = compiled_one

    def __call__(
        self, begin: int, batch: Batch, most: int, accuracy: float, out: EventRows, tally: Tally, table: np.ndarray
    ) -> tuple[int, int]:
        """Do what `symosc.engine.batch.follow_all` does, perhaps in turns of fewer rows."""
        if DOUBLES.events <= 0 or is_compiled(self._compiled):
            return self._compiled(begin, batch, most, accuracy, out, tally, table)
        one, some = Batch(*(column[: begin + 1] for column in batch)), rows_between(out, 0, TURN)
        begin, filled = interpreted(begin, one, most, accuracy, some, tally, table)
        DOUBLES.events -= max(filled, 1)
        return begin, filled


def chosen_loops(use_numba: Any) -> Loops:
    """Return the loops that are asked for: compiled (True), interpreted (False), or what is there (None)."""
    if use_numba is not None and not isinstance(use_numba, (bool, np.bool_)):
        raise ParameterError("use_numba", use_numba, "must be True, False or None")
    plain = Loops(interpreted, _first_rows, _march_rows, _settle)
    if use_numba is not None and not use_numba:
        return plain
    try:
        functions = compiled()
    except MissingExtraError:
        if use_numba:
            raise
        return plain
    ready = Loops(*(functions[name] for name in ("follow_all", "first_rows", "march_rows", "settle")))
    if use_numba:
        return ready
    there = {name: function for name, function in ready._asdict().items() if is_compiled(function)}
    return plain._replace(**{"follow": PatientLoop(ready.follow)} | there)


class Rooms:
    """Room for events, kept from one call to the next: memory that is new to a process is slow.

    Parameters
    ----------
    most : int
        Rooms that are kept at most, of 18 MB each.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._kept: list[EventRows] = []

    @contextmanager
    def lent(self) -> Iterator[Callable[[], EventRows]]:
        """Lend what makes room that nobody else uses meanwhile."""
        lent: list[EventRows] = []

        def room() -> EventRows:
            try:  # another thread may have taken the last one
                lent.append(self._kept.pop())
            except IndexError:
                lent.append(room_for(CAPACITY))
            return lent[-1]

        yield room
        for each in lent:  # one by one: what another thread has taken meanwhile is not to come back
            if len(self._kept) < self._most:
                self._kept.append(each)


ROOMS = Rooms(2)


class Course(NamedTuple):
    """What motions are followed into and how far: room, tally, events per motion, accuracy, and their constants."""

    room: EventRows
    tally: Tally
    most: int
    accuracy: float
    table: np.ndarray


def followed(follow: Follow, batch: Batch, into: Course) -> Iterator[EventRows]:
    """Follow a batch to its end; yield the rows of its events, copied out of the room that is used again."""
    begin = 0
    while begin < len(batch.states):
        begin, filled = follow(begin, batch, into.most, into.accuracy, into.room, into.tally, into.table)
        filled = 0 if len(into.tally.floats) else filled
        yield EventRows(*(copied(columns[:, :filled]) for columns in into.room))


def joined(parts: Iterable[EventRows]) -> EventRows:
    """Return rows in one piece."""
    rows = list(parts)
    if not rows:
        return room_for(0)
    return rows[0] if len(rows) == 1 else EventRows(*(np.concatenate(each, axis=1) for each in zip(*rows, strict=True)))
