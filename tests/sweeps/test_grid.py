"""What is swept: axes and tables, their cells, and what is refused."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from bad_values import NO_NUMBERS, refused

from symosc import load_scene
from symosc.sweeps.grid import read_axis, read_grid

FIG9 = load_scene("fig9")


@pytest.mark.parametrize("seed", range(5))
def test_cells_are_all_combinations_in_c_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    axes = {name: rng.uniform(1, 20, rng.integers(1, 6)) for name in rng.permutation(["k", "FN", "x0"])}
    grid = read_grid(FIG9, axes)
    assert grid.shape == tuple(map(len, axes.values()))
    mesh = np.meshgrid(*axes.values(), indexing="ij")
    begin, end = sorted(rng.integers(0, len(grid) + 1, 2))
    for (name, column), expected in zip(grid.columns(begin, end).items(), mesh, strict=True):
        assert np.array_equal(column, expected.ravel()[begin:end]), name


@pytest.mark.parametrize(("text", "values"), [("1:6:51", [f"{1 + i / 10:.1f}" for i in range(51)])])
def test_even_values_are_the_decimals_that_one_would_write(text: str, values: list[str]) -> None:
    assert read_axis("Omega", text).tolist() == [float(value) for value in values]


@pytest.mark.parametrize("seed", range(5))
def test_even_values_are_the_doubles_nearest_to_the_exact_ones(seed: int) -> None:
    rng = np.random.default_rng(seed)
    low, high, count = Fraction(int(rng.integers(-99, 99)), 7), Fraction(int(rng.integers(100, 900)), 3), 17
    exact = [low + (high - low) * i / (count - 1) for i in range(count)]
    assert read_axis("A0", f"{low}:{high}:{count}").tolist() == [float(value) for value in exact]


def test_a_table_has_a_row_for_each_set() -> None:
    rows = [{"Omega": 3, "FN": "1/3"}, {"Omega": "3.5", "FN": 2}, {"Omega": 3, "FN": 2}]
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"Omega": [3.0, 3.5, 3.0], "FN": [1 / 3, 2.0, 2.0]})
    for table in (rows, frame):
        grid = read_grid(FIG9, table)
        assert (grid.sizes, grid.is_table()) == ({"set": 3}, True)
        assert grid.columns(1, 3)["Omega"].tolist() == [3.5, 3]
        assert grid.columns(0, 1)["FN"].tolist() == [1 / 3]


def test_several_starts_are_one_more_dimension() -> None:
    grid = read_grid(FIG9, {"FN": [1, 2]}, [(0, 1, 2), (0, 3, 4), ("1/2", 5, 6)])
    assert grid.sizes == {"FN": 2, "start": 3}
    assert grid.columns(2, 5)["x0"].tolist() == [5, 1, 3]
    assert grid.columns(2, 5)["FN"].tolist() == [1, 2, 2]


@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda value: repr(value)[:20])
def test_what_is_no_number(value: Any) -> None:
    refused(lambda: read_axis("FN", [1, value]), "FN")
    refused(lambda: read_grid(FIG9, [{"FN": value}]), "FN")


BAD_AXES: list[Any] = ["1:6", "1:6:", ":6:3", "1:6:1", "1:6:0", "1:6:-3", "1:6:2.5", "6:1:5", "1:1:5", "a:2:3", "1:2:٣"]
BAD_AXES += ["", [], 5, None, [1, 2, 1], np.zeros((2, 2)), np.array([1.0, np.nan]), b"1:2:3", {1: 2}, "1:2:9999999999"]


@pytest.mark.parametrize("values", BAD_AXES, ids=lambda value: repr(value)[:20])
def test_what_is_no_axis(values: Any) -> None:
    refused(lambda: read_axis("FN", values), "FN")


BAD_OVER: list[Any] = [
    None,
    {},
    [],
    5,
    "Omega=1:6:5",
    {"omega": [1]},
    {"t_end": [1]},
    {1: [1]},
    [{}],
    [{"FN": 1}, {"k": 1}],
]
BAD_OVER += [dict.fromkeys(("m", "c", "k", "FN"), "1:2:2"), dict.fromkeys(("m", "c", "k"), np.arange(1.0, 2000.0))]


@pytest.mark.parametrize("over", BAD_OVER, ids=lambda value: repr(value)[:20])
def test_what_cannot_be_swept(over: Any) -> None:
    refused(lambda: read_grid(FIG9, over), "over")


@pytest.mark.parametrize(
    ("over", "name"),
    [
        ({"m": [1, 0]}, "m"),
        ({"Omega": "-1:1:5"}, "Omega"),
        ({"FN": [3, -1, 2]}, "FN"),
        ({"v1": [1, 26]}, "v1"),
        ({"v2": [0.5, 30]}, "v1"),
        ({"v1": [0, 3], "v2": [2, 5]}, "v1"),
        ([{"v1": 0, "v2": 1}, {"v1": 3, "v2": 3}], "v1"),
        ([{"k": 1}, {"k": -1}], "k"),
    ],
)
def test_values_that_the_model_does_not_allow_are_found_before_the_work(over: Any, name: str) -> None:
    refused(lambda: read_grid(FIG9, over), name)


def test_rows_of_a_table_are_judged_row_by_row() -> None:
    grid = read_grid(FIG9, [{"v1": 0, "v2": 1}, {"v1": 3, "v2": 4}])
    assert len(grid) == 2


@pytest.mark.parametrize("starts", [5, [], [1, 2], [(1, 2)], [(1, 2, 3, 4)], [[(1, 2, 3)]], "abc", [(1, 2), (3,)]])
def test_what_are_no_starts(starts: Any) -> None:
    refused(lambda: read_grid(FIG9, {"FN": [1]}, starts), "starts")


def test_a_start_is_swept_in_one_place() -> None:
    refused(lambda: read_grid(FIG9, {"x0": [1]}, [(0, 0, 0), (0, 0, 1)]), "starts")
