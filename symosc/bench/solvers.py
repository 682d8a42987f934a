"""The solvers of the benchmarks, and calls of them with a time limit in a separate process.

What hangs or dies there is a result, not the end of the run. The process is spawned, not forked:
compiled peers (numba, heyoka) and the pool itself run threads, and locks that these hold at a fork
are never released in the child. It serves all calls until one overruns its limit or kills it, so
imports and compilation are paid once.
"""

from __future__ import annotations

import os
import pkgutil
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, TimeoutError
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from multiprocessing import get_context
from threading import Event as Flag
from threading import Lock
from typing import Any, NamedTuple, TypeAlias

from pebble import ProcessExpired, ProcessPool

from symosc import bench
from symosc.base.aliases import Record
from symosc.scenes import Scene
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.simulate import ACCURACY, simulate
from symosc.simulation.tables import EventTable

HANG = "hang"
CRASH = "crash"
#: How much of an exception's message is kept.
LONGEST_MESSAGE = 120
#: Seconds for the first call of a solver, with all that it imports and compiles, on a slow machine
#: too.
FIRST_LIMIT = 600.0
PROCESSES = min(2, os.cpu_count() or 1)


#: Digits of the runs that errors are measured against.
REFERENCE_DIGITS = 40


class SolverEvent(NamedTuple):
    """A switching event that a solver found, named as in `symosc.Event`."""

    t: float
    x: float
    kind: str
    boundary: int


#: prepare(scene, tolerance) does what a user would do once (compile, build the integrator). It
#: returns a function that follows the scene from its start to its end and returns its events; where
#: they come in arrays, an iterator, so that making objects of them is not timed.
Prepare: TypeAlias = Callable[[Scene, float], Callable[[], Iterable[SolverEvent]]]


@dataclass(frozen=True)
class Solver:
    """A solver to compare with: how it finds the events of a scene, with which tolerances, and what
    it needs.
    """

    #: Its name in tables and plots.
    name: str
    prepare: Prepare
    #: Those of a work-precision curve, coarse to fine; 0.0 alone for a solver without one.
    tolerances: tuple[float, ...]
    #: The module that must be importable, "" if it comes with symosc.
    needs: str = ""
    #: Its precautions.
    note: str = ""

    @property
    def missing(self) -> str:
        """Say why the solver cannot run here; "" if it can."""
        if not self.needs or find_spec(self.needs) is not None:
            return ""
        return f"{self.needs} is not installed (extra `bench`)"


def events_of(table: EventTable) -> Iterator[SolverEvent]:
    """Yield the events of a table."""
    yield from map(
        SolverEvent,
        table.t.tolist(),
        table.x.tolist(),
        table.kind.tolist(),
        table.boundary.tolist(),
    )


def compiled(scene: Scene, tolerance: float) -> Callable[[], Iterator[SolverEvent]]:
    """Prepare `simulate_many`.

    The tolerance is its `accuracy`: events with larger error estimates get more digits.
    """
    start = [scene.t0, scene.x0, scene.v0]
    options: Record = {"accuracy": tolerance, "start_error": scene.start_error}
    return lambda: events_of(simulate_many(scene.parameters, start, scene.t_end, **options))


def multiprecision(scene: Scene, tolerance: float) -> Callable[[], list[SolverEvent]]:
    """Prepare `simulate` with mpmath; the tolerance sets its number of digits: 20 for 1e-20."""
    digits = max(5, len(f"{1 / tolerance:.0f}") - 1)  # the zeros of 1/tolerance

    def run() -> list[SolverEvent]:
        # As many events as the time limit allows.
        events = simulate(scene, digits=digits, max_events=10**9).events
        return [
            SolverEvent(float(event.t), float(event.x), event.kind, event.boundary)
            for event in events
        ]

    return run


#: symosc's own; the time of the first one is the unit. Accuracies: one that doubles keep on all
#: shipped scenes, and the default, for which fig8 is computed again with mpmath.
OURS = (
    Solver("symosc, compiled", compiled, (1e-9, ACCURACY), needs="numba"),
    Solver("symosc, mpmath", multiprecision, (1e-20,)),
)


@lru_cache(maxsize=1)
def all_solvers() -> tuple[Solver, ...]:
    """Return symosc's own solvers, then those of all modules peers_* in this package."""
    solvers = list(OURS)
    for module in pkgutil.iter_modules(bench.__path__):
        if module.name.startswith("peers_"):
            solvers += import_module(f"symosc.bench.{module.name}").SOLVERS
    return tuple(solvers)


# -- calls with a time limit -----------------------------------------------------------------------


