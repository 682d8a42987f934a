"""Figures of cross-checks, certificates, scores and branches, and what notebooks show of all answers."""

from __future__ import annotations

from copy import copy
from pathlib import Path

import numpy as np
import pytest
from answers import PROVEN, answer
from careful_solver import TIGHT, solve
from excerpts import crosscheck
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from small_set import right, small_set

import symosc
from symosc import Branch, Parameters, continue_orbit, find_orbit, load_scene, plot, simulate
from symosc.plot.figures import END_MARKERS, multiplier_curves
from symosc.plot.judged import ABSENT, FAULTY, LEAST_UNITS
from symosc.plot.judged import crosscheck_figure as figure
from symosc.reference.results import CaseResult
from symosc.reference.score import score

# -- branches ---------------------------------------------------------------------------------------------------------


FIG9 = load_scene("fig9").parameters
# Without damping, where the multipliers are on the unit circle.
UNDAMPED = Parameters(m=1, c=0, k=4, A0=0, B0=3, Omega="1.5", v1="1/10", v2=25, mu1=0, mu2="1/10", FN=1)


@pytest.fixture(scope="module")
def branch() -> Branch:
    return continue_orbit(FIG9, "P32", "Omega", (3, 5))


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
    assert names == ["$P_{3}$", "$P_{2}$"]  # from below


@pytest.mark.slow
def test_points_ends_and_words_are_those_of_the_branch(branch: Branch) -> None:
    positions, multipliers = plot.branch_figure(branch).axes
    ends = [(end, row) for end, row in zip(branch.ends, (0, -1), strict=True) if end.kind in END_MARKERS]
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
    expected = {branch.word: (branch.values.min() + branch.values.max()) / 2} | {
        end.beyond: end.value for end, _ in ends
    }
    assert words == {f"$P_{{{word[1:]}}}$": place for word, place in expected.items()}


def marks_of_ends(ax: Axes) -> set[tuple[str, float, float]]:
    """Return kind, value and height of each mark at an end of a branch."""
    kinds = {marker: kind for kind, marker in END_MARKERS.items()}
    dots = [line for line in ax.lines if line.get_marker() in kinds]
    return {(kinds[str(line.get_marker())], *map(float, np.asarray(line.get_xydata())[0])) for line in dots}  # type: ignore[misc]


@pytest.mark.slow
def test_a_style_of_lines_reaches_a_border_by_any_of_its_names() -> None:
    for given in ({"lw": 3, "c": "red"}, {"linewidth": 3, "color": "red"}):
        line = answer("border").plot(**given).axes[0].lines[0]
        assert (line.get_linewidth(), line.get_color()) == (3, "red")


# -- cross-checks -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_figure_marks_events_and_tolerances(tmp_path: Path) -> None:
    run = solve(load_scene("fig8"), 3.6, **TIGHT)
    result = crosscheck("fig8", run.t, run.x, run.v)
    drawing = figure(result)
    for ax in drawing.axes:
        missed = [line.get_xdata()[0] for line in ax.lines if line.get_label() == "event, missed"]  # type: ignore[index]
        assert missed == pytest.approx([event.t for event in result.missed])
    error = next(line for line in drawing.axes[0].lines if line.get_label() == "$x$, relative")
    assert np.nanmax(np.asarray(error.get_ydata(), dtype=float)) * result.scales[0] == pytest.approx(result.max_error_x)


# -- one step ---------------------------------------------------------------------------------------------------------


def test_the_first_wrong_step_is_drawn() -> None:
    t = np.linspace(0, 7, 100)
    x, v = simulate("fig5", t_end=7)(t)
    v[67] += 0.3
    check = crosscheck("fig5", t, x, v)
    drawing = plot.step_figure(check)
    assert [axes.get_ylabel() for axes in drawing.axes] == ["$v$", "$x$"]
    lines = {line.get_label(): line for line in drawing.axes[0].get_lines()}
    exact = lines["exact, from the sample before"]
    step = check.first_wrong.step if check.first_wrong else -1
    assert step == 66
    assert exact.get_xdata()[[0, -1]] == pytest.approx(check.t[step : step + 2])  # type: ignore[index]
    given = lines["given, end of this step"].get_ydata()
    assert exact.get_ydata()[-1] - given[0] == pytest.approx(check.defects[step, 1], abs=1e-9)  # type: ignore[index]
    assert "exact, from the sample before" in [text.get_text() for text in drawing.legends[0].get_texts()]


# -- certificates -----------------------------------------------------------------------------------------------------


def test_widths_are_those_of_the_enclosures() -> None:
    axes = Figure().add_subplot()
    assert PROVEN.plot(ax=axes) is axes.figure
    drawn = np.array([line.get_xydata() for line in axes.lines])
    assert drawn[:, 0, 0] == pytest.approx([1.58260582141] * 2, rel=1e-12)
    assert drawn[:, 0, 1] == pytest.approx([2e-11, 1e-11], rel=1e-9)


# -- scores -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_each_case_is_where_it_belongs() -> None:
    cases = list(small_set())
    good = score("good", cases, {case.name: right(case) for case in cases})
    bad = score("bad", cases, {cases[0].name: CaseResult(right(cases[0]).events[1:])})
    drawing = plot.score_figure([good, bad])
    (ax,) = drawing.axes
    heights = [list(line.get_ydata()) for line in ax.lines[:2]]
    happening = [case for case in cases if any(event.kind != "graze" for event in case.events)]
    assert heights[0] == [LEAST_UNITS] * len(happening)  # no error at all
    assert heights[1] == [FAULTY] + [ABSENT] * (len(cases) - 1)
    assert [label.get_text() for label in ax.get_xticklabels()] == list(dict.fromkeys(case.group for case in cases))
    assert [text.get_text() for text in drawing.legends[0].get_texts()] == ["good", "bad"]
    looks = {(line.get_color(), line.get_marker()) for line in ax.lines[:2]}
    assert len(looks) == 2


def test_a_fit_is_drawn_with_its_data_and_residuals() -> None:
    motion, noise = simulate("fig5", t_end=20), np.random.default_rng(3)
    data = [(event.t + noise.normal(scale=1e-3), event.kind) for event in motion.events]
    found = symosc.fit("fig5", data, "mu1", sigma=1e-3)
    above, below = found.plot().axes
    labels = [line.get_label() for line in above.lines]
    assert below.get_ylabel() == r"residual / $\sigma$"
    assert symosc.fit("fig5", data, "mu1").plot(panels="b").axes[0].get_ylabel() == "residual"
    assert labels == ["fitted motion", "measured stick", "measured slip"]
    np.testing.assert_allclose(below.lines[0].get_ydata(), found.residuals)
    t = np.linspace(0, 7, 40)
    x, v = motion(t)
    both = symosc.fit("fig5", {"t": t, "x": x + 1e-3, "v": v}, "x0", sigma=(1e-2, 1e-2)).plot(panels="b")
    assert [len(np.atleast_1d(line.get_xdata())) for line in both.axes[0].lines][:2] == [40, 40]
