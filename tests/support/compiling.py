"""The event loops are compiled once: by a process beside the tests that do not need them, for those that do.

Compiling takes twenty seconds for doubles and a minute for double-double numbers. Without this each worker would do
it for itself. Nobody holds a lock: whoever needs a loop looks whether it is on disk. If the other process comes to its
end without one, or takes too long, the loop is compiled where it is needed.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

from once import SHARED

#: Seconds after which nobody waits for the other process any longer.
LONGEST_WAIT = 240
_wait_until: list[float] = []


def is_there() -> bool:
    """Return whether both loops are on disk, or nothing can be compiled."""
    if find_spec("numba") is None:
        return True
    from symosc.engine import arithmetic, binding, pairs

    return binding.is_compiled(arithmetic.compiled()["follow_all"]) and pairs.is_compiled()


def ended() -> Path:
    """Return the path of a file that is there when the other process has come to its end, whatever it was."""
    return Path(os.environ[SHARED]) / "compiling-has-ended"


def begin() -> subprocess.Popen[bytes] | None:
    """Compile what is not on disk, in a process of its own."""
    if is_there():
        return None
    code = "import sys, pathlib\nfrom symosc.simulation.warm import warm\n"
    code += "try: warm()\nfinally: pathlib.Path(sys.argv[1]).touch()"
    nowhere = subprocess.DEVNULL
    return subprocess.Popen([sys.executable, "-c", code, str(ended())], stdout=nowhere, stderr=nowhere)


def end(process: subprocess.Popen[bytes]) -> None:
    """Let the other process come to its end: another worker may still wait for what it makes."""
    try:
        process.wait(LONGEST_WAIT)
    except subprocess.TimeoutExpired:
        process.kill()


def wait() -> None:
    """Wait until the loops are there, all tests of this process together not longer than LONGEST_WAIT."""
    _wait_until[:] = _wait_until or [time.monotonic() + LONGEST_WAIT]
    while not is_there() and not ended().exists() and time.monotonic() < _wait_until[0]:
        time.sleep(0.2)
