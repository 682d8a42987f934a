"""Closed forms of the oscillator with Coulomb friction, against a matrix exponential that knows none of them."""

from __future__ import annotations

import random

import mpmath
import pytest
import sympy as sp

from symosc.symbolic import coulomb, solution
from symosc.symbolic.solution import E0, E1, E2, Omega, cm, w0sq

mp = mpmath.MPContext()
mp.dps = 30


def random_systems(count: int, seed: int) -> list[tuple]:
    """Return random (cm, w0sq, Omega) of all damping regimes."""
    dice = random.Random(seed)
    rows = [
        (dice.choice((0, dice.uniform(0, 0.5), dice.uniform(0, 4))), dice.uniform(0.2, 5))
        for _ in range(count)
    ]
    return [(mp.mpf(c), mp.mpf(w), mp.mpf(dice.uniform(0.2, 4))) for c, w in rows]


def free_motion(c, w, time):
    """Return the matrix that takes (x, v) of a free motion through a time."""
    return mp.expm(mp.matrix([[0, 1], [-w, -c]]) * time)


def basis(c, w, time):
    """Return E0, E1, E2: the last one is the response to a constant force of 1."""
    matrix = free_motion(c, w, time)
    return {E0: matrix[1, 1], E1: matrix[0, 1], E2: (1 - matrix[0, 0]) / w, cm: c, w0sq: w}


def value(expr, letters):
    """Return an expression as a number."""
    return mp.mpf(sp.N(sp.sympify(expr).subs(letters), 30)._to_mpmath(mp.prec))


def as_floats(letters):
    return {letter: sp.Float(str(number), 30) for letter, number in letters.items()}


def test_transition_is_the_free_motion() -> None:
    for c, w, _ in random_systems(3, 1):
        letters = as_floats(basis(c, w, mp.mpf("0.7")))
        matrix = free_motion(c, w, mp.mpf("0.7"))
        for i in range(2):
            for j in range(2):
                assert abs(value(coulomb.transition()[i, j], letters) - matrix[i, j]) < 1e-24


@pytest.mark.slow
def test_half_a_period_takes_the_highest_point_to_the_lowest() -> None:
    """With the steady part that symmetry gives, the motion from (x_0, 0) ends at (-x_0, 0)."""
    for c, w, turn in random_systems(6, 2):
        half = mp.pi / turn
        letters = as_floats(basis(c, w, half) | {Omega: turn})
        G, H = (value(part, letters) for part in coulomb.half_period())
        x_f = mp.mpf("0.3")
        x_0 = mp.mpf("1.7")
        p = x_0 + G * x_f
        q = H * x_f
        end = free_motion(c, w, half) * mp.matrix([x_0 - p - x_f, -turn * q])
        assert abs(end[0] + x_f - p + x_0) < 1e-20
        assert abs(end[1] - turn * q) < 1e-20


@pytest.mark.slow
def test_velocity_and_its_bound() -> None:
    """On p_0 = B x_f the velocity is 0 at that angle; a little above it the mass moves down."""
    for c, w, turn in random_systems(4, 3):
        half = as_floats(basis(c, w, mp.pi / turn) | {Omega: turn})
        G, H = (value(part, half) for part in coulomb.half_period())
        for angle in (mp.mpf("0.4"), mp.mpf("2.4")):
            here = basis(c, w, angle / turn) | {
                Omega: turn,
                coulomb.G: G,
                coulomb.H: H,
                coulomb.phi: angle,
            }
            B = value(coulomb.slide_function(), as_floats(here))
            x_f = mp.mpf("0.3")
            for above in (0, mp.mpf("0.01")):
                p = (B + above) * x_f
                q = H * x_f
                free = free_motion(c, w, angle / turn) * mp.matrix([-G * x_f - x_f, -turn * q])
                rate = free[1] / turn - p * mp.sin(angle) + q * mp.cos(angle)
                assert abs(rate) < 1e-20 if not above else rate < 0


@pytest.mark.slow
def test_limit_of_the_bound_at_the_turning_point() -> None:
    for c, w, turn in random_systems(6, 4):
        half = as_floats(basis(c, w, mp.pi / turn) | {Omega: turn})
        G, H = (value(part, half) for part in coulomb.half_period())
        angle = mp.mpf("1e-8")
        letters = basis(c, w, angle / turn) | {
            Omega: turn,
            coulomb.G: G,
            coulomb.H: H,
            coulomb.phi: angle,
        }
        near, limit = (
            value(f, as_floats(letters)) for f in (coulomb.slide_function(), coulomb.slide_limit())
        )
        assert abs(near - limit) < 1e-6 * max(1, abs(limit))


def test_ratio_is_that_of_the_accelerations_in_the_equation_of_motion() -> None:
    """m = 1: x'' = P cos(theta) - k x -+ F with P cos(theta) = (k - Omega^2) p_0 + c Omega q_0, and x' = 0."""
    for c, w, turn in random_systems(6, 5):
        x_0, x_f, G, H = (mp.mpf(text) for text in ("1.3", "0.2", "0.15", "-0.4"))
        p = x_0 + G * x_f
        q = H * x_f
        push = (w - turn**2) * p + c * turn * q
        expected = (push - w * (x_0 - x_f)) / (push - w * (x_0 + x_f))
        letters = {
            cm: c,
            w0sq: w,
            Omega: turn,
            coulomb.G: G,
            coulomb.H: H,
            coulomb.x_0: x_0,
            coulomb.x_f: x_f,
        }
        assert abs(value(coulomb.ratio(), as_floats(letters)) - expected) < 1e-22


@pytest.mark.quick(1)
@pytest.mark.parametrize("which", [0, 1])
def test_den_hartogs_form_is_the_derived_one(which: int) -> None:
    derived = coulomb.closed(coulomb.half_period()[which], solution.REGIMES["underdamped"])
    difference = derived - coulomb.den_hartog_damped()[which]
    for rate, frequency, turn in ((0.1, 0.9, 1.5), (0.4, 2.2, 0.7), (1.3, 0.2, 2.9)):
        numbers = {solution.h: rate, solution.omega_d: frequency, Omega: turn}
        assert abs(sp.N(difference.subs(numbers))) < 1e-12


@pytest.mark.slow
def test_undamped_forms() -> None:
    free = solution.REGIMES["undamped"]
    forms = coulomb.den_hartog_undamped()
    G, H = (
        coulomb.closed(part, free).subs(solution.omega_0, Omega / coulomb.r)
        for part in coulomb.half_period()
    )
    assert sp.simplify(G) == 0
    B = coulomb.closed(coulomb.slide_function(), free, coulomb.phi / Omega).subs(
        solution.omega_0, Omega / coulomb.r
    )
    for ratio in (0.3, 0.8, 1.5):
        U = forms[coulomb.U].subs(coulomb.r, ratio)
        assert abs(sp.N(H.subs(coulomb.r, ratio) - U)) < 1e-12
        at = {coulomb.G: 0, coulomb.H: U, coulomb.U: U, coulomb.r: ratio, coulomb.phi: 1.1}
        assert abs(sp.N(B.subs(at) - forms[coulomb.S].subs(at) / ratio**2)) < 1e-12


def test_growth_and_decay() -> None:
    P = coulomb.P
    F = coulomb.F
    k = solution.k
    assert sp.simplify(coulomb.resonance_growth() - (sp.pi * P - 4 * F) / k) == 0
    assert coulomb.free_decay() == 2 * coulomb.x_f
