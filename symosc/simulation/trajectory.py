"""The result of a simulation: events, segments, dense output and files, in other coordinates too."""

from __future__ import annotations

import json
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.arguments import ARRAY_LIKE, ROWS, WHOLE, public, require
from symosc.base.display.drawable import Drawable, Listing
from symosc.base.display.frames import imported
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact, show, unmasked, whole_number
from symosc.base.files import write_text
from symosc.engine.arithmetic import column_functions, rows_in_doubles
from symosc.engine.batch import PIECE_COLUMNS, EventRows
from symosc.engine.events import (
    COLUMN_TYPES,
    EVENT_COLUMNS,
    EXACT_COLUMNS,
    Event,
    events_from,
    mode_of_law,
)
from symosc.engine.flow import Constants, constant_force
from symosc.engine.state import MIDDLE, ON_BELT
from symosc.friction import ALL_MODE_NAMES, geometry
from symosc.kernels._generated import acceleration, motion
from symosc.kernels.elementary import cos, sin
from symosc.kernels.entire import basis_with_drive
from symosc.model import Model
from symosc.reductions import event_back, motion_of_frame, number_like
from symosc.scenes import Original
from symosc.simulation.samples import MotionSamples, even_samples
from symosc.simulation.tables import rows_of, write_csv
from symosc.words import Labels

# So many times are evaluated as arrays, and how many at once.
MANY_TIMES = 1 << 6
TIMES_TOGETHER = 1 << 16
# Rows of the array of pieces that are used alone.
MODE_ROW = PIECE_COLUMNS.index("mode")
ELAPSED_ROW = PIECE_COLUMNS.index("elapsed")
BAND_ROW = PIECE_COLUMNS.index("row")


