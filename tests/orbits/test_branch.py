"""Branches as dictionaries."""

from __future__ import annotations

import json
from copy import copy

import numpy as np
import pytest
from branches import branch_of

from symosc import Parameters, continue_orbit, load_scene

FIG9, FIG10 = load_scene("fig9").parameters, load_scene("fig10").parameters


@pytest.mark.slow
def test_as_dict_holds_everything():
    branch = branch_of(FIG9, "P32", "Omega", (3, 5))
    data = json.loads(json.dumps(branch.as_dict()))
    assert (data["word"], data["parameter"], data["periods"]) == ("P32", "Omega", 1)
    assert Parameters(**data["parameters"]) == FIG9
    np.testing.assert_array_equal(data["values"], branch.values)
    np.testing.assert_array_equal(data["points"], branch.points)
    np.testing.assert_array_equal(np.array(data["multipliers"]) @ [1, 1j], branch.multipliers)
    assert data["stable"] == branch.stable.tolist()
    for end, shown in zip(branch.ends, data["ends"], strict=True):
        assert (shown["kind"], shown["value"], shown["message"]) == (end.kind, end.value, end.message)
        assert shown["beyond"] == end.beyond
        np.testing.assert_array_equal(shown["points"], end.points)
        assert [c["value"] for c in shown["conditions"]] == [c.value for c in end.conditions]
    assert data["ends"][0]["conditions"][0]["event"] == "birth of a stick"


def test_branches_are_equal_by_what_they_say() -> None:
    one = continue_orbit(FIG9, "P32", "Omega", (3.999, 4.0))
    two, other = copy(one), copy(one)
    other.values = one.values + 1e-9
    assert one is not two
    assert (one == two, hash(one) == hash(two)) == (True, True)
    assert one != other
    assert one != one.as_dict()
    assert one != "P32"
