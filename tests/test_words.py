"""Mapping structures: how they are read, and which steps are possible."""

from __future__ import annotations

import itertools
import pickle
import random

import pytest

from symosc import scene_names, simulate
from symosc.words import MAPS, Labels, Plane, WordError, read_word, why_not


@pytest.mark.parametrize(
    "text", ["P32", "P3∘P2", "P3 P2", " P3*P2 ", "P3·P2", "P3,P2", "P_{32}", "P_3 P_2", ["P3", "P2"], ("P32",)]
)
def test_every_spelling_is_read_right_to_left(text: object) -> None:
    word = read_word(text)  # type: ignore[arg-type]
    assert word.labels == ("P2", "P3")
    assert str(word) == "P32"
    assert read_word(word) == word


def test_the_paper_s_stick_orbit() -> None:
    word = read_word("P4645")
    assert word.labels == ("P5", "P4", "P6", "P4")
    assert [row.domain for row in word.maps] == [2, 0, 3, 0]
    assert word.exits() == (None, "above", None, "below")
    assert read_word("P4∘P6∘P4∘P5") == word


def test_planes_are_those_of_the_paper() -> None:
    assert MAPS["P7"].start == Plane(1, 2)
    assert MAPS["P7"].end == Plane(2, 1)
    assert str(MAPS["P8"].end) == "Σ¹(2)"


@pytest.mark.parametrize(
    ("text", "step", "reason"),
    [
        ("P52", ("P2", "P5"), r"P5 cannot follow P2: P2 ends on Σ¹\(1\), at belt 1, and P5 starts on Σ¹\(2\)"),
        ("P47", ("P7", "P4"), "P4 cannot follow P7"),
        ("P8", ("P8", "P8"), "P8 cannot follow P8"),
        ("P313", ("P3", "P3"), "only a graze"),
        ("P11", ("P1", "P1"), "a stick ends by slipping"),
        ("P4", ("P4", "P4"), "a flight must come next"),
        ("P22", ("P2", "P2"), "comes from Ω1 and P2 goes back there, which only a graze does"),
        ("P57", ("P7", "P5"), "P5 cannot follow P7"),
        ("P58", ("P8", "P5"), "comes from Ω2"),
    ],
)
def test_impossible_steps_are_named(text: str, step: tuple[str, str], reason: str) -> None:
    with pytest.raises(WordError, match=reason) as error:
        read_word(text)
    assert error.value.step == step
    copy = pickle.loads(pickle.dumps(error.value))
    assert (str(copy), copy.step) == (str(error.value), step)


def test_grazes_may_be_allowed() -> None:
    assert read_word("P22", grazing=True).labels == ("P2", "P2")
    assert read_word("P2", grazing=True).labels == ("P2",)
    with pytest.raises(WordError):
        read_word("P52", grazing=True)


@pytest.mark.parametrize("name", scene_names())
def test_simulated_words_are_possible(name: str) -> None:
    labels = simulate(name, max_events=40).word
    for before, after in itertools.pairwise(labels):
        assert why_not(before, after, grazing=True) == ""


def test_a_long_word_prints_short_and_is_a_list() -> None:
    rng = random.Random(1)
    labels = Labels(rng.choice(["P1", "P2", "P3"]) for _ in range(10_000))
    assert len(repr(labels)) < 1000
    assert repr(labels).startswith("<10,000 mappings: ")
    assert labels == list(labels)
    assert repr(Labels(["P1"])) == "['P1']"
    assert repr(Labels(["P3", *["P1", "P2"] * 30, "P1"])) == "<62 mappings: P3 (P1 P2)×30 P1>"
