"""Other ways to differentiate: right on a scene of the paper, each to the digits that it has."""

from __future__ import annotations

from dataclasses import replace

import pytest

from symosc import load_scene, sensitivities, simulate
from symosc.bench.gradients import heyoka_jacobian, run, solvers, table, through_events
from symosc.bench.solvers import FoundEvent, Solver
from symosc.reference.cases import reference_case
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


@pytest.mark.slow
@pytest.mark.parametrize("solver", solvers(), ids=lambda solver: solver.name)
def test_all_derivatives_of_a_motion_with_sticks(solver: Solver) -> None:
    if solver.missing:
        pytest.skip(solver.missing)
    scene = replace(load_scene("fig5"), t_end=5)
    exact, found = sensitivities(scene, NAMES), solver.prepare(scene, solver.tolerances[-1])()
    assert [event.kind for event in found] == [event.kind for event in exact.trajectory.events]
    for n, event in enumerate(found):
        for name, dt, dx in zip(NAMES, exact.dt[n], exact.dx[n], strict=True):
            for of, value in (("dt", dt), ("dx", dx)):
                assert event.changes[f"{of}_{name}"] == pytest.approx(
                    value, rel=ERRORS[solver.name], abs=ERRORS[solver.name]
                )


@pytest.mark.slow
def test_what_is_missing_is_said_and_the_rest_is_scored(monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(solvers()[-1], name="absent", needs="no_such_module", extra="gradients")
    ways = solvers()[-1], missing
    monkeypatch.setattr("symosc.bench.gradients.solvers", lambda: ways)
    result = run(chosen=[reference_case("paper-fig6")])
    assert result["skipped"] == {"absent": "no_such_module is not installed (extra `gradients`)"}
    (score,) = result["scores"]
    assert score.cases[0].derivatives == score.cases[0].known_derivatives == 72
    assert "| paper" in table(result["scores"])


@pytest.mark.slow
def test_a_flight_goes_on_behind_a_graze() -> None:
    """What is reported as a graze in the middle of a flight changes no derivative of later events."""
    pytest.importorskip("heyoka")
    scene = replace(load_scene("fig5"), t_end=5)
    motion, jacobian = simulate(scene), heyoka_jacobian(1e-16)
    events = [FoundEvent(event.t, event.x, event.kind, event.boundary) for event in motion.events]
    assert [event.kind for event in events[:3]] == ["stick", "slip", "stick"]
    middle = (events[1].t + events[2].t) / 2
    touched = [*events[:2], FoundEvent(middle, float(motion(middle)[0]), "graze", events[2].boundary), *events[2:]]
    plain, found = (list(through_events(scene, each, jacobian)) for each in (events, touched))
    assert found[:2] + found[3:] == plain
