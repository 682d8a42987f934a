"""That a function stays positive: proven where it does, open where it does not, however little it fails."""

from __future__ import annotations

import random

import pytest
from flint import arb

from symosc.certificates.balls import Undecided, working_bits
from symosc.certificates.course import Jet, Margin, prove_positive


def margin(coefficients: list[object], at_start: int, at_end: bool) -> Margin:
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
        return Jet(*jets)

    return Margin("a polynomial", curve, at_start, at_end)


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
        with working_bits(256):
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
    with working_bits(128):
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


def test_an_end_that_is_known_to_an_error() -> None:
    with working_bits(128):
        row = product([0, 1], [arb(1) + arb(0, 1e-9), -1])
        prove_positive(margin(row, 1, True), arb(1) + arb(0, 1e-9))
