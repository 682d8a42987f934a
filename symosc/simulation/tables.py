"""The results of `simulate_many`: events of many motions in columns, or a summary with a row per
motion.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from symosc.base.aliases import Record
from symosc.base.arguments import FLAG, SLICE, WHOLE, public, require, sequence_of
from symosc.base.display.drawable import Drawable
from symosc.base.display.frames import imported
from symosc.base.exact import scalar_of, unmasked, whole_number
from symosc.base.files import write_whole
from symosc.engine.batch import EventRows, event_buffer, joined_arrays
from symosc.engine.events import CODE_COLUMNS, CODE_NAMES, EVENT_COLUMNS, FLOAT_COLUMNS, Event

#: Attributes of an `EventTable` for the code fields of an event: those with names have "_code"
#: behind their own.
CODE_ATTRIBUTES = tuple(f"{name}_code" if name in CODE_NAMES else name for name in CODE_COLUMNS)
#: Columns of an `EventTable` with derivatives.
CHANGES = ("dt", "dx", "regular")


class Columns(Drawable):
    """Base class of results whose columns are attributes.

    Two of the same class are equal if all columns are.
    """

    __hash__ = None  # type: ignore[assignment]  # arrays have none

    def __init__(self, **columns: Any) -> None:
        vars(self).update(columns)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        mine = vars(self)
        others = vars(other)
        return mine.keys() == others.keys() and all(
            np.array_equal(column, others[name], equal_nan=np.asarray(column).dtype.kind == "f")
            for name, column in mine.items()
        )


def _index(name: str, number: int, count: int) -> int:
    """Return the index from 0 of one of `count` motions, which may be counted from the end.

    An IndexError, as of any sequence, calls it `name`.
    """
    if not -count <= number < count:
        if count:
            allowed = f"must be from 0 to {count - 1}, or from -1 to {-count} from the end"
        else:
            allowed = "there are no motions"
        raise IndexError(f"{name} = {number}: {allowed}")
    return number % count


class EventTable(Columns):
    """Events of many trajectories, one row per event, in order of trajectory and time.

    Attributes
    ----------
    trajectory : (rows,) int array
        Number of the trajectory, an index into `status`.
    t, x, v, theta, t_error, x_error : (rows,) float arrays
        As in `Event`; each of its fields is a column here.
    boundary : (rows,) int array
    kind, source, target : (rows,) arrays of str
        As in `Event`; the table keeps them as numbers, kind_code, source_code and target_code.
    status : list of str
        Per trajectory: "t_end", "max_events", "equilibrium" or "undecidable", as in `Trajectory`.
    wrt : tuple of str
        What the events are differentiated by, if that was asked for; empty else.
    dt, dx, regular : (rows, wrt) arrays
        As in `Sensitivities`; with `wrt` only.

    Examples
    --------
    >>> from symosc import load_scene, simulate_many
    >>> table = simulate_many(load_scene("fig5").parameters, (0, 0, 0), t_end=7, use_numba=False)
    >>> table.kind.tolist(), table.status
    (['stick', 'slip', 'stick', 'slip', 'stick'], ['t_end'])
    """

    _drawn_by = "events_figure"
    _made_by = "simulate_many(...)"

    trajectory: np.ndarray
    status: list[str]

    wrt: tuple[str, ...]

    def __getattr__(self, name: str) -> Any:
        if name in CODE_NAMES:
            names = CODE_NAMES[name]
            codes = vars(self)[f"{name}_code"]
            name_of_code = np.array([names.get(code, "") for code in range(max(names) + 1)])
            return name_of_code[codes]
        if name in CHANGES:
            more = f"; with wrt= also {', '.join(CHANGES)}"
        else:
            more = ""
        has = ", ".join(("trajectory", *EVENT_COLUMNS))
        raise AttributeError(f"EventTable has no column {name!r}; it has {has}{more}")

    def __len__(self) -> int:
        return len(self.trajectory)

    @public
    def __getitem__(self, trajectory: int) -> EventTable:
        """Return the events of one trajectory, as a table of it alone."""
        number = _index("trajectory", whole_number("trajectory", trajectory), len(self.status))
        rows = slice(*np.searchsorted(self.trajectory, [number, number + 1]))
        selected = select_rows(self, rows, [self.status[number]])
        selected.trajectory = selected.trajectory * 0
        return selected

    def __repr__(self) -> str:
        motions = f"{counted(len(self.status), 'motion')} ({statuses(self.status)})"
        return f"<EventTable of {counted(len(self), 'event')} of {motions}>"

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns by name, text for kind, source, target.

        Derivatives are dt_mu1, dx_mu1 and so on.
        """
        columns = {name: getattr(self, name) for name in ("trajectory", *EVENT_COLUMNS)}
        for change in CHANGES if self.wrt else ():
            columns |= {
                f"{change}_{name}": getattr(self, change)[:, n] for n, name in enumerate(self.wrt)
            }
        return columns

    @public
    def to_csv(self, path: str | Path) -> None:
        """Write the rows as CSV with a header ("-": to standard output).

        OutputError if it cannot be written.
        """
        columns = self.columns()
        write_csv(
            path, columns, zip(*(column.tolist() for column in columns.values()), strict=True)
        )

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per event; MissingExtraError if pandas is not installed."""
        return imported("pandas").DataFrame(self.columns())

    def to_xarray(self) -> Any:
        """Return a Dataset over `event`, with the statuses over `motion`.

        MissingExtraError without xarray.
        """
        columns: Record = {
            name: (("event",), getattr(self, name)) for name in ("trajectory", *EVENT_COLUMNS)
        }
        if self.wrt:
            columns |= {name: (("event", "wrt"), getattr(self, name)) for name in CHANGES} | {
                "wrt": list(self.wrt)
            }
        return imported("xarray").Dataset(
            columns | {"status": (("motion",), np.array(self.status, dtype=str))}
        )


def write_csv(path: str | Path, header: Iterable[str], rows: Iterable[Iterable[Any]]) -> None:
    """Write `rows` under a `header` as a CSV file ("-": to standard output)."""

    def write(draft: Path) -> None:
        with draft.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            writer.writerows(rows)

    write_whole(path, write)


def select_rows(table: EventTable, rows: Any, status: list[str]) -> EventTable:
    """Return some rows of a table, by numbers or a slice, with the statuses of their trajectories."""
    columns = {
        name: column[rows] for name, column in vars(table).items() if name not in ("status", "wrt")
    }
    return EventTable(status=status, wrt=table.wrt, **columns)


def table_from(
    parts: Sequence[EventRows], status: list[str], wrt: tuple[str, ...] = (), **changes: Any
) -> EventTable:
    """Return blocks of event rows as one table.

    `changes` are its columns dt, dx and regular by `wrt`.
    """
    parts = parts or [event_buffer(0)]
    columns = dict[str, Any]()
    for n, name in enumerate(FLOAT_COLUMNS):
        columns[name] = joined_arrays([part.floats[n] for part in parts])
    for n, name in enumerate(("trajectory", *CODE_ATTRIBUTES)):
        columns[name] = joined_arrays([part.ints[n] for part in parts])
    return EventTable(status=status, wrt=wrt, **columns, **changes)


def rows_of(i: int, events: Sequence[Event]) -> EventRows:
    """Return the events of trajectory number i as rows of doubles and codes."""
    codes = {
        name: {name_of_code: code for code, name_of_code in names.items()}
        for name, names in CODE_NAMES.items()
    }
    rows = event_buffer(len(events))
    for n, event in enumerate(events):
        rows.floats[:, n] = [getattr(event, name) for name in FLOAT_COLUMNS]
        values = [(name, getattr(event, name)) for name in CODE_COLUMNS]
        rows.ints[:, n] = (
            i,
            *(codes[name][value] if name in codes else value for name, value in values),
        )
    return rows


def counted(count: int, noun: str) -> str:
    """Return a count and a noun, singular or plural, as text."""
    return f"{count:,} {noun}{'s' * (count != 1)}"


def statuses(status: Any) -> str:
    """Return how many motions ended with each status, as a short text."""
    names, counts = np.unique(np.asarray(status, dtype=str), return_counts=True)
    return (
        ", ".join(
            f"{count:,} {name}" for name, count in zip(names.tolist(), counts.tolist(), strict=True)
        )
        or "none"
    )


#: Columns of a summary: long name and dimension of each. `symosc.simulation.ensemble.summary_of`
#: computes them.
SUMMARY_COLUMNS = {
    "status": ("why the motion ended", "1"),
    "events": ("number of events", "1"),
    "sticks": ("number of onsets of a stick", "1"),
    "t": ("time of the last state", "time"),
    "x": ("last position", "length"),
    "v": ("last velocity", "length/time"),
    "mode": ("last mode", "1"),
    "word": ("mappings of the last forcing period as a cycle, from right to left", "1"),
    "multiplicity": ("forcing periods after which word and section repeat, 0 if they do not", "1"),
    "stuck": ("share of the time that the mass sticks", "1"),
    "x_min": ("least position", "length"),
    "x_max": ("largest position", "length"),
    "v_min": ("least velocity", "length/time"),
    "v_max": ("largest velocity", "length/time"),
    "section": ("position and velocity at the last whole forcing periods", ""),
}


class Summary(Columns):
    """The summary of many motions, one row each.

    Attributes
    ----------
    status : (n,) array of str
        As in `Trajectory`.
    events, sticks : (n,) int arrays
        Events, and how many of them begin a stick.
    t, x, v : (n,) float arrays
        The last state: at t_end, or at the last event of a motion that ended before.
    mode : (n,) array of str
        The mode of the last state, "Omega1" … "belt2".
    word : (n,) array of str
        Mappings that ended in the last whole forcing period, written like `PeriodicOrbit.word`; ""
        if none did.
    multiplicity : (n,) int array
        Smallest number of forcing periods, 32 at most, after which words and sections repeat, twice
        in a row; 0 if they do not. Sections are the same if they differ by less than 1e-6 of the
        motion's extent plus 8 estimated errors. A motion without a drive that comes to rest has 1.
    stuck : (n,) float array
        Share of time on a belt.
    x_min, x_max, v_min, v_max : (n,) float arrays
        Extremes, those inside flights included.
    section : (n, sections, 2) float array
        x and v where the last forcing periods ended (Omega t = 2 pi n, the start not included), in
        order of time; NaN for those that were not.

    Notes
    -----
    A column that was not asked for is ().

    Examples
    --------
    >>> from symosc import load_scene, simulate_many
    >>> scene = load_scene("fig9-orbit")
    >>> start = (scene.t0, scene.x0, scene.v0)
    >>> found = simulate_many(scene.parameters, start, t_end=20, record="summary", use_numba=False)
    >>> found.word.tolist(), found.multiplicity.tolist(), found.sticks.tolist()
    (['P32'], [1], [0])
    """

    _drawn_by = "summary_figure"
    _made_by = "simulate_many(..., record='summary')"

    def __getattr__(self, name: str) -> Any:
        if name in SUMMARY_COLUMNS:
            return ()
        raise AttributeError(f"Summary has no column {name!r}; it has {', '.join(SUMMARY_COLUMNS)}")

    def __len__(self) -> int:
        return max(map(len, self.columns().values()), default=0)

    @public
    def __getitem__(self, motion: int | slice | Sequence[bool | int]) -> Any:
        """Return the row of one motion as a dictionary, or another summary of some of them."""
        require(WHOLE, SLICE, sequence_of(FLAG, WHOLE), motion=motion)
        columns = self.columns()
        unmasked("motion", motion)
        motion = scalar_of("motion", motion)
        if isinstance(motion, (int, np.integer)) and not isinstance(motion, bool):
            number = _index("motion", int(motion), len(self))
            return {name: column[number] for name, column in columns.items()}
        return Summary(**{name: column[motion] for name, column in columns.items()})

    def __repr__(self) -> str:
        if not len(self.status):
            content = ", ".join(self.columns())
        else:
            content = statuses(self.status)
        return f"<Summary of {counted(len(self), 'motion')}: {content}>"

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns that were asked for, by name."""
        return dict(vars(self))

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per motion; MissingExtraError if pandas is not installed."""
        columns = self.columns()
        section = columns.pop("section", np.zeros((0, 0, 2)))
        count = section.shape[1]
        for n in range(count):
            from_end = n - count  # negative, as an index from the end: -1 is the last whole period
            columns |= {
                f"section_x[{from_end}]": section[:, n, 0],
                f"section_v[{from_end}]": section[:, n, 1],
            }
        pandas = imported("pandas")
        return pandas.DataFrame(columns, index=pandas.RangeIndex(len(self), name="motion"))

    def to_xarray(self) -> Any:
        """Return a Dataset over `motion`, `period` and `component`.

        MissingExtraError if xarray is not installed.
        """
        columns: Record = {name: (("motion",), column) for name, column in self.columns().items()}
        coordinates: Record = {"motion": np.arange(len(self))}
        if "section" in columns:
            columns["section"] = ("motion", "period", "component"), self.section
            coordinates |= {"period": np.arange(-self.section.shape[1], 0), "component": ["x", "v"]}
        return imported("xarray").Dataset(columns, coords=coordinates)
