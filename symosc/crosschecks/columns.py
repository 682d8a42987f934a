"""Wrong columns as causes.

Signs, units, order, velocities made from x, uneven clocks, few digits, noise, outliers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from math import pi
from typing import NamedTuple

import numpy as np

from symosc.base.errors import ParameterError
from symosc.crosschecks.causes import Diagnosis, Explanation, FaultySteps
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.steps import follow_steps
from symosc.crosschecks.velocities import with_velocities
from symosc.crosschecks.verdict import Verdict
from symosc.model import Model
from symosc.simulation.tables import counted

# In any units x must agree with the integral of v up to this factor.
SAME_WAY = 5.0
# A column counts as made from another one if all but this part of the samples agree.
EXCEPTIONS = 0.1
# Flights that show that positions are right where velocities are not.
FEWEST_FLIGHTS = 60
# Noise makes no defect that is larger than this many of its standard deviations.
MOST_DEVIATIONS = 6.0
# The median of chi-square with 1 degree of freedom: that of (error/deviation)^2 of normal errors.
MEDIAN_CHI2 = 0.455
# Noise shows in at least this many pairs of successive wrong steps.
FEWEST_PAIRS = 12
# White noise makes the correlation of their defects -1/2: these share one sample, whose error is in
# both with opposite signs, and is half of the variance of each. Half of that is enough.
LEAST_CORRELATION = -0.25
FEWEST = 8
# Shifts of times by parts of their last places may leave this part of a defect.
LEFT_BY_SHIFTS = 0.02
Columns = tuple[np.ndarray, np.ndarray, np.ndarray]


# -- signs, places and units -----------------------------------------------------------------------

#: Sizes of other units, as factors.
SIZES = {1000.0: "1000 times too large", 100.0: "100 times too large", 0.01: "100 times too small",
         0.001: "1000 times too small"}  # fmt: skip


def other_columns(case: FaultySteps) -> Iterator[Explanation]:
    """Yield every change of columns that people make by mistake, with the fraction of wrong steps
    that it explains.
    """
    s = case.steps
    for candidate in changed_columns(case.parameters, s.t, s.x, s.v):
        columns = candidate.columns(s.t, s.x, s.v)  # type: ignore[misc]
        share = case.share_mended_by(*columns)
        yield candidate._replace(diagnosis=replace(candidate.diagnosis, share=share))


def changed_columns(p: Model, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Iterator[Explanation]:
    """Yield candidates with other signs, order or units of columns.

    Units only if x and v then give one path length.
    """
    for change in (*_other_signs(p), *_other_units(p)):
        error = None
        if change.value is not None:
            error = 0.0
            # The path from x must be as long as that from v.
            if not _is_same_way(*change.columns(t, x, v)):
                continue
        diagnosis = Diagnosis(change.cause, change.subject, change.words, "", change.value, error)
        yield Explanation(diagnosis, change.result, columns=change.columns)


class Change(NamedTuple):
    """What somebody may have done to the columns by mistake, and how to undo it.

    `result` says what the columns then are, such as "with -x"; `value` is the factor of other units,
    or the speed of a belt.
    """

    cause: str
    subject: str
    words: str
    result: str
    columns: Callable[..., Columns]
    value: float | None = None


def _other_signs(p: Model) -> Iterator[Change]:
    """Yield changes of sign, of order, of the frame, and by one sample."""
    yield Change("sign", "x", "x has the wrong sign", "with -x", lambda t, x, v: (t, -x, v))
    yield Change("sign", "v", "v has the wrong sign", "with -v", lambda t, x, v: (t, x, -v))
    words = "x and v have the wrong sign"
    yield Change("sign", "x and v", words, "with -x, -v", lambda t, x, v: (t, -x, -v))
    words = "the columns x and v are swapped"
    yield Change("columns", "x and v", words, "swapped", lambda t, x, v: (t, v, x))
    for boundary, belt in enumerate(p.law.belts, 1):
        speed = float(belt.v)
        if speed:
            words = f"v is the velocity relative to belt {boundary}"
            result = f"with v + v{boundary}"
            yield Change("columns", "v", words, result, partial(_faster, speed), speed)
    result = "with v of the next sample"
    yield Change("columns", "v", "v is one sample late", result, _with_next_v)
    result = "with v of the sample before"
    yield Change("columns", "v", "v is one sample early", result, _with_v_before)


def _with_next_v(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    """Return the columns with v of the next sample; the last sample has none."""
    return t[:-1], x[:-1], v[1:]


def _with_v_before(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    """Return the columns with v of the sample before; the first sample has none."""
    return t[1:], x[1:], v[:-1]


def _other_units(p: Model) -> Iterator[Change]:
    """Yield changes of the units of x, v or t."""
    m = float(p.m)
    Om = float(p.Omega)
    units = [
        (name, factor, f"{name} {'are' if ' ' in name else 'is'} {size}: other units")
        for factor, size in SIZES.items()
        for name in ("x", "v", "x and v", "t")
    ]
    units += [
        ("v", m, "v is the momentum, m times the velocity"),
        ("v", 1.0 / Om, "v is dx/d(Omega t)"),
        ("t", Om, "t is the phase Omega t of the drive"),
        ("t", Om / (2 * pi), "t is in periods of the drive"),
        ("t", Om * 180 / pi, "t is the phase of the drive in degrees"),
        ("t", 1 / 60, "t is in minutes"),
    ]
    for name, factor, words in units:
        if factor != 1.0:
            result = f"with {name} divided by {factor:.17g}"
            columns = partial(_divided, name.split(" and "), factor)
            yield Change("columns", name, words, result, columns, factor)


def _is_same_way(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> bool:
    """Return whether the path that x makes is about as long as the integral of |v|."""
    by_velocity = float(np.sum(np.abs(v[1:] + v[:-1]) * np.abs(np.diff(t))) / 2.0)
    if not by_velocity:
        return False
    ratio = float(np.sum(np.abs(np.diff(x)))) / by_velocity
    return 1.0 / SAME_WAY < ratio < SAME_WAY


def _faster(speed: float, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    """Return the columns with a belt's speed added to v."""
    return t, x, v + speed


