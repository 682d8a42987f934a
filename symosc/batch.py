"""Many trajectories at once: arrays in, columns of events out, compiled by numba where it is installed."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import cos
from pathlib import Path
from typing import Any

import numpy as np

from symosc import loop
from symosc.advance import END, REST
from symosc.errors import MissingExtraError, ParameterError
from symosc.exact import read_exact, show, whole_number
from symosc.files import write_whole
from symosc.kernels._generated import acceleration
from symosc.model import MODE_NAMES, Parameters
from symosc.numerics import Arithmetic, MpArithmetic, compiled
from symosc.path import EVENT_KINDS, START_DIGITS, Start, State, first_state, rounded
from symosc.simulation import LONGEST_BACKUP, MOST_EVENTS, read_accuracy, simulate
from symosc.trajectory import Event

CAPACITY = 1 << 18
STATUS_NAMES = {END: "t_end", REST: "t_end", loop.FULL: "max_events", loop.IN_DOUBT: "undecidable"}
#: Kinds of events by code.
KIND_NAMES = EVENT_KINDS
# A force on a belt at the start that is smaller than this part of its terms is looked at with more digits.
CLEAR_FORCE = 1e-9


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
        plain = {name: getattr(self, name) for name in ("trajectory", *loop.FLOAT_COLUMNS, "boundary")}
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
        A short trajectory with an event known to less than that is followed once more, as by `simulate` (default
        1e-13, ``math.inf`` for never).
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
    A trajectory with a contact that double precision cannot decide, and a short one that lost accuracy, is followed
    once more by `simulate`. In the others decisions refer to the computed path; how far that may be from the true one
    is what t_error and x_error estimate.
    """
    sets, problems = _read_problems(parameters, starts, t_end)
    most = MOST_EVENTS if max_events is None else whole_number("max_events", max_events, 1)
    needed = read_accuracy(accuracy)
    follow = _follow_all(use_numba)
    floats: list[np.ndarray] = []
    ints: list[np.ndarray] = []
    codes, short = np.zeros(len(sets), np.int64), np.zeros(len(sets), bool)
    worst = np.zeros(len(sets))
    groups: dict[Parameters, list[int]] = {}
    for i, p in enumerate(sets):
        groups.setdefault(p, []).append(i)
    for p, members in groups.items():
        arithmetic = Arithmetic(p)
        K = arithmetic.K._replace(sigmas=0.0)
        states = np.array([_initial_row(Start(p, *problems[i]), arithmetic) for i in members])
        t0 = np.array([float(problems[i][0]) for i in members])
        counts, ends = np.zeros(len(members), np.int64), np.zeros(len(members), np.int64)
        errors = np.zeros(len(members))
        begin = 0
        while begin < len(members):
            out_float, out_int = np.empty((CAPACITY, 6)), np.empty((CAPACITY, 5), np.int32)
            begin, rows = follow(begin, states, t0, counts, ends, errors, most, out_float, out_int, K)
            if len(groups) > 1:
                out_int[:rows, 0] = np.asarray(members)[out_int[:rows, 0]]
            floats.append(out_float[:rows])
            ints.append(out_int[:rows])
        codes[members], worst[members], short[members] = ends, errors, counts <= LONGEST_BACKUP
    status = [STATUS_NAMES[code] for code in codes.tolist()]
    table = _table(floats, ints, status, sort=len(groups) > 1)
    doubtful = np.flatnonzero((codes == loop.IN_DOUBT) | (short & (worst > needed)))
    return _with_closer_looks(table, doubtful.tolist(), sets, problems, most, needed) if doubtful.size else table


def _follow_all(use_numba: bool | None) -> Any:
    if use_numba is not None and not isinstance(use_numba, (bool, np.bool_)):
        raise ParameterError("use_numba", use_numba, "must be True, False or None")
    if use_numba is not None and not use_numba:
        return loop.follow_all
    try:
        return compiled()["follow_all"]
    except MissingExtraError:
        if use_numba:
            raise
        return loop.follow_all


