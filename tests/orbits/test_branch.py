"""Branches as dictionaries."""

from __future__ import annotations

import json
from copy import copy
from dataclasses import replace

import numpy as np
import pytest
from branches import branch_of

from symosc import ParameterError, Parameters, continue_orbit, find_orbit, load_scene
from symosc.orbits.branch import Branch, BranchEnd, BranchPoint

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


@pytest.mark.slow
def test_branches_are_equal_by_what_they_say() -> None:
    one = continue_orbit(FIG9, "P32", "Omega", (3.999, 4.0))
    two, other = copy(one), copy(one)
    other.values = one.values + 1e-9
    assert one is not two
    assert (one == two, hash(one) == hash(two)) == (True, True)
    assert one != other
    assert one != one.as_dict()
    assert one != "P32"


def hand_made(rng: np.random.Generator, value: float, n: int = 2) -> BranchPoint:
    """Return a point with random switchings and multipliers."""
    both = tuple(complex(*rng.uniform(-1.2, 1.2, 2)) for _ in range(2))
    return BranchPoint(value, rng.uniform(-5, 5, (n, 2)), np.zeros(2 * n + 1), 0.0, 0.0, both, (), ())  # type: ignore[arg-type]


@pytest.mark.parametrize("parameter", ["Omega", "c"])
@pytest.mark.parametrize("c", ["0", "1/5"])
def test_columns_of_a_branch_are_those_of_its_points(parameter: str, c: str) -> None:
    """Times are phases over the drive's frequency there; stable is what damping proves, or both multipliers show."""
    rng = np.random.default_rng(3)
    orbit = replace(find_orbit(FIG9, "P32"), parameters=FIG9.replace(c=c))
    values = sorted([0.0 if parameter == "c" else 0.5, *rng.uniform(0.5, 6, 7)])
    path = [hand_made(rng, value) for value in values]
    for i, size in ((2, 0.5), (3, 1 - 1e-7), (4, 1 - 1e-10), (5, 1.0)):  # on both sides of the border
        path[i] = replace(path[i], multipliers=(0.1 + 0j, size * 1j) if i % 2 else (complex(size), -0.1 + 0j))
    ends = tuple(BranchEnd("x", 0.0, "", (), ()) for _ in range(2))
    branch = Branch(orbit, parameter, path, ends)  # type: ignore[arg-type]
    assert branch.values.tolist() == values
    for i, point in enumerate(path):
        Omega = point.value if parameter == "Omega" else 4.0
        assert branch.points[i] == pytest.approx(np.column_stack([point.points[:, 1] / Omega, point.points[:, 0]]))
        inside = all(abs(each) < 1 - 1e-9 for each in point.multipliers)
        assert branch.parameters(i) == orbit.parameters.replace(**{parameter: values[i]})
        assert branch.stable[i] == (branch.parameters(i).c > 0 or inside)
        assert branch.multipliers[i].tolist() == list(point.multipliers)
    frame, data = branch.to_pandas(), branch.to_xarray()
    points = [f"{letter}{i}" for i in (0, 1) for letter in "tx"]
    assert list(frame.columns) == [parameter, *points, "multiplier0", "multiplier1", "stable"]
    assert frame[parameter].tolist() == data[parameter].values.tolist() == values
    assert np.array_equal(frame[points].to_numpy().reshape(-1, 2, 2), branch.points)
    assert np.array_equal(frame[["multiplier0", "multiplier1"]].to_numpy(), branch.multipliers)
    assert np.array_equal(np.stack([data["t"].values, data["x"].values], axis=-1), branch.points)
    assert np.array_equal(data["multiplier_re"].values + 1j * data["multiplier_im"].values, branch.multipliers)
    assert frame["stable"].tolist() == data["stable"].values.tolist() == branch.stable.tolist()
    assert data["map"].values.tolist() == list(orbit.labels)
    assert data.attrs == {"word": "P32", "periods": 1, "ends": ["x", "x"]}
    assert branch.parameters(-1) == branch.parameters(7)
    for i in (8, -9):
        with pytest.raises(ParameterError, match=r"^i = "):
            branch.parameters(i)
