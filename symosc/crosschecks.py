"""Cross-checks of other people's solutions against the exact motion: step by step, event by event, and as a whole."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.model import Parameters
from symosc.sample_events import FoundEvent, Match, find_events, given_events, labels, match_events
from symosc.sample_files import checked, read_samples
from symosc.sample_steps import Steps, follow_steps
from symosc.scenes import Scene, load_scene
from symosc.simulation import simulate
from symosc.step_faults import REASONS, Fault, explain
from symosc.trajectory import Event, Trajectory

TOLERANCE = 1e-8
# Errors of many right steps may add up to this many tolerances.
GLOBAL_FACTOR = 1000.0
# While the exact motion sticks, samples this near to the belt (in units of velocity) are meant to be on it.
DRIFT = 1e-4
# Wrong steps that are looked at one by one.
MOST_FAULTS = 500
LISTED = 5  # events of a kind in a summary


@dataclass(frozen=True)
class CrossCheck:
    """How samples compare with the exact motion.

    Attributes
    ----------
    ok : bool
        No step is wrong, no event missed or invented, and the global error within its tolerance.
    max_error_x, max_error_v : float
        Largest global error: samples minus the exact motion from the same start.
    errors : (n, 2) array
        Global errors of x and v; NaN after the end of the exact motion (`compared_until`).
    defects : (n - 1, 2) array
        Local errors: the exact motion from a sample over the step, minus the next sample.
    wrong_steps : int array
        Steps whose defect is larger than `allowed`.
    allowed : (n - 1, 2) array
        The tolerance in units of x and v, plus the rounding of the times.
    matched : tuple of Match
        Exact events that the samples have too.
    missed : tuple of Event
        Exact events that wrong steps passed over, or that a given list lacks.
    invented : tuple of FoundEvent
        Events of wrong steps that the exact motion does not have.
    unresolved : tuple of Event or FoundEvent
        Events on one side only, where each step is right: the samples are on a neighbouring path, within global error.
    decisions : tuple of Fault
        Wrong steps that stick, slip or pass where the exact motion does something else.
    faults : tuple of Fault
        Wrong steps with guesses why: the first 500 and those with a missed or invented event.
    first_wrong : Fault or None
        The first wrong step.
    first_switching : Fault or None
        The first wrong step that has to do with a belt: more than a local error.
    compared_until : float
        Where the exact motion ends: the last sample, or earlier if its status is "undecidable".
    tolerance, global_tolerance : float
    scales : tuple of two floats
        Units of x and v for the tolerances: the largest of the exact motion.
    notes : tuple of str
    modes : (n,) int array
        What the samples do, by the codes of `symosc.model.MODE_NAMES`; 0 where they only pass or touch a belt.
    t, x, v : (n,) arrays
    trajectory : Trajectory
        The exact motion.
    """

    ok: bool
    max_error_x: float
    max_error_v: float
    errors: np.ndarray
    defects: np.ndarray
    wrong_steps: np.ndarray
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
    notes: tuple[str, ...]
    modes: np.ndarray
    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    trajectory: Trajectory

    def summary(self) -> str:
        """Return the findings as lines of text."""
        worst = np.max(np.abs(self.defects), axis=0)
        lines = [
            f"{'ok' if self.ok else 'FAILED'}: {len(self.t)} samples, tolerance {self.tolerance:g} per step",
            f"largest defect of a step: {worst[0]:.2e} in x, {worst[1]:.2e} in v; "
            f"wrong steps: {len(self.wrong_steps)} of {len(self.defects)}",
            f"largest global error: {self.max_error_x:.2e} in x, {self.max_error_v:.2e} in v "
            f"(allowed {self.global_tolerance * self.scales[0]:.1e} and {self.global_tolerance * self.scales[1]:.1e})",
            f"events: {len(self.matched)} matched, {len(self.missed)} missed, {len(self.invented)} invented, "
            f"{len(self.unresolved)} within the global error",
        ]
        if self.matched:
            late = max(self.matched, key=lambda match: abs(match.error))
            lines.append(f"largest error of an event's time: {abs(late.error):.2e} at t = {float(late.event.t):.10g}")
        for name, events in (("missed", self.missed), ("invented", self.invented)):
            for event in events[:LISTED]:
                on = f" on belt {event.boundary}" if event.boundary else ""
                lines.append(f"{name}: {event.kind}{on} at t = {float(event.t):.10g}")
            if len(events) > LISTED:
                lines.append(f"{name}: and {len(events) - LISTED} more")
        if self.first_wrong:
            lines.append(f"first wrong step: {_words(self.first_wrong)}")
        if self.first_switching and self.first_switching != self.first_wrong:
            lines.append(f"first wrong step at a belt: {_words(self.first_switching)}")
        for fault in self.decisions[:LISTED]:
            what = f"{fault.found} where {fault.expected} is right"
            lines.append(f"wrong decision: step {fault.step}, t = {fault.t_next:.10g}: {what}")
        if len(self.decisions) > LISTED:
            lines.append(f"wrong decision: and {len(self.decisions) - LISTED} more")
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def as_dict(self) -> dict[str, Any]:
        """Return the findings as plain values, without the samples."""
        exact = ("t", "x", "v", "kind", "boundary", "source", "target")

        def plain(event: Event | FoundEvent) -> dict[str, Any]:
            if isinstance(event, FoundEvent):
                return asdict(event)
            return {name: getattr(event, name) for name in exact}

        def fault(item: Fault | None) -> dict[str, Any] | None:
            return asdict(item) if item else None

        worst = [None if np.isnan(value) else float(value) for value in np.max(np.abs(self.defects), axis=0)]
        return {
            "ok": self.ok,
            "samples": len(self.t),
            "tolerance": self.tolerance,
            "global_tolerance": self.global_tolerance,
            "scales": list(self.scales),
            "max_error_x": self.max_error_x,
            "max_error_v": self.max_error_v,
            "max_defect_x": worst[0],
            "max_defect_v": worst[1],
            "wrong_steps": self.wrong_steps.tolist(),
            "matched": [{**plain(match.event), "found_t": match.t, "error": match.error} for match in self.matched],
            "missed": [plain(event) for event in self.missed],
            "invented": [plain(event) for event in self.invented],
            "unresolved": [plain(event) for event in self.unresolved],
            "decisions": [fault(item) for item in self.decisions],
            "first_wrong": fault(self.first_wrong),
            "first_switching": fault(self.first_switching),
            "compared_until": self.compared_until,
            "notes": list(self.notes),
        }


def crosscheck(
    scene: Scene | Parameters | str,
    t: Any,
    x: Any = None,
    v: Any = None,
    *,
    events: Iterable[tuple[float, str]] | None = None,
    tolerance: float = TOLERANCE,
    global_tolerance: float | None = None,
) -> CrossCheck:
    """Compare samples of somebody's solution with the exact motion.

    Parameters
    ----------
    scene : Scene, str or Parameters
        With a scene the exact motion starts where the scene does, if the first sample is there; else at the sample.
    t, x, v : array_like, shape (n,)
        Times, strictly increasing, positions and velocities. Or in place of `t` alone what
        `symosc.sample_files.read_samples` reads: a file, an OdeResult, a DataFrame and others.
    events : pairs (t, kind), optional
        The events that the solver reported; kind "cross", "stick", "slip" or "graze". Default: those that the samples
        show, and those inside steps that are right.
    tolerance : float
        Allowed defect of a step, relative to the largest |x| and |v| of the exact motion; v within it of a belt's speed
        is on the belt.
    global_tolerance : float, optional
        Allowed global error, likewise. Default: 1000 times `tolerance`.

    Returns
    -------
    CrossCheck

    Raises
    ------
    ParameterError
        If times repeat or are not sorted, a number is not finite, or lengths differ.
    """
    samples = read_samples(t) if x is None and v is None else checked(t, x, v, events)
    if x is None and v is None and events is not None:
        samples = checked(samples.t, samples.x, samples.v, events)
    tolerance = _positive("tolerance", tolerance)
    limit = GLOBAL_FACTOR * tolerance if global_tolerance is None else _positive("global_tolerance", global_tolerance)
    times = samples.t
    notes: list[str] = []
    trajectory = _exact(scene, samples.t, samples.x, samples.v, limit, notes)
    until = float(trajectory.t_end)
    inside = times <= until
    if not inside.all():
        notes.append(f"the exact motion ends at t = {until:.10g} ({trajectory.message}); later only steps are compared")
    errors = np.full((len(times), 2), np.nan)
    exact = trajectory(np.clip(times[inside], float(trajectory.t_start), until))
    errors[inside] = np.column_stack([samples.x[inside], samples.v[inside]]) - exact.T
    p = trajectory.parameters
    scales = _scales(p, exact)
    near = tolerance * scales[1]
    steps = follow_steps(p, times, samples.x, samples.v, near, scales)
    allowed = tolerance * scales + _rounding(steps, scales)
    sizes = np.max(np.abs(steps.defects) / allowed, axis=1)
    wrong = ~(sizes <= 1.0)
    label = labels(steps, near, max(near, DRIFT * scales[1]))
    known = samples.events is not None
    found, modes = find_events(steps, label, wrong)
    found = given_events(steps, samples.events or ()) if known else found
    # Where the exact motion has ended there is nothing to match.
    found = [event for event in found if float(times[event.step]) <= until]
    matched, missed, invented, unresolved = match_events(steps, label, wrong, trajectory.events, found, known)
    wrong_steps = np.flatnonzero(wrong)
    odd = {event.step for event in invented} | {int(np.searchsorted(times, float(event.t))) - 1 for event in missed}
    odd |= set(np.flatnonzero(wrong & (modes[1:] > 0) & (steps.last != modes[1:]))[:MOST_FAULTS].tolist())
    chosen = sorted(set(wrong_steps[:MOST_FAULTS].tolist()) | {i for i in odd if 0 <= i < len(wrong) and wrong[i]})
    faults = tuple(explain(steps, i, modes, sizes, allowed, near) for i in chosen)
    greatest = [float(value) for value in np.nanmax(np.abs(errors), axis=0)]
    within = all(value <= limit * scale for value, scale in zip(greatest, scales, strict=True))
    if not within and not len(wrong_steps):
        notes.append("every step is right, but their errors add up, or the start is another one")
    return CrossCheck(
        ok=not len(wrong_steps) and not missed and not invented and within,
        max_error_x=greatest[0],
        max_error_v=greatest[1],
        errors=errors,
        defects=steps.defects,
        wrong_steps=wrong_steps,
        allowed=allowed,
        matched=tuple(matched),
        missed=tuple(missed),
        invented=tuple(invented),
        unresolved=tuple(unresolved),
        decisions=tuple(fault for fault in faults if fault.wrong_decision),
        faults=faults,
        first_wrong=faults[0] if faults else None,
        first_switching=next((fault for fault in faults if fault.reason not in ("local error", "outlier")), None),
        compared_until=min(until, float(times[-1])),
        tolerance=tolerance,
        global_tolerance=limit,
        scales=(float(scales[0]), float(scales[1])),
        notes=tuple(notes),
        modes=modes,
        t=times,
        x=samples.x,
        v=samples.v,
        trajectory=trajectory,
    )


def _positive(name: str, value: Any) -> float:
    number = float(read_exact(name, value))
    if not number > 0.0:
        raise ParameterError(name, value, "must be > 0")
    return number


def _exact(scene: Any, t: Any, x: Any, v: Any, limit: float, notes: list[str]) -> Trajectory:
    """Return the exact motion from the scene's start if the first sample is there, else from the first sample."""
    if isinstance(scene, str):
        scene = load_scene(scene)
    t_end = float(t[-1])
    if isinstance(scene, Parameters):
        return simulate(scene, t0=float(t[0]), x0=float(x[0]), v0=float(v[0]), t_end=t_end)
    if not isinstance(scene, Scene):
        raise ParameterError("scene", scene, "give a Scene, the name of a scene, or Parameters")
    start: dict[str, Any] = {"t0": float(t[0]), "x0": float(x[0]), "v0": float(v[0])}
    own = {name: float(getattr(scene, name)) for name in start}
    there = all(abs(start[name] - own[name]) <= limit * max(1.0, abs(own[name])) for name in start)
    if there and abs(start["t0"] - own["t0"]) <= 4.0 * np.spacing(abs(own["t0"])):
        return simulate(scene, t_end=t_end)
    shown = ", ".join(f"{name} = {value:.10g}" for name, value in start.items())
    notes.append(f"the exact motion starts at the first sample ({shown}), which is not {scene.name}'s start")
    return simulate(scene, t_end=t_end, **start)


