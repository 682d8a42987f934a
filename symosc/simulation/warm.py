"""Compile ahead: what numba makes of the event loops is kept on disk, and later programs only load it."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple

import numpy as np

from symosc.engine.arithmetic import (
    Arithmetic,
    Going,
    compiled,
    compiled_pairs,
    is_compiled,
    pair_constants,
    pairs_are_compiled,
)
from symosc.engine.batch import STATE_WIDTH, batch_of, room_for, row_of
from symosc.engine.constant_table import table_of
from symosc.engine.start import Start, first_state
from symosc.engine.summary import no_tally
from symosc.scenes import load_scene
from symosc.simulation.batch_loop import chosen_loops
from symosc.simulation.run import last_time


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
    scene, nothing = load_scene("fig8"), np.arange(0)
    p = scene.parameters

    def doubles() -> None:
        table, states = table_of([Arithmetic(p).K]), np.zeros((0, STATE_WIDTH))
        loops.march_rows(table, np.zeros((1, 2, 7)))
        loops.first_rows(table, nothing, states)
        loops.follow(0, batch_of(states), 1, 1.0, room_for(0), no_tally(), table)
        loops.settle(no_tally(), nothing, table, np.zeros((0, 0, 2)), nothing)

    search = compiled()["search_row"]

    def alone() -> None:
        start, arithmetic = Start(p, scene.t0, scene.x0, scene.v0, scene.t_end), Arithmetic(p)
        row = row_of(first_state(start, arithmetic), *last_time(start, arithmetic))
        search(np.array([row], float), table_of([arithmetic.K]))

    def pairs() -> None:
        states = np.zeros((0, STATE_WIDTH))
        batch, table = batch_of(states), table_of([Arithmetic(p).K])
        K, room = pair_constants(p), room_for(0)
        begin, follow = compiled_pairs()
        begin(states.astype(complex), K)
        follow(nothing, nothing, states.astype(complex), batch, room, K, no_tally(), Going(1, 1.0, 0, table, table))

    works: dict[str, tuple[Callable[[], bool], Callable[[], None]]] = {
        "events in doubles": (lambda: all(map(is_compiled, loops)), doubles),
        "events of single motions": (lambda: is_compiled(search), alone),
        "events in double-double numbers": (pairs_are_compiled, pairs),
    }
    done = []
    for what, (is_there, run) in works.items():
        was_there, begin = is_there(), perf_counter()
        run()
        done.append(Warmed(what, was_there, perf_counter() - begin))
    return done
