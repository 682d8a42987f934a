"""Return maps of motions under any friction law: from one passage through a speed to a later one.

Between the belts a speed may be chosen that an orbit passes through in a flight. A belt with this
speed and without friction is transparent, so that it changes no motion, but its passages are
events: they are located like all events, with as many digits as are asked for, and differentiated by
`symosc.sensitivities`. So a periodic orbit of any law, with stick, static friction, corners and
growing bands, is a fixed point of the map from one passage to the one after a period:

- with a drive of the map (t, x) -> (t' - periods 2 pi/Omega, x'), whose two multipliers are those of
  the orbit;
- without a drive of the map x -> x', since the time of the start does not matter. Its slope is one
  multiplier. The other is 1, for the phase.

After a stick the first map has rank 1, and the slope of the second one is 0. M - 1 is invertible all
the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import inf, pi
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Number
from symosc.base.quantities import number_of_belt
from symosc.belts import Belt
from symosc.derivatives.sensitivities import Sensitivities, sensitivities
from symosc.engine.arithmetic import mp_context
from symosc.engine.events import Event
from symosc.model import OSCILLATOR_NAMES, Model, Oscillator, too_fast_error
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

#: Samples of a motion from which a section is chosen.
SAMPLES = 1024
#: Digits of the speed of a section.
SPEED_DIGITS = 5
#: A section is at least this far from every edge of the law, as a part of the speeds there are.
CLEAR = 1e-7
#: After the time at which a passage is expected the motion is followed on, in parts of that time.
LATE = (0.03, 1.0)

#: Newton's steps at most, and how often one is halved.
MOST_STEPS = 30
MOST_HALVINGS = 6
#: In so many steps the residual has to halve.
SLOW_STEPS = 5
#: The longest step, in parts of the size of the motion and of its period.
LONGEST_STEP = 0.3
#: A step must shrink the residual by this part of what it would do if the map were linear.
GAIN = 0.1
#: Residuals, as parts of the size and the period: found, and good enough where rounding ends
#: the search.
FOUND = 1e-13
GOOD = 1e-10
#: Steps in many digits, after doubles have found the orbit.
MOST_POLISHING = 8
SPARE_DIGITS = 8


class Passage(NamedTuple):
    """A passage through a section: its time and position, and their derivatives, a row for each of
    both. `motion` has those of all events.
    """

    t: Number
    x: Number
    changes: np.ndarray
    motion: Sensitivities


@dataclass(frozen=True, eq=False)
class SpeedSection:
    """A speed through which an orbit passes in a flight, upwards or downwards.

    `law` is the oscillator as it is given. If a belt has the speed already, the passages are its
    crossings.
    """

    law: Model
    speed: Fraction
    upwards: bool

    @property
    def is_own(self) -> bool:
        """Whether a belt of the law has the speed."""
        return self.law.law.boundary_of(self.speed) != 0

    @cached_property
    def model(self) -> Model:
        """The oscillator with a transparent belt at the speed."""
        if self.is_own:
            return self.law
        shared = {name: getattr(self.law, name) for name in OSCILLATOR_NAMES}
        if not self.law.has_periods:
            shared["Omega"] = None
        return Oscillator(**shared, belts=[*belts_as_given(self.law), Belt(self.speed, 0)])

    @cached_property
    def boundary(self) -> int:
        """The number of the transparent belt."""
        return self.model.law.boundary_of(self.speed)

    def named(self, name: str) -> str:
        """Return what a number of the oscillator is called beside the transparent belt."""
        of_belt = number_of_belt(name)
        if self.is_own or of_belt is None or of_belt.belt < self.boundary:
            return name
        return str(of_belt._replace(belt=of_belt.belt + 1))

    def is_passage(self, event: Event) -> bool:
        """Return whether an event is a passage in the direction of the section."""
        if event.boundary != self.boundary or event.kind != "cross":
            return False
        return (event.target == f"Omega{self.boundary + 1}") == self.upwards

    def passages(self, motion: Trajectory) -> list[int]:
        """Return the numbers of the events of a motion that are passages."""
        return [n for n, event in enumerate(motion.events) if self.is_passage(event)]

    def motion(
        self, t: Number, x: Number, v: Number, span: float, most: int | None = None
    ) -> Trajectory:
        """Return the motion from any start for some time, with the passages as events."""
        end = float(t) + float(span)
        return simulate(self.model, t0=t, x0=x, v0=v, t_end=end, max_events=most, accuracy=inf)

    def passage(
        self,
        t: Number,
        x: Number,
        span: Number,
        wrt: tuple[str, ...] = ("t0", "x0"),
        digits: int | None = None,
    ) -> Passage | None:
        """Return the passage nearest to a time `span` after the one at t and x, with its derivatives
        by `wrt`; None if there is none near.
        """
        names = tuple(self.named(name) for name in wrt)
        expected = t + span
        for late in LATE:
            changes = sensitivities(
                self.model,
                names,
                t0=t,
                x0=x,
                v0=self.speed,
                t_end=float(expected) + late * float(span),
                digits=digits,
            )
            events = changes.trajectory.events
            passages = self.passages(changes.trajectory)
            if passages and (events[passages[-1]].t >= expected or late == LATE[-1]):
                n = min(passages, key=lambda n: abs(events[n].t - expected))
                event = events[n]
                rows = np.array([changes.dt[n], changes.dx[n]])
                return Passage(event.t, event.x, rows, changes)
        return None


def belts_as_given(model: Model) -> list[Belt]:
    """Return the belts of an oscillator."""
    if isinstance(model, Oscillator):
        return list(model.belts)
    return [Belt(belt.v, belt.mu) for belt in model.law.belts]


class Slopes(NamedTuple):
    """Samples of a motion: velocities, their slopes where it flies (else 0), and their distances from
    the speeds of the belts.
    """

    v: np.ndarray
    slopes: np.ndarray
    away: np.ndarray


def slopes_of(motion: Trajectory, span: float = inf) -> Slopes:
    """Return samples of a motion within a time from its start."""
    begin = float(motion.t_start)
    end = min(float(motion.t_end), begin + span)
    times = np.linspace(begin, end, SAMPLES)
    modes = np.asarray(motion.mode(times)).astype(str)
    _, v = motion(times)
    slopes = (v[2:] - v[:-2]) / (times[2] - times[0])
    flies = (modes[2:] == modes[:-2]) & (np.char.find(modes[1:-1], "belt") < 0)
    speeds = np.array([float(belt.v) for belt in motion.parameters.law.belts])
    away = np.abs(v[1:-1, None] - speeds).min(axis=1)
    return Slopes(v[1:-1], np.where(flies, slopes, 0.0), np.where(flies, away, 0.0))


def qualities(samples: Slopes) -> np.ndarray:
    """Return how well the velocity of each sample would do for a section, from 0 to 1."""
    _, slopes, away = samples
    steepness = np.abs(slopes) / max(np.abs(slopes).max(initial=0.0), 1e-300)
    distance = away / max(away.max(initial=0.0), 1e-300)
    return np.minimum(steepness, distance)


def quality_of(motion: Trajectory, section: SpeedSection) -> float:
    """Return how good a section of an orbit is, from 0 to 1, where its motion begins."""
    samples = slopes_of(motion)
    upwards = (samples.slopes > 0) == section.upwards
    near = np.abs(samples.v[upwards] - float(section.speed))
    if not len(near):
        return 0.0
    return float(qualities(samples)[upwards][int(near.argmin())])


def section_through(motion: Trajectory, span: float = inf) -> SpeedSection | None:
    """Return a section that a motion passes through steeply in a flight, away from the belts, within
    a time from its start; None if it never flies.

    Raise ParameterError if a belt is so fast that no speed of the motion is clear of the others.
    """
    model = motion.parameters
    samples = slopes_of(motion, span)
    v = samples.v
    # An early passage costs less than a later one that is hardly better.
    quality = qualities(samples) * np.linspace(1.0, 0.5, len(v))
    edges = np.array([float(edge.v) for edge in model.law.edges])
    fastest = float(np.abs(v).max())
    least = CLEAR * max(fastest, float(np.abs(edges).max()))
    for n in np.argsort(-quality, kind="stable").tolist():
        if quality[n] <= 0.0:
            break
        speed = _rounded_speed(float(v[n]), float(np.ptp(v)))
        if np.abs(edges - float(speed)).min() > least:
            return SpeedSection(model, speed, bool(samples.slopes[n] > 0))
    flies = bool(quality.max() > 0.0)
    if flies and CLEAR * float(np.abs(edges).max()) > fastest:
        raise too_fast_error(model)
    return None


def _rounded_speed(speed: float, size: float) -> Fraction:
    """Return a speed with few digits, so that its exact value is short."""
    digits = SPEED_DIGITS - int(np.floor(np.log10(size)))
    return Fraction(repr(round(speed, digits)))


# -- Newton's method on a return map ------------------------------------------------------------------


@dataclass(frozen=True)
class Closed:
    """A fixed point of a return map: its passage, the time after which it returns, and the
    derivatives of the map.
    """

    t: Number
    x: Number
    span: Number
    changes: np.ndarray
    residual: float
    steps: int


class Shooting:
    """The equations that a motion which starts on a section returns to its start.

    `periods` is the number of forcing periods, 0 without a drive. `size` and `pace` are the
    units of positions and times in which residuals are measured.
    """

    def __init__(self, section: SpeedSection, periods: int, size: float, pace: float) -> None:
        self.section = section
        self.periods = periods
        self.size = size
        self.pace = pace
        self.steps = 0

    def span(self, digits: int | None = None) -> Number:
        """Return the time after which the orbit closes, with a drive."""
        Omega = self.section.law.Omega
        if digits is None:
            return 2 * pi * self.periods / float(Omega)
        context = mp_context(digits)
        return 2 * context.pi * self.periods * Omega.denominator / Omega.numerator

    def residual(self, t: Number, x: Number, span: Number, end: Passage) -> tuple[Number, Number]:
        """Return by how much a motion from t and x misses its start, in time and position."""
        if not self.periods:
            return 0 * end.t, end.x - x
        return end.t - t - span, end.x - x

    def measured(self, residual: tuple[Number, Number]) -> float:
        """Return the size of a residual, in parts of the size and the pace of the motion."""
        late, off = residual
        return float(abs(late)) / self.pace + float(abs(off)) / self.size

    def step(self, end: Passage, residual: tuple[Number, Number]) -> tuple[Number, Number] | None:
        """Return Newton's step of t and x; None if the equations are singular."""
        late, off = residual
        (a, b), (c, d) = end.changes.tolist()
        if not self.periods:
            if d == 1:
                return None
            return 0 * late, off / (1 - d)
        determinant = (a - 1) * (d - 1) - b * c
        if determinant == 0:
            return None
        return (b * off - (d - 1) * late) / determinant, (c * late - (a - 1) * off) / determinant

    def solve(self, t: Number, x: Number, span: Number) -> Closed | None:
        """Return the orbit that Newton's method leads to from a passage near it, in doubles; None if
        it leads to none.
        """
        end = self.section.passage(t, x, span)
        misses = list[float]()
        for _ in range(MOST_STEPS):
            if end is None:
                return None
            self.steps += 1
            if not self.periods:
                span = end.t - t
            residual = self.residual(t, x, span, end)
            miss = self.measured(residual)
            step = self.step(end, residual)
            misses.append(miss)
            is_slow = len(misses) > SLOW_STEPS and miss > misses[-1 - SLOW_STEPS] / 2
            if miss <= FOUND or step is None or is_slow:
                break
            longest = max(abs(step[0]) / self.pace, abs(step[1]) / self.size)
            part = min(1.0, LONGEST_STEP / longest)
            for _ in range(MOST_HALVINGS):
                next_t = t + part * step[0]
                next_x = x + part * step[1]
                next_end = self.section.passage(next_t, next_x, span)
                if next_end is not None:
                    later = self.residual(next_t, next_x, span, next_end)
                    if self.measured(later) < (1 - GAIN * part) * miss:
                        break
                part /= 2
            else:
                break
            t = next_t
            x = next_x
            end = next_end
        if end is None or miss > GOOD:
            return None
        return Closed(t, x, span, end.changes, miss, self.steps)

    def polish(self, closed: Closed, digits: int) -> Closed | None:
        """Return the orbit with many digits; None if it is not found to so many."""
        context = mp_context(digits + SPARE_DIGITS)
        t = context.mpf(closed.t)
        x = context.mpf(closed.x)
        span = context.mpf(closed.span)
        if self.periods:
            span = self.span(context.dps)
        for _ in range(MOST_POLISHING):
            end = self.section.passage(t, x, span, digits=context.dps)
            if end is None:
                return None
            self.steps += 1
            if not self.periods:
                span = end.t - t
            residual = self.residual(t, x, span, end)
            miss = self.measured(residual)
            if miss < 10.0 ** (-digits - 2):
                return Closed(t, x, span, end.changes, miss, self.steps)
            step = self.step(end, residual)
            if step is None:
                return None
            t += step[0]
            x += step[1]
        return None
