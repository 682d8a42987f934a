"""Margins of orbits, and what they are measured by, are the same in any units."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import BOTH_BELTS, FIG9, FIG10
from units import UNITS, Units

from symosc import Parameters, find_orbit
from symosc.orbits import verification
from symosc.orbits.admissibility import Condition, conditions, grazing_distance
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.floquet import monodromy, rest_positions
from symosc.orbits.guesses import largest_displacement
from symosc.words import read_word

ORBITS = [(p, word, find_orbit(p, word)) for p, word in ((FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748"))]


def factor_of(condition: Condition, units: Units) -> float:
    """Return the factor of a margin by what it is: a duration, a velocity, a force, or the slope of one."""
    if condition.text.endswith(" lasts"):
        return float(units.time)
    if " stays in " in condition.text:
        return units.speed
    return units.force / float(units.time) if condition.text.split()[1] in ("falls", "rises") else units.force


def residual_factors(equations: ClosingEquations, units: Units) -> list[float]:
    """Return the factors of f1 and f2 of all pieces; f2 is a force for a stick, and divided by durations for a slip."""
    found = []
    for piece in equations.pieces:
        found += [float(units.length), units.force if piece.sticks else units.speed / float(units.time) ** piece.zeros]
    return found


@pytest.mark.parametrize("units", UNITS, ids=str)
@pytest.mark.parametrize(("p", "word", "orbit"), ORBITS, ids=["P32", "P4645", "P1748"])
def test_an_orbit_has_the_same_margins(units: Units, p: Parameters, word: str, orbit: object) -> None:
    T, L, V = float(units.time), float(units.length), units.speed
    one, two = (ClosingEquations(each, read_word(word), 1) for each in (p, units.of(p)))
    points = orbit.phases()  # type: ignore[attr-defined]
    for shift in (0.0, 1e-3, 0.3):  # on the orbit, beside it, and far away
        here = points + np.array([shift, 0.0])
        there = here * [L, 1.0]
        for a, b in zip(conditions(one, here), conditions(two, there), strict=True):
            factor = factor_of(a, units)
            assert (b.text, b.rank) == (a.text, a.rank)
            assert (b.value, b.scale) == (a.value * factor, a.scale * factor)
            assert b.t == pytest.approx(a.t * T, rel=1e-12)
        assert grazing_distance(two, there) == grazing_distance(one, here) * V
        assert verification.ill_conditioned(two, there) == verification.ill_conditioned(one, here)
        residuals = zip(one.residuals(here), two.residuals(there), residual_factors(one, units), strict=True)
        assert all(b == a * factor for a, b, factor in residuals)
        a, b = monodromy(one, here), monodromy(two, there)
        assert (b.trace, b.determinant) == (a.trace, a.determinant)
        assert verification._start(two, there) == verification._start(one, here)
    assert largest_displacement(two) == tuple(value * L for value in largest_displacement(one))
    for boundary in (1, 2):
        rest = rest_positions(p.replace(v1=0) if boundary == 1 else p.replace(v1=-9, v2=0), boundary)
        other = rest_positions(units.of(p.replace(v1=0) if boundary == 1 else p.replace(v1=-9, v2=0)), boundary)
        assert other == (rest and tuple(value * units.length for value in rest))


@pytest.mark.quick(2)
@pytest.mark.parametrize("units", UNITS, ids=str)
def test_an_orbit_is_found_in_any_units(units: Units) -> None:
    """Without a guess, to nearly all digits, with all that is said of it."""
    for p, word, orbit in ORBITS[:2]:
        found = find_orbit(units.of(p), word)
        assert (found.admissible, found.stable) == (True, True)
        assert found.multipliers == pytest.approx(orbit.multipliers, rel=1e-9, abs=1e-12)
        assert found.grazing_distance == pytest.approx(orbit.grazing_distance * units.speed, rel=1e-9)
        for (t, x), (t_found, x_found) in zip(orbit.points, found.points, strict=True):
            assert (t_found, x_found) == pytest.approx((t * float(units.time), x * float(units.length)), rel=1e-10)
