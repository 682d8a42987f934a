"""Whether the numbers themselves are at fault: too few digits, noise, single samples, or the list of events."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues

# Columns in other units: so many times too large or too small.
UNIT_FACTORS = (1000.0, 100.0, 0.01, 0.001)
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


def outliers(check: Any) -> Iterator[Diagnosis]:
    """Yield samples that are off by themselves: without them the steps are right."""
    off = [fault for fault in check.faults if fault.reason == "outlier"]
    explained = {step for fault in off for step in (fault.step, fault.step + 1)} & set(check.wrong_steps.tolist())
    if off:
        words = f"{len(off)} sample{'s are' if len(off) > 1 else ' is'} off, the first is number {off[0].step + 1}"
        sizes = [max(abs(fault.defect_x), abs(fault.defect_v)) for fault in off]
        share = len(explained) / len(check.wrong_steps)
        yield Diagnosis("outlier", "", words, off[0].words, float(np.median(sizes)), None, share)


def other_units(clues: Clues) -> Iterator[Diagnosis]:
    """Yield columns in other units: x, v or both are a power of ten too large or too small."""
    s, step = clues.steps, np.diff(clues.steps.t)
    way = float(np.sum(np.abs(s.v[1:] + s.v[:-1]) * step) / 2.0)
    ratio = float(np.sum(np.abs(np.diff(s.x)))) / way if way else 1.0
    for factor in UNIT_FACTORS:
        columns = {"x": (factor, (s.x / factor, s.v)), "v": (1.0 / factor, (s.x, s.v / factor))}
        for name, (expected, (x, v)) in (columns | {"x and v": (1.0, (s.x / factor, s.v / factor))}).items():
            if 0.5 < ratio / expected < 2.0:  # x must be the way that v makes
                share = clues.share(clues.followed(clues.parameters, x=x, v=v))
                size = f"{factor:g} times too large" if factor > 1.0 else f"{1.0 / factor:g} times too small"
                evidence = f"divided by {factor:g} the steps are right"
                yield Diagnosis(
                    "columns",
                    name,
                    f"{name} {'are' if name == 'x and v' else 'is'} {size}: other units",
                    evidence,
                    factor,
                    0.0,
                    share,
                )


def noise(clues: Clues) -> Iterator[Diagnosis]:
    """Yield noise: each sample is off by itself, by so much on average."""
    inside = clues.inside[clues.wrong[clues.inside]]
    pairs = inside[:-1][np.diff(inside) == 1]
    if len(pairs) < FEW_NOISY:
        return
    defects, found = clues.steps.defects, []
    for column in (0, 1):
        one, next_one = defects[pairs, column], defects[pairs + 1, column]
        found.append(float(np.sum(one * next_one) / np.sqrt(np.sum(one**2) * np.sum(next_one**2))))
    if max(found) < 0.0 and min(found) < NOISE_CORRELATION:
        sizes = np.sqrt(np.median(defects[inside] ** 2, axis=0) / 0.455 / 2.0)
        words = f"the samples have noise of about {sizes[0]:.2g} in x and {sizes[1]:.2g} in v"
        evidence = f"defects of neighbouring steps are opposite: correlation {found[0]:.2f} in x, {found[1]:.2f} in v"
        error = float(sizes[1] / np.sqrt(2.0 * len(inside)))
        yield Diagnosis("noise", "", words, evidence, float(sizes[1]), error, clues.flights_wrong)


def digits(check: Any) -> Iterator[Diagnosis]:
    """Yield how few digits the columns have."""
    if check.rounded:
        columns = ", ".join(f"{name} to {text}" for name, text in check.rounded.items())
        yield Diagnosis("precision", ", ".join(check.rounded), f"the samples are rounded: {columns}",
                        "all numbers of these columns fit that grid", share=0.0)  # fmt: skip
