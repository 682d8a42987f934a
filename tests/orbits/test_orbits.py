"""Periodic orbits: the paper's against 50 digits and the oracle, other words, equations, multipliers and states."""

from __future__ import annotations

import cmath
import pickle
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from oracle import simulate_oracle
from paper_orbits import BOTH_BELTS, FIG9, FIG10, P32, P32_MULTIPLIER, P6454
from parameter_sets import MANY_SLIPS

from symosc.orbits.closing_equations import ClosingEquations, ConvergenceError, newton
from symosc.orbits.find import find_orbit
from symosc.orbits.floquet import multipliers
from symosc.words import read_word

CROSSING_BOTH = FIG9.replace(Omega="5.1")
PAPER = [(FIG9, "P32", P32), (FIG10, "P4645", P6454)]


@pytest.mark.parametrize(("p", "word", "points"), PAPER)
def test_paper_orbits_with_digits(p, word, points):
    orbit = find_orbit(p, word, digits=20)
    with mpmath.workdps(40):
        for (t, x), (t_known, x_known) in zip(orbit.points, points, strict=True):
            assert abs(mpmath.mpf(t) - mpmath.mpf(t_known)) < 1e-18 * abs(mpmath.mpf(t_known))
            assert abs(mpmath.mpf(x) - mpmath.mpf(x_known)) < 1e-18 * abs(mpmath.mpf(x_known))
    assert orbit.residual < 1e-30


def exact(value) -> Fraction:
    """Return an mpmath number as the Fraction that it is."""
    sign, mantissa, exponent, _ = value._mpf_
    return (-1) ** sign * int(mantissa) * Fraction(2) ** int(exponent)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("p", "word"),
    [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748"), (CROSSING_BOTH, "P7482")],
)
def test_oracle_returns_to_the_orbit_and_has_its_multipliers(p, word):
    """The ODE alone, 50 digits: one period later the same state.

    The return map's differences have the multipliers.
    """
    orbit = find_orbit(p, word, digits=45)
    assert orbit.admissible
    with mpmath.workdps(60):
        # Start inside a flight, so that a push of the state stays a push of the state.
        i = next(i for i, piece in enumerate(orbit.equations().pieces) if not piece.sticks)
        (t, _) = orbit.points[i]
        following = (*orbit.points[1:], (orbit.points[0][0] + orbit.period, None))[i][0]
        middle = (float(t) + float(following)) / 2
        t0 = exact(mpmath.mpf(middle))
        before = orbit.equations().pieces[i - 1]
        if before.sticks:
            start = orbit.points[i - 1]
        else:
            start = orbit.points[i]
        begin = exact(start[0])
        v = p.belt((before if before.sticks else orbit.equations().pieces[i]).start)
        if before.sticks and i == 0:
            t0 += exact(orbit.period)
        here = simulate_oracle(p, begin, exact(start[1]), v, t0, 50)
        x0 = exact(here.x)
        v0 = exact(here.v)
        h = Fraction(1, 10**18)
        after = t0 + exact(orbit.period)
        back = simulate_oracle(p, t0, x0, v0, after, 50)
        assert abs(back.x - here.x) + abs(back.v - here.v) < 1e-30
        assert len(back.events) == len(orbit.labels)
        M = mpmath.matrix(2)
        for column, (dx, dv) in enumerate(((h, 0), (0, h))):
            plus = simulate_oracle(p, t0, x0 + dx, v0 + dv, after, 50)
            minus = simulate_oracle(p, t0, x0 - dx, v0 - dv, after, 50)
            M[0, column] = (plus.x - minus.x) / (2 * mpmath.mpf(h.numerator) / h.denominator)
            M[1, column] = (plus.v - minus.v) / (2 * mpmath.mpf(h.numerator) / h.denominator)
        trace = M[0, 0] + M[1, 1]
        determinant = M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0]
    ours = [complex(value) for value in orbit.multipliers]
    assert abs(sum(ours) - complex(trace)) < 1e-12
    assert abs(ours[0] * ours[1] - complex(determinant)) < 1e-12


