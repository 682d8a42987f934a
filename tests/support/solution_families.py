"""Random solutions of random scenes by five integrators that begin again at events: right ones and wrong ones.

The event logic is the simplest that is right: the forces just below and just above a belt decide what happens there.
Motions that nearly touch a belt, or whose next mode hangs on a force near 0, are left out: there two right solvers
may differ.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import cos, pi
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from symosc import Parameters

Rng = np.random.Generator
State = tuple[float, float, float]


def states_of(pieces: list[np.ndarray], dense: list[Any], t: Any) -> np.ndarray:
    """Return the rows x and v at times, from the dense output of the piece in which each lies."""
    times = np.atleast_1d(np.asarray(t, dtype=float))
    begins = np.array([piece[0, 0] for piece in pieces])
    numbers = np.clip(np.searchsorted(begins, times, "right") - 1, 0, len(begins) - 1)
    states = np.empty((2, len(times)))
    for number in np.unique(numbers).tolist():
        here = numbers == number
        states[:, here] = dense[number](times[here])
    return states


#: Tolerances and longest steps (in units of 1/rate) at which events and dense output are right to about 1e-10.
METHODS: dict[str, dict[str, Any]] = {
    "DOP853": {"rtol": 1e-12, "atol": 1e-13, "max_step": 0.1},
    "RK45": {"rtol": 1e-11, "atol": 1e-12, "max_step": 0.05},
    "LSODA": {"rtol": 1e-11, "atol": 1e-12, "max_step": 0.05},
    "Radau": {"rtol": 1e-9, "atol": 1e-10, "max_step": 0.03},
}
#: What a solution that is right to 1e-10 cannot tell apart, relative to the largest |v| or acceleration.
UNCLEAR = 1e-5


class UnclearError(Exception):
    """Two right solvers may differ about this motion."""


@dataclass(frozen=True)
class Problem:
    """A scene: parameters, a start and an end."""

    p: Parameters
    start: State
    t_end: float

    @property
    def rate(self) -> float:
        return max(float(self.p.Omega), float(self.p.k / self.p.m) ** 0.5)


@dataclass(frozen=True)
class Flaws:
    """What a solver does wrong: the belt that it does not see, and how many contacts it reacts to too late.

    A stick holds up to `static` times the friction. From the contact number `late` on, whatever happens at a belt
    happens `delay` too late.
    """

    unseen: int = 0
    static: float = 1.0
    late: int = 10**6
    delay: float = 0.0


@dataclass
class Solution:
    """The pieces of a solution between events: own steps and dense output of each, and the events."""

    steps: list[np.ndarray] = field(default_factory=list)  # rows t, x, v of each piece
    dense: list[Callable[[np.ndarray], np.ndarray]] = field(default_factory=list)
    sticks: list[bool] = field(default_factory=list)
    events: list[tuple[float, str, int]] = field(default_factory=list)  # t, kind, belt

    def __call__(self, t: Any) -> np.ndarray:
        """Return the rows x and v at times."""
        return states_of(self.steps, self.dense, t)

    @property
    def own_steps(self) -> np.ndarray:
        """Rows t, x, v of all steps; times of joints come twice."""
        return np.hstack(self.steps)


def solved(
    problem: Problem, method: str = "DOP853", flaws: Flaws | None = None, **options: Any
) -> Solution:
    """Integrate a problem from event to event; raise UnclearError if its events are not clear."""
    p = problem.p
    flaws = flaws or Flaws()
    m, c, k, B0, Omega = (float(value) for value in (p.m, p.c, p.k, p.B0, p.Omega))
    speeds = [float(p.v1), float(p.v2)]
    friction = [float(p.mu1 * p.FN), float(p.mu2 * p.FN)]
    control = METHODS[method] | options
    control["max_step"] /= problem.rate
    if method == "Radau":
        control["jac"] = np.array([[0.0, 1.0], [-k / m, -c / m]])

    def push(domain: int, t: float, x: float, v: float) -> float:
        """Return the acceleration above `domain` of the belts: 0, 1 or 2."""
        signs = [-1.0 if domain > belt else 1.0 for belt in (0, 1)]
        held = sum(sign * force for sign, force in zip(signs, friction, strict=True))
        return (float(p.A0) + B0 * cos(Omega * t) - k * x - c * v + held) / m

    solution = Solution()
    t, x, v = problem.start
    largest = (
        max(abs(push(domain, t, x, v)) for domain in (0, 1, 2) if domain < 2 or speeds[1] < 1e3)
        + 1e-3
    )

    def clear(value: float) -> float:
        if abs(value) < UNCLEAR * largest:
            raise UnclearError
        return value

    def fly(domain: int, t: float, x: float, v: float, until: float, seen: tuple[int, ...]) -> Any:
        walls = []
        for belt, direction in ((domain - 1, -1), (domain, 1)):
            if belt in seen:
                walls.append(_wall(speeds[belt], direction))
        span = (t, until)
        flight = solve_ivp(
            lambda t, y: (y[1], push(domain, t, y[0], y[1])),
            span, (x, v), method, events=walls or None, dense_output=True, **control,
        )  # fmt: skip
        solution.steps.append(np.vstack([flight.t, flight.y]))
        solution.dense.append(flight.sol)
        solution.sticks.append(False)
        fine = flight.sol(np.linspace(flight.t[0], flight.t[-1], 8 * len(flight.t) + 1))[1][1:-1]
        for belt, side in ((domain - 1, 1.0), (domain, -1.0)):
            if belt in seen and flaws == Flaws():
                _refuse_touches(
                    side * (fine - speeds[belt]), UNCLEAR * (1.0 + np.max(np.abs(fine)))
                )
        return flight

    seen = tuple(belt for belt in (0, 1) if belt + 1 != flaws.unseen)
    at = next((belt for belt in seen if v == speeds[belt]), None)
    domain = sum(v > speed for i, speed in enumerate(speeds) if i in seen)
    source = None
    contacts = 0
    while t < problem.t_end:
        if at is not None:
            v = speeds[at]
            contacts += 1
            if contacts > flaws.late and source is not None:
                late = fly(source, t, x, v, min(t + flaws.delay, problem.t_end), ())
                t, (x, _) = float(late.t[-1]), late.y[:, -1].tolist()
                if t >= problem.t_end:
                    break
            low = clear(push(at, t, x, v))
            high = clear(push(at + 1, t, x, v))
            if low > 0.0 > high:
                if source is not None:
                    solution.events.append((t, "stick", at + 1))
                hold = (flaws.static - 1.0) * friction[at] / m
                end, domain = _stick_end(problem, t, x, v, [
                    lambda t, x, at=at, v=v, hold=hold: push(at, t, x, v) + hold,
                    lambda t, x, at=at, v=v, hold=hold: hold - push(at + 1, t, x, v)], at)  # fmt: skip
                times = np.unique(np.append(np.arange(t, end, 0.05 / problem.rate), end))
                times = times if len(times) > 1 else np.array([t, end])
                line = _line(t, x, v)
                solution.steps.append(np.vstack([times, line(times)]))
                solution.dense.append(line)
                solution.sticks.append(True)
                x = float(line(np.array([end]))[0, 0])
                t = end
                if end >= problem.t_end:
                    break
                solution.events.append((t, "slip", at + 1))
            else:
                domain = at + 1 if high > 0.0 else at
                if source is not None and domain != source:
                    solution.events.append((t, "cross", at + 1))
        # From a belt the flight begins with the belt's speed and its first step leaves it.
        begin = min(t + 1e-3 / problem.rate, problem.t_end) if at is not None else t
        if begin > t:
            first = fly(domain, t, x, v, begin, tuple(belt for belt in seen if belt != at))
            t, (x, v) = float(first.t[-1]), first.y[:, -1].tolist()
            if (first.status == 1) or (v - speeds[at]) * (1.0 if domain == at + 1 else -1.0) <= 0.0:
                raise UnclearError
            if t >= problem.t_end:
                break
        flight = fly(domain, t, x, v, problem.t_end, seen)
        t, (x, v) = float(flight.t[-1]), flight.y[:, -1].tolist()
        source = domain
        at = min(seen, key=lambda belt, v=v: abs(v - speeds[belt])) if flight.status == 1 else None
        if len(solution.steps) > 60:
            raise UnclearError
    return solution


def _wall(speed: float, direction: int) -> Callable[..., float]:
    """Return an event function of solve_ivp: v passes a belt's speed."""

    def event(t: float, y: Any) -> float:
        return float(y[1]) - speed

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = direction  # type: ignore[attr-defined]
    return event


