"""Figures of sweeps and ensembles: what is drawn is what was recorded, told apart without colours."""

from __future__ import annotations

import numpy as np
import pytest
from answers import answer
from bad_values import refused
from matplotlib.figure import Figure
from small_sweeps import made_up

from symosc import Summary, plot, sweep
from symosc.plot.sweeps import MOST_CLASSES, borders, classes_of

# -- sweeps over one axis ---------------------------------------------------------------------------------------------


pytest.importorskip("xarray")
ONE_AXIS = {"Omega": "1:6:40"}


def section(cells: dict[str, np.ndarray]) -> np.ndarray:
    return cells["Omega"][:, None, None] * np.array([[1, 2], [3, 4], [5, 6]])


@pytest.mark.parametrize(("component", "factors"), [("x", [1, 3, 5]), ("v", [2, 4, 6])])
def test_a_point_for_each_recorded_period(component: str, factors: list[int]) -> None:
    axes = plot.bifurcation_figure(made_up(ONE_AXIS, section=section), component).axes[0]
    points = np.asarray(axes.collections[0].get_offsets())
    assert len(points) == 120
    assert sorted({round(float(y / x)) for x, y in points}) == factors
    assert axes.get_xlim() == (1, 6)


def test_a_bifurcation_diagram_marks_where_the_word_changes() -> None:
    found = sweep("fig9", {"Omega": "2:5:13"}, record=["section:1", "word"], t_end="40T")
    (axes,) = plot.bifurcation_figure(found).axes
    words = found.word.values.tolist()
    values = found.Omega.values
    changes = [(values[i] + values[i - 1]) / 2 for i in range(1, len(words)) if words[i] != words[i - 1]]
    assert [line.get_xdata()[0] for line in axes.lines] == pytest.approx(changes)
    assert "$P_{3121}$" in {text.get_text() for text in axes.texts}


def test_numbers_are_a_curve_and_words_are_levels() -> None:
    dataset = made_up(
        ONE_AXIS, stuck=lambda cells: cells["Omega"] / 6, word=lambda cells: np.where(cells["Omega"] > 3, "P32", "")
    )
    (line,) = plot.curve_figure(dataset).axes[0].lines
    assert np.array_equal(line.get_ydata(), dataset.stuck.values)
    axes = plot.curve_figure(dataset, "word").axes[0]
    assert [text.get_text() for text in axes.get_yticklabels()] == ["no event", "$P_{32}$"]


# -- sweeps over two axes ---------------------------------------------------------------------------------------------


OVER = {"Omega": "1:6:30", "FN": "1:20:20"}
WORDS = np.array(["P32", "P3212", "P2", ""])


def bands(cells: dict[str, np.ndarray]) -> np.ndarray:
    return np.clip(cells["Omega"] - 1, 0, 3.5).astype(int)


def legend(drawing: Figure) -> list[str]:
    return [text.get_text() for text in drawing.legends[0].get_texts()]


@pytest.mark.parametrize("seed", [0, 3])
def test_cells_have_the_class_of_their_value(seed: int) -> None:
    rng = np.random.default_rng(seed)
    words = rng.choice(["P32", "P2", "", "P56", *(f"P{i}" for i in range(100, 100 + 5 * seed))], (12, 9))
    doubt = rng.random(words.shape) < 0.1
    codes, looks = classes_of(words, doubt)
    names = [name for name, _, _ in looks]
    assert len(names) <= MOST_CLASSES + 1
    for word, code, undecided in zip(words.ravel(), codes.ravel(), doubt.ravel(), strict=True):
        name = names[code]
        assert name == ("undecidable" if undecided else word or "no event") or name.endswith(" others")
    kept = [name for name in names if name != "undecidable" and not name.endswith(" others")]
    counts = [np.sum(words == ("" if name == "no event" else name)) for name in kept]
    assert counts == sorted(counts, reverse=True)  # the rarest are the others


@pytest.mark.parametrize("seed", range(2))
def test_borders_are_where_the_class_changes(seed: int) -> None:
    codes = np.random.default_rng(seed).integers(0, 3, (6, 5))
    lines = borders(np.arange(7.0), np.arange(6.0), codes)
    assert len(lines) == np.sum(codes[1:] != codes[:-1]) + np.sum(codes[:, 1:] != codes[:, :-1])
    for (x1, y1), (x2, y2) in lines:
        middle = np.array([x1 + x2, y1 + y2]) / 2
        step = np.array([y2 - y1, x2 - x1]) / 2
        (a, b), (c, d) = np.floor(middle - step).astype(int), np.floor(middle + step).astype(int)
        assert codes[a, b] != codes[c, d]