def _read_problems(parameters: Any, starts: Any, t_end: Any) -> tuple[list[Parameters], list[tuple[Fraction, ...]]]:
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
        start = tuple(read(name, value) for name, value in zip(names, row, strict=True))
        if end <= start[0]:
            raise ParameterError("t_end", show(end), f"must be later than t0 = {show(start[0])}")
        problems.append((*start, end))
    return [sets[i % len(sets)] for i in range(count)], problems


def _initial_row(start: Start, arithmetic: Arithmetic) -> list[float]:
    """Return a row of `symosc.loop`'s states; only a start on a belt with a force near 0 needs more than floats."""
    p, K = start.parameters, arithmetic.K
    n, theta = arithmetic.phase(start.t0)
    n_end, theta_end = arithmetic.phase(start.t_end)
    x, v, c = float(start.x0), float(start.v0), cos(theta)
    at = 1 if start.v0 == p.v1 else 2 if start.v0 == p.v2 else 0
    mode = 1 if start.v0 < p.v1 else 2 if start.v0 < p.v2 else 3
    lowest, highest = (at, at + 1) if at else (mode, mode)
    A = (K.A1, K.A2, K.A3)
    Fb, Fa = (acceleration(x, v, c, A[domain - 1], K.cm, K.w0sq, K.f0) for domain in (lowest, highest))
    eps = 2.0**-53
    S11, S22 = (eps * x) ** 2, 0.0 if at else (eps * v) ** 2
    if at:
        size = CLEAR_FORCE * (abs(A[lowest - 1]) + abs(K.f0) + abs(K.w0sq * x) + abs(K.cm * v))
        if min(abs(Fb), abs(Fa)) <= size:
            state = rounded(first_state(start, MpArithmetic(p, START_DIGITS)))
        else:
            mode = at + 1 if Fa > 0.0 else at if Fb < 0.0 else 3 + at
            Fb, Fa = (Fb, Fa) if mode > 3 else (Fa, Fa) if mode > at else (Fb, Fb)
            state = State(mode, at, n, theta, x, v, Fb, Fa, S11, 0.0, S22)
    else:
        state = State(mode, at, n, theta, x, v, Fb, Fa, S11, 0.0, S22)
    entries = [float(entry) for entry in state.as_tuple()]
    entries[2] = 0.0
    return [*entries, state.theta, float(n_end - state.n), theta_end]


def _table(floats: list[np.ndarray], ints: list[np.ndarray], status: list[str], sort: bool) -> EventTable:
    numbers, codes = (parts[0] if len(parts) == 1 else np.concatenate(parts) for parts in (floats, ints))
    if sort:
        order = np.argsort(codes[:, 0], kind="stable")
        numbers, codes = numbers[order], codes[order]
    columns = dict(zip(loop.FLOAT_COLUMNS, numbers.T, strict=True))
    columns |= dict(zip(("trajectory", "kind_code", "boundary", "source_code", "target_code"), codes.T, strict=True))
    return EventTable(**columns, status=status)


def _names(by_code: dict[int, str]) -> np.ndarray:
    return np.array([by_code.get(code, "") for code in range(max(by_code) + 1)])


def _with_closer_looks(
    table: EventTable,
    doubtful: list[int],
    sets: list[Parameters],
    problems: list[tuple[Fraction, ...]],
    most: int,
    accuracy: float,
) -> EventTable:
    """Replace trajectories that ended in doubt, and short ones that lost accuracy, by what `simulate` says of them."""
    kept = ~np.isin(table.trajectory, doubtful)
    columns = {name: [column[kept]] for name, column in vars(table).items() if name != "status"}
    for i in doubtful:
        t0, x0, v0, t_end = problems[i]
        trajectory = simulate(sets[i], t0=t0, x0=x0, v0=v0, t_end=t_end, max_events=most, accuracy=accuracy)
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
