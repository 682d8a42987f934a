"""The plan of a sweep: a motion for each cell of a grid or row of a table, computed in chunks.

A plan is named by a hash of its content: two sweeps of one name give the same bits.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, NamedTuple

import numpy as np

import symosc
from symosc.base.aliases import Record, SceneName
from symosc.base.errors import ParameterError, SweepError, meant
from symosc.base.exact import LARGEST, read_exact, scalar_of, show, unmasked, whole_number
from symosc.base.quantities import forcing_periods, read_number
from symosc.model import PARAMETER_NAMES, Model, Parameters
from symosc.scenes import (
    STARTS,
    Scene,
    check_periods,
    from_rest,
    not_reduced_error,
    passed,
    scene_of,
)
from symosc.simulation.ensemble import NO_SECTION, simulate_many
from symosc.simulation.problems import OPTIONAL_NAMES, named
from symosc.simulation.tables import SUMMARY_COLUMNS

MOST_AXES = 3
#: The dimension of a table's rows, and of several starts.
SET_AXIS = "set"
START_AXIS = "start"
MOST_SWEPT = 10**9
MOST_FORCING_PERIODS = 10**9
AXIS_FORM = "give numbers, or LO:HI:N such as '1:6:500'"
OVER_FORM = (
    "give names with their values, such as {'Omega': '1:6:500'}, or a table: a DataFrame or a list "
    "of dicts"
)
#: Points of a section if nobody says how many.
SECTION_POINTS = 32
#: What decides the numbers of a motion: changed sources make another plan.
DECISIVE = ("kernels", "engine", "simulation", "base/exact.py", "friction.py", "model.py")


class Coordinate(NamedTuple):
    """The values of one parameter or start value along a dimension, and their text "LO:HI:N" if
    given so.
    """

    dimension: str
    values: np.ndarray
    text: str = ""


Coordinates = dict[str, Coordinate]


@dataclass(frozen=True)
class Duration:
    """A length of time, in units of time or in periods of the drive, which depend on the Omega of
    each motion.
    """

    value: Fraction
    periods: bool = False

    def __str__(self) -> str:
        return f"{show(self.value)}{'T' * self.periods}"

    def times(self, period: Any) -> Any:
        """Return the duration in units of time for each of the given periods of the drive."""
        if self.periods:
            return float(self.value) * period
        return self.value


@dataclass(frozen=True, eq=False)
class SweepPlan:
    """A sweep with all settings that decide its numbers.

    A cell is one motion of the sweep, at one point of the grid or in one row of the table. Cells
    are numbered in C order of the dimensions.
    """

    # Swept values are doubles, each read as the decimal that it prints as: a coordinate of the
    # result says exactly what was computed. What is not swept stays exact. Periods of `t_end` count
    # from the start of each motion; `skip` is left out of it from its start on.

    scene: Scene  # what is not swept
    coordinates: Coordinates
    record: tuple[str, ...]  # columns of summaries
    sections: int  # points of a section, 0 if none is recorded
    t_end: Duration
    skip: Duration

    @cached_property
    def sizes(self) -> dict[str, int]:
        """The names of the sweep's dimensions and their lengths."""
        return {
            coordinate.dimension: len(coordinate.values) for coordinate in self.coordinates.values()
        }

    def __len__(self) -> int:
        return math.prod(self.sizes.values())

    def cells(self, begin: int, end: int) -> dict[str, np.ndarray]:
        """Return the swept values of the cells from `begin` up to `end`."""
        indices = np.unravel_index(np.arange(begin, end), tuple(self.sizes.values()))
        index_along = dict(zip(self.sizes, indices, strict=True))
        return {
            name: coordinate.values[index_along[coordinate.dimension]]
            for name, coordinate in self.coordinates.items()
        }

    @property
    def column_names(self) -> tuple[str, ...]:
        """The names of the columns that are computed for each cell: those to record, and always the
        status.
        """
        return tuple(dict.fromkeys((*self.record, "status")))

    @cached_property
    def content(self) -> Record:
        """Everything that decides the numbers of the sweep, as plain data.

        Swept values are replaced by a hash.
        """
        swept = [  # in order, which is that of the dimensions
            [
                name,
                coordinate.dimension,
                len(coordinate.values),
                hashlib.sha256(coordinate.values.tobytes()).hexdigest(),
            ]
            for name, coordinate in self.coordinates.items()
        ]
        errors = self.scene.start_error
        return {
            "symosc": symosc.__version__,
            "kernels": kernels_hash(),
            "parameters": self.scene.parameters.as_dict(),
            "start": {name: show(getattr(self.scene, name)) for name in STARTS},
            "start_error": None if errors is None else [show(error) for error in errors],
            "swept": swept,
            "record": list(self.record),
            "sections": self.sections,
            "t_end": str(self.t_end),
            "skip": str(self.skip),
        }

    @cached_property
    def key(self) -> str:
        """The plan's name: a hash of its content."""
        return hashlib.sha256(json.dumps(self.content, sort_keys=True).encode()).hexdigest()

    def arguments(self, begin: int, end: int) -> Record:
        """Return the arguments of `simulate_many` that compute the cells from `begin` up to `end`."""
        swept = self.cells(begin, end)
        p: Record = {
            name: swept.get(name, value)
            for name, value in self.scene.parameters.given_numbers().items()
        }
        p |= {name: swept[name] for name in OPTIONAL_NAMES if name in swept}
        starts = {name: swept.get(name, getattr(self.scene, name)) for name in STARTS}
        period = 2 * math.pi / np.asarray(p["Omega"], dtype=float)
        t_end = self.t_end.times(period)
        if self.t_end.periods:  # they count from the start of each motion
            t_end = np.asarray(starts["t0"], dtype=float) + t_end
        return {
            "parameters": p,
            "starts": starts,
            "t_end": t_end,
            "record": self.column_names,
            "skip": self.skip.times(period),
            "sections": self.sections,
            "start_error": self.scene.start_error,
        }


