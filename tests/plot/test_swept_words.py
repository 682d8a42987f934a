"""Words in figures of sweeps: colours that differ in greyscale, and marks where the word changes."""

from __future__ import annotations

import pytest

pytest.importorskip("xarray", reason="the extra sweep is not installed")


from symosc import plot, sweep


def test_a_bifurcation_diagram_marks_where_the_word_changes() -> None:
    found = sweep("fig9", {"Omega": "2:5:13"}, record=["section:1", "word"], t_end="40T")
    (axes,) = plot.bifurcation_figure(found).axes
    words = found.word.values.tolist()
    values = found.Omega.values
    changes = [(values[i] + values[i - 1]) / 2 for i in range(1, len(words)) if words[i] != words[i - 1]]
    assert [line.get_xdata()[0] for line in axes.lines] == pytest.approx(changes)
    assert "$P_{3121}$" in {text.get_text() for text in axes.texts}
