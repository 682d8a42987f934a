"""Constants of many parameter sets: each row of the table has the bits that the set alone gets from fractions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from regimes import random_sets

from symosc import Parameters, load_scene, scene_names
from symosc.engine import constant_table, first_rows
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.constant_table import ConstantRows, table_of
from symosc.model import PARAMETER_NAMES
from symosc.simulation.problems import ParameterSets


def table(sets: list[Parameters]) -> np.ndarray:
    def march_rows(rows: np.ndarray, out: np.ndarray) -> None:
        first_rows.march_rows(ConstantRows(rows), out)

    return ParameterSets(sets).table(slice(0, len(sets)), march_rows)


@pytest.mark.parametrize("seed", range(3))
def test_rows_have_the_bits_of_single_sets(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    sets = random_sets(seed, 60) + [load_scene(name).parameters for name in scene_names()]
    left: list[int] = []
    whole: Callable[..., np.ndarray] = constant_table.constant_table

    def counted(columns: object, count: int, alone: Callable[[int], object], march_rows: object) -> np.ndarray:
        return whole(columns, count, lambda i: left.append(i) or alone(i), march_rows)

    monkeypatch.setattr("symosc.simulation.problems.constant_table", counted)
    found = table(sets)
    expected = table_of(Arithmetic(p).K for p in sets)
    assert found.tobytes() == expected.tobytes()
    assert 0 < len(left) < len(sets) / 2  # fractions only where a decision needs them


def test_columns_of_doubles_are_the_decimals_that_they_print_as() -> None:
    rng = np.random.default_rng(5)
    base = {name: float(getattr(load_scene("fig9").parameters, name)) for name in PARAMETER_NAMES}
    columns = base | {"Omega": rng.uniform(1, 6, 40), "c": np.round(rng.uniform(0, 1, 40), 2)}

    def march_rows(rows: np.ndarray, out: np.ndarray) -> None:
        first_rows.march_rows(ConstantRows(rows), out)

    given = ParameterSets(columns)
    found = given.table(slice(0, 40), march_rows)
    single = [Parameters(**{name: np.broadcast_to(columns[name], 40)[i] for name in base}) for i in range(40)]
    assert [given[i] for i in range(40)] == single
    assert found.tobytes() == table_of(Arithmetic(p).K for p in single).tobytes()


def test_rows_as_cpython_takes_them_are_constants() -> None:
    sets = random_sets(7, 3)
    rows = ConstantRows(table_of(Arithmetic(p).K for p in sets))
    assert [rows[i] for i in (2, 0, 1)] == [Arithmetic(sets[i]).K for i in (2, 0, 1)]
    assert len(rows) == 3
