"""Curves between the orbits of a branch."""

from __future__ import annotations

import numpy as np
import pytest

from symosc import continue_orbit, find_orbit, load_scene
from symosc.plot.figures import multiplier_curves

FIG9 = load_scene("fig9").parameters


@pytest.mark.slow
def test_multipliers_between_the_orbits_are_those_of_orbits_there() -> None:
    branch = continue_orbit(FIG9, "P32", "Omega", (3, 5))
    values, sizes = multiplier_curves(branch.values, branch.multipliers)
    assert len(values) > 8 * len(branch.values)
    for i in np.random.default_rng(2).choice(len(values), 8, replace=False):
        orbit = find_orbit(FIG9.replace(Omega=float(values[i])), "P32")
        exact = sorted((abs(item) for item in orbit.multipliers), reverse=True)
        assert sizes[i] == pytest.approx(exact, abs=2e-3)
    assert sizes[0] == pytest.approx(np.sort(np.abs(branch.multipliers[0]))[::-1], abs=1e-9)
