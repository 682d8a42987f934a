"""Follow the reference cases with heyoka.

Taylor series of high order, whose roots are found with care.

python with_heyoka.py cases/cases.csv mine.csv && symosc score cases mine.csv

The drive is two more variables: it keeps the steps of a stick short. A flight starts a few units of
rounding off its belt: in a step that begins exactly on it heyoka does not see the next root.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import heyoka as hy
from belts import End, Problem, constant, main

OFF_THE_BELT = 4e-16
MOST_STEPS = 10**6
DOWN = hy.event_direction.negative


@cache
def integrator(flies: bool) -> Any:
    """Return the integrator of all flights, or of all sticks.

    The parameters are those of the problem.

    They are k/m, c/m and Omega; then of a flight its A/m and the speeds of both belts, of a stick
    A/m below and above.
    """
    x, v, C, S = hy.make_vars("x", "v", "C", "S")
    p = hy.par
    a = C - p[0] * x - p[1] * v
    if flies:
        ends = [v - p[4], v - p[5]]
    else:
        ends = [a + p[3], -a - p[4]]
    rates = [(x, v), (v, a + p[3] if flies else 0.0 * v), (C, -p[2] * S), (S, p[2] * C)]
    events = [
        hy.t_event(each, direction=hy.event_direction.any if flies else DOWN) for each in ends
    ]
    return hy.taylor_adaptive(rates, [0.0] * 4, pars=[0.0] * (6 if flies else 5), t_events=events)


def fly(p: Problem, domain: int, t: float, x: float, v: float) -> End:
    """Integrate in a domain up to a belt."""
    if v == p["v1"]:
        belt = 1
    elif v == p["v2"]:
        belt = 2
    else:
        belt = 0
    if belt:
        off = OFF_THE_BELT * max(abs(v), 1.0)
    else:
        off = 0.0
    if domain == belt:
        v = v - off
    else:
        v = v + off
    end = advance(p, integrator(True), t, x, v, [constant(p, domain) / p["m"], p["v1"], p["v2"]])
    return end and (*end[:2], 1 + end[2])


def ride(p: Problem, belt: int, t: float, x: float) -> End:
    """Stay on a belt until a force lets go."""
    forces = [constant(p, belt + i) / p["m"] for i in (0, 1)]
    end = advance(p, integrator(False), t, x, p[f"v{belt}"], forces)
    return end and (*end[:2], belt + end[2])


def advance(p: Problem, motion: Any, t: float, x: float, v: float, more: list[float]) -> End:
    """Return time and position at the first event, and its number; None at the end."""
    swing = p["B0"] / p["m"]
    angle = p["Omega"] * t
    motion.reset_cooldowns()
    motion.time, motion.state[:] = 0.0, (x, v, swing * math.cos(angle), swing * math.sin(angle))
    motion.pars[:] = (p["k"] / p["m"], p["c"] / p["m"], p["Omega"], *more)
    outcome = motion.propagate_until(p["t_end"] - t, max_steps=MOST_STEPS)[0]
    if outcome == hy.taylor_outcome.time_limit:
        return None
    if int(outcome) >= 0 or int(outcome) < -2:
        raise ArithmeticError(str(outcome))
    return t + motion.time, float(motion.state[0]), -int(outcome) - 1


if __name__ == "__main__":
    main(fly, ride)
