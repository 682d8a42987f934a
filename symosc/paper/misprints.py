"""Whether one misprinted number explains why a printed start is not on the periodic motion it is printed with.

A periodic motion comes back to its start after one period of the drive. Every parameter is left free in turn: from the
printed start, on its belt, one period is followed for many values, and between those next to the smallest misses the
miss is minimised. A value explains the start if the orbit of the printed structure then goes through it, to half a unit
of its last digit. Then each number of the start is left free: there the orbit of the printed parameters is looked at.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf, pi
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from symosc.errors import SymoscError
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.find import find_orbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.scenes import Scene
from symosc.simulation.ensemble import simulate_many

#: How far a parameter is varied: this many times its size (at least 1) both ways, as far as the model allows.
REACH = 10
#: Values of a parameter that are tried: so many evenly spaced, and so many on each side ever closer to what is printed.
EVEN_VALUES, CLOSER_VALUES = 120, 50
#: So many of the smallest misses are minimised; an orbit is looked for where the miss is below this.
VALLEYS, NEAR_MISS = 3, 0.002
# The least of a parameter that must stay positive, as a part of its printed value (k = 0 has no orbit).
LEAST = 1e-3
POSITIVE, NOT_NEGATIVE = ("m", "k", "Omega"), ("c", "mu1", "mu2", "FN")
# How long is followed, in periods: the event that may be the return can be late.
FOLLOWED = Fraction(5, 4)
# What counts as infinitely far from the printed start.
OUT_OF_SIGHT = 1e9


@dataclass(frozen=True)
class Nearest:
    """How near a motion comes to being periodic from the printed start when one number is left free.

    Attributes
    ----------
    name : str
        The number that is left free: a parameter, or "t0", "x0", "v0".
    value : float
        Its value there.
    dt, dx : float
        By how much the motion misses the start after one period, in time and position; where it is an orbit, the
        switching point of that minus the start. 0 for what was left free.
    searched : tuple of float
        The values that were tried.
    orbit : bool
        Whether it is the orbit of the printed structure that dt and dx are measured from.
    """

    name: str
    value: float
    dt: float
    dx: float
    searched: tuple[float, float]
    orbit: bool

    @property
    def distance(self) -> float:
        """The larger one of |dt| and |dx|."""
        return max(abs(self.dt), abs(self.dx))


def search_parameters(scene: Scene, names: tuple[str, ...] = PARAMETER_NAMES) -> list[Nearest]:
    """Leave each of the parameters free in turn; return one result for each, the nearest first."""
    return sorted((_along(scene, name) for name in names), key=lambda each: each.distance)


def search_start(scene: Scene) -> list[Nearest]:
    """Leave each number of the start free in turn; the parameters stay as they are printed."""
    orbit = find_orbit(scene.parameters, str(scene.structure))
    t0, x0, gaps = float(scene.t0), float(scene.x0), _gaps(orbit, scene)
    dt, dx = min(gaps, key=lambda gap: abs(gap[1]))
    found = [Nearest("t0", t0 + dt, 0.0, dx, (-inf, inf), True)]
    dt, dx = min(gaps, key=lambda gap: abs(gap[0]))
    found.append(Nearest("x0", x0 + dx, dt, 0.0, (-inf, inf), True))
    x, v = orbit(t0)
    return [*found, Nearest("v0", float(v), 0.0, float(x) - x0, (-inf, inf), True)]


def _along(scene: Scene, name: str) -> Nearest:
    values = _tried(scene.parameters, name)
    misses = _misses(scene, name, values)
    sizes = np.abs(misses).max(axis=1)
    best, value, orbit = misses[sizes.argmin()], float(values[sizes.argmin()]), False
    for i in _valleys(sizes):
        around = float(values[max(i - 1, 0)]), float(values[min(i + 1, len(values) - 1)])
        at, miss = _least(lambda number: _misses(scene, name, np.array([number]))[0], around)
        if np.abs(miss).max() < NEAR_MISS:
            exact, gap = _least(lambda number: _gap(scene, name, number), around)
            if np.abs(gap).max() < np.abs(best).max():
                best, value, orbit = gap, exact, True
        elif np.abs(miss).max() < np.abs(best).max():
            best, value = miss, at
    return Nearest(name, value, float(best[0]), float(best[1]), (float(values[0]), float(values[-1])), orbit)


def _least(miss: Any, around: tuple[float, float]) -> tuple[float, np.ndarray]:
    """Minimise the larger component of a miss."""

    def size(number: float) -> float:
        return min(float(np.abs(miss(float(number))).max()), OUT_OF_SIGHT)  # parabolas through infinite values are none

    found = minimize_scalar(size, bounds=around, method="bounded")
    return float(found.x), np.asarray(miss(float(found.x)))


def _valleys(sizes: np.ndarray) -> list[int]:
    """Return where the smallest local minima are, ends included."""
    padded = np.array([inf, *sizes, inf])
    at = np.flatnonzero((sizes <= padded[:-2]) & (sizes <= padded[2:]) & (sizes < inf))
    return [int(i) for i in at[np.argsort(sizes[at])][:VALLEYS]]


def _tried(p: Parameters, name: str) -> np.ndarray:
    value, (low, high) = float(getattr(p, name)), range_of(p, name)
    closer = np.geomspace(LEAST, 1.0, CLOSER_VALUES)
    near = [value - (value - low) * closer, value + (high - value) * closer]
    return np.unique(np.concatenate([np.linspace(low, high, EVEN_VALUES), *near, [value]]))


def range_of(p: Parameters, name: str) -> tuple[float, float]:
    """Return the values of a parameter that are tried: REACH times its size both ways, as far as the model allows."""
    value = float(getattr(p, name))
    reach = REACH * max(1.0, abs(value))
    low, high = value - reach, value + reach
    if name in POSITIVE:
        low = LEAST * value
    elif name in NOT_NEGATIVE:
        low = 0.0
    margin = LEAST * float(p.v2 - p.v1)
    if name == "v1":
        high = min(high, float(p.v2) - margin)
    elif name == "v2":
        low = max(low, float(p.v1) + margin)
    return low, high


def _misses(scene: Scene, name: str, values: np.ndarray) -> np.ndarray:
    """Return (dt, dx) of the contact that comes nearest to the printed start one period later, for each value."""
    boundary = 1 if scene.v0 == scene.parameters.v1 else 2
    sets = [scene.parameters.replace(**{name: float(value)}) for value in values]
    periods = np.array([2 * pi / float(p.Omega) for p in sets])
    t0, x0 = float(scene.t0), float(scene.x0)
    starts = [(scene.t0, scene.x0, p.belt(boundary)) for p in sets]
    # A few thousand short motions: compiling would take longer.
    table = simulate_many(sets, starts, t0 + float(FOLLOWED) * periods, accuracy=inf, use_numba=False)
    misses = np.full((len(values), 2), inf)
    here = table.boundary == boundary
    dt, dx = table.t - t0 - periods[table.trajectory], table.x - x0
    size = np.where(here, np.maximum(np.abs(dt), np.abs(dx)), inf)
    for row in np.lexsort((-size, table.trajectory)):  # the last one of each trajectory is the nearest
        if size[row] < inf:
            misses[table.trajectory[row]] = dt[row], dx[row]
    return misses


def _gap(scene: Scene, name: str, value: float) -> np.ndarray:
    """Return (dt, dx) from the printed start to the nearest switching point of the orbit; inf if there is none."""
    try:
        orbit = find_orbit(scene.parameters.replace(**{name: value}), str(scene.structure))
    except SymoscError:
        return np.array([inf, inf])
    if not orbit.admissible:
        return np.array([inf, inf])
    return np.array(min(_gaps(orbit, scene), key=lambda gap: max(map(abs, gap))))


def _gaps(orbit: PeriodicOrbit, scene: Scene) -> list[tuple[float, float]]:
    """Return (dt, dx) from the printed start to each switching point, dt modulo the period."""
    period, points = float(orbit.period), np.array([(float(point.t), float(point.x)) for point in orbit.points])
    dt = (points[:, 0] - float(scene.t0) + period / 2) % period - period / 2
    return list(zip(dt.tolist(), (points[:, 1] - float(scene.x0)).tolist(), strict=True))
