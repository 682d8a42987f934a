"""Compile ahead: what numba makes of the event loops is kept on disk, and later programs only load it."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple

import numpy as np

from symosc.engine.arithmetic import Arithmetic
from symosc.engine.binding import is_compiled
from symosc.engine.compiled_loop import STATE_WIDTH, batch_of, room_for
from symosc.engine.constant_table import table_of
from symosc.engine.tally import no_tally
from symosc.scenes import load_scene
from symosc.simulation.batch_loop import chosen_loops


class Warmed(NamedTuple):
    """What was compiled, or only loaded because it was on disk, and the seconds that it took."""

    what: str
    was_there: bool
    seconds: float


def warm() -> list[Warmed]:
    """Compile what `simulate_many` calls, unless that is on disk already.

    Raises
    ------
    MissingExtraError
        If numba is not installed.
    """
    loops = chosen_loops(True)
    from symosc.engine.pairs import follow_pairs, pair_constants

    p, nothing = load_scene("fig8").parameters, np.arange(0)

    def doubles() -> None:
        table, states = table_of([Arithmetic(p).K]), np.zeros((0, STATE_WIDTH))
        loops.march_rows(table, np.zeros((1, 2, 7)))
        loops.first_rows(table, nothing, states)
        loops.follow(0, batch_of(states), 1, 1.0, room_for(0), no_tally(), table)
        loops.settle(no_tally(), nothing, table, np.zeros((0, 0, 2)), nothing)

    def pairs() -> None:
        states = np.zeros((0, STATE_WIDTH))
        batch, table = batch_of(states), table_of([Arithmetic(p).K])
        K, room = pair_constants(p), room_for(0)
        follow_pairs()(nothing, nothing, states.astype(complex), batch, room, K, no_tally(), table)

    works: dict[str, tuple[Callable[[], bool], Callable[[], None]]] = {
        "events in doubles": (lambda: all(map(is_compiled, loops)), doubles),
        "events in double-double numbers": (lambda: is_compiled(follow_pairs()), pairs),
    }
    done = []
    for what, (is_there, run) in works.items():
        was_there, begin = is_there(), perf_counter()
        run()
        done.append(Warmed(what, was_there, perf_counter() - begin))
    return done
