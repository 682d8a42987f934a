"""Answers about an oscillator with one belt: they name its mappings S1, B1, A1, and no other belt."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from cli_runs import good, run

import symosc
from symosc import (
    Belt,
    Oscillator,
    OtherModel,
    Parameters,
    Scene,
    WordError,
    find_orbit,
    frequency_response,
    load_scene,
    read_word,
    simulate,
    simulate_many,
    sweep,
)
from symosc.scenes import as_toml

NUMBERS = {"m": 1, "c": "1/10", "k": 1, "A0": 0, "B0": 1, "Omega": "1/2", "FN": 1}
CROSSING = Oscillator(**NUMBERS, belts=[Belt(0, mu="1/5")])  # type: ignore[arg-type]
STICKING = CROSSING.replace(v1="1/2", mu1="3/5")
#: The oscillator, the word of its orbit, and the word with a second belt that is never met.
ONE = [
    pytest.param(CROSSING, "B1∘A1", "P32", id="crossing"),
    pytest.param(STICKING, "S1∘B1", "P21", id="sticking"),
]

#: What the mappings are called with a second belt.
PAPER = {"S1": "P1", "B1": "P2", "A1": "P3"}


def beside_another(one: Oscillator) -> Parameters:
    """Return the oscillator with a second belt far above all that it reaches."""
    numbers = {name: getattr(one, name) for name in NUMBERS}
    (belt,) = one.belts
    return Parameters(**numbers, v1=belt.v, mu1=belt.mu, v2=1000, mu2=0)


@pytest.mark.parametrize(("one", "text", "of_two"), ONE)
def test_every_answer_has_one_word(one: Oscillator, text: str, of_two: str) -> None:
    orbit = find_orbit(one)
    T = float(orbit.period)
    motion = simulate(one, t_end=41 * T)
    last = [s.label for s in motion.segments if s.label and 39 * T < s.t_start < 40 * T]
    assert read_word(last[::-1]) == read_word(text)
    assert (orbit.word, orbit.parameters) == (text, one)
    assert read_word(orbit.word).labels == orbit.labels
    assert simulate_many(one, (0, 1, 0), 40 * T, record="word").word.tolist() == [text]
    swept = sweep(
        Scene("mine", one, 0, 1, 0, 9),  # type: ignore[arg-type]
        {"Omega": [str(one.Omega)]},
        t_end="40T",
        skip="30T",
    )
    assert swept.word.values.tolist() == [text]
    assert frequency_response(one, {"Omega": [0.5]}).word.tolist() == [text]
    model = OtherModel(**NUMBERS, v1=one.belts[0].v, mu1=one.belts[0].mu)  # type: ignore[arg-type]
    assert frequency_response(model, {"Omega": [0.5]}).word.tolist() == [text]
    assert (find_orbit(model).word, find_orbit(model).parameters) == (text, one)


def test_another_model_has_the_word_of_its_belts() -> None:
    one = CROSSING.belts[0]
    for belts, text in (([one], "B1∘A1"), ([one, Belt(3, mu="1/10")], "P32")):
        model = OtherModel(**NUMBERS, belts=belts)  # type: ignore[arg-type]
        assert frequency_response(model, {"Omega": [0.5]}).word.tolist() == [text]
        assert find_orbit(model).word == text


@pytest.mark.parametrize(("one", "text", "of_two"), ONE)
def test_the_orbit_is_that_beside_a_belt_far_away(one: Oscillator, text: str, of_two: str) -> None:
    two = find_orbit(beside_another(one))
    assert read_word(two.word) == read_word(of_two)
    for word in (None, text, of_two):
        orbit = find_orbit(one, word)
        assert orbit.word == text
        t = np.linspace(0, 30, 100)
        assert orbit(t) == pytest.approx(two(t), abs=1e-9)
        assert orbit.multipliers == pytest.approx(two.multipliers, abs=1e-9)
        assert orbit.conditions()
    assert find_orbit(one, digits=30).points[0] == pytest.approx(orbit.points[0], abs=1e-12)
    assert orbit.lyapunov == pytest.approx(two.lyapunov)
    order = [two.labels.index(PAPER[label]) for label in orbit.labels]
    changes = two.sensitivities(("v1", "mu1")).dt[order]
    assert orbit.sensitivities(("v1", "mu1")).dt == pytest.approx(changes)
    refused(lambda: orbit.sensitivities("v2"), "wrt")
    assert "A_1" in orbit._repr_latex_() or "S_1" in orbit._repr_latex_()


def test_a_branch_and_its_ends_have_such_words() -> None:
    branch = symosc.continue_orbit(CROSSING, "A1 B1", "mu1", ("1/10", "9/10"))
    assert (branch.word, branch.labels) == ("B1∘A1", ("A1", "B1"))
    end = branch.ends[1]
    assert end.kind == "birth of a stick"
    beyond = CROSSING.replace(mu1=end.value + 0.01)
    assert end.beyond == find_orbit(beyond).word
    assert branch.orbit(0).word == "B1∘A1"
    assert branch.parameters(-1) == CROSSING.replace(mu1=end.value)
    refused(lambda: symosc.continue_orbit(CROSSING, "A1 B1", "v2", (1, 2)), "parameter")


def test_a_branch_goes_on_where_the_reach_of_the_mass_is_a_power_of_ten() -> None:
    """B0/Omega + mu FN/Omega + v1 = 1 at v1 = 3/7: a belt out of reach leaps from there."""
    belt = symosc.Belt("1/2", mu="1/5")
    law = symosc.Oscillator(m=1, c="1/20", k=1, B0="3/5", Omega="7/5", belts=[belt])
    branch = symosc.continue_orbit(law, "B1 A1", "v1", ("1/10", "3/5"))
    assert [end.kind for end in branch.ends] == ["end of the range", "end of the range"]
    end = find_orbit(law.replace(v1="1/10"))
    assert end.word == branch.word
    positions = sorted(x for _, x in branch.ends[0].points)
    assert positions == pytest.approx(sorted(x for _, x in end.points), abs=1e-9)


def test_an_orbit_of_one_belt_is_proven() -> None:
    pytest.importorskip("flint")
    assert symosc.certify(find_orbit(STICKING)).proven


def test_words_are_read_and_written() -> None:
    word = read_word("A1 ∘ B1")
    assert (str(word), word.labels, word.latex()) == ("A1∘B1", ("B1", "A1"), r"A_1 \circ B_1")
    assert word == read_word(["B1", "A1"]) != read_word("P32")
    assert read_word("S1 B1").exits() == (None, "below")
    for text, message in (
        ("S1", "S1 cannot follow S1"),
        ("B1 B1", "only a graze"),
        ("P3 B1", "mixes mappings"),
        ("B1 B2", "B1 cannot follow B2"),
        ("B1 B", "S1, B1 and A1"),
        ("A1B1", "is not a mapping"),
    ):
        with pytest.raises(WordError, match=message):
            read_word(text)
    with pytest.raises(WordError, match="P4 is at belt 2, and there is one belt"):
        find_orbit(CROSSING, "P54")
    assert find_orbit(beside_another(CROSSING), "A1∘B1").word == "P32"


def test_a_scene_keeps_the_word_of_its_belts(tmp_path: Path) -> None:
    scene = Scene("mine", CROSSING, 0, 1, 0, 9, structure="P32")  # type: ignore[arg-type]
    assert scene.structure == "B1∘A1"
    file = tmp_path / "mine.toml"
    file.write_text(as_toml(scene), encoding="utf-8")
    assert load_scene(file) == scene
    assert "B1∘A1: a stable orbit" in good("orbit", str(file))
    found = run("orbit", str(file), "--structure", "P54")
    assert (found.exit_code, found.stderr.count("\n")) == (2, 1)


@pytest.mark.parametrize("mapping", ["P5", "P6"])
@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda p, map: symosc.grazing_window(p, map), "mapping"),
        (lambda p, map: symosc.grazing_windows(p, map, Omega=[1]), "mapping"),
        (lambda p, map: symosc.check_grazing(p, map, n=20), "mapping"),
        (lambda p, map: symosc.grazing_start(p, map, 1), "mapping"),
        (lambda p, map: symosc.is_grazing(p, map, 0, 1), "mapping"),
        (lambda p, map: symosc.grazing_curve(p, map), "mapping"),
        (lambda p, map: symosc.solve_grazing(p, map, x_i=4), "mapping"),
        (lambda p, map: symosc.values_containing(p, map, "Omega", 1), "mapping"),
        (lambda p, map: symosc.values_empty(p, map, "Omega"), "mapping"),
        (lambda p, map: symosc.values_everything(p, map, "Omega"), "mapping"),
        (lambda p, map: symosc.plot.sweep_figure(p, map, "Omega"), "mapping"),
        (lambda p, map: symosc.residual(p, map, (0, 1), (0, 2)), "label"),
        (lambda p, map: symosc.jacobian(p, map, (0, 1), (0, 2)), "label"),
        (lambda p, map: symosc.parameter_jacobian(p, map, (0, 1), (0, 2)), "label"),
        (lambda p, map: symosc.solve_map(p, map, 0, 1), "label"),
    ],
)
def test_a_mapping_at_a_belt_that_is_not_there_is_refused(
    call: Callable[[Any, str], Any], name: str, mapping: str
) -> None:
    scene = Scene("mine", CROSSING, 0, 1, 0, 9)  # type: ignore[arg-type]
    for what in (CROSSING, scene, OtherModel(m=1, k=1, Omega=2, FN=1, B0=1)):
        message = refused(lambda what=what: call(what, mapping), name)  # type: ignore[misc]
        assert message is None or "there is one belt" in message


def test_borders_and_planes_name_the_mappings_of_one_belt(tmp_path: Path) -> None:
    """A file of a plane states two belts, so that it is verified as before."""
    one = CROSSING.replace(Omega=1, FN="2/5", mu1=1)
    branch = symosc.continue_orbit(one, "B1 A1", "FN", ("0.3", "0.99"))
    over = {"FN": ("0.5", "0.99"), "Omega": ("0.98", "1.02")}
    border = symosc.continue_border(branch, 1, "Omega", over, step="0.1")
    words = ("B1∘A1", "S1∘B1∘S1∘A1")
    assert border.words == border.words_beside(1) == words
    assert "B1∘A1 | S1∘B1∘S1∘A1" in repr(border)
    assert border.as_dict()["words"] == list(words)
    plane = symosc.atlas(one, over, workers=1, path=tmp_path / "plane.json")
    assert {region.word for region in plane.regions} == set(words)
    assert plane.word_at(FN="0.6", Omega=1) == words[0]
    assert [set(curve.words) for curve in plane.borders] == [set(words)]
    assert '"P32"' in (tmp_path / "plane.json").read_text()