def compute(
    arguments: Record, kernels: str, workers: int | None = 1
) -> tuple[dict[str, np.ndarray], float]:
    """Compute a chunk of cells by `simulate_many` with `arguments`.

    Return its columns and the processor seconds.

    `kernels` is the caller's `kernels_hash`; SweepError if it differs here, in a worker with
    another symosc.
    """
    if kernels != kernels_hash():
        raise SweepError("a worker has another version of symosc than this program")
    wall = perf_counter()
    processor = process_time()
    columns: dict[str, np.ndarray] = simulate_many(**arguments, workers=workers).columns()
    threads = workers or os.cpu_count() or 1
    # Two estimates: other programs make the first too long, other threads of this one the second.
    return columns, min((perf_counter() - wall) * threads, process_time() - processor)


@cache
def kernels_hash() -> str:
    """Return a hash of the source files that decide the numbers of a motion."""
    root = Path(symosc.__file__).parent
    digest = hashlib.sha256()
    for path in map(root.joinpath, DECISIVE):
        for source in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


# -- reading the arguments of a sweep --------------------------------------------------------------


def read_plan(
    scene: Scene | Model | SceneName,
    over: Any,
    record: Any,
    t_end: Any,
    skip: Any,
    starts: Any = None,
) -> SweepPlan:
    """Check the arguments of `sweep` and return them as a plan."""
    problem = scene_of(scene, "scene", any_law=True)
    if isinstance(problem, Model):
        if t_end is None:
            raise ParameterError(
                "t_end", None, f"t_end is required when you pass {passed(problem)}"
            )
        # A scene needs an end. The plan's own `t_end`, read below, takes its place, so that the
        # latest possible one refuses no start.
        problem = from_rest(problem, LARGEST)
    elif problem.original is not None:
        raise not_reduced_error(problem)
    if starts is None:
        rows = None
    else:
        rows = _start_rows(starts)
    if rows is not None and rows.ndim == 1:  # a single start makes no dimension
        problem = problem.started(dict(zip(STARTS, rows, strict=True)))
        rows = None
    coordinates = read_coordinates(problem, over, rows)
    columns, sections = _read_record(record)
    if t_end is None:
        end = Duration(problem.t_end)
    else:
        end = read_duration("t_end", t_end)
    left_out = read_duration("skip", skip)
    for name, duration in (("t_end", end), ("skip", left_out)):
        if duration.periods:
            check_periods(name, str(duration), problem.parameters)
    if sections and not problem.parameters.has_periods:
        raise ParameterError("record", "section", NO_SECTION)
    plan = SweepPlan(problem, coordinates, columns, sections, end, left_out)
    _check_times(plan)
    return plan


