"""A careful user of scipy, and random parameters: solutions from outside for cross-checks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from symosc import Parameters, Scene
from symosc.bench.event_logic import (
    EVENT_KINDS,
    PeerError,
    PeerProblem,
    force,
    margins,
    problem,
    start_mode,
    with_solver,
)
from symosc.bench.peers_scipy import SIDES

TIGHT = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
# After a stick or a crossing the solver starts this far off the belt, or it would meet the belt at
# once.
OFF = 1e-12
# Along a stick any step is accurate: without a limit it would grow past the end of the stick.
LONGEST_STICK_STEP = 0.02


@dataclass
class Run:
    """Samples of an event-driven solver, and the events that it saw.

    `joined` keeps both samples at a joint.
    """

    t: list[float] = field(default_factory=list)
    x: list[float] = field(default_factory=list)
    v: list[float] = field(default_factory=list)
    events: list[tuple[float, str]] = field(default_factory=list)
    joined: bool = False

    def add(self, t: Any, x: Any, v: Any) -> None:
        for row in zip(t, x, v, strict=True):
            if self.joined or not self.t or row[0] > self.t[-1]:
                for values, value in zip((self.t, self.x, self.v), row, strict=True):
                    values.append(float(value))


def piece(
    options: dict[str, Any], q: PeerProblem, mode: int, x: float, v: float, t_end: float
) -> tuple[int, Any, Any, Any]:
    """Follow a flight or stick by solve_ivp; return the side where it ends, and its samples."""

    def margin(place: int, t: float, y: Any) -> float:
        speed = y[1] if mode < 4 else v
        return margins(q, mode, t, y[0], speed)[place]

    ends: list[Any] = [partial(margin, int(side > 0)) for side in SIDES[mode]]
    for end in ends:
        end.terminal = True
        end.direction = -1
    if mode < 4:
        solution = solve_ivp(
            lambda t, y: [y[1], force(q, mode, t, *y)], (0.0, t_end), [x, v], events=ends, **options
        )
        speeds = solution.y[1]
    else:
        limited = {"max_step": LONGEST_STICK_STEP, **options}
        solution = solve_ivp(lambda t, y: [v], (0.0, t_end), [x], events=ends, **limited)
        speeds = np.full(len(solution.t), v)
    side = 0
    for exit_side, times in zip(SIDES[mode], solution.t_events, strict=True):
        if len(times):
            side = exit_side
    return side, solution.t, solution.y[0], speeds


def recording(run: Run, options: dict[str, Any]) -> Callable[..., tuple[int, float, float]]:
    """Return the function `leave` of the event logic for solve_ivp, which adds samples to `run`."""
    begin = run.t[0]

    def leave(
        q: PeerProblem, settings: None, mode: int, t: float, x: float, v: float, t_end: float
    ) -> tuple[int, float, float]:
        nonlocal begin
        side, times, places, speeds = piece(options, q, mode, x, v, t_end)
        run.add(begin + times, places, speeds)
        begin += float(times[-1])
        return side, float(times[-1]), float(places[-1])

    return leave


def solve(
    scene: Scene,
    t_end: float,
    wrong_domain: dict[int, int] | None = None,
    joined: bool = False,
    **options: Any,
) -> Run:
    """Integrate a scene with solve_ivp and terminal events, the way a careful user of scipy would."""
    q = problem(scene.parameters, Fraction(scene.t0))
    if wrong_domain:
        forces = {1: q.A1, 2: q.A2, 3: q.A3}
        A1, A2, A3 = (forces[wrong_domain.get(domain, domain)] for domain in forces)
        q = q._replace(A1=A1, A2=A2, A3=A3)
    t = float(scene.t0)
    x = float(scene.x0)
    v = float(scene.v0)
    run = Run(joined=joined)
    run.add([t], [x], [v])
    follow = with_solver(recording(run, options))["follow"]
    rows, count, outcome, _ = follow(
        q, None, 0.0, x, v, *start_mode(q, x, v), (OFF, OFF), t_end - t
    )
    if outcome:
        raise PeerError(f"solve_ivp gives up after {count} events")
    run.events = [
        (t + after, EVENT_KINDS[int(kind)]) for after, _, kind, _ in rows[:count].tolist()
    ]
    return run


def random_parameters(rng: np.random.Generator) -> Parameters:
    ranges: dict[str, tuple[float, float]] = {
        "m": (0.1, 2),
        "c": (0, 3),
        "k": (0.1, 8),
        "A0": (-10, 10),
        "B0": (0, 15),
        "Omega": (0.2, 5),
    }
    ranges |= {"v1": (-4, 1), "v2": (1.1, 6), "mu1": (0, 0.8), "mu2": (0, 0.8), "FN": (0, 20)}
    values = {name: round(rng.uniform(*span), 2) for name, span in ranges.items()}
    return Parameters(**values | {"c": values["c"] if rng.random() < 0.5 else 0})
