"""Columns that are no samples of the motion: velocities made from x, uneven clocks, frozen sticks, interpolation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Candidate, Change, Diagnosis
from symosc.crosschecks.clues import Clues
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.steps import follow_steps
from symosc.crosschecks.velocities import with_velocities
from symosc.errors import ParameterError

# Columns are made again if all but this part of the samples agree, to this part of what the rest differs by.
EXCEPTIONS, AGREES = 0.1, 0.02
# Samples on straight lines: so many of three in a row, to this part of the largest value.
COLLINEAR, STRAIGHT = 0.25, 1e-12
# Times are an even grid up to this part of a step, or of themselves as a single-precision number.
NEARLY_EVEN, SINGLE = 0.2, 2e-6
CLOSER, SINGLE_ENOUGH = 0.2, 0.7
FEWEST, FEWEST_ALONE = 8, 60
Grid = Callable[[np.ndarray], np.ndarray]
Columns = tuple[np.ndarray, np.ndarray, np.ndarray]
POSITIONS_ALONE = Change("with positions alone", columns=lambda t, x, v: (t, x, None))


def no_motion(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Diagnosis | None:
    """Return that the samples never move, if they do not."""
    if np.ptp(x) or np.ptp(v):
        return None
    words, evidence = "x and v never change: the mass does not move", f"x = {x[0]:.10g}, v = {v[0]:.10g} in all samples"
    return Diagnosis("columns", "x and v", words, evidence)


def column_faults(clues: Clues) -> Iterator[Candidate]:
    """Yield what is wrong in how the columns were made."""
    if len(clues.steps.t) >= FEWEST:
        yield from _velocity_column(clues)
        yield from _frozen(clues)
        yield from _resampled(clues)


def other_times(clues: Clues) -> Iterator[Candidate]:
    """Yield times that are off by themselves, and belong to an even grid or are in single precision."""
    if len(clues.steps.t) >= FEWEST:
        yield from _even_times(clues)
        yield from _single_times(clues)


def gradient(t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return differences of x: central ones, one-sided at the ends."""
    return np.asarray(np.gradient(x, t))


def _velocity_column(clues: Clues) -> Iterator[Candidate]:
    """Yield how v was made from right positions: by differences, or at times between the samples."""
    s, h = clues.steps, np.diff(clues.steps.t)
    if np.any(h <= 0.0):
        return
    slopes = np.diff(s.x) / h
    made = {
        "v is gradient(x): differences of neighbouring x": gradient(s.t, s.x),
        "v is the difference of x to the sample before, over the step": np.append(np.nan, slopes),
        "v is the difference of x to the next sample, over the step": np.append(slopes, np.nan),
    }
    for words, v in made.items():
        off = np.abs(v - s.v)[1:-1] / np.max(np.abs(s.v))
        if np.mean(off <= 1e-9 + 4.0 * np.finfo(float).eps * np.max(np.abs(s.x)) / np.min(h)) >= 1.0 - EXCEPTIONS:
            yield Candidate(Diagnosis("columns", "v", words, "repeats v to 9 digits"), POSITIONS_ALONE)
            return
    exact = _from_positions(clues)
    if exact is None:
        return
    first, v = exact
    size = np.median(np.abs(v - s.v[first:])) if len(v) else 0.0
    for part, words in ((0.5, "v is half a sample late"), (-0.5, "v is half a sample early")):
        there = _at_other_times(clues, first, v, part)
        good = np.isfinite(there)
        near = np.abs(there - s.v[first:])[good] <= max(AGREES * size, clues.allowed[0, 1])
        if len(near) and np.mean(near) >= 1.0 - EXCEPTIONS:
            found = Diagnosis("columns", "v", words, f"repeats {np.mean(near):.0%} of v", part)
            yield Candidate(found, POSITIONS_ALONE)
            return


def other_velocities(clues: Clues) -> Iterator[Candidate]:
    """Yield that x alone is right, whatever v is."""
    exact = _from_positions(clues) if len(clues.inside) >= FEWEST_ALONE else None
    if exact is not None:
        s, (first, v) = clues.steps, exact
        share = clues.share_of(s.t[first:], s.x[first:], v)
        found = Diagnosis("columns", "v", "v is not the velocity of x; the positions are right", "", share=share)
        yield Candidate(found, POSITIONS_ALONE)


