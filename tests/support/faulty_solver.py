"""A solver with faults to order.

Event by event in closed form, or by a fixed-step method, on a grid of times.

It shares the closed form of a flight with symosc, and none of its event logic: that is what is made
wrong here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from math import cos, inf, sin, tanh
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from symosc import Parameters, load_scene
from symosc.engine.arithmetic import Arithmetic
from symosc.friction import NEIGHBOURS
from symosc.kernels._generated import acceleration, motion
from symosc.kernels.entire import basis


@dataclass(frozen=True)
class Flaw:
    """What a solver does wrong.

    Attributes
    ----------
    force : tuple of three floats or None
        A1 to A3 over m, if they are not those of the parameters.
    late : bool
        An event happens at the next point of the grid, with the state there.
    early : float
        A stick is left this part of its own length too early; if negative, too late.
    static : float
        A stick holds up to this many times the friction of the flight.
    drift : float
        In a stick the velocity runs away from the belt's by this acceleration.
    method : str or None
        Flights are integrated by one of METHODS, one step from one point of the grid to the next.
    linear : bool
        A belt is met where a straight line in v between two points of the grid meets it, at the x
        of such a line.
    ignored : int
        Flights go over this belt as if it were not there.
    """

    force: tuple[float, float, float] | None = None
    late: bool = False
    early: float = 0.0
    static: float = 1.0
    drift: float = 0.0
    method: str | None = None
    linear: bool = False
    ignored: int = 0


@dataclass
class Course:
    """What a solver did: samples at the grid (and at events where `joints`), and events."""

    t: list[float] = field(default_factory=list)
    x: list[float] = field(default_factory=list)
    v: list[float] = field(default_factory=list)
    events: list[tuple[float, str]] = field(default_factory=list)

    def add(self, t: float, x: float, v: float) -> None:
        self.t.append(t)
        self.x.append(x)
        self.v.append(v)

    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return np.array(self.t), np.array(self.x), np.array(self.v)


class Solver:
    """An event-driven solver of one parameter set, with a flaw."""

    def __init__(self, parameters: Parameters, flaw: Flaw, joints: bool = False) -> None:
        self.p, self.flaw, self.joints = parameters, flaw, joints
        self.K = Arithmetic(parameters).K
        self.A = flaw.force or (self.K.A1, self.K.A2, self.K.A3)
        self.belts = (self.K.belt1.v, self.K.belt2.v)
        self.mode, self.since, self.ends, self.bias = 0, 0.0, inf, 0.0
        self.out = Course()

    def force(self, domain: int, t: float, x: float, v: float) -> float:
        return float(
            acceleration(
                x, v, cos(self.K.Om * t), self.A[domain - 1], self.K.cm, self.K.w0sq, self.K.f0
            )
        )

    def flight(self, domain: int, t: float, x: float, v: float, dt: float) -> tuple[float, float]:
        if self.flaw.method:
            return METHODS[self.flaw.method](
                lambda t, x, v: self.force(domain, t, x, v), t, x, v, dt
            )
        theta = self.K.Om * t
        K = self.K
        E0, E1, E2, R2, I2 = basis(dt, K)[:5]
        a = self.force(domain, t, x, v)
        dx, dv, _ = motion(
            v, a, sin(theta), cos(theta), K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2
        )
        return float(x + dx), float(v + dv)

    def run(self, grid: np.ndarray, x: float, v: float) -> Course:
        times = grid.tolist()
        at = next((b for b in (1, 2) if v == self.belts[b - 1]), 0)
        self.mode = 1 + (v > self.belts[0]) + (v > self.belts[1])
        self.out.add(times[0], x, v)
        if at:
            v = self.decide(at, times[0], x, v, None)
        for begin, end in pairwise(times):
            t = begin
            for _ in range(50):
                if self.mode > 3:
                    t, x, v = self.stick(t, x, v, end)
                else:
                    t, x, v = self.fly(t, x, v, end)
                if t >= end:
                    break
                if self.joints:
                    self.out.add(t, x, v)
            self.out.add(end, x, v)
        return self.out

    def decide(self, b: int, t: float, x: float, v: float, source: int | None) -> float:
        """Say what happens at belt `b`; return the velocity afterwards."""
        below, above = NEIGHBOURS[b]
        low, high = (self.force(domain, t, x, self.belts[b - 1]) for domain in (below, above))
        if low > 0.0 > high:
            self.mode, self.since, self.ends = 3 + b, t, self.exit_time(b, t, x)
            kind = "stick"
            v = self.belts[b - 1]
        else:
            if source:
                self.mode, kind = (above if source == below else below, "cross")
            else:
                self.mode, kind = (above, "")
            if not source:
                if high >= 0.0:
                    self.mode = above
                else:
                    self.mode = below
        if source:
            self.out.events.append((t, kind))
        return v

    def exit_time(self, b: int, t: float, x: float) -> float:
        """Return when a stick is to be left, for a solver that leaves too early.

        Others look for it.
        """
        if not self.flaw.early:
            return inf
        v = self.belts[b - 1]
        (below, above) = NEIGHBOURS[b]
        step = self.K.period / 2000

        def holds(s: float) -> float:
            """Return by how much the belt holds the mass at a time, negative if it does not."""
            x_then = x + v * (s - t)
            return min(self.force(below, s, x_then, v), -self.force(above, s, x_then, v))

        for i in range(1, 20000):
            s = t + i * step
            if holds(s) < 0.0:
                if holds(s - step) > 0.0:
                    s = brentq(holds, s - step, s)
                return t + (s - t) * (1.0 - self.flaw.early)
        return inf

    def stick(self, t: float, x: float, v: float, end: float) -> tuple[float, float, float]:
        b = self.mode - 3
        speed = self.belts[b - 1]
        (below, above) = NEIGHBOURS[b]
        more = (self.flaw.static - 1.0) * 0.5 * (self.A[below - 1] - self.A[above - 1])

        def place(s: float) -> float:
            return (
                x
                + speed * (s - t)
                + self.flaw.drift * ((s - self.since) ** 2 - (t - self.since) ** 2) / 2
            )

        exits = [lambda s: self.force(below, s, place(s), speed) + more,
                 lambda s: more - self.force(above, s, place(s), speed)]  # fmt: skip
        left = min(
            (brentq(f, t, end) if f(t) > 0.0 else t for f in exits if f(end) < 0.0), default=inf
        )
        if self.flaw.early < 0.0:  # too late
            time = self.ends
        else:
            time = min(left, self.ends)
        if time >= end:
            return end, place(end), speed + self.flaw.drift * (end - self.since)
        if self.flaw.late:
            time = end
        x = place(time)
        low = self.force(below, time, x, speed)
        high = self.force(above, time, x, speed)
        if abs(low) < abs(high):
            self.mode = below
        else:
            self.mode = above
        # Too early: outwards, and the belt is looked at only from the other side.
        if self.ends < inf and self.flaw.early > 0.0:
            if self.mode == below:
                self.bias = speed + 1e-12
            else:
                self.bias = speed - 1e-12
        self.ends = inf
        self.out.events.append((time, "slip"))
        return time, x, speed + self.flaw.drift * (time - self.since)

    def fly(self, t: float, x: float, v: float, end: float) -> tuple[float, float, float]:
        domain = self.mode
        after = self.flight(domain, t, x, v, end - t)
        if domain > 1:
            low = self.belts[domain - 2]
        else:
            low = -inf
        if domain < 3:
            high = self.belts[domain - 1]
        else:
            high = inf
        if domain - 1 == self.flaw.ignored:
            low = -inf
        if domain == self.flaw.ignored:
            high = inf
        if self.bias:  # it left a stick too early: it may be on the wrong side for a while
            if low < after[1] < high:
                self.bias = 0.0
            return end, *after
        if low <= after[1] <= high:
            return end, *after
        if after[1] < low:
            b = domain - 1
        else:
            b = domain
        speed = self.belts[b - 1]
        if self.flaw.late:
            return end, after[0], self.decide(b, end, after[0], after[1], domain)

        def gap(s):
            return self.flight(domain, t, x, v, s)[1] - speed

        if gap(0.0) * gap(end - t) < 0.0:
            start = 0.0
        else:
            start = next(
                (
                    part * (end - t)
                    for part in (0.01, 0.1, 0.3, 0.5, 0.7, 0.9)
                    if gap(part * (end - t)) * gap(end - t) < 0
                ),
                None,
            )
        if start is None:
            tau = 0.0
        else:
            tau = brentq(gap, start, end - t, xtol=1e-15, rtol=1e-15)
        if self.flaw.linear and start == 0.0:
            part = (speed - v) / (after[1] - v)
            tau = part * (end - t)
            x = x + part * (after[0] - x)
        else:
            x = self.flight(domain, t, x, v, tau)[0]
        return t + tau, x, self.decide(b, t + tau, x, speed, domain)


Acceleration = Callable[[float, float, float], float]


def euler(a: Acceleration, t: float, x: float, v: float, h: float) -> tuple[float, float]:
    return x + h * v, v + h * a(t, x, v)


def heun(a: Acceleration, t: float, x: float, v: float, h: float) -> tuple[float, float]:
    k = a(t, x, v)
    return x + h * v + h * h * k / 2, v + h * (k + a(t + h, x + h * v, v + h * k)) / 2


def rk4(a: Acceleration, t: float, x: float, v: float, h: float) -> tuple[float, float]:
    k1 = a(t, x, v)
    k2 = a(t + h / 2, x + h / 2 * v, v + h / 2 * k1)
    k3 = a(t + h / 2, x + h / 2 * (v + h / 2 * k1), v + h / 2 * k2)
    k4 = a(t + h, x + h * (v + h / 2 * k2), v + h * k3)
    return x + h * v + h * h * (k1 + k2 + k3) / 6, v + h * (k1 + 2 * k2 + 2 * k3 + k4) / 6


def leapfrog(a: Acceleration, t: float, x: float, v: float, h: float) -> tuple[float, float]:
    half = v + h / 2 * a(t, x, v)
    return x + h * half, half + h / 2 * a(t + h, x + h * half, half)


def verlet(a: Acceleration, t: float, x: float, v: float, h: float) -> tuple[float, float]:
    first = a(t, x, v)
    ahead = x + h * v + h * h / 2 * first
    return ahead, v + h / 2 * (first + a(t + h, ahead, v + h * first))


def weighted(*w: float) -> Any:
    """Return RK4 with other weights."""

    def step(a: Acceleration, t: float, x: float, v: float, h: float) -> tuple[float, float]:
        k1 = a(t, x, v)
        k2 = a(t + h / 2, x + h / 2 * v, v + h / 2 * k1)
        k3 = a(t + h / 2, x + h / 2 * (v + h / 2 * k1), v + h / 2 * k2)
        k4 = a(t + h, x + h * (v + h / 2 * k2), v + h * k3)
        u = v, v + h / 2 * k1, v + h / 2 * k2, v + h * k3
        return (x + h * sum(w[i] * u[i] for i in range(4)),
                v + h * sum(w[i] * k for i, k in enumerate((k1, k2, k3, k4))))  # fmt: skip

    return step


METHODS: dict[str, Any] = {
    "euler": euler,
    "heun": heun,
    "rk4": rk4,
    "leapfrog": leapfrog,
    "verlet": verlet,
    "rk4 1111": weighted(1 / 4, 1 / 4, 1 / 4, 1 / 4),
    "rk4 2112": weighted(1 / 3, 1 / 6, 1 / 6, 1 / 3),
    "rk4 1221/5": weighted(1 / 5, 2 / 5, 2 / 5, 1 / 5),
}


def without_events(
    p: Parameters, grid: np.ndarray, x: float, v: float, method: Any = rk4, held: bool = False
) -> tuple[np.ndarray, ...]:
    """Integrate with the sign of v - v_belt as it is at each stage.

    It chatters about a belt that holds.

    `held`: with the sign at the beginning of each step.
    """
    solver = Solver(p, Flaw())
    belts = solver.belts
    rows = [(x, v)]
    for t, end in zip(grid[:-1].tolist(), grid[1:].tolist(), strict=True):
        begin = rows[-1][1]

        def a(t: float, x: float, v: float, begin: float = begin) -> float:
            if held:
                sign = begin
            else:
                sign = v
            return solver.force(1 + (sign > belts[0]) + (sign > belts[1]), t, x, v)

        rows.append(method(a, t, *rows[-1], end - t))
    return grid, *np.array(rows).T


#: Curves of friction that is smoothed, from -1 to 1.
CURVES: dict[str, Callable[[float], float]] = {
    "tanh": tanh,
    "arctan": lambda z: float(np.arctan(z) * 2.0 / np.pi),
    "root": lambda z: z / (1.0 + z * z) ** 0.5,
}


def smoothed(
    p: Parameters,
    grid: np.ndarray,
    x: float,
    v: float,
    width: float,
    curve: str,
    more: Callable[[float], float] = lambda v: 0.0,
) -> tuple[np.ndarray, ...]:
    """Integrate with friction that goes from -1 to 1 by a smooth curve of (v - v_belt) / width.

    The acceleration `more` of v is added.
    """
    solver = Solver(p, Flaw())
    form = CURVES[curve]
    A1, A2, A3 = solver.A
    (low, high) = solver.belts
    K = solver.K

    def right(t: float, y: Any) -> list[float]:
        push = (
            (A1 + A3) / 2
            - (A1 - A2) / 2 * form((y[1] - low) / width)
            - (A2 - A3) / 2 * form((y[1] - high) / width)
        )
        return [y[1], more(y[1]) + push + K.f0 * cos(K.Om * t) - K.w0sq * y[0] - K.cm * y[1]]

    found = solve_ivp(
        right, (grid[0], grid[-1]), [x, v], "LSODA", t_eval=grid, rtol=1e-10, atol=1e-11
    )
    return found.t, *found.y


def solved(
    flaw: Flaw,
    name: str = "fig10",
    t_end: float = 10.0,
    count: int = 161,
    every: int = 4,
    **more: Any,
) -> Any:
    """Return what a solver with a flaw makes of a scene, in steps of which every n-th ends at a sample."""
    scene = load_scene(name)
    grid = np.linspace(float(scene.t0), t_end, (count - 1) * every + 1)
    run = Solver(scene.parameters, flaw, **more).run(grid, float(scene.x0), float(scene.v0))
    return name, *(column[:: 1 if more else every] for column in run.arrays())


def softened(
    curve: str, width: float, name: str = "fig10", t_end: float = 10.0, count: int = 161
) -> Any:
    scene = load_scene(name)
    times = np.linspace(float(scene.t0), t_end, count)
    return name, *smoothed(scene.parameters, times, float(scene.x0), float(scene.v0), width, curve)
