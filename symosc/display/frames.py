"""Optional packages that tables need."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from symosc.errors import MissingExtraError


def imported(name: str) -> Any:
    """Import and return pandas or xarray; raise MissingExtraError if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(f"a table of {name}", "sweep") from None
