"""`symosc grazing` and its figures."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import cli_runs
import numpy as np
import pytest
from sympy.parsing.sympy_parser import parse_expr

from symosc.errors import ParameterError
from symosc.grazing.window import grazing_window
from symosc.mappings.theorem7_cases import EVERYTHING
from symosc.model import PARAMETER_NAMES
from symosc.plot.sweep import sweep_figure
from symosc.plot.windows import window_figure
from symosc.scenes import load_scene, scene_names

FIG9 = load_scene("fig9").parameters
MAPS = ("P2", "P3", "P5", "P6")


run, good = partial(cli_runs.run, "grazing"), partial(cli_runs.good, "grazing")


def test_the_table() -> None:
    lines = good("fig9").splitlines()
    assert lines[0].split() == ["map", "case", "gamma", "B0", "Omega/m", "Theta_cr", "window"]
    rows = [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in lines[2:]]
    assert rows == [
        ["P2", "(55.1)", "30", "360", "-asin(1/12)", "[0, asin(1/12) + pi) U (-asin(1/12) + 2*pi, 2*pi)"],
        ["P3", "(56.1)", "30", "360", "-asin(1/12)", "(asin(1/12) + pi, -asin(1/12) + 2*pi)"],
        ["P5", "(57.3)", "750", "360", "none", "[0, 2*pi)"],
        ["P6", "(58.2)", "750", "360", "none", "empty"],
    ]


def test_order_map_and_set() -> None:
    printed = good("fig8", "--map", "P3", "--order", "paper")
    assert "(56.5)" in printed
    assert "[0, pi/2) U (pi/2, 2*pi)" in printed
    assert good("fig8", "--map", "P3").splitlines()[-1].endswith("[0, 2*pi)")
    changed = good("fig9", "--set", "k=1/3", "--set", "v1=-0.6", "--map", "P2", "--map", "P6").splitlines()
    assert [line[:2] for line in changed[2:]] == ["P2", "P6"]
    assert "-2 " in changed[2]  # k v1/m = -0.2/0.1


def test_parameters_without_a_scene() -> None:
    settings = [f"--set={name}={value}" for name, value in FIG9.as_dict().items()]
    assert good(*settings) == good("fig9")
    for result in (run(), run("--set", "k=3")):
        assert result.exit_code == 2
        assert "missing: m, c," in result.stderr
        assert len(result.stderr.splitlines()) == 1


def test_without_a_spring_the_phase_is_named() -> None:
    changes = [f"--set={text}" for text in ("k=0", "A0=0", "mu1=0", "mu2=0", "v1=3", "B0=6")]
    assert "P2: k = 0, so x_m is free and F = 0 fixes the phase: pi/3" in good("fig9", *changes, "--set=c=1")
    assert "P2: k = 0, so x_m is free and F = 0 fixes the phase: at no phase of it" in good(
        "fig9", *changes, "--set=c=90"
    )


@pytest.mark.parametrize("name", scene_names())
def test_json_says_what_python_says(name: str) -> None:
    data = json.loads(good(name, "--json"))
    assert data["scene"] == name
    assert data["parameters"] == load_scene(name).parameters.as_dict()
    for shown, mapping in zip(data["windows"], MAPS, strict=True):
        window = grazing_window(load_scene(name).parameters, mapping)
        assert (shown["map"], shown["case"], shown["latex"]) == (mapping, window.case, window.latex())
        assert [tuple(interval.values()) for interval in shown["intervals"]] == list(window.intervals)
        if window.theta_cr is None:
            assert shown["theta_cr"] is None
        else:
            assert parse_expr(shown["theta_cr"]["exact"]) == window.theta_cr
            assert shown["theta_cr"]["value"] == pytest.approx(float(window.theta_cr), rel=1e-15)


def test_latex() -> None:
    lines = good("fig7", "--latex").splitlines()
    assert len(lines) == 4
    assert lines[0] == grazing_window(load_scene("fig7").parameters, "P2").latex()


@pytest.mark.quick(14)
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["fig9", "--map", "P1"], "sticks on belt 1; grazing is defined for P2, P3, P5, P6"),
        (["fig9", "--map", "P7"], "leads from v2 to v1"),
        (["fig9", "--map", "P9"], "P2, P3, P5, P6"),
        (["fig9", "--set", "Omega=abc"], "Omega = 'abc'"),
        (["fig9", "--set", "B0=abc"], "B0 = 'abc'"),
        (["fig9", "--set", "Omega=0"], "must be > 0"),
        (["fig9", "--set", "B0"], "not NAME=VALUE"),
        (["fig9", "--set", "k=1", "--set", "k=2"], "k is set twice"),
        (["fig9", "--set", "w=1"], "is not a parameter"),
        (["--set", "w=1"], "is not a parameter"),
        (["nowhere"], "scene nowhere: unknown"),
        (["fig9", "--check", "1000000000000"], "n = 1000000000000: must be a whole number from 1 to"),
        (["fig9", "--check", "1000000000000", "--plot", "w.png"], "n = 1000000000000"),
        (["fig9", "--check", "1", "--set", "k=0", "--plot", "w.png"], "k = '0'"),
        (["fig9", "--check", "nan"], "nan"),
        (["fig9", "--set", "k=nan"], "must be finite"),
        (["fig9", "--order", "second"], "second"),
        (["fig9", "--latex", "--json"], "not both"),
        (["fig9", "--plot", "window.txt"], ".png"),
        (["fig9", "--plot", "no/such/folder/window.png"], "No such file"),
        (["fig9", "--against", "Omega"], "--against needs --plot FILE and one --map"),
        (["fig9", "--against", "Omega", "--plot", "w.png"], "--against needs --plot FILE and one --map"),
        (["fig9", "--map", "P2", "--against", "c", "--plot", "w.png"], "depends on Omega, B0, k, v1 only"),
        (["fig9", "--map", "P2", "--against", "Omega=3", "--plot", "w.png"], "NAME=LOW:HIGH"),
        (["fig9", "--map", "P2", "--against", "Omega=3:1", "--plot", "w.png"], "lower to a higher"),
        (["fig9", "--map", "P2", "--against", "Omega=-1:1", "--plot", "w.png"], "must be > 0"),
        (["fig9", "--map", "P2", "--against", "Omega=a:1", "--plot", "w.png"], "Omega = 'a'"),
    ],
)
def test_bad_input_costs_one_line(arguments: list[str], message: str, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_help_has_an_example() -> None:
    assert "symosc grazing fig9" in good("--help")


@pytest.mark.full(1)
@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["pdf", "svg", "png"])
def test_plot_files(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"window.{suffix}"
    good("fig9", "--map", "P3", "--plot", str(path))
    first = path.read_bytes()
    assert len(first) > 5000
    # The layout's solver is not exact to the last digit, so a second drawing may differ there.
    good("fig9", "--map", "P3", "--plot", str(path))
    assert len(path.read_bytes()) == pytest.approx(len(first), rel=1e-3)
    good("fig9", "--map", "P3", "--against", "Omega=0.1:4", "--plot", str(path))
    assert len(path.read_bytes()) != pytest.approx(len(first), rel=1e-3)


# -- what the figures show -------------------------------------------------------------------------------------------


def dots(axes: Any) -> list[tuple[float, float, bool]]:
    """Return x, y and whether it is full, of each dot."""
    lines = [line for line in axes.lines if line.get_marker() == "o"]
    return [(line.get_xdata()[0], line.get_ydata()[0], line.get_markerfacecolor() != "white") for line in lines]


@pytest.mark.full(8)
@pytest.mark.quick(5)
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("changes", [{}, {"B0": -9}, {"k": 36}, {"v1": -1}, {"B0": 0}, {"v1": 0}], ids=str)
def test_window_figure_shows_the_ends_and_the_contacts(mapping: str, changes: dict[str, Any]) -> None:
    p = FIG9.replace(**changes)
    for order in ("full", "paper"):
        window = grazing_window(p, mapping, order)
        circle, curve = window_figure([window]).axes
        ends = sorted({end for low, high, *_ in window.intervals for end in (low, high)} - {0.0, 2 * np.pi})
        marked = sorted({x for x, _, full in dots(curve) if not full} - {0.0, 2 * np.pi})
        tangent = abs(window.gamma) == abs(window.amplitude)
        if tangent or window.kind > 1:
            assert len(dots(circle)) == (1 if tangent else 2)
        if not tangent:
            assert marked == pytest.approx(ends, abs=1e-15)
        full_dots = [full for *_, full in dots(curve)]
        assert full_dots == [tangent and window.kind == EVERYTHING] * len(full_dots)
        assert {full for *_, full in dots(circle)} == set(full_dots)
        for x, y, _ in dots(circle):
            phase = np.arctan2(y, x) % (2 * np.pi)
            assert float(window.amplitude) * np.sin(phase) == pytest.approx(-float(window.gamma), abs=1e-9)
        blue = [line for line in curve.lines if line.get_linewidth() == 2.0]
        assert len(blue) == len(window.intervals)
        for line, (low, high, *_) in zip(blue, window.intervals, strict=True):
            theta, places = line.get_data()
            assert (theta[0], theta[-1]) == (low, high)
            middle = len(theta) // 2
            assert places[middle] == pytest.approx(window.contact(float(theta[middle])), rel=1e-12)


def test_a_third_column_is_drawn_by_the_caller() -> None:
    seen: list[str] = []
    windows = [grazing_window(FIG9, mapping) for mapping in ("P2", "P3")]
    drawing = window_figure(windows, lambda axes, window: seen.append(window.mapping))
    assert seen == ["P2", "P3"]
    assert len(drawing.axes) == 6


def shaded(axes: Any, x: float, y: float) -> bool:
    return any(path.contains_point((x, y)) for area in axes.collections for path in area.get_paths())


@pytest.mark.full(3)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("mapping", "name"),
    [("P2", "Omega"), ("P2", "B0"), ("P2", "k"), ("P3", "v1"), ("P5", "v2"), ("P6", "B0"), ("P6", "v2"), ("P3", "k")],
)
def test_sweep_figure_shades_the_window(mapping: str, name: str) -> None:
    rng = np.random.default_rng(1)
    axes = sweep_figure(FIG9, mapping, name).axes[0]
    low, high = axes.get_xlim()
    answers = []
    for value, theta in zip(rng.uniform(low, high, 200), rng.uniform(0, 2 * np.pi, 200), strict=True):
        window = grazing_window(FIG9.replace(**{name: value}), mapping)
        near = [abs(theta - end) for low, high, *_ in window.intervals for end in (low, high)]
        if min(near, default=1.0) > 0.02:
            answers.append(window.contains(theta))
            assert shaded(axes, value, theta) == answers[-1], (value, theta)
    assert 3 < sum(answers) < len(answers) - 3


def test_sweep_figure_marks_the_tangency() -> None:
    for order, full in (("full", True), ("paper", False)):
        axes = sweep_figure(FIG9, "P2", "Omega", order=order).axes[0]
        assert dots(axes) == [(pytest.approx(1 / 3), pytest.approx(1.5 * np.pi), full)]
    axes = sweep_figure(FIG9, "P3", "B0").axes[0]
    assert sorted(dots(axes)) == [(-0.75, pytest.approx(np.pi / 2), False), (0.75, pytest.approx(1.5 * np.pi), False)]
    assert dots(sweep_figure(FIG9, "P2", "k", 1, 2).axes[0]) == []
    empty = sweep_figure(FIG9, "P6", "k", 40, 50).axes[0]
    assert [text.get_text() for text in empty.texts] == ["the window is empty"]


def test_sweep_figure_of_what_cannot_be_swept() -> None:
    for name in ("c", "v2", "abc"):
        with pytest.raises(ParameterError, match="depends on"):
            sweep_figure(FIG9, "P2", name)
    for name in set(PARAMETER_NAMES) - {"Omega", "B0", "k", "v2"}:
        with pytest.raises(ParameterError, match=name):
            sweep_figure(FIG9, "P5", name)
    with pytest.raises(ParameterError, match="v1"):
        sweep_figure(FIG9, "P2", "v1", 0, 30)
    assert sweep_figure(FIG9.replace(v1=-90, v2=-80), "P3", "v1").axes
    assert sweep_figure(FIG9.replace(v1=-90, v2=-80), "P6", "v2").axes
