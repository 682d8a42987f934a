"""The checker of branches proves again what is proven, and refuses what is false."""

from __future__ import annotations

import copy
import json
import random
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from branch_mutants import BRANCH_CHANGES, HARMLESS, branch_is_true

import symosc.certificates.verify_orbits as checker
from symosc import certify, continue_orbit, find_orbit, load_scene
from symosc.certificates.orbit_list import listed_orbits, task_of
from symosc.model import PARAMETER_NAMES

#: Ends at the birth of a stick, at a graze; the end of the range.
SHORT = {"stick": ("fig9", "3.28", "3.2885766", "3.2885765"), "graze": ("fig9", "5.017619656", "5.1", "5.0176196565")}
#: Changes that need an end that is not that of the range.
AT_AN_END = {"at moved", "inequality"}
SHORT |= {"sticks": ("fig10", "1.74", "1.76", "1.75")}


@cache
def document(name: str) -> str:
    scene, low, high, begin = SHORT[name]
    problem = load_scene(scene)
    branch = continue_orbit(problem.parameters.replace(Omega=begin), problem.structure, "Omega", (low, high))
    found = certify(branch)
    assert found.proven, found.message
    return json.dumps(found.as_dict())


def judged(content: Any, tmp_path: Path) -> tuple[int, str]:
    path = tmp_path / "branch.json"
    if isinstance(content, dict):  # the message is checked last of all: see test_format.py
        content = {name: value for name, value in content.items() if name != "message"}
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return checker.verify(str(path))


@pytest.mark.parametrize(
    "name", ["sticks", *(pytest.param(each, marks=pytest.mark.slow) for each in ("stick", "graze"))]
)
def test_a_branch_is_proven_again(name: str, tmp_path: Path) -> None:
    code, line = judged(document(name), tmp_path)
    assert code == 0, line


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("scene", "low", "high", "ends"),
    [("fig9", "3", "6", ("birth of a stick", "grazing")), ("fig10", "1.7", "3", ("end of the range", "grazing"))],
)
def test_the_branches_of_the_paper_are_proven_again(
    scene: str, low: str, high: str, ends: tuple[str, ...], tmp_path: Path
) -> None:
    problem = load_scene(scene)
    found = certify(continue_orbit(problem.parameters, problem.structure, "Omega", (low, high)))
    assert tuple(end["kind"] for end in found.statement["ends"]) == ends
    code, line = judged(found.as_dict(), tmp_path)
    assert code == 0, line


@pytest.mark.parametrize("change", random.Random(17).sample(sorted(BRANCH_CHANGES.keys() - AT_AN_END), 8))
def test_a_changed_branch_is_proven_only_if_it_is_still_true(change: str, tmp_path: Path) -> None:
    judge_branches(change, tmp_path, 1, ("sticks",))


@pytest.mark.campaign
@pytest.mark.parametrize("change", BRANCH_CHANGES)
def test_many_changed_branches(change: str, tmp_path: Path) -> None:
    judge_branches(change, tmp_path, 3, tuple(SHORT))


def judge_branches(change: str, tmp_path: Path, count: int, names: tuple[str, ...]) -> None:
    rng = random.Random(f"{change} {count}")
    for _ in range(count):
        original = json.loads(document("stick" if change in AT_AN_END else rng.choice(names)))
        changed = copy.deepcopy(original)
        BRANCH_CHANGES[change](rng, changed)
        code, line = judged(changed, tmp_path)
        if code == 0 and changed != original:
            assert change in HARMLESS, (change, line)
            assert branch_is_true(changed, original), (change, line)


@pytest.mark.parametrize("name", ["events", "word", "periods", "parameters", "parameter", "range", "ends", "boxes"])
def test_what_is_missing_or_nonsense_is_one_line(name: str, tmp_path: Path) -> None:
    whole = json.loads(document("sticks"))
    assert judged({key: value for key, value in whole.items() if key != name}, tmp_path)[0] == 2
    for nonsense in (7, "x", [], {}, [None], ["x", "y"], [[]]):
        code, line = judged(whole | {name: nonsense}, tmp_path)
        assert (code >= 1, len(line.splitlines())) == (True, 1), (nonsense, line)


def test_boxes_that_leave_the_orbit_out_are_refused(tmp_path: Path) -> None:
    """An orbit is near each box, but not in it."""
    whole = json.loads(document("sticks"))
    for row in whole["boxes"]:
        row["x"] = [[str(Fraction(end) + Fraction(1, 10**4)) for end in ends] for ends in row["x"]]
    assert judged(whole, tmp_path)[0] == 1


def random_branches(seed: str, count: int) -> list[Any]:
    """Return branches of listed orbits in parameters drawn at random, certified."""
    rng, found = random.Random(seed), []
    while len(found) < count:
        orbit, name = rng.choice(listed_orbits()), rng.choice(PARAMETER_NAMES)
        value = getattr(orbit.p, name)
        width = abs(value) * Fraction(rng.choice([1, 5, 20]), 1000)
        if len(orbit.word) > 7 or not width:
            continue
        start = find_orbit(orbit.p, orbit.word, [(t, x) for t, x in task_of(orbit).near])
        found.append(certify(continue_orbit(orbit.p, orbit.word, name, (value - width, value + width), start)))
    return found


@pytest.mark.campaign
def test_branches_in_all_parameters_are_proven_again(tmp_path: Path) -> None:
    for found in random_branches("17", 30):
        if found.proven:
            assert judged(found.as_dict(), tmp_path)[0] == 0, found.message


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["c", "k", "m"])
def test_a_branch_through_critical_damping_is_proven(name: str, tmp_path: Path) -> None:
    orbit = next(each for each in listed_orbits() if each.regime == "critically damped" and len(each.word) < 5)
    value = getattr(orbit.p, name)
    start = find_orbit(orbit.p, orbit.word, [(t, x) for t, x in task_of(orbit).near])
    ends = (value * Fraction(99, 100), value * Fraction(101, 100))
    found = certify(continue_orbit(orbit.p, orbit.word, name, ends, start))
    assert found.proven, found.message
    assert judged(found.as_dict(), tmp_path)[0] == 0
