"""Tables of pandas and xarray: the same numbers as the answers have.

One clear line where the package is missing.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from answers import answer

TABLES = [
    "trajectory",
    "trajectory in digits",
    "trajectory without events",
    "branch",
    "events",
    "summary",
]


@pytest.mark.parametrize("kind", TABLES[:3])
def test_events_of_a_trajectory(kind: str) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    path = answer(kind)
    frame = path.to_pandas()
    dataset = path.to_xarray()
    assert frame.to_dict("records") == path.table()
    for name in ("t", "kind", "boundary", "t_error"):
        assert dataset[name].values.tolist() == [row[name] for row in path.table()]
    assert dataset.attrs["word"].split() == path.word
    assert dataset.attrs["Omega"] == str(path.parameters.as_dict()["Omega"])
    assert dataset["t"].dtype.kind == ("f" if path.digits is None else "U")


def test_points_of_a_branch() -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    branch = answer("branch")
    frame = branch.to_pandas()
    dataset = branch.to_xarray()
    assert np.array_equal(frame["Omega"], branch.values)
    for i in (0, 1):
        assert np.array_equal(frame[f"t{i}"], branch.points[:, i, 0])
        assert np.array_equal(frame[f"x{i}"], branch.points[:, i, 1])
        assert np.array_equal(frame[f"multiplier{i}"], branch.multipliers[:, i])
    assert np.array_equal(np.stack([dataset["t"], dataset["x"]], -1), branch.points)
    assert np.array_equal(
        dataset["multiplier_re"] + 1j * dataset["multiplier_im"], branch.multipliers
    )
    assert dataset["map"].values.tolist() == list(branch.labels)


@pytest.mark.slow
@pytest.mark.parametrize("kind", TABLES[::3])
def test_tables_go_into_files(kind: str, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    dataset: Any = answer(kind).to_xarray()
    dataset.to_netcdf(tmp_path / "table.nc")
    assert xarray.load_dataset(tmp_path / "table.nc").equals(dataset)
