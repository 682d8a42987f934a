"""The number of stops per cycle: by running, and by equations for its borders."""

from __future__ import annotations

from fractions import Fraction

import pytest

from symosc.derive import stops
from symosc.derive.published import wall
from symosc.errors import ParameterError
from symosc.orbits.branch import continue_orbit
from symosc.orbits.find import find_orbit


@pytest.mark.slow
@pytest.mark.parametrize(
    ("low", "high", "counts", "kind"),
    [("0.12", "0.125", (2, 4), "touch"), ("0.5", "0.51", (6, 4), "birth")],
)
def test_borders_by_running_are_those_of_the_equations(low: str, high: str, counts: tuple, kind: str) -> None:
    border = stops.find_border(Fraction(low), Fraction(high), "0.1")
    assert (border.below, border.above) == counts
    assert border.high - border.low < 1e-7
    found = stops.meeting("0.1", border)
    assert found.kind == kind
    assert float(found.ratio) == pytest.approx(border.middle, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(("low", "high", "counts"), [("0.4", "0.45", (12, 14)), ("0.45", "0.5", (14, 12))])
def test_fourteen_stops(low: str, high: str, counts: tuple) -> None:
    border = stops.find_border(Fraction(low), Fraction(high), "0.04")
    assert (border.below, border.above) == counts
    assert float(stops.meeting("0.04", border).ratio) == pytest.approx(border.middle, abs=1e-7)


@pytest.mark.slow
def test_the_branch_of_orbits_with_two_stops_ends_at_the_border() -> None:
    """Another way to the border of 2 and 4 stops: P1312 followed in F until a slide is touched."""
    branch = continue_orbit(wall("0.12", "0.1"), "P1312", "mu1", ("0.119", "0.122"))
    border = stops.find_border(Fraction("0.12"), Fraction("0.125"), "0.1")
    assert branch.ends[1].value == pytest.approx(border.middle, abs=1e-7)


@pytest.mark.slow
def test_counts_are_those_of_orbits() -> None:
    """A settled motion with 2 n stops has the word of n slides down, n slides up, and a stop after each."""
    for ratio, word in (("0.11", "P1312"), ("0.2", "P13131212"), ("0.9", "P1312")):
        assert stops.stops(wall(ratio, "0.1")) == word.count("1")
        assert find_orbit(wall(ratio, "0.1"), word).admissible


def test_one_stop_at_one_half_only() -> None:
    """From rest at 0: below F/P = 1/3 one stop per cycle at Omega = 1/2; above two; elsewhere none or two."""
    assert [stops.stops_in_cycle(wall(F, "0.5"), 60) for F in ("0.1", "0.3", "0.4")] == [1, 1, 2]
    assert stops.stops(wall("0.36", "0.5")) == 2
    assert [stops.stops(wall(F, "0.49")) for F in ("0.1", "0.4")] == [0, 2]


def test_equal_counts_have_no_border() -> None:
    with pytest.raises(ParameterError, match="different numbers of stops"):
        stops.find_border("0.2", "0.3", "0.1")
