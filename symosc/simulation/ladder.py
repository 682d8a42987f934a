"""Many motions beyond doubles: those in doubt are followed in double-double numbers where numba is installed.

The rule is that of `symosc.simulation.simulate.in_doubles`: up to an event that doubles leave open, or do not know well
enough, the motion is followed with more digits from its exact start, and doubles go on from there. Here that is done
for all such motions of a parameter set in turns, double-double numbers for all, then doubles for all. A double keeps
16 digits of a state only; so where doubles are in doubt the longer numbers go on from their own last state, and not
from one of doubles.

Double-double numbers let doubles search for the events, and go on where doubles would soon be in doubt again
(`symosc.engine.batch`). What they leave open, too, is left to single motions with more digits. So which arithmetic
follows a motion depends on the motion alone. Whether the loop of pairs is compiled or interpreted makes no difference
to the numbers. Events are those of `simulate`: rounded to doubles, numbers of 30 and of 36 digits are the same unless
the former are in doubt (`symosc.engine.batch`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import isinf
from typing import Any, NamedTuple

import numpy as np

from symosc.engine.arithmetic import (
    ROUNDED_FROM,
    Going,
    PairLoops,
    as_complex,
    compiled_pairs,
    interpreted_pairs,
    many_digits,
    pair_constants,
    pair_phase,
    pairs_are_compiled,
)
from symosc.engine.batch import Batch, EventRows, batch_of, room_for, row_of, rows_between
from symosc.engine.flow import SIGMAS
from symosc.engine.start import Start, first_state, settles
from symosc.engine.state import IN_DOUBT, INEXACT, RUNNING
from symosc.engine.summary import Tally, no_tally, put_back, some_of
from symosc.model import Parameters
from symosc.simulation.batch_loop import PAIRS, Course, Loops, followed, joined
from symosc.simulation.problems import FEW, Problems
from symosc.simulation.run import last_time
from symosc.simulation.simulate import attainable
from symosc.simulation.workers import Patrol

# Digits between a start and a belt, or of its error, that double-double numbers have to spare; and a gap of fewer.
PAIR_SPARE = 8
FAR_OFF = 2e-8
# Events that a motion is followed farther at once, at most, if doubles would leave it open again.
MOST_MORE = 64
# Motions that are followed in interpreted pairs until it is asked again whether to compile.
TOGETHER = 8


class Limits(NamedTuple):
    """How far motions are followed: events per motion, and the accuracy that is asked of each."""

    most: int
    accuracy: float


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
    problems : Problems
    rows : slice
        Which of them; here they are numbered from 0.
    loops : Loops
        Without numba there are no double-double numbers either.
    limits : Limits
    room : EventRows
        Used while the motions are followed.
    patrol : Patrol
        Asked whether to go on whenever the room is full.
    keep : callable, optional
        Returns the tally of motions, given their numbers and their rows at the start: then no events are recorded.

    Attributes
    ----------
    batch : Batch
        What became of the motions; those that ended in doubt need still more digits.
    rows : list of EventRows
        Events in order of motion and time, as doubles have them.
    climbed : dict
        The events of motions that were followed in double-double numbers, by number.
    """

    def __init__(
        self,
        problems: Problems,
        rows: slice,
        loops: Loops,
        limits: Limits,
        room: EventRows,
        patrol: Patrol,
        keep: Callable[[Any, np.ndarray], Tally] | None = None,
    ) -> None:
        self._problems, self._first, self.limits = problems, rows.start, limits
        self._follow, self._patrol = loops.follow, patrol
        self.batch, table = problems.begin(rows, loops.first_rows, loops.march_rows)
        begun_at = self.batch.states[:, 1].copy()
        if isinf(limits.accuracy):
            table["sigmas"] = 0.0
        self.table, self.tally = table, keep(rows, self.batch.states) if keep else no_tally()
        needed = attainable(limits.accuracy, problems.start_error)
        self._into = Course(room, self.tally, limits.most, needed, table)
        self._keep, self._starts = keep, self.batch.states.copy() if keep else self.batch.states
        self.rows = list(self._in_doubles(self.batch, self.tally))
        self.climbed = dict[int, EventRows]()
        in_doubt = np.flatnonzero(is_doubtful(self.batch.codes)).tolist()
        self._begin_again(in_doubt)
        if in_doubt and loops.in_threads:
            self._climb(self._fitting(in_doubt, begun_at), begun_at)
        self._begin_again(np.flatnonzero(is_doubtful(self.batch.codes)).tolist())

    def problem(self, i: int) -> Start:
        """Return a motion's problem by its number here."""
        found: Start = self._problems[self._first + i]
        return found

    def _begin_again(self, members: list[int]) -> None:
        """Take back what was counted of some motions."""
        if self._keep and members:
            motions = self._first + np.array(members)
            put_back(self.tally, members, self._keep(motions, self._starts[members]))

    def _in_doubles(self, batch: Batch, tally: Tally) -> Iterator[EventRows]:
        for rows in followed(self._follow, batch, self._into._replace(tally=tally)):
            self._patrol.check()
            yield rows

    def _fitting(self, members: list[int], at: np.ndarray) -> list[int]:
        """Return the motions that double-double numbers can follow, of those given; see `fits`."""
        if len(members) <= FEW:
            return [i for i in members if fits(self.problem(i))]
        plain = self._problems.are_apart(self._first + np.array(members, np.int64), at[members], FAR_OFF)
        return [i for i, is_plain in zip(members, plain.tolist(), strict=True) if is_plain or fits(self.problem(i))]

    def _climb(self, members: list[int], at: np.ndarray) -> None:
        sets: dict[int, list[int]] = {}
        for i, number in zip(members, self.batch.sets[members].tolist(), strict=True):
            sets.setdefault(number, []).append(i)
        groups: dict[Parameters, list[int]] = {}
        for some in sets.values():
            groups.setdefault(self._problems.sets[self._first + some[0]], []).extend(some)
        for parameters, some in groups.items():
            below = Motions(Batch(*(column[some] for column in self.batch)), some_of(self.tally, some), self.table)
            found = climb(parameters, self._pairs(parameters, some, at[some]), below, self.limits, self._in_doubles)
            events = joined(found.rows)
            order = np.argsort(events.ints[0], kind="stable")
            events = EventRows(*(columns[:, order] for columns in events))
            cuts = np.searchsorted(events.ints[0], np.arange(len(some) + 1)).tolist()
            events.ints[0] = np.array(some)[events.ints[0]]
            for i, begin, end in zip(some, cuts[:-1], cuts[1:], strict=True):
                self.climbed[i] = rows_between(events, begin, end)
            for column, values in zip(self.batch, found.batch, strict=True):
                column[some] = values
            put_back(self.tally, some, below.tally)

    def _pairs(self, parameters: Parameters, members: list[int], at: np.ndarray) -> np.ndarray:
        """Return the first states of motions of one parameter set, as complex numbers that stand for pairs."""
        numbers, times = self._first + np.array(members, np.int64), self.batch.states[members, 13:15]
        pairs = self._problems.pair_rows(numbers, at, times, partial(pair_phase, parameters))
        pair_loops(len(pairs)).first_pairs(pairs, pair_constants(parameters))
        for i in np.flatnonzero(pairs[:, 0] == 0.0).tolist():
            start, arithmetic = self.problem(members[i]), many_digits(parameters, ROUNDED_FROM)
            pairs[i] = as_complex(tuple(row_of(first_state(start, arithmetic), *last_time(start, arithmetic))))
        return pairs


