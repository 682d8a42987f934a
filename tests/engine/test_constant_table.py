"""Constants of many parameter sets.

Each row of the table is what the set alone gets from fractions.
"""

from __future__ import annotations

import numpy as np
import pytest
from regimes import random_sets

from symosc import Parameters, load_scene, scene_names
from symosc.engine import flow
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import ConstantRows
from symosc.model import by_name
from symosc.simulation.loops import INTERPRETED
from symosc.simulation.problems import ParameterSets


def assert_as_alone(computed: np.ndarray, sets: list[Parameters]) -> None:
    """Compare flags, and numbers but for the last bits."""
    for row, p in zip(ConstantRows(computed), sets, strict=True):
        K = Arithmetic(p).K
        for name in flow.Constants._fields:
            mine, right = (np.atleast_1d(getattr(entry, name)).astype(float) for entry in (row, K))
            np.testing.assert_allclose(mine, right, rtol=1e-14, atol=1e-30, err_msg=f"{name} {p}")


@pytest.mark.parametrize("seed", range(2))
def test_rows_are_those_of_single_sets(seed: int) -> None:
    sets = random_sets(seed, 30) + [load_scene(name).parameters for name in scene_names()]
    assert_as_alone(ParameterSets(sets).table(slice(0, len(sets)), INTERPRETED.table), sets)


def test_columns_of_doubles_are_the_decimals_that_they_print_as() -> None:
    rng = np.random.default_rng(5)
    base = by_name(load_scene("fig9").parameters, float)
    columns = base | {"Omega": rng.uniform(1, 6, 40), "c": np.round(rng.uniform(0, 1, 40), 2)}
    arguments = ParameterSets(columns)
    single = [
        Parameters(**{name: np.broadcast_to(columns[name], 40)[i] for name in base})
        for i in range(40)
    ]
    assert [arguments[i] for i in range(40)] == single
    whole = arguments.table(slice(0, 40), INTERPRETED.table)
    assert_as_alone(whole, single)
    part = {name: np.broadcast_to(column, 40)[7:8] for name, column in columns.items()}
    alone = ParameterSets(part).table(slice(0, 1), INTERPRETED.table)
    assert alone.tobytes() == whole[7:8].tobytes()  # however a sweep is cut into calls