def read_coordinates(scene: Scene, over: Any, starts: np.ndarray | None = None) -> Coordinates:
    """Return the swept values by name, from axes or a table `over`.

    `starts`, rows t0, x0, v0, add a dimension.
    """
    known = swept_names(scene.parameters)
    table = _table_columns(over, known)
    if table is None:
        coordinates = _axes(over, known)
    else:
        coordinates = {name: Coordinate(SET_AXIS, values) for name, values in table.items()}
    if starts is not None:
        if twice := [name for name in STARTS if name in coordinates]:
            raise ParameterError(
                "starts", twice[0], "must be either swept or one of the starts, not both"
            )
        columns = zip(STARTS, starts.T, strict=True)
        coordinates |= {
            name: Coordinate(START_AXIS, _numbers(name, values)) for name, values in columns
        }
    # By dimension: the columns of a table, or of starts, share theirs.
    sizes = {coordinate.dimension: len(coordinate.values) for coordinate in coordinates.values()}
    count = math.prod(sizes.values())
    if count > MOST_SWEPT:
        raise ParameterError("over", f"{count} motions", f"must be at most {MOST_SWEPT}")
    _check_values(scene, coordinates)
    return coordinates


def swept_names(p: Model) -> tuple[str, ...]:
    """Return the names of the numbers that may be swept."""
    if isinstance(p, Parameters):
        return (*PARAMETER_NAMES, *OPTIONAL_NAMES, *STARTS)
    return (*p.numbers(), *STARTS)


def _axes(over: Any, known: tuple[str, ...]) -> Coordinates:
    """Check the swept axes, with names out of those that are `known`, and return them by name."""
    if not isinstance(over, Mapping):
        raise ParameterError("over", over, OVER_FORM)
    if not 1 <= len(over) <= MOST_AXES:
        raise ParameterError("over", list(over), f"must have one to {MOST_AXES} axes")
    return {
        _known_name(name, known): Coordinate(
            name, read_axis(name, values), values if isinstance(values, str) else ""
        )
        for name, values in over.items()
    }


def _known_name(name: Any, known: tuple[str, ...]) -> str:
    """Return the name of a swept number; ParameterError if it is not one of those `known`."""
    if name not in known:
        allowed = f"unknown number; choose from {', '.join(known)}"
        raise ParameterError("over", name, allowed + meant(name, known))
    return str(name)


def read_axis(name: str, values: Any) -> np.ndarray:
    """Return the values of an axis, all different: those that are given, or N evenly spaced ones of
    "LO:HI:N".
    """
    if isinstance(values, str):
        numbers = _evenly_spaced(name, values)
    else:
        numbers = _numbers(name, values)
    if not len(numbers):
        raise ParameterError(name, values, f"must have one or more values; {AXIS_FORM}")
    ordered = np.sort(numbers)
    repeated = ordered[1:][ordered[1:] == ordered[:-1]]
    if len(repeated):
        raise ParameterError(name, float(repeated[0]), "must be on its axis only once")
    return numbers


def _read_whole(name: str, text: str, least: int) -> int:
    """Return the whole number that a text states.

    ParameterError, which calls it `name`, if it is less than `least`.
    """
    text = text.strip()
    return whole_number(name, int(text) if text.isascii() and text.isdigit() else text, least)


