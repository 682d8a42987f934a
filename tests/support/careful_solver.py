"""A careful user of scipy, and random parameters: solutions from outside for cross-checks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from symosc import Parameters, Scene
from symosc.friction import NEIGHBOURS

TIGHT = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
# After a stick or a crossing the solver starts this far off the belt, or it would meet the belt at
# once.
OFF = 1e-12


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


def solve(
    scene: Scene,
    t_end: float,
    wrong_domain: dict[int, int] | None = None,
    joined: bool = False,
    **options: Any,
) -> Run:
    """Integrate a scene with solve_ivp and terminal events, the way a careful user of scipy would."""
    p = scene.parameters
    m, c, k, B0, Om = (float(value) for value in (p.m, p.c, p.k, p.B0, p.Omega))
    A = {alpha: float(p.A((wrong_domain or {}).get(alpha, alpha))) for alpha in (1, 2, 3)}
    speeds = {boundary: float(p.belt(boundary)) for boundary in (1, 2)}

    def force(alpha: int, t: float, x: float, v: float) -> float:
        return (A[alpha] + B0 * np.cos(Om * t) - k * x - c * v) / m

    def wall(boundary: int, direction: int) -> Any:
        def event(t: float, y: Any) -> float:
            return y[1] - speeds[boundary]

        event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
        return event

    def exit_into(alpha: int, direction: int, speed: float) -> Any:
        def event(t: float, y: Any) -> float:
            return force(alpha, t, y[0], speed)

        event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
        return event

    run = Run(joined=joined)
    t = float(scene.t0)
    x = float(scene.x0)
    v = float(scene.v0)
    at = next((boundary for boundary in (1, 2) if v == speeds[boundary]), 0)
    domain = 1 + (v > speeds[1]) + (v > speeds[2])
    source = 0  # the domain from which a belt was met; 0 at the start
    while t < t_end:
        if at:
            below, above = NEIGHBOURS[at]
            v = speeds[at]
            run.add([t], [x], [v])
            if force(below, t, x, v) > 0 > force(above, t, x, v):
                if source:
                    run.events.append((t, "stick"))
                exits = [exit_into(below, -1, v), exit_into(above, 1, v)]
                # Along a stick any step is accurate: without a limit it would grow past the end of
                # the stick.
                stick = solve_ivp(
                    lambda t, y, v=v: [v],
                    (t, t_end),
                    [x],
                    events=exits,
                    **{"max_step": 0.02, **options},
                )
                run.add(stick.t, stick.y[0], np.full(len(stick.t), v))
                t = float(stick.t[-1])
                x = float(stick.y[0, -1])
                if stick.status == 0:
                    break
                if len(stick.t_events[1]):
                    domain = above
                else:
                    domain = below
                run.events.append((t, "slip"))
            else:
                if force(above, t, x, v) > 0:
                    domain = above
                else:
                    domain = below
                if source:
                    run.events.append((t, "cross"))
            if domain == above:
                v += OFF
            else:
                v += -OFF
        if domain > 1:
            walls = [wall(domain - 1, -1)]
        else:
            walls = []
        if domain < 3:
            walls += [wall(domain, 1)]
        else:
            walls += []
        flight = solve_ivp(
            lambda t, y, domain=domain: [y[1], force(domain, t, *y)],
            (t, t_end),
            [x, v],
            events=walls,
            **options,
        )
        run.add(flight.t, *flight.y)
        t, x, v = float(flight.t[-1]), *(float(value) for value in flight.y[:, -1])
        if flight.status == 1:
            at = min((1, 2), key=lambda boundary, v=v: abs(v - speeds[boundary]))
        else:
            at = 0
        source = domain
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
