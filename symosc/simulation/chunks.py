"""A chunk of many motions: followed as far as doubles and pairs of them go, one by one beyond, and then recorded."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from symosc.engine import summary as kept
from symosc.engine.batch import EventRows, state_of
from symosc.engine.start import settles
from symosc.engine.state import END, FULL, REST
from symosc.errors import ParameterError
from symosc.simulation.batch_loop import Loops
from symosc.simulation.event_table import EventTable, rows_of, table_from
from symosc.simulation.ladder import Ladder, Limits, is_doubtful, spliced
from symosc.simulation.problems import Problems
from symosc.simulation.run import MOST_PERIODS, check_reached
from symosc.simulation.simulate import end_status, in_doubles
from symosc.simulation.summary import MODE_TEXTS, USUAL_WORD, Question, columns_of, tally_alone
from symosc.simulation.trajectory import Trajectory
from symosc.simulation.workers import Patrol


class BatchTask(NamedTuple):
    """What all chunks are about."""

    problems: Problems
    loops: Loops
    limits: Limits


class EventsPart(NamedTuple):
    """Events of a chunk, in order of trajectory and time, and the statuses of its trajectories."""

    rows: list[EventRows]
    status: list[str]


def read_record(record: Any, skip: Any, sections: Any, task: BatchTask) -> Callable[[slice, EventRows, Patrol], Any]:
    """Return what does a chunk: `events_part` or `summary_part`."""
    if is_events(record):
        for name, value, usual in (("skip", skip, 0), ("sections", sections, 1)):
            if value is not usual and not (isinstance(value, int) and value == usual):
                raise ParameterError(name, value, 'is for summaries; give record="summary", or names of its columns')
        return partial(events_part, task)
    return partial(summary_part, task, Question(record, skip, sections, task.problems))


def is_events(record: Any) -> bool:
    """Return whether events are to be recorded, and not a summary."""
    return isinstance(record, str) and record == "events"


def events_part(task: BatchTask, rows: slice, room: EventRows, patrol: Patrol) -> EventsPart:
    """Return the events of a chunk."""
    steps = Ladder(task.problems, rows, task.loops, task.limits, room, patrol)
    status, looks = ended(steps, patrol)
    again = steps.climbed | {i: rows_of(i, trajectory.events) for i, trajectory in looks.items()}
    parts = spliced(steps.rows, again) if again else steps.rows
    if rows.start:
        for part in parts:
            part.ints[0] += rows.start
    return EventsPart(parts, status)


def table_of_parts(parts: list[EventsPart]) -> EventTable:
    """Return the events of all chunks."""
    return table_from([rows for part in parts for rows in part.rows], [each for part in parts for each in part.status])


def summary_part(
    task: BatchTask, asked: Question, rows: slice, room: EventRows, patrol: Patrol, longest: int = USUAL_WORD
) -> dict[str, np.ndarray]:
    """Return the columns of a chunk; a motion whose word has no room is followed once more, with more of it."""
    keep = partial(asked.begun, longest)
    steps = Ladder(task.problems, rows, task.loops, task.limits, room, patrol, keep)
    status, looks = ended(steps, patrol)
    modes = steps.batch.states[:, 0].astype(int)
    for i, trajectory in looks.items():
        last = tally_alone(i, trajectory, steps.tally, steps.table, int(steps.batch.sets[i]))
        modes[i] = last.mode
    columns = columns_of(asked, steps.tally, partial(task.loops.settle, steps.tally, steps.batch.sets, steps.table))
    texts = np.array(status, dtype=str)
    columns |= {"status": texts, "mode": MODE_TEXTS[modes]}
    whole = (texts == "t_end") | (texts == "equilibrium")
    t_end, t0 = (column.pairs(rows).hi for column in (task.problems.t_end, task.problems.t0))
    columns["t"] = np.where(whole, t_end, columns["t"])
    counted = columns["t"] - t0 - asked.skip[rows]
    with np.errstate(all="ignore"):
        columns["stuck"] = np.where(counted > 0.0, np.minimum(steps.tally.floats[:, kept.STUCK] / counted, 1.0), np.nan)
    too_long = (steps.tally.ints[:, kept.LAST_LENGTH] > longest) & ("word" in asked.names)
    for i in np.flatnonzero(too_long).tolist():
        row, length = rows.start + i, int(steps.tally.ints[i, kept.LAST_LENGTH])
        again = summary_part(task, asked, slice(row, row + 1), room, patrol, length)
        columns["word"] = columns["word"].astype(np.promote_types(columns["word"].dtype, again["word"].dtype))
        columns["word"][i] = again["word"][0]
    return {name: columns[name] for name in asked.names}


def ended(steps: Ladder, patrol: Patrol) -> tuple[list[str], dict[int, Trajectory]]:
    """Return the statuses of a chunk's motions, and those that were followed one by one, by number."""
    batch, looks = steps.batch, dict[int, Trajectory]()
    codes, counts, periods = batch.codes, batch.counts, batch.states[:, 2]
    status: list[str] = np.where(codes == FULL, "max_events", "t_end").tolist()
    # Motions without a drive may have come to rest.
    for i in np.flatnonzero((codes == REST) | ((codes == END) & (counts == 0))).tolist():
        problem, state = steps.problem(i), state_of(batch.states, i)
        code = REST if codes[i] == END and settles(problem) else int(codes[i])
        status[i] = end_status(code, state.mode, state.v, problem.parameters)
    for i in np.flatnonzero((codes == END) & (periods >= MOST_PERIODS)).tolist():
        check_reached(steps.problem(i), int(periods[i]))
    for i in np.flatnonzero(is_doubtful(codes)).tolist():
        patrol.check()
        looks[i] = in_doubles(steps.problem(i), *steps.limits)
        status[i] = looks[i].status
    return status, looks
