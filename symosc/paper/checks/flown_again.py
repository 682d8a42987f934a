"""A second opinion on motions: every stretch is flown again by another closed form, and every switch decided anew.

Nothing of the engine is used here but its answer: the flow is that of `linear_flow`, in doubles, the forces are those
of (9), and what follows a contact is Theorems 4 and 5.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import wraps
from typing import NamedTuple

import numpy as np

from symosc.model import NEIGHBOURS, Parameters
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.paper.checks import contacts
from symosc.paper.checks.linear_flow import flow
from symosc.paper.evidence import UNDECIDED, Evidence
from symosc.simulation.trajectory import Trajectory
from symosc.words import MAPS

#: What two closed forms may differ by in doubles, relative to the size of the motion.
AGREEMENT = 1e-9
SAMPLES = 101


class FlownPiece(NamedTuple):
    """A motion in one domain (1 to 3) or on one belt (-1, -2), from a state to the next contact."""

    where: int
    start: tuple[float, ...]
    end: tuple[float, ...]


@dataclass(frozen=True)
class Opinion:
    """What came out: stretches, the largest relative difference, and stretches or switches that are not so."""

    stretches: int = 0
    difference: float = 0.0
    outside: int = 0
    otherwise: int = 0

    @property
    def agrees(self) -> bool:
        """Whether the motion is confirmed."""
        return self.difference <= AGREEMENT and not self.outside and not self.otherwise

    def __add__(self, other: Opinion) -> Opinion:
        return Opinion(
            self.stretches + other.stretches,
            max(self.difference, other.difference),
            self.outside + other.outside,
            self.otherwise + other.otherwise,
        )


def stretches_of(path: Trajectory) -> list[FlownPiece]:
    """Return the stretches of a motion."""
    found = []
    start: tuple[float, ...] = (float(path.t_start), *map(float, path(path.t_start)))
    for segment, event in zip(path.segments, path.events, strict=False):
        end: tuple[float, ...] = (float(event.t), float(event.x), float(event.v))
        found.append(FlownPiece(_where(segment.mode), start, end))
        start = end
    if len(path.segments) > len(path.events):
        end = float(path.t_end), *map(float, path(path.t_end))
        found.append(FlownPiece(_where(path.segments[-1].mode), start, end))
    return found


def stretches_of_orbit(orbit: PeriodicOrbit) -> list[FlownPiece]:
    """Return the stretches of one period of an orbit, the last one back to the first point."""
    p, found = orbit.parameters, []
    points = [*orbit.points, (orbit.points[0][0] + orbit.period, orbit.points[0][1])]
    for label, (t, x), (t_end, x_end) in zip(orbit.labels, points, points[1:], strict=False):
        row = MAPS[label]
        speeds = [float(p.belt(plane.boundary)) for plane in (row.start, row.end)]
        where = row.domain or -row.start.boundary
        found.append(FlownPiece(where, (float(t), float(x), speeds[0]), (float(t_end), float(x_end), speeds[1])))
    return found


def fly_again(p: Parameters, stretches: Iterable[FlownPiece]) -> Opinion:
    """Fly stretches again, and decide anew what follows each of them but the last."""
    stretches = list(stretches)
    opinion = Opinion()
    for i, stretch in enumerate(stretches):
        opinion += _one(p, stretch)
        if i + 1 < len(stretches):
            opinion += Opinion(otherwise=not _follows(p, stretch, stretches[i + 1].where))
    return opinion


def _where(mode: str) -> int:
    return int(mode[-1]) * (-1 if mode.startswith("belt") else 1)


def _one(p: Parameters, stretch: FlownPiece) -> Opinion:
    (t0, x0, v0), (t1, x1, v1) = stretch.start, stretch.end
    t = np.linspace(t0, t1, SAMPLES)
    if stretch.where > 0:
        x, v = flow(p, p.A(stretch.where), stretch.start, t)
        edges = -np.inf, float(p.v1), float(p.v2), np.inf
        low, high = edges[stretch.where - 1 : stretch.where + 1]
        inside = np.minimum(v - low, high - v)
    else:
        belt = -stretch.where
        x, v = x0 + v0 * (t - t0), np.full_like(t, float(p.belt(belt)))
        lo, hi = NEIGHBOURS[belt]
        inside = np.minimum(_force(p, lo, t, x, v), -_force(p, hi, t, x, v))
    size = max(1.0, float(np.abs(x).max()), float(np.abs(v).max()))
    difference = max(abs(float(x[-1]) - x1), abs(float(v[-1]) - v1)) / size
    return Opinion(1, difference, int(inside.min() < -AGREEMENT * size))


def _force(p: Parameters, alpha: int, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Eq. (9)."""
    A, B0, Omega, k, c, m = (float(value) for value in (p.A(alpha), p.B0, p.Omega, p.k, p.c, p.m))
    return np.asarray((A + B0 * np.cos(Omega * t) - k * x - c * v) / m)


def _follows(p: Parameters, stretch: FlownPiece, then: int) -> bool:
    """Tell whether Theorems 4 and 5 let a stretch be followed by another; where a force is 0 they leave it open."""
    t, x, v = map(np.asarray, stretch.end)
    belt = 1 if abs(float(v) - float(p.v1)) < abs(float(v) - float(p.v2)) else 2
    lo, hi = NEIGHBOURS[belt]
    below, above = float(_force(p, lo, t, x, v)), float(_force(p, hi, t, x, v))
    size = max(1.0, abs(below), abs(above))
    allowed = {
        -belt: below > -AGREEMENT * size and above < AGREEMENT * size,
        hi: above > -AGREEMENT * size,
        lo: below < AGREEMENT * size,
    }
    return bool(allowed.get(then, False))


def flown_again(check: Callable[[], Evidence]) -> Callable[[], Evidence]:
    """Let a check have a second opinion on every motion and orbit that it looks at.

    Without it a claim about a motion would be judged by the simulator alone.
    """

    @wraps(check)
    def checked() -> Evidence:
        with contacts.recording() as seen:
            evidence = check()
        opinion = sum(_opinions(seen), Opinion())
        if not opinion.stretches:
            return evidence
        told = f"{opinion.stretches} stretches, largest relative difference {opinion.difference:.1g}"
        evidence = replace(evidence, numbers=evidence.numbers | {"flown again in another closed form": told})
        if opinion.agrees:
            return evidence
        return replace(evidence, verdict=UNDECIDED, finding=f"Two ways do not agree ({told}). {evidence.finding}")

    return checked


def _opinions(seen: Iterable[Trajectory | PeriodicOrbit]) -> Iterator[Opinion]:
    for motion in {id(each): each for each in seen}.values():
        stretches = stretches_of(motion) if isinstance(motion, Trajectory) else stretches_of_orbit(motion)
        yield fly_again(motion.parameters, stretches)
