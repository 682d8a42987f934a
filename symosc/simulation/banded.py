"""Derivatives of motions whose friction law has a band of velocities between any two edges.

A motion consists of pieces (`symosc.engine.batch.PIECE_COLUMNS`), each in one band or on a belt. The
end of a flight is a function of its launch and of the numbers m, c, k, A, B0 and Omega of its band;
the partial derivatives are those of `symosc.engine.tangent`, computed for all pieces of a band at
once. From piece to piece they follow one another:

- at a corner, and between two searches, the force is continuous: the state at a fixed time has the
  same derivatives on both sides, whether the corner moves or is touched only;
- at a belt the next piece is launched at another time. `symosc.engine.tangent` has the derivatives
  of this time, for a contact and for the end of a stick.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf, log, nan, pi
from typing import Any

import numpy as np

from symosc.base.aliases import Number
from symosc.engine import tangent
from symosc.engine.arithmetic import many_digits
from symosc.engine.batch import PIECE_COLUMNS
from symosc.engine.flow import belt_at, drag
from symosc.engine.start import Start
from symosc.engine.state import GRAZE, MIDDLE, ON_BELT, SLIP, STICK
from symosc.engine.tangent import (
    A0,
    BY_V,
    DT,
    END_V,
    END_X,
    OMEGA,
    SIZE,
    T0,
    LaunchPoint,
    Letters,
)
from symosc.kernels._generated import acceleration
from symosc.simulation.law_gradients import LOCAL_CODES, law_gradients
from symosc.simulation.motion_columns import (
    LEAST_EVENTS,
    MotionColumns,
    both_exponents,
    cuts_of_parts,
    error_of_mean,
)
from symosc.simulation.tangents import columns_of, is_deep, work_space
from symosc.simulation.trajectory import Trajectory

#: Why a derivative does not exist, beside the reasons of `symosc.engine.tangent`: a corner of
#: another belt's friction is where a force decides about the end of a stick.
CORNER_ON_BELT = 1 + tangent.NO_FORCE
#: Newton's steps to the time of a corner in many digits, at most: doubles know it to 15 of them.
MOST_STEPS = 20
#: The derivatives of t, x and v where a piece is launched.
LAUNCH = 3


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the matrix product a b, added in order: the same bits on every processor."""
    total: np.ndarray = a[..., 0, None] * b[0]
    for n in range(1, len(b)):
        total = total + a[..., n, None] * b[n]
    return total


@dataclass(eq=False)
class Propagated:
    """The derivatives along a motion: of its events, and of t, x, v where its pieces are launched.

    `launched` is (pieces, 3, wrt). `grown` has for each event the logarithm by which derivatives
    up to there have been scaled, and at the end that for the whole motion; `volume` is the
    logarithm of the factor of areas.
    """

    dt: np.ndarray
    dx: np.ndarray
    marks: np.ndarray
    reasons: np.ndarray
    launched: list[np.ndarray]
    grown: list[float]
    volume: float


