"""Summaries of many motions: a row each, whatever the number of their events."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from math import cos, sin
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.display.drawable import Drawable
from symosc.display.frames import imported
from symosc.engine import tally as kept
from symosc.engine.constant_table import ConstantRows
from symosc.engine.state import MOVED, ON_BELT, Covariance, NextEvent, State
from symosc.engine.tally import Tally, rest_tally, tally_step
from symosc.errors import ParameterError
from symosc.exact import whole_number
from symosc.model import MODE_NAMES
from symosc.simulation.columns import NumberColumn, as_given
from symosc.simulation.event_table import counted, statuses
from symosc.simulation.problems import Problems
from symosc.simulation.run import EVENT_KINDS
from symosc.simulation.trajectory import Trajectory

# Periods after which a motion may repeat, at most.
LONGEST_REPEAT = 32
# Two sections are the same if they differ by less than this part of the motion's extent, and this times their errors.
SAME_PART, SAME_ERRORS = 1e-6, 8.0
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

    def __getitem__(self, motion: Any) -> Any:
        """Return the row of one motion as a dictionary, or another summary of some of them."""
        columns = self.columns()
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
EXTREMES = {"x_min", "x_max", "v_min", "v_max"}


def read_names(record: Any) -> tuple[str, ...]:
    """Return the columns that are asked for, in order: all for "summary", or some by name."""
    if record == "events" or isinstance(record, str):
        names = SUMMARY_COLUMNS if record in ("events", "summary") else (record,)
    else:
        try:
            names = tuple(record)
        except TypeError:
            names = (record,)
    for name in names:
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
        self.inside = not EXTREMES.isdisjoint(self.names)
        self.sections = whole_number("sections", sections, 0)
        column = NumberColumn("skip", as_given(skip))
        if len(column) not in (1, len(problems)):
            raise ParameterError("skip", len(column), f"must have 1 or {len(problems)} entries, as the motions")
        self.skip = np.broadcast_to(column.hi, len(problems))
        lasts = problems.t_end.hi - problems.t0.hi
        for row in np.flatnonzero(~((self.skip >= 0.0) & (self.skip < lasts))).tolist():
            raise ParameterError(column.called(row), column.hi[row % len(column)], "must be >= 0 and end before t_end")

    def begun(self, rows: slice, states: np.ndarray, longest: int = USUAL_WORD) -> Tally:
        """Return the tally of some motions at their starts."""
        room = kept.Kept(self.inside, max(2 * LONGEST_REPEAT, self.sections), longest)
        return kept.begun_tally(states, self.skip[rows], room)


def tally_alone(i: int, trajectory: Trajectory, tally: Tally, table: np.ndarray, set_: int) -> State:
    """Count a motion that was followed alone, from the pieces and events of its trajectory; return its last state."""
    K, t0 = ConstantRows(table)[set_], float(trajectory.t_start)
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
    if trajectory.status in ("t_end", "equilibrium"):
        rest_tally(i, last, (float(trajectory.t_end) - t0) - last.t, 0.0, tally, K)
    tally.floats[i, kept.T_LAST] += t0
    return last


def _state(piece: Any) -> State:
    zero = Covariance(0.0, 0.0, 0.0)
    at = piece.mode - ON_BELT if piece.mode > ON_BELT else 0
    clock = piece.elapsed, 0.0, sin(piece.theta), cos(piece.theta)
    return State(piece.mode, at, piece.n, piece.theta, piece.x, piece.v, piece.a, piece.a, zero, *clock)


def _is_at(state: State, event: Any) -> bool:
    near = 1e-9
    return abs(state.x - event.x) <= near * (1.0 + abs(event.x)) and abs(1.0 - cos(state.theta - event.theta)) <= near


def columns_of(tally: Tally, sections: int) -> dict[str, np.ndarray]:
    """Return the columns of a summary that a tally has."""
    floats, ints = tally.floats, tally.ints
    values, errors, words = _in_order(tally)
    extent = np.stack([floats[:, kept.X_HIGH] - floats[:, kept.X_LOW], floats[:, kept.V_HIGH] - floats[:, kept.V_LOW]])
    found = {"events": ints[:, kept.EVENTS_SO_FAR], "sticks": ints[:, kept.STICKS]}
    lengths = np.minimum(ints[:, kept.LAST_LENGTH], tally.labels.shape[2]).tolist()
    labels = tally.labels[:, 1]
    found["word"] = np.array([_text(row[:size]) for row, size in zip(labels, lengths, strict=True)], dtype=str)
    found["multiplicity"] = repeats(values, errors, words, extent.T)
    names = {"x_min": kept.X_MIN, "x_max": kept.X_MAX, "v_min": kept.V_MIN, "v_max": kept.V_MAX}
    names |= {"t": kept.T_LAST, "x": kept.X_LAST, "v": kept.V_LAST}
    found |= {name: np.where(np.isfinite(floats[:, n]), floats[:, n], np.nan) for name, n in names.items()}
    return found | {"section": values[:, values.shape[1] - sections :]}


def _text(labels: np.ndarray) -> str:
    """Return the word of mappings in order of time, of which the first was under way when the period began."""
    return "P" + bytes(48 + np.roll(labels, -1))[::-1].decode() if len(labels) else ""


def _in_order(tally: Tally) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the sections, their errors, and the words before them, in order of time, the last one last."""
    ring = tally.words.shape[1]
    places = (tally.ints[:, kept.SECTIONS, None] - ring + np.arange(ring)) % ring
    sections = np.take_along_axis(tally.sections, places[:, :, None], axis=1)
    return sections[:, :, :2], sections[:, :, 2:], np.take_along_axis(tally.words, places, axis=1)


def repeats(values: np.ndarray, errors: np.ndarray, words: np.ndarray, extent: np.ndarray) -> np.ndarray:
    """Return after how many periods words and sections repeat, twice in a row; 0 if they do not."""
    found = np.zeros(len(words), np.int64)
    left = np.arange(len(words))
    for m in range(1, LONGEST_REPEAT + 1):
        last, before = slice(-m, None), slice(-2 * m, -m)
        same = (words[left, last] == words[left, before]).all(axis=1) & (words[left, before] >= 0).all(axis=1)
        some = left[same]
        gap = abs(values[some, last] - values[some, before])
        allowed = SAME_PART * extent[some, None] + SAME_ERRORS * (errors[some, last] + errors[some, before])
        some = some[(gap <= allowed).all(axis=(1, 2))]
        found[some] = m
        left = left[found[left] == 0]
    return found


def summary_from(parts: Sequence[dict[str, np.ndarray]]) -> Summary:
    """Return the summary of all chunks."""
    return Summary(**{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


#: Modes by code.
MODE_TEXTS = np.array(["", *(MODE_NAMES[code] for code in sorted(MODE_NAMES))])
