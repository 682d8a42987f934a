"""Touches that come back for ever, exactly: none is missed, and a search that fails is never taken for an end."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from touches import NEIGHBOURS, Touching, at_a_seam, free, ordinary, undriven, wild

from symosc import Parameters, simulate
from symosc.engine import first_exit, gap_bounds, next_event, stick_exit, touches
from symosc.engine.start import Start
from symosc.engine.state import FlightEnd, Flown, StickEnd
from symosc.simulation.motion import Motion

pytestmark = pytest.mark.usefixtures("interpreted")

KINDS: dict[str, Callable[[random.Random, str], Touching]] = {
    "ordinary": ordinary,
    "wild": wild,
    "undriven": undriven,
    "free": free,
}
OFFSETS = [0, 1e-17, -1e-17, 1e-15, -1e-15, 1e-13, -1e-11, 1e-9, -1e-7, 1e-5, -1e-3]


def followed(scene: Touching, digits: int | None) -> Any:
    return simulate(scene.p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, digits=digits)


def assert_touches(trajectory: Any, scene: Touching) -> None:
    """The events are touches at the known times, from the first on, and nothing else."""
    domain = f"Omega{scene.domain}"
    for event, t in zip(trajectory.events, scene.times, strict=False):
        assert (event.kind, event.boundary, event.source, event.target) == ("graze", scene.boundary, domain, domain)
        assert abs(float(event.t) - t) < 1e-10 * t, scene
    assert len(trajectory.events) <= len(scene.times), scene


def assert_complete(trajectory: Any, scene: Touching) -> None:
    assert_touches(trajectory, scene)
    assert (trajectory.status, len(trajectory.events)) == ("t_end", len(scene.times)), scene


# -- periodic touches of all kinds -------------------------------------------------------------------------------------


@pytest.mark.full(11)
@pytest.mark.slow
@pytest.mark.parametrize("digits", [None, 17])
@pytest.mark.parametrize("mapping", NEIGHBOURS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_touch_is_found(kind: str, mapping: str, digits: int | None) -> None:
    for seed in range(3 if kind == "ordinary" else 1):
        scene = KINDS[kind](random.Random(f"{kind} {mapping} {seed}"), mapping)
        assert_complete(followed(scene, digits), scene)


@pytest.mark.campaign
@pytest.mark.parametrize("digits", [None, 17])
@pytest.mark.parametrize("mapping", NEIGHBOURS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_touch_of_many_is_found(kind: str, mapping: str, digits: int | None) -> None:
    """Digits decide all of them; doubles nearly all, and never end before the end without saying so."""
    complete = 0
    for seed in range(100, 150):
        scene = KINDS[kind](random.Random(f"{kind} {mapping} {seed}"), mapping)
        trajectory = followed(scene, digits)
        assert_touches(trajectory, scene)
        found = (trajectory.status, len(trajectory.events))
        assert found == ("t_end", len(scene.times)) or (digits is None and found[0] == "undecidable"), scene
        complete += found[0] == "t_end"
    assert complete >= 48


@pytest.mark.quick(2)
@pytest.mark.parametrize(("t_end", "touches"), [(30, 4), (70, 11)])
@pytest.mark.parametrize(("c", "digits"), [(2, None), (6, None), (6, 17)])
def test_a_belt_that_is_touched_once_a_period(c: int, digits: int | None, t_end: int, touches: int) -> None:
    """x = 2/5 + sin t: each touch lies where the search that began at the one before ends."""
    p = Parameters(m=1, c=c, k=1, A0="1/5", B0=c, Omega=1, v1=-5, v2=1, mu1=0, mu2="1/5", FN=1)
    trajectory = simulate(p, t0=0, x0="2/5", v0=1, t_end=t_end, digits=digits)
    assert [event.kind for event in trajectory.events] == ["graze"] * touches
    assert [float(event.t) for event in trajectory.events] == pytest.approx(
        [6.283185307179586 * n for n in range(1, touches + 1)], rel=1e-13
    )
    assert trajectory.status == "t_end"


@pytest.mark.parametrize("mapping", ["P3", "P5"])
def test_both_belts_are_touched_in_turn(mapping: str) -> None:
    """With v1 = -v2 the steady motion touches belt 2 and, half a period later, belt 1."""
    scene = ordinary(random.Random(f"both {mapping}"), "P5")
    p, (first, second, third) = scene.p.replace(v1=-scene.p.v2), scene.times
    half = (second - first) / 2
    expected = [t for t in (first - half, first, first + half, second, second + half, third) if t > 1e-9]
    trajectory = simulate(p, t0=0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end - Fraction(half / 2))
    assert [float(event.t) for event in trajectory.events] == pytest.approx(expected, rel=1e-12)
    turns = [event.boundary for event in trajectory.events]
    assert {event.kind for event in trajectory.events} == {"graze"}
    assert all(a != b for a, b in pairwise(turns))


@pytest.mark.full(4)
@pytest.mark.quick(2)
@pytest.mark.parametrize("offset", OFFSETS)
def test_a_touch_where_two_searches_meet(offset: float) -> None:
    mapping = "P3" if offset >= 0 else "P5"
    scene = at_a_seam(random.Random(f"seam {mapping} {offset}"), mapping, offset)
    for digits in (None, 17):
        assert_complete(followed(scene, digits), scene)


@pytest.mark.campaign
@pytest.mark.parametrize("digits", [None, 17])
@pytest.mark.parametrize("mapping", NEIGHBOURS)
@pytest.mark.parametrize("offset", OFFSETS)
def test_many_touches_where_two_searches_meet(offset: float, mapping: str, digits: int | None) -> None:
    for seed in range(100, 110):
        scene = at_a_seam(random.Random(f"seam {mapping} {seed} {offset}"), mapping, offset)
        assert_complete(followed(scene, digits), scene)


# -- searches that fail ------------------------------------------------------------------------------------------------

LIMITS = [
    (first_exit, "MOST_STEPS", 1),
    (first_exit, "MOST_STEPS", 3),
    (first_exit, "MOST_STALLS", 0),
    (touches, "MOST_DESCENTS", 1),
    (touches, "MOST_DESCENTS", 2),
    (first_exit, "MOST_HALVINGS", 1),
    (gap_bounds, "MOST_NEWTON", 0),
    (stick_exit, "MOST_STICK_STEPS", 1),
]
ORDINARY = Parameters(m=1, c=1, k=1, A0=-15, B0=10, Omega=1, v1=1, v2=5, mu1="4/5", mu2="3/5", FN="9.81")


def assert_part_of(found: Any, right: Any) -> None:
    """A trajectory that could not go on shows the events before that; one that could shows them all."""
    for event, expected in zip(found.events, right.events, strict=False):
        assert (event.kind, event.source, event.target) == (expected.kind, expected.source, expected.target)
        assert abs(event.t - expected.t) < 1e-12 * max(1, expected.t)
    if found.status == "undecidable":
        assert len(found.events) <= len(right.events)
    else:
        assert (found.status, len(found.events)) == (right.status, len(right.events))


@pytest.mark.full(6)
@pytest.mark.slow
@pytest.mark.parametrize(("module", "name", "value"), LIMITS, ids=lambda item: str(getattr(item, "__name__", item)))
@pytest.mark.parametrize("mapping", ["P2", "P5"])
def test_a_search_that_fails_is_no_end(
    mapping: str, module: Any, name: str, value: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenes = [make(random.Random(f"failing {mapping}"), mapping) for make in (ordinary, undriven)]
    starts = [(scene.p, scene.x0, scene.v0, scene.t_end) for scene in scenes] + [(ORDINARY, 0, 0, 6)]
    right = [simulate(p, t0=0, x0=x0, v0=v0, t_end=t_end) for p, x0, v0, t_end in starts]
    monkeypatch.setattr(module, name, value)
    for (p, x0, v0, t_end), expected in zip(starts, right, strict=True):
        for digits in (None, 17):
            assert_part_of(simulate(p, t0=0, x0=x0, v0=v0, t_end=t_end, digits=digits), expected)


@pytest.mark.parametrize("mapping", NEIGHBOURS)
def test_a_minimum_that_is_not_found_is_no_end(mapping: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = ordinary(random.Random(f"no minimum {mapping}"), mapping)
    for module in (first_exit, touches):
        monkeypatch.setattr(module, "closest_approach", lambda tau, *_: (touches.LOST, tau))
    for digits in (None, 17):
        found = followed(scene, digits)
        assert (found.status, len(found.events)) == ("undecidable", 0)


@pytest.mark.parametrize("behind", [0.5, 1.5], ids=["before the end", "behind it"])
def test_only_a_contact_can_lie_behind_the_end(behind: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A search that gave up may have wandered anywhere: its time says nothing, and it is no end."""
    scene = undriven(random.Random(3), "P3")
    path = Motion(Start(scene.p, Fraction(0), scene.x0, scene.v0, scene.t_end))
    now = Flown(behind * float(scene.t_end), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    gave_up = FlightEnd(touches.STALLED, -1, now)
    monkeypatch.setattr(next_event, "first_exit", lambda *_: gave_up)
    path.step()
    assert (path.code, path.decided) == (next_event.FAILED, False)


@pytest.mark.parametrize("behind", [0.5, 1.5], ids=["before the end", "behind it"])
def test_a_stick_whose_end_is_not_found_is_no_end(behind: float, monkeypatch: pytest.MonkeyPatch) -> None:
    start = Start(ORDINARY, Fraction(0), Fraction(0), Fraction(1), Fraction(1))
    path = Motion(start)
    assert path.state.mode == 4
    gave_up = StickEnd(touches.STALLED, -1, behind, 0.0, 0.0, 0.0, 0.0, 1.0)
    monkeypatch.setattr(next_event, "belt_exit", lambda *_: gave_up)
    path.step()
    assert (path.code, path.decided) == (next_event.FAILED, False)


# -- contacts at the very end ------------------------------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [None, 20])
def test_a_crossing_exactly_at_the_end_is_not_in_doubt(digits: int | None) -> None:
    """v = v0 + A t meets belt 2 at a rational time, which is t_end: it counts or not, but nothing is undecided."""
    rng = random.Random(1)
    for _ in range(40):
        p = Parameters(
            m=Fraction(rng.randint(1, 30), 10), c=0, k=0, A0=Fraction(rng.randint(1, 30), 10), B0=0, Omega=1, v1=-100,
            v2=0, mu1=0, mu2="0.5", FN=10,
        )  # fmt: skip
        v0 = Fraction(rng.randint(-40, -1), 10)
        t = -v0 * p.m / p.A(2)
        found = simulate(p, t0=0, x0=0, v0=v0, t_end=t, digits=digits)
        assert found.status == "t_end"
        assert len(found.events) <= 1
        later = simulate(p, t0=0, x0=0, v0=v0, t_end=t + Fraction(1, 10**6), digits=digits)
        assert [float(event.t) for event in later.events] == pytest.approx([float(t)], rel=1e-14)


@pytest.mark.parametrize("name", ["fig5", "fig9", "fig10"])
def test_a_motion_may_end_at_any_of_its_events_as_doubles_have_them(name: str) -> None:
    """What is left then may be a little less than nothing."""
    for event in simulate(name, t_end=12).events:
        found = simulate(name, t_end=event.t)
        assert found.status == "t_end"
        assert len(found.events) <= len(simulate(name, t_end=event.t * (1 + 1e-12)).events)
