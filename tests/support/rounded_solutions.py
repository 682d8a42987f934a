"""Solutions rounded to few decimals.

Right ones, and ones that are wrong by more than 20 last places.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import cycle, islice
from typing import Any

import numpy as np
from careful_solver import random_parameters
from faulty_solver import METHODS, Flaw, Solver, without_events

from symosc import Parameters, Scene, load_scene, simulate
from symosc.base.exact import read_exact

#: Deviation of a wrong solution, in units of the last place, at least.
DEVIATION = 20.0


@dataclass
class Solution:
    """A rounded solution of a scene, and how far it and its x are from the right one, in units of the last place."""

    scene: Scene
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    decimals: int
    kind: str
    off: float = 0.0
    off_x: float = 0.0


def random_scene(rng: np.random.Generator) -> Scene:
    """Return a shipped or a random scene, and an end after some periods."""
    if rng.random() < 0.3:
        scene = load_scene(
            str(rng.choice(["fig5", "fig6", "fig7", "fig9", "fig10", "fig9-orbit", "fig10-orbit"]))
        )
        return replace(scene, t_end=scene.t0 + min(scene.t_end - scene.t0, 20))
    p = random_parameters(rng)
    t0 = round(rng.uniform(0, 5), int(rng.integers(0, 5)))
    x0 = round(rng.uniform(-4, 4), int(rng.integers(0, 9)))
    v0 = float(rng.choice([float(p.v1), float(p.v2), round(rng.uniform(-6, 8), 3)]))
    t_end = round(t0 + min(rng.uniform(2, 8) * 2 * np.pi / float(p.Omega), 40.0), 2)
    exact = (
        read_exact(name, value)
        for name, value in (("t0", t0), ("x0", x0), ("v0", v0), ("t_end", t_end))
    )
    return Scene("random", p, *exact)  # type: ignore[arg-type]


def times(scene: Scene, rng: np.random.Generator, least: int, most: int) -> np.ndarray:
    """Return an even grid of some length."""
    return np.linspace(
        float(scene.t0),
        float(scene.t_end),
        int(np.exp(rng.uniform(np.log(least), np.log(most)))) + 1,
    )


def solved(
    scene: Scene, p: Parameters, t: np.ndarray, ahead: float = 0.0, **start: float
) -> np.ndarray:
    """Return x, v of a motion of parameters from the scene's start, its clock ahead."""
    begin: dict[str, Any] = {"x0": scene.x0, "v0": scene.v0} | start
    motion = simulate(
        p, t0=scene.t0 + read_exact("ahead", ahead), **begin, t_end=float(t[-1]) + ahead + 1e-9
    )
    return np.asarray(motion(np.clip(t + ahead, float(motion.t_start), float(motion.t_end))))


