"""Figures: what is drawn, where the marks are, that nothing global is touched, and bad input."""

from __future__ import annotations

import random
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from effort import at_most
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from problems import ordinary

import symosc
from symosc import (
    OutputError,
    Trajectory,
    continue_orbit,
    crosscheck,
    find_orbit,
    grazing_curve,
    grazing_window,
    load_scene,
    plot,
    simulate,
)
from symosc.display.drawable import Drawable
from symosc.plot import drawing
from symosc.plot.panels import SHAPES, view_of

# -- answers, and axes of a user's own --------------------------------------------------------------------------------


P = load_scene("fig9").parameters


@cache
def answers() -> dict[str, Drawable]:
    """Return one answer of each kind that draws itself."""
    t = np.linspace(0, 3, 60)
    return {
        "trajectory": simulate("fig5", t_end=3),
        "orbit": find_orbit(P, "P32"),
        "branch": continue_orbit(P, "P32", "Omega", (3.9, 4.1)),
        "window": grazing_window(P, "P2"),
        "curve": grazing_curve(P, "P2", 40),
        "check": crosscheck("fig5", t, *simulate("fig5", t_end=3)(t)),
    }


KINDS = ["trajectory", "orbit", "branch", "window", "curve", "check"]


@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", KINDS)
def test_every_answer_draws_itself(kind: str) -> None:
    drawing = answers()[kind].plot()
    assert len(drawing.axes) > 1
    assert drawing._repr_png_().startswith(b"\x89PNG")


@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", KINDS)
def test_one_panel_goes_into_given_axes_and_nothing_else_changes(kind: str) -> None:
    before = dict(rcParams)
    drawing = Figure()
    left, right = drawing.subplots(1, 2)
    answer = answers()[kind]
    assert answer.plot(ax=right) is drawing
    assert right.lines
    assert not left.has_data()
    assert drawing.axes == [left, right]
    assert not drawing.legends
    assert dict(rcParams) == before
    assert answer.plot(panels="b", ax=left) is drawing
    assert left.has_data()
    drawing.draw_without_rendering()


@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", KINDS)
def test_axes_hold_one_panel(kind: str) -> None:
    answer, axes = answers()[kind], Figure().add_subplot()
    refused(lambda: answer.plot(panels="ab", ax=axes), "panels")
    refused(lambda: answer.plot(panels="", ax=axes), "panels")
    refused(lambda: answer.plot(panels="z"), "panels")
    for value in (3, "axes", [axes], Figure()):
        refused(lambda value=value: answer.plot(panels="a", ax=value), "ax")  # type: ignore[misc]
    assert not axes.has_data()


@pytest.mark.slow
def test_a_root_that_is_no_orbit_is_not_drawn() -> None:
    root = find_orbit(P.replace(Omega=3), "P32")
    assert not root.admissible
    assert "no motion" in refused(lambda: plot.orbit_figure(root), "orbit")


