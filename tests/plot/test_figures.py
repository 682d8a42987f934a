"""Figures: what is drawn, where the marks are, that nothing global is touched, and bad input."""

from __future__ import annotations

import random
import subprocess
import sys
import warnings
from functools import cache
from inspect import signature
from itertools import product
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from bad_values import refused
from effort import at_most
from hostile import functions, of_answers
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from problems import ordinary

import symosc
from symosc import (
    Belt,
    Oscillator,
    OtherModel,
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
from symosc.base.display.drawable import Drawable
from symosc.plot.figures import MOST_DRAWN_EVENTS
from symosc.plot.panels import SHAPES, view_of
from symosc.scenes import as_toml, read_scene
from symosc.sweeps.output import SweptDataset

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


def test_what_draws_an_answer_is_a_figure_of_the_package() -> None:
    names = [getattr(symosc, name) for name in symosc.__all__]
    kinds = [item for item in names if isinstance(item, type) and issubclass(item, Drawable)]
    assert len(kinds) > 12
    for kind in [*kinds, SweptDataset]:
        assert kind._drawn_by in plot.__all__
    with pytest.raises(NotImplementedError, match="nothing draws a Drawable"):
        Drawable().plot()


KINDS = ["trajectory", "orbit", "branch", "window", "curve", "check"]


@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", KINDS)
def test_an_answer_draws_all_panels_or_one_into_given_axes(kind: str) -> None:
    before = dict(rcParams)
    answer = answers()[kind]
    assert len(answer.plot().axes) > 1
    drawing = Figure()
    left, right = drawing.subplots(1, 2)
    assert answer.plot(ax=right) is drawing
    assert right.lines
    assert not left.has_data()
    assert answer.plot(panels="b", ax=left) is drawing
    assert left.has_data()
    assert drawing.axes == [left, right]
    assert not drawing.legends
    assert dict(rcParams) == before
    drawing.draw_without_rendering()
    empty = Figure().add_subplot()
    for panels in ("ab", ""):
        refused(lambda panels=panels: answer.plot(panels=panels, ax=empty), "panels")  # type: ignore[misc]
    refused(lambda: answer.plot(panels="z"), "panels")
    refused(lambda: answer.plot(panels="a", ax=Figure()), "ax")
    assert not empty.has_data()


@pytest.mark.slow
def test_a_root_that_is_no_orbit_is_not_drawn() -> None:
    root = find_orbit(P.replace(Omega=3), "P32")
    assert not root.admissible
    assert "no motion" in refused(lambda: plot.orbit_figure(root), "orbit")


@pytest.mark.slow
def test_a_page_loads_nothing_that_draws_and_the_first_plot_does() -> None:
    code = (
        "import sys; from symosc import simulate, grazing_window, load_scene; motion = simulate('fig5', t_end=3);"
        "pages = [motion._repr_html_(), grazing_window(load_scene('fig9').parameters, 'P2')._repr_html_()];"
        "assert not {'matplotlib', 'sympy', 'numba'} & set(sys.modules);"
        "print(motion.plot(panels='c')._repr_png_()[1:4])"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout == "b'PNG'\n"


# -- figures of scenes ------------------------------------------------------------------------------------------------


MAGIC = {".pdf": b"%PDF-", ".svg": b"<?xml", ".png": b"\x89PNG"}


@pytest.mark.slow
def test_files_by_suffix_the_same_each_time(tmp_path: Path) -> None:
    drawings = [plot.figure("fig5", t_end=2, panels="c") for _ in "ab"]
    for suffix, start in MAGIC.items():
        paths = [
            plot.save(drawing, tmp_path / f"{n}{suffix}")
            for n, drawing in zip("ab", drawings, strict=True)
        ]
        first, second = (path.read_bytes() for path in paths)
        assert first.startswith(start)
        assert first == second


def test_other_suffixes_and_unwritable_paths_leave_nothing(tmp_path: Path) -> None:
    drawing = plot.figure("fig7", panels="c")
    with pytest.raises(OutputError, match=r"\.pdf, \.svg or \.png"):
        plot.save(drawing, tmp_path / "a.eps")
    with pytest.raises(OutputError, match="No such file"):
        plot.save(drawing, tmp_path / "none" / "a.pdf")
    assert list(tmp_path.iterdir()) == []


# -- what the panels show ---------------------------------------------------------------------------------------------


@cache
def random_motions(count: int) -> list[Trajectory]:
    """Return motions of random oscillators with events at both belts."""
    rng = random.Random(14)
    results: list[Trajectory] = []
    while len(results) < count:
        p, start = ordinary(rng)
        motion = simulate(p, **start, max_events=100)
        if {event.boundary for event in motion.events} == {1, 2}:
            results.append(motion)
    return results


def marks(ax: Axes) -> dict[str, np.ndarray]:
    """Return the places of all marks by label."""
    drawn = [line for line in ax.lines if line.get_marker() != "None"]
    result = {str(line.get_label()): np.column_stack(line.get_data()) for line in drawn}
    return {label: places for label, places in result.items() if label in SHAPES}


@pytest.mark.parametrize("number", range(3))
def test_forces_have_marks_of_their_own_belt_only(number: int) -> None:
    motion = random_motions(3)[number]
    boundary = 1 + number % 2
    kinds = {
        "stick": "onset of stick",
        "slip": "end of stick",
        "cross": "crossing",
        "graze": "grazing point",
    }
    (ax,) = plot.figure(motion, panels="d", boundary=boundary).axes
    for kind, label in kinds.items():
        times = {
            float(event.t)
            for event in motion.events
            if (event.kind, event.boundary) == (kind, boundary)
        }
        if label == "onset of stick" and motion.segments[0].mode == f"belt{boundary}":
            times.add(float(motion.t_start))
        assert set(marks(ax).get(label, np.empty((0, 2)))[:, 0]) == times
    # Theorem 4: while the mass sticks, the force below pushes up and the one above down. So at an
    # onset.
    heights = [line.get_ydata() for line in ax.lines if line.get_label() == "onset of stick"]
    for height, sign in zip(heights, (1, -1), strict=False):
        assert (sign * np.asarray(height) > -1e-9).all()


@pytest.mark.slow
def test_the_product_of_the_forces_decides() -> None:
    """It is > 0 at each crossing, < 0 inside each stick and 0 at its end (section 6)."""
    for motion, boundary in ((simulate("fig5", t_end=9), 1), (random_motions(3)[0], 2)):
        (ax,) = plot.figure(motion, panels="g", boundary=boundary).axes
        curve = max(ax.lines, key=lambda line: len(line.get_xdata()))  # type: ignore[arg-type]
        t, values = (np.asarray(part) for part in curve.get_data())
        scale = np.abs(values).max()
        for segment in motion.segments:
            inside = (float(segment.t_start) < t) & (t < float(segment.t_end))
            if segment.mode == f"belt{boundary}":
                assert (values[inside] < 1e-9 * scale).all()
        result = marks(ax)
        assert (result.get("crossing", np.ones((1, 2)))[:, 1] > -1e-9 * scale).all()
        for time, value in result.get("end of stick", np.empty((0, 2))):
            assert value == pytest.approx(0, abs=1e-9 * scale), time


#: Panel: what is drawn across and up; F stands for the two forces.
AXES = {
    "a": ("t", "x"),
    "b": ("t", "v"),
    "c": ("x", "v"),
    "d": ("t", "F"),
    "e": ("x", "F"),
    "f": ("v", "F"),
}


def force(motion: Trajectory, domain: int, t: np.ndarray) -> np.ndarray:
    """Return F^(alpha), equation (13), from the parameters alone."""
    p = motion.parameters
    (x, v) = motion(t)
    first = float(p.mu1 * p.FN)
    second = float(p.mu2 * p.FN)
    friction = {1: first + second, 2: second - first, 3: -first - second}[domain]
    drive = float(p.A0) + float(p.B0) * np.cos(float(p.Omega) * t)
    return np.asarray((drive - float(p.c) * v - float(p.k) * x + friction) / float(p.m))


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("letter", "boundary"), [("a", 1), ("b", 2), ("c", 1), ("d", 1), ("d", 2), ("e", 2), ("f", 1)]
)
def test_curves_are_what_the_axes_say(letter: str, boundary: int) -> None:
    motion = random_motions(3)[boundary]
    t = view_of(motion, boundary).t
    (ax,) = plot.figure(motion, panels=letter, boundary=boundary).axes
    shown = dict(zip("txv", (t, *motion(t)), strict=True))
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
    motion = random_motions(3)[0]
    view = view_of(motion, 1)
    (ax,) = plot.figure(motion, panels=letter, boundary=1).axes
    drawn = [line for line in ax.lines if line.get_label() == "belt"]
    at = [float(np.asarray(line.get_xydata())[0, int(letter != "f")]) for line in drawn]
    speeds = [float(motion.parameters.belt(belt)) for belt in view.belts()]
    assert at == speeds
    names = {text.get_text(): text.xy[letter != "f"] for text in ax.texts}  # type: ignore[attr-defined]
    assert names == {f"$v_{belt}$": speed for belt, speed in zip(view.belts(), speeds, strict=True)}


@pytest.mark.slow
def test_sticks_are_shaded_and_jumps_of_force_joined() -> None:
    joined = 0
    for motion, boundary in product(random_motions(3), (1, 2)):
        (ax,) = plot.figure(motion, panels="d", boundary=boundary).axes
        sticks = [item for item in motion.segments if item.mode == f"belt{boundary}"]
        shaded = sorted((patch.get_x(), patch.get_width()) for patch in ax.patches)  # type: ignore[attr-defined]
        spans = [(float(item.t_start), float(item.t_end - item.t_start)) for item in sticks]
        assert np.array(shaded) == pytest.approx(np.array(spans), abs=1e-12)
        crossings = [
            float(e.t) for e in motion.events if (e.kind, e.boundary) == ("cross", boundary)
        ]
        (bars,) = ax.collections
        ends = np.array([path.vertices for path in bars.get_paths()]).reshape(-1, 4)
        heights = [
            [force(motion, i, np.array([t]))[0] for i in (boundary, boundary + 1)]
            for t in crossings
        ]
        expected = np.array(
            [(t, low, t, high) for t, (low, high) in zip(crossings, heights, strict=True)]
        )
        assert ends == pytest.approx(expected.reshape(-1, 4), abs=1e-9)
        joined += len(crossings)
    assert joined


# -- bad input --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("panels", ["", "z", "aa", 5]),
        ("boundary", [0, 3, True]),
        ("columns", [0, 3, None]),
        ("t_end", ["x", -1]),
    ],
)
def test_options_of_a_figure(name: str, values: list[Any]) -> None:
    for value in values:
        refused(lambda value=value: symosc.plot.figure("fig5", **{name: value}), name)  # type: ignore[misc]


