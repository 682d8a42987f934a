"""What is just behind the end of a branch."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError, find_orbit, load_scene
from symosc.engine.state import END, FAILED, REST
from symosc.orbits import behind
from symosc.orbits.behind import look_behind
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.curve import Curve
from symosc.orbits.guesses import SETTLING_EVENTS, follow
from symosc.words import read_word

FIG9 = load_scene("fig9").parameters
ORBIT = find_orbit(FIG9, "P32")


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


@pytest.mark.parametrize(("width", "tried"), [(2.0, 5), (1e-4, 4), (1e-8, 0), (1e-10, 0)])
@pytest.mark.parametrize("direction", [-1.0, 1.0])
def test_only_values_beyond_the_end_are_looked_at(
    width: float, tried: int, direction: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The nearest first. In a range so narrow that doubles do not tell one from the end, that one is left out."""
    along = Curve(ORBIT, "Omega", 4.0 - width / 2, 4.0 + width / 2)
    asked: list[float] = []
    end = along.first(direction)
    monkeypatch.setattr(behind, "follow", lambda equations, *_: asked.append(equations.K.Om) or SimpleNamespace(code=0))
    monkeypatch.setattr(behind, "_orbit_of", lambda *_: None)
    assert look_behind(along, end, direction) == (None, "")
    distances = [10.0**-n for n in (9, 8, 7, 6, 5)]
    right = [value for each in distances if (value := 4.0 + direction * each * (along.high - along.low)) != 4.0]
    assert asked == right
    assert tried == 0 or len(asked) == 5
    assert all(direction * (value - 4.0) > 0 for value in asked)


def test_the_first_word_that_is_found_beyond_counts_and_else_where_it_rests(monkeypatch: pytest.MonkeyPatch) -> None:
    along = Curve(ORBIT, "Omega", 3.0, 5.0)
    end, number = along.first(1.0), [0]
    for found_at, codes, right in (
        (0, [END] * 5, ("P32", "")), (3, [REST] * 5, ("P32", "")), (9, [REST] * 5, (None, "rest 1")),
        (9, [END, FAILED, REST, REST, END], (None, "rest 3")), (9, [END] * 5, (None, "")),
    ):  # fmt: skip
        number[0] = 0

        def follow_it(*_: object, codes: list[int] = codes) -> SimpleNamespace:
            number[0] += 1
            return SimpleNamespace(code=codes[number[0] - 1])

        def orbit(*_: object, found_at: int = found_at) -> object:
            return read_word("P32") if number[0] > found_at else None

        monkeypatch.setattr(behind, "follow", follow_it)
        monkeypatch.setattr(behind, "_orbit_of", orbit)
        monkeypatch.setattr(behind, "without_word", lambda *_: f"rest {number[0]}")
        assert look_behind(along, end, 1.0) == right


def test_the_motion_behind_an_end_begins_where_the_orbit_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the first point of the orbit, in its phase and on its belt; how far it moves is the size of what is found."""
    asked: list[Any] = []
    for word in ("P32", "P23"):
        along = Curve(find_orbit(FIG9, word), "Omega", 3.0, 5.0)
        end = along.first(1.0)
        monkeypatch.setattr(behind, "follow", lambda equations, *rest: asked.append(rest) or SimpleNamespace(code=END))
        monkeypatch.setattr(behind, "_orbit_of", lambda equations, run, size: asked.append(size) or "P32")
        assert look_behind(along, end, 1.0) == ("P32", "")
        (x, theta, belt, most), size = asked
        assert (x, belt, most) == (end.points[0][0], 1, SETTLING_EVENTS)
        assert theta == pytest.approx(end.points[0][1] % (2 * np.pi))
        assert size == max(abs(end.points[0][0]), abs(end.points[1][0]))
        asked.clear()


@pytest.mark.parametrize("size", [3.0, 0.0])
def test_guesses_are_measured_by_how_far_the_orbit_moves(size: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """... which may be nowhere: the distance of two points is over a size > 0."""
    equations = ClosingEquations(FIG9, read_word("P32"), 1)
    run = follow(equations, 4.0, 1.0, 1, 20)
    asked: list[float] = []
    monkeypatch.setattr(behind, "windows", lambda passages, labels, periods, size: asked.append(size) or [])
    assert behind._orbit_of(equations, run, size) is None
    assert asked
    assert set(asked) == {size or 1e-300}
