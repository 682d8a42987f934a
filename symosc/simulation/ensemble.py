"""Many trajectories at once: arrays in, columns of events out, compiled by numba where it is installed."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from symosc.engine.compiled_loop import (
    FLOAT_COLUMNS,
    INT_COLUMNS,
    Batch,
    EventRows,
    state_of,
)
from symosc.engine.start import Start, settles
from symosc.engine.state import DOUBTFUL, END, FULL, REST
from symosc.errors import ParameterError
from symosc.exact import read_exact, read_start_error, show, whole_number
from symosc.files import write_whole
from symosc.model import MODE_NAMES, Parameters
from symosc.simulation.batch_loop import chosen_loop, joined
from symosc.simulation.ladder import Ladder
from symosc.simulation.run import EVENT_KINDS, check_reached
from symosc.simulation.simulate import MOST_EVENTS, end_status, in_doubles, read_accuracy
from symosc.simulation.trajectory import Event, Trajectory

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
    parameters: Parameters | Sequence[Parameters],
    starts: Any,
    t_end: Any,
    *,
    max_events: int | None = None,
    accuracy: float | None = None,
    start_error: Any = None,
    use_numba: bool | None = None,
) -> EventTable:
    """Follow many motions in double precision; the event loop is compiled when numba is installed (extra `fast`).

    Parameters
    ----------
    parameters : Parameters or sequence of n Parameters
    starts : array_like, shape (n, 3) or (3,)
        Rows of t0, x0, v0; floats are read as the decimals that they print as. One row serves for all parameters.
    t_end : number or array_like, shape (n,)
    max_events : int, optional
        Per trajectory (default 1,000,000).
    accuracy : float, optional
        As in `simulate` (default 1e-13): a trajectory that has an event with a larger error is followed with more
        digits. With ``math.inf`` the paths that doubles compute are followed as they are.
    start_error : number or three numbers, optional
        Half-widths to which all t0, x0 and v0 are known, as in `simulate`; None: they are exact.
    use_numba : bool, optional
        None: if it is installed. The same source runs without it, slower, with the same results.

    Returns
    -------
    EventTable

    Raises
    ------
    ParameterError
        If a number is not finite, shapes do not fit or a t_end is not later than its t0.
    MissingExtraError
        If `use_numba` is True and numba is missing.

    Notes
    -----
    Events, errors and statuses are those of `simulate` for each motion, to the last bit; it follows itself a motion
    with a contact that doubles cannot decide, or with an event whose error is larger than `accuracy`.

    Examples
    --------
    >>> from symosc import load_scene, simulate_many
    >>> starts = [(0, 0, 0), (0, 1, 2)]  # for so few starts the compilation would not be worth its time
    >>> table = simulate_many(load_scene("fig9").parameters, starts, t_end=3, use_numba=False)
    >>> table.trajectory.tolist()
    [0, 0, 0, 0, 0, 1, 1, 1, 1, 1]
    """
    problems = _read_problems(parameters, starts, t_end, read_start_error(start_error))
    most = MOST_EVENTS if max_events is None else whole_number("max_events", max_events, 1)
    asked = read_accuracy(accuracy)
    steps = Ladder(problems, chosen_loop(use_numba), most, asked)
    table = _table(steps.rows, [""] * len(problems), steps.mixed)
    open_ones = [i for i in _statuses(table, steps.batch, problems) if i not in steps.looks]
    looks = steps.looks | {i: in_doubles(problems[i], most, asked) for i in open_ones}
    return _with_looks(table, looks) if looks else table


def _statuses(table: EventTable, batch: Batch, problems: list[Start]) -> list[int]:
    """Write the statuses of trajectories into the table; return the numbers of those that need a closer look."""
    open_ones = []
    for i, (code, count) in enumerate(zip(batch.codes.tolist(), batch.counts.tolist(), strict=True)):
        if code in DOUBTFUL:
            open_ones.append(i)
        elif code == FULL:
            table.status[i] = "max_events"
        else:
            state = state_of(batch.states, i)
            code = REST if code == END and count == 0 and settles(problems[i]) else code
            table.status[i] = end_status(code, state.mode, state.v, problems[i].parameters)
            if code == END:
                check_reached(problems[i], state.n)
    return open_ones


def _read_problems(parameters: Any, starts: Any, t_end: Any, start_error: Any) -> list[Start]:
    try:
        sets = [parameters] if isinstance(parameters, Parameters) else list(parameters)
    except TypeError:
        sets = [None]
    if not all(isinstance(p, Parameters) for p in sets):
        raise ParameterError("parameters", parameters, "give Parameters or a sequence of them")
    rows = np.asarray(starts, dtype=object)
    rows = rows.reshape(1, -1) if rows.ndim == 1 else rows
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ParameterError("starts", starts, f"must have shape (n, 3), rows of t0, x0, v0; it has {rows.shape}")
    ends = np.atleast_1d(np.asarray(t_end, dtype=object))
    if ends.ndim != 1:
        raise ParameterError("t_end", t_end, f"must be a number or have shape (n,); it has {ends.shape}")
    count = max(len(sets), len(rows), len(ends))
    for name, length in (("parameters", len(sets)), ("starts", len(rows)), ("t_end", len(ends))):
        if length not in (1, count):
            raise ParameterError(name, length, f"must have 1 or {count} entries, as the others")
    names = ("t0", "x0", "v0")
    exact: dict[Any, Fraction] = {}

    def read(name: str, value: Any) -> Fraction:
        # Numbers of two types may be equal and mean two fractions: the float 0.1 is 1/10, Fraction(0.1) is not.
        key = type(value), value
        try:
            known = key in exact
        except TypeError:  # a list, or another thing that is no number
            return read_exact(name, value)
        if not known:
            exact[key] = read_exact(name, value)
        return exact[key]

    problems = []
    for i in range(count):
        row, end = rows[i % len(rows)], read("t_end", ends[i % len(ends)])
        t0, x0, v0 = (read(name, value) for name, value in zip(names, row, strict=True))
        if end <= t0:
            raise ParameterError("t_end", show(end), f"must be later than t0 = {show(t0)}")
        problems.append(Start(sets[i % len(sets)], t0, x0, v0, end, start_error))
    return problems


def _table(parts: list[EventRows], status: list[str], sort: bool) -> EventTable:
    numbers, codes = joined(parts)
    if sort:
        order = np.argsort(codes[:, 0], kind="stable")
        numbers, codes = numbers[order], codes[order]
    columns = dict(zip(FLOAT_COLUMNS, numbers.T, strict=True)) | dict(zip(INT_COLUMNS, codes.T, strict=True))
    return EventTable(**columns, status=status)


def _names(by_code: dict[int, str]) -> np.ndarray:
    return np.array([by_code.get(code, "") for code in range(max(by_code) + 1)])


def _with_looks(table: EventTable, looks: dict[int, Trajectory]) -> EventTable:
    """Replace trajectories that ended in doubt or lost accuracy by what `simulate` says of them."""
    kept = ~np.isin(table.trajectory, list(looks))
    columns = {name: [column[kept]] for name, column in vars(table).items() if name != "status"}
    for i, trajectory in looks.items():
        table.status[i] = trajectory.status
        _append(columns, i, trajectory.events)
    joined = {name: np.concatenate(parts) for name, parts in columns.items()}
    order = np.argsort(joined["trajectory"], kind="stable")
    return EventTable(**{name: column[order] for name, column in joined.items()}, status=table.status)


def _append(columns: dict[str, list[np.ndarray]], i: int, events: Iterable[Event]) -> None:
    rows = list(events)
    codes = {name: code for names in (KIND_NAMES, MODE_NAMES) for code, name in names.items()}
    for name, parts in columns.items():
        if name == "trajectory":
            values = [i] * len(rows)
        elif name.endswith("_code"):
            values = [codes[getattr(event, name.removesuffix("_code"))] for event in rows]
        else:
            values = [getattr(event, name) for event in rows]
        parts.append(np.array(values, dtype=parts[0].dtype))
