"""Tables of pandas and xarray, which not everybody has."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from symosc.errors import MissingExtraError


def imported(name: str) -> Any:
    """Return a package that not everybody has.

    Raises
    ------
    MissingExtraError
        If it is not installed.
    """
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(f"a table of {name}", "sweep") from None