def is_doubtful(codes: np.ndarray) -> np.ndarray:
    """Return which motions ended in doubt (`symosc.engine.state.DOUBTFUL`)."""
    doubtful: np.ndarray = (codes == IN_DOUBT) | (codes == INEXACT)
    return doubtful


def spliced(parts: Sequence[EventRows], again: dict[int, EventRows]) -> list[EventRows]:
    """Return rows in order of motion and time, with those in `again` in place of the ones that these motions have.

    The parts are cut, not copied.
    """
    members, pieces = np.array(sorted(again), np.int64), list(again.values())
    for part in parts:
        begins, ends = (np.searchsorted(part.ints[0], members, side) for side in ("left", "right"))
        gaps = zip([0, *ends], [*begins, part.ints.shape[1]], strict=True)
        pieces += [rows_between(part, begin, end) for begin, end in gaps]
    return sorted((piece for piece in pieces if piece.ints.shape[1]), key=lambda piece: int(piece.ints[0, 0]))


def fits(start: Start) -> bool:
    """Return whether double-double numbers can follow a motion as many digits would."""
    still = start.parameters.B0 == 0 and settles(start)
    return start.start_error is None and start.spare_digits <= PAIR_SPARE and not still


class Motions(NamedTuple):
    """Motions with what is kept of them, and the constants of their parameter sets."""

    batch: Batch
    tally: Tally
    table: np.ndarray


