"""What an orbit must satisfy, and where it does not."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from paper_orbits import FIG9, FIG10

from symosc.orbits import admissibility
from symosc.orbits.admissibility import conditions
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.find import find_orbit
from symosc.words import read_word


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


@pytest.mark.parametrize("forces", [(0.3, 4.0, -7.0), (9.0, 0.2, 1.0), (0.1, -8.0, 0.5)])
def test_sizes_bound_all_terms_of_the_equation(forces: tuple[float, ...]) -> None:
    """Whatever domain the orbit is in: the sum of the sizes of the terms of its acceleration."""
    equations = ClosingEquations(FIG9, read_word("P32"), 1)
    equations.K = equations.K._replace(A1=forces[0], A2=forces[1], A3=forces[2])
    K, points = equations.K, [(4.0, 1.0), (-4.5, 3.0)]
    found = admissibility.scales(equations, points)
    speeds = [abs(equations.belt(piece.start).v) for piece in equations.pieces]
    terms = max(map(abs, forces)) + abs(K.f0) + K.cm * max(speeds) + K.w0sq * 4.5
    assert found.a == pytest.approx(terms, rel=1e-12)
    assert found.v == pytest.approx(terms / K.rate + max(speeds), rel=1e-12)
    assert found.t == 1 / K.rate


def test_the_nearest_graze_counts_all_flights(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least gap, of whichever flight: a smaller one elsewhere is not hidden by a larger one."""
    orbit = find_orbit(FIG9, "P32")
    equations = ClosingEquations(FIG9, read_word("P32"), 1)
    points = np.array([(point.x, float(FIG9.Omega) * point.t) for point in orbit.points])
    far = admissibility.grazing_distance(equations, points)
    gaps = [c.value for c in conditions(equations, points) if "stays in" in c.text]
    assert 0 < far <= min(gaps)
    for values in ((1e-9, 5.0), (5.0, 1e-9), (1e-9, 1e-3)):
        said = [SimpleNamespace(text="P3 stays in Omega2", value=value) for value in values]
        monkeypatch.setattr(admissibility, "conditions", lambda equations, points, said=said: said)
        assert admissibility.grazing_distance(equations, points) == 1e-9
