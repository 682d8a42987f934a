"""`symosc grazing` and its figures."""

from __future__ import annotations

import json
from functools import partial
from typing import Any

import cli_runs
import numpy as np
import pytest
from sympy.parsing.sympy_parser import parse_expr

from symosc.grazing.window import grazing_window
from symosc.kernels.theorem7_cases import ORDERS
from symosc.plot.windows import sweep_figure
from symosc.scenes import load_scene, scene_names

FIG9 = load_scene("fig9").parameters
MAPS = ("P2", "P3", "P5", "P6")


good = partial(cli_runs.good, "grazing")


@pytest.mark.parametrize("name", scene_names())
def test_json_says_what_python_says(name: str) -> None:
    data = json.loads(good(name, "--json"))
    assert data["scene"] == name
    assert data["parameters"] == load_scene(name).parameters.as_dict()
    for shown, mapping in zip(data["windows"], MAPS, strict=True):
        window = grazing_window(load_scene(name).parameters, mapping)
        assert (shown["map"], shown["case"], shown["latex"]) == (
            mapping,
            window.case,
            window.latex(),
        )
        assert [tuple(interval.values()) for interval in shown["intervals"]] == list(
            window.intervals
        )
        if window.theta_cr is None:
            assert shown["theta_cr"] is None
        else:
            assert parse_expr(shown["theta_cr"]["exact"]) == window.theta_cr
            assert shown["theta_cr"]["value"] == pytest.approx(float(window.theta_cr), rel=1e-15)


# -- --solve: for which parameters


# -- what the figures show -------------------------------------------------------------------------------------------


def shaded(axes: Any, x: float, y: float) -> bool:
    return any(
        path.contains_point((x, y)) for area in axes.collections for path in area.get_paths()
    )


@pytest.mark.full(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("mapping", "name"),
    [
        ("P2", "Omega"),
        ("P2", "B0"),
        ("P2", "k"),
        ("P3", "v1"),
        ("P5", "v2"),
        ("P6", "B0"),
        ("P6", "v2"),
        ("P3", "k"),
    ],
)
def test_sweep_figure_shades_the_window(mapping: str, name: str) -> None:
    rng = np.random.default_rng(1)
    axes = sweep_figure(FIG9, mapping, name).axes[0]
    low, high = axes.get_xlim()
    answers = []
    for value, theta in zip(
        rng.uniform(low, high, 200), rng.uniform(0, 2 * np.pi, 200), strict=True
    ):
        window = grazing_window(FIG9.replace(**{name: value}), mapping)
        near = [abs(theta - end) for low, high, *_ in window.intervals for end in (low, high)]
        if min(near, default=1.0) > 0.02:
            answers.append(window.contains(theta))
            assert shaded(axes, value, theta) == answers[-1], (value, theta)
    assert 3 < sum(answers) < len(answers) - 3


def test_a_drive_that_the_paper_leaves_out_is_not_as_printed() -> None:
    turned = ["fig9", "--set", "B0=-9", "--map", "P2"]
    said = "P2: not as printed: the paper supposes B0 > 0"
    assert said in good(*turned, "--order", "paper")
    assert said not in good(*turned)
    assert said not in good("fig9", "--map", "P2", "--order", "paper")
    for order in ORDERS:
        window = grazing_window(FIG9.replace(B0=-9), "P2", order)
        assert bool(window.not_as_printed) == (order == "paper")
        assert ("not as printed" in repr(window)) == (order == "paper")
