"""The result of a sweep: coordinates, names, units, and the call that gives it again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from small_sweeps import OPTIONS, OVER, SCENE, identical, made_up

import symosc
from symosc import load_scene, sweep
from symosc.scenes.quantities import QUANTITIES
from symosc.sweeps.dataset import VARIABLES
from symosc.sweeps.grid import SWEPT_NAMES
from symosc.sweeps.motions import RECORDED

pytest.importorskip("xarray")


def test_everything_that_can_be_swept_or_recorded_is_described() -> None:
    assert {*QUANTITIES} - {"t_end"} == {*SWEPT_NAMES}
    assert {*VARIABLES} == {*RECORDED}


def test_coordinates_names_and_units() -> None:
    found = sweep(SCENE, OVER, **OPTIONS)
    assert found.word.dims == ("Omega", "FN")
    assert found.section.dims == ("Omega", "FN", "period", "component")
    assert found.component.values.tolist() == ["x", "v"]
    assert found.period.values.tolist() == [-2, -1]
    assert found.FN.values.tolist() == [5, 10, 12.5, 15]
    assert found.FN.attrs == {"long_name": "normal force", "dimension": "force"}
    assert found.events.attrs == {"long_name": "number of events", "units": "1"}
    assert "status" in found


def again(found: Any) -> Any:
    """Return what the attribute `call` of a result gives."""
    names = {name: getattr(symosc, name) for name in ("Parameters", "Scene", "sweep")}
    return eval(found.attrs["call"], names | {"dataset": found})


ROWS = [{"k": 3, "x0": "1/3"}, {"k": 0.1, "x0": -2}, {"k": 3, "x0": 0}]


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("over", "options"),
    [
        (OVER, OPTIONS),
        ({"A0": [-1, "1/3", 0.1]}, {"record": "x", "t_end": "22/7"}),
        (ROWS, {"record": ("x", "v"), "skip": "1/3T"}),
        ({"k": [2, 3]}, {"starts": [(0, "1/3", 0), (0, 1, 2)], "record": "x"}),
        ({"k": [2, 3]}, {"starts": (0, "1/3", 0), "record": "x"}),
        ({"FN": np.linspace(1, 2, 7)}, {"record": "section:3", "t_end": "9T"}),
    ],
)
def test_the_call_gives_the_same_bits(over: Any, options: Any) -> None:
    found = sweep(load_scene("fig9"), over, **options)
    identical(again(found), found)


def test_the_call_refers_to_coordinates_that_are_too_long_to_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symosc.sweeps.dataset.MOST_WRITTEN", 5)
    found = sweep("fig9", {"FN": np.linspace(1, 2, 7)}, record="x", t_end=2)
    assert "dataset['FN'].values" in found.attrs["call"]
    assert again(found).x.values.tolist() == found.x.values.tolist()


def test_the_scenes_exact_numbers_and_error_are_in_the_call() -> None:
    scene = load_scene("fig7-exact")
    found = sweep(scene, {"FN": [float(scene.parameters.FN)]}, t_end="1T")
    assert symosc.exact.show(scene.x0) in found.attrs["call"]
    assert scene.start_error is not None
    assert "start_error=" in found.attrs["call"]
    identical(again(found), found)


def test_a_result_of_columns_alone() -> None:
    found = made_up({"k": "1:2:3", "x0": "0:1:2"}, word=lambda cells: np.where(cells["k"] > 1, "P32", "P2"))
    assert found.word.values.tolist() == [["P2", "P2"], ["P32", "P32"], ["P32", "P32"]]
