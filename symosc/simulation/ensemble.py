"""Many trajectories at once: columns in, columns of events or summaries out, on all cores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

from symosc.aliases import DataFrame, NumberLike, Progress, StartError
from symosc.arguments import public
from symosc.display.progress import reporting
from symosc.exact import read_start_error, whole_number
from symosc.model import Parameters
from symosc.simulation.batch_loop import ROOMS, chosen_loops
from symosc.simulation.chunks import BatchTask, is_events, read_record, table_of_parts
from symosc.simulation.event_table import EventTable
from symosc.simulation.ladder import Limits
from symosc.simulation.problems import Problems
from symosc.simulation.simulate import MOST_EVENTS, read_accuracy
from symosc.simulation.summary import Summary, summary_from
from symosc.simulation.workers import MOST_WORKERS, in_chunks, read_workers

__all__ = ["EventTable", "Summary", "simulate_many"]


@public
def simulate_many(
    parameters: Parameters | Sequence[Parameters] | Mapping[str, ArrayLike],
    starts: ArrayLike | Mapping[str, ArrayLike] | DataFrame,
    t_end: NumberLike | ArrayLike,
    *,
    max_events: int | None = None,
    accuracy: NumberLike | None = None,
    start_error: StartError | None = None,
    use_numba: bool | None = None,
    record: str | Sequence[str] = "events",
    skip: NumberLike | ArrayLike = 0,
    sections: int = 1,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Any:
    """Follow many motions in double precision, on all cores; compiled when numba is installed (extra `fast`).

    Parameters
    ----------
    parameters : Parameters, sequence of n Parameters, or mapping of all their names to a number or an (n,) array
    starts : (n, 3) or (3,) array_like, rows of t0, x0, v0; or mapping of these names like `parameters`
    t_end : number or (n,) array
    max_events, accuracy, start_error : optional
        As in `simulate`, for all motions.
    use_numba : bool, optional
        None: if it is installed. Without it all is slower; the last digits of summaries may be others.
    record : str or sequence of str
        "events": all of them, an `EventTable`. "summary": a row per motion, a `Summary`; or names of its columns.
    skip, sections : optional
        For summaries: the time from t0 on, in the unit of t_end, that is left out as a transient (one for all motions,
        or one for each), and the number of sections that are kept.
    workers : int, optional
        Threads; None: one for each core. The bytes of the result are the same for any number.
    progress : bool or callable, optional
        True: a bar on a terminal. Or what is called with the number of motions done, and of all.

    Returns
    -------
    EventTable or Summary
        Events, errors and statuses are those of `simulate` for each motion, to the last bit.

    Raises
    ------
    ParameterError
        If a number is out of range, or shapes do not fit; it names the row.

    Examples
    --------
    >>> from symosc import load_scene, simulate_many
    >>> simulate_many(load_scene("fig9").parameters, [(0, 0, 0), (0, 1, 2)], 3, use_numba=False).trajectory.tolist()
    [0, 0, 0, 0, 0, 1, 1, 1, 1, 1]
    """
    problems = Problems(parameters, starts, t_end, read_start_error(start_error))
    most = MOST_EVENTS if max_events is None else min(whole_number("max_events", max_events, 1), 2**62)
    task = BatchTask(problems, chosen_loops(use_numba), Limits(most, read_accuracy(accuracy)))
    part = read_record(record, skip, sections, task)
    threads = min(read_workers(workers), MOST_WORKERS if task.loops.in_threads else 1)
    with (
        reporting(progress or False, 0, len(problems), "simulate_many") as report,
        ROOMS.lent() as room,
    ):
        parts = in_chunks(len(problems), part, room, threads, report)
    return table_of_parts(parts) if is_events(record) else summary_from(parts)
