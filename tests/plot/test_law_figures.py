"""The figure of a friction law."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from symosc import Belt, Oscillator, ParameterError, load_scene, plot
from symosc.scenes import load_template

FALLING = Belt(1, curve=[(0, 0.4), (0.5, 0.25)], slope=0.1, mu_s=0.6)
LAW = Oscillator(m=1, c=0.3, k=1, A0=7, FN=2, belts=[FALLING, Belt(4, 0.5)])


def lines(axes: Axes, label: str) -> list[list[list[float]]]:
    """Return the ends of the lines of the collection with a label, ordered by velocity and force."""
    (drawn,) = (item for item in axes.collections if item.get_label() == label)
    assert isinstance(drawn, LineCollection)
    return sorted(np.sort(np.round(path, 12), axis=0).tolist() for path in drawn.get_segments())


def test_the_kinetic_force_is_that_of_the_law() -> None:
    (axes,) = LAW.plot(v=(-1, 6)).axes
    (kinetic,) = (line for line in axes.lines if line.get_label() == "slips: one value")
    v, force = np.array(kinetic.get_data(), dtype=float)
    # Against the motion: 2 mu(w) of belt 1, with its curve, and 2 times 0.5 of belt 2.
    wanted = [
        *[(-1, -0.8 - 1), (0.5, -0.5 - 1), (1, -0.8 - 1), (np.nan, np.nan)],
        *[(1, 0.8 - 1), (1.5, 0.5 - 1), (4, 1 - 1), (np.nan, np.nan), (4, 1 + 1), (6, 1.4 + 1)],
    ]
    points = list(dict.fromkeys(zip(v.tolist(), force.round(12).tolist(), strict=True)))
    assert len(points) == len(wanted)
    assert np.allclose(points, wanted, atol=1e-12, equal_nan=True)


def test_sticks_static_limits_and_corners() -> None:
    (axes,) = LAW.plot(v=(-1, 6)).axes
    assert lines(axes, "sticks: any value") == [[[1, -1.8], [1, -0.2]], [[4, 0], [4, 2]]]
    # Belt 1 holds 2 * 0.6 either way, beside the force of belt 2.
    ends = lines(axes, "static friction")
    assert [end for end in ends if end[0][0] == end[1][0]] == [
        [[1, -2.2], [1, -1.8]],
        [[1, -0.2], [1, 0.2]],
    ]
    bars = [end for end in ends if end[0][0] != end[1][0]]
    assert [bar[0][1] for bar in bars] == [bar[1][1] for bar in bars] == [-2.2, 0.2]
    corners = [line for line in axes.lines if line.get_color() == "0.8"]
    assert [line.get_xdata()[0] for line in corners] == [0.5, 1.5]  # type: ignore[index]
    assert [text.get_text() for text in axes.texts] == ["$v_1$", "$v_2$"]
    assert axes.get_xlabel() == r"velocity $\dot{x}$"


def test_the_law_of_the_paper_is_its_figure_2() -> None:
    p = load_scene("fig5").parameters
    (axes,) = p.plot().axes
    (kinetic,) = (line for line in axes.lines if line.get_label() == "slips: one value")
    forces = np.array(kinetic.get_data(), dtype=float)[1]
    levels = [float(level * p.FN) for level in (-p.mu1 - p.mu2, p.mu1 - p.mu2, p.mu1 + p.mu2)]
    assert np.allclose(np.unique(forces[~np.isnan(forces)]), levels)
    labels = [text.get_text() for text in axes.figure.legends[0].get_texts()]  # type: ignore[union-attr]
    assert labels == ["slips: one value", "sticks: any value"]
    assert [line for line in axes.lines if line.get_color() == "0.8"] == []


def test_axes_of_a_users_own_and_a_style() -> None:
    own = Figure().subplots()
    drawing = plot.friction_figure(load_template("stribeck"), ax=own, color="green", lw=3)
    assert drawing is own.figure
    assert [line.get_color() for line in own.lines if line.get_linewidth() == 3] == ["green"]


def test_a_smooth_law_has_no_corners_drawn() -> None:
    law = Oscillator(m=1, c=0, k=1, belts=[Belt.from_function(0, lambda w: 1 / (1 + w), 2)])
    (axes,) = law.plot().axes
    assert [line for line in axes.lines if line.get_color() == "0.8"] == []


@pytest.mark.parametrize(
    ("options", "name", "said"),
    [
        ({"v": (2, 1)}, "v", "increasing velocities"),
        ({"v": 3}, "v", "must be a pair"),
        ({"v": ("low", 1)}, "v", "give a number"),
        ({"colour": "red"}, "colour", "did you mean color"),
        ({"ax": 1}, "ax", "axes of matplotlib"),
    ],
)
def test_wrong_arguments_are_one_sentence(options: dict[str, object], name: str, said: str) -> None:
    with pytest.raises(ParameterError, match=said) as caught:
        LAW.plot(**options)
    assert caught.value.name == name