def test_a_map_of_words() -> None:
    dataset = made_up(
        OVER,
        word=lambda cells: WORDS[bands(cells)],
        status=lambda cells: np.where(cells["FN"] + cells["Omega"] < 3, "undecidable", "t_end"),
    )
    drawing = plot.map_figure(dataset)
    assert {*legend(drawing)} == {"$P_{32}$", "$P_{3212}$", "$P_{2}$", "no event", "undecidable"}
    axes = drawing.axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == (r"$\Omega$", "$F_N$")
    inside = {text.get_text(): text.get_position() for text in axes.texts}
    for name, (omega, _) in inside.items():  # each name is on its own class
        word = WORDS[bands({"Omega": np.array([omega])})][0]
        assert name == (f"$P_{{{word[1:]}}}$" if word else "no event")
    assert len(inside) >= 3


def test_cells_that_are_undecidable_are_hatched() -> None:
    dataset = made_up(
        OVER,
        word=lambda cells: WORDS[bands(cells)],
        status=lambda cells: np.where(cells["FN"] + cells["Omega"] < 3, "undecidable", "t_end"),
    )
    axes = plot.map_figure(dataset).axes[0]
    (hatched,) = (each for each in axes.collections if each.get_hatch())
    middles = np.sort([np.asarray(path.vertices)[:4].mean(axis=0) for path in hatched.get_paths()], axis=0)
    omega, force = np.meshgrid(dataset.Omega, dataset.FN, indexing="ij")
    here = omega + force < 3
    assert middles == pytest.approx(np.sort(np.column_stack([omega[here], force[here]]), axis=0))
    mesh = axes.collections[0]
    colors = mesh.to_rgba(np.asarray(mesh.get_array()).reshape(20, 30))
    for text in axes.texts:  # black on light, or white on dark
        x, y = text.get_position()
        color = colors[np.abs(dataset.FN.values - y).argmin(), np.abs(dataset.Omega.values - x).argmin()]
        assert abs(color[:3].mean() - (text.get_color() == "white")) > 0.4


def test_whole_numbers_are_classes_and_others_are_shades() -> None:
    whole = plot.map_figure(made_up(OVER, sticks=bands), "sticks")
    assert (len(whole.legends), len(whole.axes)) == (1, 1)
    shades = plot.map_figure(made_up(OVER, stuck=lambda cells: bands(cells) / 3), "stuck")
    assert (len(shades.legends), len(shades.axes)) == (0, 2)  # the second axes are the colour bar


def test_a_basin_has_the_belts() -> None:
    dataset = made_up({"v0": "-3:3:9", "x0": "-1:1:5"}, word=lambda cells: WORDS[(cells["v0"] > 0).astype(int)])
    axes = plot.basin_figure(dataset).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$x_0$", "$v_0$")
    lines = [line.get_ydata()[0] for line in axes.lines]  # type: ignore[index]
    assert lines == [1]  # belt 1 of fig9; belt 2 runs with 25
    refused(lambda: plot.basin_figure(made_up(OVER, sticks=bands)), "dataset")


# -- ensembles --------------------------------------------------------------------------------------------------------


def test_every_event_has_a_mark() -> None:
    events = answer("events")
    axes = events.plot().axes[0]
    drawn = {line.get_label(): line.get_xydata() for line in axes.lines}
    assert sum(map(len, drawn.values())) == len(events)
    here = events.kind == "cross"
    assert np.array_equal(drawn["crossing"], np.column_stack([events.t, events.trajectory])[here])
    low, high = axes.get_ylim()
    assert low < 0 < len(events.status) - 1 < high


@pytest.mark.parametrize("seed", range(2))
def test_bars_count_all_motions(seed: int) -> None:
    words = np.random.default_rng(seed).choice([f"P{n}" for n in range(11, 11 + 7 * (seed + 1))], 300)
    axes = Summary(word=words).plot().axes[0]
    counts = [bar.get_width() for bar in axes.patches]
    assert sum(counts) == 300
    names = [tick.get_text() for tick in axes.get_yticklabels()]
    assert len(names) == len(counts) <= 12
    assert counts[0] == max(np.unique(words, return_counts=True)[1])
    assert ("others" in names[-1]) == (len(set(words)) > 12)