def _from_positions(clues: Clues) -> tuple[int, np.ndarray] | None:
    """Return the velocities that belong to the positions, from the first sample that has one on."""
    s = clues.steps
    unknown = np.full(len(s.t), np.nan)
    try:
        found = with_velocities(
            Samples(s.t, s.x, unknown), clues.parameters, float(clues.allowed[0, 0] / clues.scales[0])
        )
    except ParameterError:
        return None
    return len(s.t) - len(found.t), found.v


def _at_other_times(clues: Clues, first: int, v: np.ndarray, part: float) -> np.ndarray:
    """Return the exact velocity a part of a step before each sample (negative: after it); NaN where there is none."""
    s = clues.steps
    t, x = s.t[first:], s.x[first:]
    h = np.diff(t)
    since, time = np.arange(len(h)), (t[1:] if part > 0.0 else t[:-1]) - part * h
    rows = np.stack([np.column_stack([t, x, v])[since], np.column_stack([time, x[since], 0.0 * time])], axis=1)
    pairs_t, pairs_x, pairs_v = rows.reshape(-1, 3).T
    near = np.repeat(clues.near[first:][since], 2)
    ends = follow_steps(clues.parameters, pairs_t, pairs_x, pairs_v, near, clues.scales).defects[::2, 1]
    return np.append(np.nan, ends) if part > 0.0 else np.append(ends, np.nan)


def _even_times(clues: Clues) -> Iterator[Candidate]:
    """Yield times that are an even grid, but written or added up with few digits."""
    t = clues.steps.t
    h, step = np.diff(t), float((t[-1] - t[0]) / (len(t) - 1))
    if np.ptp(h) == 0.0 or not np.max(np.abs(h - step)) <= NEARLY_EVEN * step:
        return
    off = float(np.max(np.abs(t - np.linspace(t[0], t[-1], len(t)))))
    if off <= 16.0 * np.spacing(np.max(np.abs(t))):
        return
    single = off <= 1e3 * np.spacing(np.float32(np.max(np.abs(t))))
    words = f"the times are no even grid, by up to {off:.1e}" + (": single precision" if single else "")
    grids: list[Grid] = [partial(_even, digits=digits) for digits in (0, 7, 6, 5, 4, 3, 2)]
    for make in (*grids, _rounded_ends):
        even = make(t)
        if np.max(np.abs(even - t)) <= max(0.5 * step, SINGLE * float(np.max(np.abs(t)))):
            share = clues.share_of(even, clues.steps.x, clues.steps.v)
            change = f"with even times, {even[1] - even[0]:.10g} apart,"
            yield Candidate(Diagnosis("columns", "t", words, "", share=share),
                            Change(change, columns=partial(_with_times, make)))  # fmt: skip


