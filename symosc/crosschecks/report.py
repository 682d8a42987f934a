"""The result of a cross-check as values, text and plain data.

And the results of several solutions.
"""

from __future__ import annotations

import multiprocessing
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, fields
from functools import cached_property, partial
from typing import Any

import numpy as np

from symosc.base.aliases import Progress, Record
from symosc.base.display.drawable import Comparable, Drawable, Reportable
from symosc.base.display.frames import imported
from symosc.base.display.progress import reporting
from symosc.base.errors import ParameterError
from symosc.base.workers import process_pool
from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.diagnosis import diagnose
from symosc.crosschecks.events import FoundEvent
from symosc.crosschecks.faults import REASONS, Fault
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.verdict import CheckTask, Verdict, judge
from symosc.simulation.tables import counted
from symosc.simulation.trajectory import Event

EVENTS_LISTED = 5  # of a kind in a summary
# Number of failing solutions that a summary of several solutions lists.
MOST_LISTED = 20
EVENT_LISTS = ("matched", "missed", "invented", "unresolved")
#: What is said of an exact event.
EVENT_VALUES = ("t", "x", "v", "kind", "boundary", "source", "target")


@dataclass(frozen=True, eq=False, repr=False)
class CrossCheck(Verdict, Comparable, Drawable, Reportable):
    """The comparison of samples with the exact motion.

    Attributes
    ----------
    ok : bool
        No step or span is wrong, no event missed or invented, the global error within its limits,
        the start that of the scene, and the end not before that of the motion.
    max_error_x, max_error_v : float
        Largest global error: samples minus the exact motion from the same start.
    errors : (n, 2) array
        Global errors of x and v; NaN after the end of the exact motion (`compared_until`).
    limits : (n, 2) array
        How large `errors` may be: the global tolerance in units of x and v, plus the rounding of
        the sample, and what the exact motion makes of the rounding of the first sample.
    defects : (n - 1, 2) array
        Local errors: the exact motion from a sample over the step, minus the next sample.
    wrong_steps : int array
        Steps whose defect is larger than `allowed`.
    allowed : (n - 1, 2) array
        The tolerance in units of x and v, plus the rounding of the times. For samples with few
        digits also the rounding of the next sample, and what the exact motion makes of the rounding
        of the sample before.
    wrong_spans : (m, 2) int array
        Spans of rounded samples, each from one sample to a later one, over which the exact motion
        leads elsewhere.
    matched : tuple of Match
        Exact events that the samples have too.
    missed : tuple of Event
        Exact events that wrong steps passed over, or that a given list does not have at their time.
    invented : tuple of FoundEvent
        Events of wrong steps, or of a given list, that the exact motion does not have at their
        time.
    unresolved : tuple of Event or FoundEvent
        Events on one side only, though each step is right. The samples are on a neighbouring path,
        within the global error, or the tolerance does not decide whether there is such an event.
    decisions : tuple of Fault
        Wrong steps that stick, slip or pass where the exact motion does something else.
    faults : tuple of Fault
        Wrong steps with guesses why: the first 500 and those with a missed or invented event.
    first_wrong : Fault or None
        The first wrong step.
    first_switching : Fault or None
        The first wrong step at a belt: its reason is more than a local error.
    compared_until : float
        Where the exact motion ends: the last sample, or earlier if its status is "undecidable", or
        if static friction has driven the solution away from it.
    tolerance, global_tolerance : float
    scales : tuple of two floats
        Units of x and v for the tolerances: the largest of the exact motion.
    rounded : dict
        How the columns "t", "x", "v" and the times of the list, "events", were rounded, such as "6
        decimals".
    notes : tuple of str
    modes : (n,) int array
        What the samples do, by the codes of `symosc.friction.ALL_MODE_NAMES`; 0 where they only pass or
        graze a belt.
    t, x, v : (n,) arrays
    trajectory : Trajectory
        The exact motion.
    own_start : tuple of three floats or None
        Where the scene starts: t0, x0, v0; None if Parameters were given.
    wrong_start, early_end : str
        Where the solution starts if that is not where the scene does, and where it ends if that is
        before the motion does; "" if it is right or allowed.
    coarser : CrossCheck or None
        Verdict on every n-th sample, where the rounding hides in single steps what is wrong over
        spans of n.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> check = crosscheck("fig5", t, x, v + 0.1 * (t > 5), partial=True)
    >>> check.ok, f"{check.max_error_v:.3f}"
    (False, '0.100')
    """

    _drawn_by = "crosscheck_figure"
    _made_by = "crosscheck(...)"

    @cached_property
    def diagnosis(self) -> tuple[Diagnosis, ...]:
        """The probable causes, the most probable first; computed on first access."""
        return diagnose(self)

    @property
    def limits_there(self) -> tuple[float, float]:
        """The limits of the errors of x and v, each at the sample where this error is largest."""
        worst_x, worst_v = np.nanargmax(np.abs(self.errors), axis=0)
        limits_x, limits_v = self.limits.T
        return float(limits_x[worst_x]), float(limits_v[worst_v])

    def __repr__(self) -> str:
        return f"<CrossCheck {self.summary().splitlines()[0]}>"

    def summary(self) -> str:
        """Return the findings as lines of text."""
        lines = [
            *self._figures(),
            *self._beyond_limits(),
            *self._about_events(),
            *self._about_faults(),
            *self._about_causes(),
        ]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def _figures(self) -> list[str]:
        """Return lines about how many samples, steps and events are right, and the largest
        errors.
        """
        defect_x, defect_v = np.max(np.abs(self.defects), axis=0)
        limit_x, limit_v = self.limits_there
        verdict = "ok" if self.ok else "FAILED"
        counts = [f"{len(getattr(self, name))} {name}" for name in EVENT_LISTS[:3]]
        events = ", ".join([*counts, f"{len(self.unresolved)} within the global error"])
        return [
            f"{verdict}: {len(self.t)} samples, tolerance {self.tolerance:g} per step",
            f"largest defect of a step: {defect_x:.2e} in x, {defect_v:.2e} in v; "
            f"wrong steps: {len(self.wrong_steps)} of {len(self.defects)}",
            f"largest global error: {self.max_error_x:.2e} in x, {self.max_error_v:.2e} in v "
            f"(allowed there {limit_x:.1e} and {limit_v:.1e})",
            f"events: {events}",
        ]

    def _beyond_limits(self) -> Iterator[str]:
        """Yield lines about the start, the end, the global error and the spans, where these are
        wrong.
        """
        if self.wrong_start:
            yield f"wrong start: {self.wrong_start} (own_start=True, --own-start: allowed)"
        if self.early_end:
            yield f"early end: {self.early_end} (partial=True, --partial: allowed)"
        beyond = np.flatnonzero(np.any(np.abs(self.errors) > self.limits, axis=1))
        if len(beyond):
            first = beyond[0]
            x, v = np.abs(self.errors[first])
            t = self.t[first]
            limit_x, limit_v = self.limits[first]
            allowed = f"allowed {limit_x:.1e} and {limit_v:.1e}"
            where = f"first at t = {t:.10g} ({x:.1e} in x, {v:.1e} in v, {allowed})"
            count = f"{len(beyond)} of {len(self.t)} samples"
            yield f"global error beyond its limit: {count}, {where}"
        if len(self.wrong_spans):
            first, last = self.wrong_spans[0].tolist()
            times = f"first from t = {self.t[first]:.10g} to {self.t[last]:.10g}"
            spans = f"{len(self.wrong_spans)} spans, {times}"
            yield f"wrong over {last - first} steps, beyond the rounding: {spans}"

    def _about_events(self) -> Iterator[str]:
        """Yield lines about the worst of the matched events, and the first missed and invented
        ones.
        """
        if self.matched:
            late = max(self.matched, key=lambda match: abs(match.error))
            where = f"at t = {float(late.event.t):.10g}"
            yield f"largest error of an event's time: {abs(late.error):.2e} {where}"
        for name in ("missed", "invented"):
            yield from _first_lines(name, [_event_text(event) for event in getattr(self, name)])

    def _about_faults(self) -> Iterator[str]:
        """Yield lines about the first wrong steps and decisions."""
        if self.first_wrong:
            yield f"first wrong step: {_fault_text(self.first_wrong)}"
        if self.first_switching and self.first_switching != self.first_wrong:
            yield f"first wrong step at a belt: {_fault_text(self.first_switching)}"
        decisions = [
            f"step {fault.step}, t = {fault.t_next:.10g}: "
            f"{fault.found} where {fault.expected} is right"
            for fault in self.decisions
        ]
        yield from _first_lines("wrong decision", decisions)

    def _about_causes(self) -> Iterator[str]:
        """Yield lines about the probable causes."""
        for diagnosis in self.diagnosis:
            if diagnosis.cause == "precision":  # a note says already that samples are rounded
                continue
            yield f"diagnosis: {diagnosis.words} ({diagnosis.evidence})"
            for second in diagnosis.alternatives:
                yield f"diagnosis: or: {second.words} ({second.evidence})"

    def as_dict(self) -> Record:
        """Return the findings as plain values, without the samples."""
        # JSON has no NaN: a step that cannot be decided has no defect.
        max_defect_x, max_defect_v = (
            None if np.isnan(value) else float(value)
            for value in np.max(np.abs(self.defects), axis=0)
        )
        allowed_x, allowed_v = self.limits_there
        return {
            "ok": self.ok,
            "samples": len(self.t),
            "tolerance": self.tolerance,
            "global_tolerance": self.global_tolerance,
            "scales": list(self.scales),
            "max_error_x": self.max_error_x,
            "max_error_v": self.max_error_v,
            "allowed_error_x": allowed_x,
            "allowed_error_v": allowed_v,
            "wrong_start": self.wrong_start,
            "early_end": self.early_end,
            "max_defect_x": max_defect_x,
            "max_defect_v": max_defect_v,
            "wrong_steps": self.wrong_steps.tolist(),
            "wrong_spans": self.wrong_spans.tolist(),
            "matched": [
                {**_plain_event(match.event), "found_t": match.t, "error": match.error}
                for match in self.matched
            ],
            **{
                name: [_plain_event(event) for event in getattr(self, name)]
                for name in EVENT_LISTS[1:]
            },
            "decisions": [_plain_fault(fault) for fault in self.decisions],
            "first_wrong": _plain_fault(self.first_wrong),
            "first_switching": _plain_fault(self.first_switching),
            "compared_until": self.compared_until,
            "rounded": dict(self.rounded),
            "diagnosis": [asdict(diagnosis) for diagnosis in self.diagnosis],
            "notes": list(self.notes),
        }


