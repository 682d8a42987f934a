"""The figure of a frequency response: all finite values are shown, and it says what is not."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes

from symosc import Belt, Oscillator, OtherModel, frequency_response
from symosc.analysis.response import FrequencyResponse
from symosc.orbits import settling
from symosc.plot.sweeps import FEW_POINTS, RESPONSE_PANELS

#: A base that moves by cos(Omega t), with light damping and friction: a high peak, finite.
PEAK = OtherModel(m=1, k=1, c="0.05", FN="0.2", Y=1, Omega=1)


def texts(axes: Axes) -> str:
    return " ".join(item.get_text() for item in axes.texts)


def response(found: dict[str, np.ndarray], count: int = 60) -> FrequencyResponse:
    """Return a made-up response over Omega with some of its columns as given."""
    columns = {
        name: np.ones(count)
        for name in (
            "amplitude", "transmissibility", "phase", "harmonic", "work", "dissipated", "damper",
            "friction", "stuck", "balance", "balance_error", "error",
        )
    }  # fmt: skip
    words = {"status": np.full(count, "orbit"), "word": np.full(count, "P32")}
    return FrequencyResponse(
        name="Omega", values=np.linspace(0.5, 1.5, count), **words, **columns | found
    )


def test_a_finite_peak_is_not_cut_off() -> None:
    """Of a list that had it cut off: 14.68 of an axis that ended at 12.77."""
    response = frequency_response(PEAK, {"Omega": "0.9:1.1:21"})
    assert response.amplitude.max() == pytest.approx(14.93, abs=0.3)
    wide = frequency_response(PEAK, {"Omega": [*np.linspace(0.5, 2, 41), 1.0]})
    for answer in (response, wide):
        drawing = answer.plot("abd")
        for axes in drawing.axes:
            top = axes.get_ylim()[1]
            for line in axes.lines:
                heights = np.asarray(line.get_ydata(), dtype=float)
                assert np.nanmax(heights) <= top
            assert "cut off" not in texts(axes)


@pytest.mark.parametrize("seed", range(10))
def test_random_peaks_are_shown_whole(seed: int) -> None:
    rng = np.random.default_rng(seed)
    high = 10.0 ** rng.uniform(0, 6, 60)
    drawing = response({"amplitude": high, "balance": rng.permutation(high) * 2}).plot("a")
    assert drawing.axes[0].get_ylim()[1] >= 2 * high.max()


def test_only_a_true_resonance_is_cut_off_and_the_figure_says_so() -> None:
    result = frequency_response(PEAK.replace(c=0), {"Omega": "0.5:1.5:41"})
    assert np.isinf(result.balance).sum() == 1
    for axes in result.plot("ab").axes:
        assert "infinite at $\\Omega$ = 1" in texts(axes)
        assert "higher values cut off" in texts(axes)
        assert axes.get_ylim()[1] < np.nanmax(result.amplitude)
    # what fits is not said to be cut off
    low = response({"balance": np.where(np.arange(60) == 30, np.inf, 1.0)})
    (axes,) = low.plot("a").axes
    assert "infinite at" in texts(axes)
    assert "cut off" not in texts(axes)


def test_few_values_have_markers() -> None:
    for count, marker in ((3, "o"), (FEW_POINTS, "o"), (FEW_POINTS + 1, "None")):
        drawing = response({}, count).plot()
        lines = [line for axes in drawing.axes for line in axes.lines if len(line.get_xdata()) > 2]
        curves = [line for line in lines if len(line.get_xdata()) == count]
        assert {line.get_marker() for line in curves} <= {marker}


def test_each_panel_can_be_drawn_without_a_finite_value() -> None:
    nothing = dict.fromkeys(("amplitude", "transmissibility", "balance"), np.full(60, np.nan))
    assert len(response(nothing).plot().axes) == len(RESPONSE_PANELS)


def test_up_and_down_are_told_apart_without_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settling, "SETTLING_LOOPS", (60,))
    law = {"m": 1, "c": "1/10", "k": 1, "B0": "1/10", "Omega": 1}
    belt = Belt("3/2", curve=[(0, 1), ("1/4", "4/5"), (1, "14/25"), (3, "1/2")])
    found = frequency_response(Oscillator(**law, belts=[belt]), {"Omega": [0.9, 1.0, 1.1]})
    drawing = found.plot()
    assert [axes.get_ylabel() for axes in drawing.axes[:2]] == ["amplitude", "transmissibility"]
    assert len(drawing.axes) == 5
    up, down = drawing.axes[0].lines[:2]
    assert (up.get_label(), down.get_label()) == ("upwards", "downwards")
    assert up.get_xdata().tolist() == down.get_xdata().tolist() == [0.9, 1.0, 1.1]
    looks = [(line.get_marker(), line.get_linestyle(), line.get_color()) for line in (up, down)]
    assert looks == [("^", "-", "black"), ("v", "--", "0.55")]
    with pytest.raises(ValueError, match="panels"):
        found.plot("f")
