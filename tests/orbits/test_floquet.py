"""Multipliers: stable, marginal, and inside the unit circle."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import FIG9, FIG10, P32_MULTIPLIER

from symosc.orbits.find import find_orbit

P4645_MULTIPLIER = 1.9589682640e-4


def test_multipliers_of_the_paper_orbits():
    for digits in (None, 20):
        first, second = find_orbit(FIG9, "P32", digits=digits).multipliers
        assert abs(complex(first) - P32_MULTIPLIER) < 1e-14
        assert abs(complex(second) - P32_MULTIPLIER.conjugate()) < 1e-14
        first, second = find_orbit(FIG10, "P4645", digits=digits).multipliers
        assert abs(complex(first) - P4645_MULTIPLIER) < 1e-14
        assert second == 0


@pytest.mark.slow
def test_determinant_shrinks_by_damping_and_friction():
    """det M = exp(-(c/m) T) prod F(target)/F(source) < 1: no multipliers leave the unit circle as a pair."""
    rng = np.random.default_rng(7)
    for _ in range(15):
        p = FIG9.replace(Omega=round(rng.uniform(3.4, 4.9), 3), c=round(rng.uniform(0.05, 0.4), 3))
        orbit = find_orbit(p, "P32")
        determinant = (orbit.multipliers[0] * orbit.multipliers[1]).real
        ratio = np.exp(-float(p.c / p.m) * orbit.period)
        for (t, x), (source, target) in zip(orbit.points, ((2, 1), (1, 2)), strict=True):
            force = [
                float((p.A(alpha) - p.c * p.v1) / p.m)
                + float(p.B0 / p.m) * np.cos(float(p.Omega) * t)
                - float(p.k / p.m) * x
                for alpha in (source, target)
            ]
            ratio *= force[1] / force[0]
        assert determinant == pytest.approx(ratio, rel=1e-9)
        assert 0 < determinant < 1
        assert max(abs(value) for value in orbit.multipliers) < 1
