"""Solutions from files and objects: their columns, matched by name, as samples and events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise, zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.base.files import STDOUT
from symosc.crosschecks.frames import Problem
from symosc.crosschecks.reading.files import read_file
from symosc.crosschecks.reading.names import EVENTS, ID_COLUMN, Asked, read_column_names
from symosc.crosschecks.reading.objects import table_in
from symosc.crosschecks.reading.solver_events import solver_events
from symosc.crosschecks.reading.tables import ColumnTable, array_of
from symosc.crosschecks.samples import SAMPLE_COLUMNS, Samples, checked, checked_events

# Two pieces meet if their times agree but for so many units in the last place.
SAME_TIME_UNITS = 4.0


def read_solutions(
    source: Any, columns: Mapping[str, str | None] | None = None, problem: Problem = None
) -> list[Samples]:
    """Read solutions from a file, standard input ("-"), a list of files, or an object such as a
    table or a function.

    `columns` says how the columns t, x, v and id are called, None for a missing one; from `problem`
    a function gets its times. ParameterError if the file cannot be read, a column is missing or the
    samples are wrong. docs/checking.md lists the objects.
    """
    asked = read_column_names(columns)
    if isinstance(source, (list, tuple)) and source and all(map(_is_path, source)):
        return [
            replace(samples, name=f"{path}:{samples.name}" if samples.name else str(path))
            for path in source
            for samples in read_solutions(path, columns, problem)
        ]
    if not _is_path(source):
        return solutions_in(source, asked, problem)
    where = "standard input" if source == STDOUT else str(source)
    return read_file(source, where, lambda content: solutions_in(content, asked, problem, where))


def _is_path(source: Any) -> bool:
    return isinstance(source, (str, Path))


def solutions_in(
    source: Any, asked: Asked, problem: Problem = None, where: str = ""
) -> list[Samples]:
    """Return the solutions in an object.

    `where` names it in messages, `asked` are the names of its columns. A list of objects is several
    solutions, or pieces of one if each begins where the one before ends.
    """
    where = where or type(source).__name__
    table = table_in(source, asked, problem, where)
    if table is None and isinstance(source, (list, tuple)):
        return _joined(_parts(source, asked, problem, where))
    if table is None:
        what = "is no solution: give a file, a table, an array or a function"
        raise ParameterError("solution", source, what)
    columns, notes = table.choice(asked, where)
    table = replace(table, notes=(*table.notes, *notes))
    return samples_of(table, columns, problem, where)


# -- lists -----------------------------------------------------------------------------------------


def _parts(source: Sequence[Any], asked: Asked, problem: Problem, where: str) -> list[Samples]:
    """Return the solutions in each entry of a list."""
    solutions: list[Samples] = []
    for i, part in enumerate(source):
        if isinstance(part, (str, int, float)) or part is None:
            raise ParameterError(f"{where}[{i}]", part, "is no solution")
        try:
            solutions += solutions_in(part, asked, problem)
        except RecursionError:  # of a list that contains itself
            raise ParameterError(where, part, "is nested too deeply") from None
    return solutions


def _joined(pieces: list[Samples]) -> list[Samples]:
    """Return the pieces as one solution if each begins where the one before ends, else as they
    are.
    """
    gaps = [
        abs(after.t[0] - before.t[-1]) / np.spacing(abs(before.t[-1]))
        for before, after in pairwise(pieces)
    ]
    lack_v = {piece.lacks_v for piece in pieces}
    if len(pieces) == 1 or max(gaps) > SAME_TIME_UNITS or len(lack_v) > 1:
        return pieces
    joined: Record = {
        name: np.concatenate([getattr(piece, name) for piece in pieces]) for name in SAMPLE_COLUMNS
    }
    # Where a piece begins before the one before ends, by rounding, it begins there.
    begin = np.cumsum([len(piece.t) for piece in pieces[:-1]])
    joined["t"][begin] = np.maximum(joined["t"][begin], joined["t"][begin - 1])
    listed = [piece.events for piece in pieces if piece.events is not None]
    if listed:
        joined["events"] = tuple(chain.from_iterable(listed))
    by_function = [piece.lists for piece in pieces if piece.lists is not None]
    if by_function:
        # A piece without such lists claims nothing, and so the whole does not.
        are_complete = len(by_function) == len(pieces)
        functions = zip_longest(*by_function, fillvalue=())
        lists = tuple(tuple(chain.from_iterable(times)) for times in functions)
        joined["lists"] = lists if are_complete else ()
    notes = dict.fromkeys(note for piece in pieces for note in piece.notes)
    return [Samples(**joined, notes=(*notes, f"joined from {len(pieces)} pieces"))]


# -- columns become samples ------------------------------------------------------------------------


def samples_of(table: ColumnTable, values: Record, problem: Problem, where: str) -> list[Samples]:
    """Return the solutions in the chosen columns of a table: a single one, or one for each id or for
    each row of matrices.
    """
    ids = values.pop(ID_COLUMN, None)
    events = table.beside.get(EVENTS)
    if np.ndim(array_of(values["x"])) > 1:
        solutions = _of_matrices(values, table.are_padded, where)
    elif ids is None:
        solutions = [_solution(values, table.are_padded)]
    else:
        solutions = _of_ids(values, np.ravel(np.asarray(ids)).astype(str))
    if len(solutions) > 1:
        if events is not None:
            what = f"can be listed for one solution; {where} has several"
            raise ParameterError("events", "given", what)
        return [replace(samples, notes=table.notes) for samples in solutions]
    samples = replace(solutions[0], dense=table.dense, notes=table.notes)
    if events is not None:
        return [replace(samples, events=checked_events(events))]
    listed = solver_events(table.beside, problem, samples)
    notes = (*table.notes, *listed.notes)
    return [replace(samples, events=listed.events, lists=listed.lists, notes=notes)]


def _solution(values: Record, are_padded: bool = False) -> Samples:
    """Return the samples in the columns t, x and perhaps v of one solution."""
    times = array_of(values["t"])
    if times.ndim == 2 and 1 in times.shape:  # a column of MATLAB
        times = times.ravel()
        values = values | {"t": times}
    # Solvers with arrays of one size fill them up with inf.
    if are_padded and times.dtype.kind == "f" and len(times) > 2 and np.isinf(times[-1]):
        end = int(np.argmax(np.isinf(times)))
        values = {name: column[:end] for name, column in values.items()}
    return checked(**values)


def _of_matrices(values: Record, are_padded: bool, where: str) -> list[Samples]:
    """Return the solutions in columns that are matrices: one solution per row, or per column."""
    arrays = {name: np.asarray(value) for name, value in values.items()}
    times = arrays["t"]
    are_lines = all(array.size == max(array.shape, default=0) for array in arrays.values())
    if are_lines:  # one row or column each
        return [_solution({name: array.ravel() for name, array in arrays.items()}, are_padded)]
    count = times.shape[-1] if times.ndim else 0
    shapes = {name: array.shape for name, array in arrays.items()}
    # One solution per column becomes one per row.
    shape_of_x = arrays["x"].shape
    if times.ndim == 1 and shape_of_x[-1] != count and shape_of_x[0] == count:
        arrays = {name: array.T for name, array in arrays.items()}
    # All must have one shape, but for times that all solutions share.
    different = {array.shape for name, array in arrays.items() if name != "t" or array.ndim > 1}
    shape = different.pop()
    if different or len(shape) != 2 or shape[1] != arrays["t"].shape[-1]:
        what = f"do not fit in {where}: x and v need a row for each solution"
        raise ParameterError("shapes", shapes, what)
    rows = {name: np.broadcast_to(array, shape) for name, array in arrays.items()}
    solutions = [
        _solution({name: row[i] for name, row in rows.items()}, are_padded) for i in range(shape[0])
    ]
    if len(solutions) == 1:
        return solutions
    return [replace(samples, name=str(i)) for i, samples in enumerate(solutions)]


def _of_ids(values: Record, ids: np.ndarray) -> list[Samples]:
    """Return one solution per id, in order of their first rows."""
    names, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
    if len(names) == len(ids):  # a column that has no value twice numbers the rows
        return [_solution(values)]
    lengths = {name: len(column) for name, column in values.items()} | {ID_COLUMN: len(ids)}
    if len(set(lengths.values())) > 1:
        raise ParameterError("lengths", lengths, "the columns must have the same length")
    columns = {name: np.asarray(column) for name, column in values.items()}
    # The numbers of the rows of each id, in the order of the table.
    rows = np.split(np.argsort(inverse, kind="stable"), np.cumsum(np.bincount(inverse))[:-1])
    solutions = []
    for i in np.argsort(first).tolist():
        try:
            samples = checked(**{name: column[rows[i]] for name, column in columns.items()})
        except ParameterError as error:
            what = f"{error.allowed} (id {names[i]})"
            raise ParameterError(error.name, error.value, what) from None
        solutions.append(replace(samples, name=str(names[i]) if len(names) > 1 else ""))
    return solutions
