"""Motions that creep up to a belt's speed: no touch is invented, however near they come, and no contact is missed."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
from agreement import assert_event_agrees
from creeping import AHEAD, Creeping, to_a_belt_at_rest, to_a_limit_speed, with_a_tiny_drive
from oracle import simulate_oracle

from symosc import Parameters, simulate

DIGITS = [None, 17, 40]


def assert_right(scene: Creeping, digits: int | None) -> None:
    """No event where none is; else the first one at its time, or in doubles the admission that they cannot tell."""
    trajectory = simulate(scene.p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, digits=digits)
    if scene.contact is None:
        assert list(trajectory.events) == [], scene
        assert trajectory.status in ("equilibrium", "t_end"), scene
    elif trajectory.events:
        assert abs(float(trajectory.events[0].t) - scene.contact) < 1e-7 * scene.contact, scene
        assert trajectory.events[0].kind in ("cross", "stick")
    else:
        assert (digits, trajectory.status) == (None, "undecidable"), scene


@pytest.mark.slow
@pytest.mark.parametrize("digits", DIGITS)
@pytest.mark.parametrize("push", ["0", "1e-30", "1e-9", "0.3"])
@pytest.mark.parametrize("flight", AHEAD)
def test_no_touch_is_invented_beside_a_belt_at_rest(flight: str, push: str, digits: int | None) -> None:
    """push = 0: the start is on the fast manifold, exactly."""
    for critical in (False, True):
        rng = random.Random(f"rest {flight} {push} {critical}")
        assert_right(to_a_belt_at_rest(rng, flight, Fraction(push), critical), digits)


@pytest.mark.full(11)
@pytest.mark.slow
@pytest.mark.parametrize("digits", [None, 17])
@pytest.mark.parametrize("push", ["-1e-25", "-1e-13", "-1e-7", "-0.3"])
@pytest.mark.parametrize("flight", AHEAD)
def test_a_contact_from_beside_the_fast_manifold_is_found(flight: str, push: str, digits: int | None) -> None:
    rng = random.Random(f"manifold {flight} {push}")
    assert_right(to_a_belt_at_rest(rng, flight, Fraction(push)), digits)


@pytest.mark.full(11)
@pytest.mark.slow
@pytest.mark.parametrize("digits", [None, 17])
@pytest.mark.parametrize("beyond", ["0", "1e-20", "1e-13", "1e-6"])
@pytest.mark.parametrize("flight", AHEAD)
def test_a_limit_speed_that_is_a_belts(flight: str, beyond: str, digits: int | None) -> None:
    rng = random.Random(f"limit {flight} {beyond}")
    assert_right(to_a_limit_speed(rng, flight, Fraction(beyond)), digits)


FOUND: dict[str, tuple[dict[str, Any], tuple[Any, Any, Any]]] = {  # x0, v0, t_end
    "k = 0": (
        {"m": "13/20", "c": "143/10000", "k": 0, "A0": "-2011/50000", "B0": 0, "Omega": "1/1000", "v1": "-392/25",
         "v2": "-12/5", "mu1": "77/100", "mu2": "79/100", "FN": "59/200"}, ("3261/11", "-89/10", 22730)),
    "Omega3": (
        {"m": "21/100", "c": "1911/5000", "k": "11319/125000", "A0": "858363/1250000", "B0": 0, "Omega": "1/1000",
         "v1": 0, "v2": "1711/100", "mu1": "33/100", "mu2": 0, "FN": "67/50"}, ("-2171/770", "17/2", "3247/10")),
    "transparent": (
        {"m": "7/5", "c": "1477/2000", "k": "777/8000", "A0": "-777/8000", "B0": 0, "Omega": "3/625", "v1": 0,
         "v2": "91/10", "mu1": 0, "mu2": 0, "FN": "151/1000"}, ("-16792/2775", "27/20", 2000)),
    "k = 0, c large": (
        {"m": "81/10", "c": "3483/500", "k": 0, "A0": "50479/100000", "B0": 0, "Omega": "2/25", "v1": "-167/50",
         "v2": 0, "mu1": "61/100", "mu2": "41/50", "FN": "353/1000"}, ("-349/430", "87/100", "1163/10")),
    "two rates": (
        {"m": 2, "c": "98649/250000", "k": "4864453/250000000", "A0": "2809969923/1250000000", "B0": 0,
         "Omega": "1/1000", "v1": "-19647/5000", "v2": 0, "mu1": "3/10", "mu2": 0, "FN": "761/100"},
        ("372259/250745", "-3053/10000", 1031)),
}  # fmt: skip


@pytest.mark.parametrize("digits", DIGITS)
@pytest.mark.parametrize("name", FOUND)
def test_scenes_that_once_had_a_touch_too_many(name: str, digits: int | None) -> None:
    numbers, (x0, v0, t_end) = FOUND[name]
    trajectory = simulate(Parameters(**numbers), t0=0, x0=x0, v0=v0, t_end=t_end, digits=digits)
    assert list(trajectory.events) == []
    assert trajectory.status in ("equilibrium", "t_end")


REST = {"m": 1, "k": 1, "c": 3, "A0": 0, "B0": 0, "v1": -1, "v2": 0, "mu1": 0, "mu2": "3/10", "FN": 1}


@pytest.mark.parametrize("digits", DIGITS)
@pytest.mark.parametrize("Omega", ["1/1000", "1/100", "1/10"])
def test_real_contacts_and_then_no_touch(Omega: str, digits: int | None) -> None:
    """Two crossings and a stick come first; then v -> 0 like exp(-0.38 t), and a touch was once reported at t = 459."""
    p = Parameters(**REST, Omega=Omega)
    trajectory = simulate(p, t0=0, x0=5, v0="1/5", t_end=1500, digits=digits)
    run = simulate_oracle(p, 0, 5, "1/5", 30, 40)
    for event, expected in zip(trajectory.events, run.events, strict=True):
        assert_event_agrees(event, expected)
    assert trajectory.status == "equilibrium"


# -- a tiny drive: in the end it decides ------------------------------------------------------------------------------


@pytest.mark.full(2)
@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("size", "flight"), [(3, "Omega1 up"), (9, "Omega2 down"), (16, "Omega2 up"), (22, "Omega3 down")]
)
def test_events_of_a_tiny_drive_are_not_missed(size: int, flight: str) -> None:
    scene = with_a_tiny_drive(random.Random(f"drive {flight} {size}"), flight, size)
    run = simulate_oracle(scene.p, 0, scene.x0, scene.v0, scene.t_end, 40 + 2 * size)
    assert run.events
    for digits in (None, 20):
        trajectory = simulate(scene.p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, digits=digits)
        for event, expected in zip(trajectory.events, run.events, strict=False):
            assert_event_agrees(event, expected)
        assert_errors_within_flights(trajectory)
        if trajectory.status == "undecidable":
            assert digits is None
        else:
            assert len(trajectory.events) == len(run.events), scene


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
        trajectory = simulate(p, t0=0, x0="-29742917/68781330", v0="31/100", t_end="1053/10", digits=digits)
        assert [event.kind for event in trajectory.events] == ["stick", "slip"]
        assert [float(event.t) for event in trajectory.events] == pytest.approx([24.9047818, 85.6285463], abs=1e-7)
        assert_errors_within_flights(trajectory)


@pytest.mark.campaign
@pytest.mark.parametrize("flight", AHEAD)
@pytest.mark.parametrize("seed", range(15))
def test_many_creeping_motions(seed: int, flight: str) -> None:
    for push in ("0", "1e-30", "1e-9", "0.3", "-1e-25", "-1e-13", "-1e-7", "-0.3"):
        rng = random.Random(f"many {flight} {push} {seed}")
        assert_right(to_a_belt_at_rest(rng, flight, Fraction(push), seed % 4 == 0 and Fraction(push) >= 0), None)
        assert_right(to_a_limit_speed(rng, flight, abs(Fraction(push)) / 10), None)
    for size in (3, 9, 16, 22):
        scene = with_a_tiny_drive(random.Random(f"many {flight} {size} {seed}"), flight, size)
        run = simulate_oracle(scene.p, 0, scene.x0, scene.v0, scene.t_end, 40 + 2 * size)
        trajectory = simulate(scene.p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end)
        for event, expected in zip(trajectory.events, run.events, strict=False):
            assert_event_agrees(event, expected)
        assert trajectory.status == "undecidable" or len(trajectory.events) == len(run.events), scene
