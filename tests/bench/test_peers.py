"""The event logic that other people's integrators share, and the adapters of scipy and CVODE."""

from __future__ import annotations

import pickle
import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import cos, pi, sin
from typing import Any

import mpmath
import pytest
from scipy.optimize import brentq

from symosc import Parameters, simulate
from symosc.bench import peers_cvode, peers_scipy
from symosc.bench.event_logic import CHATTER, INTEGRATOR_OFFSET, Exit, Motion, PeerError, Phase, follow, watching
from symosc.bench.solvers import FoundEvents, Solver
from symosc.engine.flow import constants, state_at
from symosc.engine.state import Launch
from symosc.scenes import Scene, load_scene

SOLVERS = (*peers_scipy.SOLVERS, *peers_cvode.SOLVERS)
CAREFUL = [solver for solver in SOLVERS if not solver.raw]
RAW = [solver for solver in SOLVERS if solver.raw]
SCAN = 200  # steps per period of the exact integrator


def scene_of(p: Parameters, t0: Any, x0: Any, v0: Any, t_end: Any) -> Scene:
    return Scene("test", p, Fraction(t0), Fraction(x0), Fraction(v0), Fraction(t_end))


# A flight of 2.5 ms, 3.4e-6 below belt 1, seen from 2 s before: it is shorter than the first step of most integrators.
DIP = scene_of(
    Parameters(
        m="1.966", c="1.541", k="4.409", A0="3.603", B0="4.25", Omega="2.25", v1="-0.987", v2="4.752", mu1="0.462",
        mu2="0.367", FN="2.693",
    ),
    "2.491758084473163", "0.162784459", "-0.987", 6,
)  # fmt: skip


def exact_leave(parameters: Parameters) -> Any:
    """Return an integrator that knows the exact flow: it brackets every exit by a fine scan and the turning points."""
    K, motion = constants(parameters), Motion(parameters)

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Exit:
        a = phase.rate(t, (x, v))[1]
        s, c = sin(motion.Omega * t), cos(motion.Omega * t)

        def state(tau: float) -> tuple[float, float]:
            if phase.mode > 3:
                return x + v * tau, v
            now = state_at(tau, Launch(v, a, s, c), K)
            return x + now.dx, v + now.dv

        def turn(tau: float) -> float:
            return phase.turn(t + tau, state(tau))

        step, low = motion.period / SCAN, 0.0
        while low < t_end - t:
            high = min(low + step, t_end - t)
            places = [low, high]
            if turn(low) * turn(high) < 0:
                places.insert(1, brentq(turn, low, high, xtol=1e-15, rtol=1e-14))
            for start, end in pairwise(places):
                for side, function in phase.exits:

                    def value(tau: float, function: Any = function) -> float:
                        return function(t + tau, state(tau))

                    if value(end) < -1e-13 and value(start) > 0:
                        tau = brentq(value, start, end, xtol=1e-15, rtol=1e-14)
                        return Exit(side, t + tau, state(tau)[0])
            low = high
        return Exit(0, t_end, state(t_end - t)[0])

    return leave


def assert_same_events(found: list[FoundEvents], events: Any, tolerance: float) -> float:
    """Kinds and boundaries are equal; return the largest error of t and x, which is within `tolerance`."""
    assert [(event.kind, event.boundary) for event in found] == [(event.kind, event.boundary) for event in events]
    errors = [abs(float(b.t - a.t)) for a, b in zip(found, events, strict=True)]
    errors += [abs(float(b.x - a.x)) for a, b in zip(found, events, strict=True)]
    assert max(errors, default=0.0) <= tolerance
    return max(errors, default=0.0)


def scene(name: str, **changes: Any) -> Scene:
    return replace(load_scene(name), **changes)


def with_parameters(name: str, **changes: Any) -> Scene:
    shipped = load_scene(name)
    return replace(shipped, parameters=shipped.parameters.replace(**changes))


