"""Errors go from one process to another as they are."""

from __future__ import annotations

import pickle

import pytest

from symosc.errors import ParameterError, SceneError, SymoscError


@pytest.mark.parametrize("error", [ParameterError("m", 0, "must be > 0"), SceneError("fig11", "unknown")])
def test_errors_survive_pickling(error: SymoscError) -> None:
    copy = pickle.loads(pickle.dumps(error))
    assert (type(copy), str(copy), vars(copy)) == (type(error), str(error), vars(error))