def _scales(p: Parameters, exact: np.ndarray) -> np.ndarray:
    """Return units of x and v: the largest of the exact motion, and nothing less than the belts give."""
    reach = np.max(np.abs(exact), axis=1)
    speed = max(float(reach[1]), abs(float(p.v1)), abs(float(p.v2)))
    rate = max(float(p.Omega), float(p.k / p.m) ** 0.5)
    return np.array([max(float(reach[0]), speed / rate), speed])


def _rounding(steps: Steps, scales: np.ndarray) -> np.ndarray:
    """Return what the rounding of the times and of the samples makes of x and v."""
    K = steps.K
    push = max(abs(K.A1), abs(K.A2), abs(K.A3)) + abs(K.f0) + K.w0sq * scales[0] + K.cm * scales[1]
    ticks = 2.0 * np.spacing(np.maximum(np.abs(steps.t[1:]), np.abs(steps.t[:-1])))
    return np.outer(ticks, [scales[1], push]) + 8.0 * np.finfo(float).eps * scales


def _words(fault: Fault) -> str:
    size = f"defect {fault.defect_x:.1e} in x, {fault.defect_v:.1e} in v"
    guess = f"{REASONS[fault.reason]} ({fault.words})"
    return f"{fault.step}, t = {fault.t:.10g} to {fault.t_next:.10g}, {size}; guess: {guess}"