def _evenly_spaced(name: str, text: str) -> np.ndarray:
    """Return the N evenly spaced numbers of "LO:HI:N"."""
    parts = text.split(":")
    if len(parts) != 3:
        raise ParameterError(name, text, AXIS_FORM)
    low_text, high_text, count_text = parts
    low, _ = read_number(name, low_text)
    high, _ = read_number(name, high_text)
    count = _read_whole(f"the number of values of {name}", count_text, 1)
    if count == 1 and low == high:
        return np.array([float(low)])
    if count == 1:
        allowed = "must have 2 or more values to go from a lower to a higher one"
        raise ParameterError(name, text, allowed)
    if count > MOST_SWEPT:
        raise ParameterError(name, text, f"must have at most {MOST_SWEPT} values")
    if low >= high:
        raise ParameterError(name, text, "must go from a lower to a higher value")
    # In fractions, so that 1:6:51 gives 1.1 and not 1.1000000000000001.
    return np.array([float(low + Fraction(i, count - 1) * (high - low)) for i in range(count)])


def _numbers(name: str, values: Any) -> np.ndarray:
    """Return a one-dimensional row of numbers as an array of doubles."""
    values = scalar_of(name, values)
    unmasked(name, values)
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        raise ParameterError(name, values, AXIS_FORM)
    if isinstance(values, np.ndarray):
        array = values
    else:
        array = np.asarray(list(values), dtype=object)
    if array.ndim != 1:
        raise ParameterError(
            name, values, f"must be one row of numbers; it has shape {array.shape}"
        )
    if array.dtype.kind not in "iuf":
        numbers = np.array([float(read_number(name, value)[0]) for value in array], dtype=float)
        return numbers + 0.0  # turns -0.0 into 0.0
    # The extremes are read to check them, and with them all others; nan, if any, is both.
    for value in (array.min(), array.max()) if len(array) else ():
        read_number(name, value)
    return array.astype(float) + 0.0


def _table_columns(over: Any, known: tuple[str, ...]) -> dict[str, np.ndarray] | None:
    """Return the columns of a table, with names out of those that are `known`, or None if `over` is
    no table.
    """
    if hasattr(over, "columns") and hasattr(over, "to_numpy"):
        rows: dict[Any, Any] = {name: over[name].to_numpy() for name in over.columns}
    elif isinstance(over, (list, tuple)) and over and all(isinstance(row, Mapping) for row in over):
        if any(row.keys() != over[0].keys() for row in over):
            raise ParameterError("over", "a table", "must have the same names in all rows")
        rows = {name: [row[name] for row in over] for name in over[0]}
    else:
        return None
    columns = {_known_name(name, known): _numbers(name, values) for name, values in rows.items()}
    if not columns or not len(next(iter(columns.values()))):
        raise ParameterError("over", "a table", "must have a column and a row")
    return columns


def _start_rows(starts: Any) -> np.ndarray:
    """Return starts, given as rows or as columns by name, as an array (n, 3) of rows t0, x0, v0, or
    (3,) if single.
    """
    columns = named("starts", starts, STARTS)
    if isinstance(columns, Mapping):
        arrays = [
            np.asarray(unmasked(name, column), dtype=object) for name, column in columns.items()
        ]
        try:
            rows = np.stack(np.broadcast_arrays(*arrays), axis=-1)  # a column of length 1 repeats
        except ValueError:
            lengths = [np.shape(column) for column in columns.values()]
            allowed = "the columns must have the same length, or length 1"
            raise ParameterError("starts", lengths, allowed) from None
        if rows.size == 3:
            return rows.ravel()
        return rows
    try:
        rows = np.asarray(
            unmasked("starts", starts), dtype=None if hasattr(starts, "dtype") else object
        )
    except ValueError:
        rows = np.zeros(0)
    if rows.ndim not in (1, 2) or rows.shape[-1] != 3 or not len(rows):
        raise ParameterError("starts", starts, "must have shape (n, 3), rows of t0, x0, v0")
    return rows


