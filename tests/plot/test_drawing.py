"""Figures in notebooks, in axes of a user's own, and as the `.plot()` of answers."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from matplotlib import rcParams
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from symosc import (
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
from symosc.plot.drawing import Drawing, plain_numbers

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


@pytest.mark.quick(4)
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


@pytest.mark.parametrize("kind", KINDS)
def test_axes_hold_one_panel(kind: str) -> None:
    answer, axes = answers()[kind], Figure().add_subplot()
    refused(lambda: answer.plot(panels="ab", ax=axes), "panels")
    refused(lambda: answer.plot(panels="", ax=axes), "panels")
    refused(lambda: answer.plot(panels="z"), "panels")
    for value in (3, "axes", [axes], Figure()):
        refused(lambda value=value: answer.plot(panels="a", ax=value), "ax")  # type: ignore[misc]
    assert not axes.has_data()


def test_functions_of_one_panel_take_axes() -> None:
    axes = Figure().add_subplot()
    assert plot.sweep_figure(P, "P2", "Omega", ax=axes) is axes.figure
    assert axes.get_xlabel() == r"$\Omega$"
    refused(lambda: plot.sweep_figure(P, "P2", "Omega", ax=3), "ax")  # type: ignore[arg-type]
    windows = [grazing_window(P, mapping) for mapping in ("P2", "P3")]
    refused(lambda: plot.window_figure(windows, ax=axes), "windows")


@pytest.mark.parametrize(
    ("draw", "name"),
    [
        (plot.orbit_figure, "orbit"),
        (plot.branch_figure, "branch"),
        (plot.figure_grazing_curve, "curve"),
        (plot.crosscheck_figure, "check"),
        (plot.window_figure, "windows"),
    ],
)
def test_what_cannot_be_drawn(draw: Callable[[Any], Any], name: str) -> None:
    for value in (None, 5, "fig5", [], P):
        refused(lambda value=value: draw(value), name)  # type: ignore[misc]


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


def test_numbers_at_ticks_are_plain_text_and_say_the_same() -> None:
    drawing = plot.figure(simulate("fig5", t_end=7), panels="b")
    (axes,) = drawing.axes
    drawing.draw_without_rendering()
    plain = [text.get_text() for text in axes.get_yticklabels()]
    axes.yaxis.set_major_formatter(ScalarFormatter(useMathText=True))
    drawing.draw_without_rendering()
    set_by_mathtext = [text.get_text() for text in axes.get_yticklabels()]
    assert len(plain) > 3
    assert [rf"$\mathdefault{{{text}}}$" for text in plain] == set_by_mathtext


def test_a_figure_is_saved_as_matplotlib_would(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plot.save(plot.figure("fig5", panels="cd"), tmp_path / "ours.png")

    def draw(self: Drawing, renderer: Any) -> None:
        plain_numbers(self.axes)
        Figure.draw(self, renderer)

    monkeypatch.setattr(Drawing, "draw", draw)
    plot.save(plot.figure("fig5", panels="cd"), tmp_path / "theirs.png")
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "theirs.png").read_bytes()
