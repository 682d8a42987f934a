"""Derivatives with respect to parameters and the start: of every event of a motion, and of its
state at any time.

At a graze a motion is differentiable on one side only by each number that moves the gap. There the
derivatives are those of the side on which the touch opens, `regular` is False from there on, and
`reasons` names the side. How the derivatives follow from each other says `symosc.engine.tangent`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import inf, nan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import NumberLike, SceneName
from symosc.base.arguments import ARRAY_LIKE, NAMES, NUMBER, WHOLE, public, require, require_or_none
from symosc.base.display.drawable import Comparable
from symosc.derivatives.banded import CORNER_ON_BELT, BandedColumns
from symosc.derivatives.law_gradients import LawGradients, with_all_points
from symosc.derivatives.motion_columns import (
    LEAST_EVENTS,
    MotionColumns,
    both_exponents,
    cuts_of_parts,
    error_of_mean,
)
from symosc.engine import tangent
from symosc.engine.arithmetic import many_digits
from symosc.engine.start import Start
from symosc.engine.state import GRAZE, ON_BELT
from symosc.kernels.entire import EPS
from symosc.model import Model
from symosc.scenes import Scene, scene_of
from symosc.simulation.problems import number_of
from symosc.simulation.simulate import read_start, simulate
from symosc.simulation.tangents import (
    codes_of,
    columns_of,
    is_deep,
    names_of,
    read_wrt,
    work_space,
)
from symosc.simulation.trajectory import Trajectory, read_times

#: Digits to compute derivatives with if double precision loses too many.
MORE_DIGITS = 30
#: Why a derivative does not exist, by the code of the reason.
REASONS = {
    tangent.NO_SLOPE: "the force that ends the stick at t = {t:.6g} has no slope there, up to "
    "rounding",
    tangent.FLAT_CONTACT: "the contact at t = {t:.6g} has no slope, up to rounding",
    tangent.NO_FORCE: "a force on belt {belt} vanishes at t = {t:.6g}, up to rounding",
    CORNER_ON_BELT: "where the stick ends at t = {t:.6g}, belt {belt} has the speed of a corner of "
    "another belt's friction",
}


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities(Comparable):
    """The derivatives of a motion.

    Call it for the derivatives of the state: ``s(t)`` are those of [x, v] at a fixed time, of shape
    (2, wrt) for a scalar and (2, n, wrt) for n times.

    Attributes
    ----------
    trajectory : Trajectory
        The motion.
    wrt : tuple of str
        The names of the numbers by which the motion is differentiated.
    dt, dx : array, (events, wrt)
        Total derivatives of the time and the position of each event.
    regular : array of bool, (events, wrt)
        Whether the derivative exists; where not, the number is that of one side.
    reasons : tuple
        For each event a text on what is not regular from there on, or None.
    lyapunov : array, (2,)
        The exponents, per unit of time, of the distance of neighbouring motions over this motion;
        the second is -inf where a stick occurred. A positive one says that the motion is chaotic.
    lyapunov_error : float
        Standard error of the first exponent as a mean over time, from 16 parts of the motion; NaN
        with fewer than 64 events.

    Examples
    --------
    >>> from symosc import sensitivities
    >>> s = sensitivities("fig9", ("Omega", "x0"))
    >>> s.dt.shape, bool(s.regular.all()), bool(s.lyapunov[0] < 0)
    ((12, 2), True, True)
    """

    trajectory: Trajectory
    wrt: tuple[str, ...]
    dt: np.ndarray
    dx: np.ndarray
    regular: np.ndarray
    reasons: tuple[str | None, ...]
    _motion: _PlainColumns | BandedColumns = field(repr=False)

    @cached_property
    def lyapunov(self) -> np.ndarray:
        """The Lyapunov exponents: rates at which the distance of neighbouring motions grows, the
        larger one first.
        """
        return self._motion.exponents()

    @cached_property
    def lyapunov_error(self) -> float:
        """The standard error of the first Lyapunov exponent as a mean over time."""
        return self._motion.exponent_error()

    @public
    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return the derivatives of [x, v] at the times `t`.

        Raises
        ------
        ParameterError
            If a time is outside [t_start, t_end].

        Examples
        --------
        >>> from symosc import sensitivities
        >>> s = sensitivities("fig9", ("x0", "k"))
        >>> s(2.0).shape, s([2.0, 3.0]).shape
        ((2, 2), (2, 2, 2))
        """
        require(*ARRAY_LIKE, t=t)
        times = read_times(t)
        self.trajectory(times)  # which checks their range
        changes = self._motion.at_times(times.ravel(), self.wrt, self.dt, self.dx)
        if self.trajectory.digits is None:
            changes = changes.astype(float)
        return changes.reshape((2, *times.shape, len(self.wrt)))

    def __repr__(self) -> str:
        first = next((n for n, row in enumerate(self.regular) if not row.all()), None)
        if first is None:
            about = ""
        else:
            about = f", not all regular from event {first} on"
        return f"<Sensitivities of {len(self.dt)} events by {', '.join(self.wrt)}{about}>"


class _PlainColumns(MotionColumns):
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


