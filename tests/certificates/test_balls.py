"""Ball arithmetic, and the traps of it that the proofs must not fall into."""

from __future__ import annotations

import random
import subprocess
import sys
from fractions import Fraction

import pytest
from flint import arb, ctx

from symosc.certificates.balls import (
    Undecided,
    around,
    ball,
    decided_sign,
    exact_ends,
    hull,
    outward,
    sure_sign,
    working_bits,
)


def test_a_comparison_is_true_only_if_it_is_certain() -> None:
    wide = arb(0, 1)
    assert not wide < 0
    assert not wide >= 0  # so "not x < 0" proves nothing
    assert (sure_sign(wide), sure_sign(wide + 2), sure_sign(wide - 2)) == (0, 1, -1)
    with pytest.raises(Undecided):
        decided_sign(wide, "a sign")
    assert sure_sign(arb.nan()) == 0


def test_a_negative_ball_is_the_negative() -> None:
    assert (-arb(3, 1)).contains(-2)
    assert arb(3, 1).neg().contains(-4)  # wrong before python-flint 0.9
    assert not (-arb(3, 1)).contains(3)


def test_a_power_of_a_ball_around_0_is_no_number() -> None:
    """Squares are written as products: x**2 of a ball that contains 0 is nan, and nothing is certain of that."""
    wide = arb(fraction := 0.25, 1)
    assert (wide**2).is_nan() or (wide**2).contains(fraction**2)
    assert (wide * wide).contains(fraction**2)
    assert not arb.nan() > 0
    assert not arb.nan() < arb(1)


def test_the_ends_of_a_ball_are_those_of_its_middle_and_radius() -> None:
    rng = random.Random(1)
    for _ in range(200):
        middle, radius = (Fraction(rng.randint(-(10**9), 10**9), rng.randint(1, 10**9)) for _ in range(2))
        value = around(ball(middle), ball(radius))
        low, high = exact_ends(value)
        assert low <= middle - abs(radius)
        assert high >= middle + abs(radius)
        assert high - low <= 2 * abs(radius) * (1 + Fraction(1, 10**6)) + Fraction(1, 10**3)


def test_a_hull_contains_what_is_between() -> None:
    both = hull(ball(Fraction(1, 3)), ball(Fraction(7, 3)))
    assert all(both.contains(ball(Fraction(i, 3))) for i in range(1, 8))


@pytest.mark.parametrize("digits", [5, 25, 60])
def test_decimals_are_rounded_outward(digits: int) -> None:
    rng = random.Random(digits)
    with working_bits(300):
        for _ in range(100):
            exact = Fraction(rng.randint(-(10**30), 10**30), 10 ** rng.randint(1, 40))
            value = around(ball(exact), ball(Fraction(1, 10 ** rng.randint(3, 70))))
            low, high = map(Fraction, outward(value, digits))
            below, above = exact_ends(value)
            assert low < below <= above < high
            unit = Fraction(10) ** (len(str(int(max(1, abs(below), abs(above))))) - digits)
            assert high - low <= above - below + 4 * unit


def test_the_precision_is_given_back() -> None:
    before = ctx.prec
    with working_bits(999):
        assert ctx.prec == 999
    with pytest.raises(ZeroDivisionError), working_bits(999):
        Fraction(1, 0)
    assert ctx.prec == before


@pytest.mark.parametrize(("command", "what"), [("certify", "certify"), ("verify", "verify")])
def test_without_python_flint_one_line_says_what_to_install(command: str, what: str) -> None:
    code = "import sys; sys.modules['flint'] = None; from symosc.cli.app import main; main(sys.argv[1:])"
    run = subprocess.run([sys.executable, "-c", code, command, "fig6"], capture_output=True, text=True)
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr == f"symosc: error: {what} needs an optional package: pip install 'symosc[certify]'\n"
