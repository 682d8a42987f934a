"""The picture of scores."""

from __future__ import annotations

from small_set import right, stored_set

from symosc import plot
from symosc.plot.score import ABSENT, FAULTY, LEAST_UNITS
from symosc.reference.results import CaseResult
from symosc.reference.score import score


def test_each_case_is_where_it_belongs() -> None:
    cases = list(stored_set())
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


def test_sixteen_solvers_look_different() -> None:
    cases = list(stored_set())[:1]
    scores = [score(str(i), cases, {cases[0].name: right(cases[0])}) for i in range(16)]
    lines = plot.score_figure(scores).axes[0].lines[:16]
    assert len({(line.get_color(), line.get_marker()) for line in lines}) == 16
