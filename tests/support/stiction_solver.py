"""A careful user of scipy who knows static friction, and the mistakes that others make.

A mass that reaches a belt sticks if the force needed to hold it is at most the static friction, and
slips when more is needed. Kinetic friction may depend on the relative speed. It shares nothing with
the package but the numbers of the oscillator.
"""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass, field
from math import cos, tanh
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from solution_families import states_of

from symosc import Oscillator

#: Tolerances at which solutions are right to about 1e-11.
TIGHT: dict[str, Any] = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
#: What two right solvers may decide differently, relative to the forces and to the speeds.
UNCLEAR = 1e-6
MOST_EVENTS = 400


class UnclearError(Exception):
    """Two right solvers may differ about this motion."""


@dataclass(frozen=True)
class Mistakes:
    """What a solver does wrong.

    Static friction is multiplied by `static`, but at least kinetic. With `crosses` a belt that is
    met is passed where kinetic friction does not hold the mass (Filippov). Slips come later by
    `delay`. Sticks shorter than `shortest` are passed over. A belt is met only if the speed is
    beyond it by `blind`. With `absolute` the friction curves are over |v|, not over the relative
    speed.
    """

    static: float = 1.0
    kinetic_only: bool = False
    crosses: bool = False
    delay: float = 0.0
    shortest: float = 0.0
    blind: float = 0.0
    absolute: bool = False


@dataclass
class Solved:
    """Steps of the solver, dense output of its pieces, and events (t, kind)."""

    pieces: list[np.ndarray] = field(default_factory=list)  # rows t, x, v
    dense: list[Any] = field(default_factory=list)
    events: list[tuple[float, str]] = field(default_factory=list)

    @property
    def own_steps(self) -> np.ndarray:
        """Rows t, x, v; times of joints come twice."""
        return np.hstack(self.pieces)

    def __call__(self, t: Any) -> np.ndarray:
        return states_of(self.pieces, self.dense, t)


