"""How the next event is searched in doubles: by compiled code where this program has loaded it, else in CPython.

Both give the same numbers. To load compiled code takes as long as thousands of events, so one motion does not ask for
it; where `simulate_many` has, and `symosc warm` has compiled the step of a single motion too, it is there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from symosc.aliases import Number
from symosc.engine.arithmetic import FLOAT_PATHS, compiled
from symosc.engine.binding import is_compiled
from symosc.engine.compiled_loop import row_of
from symosc.engine.constant_table import table_of
from symosc.engine.flow import Constants
from symosc.engine.state import Covariance, NextEvent, State

#: Returns the next event of a state in doubles.
Search = Callable[[State], NextEvent]


def search_in_doubles(end: tuple[Number, Number], K: Constants) -> Search:
    """Return what searches for the next event up to an end, given in two parts."""
    function = loaded()
    return Interpreted(end, K) if function is None else Compiled(function, end, K)


def loaded() -> Any:
    """Return `symosc.engine.compiled_loop.search_row` compiled, or None where to get it would take a while."""
    if not compiled.cache_info().currsize:
        return None
    functions = compiled()
    in_use, function = functions["follow_all"].overloads, functions["search_row"]
    return function if in_use and is_compiled(function) else None


class Interpreted:
    """The engine as CPython runs it."""

    def __init__(self, end: tuple[Number, Number], K: Constants) -> None:
        self._end, self._K = end, K

    def __call__(self, state: State) -> NextEvent:
        """Return the next event."""
        found: NextEvent = FLOAT_PATHS.advance(state, *self._end, self._K)
        return found


class Compiled:
    """The engine as numba compiled it; not for two threads at once."""

    def __init__(self, function: Any, end: tuple[Number, Number], K: Constants) -> None:
        self._function, self._end, self._table = function, end, table_of([K])

    def __call__(self, state: State) -> NextEvent:
        """Return the next event."""
        row = np.array([row_of(state, *self._end)])
        code, boundary, decided, t_error = self._function(row, self._table)
        mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, _, _, _, s, c = row[0].tolist()
        S = Covariance(S11, S12, S22)
        there = State(int(mode), int(at), int(n), theta, x, v, Fb, Fa, S, t, t_low, s, c)
        return NextEvent(code, boundary, decided, t_error, there)
