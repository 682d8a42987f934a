"""The checker of orbits and windows refuses what is false and accepts what is true."""

from __future__ import annotations

import copy
import itertools
import json
import random
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from orbit_mutants import ORBIT_CHANGES, WINDOW_CHANGES, orbit_is_true, window_is_true

import symosc.certificates.verify_orbits as checker
from symosc import certify, find_orbit, grazing_window, load_scene
from symosc.certificates.orbit_list import listed_orbits, prove_listed

WINDOWS = tuple(itertools.product(("fig5", "fig8", "fig9"), ("P2", "P3", "P5", "P6"), ("full", "paper")))
#: Words of three kinds from the list that ships, by their places.
LISTED = (3, 40, 500)


@cache
def orbit_document(i: int) -> str:
    if i < 0:
        scene = load_scene(("fig9", "fig10")[i])
        return json.dumps(certify(find_orbit(scene.parameters, scene.structure)).as_dict())
    return json.dumps(prove_listed(listed_orbits()[i]).as_dict())


@cache
def window_document(scene: str, mapping: str, order: str) -> str:
    return json.dumps(certify(grazing_window(load_scene(scene).parameters, mapping, order)).as_dict())


def judged(content: Any, tmp_path: Path) -> tuple[int, str]:
    path = tmp_path / "certificate.json"
    if isinstance(content, dict):  # the message is checked last of all: see test_format.py
        content = {name: value for name, value in content.items() if name != "message"}
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return checker.verify(str(path))


@pytest.mark.parametrize("place", [31, 59, 583, 827])
def test_orbits_whose_multipliers_take_a_closer_look_are_proven_again(place: int, tmp_path: Path) -> None:
    """Of the list of 1,030 fifty failed: their fixed point was not known well enough for 16 places of a multiplier."""
    assert judged(orbit_document(place), tmp_path)[0] == 0


@pytest.mark.quick(7)
@pytest.mark.parametrize("change", ORBIT_CHANGES)
def test_a_changed_orbit_is_proven_only_if_it_is_still_true(change: str, tmp_path: Path) -> None:
    _judge_orbits(change, tmp_path, 4, (-2, -1))


@pytest.mark.campaign
@pytest.mark.parametrize("change", ORBIT_CHANGES)
def test_many_changed_orbits(change: str, tmp_path: Path) -> None:
    _judge_orbits(change, tmp_path, 20, (-2, -1, *LISTED))


def _judge_orbits(change: str, tmp_path: Path, count: int, orbits: tuple[int, ...]) -> None:
    rng = random.Random(f"{change} {count}")
    for _ in range(count):
        original = json.loads(orbit_document(rng.choice(orbits)))
        changed = copy.deepcopy(original)
        ORBIT_CHANGES[change](rng, changed)
        code, line = judged(changed, tmp_path)
        if code == 0:
            assert changed == original or orbit_is_true(changed, original), (line, changed)
        elif change == "box wider":
            raise AssertionError((line, changed))


@pytest.mark.quick(3)
@pytest.mark.parametrize("change", WINDOW_CHANGES)
def test_a_changed_window_is_proven_only_if_it_is_still_true(change: str, tmp_path: Path) -> None:
    rng, refused = random.Random(change), 0
    for scene, mapping, order in WINDOWS:
        changed = json.loads(window_document(scene, mapping, order))
        before = copy.deepcopy(changed)
        WINDOW_CHANGES[change](rng, changed)
        code, line = judged(changed, tmp_path)
        refused += code > 0
        if changed == before:
            assert code == 0, (line, changed)
        elif code == 0:
            assert window_is_true(changed), (line, changed)
    assert refused


def test_the_box_in_which_an_orbit_is_alone_has_to_be_proven(tmp_path: Path) -> None:
    document = json.loads(orbit_document(-1))
    for box in (["1", "1"], ["0", "0"], ["-1e-9", "1e-9"], ["1e-30", "1e-30"]):
        assert judged(document | {"alone_within": box}, tmp_path)[0] >= 1, box


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", ["events", "word", "periods", "parameters", "multipliers", "stable", "alone_within"])
def test_what_is_missing_or_nonsense_is_one_line(name: str, tmp_path: Path) -> None:
    whole = json.loads(orbit_document(-2))
    assert judged({key: value for key, value in whole.items() if key != name}, tmp_path)[0] == 2
    for nonsense in (7, "x", [], {}, [None], ["x", "y"]):
        code, line = judged(whole | {name: nonsense}, tmp_path)
        assert (code >= 1, len(line.splitlines())) == (True, 1), (nonsense, line)


def test_listed_orbits_are_proven_again(tmp_path: Path) -> None:
    for i in LISTED:
        assert judged(orbit_document(i), tmp_path)[0] == 0, i
