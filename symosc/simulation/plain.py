"""Derivatives of motions that one row of constants is enough for: those under a plain law."""

from __future__ import annotations

from fractions import Fraction
from math import inf, nan
from typing import Any

import numpy as np

from symosc.engine import tangent
from symosc.engine.arithmetic import many_digits
from symosc.engine.start import Start
from symosc.engine.state import GRAZE, ON_BELT
from symosc.simulation.motion_columns import (
    LEAST_EVENTS,
    MotionColumns,
    both_exponents,
    cuts_of_parts,
    error_of_mean,
)
from symosc.simulation.problems import number_of
from symosc.simulation.tangents import codes_of, columns_of, is_deep, work_space
from symosc.simulation.trajectory import Trajectory


class PlainColumns(MotionColumns):
    """A motion that one row of constants is enough for, with its events as columns.

    Its methods compute all derivatives.
    """

    def __init__(self, trajectory: Trajectory, start: Start) -> None:
        super().__init__(trajectory)
        p = trajectory.parameters
        number = self.numbers.number
        piece = trajectory._pieces[:, 0]
        letters = [number(number_of(p, name)) for name in tangent.Letters._fields]
        self.letters = np.array([letters], dtype=self.kind)
        if self.context:
            theta = many_digits(p, self.context.dps).phase(start.t0)[0]
        else:
            theta = piece[1]
        mode = int(piece[2])
        first = mode, number(start.t0), theta, number(start.x0), number(start.v0)
        self.starts = np.array([first], dtype=self.kind)
        self.rows: tuple[Any, ...] = columns_of(trajectory.rows())
        if self.context:
            names = ("t", "theta", "x", "v")
            exact = [
                [self.context.mpf(getattr(event, name)) for event in trajectory.events]
                for name in names
            ]
            # The rest of a row, after these four, is the same in any arithmetic.
            self.rows = (*np.array(exact, dtype=object), *self.rows[len(names) :])

    def event_derivatives(
        self, wrt: tuple[str, ...], count: int, first_events: int | None = None
    ) -> tuple[np.ndarray, ...]:
        """Return dt, dx, marks, reasons, growth and last: derivatives of all events by the first
        `count` names.

        Of the events after the number `first_events`, if that is given, nothing is computed.

        A mark is 1 where the derivative exists, else says why not; a reason is a code for each
        event, 0 if there is none. Growth is the logarithms of how lengths and areas grow; last has
        the derivatives where the last piece begins.
        """
        codes = codes_of(wrt)
        events = len(self.rows[0])
        kept = [np.zeros((events, count), self.kind) for _ in range(2)]
        out = *kept, np.zeros((events, count), np.int8), np.zeros(events, np.int8), np.zeros((1, 2))
        work = work_space(codes, self.kind)
        first = np.zeros(1, np.int64)
        cuts = np.array([0, events if first_events is None else first_events])
        loop, table = self.loop("tangents", events)
        loop(
            first,
            cuts,
            self.starts,
            first,
            self.rows,
            codes,
            is_deep(codes),
            self.letters,
            table,
            out,
            work,
        )
        return *out, work

    def pieces(self) -> tuple[np.ndarray, np.ndarray]:
        """Return rows of mode, t, theta, x, v where pieces of the motion begin, and the indices of
        the events there.
        """
        t, theta, x, v, kinds, _, targets = self.rows
        events = np.flatnonzero(kinds != GRAZE)
        rows = np.array([targets, t, theta, x, v], dtype=self.kind).T[events]
        return np.concatenate([self.starts, rows]), events

    def at_times(
        self, times: np.ndarray, wrt: tuple[str, ...], dt: np.ndarray, dx: np.ndarray
    ) -> np.ndarray:
        """Return derivatives of x, v at times with respect to `wrt`, (2, times, wrt), given dt, dx
        of the events.
        """
        codes = codes_of(wrt)
        (starts, events) = self.pieces()
        # Derivatives of t, x, v where the pieces begin. At the start t0, x0, v0 vary by themselves,
        # and have the codes from T0 on. At an event v is the speed of its belt, of code V1 or V2.
        launched = np.zeros((3, len(starts), len(wrt)), self.kind)
        launched[:, 0] = codes == tangent.T0 + np.arange(3)[:, None]
        launched[0, 1:] = dt[events]
        launched[1, 1:] = dx[events]
        _t, _theta, _x, _v, _kind, belts, _target = self.rows
        launched[2, 1:] = codes == tangent.V1 - 1 + belts[events, None]
        if self.context:
            times = np.array([self.numbers.number(Fraction(t)) for t in times])
        pieces = np.maximum(
            np.searchsorted(starts[1:, 1].astype(float), times.astype(float), "right"), 0
        )
        return self._state_derivatives(
            self.loop("changes_at", len(times)), times, pieces, starts, launched, codes
        )

    def _state_derivatives(
        self,
        loop: Any,
        times: np.ndarray,
        pieces: np.ndarray,
        starts: np.ndarray,
        launched: np.ndarray,
        codes: Any,
    ) -> np.ndarray:
        """Return derivatives of x and v at `times`, from those where the pieces of the motion
        begin.

        They are with respect to the numbers with `codes`. `pieces` has for each time the index of
        its piece: of the row of `starts` where that begins, and of the derivatives `launched` of t,
        x and v there. `loop` is the function to call, and the motion's constants.
        """
        out = np.zeros((2, len(times), len(codes)), self.kind)
        (function, table) = loop
        work = work_space(codes, self.kind)
        function(
            times, pieces, starts, launched, codes, is_deep(codes), self.letters, table, out, work
        )
        return out

    def exponents(self) -> np.ndarray:
        """Return the Lyapunov exponents over the motion, the larger one first."""
        codes = codes_of(("x0", "v0"))
        starts, _ = self.pieces()
        last = starts[-1:]
        *_, growth, work = self.event_derivatives(("x0", "v0"), 0)
        grown, volume = growth[0].tolist()
        end = (self.context.mpf if self.context else float)(self.trajectory.t_end)
        interpreted = (self.numbers.of["changes_at"], [self.numbers.K])
        only_piece = np.zeros(1, np.int64)
        # Derivatives of t, x, v by both numbers where the last piece begins.
        launched = work[:3, None, :2].copy()
        out = self._state_derivatives(
            interpreted, np.array([end]), only_piece, last, launched, codes
        )
        mode, begin, *_ = last[0]
        if mode <= ON_BELT:  # in a flight areas shrink by exp(-c t/m), in a stick to 0
            volume -= float(self.numbers.K.cm * (end - begin))
        else:
            volume -= inf
        _, t_start, *_ = self.starts[0]
        return both_exponents(grown, out[:, 0], volume, float(end - t_start))

    def exponent_error(self) -> float:
        """Return the standard error of the first exponent, from its values in parts of the motion."""
        events = len(self.rows[0])
        if events < LEAST_EVENTS:
            return nan
        cuts = cuts_of_parts(events)
        grown = [0.0]
        for end in cuts:
            *_, growth, _ = self.event_derivatives(("x0", "v0"), 0, end)
            grown.append(float(growth[0, 0]))
        times = self.rows[0]
        return error_of_mean(grown, [self.starts[0, 1], *(times[end - 1] for end in cuts)])