@cache
def map_labels(belts: int) -> dict[tuple[int, str, int], str]:
    """Return the labels of the mappings of so many belts by start plane, mode and end plane.

    Planes are the belts; a stick stays on one.
    """
    law = geometry(belts)
    return {
        (row.start.boundary, law.mode_names[row.mode], row.end.boundary): row.label
        for row in law.maps.values()
    }


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of a motion in one domain or on one belt.

    Attributes
    ----------
    t_start, t_end : number
    mode : str
        "Omega1", "Omega2" and so on between the belts, "belt1", "belt2" on them.
    label : str or None
        The mapping, "P1" to "P8"; None if the segment starts or ends between the belts. With
        another number of belts than two it is S (stick), B, A (return to a belt from below, above),
        U or D (passage up, down) with the belts' numbers, such as "S1" or "U12".

    Examples
    --------
    >>> from symosc import simulate
    >>> segment = simulate("fig5").segments[1]
    >>> segment.label, segment.mode, f"{segment.t_end:.6f}"
    ('P1', 'belt1', '1.220981')
    """

    t_start: Any
    t_end: Any
    mode: str
    label: str | None


class Trajectory(Drawable):
    """An exact event-driven trajectory.

    Calling it gives the state: ``traj(t)`` is ``[x, v]``, of shape (2,) for a scalar and (2, n) for
    n times.

    Attributes
    ----------
    parameters : Parameters or Oscillator
    events : tuple of Event
        Made at the first access.
    segments : tuple of Segment
    status : str
        "t_end" (reached), "max_events", "equilibrium" (at rest, or settling with no event left) or
        "undecidable" (a contact that this precision cannot decide; the trajectory ends before it).
    message : str
        The status in words: what happened, when, and what to do about it.
    word : list of str
        Labels "P1" to "P8" of the segments between switching planes, in order of time. A graze ends
        one mapping and begins the next.
    t_start, t_end : number
        First and last time.
    digits : int or None
        How many digits were asked for, relative to max(1, |value|); None is double precision.

    Examples
    --------
    >>> from symosc import simulate
    >>> trajectory = simulate("fig5", t_end=7)
    >>> x, v = trajectory(2.5)
    >>> print(f"x = {x:.6f}, v = {v:.6f} in {trajectory.mode(2.5)}")
    x = -0.144666, v = -4.125063 in Omega1
    >>> trajectory.word
    ['P1', 'P2', 'P1', 'P3']
    """

    _drawn_by = "figure"
    _made_by = "simulate(...)"
    #: Whether the numbers are in kg, m, s, N and rad, as `Scene.in_si` says.
    in_si = False

    def __init__(
        self,
        parameters: Model,
        events: Callable[[], Sequence[Event]] | EventRows,
        pieces: np.ndarray,
        status: str,
        message: str,
        span: tuple[Any, Any],
        first_at: int,
        digits: int | None = None,
    ) -> None:
        self.parameters = parameters
        self.status = status
        self.message = message
        self.digits = digits
        self.t_start, self.t_end = span
        self._rows: Any = events
        self._t0 = float(self.t_start)
        self._first_at = first_at
        self._pieces = pieces
        self._rows_of_constants = rows_in_doubles(parameters)  # they are kept

    @cached_property
    def events(self) -> Listing[Event]:
        """The events in order of time."""
        if not callable(self._rows):
            return Listing(events_from(self._rows))
        # what makes them, the whole motion, is no longer needed
        made = Listing(self._rows())
        self._rows = None
        return made

    def __getstate__(self) -> dict[str, Any]:
        if callable(self._rows):
            len(self.events)  # made now, as what makes them cannot be pickled
        return self.__dict__

    def rows(self) -> EventRows:
        """Return the events as columns of doubles."""
        if isinstance(self._rows, EventRows):
            return self._rows
        return rows_of(0, self.events)

    @cached_property
    def segments(self) -> Listing[Segment]:
        """The segments in order of time."""
        segments = []
        labels = map_labels(len(self.parameters.law.belts))
        plane = self._first_at
        since = self.t_start
        mode = self._mode_of_piece(0)
        for event in self.events:
            label = labels.get((plane, mode, event.boundary))
            segments.append(Segment(since, event.t, mode, label))
            plane = event.boundary
            since = event.t
            mode = event.target
        return Listing([*segments, Segment(since, self.t_end, mode, None)])

    @cached_property
    def _starts(self) -> Any:
        """The times at which the pieces begin, counted from t0."""
        return self._pieces[ELAPSED_ROW].tolist()

    @property
    def word(self) -> Labels:
        """The labels "P1" to "P8" of the mappings, in order of time."""
        return Labels(segment.label for segment in self.segments if segment.label)

    @public
    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return [x, v] at the times `t` (unit of time of the parameters).

        Raises
        ------
        ParameterError
            If a time is outside [t_start, t_end].
        """
        require(*ARRAY_LIKE, t=t)
        times = read_times(t)
        return self._states(times)[:2].reshape((2, *times.shape))

    @public
    def mode(self, t: ArrayLike) -> Any:
        """Return the mode ("Omega1" … "belt2") at a time, or an array of them.

        At an event the one that follows.
        """
        require(*ARRAY_LIKE, t=t)
        times = read_times(t)
        self._check_times(times)
        pieces = self._pieces_at(times.ravel() - self._t0)
        names = [self._mode_of_piece(piece) for piece in pieces.tolist()]
        if times.ndim == 0:
            return names[0]
        return np.array(names).reshape(times.shape)

    @public
    def force(self, alpha: int, t: ArrayLike) -> Any:
        """Return F^(alpha) of eq. (9), the acceleration that domain `alpha` would give, at times
        `t`.

        Where the friction in the domain depends on the velocity, and this is outside of it, the
        band beside the belt counts.
        """
        require(*ARRAY_LIKE, t=t)
        times = read_times(t)
        alpha = whole_number("alpha", alpha, 1, len(self.parameters.law.belts) + 1)
        x, v, c = self._states(times)
        forces = np.empty_like(x)
        for K, A, here in self._bands_of(alpha, v):
            forces[here] = acceleration(x[here], v[here], c[here], A, K.cm, K.w0sq, K.f0)
        if times.ndim:
            return forces.reshape(times.shape)
        return forces.item()

    def _bands_of(self, alpha: int, v: np.ndarray) -> Iterator[tuple[Constants, float, np.ndarray]]:
        """Yield the constants of each band of a domain, the constant force there, and the places in
        `v` of the velocities for which they count.
        """
        first, *others = self._rows_of_constants
        if not first.banded:
            yield first, constant_force(alpha, first), np.arange(len(v))
            return
        bands = [K for K in (first, *others) if K.shift + MIDDLE == alpha]
        band_of = np.searchsorted([K.belt2.v for K in bands[:-1]], v)
        for number, K in enumerate(bands):
            yield K, K.A2, np.flatnonzero(band_of == number)

    def _mode_of_piece(self, piece: int) -> str:
        """Return the name of the mode in a piece of the motion."""
        K = self._rows_of_constants[int(self._pieces[BAND_ROW, piece])]
        return ALL_MODE_NAMES[mode_of_law(int(self._pieces[MODE_ROW, piece]), K)]

    def _check_times(self, times: np.ndarray) -> None:
        """Raise ParameterError for a time that is out of range."""
        low = float(self.t_start)
        high = float(self.t_end)
        for outside in times[~((times >= low) & (times <= high))][:1]:  # the first one, if any
            raise ParameterError("t", float(outside), f"must be within [{low!r}, {high!r}]")

    def _pieces_at(self, elapsed: np.ndarray) -> np.ndarray:
        """Return the numbers of the pieces to which times, counted from t0, belong."""
        return np.maximum(np.searchsorted(self._pieces[ELAPSED_ROW], elapsed, "right") - 1, 0)

    def _state(self, t: float) -> tuple[float, float, float]:
        """Return x, v and the cosine of the phase at a single time."""
        if not float(self.t_start) <= t <= float(self.t_end):
            self._check_times(np.array([t]))
        elapsed = t - self._t0
        _, theta, mode, x, v, a, since, row = self._pieces[
            :, max(bisect_right(self._starts, elapsed) - 1, 0)
        ].tolist()
        K = self._rows_of_constants[int(row)]
        tau = max(elapsed - since, 0.0)
        if v == 0.0 and a == 0.0 and not K.driven:  # at rest, whatever would grow from there
            tau = 0.0
        turn = K.Om * (tau % K.period if tau > K.period else tau)
        s_Om = sin(turn)
        c_Om = cos(turn)
        s0 = sin(theta)
        c0 = cos(theta)
        c = c0 * c_Om - s0 * s_Om
        if mode > ON_BELT:
            return x + v * tau, v, c
        E0, E1, E2, R2, I2, _, _ = basis_with_drive(tau, s_Om, c_Om, K)
        dx, dv, _ = motion(v, a, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        return x + dx, v + dv, c

    def _states(self, times: np.ndarray) -> np.ndarray:
        """Return x, v and cosine of the phase at times, (3, n).

        Many times are evaluated together, in numpy.
        """
        times = times.ravel()
        if len(times) < MANY_TIMES:
            return (
                np.array([self._state(time) for time in times.tolist()], dtype=float)
                .reshape(-1, 3)
                .T
            )
        self._check_times(times)
        states = np.empty((3, len(times)))
        for begin in range(0, len(times), TIMES_TOGETHER):
            part = slice(begin, begin + TIMES_TOGETHER)
            elapsed = times[part] - self._t0
            pieces = self._pieces_at(elapsed)
            if len(self._rows_of_constants) == 1:
                states[:, part] = self._states_together(elapsed, pieces, 0)
                continue
            rows = self._pieces[BAND_ROW, pieces]
            for row in np.unique(rows):
                here = np.flatnonzero(rows == row)
                states[:, begin + here] = self._states_together(
                    elapsed[here], pieces[here], int(row)
                )
        return states

    def _states_together(self, elapsed: np.ndarray, pieces: np.ndarray, row: int) -> np.ndarray:
        """Return x, v and cosine of the phase, (3, n), at times since t0 in pieces with the
        constants number `row`.
        """
        K = self._rows_of_constants[row]
        own = column_functions()
        sine_cosine = own["sine_cosine"]
        _, theta, mode, x, v, a, since, _ = self._pieces[:, pieces]
        tau = np.maximum(elapsed - since, 0.0)
        if not K.driven:
            tau[(v == 0.0) & (a == 0.0)] = 0.0
        s0, c0 = sine_cosine(theta)
        drive = sine_cosine(K.Om * np.where(tau > K.period, tau % K.period, tau))
        E0, E1, E2, R2, I2, s_Om, c_Om = own["basis_with_drive"](tau, *drive, K)
        dx, dv, _ = motion(v, a, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        held = mode > ON_BELT
        return np.stack(
            (
                x + np.where(held, v * tau, dx),
                v + np.where(held, 0.0, dv),
                c0 * c_Om - s0 * s_Om,
            )
        )

    @public
    def samples(self, times: int | ArrayLike) -> MotionSamples:
        """Return the motion at `times` as a table with columns t, x, v and mode.

        Parameters
        ----------
        times : int or sequence of numbers
            How many evenly spaced times, from the start to the end, or the times themselves.

        Returns
        -------
        MotionSamples
            In doubles; ``.to_csv(path)`` writes it, ``.to_pandas()`` converts it.

        Raises
        ------
        ParameterError
            If a time is outside [t_start, t_end].

        Examples
        --------
        >>> from symosc import simulate
        >>> simulate("fig5", t_end=2).samples([0.5, 1]).mode.tolist()
        ['belt1', 'belt1']
        """
        require(WHOLE, ROWS, times=times)
        if WHOLE.takes(times):
            chosen = even_samples(times, float(self.t_start), float(self.t_end))
        else:
            chosen = read_times(times, "times")
        if chosen.ndim != 1:
            given = f"an array of shape {chosen.shape}"
            raise ParameterError("times", given, "must be one row of times, or how many")
        x, v = self(chosen)
        return MotionSamples(chosen, x, v, np.asarray(self.mode(chosen), dtype=str))

    def table(self) -> list[dict[str, Any]]:
        """Return the events as rows of plain values.

        With ``digits=`` the numbers t, x, v and theta are text of that many digits, since programs
        that read numbers round them to doubles (RFC 7493 recommends text in JSON). In double
        precision they are floats.
        """
        return [
            {name: self._plain(getattr(event, name)) for name in EVENT_COLUMNS}
            for event in self.events
        ]

    def _plain(self, value: Any) -> Any:
        """Return a number as it is if it is an int, a float or text, else as text with all digits."""
        if isinstance(value, (int, float, str)):
            return value
        return value.context.nstr(value, self.digits)

    @public
    def to_csv(self, path: str | Path) -> None:
        """Write the events as CSV with a header ("-": to standard output).

        OutputError if it cannot be written.
        """
        write_csv(path, EVENT_COLUMNS, (row.values() for row in self.table()))

    def to_pandas(self) -> Any:
        """Return the events as a DataFrame, a row each.

        MissingExtraError if pandas is not installed.
        """
        return imported("pandas").DataFrame(self.table(), columns=list(EVENT_COLUMNS))

    def to_xarray(self) -> Any:
        """Return the events as a Dataset over `event`.

        MissingExtraError if xarray is not installed.
        """
        rows = self.table()
        columns = dict[str, Any]()
        for name in EVENT_COLUMNS:
            if self.digits and name in EXACT_COLUMNS:
                kind: type = str
            else:
                kind = COLUMN_TYPES[name]
            columns[name] = ("event",), np.array([row[name] for row in rows], dtype=kind)
        about = {"status": self.status, "message": self.message, "word": " ".join(self.word)}
        return imported("xarray").Dataset(columns, attrs=about | self.parameters.as_dict())

    def to_scipy(self) -> Any:
        """Return the motion as the OdeResult of ``scipy.integrate.solve_ivp``, in doubles.

        t and y are times and states at the start, the events and the end; `sol` is this trajectory;
        t_events and y_events have the events on belt 1, then those on belt 2, and so on.
        """
        from scipy.optimize import OptimizeResult  # what scipy's OdeResult is, loaded in less time

        times = np.array(
            [float(t) for t in (self.t_start, *(event.t for event in self.events), self.t_end)]
        )
        belts = [
            np.array([float(event.t) for event in self.events if event.boundary == belt])
            for belt in range(1, len(self.parameters.law.belts) + 1)
        ]
        states = [self(t).T.astype(float) if len(t) else np.empty((0, 2)) for t in belts]
        success = self.status in ("t_end", "equilibrium")
        about = {
            "status": 0 if success else -1,
            "message": self.message,
            "success": success,
            "nfev": 0,
        }
        y = np.asarray(self(times), dtype=float)
        return OptimizeResult(
            t=times, y=y, sol=self, t_events=belts, y_events=states, njev=0, nlu=0, **about
        )

    def as_dict(self) -> dict[str, Any]:
        """Return parameters, status and events as plain values.

        Parameters are text that reads back exactly. With ``digits=`` the numbers of the motion are
        text too, see `table`; the entry "digits" says so.
        """
        return {
            "parameters": self.parameters.as_dict(),
            "t_start": self._plain(self.t_start),
            "t_end": self._plain(self.t_end),
            "status": self.status,
            "message": self.message,
            "digits": self.digits,
            "word": self.word,
            "events": self.table(),
        }

    @public
    def to_json(self, path: str | Path) -> None:
        """Write what `as_dict` returns as JSON ("-": to standard output).

        OutputError if it cannot be written.
        """
        write_text(path, json.dumps(self.as_dict(), indent=1) + "\n")

    def __eq__(self, other: object) -> bool:
        """Whether both are the same motion: parameters, digits, status, events, segments and dense
        output.
        """
        if not isinstance(other, Trajectory):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self) -> int:
        return hash(
            (self.parameters, self.digits, self.status, float(self.t_end), self._pieces.shape[1])
        )

    def _content(self) -> tuple[Any, ...]:
        """Return what must be equal in equal trajectories: parameters, status, events, segments and
        pieces.
        """
        about = self.parameters, self.digits, self.status, self.message
        return *about, self.events, self.segments, self._pieces.tolist()

    def __repr__(self) -> str:
        span = f"t = {float(self.t_start):g} … {float(self.t_end):g}"
        return f"<Trajectory {span}, {len(self.events)} events: {self.status}>"


def read_times(t: Any, name: str = "t") -> np.ndarray:
    """Return times as floats, in their given shape.

    Messages call the argument `name`.
    """
    unmasked(name, t)
    try:
        times = np.asarray(t)
    except ValueError:  # rows of several lengths
        times = np.asarray(t, dtype=object)
    if times.dtype.kind in "iuf":
        return times.astype(float)
    numbers = [float(read_exact(name, time)) for time in times.ravel().tolist()]
    return np.array(numbers, dtype=float).reshape(times.shape)


class MovedTrajectory(Trajectory):
    """The motion of another model: the motion of symosc's oscillator, converted to the coordinates
    of the model.

    Attributes
    ----------
    model : OtherModel
    reduced : Trajectory
        The motion of the oscillator to which the model is reduced, in its own coordinates.

    Examples
    --------
    >>> from symosc import OtherModel, simulate
    >>> motion = simulate(OtherModel(m=1, k=1, Omega="3/2", FN="1/2", Y=1, joined=True), t_end=8)
    >>> motion(2.5).round(6).tolist(), motion.reduced(2.5).round(6).tolist()
    ([-0.627853, -0.79439], [0.192706, -1.651732])
    """

    def __init__(self, reduced: Trajectory, original: Original) -> None:
        self.model = original.model
        self.reduced = reduced
        number = number_like(reduced.t_end)
        message = f"reached t_end = {show(original.t_end)}"
        delay = number(self.model.delay)
        end = number(original.t_end)
        if reduced.status != "t_end":
            message = (
                f"{reduced.message} (of the oscillator that the model is; its time is "
                f"{float(delay):.6g} less)"
            )
            if reduced.status != "equilibrium":
                end = reduced.t_end + delay
        description = (
            reduced._pieces,
            reduced.status,
            message,
            (number(original.t0), end),
            reduced._first_at,
            reduced.digits,
        )
        super().__init__(
            reduced.parameters,
            lambda: [self._event(event) for event in reduced.events],
            *description,
        )

    def _event(self, event: Event) -> Event:
        """Return an event of the oscillator in the coordinates of the model."""
        t, x, v, theta = event_back(self.model, event.t, event.x, event.v, event.theta)
        x_error = event.x_error + float(abs(v - event.v)) * event.t_error
        return replace(event, t=t, x=x, v=v, theta=theta, x_error=x_error)

    def _times(self, t: Any) -> tuple[np.ndarray, np.ndarray]:
        """Return the times `t` and the oscillator's times, which are earlier by the model's delay."""
        times = read_times(t)
        self._check_times(times)
        ends = float(self.reduced.t_start), float(self.reduced.t_end)
        return times, np.clip(times - float(self.model.delay), *ends)

    @public
    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return [x, v] in the coordinates of the model at the times `t`."""
        require(*ARRAY_LIKE, t=t)
        times, own = self._times(t)
        return np.asarray(self.reduced(own) + np.stack(motion_of_frame(self.model, times)))

    @public
    def mode(self, t: ArrayLike) -> Any:
        """Return the mode ("Omega1" … "belt2") at a time, or an array of them.

        At an event the one that follows.
        """
        require(*ARRAY_LIKE, t=t)
        return self.reduced.mode(self._times(t)[1])

    @public
    def force(self, alpha: int, t: ArrayLike) -> Any:
        """Return F^(alpha) of eq. (9) of the oscillator: the acceleration of x relative to the
        (oscillating) belts.
        """
        require(WHOLE, alpha=alpha)
        require(*ARRAY_LIKE, t=t)
        return self.reduced.force(alpha, self._times(t)[1])

    def as_dict(self) -> dict[str, Any]:
        """Return parameters, status, events and the numbers of the model as plain values."""
        return {"model": self.model.as_dict()} | super().as_dict()

    def _content(self) -> tuple[Any, ...]:
        return self.model, *super()._content()


def belt_path(trajectory: Trajectory, boundary: int, t: np.ndarray) -> np.ndarray:
    """Return position and velocity, (2, n), of a point of a belt at times `t`, in the trajectory's
    coordinates.
    """
    speed = float(trajectory.parameters.belt(boundary))
    path = np.stack([speed * t, np.full(t.shape, speed)])
    if isinstance(trajectory, MovedTrajectory):
        return path + np.stack(motion_of_frame(trajectory.model, t))
    return path
