"""How far the times of a solution's events may be off."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin, sqrt

import numpy as np

from symosc.crosschecks.bands import BELT_OF, DOMAIN_CODES, DOMAIN_OF, MODES, STICK_CODES
from symosc.crosschecks.events import CODES
from symosc.crosschecks.steps import ExactSteps
from symosc.engine.flow import derivatives
from symosc.engine.next_event import passing_time
from symosc.kernels._generated import acceleration
from symosc.simulation.trajectory import Event, Trajectory

# Times are estimated from the leading derivatives: twice that is surely enough.
REACH_SAFETY = 2.0


@dataclass(frozen=True)
class TimeTolerances:
    """How far the times of events may be from the exact ones, as the errors of the samples allow.

    Attributes
    ----------
    steps : ExactSteps
    errors : (n, 2) array
        Allowed errors of the samples in x and v.
    allowed_v : float
        The tolerance as a velocity.
    tolerance : float
    listed : (m,) array
        Rounding of the times of a list.
    """

    steps: ExactSteps
    errors: np.ndarray
    allowed_v: float
    tolerance: float
    listed: np.ndarray

    def of_event(self, event: Event) -> float:
        """Return by how much a solver's time of an exact event may be off."""
        t = float(event.t)
        x = float(event.x)
        theta = float(event.theta)
        return self._tolerance(t, x, theta, event.boundary, MODES[event.source])

    def of_row(self, row: int) -> float:
        """Return by how much a solver's time of the exact event in one `row` of `steps.events` may
        be off.
        """
        events = self.steps.events
        step = int(events.step[row])
        boundary = int(events.boundary[row])
        is_first = row == 0 or events.step[row - 1] != step
        if events.kind[row] == CODES["slip"]:
            source = int(STICK_CODES[boundary])
        elif is_first:
            source = self._flight(int(self.steps.first[step]))
        else:  # the mode after the event before, a flight
            source = self._flight(int(events.target[row - 1]))
        t, x, theta = (float(column[row]) for column in (events.t, events.x, events.theta))
        return self._tolerance(t, x, theta, boundary, source)

    def _flight(self, mode: int) -> int:
        """Return a mode if it is a flight, else the one in the domain above its belt."""
        belt = int(BELT_OF[mode])
        return int(DOMAIN_CODES[belt + 1]) if belt else mode

    def of_start(self, boundary: int) -> float:
        """Return how long after the first sample a solver may list its start on a belt as an
        event.
        """
        t = float(self.steps.t[0])
        x = float(self.steps.x[0])
        theta = float(self.steps.theta[0])
        return max(
            self._tolerance(t, x, theta, boundary, int(DOMAIN_CODES[domain]))
            for domain in (boundary, boundary + 1)
        )

    def of_near_graze(self, trajectory: Trajectory, time: float) -> float | None:
        """Return how long before and after a time v is within tolerance of a belt's speed.

        None if it is not.
        """
        inside = float(trajectory.t_start) <= time <= float(trajectory.t_end)
        if not inside:
            return None
        mode = MODES[trajectory.mode(time)]
        domain = int(DOMAIN_OF[mode])
        if not domain:
            return None
        x, v = (float(value) for value in trajectory(time))
        K, A = self.steps.bands.constants_at(domain, v)
        # The phase of the samples' clock does not lose digits at large times.
        step, _ = self.steps.at(time)
        theta = float(self.steps.theta[step] + K.Om * (time - self.steps.t[step]))
        a = float(acceleration(x, v, cos(theta), A, K.cm, K.w0sq, K.f0))
        b, *_ = derivatives(v, a, sin(theta), cos(theta), K)
        curvature = abs(float(b))
        _, error_v = self._spread(time)
        spread = error_v + self.allowed_v
        # Near its turn v is a parabola, a^2/(2 curvature) away from its extreme value.
        gap = float(np.min(np.abs(v - self.steps.belts)))
        is_off_belt = gap > REACH_SAFETY * spread
        is_off_turn = a * a > 2.0 * REACH_SAFETY * spread * curvature
        if curvature == 0.0 or is_off_belt or is_off_turn:
            return None
        return REACH_SAFETY * sqrt(2.0 * spread / curvature)

    def _spread(self, time: float) -> tuple[float, float]:
        """Return bounds of the errors of x and v around a time.

        The second bounds all later errors of v too.
        """
        # For the differences X, V of two motions V^2 + (k/m) X^2 never grows: an error of x may
        # become one of v.
        j = int(np.searchsorted(self.steps.t, time))
        dx, dv = (float(value) for value in np.max(self.errors[max(j - 2, 0) : j + 2], axis=0))
        return dx, sqrt(dv * dv + self.steps.K.w0sq * dx * dx)

    def _tolerance(self, time: float, x: float, theta: float, boundary: int, source: int) -> float:
        """Return how far the time of an event at x, theta and a belt may be off.

        `source` is the mode that it ends.
        """
        dx, dv = self._spread(time)
        v = float(self.steps.belts[boundary - 1])
        domain = int(DOMAIN_OF[source])
        K, A = self.steps.bands.constants_at(domain or boundary, v)
        s = sin(theta)
        c = cos(theta)
        rate = max(K.Om, sqrt(K.w0sq))
        if not domain:  # the force passes 0, with known derivatives
            error = K.w0sq * dx + rate * self.allowed_v
            slopes = -(K.w0sq * v + K.fB * s), -K.fB * K.Om * c, K.fB * K.Om * K.Om * s
        else:  # the velocity passes the belt's
            error = dv + self.allowed_v
            a = float(acceleration(x, v, c, A, K.cm, K.w0sq, K.f0))
            slopes = (a, *derivatives(v, a, s, c, K)[:2])
        passing = REACH_SAFETY * float(passing_time(error, *slopes, K))
        return passing + self.tolerance / rate + 4.0 * float(np.spacing(abs(time)))