def _line(t0: float, x0: float, v: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return the states of a stick."""
    return lambda t: np.vstack([x0 + v * (t - t0), np.full(len(t), v)])


def _refuse_touches(gaps: np.ndarray, unclear: float) -> None:
    """Raise UnclearError if a flight inside a domain, `gaps` away from a belt, touches or nearly touches it."""
    if len(gaps) < 3:
        return
    lowest = (gaps[1:-1] <= gaps[:-2]) & (gaps[1:-1] <= gaps[2:])
    if np.any(gaps[1:-1][lowest] < unclear):
        raise UnclearError


def _stick_end(
    problem: Problem,
    t: float,
    x: float,
    v: float,
    holds: list[Callable[[float, float], float]],
    at: int,
) -> tuple[float, int]:
    """Return when the first of two forces that hold a stick turns negative, and the domain that it then enters."""
    step = 0.01 / problem.rate
    a = t
    while a < problem.t_end:
        b = min(a + step, problem.t_end)
        for entered, hold in zip((at, at + 1), holds, strict=True):
            after = hold(b, x + v * (b - t))
            if after < 0.0:
                root = brentq(
                    lambda s, hold=hold: hold(s, x + v * (s - t)), a, b, xtol=1e-15, rtol=1e-15
                )
                return float(root), entered
        a = b
    return problem.t_end, 0


# -- problems ----------------------------------------------------------------------------------------------------------


def random_problem(rng: Rng, belts: int) -> Problem:
    """Return a random problem with two belts, or with a second one so far away that it is never met."""
    B0 = rng.uniform(0.5, 6)
    values: dict[str, float] = {
        "m": rng.uniform(0.3, 2),
        "c": rng.choice([0.0, rng.uniform(0, 0.8)]),
        "k": rng.uniform(0.5, 6),
        "A0": rng.uniform(-3, 3),
        "B0": B0,
        "Omega": rng.uniform(0.4, 4),
        "v1": rng.choice([0.0, rng.uniform(-1.5, 1)]),
        "FN": rng.uniform(0.2, 3) * B0,
        "mu1": rng.uniform(0.05, 0.5),
        "mu2": rng.uniform(0.05, 0.5),
    }
    values = {name: round(float(value), 3) for name, value in values.items()}
    values["v2"] = round(values["v1"] + rng.uniform(0.3, 2), 3)
    if belts == 1:
        values["v2"] = float(rng.choice([1e2, 1e4, 1e6, 1e9]))
        values["mu2"] = float(rng.choice([0.0, values["mu2"]]))
    p = Parameters(**values)
    rate = max(values["Omega"], (values["k"] / values["m"]) ** 0.5)
    t0 = round(float(rng.choice([0.0, rng.uniform(0, 5)])), 3)
    start = (
        t0,
        round(rng.uniform(-2, 2), 3),
        round(float(rng.choice([values["v1"], rng.uniform(-2, 2)])), 3),
    )
    return Problem(p, start, t0 + round(rng.uniform(6, 14) / rate, 3))


def problems(seed: int) -> Iterator[tuple[Problem, Solution]]:
    """Yield random problems with clear events, every second one with one belt, and tight solutions by DOP853."""
    rng = np.random.default_rng(seed)
    belts = 1
    while True:
        problem = random_problem(rng, belts)
        try:
            solution = solved(problem)
        except UnclearError:
            continue
        moves = np.ptp(solution.own_steps[2]) > 1e-3
        if moves and (solution.events or rng.random() < 0.1):
            yield problem, solution
            belts = 3 - belts


def scales_of(solution: Solution) -> np.ndarray:
    """Return the largest |x| and |v| of a solution."""
    return np.max(np.abs(solution.own_steps[1:]), axis=1)


def even_times(problem: Problem, rng: Rng, least: int = 60, most: int = 600) -> np.ndarray:
    """Return evenly spaced times from the start to the end of a problem."""
    count = int(np.exp(rng.uniform(np.log(least), np.log(most))))
    return np.linspace(problem.start[0], problem.t_end, count + 1)


def periods(problem: Problem) -> float:
    """Return the shorter of the periods of the drive and of the free motion."""
    return 2.0 * pi / problem.rate
