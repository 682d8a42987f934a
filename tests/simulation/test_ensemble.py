"""Many trajectories at once: compiled and interpreted alike, against single simulations; bad input."""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from symosc import MissingExtraError, OutputError, ParameterError, load_scene, scene_names, simulate, simulate_many
from symosc.simulation.ensemble import EventTable

TWO_ULP = 2 * 2.0**-52


def one(name: str, use_numba: bool | None) -> EventTable:
    scene = load_scene(name)
    start = [scene.t0, scene.x0, scene.v0]
    return simulate_many(scene.parameters, start, scene.t_end, start_error=scene.start_error, use_numba=use_numba)


@pytest.mark.slow
@pytest.mark.compiled("doubles")
@pytest.mark.full(4)
@pytest.mark.parametrize("name", scene_names())
def test_compiled_and_interpreted_agree_to_two_ulp(name: str) -> None:
    pytest.importorskip("numba", reason="numba is the extra `fast`; without it there is nothing to compare")
    compiled, interpreted = one(name, True), one(name, False)
    assert compiled.status == interpreted.status
    assert compiled.kind.tolist() == interpreted.kind.tolist()
    for column in ("t", "x", "v", "theta"):
        a, b = getattr(compiled, column), getattr(interpreted, column)
        np.testing.assert_allclose(a, b, rtol=TWO_ULP, atol=0)


@pytest.mark.parametrize("name", scene_names())
def test_each_row_is_the_event_of_a_simulation(name: str) -> None:
    table, trajectory = one(name, None), simulate(load_scene(name))
    assert table.status == [trajectory.status]
    assert len(table) == len(trajectory.events)
    for row, event in enumerate(trajectory.events):
        assert (table.kind[row], table.boundary[row]) == (event.kind, event.boundary)
        assert (table.source[row], table.target[row]) == (event.source, event.target)
        assert table.t[row] == pytest.approx(event.t, rel=1e-13, abs=1e-13)
        assert table.x[row] == pytest.approx(event.x, rel=1e-13, abs=1e-13)


def test_starts_and_parameters_are_paired() -> None:
    scene = load_scene("fig5")
    p, q = scene.parameters, scene.parameters.replace(c="0.7")
    starts = np.array([[0, 0, 0], [0.25, -3.5, 2], [1e8, 1, 1]], dtype=object)
    ends = [30, 31, 100000020]
    table = simulate_many([p, q, p], starts, ends)
    assert sorted(set(table.trajectory.tolist())) == [0, 1, 2]
    assert np.all(np.diff(table.trajectory) >= 0)
    for i, parameters in enumerate((p, q, p)):
        t0, x0, v0 = starts[i]
        alone = simulate(parameters, t0=t0, x0=x0, v0=v0, t_end=ends[i])
        rows = table.trajectory == i
        assert table.kind[rows].tolist() == [event.kind for event in alone.events]
        np.testing.assert_allclose(table.x[rows], [event.x for event in alone.events], rtol=1e-12, atol=1e-12)
        assert np.all(np.diff(table.t[rows]) > 0)


def test_one_start_serves_for_all_parameters() -> None:
    p = load_scene("fig9").parameters
    table = simulate_many([p, p.replace(B0=8)], (0, 1, 0), 5)
    assert len(table.status) == 2
    assert len(set(table.trajectory.tolist())) == 2


@pytest.mark.slow
def test_a_doubtful_contact_is_looked_at_with_more_digits() -> None:
    """From fig7-exact's start a double cannot tell a graze from a crossing; fig8's sticks shrink until it cannot."""
    assert one("fig7-exact", None).kind.tolist() == ["graze"]
    scene = load_scene("fig8")
    long = simulate_many(scene.parameters, [scene.t0, scene.x0, scene.v0], 160)
    alone = simulate(scene, t_end=160)
    assert long.status == [alone.status] == ["undecidable"]
    assert len(long) == len(alone.events)


def test_accuracy_asks_for_a_closer_look_or_none() -> None:
    """In fig8 errors grow: a double knows its 20th event to some 1e-12, and says so."""
    scene = load_scene("fig8")
    start = [scene.t0, scene.x0, scene.v0]
    exact = simulate(scene, digits=25).events
    looked, plain = simulate(scene), simulate(scene, accuracy=math.inf)
    rough = simulate_many(scene.parameters, start, scene.t_end, accuracy=1e-9)
    assert max(event.x_error for event in looked.events) < 1e-13 < max(event.x_error for event in plain.events)
    assert rough.x_error.tolist() == pytest.approx([event.x_error for event in plain.events], rel=1e-6)
    assert len(rough) == len(plain.events) == len(exact)
    for event, error, x in zip(exact, rough.x_error, rough.x, strict=True):
        assert abs(float(event.x - x)) < 8 * error + 1e-15
    again = simulate_many(scene.parameters, start, scene.t_end)
    assert again.x.tolist() == [event.x for event in looked.events]
    in_t, in_x = ((error / np.maximum(1, np.abs(value))).max() for error, value in
                  ((rough.t_error, rough.t), (rough.x_error, rough.x)))  # fmt: skip
    assert in_t < in_x  # the position alone is reason enough
    by_x = simulate_many(scene.parameters, start, scene.t_end, accuracy=math.sqrt(in_t * in_x))
    assert by_x.x.tolist() == again.x.tolist()


