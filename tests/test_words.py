"""Mapping structures: how they are read, and which steps are possible."""

from __future__ import annotations

import itertools
import random

import pytest

from symosc import (
    Parameters,
    certify,
    continue_orbit,
    find_orbit,
    frequency_response,
    load_scene,
    read_word,
    scene_names,
    simulate,
    simulate_many,
    sweep,
)
from symosc.friction import MAPS
from symosc.words import Labels, Word, cycle, why_not


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


# -- one orbit has one word ------------------------------------------------------------------------

FIG9 = load_scene("fig9").parameters
FIG10 = load_scene("fig10").parameters
#: A scene's parameters, its start, the word of the orbit in all rotations, and the one to write.
ORBITS = [
    pytest.param("fig10", FIG10, ("P4645", "P6454", "P4546", "P5464"), "P6454", id="fig10"),
    pytest.param(
        "fig9", FIG9.replace(Omega=1), ("P1312", "P3121", "P1213", "P2131"), "P3121", id="fig9"
    ),
]


def least_rotation(labels: tuple[str, ...]) -> tuple[str, ...]:
    return sorted(labels[i:] + labels[:i] for i in range(len(labels)))[0]


def test_all_rotations_of_a_word_are_equal_and_have_one_text() -> None:
    rng = random.Random(11)
    for _ in range(200):
        labels = tuple(rng.choices(sorted(MAPS), k=rng.randint(1, 9)))
        cut = rng.randrange(len(labels))
        word = Word(labels)
        turned = Word(labels[cut:] + labels[:cut])
        assert word == turned
        assert (word != turned) is False
        assert hash(word) == hash(turned)
        assert word.cycle.labels == least_rotation(labels)
        assert str(word.cycle) == cycle(str(word)) == cycle(str(turned))
        assert turned in {word}
    assert read_word("P32") != read_word("P12")
    assert read_word("P32") != "P32"
    assert cycle("") == ""


@pytest.mark.parametrize(("scene", "p", "rotations", "text"), ORBITS)
def test_every_answer_about_an_orbit_has_the_same_text(
    scene: str, p: Parameters, rotations: tuple[str, ...], text: str
) -> None:
    orbit = find_orbit(p, rotations[0])
    assert [find_orbit(p, word) == orbit for word in rotations] == [True] * len(rotations)
    assert [read_word(word) == read_word(text) for word in rotations] == [True] * len(rotations)
    assert orbit.word == text == find_orbit(p).word
    assert orbit.labels == least_rotation(orbit.labels)
    T = float(orbit.period)
    summary = simulate_many(p, (0, 4, 2), 40 * T, record=("word",), use_numba=False)
    assert summary.word.tolist() == [text]
    swept = sweep(scene, {"Omega": [str(p.Omega)]}, t_end="40T", skip="30T")
    assert swept.word.values.tolist() == [text]
    assert frequency_response(p, {"Omega": [float(p.Omega)]}).word.tolist() == [text]


def test_a_scene_reads_any_rotation_and_keeps_the_one_of_answers() -> None:
    scene = load_scene("fig10")
    assert scene.structure == "P6454"
    for word in ("P4645", "P6454", "P4∘P5∘P4∘P6"):
        assert type(scene)("mine", FIG10, 0, 1, 2, 3, structure=word).structure == "P6454"


def test_points_of_an_answer_are_a_guess_for_any_rotation() -> None:
    orbit = find_orbit(FIG10, "P4645")
    begun = (*orbit.points[1:], (orbit.points[0].t + orbit.period, orbit.points[0].x))
    rough = [(round(t, 1), round(x, 1)) for t, x in orbit.points]
    for word, guess in (("P4645", orbit), ("P4645", begun), ("P4645", rough), ("P6454", rough)):
        found = find_orbit(FIG10, word, guess)
        assert found.word == "P6454"
        assert found.points[0] == pytest.approx(orbit.points[0], rel=1e-13)


@pytest.mark.slow
def test_branches_and_certificates_have_the_text_too() -> None:
    branch = continue_orbit(FIG10, "P4645", "B0", (3, FIG10.B0))
    assert (branch.word, branch.ends[0].beyond) == ("P6454", "P54")
    turned = continue_orbit(FIG10, "P5464", "B0", (3, FIG10.B0))
    assert (turned.points == branch.points).all()
    pytest.importorskip("flint")
    proof = certify(find_orbit(FIG10, "P4645"))
    assert proof.proven
    assert proof.as_dict()["word"] == "P6454"
