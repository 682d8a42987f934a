"""Grazing starts, curves and Theorem 6 at a state, against the oracle that knows only the ODE."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise
from math import cos, pi, sin, sqrt
from typing import Any

import mpmath
import pytest
import sympy
from oracle import flow_oracle, simulate_oracle
from samples import sample_of

from symosc import ParameterError, Parameters, load_scene, simulate
from symosc.grazing.backward_flow import first_root
from symosc.grazing.curve import grazing_curve
from symosc.grazing.solve import solve_grazing
from symosc.grazing.start import GrazingStart, grazing_start
from symosc.grazing.state import is_grazing
from symosc.plot.curve import figure_grazing_curve

DOMAIN = {"P2": 1, "P3": 2, "P5": 2, "P6": 3}
BELT = {"P2": 1, "P3": 1, "P5": 2, "P6": 2}
BASE = Parameters(m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3)


def assert_oracle_grazes(p: Parameters, start: GrazingStart, dps: int = 45) -> None:
    """The oracle, from the start as printed, touches the belt at t_m and at no time before; simulate says so too."""
    assert start.found, start.reason
    begin, last = start.start, Fraction(str(start.t_m)) + Fraction(1, 1000)
    t0, x0, v0 = (Fraction(str(begin[name])) for name in ("t0", "x0", "v0"))
    # The start has 40 digits: a gap of the oracle below 1e-30 is a touch.
    run = simulate_oracle(p, t0, x0, v0, last, dps=dps - 10)
    first = run.events[0]
    boundary, domain = BELT[start.mapping], f"Omega{DOMAIN[start.mapping]}"
    assert (first.kind, first.boundary, first.source, first.target) == ("graze", boundary, domain, domain), run.events
    assert abs(float(first.t) - float(start.t_m)) < 1e-8 * max(1.0, abs(start.t_m))
    event = simulate(p, **begin, t_end=last).events[0]
    assert (event.kind, event.boundary, event.source) == ("graze", boundary, domain)
    assert abs(event.t - float(start.t_m)) < 1e-8 * max(1.0, abs(start.t_m))


@pytest.mark.parametrize(("scene", "mapping", "theta"), [("fig7-exact", "P2", sympy.pi), ("fig8-exact", "P3", 0)])
def test_starts_of_the_papers_grazing_figures(scene: str, mapping: str, theta: Any) -> None:
    expected = load_scene(scene)
    for given in ({"t_m": sympy.pi}, {"t_m": "pi"}, {"theta": theta}):
        start = grazing_start(expected.parameters, mapping, **given, t0="2.5", digits=50)
        assert start.found
        assert abs(Fraction(start.start["x0"]) - expected.x0) < Fraction(1, 10**40)
        assert abs(Fraction(start.start["v0"]) - expected.v0) < Fraction(1, 10**40)
        assert abs(start.t_m - mpmath.pi) < 1e-15
    events = simulate(expected.parameters, **start.start, t_end=4).events
    assert [event.kind for event in events] == ["graze"]
    assert abs(events[0].t - pi) < 1e-12


@pytest.mark.parametrize(("mapping", "theta"), [("P2", "0.42"), ("P5", "5.84"), ("P6", "4.1")])
@pytest.mark.parametrize("changes", [{"k": "1.69", "c": 0}, {"c": "2.8284271247461903", "v1": "-0.2"}, {}], ids=str)
def test_default_starts_have_forty_digits(changes: dict[str, Any], mapping: str, theta: str) -> None:
    # Newton's method once stopped at 34 of them, after a halving of its bracket
    p = BASE.replace(**changes)
    start, finer = grazing_start(p, mapping, theta), grazing_start(p, mapping, theta, digits=70)
    for name in ("t0", "x0"):
        assert abs(Fraction(start.start[name]) - Fraction(finer.start[name])) <= Fraction(1, 10**40)


def test_newton_keeps_all_digits() -> None:
    rng = random.Random(5)
    context = mpmath.mp.clone()
    context.dps = 60
    for _ in range(200):
        root, other = context.mpf(rng.random()), context.mpf(rng.uniform(1.5, 3))
        p = [root * other, -(root + other), context.mpf(1)]
        _, found = first_root(p, context.mpf(10) ** -55, context.eps)
        assert abs(found - root) < 1e-55


def test_digits_are_correct() -> None:
    for digits in (10, 60):
        start = grazing_start(BASE, "P2", "2", digits=digits)
        finer = grazing_start(BASE, "P2", "2", digits=90)
        with mpmath.workdps(100):
            for name in ("t", "x", "theta"):
                assert abs(getattr(start, name) - getattr(finer, name)) < mpmath.mpf(10) ** (1 - digits)


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
    p, rng = BASE.replace(**changes), random.Random(str(changes))
    answers = []
    for mapping in DOMAIN:
        starts = [start for _ in range(12) if (start := random_start(p, mapping, rng)) is not None][:3]
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
    domain, own = DOMAIN[start.mapping], BELT[start.mapping]
    assert start.reason
    back = 5.0 if start.t is None else float(start.t_m) - float(start.t)
    walls = [(float(p.belt(b)), 1 if b == domain - 1 else -1) for b in (1, 2) if b in (domain - 1, domain)]
    t_m, x_m = Fraction(str(start.t_m)), Fraction(str(start.x_m))
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


def test_a_flow_that_touches_the_other_belt_on_the_way() -> None:
    # fig8's orbit to which all motions tend grazes both belts, half a period apart
    start = grazing_start(load_scene("fig8").parameters, "P5", 0)
    assert (start.found, start.touch, start.boundary) == (False, True, 1)
    assert abs(start.t + pi / 2) < 1e-12
    assert "touches belt 1" in str(start.reason)


def test_unforced_overdamped_flow_runs_away() -> None:
    # v'' + 3 v' + 2 v = 0 from v = -1, a = 0: v = -2 e^{-t} + e^{-2t}, backward -> +infinity; belt 1 at -1 is met at
    # the root of e^{2s} - 2 e^s + 1 = (e^s - 1)^2: only s = 0, so domain 2 is left through belt 2
    p = BASE.replace(c=3, k=2, B0=0)
    start = grazing_start(p, "P3", 1)
    s = _log_root(float(p.v2))
    assert (start.found, start.boundary) == (False, 2)
    assert abs(float(start.t_m) - float(start.t) - s) < 1e-12
    # P5, from v = 1.5 below belt 2: v = 3 e^{-t} - 1.5 e^{-2t}: falls backward through belt 1
    start = grazing_start(p, "P5", 1)
    assert (start.found, start.boundary) == (False, 1)
    # P2 with v1 > 0: v = 2 v1 e^{-t} - v1 e^{-2t} runs away downward and never was on belt 1
    start = grazing_start(p.replace(v1=1), "P2", 1)
    assert (start.found, start.t, start.boundary, start.start) == (False, None, 0, {})
    assert "never met a belt" in str(start.reason)


def _log_root(v: float) -> float:
    # e^{2s} - 2 e^s = v
    return float(mpmath.log(1 + sqrt(1 + v)))


def test_search_that_is_too_short_says_so() -> None:
    p = BASE.replace(c=0, B0=0, v1=1, k=1)  # v = cos t: on belt 1 again 2 pi earlier, by a touch
    start = grazing_start(p, "P2", 0)
    assert start.found
    assert start.touch
    assert abs(start.t + 2 * pi) < 1e-12
    short = grazing_start(p, "P2", 0, periods=0.5)
    assert not short.found
    assert "periods" in str(short.reason)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"mapping": "P1", "theta": 1}, "mapping"),
        ({"mapping": "P8", "theta": 1}, "mapping"),
        ({"mapping": "P2", "theta": "5"}, "theta"),
        ({"mapping": "P2", "theta": sympy.asin(sympy.Rational(5, 13))}, "theta"),
        ({"mapping": "P2", "theta": "one"}, "theta"),
        ({"mapping": "P2", "theta": "pi**pi"}, "theta"),
        ({"mapping": "P2", "theta": sympy.Symbol("x")}, "theta"),
        ({"mapping": "P2", "theta": sympy.I}, "theta"),
        ({"mapping": "P2", "theta": float("nan")}, "theta"),
        ({"mapping": "P2"}, "theta"),
        ({"mapping": "P2", "theta": 1, "t_m": 1}, "theta"),
        ({"mapping": "P2", "t_m": 2, "t0": 3}, "t0"),
        ({"mapping": "P2", "theta": 2, "digits": 2}, "digits"),
    ],
)
def test_bad_input(arguments: dict[str, Any], name: str) -> None:
    with pytest.raises(ParameterError) as caught:
        grazing_start(BASE, **arguments)
    assert caught.value.name == name


def test_without_a_spring_there_is_no_contact_curve() -> None:
    for call in (grazing_start, grazing_curve):
        with pytest.raises(ParameterError, match="spring"):
            call(BASE.replace(k=0), "P2", 20)  # type: ignore[operator]


# -- the search for the first root -----------------------------------------------------------------------------------


def test_first_root_of_products() -> None:
    rng = random.Random(7)
    for _ in range(300):
        roots = sorted(rng.uniform(0.02, 1.5) for _ in range(rng.randrange(1, 6)))
        if any(b - a < 1e-3 for a, b in pairwise(roots)):
            continue
        p = [1.0]
        for root in roots:
            p = [(p[i] if i < len(p) else 0.0) - (p[i - 1] / root if i else 0.0) for i in range(len(p) + 1)]
        touch, found = first_root(p, 1e-15, 2.0**-53)
        assert not touch
        assert (found is None) == (roots[0] > 1)
        assert found is None or abs(found - roots[0]) < 1e-9


def test_first_root_tells_touches_and_near_misses() -> None:
    for depth in (1e-10, 0.0, -1e-10):  # (x - 0.6)^2 + depth
        touch, found = first_root([0.36 + depth, -1.2, 1.0], 1e-15, 2.0**-53)
        assert touch == (depth == 0.0)
        assert (found is None) == (depth > 0.0)
        if depth <= 0.0:
            assert abs(found - (0.6 - sqrt(-depth))) < 1e-8


# -- the curve -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("scene", "mapping"), [("fig10", "P5"), ("fig9", "P3"), ("fig6", "P2"), ("fig7-exact", "P2")])
def test_curve(scene: str, mapping: str) -> None:
    p = load_scene(scene).parameters
    curve = grazing_curve(p, mapping, 100)
    assert curve.pieces
    for piece in curve.pieces:
        middle = len(piece.theta_m) // 2
        for i in (3, middle, -4):
            start = grazing_start(p, mapping, float(piece.theta_m[i]))
            assert start.found
            assert abs(start.x - piece.x[i]) < 1e-8 * max(1.0, abs(start.x))
            assert abs(sin(0.5 * (start.theta - piece.theta[i]))) < 1e-8
        # the printed derivatives against differences
        at, step = float(piece.theta_m[middle]), 1e-5
        before, after = curve.sample(at - step), curve.sample(at + step)
        for name in ("x", "theta"):
            slope = (getattr(after, name) - getattr(before, name)) / (2 * step)
            assert abs(slope - getattr(piece, f"slope_{name}")[middle]) < 1e-5 * max(1.0, abs(slope))
        for end, inward in ((piece.low, 1), (piece.high, -1)):
            assert_end_is_located(p, mapping, end, inward, curve)


def assert_end_is_located(p: Parameters, mapping: str, end: Any, inward: int, curve: Any) -> None:
    """1e-7 inside the end there is a start, 1e-7 beyond there is none, or another one."""
    if end.reason == "closed":
        return
    inside = grazing_start(p, mapping, end.theta_m + inward * 1e-7)
    assert inside.found
    if end.reason == "end of the window":
        with pytest.raises(ParameterError):
            grazing_start(p, mapping, end.theta_m - inward * 1e-7)
        return
    beyond = grazing_start(p, mapping, end.theta_m - inward * 1e-7)
    if "on the way" in end.reason:
        assert abs((inside.t_m - inside.t) - (beyond.t_m - beyond.t)) > 1e-2
    else:
        assert not beyond.found


def test_solutions_with_one_unknown_given() -> None:
    p = load_scene("fig10").parameters
    known = grazing_start(p, "P6", 4)
    given = {"theta_m": 4, "theta_j": 4, "x_j": known.x_m, "theta_i": known.theta, "x_i": known.start["x0"]}
    for name, value in given.items():
        found = solve_grazing(p, "P6", n=100, **{name: value})
        assert any(abs(start.theta_m - 4) < 1e-9 and abs(start.x - known.x) < 1e-9 for start in found), name
    # a start of the same x that grazes at another phase: the curve has an extremum of x
    others = solve_grazing(p, "P6", n=100, x_i=known.start["x0"])
    assert len(others) == 2
    for start in others:
        assert_oracle_grazes(p, start)
    assert solve_grazing(p, "P6", n=100, x_i=1000) == []
    assert solve_grazing(p, "P6", x_j=1000) == []
    assert solve_grazing(p, "P6", theta_m=1) == []
    with pytest.raises(ParameterError):
        solve_grazing(p, "P6", x_i=1, x_j=1)


def test_curve_of_an_empty_window_and_its_figure() -> None:
    curve = grazing_curve(load_scene("fig8").parameters, "P2", 50)
    assert (curve.pieces, curve.gaps, curve.windows) == ((), (), ())
    assert len(figure_grazing_curve(curve).axes) == 2


def test_figure_shows_every_piece() -> None:
    curve = grazing_curve(load_scene("fig10").parameters, "P5", 50)
    plane, flight = figure_grazing_curve(curve).axes
    assert len(flight.lines) == sum(1 + 2 for _ in curve.pieces)  # a line and two ends each
    assert len(flight.patches) == len(curve.gaps)
    assert plane.get_title()


# -- Theorem 6 -------------------------------------------------------------------------------------------------------


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


@pytest.mark.slow
@sample_of(12, 40)
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
                exact = (mpmath.mpf(force.numerator) / force.denominator + 4 * mpmath.cos(float(theta))) / 2
                x30 = Fraction(str(exact))
            t_m = theta / BASE.Omega
            flows = [flow_oracle(BASE, domain, t_m, x30, belt, tau, dps=30)[1] for tau in ("-1e-4", "1e-4")]
            gaps = [float(v - mpmath.mpf(belt.numerator) / belt.denominator) for v in flows]
            inward = 1 if domain > BELT[mapping] else -1
            assert grazes == all(inward * gap > 0 for gap in gaps), (mapping, theta, gaps)
