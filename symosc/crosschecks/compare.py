"""Cross-checks of other people's solutions against the exact motion: step by step, event by event, and as a whole."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import Record
from symosc.crosschecks.allowed import carried, looseness, rounding_of_steps
from symosc.crosschecks.events import WINDOW, FoundEvent, find_events, given_events, labels
from symosc.crosschecks.faults import Fault, explain
from symosc.crosschecks.functions import dense_note
from symosc.crosschecks.given import given_solutions
from symosc.crosschecks.many import CrossChecks, check_all
from symosc.crosschecks.matching import Match, Matcher, Matching
from symosc.crosschecks.other_models import own_start
from symosc.crosschecks.reach import Reach
from symosc.crosschecks.report import CrossCheck
from symosc.crosschecks.rounding import Rounding, find_rounding
from symosc.crosschecks.samples import Samples, check_joints
from symosc.crosschecks.solver_times import with_times
from symosc.crosschecks.steps import ExactSteps, follow_steps
from symosc.crosschecks.velocities import with_velocities
from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.model import Parameters
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event, Trajectory
from symosc.simulation.workers import Progress, read_workers

__all__ = ["CrossCheck", "CrossChecks", "FoundEvent", "Match", "crosscheck"]

STEP_TOLERANCE = 1e-8
# Errors of many right steps may add up to this many tolerances.
GLOBAL_FACTOR = 1000.0
# While the exact motion sticks, samples this near to the belt (in units of velocity) are meant to be on it.
DRIFT = 1e-4
# Two samples of one time may differ by this part of the largest |x| and |v|: pieces joined at an event.
SAMPLE_JUMP = 1e-4
# Wrong steps that are looked at one by one.
MOST_FAULTS = 500
# The exact motion is followed for this many events.
FEW_EVENTS, EVENTS_PER_SAMPLE = 2_000, 10
ADDED_UP = "every step is right, but their errors add up, or the start is another one"


def crosscheck(
    scene: Scene | Parameters | str,
    t: object,
    x: ArrayLike | Callable[..., Any] | None = None,
    v: ArrayLike | None = None,
    *,
    events: Iterable[tuple[float, str]] | None = None,
    tolerance: float = STEP_TOLERANCE,
    global_tolerance: float | None = None,
    columns: Mapping[str, str | None] | None = None,
    workers: int | None = 1,
    progress: Progress | bool | None = None,
) -> Any:
    """Compare somebody's solution, or several, with the exact motion.

    Parameters
    ----------
    scene : Scene, str or Parameters
        With a scene the exact motion starts where the scene does, if the first sample is there; else at the sample.
    t, x, v : array_like, shape (n,)
        Times, which may come twice where two pieces are joined, positions and velocities. Without `v` it is computed
        from `x`, and a note says so. `x` may be a function t -> (x, v). Or give `t` alone: whatever
        `symosc.crosschecks.files.read_solutions` reads (a file, an OdeResult, a DataFrame, a function, ...), or a list
        of such: pieces of one solution, each beginning where one ends, or several solutions.
    events : pairs (t, kind), optional
        What the solver reported, in order of time; kind "cross", "stick", "slip" or "graze". Each exact event must be
        there once, as near in time as the tolerance and the errors of the samples let it; a graze, or a start on a
        belt, may be left out. Default: the events that the samples show, and those inside steps that are right.
    tolerance : float
        Allowed defect of a step, relative to the largest |x| and |v| of the exact motion. A sample whose v differs
        from a belt's speed by less is on the belt. Samples with few digits (3 decimals, single precision) that fail
        are judged once more at that precision; `rounded` and a note say so.
    global_tolerance : float, optional
        Allowed global error, relative to the same values. Default: 1000 times `tolerance`.
    columns : mapping, optional
        What the columns t, x, v and id of a file or a table are called.
    workers, progress : int, callable or True, optional
        Processes for several solutions (None: all cores); what is called with the numbers of those done and of all.

    Returns
    -------
    CrossCheck, or CrossChecks (a list of these) for several solutions

    Raises
    ------
    ParameterError
        If something is no solution, times are not sorted, or one is repeated with another state.

    Examples
    --------
    >>> from symosc import crosscheck, simulate
    >>> crosscheck("fig5", simulate("fig5", t_end=7)).ok
    True
    """
    judge = partial(judged, *_limits(scene, tolerance, global_tolerance))
    found = given_solutions(judge.args[0], (t, x, v), events, columns)
    read_workers(workers)
    return judge(found[0]) if len(found) == 1 else check_all(judge, found, workers, progress)


def _limits(
    scene: object, tolerance: object, global_tolerance: object | None
) -> tuple[Scene | Parameters, float, float]:
    """Return the problem and the tolerances as numbers."""
    allowed = _positive("tolerance", tolerance)
    limit = GLOBAL_FACTOR * allowed if global_tolerance is None else _positive("global_tolerance", global_tolerance)
    scene = load_scene(scene) if isinstance(scene, str) else scene
    if not isinstance(scene, (Scene, Parameters)):
        raise ParameterError("scene", scene, "give a Scene, the name of a scene, or Parameters")
    return scene, allowed, limit


def judged(scene: Scene | Parameters, allowed: float, limit: float, samples: Samples) -> CrossCheck:
    """Return the verdict on one solution; velocities that were not given are computed."""
    p = scene if isinstance(scene, Parameters) else scene.parameters
    if samples.lacks_v:
        samples = with_velocities(samples, scene, allowed)
    return Task(scene, p, samples, allowed, limit, find_rounding(samples, (float(p.v1), float(p.v2)))).verdict()


@dataclass(frozen=True)
class Task:
    """Samples to be judged: what, against what, and how strictly; see `crosscheck`."""

    scene: Scene | Parameters
    parameters: Parameters
    samples: Samples
    tolerance: float
    limit: float
    rounding: Rounding

    def verdict(self) -> CrossCheck:
        """Judge the samples as numbers with all digits; if they fail and have few, once more at their precision."""
        samples, rounding = self.samples, self.rounding
        units, listed = rounding.units(len(samples.t)), rounding.of_events(len(samples.events or ()))
        check_joints(samples, max(SAMPLE_JUMP, self.tolerance), *looseness(self.parameters, samples, units).T)
        result = self.judge(np.broadcast_to(0.0, units.shape), np.zeros_like(listed))
        return result if result.ok or not rounding.texts else self.judge(units, listed)

    def judge(self, units: np.ndarray, listed: np.ndarray) -> CrossCheck:
        """Compare the samples with the exact motion.

        Parameters
        ----------
        units : (3, n) array
            How far t, x and v of the samples are rounded.
        listed : array
            How far the times of the list of events are rounded.
        """
        samples, p, notes = self.samples, self.parameters, self._notes(units, listed)
        loose = looseness(p, samples, units)
        start = _start(self.scene, samples, self.limit, units[:, 0], notes)
        trajectory = self._simulate(float(samples.t[-1]), start)
        errors, scales = _global_errors(trajectory, samples, notes)
        limits = self.limit * scales + GLOBAL_FACTOR * np.max(loose, axis=0)
        near = self.tolerance * scales[1] + loose[:, 1]
        steps = follow_steps(p, samples.t, samples.x, samples.v, near, scales)
        allowed = rounding_of_steps(steps, scales) + self.tolerance * scales
        allowed += carried(steps, loose, near, scales)
        sizes = np.maximum(*(np.abs(steps.defects[:, i]) / allowed[:, i] for i in (0, 1)))
        wrong = ~(sizes <= 1.0)
        label = labels(steps, near, np.maximum(near, DRIFT * scales[1]))
        found, modes = find_events(steps, label, wrong)
        reach = Reach(steps, _within(errors, limits) + loose, self.tolerance * float(scales[1]), self.tolerance, listed)
        matching = self._match(trajectory, start, found, reach, label, wrong)
        faults = _faults(steps, modes, sizes, allowed, near, matching)
        disorder = _disorder(samples.events or (), notes)
        greatest = [float(np.nanmax(np.abs(column))) for column in errors.T]
        within = bool(np.all(greatest <= limits))
        notes += [ADDED_UP] if not within and not wrong.any() else []
        return CrossCheck(
            ok=within and not (wrong.any() or matching.missed or matching.invented or disorder),
            max_error_x=greatest[0],
            max_error_v=greatest[1],
            errors=errors,
            defects=steps.defects,
            wrong_steps=np.flatnonzero(wrong),
            allowed=allowed,
            matched=tuple(matching.matched),
            missed=tuple(matching.missed),
            invented=tuple(matching.invented),
            unresolved=tuple(matching.unresolved),
            decisions=tuple(fault for fault in faults if fault.wrong_decision),
            faults=faults,
            first_wrong=faults[0] if faults else None,
            first_switching=next((fault for fault in faults if fault.reason not in ("local error", "outlier")), None),
            compared_until=min(float(trajectory.t_end), float(samples.t[-1])),
            tolerance=self.tolerance,
            global_tolerance=self.limit,
            scales=(float(scales[0]), float(scales[1])),
            rounded=self.rounding.texts,
            notes=(*notes, *matching.notes),
            modes=modes,
            t=samples.t,
            x=samples.x,
            v=samples.v,
            trajectory=trajectory,
            own_start=own_start(self.scene),
        )

    def _notes(self, units: np.ndarray, listed: np.ndarray) -> list[str]:
        columns = ", ".join(f"{name} to {text}" for name, text in self.rounding.texts.items())
        at_it = "; they are judged at that precision" if np.any(units) or np.any(listed) else ""
        return [*self.samples.notes, *([f"the samples are rounded: {columns}{at_it}"] if columns else [])]

    def _match(
        self,
        trajectory: Trajectory,
        start: Record,
        found: list[FoundEvent],
        reach: Reach,
        label: np.ndarray,
        wrong: np.ndarray,
    ) -> Matching:
        events, until, times = self.samples.events, float(trajectory.t_end), list[float]()
        if events and not any(kind for _, kind in events):  # a solver's list of times
            times, events = [t for t, _ in events], None
        ended = until < self.samples.t[-1]  # where the exact motion has ended there is nothing to match
        if events is None:
            found = [event for event in found if float(self.samples.t[event.step]) <= until]
            matcher = Matcher(trajectory, trajectory.events, found, False, reach, label, wrong)
            return with_times(matcher.match(), matcher, [t for t in times if t <= until])
        order = sorted((i for i, (t, _) in enumerate(events) if not ended or t <= until), key=lambda i: events[i][0])
        pairs, reach = [events[i] for i in order], replace(reach, listed=reach.listed[order])
        exact = [*trajectory.events, *self._later_events(trajectory, start, pairs)]
        return Matcher(trajectory, exact, given_events(reach.steps, pairs), True, reach, label, wrong).match()

    def _later_events(self, trajectory: Trajectory, start: Record, pairs: Sequence[tuple[float, str]]) -> list[Event]:
        """Return exact events just after the last sample, if the list has events about there."""
        t_end, span = float(trajectory.t_end), WINDOW * 2.0 * np.pi / float(self.parameters.Omega)
        if trajectory.status != "t_end" or not pairs or pairs[-1][0] < t_end - span:
            return []
        longer = self._simulate(t_end + span, start)
        return list(longer.events[len(trajectory.events) :])

    def _simulate(self, t_end: float, start: Record) -> Trajectory:
        # So many more events than samples cannot be meant.
        most = FEW_EVENTS + EVENTS_PER_SAMPLE * len(self.samples.t)
        return simulate(self.scene, t_end=t_end, max_events=most, **start)


def _positive(name: str, value: object) -> float:
    number = float(read_exact(name, value))
    if not number > 0.0:
        raise ParameterError(name, value, "must be > 0")
    return number


def _start(scene: Scene | Parameters, samples: Samples, limit: float, units: np.ndarray, notes: list[str]) -> Record:
    """Return where the exact motion starts: at the first sample; {} for the scene's own start, if the sample is there.

    The scene's may have more digits than the sample.
    """
    start = {"t0": float(samples.t[0]), "x0": float(samples.x[0]), "v0": float(samples.v[0])}
    if isinstance(scene, Parameters):
        return start
    own = {name: float(getattr(scene, name)) for name in start}
    slack = {name: limit * max(1.0, abs(own[name])) for name in start}
    slack["t0"] = min(slack["t0"], 4.0 * float(np.spacing(abs(own["t0"]))))
    rounded = dict(zip(start, 2.0 * units, strict=True))
    if all(abs(start[name] - own[name]) <= slack[name] + rounded[name] for name in start):
        return {}
    shown = ", ".join(f"{name} = {value:.10g}" for name, value in start.items())
    notes.append(f"the exact motion starts at the first sample ({shown}), which is not {scene.name}'s start")
    return start


def _global_errors(trajectory: Trajectory, samples: Samples, notes: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the samples minus the exact motion, shape (n, 2), NaN after its end; and the units of x and v."""
    times, until = samples.t, float(trajectory.t_end)
    inside = times <= until
    if not inside.all():
        notes.append(f"the exact motion ends at t = {until:.10g} ({trajectory.message}); later only steps are compared")
    exact = trajectory(np.clip(times[inside], float(trajectory.t_start), until))
    scales, errors = _scales(trajectory.parameters, exact), np.full((2, len(times)), np.nan)
    for row, values, given in zip(errors, exact, (samples.x, samples.v), strict=True):
        row[inside] = given[inside] - values
    if samples.dense is not None:
        notes.append(dense_note(trajectory, samples.dense, until))
    return errors.T, scales


