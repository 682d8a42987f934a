"""The figure of a cross-check."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from careful_solver import TIGHT, Run, solve
from excerpts import crosscheck

from symosc import load_scene
from symosc.crosschecks.compare import CrossCheck
from symosc.plot.crosscheck import crosscheck_figure as figure
from symosc.plot.crosscheck import write


def check(name: str, t_end: float, **options: Any) -> tuple[Run, CrossCheck]:
    run = solve(load_scene(name), t_end, **options)
    return run, crosscheck(name, run.t, run.x, run.v)


@pytest.mark.slow
def test_the_figure_marks_events_and_tolerances(tmp_path: Path) -> None:
    result = check("fig8", 3.6, **TIGHT)[1]
    drawing = figure(result)
    for ax in drawing.axes:
        missed = [line.get_xdata()[0] for line in ax.lines if line.get_label() == "event, missed"]  # type: ignore[index]
        assert missed == pytest.approx([event.t for event in result.missed])
    error = next(line for line in drawing.axes[0].lines if line.get_label() == "$x$, relative")
    assert np.nanmax(np.asarray(error.get_ydata(), dtype=float)) * result.scales[0] == pytest.approx(result.max_error_x)
    assert write(result, tmp_path / "check.png").read_bytes().startswith(b"\x89PNG")
