"""Many initial value problems in columns: read and checked at once, begun in rows, objects where one is asked for.

What doubles, or pairs of them, do not decide is left to `symosc.engine.start`, motion by motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

from symosc.engine.arithmetic import Arithmetic
from symosc.engine.batch import STATE_WIDTH, Batch, batch_of, row_of
from symosc.engine.constant_table import constant_table, table_of
from symosc.engine.start import Start, first_state
from symosc.errors import ParameterError
from symosc.exact import SMALLEST, read_exact, show
from symosc.kernels.double_double import TWO_PI_PAIR
from symosc.kernels.pair_columns import PairColumn
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.simulation.columns import NumberColumn, as_given, named, same
from symosc.simulation.run import MOST_PERIODS, last_time

START_COLUMNS = ("t0", "x0", "v0")
# So few parameter sets are quicker from fractions, which are kept; and so few starts.
FEW_SETS, FEW = 16, 6
# Constants of so many sets are computed at once, some 10 MB: for fewer, what numpy takes per operation counts.
SETS_AT_ONCE = 16384
# 2 pi, and what is missing from the two doubles.
TWO_PI_COLUMN = PairColumn(*TWO_PI_PAIR, 6e-33)


class Begun(NamedTuple):
    """Motions that are about to begin, and the constants of their parameter sets as a table."""

    batch: Batch
    table: np.ndarray


class ParameterSets:
    """Parameter sets from objects or from columns.

    Parameters
    ----------
    given : Parameters, sequence of Parameters, or mapping of all eleven names to a number or an (n,) array
    """

    def __init__(self, given: Any) -> None:
        self._known: dict[int, Parameters] = {}
        self._blocks: dict[int, np.ndarray] = {}
        self._lock = Lock()
        if isinstance(given, Mapping):
            self._of_mapping(given)
            return
        try:
            sets = [given] if isinstance(given, Parameters) else list(given)
        except TypeError:
            sets = [None]
        if not sets or not all(isinstance(p, Parameters) for p in sets):
            hint = "give Parameters, a sequence of them, or a mapping of all their names to numbers or columns"
            raise ParameterError("parameters", given, hint)
        self._known, self.count = dict(enumerate(sets)), len(sets)
        self.columns: dict[str, NumberColumn] = {}

    def _of_mapping(self, given: Mapping[str, Any]) -> None:
        for name in given:
            if name not in PARAMETER_NAMES:
                raise ParameterError(str(name), given[name], f"is no parameter; they are {', '.join(PARAMETER_NAMES)}")
        for name in PARAMETER_NAMES:
            if name not in given:
                raise ParameterError("parameters", dict(given), f"{name} is missing")
        columns = self.columns = {name: NumberColumn(name, as_given(name, given[name])) for name in PARAMETER_NAMES}
        self.count = common_length({name: len(column) for name, column in columns.items()})
        low, high = columns["v1"], columns["v2"]
        wrong = {name: columns[name].hi < 0.0 for name in ("c", "k", "mu1", "mu2", "FN")}
        wrong |= {name: columns[name].hi < float(SMALLEST) for name in ("m", "Omega")}
        gap = low.pairs() - high.pairs()
        wrong["v1"] = gap.hi >= -1.01 * gap.off
        for rows in wrong.values():
            for row in np.flatnonzero(rows).tolist():
                self._checked(row)

    def _checked(self, row: int) -> Parameters:
        """Return the parameters of a row; what is wrong with them is said with its number."""
        try:
            return Parameters(**{name: column.exact(row) for name, column in self.columns.items()})
        except ParameterError as error:
            raise ParameterError(self.columns[error.name].called(row), error.value, error.allowed) from None

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, i: int) -> Parameters:
        i = i if self.count > 1 else 0
        if i not in self._known:
            self._known[i] = self._checked(i)
        return self._known[i]

    def column(self, name: str) -> NumberColumn:
        """Return the numbers of one name."""
        if name not in self.columns:
            self.columns[name] = NumberColumn(name, [getattr(p, name) for p in self._known.values()])
        return self.columns[name]

    def table(self, rows: slice, march_rows: Callable[..., None]) -> np.ndarray:
        """Return the constants of some sets, a table of their own."""
        parts, begin = [], rows.start
        while begin < rows.stop:
            number, first = divmod(begin, SETS_AT_ONCE)
            size = min(rows.stop - begin, SETS_AT_ONCE - first)
            parts.append(self._block(number, march_rows)[first : first + size].copy())
            begin += size
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def _block(self, number: int, march_rows: Callable[..., None]) -> np.ndarray:
        """Return the constants of a block of SETS_AT_ONCE sets; the last two are kept."""
        with self._lock:
            if number not in self._blocks:
                rows = slice(number * SETS_AT_ONCE, min((number + 1) * SETS_AT_ONCE, self.count))
                while len(self._blocks) > 1:
                    self._blocks.pop(next(iter(self._blocks)))
                self._blocks[number] = self._computed(rows, march_rows)
            return self._blocks[number]

    def _computed(self, rows: slice, march_rows: Callable[..., None]) -> np.ndarray:
        numbers = range(rows.start, rows.stop)
        if len(numbers) <= FEW_SETS:
            return table_of(Arithmetic(self[i]).K for i in numbers)
        columns = {name: self.column(name).pairs(rows) for name in PARAMETER_NAMES}
        return constant_table(columns, len(numbers), lambda i: Arithmetic(self[numbers[i]]).K, march_rows)


class Problems(Sequence[Start]):
    """Initial value problems, of which each is made when it is asked for.

    Parameters
    ----------
    parameters : see `ParameterSets`
    starts : (n, 3) or (3,) array_like, or mapping of t0, x0 and v0 to a number or an (n,) array
    t_end : number or (n,) array_like
    start_error : three Fractions, optional
    """

    def __init__(self, parameters: Any, starts: Any, t_end: Any, start_error: Any = None) -> None:
        self.sets = ParameterSets(parameters)
        self.start_error = start_error if start_error and max(start_error) > 0 else None
        self.t0, self.x0, self.v0 = _start_columns(starts)
        self.t_end = NumberColumn("t_end", _one_row("t_end", t_end))
        starts_length = common_length({column.name: len(column) for column in (self.t0, self.x0, self.v0)})
        lengths = {"parameters": len(self.sets), "starts": starts_length, "t_end": len(self.t_end)}
        self._count = common_length(lengths)
        for row in self._perhaps_over():
            t0, end = self.t0.exact(row), self.t_end.exact(row)
            if end <= t0:
                raise ParameterError(self.t_end.called(row), show(end), f"must be later than t0 = {show(t0)}")

    def _perhaps_over(self) -> Sequence[int]:
        """Return the rows whose end may be before their start."""
        if self._count <= FEW:
            return range(self._count)
        with np.errstate(all="ignore"):
            gap = self.t_end.pairs() - self.t0.pairs()
        rows: list[int] = np.flatnonzero(np.broadcast_to(gap.hi <= 1.01 * gap.off, self._count)).tolist()
        return rows

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, i: Any) -> Any:
        t0, x0, v0, end = (column.exact(i) for column in (self.t0, self.x0, self.v0, self.t_end))
        return Start(self.sets[i], t0, x0, v0, end, self.start_error)

    def are_apart(self, rows: np.ndarray, at: np.ndarray, gap: float) -> np.ndarray:
        """Return where a motion has exact starts, a drive, and more than `gap` to each belt but that it starts on."""
        v = _of(self.v0.hi, rows)
        apart = np.full(len(rows), self.start_error is None) & (_of(self.sets.column("B0").hi, rows) != 0.0)
        for boundary in (1, 2):
            apart &= (at == boundary) | (abs(v - _of(self.sets.column(f"v{boundary}").hi, rows)) > gap)
        return apart

    def pair_rows(
        self, rows: np.ndarray, at: np.ndarray, times: np.ndarray, phase: Callable[[Fraction], complex]
    ) -> np.ndarray:
        """Return the starts of motions of one parameter set as rows of complex numbers, which stand for pairs.

        Parameters
        ----------
        rows : (m,)
        at : (m,) the belt that each starts on, or 0.
        times : (m, 2) the ends of the motions, in two parts.
        phase : callable
            Returns the phase at a time, as such a number.

        Returns
        -------
        (m, STATE_WIDTH) array
            With the mode 0, for `symosc.engine.batch.first_pairs`.
        """
        made = np.zeros((len(rows), STATE_WIDTH), complex)
        made[:, 1] = at
        for place, column in ((4, self.x0), (5, self.v0), (11, self.t0)):
            hi, lo, _ = column.parts
            made[:, place].real, made[:, place].imag = _of(hi, rows), _of(lo, rows)
        made[:, 13].real, made[:, 13].imag = times.T
        made[:, 15] = made[:, 11]
        known = {0j: 0j}
        for i, t0 in enumerate(made[:, 11].tolist()):
            if t0 not in known:
                known[t0] = phase(self.t0.exact(int(rows[i])))
            made[i, 3] = known[t0]
        return made

    def begin(self, rows: slice, first_rows: Callable[..., None], march_rows: Callable[..., None]) -> Begun:
        """Return the motions of some rows at their starts."""
        size = rows.stop - rows.start
        table = self.sets.table(rows if len(self.sets) > 1 else slice(0, 1), march_rows)
        sets = np.arange(size) if len(self.sets) > 1 else np.zeros(size, np.int64)
        states = np.zeros((size, STATE_WIDTH))
        if size > FEW:
            self._begin_columns(rows, Begun(batch_of(states, sets), table), first_rows)
        for i in np.flatnonzero(states[:, 0] == 0.0).tolist():
            problem = self[rows.start + i]
            arithmetic = Arithmetic(problem.parameters)
            states[i] = row_of(first_state(problem, arithmetic), *last_time(problem, arithmetic))
        return Begun(batch_of(states, sets), table)

    def _begin_columns(self, rows: slice, begun: Begun, first_rows: Callable[..., None]) -> None:
        """Write the states of some rows, all but those that doubles do not decide: there mode 0 is left."""
        states, size = begun.batch.states, rows.stop - rows.start
        doubts = self._write_clock(rows, states)
        x, v = self.x0.pairs(rows), self.v0.pairs(rows)
        states[:, 4], states[:, 5] = x.hi, v.hi
        for boundary in (1, 2):
            speed = self.sets.column(f"v{boundary}")
            belt = speed.pairs(rows)
            near = np.broadcast_to(v.hi == belt.hi, size)
            sure = near & (v.lo == belt.lo) & (v.off == 0.0) & (belt.off == 0.0)
            states[near, 1] = -1.0  # beside the belt, but not as doubles
            for i in np.flatnonzero(near & ~sure).tolist():
                sure[i] = same(self.v0, speed, rows.start + i, rows.start + i)
            states[sure & (states[:, 1] == -1.0) & ~doubts, 1] = boundary
        if self.start_error:
            states[:, 1] = -1
        first_rows(begun.table, begun.batch.sets, states)

    def _write_clock(self, rows: slice, states: np.ndarray) -> np.ndarray:
        """Write phases and times; return where that takes more than pairs of doubles: there `at` is -1."""
        doubts = np.zeros(len(states), dtype=bool)
        t0, t_end = self.t0.pairs(rows), self.t_end.pairs(rows)
        Omega = self.sets.column("Omega").pairs(rows)
        angle = PairColumn(Omega.hi, Omega.lo, Omega.off, doubts) * t0
        turns = np.floor((angle / TWO_PI_COLUMN).hi)
        theta = angle - TWO_PI_COLUMN * PairColumn(turns)
        phase = np.where(angle.hi == 0.0, 0.0, theta.rounded())
        doubts |= (angle.hi != 0.0) & ~((phase > 0.0) & (phase < TWO_PI_COLUMN.hi))
        # Near the end of what is followed at all.
        doubts |= (t_end.hi - t0.hi) * Omega.hi > 6.0 * MOST_PERIODS
        states[:, 1], states[:, 3] = np.where(doubts, -1.0, 0.0), phase
        states[:, 11], states[:, 12], states[:, 15] = t0.hi, t0.lo, t0.hi
        states[:, 13], states[:, 14] = t_end.hi, t_end.lo
        return doubts


def _of(column: np.ndarray, rows: np.ndarray) -> np.ndarray:
    return column[rows] if len(column) > 1 else column


def _start_columns(starts: Any) -> tuple[NumberColumn, NumberColumn, NumberColumn]:
    """Return t0, x0 and v0."""
    starts = named("starts", starts, START_COLUMNS)
    if isinstance(starts, Mapping):
        columns = [as_given(name, starts[name]) for name in START_COLUMNS]
    else:
        rows = as_given("starts", starts)
        if not isinstance(rows, np.ndarray):
            rows = np.asarray(starts, dtype=object)
        rows = rows.reshape(1, -1) if rows.ndim == 1 else rows
        if rows.ndim != 2 or rows.shape[1] != 3:
            hint = f"must have shape (n, 3), rows of t0, x0, v0, or be a mapping of these names; it has {rows.shape}"
            raise ParameterError("starts", starts, hint)
        columns = [_one_row(name, column) for name, column in zip(START_COLUMNS, rows.T, strict=True)]
    t0, x0, v0 = (NumberColumn(name, column) for name, column in zip(START_COLUMNS, columns, strict=True))
    return t0, x0, v0


def _one_row(name: str, given: Any) -> Any:
    """Return a column; one of a single row is its number."""
    column = as_given(name, given)
    if not isinstance(column, np.ndarray) and isinstance(column, Sequence) and not isinstance(column, (str, bytes)):
        column = np.asarray(column, dtype=object)
    if not isinstance(column, np.ndarray):
        return column
    if column.ndim != 1:
        raise ParameterError(name, given, f"must be a number or have shape (n,); it has {column.shape}")
    if column.dtype == object and len(column) > 1 and all(type(value) is float for value in column):
        return column.astype(float)
    return read_exact(name, column[0]) if len(column) == 1 else column


def common_length(lengths: dict[str, int]) -> int:
    """Return the number of rows that columns of these lengths have together: one number serves for all rows."""
    count = max(lengths.values(), key=lambda length: (length != 1, length))
    for name, length in lengths.items():
        if length not in (1, count):
            raise ParameterError(name, length, f"must have 1 or {count} entries, as the others")
    return count