@dataclass(frozen=True)
class Outcome:
    """The result of a call: its value, or None and a failure."""

    value: Any = None
    # "hang" (time limit), "exception: <type>: <message>" or "crash: <how the process ended>"
    failure: str = ""
    warnings: tuple[str, ...] = ()  # first lines of the different warnings


class Worker:
    """A process that runs one call at a time, in a ``with`` statement.

    What calls print is dropped.
    """

    def __init__(self) -> None:
        self._pool = _one_process()
        self._warm = set[str]()

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *error: object) -> None:
        self._pool.stop()  # a call that is still running belongs to an interrupted caller
        self._pool.join()

    def call(self, limit: float, function: Callable[..., Any], *arguments: object) -> Outcome:
        """Return the outcome of ``function(*arguments)`` (picklable) within `limit` seconds."""
        # The clock includes what the function imports or compiles, but not the start of the
        # process. An argument that cannot be pickled ends in an exception here: that is the
        # caller's mistake.
        if not self._pool.active:  # the process died between two calls
            self._pool = _one_process()
        try:
            outcome: Outcome = self._pool.schedule(
                _guarded, args=(function, arguments), timeout=limit
            ).result()
            return outcome
        except TimeoutError:
            failure = HANG
        except ProcessExpired as death:
            failure = f"{CRASH}: the process ended with exit code {death.exitcode}"
        except BrokenProcessPool:  # before it reported that it had begun
            failure = f"{CRASH}: the process ended"
        self._warm.clear()
        return Outcome(failure=failure)

    def warm(self, name: str, function: Callable[..., Any], *arguments: object) -> None:
        """Make a first call, which imports and compiles, unless the worker's process has had one
        for `name`.
        """
        if name not in self._warm:
            self.call(FIRST_LIMIT, function, *arguments)
            self._warm.add(name)


def _one_process() -> ProcessPool:
    """Return a pool of one process, which starts with the first call."""
    return ProcessPool(max_workers=1, initializer=_drop_output, context=get_context("spawn"))


@contextmanager
def processor_limit(seconds: float) -> Iterator[None]:
    """Raise TimeoutError once a `with` block exceeds `seconds` of processor time.

    It cannot interrupt compiled code.
    """
    # In the main thread only, and where the system has such a timer.
    if not hasattr(signal, "setitimer"):
        yield
        return
    late = TimeoutError(f"more than {seconds:g} s of processor time")

    def stop(*_: object) -> None:
        raise late

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    except SystemError as error:
        # An exception becomes this one where it is raised while compiled code runs.
        if late in (error.__cause__, error.__context__):
            raise late from None
        raise
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _guarded(function: Callable[..., Any], arguments: tuple[object, ...]) -> Outcome:
    """Call a function in the worker; return its outcome."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            value = function(*arguments)
            failure = ""
        except Exception as error:
            value = None
            failure = f"exception: {type(error).__name__}: {_first_line(error)}".removesuffix(": ")
    messages = dict.fromkeys(_first_line(warning.message) for warning in caught)
    return Outcome(value, failure, tuple(messages))


def _first_line(message: object) -> str:
    line = next(iter(str(message).strip().splitlines()), "")
    if len(line) <= LONGEST_MESSAGE:
        return line
    return f"{line[: LONGEST_MESSAGE - 1]}…"


def _drop_output() -> None:
    """Discard standard output and standard error of the worker."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nothing, stream)


def in_parallel(
    chunks: Sequence[Sequence[tuple[Any, ...]]], steps: Iterator[Any], limit: float = FIRST_LIMIT
) -> dict[Any, Outcome]:
    """Run each chunk of jobs (key, function, arguments ...) in its own worker.

    Return the outcomes by key.

    A job may take `limit` seconds. Before each job an item of `steps` is taken, to show the
    progress.
    """
    # The first job of a chunk is done once more before it in each new process, where it may take
    # FIRST_LIMIT.
    stop = Flag()
    turn = Lock()
    done = dict[Any, Outcome]()

    def follow(chunk: Sequence[tuple[Any, ...]]) -> None:
        with Worker() as worker:
            for key, *call in chunk:
                if stop.is_set():
                    break
                # A process that is new, or was ended by a job before, is warmed by the first job.
                _, *first_call = chunk[0]
                worker.warm("", *first_call)
                with turn:
                    next(steps, None)
                done[key] = worker.call(limit, *call)

    with ThreadPoolExecutor(PROCESSES) as pool:
        try:
            list(pool.map(follow, chunks))
        finally:
            stop.set()
    return done
