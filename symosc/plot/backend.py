"""What is wrong with the backend of matplotlib, in words."""

from __future__ import annotations

import os

from symosc.base.errors import ParameterError


def backend_error(error: ValueError) -> ParameterError | None:
    """Return what is wrong with MPLBACKEND, if matplotlib cannot be loaded for it; else None."""
    if not str(error).startswith("Key backend:"):
        return None
    backend = os.environ.get("MPLBACKEND")
    return ParameterError("MPLBACKEND", backend, "must be a backend of matplotlib, such as agg")