@pytest.mark.parametrize("accuracy", [0, -1e-13, float("nan"), "much"])
def test_accuracy_is_a_positive_number(accuracy: Any) -> None:
    scene = load_scene("fig5")
    with pytest.raises(ParameterError, match=r"accuracy.*> 0"):
        simulate(scene, accuracy=accuracy)
    with pytest.raises(ParameterError, match=r"accuracy.*> 0"):
        simulate_many(scene.parameters, [0, 0, 0], 1, accuracy=accuracy)
    with pytest.raises(ParameterError, match=r"accuracy.*digits = 30"):
        simulate(scene, accuracy=1e-9, digits=30)


def test_max_events_and_no_events() -> None:
    p = load_scene("fig5").parameters
    table = simulate_many(p, [[0, 0, 0], [0, 1, 2]], 1000, max_events=5)
    assert table.status == ["max_events"] * 2
    assert len(table) == 10
    still = p.replace(A0=0, B0=0, v1=-1, mu1=0, mu2=0)
    assert len(simulate_many(still, [0, 0, 0], 10)) == 0


def test_csv_round_trip(tmp_path: Path) -> None:
    table = one("fig10", None)
    table.to_csv(tmp_path / "events.csv")
    rows = list(csv.DictReader((tmp_path / "events.csv").read_text().splitlines()))
    assert [float(row["t"]) for row in rows] == table.t.tolist()
    assert [row["kind"] for row in rows] == table.kind.tolist()
    with pytest.raises(OutputError):
        table.to_csv(tmp_path / "missing" / "events.csv")


@pytest.mark.parametrize(
    ("starts", "t_end", "message"),
    [
        ([[0, 0]], 1, "starts"),
        ([[0, 0, 0]] * 2, [1, 2, 3], "starts"),
        ([0, float("nan"), 0], 1, "x0"),
        ([2, 0, 0], 1, "t_end"),
        ([0, "x", 0], 1, "x0"),
    ],
)
def test_bad_input_is_named(starts: object, t_end: object, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        simulate_many(load_scene("fig5").parameters, starts, t_end)


def test_parameters_must_be_parameters() -> None:
    with pytest.raises(ParameterError, match="parameters"):
        simulate_many(["fig5"], [0, 0, 0], 1)  # type: ignore[list-item]


def test_a_table_has_its_trajectories_by_number() -> None:
    p = load_scene("fig9").parameters
    table = simulate_many(p, [(0, 0, 0), (0, 1, 2), (0, 2, 0)], 5, use_numba=False)
    for number in (0, 2, -1):
        alone = table[number]
        rows = table.trajectory == number % 3
        assert alone.t.tolist() == table.t[rows].tolist()
        assert (set(alone.trajectory.tolist()), alone.status) == ({0}, ["t_end"])
    with pytest.raises(IndexError):
        table[3]
    assert repr(table) == f"<EventTable of {len(table)} events of 3 motions (3 t_end)>"


def test_tables_of_other_packages() -> None:
    table = one("fig9", False)
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    frame, dataset = table.to_pandas(), table.to_xarray()
    assert isinstance(frame, pandas.DataFrame)
    assert isinstance(dataset, xarray.Dataset)
    assert frame["kind"].tolist() == dataset["kind"].values.tolist() == table.kind.tolist()
    assert dataset["status"].values.tolist() == table.status


def test_a_package_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(MissingExtraError, match=r"a table of pandas.*symosc\[sweep\]"):
        one("fig9", False).to_pandas()


def test_columns_are_rows_of_parameters() -> None:
    p = load_scene("fig9").parameters
    Omega = np.linspace(3, 5, 6)
    columns = {name: getattr(p, name) for name in p.as_dict()} | {"Omega": Omega}
    table = simulate_many(columns, (0, 0, 0), 5, use_numba=False)
    assert table == simulate_many([p.replace(Omega=float(each)) for each in Omega], (0, 0, 0), 5, use_numba=False)
