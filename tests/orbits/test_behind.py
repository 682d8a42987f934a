"""What is just behind the end of a branch."""

from __future__ import annotations

import pytest

from symosc import ParameterError, find_orbit, load_scene
from symosc.orbits.behind import look_behind
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.curve import Curve

FIG9 = load_scene("fig9").parameters


def test_nothing_is_behind_the_last_system_that_there_is() -> None:
    """Without friction there is nothing beyond: mu2 < 0 is no system."""
    orbit = find_orbit(FIG9.replace(mu2=0), "P32")
    along = Curve(orbit, "mu2", 0.0, 1.0)
    first = along.first(-1.0)
    assert first.value == 0
    with pytest.raises(ParameterError):
        along.equations(-1e-9)
    assert look_behind(along, first, -1.0) == (None, "")
    assert isinstance(along.equations(0.5), ClosingEquations)
