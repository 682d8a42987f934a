"""What an orbit must satisfy, and where it does not."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import FIG9, FIG10

from symosc.orbits.admissibility import conditions
from symosc.orbits.find import find_orbit


def test_root_that_is_no_orbit_is_reported_with_where_and_by_how_much():
    """Below Omega = 3.2886 both crossings of P32 are stick conditions; the force says so by itself."""
    p = FIG9.replace(Omega=3)
    root = find_orbit(p, "P32")
    assert root.residual < 1e-11
    assert not root.admissible
    assert "settles to P1312" in root.message
    crossing = next(c for c in root.failures if "P3 crosses v1" in c.text)
    x, cosine = root.points[0].x, np.cos(float(p.Omega) * root.points[0].t)
    F1 = float((p.A(1) - p.c * p.v1) / p.m) + float(p.B0 / p.m) * cosine - float(p.k / p.m) * x
    assert F1 > 0  # Theorem 5 needs F^(1) < 0 for a downward crossing
    assert -crossing.value == pytest.approx(F1, rel=1e-10)
    assert crossing.t == pytest.approx(root.points[0].t + root.period, rel=1e-10)
    gap = next(c for c in root.failures if "P2 stays in Omega1" in c.text)
    assert root(gap.t)[1] == pytest.approx(float(p.v1) - gap.value, abs=1e-9)  # how far above v1 it gets


def test_conditions_come_in_the_same_order():
    orbit = find_orbit(FIG10, "P4645")
    texts = [c.text for c in orbit.conditions()]
    moved = orbit.phases() + np.array([0.0, 1e-3])
    assert texts == [c.text for c in conditions(orbit.equations(), moved)]
    assert all(c.value > 0 for c in orbit.conditions())
