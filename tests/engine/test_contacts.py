"""Contacts that are exact coincidences.

Starts on a belt, forces that vanish, grazes that come back for ever.
"""

from __future__ import annotations

import math
import random
from fractions import Fraction
from math import pi, sqrt
from typing import Any

import mpmath
import pytest
from agreement import BASE, CONTACTS, NEAR, assert_agrees, assert_event_agrees, oracle_of, simulated
from oracle import simulate_oracle
from touches import at_a_seam

from symosc import Parameters, simulate
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.next_event import following_sign

pytestmark = pytest.mark.usefixtures("interpreted")

# -- starts on a boundary ----------------------------------------------------------------------------------------------


def rational_start(p: Parameters, alpha: int, boundary: int, force: Fraction) -> Fraction:
    """Return x0 where F^(alpha) is `force` on the belt at t = 0, exactly."""
    return (p.A(alpha) + p.B0 - p.c * p.belt(boundary) - p.m * force) / p.k


@pytest.mark.quick(5)
@pytest.mark.parametrize("boundary", [1, 2])
@pytest.mark.parametrize(
    ("side", "force", "mode"),
    [
        ("low", "0.3", "belt"),  # F below > 0 > F above
        ("low", "-0.3", "below"),
        ("high", "0.3", "above"),
        ("high", "-0.3", "belt"),
        ("low", "10", "above"),
        ("high", "-10", "below"),
    ],
)
def test_starts_on_a_boundary(boundary: int, side: str, force: str, mode: str) -> None:
    x0 = rational_start(NEAR, boundary + (side == "high"), boundary, Fraction(force))
    check_start(NEAR, boundary, x0, mode)


@pytest.mark.quick(5)
# On the belt at t = 0, G^(1) = -(k/m) v_lambda: the sign of the belt's speed decides where F = 0.
@pytest.mark.parametrize("boundary", [1, 2])
@pytest.mark.parametrize(
    ("side", "speed", "mode"),
    [
        ("low", "0.5", "below"),  # F below falls through 0
        ("low", "-0.5", "belt"),  # F below rises from 0
        ("high", "0.5", "belt"),
        ("high", "-0.5", "above"),
        ("low", "0", "below"),  # G^(1) = 0, G^(2) = -B0 Omega^2/m < 0
        ("high", "0", "belt"),
    ],
)
def test_starts_where_a_force_vanishes(boundary: int, side: str, speed: str, mode: str) -> None:
    if boundary == 1:
        p = NEAR.replace(v1=speed, v2=5)
    else:
        p = NEAR.replace(v1=-5, v2=speed)
    check_start(
        p, boundary, rational_start(p, boundary + (side == "high"), boundary, Fraction(0)), mode
    )


@pytest.mark.parametrize("boundary", [1, 2])
@pytest.mark.parametrize(("speed", "mode"), [("0.5", "below"), ("-0.5", "above"), ("0", "below")])
def test_starts_on_a_transparent_belt_where_the_force_vanishes(
    boundary: int, speed: str, mode: str
) -> None:
    if boundary == 1:
        p = NEAR.replace(v1=speed, v2=5, mu1=0)
    else:
        p = NEAR.replace(v1=-5, v2=speed, mu2=0)
    check_start(p, boundary, rational_start(p, boundary, boundary, Fraction(0)), mode)


@pytest.mark.parametrize("third", [Fraction(1, 3), Fraction(-1, 3)])
def test_a_force_that_vanishes_only_in_rational_numbers(third: Fraction) -> None:
    """k = 1/3 and x0 = n/7 have no finite decimals; F = 0 all the same."""
    p = NEAR.replace(k=Fraction(1, 3), m=Fraction(2, 7), v1=third)
    check_start(p, 1, rational_start(p, 1, 1, Fraction(0)), "below" if third > 0 else "belt")


def check_start(p: Parameters, boundary: int, x0: Fraction, mode: str) -> None:
    name = {
        "below": f"Omega{boundary}",
        "above": f"Omega{boundary + 1}",
        "belt": f"belt{boundary}",
    }[mode]
    start = (0, x0, p.belt(boundary), 12)
    run = oracle_of(p, start)
    trajectory = simulated(p, start)
    assert run.events[0].source == name
    assert trajectory.mode(0.0) == name
    assert all(event.t > 0 for event in trajectory.events)
    assert_agrees(trajectory, run)
    leaves = {"below": -1, "above": 1, "belt": 0}[mode]
    gap = float(trajectory(float(run.events[0].t) / 1000)[1]) - float(p.belt(boundary))
    assert (gap > 0) - (gap < 0) == leaves


