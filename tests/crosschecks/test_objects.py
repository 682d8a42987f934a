"""Solutions as objects, as their own libraries make them."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck
from solution_files import COLUMNS, LISTS, RECORDS, ROWS, T, V, X, frame

from symosc import ParameterError, load_scene, simulate
from symosc.crosschecks.functions import solver_task
from symosc.crosschecks.objects import solutions_in
from symosc.crosschecks.samples import Samples

PROBLEM = solver_task(load_scene("fig9"))


@cache
def made() -> dict[str, Any]:
    import pyarrow
    import xarray

    states = np.array([X, V])
    return {
        "mapping": COLUMNS,
        "lists": LISTS,
        "other names": {"Time": T, "POSITION": X, "velocity": V},
        "rows": ROWS,
        "tuples": list(zip(*LISTS.values(), strict=True)),
        "array": np.column_stack([T, X, V]),
        "records": RECORDS,
        "structured": np.array(RECORDS),
        "DataFrame": frame(),
        "DataFrame by time": frame().set_index("t"),
        "DataFrame of text": frame().map(repr),
        "xarray": xarray.Dataset({"x": ("time", X), "v": ("time", V)}, {"time": T}),
        "pyarrow": pyarrow.table(COLUMNS),
        "pyarrow batch": pyarrow.record_batch(COLUMNS),
        "polars-like": SimpleFrame(),
        "OdeResult-like": SimpleNamespace(t=T, y=states),
        "states as columns": SimpleNamespace(t=T, y=states.T),
        "diffrax-like": SimpleNamespace(ts=T, ys=states.T),
        "diffrax, padded": SimpleNamespace(
            ts=np.append(T, [np.inf] * 4), ys=np.concatenate([states.T, np.full((4, 2), np.inf)])
        ),
        "diffrax, a pair": SimpleNamespace(ts=T, ys=(X, V)),
        "diffrax, named": SimpleNamespace(ts=T, ys={"x": X, "v": V}),
        "states of MATLAB": {"t": T[:, None], "y": states.T},
        "states beside a time": {"time": T, "states": states, "id": ["run"] * 60},
    }


class SimpleFrame:
    """What polars' DataFrame has."""

    columns = ["t", "x", "v"]  # noqa: RUF012

    def __getitem__(self, name: str) -> np.ndarray:
        return COLUMNS[name]


