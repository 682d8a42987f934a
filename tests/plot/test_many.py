"""Figures of many motions: each event has its mark, each value its bar, and the counts are those of the columns."""

from __future__ import annotations

import numpy as np
import pytest
from answers import answer
from bad_values import refused
from matplotlib.figure import Figure

from symosc import Summary, plot


def test_every_event_has_a_mark() -> None:
    events = answer("events")
    axes = events.plot().axes[0]
    drawn = {line.get_label(): line.get_xydata() for line in axes.lines}
    assert sum(map(len, drawn.values())) == len(events)
    here = events.kind == "cross"
    assert np.array_equal(drawn["crossing"], np.column_stack([events.t, events.trajectory])[here])
    low, high = axes.get_ylim()
    assert low < 0 < len(events.status) - 1 < high


def test_no_events_say_so() -> None:
    assert [text.get_text() for text in answer("no events").plot().axes[0].texts] == ["no event"]


@pytest.mark.parametrize("seed", range(3))
def test_bars_count_all_motions(seed: int) -> None:
    words = np.random.default_rng(seed).choice([f"P{n}" for n in range(11, 11 + 7 * (seed + 1))], 300)
    axes = Summary(word=words).plot().axes[0]
    counts = [bar.get_width() for bar in axes.patches]
    assert sum(counts) == 300
    names = [tick.get_text() for tick in axes.get_yticklabels()]
    assert len(names) == len(counts) <= 12
    assert counts[0] == max(np.unique(words, return_counts=True)[1])
    assert ("others" in names[-1]) == (len(set(words)) > 12)


@pytest.mark.parametrize("name", ["section", "stuck", "mode", "sticks", "events"])
def test_every_column_is_drawn_into_given_axes(name: str) -> None:
    axes = Figure().add_subplot()
    assert answer("summary").plot(name=name, ax=axes) is axes.figure
    assert axes.has_data()


def test_what_cannot_be_drawn() -> None:
    refused(lambda: plot.events_figure(3), "events")  # type: ignore[arg-type]
    refused(lambda: plot.summary_figure(answer("events")), "summary")
    refused(lambda: answer("summary").plot(name="words"), "name")
    refused(lambda: Summary().plot(), "name")
    refused(lambda: answer("summary").plot(ax=3), "ax")