# -- forces that are 0 on a belt and do not change their sign ---------------------------------------------------------

# parameters beside mu1 = mu2 = 1/2, x0, v0, the belt: a force is >= 0 (below) or <= 0 (above), and
# not > or <
HELD = {
    "F(1) = 0": ({"A0": -1, "B0": 0, "c": 1, "k": 4, "v1": 0, "v2": 5}, "3/4", 0, "belt1"),
    "F(2) = 0": ({"A0": -4, "B0": 0, "c": 1, "k": 4, "v1": 0, "v2": 5}, -1, 0, "belt1"),
    "F(3) = 0": ({"A0": 4, "B0": 0, "c": 1, "k": 4, "v1": -5, "v2": 0}, 0, 0, "belt2"),
    "F(1) = 0, no spring": ({"A0": -3, "B0": 0, "c": 1, "k": 0, "v1": 1, "v2": 5}, 2, 1, "belt1"),
    "F(1) touches 0": ({"A0": -3, "B0": 1, "c": 1, "k": 4, "v1": 0, "v2": 5}, 0, 0, "belt1"),
    "F(2) touches 0": ({"A0": 1, "B0": -1, "c": 1, "k": 4, "v1": -5, "v2": 0}, 0, 0, "belt2"),
    "F(3) touches 0": ({"A0": 3, "B0": 1, "c": 1, "k": 4, "v1": -5, "v2": 0}, 0, 0, "belt2"),
}


@pytest.mark.quick(6)
@pytest.mark.parametrize("digits", [None, 30])
@pytest.mark.parametrize("name", HELD)
def test_a_force_that_is_only_just_enough_on_a_belt(name: str, digits: int | None) -> None:
    """A force that is 0 for ever, or touches 0 once a period and never changes its sign, does not end a stick."""
    changes, x0, v0, mode = HELD[name]
    p = BASE.replace(mu1="1/2", mu2="1/2", FN=4, Omega=1, **changes)
    assert oracle_of(p, (0, x0, v0, 30)).events == []
    trajectory = simulate(p, t0=0, x0=x0, v0=v0, t_end=30, digits=digits)
    assert list(trajectory.events) == []
    assert trajectory.status in ("t_end", "equilibrium")
    assert trajectory.mode(0.0) == trajectory.mode(25.0) == mode


# -- grazes and multiple roots in flight ------------------------------------------------------------------------------


@pytest.mark.full(4)
@pytest.mark.quick(5)
@pytest.mark.parametrize("digits", [None, 30])
@pytest.mark.parametrize(
    "Omega", ["1.3", "2"]
)  # the return takes less, and more, than a period of the drive
@pytest.mark.parametrize(
    ("mapping", "v1", "v2"), [("P2", 1, 5), ("P3", -1, 5), ("P5", -5, 1), ("P6", -5, -1)]
)
def test_an_orbit_that_grazes_for_ever(
    mapping: str, v1: int, v2: int, Omega: str, digits: int | None
) -> None:
    """Without drive and damper a mass that leaves its belt with F = 0 is back after each 2 pi sqrt(m/k)."""
    alpha, boundary, _, _ = CONTACTS[mapping]
    p = BASE.replace(c=0, B0=0, k=2, Omega=Omega, FN="0.5", v1=v1, v2=v2)
    trajectory = simulate(
        p, t0=0, x0=p.A(alpha) / p.k, v0=p.belt(boundary), t_end=20, digits=digits
    )
    expected = [("graze", boundary, f"Omega{alpha}", f"Omega{alpha}")] * 4
    assert [
        (event.kind, event.boundary, event.source, event.target) for event in trajectory.events
    ] == expected
    for n, event in enumerate(trajectory.events, 1):
        assert abs(event.t - n * 2 * pi / sqrt(2)) < 1e-12 * event.t
    assert trajectory.status == "t_end"


