"""What the page shows is what symosc.simulate and symosc.grazing_window say, and no input makes it fail."""

from __future__ import annotations

import json
import random
from math import hypot, pi

import numpy as np
import pytest
from explorer_states import FIG5, random_state

from symosc import grazing_window, load_scene, scene_names, simulate
from symosc.plot.explorer.answer import MOST_SHOWN_EVENTS, RINGS, TABLE_ROWS, answer
from symosc.plot.explorer.inputs import FIELDS, link_of, scene_of, state_of

STATES = [state_of(load_scene(name)) for name in ("fig5", "fig6", "fig8", "fig9", "fig10", "fig7-exact")]
STATES += [random_state(random.Random(seed)) for seed in range(12)]
BAD_TEXTS = [
    "",
    "0",
    "-1",
    "1e50",
    "1e-50",
    "1e51",
    "nan",
    "inf",
    "1/0",
    "½",
    "1_000",
    "<b>",
    "0x10",
    "é" * 90,
    "9" * 5000,
]


def shown(state: dict[str, str]) -> dict:
    content = answer(link_of(state), FIG5)
    assert content["errors"] == {}, content["errors"]
    return json.loads(json.dumps(content, allow_nan=False))


@pytest.mark.parametrize("state", STATES[::3])
def test_word_and_events_are_those_of_simulate(state: dict[str, str]) -> None:
    content, trajectory = shown(state), simulate(scene_of(state)[0], max_events=MOST_SHOWN_EVENTS)
    assert (content["word"], content["status"]) == (trajectory.word, trajectory.status)
    assert content["count"] == len(trajectory.events)
    for row, event in zip(content["table"], trajectory.events[:TABLE_ROWS], strict=True):
        assert (row[0], row[5]) == (event.kind, str(event.boundary))
        assert [float(text) for text in row[1:4]] == pytest.approx([event.t, event.x, event.v], rel=1e-7, abs=1e-8)
    marks = content["sources"]["marks"]
    assert marks["t"][1:] == pytest.approx([event.t for event in trajectory.events], rel=1e-8)
    shapes = {"stick": "circle", "slip": "square", "cross": "triangle", "graze": "star"}
    assert marks["marker"][1:] == [shapes[event.kind] for event in trajectory.events]


@pytest.mark.parametrize("state", STATES[1::3])
def test_curves_are_the_motion_and_its_forces(state: dict[str, str]) -> None:
    content, trajectory = shown(state), simulate(scene_of(state)[0], max_events=MOST_SHOWN_EVENTS)
    curves, ranges = content["sources"]["curves"], content["ranges"]
    t = np.clip(curves["t"], trajectory.t_start, trajectory.t_end)
    expected = {"x": trajectory(t)[0], "v": trajectory(t)[1]}
    expected |= {f"F{domain}": trajectory.force(domain, t) for domain in (1, 2, 3)}
    for name, values in expected.items():
        assert curves[name] == pytest.approx(values, abs=1e-5 * max(np.ptp(values), 1e-3 * np.abs(values).max()))
        low, high = ranges["F" if name[0] == "F" else name]
        assert low <= min(curves[name]) <= max(curves[name]) <= high
    sticks = content["sources"]["sticks"]
    on_belts = [segment for segment in trajectory.segments if segment.mode.startswith("belt")]
    assert sticks["since"] == pytest.approx([segment.t_start for segment in on_belts], rel=1e-8)
    assert sticks["until"] == pytest.approx([segment.t_end for segment in on_belts], rel=1e-8)
    assert len(set(sticks["shade"])) == len({segment.mode for segment in on_belts})


