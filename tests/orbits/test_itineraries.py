"""Motions along known itineraries, against the engine's event search and its derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from law_orbits import STICK_SLIP, TWO_BANDS, driven

from symosc import Belt, Oscillator, find_orbit
from symosc.orbits.followed_orbit import FollowedOrbit
from symosc.orbits.itinerary import LawInDoubles, itinerary_of

ENTRAINED = Oscillator(
    m=1, c="1/10", k=1, B0="1/10", Omega="0.966",
    belts=[Belt("3/2", curve=[(0, 1), ("1/4", "4/5"), (1, "14/25"), (3, "1/2")])],
)  # fmt: skip
THREE = Oscillator(
    m=1, c="1/5", k=1, B0=3, Omega="7/10",
    belts=[Belt(-1, mu="1/5"), Belt(0, mu="1/4", mu_s="3/10"), Belt(1, mu="1/5", slope="1/20")],
)  # fmt: skip
CASES = [
    pytest.param(STICK_SLIP, {"v0": "1/5"}, id="cycle"),
    pytest.param(driven("1"), {}, id="driven"),
    pytest.param(TWO_BANDS, {"guess": (0, 1, 2)}, id="unstable"),
    pytest.param(ENTRAINED, {"x0": 2}, id="corners"),
    pytest.param(THREE, {}, id="three belts"),
]


@pytest.mark.parametrize(("law", "about"), CASES)
def test_they_end_where_the_engine_does(law: Oscillator, about: Any) -> None:
    orbit = find_orbit(law, **about)
    assert isinstance(orbit, FollowedOrbit)
    assert orbit.motion is not None
    section = orbit._section
    assert section is not None
    itinerary = itinerary_of(orbit.motion, section.upwards)
    t, x = float(orbit.motion.t_start), float(orbit.start[1]) + 1e-4
    own = itinerary.follow(LawInDoubles(law), t, x)
    passage = section.passage(t, x, float(orbit.period))
    assert own is not None
    assert passage is not None
    assert (own.end.t, own.end.x) == pytest.approx((passage.t, passage.x), abs=1e-12)
    assert own.changes == pytest.approx(passage.changes.astype(float), abs=1e-9)
    # On the orbit itself areas change like the determinant of the map.
    closed = itinerary.follow(LawInDoubles(law), t, x - 1e-4)
    assert closed is not None
    assert closed.growth == pytest.approx(float(np.linalg.det(closed.changes)), abs=1e-9)
