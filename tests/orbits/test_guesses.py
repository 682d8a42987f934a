"""Guesses of an orbit's points, in every form."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import FIG9, P32

from symosc.errors import ParameterError
from symosc.orbits.find import find_orbit


def test_guesses():
    rough = [(0.2, 4.0), (1.0, -4.0)]
    for guess in (rough, np.array(rough), (0.18, 4.15), (0.9, 4.15), find_orbit(FIG9, "P32")):
        assert find_orbit(FIG9, "P32", guess).points[0].t == pytest.approx(float(P32[0][0]), abs=1e-13)
    moved = [(t + 5 * np.pi, x) for t, x in rough]  # the first point is brought into the first period
    assert find_orbit(FIG9, "P32", moved).points[1].t == pytest.approx(float(P32[1][0]), abs=1e-12)


@pytest.mark.parametrize(
    ("guess", "says"),
    [
        ([(0.2, 4.0)] * 3, r"must be 2 pairs \(t, x\)"),
        ([1, 2, 3], "must be 2 pairs"),
        ("nonsense", "must be 2 pairs"),
        ([(0.2, 4.0), (float("nan"), 1)], "must be 2 pairs"),
        ([(1.0, 4.0), (0.2, -4.0)], "times must increase"),
    ],
)
def test_guesses_of_the_wrong_form(guess, says):
    with pytest.raises(ParameterError, match=says):
        find_orbit(FIG9, "P32", guess)
