"""The pieces of the event search: each bound is a bound, each step stays before the first root."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symosc import Parameters, load_scene, simulate, simulate_many
from symosc.engine import first_exit as first_exit_module
from symosc.engine import gap_bounds, stick_exit
from symosc.engine import march as march_module
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.first_exit import first_exit, march
from symosc.engine.flow import Constants, derivatives, state_at
from symosc.engine.gap_bounds import fourth_derivative_bound, positive_on, safe_step
from symosc.engine.state import (
    BELT,
    DOMAIN_ABOVE,
    DOMAIN_BELOW,
    HIT,
    NOTHING,
    Covariance,
    Flown,
    Hold,
    Launch,
    Walls,
)
from symosc.engine.stick_exit import belt_exit, gain
from symosc.engine.switching import following_sign, resolve

COEFFICIENTS = st.floats(-5, 5)


def constants_of(rng: random.Random, **fixed: object) -> Constants:
    """Return constants of random parameters: under- and overdamped, near resonance and far from it."""
    numbers = {name: round(10 ** rng.uniform(-1, 1), 6) for name in ("m", "c", "k", "B0", "Omega", "FN")}
    if rng.random() < 0.3:
        numbers |= {"k": numbers["m"] * numbers["Omega"] ** 2, "c": round(10 ** rng.uniform(-9, -2), 12)}
    p = Parameters(**(numbers | {"A0": 1, "v1": -1, "v2": 1, "mu1": 0.3, "mu2": 0.2} | fixed))
    return Arithmetic(p).K


@pytest.mark.slow
@given(st.tuples(*[COEFFICIENTS] * 5), st.floats(0.01, 3))
@settings(derandomize=True, deadline=None, max_examples=300)
def test_positive_bernstein_coefficients_mean_a_positive_polynomial(p: tuple[float, ...], s: float) -> None:
    values = np.polyval(p[::-1], np.linspace(0, s, 200))
    if positive_on(s, *p):
        assert values.min() > -1e-12
    elif p[0] > 0:  # not too shy: on a tenth of the way to the nearest possible root it says so
        reach = p[0] / (p[0] + max(map(abs, p[1:])))
        assert positive_on(min(0.1 * reach, s), *p)


@pytest.mark.slow
@given(st.floats(1e-6, 5), st.tuples(*[COEFFICIENTS] * 3), st.floats(0.01, 5))
@settings(derandomize=True, deadline=None, max_examples=500)
def test_a_safe_step_stays_before_the_first_root(p0: float, middle: tuple[float, ...], p4: float) -> None:
    p = (p0, *middle, -p4)
    step, root = safe_step(10.0, *p)
    roots = np.roots(p[::-1])
    first = min((r.real for r in roots if abs(r.imag) < 1e-9 and r.real > 0), default=math.inf)
    assert 0 < step <= first * (1 + 1e-9)
    if root < 10.0:
        assert root == pytest.approx(first, rel=1e-4)


def test_the_fourth_derivative_stays_within_its_bound() -> None:
    rng = random.Random(5)
    for _ in range(200):
        K = constants_of(rng)
        v0, a0, theta = rng.uniform(-3, 3), rng.uniform(-20, 20), rng.uniform(0, 6.28)
        s0, c0 = math.sin(theta), math.cos(theta)
        _, w, j = derivatives(v0, a0, s0, c0, K)
        bound = fourth_derivative_bound(w, j, s0, c0, K)
        reach = 20 / K.rate if K.steady else 1 / K.Om
        for tau in np.linspace(0, reach, 60):
            assert abs(state_at(tau, Launch(v0, a0, s0, c0), K).G3) <= bound * (1 + 1e-9)


@pytest.mark.slow
def test_marching_is_the_flow_and_stops_before_the_first_contact() -> None:
    rng = random.Random(6)
    marched = 0
    for _ in range(500):
        K = constants_of(rng)
        if not K.apart:
            continue
        v0, a0, theta = rng.uniform(-0.9, 0.9), rng.uniform(-9, 9), rng.uniform(0, 6.28)
        s0, c0 = math.sin(theta), math.cos(theta)
        b, w, j = derivatives(v0, a0, s0, c0, K)
        M4 = fourth_derivative_bound(w, j, s0, c0, K)
        walls, start = Walls(v0 + 1, 1 - v0, True, True, False, False), Launch(v0, a0, s0, c0)
        now = Flown(0.0, 0.0, 0.0, a0, b, w, j, s0, c0, 1.0, 0.0, 0.0)
        now, _ = march(K.chunk, v0, now, M4, walls, 0.0, K)
        exact = state_at(now.tau, start, K)
        scale = abs(v0) + K.V0 + abs(a0) / K.w0 + 1
        assert now.dv == pytest.approx(exact.dv, abs=1e-12 * scale)
        assert pytest.approx(exact.F, abs=1e-11 * scale * K.rate) == now.F
        assert pytest.approx(exact.G3, abs=1e-11 * scale * K.rate**4) == now.G3
        assert (now.s, now.c) == pytest.approx((exact.s, exact.c), abs=1e-14)
        marched += now.tau > 0
        for time in np.linspace(0, now.tau, 50):
            assert abs(v0 + state_at(time, start, K).dv) < 1
    assert marched > 50


@pytest.mark.slow
def test_no_contact_is_passed_over() -> None:
    """Against the signs of a fine scan: an independent check that can only miss what is shorter than its step."""
    rng = random.Random(8)
    hits = 0
    for _ in range(300):
        K = constants_of(rng)
        v0, a0, theta = rng.uniform(-0.95, 0.95), rng.uniform(-9, 9), rng.uniform(0, 6.28)
        start = Launch(v0, a0, math.sin(theta), math.cos(theta))
        walls = Walls(v0 + 1, 1 - v0, True, True, False, False)
        code, side, now = first_exit(K.chunk, start, walls, Covariance(0.0, 0.0, 0.0), K)
        assert code in (HIT, NOTHING)
        before = np.linspace(0, now.tau, 400)[:-1]
        assert all(abs(v0 + state_at(time, start, K).dv) < 1 for time in before)
        if code == HIT:
            hits += 1
            assert v0 + state_at(now.tau, start, K).dv == pytest.approx(side, abs=1e-13 * (1 + abs(a0)))
    assert hits > 100


def test_the_end_of_a_stick_is_the_first() -> None:
    rng = random.Random(9)
    ends = 0
    for _ in range(300):
        K = constants_of(rng, v1=round(rng.uniform(-2, 0.5), 3))
        belt, theta = K.belt1, rng.uniform(0, 2 * math.pi)
        below = rng.uniform(0.01, 0.99) * belt.J
        s0, c0 = math.sin(theta), math.cos(theta)
        code, side, tau, _, _, _ = belt_exit(K.period, Hold(below, below - belt.J, theta, s0, c0), 0.0, belt, K)
        inside = [below + gain(time, s0, c0, belt, K)[0] for time in np.linspace(0, tau, 300)[:-1]]
        assert all(0 < force < belt.J for force in inside)
        if code == HIT:
            ends += 1
            force = below + gain(tau, s0, c0, belt, K)[0]
            assert force == pytest.approx(0 if side < 0 else belt.J, abs=1e-13 * (belt.J + abs(K.f0)))
    assert ends > 100


def test_theorems_4_and_5() -> None:
    K = constants_of(random.Random(1))
    assert resolve(-1.0, 2.0, -1.0, 0.0, 1.0, K) == BELT
    assert resolve(-1.0, 2.0, 1.0, 0.0, 1.0, K) == DOMAIN_ABOVE
    assert resolve(-1.0, -1.0, -2.0, 0.0, 1.0, K) == DOMAIN_BELOW


def test_a_vanishing_force_is_decided_by_the_next_g_function() -> None:
    """m = c = k = Omega = 1, B0 = 2, v = 1: G^(1) = -(1 + 2 sin), G^(2) = -2 cos, G^(3) = 2 sin at F = 0."""
    p = Parameters(m=1, c=1, k=1, A0=0, B0=2, Omega=1, v1=1, v2=2, mu1=1, mu2=1, FN=1)
    K = Arithmetic(p).K
    assert following_sign(1.0, 0.0, 0.0, 1.0, K) == (-1, 1)
    assert following_sign(1.0, 0.0, -1.0, 0.0, K) == (1, 1)
    half = math.sqrt(0.75)
    assert following_sign(1.0, 0.0, -0.5, half, K) == (-1, 2)
    assert following_sign(1.0, 0.0, -0.5, -half, K) == (1, 2)
    equality = Arithmetic(p.replace(B0=1)).K  # the quartic tangency of Theorem 7's equality
    assert following_sign(1.0, 0.0, -1.0, 0.0, equality) == (-1, 3)
    nothing = Arithmetic(p.replace(B0=0, k=0)).K
    assert following_sign(1.0, 0.0, 0.0, 1.0, nothing)[0] == 0


def test_a_phase_turned_by_taylor() -> None:
    for angle in (1e-3, -7e-4, 1e-9):
        s, c = first_exit_module.turned(math.sin(1.2), math.cos(1.2), angle)
        with mpmath.workdps(30):
            assert abs(s - mpmath.sin(mpmath.mpf(1.2) + angle)) < 3e-16 + abs(angle) ** 5
            assert abs(c - mpmath.cos(mpmath.mpf(1.2) + angle)) < 3e-16 + abs(angle) ** 5


def counted(monkeypatch: pytest.MonkeyPatch, *functions: tuple[Any, str]) -> dict[str, int]:
    """Count the calls of functions, given as (module, name)."""
    counts = {name: 0 for _, name in functions}

    def replaced(original: Any, name: str) -> Any:
        def call(*arguments: Any) -> Any:
            counts[name] += 1
            return original(*arguments)

        return call

    for module, name in functions:
        monkeypatch.setattr(module, name, replaced(getattr(module, name), name))
    return counts


def interpreted(name: str, most: int) -> Any:
    scene = load_scene(name)
    start = [scene.t0, scene.x0, scene.v0]
    return simulate_many(scene.parameters, start, 10**6, max_events=most, accuracy=math.inf, use_numba=False)


@pytest.mark.parametrize(("name", "most"), [("fig5", 400), ("fig9", 400), ("fig10", 400), ("fig8", 20)])
def test_a_flight_takes_one_evaluation_of_the_flow_and_a_stick_two_of_the_force(
    name: str, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    counts = counted(monkeypatch, (first_exit_module, "state_at"), (stick_exit, "gain"))
    table = interpreted(name, most)
    held = np.count_nonzero(table.kind == "slip")
    assert counts["gain"] <= 2 * held
    if name != "fig8":  # near its grazes the search takes smaller steps
        assert counts["state_at"] <= 1.02 * (len(table) - held) + 10  # some more before the motion is periodic


def test_a_slow_drive_is_passed_in_strides(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half a period of fig6's drive is 31 short steps."""
    counts = counted(monkeypatch, (march_module, "gap_polynomial"), (gap_bounds, "gap_polynomial"))
    table = interpreted("fig6", 200)
    assert counts["gap_polynomial"] < 20 * len(table)


