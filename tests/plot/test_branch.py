"""Figures of branches: multipliers as curves, stability by line style, the unit circle."""

from __future__ import annotations

from copy import copy
from typing import Any

import numpy as np
import pytest
from bad_values import refused
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc import Branch, Parameters, continue_orbit, find_orbit, load_scene, plot
from symosc.plot.branch import MARKERS, multiplier_curves

FIG9 = load_scene("fig9").parameters
# Without damping, where the multipliers are on the unit circle.
UNDAMPED = Parameters(m=1, c=0, k=4, A0=0, B0=3, Omega="1.5", v1="1/10", v2=25, mu1=0, mu2="1/10", FN=1)


@pytest.fixture(scope="module")
def branch() -> Branch:
    return continue_orbit(FIG9, "P32", "Omega", (3, 5))


@pytest.fixture(scope="module")
def short() -> Branch:
    return continue_orbit(FIG9, "P32", "Omega", ("3.9", "4.1"))


@pytest.fixture(scope="module")
def undamped() -> Branch:
    return continue_orbit(UNDAMPED, "P32", "Omega", (1.47, 1.55))


@pytest.mark.slow
def test_multipliers_between_the_orbits_are_those_of_orbits_there(branch: Branch) -> None:
    values, sizes = multiplier_curves(branch.values, branch.multipliers)
    assert len(values) > 8 * len(branch.values)
    for i in np.random.default_rng(2).choice(len(values), 8, replace=False):
        orbit = find_orbit(FIG9.replace(Omega=float(values[i])), "P32")
        exact = sorted((abs(each) for each in orbit.multipliers), reverse=True)
        assert sizes[i] == pytest.approx(exact, abs=2e-3)
    # Smooth where the orbits of the branch leave corners: two real multipliers meet and turn complex at 4.88.
    corner = (values > 4.8) & (values < 4.95)
    assert np.abs(np.diff(sizes[corner, 0])).max() < 0.02
    assert sizes[0] == pytest.approx(np.sort(np.abs(branch.multipliers[0]))[::-1], abs=1e-9)


def styles(drawing: Figure, panel: int) -> set[str]:
    return {str(line.get_linestyle()) for line in drawing.axes[panel].lines if len(line.get_xdata()) > 2}  # type: ignore[arg-type]


@pytest.mark.slow
def test_stability_has_a_line_style_and_the_unit_circle_is_drawn(branch: Branch, undamped: Branch) -> None:
    assert [undamped.orbit(i).stable for i in (0, -1)] == [None, None]
    grown = copy(undamped)  # no such orbit exists: friction never makes a difference grow
    grown.multipliers = 1.1 * undamped.multipliers
    cases = ((branch, "-", "stable"), (undamped, "-.", "marginal"), (grown, "--", "not stable"))
    for each, style, name in cases:
        drawing = plot.branch_figure(each)
        assert styles(drawing, 0) == styles(drawing, 1) == {style}
        labels = [text.get_text() for text in drawing.legends[0].get_texts()]
        assert {name} == {"stable", "marginal", "not stable"} & {*labels}
        assert "unit circle" in labels
        multipliers = drawing.axes[1]
        low, high = multipliers.get_ylim()
        assert low < 0 < 1 < high
        assert [line.get_ydata()[0] for line in multipliers.lines if line.get_label() == "unit circle"] == [1]  # type: ignore[index]
    # Curves are named where they end: colour alone does not tell them apart.
    names = [text.get_text() for text in plot.branch_figure(branch).axes[0].texts]
    assert names == ["$P_2$", "$P_3$"]


@pytest.mark.slow
def test_points_ends_and_words_are_those_of_the_branch(branch: Branch) -> None:
    positions, multipliers = plot.branch_figure(branch).axes
    ends = [(end, row) for end, row in zip(branch.ends, (0, -1), strict=True) if end.kind in MARKERS]
    assert {end.kind for end, row in ends} == {"birth of a stick"}  # the other end is where the range ends
    curves = [line for line in positions.lines if str(line.get_label()).startswith("start of")]
    for i, line in enumerate(curves):
        assert np.asarray(line.get_xydata()) == pytest.approx(np.column_stack([branch.values, branch.points[:, i, 1]]))
    assert len(curves) == len(branch.labels)
    expected = {(end.kind, end.value, point.x) for end, row in ends for point in end.points}
    assert marks_of_ends(positions) == expected
    sizes = np.abs(branch.multipliers)
    expected = {(end.kind, end.value, size) for end, row in ends for size in sizes[row]}
    assert marks_of_ends(multipliers) == expected
    for ax in (positions, multipliers):
        verticals = [line.get_xdata() for line in ax.lines if len(set(np.asarray(line.get_xdata()))) == 1]
        assert {end.value for end, row in ends} == {float(np.asarray(each)[0]) for each in verticals if len(each) == 2}  # type: ignore[arg-type]
    words = {text.get_text(): text.xy[0] for text in multipliers.texts}  # type: ignore[attr-defined]
    beyond = {end.beyond: end.value for end, row in ends}
    assert words == {branch.word: (branch.values.min() + branch.values.max()) / 2} | beyond


def marks_of_ends(ax: Axes) -> set[tuple[str, float, float]]:
    """Return kind, value and height of each mark at an end of a branch."""
    kinds = {marker: kind for kind, marker in MARKERS.items()}
    dots = [line for line in ax.lines if line.get_marker() in kinds]
    return {(kinds[str(line.get_marker())], *map(float, np.asarray(line.get_xydata())[0])) for line in dots}  # type: ignore[misc]


def test_one_panel_into_given_axes(short: Branch) -> None:
    for letter, label in (("a", "position $x$ at the switching"), ("b", "moduli of the multipliers")):
        drawing = Figure()
        axes = drawing.add_subplot()
        assert plot.branch_figure(short, letter, ax=axes) is drawing
        assert axes.get_ylabel() == label
        assert axes.get_legend() is not None
        assert [each.get_ylabel() for each in plot.branch_figure(short, letter).axes] == [label]


@pytest.mark.parametrize("value", [None, 5, "P32", []])
def test_what_is_no_branch(value: Any, short: Branch) -> None:
    refused(lambda: plot.branch_figure(value), "branch")
    refused(lambda: plot.branch_figure(short, "c"), "panels")
    refused(lambda: plot.branch_figure(short, "a", ax=value or 3), "ax")
    refused(lambda: plot.branch_figure(short, "ab", ax=Figure().add_subplot()), "panels")
