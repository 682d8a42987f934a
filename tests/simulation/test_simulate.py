"""The paper's scenes: double precision against references of 35 digits, grazes, and fig8's endless micro-sticks."""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from math import cos, pi
from pathlib import Path
from typing import Any

import mpmath
import pytest
from agreement import assert_agrees, assert_event_agrees
from oracle import OracleRun, simulate_oracle
from scipy.integrate import solve_ivp

from symosc import Parameters, load_scene, simulate

REFERENCE = Path(__file__).parents[1] / "reference"
TARGETS = {"1": "Omega1", "2": "Omega2", "3": "Omega3"}


def reference(name: str) -> list[tuple[Any, str, Any, Any]]:
    rows = json.loads((REFERENCE / f"{name}.json").read_text())
    with mpmath.workdps(40):
        return [(mpmath.mpf(t), kind, mpmath.mpf(x), mpmath.mpf(v)) for t, kind, x, v in rows]


@pytest.mark.parametrize(
    ("name", "count"), [("fig5", 16), ("fig7-corrected", 2), ("fig8", 22), ("fig10", 44)]
)
def test_every_event_of_the_references(name: str, count: int) -> None:
    expected = reference(name)
    scene = load_scene(name)
    assert len(expected) == count
    after = Fraction(str(expected[-1][0])) + Fraction(1, 10**6)
    trajectory = simulate(scene.parameters, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=after)
    assert trajectory.status == "t_end"
    assert len(trajectory.events) == count
    for event, (t, kind, x, v) in zip(trajectory.events, expected, strict=True):
        with mpmath.workdps(40):
            assert abs(mpmath.mpf(event.t) - t) <= 1e-12 * max(1, abs(t))
            assert abs(mpmath.mpf(event.x) - x) <= 1e-12 * max(1, abs(x))
            phase = mpmath.mpf(str(float(scene.parameters.Omega))) * t % (2 * mpmath.pi)
            assert abs(mpmath.mpf(event.theta) - phase) <= 1e-12 * t
        assert event.v == v
        if kind == "stick onset":
            assert (event.kind, event.target) == ("stick", f"belt{event.boundary}")
        else:
            assert (event.kind, event.target) == ("slip", TARGETS[kind[-1]])
            assert event.source == f"belt{event.boundary}"
        assert float(scene.parameters.belt(event.boundary)) == v


@pytest.mark.quick(4)
@pytest.mark.parametrize(
    "name", ["fig5", "fig6", "fig7", "fig7-corrected", "fig9", "fig9-orbit", "fig10", "fig10-orbit"]
)
def test_every_scene_to_its_end(name: str) -> None:
    scene = load_scene(name)
    trajectory = simulate(scene)
    assert trajectory.status == "t_end"
    # an orbit's start is known to 25 digits: with 28 the oracle, too, takes a force of 1e-24 there
    # for 0
    if name.endswith("orbit"):
        digits = 28
    else:
        digits = 50
    assert_agrees(
        trajectory,
        simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end, digits),
    )


@pytest.mark.parametrize("digits", [None, 40])
@pytest.mark.parametrize(
    ("name", "domain", "x"), [("fig7-exact", "Omega1", -0.5855), ("fig8-exact", "Omega2", 4.51425)]
)
def test_exact_starts_graze_and_do_not_stick(
    name: str, domain: str, x: float, digits: int | None
) -> None:
    scene = load_scene(name)
    trajectory = simulate(
        scene.parameters,
        t0=scene.t0,
        x0=scene.x0,
        v0=scene.v0,
        t_end=4,
        start_error=scene.start_error,
        digits=digits,
    )
    assert [event.kind for event in trajectory.events] == ["graze"]
    graze = trajectory.events[0]
    assert (graze.boundary, graze.source, graze.target) == (1, domain, domain)
    assert float(graze.t) == pytest.approx(pi, abs=1e-12)
    assert float(graze.x) == pytest.approx(x, abs=1e-12)
    assert graze.v == float(scene.parameters.v1)


# -- fig8 for many periods: sticks shrink by 3/8 each half period and belts are grazed in the limit --------------------


def end_of(periods: int) -> Fraction:
    """Return t0 + so many periods of pi."""
    return load_scene("fig8").t0 + periods * Fraction("3.1415926535897932")


@cache
def fig8_oracle(periods: int) -> OracleRun:
    scene = load_scene("fig8")
    return simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, end_of(periods), 150)


@pytest.mark.slow
@pytest.mark.parametrize("periods", [20, pytest.param(50, marks=pytest.mark.campaign)])
def test_fig8_in_doubles_has_all_events(periods: int) -> None:
    """Also where pairs, and 44 digits, do not decide a contact any more."""
    scene = load_scene("fig8")
    trajectory = simulate(scene, t_end=end_of(periods))
    assert trajectory.status == "t_end"
    for event, expected in zip(trajectory.events, fig8_oracle(periods).events, strict=True):
        assert_event_agrees(event, expected)
        assert abs(event.t - float(expected.t)) <= 2.0**-52 * event.t


