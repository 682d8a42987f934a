"""What follows motions in one kind of numbers: the two functions that take a state further, and its numbers' border."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Paths:
    """`advance`, `advance_near` and `handed_out` of the engine for one kind of numbers.

    Parameters
    ----------
    functions : dict
        The fast paths bound to such numbers.

    Attributes
    ----------
    advance, advance_near, handed_out : callable
        See `symosc.engine.next_event`, `near_event` (None for doubles) and `compiled_loop`. They, and all arithmetic on
        their numbers, belong between `enter` and `leave`.
    """

    def __init__(self, functions: dict[str, Any]) -> None:
        self.advance: Callable[..., Any] = functions["advance"]
        self.advance_near: Any = functions.get("advance_near")
        self.handed_out: Callable[..., Any] = functions["handed_out"]
        self.event_numbers: Callable[..., Any] = functions["event_numbers"]

    def enter(self) -> Any:
        """Begin to compute; return what `leave` asks for."""

    def leave(self, before: Any) -> None:
        """Let the precision be what it was before."""

    def inward(self, value: Any) -> Any:
        """Return a number, or a tuple with some, as what these functions take."""
        return value

    def constants(self, K: Any) -> Any:
        """Return the constants as what these functions take."""
        return K

    def outward(self, value: Any) -> Any:
        """Return what `inward` took."""
        return value


def converted(value: Any, number: Callable[[Any], Any]) -> Any:
    """Return a value with `number` applied to it, or to the entries of a tuple in any depth."""
    if not isinstance(value, tuple):
        return number(value)
    entries = [converted(entry, number) for entry in value]
    return type(value)(*entries) if hasattr(value, "_fields") else tuple(entries)
