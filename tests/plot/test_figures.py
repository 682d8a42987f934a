"""Figures: what is drawn, where the dots are, and that nothing global is touched."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from symosc import OutputError, ParameterError, load_scene, plot, scene_names, simulate
from symosc.plot import drawing, figures
from symosc.plot.panels import BELT_COLOR, END_COLOR, MASS_COLOR, ONSET_COLOR, SWITCH_COLOR

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


@pytest.mark.slow
def test_the_legend_covers_no_panel(fig5: Figure) -> None:
    fig5.draw_without_rendering()
    legend = fig5.legends[0].get_window_extent()
    assert not any(ax.get_tightbbox().overlaps(legend) for ax in fig5.axes)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("color", "hue"), [(MASS_COLOR, "red"), (SWITCH_COLOR, "red"), (ONSET_COLOR, "blue"), (END_COLOR, "green")]
)
def test_colours_are_those_of_the_paper(color: str, hue: str) -> None:
    assert int(np.argmax(to_rgb(color))) == HUES[hue]
    assert BELT_COLOR == "black"


def test_forces_are_blue_and_green(fig5: Figure) -> None:
    below, above = fig5.axes[3].lines[1:3]
    assert (to_hex(below.get_color()), to_hex(above.get_color())) == (ONSET_COLOR, END_COLOR)


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


def test_curves_pass_through_the_events_and_are_dense(fig5: Figure) -> None:
    trajectory = simulate("fig5", t_end=9)
    t, x = lines(fig5.axes[0], "mass")[0].get_data()
    assert set(np.array([event.t for event in trajectory.events])) <= set(t)
    assert max(np.diff(t)) < 2 * np.pi / 100
    np.testing.assert_array_equal(x, trajectory(t)[0])


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


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "boundary", "panels"),
    [("fig5", 1, 4), ("fig6", 2, 4), ("fig7", 1, 4), ("fig8", 1, 4), ("fig9", 1, 6), ("fig10", 2, 6)],
)
def test_boundary_and_number_of_panels(name: str, boundary: int, panels: int) -> None:
    drawing = plot.figure(name)
    assert len(drawing.axes) == panels
    for ax in drawing.axes[3:]:
        labels = [line.get_label() for line in ax.lines]
        assert [label for label in labels if str(label).startswith("$F")] == [
            f"$F^{{({boundary})}}$",
            f"$F^{{({boundary + 1})}}$",
        ]


def test_forces_against_displacement_and_velocity() -> None:
    trajectory = simulate("fig9-orbit", t_end=3)
    drawing = plot.figure(trajectory, panels="ef")
    events = trajectory.events
    assert {event.kind for event in events} == {"cross"}
    for ax, name in zip(drawing.axes, ("x", "v"), strict=True):
        expected = [(getattr(e, name), trajectory.force(domain, e.t)) for domain in (1, 2) for e in events]
        np.testing.assert_allclose(dots(ax, "crossing"), expected, rtol=0, atol=1e-9)
        assert to_hex(lines(ax, "crossing")[0].get_markerfacecolor()) == SWITCH_COLOR


def test_a_start_on_a_belt_is_the_onset_of_its_stick() -> None:
    drawing = plot.figure("fig6", panels="b")
    assert dots(drawing.axes[0], "onset of stick")[0] == pytest.approx([0, 5])
    assert not lines(drawing.axes[0], "start")


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


@pytest.mark.full(3)
@pytest.mark.slow
@pytest.mark.parametrize("name", scene_names())
def test_every_scene_can_be_drawn(name: str, tmp_path: Path) -> None:
    saved = plot.save(plot.figure(name, columns=1), tmp_path / f"{name}.svg")
    assert saved.read_bytes().startswith(MAGIC[".svg"])


@pytest.mark.quick(1)
@pytest.mark.parametrize("suffix", drawing.FIGURE_SUFFIXES)
def test_files_by_suffix_the_same_each_time(suffix: str, tmp_path: Path) -> None:
    paths = [plot.save(plot.figure("fig7", panels="c"), tmp_path / f"{n}{suffix}") for n in "ab"]
    first, second = (path.read_bytes() for path in paths)
    assert first.startswith(MAGIC[suffix])
    assert first == second


@pytest.mark.slow
def test_pdf_keeps_text_as_text_and_svg_is_vector(tmp_path: Path) -> None:
    drawing = plot.figure("fig5", panels="b")
    assert b"/Type /Font" in plot.save(drawing, tmp_path / "a.pdf").read_bytes()
    assert b"<image" not in plot.save(drawing, tmp_path / "a.svg").read_bytes()


def test_other_suffixes_and_unwritable_paths_leave_nothing(tmp_path: Path) -> None:
    drawing = plot.figure("fig7", panels="c")
    with pytest.raises(OutputError, match=r"\.pdf, \.svg or \.png"):
        plot.save(drawing, tmp_path / "a.eps")
    with pytest.raises(OutputError, match="No such file"):
        plot.save(drawing, tmp_path / "none" / "a.pdf")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"panels": "ax"}, "panels"),
        ({"panels": "aa"}, "panels"),
        ({"panels": ""}, "panels"),
        ({"boundary": 3}, "boundary"),
        ({"columns": 3}, "columns"),
        ({"t_end": "-1"}, "t_end"),
    ],
)
def test_bad_arguments(arguments: dict, name: str) -> None:
    with pytest.raises(ParameterError) as caught:
        plot.figure("fig5", **arguments)
    assert caught.value.name == name


def test_a_trajectory_has_its_own_end() -> None:
    with pytest.raises(ParameterError, match="only for scenes"):
        plot.figure(simulate("fig7"), t_end=3)


def test_spans_of_the_scenes() -> None:
    assert float(figures.default_end(load_scene("fig5"))) == 9
    assert float(figures.default_end(load_scene("fig7"))) == 15.1
    orbit = load_scene("fig10")
    periods = (float(figures.default_end(orbit)) - float(orbit.t0)) / (2 * np.pi / 1.75)
    assert periods == pytest.approx(figures.PERIODS_SHOWN)


@pytest.mark.slow
def test_digits_and_an_undecided_end_can_be_drawn() -> None:
    assert plot.figure(simulate("fig8", t_end=4, digits=30)).axes
    undecided = simulate("fig8", t_end=160)
    assert undecided.status == "undecidable"
    assert plot.figure(undecided, panels="b").axes


@pytest.mark.slow
def test_no_global_state() -> None:
    before = dict(rcParams)
    plot.figure("fig5", panels="b")
    assert dict(rcParams) == before
    code = (
        "import sys; from symosc import plot, simulate; plot.figure(simulate('fig5'));"
        "assert 'matplotlib.pyplot' not in sys.modules; assert 'sympy' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
