"""Marks of figures: shapes that need no colour, the belt that each belongs to, and sizes that leave room."""

from __future__ import annotations

import random
from functools import cache

import numpy as np
import pytest
from matplotlib.axes import Axes
from problems import ordinary

from symosc import Trajectory, plot, simulate
from symosc.plot.panels import SHAPES, view_of


@cache
def random_motions(count: int) -> list[Trajectory]:
    """Return motions of random oscillators with events at both belts."""
    rng = random.Random(14)
    found: list[Trajectory] = []
    while len(found) < count:
        p, start = ordinary(rng)
        motion = simulate(p, **start, max_events=100)
        if {event.boundary for event in motion.events} == {1, 2}:
            found.append(motion)
    return found


def marks(ax: Axes) -> dict[str, np.ndarray]:
    """Return the places of all marks by label."""
    lines = [line for line in ax.lines if line.get_marker() != "None"]
    found = {str(line.get_label()): np.column_stack(line.get_data()) for line in lines}
    return {label: places for label, places in found.items() if label in SHAPES}


@pytest.mark.quick(3)
@pytest.mark.parametrize("number", range(4))
@pytest.mark.parametrize("boundary", [1, 2])
def test_forces_have_marks_of_their_own_belt_only(number: int, boundary: int) -> None:
    motion = random_motions(4)[number]
    kinds = {"stick": "onset of stick", "slip": "end of stick", "cross": "crossing", "graze": "grazing point"}
    (ax,) = plot.figure(motion, panels="d", boundary=boundary).axes
    for kind, label in kinds.items():
        times = {float(event.t) for event in motion.events if (event.kind, event.boundary) == (kind, boundary)}
        if label == "onset of stick" and motion.segments[0].mode == f"belt{boundary}":
            times.add(float(motion.t_start))
        assert set(marks(ax).get(label, np.empty((0, 2)))[:, 0]) == times
    # Theorem 4: while the mass sticks, the force below pushes up and the one above down. So at an onset.
    heights = [line.get_ydata() for line in ax.lines if line.get_label() == "onset of stick"]
    for height, sign in zip(heights, (1, -1), strict=False):
        assert (sign * np.asarray(height) > -1e-9).all()


def test_no_two_marks_of_one_motion_have_one_shape() -> None:
    together = ["start", "onset of stick", "end of stick", "crossing", "grazing point"]
    looks = {label: SHAPES[label][0] for label in together}
    assert looks["start"] == looks["onset of stick"]  # an open and a full circle
    assert len(set(looks.values())) == len(together) - 1
    (ax,) = plot.figure("fig5", panels="d").axes
    below, above = (next(line for line in ax.lines if line.get_label() == f"$F^{{({i})}}$") for i in (1, 2))
    assert below.get_linestyle() == "-"
    assert above.get_linestyle() == "--"
    (ax,) = plot.figure("fig5", panels="b").axes
    faces = {line.get_label(): line.get_markerfacecolor() for line in ax.lines}
    assert faces["start"] == "white"
    assert faces["onset of stick"] != "white"


@pytest.mark.slow
def test_many_marks_leave_the_motion_visible() -> None:
    """The more marks, the smaller they are: their area grows no more once they are many."""
    motion = simulate("fig9", t_end=120)
    areas = []
    for t_end in (4, 30, 60, 120):
        part = simulate("fig9", t_end=t_end)
        (ax,) = plot.figure(part, panels="b").axes
        (line,) = [line for line in ax.lines if line.get_label() == "crossing"]
        areas.append(len(line.get_xdata()) * line.get_markersize() ** 2)
    assert len(motion.events) > 100
    assert max(areas) < 1.01 * 16 * 5.6**2  # that of 16 marks in full size
    legend = plot.figure(motion, panels="b").legends[0]
    assert {handle.get_markersize() for handle in legend.legend_handles if handle.get_marker() == "^"} == {5.6}


@pytest.mark.slow
def test_ordinary_sticks_are_not_magnified() -> None:
    """In a long motion every stick is short on the axis; only one far below the others gets an inset."""
    rng, tried = random.Random(3), 0
    while tried < 3:
        p, start = ordinary(rng)
        motion = simulate(p, **(start | {"t_end": start["t0"] + 150}), max_events=300)
        sticks = [float(each.t_end - each.t_start) for each in motion.segments if each.mode.startswith("belt")]
        if len(sticks) < 6 or motion.status != "t_end":
            continue
        tried += 1
        for contact in view_of(motion, None).magnified:
            assert contact.until - contact.since < 0.1 * np.median(sticks)
    assert len(view_of(simulate("fig8", t_end=9), None).magnified) == 2


