"""Scenes that break ordinary solvers, each against the oracle at 50 digits."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath
import pytest
from agreement import BASE, CONTACTS, NEAR, assert_agrees, oracle_of, simulated
from oracle import flow_oracle, simulate_oracle
from samples import few

from symosc import Parameters, simulate

# changes to BASE; t0, x0, v0, t_end; how many events of which kind the oracle must show, so that a
# case stays hard
SCENES: dict[str, tuple[dict[str, Any], tuple[Any, Any, Any, Any], dict[str, int]]] = {
    "far from everything": ({}, (0, 0, 0, 30), {"cross": 20, "stick": 1}),
    "c^2 = 4km": ({"c": 2, "k": 1}, (0, 0, 0, 30), {"stick": 15, "slip": 15}),
    "c^2 = 4km (1 + 1e-8)^2": ({"c": "2.00000002", "k": 1}, (0, 0, 0, 30), {"stick": 15, "slip": 15}),
    "c^2 = 4km (1 - 1e-8)^2": ({"c": "1.99999998", "k": 1}, (0, 0, 0, 30), {"stick": 15, "slip": 15}),
    "c^2 = 4km in thirds": ({"m": "0.75", "c": "1.04", "k": "676/1875"}, (0, 0, 0, 30), {"stick": 10, "slip": 10}),
    "overdamped": ({"c": 7, "B0": 15}, (0, 0, 0, 30), {"cross": 10, "stick": 10, "slip": 10}),
    "undamped": ({"c": 0}, (0, 0, 0, 30), {"cross": 20, "stick": 1}),
    "undamped, slower than the drive": ({"c": 0, "k": "0.05"}, (0, 0, 0, 30), {"cross": 20}),
    "c = k = m = Omega = 1": ({"c": 1, "k": 1, "Omega": 1}, (0, 0, 0, 30), {"cross": 10}),
    "undamped resonance": ({"c": 0, "k": "1.69"}, (0, 0, 0, 30), {"cross": 20, "stick": 1}),
    "resonance, c = 1e-10": ({"c": "1e-10", "k": "1.69"}, (0, 0, 0, 30), {"cross": 20, "stick": 1}),
    "resonance but for 1e-10": ({"c": 0, "k": "1.6900000001"}, (0, 0, 0, 30), {"cross": 20, "stick": 1}),
    "k = 0": ({"k": 0}, (0, 0, 0, 30), {"cross": 15, "stick": 5, "slip": 5}),
    "k = 0, c = 1e-9": ({"k": 0, "c": "1e-9"}, (0, 0, 0, 30), {"cross": 15, "stick": 4, "slip": 4}),
    "k = c = 0": ({"k": 0, "c": 0}, (0, 0, 0, 30), {"cross": 15, "stick": 5, "slip": 5}),
    "m = 1e-6, underdamped": ({"m": "1e-6", "c": "1e-4", "k": 1, "Omega": 40}, (0, 0, 0, "0.2"), {"stick": 1}),
    "m = 1e-6, overdamped": ({"m": "1e-6", "Omega": 13}, (0, 0, 0, "0.6"), {"stick": 2, "slip": 2}),
    "Omega = 1e3": ({"Omega": 1000, "B0": 3000}, (0, 0, 0, "0.1"), {"cross": 50}),
    "Omega = 1e-3": ({"Omega": "1e-3"}, (0, 0, 0, 300), {"cross": 1, "stick": 1, "slip": 1}),
    "mu1 = 0": ({"mu1": 0}, (0, 0, 0, 30), {"cross": 20}),
    "mu2 = 0": ({"mu2": 0}, (0, 0, 0, 30), {"cross": 20}),
    "mu1 = mu2 = 0": ({"mu1": 0, "mu2": 0}, (0, 0, 0, 30), {"cross": 20}),
    "FN = 1e-9": ({"FN": "1e-9"}, (0, 0, 0, 30), {"cross": 20}),
    "belt 1 at rest": ({"v1": 0, "A0": 0}, (0, 0, 1, 30), {"cross": 20, "stick": 1}),
    "belt 2 at rest": ({"v2": 0, "A0": 0}, (0, 0, -1, 30), {"cross": 20, "stick": 1}),
    "B0 = 0": ({"B0": 0, "A0": 2, "c": "0.05", "FN": "0.5"}, (0, 5, 0, 60), {"cross": 15}),
    "B0 = 0, c = 0": ({"B0": 0, "A0": 2, "c": 0, "FN": "0.5"}, (0, 5, 0, 60), {"cross": 15}),
    "B0 = 0, stops on belt 1": ({"B0": 0, "v1": 0}, (0, 5, 1, 40), {"cross": 2, "stick": 1}),
    "B0 = 0, stops between belts": ({"B0": 0, "c": 2}, (0, 5, 1, 40), {"slip": 1}),
    "B0 < 0": ({"B0": -4}, (0, 0, 0, 30), {"cross": 20}),
}  # fmt: skip


@pytest.mark.full(9)
@pytest.mark.quick(4)
@pytest.mark.parametrize("name", few(SCENES, "m = 1e-6, overdamped"))
def test_hard_scenes(name: str) -> None:
    changes, start, least = SCENES[name]
    p = BASE.replace(**changes)
    run = oracle_of(p, start)
    for kind, count in least.items():
        assert sum(event.kind == kind for event in run.events) >= count, kind
    trajectory = simulated(p, start)
    assert_agrees(trajectory, run)
    end = trajectory(float(start[-1]))
    assert abs(end[0] - run.x) <= 1e-11 * max(1, abs(run.x))
    assert abs(end[1] - run.v) <= 1e-11 * max(1, abs(run.v))


@pytest.mark.parametrize("digits", [None, 20])
def test_a_near_miss_beside_which_the_gap_hardly_bends_is_decided(digits: int | None) -> None:
    """It is 1e-23 wide, at resonance but for 1e-8.

    To get away from there takes many short steps.
    """
    p = Parameters(
        m="87/500", c=0, k="1273766975798427/1250000000000000", A0=0, B0="-117/5", Omega="121/50",
        v1="-65000000000000/1169666644443", v2="58984664310958/1169666644443", mu1="377/1000", mu2=0, FN="401/500",
    )  # fmt: skip
    t0 = Fraction(73090726948507271742983, 4 * 10**22)
    x0 = Fraction(6371460601125475245182523, 10**24)
    v0 = Fraction(-5555501383552425478523611, 10**23)
    t_end = Fraction(51, 5)
    run = simulate_oracle(p, t0, x0, v0, t_end, 60)
    assert_agrees(simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end, digits=digits), run)


@pytest.mark.full(6)
@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_hard_scenes_with_digits(name: str) -> None:
    changes, (t0, x0, v0, t_end), _ = SCENES[name]
    p = BASE.replace(**changes)
    run = simulate_oracle(p, t0, x0, v0, t_end, 50, max_events=8)
    trajectory = simulate(
        p, t0=t0, x0=x0, v0=v0, t_end=t_end, digits=25, max_events=len(run.events) or None
    )
    assert_agrees(trajectory, run, 1e-24)


@pytest.mark.parametrize("t0", [10**8, -(10**8), "123456789.015625"])
def test_a_late_start_loses_nothing(t0: Any) -> None:
    """t itself is a double near 1e8, good to 1.5e-8; phases and positions keep 1e-12."""
    start = (t0, 0, 0, Fraction(t0) + 30)
    run = oracle_of(BASE, start)
    trajectory = simulated(BASE, start)
    assert len(run.events) >= 20
    assert [event[1:5] for event in run.events] == [
        (e.kind, e.boundary, e.source, e.target) for e in trajectory.events
    ]
    with mpmath.workdps(50):
        for event, expected in zip(trajectory.events, run.events, strict=True):
            assert abs(mpmath.mpf(event.t) - expected.t) <= 1.5e-8
            assert abs(mpmath.mpf(event.x) - expected.x) <= 1e-12 * max(1, abs(expected.x))
            turn = 2 * mpmath.pi
            error = (
                mpmath.mpf(event.theta) - expected.t * BASE.Omega.numerator / BASE.Omega.denominator
            ) % turn
            assert min(error, turn - error) <= 1e-11
            assert 0 <= event.theta < turn


# -- near-grazes: a peak of known height beside a belt -----------------------------------------------------------------


def start_before_a_peak(
    p: Parameters, mapping: str, height: Fraction, flight: Fraction
) -> tuple[Any, Any, Any]:
    """Return t0, x0, v0 from which v - v_lambda peaks `height` beyond the belt (short of it if negative) at t_m."""
    alpha, boundary, beyond, t_m = CONTACTS[mapping]
    with mpmath.workdps(90):
        v = p.belt(boundary) + beyond * height
        theta = (
            mpmath.mpf(Fraction(t_m).numerator)
            / Fraction(t_m).denominator
            * p.Omega.numerator
            / p.Omega.denominator
        )
        cosine = Fraction(mpmath.nstr(mpmath.cos(theta), 80))
        x = (p.A(alpha) + p.B0 * cosine - p.c * v) / p.k  # the acceleration vanishes there
    t0 = Fraction(t_m) - flight
    x0, v0, _ = flow_oracle(p, alpha, t_m, x, v, -flight, 80)
    with mpmath.workdps(80):
        return t0, mpmath.nstr(x0, 60), mpmath.nstr(v0, 60)


@pytest.mark.full(10)
@pytest.mark.slow
@pytest.mark.parametrize("exponent", [3, 5, 7, 9, 11, 13])
@pytest.mark.parametrize("beyond", [True, False], ids=["beyond", "short"])
@pytest.mark.parametrize("mapping", CONTACTS)
def test_a_peak_beside_a_belt(mapping: str, beyond: bool, exponent: int) -> None:
    alpha, boundary, _, t_m = CONTACTS[mapping]
    height = Fraction(1 if beyond else -1, 10**exponent)
    t0, x0, v0 = start_before_a_peak(NEAR, mapping, height, Fraction(1, 2))
    start = (t0, x0, v0, Fraction(t_m) + Fraction(1, 4))
    run = oracle_of(NEAR, start)
    # at most 3e-2 before the peak of 1e-3, in proportion to the root of the height
    near = [
        event
        for event in run.events
        if abs(event.t - float(Fraction(t_m))) < 3 * 10 ** (-exponent / 2)
    ]
    if beyond:
        assert [(event.kind, event.boundary) for event in near] == [
            ("stick", boundary),
            ("slip", boundary),
        ]
        assert near[1].target == f"Omega{alpha}"
    assert len(run.events) == len(near) == (2 if beyond else 0)
    assert_agrees(simulated(NEAR, start), run)


# -- flights and sticks of 1e-7 ----------------------------------------------------------------------------------------


def position_with_force(p: Parameters, alpha: int, boundary: int, t0: str, force: Fraction) -> str:
    """Return the position on the belt where F^(alpha) is `force`, as a decimal of 60 digits."""
    with mpmath.workdps(80):
        theta = mpmath.mpf(t0) * p.Omega.numerator / p.Omega.denominator
        cosine = Fraction(mpmath.nstr(mpmath.cos(theta), 70))
        x = (p.A(alpha) + p.B0 * cosine - p.c * p.belt(boundary) - p.m * force) / p.k
        return mpmath.nstr(mpmath.mpf(x.numerator) / x.denominator, 60)


@pytest.mark.parametrize("scale", ["1e-3", "1e-7", "1e-9"])
@pytest.mark.parametrize(
    ("mapping", "t0"), [("P2", "4.1"), ("P3", "0.9"), ("P5", "4.6"), ("P6", "1.2")]
)
def test_flights_of_a_tenth_of_a_microsecond(mapping: str, t0: str, scale: str) -> None:
    """A mass that leaves its belt with a tiny acceleration against G^(1) is back at once."""
    alpha, boundary, beyond, _ = CONTACTS[mapping]
    x0 = position_with_force(NEAR, alpha, boundary, t0, -beyond * Fraction(scale))
    start = (t0, x0, NEAR.belt(boundary), Fraction(t0) + Fraction(1, 2))
    run = oracle_of(NEAR, start)
    assert (run.events[0].kind, run.events[0].source) == ("stick", f"Omega{alpha}")
    assert run.events[0].t - float(t0) < 10 * float(scale)
    trajectory = simulated(NEAR, start)
    assert_agrees(trajectory, run)
    with mpmath.workdps(50):
        flight = mpmath.mpf(trajectory.events[0].t) - mpmath.mpf(t0)
        assert abs(flight - (run.events[0].t - mpmath.mpf(t0))) <= 1e-15 * mpmath.mpf(t0)


@pytest.mark.parametrize("scale", ["1e-3", "1e-7", "1e-9"])
@pytest.mark.parametrize("mapping", CONTACTS)
def test_sticks_of_a_tenth_of_a_microsecond(mapping: str, scale: str) -> None:
    """A mass that starts on its belt with a tiny F towards it, and falling, slips at once."""
    alpha, boundary, beyond, t0 = CONTACTS[mapping]
    x0 = position_with_force(NEAR, alpha, boundary, t0, beyond * Fraction(scale))
    start = (t0, x0, NEAR.belt(boundary), Fraction(t0) + Fraction(1, 2))
    run = oracle_of(NEAR, start)
    first = run.events[0]
    assert (first.kind, first.source, first.target) == ("slip", f"belt{boundary}", f"Omega{alpha}")
    assert first.t - float(t0) < 10 * float(scale)
    trajectory = simulated(NEAR, start)
    assert trajectory.mode(float(t0)) == f"belt{boundary}"
    assert_agrees(trajectory, run)


# -- a force that dips through zero on a belt, or just not ------------------------------------------------------------


@pytest.mark.quick(20)
@pytest.mark.parametrize("exponent", [3, 6, 9, 11, 13])
@pytest.mark.parametrize("slips", [True, False], ids=["slips", "holds"])
@pytest.mark.parametrize(("boundary", "side"), [(1, "low"), (1, "high"), (2, "low"), (2, "high")])
def test_an_extreme_force_on_a_belt(boundary: int, side: str, slips: bool, exponent: int) -> None:
    """The force on a belt has an extremum where sin(theta) = -k v_lambda/(B0 Omega).

    It goes that far beyond 0.
    """
    p = NEAR
    speed = NEAR.belt(boundary)
    if side == "low":
        outward = -1
    else:
        outward = 1
    height = Fraction(outward if slips else -outward, 10**exponent)
    alpha = boundary + (side == "high")
    with mpmath.workdps(90):
        ratio = -p.k * speed / (p.B0 * p.Omega)
        angle = mpmath.asin(mpmath.mpf(ratio.numerator) / ratio.denominator)
        # lowest where cos < 0, highest where cos > 0
        if side == "low":
            theta = mpmath.pi - angle
        else:
            theta = angle
        t_m, cosine = (Fraction(mpmath.nstr(value, 80)) for value in (theta, mpmath.cos(theta)))
        x_m = (p.A(alpha) + p.B0 * cosine - p.c * speed - p.m * height) / p.k
        t0 = Fraction(int(10 * t_m) - 5, 10)
        x0 = x_m - speed * (t_m - t0)
        start = (
            t0,
            mpmath.nstr(mpmath.mpf(x0.numerator) / x0.denominator, 60),
            speed,
            t_m + Fraction(1, 2),
        )
    run = oracle_of(p, start)
    early = [event for event in run.events if event.t < float(t_m) + 10 * 10 ** (-exponent / 2)]
    expected = [
        ("slip", f"belt{boundary}", f"Omega{alpha}"),
        ("stick", f"Omega{alpha}", f"belt{boundary}"),
    ]
    assert [(event.kind, event.source, event.target) for event in early] == (
        expected if slips else []
    )
    trajectory = simulated(p, start)
    assert trajectory.mode(float(t0)) == f"belt{boundary}"
    assert_agrees(trajectory, run)


# Sticks whose exit lies in the monotone piece after a phase Theta_cr, where the force has slope 0:
# found by 20,000 random sticks, of which these fooled a root search that began there.
AFTER_A_TURN = [
    "1.82 0.72 3.82 -2.07 1.05 1.47 0.35 1.96 0.81 0.98 6.81  1.37 0.35",
    "1 0.1 2.92 -2.63 -0.69 0.93 -0.58 0.11 0.6 0.94 6.3  -2.8 0.11",
    "1.82 0.72 3.82 2.07 -1.05 1.47 -1.96 -0.35 0.98 0.81 6.81  -1.37 -0.35",
]


@pytest.mark.parametrize("numbers", AFTER_A_TURN)
def test_sticks_that_outlast_a_turning_phase(numbers: str) -> None:
    *values, x0, v0 = numbers.split()
    names = ("m", "c", "k", "A0", "B0", "Omega", "v1", "v2", "mu1", "mu2", "FN")
    p = Parameters(**dict(zip(names, values, strict=True)))
    start = (0, x0, v0, 25)
    run = oracle_of(p, start)
    assert run.events[0].kind == "slip"
    assert_agrees(simulated(p, start), run)