@pytest.mark.parametrize("state", STATES[2::3])
def test_the_dial_has_the_windows(state: dict[str, str]) -> None:
    content, scene = shown(state), scene_of(state)[0]
    assert scene is not None
    arcs = content["sources"]["arcs"]
    for row in content["windows"]:
        window = grazing_window(scene.parameters, row["map"])
        mine = [i for i, name in enumerate(arcs["map"]) if name == row["map"]]
        length = sum(arcs["high"][i] - arcs["low"][i] for i in mine)
        assert length == pytest.approx(sum(high - low for low, high, *_ in window.intervals))
        assert len(mine) <= 1  # through the phase 0 as well
        assert (row["phases"] == "none") == (not mine)
        for i in mine:
            assert arcs["radius"][i] == RINGS[window.place.boundary]
            middle = (arcs["low"][i] + arcs["high"][i]) / 2 % (2 * pi)
            assert window.contains(middle) or length > 6.28
    contacts = content["sources"]["contacts"]
    phases = np.arctan2(contacts["y"], contacts["x"]) % (2 * pi)
    assert phases == pytest.approx(np.array(contacts["phase"]) % (2 * pi), abs=1e-9)
    assert {round(hypot(x, y), 2) for x, y in zip(contacts["x"], contacts["y"], strict=True)} <= {0.47, 0.85}


def test_belts_that_are_far_away_are_named_at_the_edge() -> None:
    near, far = shown(state_of(FIG5)), shown(state_of(FIG5) | {"v2": "100"})
    assert near["belts"]["drawn"] == [True, True]
    assert [text for _, text in near["belts"]["names"]] == ["belt 1", "belt 2"]
    assert far["belts"]["drawn"] == [True, False]
    assert "↑ belt 2" in " ".join(text for _, text in far["belts"]["names"])
    assert all(low <= far["ranges"]["v"][1] for low, _ in far["belts"]["names"])
    together = shown(state_of(FIG5) | {"v2": "1.001"})["belts"]["names"]
    assert [text for _, text in together] == ["belt 2\nbelt 1"]


def test_many_events_end_the_picture_and_it_says_so() -> None:
    state = state_of(load_scene("fig10")) | {"periods": "100"}
    content = shown(state)
    assert (content["status"], content["count"], len(content["table"])) == ("max_events", MOST_SHOWN_EVENTS, TABLE_ROWS)
    assert any("show fewer periods" in note for note in content["notes"])
    assert len(content["sources"]["curves"]["t"]) < 8000


def test_what_doubles_cannot_decide_is_said() -> None:
    content = shown(state_of(load_scene("fig8")) | {"periods": "30"})
    assert content["status"] == "undecidable"
    assert "cannot be decided" in content["message"]
    assert "--digits" in content["message"]


def test_a_mass_that_never_moves_is_drawn() -> None:
    content = shown(state_of(FIG5) | {"A0": "0", "B0": "0", "v1": "-1", "mu1": "0", "mu2": "0"})
    assert (content["status"], content["count"], content["word"]) == ("equilibrium", 0, [])
    assert set(content["sources"]["curves"]["x"]) == {0.0}
    assert all(low < high for low, high in content["ranges"].values())


def test_notes_say_what_is_special_about_the_start() -> None:
    assert "known to ±0, ±5e-45, ±5e-45" in shown(state_of(load_scene("fig7-exact")))["notes"][0]
    assert "starts with a stick on belt 2" in shown(state_of(load_scene("fig6")))["notes"][0]


def test_no_input_makes_it_fail() -> None:
    rng = random.Random(3)
    for _ in range(60):
        changes = {name: rng.choice(BAD_TEXTS) for name in rng.sample(list(FIELDS), rng.randint(1, 3))}
        content = answer(link_of(state_of(FIG5) | changes), FIG5)
        json.dumps(content, allow_nan=False)
        assert content["errors"] or content["count"] >= 0
        assert all(said and "\n" not in said for said in content["errors"].values())


@pytest.mark.parametrize("query", ["", "&&&", "=", "k", "k=", "scene=<script>", "%ff=%ff", "start_error=1", "k=1&k=2"])
def test_no_link_makes_it_fail(query: str) -> None:
    content = answer(query, FIG5)
    json.dumps(content, allow_nan=False)
    assert content["link"].startswith("scene=")


def test_all_scenes_are_shown() -> None:
    for name in scene_names():
        assert shown(state_of(load_scene(name)))["name"] == name
