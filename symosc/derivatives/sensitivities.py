"""Derivatives with respect to parameters and the start: of every event of a motion, and of its
state at any time.

At a graze a motion is differentiable on one side only by each number that moves the gap. There the
derivatives are those of the side on which the touch opens, `regular` is False from there on, and
`reasons` names the side. How the derivatives follow from each other says `symosc.engine.tangent`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import NumberLike, SceneName
from symosc.base.arguments import ARRAY_LIKE, NAMES, NUMBER, WHOLE, public, require, require_or_none
from symosc.base.display.drawable import Comparable
from symosc.engine import tangent
from symosc.engine.state import ON_BELT
from symosc.kernels.entire import EPS
from symosc.model import Model
from symosc.scenes import Scene, scene_of
from symosc.simulation.banded import CORNER_ON_BELT, BandedColumns
from symosc.simulation.differentiated import columns_for
from symosc.simulation.plain import PlainColumns
from symosc.simulation.simulate import read_start, simulate
from symosc.simulation.tangents import names_of, read_wrt
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
    _motion: PlainColumns | BandedColumns = field(repr=False)

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
    columns = columns_for(motion, start, names, partial(simulate, **about, digits=digits))
    dt, dx, marks, why, *_ = columns.event_derivatives(names, len(names))
    belts = max(abs(float(belt.v)) for belt in start.parameters.law.belts)
    # A rounding that dx may have from v dt, relative to max(1, |dx|): with t0 = 1e8 all times
    # depend much on Omega.
    late = EPS * belts * np.abs(dt) > 1e-12 * np.maximum(1, np.abs(dx))
    if digits is None and ((why >= tangent.ROUGH).any() or late.any()):
        exact = simulate(start.parameters, **about, digits=MORE_DIGITS)
        # If the kinds differ, doubles followed another motion: its derivatives are left as they are.
        if [event.kind for event in exact.events] == [event.kind for event in motion.events]:
            columns = columns_for(
                exact, start, names, partial(simulate, **about, digits=MORE_DIGITS)
            )
            dt, dx, marks, why, *_ = columns.event_derivatives(names, len(names))
            dt = dt.astype(float)
            dx = dx.astype(float)
    return Sensitivities(
        motion, names, dt, dx, marks == 1, _reasons(columns, names, marks, why), columns
    )


def _reasons(
    columns: PlainColumns | BandedColumns,
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
    columns: PlainColumns | BandedColumns, wrt: tuple[str, ...], marks: np.ndarray
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
