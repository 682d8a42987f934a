"""A page that is served."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from exploring import served


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """Return the link of a page that shows Fig. 5."""
    pytest.importorskip("bokeh")
    with served("fig5") as address:
        yield address


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from browsing import chromium

    with ExitStack() as stack:
        yield stack.enter_context(chromium())
