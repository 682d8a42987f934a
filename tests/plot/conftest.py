"""The page of `symosc explore`, served once for all tests."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from exploring import served


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """Return the link of a page that shows Fig. 5."""
    pytest.importorskip("bokeh")
    with served("fig5") as address:
        yield address