@pytest.mark.parametrize("c", ["0.7", "0.3", "2.2"])
@pytest.mark.parametrize("Omega", ["1e-4", "1e-5", "1e-7"])
def test_what_a_slow_drive_costs_does_not_grow_with_its_period(
    Omega: str, c: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once the free oscillation is gone the steps are those of the drive, in doubles and in 36 digits."""
    counts = counted(
        monkeypatch, (march_module, "gap_polynomial"), (gap_bounds, "gap_polynomial"), (first_exit_module, "state_at")
    )
    p = Parameters(
        m="1.9", c=c, k=2, A0="-1.8", B0="18.3", Omega=Fraction(Omega), v1=-1, v2="1e-6", mu1=1, mu2="0.8", FN="13.9"
    )
    found = simulate(p, t0="-3/2", x0="-13/5", v0="-4/5", t_end=5 / Fraction(Omega))
    exact = simulate(p, t0="-3/2", x0="-13/5", v0="-4/5", t_end=5 / Fraction(Omega), digits=20)
    assert [event.kind for event in found.events] == [event.kind for event in exact.events]
    assert found.status == "t_end"
    assert counts["gap_polynomial"] + counts["state_at"] < 20_000


@pytest.mark.parametrize("Omega", ["8", "8000"])
def test_a_drive_of_no_size_has_no_period(Omega: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """k = 0, and a limit speed 1e-20 beyond the belt: one contact after a long approach, whatever Omega says."""
    counts = counted(monkeypatch, (first_exit_module, "state_at"))
    v2 = Fraction("-0.13549")
    p = Parameters(
        m="0.595", c="0.06545", k=0, A0=0, B0=0, Omega=Omega, v1="-0.14", v2=v2, mu1="0.15", mu2="0.813", FN="0.517"
    )  # fmt: skip
    p = p.replace(A0=p.c * (v2 + Fraction(1, 10**20)) - p.FN * (p.mu2 - p.mu1))
    assert p.A(2) / p.c > v2
    found = simulate(p, t0=0, x0="9/5", v0="-0.138", t_end=1000)
    assert [event.kind for event in found.events] == ["stick"]
    assert counts["state_at"] < 1000
