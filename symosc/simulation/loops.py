"""Which loop follows motions: the one place where that is chosen.

A motion can be followed by five kinds of loops. All of doubles give the same bits, and so do both
of pairs; so what comes out does not depend on the choice, only the time that it takes.

- plain Python on floats: at once, a fraction of a millisecond an event;
- compiled doubles: 0.1 to 0.3 microseconds an event, once numba is imported (half a second) and the
  code loaded from disk (half a second) or compiled (twenty seconds);
- plain Python on pairs of doubles: some milliseconds an event;
- compiled pairs: some microseconds an event, after up to a minute of compiling;
- any number of digits (`symosc.simulation.motion`): half a millisecond an event and more. They are
  no choice: they follow where pairs do not suffice.

The rules, in this order:

1. `use_numba` decides, if the caller gives it.
2. A loop that has run compiled in this process is used: nothing is quicker.
3. Single motions do not import numba before they have had TURN events.
4. A loop whose code is on disk is loaded.
5. Other loops are interpreted until this process has interpreted as many events as take about as
   long as compiling (`Budget`), and are compiled then.

`CHOICE` is the choice of this process, and the only state of it: budgets, which go down. Nothing of
it is locked: two threads that read a budget at once at worst interpret some events more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from symosc.base.errors import MissingExtraError
from symosc.engine import arithmetic, batch, flow, summary, tangent
from symosc.engine.arithmetic import PairLoops, compiled, compiled_pairs, interpreted, loaded_loop
from symosc.engine.batch import Batch, EventRows, keep_state, rows_between, state_of
from symosc.engine.flow import Constants, TableLoops, table_of
from symosc.engine.state import STATE_ROW, RowNumbers, State, numbers_of_state
from symosc.kernels.compiling import is_compiled

#: Follows motions as `symosc.engine.batch.follow_all` does.
Follow = Callable[..., tuple[int, int, int]]

# Events after which an interpreted loop gives its rows back, so that it is asked again whether
# compiling pays.
TURN = 2048
# Events for which a compiled loop of a single motion gets room at most, before it gives its rows
# back and tells of its progress.
LARGEST_BLOCK = 1 << 15


@dataclass
class Budget:
    """How many events one kind of loop may still interpret in this process before it is compiled
    instead.
    """

    events: int

    @property
    def is_spent(self) -> bool:
        """Whether the loop is to be compiled."""
        return self.events <= 0


class Loops(NamedTuple):
    """The functions that start, follow and finish motions in doubles, compiled or not.

    They take constants as a numpy table.
    """

    table: TableLoops
    follow: Follow
    settle: Callable[..., None]
    in_threads: bool  # whether several threads are faster than one


class SingleLoop(NamedTuple):
    """The loop for one motion: the function, its constants as this function takes them, and for
    how many events it gets room at most.
    """

    follow: Follow
    constants: Any
    most_events: int


# Python reads and writes the numbers of a numpy record, one by one, ten times as slowly as those of
# its own objects. Where that is done for each event, one of these two stands between.


class PlainMotion:
    """One motion as interpreted code takes it: a list with one row, an object of Python's."""

    def __init__(self, t_end: float, t_end_low: float, t0: float) -> None:
        self.table = [SimpleNamespace(t_end=t_end, t_end_low=t_end_low, t0=t0)]

    def put(self, state: State) -> None:
        """Write its state."""
        keep_state(self.table[0], state)

    def state(self) -> State:
        """Return its state."""
        state: State = state_of(self.table[0])
        return state


class MotionInTable:
    """One motion as compiled code takes it: a numpy table of one row, read and written as a whole."""

    def __init__(self, t_end: float, t_end_low: float, t0: float) -> None:
        self.table = np.zeros(1, STATE_ROW)
        self._ends = t_end, t_end_low, t0

    def put(self, state: State) -> None:
        """Write its state."""
        self.table[0] = numbers_of_state(state) + self._ends

    def state(self) -> State:
        """Return its state."""
        state: State = state_of(RowNumbers._make(self.table[0].item()))
        return state


class SearchLoops(NamedTuple):
    """The functions that search for single events (`symosc.engine.batch.search_row`, `doubt_row`),
    and whether they are compiled: then they take constants and motions as numpy tables.
    """

    search: Callable[..., Any]
    doubt: Callable[..., int]
    are_compiled: bool

    def constants(self, rows: Sequence[Constants]) -> Any:
        """Return rows of constants as these functions take them."""
        if self.are_compiled:
            return table_of(rows)
        return rows

    def motion(self, t_end: float, t_end_low: float, t0: float) -> PlainMotion | MotionInTable:
        """Return a motion as these functions take it, without a state yet."""
        if self.are_compiled:
            return MotionInTable(t_end, t_end_low, t0)
        return PlainMotion(t_end, t_end_low, t0)


INTERPRETED = Loops(
    TableLoops(interpreted(flow.march_rows), None),
    interpreted(batch.follow_all),
    interpreted(summary.settle),
    False,
)
INTERPRETED_TANGENTS = interpreted(tangent.tangents)


