"""The equations that close an orbit, and their derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import BOTH_BELTS, FIG9, FIG10

from symosc import Parameters
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.find import find_orbit
from symosc.words import read_word

# Sticks on both belts; found by simulating random parameters.

MANY_SLIPS = Parameters(
    m=1, c="0.26", k="4.04", A0="3.53", B0="10.37", Omega="1.44", v1="-2.02", v2="1.02", mu1="0.68", mu2="0.71", FN=10
)


@pytest.mark.parametrize(
    ("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748"), (MANY_SLIPS, "P174648")]
)
def test_jacobian_matches_differences_of_its_residuals(p, word):
    orbit = find_orbit(p, word, digits=15)
    points = [(x, t * orbit.period.context.mpf(p.Omega.numerator) / p.Omega.denominator) for t, x in orbit.points]
    exact_ = ClosingEquations(p, read_word(word), 1, 40)
    context = exact_.arithmetic.context
    # Off the orbit, where the residuals do not vanish.
    points = [
        (context.mpf(x) + context.mpf("0.01") * i, context.mpf(theta) + context.mpf("0.01"))
        for i, (x, theta) in enumerate(points)
    ]
    ours = ClosingEquations(p, read_word(word), 1).matrix([(float(x), float(theta)) for x, theta in points])
    h = context.mpf("1e-15")
    for column in range(2 * len(points)):
        sides = []
        for sign in (1, -1):
            moved = [list(point) for point in points]
            moved[column // 2][column % 2] += sign * h
            sides.append(exact_.residuals(moved))
        differences = np.array([float((a - b) / (2 * h)) for a, b in zip(*sides, strict=True)])
        assert np.abs(ours[:, column] - differences).max() < 1e-11 * max(1, np.abs(differences).max())