def _disorder(events: Sequence[tuple[float, str]], notes: list[str]) -> bool:
    """Tell whether a list of events is not in order of time, and note where."""
    for (before, _), (time, kind) in pairwise(events):
        if time < before:
            notes.append(f"the list is not in order of time: {kind} at t = {time:.10g} comes after t = {before:.10g}")
            return True
    return False


def _faults(
    steps: ExactSteps, modes: np.ndarray, sizes: np.ndarray, allowed: np.ndarray, near: np.ndarray, matching: Matching
) -> tuple[Fault, ...]:
    """Return the first wrong steps with guesses why, and all wrong ones with a missed or invented event."""
    wrong = ~(sizes <= 1.0)
    odd = {event.step for event in matching.invented}
    odd |= {int(np.searchsorted(steps.t, float(event.t))) - 1 for event in matching.missed}
    odd |= set(np.flatnonzero(wrong & (modes[1:] > 0) & (steps.last != modes[1:]))[:MOST_FAULTS].tolist())
    first = np.flatnonzero(wrong)[:MOST_FAULTS].tolist()
    chosen = sorted(set(first) | {i for i in odd if 0 <= i < len(wrong) and wrong[i]})
    return explain(steps, chosen, modes, sizes, allowed, near)


def _scales(p: Parameters, exact: np.ndarray) -> np.ndarray:
    """Return units of x and v: the largest of the exact motion, and nothing less than the belts give."""
    reach = np.array([np.max(np.abs(row)) for row in exact])
    speed = max(float(reach[1]), abs(float(p.v1)), abs(float(p.v2)))
    rate = max(float(p.Omega), float(p.k / p.m) ** 0.5)
    return np.array([max(float(reach[0]), speed / rate), speed])


def _within(errors: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Return the sizes of the errors, as far as they are allowed; 0 where there is nothing to compare."""
    sizes = np.abs(errors)
    return np.fmin(sizes, limits, where=~np.isnan(sizes), out=np.zeros_like(sizes))
