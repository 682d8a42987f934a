"""The equations that close an orbit, and their derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import BOTH_BELTS, FIG9, FIG10

from symosc import Parameters
from symosc.mappings.equations import residual
from symosc.orbits.closing_equations import ClosingEquations, OrbitPiece
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


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645")])
def test_the_largest_residual_is_that_of_all_maps(p: Parameters, word: str) -> None:
    """Of eq. (54), as `symosc.residual` has it, in x and v of every map, off the orbit."""
    rng = np.random.default_rng(4)
    equations = ClosingEquations(p, read_word(word), 1)
    on_it = find_orbit(p, word).phases()
    for _ in range(5):
        points = on_it + rng.uniform(-0.02, 0.02, (len(word) - 1, 2))
        ends = [*points[1:], points[0] + [0.0, 2 * np.pi]]
        each = [
            residual(p, label, tuple(start), tuple(end), exit_of(piece))
            for label, piece, start, end in zip(equations.word.labels, equations.pieces, points, ends, strict=True)
        ]
        assert equations.largest_residual(points) == pytest.approx(np.abs(each).max(), rel=1e-9)


def exit_of(piece: OrbitPiece) -> str | None:
    return None if not piece.sticks else "below" if piece.side < 0 else "above"
