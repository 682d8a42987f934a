"""Several solutions, judged one after the other or by several processes at once."""

from __future__ import annotations

import multiprocessing
import sys
import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.report import CrossCheck
from symosc.crosschecks.samples import Samples
from symosc.display.frames import imported
from symosc.display.progress import Report, reporting
from symosc.errors import ParameterError
from symosc.simulation.batch import read_workers
from symosc.simulation.tables import counted

# Lines of a summary: so many solutions that fail are listed.
MOST_LISTED = 20
#: Columns of the tables of results, after the name of the solution.
RESULT_COLUMNS = (
    "ok",
    "samples",
    "t_first",
    "t_last",
    "max_error_x",
    "max_error_v",
    "max_defect_x",
    "max_defect_v",
    "wrong_steps",
    "matched",
    "missed",
    "invented",
    "unresolved",
    "compared_until",
    "first_wrong_t",
    "reason",
)

Judge = Callable[[Samples], CrossCheck]


class CrossChecks(list[CrossCheck]):
    """Cross-checks of several solutions: a list, with their names and a summary.

    Attributes
    ----------
    names : list of str
        Which is which: the ids of a table, or their numbers.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> checks = crosscheck("fig5", [{"t": t, "x": x, "v": v}, {"t": t, "x": x, "v": v + (t > 5)}], partial=True)
    >>> [check.ok for check in checks], checks.ok
    ([True, False], False)
    """

    def __init__(self, checks: Iterable[CrossCheck], names: Iterable[str]) -> None:
        super().__init__(checks)
        self.names = list(names)

    @property
    def ok(self) -> bool:
        """Whether all are right."""
        return all(check.ok for check in self)

    def __repr__(self) -> str:
        right = sum(check.ok for check in self)
        return f"<CrossChecks of {counted(len(self), 'solution')}: {right:,} ok, {len(self) - right:,} failed>"

    def summary(self) -> str:
        """Return the findings as lines of text: how many are right, and what is wrong with the first that are not."""
        failed = [(name, check) for name, check in zip(self.names, self, strict=True) if not check.ok]
        lines = [
            f"{'FAILED' if failed else 'ok'}: {counted(len(self), 'solution')}, {len(failed):,} failed",
            f"largest global error: {max(check.max_error_x for check in self):.2e} in x, "
            f"{max(check.max_error_v for check in self):.2e} in v",
        ]
        totals = ", ".join(f"{sum(len(getattr(check, name)) for check in self):,} {name}" for name in EVENT_LISTS)
        lines.append(f"events: {totals}")
        for name, check in failed[:MOST_LISTED]:
            fault = check.first_wrong
            what = f"first wrong step at t = {fault.t:.10g}: {fault.reason}" if fault else "no step is wrong"
            what = "; ".join([what, *filter(None, (check.wrong_start, check.early_end))])
            counts = f"{len(check.wrong_steps)} wrong steps, {len(check.missed)} missed, {len(check.invented)} invented"
            lines.append(f"{name}: {counts}; {what}")
        if len(failed) > MOST_LISTED:
            lines.append(f"and {len(failed) - MOST_LISTED:,} more that failed")
        notes = dict.fromkeys(note for check in self for note in check.notes)
        return "\n".join([*lines, *(f"note: {note}" for note in list(notes)[:MOST_LISTED])])

    def as_dict(self) -> Record:
        """Return the findings as plain values, without the samples."""
        checks = [{"name": name, **check.as_dict()} for name, check in zip(self.names, self, strict=True)]
        return {"ok": self.ok, "solutions": len(self), "checks": checks}

    def columns(self) -> dict[str, np.ndarray]:
        """Return the findings as columns, a row for each solution."""
        rows = [_row(check) for check in self]
        return {"solution": np.array(self.names)} | {
            name: np.array([row[i] for row in rows]) for i, name in enumerate(RESULT_COLUMNS)
        }

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row for each solution; MissingExtraError if pandas is not installed."""
        return imported("pandas").DataFrame(self.columns())

    def to_xarray(self) -> Any:
        """Return a Dataset over `solution`; MissingExtraError if xarray is not installed."""
        columns = self.columns()
        names = columns.pop("solution")
        data: Record = {name: (("solution",), column) for name, column in columns.items()}
        return imported("xarray").Dataset(data, coords={"solution": names})


EVENT_LISTS = ("matched", "missed", "invented", "unresolved")


def _row(check: CrossCheck) -> tuple[Any, ...]:
    fault = check.first_wrong
    defects = [float(np.max(np.abs(column))) for column in check.defects.T]
    return (
        check.ok,
        len(check.t),
        float(check.t[0]),
        float(check.t[-1]),
        check.max_error_x,
        check.max_error_v,
        *defects,
        len(check.wrong_steps),
        *(len(getattr(check, name)) for name in EVENT_LISTS),
        check.compared_until,
        np.nan if fault is None else fault.t,
        "" if fault is None else fault.reason,
    )


def check_all(judge: Judge, solutions: Sequence[Samples], workers: Any, progress: Any) -> CrossChecks:
    """Judge several solutions.

    Parameters
    ----------
    judge : callable
        Returns the verdict on one; it is sent to other processes, so it must be one of a module.
    solutions : sequence of Samples
    workers : int or None
        Processes; None: as many as there are cores.
    progress : callable, bool or None
        Called with the number of solutions that are done, and of all; True: a bar on a terminal.

    Raises
    ------
    ParameterError
        If a solution cannot be judged; the message names it.
    """
    count = min(read_workers(workers), len(solutions))
    names = [samples.name or str(i) for i, samples in enumerate(solutions)]
    with reporting(progress or False, 0, len(solutions), "check", "solutions") as report:
        if count > 1:
            return CrossChecks(_in_processes(judge, solutions, names, count, report), names)
        found = []
        for i in range(len(solutions)):
            found.append(_judged(judge, solutions, names, i))
            report(i + 1, len(solutions))
        return CrossChecks(found, names)


def _judged(judge: Judge, solutions: Sequence[Samples], names: Sequence[str], i: int) -> CrossCheck:
    try:
        return judge(solutions[i])
    except ParameterError as error:
        raise ParameterError(error.name, error.value, f"{error.allowed} (solution {names[i]})") from None


# What the processes judge: they inherit it, or are sent it once, so that a task is a number.
_shared: dict[str, Any] = {}


def _share(judge: Judge, solutions: Sequence[Samples], names: Sequence[str]) -> None:
    _shared["all"] = judge, solutions, names


def _judged_there(i: int) -> CrossCheck:
    judge, solutions, names = _shared["all"]
    return _judged(judge, solutions, names, i)


def _in_processes(
    judge: Judge, solutions: Sequence[Samples], names: Sequence[str], workers: int, report: Report
) -> list[CrossCheck]:
    # A process that is forked needs no main module that can be imported, and nothing is sent to it.
    forks = sys.platform == "linux" and "fork" in multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("fork" if forks else "spawn")
    shared = (judge, solutions, names)
    found: dict[int, CrossCheck] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of forking beside threads, which are idle
        with ProcessPoolExecutor(workers, context, _share, shared) as pool:
            try:
                tasks = {pool.submit(_judged_there, i): i for i in range(len(solutions))}
                for task in as_completed(tasks):
                    found[tasks[task]] = task.result()
                    report(len(found), len(solutions))
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
    return [found[i] for i in range(len(solutions))]