class BandedColumns(MotionColumns):
    """A motion through bands, with its pieces as columns of doubles or mpmath numbers.

    Its methods compute all derivatives.
    """

    # For each piece: `modes` and `bands`, codes and numbers of rows; `since`, the time since t0, and
    # `thetas`, `xs`, `vs` there; `spans`, how long it lasts, of all but the last. `events` has the
    # number of the event with which a piece begins, -1 for none.

    def __init__(self, trajectory: Trajectory, start: Start) -> None:
        super().__init__(trajectory)
        law = trajectory.parameters.law
        self.start = start
        number = self.numbers.number
        self.t0 = number(start.t0)
        rows = columns_of(trajectory.rows())
        self.kinds, self.boundaries, _ = (column.tolist() for column in rows[4:])
        by_name = dict(zip(PIECE_COLUMNS, trajectory._pieces, strict=True))
        self.modes = by_name["mode"].astype(int)
        self.bands = by_name["row"].astype(int)
        self.events = self._events_of_pieces(by_name, rows)
        if self.context:
            self._many_digits(by_name["elapsed"])
        else:
            self.since = by_name["elapsed"]
            self.thetas = by_name["theta"]
            self.xs = by_name["x"]
            self.vs = by_name["v"]
            turns = 2 * pi * np.diff(by_name["n"]) + np.diff(self.thetas)
            # The phase knows the time better than the time does.
            self.spans = turns / self.numbers.K.Om
        self.letters = Letters(
            number(trajectory.parameters.m), *map(number, map(Fraction, (0, 0, 1)))
        )
        self.edges_below = [row.below.belt if row.below else 0 for row in law.rows]
        self.edges_above = [row.above.belt if row.above else 0 for row in law.rows]
        first = self.modes[0], self.t0, self.thetas[0], self.xs[0], self.vs[0]
        self.starts = np.array([first], dtype=self.kind)

    def _events_of_pieces(
        self, pieces: dict[str, np.ndarray], rows: tuple[np.ndarray, ...]
    ) -> list[int]:
        """Return for each piece the number of the event with which it begins, -1 for none."""
        events = [-1] * len(self.modes)
        (_, _, xs, vs, *_), piece = rows, 0
        for n, event in enumerate(self.trajectory.events):
            while True:
                piece += 1
                # The same numbers, but for a rounding from many digits in between.
                near = np.isclose(pieces["x"][piece], xs[n], rtol=1e-14, atol=1e-300)
                same = near and np.isclose(pieces["v"][piece], vs[n], rtol=1e-14, atol=1e-300)
                if same and self.trajectory._mode_of_piece(piece) == event.target:
                    break
            events[piece] = n
        return events

    def _many_digits(self, elapsed: np.ndarray) -> None:
        """Compute in many digits where the pieces begin.

        At events that is known; to a corner a few of Newton's steps lead from what doubles know.
        """
        context = self.context
        first = self.numbers.number(self.start.x0), self.numbers.number(self.start.v0)
        theta, *_ = many_digits(self.trajectory.parameters, context.dps).phase(self.start.t0)
        points: list[tuple[Number, ...]] = [(context.mpf(0), context.convert(theta), *first)]
        events = self.trajectory.events
        for piece, n in enumerate(self.events[1:], 1):
            if n < 0:
                tau = context.mpf(float(elapsed[piece])) - points[-1][0]
                points.append(self._between_events(piece, tau, points[-1]))
            else:
                event = events[n]
                t, theta, x, v = map(context.mpf, (event.t, event.theta, event.x, event.v))
                points.append((t - self.t0, theta, x, v))
        columns = np.array(points, dtype=object).T
        self.since, self.thetas, self.xs, self.vs = columns
        self.spans = np.diff(self.since)

    def _between_events(
        self, piece: int, tau: Number, start: tuple[Number, ...]
    ) -> tuple[Number, ...]:
        """Return time, phase, x and v where a piece begins that begins with no event: about `tau`
        after the `start` of the piece before.
        """
        since, theta, x, v = start
        band = self.bands[piece - 1]
        K = self.arithmetic(band).K
        if self.modes[piece - 1] > ON_BELT:
            return since + tau, theta + K.Om * tau, x + v * tau, v
        goes = self.bands[piece] - band
        for _ in range(MOST_STEPS if goes else 0):
            _, speed, force = self._flown(band, theta, x, v, tau)
            step = (speed - belt_at(1 if goes < 0 else 2, K).v) / (force or 1)
            # Next to a touch, where the time is known to less, it also matters less.
            if not abs(step) < tau * 1e-6:
                break
            tau -= step
            if abs(step) <= self.context.eps * tau:
                break
        x, v, _ = self._flown(band, theta, x, v, tau)
        return since + tau, theta + K.Om * tau, x, v

    def _flown(
        self, band: int, theta: Number, x: Number, v: Number, tau: Number
    ) -> tuple[Number, Number, Number]:
        """Return x, v and v' of a flight, `tau` after its launch at the phase `theta` with x and v."""
        K, of, _ = self.arithmetic(band)
        s = of["sin"](theta)
        c = of["cos"](theta)
        force = acceleration(x, v, c, K.A2, K.cm, K.w0sq, K.f0)
        E0, E1, E2, R2, I2, *_ = of["basis"](tau, K)
        dx, dv, force = of["motion"](v, force, s, c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        return x + dx, v + dv, force

    def _flights(
        self, pieces: np.ndarray, taus: np.ndarray, gradients: dict[int, np.ndarray]
    ) -> np.ndarray:
        """Return for flights, `taus` after the launches of `pieces`, the derivatives of x and v by
        t, x and v there, and by the numbers of their bands.

        The result is (2, pieces, 3 + 6), in the order of LOCAL_CODES. Of the six those are computed
        by which `gradients` are not all 0.
        """
        number = self.numbers.number
        used = [
            n
            for n in range(len(LOCAL_CODES))
            if any((rows[n] != 0).any() for rows in gradients.values())
        ]
        codes = np.array([T0] * LAUNCH + [LOCAL_CODES[n] for n in used], dtype=np.int64)
        launched = np.zeros((LAUNCH, 1, len(codes)), self.kind)
        for n in range(LAUNCH):
            launched[n, 0, n] = number(Fraction(1))
        result = np.zeros((2, len(pieces), LAUNCH + len(LOCAL_CODES)), self.kind)
        columns = [*range(LAUNCH), *(LAUNCH + n for n in used)]
        letters = np.array([self.letters], dtype=self.kind)
        for band in np.unique(self.bands[pieces]):
            here = np.flatnonzero(self.bands[pieces] == band)
            of_band = pieces[here]
            zeros = np.zeros(len(here), self.kind)
            modes = np.full(len(here), MIDDLE)
            starts = np.array(
                [modes, zeros, self.thetas[of_band], self.xs[of_band], self.vs[of_band]],
                dtype=self.kind,
            ).T
            (function, table) = self.loop("changes_at", len(here), band)
            out = np.zeros((2, len(here), len(codes)), self.kind)
            each = np.repeat(launched, len(here), axis=1)
            function(
                taus[here], np.arange(len(here)), starts, each, codes, is_deep(codes), letters,
                table, out, work_space(codes, self.kind),
            )  # fmt: skip
            for n, column in enumerate(columns):
                result[:, here, column] = out[:, :, n]
        column = LOCAL_CODES.index(OMEGA)
        if column in used:
            # Until a flight is launched another Omega has changed the phase by the time.
            phases = self._by_phase(pieces, taus, result[:, :, 0])
            result[:, :, LAUNCH + column] += phases * (self.t0 + self.since[pieces])
        return result

    def _by_phase(self, pieces: np.ndarray, taus: np.ndarray, by_time: np.ndarray) -> np.ndarray:
        """Return the derivatives of x and v by the phase of the launch, from those by its time.

        A later launch has another phase, and moves less far.
        """
        phases = np.empty_like(by_time)
        for n, (piece, tau) in enumerate(zip(pieces.tolist(), taus, strict=True)):
            band = int(self.bands[piece])
            _, v, force = self._flown(band, self.thetas[piece], self.xs[piece], self.vs[piece], tau)
            phases[0, n] = by_time[0, n] + v
            phases[1, n] = by_time[1, n] + force
        return phases / self.numbers.K.Om

    def _belt_of_stick(self, piece: int) -> tuple[int, int]:
        """Return the belt of a stick, and at which boundary of its band it is."""
        band = self.bands[piece]
        boundary = int(self.modes[piece]) - ON_BELT
        return (self.edges_below, self.edges_above)[boundary - 1][band], boundary

    def _boundary_of(self, belt: int, band: int) -> int:
        """Return at which boundary of a band a belt is: 1 below it, 2 above it."""
        if self.edges_below[band] == belt:
            return 1
        return 2

    def event_derivatives(
        self, wrt: tuple[str, ...], count: int, first_events: int | None = None
    ) -> tuple[np.ndarray, ...]:
        """Return dt, dx, marks and reasons of all events, as for motions under a plain law."""
        done = self.propagated(wrt)
        return done.dt, done.dx, done.marks, done.reasons

    def propagated(self, wrt: tuple[str, ...], scaled: bool = False) -> Propagated:
        """Return the derivatives along the motion by `wrt`; if `scaled`, kept near 1 in size."""
        return _Propagation(self, wrt, scaled).run()

    def at_times(
        self, times: np.ndarray, wrt: tuple[str, ...], dt: np.ndarray, dx: np.ndarray
    ) -> np.ndarray:
        """Return derivatives of x, v at times with respect to `wrt`, (2, times, wrt)."""
        return self._changes_at(times, self.propagated(wrt).launched, _Gradients(self, wrt))

    def _changes_at(
        self, times: np.ndarray, launched: list[np.ndarray], gradients: _Gradients
    ) -> np.ndarray:
        """Return derivatives of x, v at `times`, from those where the pieces are launched."""
        number = self.numbers.number
        elapsed = [number(Fraction(t) - self.start.t0) for t in times.tolist()]
        since = self.since.astype(float)
        pieces = np.searchsorted(since, np.array(elapsed, dtype=float), "right") - 1
        pieces = np.maximum(pieces, 0)
        taus = np.array(elapsed, dtype=self.kind) - self.since[pieces]
        out = np.zeros((2, len(times), len(gradients.wrt)), self.kind)
        flies = self.modes[pieces] <= ON_BELT
        flights = np.flatnonzero(flies)
        blocks = self._flights(pieces[flights], taus[flights], gradients.of_bands)
        for n, i in enumerate(flights.tolist()):
            piece = int(pieces[i])
            out[:, i] = gradients.ends(blocks[:, n], launched[piece], int(self.bands[piece]))
        for i in np.flatnonzero(~flies).tolist():
            piece = int(pieces[i])
            out[:, i] = gradients.stuck(piece, taus[i], launched[piece])
        return out

    def exponents(self) -> np.ndarray:
        """Return the Lyapunov exponents over the motion, the larger one first."""
        wrt = ("x0", "v0")
        done = self.propagated(wrt, scaled=True)
        end = np.array([float(self.trajectory.t_end)])
        last = self._changes_at(end, done.launched, _Gradients(self, wrt))
        span = float(self.trajectory.t_end) - float(self.start.t0)
        tau = span - float(self.since[-1])
        if self.modes[-1] <= ON_BELT:
            volume = done.volume - float(self.arithmetic(int(self.bands[-1])).K.cm) * tau
        else:
            volume = -inf
        return both_exponents(done.grown[-1], last[:, 0], volume, span)

    def exponent_error(self) -> float:
        """Return the standard error of the first exponent, from its values in parts of the motion."""
        events = len(self.kinds)
        if events < LEAST_EVENTS:
            return nan
        grown = self.propagated(("x0", "v0"), scaled=True).grown
        cuts = cuts_of_parts(events)
        since = dict(zip(self.events, self.since, strict=True))
        return error_of_mean(
            [0.0, *(grown[end - 1] for end in cuts)], [0.0, *(since[end - 1] for end in cuts)]
        )


class _Gradients:
    """The derivatives of the numbers of all bands and belts by `wrt`, as numbers of a motion."""

    def __init__(self, motion: BandedColumns, wrt: tuple[str, ...]) -> None:
        model = motion.trajectory.parameters
        self._exact = exact = law_gradients(model, wrt)
        kind: dict[str, Any] = {"number": motion.numbers.number, "kind": motion.kind}
        self.wrt = wrt
        self.motion = motion
        self._bands = dict[int, np.ndarray]()
        self.of_bands = {band: self.of_band(band) for band in np.unique(motion.bands).tolist()}
        boundaries = model.law.boundaries
        self.speeds = {belt: exact.of_speed(belt, **kind) for belt in boundaries}
        self.excess = {belt: exact.of_excess(belt, **kind) for belt in boundaries}
        self.corners = {belt: exact.corners_at(belt) for belt in boundaries}

    def of_band(self, band: int) -> np.ndarray:
        """Return the derivatives of m, c, k, A, B0 and Omega in a band, (6, wrt)."""
        if band not in self._bands:
            self._bands[band] = self._row(band)
        return self._bands[band]

    def _row(self, band: int) -> np.ndarray:
        return self._exact.of_row(band, self.motion.numbers.number, self.motion.kind)

    def ends(self, block: np.ndarray, launched: np.ndarray, band: int) -> np.ndarray:
        """Return derivatives of x and v in a flight, from those where it is launched."""
        by_launch = product(block[:, :LAUNCH], launched)
        return by_launch + product(block[:, LAUNCH:], self.of_bands[band])

    def size(self, block: np.ndarray, launched: np.ndarray, band: int) -> np.ndarray:
        """Return the size of the terms of the derivatives of v that `ends` returns."""
        by_numbers = abs(product(block[1, LAUNCH:], self.of_bands[band]))
        return product(abs(block[1, :LAUNCH]), abs(launched)) + by_numbers

    def stuck(self, piece: int, tau: Number, launched: np.ndarray) -> np.ndarray:
        """Return derivatives of x and v in a stick, `tau` after it begins."""
        belt, _ = self.motion._belt_of_stick(piece)
        speed = self.speeds[belt]
        dt, dx, _ = launched
        return np.array([dx + speed * tau - self.motion.vs[piece] * dt, speed], self.motion.kind)


class _Propagation:
    """One run along a motion: its derivatives by `wrt`, from piece to piece."""

    def __init__(self, motion: BandedColumns, wrt: tuple[str, ...], scaled: bool) -> None:
        self.motion = motion
        self.wrt = wrt
        self.scaled = scaled
        self.gradients = _Gradients(motion, wrt)
        # No name is a number of one band: what those change comes from `gradients`.
        self.codes = np.full(len(wrt), T0)
        self.work = work_space(self.codes, motion.kind)
        events = len(motion.kinds)
        shape = (events, len(wrt))
        self.done = Propagated(
            np.zeros(shape, motion.kind),
            np.zeros(shape, motion.kind),
            np.zeros(shape, np.int8),
            np.zeros(events, np.int8),
            launched=[],
            grown=[0.0] * (events + 1),
            volume=0.0,
        )
        self.regular = [True] * len(wrt)
        # What is usual for derivatives of v in a flight is the scale of what vanishes at a graze.
        self.usual = np.zeros(len(wrt), motion.kind)

    def run(self) -> Propagated:
        """Follow the derivatives through all pieces."""
        motion = self.motion
        done = self.done
        last = len(motion.modes) - 1
        flights = np.flatnonzero(motion.modes[:last] <= ON_BELT)
        blocks = motion._flights(flights, motion.spans[flights], self.gradients.of_bands)
        block_of = dict(zip(flights.tolist(), range(len(flights)), strict=True))
        now = self._begun()
        for piece in range(last):
            done.launched.append(now)
            band = int(motion.bands[piece])
            if piece in block_of:
                block = blocks[:, block_of[piece]]
                ends = self.gradients.ends(block, now, band)
                size = self.gradients.size(block, now, band)
                done.volume -= float(motion.arithmetic(band).K.cm * motion.spans[piece])
            else:
                ends = self.gradients.stuck(piece, motion.spans[piece], now)
                size = abs(ends[1])
                done.volume = -inf
            n = motion.events[piece + 1]
            if n < 0:
                now = self._unchanged(ends)
                self.usual = np.maximum(self.usual, size)
            else:
                if motion.kinds[n] == GRAZE:
                    self._note_usual(piece, now, band)
                now = self._at_event(n, piece, ends, size)
            if self.scaled:
                now = self._scaled(now)
            if n >= 0:
                done.grown[n] = done.grown[-1]
        done.launched.append(now)
        return done

    def _unchanged(self, ends: np.ndarray) -> np.ndarray:
        """Return derivatives of x and v at a fixed time as those of a launch then."""
        return np.concatenate([np.zeros((1, len(self.wrt)), self.motion.kind), ends])

    def _scaled(self, now: np.ndarray) -> np.ndarray:
        """Return derivatives divided by the largest, and count its logarithm."""
        size = float(abs(now).max())
        if size == 0.0:
            return now
        self.done.grown[-1] += log(size)
        return now / size

    def _note_usual(self, piece: int, now: np.ndarray, band: int) -> None:
        """Take derivatives on the way to a graze into account as usual ones."""
        motion = self.motion
        tau = np.array([tangent.GOLDEN * motion.spans[piece]], dtype=motion.kind)
        of_bands = self.gradients.of_bands
        block = motion._flights(np.array([piece]), tau, of_bands)[:, 0]
        self.usual = np.maximum(self.usual, self.gradients.size(block, now, band))

    def _at_event(self, n: int, piece: int, ends: np.ndarray, size: np.ndarray) -> np.ndarray:
        """Write the derivatives of event `n` at the end of a piece; return those of what is launched
        there.
        """
        motion = self.motion
        done = self.done
        belt = motion.boundaries[n]
        kind = motion.kinds[n]
        names = range(len(self.wrt))
        point = self._point(piece + 1)
        band = int(motion.bands[piece])
        speed = self.gradients.speeds[belt]
        touched = False
        if kind == SLIP:
            band = int(motion.bands[piece + 1])
            reason = self._vanishing(belt, band, point, ends)
            corners = self.gradients.corners[belt].intersection(self.wrt)
            for name in corners:
                self.regular[self.wrt.index(name)] = False
            if corners and reason <= tangent.ROUGH:
                done.reasons[n] = CORNER_ON_BELT
        else:
            boundary = motion._boundary_of(belt, band)
            self._put(ends - np.array([0 * speed, speed]), size + abs(speed))
            if kind == GRAZE:
                touched = self._kinks(n, boundary)
                self._vanishing(belt, band, point, ends)
                reason = tangent.KINK if touched else tangent.REGULAR
            else:
                of = motion.arithmetic(band).of
                K = motion.arithmetic(band).K
                force, _ = of["force"](MIDDLE, point, K)
                reason = of["contact_times"](
                    MIDDLE, boundary, point, force, self.codes, K, self.work
                )
                if kind != STICK:
                    self._count_crossing(force, piece, point)
        if reason:
            done.reasons[n] = reason
        dt = self.work[DT, : len(self.wrt)].copy()
        dx = ends[0] + point.v * dt
        done.dt[n] = dt
        done.dx[n] = dx
        for j in names:
            self.regular[j] = self.regular[j] and reason <= tangent.ROUGH
            if not touched or done.marks[n, j] == 0:
                done.marks[n, j] = self.regular[j]
        if kind == GRAZE:
            self.usual = np.maximum(self.usual, size)
            return self._unchanged(ends)
        self.usual = np.zeros(len(self.wrt), motion.kind)
        return np.array([dt, dx, speed], dtype=motion.kind)

    def _point(self, piece: int) -> LaunchPoint:
        """Return the point where a piece begins."""
        motion = self.motion
        launch_at = motion.numbers.of["launch_at"]
        theta, x, v = motion.thetas[piece], motion.xs[piece], motion.vs[piece]
        point: LaunchPoint = launch_at(MIDDLE, motion.t0 + motion.since[piece], theta, x, v)
        return point

    def _put(self, ends: np.ndarray, size: np.ndarray) -> None:
        """Write derivatives of x and v at a fixed time, and their size, into `work`."""
        self.work[END_X, : len(self.wrt)] = ends[0]
        self.work[END_V, : len(self.wrt)] = ends[1]
        self.work[SIZE, : len(self.wrt)] = size

    def _vanishing(self, belt: int, band: int, point: LaunchPoint, ends: np.ndarray) -> int:
        """Write derivatives of the time when the force passes 0 that decides, in a band beside a
        belt, whether the belt holds the mass; return a reason.

        `ends` are those of x and v at a fixed time.
        """
        motion = self.motion
        K, of, _ = motion.arithmetic(band)
        boundary = motion._boundary_of(belt, band)
        self._put(ends, abs(ends[1]))
        reason: int = of["vanishing_times"](
            MIDDLE, boundary, point, self.codes, motion.letters, K, self.work
        )
        rate = sum(self._forces(belt, band, point))
        if reason == tangent.NO_SLOPE:
            rate = 1.0
        self.work[DT] = -self.work[SIZE] / rate
        return reason

    def _forces(self, belt: int, band: int, point: LaunchPoint) -> tuple[Number, Number]:
        """Write the derivatives of this force into row SIZE of `work`; return its rates in time, by
        the motion and by the drive.
        """
        motion = self.motion
        K, of, _ = motion.arithmetic(band)
        boundary = motion._boundary_of(belt, band)
        rates: tuple[Number, Number] = of["force_changes"](
            MIDDLE, boundary, point, self.codes, motion.letters, K, self.work
        )
        by_local = self.work[BY_V, list(LOCAL_CODES)]
        by_numbers = product(by_local, self.gradients.of_band(band))
        excess = drag(boundary, MIDDLE) * self.gradients.excess[belt]
        self.work[SIZE, : len(self.wrt)] += by_numbers + self.work[BY_V, A0] * excess
        return rates

    def _begun(self) -> np.ndarray:
        """Return the derivatives at the start, and note by which numbers none exist."""
        motion = self.motion
        now = np.zeros((LAUNCH, len(self.wrt)), motion.kind)
        for row, name in enumerate(("t0", "x0", "v0")):
            now[row] = [motion.numbers.number(Fraction(own == name)) for own in self.wrt]
        belt = motion.trajectory.parameters.law.boundary_of(motion.start.v0)
        if belt == 0:
            return now
        self.regular = [name not in ("v0", f"v{belt}") for name in self.wrt]
        point = self._point(0)
        for band in (motion.edges_above.index(belt), motion.edges_below.index(belt)):
            K, of, _ = motion.arithmetic(band)
            if not of["vanishes"](MIDDLE, motion._boundary_of(belt, band), point, K):
                continue
            self._put(np.array([now[1], 0 * now[1]], dtype=motion.kind), abs(now[1]))
            by_motion, by_drive = self._forces(belt, band, point)
            fixed = of["is_kept_in_time"](by_motion, by_drive, point, K)
            for j, name in enumerate(self.wrt):
                if self.work[SIZE, j] != 0.0 or (name == "t0" and not fixed):
                    self.regular[j] = False
        return now

    def _count_crossing(self, before: Number, piece: int, point: LaunchPoint) -> None:
        """Count by which factor areas change where a flight crosses a belt: the forces' ratio."""
        motion = self.motion
        band = int(motion.bands[piece + 1])
        after, _ = motion.arithmetic(band).of["force"](MIDDLE, point, motion.arithmetic(band).K)
        if before and after:
            self.done.volume += log(abs(float(after / before)))

    def _kinks(self, n: int, boundary: int) -> bool:
        """Mark the numbers that turn the graze `n` into a crossing or a miss; return whether any
        does.
        """
        motion = self.motion
        before = np.zeros_like(self.work)
        before[SIZE, : len(self.wrt)] = self.usual
        kinks = motion.numbers.of["kinks"]
        from_above = boundary == 1
        return bool(
            kinks(from_above, 0, self.codes, self.done.marks, n, self.regular, before, self.work)
        )
