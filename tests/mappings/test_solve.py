"""solve_map: where a mapping leads."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from symosc import Parameters, load_scene, simulate
from symosc.errors import ParameterError
from symosc.mappings.solve import solve_map
from symosc.simulation.trajectory import MAP_LABELS


@pytest.mark.parametrize("name", ["fig6", "fig9", "fig10", "fig9-orbit", "fig10-orbit"])
def test_solve_map_follows_the_simulator(name: str) -> None:
    scene = load_scene(name)
    p, Omega = scene.parameters, float(scene.parameters.Omega)
    events = simulate(scene, max_events=12).events
    for before, after in itertools.pairwise(events):
        label = MAP_LABELS[before.boundary, before.target, after.boundary]
        found = solve_map(p, label, before.x, before.theta + 4 * np.pi)
        assert found.x == pytest.approx(after.x, abs=1e-10)
        assert found.theta - before.theta - 4 * np.pi == pytest.approx(Omega * (after.t - before.t), abs=1e-10)
        assert (found.exit is not None) == (after.kind == "slip")


@pytest.fixture
def p() -> Parameters:
    return load_scene("fig10").parameters


@pytest.mark.parametrize(
    "start", [("a", 0), (None, 0), (1, None), (1j, 0), (1, "0"), (float("nan"), 0), (np.ones(2), 0)]
)
def test_solve_map_names_what_is_no_number(p: Parameters, start: Any) -> None:
    with pytest.raises(ParameterError, match=r"x_i|theta_i"):
        solve_map(p, "P5", *start)
