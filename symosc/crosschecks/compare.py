"""Compare external solutions with the exact motion: step by step, event by event, and globally."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial as partial_of
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import NumberLike, Progress, Record, SceneName, SolutionLike
from symosc.base.arguments import (
    ARRAY_LIKE,
    FLAG,
    NONE,
    NUMBER,
    PROGRESS,
    REAL,
    SOLUTION,
    TEXT,
    WHOLE,
    function_of,
    mapping_of,
    public,
    require,
    require_or_none,
    row_of,
    sequence_of,
)
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact
from symosc.crosschecks.causes import Fault, explain
from symosc.crosschecks.events import (
    WINDOW,
    FoundEvent,
    Match,
    Matcher,
    TimeTolerances,
    find_events,
    given_events,
    labels,
)
from symosc.crosschecks.reading.functions import dense_note
from symosc.crosschecks.reading.objects import of_function
from symosc.crosschecks.reading.solutions import read_solutions
from symosc.crosschecks.report import EVENT_LISTS, CrossCheck, CrossChecks, check_all
from symosc.crosschecks.rounding import Digits, find_rounding
from symosc.crosschecks.samples import (
    SAMPLE_COLUMNS,
    Samples,
    check_joints,
    checked,
    checked_events,
    fastest_rate,
)
from symosc.crosschecks.steps import (
    ExactSteps,
    double_rounding,
    follow_steps,
    propagated,
    push_bound,
    sample_errors,
)
from symosc.crosschecks.velocities import with_velocities
from symosc.model import Parameters
from symosc.scenes import STARTS, Scene, not_reduced_error, scene_of
from symosc.simulation.batch import read_workers
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

__all__ = ["CrossCheck", "CrossChecks", "FoundEvent", "Match", "crosscheck"]

STEP_TOLERANCE = 1e-8
# Rounded samples are compared over steps and over spans of 4, 16, 64, ... steps.
SPAN_FACTOR = 4
# Wrong steps that are explained one by one.
MOST_FAULTS = 500
# Times at which the largest |x| and |v| of the exact motion are looked for, beside the samples.
SCALE_TIMES = 400
# The unit of v of a motion that rests at x is this part of the fastest frequency times |x|.
REST_SPEED = 1e-3


@public
def crosscheck(
    scene: Scene | Parameters | SceneName,
    t: SolutionLike,
    x: ArrayLike | Callable[..., Any] | None = None,
    v: ArrayLike | None = None,
    *,
    events: Iterable[tuple[float, str]] | None = None,
    tolerance: NumberLike = STEP_TOLERANCE,
    global_tolerance: NumberLike | None = None,
    own_start: bool = False,
    partial: bool = False,
    columns: Mapping[str, str | None] | None = None,
    workers: int | None = 1,
    progress: Progress | None = None,
) -> Any:
    """Compare one or several external solutions with the exact motion.

    Parameters
    ----------
    scene : Scene, str or Parameters
        With a scene the solution has to start where the scene does, or on its motion later, and to
        go on to its `t_end`. With Parameters it starts at the first sample and may end anywhere.
    t, x, v : array_like, shape (n,)
        Times, which may come twice where two pieces are joined, positions and velocities. Without
        `v` it is computed from `x`, and a note says so. `x` may be a function t -> (x, v), or a
        matrix of states, (n, 2) or (2, n). Or give
        `t` alone: whatever `symosc.crosschecks.reading.solutions.read_solutions` reads (a file, an OdeResult, a
        DataFrame, a function, ...), or a list of such: pieces of one solution, each beginning where
        one ends, or several solutions.
    events : pairs (t, kind), optional
        What the solver reported, in order of time; kind "cross", "stick", "slip" or "graze". Each
        exact event must be there once, as near in time as the tolerance and the errors of the
        samples let it; a graze, or a start on a belt, may be left out. Default: the events that the
        samples show, and those inside steps that are right. Times without kinds in a solver's
        result (`t_events`, or te and ie) claim less: an event function that finds contacts with a
        belt must have all of them, or all from one side, but no slips. One that finds any time at
        which v is not a belt's speed (x = 0) is left out. An empty list beside one of a belt is
        that of the other belt.
    tolerance : float
        Allowed defect of a step, relative to the largest |x| and |v| of the exact motion; a belt
        that it never meets does not count. A sample
        whose v differs from a belt's speed by less is on the belt. Samples with few digits (3
        decimals, single precision) that fail are judged once more at that precision; `rounded` and
        a note say so. Then half a unit of the last place of each sample is allowed beside the
        tolerance, and what the exact motion makes of such an error of the sample before. Spans of
        4, 16, 64, ... steps are judged in the same way.
    global_tolerance : float, optional
        Allowed global error, relative to the same values. Default: 1000 times `tolerance`, at most
        0.01; of rounded samples at most 5 last places, or 100 times `tolerance` where that is more.
        The rounding of the sample is allowed beside it, and what the exact motion makes of the
        rounding of the first sample.
    own_start, partial : bool
        Allow a solution of a scene that starts elsewhere, and one that ends before the scene's
        `t_end`.
    columns : mapping, optional
        What the columns t, x, v and id of a file or a table are called.
    workers, progress : int, callable or True, optional
        Processes for several solutions (None: all cores); what is called with the numbers of those
        done and of all.

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
    >>> crosscheck("fig5", simulate("fig5")).ok
    True
    """
    scene = scene_of(scene, "scene")
    require(SOLUTION, t=t)
    require_or_none(*ARRAY_LIKE, function_of(None), x=x)
    require_or_none(*ARRAY_LIKE, v=v)
    require_or_none(sequence_of(row_of(2, REAL, TEXT), once=True), events=events)
    require(NUMBER, tolerance=tolerance)
    require_or_none(NUMBER, global_tolerance=global_tolerance)
    require(FLAG, own_start=own_start, partial=partial)
    require_or_none(mapping_of(TEXT, NONE), columns=columns)
    require_or_none(WHOLE, workers=workers)
    require_or_none(*PROGRESS, progress=progress)
    if isinstance(scene, Scene) and scene.original is not None:
        raise not_reduced_error(scene)
    allowed = _positive("tolerance", tolerance)
    if global_tolerance is None:
        limit = None
    else:
        limit = _positive("global_tolerance", global_tolerance)
    if x is None and v is None:
        found = read_solutions(t, columns, scene)
    elif callable(x) and not hasattr(x, "__array__"):
        found = read_solutions(of_function(x, scene, t))
    elif v is None and len(getattr(x, "shape", ())) == 2:  # states, as ode45 returns them
        found = read_solutions({"t": t, "x": x}, None, scene)
    else:
        found = [checked(t, x, v, events)]
    if events is not None:
        if len(found) > 1:
            raise ParameterError(
                "events", "given", f"can be listed for one solution; there are {len(found)}"
            )
        found = [replace(found[0], events=checked_events(events), lists=None)]
    count = read_workers(workers)
    task = partial_of(
        Task,
        scene=scene,
        tolerance=allowed,
        given_limit=limit,
        own_start=own_start,
        partial=partial,
    )
    if len(found) == 1:
        return task(found[0]).verdict()
    return check_all(task, found, count, progress)


def _positive(name: str, value: object) -> float:
    """Return a tolerance as a float; raise ParameterError unless it is positive."""
    number = float(read_exact(name, value))
    if not number > 0.0:
        raise ParameterError(name, value, "must be > 0")
    return number


@dataclass(frozen=True)
class Task:
    """A solution to judge: its samples and their rounding, and the scene and tolerances to compare it with."""

    samples: Samples
    scene: Scene | Parameters
    tolerance: float
    given_limit: float | None
    own_start: bool
    partial: bool
    rounding: dict[str, Digits] | None = None  # found with the velocities that were not given

    @property
    def parameters(self) -> Parameters:
        """The parameters of the exact motion."""
        if isinstance(self.scene, Parameters):
            return self.scene
        return self.scene.parameters

    @property
    def limit(self) -> float:
        """The allowed global error, relative to the sizes of x and v."""
        usual = max(self.tolerance, min(1000.0 * self.tolerance, 0.01))  # errors of steps add up
        if self.given_limit is None:
            return usual
        return self.given_limit

    def again(self, samples: Samples, parameters: Parameters) -> CrossCheck:
        """Judge other samples of another system in the same way."""
        return replace(self, samples=samples, scene=parameters, rounding=None).verdict()

    def verdict(self) -> CrossCheck:
        """Judge the samples; if they fail but are rounded, judge again and allow rounding."""
        samples = self.samples
        rounding = self.rounding
        p = self.parameters
        if rounding is None:
            if samples.lacks_v:
                samples = with_velocities(samples, self.scene, self.tolerance)
            if isinstance(self.scene, Parameters):
                t0 = None
            else:
                t0 = float(self.scene.t0)
            rounding = find_rounding(samples, (float(p.v1), float(p.v2)), t0)
            return replace(self, samples=samples, rounding=rounding).verdict()
        units = np.array(
            [rounding[c].units if c in rounding else 0.0 * samples.t for c in SAMPLE_COLUMNS]
        )
        listed = np.zeros(len(samples.events or ()))
        if "events" in rounding:
            listed = rounding["events"].units
        jump = max(1e-4, self.tolerance)  # pieces joined at an event may differ by so much
        check_joints(samples, jump, sample_errors(p, samples, units))
        result = self._judged(units, listed)
        early = self._early_end(result.trajectory)
        if early and self.partial:
            return replace(result, notes=(*result.notes, early))
        return replace(result, ok=result.ok and not early, early_end=early)

    def _judged(self, units: np.ndarray, listed: np.ndarray) -> CrossCheck:
        """Return the first result that is right, of the samples as they are or as rounded.

        Else the last one.

        `units` are those in the last place of the samples, `listed` of the times of a list of
        events.
        """
        # Events are looked for only where all the rest is right, and in the result that is
        # returned.
        plain = Comparison(self, np.zeros_like(units), np.zeros_like(listed))
        if not self.rounding:
            return plain.result()
        if plain.is_close and plain.is_right:
            result = plain.result()
            if result.ok:
                return result
        half = units * (0.5 + 1e-9)
        comparison = Comparison(self, half, listed)
        result = comparison.result()
        if result.ok:
            return result
        cut_off = self._judge_cut_off(half, listed, comparison)
        return cut_off or self._with_coarser(half, listed, result)

    def _judge_cut_off(
        self, half: np.ndarray, listed: np.ndarray, comparison: Comparison
    ) -> CrossCheck | None:
        """Judge the samples again with `half` a unit added, as if digits had been cut off.

        Return None if they still fail; `comparison` is that of the samples as they are.
        """
        samples = self.samples
        # Digits that are cut off, not rounded, make no larger errors.
        off = np.abs(comparison.errors) / comparison.limits
        if not np.any(half) or np.nanmax(off) > 4.0:
            return None
        numbers = np.stack([samples.t, samples.x, samples.v])
        for way, sign in (("cut off", np.sign(numbers)), ("rounded down", np.ones_like(numbers))):
            # Each sample is put into the middle of the numbers that it may be.
            t, x, v = numbers + half * sign
            moved = replace(self, samples=replace(samples, t=t, x=x, v=v))
            again = Comparison(moved, half * (2.0 - np.abs(sign)), listed)
            if again.is_close and again.is_right:
                result = again.result()
            else:
                result = None
            if result and result.ok:
                note = f"the last digits are {way}: half a unit of the last place is added to each sample"
                return replace(result, notes=(*result.notes, note))
        return None

    def _with_coarser(self, half: np.ndarray, listed: np.ndarray, result: CrossCheck) -> CrossCheck:
        """Return the failed `result`.

        If many spans are wrong, its `coarser` judges every n-th sample.
        """
        # Over one dense step the rounding of the samples is larger than what a wrong model does;
        # over n it is not.
        spans = result.wrong_spans
        samples = self.samples
        # A few spans show no cause, and where most steps are wrong these show it themselves.
        if len(spans) < 6 or 2 * len(result.wrong_steps) >= np.sum(spans[:, 1] - spans[:, 0]):
            return result
        kept = _every(int(np.max(spans[:, 1] - spans[:, 0])), len(samples.t))
        columns = {name: getattr(samples, name)[kept] for name in SAMPLE_COLUMNS}
        if samples.v_off is None:
            off = None
        else:
            off = samples.v_off[kept]
        few = replace(self, samples=replace(samples, **columns, v_off=off, dense=None))
        return replace(result, coarser=Comparison(few, half[:, kept], listed).result())

    def _start(self, loose: np.ndarray, rounding: np.ndarray) -> tuple[Record, str]:
        """Return the start of the exact motion, and a note if the first sample is not on the motion of the scene.

        `loose` are the allowed errors of this sample's x and v, `rounding` the rounding of its t, x
        and v.
        """
        # {} is the scene's own start, which may have more digits than the first sample.
        scene = self.scene
        samples = self.samples
        limit = self.limit
        rate = fastest_rate(self.parameters)
        first = np.array([samples.t[0], samples.x[0], samples.v[0]])
        start = dict(zip(STARTS, first.tolist(), strict=True))
        if isinstance(scene, Parameters):
            return start, ""
        own = np.array([float(scene.t0), float(scene.x0), float(scene.v0)])
        slack = limit * np.maximum(1.0, np.abs(own))
        slack[0] = max(limit / rate, 4.0 * float(np.spacing(abs(own[0]))))
        if samples.v_off is None:
            v_off = 0.0
        else:
            v_off = float(samples.v_off[0])
        off = np.maximum(rounding, [0.0, 0.0, v_off])
        if np.all(np.abs(first - own) <= slack + off):
            return {}, ""
        if samples.v_off is not None:  # positions show the first velocity less well
            slack[2] += 20.0 * max(1.0, rate) * off[2]
            if np.all(np.abs(first - own) <= slack + off):
                return start, ""
        if first[0] > own[0]:
            before = self._simulate(start["t0"], {})
            there = before(min(start["t0"], float(before.t_end)))
            allowed = limit * _scales(before, before.t_end) + loose
            if before.t_end >= start["t0"] and np.all(np.abs(there - first[1:]) <= allowed):
                return start, ""
        given, its = (
            ", ".join(f"{name} = {value:.10g}" for name, value in zip(start, each, strict=True))
            for each in (first, own)
        )
        return start, f"the solution starts at {given}; {scene.name} starts at {its}"

    def _early_end(self, trajectory: Trajectory) -> str:
        """Return a note if the solution ends before the motion does, else ""."""
        scene = self.scene
        t = self.samples.t
        if isinstance(scene, Parameters) or trajectory.status == "equilibrium":
            return ""
        last = float(t[-1])
        t_end = float(scene.t_end)
        steps = np.diff(t)
        step = min(
            float(np.median(steps[steps > 0.0])), 0.05 * (t_end - float(scene.t0))
        )  # may be missing
        if last + (1.0 + 1e-9) * step >= t_end:
            return ""
        return f"the solution ends at t = {last:.10g}; the motion of {scene.name} goes on to t = {t_end:.10g}"

    def _wrong_spans(self, loose: np.ndarray, near: np.ndarray, scales: np.ndarray) -> np.ndarray:
        """Return the spans (first and last sample) over which samples are off by more than their rounding explains.

        `loose` are the errors of x and v that the rounding of each sample allows, `near` the
        distances of v from a belt's speed that count as on the belt, and `scales` the units of x
        and v.
        """
        # The tolerances of the steps of a span add up. The length is chosen at which many spans,
        # and a great part of all, are wrong.
        p = self.parameters
        samples = self.samples
        best = np.empty((0, 2), int)
        count = len(samples.t)
        length = SPAN_FACTOR
        most = 0.0
        while length < count and np.any(loose):
            ends = _every(length, count)
            t = samples.t[ends]
            of_steps = np.minimum(np.diff(ends)[:, None] * self.tolerance, self.limit) * scales
            allowed = double_rounding(p, t, scales) + loose[ends[1:]]
            allowed = allowed + propagated(p, loose[ends[:-1]] + of_steps, np.diff(t))
            defects = follow_steps(
                p, t, samples.x[ends], samples.v[ends], near[ends], allowed
            ).defects
            wrong = np.flatnonzero(np.max(np.abs(defects) / allowed, axis=1) > 1.0)
            if len(wrong) ** 2 > most * len(t):
                most = len(wrong) ** 2 / len(t)
                best = np.column_stack([ends[wrong], ends[wrong + 1]])
            length *= SPAN_FACTOR
        return best

    def _match(
        self, trajectory: Trajectory, start: Record, found: list[FoundEvent], tolerances: TimeTolerances,
        label: Any, wrong: Any,
    ) -> Matcher:  # fmt: skip
        """Match the exact events with the solver's list of events or, if none was given, with those `found`.

        The events `found` were read off the samples. `label` are the mode codes of the samples,
        `wrong` marks the wrong steps, and `tolerances` tell how far times of events may be off.
        """
        events = self.samples.events
        until = float(trajectory.t_end)
        last = float(self.samples.t[-1])
        steps = tolerances.steps
        lists = self.samples.lists
        if events is None or lists is not None:
            found = [event for event in found if float(self.samples.t[event.step]) <= until]
            own = trajectory.events
            shown = Matcher(trajectory, own, found, False, tolerances, label, wrong)
        if events is None:
            return shown
        # where the exact motion has ended there is nothing to match
        if until < last:
            there = until
        else:
            there = np.inf
        order = sorted(
            (i for i, (t, _) in enumerate(events) if t <= there), key=lambda i: events[i][0]
        )
        pairs = [events[i] for i in order]
        exact = [*trajectory.events]
        span = WINDOW * steps.K.period
        # A solution may end at an event that is just after the end.
        if trajectory.status == "t_end" and pairs and pairs[-1][0] >= until - span:
            exact += self._simulate(until + span, start).events[len(exact) :]
        tolerances = replace(tolerances, listed=tolerances.listed[order])
        given = given_events(steps, pairs)
        listed = Matcher(trajectory, exact, given, True, tolerances, label, wrong, lists)
        if lists is None:
            return listed
        shown.add_list(listed)
        return shown

    def _simulate(self, t_end: float, start: Record) -> Trajectory:
        """Return the exact motion from a start to t_end, cut short if it has far more events than there are samples."""
        return simulate(
            self.scene, t_end=t_end, max_events=2_000 + 10 * len(self.samples.t), **start
        )


class Comparison:
    """Samples beside the exact motion.

    Global errors, defects of steps and spans, and what is allowed to them.

    Whether the solution is near the exact motion everywhere (`is_close`) and right from sample to
    sample (`is_right`) takes no event of the samples; `result` looks for these too.
    """

    def __init__(self, task: Task, rounding: np.ndarray, listed: np.ndarray) -> None:
        samples = task.samples
        p = task.parameters
        self.task = task
        self.rounding = rounding
        self.listed = listed
        self.loose = sample_errors(p, samples, rounding)
        self.start, self.other_start = task._start(self.loose[0], rounding[:, 0])
        self.trajectory = task._simulate(float(samples.t[-1]), self.start)
        self.until = float(self.trajectory.t_end)
        # Global errors are NaN after the end of the exact motion.
        inside = samples.t <= self.until
        begin = float(self.trajectory.t_start)
        exact = self.trajectory(np.clip(samples.t[inside], begin, self.until))
        self.scales = _scales(self.trajectory, self.until, exact)
        self.errors = np.full((len(samples.t), 2), np.nan)
        self.errors[inside] = np.column_stack([samples.x, samples.v])[inside] - exact.T
        self.limits = self._limits()
        tolerance = task.tolerance
        self.near = tolerance * self.scales[1] + self.loose[:, 1]
        allowed = double_rounding(p, samples.t, self.scales) + tolerance * self.scales
        self.allowed = allowed + self.loose[1:] + propagated(p, self.loose[:-1], np.diff(samples.t))
        self.steps = follow_steps(p, samples.t, samples.x, samples.v, self.near, self.allowed)
        self.sizes = np.max(np.abs(self.steps.defects) / self.allowed, axis=1)
        self.wrong = ~(self.sizes <= 1.0)
        self.spans = task._wrong_spans(self.loose, self.near, self.scales)

    @property
    def is_close(self) -> bool:
        """Whether no sample is too far from the exact motion."""
        return not np.any(np.abs(self.errors) > self.limits)

    @property
    def is_right(self) -> bool:
        """Whether no step and no span of steps is wrong."""
        return not (self.wrong.any() or len(self.spans))

    def _limits(self) -> np.ndarray:
        """Return how far each sample may be from the exact motion."""
        task = self.task
        loose = self.loose
        limits = task.limit * self.scales
        if task.given_limit is None and np.any(self.rounding):
            places = 5.0 * 2.0 * np.max(loose, axis=0)
            few = np.minimum(limits, np.maximum(places, 100.0 * task.tolerance * self.scales))
            limits = np.where(places > 0.0, few, limits)
        since = task.samples.t - task.samples.t[0]
        return np.asarray(limits + loose + propagated(task.parameters, loose[0], since))

    def result(self) -> CrossCheck:
        """Compare the events too, and return the result."""
        task = self.task
        samples = task.samples
        steps = self.steps
        # While the exact motion sticks, samples that are this near to the belt are taken to be on
        # it.
        label = labels(steps, self.near, np.maximum(self.near, 1e-4 * self.scales[1]))
        found, modes = find_events(steps, label, self.wrong)
        # The part of the samples' errors that is allowed; 0 after the end of the exact motion.
        errors = np.abs(self.errors)
        within = np.where(np.isnan(errors), 0.0, np.fmin(errors, self.limits))
        allowed_v = task.tolerance * float(self.scales[1])
        tolerances = TimeTolerances(
            steps, within + self.loose, allowed_v, task.tolerance, self.listed
        )
        matching = task._match(self.trajectory, self.start, found, tolerances, label, self.wrong)
        faults = _faults(steps, modes, self.sizes, self.allowed, self.near, matching)
        late = _first_late(samples.events or ())
        if task.own_start:
            refused = ""
        else:
            refused = self.other_start
        switching = (fault for fault in faults if fault.reason not in ("local error", "outlier"))
        scene = task.scene
        own = None
        if isinstance(scene, Scene):
            own = (float(scene.t0), float(scene.x0), float(scene.v0))
        copied: Record = {name: tuple(getattr(matching, name)) for name in EVENT_LISTS}
        copied |= {name: getattr(samples, name) for name in SAMPLE_COLUMNS}
        right = self.is_close and self.is_right and not late
        return CrossCheck(
            ok=right and not (matching.missed or matching.invented or refused),
            max_error_x=float(np.nanmax(errors[:, 0])),
            max_error_v=float(np.nanmax(errors[:, 1])),
            errors=self.errors,
            limits=self.limits,
            defects=steps.defects,
            wrong_steps=np.flatnonzero(self.wrong),
            wrong_spans=self.spans,
            allowed=self.allowed,
            decisions=tuple(fault for fault in faults if fault.wrong_decision),
            faults=faults,
            first_wrong=faults[0] if faults else None,
            first_switching=next(switching, None),
            compared_until=min(self.until, float(samples.t[-1])),
            tolerance=task.tolerance,
            global_tolerance=task.limit,
            scales=(float(self.scales[0]), float(self.scales[1])),
            rounded={name: digits.text for name, digits in (task.rounding or {}).items()},
            notes=(*self._notes(late), *matching.notes),
            modes=modes,
            trajectory=self.trajectory,
            own_start=own,
            _task=replace(task, samples=replace(samples, dense=None)),
            wrong_start=refused,
            **copied,
        )

    def _notes(self, late: str) -> list[str]:
        """Return what is to be said beside the numbers.

        `late` says what is not in order in the list of events.
        """
        task = self.task
        notes = list(task.samples.notes)
        if task.rounding:
            at_it = ""
            if np.any(self.rounding) or np.any(self.listed):
                at_it = "; they are judged at that precision"
            texts = (f"{name} to {digits.text}" for name, digits in task.rounding.items())
            notes.append(f"the samples are rounded: {', '.join(texts)}{at_it}")
        if self.until < task.samples.t[-1]:
            ends = f"the exact motion ends at t = {self.until:.10g} ({self.trajectory.message})"
            notes.append(f"{ends}; later only steps are compared")
        if task.samples.dense is not None:
            notes.append(dense_note(self.trajectory, task.samples.dense, self.until))
        if self.other_start and task.own_start:
            notes.append(self.other_start)
        if late:
            notes.append(f"the list is not in order of time: {late}")
        if not self.is_close and self.is_right and not self.other_start:
            notes.append(
                "every step is right, but their errors add up, or the start is another one"
            )
        return notes


def _first_late(events: Sequence[tuple[float, str]]) -> str:
    """Return which event of a list comes after a later one, as words.

    "" if they are in order of time.
    """
    for (before, _), (time, kind) in pairwise(events):
        if time < before:
            return f"{kind} at t = {time:.10g} comes after t = {before:.10g}"
    return ""


def _every(n: int, count: int) -> np.ndarray:
    """Return the numbers of every n-th of `count` samples, and of the last one."""
    return np.unique([*range(0, count, n), count - 1])


def _faults(
    steps: ExactSteps,
    modes: np.ndarray,
    sizes: np.ndarray,
    allowed: np.ndarray,
    near: np.ndarray,
    matching: Matcher,
) -> tuple[Fault, ...]:
    """Describe wrong steps by `explain`.

    The first MOST_FAULTS, and as many in which an event is wrong.
    """
    # Chatter makes every step wrong and invents two events in each: to describe all takes minutes.
    wrong = ~(sizes <= 1.0)
    at_events = [event.step for event in matching.invented]
    at_events += [int(np.searchsorted(steps.t, float(event.t))) - 1 for event in matching.missed]
    events = np.unique(np.array(at_events, dtype=int))
    events = events[(events >= 0) & (events < len(wrong))]
    decided = np.flatnonzero(wrong & (modes[1:] > 0) & (steps.last != modes[1:]))
    kinds = (events[wrong[events]], decided, np.flatnonzero(wrong))
    chosen = np.unique(np.concatenate([numbers[:MOST_FAULTS] for numbers in kinds]))
    return explain(steps, chosen.tolist(), modes, sizes, allowed, near)


def _scales(trajectory: Trajectory, until: float, states: np.ndarray | None = None) -> np.ndarray:
    """Return the units of x and v: the largest |x| and |v| of the exact motion up to a time.

    `states` are further ones of the motion, rows x and v.
    """
    # A belt counts only if the motion meets it: its speed is then one of the motion's velocities.
    p = trajectory.parameters
    rate = fastest_rate(p)
    times = np.linspace(float(trajectory.t_start), float(until), SCALE_TIMES)
    reach = np.max(np.abs(trajectory(times)), axis=1)
    if states is not None:
        reach = np.maximum(reach, np.max(np.abs(states), axis=1))
    met = [abs(float(p.belt(event.boundary))) for event in trajectory.events if event.t <= until]
    x = float(reach[0])
    v = max([float(reach[1]), *met])
    if x == v == 0.0:
        x = float(push_bound(p, 0.0, 0.0)) / rate**2 or 1.0
    # x is at least as far as a motion at the speed v swings. A motion at rest has no speed.
    x = max(x, v / rate)
    return np.array([x, max(v, REST_SPEED * rate * x)])
