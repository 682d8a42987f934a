"""The search for the first contact of a flight: none is passed over, and what it costs."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from random_constants import constants_of

from symosc import Parameters, load_scene, simulate, simulate_many
from symosc.engine import first_exit as first_exit_module
from symosc.engine import flow, gap_bounds, stick_exit
from symosc.engine import march as march_module
from symosc.engine.first_exit import first_exit
from symosc.engine.flow import constants as constants_of_parameters
from symosc.engine.flow import state_at
from symosc.engine.state import (
    HIT,
    NOTHING,
    Covariance,
    Launch,
    Walls,
)

pytestmark = pytest.mark.usefixtures("interpreted")


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


def test_a_phase_turned_by_taylor() -> None:
    for angle in (1e-3, -7e-4, 1e-9):
        s, c = flow.turned(math.sin(1.2), math.cos(1.2), angle)
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
    counts = counted(monkeypatch, (march_module, "stays_open"), (gap_bounds, "gap_polynomial"))
    table = interpreted("fig6", 200)
    assert counts["stays_open"] + counts["gap_polynomial"] < 20 * len(table)


@pytest.mark.quick(3)
@pytest.mark.parametrize("c", ["0.7", "0.3", "2.2"])
@pytest.mark.parametrize("Omega", ["1e-4", "1e-5", "1e-7"])
def test_what_a_slow_drive_costs_does_not_grow_with_its_period(
    Omega: str, c: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once the free oscillation is gone the steps are those of the drive, in doubles and in 36 digits."""
    counts = counted(
        monkeypatch, (march_module, "stays_open"), (gap_bounds, "gap_polynomial"), (first_exit_module, "state_at")
    )
    p = Parameters(
        m="1.9", c=c, k=2, A0="-1.8", B0="18.3", Omega=Fraction(Omega), v1=-1, v2="1e-6", mu1=1, mu2="0.8", FN="13.9"
    )
    found = simulate(p, t0="-3/2", x0="-13/5", v0="-4/5", t_end=5 / Fraction(Omega))
    exact = simulate(p, t0="-3/2", x0="-13/5", v0="-4/5", t_end=5 / Fraction(Omega), digits=20)
    assert [event.kind for event in found.events] == [event.kind for event in exact.events]
    assert found.status == "t_end"
    assert sum(counts.values()) < 20_000


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


def test_a_root_near_0_is_found_to_the_resolution() -> None:
    """Of a quartic whose root is known: simple roots, and such whose slope, bend or third derivative is small there."""
    rng = random.Random(31)
    for _ in range(4000):
        root, resolution = 10 ** rng.uniform(-6, -1) * rng.choice([-1, 1]), 10 ** rng.uniform(-12, -6)
        F, G1, G2, G3 = (10 ** rng.uniform(-3, 1) * rng.choice([-1, 1]) for _ in range(4))
        G1, G2 = G1 - rng.choice([0, 1]) * (G1 + G2 * root), G2 - rng.choice([0, 0.99]) * (G2 + G3 * root)
        if abs(root) * (abs(G1) + abs(G2) + abs(G3)) > 0.2 * abs(F):
            continue  # then another root may be as near
        over = -(F + (G1 / 2 + (G2 / 6 + G3 / 24 * root) * root) * root) * root
        found = gap_bounds.local_root(over, F, G1, G2, G3, resolution)
        assert abs(found - root) <= resolution + 1e-15


def test_a_polynomial_without_a_slope_is_left_where_it_is() -> None:
    """Newton's method has no step where the slope is 0: at the guess 0, however large the other coefficients are."""
    rng = random.Random(32)
    for _ in range(200):
        over, G1, G2, G3 = (rng.choice([0.0, 10 ** rng.uniform(-9, 3) * rng.choice([-1, 1])]) for _ in range(4))
        assert first_exit_module.local_root(over, 0.0, G1, G2, G3, 1e-12) == 0.0


@pytest.mark.quick(1)
@pytest.mark.parametrize("part", [0.05, 0.3])
def test_what_a_step_goes_past_is_found_behind_it(part: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps that no bound has made: whatever wall a step ends behind, the contact on it is the answer, on that side."""
    rng, sides = random.Random(33), []

    def stride(cap: float, now: Any, M4: float, margin: float, walls: Walls) -> tuple[int, float, float, Any]:
        step = min(cap, part / K.rate)
        side = rng.choice([-1, 1])
        return side, step, cap, gap_bounds.gap_bound(side, now, M4, margin, walls)

    monkeypatch.setattr(first_exit_module, "nearest_root", stride)
    monkeypatch.setattr(first_exit_module, "may_touch", lambda *_: False)
    for _ in range(60):
        K = constants_of(rng)._replace(apart=False)  # nothing marches ahead
        v0, a0, theta = rng.uniform(-0.95, 0.95), rng.uniform(-9, 9), rng.uniform(0, 6.28)
        start = Launch(v0, a0, math.sin(theta), math.cos(theta))
        walls = Walls(v0 + 1, 1 - v0, True, True, False, False)
        code, side, now = first_exit(min(K.chunk, 40 / K.rate), start, walls, Covariance(0.0, 0.0, 0.0), K)
        grid = np.linspace(0, now.tau, 400)[:-1]
        gaps = [1 - abs(v0 + state_at(time, start, K).dv) for time in grid]
        if code != HIT:
            assert code == NOTHING
            assert now.tau == min(K.chunk, 40 / K.rate)
            continue
        sides.append(side)
        assert v0 + state_at(now.tau, start, K).dv == pytest.approx(side, abs=1e-12 * (1 + abs(a0) + K.V0))
        missed = [time for time, gap in zip(grid, gaps, strict=True) if gap < -1e-9]
        assert all(time > now.tau - 2 * part / K.rate for time in missed)  # in the stride of the contact at most
    assert sides.count(-1) > 5
    assert sides.count(1) > 5


@pytest.mark.parametrize("on_below", [False, True])
@pytest.mark.parametrize("on_above", [False, True])
def test_a_launch_from_rest_on_a_belt_is_flat_as_far_as_rounding_tells(on_below: bool, on_above: bool) -> None:
    """At |k v| = |B0 Omega| and sin(theta) = +-1 the slope is 0 too: the search begins behind that. Not elsewhere."""
    p = load_scene("fig7-exact").parameters
    K = constants_of_parameters(p)
    v = K.belt1.v
    s = -K.w0sq * v / K.fB
    assert abs(s) == 1.0
    walls = Walls(0.0, K.belt2.v - v, True, True, on_below, on_above)
    on_a_belt = on_below or on_above
    for off, F, c in ((0.0, 0.0, 0.0), (1e-16, 0.0, 0.0), (1e-9, 0.0, 0.0), (0.0, 1e-9, 0.0), (1e-16, 0.0, 1e-3)):
        start = Launch(v, F, s * (1.0 - off), c)
        now, behind = first_exit_module.search_start(10.0, start, walls, K)
        flat = on_a_belt and F == 0.0 and off < 1e-12
        assert behind == (flat and c == 0.0)
        if behind:
            assert 0.0 < now.tau < 10.0
            assert now == state_at(now.tau, start, K)
            assert first_exit_module.search_start(0.5 * now.tau, start, walls, K)[0].tau == 0.5 * now.tau
        else:
            assert (now.tau, now.dx, now.dv, now.F) == (0.0, 0.0, 0.0, F)
            assert now.G1 == 0.0 or not flat
            assert now.G1 != 0.0 or flat or not (off or F)