@pytest.mark.slow
def test_the_first_plot_loads_what_draws() -> None:
    code = (
        "import sys; from symosc import simulate; motion = simulate('fig5', t_end=3);"
        "assert 'matplotlib' not in sys.modules; print(len(motion.plot(panels='abc').axes))"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout == "3\n"


# -- figures of scenes ------------------------------------------------------------------------------------------------


MAGIC = {".pdf": b"%PDF-", ".svg": b"<?xml", ".png": b"\x89PNG"}
HUES = {"red": 0, "green": 1, "blue": 2}


def lines(ax: Axes, label: str) -> list[Line2D]:
    return [line for line in ax.lines if line.get_label() == label]


def dots(ax: Axes, label: str) -> np.ndarray:
    return np.concatenate([np.column_stack(line.get_data()) for line in lines(ax, label)])


@pytest.fixture(scope="module")
def fig5() -> Figure:
    return plot.figure("fig5", t_end=9)


def test_panels_axes_and_labels_of_fig5(fig5: Figure) -> None:
    displacement, velocity, phase, forces = fig5.axes
    assert [ax.get_title(loc="left") for ax in fig5.axes] == ["(a)", "(b)", "(c)", "(d)"]
    assert "$x$" in displacement.get_ylabel()
    assert "$t$" in displacement.get_xlabel()
    assert r"\dot{x}" in velocity.get_ylabel()
    assert r"\dot{x}" in phase.get_ylabel()
    assert "F^{(1)}" in forces.get_ylabel()
    assert "F^{(2)}" in forces.get_ylabel()
    assert [line.get_label() for line in forces.lines[1:3]] == ["$F^{(1)}$", "$F^{(2)}$"]
    (legend,) = fig5.legends
    names = [text.get_text() for text in legend.get_texts()]
    assert names == ["mass", "belt", "onset of stick", "end of stick", "start", "$F^{(1)}$", "$F^{(2)}$"]


def test_dots_are_at_the_events(fig5: Figure) -> None:
    trajectory = simulate("fig5", t_end=9)
    for kind, label in [("stick", "onset of stick"), ("slip", "end of stick")]:
        events = [event for event in trajectory.events if event.kind == kind]
        assert len(events) == 3
        displacement, velocity, phase, forces = fig5.axes
        np.testing.assert_allclose(dots(displacement, label), [(e.t, e.x) for e in events], rtol=0, atol=1e-12)
        np.testing.assert_allclose(dots(velocity, label), [(e.t, e.v) for e in events], rtol=0, atol=1e-12)
        np.testing.assert_allclose(dots(phase, label), [(e.x, e.v) for e in events], rtol=0, atol=1e-12)
        expected = [(e.t, trajectory.force(domain, e.t)) for domain in (1, 2) for e in events]
        np.testing.assert_allclose(dots(forces, label), expected, rtol=0, atol=1e-12)


def test_belts_move_with_the_mass_through_each_stick(fig5: Figure) -> None:
    trajectory = simulate("fig5", t_end=9)
    sticks = [segment for segment in trajectory.segments if segment.mode == "belt1"]
    belts = lines(fig5.axes[0], "belt")
    assert len(belts) == len(sticks) == 3
    for stick, belt in zip(sticks, belts, strict=True):
        t, x = belt.get_data()
        assert t[0] < stick.t_start < stick.t_end < t[1]
        assert to_hex(belt.get_color()) == "#000000"
        np.testing.assert_allclose(
            np.interp([stick.t_start, stick.t_end], t, x), trajectory([stick.t_start, stick.t_end])[0]
        )
    assert [line.get_ydata()[0] for line in lines(fig5.axes[1], "belt")] == [1, 5]  # type: ignore[index]


def test_a_graze_is_a_red_dot_with_its_belt() -> None:
    drawing = plot.figure("fig8-exact", panels="ab")
    displacement, velocity = drawing.axes
    assert dots(velocity, "grazing point") == pytest.approx(np.array([[np.pi, -4]]))
    assert len(lines(displacement, "belt")) == 1
    assert not velocity.child_axes


def test_micro_sticks_are_magnified() -> None:
    trajectory = simulate("fig8", t_end=9)
    (velocity,) = plot.figure(trajectory, panels="b").axes
    assert len(velocity.child_axes) == 2
    first = velocity.child_axes[0]
    onset, end = trajectory.events[:2]
    assert first.lines[2].get_xdata()[0] == 0  # type: ignore[index]
    assert first.lines[3].get_xdata()[0] == pytest.approx(1e3 * (end.t - onset.t))  # type: ignore[index]
    assert "10^{3}" in first.get_xlabel()
    assert "3.139006" in first.get_xlabel()
    # The insets stand above the axes, whose scale is that of the curve and the belts.
    assert velocity.get_ylim()[1] < 5
    assert all(inset.get_position().y0 > velocity.get_position().y1 for inset in velocity.child_axes)


@pytest.mark.quick(1)
@pytest.mark.parametrize("suffix", drawing.FIGURE_SUFFIXES)
def test_files_by_suffix_the_same_each_time(suffix: str, tmp_path: Path) -> None:
    paths = [plot.save(plot.figure("fig7", panels="c"), tmp_path / f"{n}{suffix}") for n in "ab"]
    first, second = (path.read_bytes() for path in paths)
    assert first.startswith(MAGIC[suffix])
    assert first == second


def test_other_suffixes_and_unwritable_paths_leave_nothing(tmp_path: Path) -> None:
    drawing = plot.figure("fig7", panels="c")
    with pytest.raises(OutputError, match=r"\.pdf, \.svg or \.png"):
        plot.save(drawing, tmp_path / "a.eps")
    with pytest.raises(OutputError, match="No such file"):
        plot.save(drawing, tmp_path / "none" / "a.pdf")
    assert list(tmp_path.iterdir()) == []


def test_where_figures_of_scenes_end() -> None:
    ends = {name: plot.simulated(load_scene(name)).t_end for name in ("fig5", "fig7", "fig10")}
    assert (ends["fig5"], ends["fig7"]) == (9, 15.1)
    orbit = load_scene("fig10")
    assert (ends["fig10"] - float(orbit.t0)) * 1.75 / (2 * np.pi) == pytest.approx(2.5)  # periods


@pytest.mark.slow
def test_digits_and_an_undecided_end_can_be_drawn() -> None:
    assert plot.figure(simulate("fig8", t_end=4, digits=30)).axes
    undecided = simulate("fig8", t_end=160)
    assert undecided.status == "undecidable"
    assert plot.figure(undecided, panels="b").axes


# -- what the panels show ---------------------------------------------------------------------------------------------


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
    drawn = [line for line in ax.lines if line.get_marker() != "None"]
    found = {str(line.get_label()): np.column_stack(line.get_data()) for line in drawn}
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
    drawn = [line for line in ax.lines if line.get_label() == "belt"]
    at = [float(np.asarray(line.get_xydata())[0, int(letter != "f")]) for line in drawn]
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


# -- bad input --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("panels", ["", "z", "aa", 5, ["a"], True, b"a", {}, "A"]),
        ("boundary", [0, 3, True, "1", [1], 1.0, np.array([1, 2])]),
        ("columns", [0, 3, True, "1", None, 1.0]),
        ("t_end", ["", "x", float("nan"), True, -1, 1j, []]),
    ],
)
def test_options_of_a_figure(name: str, values: list[Any]) -> None:
    for value in values:
        refused(lambda value=value: symosc.plot.figure("fig5", **{name: value}), name)  # type: ignore[misc]


def test_a_figure_of_too_many_events_is_refused_at_once() -> None:
    with at_most(10_000_000):
        message = refused(lambda: symosc.plot.figure("fig9", t_end="1e7"), "t_end")
    assert "earlier end" in message
    long = simulate("fig9", max_events=symosc.plot.MOST_DRAWN_EVENTS + 1, t_end=10**7)
    refused(lambda: symosc.plot.figure(long), "subject")
