"""Solutions of an independent solver, right and wrong ones, rounded to few decimals.

The solver steps x, v, cos, sin and 1 by matrix exponentials of the equation of motion in each domain. Switchings are
bracketed between its steps, an extremum of the velocity included, and bisected.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import cycle, islice
from math import ceil, cos, log2, sin
from typing import Any

import numpy as np
from careful_solver import random_parameters

from symosc import Parameters, Scene, load_scene
from symosc.exact import read_exact

SHORTEST = 1e-13  # of a bisection
LONGEST_STEP = 0.4  # in units of 1/rate
MOST_EVENTS = 100  # in a step
BEYOND = 1e-12  # of a belt, so that rounding is no crossing
#: Deviation of a wrong solution, in units of the last place, at least.
DEVIATION = 20.0


@dataclass
class Flaws:
    """What a wrong solver does; the default is a right one."""

    late: float = 0.0  # events are taken so much later
    never_sticks: bool = False
    holds: float = 1.0  # a stick ends when a force is so many times beyond its bound
    upper_exit: bool = False  # a stick ends upward only


@dataclass
class Solver:
    """The motion of a double-belt oscillator from a start, at growing times."""

    p: Parameters
    flaws: Flaws = field(default_factory=Flaws)

    def __post_init__(self) -> None:
        p = self.p
        self.m, self.c, self.k, self.B0, self.Om = (float(value) for value in (p.m, p.c, p.k, p.B0, p.Omega))
        self.belts = (float(p.v1), float(p.v2))
        push = float(p.mu1 * p.FN), float(p.mu2 * p.FN)
        sides = ((1, 1), (-1, 1), (-1, -1))
        self.A = [float(p.A0) + sum(s * f for s, f in zip(side, push, strict=True)) for side in sides]
        self.known: dict[tuple[int, float], np.ndarray] = {}

    def force(self, domain: int, t: float, x: float, v: float) -> float:
        return (self.A[domain] + self.B0 * cos(self.Om * t) - self.k * x - self.c * v) / self.m

    def step(self, domain: int, tau: float, keep: bool = False) -> np.ndarray:
        """Return the matrix over a time; domains 0 to 2."""
        key = domain, tau
        if key not in self.known:
            k, c, B, A, Om = self.k / self.m, self.c / self.m, self.B0 / self.m, self.A[domain] / self.m, self.Om
            rates = [[0, 1, 0, 0, 0], [-k, -c, B, 0, A], [0, 0, 0, -Om, 0], [0, 0, Om, 0, 0], [0, 0, 0, 0, 0]]
            found = exponential(np.array(rates, dtype=float) * tau)
            if not keep:
                return found
            self.known[key] = found
        return self.known[key]

    def flown(self, domain: int, t: float, x: float, v: float, tau: float, keep: bool = False) -> tuple[float, float]:
        x, v = (self.step(domain, tau, keep)[:2] @ [x, v, cos(self.Om * t), sin(self.Om * t), 1.0]).tolist()
        return x, v

    def solve(self, times: np.ndarray, x: float, v: float) -> tuple[np.ndarray, np.ndarray]:
        """Return x and v at the times of an even grid, by steps short enough to hold one extremum of the velocity."""
        rate = max(self.Om, (self.k / self.m) ** 0.5, self.c / self.m)
        parts = ceil(rate * (times[-1] - times[0]) / (len(times) - 1) / LONGEST_STEP)
        times = np.linspace(times[0], times[-1], parts * (len(times) - 1) + 1)
        found = [(x, v)]
        steps = np.round(np.diff(times), 14).tolist()
        t, mode = float(times[0]), self.settle(float(times[0]), x, v)
        for end, h in zip(times[1:].tolist(), steps, strict=True):
            t, x, v, mode = self.advance(t, x, v, mode, end, h, True)
            for _ in range(MOST_EVENTS):
                if t >= end:
                    break
                t, x, v, mode = self.advance(t, x, v, mode, end, end - t, False)
            else:
                raise RuntimeError(f"{self.p}, {self.flaws}: too many events at t = {t}")
            t = end
            found.append((x, v))
        x_found, v_found = np.array(found[::parts]).T
        return x_found, v_found

    def settle(self, t: float, x: float, v: float) -> int:
        """Return the mode in which a motion goes on: domain 0 to 2, or 3 and 4 on a belt."""
        for i, speed in enumerate(self.belts):
            if v == speed:
                low, high = self.force(i, t, x, v), self.force(i + 1, t, x, v)
                if low > 0 > high and not self.flaws.never_sticks:
                    return 3 + i
                return i + 1 if high > 0 or (low > 0 > high) else i
        return int(v > self.belts[0]) + int(v > self.belts[1])

    def advance(
        self, t: float, x: float, v: float, mode: int, end: float, h: float, keep: bool
    ) -> tuple[float, float, float, int]:
        """Move to the end of the step, or to the first switching in it."""
        if mode > 2:
            return self.held(t, x, v, mode, end, h)
        walls = (-np.inf, *self.belts, np.inf)[mode : mode + 2]

        def outside(tau: float) -> bool:
            speed = self.flown(mode, t, x, v, tau)[1]
            return not walls[0] - BEYOND <= speed <= walls[1] + BEYOND

        x_end, v_end = self.flown(mode, t, x, v, h, keep)
        hit = h if not walls[0] - BEYOND <= v_end <= walls[1] + BEYOND else None
        if hit is None:
            a, b = self.force(mode, t, x, v), self.force(mode, end, x_end, v_end)
            if a * b < 0 and min(abs(v - w) for w in walls) < (abs(a) + abs(b)) * h:  # an extremum, near a belt
                top = bisect(lambda tau: self.force(mode, t + tau, *self.flown(mode, t, x, v, tau)) * a <= 0, h)
                hit = top if outside(top) else None
        if hit is None:
            return end, x_end, v_end, mode
        tau = min(bisect(outside, hit) + self.flaws.late, h)
        x, v = self.flown(mode, t, x, v, tau)
        i = int(np.argmin(np.abs(np.array(self.belts) - v)))
        v = self.belts[i]
        after = self.settle(t + tau, x, v)
        if self.flaws.never_sticks:  # it passes, whatever the forces say
            after = i + (mode == i)
        return t + max(tau, 1e-12), x, v, after

    def held(self, t: float, x: float, v: float, mode: int, end: float, h: float) -> tuple[float, float, float, int]:
        i, more = mode - 3, self.flaws.holds - 1.0
        slack = more * float(self.p.FN) / self.m

        def leaves(tau: float) -> bool:
            at = t + tau, x + v * tau, v
            return self.force(i + 1, *at) > slack or (self.force(i, *at) < -slack and not self.flaws.upper_exit)

        if not leaves(h):
            return end, x + v * h, v, mode
        tau = bisect(leaves, h)
        at = t + tau, x + v * tau, v
        return t + max(tau, 1e-12), at[1], v, i + (self.force(i + 1, *at) >= 0)


def exponential(M: np.ndarray) -> np.ndarray:
    """Return exp(M) by its power series, after halving M until it is small."""
    halvings = max(0, ceil(log2(max(float(np.max(np.abs(M))), 1e-300) / 0.02)))
    one = np.eye(len(M))
    found, small = one, M * 0.5**halvings
    for n in range(11, 0, -1):
        found = one + small @ found / n
    for _ in range(halvings):
        found = found @ found
    return found


def bisect(holds: Any, h: float) -> float:
    low, high = 0.0, h
    while high - low > SHORTEST * max(1.0, h):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


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
        scene = load_scene(str(rng.choice(["fig5", "fig6", "fig7", "fig9", "fig10", "fig9-orbit", "fig10-orbit"])))
        return replace(scene, t_end=scene.t0 + min(scene.t_end - scene.t0, 20))
    p = random_parameters(rng)
    t0, x0 = round(rng.uniform(0, 5), int(rng.integers(0, 5))), round(rng.uniform(-4, 4), int(rng.integers(0, 9)))
    v0 = float(rng.choice([float(p.v1), float(p.v2), round(rng.uniform(-6, 8), 3)]))
    t_end = round(t0 + min(rng.uniform(2, 8) * 2 * np.pi / float(p.Omega), 40.0), 2)
    exact = (read_exact(name, value) for name, value in (("t0", t0), ("x0", x0), ("v0", v0), ("t_end", t_end)))
    return Scene("random", p, *exact)  # type: ignore[arg-type]


def grid(scene: Scene, count: int) -> np.ndarray:
    return np.linspace(float(scene.t0), float(scene.t_end), count + 1)


def right(rng: np.random.Generator, most: int) -> Solution:
    """Return a right solution: dense or sparse, its times rounded or not, its start rounded or not."""
    scene, decimals = random_scene(rng), int(rng.integers(0, 6))
    count = int(np.exp(rng.uniform(np.log(30), np.log(most))))
    t, start = grid(scene, count), (float(scene.x0), float(scene.v0))
    if rng.random() < 0.3:
        start = (round(start[0], decimals), round(start[1], decimals))
    x, v = Solver(scene.parameters).solve(t, *start)
    kind = "right"
    if rng.random() < 0.3:
        chosen = np.unique([0, *rng.integers(1, count, count // 2), count])
        t, x, v, kind = t[chosen], x[chosen], v[chosen], "right, uneven"
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
    "misses sticks": Flaws(never_sticks=True, late=np.inf),  # it passes, at the end of a step
    "late events": Flaws(late=0.02),
    "static friction": Flaws(holds=1.3),
    "leaves sticks upward only": Flaws(upper_exit=True),
}
OTHERS = ("sine", "drift", "noise", "clock", "scale", "v late", "Euler", "outlier", "jump")
SIZED = ("drift", "noise", "outlier", "jump")  # as large as the decimals ask for
KINDS = (*PARTS, *FLAWS, *OTHERS)


def wrong(rng: np.random.Generator, kind: str, most: int) -> Solution | None:
    """Return a densely rounded wrong solution, or None if it is not far enough from the right one."""
    scene, decimals = random_scene(rng), int(rng.integers(0, 6))
    p, unit = scene.parameters, 10.0**-decimals
    t, start = grid(scene, int(np.exp(rng.uniform(np.log(400), np.log(most))))), (float(scene.x0), float(scene.v0))
    exact = np.array(Solver(p).solve(t, *start))

    def factor(low: float, high: float) -> Any:
        return read_exact("factor", round(1 + rng.choice([-1, 1]) * rng.uniform(low, high), 5))

    size = unit * DEVIATION * rng.uniform(1.1, 10)
    if kind in PARTS:
        change = PARTS[kind](p, factor)
        if change.get("v1", p.v1) >= p.v2:
            return None
        found = np.array(Solver(p.replace(**change)).solve(t, *start))
    elif kind in FLAWS:
        found = np.array(Solver(p, FLAWS[kind]).solve(t, *start))
    elif kind == "sine":
        found = np.array(Solver(p).solve(t - 0.5 * np.pi / float(p.Omega), *start))
    elif kind == "Euler":
        found = np.array(euler(p, t, *start))
    elif kind == "clock":
        found = np.array([np.interp(t * (1 + 1e-3), t, row) for row in exact])
    else:
        found = exact.copy()
        row, one = rng.integers(0, 2), rng.integers(1, len(t))
        if kind == "drift":
            found[row] += size * (t - t[0]) / (t[-1] - t[0])
        if kind == "noise":
            found[:, 1:] += size / 3.0 * rng.standard_normal((2, len(t) - 1))
        if kind == "scale":
            found[row, 1:] *= 1.01
        if kind == "v late":
            found[1, 1:] = exact[1, :-1]
        if kind == "outlier":
            found[row, one] += size
        if kind == "jump":
            found[row, one:] += size
    if kind not in SIZED:  # as few decimals as show it, or more
        most_off = float(np.max(np.abs(found - exact)))
        shown = [d for d in range(6) if most_off > 1.1 * DEVIATION * 10.0**-d]
        if not shown:
            return None
        decimals = int(rng.choice(shown))
    found = np.round(found, decimals)
    off_x, off_v = (np.max(np.abs(found - exact), axis=1) * 10.0**decimals).tolist()
    off = max(off_x, off_v)
    return Solution(scene, t, *found, decimals, kind, off, off_x) if off > DEVIATION else None


def euler(p: Parameters, t: np.ndarray, x: float, v: float) -> tuple[np.ndarray, np.ndarray]:
    """Return what a fixed step without events makes of it."""
    solver, found = Solver(p), [(x, v)]
    for now, h in zip(t.tolist(), np.diff(t).tolist(), strict=False):
        a = solver.force(int(v > solver.belts[0]) + int(v > solver.belts[1]), now, x, v)
        x, v = x + h * v, v + h * a
        found.append((x, v))
    x_found, v_found = np.array(found).T
    return x_found, v_found


def wrong_solutions(seed: int, count: int, most: int) -> Iterator[Solution]:
    """Return wrong solutions of all kinds in turn."""
    rng = np.random.default_rng(seed)
    tried = (wrong(rng, kind, most) for kind in cycle(KINDS))
    return islice((found for found in tried if found is not None), count)
