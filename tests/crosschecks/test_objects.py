"""Solutions as objects, functions and results of solvers; wrong input is one line."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import cos, sin
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck
from solution_files import COLUMNS, LISTS, RECORDS, ROWS, T, V, X, frame

from symosc import ParameterError, load_scene, simulate
from symosc.crosschecks.reading.functions import MOST_TIMES
from symosc.crosschecks.reading.names import find_columns, read_column_names
from symosc.crosschecks.reading.solutions import solutions_in
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.solver_runs import run_solver

# -- objects ---------------------------------------------------------------------------------------


PROBLEM = load_scene("fig9")


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
        "record array with a y": np.rec.fromarrays([T, X, V, -X], names="t,x,v,y"),
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


@pytest.mark.parametrize("kind", made())
def test_what_is_a_solution(kind: str) -> None:
    (samples,) = solutions_in(made()[kind], {}, PROBLEM)
    np.testing.assert_array_equal([samples.t, samples.x, samples.v], [T, X, V])


def test_positions_alone_are_a_solution_without_velocities() -> None:
    import pyarrow

    rows = [{"t": row["t"], "x": row["x"]} for row in ROWS]
    for source in (
        rows,
        frame()[["t", "x"]],
        pyarrow.table({"t": T, "x": X}),
        np.column_stack([T, X]),
    ):
        (samples,) = solutions_in(source, {})
        assert samples.lacks_v
        np.testing.assert_array_equal(samples.x, X)


def names_of(solutions: list[Samples]) -> list[str]:
    for samples in solutions:
        np.testing.assert_array_equal([samples.t, samples.x, samples.v], [T, X, V])
    return [samples.name for samples in solutions]


def test_several_solutions_in_one_object() -> None:
    import pandas
    import xarray

    both = pandas.concat([frame().assign(run="b"), frame().assign(run="a")])
    assert names_of(solutions_in(both, {})) == ["b", "a"]
    mixed = both.sort_values("t", kind="stable")
    assert names_of(solutions_in(mixed, {})) == ["b", "a"]
    assert names_of(solutions_in(both.rename(columns={"run": "which"}), {"id": "which"})) == [
        "b",
        "a",
    ]
    twice = {"t": T, "x": np.array([X, X]), "v": np.array([V, V])}
    assert names_of(solutions_in(twice, {})) == ["0", "1"]
    assert names_of(solutions_in({name: column.T for name, column in twice.items()}, {})) == [
        "0",
        "1",
    ]
    data = xarray.Dataset(
        {"x": (("motion", "t"), twice["x"]), "v": (("motion", "t"), twice["v"])}, {"t": T}
    )
    assert names_of(solutions_in(data, {})) == ["0", "1"]
    batch = SimpleNamespace(ts=np.array([T, T]), ys=np.array([np.column_stack([X, V])] * 2))
    assert names_of(solutions_in(batch, {})) == ["0", "1"]
    assert len(solutions_in([frame(), COLUMNS, np.column_stack([T, X, V])], {})) == 3


def test_rows_may_have_numbers_for_names() -> None:
    """Names that are no text stopped the reader with a TypeError."""
    (samples,) = solutions_in([{1: 0.0, 2: 1.0}, {1: 1.0, 2: 2.0}], {})
    assert samples.x.tolist() == [1.0, 2.0]
    with pytest.raises(ParameterError, match="its columns are 1, 2, 3, 4;"):
        solutions_in([dict.fromkeys((1, 2, 3, 4), 0.0)] * 2, {})


def test_results_of_scipy_with_their_events() -> None:
    """Times of crossings are the solver's own.

    A function that looks for something else is left out.
    """
    from scipy.integrate import solve_ivp

    p = load_scene("fig9").parameters
    motion = simulate("fig9", t_end=0.9)
    force = float(p.A(1)), float(p.B0), float(p.Omega), float(p.c), float(p.k), float(p.m)

    def rhs(t: float, y: Any) -> list[float]:
        A, B, Omega, c, k, m = force
        return [y[1], (A + B * np.cos(Omega * t) - c * y[1] - k * y[0]) / m]

    t0 = 0.2
    (x0, v0) = motion(0.2)
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
        {"t": T, "x": X, "v": V, "id": ["a"] * 59 + ["b"]}, [ROWS[0], 5],
    ],
)  # fmt: skip
def test_what_is_no_solution_is_one_line(source: Any) -> None:
    with pytest.raises(ParameterError) as caught:
        crosscheck("fig9", source)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


# -- functions -------------------------------------------------------------------------------------


FIG9 = load_scene("fig9")


def test_functions_of_one_time_and_of_many() -> None:
    problem = FIG9
    for function in (
        lambda t: (sin(t), cos(t)),
        lambda t: np.array([np.sin(t), np.cos(t)]),
        lambda t: np.column_stack([np.sin(t), np.cos(t)]) if np.ndim(t) else [sin(t), cos(t)],
    ):
        (samples,) = solutions_in(function, {}, problem)
        np.testing.assert_allclose(samples.x, np.sin(samples.t), rtol=0, atol=1e-15)
        np.testing.assert_allclose(samples.v, np.cos(samples.t), rtol=0, atol=1e-15)
        assert (samples.t[0], samples.t[-1]) == (float(FIG9.t0), float(FIG9.t_end))
    far = replace(FIG9, t0=Fraction(0), t_end=Fraction(10**9))
    (long,) = solutions_in(lambda t: (t, t), {}, far)
    assert len(long.t) == MOST_TIMES + 1


def test_what_is_no_solution_of_a_function() -> None:
    with pytest.raises(
        ParameterError, match=r"needs times: give crosscheck\(parameters, t, function\)"
    ):
        crosscheck(FIG9.parameters, lambda t: (t, t))
    with pytest.raises(ParameterError, match="must return two numbers"):
        crosscheck("fig9", lambda t: t)
    for function, kind in ((lambda t: (t / 0, 1), ZeroDivisionError), (lambda: (0, 0), TypeError)):
        with pytest.raises(
            ParameterError, match=rf"fails at t = 0.1324: {kind.__name__}: "
        ) as caught:
            crosscheck("fig9", function)
        assert isinstance(
            caught.value.__cause__, kind
        )  # an error of the function itself, with its place
    with pytest.raises(ParameterError, match=r"x\[0\] = nan"):
        crosscheck("fig9", lambda t: (np.nan, 1))


# -- solver runs -----------------------------------------------------------------------------------


SOURCE = """
print("loading")
def solve(p, t0, x0, v0, t_end):
    print("solving")
    return {"t": [t0, t_end], "x": [x0, x0], "v": [v0, float(p.k)]}