LOGIC = {
    "both exits of a stick": (scene("fig5"), 1e-11),
    "start on belt 2": (scene("fig6"), 1e-11),
    "no event": (scene("fig7"), 0.0),
    "a stick of 1 ms": (scene("fig7-corrected"), 1e-11),
    "sticks that shrink": (scene("fig8", t_end=13), 1e-8),
    "start on belt 1, passing": (scene("fig9"), 1e-11),
    "stick and slip on belt 2": (scene("fig10", t_end=13), 1e-11),
    "belt 1 transparent": (with_parameters("fig5", mu1=0), 1e-10),
    "belt 2 transparent": (with_parameters("fig10", mu2=0), 1e-10),
    "no friction": (with_parameters("fig9", FN=0), 1e-10),
    "start on belt 1 inside a stick": (scene("fig5", v0=1), 1e-11),
}


@pytest.mark.parametrize("case", LOGIC)
def test_event_logic_on_the_exact_flow_gives_the_events_of_simulate(case: str) -> None:
    start, tolerance = LOGIC[case]
    found = follow(start, Motion(start.parameters), exact_leave(start.parameters), INTEGRATOR_OFFSET)
    assert_same_events(found, simulate(start).events, tolerance)


@pytest.mark.parametrize("seed", range(12))
def test_event_logic_on_random_parameters(seed: int) -> None:
    rng = random.Random(seed)

    def number(low: float, high: float) -> str:
        return str(round(rng.uniform(low, high), 3))

    v1 = rng.uniform(-4, 2)
    parameters = Parameters(
        m=number(0.1, 2), c=number(0, 2), k=number(0.2, 8), A0=number(-5, 5), B0=number(1, 15), Omega=number(0.4, 4),
        v1=str(round(v1, 3)), v2=str(round(v1 + rng.uniform(0.5, 6), 3)), mu1=number(0, 0.8), mu2=number(0, 0.8),
        FN=number(0, 10),
    )  # fmt: skip
    start = scene_of(parameters, 0, number(-3, 3), number(-5, 6), 8)
    found = follow(start, Motion(parameters), exact_leave(parameters), INTEGRATOR_OFFSET)
    assert found
    assert_same_events(found, simulate(start).events, 1e-9)


@pytest.mark.parametrize("mode", range(1, 6))
def test_phases_are_consistent(mode: int) -> None:
    """The turning points are those of the exit functions along the motion, and the Jacobian is that of the rate."""
    motion = Motion(load_scene("fig8").parameters, Fraction("2.5"))
    phase, t, step = motion.phases[mode], 0.7, 1e-4
    v = motion.belts[mode - 3] if mode > 3 else 1.5

    def along(tau: float) -> tuple[float, float]:
        dx, dv = phase.rate(t, (0.3, v))
        # the next order of x and v: v' and v'' = -(k v + c v' + B0 Omega sin)/m
        bend = -(motion.k * v + motion.c * dv + motion.B0 * motion.Omega * sin(motion.Omega * (t + 2.5))) / motion.m
        return 0.3 + dx * tau + dv * tau**2 / 2, v + (dv * tau + bend * tau**2 / 2) * (mode < 4)

    for side, function in phase.exits:
        slope = (function(t + step, along(step)) - function(t - step, along(-step))) / (2 * step)
        assert slope == pytest.approx(-side * phase.turn(t, (0.3, v)), abs=1e-6)
    for column, moved in enumerate([(1.3, v), (0.3, v + 1)]):
        change = [b - a for a, b in zip(phase.rate(t, (0.3, v)), phase.rate(t, moved), strict=True)]
        assert change == pytest.approx([row[column] for row in phase.jacobian])


def test_the_phase_at_a_late_origin_has_all_digits() -> None:
    origin = Fraction(10**12) + Fraction("0.1324")
    motion = Motion(load_scene("fig9").parameters, origin)
    with mpmath.workdps(50):
        assert abs(mpmath.sin(4 * (10**12 + mpmath.mpf("0.1324"))) - sin(motion.theta)) < 1e-15


def test_what_follows_at_a_boundary() -> None:
    p = load_scene("fig8").parameters
    motion = Motion(p)
    assert motion.resolve(1, 0.0, -100.0) == 2  # both forces upward
    assert motion.resolve(1, 0.0, 100.0) == 1
    assert motion.resolve(2, 0.0, -100.0) == 3
    assert motion.resolve(2, 0.0, 100.0) == 2
    x = float((p.A(1) + p.A(2)) / 2 + p.B0 - p.c * p.v1) / float(p.k)  # half way between the two forces
    assert motion.resolve(1, 0.0, x) == 4