def shown(verdict: Verdict) -> CrossCheck:
    """Return a verdict as a result that can be shown, with the probable causes."""
    values = {part.name: getattr(verdict, part.name) for part in fields(verdict)}
    if verdict.coarser is not None:
        values["coarser"] = shown(verdict.coarser)
    return CrossCheck(**values)


def _event_text(event: Event | FoundEvent) -> str:
    """Return an event as text, such as "cross on belt 2 at t = 1.5"."""
    belt = f" on belt {event.boundary}" if event.boundary else ""
    return f"{event.kind}{belt} at t = {float(event.t):.10g}"


def _plain_event(event: Event | FoundEvent) -> Record:
    """Return an event as plain values."""
    if isinstance(event, FoundEvent):
        return asdict(event)
    return {name: getattr(event, name) for name in EVENT_VALUES}


def _plain_fault(fault: Fault | None) -> Record | None:
    """Return a wrong step as plain values."""
    if fault is None:
        return None
    # JSON has no NaN: a step that cannot be decided has none.
    values = asdict(fault)
    return {name: None if value != value else value for name, value in values.items()}


def _first_lines(name: str, items: Sequence[str]) -> list[str]:
    """Return the first items as lines that begin with `name`, and a line with the number of items
    left out.
    """
    lines = [f"{name}: {item}" for item in items[:EVENTS_LISTED]]
    if len(items) > EVENTS_LISTED:
        lines.append(f"{name}: and {len(items) - EVENTS_LISTED} more")
    return lines


