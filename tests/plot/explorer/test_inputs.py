"""The page's texts: a link and a scene file bring all of them back, and what is wrong is said for each."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from math import isclose, tau

import pytest
from explorer_states import FIG5, random_state

from symosc import load_scene, scene_names
from symosc.plot.explorer.inputs import FIELDS, MOST_SHOWN_PERIODS, link_of, read_link, scene_of, state_of
from symosc.scenes import START_NAMES, as_toml, read_scene


@pytest.mark.parametrize("name", scene_names())
def test_a_shipped_scene_comes_back_whole(name: str) -> None:
    scene = load_scene(name)
    state, notes = read_link(link_of(state_of(scene)), FIG5)
    assert (scene_of(state), notes) == ((scene, {}), [])
    assert scene_of(state_of(read_scene(as_toml(scene), "file"))) == (scene, {})


def test_a_link_and_a_file_have_the_whole_state() -> None:
    rng = random.Random(1)
    for _ in range(60):
        state = random_state(rng)
        scene, errors = scene_of(state)
        assert scene is not None, (state, errors)
        assert read_link(link_of(state), FIG5) == (state, [])
        again, _ = scene_of(state_of(read_scene(as_toml(scene), "file")))
        assert again == scene
        for field in FIELDS:
            assert field == "periods" or Fraction(state_of(scene)[field]) == Fraction(state[field].strip())


def test_the_end_is_so_many_periods_after_the_start() -> None:
    rng = random.Random(2)
    for _ in range(60):
        state = random_state(rng) | {
            "t0": rng.choice(["0", "1e8", "1/3", "-7.5"]),
            "Omega": f"{10 ** rng.uniform(-6, 6):.4g}",
        }
        scene, _ = scene_of(state)
        assert scene is not None
        wanted = float(Fraction(state["periods"].strip()))
        assert isclose(float((scene.t_end - scene.t0) * scene.parameters.Omega), wanted * tau, rel_tol=1e-11)
        assert float(state_of(scene)["periods"]) == pytest.approx(wanted, rel=1e-11)


def test_everything_that_is_wrong_is_said_at_once() -> None:
    wrong = {"m": "0", "c": "", "k": "pi", "FN": "1/0", "mu1": "-1", "Omega": "x", "v1": "9", "v2": "8", "periods": "0"}
    scene, errors = scene_of(state_of(FIG5) | wrong)
    assert scene is None
    assert set(errors) == set(wrong) - {"v2"}
    assert errors["m"] == "must be > 0"
    assert errors["v1"] == "must be less than v2 = 8"
    assert "expression" in errors["k"]
    assert "not a number" in errors["c"]


@pytest.mark.parametrize("text", ["0", "-1", str(MOST_SHOWN_PERIODS + 1), "1e400", "nan", "1e-40000"])
def test_a_number_of_periods_that_no_picture_shows(text: str) -> None:
    scene, errors = scene_of(state_of(FIG5) | {"periods": text})
    assert scene is None
    assert list(errors) == ["periods"]


@pytest.mark.parametrize("text", ["1", "1,2", "a,b,c", "-1,0,0", ",,"])
def test_a_wrong_error_of_the_start(text: str) -> None:
    scene, errors = scene_of(state_of(FIG5) | {"start_error": text})
    assert scene is None
    assert list(errors) == ["start_error"]


def test_a_scene_that_was_changed_has_another_name() -> None:
    state = state_of(FIG5) | {"k": "1.01"}
    scene, _ = scene_of(state)
    assert scene is not None
    assert scene.name == "fig5, changed"
    assert scene_of(state_of(scene))[0] == scene
    assert scene_of(state_of(scene) | {"k": "1.00"})[0] == FIG5
    assert scene_of(state | {"scene": "  "})[0] == replace(scene, name="explored")


def test_a_link_may_have_some_numbers_only() -> None:
    state, notes = read_link("k=4%2F5&velocity=3&t0=1", load_scene("fig9-orbit"))
    scene, _ = scene_of(state)
    assert scene is not None
    assert (scene.parameters.k, scene.t0, scene.x0) == (Fraction(4, 5), 1, load_scene("fig9-orbit").x0)
    assert scene.start_error is None  # it was that of another start
    assert len(notes) == 1
    assert "'velocity'" in notes[0]


@pytest.mark.parametrize("name", ["fig9-orbit", "fig6"])
def test_a_link_may_name_a_scene(name: str) -> None:
    assert scene_of(read_link(f"scene={name}", FIG5)[0]) == (load_scene(name), {})
    changed, _ = scene_of(read_link(f"scene={name}&k=9", FIG5)[0])
    assert changed is not None
    assert changed.start_error == load_scene(name).start_error
    assert changed.parameters == load_scene(name).parameters.replace(k=9)


def test_every_number_of_a_scene_is_a_field() -> None:
    given = {*FIG5.parameters.as_dict(), *START_NAMES} - {"t_end"} | {"periods"}
    assert set(FIELDS) == given
    for field in FIELDS.values():
        assert field.low < field.high
        assert (field.high - field.low) / field.step >= 90  # fine enough to be moved with a finger