def test_a_vanishing_force_is_decided_by_the_derivatives() -> None:
    grazing = Motion(load_scene("fig8").parameters)  # F^(2) = 0 < G^(1) where it grazes belt 1 from above
    assert grazing.sign_of_force(2, pi, 4.51425, -4.0) == 1
    assert grazing.resolve(1, pi, 4.51425) == 2
    quartic = Motion(load_scene("fig7-corrected").parameters)  # F^(1) = G^(1) = G^(2) = 0 > G^(3)
    assert quartic.sign_of_force(1, 1.5 * pi, 4.4145, 5.0) == -1
    assert quartic.resolve(1, 1.5 * pi, 4.4145) == 1


@pytest.mark.parametrize("seed", range(20))
def test_a_force_that_vanishes_up_to_rounding(seed: int) -> None:
    """On the set where F^(2) = 0 on belt 1 the motion leaves upward if F^(2) grows, else the belt takes it."""
    rng = random.Random(seed)
    p = load_scene("fig8").parameters.replace(v1="-3.7")
    motion, t = Motion(p), rng.uniform(0, 20)
    v = motion.belts[1]
    x = (motion.A[2] + motion.B0 * cos(motion.Omega * t) - motion.c * v) / motion.k
    growing = -motion.k * v - motion.B0 * motion.Omega * sin(motion.Omega * t) > 0
    assert motion.resolve(1, t, x) == (2 if growing else 4)


@pytest.mark.parametrize(("v1", "follows"), [(2, 1), (-2, 4)])
def test_start_on_a_belt_with_a_force_that_is_zero(v1: int, follows: int) -> None:
    p = Parameters(m=1, c=1, k=1, A0=3, B0=0, Omega=1, v1=v1, v2=5, mu1=0.5, mu2=0.25, FN=4)
    start = scene_of(p, 0, p.A(1) - v1, v1, 20)
    motion = Motion(p)
    assert motion.resolve(1, 0.0, float(start.x0)) == follows  # dF/dt = -v1: it falls away from the belt, or stays
    assert_same_events(follow(start, motion, exact_leave(p), INTEGRATOR_OFFSET), simulate(start).events, 1e-11)


def test_turning_points_find_what_comes_back_within_a_step() -> None:
    """x^2 - 1/4 on [-1, 1] as seen by an integrator that compares the ends of the step only."""
    asked = []

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Any:
        asked.append(t_end)
        crossed = (t * t - 0.25) * (t_end * t_end - 0.25) < 0
        return Exit(-1, -0.5, x) if crossed else Exit(0, t_end, x), [(0.0, (x, -0.25))]

    phase = Phase(2, lambda t, y: (0.0, 0.0), ((-1, lambda t, y: y[1]),), lambda t, y: t, ((0.0, 0.0), (0.0, 0.0)))
    assert leave(phase, -1.0, 0.0, 0.75, 1.0)[0].side == 0
    assert watching(leave)(phase, -1.0, 0.0, 0.75, 1.0) == Exit(-1, -0.5, 0.0)
    assert asked[-1] == 0.0


def test_chatter_is_bounded_and_the_error_carries_the_events() -> None:
    start = load_scene("fig9")

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Exit:
        return Exit(phase.exits[0][0], t, x)

    with pytest.raises(PeerError, match=r"chatters between Omega1 and Omega. near t = 0\.1324") as caught:
        follow(start, Motion(start.parameters), leave)
    assert len(caught.value.found) == CHATTER + 1
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.reason, again.found) == (caught.value.reason, caught.value.found)


def test_an_integrator_that_gives_up_keeps_the_events_before() -> None:
    start = load_scene("fig9")
    exact = exact_leave(start.parameters)

    def leave(phase: Phase, t: float, x: float, v: float, t_end: float) -> Exit:
        if t > 1:
            raise PeerError("step too small")
        return exact(phase, t, x, v, t_end)

    with pytest.raises(PeerError, match="step too small") as caught:
        follow(start, Motion(start.parameters), leave, INTEGRATOR_OFFSET)
    assert_same_events(caught.value.found, simulate(start).events[:2], 1e-11)


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
