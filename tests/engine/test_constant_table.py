"""Constants of many parameter sets.

Each row of the table is what the set alone gets from fractions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from regimes import random_sets

from symosc import Parameters, load_scene, scene_names
from symosc.engine import flow
from symosc.engine.arithmetic import Arithmetic, compiled_program
from symosc.engine.flow import ConstantRows, TableLoops, constant_table
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


def kinds_of_sets(count: int) -> dict[str, dict[str, np.ndarray]]:
    """Return columns of random parameters, and such with a property that formulas ask for."""
    rng = np.random.default_rng(8)
    ranges = {"m": (0.1, 5), "c": (0, 5), "k": (0, 5), "A0": (-10, 10), "B0": (-10, 10)}
    ranges |= {"Omega": (0.1, 5), "v1": (-5, 0), "v2": (0.1, 5), "mu1": (0, 1), "mu2": (0, 1)}
    ranges |= {"FN": (0, 10)}
    usual = {name: rng.uniform(*ends, count) for name, ends in ranges.items()}
    kinds = {name: usual | {name: np.zeros(count)} for name in ("c", "k", "B0", "FN", "mu1")}
    kinds["nothing holds"] = kinds["c"] | {"k": np.zeros(count)}
    halves = np.round(rng.uniform(0.5, 2, count), 2)
    kinds["critical"] = usual | {"m": np.ones(count), "c": 2 * halves, "k": halves * halves}
    kinds["resonant"] = kinds["c"] | {"m": np.ones(count), "k": halves**2, "Omega": halves}
    kinds["static"] = usual | {"mu_s1": usual["mu1"] + 0.5, "mu_s2": usual["mu2"]}
    kinds["one belt"] = {name: usual[name] for name in ranges if name not in ("v2", "mu2")}
    kinds["one static belt"] = kinds["one belt"] | {"mu_s1": 2 * usual["mu1"]}
    sizes = 10.0 ** rng.uniform(-22, 22, count)
    kinds["any size"] = usual | {"k": sizes, "B0": sizes[::-1].copy()}
    return {"usual": usual} | kinds


KINDS = kinds_of_sets(150)


@pytest.mark.parametrize("kind", KINDS)
def test_the_program_gives_the_bits_of_columns(kind: str) -> None:
    """And asks for more digits in the same rows."""
    pytest.importorskip("numba")
    table = ParameterSets(KINDS[kind])
    columns = {name: table.column(name).pairs() for name in table.names}
    asked: dict[str, list[int]] = {"columns": [], "program": []}

    def no_march(table: np.ndarray, out: np.ndarray) -> None:
        """Steps of a fixed length follow from the other constants."""

    def rows(which: str, run: Any) -> bytes:
        def alone(i: int) -> Any:
            asked[which].append(i)
            return np.zeros(1, flow.ROW)[0].item()

        loops = TableLoops(no_march, run)
        return constant_table(columns, len(table), alone, loops).tobytes()

    in_columns = rows("columns", None)
    by_program = rows("program", compiled_program())
    assert by_program == in_columns
    assert asked["program"] == asked["columns"]
    if kind == "any size":
        assert 0 < len(asked["columns"]) < len(table)


def test_the_program_computes_every_field() -> None:
    """Whatever `Constants` and the tuples in it get, and for any names of parameters."""

    def numbers_in(kind: np.dtype[Any]) -> int:
        return sum(numbers_in(kind[name]) for name in kind.names) if kind.names else 1

    for names in KINDS.values():
        program = flow._constants_program(tuple(names))
        assert len(program.results) == numbers_in(flow.ROW)
