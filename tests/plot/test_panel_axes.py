"""Axes that are measured quickly are laid out as matplotlib does it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.ticker import ScalarFormatter

from symosc import plot, simulate
from symosc.plot.panel_axes import PanelAxes

#: Figures with insets, with six panels, in one column, with long numbers, and with many marks.
FIGURES: dict[str, dict[str, Any]] = {
    "fig8": {"columns": 1, "panels": "abcd"},
    "fig5": {},
    "fig9": {"panels": "abcdefg"},
    "fig10": {"panels": "ag", "t_end": 60},
}


def places(drawing: Any) -> np.ndarray:
    """Return where all axes are once a figure is laid out."""
    drawing.draw_without_rendering()
    return np.array([axes.get_position().extents for axes in drawing.axes])


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", FIGURES)
def test_axes_are_where_matplotlib_puts_them(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    ours = places(plot.figure(name, **FIGURES[name]))
    monkeypatch.setattr(PanelAxes, "get_tightbbox", Axes.get_tightbbox)
    np.testing.assert_allclose(ours, places(plot.figure(name, **FIGURES[name])), atol=1e-9)


def test_what_changes_between_two_drawings_is_measured_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def changed() -> np.ndarray:
        drawing = plot.figure(simulate("fig5", t_end=3), panels="ab")
        places(drawing)
        drawing.axes[1].set_ylabel("two\nlines\nand a third")
        drawing.axes[0].tick_params(labelsize=30)
        return places(drawing)

    ours = changed()
    monkeypatch.setattr(PanelAxes, "get_tightbbox", Axes.get_tightbbox)
    np.testing.assert_allclose(ours, changed(), atol=1e-9)


def test_titles_give_way_to_a_power_of_ten(monkeypatch: pytest.MonkeyPatch) -> None:
    """The power stands above the axes on the left, where the letter of the panel is."""

    def in_powers() -> np.ndarray:
        drawing = plot.figure("fig5", panels="a")
        drawing.axes[0].yaxis.set_major_formatter(formatter := ScalarFormatter())
        formatter.set_powerlimits((0, 0))
        drawing.axes[0].set_title("(a)", loc="left", x=0.0)
        return places(drawing)

    ours = in_powers()
    monkeypatch.setattr(PanelAxes, "get_tightbbox", Axes.get_tightbbox)
    np.testing.assert_allclose(ours, in_powers(), atol=1e-9)


def test_each_axis_is_asked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """This is what makes it quick."""
    from matplotlib.axis import Axis

    asked, usual = [], Axis.get_tightbbox

    def noted(axis: Axis, *given: Any, **options: Any) -> Any:
        asked.append(axis)
        return usual(axis, *given, **options)

    drawing = plot.figure("fig9", panels="abc")
    monkeypatch.setattr(Axis, "get_tightbbox", noted)
    drawing.get_layout_engine().execute(drawing)
    assert len(asked) <= 1.5 * 2 * 3  # again where the second layout has other ticks