def right(rng: np.random.Generator, most: int) -> Solution:
    """Return a right solution.

    Dense or sparse, its times rounded or not, its start rounded or not.
    """
    scene = random_scene(rng)
    decimals = int(rng.integers(0, 6))
    kind = "right"
    start = {}
    t = times(scene, rng, 30, most)
    if rng.random() < 0.3:
        start = {name: round(float(getattr(scene, name)), decimals) for name in ("x0", "v0")}
    x, v = solved(scene, scene.parameters, t, **start)
    if rng.random() < 0.3:
        chosen = np.unique([0, *rng.integers(1, len(t) - 1, len(t) // 2), len(t) - 1])
        t = t[chosen]
        x = x[chosen]
        v = v[chosen]
        kind = "right, uneven"
        if rng.random() < 0.5:
            t = np.round(t, max(decimals, 2))
    return Solution(scene, t, np.round(x, decimals), np.round(v, decimals), decimals, kind)


PARTS: dict[str, Any] = {
    "c halved": lambda p, r: {"c": p.c / 2},
    "k off": lambda p, r: {"k": p.k * r(0.01, 0.03)},
    "m off": lambda p, r: {"m": p.m * r(0.01, 0.05)},
    "FN off": lambda p, r: {"FN": p.FN * r(0.02, 0.3)},
    "Omega off": lambda p, r: {"Omega": p.Omega * r(0.001, 0.02)},
    "B0 off": lambda p, r: {"B0": p.B0 * r(0.01, 0.1)},
    "A0 negative": lambda p, r: {"A0": -p.A0},
    "mu swapped": lambda p, r: {"mu1": p.mu2, "mu2": p.mu1},
    "no friction": lambda p, r: {"FN": 0},
    "belt off": lambda p, r: {"v1": p.v1 * r(0.01, 0.05)},
}
FLAWS = {
    "late events": Flaw(late=True),
    "static friction": Flaw(static=1.3),
    "leaves sticks early": Flaw(early=0.2),
    "drifts in sticks": Flaw(drift=1e-2),
}
SIZED = ("drift", "noise", "outlier", "jump")  # as large as the decimals ask for
KINDS = (*PARTS, *FLAWS, "sine", "clock", "scale", "v late", "Euler", *SIZED)


def wrong(rng: np.random.Generator, kind: str, most: int) -> Solution | None:
    """Return a densely rounded wrong solution, or None if it is not far enough from the right one."""
    scene = random_scene(rng)
    decimals = int(rng.integers(0, 6))
    p = scene.parameters
    t = times(scene, rng, 400, most)
    start = (float(scene.x0), float(scene.v0))
    exact = solved(scene, p, t)

    def factor(low: float, high: float) -> Any:
        return read_exact("factor", round(1 + rng.choice([-1, 1]) * rng.uniform(low, high), 5))

    size = 10.0**-decimals * DEVIATION * rng.uniform(1.1, 10)
    found = exact.copy()
    row = rng.integers(0, 2)
    one = rng.integers(1, len(t))
    if kind in PARTS:
        change = PARTS[kind](p, factor)
        if change.get("v1", p.v1) >= p.v2:
            return None
        found = solved(scene, p.replace(**change), t)
    elif kind in FLAWS:
        found = np.array(Solver(p, FLAWS[kind]).run(t, *start).arrays()[1:])
    elif kind == "sine":
        found = solved(scene, p, t, -0.5 * np.pi / float(p.Omega))
    elif kind == "Euler":
        found = np.array(without_events(p, t, *start, METHODS["euler"])[1:])
    elif kind == "clock":
        found = np.array([np.interp(t * (1 + 1e-3), t, each) for each in exact])
    elif kind == "scale":
        found[row, 1:] *= 1.01
    elif kind == "v late":
        found[1, 1:] = exact[1, :-1]
    elif kind == "drift":
        found[row] += size * (t - t[0]) / (t[-1] - t[0])
    elif kind == "noise":
        found[:, 1:] += size / 3.0 * rng.standard_normal((2, len(t) - 1))
    else:  # an outlier or a jump
        found[row, one : one + 1 if kind == "outlier" else None] += size
    if kind not in SIZED:  # as few decimals as show it, or more
        most_off = float(np.max(np.abs(found - exact)))
        shown = [d for d in range(6) if most_off > 1.1 * DEVIATION * 10.0**-d]
        if not shown:
            return None
        decimals = int(rng.choice(shown))
    found = np.round(found, decimals)
    off_x, off_v = (np.max(np.abs(found - exact), axis=1) * 10.0**decimals).tolist()
    off = max(off_x, off_v)
    if off > DEVIATION:
        return Solution(scene, t, *found, decimals, kind, off, off_x)
    return None


def wrong_solutions(seed: int, count: int, most: int) -> Iterator[Solution]:
    """Return wrong solutions of all kinds in turn."""
    rng = np.random.default_rng(seed)
    tried = (wrong(rng, kind, most) for kind in cycle(KINDS))
    return islice((found for found in tried if found is not None), count)
