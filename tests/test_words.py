"""Mapping structures: how they are read, and which steps are possible."""

from __future__ import annotations

import itertools
import random

import pytest

from symosc import scene_names, simulate
from symosc.words import Labels, why_not


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
