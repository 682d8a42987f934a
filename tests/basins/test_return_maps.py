"""Section maps against scipy, against known exponents, and against orbits found otherwise."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest
from stiction_solver import solved

from symosc import Belt, Oscillator, ParameterError, find_orbit, return_map, sensitivities
from symosc.basins.return_map import SlipMap

STICKY = Oscillator(
    m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.98")]
)
FREE = Oscillator(m=1, c="0.1", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
#: Chaos under cos(Omega t) on a belt at rest: mu, mu_s, Omega, exponent per slip.
CHAOS = [("0.1", "0.829", "0.58", 0.256), ("0.21", "0.7393", "0.43", 0.159)]


@pytest.mark.compiled("doubles")
def test_next_slips_are_those_of_scipy() -> None:
    law = SlipMap(STICKY, 1, None)
    phases = np.array([0.4, 1.6, 3.0, 5.5])
    exact = law.sample(phases, 1)
    for theta, after, span in zip(phases, exact.after, exact.span, strict=True):
        t = (theta - 0.3) / 1.4
        x = law.position(theta) - 0.1 * 0.3 / 1.4
        events = solved(STICKY, (t, x, 0.1), t + span + 1.0).events
        slips = [time for time, kind in events if kind == "slip"]
        assert slips[0] == pytest.approx(theta / 1.4, abs=1e-8)
        assert slips[1] - slips[0] == pytest.approx(span, abs=1e-7)
        assert abs((1.4 * slips[1] - after + pi) % (2 * pi) - pi) < 1e-7


@pytest.mark.compiled("doubles")
def test_fixed_points_are_orbits_and_their_slopes_multipliers() -> None:
    found = return_map(STICKY, points=96)
    points = found.fixed_points()
    assert len(points) == 2
    for point in points:
        t = point.at / 1.4
        orbit = find_orbit(STICKY, t0=t - 1e-6, x0=found._map.position(point.at) - 1e-7, v0="0.1")
        assert float(orbit.period) == pytest.approx(point.span, abs=1e-9)
        assert max(map(abs, orbit.multipliers)) == pytest.approx(abs(point.slope), abs=1e-6)
    assert np.allclose(found([point.at for point in points]), [point.at for point in points])


@pytest.mark.compiled("doubles")
def test_points_of_a_period_are_fixed_points_of_iterates() -> None:
    found = return_map(STICKY, points=96)
    twice = found.fixed_points(2)
    assert {round(point.at, 8) for point in found.fixed_points()} <= {
        round(point.at, 8) for point in twice
    }
    for point in twice:
        assert found(found(point.at)) == pytest.approx(point.at, abs=1e-7)
        assert found(point.at, n=2) == pytest.approx(point.at, abs=1e-7)


@pytest.mark.compiled("doubles")
@pytest.mark.parametrize(("mu", "mu_s", "Omega", "exponent"), CHAOS)
def test_chaos_has_the_exponent_that_is_known(
    mu: str, mu_s: str, Omega: str, exponent: float
) -> None:
    law = Oscillator(m=1, c=0, k=1, B0=1, Omega=Omega, belts=[Belt(0, mu=mu, mu_s=mu_s)])
    mean, error = return_map(law, points=8).exponent(1, n=1000)
    assert mean > 3 * error
    assert mean == pytest.approx(exponent, rel=0.2)


@pytest.mark.compiled("doubles")
def test_the_exponent_is_that_of_the_motion() -> None:
    found = return_map(STICKY.replace(mu_s1="0.77"), points=8)
    mean, _ = found.exponent(1, n=64)
    _, slip = found.orbit(1, 1)
    x = found._map.position(slip)
    s = sensitivities(
        STICKY.replace(mu_s1="0.77"), t0=slip / 1.4 - 1e-6, x0=x - 1e-7, t_end="60T", v0="0.1"
    )
    assert s.lyapunov[0] * 2 * pi / 1.4 == pytest.approx(mean, rel=0.02)


@pytest.mark.compiled("doubles")
def test_the_jump_is_where_a_flight_touches_the_belt() -> None:
    found = return_map(FREE, points=24)
    (jump,) = found.jumps
    assert found.at[0] > 0.5
    # On this side of it a flight of scipy misses the belt, beyond it it sticks.
    for x, sticks in ((jump.at - 1e-3, False), (jump.at + 1e-3, True)):
        kinds = {kind for _, kind in solved(FREE, (0.0, x, -1e-9), 8.0).events}
        assert ("stick" in kinds) == sticks
    (point,) = found.fixed_points()
    assert point.stable
    assert found(jump.at + 0.01) == pytest.approx(point.at)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"belt": 2}, "belt"),
        ({"points": 3}, "points"),
        ({"over": (2, 1)}, "over"),
        ({"what": FREE, "belt": 1}, "omitted without a drive"),
        ({"what": STICKY.replace(mu1=0, mu_s1=0)}, "no belt has friction"),
    ],
)
def test_wrong_arguments_are_named(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        return_map(**{"what": STICKY} | changes)
