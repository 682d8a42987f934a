"""`simulate_many`: many motions on all cores, from columns of problems to columns of events or
summaries.

Motions are followed in chunks, each in doubles first. A motion with an event that doubles do not
decide, or do not know accurately enough, is followed again from its exact start in pairs of
doubles, where numba is installed, and doubles go on from there. What pairs do not decide either is
followed alone, as `symosc.simulation.simulate` does. So which arithmetic follows a motion depends
on the motion alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from math import isinf
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import DataFrame, NumberLike, Progress, Record, StartError
from symosc.base.arguments import (
    ARRAY_LIKE,
    FLAG,
    NAMES,
    PROGRESS,
    SCENE_OR_NAME,
    START_ERROR,
    TABLE_LIKE,
    WHOLE,
    mapping_of,
    public,
    require,
    require_or_none,
    sequence_of,
)
from symosc.base.display.progress import reporting
from symosc.base.errors import ParameterError
from symosc.base.exact import read_start_error, whole_number
from symosc.engine import batch as engine_batch
from symosc.engine import summary as kept
from symosc.engine.arithmetic import (
    ROUNDED_FROM,
    compiled_pairs,
    many_digits,
    pair_constants,
    pairs_as_complex,
)
from symosc.engine.batch import (
    Batch,
    EventRows,
    PairLimits,
    batch_of,
    event_buffer,
    joined,
    rows_between,
    state_of,
)
from symosc.engine.events import CODE_COLUMNS, FLOAT_COLUMNS, mode_of_law
from symosc.engine.flow import SIGMAS, ConstantRows, Constants, constants, table_of
from symosc.engine.start import FAR_PERIODS, Start, first_row, settles
from symosc.engine.state import (
    END,
    FULL,
    MOVED,
    ON_BELT,
    REST,
    RUNNING,
    UNDECIDED,
    Covariance,
    NextEvent,
    State,
)
from symosc.engine.summary import (
    Kept,
    Tally,
    finish_tally,
    no_tally,
    select_tallies,
    store_tallies,
    tally_step,
)
from symosc.engine.tangent import Letters
from symosc.friction import ALL_MODE_NAMES, geometry
from symosc.kernels.elementary import cos, sin
from symosc.model import Model, Oscillator, Parameters
from symosc.reductions import OtherModel
from symosc.scenes import ParametersLike, Scene, model_of
from symosc.simulation.batch import (
    MOST_WORKERS,
    CancelToken,
    follow_batch,
    in_chunks,
    read_workers,
)
from symosc.simulation.differentiated import columns_for
from symosc.simulation.loops import CHOICE, Loops
from symosc.simulation.motion import MOST_MORE, PAIR_NOISE, fits_pairs
from symosc.simulation.problems import NumberColumn, ParameterSets, Problems
from symosc.simulation.simulate import (
    MOST_EVENTS,
    attainable,
    check_reached,
    end_status,
    in_doubles,
    read_accuracy,
    read_most,
)
from symosc.simulation.tables import CHANGES, SUMMARY_COLUMNS, Summary, table_from
from symosc.simulation.tangents import event_changes, names_of, read_wrt
from symosc.simulation.trajectory import Trajectory
from symosc.words import Word

# A gap between a start and a belt that pairs have digits to spare for
# (`symosc.simulation.motion.fits_pairs`).
FAR_OFF = 2e-8
# Motions that are followed in interpreted pairs until it is asked again whether to compile.
TOGETHER = 8
# A force on a belt that is this small beside others is computed from the exact start.
SMALL_FORCE = 1e-6
# Mappings of a period that are kept at first, and sections that are kept of a motion, 64 bytes
# each.
USUAL_WORD = 48
MOST_SECTIONS = 100_000
EXTREMES = {"x_min": kept.X_MIN, "x_max": kept.X_MAX, "v_min": kept.V_MIN, "v_max": kept.V_MAX}
#: Columns of a summary that a tally has as they are.
KEPT_COLUMNS = EXTREMES | {"t": kept.T_LAST, "x": kept.X_LAST, "v": kept.V_LAST}
#: Statuses of motions that were followed to their ends.
FOLLOWED = ("t_end", "equilibrium")
NO_SECTION = "sections in periods of the drive require Omega, which this Oscillator lacks"
MODE_TEXTS = np.array(["", *(ALL_MODE_NAMES[code] for code in sorted(ALL_MODE_NAMES))])


@public
def simulate_many(
    parameters: ParametersLike | Sequence[Model] | Mapping[str, ArrayLike],
    starts: ArrayLike | Mapping[str, ArrayLike] | DataFrame,
    t_end: NumberLike | ArrayLike,
    *,
    max_events: int | None = None,
    accuracy: NumberLike | None = None,
    start_error: StartError | None = None,
    use_numba: bool | None = None,
    record: str | Sequence[str] = "events",
    wrt: str | Sequence[str] | None = None,
    skip: NumberLike | ArrayLike = 0,
    sections: int = 1,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Any:
    """Follow many motions in double precision, on all cores.

    Compiled when numba is installed (extra `fast`).

    Parameters
    ----------
    parameters : Parameters or Oscillator, or a Scene, its name or its file
        Or a sequence of n of them, or a mapping of all their names to a number or an (n,) array:
        mu_s1 and mu_s2 are static coefficients, and without v2 and mu2 there is one belt.
    starts : (n, 3) or (3,) array_like, rows of t0, x0, v0; or mapping of these names like `parameters`
    t_end : number or (n,) array, or "10T": ten periods of the drive after each t0
    max_events, accuracy, start_error : optional
        As in `simulate`, for all motions.
    use_numba : bool, optional
        None: if it is installed. Without it all is slower; the last digits may be others.
    record : str or sequence of str
        "events": all of them, an `EventTable`. "summary": a row per motion, a `Summary`; or names
        of its columns.
    wrt : str or sequence of str, optional
        Names of parameters, and t0, x0, v0, by which all events are differentiated, as by
        `symosc.sensitivities`: the table then has dt, dx and regular. With more than two belts, or
        friction that depends on speed, this takes about half a millisecond an event.
    skip, sections : optional
        For summaries: the time from t0 on, in the unit of t_end, that is left out as a transient
        (one for all motions, or one for each), and the number of sections that are kept.
    workers : int, optional
        Threads; None: one for each core. The bytes of the result are the same for any number.
    progress : bool or callable, optional
        True: a bar on a terminal. Or what is called with the number of motions done, and of all.

    Returns
    -------
    EventTable or Summary
        Events and statuses are those of `simulate` for each motion, and their numbers within the
        estimated errors.

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
    sets = parameter_sets(parameters)
    require(*TABLE_LIKE, starts=starts)
    require(*ARRAY_LIKE, t_end=t_end, skip=skip)
    require_or_none(*START_ERROR, start_error=start_error)
    require_or_none(FLAG, use_numba=use_numba)
    require(*NAMES, record=record)
    require_or_none(*NAMES, wrt=wrt)
    require(WHOLE, sections=sections)
    require_or_none(WHOLE, workers=workers)
    require_or_none(*PROGRESS, progress=progress)
    problems = Problems(sets, starts, t_end, read_start_error(start_error))
    most = read_most(max_events, MOST_EVENTS)
    task = EnsembleTask(problems, CHOICE.of_many(use_numba), most, read_accuracy(accuracy))
    of_events = isinstance(record, str) and record == "events"
    work: Callable[..., Any]
    if of_events:
        for name, value, usual in (("skip", skip, 0), ("sections", sections, 1)):
            if value is not usual and not (isinstance(value, int) and value == usual):
                allowed = 'pass record="summary", or names of its columns'
                raise ParameterError(name, value, f"{name} applies to summaries only; {allowed}")
        names: tuple[str, ...] = ()
        if wrt is not None:
            names = read_wrt(wrt, names_of(problems.sets[0]))
        if names and not problems.sets.are_plain:
            check_names(names, problems.sets)
            work = partial(banded_events_of, task, names)
        else:
            work = partial(events_of, task, names, use_numba)
    elif wrt is not None:
        raise ParameterError(
            "wrt", wrt, 'wrt applies to events only; omit it, or pass record="events"'
        )
    else:
        work = partial(summary_of, task, SummaryRequest(record, skip, sections, problems))
    threads = min(read_workers(workers), MOST_WORKERS if task.loops.in_threads else 1)
    with reporting(progress or False, 0, len(problems), "simulate_many") as report:
        parts: list[Any] = in_chunks(len(problems), work, threads, report)
    if of_events:  # parts are what `events_of` returns
        rows = [block for blocks, _, _ in parts for block in blocks]
        status = [text for _, texts, _ in parts for text in texts]
        pieces_of_columns = zip(*(changes for _, _, changes in parts), strict=True)
        columns = [engine_batch.joined_arrays(list(pieces)) for pieces in pieces_of_columns]
        return table_from(
            rows, status, names, **dict(zip(CHANGES if names else (), columns, strict=True))
        )
    return Summary(**{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


def parameter_sets(
    parameters: ParametersLike | Sequence[Model] | Mapping[str, ArrayLike],
) -> Model | Sequence[Model] | Mapping[str, ArrayLike]:
    """Return the parameters of a scene, or of its name or file; return others unchanged."""
    several = (sequence_of(Parameters, Oscillator), mapping_of(*ARRAY_LIKE))
    one = (Parameters, Oscillator, Scene, OtherModel, SCENE_OR_NAME)
    require(*one, *several, parameters=parameters)
    if isinstance(parameters, Scene | OtherModel | str | PathLike):
        return model_of(parameters)
    return parameters


class EnsembleTask(NamedTuple):
    """What all chunks of a call share: the problems, the loops, the most events of a motion, and
    the accuracy.
    """

    problems: Problems
    loops: Loops
    most: int
    accuracy: float


class Chunk:
    """Some of the motions of `simulate_many`, those in `rows`.

    Making the object follows them to their ends.
    """

    # `buffer` is used meanwhile. `keep`, if given, returns the tally of motions from their numbers,
    # their rows at the start and their belts there: then no events are recorded. `batch` has the last states and what
    # each motion ended with, `rows` the events in order of motion and time, `alone` the
    # trajectories of motions that were followed alone.

    def __init__(
        self,
        task: EnsembleTask,
        rows: slice,
        buffer: EventRows,
        cancel: CancelToken,
        keep: Any = None,
    ) -> None:
        self.task = task
        self._first = rows.start
        self._buffer = buffer
        self._cancel = cancel
        self.batch, self.table = task.problems.begin(rows, task.loops.table)
        if isinf(task.accuracy):  # decisions exceed their own rounding only, as in `in_doubles`
            self.table["sigmas"] = 0.0
        self._starts = self.batch.states.copy()
        self._bands = self.batch.sets.copy()
        self._planes = planes_of(self._starts, self.table[self.batch.sets])
        self._keep = keep
        self._needed = attainable(task.accuracy, task.problems.start_error)
        if keep:
            self.tally = keep(rows, self._starts, self._planes)
        else:
            self.tally = no_tally()
        self.rows = list(self._in_doubles(self.batch, self.tally))
        self.alone = dict[int, Trajectory]()
        # What doubles leave undecided is followed again: in pairs if they are compiled, then alone.
        if task.loops.in_threads:
            events_again = self._in_pairs(self._reset_undecided())
        else:
            events_again = {}
        for i in self._reset_undecided():
            cancel.check()
            if task.loops.in_threads:
                pairs = CHOICE.of_pairs(int(self.batch.counts[i]))
            else:
                pairs = None
            CHOICE.pairs.events -= int(self.batch.counts[i])  # from the budget of such events
            self.alone[i] = in_doubles(self.problem(i), task.most, task.accuracy, loops=pairs)
        for i, trajectory in self.alone.items():
            events_again[i] = trajectory.rows()
            events_again[i].ints[0] = i
        if events_again:
            self.rows = with_replaced(self.rows, events_again)
        self.status = self._statuses()

    def problem(self, i: int) -> Start:
        """Return the problem of a motion by its number in this chunk."""
        return self.task.problems[self._first + i]

    def launches(self) -> tuple[np.ndarray, ...]:
        """Return starts, indices of parameter sets, their m, mu1, mu2, FN, and their constants, for
        `event_changes`.
        """
        starts = np.empty((len(self._starts), 5))  # mode, t, theta, x, v, as `tangents` takes them
        sets = self.task.problems.sets
        rows = slice(self._first, self._first + len(starts))
        starts[:, 0] = self._starts["mode"]
        starts[:, 1] = self.task.problems.t0.pairs(rows).hi
        starts[:, 2] = self._starts["theta"]
        starts[:, 3] = self._starts["x"]
        starts[:, 4] = self._starts["v"]
        letters = sets.doubles(Letters._fields, rows if len(sets) > 1 else slice(0, 1))
        # A derivative by B0 depends on Omega, even where B0 = 0 and the motion does not.
        table = self.table.copy()
        first = self._first if len(sets) > 1 else 0
        for i in np.flatnonzero(table["driven"] == 0.0).tolist():
            table[i] = table_of([constants(sets[first + i], driven=True)])[0]
        return starts, self.batch.sets, letters, table

    def _reset_undecided(self) -> list[int]:
        """Return the numbers of the motions that ended undecided.

        Reset their bands and their running summaries to the start.
        """
        members: list[int] = np.flatnonzero(self.batch.codes <= UNDECIDED).tolist()
        self.batch.sets[members] = self._bands[members]
        if self._keep and members:
            numbers = self._first + np.array(members)
            again = self._keep(numbers, self._starts[members], self._planes[members])
            store_tallies(self.tally, members, again)
        return members

    def _in_doubles(self, batch: Batch, tally: Tally) -> Iterator[EventRows]:
        """Follow the motions of a batch in doubles and yield their events.

        Update their summaries in `tally`.
        """
        follow = self.task.loops.follow
        most = self.task.most
        for rows in follow_batch(
            follow, batch, most, self._needed, self.table, self._buffer, tally
        ):
            self._cancel.check()
            yield rows

    def _in_pairs(self, members: list[int]) -> dict[int, EventRows]:
        """Follow the motions `members` again, if double-double numbers suffice for them.

        Return events by motion.
        """
        events_by_motion: dict[int, EventRows] = {}
        numbers = self._first + np.array(members, np.int64)
        sure = self.task.problems.surely_fit_pairs(numbers, self._starts["at"][members], FAR_OFF)
        # motions by parameter set: by the first row of its constants
        groups: dict[int, list[int]] = {}
        for i, surely_fits in zip(members, sure.tolist(), strict=True):
            if surely_fits or fits_pairs(self.problem(i)):
                band = int(self.batch.sets[i])
                groups.setdefault(band - int(self.table["row"][band]), []).append(i)
        for group in groups.values():
            parameters = self.task.problems.sets[self._first + group[0]]
            events = joined(self._escalate(parameters, group))
            # Events come as pairs and doubles take turns: sort them by motion, cut between motions,
            # and replace numbers in the group by those in the chunk.
            order = np.argsort(events.ints[0], kind="stable")
            events = EventRows(*(columns[:, order] for columns in events))
            cuts = np.searchsorted(events.ints[0], np.arange(len(group) + 1)).tolist()
            events.ints[0] = np.array(group)[events.ints[0]]
            events_by_motion |= {
                i: rows_between(events, *cut) for i, cut in zip(group, pairwise(cuts), strict=True)
            }
        return events_by_motion

    def _escalate(self, parameters: Model, members: list[int]) -> Iterator[EventRows]:
        """Follow the motions `members`, of one parameter set, to the end, in pairs where doubles
        are in doubt.
        """
        # Pairs go on from their own last state where doubles are in doubt again: a double has 16
        # digits of it only.
        most = self.task.most
        table = pair_constants(parameters)
        pairs = self._pair_rows(parameters, members)
        tally = select_tallies(self.tally, members)
        states, sets, counts, codes = (column[members] for column in self.batch)
        batch = batch_of(states, sets)
        # An event that doubles do not decide is not counted yet; one that is INEXACT is.
        wanted = counts + (codes == UNDECIDED)
        limits = PairLimits(
            most, self._needed, MOST_MORE, PAIR_NOISE, self.table, careful_table(self.table)
        )
        waiting = np.arange(len(pairs))
        while len(waiting):
            events = wanted - batch.counts
            functions = CHOICE.of_pairs(int(events[waiting[:TOGETHER]].sum()))
            if functions is compiled_pairs():
                together = len(waiting)
            else:
                together = TOGETHER
            active = waiting[:together]
            waiting = waiting[together:]
            # With a tally no events are recorded.
            buffer = event_buffer(
                0 if len(tally.floats) else int((events + MOST_MORE)[active].sum())
            )
            arguments = (
                active,
                wanted,
                pairs,
                batch,
                buffer,
                engine_batch.NO_PIECES,
                table,
                tally,
                limits,
            )
            filled, _ = functions.follow_pairs(*arguments)
            CHOICE.pairs.events -= filled
            yield rows_between(buffer, 0, min(filled, buffer.floats.shape[1]))
            # Those that doubles can decide again go on in doubles, until these are in doubt once more.
            active = active[batch.codes[active] == RUNNING]
            further = Batch(*(column[active] for column in batch))
            counted = select_tallies(tally, active)
            if len(active):
                further_events = joined(self._in_doubles(further, counted))
                doubtful = further.codes <= UNDECIDED
                decided = ~doubtful[further_events.ints[0]]
                further_events.ints[0] = active[further_events.ints[0]]
                yield EventRows(further_events.floats[:, decided], further_events.ints[:, decided])
                wanted[active] = further.counts + (further.codes == UNDECIDED)
                done = active[~doubtful]
                for column, own in zip(batch, further, strict=True):
                    column[done] = own[~doubtful]
                store_tallies(tally, done, select_tallies(counted, ~doubtful))
                waiting = np.concatenate([waiting, active[doubtful]])
        for column, values in zip(self.batch, batch, strict=True):
            column[members] = values
        store_tallies(self.tally, members, tally)

    def _pair_rows(self, parameters: Model, members: list[int]) -> np.ndarray:
        """Return the first states of the motions `members` in pairs hi + lo, stored as complex
        numbers hi + i lo.
        """
        starts = self._starts[members]
        numbers = self._first + np.array(members, np.int64)
        arithmetic = partial(many_digits, parameters, ROUNDED_FROM)
        phase = arithmetic(0).phase
        pairs = self.task.problems.pair_rows(
            numbers, starts, lambda t: pairs_as_complex(phase(t)[0])
        )
        bands = self.table["row"][self._bands[members]].astype(np.int64)
        CHOICE.of_pairs(len(pairs)).first_pairs(pairs, bands, pair_constants(parameters))
        least = np.minimum(abs(starts["Fb"]), abs(starts["Fa"]))
        largest = np.maximum(abs(starts["Fb"]), abs(starts["Fa"]))
        unclear = (starts["at"] > 0) & (least <= SMALL_FORCE * (largest + float(parameters.FN)))
        for i in np.flatnonzero(unclear).tolist():
            _, row = first_row(self.problem(members[i]), arithmetic)
            pairs[i] = pairs_as_complex(row)
        return pairs

    def _statuses(self) -> list[str]:
        """Return for each motion why it ended, as text such as "t_end" or "max_events"."""
        codes = self.batch.codes
        states = self.batch.states
        status: list[str] = np.where(codes == FULL, "max_events", "t_end").tolist()
        # Motions without a drive may have come to rest.
        for i in np.flatnonzero(
            (codes == REST) | ((codes == END) & (self.batch.counts == 0))
        ).tolist():
            problem = self.problem(i)
            last = state_of(states[i])
            if codes[i] == END and settles(problem):
                code = REST
            else:
                code = int(codes[i])
            row = int(self.table["row"][self.batch.sets[i]])
            status[i] = end_status(code, last.mode, last.v, last.Fb, problem.parameters, row)
        wanted = self.task.problems.t_end.pairs(slice(self._first, self._first + len(codes))).hi
        given_up = (states["n"] >= FAR_PERIODS) | (states["t_end"] < wanted)
        for i in np.flatnonzero((codes == END) & given_up).tolist():
            check_reached(self.problem(i))
        for i, trajectory in self.alone.items():
            status[i] = trajectory.status
        return status


def with_replaced(parts: Sequence[EventRows], again: dict[int, EventRows]) -> list[EventRows]:
    """Return the event rows of `parts` in order of motion and time, with those of the motions in
    `again` replaced.
    """
    members = np.array(sorted(again), np.int64)
    pieces = list(again.values())
    for part in parts:
        begins, ends = (np.searchsorted(part.ints[0], members, side) for side in ("left", "right"))
        gaps = zip([0, *ends], [*begins, part.ints.shape[1]], strict=True)
        pieces += [rows_between(part, begin, end) for begin, end in gaps]
    return sorted(
        (piece for piece in pieces if piece.ints.shape[1]), key=lambda piece: int(piece.ints[0, 0])
    )


def careful_table(table: np.ndarray) -> np.ndarray:
    """Return the constants such that an event counts as decided only if the error of a state cannot
    change it.
    """
    if len(table) and (table["sigmas"] == 0.0).any():
        table = table.copy()
        table["sigmas"] = float(SIGMAS)
    return table


def events_of(
    task: EnsembleTask,
    wrt: tuple[str, ...],
    use_numba: bool | None,
    rows: slice,
    buffer: EventRows,
    cancel: CancelToken,
) -> tuple[list[EventRows], list[str], tuple[np.ndarray, ...]]:
    """Follow the motions of `rows`.

    Return their events, their statuses, and the columns dt, dx, regular by `wrt`.
    """
    chunk = Chunk(task, rows, buffer, cancel)
    changes = tuple[np.ndarray, ...]()
    if wrt:
        chunk.rows = [joined(chunk.rows)]
        count = len(chunk.rows[0].ints[0])
        loop = CHOICE.of_derivatives(count, task.loops.in_threads, use_numba)
        changes = event_changes(chunk.rows[0], chunk.launches(), wrt, loop)
    for part in chunk.rows:
        part.ints[0] += rows.start
    return chunk.rows, chunk.status, changes


def check_names(wrt: tuple[str, ...], sets: ParameterSets) -> None:
    """Raise ParameterError unless each of the parameter sets has the numbers `wrt`."""
    for row, model in enumerate(sets.given()):
        names = names_of(model)
        for name in wrt:
            if name not in names:
                raise ParameterError("wrt", name, f"parameters[{row}] has no number {name}")


def banded_events_of(
    task: EnsembleTask,
    wrt: tuple[str, ...],
    rows: slice,
    buffer: EventRows,
    cancel: CancelToken,
) -> tuple[list[EventRows], list[str], tuple[np.ndarray, ...]]:
    """Follow the motions of `rows` one by one: derivatives through bands need their pieces.

    Return what `events_of` returns.
    """
    if task.loops.in_threads:
        pairs = CHOICE.of_pairs(0)
    else:
        pairs = None
    events = list[EventRows]()
    status = list[str]()
    shape = (0, len(wrt))
    # No motions have the columns too, without an entry.
    changes: list[tuple[np.ndarray, ...]] = [
        (np.zeros(shape), np.zeros(shape), np.zeros(shape, bool))
    ]
    for i in range(rows.start, rows.stop):
        cancel.check()
        start = task.problems[i]
        motion = in_doubles(start, task.most, task.accuracy, loops=pairs)

        def follow(model: Model, start: Start = start) -> Trajectory:
            return in_doubles(replace(start, parameters=model), task.most, task.accuracy)

        columns = columns_for(motion, start, wrt, follow)
        dt, dx, marks, *_ = columns.event_derivatives(wrt, len(wrt))
        changes.append((dt, dx, marks == 1))
        part = motion.rows()
        part.ints[0] = i
        events.append(part)
        status.append(motion.status)
    joined_changes = tuple(
        engine_batch.joined_arrays(list(column)) for column in zip(*changes, strict=True)
    )
    return events, status, joined_changes


class SummaryRequest:
    """What a caller asks of a summary: columns, the time to skip, and the number of Poincaré
    sections to keep.
    """

    def __init__(self, record: Any, skip: Any, sections: Any, problems: Problems) -> None:
        if isinstance(record, str):
            names = [record]
        else:
            names = list(record)
        periodic = all(p.has_periods for p in problems.sets.given())
        if names == ["summary"]:
            names = [name for name in SUMMARY_COLUMNS if periodic or name != "section"]
        for name in names or ("",):
            if name not in SUMMARY_COLUMNS:
                allowed = f'must be "events", "summary", or some of {", ".join(SUMMARY_COLUMNS)}'
                raise ParameterError("record", name, allowed)
        self.names = tuple(name for name in SUMMARY_COLUMNS if name in names)
        if "section" in names and not periodic:
            raise ParameterError("record", "section", NO_SECTION)
        #: The labels of the mappings, by their numbers from 1.
        self.labels = tuple(geometry(len(problems.sets.boundaries)).maps)
        self.sections = whole_number("sections", sections, 0, MOST_SECTIONS)
        column = NumberColumn("skip", skip)
        if len(column) not in (1, len(problems)):
            allowed = f"must have 1 or {len(problems)} values, as many as motions"
            raise ParameterError("skip", f"{len(column)} values", allowed)
        self.skip = np.broadcast_to(column.hi, len(problems))
        spans = problems.t_end.hi - problems.t0.hi
        for row in np.flatnonzero(~((self.skip >= 0.0) & (self.skip < spans))).tolist():
            raise ParameterError(
                column.called(row),
                column.hi[row % len(column)],
                "must be >= 0 and end before t_end",
            )

    def __contains__(self, name: str) -> bool:
        return name in self.names

    def start_tallies(
        self, longest: int, motions: Any, states: np.ndarray, planes: np.ndarray
    ) -> Tally:
        """Return new running summaries of `motions` that begin at `states`, on the belts `planes`
        or none (0), for words of up to `longest` mappings.
        """
        repeats = "multiplicity" in self
        extremes = not EXTREMES.keys().isdisjoint(self.names)
        if repeats:
            ring = 2 * kept.LONGEST_REPEAT
        elif "word" in self or "section" in self:
            ring = kept.LEAST_RING
        else:
            ring = 0
        if "section" in self:
            ring = max(ring, self.sections)
        if "word" in self:
            words = longest
        else:
            words = 0
        asked = Kept("stuck" in self, repeats or extremes, extremes, ring, words)
        return kept.new_tally(states, planes, self.skip[motions], asked)


def summary_of(
    task: EnsembleTask,
    asked: SummaryRequest,
    rows: slice,
    buffer: EventRows,
    cancel: CancelToken,
    longest: int = USUAL_WORD,
) -> Record:
    """Follow the motions of `rows`, again if words exceed `longest` mappings.

    Return the summary columns `asked`.
    """
    chunk = Chunk(task, rows, buffer, cancel, partial(asked.start_tallies, longest))
    tally = chunk.tally
    sets = chunk.batch.sets
    t0 = task.problems.t0.pairs(rows).hi
    modes = modes_of_law(chunk.batch.states["mode"].astype(int), chunk.table[sets])
    for i, trajectory in chunk.alone.items():
        first = int(sets[i] - chunk.table["row"][sets[i]])
        modes[i] = tally_alone(i, trajectory, tally, chunk.table, first)
    status = np.array(chunk.status, dtype=str)
    floats = tally.floats
    columns: Record = {"status": status, "mode": MODE_TEXTS[modes]}
    columns |= {"events": tally.ints[:, kept.EVENTS_SO_FAR], "sticks": tally.ints[:, kept.STICKS]}
    columns |= {name: floats[:, n] for name, n in KEPT_COLUMNS.items()}
    columns |= {
        name: np.where(np.isfinite(columns[name]), columns[name], np.nan) for name in EXTREMES
    }
    reached_end = np.isin(status, FOLLOWED)
    columns["t"] = np.where(reached_end, task.problems.t_end.pairs(rows).hi, columns["t"])
    counted_time = columns["t"] - t0 - asked.skip[rows]
    with np.errstate(all="ignore"):
        columns["stuck"] = np.where(
            counted_time > 0.0, np.minimum(floats[:, kept.STUCK] / counted_time, 1.0), np.nan
        )
    if "multiplicity" in asked or "section" in asked:
        columns["section"] = np.full(
            (len(floats), asked.sections if "section" in asked else 0, 2), np.nan
        )
        columns["multiplicity"] = np.zeros(len(floats) if "multiplicity" in asked else 0, np.int64)
        task.loops.settle(tally, sets, chunk.table, columns["section"], columns["multiplicity"])
        # Without a drive rest is rest, however many periods it has lasted.
        if "multiplicity" in asked:
            rests = (status == "equilibrium") & (chunk.table["driven"][sets] == 0.0)
            columns["multiplicity"][rests] = 1
    if "word" in asked:
        columns["word"] = words_of(tally, asked.labels)
        for i in np.flatnonzero(tally.ints[:, kept.LAST_LENGTH] > longest).tolist():
            row = rows.start + i
            length = int(tally.ints[i, kept.LAST_LENGTH])
            again = summary_of(task, asked, slice(row, row + 1), buffer, cancel, length)["word"]
            columns["word"] = columns["word"].astype(
                np.promote_types(columns["word"].dtype, again.dtype)
            )
            columns["word"][i] = again[0]
    return {name: columns[name] for name in asked.names}


def words_of(tally: Tally, labels: Sequence[str]) -> np.ndarray:
    """Return for each motion the word of its last whole forcing period as text, such as "P32".

    "" if there is none. `labels` are those of the mappings, by their numbers from 1.
    """
    width = tally.labels.shape[2]
    there = np.arange(width) < tally.ints[:, kept.LAST_LENGTH, None]
    rows = np.where(there, tally.labels[:, 1], np.uint8(0)).view(f"S{width}")[:, 0]
    words, numbers = np.unique(rows, return_inverse=True)
    # Where a cycle is cut into periods depends on the phases of its events: all of its rotations
    # are one text.
    cycles = [Word(tuple(labels[code - 1] for code in word)).cycle for word in words.tolist()]
    texts = [str(word) if word.labels else "" for word in cycles]
    return np.array(texts, dtype=str)[numbers]


def planes_of(states: np.ndarray, constants: np.ndarray) -> np.ndarray:
    """Return the belts on which motions start, 0 for none, from their states and constants."""
    at = states["at"].astype(np.int64)
    corner = np.where(at == 1, constants["belt1"]["is_corner"], constants["belt2"]["is_corner"])
    planes: np.ndarray = np.where((at == 0) | (corner != 0.0), 0, at + constants["shift"])
    return planes


def modes_of_law(modes: np.ndarray, constants: np.ndarray) -> np.ndarray:
    """Return modes of motions as codes of the whole law, from those in their rows of constants."""
    own = modes.copy()
    rows = constants.view(np.recarray)
    for i in np.flatnonzero(constants["banded"]).tolist():
        own[i] = mode_of_law(int(modes[i]), rows[i])
    return own


def tally_alone(i: int, trajectory: Trajectory, tally: Tally, table: np.ndarray, first: int) -> int:
    """Fill row `i` of `tally` from a trajectory whose constants begin in row `first` of `table`.

    Return its last mode.
    """
    rows = ConstantRows(table)
    t0 = float(trajectory.t_start)
    pieces = trajectory._pieces.T.tolist()
    states = [_state_of_piece(*piece) for piece in pieces]
    events = trajectory.rows()
    floats = (
        events.floats[FLOAT_COLUMNS.index(name)].tolist() for name in ("x", "theta", "t_error")
    )
    codes = (events.ints[1 + CODE_COLUMNS.index(name)].tolist() for name in ("kind", "boundary"))
    events_left = list(zip(*floats, *codes, strict=True))[::-1]  # the next one is the last
    last = states[0]
    K = _true_clock(rows[first + int(pieces[0][-1])])
    reached_end = trajectory.status in FOLLOWED
    for (before, after), (*_, next_row) in zip(pairwise(states), pieces[1:], strict=True):
        if not (events_left or reached_end):
            break
        # A piece begins with an event, or where a search without an event was over.
        event = NextEvent(MOVED, 0, True, 0.0, after)
        if events_left and events_left[-1][:2] == (after.x, after.theta):
            _, _, t_error, kind, boundary = events_left.pop()
            event = NextEvent(kind, boundary - int(K.shift), True, t_error, after)
        tally_step(i, before, event, 0.0, tally, K)
        last = after
        K = _true_clock(rows[first + int(next_row)])
    remaining = (float(trajectory.t_end) - t0) - last.t
    finish_tally(i, last, REST if reached_end else RUNNING, remaining, 0.0, tally, K)
    tally.floats[i, kept.T_LAST] += t0
    return int(mode_of_law(last.mode, K))


def _true_clock(K: Constants) -> Constants:
    """Return the constants for pieces of a motion, which have true times."""
    return K._replace(Om_gain=0.0)


def _state_of_piece(
    n: float, theta: float, mode: float, x: float, v: float, a: float, elapsed: float, _row: float
) -> State:
    """Return the State at the start of a piece, without errors: period, phase, mode, x, v,
    acceleration, time.
    """
    if mode > ON_BELT:
        at = int(mode) - ON_BELT
    else:
        at = 0
    exact = Covariance(0.0, 0.0, 0.0)
    return State(
        int(mode), at, int(n), theta, x, v, a, a, exact, elapsed, 0.0, sin(theta), cos(theta), 0.0
    )