def test_no_convergence_carries_the_best_points():
    with pytest.raises(ConvergenceError, match="the motion settles to P6454") as caught:
        find_orbit(FIG10, "P32", [(0.2, 4.0), (1.0, -4.0)])
    error = caught.value
    assert len(error.best) == 2
    assert np.isfinite(np.array(error.best, dtype=float)).all()
    assert error.residual > 0
    assert error.periods == 1
    copy = pickle.loads(pickle.dumps(error))
    assert (copy.word, copy.best, copy.residual) == (error.word, error.best, error.residual)


def test_a_search_that_fails_returns_its_best_points_with_their_residual() -> None:
    rng = np.random.default_rng(3)
    reasons = set()
    equations = ClosingEquations(CROSSING_BOTH, read_word("P7482"), 1)
    for _ in range(25):
        guess = np.column_stack([rng.uniform(-6, 6, 4), np.sort(rng.uniform(0, 6.2, 4))])
        with np.errstate(all="ignore"):
            solution = newton(equations, guess)
            if not solution.converged:
                reasons.add(solution.reason)
                assert solution.residual == pytest.approx(
                    np.abs(equations.residuals(solution.points)).max()
                )
    assert "not converged after 60 steps" in reasons


@pytest.mark.slow
def test_determinant_shrinks_by_damping_and_friction():
    """det M = exp(-(c/m) T) prod F(target)/F(source) < 1.

    No multipliers leave the unit circle as a pair.
    """
    rng = np.random.default_rng(7)
    for _ in range(2):
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
    """Of random matrices, also of such with a tiny determinant.

    Both to all digits, the larger one first.
    """
    rng = np.random.default_rng(5)
    for _ in range(300):
        if rng.random() < 0.3:
            size = rng.uniform(0, 1.1)
            angle = rng.uniform(0, np.pi)
            trace = 2 * size * np.cos(angle)
            determinant = size * size
            large = size
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


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (MANY_SLIPS, "P174648")])
def test_jacobian_matches_differences_of_its_residuals(p, word):
    orbit = find_orbit(p, word, digits=15)
    points = [
        (x, t * orbit.period.context.mpf(p.Omega.numerator) / p.Omega.denominator)
        for t, x in orbit.points
    ]
    exact_ = ClosingEquations(p, read_word(word), 1, 40)
    context = exact_.arithmetic.context
    # Off the orbit, where the residuals do not vanish.
    points = [
        (context.mpf(x) + context.mpf("0.01") * i, context.mpf(theta) + context.mpf("0.01"))
        for i, (x, theta) in enumerate(points)
    ]
    ours = ClosingEquations(p, read_word(word), 1).matrix(
        [(float(x), float(theta)) for x, theta in points]
    )
    h = context.mpf("1e-15")
    for column in range(2 * len(points)):
        sides = []
        for sign in (1, -1):
            moved = [list(point) for point in points]
            moved[column // 2][column % 2] += sign * h
            sides.append(exact_.residuals(moved))
        differences = np.array([float((a - b) / (2 * h)) for a, b in zip(*sides, strict=True)])
        assert np.abs(ours[:, column] - differences).max() < 1e-11 * max(
            1, np.abs(differences).max()
        )


@pytest.mark.parametrize(("p", "word", "points"), PAPER)
def test_paper_orbits_in_double_precision(p, word, points):
    orbit = find_orbit(p, word)
    assert np.abs(np.array(orbit.points) - np.array(points, dtype=float)).max() < 1e-12
    assert orbit.word == str(read_word(word).cycle)
    assert orbit.admissible
    assert orbit.stable
    assert orbit.failures == ()
    assert orbit.residual < 1e-12
    assert orbit.periods == 1
    assert orbit.period == pytest.approx(2 * np.pi / float(p.Omega), rel=1e-15)


P4645_MULTIPLIER = 1.9589682640e-4


def test_multipliers_of_the_paper_orbits():
    for digits in (None, 20):
        first, second = find_orbit(FIG9, "P32", digits=digits).multipliers
        assert abs(complex(first) - P32_MULTIPLIER) < 1e-14
        assert abs(complex(second) - P32_MULTIPLIER.conjugate()) < 1e-14
        first, second = find_orbit(FIG10, "P4645", digits=digits).multipliers
        assert abs(complex(first) - P4645_MULTIPLIER) < 1e-14
        assert second == 0
