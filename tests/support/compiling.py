"""The event loops are compiled once: by a process beside the tests that do not need them, for those that do.

Compiling takes twenty seconds for doubles and a minute for double-double numbers. Without this each worker would do
it for itself. Nobody holds a lock: whoever needs a loop looks whether it is on disk, and after a while makes it alone.
"""

from __future__ import annotations

import subprocess
import sys
import time
from functools import cache
from importlib.util import find_spec

#: Seconds after which nobody waits for the other process any longer.
LONGEST_WAIT = 240
_wanted_until: list[float] = []


def is_there() -> bool:
    """Return whether both loops are on disk, or nothing can be compiled."""
    if find_spec("numba") is None:
        return True
    from symosc.engine import arithmetic, binding, pairs

    return binding.is_compiled(arithmetic.compiled()["follow_all"]) and pairs.is_compiled()


@cache
def begin() -> subprocess.Popen[bytes] | None:
    """Compile what is not on disk, in a process of its own."""
    if is_there():
        return None
    code = "from symosc.simulation.warm import warm; warm()"
    return subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def wait() -> None:
    """Wait until the loops are there, all tests of this process together not longer than LONGEST_WAIT."""
    _wanted_until[:] = _wanted_until or [time.monotonic() + LONGEST_WAIT]
    while time.monotonic() < _wanted_until[0] and not is_there():
        time.sleep(0.2)
