"""scipy.integrate.solve_ivp with terminal events: RK45, DOP853, Radau and LSODA, at their best and as they come.

solve_ivp looks for a change of sign from one step to the next, and brentq then finds a root of the interpolant. So
there are traps.

- Out and back within one step is not seen. On a belt x is linear, every error estimate is 0, and the step grows tenfold
  each time until it is past the end of the stick. The best version bounds the step. It also records where the exit
  functions turn, and goes back when one has turned outside.
- A flight that starts on the belt starts at a zero of its own exit function. When it comes back within its first step,
  brentq returns the start: the same flight begins again and again. The best version starts off the belt.
- The interpolant of LSODA does not go through the start of a step, and brentq then finds no change of sign ("f(a) and
  f(b) must have different signs"). The best version starts farther off, in proportion to rtol.

Time itself is one more: at t = 1e8 a step of 1e-9 is lost in rounding. The best version counts it from the start.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from symosc.aliases import Record
from symosc.bench.event_logic import (
    ATOL,
    INTEGRATOR_OFFSET,
    MULTISTEP_OFFSET,
    STEPS_PER_PERIOD,
    Exit,
    Leave,
    Motion,
    PeerError,
    Phase,
    State,
    follow,
    watching,
)
from symosc.bench.solvers import Solver
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene


def _event(function: Callable[..., float], direction: float, terminal: bool) -> Callable[..., float]:
    """Return `function` as an event of solve_ivp, which reads its attributes."""

    def event(t: float, y: State) -> float:
        return function(t, y)

    event.direction, event.terminal = direction, terminal  # type: ignore[attr-defined]
    return event


def _solve(phase: Phase, t: float, x: float, v: float, t_end: float, events: Sequence[Any], options: Any) -> Any:
    try:
        solution = solve_ivp(phase.rate, (t, t_end), (x, v), events=events, **options)
    except ValueError as error:  # from brentq
        raise PeerError(f"solve_ivp, after t = {t:.6g}: {error}") from None
    if not solution.success:
        raise PeerError(f"solve_ivp, after t = {solution.t[-1]:.6g}: {solution.message}")
    return solution


def _exit(phase: Phase, solution: Any) -> Exit:
    for (side, _), times, states in zip(phase.exits, solution.t_events, solution.y_events, strict=False):
        if len(times):
            return Exit(side, float(times[0]), float(states[0][0]))
    return Exit(0, float(solution.t[-1]), float(solution.y[0, -1]))


def _raw(motion: Motion, options: Record) -> Leave:
    """Return solve_ivp as its documentation shows it: terminal events with a direction, and the tolerances."""
    events = {mode: [_event(f, -1, True) for _, f in phase.exits] for mode, phase in motion.phases.items()}

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Exit:
        return _exit(phase, _solve(phase, t, x, v, t_end, events[phase.mode], options))

    return leave


def _careful(motion: Motion, options: Record) -> Leave:
    """Return solve_ivp with bounded steps, the Jacobian, and an eye on the turning points of the exit functions."""
    events, own_options = {}, {}
    for mode, phase in motion.phases.items():
        events[mode] = [*(_event(f, -1, True) for _, f in phase.exits), _event(phase.turn, 0, False)]
        own_options[mode] = (
            options | {"max_step": motion.period / STEPS_PER_PERIOD} | _jacobian(options["method"], phase)
        )

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Any:
        solution = _solve(phase, t, x, v, t_end, events[phase.mode], own_options[phase.mode])
        return _exit(phase, solution), zip(solution.t_events[-1], solution.y_events[-1], strict=True)

    return watching(leave)


def _jacobian(method: str, phase: Phase) -> Record:
    if method == "Radau":
        return {"jac": phase.jacobian}
    if method == "LSODA":
        matrix = np.array(phase.jacobian)  # before SciPy 1.17 it takes no nested tuples, and in no version a constant
        return {"jac": lambda t, y: matrix}
    return {}


def prepare(method: str, raw: bool, scene: Scene, tolerance: float) -> Callable[[], list[FoundEvents]]:
    """Prepare solve_ivp with `method` and ``rtol = tolerance``."""
    options = {"method": method, "rtol": tolerance, "atol": ATOL * tolerance}
    if raw:
        motion = Motion(scene.parameters)
        return partial(follow, scene, motion, _raw(motion, options))
    motion = Motion(scene.parameters, scene.t0)
    offset = max(INTEGRATOR_OFFSET, MULTISTEP_OFFSET * tolerance) if method == "LSODA" else INTEGRATOR_OFFSET
    return partial(follow, scene, motion, _careful(motion, options), offset)


METHODS = {
    "RK45": (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12),
    "DOP853": (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12),
    "Radau": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),  # of order 5 and written in Python: 1e-12 takes 0.1 s per event
    "LSODA": (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12),
}
SCIPY_NOTE = (
    f"time counted from t0, {STEPS_PER_PERIOD} steps per period or more, turning points watched, "
    "flights start off the belt by"
)
NOTES = {
    "RK45": f"{SCIPY_NOTE} {INTEGRATOR_OFFSET:g}",
    "DOP853": f"{SCIPY_NOTE} {INTEGRATOR_OFFSET:g}",
    "Radau": f"Jacobian given, {SCIPY_NOTE} {INTEGRATOR_OFFSET:g}",
    "LSODA": f"Jacobian given, {SCIPY_NOTE} {MULTISTEP_OFFSET:g} rtol",
}
RAW_SCIPY = (
    "a stick's step grows past both its exits; a flight that is back within its first step begins again for ever"
)

SOLVERS = (
    *(
        Solver(f"scipy {method}", partial(prepare, method, False), tolerances, note=NOTES[method])
        for method, tolerances in METHODS.items()
    ),
    *(
        Solver(f"scipy {method}, raw", partial(prepare, method, True), tolerances, raw=True, note=RAW_SCIPY)
        for method, tolerances in METHODS.items()
    ),
)
