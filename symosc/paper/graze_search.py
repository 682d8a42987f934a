"""Starts of grazing motions: the one next to a printed start, and misprints that would explain why it does not graze.

The starts at t0 from which a flow grazes are a curve in the plane (x0, v0), one point for each time t_m of the contact:
x_m and v_lambda at t_m, flowed back. Printed digits are right if the curve meets the box of all starts that round to
them. If it does not, each parameter and each number of the start is left free in turn: a value at which the flow from
the printed start touches the belt, and never is beyond it, explains the figure if it is no longer than what is printed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from symosc.mappings.theorem7_cases import place
from symosc.model import PARAMETER_NAMES
from symosc.paper.checks.linear_flow import flow
from symosc.paper.misprints import REACH, range_of
from symosc.scenes import Scene

START = ("t0", "x0", "v0")
#: Periods after the start in which a touch is looked for, instants in them, and values of a number left free.
SEARCHED_PERIODS, INSTANTS, VALUES = 3, 300, 201
LONGEST = 12
# Of the search for the time of the largest velocity.
PEAK: dict[str, Any] = {"method": "bounded", "options": {"xatol": 1e-10}}


@dataclass(frozen=True)
class NearestGraze:
    """The start of a graze next to a printed start.

    Attributes
    ----------
    t_m : float
        Time of its contact.
    dx, dv : float
        It minus the printed start.
    t_low, t_high : float
        Times of contact of all starts that round to the printed one; nan if there are none.
    """

    t_m: float
    dx: float
    dv: float
    t_low: float
    t_high: float

    @property
    def rounds(self) -> bool:
        """Whether a start that grazes rounds to the printed one."""
        return self.t_low <= self.t_high


@dataclass(frozen=True)
class FreeValue:
    """A number of a scene with which the flow from the printed start grazes, all others as printed.

    Attributes
    ----------
    name, value : str, float
    uncertainty : float
        What half a unit of the printed x0 and v0 changes it by.
    t_m : float
        Time of the contact.
    """

    name: str
    value: float
    uncertainty: float
    t_m: float

    @property
    def shortest(self) -> str:
        """The shortest decimal number within the uncertainty."""
        for digits in range(1, LONGEST):
            text = f"{self.value:.{digits}g}"
            if abs(float(text) - self.value) <= self.uncertainty:
                return f"{float(text):.{LONGEST}g}"
        return f"{self.value:.{LONGEST}g}"

    @property
    def digits(self) -> int:
        """How many significant digits that has."""
        return len(self.shortest.replace(".", "").lstrip("-0"))


def starts_that_graze(scene: Scene, mapping: str, t_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return x0 and v0 at t0 of the flows that touch the mapping's belt at the times t_m."""
    p, at = scene.parameters, place(mapping)
    v = float(p.belt(at.boundary))
    A, B0, Omega, c, k = (float(value) for value in (p.A(at.domain), p.B0, p.Omega, p.c, p.k))
    x_m = (A + B0 * np.cos(Omega * t_m) - c * v) / k
    pairs = [flow(p, A, (t, x, v), float(scene.t0)) for t, x in zip(t_m, x_m, strict=True)]
    return np.array([x for x, _ in pairs]), np.array([v for _, v in pairs])


def nearest_graze(scene: Scene, mapping: str, half_unit: float) -> NearestGraze:
    """Find the point of the curve of grazing starts next to the printed start, and where it is in its rounding box."""

    def away(t: float) -> float:
        x, v = starts_that_graze(scene, mapping, np.array([t]))
        return float(max(abs(x[0] - float(scene.x0)), abs(v[0] - float(scene.v0))))

    period = 2 * np.pi / float(scene.parameters.Omega)
    times = float(scene.t0) + period * np.arange(INSTANTS + 1) / INSTANTS
    x, v = starts_that_graze(scene, mapping, times)
    coarse = np.maximum(np.abs(x - float(scene.x0)), np.abs(v - float(scene.v0)))
    best, around = np.nan, (np.nan, np.nan)
    for i in _valleys(coarse):
        ends = times[i - 1], times[i + 1]
        t = float(minimize_scalar(away, bounds=ends, method="bounded", options={"xatol": 1e-13}).x)
        if not away(t) >= away(best):
            best, around = t, ends
    x, v = starts_that_graze(scene, mapping, np.array([best]))
    box = (np.nan, np.nan)
    if away(best) <= half_unit:
        box = tuple(brentq(lambda t: away(t) - half_unit, *sorted((best, end)), xtol=1e-12) for end in around)
    return NearestGraze(best, float(x[0]) - float(scene.x0), float(v[0]) - float(scene.v0), *box)


