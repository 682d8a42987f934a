"""What takes long is made once in a test session: one worker makes it, and the others wait and read it."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

#: The environment variable that names the folder which all workers share; the first process makes it.
SHARED = "SYMOSC_TESTS_SHARED"
#: Seconds after which a process goes on alone: what it waits for was not made, or its maker hangs.
LONGEST_WAIT = 240


@contextmanager
def alone(name: str) -> Iterator[Path]:
    """Let one process at a time into the block of this name; give it the path of what they share."""
    import fcntl

    path, until = Path(os.environ[SHARED]) / name, time.monotonic() + LONGEST_WAIT
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


def compile_once() -> None:
    """Let one worker compile a function; the others wait, and load it from numba's cache on disk."""
    from symosc.engine import binding

    plain = binding.compiled

    def compiled(*arguments: Any, **options: Any) -> dict[str, Any]:
        binding.compiled = plain  # from now on numba does it
        _lock_the_compiler()
        return plain(*arguments, **options)

    binding.compiled = compiled


def _lock_the_compiler() -> None:
    try:
        from numba.core.dispatcher import Dispatcher
    except ImportError:
        return
    compile_it, busy = Dispatcher.compile, []

    def compile_alone(self: Any, signature: Any) -> Any:
        # What the function calls is compiled with it. Other threads do not wait: they may hold numba's own lock.
        if busy or threading.current_thread() is not threading.main_thread():
            return compile_it(self, signature)
        with alone(f"{self.py_func.__qualname__}.compiled"):
            busy.append(self)
            try:
                return compile_it(self, signature)
            finally:
                busy.pop()

    Dispatcher.compile = compile_alone
