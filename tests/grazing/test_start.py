"""Grazing starts, and Theorem 6 at a state, against the oracle that knows only the ODE."""

from __future__ import annotations

import random
from fractions import Fraction
from math import cos, pi, sin
from typing import Any

import mpmath
import pytest
import sympy
from grazing_starts import BELT, DOMAIN, assert_oracle_grazes
from oracle import flow_oracle
from samples import sample_of

from symosc import Parameters, load_scene, simulate
from symosc.grazing.start import GrazingStart, grazing_start, is_grazing

BASE = Parameters(
    m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3
)


@pytest.mark.parametrize(
    ("scene", "mapping", "theta"), [("fig7-exact", "P2", sympy.pi), ("fig8-exact", "P3", 0)]
)
def test_starts_of_the_papers_grazing_figures(scene: str, mapping: str, theta: Any) -> None:
    expected = load_scene(scene)
    for arguments in ({"t_m": sympy.pi}, {"t_m": "pi"}, {"theta": theta}):
        start = grazing_start(expected.parameters, mapping, **arguments, t0="2.5", digits=50)
        assert start.found
        assert abs(Fraction(start.start["x0"]) - expected.x0) < Fraction(1, 10**40)
        assert abs(Fraction(start.start["v0"]) - expected.v0) < Fraction(1, 10**40)
        assert abs(start.t_m - mpmath.pi) < 1e-15
    events = simulate(expected.parameters, **start.start, t_end=4).events
    assert [event.kind for event in events] == ["graze"]
    assert abs(events[0].t - pi) < 1e-12


@pytest.mark.parametrize(("mapping", "theta"), [("P2", "0.42"), ("P5", "5.84"), ("P6", "4.1")])
@pytest.mark.parametrize(
    "changes", [{"k": "1.69", "c": 0}, {"c": "2.8284271247461903", "v1": "-0.2"}, {}], ids=str
)
def test_default_starts_have_forty_digits(
    changes: dict[str, Any], mapping: str, theta: str
) -> None:
    # Newton's method once stopped at 34 of them, after a halving of its bracket
    p = BASE.replace(**changes)
    start = grazing_start(p, mapping, theta)
    finer = grazing_start(p, mapping, theta, digits=70)
    for name in ("t0", "x0"):
        assert abs(Fraction(start.start[name]) - Fraction(finer.start[name])) <= Fraction(1, 10**40)


def test_digits_are_correct() -> None:
    for digits in (10, 60):
        start = grazing_start(BASE, "P2", "2", digits=digits)
        finer = grazing_start(BASE, "P2", "2", digits=90)
        with mpmath.workdps(100):
            for name in ("t", "x", "theta"):
                assert abs(getattr(start, name) - getattr(finer, name)) < mpmath.mpf(10) ** (
                    1 - digits
                )


@pytest.mark.full(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"c": 0},
        {"c": "5"},
        {"c": "2.8284271247461903", "v1": "-0.2"},
        {"k": "1.69", "c": 0},
        {"B0": -4, "Omega": "2.7"},
        {"v1": "0.3", "FN": 1},
    ],
    ids=str,
)
def test_the_oracle_grazes_from_random_starts(changes: dict[str, Any]) -> None:
    p = BASE.replace(**changes)
    rng = random.Random(str(changes))
    answers = []
    for mapping in DOMAIN:
        starts = [start for _ in range(12) if (start := random_start(p, mapping, rng)) is not None][
            :2
        ]
        for start in starts:
            answers.append(start.found)
            if start.found:
                assert_oracle_grazes(p, start)
            else:
                assert_came_from_elsewhere(p, start)
    assert sum(answers) >= 2, answers
    assert not all(answers), answers


def random_start(p: Parameters, mapping: str, rng: random.Random) -> GrazingStart | None:
    """Return what grazing_start says at a random phase, None outside the window."""
    theta = Fraction(rng.randrange(628), 100)
    slope = float(p.k * p.belt(BELT[mapping])) + float(p.B0 * p.Omega) * sin(theta)
    if (slope > 0) != (mapping in ("P2", "P5")) or abs(slope) < 1e-3:
        return None
    return grazing_start(p, mapping, theta)