@pytest.mark.parametrize("digits", [None, 25])
def test_a_free_mass_that_grazes_once_a_period(digits: int | None) -> None:
    """With A_2 = 0, v = 3 - 4 sin t: v1 = -1 is touched where sin t = 1.

    V2 = 1 has no friction and is crossed.
    """
    p = BASE.replace(c=0, k=0, A0=1, B0=-4, Omega=1, v1=-1, v2=1, mu1="1/2", mu2=0, FN=2)
    trajectory = simulate(p, t0=0, x0=2, v0=3, t_end=36, digits=digits)
    times = [float(event.t) for event in trajectory.events if event.kind == "graze"]
    assert times == pytest.approx([(2 * n + 0.5) * pi for n in range(6)], abs=1e-11)
    assert {event.kind for event in trajectory.events} == {"graze", "cross"}
    assert len(trajectory.events) == 6 + 12
    assert trajectory.status == "t_end"


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [None, 25])
def test_a_crossing_at_a_triple_root(digits: int | None) -> None:
    """Started at F = G^(1) = 0, G^(2) < 0 on a transparent belt at rest, the undamped mass is back there after 2 pi."""
    p = BASE.replace(c=0, k=1, A0=-1, B0=8, Omega=2, v1="-0.5", v2=0, FN=0)
    run = oracle_of(p, (0, 7, 0, 15))
    back = [event for event in run.events if abs(event.t % (2 * mpmath.pi)) < 1e-9]
    assert [(event.kind, event.source, event.target) for event in back] == [
        ("cross", "Omega3", "Omega2")
    ] * 2
    trajectory = simulate(p, t0=0, x0=7, v0=0, t_end=15, digits=digits)
    assert_agrees(trajectory, run, 1e-12 if digits is None else 1e-24)


# -- the rule at a point of a belt -------------------------------------------------------------------------------------


def test_a_vanishing_force_is_decided_by_the_next_g_function() -> None:
    """m = c = k = Omega = 1, B0 = 2, v = 1.

    G^(1) = -(1 + 2 sin), G^(2) = -2 cos, G^(3) = 2 sin at F = 0.
    """
    p = Parameters(m=1, c=1, k=1, A0=0, B0=2, Omega=1, v1=1, v2=2, mu1=1, mu2=1, FN=1)
    K = Arithmetic(p).K
    assert following_sign(1.0, 0.0, 0.0, 1.0, K) == -1
    assert following_sign(1.0, 0.0, -1.0, 0.0, K) == 1
    half = math.sqrt(0.75)
    assert following_sign(1.0, 0.0, -0.5, half, K) == -1
    assert following_sign(1.0, 0.0, -0.5, -half, K) == 1
    equality = Arithmetic(p.replace(B0=1)).K  # the quartic tangency of Theorem 7's equality
    assert following_sign(1.0, 0.0, -1.0, 0.0, equality) == -1
    nothing = Arithmetic(p.replace(B0=0, k=0)).K
    assert following_sign(1.0, 0.0, 0.0, 1.0, nothing) == 0


OFFSETS = [0, 1e-17, -1e-17, 1e-15, -1e-15, 1e-13, -1e-11, 1e-9, -1e-7, 1e-5, -1e-3]


# -- periodic touches of all kinds -------------------------------------------------------------------------------------


@pytest.mark.quick(2)
@pytest.mark.parametrize(("t_end", "touches"), [(30, 4), (70, 11)])
@pytest.mark.parametrize(("c", "digits"), [(2, None), (6, None), (6, 17)])
def test_a_belt_that_is_touched_once_a_period(
    c: int, digits: int | None, t_end: int, touches: int
) -> None:
    """x = 2/5 + sin t: each touch lies where the search that began at the one before ends."""
    p = Parameters(m=1, c=c, k=1, A0="1/5", B0=c, Omega=1, v1=-5, v2=1, mu1=0, mu2="1/5", FN=1)
    trajectory = simulate(p, t0=0, x0="2/5", v0=1, t_end=t_end, digits=digits)
    assert [event.kind for event in trajectory.events] == ["graze"] * touches
    assert [float(event.t) for event in trajectory.events] == pytest.approx(
        [6.283185307179586 * n for n in range(1, touches + 1)], rel=1e-13
    )
    assert trajectory.status == "t_end"


