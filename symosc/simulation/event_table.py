"""Events of many trajectories in columns."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.arguments import public
from symosc.display.drawable import Drawable
from symosc.display.frames import imported
from symosc.engine.batch import FLOAT_COLUMNS, INT_COLUMNS, EventRows, joined, room_for
from symosc.files import write_whole
from symosc.model import MODE_NAMES
from symosc.simulation.run import EVENT_KINDS
from symosc.simulation.trajectory import Event

#: Kinds of events by code.
KIND_NAMES = EVENT_KINDS


@dataclass(frozen=True, eq=False, repr=False)
class EventTable(Drawable):
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

    @public
    def __getitem__(self, trajectory: int) -> EventTable:
        """Return the events of one trajectory, as a table of it alone."""
        number = range(len(self.status))[trajectory]
        first, last = np.searchsorted(self.trajectory, [number, number + 1])
        columns = {name: column[first:last] for name, column in vars(self).items() if name != "status"}
        return EventTable(**columns | {"trajectory": columns["trajectory"] * 0}, status=[self.status[number]])

    def __repr__(self) -> str:
        motions = f"{counted(len(self.status), 'motion')} ({statuses(self.status)})"
        return f"<EventTable of {counted(len(self), 'event')} of {motions}>"

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

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per event; MissingExtraError if pandas is not installed."""
        return imported("pandas").DataFrame(self.columns())

    def to_xarray(self) -> Any:
        """Return a Dataset over `event`, with the statuses over `motion`; MissingExtraError without xarray."""
        columns: Record = {name: (("event",), column) for name, column in self.columns().items()}
        return imported("xarray").Dataset(columns | {"status": (("motion",), np.array(self.status, dtype=str))})


def _names(by_code: dict[int, str]) -> np.ndarray:
    return np.array([by_code.get(code, "") for code in range(max(by_code) + 1)])


def table_from(parts: Sequence[EventRows], status: list[str]) -> EventTable:
    """Return rows of events as a table, each column in one piece."""
    columns, parts = {}, parts or [room_for(0)]
    for names, which in ((FLOAT_COLUMNS, 0), (INT_COLUMNS, 1)):
        for n, name in enumerate(names):
            columns[name] = joined([part[which][n] for part in parts])
    return EventTable(**columns, status=status)


def rows_of(i: int, events: Sequence[Event]) -> EventRows:
    """Return the events of one trajectory as rows."""
    codes = {name: code for names in (KIND_NAMES, MODE_NAMES) for code, name in names.items()}
    rows = room_for(len(events))
    for n, event in enumerate(events):
        rows.floats[:, n] = [getattr(event, name) for name in FLOAT_COLUMNS]
        rows.ints[:, n] = i, codes[event.kind], event.boundary, codes[event.source], codes[event.target]
    return rows


def counted(count: int, what: str) -> str:
    """Return a number of things in words."""
    return f"{count:,} {what}{'s' * (count != 1)}"


def statuses(status: Any) -> str:
    """Return how many motions ended in which way, in short."""
    names, counts = np.unique(np.asarray(status, dtype=str), return_counts=True)
    return ", ".join(f"{count:,} {name}" for name, count in zip(names.tolist(), counts.tolist(), strict=True)) or "none"