class Many:
    @staticmethod
    def solve(*start):
        return start
def none(*start): pass
def broken(*start):
    return 1 / 0
def leaves(*start):
    raise SystemExit(3)
number = 5
async def later(*start):
    return start
"""


def test_a_function_gets_the_problem(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "solver_of_a_test.py").write_text(SOURCE)
    scene = load_scene("fig9")
    start = [float(getattr(scene, name)) for name in ("t0", "x0", "v0", "t_end")]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    for module in ("solver_of_a_test", str(tmp_path / "solver_of_a_test.py")):
        solution = run_solver(f"{module}:solve", scene)
        assert solution == {
            "t": [start[0], start[3]],
            "x": [start[1]] * 2,
            "v": [start[2], float(scene.parameters.k)],
        }
        assert run_solver(f"{module}:Many.solve", scene) == (scene.parameters, *start)
    printed = capsys.readouterr()
    assert "solving" in printed.err
    assert printed.out == ""
    for name, words in (
        ("solver_of_a_test:none", "returned None"),
        (
            "solver_of_a_test:broken",
            r"failed: ZeroDivisionError: division by zero \(line 12 of solver_of_a_test.py\)",
        ),
        ("solver_of_a_test:leaves", "failed: SystemExit: 3"),
        ("solver_of_a_test:number", "is no function of"),
        ("solver_of_a_test:later", "is async"),
        ("solver_of_a_test:other", "is no function of"),
        ("no_such_module:solve", "cannot be imported: ModuleNotFoundError"),
        ("no_such_file.py:solve", "cannot be imported: FileNotFoundError"),
        ("solver_of_a_test", "must be MODULE:FUNCTION"),
        (":solve", "must be MODULE:FUNCTION"),
    ):
        with pytest.raises(ParameterError, match=words) as caught:
            run_solver(name, scene)
        assert "\n" not in str(caught.value)
        assert "importlib" not in str(caught.value)  # a place is one in the solver's own files
        assert "solver_runs.py" not in str(caught.value)


# -- columns ---------------------------------------------------------------------------------------


def chosen(names: list[str], **asked: str | None) -> dict[str, str]:
    return {role: names[i] for role, i in find_columns(names, asked, "here").items()}


def test_the_exact_name_comes_first_then_usual_ones_in_any_case() -> None:
    assert chosen(["X", "x", "T", "V"]) == {"t": "T", "x": "x", "v": "V"}
    assert chosen(["Time", "Pos", "Run", "velocity"]) == {
        "t": "Time", "x": "Pos", "id": "Run", "v": "velocity",
    }  # fmt: skip
    assert chosen(["t", "x", "w"], v=None) == {"t": "t", "x": "x"}
    assert chosen(["t", "A", "w"], x="a", v="w") == {"t": "t", "x": "A", "v": "w"}


def test_columns_are_asked_for_one_by_one() -> None:
    for columns, words in (
        ({"t": "a", "x": "a"}, "three columns"),
        ({"x": "v"}, "three columns"),
        ({"y": "a"}, "must be one of t, x, v and id"),
    ):
        with pytest.raises(ParameterError, match=words):
            read_column_names(columns)
    assert read_column_names({"t": "a", "v": "None"}) == {"t": "a", "v": None}


@pytest.mark.parametrize(("off", "there"), [(5e-5, True), (5e-4, False)])
def test_events_of_a_solver_are_at_a_belt_relative_to_the_largest_velocity(
    off: float, there: bool
) -> None:
    p = load_scene("fig9").parameters.replace(v1=-100, v2=100)
    states = [np.array([[0.0, 100 + off]])]
    result = SimpleNamespace(t=T, y=np.array([X, V]), t_events=[np.array([1.0])], y_events=states)
    (samples,) = solutions_in(result, {}, p)
    assert samples.events == (((1.0, ""),) if there else None)


# -- samples ---------------------------------------------------------------------------------------


SAMPLES_T = np.linspace(0.1324, 3, 30)
SAMPLES_X, SAMPLES_V = simulate("fig9", t_end=3)(SAMPLES_T)

NO_COLUMNS: list[Any] = [
    "abc", 5.0, SAMPLES_T > 1, [True, *SAMPLES_T[1:]], SAMPLES_T + 0j, np.arange(30).astype("datetime64[s]"),
    np.ma.array(SAMPLES_T, mask=[1] + [0] * 29), np.where(SAMPLES_T > 1, np.nan, SAMPLES_T), [10**5000] * 30,
    np.where(SAMPLES_T > 1, 1e200, SAMPLES_T), [[1, 2], [3]], [[1.0]] * 30, {"a": 1}, ["1_000"] * 30, ["１"] * 30,
    [None] * 30, np.array([(1.0, 2.0)] * 30, dtype="f8,f8"), ["a" * 10000] * 30,
]  # fmt: skip
NO_EVENTS: list[Any] = [
    5, "abc", np.array(5), [None], [(1, "cross", 2)], [(np.nan, "cross")], [(True, "cross")], [(10**400, "cross")],
    [("1_0", "cross")], [(1.0, None)], [(1.0, "jump")], [[[[[1]]]]], [{"t": 1, "kind": "cross"}],
]  # fmt: skip


def one_line(call: Callable[[], Any], *words: str) -> None:
    with pytest.raises(ParameterError) as caught:
        call()
    text = str(caught.value)
    assert "\n" not in text
    assert len(text) < 300
    text.encode()  # it can be printed
    for word in words:
        assert word in text


@pytest.mark.parametrize("number", range(len(NO_COLUMNS)))
def test_what_is_no_column(number: int) -> None:
    for name in "txv":
        columns = {"t": SAMPLES_T, "x": SAMPLES_X, "v": SAMPLES_V} | {name: NO_COLUMNS[number]}
        one_line(
            lambda columns=columns: crosscheck("fig9", columns["t"], columns["x"], columns["v"]),
            name,
        )  # type: ignore[misc]
    one_line(lambda: crosscheck("fig9", SAMPLES_T, SAMPLES_X[:3], SAMPLES_V), "lengths", "'x'")


def test_what_is_a_column_all_the_same() -> None:
    for kind in (np.float32, np.longdouble, object):
        assert crosscheck("fig9", SAMPLES_T.astype(kind), SAMPLES_X, SAMPLES_V, tolerance=1e-5).ok
    assert crosscheck(
        "fig9",
        [str(value) for value in SAMPLES_T],
        [Fraction(value) for value in SAMPLES_X.tolist()],
        SAMPLES_V.tolist(),
    ).ok
    assert crosscheck("fig9", np.ma.array(SAMPLES_T, mask=False), SAMPLES_X, SAMPLES_V).ok


@pytest.mark.parametrize("events", NO_EVENTS, ids=lambda events: repr(events)[:20])
def test_what_is_no_list_of_events(events: Any) -> None:
    one_line(lambda: crosscheck("fig9", SAMPLES_T, SAMPLES_X, SAMPLES_V, events=events), "events")


GOOD = {"t": SAMPLES_T.tolist(), "x": SAMPLES_X.tolist(), "v": SAMPLES_V.tolist()}

TEXTS = {
    "text.json": ('{"t": "abc", "x": [1, 2], "v": [1, 2]}', "t[0] = 'abc'"),
    "events.json": (json.dumps(GOOD | {"events": 5}), "events = 5"),
    "deep.json": ("[" * 100000 + "]" * 100000, "nested too deeply"),
    "blank.json": (" \n", "is empty"),
    "mixed.json": ("[{}, 1]", "must hold columns"),
    "cut.json": (json.dumps(GOOD)[:-5], "cannot be read"),
    "rows.json": ('[{"t": 0, "x": 0, "v": 0}, {"t": 1, "x": 1}]', "v[1] = None"),
    "twice.json": ('{"t": [0, 1], "t": [0, 2], "x": [0, 1], "v": [0, 1]}', "has 't' twice"),
    "nan.json": ('{"t": [0, NaN], "x": [0, 1], "v": [0, 1]}', "t[1] = nan"),
    "digits.json": (
        '{"t": [0, ' + "1" * 5000 + '], "x": [0, 1], "v": [0, 1]}',
        "thousands of digits",
    ),
    "surrogate.json": ('{"\\ud800": ["0"], "x": [0], "v": [0]}', "its columns are \\ud800"),
    "header.csv": ("t,x,v\n", "at least 2"),
    "holes.csv": ("t,x,v\n0,,0\n1,1,1", "x[0] = ''"),
    "field.csv": ("t,x,v\n" + "1" * 200000 + ",0,0\n1,1,1", "at most 4000 characters"),
    "hex.csv": ("t,x,v\n0x10,0,0\n1,1,1", "'0x10'"),
    "wide.csv": (",".join(f"c{i}" for i in range(5000)), "c11, and 4988 more"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_files_of_text(name: str, tmp_path: Path) -> None:
    text, words = TEXTS[name]
    (tmp_path / name).write_text(text)
    with pytest.raises(ParameterError) as caught:
        crosscheck("fig9", tmp_path / name)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300 + len(str(tmp_path))
    str(caught.value).encode()


def test_npz_files(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    objects = np.array([None])
    for arrays, words in (
        (GOOD | {"t": np.array([0, None])}, "not of Python objects"),
        (GOOD | {"events": np.array([(0.5, "stick")], object)}, "not of Python objects"),
        (GOOD | {"events": 5}, "events"),
        (GOOD | {"t": SAMPLES_T + 0j}, "t[0]"),
        ({"t": SAMPLES_T, "pos": SAMPLES_X, "w": SAMPLES_V}, "its columns are t, pos, w"),
    ):
        np.savez(path, **arrays)
        one_line(lambda: crosscheck("fig9", path), words)
    np.savez(path, **GOOD, other=objects)  # type: ignore[arg-type]
    assert crosscheck("fig9", path).ok
    np.savez(path, **GOOD, events=np.array([["0.5", "stick"]]))  # type: ignore[arg-type]
    assert [event.t for event in crosscheck("fig9", path).invented] == [0.5]
    content = path.read_bytes()
    for damaged in (b"", b"no zip", content[: len(content) // 2], b"\x80\x04]."):
        path.write_bytes(damaged)
        one_line(lambda: crosscheck("fig9", path), "is not a readable npz file")
