"""Calls with a time limit, in a process of their own: what hangs or dies there is a result, not the end of the run.

The process is spawned, not forked. Compiled peers (numba, heyoka) and the pool itself run threads, and locks that these
hold at a fork are never released in the child. It serves all calls until one overruns its limit or kills it, so imports
and compilation are paid once; after that the next call gets a new process.
"""

from __future__ import annotations

import os
import signal
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import TimeoutError
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

from pebble import ProcessExpired, ProcessPool

HANG, CRASH = "hang", "crash"
#: How much of an exception's message is kept.
LONGEST_MESSAGE = 120
#: Seconds for the first call of a solver, with all that it imports and compiles, on a slow machine too.
FIRST_LIMIT = 600.0


@dataclass(frozen=True)
class Outcome:
    """What became of a call.

    Attributes
    ----------
    value : object
        What the function returned; None after a failure.
    failure : str
        "" after success, else "hang" (the time limit was reached), "exception: <type>: <message>" or
        "crash: <how the process ended>".
    warnings : tuple of str
        First lines of the different warnings that the function gave.
    """

    value: Any = None
    failure: str = ""
    warnings: tuple[str, ...] = ()

    @property
    def lost(self) -> bool:
        """Whether the process is gone, with all that it had imported and compiled."""
        return self.failure == HANG or self.failure.startswith(CRASH)


class Worker:
    """A process that runs one call at a time; use it in a ``with`` statement.

    What calls write to standard output or standard error, from C and Fortran too, is dropped.

    Examples
    --------
    >>> with Worker() as worker:
    ...     worker.call(10.0, divmod, 7, 2).value
    (3, 1)
    """

    def __init__(self) -> None:
        self._pool = ProcessPool(max_workers=1, initializer=_be_quiet, context=get_context("spawn"))

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *error: object) -> None:
        self._pool.stop()  # a call that is still running belongs to an interrupted caller
        self._pool.join()

    def call(self, limit: float, function: Callable[..., Any], *arguments: object) -> Outcome:
        """Return what became of ``function(*arguments)`` within `limit` seconds.

        The function, its arguments and its result must be picklable. The clock includes what the function imports or
        compiles, but not the start of the process.
        """
        # An argument that cannot be pickled ends in an exception here: that is the caller's mistake.
        future = self._pool.schedule(_guarded, args=(function, arguments), timeout=limit)
        try:
            outcome: Outcome = future.result()
        except TimeoutError:
            return Outcome(failure=HANG)
        except ProcessExpired as death:
            return Outcome(failure=f"{CRASH}: the process ended with exit code {death.exitcode}")
        return outcome


@contextmanager
def processor_limit(seconds: float) -> Iterator[None]:
    """Raise TimeoutError in a block that takes more processor time; compiled code is interrupted when it returns.

    In the main thread only, and where the system has such a timer.
    """
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(*_: object) -> None:
        raise TimeoutError(f"more than {seconds:g} s of processor time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _guarded(function: Callable[..., Any], arguments: tuple[object, ...]) -> Outcome:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            value, failure = function(*arguments), ""
        except Exception as error:
            value, failure = None, f"exception: {type(error).__name__}: {_first_line(error)}".removesuffix(": ")
    return Outcome(value, failure, tuple(dict.fromkeys(_first_line(each.message) for each in caught)))


def _first_line(message: object) -> str:
    line = next(iter(str(message).strip().splitlines()), "")
    return line if len(line) <= LONGEST_MESSAGE else f"{line[: LONGEST_MESSAGE - 1]}…"


def _be_quiet() -> None:
    nothing = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nothing, stream)
