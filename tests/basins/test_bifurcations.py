"""Bifurcation diagrams: where attractors coexist, against attractors found one by one."""

from __future__ import annotations

from math import exp, pi
from typing import Any

import numpy as np
import pytest
from stiction_solver import solved

from symosc import Belt, Oscillator, ParameterError, attractors, bifurcation, load_scene, plot

STICKY = Oscillator(
    m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.7")]
)
FALLING = Oscillator(
    m=1, c="0.1", k=1,
    belts=[Belt.from_function("1.5", lambda w: 0.5 + 0.5 * exp(-w / 0.5), 4, 16)],
)  # fmt: skip


@pytest.mark.compiled("doubles")
def test_what_is_reached_downward_alone_is_the_other_attractor() -> None:
    found = bifurcation(STICKY, {"mu_s1": "0.86:1.16:16"}, sections=16, skip=150)
    assert found.points.shape == (16, 2, 16, 2)
    i = int(np.argmin(abs(found.values - 0.98)))
    assert found.attractor[i].tolist() == [0, 1]
    assert found.attractor[0].tolist() == [0, 0]
    orbits = attractors(STICKY.replace(mu_s1=0.98), {"x0": "-2:2:9", "v0": "-1:1:5"}).orbits
    turn = 2 * pi / 1.4
    for orbit, branch in zip(orbits, (0, 1), strict=True):
        states = orbit(turn * np.arange(orbit.periods)).T
        away = np.abs(found.points[i, branch, :, None] - states).max(axis=-1).min(axis=-1)
        assert away.max() < 1e-4


@pytest.mark.compiled("doubles")
def test_section_points_are_those_of_scipy() -> None:
    found = bifurcation(STICKY, {"Omega": [1.3, 1.4]}, starts=[(0, 1, 0)], sections=2, skip=20)
    assert found.branches == ("upward", "downward", "start 1")
    turn = 2 * pi / 1.3
    states = solved(STICKY.replace(Omega=1.3), (0.0, 1.0, 0.0), 22 * turn)(
        [21 * turn, 22 * turn - 1e-9]
    )
    assert np.abs(found.points[0, 2] - states.T).max() < 1e-7


@pytest.mark.compiled("doubles")
def test_rest_and_cycle_coexist_between_the_onset_and_the_last_touch() -> None:
    found = bifurcation(FALLING, {"v1": [1.1, 1.4, 1.8, 1.9]})
    assert found.branches == ("rest", "cycle 1")
    there = np.isfinite(found.points[:, :, 0, 0])
    assert there.T.tolist() == [[False, True, True, True], [True, True, True, False]]
    assert found.coexisting.tolist() == [False, True, True, False]
    data = found.to_xarray()
    assert data.section.dims == ("v1", "branch", "period", "component")
    frame = found.to_pandas()
    assert list(frame) == ["v1", "branch", "attractor", "period", "x", "v"]
    assert frame.groupby("branch").v1.apply(list).to_dict() == {
        "rest": [1.4, 1.8, 1.9], "cycle 1": [1.1, 1.4, 1.8],
    }  # fmt: skip
    for _, row in frame.iterrows():
        place = {"v1": row.v1, "branch": row.branch}
        assert data.section.sel(place).values[row.period].tolist() == [row.x, row.v]
        assert data.attractor.sel(place) == row.attractor


@pytest.mark.compiled("doubles")
def test_static_friction_of_a_scene_of_the_paper() -> None:
    """Its Parameters have none: the diagram is that of the Oscillator with it."""
    p = load_scene("fig9").parameters
    over = {"mu_s1": [0.3, 0.9]}
    of_scene, of_oscillator = (
        bifurcation(what, over, sections=2, skip=2) for what in (p, p.oscillator)
    )
    assert np.array_equal(of_scene.points, of_oscillator.points)
    assert np.isfinite(of_scene.points).all()


def test_the_diagram_tells_attractors_apart() -> None:
    found = bifurcation(FALLING, {"v1": [1.1, 1.5]})
    (axes,) = found.plot().axes
    assert axes.get_xlabel() == "$v_1$"
    assert len({line.get_marker() for line in axes.get_lines()}) == 2
    assert plot.bifurcation_figure(found, "v").axes


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"over": {"x0": [1, 2]}}, "x0"),
        ({"over": {"Omega": [1], "k": [1]}}, "over"),
        ({"sections": 0}, "sections"),
        ({"skip": -1}, "skip"),
        ({"what": FALLING, "over": {"v1": [1]}, "starts": (0, 0, 0)}, "without a drive"),
    ],
)
def test_wrong_arguments_are_named(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        bifurcation(**{"what": STICKY, "over": {"Omega": [1, 2]}} | changes)