def _with_times(make: Callable[[np.ndarray], np.ndarray], t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    return make(t), x, v


def _even(t: np.ndarray, digits: int) -> np.ndarray:
    """Return an even grid; the first time and the step may be rounded themselves (digits of the step, 0: all)."""
    if not digits:
        return np.linspace(float(t[0]), float(t[-1]), len(t))
    step = float(f"{(t[-1] - t[0]) / (len(t) - 1):.{digits}g}")
    return np.asarray(float(f"{t[0]:.6g}") + step * np.arange(len(t)))


def _rounded_ends(t: np.ndarray) -> np.ndarray:
    return np.linspace(float(f"{t[0]:.6g}"), float(f"{t[-1]:.6g}"), len(t))


def _single_times(clues: Clues) -> Iterator[Candidate]:
    """Yield times that are each off by themselves: in single precision, a shift of each explains its step."""
    s = clues.steps
    if not np.array_equal(s.t.astype(np.float32).astype(float), s.t) or np.array_equal(s.t, np.rint(s.t)):
        return
    chosen = clues.inside
    if not len(chosen):
        return
    domain = clues.label[chosen]
    force = np.array([s.K.A1, s.K.A2, s.K.A3])[domain - 1]
    v = s.v[chosen + 1]
    a = force + s.K.f0 * np.cos(s.theta[chosen + 1]) - s.K.w0sq * s.x[chosen + 1] - s.K.cm * v
    slopes = np.column_stack([v, a]) / clues.allowed[chosen]
    misses = s.defects[chosen] / clues.allowed[chosen]
    shift = np.sum(slopes * misses, axis=1) / np.sum(slopes * slopes, axis=1)
    within = np.abs(shift) <= 2.0 * np.spacing(np.abs(s.t[chosen + 1]).astype(np.float32)).astype(float)
    left = np.max(np.abs(misses - slopes * shift[:, None]), axis=1)
    explained = np.where(within, left, np.inf)
    part = clues.share(explained, chosen, CLOSER)
    largest = float(np.max(np.abs(shift[within]), initial=0.0))
    evidence = f"all are such numbers; shifts of them by up to {largest:.1e} repeat {max(part, 0.0):.0%} of the flights"
    # Numbers of single precision in all samples are no chance.
    found = Diagnosis("columns", "t", "the times are in single precision", evidence, largest)
    yield Candidate(replace(found, share=1.0 if part >= SINGLE_ENOUGH else part))


def _frozen(clues: Clues) -> Iterator[Candidate]:
    """Yield positions that stand still in a stick, in which the belt carries the mass along."""
    speeds = (float(clues.parameters.v1), float(clues.parameters.v2))

    def moved(t: np.ndarray, x: np.ndarray, v: np.ndarray, later: bool = False) -> Any:
        held = (np.diff(x) == 0.0) & (np.diff(v) == 0.0) & np.isin(v[:-1], speeds)
        way = np.append(0.0, np.where(held, v[:-1] * np.diff(t), 0.0))
        total = np.cumsum(way)
        runs = np.append(False, held)  # each sample of a run is moved by what the run has made of it so far
        begin = np.maximum.accumulate(np.where(runs, 0, np.arange(len(t))))
        return t, x + np.where(runs, total - total[begin], 0.0), v

    s = clues.steps
    x = moved(s.t, s.x, s.v)[1]
    still = np.flatnonzero((x != s.x)[1:])
    if not len(still) or not any(speeds):
        return
    words = f"x stands still in {len(still)} samples of sticks, where the belt carries the mass along"
    share = clues.share_of(s.t, x, s.v)
    if share > 0.0:
        yield Candidate(Diagnosis("columns", "x", words, "", share=share),
                        Change("with x moved on by the belt", columns=moved))  # fmt: skip
    wrong = np.flatnonzero(clues.wrong)
    # A solver that goes on from where x stood: only the steps of the sticks are wrong.
    inside = float(np.mean(np.isin(wrong, still)))
    evidence = f"{inside:.0%} of the wrong steps are such"
    yield Candidate(Diagnosis("columns", "x", words, evidence, share=inside))


def _resampled(clues: Clues) -> Iterator[Candidate]:
    """Yield samples on straight lines between fewer samples."""
    s = clues.steps

    def bends(t: np.ndarray, values: np.ndarray) -> np.ndarray:
        h = np.diff(t)
        slope = np.diff(values) / np.where(h > 0.0, h, np.nan)
        limit = STRAIGHT * max(float(np.max(np.abs(values))), 1e-300) / np.where(h > 0.0, h, np.nan)
        return np.asarray(~(np.abs(np.diff(slope)) <= 2.0 * (limit[1:] + limit[:-1])))

    def knots(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Any:
        kept = np.concatenate([[True], bends(t, x) | bends(t, v), [True]])
        return t[kept], x[kept], v[kept]

    bent = bends(s.t, s.x) | bends(s.t, s.v)
    flat = np.diff(s.v)[:-1] == 0.0  # on a belt a line is right
    straight = ~bent & ~flat
    if np.sum(straight) < COLLINEAR * np.sum(~flat) or np.sum(straight) < FEWEST // 2:
        return
    count = int(np.sum(bent)) + 2
    words = f"the samples lie on straight lines between {count} others: linear interpolation"
    evidence = f"{int(np.sum(straight))} of {len(s.t)} samples lie on the line through their neighbours, in x and in v"
    share = clues.share_of(*knots(s.t, s.x, s.v)) if count < len(s.t) - FEWEST // 2 else 0.0
    found = Diagnosis("resampling", "", words, evidence)
    if share >= 0.9:
        yield Candidate(found, Change("with these alone", columns=knots))
    else:
        yield Candidate(found)
