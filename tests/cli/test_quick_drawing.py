"""The command `symosc figure` loads matplotlib without its help texts, and leaves no trace where others use it."""

from __future__ import annotations

import gc
import subprocess
import sys

import pytest

from symosc.cli.quick_drawing import load_matplotlib, without_collection

LOADED = """
import inspect, sys
from symosc.cli.quick_drawing import load_matplotlib
load_matplotlib()
from matplotlib import artist, lines, text
print("Supported properties" in (lines.Line2D.set.__doc__ or ""), bool(artist.kwdoc(lines.Line2D)))

class Mine(text.Text):
    def set_answer(self, value):
        "Set it.\\n\\nParameters\\n----------\\nvalue : int"
        self.answer = value

print("answer" in inspect.signature(Mine.set).parameters, "answer" in Mine.set.__doc__)
mine = Mine()
mine.set(answer=42, color="red")
print(mine.answer, mine.get_color(), lines.Line2D([], []).set(lw=2) is not None)
"""


@pytest.mark.slow
def test_texts_are_left_out_while_it_loads_alone() -> None:
    run = subprocess.run([sys.executable, "-c", LOADED], check=True, capture_output=True, text=True)
    assert run.stdout.splitlines() == ["False True", "True True", "42 red True"]


def test_nothing_is_done_where_matplotlib_is_loaded() -> None:
    from matplotlib import artist
    from matplotlib.lines import Line2D

    before = artist.kwdoc, Line2D.set.__doc__
    load_matplotlib()
    assert (artist.kwdoc, Line2D.set.__doc__) == before
    assert "Supported properties" in before[1]


def test_garbage_is_collected_again_afterwards() -> None:
    states = []
    with pytest.raises(IndexError), without_collection():
        [states.append(gc.isenabled())][2]
    assert (states, gc.isenabled()) == ([False], True)
