"""How much work something takes, counted and not timed: the same on a machine of any speed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

#: Seconds after which a test no longer waits for what should come; it hangs then, on the slowest
#: machine too.
PATIENCE = 600.0


class Effort:
    """How many functions a block has called, those in C too."""

    calls = 0


@contextmanager
def at_most(calls: int) -> Iterator[Effort]:
    """Fail as soon as a block has called more functions than this."""
    effort = Effort()

    def count(frame: Any, event: str, argument: Any) -> None:
        effort.calls += event in ("call", "c_call")
        if effort.calls > calls:
            raise AssertionError(f"it takes more than {calls} calls of functions")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        yield effort
    finally:
        sys.setprofile(before)
