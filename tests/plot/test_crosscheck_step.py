"""The picture of one step: the exact motion, what was given, and the event between."""

from __future__ import annotations

import numpy as np
import pytest
from excerpts import crosscheck
from matplotlib.figure import Figure

from symosc import ParameterError, plot, simulate
from symosc.crosschecks.report import CrossCheck


def spoilt() -> CrossCheck:
    t = np.linspace(0, 7, 100)
    x, v = simulate("fig5", t_end=7)(t)
    v[67] += 0.3
    return crosscheck("fig5", t, x, v)


def test_the_first_wrong_step_is_drawn() -> None:
    check = spoilt()
    drawing = plot.step_figure(check)
    assert [axes.get_ylabel() for axes in drawing.axes] == ["$v$", "$x$"]
    lines = {line.get_label(): line for line in drawing.axes[0].get_lines()}
    exact = lines["exact, from the sample before"]
    step = check.first_wrong.step if check.first_wrong else -1
    assert step == 66
    assert exact.get_xdata()[[0, -1]] == pytest.approx(check.t[step : step + 2])  # type: ignore[index]
    given = lines["given, end of this step"].get_ydata()
    assert exact.get_ydata()[-1] - given[0] == pytest.approx(check.defects[step, 1], abs=1e-9)  # type: ignore[index]


def test_events_of_the_step_are_marked() -> None:
    check = spoilt()
    event = check.trajectory.events[0]
    step = int(np.searchsorted(check.t, float(event.t))) - 1
    axes = plot.step_figure(check, step, "a").axes[0]
    marked = [line.get_xdata()[0] for line in axes.get_lines() if line.get_label() == "exact event"]  # type: ignore[index]
    assert marked == pytest.approx([float(event.t)], abs=1e-6)
    assert event.kind in {text.get_text() for text in axes.texts}


def test_bad_input_costs_a_line() -> None:
    check = spoilt()
    for step in (-1, len(check.t) - 1, "first"):
        with pytest.raises(ParameterError, match="step"):
            plot.step_figure(check, step)  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="panels"):
        plot.step_figure(check, 0, "c")
    with pytest.raises(ParameterError, match="check"):
        plot.step_figure("check")  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="ax"):
        plot.step_figure(check, 0, "a", ax=3)  # type: ignore[arg-type]
    own = Figure().subplots()
    assert plot.step_figure(check, 0, "b", ax=own) is own.figure
