"""A small set of reference cases, written once."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_set import small_set

from symosc.reference.folder import write_cases


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the small set."""
    return write_cases(tmp_path_factory.mktemp("set") / "cases", small_set())