@pytest.mark.slow
def test_fig8_goes_on_for_ever() -> None:
    """Each half period has its stick, 3/8 as long as the one before.

    Whatever digits it takes, none is a graze.
    """
    trajectory = simulate("fig8", t_end=450)
    assert trajectory.status == "t_end"
    late = [event for event in trajectory.events if event.t > 9]
    assert [event.kind for event in late] == ["stick", "slip"] * (len(late) // 2)
    halves = [round(event.t / (pi / 2)) for event in late if event.kind == "slip"]
    assert halves == list(range(6, int(450 / (pi / 2)) + 1))
    assert (
        max(abs(event.t - half * pi / 2) for event, half in zip(late[1::2], halves, strict=True))
        < 2e-3
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("periods", "events", "shortest"),
    [(20, 76, 3.308e-17), pytest.param(50, 196, 9.3e-43, marks=pytest.mark.campaign)],
)
def test_fig8_with_150_digits_shows_all_events(periods: int, events: int, shortest: float) -> None:
    scene = load_scene("fig8")
    trajectory = simulate(
        scene.parameters, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=end_of(periods), digits=150
    )
    assert trajectory.status == "t_end"
    assert len(trajectory.events) == events
    with mpmath.workdps(150):
        for event, expected in zip(trajectory.events, fig8_oracle(periods).events, strict=True):
            assert_event_agrees(event, expected, 1e-60)
        sticks = [end.t - onset.t for onset, end in zip(trajectory.events, trajectory.events[1:], strict=False)
                  if onset.kind == "stick"]  # fmt: skip
        assert len(sticks) == events // 2
        assert float(min(sticks)) == pytest.approx(shortest, rel=2e-3)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["fig5", "fig6", "fig9", "fig10"])
def test_forty_digits_are_forty_digits(name: str) -> None:
    scene = load_scene(name)
    trajectory = simulate(scene, digits=40)
    run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end, 70)
    assert_agrees(trajectory, run, 1e-39)


@pytest.mark.parametrize("digits", [None, 30])
def test_progress_tells_the_part_of_the_time_and_changes_nothing(digits: int | None) -> None:
    told: list[tuple[float, float]] = []
    # in doubles progress is told block by block
    if digits:
        t_end = 12
    else:
        t_end = 2000
    watched = simulate(
        "fig9", t_end=t_end, digits=digits, progress=lambda part, all: told.append((part, all))
    )
    assert watched.events == simulate("fig9", t_end=t_end, digits=digits).events
    parts = [part for part, all in told if all == 1.0]
    assert len(parts) == len(told) > 2
    assert parts == sorted(parts)
    assert (parts[0] < 0.2, parts[-1]) == (True, 1.0)
    told.clear()
    simulate(
        "fig9",
        t_end=1e6,
        max_events=4,
        digits=digits,
        progress=lambda part, all: told.append((part, all)),
    )
    assert [part for part, _ in told] == ([0.25, 0.5, 0.75, 1.0] if digits else [1.0])


def test_an_end_on_an_event_is_reached() -> None:
    """A flight after an event that is found a rounding past the end has a length below 0, and an error that is not."""
    p = Parameters(
        m=1, c=0, k=1, A0=0, B0="0.81", Omega="0.9", v1=0, v2=10, mu1=1, mu2=0, FN="0.25"
    )
    start = {"t0": 0.42055664276459315, "x0": 3.961409915233731, "v0": 0}
    motion = simulate(p, **start, t_end=7.401873650741911)
    assert [event.kind for event in motion.events] == ["cross", "cross"]
    assert all(0 < event.x_error < 1e-13 for event in motion.events)


def test_a_motion_goes_on_with_another_force_as_the_page_on_models_says() -> None:
    p = load_scene("fig5").parameters
    whole = simulate(p, t_end=9)
    t, x, v = 0, 0, 0
    events = []
    for t_end in (2, 5, 9):  # in flight, in a stick
        piece = simulate(p, t0=t, x0=x, v0=v, t_end=t_end)
        events += piece.events
        t = t_end
        x, v = piece(t)
    assert [event.kind for event in events] == [event.kind for event in whole.events]
    for event, other in zip(events, whole.events, strict=True):
        assert abs(event.t - other.t) < 1e-13
    # The flight after a step of the force, by another integrator.
    x, v = simulate(p, t_end=4)(4)
    piece = simulate(p.replace(A0=-11), t0=4, x0=x, v0=v, t_end=5)
    force = -11 + (float(p.mu1) + float(p.mu2)) * float(p.FN)

    def belt(t: float, y: Any) -> float:
        return float(y[1] - 1)

    belt.terminal = True  # type: ignore[attr-defined]
    flight = solve_ivp(
        lambda t, y: (y[1], force + 10 * cos(t) - y[1] - y[0]),
        (4, 5),
        (x, v),
        "DOP853",
        events=belt,
        rtol=1e-12,
        atol=1e-12,
    )
    assert abs(piece.events[0].t - flight.t[-1]) < 1e-9
