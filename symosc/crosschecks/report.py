"""What a cross-check found: as values, as text and as plain data."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, is_dataclass
from functools import cached_property
from math import isnan
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.diagnosis import diagnose
from symosc.crosschecks.events import FoundEvent
from symosc.crosschecks.faults import REASONS, Fault
from symosc.crosschecks.matching import Match
from symosc.display.drawable import Drawable, Reportable
from symosc.simulation.trajectory import Event, Trajectory

EVENTS_LISTED = 5  # events of a kind in a summary


@dataclass(frozen=True, eq=False)
class CrossCheck(Drawable, Reportable):
    """How samples compare with the exact motion.

    Attributes
    ----------
    ok : bool
        No step or span is wrong, no event missed or invented, the global error within its limits, the start that of
        the scene, and the end not before that of the motion.
    max_error_x, max_error_v : float
        Largest global error: samples minus the exact motion from the same start.
    errors : (n, 2) array
        Global errors of x and v; NaN after the end of the exact motion (`compared_until`).
    limits : (n, 2) array
        How large they may be: the global tolerance in units of x and v, plus the rounding of the sample, and
        what the exact motion makes of that of the first sample.
    defects : (n - 1, 2) array
        Local errors: the exact motion from a sample over the step, minus the next sample.
    wrong_steps : int array
        Steps whose defect is larger than `allowed`.
    allowed : (n - 1, 2) array
        The tolerance in units of x and v, plus the rounding of the times, and of samples with few digits: that of the
        next sample, and what the exact motion makes of that of the sample before.
    wrong_spans : (m, 2) int array
        Spans of rounded samples, each from one sample to a later one, over which the exact motion leads elsewhere.
    matched : tuple of Match
        Exact events that the samples have too.
    missed : tuple of Event
        Exact events that wrong steps passed over, or that a given list does not have at their time.
    invented : tuple of FoundEvent
        Events of wrong steps, or of a given list, that the exact motion does not have at their time.
    unresolved : tuple of Event or FoundEvent
        Events on one side only, though each step is right. The samples are on a neighbouring path, within the global
        error, or the tolerance cannot tell whether there is such an event.
    decisions : tuple of Fault
        Wrong steps that stick, slip or pass where the exact motion does something else.
    faults : tuple of Fault
        Wrong steps with guesses why: the first 500 and those with a missed or invented event.
    first_wrong : Fault or None
        The first wrong step.
    first_switching : Fault or None
        The first wrong step at a belt: its reason is more than a local error.
    compared_until : float
        Where the exact motion ends: the last sample, or earlier if its status is "undecidable".
    tolerance, global_tolerance : float
    scales : tuple of two floats
        Units of x and v for the tolerances: the largest of the exact motion.
    rounded : dict
        How the columns "t", "x", "v" and the times of the list, "events", were rounded, such as "6 decimals".
    notes : tuple of str
    modes : (n,) int array
        What the samples do, by the codes of `symosc.model.MODE_NAMES`; 0 where they only pass or touch a belt.
    t, x, v : (n,) arrays
    trajectory : Trajectory
        The exact motion.
    own_start : tuple of three floats or None
        Where the scene starts: t0, x0, v0; None if Parameters were given.
    wrong_start, early_end : str
        Where the solution starts if that is not where the scene does, and where it ends if that is before the motion
        does; "" if it is right or allowed.
    coarser : CrossCheck or None
        Verdict on every n-th sample, where the rounding hides in single steps what is wrong over spans of n.

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

    ok: bool
    max_error_x: float
    max_error_v: float
    errors: np.ndarray
    limits: np.ndarray
    defects: np.ndarray
    wrong_steps: np.ndarray
    wrong_spans: np.ndarray
    allowed: np.ndarray
    matched: tuple[Match, ...]
    missed: tuple[Event, ...]
    invented: tuple[FoundEvent, ...]
    unresolved: tuple[Event | FoundEvent, ...]
    decisions: tuple[Fault, ...]
    faults: tuple[Fault, ...]
    first_wrong: Fault | None
    first_switching: Fault | None
    compared_until: float
    tolerance: float
    global_tolerance: float
    scales: tuple[float, float]
    rounded: dict[str, str]
    notes: tuple[str, ...]
    modes: np.ndarray
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    trajectory: Trajectory
    own_start: tuple[float, float, float] | None = None
    _task: Any = None
    wrong_start: str = ""
    early_end: str = ""
    coarser: CrossCheck | None = None

    @cached_property
    def diagnosis(self) -> tuple[Diagnosis, ...]:
        """What is probably wrong, the likeliest first; worked out when it is first asked for."""
        return diagnose(self)

    @property
    def limits_there(self) -> tuple[float, float]:
        """Limits of the global errors of x and v where these are largest."""
        worst = np.nanargmax(np.abs(self.errors), axis=0)
        return float(self.limits[worst[0], 0]), float(self.limits[worst[1], 1])

    def __eq__(self, other: object) -> bool:
        """Whether all findings and samples are equal; NaN equals NaN."""
        return _same(self, other)

    __hash__ = None  # type: ignore[assignment]

    def summary(self) -> str:
        """Return the findings as lines of text."""
        worst = np.max(np.abs(self.defects), axis=0)
        lines = [
            f"{'ok' if self.ok else 'FAILED'}: {len(self.t)} samples, tolerance {self.tolerance:g} per step",
            f"largest defect of a step: {worst[0]:.2e} in x, {worst[1]:.2e} in v; "
            f"wrong steps: {len(self.wrong_steps)} of {len(self.defects)}",
            f"largest global error: {self.max_error_x:.2e} in x, {self.max_error_v:.2e} in v "
            f"(allowed there {self.limits_there[0]:.1e} and {self.limits_there[1]:.1e})",
            f"events: {len(self.matched)} matched, {len(self.missed)} missed, {len(self.invented)} invented, "
            f"{len(self.unresolved)} within the global error",
        ]
        lines += [f"wrong start: {self.wrong_start} (own_start=True, --own-start: allowed)"] if self.wrong_start else []
        lines += [f"early end: {self.early_end} (partial=True, --partial: allowed)"] if self.early_end else []
        beyond = np.flatnonzero(np.any(np.abs(self.errors) > self.limits, axis=1))
        if len(beyond):
            (x, v), limits, t = np.abs(self.errors[beyond[0]]), self.limits[beyond[0]], self.t[beyond[0]]
            where = f"first at t = {t:.10g} ({x:.1e} in x, {v:.1e} in v, allowed {limits[0]:.1e} and {limits[1]:.1e})"
            lines.append(f"global error beyond its limit: {len(beyond)} of {len(self.t)} samples, {where}")
        if len(self.wrong_spans):
            (first, last), times = self.wrong_spans[0].tolist(), self.t[self.wrong_spans[0]]
            where = f"first from t = {times[0]:.10g} to {times[1]:.10g}"
            lines.append(
                f"wrong over {last - first} steps, beyond the rounding: {len(self.wrong_spans)} spans, {where}"
            )
        if self.matched:
            late = max(self.matched, key=lambda match: abs(match.error))
            lines.append(f"largest error of an event's time: {abs(late.error):.2e} at t = {float(late.event.t):.10g}")
        for name, events in (("missed", self.missed), ("invented", self.invented)):
            for event in events[:EVENTS_LISTED]:
                on = f" on belt {event.boundary}" if event.boundary else ""
                lines.append(f"{name}: {event.kind}{on} at t = {float(event.t):.10g}")
            if len(events) > EVENTS_LISTED:
                lines.append(f"{name}: and {len(events) - EVENTS_LISTED} more")
        if self.first_wrong:
            lines.append(f"first wrong step: {_words(self.first_wrong)}")
        if self.first_switching and self.first_switching != self.first_wrong:
            lines.append(f"first wrong step at a belt: {_words(self.first_switching)}")
        for fault in self.decisions[:EVENTS_LISTED]:
            what = f"{fault.found} where {fault.expected} is right"
            lines.append(f"wrong decision: step {fault.step}, t = {fault.t_next:.10g}: {what}")
        if len(self.decisions) > EVENTS_LISTED:
            lines.append(f"wrong decision: and {len(self.decisions) - EVENTS_LISTED} more")
        lines += [f"diagnosis: {line}" for line in self._diagnosed()]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def _diagnosed(self) -> list[str]:
        """Return the diagnoses as lines; a note says already that samples are rounded."""
        lines = []
        for one in self.diagnosis:
            if one.cause != "precision":
                lines.append(f"{one.words} ({one.evidence})")
                lines += [f"or: {other.words} ({other.evidence})" for other in one.alternatives]
        return lines

    def as_dict(self) -> Record:
        """Return the findings as plain values, without the samples."""
        exact = ("t", "x", "v", "kind", "boundary", "source", "target")

        def plain(event: Event | FoundEvent) -> Record:
            if isinstance(event, FoundEvent):
                return asdict(event)
            return {name: getattr(event, name) for name in exact}

        def fault(item: Fault | None) -> Record | None:
            values = asdict(item) if item else {}
            return {name: None if value != value else value for name, value in values.items()} or None

        # JSON has no NaN: a step that cannot be decided has none.
        worst = [None if np.isnan(value) else float(value) for value in np.max(np.abs(self.defects), axis=0)]
        return {
            "ok": self.ok,
            "samples": len(self.t),
            "tolerance": self.tolerance,
            "global_tolerance": self.global_tolerance,
            "scales": list(self.scales),
            "max_error_x": self.max_error_x,
            "max_error_v": self.max_error_v,
            "allowed_error_x": self.limits_there[0],
            "allowed_error_v": self.limits_there[1],
            "wrong_start": self.wrong_start,
            "early_end": self.early_end,
            "max_defect_x": worst[0],
            "max_defect_v": worst[1],
            "wrong_steps": self.wrong_steps.tolist(),
            "wrong_spans": self.wrong_spans.tolist(),
            "matched": [{**plain(match.event), "found_t": match.t, "error": match.error} for match in self.matched],
            "missed": [plain(event) for event in self.missed],
            "invented": [plain(event) for event in self.invented],
            "unresolved": [plain(event) for event in self.unresolved],
            "decisions": [fault(item) for item in self.decisions],
            "first_wrong": fault(self.first_wrong),
            "first_switching": fault(self.first_switching),
            "compared_until": self.compared_until,
            "rounded": dict(self.rounded),
            "diagnosis": [asdict(one) for one in self.diagnosis],
            "notes": list(self.notes),
        }


def _same(one: Any, other: Any) -> bool:
    """Compare values of any depth; NaN equals NaN, arrays are compared as wholes."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    if isinstance(one, (tuple, list)):
        return len(one) == len(other) and all(map(_same, one, other))
    if is_dataclass(one):
        return all(_same(getattr(one, item.name), getattr(other, item.name)) for item in fields(one))
    if isinstance(one, Trajectory):
        return _same(list(vars(one).items()), list(vars(other).items()))
    return bool(one == other) or (isinstance(one, float) and isnan(one) and isnan(other))


def _words(fault: Fault) -> str:
    size = f"defect {fault.defect_x:.1e} in x, {fault.defect_v:.1e} in v"
    guess = f"{REASONS[fault.reason]} ({fault.words})"
    return f"{fault.step}, t = {fault.t:.10g} to {fault.t_next:.10g}, {size}; guess: {guess}"
