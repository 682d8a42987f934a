"""The figure of a certificate: its widths are those of the enclosures."""

from __future__ import annotations

import numpy as np
import pytest
from answers import PROVEN, answer
from bad_values import refused
from matplotlib.figure import Figure

from symosc import plot


def test_widths_are_those_of_the_enclosures() -> None:
    axes = Figure().add_subplot()
    assert PROVEN.plot(ax=axes) is axes.figure
    drawn = np.array([line.get_xydata() for line in axes.lines])
    assert drawn[:, 0, 0] == pytest.approx([1.58260582141] * 2, rel=1e-12)
    assert drawn[:, 0, 1] == pytest.approx([2e-11, 1e-11], rel=1e-9)


def test_what_cannot_be_drawn() -> None:
    refused(lambda: answer("open certificate").plot(), "certificate")
    refused(lambda: plot.certificate_figure("fig5"), "certificate")  # type: ignore[arg-type]
    refused(lambda: PROVEN.plot(ax="axes"), "ax")