KINDS = [
    "mapping", "lists", "other names", "rows", "tuples", "array", "records", "structured", "DataFrame",
    "DataFrame by time", "DataFrame of text", "xarray", "pyarrow", "pyarrow batch", "polars-like", "OdeResult-like",
    "states as columns", "diffrax-like", "diffrax, padded", "diffrax, a pair", "diffrax, named", "states of MATLAB",
    "states beside a time",
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_a_solution(kind: str) -> None:
    assert set(KINDS) == set(made())
    (samples,) = solutions_in(made()[kind], {}, PROBLEM)
    np.testing.assert_array_equal([samples.t, samples.x, samples.v], [T, X, V])


@pytest.mark.parametrize("what", ["rows", "DataFrame", "pyarrow", "array"])
def test_positions_alone_are_a_solution_without_velocities(what: str) -> None:
    import pyarrow

    sources = {
        "rows": [{"t": row["t"], "x": row["x"]} for row in ROWS],
        "DataFrame": frame()[["t", "x"]],
        "pyarrow": pyarrow.table({"t": T, "x": X}),
        "array": np.column_stack([T, X]),
    }
    (samples,) = solutions_in(sources[what], {})
    assert samples.lacks_v
    np.testing.assert_array_equal(samples.x, X)


def names_of(found: list[Samples]) -> list[str]:
    for samples in found:
        np.testing.assert_array_equal([samples.t, samples.x, samples.v], [T, X, V])
    return [samples.name for samples in found]


def test_several_solutions_in_one_object() -> None:
    import pandas
    import xarray

    both = pandas.concat([frame().assign(run="b"), frame().assign(run="a")])
    assert names_of(solutions_in(both, {})) == ["b", "a"]
    mixed = both.sort_values("t", kind="stable")
    assert names_of(solutions_in(mixed, {})) == ["b", "a"]
    assert names_of(solutions_in(both.rename(columns={"run": "which"}), {"id": "which"})) == ["b", "a"]
    twice = {"t": T, "x": np.array([X, X]), "v": np.array([V, V])}
    assert names_of(solutions_in(twice, {})) == ["0", "1"]
    assert names_of(solutions_in({name: column.T for name, column in twice.items()}, {})) == ["0", "1"]
    data = xarray.Dataset({"x": (("motion", "t"), twice["x"]), "v": (("motion", "t"), twice["v"])}, {"t": T})
    assert names_of(solutions_in(data, {})) == ["0", "1"]
    batch = SimpleNamespace(ts=np.array([T, T]), ys=np.array([np.column_stack([X, V])] * 2))
    assert names_of(solutions_in(batch, {})) == ["0", "1"]
    assert len(solutions_in([frame(), COLUMNS, np.column_stack([T, X, V])], {})) == 3


def test_a_column_of_row_numbers_and_one_of_a_single_id_are_one_solution() -> None:
    for ids in (np.arange(60), np.zeros(60), ["run"] * 60):
        assert names_of(solutions_in({**COLUMNS, "id": ids}, {})) == [""]


def test_pieces_that_meet_are_joined() -> None:
    parts = (slice(0, 21), slice(20, 41), slice(40, 60))
    pieces = [{name: column[part] for name, column in COLUMNS.items()} for part in parts]
    (samples,) = solutions_in(pieces, {})
    assert len(samples.t) == 62
    assert samples.notes == ("joined from 3 pieces",)
    assert crosscheck("fig9", pieces).ok
    assert len(solutions_in([pieces[0], pieces[2]], {})) == 2


def test_results_of_scipy_with_their_events() -> None:
    """Times of crossings are the solver's own; a function that looks for something else is left out."""
    from scipy.integrate import solve_ivp

    p, motion = load_scene("fig9").parameters, simulate("fig9", t_end=0.9)
    force = float(p.A(1)), float(p.B0), float(p.Omega), float(p.c), float(p.k), float(p.m)

    def rhs(t: float, y: Any) -> list[float]:
        A, B, Omega, c, k, m = force
        return [y[1], (A + B * np.cos(Omega * t) - c * y[1] - k * y[0]) / m]

    t0, (x0, v0) = 0.2, motion(0.2)
    assert motion.mode(0.2) == "Omega1"
    events = [lambda t, y: y[1] - float(p.v1), lambda t, y: y[0] - 4.5]
    events[0].terminal = True  # type: ignore[attr-defined]
    result = solve_ivp(rhs, (t0, 3), (x0, v0), rtol=1e-11, atol=1e-12, events=events)
    assert len(result.t_events[0]) == 1
    check = crosscheck(load_scene("fig9"), result)
    assert check.ok, check.summary()
    assert any("left out" in note for note in check.notes) == bool(len(result.t_events[1]))
    dense = solve_ivp(rhs, (t0, 0.9), (x0, v0), rtol=1e-11, atol=1e-12, dense_output=True)
    assert crosscheck(p, dense.sol, tolerance=1e-6).ok
    for sol, low, high in ((dense.sol, 0, 1e-6), (lambda t: np.array([t, t]), 1, np.inf)):
        dense.sol = sol
        notes = crosscheck("fig9", dense).notes
        note = next(note for note in notes if note.startswith("the dense output is off by up to "))
        assert low < float(note.split()[8]) < high


@pytest.mark.parametrize(
    "source",
    [
        None, 5, b"x", [], [None], [1, 2], ["no file"], {}, {"t": T}, np.zeros((3, 4)), np.zeros(5), np.zeros((2,) * 3),
        object(), [[1, 2, 3], [1, 2]], [COLUMNS, 5], SimpleNamespace(t=T, y=None), SimpleNamespace(ts=T, ys=X),
        {"t": T, "x": X, "v": np.zeros((2, 7))}, {"t": T, "x": np.zeros((2, 7)), "v": V},
        {"t": T, "x": np.zeros((2, 7)), "v": np.zeros((2, 7))}, {"t": T, "x": X, "v": V, "id": ["a"] * 5},
        {"t": T, "x": X, "v": V, "id": ["a"] * 59 + ["b"]},
    ],
)  # fmt: skip
def test_what_is_no_solution_is_one_line(source: Any) -> None:
    with pytest.raises(ParameterError) as caught:
        crosscheck("fig9", source)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("nothing", [[], ()])
def test_an_empty_list_is_called_empty(nothing: Any) -> None:
    with pytest.raises(ParameterError, match="is empty"):
        solutions_in(nothing, {}, None)


def test_rows_of_several_ids_are_sorted_out() -> None:
    """Of any number of ids and rows, however mixed; in the order in which they begin."""
    rng = np.random.default_rng(3)
    for count in (2, 3, 5):
        lengths = rng.integers(2, 9, count)
        ids = rng.permutation(np.repeat(np.arange(count), lengths))
        t = np.empty(len(ids))
        for i in range(count):
            t[ids == i] = np.sort(rng.uniform(0, 9, lengths[i]))
        columns = {"t": t, "x": rng.uniform(-1, 1, len(t)), "v": rng.uniform(-1, 1, len(t))}
        found = solutions_in({**columns, "id": [f"run {i}" for i in ids]}, {})
        order = list(dict.fromkeys(ids.tolist()))
        assert [samples.name for samples in found] == [f"run {i}" for i in order]
        for samples, i in zip(found, order, strict=True):
            for name, column in columns.items():
                assert getattr(samples, name).tolist() == column[ids == i].tolist()
