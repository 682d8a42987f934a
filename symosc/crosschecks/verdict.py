"""Judge samples: global errors, defects of the steps, events, and a guess at each wrong step.

`judge` makes a `Verdict` of a `CheckTask`. Neither knows the other's maker: the diagnosis judges
changed samples again, and the result that a user gets is a verdict that can be shown.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.crosschecks.event_verdicts import EventVerdicts
from symosc.crosschecks.events import (
    WINDOW,
    FoundEvent,
    Match,
    find_events,
    given_events,
    labels,
)
from symosc.crosschecks.faults import Fault, explain
from symosc.crosschecks.reading.functions import dense_note
from symosc.crosschecks.rounding import Digits, find_rounding
from symosc.crosschecks.samples import SAMPLE_COLUMNS, Samples, check_joints, fastest_rate
from symosc.crosschecks.separation import Separation, separation_at, separation_note
from symosc.crosschecks.steps import (
    ExactSteps,
    contracts,
    double_rounding,
    follow_steps,
    least_damping,
    propagated,
    push_bound,
    sample_errors,
    spread_of_steps,
)
from symosc.crosschecks.time_tolerances import TimeTolerances
from symosc.crosschecks.velocities import with_velocities
from symosc.model import Model
from symosc.scenes import STARTS, Scene, model_of
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event, Trajectory

# Rounded samples are compared over steps and over spans of 4, 16, 64, ... steps.
SPAN_FACTOR = 4
# So many wrong spans show a cause; where most steps are wrong, these show it themselves.
FEWEST_SPANS = 6
# Digits that are cut off, not rounded, make no errors larger than so many limits.
MOST_CUT_OFF = 4.0
# Wrong steps that are explained one by one.
MOST_FAULTS = 500
# Times at which the largest |x| and |v| of the exact motion are looked for, beside the samples.
SCALE_TIMES = 400
# The unit of v of a motion that rests at x is this part of the fastest frequency times |x|.
REST_SPEED = 1e-3
# Pieces joined at an event may differ by this part of the largest |x| or |v|.
LARGEST_JUMP = 1e-4
# While the exact motion sticks, a sample is at the belt up to this part of the largest |v|.
STICK_DRIFT = 1e-4
# A global error adds up the errors of so many steps, but is no larger than a part of the motion.
STEPS_ADDED = 1000.0
LARGEST_LIMIT = 0.01
# That of rounded samples is so many last places, or so many tolerances where that is more.
LIMIT_IN_PLACES = 5.0
LIMIT_IN_TOLERANCES = 100.0
# So often the exact motion is begun again where neighbours move apart.
MOST_SEPARATIONS = 1_000
# From so many points on a friction curve may stand for a smooth function.
POINTS_OF_FUNCTION = 16
# Reasons of wrong steps that have nothing to do with a belt.
WITHOUT_BELT = ("local error", "outlier")


@dataclass(frozen=True)
class CheckTask:
    """A solution to judge, and the scene and tolerances to compare it with."""

    samples: Samples
    scene: Scene | Model
    tolerance: float
    given_limit: float | None
    own_start: bool
    partial: bool
    rounding: dict[str, Digits] = field(default_factory=dict)  # of the samples, once found

    @property
    def parameters(self) -> Model:
        """The parameters of the exact motion."""
        return model_of(self.scene)

    @property
    def limit(self) -> float:
        """The allowed global error, relative to the sizes of x and v."""
        if self.given_limit is not None:
            return self.given_limit
        return max(self.tolerance, min(STEPS_ADDED * self.tolerance, LARGEST_LIMIT))

    def with_columns(self, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> CheckTask:
        """Return the task with other samples of the same solution."""
        return replace(self, samples=replace(self.samples, t=t, x=x, v=v))

    def motion(self, t_end: float, start: Record) -> Trajectory:
        """Return the exact motion from a start to t_end, cut short if it has far more events than
        there are samples.
        """
        most = 2_000 + 10 * len(self.samples.t)
        return simulate(self.scene, t_end=t_end, max_events=most, **start)


@dataclass(frozen=True, eq=False, repr=False)
class Verdict:
    """What was found: the fields and properties of a `CrossCheck` but for the diagnosis."""

    trajectory: Trajectory
    errors: np.ndarray
    limits: np.ndarray
    scales: tuple[float, float]
    defects: np.ndarray
    allowed: np.ndarray
    wrong_spans: np.ndarray
    modes: np.ndarray
    matched: tuple[Match, ...]
    missed: tuple[Event, ...]
    invented: tuple[FoundEvent, ...]
    unresolved: tuple[Event | FoundEvent, ...]
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]
    wrong_start: str
    _task: CheckTask
    early_end: str = ""
    coarser: Verdict | None = None

    @property
    def task(self) -> CheckTask:
        """What was judged, and how."""
        return self._task

    @cached_property
    def ok(self) -> bool:
        """Whether the solution is right: no step or span is wrong, no event missed or invented."""
        is_close = not np.any(np.abs(self.errors) > self.limits)
        is_right = not (len(self.wrong_steps) or len(self.wrong_spans))
        has_events = not (self.missed or self.invented or _first_late(self._task.samples.events))
        return is_close and is_right and has_events and not (self.wrong_start or self.early_end)

    @property
    def t(self) -> np.ndarray:
        """The times of the samples."""
        return self._task.samples.t

    @property
    def x(self) -> np.ndarray:
        """The positions."""
        return self._task.samples.x

    @property
    def v(self) -> np.ndarray:
        """The velocities."""
        return self._task.samples.v

    @property
    def tolerance(self) -> float:
        """The allowed defect of a step, relative to the scales."""
        return self._task.tolerance

    @property
    def global_tolerance(self) -> float:
        """The allowed global error, relative to the scales."""
        return self._task.limit

    @property
    def rounded(self) -> dict[str, str]:
        """How the columns "t", "x", "v" and the times of the list, "events", were rounded."""
        return {name: digits.text for name, digits in self._task.rounding.items()}

    @property
    def own_start(self) -> tuple[float, float, float] | None:
        """Where the scene starts; None if Parameters were given."""
        scene = self._task.scene
        if not isinstance(scene, Scene):
            return None
        return float(scene.t0), float(scene.x0), float(scene.v0)

    @property
    def compared_until(self) -> float:
        """Where the exact motion ends, or the last sample."""
        return min(float(self.trajectory.t_end), float(self.t[-1]))

    @property
    def max_error_x(self) -> float:
        """The largest global error of x."""
        return float(np.nanmax(np.abs(self.errors[:, 0])))

    @property
    def max_error_v(self) -> float:
        """The largest global error of v."""
        return float(np.nanmax(np.abs(self.errors[:, 1])))

    @cached_property
    def wrong_steps(self) -> np.ndarray:
        """The numbers of the steps whose defect is larger than allowed."""
        return np.flatnonzero(_are_wrong(self.defects, self.allowed))

    @property
    def decisions(self) -> tuple[Fault, ...]:
        """Wrong steps that stick, slip or pass where the exact motion does something else."""
        return tuple(fault for fault in self.faults if fault.wrong_decision)

    @property
    def first_wrong(self) -> Fault | None:
        """The first wrong step."""
        return self.faults[0] if self.faults else None

    @property
    def first_switching(self) -> Fault | None:
        """The first wrong step at a belt."""
        at_belts = (fault for fault in self.faults if fault.reason not in WITHOUT_BELT)
        return next(at_belts, None)


def judge(task: CheckTask) -> Verdict:
    """Judge samples; if they fail but are rounded, judge again and allow rounding."""
    task = _prepared(task)
    units, listed = _units(task)
    jump = max(LARGEST_JUMP, task.tolerance)
    check_joints(task.samples, jump, sample_errors(task.parameters, task.samples, units))
    verdict = _first_right(task, units, listed)
    early = _early_end(task, verdict.trajectory)
    if early and task.partial:
        return replace(verdict, notes=(*verdict.notes, early))
    return replace(verdict, early_end=early)


def _prepared(task: CheckTask) -> CheckTask:
    """Return the task with velocities, if these were not given, and with the rounding of its
    samples.
    """
    samples = task.samples
    if samples.lacks_v:
        samples = with_velocities(samples, task.scene, task.tolerance)
    p = task.parameters
    t0 = float(task.scene.t0) if isinstance(task.scene, Scene) else None
    rounding = find_rounding(samples, [float(belt.v) for belt in p.law.belts], t0)
    return replace(task, samples=samples, rounding=rounding)


def _units(task: CheckTask) -> tuple[np.ndarray, np.ndarray]:
    """Return the units in the last place of the samples, rows t, x and v, and of listed events.

    0 where numbers have all digits.
    """
    none = np.zeros(len(task.samples.t))
    rounding = task.rounding
    units = [rounding[name].units if name in rounding else none for name in SAMPLE_COLUMNS]
    if "events" in rounding:
        return np.array(units), rounding["events"].units
    return np.array(units), np.zeros(len(task.samples.events or ()))


def _first_right(task: CheckTask, units: np.ndarray, listed: np.ndarray) -> Verdict:
    """Return the first verdict that is right, on the samples as they are or as rounded.

    Else the last one. `units` are those in the last place of the samples, `listed` of the times of
    a list of events.
    """
    # Events are looked for only where all the rest is right, and in the verdict that is returned.
    plain = Comparison(task, np.zeros_like(units), np.zeros_like(listed))
    if not task.rounding:
        return plain.verdict()
    if plain.is_close and plain.is_right:
        verdict = plain.verdict()
        if verdict.ok:
            return verdict
    half = units * (0.5 + 1e-9)
    comparison = Comparison(task, half, listed)
    verdict = comparison.verdict()
    if verdict.ok:
        return verdict
    cut_off = _cut_off(comparison)
    if cut_off is not None:
        return cut_off
    return replace(verdict, coarser=_coarser(comparison, verdict))


def _cut_off(comparison: Comparison) -> Verdict | None:
    """Return the verdict on the samples as if their digits had been cut off; None if they still
    fail.

    Half a unit is added, so that each sample is in the middle of the numbers that it may be.
    """
    half = comparison.rounding
    off = np.abs(comparison.errors) / comparison.limits
    if not np.any(half) or np.nanmax(off) > MOST_CUT_OFF:
        return None
    samples = comparison.task.samples
    numbers = np.stack([samples.t, samples.x, samples.v])
    directions = (("cut off", np.sign(numbers)), ("rounded down", np.ones_like(numbers)))
    for verb, sign in directions:
        moved = comparison.task.with_columns(*(numbers + half * sign))
        # A 0 stays: it may have been cut off from a whole unit on either side.
        again = Comparison(moved, half * (2.0 - np.abs(sign)), comparison.listed)
        if not (again.is_close and again.is_right):
            continue
        verdict = again.verdict()
        if verdict.ok:
            note = (
                f"the last digits are {verb}: half a unit of the last place is added to each sample"
            )
            return replace(verdict, notes=(*verdict.notes, note))
    return None


def _coarser(comparison: Comparison, verdict: Verdict) -> Verdict | None:
    """Return the verdict on every n-th sample of rounded ones that fail.

    Over one dense step the rounding of the samples is larger than what a wrong model does; over n
    it is not. None if too few spans are wrong to show a cause.
    """
    spans = verdict.wrong_spans
    first_samples, last_samples = spans.T
    in_spans = np.sum(last_samples - first_samples)
    # If half of the steps in the spans are wrong by themselves, longer steps show no more.
    if len(spans) < FEWEST_SPANS or 2 * len(verdict.wrong_steps) >= in_spans:
        return None
    samples = comparison.task.samples
    kept = _every(int(np.max(last_samples - first_samples)), len(samples.t))
    off = None if samples.v_off is None else samples.v_off[kept]
    few = comparison.task.with_columns(samples.t[kept], samples.x[kept], samples.v[kept])
    few = replace(few, samples=replace(few.samples, v_off=off, dense=None))
    return Comparison(few, comparison.rounding[:, kept], comparison.listed).verdict()


# -- where a solution starts and ends --------------------------------------------------------------


class SolutionStart(NamedTuple):
    """The start of the exact motion, and a note if the first sample is not on the motion of the
    scene.

    `numbers` are t0, x0 and v0, or none: the scene's own, which may have more digits.
    """

    numbers: Record
    note: str = ""


def _start(task: CheckTask, loose: np.ndarray, rounding: np.ndarray) -> SolutionStart:
    """Return where the exact motion starts.

    `loose` are the allowed errors of the first sample's x and v, `rounding` the rounding of its t,
    x and v.
    """
    scene = task.scene
    samples = task.samples
    rate = fastest_rate(task.parameters)
    first = np.array([samples.t[0], samples.x[0], samples.v[0]])
    start = dict(zip(STARTS, first.tolist(), strict=True))
    if not isinstance(scene, Scene):
        return SolutionStart(start)
    own = np.array([float(scene.t0), float(scene.x0), float(scene.v0)])
    own_t, own_x, own_v = own
    slack_t = max(task.limit / rate, 4.0 * float(np.spacing(abs(own_t))))
    slack_x = task.limit * max(1.0, abs(own_x))
    slack_v = task.limit * max(1.0, abs(own_v))
    v_off = 0.0 if samples.v_off is None else float(samples.v_off[0])
    off = np.maximum(rounding, [0.0, 0.0, v_off])
    if np.all(np.abs(first - own) <= np.array([slack_t, slack_x, slack_v]) + off):
        return SolutionStart({})
    if samples.v_off is not None:  # positions show the first velocity less well
        _, _, off_v = off
        slack_v += 20.0 * max(1.0, rate) * off_v
        if np.all(np.abs(first - own) <= np.array([slack_t, slack_x, slack_v]) + off):
            return SolutionStart(start)
    # A solution may begin later, on the motion of the scene.
    t0 = start["t0"]
    if t0 > own_t:
        before = task.motion(t0, {})
        exact = before(min(t0, float(before.t_end)))
        allowed = task.limit * _scales(before, before.t_end) + loose
        is_near = np.all(np.abs(exact - [start["x0"], start["v0"]]) <= allowed)
        if before.t_end >= t0 and is_near:
            return SolutionStart(start)
    note = f"the solution starts at {_start_text(first)}; {scene.name} starts at {_start_text(own)}"
    return SolutionStart(start, note)


def _start_text(numbers: np.ndarray) -> str:
    """Return t0, x0 and v0 as text."""
    named = zip(STARTS, numbers, strict=True)
    return ", ".join(f"{name} = {value:.10g}" for name, value in named)


def _early_end(task: CheckTask, trajectory: Trajectory) -> str:
    """Return a note if the solution ends before the motion does, else ""."""
    scene = task.scene
    t = task.samples.t
    if not isinstance(scene, Scene) or trajectory.status == "equilibrium":
        return ""
    last = float(t[-1])
    t_end = float(scene.t_end)
    steps = np.diff(t)
    usual = float(np.median(steps[steps > 0.0]))
    missing = min(usual, 0.05 * (t_end - float(scene.t0)))  # one step, as of arange
    if last + (1.0 + 1e-9) * missing >= t_end:
        return ""
    goes_on = f"the motion of {scene.name} goes on to t = {t_end:.10g}"
    return f"the solution ends at t = {last:.10g}; {goes_on}"


# -- samples beside the exact motion ---------------------------------------------------------------


class Comparison:
    """Samples beside the exact motion: global errors, defects, and what is allowed to them.

    Whether the solution is near the exact motion everywhere (`is_close`) and right from sample to
    sample (`is_right`) takes no event of the samples; `verdict` looks for these too. `rounding` are
    the errors of the samples, rows t, x and v, that their digits allow, `listed` those of the times
    of a list.
    """

    def __init__(self, task: CheckTask, rounding: np.ndarray, listed: np.ndarray) -> None:
        self.task = task
        self.rounding = rounding
        self.listed = listed
        self.loose = sample_errors(task.parameters, task.samples, rounding)
        self.contracts = contracts(task.parameters)
        self._compare_states()  # sets start, trajectory, until, scales, errors and limits
        self._compare_steps()  # sets near, allowed, steps, wrong and spans
        self.separations = list[Separation]()
        if not self.contracts:
            self._follow_separations()

    def _compare_states(self) -> None:
        """Compute the exact motion and the global errors, NaN after its end."""
        samples = self.task.samples
        self.start = _start(self.task, self.loose[0], self.rounding[:, 0])
        self.trajectory = self.task.motion(float(samples.t[-1]), self.start.numbers)
        self.until = float(self.trajectory.t_end)
        inside = samples.t <= self.until
        begin = float(self.trajectory.t_start)
        exact = self.trajectory(np.clip(samples.t[inside], begin, self.until))
        self.scales = _scales(self.trajectory, self.until, exact)
        self.errors = np.full((len(samples.t), 2), np.nan)
        self.errors[inside] = np.column_stack([samples.x, samples.v])[inside] - exact.T
        self.limits = self._limits()

    def _compare_steps(self) -> None:
        """Compute the defects of all steps and spans, and which are wrong."""
        p = self.task.parameters
        samples = self.task.samples
        tolerance = self.task.tolerance
        _, scale_v = self.scales
        _, loose_v = self.loose.T
        self.near = tolerance * scale_v + loose_v
        allowed = double_rounding(p, samples.t, self.scales) + tolerance * self.scales
        moved = propagated(p, self.loose[:-1], np.diff(samples.t))
        self.allowed = allowed + self.loose[1:] + moved
        self.steps = follow_steps(p, samples.t, samples.x, samples.v, self.near, self.allowed)
        self.wrong = self._wrong_steps(
            self.steps, self.allowed, self.loose[:-1] + tolerance * self.scales
        )
        self.spans = self._wrong_spans()

    def _wrong_steps(self, steps: ExactSteps, allowed: np.ndarray, box: np.ndarray) -> np.ndarray:
        """Return which steps are wrong.

        Where motions may move apart add to `allowed`, for steps that seem to be and may have such
        a place, what the exact motion makes of an error of the sample before; `box` are the largest
        such errors.
        """
        wrong = _are_wrong(steps.defects, allowed)
        if not self.contracts:
            may_grow = steps.may_meet_belts(box) | (least_damping(steps.parameters) < 0)
            doubted = np.flatnonzero(wrong & (np.diff(steps.t) > 0.0) & may_grow)
            allowed[doubted] += spread_of_steps(steps, doubted, box[doubted])
            wrong = _are_wrong(steps.defects, allowed)
        return wrong

    def _follow_separations(self) -> None:
        """Go on with the exact motion from a sample where the solution moves away from that from
        the start as its neighbours do.

        Sets separations; changes errors and, at the first one, trajectory and until.
        """
        samples = self.task.samples
        motion = self.trajectory
        since = 0
        while len(self.separations) < MOST_SEPARATIONS:
            beyond = np.any(np.abs(self.errors) > self.limits, axis=1)
            beyond[:since] = False
            if not beyond.any() or self.wrong[: int(np.argmax(beyond))].any():
                return
            found = separation_at(self, motion, since, int(np.argmax(beyond)))
            if found is None:
                return
            if not self.separations:
                self.trajectory = self.task.motion(found.until, self.start.numbers)
                self.until = float(self.trajectory.t_end)
            self.separations.append(found)
            since = found.sample + 1
            motion = self.task.motion(float(samples.t[-1]), found.start)
            there = np.flatnonzero(samples.t[since:] <= float(motion.t_end)) + since
            self.errors[since:] = np.nan
            exact = motion(samples.t[there]).T
            self.errors[there] = np.column_stack([samples.x, samples.v])[there] - exact

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
            # Rounding makes errors of half a last place.
            places = LIMIT_IN_PLACES * 2.0 * np.max(loose, axis=0)
            tolerated = LIMIT_IN_TOLERANCES * task.tolerance * self.scales
            limits_of_rounded = np.minimum(limits, np.maximum(places, tolerated))
            limits = np.where(places > 0.0, limits_of_rounded, limits)
        since = task.samples.t - task.samples.t[0]
        if not self.contracts:  # how rounding grows is asked where a sample is beyond its limit
            return np.asarray(limits + loose + np.zeros((len(since), 2)))
        return np.asarray(limits + loose + propagated(task.parameters, loose[0], since))

    def _wrong_spans(self) -> np.ndarray:
        """Return the spans (first and last sample) over which samples are off by more than their
        rounding explains.

        The tolerances of the steps of a span add up. The length is chosen at which many spans, and
        a great part of all, are wrong.
        """
        task = self.task
        p = task.parameters
        samples = task.samples
        best = np.empty((0, 2), int)
        count = len(samples.t)
        length = SPAN_FACTOR
        most = 0.0
        while length < count and np.any(self.loose):
            ends = _every(length, count)
            t = samples.t[ends]
            added = np.minimum(np.diff(ends)[:, None] * task.tolerance, task.limit) * self.scales
            box = self.loose[ends[:-1]] + added
            allowed = double_rounding(p, t, self.scales) + self.loose[ends[1:]]
            allowed = allowed + propagated(p, box, np.diff(t))
            over = follow_steps(p, t, samples.x[ends], samples.v[ends], self.near[ends], allowed)
            self._wrong_steps(over, allowed, box)
            wrong = np.flatnonzero(np.max(np.abs(over.defects) / allowed, axis=1) > 1.0)
            # The number of wrong spans times their share of all.
            if len(wrong) ** 2 > most * len(t):
                most = len(wrong) ** 2 / len(t)
                best = np.column_stack([ends[wrong], ends[wrong + 1]])
            length *= SPAN_FACTOR
        return best

    def verdict(self) -> Verdict:
        """Compare the events too, and return the verdict."""
        task = self.task
        scale_x, scale_v = self.scales.tolist()
        label = labels(self.steps, self.near, np.maximum(self.near, STICK_DRIFT * scale_v))
        shown, modes = find_events(self.steps, label, self.wrong)
        matching = self._match(shown, label)
        return Verdict(
            trajectory=self.trajectory,
            errors=self.errors,
            limits=self.limits,
            scales=(scale_x, scale_v),
            defects=self.steps.defects,
            allowed=self.allowed,
            wrong_spans=self.spans,
            modes=modes,
            matched=tuple(matching.matched),
            missed=tuple(matching.missed),
            invented=tuple(matching.invented),
            unresolved=tuple(matching.unresolved),
            faults=self._faults(modes, matching),
            notes=(*self._notes(), *matching.notes),
            wrong_start="" if task.own_start else self.start.note,
            _task=replace(task, samples=replace(task.samples, dense=None)),
        )

    def _match(self, shown: list[FoundEvent], label: np.ndarray) -> EventVerdicts:
        """Match the exact events with the solver's list of events or, if it has none, with those
        `shown`.

        The events `shown` were read off the samples; `label` are the mode codes of the samples.
        """
        samples = self.task.samples
        tolerances = self._time_tolerances()
        events = samples.events
        lists = samples.lists
        motion = self.trajectory
        if events is None or lists is not None:
            shown = [event for event in shown if float(samples.t[event.step]) <= self.until]
            of_samples = EventVerdicts(
                motion, motion.events, shown, False, tolerances, label, self.wrong
            )
            if events is None:
                return of_samples
        # Where the exact motion has ended there is nothing to match.
        has_ended = self.until < float(samples.t[-1])
        times = [t for t, _ in events]
        compared = [i for i, t in enumerate(times) if not has_ended or t <= self.until]
        order = sorted(compared, key=lambda i: times[i])
        pairs = [events[i] for i in order]
        exact = self._exact_events(pairs)
        tolerances = replace(tolerances, listed=tolerances.listed[order])
        listed_events = given_events(self.steps, pairs)
        listed = EventVerdicts(
            motion, exact, listed_events, True, tolerances, label, self.wrong, lists
        )
        if lists is None:
            return listed
        of_samples.add_list(listed)
        return of_samples

    def _exact_events(self, pairs: Sequence[tuple[float, str]]) -> list[Event]:
        """Return the exact events, with those just after the end if a list ends there."""
        exact = [*self.trajectory.events]
        span = WINDOW * self.steps.K.period
        ends_late = False
        if pairs:
            last_time, _ = pairs[-1]
            ends_late = last_time >= self.until - span and not self.separations
        if self.trajectory.status == "t_end" and ends_late:
            longer = self.task.motion(self.until + span, self.start.numbers)
            exact += longer.events[len(exact) :]
        return exact

    def _time_tolerances(self) -> TimeTolerances:
        """Return how far times of events may be off, as the errors of the samples that are allowed
        let them.
        """
        errors = np.abs(self.errors)
        within = np.where(np.isnan(errors), 0.0, np.fmin(errors, self.limits))
        _, scale_v = self.scales.tolist()
        allowed_v = self.task.tolerance * scale_v
        return TimeTolerances(
            self.steps, within + self.loose, allowed_v, self.task.tolerance, self.listed
        )

    def _faults(self, modes: np.ndarray, matching: EventVerdicts) -> tuple[Fault, ...]:
        """Describe wrong steps: the first MOST_FAULTS, and as many in which an event is wrong."""
        # Chatter makes every step wrong and invents two events in each: to describe all takes
        # minutes.
        steps = self.steps
        sizes = np.max(np.abs(steps.defects) / self.allowed, axis=1)
        rows = [event.step for event in matching.invented]
        rows += [int(np.searchsorted(steps.t, float(event.t))) - 1 for event in matching.missed]
        at_events = np.unique(np.array(rows, dtype=int))
        at_events = at_events[(at_events >= 0) & (at_events < len(self.wrong))]
        decided = np.flatnonzero(self.wrong & (modes[1:] > 0) & (steps.last != modes[1:]))
        kinds = (at_events[self.wrong[at_events]], decided, np.flatnonzero(self.wrong))
        chosen = np.unique(np.concatenate([numbers[:MOST_FAULTS] for numbers in kinds]))
        return explain(steps, chosen.tolist(), modes, sizes, self.allowed, self.near)

    def _notes(self) -> list[str]:
        """Return what is to be said beside the numbers."""
        task = self.task
        samples = task.samples
        notes = list(samples.notes)
        if task.rounding:
            texts = (f"{name} to {digits.text}" for name, digits in task.rounding.items())
            is_allowed = np.any(self.rounding) or np.any(self.listed)
            at_it = "; they are judged at that precision" if is_allowed else ""
            notes.append(f"the samples are rounded: {', '.join(texts)}{at_it}")
        notes += _notes_of_curves(task.parameters)
        if self.separations:
            notes.append(separation_note(task.parameters, self.separations, self.until))
        elif self.until < samples.t[-1]:
            ends = f"the exact motion ends at t = {self.until:.10g} ({self.trajectory.message})"
            notes.append(f"{ends}; later only steps are compared")
        if samples.dense is not None:
            notes.append(dense_note(self.trajectory, samples.dense, self.until))
        if self.start.note and task.own_start:
            notes.append(self.start.note)
        late = _first_late(samples.events)
        if late:
            notes.append(f"the list is not in order of time: {late}")
        if not self.is_close and self.is_right and not self.start.note:
            notes.append(
                "every step is right, but their errors add up, or the start is another one"
            )
        return notes


def _notes_of_curves(p: Model) -> Iterator[str]:
    """Yield what is to be said of curves with so many points that they may stand for a function."""
    for number, belt in enumerate(p.law.belts, 1):
        if len(belt.curve) < POINTS_OF_FUNCTION:
            continue
        w, mu = np.array(belt.curve, dtype=float).T
        widths = np.diff(w)
        slopes = np.diff(mu) / widths
        # Between points a width h apart a line is off by h^2/8 of the second derivative.
        bends = np.abs(np.diff(slopes)) / (0.5 * (widths[1:] + widths[:-1]))
        off = float(np.max(bends * np.maximum(widths[1:], widths[:-1]) ** 2)) / 8.0
        yield (
            f"the samples are compared with a friction of belt {number} that is linear between the "
            f"{len(w)} points of its curve; from a smooth function through them it is off by up to "
            f"about {off:.1g} in mu"
        )


def _are_wrong(defects: np.ndarray, allowed: np.ndarray) -> np.ndarray:
    """Return which steps have a larger defect than is allowed, or one that is not known."""
    return ~(np.max(np.abs(defects) / allowed, axis=1) <= 1.0)


def _first_late(events: Sequence[tuple[float, str]] | None) -> str:
    """Return which event of a list comes after a later one, as words.

    "" if they are in order of time.
    """
    for (before, _), (time, kind) in pairwise(events or ()):
        if time < before:
            return f"{kind} at t = {time:.10g} comes after t = {before:.10g}"
    return ""


def _every(n: int, count: int) -> np.ndarray:
    """Return the numbers of every n-th of `count` samples, and of the last one."""
    return np.unique([*range(0, count, n), count - 1])


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
    reach_x, reach_v = reach.tolist()
    x = reach_x
    v = max([reach_v, *met])
    if x == v == 0.0:
        x = float(push_bound(p, 0.0, 0.0)) / rate**2 or 1.0
    # x is at least as far as a motion at the speed v swings. A motion at rest has no speed.
    x = max(x, v / rate)
    return np.array([x, max(v, REST_SPEED * rate * x)])
