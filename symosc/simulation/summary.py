"""Summaries of many motions: a row each, whatever the number of their events."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from math import cos, sin
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.arguments import public
from symosc.display.drawable import Drawable
from symosc.display.frames import imported
from symosc.engine import summary as kept
from symosc.engine.constant_table import ConstantRows
from symosc.engine.state import MOVED, ON_BELT, REST, RUNNING, Covariance, NextEvent, State
from symosc.engine.summary import LEAST_RING, LONGEST_REPEAT, Kept, Tally, leave_tally, tally_step
from symosc.errors import ParameterError
from symosc.exact import unmasked, whole_number
from symosc.model import MODE_NAMES
from symosc.simulation.columns import NumberColumn, as_given
from symosc.simulation.event_table import counted, statuses
from symosc.simulation.problems import Problems
from symosc.simulation.run import EVENT_KINDS
from symosc.simulation.trajectory import Trajectory

# Mappings of a period for which there is room at first.
USUAL_WORD = 48


# What stands for a column that was not asked for.
MISSING: Any = ()


@dataclass(frozen=True, eq=False, repr=False)
class Summary(Drawable):
    """What became of many motions, one row each.

    Attributes
    ----------
    status : (n,) array of str
        As in `Trajectory`.
    events, sticks : (n,) int arrays
        Events, and how many of them begin a stick.
    t, x, v : (n,) float arrays
        The last state: at t_end, or at the last event of a motion that ended before.
    mode : (n,) array of str
        Its mode, "Omega1" … "belt2".
    word : (n,) array of str
        Mappings that ended in the last whole forcing period, written like `PeriodicOrbit.word`; "" if none did. The one
        that was under way when the period began counts as its last: on an orbit of one period it is so at its end too.
    multiplicity : (n,) int array
        Smallest number of forcing periods, 32 at most, after which words and sections repeat, twice in a row; 0 if they
        do not. Sections are the same if they differ by less than 1e-6 of the motion's extent plus 8 estimated errors.
    stuck : (n,) float array
        Share of time on a belt.
    x_min, x_max, v_min, v_max : (n,) float arrays
        Extremes, those inside flights included.
    section : (n, sections, 2) float array
        x and v where the last forcing periods ended (Omega t = 2 pi n, the start not included), in order of time; NaN
        for those that were not.

    Examples
    --------
    >>> from symosc import load_scene, simulate_many
    >>> scene = load_scene("fig9-orbit")
    >>> start = (scene.t0, scene.x0, scene.v0)
    >>> found = simulate_many(scene.parameters, start, t_end=20, record="summary", use_numba=False)
    >>> found.word.tolist(), found.multiplicity.tolist(), found.sticks.tolist()
    (['P32'], [1], [0])
    """

    status: np.ndarray = MISSING
    events: np.ndarray = MISSING
    sticks: np.ndarray = MISSING
    t: np.ndarray = MISSING
    x: np.ndarray = MISSING
    v: np.ndarray = MISSING
    mode: np.ndarray = MISSING
    word: np.ndarray = MISSING
    multiplicity: np.ndarray = MISSING
    stuck: np.ndarray = MISSING
    x_min: np.ndarray = MISSING
    x_max: np.ndarray = MISSING
    v_min: np.ndarray = MISSING
    v_max: np.ndarray = MISSING
    section: np.ndarray = MISSING

    def __len__(self) -> int:
        return max(map(len, self.columns().values()), default=0)

    @public
    def __getitem__(self, motion: int | slice | Sequence[bool | int]) -> Any:
        """Return the row of one motion as a dictionary, or another summary of some of them."""
        columns = self.columns()
        unmasked("motion", motion)
        if isinstance(motion, (int, np.integer)) and not isinstance(motion, bool):
            return {name: column[motion] for name, column in columns.items()}
        return Summary(**{name: column[motion] for name, column in columns.items()})

    def __eq__(self, other: object) -> bool:
        """Whether both have the same rows."""
        if not isinstance(other, Summary):
            return NotImplemented
        mine, others = self.columns(), other.columns()
        return mine.keys() == others.keys() and all(
            np.array_equal(column, others[name], equal_nan=column.dtype.kind == "f") for name, column in mine.items()
        )

    __hash__ = None  # type: ignore[assignment]  # arrays have none

    def __repr__(self) -> str:
        what = ", ".join(self.columns()) if not len(self.status) else statuses(self.status)
        return f"<Summary of {counted(len(self), 'motion')}: {what}>"

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns by name."""
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: column for name, column in columns.items() if isinstance(column, np.ndarray)}

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per motion; MissingExtraError if pandas is not installed."""
        columns = self.columns()
        section = columns.pop("section", np.zeros((0, 0, 2)))
        for n in range(section.shape[1]):
            place = n - section.shape[1]
            columns |= {f"section_x[{place}]": section[:, n, 0], f"section_v[{place}]": section[:, n, 1]}
        pandas = imported("pandas")
        return pandas.DataFrame(columns, index=pandas.RangeIndex(len(self), name="motion"))

    def to_xarray(self) -> Any:
        """Return a Dataset over `motion`, `section` and `component`; MissingExtraError if xarray is not installed."""
        columns: Record = {name: (("motion",), column) for name, column in self.columns().items()}
        places: Record = {"motion": np.arange(len(self))}
        if "section" in columns:
            columns["section"] = ("motion", "period", "component"), self.section
            places |= {"period": np.arange(-self.section.shape[1], 0), "component": ["x", "v"]}
        return imported("xarray").Dataset(columns, coords=places)


#: Columns of a summary, and those that have to be looked for inside flights.
SUMMARY_COLUMNS = tuple(field.name for field in fields(Summary))
EXTREMES = {"x_min": kept.X_MIN, "x_max": kept.X_MAX, "v_min": kept.V_MIN, "v_max": kept.V_MAX}
#: Sections that are kept of a motion, 64 bytes each.
MOST_SECTIONS = 100_000
#: Where a tally has them, and the last state.
KEPT_COLUMNS = EXTREMES | {"t": kept.T_LAST, "x": kept.X_LAST, "v": kept.V_LAST}


def read_names(record: Any) -> tuple[str, ...]:
    """Return the columns that are asked for, in order: all for "summary", or some by name."""
    if isinstance(record, str):
        names = SUMMARY_COLUMNS if record in ("events", "summary") else (record,)
    else:
        names = tuple(record)
    for name in names or ("",):
        if name not in SUMMARY_COLUMNS:
            allowed = f'must be "events", "summary", or some of {", ".join(SUMMARY_COLUMNS)}'
            raise ParameterError("record", name, allowed)
    return tuple(name for name in SUMMARY_COLUMNS if name in names)


class Question:
    """What is asked of a summary: its columns, the time that is left out, and the sections that are kept.

    Parameters
    ----------
    record : "events", "summary" or names of columns
    skip : number or (n,) array
        Time from the start.
    sections : int
    problems : Problems
    """

    def __init__(self, record: Any, skip: Any, sections: Any, problems: Problems) -> None:
        self.names = read_names(record)
        self.sections = whole_number("sections", sections, 0, MOST_SECTIONS)
        column = NumberColumn("skip", as_given("skip", skip))
        if len(column) not in (1, len(problems)):
            raise ParameterError("skip", len(column), f"must have 1 or {len(problems)} entries, as the motions")
        self.skip = np.broadcast_to(column.hi, len(problems))
        lasts = problems.t_end.hi - problems.t0.hi
        for row in np.flatnonzero(~((self.skip >= 0.0) & (self.skip < lasts))).tolist():
            raise ParameterError(column.called(row), column.hi[row % len(column)], "must be >= 0 and end before t_end")

    def asks(self, *names: str) -> bool:
        """Return whether one of some columns is asked for."""
        return not set(names).isdisjoint(self.names)

    def begun(self, longest: int, motions: Any, states: np.ndarray) -> Tally:
        """Return the tally of some motions (a slice, or numbers) at their starts: it keeps what is asked for."""
        repeats, extremes = self.asks("multiplicity"), self.asks(*EXTREMES)
        ring = 2 * LONGEST_REPEAT if repeats else LEAST_RING if self.asks("word", "section") else 0
        ring = max(ring, self.sections) if self.asks("section") else ring
        words = longest if self.asks("word") else 0
        asked = Kept(self.asks("stuck"), repeats or extremes, extremes, ring, words)
        return kept.begun_tally(states, self.skip[motions], asked)


def tally_alone(i: int, trajectory: Trajectory, tally: Tally, table: np.ndarray, set_: int) -> State:
    """Count a motion that was followed alone, from the pieces and events of its trajectory; return its last state."""
    K, t0 = ConstantRows(table)[set_]._replace(Om_gain=0.0), float(trajectory.t_start)  # pieces have true times
    states = [_state(piece) for piece in trajectory._pieces]
    codes = {name: code for code, name in EVENT_KINDS.items()}
    events, number, last = trajectory.events, 0, states[0]
    for before, after in pairwise(states):
        if number == len(events) and trajectory.status not in ("t_end", "equilibrium"):
            break
        found = NextEvent(MOVED, 0, True, 0.0, after)
        if number < len(events) and _is_at(after, events[number]):
            event = events[number]
            found = NextEvent(codes[event.kind], event.boundary, True, event.t_error, after)
            number += 1
        tally_step(i, before, found, 0.0, tally, K)
        last = after
    code = REST if trajectory.status in ("t_end", "equilibrium") else RUNNING
    leave_tally(i, last, code, (float(trajectory.t_end) - t0) - last.t, 0.0, tally, K)
    tally.floats[i, kept.T_LAST] += t0
    return last


def _state(piece: Any) -> State:
    zero = Covariance(0.0, 0.0, 0.0)
    at = piece.mode - ON_BELT if piece.mode > ON_BELT else 0
    clock = piece.elapsed, 0.0, sin(piece.theta), cos(piece.theta), 0.0
    return State(piece.mode, at, piece.n, piece.theta, piece.x, piece.v, piece.a, piece.a, zero, *clock)


def _is_at(state: State, event: Any) -> bool:
    near = 1e-9
    return abs(state.x - event.x) <= near * (1.0 + abs(event.x)) and abs(1.0 - cos(state.theta - event.theta)) <= near


def columns_of(asked: Question, tally: Tally, settle: Callable[[np.ndarray, np.ndarray], None]) -> Record:
    """Return the columns of a summary that a tally has, of those that are asked for.

    Parameters
    ----------
    asked : Question
    tally : Tally
    settle : callable
        Fills sections and multiplicities (`symosc.engine.summary.settle`).
    """
    found: Record = {"events": tally.ints[:, kept.EVENTS_SO_FAR], "sticks": tally.ints[:, kept.STICKS]}
    for name, n in KEPT_COLUMNS.items():
        values = tally.floats[:, n]
        found[name] = np.where(np.isfinite(values), values, np.nan) if name in EXTREMES else values
    if asked.asks("word"):
        found["word"] = words_of(tally)
    if asked.asks("multiplicity", "section"):
        count, sections = len(tally.floats), asked.sections if asked.asks("section") else 0
        found["section"] = np.full((count, sections, 2), np.nan)
        found["multiplicity"] = np.zeros(count if asked.asks("multiplicity") else 0, np.int64)
        settle(found["section"], found["multiplicity"])
    return found


def words_of(tally: Tally) -> np.ndarray:
    """Return the last words as text; most motions have one of a few."""
    width = tally.labels.shape[2]
    there = np.arange(width) < tally.ints[:, kept.LAST_LENGTH, None]
    rows = np.where(there, tally.labels[:, 1], np.uint8(0)).view(f"S{width}")[:, 0]
    words, numbers = np.unique(rows, return_inverse=True)
    return np.array([_text(labels) for labels in words.tolist()], dtype=str)[numbers]


def _text(labels: bytes) -> str:
    """Return the word of mappings in order of time, of which the first was under way when the period began."""
    return "P" + bytes(48 + label for label in (*labels[1:], *labels[:1]))[::-1].decode() if labels else ""


def summary_from(parts: Sequence[dict[str, np.ndarray]]) -> Summary:
    """Return the summary of all chunks."""
    return Summary(**{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


#: Modes by code.
MODE_TEXTS = np.array(["", *(MODE_NAMES[code] for code in sorted(MODE_NAMES))])
