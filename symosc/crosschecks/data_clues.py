"""Whether the numbers themselves are at fault: too few digits, noise, single samples, or the list of events."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Candidate, Change, Diagnosis
from symosc.crosschecks.clues import Clues

# Noise makes the defects of neighbouring steps opposite: their correlation is about -0.5.
NOISE_CORRELATION = -0.25
FEW_NOISY = 12


def listed(check: Any) -> Iterator[Diagnosis]:
    """Yield what a list of events lacks, and what it has too much, where the samples are right."""
    missed, invented = check.missed, check.invented
    if missed and len(missed) == len(invented) and [e.kind for e in missed] == [e.kind for e in invented]:
        off = [found.t - float(exact.t) for found, exact in zip(invented, missed, strict=True)]
        worst = max(off, key=abs)
        yield Diagnosis("event times", "", f"{len(off)} events of the list are at wrong times, by up to {worst:.3g}",
                        "the samples are right", worst, None)  # fmt: skip
        return
    for cause, events, what in (
        ("missing events", missed, "lacks"), ("invented events", invented, "has, and the motion has not,"),
    ):  # fmt: skip
        if events:
            first = f"{events[0].kind} at t = {float(events[0].t):.10g}"
            words = f"the list {what} {len(events)} event{'s' if len(events) > 1 else ''}, first: {first}"
            yield Diagnosis(cause, "", words, "the samples are right", float(len(events)), 0.0)


def outliers(check: Any) -> Iterator[Candidate]:
    """Yield samples that are off by themselves: without them the steps are right."""
    off = [fault for fault in check.faults if fault.reason == "outlier"]
    explained = {step for fault in off for step in (fault.step, fault.step + 1)} & set(check.wrong_steps.tolist())
    if off:
        words = f"{len(off)} sample{'s are' if len(off) > 1 else ' is'} off, the first is number {off[0].step + 1}"
        sizes = [max(abs(fault.defect_x), abs(fault.defect_v)) for fault in off]
        share = len(explained) / len(check.wrong_steps)
        found = Diagnosis("outlier", "", words, "", float(np.median(sizes)), None, share)
        rows = [fault.step + 1 for fault in off]
        without = "without them" if len(off) > 1 else "without it"
        yield Candidate(found, Change(without, columns=lambda *columns: tuple(np.delete(c, rows) for c in columns)))


def noise(clues: Clues) -> Iterator[Diagnosis]:
    """Yield noise: each sample is off by itself, by so much on average.

    Its error is in the defect before it, and carried on in the defect after it.
    """
    inside = clues.inside[clues.wrong[clues.inside]]
    pairs = inside[:-1][np.diff(inside) == 1]
    if len(pairs) < FEW_NOISY:
        return
    s, defects, found = clues.steps, clues.steps.defects, []
    # What the error of a sample in between, minus the defect before it, makes of the next step.
    moved = replace(s, x=s.x.copy(), v=s.v.copy())
    moved.x[pairs + 1] += defects[pairs, 0]
    moved.v[pairs + 1] += defects[pairs, 1]
    domain = clues.label[pairs + 1]
    one = moved.flight(domain, pairs + 1, pairs + 2) - s.flight(domain, pairs + 1, pairs + 2)
    for column in (0, 1):
        next_one = defects[pairs + 1, column]
        found.append(
            float(np.sum(one[:, column] * next_one) / np.sqrt(np.sum(one[:, column] ** 2) * np.sum(next_one**2)))
        )
    if max(found) < 0.0 and min(found) < NOISE_CORRELATION:
        sizes = np.sqrt(np.median(defects[inside] ** 2, axis=0) / 0.455 / 2.0)
        words = f"the samples have noise of about {sizes[0]:.2g} in x and {sizes[1]:.2g} in v"
        evidence = (
            f"what one step is off, the next one takes back: correlation {found[0]:.2f} in x, {found[1]:.2f} in v"
        )
        error = float(sizes[1] / np.sqrt(2.0 * len(inside)))
        yield Diagnosis("noise", "", words, evidence, float(sizes[1]), error, 0.99 * clues.flights_wrong)


def digits(check: Any) -> Iterator[Diagnosis]:
    """Yield how few digits the columns have."""
    if check.rounded:
        columns = ", ".join(f"{name} to {text}" for name, text in check.rounded.items())
        yield Diagnosis("precision", ", ".join(check.rounded), f"the samples are rounded: {columns}",
                        "all numbers of these columns fit that grid", share=0.0)  # fmt: skip
