"""Integrators called from Python: solve_ivp of scipy (RK45, DOP853, Radau, LSODA).

It looks for a change of sign from one step to the next. So there are traps.

- Out and back within one step is not seen. On a belt x is linear, every error estimate is 0, and
  the step grows past the end of the stick. So the step is bounded. The turning points of the exit
  functions are recorded too, and where one has turned outside, the piece is integrated again up to
  there.
- A flight that starts on the belt starts at a zero of its own exit function. When it comes back
  within its first step, solve_ivp finds the start again: the same flight begins again and again. So
  flights start off the belt.
- LSODA's interpolant does not go through the start of a step, and brentq then finds no change of
  sign. So its flights start farther off, in proportion to rtol.
- Time itself: at t = 1e8 a step of 1e-9 is lost in rounding. So it is counted from the start of
  each piece.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from symosc.base.aliases import Record
from symosc.bench.event_logic import (
    ATOL,
    LASTS,
    ON_BELT,
    STEPS_PER_PERIOD,
    PeerError,
    PeerProblem,
    force,
    margins,
    problem,
    runner,
    turn,
    with_solver,
)
from symosc.bench.solvers import Solver, SolverEvent
from symosc.scenes import Scene

#: As `ONE_STEP_OFFSET`, for methods of one step.
INTEGRATOR_OFFSET = 1e-14
#: The offset of LSODA as a part of rtol. A multistep method starts with order 1, so its first steps
#: away from the belt are wrong by as much as rtol allows; closer to the belt they are back at the
#: start, for ever. With a tenth of it LSODA invents events in
#: `tests/bench/test_peers.py::test_integrators_in_their_traps`.
MULTISTEP_OFFSET = 0.1
State = Sequence[float]
#: On which sides a mode can be left.
SIDES = {1: (1,), 2: (-1, 1), 3: (-1,), 4: (-1, 1), 5: (-1, 1)}


class Left(NamedTuple):
    """How a flight or stick ended: side (0: it lasts until t_end), t and x there, and the turning
    points (t, (x, v)) of its margins before.
    """

    side: int
    t: float
    x: float
    turns: Iterable[tuple[float, State]]


def _functions(
    q: PeerProblem, mode: int
) -> tuple[Callable[..., Any], list[Callable[..., float]], Any]:
    """Return a mode's right-hand side, its event functions (a margin for each exit, and `turn`),
    and its Jacobian.
    """
    flies = mode <= ON_BELT

    def rate(t: float, y: State) -> tuple[float, float]:
        x, v = y
        if flies:
            return v, force(q, mode, t, x, v)
        return v, 0.0

    def margin_at(side: int, t: float, y: State) -> float:
        below, above = margins(q, mode, t, *y)
        if side > 0:
            return above
        return below

    def turning(t: float, y: State) -> float:
        return turn(q, mode, t, *y)

    exits = [partial(margin_at, side) for side in SIDES[mode]]
    jacobian = np.array([[0.0, 1.0], [0.0, 0.0]])
    if flies:
        jacobian[1] = -q.stiffness, -q.damping
    return rate, [*exits, turning], jacobian


def integrate(options: Record, q: PeerProblem, mode: int, x: float, v: float, t_end: float) -> Left:
    """Follow a flight or stick with solve_ivp.

    Return side, t and x of its end, and the turning points before it.
    """
    rate, functions, jacobian = _functions(q, mode)
    # Partials, because solve_ivp reads attributes of its event functions. The last one, of turning
    # points, ends nothing.
    events: list[Any] = [partial(function) for function in functions]
    for event in events[:-1]:
        event.direction = -1
        event.terminal = True
    if options["method"] in IMPLICIT_METHODS:
        options = options | {"jac": lambda t, y: jacobian}
    try:
        solution = solve_ivp(rate, (0.0, t_end), (x, v), events=events, **options)
    except ValueError as error:  # from brentq
        raise PeerError(f"solve_ivp: {error}") from None
    if not solution.success:
        raise PeerError(f"solve_ivp: {solution.message}")
    turns = list(zip(solution.t_events[-1], solution.y_events[-1], strict=True))
    # Exits come first among the functions, in the order of SIDES; they are terminal, so that at most
    # one has a time.
    for side, times, states in zip(SIDES[mode], solution.t_events, solution.y_events, strict=False):
        if len(times):
            x_exit, _ = states[0]
            return Left(side, float(times[0]), float(x_exit), turns)
    positions, _ = solution.y
    return Left(LASTS, float(solution.t[-1]), float(positions[-1]), turns)


def leave_by(options: Record) -> Callable[..., tuple[int, float, float]]:
    """Return the function `leave` of `event_logic` for solve_ivp with some options."""

    def leave(
        q: PeerProblem, s: None, mode: int, t: float, x: float, v: float, t_end: float
    ) -> tuple[int, float, float]:
        left = integrate(options, q, mode, x, v, t_end)
        for at, state in left.turns:
            # Outside at a turning point: an exit before it was missed, which a shorter integration
            # finds.
            if 0 < at < left.t and min(margins(q, mode, at, *state)) < 0:
                missed = integrate(options, q, mode, x, v, float(at))
                if missed.side != LASTS:
                    return missed.side, missed.t, missed.x
        return left.side, left.t, left.x

    return leave


def prepare(method: str, scene: Scene, tolerance: float) -> Callable[[], Iterator[SolverEvent]]:
    """Return a function that follows a scene by the integrator `method` with this rtol, and returns
    its events.
    """
    longest = problem(scene.parameters).period / STEPS_PER_PERIOD
    options = {"method": method, "rtol": tolerance, "atol": ATOL * tolerance, "max_step": longest}
    offset = INTEGRATOR_OFFSET
    if method == "LSODA":
        offset = max(offset, MULTISTEP_OFFSET * tolerance)
    return runner(scene, with_solver(leave_by(options)), None, offset)


TOLERANCES = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
#: Radau is of order 5 and written in Python: 1e-12 takes 0.1 s per event.
RADAU_TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
METHODS = {
    "RK45": TOLERANCES,
    "DOP853": TOLERANCES,
    "Radau": RADAU_TOLERANCES,
    "LSODA": TOLERANCES,
}
IMPLICIT_METHODS = ("Radau", "LSODA")
NOTE = (
    f"time counted from each flight and stick, {STEPS_PER_PERIOD} steps per period or more, "
    "turning points watched, flights start off the belt by"
)
NOTES = {
    "RK45": f"{NOTE} {INTEGRATOR_OFFSET:g}",
    "DOP853": f"{NOTE} {INTEGRATOR_OFFSET:g}",
    "Radau": f"Jacobian given, {NOTE} {INTEGRATOR_OFFSET:g}",
    "LSODA": f"Jacobian given, {NOTE} {MULTISTEP_OFFSET:g} rtol",
}

SOLVERS = tuple(
    Solver(f"scipy {method}", partial(prepare, method), tolerances, note=NOTES[method])
    for method, tolerances in METHODS.items()
)
