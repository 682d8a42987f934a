"""Other ways to differentiate: right on a scene of the paper, each to the digits that it has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from symosc import Scene, load_scene, sensitivities, simulate
from symosc.bench.gradients import heyoka_jacobian, solvers, tangent_steps, through_events
from symosc.bench.solvers import FoundEvent, Solver
from symosc.simulation.tangents import NAMES

#: The error that each may have; what compiles for a minute is slow.
ERRORS = {
    "symosc": 1e-12,
    "heyoka, variational": 1e-12,
    "numba DOP853, tangents": 1e-11,
    "casadi, CVODES": 1e-6,
    "diffrax, jacfwd": 1e-6,
    "scipy DOP853, differences": 1e-5,
}


def without_compiling(scene: Scene, tolerance: float) -> Callable[[], list[FoundEvent]]:
    """Prepare the tangents of DOP853 as they are compiled, but interpreted."""

    def jacobian(*values: float) -> tuple[np.ndarray, np.ndarray]:
        found = tangent_steps(*map(float, values), tolerance)
        return found[2::2], found[3::2]

    events = [
        FoundEvent(float(e.t), float(e.x), e.kind, e.boundary) for e in simulate(scene).events
    ]
    return lambda: list(through_events(scene, events, jacobian))


WAYS = [
    replace(s, prepare=without_compiling, needs="") if s.name.startswith("numba") else s
    for s in solvers()
]


@pytest.mark.slow
@pytest.mark.parametrize("solver", WAYS, ids=lambda solver: solver.name)
def test_all_derivatives_of_a_motion_with_sticks(solver: Solver) -> None:
    if solver.missing:
        pytest.skip(solver.missing)
    scene = replace(load_scene("fig5"), t_end=5)
    exact = sensitivities(scene, NAMES)
    found = solver.prepare(scene, solver.tolerances[-1])()
    assert [event.kind for event in found] == [event.kind for event in exact.trajectory.events]
    for n, event in enumerate(found):
        for name, dt, dx in zip(NAMES, exact.dt[n], exact.dx[n], strict=True):
            for of, value in (("dt", dt), ("dx", dx)):
                assert event.changes[f"{of}_{name}"] == pytest.approx(
                    value, rel=ERRORS[solver.name], abs=ERRORS[solver.name]
                )


@pytest.mark.slow
def test_a_flight_goes_on_behind_a_graze() -> None:
    """What is reported as a graze in the middle of a flight changes no derivative of later events."""
    pytest.importorskip("heyoka")
    scene = replace(load_scene("fig5"), t_end=5)
    motion = simulate(scene)
    jacobian = heyoka_jacobian(1e-16)
    events = [FoundEvent(event.t, event.x, event.kind, event.boundary) for event in motion.events]
    assert [event.kind for event in events[:3]] == ["stick", "slip", "stick"]
    middle = (events[1].t + events[2].t) / 2
    touched = [
        *events[:2],
        FoundEvent(middle, float(motion(middle)[0]), "graze", events[2].boundary),
        *events[2:],
    ]
    plain, found = (list(through_events(scene, each, jacobian)) for each in (events, touched))
    assert found[:2] + found[3:] == plain