def climb(
    parameters: Parameters,
    pairs: np.ndarray,
    below: Motions,
    limits: Limits,
    go_on: Callable[[Batch, Tally], Iterator[EventRows]],
) -> Climb:
    """Follow motions of one parameter set that doubles left open.

    Parameters
    ----------
    parameters : Parameters
    pairs : (n, STATE_WIDTH) complex array, updated
        Their first states, as pairs.
    below : Motions
        What doubles made of them, with fresh tallies, which are filled.
    limits : Limits
        The accuracy is the one that is attainable.
    go_on : callable
        Goes on in doubles with a batch and its tallies, which it updates, and yields the rows of its events.
    """
    doubles, tally, K = below.batch, below.tally, pair_constants(parameters)
    batch, rows = batch_of(doubles.states.copy(), doubles.sets), list[EventRows]()
    wanted = doubles.counts + (doubles.codes == IN_DOUBT)
    waiting, going = (
        np.arange(len(pairs)),
        Going(limits.most, limits.accuracy, MOST_MORE, below.table, sure(below.table)),
    )
    while len(waiting):
        events = wanted - batch.counts
        loops = pair_loops(int(events[waiting[:TOGETHER]].sum()))
        together = len(waiting) if loops is compiled_pairs() else TOGETHER
        active, waiting = waiting[:together], waiting[together:]
        room = room_for(0 if len(tally.floats) else int((events + MOST_MORE)[active].sum()))
        filled = loops.follow_pairs(active, wanted, pairs, batch, room, K, tally, going)
        PAIRS.events -= filled
        rows.append(rows_between(room, 0, min(filled, room.floats.shape[1])))
        active = active[batch.codes[active] == RUNNING]
        if len(active):
            further, counted = Batch(*(column[active] for column in batch)), some_of(tally, active)
            events = joined(go_on(further, counted))
            doubtful = is_doubtful(further.codes)
            kept = ~doubtful[events.ints[0]]
            events.ints[0] = active[events.ints[0]]
            rows.append(EventRows(events.floats[:, kept], events.ints[:, kept]))
            wanted[active] = further.counts + (further.codes == IN_DOUBT)
            done = active[~doubtful]
            for column, own in zip(batch, further, strict=True):
                column[done] = own[~doubtful]
            put_back(tally, done, some_of(counted, ~doubtful))
            waiting = np.concatenate([waiting, active[doubtful]])
    return Climb(batch, rows)


def sure(table: np.ndarray) -> np.ndarray:
    """Return a table of constants by which decisions exceed the errors of a state, whatever accuracy is asked for."""
    if len(table) and (table["sigmas"] == 0.0).any():
        table = table.copy()
        table["sigmas"] = float(SIGMAS)
    return table


def pair_loops(events: int) -> PairLoops:
    """Return the loops of double-double numbers for so many events: compiled, unless so few can be interpreted."""
    return compiled_pairs() if events > PAIRS.events or pairs_are_compiled() else interpreted_pairs()