def _valleys(values: np.ndarray) -> list[int]:
    """Return where values have a local minimum, the lowest first."""
    inner = values[1:-1]
    at = np.flatnonzero((inner <= values[:-2]) & (inner <= values[2:])) + 1
    return [int(i) for i in at[np.argsort(values[at])]] or [1 + int(np.argmin(inner))]


def search(
    scene: Scene, mapping: str, half_unit: float, names: Sequence[str] = (*PARAMETER_NAMES, *START)
) -> list[FreeValue]:
    """Leave each parameter and each number of the start free in turn, and return all values that graze."""
    return [value for name in names for value in _values(scene, mapping, name, half_unit)]


def _values(scene: Scene, mapping: str, name: str, half_unit: float) -> list[FreeValue]:
    printed = float(getattr(scene if name in START else scene.parameters, name))
    values = np.unique([*np.linspace(*_range(scene, name), VALUES), printed])
    gaps = [_gap(scene, mapping, {name: float(value)})[0] for value in values]
    found = []
    for i, (one, two) in enumerate(pairwise(gaps)):
        if not one * two <= 0 or abs(one - two) > 10 * max(1.0, abs(printed)):
            continue
        root = float(brentq(lambda value: _gap(scene, mapping, {name: float(value)})[0], values[i], values[i + 1]))
        gap, t_m, clear = _gap(scene, mapping, {name: root})
        if not clear or abs(gap) > half_unit:
            continue
        steps = {key: 1e-6 * max(1.0, abs(number)) for key, number in (("x0", 1.0), ("v0", 1.0), (name, root))}
        slopes = {key: _slope(scene, mapping, name, root, key, step) for key, step in steps.items()}
        moved = sum(abs(slopes[key]) for key in ("x0", "v0") if key != name)
        found.append(FreeValue(name, root, half_unit * (moved / abs(slopes[name]) + (name in START)), t_m))
    return found


def _range(scene: Scene, name: str) -> tuple[float, float]:
    if name not in START:
        return range_of(scene.parameters, name)
    value = float(getattr(scene, name))
    # Times come back after a period.
    reach = np.pi / float(scene.parameters.Omega) if name == "t0" else REACH * max(1.0, abs(value))
    return value - reach, value + reach


def _slope(scene: Scene, mapping: str, name: str, root: float, key: str, step: float) -> float:
    ends = []
    for sign in (1, -1):
        change = {name: root}
        change[key] = change.get(key, float(getattr(scene, key, 0))) + sign * step
        ends.append(_gap(scene, mapping, change)[0])
    return (ends[0] - ends[1]) / (2 * step)


def _gap(scene: Scene, mapping: str, change: dict[str, float]) -> tuple[float, float, bool]:
    """Return how far the flow gets beyond the belt (negative: not at all), when, and if it starts in its domain."""
    at = place(mapping)
    start = tuple(change.get(name, float(getattr(scene, name))) for name in START)
    exact = {name: Fraction(value) for name, value in change.items() if name not in START}
    p = scene.parameters.replace(**exact) if exact else scene.parameters
    A, belt = float(p.A(at.domain)), float(p.belt(at.boundary))
    times = start[0] + SEARCHED_PERIODS * 2 * np.pi / float(p.Omega) * np.arange(INSTANTS + 1) / INSTANTS

    def beyond(t: np.ndarray) -> np.ndarray:
        return at.side * (flow(p, A, start, t)[1] - belt)

    try:
        over = beyond(times)
    except ZeroDivisionError:  # resonance without a damper
        return np.nan, np.nan, False
    i = int(np.argmax(over))
    step = times[1] - times[0]
    best = minimize_scalar(lambda t: -float(beyond(t)), bounds=(times[i] - step, times[i] + step), **PEAK)
    inside = over[0] < 0 and i > 0
    if at.domain == 2:
        other = p.v2 if at.boundary == 1 else p.v1
        speeds = flow(p, A, start, times[: i + 1])[1]
        inside = inside and bool(np.all(-at.side * (speeds - float(other)) < 0))
    return -float(best.fun), float(best.x), bool(inside)
