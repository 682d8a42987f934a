"""Constants of many parameter sets: each row of the table has the bits that the set alone gets from fractions."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from symosc import Parameters, load_scene, scene_names
from symosc.engine import constant_table, first_rows
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.constant_table import ConstantRows, table_of
from symosc.model import PARAMETER_NAMES
from symosc.simulation.problems import ParameterSets


def random_sets(seed: int, count: int) -> list[Parameters]:
    """Return sets of all regimes; one in three is at critical damping, at resonance, or without spring or drive."""
    dice = random.Random(seed)

    def number(low: float, high: float) -> Fraction:
        digits = 10 ** dice.choice((1, 2, 16))
        return Fraction(dice.randint(int(low * digits), int(high * digits)), digits)

    def one() -> Parameters:
        m, k, c, Om, low = number(0.1, 3), number(0.1, 9), number(0, 5), number(0.1, 6), number(-5, 5)
        kind = dice.randrange(12)
        if kind == 0:
            k, c = m * Om * Om / 4, m * Om  # critical damping
        if kind == 1:
            k, c = m * Om * Om, Fraction(0)  # resonance
        k, c, B0 = (Fraction(0) if kind == n else value for n, value in ((2, k), (3, c), (4, number(-9, 9))))
        if kind == 5:
            B0 = -k * low / Om  # on belt 1 the slope touches 0 and keeps its sign
        others = {name: number(0, 2) for name in ("mu1", "mu2", "FN")}
        return Parameters(
            m=m, c=c, k=k, A0=number(-9, 9), B0=B0, Omega=Om, v1=low, v2=low + number(0.1, 3) + 1, **others
        )

    return [one() for _ in range(count)]


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
