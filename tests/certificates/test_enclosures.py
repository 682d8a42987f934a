"""Decimals are rounded outward; along a motion in a box of an atlas signs are certain or open."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from flint import arb, ctx

from symosc import Parameters, Scene, certify
from symosc.certificates.balls import Jet, SignedGap, Undecided, prove_positive, sure_sign
from symosc.certificates.propose import known, one_digit, outward, show_decimal


def test_a_comparison_is_true_only_if_it_is_certain() -> None:
    wide = arb(0, 1)
    assert not wide < 0
    assert not wide >= 0  # so "not x < 0" proves nothing
    assert (sure_sign(wide), sure_sign(wide + 2), sure_sign(wide - 2)) == (0, 1, -1)
    assert sure_sign(arb.nan()) == 0


@pytest.mark.parametrize("digits", [5, 60])
def test_decimals_are_rounded_outward(digits: int) -> None:
    rng = random.Random(digits)
    for _ in range(50):
        middle = Fraction(rng.randint(-(10**30), 10**30), 10 ** rng.randint(1, 40))
        radius = Fraction(1, 10 ** rng.randint(3, 70))
        below = middle - radius
        above = middle + radius
        low, high = map(Fraction, outward((below, above), digits))
        assert low < below <= above < high
        unit = Fraction(10) ** (len(str(int(max(1, abs(below), abs(above))))) - digits)
        assert high - low <= above - below + 4 * unit
        rough_low, rough_high = map(Fraction, known((below, above), digits))
        assert rough_low < below <= above < rough_high


def test_a_radius_is_rounded_down_to_one_digit() -> None:
    for text, shown in (("0.00123", "1e-3"), ("9.99", "9e0"), ("1", "1e0"), ("0.1", "1e-1")):
        assert one_digit(Fraction(text)) == shown
    assert show_decimal(Fraction(-1, 8)) == "-0.125"


def test_a_dip_between_two_equal_slopes_is_found() -> None:
    """Its secant is no number.

    The gap falls as fast at both ends of the piece, a whole period apart.
    """
    numbers = {
        "m": "13/2",
        "c": 2,
        "k": "51597/2000000",
        "A0": "-670761/20000000",
        "B0": "-83349/12500000",
    }
    speeds = {
        "v1": "-166697999997/50000000000000",
        "v2": "2165849/25000000",
        "mu1": 0,
        "mu2": 0,
        "FN": "179/25",
    }
    p = Parameters(**numbers, Omega="63/1000", **speeds)
    scene = Scene(
        "dip", p, Fraction(0), Fraction("-1.3"), Fraction(-83349, 25000000), Fraction(300)
    )
    certificate = certify(scene)
    assert certificate.proven, certificate.message
    assert [event[0] for event in certificate.events] == ["cross"] * 7


def margin(coefficients: list[object], at_start: int, at_end: bool) -> SignedGap:
    """Return a polynomial, the lowest power first."""

    def curve(tau: object) -> Jet:
        jets = []
        row = [arb(each) for each in coefficients]
        for _ in range(3):
            total = arb(0)
            for each in reversed(row):
                total = total * tau + each
            jets.append(total)
            row = [i * each for i, each in enumerate(row)][1:]
        return Jet(tau, *jets)

    return SignedGap("a polynomial", curve, at_start, at_end)


def product(*factors: list[object]) -> list[object]:
    total: list[object] = [arb(1)]
    for factor in factors:
        longer: list[object] = [arb(0)] * (len(total) + len(factor) - 1)
        for i, a in enumerate(total):
            for j, b in enumerate(factor):
                longer[i + j] += a * arb(b)
        total = longer
    return total


@pytest.mark.parametrize("gap", [1, 1e-3, 1e-9, 1e-25, 0, -1e-25, -1e-9, -1e-3])
def test_a_near_miss(gap: float) -> None:
    rng = random.Random(str(gap))
    for _ in range(5):
        place = rng.uniform(0.2, 0.8)
        with ctx.workprec(256):
            row = product([-arb(place), 1], [-arb(place), 1])
            row[0] += arb(gap)
            if gap > 0:
                prove_positive(margin(row, 0, False), arb(1))
            else:
                with pytest.raises(Undecided):
                    prove_positive(margin(row, 0, False), arb(1))


@pytest.mark.parametrize("at_start", [0, 1, 2])
def test_it_starts_and_ends_on_the_belt(at_start: int) -> None:
    start: list[list[object]] = [[0, 1]] * at_start
    good = product(*start, [1, -1], [2, 1])
    with ctx.workprec(128):
        prove_positive(margin(good, at_start, True), arb(1))
        for bad in (
            product(*start, [1, -1], [-0.5, 1], [-0.5, 1]),
            product(*start, [-1, 1]),
            product([0.25, -1], good),
        ):
            with pytest.raises(Undecided):
                prove_positive(margin(bad, at_start, True), arb(1))
        with pytest.raises(Undecided):  # it ends before the time that is asked for
            prove_positive(margin(good, at_start, False), arb(1.5))
