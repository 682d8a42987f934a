"""What simulate does where doubles, or the digits asked for, are not enough.

And that all this stays bounded work.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Any

import pytest
from agreement import BASE, assert_agrees
from aimed import aimed, text
from oracle import simulate_oracle

from symosc import Parameters, load_scene, simulate
from symosc.engine.start import Start
from symosc.simulation import motion
from symosc.simulation.motion import Motion, digits_to_confirm_graze

pytestmark = pytest.mark.usefixtures("interpreted")


def test_more_digits_take_over_and_doubles_go_on() -> None:
    """Events that doubles know to less than the accuracy asked for come from more digits, right to half a unit."""
    scene = load_scene("fig8")
    plain = simulate(scene, accuracy=math.inf)
    finer = simulate(scene)
    exact = simulate(scene, digits=30)
    assert max(event.x_error / max(1, abs(event.x)) for event in plain.events) > 1e-13
    for event, right in zip(finer.events, exact.events, strict=True):
        assert event.t_error <= 1e-13 * max(1.0, event.t)
        assert event.x_error <= 1e-13 * max(1.0, abs(event.x))
        assert abs(float(event.t - right.t)) <= 2.0**-52 * event.t
        assert abs(float(event.x - right.x)) <= 2.0**-52 * abs(event.x)
    assert simulate(scene, accuracy=1e-6).events == plain.events


def limit(places: int) -> Parameters:
    """Return parameters without a spring.

    V tends to a speed 10**-places above that of belt 1, and meets it before.
    """
    return Parameters(
        m=1, c=1, k=0, A0=f"-0.{'9' * places}", B0=0, Omega=1, v1=1, v2=5, mu1="0.5", mu2="0.5", FN=2
    )  # fmt: skip


@pytest.mark.parametrize("places", [40, 401])
def test_a_belt_just_below_the_limit_is_met(places: int) -> None:
    """At t = 92 and 923; 1e-401 is nearer than the least double."""
    (event,) = simulate(limit(places), t_end=1000).events
    assert event.kind == "stick"
    assert event.t == pytest.approx(places * math.log(10), rel=1e-14)


def test_a_contact_that_stays_open_ends_the_motion_and_says_what_to_ask_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(motion, "MOST_FAST", 60)
    computed = simulate(limit(150), t_end=400)
    assert (computed.status, list(computed.events)) == ("undecidable", [])
    near, digits, advice = re.findall(
        r"near t = (\S+) cannot be decided with (\d+) digits; .*digits=(\d+)", computed.message
    )[0]
    assert 40 < computed.t_end == float(near) < 150 * math.log(10)
    assert int(advice) == 2 * int(digits)
    (event,) = simulate(limit(150), t_end=400, digits=int(advice)).events
    assert float(event.t) == pytest.approx(150 * math.log(10), rel=1e-9)


@pytest.mark.slow
def test_more_digits_than_anybody_waits_for_are_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """All events before are right, and the message says where more digits would go on."""
    monkeypatch.setattr(motion, "MOST_GRAZE", 60)
    computed = simulate("fig8", t_end=160)
    whole = simulate("fig8", t_end=160, digits=150)
    assert (computed.status, whole.status) == ("undecidable", "t_end")
    assert 140 < computed.t_end < 160
    assert "with 87 digits" in computed.message
    for event, right in zip(computed.events, whole.events, strict=False):
        assert (event.kind, event.target, event.t, event.x) == (
            right.kind,
            right.target,
            float(right.t),
            float(right.x),
        )


@pytest.mark.slow
def test_digits_are_raised_until_events_are_known_to_them() -> None:
    scene = load_scene("fig8")
    motion = simulate(scene, t_end=50, digits=20)
    run = simulate_oracle(scene.parameters, scene.t0, scene.x0, scene.v0, 50, 70)
    assert_agrees(motion, run, 1e-19)
    assert max(event.t_error / event.t for event in motion.events) < 1e-19


def test_how_many_digits_a_graze_takes() -> None:
    """Gaps shrink like exp(-rate t).

    E^-(h t) without oscillation of the roots, else by the fast root, or the slow.
    """

    def followed(**changes: Any) -> Motion:
        return Motion(
            Start(BASE.replace(m=1, **changes), Fraction(0), Fraction(0), Fraction(0), Fraction(1)),
            20,
        )

    # roots -1 +- 2i; -1, -4
    under = followed(c=2, k=5)
    over = followed(c=5, k=4)
    ten = math.log(10)
    spare = motion.GRAZE_SPARE
    assert digits_to_confirm_graze(under, 0, 40) == 3 * 40
    assert digits_to_confirm_graze(under, 200 * ten, 40) == 40 + spare + 200
    assert digits_to_confirm_graze(over, 100 * ten, 40) == 40 + spare + 400
    assert digits_to_confirm_graze(over, 300 * ten, 40) == 40 + spare + motion.MOST_FAST
    assert digits_to_confirm_graze(over, 1000 * ten, 40) == 40 + spare + 1000
    assert digits_to_confirm_graze(over, 3000 * ten, 40) is None
    assert digits_to_confirm_graze(over, 0, 2000) == 6000
    # On the steady motion no share of the transient could have shrunk; beside it as many digits as
    # that has lost.
    p = Parameters(
        m=1, c=2, k=1, A0="1/5", B0=2, Omega=1, v1=-5, v2=1, mu1=0, mu2="1/5", FN=1
    )  # x = 2/5 + sin t
    elapsed = 1000 * float(p.m / p.c)
    for push, few in ((Fraction(0), True), (Fraction(1, 10**30), False)):
        first = Motion(Start(p, Fraction(0), Fraction(2, 5) + push, Fraction(1), Fraction(9)), 40)
        assert (digits_to_confirm_graze(first, elapsed, 40) == 3 * 40) is few


def test_grazes_of_a_motion_that_repeats_are_grazes_in_doubles_too() -> None:
    """Without spring and damper v comes back to a belt each period, exactly.

    A slip that is off by 1e-44 would not.
    """
    p = Parameters(
        m="0.38", c=0, k=0, A0="-2.3594", B0="1.3177944", Omega="7.8", v1="-1.2746", v2="1.94459999992", mu1=0,
        mu2="0.47", FN="5.02",
    )  # fmt: skip
    for digits in (None, 20):
        motion = simulate(p, x0="-2.857", v0="1.5", t_end="6.1647", digits=digits)
        assert [event.kind for event in motion.events] == ["stick", "slip", *["graze"] * 7]


def test_a_graze_is_decided_by_what_is_behind_the_digits() -> None:
    """A near miss of 1e-33 is more than pairs tell with certainty.

    More digits do: no guess in between.
    """
    a = aimed("near miss", "P5", Fraction(-1, 10**33))
    kinds = {}
    for digits in (None, 20, 40):
        motion = simulate(
            a.p,
            t0=a.t0,
            x0=text(a.x0, 80),
            v0=text(a.v0, 80),
            t_end=a.t_m + Fraction(1, 20),
            digits=digits,
        )
        kinds[digits] = (motion.status, [event.kind for event in motion.events])
    assert kinds[20] == kinds[40] == ("t_end", [])
    assert kinds[None] in (("t_end", []), ("undecidable", []))
