"""Many motions beyond doubles: those in doubt are followed in double-double numbers, which numba compiles.

The rule is that of `symosc.simulation.simulate.in_doubles`: up to an event that doubles leave open, or do not know well
enough, the motion is followed with more digits from its exact start, and doubles go on from there. Here that is done
for all such motions of a parameter set in turns, double-double numbers for all, then doubles for all. A double keeps
16 digits of a state only; so where doubles are in doubt the longer numbers go on from their own last state, and not
from one of doubles.

What double-double numbers leave open, too, is left to single motions with more digits. So the results are those of
`simulate`, to the last bit: rounded to doubles, numbers of 30 and of 36 digits are the same unless the former are in
doubt (`symosc.engine.rounding`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from math import isinf
from typing import NamedTuple

import numpy as np

from symosc.engine import compiled_loop
from symosc.engine.arithmetic import Arithmetic, many_digits
from symosc.engine.compiled_loop import STATE_WIDTH, Batch, EventRows, batch_of, room_for, row_of
from symosc.engine.start import Start, first_state, settles
from symosc.engine.state import DOUBTFUL, IN_DOUBT, RUNNING, Number
from symosc.model import Parameters
from symosc.simulation.batch_loop import PAIRS, Follow, followed, joined
from symosc.simulation.run import last_time
from symosc.simulation.simulate import attainable, in_doubles
from symosc.simulation.trajectory import Trajectory

# Digits between a start and a belt, or of its error, that double-double numbers have to spare.
PAIR_SPARE = 8


class Climb(NamedTuple):
    """What became of motions that doubles left open.

    Attributes
    ----------
    batch : Batch
        The last states in doubles, the events, and what each motion ended with: IN_DOUBT if it needs more digits.
    rows : list of EventRows
        Events, those of a motion in order of time.
    """

    batch: Batch
    rows: list[EventRows]


class Ladder:
    """Many motions, followed in doubles, and in double-double numbers where those are in doubt.

    Parameters
    ----------
    problems : sequence of Start
    follow : callable
        The event loop for doubles; without the compiled one there are no double-double numbers either.
    most : int
        Events per motion.
    accuracy : float

    Attributes
    ----------
    batch : Batch
        What became of the motions; those that ended in doubt need still more digits.
    rows : list of EventRows
        Events, those of a motion in order of time.
    mixed : bool
        Whether the rows are not in order of the motions.
    looks : dict
        Motions that were followed alone, by number.
    """

    def __init__(self, problems: Sequence[Start], follow: Follow, most: int, accuracy: float) -> None:
        self._problems, self._follow, self._most, self._accuracy = problems, follow, most, accuracy
        self.batch, self.rows = batch_of(np.zeros((len(problems), STATE_WIDTH))), list[EventRows]()
        self.looks: dict[int, Trajectory] = {}
        groups = self._groups(range(len(problems)))
        for p, members in groups.items():
            arithmetic = Arithmetic(p)
            batch = batch_of(np.array([_row(problems[i], arithmetic) for i in members]))
            self._add(Climb(batch, list(self._in_doubles(p, batch))), members)
        in_doubt = np.flatnonzero(np.isin(self.batch.codes, DOUBTFUL)).tolist()
        self.mixed = len(groups) > 1 or len(in_doubt) > 0
        if in_doubt and follow is not compiled_loop.follow_all:
            self.looks = looks_before_compiling(in_doubt, problems, most, accuracy)
            self._climb([i for i in in_doubt if i not in self.looks and fits(problems[i])])

    def _groups(self, members: Iterable[int]) -> dict[Parameters, list[int]]:
        groups: dict[Parameters, list[int]] = {}
        for i in members:
            groups.setdefault(self._problems[i].parameters, []).append(i)
        return groups

    def _in_doubles(self, p: Parameters, batch: Batch) -> Iterator[EventRows]:
        K, needed = Arithmetic(p).K, attainable(self._accuracy, self._problems[0])
        K = K._replace(sigmas=0.0) if isinf(self._accuracy) else K
        return followed(self._follow, batch, self._most, needed, K)

    def _climb(self, members: list[int]) -> None:
        self.rows = [_without(rows, members) for rows in self.rows]
        for p, some in self._groups(members).items():
            below = Batch(*(column[some] for column in self.batch))
            self._add(climb([self._problems[i] for i in some], below, partial(self._in_doubles, p)), some)

    def _add(self, found: Climb, members: list[int]) -> None:
        """Put in what became of some motions, which were numbered from 0."""
        if len(members) < len(self._problems):
            for rows in found.rows:
                rows.ints[:, 0] = np.asarray(members)[rows.ints[:, 0]]
        self.rows += found.rows
        for column, own in zip(self.batch, found.batch, strict=True):
            column[members] = own


def _without(rows: EventRows, members: list[int]) -> EventRows:
    kept = ~np.isin(rows.ints[:, 0], members)
    return EventRows(rows.floats[kept], rows.ints[kept])


def fits(start: Start) -> bool:
    """Return whether double-double numbers can follow a motion as many digits would."""
    still = start.parameters.B0 == 0 and settles(start)
    return start.start_error is None and start.spare_digits <= PAIR_SPARE and not still


def climb(problems: Sequence[Start], below: Batch, go_on: Callable[[Batch], Iterator[EventRows]]) -> Climb:
    """Follow motions of one parameter set that doubles left open.

    Parameters
    ----------
    problems : sequence of n Start
    below : Batch
        What doubles made of them.
    go_on : callable
        Goes on in doubles with a batch, which it updates, and yields the rows of its events.
    """
    from symosc.engine.pairs import ROUNDED_FROM, as_complex, follow_pairs, pair_constants

    parameters = problems[0].parameters
    follow, K, arithmetic = follow_pairs(), pair_constants(parameters), many_digits(parameters, ROUNDED_FROM)
    pairs = np.array([as_complex(tuple(_row(problem, arithmetic))) for problem in problems])
    batch, rows = batch_of(below.states.copy()), list[EventRows]()
    wanted = below.counts + (below.codes == IN_DOUBT)
    active = np.arange(len(problems))
    while len(active):
        room = room_for(int((wanted - batch.counts)[active].sum()))
        filled = follow(active, wanted, pairs, batch, room, K)
        rows.append(EventRows(room.floats[:filled], room.ints[:filled]))
        active = active[batch.codes[active] == RUNNING]
        if len(active):
            further = Batch(*(column[active] for column in batch))
            events = joined(go_on(further))
            doubtful = np.isin(further.codes, DOUBTFUL)
            kept = ~doubtful[events.ints[:, 0]]
            events.ints[:, 0] = active[events.ints[:, 0]]
            rows.append(EventRows(events.floats[kept], events.ints[kept]))
            wanted[active] = further.counts + (further.codes == IN_DOUBT)
            done = active[~doubtful]
            for column, own in zip(batch, further, strict=True):
                column[done] = own[~doubtful]
            active = active[doubtful]
    return Climb(batch, rows)


def _row(start: Start, arithmetic: Arithmetic) -> list[Number]:
    return row_of(first_state(start, arithmetic), *last_time(start, arithmetic))


def looks_before_compiling(
    open_ones: Sequence[int], problems: Sequence[Start], most: int, accuracy: float
) -> dict[int, Trajectory]:
    """Follow motions one by one for as long as it would take to compile, unless that was done before."""
    from symosc.engine.pairs import is_compiled

    looks: dict[int, Trajectory] = {}
    if is_compiled():
        return looks
    for i in open_ones:
        if PAIRS.left <= 0:
            break
        with PAIRS.used():
            looks[i] = in_doubles(problems[i], most, accuracy)
    return looks
