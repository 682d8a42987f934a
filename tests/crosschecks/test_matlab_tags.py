"""Files of MATLAB at which scipy would end the program are refused before it sees them."""

from __future__ import annotations

import struct
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.io import savemat
from solution_files import COLUMNS

from symosc import ParameterError
from symosc.crosschecks.files import has_wrong_tags, read_samples


def written(variables: dict[str, Any], packed: bool = False) -> bytes:
    file = BytesIO()
    savemat(file, variables, do_compression=packed)
    return file.getvalue()


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize(
    "variables",
    [
        COLUMNS,
        {"sol": COLUMNS},
        {"z": np.array([1j, 2]), "empty": np.array([]), "flag": True, "text": "abc", "short": np.arange(5, dtype="u1")},
        {"s": sparse.csc_matrix(np.eye(3)), "c": np.array([1, "a"], dtype=object), "deep": {"a": {"b": [1.5]}}},
    ],
)
def test_what_scipy_writes_is_sound(variables: dict[str, Any], packed: bool) -> None:
    assert not has_wrong_tags(written(variables, packed))


@pytest.mark.parametrize(("at", "value"), [(176, 0xFF), (176, 0), (145, 0x08), (133, 0xFF), (180, 0xFF), (128, 99)])
def test_a_damaged_one_is_refused(at: int, value: int, tmp_path: Path) -> None:
    """The kind of the numbers, a second (imaginary) part that is not there, sizes beyond the end."""
    data = bytearray(written(COLUMNS))
    assert struct.unpack_from("<I", data, 176) == (9,)  # numbers in double precision
    data[at] = value
    assert has_wrong_tags(bytes(data))
    (tmp_path / "run.mat").write_bytes(data)
    with pytest.raises(ParameterError, match="is not a MATLAB file, or it is damaged"):
        read_samples(tmp_path / "run.mat")
