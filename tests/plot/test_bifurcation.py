"""Bifurcation diagrams and curves: what is drawn is what was recorded."""

from __future__ import annotations

import numpy as np
import pytest
from bad_values import refused
from matplotlib.figure import Figure
from small_sweeps import made_up

from symosc import plot

pytest.importorskip("xarray")
OVER = {"Omega": "1:6:40"}


def section(cells: dict[str, np.ndarray]) -> np.ndarray:
    return cells["Omega"][:, None, None] * np.array([[1, 2], [3, 4], [5, 6]])


@pytest.mark.parametrize(("component", "factors"), [("x", [1, 3, 5]), ("v", [2, 4, 6])])
def test_a_point_for_each_recorded_period(component: str, factors: list[int]) -> None:
    axes = plot.bifurcation_figure(made_up(OVER, section=section), component).axes[0]
    points = np.asarray(axes.collections[0].get_offsets())
    assert len(points) == 120
    assert sorted({round(float(y / x)) for x, y in points}) == factors
    assert axes.get_xlim() == (1, 6)


def test_several_starts_lie_over_each_other() -> None:
    dataset = made_up({"Omega": [1, 2]}, starts=[(0, 0, 0), (0, 1, 0)], section=section)
    points = np.asarray(plot.bifurcation_figure(dataset).axes[0].collections[0].get_offsets())
    assert len(points) == 12


def test_numbers_are_a_curve_and_words_are_levels() -> None:
    dataset = made_up(
        OVER, stuck=lambda cells: cells["Omega"] / 6, word=lambda cells: np.where(cells["Omega"] > 3, "P32", "")
    )
    (line,) = plot.curve_figure(dataset).axes[0].lines
    assert np.array_equal(line.get_ydata(), dataset.stuck.values)
    axes = plot.curve_figure(dataset, "word").axes[0]
    assert [text.get_text() for text in axes.get_yticklabels()] == ["no event", "$P_{32}$"]


def test_what_is_refused() -> None:
    dataset = made_up(OVER | {"k": [1, 2]}, section=section, sticks=lambda cells: cells["k"].astype(int))
    refused(lambda: plot.bifurcation_figure(dataset), "dataset")
    refused(lambda: plot.bifurcation_figure(dataset.isel(k=0), "z"), "component")
    refused(lambda: plot.bifurcation_figure(dataset[["sticks", "status"]].isel(k=0)), "name")
    refused(lambda: plot.curve_figure(dataset, "sticks"), "dataset")
    drawing = Figure()
    axes = drawing.add_subplot()
    assert plot.bifurcation_figure(dataset.isel(k=0), ax=axes) is drawing
