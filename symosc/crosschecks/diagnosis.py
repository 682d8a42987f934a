"""The probable cause of errors in a solution.

Each cause is tried on the wrong steps. It is named if it explains the first of them, the one with
the largest defect, and most of the others; where it is a change, the whole check is repeated with
the change. Else the cause is unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from symosc.base.errors import ParameterError
from symosc.crosschecks import columns, friction, methods, models
from symosc.crosschecks.causes import (
    ENOUGH,
    Diagnosis,
    Explanation,
    FaultySteps,
    explained_share,
    larger,
    mended_share,
)
from symosc.crosschecks.verdict import Verdict, judge
from symosc.engine.next_event import TWO_PI
from symosc.model import Parameters

# Causes that explain this little less than the best are its alternatives.
AS_GOOD = 0.02
# So often a check is repeated at most, to confirm causes.
MOST_REPEATED = 4
# Periods of the drive in the steps that are tried, if each step is shorter than one.
MOST_PERIODS = 200.0
# Without velocities not all samples can be judged, but this part of them has to be.
FEWEST_LEFT = 0.9
Cause = Callable[[FaultySteps], Iterable[Explanation]]
#: The causes, stage by stage, the cheapest first.
STAGES: tuple[tuple[Cause, ...], ...] = (
    (columns.even_times, columns.single_times),
    (columns.outliers, columns.other_columns),
    (models.other_systems, models.phases_of_drive, models.jumps_of_clock),
    (columns.velocity_column, columns.frozen_positions),
    # What one step is off and the next takes back may be v alone, at times between samples.
    (columns.noise,),
    (models.coefficients,),
    (models.far_coefficients,),
    # A width is one number for all steps, delays are one for each.
    (friction.smoothed, methods.late_events, friction.drift),
    (methods.gone_over, methods.large_steps),
)
#: The causes for oscillators with other friction laws than the paper's.
STAGES_OF_OTHER_LAWS: tuple[tuple[Cause, ...], ...] = (
    (friction.without_static, friction.without_curve),
    *STAGES[:2],
    (columns.velocity_column, columns.frozen_positions),
    (columns.noise,),
)


def diagnose(check: Verdict) -> tuple[Diagnosis, ...]:
    """Return the probable causes of the errors of a solution, the most probable first."""
    few_digits = tuple(columns.few_digits(check))
    if check.ok:
        return few_digits
    if check.coarser is not None:
        return diagnose(check.coarser)
    if len(check.wrong_steps):
        causes = [_cause_of_wrong_steps(check)]
    elif check.missed or check.invented:
        causes = list(columns.event_list_faults(check))
    else:
        causes = list(_start(check))
    return (*causes, *few_digits)


def _cause_of_wrong_steps(check: Verdict) -> Diagnosis:
    """Return what is probably wrong with samples that have wrong steps."""
    if not (np.ptp(check.x) or np.ptp(check.v)):
        words = "x and v never change: the mass does not move"
        evidence = f"x = {check.x[0]:.10g}, v = {check.v[0]:.10g} in all samples"
        return Diagnosis("columns", "x and v", words, evidence)
    p = check.trajectory.parameters
    repeated = Repeated(check)
    case = FaultySteps(check, int(check.wrong_steps[0]))
    periods = (case.steps.t[-1] - case.steps.t[0]) * float(p.Omega) / TWO_PI
    if periods > max(MOST_PERIODS, len(case.steps.t)):
        # Steps longer than a period hold too many events to show a cause, but for other units of t.
        units = columns.changed_columns(p, check.t, check.x, check.v)
        named = repeated.confirmed([unit for unit in units if unit.diagnosis.subject == "t"])
        return named[0] if named else _unknown(check)
    if len(case.telling):  # else samples at one time differ, or no step can be decided
        stages = STAGES if isinstance(p, Parameters) else STAGES_OF_OTHER_LAWS
        with np.errstate(all="ignore"):  # what cannot be computed explains nothing
            for stage in stages:
                named = repeated.confirmed(_explaining(case, stage, check))
                if named:
                    return _with_alternatives(named)
    return _unknown(check)


def _with_alternatives(named: list[Diagnosis]) -> Diagnosis:
    """Return the best diagnosis, with the others that explain the samples as well."""
    first, *others = named
    as_good = [diagnosis for diagnosis in others if diagnosis.share >= first.share - AS_GOOD]
    return replace(first, alternatives=tuple(as_good))


def _explaining(case: FaultySteps, stage: Iterable[Cause], check: Verdict) -> Iterator[Explanation]:
    """Yield the candidates of a stage that explain the steps of a `case`.

    One without a change has to explain the largest defect of the `check` too, wherever that is.
    """
    sizes = larger(check.defects / check.allowed)
    largest = int(np.argmax(np.where(np.isfinite(sizes), sizes, 0.0)))
    inside = case.offset <= largest < case.offset + len(case.sizes)
    elsewhere = None
    for cause in stage:
        for candidate in _candidates(case, cause):
            if inside or candidate.words:
                yield candidate
                continue
            elsewhere = elsewhere or FaultySteps(check, largest)
            if candidate.name in {known.name for known in _candidates(elsewhere, cause)}:
                yield candidate


def _candidates(case: FaultySteps, cause: Cause) -> Iterator[Explanation]:
    """Yield the candidates of one cause that explain enough, with the share that they explain."""
    for candidate in cause(case):
        share = candidate.diagnosis.share
        if candidate.left is not None:
            share = case.share(candidate.left)
        if share >= ENOUGH:
            yield candidate._replace(diagnosis=replace(candidate.diagnosis, share=share))


# -- the check repeated with a change --------------------------------------------------------------


class Repeated:
    """A check that is repeated with changes, as often as is allowed."""

    def __init__(self, check: Verdict) -> None:
        self.check = check
        self.left = MOST_REPEATED

    def confirmed(self, candidates: Iterable[Explanation]) -> list[Diagnosis]:
        """Return the diagnoses that repeated checks confirm, the best first, each name once."""
        named = dict[tuple[str, str], Diagnosis]()
        for candidate in sorted(candidates, key=lambda proposal: -proposal.diagnosis.share):
            if candidate.name in named:
                continue
            diagnosis = self.with_evidence(candidate)
            if diagnosis is not None and diagnosis.share >= ENOUGH:
                named[candidate.name] = diagnosis
        return sorted(named.values(), key=lambda proposal: -proposal.share)

    def with_evidence(self, candidate: Explanation) -> Diagnosis | None:
        """Add the result of the check with a candidate's change to the diagnosis.

        None: the change is not possible, or the check has been repeated often enough.
        """
        diagnosis = candidate.diagnosis
        change = candidate.words
        if not change:
            return diagnosis
        if not self.left:
            return None
        self.left -= 1
        again = self._check_with(candidate)
        if again is None:
            return None
        wrong = len(again.wrong_steps)
        steps = len(again.defects)
        words = f"{change} all {steps} steps are right"
        share = 1.0
        if wrong or len(again.wrong_spans):
            before, after = (
                larger(result.defects / result.allowed) for result in (self.check, again)
            )
            measure = explained_share if len(before) == len(after) else mended_share
            share = measure(before, after)
            words = f"{change} {wrong} of {steps} steps are wrong"
        evidence = "; ".join(filter(None, (diagnosis.evidence, words)))
        return replace(diagnosis, evidence=evidence, share=share)

    def _check_with(self, candidate: Explanation) -> Verdict | None:
        """Return the check with a candidate's change; None if it is not possible."""
        task = self.check.task
        samples = task.samples
        if candidate.columns is not None:
            t, x, v = candidate.columns(samples.t, samples.x, samples.v)
            if v is None:
                v = np.full(len(t), np.nan)
            samples = replace(samples, t=t, x=x, v=v)
        elif samples.v_off is not None:  # the velocities were those of the system
            samples = replace(samples, v=np.full(len(samples.t), np.nan))
        samples = replace(samples, events=None, dense=None, v_off=None)
        try:
            again = judge(
                replace(task, samples=samples, scene=candidate.parameters or task.parameters)
            )
        except ParameterError:
            return None
        if again.task.samples.v_off is not None and len(again.t) < FEWEST_LEFT * len(self.check.t):
            return None
        return again


# -- what is said where no cause is named ----------------------------------------------------------


def _start(check: Verdict) -> Iterator[Diagnosis]:
    """Yield the diagnosis of another start, if a note of the check or the global error shows it."""
    words = "every step is right, but the motion starts elsewhere, or errors of the steps add up"
    if check.wrong_start:
        yield Diagnosis("start", "", check.wrong_start, "every step is right")
    elif np.any(np.abs(check.errors) > check.limits):
        yield Diagnosis(
            "start",
            "",
            words,
            f"off by {check.max_error_x:.2g} in x and {check.max_error_v:.2g} in v",
        )


def _unknown(check: Verdict) -> Diagnosis:
    """Return the diagnosis that the cause is unknown."""
    words = "the cause is unknown"
    first = check.first_wrong
    if first:
        words += f"; the first wrong step begins at t = {first.t:.10g}: {first.words}"
    return Diagnosis(
        "unknown",
        "",
        words,
        "no cause explains the first wrong step and the largest defect",
        share=0.0,
    )
