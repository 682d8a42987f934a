"""What is just behind the end of a branch."""

from __future__ import annotations

import pytest

from symosc import ParameterError, find_orbit, load_scene
from symosc.orbits import behind
from symosc.orbits.behind import look_behind
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.curve import Curve
from symosc.orbits.guesses import follow
from symosc.words import read_word

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


@pytest.mark.parametrize("most", [1, 2, 3, 6])
def test_so_many_words_of_a_motion_are_tried_and_no_more(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The motion goes through three words until it has settled; the last ones come first."""
    equations = ClosingEquations(load_scene("fig5").parameters, read_word("P32"), 1)
    run = follow(equations, 5.0, 1.0, equations.pieces[0].start, 60)
    monkeypatch.setattr(behind, "MOST_WORDS", most)
    found = [str(word) for word in behind._words_of_a_period(equations, run.passages)]
    assert found == ["P12", "P1312", "P312"][:most]
