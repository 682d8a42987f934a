"""The event logic that other people's integrators share."""

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
from bench_work import assert_same_events, scene_of
from scipy.optimize import brentq

from symosc import Parameters, simulate
from symosc.bench.event_logic import CHATTER, INTEGRATOR_OFFSET, Exit, Motion, PeerError, Phase, follow, watching
from symosc.engine.flow import constants, state_at
from symosc.engine.state import Launch
from symosc.scenes import Scene, load_scene

SCAN = 200  # steps per period of the exact integrator


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


@pytest.mark.quick(5)
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