def assert_came_from_elsewhere(p: Parameters, start: GrazingStart) -> None:
    """Between the point that the reason names and the tangency, the exact flow by matrix exponential stays inside."""
    domain = DOMAIN[start.mapping]
    own = BELT[start.mapping]
    assert start.reason
    if start.t is None:
        back = 5.0
    else:
        back = float(start.t_m) - float(start.t)
    walls = [
        (float(p.belt(b)), 1 if b == domain - 1 else -1)
        for b in (1, 2)
        if b in (domain - 1, domain)
    ]
    t_m = Fraction(str(start.t_m))
    x_m = Fraction(str(start.x_m))
    for j in range(1, 16):
        tau = Fraction(-back * j / 16).limit_denominator(10**6)
        v = float(flow_oracle(p, domain, t_m, x_m, p.belt(own), tau, dps=20)[1])
        assert all(inward * (v - wall) > -1e-9 for wall, inward in walls), (start.reason, tau)
    if start.t is not None:
        assert start.boundary == 3 - own
        state = flow_oracle(p, domain, t_m, x_m, p.belt(own), Fraction(str(start.t)) - t_m, dps=20)
        assert abs(float(state[1]) - float(p.belt(start.boundary))) < 1e-8
        assert abs(float(state[0]) - float(start.x)) < 1e-8 * max(1.0, abs(start.x))


def test_a_quartic_tangency_has_a_start() -> None:
    p = load_scene("fig7-exact").parameters
    start = grazing_start(p, "P2", 3 * sympy.pi / 2)
    assert start.found
    events = simulate(p, **start.start, t_end=5).events
    assert [event.kind for event in events] == ["graze"]
    assert abs(events[0].t - 1.5 * pi) < 1e-9


@pytest.mark.slow
@sample_of(5, 40)
def test_theorem_6_is_what_the_flow_does(count: int) -> None:
    rng = random.Random(3)
    for _ in range(count):
        theta = Fraction(rng.randrange(628), 100)
        for mapping, domain in DOMAIN.items():
            belt = BASE.belt(BELT[mapping])
            force = BASE.A(domain) - BASE.c * belt
            x = (float(force) + 4 * cos(theta)) / 2
            grazes = is_grazing(BASE, mapping, x, theta, tolerance=1e-10).grazing
            with mpmath.workdps(30):
                exact = (
                    mpmath.mpf(force.numerator) / force.denominator + 4 * mpmath.cos(float(theta))
                ) / 2
                x30 = Fraction(str(exact))
            t_m = theta / BASE.Omega
            flows = [
                flow_oracle(BASE, domain, t_m, x30, belt, tau, dps=30)[1]
                for tau in ("-1e-4", "1e-4")
            ]
            gaps = [float(v - mpmath.mpf(belt.numerator) / belt.denominator) for v in flows]
            if domain > BELT[mapping]:
                inward = 1
            else:
                inward = -1
            assert grazes == all(inward * gap > 0 for gap in gaps), (mapping, theta, gaps)


def test_theorem_6_at_states() -> None:
    p = load_scene("fig7-exact").parameters
    x_m = Fraction("-0.5855")  # (A0 + 0.9 FN - B0 - c v1)/k
    verdict = is_grazing(p, "P2", x_m, sympy.pi)
    assert (verdict.grazing, verdict.order) == (True, 1)
    assert abs(verdict.values[1] + 10) < 1e-12  # -(k v1/m + (B0 Omega/m) sin)
    beside = is_grazing(p, "P2", x_m + Fraction(1, 1000), sympy.pi)
    assert (beside.grazing, beside.order) == (False, 0)
    assert abs(beside.values[0] + 0.002) < 1e-12
    assert is_grazing(p, "P2", x_m + Fraction(1, 1000), sympy.pi, tolerance=1e-2).grazing
    quartic = is_grazing(p, "P2", Fraction("4.4145"), 3 * sympy.pi / 2)
    assert (quartic.grazing, quartic.order) == (True, 3)


def test_theorem_6_at_an_inflection() -> None:
    p = load_scene("fig9").parameters  # k v1 = 3, B0 Omega = 36
    theta = -sympy.asin(sympy.Rational(1, 12))
    for mapping, A in (("P2", p.A(1)), ("P3", p.A(2))):
        x = sympy.Rational(A - p.c) / 3 + 3 * sympy.cos(theta)
        verdict = is_grazing(p, mapping, x, theta)
        assert (verdict.grazing, verdict.order) == (False, 2)