def test_a_figure_of_too_many_events_is_refused_at_once() -> None:
    with at_most(10_000_000):
        message = refused(lambda: symosc.plot.figure("fig9", t_end="1e7"), "t_end")
    assert "earlier end" in message
    long = simulate("fig9", max_events=MOST_DRAWN_EVENTS + 1, t_end=10**7)
    refused(lambda: symosc.plot.figure(long), "subject")


# --- a style of one's own ---


@pytest.mark.parametrize("t_end", ["1e-900", "1e-320"])
def test_a_motion_too_short_for_doubles_is_drawn_without_a_warning(t_end: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawing = plot.figure("fig5", t_end=t_end)
    assert len(drawing.axes) == 4


@pytest.mark.slow
def test_every_figure_has_the_size_that_is_asked_for() -> None:
    drawn = 0
    for name, (draw, given) in (functions() | of_answers()).items():
        parameters = signature(draw).parameters
        if not name.startswith("plot.") or not {"ax", "figsize"} & parameters.keys():
            continue
        drawing = draw(**given, figsize=(6, "2.5"))
        assert drawing.get_size_inches().tolist() == [6, 2.5], name
        drawn += 1
        if "ax" in parameters:
            ax = Figure().add_subplot()
            refused(lambda: draw(**given, ax=ax, figsize=(6, 3)), "figsize")  # noqa: B023
    assert drawn > 20


@pytest.mark.parametrize("size", [3, (3,), (3, 0), (3, -1), (3, 1e4), ("wide", 2), (3, None), "ab"])
def test_what_is_no_size_is_refused(size: Any) -> None:
    refused(lambda: plot.figure("fig6", panels="a", figsize=size), "figsize")


def test_a_figure_has_the_size_that_is_asked_for() -> None:
    drawing = simulate("fig6", t_end=2).plot(figsize=(5, 4))
    assert drawing.get_size_inches().tolist() == [5, 4]


UNITS = {
    "a": ("time $t$ (s)", "displacement $x$ (m)"),
    "b": ("time $t$ (s)", r"velocity $\dot{x}$ (m/s)"),
    "c": ("displacement $x$ (m)", r"velocity $\dot{x}$ (m/s)"),
    "d": ("time $t$ (s)", "forces per mass $F^{(1)}$, $F^{(2)}$ (m/s$^2$)"),
    "g": ("time $t$ (s)", "product $F^{(1)}\\, F^{(2)}$ (m$^2$/s$^4$)"),
}


def test_axes_have_units_if_the_scene_has_some(tmp_path: Path) -> None:
    pytest.importorskip("pint")
    text = as_toml(load_scene("fig5"))
    plain = tmp_path / "plain.toml"
    plain.write_text(text, encoding="utf-8")
    file = tmp_path / "mine.toml"
    file.write_text(text.replace("m = 1\n", 'm = "1000 g"\n'), encoding="utf-8")
    assert load_scene(file) == load_scene(plain)
    for panel, labels in UNITS.items():
        for drawing in (
            plot.figure(file, t_end=3, panels=panel, boundary=1),
            simulate(file, t_end=3).plot(panels=panel, boundary=1),
            plot.figure(load_scene(file).changed(FN=9), t_end=3, panels=panel, boundary=1),
        ):
            (ax,) = drawing.axes
            assert (ax.get_xlabel(), ax.get_ylabel()) == labels
        (ax,) = plot.figure(plain, t_end=3, panels=panel).axes
        assert "(" not in ax.get_xlabel()


@pytest.mark.parametrize(
    ("number", "has_some"), [("80%", False), ("2*pi", False), ("1 rad/s", True)]
)
def test_what_has_a_unit(number: str, has_some: bool) -> None:
    pytest.importorskip("pint")
    name = "mu1" if number == "80%" else "Omega"
    lines = as_toml(load_scene("fig5")).splitlines()
    lines = [f'{name} = "{number}"' if line.startswith(f"{name} =") else line for line in lines]
    assert read_scene("\n".join(lines), "mine.toml").in_si is has_some


def test_rcparams_hold() -> None:
    motion = simulate("fig5", t_end=9)
    with matplotlib.rc_context({"axes.labelsize": 17.0, "axes.facecolor": "0.9"}):
        (axes,) = plot.figure(motion, panels="b").axes
    assert axes.xaxis.label.get_fontsize() == 17.0
    assert axes.get_facecolor() == pytest.approx((0.9, 0.9, 0.9, 1.0))


@pytest.mark.parametrize("style", [{"colr": "red"}, {"color": "no colour"}, {"linewidth": "thick"}])
def test_what_is_no_style_is_refused(style: dict[str, Any]) -> None:
    with pytest.raises(symosc.ParameterError, match=next(iter(style))):
        plot.figure("fig5", panels="c", **style)


def test_what_is_no_transient_is_refused() -> None:
    motion = simulate("fig9", t_end="12T")
    for skip in (-1, 100, "20T", "x"):
        with pytest.raises(symosc.ParameterError, match="skip"):
            plot.figure(motion, skip=skip)


# -- laws of friction ---------------------------------------------------------------------------------


def test_corners_are_drawn_lightly_and_belts_where_they_are() -> None:
    """The corners of the curve lie at -3, -1, 5 and 7, of which the motion passes the first two."""
    law: dict[str, Any] = {"m": 1, "c": "1/5", "k": 1, "B0": 1, "Omega": 1}
    belt = Belt(2, curve=[(0, 1), (3, "1/2"), (5, "2/5")])
    figure = simulate(Oscillator(**law, belts=[belt]), x0=6, v0=-1, t_end=30).plot(panels="bc")
    for ax in figure.axes[:2]:
        levels = {line.get_ydata()[0] for line in ax.lines if len(set(line.get_ydata())) == 1}
        assert {-3.0, -1.0, 2.0} <= levels
        assert not {5.0, 7.0} & levels
    close = [Belt(v, mu) for v, mu in (("1/5", "2/5"), ("3/10", "1/5"), ("2/5", "1/5"))]
    figure = simulate(Oscillator(**law, belts=close), t_end=30).plot(panels="b")
    names = [text.get_text() for text in figure.axes[0].texts if text.get_text()]
    assert names == ["$v_1$", "$v_2$", "$v_3$"]


def test_belts_of_a_pulled_block_are_drawn_in_its_own_coordinates() -> None:
    block = OtherModel(m=1, k=2, Omega=1, FN=1, pull="1/10", belts=[Belt(0, "1/2", mu_s="4/5")])
    figure = simulate(block, t_end=13).plot(panels="b")
    levels = {
        line.get_ydata()[0] for line in figure.axes[0].lines if len(set(line.get_ydata())) == 1
    }
    assert 0.0 in levels
    assert -0.1 not in levels


@pytest.mark.parametrize("width", [7, 4, 3])
def test_a_legend_is_no_wider_than_its_figure(width: float) -> None:
    t = np.linspace(0, 10, 500)
    x, v = simulate("fig5")(t)
    v[t > 3] += 1e-5
    drawing = crosscheck("fig5", t, x, v, partial=True).plot(panels="b", figsize=(width, 3))
    drawing.draw_without_rendering()
    box = drawing.legends[0].get_window_extent()
    assert 0 <= box.x0 < box.x1 <= drawing.bbox.width
