"""What is probably wrong in a solution: every cause is tried on the wrong steps, and the best ones are named."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.crosschecks import data_clues, event_clues, friction_clues, method_clues, other_models, stick_clues
from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues, clue_samples
from symosc.crosschecks.faults import REASONS
from symosc.crosschecks.other_models import AS_GOOD, ENOUGH
from symosc.crosschecks.smoothed_flights import smoothed_flights
from symosc.engine.next_event import TWO_PI

# A cause that explains less of the wrong steps is not named.
NAMED = 0.3
# Forcing periods of which no sample is needed. Longer steps hold so many events that they tell nothing of a cause, and
# each cause would take long to try.
UNSEEN_PERIODS = 200.0


def diagnose(check: Any) -> tuple[Diagnosis, ...]:
    """Return what is probably wrong in the samples of a `CrossCheck`, the likeliest first.

    Each cause is put to the test: another model is followed over all steps, and has to make the wrong ones right.
    Where several explain the samples as well, the others are the `alternatives` of the first.
    """
    few_digits = tuple(data_clues.digits(check))
    if check.ok:
        return few_digits
    if not len(check.wrong_steps):
        found = tuple(data_clues.listed(check)) or (_start(check),)
        return (*found, *few_digits)
    if _too_long(check):
        return (_unknown(check), *few_digits)
    with np.errstate(all="ignore"):  # what cannot be computed explains nothing
        found = _best(Clues.of(check), check)
    return (*found, *few_digits)


def _too_long(check: Any) -> bool:
    """Return whether there are fewer samples than forcing periods around the wrong steps."""
    t = check.t[clue_samples(check)]
    periods = (t[-1] - t[0]) * float(check.trajectory.parameters.Omega) / TWO_PI
    return bool(periods > max(UNSEEN_PERIODS, len(t)))


def _best(clues: Clues, check: Any) -> tuple[Diagnosis, ...]:
    """Return what explains the wrong steps; causes that cost more are tried only if the cheaper ones do not."""
    tried: list[Diagnosis] = []
    for stage in (_simple, _models, _methods, _sticks, _delays, _rest):
        tried += stage(clues, check)
        tried.sort(key=lambda one: -one.share)
        if tried and tried[0].share >= ENOUGH:
            break
    good = [one for one in tried if one.share >= max(NAMED, tried[0].share - AS_GOOD)] if tried else []
    if not good:
        return (_unknown(check),)
    return (replace(good[0], alternatives=(*good[0].alternatives, *_others(good))),)


def _others(good: list[Diagnosis]) -> Iterator[Diagnosis]:
    """Yield the diagnoses after the first, each once; of several that name a method, one is enough."""
    seen = {_name(good[0])}
    for one in good[1:]:
        if _name(one) not in seen:
            seen.add(_name(one))
            yield one


def _name(one: Diagnosis) -> tuple[str, str]:
    return one.cause, one.subject if one.cause in ("coefficient", "sign", "columns") else ""


def _simple(clues: Clues, check: Any) -> Iterator[Diagnosis]:
    yield from data_clues.outliers(check)
    yield from data_clues.noise(clues)
    yield from other_models.other_signs(clues)
    yield from other_models.phases_of_drive(clues, check.own_start)
    yield from other_models.sign_of_friction(clues)


def _models(clues: Clues, check: Any) -> Iterator[Diagnosis]:
    yield from data_clues.other_units(clues)
    yield from event_clues.double_roots(clues)
    yield from other_models.coefficients(clues)


def _methods(clues: Clues, check: Any) -> Iterator[Diagnosis]:
    yield from method_clues.repeated(clues)


def _sticks(clues: Clues, check: Any) -> Iterator[Diagnosis]:
    yield from smoothed_flights(clues)
    yield from friction_clues.at_belts(clues)
    yield from stick_clues.stick_ends(clues)
    yield from stick_clues.drift_within_steps(clues)


def _delays(clues: Clues, check: Any) -> Iterator[Diagnosis]:
    yield from event_clues.delays(clues)
    yield from friction_clues.smoothed_passages(clues)


def _rest(clues: Clues, check: Any) -> Iterator[Diagnosis]:
    yield from method_clues.truncation(clues)
    yield from other_models.forces(clues)


def _start(check: Any) -> Diagnosis:
    words = "every step is right, but the motion starts elsewhere, or errors of the steps add up"
    return Diagnosis("start", "", words, f"off by {check.max_error_x:.2g} in x and {check.max_error_v:.2g} in v")


def _unknown(check: Any) -> Diagnosis:
    first = check.first_wrong
    words = f"the first wrong step: {REASONS[first.reason]} ({first.words})" if first else "no step tells what it is"
    return Diagnosis("unknown", "", words, "no single cause explains most of the wrong steps", share=0.0)
