"""How far from its exact time an event may be: as far as the tolerance and the errors of the samples can move it."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin, sqrt

import numpy as np

from symosc.crosschecks.events import CODES
from symosc.crosschecks.steps import ExactSteps
from symosc.engine.flow import derivatives
from symosc.engine.next_event import passing_time
from symosc.kernels._generated import acceleration
from symosc.model import MODE_NAMES, NEIGHBOURS
from symosc.simulation.trajectory import Event, Trajectory

MODES = {name: code for code, name in MODE_NAMES.items()}
# Times are estimated from the leading derivatives: twice that is surely enough.
REACH_SAFETY = 2.0


@dataclass(frozen=True)
class Reach:
    """Tolerances of event times.

    Attributes
    ----------
    steps : ExactSteps
    errors : (n, 2) array
        Sizes of the samples' errors in x and v, as far as they are allowed, and of their rounding.
    allowed_v : float
        The tolerance as a velocity.
    tolerance : float
        The tolerance, relative.
    listed : array
        How far the times of a list are rounded.
    """

    steps: ExactSteps
    errors: np.ndarray
    allowed_v: float
    tolerance: float
    listed: np.ndarray

    def of(self, event: Event) -> float:
        """Return how far from its time an exact event may be."""
        t, x, theta = float(event.t), float(event.x), float(event.theta)
        return self._width(t, x, theta, event.boundary, MODES[event.source])

    def of_row(self, row: int) -> float:
        """Return how far from its time an event of `steps.events` may be."""
        events = self.steps.events
        step, boundary = int(events.step[row]), int(events.boundary[row])
        starts = row == 0 or events.step[row - 1] != step
        source = int(self.steps.first[step] if starts else events.target[row - 1])
        source = 3 + boundary if events.kind[row] == CODES["slip"] else min(source, 3)
        return self._width(float(events.t[row]), float(events.x[row]), float(events.theta[row]), boundary, source)

    def of_start(self, boundary: int) -> float:
        """Return how far from the first sample a solver may see its start on a belt."""
        t, x, theta = float(self.steps.t[0]), float(self.steps.x[0]), float(self.steps.theta[0])
        return max(self._width(t, x, theta, boundary, domain) for domain in NEIGHBOURS[boundary])

    def of_touch(self, trajectory: Trajectory, time: float) -> float | None:
        """Return how long the exact motion is nearly touching a belt at a time, or None if it is not."""
        if not float(trajectory.t_start) <= time <= float(trajectory.t_end):
            return None
        K, mode = self.steps.K, MODES[trajectory.mode(time)]
        if mode > 3:
            return None
        x, v = (float(value) for value in trajectory(time))
        # The phase of the samples' clock, which does not lose digits at large times.
        theta = self._phase(time)
        a = self._acceleration(x, v, theta, mode)
        b = float(derivatives(v, a, sin(theta), cos(theta), K)[0])
        spread = self._spread(time)[1] + self.allowed_v
        gap = min(abs(v - belt.v) for belt in (K.belt1, K.belt2))
        if b == 0.0 or gap > REACH_SAFETY * spread or a * a > 2.0 * REACH_SAFETY * spread * abs(b):
            return None
        return REACH_SAFETY * sqrt(2.0 * spread / abs(b))

    def _phase(self, time: float) -> float:
        step = self.steps.at(time)[0]
        return float(self.steps.theta[step] + self.steps.K.Om * (time - self.steps.t[step]))

    def _acceleration(self, x: float, v: float, theta: float, domain: int) -> float:
        K = self.steps.K
        return float(acceleration(x, v, cos(theta), (K.A1, K.A2, K.A3)[domain - 1], K.cm, K.w0sq, K.f0))

    def _spread(self, time: float) -> tuple[float, float]:
        """Return how far x and v of the samples may be off at a time: in a flight neither outgrows its energy."""
        j = int(np.searchsorted(self.steps.t, time))
        dx, dv = (float(value) for value in np.max(self.errors[max(j - 2, 0) : j + 2], axis=0))
        return dx, sqrt(dv * dv + self.steps.K.w0sq * dx * dx)

    def _width(self, time: float, x: float, theta: float, boundary: int, source: int) -> float:
        K, (dx, dv) = self.steps.K, self._spread(time)
        v, s, c = (K.belt1, K.belt2)[boundary - 1].v, sin(theta), cos(theta)
        rate = max(K.Om, sqrt(K.w0sq))
        if source > 3:  # the force passes 0, with known derivatives
            error = K.w0sq * dx + rate * self.allowed_v
            slopes = -(K.w0sq * v + K.fB * s), -K.fB * K.Om * c, K.fB * K.Om * K.Om * s
        else:  # the velocity passes the belt's
            error, a = dv + self.allowed_v, self._acceleration(x, v, theta, source)
            slopes = (a, *derivatives(v, a, s, c, K)[:2])
        return (
            REACH_SAFETY * float(passing_time(error, *slopes, K))
            + self.tolerance / rate
            + 4.0 * float(np.spacing(abs(time)))
        )
