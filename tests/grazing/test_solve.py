"""`grazing_start` and `solve_grazing` over all damping regimes.

Every point against the flow by matrix exponential.
"""

from __future__ import annotations

import random
from fractions import Fraction
from math import pi, sin
from typing import Any

import mpmath
import pytest
import sympy
from effort import at_most
from oracle import flow_oracle
from parameter_sets import FREE, OVER

from symosc import Parameters, grazing_start, grazing_window, load_scene, solve_grazing
from symosc.grazing.start import GrazingStart

DOMAIN = {"P2": 1, "P3": 2, "P5": 2, "P6": 3}
BELT = {"P2": 1, "P3": 1, "P5": 2, "P6": 2}
REGIMES = ["undamped", "under", "critical", "near", "over", "very over"]
SLOW = Parameters(
    m="1.091", c="4.039", k="3.604", A0="0.976", B0="6.729", Omega="2.852", v1="-2.259", v2="0.224", mu1="0.602",
    mu2="0.71", FN="1.89",
)  # fmt: skip


def parameters(rng: random.Random, regime: str) -> Parameters:
    """Return random parameters with the damping of a regime; B0 of both signs or 0."""
    m = Fraction(rng.randint(50, 5000), 1000)
    w = Fraction(rng.randint(10, 300), 100)
    critical = 2 * m * w
    c = {
        "undamped": Fraction(0),
        "under": critical * Fraction(rng.randint(1, 900), 1000),
        "critical": critical,
        "near": critical * (1 + Fraction(rng.choice([-1, 1]), 10 ** rng.randint(2, 9))),
        "over": critical * Fraction(rng.randint(1100, 3000), 1000),
        "very over": critical * rng.randint(4, 40),
    }[regime]
    v1 = Fraction(rng.randint(-3000, 3000), 1000)
    B0 = rng.choice([1, 1, -1, 0]) * Fraction(rng.randint(100, 10000), 1000)
    return Parameters(
        m=m, c=c, k=m * w * w, A0=Fraction(rng.randint(-50, 50), 10), B0=B0, Omega=Fraction(rng.randint(10, 400), 100),
        v1=v1, v2=v1 + Fraction(rng.randint(50, 4000), 1000), mu1=Fraction(rng.randint(0, 10), 10),
        mu2=Fraction(rng.randint(0, 10), 10), FN=rng.randint(0, 10),
    )  # fmt: skip


def assert_grazes(p: Parameters, start: GrazingStart) -> None:
    """Forward from the start as printed the flow is on the belt with acceleration 0 at t_m, and inside before."""
    t0, x0, v0 = (Fraction(start.start[name]) for name in ("t0", "x0", "v0"))
    belt = p.belt(BELT[start.mapping])
    domain = DOMAIN[start.mapping]
    assert v0 == belt
    tau = Fraction(str(start.t_m)) - t0
    wave = mpmath.mpf(float(p.B0 * p.Omega / p.m))
    for _ in range(3):  # t_m is a double: to the instant of acceleration 0
        _, v, a = flow_oracle(p, domain, t0, x0, v0, tau, dps=40)
        slope = -(
            float(p.c / p.m) * a
            + float(p.k / p.m) * v
            + wave * mpmath.sin(float(p.Omega * (t0 + tau)))
        )
        if abs(slope) > 1e-9 and abs(a / slope) < 1e-5:
            tau -= Fraction(str(a / slope)).limit_denominator(10**45)
    _, v, a = flow_oracle(p, domain, t0, x0, v0, tau, dps=40)
    assert abs(float(v - mpmath.mpf(belt.numerator) / belt.denominator)) < 1e-11 * max(
        1.0, abs(float(belt))
    )
    assert abs(float(a)) < 1e-9 * max(1.0, float(abs(p.B0) / p.m))
    walls = [
        (float(p.belt(b)), 1 if b == domain - 1 else -1)
        for b in (1, 2)
        if b in (domain - 1, domain)
    ]
    for j in range(1, 6):
        v = float(flow_oracle(p, domain, t0, x0, v0, tau * j / 6, dps=20)[1])
        assert all(inward * (v - wall) > -1e-9 for wall, inward in walls), (start, j)


