"""The adapters of scipy and CVODE: right where they can be, and each known trap where it is."""

from __future__ import annotations

import pickle
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from bench_work import assert_same_events, scene_of

from symosc import Parameters, simulate
from symosc.bench import peers_cvode, peers_scipy
from symosc.bench.event_logic import CHATTER, PeerError
from symosc.bench.solvers import Solver
from symosc.scenes import Scene, load_scene

SOLVERS = (*peers_scipy.SOLVERS, *peers_cvode.SOLVERS)
CAREFUL = [solver for solver in SOLVERS if not solver.raw]
RAW = [solver for solver in SOLVERS if solver.raw]


# A flight of 2.5 ms, 3.4e-6 below belt 1, seen from 2 s before: it is shorter than the first step of most integrators.
DIP = scene_of(
    Parameters(
        m="1.966", c="1.541", k="4.409", A0="3.603", B0="4.25", Omega="2.25", v1="-0.987", v2="4.752", mu1="0.462",
        mu2="0.367", FN="2.693",
    ),
    "2.491758084473163", "0.162784459", "-0.987", 6,
)  # fmt: skip


def scene(name: str, **changes: Any) -> Scene:
    return replace(load_scene(name), **changes)


def skip_if_missing(solver: Solver) -> None:
    if solver.missing:
        pytest.skip(solver.missing)


EASY = {"fig5": 13, "fig9": 4, "fig10": 8}


@pytest.mark.slow
@pytest.mark.parametrize("name", EASY)
@pytest.mark.parametrize("solver", CAREFUL, ids=lambda solver: solver.name)
def test_careful_solvers_on_easy_scenes(solver: Solver, name: str) -> None:
    skip_if_missing(solver)
    start = scene(name, t_end=EASY[name])
    exact = simulate(start, digits=30).events
    coarse = assert_same_events(solver.prepare(start, 1e-5)(), exact, 3e-4)
    fine = assert_same_events(solver.prepare(start, 1e-8)(), exact, 1e-6)
    assert fine < coarse / 5 or fine < 1e-9
    finest = assert_same_events(solver.prepare(start, solver.tolerances[-1])(), exact, 2e-8)
    assert finest <= fine


@pytest.mark.parametrize("solver", RAW, ids=lambda solver: solver.name)
def test_raw_solvers_on_an_easy_scene(solver: Solver) -> None:
    skip_if_missing(solver)
    start = scene("fig9", t_end=4)
    assert_same_events(solver.prepare(start, 1e-6)(), simulate(start).events, 1e-3)


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda solver: solver.name)
def test_solvers_say_what_they_are(solver: Solver) -> None:
    assert solver.note
    assert solver.raw == solver.name.endswith(", raw")
    assert list(solver.tolerances) == sorted(solver.tolerances, reverse=True)
    assert pickle.loads(pickle.dumps(solver)).name == solver.name  # runs in another process


def named(name: str) -> Solver:
    return next(solver for solver in SOLVERS if solver.name == name)


@pytest.mark.parametrize("solver", CAREFUL, ids=lambda solver: solver.name)
def test_careful_solvers_find_the_micro_stick_of_fig8(solver: Solver) -> None:
    skip_if_missing(solver)
    start = scene("fig8", t_end=5)
    exact = simulate(start, digits=30).events
    assert [event.kind for event in exact] == ["stick", "slip"]
    assert exact[1].t - exact[0].t < 0.003
    assert_same_events(solver.prepare(start, 1e-8)(), exact, 1e-4)


@pytest.mark.parametrize("method", ["RK45", "DOP853", "LSODA"])
def test_raw_solvers_miss_the_micro_stick_of_fig8(method: str) -> None:
    assert named(f"scipy {method}, raw").prepare(scene("fig8", t_end=5), 1e-8)() == []


@pytest.mark.parametrize("solver", RAW, ids=lambda solver: solver.name)
def test_raw_solvers_step_past_the_end_of_a_stick(solver: Solver) -> None:
    skip_if_missing(solver)
    start = load_scene("fig5")
    found, exact = solver.prepare(start, 1e-6)(), simulate(start).events
    assert len(found) < len(exact)
    wrong, right = next(pair for pair in zip(found, exact, strict=False) if abs(pair[0].t - pair[1].t) > 0.1)
    assert wrong.kind == right.kind == "slip"
    assert wrong.t > right.t + 1  # both exits of the stick were passed


@pytest.mark.parametrize("method", ["RK45", "DOP853", "Radau"])
def test_raw_flights_that_are_back_within_a_step_begin_again_for_ever(method: str) -> None:
    exact = simulate(DIP).events
    assert exact[1].t - exact[0].t < 0.003
    with pytest.raises(PeerError, match=r"chatters between Omega1 and Omega1 near t = 4\.47") as caught:
        named(f"scipy {method}, raw").prepare(DIP, 1e-6)()
    kinds = [event.kind for event in caught.value.found]
    assert kinds == ["cross"] + ["graze"] * CHATTER  # the forces send it back, it has never been gone


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
@pytest.mark.parametrize("solver", CAREFUL, ids=lambda solver: solver.name)
def test_careful_flights_that_are_back_within_a_step(solver: Solver, tolerance: float) -> None:
    skip_if_missing(solver)
    assert_same_events(solver.prepare(DIP, tolerance)(), simulate(DIP).events, 500 * tolerance)


@pytest.mark.parametrize("solver", CAREFUL, ids=lambda solver: solver.name)
def test_careful_solvers_find_a_peak_just_beyond_a_belt(solver: Solver) -> None:
    """v rises 4e-6 over belt 1 in fig7-corrected: the mass sticks for 0.9 ms."""
    skip_if_missing(solver)
    start = load_scene("fig7-corrected")
    assert_same_events(solver.prepare(start, 1e-7)(), simulate(start).events, 1e-3)


@pytest.mark.parametrize("solver", CAREFUL, ids=lambda solver: solver.name)
def test_careful_solvers_count_time_from_a_late_start(solver: Solver) -> None:
    skip_if_missing(solver)
    start = scene("fig9", t0=10**10 + Fraction("0.1324"), t_end=10**10 + 4)
    events = simulate(start).events
    assert len(events) > 3
    assert_same_events(solver.prepare(start, 1e-8)(), events, 1e-5)  # the last bit of 1e10 is 2e-6
