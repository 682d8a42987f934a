"""Solvers and calls that go wrong, in a module that a worker process imports fast."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from typing import Any

from effort import PATIENCE

from symosc.bench.solvers import HANG, OURS, Outcome, Solver, SolverEvent, Worker
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate


def loop_for_ever() -> None:
    while True:
        pass


def fail() -> None:
    raise ValueError("no\nreason")


def talk() -> int:
    os.write(1, b"noise on stdout")
    os.write(2, b"noise on stderr")
    warnings.warn("careful", UserWarning, stacklevel=1)
    warnings.warn("careful", UserWarning, stacklevel=1)
    return os.getpid()


class PatientWorker(Worker):
    """Gives every call all the time that it needs, but none at all to those that would hang."""

    def call(self, limit: float, function: Callable[..., Any], *arguments: object) -> Outcome:
        """Return what became of a call."""
        names = {getattr(each, "name", "") for each in arguments}
        if function.__name__ in ("measure", "found_by") and names & {"hanging", "sleeps"}:
            return Outcome(failure=HANG)
        return super().call(PATIENCE, function, *arguments)


def careless(scene: Scene, tolerance: float) -> Callable[[], list[SolverEvent]]:
    """Prepare a solver that does not see the second event, and reports all others late."""
    events = simulate(scene).events
    found = [
        SolverEvent(event.t + tolerance, event.x, event.kind, event.boundary) for event in events
    ]
    return lambda: found[:1] + found[2:]


def hanging(scene: Scene, tolerance: float) -> Callable[[], None]:
    return loop_for_ever


def failing_later(scene: Scene, tolerance: float) -> Callable[[], list[SolverEvent]]:
    if scene.t_end > 20:
        raise ArithmeticError("too far")
    return list


FAKES = (
    OURS[0],
    Solver("careless", careless, (1e-3, 1e-6), note="looks away"),
    Solver("hanging", hanging, (1e-3,)),  # type: ignore[arg-type]
    Solver("failing later", failing_later, (1e-3,)),
    Solver("absent", careless, (1e-3,), needs="no_such_module"),
)