def assert_value(p: Parameters, start: GrazingStart, name: str, value: Fraction) -> None:
    if name == "x_i":
        assert abs(Fraction(start.start["x0"]) - value) < Fraction(1, 10**36) * max(1, abs(value))
        return
    with mpmath.workdps(60):
        angle = p.Omega * Fraction(start.start["t0"]) - value
        turns = mpmath.mpf(angle.numerator) / angle.denominator / (2 * mpmath.pi)
        assert abs(turns - mpmath.nint(turns)) < mpmath.mpf(10) ** -36


@pytest.mark.full(4)
@pytest.mark.slow
@pytest.mark.parametrize("regime", REGIMES)
def test_every_point_grazes_and_has_the_value(regime: str) -> None:
    check_random_queries(random.Random(regime), regime, 1)


@pytest.mark.campaign
@pytest.mark.parametrize("regime", REGIMES)
def test_every_point_of_many_grazes_and_has_the_value(regime: str) -> None:
    check_random_queries(random.Random(regime + "many"), regime, 40)


def check_random_queries(rng: random.Random, regime: str, times: int) -> None:
    """Start from a random phase, and find that tangency again from the value of its start."""
    solved = 0
    while solved < times:
        p = parameters(rng, regime)
        theta = rng.uniform(0, 6.28)
        mapping = rng.choice(list(DOMAIN))
        if not grazing_window(p, mapping).contains(theta):
            continue
        known = grazing_start(p, mapping, theta)
        assert known.found or known.reason
        if not known.found or abs(known.x) > 1e9:
            continue
        assert_grazes(p, known)
        if p.B0 and rng.random() < 0.5:
            name = "x_i"
        else:
            name = "theta_i"
        value = Fraction(str(known.x if name == "x_i" else known.theta))
        solutions = solve_grazing(p, mapping, n=40, **{name: value})
        for start in solutions:
            assert_value(p, start, name, value)
        again = [start for start in solutions if abs(sin((start.theta_m - theta) / 2)) < 1e-6]
        assert again or not solutions.complete, (p, theta, name, solutions.message)
        for start in again[:1]:
            assert_grazes(p, start)
            solved += 1


@pytest.mark.slow
def test_solutions_that_gather_at_the_end_of_a_curve() -> None:
    """The curve runs to minus infinity: theta_i repeats for ever, and what is left out is said."""
    value = Fraction("5.974415351155259")
    solutions = solve_grazing(OVER, "P2", theta_i=str(value))
    assert len(solutions) >= 3
    for start in solutions:
        assert_value(OVER, start, "theta_i", value)
        assert_grazes(OVER, start)
    assert not solutions.complete
    assert "goes on for ever" in solutions.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "mapping", "given", "least"),
    [
        (SLOW, "P6", {"theta_i": "2.2058944139607997", "n": 100}, 5),
        (load_scene("fig8").parameters, "P3", {"theta_i": "1"}, 1),
        (load_scene("fig8").parameters, "P3", {"x_i": "0.5"}, 2),
        (load_scene("fig8").parameters, "P5", {"x_i": "0.5"}, 2),
    ],
)
def test_hard_queries_are_answered_soon(
    p: Parameters, mapping: str, given: dict[str, Any], least: int
) -> None:
    with at_most(3_000_000):
        solutions = solve_grazing(p, mapping, **given)
    assert len(solutions) >= least
    name, value = next((name, Fraction(value)) for name, value in given.items() if name != "n")
    for start in solutions:
        assert_value(p, start, name, value)


