"""What is swept and how: axes and tables, the plan and its calls, the columns of the result."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from bad_values import NO_NUMBERS, refused
from small_sweeps import OPTIONS, OVER, identical

import symosc
from symosc import load_scene, sweep
from symosc.sweeps.plan import SweepPlan, read_axis, read_coordinates, read_duration, read_plan

pytest.importorskip("xarray")
FIG9 = load_scene("fig9")


@pytest.mark.parametrize("seed", range(3))
def test_cells_are_all_combinations_in_c_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    axes = {
        name: rng.uniform(1, 20, rng.integers(1, 6)) for name in rng.permutation(["k", "FN", "x0"])
    }
    plan = planned(over=axes)
    assert plan.sizes == {name: len(values) for name, values in axes.items()}
    mesh = np.meshgrid(*axes.values(), indexing="ij")
    begin, end = sorted(rng.integers(0, len(plan) + 1, 2))
    for (name, column), expected in zip(plan.cells(begin, end).items(), mesh, strict=True):
        assert np.array_equal(column, expected.ravel()[begin:end]), name


@pytest.mark.parametrize("seed", range(3))
def test_even_values_are_the_doubles_nearest_to_the_exact_ones(seed: int) -> None:
    rng = np.random.default_rng(seed)
    low = Fraction(int(rng.integers(-99, 99)), 7)
    high = Fraction(int(rng.integers(100, 900)), 3)
    count = 17
    exact = [low + (high - low) * i / (count - 1) for i in range(count)]
    assert read_axis("A0", f"{low}:{high}:{count}").tolist() == [float(value) for value in exact]


def test_a_table_has_a_row_for_each_set() -> None:
    rows = [{"Omega": 3, "FN": "1/3"}, {"Omega": "3.5", "FN": 2}, {"Omega": 3, "FN": 2}]
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"Omega": [3.0, 3.5, 3.0], "FN": [1 / 3, 2.0, 2.0]})
    for table in (rows, frame):
        plan = planned(over=table)
        assert plan.sizes == {"set": 3}
        assert plan.cells(1, 3)["Omega"].tolist() == [3.5, 3]
        assert plan.cells(0, 1)["FN"].tolist() == [1 / 3]


@pytest.mark.parametrize("value", NO_NUMBERS[:6], ids=lambda value: repr(value)[:20])
def test_what_is_no_number(value: Any) -> None:
    refused(lambda: read_axis("FN", [1, value]), "FN")
    refused(lambda: read_coordinates(FIG9, [{"FN": value}]), "FN")


@pytest.mark.parametrize("starts", [5, [], [1, 2], [(1, 2)], [[(1, 2, 3)]], "abc", [(1, 2), (3,)]])
def test_what_are_no_starts(starts: Any) -> None:
    refused(lambda: planned(over={"FN": [1]}, starts=starts), "starts")
    refused(lambda: planned(over={"x0": [1]}, starts=[(0, 0, 0), (0, 0, 1)]), "starts")
    rows = [{"v1": 0, "v2": 1}, {"v1": 3, "v2": 4}]  # they are judged one by one
    assert read_coordinates(FIG9, rows)["v1"].values.tolist() == [0, 3]


def planned(scene: Any = FIG9, over: Any = None, **options: Any) -> SweepPlan:
    arguments = {"record": "word", "t_end": "9T", "skip": 0, "starts": None} | options
    if over is None:
        over = {"FN": [1, 2], "Omega": "3:4:3"}
    return read_plan(scene, over, *arguments.values())


@pytest.mark.parametrize("given", ["T", "-1T", "9 periods", "", None, [], "1e12T", True])
def test_what_is_no_time(given: Any) -> None:
    refused(lambda: read_duration("t_end", given), "t_end")


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
        (ROWS, {"record": ("x", "v"), "skip": "1/3T"}),
        ({"k": [2, 3]}, {"starts": [(0, "1/3", 0), (0, 1, 2)], "record": "x"}),
        ({"FN": np.linspace(1, 2, 7)}, {"record": "section:3", "t_end": "9T"}),
    ],
)
def test_the_call_gives_the_same_bits(over: Any, options: Any) -> None:
    dataset = sweep(load_scene("fig9"), over, **options)
    identical(again(dataset), dataset)


def test_the_scenes_exact_numbers_and_error_are_in_the_call() -> None:
    scene = load_scene("fig7-exact")
    dataset = sweep(scene, {"FN": [float(scene.parameters.FN)]}, t_end="1T")
    assert symosc.base.exact.show(scene.x0) in dataset.attrs["call"]
    assert scene.start_error is not None
    assert "start_error=" in dataset.attrs["call"]
    identical(again(dataset), dataset)
