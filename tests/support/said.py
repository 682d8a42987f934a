"""What an error says, for stored outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from symosc import SymoscError


def error_of(call: Callable[[], object]) -> str:
    """Return the kind of the error that a call raises, and what it says."""
    try:
        call()
    except (SymoscError, TypeError, AttributeError) as error:
        return f"{type(error).__name__}: {error}"
    return "no error"


def errors_of(calls: Iterable[Callable[[], object]]) -> str:
    """Return what the errors of some calls say, line by line."""
    return "\n".join(map(error_of, calls))