@pytest.mark.parametrize("c", ["0", "2.828", "2.8284", "2.83"])
@pytest.mark.parametrize("mapping", ["P2", "P6"])
def test_free_flights_near_critical_damping(c: str, mapping: str) -> None:
    """Without excitation the start is one turn of the free oscillation back, which critical damping makes long."""
    if mapping == "P2":
        p = FREE.replace(c=c)
    else:
        p = FREE.replace(c=c, v1=-2, v2="-0.5")
    with at_most(500_000):
        start = grazing_start(p, mapping, 1)
    square = float(p.k / p.m - (p.c / (2 * p.m)) ** 2)
    if square > 0:
        turn = 2 * pi / square**0.5
    else:
        turn = float("inf")
    # the flight is as long as the turn (undamped), and never shorter than half of it
    assert start.found == (turn / 2 < 100 * 2 * pi / 1.3)
    if start.found:
        assert turn / 2 < float(start.t_m) - float(start.t) <= turn + 1e-9
        assert start.touch == (c == "0")
    else:
        assert start.reason


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [70, 90, 200])
def test_a_crossing_is_told_from_a_touch(digits: int) -> None:
    """With c = 0 the flow comes back in a touch.

    The least damping makes it a crossing sqrt(2 pi c) before.
    """
    p = FREE.replace(k=1, Omega=1)
    touch = grazing_start(p, "P2", 1, digits=digits)
    assert (touch.found, touch.touch) == (True, True)
    turn = Fraction(str(sympy.N(2 * sympy.pi, digits + 5)))
    assert abs(Fraction(touch.start["t0"]) - 1 + turn) < Fraction(1, 10 ** (digits - 2))
    for exponent in (20, 40, 70):
        start = grazing_start(p.replace(c=Fraction(1, 10**exponent)), "P2", 1, digits=digits)
        assert (start.found, start.touch) == (True, False)
        apart = float(Fraction(start.start["t0"]) - Fraction(touch.start["t0"]))
        assert apart == pytest.approx((2 * pi * 10.0**-exponent) ** 0.5, rel=1e-6)


def test_long_flights_keep_all_digits() -> None:
    """A backward flight that has grown to 1e27 needs more digits than were asked for.

    They are added.
    """
    p = Parameters(
        m="3.701", c="7.17276006", k="3.4822709", A0="-4.647", B0="5.21", Omega="3.275", v1="-0.962", v2="0.257",
        mu1="0.799", mu2="0.037", FN="9.893",
    )  # fmt: skip
    start, finer = (
        grazing_start(p, "P6", "4.7086158295626905", digits=digits) for digits in (None, 120)
    )
    assert abs(start.x) > 1e27
    for name in ("t0", "x0"):
        assert abs(Fraction(start.start[name]) - Fraction(finer.start[name])) <= Fraction(1, 10**40)


@pytest.mark.slow
def test_what_was_not_searched_is_said() -> None:
    """Just below critical damping all flights are so long that their starts are beyond any bound."""
    p = Parameters(
        m="2.7", c="5.93999999406", k="3.267", A0="-2.587", B0="-1.78", Omega="1.178", v1="-1.419", v2="-0.945",
        mu1="0.399", mu2="0.118", FN="7.979",
    )  # fmt: skip
    solutions = solve_grazing(p, "P6", x_i="2.59", n=20)
    assert (solutions, solutions.complete) == ([], False)
    assert "longer than the search" in solutions.message


def test_the_work_is_bounded() -> None:
    slow = Parameters(
        m=1, c=0, k=1, A0=0, B0="0.001", Omega="0.0001", v1=0, v2=2, mu1=0, mu2=0, FN=1
    )
    with at_most(500_000):
        answers = [grazing_start(slow, mapping, theta) for mapping in ("P2", "P3") for theta in (1, 4)
                   if grazing_window(slow, mapping).contains(theta)]  # fmt: skip
    for start in answers:
        assert start.found or start.reason
