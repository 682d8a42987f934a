"""Optional packages that tables need."""

from __future__ import annotations

from typing import Any

from symosc.base.errors import optional


def imported(name: str) -> Any:
    """Import and return pandas or xarray; raise MissingExtraError if it is not installed."""
    return optional(name, f"a table of {name}", "sweep")
