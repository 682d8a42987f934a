"""Words in figures of sweeps: colours that differ in greyscale, and marks where the word changes."""

from __future__ import annotations

from itertools import pairwise

import pytest

pytest.importorskip("xarray", reason="the extra sweep is not installed")

from matplotlib.colors import to_rgb

from symosc import plot, sweep
from symosc.plot.sweeps import WORD_COLORS, luminance


def test_a_bifurcation_diagram_marks_where_the_word_changes() -> None:
    found = sweep("fig9", {"Omega": "2:5:13"}, record=["section:1", "word"], t_end="40T")
    (axes,) = plot.bifurcation_figure(found).axes
    words = found.word.values.tolist()
    values = found.Omega.values
    changes = [(values[i] + values[i - 1]) / 2 for i in range(1, len(words)) if words[i] != words[i - 1]]
    assert [line.get_xdata()[0] for line in axes.lines] == pytest.approx(changes)
    assert "$P_{3121}$" in {text.get_text() for text in axes.texts}


def test_words_have_colours_that_grow_darker() -> None:
    lightness = [luminance(to_rgb(color)) for color in WORD_COLORS]
    assert lightness[0] - lightness[-1] > 0.6
    assert all(after < before + 0.03 for before, after in pairwise(lightness))