@pytest.mark.full(3)
@pytest.mark.quick(2)
@pytest.mark.parametrize("offset", OFFSETS)
def test_a_touch_where_two_searches_meet(offset: float) -> None:
    if offset >= 0:
        mapping = "P3"
    else:
        mapping = "P5"
    scene = at_a_seam(random.Random(f"seam {mapping} {offset}"), mapping, offset)
    for digits in (None, 17):
        motion = simulate(scene.p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, digits=digits)
        assert [(event.kind, event.boundary) for event in motion.events] == [
            ("graze", scene.boundary)
        ] * len(scene.times)
        assert [float(event.t) for event in motion.events] == pytest.approx(scene.times, rel=1e-10)
        assert motion.status == "t_end"


# -- contacts at the very end ------------------------------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [None, 20])
def test_a_crossing_exactly_at_the_end_is_not_in_doubt(digits: int | None) -> None:
    """v = v0 + A t meets belt 2 at a rational time, which is t_end.

    It counts or not, but nothing is undecided. If it counts, the mass is at rest from then on.
    """
    rng = random.Random(1)
    for _ in range(40):
        p = Parameters(
            m=Fraction(rng.randint(1, 30), 10), c=0, k=0, A0=Fraction(rng.randint(1, 30), 10), B0=0, Omega=1, v1=-100,
            v2=0, mu1=0, mu2="0.5", FN=10,
        )  # fmt: skip
        v0 = Fraction(rng.randint(-40, -1), 10)
        t = -v0 * p.m / p.A(2)
        motion = simulate(p, t0=0, x0=0, v0=v0, t_end=t, digits=digits)
        assert motion.status in ("t_end", "equilibrium")
        assert len(motion.events) <= 1
        later = simulate(p, t0=0, x0=0, v0=v0, t_end=t + Fraction(1, 10**6), digits=digits)
        assert [float(event.t) for event in later.events] == pytest.approx([float(t)], rel=1e-14)


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_a_motion_may_end_at_any_of_its_events_as_doubles_have_them(name: str) -> None:
    """What is left then may be a little less than nothing."""
    for event in simulate(name, t_end=12).events:
        motion = simulate(name, t_end=event.t)
        assert motion.status == "t_end"
        assert len(motion.events) <= len(simulate(name, t_end=event.t * (1 + 1e-12)).events)


REST = {
    "m": 1,
    "k": 1,
    "c": 3,
    "A0": 0,
    "B0": 0,
    "v1": -1,
    "v2": 0,
    "mu1": 0,
    "mu2": "3/10",
    "FN": 1,
}


@pytest.mark.parametrize("digits", [None, 17, 40])
@pytest.mark.parametrize("Omega", ["1/1000", "1/100", "1/10"])
def test_real_contacts_and_then_no_touch(Omega: str, digits: int | None) -> None:
    """Two crossings and a stick come first.

    Then v -> 0 like exp(-0.38 t), and a touch was once reported at t = 459.
    """
    p = Parameters(**REST, Omega=Omega)
    trajectory = simulate(p, t0=0, x0=5, v0="1/5", t_end=1500, digits=digits)
    run = simulate_oracle(p, 0, 5, "1/5", 30, 40)
    for event, expected in zip(trajectory.events, run.events, strict=True):
        assert_event_agrees(event, expected)
    assert trajectory.status == "equilibrium"


# -- a tiny drive: in the end it decides ------------------------------------------------------------------------------


def assert_errors_within_flights(trajectory: Any) -> None:
    """An event that may be anywhere in its flight is none."""
    for segment, event in zip(trajectory.segments, trajectory.events, strict=False):
        assert event.t_error <= segment.t_end - segment.t_start


@pytest.mark.slow
def test_an_event_behind_a_tiny_drive() -> None:
    """Doubles once ended as t_end, without these two."""
    p = Parameters(
        m="219/500", c="570057/250000", k="6878133/2500000", A0="-67/500", B0="43/1000000000000000000000",
        Omega="57/1000", v1=-1, v2=0, mu1="37/100", mu2="459/1000", FN="183/250",
    )  # fmt: skip
    for digits in (None, 20, 40):
        trajectory = simulate(
            p, t0=0, x0="-29742917/68781330", v0="31/100", t_end="1053/10", digits=digits
        )
        assert [event.kind for event in trajectory.events] == ["stick", "slip"]
        assert [float(event.t) for event in trajectory.events] == pytest.approx(
            [24.9047818, 85.6285463], abs=1e-7
        )
        assert_errors_within_flights(trajectory)
