"""Many trajectories at once: arrays in, columns of events out, compiled by numba where it is installed."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from symosc.engine.compiled_loop import FLOAT_COLUMNS, INT_COLUMNS, EventRows, room_for, state_of
from symosc.engine.start import settles
from symosc.engine.state import DOUBTFUL, END, FULL, REST
from symosc.exact import read_start_error, whole_number
from symosc.files import write_whole
from symosc.model import MODE_NAMES
from symosc.simulation.batch_loop import CAPACITY, chosen_loops, joined
from symosc.simulation.ladder import Ladder, Limits, without
from symosc.simulation.problems import Problems
from symosc.simulation.run import EVENT_KINDS, MOST_PERIODS, check_reached
from symosc.simulation.simulate import MOST_EVENTS, end_status, in_doubles, read_accuracy
from symosc.simulation.trajectory import Event
from symosc.simulation.workers import Patrol, Progress, in_chunks, read_progress, read_workers

#: Kinds of events by code.
KIND_NAMES = EVENT_KINDS


@dataclass(frozen=True, eq=False)
class EventTable:
    """Events of many trajectories, one row per event, in order of trajectory and time.

    Attributes
    ----------
    trajectory : (rows,) int array
        Number of the trajectory, an index into `status`.
    t, x, v, theta, t_error, x_error : (rows,) float arrays
        As in `Event`.
    boundary : (rows,) int array
    kind, source, target : (rows,) arrays of str
        As in `Event`; made on access from the columns kind_code, source_code and target_code (see KIND_NAMES and
        MODE_NAMES).
    status : list of str
        Per trajectory: "t_end", "max_events", "equilibrium" or "undecidable", as in `Trajectory`.

    Examples
    --------
    >>> from symosc import load_scene, simulate_many
    >>> table = simulate_many(load_scene("fig5").parameters, (0, 0, 0), t_end=7, use_numba=False)
    >>> table.kind.tolist(), table.status
    (['stick', 'slip', 'stick', 'slip', 'stick'], ['t_end'])
    """

    trajectory: np.ndarray
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    theta: np.ndarray
    t_error: np.ndarray
    x_error: np.ndarray
    boundary: np.ndarray
    kind_code: np.ndarray
    source_code: np.ndarray
    target_code: np.ndarray
    status: list[str]

    def __len__(self) -> int:
        return len(self.t)

    def __eq__(self, other: object) -> bool:
        """Whether both have the same events and statuses."""
        if not isinstance(other, EventTable):
            return NotImplemented
        return all(np.array_equal(column, vars(other)[name]) for name, column in vars(self).items())

    __hash__ = None  # type: ignore[assignment]  # arrays have none

    @property
    def kind(self) -> np.ndarray:
        """Kinds of the events."""
        return _names(KIND_NAMES)[self.kind_code]

    @property
    def source(self) -> np.ndarray:
        """Modes before the events."""
        return _names(MODE_NAMES)[self.source_code]

    @property
    def target(self) -> np.ndarray:
        """Modes after the events."""
        return _names(MODE_NAMES)[self.target_code]

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns by name, names instead of codes."""
        plain = {name: getattr(self, name) for name in ("trajectory", *FLOAT_COLUMNS, "boundary")}
        return plain | {"kind": self.kind, "source": self.source, "target": self.target}

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as CSV with a header ("-": to standard output); OutputError if it cannot be written."""

        def write(draft: Path) -> None:
            with draft.open("w", encoding="utf-8", newline="") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(self.columns())
                writer.writerows(zip(*(column.tolist() for column in self.columns().values()), strict=True))

        write_whole(path, write)


def simulate_many(
    parameters: Any,
    starts: Any,
    t_end: Any,
    *,
    max_events: int | None = None,
    accuracy: float | None = None,
    start_error: Any = None,
    use_numba: bool | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> EventTable:
    """Follow many motions in double precision, on all cores; compiled when numba is installed (extra `fast`).

    Parameters
    ----------
    parameters : Parameters, sequence of n Parameters, or mapping of all their names to a number or an (n,) array
    starts : array_like, shape (n, 3) or (3,), or mapping of t0, x0 and v0 to a number or an (n,) array
        Rows of t0, x0, v0; floats are read as the decimals that they print as. One row serves for all parameters.
    t_end : number or array_like, shape (n,)
    max_events : int, optional
        Per trajectory (default 1,000,000).
    accuracy, start_error : optional
        As in `simulate`, for all motions. With accuracy ``math.inf`` the paths of doubles are followed as they are.
    use_numba : bool, optional
        None: if it is installed. The same source runs without it, slower, with the same results.
    workers : int, optional
        Threads; None: one for each core. Their number changes no bit of the result.
    progress : callable, optional
        Called with the number of motions that are done and of all, now and then.

    Returns
    -------
    EventTable
        Events, errors and statuses are those of `simulate` for each motion, to the last bit.

    Raises
    ------
    ParameterError
        If a number is not finite, shapes do not fit or a t_end is not later than its t0; it names the row.
    MissingExtraError
        If `use_numba` is True and numba is missing.

    Examples
    --------
    >>> from symosc import load_scene, simulate_many
    >>> starts = [(0, 0, 0), (0, 1, 2)]  # for so few starts the compilation would not be worth its time
    >>> table = simulate_many(load_scene("fig9").parameters, starts, t_end=3, use_numba=False)
    >>> table.trajectory.tolist()
    [0, 0, 0, 0, 0, 1, 1, 1, 1, 1]
    """
    problems = Problems(parameters, starts, t_end, read_start_error(start_error))
    most = MOST_EVENTS if max_events is None else whole_number("max_events", max_events, 1)
    limits, loops = Limits(most, read_accuracy(accuracy)), chosen_loops(use_numba)
    threads, shown = read_workers(workers), read_progress(progress)

    def work(rows: slice, room: EventRows, patrol: Patrol) -> _Part:
        return _part(problems, rows, Ladder(problems, rows, loops, limits, room, patrol))

    threads = threads if loops.in_threads else 1
    return _table(in_chunks(len(problems), work, partial(room_for, CAPACITY), threads, shown))


class _Part(NamedTuple):
    """Events of a chunk, in order of trajectory and time, and the statuses of its trajectories."""

    rows: EventRows
    status: list[str]


def _part(problems: Problems, rows: slice, steps: Ladder) -> _Part:
    """Return what became of the motions of a chunk; those in doubt still are followed one by one."""
    status, open_ones = _statuses(steps)
    looks = dict(steps.looks)
    for i in open_ones:
        if i not in looks:
            looks[i] = in_doubles(steps.problem(i), *steps.limits)
    parts = [without(part, list(looks)) for part in steps.rows] if looks else steps.rows
    for i, trajectory in looks.items():
        status[i] = trajectory.status
        parts = [*parts, _rows_of(i, trajectory.events)]
    events = joined(parts)
    if steps.mixed:
        order = np.argsort(events.ints[:, 0], kind="stable")
        events = EventRows(*(column[order] for column in events))
    events.ints[:, 0] += rows.start
    return _Part(events, status)


def _statuses(steps: Ladder) -> tuple[list[str], list[int]]:
    """Return the statuses of a chunk's motions, and the numbers of those that need a closer look."""
    batch = steps.batch
    codes, counts, periods = batch.codes, batch.counts, batch.states[:, 2]
    status = np.where(codes == FULL, "max_events", "t_end").tolist()
    # Motions without a drive may have come to rest.
    for i in np.flatnonzero((codes == REST) | ((codes == END) & (counts == 0))).tolist():
        problem, state = steps.problem(i), state_of(batch.states, i)
        code = REST if codes[i] == END and settles(problem) else int(codes[i])
        status[i] = end_status(code, state.mode, state.v, problem.parameters)
    for i in np.flatnonzero((codes == END) & (periods >= MOST_PERIODS)).tolist():
        check_reached(steps.problem(i), int(periods[i]))
    return status, np.flatnonzero(np.isin(codes, DOUBTFUL)).tolist()


def _table(parts: list[_Part]) -> EventTable:
    """Return the events of all chunks; each column in one piece."""
    columns = {}
    for names, which in ((FLOAT_COLUMNS, "floats"), (INT_COLUMNS, "ints")):
        for n, name in enumerate(names):
            pieces = [getattr(part.rows, which)[:, n] for part in parts]
            columns[name] = np.concatenate(pieces) if pieces else room_for(0)[which == "ints"][:, n]
    return EventTable(**columns, status=[each for part in parts for each in part.status])


def _rows_of(i: int, events: Sequence[Event]) -> EventRows:
    """Return the events of one trajectory as rows."""
    codes = {name: code for names in (KIND_NAMES, MODE_NAMES) for code, name in names.items()}
    rows = room_for(len(events))
    for n, event in enumerate(events):
        rows.floats[n] = [getattr(event, name) for name in FLOAT_COLUMNS]
        rows.ints[n] = i, codes[event.kind], event.boundary, codes[event.source], codes[event.target]
    return rows


def _names(by_code: dict[int, str]) -> np.ndarray:
    return np.array([by_code.get(code, "") for code in range(max(by_code) + 1)])
