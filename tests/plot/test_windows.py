"""Figures of windows: the given value is inside the frame, equality is named, nothing has an empty scale."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from matplotlib.axes import Axes

from symosc import ParameterError, Parameters, grazing_curve, grazing_window, load_scene, plot
from symosc.plot.curve import draw_plane

FIG9 = load_scene("fig9").parameters
MAPS = ("P2", "P3", "P5", "P6")


def parameters(rng: random.Random) -> Parameters:
    v1 = Fraction(rng.randint(-20, 20), 3)
    changes = {"B0": rng.randint(-9, 9), "k": rng.randint(0, 8), "Omega": Fraction(rng.randint(1, 30), 4)}
    return FIG9.replace(v1=v1, v2=v1 + Fraction(rng.randint(1, 30), 7), **changes)


def given_line(ax: Axes) -> float:
    (line,) = [line for line in ax.lines if line.get_label() == "given value"]
    return float(line.get_xdata()[0])  # type: ignore[index]


@pytest.mark.slow
@pytest.mark.parametrize("mapping", MAPS)
def test_the_given_value_is_inside_the_frame(mapping: str) -> None:
    """By default, and where the range that is asked for ends at the value."""
    rng = random.Random(mapping)
    for _ in range(6):
        p = parameters(rng)
        name = rng.choice(["Omega", "B0", "k", "v1" if mapping in ("P2", "P3") else "v2"])
        value, reach = getattr(p, name), Fraction(rng.randint(1, 20), 3)
        for low, high in ((None, None), (value - reach, value), (value, value + reach)):
            try:
                (ax,) = plot.sweep_figure(p, mapping, name, low, high).axes
            except ParameterError:  # the range leaves what Parameters allows
                assert low is not None
                continue
            assert given_line(ax) == pytest.approx(float(value))
            left, right = ax.get_xlim()
            assert min(value - left, right - value) > 0.015 * (right - left), (p, name, low, high)


def test_a_value_outside_the_range_is_not_drawn() -> None:
    (ax,) = plot.sweep_figure(FIG9, "P2", "Omega", 5, 6).axes
    assert ax.get_xlim() == (5, 6)
    assert not [line for line in ax.lines if line.get_label() == "given value"]


def test_phases_at_equality_are_named_in_the_legend() -> None:
    for order, label in (("full", "belongs to it"), ("paper", "does not belong to it")):
        drawing = plot.sweep_figure(FIG9, "P2", "Omega", order=order)
        assert label in [text.get_text() for text in drawing.legends[0].get_texts()]


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["fig8", "fig9"])
def test_where_nothing_is_drawn_there_is_no_scale(name: str) -> None:
    p = load_scene(name).parameters
    windows = [grazing_window(p, mapping) for mapping in MAPS]
    drawing = plot.window_figure(windows, lambda ax, w: draw_plane(ax, grazing_curve(p, w.mapping, 40)))
    empty = 0
    for ax in drawing.axes:
        if not ax.lines and not ax.collections:
            empty += 1
            assert len(ax.get_yticks()) == 0
            assert ax.texts[0].get_text() in ("the window is empty", "no start on this plane grazes")
            assert ax.get_xlim() == pytest.approx((0, 2 * np.pi))
    assert empty == 2


def test_one_window_or_several() -> None:
    window = grazing_window(FIG9, "P2")
    assert len(plot.window_figure(window).axes) == 2
    assert len(plot.window_figure([window] * 3, panels="b").axes) == 3


def test_ends_of_a_curve_have_a_shape_for_each_reason() -> None:
    curve = grazing_curve(load_scene("fig8").parameters, "P3", 80)
    (ax,) = plot.figure_grazing_curve(curve, "a").axes
    looks = {
        line.get_label(): (line.get_marker(), line.get_markerfacecolor() == "white")
        for line in ax.lines
        if line.get_marker() != "None"
    }
    assert len(looks) > 1
    assert len(set(looks.values())) == len(looks)
