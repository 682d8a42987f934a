"""Arrays and tables that users give.

Nothing behind a mask is read, and columns are known by their names.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import symosc
from symosc import (
    ParameterError,
    crosscheck,
    find_orbit,
    load_scene,
    simulate,
    simulate_many,
    sweep,
)

SCENE = load_scene("fig9")
P = SCENE.parameters
PARAMETERS = {name: getattr(P, name) for name in P.as_dict()}
#: Three rows of t0, x0, v0.
ROWS = np.array([[0.0, 0.1, 1.0], [0.0, 0.2, 2.0], [0.0, 0.3, 3.0]])
Function = Callable[[Any], object]

#: What each function does with a row of three numbers.
TAKE_ROWS: dict[str, Function] = {
    "parameters": lambda row: simulate_many(PARAMETERS | {"FN": row}, ROWS, 5),
    "starts": lambda row: simulate_many(P, {"t0": 0, "x0": row, "v0": 1}, 5),
    "t_end": lambda row: simulate_many(P, ROWS, row),
    "skip": lambda row: simulate_many(P, ROWS, 5, record="summary", skip=row),
    "start_error": lambda row: simulate(P, t0=0, x0=0, v0=1, t_end=1, start_error=row),
    "times": lambda row: simulate(SCENE)(row),
    "modes": lambda row: simulate(SCENE).mode(row),
    "forces": lambda row: simulate(SCENE).force(1, row),
    "times of an orbit": lambda row: find_orbit(P, "P32")(row),
    "guess": lambda row: find_orbit(P, "P32", guess=np.ma.array([row, row])),
    "guess in pairs": lambda row: find_orbit(P, "P32", guess=[(0.5, row[1]), (1.5, 1.0)]),
    "index": lambda row: simulate_many(P, ROWS, 5, record="summary")[row.astype(int)],
    "axis": lambda row: sweep(SCENE, {"FN": row}, t_end=1),
    "starts of a sweep": lambda row: sweep(
        SCENE, {"FN": [5, 6]}, starts={"t0": 0, "x0": row, "v0": 0}, t_end=1
    ),
    "range": lambda row: symosc.continue_orbit(P, "P32", "FN", row[:2]),
    "t": lambda row: crosscheck(SCENE, row, [1, 2, 3], [1, 2, 3]),
    "x": lambda row: crosscheck(SCENE, [1, 2, 3], row, [1, 2, 3]),
    "v": lambda row: crosscheck(SCENE, {"t": [1, 2, 3], "x": [1, 2, 3], "v": row}),
    "function": lambda row: crosscheck(SCENE, lambda t: (row[1], 0.0)),
    "events": lambda row: crosscheck(
        SCENE, [1, 2, 3], [1, 2, 3], [1, 2, 3], events=[(row[1], "cross")]
    ),
    "residual": lambda row: symosc.residual(P, "P2", (row, 0.5), (1.0, 4.0)),
    "jacobian": lambda row: symosc.jacobian(P, "P2", (4.5, 0.5), (1.0, row)),
    "parameter_jacobian": lambda row: symosc.parameter_jacobian(P, "P2", (4.5, row), (1.0, 9.0)),
    "solve_map": lambda row: symosc.solve_map(P, "P2", row[1], 0.5),
    "windows": lambda row: symosc.grazing_windows(P, "P2", Omega=row),
}


@pytest.mark.parametrize("name", TAKE_ROWS)
def test_what_is_behind_a_mask_is_not_read(name: str) -> None:
    if name in ("axis", "starts of a sweep"):
        pytest.importorskip("xarray")
    row = np.ma.array([2.0, 2.5, 3.0], mask=[False, True, False])
    with pytest.raises(ParameterError, match=r"masked|must be 2 pairs"):
        TAKE_ROWS[name](row)


def tables() -> dict[str, Any]:
    """Return the rows with names, not in order."""
    pandas = pytest.importorskip("pandas")
    xarray = pytest.importorskip("xarray")
    t0, x0, v0 = ROWS.T
    frame = pandas.DataFrame({"v0": v0, "x0": x0, "t0": t0})
    return {
        "frame": frame,
        "records": frame.to_records(index=False),
        "dataset": xarray.Dataset({name: ("i", frame[name].values) for name in frame}),
        "mapping": {"v0": v0, "x0": x0, "t0": 0},
        "positions": pandas.DataFrame(ROWS),
    }


@pytest.mark.parametrize("kind", ["frame", "records", "dataset", "mapping", "positions"])
def test_starts_are_known_by_their_names(kind: str) -> None:
    table = tables()[kind]
    assert simulate_many(P, table, 5) == simulate_many(P, ROWS, 5)
    assert (
        sweep(SCENE, {"FN": [5, 6]}, starts=table, t_end=2).v0.values.tolist()
        == ROWS[:, 2].tolist()
    )


def test_a_row_of_a_table_is_one_start() -> None:
    row = tables()["frame"].iloc[1]
    assert simulate_many(P, row, 5) == simulate_many(P, ROWS[1], 5)
    assert sweep(SCENE, {"FN": [5, 6]}, starts=row, t_end=2).sizes == {"FN": 2}


@pytest.mark.parametrize("change", [{"v0": "v"}, {"t0": "time", "x0": "t0"}, {"x0": 0}])
def test_columns_of_other_names_are_refused(change: dict[str, Any]) -> None:
    table = tables()["frame"].rename(columns=change)
    for call in (
        lambda: simulate_many(P, table, 5),
        lambda: sweep(SCENE, {"FN": [5, 6]}, starts=table, t_end=2),
    ):
        with pytest.raises(ParameterError, match="must have the names t0, x0 and v0"):
            call()
    with pytest.raises(ParameterError, match="must have the names"):
        simulate_many(P, tables()["frame"].assign(weight=1), 5)


def test_a_guess_is_known_by_its_names() -> None:
    pandas = pytest.importorskip("pandas")
    orbit = find_orbit(P, "P32")
    t, x = np.array([(float(t), float(x)) for t, x in orbit.points]).T
    again = find_orbit(P, "P32", guess=pandas.DataFrame({"x": x, "t": t}))
    assert np.array(again.points) == pytest.approx(np.array(orbit.points), rel=1e-14)
    with pytest.raises(ParameterError, match="must have the names t and x"):
        find_orbit(P, "P32", guess=pandas.DataFrame({"x": x, "theta": t}))
