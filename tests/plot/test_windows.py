"""Figures of windows: the given value is inside the frame, equality is named, nothing has an empty scale."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from matplotlib.axes import Axes

from symosc import ParameterError, Parameters, grazing_curve, grazing_window, load_scene, plot
from symosc.mappings.theorem7_cases import EVERYTHING
from symosc.plot.curve import draw_plane
from symosc.plot.windows import INSIDE_COLOR, TURN

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


@pytest.mark.quick(2)
@pytest.mark.parametrize("mapping", MAPS)
def test_what_is_drawn_thick_is_in_the_window(mapping: str) -> None:
    """Sampled against `contains`, in exact numbers; the places x_m from F = 0 itself."""
    rng = random.Random(mapping)
    dots = 0
    for _ in range(8):
        p = parameters(rng)
        window = grazing_window(p, mapping)
        circle, contacts = plot.window_figure(window).axes
        thick = {ax: [line for line in ax.lines if line.get_color() == INSIDE_COLOR] for ax in (circle, contacts)}
        arcs = [np.asarray(line.get_xydata()) for line in thick[circle] if line.get_marker() == "None"]
        shown = [np.arctan2(arc[:, 1], arc[:, 0]) % TURN for arc in arcs]
        assert all(window.contains(float(theta)) for part in shown for theta in part[2:-2:60])
        length = sum(np.unwrap(np.arctan2(arc[:, 1], arc[:, 0]))[[0, -1]] @ [-1, 1] for arc in arcs)
        assert length == pytest.approx(sum(high - low for low, high, *_ in window.intervals))
        for ax, (across, up) in ((circle, ("cos", "sin")), (contacts, ("theta", "x"))):
            for dot in [line for line in thick[ax] if line.get_marker() == "o"]:
                (place,) = np.asarray(dot.get_xydata())
                theta = (np.arctan2(place[1], place[0]) if up == "sin" else place[0]) % TURN
                speed = float(p.v1 if mapping in ("P2", "P3") else p.v2)
                assert np.sin(theta) == pytest.approx(-float(p.k) * speed / float(p.B0 * p.Omega), abs=1e-9)
                full = dot.get_markerfacecolor() == INSIDE_COLOR
                assert full == (window.kind == EVERYTHING), across
                dots += 1
        if p.k:
            speed = p.v1 if mapping in ("P2", "P3") else p.v2
            friction = {"P2": 1, "P3": 2, "P5": 2, "P6": 3}[mapping]
            constant = p.A0 - p.c * speed + {1: p.mu1 + p.mu2, 2: p.mu2 - p.mu1, 3: -p.mu1 - p.mu2}[friction] * p.FN
            for line in [line for line in contacts.lines if len(line.get_xydata()) > 2]:  # type: ignore[arg-type]
                theta, x = np.asarray(line.get_xydata()).T
                assert x == pytest.approx((float(constant) + float(p.B0) * np.cos(theta)) / float(p.k), abs=1e-9)
    assert dots


def test_a_free_place_is_told_by_bands() -> None:
    window = grazing_window(FIG9.replace(k=0), "P2")
    (contacts,) = plot.window_figure(window, panels="b").axes
    bands = sorted((patch.get_x(), patch.get_width()) for patch in contacts.patches)  # type: ignore[attr-defined]
    assert np.array(bands) == pytest.approx(np.array([(low, high - low) for low, high, *_ in window.intervals]))
