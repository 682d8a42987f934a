"""How the next event is searched in doubles: by compiled code where this program has loaded it, else in CPython.

Both give the same bits. To load compiled code takes as long as thousands of events, so one motion does not ask for
it; where `simulate_many` has, and `symosc warm` has compiled the step of a single motion too, it is there.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np

from symosc.aliases import Number
from symosc.engine.arithmetic import Arithmetic, compiled, is_compiled
from symosc.engine.batch import STATE_WIDTH, end_by_phase, row_of
from symosc.engine.constant_table import table_of
from symosc.engine.flow import Constants
from symosc.engine.next_event import advance
from symosc.engine.start import Start
from symosc.engine.state import Covariance, NextEvent, State

# A motion is searched period by period: more than this many would take hours.
MOST_PERIODS = 10**8

#: Returns the next event of a state in doubles.
Search = Callable[[State], NextEvent]


def last_time(start: Start, arithmetic: Arithmetic) -> tuple[Number, Number]:
    """Return t_end in two parts, or a time MOST_PERIODS after t0 if that is earlier."""
    periods = Fraction(MOST_PERIODS * 44, 7) / start.parameters.Omega  # 44/7 is a little more than 2 pi
    return arithmetic.time(min(start.t_end, start.t0 + periods))


def _times(start: Start) -> list[Number]:
    """Return a row of a batch with nothing but its times."""
    row = [0.0] * STATE_WIDTH
    row[13:16] = *last_time(start, Arithmetic(start.parameters)), float(start.t0)
    return row


def search_in_doubles(start: Start, K: Constants) -> Search:
    """Return what searches for the next event of a motion."""
    function = loaded()
    return Interpreted(start, K) if function is None else Compiled(function, start, K)


def loaded() -> Any:
    """Return `symosc.engine.batch.search_row` compiled, or None where to get it would take a while."""
    if not compiled.cache_info().currsize:
        return None
    functions = compiled()
    in_use, function = functions["follow_all"].overloads, functions["search_row"]
    return function if in_use and is_compiled(function) else None


class Interpreted:
    """The engine as CPython runs it."""

    def __init__(self, start: Start, K: Constants) -> None:
        (*self._end, _), self._K = end_by_phase(_times(start), K), K

    def __call__(self, state: State) -> NextEvent:
        """Return the next event."""
        found: NextEvent = advance(state, *self._end, self._K)
        return found


class Compiled:
    """The engine as numba compiled it; not for two threads at once."""

    def __init__(self, function: Any, start: Start, K: Constants) -> None:
        self._function, self._times, self._table = function, _times(start), table_of([K])

    def __call__(self, state: State) -> NextEvent:
        """Return the next event."""
        row = np.array([row_of(state, 0.0, 0.0)])
        row[0, 13:16] = self._times[13:16]
        code, boundary, decided, t_error = self._function(row, self._table)
        mode, at, n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low, _, _, _, s, c, theta_low = row[0].tolist()
        S = Covariance(S11, S12, S22)
        there = State(int(mode), int(at), int(n), theta, x, v, Fb, Fa, S, t, t_low, s, c, theta_low)
        return NextEvent(code, boundary, decided, t_error, there)
