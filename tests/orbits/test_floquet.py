"""Multipliers: stable, marginal, and inside the unit circle."""

from __future__ import annotations

import cmath

import numpy as np
import pytest
from paper_orbits import FIG9, FIG10, P32_MULTIPLIER

from symosc.orbits import floquet
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.find import find_orbit
from symosc.orbits.floquet import multipliers
from symosc.orbits.newton import Solution
from symosc.words import read_word

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


def test_multipliers_are_the_eigenvalues() -> None:
    """Of random matrices, also of such with a tiny determinant: both to all digits, the larger one first."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        if rng.random() < 0.3:
            size, angle = rng.uniform(0, 1.1), rng.uniform(0, np.pi)
            trace, determinant, large = 2 * size * np.cos(angle), size * size, size
            first, second = multipliers(trace, determinant, cmath.sqrt)
            assert (first * second).real == pytest.approx(determinant)
            assert abs(first) == pytest.approx(large)
            assert second == pytest.approx(np.conj(first)) or abs(np.sin(angle)) < 1e-6
            continue
        large = rng.choice([-1, 1]) * rng.uniform(0, 1.1)
        small = rng.choice([-1, 1]) * abs(large) * rng.choice([0.0, 1e-30, 1e-9, 0.5, 0.999])
        first, second = multipliers(large + small, large * small, cmath.sqrt)
        assert complex(first) == pytest.approx(large, rel=1e-12)
        assert complex(second) == pytest.approx(small, rel=1e-12, abs=0)
    assert multipliers(0.0, 0.0, cmath.sqrt) == (0, 0)


@pytest.mark.parametrize(
    ("gap", "fine", "converged", "found"),
    [
        (0.3, None, None, 0.3), (-0.2, None, None, -0.2), (2e-9, None, None, 2e-9), (-2e-9, None, None, -2e-9),
        (1e-12, "3e-12", True, 3e-12), (-1e-12, "-3e-12", True, -3e-12), (1e-12, "1e-20", True, 1e-20),
        (0.0, "2e-25", True, 2e-25), (1e-12, "1e-26", True, None), (0.0, "-1e-26", True, None),
        (0.0, "0.5", False, None),
    ],
)  # fmt: skip
def test_a_multiplier_near_the_circle_is_computed_again(
    gap: float, fine: str | None, converged: bool | None, found: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With 50 digits, whose verdict counts: on it to 25 digits, or where no isolated root is found."""
    equations, asked = ClosingEquations(FIG9, read_word("P32"), 1), []

    def polished(finer: ClosingEquations, points: object) -> Solution:
        asked.append(finer.arithmetic.context.dps)
        return Solution(points, 0.0, 1, bool(converged), "")

    def flow(finer: ClosingEquations, points: object) -> floquet.Monodromy:
        assert fine is not None
        large = 1 - finer.exact(fine)
        return floquet.Monodromy(((0, 0), (0, 0)), large, 0 * large)

    monkeypatch.setattr(floquet, "polish", polished)
    monkeypatch.setattr(floquet, "monodromy", flow)
    assert floquet.inside(equations, [(0, 0)], (complex(0, 1 - gap), 0.5)) == (found and pytest.approx(found, rel=1e-6))
    assert [dps >= 50 for dps in asked] == [True] * (fine is not None)