def _divided(names: list[str], factor: float, *columns: np.ndarray) -> Columns:
    """Return the columns t, x, v, those in `names` divided by `factor`."""
    t, x, v = (
        column / factor if name in names else column
        for name, column in zip("txv", columns, strict=True)
    )
    return t, x, v


# -- how the columns were made ---------------------------------------------------------------------


def velocity_column(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that only v is wrong: made of differences of x, or belonging to times
    between samples.
    """
    s = case.steps
    h = np.diff(case.steps.t)
    if len(s.t) < FEWEST or np.any(h <= 0.0):
        return
    words = _difference_that_v_is(case, h)
    if words:
        repeats = Diagnosis("columns", "v", words, "repeats v to 9 digits")
        yield _positions_alone(repeats)
        # Positions far apart in time are no solution alone. So many digits are no chance, but
        # Euler's methods move by such differences too.
        if not _is_euler(case):
            yield Explanation(repeats, left=np.zeros(len(case.sizes)))
        return
    exact = _velocities_from_positions(case)
    if exact is None:
        return
    first, v, off = exact
    if len(v):
        size = np.median(np.abs(v - s.v[first:]))
    else:
        size = 0.0
    _, allowed_v = case.allowed[0]
    for share, words in ((0.5, "v is half a sample late"), (-0.5, "v is half a sample early")):
        beside = _velocities_beside(case, first, v, share)
        misses = np.abs(beside - s.v[first:])[np.isfinite(beside)]
        agrees = misses <= max(0.02 * size, allowed_v)
        if len(agrees) and np.mean(agrees) >= 1.0 - EXCEPTIONS:
            evidence = f"repeats {np.mean(agrees):.0%} of v"
            yield _positions_alone(Diagnosis("columns", "v", words, evidence, share))
            return
    # A few wrong velocities, at an event, are no wrong column.
    is_other = np.abs(v - s.v[first:]) > allowed_v + off
    if len(case.inside) >= FEWEST_FLIGHTS and np.mean(is_other) >= 0.5:
        words = "v is not the velocity of x; the positions are right"
        share_mended = case.share_mended_by(s.t[first:], s.x[first:], v)
        yield _positions_alone(Diagnosis("columns", "v", words, "", share=share_mended))


def _positions_alone(diagnosis: Diagnosis) -> Explanation:
    """Return the explanation that has a diagnosis and is tested without the column v."""
    return Explanation(diagnosis, "with positions alone", columns=lambda t, x, v: (t, x, None))


def _difference_that_v_is(case: FaultySteps, h: np.ndarray) -> str:
    """Return in words which difference of positions over steps `h` the column v is; "" if none."""
    s = case.steps
    slopes = np.diff(s.x) / h
    differences = {
        "v is gradient(x): differences of neighbouring x": np.gradient(s.x, s.t),
        "v is the difference of x to the sample before, over the step": np.append(np.nan, slopes),
        "v is the difference of x to the next sample, over the step": np.append(slopes, np.nan),
    }
    # To 9 digits, but for what the rounding of x makes of differences over short steps.
    allowed = 1e-9 + 4.0 * np.finfo(float).eps * np.max(np.abs(s.x)) / np.min(h)
    for words, v in differences.items():
        off = np.abs(v - s.v)[1:-1] / np.max(np.abs(s.v))
        if np.mean(off <= allowed) >= 1.0 - EXCEPTIONS:
            return words
    return ""


def _is_euler(case: FaultySteps) -> bool:
    """Return whether v changes over most flights by h times the force at one end of the step."""
    s = case.steps
    flights = case.inside
    after = flights + 1
    if not len(flights):
        return True
    domain = case.domain[flights]
    changes = (s.v[after] - s.v[flights]) / (s.t[after] - s.t[flights])
    # Explicit, implicit, and those that move x or v first.
    ends = ((flights, flights), (after, after), (after, flights), (flights, after))
    misses = []
    for of_x, of_v in ends:
        for phase in (s.theta[flights], s.theta[after]):
            a = s.acceleration(domain, s.x[of_x], s.v[of_v], phase)
            misses.append(float(np.median(np.abs(a - changes))))
    return min(misses) <= 1e-6 * float(np.max(np.abs(changes)))


def _velocities_from_positions(
    case: FaultySteps,
) -> tuple[int, np.ndarray, np.ndarray] | None:
    """Return the first sample whose velocity the positions determine, and the velocities from that
    sample on and how far they may be off.
    """
    s = case.steps
    allowed_x, _ = case.allowed[0]
    scale_x, _ = case.scales
    without_v = Samples(s.t, s.x, np.full(len(s.t), np.nan))
    try:
        samples = with_velocities(without_v, case.parameters, float(allowed_x / scale_x))
    except ParameterError:
        return None
    off = np.zeros(len(samples.t)) if samples.v_off is None else samples.v_off
    return len(s.t) - len(samples.t), samples.v, off


def _velocities_beside(case: FaultySteps, first: int, v: np.ndarray, share: float) -> np.ndarray:
    """Return the exact velocities at times beside the samples from number `first` on, which have
    velocities `v`.

    A positive `share` puts each time before its sample, by this share of the step to the sample; a
    negative one puts it after, by -`share` of the next step. NaN for a sample without this step.
    """
    s = case.steps
    t = s.t[first:]
    x = s.x[first:]
    time = (t[1:] if share > 0.0 else t[:-1]) - share * np.diff(t)
    # Pairs of a sample and a state with v = 0 at the time beside: the defect of the step between
    # them is the velocity there.
    begins = np.column_stack([t, x, v])[:-1]
    ends = np.column_stack([time, x[:-1], 0.0 * time])
    pair_t, pair_x, pair_v = np.stack([begins, ends], axis=1).reshape(-1, 3).T
    near = np.repeat(case.near[first:][:-1], 2)
    followed = follow_steps(case.parameters, pair_t, pair_x, pair_v, near, case.scales)
    speeds = followed.defects[::2, 1]  # of v, in each step from a sample to the time beside it
    if share > 0.0:
        return np.append(np.nan, speeds)
    return np.append(speeds, np.nan)


def frozen_positions(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that x stands still during sticks although the belt moves."""
    s = case.steps
    speeds = s.belts.tolist()

    def moved(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
        """Return the columns with x of sticks moved by the way of the belt since the stick began."""
        is_frozen = (np.diff(x) == 0.0) & (np.diff(v) == 0.0) & np.isin(v[:-1], speeds)
        way = np.cumsum(np.append(0.0, np.where(is_frozen, v[:-1] * np.diff(t), 0.0)))
        ends_frozen = np.append(False, is_frozen)  # the samples at which such a step ends
        begin = np.maximum.accumulate(np.where(ends_frozen, 0, np.arange(len(t))))
        return t, x + np.where(ends_frozen, way - way[begin], 0.0), v

    _, x, _ = moved(s.t, s.x, s.v)
    still = np.flatnonzero((x != s.x)[1:])
    if len(s.t) < FEWEST or not len(still) or not any(speeds):
        return
    words = (
        f"x stands still in {len(still)} samples of sticks, where the belt carries the mass along"
    )
    share = case.share_mended_by(s.t, x, s.v)
    if share > 0.0:
        diagnosis = Diagnosis("columns", "x", words, "", share=share)
        yield Explanation(diagnosis, "with x moved on by the belt", columns=moved)
    # A solver that goes on from where x stood: only the steps of the sticks are wrong.
    share_in_sticks = float(np.mean(np.isin(np.flatnonzero(case.wrong), still)))
    left = case.sizes.copy()
    left[still] = 0.0
    evidence = f"{share_in_sticks:.0%} of the wrong steps are such"
    yield Explanation(Diagnosis("columns", "x", words, evidence), left=left)


# -- the clock -------------------------------------------------------------------------------------


def even_times(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that evenly spaced times were rounded, or summed up with few digits."""
    t = case.steps.t
    h = np.diff(t)
    step = float((t[-1] - t[0]) / (len(t) - 1))
    if len(t) < FEWEST or np.ptp(h) == 0.0 or not np.max(np.abs(h - step)) <= 0.2 * step:
        return
    off = float(np.max(np.abs(t - np.linspace(t[0], t[-1], len(t)))))
    if off <= 16.0 * np.spacing(np.max(np.abs(t))):
        return
    single = off <= 1e3 * np.spacing(np.float32(np.max(np.abs(t))))
    words = f"the times are no even grid, by up to {off:.1e}"
    if single:
        words += ": single precision"
    # Even times may differ from these by half a step, or as 6 digits do.
    most_off = max(0.5 * step, 2e-6 * float(np.max(np.abs(t))))
    for digits in (0, 7, 6, 5, 4, 3, 2, None):
        even = _even(t, digits)
        if np.max(np.abs(even - t)) <= most_off:
            share = case.share_mended_by(even, case.steps.x, case.steps.v)
            change = f"with even times, {even[1] - even[0]:.10g} apart,"
            columns = partial(lambda t, x, v, digits: (_even(t, digits), x, v), digits=digits)
            yield Explanation(
                Diagnosis("columns", "t", words, "", share=share), change, columns=columns
            )


def _even(t: np.ndarray, digits: int | None) -> np.ndarray:
    """Return evenly spaced times near `t`.

    Their step has `digits` digits, or it follows from the first and the last time: as they are
    (`digits` 0), or rounded to 6 digits (None).
    """
    first = float(f"{t[0]:.6g}")
    if digits is None:
        return np.linspace(first, float(f"{t[-1]:.6g}"), len(t))
    if digits == 0:
        return np.linspace(float(t[0]), float(t[-1]), len(t))
    step = float(f"{(t[-1] - t[0]) / (len(t) - 1):.{digits}g}")
    return np.asarray(first + step * np.arange(len(t)))


def single_times(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that the times are in single precision, if tiny shifts of them make the
    steps right.
    """
    s = case.steps
    chosen = case.inside
    if len(s.t) < FEWEST or not _are_single(s.t) or not len(chosen):
        return
    shifts, slopes, left = _time_shifts(case, chosen)
    single_units = np.spacing(np.abs(s.t).astype(np.float32)).astype(float)
    is_small = np.abs(shifts) <= 2.0 * single_units
    within = is_small[chosen] & is_small[chosen + 1]
    within &= left <= np.maximum(1.0, LEFT_BY_SHIFTS * case.sizes[chosen])
    largest = float(np.max(np.abs(shifts[is_small]), initial=0.0))
    evidence = (
        f"all are such numbers; shifts of them by up to {largest:.1e} "
        f"repeat {np.mean(within):.0%} of the flights"
    )
    # Elsewhere a defect is explained that is no larger than such shifts make it.
    fastest = np.max(np.abs(slopes), axis=0)
    most = np.outer(2.0 * single_units[1:], fastest) + case.allowed
    is_explained = np.all(np.abs(s.defects) <= most, axis=1)
    is_explained[chosen] = within
    diagnosis = Diagnosis("columns", "t", "the times are in single precision", evidence, largest)
    # All times are numbers of single precision, which cannot be chance.
    if np.mean(within) >= 0.7:
        yield Explanation(diagnosis, left=np.where(is_explained | ~case.wrong, 0.0, case.sizes))


def _time_shifts(
    case: FaultySteps, flights: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return by how much to shift the time of each sample, so that flights between them are right.

    Then x' and v' at the ends of the flights, and what is left of their defects, in units of the
    allowed ones.
    """
    from scipy.linalg import solveh_banded

    s = case.steps
    after = flights + 1
    domain = case.domain[flights]
    tau = s.t[after] - s.t[flights]
    tick = 1e-4 * tau
    x = s.x[flights]
    v = s.v[flights]
    theta = s.theta[flights]
    ends = s.fly(domain, x, v, theta, tau)
    by_end = (s.fly(domain, x, v, theta, tau + tick) - ends) / tick[:, None]
    # A later start makes the step shorter, and the drive is ahead.
    by_start = (s.fly(domain, x, v, theta + s.K.Om * tick, tau - tick) - ends) / tick[:, None]
    misses = s.defects[flights] / case.allowed[flights]
    slopes = by_end / case.allowed[flights]
    start_slopes = by_start / case.allowed[flights]
    # Least squares, with the shifts themselves in units of the last place: each flight ties the two
    # times at its ends.
    diagonal = 1.0 / np.spacing(np.abs(s.t).astype(np.float32)).astype(float) ** 2
    beside = np.zeros(len(s.t))
    right = np.zeros(len(s.t))
    diagonal[flights] += np.sum(start_slopes**2, axis=1)
    diagonal[after] += np.sum(slopes**2, axis=1)
    beside[after] = np.sum(start_slopes * slopes, axis=1)
    right[flights] -= np.sum(start_slopes * misses, axis=1)
    right[after] -= np.sum(slopes * misses, axis=1)
    shifts = solveh_banded(np.stack([beside, diagonal]), right)
    moved = slopes * shifts[after, None] + start_slopes * shifts[flights, None]
    return shifts, by_end, np.max(np.abs(misses + moved), axis=1)


def _are_single(t: np.ndarray) -> bool:
    """Return whether all times are numbers of single precision, and not integers alone."""
    single = np.array_equal(t.astype(np.float32).astype(float), t)
    return single and not np.array_equal(t, np.rint(t))


# -- the numbers themselves, and the list of events ------------------------------------------------


def event_list_faults(check: Verdict) -> Iterator[Diagnosis]:
    """Yield what is wrong with a solver's list of events although its samples are right."""
    missed = check.missed
    invented = check.invented
    evidence = "the samples are right"
    # As many of the same kinds, one after another, are the same events at another time.
    if missed and [event.kind for event in missed] == [event.kind for event in invented]:
        errors = [listed.t - float(exact.t) for listed, exact in zip(invented, missed, strict=True)]
        worst = max(errors, key=abs)
        words = (
            f"the list has {counted(len(missed), 'event')} at a wrong time, by up to {worst:.3g}"
        )
        yield Diagnosis("event times", "", words, evidence, worst, None)
        return
    lists = (
        ("missing events", missed, "lacks"),
        ("invented events", invented, "has, and the motion has not,"),
    )
    for cause, events, verb in lists:
        if events:
            first = f"{events[0].kind} at t = {float(events[0].t):.10g}"
            words = f"the list {verb} {counted(len(events), 'event')}, first: {first}"
            yield Diagnosis(cause, "", words, evidence, float(len(events)), 0.0)


def outliers(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis of outliers: single wrong samples, without which the steps are right."""
    off = [fault for fault in case.check.faults if fault.reason == "outlier"]
    check = case.check
    if off:
        rows = [fault.step + 1 for fault in off]
        # Wrong steps that begin or end with such a sample.
        begins = np.isin(check.wrong_steps, rows)
        ends = np.isin(check.wrong_steps + 1, rows)
        share = float(np.mean(begins | ends))
        verb = "is" if len(off) == 1 else "are"
        words = f"{counted(len(off), 'sample')} {verb} off, the first is number {rows[0]}"
        size = float(np.median([max(abs(fault.defect_x), abs(fault.defect_v)) for fault in off]))
        diagnosis = Diagnosis("noise", "", words, "", size, None, share)
        change = "without them" if rows[1:] else "without it"
        yield Explanation(diagnosis, change, columns=partial(_without, rows))


def _without(rows: list[int], t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Columns:
    """Return the columns without the samples `rows`."""
    return np.delete(t, rows), np.delete(x, rows), np.delete(v, rows)


def noise(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis of noise if the defects of successive steps are anticorrelated, as noise
    makes them.
    """
    s = case.steps
    inside = case.inside_wrong
    first_of_pairs = inside[:-1][np.diff(inside) == 1]
    # Times in single precision make such defects too, of x and v that are right.
    if len(first_of_pairs) < FEWEST_PAIRS or _are_single(s.t):
        return
    correlation_x, correlation_v = _step_correlations(case, first_of_pairs)
    both = (correlation_x, correlation_v)
    # NaN, where nothing moves, is no correlation either.
    if not (max(both) < 0.0 and min(both) < LEAST_CORRELATION):
        return
    noise_x, noise_v = _noise_sizes(s.defects[inside])
    words = f"the samples have noise of about {noise_x:.2g} in x and {noise_v:.2g} in v"
    evidence = (
        "what one step is off, the next one takes back: "
        f"correlation {correlation_x:.2f} in x, {correlation_v:.2f} in v"
    )
    error = float(noise_v / np.sqrt(2.0 * len(inside)))
    diagnosis = Diagnosis("noise", "", words, evidence, float(noise_v), error)
    # A step has the noise of both its samples, and v of the first one moves x.
    h = np.diff(s.t)
    usual = np.column_stack(
        [np.hypot(np.sqrt(2.0) * noise_x, h * noise_v), np.full(len(h), 2.0 * noise_v)]
    )
    fits = np.all(np.abs(s.defects) <= case.allowed + MOST_DEVIATIONS * usual, axis=1)
    yield Explanation(diagnosis, left=np.where(fits, 0.0, case.sizes))


def _step_correlations(case: FaultySteps, steps: np.ndarray) -> tuple[float, float]:
    """Return how the defects of steps, carried over the next step by the motion, correlate with
    the defects of that step, in x and in v.
    """
    s = case.steps
    between = steps + 1
    # `moved` goes on from where the exact motion ends each step, `s` from the sample there.
    moved = replace(s, x=s.x.copy(), v=s.v.copy())
    moved.x[between] += s.defects[steps, 0]
    moved.v[between] += s.defects[steps, 1]
    domain = case.domain[between]
    carried = moved.flight(domain, between, between + 1) - s.flight(domain, between, between + 1)
    after = s.defects[between]
    products = np.sqrt(np.sum(carried**2, axis=0) * np.sum(after**2, axis=0))
    x, v = (np.sum(carried * after, axis=0) / products).tolist()
    return x, v


def _noise_sizes(defects: np.ndarray) -> np.ndarray:
    """Return the standard deviations of the noise of a sample in x and v, from defects of steps."""
    # The median is not moved by outliers. Both samples of a step add their noise: the variance of
    # its defect is twice that of a sample.
    return np.asarray(np.sqrt(np.median(defects**2, axis=0) / MEDIAN_CHI2 / 2.0))


def few_digits(check: Verdict) -> Iterator[Diagnosis]:
    """Yield the diagnosis that the columns were written with few digits."""
    if check.rounded:
        columns = ", ".join(f"{name} to {text}" for name, text in check.rounded.items())
        words = f"the samples are rounded: {columns}"
        evidence = "all numbers of these columns fit that grid"
        yield Diagnosis("precision", ", ".join(check.rounded), words, evidence, share=0.0)
