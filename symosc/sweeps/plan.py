"""What a sweep computes, named by a hash of its content: two sweeps of one name give the same bits."""

from __future__ import annotations

import hashlib
import json
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

import symosc
from symosc.aliases import Record
from symosc.errors import ParameterError, meant
from symosc.exact import read_exact, show, whole_number
from symosc.model import PARAMETER_NAMES
from symosc.scenes import Scene
from symosc.sweeps.grid import SWEPT_STARTS, Grid
from symosc.sweeps.motions import RECORDED, Share, kernels_hash

TIMES_FORM = "give a number, or periods of the forcing such as '60T'"
MOST_FORCING_PERIODS = 10**9
#: Points of a section if nobody says how many.
SECTION_POINTS = 32


@dataclass(frozen=True)
class Duration:
    """A time: a number, or whole or fractional periods of the forcing, which are another time for each Omega."""

    value: Fraction
    periods: bool = False

    def __str__(self) -> str:
        return f"{show(self.value)}{'T' * self.periods}"


def read_duration(name: str, given: Any) -> Duration:
    """Return a time from a number, or from text such as ``"60T"``.

    Raises
    ------
    ParameterError
        Unless it is one of both.
    """
    text = re.fullmatch(r"\s*(\S+?)\s*T\s*", given) if isinstance(given, str) else None
    if text is None:
        return Duration(read_exact(name, given))
    periods = read_exact(name, text[1])
    if not 0 <= periods <= MOST_FORCING_PERIODS:
        raise ParameterError(name, given, f"must be from 0 to {MOST_FORCING_PERIODS} periods")
    return Duration(periods, periods=True)


@dataclass(frozen=True, eq=False)
class SweepPlan:
    """A sweep as it is computed.

    Attributes
    ----------
    scene : Scene
        What is not swept.
    grid : Grid
    record : tuple of str
        Columns of `symosc.simulate_many`'s summaries.
    sections : int
        Points of a section, 0 if none is recorded.
    t_end : Duration
        End of each motion; periods count from its start.
    skip : Duration
        How much of each motion is left out from its start on.
    """

    scene: Scene
    grid: Grid
    record: tuple[str, ...]
    sections: int
    t_end: Duration
    skip: Duration

    @property
    def column_names(self) -> tuple[str, ...]:
        """The columns of a chunk: those that are recorded, and always the status."""
        return tuple(dict.fromkeys((*self.record, "status")))

    @property
    def record_names(self) -> tuple[str, ...]:
        """The columns as a user names them, the points of a section with it."""
        return tuple(f"{name}:{self.sections}" if name == "section" else name for name in self.record)

    @cached_property
    def content(self) -> Record:
        """Everything that the numbers depend on, as plain data; of the swept values a hash."""
        swept = [  # in order, which is that of the dimensions
            [name, each.dimension, len(each.values), hashlib.sha256(each.values.tobytes()).hexdigest()]
            for name, each in self.grid.coordinates.items()
        ]
        errors = self.scene.start_error
        return {
            "symosc": symosc.__version__,
            "kernels": kernels_hash(),
            "parameters": self.scene.parameters.as_dict(),
            "start": {name: show(getattr(self.scene, name)) for name in SWEPT_STARTS},
            "start_error": None if errors is None else [show(each) for each in errors],
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

    def share(self, begin: int, end: int) -> Share:
        """Return what computes the cells from `begin` up to `end`."""
        swept = self.grid.columns(begin, end)
        p: dict[str, Any] = {name: swept.get(name, getattr(self.scene.parameters, name)) for name in PARAMETER_NAMES}
        starts = tuple(swept.get(name, getattr(self.scene, name)) for name in SWEPT_STARTS)
        period = 2 * math.pi / np.asarray(p["Omega"], dtype=float)
        t0 = np.asarray(starts[0], dtype=float)
        t_end: Any = t0 + float(self.t_end.value) * period if self.t_end.periods else self.t_end.value
        skip: Any = float(self.skip.value) * period if self.skip.periods else self.skip.value
        return Share(
            end - begin, p, starts, t_end, skip, self.record, self.sections, self.scene.start_error, kernels_hash()
        )


def read_plan(scene: Scene, grid: Grid, record: Any, t_end: Any, skip: Any) -> SweepPlan:
    """Return the plan of a sweep.

    Raises
    ------
    ParameterError
        For an unknown column, a time that is none, or an end before a start.
    """
    columns, sections = read_record(record)
    end = Duration(scene.t_end) if t_end is None else read_duration("t_end", t_end)
    left_out = read_duration("skip", skip)
    plan = SweepPlan(scene, grid, columns, sections, end, left_out)
    _check_times(plan)
    return plan


def read_record(record: Any) -> tuple[tuple[str, ...], int]:
    """Return the names of columns and the number of points of a section, from names such as "word" and "section:64"."""
    names = [record] if isinstance(record, str) else list(record)
    if not names:
        raise ParameterError("record", record, f"give names out of {', '.join(RECORDED)}")
    columns, sections = [], 0
    for name in names:
        column, colon, count = name.partition(":")
        if column not in RECORDED or (colon and column != "section"):
            known = f"is not recorded; what is is {', '.join(RECORDED)}"
            raise ParameterError("record", name, known + meant(column, RECORDED))
        if column in columns:
            raise ParameterError("record", column, "is there twice")
        if column == "section":
            sections = (
                whole_number("section", int(count) if count.isascii() and count.isdigit() else None, 1)
                if colon
                else SECTION_POINTS
            )
        columns.append(column)
    return tuple(columns), sections


def _check_times(plan: SweepPlan) -> None:
    """Raise ParameterError unless every motion ends after its start and after what is left out."""
    grid = plan.grid.coordinates
    t0 = read_exact("t0", float(grid["t0"].values.max())) if "t0" in grid else plan.scene.t0
    if plan.skip.value < 0:
        raise ParameterError("skip", str(plan.skip), "must be >= 0")
    if plan.t_end.periods:
        length = plan.t_end.value
        if length <= 0:
            raise ParameterError("t_end", str(plan.t_end), "must be more than 0 periods")
    elif plan.t_end.value <= t0:
        raise ParameterError("t_end", str(plan.t_end), f"must be later than t0 = {show(t0)}")
    omegas = grid["Omega"].values if "Omega" in grid else np.array([float(plan.scene.parameters.Omega)])
    for omega in (omegas.min(), omegas.max()):
        period = 2 * math.pi / float(omega)
        until = float(plan.t_end.value) * period if plan.t_end.periods else float(plan.t_end.value - t0)
        skipped = float(plan.skip.value) * (period if plan.skip.periods else 1.0)
        if skipped >= until:
            raise ParameterError(
                "skip", str(plan.skip), f"must be shorter than the motion, which ends at t_end = {plan.t_end}"
            )