@public
def sensitivities(
    what: Scene | Model | SceneName,
    wrt: str | Sequence[str] = ("Omega", "mu1", "x0"),
    *,
    t0: NumberLike | None = None,
    x0: NumberLike | None = None,
    v0: NumberLike | None = None,
    t_end: NumberLike | None = None,
    max_events: int | None = None,
    digits: int | None = None,
) -> Sensitivities:
    """Differentiate a motion (every event, the state at any time) with respect to parameters and
    the start.

    Parameters
    ----------
    what, t0, x0, v0, t_end, max_events, digits
        The motion, as for `symosc.simulate`.
    wrt : str or sequence of str
        Names of parameters, and t0, x0, v0. Those of belts are v1, mu1, mu_s1, v2 and so on; where
        static friction equals kinetic friction, mu1 is both. Where friction depends on speed, w1_1,
        mu1_1, slope1 and so on are those of the curve (`Oscillator`).

    Returns
    -------
    Sensitivities

    Raises
    ------
    ParameterError
        If a name is unknown or given twice; and what `simulate` raises.

    Examples
    --------
    >>> from symosc import sensitivities
    >>> s = sensitivities("fig5", ("mu1", "x0"), t_end=3)
    >>> s.trajectory.events[1].kind, s.dt[1].round(6).tolist()
    ('slip', [0.93701, -0.095516])
    """
    what = scene_of(what, "what", any_law=True)
    require(*NAMES, wrt=wrt)
    require_or_none(NUMBER, t0=t0, x0=x0, v0=v0, t_end=t_end)
    require_or_none(WHOLE, max_events=max_events, digits=digits)
    start = read_start(what, {"t0": t0, "x0": x0, "v0": v0, "t_end": t_end}, None)
    names = read_wrt(wrt, names_of(start.parameters))
    about: dict[str, Any] = {"t0": start.t0, "x0": start.x0, "v0": start.v0, "t_end": start.t_end}
    about["max_events"] = max_events
    if start.start_error:
        about["start_error"] = start.start_error
    motion = simulate(start.parameters, **about, digits=digits)
    columns = _columns_of(motion, start, names, about)
    dt, dx, marks, why, *_ = columns.event_derivatives(names, len(names))
    belts = max(abs(float(belt.v)) for belt in start.parameters.law.belts)
    # A rounding that dx may have from v dt, relative to max(1, |dx|): with t0 = 1e8 all times
    # depend much on Omega.
    late = EPS * belts * np.abs(dt) > 1e-12 * np.maximum(1, np.abs(dx))
    if digits is None and ((why >= tangent.ROUGH).any() or late.any()):
        exact = simulate(start.parameters, **about, digits=MORE_DIGITS)
        # If the kinds differ, doubles followed another motion: its derivatives are left as they are.
        if [event.kind for event in exact.events] == [event.kind for event in motion.events]:
            columns = _columns_of(exact, start, names, about)
            dt, dx, marks, why, *_ = columns.event_derivatives(names, len(names))
            dt = dt.astype(float)
            dx = dx.astype(float)
    return Sensitivities(
        motion, names, dt, dx, marks == 1, _reasons(columns, names, marks, why), columns
    )


def _columns_of(
    motion: Trajectory, start: Start, wrt: tuple[str, ...], about: dict[str, Any]
) -> _PlainColumns | BandedColumns:
    """Return the motion in columns for its derivatives by `wrt`; `about` says how it was simulated."""
    model = start.parameters
    if model.law.is_plain:
        return _PlainColumns(motion, start)
    if LawGradients(model, wrt).bends_a_line:
        finer = simulate(with_all_points(model), **about, digits=motion.digits)
        # If the kinds differ, one of them followed another motion, see `sensitivities`.
        if [event.kind for event in finer.events] == [event.kind for event in motion.events]:
            motion = finer
    return BandedColumns(motion, start)


def _reasons(
    columns: _PlainColumns | BandedColumns,
    wrt: tuple[str, ...],
    marks: np.ndarray,
    codes: np.ndarray,
) -> tuple[str | None, ...]:
    """Return for each event why the motion is not differentiable from there on, None where it is.

    The first entry also says so of the start. `marks` say for each event and name whether the
    derivative exists, `codes` which of REASONS an event has.
    """
    reasons: list[str | None] = [None] * len(codes)
    for n in np.flatnonzero(codes).tolist():
        event = columns.trajectory.events[n]
        if codes[n] == tangent.KINK:
            words = {tangent.OPENS_ABOVE: "larger", tangent.OPENS_BELOW: "smaller"}
            sides = [
                f"{name} {words[mark]}"
                for name, mark in zip(wrt, marks[n].tolist(), strict=True)
                if mark > 1
            ]
            reasons[n] = f"after the graze at t = {float(event.t):.6g} for {', '.join(sides)}"
        elif codes[n] != tangent.ROUGH:
            reasons[n] = REASONS[codes[n]].format(t=float(event.t), belt=event.boundary)
    if reasons and (at_start := _kink_at_start(columns, wrt, marks)):
        reasons[0] = "; ".join(filter(None, (at_start, reasons[0])))
    return tuple(reasons)


def _kink_at_start(
    columns: _PlainColumns | BandedColumns, wrt: tuple[str, ...], marks: np.ndarray
) -> str | None:
    """Return a text on why a start on a belt is not differentiable, with the names concerned; None
    if it is.

    `marks` are 0 for the names of `wrt` by which no derivative exists.
    """
    mode, _, _, _, v = columns.starts[0]
    p = columns.trajectory.parameters
    number = columns.numbers.number
    belt_names = [f"v{n}" for n, belt in enumerate(p.law.belts, 1) if v == number(belt.v)]
    if not belt_names:
        return None
    # A change of these takes the start off the belt.
    leaving = [name for name in wrt if name in ("v0", *belt_names)]
    has_derivative = dict(zip(wrt, marks[0].tolist(), strict=True))
    moving = [name for name in wrt if not has_derivative[name] and name not in leaving]
    clauses = list[str]()
    names = ", ".join(leaving)
    if leaving:
        if mode > ON_BELT:
            side = f"for other {names} a stick begins first"
        else:
            side = f"by {names} on the flight's side only"
        clauses.append(side)
    if moving:
        clauses.append(f"a force there is 0, and {', '.join(moving)} may move it")
    if clauses:
        return f"the start is on a belt: {'; '.join(clauses)}"
    return None
