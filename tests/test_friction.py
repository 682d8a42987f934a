"""The friction law against the paper's tables and equations, which are written down here once more."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace

import pytest

from symosc import Parameters
from symosc.engine.events import mode_of_law
from symosc.engine.state import MIDDLE, ON_BELT
from symosc.engine.summary import map_number
from symosc.friction import (
    ALL_MODE_NAMES,
    MAPS,
    MODE_NAMES,
    NEIGHBOURS,
    BeltNumbers,
    FrictionLaw,
    geometry,
)
from symosc.kernels.theorem7_cases import PLACES

#: Eqs. (10) to (17): superscript and belt of the planes where a mapping starts and ends, its domain.
PAPER_MAPS = {
    "P1": ((0, 1), (0, 1), 0),
    "P2": ((1, 1), (1, 1), 1),
    "P3": ((2, 1), (2, 1), 2),
    "P4": ((0, 2), (0, 2), 0),
    "P5": ((1, 2), (1, 2), 2),
    "P6": ((2, 2), (2, 2), 3),
    "P7": ((1, 2), (2, 1), 2),
    "P8": ((2, 1), (1, 2), 2),
}


def test_two_belts_are_the_papers() -> None:
    assert {
        row.label: (tuple(row.start), tuple(row.end), row.domain) for row in MAPS.values()
    } == PAPER_MAPS
    assert list(MAPS) == list(PAPER_MAPS)
    assert MODE_NAMES == {1: "Omega1", 2: "Omega2", 3: "Omega3", 4: "belt1", 5: "belt2"}
    assert NEIGHBOURS == {1: (1, 2), 2: (2, 3)}
    assert [row.mode for row in MAPS.values()] == [4, 1, 2, 5, 2, 3, 2, 2]
    assert PLACES == {
        "P2": (1, 1, 1, 55),
        "P3": (2, 1, -1, 56),
        "P5": (2, 2, 1, 57),
        "P6": (3, 2, -1, 58),
    }


@pytest.mark.parametrize("belts", range(1, 7))
def test_any_number_of_belts(belts: int) -> None:
    """Each flight leaves a belt into a neighbouring domain and ends at a belt of that domain."""
    found = geometry(belts)
    assert len(found.maps) == 5 * belts - 2
    assert len(found.mode_names) == 2 * belts + 1
    assert found.mode_names.items() <= ALL_MODE_NAMES.items()
    ways = {(row.start, row.end) for row in found.maps.values()}
    assert len(ways) == len(found.maps)
    for row in found.maps.values():
        if row.sticks:
            assert row.mode == found.stick_mode(row.start.boundary)
            continue
        for plane in (row.start, row.end):
            below, above = found.neighbours[plane.boundary]
            assert row.domain == (below if plane.superscript == 1 else above)


def test_one_belt_and_three_have_letters() -> None:
    assert list(geometry(1).maps) == ["S1", "B1", "A1"]
    assert list(geometry(3).maps)[6:] == ["D21", "U12", "S3", "B3", "A3", "D32", "U23"]


def test_forces_are_those_of_each_belt_alone() -> None:
    """Eq. (5): -sgn(v - v_b) mu_b FN, summed over the belts, at a speed inside each domain."""
    rng = random.Random(1)
    for _ in range(50):
        count = rng.randint(1, 5)
        speeds = sorted(rng.sample(range(-20, 20), count))
        belts = [BeltNumbers(Fraction(v), Fraction(rng.randint(0, 9), 10)) for v in speeds]
        law = FrictionLaw(belts, Fraction(rng.randint(0, 30), 7))
        inside = [
            speeds[0] - 1,
            *((a + b) / Fraction(2) for a, b in pairwise(speeds)),
            speeds[-1] + 1,
        ]
        for domain, v in enumerate(inside, 1):
            pushes = sum(belt.mu * law.FN * (1 if belt.v > v else -1) for belt in belts)
            assert law.force(domain) == pushes
        assert [law.force(b) - law.force(b + 1) for b in range(1, count + 1)] == [
            2 * law.kinetic(b) for b in range(1, count + 1)
        ]


def test_parameters_read_their_forces_from_it() -> None:
    p = Parameters(m=1, c=1, k=1, A0="-1.5", B0=1, Omega=1, v1=1, v2=5, mu1="0.4", mu2="0.1", FN=10)
    assert [p.A(alpha) for alpha in (1, 2, 3)] == [
        Fraction(7, 2),
        Fraction(-9, 2),
        Fraction(-13, 2),
    ]
    assert (p.belt(1), p.belt(2), p.friction(1), p.friction(2)) == (1, 5, 4, 1)


@pytest.mark.parametrize("belts", [1, 2, 3, 5])
def test_the_engine_counts_modes_and_mappings_as_the_law_does(belts: int) -> None:
    """In each row of constants: its middle domain is number `shift` + 2 of the law."""
    law = geometry(belts)
    names = list(law.maps)
    for domain in law.domains:
        K = SimpleNamespace(banded=True, shift=float(domain - MIDDLE))
        assert law.mode_names[mode_of_law(MIDDLE, K)] == f"Omega{domain}"
        beside = {domain - 1, domain} & set(law.boundaries)
        for to in beside:
            held = ON_BELT + to - (domain - MIDDLE)
            assert mode_of_law(held, K) == law.stick_mode(to)
            stick = law.maps[names[map_number(0, held, to, K) - 1]]
            assert (stick.sticks, stick.end.boundary) == (True, to)
            assert map_number(0, MIDDLE, to, K) == 0
            for at in beside:
                row = law.maps[names[map_number(at, MIDDLE, to, K) - 1]]
                assert (row.start.boundary, row.end.boundary, row.domain) == (at, to, domain)
