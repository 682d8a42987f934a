"""The probable causes of errors in a solution.

Each is tried on the wrong steps, and the best are reported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.crosschecks import columns, friction, methods, models
from symosc.crosschecks.causes import (
    AS_GOOD,
    REASONS,
    SURE,
    Candidate,
    Case,
    Diagnosis,
    explained_share,
    larger,
    mended_share,
    tried_samples,
)
from symosc.crosschecks.models import ENOUGH
from symosc.engine.next_event import TWO_PI
from symosc.errors import ParameterError

# A cause that explains less of the wrong steps is not named.
NAMED = 0.3
#: The alternatives, stage by stage, the cheapest first.
STAGES: tuple[tuple[Callable[[Case], Iterable[Candidate | Diagnosis]], ...], ...] = (
    (
        columns.outliers,
        columns.noise,
        columns.other_columns,
        columns.even_times,
        columns.single_times,
    ),
    (models.other_systems, models.phases_of_drive),
    (columns.velocity_column, columns.frozen_positions, columns.resampled),
    (methods.double_roots, models.coefficients),
    (models.far_coefficients,),
    (methods.known_methods, methods.interpolated),
    (
        friction.smoothed_flights,
        friction.at_belts,
        friction.stick_ends,
        friction.drift_within_steps,
    ),
    (methods.delays, friction.smoothed_passages),
    (columns.other_velocities, methods.truncation, models.forces),
)


def diagnose(check: Any) -> tuple[Diagnosis, ...]:
    """Return the probable causes of the errors of a `CrossCheck`, the most probable first."""
    # Each alternative is followed over all steps, and has to make the wrong ones right. For those
    # that are named the whole check is repeated with the change, and its result is their evidence.
    # Where several explain the samples as well, the others are the `alternatives` of the first.
    few_digits = tuple(columns.few_digits(check))
    if check.ok:
        return few_digits
    if check.coarser is not None:
        return diagnose(check.coarser)
    if not len(check.wrong_steps):
        if check.missed or check.invented:
            found: Iterable[Diagnosis] = columns.event_list_faults(check)
        else:
            found = _start(check)
        return (*found, *few_digits)
    if not (np.ptp(check.x) or np.ptp(check.v)):
        words = "x and v never change: the mass does not move"
        evidence = "x = {:.10g}, v = {:.10g} in all samples"
        return (
            Diagnosis("columns", "x and v", words, evidence.format(check.x[0], check.v[0])),
            *few_digits,
        )
    t = check.t[tried_samples(check)]
    periods = (t[-1] - t[0]) * float(check.trajectory.parameters.Omega) / TWO_PI
    if periods > max(
        200.0, len(t)
    ):  # steps longer than a period hold too many events to show a cause
        units = columns.changed_columns(check.trajectory.parameters, check.t, check.x, check.v)
        tried = (with_evidence(one, check) for one in units if one.diagnosis.subject == "t")
        right = next(
            (found for found in tried if found is not None and found.share >= ENOUGH), None
        )
        return (right or _unknown(check), *few_digits)
    with np.errstate(all="ignore"):  # what cannot be computed explains nothing
        return (*_best(Case(check), check), *few_digits)


def _best(case: Case, check: Any) -> tuple[Diagnosis, ...]:
    """Return the diagnosis that explains the wrong steps best.

    Expensive causes are tried only if cheap ones fail.
    """
    tried: list[Candidate] = []
    named: list[Diagnosis] = []
    for number, stage in enumerate(STAGES):
        found = [one for alternatives in stage for one in alternatives(case)]
        candidates = [one if isinstance(one, Candidate) else Candidate(one) for one in found]
        of_sticks = ("stick left early", "stick left late", "drift", "chatter")
        tried += [one for one in candidates if case.sticks or one.diagnosis.cause not in of_sticks]
        tried.sort(key=lambda one: -one.diagnosis.share)
        if tried and tried[0].diagnosis.share >= ENOUGH:
            named = _tested(tried, check)
            # A cause of the first stages must make all steps right.
            if named and named[0].share >= (SURE if number < 3 else ENOUGH):
                break
    named = named or _tested(tried, check)
    if not named:
        return (_unknown(check),)
    first, *others = (replace(one, share=min(one.share, 1.0)) for one in named)
    return (replace(first, alternatives=(*first.alternatives, *others)),)


def _tested(tried: list[Candidate], check: Any) -> list[Diagnosis]:
    """Repeat the check with the changes of the best candidates.

    Return the diagnoses that these checks confirm.
    """
    waiting = list(tried)
    while waiting and (best := waiting[0].diagnosis.share) >= NAMED:
        good = [one for one in waiting if one.diagnosis.share >= max(NAMED, best - AS_GOOD)]
        waiting = waiting[len(good) :]
        seen: dict[tuple[str, str], Diagnosis] = {}
        for one in good:
            cause = one.diagnosis.cause
            subject = one.diagnosis.subject
            name = cause, subject if cause in ("coefficient", "sign", "columns") else ""
            if len(seen) < 6 and name not in seen:
                diagnosis = with_evidence(one, check)
                if diagnosis is not None and diagnosis.share >= NAMED:
                    seen[name] = diagnosis
        if seen:
            found = sorted(seen.values(), key=lambda one: -one.share)
            return [one for one in found if one.share >= found[0].share - 1.001 * AS_GOOD]
    return []


def with_evidence(candidate: Candidate, check: Any) -> Diagnosis | None:
    """Repeat the CrossCheck `check` with a candidate's change; add its result to the diagnosis.

    None: not possible.
    """
    diagnosis = candidate.diagnosis
    change = candidate.words
    if not change:
        return diagnosis
    task = check._task
    samples = check._task.samples
    if candidate.columns is not None:
        t, x, v = candidate.columns(samples.t, samples.x, samples.v)
        samples = replace(samples, t=t, x=x, v=np.full(len(t), np.nan) if v is None else v)
    elif samples.v_off is not None:  # the velocities were those of the system
        samples = replace(samples, v=np.full(len(samples.t), np.nan))
    samples = replace(samples, events=None, dense=None, v_off=None)
    try:
        scene = candidate.parameters or task.parameters
        again = replace(task, samples=samples, scene=scene, rounding=None).verdict()
    except ParameterError:
        return None
    if again._task.samples.v_off is not None and len(again.t) < 0.9 * len(check.t):
        return None
    wrong = len(again.wrong_steps)
    steps = len(again.defects)
    words = f"{change} all {steps} steps are right"
    share = SURE
    if wrong or len(again.wrong_spans):
        before, after = (larger(one.defects / one.allowed) for one in (check, again))
        share = (explained_share if len(before) == len(after) else mended_share)(before, after)
        words = f"{change} {wrong} of {steps} steps are wrong"
    return replace(
        diagnosis, evidence="; ".join(filter(None, (diagnosis.evidence, words))), share=share
    )


def _start(check: Any) -> Iterable[Diagnosis]:
    """Yield the diagnosis of a start other than the scene's, if a note of the check or the global error shows it."""
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


def _unknown(check: Any) -> Diagnosis:
    """Return the diagnosis that the cause is unknown."""
    first = check.first_wrong
    if first:
        words = f"the first wrong step: {REASONS[first.reason]} ({first.words})"
    else:
        words = "no step tells what it is"
    return Diagnosis(
        "unknown", "", words, "no single cause explains most of the wrong steps", share=0.0
    )
