"""Where a solution and the exact motion move apart although both are right.

With static friction errors may grow: a slip begins with a jump of the acceleration, and an error of
x decides when, or whether a belt holds the mass at all. So they may where friction falls with the
velocity more steeply than the damper grows. Motions may be chaotic, and no solver stays
near the exact motion for long. So a sample that is too far from the exact motion is no fault by
itself. It is none if exact motions that begin as near to an earlier sample as the exact motion does
move apart as far: then the exact motion from that sample takes the place of the one before. Errors
that only add up from step to step are no such case, and remain a fault.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp
from typing import NamedTuple, Protocol

import numpy as np

from symosc.base.aliases import Record
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.steps import BOX_POINTS, ExactSteps, has_static, least_damping
from symosc.model import Model
from symosc.scenes import STARTS
from symosc.simulation.tables import counted
from symosc.simulation.trajectory import Trajectory

# Motions begin apart by at most this part of the limit; what adds up from there on is no growth.
GROWN_FROM = 1 / 8
# An error is explained by growth if neighbours are apart by this part of it.
EXPLAINED = 1 / 2
# From an error that is right in a single step to one beyond the limit, which is so many times as
# large, no right solution gets in so few events: another decision was made where the exact motion
# touches a belt, or meets it where static friction just holds.
FAR_BEYOND = 100.0
FEW_EVENTS = 2
LARGEST_EXPONENT = 700.0


class Separation(NamedTuple):
    """A sample from which the exact motion is begun again, and a time before it that lies between
    two events of the motion before.
    """

    sample: int
    start: Record
    until: float


class Task(Protocol):
    """What is asked of a `CheckTask`."""

    @property
    def samples(self) -> Samples:
        """The samples."""
        ...

    @property
    def tolerance(self) -> float:
        """The tolerance of a step."""
        ...

    def motion(self, t_end: float, start: Record) -> Trajectory:
        """Return the exact motion from a start."""
        ...


class Compared(Protocol):
    """What is asked of a `Comparison`."""

    loose: np.ndarray
    scales: np.ndarray
    errors: np.ndarray
    limits: np.ndarray
    steps: ExactSteps

    @property
    def task(self) -> Task:
        """What is judged."""
        ...


def separation_at(
    compared: Compared, motion: Trajectory, since: int, beyond: int
) -> Separation | None:
    """Return from where neighbours of the exact `motion` move apart as far as the sample number
    `beyond` is from it.

    None if they do not. The motion counts from sample number `since` on.
    """
    rest = compared.limits - compared.loose
    is_near = np.all(np.abs(compared.errors) <= compared.loose + GROWN_FROM * rest, axis=1)
    near = np.flatnonzero(is_near[since:beyond]) + since
    if not len(near):
        return None
    j = int(near[-1])
    samples = compared.task.samples
    error = np.abs(compared.errors)
    # Up to the last of these samples the solution was as near as a single step has to be.
    exact = compared.loose + compared.task.tolerance * compared.scales
    last_exact = near[np.all(error <= exact, axis=1)[near]]
    if len(last_exact):
        i = int(last_exact[-1])
        events = [e for e in motion.events if samples.t[i] < e.t <= samples.t[beyond]]
        grown = _growth(compared.steps.parameters, float(samples.t[beyond] - samples.t[i]))
        far = np.any(compared.limits[i] >= FAR_BEYOND * grown * exact[i])
        if far and len(events) <= FEW_EVENTS:
            return None
    begin = float(samples.t[j])
    end = float(samples.t[beyond])
    box = error[j] + compared.loose[j] + compared.task.tolerance * compared.scales
    speeds = compared.steps.belts
    on = int(compared.steps.on[j])
    v = float(speeds[on - 1]) if on else float(samples.v[j])
    start = dict(zip(STARTS, (begin, float(samples.x[j]), v), strict=True))
    own = compared.task.motion(end, start)
    if float(own.t_end) < end:
        return None
    walls = compared.steps.bands.walls
    domain = int(np.sum(v > speeds))
    states = [motion(min(end, float(motion.t_end)))]
    for along_x, along_v in BOX_POINTS:
        moved = v if on else float(np.clip(v + along_v * box[1], walls[domain], walls[domain + 1]))
        numbers = (begin, float(samples.x[j] + along_x * box[0]), moved)
        neighbour = compared.task.motion(end, dict(zip(STARTS, numbers, strict=True)))
        if float(neighbour.t_end) >= end:
            states.append(neighbour(end))
    apart = np.max(np.abs(np.array(states, dtype=float) - np.asarray(own(end))), axis=0)
    if np.any(EXPLAINED * error[beyond] > np.maximum(apart, EXPLAINED * compared.limits[beyond])):
        return None
    return Separation(j, start, _between_events(motion, begin))


def _growth(p: Model, time: float) -> float:
    """Return by how much friction that falls with the velocity can make an error grow in a time."""
    least = float(least_damping(p) / p.m)
    return exp(min(-least * time, LARGEST_EXPONENT)) if least < 0.0 else 1.0


def _between_events(motion: Trajectory, time: float) -> float:
    """Return a time up to `time` in the middle between two events."""
    before = [float(motion.t_start), *(float(e.t) for e in motion.events if float(e.t) <= time)]
    if len(before) == 1:
        return time
    return 0.5 * (before[-2] + before[-1])


def separation_note(p: Model, separations: Sequence[Separation], until: float) -> str:
    """Return what is to be said of solutions that move away from the exact motion."""
    reasons = []
    if has_static(p):
        reasons.append("static friction")
    if least_damping(p) < 0:
        reasons.append("friction that falls with the speed")
    verb = "drives" if len(reasons) == 1 else "drive"
    first = separations[0].start["t0"]
    count = counted(len(separations), "time")
    return (
        f"{' and '.join(reasons)} {verb} neighbouring motions apart: from t = {first:.10g} on the solution "
        f"is compared with the exact motion from one of its own samples ({count}); every step is "
        f"judged, events in the whole only up to t = {until:.10g}"
    )
