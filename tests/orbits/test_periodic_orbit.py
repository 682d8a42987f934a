"""A periodic orbit as a motion: its states, many periods, its dictionary."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import BOTH_BELTS, FIG9, FIG10, P32_MULTIPLIER

from symosc.orbits.find import find_orbit

# Sticks on both belts; found by simulating random parameters.


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748")])
def test_states_of_the_orbit(p, word):
    """The orbit as a function of time: continuous at switchings, periodic, on the belts where it must be."""
    orbit = find_orbit(p, word)
    T = orbit.period
    times = np.linspace(-T, 2 * T, 100)
    assert np.abs(orbit(times) - orbit(times + 3 * T)).max() < 1e-11
    assert orbit(0.3).shape == (2,)
    for piece, (t, x) in zip(orbit.equations().pieces, orbit.points, strict=True):
        for state in (orbit(t - 1e-12), orbit(t + 1e-12)):
            assert state == pytest.approx([x, float(p.belt(piece.start))], abs=1e-8)


@pytest.mark.slow
def test_more_than_one_period():
    """Two periods of P32 are an orbit of P3232; with damping there is no other (symosc.orbits.floquet)."""
    orbit = find_orbit(FIG9, "P3232", periods=2)
    assert orbit.admissible
    assert orbit.periods == 2
    assert "runs 2 times" in orbit.message
    assert orbit.period == pytest.approx(2 * find_orbit(FIG9, "P32").period, rel=1e-15)
    for value in orbit.multipliers:
        assert min(abs(value - P32_MULTIPLIER**2), abs(value - P32_MULTIPLIER.conjugate() ** 2)) < 1e-14
    root = find_orbit(FIG9, "P32", periods=3)  # closes after three periods, but passes its belt on the way
    assert root.residual < 1e-11
    assert root.periods == 3
    assert not root.admissible
    assert any("stays in Omega1" in condition.text for condition in root.failures)


@pytest.mark.slow
def test_as_dict_is_plain():
    import json

    data = json.loads(json.dumps(find_orbit(FIG10, "P4645", digits=20).as_dict()))
    assert data["points"][0]["t"].startswith("0.44364498555745564947")
    assert data["stable"] is True
    data = json.loads(json.dumps(find_orbit(FIG9.replace(Omega=3), "P32").as_dict()))
    assert data["admissible"] is False
    assert data["failures"][0]["event"] == "birth of a stick"