def _check_values(scene: Scene, coordinates: Coordinates) -> None:
    """Check that the model accepts the extreme swept values: then it accepts all values between
    them.

    Two numbers of which one bounds the other (v1 < v2, mu1 <= mu_s1) are checked last and together:
    in a table row by row, on axes with the largest of the lower one and the least of the other.
    """
    model: Model = scene.parameters
    swept = {
        name: coordinate.values for name, coordinate in coordinates.items() if name not in STARTS
    }
    if isinstance(model, Parameters) and not swept.keys().isdisjoint(OPTIONAL_NAMES):
        model = model.oscillator
    bounded = [(f"mu{n}", f"mu_s{n}") for n in model.law.boundaries] + [("v1", "v2")]
    for name, values in swept.items():
        if not any(name in pair for pair in bounded):
            for value in (values.min(), values.max()):
                model.replace(**{name: float(value)})
    for lower, upper in bounded:
        both = lower in swept and upper in swept
        if both and coordinates[lower].dimension == SET_AXIS:
            closest = int(np.argmin(swept[upper] - swept[lower]))
            tried = [{name: swept[name][closest] for name in (lower, upper)}]
        else:
            extremes = {
                name: (swept[name].min(), swept[name].max())
                for name in (lower, upper)
                if name in swept
            }
            tried = [{name: ends[name == lower] for name, ends in extremes.items()}]
            tried.append({name: ends[name == upper] for name, ends in extremes.items()})
        for changes in tried:
            model.replace(**{name: float(value) for name, value in changes.items()})


def read_duration(name: str, duration: Any) -> Duration:
    """Return a `Duration` from a number, or from text such as "60T" for 60 periods of the drive."""
    periods = forcing_periods(name, duration)
    if periods is None:
        number, _ = read_number(name, duration)
        return Duration(number)
    if not 0 <= periods <= MOST_FORCING_PERIODS:
        raise ParameterError(name, duration, f"must be from 0 to {MOST_FORCING_PERIODS} periods")
    return Duration(periods, periods=True)


def _read_record(record: Any) -> tuple[tuple[str, ...], int]:
    """Return the names of the summary columns in `record`, and the number of points of a Poincaré
    section.

    A column "section:64" asks for a section with 64 points; without a section the number is 0.
    """
    columns = list[str]()
    sections = 0
    for name in [record] if isinstance(record, str) else record:
        column, colon, count = name.partition(":")
        if column not in SUMMARY_COLUMNS or (colon and column != "section"):
            known = f"unknown column; choose from {', '.join(SUMMARY_COLUMNS)}"
            raise ParameterError("record", name, known + meant(column, tuple(SUMMARY_COLUMNS)))
        if column in columns:
            raise ParameterError("record", column, "must be recorded only once")
        if column == "section":
            if colon:
                sections = _read_whole("section", count, 1)
            else:
                sections = SECTION_POINTS
        columns.append(column)
    if not columns:
        raise ParameterError("record", record, f"give names out of {', '.join(SUMMARY_COLUMNS)}")
    return tuple(columns), sections


def _check_times(plan: SweepPlan) -> None:
    """Raise ParameterError unless every motion ends after its start and after the skipped time."""
    swept = {name: coordinate.values for name, coordinate in plan.coordinates.items()}
    if "t0" in swept:
        t0 = read_exact("t0", float(swept["t0"].max()))
    else:
        t0 = plan.scene.t0
    if plan.skip.value < 0:
        raise ParameterError("skip", str(plan.skip), "must be >= 0")
    if plan.t_end.periods and plan.t_end.value <= 0:
        raise ParameterError("t_end", str(plan.t_end), "must be more than 0 periods")
    if not plan.t_end.periods and plan.t_end.value <= t0:
        raise ParameterError("t_end", str(plan.t_end), f"must be later than t0 = {show(t0)}")
    omegas = swept.get("Omega", np.array([float(plan.scene.parameters.Omega)]))
    # Both sides are linear in the period, so its two ends suffice. A number of periods counts from
    # t0, a time does not.
    for period in (2 * math.pi / float(omega) for omega in (omegas.min(), omegas.max())):
        length = plan.t_end.times(period) - (0 if plan.t_end.periods else t0)
        if float(plan.skip.times(period)) >= float(length):
            ends = f"must be shorter than the motion, which ends at t_end = {plan.t_end}"
            raise ParameterError("skip", str(plan.skip), ends)
