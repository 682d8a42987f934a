"""Follow the reference cases with scipy's solve_ivp (DOP853).

python with_scipy.py cases/cases.csv mine.csv && symosc score cases mine.csv

Steps are at most a twentieth of a forcing period. Two roots inside one step are not seen.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

from belts import End, Problem, force, main
from scipy.integrate import solve_ivp

TOLERANCE = 1e-13
LARGEST_STEP = 0.05


def fly(p: Problem, domain: int, t: float, x: float, v: float) -> End:
    """Integrate in a domain up to a belt."""

    def rates(t: float, y: Any) -> list[float]:
        if time.process_time() > p["stop at"]:
            raise TimeoutError
        return [y[1], force(p, domain, t, y[0], y[1])]

    walls = {1: (1,), 2: (1, 2), 3: (2,)}[domain]
    gaps = [
        end_of(lambda t, y, speed=p[f"v{i}"]: y[1] - speed, 1 if i == domain else -1) for i in walls
    ]
    end = advance(p, rates, t, [x, v], gaps)
    return end and (*end[:2], walls[end[2]])


def ride(p: Problem, belt: int, t: float, x: float) -> End:
    """Stay on a belt until a force lets go.

    The one below falls to 0, or the one above rises to 0.
    """
    v = p[f"v{belt}"]
    forces = [end_of(lambda t, y, i=i: force(p, belt + i, t, y[0], v), 2 * i - 1) for i in (0, 1)]
    end = advance(p, lambda t, y: [v], t, [x], forces)
    return end and (*end[:2], belt + end[2])


def end_of(function: Callable[[float, Any], float], direction: int) -> Any:
    """Return an event that ends the integration, where a function changes its sign in a direction."""
    function.terminal, function.direction = True, direction  # type: ignore[attr-defined]
    return function


def advance(p: Problem, rates: Any, t: float, state: list[float], events: list[Any]) -> End:
    """Return time and position at the first event, and its number; None at the end."""
    settings = {
        "rtol": TOLERANCE,
        "atol": TOLERANCE,
        "max_step": LARGEST_STEP * 2 * math.pi / p["Omega"],
    }
    found = solve_ivp(rates, (t, p["t_end"]), state, method="DOP853", events=events, **settings)
    if not found.success:
        raise ArithmeticError(found.message)
    hits = [
        (float(found.t_events[i][0]), float(found.y_events[i][0][0]), i)
        for i in (0, 1)
        if i < len(events) and len(found.t_events[i])
    ]
    return min(hits, default=None)


if __name__ == "__main__":
    main(fly, ride)
