"""What `certify` proves the checker confirms: random scenes of all families."""

from __future__ import annotations

import pytest
from confirming import REFUSED, certified, numbered


@pytest.mark.slow
@pytest.mark.parametrize(("count", "seed"), [(40, 1), pytest.param(2000, 2, marks=pytest.mark.campaign)])
def test_random_scenes_are_confirmed(count: int, seed: int) -> None:
    proven = 0
    for family, number in numbered(count):
        found = certified(family, seed, number)
        assert not found.message.startswith(REFUSED), (family, number, found.message)
        proven += found.proven
    assert proven > count / 2


@pytest.mark.parametrize(
    ("family", "seed", "number"),
    [
        pytest.param("onbelt", 21, 2, id="a flight of 1e-13 from a belt where F is 1e-14"),
        pytest.param("aimed", 3, 14, id="a stick that a start known to 1e-20 leaves"),
        pytest.param("limit", 21, 14, id="a belt met at a speed of 1e-20"),
        pytest.param("near", 21, 59, id="a graze, then four cycles that nearly graze"),
        pytest.param("approach", 21, 6, id="a belt that is approached to 1e-217", marks=pytest.mark.slow),
    ],
)
def test_scenes_are_confirmed_that_the_checker_refused(family: str, seed: int, number: int) -> None:
    assert certified(family, seed, number).proven
