"""SUNDIALS CVODE with root finding, through scikit-sundae: at its best (Adams and BDF) and as it comes.

CVODE knows that a root function may be 0 at the start: it looks a little ahead and waits until the function has left 0.
Flights may start on the belt. But after a near graze the first steps, of order 1, cross the belt at coarse tolerances.
So the best version starts a little off. CVODE does not see a function that changes its sign twice within one step. On a
belt every error estimate is 0, so that the step grows past the end of the stick. The best version bounds the step, and
adds the turning points of the exit functions as roots, to go back when one has turned outside.

A CVODE object of scikit-sundae (1.2) can be used for one solution only. It goes on counting events over calls of
`solve`, and after a terminal event in one call the next call stops at any event. So each phase gets an object of its
own, which takes 0.04 ms.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from symosc.aliases import Record
from symosc.bench.event_logic import (
    ATOL,
    MULTISTEP_OFFSET,
    STEPS_PER_PERIOD,
    Exit,
    Leave,
    Motion,
    PeerError,
    Phase,
    follow,
    watching,
)
from symosc.bench.solvers import Solver
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene


def _arguments(phase: Phase, careful: bool) -> Record:
    """Return what CVODE is constructed with for a phase: its functions write into the arrays that they are given."""
    functions = [function for _, function in phase.exits] + [phase.turn] * careful

    def rate(t: float, y: Any, out: Any) -> None:
        out[0], out[1] = phase.rate(t, y)

    def events(t: float, y: Any, out: Any) -> None:
        for i, function in enumerate(functions):
            out[i] = function(t, y)

    def jacobian(t: float, y: Any, rate: Any, out: Any) -> None:
        out[:] = phase.jacobian

    events.terminal = [True] * len(phase.exits) + [False] * careful  # type: ignore[attr-defined]
    events.direction = [-1] * len(phase.exits) + [0] * careful  # type: ignore[attr-defined]
    arguments = {"rhsfn": rate, "eventsfn": events, "num_events": len(functions)}
    return arguments | ({"jacfn": jacobian} if careful else {})


def _leave(motion: Motion, options: Record, careful: bool) -> Leave:
    from sksundae.cvode import CVODE

    arguments = {mode: _arguments(phase, careful) | options for mode, phase in motion.phases.items()}

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Any:
        solution = CVODE(**arguments[phase.mode]).solve((t, t_end), (x, v))
        if not solution.success:
            raise PeerError(f"CVODE, after t = {solution.t[-1]:.6g}: {solution.message}")
        return _exit(phase, solution), _turns(solution)

    return watching(leave) if careful else lambda *start: leave(*start)[0]


def _turns(solution: Any) -> Any:
    if solution.i_events is None:
        return
    for which, t, state in zip(solution.i_events, solution.t_events, solution.y_events, strict=True):
        if which[-1]:
            yield t, state


def _exit(phase: Phase, solution: Any) -> Exit:
    if solution.i_events is not None:
        for (side, _), crossed in zip(phase.exits, solution.i_events[-1], strict=False):
            if crossed:
                return Exit(side, float(solution.t_events[-1]), float(solution.y_events[-1][0]))
    return Exit(0, float(solution.t[-1]), float(solution.y[-1][0]))


def prepare(method: str, raw: bool, scene: Scene, tolerance: float) -> Callable[[], list[FoundEvents]]:
    """Prepare CVODE with `method` ("Adams" or "BDF") and ``rtol = tolerance``."""
    options = {"method": method, "rtol": tolerance, "atol": ATOL * tolerance}
    if raw:
        motion = Motion(scene.parameters)
        return partial(follow, scene, motion, _leave(motion, options, False))
    motion = Motion(scene.parameters, scene.t0)
    options["max_step"] = motion.period / STEPS_PER_PERIOD
    return partial(follow, scene, motion, _leave(motion, options, True), MULTISTEP_OFFSET * tolerance)


CVODE_TOLERANCES = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
CVODE_NOTE = (
    f"Jacobian given, time counted from t0, {STEPS_PER_PERIOD} steps per period or more, turning points are roots too, "
    f"flights start off the belt by {MULTISTEP_OFFSET:g} rtol"
)
RAW_CVODE = "a stick's step grows past both its exits, and a short flight or stick passes within a step"

SOLVERS = (
    Solver("CVODE Adams", partial(prepare, "Adams", False), CVODE_TOLERANCES, "sksundae", note=CVODE_NOTE),
    Solver("CVODE BDF", partial(prepare, "BDF", False), CVODE_TOLERANCES, "sksundae", note=CVODE_NOTE),
    Solver("CVODE BDF, raw", partial(prepare, "BDF", True), CVODE_TOLERANCES, "sksundae", raw=True, note=RAW_CVODE),
)