@dataclass
class LoopChoice:
    """The choice of the loops, with the budgets of what may still be interpreted."""

    doubles: Budget = field(default_factory=lambda: Budget(250_000))
    pairs: Budget = field(default_factory=lambda: Budget(25_000))
    # searches for single events, beside motions in digits
    searches: Budget = field(default_factory=lambda: Budget(150_000))
    derivatives: Budget = field(default_factory=lambda: Budget(250_000))

    def of_many(self, use_numba: Any) -> Loops:
        """Return the loops for many motions: compiled (True), interpreted (False), or compiled if
        numba is installed and that is quicker (None).
        """
        if use_numba is not None and not use_numba:
            return INTERPRETED
        try:
            functions = compiled()
        except MissingExtraError:
            if use_numba:
                raise
            return INTERPRETED
        march_rows = functions["march_rows"]
        run_program: Callable[..., None] | None = arithmetic.compiled_program()
        follow = functions["follow_all"]
        settle = functions["settle"]
        if not use_numba:
            if not is_compiled(march_rows):
                march_rows = INTERPRETED.table.march_rows
            if not is_compiled(run_program):
                run_program = None
            if not is_compiled(follow):
                follow = self._interpreted_first(follow)
            if not is_compiled(settle):
                settle = INTERPRETED.settle
        return Loops(TableLoops(march_rows, run_program), follow, settle, True)

    def _interpreted_first(self, compiled_loop: Follow) -> Follow:
        """Return an event loop, interpreted for up to TURN events per call until the budget is
        spent, then compiled.
        """

        def follow(
            begin: int, motions: Batch, most: int, accuracy: float, out: EventRows, *others: Any
        ) -> tuple[int, int, int]:
            if self.doubles.is_spent or is_compiled(compiled_loop):
                return compiled_loop(begin, motions, most, accuracy, out, *others)
            first = Batch(*(column[: begin + 1] for column in motions))
            turn = rows_between(out, 0, TURN)
            begin, filled, parts = INTERPRETED.follow(begin, first, most, accuracy, turn, *others)
            self.doubles.events -= max(filled, 1)
            return begin, filled, parts

        return follow

    def of_single(self, count: int, rows: Sequence[Constants]) -> SingleLoop:
        """Return the loop for a motion that has had `count` events and has these rows of constants."""
        functions = loaded_loop()
        if functions:
            return SingleLoop(functions["follow_all"], table_of(rows), LARGEST_BLOCK)
        if count < TURN:
            return SingleLoop(batch.follow_all, rows, TURN)
        follow = self.of_many(None).follow
        if loaded_loop() is None:
            return SingleLoop(follow, table_of(rows), TURN)
        return SingleLoop(follow, table_of(rows), LARGEST_BLOCK)

    def of_searches(self) -> SearchLoops:
        """Return the functions that search for single events: compiled only where the event loop
        is loaded too.
        """
        functions = loaded_loop()
        if functions:
            search = functions[batch.search_row.__name__]
            doubt = functions[batch.doubt_row.__name__]
            if self.searches.is_spent or (is_compiled(search) and is_compiled(doubt)):
                return SearchLoops(search, doubt, True)
        return SearchLoops(batch.search_row, batch.doubt_row, False)

    def of_pairs(self, events: int) -> PairLoops:
        """Return the loops for pairs, compiled, or interpreted if that is quicker for so many
        `events`.
        """
        if events > self.pairs.events or arithmetic.pairs_are_compiled():
            return compiled_pairs()
        return arithmetic.interpreted_pairs()

    def of_pairs_if_loaded(self) -> PairLoops | None:
        """Return the loops for pairs if they are compiled and the loop of doubles has run compiled
        in this process, else None: single motions take digits then.
        """
        if arithmetic.pairs_are_loaded():
            return compiled_pairs()
        return None

    def of_derivatives(
        self, events: int, in_threads: bool, use_numba: bool | None
    ) -> Callable[..., None]:
        """Return the loop for derivatives of so many `events`: compiled if `in_threads`, and if
        `use_numba` or quicker.
        """
        if not in_threads:
            return INTERPRETED_TANGENTS
        loop: Callable[..., None] = arithmetic.compiled_tangents()["tangents"]
        if use_numba or self.derivatives.is_spent or is_compiled(loop):
            return loop
        self.derivatives.events -= events
        return INTERPRETED_TANGENTS

    def of_derivatives_on_disk(self, wanted: bool) -> dict[str, Any] | None:
        """Return the compiled loops of derivatives if they are on disk, else None.

        Look only if `wanted` or if numba is in use.
        """
        if not wanted and loaded_loop() is None:
            return None
        try:
            functions = arithmetic.compiled_tangents()
        except MissingExtraError:
            return None
        if is_compiled(functions["tangents"]):
            return functions
        return None


#: The choice of this process.
CHOICE = LoopChoice()
