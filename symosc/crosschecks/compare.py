"""Cross-checks of other people's solutions against the exact motion: step by step, event by event, and as a whole."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import Record
from symosc.crosschecks.events import WINDOW, FoundEvent, find_events, given_events, labels
from symosc.crosschecks.faults import Fault, explain
from symosc.crosschecks.files import read_samples
from symosc.crosschecks.matching import Match, Matcher, Matching
from symosc.crosschecks.other_models import own_start
from symosc.crosschecks.reach import Reach
from symosc.crosschecks.report import CrossCheck
from symosc.crosschecks.rounding import Rounding, find_rounding
from symosc.crosschecks.samples import Samples, check_joints, checked
from symosc.crosschecks.steps import ExactSteps, follow_steps
from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.model import Parameters
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event, Trajectory

__all__ = ["CrossCheck", "FoundEvent", "Match", "crosscheck"]

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


def crosscheck(
    scene: Scene | Parameters | str,
    t: object,
    x: ArrayLike | None = None,
    v: ArrayLike | None = None,
    *,
    events: Iterable[tuple[float, str]] | None = None,
    tolerance: float = STEP_TOLERANCE,
    global_tolerance: float | None = None,
) -> CrossCheck:
    """Compare samples of somebody's solution with the exact motion.

    Parameters
    ----------
    scene : Scene, str or Parameters
        With a scene the exact motion starts where the scene does, if the first sample is there; else at the sample.
    t, x, v : array_like, shape (n,)
        Increasing times, positions and velocities. A time may come twice where two pieces are joined. Or give `t`
        alone: anything that `symosc.crosschecks.files.read_samples` reads (a file, an OdeResult, a DataFrame, ...).
    events : pairs (t, kind), optional
        The events that the solver reported, in order of time; kind "cross", "stick", "slip" or "graze". Each exact
        event must be there once; a graze may be left out, because nothing changes there. How near in time it must be
        follows from the tolerance and the errors of the samples. A start on a belt may be listed. Default: the events
        that the samples show, and those inside steps that are right.
    tolerance : float
        Allowed defect of a step, relative to the largest |x| and |v| of the exact motion. A sample whose v differs
        from a belt's speed by less is on the belt.
    global_tolerance : float, optional
        Allowed global error, relative to the same values. Default: 1000 times `tolerance`.

    Returns
    -------
    CrossCheck

    Raises
    ------
    ParameterError
        If times or events are not sorted, a number is not finite, lengths differ, or a time is repeated with another
        state.

    Notes
    -----
    Some samples have few digits (3 decimals, single precision). If they fail, they are judged once more at that
    precision: their rounding is added to what is allowed. `rounded` and a note say so.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> crosscheck("fig5", t, x, v).ok
    True
    """
    return _task(scene, _read(t, x, v, events), tolerance, global_tolerance).verdict()


def _read(t: object, x: object, v: object, events: object) -> Samples:
    if x is not None or v is not None:
        return checked(t, x, v, events)
    samples = read_samples(t)
    return samples if events is None else checked(samples.t, samples.x, samples.v, events)


def _task(
    scene: Scene | Parameters | str, samples: Samples, tolerance: object, global_tolerance: object | None
) -> Task:
    """Return what is to be judged, the arguments of `crosscheck` read."""
    allowed = _positive("tolerance", tolerance)
    limit = GLOBAL_FACTOR * allowed if global_tolerance is None else _positive("global_tolerance", global_tolerance)
    scene = load_scene(scene) if isinstance(scene, str) else scene
    if not isinstance(scene, (Scene, Parameters)):
        raise ParameterError("scene", scene, "give a Scene, the name of a scene, or Parameters")
    p = scene if isinstance(scene, Parameters) else scene.parameters
    return Task(scene, p, samples, allowed, limit, find_rounding(samples, (float(p.v1), float(p.v2))))


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
        check_joints(samples, max(SAMPLE_JUMP, self.tolerance), *_loose(self.parameters, samples, units).T)
        result = self.judge(np.zeros_like(units), np.zeros_like(listed))
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
        samples, notes, p = self.samples, self._rounding_notes(units, listed), self.parameters
        loose = _loose(p, samples, units)
        start = _start(self.scene, samples, self.limit, units[:, 0], notes)
        trajectory = self._simulate(float(samples.t[-1]), start)
        errors, scales = _global_errors(trajectory, samples, notes)
        limits = self.limit * scales + GLOBAL_FACTOR * np.max(loose, axis=0)
        near = self.tolerance * scales[1] + loose[:, 1]
        steps = follow_steps(p, samples.t, samples.x, samples.v, near, scales)
        allowed = self.tolerance * scales + _rounding(steps, scales) + _carried(steps, loose, near, scales)
        sizes = np.max(np.abs(steps.defects) / allowed, axis=1)
        wrong = ~(sizes <= 1.0)
        label = labels(steps, near, np.maximum(near, DRIFT * scales[1]))
        found, modes = find_events(steps, label, wrong)
        reach = Reach(steps, _within(errors, limits) + loose, self.tolerance * float(scales[1]), self.tolerance, listed)
        matching = self._match(trajectory, start, found, reach, label, wrong)
        faults = _faults(steps, modes, sizes, allowed, near, matching)
        disorder = _disorder(samples.events or (), notes)
        greatest = [float(value) for value in np.nanmax(np.abs(errors), axis=0)]
        within = bool(np.all(greatest <= limits))
        if not within and not wrong.any():
            notes.append("every step is right, but their errors add up, or the start is another one")
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

    def _rounding_notes(self, units: np.ndarray, listed: np.ndarray) -> list[str]:
        columns = ", ".join(f"{name} to {text}" for name, text in self.rounding.texts.items())
        judged = "; they are judged at that precision" if np.any(units) or np.any(listed) else ""
        return [f"the samples are rounded: {columns}{judged}"] if columns else []

    def _match(
        self,
        trajectory: Trajectory,
        start: Record,
        found: list[FoundEvent],
        reach: Reach,
        label: np.ndarray,
        wrong: np.ndarray,
    ) -> Matching:
        events, until = self.samples.events, float(trajectory.t_end)
        ended = until < self.samples.t[-1]  # where the exact motion has ended there is nothing to match
        if events is None:
            found = [event for event in found if float(self.samples.t[event.step]) <= until]
            return Matcher(trajectory, trajectory.events, found, False, reach, label, wrong).match()
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
    errors = np.full((len(times), 2), np.nan)
    exact = trajectory(np.clip(times[inside], float(trajectory.t_start), until))
    errors[inside] = np.column_stack([samples.x[inside], samples.v[inside]]) - exact.T
    return errors, _scales(trajectory.parameters, exact)


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
    reach = np.max(np.abs(exact), axis=1)
    speed = max(float(reach[1]), abs(float(p.v1)), abs(float(p.v2)))
    rate = max(float(p.Omega), float(p.k / p.m) ** 0.5)
    return np.array([max(float(reach[0]), speed / rate), speed])


def _rounding(steps: ExactSteps, scales: np.ndarray) -> np.ndarray:
    """Return what the rounding of the times and of the samples makes of x and v."""
    push = float(_push(steps.parameters, *scales))
    ticks = 2.0 * np.spacing(np.maximum(np.abs(steps.t[1:]), np.abs(steps.t[:-1])))
    return np.outer(ticks, [scales[1], push]) + 8.0 * np.finfo(float).eps * scales


def _push(p: Parameters, x: float | np.ndarray, v: float | np.ndarray) -> Any:
    """Return a bound of the acceleration at given |x| and |v|."""
    forces = max(abs(p.A(alpha)) for alpha in (1, 2, 3)) + abs(p.B0)
    return float(forces / p.m) + float(p.k / p.m) * np.abs(x) + float(p.c / p.m) * np.abs(v)


def _loose(p: Parameters, samples: Samples, units: np.ndarray) -> np.ndarray:
    """Return how far x and v of each sample may be off for its rounding, that of its time included, shape (n, 2)."""
    t, x, v = units
    return np.column_stack([x + np.abs(samples.v) * t, v + _push(p, samples.x, samples.v) * t])


def _carried(steps: ExactSteps, loose: np.ndarray, near: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Return how far rounded samples may be from the exact motion over the step, shape (n - 1, 2).

    That is the rounding of the next sample, and what the step makes of the rounding of the one before. Events in the
    step amplify it. So the exact motion is followed from the corners of the box of states that round to the sample.
    """
    if not np.any(loose):
        return np.zeros_like(steps.defects)
    spread = np.zeros_like(steps.defects)
    for signs in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        shift = loose * signs
        x, v = (np.column_stack([steps.x, steps.v]) + shift).T
        corner = follow_steps(steps.parameters, steps.t, x, v, near, scales)
        spread = np.fmax(spread, np.abs(corner.defects + shift[1:] - steps.defects))
    return spread + loose[1:]


def _within(errors: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Return the sizes of the errors, as far as they are allowed; 0 where there is nothing to compare."""
    return np.minimum(np.nan_to_num(np.abs(errors), nan=0.0), limits)
