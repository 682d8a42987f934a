"""What takes long is made once in a test session.

One worker makes it, and the others wait and read it.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

#: The environment variable that names the folder which all workers share; the first process makes
#: it.
SHARED = "SYMOSC_TESTS_SHARED"
#: Seconds after which a process goes on alone: what it waits for was not made, or its maker hangs.
LONGEST_WAIT = 3600


@contextmanager
def alone(name: str) -> Iterator[Path]:
    """Let one process at a time into the block of this name.

    Give it the path of what they share.
    """
    import fcntl

    path = Path(os.environ[SHARED]) / name
    until = time.monotonic() + LONGEST_WAIT
    with open(f"{path}.lock", "w") as lock:
        while time.monotonic() < until:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                time.sleep(0.05)
        try:
            yield path
        finally:  # closing is not enough: a process that was forked meanwhile has the file open too
            fcntl.flock(lock, fcntl.LOCK_UN)
