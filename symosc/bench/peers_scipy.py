"""Integrators called from Python: solve_ivp of scipy (RK45, DOP853, Radau, LSODA) and CVODE of
SUNDIALS (Adams, BDF).

Both look for a change of sign from one step to the next. So there are traps.

- Out and back within one step is not seen. On a belt x is linear, every error estimate is 0, and
  the step grows past the end of the stick. So the step is bounded. The turning points of the exit
  functions are recorded too, and where one has turned outside, the piece is integrated again up to
  there.
- A flight that starts on the belt starts at a zero of its own exit function. When it comes back
  within its first step, solve_ivp finds the start again: the same flight begins again and again. So
  flights start off the belt.
- LSODA's interpolant does not go through the start of a step, and brentq then finds no change of
  sign. The first steps of CVODE, of order 1, cross the belt after a near graze. So these start
  farther off, in proportion to rtol.
- Time itself: at t = 1e8 a step of 1e-9 is lost in rounding. So it is counted from the start of
  each piece.
- A CVODE object of scikit-sundae (1.2) can be used for one solution only. It goes on counting
  events over calls of `solve`, and after a terminal event the next call stops at any event. So each
  piece gets an object of its own (0.04 ms).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from symosc.base.aliases import Record
from symosc.bench import event_logic
from symosc.bench.event_logic import (
    ATOL,
    STEPS_PER_PERIOD,
    PeerError,
    Problem,
    force,
    margins,
    problem,
    runner,
    turn,
)
from symosc.bench.solvers import FoundEvent, Solver
from symosc.kernels.rebind import bind
from symosc.scenes import Scene

#: As `ONE_STEP_OFFSET`; and of multistep methods at least this part of rtol: they start with order
#: 1, so that the first steps away from the belt are wrong by as much as rtol allows, and closer to
#: it they are back at the start, for ever.
INTEGRATOR_OFFSET = 1e-14
MULTISTEP_OFFSET = 0.1
State = Sequence[float]
#: On which sides a mode can be left.
SIDES = {1: (1,), 2: (-1, 1), 3: (-1,), 4: (-1, 1), 5: (-1, 1)}
#: What ``integrate(q, mode, x, v, t_end)`` returns: side, t and x of the end, and turning points
#: (t, (x, v)) before it.
Left = tuple[int, float, float, Iterable[tuple[float, State]]]
Integrate = Callable[[Problem, int, float, float, float], Left]


def _functions(q: Problem, mode: int) -> tuple[Callable[..., Any], list[Callable[..., float]], Any]:
    """Return a mode's right-hand side, its event functions (a margin for each exit, and `turn`),
    and its Jacobian.
    """

    def rate(t: float, y: State) -> tuple[float, float]:
        return y[1], force(q, mode, t, y[0], y[1]) if mode < 4 else 0.0

    def margin_at(place: int, t: float, y: State) -> float:
        return margins(q, mode, t, y[0], y[1])[place]

    exits = [partial(margin_at, 0 if side < 0 else 1) for side in SIDES[mode]]
    jacobian = np.array([[0.0, 1.0], [-q.stiffness, -q.damping] if mode < 4 else [0.0, 0.0]])
    return rate, [*exits, lambda t, y: turn(q, mode, t, y[0], y[1])], jacobian


def integrate_by_scipy(
    options: Record, q: Problem, mode: int, x: float, v: float, t_end: float
) -> Left:
    """Follow a flight or stick with solve_ivp.

    Return side, t and x of its end, and the turning points before it.
    """
    rate, functions, jacobian = _functions(q, mode)
    events: list[Any] = [partial(function) for function in functions]
    for event in events:
        if event is events[-1]:
            event.direction = 0
            event.terminal = False
        else:
            event.direction = -1
            event.terminal = True
    if options["method"] in ("Radau", "LSODA"):
        options = options | {"jac": lambda t, y: jacobian}
    try:
        solution = solve_ivp(rate, (0.0, t_end), (x, v), events=events, **options)
    except ValueError as error:  # from brentq
        raise PeerError(f"solve_ivp: {error}") from None
    if not solution.success:
        raise PeerError(f"solve_ivp: {solution.message}")
    turns = list(zip(solution.t_events[-1], solution.y_events[-1], strict=True))
    for side, times, states in zip(SIDES[mode], solution.t_events, solution.y_events, strict=False):
        if len(times):
            return side, float(times[0]), float(states[0][0]), turns
    return 0, float(solution.t[-1]), float(solution.y[0, -1]), turns


def integrate_by_cvode(
    options: Record, q: Problem, mode: int, x: float, v: float, t_end: float
) -> Left:
    """Follow a flight or stick with CVODE.

    Return side, t and x of its end, and the turning points before it.
    """
    from sksundae.cvode import CVODE

    rate, functions, jacobian = _functions(q, mode)
    begin = (
        q.period
    )  # at t = 0 CVODE takes a root for two that differ by rounding only, and gives up

    def rhsfn(t: float, y: Any, out: Any) -> None:
        out[0], out[1] = rate(t - begin, y)

    def eventsfn(t: float, y: Any, out: Any) -> None:
        for i, function in enumerate(functions):
            out[i] = function(t - begin, y)

    def jacfn(t: float, y: Any, rate: Any, out: Any) -> None:
        out[:] = jacobian

    exits = len(functions) - 1
    eventsfn.terminal = [True] * exits + [False]  # type: ignore[attr-defined]
    eventsfn.direction = [-1] * exits + [0]  # type: ignore[attr-defined]
    solver = CVODE(rhsfn=rhsfn, eventsfn=eventsfn, jacfn=jacfn, num_events=exits + 1, **options)
    solution = solver.solve((begin, begin + t_end), (x, v))
    if not solution.success:
        raise PeerError(f"CVODE: {solution.message}")
    if solution.i_events is None:
        return 0, t_end, float(solution.y[-1][0]), ()
    events = zip(solution.i_events, solution.t_events, solution.y_events, strict=True)
    turns = [(t - begin, state) for which, t, state in events if which[-1]]
    for side, crossed in zip(SIDES[mode], solution.i_events[-1], strict=False):
        if crossed:
            return (
                side,
                float(solution.t_events[-1]) - begin,
                float(solution.y_events[-1][0]),
                turns,
            )
    return 0, t_end, float(solution.y[-1][0]), turns


def leave_by(integrate: Integrate) -> Callable[..., tuple[int, float, float]]:
    """Return the function `leave` for an integrator, which follows a flight or stick to its exit."""

    def leave(
        q: Problem, s: None, mode: int, t: float, x: float, v: float, t_end: float
    ) -> tuple[int, float, float]:
        side, end, x_end, turns = integrate(q, mode, x, v, t_end)
        for at, state in turns:
            if 0 < at < end and min(margins(q, mode, at, *state)) < 0:
                before = integrate(q, mode, x, v, float(at))
                if before[0]:
                    return before[:3]
        return side, end, x_end

    return leave


def prepare(method: str, scene: Scene, tolerance: float) -> Callable[[], Iterator[FoundEvent]]:
    """Return a function that follows a scene by the integrator `method` with this rtol, and returns
    its events.
    """
    longest = problem(scene.parameters).period / STEPS_PER_PERIOD
    options = {"method": method, "rtol": tolerance, "atol": ATOL * tolerance, "max_step": longest}
    leave = leave_by(
        partial(integrate_by_cvode if method in CVODE_METHODS else integrate_by_scipy, options)
    )
    if method in ("LSODA", *CVODE_METHODS):
        offset = MULTISTEP_OFFSET * tolerance
    else:
        offset = INTEGRATOR_OFFSET
    functions = bind((event_logic,), {"leave": leave})
    return runner(scene, functions, None, max(offset, INTEGRATOR_OFFSET))


TOLERANCES = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
SCIPY_METHODS = {
    "RK45": TOLERANCES,
    "DOP853": TOLERANCES,
    "Radau": (
        1e-3,
        1e-4,
        1e-5,
        1e-6,
        1e-7,
        1e-8,
    ),  # of order 5 and written in Python: 1e-12 takes 0.1 s per event
    "LSODA": TOLERANCES,
}
CVODE_METHODS = ("Adams", "BDF")
NOTE = (
    f"time counted from each flight and stick, {STEPS_PER_PERIOD} steps per period or more, "
    "turning points watched, "
    "flights start off the belt by"
)
FAR_OFF = f"Jacobian given, {NOTE} {MULTISTEP_OFFSET:g} rtol"
NOTES = {"Radau": f"Jacobian given, {NOTE} {INTEGRATOR_OFFSET:g}", "LSODA": FAR_OFF}

SOLVERS = (
    *(
        Solver(
            f"scipy {name}",
            partial(prepare, name),
            each,
            note=NOTES.get(name, f"{NOTE} {INTEGRATOR_OFFSET:g}"),
        )
        for name, each in SCIPY_METHODS.items()
    ),
    *(
        Solver(f"CVODE {name}", partial(prepare, name), TOLERANCES, "sksundae", note=FAR_OFF)
        for name in CVODE_METHODS
    ),
)