class _Solver:
    def __init__(self, p: Oscillator, mistakes: Mistakes) -> None:
        self.m, self.c, self.k, self.A0, self.B0, self.Om, self.FN = (
            float(value) for value in (p.m, p.c, p.k, p.A0, p.B0, p.Omega, p.FN)
        )
        self.speeds = [float(belt.v) for belt in p.belts]
        self.kinetic = [float(belt.mu) * self.FN for belt in p.belts]
        self.curves = [
            (
                [float(w) for w, _ in belt.curve],
                [float(mu) for _, mu in belt.curve],
                float(belt.slope),
            )
            for belt in p.belts
        ]
        self.static = [float(belt.mu_s) * self.FN for belt in p.belts]
        if mistakes.kinetic_only:
            self.static = self.kinetic
        self.static = [
            max(most * mistakes.static, least)
            for most, least in zip(self.static, self.kinetic, strict=True)
        ]
        self.mistakes = mistakes
        self.solved = Solved()
        self.size = 1e-3

    def friction(self, n: int, v: float) -> float:
        """Return the size of the kinetic friction of a belt at a velocity."""
        speeds, values, slope = self.curves[n]
        if not speeds:
            return self.kinetic[n]
        w = abs(v) if self.mistakes.absolute else abs(v - self.speeds[n])
        i = bisect(speeds, w) - 1
        if i + 1 == len(speeds):
            return self.FN * (values[i] + slope * (w - speeds[i]))
        share = (w - speeds[i]) / (speeds[i + 1] - speeds[i])
        return self.FN * (values[i] + share * (values[i + 1] - values[i]))

    def others(self, t: float, x: float, v: float, at: int | None) -> float:
        """Return the force of everything but the belt `at`, in a domain or on this belt."""
        force = self.A0 + self.B0 * cos(self.Om * t) - self.k * x - self.c * v
        for n, speed in enumerate(self.speeds):
            if n != at:
                force += self.friction(n, v) if v < speed else -self.friction(n, v)
        return force

    def push(self, domain: int, t: float, x: float, v: float) -> float:
        """Return the acceleration above `domain` belts."""
        force = self.A0 + self.B0 * cos(self.Om * t) - self.k * x - self.c * v
        for n in range(len(self.speeds)):
            force += self.friction(n, v) if n >= domain else -self.friction(n, v)
        return force / self.m

    def clear(self, value: float) -> float:
        """Return a number that decides; UnclearError if it is too near to 0."""
        if self.mistakes == Mistakes() and abs(value) < UNCLEAR * self.size:
            raise UnclearError
        return value

    def run(self, t: float, x: float, v: float, t_end: float) -> Solved:
        forces = [abs(self.A0), abs(self.B0), *self.static, abs(self.k * x), abs(self.c * v)]
        self.size = max(forces) + 1e-3
        domain = sum(v > speed for speed in self.speeds)
        if v in self.speeds:
            belt = self.speeds.index(v)
            domain = self.at_belt(belt, t, x, None)
            if domain < 0:
                t, x, domain = self.stick(belt, t, x, t_end)
        while t < t_end:
            t, x, v, belt = self.fly(domain, t, x, v, t_end)
            if belt is None or t >= t_end:
                break
            source = domain
            domain = self.at_belt(belt, t, x, source)
            v = self.speeds[belt]
            if domain < 0:
                self.solved.events.append((t, "stick"))
                t, x, domain = self.stick(belt, t, x, t_end)
            elif domain != source:
                self.solved.events.append((t, "cross"))
            if len(self.solved.events) > MOST_EVENTS:
                raise UnclearError
        return self.solved

    def at_belt(self, belt: int, t: float, x: float, source: int | None) -> int:
        """Return the domain in which the motion goes on from a belt, -1 if it sticks."""
        needed = self.others(t, x, self.speeds[belt], belt)
        limit = self.static[belt]
        if self.mistakes.crosses and source is not None:
            limit = self.kinetic[belt]
        if self.clear(abs(needed) - limit) > 0.0:
            return belt + int(needed > 0.0)
        if self.mistakes.shortest and source is not None:
            times = np.linspace(t, t + self.mistakes.shortest, 50)
            ahead = [
                self.others(s, x + self.speeds[belt] * (s - t), self.speeds[belt], belt)
                for s in times
            ]
            beyond = np.flatnonzero(np.abs(ahead) > limit)
            if len(beyond):
                return belt + int(ahead[int(beyond[0])] > 0.0)
        return -1

    def stick(self, belt: int, t: float, x: float, t_end: float) -> tuple[float, float, int]:
        """Follow a stick; return where it ends and the domain behind it."""
        speed = self.speeds[belt]
        begin = t
        start = x

        def spare(s: float, y: Any) -> float:
            return self.static[belt] - abs(self.others(s, float(y[0]), speed, belt))

        spare.terminal = True  # type: ignore[attr-defined]
        spare.direction = -1  # type: ignore[attr-defined]
        held = solve_ivp(
            lambda s, y: [speed], (t, t_end), [x], events=spare, **TIGHT,
            max_step=0.02 / max(self.Om, (self.k / self.m) ** 0.5, 0.1), dense_output=True,
        )  # fmt: skip
        t = float(held.t[-1])
        if len(held.t_events[0]):
            nodes = np.linspace(begin, t, 400)[1:-4]
            # A force that nearly reaches the limit before is one that others may see reach it.
            least = [spare(s, [start + speed * (s - begin)]) for s in nodes]
            if len(least):
                self.clear(float(np.min(least)))
            if t == begin:
                raise UnclearError
        moved = held.t
        if self.mistakes.delay and len(held.t_events[0]):
            t = min(max(begin, t + self.mistakes.delay), t_end)
            moved = np.append(held.t[held.t < t], t)
        x = start + speed * (t - begin)
        self.solved.pieces.append(
            np.vstack([moved, start + speed * (moved - begin), np.full(len(moved), speed)])
        )
        self.solved.dense.append(
            lambda s: np.vstack([start + speed * (s - begin), np.full(len(s), speed)])
        )
        needed = self.others(t, x, speed, belt)
        if t < t_end:
            self.solved.events.append((t, "slip"))
        return t, x, belt + int(needed > 0.0)

    def fly(
        self, domain: int, t: float, x: float, v: float, t_end: float
    ) -> tuple[float, float, float, int | None]:
        """Follow a flight; return where it ends, and the belt that it meets."""
        walls = []
        for belt, direction in ((domain - 1, -1), (domain, 1)):
            if 0 <= belt < len(self.speeds):
                wall = self.speeds[belt] + direction * self.mistakes.blind

                def meets(s: float, y: Any, wall: float = wall) -> float:
                    return float(y[1]) - wall

                meets.terminal = True  # type: ignore[attr-defined]
                meets.direction = direction  # type: ignore[attr-defined]
                walls.append((belt, meets))
        rate = max(self.Om, (self.k / self.m) ** 0.5, 0.1)
        flight = solve_ivp(
            lambda s, y: (y[1], self.push(domain, s, y[0], y[1])), (t, t_end), [x, v],
            events=[meets for _, meets in walls] or None, dense_output=True, max_step=0.1 / rate, **TIGHT,
        )  # fmt: skip
        if self.mistakes == Mistakes():
            self.refuse_touches(domain, flight)
        self.solved.pieces.append(np.vstack([flight.t, flight.y]))
        self.solved.dense.append(flight.sol)
        for (belt, _), times in zip(walls, flight.t_events or (), strict=True):
            if len(times):
                return float(flight.t[-1]), float(flight.y[0, -1]), float(flight.y[1, -1]), belt
        return t_end, float(flight.y[0, -1]), float(flight.y[1, -1]), None

    def refuse_touches(self, domain: int, flight: Any) -> None:
        """Raise UnclearError if the speed nearly touches that of a belt."""
        fine = flight.sol(np.linspace(flight.t[0], flight.t[-1], 8 * len(flight.t) + 1))[1]
        largest = float(np.max(np.abs(fine))) + 1e-3
        inner = np.flatnonzero((np.diff(fine)[1:] * np.diff(fine)[:-1]) <= 0.0) + 1
        for i in inner.tolist():
            gaps = [abs(fine[i] - speed) for speed in self.speeds]
            # Between the nodes it may be nearer by the bend of the curve.
            bend = abs(fine[i + 1] - 2.0 * fine[i] + fine[i - 1])
            if min(gaps) < UNCLEAR * largest + bend:
                raise UnclearError


def solved(
    p: Oscillator, start: tuple[float, float, float], t_end: float, mistakes: Mistakes | None = None
) -> Solved:
    """Integrate an oscillator from event to event; UnclearError if its events are not clear."""
    return _Solver(p, mistakes or Mistakes()).run(*start, t_end)


def regularised(
    p: Oscillator, start: tuple[float, float, float], times: np.ndarray, width: float
) -> np.ndarray:
    """Return rows x, v of the motion with tanh friction that has a peak of static friction."""
    solver = _Solver(p, Mistakes())

    def slopes(t: float, y: Any) -> tuple[float, float]:
        x, v = y
        force = solver.A0 + solver.B0 * cos(solver.Om * t) - solver.k * x - solver.c * v
        for n, (speed, static) in enumerate(zip(solver.speeds, solver.static, strict=True)):
            kinetic = solver.friction(n, v)
            z = (v - speed) / width
            force -= tanh(z) * (kinetic + (static - kinetic) * float(np.exp(-min(z * z, 50.0) / 4)))
        return v, force / solver.m

    path = solve_ivp(
        slopes,
        (start[0], float(times[-1])),
        start[1:],
        "Radau",
        t_eval=times,
        rtol=1e-9,
        atol=1e-11,
    )
    return path.y
