"""One cycle of a settled motion: integrals and extremes over it.

The pieces of the motion are analytic; on each, cut in halves until that has converged, Legendre
polynomials through Gauss's points give the integrals and the extremes. The energies that go in and
that are lost are integrals of their own, so that their difference shows the error.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from math import inf, nan, pi, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from symosc.base.aliases import Record
from symosc.engine.arithmetic import column_functions
from symosc.engine.batch import PIECE_COLUMNS
from symosc.friction import FrictionLaw
from symosc.kernels import linear
from symosc.kernels.elementary import cos
from symosc.model import Model
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.reductions import Harmonic, OtherModel, harmonic, motion_of_belts
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Segment, Trajectory
from symosc.words import Word, of_belts

#: Gauss points of a part of a piece, and what the last coefficients of its polynomials may be: as a
#: part of the size of the motion or, where that is less, of this part of what the drive would do to
#: the mass alone, or to the spring.
POINTS = 24
CONVERGED = 1e-14
SMALL_MOTION = 1e-2
#: How often a piece is halved at most, and where halving no longer helps because rounding is all
#: that is left.
MOST_HALVES = 30
ROUNDING = 1e-10


class MotionPart(NamedTuple):
    """A part of a segment: its ends, Gauss's points and weights of an integral over it, and
    position `z` and velocity `u` of the motion at these points.
    """

    segment: Segment
    ends: tuple[float, float]
    t: np.ndarray
    weights: np.ndarray
    z: np.ndarray
    u: np.ndarray


class GaussRule(NamedTuple):
    """Points and weights of Gauss in [-1, 1], and the matrix from values there to Legendre
    coefficients.
    """

    points: np.ndarray
    weights: np.ndarray
    coefficients: np.ndarray


@cache
def _gauss() -> GaussRule:
    """Return the rule of Gauss with POINTS points."""
    # Not by legendre.leggauss: the eigenvalues that it begins with have other last bits on other
    # processors.
    points = np.array([-cos(pi * (i + 0.75) / (POINTS + 0.5)) for i in range(POINTS)])
    highest = np.append(np.zeros(POINTS), 1.0)
    slope = legendre.legder(highest)
    # Newton's method doubles the digits of the first points, the usual estimates by a cosine.
    for _ in range(6):
        points -= legendre.legval(points, highest) / legendre.legval(points, slope)
    weights = 2.0 / ((1.0 - points * points) * legendre.legval(points, slope) ** 2)
    degrees = np.arange(POINTS)
    # The coefficient of P_n is (n + 1/2) times the integral of values times P_n.
    coefficients = (degrees + 0.5)[:, None] * legendre.legvander(points, POINTS - 1).T * weights
    return GaussRule(points, weights, coefficients)


def parts(motion: Trajectory) -> Iterator[MotionPart]:
    """Yield the parts of a motion on which a polynomial through its values at Gauss's points is
    accurate.
    """
    p = motion.parameters
    (points, weights, coefficients) = _gauss()
    # Long segments are cut into parts of an angle of 2 of the faster of drive and oscillator: on
    # longer ones the polynomial would hardly ever be accurate.
    longest = 2.0 / max(float(p.Omega), sqrt(p.k / p.m))
    times = np.linspace(float(motion.t_start), float(motion.t_end), POINTS)
    forces = float(abs(p.B0) + sum(p.friction(belt) for belt in p.law.boundaries))
    least = SMALL_MOTION * np.array([forces / float(p.k), forces / float(p.m * p.Omega)])
    scale = np.maximum(np.maximum(np.abs(motion(times)).max(axis=1), least), 1e-300)  # of z and u
    for segment in motion.segments:
        begin = float(segment.t_start)
        end = float(segment.t_end)
        ends = list[float]()
        for since, until in pairwise([begin, *_corners(motion, begin, end), end]):
            ends += np.linspace(since, until, 2 + int((until - since) / longest)).tolist()
        # Ends of a part, how often it was halved, and the tail of the part that it is a half of.
        todo = [(a, b, 0, inf) for a, b in pairwise(ends) if b > a]
        while todo:
            a, b, halved, tail_before = todo.pop()
            t = np.clip(a + (b - a) * (points + 1) / 2, a, b)
            z, u = motion(t)
            last_coefficients = [
                [abs(linear.dot(row, values)) for values in (z, u)] for row in coefficients[-2:]
            ]
            tail = float((np.array(last_coefficients).max(axis=0) / scale).max())
            is_rounding = ROUNDING > tail > tail_before / 4  # halving hardly helps any more
            if tail > CONVERGED and not is_rounding and halved < MOST_HALVES:
                middle = (a + b) / 2
                todo += [(a, middle, halved + 1, tail), (middle, b, halved + 1, tail)]
            else:
                yield MotionPart(segment, (a, b), t, weights * (b - a) / 2, z, u)


def _corners(motion: Trajectory, begin: float, end: float) -> list[float]:
    """Return the times between `begin` and `end` at which a motion passes corners of its law."""
    if motion.parameters.law.is_plain:
        return []
    elapsed = motion._pieces[PIECE_COLUMNS.index("elapsed")]
    times = float(motion.t_start) + elapsed
    inside = (times > begin) & (times < end)
    corners: list[float] = times[inside].tolist()
    return corners


class _BeltFriction:
    """The kinetic friction of one belt, over velocities between two edges of the law."""

    def __init__(self, law: FrictionLaw, belt: int) -> None:
        self.speed = float(law.belts[belt - 1].v)
        FN = law.FN
        #: Where straight pieces begin, their forces at w = 0, and their slopes.
        self._lines = [
            (float(line.begin), float(line.mu * FN), float(line.slope * FN))
            for line in law.lines[belt - 1]
        ]

    def force(self, u: np.ndarray) -> np.ndarray | float:
        """Return the friction at velocities that are all in one band."""
        w = np.abs(u - self.speed)
        middle = float(w.mean())
        _, force, slope = next(line for line in reversed(self._lines) if line[0] <= middle)
        if slope == 0.0:
            return force
        return force + slope * w


def turning_points(values: np.ndarray) -> np.ndarray:
    """Return where in [-1, 1] a function may have extremes, given its values at Gauss's points.

    These are the two ends, and the turning points of the polynomial that goes through the values.
    """
    series = linear.product(_gauss().coefficients, values)
    slope = legendre.legder(legendre.legtrim(series, CONVERGED * np.abs(series).max()))
    # The polynomial bends too little for two turning points between neighbours of these to matter.
    grid = np.linspace(-1.0, 1.0, 8 * POINTS + 1)
    slopes = legendre.legval(grid, slope)
    turns = np.flatnonzero((slopes[:-1] > 0.0) != (slopes[1:] > 0.0))
    low = grid[turns]
    high = grid[turns + 1]
    # Where the straight line between both slopes is 0; Newton's method starts there.
    inside = low + (high - low) * slopes[turns] / (slopes[turns] - slopes[turns + 1])
    bend = legendre.legder(slope)
    for _ in range(4 if len(turns) else 0):  # Newton's method doubles the digits
        with np.errstate(divide="ignore", invalid="ignore"):
            change = legendre.legval(inside, slope) / legendre.legval(inside, bend)
        inside = np.clip(np.where(np.isfinite(change), inside - change, inside), low, high)
    return np.concatenate([[-1.0, 1.0], inside])


def _heat(friction: np.ndarray | float, weights: np.ndarray, slips: np.ndarray) -> float:
    """Return the energy that a belt takes while the mass slips on it in one direction."""
    if isinstance(friction, np.ndarray):
        return float(abs(linear.dot(weights * friction, slips)))
    return float(friction * abs(linear.dot(weights, slips)))


class _Cycle:
    """Integrals and extremes over one cycle of the settled motion, whose parts are added one after
    the other.
    """

    def __init__(self, model: OtherModel, p: Model) -> None:
        self.model = model
        self.reduced = p
        self.belts = [_BeltFriction(p.law, belt) for belt in p.law.boundaries]
        self.turns = list[np.ndarray]()  # times at which x may be extreme
        self.base_forces = list[float]()  # extremes of the force that the mass passes on
        self.first_harmonic = 0j  # the integral of x exp(-i Omega t)
        self.damper = 0.0  # energy that the damper takes
        self.work = 0.0  # energy that the drive puts in
        self.heat = 0.0  # energy that friction takes
        self.stuck = 0.0  # time on a belt

    def add(self, part: MotionPart) -> None:
        """Add a part of the motion."""
        segment, (begin, end), t, weights, z, u = part
        model = self.model
        belts = [(belt.force(u), belt.speed) for belt in self.belts]
        m, c, k = (float(number) for number in (model.m, model.c, model.k))
        Omega = float(model.Omega)
        delay = float(model.delay)
        columns = column_functions()
        c_late = columns["cos"](Omega * (t + delay))
        s_late = columns["sin"](Omega * (t + delay))
        shift_rate = model.shift.rate(model.Omega)
        base_rate = model.base.rate(model.Omega)
        w, w_rate, w_second = (
            wave.at(c_late, s_late)
            for wave in (model.shift, shift_rate, shift_rate.rate(model.Omega))
        )
        y, y_rate = (wave.at(c_late, s_late) for wave in (model.base, base_rate))
        force = model.force.at(c_late, s_late)
        # z and u are relative to the belts, which move by w; x and v are in the fixed frame.
        x = z + w
        v = u + w_rate
        # All forces but friction.
        drive = float(self.reduced.B0) * columns["cos"](Omega * t)
        driven = float(self.reduced.A0) + drive - c * u - k * z
        pulls = [
            np.full(POINTS, friction * (-1 if u.mean() > speed else 1)) for friction, speed in belts
        ]
        if segment.mode.startswith("belt"):
            # The belt that holds the mass balances all other forces.
            held = int(segment.mode.removeprefix("belt"))
            others = [pull for belt, pull in enumerate(pulls, 1) if belt != held]
            pulls[held - 1] = -driven - sum(others)
            self.stuck += end - begin
        acceleration = (driven + sum(pulls)) / m
        # On a belt u is its speed, and it takes nothing.
        self.heat += sum(_heat(friction, weights, u - speed) for friction, speed in belts)
        self.damper += c * linear.dot(weights, (v - y_rate) ** 2)
        # The power of the force and of the base, then that of the belts.
        pushed = force * v + (k * (y - x) + c * (y_rate - v)) * y_rate
        drawn = sum(pull * (speed + w_rate) for pull, (_, speed) in zip(pulls, belts, strict=True))
        self.work += linear.dot(weights, pushed + drawn)
        self.first_harmonic += complex(
            linear.dot(weights, x * c_late), -linear.dot(weights, x * s_late)
        )
        self.turns.append(begin + (end - begin) * (turning_points(x) + 1) / 2)
        felt = force - m * (acceleration + w_second)
        series = linear.product(_gauss().coefficients, felt)
        self.base_forces += legendre.legval(turning_points(felt), series).tolist()


def cycle_response(
    model: OtherModel, p: Model, start: tuple[Any, Any, Any], orbit: PeriodicOrbit | None
) -> Record:
    """Return the columns of a response from one cycle of the settled motion of a model through
    `start` (on `orbit`, if any).

    `p` is the oscillator that the model is.
    """
    Omega = float(model.Omega)
    if orbit:
        n = orbit.periods
    else:
        n = 1
    period = 2 * pi * n / Omega
    (t0, x0, v0) = start
    motion = simulate(p, t0=t0, x0=x0, v0=v0, t_end=float(t0) + period)
    if motion.status == "undecidable":
        raise unsettled(motion.message)
    cycle = _Cycle(model, p)
    for part in parts(motion):
        cycle.add(part)
    times = np.clip(np.concatenate(cycle.turns), float(motion.t_start), float(motion.t_end))
    z_extremes, _ = motion(times)
    belt_positions, *_ = motion_of_belts(model, times + float(model.delay))
    amplitude = float(np.ptp(z_extremes + belt_positions)) / 2
    first = cycle.first_harmonic * (2 / period)
    excitation = phasor(_excitation(model))
    Y = abs(float(model.Y))
    B0 = abs(float(model.B0))
    ends = motion([motion.t_start, motion.t_end])
    state_at_start, state_at_end = ends.T
    closure = np.abs(state_at_start - state_at_end) / [1, Omega]
    if orbit:
        multiplier = max(abs(complex(value)) for value in orbit.multipliers)
    else:
        multiplier = 0.0
    transmissibility = nan
    if Y:
        transmissibility = amplitude / Y
    elif B0:
        transmissibility = float(np.ptp(cycle.base_forces)) / 2 / B0
    # How far the start is off the orbit: by the gap after this cycle and, times the multiplier each
    # time, after all later ones, which is a geometric series.
    start_error = float(closure.max()) / max(1 - multiplier, CONVERGED)
    return {
        "word": _word(model, orbit) if orbit else "",
        "amplitude": amplitude,
        "transmissibility": transmissibility,
        "phase": phase(excitation / first) if abs(first) > CONVERGED * abs(excitation) else nan,
        "harmonic": abs(first),
        "work": cycle.work / n,
        "dissipated": (cycle.damper + cycle.heat) / n,
        "damper": cycle.damper / n,
        "friction": cycle.heat / n,
        "stuck": cycle.stuck / period,
        "error": start_error + float(np.spacing(amplitude)),
    }


def _word(model: OtherModel, orbit: PeriodicOrbit) -> str:
    """Return the word of an orbit, with the labels of the model's belts."""
    belts = len(model.oscillator.law.belts)
    return str(of_belts(Word(orbit.labels), belts).cycle)


def _excitation(model: OtherModel) -> Harmonic:
    """Return what phases refer to: the motion of the base, else the force, else the belts' speeds."""
    if model.Y:
        return model.base
    if model.B0:
        return model.force
    return harmonic(model.W, model.W_phase)


def phasor(function: Harmonic) -> complex:
    """Return the complex amplitude E of a harmonic Re(E exp(i Omega t))."""
    return complex(float(function.C), -float(function.S))


def unsettled(reason: str) -> ConvergenceError:
    """Return the error that says why there is no settled motion."""
    return ConvergenceError("", (), 1, inf, reason)