@pytest.mark.slow
def test_the_product_of_the_forces_decides() -> None:
    """It is > 0 at each crossing, < 0 inside each stick and 0 at its end (section 6)."""
    for motion, boundary in ((simulate("fig5", t_end=9), 1), *((motion, 2) for motion in random_motions(4))):
        (ax,) = plot.figure(motion, panels="g", boundary=boundary).axes
        product = next(line for line in ax.lines if str(line.get_label()).startswith("$F"))
        t, values = (np.asarray(part) for part in product.get_data())
        scale = np.abs(values).max()
        for segment in motion.segments:
            inside = (float(segment.t_start) < t) & (t < float(segment.t_end))
            if segment.mode == f"belt{boundary}":
                assert (values[inside] < 1e-9 * scale).all()
        found = marks(ax)
        assert (found.get("crossing", np.ones((1, 2)))[:, 1] > -1e-9 * scale).all()
        for time, value in found.get("end of stick", np.empty((0, 2))):
            assert value == pytest.approx(0, abs=1e-9 * scale), time


#: Panel: what is drawn across and up; F stands for the two forces.
AXES = {"a": ("t", "x"), "b": ("t", "v"), "c": ("x", "v"), "d": ("t", "F"), "e": ("x", "F"), "f": ("v", "F")}


def quantities(motion: Trajectory, t: np.ndarray) -> dict[str, np.ndarray]:
    """Return what the panels draw, from the exact motion and the equation of motion."""
    x, v = motion(t)
    return {"t": t, "x": x, "v": v}


def force(motion: Trajectory, domain: int, t: np.ndarray) -> np.ndarray:
    """Return F^(alpha), equation (13), from the parameters alone."""
    p, (x, v) = motion.parameters, motion(t)
    first, second = float(p.mu1 * p.FN), float(p.mu2 * p.FN)
    friction = {1: first + second, 2: second - first, 3: -first - second}[domain]
    drive = float(p.A0) + float(p.B0) * np.cos(float(p.Omega) * t)
    return np.asarray((drive - float(p.c) * v - float(p.k) * x + friction) / float(p.m))


@pytest.mark.quick(2)
@pytest.mark.parametrize("boundary", [1, 2])
@pytest.mark.parametrize("letter", AXES)
def test_curves_are_what_the_axes_say(letter: str, boundary: int) -> None:
    motion = random_motions(4)[boundary]
    t = view_of(motion, boundary).t
    (ax,) = plot.figure(motion, panels=letter, boundary=boundary).axes
    shown = quantities(motion, t)
    across, up = AXES[letter]
    if up == "F":
        expected = {f"$F^{{({i})}}$": force(motion, i, t) for i in (boundary, boundary + 1)}
    else:
        expected = {"mass": shown[up]}
    curves = {str(line.get_label()): line for line in ax.lines}
    for label, values in expected.items():
        assert np.asarray(curves[label].get_xdata()) == pytest.approx(shown[across], abs=1e-12)
        assert np.asarray(curves[label].get_ydata()) == pytest.approx(values, abs=1e-9)


@pytest.mark.quick(2)
@pytest.mark.parametrize("letter", "bcf")
def test_belts_are_at_their_speeds(letter: str) -> None:
    motion = random_motions(4)[0]
    view = view_of(motion, 1)
    (ax,) = plot.figure(motion, panels=letter, boundary=1).axes
    lines = [line for line in ax.lines if line.get_label() == "belt"]
    at = [float(np.asarray(line.get_xydata())[0, int(letter != "f")]) for line in lines]
    speeds = [float(motion.parameters.belt(belt)) for belt in view.belts()]
    assert at == speeds
    names = {text.get_text(): text.xy[letter != "f"] for text in ax.texts}  # type: ignore[attr-defined]
    assert names == {f"$v_{belt}$": speed for belt, speed in zip(view.belts(), speeds, strict=True)}


@pytest.mark.quick(1)
@pytest.mark.parametrize("boundary", [1, 2])
def test_sticks_are_shaded_and_jumps_of_force_joined(boundary: int) -> None:
    joined = 0
    for motion in random_motions(4):
        (ax,) = plot.figure(motion, panels="d", boundary=boundary).axes
        sticks = [each for each in motion.segments if each.mode == f"belt{boundary}"]
        shaded = sorted((patch.get_x(), patch.get_width()) for patch in ax.patches)  # type: ignore[attr-defined]
        spans = [(float(each.t_start), float(each.t_end - each.t_start)) for each in sticks]
        assert np.array(shaded) == pytest.approx(np.array(spans), abs=1e-12)
        crossings = [float(e.t) for e in motion.events if (e.kind, e.boundary) == ("cross", boundary)]
        (bars,) = ax.collections
        ends = np.array([path.vertices for path in bars.get_paths()]).reshape(-1, 4)
        heights = [[force(motion, i, np.array([t]))[0] for i in (boundary, boundary + 1)] for t in crossings]
        expected = np.array([(t, low, t, high) for t, (low, high) in zip(crossings, heights, strict=True)])
        assert ends == pytest.approx(expected.reshape(-1, 4), abs=1e-9)
        joined += len(crossings)
    assert joined
