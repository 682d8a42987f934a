"""Whether one misprinted number explains why a printed start is not on the periodic orbit it is printed with.

Every parameter is left free in turn: the orbit of the printed structure is followed over it, both ways, until it ends
or the range does, and where it comes nearest to the printed start, the distance is minimised. Then each number of the
start is left free. A misprint explains the start if what was not left free agrees to half a unit of its last digit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import inf, pi
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from symosc.errors import SymoscError
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.continuation import continue_orbit
from symosc.orbits.find import find_orbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.scenes import Scene

#: How far a parameter is varied: this many times its size (at least 1) both ways, as far as the model allows.
REACH = 10
# The least of a parameter that must stay positive, as a part of its printed value (k = 0 has no orbit).
LEAST = 1e-3
POSITIVE, NOT_NEGATIVE = ("m", "k", "Omega"), ("c", "mu1", "mu2", "FN")


@dataclass(frozen=True)
class Nearest:
    """Where the orbit comes nearest to the printed start when one number is left free.

    Attributes
    ----------
    name : str
        The number that is left free: a parameter, or "t0", "x0", "v0".
    value : float
        Its value there.
    dt, dx : float
        Orbit minus printed start, in time (modulo the period) and position; 0 for what was left free.
    searched : tuple of float
        The values between which the orbit exists and was searched.
    ends : tuple of str
        Why the search ended at either side.
    """

    name: str
    value: float
    dt: float
    dx: float
    searched: tuple[float, float]
    ends: tuple[str, str]

    @property
    def distance(self) -> float:
        """The larger one of |dt| and |dx|."""
        return max(abs(self.dt), abs(self.dx))


@dataclass(frozen=True)
class Companion:
    """A parameter value with which the orbit agrees with one number of the start, the other one being left free too.

    Attributes
    ----------
    name, value : str, float
        The parameter and its value.
    uncertainty : float
        What half a unit of the start's last digit changes it by.
    agrees : str
        "t0" or "x0".
    """

    name: str
    value: float
    uncertainty: float
    agrees: str

    def is_round(self, digits: int) -> bool:
        """Tell whether a number with so many significant digits lies within the uncertainty."""
        return abs(self.value - float(f"{self.value:.{digits - 1}e}")) <= self.uncertainty


def search_parameters(scene: Scene, half_unit: float) -> tuple[list[Nearest], list[Companion]]:
    """Leave each of the eleven parameters free in turn.

    Parameters
    ----------
    scene : Scene
        With the printed start, on a belt, and the structure of the orbit.
    half_unit : float
        Half a unit of the last digit of the printed start.

    Returns
    -------
    nearest : list of Nearest
        One per parameter, the nearest first.
    companions : list of Companion
        All values with which the orbit agrees with t0 alone or with x0 alone.
    """
    nearest, companions = [], []
    for name in PARAMETER_NAMES:
        one, more = _along(scene, name, half_unit)
        nearest.append(one)
        companions += more
    return sorted(nearest, key=lambda each: each.distance), companions


def search_start(scene: Scene) -> list[Nearest]:
    """Leave each number of the start free in turn; the parameters stay as they are printed."""
    orbit = find_orbit(scene.parameters, scene.structure)
    t0, x0, gaps = float(scene.t0), float(scene.x0), _gaps(orbit, scene)
    whole: dict[str, Any] = {"searched": (-inf, inf), "ends": ("", "")}
    dt, dx = min(gaps, key=lambda gap: abs(gap[1]))
    found = [Nearest("t0", t0 + dt, 0.0, dx, **whole)]
    dt, dx = min(gaps, key=lambda gap: abs(gap[0]))
    found.append(Nearest("x0", x0 + dx, dt, 0.0, **whole))
    x, v = orbit(t0)
    return [*found, Nearest("v0", float(v), 0.0, float(x) - x0, **whole)]


def _along(scene: Scene, name: str, half_unit: float) -> tuple[Nearest, list[Companion]]:
    branch = continue_orbit(scene.parameters, scene.structure, name, range_of(scene.parameters, name))
    gaps = np.array([_gaps_of(p, branch.parameters(i), scene) for i, p in enumerate(branch.points)])
    best = np.unravel_index(np.abs(gaps).max(axis=2).argmin(), gaps.shape[:2])
    index, point = int(best[0]), int(best[1])

    def gap(value: float, near: int) -> np.ndarray:
        changed = scene.parameters.replace(**{name: value})
        orbit = find_orbit(changed, scene.structure, branch.points[near], periods=branch.periods)
        return np.array(_gaps(orbit, scene)[point])

    value, least = branch.values[index], gaps[index, point]
    around = branch.values[[max(index - 1, 0), min(index + 1, len(branch.values) - 1)]]
    finer = minimize_scalar(
        lambda number: _distance(gap, float(number), index), bounds=sorted(around), method="bounded"
    )
    if finer.fun < np.abs(least).max():
        value, least = float(finer.x), gap(float(finer.x), index)
    ends = (branch.ends[0].kind, branch.ends[1].kind)
    searched = (float(branch.values[0]), float(branch.values[-1]))
    nearest = Nearest(name, float(value), float(least[0]), float(least[1]), searched, ends)
    return nearest, _companions(name, branch.values, gaps[:, point], gap, half_unit)


def _companions(
    name: str, values: np.ndarray, gaps: np.ndarray, gap: Callable[[float, int], np.ndarray], half_unit: float
) -> list[Companion]:
    found = []
    for column, agrees in enumerate(("t0", "x0")):
        for i, (one, two) in enumerate(pairwise(gaps[:, column])):
            # A jump by half a period is no root.
            if one * two > 0 or one == two or abs(one - two) > 1:
                continue
            low, high = values[i], values[i + 1]
            root = float(brentq(lambda value, i=i, column=column: gap(float(value), i)[column], low, high, xtol=1e-12))
            slope = (two - one) / (high - low)
            found.append(Companion(name, root, abs(half_unit / slope), agrees))
    return found


def _distance(gap: Callable[[float, int], np.ndarray], value: float, near: int) -> float:
    try:
        return float(np.abs(gap(value, near)).max())
    except SymoscError:  # just behind the end of the branch
        return inf


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


def _gaps(orbit: PeriodicOrbit, scene: Scene) -> list[tuple[float, float]]:
    points = np.array([(float(point.t), float(point.x)) for point in orbit.points])
    return _gaps_of(points, orbit.parameters, scene)


def _gaps_of(points: np.ndarray, p: Parameters, scene: Scene) -> list[tuple[float, float]]:
    """Return (dt, dx) from the printed start to each switching point, dt modulo the period."""
    period = 2 * pi / float(p.Omega)
    dt = (points[:, 0] - float(scene.t0) + period / 2) % period - period / 2
    return list(zip(dt.tolist(), (points[:, 1] - float(scene.x0)).tolist(), strict=True))