def _fault_text(fault: Fault) -> str:
    """Describe a wrong step: its number, times, defects and the guessed cause."""
    size = f"defect {fault.defect_x:.1e} in x, {fault.defect_v:.1e} in v"
    guess = f"{REASONS[fault.reason]} ({fault.words})"
    return f"{fault.step}, t = {fault.t:.10g} to {fault.t_next:.10g}, {size}; guess: {guess}"


class CrossChecks(list[CrossCheck]):
    """Cross-checks of several solutions: a list, with their names and a summary.

    Attributes
    ----------
    names : list of str
        The name of each solution: its id in a table, or its number.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> right, wrong = {"t": t, "x": x, "v": v}, {"t": t, "x": x, "v": v + (t > 5)}
    >>> checks = crosscheck("fig5", [right, wrong], partial=True)
    >>> [check.ok for check in checks], checks.ok
    ([True, False], False)
    """

    def __init__(self, checks: Iterable[CrossCheck], names: Iterable[str]) -> None:
        super().__init__(checks)
        self.names = list(names)

    @property
    def ok(self) -> bool:
        """Whether all solutions are right."""
        return all(check.ok for check in self)

    def __repr__(self) -> str:
        right = sum(check.ok for check in self)
        wrong = len(self) - right
        return f"<CrossChecks of {counted(len(self), 'solution')}: {right:,} ok, {wrong:,} failed>"

    def summary(self) -> str:
        """Return the findings as lines of text: how many are right, and the faults of the first
        that are not.
        """
        failed = [
            (name, check) for name, check in zip(self.names, self, strict=True) if not check.ok
        ]
        verdict = "FAILED" if failed else "ok"
        lines = [
            f"{verdict}: {counted(len(self), 'solution')}, {len(failed):,} failed",
            f"largest global error: {max(check.max_error_x for check in self):.2e} in x, "
            f"{max(check.max_error_v for check in self):.2e} in v",
        ]
        totals = ", ".join(
            f"{sum(len(getattr(check, name)) for check in self):,} {name}" for name in EVENT_LISTS
        )
        lines.append(f"events: {totals}")
        for name, check in failed[:MOST_LISTED]:
            lines.append(f"{name}: {_failure_text(check)}")
        if len(failed) > MOST_LISTED:
            lines.append(f"and {len(failed) - MOST_LISTED:,} more that failed")
        notes = dict.fromkeys(note for check in self for note in check.notes)
        return "\n".join([*lines, *(f"note: {note}" for note in list(notes)[:MOST_LISTED])])

    def as_dict(self) -> Record:
        """Return the findings as plain values, without the samples."""
        checks = [
            {"name": name, **check.as_dict()} for name, check in zip(self.names, self, strict=True)
        ]
        return {"ok": self.ok, "solutions": len(self), "checks": checks}

    def columns(self) -> dict[str, np.ndarray]:
        """Return the findings as columns, a row for each solution."""
        first = [check.first_wrong for check in self]
        rows: Record = {"solution": self.names, "ok": [check.ok for check in self]}
        rows["samples"] = [len(check.t) for check in self]
        rows |= {
            "t_first": [check.t[0] for check in self],
            "t_last": [check.t[-1] for check in self],
        }
        rows |= {
            name: [getattr(check, name) for check in self]
            for name in ("max_error_x", "max_error_v")
        }
        for i, name in enumerate(("max_defect_x", "max_defect_v")):
            rows[name] = [np.max(np.abs(check.defects[:, i])) for check in self]
        rows |= {
            name: [len(getattr(check, name)) for check in self]
            for name in ("wrong_steps", *EVENT_LISTS)
        }
        rows["compared_until"] = [check.compared_until for check in self]
        rows["first_wrong_t"] = [fault.t if fault else np.nan for fault in first]
        rows["reason"] = [fault.reason if fault else "" for fault in first]
        return {name: np.array(column) for name, column in rows.items()}

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row for each solution.

        MissingExtraError if pandas is not installed.
        """
        return imported("pandas").DataFrame(self.columns())

    def to_xarray(self) -> Any:
        """Return a Dataset over `solution`; MissingExtraError if xarray is not installed."""
        columns = self.columns()
        names = columns.pop("solution")
        data: Record = {name: (("solution",), column) for name, column in columns.items()}
        return imported("xarray").Dataset(data, coords={"solution": names})


def _failure_text(check: CrossCheck) -> str:
    """Return in one line what is wrong with one of several solutions."""
    counts = (
        f"{len(check.wrong_steps)} wrong steps, {len(check.missed)} missed, "
        f"{len(check.invented)} invented"
    )
    fault = check.first_wrong
    first = "no step is wrong"
    if fault:
        first = f"first wrong step at t = {fault.t:.10g}: {fault.reason}"
    return "; ".join(filter(None, (counts, first, check.wrong_start, check.early_end)))


def _judged(task: Callable[[Samples], CheckTask], name: str, samples: Samples) -> CrossCheck:
    """Judge samples by the `CheckTask` that `task` makes of them.

    Add the solution's `name` to a ParameterError.
    """
    try:
        return shown(judge(task(samples)))
    except ParameterError as error:
        what = f"{error.allowed} (solution {name})"
        raise ParameterError(error.name, error.value, what) from None


def check_all(
    task: Callable[[Samples], CheckTask],
    solutions: Sequence[Samples],
    workers: int,
    progress: Progress | None,
) -> CrossChecks:
    """Judge each of `solutions` by the `CheckTask` that `task` makes of it, in `workers` processes.

    Return all in order.
    """
    count = min(workers, len(solutions))
    total = len(solutions)
    names = [samples.name or str(i) for i, samples in enumerate(solutions)]
    checks = list[CrossCheck]()
    with (
        reporting(progress or False, 0, total, "check", "solutions") as report,
        ExitStack() as stack,
    ):
        in_turn: Any = map
        if count > 1:
            in_turn = stack.enter_context(_processes(count)).map
        for check in in_turn(partial(_judged, task), names, solutions):
            checks.append(check)
            report(len(checks), total)
    return CrossChecks(checks, names)


@contextmanager
def _processes(count: int) -> Iterator[Any]:
    """Open a pool of processes."""
    # A process that is forked needs no main module that can be imported.
    forks = sys.platform == "linux" and "fork" in multiprocessing.get_all_start_methods()
    with warnings.catch_warnings():
        # of forking beside threads, which are idle
        warnings.simplefilter("ignore", DeprecationWarning)
        with process_pool(count, "fork" if forks else "spawn") as pool:
            yield pool
