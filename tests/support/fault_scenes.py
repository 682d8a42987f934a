"""Thirty scenes to be solved wrongly, shipped ones and random ones of all regimes, and four ways to sample them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import pi

import numpy as np
from regimes import random_sets

from symosc import Scene, load_scene, simulate
from symosc.base.exact import read_exact
from symosc.scenes import scene_names
from symosc.simulation.trajectory import Trajectory

SAMPLINGS = ("dense", "coarse", "own steps", "random")
COUNT = 30
SEED = 18
PERIODS = 8.0  # of the drive, at most


@dataclass(frozen=True)
class Case:
    """A scene, its length and its exact motion."""

    scene: Scene
    t_end: float
    exact: Trajectory

    @property
    def span(self) -> tuple[float, float]:
        return float(self.exact.t_start), self.t_end

    @property
    def start(self) -> tuple[float, float]:
        return float(self.scene.x0), float(self.scene.v0)

    def times(self, sampling: str, rng: np.random.Generator) -> np.ndarray:
        """Return the times of a sampling.

        A solver's own steps grow and shrink by a factor of about 5.
        """
        begin, end = self.span
        turns = (end - begin) * float(self.scene.parameters.Omega) / (2.0 * pi)
        if sampling == "dense":
            return np.linspace(begin, end, 401)
        if sampling == "coarse":
            return np.linspace(begin, end, max(int(12 * turns), 24) + 1)
        if sampling == "random":
            return np.concatenate([[begin], np.sort(rng.uniform(begin, end, 200)), [end]])
        steps = np.exp(
            0.8 * np.sin(np.linspace(0.0, rng.uniform(20.0, 60.0), 260) + rng.uniform(0.0, 6.0))
        )
        ends = np.cumsum(steps) / np.sum(steps)
        return np.concatenate([[begin], begin + (end - begin) * ends[:-1], [end]])


@cache
def cases() -> tuple[Case, ...]:
    """Return the scenes: a random one counts if its motion has some events and is decided to its end."""
    found = [case for name in scene_names() if (case := _case(load_scene(name)))]
    rng = np.random.default_rng(SEED)
    for p in random_sets(SEED, 400):
        if len(found) == COUNT:
            break
        v0 = round(float(p.v1) + float(p.v2 - p.v1) * rng.uniform(-0.5, 1.5), 3)
        name = f"random-{len(found)}"
        t0 = round(rng.uniform(0, 5), 3)
        x0 = round(rng.normal(), 3)
        scene = Scene(name, p, *(read_exact("start", value) for value in (t0, x0, v0, 9.0)))  # type: ignore[arg-type]
        case = _case(scene)
        if case and 4 <= len(case.exact.events) <= 60:
            found.append(case)
    return tuple(found)


def _case(scene: Scene) -> Case | None:
    period = 2.0 * pi / float(scene.parameters.Omega)
    begin = float(scene.t0)
    t_end = float(f"{begin + PERIODS * period:.6g}")
    if scene.name in scene_names():
        t_end = min(t_end, float(scene.t_end))
    exact = simulate(scene, t_end=t_end)
    if exact.status == "t_end":
        return Case(scene, t_end, exact)
    return None
